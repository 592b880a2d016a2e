"""A draft written back into the text that it came from, comments and layout kept."""

from __future__ import annotations

import tomllib
from difflib import SequenceMatcher
from typing import Any

from aeroservo.studio.draft import Draft, Source


def text_of(draft: Draft, source: Source) -> str:
    """The draft as the text of a file: the source's own, comments and all, with the changed values in it.

    Parameters
    ----------
    draft : dict
        As TOML gives it.
    source : Source
        Where it came from.

    Returns
    -------
    text : str
        TOML that says what the draft says.

    References
    ----------
    TOML 1.0.

    Examples
    --------
    >>> from pathlib import Path
    >>> from aeroservo.studio.draft import opened, put
    >>> source = opened("thesis-binary", Path("."))
    >>> text = text_of(put(source.draft, ("wing", "chord_m"), 0.6), source)
    >>> next(line for line in text.splitlines() if line.startswith("chord_m"))
    'chord_m = 0.6                          # m. Table 1: mean aerodynamic chord'
    """
    import tomlkit

    document = tomlkit.parse(source.text)
    _merge(document, draft)
    text = tomlkit.dumps(document)
    try:
        if tomllib.loads(text) == draft:
            return text
    except tomllib.TOMLDecodeError:
        pass
    return tomlkit.dumps(draft)  # a layout that values cannot be put back into: without comments, but right


def _merge(old: Any, new: dict[str, Any]) -> None:
    """Bring a document to what a draft says, leaving alone what says so already."""
    import tomlkit

    for key in [key for key in old if key not in new]:
        old.remove(key)
    for key, value in new.items():
        if key not in old:
            old.append(key, tomlkit.item(value))
        elif isinstance(value, dict) and isinstance(old[key], dict):
            _merge(old[key], value)
        elif _tables(value) and isinstance(old[key], tomlkit.items.AoT):
            _merge_rows(old[key], value)
        elif old[key] != value:
            old[key] = value


def _merge_rows(old: Any, new: list[dict[str, Any]]) -> None:
    """Rows that are in both keep their place and comments."""
    import tomlkit

    before, after = [repr(row) for row in old.unwrap()], [repr(row) for row in new]
    for what, i1, i2, j1, j2 in reversed(SequenceMatcher(None, before, after, autojunk=False).get_opcodes()):
        if what == "equal":
            continue
        both = min(i2 - i1, j2 - j1)
        for i in range(i2 - 1, i1 + both - 1, -1):
            del old[i]
        for j in range(j1 + both, j2):
            old.insert(i1 + j - j1, tomlkit.item(new[j]))
        for i, j in zip(range(i1, i1 + both), range(j1, j1 + both)):
            _merge(old[i], new[j])


def _tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(row, dict) for row in value)
