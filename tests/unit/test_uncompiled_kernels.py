"""The compiled kernels and the same Python without a compiler give the same numbers, in short flights that visit all.

Run as a script, this file prints those numbers; the test runs it with NUMBA_DISABLE_JIT=1 (which also lets coverage see
inside the kernels) and compares.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import aeroservo as av
from aeroservo.aircraft.files import model_path, validate
from aeroservo.control.adaptive import control_adaptation, recursive_least_squares
from aeroservo.control.controller import Controller
from aeroservo.gust.intensity import constant_turbulence
from aeroservo.gust.records import turbulence_record
from aeroservo.gust.sampling import discretise
from aeroservo.gust.turbulence import shaping_filter
from aeroservo.servo import Actuator, Sensor
from aeroservo.simulate.disturbances import CosineGust, Doublet, Gustiness, SharpGust
from aeroservo.simulate.engine import simulate
from aeroservo.simulate.profiles import climb, level
from aeroservo.simulate.scenario import Scenario, Stepping

LONG = 0.12
"""Of each flight; uncompiled steps take a millisecond. [s]"""


RK4 = Stepping(dt=1e-3, substeps=2, method="rk4")


def model(**changes: object) -> av.AeroelasticModel:
    """The thesis' pitch-plunge model, changed."""
    return replace(av.build(av.read("thesis-simulation")), **changes)  # type: ignore[arg-type]


def flown(plant: av.AeroelasticModel, scenario: Scenario, stepping: Stepping = RK4) -> list[float]:
    """Last row, RMS and peaks of a short flight of given steps."""
    run = simulate(plant, scenario, seed=4, stepping=stepping)
    assert run.history is not None
    return [*run.history.data[-1].tolist(), *run.rms.tolist(), *run.peak.tolist()]


def limited_servo() -> list[float]:
    """Saturation, rate limit, backlash, dead time; a schedule with limits and anti-windup; noise and a quantiser."""
    servo = Actuator(control="elevon", omega=90.0, zeta=0.7, limit=0.02, rate_limit=1.0, delay_s=0.003, backlash=0.002)
    gyro = Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0), noise=1e-3, quantum=1e-4, delay_s=0.002, bandwidth=300.0)
    c = Controller(
        A=[[[0.9]], [[0.8]]], B=[[[1.0]], [[1.0]]], C=[[[0.05]], [[0.06]]], D=[[[0.5]], [[0.6]]], inputs=("gyro",),
        outputs=("elevon_command_rad",), dt_s=0.005, delay_s=0.002, limits=(0.03,), pressures=[400.0, 900.0],
        windup=[[[0.3]], [[0.3]]],
    )  # fmt: skip
    scenario = Scenario(
        profile=climb(V=(30.0, 36.0), altitude=(0.0, 20.0), duration=LONG), duration=LONG, controller=c,
        gusts=(SharpGust(amplitude=2.0, start=0.02), CosineGust(amplitude=4.0, length=1.5, start=0.04)),
        doublets=(Doublet(amplitude=0.05, start=0.05, duration=0.04),), turbulence=Gustiness(level=1.0),
        initial=(("pitch_rad", 0.02),),
    )  # fmt: skip
    return flown(model(sensors=(gyro,), actuators=(servo,)), scenario)


def first_order_servo() -> list[float]:
    """An actuator of first order with both limits, thrown about."""
    servo = Actuator(control="elevon", omega=60.0, limit=0.03, rate_limit=2.0, gain=2.0)
    doublet = Doublet(amplitude=0.3, start=0.01, duration=0.05)
    return flown(model(actuators=(servo,)), Scenario(profile=level(30.0), duration=LONG, doublets=(doublet,)))


def soft_springs() -> list[float]:
    """Polynomial springs, freeplay, and a lift curve that stalls."""
    text = model_path("thesis-simulation").read_text(encoding="utf-8")
    nonlinear = {
        "plunge_stiffness_polynomial": [1.0, 0.0, 40.0],
        "pitch_stiffness_polynomial": [1.0, 2.0, 30.0],
        "freeplay_rad": 0.005,
        "CL_alpha_table": [[-20.0, -0.9], [-6.0, -0.38536], [6.0, 0.38536], [20.0, 0.6]],
    }
    file = validate(tomllib.loads(text) | {"nonlinear": nonlinear}, "test")
    start = (("pitch_rad", 0.15), ("plunge_rate_m_s", 1.0))
    return flown(av.build(file), Scenario(profile=level(35.0), duration=LONG, initial=start))


def exact_steps() -> list[float]:
    """A linear flight stepped by the matrix exponential, in turbulence."""
    scenario = Scenario(profile=level(38.0), duration=LONG, turbulence=Gustiness(level=1.0))
    return flown(model(gravity=None, limits=()), scenario, Stepping(dt=1e-3, method="exact"))


def left_limits() -> list[float]:
    """A flight that ends where pitch leaves its limit."""
    return flown(
        model(), Scenario(profile=level(60.0), duration=LONG, initial=(("pitch_rad", 3.13), ("pitch_rate_rad_s", 5.0)))
    )


def adaptation() -> list[float]:
    """The adaptive element beside a schedule; its least squares by itself."""
    from aeroservo.studies.climb_flight import climb_conditions, climb_model, climb_schedule

    plant = climb_model()
    conditions = climb_conditions()
    schedule = climb_schedule(plant, "full state", conditions)
    made = control_adaptation(plant, schedule, conditions)
    scenario = Scenario(
        profile=level(53.0, altitude=3048.0), duration=LONG, controller=schedule, turbulence=Gustiness(level=1.0),
        adaptation=made,
    )  # fmt: skip
    rng = np.random.default_rng(2)
    x = rng.standard_normal((40, 2))
    found, _ = recursive_least_squares(x, x @ np.array([[1.0], [-2.0]]), forget=0.98)
    return [*flown(plant, scenario), *found[-1].ravel().tolist()]


def lattice() -> list[float]:
    """Influence of bound vortices and wakes: derivatives of a coarse wing."""
    from aeroservo.aeroelastic.aircraft_lattice import aircraft_lattice, lattice_coefficients

    file = av.read("thesis-uav")
    method = av.VortexLattice(chordwise=2, spanwise=4)
    found = aircraft_lattice(file.surfaces(), file.references(), method=method)  # type: ignore[attr-defined]
    c = lattice_coefficients(found)
    return [float(c.CL_alpha), float(c.CM_alpha)]


def shaped_noise() -> list[float]:
    """A turbulence record."""
    noise = discretise(shaping_filter(constant_turbulence(1.0), 40.0), 1e-3)
    return turbulence_record(noise, 120, seed=3)[-2:].ravel().tolist()


FLIGHTS: dict[str, Callable[[], list[float]]] = {
    f.__name__: f
    for f in (
        limited_servo, first_order_servo, soft_springs, exact_steps, left_limits, adaptation, lattice, shaped_noise,
    )
}  # fmt: skip


@pytest.fixture(scope="module")
def uncompiled() -> dict[str, list[float]]:
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run([sys.executable, __file__], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    found: dict[str, list[float]] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_kernel_is_its_python(name: str, uncompiled: dict[str, list[float]]) -> None:
    compiled = FLIGHTS[name]()
    assert len(compiled) > 1
    np.testing.assert_allclose(uncompiled[name], compiled, rtol=1e-9, atol=1e-12)  # fused operations round once less


if __name__ == "__main__":
    print(json.dumps({name: flight() for name, flight in FLIGHTS.items()}))
