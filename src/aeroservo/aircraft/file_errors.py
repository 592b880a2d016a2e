"""Errors of model files in words: which field, which value, what is allowed."""

from __future__ import annotations

import difflib
import typing
from collections.abc import Iterable
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from aeroservo.aircraft.schema_base import TINY

_MOST = 8  # findings in one message


class ModelFileError(ValueError):
    """A model file that cannot be used; the message is for the user."""


def explained(error: ValidationError, model: type[BaseModel], where: str) -> str:
    """A refused model file in words, one line for each finding.

    Parameters
    ----------
    error : ValidationError
        What pydantic found.
    model : type
        The class that refused.
    where : str
        Name of the file.

    Returns
    -------
    message : str
        "file: field = value must be ..., " and so on.

    References
    ----------
    Project convention: contract.md, "Exit codes".

    Examples
    --------
    >>> from aeroservo.aircraft.schema_base import Hysteretic
    >>> try:
    ...     Hysteretic.model_validate({"g": 2.0})
    ... except ValidationError as error:
    ...     print(explained(error, Hysteretic, "wing.toml"))
    wing.toml: g = 2.0 must be at least 0 and less than 1 (structural damping [-])
    """
    findings = [f for f in error.errors(include_url=False) if not _follows(f, error)]
    lines = [_finding(finding, model) for finding in findings[:_MOST]]
    if len(findings) > _MOST:
        lines.append(f"and {len(findings) - _MOST} more")
    return "\n".join(f"{where}: {line}" for line in lines)


def nearest(word: Any, words: Iterable[str]) -> str:
    """A hint "; did you mean 'X'?" where a known word is close, else nothing.

    Parameters
    ----------
    word : str
        What was given.
    words : iterable of str
        What is known.

    Returns
    -------
    hint : str
        To be appended to a message.

    References
    ----------
    Ratcliff & Metzener, Dr. Dobb's Journal, July 1988 (the measure of `difflib`).

    Examples
    --------
    >>> nearest("golan", ["goland", "bact"])
    "; did you mean 'goland'?"
    """
    if not isinstance(word, str) or len(word) > 200:
        return ""
    exact = {w.lower(): w for w in words}
    longer = [w for w in exact if len(word) > 3 and w.startswith(word.lower())]
    close = longer[:1] or difflib.get_close_matches(word.lower(), exact, n=1, cutoff=0.6)
    return f"; did you mean {exact[close[0]]!r}?" if close else ""


def dotted(path: Iterable[int | str]) -> str:
    """A field's place as the user writes it, stations counted from 0.

    Parameters
    ----------
    path : iterable of str or int
        Keys and indices, outermost first.

    Returns
    -------
    text : str
        For example `wing.station[1].chord_m`.

    References
    ----------
    Project convention: contract.md, `--over FIELD=MIN:MAX:STEP`.

    Examples
    --------
    >>> dotted(["wing", "station", 1, "chord_m"])
    'wing.station[1].chord_m'
    """
    text = ""
    for part in path:
        key = clean(str(part), 60)
        text += f"[{part}]" if isinstance(part, int) else f".{key}" if text else key
    return text


def clean(text: str, length: int) -> str:
    """Text of a file that is safe to print: one line, no control characters, not longer than asked.

    Parameters
    ----------
    text : str
        Anything.
    length : int
        Most characters wanted.

    Returns
    -------
    text : str
        Control characters made visible, the end cut.

    References
    ----------
    Project convention: contract.md, "Exit codes".

    Examples
    --------
    >>> clean("a" * 9, 5)
    'aa...'
    """
    text = "".join(c if c.isprintable() else repr(c)[1:-1] for c in text[: 4 * length])
    return text if len(text) <= length else text[: length - 3] + "..."


def allowed(field: FieldInfo) -> str:
    """The range of a number in words.

    Parameters
    ----------
    field : FieldInfo
        Of a `Table`.

    Returns
    -------
    text : str
        For example "greater than 0 and at most 100".

    References
    ----------
    Project convention: house style, "Errors".

    Examples
    --------
    >>> from aeroservo.aircraft.schema_base import Hysteretic
    >>> allowed(Hysteretic.model_fields["g"])
    'at least 0 and less than 1'
    """
    words = {"gt": "greater than", "ge": "at least", "lt": "less than", "le": "at most"}
    limits = [(words[key], getattr(rule, key)) for rule in field.metadata for key in words if hasattr(rule, key)]
    tiny = f"at least {TINY:g}"
    return " and ".join(f"{word} {value:g}" for word, value in limits).replace(tiny, f"greater than 0 ({tiny})")


def _follows(finding: Any, error: ValidationError) -> bool:
    """Whether a list is found too short only because an entry in it was refused."""
    loc = finding["loc"]
    others = [other["loc"] for other in error.errors(include_url=False, include_context=False)]
    return finding["type"] == "too_short" and any(len(o) > len(loc) and o[: len(loc)] == loc for o in others)


def _finding(finding: Any, model: type[BaseModel]) -> str:
    """One finding of pydantic in our words."""
    kind, loc, value = finding["type"], finding["loc"], finding["input"]
    place, field, table = dotted(loc), *_field_at(model, loc)
    about = f" ({field.description})" if field is not None and field.description else ""
    shown = clean(repr(value) if not isinstance(value, int) or abs(value) < 10**40 else "a huge integer", 60)
    if kind == "extra_forbidden":
        known = list(table.model_fields) if table is not None else []
        inside = dotted(loc[:-1])
        return (
            f"unknown key {place}{nearest(str(loc[-1]), known)}; "
            f"allowed in {f'[{inside}]' if inside else 'the top of the file'}: {', '.join(known)}"
        )
    if kind == "missing":
        return f"{place} is missing{about}"
    if kind == "value_error":
        return f"{place}: {finding['ctx']['error']}" if place else str(finding["ctx"]["error"])
    if kind == "model_type":
        return f"{place} must be a table, [{place}], got {shown}{about}"
    if kind in ("too_short", "too_long"):
        ctx = finding["ctx"]
        need = f"at least {ctx['min_length']}" if kind == "too_short" else f"at most {ctx['max_length']}"
        return f"{place} needs {need} entries, got {ctx['actual_length']}{about}"
    if kind == "literal_error":
        return f"{place} = {shown} must be {finding['ctx']['expected']}{about}"
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal") and field is not None:
        return f"{place} = {shown} must be {allowed(field)}{about}"
    if kind == "finite_number":
        return f"{place} = {shown} must be a finite number{about}"
    if kind in ("float_type", "int_type"):
        word = "a number" if kind == "float_type" else "a whole number"
        return f"{place} = {shown} must be {word}{about}"
    if kind == "string_type":
        return f"{place} = {shown} must be text in quotes{about}"
    if kind == "tuple_type":
        return f"{place} = {shown} must be a list{about}"
    return f"{place} = {shown}: {finding['msg'][:1].lower()}{finding['msg'][1:]}{about}"


def _field_at(model: type[BaseModel], loc: tuple[int | str, ...]) -> tuple[FieldInfo | None, type[BaseModel] | None]:
    """The field at a place, and the table that holds (or would hold) it."""
    table: type[BaseModel] | None = model
    field: FieldInfo | None = None
    for i, part in enumerate(loc):
        if isinstance(part, int):
            continue
        if table is None or part not in table.model_fields:
            return None, table
        field = table.model_fields[part]
        if i < len(loc) - 1:
            table = _table_in(field.annotation)
    return field, table


def _table_in(annotation: Any) -> type[BaseModel] | None:
    """The table class inside an annotation such as `tuple[Station, ...] | None`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for inner in typing.get_args(annotation):
        found = _table_in(inner)
        if found is not None:
            return found
    return None
