"""What the studio computes of a model after every change: speeds first, curves after them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.datatypes import Array, FlightCondition

if TYPE_CHECKING:
    from aeroservo.aeroelastic.flutter import FlutterResult, Method
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.datatypes import AeroelasticModel

#: Called between pieces of work with what comes next and the part done [-]; raises where the user has cancelled.
Tell = Callable[[str, float], None]

#: Most speeds of a sweep: the speeds found do not depend on them, curves need no more.
MOST_SPEEDS = 401
#: Speeds at which flutter is looked for before the curves are there.
FIRST_LOOK = 49
_NAMES = {"P": "p", "PK": "p-k", "K": "k", "G": "g"}
#: Sweep where the file gives none. [m/s]
SPEEDS = (1.0, 350.0, 1.0)


@dataclass(frozen=True, kw_only=True)
class Air:
    """Where and how the analyses are made.

    Attributes
    ----------
    altitude : float
        Geopotential. [m]
    aero : str, optional
        Air forces; by kind of model if not given.
    method : str, optional
        How roots are found, "p", "pk", "k" or "g"; by kind of model if not given.
    """

    altitude: float = 0.0
    aero: str | None = None
    method: str | None = None


@dataclass(frozen=True, kw_only=True)
class Speed:
    """A number that is compared with the file's.

    Attributes
    ----------
    name : str
        What it is.
    value : float or None
        None where there is none. [`unit`]
    unit : str
        Its unit.
    remark : str
        What to know beside it.
    """

    name: str
    value: float | None
    unit: str
    remark: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class Curves:
    """Roots against airspeed.

    Attributes
    ----------
    names : tuple of str
        Branches.
    V : ndarray, shape (n_V, n)
        True airspeed. [m/s]
    frequency : ndarray, shape (n_V, n)
        Frequency, nan where a branch does not exist. [Hz]
    damping : ndarray, shape (n_V, n)
        Damping ratio, positive stable. [-]
    """

    names: tuple[str, ...]
    V: Array
    frequency: Array
    damping: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Analysis:
    """What is known of a model.

    Attributes
    ----------
    name, kind, heading : str
        The model, and in words where and how it was analysed.
    speeds : tuple of Speed
        Flutter, divergence, reversal.
    curves : Curves or None
        None where they are not there yet, or the model has none.
    modes : tuple of (str, float, float)
        Natural modes without air: name, frequency, damping ratio. [Hz, -]
    derived : tuple of (str, float)
        Numbers that follow from the file by arithmetic. [unit in the name]
    notes : tuple of str
        What to know before trusting the numbers.
    scene : str
        What the 3-D view draws, as JSON; "" where there is nothing to draw.
    complete : bool
        Whether nothing more is to come.
    """

    name: str
    kind: str
    heading: str
    speeds: tuple[Speed, ...]
    curves: Curves | None = None
    modes: tuple[tuple[str, float, float], ...] = ()
    derived: tuple[tuple[str, float], ...] = ()
    notes: tuple[str, ...] = ()
    scene: str = ""
    complete: bool = True


def analyse(text: str, path: Path, air: Air, tell: Tell, partial: Callable[[Analysis], None]) -> Analysis:
    """Speeds, curves and modes of a model file.

    Parameters
    ----------
    text : str
        Of the file.
    path : Path
        Where it lies, or would lie: data files are beside it.
    air : Air
        Where and how.
    tell : callable
        Hears of progress.
    partial : callable
        Gets the speeds as soon as they are known.

    Returns
    -------
    analysis : Analysis
        Everything. [SI]

    Raises
    ------
    ValueError
        If there is no such model or analysis.

    References
    ----------
    contract.md, `flutter`, `static`, `modes`, `check`.

    Examples
    --------
    >>> from aeroservo.studio.draft import opened
    >>> source = opened("thesis-binary", Path("."))
    >>> found = analyse(source.text, source.path, Air(), lambda what, part: None, lambda result: None)
    >>> [(speed.name, round(speed.value, 3), speed.unit) for speed in found.speeds]
    [('Flutter', 49.163, 'm/s'), ('Divergence', 81.005, 'm/s'), ('Roll reversal', 55.0, 'm/s')]
    """
    from aeroservo.aeroelastic.build import DEFAULTS, build
    from aeroservo.aeroelastic.flutter import flutter
    from aeroservo.aeroelastic.onset import onset
    from aeroservo.aeroelastic.static import reversal
    from aeroservo.aircraft.aircraft_schema import AircraftFile
    from aeroservo.aircraft.files import parse

    tell("reading the model", 0.0)
    file = parse(text, path)
    derived = tuple((k, float(v)) for k, v in file.derived().items() if isinstance(v, int | float))
    known = Analysis(name=file.name, kind=file.kind, heading="", speeds=(), derived=derived, notes=file.problems())
    if file.kind not in DEFAULTS:
        return replace(known, notes=(*known.notes, f"a {file.kind} model has no flutter analysis: simulate it"))
    if isinstance(file, AircraftFile) and file.structure is None:
        return replace(known, notes=(*known.notes, "the aircraft has no [structure]: it is rigid and does not flutter"))
    tell("building the model", 0.05)
    model = build(file, air.aero)
    sweep, method, thinned = _sweep(file, air.altitude), _method(file, air), _too_fine(file)
    theory = air.aero or DEFAULTS[file.kind].aero or "the file's own"
    known = replace(
        known,
        heading=f"{_NAMES[type(method).__name__]} method, air forces {theory.replace('_', ' ')}, {air.altitude:g} m "
        f"({float(sweep.rho[0]):.4g} kg/m³), {sweep.V[0]:g} to {sweep.V[-1]:g} m/s",
        modes=_modes(model),
        notes=(*known.notes, *thinned),
    )
    tell("static aeroelasticity", 0.1)
    quantity, reverses = reversal(model, sweep[0])
    tell("flutter speed", 0.15)
    ends = sweep[np.array([0, -1])]
    first = onset(model, ends, method, points=FIRST_LOOK)  # the whole search follows
    already = first.found and first.flutter_speed is None
    speeds = (
        Speed(name="Flutter", value=first.flutter_speed, unit="m/s", remark="" if already else _none_to(sweep)),
        _static_speed("Divergence", first.divergence_speed, "does not diverge at any speed"),
        _static_speed(f"{(quantity or 'control').capitalize()} reversal", reverses.V, _NEVER[quantity is not None]),
    )
    partial(replace(known, speeds=speeds, complete=False))
    tell("frequency and damping over speed", 0.45)
    found = flutter(model, sweep, method)
    speeds = (_flutter_speed(found, sweep), *speeds[1:])
    tell("shapes of the modes", 0.9)
    scene = _scene(file, model, found)
    return replace(known, speeds=speeds, curves=_curves(found), notes=(*known.notes, *found.warnings), scene=scene)


def _static_speed(name: str, value: float | None, never: str) -> Speed:
    return Speed(name=name, value=value, unit="m/s", remark=never if value is None else "")


_NEVER = ("the model has no controls", "does not reverse at any speed")


def _flutter_speed(found: FlutterResult, sweep: FlightCondition) -> Speed:
    if found.flutter_speed is not None:
        hertz = (found.flutter_frequency or 0.0) / (2.0 * math.pi)
        return Speed(
            name="Flutter", value=found.flutter_speed, unit="m/s", remark=f"{found.flutter_mode}, {hertz:.4g} Hz"
        )
    already = any(i.start is None and i.kind == "flutter" for i in found.intervals)
    remark = f"unstable already at {sweep.V[0]:g} m/s" if already else _none_to(sweep)
    return Speed(name="Flutter", value=None, unit="m/s", remark=remark)


def _scene(file: FileModel, model: AeroelasticModel, found: FlutterResult) -> str:
    """Modes along the root locus in three dimensions."""
    from aeroservo.report.lattice3d import lattice3d
    from aeroservo.report.page import json_for_html
    from aeroservo.report.scene import mode_data, scene_data

    if not len(model.modes.grid):
        return ""
    lattice = lattice3d(file, model)
    return json_for_html(scene_data(lattice, modes=mode_data(lattice, found)))


def _none_to(sweep: FlightCondition) -> str:
    return f"none up to {sweep.V[-1]:g} m/s"


def _sweep(file: FileModel, altitude: float) -> FlightCondition:
    """The file's speeds, thinned where they are more than curves need."""
    low, high, step = file.speeds_m_s or SPEEDS
    n = math.floor((high - low) / step * (1.0 + 1e-12) + 1e-9)
    V = low + step * np.arange(min(n, MOST_SPEEDS) + 1) if n < MOST_SPEEDS else np.linspace(low, high, MOST_SPEEDS)
    V = np.minimum(V, high)
    if high - V[-1] > 1e-9 * step:
        V = np.append(V, high)
    if len(V) < 2:
        raise ValueError(f"speeds_m_s must have two or more speeds [m/s], got {low:g} to {high:g} in steps of {step:g}")
    return FlightCondition.at(altitude, V=V)


def _too_fine(file: FileModel) -> tuple[str, ...]:
    low, high, step = file.speeds_m_s or SPEEDS
    if (high - low) / step < MOST_SPEEDS:
        return ()
    return (
        f"curves are drawn at {MOST_SPEEDS} speeds, not in the file's step of {step:g} m/s: no speed depends on it",
    )


def _method(file: FileModel, air: Air) -> Method:
    from aeroservo.aeroelastic.build import DEFAULTS
    from aeroservo.aeroelastic.flutter import PK, G, K, P

    methods: dict[str, Method] = {"p": P(), "pk": PK(), "k": K(), "g": G()}
    usual = "pk" if air.aero == "theodorsen" else DEFAULTS[file.kind].method
    return methods[air.method or usual]


def _modes(model: AeroelasticModel) -> tuple[tuple[str, float, float], ...]:
    """Natural modes; damping from the modal diagonal of D."""
    from aeroservo.structure.modal import natural_modes

    found: Any = natural_modes(model.modes)
    rows = []
    for name, omega, shape, mass in zip(found.names, found.omega, found.shapes.T, found.generalized_mass):
        damping = float(shape @ model.modes.D @ shape)
        zeta = damping / (2.0 * mass * omega) if omega > 0.0 and mass > 0.0 else 0.0
        rows.append((str(name), float(omega) / (2.0 * math.pi), zeta))
    return tuple(rows)


def _curves(found: FlutterResult) -> Curves:
    from aeroservo.report.figures import shown_branches

    shown = shown_branches(found)
    frequency = found.frequency[:, shown] / (2.0 * math.pi)
    damping = np.where(np.isfinite(frequency), found.damping_ratio[:, shown], np.nan)
    names = tuple(found.names[j] for j in shown)
    return Curves(names=names, V=np.array(found.speeds[:, shown]), frequency=frequency, damping=damping)
