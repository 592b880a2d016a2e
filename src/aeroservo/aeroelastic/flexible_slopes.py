"""Lift and moment slopes of a flexible swept wing by influence functions, in level flight or with its root held.

The unknown is the loading X = c c_l per incidence of the root, at Gauss points between the stations:

    ([A_s] - q [E] + (2 q / W) [G] {mg} |1| [W]) X = {1}

[A_s] maps c c_l to the incidence of the section (strip theory: 1 / (a c)), [E] the load to the streamwise twist, lift
acting e c ahead of the flexural axis in the streamwise section, and the last term is the twist that the weight takes
away when the aircraft accelerates so that its lift is carried (W the weight of the whole aircraft, {mg} that of the
half wing at the points; left out, the root is held and the wing has no weight).

Kernels kink where load and deflection meet. So each row of [E] is integrated to either side of its point, X being a
polynomial through the points of each panel: the result converges with the order of that polynomial, not as h^2.

Small deflections, attached incompressible flow, sections that do not feel each other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from numpy.typing import ArrayLike

from aeroservo.atmosphere import STANDARD_GRAVITY
from aeroservo.datatypes import Array
from aeroservo.structure.beam_axis import SlenderBeam
from aeroservo.structure.influence import influence_functions


@dataclass(frozen=True, kw_only=True, eq=False)
class FlexibleSlopes:
    """Slopes of a flexible wing, and the matrices behind them.

    Attributes
    ----------
    q : ndarray, shape (n_q,)
        Dynamic pressures. [Pa]
    CL_alpha, CM_alpha : ndarray, shape (n_q,)
        Of the whole wing per incidence of its root; moments nose up about the aerodynamic centre of the root section,
        over the mean aerodynamic chord. [1/rad]
    y : ndarray, shape (n,)
        Span coordinate of the points. [m]
    loading : ndarray, shape (n_q, n)
        X = c c_l per incidence of the root. [m/rad]
    A_s : ndarray, shape (n, n)
        c c_l to incidence. [rad/m]
    E : ndarray, shape (n, n)
        q c c_l to streamwise twist. [rad/N]
    G : ndarray, shape (n, n + n_lumps)
        Forces up at the centres of gravity of the points and lumps to streamwise twist. [rad/N]
    weight : ndarray, shape (n + n_lumps,)
        {mg}, weight of the half wing at the points and of its lumps. [N]
    W : ndarray, shape (n,)
        Quadrature weights in the span. [m]
    area, mac : float
        Of the whole wing: area [m^2], mean aerodynamic chord [m].
    """

    q: Array
    CL_alpha: Array
    CM_alpha: Array
    y: Array
    loading: Array
    A_s: Array
    E: Array
    G: Array
    weight: Array
    W: Array
    area: float
    mac: float


def flexible_slopes(
    beam: SlenderBeam,
    q: ArrayLike,
    *,
    chord: ArrayLike,
    eccentricity: ArrayLike,
    lift_slope: float,
    aircraft_weight: float | None = None,
    points: int = 16,
) -> FlexibleSlopes:
    """Slopes of lift and moment of a flexible swept wing against dynamic pressure.

    Parameters
    ----------
    beam : SlenderBeam
        The half wing, root clamped; its masses count only with `aircraft_weight`.
    q : array_like, shape (n_q,) or scalar
        Dynamic pressure. [Pa]
    chord : array_like, shape (n_stations,) or scalar
        Streamwise, at the stations of the beam, linear between. [m]
    eccentricity : array_like, shape (n_stations,) or scalar
        Flexural axis aft of the aerodynamic centre in streamwise chords. [-]
    lift_slope : float
        Of streamwise sections: that of normal sections times cos(Lambda). [1/rad]
    aircraft_weight : float, optional
        Weight of the whole aircraft, in free flight; left out, the root is held. [N]
    points : int
        Points in each panel between stations.

    Returns
    -------
    slopes : FlexibleSlopes
        Slopes and matrices.

    Raises
    ------
    ValueError
        If the root is not clamped, a chord, the lift slope or the weight is not positive, q is negative, or `points`
        is below 2.

    References
    ----------
    Bramstång 2015, Eqs. 7.12-7.13 and 4.15-4.25, as put right in equations.md, "Static aeroelasticity".

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 1.0], mass=1.0, inertia=1.0, EI=1.0, GJ=1.0)
    >>> slopes = flexible_slopes(wing, (np.pi / 4.0) ** 2, chord=1.0, eccentricity=0.5, lift_slope=2.0)
    >>> round(float(slopes.CL_alpha[0] / 2.0 * np.pi / 4.0), 9)  # a tan(45 deg) / (pi/4), both wings, S = 2
    1.0
    """
    q = np.atleast_1d(np.asarray(q, dtype=float))
    c_station = np.broadcast_to(np.asarray(chord, dtype=float), beam.y.shape)
    e_station = np.broadcast_to(np.asarray(eccentricity, dtype=float), beam.y.shape)
    _check(q, c_station, lift_slope, aircraft_weight, points)
    s, weight = _panels(beam, points)
    c, offset = np.interp(s, beam.y, c_station), np.interp(s, beam.y, e_station * c_station)
    W = weight * np.cos(beam.at("sweep", s))
    A_s = np.diag(1.0 / (lift_slope * c))
    E = _twist_of_loading(beam, s, points, c_station * e_station)
    G, mg = _twist_of_weight(beam, s, points, weight)
    matrix = A_s - q[:, None, None] * E
    if aircraft_weight is not None:
        matrix = matrix + (2.0 * q / aircraft_weight)[:, None, None] * np.outer(G @ mg, W)
    X = np.linalg.solve(matrix, np.broadcast_to(np.ones((s.size, 1)), (q.size, s.size, 1)))[..., 0]
    x_ac = beam.position(s)[:, 0] - beam.origin[0] - offset + e_station[0] * c_station[0]
    area = 2.0 * float(W @ c)
    mac = 2.0 * float(W @ c**2) / area
    return FlexibleSlopes(
        q=q,
        CL_alpha=2.0 / area * X @ W,
        CM_alpha=-2.0 / (area * mac) * X @ (x_ac * W),
        y=beam.position(s)[:, 1],
        loading=X,
        A_s=A_s,
        E=E,
        G=G,
        weight=mg,
        W=W,
        area=area,
        mac=mac,
    )


def _check(q: Array, chord: Array, lift_slope: float, aircraft_weight: float | None, points: int) -> None:
    """Refuse what no wing can have."""
    if not np.all(q >= 0.0):
        raise ValueError(f"q must not be negative [Pa], got {q.min():g}")
    if not np.all(chord > 0.0):
        raise ValueError(f"chord must be positive at every station [m], got {chord.min():g}")
    if not lift_slope > 0.0:
        raise ValueError(f"lift_slope must be positive [1/rad], got {lift_slope:g}")
    if aircraft_weight is not None and not aircraft_weight > 0.0:
        raise ValueError(f"aircraft_weight must be positive [N], got {aircraft_weight:g}")
    if points < 2:
        raise ValueError(f"points must be 2 or more in each panel, got {points}")


def _panels(beam: SlenderBeam, points: int) -> tuple[Array, Array]:
    """Gauss points along the axis in each panel between stations, and their weights."""
    xi, weight = leggauss(points)
    half = 0.5 * np.diff(beam.y)[:, None]
    return (beam.y[:-1, None] + half * (1.0 + xi)).ravel(), (half * weight).ravel()


def _twist_of_loading(beam: SlenderBeam, s: Array, points: int, arm: Array) -> Array:
    """[E]: streamwise twist at the points per q c c_l there."""

    def kernel(place: float, eta: Array) -> Array:
        found = influence_functions(beam, [place], eta)
        twist = found.theta_z[0] + found.theta_theta[0] * np.interp(eta, beam.y, arm)
        return np.asarray(twist * np.cos(beam.at("sweep", eta)))

    return _product_integration(beam, s, points, kernel)


def _twist_of_weight(beam: SlenderBeam, s: Array, points: int, weight: Array) -> tuple[Array, Array]:
    """[G] per force up at the centres of gravity, and {mg}: at the points, then the lumps."""

    def kernel(place: float, eta: Array, aft: Array) -> Array:
        found = influence_functions(beam, [place], eta)
        sweep = beam.at("sweep", eta)
        lean = np.sin(sweep) * found.C[0, 2, :, 1] + np.cos(sweep) * found.theta_theta[0]
        return np.asarray(found.theta_z[0] - aft * lean)

    G = _product_integration(beam, s, points, lambda place, eta: kernel(place, eta, beam.at("cg_offset", eta))) / weight
    lumps = beam.masses
    if lumps:
        where, aft = np.array([lump.y for lump in lumps]), np.array([lump.x for lump in lumps])
        G = np.hstack([G, np.stack([kernel(place, where, aft) for place in s])])
    mass = np.concatenate([beam.at("mass", s) * weight, [lump.mass for lump in lumps]])
    return G, STANDARD_GRAVITY * mass


def _product_integration(beam: SlenderBeam, s: Array, points: int, kernel: Callable[[float, Array], Array]) -> Array:
    """Integral along the axis of kernel(s_i, eta) times what is a polynomial in each panel, per value at the points."""
    xi, weight = leggauss(points + 4)
    to_series = np.linalg.inv(legvander(leggauss(points)[0], points - 1))
    rows = np.zeros((s.size, s.size))
    for i, place in enumerate(s):
        for p, (a, b) in enumerate(pairwise(beam.y)):
            ends = [a, place, b] if a < place < b else [a, b]
            eta = np.concatenate([x + 0.5 * (y - x) * (1.0 + xi) for x, y in pairwise(ends)])
            width = np.concatenate([0.5 * (y - x) * weight for x, y in pairwise(ends)])
            basis = legvander(2.0 * (eta - a) / (b - a) - 1.0, points - 1) @ to_series
            rows[i, p * points : (p + 1) * points] = (kernel(place, eta) * width) @ basis
    return rows
