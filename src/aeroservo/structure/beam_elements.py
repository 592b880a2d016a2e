"""Finite elements of a slender beam in curvature and twist rate.

Each element carries its curvature w'' and its twist rate theta' as Legendre series of degree p - 2.
Integrated outboard from the root they give a deflection that is a piecewise polynomial of degree p
with continuous slope and a continuous twist of degree p - 1: for p = 3 exactly the space of Hermite
cubics and quadratic twist, with the same Ritz values. Working in strains instead of nodal displacements
brings three things: the stiffness matrix falls apart into one small block per element, so its
conditioning does not grow with 1/h^4; rigid-body shapes are coordinates of their own whose rows and
columns of K are zero by construction; and a kinked axis needs no special treatment, because slope
and twist are components of one rotation vector that is integrated along it.

Convergence: squared frequencies to order h^(2 p - 2), so h^4 for p = 3 and h^8 for p = 5.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike

from aeroservo.structure.beam_axis import Array, BeamMass, SlenderBeam, axis_directions, gauss_points


@dataclass(frozen=True, kw_only=True, eq=False)
class BeamMesh:
    """A beam cut into elements; boundaries lie at every station, and at lumps and other points asked for.

    Attributes
    ----------
    beam : SlenderBeam
        What is modelled.
    nodes : ndarray, shape (n_elements + 1,)
        Element boundaries along the flexural axis. [m]
    degree : int
        Degree p of the deflection inside an element; the twist has degree p - 1.
    """

    beam: SlenderBeam
    nodes: Array
    degree: int

    @property
    def terms(self) -> int:
        """Legendre terms of curvature, and of twist rate, per element."""
        return self.degree - 1

    @property
    def n_strain(self) -> int:
        """Number of strain coordinates, ordered (element, curvature then twist rate, term)."""
        return 2 * self.terms * (self.nodes.size - 1)


@dataclass(frozen=True, kw_only=True, eq=False)
class BeamMatrices:
    """Mass and stiffness of a beam under its root condition.

    The coordinates are first the rigid-body ones (none when clamped), then the strains of the elements.

    Attributes
    ----------
    M, K : ndarray, shape (n, n)
        Consistent mass and stiffness; rows and columns of K of rigid-body coordinates are exactly zero. [SI]
    rigid_names : tuple of str
        "heave" and "pitch" (about the centre of gravity), or "roll", or nothing.
    x_cg : float
        Centre of gravity in geometry axes, the axis of "pitch". [m]
    mesh : BeamMesh
        The elements.
    """

    M: Array
    K: Array
    rigid_names: tuple[str, ...]
    x_cg: float
    mesh: BeamMesh


def beam_mesh(beam: SlenderBeam, *, elements: int = 8, degree: int = 5, at: ArrayLike = ()) -> BeamMesh:
    """Cut a beam into elements.

    Parameters
    ----------
    beam : SlenderBeam
        The beam.
    elements : int
        Elements over the whole length, shared among the panels by length, at least one in each.
    degree : int
        Degree of the deflection in an element, 3 or more.
    at : array_like, shape (m,)
        Further element boundaries along the axis, such as points of load; those closer than 1e-3 of the
        length to another boundary are left out, which costs little accuracy and no conditioning. [m]

    Returns
    -------
    mesh : BeamMesh
        Boundaries at all stations and lumps, at `at`, and equally spaced between.

    Raises
    ------
    ValueError
        If `elements` is below 1, `degree` below 3, or a point off the span.

    References
    ----------
    G. Strang and G. Fix, An Analysis of the Finite Element Method, 1973, section 6.3 (order of eigenvalues).

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 6.0], mass=30.0, inertia=8.0, EI=1e7, GJ=1e6)
    >>> beam_mesh(wing, elements=3).nodes.tolist()
    [0.0, 2.0, 4.0, 6.0]
    """
    if elements < 1:
        raise ValueError(f"elements must be 1 or more, got {elements}")
    if degree < 3:
        raise ValueError(f"degree of the elements must be 3 or more, got {degree}")
    at = np.asarray(at, dtype=float).ravel()
    if at.size and (not np.all(np.isfinite(at)) or at.min() < beam.y[0] or at.max() > beam.y[-1]):
        raise ValueError(
            f"points must lie on the span, {beam.y[0]:g} to {beam.y[-1]:g} m along the axis, got {at.tolist()}"
        )
    corners = list(beam.y)
    for y in np.unique([*(lump.y for lump in beam.masses), *at]):
        if np.abs(np.asarray(corners) - y).min() > 1e-3 * beam.length:
            corners.append(y)
    ends = np.sort(corners)
    # the 1e-9 keeps a length that is a whole number of elements from being cut once more by rounding
    pieces = np.maximum(1, np.ceil(elements * np.diff(ends) / beam.length - 1e-9)).astype(int)
    inner = [np.linspace(a, b, n + 1)[1:] for a, b, n in zip(ends[:-1], ends[1:], pieces)]
    return BeamMesh(beam=beam, nodes=np.concatenate([ends[:1], *inner]), degree=int(degree))


def strain_shapes(mesh: BeamMesh, y: ArrayLike) -> Array:
    """Displacement of the axis per unit of each strain coordinate, root held.

    Parameters
    ----------
    mesh : BeamMesh
        The elements.
    y : array_like, shape (m,)
        Points along the axis. [m]

    Returns
    -------
    S : ndarray, shape (m, 3, n_strain)
        Deflection w up [m], rotation about x and rotation about y [rad], in geometry axes.

    References
    ----------
    Bramstång 2015, Eqs. 4.2-4.3 read as strains and integrated twice and once along the axis.

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 2.0], mass=1.0, inertia=1.0, EI=1.0, GJ=1.0)
    >>> S = strain_shapes(beam_mesh(wing, elements=1, degree=3), [2.0])
    >>> np.round(S[0, :, 0], 12).tolist()  # unit curvature over 2 m: w = 2^2 / 2, slope 2
    [2.0, 2.0, -0.0]
    """
    y = np.atleast_1d(np.asarray(y, dtype=float))
    nodes, k = mesh.nodes, mesh.terms
    n_el = nodes.size - 1
    half = 0.5 * np.diff(nodes)
    tangent, chordwise = axis_directions(mesh.beam.at("sweep", nodes[:-1]))
    element = np.clip(np.searchsorted(nodes, y, side="right") - 1, 0, n_el - 1)
    xi = (y - nodes[element]) / half[element] - 1.0
    _, first, second = _legendre_integrals(xi, k)
    S = np.zeros((y.size, 3, n_el, 2, k))
    # elements wholly inboard of the point: a rigid continuation of their outboard end
    _, first_end, second_end = _legendre_integrals(np.ones(1), k)
    arm = mesh.beam.position(y)[:, None, :] - mesh.beam.position(nodes[1:])[None, :, :]
    inboard = (np.arange(n_el) < element[:, None]).astype(float)
    for kind, axis in enumerate((chordwise, tangent)):
        turn = axis[:, :2, None] * (half[:, None] * first_end)[:, None, :]
        bend = (half[:, None] ** 2 * second_end) if kind == 0 else np.zeros((n_el, k))
        w = bend + turn[:, 0] * arm[:, :, 1, None] - turn[:, 1] * arm[:, :, 0, None]
        S[:, 0, :, kind] = w * inboard[..., None]
        S[:, 1:, :, kind] = turn.transpose(1, 0, 2) * inboard[:, None, :, None]
    # the element that holds the point
    own, h = np.arange(y.size), half[element][:, None]
    S[own, 0, element, 0] = h**2 * second
    for kind, axis in enumerate((chordwise, tangent)):
        for i in (0, 1):
            S[own, 1 + i, element, kind] = axis[element, i, None] * h * first
    return S.reshape(y.size, 3, -1)


def rigid_shapes(mesh: BeamMesh, y: ArrayLike, x_cg: float) -> Array:
    """Displacement of the axis per unit of each rigid-body coordinate that the root leaves free.

    Parameters
    ----------
    mesh : BeamMesh
        The elements.
    y : array_like, shape (m,)
        Points along the axis. [m]
    x_cg : float
        Axis of pitch in geometry axes. [m]

    Returns
    -------
    R : ndarray, shape (m, 3, n_rigid)
        Deflection w up [m], rotation about x and about y [rad]: heave 1 m down and pitch 1 rad nose up about `x_cg`;
        or roll 1 rad starboard wing down about the plane of symmetry y = 0; or nothing, clamped.

    References
    ----------
    equations.md, Conventions (plunge positive down, pitch positive nose up).

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 2.0], mass=1.0, inertia=1.0, EI=1.0, GJ=1.0, root="free", symmetry="antisymmetric")
    >>> rigid_shapes(beam_mesh(wing), [2.0], 0.0)[0, :, 0].tolist()
    [-2.0, -1.0, 0.0]
    """
    place = mesh.beam.position(np.atleast_1d(np.asarray(y, dtype=float)))
    one, zero = np.ones(len(place)), np.zeros(len(place))
    columns = {
        "heave": (-one, zero, zero),
        "pitch": (-(place[:, 0] - x_cg), zero, one),
        "roll": (-place[:, 1], -one, zero),
    }
    chosen = [np.stack(columns[name], axis=-1) for name in rigid_names(mesh.beam)]
    return np.stack(chosen, axis=-1) if chosen else np.zeros((len(place), 3, 0))


def rigid_names(beam: SlenderBeam) -> tuple[str, ...]:
    """Names of the rigid-body modes that the root leaves free.

    Parameters
    ----------
    beam : SlenderBeam
        The beam.

    Returns
    -------
    names : tuple of str
        ("heave", "pitch"), ("roll",) or ().

    References
    ----------
    equations.md, "Whole aircraft" [7.43-7.46], where heave is free.

    Examples
    --------
    >>> rigid_names(SlenderBeam(y=[0.0, 2.0], mass=1.0, inertia=1.0, EI=1.0, GJ=1.0))
    ()
    """
    if beam.root == "clamped":
        return ()
    return ("heave", "pitch") if beam.symmetry == "symmetric" else ("roll",)


def beam_matrices(beam: SlenderBeam, *, elements: int = 8, degree: int = 5, at: ArrayLike = ()) -> BeamMatrices:
    """Consistent mass and stiffness matrices of a slender beam.

    Parameters
    ----------
    beam : SlenderBeam
        The beam.
    elements, degree : int
        As in `beam_mesh`.
    at : array_like, shape (m,)
        Further element boundaries, as in `beam_mesh`. [m]

    Returns
    -------
    matrices : BeamMatrices
        M and K in rigid-body and strain coordinates.

    Raises
    ------
    ValueError
        As `beam_mesh`, or if a free beam has no mass or no inertia in a rigid-body mode.

    References
    ----------
    Bramstång 2015, Eq. 4.4 (strain energy) and 4.36 (Lagrange); kinetic energy per length
    1/2 (m h'^2 + 2 m d h' theta' + I theta'^2) with ' = d/dt, d the offset of the centre of gravity.

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 6.0], mass=30.0, inertia=8.0, EI=1e7, GJ=1e6, root="free")
    >>> matrices = beam_matrices(wing, elements=2)
    >>> float(np.abs(matrices.K[:2]).max()), round(float(matrices.M[0, 0]), 9)
    (0.0, 180.0)
    """
    mesh = beam_mesh(beam, elements=elements, degree=degree, at=at)
    y, weight = gauss_points(mesh.nodes, degree + 2)
    density = _section_mass(beam, y) * weight[:, None, None]
    where = np.concatenate([y, [lump.y for lump in beam.masses]])
    density = np.concatenate([density, *([_lump_mass(beam, lump)[None] for lump in beam.masses])])
    # mass and its first moment about the axis say where the centre of gravity is
    total = density[:, 0, 0].sum()
    place = beam.position(where)[:, 0]
    moment = (density[:, 0, 0] * place - density[:, 0, 2]).sum()
    x_cg = float(moment / total) if total > 0.0 else float(beam.origin[0])
    shapes = np.concatenate([rigid_shapes(mesh, where, x_cg), strain_shapes(mesh, where)], axis=2)
    weighted = np.einsum("gij,gjn->gin", density, shapes)
    M = shapes.reshape(-1, shapes.shape[2]).T @ weighted.reshape(-1, shapes.shape[2])
    names = rigid_names(beam)
    r = len(names)
    for name, value in zip(names, np.diag(M)):
        if value <= 0.0:
            raise ValueError(f"a free beam needs mass or inertia in {name} (mass, inertia or a lump's), got {value:g}")
    M = 0.5 * (M + M.T)
    if r == 2:
        M[0, 1] = M[1, 0] = 0.0  # pitch is about the centre of gravity: zero but for rounding
    K = np.zeros_like(M)
    blocks = stiffness_blocks(mesh)
    b = blocks.shape[1]
    for i, block in enumerate(blocks):
        part = slice(r + i * b, r + (i + 1) * b)
        K[part, part] = block
    return BeamMatrices(M=M, K=K, rigid_names=names, x_cg=x_cg, mesh=mesh)


def stiffness_blocks(mesh: BeamMesh) -> Array:
    """Stiffness of each element in its own strain coordinates.

    Parameters
    ----------
    mesh : BeamMesh
        The elements.

    Returns
    -------
    K : ndarray, shape (n_elements, 2 terms, 2 terms)
        Second derivative of the strain energy 1/2 (EI w''^2 - 2 K w'' theta' + GJ theta'^2), w up. [SI]

    References
    ----------
    Bramstång 2015, Eq. 4.4, whose torsion term is GJ (d theta / dy)^2 / 2; coupling as in `SlenderBeam`.

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 2.0], mass=1.0, inertia=1.0, EI=5.0, GJ=3.0)
    >>> np.round(np.diag(stiffness_blocks(beam_mesh(wing, elements=1, degree=3))[0]), 9).tolist()
    [10.0, 3.333333333, 6.0, 2.0]
    """
    n = mesh.terms
    xi, weight = np.polynomial.legendre.leggauss(n + 1)
    P = legendre.legvander(xi, n - 1)
    half = 0.5 * np.diff(mesh.nodes)[:, None]
    y = mesh.nodes[:-1, None] + half * (1.0 + xi)
    EI, GJ, coupling = (mesh.beam.at(name, y) * weight * half for name in ("EI", "GJ", "coupling"))
    blocks = [np.einsum("eg,gi,gj->eij", part, P, P) for part in (EI, -coupling, GJ)]
    bending, both, torsion = blocks
    return np.concatenate([np.concatenate([bending, both], axis=2), np.concatenate([both, torsion], axis=2)], axis=1)


def _section_mass(beam: SlenderBeam, y: Array) -> Array:
    """Inertia per length against (w, rotation about x, rotation about y), shape (m, 3, 3)."""
    m, d, inertia = beam.at("mass", y), beam.at("cg_offset", y), beam.at("inertia", y)
    tangent = axis_directions(beam.at("sweep", y))[0]
    return _line_mass(m, m * d, inertia, tangent)


def _lump_mass(beam: SlenderBeam, lump: BeamMass) -> Array:
    """Inertia of one lump against (w, rotation about x, rotation about y), shape (3, 3)."""
    tangent = axis_directions(beam.at("sweep", lump.y))[0]
    m, x = lump.mass, lump.x
    own = _line_mass(np.asarray(m), np.asarray(m * x), np.asarray(lump.inertia + m * x**2), tangent)
    own[1, 1] += lump.roll_inertia
    return own


def _line_mass(m: Array, static: Array, inertia: Array, tangent: Array) -> Array:
    """Mass matrix of 1/2 (m w^2 - 2 S w theta + I theta^2) with theta = R.t: mass aft of the axis goes down nose up."""
    matrix = np.zeros((*np.shape(m), 3, 3))
    t = tangent[..., :2]
    matrix[..., 0, 0] = m
    matrix[..., 0, 1:] = matrix[..., 1:, 0] = -np.asarray(static)[..., None] * t
    matrix[..., 1:, 1:] = np.asarray(inertia)[..., None, None] * t[..., :, None] * t[..., None, :]
    return matrix


def _legendre_integrals(xi: Array, n: int) -> tuple[Array, Array, Array]:
    """Legendre polynomials of degree 0 to n - 1 and their first and second integrals from -1, each (m, n)."""
    eye = np.eye(n)
    value = np.asarray(legendre.legvander(xi, n - 1), dtype=float)
    first = legendre.legvander(xi, n) @ legendre.legint(eye, 1, lbnd=-1)
    second = legendre.legvander(xi, n + 1) @ legendre.legint(eye, 2, lbnd=-1)
    return value, first, second
