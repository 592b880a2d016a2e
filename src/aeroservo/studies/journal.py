"""A journal of unfinished work: one JSON line for each part that is done, so that an interruption loses nothing.

The first line says which work it is; a later call with the same work goes on where the journal ends.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any


class Journal:
    """Rows of an unfinished sweep beside its result, flushed one by one; a context manager.

    Attributes
    ----------
    path : Path or None
        Where it is; None keeps nothing.
    header : dict
        What tells one sweep from another, as JSON knows it.
    rows : list of dict
        Rows that were there already, then those that are added.
    """

    def __init__(self, path: Path | None, header: dict[str, Any]) -> None:
        self.path, self.header = path, json.loads(json.dumps(header))
        self.rows: list[dict[str, Any]] = []
        self._file: Any = None

    def __enter__(self) -> Journal:
        if self.path is None:
            return self
        whole = self._read(self.path) if self.path.exists() else json.dumps(self.header) + "\n"
        # Written again whole, so that a line cut by an interruption is gone; replaced in one step.
        temporary = self.path.with_name(self.path.name + ".new")
        temporary.write_text(whole, encoding="utf-8")
        os.replace(temporary, self.path)
        self._file = open(self.path, "a", encoding="utf-8")
        return self

    def __exit__(self, *_: object) -> None:
        if self._file is not None:
            self._file.close()

    def add(self, row: dict[str, Any]) -> None:
        """Keep a row.

        Parameters
        ----------
        row : dict
            As JSON knows it. [SI]
        """
        self.rows.append(row)
        if self._file is not None:
            self._file.write(json.dumps(row) + "\n")
            self._file.flush()

    def _read(self, path: Path) -> str:
        """Take over the rows of a journal of this very sweep; its complete lines."""
        text = path.read_text(encoding="utf-8", errors="replace")
        lines = text[: text.rfind("\n") + 1].splitlines()
        try:
            mine = bool(lines) and json.loads(lines[0]) == self.header
            rows = [json.loads(line) for line in lines[1:]] if mine else []
            mine = mine and all(isinstance(row, dict) for row in rows)
        except ValueError:
            mine = False
        if not mine:
            raise ValueError(
                f"{path}: is the journal of another sweep, or damaged; delete it or name another file to write to"
            )
        self.rows = rows
        return "".join(line + "\n" for line in lines)
