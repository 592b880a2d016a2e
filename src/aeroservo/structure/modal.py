"""Natural modes of any structure in generalised coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig
from scipy.optimize import linear_sum_assignment

from aeroservo.datatypes import Array, ModalModel, frozen

RIGID = 1e-10
"""A frequency squared below this part of the largest belongs to a rigid-body mode."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NaturalModes:
    """Undamped modes in vacuum, in order of frequency.

    Attributes
    ----------
    omega : ndarray, shape (n,)
        Natural frequencies, exactly 0 for rigid-body modes. [rad/s]
    names : tuple of str
        Name of the coordinate that holds most of each mode's energy, each used once.
    shapes : ndarray, shape (n, n)
        Shape of mode j in column j, largest entry 1. [unit of each coordinate]
    generalized_mass : ndarray, shape (n,)
        Mass of each mode with that normalisation. [kg m^2 per unit^2]
    """

    omega: Array
    names: tuple[str, ...]
    shapes: Array
    generalized_mass: Array

    def __post_init__(self) -> None:
        """Lock the arrays."""
        for name in ("omega", "shapes", "generalized_mass"):
            object.__setattr__(self, name, frozen(getattr(self, name), name=name))


def natural_modes(modes: ModalModel) -> NaturalModes:
    """Undamped natural modes of M q'' + K q = 0.

    Parameters
    ----------
    modes : ModalModel
        The structure.

    Returns
    -------
    natural : NaturalModes
        Frequencies, names, shapes and generalised masses. [SI]

    Raises
    ------
    ValueError
        If M^-1 K has eigenvalues that are negative or not real: then there are no natural modes.

    References
    ----------
    Bramstång 2015, Eq. 7.24 with rho = 0 and D = 0.

    Examples
    --------
    >>> two = ModalModel(M=[[2.0, 0.0], [0.0, 1.0]], D=[[0.0, 0.0], [0.0, 0.0]], K=[[2.0, 0.0], [0.0, 9.0]],
    ...                  names=("plunge", "pitch"))
    >>> natural_modes(two).omega.tolist()
    [1.0, 3.0]
    """
    squares, vectors = eig(modes.K, modes.M)
    largest = np.abs(squares).max(initial=0.0)
    if np.any(np.abs(squares.imag) > 1e-6 * largest) or np.any(squares.real < -1e-6 * largest):
        raise ValueError("the stiffness has negative or complex natural frequencies squared: K is not a structure's")
    squares = np.where(squares.real > RIGID * largest, squares.real, 0.0)
    order = np.argsort(squares, kind="stable")
    squares, shapes = squares[order], vectors[:, order].real
    shapes = shapes / np.take_along_axis(shapes, np.argmax(np.abs(shapes), axis=0)[None, :], axis=0)
    mass = np.einsum("ij,ik,kj->j", shapes, modes.M, shapes)
    energy = shapes**2 * np.diag(modes.M)[:, None] / np.maximum(mass, 1e-300)
    coordinate = np.empty(modes.n, dtype=int)
    rows, columns = linear_sum_assignment(-energy.T)
    coordinate[rows] = columns
    return NaturalModes(
        omega=np.sqrt(squares),
        names=tuple(modes.names[j] for j in coordinate),
        shapes=shapes,
        generalized_mass=mass,
    )


def tip_motion(modes: ModalModel) -> tuple[Array, Array]:
    """Plunge and twist of the tip per unit of each mode, for shapes given along a flexural axis.

    The tip is the grid point farthest out; the axis there runs from its nearest neighbour to it (along y where
    there is no other point, as for a section).

    Parameters
    ----------
    modes : ModalModel
        With grid points along one axis.

    Returns
    -------
    h, twist : ndarray, shape (n,)
        Plunge, positive down [m], and rotation about the axis, nose up [rad]. [per unit]

    Raises
    ------
    ValueError
        If the model has no grid.

    References
    ----------
    equations.md, "Conventions": x aft, y starboard, z up; h down, nose up is a rotation about +y.

    Examples
    --------
    >>> phi = np.zeros((1, 6, 1)); phi[0, 4] = 1.0
    >>> pitch = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("pitch",), phi=phi, grid=[[0.0, 1.0, 0.0]])
    >>> tip_motion(pitch)[1].tolist()
    [1.0]
    """
    if not len(modes.grid):
        raise ValueError("the modes have no grid: where the tip is, is not known")
    tip = int(np.argmax(modes.grid[:, 1]))
    along = modes.grid[tip, :2] - modes.grid[:, :2]
    distance = np.hypot(along[:, 0], along[:, 1])
    others = np.flatnonzero(distance > 0.0)
    nearest = others[np.argmin(distance[others])] if others.size else None
    axis = np.array([0.0, 1.0]) if nearest is None else along[nearest] / distance[nearest]
    return -modes.phi[tip, 2], axis @ modes.phi[tip, 3:5]
