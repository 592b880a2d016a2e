"""Parts on control: the design and its margins, time histories, the live panel."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.control.closed_flutter import closed_flutter
from aeroservo.control.closed_loop import as_rates, at_rate, closed_loop, loop_plant
from aeroservo.control.controller import Controller
from aeroservo.control.disk_margins import DiskMargin, disk_margin
from aeroservo.control.margins import LoopMargin, loop_margins
from aeroservo.datatypes import FlightCondition, LinearSystem
from aeroservo.report.blocks import Block, Chart, Failed, LivePanel, Mark, Part, Prose, Series, Table
from aeroservo.report.case_marks import bands, drawn, marks, range_of, thinned, words
from aeroservo.report.lattice3d import Lattice3D, lattice3d
from aeroservo.report.live import live_data
from aeroservo.report.scene import history_data, scene_data
from aeroservo.structure.modal import tip_motion
from aeroservo.studies.aircraft_report import GUST_ANGLE, ReportCase, Run

Array = NDArray[Any]

#: Speeds at which the loop is closed and its margins are taken.
MARGIN_SPEEDS = 17
#: Disk margin that holds 45 degrees of phase. [-]
SIX_DB = 2.0 * math.tan(math.pi / 8.0)
#: Samples of a channel that a chart draws.
MOST_SAMPLES = 1500


def control_part(case: ReportCase) -> Part:
    """The regulator that the report designs (or the user's controller), its loop and its margins over airspeed.

    Parameters
    ----------
    case : ReportCase
        The model.

    Returns
    -------
    part : Part
        Or why there is none.
    """
    theirs = case.options.controller
    if theirs is None and not case.controllable:
        return Part(title="Control", anchor="control", blocks=(Failed(why=_uncontrolled(case)),))
    V = _speeds(case)
    loops = [_loop(case, v) for v in V]
    pressures = 0.5 * case.rho * V**2
    disks = [disk_margin(plant, c, pressure=float(q)) for (plant, c), q in zip(loops, pressures)]
    blocks: list[Block] = [Prose(text=_words(case))]
    if theirs is None:
        blocks += _gains(case)
    blocks += _growth(case, V, loops)
    blocks.append(
        Chart(
            series=(Series(name="disk margin α", x=V, y=np.array([d.alpha for d in disks])),),
            x_label="true airspeed V, m/s",
            y_label="balanced disk margin α, -",
            title="Disk margin against airspeed",
            caption="Gain and phase may change together inside the disk: α = 0.83 holds 45° of phase and 6 dB of gain; "
            "0 is an unstable loop. All inputs of the plant at once.",
            y_range=(0.0, 2.05),
            marks=(
                *marks(case, "flutter", "divergence"),
                Mark(at=SIX_DB, text="45° and 6 dB", kind="limit", axis="y"),
            ),
        )
    )
    blocks.append(_margin_table(case, V, loops, disks))
    if theirs is not None:
        blocks.append(_closed_boundaries(case, theirs))
    return Part(title="Control", anchor="control", blocks=tuple(blocks))


def _uncontrolled(case: ReportCase) -> str:
    if case.model.columns("control"):
        return "the modes have no grid, by which the report's regulator weighs motion: give a controller (--controller)"
    return "the model has no control to move"


def _words(case: ReportCase) -> str:
    if case.options.controller is not None:
        return f"The controller of {case.options.controller_name} closes the loop."
    family = case.family
    names = ", ".join(name.removesuffix("_rad").replace("_", " ") for name in family.inputs[: family.controls])
    return (
        f"A linear-quadratic regulator, sampled at {case.rate:g} Hz, moves {names}. It weighs the motion's energy: "
        "the first mode at a tip deflection of 2 % of the span is worth 10° of control. Its gains are designed at "
        f"{len(family.pressures)} dynamic pressures and blended between them. It takes every state as measured, lags "
        "of the air included: the best that feedback can do, not yet a flight controller; `aeroservo design` makes "
        "those, and `aeroservo report --controller FILE` reports on them."
    )


def _speeds(case: ReportCase) -> Array:
    if case.options.controller is None:
        return np.linspace(float(case.family.V[0]), float(case.family.V[-1]), MARGIN_SPEEDS)
    V = case.sweep.V
    top = min(float(V[-1]), 1.5 * (case.onset or float(V[-1])))
    return np.linspace(max(float(V[0]), 0.2 * top), top, MARGIN_SPEEDS)


def _loop(case: ReportCase, V: float) -> tuple[LinearSystem, Controller]:
    """Plant and controller at a speed."""
    theirs = case.options.controller
    if theirs is None:
        return case.plant(V), case.regulator(V)
    condition = FlightCondition(V=np.asarray(V), rho=np.asarray(case.rho), a_sound=np.asarray(case.a_sound))
    return loop_plant(case.rational, condition, theirs), theirs


def _growth(case: ReportCase, V: Array, loops: list[tuple[LinearSystem, Controller]]) -> list[Block]:
    """Largest real part of the roots, loop open and closed."""
    opened, closed = [], []
    for v, (plant, controller) in zip(V, loops):
        pressure = 0.5 * case.rho * v * v
        held = at_rate(plant, controller)
        loop = closed_loop(held, controller, pressure=pressure)
        opened.append(_largest(held))
        closed.append(_largest(loop))
    both = (Series(name="loop open", x=V, y=np.array(opened)), Series(name="loop closed", x=V, y=np.array(closed)))
    return [
        Chart(
            series=both, x_label="true airspeed V, m/s", y_label="largest growth rate Re λ, 1/s",
            title="Growth with the loop open and closed", marks=marks(case, "flutter", "divergence"), bands=bands(case),
            x_range=(float(V[0]), float(V[-1])), y_range=range_of([s.y for s in both], low=-50.0, high=100.0),
            caption="Below zero the slowest motion dies away. Shaded: where the wing alone is unstable.",
        )
    ]  # fmt: skip


def _largest(system: LinearSystem) -> float:
    values = np.linalg.eigvals(system.A)
    rates = values if system.dt is None else as_rates(values, system.dt)
    return float(np.max(rates.real))


def _gains(case: ReportCase) -> list[Block]:
    """The largest gains over dynamic pressure."""
    family = case.family
    K = family.K[:, 0, :]
    effect = np.abs(K).max(axis=0)
    size = [n for n, s in enumerate(family.states) if not s.startswith("lag")]
    shown = sorted(size, key=lambda n: -effect[n])[:6]
    series = tuple(Series(name=family.states[n], x=family.pressures, y=K[:, n]) for n in sorted(shown))
    return [
        Chart(
            series=series, x_label="dynamic pressure, Pa", y_label="gain K, rad per unit of the state",
            title="Gains of the schedule",
            caption=f"u = −K x for {family.inputs[0]}; the largest ones without those of the air's lags. Smooth gains "
            "can be blended.",
        )
    ]  # fmt: skip


def _margin_table(
    case: ReportCase, V: Array, loops: list[tuple[LinearSystem, Controller]], disks: list[DiskMargin]
) -> Table:
    """Loop margins at a few speeds."""
    rows = []
    for k in np.unique(np.linspace(0, len(V) - 1, 7).round().astype(int)):
        plant, controller = loops[k]
        pressure = 0.5 * case.rho * float(V[k]) ** 2
        m: LoopMargin = loop_margins(plant, controller, pressure=pressure)[0]
        rows.append(
            (
                float(V[k]),
                "yes" if m.stable else "no",
                _decibel(m.gain_down),
                _decibel(m.gain_up),
                None if m.phase is None or math.isinf(m.phase) else math.degrees(m.phase),
                None if m.delay_s is None or math.isinf(m.delay_s) else 1e3 * m.delay_s,
                disks[k].alpha,
            )
        )
    return Table(
        columns=("V, m/s", "stable", "gain down, dB", "gain up, dB", "phase, °", "delay, ms", "disk α"),
        rows=tuple(rows),
        title="Margins of the first control's loop",
        caption="Cut at the input of the plant, sampling inside. A dash: the gain or phase may change at will, or the "
        "loop is unstable.",
    )


def _decibel(factor: float | None) -> float | None:
    return None if factor is None or factor <= 0.0 or math.isinf(factor) else 20.0 * math.log10(factor)


def _closed_boundaries(case: ReportCase, controller: Controller) -> Table:
    """Unstable speeds of the closed loop."""
    found = closed_flutter(case.model, case.sweep, controller)
    rows = tuple((i.kind, i.mode, i.start, i.end) for i in found.intervals)
    return Table(
        columns=("kind", "mode", "from, m/s", "to, m/s"),
        rows=rows,
        title="Unstable speeds with the loop closed",
        caption="None in the sweep." if not rows else "A dash is an end of the sweep.",
    )


def simulation_part(case: ReportCase) -> Part:
    """Time histories, and the wing moving in them.

    Parameters
    ----------
    case : ReportCase
        The model.

    Returns
    -------
    part : Part
        A scene and charts.
    """
    runs = case.runs
    blocks: list[Block] = [
        drawn(
            case,
            lambda lattice: scene_data(lattice, histories=[_replay(case, lattice, run) for run in runs]),
            title="Replay",
            caption="Press Play: the green sheet is the gust, its height the upward velocity, moving aft with the air. "
            "Motion is enlarged as the slider says; the clock is slowed.",
        )
    ]
    for run in runs:
        blocks += _tip(case, run)
        blocks += _charts(run)
        notes = list(run.found.warnings)
        if run.found.overflow_at is not None:
            notes.append(f"the response ran away: stopped at {run.found.overflow_at:.4g} s")
        if run.found.limit_left is not None:
            left = run.found.limit_left
            notes.append(f"{left.channel} left its limit at {left.at_s:.4g} s: the run ends there")
        cycle = run.found.limit_cycle
        if cycle is not None:
            notes.append(f"a limit cycle of amplitude {cycle.amplitude:.4g} at {cycle.frequency_Hz:.4g} Hz remains")
        blocks += [Prose(text=f"{run.name}: {note}", kind="note") for note in notes]
    return Part(title="Simulations", anchor="simulations", blocks=tuple(blocks))


def _coordinates(case: ReportCase, run: Run) -> dict[str, str]:
    """Channel of each coordinate and control that moves."""
    modes, channels = case.model.modes, run.found.history.channels if run.found.history else ()
    out = {}
    for name, unit in zip(modes.names, modes.units):
        channel = name.replace(" ", "_") + (f"_{unit}" if unit else "")
        if channel in channels:
            out[name] = channel
    for j in case.model.columns("control"):
        name = case.model.aero.inputs[j].name
        found = next((c for c in (f"{name}_rad", f"{name}_command_rad") if c in channels), None)
        if found is not None:
            out[name] = found
    return out


def _replay(case: ReportCase, lattice: Lattice3D, run: Run) -> dict[str, Any]:
    assert run.found.history is not None
    return history_data(
        lattice,
        run.found.history,
        name=run.name,
        channels=_coordinates(case, run),
        speed=run.V,
        rate=float(np.clip(0.7 / case.frequency, 0.003, 1.0)),
    )


def _tip(case: ReportCase, run: Run) -> list[Block]:
    """Deflection and twist of the tip, where coordinates are modes without a unit."""
    h, modes = run.found.history, case.model.modes
    if h is None or any(modes.units) or not len(modes.grid):
        return []
    plunge, twist = tip_motion(modes)
    moving = [(j, name.replace(" ", "_")) for j, name in enumerate(modes.names) if name.replace(" ", "_") in h.channels]
    part = thinned(len(h.t), MOST_SAMPLES)
    up = -sum(plunge[j] * np.asarray(h[c]) for j, c in moving)
    nose = np.degrees(sum(twist[j] * np.asarray(h[c]) for j, c in moving))
    words = f"{run.words[:1].upper()}{run.words[1:]}."
    return [
        Chart(
            series=(Series(name=name, x=h.t[part], y=np.asarray(value)[part]),), x_label="time t, s", y_label=label,
            title=f"{run.name}: {name}", caption=words,
        )
        for name, value, label in (("tip deflection", up, "deflection up, m"), ("tip twist", nose, "twist nose up, °"))
    ]  # fmt: skip


def _charts(run: Run) -> list[Block]:
    """Motions, controls, gust of one run."""
    h = run.found.history
    if h is None:
        return []
    part = thinned(len(h.t), MOST_SAMPLES)
    t = h.t[part]
    groups: dict[str, list[Series]] = {}
    for channel, unit in zip(h.channels, h.units):
        value = np.asarray(h[channel])
        if (
            not np.any(value)
            or "rate" in channel
            or channel.startswith("lag")
            or channel in ("speed_m_s", "altitude_m")
        ):
            continue
        label, factor = {"m": ("displacement, m", 1.0), "rad": ("angle, °", 180.0 / np.pi)}.get(unit, ("", 1.0))
        if channel == "gust_m_s":
            label = "gust velocity (up), m/s"
        if not label or unit == "m/s^2" or len(groups.get(label, ())) >= 6:
            continue
        name = channel.removesuffix("_rad").removesuffix("_m").removesuffix("_m_s").replace("_", " ")
        groups.setdefault(label, []).append(Series(name=name, x=t, y=factor * value[part]))
    thin = f" Every {part.step}th sample is drawn." if part.step and part.step > 1 else ""
    return [
        Chart(
            series=tuple(series), x_label="time t, s", y_label=label, title=f"{run.name}: {label.split(',')[0]}",
            caption=f"{run.words[:1].upper()}{run.words[1:]}.{thin}",
        )
        for label, series in groups.items()
    ]  # fmt: skip


def live_part(case: ReportCase) -> Part:
    """The panel that simulates inside the page.

    Parameters
    ----------
    case : ReportCase
        The model.

    Returns
    -------
    part : Part
        Sliders, the wing, a trace.
    """
    family, lattice = case.family, lattice3d(case.file, case.model)
    V = float(np.clip(case.speed, family.V[0], family.V[-1]))
    length = max(case.speed / case.frequency, 4.0 * case.model.aero.b)
    data = live_data(
        family,
        lattice,
        start_speed=V,
        frequency=case.frequency,
        gust=float(np.tan(GUST_ANGLE)) * V,
        gust_length=length,
        altitude=case.options.altitude,
    )
    fit = (
        ""
        if family.fit_error is None
        else f" Air forces are rational, {100 * family.fit_error:.2g} % off their samples."
    )
    kept = "" if len(family.modes) == case.model.modes.n else f" It holds the first {len(family.modes)} modes."
    text = (
        f"The page carries {family.A.shape[0] * family.A.shape[1] * family.A.shape[2]} linear models of "
        f"{len(family.states)} states over airspeed, density and torsional stiffness; between them every entry "
        f"is right to {family.error:.1g} of the largest in its row. Steps are exact, {100 * family.dt_s:.3g} ms each."
        f"{kept}{fit} Linear theory: it knows no stall and no limits of the controls."
    )
    first = words(case.found.flutter_speed, "m/s")
    panel = LivePanel(
        data=data,
        title="Fly it",
        caption=f"Take the airspeed past flutter ({first}), press Play, switch the controller on; soften the wing.",
    )
    return Part(title="Live", anchor="live", blocks=(panel, Prose(text=text)))
