"""Theodorsen's oscillating thin aerofoil: the air forces of a section, with a flap or without.

Two-dimensional, incompressible, inviscid, small motion about a flat wake; the flap's gap is sealed. The theory stops
being valid at compressible speed, at stall, and for hinge moments of real flaps, whose boundary layer takes away up to
half of the potential value.

Section conventions: plunge h positive down, pitch theta nose up about an axis a semichords aft of mid-chord, flap beta
trailing edge down relative to the chord about a hinge `hinge` semichords aft of mid-chord. b is the semichord and
p = s b/V the reduced Laplace variable, p = ik in harmonic motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.aero.flap import FlapFunctions, flap_functions
from aeroservo.aero.lift_deficiency import generalized_theodorsen_function, scaled_macdonald, theodorsen_function
from aeroservo.datatypes import frozen

__all__ = [
    "FlapFunctions",
    "OscillatoryDerivatives",
    "SectionAir",
    "flap_functions",
    "generalized_theodorsen_function",
    "oscillatory_derivatives",
    "scaled_macdonald",
    "section_air",
    "theodorsen_function",
]

Real = NDArray[np.floating]
Complex = NDArray[np.complexfloating]


@dataclass(frozen=True, kw_only=True, eq=False)
class SectionAir:
    """Air forces of oscillating sections, Q(p) = A0 + A1 p + A2 p^2 + C(p) R (w0 + w1 p), per unit span.

    The forces [-L, M, H] = q_bar Q(p) [h, theta, beta] do work on plunge h (down, m), pitch theta (nose up, rad) and
    flap beta (trailing edge down relative to the chord, rad); H is the hinge moment. Without a flap n = 2, else 3.
    (w0 + w1 p) times the motion is Theodorsen's circulatory downwash over V, that of the three-quarter chord point
    when there is no flap. R alone is also the column of a gust: q_bar R S(k) w_g/V with w_g up and S Sears' function.

    Parameters
    ----------
    A0, A1, A2 : ndarray, shape (..., n, n)
        Forces without wake memory on position, rate and acceleration. Rows [m, m^2, m^2]; columns [1/m, 1, 1]; the
        acceleration column is the apparent mass, symmetric in the variables above. [see rows and columns]
    R : ndarray, shape (..., n)
        Circulatory force on each coordinate per unit downwash angle. [m, m^2, m^2]
    w0, w1 : ndarray, shape (..., n)
        Downwash angle per coordinate and per reduced rate. [1/m, 1, 1]

    References
    ----------
    Bramstång 2015, Eqs. 3.13-3.14 as put right in equations.md; T. Theodorsen, NACA Report 496, 1935.

    Examples
    --------
    >>> air = section_air(a=-0.4, b=0.3048)
    >>> np.round(air(0.0).real, 4)  # steady: lift slope 2 pi at the quarter chord, 0.1 semichords ahead of the axis
    array([[ 0.    , -3.8302],
           [ 0.    ,  0.1167]])
    """

    A0: Real  # (..., n, n)
    A1: Real  # (..., n, n)
    A2: Real  # (..., n, n)
    R: Real  # (..., n)
    w0: Real  # (..., n)
    w1: Real  # (..., n)

    def __post_init__(self) -> None:
        _freeze(self)
        n = self.R.shape[-1]
        if self.A0.shape[-2:] != (n, n) or not self.A0.shape == self.A1.shape == self.A2.shape:
            raise ValueError(
                f"A0, A1, A2 must be (..., {n}, {n}), got {self.A0.shape}, {self.A1.shape}, {self.A2.shape}"
            )
        if not self.w0.shape == self.w1.shape == self.R.shape == self.A0.shape[:-1]:
            raise ValueError(
                f"R, w0, w1 must be {self.A0.shape[:-1]}, got {self.R.shape}, {self.w0.shape}, {self.w1.shape}"
            )

    def __call__(
        self, p: ArrayLike, deficiency: Callable[[Complex], NDArray] = generalized_theodorsen_function
    ) -> Complex:
        """Air-force matrix at reduced Laplace variables.

        Parameters
        ----------
        p : array_like, shape (...)
            s*b/V, complex; ik for harmonic motion. Broadcasts against the sections' own leading axes. [-]
        deficiency : callable
            C(p); Theodorsen's by default, an `IndicialFunction.frequency_response` for lag states.

        Returns
        -------
        Q : complex ndarray, shape (..., n, n)
            Force per unit span over dynamic pressure. [rows m, m^2, m^2; columns 1/m, 1, 1]

        Raises
        ------
        ValueError
            If any p is not finite.

        References
        ----------
        Bramstång 2015, Eqs. 3.12-3.14 as put right in equations.md.

        Examples
        --------
        >>> section_air(a=-0.4, b=[1.0, 2.0, 3.0])(np.array([0.1j, 0.2j])[:, None]).shape
        (2, 3, 2, 2)
        """
        p = np.asarray(p, dtype=complex)
        C = np.asarray(deficiency(p))[..., None]
        p = p[..., None]
        circulatory = (C * self.R)[..., :, None] * (self.w0 + self.w1 * p)[..., None, :]
        p = p[..., None]
        return self.A0 + (self.A1 + self.A2 * p) * p + circulatory


def section_air(
    a: ArrayLike, b: ArrayLike, *, lift_slope: ArrayLike = 2.0 * np.pi, hinge: ArrayLike | None = None
) -> SectionAir:
    """Theodorsen's air forces of one section or many, without a flap or with one.

    Parameters
    ----------
    a : array_like, shape (...)
        Pitch axis, semichords aft of mid-chord. [-]
    b : array_like, shape (...)
        Semichord, positive. [m]
    lift_slope : array_like, shape (...)
        Circulatory lift slope a_1: 2 pi for the thin aerofoil, a finite-wing slope where that is wanted. It scales the
        circulatory part alone, hinge moment and flap lift included. [1/rad]
    hinge : array_like, shape (...), optional
        Flap hinge, semichords aft of mid-chord, from -1 to below 1. None: no flap, two degrees of freedom. [-]

    Returns
    -------
    air : SectionAir
        Forces on (h, theta) or (h, theta, beta); batch axes are the broadcast of the arguments.

    Raises
    ------
    ValueError
        If b is not positive, a hinge is off the chord, or anything is not finite.

    References
    ----------
    Bramstång 2015, Eqs. 3.13-3.14 as put right in equations.md; T. Theodorsen, NACA Report 496, 1935, P, M_alpha,
    M_beta.

    Examples
    --------
    >>> air = section_air(a=0.0, b=1.0, hinge=0.5)
    >>> round(float(-air(0.0)[0, 2].real / 2.0), 4)  # lift slope of a quarter-chord flap: cl_delta over q c
    3.8264
    """
    a, b = frozen(a, name="pitch axis a"), frozen(b, name="semichord b")
    slope = frozen(lift_slope, name="lift_slope")
    if not np.all(b > 0.0):
        raise ValueError(f"semichord b must be positive [m], got {b.min():g}")
    pi, half, o = np.pi, 0.5 - a, np.zeros(())
    if hinge is None:
        return _section(
            A0=[[o, o], [o, o]],
            A1=[[o, -2 * pi * b], [o, -2 * pi * b**2 * half]],
            A2=[[-2 * pi + o, 2 * pi * a * b], [2 * pi * a * b, -2 * pi * b**2 * (0.125 + a**2)]],
            R=[-2 * slope * b, 2 * slope * b**2 * (a + 0.5)],
            w0=[o, 1 + o],
            w1=[1 / b, half],
        )
    T, c = flap_functions(hinge, a), frozen(hinge, name="hinge")
    T16 = T.T1 - T.T8 - (c - a) * T.T4 + 0.5 * T.T11
    T17 = -2 * T.T9 - T.T1 + T.T4 * (a - 0.5)
    M_bb = 2 * b**2 * (T.T7 + (c - a) * T.T1)
    return _section(
        A0=[[o, o, o], [o, o, -2 * b**2 * (T.T4 + T.T10)], [o, o, -2 / pi * b**2 * (T.T5 - T.T4 * T.T10)]],
        A1=[
            [o, -2 * pi * b, 2 * b * T.T4],
            [o, -2 * pi * b**2 * half, -2 * b**2 * T16],
            [o, -2 * b**2 * T17, b**2 * T.T4 * T.T11 / pi],
        ],
        A2=[
            [-2 * pi + o, 2 * pi * a * b, 2 * b * T.T1],
            [2 * pi * a * b, -2 * pi * b**2 * (0.125 + a**2), M_bb],
            [2 * b * T.T1, -4 * b**2 * T.T13, 2 / pi * b**2 * T.T3],
        ],
        R=[-2 * slope * b, 2 * slope * b**2 * (a + 0.5), -slope / pi * b**2 * T.T12],
        w0=[o, 1 + o, T.T10 / pi],
        w1=[1 / b, half, T.T11 / (2 * pi)],
    )


def _section(
    *,
    A0: Sequence[Sequence[Real]],
    A1: Sequence[Sequence[Real]],
    A2: Sequence[Sequence[Real]],
    R: Sequence[Real],
    w0: Sequence[Real],
    w1: Sequence[Real],
) -> SectionAir:
    """Stack entries of any broadcastable shape into matrices with leading batch axes."""
    n = len(R)
    entries = [*(x for A in (A0, A1, A2) for row in A for x in row), *R, *w0, *w1]
    flat = np.stack(np.broadcast_arrays(*entries), axis=-1)
    A = flat[..., : 3 * n * n].reshape(*flat.shape[:-1], 3, n, n)
    v = flat[..., 3 * n * n :].reshape(*flat.shape[:-1], 3, n)
    return SectionAir(
        A0=A[..., 0, :, :], A1=A[..., 1, :, :], A2=A[..., 2, :, :], R=v[..., 0, :], w0=v[..., 1, :], w1=v[..., 2, :]
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class OscillatoryDerivatives:
    """Oscillatory derivatives of a section at a reduced frequency.

    L = rho V^2 (L_h h + L_hdot b hdot/V + L_theta b theta + L_thetadot b^2 thetadot/V) and M = rho V^2 b (M_h h + ...)
    per unit span, lift up, moment nose up about the axis.

    Parameters
    ----------
    L_h, L_hdot, L_theta, L_thetadot, M_h, M_hdot, M_theta, M_thetadot : ndarray, shape (...)
        The eight derivatives. [-]

    References
    ----------
    Bramstång 2015, appendix, Eqs. .1-.2 as put right in equations.md.

    Examples
    --------
    >>> print(f"{oscillatory_derivatives(0.3, a=-0.04).M_thetadot:.4f}")
    -2.3862
    """

    L_h: Real  # (...)  [-]
    L_hdot: Real  # (...)  [-]
    L_theta: Real  # (...)  [-]
    L_thetadot: Real  # (...)  [-]
    M_h: Real  # (...)  [-]
    M_hdot: Real  # (...)  [-]
    M_theta: Real  # (...)  [-]
    M_thetadot: Real  # (...)  [-]

    def __post_init__(self) -> None:
        _freeze(self)


def oscillatory_derivatives(
    k: ArrayLike, a: ArrayLike, *, lift_slope: ArrayLike = 2.0 * np.pi
) -> OscillatoryDerivatives:
    """Oscillatory derivatives L_h ... M_thetadot of Theodorsen's section, the same forces as `section_air` at p = ik.

    As k falls to 0, G -> k (ln(k/2) + 0.5772...) and kG -> 0, so that L_h and M_h vanish, L_hdot, L_theta -> a_1 and
    M_hdot, M_theta -> a_1 (a + 1/2). G/k does not converge: L_thetadot and M_thetadot grow as ln k (unless a = -1/2,
    for M). The force does converge, because thetadot falls with k; at k = 0 use `section_air`.

    Parameters
    ----------
    k : array_like, shape (...)
        Reduced frequency omega*b/V, positive and finite. [-]
    a : array_like, shape (...)
        Pitch axis, semichords aft of mid-chord. [-]
    lift_slope : array_like, shape (...)
        Circulatory lift slope a_1, which scales F and G alone. [1/rad]

    Returns
    -------
    derivatives : OscillatoryDerivatives
        Eight derivatives of the broadcast shape (...).

    Raises
    ------
    ValueError
        If any k is not positive and finite, or another argument not finite.

    References
    ----------
    Bramstång 2015, appendix, Eqs. .1-.2, with 1/8 (not 1/9) in M_theta and no factor k in M_thetadot: equations.md.

    Examples
    --------
    >>> d = oscillatory_derivatives([0.01, 0.4], a=0.0)
    >>> np.round(d.L_theta, 3)
    array([6.174, 4.134])
    """
    k, a, slope = (
        frozen(x, name=name)
        for x, name in ((k, "reduced frequency k"), (a, "pitch axis a"), (lift_slope, "lift_slope"))
    )
    if not np.all(k > 0.0):
        raise ValueError(f"reduced frequency k must be positive [-] (at 0 G/k has no limit), got {k.min():g}")
    C = theodorsen_function(k)
    F, G, half, arm = C.real, C.imag, 0.5 - a, a + 0.5
    pi_k2 = np.pi * k**2
    on_angle, on_rate = slope * (F - k * G * half), slope * (F * half + G / k)
    shape = np.broadcast_shapes(k.shape, a.shape, slope.shape)
    L_h, L_hdot, L_theta, L_thetadot, M_h, M_hdot, M_theta, M_thetadot = (
        np.broadcast_to(x, shape)
        for x in (
            -pi_k2 - slope * k * G,
            slope * F,
            pi_k2 * a + on_angle,
            np.pi + on_rate,
            -pi_k2 * a - slope * k * arm * G,
            slope * arm * F,
            pi_k2 * (0.125 + a**2) + arm * on_angle,
            -np.pi * half + arm * on_rate,
        )
    )
    return OscillatoryDerivatives(
        L_h=L_h, L_hdot=L_hdot, L_theta=L_theta, L_thetadot=L_thetadot,
        M_h=M_h, M_hdot=M_hdot, M_theta=M_theta, M_thetadot=M_thetadot,
    )  # fmt: skip


def _freeze(record: SectionAir | OscillatoryDerivatives) -> None:
    """Lock every array of a record."""
    for field in fields(record):
        object.__setattr__(record, field.name, frozen(getattr(record, field.name), name=field.name))
