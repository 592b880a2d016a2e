"""Commands that re-run what is published: `validate`, `demo`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aeroservo.cli.options import Json
from aeroservo.cli.output import complain, heading, print_json, table, write

if TYPE_CHECKING:
    from aeroservo.studies.thesis import Held, Row, ThesisStudy

Case = Annotated[str | None, typer.Argument(metavar="[CASE]", help="One case; all if left out.")]
Folder = Annotated[Path, typer.Option("--out", metavar="FOLDER", help="Where the figures go.")]


def validate(case: Case = None, *, as_json: Json = False) -> None:
    """Re-run the published cases; the exit code is 1 if one fails.

    Parameters
    ----------
    case : str, optional
        Name of one case.
    as_json : bool
        As JSON.

    Raises
    ------
    Exit
        With code 1 if a case fails.
    """
    from aeroservo.studies.validation import validate as rerun

    checks = rerun(case, progress=complain)
    failed = [check for check in checks if not check.passed]
    if as_json:
        rows = [
            {
                "name": check.name,
                "quantity": check.quantity,
                "reference": check.reference,
                "result": check.result,
                "difference": check.difference,
                "tolerance": check.tolerance,
                "citation": check.citation,
                "pass": check.passed,
            }
            for check in checks
        ]
        print_json(heading() | {"cases": rows})
    else:
        lines = [
            (c.name, c.quantity, c.reference, c.result, c.difference, c.tolerance, "pass" if c.passed else "FAIL")
            for c in checks
        ]
        names = ("case", "quantity", "reference", "result", "difference", "tolerance", "")
        typer.echo(table(lines, names))
        typer.echo("\nSources:\n" + "\n".join(sorted({f"  {c.name.split(':')[0]}: {c.citation}" for c in checks})))
        typer.echo(f"\n{len(checks) - len(failed)} of {len(checks)} pass")
    if failed:
        complain(f"{len(failed)} of {len(checks)} checks fail")
        raise typer.Exit(1)


def demo(*, out: Folder = Path("aeroservo-demo")) -> None:
    """Print the thesis' tables beside ours and write the figures.

    Parameters
    ----------
    out : Path
        Folder of the figures, made if it is not there.

    Raises
    ------
    ValueError
        If the folder cannot be made.
    """
    from aeroservo.studies.thesis import thesis_study

    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"--out {out}: cannot be made a folder: {error.strerror}") from None
    study = thesis_study(progress=complain)
    for number in (2, 3):
        _print_table(number, [row for row in study.rows if row.table == number])
    _print_held(study.held)
    figures = _demo_figures(study)
    for name, content in figures.items():
        write(out / name, content)
    typer.echo(f"\n{len(figures)} figures in the folder {out}; open {out / next(iter(figures))} first")


def _print_table(number: int, rows: list[Row]) -> None:
    """One table of the thesis, reasons numbered below."""
    typer.echo(f"\nTable {number} of the thesis, analytic columns, at {rows[0].altitude:g} m; speeds in m/s\n")
    reasons = list(dict.fromkeys(row.reason for row in rows))
    lines = [
        (
            f"{row.model}, {row.column}",
            row.quantity,
            row.theory,
            row.printed,
            "none" if row.computed is None else f"{row.computed:.2f}",
            "-" if row.difference is None else f"{row.difference:+.2f}",
            f"[{reasons.index(row.reason) + 1}]",
        )
        for row in rows
    ]
    typer.echo(table(lines, ("column", "quantity", "ours by", "thesis", "ours", "difference", "why")))
    typer.echo("\n" + "\n".join(f"[{i}] {reason}" for i, reason in enumerate(reasons, 1)))


def _print_held(held: tuple[Held, ...]) -> None:
    """Which k of held derivatives would print the thesis' unsteady columns."""
    typer.echo("\nThe unsteady columns: derivatives held at one reduced frequency k (thesis 7.34-7.36)\n")
    lines = [
        (
            h.model,
            f"{h.altitude:g}",
            h.slope,
            h.printed,
            "; ".join(f"{low:.3g} to {high:.3g}" for low, high in h.ranges) or "no k",
            "-" if h.own_k is None else f"{h.own_k:.3f}",
            "-" if h.own_speed is None else f"{h.own_speed:.2f}",
        )
        for h in held
    ]
    names = ("model", "altitude, m", "a_1", "thesis", "printed by k", "k of p-k flutter", "p-k flutter")
    typer.echo(table(lines, names))


def _demo_figures(study: ThesisStudy) -> dict[str, bytes]:
    """Every figure of the demo by the name of its file."""
    from aeroservo.report.figures import as_bytes, flutter_figure, static_figure

    figures = {}
    for run in study.runs:
        theory = "quasi-steady" if run.theory == "quasi_steady_damped" else f"Theodorsen, a_1 = {run.slope}"
        title = f"thesis-{run.model}, {theory}, {run.altitude:g} m"
        figures[title] = flutter_figure(run.flutter, title)
        if run.model == "binary" and run.theory == "quasi_steady_damped":
            title = f"thesis-{run.model}, statics, {run.altitude:g} m"
            figures[title] = static_figure(run.static, title)
    return {_file_name(title): as_bytes(figure, ".png") for title, figure in figures.items()}


def _file_name(title: str) -> str:
    """A file name of letters, digits, "-" and "_"."""
    kept = title.replace(", ", "_").replace(" = ", "-").replace(" ", "-").lower()
    return "".join(c for c in kept if c.isalnum() or c in "-_") + ".png"
