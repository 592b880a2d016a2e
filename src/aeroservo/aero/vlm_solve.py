"""Vortex lattice: influence matrix, and one solve for all right-hand sides. Circulations are per unit airspeed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from aeroservo.aero.vlm import Lattice
from aeroservo.aero.vlm_kernels import columns, normal_influence
from aeroservo.aero.vlm_normalwash import Normalwash


@dataclass(frozen=True, kw_only=True, eq=False)
class LatticeSolution:
    """Circulation of every panel per unit of every input; see `solve_lattice`."""

    lattice: Lattice  # the panels
    normalwash: Normalwash  # the right-hand sides
    gamma: np.ndarray  # (n, m) [m] circulation over airspeed
    mach: float  # [-] Mach number

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the inputs."""
        return self.normalwash.names


def normal_velocity(lattice: Lattice, *, mach: float = 0.0, image: bool = False) -> np.ndarray:
    """Influence matrix: normal velocity at the control points for unit circulations.

    Parameters
    ----------
    lattice : Lattice
        The panels.
    mach : float
        Mach number in [0, 1); x is stretched by 1/sqrt(1 - Mach^2). [-]
    image : bool
        The influence of the panels' mirror images instead of their own (symmetric circulation).

    Returns
    -------
    A : ndarray, shape (n, n)
        Row: control point; column: vortex. [1/m]

    Raises
    ------
    ValueError
        If mach lies outside [0, 1).

    References
    ----------
    M. Drela, Flight Vehicle Aerodynamics, 2014, section 6.5; Goethert's rule as in S. Hedman, FFA Report 105, 1965.

    Examples
    --------
    >>> from aeroservo.aero.vlm import VortexLattice, lattice, lattice_surface
    >>> one = VortexLattice(chordwise=1, spanwise=1)
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 2000, 0]], [1, 1], options=one)])
    >>> round(float(normal_velocity(grid)[0, 0]) * np.pi, 2)  # two dimensions: -1/(2 pi c/2)
    -1.0
    """
    if not 0.0 <= mach < 1.0:
        raise ValueError(f"mach must lie in [0, 1): the Prandtl-Glauert rule is subsonic, got {mach:g}")
    stretch = np.array([1.0 / np.sqrt(1.0 - mach**2), 1.0, 1.0])
    side = np.array([1.0, -1.0 if image else 1.0, 1.0])
    px, py, pz = columns(lattice.control * stretch * side)
    _, ny, nz = columns(lattice.normal * side)
    out = np.zeros((len(lattice), len(lattice)))
    normal_influence(  # type: ignore[call-arg]
        px, py, pz, ny, nz, *columns(lattice.a * stretch), *columns(lattice.b * stretch), lattice.core**2, out
    )
    return out


def solve_lattice(lattice: Lattice, normalwash: Normalwash, *, mach: float = 0.0) -> LatticeSolution:
    """Circulations of all columns from one influence matrix.

    Parameters
    ----------
    lattice : Lattice
        The panels; for a half lattice the columns are split by parity into two systems of half the size.
    normalwash : Normalwash
        All right-hand sides.
    mach : float
        Mach number in [0, 1). [-]

    Returns
    -------
    LatticeSolution
        Circulation per unit of each input.

    Raises
    ------
    ValueError
        If shapes differ or mach lies outside [0, 1).

    References
    ----------
    J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 12.

    Examples
    --------
    >>> from aeroservo.aero.vlm import VortexLattice, lattice, lattice_surface
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1])])
    >>> from aeroservo.aero.vlm_normalwash import rigid_normalwash
    >>> solve_lattice(grid, rigid_normalwash(grid, [0, 0, 0])).gamma.shape
    (192, 5)
    """
    if normalwash.values.shape[0] != len(lattice):
        raise ValueError(f"normalwash has {normalwash.values.shape[0]} rows, the lattice {len(lattice)} panels")
    direct = normal_velocity(lattice, mach=mach)
    gamma = np.empty_like(normalwash.values)
    if not lattice.mirrored:
        gamma[:] = _solve(direct, -normalwash.values)
    else:
        image = normal_velocity(lattice, mach=mach, image=True)
        for sign in (1, -1):
            chosen = normalwash.parity == sign
            if np.any(chosen):
                gamma[:, chosen] = _solve(direct + sign * image, -normalwash.values[:, chosen])
    gamma.flags.writeable = False
    return LatticeSolution(lattice=lattice, normalwash=normalwash, gamma=gamma, mach=mach)


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve in place: the transpose of a C-ordered matrix is what LAPACK wants, so nothing is copied."""
    factors = lu_factor(matrix.T, overwrite_a=True, check_finite=False)
    return lu_solve(factors, right, trans=1, check_finite=False)
