"""What a run shows: whether it stays bounded, how fast it grows, whether it ends in a limit cycle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from aeroservo.simulate._kernels import COSINE
from aeroservo.simulate.assemble import Stepper
from aeroservo.simulate.disturbances import CosineGust
from aeroservo.simulate.history import TimeHistory
from aeroservo.simulate.identify import LimitCycle, envelope_growth, limit_cycle, pencil_growth

if TYPE_CHECKING:
    from aeroservo.simulate.scenario import Scenario

GROWING = 1e-3
"""Growth below this part of a radian per second of the oscillation counts as none. [1/s]"""


@dataclass(frozen=True, kw_only=True)
class LimitLeft:
    """The limit that ended a run.

    Attributes
    ----------
    channel : str
        Which.
    at_s : float
        When. [s]
    """

    channel: str
    at_s: float


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """Judgement of a run.

    Attributes
    ----------
    bounded : bool
        Neither failed nor growing at the end.
    growth : float or None
        Of the envelope of the free response. [1/s]
    limit_cycle : LimitCycle or None
        Steady oscillation at the end.
    """

    bounded: bool
    growth: float | None
    limit_cycle: LimitCycle | None


def judge(history: TimeHistory, s: Stepper, scenario: Scenario, *, failed: bool, noisy: bool) -> Outcome:
    """Growth, limit cycle and boundedness of a history.

    Growth is that of the exponential that dominates the end of the free response, or of its envelope where it is no sum
    of exponentials. A run without noise, in a flight that does not change, is bounded if its free response does not
    grow or ends in a limit cycle; any other if the last fifth of it reaches no more than three times what came before.

    Parameters
    ----------
    history : TimeHistory
        The run.
    s : Stepper
        Names; whether the model is nonlinear.
    scenario : Scenario
        When the disturbances end.
    failed : bool
        Whether a limit was left or numbers ran away.
    noisy : bool
        Whether turbulence, noise or a changing flight leave no free response.

    Returns
    -------
    outcome : Outcome
        Growth. [1/s]
    """
    channel = main_channel(s)
    y = history[channel]
    if noisy:
        cut = 4 * len(y) // 5
        before, after = np.abs(y[:cut]).max(initial=0.0), np.abs(y[cut:]).max(initial=0.0)
        return Outcome(bounded=not failed and bool(after <= 3.0 * before), growth=None, limit_cycle=None)
    free = history.t >= quiet_from(scenario)
    rate = _rate_channel(s, channel)
    growth = None
    if np.count_nonzero(free) > 16:
        t, v = history.t[free], history[rate][free]
        loud = np.flatnonzero(np.abs(v) > 1e-8 * np.abs(v).max(initial=0.0))
        if loud.size:
            t, v = t[: loud[-1] + 1], v[: loud[-1] + 1]
            half = len(t) // 2
            growth = pencil_growth(t[half:], v[half:])
            if growth is None:
                growth = envelope_growth(t, v)
    cycle = None
    if not failed and np.any(s.elements.kinds != COSINE) and np.count_nonzero(free) > 64:
        cycle = limit_cycle(history.t[free], y[free])
        scale = np.abs(y).max(initial=0.0)
        if cycle is not None and not cycle.amplitude > 1e-9 * max(scale, 1e-300):
            cycle = None
    grows = growth is not None and growth > GROWING and cycle is None
    return Outcome(bounded=not failed and not grows, growth=growth, limit_cycle=cycle)


def main_channel(s: Stepper) -> str:
    """Pitch where there is one, else the first output.

    Parameters
    ----------
    s : Stepper
        Names.

    Returns
    -------
    channel : str
        The channel that growth and limit cycles are read from.
    """
    return "pitch_rad" if "pitch_rad" in s.outputs else s.outputs[0]


def quiet_from(scenario: Scenario) -> float:
    """When the last disturbance ends.

    Parameters
    ----------
    scenario : Scenario
        Gusts and doublets.

    Returns
    -------
    t : float
        Start of the free response; a sharp edge ends when it begins. [s]
    """
    ends = [0.0]
    for gust in scenario.gusts:
        if isinstance(gust, CosineGust):
            ends.append(gust.start + 1.05 * gust.length / float(scenario.profile.speed(gust.start)))
        else:
            ends.append(gust.start)
    ends += [d.start + d.duration for d in scenario.doublets]
    return max(ends)


def _rate_channel(s: Stepper, channel: str) -> str:
    """Rate of a coordinate: it has no mean, wherever the coordinate comes to rest."""
    stem, _, unit = channel.rpartition("_")
    for rate in (f"{stem}_rate_{unit}_s", f"{channel}_rate_1_s"):
        if rate in s.outputs:
            return rate
    return channel
