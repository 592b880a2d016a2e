"""Beam wings of model files: modes, strips along them, and a richer basis for statics.

Dynamics need few modes (the p-k method's cost grows with their cube), static deflections many: next to the critical
sweep, where two divergence pressures meet, ten natural modes miss the divergence pressure by 1e-4, and tip twists
converge no faster than the square of their number. So the model carries a second one for static analyses: the wing
clamped, on the strains of its finite elements, which converges with their degree.

Above a certain dynamic pressure the static shapes of swept wings wind along the span more than once. Exact solutions
of the swept beam with strip theory have further divergence pressures there (27 times that of the unswept wing and
more, just past the critical aft sweep; thousands of times further aft). Neither strip theory nor the modes mean
anything at such wave lengths, and the literature calls these wings free of divergence: `static_limit` is where the
search ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag

from aeroservo.aero.strip import Indicial, QuasiSteady, Strips, Theory, strip_aero, strip_shapes
from aeroservo.aeroelastic.material import material
from aeroservo.aeroelastic.wing_servo import PlacedSensor, sensors_on_shapes
from aeroservo.aircraft.schema_beam import BeamWing
from aeroservo.atmosphere import STANDARD_GRAVITY
from aeroservo.datatypes import AeroelasticModel, Array, ModalModel, Relaxation
from aeroservo.servo import Sensor
from aeroservo.structure.beam import BeamMass, SlenderBeam, modes
from aeroservo.structure.beam_axis import gauss_points
from aeroservo.structure.beam_elements import beam_mesh, stiffness_blocks, strain_shapes
from aeroservo.structure.viscoelastic import relaxing

BEAM_MODES = 10
"""Elastic modes kept of a beam wing for dynamics: flutter speeds of ordinary wings to 1e-5."""

STRIP_PARTS, PART_POINTS = 8, 6
"""Parts of the span, at least, with boundaries at stations and ends of the elevon; strips are Gauss points in each."""

LAGGING_PARTS = 3
"""The same for indicial theories on a wing whose chord varies, where each strip brings lag states of its own."""

STATIC_DEGREE = 5
"""Degree of the deflection in each part, for statics: products with the loads are integrated exactly by the strips."""

TORSION_WAVES, BENDING_WAVES = 7.5, 6.0
"""Phase of static shapes along the span at which the search for divergence ends; first divergence is at 1.57 (unswept)
and 1.85 (swept forward, no eccentricity), the next ones that no sweep merges away at 7.85. [rad]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class StripWing:
    """A half wing as a beam with strips along it: what every kind of beam-and-strips file comes down to.

    Attributes
    ----------
    name : str
        Of the model.
    beam : SlenderBeam
        The structure.
    strips : callable
        Strips from their places along the flexural axis [m] and the lengths that they stand for [m], both of shape
        (n_strips,).
    breaks : tuple of float
        Places along the axis at which sections change suddenly: ends of controls. [m]
    rolling : callable, optional
        As `strips`, in antisymmetric motion, where they differ then: for reversal of roll with the root held.
    sensors : tuple of PlacedSensor
        On the beam.
    """

    name: str
    beam: SlenderBeam
    strips: Callable[[Array, Array], Strips]
    breaks: tuple[float, ...] = ()
    rolling: Callable[[Array, Array], Strips] | None = None
    sensors: tuple[PlacedSensor, ...] = ()


def beam_model(wing: StripWing, theory: Theory) -> AeroelasticModel:
    """Beam modes at Gauss points between stations, ends of the controls and equal parts of the span.

    Parameters
    ----------
    wing : StripWing
        Structure and strips, of `beam_wing` or `aircraft_wing`.
    theory : QuasiSteady, Indicial or Theodorsen
        Section theory.

    Returns
    -------
    model : AeroelasticModel
        Undamped, with `statics`: the clamped wing in strain coordinates. [SI]

    Raises
    ------
    ValueError
        As `SlenderBeam`.

    References
    ----------
    equations.md, "One equation of motion", "Static aeroelasticity" [7.6-7.21]; contract.md, kind "beam_wing".

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> goland = beam_model(beam_wing(read("goland")), QuasiSteady())
    >>> goland.modes.n, goland.statics.modes.n
    (10, 64)
    """
    beam = wing.beam
    rigid = {"clamped": 0, "free": 2 if beam.symmetry == "symmetric" else 1}[beam.root]
    mass = float(np.trapezoid(beam.mass, beam.y)) + sum(lump.mass for lump in beam.masses)
    nodes = _parts(wing, STRIP_PARTS)
    s, width = gauss_points(nodes, PART_POINTS)
    every = wing.strips(s, width)
    limit = static_limit(beam, every, s)

    def coupled(
        basis: Callable[[Array], ModalModel],
        section: Theory,
        nodes: Array,
        sections: Callable[[Array, Array], Strips] = wing.strips,
    ) -> AeroelasticModel:
        s, width = gauss_points(nodes, PART_POINTS)
        points = np.concatenate([s, beam.y[-1:], [lump.y for lump in beam.masses]])
        strips, shapes = sections(s, width), basis(points)
        aero, loads = strip_aero(strips, strip_shapes(shapes, strips.sweep), shapes.names, section)
        loads = replace(loads, weight=_weight(beam, shapes, points, width), limit=limit)
        return AeroelasticModel(modes=shapes, aero=aero, name=wing.name, loads=loads, mass=mass)

    finest, steady = nodes, QuasiSteady(damped=False)

    def held(points: Array) -> ModalModel:
        return _strain_modes(beam, points, finest)

    statics = coupled(held, steady, finest)
    rolling = None if wing.rolling is None else coupled(held, steady, finest, wing.rolling)
    if isinstance(theory, Indicial) and len(np.unique(every.b)) > 1:
        nodes = _parts(wing, LAGGING_PARTS)
    dynamic = coupled(lambda x: modes(beam, n=BEAM_MODES + rigid, points=x), theory, nodes)
    sensors: tuple[Sensor, ...] = ()
    if wing.sensors:
        places = modes(beam, n=BEAM_MODES + rigid, points=[p.y for p in wing.sensors])
        sensors = sensors_on_shapes(wing.sensors, places.phi)
    return replace(dynamic, statics=statics, rolling=rolling, sensors=sensors)


def beam_wing(model: BeamWing) -> StripWing:
    """Structure and strips of a `beam_wing` file.

    Parameters
    ----------
    model : BeamWing
        The file; its damping is not applied here.

    Returns
    -------
    wing : StripWing
        For `beam_model`. [SI]

    Raises
    ------
    ValueError
        As `SlenderBeam`.

    References
    ----------
    contract.md, kind "beam_wing".

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> beam_wing(read("goland")).breaks
    ()
    """
    beam, elevon = slender_beam(model), model.wing.elevon
    return StripWing(
        name=model.name,
        beam=beam,
        strips=lambda s, width: _strips(model, beam, s, width),
        breaks=(elevon.from_y_m, elevon.to_y_m) if elevon else (),
        sensors=tuple(PlacedSensor(sensor=x, y=x.y_m, aft=x.x_m) for x in model.sensor),
    )


def slender_beam(model: BeamWing) -> SlenderBeam:
    """The beam of a `beam_wing` file.

    Parameters
    ----------
    model : BeamWing
        The file. Lump inertias are about their own centre of gravity.

    Returns
    -------
    beam : SlenderBeam
        Origin of its axes at the root leading edge. [SI]

    Raises
    ------
    ValueError
        As `SlenderBeam`.

    References
    ----------
    contract.md, kind "beam_wing".

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> slender_beam(read("goland")).length
    6.096
    """
    w, stations = model.wing, model.wing.station

    def each(field: str) -> list[float]:
        return [getattr(station, field) for station in stations]

    sweep = [w.sweep_deg if station.sweep_deg is None else station.sweep_deg for station in stations]
    return SlenderBeam(
        y=each("y_m"),  # type: ignore[arg-type]
        mass=each("mass_kg_per_m"),  # type: ignore[arg-type]
        inertia=each("inertia_kg_m"),  # type: ignore[arg-type]
        EI=each("EI_N_m2"),  # type: ignore[arg-type]
        GJ=each("GJ_N_m2"),  # type: ignore[arg-type]
        cg_offset=np.array(each("cg_axis")) - np.array(each("flexural_axis")),
        chord=each("chord_m"),  # type: ignore[arg-type]
        coupling=each("coupling_N_m2"),  # type: ignore[arg-type]
        sweep=np.deg2rad(sweep),
        masses=tuple(BeamMass(y=m.y_m, mass=m.mass_kg, x=m.x_m, inertia=m.inertia_kg_m2) for m in w.mass),
        root=w.root,
        symmetry=w.symmetry,
        origin=np.array([stations[0].flexural_axis * stations[0].chord_m, 0.0, 0.0]),
        material=material(model.viscoelastic),
    )


def static_limit(beam: SlenderBeam, strips: Strips, s: Array) -> float:
    """Dynamic pressure at which static shapes wind along the span too often for modes and strip theory.

    In twist they go as sin of the integral of sqrt(q cos^2(Lambda) c^2 e a / GJ) along the axis, in bending as the
    cube root of q cos^2(Lambda) c a tan(Lambda) / EI.

    Parameters
    ----------
    beam : SlenderBeam
        The wing.
    strips : Strips
        Its strips.
    s : ndarray, shape (n_strips,)
        Their places along the axis. [m]

    Returns
    -------
    q : float
        Dynamic pressure; infinite without lift. [Pa]

    References
    ----------
    Diederich & Budiansky, NACA TN 1680, 1948, section "Divergence of a uniform wing" (the third-order equation for the
    angle of attack); equations.md, "Static aeroelasticity" [7.9-7.11].

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> wing = read("goland")
    >>> round(beam_model(beam_wing(wing), QuasiSteady()).loads.limit / 39005.75, 1)  # 22.8 times divergence
    22.8
    """
    chord, sweep = 2.0 * strips.b, strips.sweep
    per_length = np.cos(sweep) ** 2 * chord * strips.lift_slope
    EI, GJ, K = beam.at("EI", s), beam.at("GJ", s), beam.at("coupling", s)
    margin = EI * GJ - K**2
    twist = strips.width @ np.sqrt(per_length * chord * np.maximum(strips.eccentricity, 0.0) * EI / margin)
    bend = strips.width @ np.cbrt(per_length * np.abs(np.tan(sweep)) * GJ / margin)
    limits = [(TORSION_WAVES / twist) ** 2 if twist > 0.0 else np.inf, (BENDING_WAVES / bend) ** 3 if bend else np.inf]
    return float(min(limits))


def _parts(wing: StripWing, count: int) -> Array:
    """Boundaries of the parts of the span along the axis."""
    breaks = np.unique(np.concatenate([wing.beam.y, wing.breaks]))
    parts = np.maximum(1, np.round(count * np.diff(breaks) / wing.beam.length)).astype(int)
    return np.unique(np.concatenate([np.linspace(a, b, n + 1) for a, b, n in zip(breaks, breaks[1:], parts)]))


def _strips(model: BeamWing, beam: SlenderBeam, s: Array, width: Array) -> Strips:
    """Sections of the file at the strips."""
    elevon = model.wing.elevon

    def along(field: str) -> Array:
        return np.interp(s, beam.y, [getattr(station, field) for station in model.wing.station])

    axis = along("flexural_axis")
    on_elevon = (s > elevon.from_y_m) & (s < elevon.to_y_m) if elevon else np.zeros(len(s), dtype=bool)
    return Strips(
        y=beam.position(s)[:, 1] - beam.origin[1],
        width=width,
        b=0.5 * along("chord_m"),
        a=2.0 * axis - 1.0,
        eccentricity=axis - 0.25,
        lift_slope=np.full(len(s), _finite_span_slope(model, beam)),
        moment_rate=np.full(len(s), -1.2),
        sweep=beam.at("sweep", s),
        elevon_lift=on_elevon * (elevon.lift_per_rad if elevon else 0.0),
        elevon_moment=on_elevon * (elevon.moment_per_rad if elevon else 0.0),
        incidence=np.deg2rad(along("incidence_deg")),
        cm0=along("cm0"),
        span=float(beam.position(beam.y[-1])[1] - beam.origin[1]),
    )


def _strain_modes(beam: SlenderBeam, points: Array, nodes: Array) -> ModalModel:
    """The clamped wing in strain coordinates of unit strain energy; statics use no mass, so M is the unit matrix."""
    clamped = replace(beam, root="clamped", symmetry="symmetric")
    mesh = beam_mesh(clamped, elements=1, degree=STATIC_DEGREE, at=nodes)
    stiffness = stiffness_blocks(mesh)
    blocks = np.linalg.inv(np.linalg.cholesky(stiffness))
    shapes = strain_shapes(mesh, points).reshape(3 * points.size, len(blocks), -1)
    unit = np.einsum("gek,emk->gem", shapes, blocks).reshape(points.size, 3, -1)
    n = unit.shape[2]
    phi = np.zeros((points.size, 6, n))
    phi[:, 2:5] = unit
    names = tuple(f"strain {j + 1}" for j in range(n))
    relaxes: tuple[Relaxation, ...] = ()
    if beam.material is not None:
        k = mesh.terms
        parts = []
        for own in (slice(0, k), slice(k, 2 * k)):
            part = np.zeros_like(stiffness)
            part[:, own, own] = stiffness[:, own, own]
            parts.append(block_diag(*(blocks @ part @ blocks.transpose(0, 2, 1))))
        relaxes = relaxing(parts[0], parts[1], beam.material)
    return ModalModel(
        M=np.eye(n),
        D=np.zeros((n, n)),
        K=np.eye(n),
        names=names,
        phi=phi,
        grid=beam.position(points),
        relaxing=relaxes,
    )


def _weight(beam: SlenderBeam, modes: ModalModel, points: Array, width: Array) -> Array:
    """Work of gravity per unit of each mode: m g (h + d theta), h down, d aft; lumps are the last points."""
    shapes, n = strip_shapes(modes, beam.at("sweep", points)), len(width)
    m = beam.at("mass", points[:n]) * width
    force = m @ shapes.h[:n] + (m * beam.at("cg_offset", points[:n])) @ shapes.twist[:n]
    for j, lump in enumerate(beam.masses):
        force = force + lump.mass * (shapes.h[n + 1 + j] + lump.x * shapes.twist[n + 1 + j])
    return np.asarray(STANDARD_GRAVITY * force)


def _finite_span_slope(model: BeamWing, beam: SlenderBeam) -> float:
    """Section lift slope, corrected for a finite span where the file asks for it."""
    from aeroservo.aero.finite_span import helmbold_slope, polhamus_slope

    w = model.wing
    if w.lift_slope_correction == "none":
        return w.lift_slope_per_rad
    chords = [station.chord_m for station in w.station]
    tip = beam.position(beam.y[-1])
    aspect_ratio = 2.0 * float(tip[1]) ** 2 / (float(np.trapezoid(chords, beam.y)) * float(tip[1]) / beam.length)
    if w.lift_slope_correction == "helmbold":
        return float(helmbold_slope(aspect_ratio, w.lift_slope_per_rad))
    mean_sweep = float(np.arctan2(tip[0] - beam.origin[0], tip[1]))
    return float(polhamus_slope(aspect_ratio, mean_sweep, w.lift_slope_per_rad))
