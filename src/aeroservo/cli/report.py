"""The command `report`: everything about one model in one offline HTML file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aeroservo.cli.options import Aero, AeroTheory, Altitude, Controller, Model, checked_output, condition_of
from aeroservo.cli.output import complain, not_yet, write

if TYPE_CHECKING:
    from aeroservo.studies.aircraft_report import ReportOptions

Out = Annotated[
    Path | None, typer.Option("-o", "--out", metavar="FILE", help="Where to: FILE.html (default: NAME.html).")
]
Speed = Annotated[
    float | None,
    typer.Option("--speed", metavar="M_S", help="Airspeed of time histories and gusts (default: 0.9 of flutter), m/s."),
]
Fresh = Annotated[bool, typer.Option("--fresh", help="Compute all parts anew, whatever was kept.")]


def report(
    model: Model,
    *,
    out: Out = None,
    altitude: Altitude = None,
    speed: Speed = None,
    aero: Aero = None,
    controller: Controller = None,
    fresh: Fresh = False,
) -> None:
    """Write a report on a model.

    Parameters
    ----------
    model : str
        Preset or path.
    out : Path, optional
        An .html file; by default the model's name in the current folder.
    altitude : float, optional
        Geopotential altitude. [m]
    speed : float, optional
        Airspeed of time histories and gusts. [m/s]
    aero : AeroTheory, optional
        Air forces.
    controller : Path, optional
        Controller file that closes the loop instead of the report's own regulator.
    fresh : bool
        Whether kept parts are left aside.

    Raises
    ------
    ValueError
        For bad input.
    """
    from aeroservo.aero.polars_cache import cache_folder
    from aeroservo.control.controller import read_controller
    from aeroservo.report.html_blocks import file_name
    from aeroservo.report.make_report import provenance_of, report_parts
    from aeroservo.report.page import page_html
    from aeroservo.studies.aircraft_report import ReportOptions, report_case

    checked_output(out, (".html", ".htm"), "--out")
    condition_of(altitude, None, speed or 1.0)
    if aero is AeroTheory.dlm:
        not_yet("--aero dlm (an unsteady lattice)")
    options = ReportOptions(
        altitude=altitude or 0.0,
        aero=None if aero is None else aero.value,
        speed=speed,
        controller=None if controller is None else read_controller(controller),
        controller_name="" if controller is None else controller.name,
    )
    case = report_case(model, options)
    path = out if out is not None else Path(f"{file_name(case.file.name)}.html")
    parts = report_parts(case, folder=None if fresh else cache_folder() / "reports", progress=complain)
    made = provenance_of(case, source=model, text=_source(model), command=_command(model, path, options))
    lead = f"{case.file.kind.replace('_', ' ')}, {options.altitude:g} m"
    write(path, page_html(parts, made, title=case.file.name, lead=lead).encode())


def _source(model: str) -> str:
    """Text of the model file."""
    from aeroservo.aircraft.files import model_path

    return model_path(model).read_text(encoding="utf-8", errors="replace")


def _command(model: str, path: Path, options: ReportOptions) -> str:
    """What makes this report again, without folders."""
    import shlex

    words = ["aeroservo", "report", Path(model).name, "-o", path.name]
    if options.altitude:
        words += ["--altitude", f"{options.altitude:g}"]
    if options.speed is not None:
        words += ["--speed", f"{options.speed:g}"]
    if options.aero is not None:
        words += ["--aero", options.aero]
    if options.controller is not None:
        words += ["--controller", options.controller_name]
    return shlex.join(words)
