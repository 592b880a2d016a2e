"""What the studio simulates: one flight, what shakes it, with or without a controller."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from aeroservo.datatypes import Array, FlightCondition, LinearSystem

if TYPE_CHECKING:
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.aircraft.schema_other import StateSpaceFile
    from aeroservo.control.controller import Controller
    from aeroservo.datatypes import AeroelasticModel
    from aeroservo.simulate.engine import Simulation
    from aeroservo.simulate.history import TimeHistory
    from aeroservo.simulate.scenario import Scenario
    from aeroservo.studio.analysis import Tell

Shake = Literal["kick", "sharp", "cosine", "light", "moderate", "severe"]
#: Offset of pitch (or of the first coordinate) at the start of a kick. [rad or m]
KICK = 0.01
#: What the regulator that the studio designs is called.
LQR = "LQR designed here"
#: An angle of the control that counts as much as the energy that it stores in the structure at rest. [rad]
AUTHORITY = math.radians(10.0)
#: Longest flight. [s]
LONGEST = 600.0
#: Most samples kept for charts and replay.
SAMPLES = 4000


@dataclass(frozen=True, kw_only=True)
class Flight:
    """A flight to be simulated.

    Attributes
    ----------
    speed, altitude : float
        True airspeed and geopotential altitude. [m/s, m]
    duration : float
        Length of the run. [s]
    shake : str
        "kick" (a displacement at the start), "sharp" or "cosine" (gusts after 0.5 s), or a severity of turbulence.
    gust : float
        Largest velocity of the gust, up. [m/s]
    length : float
        Whole wavelength of a 1-cosine gust. [m]
    seed : int
        Of turbulence and noise.
    aero : str, optional
        Air forces; by kind of model if not given.
    controller : Path, optional
        Controller file that closes the loop.
    regulated : bool
        Whether a regulator designed at this very condition closes the loop instead.
    """

    speed: float
    altitude: float = 0.0
    duration: float = 5.0
    shake: Shake = "kick"
    gust: float = 1.0
    length: float = 20.0
    seed: int = 0
    aero: str | None = None
    controller: Path | None = None
    regulated: bool = False

    def __post_init__(self) -> None:
        """Check the numbers that are typed."""
        ranges = {
            "speed": (self.speed, 0.1, 1e4, "m/s"),
            "altitude": (self.altitude, -5e3, 8e4, "m"),
            "duration": (self.duration, 0.01, LONGEST, "s"),
            "gust": (self.gust, -1e3, 1e3, "m/s"),
            "length": (self.length, 1e-3, 1e5, "m"),
            "seed": (self.seed, 0, 2**32 - 1, "-"),
        }
        for name, (value, low, high, unit) in ranges.items():
            if not low <= value <= high:
                raise ValueError(f"{name} must be from {low:g} to {high:g} [{unit}], got {value:g}")
        if self.shake not in get_args(Shake):
            raise ValueError(f"shake must be one of {', '.join(get_args(Shake))}, got {self.shake!r}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """What came out of a flight.

    Attributes
    ----------
    name : str
        The model.
    flight : Flight
        What was simulated.
    t : ndarray, shape (n_t,)
        Times. [s]
    data : ndarray, shape (n_t, n_channel)
        Channels. [unit of each]
    channels, units : tuple of str
        Their names and units.
    peak, rms : tuple of float
        Largest magnitude and root mean square of each. [unit of each]
    facts : tuple of (str, str)
        What the run shows, in words.
    notes : tuple of str
        What to know.
    csv : bytes
        The history as a file.
    scene : str
        What the 3-D view draws, as JSON; "" where there is nothing to draw.
    """

    name: str
    flight: Flight
    t: Array
    data: Array
    channels: tuple[str, ...]
    units: tuple[str, ...]
    peak: tuple[float, ...]
    rms: tuple[float, ...]
    facts: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]
    csv: bytes
    scene: str = ""


def fly(text: str, path: Path, flight: Flight, tell: Tell, partial: Callable[[Any], None]) -> Run:
    """Simulate a flight of a model file.

    Parameters
    ----------
    text : str
        Of the file.
    path : Path
        Where it lies, or would lie.
    flight : Flight
        What happens.
    tell : callable
        Hears of progress.
    partial : callable
        Not used: a flight has no first part.

    Returns
    -------
    run : Run
        Histories and what they show. [SI]

    Raises
    ------
    ValueError
        If there is no such model, controller or flight.

    References
    ----------
    contract.md, `simulate`.

    Examples
    --------
    >>> from aeroservo.studio.draft import opened
    >>> source = opened("thesis-binary", Path("."))
    >>> run = fly(source.text, source.path, Flight(speed=30.0), lambda what, part: None, lambda result: None)
    >>> dict(run.facts)["Bounded"]
    'yes'
    """
    from aeroservo.aircraft.files import parse
    from aeroservo.simulate.engine import simulate
    from aeroservo.simulate.history import history_bytes
    from aeroservo.simulate.scenario import Stepping

    tell("building the model", 0.0)
    file = parse(text, path)
    model = _model(file, flight)
    controller, notes = _controller(model, flight, tell)
    tell("simulating", 0.1)

    def reached(t: float) -> None:
        tell(f"simulating: {min(t, flight.duration):.3g} of {flight.duration:g} s", 0.1 + 0.8 * t / flight.duration)

    stepping = Stepping(record_s=max(flight.duration / SAMPLES, 1e-3))
    found = simulate(model, _scenario(model, flight, controller), seed=flight.seed, stepping=stepping, progress=reached)
    tell("drawing", 0.9)
    history = found.history
    assert history is not None
    return Run(
        name=file.name,
        flight=flight,
        t=np.array(history.t),
        data=np.array(history.data),
        channels=history.channels,
        units=history.units,
        peak=tuple(found.peak.tolist()),
        rms=tuple(found.rms.tolist()),
        facts=_facts(found),
        notes=(*notes, *found.warnings),
        csv=history_bytes(history, ".csv"),
        scene=_scene(file, model, history, flight),
    )


def _scene(file: FileModel, model: AeroelasticModel | LinearSystem, history: TimeHistory, flight: Flight) -> str:
    """The flight in three dimensions."""
    from aeroservo.report.lattice3d import lattice3d
    from aeroservo.report.page import json_for_html
    from aeroservo.report.scene import history_data, scene_data

    if isinstance(model, LinearSystem) or not len(model.modes.grid):
        return ""
    lattice = lattice3d(file, model)
    coordinates = dict(zip(model.modes.names, _channels(model)))
    channels = {name: coordinates.get(name, f"{name}_rad") for name in lattice.names}
    shown = history_data(lattice, history, name="this run", channels=channels, speed=flight.speed)
    return json_for_html(scene_data(lattice, histories=[shown]))


def _model(file: FileModel, flight: Flight) -> AeroelasticModel | LinearSystem:
    """What is flown: with rational air forces, or the linear model itself at its own condition."""
    from aeroservo.aeroelastic.build import build
    from aeroservo.aeroelastic.flutter import P, prepared
    from aeroservo.aircraft.schema_other import StateSpaceFile

    if isinstance(file, StateSpaceFile):
        return _linear(file, flight)
    return prepared(build(file, flight.aero), P())[0]


def _linear(file: StateSpaceFile, flight: Flight) -> LinearSystem:
    m = file.model
    if (flight.speed, flight.altitude) != (m.speed_m_s, m.altitude_m):
        raise ValueError(f"{file.name} holds at {m.speed_m_s:g} m/s and {m.altitude_m:g} m only")
    return LinearSystem(A=m.A, B=m.B, C=m.C, D=m.D, states=m.states, inputs=m.inputs, outputs=m.outputs)  # type: ignore[arg-type]


def _controller(
    model: AeroelasticModel | LinearSystem, flight: Flight, tell: Tell
) -> tuple[Controller | None, tuple[str, ...]]:
    from aeroservo.control.controller import read_controller

    if flight.controller is not None:
        return read_controller(flight.controller), ()
    if not flight.regulated:
        return None, ()
    if isinstance(model, LinearSystem):
        raise ValueError("the studio designs regulators for models with a structure: give a controller file")
    tell("designing the regulator", 0.05)
    return regulator(model, FlightCondition.at(flight.altitude, V=flight.speed))


def regulator(model: AeroelasticModel, condition: FlightCondition) -> tuple[Controller, tuple[str, ...]]:
    """A linear-quadratic regulator that holds the mechanical energy of the structure against the work of its controls.

    The energy that `AUTHORITY` of each control stores in the structure at rest counts as much as that angle, so that no
    weight depends on the units of the coordinates.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces and a control.
    condition : FlightCondition
        Where it is designed: one condition.

    Returns
    -------
    controller : Controller
        Continuous; reads displacements and rates, simulates what is not measured. [SI]
    notes : tuple of str
        What to know before trusting it.

    Raises
    ------
    ValueError
        If the model has no control, or its controls have no authority there.

    References
    ----------
    B. D. O. Anderson and J. B. Moore, Optimal Control, 1990, section 3; Bramstång 2015, Eq. 6.11 with u = -K x.

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> regulator(build(read("thesis-simulation")), FlightCondition.at(0.0, V=45.0))[0].outputs
    ('elevon_rad',)
    """
    from aeroservo.control.lqr import LQR as Regulator
    from aeroservo.control.plant import design_plant

    columns = model.columns("control")
    if not columns:
        raise ValueError("the model has no control: no regulator can be designed")
    plant = design_plant(model, condition)
    q_bar, modes = float(condition.q), model.modes
    moved = np.linalg.lstsq(modes.K, q_bar * model.aero(0.0, 0.0).real[:, columns] * AUTHORITY, rcond=None)[0]
    stored = 0.5 * float(np.einsum("ij,ik,kj->", moved, modes.K, moved))
    if not stored > 0.0:
        raise ValueError(f"the controls have no authority at {float(condition.V):g} m/s: no regulator can be designed")
    displacements = _channels(model)
    rates = [_rate(name, unit) for name, unit in zip(modes.names, modes.units)]
    Q = np.zeros((len(plant.states),) * 2)
    for names, energy in ((displacements, modes.K), (rates, modes.M)):
        at = [(i, plant.states.index(name)) for i, name in enumerate(names) if name in plant.states]
        own, there = [i for i, _ in at], [j for _, j in at]
        Q[np.ix_(there, there)] = 0.5 * energy[np.ix_(own, own)] / stored
    measured = tuple(name for name in plant.states if name in (*displacements, *rates))
    design = Regulator(Q=Q, R=np.full(len(plant.inputs), 1.0 / AUTHORITY**2), measured=measured)(plant)
    gains = ", ".join(f"{k:.3g}" for k in design.K.ravel()[:8])
    return design.as_controller(), (
        *design.notes,
        f"regulator of the studio: K = {gains}{' ...' * (design.K.size > 8)}",
    )


def _rate(name: str, unit: str) -> str:
    """Channel of the rate of a displacement."""
    return f"{name.replace(' ', '_')}_rate_{unit}_s" if unit else f"{name.replace(' ', '_')}_rate_1_s"


def _scenario(model: AeroelasticModel | LinearSystem, flight: Flight, controller: Controller | None) -> Scenario:
    from aeroservo.simulate.disturbances import CosineGust, Gustiness, SharpGust
    from aeroservo.simulate.profiles import level
    from aeroservo.simulate.scenario import Scenario

    gusts: dict[str, Any] = {
        "sharp": lambda: SharpGust(amplitude=flight.gust, start=0.5),
        "cosine": lambda: CosineGust(amplitude=flight.gust, length=flight.length, start=0.5),
    }
    shake = flight.shake
    return Scenario(
        profile=level(flight.speed, altitude=flight.altitude),
        duration=flight.duration,
        controller=controller,
        gusts=(gusts[shake](),) if shake in gusts else (),
        turbulence=None if shake in gusts or shake == "kick" else Gustiness(level=shake),  # type: ignore[arg-type]
        initial=((_first(model), KICK),) if shake == "kick" else (),
    )


def _first(model: AeroelasticModel | LinearSystem) -> str:
    """Pitch where there is one, else the first displacement."""
    if isinstance(model, LinearSystem):
        return "pitch_rad" if "pitch_rad" in model.states else model.states[0]
    names = _channels(model)
    return "pitch_rad" if "pitch_rad" in names else names[0]


def _channels(model: AeroelasticModel) -> list[str]:
    """Channels of the displacements, in the order of the modes."""
    return [f"{n.replace(' ', '_')}{'_' * bool(u)}{u}" for n, u in zip(model.modes.names, model.modes.units)]


def _facts(found: Simulation) -> tuple[tuple[str, str], ...]:
    """What the run shows, in words."""
    facts = [("Bounded", "yes" if found.bounded else "no")]
    if found.growth is not None:
        facts.append(("Growth of the envelope", f"{found.growth:.4g} 1/s"))
    if found.limit_cycle is not None:
        c = found.limit_cycle
        facts.append(("Limit cycle", f"amplitude {c.amplitude:.4g} at {c.frequency_Hz:.4g} Hz"))
    if found.limit_left is not None:
        facts.append(("Limit left", f"{found.limit_left.channel} at {found.limit_left.at_s:.4g} s"))
    if found.overflow_at is not None:
        facts.append(("Ran away", f"stopped at {found.overflow_at:.4g} s"))
    step = "exact steps" if found.method == "exact" else f"{found.substeps} Runge-Kutta steps in each"
    facts.append(("Steps", f"{1e3 * found.dt:g} ms, {step}"))
    return tuple(facts)
