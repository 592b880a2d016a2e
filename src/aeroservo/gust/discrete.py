"""Discrete gusts: sharp edge, one-minus-cosine, held half cosine, and where each part of the aircraft is in them.

A gust is a frozen pattern in space, met at the airspeed: everything here is a function of the distance x
penetrated into it (x = 0 where it begins; negative before it is met). A zone of the aircraft that lies
`x_offset` aft of the reference point meets the same pattern x_offset later (`penetration_distance`). Gusts are
positive UP for the vertical component and are true (not equivalent) velocities.

Valid for gusts that are small against the airspeed and do not change while the aircraft crosses them (Taylor's
frozen field). What a lagging wing feels of them is in `kussner.py`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "DiscreteGust",
    "HeldCosine",
    "OneMinusCosine",
    "SharpEdged",
    "check_sampling",
    "held_cosine",
    "one_minus_cosine",
    "penetration_distance",
    "sharp_edged",
]

Array = NDArray[Any]


class DiscreteGust(Protocol):
    """Any callable from penetrated distance [m] to gust velocity [m/s]."""

    amplitude: float

    def __call__(self, x: ArrayLike) -> Array: ...


@dataclass(frozen=True, kw_only=True)
class SharpEdged:
    """A step of gust velocity: `amplitude` for x >= 0.

    Attributes
    ----------
    amplitude : float
        Gust velocity behind the edge, positive up. [m/s]
    """

    amplitude: float

    def __call__(self, x: ArrayLike) -> Array:
        """Gust velocity at the penetrated distance x [m], shape of x. [m/s]"""
        return sharp_edged(x, self.amplitude)


@dataclass(frozen=True, kw_only=True)
class OneMinusCosine:
    """A full pulse (amplitude/2)(1 - cos(2 pi x/length)) for 0 <= x <= length.

    Attributes
    ----------
    amplitude : float
        Peak gust velocity, positive up. [m/s]
    length : float
        Whole wavelength l_g; the certification codes' gradient H is half of it. [m]
    """

    amplitude: float
    length: float

    def __post_init__(self) -> None:
        _positive_length(self.length, "length")

    def __call__(self, x: ArrayLike) -> Array:
        """Gust velocity at the penetrated distance x [m], shape of x. [m/s]"""
        return one_minus_cosine(x, self.amplitude, self.length)


@dataclass(frozen=True, kw_only=True)
class HeldCosine:
    """The ramp of MIL-F-8785C: half a cosine up to `amplitude` over d_m, then held for ever.

    Attributes
    ----------
    amplitude : float
        Gust velocity V_m that is reached and held, positive up. [m/s]
    length : float
        Distance d_m over which the gust builds up. [m]
    """

    amplitude: float
    length: float

    def __post_init__(self) -> None:
        _positive_length(self.length, "length")

    def __call__(self, x: ArrayLike) -> Array:
        """Gust velocity at the penetrated distance x [m], shape of x. [m/s]"""
        return held_cosine(x, self.amplitude, self.length)


def penetration_distance(t: ArrayLike, V: ArrayLike, *, start: float = 0.0, x_offset: ArrayLike = 0.0) -> Array:
    """Distance that each zone of the aircraft has penetrated into a gust.

    Parameters
    ----------
    t : array_like, shape (n_t,)
        Time, ascending. [s]
    V : array_like, shape () or (n_t,)
        True airspeed, positive; an array is a speed history, linear between its samples. [m/s]
    start : float
        Time at which the reference point meets the gust; within `t` or before it if V varies. [s]
    x_offset : array_like, shape (...)
        Distance of each zone aft of the reference point. [m]

    Returns
    -------
    x : ndarray, shape (..., n_t)
        Integral of V from `start` to t, less the zone's offset. [m]

    Raises
    ------
    ValueError
        If V is not positive, the times do not ascend, or V varies and `start` lies outside the history.

    References
    ----------
    Bramstång 2015, Eq. 7.60 (X_g = V t); architecture.md, gust zones: penetration is a delay x_offset/V.

    Examples
    --------
    >>> penetration_distance([0.0, 1.0], 50.0, start=0.5, x_offset=10.0)
    array([-35.,  15.])
    """
    t, V = np.atleast_1d(np.asarray(t, dtype=float)), np.asarray(V, dtype=float)
    offset = np.asarray(x_offset, dtype=float)[..., None]
    if not np.all(V > 0.0):
        raise ValueError(f"airspeed V must be positive [m/s], got {np.min(V):g}")
    if np.any(np.diff(t) < 0.0):
        raise ValueError("times t must ascend [s]")
    if V.ndim == 0:
        return V * (t - start) - offset
    if not t[0] <= start <= t[-1]:
        raise ValueError(f"start must lie within the history, {t[0]:g} to {t[-1]:g} [s], got {start:g}")
    V = np.broadcast_to(V, t.shape)
    travelled = np.concatenate([[0.0], np.cumsum(0.5 * (V[1:] + V[:-1]) * np.diff(t))])
    i = int(np.clip(np.searchsorted(t, start, side="right") - 1, 0, max(t.size - 2, 0)))
    V_start = np.interp(start, t, V)
    return travelled - (travelled[i] + 0.5 * (V[i] + V_start) * (start - t[i])) - offset


def sharp_edged(x: ArrayLike, amplitude: ArrayLike) -> Array:
    """Gust velocity of a sharp edge, a step at x = 0.

    Parameters
    ----------
    x : array_like, shape (...)
        Penetrated distance. [m]
    amplitude : array_like, shape (...)
        Gust velocity behind the edge. [m/s]

    Returns
    -------
    w_g : ndarray, shape (...)
        `amplitude` for x >= 0, else 0. [m/s]

    References
    ----------
    Bramstång 2015, section 7.10.

    Examples
    --------
    >>> sharp_edged([-1.0, 0.0, 1.0], 3.0)
    array([0., 3., 3.])
    """
    x, amplitude = np.asarray(x, dtype=float), np.asarray(amplitude, dtype=float)
    return np.where(x >= 0.0, amplitude, 0.0)


def one_minus_cosine(x: ArrayLike, amplitude: ArrayLike, length: ArrayLike) -> Array:
    """Gust velocity of a full one-minus-cosine pulse.

    Parameters
    ----------
    x : array_like, shape (...)
        Penetrated distance. [m]
    amplitude : array_like, shape (...)
        Peak gust velocity w_g0. [m/s]
    length : array_like, shape (...)
        Whole wavelength l_g, positive; H of CS-25.341 is half of it. [m]

    Returns
    -------
    w_g : ndarray, shape (...)
        (w_g0/2)(1 - cos(2 pi x/l_g)) for 0 <= x <= l_g, else 0. [m/s]

    Raises
    ------
    ValueError
        If a length is not positive.

    References
    ----------
    Bramstång 2015, Eqs. 7.59-7.60; CS-25.341(a)(2) with l_g = 2H.

    Examples
    --------
    >>> one_minus_cosine([0.0, 10.0, 20.0, 25.0], 4.0, 20.0).round(12)
    array([0., 4., 0., 0.])
    """
    x, length = np.asarray(x, dtype=float), _positive_length(length, "length")
    inside = (x >= 0.0) & (x <= length)
    return np.where(inside, np.asarray(amplitude) * np.sin(np.pi * x / length) ** 2, 0.0)


def held_cosine(x: ArrayLike, amplitude: ArrayLike, length: ArrayLike) -> Array:
    """Gust velocity of the MIL-F-8785C discrete gust: builds up over d_m and is held.

    The Aerospace Blockset's "Discrete Wind Gust" is this form: it never decays; two of them with opposite
    amplitudes, the second starting when the first is full, make a full pulse.

    Parameters
    ----------
    x : array_like, shape (...)
        Penetrated distance. [m]
    amplitude : array_like, shape (...)
        Held gust velocity V_m. [m/s]
    length : array_like, shape (...)
        Build-up distance d_m, positive: half the wavelength of the full pulse. [m]

    Returns
    -------
    w_g : ndarray, shape (...)
        0 for x < 0; (V_m/2)(1 - cos(pi x/d_m)) for 0 <= x <= d_m; V_m beyond. [m/s]

    Raises
    ------
    ValueError
        If a length is not positive.

    References
    ----------
    MIL-F-8785C, section 3.7 (discrete gust model), written from memory of the standard; the shape agrees with the
    documentation of the Aerospace Blockset's "Discrete Wind Gust" block.

    Examples
    --------
    >>> held_cosine([-1.0, 5.0, 10.0, 99.0], 4.0, 10.0).round(12)
    array([0., 2., 4., 4.])
    """
    x, length = np.asarray(x, dtype=float), _positive_length(length, "length")
    ramp = np.sin(0.5 * np.pi * np.clip(x / length, 0.0, 1.0)) ** 2
    return np.asarray(amplitude) * ramp


def check_sampling(length: float, V: ArrayLike, dt: float, *, samples: int = 1) -> None:
    """Refuse a gust that is crossed in less than a given number of time steps.

    Parameters
    ----------
    length : float
        Length of the gust. [m]
    V : array_like, shape (...)
        True airspeed. [m/s]
    dt : float
        Time step. [s]
    samples : int
        Steps wanted within the gust.

    Raises
    ------
    ValueError
        If length < samples V dt, or dt or length is not positive.

    References
    ----------
    Project convention: issue 6, "gust shorter than the step" is refused.

    Examples
    --------
    >>> check_sampling(10.0, 50.0, 0.01)
    """
    _positive_length(length, "length")
    if not dt > 0.0:
        raise ValueError(f"time step dt must be positive [s], got {dt:g}")
    crossed = float(np.max(np.asarray(V, dtype=float)) * dt * samples)
    if length < crossed:
        raise ValueError(
            f"gust length must be at least {samples} step(s) of V dt = {crossed:g} [m], got {length:g}: "
            f"shorten the step dt = {dt:g} [s] or lengthen the gust"
        )


def _positive_length(length: ArrayLike, name: str) -> Array:
    length = np.asarray(length, dtype=float)
    if not np.all((length > 0.0) & np.isfinite(length)):
        raise ValueError(f"gust {name} must be positive [m], got {np.min(length):g}")
    return length
