"""Parts on disk as plain JSON: what is read back is data and nothing that could run."""

from __future__ import annotations

import base64
import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from aeroservo.report import blocks
from aeroservo.report.blocks import Part

#: The only types that are made from a file.
TYPES = {
    t.__name__: t
    for t in (
        blocks.Band, blocks.Chart, blocks.Facts, blocks.Failed, blocks.LivePanel, blocks.Mark, blocks.Part,
        blocks.Picture, blocks.Prose, blocks.Scene, blocks.Series, blocks.Table,
    )
}  # fmt: skip


def write_part(path: Path, part: Part) -> None:
    """Keep a part; where that is not possible nothing happens.

    Parameters
    ----------
    path : Path
        Where to.
    part : Part
        What.
    """
    from aeroservo.aircraft.files import write_whole

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, json.dumps(encoded(part), allow_nan=False).encode())
    except OSError:
        return


def read_part(path: Path) -> Part | None:
    """A part that was kept, or None where there is none or it cannot be read.

    Parameters
    ----------
    path : Path
        Where from.

    Returns
    -------
    part : Part or None
        As it was written.
    """
    try:
        found = decoded(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return None
    return found if isinstance(found, Part) else None


def encoded(value: Any) -> Any:
    """Blocks, arrays, bytes and tuples as JSON knows them.

    Parameters
    ----------
    value : any
        Of blocks. [any]

    Returns
    -------
    value : any
        Of dict, list, str, numbers. [unit of `value`]

    Raises
    ------
    TypeError
        If it is something else.
    """
    if isinstance(value, np.ndarray):
        kind = "<i8" if value.dtype.kind in "iub" else "<f8"
        text = base64.b64encode(np.ascontiguousarray(value, dtype=kind).tobytes()).decode()
        return {"!": "array", "shape": list(value.shape), "kind": kind, "data": text}
    if isinstance(value, np.generic):
        return encoded(value.item())
    if value is None or isinstance(value, str | bool | int):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else {"!": "float", "text": repr(value)}
    if isinstance(value, bytes):
        return {"!": "bytes", "data": base64.b64encode(value).decode()}
    if dataclasses.is_dataclass(value) and type(value).__name__ in TYPES:
        fields = {f.name: encoded(getattr(value, f.name)) for f in dataclasses.fields(value)}
        return {"!": type(value).__name__, "fields": fields}
    if isinstance(value, dict):
        return {"!": "dict", "items": [[encoded(k), encoded(v)] for k, v in value.items()]}
    if isinstance(value, tuple):
        return {"!": "tuple", "items": [encoded(v) for v in value]}
    if isinstance(value, list):
        return [encoded(v) for v in value]
    raise TypeError(f"{type(value).__name__} has no place in a part")


def decoded(value: Any) -> Any:
    """What `encoded` was given.

    Parameters
    ----------
    value : any
        Of JSON. [any]

    Returns
    -------
    value : any
        Of blocks. [unit of `value`]

    Raises
    ------
    ValueError
        If it names a type that is no block.
    """
    if isinstance(value, list):
        return [decoded(v) for v in value]
    if not isinstance(value, dict):
        return value
    kind = value["!"]
    if kind == "array":
        if value["kind"] not in ("<f8", "<i8"):
            raise ValueError("an array of another kind")
        return np.frombuffer(base64.b64decode(value["data"]), dtype=value["kind"]).reshape(value["shape"])
    if kind == "float":
        return float(value["text"])
    if kind == "bytes":
        return base64.b64decode(value["data"])
    if kind == "dict":
        return {decoded(k): decoded(v) for k, v in value["items"]}
    if kind == "tuple":
        return tuple(decoded(v) for v in value["items"])
    if kind not in TYPES:
        raise ValueError(f"{kind!r} is no block")
    return TYPES[kind](**{k: decoded(v) for k, v in value["fields"].items()})
