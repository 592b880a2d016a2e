"""The critical gust gradient of any model: where the peak response is largest.

The model comes in as a callable from an array of gradients to peak responses, so one vectorised simulation answers
for all gradients and all load channels. A first grid finds the neighbourhood of each channel's maximum; then points
about the top of the parabola through its three best points close in on it until the gradient is known to the tolerance.

What it cannot do: see a second maximum that is narrower than the spacing of the first grid. `samples` is that
spacing; the grid and its peaks are in the result, so that a plot shows it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.datatypes import frozen

__all__ = ["CriticalGradient", "critical_gradient"]

Array = NDArray[Any]


@dataclass(frozen=True, kw_only=True, eq=False)
class CriticalGradient:
    """Critical gradient of every response channel.

    Attributes
    ----------
    gradient : ndarray, shape (n_y,)
        Gust gradient distance with the largest peak. [m]
    peak : ndarray, shape (n_y,)
        The largest peak itself, an absolute value. [unit of the channel]
    gradients : ndarray, shape (n,)
        Every gradient that was evaluated, ascending. [m]
    peaks : ndarray, shape (n, n_y)
        Peaks at those gradients. [unit of the channel]
    at_limit : ndarray of bool, shape (n_y,)
        True where the maximum lies at an end of the range: the worst gust may be outside it.
    """

    gradient: Array
    peak: Array
    gradients: Array
    peaks: Array
    at_limit: Array

    def __post_init__(self) -> None:
        for name in ("gradient", "peak", "gradients", "peaks"):
            object.__setattr__(self, name, frozen(getattr(self, name), name=name))
        object.__setattr__(self, "at_limit", frozen(self.at_limit, dtype=bool, name="at_limit"))


def critical_gradient(
    response: Callable[[Array], ArrayLike],
    *,
    bounds: tuple[float, float] = (9.0, 107.0),
    samples: int = 15,
    tolerance: float = 1e-4,
) -> CriticalGradient:
    """Find the gust gradient that gives the largest peak response.

    Parameters
    ----------
    response : callable
        From gradients of shape (n,) [m] to peaks of shape (n,) or (n, n_y); absolute values are taken. Include the
        code's own growth of the gust with its gradient, e.g. (H/107 m)^(1/6).
    bounds : pair of float
        Range of the search, positive and ascending; default that of CS-25.341. [m]
    samples : int
        Points of the first grid, spaced in equal ratios, at least 3.
    tolerance : float
        Relative accuracy wanted of the gradient, in (0, 0.1). [-]

    Returns
    -------
    result : CriticalGradient
        Critical gradient and peak of every channel, and everything that was evaluated.

    Raises
    ------
    ValueError
        If an argument is outside its range, or the response is not finite or has another shape.

    References
    ----------
    CS-25.341(a)(3): enough gradients to find the critical response for each load quantity.

    Examples
    --------
    >>> found = critical_gradient(lambda H: np.exp(-np.log(H / 31.0) ** 2))
    >>> round(float(found.gradient[0]), 2), bool(found.at_limit[0])
    (31.0, False)
    """
    low, high = bounds
    if not 0.0 < low < high:
        raise ValueError(f"bounds must be positive and ascending [m], got {bounds}")
    if samples < 3 or not 0.0 < tolerance < 0.1:
        raise ValueError(f"samples must be >= 3 and tolerance in (0, 0.1), got {samples} and {tolerance:g}")
    H = np.geomspace(low, high, samples)
    H[0], H[-1] = low, high
    P = _peaks(response, H)
    for _ in range(60):
        best = P.argmax(axis=0)
        left, right = np.maximum(best - 1, 0), np.minimum(best + 1, H.size - 1)
        open_ = np.flatnonzero(H[right] - H[left] > tolerance * H[best])
        three = np.stack([left, best, right])
        wanted = [_refined(H[three[:, j]], P[three[:, j], j], tolerance) for j in open_]
        new = np.setdiff1d(np.concatenate([np.zeros(0), *wanted]), H)
        if new.size == 0:
            break
        order = np.argsort(np.concatenate([H, new]))
        P = np.concatenate([P, _peaks(response, new)])[order]
        H = np.concatenate([H, new])[order]
    best = P.argmax(axis=0)
    return CriticalGradient(
        gradient=H[best],
        peak=P[best, np.arange(P.shape[1])],
        gradients=H,
        peaks=P,
        at_limit=(best == 0) | (best == H.size - 1),
    )


def _refined(H: Array, peak: Array, tolerance: float) -> Array:
    """Where to look next between three gradients whose middle one is the best: about the top of their parabola.

    At an end of the range (two of the three are one) a point beside it tells at once whether the end is the maximum.
    """
    low, middle, high = (float(x) for x in H)
    small = 0.45 * tolerance * middle
    if low == middle or middle == high:
        near = low + small if low == middle else high - small
        return np.array([near, 0.5 * (low + high)])
    left, right = (peak[1] - peak[0]) / (middle - low), (peak[2] - peak[1]) / (high - middle)
    top = 0.5 * (low + middle) + 0.5 * (high - low) * left / (left - right) if left > right else middle
    aside = max(small, (high - low) / 16.0)
    new = np.array([top - aside, top, top + aside])
    far = low if middle - low > high - middle else high  # a parabola that fits badly must not stall the search
    new = np.append(new, 0.5 * (middle + far))
    return new[(new > low) & (new < high)]


def _peaks(response: Callable[[Array], ArrayLike], H: Array) -> Array:
    """Absolute peaks, shape (n, n_y)."""
    peaks = np.abs(np.asarray(response(H), dtype=float))
    if peaks.shape[:1] != H.shape or peaks.ndim not in (1, 2) or not np.all(np.isfinite(peaks)):
        raise ValueError(
            f"response must return finite peaks of shape ({H.size},) or ({H.size}, n_y) for {H.size} gradients, "
            f"got shape {peaks.shape}"
        )
    return peaks.reshape(H.size, -1)
