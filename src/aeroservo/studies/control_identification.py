"""How well the effect of the elevon is identified in flight: estimates against an aircraft that is not as its model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from aeroservo.control.adaptive import control_adaptation
from aeroservo.datatypes import Array, FlightCondition, frozen
from aeroservo.simulate.disturbances import Gustiness
from aeroservo.simulate.engine import run_prepared
from aeroservo.simulate.prepare import prepare
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario, Stepping
from aeroservo.studies.climb_flight import climb_model, climb_schedule

ALTITUDE = 3048.0
"""Where the aircraft flies. [m]"""

ACTUAL = ((1.0, 1.0), (0.7, 0.7), (0.7, 1.3))
"""Lift and moment of the elevon, as parts of the model's. [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class IdentificationStudy:
    """Estimates at the end of runs that begin with the model's values.

    Attributes
    ----------
    speeds : ndarray, shape (n_V,)
        True airspeeds. [m/s]
    seeds : tuple of int
        Of the turbulence.
    actual : ndarray, shape (n_a, 2)
        Lift and moment per elevon that the aircraft has, as parts of the model's. [-]
    estimate, stated : ndarray, shape (n_a, n_V, n_seed, 2)
        Estimates, and the standard deviations that go with them, as parts of the model's. [-]
    identified : bool ndarray, shape (n_a, n_V, n_seed)
        What the supervisor said. [-]
    gain : ndarray, shape (n_a, n_V, n_seed)
        Of the schedule at the end. [-]
    largest_pitch : ndarray, shape (n_a, n_V, n_seed)
        Largest pitch of each run. [rad]
    lost : int
        Runs that left the bounds of the climb. [-]
    """

    speeds: Array
    seeds: tuple[int, ...]
    actual: Array
    estimate: Array
    stated: Array
    identified: Array
    gain: Array
    largest_pitch: Array
    lost: int

    def __post_init__(self) -> None:
        """Lock the arrays."""
        for name in ("speeds", "actual", "estimate", "stated", "gain", "largest_pitch"):
            object.__setattr__(self, name, frozen(getattr(self, name), name=name))
        object.__setattr__(self, "identified", frozen(self.identified, dtype=bool, name="identified"))

    @property
    def error(self) -> Array:
        """Error of every estimate, part of the actual value, shape (n_a, n_V, n_seed, 2). [-]"""
        return np.asarray(self.estimate / self.actual[:, None, None, :] - 1.0)


def identification_study(
    speeds: Sequence[float] = (40.0, 53.0, 70.0),
    seeds: Sequence[int] = range(20),
    *,
    actual: Sequence[tuple[float, float]] = ACTUAL,
    turbulence: float | None = None,
    dither: float = math.radians(3.0),
    duration: float = 5.0,
) -> IdentificationStudy:
    """Fly straight in light turbulence, the full-state schedule adapting, and compare the estimates with what flies.

    Parameters
    ----------
    speeds : sequence of float
        True airspeeds, at 3,048 m. [m/s]
    seeds : sequence of int
        Of the turbulence.
    actual : sequence of (float, float)
        Lift and moment per elevon of the aircraft, as parts of the model's. [-]
    turbulence : float, optional
        RMS; light of the tables at that height if not given, none at 0. [m/s]
    dither : float
        Amplitude of the oscillation that the identification may add. [rad]
    duration : float
        Of each run. [s]

    Returns
    -------
    study : IdentificationStudy
        Every estimate.

    References
    ----------
    Bramstång 2015, sections 6.4.1 and 10.3.

    Examples
    --------
    >>> study = identification_study([53.0], [0], actual=[(1.0, 1.0)])
    >>> bool(np.abs(study.error).max() < 0.1)
    True
    """
    model = climb_model()
    conditions = FlightCondition.at(ALTITUDE, V=np.linspace(15.0, 130.0, 40))
    schedule = climb_schedule(model, "full state", conditions)
    adaptation = control_adaptation(model, schedule, conditions, dither=dither)
    weather = Gustiness(level="light" if turbulence is None else turbulence)
    shape = (len(actual), len(speeds), len(seeds))
    found = {name: np.zeros((*shape, 2)) for name in ("estimate", "stated")}
    identified, gain, pitch, lost = np.zeros(shape, bool), np.zeros(shape), np.zeros(shape), 0
    for a, (lift, moment) in enumerate(actual):
        aircraft = climb_model(lift_effect=lift, moment_effect=moment)
        for v, V in enumerate(speeds):
            scenario = Scenario(
                profile=level(V, altitude=ALTITUDE), duration=duration, controller=schedule, adaptation=adaptation,
                turbulence=weather,
            )  # fmt: skip
            prepared = prepare(aircraft, scenario, Stepping(record_s=0.05))
            for s, seed in enumerate(seeds):
                run = run_prepared(prepared, seed=seed)
                assert run.adaptation is not None
                last = run.adaptation.data[-1]
                found["estimate"][a, v, s], found["stated"][a, v, s] = last[:2], last[2:4]
                gain[a, v, s], identified[a, v, s] = last[4], last[5] > 0.5
                pitch[a, v, s] = run.peak[run.channels.index("pitch_rad")]
                lost += run.limit_left is not None
    return IdentificationStudy(
        speeds=np.array(speeds, dtype=float), seeds=tuple(seeds), actual=np.array(actual), identified=identified,
        gain=gain, largest_pitch=pitch, lost=lost, **found,
    )  # fmt: skip


def unexcited_estimate(V: float = 53.0, *, duration: float = 20.0) -> tuple[float, Array]:
    """Still air and no oscillation: part of the time in which the supervisor calls the effects identified, and gains.

    Parameters
    ----------
    V : float
        True airspeed at 3,048 m. [m/s]
    duration : float
        Length of the run. [s]

    Returns
    -------
    identified : float
        Part of the samples. [-]
    gains : ndarray, shape (2,)
        Least and largest gain: 1 where the schedule flies as it is. [-]

    References
    ----------
    Bramstång 2015, section 10.3; K. J. Åström and B. Wittenmark, Adaptive Control, 1995, section 2.4 (excitation).

    Examples
    --------
    >>> unexcited_estimate(duration=3.0)[0]
    0.0
    """
    model = climb_model()
    conditions = FlightCondition.at(ALTITUDE, V=np.linspace(15.0, 130.0, 40))
    schedule = climb_schedule(model, "full state", conditions)
    adaptation = control_adaptation(model, schedule, conditions, dither=0.0)
    scenario = Scenario(
        profile=level(V, altitude=ALTITUDE), duration=duration, controller=schedule, adaptation=adaptation,
        initial=(("pitch_rad", 0.001),),
    )  # fmt: skip
    run = run_prepared(prepare(model, scenario, Stepping(record_s=0.05)))
    assert run.adaptation is not None
    gain = run.adaptation["gain"]
    return float(run.adaptation["identified"].mean()), np.array([gain.min(), gain.max()])
