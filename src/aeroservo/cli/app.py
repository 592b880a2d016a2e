"""All commands of `aeroservo`, in the order in which help lists them."""

from __future__ import annotations

from typing import Annotated

import typer

from aeroservo.cli import analyses, model_files, reruns
from aeroservo.cli.aero import aero
from aeroservo.cli.design import design
from aeroservo.cli.envelope import envelope
from aeroservo.cli.flutter import flutter
from aeroservo.cli.gust import gust
from aeroservo.cli.margins import margins
from aeroservo.cli.polar import polar
from aeroservo.cli.report import report
from aeroservo.cli.simulate import simulate
from aeroservo.cli.studio import studio
from aeroservo.cli.study import demo, study

app = typer.Typer(
    name="aeroservo",
    help="Flutter, divergence, reversal and their control for flexible aircraft.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        from aeroservo import __version__

        typer.echo(__version__)
        raise typer.Exit


@app.callback()
def _top(
    *,
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and stop.", is_eager=True, callback=_version)
    ] = False,
) -> None:
    pass


app.command("list", help="The presets.")(model_files.list_presets)
app.command("new", help="Copy a preset, or convert an AVL file (.avl), to a model file of your own.")(
    model_files.new_file
)
app.command("check", help="Check a model file; print what follows from it.")(model_files.check)
app.command("polar", help="Airfoil polars with the control deflected.")(polar)
app.command("aero", help="Lift, drag, moment and derivatives of the aircraft.")(aero)
app.command("modes", help="Frequencies and shapes without air.")(analyses.modes)
app.command("static", help="Divergence, control reversal, effectiveness, twist.")(analyses.static)
app.command("flutter", help="Flutter, divergence, damping against speed.")(flutter)
app.command("linearize", help="Named state space at one flight condition.")(analyses.linearize)
app.command("design", help="A controller: LQR, LQI, LQG, PID, pole placement; its margins.")(design)
app.command("simulate", help="Time histories in gusts, turbulence and closed loop.")(simulate)
app.command("gust", help="Critical gusts, peak loads and responses, RMS in turbulence.")(gust)
app.command("studio", help="A study, live in the browser on 127.0.0.1.")(studio)
app.command("margins", help="What a controller does to a wing: margins, delay, zeros, standards.")(margins)
app.command("envelope", help="Boundaries over speed and altitude, with and without control.")(envelope)
app.command("report", help="Everything about a model in one offline page.")(report)
app.command("study", help="The thesis re-run: every figure, table and claim, theirs and ours.")(study)
app.command("validate", help="Re-run the published cases.")(reruns.validate)
app.command("demo", help="What `study thesis` does, into a folder of its own.")(demo)
