"""The engine: time histories of any aeroelastic model in closed loop, along a flight, in weather.

A base grid (1 ms unless asked otherwise, a whole part of the controller's sample) carries everything that is held:
commands, noise, turbulence, edges. The plant is stepped inside each base step, by the matrix exponential where it is
linear and its flight does not change, else by the classical Runge-Kutta method with as many substeps as its fastest
mode needs, checked by halving. What is held stays held when the step is halved.

It is a small-perturbation model: large rigid-body motion is outside it. Airspeed may change, slowly against the modes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from aeroservo.datatypes import AeroelasticModel, Array, LinearSystem
from aeroservo.simulate.history import Event, TimeHistory
from aeroservo.simulate.identify import LimitCycle
from aeroservo.simulate.outcome import LimitLeft, Outcome, judge
from aeroservo.simulate.prepare import prepare
from aeroservo.simulate.profiles import Profile
from aeroservo.simulate.scenario import Prepared, Scenario, Stepping
from aeroservo.simulate.state import RunState

PIECE = 20_000
"""Base steps computed in one call: memory does not grow with the run."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Simulation:
    """A run.

    Attributes
    ----------
    history : TimeHistory or None
        Channels, from the equilibrium at the start; None where none was wanted.
    channels : tuple of str
        Names of `peak` and `rms`.
    peak, rms : ndarray, shape (n_channel,)
        Largest magnitude and root mean square at base steps. [unit of each channel]
    duration : float
        Time that was computed: less than asked for after a limit or an overflow. [s]
    bounded : bool
        Neither a limit left nor overflow, and not growing at the end.
    growth : float or None
        Of the envelope of the free response; None under noise, turbulence or a changing flight. [1/s]
    limit_cycle : LimitCycle or None
        A steady oscillation at the end, of pitch, else of the first coordinate.
    limit_left : LimitLeft or None
        The limit that ended the run.
    overflow_at : float or None
        When numbers ran away. [s]
    equilibrium : ndarray, shape (n_x,)
        State at rest at the start. [SI]
    method : str
        "exact" or "rk4".
    dt : float
        Base step. [s]
    substeps : int
        Runge-Kutta steps in a base step.
    halving : float or None
        Difference found by the halving check; None where there was none. [-]
    warnings : tuple of str
        What to know.
    adaptation : TimeHistory or None
        What an adaptation said at each sample of the controller: effects, their errors, gain, identified (1 or 0).
    """

    history: TimeHistory | None
    channels: tuple[str, ...]
    peak: Array
    rms: Array
    duration: float
    bounded: bool
    growth: float | None
    limit_cycle: LimitCycle | None
    limit_left: LimitLeft | None
    overflow_at: float | None
    equilibrium: Array
    method: str
    dt: float
    substeps: int
    halving: float | None
    warnings: tuple[str, ...]
    adaptation: TimeHistory | None = None


def simulate(
    model: AeroelasticModel | LinearSystem,
    scenario: Scenario,
    *,
    seed: int = 0,
    stepping: Stepping = Stepping(),  # noqa: B008 - frozen
    progress: Callable[[float], None] | None = None,
) -> Simulation:
    """Run a scenario.

    Parameters
    ----------
    model : AeroelasticModel or LinearSystem
        With rational air forces; a linear system holds at its own condition whatever the profile says.
    scenario : Scenario
        What happens.
    seed : int
        Of turbulence and sensor noise: the same seed gives the same run, whatever the pieces or the workers.
    stepping : Stepping
        How.
    progress : callable, optional
        Called with the time reached [s], a few times a second or less.

    Returns
    -------
    simulation : Simulation
        Histories and what they show. [SI]

    Raises
    ------
    ValueError
        If the model has no state space, a name is unknown, or the method does not fit the model.
    """
    return run_prepared(prepare(model, scenario, stepping), seed=seed, progress=progress)


def run_prepared(prepared: Prepared, *, seed: int = 0, progress: Callable[[float], None] | None = None) -> Simulation:
    """Run a prepared scenario with a seed.

    Parameters
    ----------
    prepared : Prepared
        Of `prepare`.
    seed : int
        Of turbulence and sensor noise.
    progress : callable, optional
        Called with the time reached. [s]

    Returns
    -------
    simulation : Simulation
        As `simulate`. [SI]
    """
    p, names = prepared, prepared.stepper.outputs
    total = p.steps + 1
    stepping = p.stepping
    every = max(1, round(stepping.record_s / p.dt) if stepping.record_s else -(-total // 20_000))
    state = RunState(p, seed)
    records, done, code, row = [], 0, 0, -1
    piece = max(1, PIECE // p.per_knot) * p.per_knot  # knots fall on the same times whatever the pieces
    while done < total and code == 0:
        n = min(piece, total - done)
        record = np.zeros((n // every + 1 if stepping.history else 0, len(names)))
        code, steps, written, row = state.advance(done, n, every, record, np.zeros((0, 0)))
        records.append(record[:written])
        done += steps
        if progress is not None:
            progress(done * p.dt)
    data = np.concatenate(records) if stepping.history else None
    return _result(p, state, done if code else p.steps, code, row, data, every)


def _result(p: Prepared, state: RunState, done: int, code: int, row: int, data: Any, every: int) -> Simulation:
    """Statistics, history and judgement of a finished run."""
    s, profile = p.stepper, p.scenario.profile
    at = done * p.dt
    count = np.maximum(state.statistics[3], 1.0)
    peak, rms = state.statistics[0], np.sqrt(state.statistics[2] / count)
    names, extra = list(s.outputs), _flight(profile)
    grid = np.linspace(0.0, max(at, p.dt), 2001)
    for name, values in extra:
        names.append(name)
        peak, rms = np.append(peak, np.abs(values(grid)).max()), np.append(rms, np.sqrt(np.mean(values(grid) ** 2)))
    left = LimitLeft(channel=s.outputs[row], at_s=at) if code == 1 else None
    events = []
    if left is not None:
        events.append(Event(t=at, text=f"{left.channel} left its limit"))
    if code == 2:
        events.append(Event(t=at, text=f"overflow of {s.states[row]}"))
    history = None
    if data is not None:
        t = p.dt * every * np.arange(len(data))
        columns = [data, *(values(t)[:, None] for _, values in extra)]
        history = TimeHistory(t=t, data=np.concatenate(columns, axis=1), channels=tuple(names), events=tuple(events))
    noisy = p.scenario.turbulence is not None or bool(np.any(state.noise)) or profile.moving
    told = _adaptation(p, state, at)
    outcome = Outcome(growth=None, limit_cycle=None, bounded=code == 0)
    if history is not None:
        outcome = judge(history, s, p.scenario, failed=code != 0, noisy=noisy)
    return Simulation(
        history=history,
        channels=tuple(names),
        peak=peak,
        rms=rms,
        duration=at,
        bounded=outcome.bounded,
        growth=outcome.growth,
        limit_cycle=outcome.limit_cycle,
        limit_left=left,
        overflow_at=at if code == 2 else None,
        equilibrium=s.equilibrium,
        method="exact" if p.exact[0].size else "rk4",
        dt=p.dt,
        substeps=p.substeps,
        halving=p.halving,
        warnings=(*p.warnings, *_unidentified(told)),
        adaptation=told,
    )


def _adaptation(p: Prepared, state: RunState, at: float) -> TimeHistory | None:
    """What the adaptation said at each sample until the end."""
    a = p.scenario.adaptation
    if a is None or not state.theta.size:
        return None
    step = p.dt * p.period
    data = np.concatenate(state.adapted)[: int(at / step + 1e-6) + 1]
    return TimeHistory(t=step * np.arange(len(data)), data=data, channels=a.channels)


def _unidentified(told: TimeHistory | None) -> tuple[str, ...]:
    """What the supervisor of an adaptation has to say at the end."""
    if told is None or np.all(told["identified"]):
        return ()
    part = 100.0 * float(np.mean(told["identified"] == 0.0))
    return (
        f"the effect of the controls was not identifiable during {part:.3g} % of the run: the schedule flew as it is",
    )


def _flight(profile: Profile) -> list[tuple[str, Callable[[Array], Array]]]:
    """Channels that are known beforehand."""
    flight: list[tuple[str, Callable[[Array], Array]]] = [("speed_m_s", profile.speed)]
    altitude = profile.altitude
    if altitude is not None:
        flight.append(("altitude_m", lambda t: np.interp(t, profile.t, altitude)))
    return flight


def linearised(model: AeroelasticModel) -> AeroelasticModel:
    """The same model without its nonlinear springs, stall and weight: what linear analyses see.

    Parameters
    ----------
    model : AeroelasticModel
        Any.

    Returns
    -------
    model : AeroelasticModel
        Its limits and actuators as they were.
    """
    return replace(model, springs=(), lift_curve=None, gravity=None)
