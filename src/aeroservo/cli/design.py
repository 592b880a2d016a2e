"""The command `design`. Over budget because a command's options are its signature."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aeroservo.cli.analyses import state_space_system
from aeroservo.cli.loaded import air, altitude_of, load, rational, tell
from aeroservo.cli.options import (
    Aero,
    Altitude,
    Density,
    FitBound,
    Json,
    Model,
    checked_bound,
    checked_output,
    condition_of,
    sweep_of,
)
from aeroservo.cli.output import complain, heading, number, print_json, table, write, write_json

if TYPE_CHECKING:
    from collections.abc import Callable

    from aeroservo.control.controller import Controller
    from aeroservo.control.design import Design
    from aeroservo.control.synthesis import Synthesis
    from aeroservo.datatypes import AeroelasticModel, FlightCondition, LinearSystem


class DesignMethod(StrEnum):
    """Words of `--method`."""

    lqr = "lqr"
    lqi = "lqi"
    lqg = "lqg"
    pid = "pid"
    poles = "poles"


MOST_POINTS = 400
"""Most points of a schedule: each has its margins computed."""

SHOWN = 24
"""States and roots that are printed for people."""

Method = Annotated[DesignMethod, typer.Option("--method", help="Kind of controller.")]
Speed = Annotated[float | None, typer.Option("--speed", metavar="M_S", help="True airspeed, m/s.")]
Row = Annotated[
    str | None, typer.Option("--speeds", metavar="MIN:MAX:STEP", help="A schedule over these speeds instead.")
]
Q = Annotated[
    str | None,
    typer.Option("--q", metavar="LIST", help="State weights in the order of `states` (zeros follow), or NAME=WEIGHT."),
]
R = Annotated[str | None, typer.Option("--r", metavar="LIST", help="Input weights (default 1 each).")]
Sensors = Annotated[
    str | None,
    typer.Option("--sensors", metavar="NAMES", help="What is measured (lqg, pid), or the states that are read."),
]
Rate = Annotated[float | None, typer.Option("--rate", metavar="HZ", help="Sample rate (default: continuous).")]
DelaySamples = Annotated[float, typer.Option("--delay-samples", metavar="N", help="Computing delay, samples.")]
Actuators = Annotated[bool, typer.Option("--actuator/--no-actuator", help="Actuators inside the plant.")]
Integrals = Annotated[
    str | None, typer.Option("--integrals", metavar="NAMES", help="lqi: outputs that are integrated.")
]
QIntegrals = Annotated[
    str | None, typer.Option("--q-integrals", metavar="LIST", help="lqi: their weights (default 1 each).")
]
Leak = Annotated[float, typer.Option("--leak", metavar="1_S", help="lqi: rate at which integrals forget.")]
GustNoise = Annotated[
    float, typer.Option("--gust-noise", metavar="M_S", help="lqg: standard deviation of the gust, m/s.")
]
W = Annotated[
    str | None,
    typer.Option("--w", metavar="LIST", help="lqg: standard deviations of further noise on the states, as --q."),
]
V = Annotated[
    str | None,
    typer.Option(
        "--v", metavar="LIST", help="lqg: standard deviations of the sensors, SI (default: their noise, or by unit)."
    ),
]
Recovery = Annotated[
    float, typer.Option("--recovery", metavar="DEG", help="lqg: loop-transfer recovery, command noise.")
]
Gain = Annotated[float, typer.Option("--kp", help="pid: gain on the sensor.")]
IntegralGain = Annotated[float, typer.Option("--ki", help="pid: gain on its integral.")]
DerivativeGain = Annotated[float, typer.Option("--kd", help="pid: gain on its derivative.")]
Derivative = Annotated[
    float, typer.Option("--derivative", metavar="RAD_S", help="pid: where the derivative rolls off.")
]
Filters = Annotated[
    list[str] | None,
    typer.Option(
        "--filter",
        metavar="FILTER",
        help="pid: lowpass:RAD_S, notch:RAD_S:DEPTH:DAMPING or phase:RAD_S:DEG on the sensor; repeatable.",
    ),
]
Poles = Annotated[
    str | None, typer.Option("--poles", metavar="LIST", help="poles: wanted roots, 1/s, as -5+3j,-5-3j,-20.")
]
LimitDeg = Annotated[
    float | None, typer.Option("--limit-deg", metavar="DEG", help="Largest command (default: the actuator's).")
]
Out = Annotated[
    Path | None, typer.Option("--out", metavar="FILE", help="Write the controller: .json (for --controller), .mat, .c.")
]


@dataclass(frozen=True, kw_only=True)
class Wishes:
    """What the options of `design` say about the controller.

    Attributes
    ----------
    method : DesignMethod
        Kind of controller.
    q, r, sensors, integrals, q_integrals, w, v, poles : str, optional
        Lists as typed.
    leak, gust_noise, recovery_deg : float
        Numbers of lqi and lqg. [1/s, m/s, deg]
    kp, ki, kd, derivative : float
        Numbers of pid. [SI]
    filters : tuple of str
        As typed.
    """

    method: DesignMethod
    q: str | None
    r: str | None
    sensors: str | None
    integrals: str | None
    q_integrals: str | None
    w: str | None
    v: str | None
    poles: str | None
    leak: float
    gust_noise: float
    recovery_deg: float
    kp: float
    ki: float
    kd: float
    derivative: float
    filters: tuple[str, ...]


def design(
    model: Model,
    *,
    method: Method,
    speed: Speed = None,
    speeds: Row = None,
    q: Q = None,
    r: R = None,
    sensors: Sensors = None,
    rate: Rate = None,
    delay_samples: DelaySamples = 0.0,
    actuator: Actuators = True,
    integrals: Integrals = None,
    q_integrals: QIntegrals = None,
    leak: Leak = 0.0,
    gust_noise: GustNoise = 0.1,
    w: W = None,
    v: V = None,
    recovery: Recovery = 0.0,
    kp: Gain = 0.0,
    ki: IntegralGain = 0.0,
    kd: DerivativeGain = 0.0,
    derivative: Derivative = 100.0,
    filter: Filters = None,
    poles: Poles = None,
    limit_deg: LimitDeg = None,
    altitude: Altitude = None,
    density: Density = None,
    aero: Aero = None,
    fit_bound: FitBound = 0.01,
    out: Out = None,
    as_json: Json = False,
) -> None:
    """Print a controller, its closed loop and its margin; write it.

    Parameters
    ----------
    model : str
        Preset or path.
    method : DesignMethod
        Kind of controller.
    speed : float, optional
        True airspeed. [m/s]
    speeds : str, optional
        MIN:MAX:STEP of a schedule. [m/s]
    q, r : str, optional
        Weights.
    sensors : str, optional
        What is measured.
    rate : float, optional
        Sample rate. [Hz]
    delay_samples : float
        Computing delay. [sample]
    actuator : bool
        Whether actuators are inside.
    integrals, q_integrals : str, optional
        Of lqi.
    leak : float
        Of lqi. [1/s]
    gust_noise : float
        Of lqg. [m/s]
    w, v : str, optional
        Of lqg.
    recovery : float
        Of lqg. [deg]
    kp, ki, kd, derivative : float
        Of pid. [SI]
    filter : list of str, optional
        Of pid.
    poles : str, optional
        Of poles.
    limit_deg : float, optional
        Largest command. [deg]
    altitude, density : float, optional
        Of the air. [m, kg/m^3]
    aero : AeroTheory, optional
        Air forces; samples are fitted first.
    fit_bound : float
        Largest error of that fit. [-]
    out : Path, optional
        Where the controller goes.
    as_json : bool
        As JSON.

    Raises
    ------
    ValueError
        For bad input.
    """
    checked_output(out, (".json", ".mat", ".c"), "--out")
    checked_bound(fit_bound)
    wishes = Wishes(
        method=method, q=q, r=r, sensors=sensors, integrals=integrals, q_integrals=q_integrals, w=w, v=v, poles=poles,
        leak=leak, gust_noise=gust_noise, recovery_deg=recovery, kp=kp, ki=ki, kd=kd, derivative=derivative,
        filters=tuple(filter or ()),
    )  # fmt: skip
    _checked(wishes, rate, delay_samples, limit_deg, speeds, out)
    limits = None if limit_deg is None else (math.radians(limit_deg),)
    head, V, found = _found(
        model, wishes, speed, speeds, rate, delay_samples, actuator, limits, altitude, density, aero, fit_bound
    )
    notes = (*head["warnings"], *found.design.notes, *_unstable(V, found))
    head["warnings"] = list(notes)
    tell(notes)
    content = head | _content(method, V, found)
    if out is not None:
        _write(out, found.controller)
    if as_json:
        print_json(content)
        return
    _print(head, V, found)


def _checked(
    wishes: Wishes, rate: float | None, delay: float, limit_deg: float | None, speeds: str | None, out: Path | None
) -> None:
    """Refuse options that do not go together before any work is done."""
    m = wishes.method
    if rate is not None and not 0.1 <= rate <= 1e6:
        raise ValueError(f"--rate must lie from 0.1 to 1e6 [Hz], got {rate:g}")
    if not 0.0 <= delay <= 100.0:
        raise ValueError(f"--delay-samples must be from 0 to 100 [sample], got {delay:g}")
    if delay and rate is None:
        raise ValueError("--delay-samples needs --rate HZ: a continuous controller has no samples")
    if limit_deg is not None and not 0.0 < limit_deg < math.inf:
        raise ValueError(f"--limit-deg must be positive [deg], got {limit_deg:g}")
    if rate is None and (limit_deg is not None or speeds is not None or (out is not None and out.suffix == ".c")):
        raise ValueError("--limit-deg, --speeds and --out FILE.c belong to a sampled controller: give --rate HZ")
    own: dict[str, tuple[bool, tuple[str, ...]]] = {
        "--q": (wishes.q is not None, ("lqr", "lqi", "lqg")),
        "--r": (wishes.r is not None, ("lqr", "lqi", "lqg")),
        "--integrals": (wishes.integrals is not None, ("lqi",)),
        "--q-integrals": (wishes.q_integrals is not None, ("lqi",)),
        "--leak": (bool(wishes.leak), ("lqi",)),
        "--w": (wishes.w is not None, ("lqg",)),
        "--v": (wishes.v is not None, ("lqg",)),
        "--recovery": (bool(wishes.recovery_deg), ("lqg",)),
        "--kp, --ki, --kd": (bool(wishes.kp or wishes.ki or wishes.kd), ("pid",)),
        "--filter": (bool(wishes.filters), ("pid",)),
        "--poles": (wishes.poles is not None, ("poles",)),
    }
    for option, (given, methods) in own.items():
        if given and m.value not in methods:
            raise ValueError(f"{option} belongs to --method {' or '.join(methods)}, not to {m.value}")
    needs = {"lqi": ("--integrals", wishes.integrals), "poles": ("--poles", wishes.poles)}
    if m.value in needs and needs[m.value][1] is None:
        raise ValueError(f"--method {m.value} needs {needs[m.value][0]}")
    if m is DesignMethod.pid and not (wishes.kp or wishes.ki or wishes.kd):
        raise ValueError("--method pid needs a gain: --kp, --ki or --kd")
    if m is DesignMethod.pid and (wishes.sensors is None or "," in wishes.sensors):
        raise ValueError("--method pid feeds back one sensor: --sensors NAME")


def _found(
    model: str,
    wishes: Wishes,
    speed: float | None,
    speeds: str | None,
    rate: float | None,
    delay: float,
    actuator: bool,
    limits: tuple[float, ...] | None,
    altitude: float | None,
    density: float | None,
    aero: Any,
    fit_bound: float,
) -> tuple[dict[str, Any], list[float], Synthesis]:
    """Heading, speeds and the design."""
    from aeroservo.aircraft.files import read
    from aeroservo.aircraft.schema_other import StateSpaceFile
    from aeroservo.control.design import with_state_outputs
    from aeroservo.control.synthesis import synthesise, synthesise_system

    file = read(model)
    read_states = wishes.method in (DesignMethod.lqr, DesignMethod.lqi, DesignMethod.poles)
    if isinstance(file, StateSpaceFile):
        if speeds is not None or aero is not None or density is not None or not actuator:
            raise ValueError(f"{file.name}: a state_space model has no --speeds, --aero, --density or --no-actuator")
        system, speed, height = state_space_system(file, speed, altitude)
        system = with_state_outputs(system) if read_states else _measured(system, wishes)
        head = heading(file.name, height, float(condition_of(height, None, speed).rho), file.problems())
        made = _design(wishes, system.outputs)
        found = synthesise_system(system, made, rate_Hz=rate, delay_samples=delay, limits=limits or ())
        return head, [speed], found
    if (speed is None) == (speeds is None):
        raise ValueError("give --speed M_S, or --speeds MIN:MAX:STEP for a schedule, one of them")
    at = condition_of(altitude, density, sweep_of(file, speeds) if speed is None else speed)
    if at.V.ndim and not 2 <= at.V.size <= MOST_POINTS:
        raise ValueError(f"--speeds: a schedule has 2 to {MOST_POINTS} points, got {at.V.size}")
    _, built, notes = load(model, aero)
    aeroelastic = rational(built, fit_bound)
    sensors = None if read_states else _sensors(wishes, aeroelastic)
    made = _design(wishes, sensors or ())
    found = synthesise(
        aeroelastic, made, at, rate_Hz=rate, delay_samples=delay, actuators=actuator, sensors=sensors, limits=limits
    )
    if at.V.ndim:
        notes = (*notes, *_between(aeroelastic, found.controller, at))
    density_now = float(at.rho.flat[0])
    head = heading(file.name, altitude_of(altitude, density), density_now, notes)
    return head, [float(x) for x in at.V.reshape(-1)], found


def _between(model: AeroelasticModel, controller: Controller, at: FlightCondition) -> tuple[str, ...]:
    """A warning where the schedule is unstable between its points."""
    from aeroservo.control.schedule import schedule_check

    check = schedule_check(model, controller, at)
    complain(f"between the points: {check.sentence()}")
    return () if check.stable else (f"between the points: {check.sentence()}",)


def _sensors(wishes: Wishes, model: AeroelasticModel) -> tuple[str, ...]:
    """Sensors by name: those asked for, or all that the model has."""
    if wishes.sensors is not None:
        return tuple(_words(wishes.sensors, "--sensors"))
    if not model.sensors:
        raise ValueError(
            "the model has no sensors: add [[sensor]] to its file, or name channels with --sensors "
            "(pitch_rate_rad_s is an ideal gyro)"
        )
    return tuple(sensor.name for sensor in model.sensors)


def _measured(system: LinearSystem, wishes: Wishes) -> LinearSystem:
    """A linear model with the outputs, or states, that are measured."""
    from aeroservo.control.design import with_state_outputs
    from aeroservo.control.plant import chosen

    if wishes.sensors is None:
        raise ValueError(f"a state_space model needs --sensors, out of {', '.join((*system.states, *system.outputs))}")
    names = _words(wishes.sensors, "--sensors")
    return chosen(system if set(names) <= set(system.outputs) else with_state_outputs(system), outputs=names)


def _design(wishes: Wishes, sensors: tuple[str, ...]) -> Callable[[LinearSystem], Design]:
    """From a plant to its design, by the options; lists are read when the plant's names are known."""

    def made(plant: LinearSystem) -> Design:
        from aeroservo.control import lqg, lqi, lqr, pid
        from aeroservo.control import poles as placement
        from aeroservo.control.design import controls

        u = controls(plant)
        measured = None if wishes.sensors is None else tuple(_words(wishes.sensors, "--sensors"))
        if wishes.method is DesignMethod.poles:
            return placement.PolePlacement(poles=_complex(wishes.poles or ""), measured=measured)(plant)  # type: ignore[arg-type]
        if wishes.method is DesignMethod.pid:
            return pid.PID(
                channel=u.outputs[0], kp=wishes.kp, ki=wishes.ki, kd=wishes.kd, derivative_rad_s=wishes.derivative,
                filters=tuple(_filter(text) for text in wishes.filters),
            )(plant)  # fmt: skip
        if wishes.q is None:
            raise ValueError(f"--method {wishes.method.value} needs --q, weights of the states {', '.join(u.states)}")
        Q: Any = _weights(wishes.q, u.states, "--q")
        R: Any = [1.0] * len(u.inputs) if wishes.r is None else _weights(wishes.r, u.inputs, "--r", whole=True)
        if wishes.method is DesignMethod.lqr:
            return lqr.LQR(Q=Q, R=R, measured=measured)(plant)
        if wishes.method is DesignMethod.lqi:
            names = tuple(_words(wishes.integrals or "", "--integrals"))
            given = [1.0] * len(names)
            if wishes.q_integrals is not None:
                given = _weights(wishes.q_integrals, names, "--q-integrals", whole=True)
            return lqi.LQI(
                Q=Q, R=R, integrals=names, Q_integrals=given, leak=wishes.leak, measured=measured  # type: ignore[arg-type]
            )(plant)  # fmt: skip
        W: Any = None if wishes.w is None else [x * x for x in _weights(wishes.w, u.states, "--w")]
        V: Any = None if wishes.v is None else [x * x for x in _weights(wishes.v, u.outputs, "--v", whole=True)]
        return lqg.LQG(
            Q=Q, R=R, gust=wishes.gust_noise, W=W, V=V, recovery=math.radians(wishes.recovery_deg)
        )(plant)  # fmt: skip

    return made


def _words(text: str, option: str) -> list[str]:
    """Names of a list with commas."""
    words = [word.strip() for word in text.split(",")]
    if not all(words):
        raise ValueError(f"{option} = {text[:80]!r} must be names with commas between them")
    return words


def _weights(text: str, names: tuple[str, ...], option: str, *, whole: bool = False) -> list[float]:
    """Numbers of a list, in order or by name; zeros follow unless all are wanted."""
    words, found = _words(text, option), [0.0] * len(names)
    if all("=" in word for word in words):
        for word in words:
            name, value = word.split("=", 1)
            if name.strip() not in names:
                raise ValueError(f"{option}: {name.strip()[:60]!r} does not exist; there are {', '.join(names)}")
            found[names.index(name.strip())] = _number(value, option)
        return found
    values = [_number(word, option) for word in words]
    if len(values) > len(names) or (whole and len(values) != len(names)):
        most = "" if whole else "at most "
        raise ValueError(f"{option} has {len(values)} values and must have {most}{len(names)}: {', '.join(names)}")
    return values + found[len(values) :]


def _number(text: str, option: str) -> float:
    """A finite number that is not negative."""
    try:
        value = float(text)
    except ValueError:
        raise ValueError(f"{option}: {text[:40]!r} is no number") from None
    if not 0.0 <= value < math.inf:
        raise ValueError(f"{option}: values must be finite and not negative, got {value:g}")
    return value


def _complex(text: str) -> list[complex]:
    """Complex numbers of a list."""
    found = []
    for word in _words(text, "--poles"):
        try:
            found.append(complex(word.replace(" ", "").replace("i", "j")))
        except ValueError:
            raise ValueError(f"--poles: {word[:40]!r} is no number such as -5 or -5+3j") from None
    return found


def _filter(text: str) -> Any:
    """A filter from its words."""
    from aeroservo.control.filters import LowPass, Notch, PhaseFilter

    kind, *words = text.split(":")
    counts = {"lowpass": 1, "notch": 3, "phase": 2}
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = []
    if kind not in counts or len(values) != counts[kind]:
        raise ValueError(f"--filter {text[:80]!r} must be lowpass:RAD_S, notch:RAD_S:DEPTH:DAMPING or phase:RAD_S:DEG")
    if kind == "lowpass":
        return LowPass(corner=values[0])
    if kind == "notch":
        return Notch(frequency=values[0], depth=values[1], damping=values[2])
    return PhaseFilter(frequency=values[0], phase=math.radians(values[1]))


def _unstable(V: list[float], found: Synthesis) -> tuple[str, ...]:
    """A warning where the loop is not stable."""
    bad = [v for v, margin in zip(V, found.margins) if not margin.stable]
    return (f"the closed loop is unstable at {', '.join(f'{v:g}' for v in bad[:5])} m/s",) if bad else ()


def _content(method: DesignMethod, V: list[float], found: Synthesis) -> dict[str, Any]:
    """JSON of the contract; of a schedule every value is a list over its points."""
    d, c = found.design, found.controller
    one = len(V) == 1 and d.K.ndim == 2
    alpha = [margin.alpha for margin in found.margins]
    return {
        "method": method.value,
        "speed_m_s": V[0] if one else V,
        "states": d.states,
        "inputs": c.outputs,
        "measured": c.inputs,
        "K": d.K if d.states else None,
        "closed_loop_eigenvalues": d.closed_loop_eigenvalues,
        "residual": d.residual,
        "disk_margin_alpha": alpha[0] if one else alpha,
        "dt_s": c.dt_s,
        "delay_s": c.delay_s,
        "dynamic_pressure_Pa": None if one else c.pressures,
    }


def _write(path: Path, controller: Controller) -> None:
    """The controller as JSON, .mat or C99."""
    from aeroservo.control.controller import controller_content

    if path.suffix.lower() == ".json":
        write_json(path, controller_content(controller))
    elif path.suffix.lower() == ".mat":
        write(path, _matlab(controller))
    else:
        from aeroservo.control.export_c import c_source

        write(path, c_source(controller).encode())


def _matlab(controller: Controller) -> bytes:
    """Matrices and names as the content of a .mat file; the last axis runs over the points of a schedule."""
    from numpy import array, moveaxis
    from scipy.io import savemat

    content = {n: moveaxis(getattr(controller, n), 0, -1) for n in (*"ABCD", "windup")}
    if len(controller.pressures) == 1:
        content = {name: value[..., 0] for name, value in content.items()}
    names = {what: array(getattr(controller, what), dtype=object) for what in ("inputs", "outputs")}
    rest = {
        "dt_s": array([]) if controller.dt_s is None else controller.dt_s,
        "delay_s": controller.delay_s,
        "limits": array(controller.limits),
        "dynamic_pressure_Pa": controller.pressures,
    }
    file = BytesIO()
    savemat(file, content | names | rest)
    return file.getvalue()


def _print(head: dict[str, Any], V: list[float], found: Synthesis) -> None:
    """For people."""
    d, c = found.design, found.controller
    rate = "continuous" if c.dt_s is None else f"{1.0 / c.dt_s:g} Hz, delay {1e3 * c.delay_s:g} ms"
    typer.echo(f"{head['model']}: {d.method} at {air(head)}, {rate}")
    typer.echo(f"reads {', '.join(c.inputs)}; drives {', '.join(c.outputs)}")
    if len(V) > 1:
        points = [
            (v, float(q), float(margin.alpha), *_margins(margin.alpha), float(residual))
            for v, q, margin, residual in zip(V, c.pressures, found.margins, d.residual)
        ]
        typer.echo(table(points, ("V, m/s", "q, Pa", "disk margin", "gain, dB", "phase, deg", "residual")))
        return
    if d.states:
        rows = [(name, *map(float, d.K[:, i])) for i, name in enumerate(d.states)][:SHOWN]
        typer.echo(table(rows, ("state", *(f"K to {name}" for name in c.outputs))))
        if len(d.states) > SHOWN:
            typer.echo(f"and {len(d.states) - SHOWN} more states: --json has them all")
    plane = "s, 1/s" if c.dt_s is None else "z"
    roots = sorted(d.closed_loop_eigenvalues.tolist(), key=lambda s: (-s.real, s.imag))
    shown = [_root(s) for s in roots if s.imag >= 0.0]
    more = f" and {len(shown) - SHOWN} more" if len(shown) > SHOWN else ""
    typer.echo(f"closed-loop roots ({plane}): {', '.join(shown[:SHOWN])}{more}")
    alpha = found.margins[0].alpha
    gain, phase = _margins(alpha)
    typer.echo(
        f"disk margin alpha {number(alpha, digits=4)} at {V[0]:g} m/s: gain {gain:.3g} dB, phase {phase:.3g} deg"
    )
    typer.echo(f"residual {float(d.residual):.1e}")


def _margins(alpha: float) -> tuple[float, float]:
    """Gain [dB] and phase [deg] that a balanced disk margin allows in every channel at once."""
    gain = math.inf if alpha >= 2.0 else 20.0 * math.log10((2.0 + alpha) / (2.0 - alpha))
    return gain, math.degrees(2.0 * math.atan(0.5 * alpha))


def _root(value: complex) -> str:
    """A root, or a pair, in words."""
    if abs(value.imag) < 1e-9 * max(1.0, abs(value)):
        return f"{value.real:.6g}"
    return f"{value.real:.6g} ± {abs(value.imag):.6g}i"
