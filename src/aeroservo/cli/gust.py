"""The command `gust`. Over budget because a command's options are its signature."""

from __future__ import annotations

import math
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aeroservo.cli.loaded import air, altitude_of, draw, tell, tell_fit
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
    checked_bound,
    checked_output,
    condition_of,
    grid,
    numbers_of,
)
from aeroservo.cli.output import heading, not_yet, print_json, table

if TYPE_CHECKING:
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.datatypes import AeroelasticModel, LinearSystem
    from aeroservo.gust.intensity import Turbulence
    from aeroservo.studies.gust_loads import GustLoads
    from aeroservo.studies.root_loads import LoadRows


class DesignGust(StrEnum):
    """Words of `--design`."""

    unit = "unit"
    cs25 = "cs25"
    cs23 = "cs23"


class TurbulenceKind(StrEnum):
    """Words of `--turbulence-kind`."""

    dryden = "dryden"
    von_karman = "von_karman"
    von_karman_blockset = "von_karman_blockset"


Speed = Annotated[float | None, typer.Option("--speed", metavar="M_S", help="True airspeed, m/s.")]
Gradients = Annotated[
    str | None,
    typer.Option(
        "--gradients", metavar="MIN:MAX:STEP", help="Gust gradients H, half the length, m (default: ten from 9 to 107)."
    ),
]
Design = Annotated[
    DesignGust | None,
    typer.Option("--design", help="Gust velocity: 1 m/s, CS-25.341(a) (default, unless --density), CS-23.333(c)."),
]
Kind = Annotated[TurbulenceKind, typer.Option("--turbulence-kind", help="Spectrum of the unit turbulence.")]
Scale = Annotated[
    float | None,
    typer.Option("--scale-length", metavar="M", help="Scale length L (default 533.4 Dryden, 762 von Karman)."),
]
Spectra = Annotated[
    Path | None,
    typer.Option("--spectra", metavar="FILE", help="Write a figure of the turbulence spectra, .png or .pdf."),
]

#: Gradients where none are given.
COUNT = 10
#: Scale length above 2,000 ft. [m]
LENGTHS = {"dryden": 533.4, "von_karman": 762.0, "von_karman_blockset": 762.0}


def gust(
    model: Model,
    *,
    speed: Speed = None,
    altitude: Altitude = None,
    density: Density = None,
    gradients: Gradients = None,
    design: Design = None,
    turbulence_kind: Kind = TurbulenceKind.dryden,
    scale_length: Scale = None,
    controller: Controller = None,
    aero: Aero = None,
    fit_bound: FitBound = 0.01,
    plot: Plot = None,
    spectra: Spectra = None,
    as_json: Json = False,
) -> None:
    """Print peaks in discrete gusts, critical gradients, and RMS per unit turbulence.

    Parameters
    ----------
    model : str
        Preset or path.
    speed : float, optional
        True airspeed; only a state_space model brings its own. [m/s]
    altitude, density : float, optional
        Of the air. [m, kg/m^3]
    gradients : str, optional
        MIN:MAX:STEP. [m]
    design : DesignGust, optional
        Law of the gust velocity.
    turbulence_kind : TurbulenceKind
        Spectrum.
    scale_length : float, optional
        Of the turbulence. [m]
    controller : Path, optional
        Controller that closes the loop; of a sampled one the samples are held.
    aero : AeroTheory, optional
        Air forces; samples are fitted first.
    fit_bound : float
        Largest error of that fit. [-]
    plot : Path, optional
        Figure of peaks against gradient, and spectra of the response.
    spectra : Path, optional
        Figure of the spectra of the turbulence.
    as_json : bool
        As JSON.

    Raises
    ------
    ValueError
        For bad input.
    """
    from aeroservo.aircraft.files import read
    from aeroservo.control.controller import read_controller
    from aeroservo.datatypes import AeroelasticModel
    from aeroservo.studies.gust_loads import design_velocity, gust_loads
    from aeroservo.studies.gust_plant import gust_plant
    from aeroservo.studies.gust_sampled import sampled_gust_loads

    checked_output(plot, PLOTS, "--plot")
    checked_output(spectra, PLOTS, "--spectra")
    checked_bound(fit_bound)
    state = _turbulence(turbulence_kind, scale_length)
    file = read(model)
    flown, rows, speed, height = _model(file, aero, speed, altitude, density)
    condition = condition_of(height, density, speed)
    if rows is not None and rows.fit_error:
        if rows.fit_error > fit_bound:
            raise ValueError(
                f"the rational fit of these air forces is off by {100.0 * rows.fit_error:.2f} %, more than --fit-bound "
                f"{fit_bound:g} allows"
            )
        tell_fit(rows.fit_error)
    law = design or (DesignGust.unit if density is not None else DesignGust.cs25)
    where = altitude_of(height, density)
    velocity = design_velocity(law.value, altitude=where, density=float(condition.rho))
    H, bounds = _gradients(gradients, law, file, flown)
    velocity(H)  # refuses what the law does not cover
    loop = None if controller is None else read_controller(controller)
    kind: Any = turbulence_kind.value
    plant = None
    if loop is not None and loop.dt_s is not None and isinstance(flown, AeroelasticModel):
        found = sampled_gust_loads(
            flown, condition, loop, gradients=H, velocity=velocity, turbulence=state, filter=kind, loads=rows
        )
    else:
        plant = gust_plant(flown, condition, controller=loop, loads=rows)
        found = gust_loads(plant, gradients=H, velocity=velocity, bounds=bounds, turbulence=state, model=kind)
    notes = [*file.problems(), *found.notes]
    tell(notes)
    head = heading(file.name, where, float(condition.rho), notes)
    title = f"{file.name}: gusts at {speed:g} m/s, {air(head)}"
    if plot is not None:
        from aeroservo.report.gust_figures import gust_figure
        from aeroservo.studies.turbulence_spectra import response_spectra

        response = response_spectra(plant, state, kind) if found.stable and plant is not None else None
        draw(plot, gust_figure(found, title, spectra=response))
    if spectra is not None:
        from aeroservo.report.gust_figures import spectrum_figure
        from aeroservo.studies.turbulence_spectra import turbulence_spectra

        words = f"vertical turbulence of 1 m/s: {kind}, L = {state.length[2]:g} m, {speed:g} m/s"
        draw(spectra, spectrum_figure(turbulence_spectra(state, speed, model=kind), words))
    content = head | {"speed_m_s": speed, "design": law.value} | gust_content(found)
    content["turbulence"] = {"kind": kind, "scale_length_m": float(state.length[2]), "intensity_m_s": 1.0}
    if as_json:
        print_json(content)
    else:
        _print(title, law, kind, found)


def _turbulence(kind: TurbulenceKind, length: float | None) -> Turbulence:
    """Unit turbulence of one scale length."""
    from numpy import full, ones

    from aeroservo.gust.intensity import Turbulence

    if length is not None and not (math.isfinite(length) and length > 0.0):
        raise ValueError(f"--scale-length must be positive [m], got {length:g}")
    return Turbulence(intensity=ones(3), length=full(3, LENGTHS[kind.value] if length is None else length))


def _model(
    file: FileModel, aero: AeroTheory | None, speed: float | None, altitude: float | None, density: float | None
) -> tuple[AeroelasticModel | LinearSystem, LoadRows | None, float, float | None]:
    """The model with its loads, the airspeed and the altitude."""
    from aeroservo.aircraft.schema_other import StateSpaceFile
    from aeroservo.cli.simulate import _linear
    from aeroservo.studies.root_loads import with_loads

    if isinstance(file, StateSpaceFile):
        if aero is not None:
            raise ValueError(f"{file.name}: a state_space model has no --aero of its own choice")
        system, flight, _ = _linear(file, speed, None, altitude, density)
        return system, None, float(flight.V[0]), file.model.altitude_m
    if speed is None:
        raise ValueError("gust needs the airspeed: --speed M_S")
    if aero is AeroTheory.dlm:
        not_yet("--aero dlm (an unsteady lattice)")
    try:
        found, rows = with_loads(file, aero.value if aero else None)
    except ValueError as error:
        raise ValueError(f"{file.name}: {error}") from error
    return found, rows, speed, altitude


def _gradients(
    text: str | None, law: DesignGust, file: FileModel, model: Any
) -> tuple[list[float], tuple[float, float] | None]:
    """Gradients asked for, and the range in which the worst is sought."""
    from aeroservo.datatypes import LinearSystem
    from aeroservo.gust.design_gusts import cs25_gradients

    if text is not None:
        low, high, step = numbers_of(text, "--gradients", "m")
        if not low > 0.0:
            raise ValueError(f"--gradients = {text[:80]!r} must be positive [m]")
        H = grid(low, high, step)
        if len(H) > 2000:
            raise ValueError(f"--gradients = {text[:80]!r} has {len(H)} values, more than 2,000: take a larger STEP")
        return H, (low, high)
    if law is DesignGust.cs23:
        if isinstance(model, LinearSystem):
            raise ValueError(f"{file.name} has no chord, which --design cs23 goes by: give --gradients")
        return [12.5 * 2.0 * float(model.aero.b)], None  # 25 chords long
    H = cs25_gradients(COUNT).tolist()
    return H, (H[0], H[-1])


def gust_content(found: GustLoads) -> dict[str, Any]:
    """What `gust --json` says about a result.

    Parameters
    ----------
    found : GustLoads
        Of `gust_loads`.

    Returns
    -------
    content : dict
        Without the heading.
    """
    critical = None
    if found.critical is not None:
        c = found.critical
        critical = {
            name: {"gradient_m": c.gradient[i], "peak": c.peak[i], "at_limit": bool(c.at_limit[i])}
            if c.peak[i] > 0.0
            else None
            for i, name in enumerate(found.channels)
        }
    return {
        "stable": found.stable,
        "growth_1_s": found.growth,
        "cases": [
            {"gradient_m": H, "velocity_m_s": U, "peak": dict(zip(found.channels, row.tolist()))}
            for H, U, row in zip(found.gradient.tolist(), found.velocity.tolist(), found.peak)
        ],
        "critical": critical,
        "rms_per_unit": dict(zip(found.channels, found.rms.tolist())),
        "rms_per_unit_by_frequency": dict(zip(found.channels, found.rms_by_frequency.tolist())),
    }


def _print(title: str, law: DesignGust, kind: str, found: GustLoads) -> None:
    """The result for people."""
    words = {"unit": "of 1 m/s", "cs25": "of CS-25.341(a)", "cs23": "of CS-23.333(c)"}[law.value]
    H = found.gradient
    span = f"gradient {H[0]:g} m" if len(H) == 1 else f"{len(H)} gradients from {H[0]:g} to {H[-1]:g} m"
    typer.echo(f"{title}\n1-cosine gusts {words}, {span}; {kind} turbulence of 1 m/s RMS")
    if not found.stable:
        typer.echo(f"unstable: a root grows at {found.growth:.4g} 1/s, so there are no peaks and no RMS")
        return
    rows = []
    for i, name in enumerate(found.channels):
        worst = int(found.peak[:, i].argmax())
        peak, at, edge = found.peak[worst, i], float(found.gradient[worst]), ""
        if found.critical is not None and found.critical.peak[i] > 0.0:
            peak, at = found.critical.peak[i], float(found.critical.gradient[i])
            edge = "end of range" if found.critical.at_limit[i] else ""
        if peak > 0.0 and "_rate" not in name and "command" not in name:
            rows.append((name, float(peak), at, edge, float(found.rms[i]), float(found.rms_by_frequency[i])))
    header = ("channel", "largest peak", "at gradient, m", "", "RMS per m/s", "by frequency")
    typer.echo(table(rows, header))
