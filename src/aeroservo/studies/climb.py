"""The climb of the thesis over many seeds: what each controller reaches, what is lost first and why.

Divergence is at 124 m/s at 3,048 m. Towards it a steady gust moves the wing ever further, 1/(1 - q/q_D): that is how
runs end whose elevon is nowhere near its limits. A gyro feels no steady twist, so it cannot hold a wing there.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from aeroservo.control.adaptive import Adaptation, control_adaptation
from aeroservo.control.controller import Controller
from aeroservo.control.schedule import ScheduleCheck, schedule_check
from aeroservo.datatypes import AeroelasticModel, Array
from aeroservo.simulate.engine import Simulation, run_prepared
from aeroservo.simulate.history import TimeHistory
from aeroservo.simulate.prepare import prepare
from aeroservo.simulate.profiles import Profile
from aeroservo.simulate.scenario import Stepping
from aeroservo.studies.climb_flight import (
    RATE_HZ,
    SURFACES,
    climb_conditions,
    climb_model,
    climb_scenario,
    climb_schedule,
)

LOOK_BACK_S = 0.5
"""Time before a loss over which its cause is looked for. [s]"""


@dataclass(frozen=True, kw_only=True)
class Loss:
    """How one run was lost.

    Attributes
    ----------
    at_s, speed : float
        When, and at what airspeed. [s, m/s]
    channel : str
        What left its bound.
    since_gust_s : float
        Time since the last gust began; infinite before the first. [s]
    at_stop, at_rate : float
        Part of the last half second that the elevon spent at its stop, and at its largest rate. [-]
    """

    at_s: float
    speed: float
    channel: str
    since_gust_s: float
    at_stop: float
    at_rate: float

    @property
    def why(self) -> str:
        """The cause, by what was measured before the end."""
        gust = "in a gust" if self.since_gust_s < 1.5 else "in turbulence"
        what = "pitch" if self.channel.startswith("pitch") else "plunge"
        if self.at_stop > 0.2:
            return f"{what}, elevon at its stop, {gust}"
        if self.at_rate > 0.2:
            return f"{what}, elevon at its largest rate, {gust}"
        return f"{what}, elevon within its limits, {gust}"


@dataclass(frozen=True, kw_only=True, eq=False)
class ClimbRuns:
    """One controller and one elevon over many seeds.

    Attributes
    ----------
    controller : str
        "full state", "gyro" or "adaptive".
    limit, rate_limit : float
        Of the elevon. [rad, rad/s]
    seeds : tuple of int
        Of the turbulence.
    reached : tuple of float
        Airspeed at the end, or at the loss, of each run. [m/s]
    losses : tuple of (Loss or None)
        Of each run; None where it reached the end.
    """

    controller: str
    limit: float
    rate_limit: float
    seeds: tuple[int, ...]
    reached: tuple[float, ...]
    losses: tuple[Loss | None, ...]

    def reaching(self, speed: float) -> int:
        """How many runs reached an airspeed [m/s]. [-]"""
        return int(np.sum(np.array(self.reached) >= speed - 1e-6))

    @property
    def first(self) -> Loss | None:
        """The loss at the lowest airspeed, None where there is none."""
        return min((x for x in self.losses if x is not None), key=lambda x: x.speed, default=None)

    @property
    def reasons(self) -> tuple[tuple[str, int], ...]:
        """Why runs were lost and how many for each reason, the most frequent first."""
        return tuple(Counter(x.why for x in self.losses if x is not None).most_common())


@dataclass(frozen=True, kw_only=True, eq=False)
class ClimbStudy:
    """The climb with every controller and elevon.

    Attributes
    ----------
    runs : tuple of ClimbRuns
        Full state, gyro, adaptive; for each elevon.
    checks : tuple of (str, ScheduleCheck)
        Frozen stability of the schedules along the climb, at their points and four conditions between each.
    """

    runs: tuple[ClimbRuns, ...]
    checks: tuple[tuple[str, ScheduleCheck], ...]


def climb_runs(
    model: AeroelasticModel,
    schedule: Controller,
    *,
    name: str,
    seeds: Sequence[int] = range(20),
    adaptation: Adaptation | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> ClimbRuns:
    """Climbs over seeds with one controller and elevon.

    Parameters
    ----------
    model : AeroelasticModel
        Of `climb_model`.
    schedule : Controller
        What flies it.
    name : str
        What to call it.
    seeds : sequence of int
        Of the turbulence.
    adaptation : Adaptation, optional
        What adapts the schedule.
    progress : callable, optional
        Called with runs done and runs in all.

    Returns
    -------
    runs : ClimbRuns
        What each reached, and how it was lost.

    References
    ----------
    Bramstång 2015, section 9.4.8.

    Examples
    --------
    >>> model = climb_model()
    >>> climb_runs(model, climb_schedule(model, "full state"), name="full state", seeds=[0]).reached
    (130.0,)
    """
    scenario = climb_scenario(model, schedule, adaptation)
    prepared = prepare(model, scenario, Stepping(record_s=1.0 / RATE_HZ))
    actuator = model.actuators[0]
    limit, rate_limit = actuator.limit or math.inf, actuator.rate_limit or math.inf
    reached, losses = [], []
    for done, seed in enumerate(seeds, 1):
        run = run_prepared(prepared, seed=seed)
        reached.append(float(scenario.profile.speed(run.duration)))
        losses.append(_loss(run, scenario.profile, limit, rate_limit))
        if progress is not None:
            progress(done, len(seeds))
    return ClimbRuns(
        controller=name,
        limit=limit,
        rate_limit=rate_limit,
        seeds=tuple(seeds),
        reached=tuple(reached),
        losses=tuple(losses),
    )


def climb_study(seeds: Sequence[int] = range(20), *, progress: Callable[[int, int], None] | None = None) -> ClimbStudy:
    """Full state, gyro and adaptive schedules over the same seeds, with both elevons.

    Parameters
    ----------
    seeds : sequence of int
        Of the turbulence.
    progress : callable, optional
        Called with runs done and runs in all.

    Returns
    -------
    study : ClimbStudy
        Every number of it.

    References
    ----------
    Bramstång 2015, sections 9.4.5, 9.4.8 and 10.3.

    Examples
    --------
    >>> [runs.controller for runs in climb_study(seeds=[0]).runs[:3]]
    ['full state', 'gyro', 'adaptive']
    """
    runs: list[ClimbRuns] = []
    checks: list[tuple[str, ScheduleCheck]] = []
    total = 3 * len(SURFACES) * len(seeds)
    conditions = climb_conditions()
    for limit, rate_limit in SURFACES:
        model = climb_model(limit, rate_limit)
        schedules = {name: climb_schedule(model, name, conditions) for name in ("full state", "gyro")}
        if not checks:
            checks = [(name, schedule_check(model, c, conditions)) for name, c in schedules.items()]
        plan: list[tuple[str, Controller, Adaptation | None]] = [(n, c, None) for n, c in schedules.items()]
        full = schedules["full state"]
        plan.append(("adaptive", full, control_adaptation(model, full, conditions)))
        for name, schedule, adaptation in plan:
            before = sum(len(r.seeds) for r in runs)

            def told(done: int, _: int, before: int = before) -> None:
                if progress is not None:
                    progress(before + done, total)

            runs.append(climb_runs(model, schedule, name=name, seeds=seeds, adaptation=adaptation, progress=told))
    return ClimbStudy(runs=tuple(runs), checks=tuple(checks))


def _loss(run: Simulation, profile: Profile, limit: float, rate_limit: float) -> Loss | None:
    """How a run was lost, by its last half second."""
    if run.limit_left is None and run.overflow_at is None:
        return None
    history = run.history
    assert history is not None
    at = run.duration
    last = history.between(at - LOOK_BACK_S, at)
    gusts = np.arange(10.0, profile.duration, 10.0)
    met = gusts[gusts <= at]
    return Loss(
        at_s=at,
        speed=float(profile.speed(at)),
        channel=run.limit_left.channel if run.limit_left is not None else "overflow",
        since_gust_s=float(at - met[-1]) if len(met) else math.inf,
        at_stop=float(np.mean(np.abs(last["elevon_rad"]) >= 0.999 * limit)),
        at_rate=float(np.mean(_rates(last) >= 0.95 * rate_limit)),
    )


def _rates(history: TimeHistory) -> Array:
    """Mean rate of the elevon between samples. [rad/s]"""
    return np.abs(np.diff(history["elevon_rad"]) / np.diff(history.t))
