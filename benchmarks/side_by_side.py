"""What every benchmark is made of: two things timed in turns, and a row that says how they compare."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import NamedTuple


class Skipped(Exception):
    """A benchmark that cannot run here; the text says why."""


class Row(NamedTuple):
    """One comparison.

    Attributes
    ----------
    name : str
        What was compared with what.
    own_s, peer_s : float
        Median time of ours and of the peer's (or of the physical limit). [s]
    target : float
        Largest ratio that keeps the promise. [-]
    accuracy : str
        How far each side's answer is off, or how far they are apart; "" where both do the same arithmetic.
    """

    name: str
    own_s: float
    peer_s: float
    target: float
    accuracy: str = ""

    @property
    def ratio(self) -> float:
        """Our time over the peer's; at most `target` keeps the promise. [-]"""
        return self.own_s / self.peer_s

    @property
    def met(self) -> bool:
        """Whether the target is met."""
        return self.ratio <= self.target


def compare(
    name: str,
    own: Callable[[], object],
    peer: Callable[[], object],
    *,
    target: float,
    rounds: int = 9,
    accuracy: str = "",
) -> Row:
    """Time two calls in turns, ours and the peer's, and take the median of each.

    Turns, not one after the other, because a shared machine drifts: both see the same drift. The first round warms
    caches and compilers and is not counted.

    Parameters
    ----------
    name : str
        What is compared with what.
    own, peer : callable
        Calls without arguments; what they return is not looked at.
    target : float
        Largest ratio of our time to the peer's. [-]
    rounds : int
        Counted rounds.
    accuracy : str
        How far each side's answer is off.

    Returns
    -------
    row : Row
        Medians and target.
    """
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(rounds + 1):
        for call, taken in zip((own, peer), times):
            start = time.perf_counter()
            call()
            taken.append(time.perf_counter() - start)
    own_s, peer_s = (statistics.median(taken[1:]) for taken in times)
    return Row(name, own_s, peer_s, target, accuracy)
