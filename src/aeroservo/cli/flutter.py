"""The command `flutter`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aeroservo.cli.boundary import run_boundary
from aeroservo.cli.loaded import SAMPLED, air, altitude_of, draw, load, tell, tell_fit
from aeroservo.cli.options import (
    PLOTS,
    Aero,
    AeroTheory,
    Altitude,
    Controller,
    Density,
    FitBound,
    FlutterMethod,
    Json,
    Method,
    Model,
    Over,
    Plot,
    Sensitivities,
    Speeds,
    checked_bound,
    checked_output,
    condition_of,
    sweep_of,
)
from aeroservo.cli.output import heading, number, print_json, table, write_json
from aeroservo.cli.sensitivities import print_sensitivities, sensitivity_rows

if TYPE_CHECKING:
    from collections.abc import Iterable

    from aeroservo.aeroelastic.branches import Interval
    from aeroservo.aeroelastic.flutter import FlutterResult
    from aeroservo.aeroelastic.flutter import Method as RootMethod
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.datatypes import AeroelasticModel, FlightCondition

#: Word for air forces that a file brings itself.
_OWN = {"pitch_plunge_flap": "derivatives"}

Out = Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the result, .json.")]


def flutter(
    model: Model,
    *,
    method: Method = None,
    aero: Aero = None,
    altitude: Altitude = None,
    density: Density = None,
    speeds: Speeds = None,
    fit_bound: FitBound = 0.01,
    controller: Controller = None,
    over: Over = None,
    out: Out = None,
    sensitivities: Sensitivities = False,
    plot: Plot = None,
    as_json: Json = False,
) -> None:
    """Print flutter and divergence.

    Parameters
    ----------
    model : str
        Preset or path.
    method : FlutterMethod, optional
        How roots are found.
    aero : AeroTheory, optional
        Air forces.
    altitude, density : float, optional
        Of the air. [m, kg/m^3]
    speeds : str, optional
        MIN:MAX:STEP. [m/s]
    fit_bound : float
        Largest error of a rational fit. [-]
    controller : Path, optional
        Controller that closes the loop.
    over : list of str, optional
        FIELD=MIN:MAX:STEP, once or twice.
    out : Path, optional
        Where the result goes.
    sensitivities : bool
        Derivatives of the speeds.
    plot : Path, optional
        Figure of frequency and damping against speed; with `sensitivities` a tornado chart.
    as_json : bool
        As JSON.

    Raises
    ------
    ValueError
        For bad input.
    """
    checked_output(plot, PLOTS, "--plot")
    checked_output(out, (".json",), "--out")
    if controller is not None and (over or sensitivities or method not in (None, FlutterMethod.p)):
        raise ValueError("--controller finds roots by p, at one model: leave out --over, --sensitivities, --method")
    if sensitivities and over:
        raise ValueError("--sensitivities and --over are two questions: ask one at a time")
    file, built, notes = load(model, aero, speeds)
    theory, chosen = choice(file, aero, method, fit_bound)
    low, high, step = sweep_of(file, speeds)
    sweep = condition_of(altitude, density, (low, high, step))
    if over:
        head = heading(file.name, altitude_of(altitude, density), float(sweep.rho[0]), notes)
        head |= {"method": type(chosen).__name__.lower(), "aero": theory, "speeds_m_s": [low, high, step]}
        run_boundary(head, file, over, sweep, chosen, aero=aero, out=out, plot=plot, as_json=as_json)
        return
    found = _found(built, sweep, chosen, controller, fit_bound)
    notes += found.warnings
    if found.fit is not None:
        tell_fit(found.fit.error)
    tell(notes)
    head = heading(file.name, altitude_of(altitude, density), float(sweep.rho[0]), notes)
    content = head | {"method": found.method, "aero": theory, "speeds_m_s": [low, high, step]} | speeds_content(found)
    if controller is not None:
        content["controller"] = controller.name
    title = f"{file.name}: {found.method} method, air forces {theory}, {air(head)}{_closed(content)}"
    if sensitivities:
        word = aero.value if aero else None
        content["sensitivities"] = sensitivity_rows(file, sweep, chosen, aero=word, plot=plot, title=title)
    elif plot is not None:
        from aeroservo.report.figures import flutter_figure

        draw(plot, flutter_figure(found, title))
    if out is not None:
        write_json(out, content)
    if as_json:
        print_json(content)
    else:
        _print_flutter(content)
        if sensitivities:
            print_sensitivities(content["sensitivities"])


def _found(
    model: AeroelasticModel, sweep: FlightCondition, method: RootMethod, controller: Path | None, fit_bound: float
) -> FlutterResult:
    """Flutter of the wing alone, or with the loop closed by a controller file."""
    from aeroservo.aeroelastic.flutter import flutter as analyse
    from aeroservo.control.closed_flutter import closed_flutter
    from aeroservo.control.controller import read_controller

    if controller is None:
        return analyse(model, sweep, method)
    return closed_flutter(model, sweep, read_controller(controller), fit_bound=fit_bound)


def speeds_content(found: FlutterResult) -> dict[str, Any]:
    """What `flutter --json` says about a result.

    Parameters
    ----------
    found : FlutterResult
        A result.

    Returns
    -------
    content : dict
        Keys of contract.md, "flutter". [SI]
    """
    from aeroservo.datatypes import FlightCondition

    V = found.flutter_speed
    eas = None if V is None else float(FlightCondition(V=V, rho=found.condition.rho[0]).eas)  # type: ignore[arg-type]
    return {
        "found": found.found,
        "flutter_speed_m_s": V,
        "flutter_speed_eas_m_s": eas,
        "flutter_frequency_rad_s": found.flutter_frequency,
        "flutter_mode": found.flutter_mode,
        "unstable_intervals": intervals_content(found.intervals),
        "divergence_speed_m_s": found.divergence_speed,
        "first_real_instability_m_s": found.first_real_instability,
        "modes": [
            {
                "name": name,
                "speed_m_s": found.speeds[:, j],
                "frequency_rad_s": found.frequency[:, j],
                "damping_ratio": found.damping_ratio[:, j],
            }
            for j, name in enumerate(found.names)
        ],
    }


def intervals_content(intervals: Iterable[Interval]) -> list[dict[str, Any]]:
    """Unstable ranges as JSON has them.

    Parameters
    ----------
    intervals : iterable of Interval
        Of a result. [m/s]

    Returns
    -------
    rows : list of dict
        Keys of contract.md, "flutter". [m/s, rad/s]
    """
    return [
        {
            "from_m_s": interval.start,
            "to_m_s": interval.end,
            "frequency_rad_s": interval.frequency,
            "mode": interval.mode,
            "kind": interval.kind,
        }
        for interval in intervals
    ]


def choice(
    file: FileModel, aero: AeroTheory | None, method: FlutterMethod | None, fit_bound: float
) -> tuple[str, RootMethod]:
    """Air forces and method in force; sampled air forces are taken by p-k unless p is asked for.

    Parameters
    ----------
    file : FileModel
        Read; its kind has defaults.
    aero : AeroTheory, optional
        The option `--aero`.
    method : FlutterMethod, optional
        The option `--method`.
    fit_bound : float
        The option `--fit-bound`. [-]

    Returns
    -------
    theory, method : str, P or PK or K or G
        For the answer, and for the search.

    Raises
    ------
    ValueError
        If the bound is none.
    """
    from aeroservo.aeroelastic.build import DEFAULTS
    from aeroservo.aeroelastic.flutter import PK, G, K, P

    default = DEFAULTS[file.kind]
    usual = "pk" if aero in SAMPLED else default.method
    checked_bound(fit_bound)
    chosen = method.value if method else usual
    methods: dict[str, RootMethod] = {"p": P(fit_bound=fit_bound), "pk": PK(), "k": K(), "g": G()}
    return aero.value if aero else default.aero or _OWN.get(file.kind, "own"), methods[chosen]


def _closed(content: dict[str, Any]) -> str:
    """That the loop is closed, and by what."""
    return f", loop closed by {content['controller']}" if "controller" in content else ""


def _print_flutter(content: dict[str, Any]) -> None:
    """The result for people."""
    low, high, _step = content["speeds_m_s"]
    typer.echo(
        f"{content['model']}: {content['method']} method, air forces {content['aero']}, {air(content)}, "
        f"{low:g} to {high:g} m/s{_closed(content)}"
    )
    if content["flutter_speed_m_s"] is None:
        typer.echo("flutter     none in this range")
    else:
        omega = content["flutter_frequency_rad_s"]
        typer.echo(
            f"flutter     {number(content['flutter_speed_m_s'], 'm/s')} "
            f"({number(content['flutter_speed_eas_m_s'], 'm/s')} EAS) at {number(omega, 'rad/s')} "
            f"({number(omega / 6.283185307179586, 'Hz')}), mode {content['flutter_mode']}"
        )
    typer.echo(f"divergence  {number(content['divergence_speed_m_s'], 'm/s')} (static, rigid-body modes fixed)")
    if content["unstable_intervals"]:
        rows = [
            (i["from_m_s"], i["to_m_s"], i["kind"], i["mode"], i["frequency_rad_s"])
            for i in content["unstable_intervals"]
        ]
        typer.echo(table(rows, ("unstable from, m/s", "to", "kind", "mode", "rad/s")))
