"""Discrete gusts as a section with lagging lift feels them: Duhamel's integral with Kussner's function.

The indicial function comes in as exponentials, Psi(tau) = 1 - sum a_j exp(-b_j tau) with tau = x/b in semi-chords,
so that this package needs to know no aerodynamics. The results are exact for that function and no better than it;
they are referred to the LEADING EDGE of the section. The cosines are in closed form, any other gust by a filter
that is exact between samples joined by straight lines.

Valid for two-dimensional incompressible flow, small gusts, and a gust that is uniform along the section's span.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import lfilter

from aeroservo.gust.discrete import _positive_length, held_cosine, one_minus_cosine

__all__ = [
    "indicial_filter",
    "kussner_held_cosine",
    "kussner_one_minus_cosine",
    "kussner_sharp_edged",
]

Array = NDArray[Any]


def kussner_sharp_edged(
    x: ArrayLike, amplitude: ArrayLike, *, semichord: float, amplitudes: ArrayLike, exponents: ArrayLike
) -> Array:
    """Effective gust velocity of a section entering a sharp edge.

    Parameters
    ----------
    x : array_like, shape (...)
        Distance penetrated by the leading edge. [m]
    amplitude : array_like, shape (...)
        Gust velocity behind the edge. [m/s]
    semichord : float
        Semi-chord b of the section, positive. [m]
    amplitudes, exponents : array_like, shape (n_lag,)
        a_j and b_j of Psi(tau) = 1 - sum a_j exp(-b_j tau), tau = x/b; exponents positive. [-]

    Returns
    -------
    w_eff : ndarray, shape (...)
        Gust velocity that would give the same lift in steady flow, w_g0 Psi(x/b). [m/s]

    Raises
    ------
    ValueError
        If the semi-chord or an exponent is not positive, or the coefficients differ in number.

    References
    ----------
    Bramstång 2015, section 7.10; W. R. Sears and B. O. Sparks, J. Aeronaut. Sci. 9(2), 1941, for the usual
    coefficients (0.5, 0.13), (0.5, 1.0).

    Examples
    --------
    >>> kussner_sharp_edged([-1.0, 0.0, 1e3], 2.0, semichord=0.5, amplitudes=[0.5, 0.5], exponents=[0.13, 1.0])
    array([0., 0., 2.])
    """
    a, g = _lags(amplitudes, exponents, semichord)
    x = np.asarray(x, dtype=float)
    inside = np.maximum(x, 0.0)[..., None]
    return np.where(x >= 0.0, np.asarray(amplitude) * (1.0 - np.sum(a * np.exp(-g * inside), axis=-1)), 0.0)


def kussner_one_minus_cosine(
    x: ArrayLike,
    amplitude: ArrayLike,
    length: ArrayLike,
    *,
    semichord: float,
    amplitudes: ArrayLike,
    exponents: ArrayLike,
) -> Array:
    """Effective gust velocity of a section crossing a one-minus-cosine pulse, in closed form.

    Parameters
    ----------
    x : array_like, shape (...)
        Distance penetrated by the leading edge. [m]
    amplitude, length : array_like, shape (...)
        Peak [m/s] and whole wavelength [m] of the pulse.
    semichord : float
        Semi-chord b of the section, positive. [m]
    amplitudes, exponents : array_like, shape (n_lag,)
        a_j and b_j of Psi(tau) = 1 - sum a_j exp(-b_j tau), tau = x/b. [-]

    Returns
    -------
    w_eff : ndarray, shape (...)
        Duhamel's integral of the pulse with Psi; decays behind the pulse. [m/s]

    Raises
    ------
    ValueError
        If a length, the semi-chord or an exponent is not positive.

    References
    ----------
    Bramstång 2015, Eq. 7.60 and section 7.10; equations.md, gust columns: z' = (V/b) g (u - z), output D (u - z).

    Examples
    --------
    >>> lag = dict(semichord=0.5, amplitudes=[0.5, 0.5], exponents=[0.13, 1.0])
    >>> kussner_one_minus_cosine([0.0, 5e3, 1.1e4], 2.0, 1e4, **lag).round(3)
    array([0., 2., 0.])
    """
    return _filtered_cosine(
        x, amplitude, length, 2.0 * np.pi, False, one_minus_cosine, _lags(amplitudes, exponents, semichord)
    )


def kussner_held_cosine(
    x: ArrayLike,
    amplitude: ArrayLike,
    length: ArrayLike,
    *,
    semichord: float,
    amplitudes: ArrayLike,
    exponents: ArrayLike,
) -> Array:
    """Effective gust velocity of a section entering the held gust of MIL-F-8785C, in closed form.

    Parameters
    ----------
    x : array_like, shape (...)
        Distance penetrated by the leading edge. [m]
    amplitude, length : array_like, shape (...)
        Held velocity V_m [m/s] and build-up distance d_m [m].
    semichord : float
        Semi-chord b of the section, positive. [m]
    amplitudes, exponents : array_like, shape (n_lag,)
        a_j and b_j of Psi(tau) = 1 - sum a_j exp(-b_j tau), tau = x/b. [-]

    Returns
    -------
    w_eff : ndarray, shape (...)
        Duhamel's integral of the gust with Psi; tends to V_m. [m/s]

    Raises
    ------
    ValueError
        If a length, the semi-chord or an exponent is not positive.

    References
    ----------
    MIL-F-8785C, section 3.7 (shape, from memory of the standard); equations.md, gust columns.

    Examples
    --------
    >>> lag = dict(semichord=0.5, amplitudes=[0.5, 0.5], exponents=[0.13, 1.0])
    >>> kussner_held_cosine([0.0, 1e4], 2.0, 20.0, **lag).round(9)
    array([0., 2.])
    """
    return _filtered_cosine(x, amplitude, length, np.pi, True, held_cosine, _lags(amplitudes, exponents, semichord))


def _filtered_cosine(
    x: ArrayLike, amplitude: ArrayLike, length: ArrayLike, arc: float, held: bool, gust: Any, lags: tuple[Array, Array]
) -> Array:
    """Sum of lags of (A/2)(1 - cos(arc x/length)), which ends at x = length at A (held) or at 0.

    Each lag obeys z' = g (u - z) from z(0) = 0 in distance; inside the arc, with kappa = arc/length,
    z = (A/2)[1 - (g^2 cos + g kappa sin)/(g^2 + kappa^2) - kappa^2 e^(-g x)/(g^2 + kappa^2)].
    """
    a, g = lags
    x, peak, length = np.broadcast_arrays(np.asarray(x, float), np.asarray(amplitude, float), np.asarray(length, float))
    _positive_length(length, "length")
    x1, size = x[..., None], length[..., None]
    kappa = arc / size
    inside = np.clip(x1, 0.0, size)
    phase, weight = kappa * inside, 1.0 / (g**2 + kappa**2)
    z = 0.5 * (1.0 - weight * (g**2 * np.cos(phase) + g * kappa * np.sin(phase) + kappa**2 * np.exp(-g * inside)))
    rest = 1.0 if held else 0.0
    after = np.maximum(x1 - size, 0.0)
    z = rest + (z - rest) * np.exp(-g * after)
    w = gust(x, peak, length)
    return np.where(x > 0.0, (1.0 - a.sum()) * w + peak * (z @ a), 0.0)


def indicial_filter(
    w: ArrayLike, step: float, *, semichord: float, amplitudes: ArrayLike, exponents: ArrayLike
) -> Array:
    """Effective gust velocity of a section flying through any sampled gust.

    Exact for a gust that is linear between its samples (ramp-invariant), whatever the step.

    Parameters
    ----------
    w : array_like, shape (..., n)
        Gust velocity at the leading edge at equal steps of distance; still air (0) before the first. [m/s]
    step : float
        Distance between samples, V dt, positive. [m]
    semichord : float
        Semi-chord b of the section, positive. [m]
    amplitudes, exponents : array_like, shape (n_lag,)
        a_j and b_j of Psi(tau) = 1 - sum a_j exp(-b_j tau), tau = x/b. [-]

    Returns
    -------
    w_eff : ndarray, shape (..., n)
        Effective gust velocity at the same points; a first sample that is not 0 is a sharp edge there. [m/s]

    Raises
    ------
    ValueError
        If the step, the semi-chord or an exponent is not positive.

    References
    ----------
    equations.md, gust columns: z' = (V/b) g (u - z), output D (u - z).

    Examples
    --------
    >>> lag = dict(semichord=1.0, amplitudes=[1.0], exponents=[0.5])
    >>> indicial_filter([1.0, 1.0, 1.0], 1.0, **lag).round(6)
    array([0.      , 0.393469, 0.632121])
    """
    a, g = _lags(amplitudes, exponents, semichord)
    if not step > 0.0:
        raise ValueError(f"step must be positive [m], got {step:g}")
    w = np.asarray(w, dtype=float)
    w_eff = (1.0 - a.sum()) * w
    for a_j, g_j in zip(a, g):
        decay = np.exp(-g_j * step)
        mean = -np.expm1(-g_j * step) / (g_j * step)
        new, old = 1.0 - mean, mean - decay
        drive = np.concatenate([np.zeros_like(w[..., :1]), new * w[..., 1:] + old * w[..., :-1]], axis=-1)
        w_eff = w_eff + a_j * lfilter([1.0], [1.0, -decay], drive, axis=-1)
    return w_eff


def _lags(amplitudes: ArrayLike, exponents: ArrayLike, semichord: float) -> tuple[Array, Array]:
    """Amplitudes and rates per metre, checked."""
    a, b = np.atleast_1d(np.asarray(amplitudes, float)), np.atleast_1d(np.asarray(exponents, float))
    if not semichord > 0.0:
        raise ValueError(f"semichord must be positive [m], got {semichord:g}")
    if a.shape != b.shape or a.ndim != 1:
        raise ValueError(f"amplitudes and exponents must be equally many, got shapes {a.shape} and {b.shape}")
    if not np.all(b > 0.0):
        raise ValueError(f"exponents must be positive [-], got {b.min():g}")
    return a, b / semichord
