"""From the geometry of an aircraft to the vortex lattice and its coefficients.

`aero` and `aircraft` do not know each other; this is where they meet.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from aeroservo.aero.airfoil import mean_line
from aeroservo.aero.airfoil_files import airfoil
from aeroservo.aero.coefficients import AeroCoefficients, Reference
from aeroservo.aero.trefftz import InducedDrag, induced_drag, span_efficiency
from aeroservo.aero.vlm import Hinge, Lattice, VortexLattice, lattice, lattice_surface
from aeroservo.aero.vlm_loads import LatticeDerivatives, lattice_derivatives
from aeroservo.aero.vlm_normalwash import (
    Normalwash,
    control_normalwash,
    join_normalwash,
    mean_slope,
    panel_cells,
    rigid_normalwash,
    slope_normalwash,
)
from aeroservo.aero.vlm_solve import LatticeSolution, solve_lattice
from aeroservo.aircraft.geometry import ControlSurface, LiftingSurface, ReferenceQuantities

#: Ending of the name of a control's antisymmetric column.
ANTISYMMETRIC = "_antisymmetric"
#: Panels where nothing else is asked for.
DEFAULT = VortexLattice()


@dataclass(frozen=True, kw_only=True, eq=False)
class AircraftLattice:
    """An aircraft's lattice, solved for every input; see `aircraft_lattice`.

    The inputs are ``steady`` (camber and twist, amount 1), ``alpha``, ``beta``, ``p``, ``q``, ``r``, and for each
    control its name (both sides down) and, with an antisymmetric share, its name with ``_antisymmetric``.
    """

    solution: LatticeSolution  # circulations
    derivatives: LatticeDerivatives  # coefficients per unit of each input
    drag: InducedDrag  # quadratic form over the inputs
    controls: tuple[str, ...]  # names of the symmetric control inputs

    @property
    def reference(self) -> Reference:
        """What the coefficients refer to."""
        return self.derivatives.reference


def aircraft_lattice(
    surfaces: Sequence[LiftingSurface],
    reference: ReferenceQuantities,
    *,
    method: VortexLattice = DEFAULT,
    full: bool = False,
) -> AircraftLattice:
    """Lattice of an aircraft, solved for camber and twist, angles, rates and every control at once.

    Parameters
    ----------
    surfaces : sequence of LiftingSurface
        The lifting surfaces.
    reference : ReferenceQuantities
        Area, chord, span, and the point of moments and of turning.
    method : VortexLattice
        Panels, spacing, Mach number.
    full : bool
        Panels on both halves even where symmetry would do.

    Returns
    -------
    AircraftLattice
        Solution, derivatives, induced drag.

    Raises
    ------
    ValueError
        If an airfoil is unknown or there are too few strips for the sections and controls.

    References
    ----------
    J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 12.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> model = read("thesis-uav")
    >>> found = aircraft_lattice(model.surfaces(), model.references())
    >>> round(found.derivatives.of("CL", "alpha"), 1)
    3.6
    """
    parts = [
        lattice_surface(
            s.name,
            s.leading_edge,
            s.chords,
            hinges=[hinge_of(c) for c in s.controls],
            options=method,
            mirrored=s.mirrored,
        )
        for s in surfaces
    ]
    grid = lattice(parts, full=full)
    point = (reference.x, reference.y, reference.z)
    ref = Reference(S=reference.S, c=reference.c, b=reference.b, point=point)
    columns = [slope_normalwash(grid, "steady", steady_slope(grid, surfaces)), rigid_normalwash(grid, point)]
    controls = []
    for surface in surfaces:
        for control in surface.controls:
            columns += control_columns(grid, surface, control)
            controls += [control.name] if control.symmetric != 0.0 else []
    solution = solve_lattice(grid, join_normalwash(columns), mach=method.mach)
    return AircraftLattice(
        solution=solution,
        derivatives=lattice_derivatives(solution, ref),
        drag=induced_drag(solution),
        controls=tuple(controls),
    )


def lattice_coefficients(found: AircraftLattice) -> AeroCoefficients:
    """Longitudinal coefficients of a solved lattice.

    Parameters
    ----------
    found : AircraftLattice
        The lattice.

    Returns
    -------
    AeroCoefficients
        Without friction drag (CD0 is None); the span efficiency is that of the loading due to angle of attack.

    References
    ----------
    Bramstång 2015, thesis [3.5].

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> model = read("thesis-uav")
    >>> lattice_coefficients(aircraft_lattice(model.surfaces(), model.references())).rates
    'c/(2V)'
    """
    d, names = found.derivatives, found.derivatives.names
    i = names.index("alpha")
    lift = d.CL[i] * d.reference.S
    return AeroCoefficients(
        reference=d.reference,
        CL0=d.of("CL", "steady"),
        CM0=d.of("CM", "steady"),
        CL_alpha=d.of("CL", "alpha"),
        CM_alpha=d.of("CM", "alpha"),
        CL_q=d.of("CL", "q"),
        CM_q=d.of("CM", "q"),
        controls=found.controls,
        CL_delta=[d.of("CL", name) for name in found.controls],
        CM_delta=[d.of("CM", name) for name in found.controls],
        span_efficiency=span_efficiency(lift, float(found.drag.matrix[i, i]), d.reference.b),
        source=f"vortex lattice, {len(found.solution.lattice)} panels, Mach {d.mach:g}",
    )


def hinge_of(control: ControlSurface) -> Hinge:
    """Hinge line of a control as the lattice takes it.

    Parameters
    ----------
    control : ControlSurface
        The control.

    Returns
    -------
    Hinge
        The same line.

    References
    ----------
    Project convention: aircraft.geometry, `ControlSurface`.

    Examples
    --------
    >>> c = ControlSurface(name="e", span_from=0.5, span_to=1.0, hinge_from=0.75, hinge_to=0.7)
    >>> hinge_of(c).chord_to
    0.7
    """
    return Hinge(
        span_from=control.span_from, span_to=control.span_to, chord_from=control.hinge_from, chord_to=control.hinge_to
    )


def control_columns(grid: Lattice, surface: LiftingSurface, control: ControlSurface) -> list[Normalwash]:
    """Symmetric and antisymmetric columns of a control, as far as its mixing has them.

    Parameters
    ----------
    grid : Lattice
        The panels.
    surface : LiftingSurface
        The surface that carries the control.
    control : ControlSurface
        The control.

    Returns
    -------
    columns : list of Normalwash
        Up to two; a surface without a twin has one.

    References
    ----------
    Project convention: aircraft.geometry, `ControlSurface`, mixing.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> wing = read("thesis-uav").surfaces()[0]
    >>> grid = lattice([lattice_surface("wing", wing.leading_edge, wing.chords, hinges=[hinge_of(wing.controls[0])])])
    >>> [c.names[0] for c in control_columns(grid, wing, wing.controls[0])]
    ['elevon', 'elevon_antisymmetric']
    """
    out = []
    for parity, gain in ((1, control.symmetric), (-1, control.antisymmetric)):
        if gain == 0.0 or (parity < 0 and not surface.mirrored):
            continue
        out.append(
            control_normalwash(
                grid,
                control.name + (ANTISYMMETRIC if parity < 0 else ""),
                surface.name,
                hinge_of(control),
                kind=control.kind,
                reading=control.reading,
                parity=parity,
                gain=gain,
            )
        )
    return out


def steady_slope(grid: Lattice, surfaces: Sequence[LiftingSurface]) -> np.ndarray:
    """Slope of the mean line less the twist at every control point.

    Parameters
    ----------
    grid : Lattice
        The panels.
    surfaces : sequence of LiftingSurface
        The surfaces in the lattice's order.

    Returns
    -------
    slope : ndarray, shape (n,)
        dz/dx, the mean over each panel's stretch of the chord; airfoils and twist linear between sections. [-]

    Raises
    ------
    ValueError
        If an airfoil is unknown.

    References
    ----------
    J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 5.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> wing = read("thesis-uav").surfaces()[0]
    >>> grid = lattice([lattice_surface("wing", wing.leading_edge, wing.chords)])
    >>> bool(steady_slope(grid, [wing])[-1] > np.radians(4.0))  # washout at the tip
    True
    """
    out = np.zeros(len(grid))
    low, high = panel_cells(grid)
    for index, surface in enumerate(surfaces):
        steps = np.hypot(*np.diff(surface.leading_edge[:, 1:], axis=0).T)
        station = np.concatenate([[0.0], np.cumsum(steps)]) / steps.sum()
        mine = grid.strip_surface[grid.strip] == index
        span = grid.strip_span[grid.strip][mine]
        slope = -np.interp(span, station, surface.twists)
        for k, section in enumerate(surface.sections):
            if section.airfoil != "flat":
                share = np.interp(span, station, np.eye(len(station))[k])
                foil = airfoil(section.airfoil)
                slope = slope + share * mean_slope(lambda x, f=foil: mean_line(f, x)[1], low[mine], high[mine])  # type: ignore[misc]
        out[mine] = slope
    return out
