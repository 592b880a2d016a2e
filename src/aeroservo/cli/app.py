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
from aeroservo.cli.output import not_yet
from aeroservo.cli.polar import polar
from aeroservo.cli.report import report
from aeroservo.cli.simulate import simulate
from aeroservo.cli.studio import studio

app = typer.Typer(
    name="aeroservo",
    help="Flutter, divergence, reversal and their control for flexible aircraft.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

#: Commands of the contract that this version does not have.
LATER = {
    "study": "the thesis re-run",
}


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
app.command("envelope", help="Boundaries over speed and altitude, with and without control.")(envelope)
app.command("report", help="Everything about a model in one offline page.")(report)
app.command("validate", help="Re-run the published cases.")(reruns.validate)
app.command("demo", help="The thesis' tables, theirs and ours.")(reruns.demo)


def _absent(name: str, what: str) -> None:
    @app.command(
        name,
        help=f"({what}: not in this version)",
        context_settings={"allow_extra_args": True, "ignore_unknown_options": True},
    )
    def _command(ctx: typer.Context) -> None:
        not_yet(f"the command '{ctx.info_name}' ({what})")


for _name, _what in LATER.items():
    _absent(_name, _what)
