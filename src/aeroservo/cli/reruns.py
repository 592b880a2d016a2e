"""The command that re-runs the published cases: `validate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from aeroservo.cli.options import Json, checked_output
from aeroservo.cli.output import complain, heading, print_json, table, write

Case = Annotated[str | None, typer.Argument(metavar="[CASE]", help="One case; all if left out.")]
Markdown = Annotated[
    Path | None, typer.Option("--markdown", metavar="FILE", help="Write the page of the documentation (.md) as well.")
]


def validate(case: Case = None, *, markdown: Markdown = None, as_json: Json = False) -> None:
    """Re-run the published cases; the exit code is 1 if one fails.

    Parameters
    ----------
    case : str, optional
        Name of one case.
    markdown : Path, optional
        Page of the documentation.
    as_json : bool
        As JSON.

    Raises
    ------
    Exit
        With code 1 if a case fails.
    """
    from aeroservo.studies.validation import not_yet_computed
    from aeroservo.studies.validation import validate as rerun

    checked_output(markdown, (".md",), "--markdown")
    checks = rerun(case, progress=complain)
    missing = not_yet_computed(case)
    if markdown is not None:
        from aeroservo.report.validation_text import validation_markdown

        write(markdown, validation_markdown(checks, missing).encode())
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
        later = [
            {"name": m.name, "quantity": m.quantity, "reference": m.reference, "why": m.why, "citation": m.citation}
            for m in missing
        ]
        print_json(heading() | {"cases": rows, "not_yet_computed": later})
    else:
        lines = [
            (c.name, c.quantity, c.reference, c.result, c.difference, c.tolerance, "pass" if c.passed else "FAIL")
            for c in checks
        ]
        names = ("case", "quantity", "reference", "result", "difference", "tolerance", "")
        typer.echo(table(lines, names))
        typer.echo("\nSources:\n" + "\n".join(sorted({f"  {c.name.split(':')[0]}: {c.citation}" for c in checks})))
        if missing:
            lines_later = [f"  {m.name}: {m.quantity}, {m.reference}: {m.why}" for m in missing]
            typer.echo("\nNot yet computed:\n" + "\n".join(lines_later))
        typer.echo(f"\n{len(checks) - len(failed)} of {len(checks)} pass")
    if failed:
        complain(f"{len(failed)} of {len(checks)} checks fail")
        raise typer.Exit(1)
