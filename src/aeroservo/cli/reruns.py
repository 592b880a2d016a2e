"""Commands that re-run what is published: `validate`, `demo`."""

from __future__ import annotations

from typing import Annotated

import typer

from aeroservo.cli.options import Json
from aeroservo.cli.output import not_yet

Case = Annotated[str | None, typer.Argument(metavar="[CASE]", help="One case; all if left out.")]


def validate(case: Case = None, *, as_json: Json = False) -> None:
    """Re-run the published cases.

    Parameters
    ----------
    case : str, optional
        Name of one case.
    as_json : bool
        As JSON.
    """
    not_yet("the command 'validate'")


def demo() -> None:
    """Re-run the thesis' tables."""
    not_yet("the command 'demo'")
