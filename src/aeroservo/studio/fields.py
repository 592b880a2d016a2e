"""The form of a model file, read off its schema: which fields, of what kind, in which unit and range."""

from __future__ import annotations

import re
import types
import typing
from dataclasses import dataclass
from typing import Any, Literal

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from aeroservo.aircraft.file_errors import allowed

Kind = Literal["number", "whole", "text", "choice", "flag", "numbers", "strings", "matrix"]

_UNIT = re.compile(r"^(.*?)\s*\[([^\[\]]*)\]$", re.DOTALL)


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One value of a table.

    Attributes
    ----------
    name : str
        Key in the file.
    kind : str
        How it is written: "number", "whole", "text", "choice", "flag", or a list of "numbers", "strings", "matrix".
    text, unit : str
        What it means, and its unit ("" where it has none).
    allowed : str
        The range in words, "" where any value goes.
    required : bool
        Whether the file must have it.
    default : str, float, bool or None
        Value in force where the file leaves it out.
    choices : tuple of str
        Words of a choice.
    """

    name: str
    kind: Kind
    text: str
    unit: str
    allowed: str
    required: bool
    default: Any
    choices: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Group:
    """A table inside a table, or a list of such tables.

    Attributes
    ----------
    name, text : str
        Key in the file, and what it means.
    required : bool
        Whether the file must have it.
    rows : bool
        Whether it is a list of tables.
    table : Form
        What is in it, or in each of its rows.
    """

    name: str
    text: str
    required: bool
    rows: bool
    table: Form


@dataclass(frozen=True, kw_only=True)
class Form:
    """The fields of a table, in the order of the schema.

    Attributes
    ----------
    entries : tuple of Entry
        Its values.
    groups : tuple of Group
        Its tables.
    """

    entries: tuple[Entry, ...]
    groups: tuple[Group, ...]

    @property
    def flat(self) -> bool:
        """Whether rows of it fit in a grid."""
        return not self.groups and not any(e.kind in ("numbers", "strings", "matrix") for e in self.entries)


def form_of(table: type[BaseModel]) -> Form:
    """The form of a kind of model, or of one of its tables.

    Parameters
    ----------
    table : type
        A class of `aircraft.schema`.

    Returns
    -------
    form : Form
        What can be edited.

    Raises
    ------
    TypeError
        If a field is of a type that no form knows: a fault of the program.

    References
    ----------
    Project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> from aeroservo.aircraft.schema import kinds
    >>> wing = form_of(kinds()["binary_wing"]).groups[0]
    >>> stiffness = {entry.name: entry for entry in wing.table.entries}["pitch_stiffness_N_m"]
    >>> stiffness.text, stiffness.unit, stiffness.allowed
    ('torsion spring K_theta', 'N m/rad', 'greater than 0')
    """
    entries: list[Entry] = []
    groups: list[Group] = []
    for name, field in table.model_fields.items():
        kind, inside = _kind_of(field.annotation)
        if name == "schema_version" or (kind == "choice" and len(_choices(field.annotation)) == 1):
            continue  # what a file is does not change
        if inside is not None:
            groups.append(
                Group(
                    name=name,
                    text=_words(field)[0],
                    required=field.is_required(),
                    rows=kind == "rows",
                    table=form_of(inside),
                )
            )
        else:
            entries.append(_entry(name, kind, field))
    return Form(entries=tuple(entries), groups=tuple(groups))


def _entry(name: str, kind: str, field: FieldInfo) -> Entry:
    text, unit = _words(field)
    default = None if field.is_required() else field.default
    if isinstance(default, tuple) and not default:
        default = None
    return Entry(
        name=name,
        kind=typing.cast(Kind, kind),
        text=text,
        unit=unit,
        allowed=_range(field) if kind in ("number", "whole") else "",
        required=field.is_required(),
        default=default,
        choices=_choices(field.annotation) if kind == "choice" else (),
    )


def _words(field: FieldInfo) -> tuple[str, str]:
    """Meaning and unit of "meaning [unit]"."""
    found = _UNIT.match(field.description or "")
    if found is None:
        return field.description or "", ""
    return found[1], "" if found[2] == "-" else found[2]


def _range(field: FieldInfo) -> str:
    """The range in words, without the limits that only keep out what is no number of physics."""
    parts = allowed(field).replace(" (at least 1e-15)", "").split(" and ")
    return " and ".join(part for part in parts if not re.search(r" -?1e\+1[0-9]$", part))


def _bare(annotation: Any) -> Any:
    """An annotation without `Annotated` and `| None`."""
    while True:
        origin, inner = typing.get_origin(annotation), typing.get_args(annotation)
        if origin is typing.Annotated:
            annotation = inner[0]
        elif origin in (typing.Union, types.UnionType) and type(None) in inner and len(inner) == 2:
            annotation = next(a for a in inner if a is not type(None))
        else:
            return annotation


def _kind_of(annotation: Any) -> tuple[str, type[BaseModel] | None]:
    """How a field is written, and the class of the tables in it."""
    bare = _bare(annotation)
    if isinstance(bare, type) and issubclass(bare, BaseModel):
        return "table", bare
    simple = {float: "number", int: "whole", str: "text", bool: "flag"}
    if bare in simple:
        return simple[bare], None
    if typing.get_origin(bare) is Literal:
        return "choice", None
    if typing.get_origin(bare) is tuple:
        inside = _bare(typing.get_args(bare)[0])
        if isinstance(inside, type) and issubclass(inside, BaseModel):
            return "rows", inside
        if inside in (float, str):
            return ("numbers" if inside is float else "strings"), None
        if typing.get_origin(inside) is tuple and _bare(typing.get_args(inside)[0]) is float:
            return "matrix", None
    raise TypeError(f"no form knows a field of type {annotation}")


def _choices(annotation: Any) -> tuple[str, ...]:
    return tuple(str(word) for word in typing.get_args(_bare(annotation)))
