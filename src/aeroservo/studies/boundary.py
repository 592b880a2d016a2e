"""Flutter boundaries over one or two numbers of a model file, streamed to disk so that an interruption loses nothing.

Points are computed one after the other, each by the same `flutter` that a single speed comes from. While a sweep runs,
its points go to a journal beside the result (`FILE.part`, one JSON line each, flushed); a later call with the same
model and options goes on where the journal ends.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aeroservo.studies.journal import Journal

if TYPE_CHECKING:
    from aeroservo.aeroelastic.flutter import Method
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.datatypes import FlightCondition

#: Most points of one sweep.
MOST = 100_000
#: The one field that is not a number of the model file.
ALTITUDE = "altitude_m"


@dataclass(frozen=True, kw_only=True)
class Over:
    """A number of the model file and the values that it takes.

    Attributes
    ----------
    field : str
        Dotted path, as `aircraft.overrides` takes it; or "altitude_m", of the standard atmosphere.
    values : tuple of float
        Ascending. [unit of the field, in its name]
    """

    field: str
    values: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Point:
    """The boundary at one point.

    Attributes
    ----------
    values : tuple of float
        Of the fields, in their order. [unit of each field]
    found : bool
        Whether any instability lies in the range of speeds.
    flutter_speed, flutter_frequency : float or None
        Lowest flutter. [m/s, rad/s]
    flutter_mode : str or None
        The mode that crosses.
    divergence_speed : float or None
        Static divergence. [m/s]
    """

    values: tuple[float, ...]
    found: bool
    flutter_speed: float | None
    flutter_frequency: float | None
    flutter_mode: str | None
    divergence_speed: float | None


def flutter_boundary(
    model: FileModel,
    over: tuple[Over, ...],
    sweep: FlightCondition,
    method: Method,
    *,
    aero: str | None = None,
    journal: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
    names: bool = True,
) -> tuple[Point, ...]:
    """Flutter and divergence at every combination of the values of one or two fields.

    Parameters
    ----------
    model : FileModel
        From `aeroservo.read`.
    over : tuple of Over, length 1 or 2
        What varies; the last field varies fastest.
    sweep : FlightCondition
        Speeds at one density, shape (n_V,). [m/s, kg/m^3]
    method : P, PK, K or G
        How roots are found.
    aero : str, optional
        Air forces; by kind of model if left out.
    journal : Path, optional
        Where points are kept until the sweep is complete; points already there are not computed again.
    progress : callable, optional
        Called with the number of points done and of all points, after each.
    names : bool
        Name the mode that crosses, for which modes must be followed; without names the same speeds in a third of the
        time.

    Returns
    -------
    points : tuple of Point
        One for each combination. [m/s, rad/s]

    Raises
    ------
    ValueError
        If a field does not exist, a value is not allowed in some combination, there are too many points, or the
        journal belongs to another sweep.
    """
    from aeroservo.aeroelastic.build import build
    from aeroservo.aeroelastic.flutter import flutter
    from aeroservo.aeroelastic.onset import onset

    count = math.prod(len(one.values) for one in over)
    if len(over) not in (1, 2) or len({one.field for one in over}) != len(over):
        raise ValueError(f"a boundary is over one field or two different ones, got {[one.field for one in over]}")
    if count > MOST:
        raise ValueError(f"a sweep may have at most {MOST:,} points, got {count:,}: take larger steps")
    fields = [one.field for one in over]
    grid = list(product(*(one.values for one in over)))
    for values in _extremes(over):  # refuse before the first hour of work, not after it
        varied(model, fields, values, sweep)
    header = _header(model, over, sweep, method, aero) | ({} if names else {"names": False})
    built: tuple[FileModel, Any] | None = None
    with Journal(journal, header) as kept:
        points = [_kept(row, journal) for row in kept.rows[:count]]
        for values in grid[len(points) :]:
            file, here = varied(model, fields, values, sweep)
            if built is None or built[0] != file:  # over altitude alone the model stays
                built = file, build(file, aero)
            found = flutter(built[1], here, method) if names else onset(built[1], here, method)
            point = Point(
                values=values,
                found=found.found,
                flutter_speed=found.flutter_speed,
                flutter_frequency=found.flutter_frequency,
                flutter_mode=getattr(found, "flutter_mode", None),
                divergence_speed=found.divergence_speed,
            )
            kept.add(asdict(point))
            points.append(point)
            if progress is not None:
                progress(len(points), count)
    return tuple(points)


def boundary_problems(model: FileModel, over: tuple[Over, ...]) -> tuple[str, ...]:
    """Findings that the varied models have at the corners of the grid and the model itself has not.

    Parameters
    ----------
    model : FileModel
        From `aeroservo.read`.
    over : tuple of Over
        What varies.

    Returns
    -------
    problems : tuple of str
        Each with the values at which it was found.

    Raises
    ------
    ValueError
        If a field does not exist or a value is not allowed.
    """
    found = []
    for values in _extremes(over):
        changes = {one.field: value for one, value in zip(over, values)}
        where = ", ".join(f"{field} = {value:g}" for field, value in changes.items())
        file = varied(model, list(changes), values, None)[0]
        found += [f"at {where}: {p}" for p in file.problems() if p not in model.problems()]
    return tuple(found)


def varied(
    model: FileModel, fields: list[str], values: tuple[float, ...], sweep: FlightCondition | None
) -> tuple[FileModel, Any]:
    """The model and the sweep with some numbers changed; `altitude_m` is a number of the sweep.

    Parameters
    ----------
    model : FileModel
        From `aeroservo.read`.
    fields : list of str
        What varies.
    values : tuple of float
        Their values. [unit of each field]
    sweep : FlightCondition, optional
        Speeds; with `altitude_m` among the fields, in the air of that altitude. [m/s, kg/m^3]

    Returns
    -------
    model : FileModel
        Checked again.
    sweep : FlightCondition or None
        At the altitude. [m/s, kg/m^3]

    Raises
    ------
    ValueError
        If a field does not exist, or a value is not allowed.
    """
    from aeroservo.aircraft.overrides import override
    from aeroservo.datatypes import FlightCondition

    changes = dict(zip(fields, values))
    altitude = changes.pop(ALTITUDE, None)
    if altitude is not None:
        at = FlightCondition.at(altitude, V=1.0 if sweep is None else sweep.V)
        sweep = None if sweep is None else at
    return (override(model, changes) if changes else model), sweep


def model_identity(model: FileModel) -> dict[str, Any]:
    """What tells one model file from another, for journals.

    Parameters
    ----------
    model : FileModel
        From `aeroservo.read`.

    Returns
    -------
    identity : dict
        Its numbers, and sums of the arrays that it brings along. [SI]
    """
    arrays = (model.__pydantic_private__ or {}).get("_arrays")
    return {
        "model": json.loads(model.model_dump_json()),
        "data": None if arrays is None else [float(abs(getattr(arrays, x)).sum()) for x in ("M", "K", "Q", "k")],
    }


def _extremes(over: tuple[Over, ...]) -> Iterator[tuple[float, ...]]:
    """Corners of the grid, where ranges and rules across fields fail first."""
    return product(*(sorted({one.values[0], one.values[-1]}) for one in over))


def _header(
    model: FileModel, over: tuple[Over, ...], sweep: FlightCondition, method: Method, aero: str | None
) -> dict[str, Any]:
    """What tells one sweep from another."""
    return {
        **model_identity(model),
        "over": [[one.field, list(one.values)] for one in over],
        "speeds_m_s": [float(v) for v in sweep.V],
        "density_kg_m3": float(sweep.rho[0]),
        "speed_of_sound_m_s": float(sweep.a_sound[0]),
        "method": [type(method).__name__, asdict(method)],
        "aero": aero,
    }


def _kept(row: dict[str, Any], journal: Path | None) -> Point:
    """A point from its line in the journal."""
    try:
        return Point(**(row | {"values": tuple(row["values"])}))
    except (TypeError, KeyError):
        raise ValueError(f"{journal}: is damaged; delete it or name another file to write to") from None
