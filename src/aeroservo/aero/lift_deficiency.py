"""Theodorsen's lift-deficiency function C(k), on the imaginary axis and off it.

Two-dimensional, incompressible, inviscid, small motion about a flat wake. b is the semichord and p = s b/V the reduced
Laplace variable, p = ik in harmonic motion.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import j0, j1, kve, y0, y1

__all__ = ["generalized_theodorsen_function", "scaled_macdonald", "theodorsen_function"]

Complex = NDArray[np.complexfloating]

_TINY = 1e-300  # below it K1(p) ~ 1/p overflows; C differs from 1 by less than 1e-297
_FAR = 40.0  # beyond it the asymptotic series of K0, K1 hold to 1e-16


def theodorsen_function(k: ArrayLike) -> Complex:
    """Lift-deficiency function C(k) of an oscillating thin aerofoil.

    Parameters
    ----------
    k : array_like, shape (...)
        Reduced frequency omega*b/V with b the semichord, real and >= 0 (infinity included). Complex values are taken
        as p = ik and go to `generalized_theodorsen_function`: Im k < 0 is a growing oscillation. [-]

    Returns
    -------
    C : complex ndarray, shape (...)
        F + iG; 1 at k = 0 (quasi-steady limit), 1/2 as k grows. [-]

    Raises
    ------
    ValueError
        If any real k is negative or not a number, or a complex one not finite.

    References
    ----------
    Bramstång 2015, Eq. 3.12; T. Theodorsen, NACA Report 496, 1935.

    Examples
    --------
    >>> np.round(theodorsen_function([0.1, 1.0]), 4)
    array([0.8319-0.1723j, 0.5394-0.1003j])
    """
    k = np.asarray(k)
    if np.iscomplexobj(k):
        return generalized_theodorsen_function(1j * k)
    k = k.astype(float)
    if not np.all(k >= 0.0):
        raise ValueError(f"reduced frequency k must be >= 0 [-], got {k[~(k >= 0.0)].flat[0]:g}")
    near = np.clip(k, _TINY, _FAR)
    ratio = (y0(near) + 1j * j0(near)) / (j1(near) - 1j * y1(near))  # K0(ik)/K1(ik)
    far = k > _FAR
    if np.any(far):
        S0, S1 = _asymptotic(-1j * (1.0 / np.where(far, k, _FAR)))
        ratio = np.where(far, S0 / S1, ratio)
    return np.asarray(1.0 / (1.0 + np.where(k > _TINY, ratio, 0.0)), dtype=complex)


def generalized_theodorsen_function(p: ArrayLike) -> Complex:
    """C(p) = K1(p)/(K0(p) + K1(p)) for growing, steady and decaying motion e^(p tau).

    Analytic in the whole plane but for a cut along the negative real axis, on which the value from above is returned.
    Off the imaginary axis it is the transfer function of motion started from rest; for a decaying motion it is the
    analytic continuation, the same function that the poles of the Laplace-transformed equations of motion see. In the
    far left half-plane, off the cut, it tends to 1/2 as everywhere.

    Parameters
    ----------
    p : array_like, shape (...)
        Reduced Laplace variable s*b/V, real or complex. [-]

    Returns
    -------
    C : complex ndarray, shape (...)
        C(p) = 1 at p = 0, 1/2 as |p| grows, C(conj p) = conj C(p). [-]

    Raises
    ------
    ValueError
        If any p is not finite.

    References
    ----------
    J. W. Edwards, Stanford SUDAAR 504, 1977 (the generalized Theodorsen function); equations.md, [3.12].

    Examples
    --------
    >>> np.round(generalized_theodorsen_function([0.0, 0.1j, 0.05 + 0.1j, 0.1]), 4)
    array([1.    +0.j    , 0.8319-0.1723j, 0.8022-0.1174j, 0.8024+0.j    ])
    """
    p = np.asarray(p, dtype=complex)
    if np.all((p.real == 0.0) & (p.imag >= 0.0) & (p.imag < np.inf)):
        return theodorsen_function(p.imag)  # on the axis: real Bessel functions, five times faster
    K0, K1 = scaled_macdonald(p)
    return 1.0 / (1.0 + K0 / K1)


def scaled_macdonald(p: ArrayLike) -> tuple[Complex, Complex]:
    """Modified Bessel functions of the second kind e^p K0(p) and e^p K1(p), which neither over- nor underflow.

    Parameters
    ----------
    p : array_like, shape (...)
        Argument, any finite complex number; |p| < 1e-300 is raised to 1e-300. On the cut, from above. [-]

    Returns
    -------
    K0, K1 : complex ndarray, shape (...)
        The two functions, each times e^p. [-]

    Raises
    ------
    ValueError
        If any p is not finite.

    References
    ----------
    NIST Digital Library of Mathematical Functions, 10.25, 10.40.2 (used for |p| > 40).

    Examples
    --------
    >>> K0, K1 = scaled_macdonald(1.0)
    >>> print(f"{K0.real:.6f} {K1.real:.6f}")
    1.144463 1.636153
    """
    p = np.asarray(p, dtype=complex)
    if not np.all(np.isfinite(p)):
        raise ValueError(f"reduced Laplace variable p must be finite [-], got {p[~np.isfinite(p)].flat[0]:g}")
    size = np.abs(p)
    far = size > _FAR
    near = np.where(far, _FAR, np.where(size < _TINY, _TINY, p))
    K0, K1 = kve(0, near), kve(1, near)
    if np.any(far):
        z = np.where(far, p, _FAR)
        S0, S1 = _asymptotic(1.0 / z)
        # principal root of p, not of 1/p: on the cut from above
        front = np.sqrt(np.pi / 2) / np.sqrt(z.real + 1j * np.where(z.imag == 0.0, 0.0, z.imag))
        K0, K1 = np.where(far, front * S0, K0), np.where(far, front * S1, K1)
    return K0, K1


def _asymptotic(u: NDArray) -> tuple[Complex, Complex]:
    """Series of K0 and K1 in u = 1/p without the front factor sqrt(pi/(2p)) e^-p; 18 terms, 1e-16 at |p| = 40."""
    sums = []
    for nu in (0, 1):
        coefficients = [1.0]
        for m in range(1, 19):
            coefficients.append(coefficients[-1] * (4 * nu**2 - (2 * m - 1) ** 2) / (8 * m))
        sums.append(np.polynomial.polynomial.polyval(u, coefficients))
    return sums[0], sums[1]
