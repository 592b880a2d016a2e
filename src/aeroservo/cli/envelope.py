"""The command `envelope`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aeroservo.cli.boundary import tell_progress
from aeroservo.cli.flutter import choice, intervals_content
from aeroservo.cli.loaded import draw, load, tell
from aeroservo.cli.options import (
    PLOTS,
    Aero,
    Controller,
    FitBound,
    Json,
    Method,
    Model,
    Plot,
    Speeds,
    checked_output,
    condition_of,
    grid,
    numbers_of,
    sweep_of,
)
from aeroservo.cli.output import complain, heading, print_json, table, write_json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from aeroservo.aeroelastic.flutter import Method as RootMethod
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.control.controller import Controller as ControllerData
    from aeroservo.studies.envelope import EnvelopePoint
    from aeroservo.studies.gust_limit import GustSearch

#: Altitudes where none are given. [m]
ALTITUDES = "0:6000:1000"

Altitudes = Annotated[
    str, typer.Option("--altitudes", metavar="MIN:MAX:STEP", help="Geopotential altitudes, m; or a list A,B,C.")
]
Margin = Annotated[
    float | None, typer.Option("--margin", metavar="ALPHA", help="Disk margin asked for (default 0.828: 6 dB, 45 deg).")
]
Gusts = Annotated[
    str | None,
    typer.Option("--gusts", metavar="MIN:MAX:STEP", help="Speeds, m/s, at which the largest gust is sought."),
]
LargestGust = Annotated[float, typer.Option("--largest-gust", metavar="M_S", help="Largest gust tried, m/s.")]
Out = Annotated[
    Path | None, typer.Option("--out", metavar="FILE", help="Write the result, .json; resumes after an interruption.")
]


def envelope(
    model: Model,
    *,
    controller: Controller = None,
    altitudes: Altitudes = ALTITUDES,
    speeds: Speeds = None,
    method: Method = None,
    aero: Aero = None,
    fit_bound: FitBound = 0.01,
    margin: Margin = None,
    gusts: Gusts = None,
    largest_gust: LargestGust = 15.0,
    out: Out = None,
    plot: Plot = None,
    as_json: Json = False,
) -> None:
    """Print boundaries over speed and altitude, with and without control.

    Parameters
    ----------
    model : str
        Preset or path.
    controller : Path, optional
        Controller that closes the loop.
    altitudes : str
        MIN:MAX:STEP or a list. [m]
    speeds : str, optional
        MIN:MAX:STEP. [m/s]
    method : FlutterMethod, optional
        How roots of the open loop are found.
    aero : AeroTheory, optional
        Air forces.
    fit_bound : float
        Largest error of the fit that a closed loop needs. [-]
    margin : float, optional
        Disk margin asked for. [-]
    gusts : str, optional
        Speeds at which the largest suppressed gust is sought. [m/s]
    largest_gust : float
        Largest gust tried. [m/s]
    out : Path, optional
        Where the result goes; while it runs, altitudes are kept in OUT.part.
    plot : Path, optional
        Figure of altitude against speed.
    as_json : bool
        As JSON.

    Raises
    ------
    ValueError
        For bad input.
    """
    from aeroservo.control.controller import read_controller
    from aeroservo.studies import envelope as study

    checked_output(plot, PLOTS, "--plot")
    checked_output(out, (".json",), "--out")
    heights = _heights(altitudes)
    search = None if gusts is None else _search(gusts, largest_gust)
    own = None if controller is None else read_controller(controller)
    file, _, notes = load(model, aero, speeds)
    theory, chosen = choice(file, aero, method, fit_bound)
    low, high, step = sweep_of(file, speeds)
    sweep = condition_of(None, None, (low, high, step))
    asked = study.SIX_DB if margin is None else margin
    journal = None if out is None else out.with_name(out.name + ".part")
    tell(notes)
    points = _points(
        file, heights, sweep.V.tolist(), journal, method=chosen, controller=own, aero=aero.value if aero else None,
        fit_bound=fit_bound, margin=asked, gusts=search,
    )  # fmt: skip
    criterion = _criterion(asked)
    warnings = [*notes, *dict.fromkeys(w for p in points for w in p.warnings)]
    tell(warnings[len(notes) :])
    content = heading(file.name, warnings=warnings) | {
        "method": type(chosen).__name__.lower(),
        "aero": theory,
        "speeds_m_s": [low, high, step],
        "controller": None if controller is None else controller.name,
        "altitudes": [point_content(p, criterion) for p in points],
    }
    if plot is not None:
        from aeroservo.report.envelope_figure import envelope_figure

        what = "" if controller is None else f", loop closed by {controller.name}"
        title = f"{file.name}: envelope, air forces {theory}{what}"
        draw(plot, envelope_figure(points, (low, high), title, margin=asked, criterion=criterion))
    if out is not None and journal is not None:
        write_json(out, content)
        journal.unlink(missing_ok=True)
    if as_json:
        print_json(content)
        return
    _print(content)


def _points(
    file: FileModel,
    altitudes: list[float],
    speeds: list[float],
    journal: Path | None,
    *,
    method: RootMethod,
    controller: ControllerData | None,
    aero: str | None,
    fit_bound: float,
    margin: float,
    gusts: GustSearch | None,
) -> tuple[EnvelopePoint, ...]:
    """The study, with progress on stderr; an interruption says what is kept."""
    from aeroservo.studies import envelope as study

    done = 0

    def progress(now: int, count: int) -> None:
        nonlocal done
        done = now
        tell_progress(now, count, "altitudes")

    try:
        return study.envelope(
            file, altitudes, speeds, method=method, controller=controller, aero=aero, fit_bound=fit_bound,
            margin=margin, gusts=gusts, journal=journal, progress=progress,
        )  # fmt: skip
    except KeyboardInterrupt:
        kept = f"kept in {journal}: the same command goes on from there" if journal else "nothing kept: give --out FILE"
        complain(f"interrupted after {done} of {len(altitudes)} altitudes; {kept}")
        raise typer.Exit(1) from None


def point_content(point: EnvelopePoint, criterion: str) -> dict[str, Any]:
    """What `envelope --json` says about one altitude.

    Parameters
    ----------
    point : EnvelopePoint
        Of the study. [SI]
    criterion : str
        The margin asked for, in words.

    Returns
    -------
    content : dict
        Keys of contract.md, "envelope"; what needs a controller is null without one. [SI]
    """
    closed, valid = point.closed_loop is not None, point.valid_to
    return {
        "altitude_m": point.altitude,
        "density_kg_m3": point.density,
        "open_loop_intervals": intervals_content(point.open_loop),
        "closed_loop_intervals": None if point.closed_loop is None else intervals_content(point.closed_loop),
        "divergence_m_s": point.divergence,
        "reversal_m_s": point.reversal,
        "reversal_quantity": point.reversal_quantity,
        "margin_speed_m_s": point.margin_speed,
        "margin_holds_to_end": point.margin_to_end if closed else None,
        "margin_criterion": criterion if closed else None,
        "disk_margin": {"speed_m_s": point.margin_speeds, "alpha": point.margin_alpha} if closed else None,
        "valid_to_m_s": None if valid is None else valid.speed,
        "valid_to_why": None if valid is None else valid.why,
        "validity": [{"speed_m_s": v.speed, "not_valid": v.side, "why": v.why} for v in point.validity],
        "largest_gust": [
            {
                "speed_m_s": g.speed,
                "amplitude_m_s": g.amplitude,
                "at_least": g.at_least,
                "lost_first": g.why or None,
                "incidence_rad": math.atan2(g.amplitude, g.speed),
            }
            for g in point.gusts
        ],
    }


def _heights(text: str) -> list[float]:
    """MIN:MAX:STEP, a list, or one altitude."""
    if ":" in text:
        return grid(*numbers_of(text, "--altitudes", "m"))
    try:
        heights = [float(part) for part in text.split(",")]
    except ValueError:
        heights = [math.nan]
    if not all(math.isfinite(h) for h in heights) or len(set(heights)) != len(heights):
        raise ValueError(f"--altitudes = {text[:80]!r} must be MIN:MAX:STEP or different numbers A,B,C [m]")
    return sorted(heights)


def _search(text: str, largest: float) -> GustSearch:
    """Speeds of the gusts."""
    from aeroservo.aircraft.schema_base import checked_speeds
    from aeroservo.studies.gust_limit import GustSearch

    if not 0.0 < largest <= 100.0:
        raise ValueError(f"--largest-gust must be greater than 0 and at most 100 [m/s], got {largest:g}")
    return GustSearch(speeds=tuple(grid(*checked_speeds(numbers_of(text, "--gusts", "m/s")))), largest=largest)


def _criterion(alpha: float) -> str:
    """A disk margin in words."""
    gain = 20.0 * math.log10((2.0 + alpha) / (2.0 - alpha))
    phase = math.degrees(2.0 * math.atan(0.5 * alpha))
    return f"disk margin {alpha:.3g} ({gain:.3g} dB, {phase:.3g} deg)"


def _print(content: dict[str, Any]) -> None:
    """The result for people."""
    closed = content["controller"] is not None
    low, high, _ = content["speeds_m_s"]
    what = f", loop closed by {content['controller']}" if closed else ""
    typer.echo(f"{content['model']}: {low:g} to {high:g} m/s, air forces {content['aero']}{what}")
    if closed:
        typer.echo(f"margin: {content['altitudes'][0]['margin_criterion']}")

    def first(intervals: Sequence[dict[str, Any]] | None) -> tuple[str, str]:
        if not intervals:
            return "-", "-"
        lowest = min(intervals, key=lambda i: low if i["from_m_s"] is None else i["from_m_s"])
        start = f"below {low:g}" if lowest["from_m_s"] is None else f"{lowest['from_m_s']:.6g}"
        return start, lowest["kind"]

    rows = []
    for p in content["altitudes"]:
        row = [p["altitude_m"], *first(p["open_loop_intervals"])]
        if closed:
            speed = p["margin_speed_m_s"]
            holds = None if speed is None else f"{'>= ' if p['margin_holds_to_end'] else ''}{speed:.5g}"
            row += [*first(p["closed_loop_intervals"]), holds]
        rows.append([*row, p["divergence_m_s"], p["reversal_m_s"], p["valid_to_m_s"]])
    header = ["altitude, m", "unstable from, m/s", "kind"]
    header += ["with control", "kind", "margin to"] if closed else []
    typer.echo(table(rows, (*header, "divergence", "reversal", "valid to")))
    for p in content["altitudes"]:
        if p["largest_gust"]:
            gusts = ", ".join(
                f"{g['speed_m_s']:g}: {'>= ' if g['at_least'] else ''}{g['amplitude_m_s']:.3g}"
                for g in p["largest_gust"]
            )
            typer.echo(f"largest gust suppressed at {p['altitude_m']:g} m, m/s at m/s: {gusts}")
