"""The command `margins`: what a controller does to a wing."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aeroservo.cli.loaded import air, altitude_of, draw, load, rational, tell
from aeroservo.cli.options import (
    PLOTS,
    Aero,
    Altitude,
    Density,
    FitBound,
    Json,
    Model,
    Plot,
    Speeds,
    checked_bound,
    checked_output,
    condition_of,
    grid,
    numbers_of,
    sweep_of,
)
from aeroservo.cli.output import heading, number, print_json, table, write_json

if TYPE_CHECKING:
    from aeroservo.studies.controller_check import ControllerCheck

#: Speeds where none are given: that many over the range of the file.
SPEEDS = 12

ControllerFile = Annotated[Path, typer.Option("--controller", metavar="FILE", help="The controller to check.")]
Delays = Annotated[
    str, typer.Option("--delays", metavar="MIN:MAX:STEP", help="Total delays, s, at which the margin is given too.")
]
VO = Annotated[float | None, typer.Option("--vo", metavar="M_S", help="Largest operational speed, m/s (MIL-F-9490D).")]
VL = Annotated[float | None, typer.Option("--vl", metavar="M_S", help="Limit speed, m/s (MIL-F-9490D).")]
VD = Annotated[float | None, typer.Option("--vd", metavar="M_S", help="Design dive speed, m/s (CS-23/25.629).")]
Out = Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the result, .json.")]


def margins(
    model: Model,
    *,
    controller: ControllerFile,
    speeds: Speeds = None,
    altitude: Altitude = None,
    density: Density = None,
    aero: Aero = None,
    fit_bound: FitBound = 0.01,
    delays: Delays = "0.005:0.03:0.005",
    vo: VO = None,
    vl: VL = None,
    vd: VD = None,
    out: Out = None,
    plot: Plot = None,
    as_json: Json = False,
) -> None:
    """Print margins against speed and delay, zeros, and rows of the standards.

    Parameters
    ----------
    model : str
        Preset or path.
    controller : Path
        The controller to check.
    speeds : str, optional
        MIN:MAX:STEP. [m/s]
    altitude, density : float, optional
        Of the air. [m, kg/m^3]
    aero : AeroTheory, optional
        Air forces.
    fit_bound : float
        Largest error of a rational fit. [-]
    delays : str
        MIN:MAX:STEP of the total delay. [s]
    vo, vl, vd : float, optional
        Speeds of the standards. [m/s]
    out, plot : Path, optional
        Result and figure.
    as_json : bool
        As JSON.

    Raises
    ------
    ValueError
        For bad input.
    """
    from aeroservo.control.closed_flutter import held_notes
    from aeroservo.control.controller import read_controller
    from aeroservo.studies.controller_check import controller_check

    checked_output(plot, PLOTS, "--plot")
    checked_output(out, (".json",), "--out")
    checked_bound(fit_bound)
    late = grid(*numbers_of(delays, "--delays", "s"))
    if late[0] < 0.0 or late[-1] > 1.0:
        raise ValueError(f"--delays = {delays[:80]!r} must lie from 0 to 1 [s]")
    own = read_controller(controller)
    file, built, notes = load(model, aero, speeds)
    low, high, step = sweep_of(file, speeds)
    if speeds is None:
        step = (high - low) / (SPEEDS - 1)
    sweep = condition_of(altitude, density, (low, high, step))
    notes += held_notes(own, sweep)
    tell(notes)
    height = altitude_of(altitude, density)
    found = controller_check(
        rational(built, fit_bound), sweep, own, altitude=height or 0.0, delays_s=late, V_o=vo, V_L=vl, V_D=vd
    )
    head = heading(file.name, height, float(sweep.rho[0]), notes)
    content = head | {"controller": controller.name} | check_content(found)
    if plot is not None:
        from aeroservo.report.margins_figure import margins_figure

        draw(plot, margins_figure(found, f"{file.name} with {controller.name}: margins, {air(head)}"))
    if out is not None:
        write_json(out, content)
    if as_json:
        print_json(content)
        return
    _print(content, air(head))


def check_content(found: ControllerCheck) -> dict[str, Any]:
    """What `margins --json` says.

    Parameters
    ----------
    found : ControllerCheck
        Of the study. [SI]

    Returns
    -------
    content : dict
        Speeds, margins of each loop and of all together, delays, zeros, rules; no limit and unstable are null, told
        apart by `stable`. [SI]
    """
    return {
        "total_delay_s": found.own_delay,
        "speeds": [
            {
                "speed_m_s": float(V),
                "stable": loops[0].stable,
                "disk_margin": {"inputs": one.alpha, "outputs": two.alpha, "both": three.alpha},
                "loops": [
                    {
                        "channel": m.channel,
                        "at": m.at,
                        "gain_up_dB": _decibel(m.gain_up),
                        "gain_down_dB": _decibel(m.gain_down),
                        "phase_deg": None if m.phase is None else math.degrees(m.phase),
                        "delay_s": m.delay_s,
                        "sensitivity_peak": m.sensitivity,
                        "complementary_peak": m.complementary,
                        "least_return_difference": m.least_return,
                        "disk_margin": m.disk.alpha,
                    }
                    for m in loops
                ],
            }
            for V, loops, one, two, three in zip(
                found.condition.V, found.loops, found.inputs, found.outputs, found.both
            )
        ],
        "delays": {"total_delay_s": found.delays.delays, "speed_m_s": found.delays.V, "alpha": found.delays.alpha},
        "zeros": [
            {"sensor": z.sensor, "speed_m_s": z.V, "right_half_plane_1_s": z.right, "crossings_m_s": z.crossings}
            for z in found.zeros
        ],
        "rules": [
            {
                "rule": r.rule,
                "what": r.what,
                "speed_m_s": r.speed,
                "asked_gain_dB": r.asked_gain_dB,
                "asked_phase_deg": r.asked_phase_deg,
                "gain_dB": r.gain_dB,
                "phase_deg": r.phase_deg,
                "pass": r.passed,
            }
            for r in found.rules
        ],
    }


def _decibel(gain: float | None) -> float | None:
    """20 log10; no limit is None, told from unstable by `stable`."""
    return 20.0 * math.log10(gain) if gain is not None and 0.0 < gain < math.inf else None


def _print(content: dict[str, Any], where: str) -> None:
    """The result for people."""
    typer.echo(f"{content['model']} with {content['controller']}: margins, {where}")
    typer.echo(f"total delay {number(1e3 * content['total_delay_s'], 'ms')} (sample, computing, dead time)")
    rows: list[tuple[Any, ...]] = []
    for p in content["speeds"]:
        if not p["stable"]:
            rows.append((p["speed_m_s"], "unstable", *[None] * 8))
            continue
        for m in [m for m in p["loops"] if m["at"] == "input"]:
            late_by = None if m["delay_s"] is None or math.isinf(m["delay_s"]) else 1e3 * m["delay_s"]
            numbers = (m["gain_up_dB"], m["gain_down_dB"], m["phase_deg"], late_by, m["sensitivity_peak"])
            rows.append((p["speed_m_s"], m["channel"], *numbers, *p["disk_margin"].values()))
    header = (
        "V, m/s",
        "cut at",
        "up, dB",
        "down, dB",
        "phase, deg",
        "delay, ms",
        "Ms",
        "disk, inputs",
        "outputs",
        "both",
    )
    typer.echo(table(rows, header))
    late = content["delays"]
    typer.echo("disk margin at the inputs against the total delay:")
    names = ["V, m/s", *(f"{1e3 * d:g} ms" for d in late["total_delay_s"])]
    typer.echo(table([[float(V), *map(float, a)] for V, a in zip(late["speed_m_s"], late["alpha"])], names))
    for z in content["zeros"]:
        if z["crossings_m_s"]:
            speeds = ", ".join(f"{V:.5g}" for V in z["crossings_m_s"])
            typer.echo(f"a zero of {z['sensor']} crosses the axis at {speeds} m/s")
    if content["rules"]:
        rules = [
            (r["rule"], r["what"], r["speed_m_s"], r["asked_gain_dB"], r["gain_dB"], r["asked_phase_deg"],
             r["phase_deg"], "pass" if r["pass"] else "FAIL")
            for r in content["rules"]
        ]  # fmt: skip
        typer.echo(table(rules, ("rule", "what", "m/s", "dB asked", "dB", "deg asked", "deg", "")))
