"""Function calls written down in a case file: which public function, with which arguments, which part of its answer.

A value in a case file is a number, a text, a list or a table of values. A text that starts with "@" is a number or a
column of the case's `reference.json`; a table with `call` is the answer of a function of the package, called with the
`arguments` of that table; a table with `name` is an object of the package, as it is.
"""

from __future__ import annotations

import importlib
from typing import Any


def evaluated(value: Any, data: dict[str, Any]) -> Any:
    """A value of a case file, with what it refers to and calls put in its place.

    Parameters
    ----------
    value : any
        As TOML gives it.
    data : dict
        The case's `reference.json`; empty where it has none.

    Returns
    -------
    value : any
        Numbers, arrays, or objects of the package. [as the function called]

    Raises
    ------
    ValueError
        If a reference or a function does not exist.

    References
    ----------
    Project convention: CONTRIBUTING.md, cases.

    Examples
    --------
    >>> evaluated({"call": "aero.theodorsen.theodorsen_function", "arguments": {"k": "@k"}}, {"k": 0.0}).real
    array(1.)
    """
    if isinstance(value, str) and value.startswith("@"):
        return looked_up(value[1:], data)
    if isinstance(value, list):
        return [evaluated(item, data) for item in value]
    if not isinstance(value, dict):
        return value
    if set(value) == {"name"}:
        return _named(value["name"])
    if "call" not in value:
        return {key: evaluated(item, data) for key, item in value.items()}
    arguments = evaluated(value.get("arguments", {}), data)
    positional = arguments.pop("*", [])
    answer = _named(value["call"])(*positional, **arguments)
    return part(answer, value["of"]) if "of" in value else answer


def looked_up(path: str, data: dict[str, Any]) -> Any:
    """A number or a column of `reference.json`.

    Parameters
    ----------
    path : str
        Keys joined by dots; after a list of tables, the key of the column.
    data : dict
        What the file holds.

    Returns
    -------
    value : any
        Number, list or table. [as the file]

    Raises
    ------
    ValueError
        If there is no such entry.

    References
    ----------
    Project convention: CONTRIBUTING.md, cases.

    Examples
    --------
    >>> looked_up("table.x", {"table": [{"x": 1.0}, {"x": 2.0}]})
    [1.0, 2.0]
    """
    found: Any = data
    for key in path.split("."):
        if isinstance(found, dict) and key in found:
            found = found[key]
        elif isinstance(found, list) and all(isinstance(row, dict) and key in row for row in found):
            found = [row[key] for row in found]
        elif isinstance(found, list) and key.isdecimal():
            found = [row[int(key)] if isinstance(row, list) else row for row in found]
        else:
            raise ValueError(f"reference.json holds no {path!r}")
    return found


def part(answer: Any, path: str) -> Any:
    """A part of a function's answer.

    Parameters
    ----------
    answer : any
        What the function returned.
    path : str
        Attributes, and places in a tuple, joined by dots; empty for the whole.

    Returns
    -------
    value : any
        That part. [as the function]

    References
    ----------
    Project convention: CONTRIBUTING.md, cases.

    Examples
    --------
    >>> part((1.0, 2.0 + 3.0j), "1.imag")
    3.0
    """
    for step in path.split(".") if path else []:
        answer = answer[int(step)] if step.isdecimal() else getattr(answer, step)
    return answer


def _named(path: str) -> Any:
    """A public object of the package by its module and name."""
    module, _, name = path.rpartition(".")
    if not module or any(part.startswith("_") for part in path.split(".")):
        raise ValueError(f"{path!r} is no public function of the package: give module.function")
    try:
        return getattr(importlib.import_module(f"aeroservo.{module}"), name)
    except (ImportError, AttributeError):
        raise ValueError(f"{path!r} is no public function of the package") from None
