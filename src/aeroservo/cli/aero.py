"""The command `aero`: derivatives of the whole aircraft from the lattice, wing polars, span loading, trim."""

from __future__ import annotations

import re
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aeroservo.cli.angles import csv_bytes, values_of
from aeroservo.cli.loaded import air, altitude_of, draw, tell
from aeroservo.cli.options import PLOTS, Altitude, Density, Json, Model, Plot, checked_output, condition_of
from aeroservo.cli.output import complain, heading, number, print_json, table, write
from aeroservo.cli.polar import Chosen, PolarSource

if TYPE_CHECKING:
    import numpy as np

    from aeroservo.aero.coefficients import AeroCoefficients
    from aeroservo.aero.viscous_wing import WingPolar
    from aeroservo.aeroelastic.aircraft_lattice import AircraftLattice
    from aeroservo.aircraft.aircraft_schema import AircraftFile
    from aeroservo.studies.aero_views import WingCase

Out = Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write all derivatives, .csv.")]
PolarOut = Annotated[
    Path | None, typer.Option("--polar-out", metavar="FILE", help="Write the wing's polars, .csv; needs --speed.")
]
LoadingOut = Annotated[
    Path | None, typer.Option("--loading-out", metavar="FILE", help="Write the span loading per unit input, .csv.")
]
Speed = Annotated[
    float | None, typer.Option("--speed", metavar="M_S", help="Airspeed of the section polars: adds friction drag.")
]
Alpha = Annotated[str, typer.Option("--alpha", metavar="MIN:MAX:STEP", help="Angles of the wing's polars, deg.")]
Deflections = Annotated[
    str, typer.Option("--deflection", metavar="LIST", help="Deflections of all controls, deg; or MIN:MAX:STEP.")
]
Lift = Annotated[
    float, typer.Option("--lift", metavar="CL", help="Lift coefficient of the figures 'loading' and 'trim'.")
]
Mach = Annotated[float, typer.Option("--mach", metavar="M", help="Mach number of the Prandtl-Glauert rule.")]
Panels = Annotated[
    str | None, typer.Option("--panels", metavar="NxM", help="Panels along the chord x strips of a half (24x32).")
]
#: Columns of the table of derivatives.
COEFFICIENTS = ("CL", "CY", "Cl", "CM", "Cn")


class AeroFigure(StrEnum):
    """Words of `--figure`."""

    polars = "polars"
    morphed = "morphed"
    loading = "loading"
    trim = "trim"


Figure = Annotated[
    AeroFigure | None,
    typer.Option("--figure", help="What --plot draws (default: polars with --speed, else loading)."),
]


def aero(
    model: Model,
    *,
    speed: Speed = None,
    altitude: Altitude = None,
    density: Density = None,
    alpha: Alpha = "-4:12:1",
    deflection: Deflections = "-5,0,5",
    lift: Lift = 0.3,
    mach: Mach = 0.0,
    panels: Panels = None,
    source: Chosen = PolarSource.auto,
    out: Out = None,
    polar_out: PolarOut = None,
    loading_out: LoadingOut = None,
    plot: Plot = None,
    figure: Figure = None,
    as_json: Json = False,
) -> None:
    """Print the coefficients and derivatives of an aircraft.

    Parameters
    ----------
    model : str
        Preset or path, of kind `aircraft`.
    speed, altitude, density : float, optional
        Reynolds numbers of the sections; without a speed there is no friction drag. [m/s, m, kg/m^3]
    alpha, deflection : str
        Axes of the wing's polars. [deg, deg]
    lift : float
        Lift coefficient of two of the figures. [-]
    mach : float
        Mach number. [-]
    panels : str, optional
        NxM.
    source : PolarSource
        What section polars are taken from.
    out, polar_out, loading_out, plot : Path, optional
        Tables, figure.
    figure : AeroFigure, optional
        What is drawn.
    as_json : bool
        As JSON.

    Raises
    ------
    ValueError
        For bad input.
    """
    import numpy as np

    from aeroservo.aeroelastic.aircraft_lattice import aircraft_lattice, lattice_coefficients
    from aeroservo.studies.aero_views import WingCase
    from aeroservo.studies.aircraft_aero import kinematic_viscosity, read_aircraft

    for path, option in ((out, "--out"), (polar_out, "--polar-out"), (loading_out, "--loading-out")):
        checked_output(path, (".csv",), option)
    checked_output(plot, PLOTS, "--plot")
    wanted = figure or (AeroFigure.loading if speed is None else AeroFigure.polars)
    _check(speed, wanted, plot, polar_out)
    case = WingCase(
        model=read_aircraft(model),
        alpha=np.radians(values_of(alpha, "--alpha", "deg", -90.0, 90.0)),
        delta=np.radians(values_of(deflection, "--deflection", "deg", -40.0, 40.0)),
        speed=speed,
        viscosity=kinematic_viscosity(altitude or 0.0, density),
        method=_method(panels, mach),
        source=source.value,
        progress=complain,
    )
    file, condition = case.model, condition_of(altitude, density, speed or 1.0)
    notes = [*file.problems()]
    fast = float(condition.mach)
    if fast > 0.3 and mach == 0.0:
        notes.append(f"{speed:g} m/s is Mach {fast:.2f}: incompressible theory; --mach {fast:.2f} corrects it")
    found = aircraft_lattice(file.surfaces(), file.references(), method=case.method)
    polars = case.polars() if speed is not None else ()
    notes += _marks(case, polars)
    tell(notes)
    head = heading(file.name, altitude_of(altitude, density), float(condition.rho), notes)
    coefficients = lattice_coefficients(found)
    _write(found, case, polars, out=out, polar_out=polar_out, loading_out=loading_out)
    if plot is not None:
        draw(plot, _figure(wanted, case, found, lift, f"{file.name}, {air(head)}"))
    content = _content(coefficients)
    if as_json:
        print_json(head | content)
        return
    _print(file, found, content, coefficients.source)
    _print_polars(case, polars)


def _content(coefficients: AeroCoefficients) -> dict[str, Any]:
    """The keys of the contract."""
    ref = coefficients.reference
    return {
        "CL_alpha": coefficients.CL_alpha,
        "CM_alpha": coefficients.CM_alpha,
        "CL_q": coefficients.CL_q,
        "CM_q": coefficients.CM_q,
        "CL_delta": dict(zip(coefficients.controls, map(float, coefficients.CL_delta))),
        "CM_delta": dict(zip(coefficients.controls, map(float, coefficients.CM_delta))),
        "CL0": coefficients.CL0,
        "CM0": coefficients.CM0,
        "neutral_point_m": coefficients.neutral_point,
        "span_efficiency": coefficients.span_efficiency,
        "reference": {
            "S_m2": ref.S,
            "c_m": ref.c,
            "span_m": ref.b,
            "moment_point_m": ref.point,
            "rates": coefficients.rates,
        },
    }


def _check(speed: float | None, wanted: AeroFigure, plot: Path | None, polar_out: Path | None) -> None:
    """Refuse what needs section polars where no airspeed is given."""
    if speed is not None:
        return
    if plot is not None and wanted is not AeroFigure.loading:
        raise ValueError(f"--figure {wanted.value} needs the airspeed, for the sections' Reynolds numbers: --speed M_S")
    if polar_out is not None:
        raise ValueError("--polar-out needs the airspeed, for the sections' Reynolds numbers: --speed M_S")


def _method(panels: str | None, mach: float) -> Any:
    """The lattice asked for."""
    from dataclasses import replace

    from aeroservo.studies.aircraft_aero import PANELS

    if not 0.0 <= mach < 1.0:
        raise ValueError(f"--mach must be at least 0 and less than 1 [-], got {mach:g}")
    if panels is None:
        return replace(PANELS, mach=mach)
    match = re.fullmatch(r"(\d{1,4})[xX](\d{1,4})", panels)
    if not match or not (1 <= int(match[1]) <= 200 and 2 <= int(match[2]) <= 500):
        raise ValueError(
            f"--panels {panels[:40]!r} must be NxM, N from 1 to 200 along the chord, M from 2 to 500 strips"
        )
    return replace(PANELS, chordwise=int(match[1]), spanwise=int(match[2]), mach=mach)


def _marks(case: WingCase, polars: tuple[WingPolar, ...]) -> list[str]:
    """What to know about stalled strips and strips outside their polars."""
    import numpy as np

    from aeroservo.aero.viscous_wing import marks_in_words

    notes = []
    for d, polar in zip(np.degrees(case.delta), polars):
        marked = [(a, words) for a, words in zip(np.degrees(case.alpha), marks_in_words(polar)) if words]
        if marked:
            a, words = marked[0]
            notes.append(
                f"deflection {d:g} deg: {len(marked)} of {len(case.alpha)} angles are marked, as at {a:g} deg: {words}"
            )
    return notes


def _write(
    found: AircraftLattice,
    case: WingCase,
    polars: tuple[WingPolar, ...],
    *,
    out: Path | None,
    polar_out: Path | None,
    loading_out: Path | None,
) -> None:
    """The CSV files asked for."""
    import numpy as np

    from aeroservo.aero.viscous_wing import marks_in_words
    from aeroservo.aero.vlm_loads import span_loading

    d = found.derivatives
    if out is not None:
        r = d.reference
        comments = (
            f"S = {r.S!r} m2, c = {r.c!r} m, b = {r.b!r} m, moments about x, y, z = {r.point} m, Mach {d.mach:g}",
            "per radian; p, r with b/(2V), q with c/(2V); 'steady' is camber and twist; stability axes at alpha = 0",
        )
        rows = [(name, *(float(getattr(d, key)[i]) + 0.0 for key in COEFFICIENTS)) for i, name in enumerate(d.names)]
        write(out, csv_bytes(("input", *COEFFICIENTS), rows, comments))
    if loading_out is not None:
        load = span_loading(found.solution)
        columns = (load.surface, load.side, load.y, load.z, load.chord, load.width)
        rows = [(*(c[i].item() for c in columns), *map(float, load.cl[i])) for i in range(len(load.y))]
        header = ("surface", "side", "y_m", "z_m", "chord_m", "width_m", *(f"cl_{name}" for name in load.names))
        write(loading_out, csv_bytes(header, rows, ("section lift coefficient on the local chord per unit input",)))
    if polar_out is not None:
        rows = [
            (
                float(np.degrees(delta).round(9)),
                float(np.degrees(a).round(9)),
                *(float(v[i]) for v in _columns(polar)),
                words,
            )
            for delta, polar in zip(case.delta, polars)
            for i, (a, words) in enumerate(zip(case.alpha, marks_in_words(polar)))
        ]
        header = ("delta_deg", "alpha_deg", *POLAR_COLUMNS, "note")
        write(polar_out, csv_bytes(header, rows, (f"wing, {case.speed:g} m/s, nu = {case.viscosity!r} m2/s",)))


#: Columns of the wing's polars.
POLAR_COLUMNS = ("CL", "CD", "CD_induced", "CD_profile", "CM", "CM_inviscid", "L_over_D", "L_over_D_inviscid")


def _columns(polar: WingPolar) -> tuple[np.ndarray, ...]:
    """The values under `POLAR_COLUMNS`."""
    return (
        polar.CL, polar.CD, polar.CD_induced, polar.CD_profile, polar.CM_viscous, polar.CM, polar.lift_to_drag,
        polar.lift_to_drag_inviscid,
    )  # fmt: skip


def _figure(wanted: AeroFigure, case: WingCase, found: AircraftLattice, lift: float, title: str) -> Any:
    """The figure asked for."""
    import numpy as np

    from aeroservo.report import aero_figures as figures
    from aeroservo.studies.aircraft_aero import inputs_at_lift

    if wanted is AeroFigure.loading:
        states = [
            (f"deflection {d:+g}°" if d else "deflection 0°", inputs_at_lift(found, lift, float(np.radians(d))))
            for d in np.degrees(case.delta).round(9)
        ]
        return figures.span_loading_figure(found, states, f"{title}: span loading at CL = {lift:g}")
    title = f"{title}, {case.speed:g} m/s"
    if wanted is AeroFigure.trim:
        trims = case.trims(lift)
        own = case.model.masses()
        return figures.trim_figure(
            trims,
            f"{title}: in trim at CL = {lift:g}\ncurves end where no balance lies inside the section polars",
            neutral_point=found.derivatives.neutral_point,
            x_cg=None if own is None else float(own.cg[0]),
        )
    groups = case.both_kinds() if wanted is AeroFigure.morphed else [("", case.delta, case.polars())]
    return figures.wing_polar_figure(case.alpha, groups, f"{title}: wing polars")


def _print(file: AircraftFile, found: AircraftLattice, content: dict[str, Any], source: str) -> None:
    """Derivatives for people."""
    d, ref = found.derivatives, content["reference"]
    typer.echo(f"{file.name}: {source}")
    x, _, z = ref["moment_point_m"]
    typer.echo(
        f"reference   S = {ref['S_m2']:.6g} m2, c = {ref['c_m']:.6g} m, b = {ref['span_m']:.6g} m, "
        f"moments about x = {x:.6g} m, z = {z:.6g} m\n"
    )
    rows = [(name, *(_short(getattr(d, key)[i]) for key in COEFFICIENTS)) for i, name in enumerate(d.names)]
    typer.echo(table(rows, ("per radian of", *COEFFICIENTS)))
    typer.echo("('steady': camber and twist as they are; p, r with b/(2V), q with c/(2V); controls streamwise)\n")
    typer.echo(f"neutral point    x = {number(content['neutral_point_m'], 'm', 5)}")
    masses = file.masses()
    if masses is not None:
        margin = 100.0 * float(d.static_margin(float(masses.cg[0])))
        words = "stable" if margin > 0.0 else "unstable"
        typer.echo(
            f"static margin    {margin:.4g} % of c at the file's centre of gravity, x = {masses.cg[0]:.5g} m: {words}"
        )
    typer.echo(f"span efficiency  {number(content['span_efficiency'], '', 5)}")


def _short(value: float) -> float:
    """Five digits; rounding errors and minus zero are zero."""
    return 0.0 if abs(value) < 1e-12 else float(f"{value:.5g}")


def _print_polars(case: WingCase, polars: tuple[WingPolar, ...]) -> None:
    """The wing's polars for people."""
    import numpy as np

    if not polars:
        typer.echo("\nwith friction drag and the sections' moments: --speed M_S")
        return
    rows = []
    for delta, polar in zip(np.degrees(case.delta), polars):
        for i, a in enumerate(np.degrees(case.alpha).round(9)):
            values = (polar.CL, polar.CD, polar.CD_induced, polar.CM_viscous, polar.lift_to_drag)
            mark = "marked" if polar.stalled[i] else ""
            rows.append((float(delta.round(9)), float(a), *(float(f"{v[i]:.4g}") for v in values), mark))
    typer.echo(
        f"\nwing at {case.speed:g} m/s (section polars on the span loading, induced drag from the Trefftz plane)"
    )
    typer.echo(table(rows, ("deflection, deg", "alpha, deg", "CL", "CD", "CD induced", "CM", "L/D", "")))
    typer.echo(f"section polars: {case.said()}")
