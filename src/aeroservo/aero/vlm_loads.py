"""Vortex lattice: forces, moments, span loading, hinge moments and derivatives of a solution.

Everything is linear in the inputs: the force on a bound vortex is rho V Gamma e_x x (b - a), so no force along x
appears here (induced drag: `trefftz`). Forces over the dynamic pressure are areas, moments are volumes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from aeroservo.aero.coefficients import Reference
from aeroservo.aero.vlm import Hinge, Lattice
from aeroservo.aero.vlm_solve import LatticeSolution


@dataclass(frozen=True, kw_only=True, eq=False)
class LatticeLoads:
    """Force and moment over dynamic pressure per unit of each input, geometry axes."""

    names: tuple[str, ...]  # names of the inputs
    point: np.ndarray  # (3,) [m] point of the moments
    force: np.ndarray  # (m, 3) [m^2]
    moment: np.ndarray  # (m, 3) [m^3]


@dataclass(frozen=True, kw_only=True, eq=False)
class SpanLoading:
    """Loading of the strips per unit of each input; see `span_loading`."""

    names: tuple[str, ...]  # names of the inputs
    y: np.ndarray  # (n_strips,) [m] control stations
    z: np.ndarray  # (n_strips,) [m]
    chord: np.ndarray  # (n_strips,) [m]
    width: np.ndarray  # (n_strips,) [m] in the y-z plane
    cl: np.ndarray  # (n_strips, m) [-] section lift coefficient on the local chord
    cm_quarter: np.ndarray  # (n_strips, m) [-] section moment about the local quarter chord
    circulation: np.ndarray  # (n_strips, m) [m] over airspeed
    surface: np.ndarray  # (n_strips,) index of the surface
    side: np.ndarray  # (n_strips,) +1 or -1


@dataclass(frozen=True, kw_only=True, eq=False)
class LatticeDerivatives:
    """Coefficients per unit input; rates per p b/(2V), q c/(2V), r b/(2V). See `lattice_derivatives`."""

    names: tuple[str, ...]  # names of the inputs
    reference: Reference  # what the coefficients refer to
    CL: np.ndarray  # (m,) [1/rad] lift
    CY: np.ndarray  # (m,) [1/rad] side force, to starboard
    Cl: np.ndarray  # (m,) [1/rad] rolling moment, starboard wing down
    CM: np.ndarray  # (m,) [1/rad] pitching moment, nose up
    Cn: np.ndarray  # (m,) [1/rad] yawing moment, nose to starboard
    mach: float  # [-] Mach number of the solution

    def of(self, coefficient: str, name: str) -> float:
        """One derivative.

        Parameters
        ----------
        coefficient : {"CL", "CY", "Cl", "CM", "Cn"}
            Name of the coefficient.
        name : str
            Name of the input.

        Returns
        -------
        derivative : float
            Per unit of the input. [1/rad]

        Raises
        ------
        ValueError
            If there is no such coefficient or input.

        References
        ----------
        Project convention: contract.md, "Other JSON", command `aero`.

        Examples
        --------
        >>> ref = Reference(S=1.0, c=1.0, b=1.0)
        >>> one = np.ones(1)
        >>> d = LatticeDerivatives(names=("q",), reference=ref, CL=one, CY=one, Cl=one, CM=one, Cn=one, mach=0.0)
        >>> d.of("CM", "q")
        1.0
        """
        if name not in self.names:
            raise ValueError(f"no input {name!r}; there are {', '.join(self.names)}")
        if coefficient not in ("CL", "CY", "Cl", "CM", "Cn"):
            raise ValueError(f"no coefficient {coefficient!r}; there are CL, CY, Cl, CM, Cn")
        return float(getattr(self, coefficient)[self.names.index(name)])

    @property
    def neutral_point(self) -> float:
        """Position x of the neutral point [m]: where CM_alpha vanishes."""
        return self.reference.x - self.reference.c * self.of("CM", "alpha") / self.of("CL", "alpha")

    def static_margin(self, x_cg: float | np.ndarray) -> float | np.ndarray:
        """Static margin (x_np - x_cg)/c for centres of gravity (...) [m], positive when stable [-]."""
        return (self.neutral_point - x_cg) / self.reference.c


def panel_forces(solution: LatticeSolution) -> tuple[np.ndarray, np.ndarray]:
    """Force on every panel over dynamic pressure, and where it acts.

    Parameters
    ----------
    solution : LatticeSolution
        Circulations.

    Returns
    -------
    force : ndarray, shape (n, m, 3)
        2 Gamma/V e_x x (b - a). [m^2]
    position : ndarray, shape (n, 3)
        Middle of the bound vortex. [m]

    References
    ----------
    Kutta-Joukowsky; J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 12.

    Examples
    --------
    >>> from aeroservo.aero.vlm import lattice, lattice_surface
    >>> from aeroservo.aero.vlm_normalwash import rigid_normalwash
    >>> from aeroservo.aero.vlm_solve import solve_lattice
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1])])
    >>> panel_forces(solve_lattice(grid, rigid_normalwash(grid, [0, 0, 0])))[0].shape
    (192, 5, 3)
    """
    grid = solution.lattice
    along = grid.b - grid.a
    direction = np.stack([np.zeros(len(grid)), -along[:, 2], along[:, 1]], axis=-1)
    return 2.0 * solution.gamma[:, :, None] * direction[:, None, :], (grid.a + grid.b) / 2.0


def lattice_loads(solution: LatticeSolution, point: Sequence[float] | np.ndarray) -> LatticeLoads:
    """Total force and moment of the whole aircraft about any point.

    Parameters
    ----------
    solution : LatticeSolution
        Circulations.
    point : array_like, shape (3,)
        Point of the moments; on the plane y = 0 for a half lattice. [m]

    Returns
    -------
    LatticeLoads
        In geometry axes: force (x aft, y to starboard, z up), moment by the right-hand rule about them.

    Raises
    ------
    ValueError
        If a half lattice is asked for moments about a point beside its plane.

    References
    ----------
    J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 12; the image half doubles what its parity allows.

    Examples
    --------
    >>> from aeroservo.aero.vlm import lattice, lattice_surface
    >>> from aeroservo.aero.vlm_normalwash import rigid_normalwash
    >>> from aeroservo.aero.vlm_solve import solve_lattice
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1])])
    >>> loads = lattice_loads(solve_lattice(grid, rigid_normalwash(grid, [0, 0, 0])), [0.25, 0, 0])
    >>> bool(loads.force[0, 2] > 0), bool(loads.moment[2, 0] > 0)
    (True, True)
    """
    point = np.asarray(point, dtype=float)
    force, position = panel_forces(solution)
    moment = np.cross((position - point)[:, None, :], force)
    force, moment = force.sum(axis=0), moment.sum(axis=0)
    if solution.lattice.mirrored:
        if abs(point[1]) > 1e-12:
            raise ValueError(
                f"a half lattice gives moments about points on y = 0 only, got y = {point[1]:g} m; use full=True"
            )
        even = solution.normalwash.parity[:, None] > 0
        force = 2.0 * np.where(even, force * [1.0, 0.0, 1.0], force * [0.0, 1.0, 0.0])
        moment = 2.0 * np.where(even, moment * [0.0, 1.0, 0.0], moment * [1.0, 0.0, 1.0])
    return LatticeLoads(names=solution.names, point=point, force=force, moment=moment)


def lattice_derivatives(solution: LatticeSolution, reference: Reference) -> LatticeDerivatives:
    """Stability and control derivatives, exact for the linear solution.

    Parameters
    ----------
    solution : LatticeSolution
        Circulations; columns named ``p``, ``q``, ``r`` are taken as rates over airspeed [rad/m].
    reference : Reference
        Area, chord, span and moment point.

    Returns
    -------
    LatticeDerivatives
        Per radian; rates per p b/(2V), q c/(2V), r b/(2V). The rates turn about the point given to
        `rigid_normalwash`. CY, Cl and Cn due to the steady lift (Cl_beta of a swept wing, Cl_r, Cn_p) are of
        second order and not here.

    References
    ----------
    Bramstång 2015, thesis [3.5], [5.24-5.27].

    Examples
    --------
    >>> from aeroservo.aero.vlm import lattice, lattice_surface
    >>> from aeroservo.aero.vlm_normalwash import rigid_normalwash
    >>> from aeroservo.aero.vlm_solve import solve_lattice
    >>> ref = Reference(S=20.0, c=1.0, b=20.0, point=(0.25, 0.0, 0.0))
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 10, 0]], [1, 1])])
    >>> d = lattice_derivatives(solve_lattice(grid, rigid_normalwash(grid, ref.point)), ref)
    >>> round(d.of("CL", "alpha"), 1), d.of("Cl", "p") < 0
    (5.4, True)
    """
    loads = lattice_loads(solution, reference.point)
    scale = np.ones(len(loads.names))
    for name, length in (("p", reference.b), ("q", reference.c), ("r", reference.b)):
        if name in loads.names:
            scale[loads.names.index(name)] = 2.0 / length
    force = loads.force * (scale / reference.S)[:, None]
    moment = loads.moment * (scale / reference.S)[:, None]
    return LatticeDerivatives(
        names=loads.names,
        reference=reference,
        CL=force[:, 2],
        CY=force[:, 1],
        Cl=-moment[:, 0] / reference.b,
        CM=moment[:, 1] / reference.c,
        Cn=-moment[:, 2] / reference.b,
        mach=solution.mach,
    )


def span_loading(solution: LatticeSolution) -> SpanLoading:
    """Section lift and moment along the span, per unit of each input.

    Parameters
    ----------
    solution : LatticeSolution
        Circulations.

    Returns
    -------
    SpanLoading
        Strips in the lattice's order.

    References
    ----------
    J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, section 3.11 per strip: c_l = 2 Gamma/(V c).

    Examples
    --------
    >>> from aeroservo.aero.vlm import lattice, lattice_surface
    >>> from aeroservo.aero.vlm_normalwash import rigid_normalwash
    >>> from aeroservo.aero.vlm_solve import solve_lattice
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1])])
    >>> loading = span_loading(solve_lattice(grid, rigid_normalwash(grid, [0, 0, 0])))
    >>> bool(loading.cl[0, 0] > loading.cl[-1, 0])
    True
    """
    grid = solution.lattice
    circulation = strip_circulation(solution)
    front, rear = grid.fraction.T
    arm = (front + 0.25 * (rear - front) - 0.25)[:, None] * solution.gamma
    first_moment = np.zeros_like(circulation)
    np.add.at(first_moment, grid.strip, arm)
    chord = grid.strip_chord[:, None]
    return SpanLoading(
        names=solution.names,
        y=grid.strip_edge[:, 1],
        z=grid.strip_edge[:, 2],
        chord=grid.strip_chord,
        width=grid.strip_width,
        cl=2.0 * circulation / chord,
        cm_quarter=-2.0 * first_moment / chord,
        circulation=circulation,
        surface=grid.strip_surface,
        side=grid.strip_side,
    )


def strip_circulation(solution: LatticeSolution) -> np.ndarray:
    """Circulation of the strips: the sum over their panels.

    Parameters
    ----------
    solution : LatticeSolution
        Circulations.

    Returns
    -------
    circulation : ndarray, shape (n_strips, m)
        Over airspeed. [m]

    References
    ----------
    J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 2 (Helmholtz' theorems).

    Examples
    --------
    >>> from aeroservo.aero.vlm import lattice, lattice_surface
    >>> from aeroservo.aero.vlm_normalwash import rigid_normalwash
    >>> from aeroservo.aero.vlm_solve import solve_lattice
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1])])
    >>> strip_circulation(solve_lattice(grid, rigid_normalwash(grid, [0, 0, 0]))).shape
    (24, 5)
    """
    out = np.zeros((len(solution.lattice.strip_chord), solution.gamma.shape[1]))
    np.add.at(out, solution.lattice.strip, solution.gamma)
    return out


def hinge_moments(solution: LatticeSolution, surface: str, hinge: Hinge) -> tuple[np.ndarray, float, float]:
    """Hinge moment of the starboard control, per unit of each input.

    Parameters
    ----------
    solution : LatticeSolution
        Circulations; the panels should have an edge on the hinge, as `lattice_surface` gives them.
    surface : str
        Name of the surface that carries the control.
    hinge : Hinge
        Hinge line.

    Returns
    -------
    coefficient : ndarray, shape (m,)
        Moment about the hinge over dynamic pressure, control area and control chord, positive trailing edge down:
        a control that floats up with the wind has a negative coefficient. [-]
    area, chord : float
        Area behind the hinge of one control [m^2] and its mean chord normal to the hinge. [m]

    Raises
    ------
    ValueError
        If no panel lies behind the hinge.

    References
    ----------
    H. Glauert, ARC Reports and Memoranda no. 1095, 1927 (the two-dimensional limit).

    Examples
    --------
    >>> from aeroservo.aero.vlm import lattice, lattice_surface
    >>> from aeroservo.aero.vlm_normalwash import rigid_normalwash
    >>> from aeroservo.aero.vlm_solve import solve_lattice
    >>> flap = Hinge(span_from=0.5, span_to=1.0, chord_from=0.75, chord_to=0.75)
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1], hinges=[flap])])
    >>> c, area, chord = hinge_moments(solve_lattice(grid, rigid_normalwash(grid, [0, 0, 0])), "w", flap)
    >>> bool(c[0] < 0), area, chord
    (True, 0.25, 0.25)
    """
    grid = solution.lattice
    if surface not in grid.surfaces:
        raise ValueError(f"the lattice has no surface {surface!r}; it has {', '.join(grid.surfaces)}")
    mine = (grid.strip_surface == grid.surfaces.index(surface)) & (grid.strip_side > 0)
    at = np.where(mine, hinge.at(grid.strip_span), np.nan)
    aft = grid.fraction[:, 0] >= at[grid.strip] - 1e-9
    if not np.any(aft):
        raise ValueError(
            f"no panel of {surface!r} lies behind the hinge at {hinge.chord_from:g} of the chord: use more panels"
        )
    strips = np.flatnonzero(np.isfinite(at))
    line = grid.strip_edge[strips, 0] + at[strips] * grid.strip_chord[strips]
    station = grid.strip_edge[strips, 1:]
    length = np.hypot(*(station - station[0]).T)
    slope = np.polyfit(length, line, 1)[0] if len(strips) > 1 else _hinge_slope(grid, strips[0], at[strips[0]])
    cosine = 1.0 / np.hypot(1.0, slope)
    force, _ = panel_forces(solution)
    normal_force = np.einsum("nmi,ni->nm", force, grid.normal)
    chosen = np.flatnonzero(aft)
    # the arm in the strip's own section: the bound vortex and the hinge at one span station
    fraction = grid.fraction[chosen, 0] + 0.25 * (grid.fraction[chosen, 1] - grid.fraction[chosen, 0])
    strip = grid.strip[chosen]
    arm = (fraction - at[strip]) * grid.strip_mean_chord[strip] * cosine
    moment = -np.sum(normal_force[chosen] * arm[:, None], axis=0)
    width = grid.strip_width[strips]
    area = float(np.sum((1.0 - at[strips]) * grid.strip_mean_chord[strips] * width))
    chord = area / float(width.sum()) * float(cosine)
    return moment / (area * chord), area, chord


def _hinge_slope(grid: Lattice, strip: int, at: float) -> float:
    """Slope dx/ds of a hinge that lies in one strip."""
    panel = np.flatnonzero(grid.strip == strip)
    along = grid.b[panel] - grid.a[panel]
    slopes = along[:, 0] / np.hypot(along[:, 1], along[:, 2])
    front, rear = grid.fraction[panel].T
    return float(np.interp(at, front + 0.25 * (rear - front), slopes))
