"""The command `studio`."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from aeroservo.cli.output import complain

Model = Annotated[
    str, typer.Argument(metavar="[MODEL]", help="Name of a preset, or path of a model file.", show_default=False)
]
Port = Annotated[
    int, typer.Option("--port", metavar="N", min=0, max=65535, help="Of the address (default: a free one).")
]
NoBrowser = Annotated[bool, typer.Option("--no-browser", help="Print the address, open nothing.")]
Folder = Annotated[
    Path | None,
    typer.Option("--folder", metavar="DIR", help="The one folder it reads and writes (default: MODEL's, or this one)."),
]


def studio(
    model: Model = "thesis-binary", *, port: Port = 0, no_browser: NoBrowser = False, folder: Folder = None
) -> None:
    """Edit a model in the browser, analysed and simulated as it changes.

    Parameters
    ----------
    model : str
        Preset or path.
    port : int
        Port on 127.0.0.1.
    no_browser : bool
        Whether the browser stays closed.
    folder : Path, optional
        Folder of models, controllers and reports.

    Raises
    ------
    ValueError
        For bad input.
    Exit
        With code 1 where NiceGUI is not installed.
    """
    from importlib.util import find_spec

    from aeroservo.aircraft.files import presets, read

    if find_spec("nicegui") is None:
        complain('the studio needs NiceGUI, which is not installed: pip install "aeroservo[studio]"')
        raise typer.Exit(1)
    read(model)  # refuses here what the page could only show
    preset = model in {p.name for p in presets()}
    home = folder or (Path.cwd() if preset else Path(model).parent)
    if not home.is_dir():
        raise ValueError(f"--folder {home}: there is no such folder")
    home = home.resolve()
    if not preset and Path(model).resolve().parent != home:
        raise ValueError(f"{model}: does not lie in the folder of the studio, {home}")
    from aeroservo.studio.draft import opened
    from aeroservo.studio.server import Choice, Studio

    name = model if preset else Path(model).name
    opened(name, home)
    running = Studio(Choice(folder=home, model=name, port=port))
    typer.echo(f"aeroservo studio at {running.url} (folder {home}; Ctrl-C stops it)")

    def show() -> None:
        webbrowser.open(running.url)

    running.serve(None if no_browser else show)
