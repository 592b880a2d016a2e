"""Lift after a step: Wagner's and Küssner's functions, their usual approximations, and Sears' function.

s is the distance travelled in semichords, V t/b. Wagner's function is the circulatory lift after a sudden change of
incidence, Küssner's the lift after the leading edge has met a sharp-edged gust, both as parts of the final value, for
a thin aerofoil in incompressible two-dimensional flow at constant speed.

Both are inverse Laplace transforms with one branch cut, the negative real axis. On it they become
1 - integral of a positive weight times exp(-s x), a continuous row of first-order lags; the approximations with
exponentials replace that row by two. Quadrature is the trapezoidal rule in ln x, which converges geometrically here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import i0e, i1e, k0e, k1e

from aeroservo.aero.lift_deficiency import scaled_macdonald
from aeroservo.datatypes import frozen

__all__ = [
    "KUSSNER_LEISHMAN",
    "KUSSNER_SEARS_SPARKS",
    "WAGNER_R_T_JONES",
    "WAGNER_W_P_JONES",
    "IndicialFunction",
    "garrick_wagner",
    "kussner_function",
    "rational_kussner",
    "sears_function",
    "wagner_function",
]

Real = NDArray[np.floating]
Complex = NDArray[np.complexfloating]

_BLOCK = 4096  # arguments per pass: bounds the memory of the outer product
_STEP = 0.2  # of the trapezoidal rule in ln x


def wagner_function(s: ArrayLike) -> Real:
    """Wagner's function: circulatory lift after a step of incidence, over its final value.

    Exact to 1e-14 by quadrature. Near the start 1/2 + s/8, far on 1 - 1/s.

    Parameters
    ----------
    s : array_like, shape (...)
        Distance travelled since the step, V t/b, in semichords; infinity included. [-]

    Returns
    -------
    phi : ndarray, shape (...)
        1/2 at s = 0, towards 1; 0 for s < 0, before the step. [-]

    Raises
    ------
    ValueError
        If any s is not a number.

    References
    ----------
    H. Wagner, ZAMM 5, 1925; equations.md "Aerodynamics"; weight derived from C(p)/p on its cut.

    Examples
    --------
    >>> np.round(wagner_function([0.0, 1.0, 10.0]), 6)
    array([0.5     , 0.600606, 0.875045])
    """
    return _step_response(s, *_wagner_lags(), start=0.5)


def kussner_function(s: ArrayLike) -> Real:
    """Küssner's function: lift after entry into a sharp-edged gust, over its final value.

    Exact to 1e-13 by quadrature. The leading edge meets the gust at s = 0; near the start sqrt(2 s)/pi, with an
    infinite slope, far on 1 - 1/s. The lift acts at the quarter chord throughout.

    Parameters
    ----------
    s : array_like, shape (...)
        Distance the leading edge has gone into the gust, V t/b, in semichords; infinity included. [-]

    Returns
    -------
    psi : ndarray, shape (...)
        0 at and before s = 0, towards 1. [-]

    Raises
    ------
    ValueError
        If any s is not a number.

    References
    ----------
    H. G. Küssner, Luftfahrtforschung 13, 1936; Th. von Kármán and W. R. Sears, J. Aeronautical Sciences 5, 1938;
    equations.md, "Aerodynamics"; weight derived from Sears' function over p on its cut.

    Examples
    --------
    >>> np.round(kussner_function([0.0, 1.0, 10.0]), 6)
    array([0.      , 0.416695, 0.856137])
    """
    return _step_response(s, *_kussner_lags(), start=0.0)


def _step_response(s: ArrayLike, rates: Real, weights: Real, *, start: float) -> Real:
    """1 - sum of weights exp(-rates s) for s > 0, `start` at 0, 0 before."""
    s = np.asarray(s, dtype=float)
    if np.any(np.isnan(s)):
        raise ValueError("distance travelled s must be a number [semichords], got nan")
    flat = np.where(s > 0.0, np.minimum(s, 1e30), 1.0).ravel()  # 1e30: every lag has died, without inf * 0
    out = np.empty_like(flat)
    for i in range(0, flat.size, _BLOCK):
        block = flat[i : i + _BLOCK]
        alive = rates * block.min() < 50.0
        out[i : i + _BLOCK] = 1.0 - np.exp(-block[:, None] * rates[alive]) @ weights[alive]
    return np.where(s > 0.0, out.reshape(s.shape), np.where(s == 0.0, start, 0.0))


@cache
def _wagner_lags() -> tuple[Real, Real]:
    """Decay rates x and weights of Wagner's lags: 1/(x^2 [(K0 - K1)^2 + pi^2 (I0 + I1)^2]) dx."""
    x = np.exp(np.arange(-40.0, 4.0, _STEP))
    K_part, I_part = np.exp(-x) * (k0e(x) - k1e(x)), np.pi * np.exp(x) * (i0e(x) + i1e(x))
    return x, _STEP / (x * (K_part**2 + I_part**2))


@cache
def _kussner_lags() -> tuple[Real, Real]:
    """Decay rates x and weights of Küssner's lags: e^x (I0 + I1)/(x^2 [(K0 - K1)^2 + pi^2 (I0 + I1)^2]) dx.

    For x -> inf the weight falls as x^(-3/2) only (the square root at the start of Küssner's function), hence the
    long range of ln x.
    """
    x = np.exp(np.arange(-40.0, 66.0, _STEP))
    K_part, I_part = np.exp(-2.0 * x) * (k0e(x) - k1e(x)), np.pi * (i0e(x) + i1e(x))
    return x, _STEP / np.pi * I_part / (x * (K_part**2 + I_part**2))


@dataclass(frozen=True, kw_only=True, eq=False)
class IndicialFunction:
    """A step response made of exponentials, constant - sum_j A_j exp(-b_j s): the lags of a state space.

    Parameters
    ----------
    constant : float
        Final value, 1 for the approximations of Wagner's and Küssner's functions. [-]
    amplitudes : ndarray, shape (n_lags,)
        A_j. [-]
    exponents : ndarray, shape (n_lags,)
        b_j, positive: lag states of poles -b_j V/b, with b the semichord. [-]
    name : str
        What it approximates and whose it is.

    Raises
    ------
    ValueError
        If the two arrays differ in length, are not finite, or an exponent is not positive.

    References
    ----------
    equations.md, "One equation of motion" and "Aerodynamics".

    Examples
    --------
    >>> float(WAGNER_R_T_JONES(0.0)), WAGNER_R_T_JONES.exponents.tolist()
    (0.5, [0.0455, 0.3])
    """

    constant: float  # [-]
    amplitudes: Real  # (n_lags,)  [-]
    exponents: Real  # (n_lags,)  [-]
    name: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "constant", float(frozen(self.constant, ndim=0, name="constant")))
        object.__setattr__(self, "amplitudes", frozen(self.amplitudes, ndim=1, name="amplitudes"))
        object.__setattr__(self, "exponents", frozen(self.exponents, ndim=1, name="exponents"))
        if self.amplitudes.shape != self.exponents.shape:
            raise ValueError(
                f"amplitudes and exponents must be of one length, got {self.amplitudes.size} and {self.exponents.size}"
            )
        if not np.all(self.exponents > 0.0):
            raise ValueError(f"exponents must be positive [-], got {self.exponents.min():g}")

    def __call__(self, s: ArrayLike) -> Real:
        """Response to a unit step.

        Parameters
        ----------
        s : array_like, shape (...)
            Distance travelled since the step, V t/b, in semichords. [-]

        Returns
        -------
        response : ndarray, shape (...)
            constant - sum_j A_j exp(-b_j s); 0 for s < 0. [-]

        Raises
        ------
        ValueError
            If any s is not a number.

        References
        ----------
        equations.md, "Aerodynamics".

        Examples
        --------
        >>> round(float(WAGNER_R_T_JONES(10.0)), 4)
        0.8786
        """
        s = np.asarray(s, dtype=float)
        if np.any(np.isnan(s)):
            raise ValueError("distance travelled s must be a number [semichords], got nan")
        after = self.constant - np.exp(-np.maximum(s, 0.0)[..., None] * self.exponents) @ self.amplitudes
        return np.where(s >= 0.0, after, 0.0)

    def frequency_response(self, p: ArrayLike) -> Complex:
        """Transfer function p times the transform of the step response.

        For an approximation of Wagner's function this is its C(p), to be given to `SectionAir` as the deficiency; for
        one of Küssner's it is Sears' function referred to the leading edge.

        Parameters
        ----------
        p : array_like, shape (...)
            Reduced Laplace variable s*b/V, complex; ik for harmonic motion. [-]

        Returns
        -------
        C : complex ndarray, shape (...)
            constant - sum_j A_j p/(p + b_j). [-]

        Raises
        ------
        ValueError
            If any p is not finite or is one of the poles -b_j.

        References
        ----------
        equations.md, "One equation of motion".

        Examples
        --------
        >>> np.round(WAGNER_R_T_JONES.frequency_response([0.0, 0.1j, 1e9j]), 4)
        array([1.    +0.j    , 0.8298-0.1627j, 0.5   -0.j    ])
        """
        p = np.asarray(p, dtype=complex)
        if not np.all(np.isfinite(p)):
            raise ValueError("reduced Laplace variable p must be finite [-]")
        shifted = p[..., None] + self.exponents
        if np.any(shifted == 0.0):
            raise ValueError(f"reduced Laplace variable p must not be a pole, one of {(-self.exponents).tolist()} [-]")
        return np.asarray(self.constant - (p[..., None] / shifted) @ self.amplitudes)


#: R. T. Jones' approximation of Wagner's function (NACA Report 681, 1940).
WAGNER_R_T_JONES = IndicialFunction(
    constant=1.0, amplitudes=np.array([0.165, 0.335]), exponents=np.array([0.0455, 0.3]), name="Wagner, R. T. Jones"
)
#: W. P. Jones' approximation of Wagner's function (ARC R&M 2117, 1945).
WAGNER_W_P_JONES = IndicialFunction(
    constant=1.0, amplitudes=np.array([0.165, 0.335]), exponents=np.array([0.041, 0.32]), name="Wagner, W. P. Jones"
)
#: Sears' and Sparks' approximation of Küssner's function (J. Aeronautical Sciences 9, 1941).
KUSSNER_SEARS_SPARKS = IndicialFunction(
    constant=1.0, amplitudes=np.array([0.5, 0.5]), exponents=np.array([0.13, 1.0]), name="Küssner, Sears & Sparks"
)
#: Leishman's approximation of Küssner's function (Principles of Helicopter Aerodynamics).
KUSSNER_LEISHMAN = IndicialFunction(
    constant=1.0, amplitudes=np.array([0.5792, 0.4208]), exponents=np.array([0.1393, 1.802]), name="Küssner, Leishman"
)


def garrick_wagner(s: ArrayLike) -> Real:
    """Garrick's approximation of Wagner's function, (s + 2)/(s + 4), which has no finite state space.

    Parameters
    ----------
    s : array_like, shape (...)
        Distance travelled since the step, V t/b, in semichords. [-]

    Returns
    -------
    phi : ndarray, shape (...)
        Within 0.0202 of Wagner's function; 0 for s < 0. [-]

    Raises
    ------
    ValueError
        If any s is not a number.

    References
    ----------
    Bramstång 2015, Eq. 3.10; I. E. Garrick, NACA Report 629, 1938.

    Examples
    --------
    >>> garrick_wagner([0.0, 4.0])
    array([0.5 , 0.75])
    """
    return _after_start(s, lambda s: 1.0 - 2.0 / (s + 4.0))


def rational_kussner(s: ArrayLike) -> Real:
    """Küssner's function as a ratio of polynomials, (s^2 + s)/(s^2 + 2.82 s + 0.80), which has no finite state space.

    Parameters
    ----------
    s : array_like, shape (...)
        Distance the leading edge has gone into the gust, V t/b, in semichords. [-]

    Returns
    -------
    psi : ndarray, shape (...)
        Within 0.0446 of Küssner's function; 0 for s < 0. [-]

    Raises
    ------
    ValueError
        If any s is not a number.

    References
    ----------
    As quoted in R. L. Bisplinghoff, H. Ashley, R. L. Halfman, Aeroelasticity, 1955, chapter 5.

    Examples
    --------
    >>> round(float(rational_kussner(1.0)), 4)
    0.4329
    """
    return _after_start(s, lambda s: 1.0 - (1.82 * s + 0.80) / (s**2 + 2.82 * s + 0.80))


def _after_start(s: ArrayLike, response: Callable[[Real], Real]) -> Real:
    """Response for s >= 0, 0 before."""
    s = np.asarray(s, dtype=float)
    if np.any(np.isnan(s)):
        raise ValueError("distance travelled s must be a number [semichords], got nan")
    return np.where(s >= 0.0, response(np.clip(s, 0.0, 1e30)), 0.0)


def sears_function(k: ArrayLike, *, reference: Literal["leading_edge", "midchord"] = "leading_edge") -> Complex:
    """Sears' function: lift of a thin aerofoil in a sinusoidal gust over its quasi-steady value.

    The lift acts at the quarter chord. Where the gust's phase is referred to matters: an aerofoil meets the gust at
    its leading edge, and Küssner's function is the step response of that choice; the textbook curve has the gust's
    phase at mid-chord, exp(ik) ahead of it.

    Parameters
    ----------
    k : array_like, shape (...)
        Reduced frequency omega*b/V, real and >= 0; complex values are taken as p = ik. [-]
    reference : {"leading_edge", "midchord"}
        The point at which the gust's phase is zero.

    Returns
    -------
    S : complex ndarray, shape (...)
        1/(p (K0(p) + K1(p))) at mid-chord, exp(-p) times that at the leading edge, p = ik; 1 at k = 0. [-]

    Raises
    ------
    ValueError
        If any real k is negative, any k not finite, or `reference` is neither point.

    References
    ----------
    W. R. Sears, J. Aeronautical Sciences 8, 1941; equations.md, "One equation of motion" (phase at the leading edge).

    Examples
    --------
    >>> np.round(sears_function([0.0, 0.4]), 4)
    array([1.  +0.j    , 0.49-0.2994j])
    >>> np.round(sears_function(0.4, reference="midchord"), 4)
    np.complex128(0.5679-0.0849j)
    """
    if reference not in ("leading_edge", "midchord"):
        raise ValueError(f'reference must be "leading_edge" or "midchord", got {reference!r}')
    k = np.asarray(k)
    if not np.iscomplexobj(k) and not np.all(k >= 0.0):
        raise ValueError(f"reduced frequency k must be >= 0 [-], got {k[~(k >= 0.0)].flat[0]:g}")
    if not np.all(np.isfinite(k)):
        raise ValueError("reduced frequency k must be finite [-]")
    p = 1j * k
    K0, K1 = scaled_macdonald(p)
    zero = p == 0.0
    S = np.where(zero, 1.0, 1.0 / (np.where(zero, 1.0, p) * (K0 + K1)))
    return S * np.exp(p) if reference == "midchord" else S
