"""A scheduled controller along a climb: what the engine flies is the file's matrices, blended by dynamic pressure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import aeroservo as av
from aeroservo.atmosphere import atmosphere
from aeroservo.control.controller import Controller
from aeroservo.simulate.disturbances import Gustiness
from aeroservo.simulate.engine import Simulation, linearised, simulate
from aeroservo.simulate.profiles import climb
from aeroservo.simulate.scenario import Scenario, Stepping

SAMPLE, DELAY = 0.005, 0.003
POINTS = np.array([200.0, 400.0, 900.0, 1000.0])


def controller(*, limit: float = 0.0) -> Controller:
    """Two states, two channels, another matrix at each of four pressures, unevenly spread."""
    rng = np.random.default_rng(8)
    A = np.stack([np.diag(rng.uniform(-0.5, 0.9, 2)) for _ in POINTS])
    B, C, D = (0.05 * rng.standard_normal((len(POINTS), *shape)) for shape in ((2, 2), (1, 2), (1, 2)))
    return Controller(
        A=A, B=B, C=C, D=D, inputs=("pitch_rad", "pitch_rate_rad_s"), outputs=("elevon_command_rad",), dt_s=SAMPLE,
        delay_s=DELAY, pressures=POINTS, limits=(limit,),
    )  # fmt: skip


def flown(c: Controller) -> Simulation:
    """Eight seconds from 15 m/s (138 Pa, below the schedule) to 45 m/s (above it), in turbulence."""
    plant = replace(linearised(av.build(av.read("thesis-simulation"))), limits=())
    profile = climb(V=(15.0, 45.0), altitude=(0.0, 300.0), duration=8.0)
    scenario = Scenario(profile=profile, duration=8.0, controller=c, turbulence=Gustiness(level=1.5))
    return simulate(plant, scenario, seed=4, stepping=Stepping(dt=1e-3, record_s=1e-3))


def recomputed(c: Controller, run: Simulation) -> np.ndarray:
    """Commands from the recorded channels alone: every entry of every matrix by numpy's linear interpolation."""
    assert run.history is not None
    h = run.history
    V, altitude = h["speed_m_s"], h["altitude_m"]
    pressure = 0.5 * atmosphere(altitude).rho * V**2
    assert pressure[0] < POINTS[0] and pressure[-1] > POINTS[-1]
    measured = np.stack([h["pitch_rad"], h["pitch_rate_rad_s"]], axis=1)
    per_sample, late = round(SAMPLE / run.dt), round(DELAY / run.dt)
    x, held, commands = np.zeros(2), 0.0, []
    for k in range(len(h.t)):
        if k % per_sample == 0:
            blended = {
                name: np.array(
                    [
                        [np.interp(pressure[k], POINTS, getattr(c, name)[:, i, j]) for j in range(cols)]
                        for i, cols in enumerate([getattr(c, name).shape[2]] * getattr(c, name).shape[1])
                    ]
                )
                for name in "ABCD"
            }
            held = float((blended["C"] @ x + blended["D"] @ measured[k])[0])
            x = blended["A"] @ x + blended["B"] @ measured[k]
        commands.append(held if not c.limits[0] else float(np.clip(held, -c.limits[0], c.limits[0])))
    return np.concatenate([np.zeros(late), commands])[: len(h.t)]


@pytest.mark.parametrize("limit", [0.0, 2e-4])
def test_commands_along_a_climb(limit: float) -> None:
    """Equal to rounding, from below the first pressure to above the last; also where a limit cuts."""
    c = controller(limit=limit)
    run = flown(c)
    assert run.history is not None and run.method == "rk4" and run.duration == pytest.approx(8.0)
    command = run.history["elevon_command_rad"]
    assert np.abs(command).max() > 1e-4
    np.testing.assert_allclose(command, recomputed(c, run), atol=1e-9 * np.abs(command).max())
    assert not limit or np.abs(command).max() == pytest.approx(limit, rel=1e-12)


def test_schedule_matters_and_ends_are_held() -> None:
    """The blend differs from any one point's controller; weights never leave 0 .. 1."""
    c = controller()
    run = flown(c)
    single = flown(replace(c, A=c.A[:1], B=c.B[:1], C=c.C[:1], D=c.D[:1], windup=None, pressures=None))
    assert run.history is not None and single.history is not None
    a, b = run.history["elevon_command_rad"], single.history["elevon_command_rad"]
    assert np.abs(a - b).max() > 0.1 * np.abs(a).max()
    low = run.history.t < 0.8  # still below 200 Pa: the first point alone
    np.testing.assert_allclose(a[low], b[low], atol=1e-12)
    weights = c.blend(np.array([0.0, 200.0, 300.0, 950.0, 5000.0]))
    np.testing.assert_allclose(weights, [[0, 0], [0, 0], [0, 0.5], [2, 0.5], [2, 1.0]])
