"""`flutter --over`: boundaries over numbers of the model file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from aeroservo.cli.loaded import air, draw, tell
from aeroservo.cli.options import AeroTheory, grid, numbers_of
from aeroservo.cli.output import print_json, table, write_json

if TYPE_CHECKING:
    from aeroservo.aeroelastic.flutter import Method
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.datatypes import FlightCondition
    from aeroservo.studies.boundary import Over


def run_boundary(
    head: dict[str, Any],
    file: FileModel,
    over: list[str],
    sweep: FlightCondition,
    method: Method,
    *,
    aero: AeroTheory | None,
    out: Path | None,
    plot: Path | None,
    as_json: bool,
) -> None:
    """Compute, write and print a boundary.

    Parameters
    ----------
    head : dict
        Keys that every JSON has, and how roots were found.
    file : FileModel
        The model file.
    over : list of str
        FIELD=MIN:MAX:STEP, once or twice.
    sweep : FlightCondition
        Speeds. [m/s, kg/m^3]
    method : P, PK, K or G
        How roots are found.
    aero : AeroTheory, optional
        Air forces.
    out, plot : Path, optional
        Result, and figure. While the sweep runs, its points are kept in OUT.part.
    as_json : bool
        As JSON.

    Raises
    ------
    ValueError
        For bad input.
    """
    from aeroservo.studies.boundary import boundary_problems, flutter_boundary

    what = tuple(_over(text) for text in over)
    journal = None if out is None else out.with_name(out.name + ".part")
    word = aero.value if aero else None
    head = head | {"warnings": [*head["warnings"], *boundary_problems(file, what)]}
    tell(head["warnings"])
    points = flutter_boundary(file, what, sweep, method, aero=word, journal=journal, progress=tell_progress)
    content = head | {
        "over": [{"field": one.field, "values": one.values} for one in what],
        "points": [
            {
                "values": point.values,
                "found": point.found,
                "flutter_speed_m_s": point.flutter_speed,
                "flutter_frequency_rad_s": point.flutter_frequency,
                "flutter_mode": point.flutter_mode,
                "divergence_speed_m_s": point.divergence_speed,
            }
            for point in points
        ],
    }
    if plot is not None:
        from aeroservo.report.boundary_figure import boundary_figure

        draw(plot, boundary_figure(what, points, f"{head['model']}: {head['method']} method, {air(head)}"))
    if out is not None and journal is not None:
        write_json(out, content)
        journal.unlink(missing_ok=True)
    if as_json:
        print_json(content)
        return
    rows = [(*point.values, point.flutter_speed, point.flutter_mode, point.divergence_speed) for point in points]
    names = (*(one.field for one in what), "flutter, m/s", "mode", "divergence, m/s")
    typer.echo(table(rows, names))


def _over(text: str) -> Over:
    """FIELD=MIN:MAX:STEP."""
    from aeroservo.studies.boundary import Over

    field, equals, numbers = text.partition("=")
    if not (field and equals):
        raise ValueError(f"--over {text[:80]!r} must be FIELD=MIN:MAX:STEP")
    return Over(field=field, values=tuple(grid(*numbers_of(numbers, f"--over {field[:60]}", "unit of the field"))))


def tell_progress(done: int, count: int, what: str = "points") -> None:
    """A count on stderr, on one line of a terminal, now and then elsewhere.

    Parameters
    ----------
    done, count : int
        How many are done, of how many.
    what : str
        Of what.
    """
    if sys.stderr.isatty():
        print(f"\r{done} of {count} {what}", end="\n" if done == count else "", file=sys.stderr, flush=True)
    elif done == count or done % max(1, count // 10) == 0:
        print(f"aeroservo: {done} of {count} {what}", file=sys.stderr)
