"""From a model file to an AeroelasticModel: which structure, which strips, which air."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from aeroservo.aero.strip import (
    Indicial,
    QuasiSteady,
    Strips,
    StripShapes,
    Theodorsen,
    Theory,
    strip_aero,
    strip_shapes,
)
from aeroservo.aircraft.schema_base import FileModel
from aeroservo.aircraft.schema_beam import BeamWing
from aeroservo.aircraft.schema_other import ModalFile
from aeroservo.aircraft.schema_section import TypicalSection
from aeroservo.aircraft.schema_wing import AircraftWing, BinaryWing, WholeAircraft
from aeroservo.datatypes import AeroelasticModel, AeroInput, Array, ModalModel, SampledAero, Spring
from aeroservo.structure.assumed import binary_wing, whole_aircraft
from aeroservo.structure.beam import BeamMass, SlenderBeam, beam_modes
from aeroservo.structure.damping import modal_damping
from aeroservo.structure.section import typical_section

THEORIES: dict[str, Callable[[], Theory]] = {
    "quasi_steady": lambda: QuasiSteady(damped=False),
    "quasi_steady_damped": lambda: QuasiSteady(damped=True),
    "jones": Indicial,
    "theodorsen": Theodorsen,
}
"""Section theories by the name that `--aero` has for them."""

BEAM_MODES = 10
"""Modes kept of a beam wing: enough for flutter speeds of ordinary wings to 1e-6."""

STRIP_POINTS = 48
"""Strips of a beam wing, at least; Gauss points between stations and ends of the elevon."""


@dataclass(frozen=True, kw_only=True)
class Default:
    """Aerodynamics and flutter method of a kind of model where the user names none."""

    aero: str | None
    method: str


DEFAULTS = {
    "typical_section": Default(aero="theodorsen", method="pk"),
    "binary_wing": Default(aero="quasi_steady_damped", method="p"),
    "whole_aircraft": Default(aero="quasi_steady_damped", method="p"),
    "beam_wing": Default(aero="theodorsen", method="pk"),
    "modal": Default(aero=None, method="pk"),
}
"""contract.md, "Default --aero by kind"."""


def build(model: FileModel, aero: str | None = None) -> AeroelasticModel:
    """Couple the structure of a model file with section air forces.

    Parameters
    ----------
    model : FileModel
        From `aeroservo.read`.
    aero : {"quasi_steady", "quasi_steady_damped", "jones", "theodorsen"}, optional
        Section theory; default that of the kind. A `modal` model brings its own air forces.

    Returns
    -------
    model : AeroelasticModel
        Without airspeed or density. [SI]

    Raises
    ------
    ValueError
        If the kind of model has no such analysis, or the theory is unknown or does not fit it.

    References
    ----------
    contract.md, "Default --aero by kind"; equations.md, "Binary wing", "Whole aircraft".

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> build(read("thesis-binary")).modes.names
    ('bending 1', 'torsion 1')
    """
    if model.kind not in DEFAULTS:
        raise ValueError(f"kind {model.kind!r} has no aeroelastic model of its own yet; kinds that have: {[*DEFAULTS]}")
    if isinstance(model, ModalFile):
        return _modal(model, aero)
    name = aero or DEFAULTS[model.kind].aero
    if name == "dlm":
        raise ValueError("aero 'dlm': there is no unsteady lattice yet; strips: " + ", ".join(THEORIES))
    if name not in THEORIES:
        raise ValueError(f"aero must be one of {', '.join(THEORIES)}, got {name!r}")
    theory = THEORIES[name]()
    if isinstance(model, TypicalSection):
        return _section(model, theory)
    if isinstance(model, BinaryWing | WholeAircraft):
        return _assumed(model, theory)
    assert isinstance(model, BeamWing)  # DEFAULTS holds no other kind
    return _beam(model, theory)


def structure(model: FileModel) -> ModalModel:
    """The structure of a model file alone, damping included.

    Parameters
    ----------
    model : FileModel
        From `aeroservo.read`.

    Returns
    -------
    modes : ModalModel
        As in `build`. [SI]

    Raises
    ------
    ValueError
        As `build`.

    References
    ----------
    contract.md, `modes`.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> structure(read("goland")).names[0]
    'bending 1'
    """
    return build(model).modes


def _section(model: TypicalSection, theory: Theory) -> AeroelasticModel:
    """One strip of unit width."""
    s = model.section
    flap = None
    if s.flap is not None:
        arm = (s.flap.hinge - s.flexural_axis) * s.chord_m
        flap = (arm, s.flap.flap_static_moment_kg, s.flap.flap_inertia_kg_m, s.flap.hinge_stiffness_N)
    modes = typical_section(
        mass=s.mass_kg_per_m,
        static_moment=s.static_moment_kg,
        inertia=s.inertia_kg_m,
        plunge_stiffness=s.plunge_stiffness_N_per_m2,
        pitch_stiffness=s.pitch_stiffness_N,
        flap=flap,
    )
    springs: tuple[Spring, ...] = ()
    if s.nonlinear is not None:
        linear = {"plunge": s.nonlinear.plunge_stiffness_polynomial, "pitch": s.nonlinear.pitch_stiffness_polynomial}
        K = np.array(modes.K)
        for row, name in enumerate(linear):
            K[row, row] *= linear[name][0]
        modes = replace(modes, K=K)
        gaps = {"pitch": s.nonlinear.freeplay_rad}
        springs = tuple(
            Spring(mode=name, polynomial=polynomial, freeplay=gaps.get(name, 0.0))
            for name, polynomial in linear.items()
        )
    viscous = None if model.damping is None or model.damping.viscous is None else model.damping.viscous
    modes = _damped(modes, model.damping, None if viscous is None else (viscous.plunge_N_s_per_m2, viscous.pitch_N_s))
    one = np.ones(1)
    strips = Strips(
        y=one,
        width=one,
        b=one * s.b,
        a=one * s.a,
        eccentricity=one * s.e,
        lift_slope=one * s.lift_slope_per_rad,
        moment_rate=one * s.moment_rate_derivative,
        sweep=0.0 * one,
        elevon_lift=0.0 * one,
        elevon_moment=0.0 * one,
        incidence=0.0 * one,
        cm0=0.0 * one,
        span=1.0,
        hinge=None if s.flap is None else 2.0 * s.flap.hinge - 1.0,
    )
    rows = np.eye(modes.n)
    shapes = StripShapes(
        h=rows[[0]], twist=rows[[1]], slope=np.zeros((1, modes.n)), flap=None if s.flap is None else rows[[2]]
    )
    aero, loads = strip_aero(strips, shapes, modes.names, theory)
    return AeroelasticModel(modes=modes, aero=aero, name=model.name, loads=loads, springs=springs, mass=s.mass_kg_per_m)


def _assumed(model: BinaryWing | WholeAircraft, theory: Theory) -> AeroelasticModel:
    """Gauss points along the assumed shapes; sweep by V cos(Lambda) only, as the contract has it."""
    w = model.wing
    points, width = _gauss(np.array([0.0, w.semi_span_m]), 6)
    sweep = np.deg2rad(w.sweep_deg)
    common: dict[str, Any] = {
        "semi_span": w.semi_span_m,
        "chord": w.chord_m,
        "flexural_axis": w.flexural_axis,
        "mass_per_area": w.mass_kg_per_m2,
        "plunge_stiffness": w.K_h,
        "pitch_stiffness": w.K_theta,
        "leading_edge_mass": w.leading_edge_mass_kg_per_m,
        "sweep": sweep,
        "points": points,
    }
    centre = w.centre_mass_kg if isinstance(w, AircraftWing) else 0.0
    modes = whole_aircraft(**common, centre_mass=centre) if isinstance(w, AircraftWing) else binary_wing(**common)
    viscous = None if model.damping is None or model.damping.viscous is None else model.damping.viscous
    modes = _damped(modes, model.damping, None if viscous is None else (viscous.plunge_N_s_per_m, viscous.pitch_N_m_s))
    every = np.ones(len(points))
    strips = Strips(
        y=points * np.cos(sweep),
        width=width,
        b=0.5 * w.chord_m * every,
        a=w.a * every,
        eccentricity=w.e * every,
        lift_slope=w.lift_slope_per_rad * every,
        moment_rate=w.moment_rate_derivative * every,
        sweep=sweep * every,
        elevon_lift=(w.elevon.lift_per_rad if w.elevon else 0.0) * every,
        elevon_moment=(w.elevon.moment_per_rad if w.elevon else 0.0) * every,
        incidence=0.0 * every,
        cm0=0.0 * every,
        span=w.semi_span_m * float(np.cos(sweep)),
    )
    shapes = strip_shapes(modes, strips.sweep, bending_slope=False)
    aero, loads = strip_aero(strips, shapes, modes.names, theory)
    mass = w.semi_span_m * (w.mass_kg_per_m2 * w.chord_m + w.leading_edge_mass_kg_per_m) + centre
    return AeroelasticModel(modes=modes, aero=aero, name=model.name, loads=loads, mass=mass)


def _beam(model: BeamWing, theory: Theory) -> AeroelasticModel:
    """Beam modes at Gauss points between stations, ends of the elevon and equal parts of the span."""
    w, beam = model.wing, slender_beam(model)
    elevon = w.elevon
    breaks = np.unique(np.concatenate([beam.y, [elevon.from_y_m, elevon.to_y_m] if elevon else []]))
    parts = np.maximum(1, np.round(STRIP_POINTS / 6 * np.diff(breaks) / beam.length)).astype(int)
    nodes = np.unique(np.concatenate([np.linspace(a, b, n + 1) for a, b, n in zip(breaks, breaks[1:], parts)]))
    s, width = _gauss(nodes, 6)
    found = beam_modes(beam, n=_beam_mode_count(w.root, w.symmetry), points=np.append(s, beam.y[-1]))
    modes = ModalModel(
        M=found.M,
        D=np.zeros_like(found.M),
        K=found.K,
        names=found.names,
        phi=found.phi,
        grid=found.grid,
    )
    if model.damping is not None and model.damping.viscous is not None:
        raise ValueError(
            "damping.viscous acts on the two coordinates of an assumed wing: for a beam_wing give "
            "[damping.modal], [damping.rayleigh] or [damping.hysteretic]"
        )
    modes = _damped(modes, model.damping, None)

    def along(field: str) -> Array:
        return np.interp(s, beam.y, [getattr(station, field) for station in w.station])

    chord, axis = along("chord_m"), along("flexural_axis")
    on_elevon = (s > elevon.from_y_m) & (s < elevon.to_y_m) if elevon else np.zeros(len(s), dtype=bool)
    y_span = found.grid[:-1, 1] - beam.origin[1]
    strips = Strips(
        y=y_span,
        width=width,
        b=0.5 * chord,
        a=2.0 * axis - 1.0,
        eccentricity=axis - 0.25,
        lift_slope=np.full(len(s), _finite_span_slope(model, beam)),
        moment_rate=np.full(len(s), -1.2),
        sweep=beam.at("sweep", s),
        elevon_lift=on_elevon * (elevon.lift_per_rad if elevon else 0.0),
        elevon_moment=on_elevon * (elevon.moment_per_rad if elevon else 0.0),
        incidence=np.deg2rad(along("incidence_deg")),
        cm0=along("cm0"),
        span=float(found.grid[-1, 1] - beam.origin[1]),
    )
    aero, loads = strip_aero(strips, strip_shapes(modes, strips.sweep), modes.names, theory)
    mass = np.trapezoid([station.mass_kg_per_m for station in w.station], beam.y) + sum(m.mass_kg for m in w.mass)
    return AeroelasticModel(modes=modes, aero=aero, name=model.name, loads=loads, mass=float(mass))


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
        cg_offset=np.array([(s.cg_axis - s.flexural_axis) * s.chord_m for s in stations]),
        coupling=each("coupling_N_m2"),  # type: ignore[arg-type]
        sweep=np.deg2rad(sweep),
        masses=tuple(BeamMass(y=m.y_m, mass=m.mass_kg, x=m.x_m, inertia=m.inertia_kg_m2) for m in w.mass),
        root=w.root,
        symmetry=w.symmetry,
        origin=np.array([stations[0].flexural_axis * stations[0].chord_m, 0.0, 0.0]),
    )


def _beam_mode_count(root: str, symmetry: str) -> int:
    """Elastic modes kept, and the rigid ones besides."""
    rigid = {"clamped": 0, "free": 2 if symmetry == "symmetric" else 1}[root]
    return BEAM_MODES + rigid


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


def _modal(model: ModalFile, aero: str | None) -> AeroelasticModel:
    """The user's own modes and air forces."""
    if aero is not None:
        raise ValueError(f"a modal model brings its own air forces: leave out aero {aero!r}")
    x = model.arrays
    n = len(x.mode_names)
    extra = {name: getattr(x, name) for name in ("M_control", "phi", "grid") if getattr(x, name) is not None}
    modes = ModalModel(M=x.M, D=x.D, K=x.K, names=x.mode_names, **extra)
    kinds = ["mode"] * n + [_input_kind(name) for name in x.input_names[n:]]
    inputs = tuple(AeroInput(name=name, kind=kind) for name, kind in zip(x.input_names, kinds))  # type: ignore[arg-type]
    return AeroelasticModel(
        modes=modes, aero=SampledAero(k=x.k, mach=x.mach, Q=x.Q, b=x.b_m, inputs=inputs), name=model.name
    )


def _input_kind(name: str) -> str:
    """Kind of a user's input by its name: "gust..." and "steady..." say so, everything else is a control."""
    return next((kind for kind in ("gust", "steady") if name.lower().startswith(kind)), "control")


def _damped(modes: ModalModel, damping: Any, viscous: tuple[float, float] | None) -> ModalModel:
    """The structure with the damping of its file."""
    if damping is None:
        return modes
    if viscous is not None:
        D = np.zeros((modes.n, modes.n))
        D[0, 0], D[1, 1] = viscous
        return replace(modes, D=D)
    if damping.modal is not None:
        return replace(modes, D=modal_damping(modes, damping.modal.ratios))
    if damping.rayleigh is not None:
        return replace(modes, D=damping.rayleigh.alpha * modes.M + damping.rayleigh.beta * modes.K)
    return replace(modes, hysteretic_g=damping.hysteretic.g)


def _gauss(nodes: Array, n: int) -> tuple[Array, Array]:
    """Gauss points and weights in every part between nodes, in order."""
    x, weight = np.polynomial.legendre.leggauss(n)
    half = 0.5 * np.diff(nodes)[:, None]
    middle = 0.5 * (nodes[1:] + nodes[:-1])[:, None]
    return (middle + half * x).ravel(), (half * weight).ravel()
