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
        str,
        typer.Argument(
            metavar="PRESET", help="Name of a preset, or an AVL geometry file (.avl) to convert; with --as also a file."
        ),
    ],
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Model file to write (TOML).")],
    *,
    kind: Annotated[
        str | None,
        typer.Option("--as", metavar="pitch_plunge_flap", help="The rigid wing on two springs of an aircraft file."),
    ] = None,
    pitch_axis: Annotated[
        float | None,
        typer.Option("--pitch-axis", metavar="X_M", help="With --as: pitch axis aft (default the flexural axis)."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Copy a preset to a file, convert an AVL geometry file, or derive a pitch-plunge model from an aircraft.

    Parameters
    ----------
    preset : str
        Name of a preset, or path of an AVL file; with `kind` of any model of kind `aircraft`.
    file : Path
        Where to.
    kind : str, optional
        Kind of model to derive: pitch_plunge_flap.
    pitch_axis : float, optional
        Of the derived model, aft of the file's origin. [m]
    force : bool
        Replace an existing file.

    Raises
    ------
    ValueError
        For bad input.
    """
    if kind is not None:
        from aeroservo.aeroelastic.pitch_plunge_aircraft import new_pitch_plunge
        from aeroservo.studies.aircraft_aero import read_aircraft

        if kind != "pitch_plunge_flap":
            raise ValueError(f"--as must be pitch_plunge_flap, got {kind[:40]!r}")
        path = new_pitch_plunge(read_aircraft(preset), file, pitch_axis=pitch_axis, force=force)
        complain(f"wrote {path}, every number with its source; next: aeroservo simulate {path} --speed 15")
        return
    if pitch_axis is not None:
        raise ValueError("--pitch-axis goes with --as pitch_plunge_flap")
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
