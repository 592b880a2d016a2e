"""What the commands print and write: JSON without NaN, messages on stderr, files that appear whole."""

from __future__ import annotations

import json
import math
import sys
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NoReturn

import typer


def complain(message: str) -> None:
    """Print a message on stderr.

    Parameters
    ----------
    message : str
        Without a full stop.
    """
    print(f"aeroservo: {message}", file=sys.stderr)


def not_yet(what: str) -> NoReturn:
    """Say that something of the contract is not in this version, and stop with code 2.

    Parameters
    ----------
    what : str
        What was asked for.

    Raises
    ------
    Exit
        With code 2.
    """
    complain(f"{what} does not exist yet in this version")
    raise typer.Exit(2)


def quiet_warnings() -> None:
    """Let Python's warnings print as one line on stderr."""

    def show(message: Warning | str, *_: Any, **__: Any) -> None:
        complain(f"warning: {message}")

    warnings.showwarning = show


def plain(value: Any) -> Any:
    """A value as JSON knows it: arrays as lists, complex numbers as [re, im], NaN and infinity as null.

    Parameters
    ----------
    value : any
        Numbers, arrays, strings, dicts, sequences, None.

    Returns
    -------
    value : any
        Made of dict, list, str, int, float, bool and None only. [unit of `value`]

    Raises
    ------
    TypeError
        If it is something else.
    """
    if value is None or isinstance(value, bool | str | int):
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, complex):
        return [plain(value.real), plain(value.imag)]
    if isinstance(value, dict):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    if isinstance(value, Path):
        return str(value)
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    raise TypeError(f"{type(value).__name__} has no place in JSON")


def heading(
    model: str | None = None,
    altitude: float | None = None,
    density: float | None = None,
    warnings: Iterable[str] = (),
) -> dict[str, Any]:
    """The keys that every JSON has.

    Parameters
    ----------
    model : str, optional
        Name of the model.
    altitude : float, optional
        Geopotential altitude. [m]
    density : float, optional
        Air density. [kg/m^3]
    warnings : iterable of str
        What to know before trusting the numbers.

    Returns
    -------
    content : dict
        To which the command adds its own.
    """
    return {
        "schema_version": 1,
        "model": model,
        "altitude_m": altitude,
        "density_kg_m3": density,
        "warnings": list(warnings),
    }


def print_json(content: dict[str, Any]) -> None:
    """Print one JSON object on stdout.

    Parameters
    ----------
    content : dict
        As `plain` takes it. [SI]
    """
    typer.echo(json.dumps(plain(content), allow_nan=False, ensure_ascii=False))


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write one JSON object to a file, whole or not at all.

    Parameters
    ----------
    path : Path
        Where to.
    content : dict
        As `plain` takes it. [SI]
    """
    write(path, (json.dumps(plain(content), allow_nan=False, ensure_ascii=False, indent=1) + "\n").encode())


def write(path: Path, content: bytes) -> None:
    """Write a file under a temporary name and move it into place.

    Parameters
    ----------
    path : Path
        Where to; an existing file is replaced.
    content : bytes
        What.

    Raises
    ------
    ValueError
        If it cannot be written.
    """
    from aeroservo.aircraft.files import write_whole

    try:
        write_whole(path, content)
    except OSError as error:
        raise ValueError(f"{path}: cannot be written: {error.strerror}") from None
    complain(f"wrote {path}")


def table(rows: Iterable[Iterable[Any]], header: Iterable[str]) -> str:
    """A table in plain text, numbers to the right.

    Parameters
    ----------
    rows : iterable of rows
        Strings, numbers or None.
    header : iterable of str
        Names of the columns.

    Returns
    -------
    text : str
        Lines without a last line feed.
    """
    cells = [[str(name) for name in header], *([_cell(value) for value in row] for row in rows)]
    widths = [max(len(row[j]) for row in cells) for j in range(len(cells[0]))]
    right = [all(_is_number(row[j]) for row in cells[1:]) for j in range(len(widths))]
    lines = [
        "  ".join(cell.rjust(w) if r else cell.ljust(w) for cell, w, r in zip(row, widths, right)).rstrip()
        for row in cells
    ]
    return "\n".join([lines[0], "  ".join("-" * w for w in widths), *lines[1:]])


def number(value: float | None, unit: str = "", digits: int = 7) -> str:
    """A number with its unit, or "none".

    Parameters
    ----------
    value : float, optional
        What. [`unit`]
    unit : str
        Its unit.
    digits : int
        Significant digits.

    Returns
    -------
    text : str
        For people.
    """
    if value is None or not math.isfinite(value):
        return "none"
    return f"{value:.{digits}g}{' ' + unit if unit else ''}"


def _cell(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, float):
        return f"{value:.6g}" if math.isfinite(value) else "-"
    return str(value)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return text == "-"
    return True
