"""Damping surfaces: damping ratio and frequency of every mode over speed and one number of a model file, or altitude.

Each row is one `flutter`, so its curves are followed and named as a single run's are; rows stand alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from aeroservo.datatypes import Array
from aeroservo.studies.boundary import Over, varied

if TYPE_CHECKING:
    from aeroservo.aeroelastic.flutter import FlutterResult, Method
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.datatypes import FlightCondition


@dataclass(frozen=True, kw_only=True, eq=False)
class DampingSurface:
    """Damping and frequency of every mode over a number of the file and speed.

    Attributes
    ----------
    over : Over
        What varies besides speed.
    V : ndarray, shape (n_V,)
        True airspeeds. [m/s]
    names : tuple of str
        Modes.
    damping_ratio : ndarray, shape (n_values, n_V, n_modes)
        Positive stable; nan where a mode does not exist. [-]
    frequency : ndarray, shape (n_values, n_V, n_modes)
        |Im s|. [rad/s]
    flutter_speed, divergence_speed : ndarray, shape (n_values,)
        nan where there is none. [m/s]
    """

    over: Over
    V: Array
    names: tuple[str, ...]
    damping_ratio: Array
    frequency: Array
    flutter_speed: Array
    divergence_speed: Array


def damping_surface(
    model: FileModel,
    over: Over,
    sweep: FlightCondition,
    method: Method,
    *,
    aero: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> DampingSurface:
    """Damping and frequency over speed and one number of a model file ("altitude_m": over speed and altitude).

    Parameters
    ----------
    model : FileModel
        From `aeroservo.read`.
    over : Over
        What varies.
    sweep : FlightCondition
        Speeds at one density, shape (n_V,). [m/s, kg/m^3]
    method : P, PK or G
        How roots are found.
    aero : str, optional
        Air forces; by kind of model if left out.
    progress : callable, optional
        Called with the number of rows done and of all rows.

    Returns
    -------
    surface : DampingSurface
        Modes in the order of the first row; a mode that a row does not have is nan there. [-, rad/s]

    Raises
    ------
    ValueError
        If the field does not exist, a value is not allowed, or the method is k, whose curves are not over speed.
    """
    from aeroservo.aeroelastic.build import build
    from aeroservo.aeroelastic.flutter import K, flutter

    if isinstance(method, K):
        raise ValueError("a damping surface needs roots at given speeds: use p, p-k or g instead of the k method")
    for value in (over.values[0], over.values[-1]):
        varied(model, [over.field], (value,), sweep)
    rows: list[FlutterResult] = []
    for value in over.values:
        file, here = varied(model, [over.field], (value,), sweep)
        rows.append(flutter(build(file, aero), here, method))
        if progress is not None:
            progress(len(rows), len(over.values))
    names = tuple(name for name in rows[0].names if not name.startswith("lag "))
    return DampingSurface(
        over=over,
        V=sweep.V,
        names=names,
        damping_ratio=np.stack([_columns(row, row.damping_ratio, names) for row in rows]),
        frequency=np.stack([_columns(row, row.frequency, names) for row in rows]),
        flutter_speed=np.array([np.nan if row.flutter_speed is None else row.flutter_speed for row in rows]),
        divergence_speed=np.array([np.nan if row.divergence_speed is None else row.divergence_speed for row in rows]),
    )


def _columns(row: FlutterResult, values: Array, names: tuple[str, ...]) -> Array:
    """The columns of the named modes, nan for one that is not there; shape (n_V, n_modes)."""
    where = [row.names.index(name) if name in row.names else -1 for name in names]
    return np.stack([values[:, j] if j >= 0 else np.full(len(values), np.nan) for j in where], axis=1)
