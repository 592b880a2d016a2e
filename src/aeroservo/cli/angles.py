"""Ranges and lists of angles and Reynolds numbers as typed, and CSV files of results."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable
from typing import Any

from aeroservo.cli.options import grid, numbers_of

#: Most values in one list.
MOST = 2000


def values_of(text: str, what: str, unit: str, low: float, high: float) -> list[float]:
    """The numbers of MIN:MAX:STEP, or of a list with commas.

    Parameters
    ----------
    text : str
        As typed.
    what : str
        The option, for errors.
    unit : str
        Unit of the numbers, for errors.
    low, high : float
        What is allowed. [`unit`]

    Returns
    -------
    values : list of float
        Ascending, without repeats. [`unit`]

    Raises
    ------
    ValueError
        If the text is neither, or a number lies outside.
    """
    if ":" in text:
        values = grid(*numbers_of(text, what, unit))
    else:
        try:
            values = sorted({float(part) for part in text.split(",")})
        except ValueError:
            raise ValueError(
                f"{what} = {text[:80]!r} must be numbers with commas between, or MIN:MAX:STEP [{unit}]"
            ) from None
    if len(values) > MOST:
        raise ValueError(f"{what} = {text[:80]!r} has more than {MOST:,} values: take a larger step")
    outside = [v for v in values if not (math.isfinite(v) and low <= v <= high)]
    if outside:
        raise ValueError(f"{what} = {text[:80]!r} must lie from {low:g} to {high:g} [{unit}], got {outside[0]:g}")
    return [0.0 if abs(v) < 1e-12 else v for v in values]


def csv_bytes(header: Iterable[str], rows: Iterable[Iterable[Any]], comments: Iterable[str] = ()) -> bytes:
    """A CSV file's content; what is not known is an empty field.

    Parameters
    ----------
    header : iterable of str
        Names of the columns, with units.
    rows : iterable of rows
        Strings and numbers.
    comments : iterable of str
        Lines above the header, each behind "# ".

    Returns
    -------
    content : bytes
        UTF-8; numbers with all their digits.
    """
    out = io.StringIO()
    out.writelines(f"# {line}\n" for line in comments)
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(list(header))
    writer.writerows([_field(value) for value in row] for row in rows)
    return out.getvalue().encode()


def _field(value: Any) -> str:
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    return repr(float(value)) if isinstance(value, float) else str(value)
