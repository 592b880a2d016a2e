"""A hash of everything that a result depends on, the same on every machine and in every folder."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.aircraft.schema_base import FileModel
from aeroservo.aircraft.schema_other import ModalFile
from aeroservo.datatypes import Array

#: Keys of model files that hold paths.
PATHS = ("airfoil", "data")


def input_hash(file: FileModel, asked: Mapping[str, Any]) -> str:
    """SHA-256 of a model and of what was asked for.

    Parameters
    ----------
    file : FileModel
        The model; files beside it count by their content, not by where they are.
    asked : mapping
        Options, as JSON knows them. [SI]

    Returns
    -------
    digest : str
        Hexadecimal.
    """
    content: dict[str, Any] = {"model": without_folders(file.model_dump(mode="json")), "asked": dict(asked)}
    if isinstance(file, ModalFile):
        x = file.arrays
        content["arrays"] = {k: array_digest(getattr(x, k)) for k in ("M", "D", "K", "Q", "k", "mach", "phi", "grid")}
        content["names"] = [list(map(str, x.mode_names)), list(map(str, x.input_names)), float(x.b_m)]
        content["M_control"] = array_digest(x.M_control)
    if isinstance(file, AircraftFile):
        names = {s.airfoil for surface in file.surfaces() for s in surface.sections}
        beside = [Path(x) for x in sorted(names) if Path(x).is_file()]
        content["airfoils"] = {x.name: hashlib.sha256(x.read_bytes()).hexdigest() for x in beside}
    return hashlib.sha256(json.dumps(content, sort_keys=True, ensure_ascii=True).encode()).hexdigest()


def array_digest(array: Array | None) -> str:
    """Hash of an array, whatever the machine's byte order.

    Parameters
    ----------
    array : ndarray, shape (...), optional
        Numbers. [any]

    Returns
    -------
    digest : str
        Hexadecimal; that of an empty array where there is none.
    """
    array = np.zeros(0) if array is None else np.asarray(array)
    kind = "<c16" if np.iscomplexobj(array) else "<f8"
    return hashlib.sha256(str(array.shape).encode() + array.astype(kind).tobytes()).hexdigest()


def without_folders(value: Any) -> Any:
    """The same with paths of files beside a model reduced to their names.

    Parameters
    ----------
    value : any
        Of JSON. [any]

    Returns
    -------
    value : any
        Of JSON. [unit of `value`]
    """
    if isinstance(value, dict):
        return {k: Path(v).name if k in PATHS and isinstance(v, str) else without_folders(v) for k, v in value.items()}
    return [without_folders(v) for v in value] if isinstance(value, list) else value
