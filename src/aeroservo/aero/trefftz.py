"""Induced drag in the Trefftz plane: a quadratic form in the inputs of a lattice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.aero.vlm import Lattice
from aeroservo.aero.vlm_kernels import columns, wake_influence
from aeroservo.aero.vlm_loads import strip_circulation
from aeroservo.aero.vlm_solve import LatticeSolution


@dataclass(frozen=True, kw_only=True, eq=False)
class InducedDrag:
    """Drag area as a quadratic form: D/q = x . matrix . x for inputs x in the order of `names`."""

    names: tuple[str, ...]  # names of the inputs
    matrix: np.ndarray  # (m, m) [m^2] symmetric

    def area(self, inputs: np.ndarray) -> np.ndarray:
        """Drag over dynamic pressure for inputs (..., m), shape (...) [m^2]."""
        x = np.asarray(inputs, dtype=float)
        return np.einsum("...i,ij,...j->...", x, self.matrix, x)


def induced_drag(solution: LatticeSolution) -> InducedDrag:
    """Induced drag from the wake far downstream.

    Parameters
    ----------
    solution : LatticeSolution
        Circulations.

    Returns
    -------
    InducedDrag
        Quadratic form of the whole aircraft.

    References
    ----------
    D = -(rho/2) * integral of Gamma w_n ds over the wake's trace: J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001,
    chapter 8.

    Examples
    --------
    >>> from aeroservo.aero.vlm import lattice, lattice_surface
    >>> from aeroservo.aero.vlm_normalwash import rigid_normalwash
    >>> from aeroservo.aero.vlm_solve import solve_lattice
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1])])
    >>> bool(induced_drag(solve_lattice(grid, rigid_normalwash(grid, [0, 0, 0]))).matrix[0, 0] > 0)
    True
    """
    grid = solution.lattice
    circulation = strip_circulation(solution)
    width = grid.strip_width[:, None]
    direct = trefftz_influence(grid)
    if not grid.mirrored:
        matrix = -circulation.T @ (width * (direct @ circulation))
    else:
        image = trefftz_influence(grid, image=True)
        parity = solution.normalwash.parity
        wash = direct @ circulation + (image @ circulation) * parity
        same = parity[:, None] == parity[None, :]
        matrix = np.where(same, -2.0 * circulation.T @ (width * wash), 0.0)
    matrix = (matrix + matrix.T) / 2.0
    matrix.flags.writeable = False
    return InducedDrag(names=solution.names, matrix=matrix)


def trefftz_influence(lattice: Lattice, *, image: bool = False) -> np.ndarray:
    """Normal velocity far downstream at the strips' control stations for unit strip circulations.

    Parameters
    ----------
    lattice : Lattice
        The strips.
    image : bool
        The influence of the mirror images instead.

    Returns
    -------
    T : ndarray, shape (n_strips, n_strips)
        Row: station; column: strip. [1/m]

    References
    ----------
    Two straight vortices 2/(4 pi d) each; J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 8.

    Examples
    --------
    >>> from aeroservo.aero.vlm import VortexLattice, lattice, lattice_surface
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1], options=VortexLattice(spanwise=1))])
    >>> round(float(trefftz_influence(grid)[0, 0]) * np.pi, 12)
    -1.0
    """
    along = lattice.strip_edge_b - lattice.strip_edge_a
    normal = np.stack([np.zeros(len(along)), -along[:, 2], along[:, 1]], axis=-1) / lattice.strip_width[:, None]
    side = np.array([1.0, -1.0 if image else 1.0, 1.0])
    _, py, pz = columns(lattice.strip_edge * side)
    _, ny, nz = columns(normal * side)
    _, ay, az = columns(lattice.strip_edge_a)
    _, by, bz = columns(lattice.strip_edge_b)
    out = np.zeros((len(along), len(along)))
    wake_influence(py, pz, ny, nz, ay, az, by, bz, lattice.core**2, out)
    return out


def span_efficiency(lift_area: float, drag_area: float, span: float) -> float:
    """Oswald's efficiency of the induced drag.

    Parameters
    ----------
    lift_area, drag_area : float
        Lift and induced drag over dynamic pressure. [m^2]
    span : float
        Span. [m]

    Returns
    -------
    e : float
        (L/q)^2/(pi b^2 D/q); 1 for the elliptic loading of a planar wing. [-]

    Raises
    ------
    ValueError
        If the drag area is not positive: without lift the efficiency means nothing.

    References
    ----------
    Thesis [3.22] (there e is Oswald's); L. Prandtl, NACA Report 116, 1921.

    Examples
    --------
    >>> round(span_efficiency(1.0, 1.0 / (np.pi * 4.0), 2.0), 12)
    1.0
    """
    if not drag_area > 0.0:
        raise ValueError(f"induced drag area must be > 0 [m^2] for an efficiency, got {drag_area:g}")
    return lift_area**2 / (np.pi * span**2 * drag_area)
