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
from aeroservo.aeroelastic.aircraft_lattice import ANTISYMMETRIC
from aeroservo.aeroelastic.aircraft_wing import aircraft_wing
from aeroservo.aeroelastic.build_beam import beam_model, beam_wing
from aeroservo.aeroelastic.material import material
from aeroservo.aeroelastic.pitch_plunge import pitch_plunge_model
from aeroservo.aeroelastic.wing_servo import PlacedSensor, actuator, sensor, sensors_on_shapes
from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.aircraft.schema_base import FileModel
from aeroservo.aircraft.schema_beam import BeamWing
from aeroservo.aircraft.schema_other import ModalFile, PitchPlungeFlap
from aeroservo.aircraft.schema_section import TypicalSection
from aeroservo.aircraft.schema_wing import AircraftWing, BinaryWing, WholeAircraft
from aeroservo.datatypes import AeroelasticModel, AeroInput, Array, ModalModel, RationalAero, SampledAero, Spring
from aeroservo.servo import Actuator
from aeroservo.structure.assumed import binary_wing, whole_aircraft
from aeroservo.structure.beam_axis import gauss_points
from aeroservo.structure.damping import modal_damping
from aeroservo.structure.modal import tip_motion
from aeroservo.structure.section import typical_section
from aeroservo.structure.viscoelastic import Viscoelastic, relaxing

THEORIES: dict[str, Callable[[], Theory]] = {
    "quasi_steady": lambda: QuasiSteady(damped=False),
    "quasi_steady_damped": lambda: QuasiSteady(damped=True),
    "jones": Indicial,
    "theodorsen": Theodorsen,
}
"""Section theories by the name that `--aero` has for them."""


@dataclass(frozen=True, kw_only=True)
class Default:
    """Aerodynamics and flutter method of a kind of model where the user names none.

    Attributes
    ----------
    aero : str or None
        A key of `THEORIES`; None where the model brings its own.
    method : str
        "p", "pk", "k" or "g".
    """

    aero: str | None
    method: str


DEFAULTS = {
    "typical_section": Default(aero="theodorsen", method="pk"),
    "binary_wing": Default(aero="quasi_steady_damped", method="p"),
    "whole_aircraft": Default(aero="quasi_steady_damped", method="p"),
    "beam_wing": Default(aero="theodorsen", method="pk"),
    "pitch_plunge_flap": Default(aero=None, method="p"),
    "modal": Default(aero=None, method="pk"),
    "aircraft": Default(aero="theodorsen", method="pk"),
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
    if isinstance(model, PitchPlungeFlap):
        if aero is not None:
            raise ValueError(f"a pitch_plunge_flap model has derivatives of its own: leave out aero {aero!r}")
        return pitch_plunge_model(model)
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
    assert isinstance(model, BeamWing | AircraftFile)  # DEFAULTS holds no other kind
    wing = beam_model(beam_wing(model) if isinstance(model, BeamWing) else aircraft_wing(model), theory)
    viscous = None if model.damping is None or model.damping.viscous is None else model.damping.viscous
    dampers = None if viscous is None else _tip_dampers(wing.modes, viscous.plunge_N_s_per_m, viscous.pitch_N_m_s)
    return replace(wing, modes=_damped(wing.modes, model.damping, dampers), actuators=_actuators(model, wing.aero))


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
            Spring(mode=name, polynomial=polynomial, freeplay=gaps.get(name, 0.0), stiffness=stiffness)
            for (name, polynomial), stiffness in zip(linear.items(), (s.plunge_stiffness_N_per_m2, s.pitch_stiffness_N))
        )
    viscous = None if model.damping is None or model.damping.viscous is None else model.damping.viscous
    dampers = (
        None if viscous is None else np.diag([viscous.plunge_N_s_per_m2, viscous.pitch_N_s, 0.0])[: modes.n, : modes.n]
    )
    modes = _relaxing(_damped(modes, model.damping, dampers), material(model.viscoelastic))
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
    points, width = gauss_points([0.0, w.semi_span_m], 6)
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
    dampers = None if viscous is None else _tip_dampers(modes, viscous.plunge_N_s_per_m, viscous.pitch_N_m_s)
    modes = _relaxing(_damped(modes, model.damping, dampers), material(model.viscoelastic))
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
    aero, loads = strip_aero(strips, shapes, modes.names, theory, axis_moment_rolls=False)
    mass = w.semi_span_m * (w.mass_kg_per_m2 * w.chord_m + w.leading_edge_mass_kg_per_m) + centre
    places = [PlacedSensor(sensor=x, y=x.y_m, aft=x.x_m) for x in model.sensor]
    common["points"] = np.array([p.y for p in places])
    at_sensors = whole_aircraft(**common, centre_mass=centre) if isinstance(w, AircraftWing) else binary_wing(**common)
    return AeroelasticModel(
        modes=modes,
        aero=aero,
        name=model.name,
        loads=loads,
        mass=mass,
        actuators=_actuators(model, aero),
        sensors=sensors_on_shapes(places, at_sensors.phi),
    )


def _actuators(
    model: BinaryWing | WholeAircraft | BeamWing | AircraftFile | ModalFile, aero: SampledAero | RationalAero
) -> tuple[Actuator, ...]:
    """Actuators of the file on the controls of the air forces, symmetric and antisymmetric alike."""
    controls = [x.name for x in aero.inputs if x.kind == "control"]
    if isinstance(model, AircraftFile | ModalFile):
        tables = {a.control: a for a in model.actuator}
        named = {name: tables.get(name, tables.get(name.removesuffix(ANTISYMMETRIC))) for name in controls}
        return tuple(actuator(table, name) for name, table in named.items() if table is not None)
    return tuple(actuator(model.actuator, name) for name in controls) if model.actuator is not None else ()


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
    air = SampledAero(k=x.k, mach=x.mach, Q=x.Q, b=x.b_m, inputs=inputs)
    missing = [a.control for a in model.actuator if a.control not in x.input_names]
    if missing:
        raise ValueError(f"actuator: no input of the data is called {missing[0]!r}; inputs: {list(x.input_names[n:])}")
    worst = max((s.grid_point for s in model.sensor), default=-1)
    if worst >= len(modes.grid):
        raise ValueError(
            f"sensor: grid_point must be below {len(modes.grid)}, the number of points in `grid`, got {worst}"
        )
    return AeroelasticModel(
        modes=modes,
        aero=air,
        name=model.name,
        actuators=_actuators(model, air),
        sensors=tuple(sensor(s, -modes.phi[s.grid_point, 2], modes.phi[s.grid_point, 4]) for s in model.sensor),
    )


def _input_kind(name: str) -> str:
    """Kind of a user's input by its name: "gust..." and "steady..." say so, everything else is a control."""
    return next((kind for kind in ("gust", "steady") if name.lower().startswith(kind)), "control")


def _relaxing(modes: ModalModel, law: Viscoelastic | None) -> ModalModel:
    """Springs of bending (the first coordinate) and of torsion (the second) that relax."""
    if law is None:
        return modes
    first, second = (np.diag(np.where(np.arange(modes.n) == j, np.diag(modes.K), 0.0)) for j in (0, 1))
    return replace(modes, relaxing=relaxing(first, second, law))


def _tip_dampers(modes: ModalModel, plunge: float, pitch: float) -> Array:
    """Dampers on the elastic plunge and twist of the tip: on the coordinates themselves of an assumed wing."""
    h, twist = (np.where(np.any(modes.K != 0.0, axis=0), motion, 0.0) for motion in tip_motion(modes))
    return plunge * np.outer(h, h) + pitch * np.outer(twist, twist)


def _damped(modes: ModalModel, damping: Any, viscous: Array | None) -> ModalModel:
    """The structure with the damping of its file; `viscous` is that of its dampers."""
    if damping is None:
        return modes
    if viscous is not None:
        return replace(modes, D=viscous)
    if damping.modal is not None:
        return replace(modes, D=modal_damping(modes, damping.modal.ratios))
    if damping.rayleigh is not None:
        return replace(modes, D=damping.rayleigh.alpha * modes.M + damping.rayleigh.beta * modes.K)
    return replace(modes, hysteretic_g=damping.hysteretic.g)
