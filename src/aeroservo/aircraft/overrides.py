"""Change single numbers of a model file by their dotted path: what `--over` and sensitivities vary.

A path names the keys as the file does, with the stations of a wing counted from 0: `wing.pitch_stiffness_N_m`,
`wing.station[1].EI_N_m2` or `wing.station.1.EI_N_m2`.
"""

from __future__ import annotations

import re
import typing
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from aeroservo.aircraft.file_errors import ModelFileError, dotted, nearest
from aeroservo.aircraft.files import validate
from aeroservo.aircraft.schema_base import FileModel

_INDEX = re.compile(r"\[(\d{1,6})\]")
_MOST = 60  # names in one message
_NOT_PHYSICAL = ("schema_version", "speeds_m_s")


def numbers(model: FileModel) -> dict[str, float | None]:
    """Every single number that a model file has or may have, by dotted path.

    Parameters
    ----------
    model : FileModel
        A checked model.

    Returns
    -------
    numbers : dict of str to float or None
        Value in force; None for an optional number that the file leaves out. [unit in the name]

    References
    ----------
    Project convention: contract.md, `--over FIELD=MIN:MAX:STEP`.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> numbers(read("goland"))["wing.station[1].EI_N_m2"]
    9773000.0
    """
    return {dotted(path): value for path, value in _walk(model, ()) if path[0] not in _NOT_PHYSICAL}


def override(model: FileModel, changes: Mapping[str, float]) -> FileModel:
    """The same model with some numbers changed, checked again.

    Parameters
    ----------
    model : FileModel
        A checked model.
    changes : mapping of str to float
        New values by dotted path. [unit in the name]

    Returns
    -------
    model : FileModel
        A new model; the old one is as it was.

    Raises
    ------
    ModelFileError
        If a path names no number of the model, or a value is not allowed there.

    References
    ----------
    Project convention: contract.md, `--over FIELD=MIN:MAX:STEP`.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> override(read("goland"), {"wing.station.1.EI_N_m2": 1e7}).wing.station[1].EI_N_m2
    10000000.0
    """
    known = numbers(model)
    data = model.model_dump(exclude_unset=True)
    for given, value in changes.items():
        path = _INDEX.sub(r".\1", given)
        keys = [int(key) if key.isdecimal() and key.isascii() else key for key in path.split(".")]
        name = dotted(keys)
        if name not in known:
            raise ModelFileError(
                f"{model.name}: {dotted([given])} is not a number of this model{nearest(name, known)}; "
                f"it may be one of {', '.join(list(known)[:_MOST])}{', ...' if len(known) > _MOST else ''}"
            )
        _put(data, keys, float(value))
    changed = validate(data, model.name)
    for private, content in (model.__pydantic_private__ or {}).items():
        setattr(changed, private, content)
    return changed


def _walk(table: BaseModel, path: tuple[int | str, ...]) -> Iterator[tuple[tuple[int | str, ...], float | None]]:
    """Every number below a table with its path; optional ones that are left out too."""
    for name, field in type(table).model_fields.items():
        value = getattr(table, name)
        here = (*path, name)
        if value is None:
            if float in typing.get_args(field.annotation):
                yield here, None
        else:
            yield from _walk_value(value, here)


def _walk_value(value: Any, path: tuple[int | str, ...]) -> Iterator[tuple[tuple[int | str, ...], float]]:
    if isinstance(value, BaseModel):
        yield from _walk(value, path)  # type: ignore[misc]
    elif isinstance(value, tuple):
        for i, item in enumerate(value):
            yield from _walk_value(item, (*path, i))
    elif isinstance(value, float):
        yield path, value


def _put(data: Any, keys: list[int | str], value: float) -> None:
    """Set a value deep inside dumped tables, whose tuples become lists on the way."""
    for key in keys[:-1]:
        inner = data.setdefault(key, {}) if isinstance(data, dict) else data[key]
        if isinstance(inner, tuple):
            inner = list(inner)
            data[key] = inner
        data = inner
    data[keys[-1]] = value
