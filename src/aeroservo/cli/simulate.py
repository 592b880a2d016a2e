"""The command `simulate`. Over budget because a command's options are its signature."""

from __future__ import annotations

import math
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aeroservo.cli.loaded import altitude_of, built, draw, rational, tell
from aeroservo.cli.options import (
    PLOTS,
    Aero,
    AeroTheory,
    Altitude,
    Controller,
    Density,
    FitBound,
    Json,
    Model,
    Plot,
    checked_output,
    condition_of,
)
from aeroservo.cli.output import heading, not_yet, number, print_json, table, write

if TYPE_CHECKING:
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.datatypes import AeroelasticModel, LinearSystem
    from aeroservo.simulate.disturbances import Doublet, Gustiness
    from aeroservo.simulate.engine import Simulation
    from aeroservo.simulate.profiles import Profile


class Spectrum(StrEnum):
    """Words of `--spectrum`."""

    dryden = "dryden"
    von_karman = "von_karman"
    dryden_blockset = "dryden_blockset"
    von_karman_blockset = "von_karman_blockset"


class Specification(StrEnum):
    """Words of `--specification`."""

    mil_f_8785c = "MIL-F-8785C"
    mil_hdbk_1797 = "MIL-HDBK-1797"


Speed = Annotated[float | None, typer.Option("--speed", metavar="M_S", help="True airspeed, m/s.")]
ProfileName = Annotated[
    str | None, typer.Option("--profile", metavar="climb", help="15 m/s at sea level to 130 m/s at 3,048 m in 115 s.")
]
Duration = Annotated[
    float | None, typer.Option("--duration", metavar="S", help="Length, s (default 10, or the profile's).")
]
Gusts = Annotated[
    list[str] | None,
    typer.Option("--gust", metavar="GUST", help="sharp:W@T or cosine:W:LENGTH@T (m/s, m, s); repeatable."),
]
Turbulent = Annotated[
    str | None, typer.Option("--turbulence", metavar="LEVEL", help="light, moderate, severe, or an RMS in m/s.")
]
TurbulenceSpectrum = Annotated[
    Spectrum | None,
    typer.Option(
        "--spectrum", help="Of --turbulence (default dryden); ..._blockset: the Aerospace Blockset's defaults."
    ),
]
Specified = Annotated[
    Specification | None, typer.Option("--specification", help="Whose scale lengths (default MIL-F-8785C).")
]
Initial = Annotated[
    list[str] | None,
    typer.Option("--initial", metavar="STATE=VALUE", help="Start off the equilibrium (pitch_rad=0.02); repeatable."),
]
Doublets = Annotated[
    list[str] | None,
    typer.Option(
        "--doublet",
        metavar="DEG:S@T",
        help="DEG one way then the other in S seconds from T, or CONTROL=...; repeatable.",
    ),
]
Runs = Annotated[
    int | None, typer.Option("--runs", metavar="N", help="Monte Carlo: that many runs; --out .csv, .json.")
]
Workers = Annotated[int | None, typer.Option("--workers", metavar="M", help="Processes of --runs (default: cores).")]
Vary = Annotated[
    list[str] | None,
    typer.Option("--vary", metavar="FIELD=LAW", help="With --runs: normal:MEAN:SD or uniform:LOW:HIGH; repeatable."),
]
Seed = Annotated[int, typer.Option("--seed", metavar="N", help="Of turbulence and sensor noise.")]
Out = Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the history, .nc, .csv or .mat.")]

#: Pitch (or first coordinate) at the start where nothing else disturbs the model.
KICK = 0.01
#: Length of a run where none is given. [s]
DURATION = 10.0


def simulate(
    model: Model,
    *,
    speed: Speed = None,
    profile: ProfileName = None,
    duration: Duration = None,
    gust: Gusts = None,
    turbulence: Turbulent = None,
    spectrum: TurbulenceSpectrum = None,
    specification: Specified = None,
    controller: Controller = None,
    doublet: Doublets = None,
    initial: Initial = None,
    runs: Runs = None,
    workers: Workers = None,
    vary: Vary = None,
    seed: Seed = 0,
    altitude: Altitude = None,
    density: Density = None,
    aero: Aero = None,
    fit_bound: FitBound = 0.01,
    out: Out = None,
    plot: Plot = None,
    as_json: Json = False,
) -> None:
    """Print what a time history shows; write it.

    Parameters
    ----------
    model : str
        Preset or path.
    speed : float, optional
        True airspeed. [m/s]
    profile : str, optional
        Name of a manoeuvre instead.
    duration : float, optional
        Length of the run. [s]
    gust : list of str, optional
        Discrete gusts.
    turbulence : str, optional
        Severity or RMS.
    spectrum : Spectrum, optional
        Of the turbulence.
    specification : Specification, optional
        Of its scale lengths.
    controller : Path, optional
        Controller file that closes the loop.
    doublet : list of str, optional
        Commands from outside.
    initial : list of str, optional
        States at the start.
    runs, workers : int, optional
        Monte Carlo: how many runs, on how many processes.
    vary : list of str, optional
        Numbers of the model file that differ from run to run.
    seed : int
        Of turbulence and noise, and of what varies.
    altitude, density : float, optional
        Of the air. [m, kg/m^3]
    aero : AeroTheory, optional
        Air forces; samples are fitted first.
    fit_bound : float
        Largest error of that fit. [-]
    out : Path, optional
        Where the history goes.
    plot : Path, optional
        Figure of the channels.
    as_json : bool
        As JSON.

    Raises
    ------
    ValueError
        For bad input.
    """
    from aeroservo.aircraft.files import read
    from aeroservo.control.controller import read_controller
    from aeroservo.simulate.disturbances import parse_gust
    from aeroservo.simulate.engine import Scenario
    from aeroservo.simulate.engine import simulate as run
    from aeroservo.simulate.history import history_bytes
    from aeroservo.simulate.scenario import Stepping

    if runs is None and (workers is not None or vary):
        raise ValueError("--workers and --vary go with --runs N")
    if runs is not None and plot is not None:
        raise ValueError("--plot draws one run: leave out --runs")
    checked_output(out, (".nc", ".csv", ".mat") if runs is None else (".csv", ".json"), "--out")
    checked_output(plot, PLOTS, "--plot")
    file = read(model)
    plant, flown, notes = _flown(file, speed, profile, altitude, density, aero, fit_bound)
    if seed < 0:
        raise ValueError(f"--seed must not be negative, got {seed}")
    gusts = tuple(parse_gust(text) for text in gust or ())
    weather = _weather(turbulence, spectrum, specification)
    doublets = tuple(_doublet(text) for text in doublet or ())
    start = tuple(_initial(text) for text in initial or ())
    if not (gusts or weather or doublets or start):
        start = ((_first_state(plant), KICK),)
        notes.append(f"nothing disturbs the model: it starts with {start[0][0]} = {KICK:g}")
    length = duration if duration is not None else flown.duration or DURATION
    notes += [
        f"--gust at {g.start:g} s comes after the end of the run, {length:g} s" for g in gusts if g.start >= length
    ]
    scenario = Scenario(
        profile=flown,
        duration=length,
        controller=None if controller is None else read_controller(controller),
        gusts=gusts,
        doublets=doublets,
        turbulence=weather,
        initial=start,
    )
    height = None if flown.moving else (float(flown.altitude[0]) if flown.altitude is not None else None)
    air = None if flown.moving else float(flown.condition(0.0).rho)
    if runs is not None:
        from aeroservo.cli.ensemble import run_many

        tell(notes)
        many: dict[str, Any] = {"runs": runs, "workers": workers, "vary": vary or [], "seed": seed}
        many |= {"aero": aero, "fit_bound": fit_bound, "out": out, "as_json": as_json}
        run_many(heading(file.name, height, air, notes), file, plant, scenario, **many)
        return
    found = run(plant, scenario, seed=seed, stepping=Stepping())
    notes += found.warnings
    if found.overflow_at is not None:
        notes.append(f"the response ran away: stopped at {found.overflow_at:g} s")
    tell(notes)
    assert found.history is not None
    if out is not None:
        write(out, history_bytes(found.history, out.suffix))
    if plot is not None:
        from aeroservo.report.gust_figures import flight_figure

        draw(plot, flight_figure(found.history, scenario, f"{file.name}: time history"))
    if as_json:
        print_json(heading(file.name, height, air, notes) | _content(found))
        return
    _print(file.name, found)


def _flown(
    file: FileModel,
    speed: float | None,
    profile: str | None,
    altitude: float | None,
    density: float | None,
    aero: AeroTheory | None,
    fit_bound: float,
) -> tuple[AeroelasticModel | LinearSystem, Profile, list[str]]:
    """What is simulated, the flight, and notes."""
    from aeroservo.aircraft.schema_other import StateSpaceFile
    from aeroservo.simulate.profiles import climb, level

    if isinstance(file, StateSpaceFile):
        return _linear(file, speed, profile, altitude, density)
    if (speed is None) == (profile is None):
        raise ValueError("give --speed M_S or --profile climb, one of them")
    if aero is AeroTheory.dlm:
        not_yet("--aero dlm (an unsteady lattice)")
    if profile is not None:
        if profile != "climb":
            raise ValueError(f"--profile must be climb, got {profile[:40]!r}")
        if altitude is not None or density is not None:
            raise ValueError("--profile climb has its own altitudes: leave out --altitude and --density")
        flight = climb()
    else:
        assert speed is not None
        condition_of(altitude, density, speed)  # refuses what is out of range
        flight = level(speed, altitude=altitude_of(altitude, density), density=density)
    return rational(built(file, aero), fit_bound), flight, list(file.problems())


def _linear(
    file: Any, speed: float | None, profile: str | None, altitude: float | None, density: float | None
) -> tuple[LinearSystem, Profile, list[str]]:
    """A linear model at its own condition."""
    from aeroservo.datatypes import LinearSystem
    from aeroservo.simulate.profiles import level

    m = file.model
    if profile is not None or density is not None:
        raise ValueError(f"{file.name} holds at one condition: leave out --profile and --density")
    for name, given, own, unit in (("--speed", speed, m.speed_m_s, "m/s"), ("--altitude", altitude, m.altitude_m, "m")):
        if given is not None and given != own:
            raise ValueError(f"{file.name} holds at {own:g} {unit} only, got {name} {given:g}")
    system = LinearSystem(A=m.A, B=m.B, C=m.C, D=m.D, states=m.states, inputs=m.inputs, outputs=m.outputs)
    return system, level(m.speed_m_s, altitude=m.altitude_m), list(file.problems())


def _weather(text: str | None, spectrum: Spectrum | None, specification: Specification | None) -> Gustiness | None:
    """Severity or RMS, spectrum and specification."""
    from aeroservo.simulate.disturbances import Gustiness

    if text is None:
        if spectrum is not None or specification is not None:
            raise ValueError("--spectrum and --specification are of --turbulence LEVEL: give that too")
        return None
    try:
        level: Any = float(text)
    except ValueError:
        level = text
        if text not in ("light", "moderate", "severe"):
            raise ValueError(
                f"--turbulence must be light, moderate, severe or an RMS [m/s], got {text[:40]!r}"
            ) from None
    return Gustiness(
        level=level,
        model=(spectrum or Spectrum.dryden).value,
        specification=(specification or Specification.mil_f_8785c).value,
    )


def _doublet(text: str) -> Doublet:
    """[CONTROL=]DEG:S@T."""
    from aeroservo.simulate.disturbances import Doublet

    control, equals, rest = text.rpartition("=")
    try:
        amplitude, rest = rest.split(":")
        duration, start = rest.split("@")
        numbers = math.radians(float(amplitude)), float(duration), float(start)
    except ValueError:
        raise ValueError(f"--doublet {text[:80]!r} must be DEG:S@T or CONTROL=DEG:S@T") from None
    name = f"{control}_command_rad" if equals and not control.endswith("_command_rad") else control
    return Doublet(amplitude=numbers[0], duration=numbers[1], start=numbers[2], command=name)


def _initial(text: str) -> tuple[str, float]:
    """STATE=VALUE."""
    name, _, value = text.partition("=")
    try:
        return name.strip(), float(value)
    except ValueError:
        raise ValueError(f"--initial {text[:80]!r} must be STATE=VALUE") from None


def _first_state(plant: AeroelasticModel | LinearSystem) -> str:
    """Pitch where there is one, else the first displacement."""
    from aeroservo.datatypes import LinearSystem

    if isinstance(plant, LinearSystem):
        return "pitch_rad" if "pitch_rad" in plant.states else plant.states[0]
    names = [f"{n.replace(' ', '_')}{'_' * bool(u)}{u}" for n, u in zip(plant.modes.names, plant.modes.units)]
    return "pitch_rad" if "pitch_rad" in names else names[0]


def _content(found: Simulation) -> dict[str, Any]:
    """Keys of contract.md, `simulate`."""
    cycle, left = found.limit_cycle, found.limit_left
    return {
        "bounded": found.bounded,
        "growth_1_s": found.growth,
        "limit_cycle": None if cycle is None else {"amplitude": cycle.amplitude, "frequency_Hz": cycle.frequency_Hz},
        "peak": dict(zip(found.channels, found.peak.tolist())),
        "rms": dict(zip(found.channels, found.rms.tolist())),
        "limit_left": None if left is None else {"channel": left.channel, "at_s": left.at_s},
    }


def _print(name: str, found: Simulation) -> None:
    """The result for people."""
    how = "exact steps" if found.method == "exact" else f"{found.substeps} Runge-Kutta steps in each"
    typer.echo(f"{name}: {found.duration:g} s in base steps of {1e3 * found.dt:g} ms, {how}")
    typer.echo(f"bounded     {'yes' if found.bounded else 'no'}")
    typer.echo(f"growth      {number(found.growth, '1/s')}")
    if found.limit_cycle is not None:
        c = found.limit_cycle
        typer.echo(f"limit cycle amplitude {number(c.amplitude)} at {number(c.frequency_Hz, 'Hz')}")
    if found.limit_left is not None:
        typer.echo(f"limit left  {found.limit_left.channel} at {number(found.limit_left.at_s, 's')}")
    rows = zip(found.channels, found.peak.tolist(), found.rms.tolist())
    typer.echo(table(rows, ("channel", "peak", "rms")))
