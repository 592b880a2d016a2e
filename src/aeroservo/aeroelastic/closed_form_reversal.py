"""Control of flexible wings in closed form: reversal, roll rate and rolling moment of simple wings.

As `closed_form`: uniform rectangular wings, steady strip theory, linear. The control lies over the whole span.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.aeroelastic.closed_form import UniformWing
from aeroservo.datatypes import Array


@dataclass(frozen=True, kw_only=True)
class ControlSlopes:
    """Section derivatives of a control over the whole span, per angle, trailing edge down.

    Attributes
    ----------
    lift_per_rad : float
        a_c = dC_L/d delta. [1/rad]
    moment_per_rad : float
        b_c = dC_M/d delta about the FLEXURAL axis, nose up (negative for a trailing-edge flap). [1/rad]
    """

    lift_per_rad: float
    moment_per_rad: float


def roll_reversal_pressure(wing: UniformWing, control: ControlSlopes) -> float | None:
    """Reversal in roll of a clamped wing held to a linear twist, its control over the whole span.

    Parameters
    ----------
    wing : UniformWing
        The half wing.
    control : ControlSlopes
        Over the whole span.

    Returns
    -------
    q : float or None
        Dynamic pressure; None where the control does not reverse. [Pa]

    References
    ----------
    Bramstång 2015, Eqs. 7.18-7.19 as read in equations.md, "Reversal": 3 GJ a_c / (c^2 s^2 a (e a_c - b_c)).

    Examples
    --------
    >>> wing = UniformWing(GJ=1.0, eccentricity=0.2, chord=1.0, semi_span=1.0, lift_slope=1.0)
    >>> round(roll_reversal_pressure(wing, ControlSlopes(lift_per_rad=1.0, moment_per_rad=-0.1)), 9)
    10.0
    """
    relief = (wing.eccentricity * control.lift_per_rad - control.moment_per_rad) * wing.area_lift
    return _quotient(3.0 * wing.GJ * control.lift_per_rad, relief)


def lift_reversal_pressure(wing: UniformWing, control: ControlSlopes) -> float | None:
    """Reversal of symmetric lift of the same wing, root incidence held.

    Parameters
    ----------
    wing : UniformWing
        The half wing.
    control : ControlSlopes
        Over the whole span.

    Returns
    -------
    q : float or None
        Dynamic pressure; None where the control does not reverse. [Pa]

    References
    ----------
    equations.md, "Reversal" [7.18-7.19]: 12 GJ a_c / (c^2 s^2 a (4 e a_c - 3 b_c)).

    Examples
    --------
    >>> wing = UniformWing(GJ=1.0, eccentricity=0.2, chord=1.0, semi_span=1.0, lift_slope=1.0)
    >>> round(lift_reversal_pressure(wing, ControlSlopes(lift_per_rad=1.0, moment_per_rad=-0.4)), 9)
    6.0
    """
    relief = (4.0 * wing.eccentricity * control.lift_per_rad - 3.0 * control.moment_per_rad) * wing.area_lift
    return _quotient(12.0 * wing.GJ * control.lift_per_rad, relief)


def wing_roll_reversal_pressure(wing: UniformWing, control: ControlSlopes) -> float | None:
    """Reversal in roll of a uniform clamped wing that twists as it likes, its control over the whole span.

    With z = lambda s and lambda^2 = q e c^2 a / GJ the rolling moment vanishes at
    2 (1 - 1/cos z) / z^2 + 1 = e a_c / b_c (hyperbolic for e < 0; at e = 0 q = -(12/5) GJ a_c / (c^2 s^2 a b_c)).

    Parameters
    ----------
    wing : UniformWing
        The half wing.
    control : ControlSlopes
        Over the whole span.

    Returns
    -------
    q : float or None
        Lowest dynamic pressure below divergence; None where the control does not reverse there. [Pa]

    References
    ----------
    GJ theta'' + q c^2 (e a (theta - p y/V) + b_c delta) = 0 without roll acceleration: Bramstång 2015, section 7.2;
    equations.md, "Static aeroelasticity" [7.9].

    Examples
    --------
    >>> wing = UniformWing(GJ=1.0, eccentricity=0.2, chord=1.0, semi_span=1.0, lift_slope=1.0)
    >>> control = ControlSlopes(lift_per_rad=1.0, moment_per_rad=-0.1)
    >>> round(wing_roll_reversal_pressure(wing, control), 4)  # held to a linear twist: 10
    8.1417
    """
    from scipy.optimize import brentq

    unit = wing.area_lift / wing.GJ
    per_q, moment = wing.eccentricity * unit, control.moment_per_rad * unit

    def roll(q: float) -> float:
        return control.lift_per_rad + 2.0 * q * moment * _roll_of_winding(q * per_q)

    end = 0.25 * np.pi**2 * (1.0 - 1e-12) / per_q if per_q > 0.0 else 1e9 / unit
    if not roll(0.0) * roll(end) < 0.0:
        return None
    return float(brentq(roll, 0.0, end, xtol=1e-300, rtol=1e-14))


def roll_rate_effectiveness(q: ArrayLike, wing: UniformWing, control: ControlSlopes) -> Array:
    """Steady roll rate per control angle over that of a rigid wing, linear twist: 1 - q / q_R.

    Parameters
    ----------
    q : array_like, shape (...)
        Dynamic pressure. [Pa]
    wing : UniformWing
        The half wing.
    control : ControlSlopes
        Over the whole span.

    Returns
    -------
    ratio : ndarray, shape (...)
        Elastic over rigid; negative past reversal. [-]

    Raises
    ------
    ValueError
        If q is negative or lift_per_rad zero.

    References
    ----------
    Bramstång 2015, Eq. 7.18; equations.md, "Reversal".

    Examples
    --------
    >>> wing = UniformWing(GJ=1.0, eccentricity=0.2, chord=1.0, semi_span=1.0, lift_slope=1.0)
    >>> control = ControlSlopes(lift_per_rad=1.0, moment_per_rad=-0.1)
    >>> roll_rate_effectiveness([0.0, 5.0], wing, control).round(9).tolist()
    [1.0, 0.5]
    """
    q = _pressure(q)
    if control.lift_per_rad == 0.0:
        raise ValueError("lift_per_rad must not be zero [1/rad]: a rigid wing would not roll")
    relief = (wing.eccentricity - control.moment_per_rad / control.lift_per_rad) * wing.area_lift
    return np.asarray(1.0 - q * relief / (3.0 * wing.GJ))


def roll_moment(q: ArrayLike, wing: UniformWing, control: ControlSlopes) -> Array:
    """Rolling moment of both wings per control angle, opposite on them, roll held: linear twist.

    q c s^2 (a_c + q c^2 s^2 a b_c / (3 GJ - q c^2 s^2 e a)): infinite at divergence, zero at the reversal in roll.

    Parameters
    ----------
    q : array_like, shape (...)
        Dynamic pressure, below divergence. [Pa]
    wing : UniformWing
        The half wing.
    control : ControlSlopes
        Over the whole span.

    Returns
    -------
    moment : ndarray, shape (...)
        Rolling moment per control angle. [N m/rad]

    Raises
    ------
    ValueError
        If q is negative or not below divergence.

    References
    ----------
    Bramstång 2015, Eqs. 7.20-7.21 as put right in equations.md, "Reversal" (C_Malpha = e a).

    Examples
    --------
    >>> wing = UniformWing(GJ=1.0, eccentricity=0.2, chord=1.0, semi_span=1.0, lift_slope=1.0)
    >>> roll_moment([1.0, 10.0], wing, ControlSlopes(lift_per_rad=1.0, moment_per_rad=-0.1)).round(6).tolist()
    [0.964286, 0.0]
    """
    q = _pressure(q)
    air = q * wing.area_lift
    if not np.all(air * wing.eccentricity < 3.0 * wing.GJ):
        raise ValueError(f"q must be below divergence [Pa], got {np.max(q):g}")
    held = control.lift_per_rad + air * control.moment_per_rad / (3.0 * wing.GJ - air * wing.eccentricity)
    return np.asarray(q * wing.chord * wing.semi_span**2 * held)


def _quotient(stiffness: float, air: float) -> float | None:
    """Dynamic pressure at which air times it outweighs a stiffness; None where it never does."""
    return float(stiffness / air) if stiffness * air > 0.0 else None


def _pressure(q: ArrayLike) -> Array:
    """Dynamic pressure, checked."""
    q = np.asarray(q, dtype=float)
    if not np.all(q >= 0.0):
        raise ValueError(f"q must not be negative [Pa], got {np.min(q):g}")
    return q


def _roll_of_winding(z2: float) -> float:
    """Integral over the span of what a unit load winds the wing by, times eta, for any sign of z^2."""
    if abs(z2) < 1e-4:
        return 5.0 / 24.0 + z2 * 61.0 / 720.0 + z2**2 * 277.0 / 8064.0
    z = np.sqrt(abs(z2))
    secant = 1.0 / np.cos(z) if z2 > 0.0 else 2.0 * np.exp(-z) / (1.0 + np.exp(-2.0 * z))
    return float(((secant - 1.0) / z2 - 0.5) / z2)
