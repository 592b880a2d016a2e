"""Options that several commands share, and what they mean: sweeps, flight conditions, output files."""

from __future__ import annotations

import math
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.datatypes import FlightCondition

#: Sweep where neither option nor file gives one. [m/s]
SPEEDS = (1.0, 350.0, 1.0)
#: Endings of figures.
PLOTS = (".png", ".pdf")
_MOST = 100_000  # numbers in one range


class AeroTheory(StrEnum):
    """Words of `--aero`."""

    quasi_steady = "quasi_steady"
    quasi_steady_damped = "quasi_steady_damped"
    jones = "jones"
    theodorsen = "theodorsen"
    dlm = "dlm"


class FlutterMethod(StrEnum):
    """Words of `--method` of `flutter`."""

    p = "p"
    pk = "pk"
    k = "k"
    g = "g"


Model = Annotated[str, typer.Argument(metavar="MODEL", help="Name of a preset, or path of a model file.")]
Altitude = Annotated[
    float | None, typer.Option("--altitude", metavar="M", help="Geopotential altitude, m (default 0).")
]
Density = Annotated[float | None, typer.Option("--density", metavar="KG_M3", help="Air density instead, kg/m3.")]
Speeds = Annotated[
    str | None,
    typer.Option("--speeds", metavar="MIN:MAX:STEP", help="True airspeeds, m/s (default: the file's, or 1:350:1)."),
]
Json = Annotated[bool, typer.Option("--json", help="One JSON object on stdout, nothing else.")]
Plot = Annotated[Path | None, typer.Option("--plot", metavar="FILE", help="Write a figure, .png or .pdf.")]
Aero = Annotated[AeroTheory | None, typer.Option("--aero", help="Air forces (default: by kind of model).")]
Method = Annotated[FlutterMethod | None, typer.Option("--method", help="How roots are found (default: by kind).")]
FitBound = Annotated[
    float, typer.Option("--fit-bound", help="Largest error of a rational fit, part of the largest |Q| of a column.")
]
Over = Annotated[
    list[str] | None,
    typer.Option("--over", metavar="FIELD=MIN:MAX:STEP", help="Vary a number of the model file; once or twice."),
]
Sensitivities = Annotated[
    bool, typer.Option("--sensitivities", help="Derivatives of the speeds to the numbers of the model file.")
]
Controller = Annotated[Path | None, typer.Option("--controller", metavar="FILE", help="Close the loop with this.")]


def numbers_of(text: str, what: str, unit: str) -> tuple[float, float, float]:
    """The three numbers of MIN:MAX:STEP.

    Parameters
    ----------
    text : str
        As typed.
    what : str
        The option, for errors.
    unit : str
        Unit of the numbers, for errors.

    Returns
    -------
    low, high, step : float
        Finite, MIN < MAX, STEP positive, at most 100,000 values. [`unit`]

    Raises
    ------
    ValueError
        Naming the option, what was typed and what is allowed.
    """
    try:
        low, high, step = (float(part) for part in text.split(":"))
    except ValueError:
        raise ValueError(f"{what} = {text[:80]!r} must be three numbers MIN:MAX:STEP [{unit}]") from None
    if not (all(math.isfinite(x) for x in (low, high, step)) and low < high and step > 0.0):
        raise ValueError(f"{what} = {text[:80]!r} must have MIN < MAX and a positive STEP [{unit}]")
    if (high - low) / step > _MOST:
        raise ValueError(f"{what} = {text[:80]!r} has more than {_MOST:,} values: take a larger step")
    return low, high, step


def sweep_of(model: FileModel, speeds: str | None) -> tuple[float, float, float]:
    """Lowest, highest and step of the airspeed: from the option, else the file, else 1:350:1.

    Parameters
    ----------
    model : FileModel
        The model file.
    speeds : str, optional
        The option `--speeds`.

    Returns
    -------
    low, high, step : float
        True airspeed. [m/s]

    Raises
    ------
    ValueError
        If the speeds are reversed, not positive or too many.
    """
    from aeroservo.aircraft.schema_base import checked_speeds

    if speeds is None:
        return model.speeds_m_s or SPEEDS
    return checked_speeds(numbers_of(speeds, "--speeds", "m/s"))


def condition_of(
    altitude: float | None, density: float | None, sweep: tuple[float, float, float] | float
) -> FlightCondition:
    """The flight condition of the options.

    Parameters
    ----------
    altitude : float, optional
        Geopotential altitude, 0 if neither is given. [m]
    density : float, optional
        Air density; the speed of sound is then that of sea level. [kg/m^3]
    sweep : tuple or float
        Lowest, highest and step, or one true airspeed. [m/s]

    Returns
    -------
    condition : FlightCondition
        Speeds from lowest to highest, both included. [m/s, kg/m^3]

    Raises
    ------
    ValueError
        If both altitude and density are given, or one is out of range.
    """
    from aeroservo.datatypes import FlightCondition

    V = [sweep] if isinstance(sweep, float | int) else grid(*sweep)
    if not all(0.0 < v <= 1e4 for v in (V[0], V[-1])):
        raise ValueError(f"the airspeed must be greater than 0 and at most 10000 [m/s], got {V[0]:g}")
    if isinstance(sweep, float | int):
        V = V[0]  # type: ignore[assignment]
    if altitude is not None and density is not None:
        raise ValueError("give --altitude or --density, not both")
    if density is None:
        return FlightCondition.at(0.0 if altitude is None else altitude, V=V)
    if not 0.0 <= density <= 1e5:
        raise ValueError(f"--density must be from 0 to 100,000 [kg/m^3], got {density:g}")
    return FlightCondition(V=V, rho=density)  # type: ignore[arg-type]


def grid(low: float, high: float, step: float) -> list[float]:
    """Values from low to high, both included; the last step may be shorter.

    Parameters
    ----------
    low, high, step : float
        Ends and step. [any]

    Returns
    -------
    values : list of float
        Ascending. [any]
    """
    n = math.floor((high - low) / step * (1.0 + 1e-12) + 1e-9)
    values = [min(low + i * step, high) for i in range(n + 1)]
    if high - values[-1] > 1e-9 * step:
        values.append(high)
    return values


def checked_bound(bound: float) -> None:
    """Refuse a bound of the rational fit that is no part.

    Parameters
    ----------
    bound : float
        The option `--fit-bound`. [-]

    Raises
    ------
    ValueError
        Unless it lies between 0 and 1.
    """
    if not 0.0 < bound < 1.0:
        raise ValueError(f"--fit-bound must be greater than 0 and less than 1 [-], got {bound:g}")


def checked_output(path: Path | None, endings: tuple[str, ...], option: str) -> None:
    """Refuse an output file before any work is done for it.

    Parameters
    ----------
    path : Path, optional
        Where the result is to go.
    endings : tuple of str
        Allowed endings, with their dots.
    option : str
        The option, for errors.

    Raises
    ------
    ValueError
        If the ending is another, the folder does not exist, or the path is a folder.
    """
    if path is None:
        return
    if path.suffix.lower() not in endings:
        raise ValueError(f"{option} {path}: the file must end in {' or '.join(endings)}")
    try:
        if path.is_dir() or not path.parent.is_dir():
            raise ValueError(f"{option} {path}: {'is a folder' if path.is_dir() else 'its folder does not exist'}")
    except OSError as error:
        raise ValueError(f"{option} {path}: {error.strerror}") from None
