"""Natural modes of a slender beam wing, clamped or as half of a free wing.

The definition is in `beam_axis`, the elements in `beam_elements`, loads and deflections in
`beam_static`; this module turns them into modes. Where the theory stops: see `beam_axis`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import eigh

from aeroservo.datatypes import ModalModel
from aeroservo.structure.beam_axis import Array, BeamMass, SlenderBeam, axis_directions
from aeroservo.structure.beam_elements import (
    BeamMatrices,
    BeamMesh,
    beam_matrices,
    rigid_shapes,
    stiffness_blocks,
    strain_shapes,
)
from aeroservo.structure.viscoelastic import relaxing

__all__ = ["BeamMass", "BeamMatrices", "BeamModes", "SlenderBeam", "beam_matrices", "beam_modes", "modes"]

NEGLIGIBLE = 1e-13  # a mode whose 1/omega^2 is below this part of the largest carries no mass: none is there


@dataclass(frozen=True, kw_only=True, eq=False)
class BeamModes:
    """Natural modes of a beam, rigid-body modes first, then by rising frequency.

    Attributes
    ----------
    omega : ndarray, shape (n,)
        Natural frequencies; exactly 0 for rigid-body modes. [rad/s]
    names : tuple of str
        "heave", "pitch", "roll"; "bending 1", "torsion 1", ... by which strain energy is the larger.
    y : ndarray, shape (n_points,)
        Points along the flexural axis. [m]
    grid : ndarray, shape (n_points, 3)
        The same points in geometry axes. [m]
    phi : ndarray, shape (n_points, 6, n)
        Displacement (x, y, z) [m] and rotation vector [rad] in geometry axes, of modes of unit generalised mass.
    h, slope, twist : ndarray, shape (n_points, n)
        Plunge positive down [m], its derivative dh/ds along the axis [rad] (of the panel outboard of the point), and
        twist about the axis, nose up [rad].
    torsion_share : ndarray, shape (n,)
        Torsion's part of the strain energy of bending plus torsion; 0 for rigid-body modes. [-]
    bending_K, torsion_K : ndarray, shape (n, n)
        Parts of K that EI and GJ hold; with that of a coupling they add up to it. [rad^2/s^2]
    """

    omega: Array
    names: tuple[str, ...]
    y: Array
    grid: Array
    phi: Array
    h: Array
    slope: Array
    twist: Array
    torsion_share: Array
    bending_K: Array
    torsion_K: Array

    @property
    def M(self) -> Array:
        """Generalised mass, the unit matrix. [kg m^2 where the coordinate is normalised to it]"""
        return np.eye(self.omega.size)

    @property
    def K(self) -> Array:
        """Generalised stiffness, diagonal: omega^2. [rad^2/s^2]"""
        return np.diag(self.omega**2)


def beam_modes(
    beam: SlenderBeam, *, n: int = 6, points: ArrayLike | None = None, elements: int | None = None, degree: int = 5
) -> BeamModes:
    """Natural frequencies and mode shapes of a slender beam.

    Rigid-body modes are exact: their shapes are written down, the elastic modes are sought among the motions
    without momentum in them, and their frequencies are exactly zero. A root mass that grows without limit
    turns the elastic modes of a free root into those of the clamped one.

    Parameters
    ----------
    beam : SlenderBeam
        The beam.
    n : int
        Modes wanted, rigid-body modes included.
    points : array_like, shape (n_points,), optional
        Where shapes are wanted, along the flexural axis; 33 equally spaced points by default. [m]
    elements : int, optional
        Elements over the length, default the larger of 8 and 2 n: then all n frequencies
        of a uniform wing are good to 1e-6.
    degree : int
        Degree p of the deflection in an element; omega^2 converges as h^(2 p - 2).

    Returns
    -------
    modes : BeamModes
        Unit generalised masses. Sign: the largest plunge of a bending mode is positive (down), the largest twist of
        a torsion mode nose up, the outermost of them where several are equal.

    Raises
    ------
    ValueError
        If the model has fewer than `n` modes, a point is off the span, or as `beam_matrices`.

    References
    ----------
    equations.md, "One equation of motion" with Q = 0; Bramstång 2015, Eqs. 4.4, 4.29 and 4.36;
    M. Goland, J. Appl. Mech. 12(4), 1945 for the example.

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 6.096], mass=35.717, inertia=8.642, cg_offset=0.18288, EI=9.773e6, GJ=0.9876e6)
    >>> goland = beam_modes(wing, n=2)
    >>> np.round(goland.omega, 5).tolist(), goland.names
    ([48.15543, 95.71935], ('bending 1', 'torsion 1'))
    """
    if n < 1:
        raise ValueError(f"n, the number of modes, must be 1 or more, got {n}")
    y = np.linspace(beam.y[0], beam.y[-1], 33) if points is None else np.atleast_1d(np.asarray(points, dtype=float))
    if not np.all((y >= beam.y[0]) & (y <= beam.y[-1])):
        raise ValueError(
            f"points must lie on the span, {beam.y[0]:g} to {beam.y[-1]:g} m along the axis, got {y.tolist()}"
        )
    matrices = beam_matrices(beam, elements=max(8, 2 * n) if elements is None else elements, degree=degree)
    mesh, r = matrices.mesh, len(matrices.rigid_names)
    rigid = np.diag(1.0 / np.sqrt(np.diag(matrices.M)[:r]))[:, :n]
    omega, coordinates = _elastic_modes(matrices, n - rigid.shape[1])
    share = _torsion_share(*_strain_parts(mesh, coordinates[r:]))
    coordinates = coordinates * _signs(mesh, matrices.x_cg, coordinates, share)
    coordinates = np.hstack([np.vstack([rigid, np.zeros((mesh.n_strain, rigid.shape[1]))]), coordinates])
    parts = _strain_parts(mesh, coordinates[r:])
    motion = _motion(mesh, y, matrices.x_cg, coordinates)
    phi = np.zeros((y.size, 6, n))
    phi[:, 2:5] = motion
    h, slope, twist = _local(beam, y, motion)
    zeros = np.zeros(rigid.shape[1])
    return BeamModes(
        omega=np.concatenate([zeros, omega]),
        names=matrices.rigid_names[:n] + _elastic_names(share),
        y=y,
        grid=beam.position(y),
        phi=phi,
        h=h,
        slope=slope,
        twist=twist,
        torsion_share=np.concatenate([zeros, share]),
        bending_K=parts[0],
        torsion_K=parts[1],
    )


def modes(
    beam: SlenderBeam, *, n: int = 6, points: ArrayLike | None = None, elements: int | None = None, degree: int = 5
) -> ModalModel:
    """Modal model of a slender beam, undamped.

    Parameters
    ----------
    beam, n, elements, degree
        As in `beam_modes`.
    points : array_like, shape (n_points,), optional
        As in `beam_modes`. [m]

    Returns
    -------
    model : ModalModel
        M the unit matrix, K = diag(omega^2) with exact zeros for rigid-body modes, phi at `points`; modes and K of a
        viscoelastic beam are the instantaneous ones, what relaxes of K goes with them.

    Raises
    ------
    ValueError
        As `beam_modes`.

    References
    ----------
    equations.md, "One equation of motion for every model".

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 6.0], mass=30.0, inertia=8.0, EI=1e7, GJ=1e6, root="free")
    >>> modes(wing, n=3).names
    ('heave', 'pitch', 'bending 1')
    """
    found = beam_modes(beam, n=n, points=points, elements=elements, degree=degree)
    relaxes = () if beam.material is None else relaxing(found.bending_K, found.torsion_K, beam.material)
    return ModalModel(
        M=found.M,
        D=np.zeros_like(found.M),
        K=found.K,
        names=found.names,
        phi=found.phi,
        grid=found.grid,
        relaxing=relaxes,
    )


def _elastic_modes(matrices: BeamMatrices, n: int) -> tuple[Array, Array]:
    """Frequencies and mass-normalised coordinates (n_rigid + n_strain, n) of the lowest elastic modes.

    With q_r = -M_rr^-1 M_rc c no momentum is left in the rigid-body modes, and K_c c = omega^2 M_eff c with K_c
    positive definite. Solved for 1/omega^2, whose largest values come out to rounding.
    """
    M, mesh, r = matrices.M, matrices.mesh, len(matrices.rigid_names)
    follow = -M[:r, r:] / np.diag(M)[:r, None]
    blocks = stiffness_blocks(mesh)
    size, width = mesh.n_strain, blocks.shape[1]
    if n > size:
        raise ValueError(f"{n} elastic modes need more elements: these have {size} coordinates")
    if n == 0:
        return np.zeros(0), np.zeros((r + size, 0))
    inverse = np.linalg.inv(np.linalg.cholesky(blocks))
    effective = M[r:, r:] + M[r:, :r] @ follow
    half = inverse @ effective.reshape(-1, width, size)
    half = inverse @ half.reshape(size, size).T.reshape(-1, width, size)
    flexible = half.reshape(size, size)
    mu, vectors = eigh(0.5 * (flexible + flexible.T), subset_by_index=[size - n, size - 1])
    mu, vectors = mu[::-1], vectors[:, ::-1]
    if mu[-1] <= NEGLIGIBLE * max(mu[0], np.trace(flexible)):
        found = int(np.sum(mu > NEGLIGIBLE * max(mu[0], np.trace(flexible))))
        raise ValueError(f"n: the masses of this beam give only {found} elastic modes, {n} were asked for")
    strain = (inverse.transpose(0, 2, 1) @ vectors.reshape(-1, width, n)).reshape(size, n) / np.sqrt(mu)
    return 1.0 / np.sqrt(mu), np.vstack([follow @ strain, strain])


def _strain_parts(mesh: BeamMesh, strain: Array) -> tuple[Array, Array]:
    """Stiffness (n, n) of bending alone and of torsion alone against strain coordinates (n_strain, n)."""
    k = mesh.terms
    blocks = stiffness_blocks(mesh)
    parts = strain.reshape(len(blocks), 2, k, strain.shape[1])
    bending, torsion = (
        np.einsum(
            "eim,eij,ejn->mn",
            parts[:, i],
            blocks[:, i * k : (i + 1) * k, i * k : (i + 1) * k],
            parts[:, i],
            optimize=True,
        )
        for i in (0, 1)
    )
    return bending, torsion


def _torsion_share(bending: Array, torsion: Array) -> Array:
    """Torsion's part of the strain energies of bending and torsion, without that of their coupling."""
    return np.asarray(np.diag(torsion) / (np.diag(bending) + np.diag(torsion)))


def _elastic_names(share: Array) -> tuple[str, ...]:
    """Numbered "bending" and "torsion" in order of frequency."""
    count = {"bending": 0, "torsion": 0}
    names = []
    for part in share:
        kind = "torsion" if part > 0.5 else "bending"
        count[kind] += 1
        names.append(f"{kind} {count[kind]}")
    return tuple(names)


def _signs(mesh: BeamMesh, x_cg: float, coordinates: Array, share: Array) -> Array:
    """+1 or -1 per mode: its largest plunge (bending) or twist (torsion) positive, the outermost if several are."""
    motion = _motion(mesh, mesh.nodes, x_cg, coordinates)
    h, _, twist = _local(mesh.beam, mesh.nodes, motion)
    shape = np.where(share > 0.5, twist, h)
    large = np.abs(shape) >= (1.0 - 1e-6) * np.abs(shape).max(axis=0)
    outermost = shape.shape[0] - 1 - np.argmax(large[::-1], axis=0)
    return np.where(shape[outermost, np.arange(shape.shape[1])] < 0.0, -1.0, 1.0)


def _motion(mesh: BeamMesh, y: Array, x_cg: float, coordinates: Array) -> Array:
    """Deflection w and rotations about x and y at points along the axis, shape (n_points, 3, n)."""
    shapes = np.concatenate([rigid_shapes(mesh, y, x_cg), strain_shapes(mesh, y)], axis=2)
    return np.asarray(shapes @ coordinates)


def _local(beam: SlenderBeam, y: Array, motion: Array) -> tuple[Array, Array, Array]:
    """Plunge h down, dh/ds and nose-up twist about the axis, from (n_points, 3, ...) of w and rotations."""
    tangent, chordwise = axis_directions(beam.at("sweep", y))
    slope = np.einsum("gi,gi...->g...", chordwise[:, :2], motion[:, 1:])
    twist = np.einsum("gi,gi...->g...", tangent[:, :2], motion[:, 1:])
    return -motion[:, 0], -slope, twist
