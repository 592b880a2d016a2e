"""What a controller is designed on is what flies: design plant and simulation agree, sample by sample."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from aeroservo.aeroelastic.build import build
from aeroservo.aircraft.files import read
from aeroservo.control.closed_loop import closed_loop
from aeroservo.control.design import controls, joined
from aeroservo.control.lqg import LQG
from aeroservo.control.lqr import LQR
from aeroservo.control.pid import PID
from aeroservo.control.plant import design_plant
from aeroservo.datatypes import AeroelasticModel, FlightCondition
from aeroservo.servo import Sensor
from aeroservo.simulate.engine import Scenario, simulate
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Stepping

TWO_ROUTES = 1e-11
"""Exact steps of 1 ms against the exact sampled plant of 5 ms, over 200 samples."""

CONDITION = FlightCondition(V=125.0, rho=1.01628)  # 7 m/s beyond flutter


def wing(dead_time: float, bandwidth: float | None, age: float) -> AeroelasticModel:
    """BACT with an accelerometer on which its actuator acts at once, a gyro, dead time, lag and age."""
    model = build(read("bact"))
    sensors = (
        replace(model.sensors[1], bandwidth=bandwidth, delay_s=age),
        Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0)),
    )
    return replace(model, sensors=sensors, actuators=(replace(model.actuators[0], delay_s=dead_time),), gravity=None)


@pytest.mark.parametrize("delay", [1.0, 0.4])
@pytest.mark.parametrize(
    ("dead_time", "bandwidth", "age"), [(0.0, None, 0.0), (0.003, 200.0, 0.0), (0.003, 200.0, 0.002)]
)
def test_sampled_plant_is_the_simulation(dead_time: float, bandwidth: float | None, age: float, delay: float) -> None:
    """An LQG loop beyond flutter: whole and fractional delays, dead time, sensor lag and sensor age."""
    model = wing(dead_time, bandwidth, age)
    options = {"rate_Hz": 200.0, "delay_samples": delay, "sensors": ("acc_te", "gyro")}
    plant = design_plant(model, CONDITION, gusts=True, **options)
    design = LQG(Q=[0.0, 800.0, 0.0, 1.0], R=[33.0], gust=0.1, recovery=0.1)(plant)
    assert np.all(np.abs(design.closed_loop_eigenvalues) < 1.0)
    loop = closed_loop(controls(plant), design.controller)
    at = loop.states.index("pitch_rad")
    x, predicted = np.zeros(len(loop.states)), []
    x[at] = 0.01
    for _ in range(200):
        predicted.append(x[at])
        x = loop.A @ x
    scenario = Scenario(
        profile=level(125.0, density=1.01628),
        duration=1.0,
        controller=design.as_controller(delay_s=delay / 200.0),
        initial=(("pitch_rad", 0.01),),
    )
    history = simulate(model, scenario, stepping=Stepping(dt=0.001)).history
    assert history is not None
    flown = history.data[:, history.channels.index("pitch_rad")][::5][:200]
    np.testing.assert_allclose(flown, predicted, atol=TWO_ROUTES * 0.01)


def test_full_state_with_what_is_not_measured_inside() -> None:
    """The elevon's rate and the delay are simulated inside the controller; the wing does not notice."""
    model = wing(0.0, None, 0.0)
    plant = controls(design_plant(model, CONDITION, rate_Hz=200.0, delay_samples=2))
    design = LQR(Q=[0.0, 800.0, 0.0, 1.0], R=[33.0])(plant)
    assert design.controller.inputs == ("plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s", "elevon_rad")
    wanted = np.linalg.eigvals(plant.A - plant.B @ design.K)  # and the roots of what is simulated inside
    inside = [i for i, name in enumerate(plant.states) if name not in design.controller.inputs]
    wanted = np.concatenate([wanted, np.linalg.eigvals(plant.A[np.ix_(inside, inside)])])
    coefficients = [np.poly(values) for values in (design.closed_loop_eigenvalues, wanted)]
    np.testing.assert_allclose(coefficients[0], coefficients[1], atol=1e-9)
    ideal, x = [], np.zeros(len(plant.states))
    x[plant.states.index("pitch_rad")] = 0.01
    for _ in range(200):
        ideal.append(x[plant.states.index("pitch_rad")])
        x = (plant.A - plant.B @ design.K) @ x
    scenario = Scenario(
        profile=level(125.0, density=1.01628), duration=1.0, initial=(("pitch_rad", 0.01),),
        controller=design.as_controller(delay_s=0.01),
    )  # fmt: skip
    history = simulate(model, scenario, stepping=Stepping(dt=0.001)).history
    assert history is not None
    flown = history.data[:, history.channels.index("pitch_rad")][::5][:200]
    np.testing.assert_allclose(flown, ideal, atol=TWO_ROUTES * 0.01)


def test_continuous_full_state_with_an_actuator_flies() -> None:
    """A continuous controller reads the position of its actuator and simulates its rate: the loop of the design."""
    model = wing(0.0, None, 0.0)
    plant = controls(design_plant(model, CONDITION))
    design = LQR(Q=[0.0, 800.0, 0.0, 1.0], R=[33.0])(plant)
    assert "elevon_rad" in design.controller.inputs and len(design.controller.states) == 1
    scenario = Scenario(
        profile=level(125.0, density=1.01628), duration=1.0, initial=(("pitch_rad", 0.01),),
        controller=design.as_controller(),
    )  # fmt: skip
    history = simulate(model, scenario, stepping=Stepping(dt=0.001)).history
    assert history is not None
    closed = joined(plant, design.controller)
    x = np.zeros(len(closed))
    x[plant.states.index("pitch_rad")] = 0.01
    wanted = [(expm(closed * t) @ x)[plant.states.index("pitch_rad")] for t in history.t[::50]]
    flown = history.data[::50, history.channels.index("pitch_rad")]
    np.testing.assert_allclose(flown, wanted, atol=TWO_ROUTES * 0.01)


def test_integral_does_not_wind_up_in_flight() -> None:
    """A steady gust beyond the limited elevon: with tracking the integral lets go at once, without it late."""
    model = replace(build(read("thesis-simulation")), limits=())
    plant = controls(
        design_plant(model, FlightCondition.at(3048.0, V=35.0), rate_Hz=200.0, delay_samples=1, sensors=("pitch_rad",))
    )
    design = PID(channel="pitch_rad", kp=-0.5, ki=-20.0, kd=-0.1)(plant)
    assert np.all(np.abs(design.closed_loop_eigenvalues) < 1.0)
    controller = design.as_controller(delay_s=0.005, limits=(0.01,))
    from aeroservo.simulate.disturbances import SharpGust

    after = []
    for windup in (controller.windup, np.zeros_like(controller.windup)):
        scenario = Scenario(
            profile=level(35.0, altitude=3048.0),
            duration=12.0,
            controller=replace(controller, windup=windup),
            gusts=(SharpGust(amplitude=2.0, start=0.5), SharpGust(amplitude=-2.0, start=5.0)),
        )
        history = simulate(model, scenario, stepping=Stepping(dt=0.001)).history
        assert history is not None
        command = history.data[:, history.channels.index("elevon_command_rad")]
        t = history.t
        assert np.abs(command).max() <= 0.01 + 1e-12
        held = np.abs(command[t > 5.5]) > 0.0099
        after.append(float(np.sum(held) * (t[1] - t[0])))
    assert after[0] < 0.5 < 2.0 < after[1]
