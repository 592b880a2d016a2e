"""Von Karman turbulence: power spectra, a rational fit that holds over the flutter band, and the Blockset's.

The spectra have no finite filter: (1 + x)^(-5/6) is fitted by real poles and zeros that alternate (the form that
this function, a Stieltjes function, asks for) over a stated range of the reduced frequency L omega/V. One fit serves
all components, since the vertical spectrum is the longitudinal one times an exact rational factor. The fit is made
here, by deterministic least squares on the logarithm of the spectrum; nothing is a table of magic numbers.

With the default 8 poles the power spectrum is within 0.5 % from 0 to L omega/V = 5e4 (1,000 Hz at 100 m/s and 800 m;
50 Hz at 5 m/s and 762 m) and the variance is 1.0004 (u), 1.0001 (v, w) of sigma^2. Above that range the filter falls
as omega^-2 where von Karman falls as omega^(-5/3), and is too low.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares
from scipy.signal import tf2ss

from aeroservo.datatypes import frozen
from aeroservo.gust.dryden import Component, _scales, rate_attenuation, roll_rate_psd
from aeroservo.gust.intensity import Specification

__all__ = ["VonKarmanFit", "blockset_core", "fit_von_karman", "von_karman_core", "von_karman_psd"]

Array = NDArray[Any]

_A = 1.339  # the specifications' rounding of Gamma(1/3)/(sqrt(pi) Gamma(5/6)); leaves 1.1e-5 of the variance out


@dataclass(frozen=True, kw_only=True, eq=False)
class VonKarmanFit:
    """Rational fit |H|^2 of (1 + x^2)^(-5/6), H(ix) = prod(1 + ix/z)/prod(1 + ix/p), x = 1.339 L omega/V.

    Attributes
    ----------
    poles : ndarray, shape (n,)
        p, ascending. [-]
    zeros : ndarray, shape (n - 1,)
        z, one between each two poles. [-]
    reduced_frequency_max : float
        Largest L omega/V for which it was fitted. [-]
    error : float
        Largest relative error of the power spectrum from 0 to there. [-]
    """

    poles: Array
    zeros: Array
    reduced_frequency_max: float
    error: float

    def __post_init__(self) -> None:
        for name in ("poles", "zeros"):
            object.__setattr__(self, name, frozen(getattr(self, name), ndim=1, name=name))


def von_karman_psd(
    omega: ArrayLike,
    *,
    component: Component,
    V: ArrayLike,
    length: ArrayLike,
    intensity: ArrayLike,
    span: float | None = None,
    specification: Specification = "MIL-F-8785C",
) -> Array:
    """One-sided von Karman power spectral density of any of the six components.

    With V = 1 m/s, omega is the spatial frequency Omega [rad/m] and this is the spectrum of CS-25.341(b)(2).

    Parameters
    ----------
    omega : array_like, shape (...)
        Angular frequency. [rad/s]
    component : {"u", "v", "w", "p", "q", "r"}
        Velocity or angular rate; p and q belong to w, r to v.
    V : array_like, shape (...)
        True airspeed, positive. [m/s]
    length, intensity : array_like, shape (...)
        Scale length [m] and RMS [m/s] of the velocity to which the component belongs, in the convention of
        `specification`.
    span : float, optional
        Wingspan b, needed for the rates. [m]
    specification : {"MIL-F-8785C", "MIL-HDBK-1797"}
        1797 has 2L where 8785C has L, in v, w and the rates.

    Returns
    -------
    Phi : ndarray, shape (...)
        [(m/s)^2 s/rad], or [(rad/s)^2 s/rad] for the rates. Its integral over omega is 1.1e-5 short of sigma^2,
        because 1.339 is rounded.

    Raises
    ------
    ValueError
        If a name is unknown, V or length is not positive, intensity is negative, or the span is missing.

    References
    ----------
    MIL-F-8785C, section 3.7; CS-25.341(b)(2) and 14 CFR 25, former Appendix G(b)(2) for w; the rates from memory of the
    standard.

    Examples
    --------
    >>> round(float(von_karman_psd(0.0, component="w", V=1.0, length=762.0, intensity=1.0)), 3)
    242.552
    """
    sigma, T = _scales(component, V, length, intensity, specification)
    omega = np.asarray(omega, dtype=float)
    if component == "p":
        return roll_rate_psd(omega, V=V, length=length, intensity=sigma, span=span, specification=specification)
    x = (_A * T * omega) ** 2
    if component == "u":
        return sigma**2 * (2.0 * T / np.pi) / (1.0 + x) ** (5.0 / 6.0)
    phi = sigma**2 * (T / np.pi) * (1.0 + 8.0 / 3.0 * x) / (1.0 + x) ** (11.0 / 6.0)
    return phi if component in ("v", "w") else phi * rate_attenuation(omega, component, V, span)


@lru_cache(maxsize=16)
def fit_von_karman(order: int = 8, reduced_frequency_max: float = 5e4) -> VonKarmanFit:
    """Fit the irrational factor of von Karman's spectra by alternating real poles and zeros.

    Parameters
    ----------
    order : int
        Number of poles, 2 to 20.
    reduced_frequency_max : float
        Largest L omega/V to be fitted, 10 to 1e7. [-]

    Returns
    -------
    fit : VonKarmanFit
        With its largest error. The same arguments always give the same fit.

    Raises
    ------
    ValueError
        If an argument is outside its range.

    References
    ----------
    A. Oustaloup et al., IEEE Trans. Circuits Syst. I 47(1), 2000, for the alternating recursion of the first
    guess; the least squares are this project's.

    Examples
    --------
    >>> fit_von_karman().error < 0.005
    True
    """
    if not 2 <= order <= 20:
        raise ValueError(f"order must lie in 2 to 20, got {order}")
    if not 10.0 <= reduced_frequency_max <= 1e7:
        raise ValueError(f"reduced_frequency_max must lie in 10 to 1e7 [-], got {reduced_frequency_max:g}")
    top = _A * reduced_frequency_max
    x = np.concatenate([[0.0], np.geomspace(0.03, top, 60 * order)])
    target = -5.0 / 6.0 * np.log1p(x**2)

    def corners(parameters: Array) -> Array:
        """Pole, zero, pole, ...: ascending because every ratio exceeds 1."""
        return np.exp(np.cumsum(np.exp(parameters)))

    def residual(parameters: Array) -> Array:
        corner = corners(parameters)
        poles, zeros = corner[0::2, None], corner[1::2, None]
        return np.log1p((x / zeros) ** 2).sum(axis=0) - np.log1p((x / poles) ** 2).sum(axis=0) - target

    period = np.log(top) / order
    first = np.resize([period / 6.0, period * 5.0 / 6.0], 2 * order - 1)
    # A high even power of the error approaches the smallest largest error; start from plain least squares.
    start = least_squares(residual, np.log(first), xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=500).x
    scale = np.abs(residual(start)).max()
    best = least_squares(
        lambda parameters: (residual(parameters) / scale) ** 3, start, xtol=1e-12, ftol=1e-12, gtol=1e-12, max_nfev=500
    ).x
    corner = corners(best)
    return VonKarmanFit(
        poles=corner[0::2],
        zeros=corner[1::2],
        reduced_frequency_max=reduced_frequency_max,
        error=float(np.abs(np.expm1(residual(best))).max()),
    )


def von_karman_core(component: Component, *, fit: VonKarmanFit | None = None) -> tuple[Array, Array, Array]:
    """State-space numbers of a von Karman velocity filter, in units of its time scale.

    Parameters
    ----------
    component : {"u", "v", "w"}
        Velocity component; v and w share one, of one order more.
    fit : VonKarmanFit, optional
        Default `fit_von_karman()`: 8 poles, to L omega/V = 5e4.

    Returns
    -------
    A0, B0, C0 : ndarray, shapes (n, n), (n, 1), (1, n)
        A = A0/T, B = B0/sqrt(T), C = sigma C0, as in `dryden.py`. [-]

    Raises
    ------
    ValueError
        If the component is not a velocity.

    References
    ----------
    MIL-F-8785C, section 3.7 (spectra); partial fractions of `fit_von_karman`.

    Examples
    --------
    >>> von_karman_core("w")[0].shape
    (9, 9)
    """
    if component not in ("u", "v", "w"):
        raise ValueError(f"velocity component must be one of u, v, w, got {component!r}")
    fit = fit_von_karman() if fit is None else fit
    p, z = fit.poles, fit.zeros
    ratio = 1.0 - p[:, None] / p
    np.fill_diagonal(ratio, 1.0)
    residues = np.prod(1.0 - p[:, None] / z, axis=1) / np.prod(ratio, axis=1)  # of 1/(1 + s/p)
    A0, B0, C0 = -np.diag(p) / _A, np.sqrt(p)[:, None], (residues * np.sqrt(p) / _A)[None, :]
    if component == "u":
        return A0, B0, np.sqrt(2.0) * C0
    # H_w = sigma sqrt(T) (1 + r s')/(1 + s') times the fit, s' = 1.339 T s, r = sqrt(8/3): one more lag.
    r, n = np.sqrt(8.0 / 3.0), p.size
    A = np.zeros((n + 1, n + 1))
    A[:n, :n], A[n, :n], A[n, n] = A0, C0[0] / _A, -1.0 / _A
    return A, np.vstack([B0, [[0.0]]]), np.hstack([r * C0, [[1.0 - r]]])


def blockset_core(component: Component) -> tuple[Array, Array, Array]:
    """State-space numbers of the Aerospace Blockset's rational von Karman filters, for comparison only.

    They hold below L omega/V of about 10: at 10 Hz (L = 762 m, V = 50 m/s) the vertical one has 0.30 of the power.
    Their variance is 0.969 (u) and 0.962 (v, w) of sigma^2.

    Parameters
    ----------
    component : {"u", "v", "w"}
        Velocity component.

    Returns
    -------
    A0, B0, C0 : ndarray, shapes (n, n), (n, 1), (1, n)
        A = A0/T, B = B0/sqrt(T), C = sigma C0, as in `dryden.py`, for UNIT white noise (the block's own has power
        pi and its gains a factor 1/sqrt(pi)). [-]

    Raises
    ------
    ValueError
        If the component is not a velocity.

    References
    ----------
    MathWorks, Aerospace Blockset reference, 2015, "Von Karman Wind Turbulence Model (Continuous)"; coefficients written
    from memory of it and checked for consistency with the exact spectra at low frequency only.

    Examples
    --------
    >>> blockset_core("w")[0].shape
    (3, 3)
    """
    if component == "u":
        gain, numerator, denominator = np.sqrt(2.0), [0.25, 1.0], [0.1987, 1.357, 1.0]
    elif component in ("v", "w"):
        gain, numerator, denominator = 1.0, [0.3398, 2.7478, 1.0], [0.1539, 1.9754, 2.9958, 1.0]
    else:
        raise ValueError(f"velocity component must be one of u, v, w, got {component!r}")
    A0, B0, C0, _ = tf2ss(numerator, denominator)
    return A0, B0, gain * C0
