"""Commands that compute at rest or at one speed: `modes`, `static`, `linearize`."""

from __future__ import annotations

import math
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aeroservo.cli.loaded import air, altitude_of, draw, load, rational, tell
from aeroservo.cli.options import (
    PLOTS,
    Aero,
    Altitude,
    Density,
    FitBound,
    Json,
    Model,
    Plot,
    Speeds,
    checked_bound,
    checked_output,
    condition_of,
    sweep_of,
)
from aeroservo.cli.output import heading, number, print_json, table, write, write_json

if TYPE_CHECKING:
    from aeroservo.aircraft.schema_other import StateSpaceFile
    from aeroservo.datatypes import AeroelasticModel, FlightCondition, LinearSystem

Out = Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the result, .json or .mat.")]
CreepTo = Annotated[
    float | None,
    typer.Option(
        "--creep-to", metavar="RATIO", help="Time until the tip twists so far per unit of incidence (viscoelastic)."
    ),
]
Speed = Annotated[float | None, typer.Option("--speed", metavar="M_S", help="True airspeed, m/s.")]


def modes(model: Model, *, plot: Plot = None, as_json: Json = False) -> None:
    """Print frequencies and shapes without air.

    Parameters
    ----------
    model : str
        Preset or path.
    plot : Path, optional
        Figure of the shapes.
    as_json : bool
        As JSON.
    """
    from aeroservo.structure.modal import natural_modes

    checked_output(plot, PLOTS, "--plot")
    file, built, notes = load(model, None)
    found = natural_modes(built.modes)
    hertz = [float(omega) / (2.0 * math.pi) for omega in found.omega]
    content = {
        "frequencies_Hz": hertz,
        "frequencies_rad_s": found.omega,
        "names": found.names,
        "generalized_mass": found.generalized_mass,
    }
    slow = None
    if built.modes.relaxing:
        from aeroservo.aeroelastic.creep import relaxed

        slow = natural_modes(relaxed(built).modes)
        content["relaxed"] = {"frequencies_rad_s": slow.omega, "names": slow.names}
    tell(notes)
    if plot is not None:
        from aeroservo.report.figures import modes_figure

        draw(plot, modes_figure(built.modes, found, f"{file.name}: modes without air"))
    if as_json:
        print_json(heading(file.name, warnings=notes) | content)
        return
    typer.echo(f"{file.name}: modes without air{' (glassy: at once)' if slow else ''}")
    rows = [(n, w, f, m) for n, w, f, m in zip(found.names, map(float, found.omega), hertz, found.generalized_mass)]
    typer.echo(table(rows, ("mode", "rad/s", "Hz", "generalised mass")))
    if slow is not None:
        typer.echo("relaxed: in the long run")
        typer.echo(
            table(
                [(n, w, w / (2.0 * math.pi)) for n, w in zip(slow.names, slow.omega.tolist())], ("mode", "rad/s", "Hz")
            )
        )


def static(
    model: Model,
    *,
    altitude: Altitude = None,
    density: Density = None,
    speeds: Speeds = None,
    aero: Aero = None,
    creep_to: CreepTo = None,
    plot: Plot = None,
    as_json: Json = False,
) -> None:
    """Print divergence, reversal, effectiveness and twist.

    Parameters
    ----------
    model : str
        Preset or path.
    altitude, density : float, optional
        Of the air. [m, kg/m^3]
    speeds : str, optional
        MIN:MAX:STEP. [m/s]
    aero : AeroTheory, optional
        Air forces.
    creep_to : float, optional
        Twist of the tip per degree of incidence to which a viscoelastic wing creeps. [-]
    plot : Path, optional
        Figure against speed.
    as_json : bool
        As JSON.

    Raises
    ------
    ValueError
        For bad input.
    """
    from aeroservo.aeroelastic.static import static as analyse

    checked_output(plot, PLOTS, "--plot")
    file, built, notes = load(model, aero, speeds)
    if creep_to is not None and not built.modes.relaxing:
        raise ValueError(f"{file.name}: --creep-to needs a viscoelastic structure ([viscoelastic] in the model file)")
    sweep = condition_of(altitude, density, sweep_of(file, speeds))
    found = analyse(built, sweep)
    notes += found.warnings
    tell(notes)
    head = heading(file.name, altitude_of(altitude, density), float(sweep.rho[0]), notes)
    content = {
        "divergence_speed_m_s": found.divergence.V,
        "divergence_dynamic_pressure_Pa": found.divergence.q,
        "reversal_speed_m_s": found.reversal.V,
        "reversal_dynamic_pressure_Pa": found.reversal.q,
        "reversal_quantity": found.reversal_quantity,
        "effectiveness": {"speed_m_s": found.V, "value": found.effectiveness},
        "twist": {"speed_m_s": found.V, "value_rad": found.twist},
    }
    viscous = _creep(built, sweep, creep_to) if built.modes.relaxing else {}
    content |= {"viscoelastic": viscous} if viscous else {}
    if plot is not None:
        from aeroservo.report.figures import static_figure

        draw(plot, static_figure(found, f"{file.name}: statics at {air(head)}", a_sound=float(sweep.a_sound[0])))
    if as_json:
        print_json(head | content)
        return
    typer.echo(f"{file.name}: statics at {air(head)}")
    typer.echo(f"divergence  {number(found.divergence.V, 'm/s')}")
    quantity = f" of {found.reversal_quantity}" if found.reversal_quantity else ""
    typer.echo(f"reversal    {number(found.reversal.V, 'm/s')}{quantity}")
    if viscous:
        typer.echo("the structure relaxes: these are its speeds in the long run; at once (glassy) they are")
        typer.echo(f"divergence  {number(viscous['glassy_divergence_speed_m_s'], 'm/s')}")
        typer.echo(f"reversal    {number(viscous['glassy_reversal_speed_m_s'], 'm/s')}")
    rows = sorted({round(i * (found.V.size - 1) / 9) for i in range(10)})
    curves = (found.effectiveness, found.twist, found.trim_incidence, found.trim_twist)
    header = ("V, m/s", "effectiveness", "twist per incidence", "trim incidence, deg", "trim twist, deg")
    scales = (1.0, 1.0, math.degrees(1.0), math.degrees(1.0))
    cells = [[found.V[i], *(scale * curve[i] for scale, curve in zip(scales, curves))] for i in rows]
    typer.echo(table(cells, header))
    if creep_to is not None:
        times = viscous["creep"]["time_s"]
        typer.echo(f"time until the tip twists {creep_to:g} per unit of root incidence (0: at once, -: never)")
        typer.echo(table([(found.V[i], times[i]) for i in rows], ("V, m/s", "s")))


def linearize(
    model: Model,
    *,
    speed: Speed = None,
    altitude: Altitude = None,
    density: Density = None,
    aero: Aero = None,
    fit_bound: FitBound = 0.01,
    out: Out = None,
    as_json: Json = False,
) -> None:
    """Print or write a named state space.

    Parameters
    ----------
    model : str
        Preset or path.
    speed : float, optional
        True airspeed; only a state_space model brings its own. [m/s]
    altitude, density : float, optional
        Of the air. [m, kg/m^3]
    aero : AeroTheory, optional
        Air forces; samples are fitted first.
    fit_bound : float
        Largest error of that fit. [-]
    out : Path, optional
        Where the matrices go.
    as_json : bool
        As JSON.

    Raises
    ------
    ValueError
        For bad input.
    """
    from aeroservo.aeroelastic.linear import linear_system
    from aeroservo.aircraft.files import read
    from aeroservo.aircraft.schema_other import StateSpaceFile

    checked_output(out, (".json", ".mat"), "--out")
    checked_bound(fit_bound)
    file = read(model)
    if isinstance(file, StateSpaceFile):
        if aero is not None or density is not None:
            raise ValueError(f"{file.name}: a state_space model has no --aero and no --density of its own choice")
        system, speed, altitude = state_space_system(file, speed, altitude)
        condition, notes = condition_of(altitude, None, speed), file.problems()
    else:
        if speed is None:
            raise ValueError("linearize needs the airspeed: --speed M_S")
        condition = condition_of(altitude, density, speed)
        _, aeroelastic, notes = load(model, aero)
        system = linear_system(rational(aeroelastic, fit_bound), condition)
    tell(notes)
    head = heading(file.name, altitude_of(altitude, density), float(condition.rho), notes)
    content = head | {
        **{name: getattr(system, name) for name in "ABCD"},
        "states": system.states,
        "inputs": system.inputs,
        "outputs": system.outputs,
        "dt_s": system.dt,
    }
    if out is not None and out.suffix.lower() == ".mat":
        write(out, _matlab(system))
    elif out is not None:
        write_json(out, content)
    if as_json:
        print_json(content)
        return
    typer.echo(f"{file.name}: {len(system.states)} states at {speed:g} m/s, {air(head)}")
    typer.echo(f"states   {', '.join(system.states)}\ninputs   {', '.join(system.inputs)}")
    typer.echo(f"outputs  {', '.join(system.outputs)}")


def _creep(model: AeroelasticModel, sweep: FlightCondition, twist: float | None) -> dict[str, Any]:
    """Speeds of the glassy and the relaxed wing, and times to a twist."""
    from aeroservo.aeroelastic.creep import creep_speeds, creep_time

    found = creep_speeds(model, sweep[0])
    content: dict[str, Any] = {
        "glassy_divergence_speed_m_s": found.glassy_divergence.V,
        "relaxed_divergence_speed_m_s": found.relaxed_divergence.V,
        "glassy_reversal_speed_m_s": found.glassy_reversal.V,
        "relaxed_reversal_speed_m_s": found.relaxed_reversal.V,
    }
    if twist is not None:
        times = creep_time(model, sweep, twist=twist)
        reached = [float(t) if math.isfinite(t) else None for t in times]
        content["creep"] = {"twist_per_incidence": twist, "speed_m_s": sweep.V, "time_s": reached}
    return content


def state_space_system(
    file: StateSpaceFile, speed: float | None, altitude: float | None
) -> tuple[LinearSystem, float, float]:
    """The system that a state_space file holds, and the condition where it holds.

    Parameters
    ----------
    file : StateSpaceFile
        Read.
    speed, altitude : float, optional
        The options: any other than the file's own are refused. [m/s, m]

    Returns
    -------
    system, speed, altitude : LinearSystem, float, float
        One condition. [SI, m/s, m]

    Raises
    ------
    ValueError
        If another condition is asked for.
    """
    from aeroservo.datatypes import LinearSystem

    m = file.model
    matrices: dict[str, Any] = {name: getattr(m, name) for name in "ABCD"}
    system = LinearSystem(**matrices, states=m.states, inputs=m.inputs, outputs=m.outputs)
    V = _at_its_own(file, "--speed", speed, "speed_m_s")
    return system, V, _at_its_own(file, "--altitude", altitude, "altitude_m")


def _at_its_own(file: StateSpaceFile, option: str, asked: float | None, field: str) -> float:
    """The one speed or altitude at which a state_space model holds; any other is refused."""
    holds = float(getattr(file.model, field))
    if asked is not None and not math.isclose(asked, holds, rel_tol=1e-9, abs_tol=1e-9):
        raise ValueError(
            f"{file.name}: {option} {asked:g}: this model holds at model.{field} = {holds:g} and nowhere else"
        )
    return holds


def _matlab(system: LinearSystem) -> bytes:
    """The matrices and names as the content of a .mat file."""
    from numpy import array
    from scipy.io import savemat

    content = {name: getattr(system, name) for name in "ABCD"}
    names = {what: array(getattr(system, what), dtype=object) for what in ("states", "inputs", "outputs")}
    file = BytesIO()
    savemat(file, content | names | {"dt_s": array([]) if system.dt is None else system.dt})
    return file.getvalue()
