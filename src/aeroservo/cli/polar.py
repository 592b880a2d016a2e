"""The command `polar`: lift, drag and moment of an aircraft's airfoil with its control deflected."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aeroservo.cli.angles import csv_bytes, values_of
from aeroservo.cli.loaded import altitude_of, draw, tell
from aeroservo.cli.options import PLOTS, Altitude, Density, Json, Model, Plot, checked_output, condition_of
from aeroservo.cli.output import complain, heading, print_json, table, write

if TYPE_CHECKING:
    from aeroservo.aero.polars import Polar
    from aeroservo.aircraft.aircraft_schema import AircraftFile
    from aeroservo.aircraft.geometry import ControlSurface, LiftingSurface

#: Reynolds numbers of the thesis' figure 21, where nothing else is asked for.
REYNOLDS = "0.5e6,1e6,1.5e6,2.5e6"


class PolarSource(StrEnum):
    """Words of `--source`."""

    auto = "auto"
    table = "table"
    neuralfoil = "neuralfoil"
    xfoil = "xfoil"


class Kind(StrEnum):
    """Words of `--kind`."""

    hinged = "hinged"
    morphed = "morphed"


Foil = Annotated[
    str | None, typer.Option("--airfoil", metavar="NAME", help="Another airfoil: mh62, naca2412, a .dat file.")
]
Alpha = Annotated[str, typer.Option("--alpha", metavar="MIN:MAX:STEP", help="Angles of attack, deg; or a list.")]
Deflections = Annotated[
    str, typer.Option("--deflection", metavar="LIST", help="Trailing edge down, deg; or MIN:MAX:STEP.")
]
Numbers = Annotated[
    str | None,
    typer.Option("--reynolds", metavar="LIST", help=f"Reynolds numbers (default {REYNOLDS}, or by --speed)."),
]
Speed = Annotated[
    float | None, typer.Option("--speed", metavar="M_S", help="Reynolds number of the mean chord at this speed.")
]
SurfaceName = Annotated[
    str | None, typer.Option("--surface", metavar="NAME", help="Surface that lends airfoil and control.")
]
PolarFiles = Annotated[
    list[Path] | None,
    typer.Option("--polar-file", metavar="FILE", help="Read XFOIL's polar files instead; repeatable."),
]
Chosen = Annotated[PolarSource, typer.Option("--source", help="What the polars are taken from.")]


def polar(
    model: Model,
    *,
    alpha: Alpha = "-4:12:0.5",
    deflection: Deflections = "-10,-5,0,5,10",
    reynolds: Numbers = None,
    speed: Speed = None,
    altitude: Altitude = None,
    density: Density = None,
    surface: SurfaceName = None,
    airfoil: Foil = None,
    kind: Annotated[Kind | None, typer.Option("--kind", help="Kind of control (default: the surface's).")] = None,
    source: Chosen = PolarSource.auto,
    polar_file: PolarFiles = None,
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the polars, .csv.")] = None,
    plot: Plot = None,
    as_json: Json = False,
) -> None:
    """Print section polars.

    Parameters
    ----------
    model : str
        Preset or path, of kind `aircraft`.
    alpha, deflection, reynolds : str
        Axes. [deg, deg, -]
    speed, altitude, density : float, optional
        The Reynolds number of the mean chord. [m/s, m, kg/m^3]
    surface, airfoil : str, optional
        Which section; the first surface's first by default.
    kind : Kind, optional
        Kind of control.
    source : PolarSource
        What the polars are taken from.
    polar_file : list of Path, optional
        Polar files of XFOIL, undeflected.
    out, plot : Path, optional
        Table, figure.
    as_json : bool
        As JSON; CL, CD, CM and L_over_D are nested [reynolds][deflection][alpha].

    Raises
    ------
    ValueError
        For bad input.
    """
    import numpy as np

    from aeroservo.studies.aircraft_aero import read_aircraft
    from aeroservo.studies.section_polar import polar_of_files, resampled, section_polar

    checked_output(out, (".csv",), "--out")
    checked_output(plot, PLOTS, "--plot")
    file = read_aircraft(model)
    chosen = _surface(file, surface)
    axes = [np.radians(values_of(alpha, "--alpha", "deg", -90.0, 90.0))]
    axes.append(np.radians(values_of(deflection, "--deflection", "deg", -40.0, 40.0)))
    air = condition_of(altitude, density, 1.0 if speed is None else speed)
    notes: list[str] = []
    if polar_file:
        found = polar_of_files(polar_file)
        found = resampled(found, axes[0], found.delta, found.reynolds)
        notes.append("the polar files are taken as undeflected")
    else:
        numbers = _reynolds(chosen, reynolds, speed, altitude or 0.0, density)
        control = chosen.controls[0] if chosen.controls else None
        found = section_polar(
            airfoil or chosen.sections[0].airfoil,
            alpha=axes[0],
            delta=axes[1],
            reynolds=numbers,
            kind=kind.value if kind else control.kind if control else "hinged",
            hinge=control.hinge_from if control else 0.75,
            reading=control.reading if control else "same_drop",
            source=source.value,
            progress=complain,
        )
        notes += _notes(chosen, control, airfoil)
    missing = int(np.isnan(found.CL).sum())
    if missing == found.CL.size:
        raise ValueError(f"{found.name}: no point of the polar has an answer; {found.source}; narrow --alpha")
    if missing:
        notes.append(f"{missing} of {found.CL.size} points have no converged or trusted answer and are left empty")
    tell(notes)
    _show(file, found, notes, altitude_of(altitude, density), float(air.rho), out=out, plot=plot, as_json=as_json)


def _show(
    file: AircraftFile,
    found: Polar,
    notes: list[str],
    altitude: float | None,
    density: float,
    *,
    out: Path | None,
    plot: Path | None,
    as_json: bool,
) -> None:
    """Write, draw and print a polar."""
    import numpy as np

    ratio = found.CL / found.CD
    degrees, deflections = np.degrees(found.alpha).round(9), np.degrees(found.delta).round(9)
    if out is not None:
        rows = [
            (float(re), float(d), float(a), *(float(t[i, j, k]) for t in (found.CL, found.CD, found.CM, ratio)))
            for i, re in enumerate(found.reynolds)
            for j, d in enumerate(deflections)
            for k, a in enumerate(degrees)
        ]
        header = ("reynolds", "delta_deg", "alpha_deg", "CL", "CD", "CM", "L_over_D")
        write(out, csv_bytes(header, rows, (f"{found.name}; CM about the quarter chord", f"source: {found.source}")))
    if plot is not None:
        from aeroservo.report.aero_figures import section_polar_figure

        draw(plot, section_polar_figure(found, f"{file.name}: {found.name}"))
    if as_json:
        print_json(
            heading(file.name, altitude, density, notes)
            | {
                "alpha_deg": degrees,
                "reynolds": found.reynolds,
                "deflection_deg": deflections,
                "CL": found.CL,
                "CD": found.CD,
                "CM": found.CM,
                "L_over_D": ratio,
                "source": found.source,
            }
        )
        return
    typer.echo(f"{file.name}: {found.name}\nsource: {found.source}\n")
    best = []
    for i, re in enumerate(found.reynolds):
        for j, d in enumerate(deflections):
            zero = np.interp(0.0, found.alpha, found.CL[i, j], left=np.nan, right=np.nan)
            top = np.nanmax(found.CL[i, j]) if np.any(np.isfinite(found.CL[i, j])) else np.nan
            best.append((f"{re:.4g}", float(d), float(zero), float(top), *_best(found, i, j)))
    names = ("Reynolds", "deflection, deg", "CL at 0", "largest CL", "best L/D", "alpha, deg", "CL there", "CM there")
    typer.echo(table(best, names))
    typer.echo("\nthe whole polars: --out FILE.csv or --json")


def _best(found: Polar, i: int, j: int) -> tuple[float | None, ...]:
    """Best L/D by a running median of three points, so that one wild point cannot win, and the state there."""
    import numpy as np

    from aeroservo.aero.polars import best_lift_to_drag

    if np.isfinite(found.CL[i, j] / found.CD[i, j]).sum() < 3:
        return (None,) * 4
    ratio, alpha = best_lift_to_drag(found, reynolds=float(found.reynolds[i]), delta=float(found.delta[j]))
    k = int(np.argmin(np.abs(found.alpha - alpha)))
    values = (ratio, float(np.degrees(alpha)), float(found.CL[i, j, k]), float(found.CM[i, j, k]))
    return tuple(float(f"{v:.5g}") for v in values)


def _surface(file: AircraftFile, name: str | None) -> LiftingSurface:
    """The surface asked for."""
    surfaces = file.surfaces()
    if name is None:
        return surfaces[0]
    for surface in surfaces:
        if surface.name == name:
            return surface
    raise ValueError(f"--surface {name[:60]!r}: the surfaces of {file.name} are {', '.join(s.name for s in surfaces)}")


def _reynolds(
    surface: LiftingSurface, text: str | None, speed: float | None, altitude: float, density: float | None
) -> list[float]:
    """Reynolds numbers asked for, or that of the mean chord at the speed."""
    from aeroservo.aircraft.planform import planform
    from aeroservo.studies.aircraft_aero import kinematic_viscosity

    if text is not None and speed is not None:
        raise ValueError("give --reynolds or --speed, not both")
    if speed is not None:
        return [speed * planform(surface).mac / kinematic_viscosity(altitude, density)]
    return values_of(text or REYNOLDS, "--reynolds", "-", 1e3, 1e9)


def _notes(surface: LiftingSurface, control: ControlSurface | None, airfoil: str | None) -> list[str]:
    """What was chosen where the file offers several."""
    names = list(dict.fromkeys(s.airfoil for s in surface.sections))
    notes = []
    if airfoil is None and len(names) > 1:
        notes.append(f"surface {surface.name!r} has airfoils {', '.join(names)}: this is {names[0]}; --airfoil chooses")
    if control is None:
        notes.append(f"surface {surface.name!r} has no control: deflections are those of a hinge at 0.75 of the chord")
    elif control.hinge_from != control.hinge_to:
        notes.append(f"control {control.name!r}: the hinge at its inboard end, {control.hinge_from:g} of the chord")
    return notes
