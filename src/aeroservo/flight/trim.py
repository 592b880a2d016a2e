"""Longitudinal trim, static margin and the shift of the moment point.

Coefficients are those of the whole aircraft: lift up, moment nose up, elevon trailing edge down, incidence from any
fixed line of the aircraft; rates by c/(2V). Thrust acts along the flight path through the centre of gravity, and does
not change with speed. Linear lift and moment, drag quadratic in lift: no stall, no Mach number.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.atmosphere import STANDARD_GRAVITY
from aeroservo.datatypes import frozen
from aeroservo.flight.derivatives import StabilityDerivatives
from aeroservo.flight.rigid import Airframe

__all__ = [
    "LongitudinalCoefficients",
    "TrimState",
    "about_centre_of_gravity",
    "neutral_point",
    "static_margin",
    "trim_derivatives",
    "trim_level",
]

Array = NDArray[Any]


@dataclass(frozen=True, kw_only=True)
class LongitudinalCoefficients:
    """Longitudinal coefficients of an aircraft about one moment point.

    Attributes
    ----------
    CL0, CL_alpha, CL_delta : float
        Lift at zero incidence [-], per radian of incidence and of elevon. [1/rad]
    CM0, CM_alpha, CM_delta : float
        The same of the moment, nose up, by the chord. [-, 1/rad, 1/rad]
    CL_q, CM_q, CL_alphadot, CM_alphadot : float
        Per q c/(2V) and per alpha-dot c/(2V). [-]
    CD0, CD_CL2 : float
        CD = CD0 + CD_CL2 CL^2, not negative. [-]
    x : float
        Moment point, aft of the datum. [m]
    """

    CL0: float
    CL_alpha: float
    CM0: float
    CM_alpha: float
    CL_delta: float = 0.0
    CM_delta: float = 0.0
    CL_q: float = 0.0
    CM_q: float = 0.0
    CL_alphadot: float = 0.0
    CM_alphadot: float = 0.0
    CD0: float = 0.0
    CD_CL2: float = 0.0
    x: float = 0.0

    def __post_init__(self) -> None:
        if not self.CL_alpha > 0.0:
            raise ValueError(f"CL_alpha must be positive [1/rad], got {self.CL_alpha:g}")
        if not (self.CD0 >= 0.0 and self.CD_CL2 >= 0.0):
            raise ValueError(f"CD0 and CD_CL2 must not be negative [-], got {self.CD0:g} and {self.CD_CL2:g}")


@dataclass(frozen=True, kw_only=True, eq=False)
class TrimState:
    """Straight steady flight.

    Attributes
    ----------
    alpha, delta : ndarray, shape (...)
        Incidence and elevon. [rad]
    thrust : ndarray, shape (...)
        Along the flight path. [N]
    CL, CD : ndarray, shape (...)
        Lift and drag coefficient. [-]
    V, rho, gamma : ndarray, shape (...)
        Airspeed [m/s], density [kg/m^3], climb angle [rad].
    """

    alpha: Array
    delta: Array
    thrust: Array
    CL: Array
    CD: Array
    V: Array
    rho: Array
    gamma: Array

    def __post_init__(self) -> None:
        for name in ("alpha", "delta", "thrust", "CL", "CD", "V", "rho", "gamma"):
            object.__setattr__(self, name, frozen(getattr(self, name), name=name))

    def __getitem__(self, index: Any) -> TrimState:
        """One trim, or a part, of a sweep."""
        names = ("alpha", "delta", "thrust", "CL", "CD", "V", "rho", "gamma")
        return TrimState(**{name: getattr(self, name)[index] for name in names})


def about_centre_of_gravity(
    coefficients: LongitudinalCoefficients, x_cg: float, chord: float
) -> LongitudinalCoefficients:
    """The same aircraft's coefficients about another moment point.

    Moving the point aft by d chords adds d CL to the moment; pitching about it lowers the incidence at the old point
    by 2 d q c/(2V). The arm of the drag and the lag of alpha-dot between the points are neglected.

    Parameters
    ----------
    coefficients : LongitudinalCoefficients
        About the point `coefficients.x`.
    x_cg : float
        New moment point, aft of the same datum. [m]
    chord : float
        Reference chord of the moment and of the rates, positive. [m]

    Returns
    -------
    moved : LongitudinalCoefficients
        About x_cg.

    Raises
    ------
    ValueError
        If the chord is not positive.

    References
    ----------
    Bramstång 2015, Eq. 6.3 (x_cg positive aft); B. Etkin and L. D. Reid, 1996, sections 2.2-2.3.

    Examples
    --------
    >>> wing = LongitudinalCoefficients(CL0=0.0, CL_alpha=4.0, CM0=0.0, CM_alpha=0.0)
    >>> about_centre_of_gravity(wing, 0.1, 0.5).CM_alpha
    0.8
    """
    if not chord > 0.0:
        raise ValueError(f"chord must be positive [m], got {chord:g}")
    k, d = coefficients, (x_cg - coefficients.x) / chord
    CL_q = k.CL_q - 2.0 * d * k.CL_alpha
    return replace(
        k,
        CM0=k.CM0 + d * k.CL0,
        CM_alpha=k.CM_alpha + d * k.CL_alpha,
        CM_delta=k.CM_delta + d * k.CL_delta,
        CL_q=CL_q,
        CM_q=k.CM_q - 2.0 * d * k.CM_alpha + d * CL_q,
        CM_alphadot=k.CM_alphadot + d * k.CL_alphadot,
        x=x_cg,
    )


def neutral_point(coefficients: LongitudinalCoefficients, chord: float) -> float:
    """Position of the neutral point.

    Parameters
    ----------
    coefficients : LongitudinalCoefficients
        About any point.
    chord : float
        Reference chord, positive. [m]

    Returns
    -------
    x_np : float
        x - c CM_alpha/CL_alpha, aft of the datum. [m]

    Raises
    ------
    ValueError
        If the chord is not positive.

    References
    ----------
    Bramstång 2015, Eq. 6.3 set to zero.

    Examples
    --------
    >>> neutral_point(LongitudinalCoefficients(CL0=0.0, CL_alpha=4.0, CM0=0.0, CM_alpha=-0.4), 0.5)
    0.05
    """
    if not chord > 0.0:
        raise ValueError(f"chord must be positive [m], got {chord:g}")
    return coefficients.x - chord * coefficients.CM_alpha / coefficients.CL_alpha


def static_margin(coefficients: LongitudinalCoefficients, x_cg: ArrayLike, chord: float) -> Array:
    """Static margin K_n = (x_np - x_cg)/c: positive is stable.

    Parameters
    ----------
    coefficients : LongitudinalCoefficients
        About any point.
    x_cg : array_like, shape (...)
        Centre of gravity, aft of the datum. [m]
    chord : float
        Reference chord, positive. [m]

    Returns
    -------
    K_n : ndarray, shape (...)
        Equal to -CM_alpha/CL_alpha about the centre of gravity. [-]

    Raises
    ------
    ValueError
        If the chord is not positive.

    References
    ----------
    Bramstång 2015, Eq. 6.3; equations.md, "Flight mechanics".

    Examples
    --------
    >>> wing = LongitudinalCoefficients(CL0=0.0, CL_alpha=4.0, CM0=0.0, CM_alpha=-0.4)
    >>> static_margin(wing, [0.0, 0.1], 0.5)
    array([ 0.1, -0.1])
    """
    return (neutral_point(coefficients, chord) - np.asarray(x_cg, dtype=float)) / chord


def trim_level(
    coefficients: LongitudinalCoefficients,
    airframe: Airframe,
    *,
    V: ArrayLike,
    rho: ArrayLike,
    gamma: ArrayLike = 0.0,
    gravity: float = STANDARD_GRAVITY,
) -> TrimState:
    """Incidence, elevon and thrust of straight steady flight.

    Parameters
    ----------
    coefficients : LongitudinalCoefficients
        About the centre of gravity.
    airframe : Airframe
        Mass and reference area.
    V : array_like, shape (...)
        True airspeed, positive. [m/s]
    rho : array_like, shape (...)
        Air density, positive. [kg/m^3]
    gamma : array_like, shape (...)
        Climb angle, within +/- 90 deg. [rad]
    gravity : float
        Acceleration of gravity. [m/s^2]

    Returns
    -------
    trim : TrimState
        The solution of L = W cos(gamma), M = 0, T = D + W sin(gamma), which is exact and unique.

    Raises
    ------
    ValueError
        If V or rho is not positive, gamma is out of range, or the elevon cannot trim (CL_alpha CM_delta = CL_delta
        CM_alpha: it moves the moment only as incidence does).

    References
    ----------
    Bramstång 2015, Eqs. 5.7-5.11 with all rates zero; thrust along the flight path.

    Examples
    --------
    >>> wing = LongitudinalCoefficients(CL0=0.0, CL_alpha=4.0, CM0=0.02, CM_alpha=-0.2, CL_delta=0.9, CM_delta=-0.3)
    >>> body = Airframe(mass=10.0, Ixx=1.0, Iyy=0.5, Izz=1.5)
    >>> trim = trim_level(wing, body, V=40.0, rho=1.225)
    >>> round(float(trim.CL), 6), bool(abs(0.02 - 0.2 * trim.alpha - 0.3 * trim.delta) < 1e-15)
    (0.100068, True)
    """
    V, rho, gamma = (np.asarray(x, dtype=float) for x in (V, rho, gamma))
    for name, unit, value in (("airspeed V", "m/s", V), ("density rho", "kg/m^3", rho)):
        if not np.all(value > 0.0):
            raise ValueError(f"{name} must be positive [{unit}], got {value.min():g}")
    if not np.all(np.abs(gamma) < 0.5 * np.pi):
        raise ValueError(
            f"climb angle gamma must lie within +/- pi/2 [rad], got {gamma.flat[np.abs(gamma).argmax()]:g}"
        )
    V, rho, gamma = np.broadcast_arrays(V, rho, gamma)
    k, qS, weight = coefficients, 0.5 * rho * V**2 * airframe.area, airframe.mass * gravity
    authority = k.CL_alpha * k.CM_delta - k.CL_delta * k.CM_alpha
    if abs(authority) <= 1e-12 * (abs(k.CL_alpha * k.CM_delta) + abs(k.CL_delta * k.CM_alpha)):
        raise ValueError(
            "the elevon cannot trim this aircraft: CL_alpha CM_delta - CL_delta CM_alpha must not be zero, "
            f"got CM_delta = {k.CM_delta:g}, CL_delta = {k.CL_delta:g} [1/rad]"
        )
    CL = weight * np.cos(gamma) / qS
    alpha = ((CL - k.CL0) * k.CM_delta + k.CL_delta * k.CM0) / authority
    delta = (-k.CL_alpha * k.CM0 - (CL - k.CL0) * k.CM_alpha) / authority
    CD = k.CD0 + k.CD_CL2 * CL**2
    thrust = qS * CD + weight * np.sin(gamma)
    return TrimState(alpha=alpha, delta=delta, thrust=thrust, CL=CL, CD=CD, V=V, rho=rho, gamma=gamma)


def trim_derivatives(
    coefficients: LongitudinalCoefficients, airframe: Airframe, trim: TrimState
) -> StabilityDerivatives:
    """Stability derivatives of an aircraft at one trim, thrust constant, no compressibility.

    Parameters
    ----------
    coefficients : LongitudinalCoefficients
        About the centre of gravity.
    airframe : Airframe
        Reference area.
    trim : TrimState
        One trim (scalars).

    Returns
    -------
    derivatives : StabilityDerivatives
        Longitudinal only: C_Xu = -2 C_T, C_Xalpha = CL - dCD/dalpha, C_Zalpha = -(CL_alpha + CD), C_Zu = C_Mu = 0.

    Raises
    ------
    ValueError
        If given a sweep of trims.

    References
    ----------
    B. Etkin and L. D. Reid, Dynamics of Flight, 3rd ed., 1996, section 5.1-5.5; Bramstång 2015, Eq. 5.24.

    Examples
    --------
    >>> wing = LongitudinalCoefficients(CL0=0.0, CL_alpha=4.0, CM0=0.02, CM_alpha=-0.2, CL_delta=0.9, CM_delta=-0.3)
    >>> body = Airframe(mass=10.0, Ixx=1.0, Iyy=0.5, Izz=1.5)
    >>> trim_derivatives(wing, body, trim_level(wing, body, V=40.0, rho=1.225)).CZ_alpha
    -4.0
    """
    if trim.alpha.ndim:
        raise ValueError(f"one trim is wanted, got a sweep of shape {trim.alpha.shape}: index it first")
    k, CL, CD = coefficients, float(trim.CL), float(trim.CD)
    CT = float(trim.thrust / (0.5 * trim.rho * trim.V**2 * airframe.area))
    slope = 2.0 * k.CD_CL2 * CL
    return StabilityDerivatives(
        CX_u=-2.0 * CT,
        CX_alpha=CL - slope * k.CL_alpha,
        CX_delta=-slope * k.CL_delta,
        CZ_alpha=-(k.CL_alpha + CD),
        CZ_alphadot=-k.CL_alphadot,
        CZ_q=-k.CL_q,
        CZ_delta=-k.CL_delta,
        CM_alpha=k.CM_alpha,
        CM_alphadot=k.CM_alphadot,
        CM_q=k.CM_q,
        CM_delta=k.CM_delta,
    )
