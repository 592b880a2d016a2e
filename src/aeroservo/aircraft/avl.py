"""AVL geometry files (`.avl`) as aircraft of this package.

What is read: reference quantities, surfaces with sections, duplicates across y = 0, scale, translation and incidence,
NACA and file airfoils, controls. What has no meaning here (bodies, drag polars, design variables, spacings) is left
out, and the notes say so. A control is deflected streamwise here and about its hinge line in AVL: a hinge swept by L
makes AVL's derivatives smaller by cos L.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from aeroservo.aircraft.aircraft_schema import AircraftFile

_KEYWORDS = (
    "SURF", "BODY", "SECT", "YDUP", "SCAL", "TRAN", "ANGL", "COMP", "INDE", "NOWA", "NOAL", "NOLO", "NACA", "AIRF",
    "AFIL", "CLAF", "CDCL", "CONT", "DESI", "BFIL",
)  # fmt: skip
#: Keywords without effect here, and how many lines of numbers follow each.
_IGNORED = {"COMP": 1, "INDE": 1, "NOWA": 0, "NOAL": 0, "NOLO": 0, "CLAF": 1, "CDCL": 1, "DESI": 1}


@dataclass(frozen=True, kw_only=True, eq=False)
class AvlImport:
    """An AVL file read; see `read_avl`."""

    model: AircraftFile  # the aircraft, checked
    data: dict[str, Any]  # the same as the tables of a model file, ready to be written as TOML
    mach: float  # [-] Mach number of the file
    notes: tuple[str, ...]  # what was left out or read in one of several ways


@dataclass(kw_only=True)
class _Surface:
    name: str
    mirrored: bool = False
    angle: float = 0.0
    scale: np.ndarray = field(default_factory=lambda: np.ones(3))
    shift: np.ndarray = field(default_factory=lambda: np.zeros(3))
    sections: list[dict[str, Any]] = field(default_factory=list)
    controls: list[list[tuple[str, float, float, float]]] = field(default_factory=list)


def read_avl(path: str | Path) -> AvlImport:
    """An aircraft from an AVL geometry file.

    Parameters
    ----------
    path : str or Path
        The file; airfoil files are looked for beside it.

    Returns
    -------
    AvlImport
        The aircraft without masses and structure, which AVL keeps elsewhere, and notes.

    Raises
    ------
    ValueError
        If the file cannot be read or a line does not fit, with its number.

    References
    ----------
    M. Drela, H. Youngren, AVL 3.36 user guide, 2017, section "Input file".

    Examples
    --------
    >>> import tempfile, os
    >>> name = os.path.join(tempfile.mkdtemp(), "plank.avl")
    >>> text = "plank\\n0.0\\n0 0 0\\n4 1 4\\n0.25 0 0\\nSURFACE\\nwing\\n8 1\\nYDUP\\n0\\n"
    >>> with open(name, "w") as f:
    ...     n = f.write(text + "SECTION\\n0 0 0 1 0\\nSECTION\\n0 2 0 1 0\\n")
    >>> read_avl(name).model.derived()["wing_aspect_ratio"]
    4.0
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise ValueError(f"AVL file {path} cannot be read: {error.strerror}") from None
    return parse_avl(text, folder=path.parent, name=path.stem)


def parse_avl(text: str, *, folder: Path | None = None, name: str = "avl") -> AvlImport:
    """An aircraft from the text of an AVL geometry file.

    Parameters
    ----------
    text : str
        The file's content.
    folder : Path, optional
        Where airfoil files are.
    name : str
        Name in messages.

    Returns
    -------
    AvlImport
        See `read_avl`.

    Raises
    ------
    ValueError
        If a line does not fit, with its number.

    References
    ----------
    M. Drela, H. Youngren, AVL 3.36 user guide, 2017, section "Input file".

    Examples
    --------
    >>> head = "fin\\n0\\n0 0 0\\n1 1 1\\n0 0 0\\nSURFACE\\nfin\\n4 1\\n"
    >>> parse_avl(head + "SECTION\\n0 0 0 1 0\\nSECTION\\n0.3 0 1 0.5 0\\n").model.surface[0].mirrored
    False
    """
    lines = _Lines(text, name)
    title = lines.words(1)[0]
    mach = lines.numbers(1)[0]
    symmetry = lines.numbers(3)
    S, c, b = lines.numbers(3)[:3]
    x, y, z = lines.numbers(3)[:3]
    notes: list[str] = []
    if lines.next_is_number():
        notes.append(
            f"the profile drag CDp = {lines.numbers(1)[0]:g} is left out: profile drag comes from section polars"
        )
    if symmetry[1] != 0.0:
        notes.append("the ground or free surface (iZsym) is left out")
    if y != 0.0:
        notes.append(f"Yref = {y:g} is taken as 0")
    surfaces = _surfaces(lines, folder, notes)
    if not surfaces:
        raise ValueError(f"{name}: the file has no SURFACE")
    if symmetry[0] > 0.0:
        for s in surfaces:
            s.mirrored = s.mirrored or any(q["y_m"] != 0.0 for q in s.sections)
        notes.append("iYsym = 1: every surface beside the plane y = 0 gets a twin")
    elif symmetry[0] < 0.0:
        raise ValueError(f"{name}: iYsym = -1 (antisymmetric flow) describes no aircraft; set it to 0 or 1")
    data: dict[str, Any] = {
        "schema_version": 1,
        "kind": "aircraft",
        "name": title[:200],
        "surface": [_as_table(s, notes) for s in surfaces],
        "reference": {"S_m2": S, "c_m": c, "b_m": b, "x_m": x, "z_m": z},
    }
    return AvlImport(model=AircraftFile.model_validate(data), data=data, mach=mach, notes=tuple(dict.fromkeys(notes)))


class _Lines:
    """The lines that count, each with its number."""

    def __init__(self, text: str, name: str) -> None:
        self.name = name
        self.rows = [
            (number, cleaned)
            for number, line in enumerate(text.splitlines(), start=1)
            if (cleaned := line.split("!")[0].split("#")[0].strip())
        ]
        self.at = 0

    def words(self, least: int) -> list[str]:
        """The next line; its words, or as one word when one is enough."""
        if self.at >= len(self.rows):
            raise ValueError(f"{self.name}: the file ends where a line was expected")
        number, line = self.rows[self.at]
        self.at += 1
        found = [line] if least == 1 else line.split()
        if len(found) < least:
            raise ValueError(f"{self.name}, line {number}: {least} values expected, got {line!r}")
        return found

    def numbers(self, least: int) -> list[float]:
        """The leading numbers of the next line."""
        number, line = self.rows[self.at] if self.at < len(self.rows) else (0, "")
        values = []
        for word in " ".join(self.words(0)).split():
            try:
                values.append(float(word.replace("D", "E").replace("d", "e")))
            except ValueError:
                break
        if len(values) < least or not np.all(np.isfinite(values)):
            raise ValueError(f"{self.name}, line {number}: {least} number(s) expected, got {line!r}")
        return values

    def keyword(self) -> str:
        """The keyword that the next line starts with, or nothing."""
        if self.at >= len(self.rows):
            return ""
        word = self.rows[self.at][1].split()[0].upper()[:4]
        return word if word in _KEYWORDS else ""

    def next_is_number(self) -> bool:
        """Whether the next line starts with a number."""
        if self.at >= len(self.rows):
            return False
        try:
            float(self.rows[self.at][1].split()[0])
        except ValueError:
            return False
        return True

    def until_keyword(self) -> Iterator[str]:
        """Lines up to the next keyword."""
        while self.at < len(self.rows) and not self.keyword():
            yield self.words(1)[0]


def _surfaces(lines: _Lines, folder: Path | None, notes: list[str]) -> list[_Surface]:
    """Every SURFACE of the file."""
    out: list[_Surface] = []
    while lines.at < len(lines.rows):
        key = lines.keyword()
        number, line = lines.rows[lines.at]
        lines.at += 1
        if key == "SURF":
            out.append(
                _Surface(name="".join(ch if ch.isalnum() else "_" for ch in lines.words(1)[0]).strip("_") or "surface")
            )
            lines.numbers(1)
        elif key == "BODY":
            notes.append("bodies are left out")
            list(lines.until_keyword())
        elif key in ("BFIL", ""):
            if key == "BFIL" or (out and not out[-1].sections) or not out:
                list(lines.until_keyword())
            else:
                raise ValueError(f"{lines.name}, line {number}: no AVL keyword: {line!r}")
        elif not out:
            list(lines.until_keyword())  # still inside a body
        else:
            _surface_line(key, lines, out[-1], folder, notes)
    return out


def _surface_line(key: str, lines: _Lines, s: _Surface, folder: Path | None, notes: list[str]) -> None:
    """One keyword inside a surface."""
    if key == "SECT":
        v = lines.numbers(5)
        s.sections.append(
            {"x_le_m": v[0], "y_m": v[1], "z_le_m": v[2], "chord_m": v[3], "twist_deg": v[4], "airfoil": "flat"}
        )
        s.controls.append([])
    elif key == "YDUP":
        if lines.numbers(1)[0] != 0.0:
            raise ValueError(
                f"{lines.name}: surface {s.name!r} is duplicated about a plane other than y = 0; give both halves"
            )
        s.mirrored = True
    elif key == "SCAL":
        s.scale = np.array(lines.numbers(3)[:3])
    elif key == "TRAN":
        s.shift = np.array(lines.numbers(3)[:3])
    elif key == "ANGL":
        s.angle = lines.numbers(1)[0]
    elif key in _IGNORED:
        for _ in range(_IGNORED[key]):
            lines.words(1)
        if key in ("CLAF", "CDCL", "DESI", "NOWA", "NOAL", "NOLO"):
            notes.append(f"{key} is left out")
    elif not s.sections:
        raise ValueError(f"{lines.name}: {key} before the first SECTION of {s.name!r}")
    elif key == "NACA":
        s.sections[-1]["airfoil"] = "naca" + lines.words(1)[0].split()[0]
    elif key == "AFIL":
        file = lines.words(1)[0].strip("\"'")
        s.sections[-1]["airfoil"] = str(folder / file) if folder is not None else file
    elif key == "AIRF":
        list(lines.until_keyword())
        notes.append(f"airfoil coordinates inside the file are left out (surface {s.name}): save them as .dat")
    elif key == "CONT":
        words = lines.words(3)
        values = [float(w) for w in words[1:]]
        sign = values[5] if len(values) > 5 else 1.0
        if values[1] < 0.0:
            raise ValueError(
                f"{lines.name}: control {words[0]!r} of {s.name!r} is a leading-edge device (Xhinge < 0), not supported"
            )
        s.controls[-1].append((words[0], values[0], values[1], sign))


def _as_table(s: _Surface, notes: list[str]) -> dict[str, Any]:
    """The surface as the tables of a model file."""
    sections = []
    for q in s.sections:
        at = np.array([q["x_le_m"], q["y_m"], q["z_le_m"]]) * s.scale + s.shift
        sections.append(
            {
                "x_le_m": float(at[0]),
                "y_m": float(at[1]),
                "z_le_m": float(at[2]),
                "chord_m": q["chord_m"] * float(s.scale[0]),
                "twist_deg": q["twist_deg"] + s.angle,
                "airfoil": q["airfoil"],
            }
        )
    steps = [math.hypot(b["y_m"] - a["y_m"], b["z_le_m"] - a["z_le_m"]) for a, b in pairwise(sections)]
    total = sum(steps)
    if total <= 0.0:
        raise ValueError(f"surface {s.name!r} has no span")
    station = np.concatenate([[0.0], np.cumsum(steps)]) / total
    controls = _controls(s, station, notes)
    return {"name": s.name, "mirrored": s.mirrored, "section": sections, "control": controls}


def _controls(s: _Surface, station: np.ndarray, notes: list[str]) -> list[dict[str, Any]]:
    """Controls panel by panel; neighbours on one line are joined, two names on one hinge share a control."""
    out: list[dict[str, Any]] = []
    for i in range(len(station) - 1):
        inner = {c[0]: c for c in s.controls[i]}
        outer = {c[0]: c for c in s.controls[i + 1]}
        both = [n for n in inner if n in outer]
        if not both:
            continue
        lines = {(inner[n][2], outer[n][2]) for n in both}
        if len(lines) > 1:
            raise ValueError(
                f"surface {s.name!r}: controls {', '.join(both)} overlap with different hinges; not supported"
            )
        gains = [0.0, 0.0]
        for n in both:
            if inner[n][1] != outer[n][1]:
                notes.append(f"control {n}: the gain varies along the span; the inboard value of each panel is taken")
            gains[0 if inner[n][3] > 0.0 or not s.mirrored else 1] += inner[n][1]
        (h0, h1), name = lines.pop(), "_".join(both)
        piece = {
            "name": name,
            "from_span": float(station[i]),
            "to_span": float(station[i + 1]),
            "hinge_from": h0,
            "hinge_to": h1,
            "symmetric": gains[0],
            "antisymmetric": gains[1],
        }
        last = out[-1] if out else None
        if last and last["to_span"] == piece["from_span"] and _joins(last, piece):
            last |= {"to_span": piece["to_span"], "hinge_to": h1}
            continue
        taken = sum(1 for c in out if c["name"] == name or c["name"].startswith(f"{name}_{s.name}"))
        piece["name"] = name if not taken else f"{name}_{s.name}_{taken + 1}"
        out.append(piece)
    if out:
        notes.append(
            "deflections are streamwise here and about the hinge line in AVL: a hinge swept by L differs by cos L"
        )
    return out


def _joins(a: dict[str, Any], b: dict[str, Any]) -> bool:
    """Whether two neighbouring pieces are one straight hinge with the same gains."""
    slope_a = (a["hinge_to"] - a["hinge_from"]) / (a["to_span"] - a["from_span"])
    slope_b = (b["hinge_to"] - b["hinge_from"]) / (b["to_span"] - b["from_span"])
    same = a["symmetric"] == b["symmetric"] and a["antisymmetric"] == b["antisymmetric"]
    return bool(same and abs(slope_a - slope_b) < 1e-9 and abs(a["hinge_to"] - b["hinge_from"]) < 1e-9)
