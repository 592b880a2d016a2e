"""The climb of the thesis, 15 m/s at sea level to 130 m/s at 3,048 m in 115 s: aircraft, schedules, weather.

Schedules of full state and of a gyro fly the pinned pitch-plunge model with a second-order actuator, 200 Hz and one
sample of delay, through turbulence and a 1-cosine gust every ten seconds; a run is lost when pitch or plunge leave
their bounds. The air forces are those of small angles: what happens beyond the bounds is not asked.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from aeroservo.aeroelastic.build import build
from aeroservo.aircraft.files import read
from aeroservo.aircraft.overrides import override
from aeroservo.control.adaptive import Adaptation
from aeroservo.control.controller import Controller
from aeroservo.control.design import Design
from aeroservo.control.lqg import GYRO_RECOVERY
from aeroservo.control.lqr import FULL_STATE
from aeroservo.control.schedule import design_schedule
from aeroservo.datatypes import AeroelasticModel, FlightCondition, LinearSystem
from aeroservo.servo import Actuator, Limit, Sensor
from aeroservo.simulate.disturbances import CosineGust, Gustiness
from aeroservo.simulate.engine import Simulation, run_prepared
from aeroservo.simulate.prepare import prepare
from aeroservo.simulate.profiles import climb
from aeroservo.simulate.scenario import Scenario, Stepping

RATE_HZ = 200.0
"""Sample rate of the controllers. [Hz]"""

DELAY_SAMPLES = 1
"""Computing delay. [sample]"""

POINTS = 60
"""Points of the schedules."""

FULL_STATE_SENSORS = ("plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s", "elevon_rad")
"""What the full-state schedule measures; the rate of the elevon it simulates."""

LOST = {"pitch": math.radians(20.0), "plunge": 3.0}
"""Where a run is lost. [rad, m]"""

SURFACES = ((math.radians(20.0), math.radians(400.0)), (math.radians(15.0), math.radians(300.0)))
"""Elevons: largest deflection and rate, either way. [rad, rad/s]"""


def climb_model(
    limit: float = SURFACES[0][0],
    rate_limit: float = SURFACES[0][1],
    *,
    lift_effect: float = 1.0,
    moment_effect: float = 1.0,
) -> AeroelasticModel:
    """The preset thesis-simulation with a 60 rad/s actuator, a gyro and an accelerometer, and the bounds of the climb.

    Parameters
    ----------
    limit, rate_limit : float
        Of the elevon, either way. [rad, rad/s]
    lift_effect, moment_effect : float
        Factors on the elevon's lift and moment: an aircraft that is not as its model says. [-]

    Returns
    -------
    model : AeroelasticModel
        Quasi-steady pitch-plunge model.

    References
    ----------
    targets.json, "simulation_model"; equations.md, "Simulation model".

    Examples
    --------
    >>> climb_model().actuators[0].omega
    60.0
    """
    file = read("thesis-simulation")
    derivatives = {"model.CL_delta": 0.87 * lift_effect, "model.CM_delta": -0.117 * moment_effect}
    model = build(override(file, derivatives) if (lift_effect, moment_effect) != (1.0, 1.0) else file)
    return replace(
        model,
        actuators=(Actuator(control="elevon", omega=60.0, zeta=0.7, limit=limit, rate_limit=rate_limit),),
        sensors=(
            Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0)),
            Sensor(name="accelerometer", unit="m_s2", acceleration=(1.0, 0.0)),
        ),
        limits=tuple(Limit(mode=mode, largest=largest) for mode, largest in LOST.items()),
    )


def climb_conditions(points: int = POINTS) -> FlightCondition:
    """Flight conditions along the climb, equally far apart in time.

    Parameters
    ----------
    points : int
        How many.

    Returns
    -------
    conditions : FlightCondition
        Shape (points,). [m/s, kg/m^3]

    References
    ----------
    Bramstång 2015, section 8.4.

    Examples
    --------
    >>> climb_conditions(3).V
    array([ 15. ,  72.5, 130. ])
    """
    profile = climb()
    return profile.condition(np.linspace(0.0, profile.duration, points))


def climb_schedule(model: AeroelasticModel, controller: str, conditions: FlightCondition | None = None) -> Controller:
    """The schedule of the climb, 200 Hz, with the actuator and one sample of delay inside.

    Parameters
    ----------
    model : AeroelasticModel
        Of `climb_model`.
    controller : {"full state", "gyro"}
        LQR on the measured states, or LQG with recovery on the gyro.
    conditions : FlightCondition, optional
        Points of the schedule; those of `climb_conditions` if not given.

    Returns
    -------
    schedule : Controller
        Commands limited as the elevon is. [SI]

    Raises
    ------
    ValueError
        If the controller is another one.

    References
    ----------
    Bramstång 2015, Eq. 6.11 and section 10.3.

    Examples
    --------
    >>> climb_schedule(climb_model(), "gyro", climb_conditions(4)).inputs
    ('gyro_rad_s',)
    """
    if controller not in ("full state", "gyro"):
        raise ValueError(f"controller must be 'full state' or 'gyro', got {controller!r}")
    full = controller == "full state"
    design: Callable[[LinearSystem], Design] = FULL_STATE if full else GYRO_RECOVERY
    sensors = FULL_STATE_SENSORS if full else ("gyro",)
    where = climb_conditions() if conditions is None else conditions
    return design_schedule(
        model, design, where, rate_Hz=RATE_HZ, delay_samples=DELAY_SAMPLES, sensors=sensors
    )  # fmt: skip


def climb_scenario(model: AeroelasticModel, schedule: Controller, adaptation: Adaptation | None = None) -> Scenario:
    """The climb with its weather: Dryden turbulence of 1.83 m/s, a 5 m/s gust of 25 chords every ten seconds.

    Parameters
    ----------
    model : AeroelasticModel
        Whose chord counts.
    schedule : Controller
        What flies it.
    adaptation : Adaptation, optional
        What adapts it.

    Returns
    -------
    scenario : Scenario
        Of 115 s.

    References
    ----------
    Bramstång 2015, sections 8.4 and 9.4.8; equations.md, "Gusts and turbulence".

    Examples
    --------
    >>> len(climb_scenario(climb_model(), climb_schedule(climb_model(), "gyro", climb_conditions(4))).gusts)
    11
    """
    profile = climb()
    starts = np.arange(10.0, profile.duration, 10.0)
    gusts = tuple(CosineGust(amplitude=5.0, length=50.0 * model.aero.b, start=float(t)) for t in starts)
    return Scenario(
        profile=profile,
        duration=profile.duration,
        controller=schedule,
        adaptation=adaptation,
        gusts=gusts,
        turbulence=Gustiness(level=1.83),
    )


def climb_run(
    model: AeroelasticModel, schedule: Controller, *, seed: int = 0, adaptation: Adaptation | None = None
) -> Simulation:
    """One climb, its history sampled at the rate of the controller.

    Parameters
    ----------
    model : AeroelasticModel
        Of `climb_model`.
    schedule : Controller
        Of `climb_schedule`, or any other.
    seed : int
        Of the turbulence.
    adaptation : Adaptation, optional
        Of `control_adaptation`.

    Returns
    -------
    simulation : Simulation
        With its history. [SI]

    References
    ----------
    Bramstång 2015, Figs. 36 and 39.

    Examples
    --------
    >>> model = climb_model()
    >>> climb_run(model, climb_schedule(model, "full state"), seed=1).limit_left is None
    True
    """
    prepared = prepare(model, climb_scenario(model, schedule, adaptation), Stepping(record_s=1.0 / RATE_HZ))
    return run_prepared(prepared, seed=seed)
