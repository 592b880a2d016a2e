"""At rest nothing moves: weight is carried by the springs, and controllers and sensors read from there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import aeroservo as av
from aeroservo.control.controller import Controller, state_feedback
from aeroservo.servo import Actuator, Sensor
from aeroservo.simulate.engine import simulate
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario

STATES = ("plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s")
COMMAND = ("elevon_command_rad",)
ANGLE = Sensor(name="angle", unit="rad", displacement=(0.0, 1.0), bandwidth=100.0)


@pytest.mark.parametrize("dt", [None, 0.005])
@pytest.mark.parametrize("reads", ["states", "lagged sensor"])
@pytest.mark.parametrize("servo", [(), (Actuator(control="elevon", omega=80.0, zeta=0.7),)])
def test_an_undisturbed_loop_stays_at_rest(dt: float | None, reads: str, servo: tuple[Actuator, ...]) -> None:
    """Heavy wing, feedback of positions, continuous and sampled, with and without lags: nothing happens at all."""
    model = replace(av.build(av.read("thesis-simulation")), sensors=(ANGLE,), actuators=servo)
    gain: Controller = state_feedback(np.array([[-6.8, -1.7, -0.6, -0.9]]), STATES, COMMAND, dt)
    if reads == "lagged sensor":
        gain = Controller(A=[[-5.0 if dt is None else 0.9]], B=[[0.1]], C=[[0.2]], D=[[0.3]], inputs=("angle",),
                          outputs=COMMAND, dt_s=dt)  # type: ignore[arg-type]  # fmt: skip
    run = simulate(model, Scenario(profile=level(20.0, altitude=3048.0), duration=2.0, controller=gain))
    assert np.abs(run.equilibrium[0]) > 0.01  # it does hang in its springs
    moving = [j for j, name in enumerate(run.channels) if name not in ("speed_m_s", "altitude_m")]
    assert run.peak[moving].max() < 1e-9


@pytest.mark.parametrize("dt", [None, 0.002])
def test_weight_does_not_change_small_motions(dt: float | None) -> None:
    """The same response with and without weight, from a small kick, with a continuous and a fast sampled loop."""
    from aeroservo.simulate.engine import linearised

    heavy = av.build(av.read("thesis-simulation"))
    gain = state_feedback(np.array([[-6.8, -1.7, -0.6, -0.9]]), STATES, COMMAND, dt)
    scenario = Scenario(
        profile=level(40.0, altitude=3048.0), duration=3.0, controller=gain, initial=(("pitch_rad", 1e-5),)
    )
    runs = [simulate(model, scenario).history for model in (heavy, linearised(heavy))]
    assert runs[0] is not None and runs[1] is not None
    for channel in ("plunge_m", "pitch_rad"):
        difference = np.abs(runs[0][channel] - runs[1][channel]).max()
        assert difference < 2e-3 * np.abs(runs[1][channel]).max()  # weight on pitch acts through cos of pitch
