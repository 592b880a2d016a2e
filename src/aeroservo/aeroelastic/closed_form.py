"""Static aeroelasticity in closed form: divergence and twist of simple wings.

Uniform rectangular wings, steady strip theory, linear: it stops being valid where the flow separates, at low aspect
ratio and past divergence, where twists and moments are refused. The eccentricity e is the distance of the flexural
axis aft of the aerodynamic centre, in chords. A divergence or reversal that does not exist is None.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.datatypes import Array


@dataclass(frozen=True, kw_only=True)
class UniformWing:
    """A rectangular half wing, clamped at its root.

    Attributes
    ----------
    GJ : float
        Torsional stiffness. [N m^2]
    eccentricity : float
        e, flexural axis aft of the aerodynamic centre, in chords. [-]
    chord, semi_span : float
        Chord, and root to tip. [m]
    lift_slope : float
        a, of every section. [1/rad]
    """

    GJ: float
    eccentricity: float
    chord: float
    semi_span: float
    lift_slope: float

    def __post_init__(self) -> None:
        """Refuse what must be positive and is not."""
        _check(GJ=self.GJ, chord=self.chord, semi_span=self.semi_span, lift_slope=self.lift_slope)

    @property
    def area_lift(self) -> float:
        """c^2 s^2 a. [m^4/rad]"""
        return (self.chord * self.semi_span) ** 2 * self.lift_slope


def section_divergence_pressure(
    *, pitch_stiffness: float, eccentricity: float, chord: float, span: float, lift_slope: float
) -> float | None:
    """Divergence of a rigid section on a torsion spring: K_theta = q e c^2 s a.

    Parameters
    ----------
    pitch_stiffness : float
        Spring about the flexural axis. [N m/rad]
    eccentricity : float
        e. [-]
    chord, span : float
        Of the section. [m]
    lift_slope : float
        a. [1/rad]

    Returns
    -------
    q : float or None
        Dynamic pressure; None where it does not diverge. [Pa]

    Raises
    ------
    ValueError
        If a stiffness, a length or the lift slope is not positive and finite.

    References
    ----------
    Bramstång 2015, Eq. 7.6; equations.md, "Static aeroelasticity".

    Examples
    --------
    >>> section_divergence_pressure(pitch_stiffness=8.0, eccentricity=0.25, chord=2.0, span=1.0, lift_slope=4.0)
    2.0
    """
    _check(pitch_stiffness=pitch_stiffness, chord=chord, span=span, lift_slope=lift_slope)
    return _quotient(pitch_stiffness, eccentricity * chord**2 * span * lift_slope)


def binary_divergence_pressure(wing: UniformWing) -> float | None:
    """Divergence of a clamped wing held to a linear twist: 3 K_theta / (e c^2 s a), K_theta = GJ / s.

    Parameters
    ----------
    wing : UniformWing
        The half wing.

    Returns
    -------
    q : float or None
        Dynamic pressure; None where it does not diverge. [Pa]

    References
    ----------
    equations.md, "Static aeroelasticity" (binary wing); Bramstång 2015, Eqs. 7.27-7.36 at rest.

    Examples
    --------
    >>> binary_divergence_pressure(UniformWing(GJ=8.0, eccentricity=0.25, chord=2.0, semi_span=1.0, lift_slope=4.0))
    6.0
    """
    return _quotient(3.0 * wing.GJ, wing.eccentricity * wing.area_lift)


def wing_divergence_pressure(wing: UniformWing) -> float | None:
    """Divergence of a uniform clamped wing: pi^2 GJ / (4 e c^2 s^2 a).

    Parameters
    ----------
    wing : UniformWing
        The half wing.

    Returns
    -------
    q : float or None
        Dynamic pressure; None where it does not diverge. [Pa]

    References
    ----------
    Bramstång 2015, Eqs. 7.9-7.10 (lambda s = pi/2); equations.md, "Static aeroelasticity".

    Examples
    --------
    >>> goland = UniformWing(GJ=0.9876e6, eccentricity=0.08, chord=1.8288, semi_span=6.096, lift_slope=2.0 * np.pi)
    >>> round(float(np.sqrt(2.0 * wing_divergence_pressure(goland) / 1.225)), 3)
    252.355
    """
    return _quotient(0.25 * np.pi**2 * wing.GJ, wing.eccentricity * wing.area_lift)


def wing_twist(y: ArrayLike, wing: UniformWing, *, q: ArrayLike, incidence: float, cm0: float = 0.0) -> Array:
    """Elastic twist of a uniform clamped wing at an incidence.

    Parameters
    ----------
    y : array_like, shape (...)
        Distance from the root. [m]
    q : array_like, shape (...)
        Dynamic pressure, below divergence. [Pa]
    wing : UniformWing
        The half wing.
    incidence : float
        Of the root. [rad]
    cm0 : float
        Moment coefficient without lift, nose up. [-]

    Returns
    -------
    theta : ndarray, shape (...)
        Nose up. [rad]

    Raises
    ------
    ValueError
        If q is negative or not below divergence, y off the span.

    References
    ----------
    Bramstång 2015, Eqs. 7.9-7.10: theta = (alpha + C_M0/(e a)) (tan(lambda s) sin(lambda y) + cos(lambda y) - 1),
    lambda^2 = q e c^2 a / GJ; hyperbolic for e < 0, a parabola for e = 0.

    Examples
    --------
    >>> wing = UniformWing(GJ=1.0, eccentricity=0.25, chord=2.0, semi_span=1.0, lift_slope=1.0)
    >>> round(float(wing_twist(1.0, wing, q=(np.pi / 3.0) ** 2, incidence=0.1)), 12)  # 0.1 (1/cos(60 deg) - 1)
    0.1
    """
    y, q = np.broadcast_arrays(np.asarray(y, dtype=float), np.asarray(q, dtype=float))
    if not np.all((y >= 0.0) & (y <= wing.semi_span)):
        raise ValueError(f"y must lie on the span, 0 to {wing.semi_span:g} [m], got {y.min():g} to {y.max():g}")
    scale = q * (wing.chord * wing.semi_span) ** 2 / wing.GJ
    z2 = _below_divergence(q, scale * wing.eccentricity * wing.lift_slope, 0.25 * np.pi**2)
    return np.asarray(
        scale * (wing.eccentricity * wing.lift_slope * incidence + cm0) * _winding(z2, y / wing.semi_span)
    )


def swept_divergence_pressure(
    *,
    pitch_stiffness: float,
    bending_stiffness: float,
    eccentricity: float,
    chord: float,
    span: float,
    lift_slope: float,
    sweep: float,
) -> float | None:
    """Divergence of a rigid swept wing on root springs in twist and bending.

    A lift L makes the torque L e c cos(Lambda) and, acting e c ahead of the axis, the bending moment
    L (s / (2 cos Lambda) - e c sin(Lambda)); the incidence that it feels is theta cos(Lambda) - kappa sin(Lambda).

    Parameters
    ----------
    pitch_stiffness : float
        Spring in twist about the axis. [N m/rad]
    bending_stiffness : float
        Spring K_kappa in rotation about the normal to the axis; infinite is allowed. [N m/rad]
    eccentricity : float
        e, of the streamwise chord. [-]
    chord : float
        Streamwise. [m]
    span : float
        Normal to the flow. [m]
    lift_slope : float
        a. [1/rad]
    sweep : float
        Of the axis, positive aft. [rad]

    Returns
    -------
    q : float or None
        Dynamic pressure; None where the wing does not diverge at any speed. [Pa]

    Raises
    ------
    ValueError
        If the sweep is 90 degrees or more.

    References
    ----------
    Bramstång 2015, Eq. 7.11 put right in equations.md, "Static aeroelasticity" (a sign and a factor s).

    Examples
    --------
    >>> wing = {"pitch_stiffness": 1e3, "bending_stiffness": 1e4, "eccentricity": 0.2, "chord": 0.5, "span": 2.0,
    ...         "lift_slope": 6.0}
    >>> swept_divergence_pressure(**wing, sweep=np.radians(45.0)) is None
    True
    """
    _check(pitch_stiffness=pitch_stiffness, chord=chord, span=span, lift_slope=lift_slope)
    if not bending_stiffness > 0.0:
        raise ValueError(f"bending_stiffness must be positive [N m/rad], got {bending_stiffness:g}")
    if not abs(sweep) < 0.5 * np.pi - 1e-8:
        raise ValueError(f"sweep must lie between -90 and 90 deg, both excluded, got {np.degrees(sweep):g} deg")
    springs = np.cos(sweep) ** 2 / pitch_stiffness + np.sin(sweep) ** 2 / bending_stiffness
    bracket = eccentricity * chord**2 * span * springs - chord * span**2 * np.tan(sweep) / (2.0 * bending_stiffness)
    return _quotient(1.0, lift_slope * bracket)


def _check(**values: float) -> None:
    """Refuse what must be positive and is not."""
    units = {"GJ": "N m^2", "pitch_stiffness": "N m/rad", "lift_slope": "1/rad"}
    for name, value in values.items():
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} must be positive and finite [{units.get(name, 'm')}], got {value:g}")


def _quotient(stiffness: float, air: float) -> float | None:
    """Dynamic pressure at which air times it outweighs a stiffness; None where it never does."""
    return float(stiffness / air) if stiffness * air > 0.0 else None


def _pressure(q: ArrayLike) -> Array:
    """Dynamic pressure, checked."""
    q = np.asarray(q, dtype=float)
    if not np.all(q >= 0.0):
        raise ValueError(f"q must not be negative [Pa], got {np.min(q):g}")
    return q


def _below_divergence(q: Array, air: Array, stiffness: float) -> Array:
    """`air`, refused where it is not below the stiffness."""
    _pressure(q)
    if not np.all(air < stiffness):
        first = q[np.asarray(air >= stiffness)].min() if q.ndim else q
        raise ValueError(f"q must be below divergence [Pa], got {first:g}")
    return air


def _winding(z2: Array, eta: Array) -> Array:
    """(tan z sin(z eta) + cos(z eta) - 1) / z^2 for any sign of z^2: the twist under a load of 1."""
    z = np.sqrt(np.abs(z2))
    small = z < 1e-3
    safe = np.where(small, 1.0, z)
    trigonometric = np.cos(safe * (1.0 - eta)) / np.cos(safe)
    hyperbolic = (np.exp(-safe * eta) + np.exp(-safe * (2.0 - eta))) / (1.0 + np.exp(-2.0 * safe))
    ratio = np.where(z2 > 0.0, trigonometric, hyperbolic)
    series = eta - 0.5 * eta**2 + z2 * (eta**4 - 4.0 * eta**3 + 8.0 * eta) / 24.0
    return np.asarray(np.where(small, series, (ratio - 1.0) / np.where(small, 1.0, z2)))
