"""A model file while it is edited: tables that may be wrong, checked after every change.

A draft is what TOML gives: tables as dicts, keys as in the file. It may hold anything the user typed; `checked` says
what is wrong with it and where. Drafts are never changed in place.
"""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from aeroservo.aircraft import files
from aeroservo.aircraft.file_errors import ModelFileError, dotted, explained
from aeroservo.aircraft.schema import kinds
from aeroservo.aircraft.schema_base import FileModel
from aeroservo.studio.fields import Kind

Place = tuple[int | str, ...]
Draft = dict[str, Any]

#: Largest model file that the studio edits. [byte]
LARGEST = 500_000


@dataclass(frozen=True, kw_only=True)
class Finding:
    """Something that is not allowed.

    Attributes
    ----------
    place : tuple of str or int
        Where in the file; empty for the file as a whole.
    message : str
        What is allowed.
    """

    place: Place
    message: str


@dataclass(frozen=True, kw_only=True, eq=False)
class Source:
    """Where a draft came from.

    Attributes
    ----------
    path : Path
        The file, or the file that a preset's copy would be: named in errors, data files lie beside it.
    text : str
        What was read.
    model : FileModel
        What it says.
    preset : str
        Name of the preset, "" for a file of the user's own.
    """

    path: Path
    text: str
    model: FileModel
    preset: str = ""

    @property
    def draft(self) -> Draft:
        """The tables as they are in the file."""
        return tomllib.loads(self.text)


def put(draft: Draft, place: Place, value: Any) -> Draft:
    """The draft with one value set, or taken out.

    Parameters
    ----------
    draft : dict
        As TOML gives it.
    place : tuple of str or int
        Keys and indices, outermost first; tables on the way are made where they are missing.
    value : any
        What TOML can hold, or None to take the key (or row) out.

    Returns
    -------
    draft : dict
        A new one.

    Raises
    ------
    ValueError
        If there is no such place.

    References
    ----------
    Project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> put({"wing": {"chord_m": 1.0}}, ("wing", "chord_m"), 2.0)
    {'wing': {'chord_m': 2.0}}
    >>> put({"wing": {"chord_m": 1.0}}, ("wing", "chord_m"), None)
    {'wing': {}}
    """
    draft = copy.deepcopy(draft)
    at: Any = draft
    for key, after in pairwise(place):
        if isinstance(at, dict) and key not in at:
            at[key] = [] if isinstance(after, int) else {}
        at = _inside(at, key)
    last = place[-1]
    if value is not None and isinstance(at, list) and isinstance(last, int) and last == len(at):
        at.append(value)
    elif value is not None and isinstance(at, dict):
        at[last] = value
    elif value is not None:
        _inside(at, last)
        at[last] = value
    elif isinstance(at, dict):
        at.pop(last, None)
    else:
        _inside(at, last)
        del at[last]
    return draft


def held(draft: Draft, place: Place) -> Any:
    """The value at a place, None where there is none.

    Parameters
    ----------
    draft : dict
        As TOML gives it.
    place : tuple of str or int
        Keys and indices, outermost first.

    Returns
    -------
    value : any
        Table, list or value.

    References
    ----------
    Project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> held({"wing": {"station": [{"y_m": 0.0}]}}, ("wing", "station", 0, "y_m"))
    0.0
    """
    at: Any = draft
    for key in place:
        try:
            at = _inside(at, key)
        except ValueError:
            return None
    return at


def typed(kind: Kind, text: str) -> Any:
    """What a text in the form means; text that is no such thing stays text, and `checked` refuses it.

    Parameters
    ----------
    kind : str
        As `fields.Entry` has it.
    text : str
        As typed.

    Returns
    -------
    value : any
        Number, word, list, or None where nothing is left.

    References
    ----------
    TOML 1.0, numbers.

    Examples
    --------
    >>> typed("number", " 4.1e2 "), typed("number", "wide"), typed("numbers", "0.02, 0.03"), typed("number", "")
    (410.0, 'wide', [0.02, 0.03], None)
    """
    stripped = text.strip()
    if not stripped:
        return None
    if kind in ("number", "whole"):
        return _number(stripped, whole=kind == "whole")
    if kind == "numbers":
        return [_number(part) for part in stripped.strip("[]").replace(",", " ").split()]
    if kind == "strings":
        return [line.strip() for line in stripped.splitlines() if line.strip()]
    if kind == "matrix":
        return [[_number(part) for part in row.replace(",", " ").split()] for row in stripped.splitlines()]
    return stripped


def shown(kind: Kind, value: Any) -> str:
    """A value as the form shows it; `typed` reads it back.

    Parameters
    ----------
    kind : str
        As `fields.Entry` has it.
    value : any
        What the draft holds.

    Returns
    -------
    text : str
        "" for None.

    References
    ----------
    TOML 1.0, numbers.

    Examples
    --------
    >>> shown("numbers", [0.02, 0.03]), shown("number", 413.2), shown("number", None)
    ('0.02, 0.03', '413.2', '')
    """
    if value is None:
        return ""
    if kind == "matrix" and isinstance(value, list | tuple):
        return "\n".join(shown("numbers", row) for row in value)
    if isinstance(value, list | tuple):
        return ("\n" if kind == "strings" else ", ").join(shown("number", item) for item in value)
    return repr(value) if isinstance(value, float) else str(value)


def checked(draft: Draft, source: Source) -> tuple[Finding, ...]:
    """What is wrong with a draft, beside the fields that it is about.

    Parameters
    ----------
    draft : dict
        As TOML gives it.
    source : Source
        Where it came from.

    Returns
    -------
    findings : tuple of Finding
        Empty where the draft is a model file.

    References
    ----------
    Project convention: contract.md, "Exit codes".

    Examples
    --------
    >>> source = opened("thesis-binary", Path("."))
    >>> [finding.message for finding in checked(put(source.draft, ("wing", "chord_m"), -1.0), source)]
    ['must be greater than 0 and at most 100000']
    """
    from pydantic import ValidationError

    model = kinds()[source.model.kind]
    try:
        model.model_validate(draft)
    except ValidationError as error:
        return tuple(_findings(error, model))
    return ()


def opened(name: str, folder: Path) -> Source:
    """A preset, or a model file of the folder, ready to be edited.

    Parameters
    ----------
    name : str
        Name of a preset, or of a file directly in the folder.
    folder : Path
        The folder that the studio works in.

    Returns
    -------
    source : Source
        What was read.

    Raises
    ------
    ModelFileError
        If there is no such model, it is not in the folder, or it is refused.

    References
    ----------
    Project convention: contract.md, `studio`.

    Examples
    --------
    >>> opened("goland", Path(".")).model.kind
    'beam_wing'
    """
    from aeroservo.aircraft.files import presets, read
    from aeroservo.studio.folder import inside

    if name in {preset.name for preset in presets()}:
        path = folder / f"{name}.toml"
        text = (Path(files.__file__).parent / "presets" / path.name).read_text(encoding="utf-8")
        return Source(path=path, text=text, model=read(name), preset=name)
    path = inside(folder, name, ".toml")
    model = read(path)
    text = path.read_text(encoding="utf-8-sig").replace("\r\n", "\n")
    if len(text.encode()) > LARGEST:
        raise ModelFileError(f"{path}: is larger than {LARGEST / 1e3:.0f} kB, the most that the studio edits")
    return Source(path=path, text=text, model=model)


def changes(before: Draft, after: Draft) -> tuple[str, ...]:
    """Where two drafts differ, by dotted path.

    Parameters
    ----------
    before, after : dict
        As TOML gives them.

    Returns
    -------
    paths : tuple of str
        In the order of `after`, then what it left out.

    References
    ----------
    Project convention: contract.md, `--over FIELD=MIN:MAX:STEP`.

    Examples
    --------
    >>> changes({"wing": {"chord_m": 1.0}}, {"wing": {"chord_m": 2.0}})
    ('wing.chord_m',)
    """
    return tuple(dotted(place) for place in _differing(before, after, ()))


def _differing(a: Any, b: Any, place: Place) -> Iterator[Place]:
    if isinstance(a, dict) and isinstance(b, dict):
        for key in [*b, *(key for key in a if key not in b)]:
            yield from _differing(a.get(key), b.get(key), (*place, key))
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for i, (x, y) in enumerate(zip(a, b)):
            yield from _differing(x, y, (*place, i))
    elif a != b:
        yield place


def _inside(at: Any, key: int | str) -> Any:
    if isinstance(at, dict) and key in at:
        return at[key]
    if isinstance(at, list) and isinstance(key, int) and 0 <= key < len(at):
        return at[key]
    raise ValueError(f"{dotted([key])}: the model has no such place")


def _number(text: str, *, whole: bool = False) -> Any:
    """A number, or the text where it is none."""
    try:
        return int(text) if whole else float(text)
    except ValueError:
        return text


def _findings(error: Any, model: type[FileModel]) -> Iterable[Finding]:
    """Each finding of pydantic in the words of the command line, without the field that it stands beside."""
    from pydantic_core import InitErrorDetails, ValidationError

    every = error.errors(include_url=False)
    for found in every:
        inner = [other for other in every if len(other["loc"]) > len(found["loc"])]
        if found["type"] == "too_short" and any(o["loc"][: len(found["loc"])] == found["loc"] for o in inner):
            continue  # too short only because an entry in it was refused
        details = InitErrorDetails(type=found["type"], loc=found["loc"], input=found["input"], ctx=found.get("ctx", {}))
        single = ValidationError.from_exception_data(model.__name__, [details])
        message = explained(single, model, "").removeprefix(": ")
        place = tuple(found["loc"])
        message = message.removeprefix(dotted(place)).removeprefix(":").strip()
        if message.startswith("= ") and " must be " in message:
            message = "must be " + message.split(" must be ", 1)[1]
        if message.endswith(")") and " (" in message and found["type"] != "value_error":
            message = _without_description(message)
        message = message.replace(" (at least 1e-15)", "").replace("text in quotes", "text")
        yield Finding(place=place, message=message)


def _without_description(message: str) -> str:
    """A message without the meaning of the field in brackets at its end, which the form shows already."""
    depth = 0
    for i in range(len(message) - 1, -1, -1):
        depth += {")": 1, "(": -1}.get(message[i], 0)
        if depth == 0:
            return message[:i].rstrip()
    return message
