"""What a controller file may hold: the JSON of the contract, checked field by field."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from aeroservo.datatypes import Array

_LAW = ("A", "B", "C", "D", "windup")
_HEAD = ("schema_version", "inputs", "outputs", "dt_s", "delay_s", "limits", "interpolation")
_POINT = ("dynamic_pressure_Pa", "altitude_m", *_LAW)


def fields_of(data: Any) -> dict[str, Any]:
    """Fields of a controller from what JSON gives.

    Parameters
    ----------
    data : any
        As `json.loads` gives it.

    Returns
    -------
    fields : dict
        Arguments of `Controller`. [SI]

    Raises
    ------
    ValueError
        Naming the field and what is allowed.

    References
    ----------
    contract.md, "Controller file (JSON)".

    Examples
    --------
    >>> fields_of({"inputs": ["y"], "outputs": ["u"], "D": [[-2.0]]})["D"].tolist()
    [[[-2.0]]]
    """
    if not isinstance(data, dict):
        raise ValueError("must be one JSON object")
    version = data.get("schema_version", 1)
    if version != 1:
        raise ValueError(f"schema_version = {version!r} is not 1, the version that this program reads")
    names = {}
    for key in ("inputs", "outputs"):
        value = data.get(key)
        if not isinstance(value, list) or not value or not all(isinstance(name, str) for name in value):
            raise ValueError(f"{key} must be a list of one or more channel names, got {value!r:.80}")
        if len(set(value)) != len(value):
            raise ValueError(f"{key} must differ, got {value!r:.200}")
        names[key] = tuple(value)
    points = data.get("points")
    if points is None:
        points, pressures = [data], None
    else:
        if not isinstance(points, list) or not points or not all(isinstance(p, Mapping) for p in points):
            raise ValueError("points must be a list of objects with dynamic_pressure_Pa, A, B, C, D")
        pressures = np.array([_number(p, "dynamic_pressure_Pa", None) for p in points])
        if data.get("interpolation", "linear") != "linear":
            raise ValueError(f"interpolation must be 'linear', got {data['interpolation']!r:.40}")
    _only(data, (*_HEAD, "points") if pressures is not None else (*_HEAD, *_POINT))
    for point in points if pressures is not None else ():
        _only(point, _POINT, " in a point")
    n_in, n_out = len(names["inputs"]), len(names["outputs"])
    told = [*"ABCD", *(["windup"] if any("windup" in p for p in points) else [])]
    stacks = {key: [_matrix(p, key) for p in points] for key in told}
    n_c = len(stacks["A"][0])
    shapes = {"A": (n_c, n_c), "B": (n_c, n_in), "C": (n_out, n_c), "D": (n_out, n_in), "windup": (n_c, n_out)}
    matrices = {}
    for key, stack in stacks.items():
        for value in stack:
            if value.size != shapes[key][0] * shapes[key][1] or (value.size and value.shape != shapes[key]):
                raise ValueError(f"{key} must be {shapes[key][0]} x {shapes[key][1]}, got shape {value.shape}")
        matrices[key] = np.stack([value.reshape(shapes[key]) for value in stack])
    dt = data.get("dt_s")
    return {
        **matrices,
        "inputs": names["inputs"],
        "outputs": names["outputs"],
        "dt_s": None if dt is None else _number(data, "dt_s", None),
        "delay_s": _number(data, "delay_s", 0.0),
        "limits": _limits(data.get("limits"), names["outputs"]),
        "pressures": pressures,
    }


def no_constant(word: str) -> float:
    """Refuse NaN and Infinity, which are no numbers of JSON.

    Parameters
    ----------
    word : str
        What stands there.

    Returns
    -------
    never : float
        Nothing. [-]

    Raises
    ------
    ValueError
        Always.

    References
    ----------
    RFC 8259 (2017), section 6.

    Examples
    --------
    >>> no_constant("NaN")
    Traceback (most recent call last):
    ...
    ValueError: NaN is not a number of JSON
    """
    raise ValueError(f"{word} is not a number of JSON")


def _only(data: Mapping[str, Any], known: tuple[str, ...], where: str = "") -> None:
    """Refuse a field that nothing reads: a misspelt delay_s would fly without its delay."""
    other = [key for key in data if key not in known]
    if other:
        raise ValueError(f"{other[0]!r:.80} is no field{where} of a controller file; fields: {', '.join(known)}")


def _matrix(data: Mapping[str, Any], key: str) -> Array:
    """A matrix of numbers; [] and [[]] are empty."""
    value = data.get(key, [])
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{key} must be rows of numbers, all of one length") from None
    if array.size and array.ndim != 2:
        raise ValueError(f"{key} must be rows of numbers, got {array.ndim} axes")
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{key} holds a value that is not finite")
    return array if array.ndim == 2 else np.zeros((0, 0))


def _number(data: Mapping[str, Any], key: str, default: float | None) -> float:
    """A finite number of a field."""
    value = data.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{key} must be a number, got {value!r:.40}")
    return float(value)


def _limits(data: Any, outputs: tuple[str, ...]) -> tuple[float, ...]:
    """Largest magnitude of each output by its name."""
    if data is None:
        return ()
    if not isinstance(data, dict) or set(data) - set(outputs):
        raise ValueError(
            f"limits must name outputs out of {list(outputs)} and their largest magnitude, got {data!r:.80}"
        )
    return tuple(_number(data, name, 0.0) for name in outputs)
