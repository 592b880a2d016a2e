"""Commands about model files: `list`, `new`, `check`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from aeroservo.cli.loaded import built, is_buildable
from aeroservo.cli.options import Json, Model
from aeroservo.cli.output import complain, heading, print_json, table


def list_presets(*, as_json: Json = False) -> None:
    """Print the presets.

    Parameters
    ----------
    as_json : bool
        As JSON.
    """
    from aeroservo.aircraft.files import presets

    rows = [{"name": p.name, "kind": p.kind, "description": p.description} for p in presets()]
    if as_json:
        print_json(heading() | {"presets": rows})
    else:
        typer.echo(table([row.values() for row in rows], ("name", "kind", "description")))


def new_file(
    preset: Annotated[str, typer.Argument(metavar="PRESET", help="Name of a preset.")],
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Model file to write (TOML).")],
    *,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Copy a preset to a file.

    Parameters
    ----------
    preset : str
        Name of a preset.
    file : Path
        Where to.
    force : bool
        Replace an existing file.
    """
    from aeroservo.aircraft.files import new

    path = new(preset, file, force=force)
    complain(f"wrote {path}; next: aeroservo flutter {path}")


def check(model: Model, *, as_json: Json = False) -> None:
    """Check a model file.

    Parameters
    ----------
    model : str
        Preset or path.
    as_json : bool
        As JSON.
    """
    from aeroservo.aircraft.files import read

    file = read(model)
    if is_buildable(file):
        built(file)
    derived, problems = file.derived(), list(file.problems())
    if as_json:
        print_json(heading(file.name) | {"kind": file.kind, "derived": derived, "problems": problems})
        return
    typer.echo(f"{file.name}: kind {file.kind}, valid")
    typer.echo(table(derived.items(), ("derived", "value")))
    for problem in problems:
        typer.echo(f"problem: {problem}")
