"""The command that re-runs the published cases: `validate`."""

from __future__ import annotations

from typing import Annotated

import typer

from aeroservo.cli.options import Json
from aeroservo.cli.output import complain, heading, print_json, table

Case = Annotated[str | None, typer.Argument(metavar="[CASE]", help="One case; all if left out.")]


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
