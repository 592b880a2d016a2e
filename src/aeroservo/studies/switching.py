"""The thesis' switch of controllers at 50 m/s under a sinusoidal airspeed, beside a schedule and beside reversed gains.

The thesis flies one controller up to 50 m/s and another, tuned by hand with its output reversed, from there on, and
tests the switch with an airspeed that swings about it (chapter 10.3). Its second controller is not printed. Here the
two are regulators designed at one speed below and one above; the same regulator with every sign turned past the switch
shows what a reversal of all gains does; a schedule needs neither.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from aeroservo.control.controller import Controller
from aeroservo.control.lqr import FULL_STATE
from aeroservo.control.plant import design_plant
from aeroservo.control.schedule import schedule_check, switched
from aeroservo.datatypes import AeroelasticModel, FlightCondition
from aeroservo.simulate.disturbances import Gustiness
from aeroservo.simulate.engine import Simulation, run_prepared
from aeroservo.simulate.prepare import prepare
from aeroservo.simulate.profiles import Profile
from aeroservo.simulate.scenario import Scenario, Stepping
from aeroservo.studies.climb_flight import (
    DELAY_SAMPLES,
    FULL_STATE_SENSORS,
    RATE_HZ,
    climb_model,
    climb_schedule,
)

ALTITUDE = 3048.0
"""10,000 ft. [m]"""

SWITCH = 50.0
"""Airspeed of the switch. [m/s]"""

BELOW, ABOVE = 40.0, 70.0
"""Airspeeds at which the two regulators of the switch are designed. [m/s]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class SwitchRun:
    """One controller through the sinusoidal airspeed.

    Attributes
    ----------
    name : str
        "schedule", "switch" or "reversed".
    simulation : Simulation
        Its history. [SI]
    largest_pitch, largest_plunge : float
        Largest magnitudes. [rad, m]
    largest_step : float
        Largest change of the command from sample to sample, all of the run. [rad]
    jump_at_switch : float
        Mean of the largest change of the command from sample to sample in the 20 ms after each passage of the switch,
        that at the start left out. [rad]
    lost_at_s : float or None
        When the bounds were left. [s]
    decay : float
        Least decay of the frozen closed loop over the airspeeds of the test, negative where unstable. [1/s]
    """

    name: str
    simulation: Simulation
    largest_pitch: float
    largest_plunge: float
    largest_step: float
    jump_at_switch: float
    lost_at_s: float | None
    decay: float


def sinusoidal_airspeed(
    mean: float = SWITCH, amplitude: float = 5.0, period: float = 4.0, duration: float = 40.0
) -> Profile:
    """An airspeed that swings about a mean at 3,048 m, by straight lines of a 40th of a period.

    Parameters
    ----------
    mean, amplitude : float
        True airspeed. [m/s]
    period, duration : float
        Of the swing, and of the flight. [s]

    Returns
    -------
    profile : Profile
        Airspeed against time.

    Raises
    ------
    ValueError
        If the airspeed would not stay positive.

    References
    ----------
    Bramstång 2015, section 10.3.

    Examples
    --------
    >>> sinusoidal_airspeed().speed(1.0).round(6).item()
    55.0
    """
    if not (0.0 <= amplitude < mean and period > 0.0 and duration > 0.0):
        raise ValueError(f"amplitude must be below the mean airspeed [m/s], got {amplitude:g} about {mean:g}")
    t = np.linspace(0.0, duration, max(2, 1 + round(40.0 * duration / period)))
    return Profile(t=t, V=mean + amplitude * np.sin(2.0 * math.pi * t / period), altitude=np.full(t.shape, ALTITUDE))


def switch_controllers(model: AeroelasticModel) -> dict[str, Controller]:
    """The schedule, the switch of two regulators at 50 m/s, and a switch that turns every sign there.

    Parameters
    ----------
    model : AeroelasticModel
        Of `climb_model`.

    Returns
    -------
    controllers : dict of str to Controller
        "schedule", "switch", "reversed". [SI]

    References
    ----------
    Bramstång 2015, sections 9.4.8 and 10.3; equations.md, "Near reversal, what really changes sign".

    Examples
    --------
    >>> sorted(switch_controllers(climb_model()))
    ['reversed', 'schedule', 'switch']
    """
    conditions = FlightCondition.at(ALTITUDE, V=np.linspace(15.0, 130.0, 60))
    schedule = climb_schedule(model, "full state", conditions)
    low, high = (_regulator(model, V, schedule.limits) for V in (BELOW, ABOVE))
    q = float(FlightCondition.at(ALTITUDE, V=SWITCH).q)
    return {"schedule": schedule, "switch": switched(low, high, q), "reversed": switched(low, _turned(low), q)}


def switch_study(
    *, amplitude: float = 5.0, period: float = 4.0, duration: float = 40.0, turbulence: float = 1.0, seed: int = 0
) -> tuple[SwitchRun, ...]:
    """Fly the three controllers through the same swinging airspeed and turbulence.

    Parameters
    ----------
    amplitude : float
        Of the airspeed about 50 m/s. [m/s]
    period, duration : float
        Of its swing, and of the flight. [s]
    turbulence : float
        RMS of Dryden turbulence. [m/s]
    seed : int
        Of the turbulence.

    Returns
    -------
    runs : tuple of SwitchRun
        "schedule", "switch", "reversed".

    References
    ----------
    Bramstång 2015, section 10.3.

    Examples
    --------
    >>> [run.lost_at_s is None for run in switch_study(duration=8.0)]
    [True, True, False]
    """
    model = climb_model()
    profile = sinusoidal_airspeed(SWITCH, amplitude, period, duration)
    speeds = FlightCondition.at(ALTITUDE, V=np.linspace(SWITCH - amplitude, SWITCH + amplitude, 41))
    runs = []
    for name, controller in switch_controllers(model).items():
        scenario = Scenario(
            profile=profile, duration=duration, controller=controller, turbulence=Gustiness(level=turbulence)
        )  # fmt: skip
        run = run_prepared(prepare(model, scenario, Stepping(record_s=1.0 / RATE_HZ)), seed=seed)
        decay = schedule_check(model, controller, speeds, between=0).decay
        runs.append(_summary(name, run, float(decay.min())))
    return tuple(runs)


def _regulator(model: AeroelasticModel, V: float, limits: tuple[float, ...]) -> Controller:
    """The full-state regulator of one airspeed."""
    plant = design_plant(
        model, FlightCondition.at(ALTITUDE, V=V), rate_Hz=RATE_HZ, delay_samples=DELAY_SAMPLES,
        sensors=FULL_STATE_SENSORS,
    )  # fmt: skip
    return FULL_STATE(plant).as_controller(delay_s=DELAY_SAMPLES / RATE_HZ, limits=limits)


def _turned(c: Controller) -> Controller:
    """The controller with the sign of its output turned; what it simulates inside follows the turned command."""
    return replace(c, A=c.A - 2.0 * c.windup @ c.C, B=c.B - 2.0 * c.windup @ c.D, C=-c.C, D=-c.D)


def _summary(name: str, run: Simulation, decay: float) -> SwitchRun:
    """Largest values, and what the command does at the switch."""
    history = run.history
    assert history is not None
    steps = np.abs(np.diff(history["elevon_command_rad"]))
    above = history["speed_m_s"] > SWITCH
    passed = [k for k in np.flatnonzero(above[1:] != above[:-1]) if k > 0]
    jumps = [float(steps[k : k + 4].max()) for k in passed]
    peak = dict(zip(run.channels, run.peak.tolist()))
    return SwitchRun(
        name=name,
        simulation=run,
        largest_pitch=peak["pitch_rad"],
        largest_plunge=peak["plunge_m"],
        largest_step=float(steps.max()),
        jump_at_switch=float(np.mean(jumps)) if jumps else 0.0,
        lost_at_s=run.duration if run.limit_left is not None or run.overflow_at is not None else None,
        decay=decay,
    )
