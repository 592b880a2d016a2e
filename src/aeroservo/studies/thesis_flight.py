"""Chapter 9.4 of the thesis again: the wing on springs flown with and without control, level and in a climb."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from aeroservo.aircraft.files import read
from aeroservo.control.adaptive import control_adaptation
from aeroservo.control.controller import Controller, state_feedback
from aeroservo.control.schedule import ScheduleCheck, schedule_check
from aeroservo.control.zeros import ZeroCurve, zeros_against_speed
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition
from aeroservo.servo import Limit
from aeroservo.simulate.disturbances import CosineGust, Gustiness, SharpGust
from aeroservo.simulate.engine import Simulation, simulate
from aeroservo.simulate.profiles import Profile, climb, level
from aeroservo.simulate.scenario import Scenario, Stepping
from aeroservo.studies.climb import climb_runs
from aeroservo.studies.climb_flight import climb_conditions, climb_model, climb_run, climb_scenario, climb_schedule
from aeroservo.studies.thesis_gains import (
    CHECKED_SPEEDS,
    DESIGN_SPEED,
    HIGH,
    STATES,
    SWITCH_SPEED,
    bare_wing,
    elevon_effect,
    gain_at,
    growth_with_gains,
    lost_at,
    poles_and_zeros,
    root_with_servo,
    thesis_switch,
)

MACH = {"lqr": 0.172, "manual": 0.3, "poles": 0.15}
"""Of Figures 34, 38 and 40. [-]"""
TURBULENCE, GUST, CHORD = 1.83, 5.0, 0.53
"""RMS of light turbulence [m/s], discrete gusts [m/s], mean chord [m]."""
SEEDS = range(10)


@dataclass(frozen=True, kw_only=True, eq=False)
class Climbed:
    """A climb in gusts and turbulence, several seeds.

    Attributes
    ----------
    first : Simulation
        Of seed 0.
    reached : tuple of float
        Speed at which each seed was lost; the last speed of the climb where it was not. [m/s]
    lost : tuple of str or None
        The channel that left its limit, or why.
    """

    first: Simulation
    reached: tuple[float, ...]
    lost: tuple[str | None, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Flight:
    """Everything that chapter 9.4 rests on; 10,000 ft unless told.

    Attributes
    ----------
    speed : dict of str to float
        True airspeeds of the figures' Mach numbers. [m/s]
    gain : ndarray, shape (1, 4)
        The LQR gain at 55 m/s. [SI]
    lost : dict of float to float
        Speed at which that gain is lost, by altitude [m]. [m/s]
    lost_root : complex
        The root that crosses, at 10,000 ft. [1/s]
    V : ndarray, shape (n,)
        Speeds of the next three. [m/s]
    gains : ndarray, shape (n, 4)
        LQR gains designed at each speed. [SI]
    growth : dict of str to ndarray, shape (n,)
        Largest real part: "open", "designed here", "gain of 55 m/s", "that gain reversed", "designed here, reversed".
        [1/s]
    servo_root : complex
        Fastest growing root of the gain of 55 m/s with the servo inside, at its own design point. [1/s]
    lattice_reversal : dict of float to float
        Lift reversal with the lattice's CM_delta, by altitude [m]. [m/s]
    effect : dict of str to ndarray, shape (n,)
        Lift [N/rad] and moments [N m/rad] per elevon angle, pitch relieved by its spring.
    runs : dict of str to Simulation
        Of the figures.
    peaks : dict of str to ndarray, shape (n_seed, 3)
        Largest plunge up and down [m] and pitch [rad] in turbulence with "lqr" and "schedule".
    climbs : dict of str to Climbed
        "lqr", "lqr level", "switch" as the thesis flies; "schedule", "gyro", "adaptive" with a servo.
    check, check_low : ScheduleCheck
        Frozen stability of the schedule at 10,000 ft and, to the same dynamic pressure, at sea level.
    switch_check : ScheduleCheck
        Of the switch.
    poles : complex ndarray, shape (4,)
        Of the closed loop of Figure 40. [1/s]
    zeros : dict of str to complex ndarray, shape (n,)
        From the elevon to plunge and pitch there. [1/s]
    zero_curves : tuple of ZeroCurve
        To plunge, pitch and pitch rate against speed.
    """

    speed: dict[str, float]
    gain: Array
    lost: dict[float, float]
    lost_root: complex
    V: Array
    gains: Array
    growth: dict[str, Array]
    servo_root: complex
    lattice_reversal: dict[float, float]
    effect: dict[str, Array]
    runs: dict[str, Simulation]
    peaks: dict[str, Array]
    climbs: dict[str, Climbed]
    check: ScheduleCheck
    check_low: ScheduleCheck
    switch_check: ScheduleCheck
    poles: Array
    zeros: dict[str, Array]
    zero_curves: tuple[ZeroCurve, ...]


def thesis_flight(*, seeds: range = SEEDS, progress: Callable[[str], None] | None = None) -> Flight:
    """Fly the thesis' chapter 9.4 again.

    Parameters
    ----------
    seeds : range
        Of the climbs.
    progress : callable, optional
        Told in words what comes next.

    Returns
    -------
    flight : Flight
        Runs and numbers. [SI]

    References
    ----------
    Bramstång 2015, sections 8.4 and 9.4, Figures 33-40.
    """
    say = progress or (lambda words: None)
    say("control: gains, roots, zeros")
    model, servo = bare_wing(), climb_model()
    sound = float(FlightCondition.at(HIGH, V=1.0).a_sound or np.nan)
    speed = {name: mach * sound for name, mach in MACH.items()}
    gain = gain_at(model, DESIGN_SPEED)
    lost, root = {}, 0j
    for altitude in (HIGH, 0.0):
        lost[altitude], crossing = lost_at(model, gain, altitude)
        root = crossing if altitude == HIGH else root
    V = np.arange(15.0, 123.01, 0.5)
    schedule = climb_schedule(servo, "full state")
    switch = thesis_switch(model, speed["manual"])
    condition, low = FlightCondition.at(HIGH, V=CHECKED_SPEEDS), FlightCondition.at(0.0, V=1.0)
    same_pressure = FlightCondition.at(0.0, V=np.sqrt(2.0 * condition.q / low.rho))
    other = float(read("thesis-simulation").derived()["comparison_lift_reversal_pressure_Pa"])
    say("time histories with and without control")
    runs, peaks = _runs(model, servo, gain, schedule, switch, speed)
    climbs = {}
    feedback = state_feedback(gain, STATES, ("elevon_rad",), None)
    for name, wing, controller, profile in (
        ("lqr", model, feedback, climb()),
        ("lqr level", model, feedback, climb(altitude=(HIGH, HIGH))),
        ("switch", model, switch, climb()),
    ):
        say(f"climbs: {name}")
        climbs[name] = climbed(wing, controller, profile, seeds)
    climbs |= _scheduled(servo, seeds, say)
    K, growth = growth_with_gains(model, gain, V)
    poles, zeros = poles_and_zeros(model, gain, speed["poles"])
    return Flight(
        speed=speed, gain=gain, lost=lost, lost_root=root, V=V, gains=K, growth=growth,
        servo_root=root_with_servo(gain),
        lattice_reversal={h: float(np.sqrt(2.0 * other / FlightCondition.at(h, V=1.0).rho)) for h in (HIGH, 0.0)},
        effect=elevon_effect(V), runs=runs, peaks=peaks, climbs=climbs,
        check=schedule_check(servo, schedule, condition),
        check_low=schedule_check(servo, schedule, same_pressure),
        switch_check=schedule_check(model, switch, condition), poles=poles, zeros=zeros,
        zero_curves=zeros_against_speed(
            model, FlightCondition.at(HIGH, V=V), sensors=("plunge_m", "pitch_rad", "pitch_rate_rad_s"), actuators=False
        ),
    )  # fmt: skip


def climbed(model: AeroelasticModel, controller: Controller, profile: Profile, seeds: range) -> Climbed:
    """Fly a profile in the weather of the climb: turbulence and a gust every 10 s.

    Parameters
    ----------
    model : AeroelasticModel
        The wing, with its limits.
    controller : Controller
        Closes the loop.
    profile : Profile
        Airspeed and altitude.
    seeds : range
        Of the turbulence.

    Returns
    -------
    climbed : Climbed
        Seed 0 with its history, the others by how far they came.
    """
    scenario = replace(climb_scenario(model, controller), profile=profile, duration=profile.duration)
    first = None
    reached: list[float] = []
    lost: list[str | None] = []
    for seed in seeds:
        run = simulate(model, scenario, seed=seed, stepping=Stepping(record_s=0.01, history=first is None))
        first = first or run
        reached.append(float(profile.speed(run.duration)))
        lost.append(None if run.limit_left is None else run.limit_left.channel)
    assert first is not None
    return Climbed(first=first, reached=tuple(reached), lost=tuple(lost))


def _scheduled(model: AeroelasticModel, seeds: range, say: Callable[[str], None]) -> dict[str, Climbed]:
    """Climbs of the servo's schedules: full state, gyro alone, and the first with adaptation."""
    conditions = climb_conditions()
    full, gyro = (climb_schedule(model, name, conditions) for name in ("full state", "gyro"))
    found = {}
    for name, schedule, adaptation in (
        ("schedule", full, None),
        ("gyro", gyro, None),
        ("adaptive", full, control_adaptation(model, full, conditions)),
    ):
        say(f"climbs: {name}")
        runs = climb_runs(model, schedule, name=name, seeds=seeds, adaptation=adaptation)
        first = climb_run(model, schedule, seed=seeds[0], adaptation=adaptation)
        lost = tuple(None if loss is None else loss.why for loss in runs.losses)
        found[name] = Climbed(first=first, reached=runs.reached, lost=lost)
    return found


def _runs(
    model: AeroelasticModel,
    servo: AeroelasticModel,
    gain: Array,
    schedule: Controller,
    switch: Controller,
    speed: dict[str, float],
) -> tuple[dict[str, Simulation], dict[str, Array]]:
    """Level flights of Figures 33 to 35 and 38, and the fluctuating airspeed of section 10.3."""
    here, fast = level(speed["lqr"], altitude=HIGH), level(speed["manual"], altitude=HIGH)
    lqr = state_feedback(gain, STATES, ("elevon_rad",), None)
    lqr_servo = state_feedback(gain, STATES, ("elevon_command_rad",), None)
    wind = Gustiness(level=TURBULENCE)
    pulse = (CosineGust(amplitude=GUST, length=25.0 * CHORD, start=10.0),)
    early = (CosineGust(amplitude=GUST, length=25.0 * CHORD, start=5.0),)
    step = (SharpGust(amplitude=GUST, start=10.0),)
    start = (("pitch_rad", 0.01),)
    t = np.arange(0.0, 30.01, 0.1)
    sine = Profile(t=t, V=SWITCH_SPEED + 3.0 * np.sin(0.4 * np.pi * t), altitude=np.full(t.shape, HIGH))
    half_turn = (Limit(mode="pitch", largest=math.pi),)
    free, driven = replace(model, limits=half_turn), replace(servo, limits=half_turn)
    keep = Stepping(record_s=0.01)
    flown: dict[str, tuple[AeroelasticModel, Scenario]] = {
        "free": (free, Scenario(profile=here, duration=20.0, initial=start)),
        "cosine": (free, Scenario(profile=here, duration=20.0, controller=lqr, gusts=pulse)),
        "sharp": (free, Scenario(profile=here, duration=20.0, controller=lqr, gusts=step)),
        "servo": (driven, Scenario(profile=here, duration=20.0, controller=lqr_servo, initial=start)),
        "schedule": (driven, Scenario(profile=here, duration=20.0, controller=schedule, gusts=pulse)),
        "manual": (driven, Scenario(profile=fast, duration=20.0, controller=schedule, gusts=early, turbulence=wind)),
        "sine": (model, Scenario(profile=sine, duration=30.0, controller=switch, turbulence=wind)),
    }
    runs = {name: simulate(wing, scenario, stepping=keep) for name, (wing, scenario) in flown.items()}
    peaks = {}
    for name, wing, controller in (("lqr", free, lqr), ("schedule", driven, schedule)):
        found = []
        for seed in range(5):
            scenario = Scenario(profile=here, duration=20.0, controller=controller, turbulence=wind)
            run = simulate(wing, scenario, seed=seed, stepping=keep)
            assert run.history is not None
            plunge, pitch = run.history["plunge_m"], run.history["pitch_rad"]
            found.append((-plunge.min(), plunge.max(), np.abs(pitch).max()))
            if seed == 0:
                runs[f"turbulence, {name}"] = run
        peaks[name] = np.array(found)
    return runs, peaks
