"""The elastic wing of an aircraft file: a beam along the flexural axis, strips with the lattice's span loading.

What is taken from where. Bending and torsion stiffness are those of the sections normal to the flexural axis, as the
file has them. Mass, mass axis and inertia are given per metre of span on the streamwise chord; a point d aft of the
axis along the stream lies d cos(Lambda) aft of it along the normal, so with ds the length of the axis and dy that of
the span: mass m dy/ds, offset d cos(Lambda), inertia I cos^2(Lambda) dy/ds. No mass and no static moment is lost.

A strip of axis ds at sweep Lambda has the chord c cos(Lambda) (its area is c dy), and meets the flow V cos(Lambda),
in which an incidence alpha of the whole wing is alpha/cos(Lambda). Its lift is the streamwise section's, so

    q cos^2(Lambda) (c cos(Lambda)) a_w alpha/cos(Lambda) ds = q c c_l ds cos(Lambda)   =>   a_w = c_l_alpha/cos(Lambda)

and for a control, whose derivatives act on V cos(Lambda) as they are, a_c = c_l_delta/cos^2(Lambda); the moment
about the axis is cos(Lambda) times the moment about the streamwise section's point on it, hence
b_c = c_m_delta/cos^2(Lambda) about that point. All c_l and c_m are the lattice's at zero frequency and its own Mach
number, at each place of the span, with every surface of the file in the flow; beside a control too, where it
induces lift. Camber and twist come in the same way as an incidence and a moment of each section.

Lift, and torque about the axis, are those of the lattice at every place; the rolling moment is not exactly: a normal
section carries its load on its own chord, which on a swept wing leaves the streamwise one (an aileron of `thesis-uav`
rolls 2.6 % less than in the lattice).

Slopes are those of a uniform incidence, but those of the wing in roll, c_l_p/(cos(Lambda) y), where the root is free
and the motion antisymmetric (a third less, for `thesis-uav`), and in all that is about roll of a clamped half wing.

What the strips do not have from the lattice: the aerodynamic centre is at the quarter chord everywhere; of dihedral
only the developed length is kept. Loadings keep their shape as the wing deforms, which is good for aspect ratios above
five or so; below, `flutter` and `static` from strips are a first estimate.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import PchipInterpolator

from aeroservo.aero.strip import StripControl, Strips
from aeroservo.aero.vlm import VortexLattice
from aeroservo.aero.vlm_loads import span_loading
from aeroservo.aeroelastic.aircraft_axis import FlexuralAxis, carrier, structure_of
from aeroservo.aeroelastic.aircraft_lattice import ANTISYMMETRIC, DEFAULT, aircraft_lattice
from aeroservo.aeroelastic.build_beam import StripWing
from aeroservo.aeroelastic.material import material
from aeroservo.aeroelastic.wing_servo import PlacedSensor
from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.aircraft.geometry import span_stations
from aeroservo.aircraft.schema_servo import AircraftSensor
from aeroservo.datatypes import Array
from aeroservo.structure.beam_axis import BeamMass, SlenderBeam

#: Change of dy/ds at a corner of the axis above which a station just inboard of it keeps the mass of both panels.
CORNER = 1e-3
#: Where that station lies: this part of the panel inboard of the corner.
INBOARD = 0.01
_MOTIONS = ("alpha", "steady", "p")


@dataclass(frozen=True, kw_only=True, eq=False)
class SectionLoading:
    """Loading of one surface's starboard half by strips of the lattice, per unit of each input.

    Attributes
    ----------
    names : tuple of str
        Inputs: "alpha", "steady" (camber and twist), "p" (rate of roll over airspeed, starboard wing down; may be
        left out), and the controls. [rad, -, rad/m]
    edges : ndarray, shape (n + 1,)
        Edges of the strips, fractions of the developed span. [-]
    lift : ndarray, shape (n, n_inputs)
        c c_l: section lift per length of span and dynamic pressure. [m]
    moment : ndarray, shape (n, n_inputs)
        c^2 c_m about the quarter chord of the streamwise section, nose up. [m^2]
    breaks : tuple of float
        Fractions of the span at which the loading may jump: sections and ends of controls. [-]
    """

    names: tuple[str, ...]
    edges: Array
    lift: Array
    moment: Array
    breaks: tuple[float, ...] = ()

    def at(self, fraction: Array) -> tuple[Array, Array]:
        """Lift [m] and moment [m^2] at fractions of the span, shape (n_points, n_inputs) each.

        Slopes of the monotone cubic through the running integral, between one break and the next: what the strips
        carry is what the curve carries.
        """
        fraction = np.asarray(fraction, dtype=float)
        both = np.concatenate([self.lift, self.moment], axis=1)
        out = np.zeros((len(fraction), both.shape[1]))
        ends = np.unique([0, *(int(np.argmin(np.abs(self.edges - x))) for x in self.breaks), len(self.lift)])
        for first, last in pairwise(ends):
            edges = self.edges[first : last + 1]
            running = np.cumsum(both[first:last] * np.diff(edges)[:, None], axis=0)
            curve = PchipInterpolator(edges, np.concatenate([np.zeros((1, both.shape[1])), running])).derivative()
            low = -np.inf if first == 0 else edges[0]
            high = np.inf if last == len(self.lift) else edges[-1]
            here = (fraction >= low) & (fraction < high)
            out[here] = curve(np.clip(fraction[here], edges[0], edges[-1]))
        return out[:, : len(self.names)], out[:, len(self.names) :]


def section_loading(model: AircraftFile, method: VortexLattice = DEFAULT) -> SectionLoading:
    """Span loading of the surface that carries the beam, from the lattice of the whole aircraft.

    Parameters
    ----------
    model : AircraftFile
        With `[structure]`.
    method : VortexLattice
        Panels and Mach number.

    Returns
    -------
    loading : SectionLoading
        Per radian of incidence and of every control of that surface, of camber and twist, and of roll. [SI]

    Raises
    ------
    ValueError
        If the file has no structure, or an airfoil is unknown.

    References
    ----------
    J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 12; issue 4, item 7.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> section_loading(read("thesis-uav")).names
    ('alpha', 'steady', 'p', 'elevon', 'elevon_antisymmetric')
    """
    surface = carrier(model)
    found = aircraft_lattice(model.surfaces(), model.references(), method=method)
    loads = span_loading(found.solution)
    index = found.solution.lattice.surfaces.index(surface.name)
    mine = (loads.surface == index) & (loads.side > 0)
    own = [c.name + ending for c in surface.controls for ending in ("", ANTISYMMETRIC)]
    names = ("alpha", "steady", "p", *(name for name in own if name in loads.names))
    columns = [loads.names.index(name) for name in names]
    chord, width = loads.chord[mine, None], loads.width[mine]
    stations = span_stations(surface)
    ends = [x for c in surface.controls for x in (c.span_from, c.span_to)]
    return SectionLoading(
        names=names,
        edges=np.concatenate([[0.0], np.cumsum(width)]) / width.sum(),
        lift=chord * loads.cl[np.ix_(mine, columns)],
        moment=chord**2 * loads.cm_quarter[np.ix_(mine, columns)],
        breaks=(*(stations / stations[-1]).tolist(), *ends),
    )


def aircraft_wing(model: AircraftFile, loading: SectionLoading | None = None) -> StripWing:
    """Beam and strips of the surface that carries the structure.

    Parameters
    ----------
    model : AircraftFile
        With `[structure]`; its damping is not applied here.
    loading : SectionLoading, optional
        Of the surface's sections; default the lattice's, `section_loading`.

    Returns
    -------
    wing : StripWing
        For `beam_model`. Controls of a clamped half wing act both ways, antisymmetrically first (so that reversal is
        of roll by ailerons); those of a free one as its motion does. [SI]

    Raises
    ------
    ValueError
        If the file has no structure, the surface does not run outboard, or the lattice's lift slope is negative
        somewhere.

    References
    ----------
    Bramstång 2015, section 7.7; NACA Report 1014 (swept strips); issue 4, item 7.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> round(aircraft_wing(read("thesis-uav")).beam.length, 4)  # 1 m of span, swept by 19.4 degrees
    1.0599
    """
    axis = FlexuralAxis.of(model)
    loading = section_loading(model) if loading is None else loading
    surface, root = carrier(model), structure_of(model)
    chosen = [
        name
        for name in sorted(loading.names, key=lambda name: not name.endswith(ANTISYMMETRIC))
        if name not in _MOTIONS
        and (root.root == "clamped" or name.endswith(ANTISYMMETRIC) == (root.symmetry == "antisymmetric"))
    ]
    both = root.root == "clamped" and "p" in loading.names and any(name.endswith(ANTISYMMETRIC) for name in chosen)
    rolls = root.root == "free" and root.symmetry == "antisymmetric"
    ends = [x for c in surface.controls for x in (c.span_from, c.span_to) if 0.0 < x < 1.0]
    return StripWing(
        name=model.name,
        beam=_beam(model, axis),
        strips=lambda s, width: _strips(axis, loading, chosen, s, width, rolls=rolls),
        breaks=tuple(np.interp(np.array(ends) * axis.r[-1], axis.r, axis.s).tolist()),
        rolling=(lambda s, width: _strips(axis, loading, chosen, s, width, rolls=True)) if both else None,
        sensors=tuple(
            PlacedSensor(sensor=x, y=y, aft=aft) for x in model.sensor for y, aft in [axis.place(x.x_m, x.y_m)]
        ),
    )


def _placed(axis: FlexuralAxis, sensor: AircraftSensor) -> PlacedSensor:
    """A sensor of the file on the beam."""
    along, aft = axis.place(sensor.x_m, sensor.y_m)
    return PlacedSensor(sensor=sensor, y=along, aft=aft)


def _beam(model: AircraftFile, axis: FlexuralAxis) -> SlenderBeam:
    """Stations at the corners of the axis, and just inboard of those where the mass per length jumps."""
    structure = structure_of(model)
    given = [station.y_m for station in structure.station]
    per_length = np.diff(axis.y) / np.diff(axis.s)
    jumps = np.flatnonzero(np.abs(np.diff(per_length)) > CORNER * per_length[1:])
    before = axis.s[jumps + 1] - INBOARD * np.diff(axis.s)[jumps]
    s = np.sort(np.concatenate([axis.s, before]))
    panel, y = axis.panel(s), np.interp(s, axis.s, axis.y)

    def each(field: str) -> Array:
        return np.interp(y, given, [getattr(station, field) for station in structure.station])

    chord = np.interp(y, axis.y, axis.chord)
    factor, cos = per_length[panel], np.cos(axis.sweep[panel])
    return SlenderBeam(
        y=s,
        mass=each("mass_kg_per_m") * factor,
        inertia=each("inertia_kg_m") * factor * cos**2,
        EI=each("EI_N_m2"),
        GJ=each("GJ_N_m2"),
        cg_offset=each("cg_axis") - each("flexural_axis"),
        chord=chord * cos,
        sweep=axis.sweep[panel],
        masses=_lumps(model, axis),
        root=structure.root,
        symmetry=structure.symmetry,
        origin=np.array([axis.x[0], axis.y[0], 0.0]),
        material=material(model.viscoelastic),
    )


def _lumps(model: AircraftFile, axis: FlexuralAxis) -> tuple[BeamMass, ...]:
    """Mass items that are not spread over a surface: on the plane of symmetry half of each at the root."""
    out = []
    symmetric = structure_of(model).symmetry == "symmetric"
    corners = np.stack([axis.x, axis.y], axis=1)
    steps = np.diff(corners, axis=0)
    for item in model.mass:
        if item.spread_over or (item.y_m != 0.0 and not item.mirrored) or item.mass_kg == 0.0:
            continue
        if item.y_m == 0.0:
            # the root turns about y only (symmetric) or about x only, so these are the exact arm and inertia
            cos, share = float(np.cos(axis.sweep[0])), 1.0 if item.mirrored else 0.5
            out.append(
                BeamMass(
                    y=0.0,
                    mass=share * item.mass_kg,
                    x=(item.x_m - float(axis.x[0])) / cos if symmetric else 0.0,
                    inertia=share * item.Iyy_kg_m2 / cos**2 if symmetric else 0.0,
                    roll_inertia=0.0 if symmetric else share * item.Ixx_kg_m2,
                )
            )
            continue
        point = np.array([item.x_m, abs(item.y_m)])
        along = np.clip(np.sum((point - corners[:-1]) * steps, axis=1) / np.sum(steps**2, axis=1), 0.0, 1.0)
        feet = corners[:-1] + along[:, None] * steps
        nearest = int(np.argmin(np.hypot(*(point - feet).T)))
        sweep = axis.sweep[nearest]
        offset = point - feet[nearest]
        out.append(
            BeamMass(
                y=float(axis.s[nearest] + along[nearest] * (axis.s[nearest + 1] - axis.s[nearest])),
                mass=item.mass_kg,
                x=float(offset[0] * np.cos(sweep) - offset[1] * np.sin(sweep)),
                inertia=float(item.Iyy_kg_m2 * np.cos(sweep) ** 2 + item.Ixx_kg_m2 * np.sin(sweep) ** 2),
            )
        )
    return tuple(out)


def _strips(
    axis: FlexuralAxis, loading: SectionLoading, controls: list[str], s: Array, width: Array, *, rolls: bool
) -> Strips:
    """Sections normal to the axis that carry the loading of the streamwise ones."""
    y, sweep = np.interp(s, axis.s, axis.y), axis.sweep[axis.panel(s)]
    chord, flexural = np.interp(y, axis.y, axis.chord), np.interp(y, axis.y, axis.flexural)
    lift, moment = loading.at(np.interp(s, axis.s, axis.r) / axis.r[-1])
    cl, cm, cos = lift / chord[:, None], moment / chord[:, None] ** 2, np.cos(sweep)
    in_roll = cl[:, loading.names.index("p")] / (y * cos) if "p" in loading.names else cl[:, 0] / cos
    slope = in_roll if rolls else cl[:, 0] / cos
    if np.any(slope < 0.0):
        worst = int(np.argmin(slope))
        raise ValueError(
            f"the lattice's lift slope is negative at y = {y[worst]:g} m ({slope[worst]:g} per rad): strips cannot "
            "carry that; is another surface just ahead?"
        )
    lifting = slope > 1e-9 * slope.max()
    incidence = np.divide(cl[:, 1], cos**2 * slope, out=np.zeros(len(s)), where=lifting)
    of_the_angle = np.divide(in_roll, slope, out=np.zeros(len(s)), where=lifting)
    derivatives = []
    for name in controls:
        j = loading.names.index(name)
        about_axis = cm[:, j] + (flexural - 0.25) * cl[:, j]
        derivatives.append(StripControl(name=name, lift=cl[:, j] / cos**2, moment=about_axis / cos**2))
    nothing = np.zeros(len(s))
    return Strips(
        y=y,
        width=width,
        b=0.5 * chord * cos,
        a=2.0 * flexural - 1.0,
        eccentricity=flexural - 0.25,
        lift_slope=slope,
        moment_rate=nothing - 1.2,
        sweep=sweep,
        elevon_lift=nothing,
        elevon_moment=nothing,
        incidence=incidence,
        cm0=cm[:, 1] / cos**2,
        span=float(axis.y[-1]),
        controls=tuple(derivatives),
        roll_angle=of_the_angle * y / axis.y[-1],
    )
