"""Influence functions of a slender swept wing, and static deflection by them.

C_pq(y, eta) is the displacement in p at y per unit load in q at eta, root clamped, from the unit-load theorem:

    C_pq(y, eta) = integral over the axis inboard of both points of  m_p(y)' F m_q(eta) ds

with m_q(eta) the bending moment (about the chord) and torque (about the axis) that a unit load in q at eta makes
at s, and F the flexibility [[EI, -K], [-K, GJ]]^-1 of the section (diag(1/EI, 1/GJ) without bend-twist
coupling). For a straight axis of sweep Lambda m_z = (eta/cos Lambda - s, 0) and m_theta = (-sin Lambda, cos Lambda):
the thesis' [4.15-4.20], put right.

Signs. z is UP here and theta is the rotation about the y axis of the aircraft, nose up: the twist of the
STREAMWISE section, theta = theta_axis cos Lambda - (dz/ds) sin Lambda. So a lift at the tip of an aft-swept wing
lowers theta (washes out), which is the minus in C_theta_z. The rotation about the x axis (starboard wing up) comes
along as third component: without it a torque about the flexural axis could not be applied. Points are measured ALONG
the flexural axis, as in `SlenderBeam`; the thesis' y is the distance from the root times cos Lambda, and its [4.14]
and [4.21] hold with x - y tan Lambda for x.

Not modelled: see `beam_axis`; the root is a clamp normal to the axis or not, which a slender beam cannot tell apart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.structure.beam_axis import Array, SlenderBeam, axis_directions, gauss_points
from aeroservo.structure.beam_static import (
    BeamDeflection,
    BeamLoad,
    check_on_span,
    deflection_from_motion,
    distributed_points,
    point_forces,
)

_RATIO = 2.0  # a stiffness changes at most by this factor over a piece of quadrature
_GAUSS = 12  # points per piece: the error of 1/stiffness is then below (sqrt 2 + 1)^(-2 * 2 * 12) < 1e-18


@dataclass(frozen=True, kw_only=True, eq=False)
class InfluenceFunctions:
    """Influence functions between two sets of points.

    Attributes
    ----------
    y : ndarray, shape (n,)
        Where the displacement is, along the flexural axis. [m]
    eta : ndarray, shape (m,)
        Where the load is, along the flexural axis. [m]
    C : ndarray, shape (n, 3, m, 3)
        Deflection z up [m], rotation about x and about y [rad] at `y` per unit force up [N], moment about x and
        about y [N m] at `eta`, in geometry axes.
    """

    y: Array
    eta: Array
    C: Array

    @property
    def zz(self) -> Array:
        """C^zz, deflection up per unit force up, shape (n, m) [m/N]."""
        return self.C[:, 0, :, 0]

    @property
    def theta_theta(self) -> Array:
        """C^theta,theta, streamwise twist per unit moment about y, shape (n, m) [rad/(N m)]."""
        return self.C[:, 2, :, 2]

    @property
    def theta_z(self) -> Array:
        """C^theta,z, streamwise twist per unit force up, shape (n, m) [rad/N]."""
        return self.C[:, 2, :, 0]

    @property
    def z_theta(self) -> Array:
        """C^z,theta, deflection up per unit moment about y, shape (n, m) [1/N]."""
        return self.C[:, 0, :, 2]


def influence_functions(
    beam: SlenderBeam, y: ArrayLike, eta: ArrayLike, *, GK: ArrayLike | None = None
) -> InfluenceFunctions:
    """Influence functions of a clamped slender wing, straight or kinked, stiffnesses varying along it.

    Parameters
    ----------
    beam : SlenderBeam
        The wing; only its axis and stiffnesses are used. Its root must be clamped.
    y : array_like, shape (n,)
        Where displacements are wanted, along the flexural axis. [m]
    eta : array_like, shape (m,)
        Where unit loads act, along the flexural axis. [m]
    GK : array_like, shape (n_stations,) or scalar, optional
        Shear stiffness at the stations, linear between; left out, no shear deformation. [N]

    Returns
    -------
    influence : InfluenceFunctions
        C^zz, C^theta,theta, C^theta,z, C^z,theta and the blocks of rotation about x.

    Raises
    ------
    ValueError
        If the root is free, a point is off the span or GK is not positive.

    References
    ----------
    Bramstång 2015, Eqs. 4.15-4.20, as corrected in equations.md (C^theta,z differs from C^z,theta; reciprocity is
    C^z,theta(y, eta) = C^theta,z(eta, y)); R. Bisplinghoff, H. Ashley, R. Halfman, Aeroelasticity, 1955, section 2-13.

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 3.0], mass=1.0, inertia=1.0, EI=9.0, GJ=1.0, sweep=np.radians(30.0))
    >>> tip = influence_functions(wing, [3.0], [3.0])
    >>> round(float(tip.zz[0, 0]), 12), round(float(tip.theta_z[0, 0]), 12)  # s^3 / 3 EI, -sin 30 s^2 / 2 EI
    (1.0, -0.25)
    """
    y, eta = (np.atleast_1d(np.asarray(value, dtype=float)) for value in (y, eta))
    check_on_span(beam, y, "y")
    check_on_span(beam, eta, "eta")
    if beam.root != "clamped":
        raise ValueError('root must be "clamped" for influence functions, got "free"')
    s, weight = gauss_points(_pieces(beam, np.concatenate([y, eta]), GK), _GAUSS)
    left, right = _unit_moments(beam, s, y), _unit_moments(beam, s, eta)
    C = _contract(left, _section_flexibility(beam, s) * weight[:, None, None], right)
    if GK is not None:
        inboard = 1.0 / np.interp(s, beam.y, _shear_stiffness(beam, GK)) * weight
        C[:, 0, :, 0] += (s[:, None] < y).T.astype(float) * inboard @ (s[:, None] < eta).astype(float)
    return InfluenceFunctions(y=y, eta=eta, C=C)


def influence_deflection(
    beam: SlenderBeam, load: BeamLoad, points: ArrayLike, *, GK: ArrayLike | None = None
) -> BeamDeflection:
    """Static deflection of a clamped wing by its influence functions.

    Parameters
    ----------
    beam : SlenderBeam
        The wing.
    load : BeamLoad
        Lift up, torque about the flexural axis nose up.
    points : array_like, shape (n,)
        Where the deflection is wanted, along the flexural axis. [m]
    GK : array_like, shape (n_stations,) or scalar, optional
        Shear stiffness; left out, no shear deformation. [N]

    Returns
    -------
    deflection : BeamDeflection
        h down, twist about the axis, twist of the streamwise section; with shear, `slope` is that of bending alone
        (the rotation of the section).

    Raises
    ------
    ValueError
        As `influence_functions`, or if the load is off the span.

    References
    ----------
    Bramstång 2015, Eqs. 4.22-4.25, with the influence functions of equations.md.

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 2.0], mass=1.0, inertia=1.0, EI=4.0, GJ=1.0)
    >>> tip = influence_deflection(wing, BeamLoad(y=[0.0, 2.0], lift=1.0), [2.0])
    >>> round(float(tip.h[0]), 12)  # -W s^4 / (8 EI)
    -0.5
    """
    points = np.atleast_1d(np.asarray(points, dtype=float))
    eta, force = distributed_points(beam, load, _pieces(beam, points, GK), _GAUSS)
    eta = np.concatenate([eta, load.point_y])
    force = np.concatenate([force, point_forces(beam, load)])
    motion = np.einsum("ipjq,jq->ip", influence_functions(beam, points, eta, GK=GK).C, force)
    return deflection_from_motion(beam, points, motion)


def _pieces(beam: SlenderBeam, points: Array, GK: ArrayLike | None) -> Array:
    """Ends of the pieces between stations and points over which no stiffness changes by more than `_RATIO`."""
    ends = [beam.y, points]
    stiffnesses = [beam.EI, beam.GJ] + ([] if GK is None else [_shear_stiffness(beam, GK)])
    for value in stiffnesses:
        for a, b, first, last in zip(beam.y[:-1], beam.y[1:], value[:-1], value[1:]):
            n = int(np.ceil(abs(np.log(last / first)) / np.log(_RATIO)))
            if n > 1:
                steps = np.expm1(np.log(last / first) * np.arange(1, n) / n) / (last / first - 1.0)
                ends.append(a + (b - a) * steps)
    return np.unique(np.concatenate(ends))


def _unit_moments(beam: SlenderBeam, s: Array, at: Array) -> Array:
    """Bending moment and torque at s from unit force up and moments about x and y at points, shape (n_s, 2, n, 3).

    The moment of a force up at r is (r_y, -r_x, 0); its parts along the chord n and the axis t are the bending moment,
    which curves the axis upward, and the torque, nose up. Outboard of the load there is nothing.
    """
    tangent, chordwise = axis_directions(beam.at("sweep", s))
    arm = beam.position(at)[None] - beam.position(s)[:, None]
    moment = np.zeros((s.size, 2, at.size, 3))
    for i, axis in enumerate((chordwise, tangent)):
        moment[:, i, :, 0] = axis[:, 0, None] * arm[:, :, 1] - axis[:, 1, None] * arm[:, :, 0]
        moment[:, i, :, 1:] = axis[:, None, :2]
    return np.asarray(moment * (s[:, None] < at)[:, None, :, None])


def _section_flexibility(beam: SlenderBeam, s: Array) -> Array:
    """Curvature upward and twist rate per unit bending moment and torque, shape (n_s, 2, 2)."""
    EI, GJ, K = beam.at("EI", s), beam.at("GJ", s), beam.at("coupling", s)
    return np.stack([np.stack([GJ, K], -1), np.stack([K, EI], -1)], -2) / (EI * GJ - K * K)[:, None, None]


def _contract(left: Array, section: Array, right: Array) -> Array:
    """Sum over s of left' F right, shape (n, 3, m, 3)."""
    n, m = left.shape[2], right.shape[2]
    weighted = np.einsum("gij,gjmq->gimq", section, right)
    C = left.reshape(-1, 3 * n).T @ weighted.reshape(-1, 3 * m)
    return np.asarray(C).reshape(n, 3, m, 3)


def _shear_stiffness(beam: SlenderBeam, GK: ArrayLike) -> Array:
    """Shear stiffness at the stations, checked."""
    value = np.asarray(GK, dtype=float)
    if value.ndim != 0 and value.shape != beam.y.shape:
        raise ValueError(f"GK must be a number or one value per station {beam.y.shape}, got shape {value.shape}")
    if not np.all(np.isfinite(value)) or np.any(value <= 0.0):
        raise ValueError(f"GK must be positive and finite at every station [N], got {value.tolist()}")
    return np.broadcast_to(value, beam.y.shape)
