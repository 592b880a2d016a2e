"""Commands about model files: `list`, `new`, `check`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from aeroservo.cli.loaded import built, draw, is_buildable, tell
from aeroservo.cli.options import PLOTS, Json, Model, Plot, checked_output
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
    preset: Annotated[
        str, typer.Argument(metavar="PRESET", help="Name of a preset, or an AVL geometry file (.avl) to convert.")
    ],
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Model file to write (TOML).")],
    *,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Copy a preset to a file, or convert an AVL geometry file.

    Parameters
    ----------
    preset : str
        Name of a preset, or path of an AVL file.
    file : Path
        Where to.
    force : bool
        Replace an existing file.
    """
    if preset.lower().endswith(".avl"):
        from aeroservo.aircraft.avl_files import new_from_avl

        path, notes = new_from_avl(preset, file, force=force)
        tell(notes)
        complain(f"wrote {path}; next: aeroservo aero {path}")
        return
    from aeroservo.aircraft.files import new

    path = new(preset, file, force=force)
    complain(f"wrote {path}; next: aeroservo flutter {path}")


def check(model: Model, *, plot: Plot = None, as_json: Json = False) -> None:
    """Check a model file.

    Parameters
    ----------
    model : str
        Preset or path.
    plot : Path, optional
        Three views of an aircraft.
    as_json : bool
        As JSON.

    Raises
    ------
    ValueError
        If a drawing is asked for of a model that is no aircraft.
    """
    from aeroservo.aircraft.aircraft_schema import AircraftFile
    from aeroservo.aircraft.files import read

    checked_output(plot, PLOTS, "--plot")
    file = read(model)
    if plot is not None and not isinstance(file, AircraftFile):
        raise ValueError(f"{file.name}: --plot draws the planform of kind 'aircraft'; kind {file.kind!r} has none")
    if is_buildable(file):
        built(file)
    derived, problems = file.derived(), list(file.problems())
    if plot is not None and isinstance(file, AircraftFile):
        from aeroservo.report.planform import planform_figure

        draw(plot, planform_figure(file, f"{file.name}: three views"))
    if as_json:
        print_json(heading(file.name) | {"kind": file.kind, "derived": derived, "problems": problems})
        return
    typer.echo(f"{file.name}: kind {file.kind}, valid")
    typer.echo(table(derived.items(), ("derived", "value")))
    for problem in problems:
        typer.echo(problem if problem.startswith("assumed: ") else f"problem: {problem}")
