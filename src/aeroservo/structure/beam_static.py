"""Static loads and deflections of a slender beam wing by its finite elements, root held.

Loads: `lift` positive UP, `torque` about the flexural axis positive nose up. Deflections: plunge
h positive DOWN, twist positive nose up, and the displacement vector in geometry axes (z up).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.datatypes import frozen
from aeroservo.structure.beam_axis import Array, SlenderBeam, axis_directions, gauss_points
from aeroservo.structure.beam_elements import BeamMesh, beam_mesh, stiffness_blocks, strain_shapes

_LOAD_POINTS = 8  # Gauss points between breaks: a linear load on shapes of degree up to 14 is exact


@dataclass(frozen=True, kw_only=True, eq=False)
class BeamLoad:
    """Static load of a beam: distributed, linear between the values given and zero outside them, and at points.

    Attributes
    ----------
    y : ndarray, shape (m,)
        Where the distributed load is given, along the flexural axis, ascending. [m]
    lift : ndarray, shape (m,) or scalar
        Force per length of axis, positive up. [N/m]
    torque : ndarray, shape (m,) or scalar
        Moment per length about the flexural axis, positive nose up. [N]
    point_y : ndarray, shape (k,)
        Where point loads act, along the flexural axis; at a kink, on the panel outboard of it. [m]
    point_lift : ndarray, shape (k,) or scalar
        Forces, positive up. [N]
    point_torque : ndarray, shape (k,) or scalar
        Moments about the flexural axis, positive nose up. [N m]

    Notes
    -----
    A weight per length m g is lift = -m g with torque = + m g d, its centre of gravity being d aft of the axis.
    """

    y: Array = ()  # type: ignore[assignment]
    lift: Array = 0.0  # type: ignore[assignment]
    torque: Array = 0.0  # type: ignore[assignment]
    point_y: Array = ()  # type: ignore[assignment]
    point_lift: Array = 0.0  # type: ignore[assignment]
    point_torque: Array = 0.0  # type: ignore[assignment]

    def __post_init__(self) -> None:
        """Broadcast the loads over their places, lock and check them."""
        for where, names in (("y", ("lift", "torque")), ("point_y", ("point_lift", "point_torque"))):
            place = frozen(getattr(self, where), ndim=1, name=where)
            object.__setattr__(self, where, place)
            for name in names:
                value = np.asarray(getattr(self, name), dtype=float)
                if value.ndim != 0 and value.shape != place.shape:
                    raise ValueError(
                        f"{name} must be one number or as many as {where}, {place.size}, got {value.shape}"
                    )
                object.__setattr__(self, name, frozen(np.broadcast_to(value, place.shape), name=name))
        if np.any(np.diff(self.y) <= 0.0):
            raise ValueError(f"y of a distributed load must ascend [m], got {self.y.tolist()}")
        if self.y.size == 1:
            raise ValueError("y of a distributed load needs two or more places, got one: use point_y for a point load")


@dataclass(frozen=True, kw_only=True, eq=False)
class BeamDeflection:
    """Static deflection of a beam.

    Attributes
    ----------
    y : ndarray, shape (n,)
        Points along the flexural axis. [m]
    grid : ndarray, shape (n, 3)
        The same in geometry axes, undeflected. [m]
    h, slope, twist : ndarray, shape (n,)
        Plunge positive down [m], dh/ds along the axis [rad], twist about the axis nose up [rad].
    twist_streamwise : ndarray, shape (n,)
        Rotation about the y axis, nose up: twist cos Lambda + slope sin Lambda with slope = dh/ds, h down. [rad]
    displacement : ndarray, shape (n, 6)
        Displacement (x, y, z) [m] and rotation vector [rad] in geometry axes.
    """

    y: Array
    grid: Array
    h: Array
    slope: Array
    twist: Array
    twist_streamwise: Array
    displacement: Array


def static_deflection(
    beam: SlenderBeam, load: BeamLoad, points: ArrayLike, *, elements: int = 16, degree: int = 7
) -> BeamDeflection:
    """Deflection of a clamped beam under a static load.

    Parameters
    ----------
    beam : SlenderBeam
        The beam; its root must be clamped.
    load : BeamLoad
        Lift up, torque nose up.
    points : array_like, shape (n,)
        Where the deflection is wanted, along the flexural axis. [m]
    elements, degree : int
        As in `beam_mesh`; exact where EI and GJ are constant in each element.

    Returns
    -------
    deflection : BeamDeflection
        h down, twist nose up.

    Raises
    ------
    ValueError
        If the root is free, or a load or a point is off the span.

    References
    ----------
    Bramstång 2015, Eqs. 4.1-4.4 and 4.10 (for h down with a minus: equations.md).

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 2.0], mass=1.0, inertia=1.0, EI=4.0, GJ=1.0)
    >>> tip = static_deflection(wing, BeamLoad(y=[0.0, 2.0], lift=1.0), [2.0])
    >>> round(float(tip.h[0]), 12)  # -W s^4 / (8 EI)
    -0.5
    """
    _check_clamped(beam)
    points = np.atleast_1d(np.asarray(points, dtype=float))
    check_on_span(beam, points, "points")
    # strains kink where a load does, and displacements are most accurate at element ends
    mesh = beam_mesh(beam, elements=elements, degree=degree, at=np.concatenate([load.point_y, load.y, points]))
    force = _generalised_force(mesh, load)
    blocks = stiffness_blocks(mesh)
    strain = np.linalg.solve(blocks, force.reshape(len(blocks), -1, 1)).ravel()
    return deflection_from_motion(beam, points, strain_shapes(mesh, points) @ strain)


def flexibility(beam: SlenderBeam, points: ArrayLike, *, elements: int = 16, degree: int = 7) -> Array:
    """Flexibility matrix of a clamped beam at points of its axis, by finite elements.

    Parameters
    ----------
    beam : SlenderBeam
        The beam; its root must be clamped.
    points : array_like, shape (n,)
        Points along the flexural axis. [m]
    elements, degree : int
        As in `beam_mesh`.

    Returns
    -------
    C : ndarray, shape (n, 3, n, 3)
        Deflection w up [m], rotation about x and about y [rad] at the first point per unit force up [N], moment about x
        and about y [N m] at the second; symmetric: C[i, p, j, q] = C[j, q, i, p].

    Raises
    ------
    ValueError
        If the root is free or a point is off the span.

    References
    ----------
    Bramstång 2015, Eqs. 4.15-4.20 in the corrected form of equations.md, by another route.

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 3.0], mass=1.0, inertia=1.0, EI=9.0, GJ=1.0)
    >>> round(float(flexibility(wing, [3.0])[0, 0, 0, 0]), 12)  # s^3 / (3 EI)
    1.0
    """
    _check_clamped(beam)
    points = np.atleast_1d(np.asarray(points, dtype=float))
    check_on_span(beam, points, "points")
    mesh = beam_mesh(beam, elements=elements, degree=degree, at=points)
    shapes = strain_shapes(mesh, points).reshape(3 * points.size, -1)
    blocks = stiffness_blocks(mesh)
    solved = np.linalg.solve(blocks, shapes.T.reshape(len(blocks), -1, shapes.shape[0]))
    C = shapes @ solved.reshape(-1, shapes.shape[0])
    return np.asarray(0.5 * (C + C.T)).reshape(points.size, 3, points.size, 3)


def deflection_from_motion(beam: SlenderBeam, points: Array, motion: Array) -> BeamDeflection:
    """Deflection in both sets of axes from w and the rotations about x and y.

    Parameters
    ----------
    beam : SlenderBeam
        The beam.
    points : ndarray, shape (n,)
        Points along the flexural axis. [m]
    motion : ndarray, shape (n, 3)
        Deflection w up [m], rotations about x and y [rad].

    Returns
    -------
    deflection : BeamDeflection
        The same in plunge, slope and twist.

    References
    ----------
    equations.md, Conventions; R.n = dw/ds, R.t = theta (`beam_axis`).

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 3.0], mass=1.0, inertia=1.0, EI=9.0, GJ=1.0)
    >>> deflection_from_motion(wing, np.array([3.0]), np.array([[0.1, 0.0, 0.02]])).twist.tolist()
    [0.02]
    """
    tangent, chordwise = axis_directions(beam.at("sweep", points))
    displacement = np.zeros((points.size, 6))
    displacement[:, 2:5] = motion
    return BeamDeflection(
        y=points,
        grid=beam.position(points),
        h=-motion[:, 0],
        slope=-np.sum(chordwise[:, :2] * motion[:, 1:], axis=1),
        twist=np.sum(tangent[:, :2] * motion[:, 1:], axis=1),
        twist_streamwise=motion[:, 2].copy(),
        displacement=displacement,
    )


def distributed_points(beam: SlenderBeam, load: BeamLoad, breaks: ArrayLike, n: int) -> tuple[Array, Array]:
    """Points along the axis and the force and moments that stand for a distributed load there.

    Parameters
    ----------
    beam : SlenderBeam
        The beam.
    load : BeamLoad
        Its distributed part is used.
    breaks : array_like, shape (m,)
        Places across which what is integrated is not smooth. [m]
    n : int
        Gauss points between breaks.

    Returns
    -------
    y : ndarray, shape (k,)
        Points along the flexural axis. [m]
    force : ndarray, shape (k, 3)
        Force up [N], moments about x and about y [N m].

    Raises
    ------
    ValueError
        If the load reaches off the span.

    References
    ----------
    Bramstång 2015, Eqs. 4.22-4.25 (the integrals over the span).

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 3.0], mass=1.0, inertia=1.0, EI=9.0, GJ=1.0)
    >>> y, force = distributed_points(wing, BeamLoad(y=[0.0, 3.0], lift=2.0), [0.0, 3.0], 4)
    >>> np.round(force.sum(axis=0), 9).tolist()
    [6.0, 0.0, 0.0]
    """
    if load.y.size == 0:
        return np.zeros(0), np.zeros((0, 3))
    check_on_span(beam, load.y, "y of the load")
    breaks = np.asarray(breaks, dtype=float)
    inside = breaks[(breaks > load.y[0]) & (breaks < load.y[-1])]
    y, weight = gauss_points(np.unique(np.concatenate([load.y, inside])), n)
    return y, _force(beam, y, weight * np.interp(y, load.y, load.lift), weight * np.interp(y, load.y, load.torque))


def point_forces(beam: SlenderBeam, load: BeamLoad) -> Array:
    """Force up and moments about x and y of the point loads.

    Parameters
    ----------
    beam : SlenderBeam
        The beam.
    load : BeamLoad
        Its point loads are used.

    Returns
    -------
    force : ndarray, shape (k, 3)
        Force up [N], moments about x and about y [N m], at `load.point_y`.

    Raises
    ------
    ValueError
        If a load is off the span.

    References
    ----------
    equations.md, Conventions: a nose-up torque T about the axis is the moment T t.

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 3.0], mass=1.0, inertia=1.0, EI=9.0, GJ=1.0)
    >>> point_forces(wing, BeamLoad(point_y=[3.0], point_torque=2.0)).tolist()
    [[0.0, 0.0, 2.0]]
    """
    check_on_span(beam, load.point_y, "point_y")
    return _force(beam, load.point_y, load.point_lift, load.point_torque)


def check_on_span(beam: SlenderBeam, y: ArrayLike, name: str) -> None:
    """Refuse points off the span.

    Parameters
    ----------
    beam : SlenderBeam
        The beam.
    y : array_like, shape (n,)
        Points along the flexural axis. [m]
    name : str
        What to call them in the error.

    Raises
    ------
    ValueError
        If one is off the span or not finite.

    References
    ----------
    equations.md, "Conventions".

    Examples
    --------
    >>> check_on_span(SlenderBeam(y=[0.0, 3.0], mass=1.0, inertia=1.0, EI=9.0, GJ=1.0), [1.0], "points")
    """
    y = np.asarray(y, dtype=float)
    if not np.all((y >= beam.y[0]) & (y <= beam.y[-1])):
        raise ValueError(
            f"{name} must lie on the span, {beam.y[0]:g} to {beam.y[-1]:g} m along the axis, got {y.tolist()}"
        )


def _check_clamped(beam: SlenderBeam) -> None:
    """A free wing has no static deflection until its loads are balanced by its motion."""
    if beam.root != "clamped":
        raise ValueError(
            'root must be "clamped" for a static deflection, got "free": a free wing has one only relative to its '
            "own motion; add the inertia loads and hold the root (dataclasses.replace(beam, root='clamped'))"
        )


def _generalised_force(mesh: BeamMesh, load: BeamLoad) -> Array:
    """Work of the load per unit of each strain coordinate, shape (n_strain,)."""
    y, force = distributed_points(mesh.beam, load, mesh.nodes, _LOAD_POINTS)
    y = np.concatenate([y, load.point_y])
    force = np.concatenate([force, point_forces(mesh.beam, load)])
    return np.einsum("gin,gi->n", strain_shapes(mesh, y), force)


def _force(beam: SlenderBeam, y: Array, lift: Array, torque: Array) -> Array:
    """Force up and moments about x and y of lift up and torque about the axis."""
    tangent = axis_directions(beam.at("sweep", y))[0]
    return np.concatenate([lift[:, None], torque[:, None] * tangent[:, :2]], axis=1)
