"""Airfoils by name and from coordinate files, read as they are found."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import numpy as np

from aeroservo.aero.airfoil import FEWEST, Airfoil
from aeroservo.aero.airfoil_naca import naca_outline

#: A surface may run backwards by this share of the chord in all before it is called disordered.
BACKWARD = 0.05


def airfoil(name: str) -> Airfoil:
    """An airfoil by name: shipped, NACA 4- or 5-digit, or a coordinate file.

    Parameters
    ----------
    name : str
        ``"MH 62"`` (spaces, dashes and case do not matter), ``"naca2412"``, ``"naca23012"``, or the path of a file.

    Returns
    -------
    Airfoil
        The outline.

    Raises
    ------
    ValueError
        If there is no such airfoil.

    References
    ----------
    Project convention: aero/airfoils/SOURCE.md for shipped coordinates.

    Examples
    --------
    >>> airfoil("MH 62").name
    'MH 62  9.3%'
    """
    key = "".join(c for c in name.lower() if c.isalnum())
    if key.startswith("naca") and key[4:].isdigit():
        return Airfoil(name=f"NACA {key[4:]}", points=naca_outline(key[4:]))
    if key in shipped_airfoils():
        return parse_airfoil(
            (files("aeroservo.aero") / "airfoils" / f"{key}.dat").read_text(encoding="utf-8"), name=key
        )
    path = Path(name)
    if path.suffix and path.is_file():
        return read_airfoil(path)
    raise ValueError(
        f"no airfoil {name!r}: give one of {', '.join(shipped_airfoils())}, naca2412, naca23012 and the like, "
        "or the path of a coordinate file (.dat)"
    )


def shipped_airfoils() -> tuple[str, ...]:
    """Names of the airfoils whose coordinates come with the package.

    Returns
    -------
    names : tuple of str
        In alphabetical order.

    References
    ----------
    Project convention: aero/airfoils/SOURCE.md.

    Examples
    --------
    >>> "mh62" in shipped_airfoils()
    True
    """
    folder = files("aeroservo.aero") / "airfoils"
    return tuple(sorted(entry.name[:-4] for entry in folder.iterdir() if entry.name.endswith(".dat")))


def read_airfoil(path: str | Path) -> Airfoil:
    """An airfoil from a Selig or Lednicer file.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    Airfoil
        See `parse_airfoil`.

    Raises
    ------
    ValueError
        If the file is not there or holds no outline.

    References
    ----------
    M. Selig, UIUC Airfoil Coordinates Database, 1996, section "Data format".

    Examples
    --------
    >>> from importlib.resources import files
    >>> len(read_airfoil(str(files("aeroservo.aero") / "airfoils" / "mh62.dat")).points)
    68
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise ValueError(f"airfoil file {path} cannot be read: {error.strerror}") from None
    return parse_airfoil(text, name=path.stem)


def parse_airfoil(text: str, *, name: str = "airfoil") -> Airfoil:
    """An airfoil from the text of a coordinate file.

    Parameters
    ----------
    text : str
        Selig order (one loop) or Lednicer order (upper, then lower surface from the leading edge), with or without a
        name and counts; columns by spaces, tabs, commas or semicolons; chord of 1, 100 or any; either direction.
    name : str
        Name where the text has none.

    Returns
    -------
    Airfoil
        On a chord of one: shifted and scaled, not rotated; repeated points dropped.

    Raises
    ------
    ValueError
        If a number is not finite, there are too few points, or their order makes no outline.

    References
    ----------
    M. Selig, UIUC Airfoil Coordinates Database, 1996, section "Data format".

    Examples
    --------
    >>> text = "diamond\\n1 0\\n.75 .03\\n.5 .05\\n0 0\\n.25 -.03\\n.5 -.05\\n.75 -.03\\n1 0\\n"
    >>> parse_airfoil(text).points.shape
    (8, 2)
    """
    title, blocks = _numbers(text, name)
    flat = [pair for block in blocks for pair in block]
    if flat and flat[0][0] > 1.5 and flat[0][1] > 1.5 and flat[0][0] == int(flat[0][0]) and _fits(flat):
        upper = int(flat[0][0])
        points = _lednicer(np.array(flat[1:]), upper)
    elif (
        len(blocks) == 2 and len(blocks[0]) > 2 and len(blocks[1]) > 2 and abs(blocks[0][0][0] - blocks[1][0][0]) < 1e-3
    ):
        points = _lednicer(np.array(flat), len(blocks[0]))
    else:
        points = np.array(flat).reshape(-1, 2)
    points = points[np.append(True, np.any(np.diff(points, axis=0) != 0.0, axis=1))[: len(points)]]
    if len(points) < FEWEST:
        raise ValueError(
            f"airfoil {title!r}: {len(points)} point(s) found, {FEWEST} or more are needed; "
            "is this a coordinate file (two columns, x and z)?"
        )
    points = _ordered(points, title)
    return Airfoil(name=title, points=points)


def _numbers(text: str, name: str) -> tuple[str, list[list[tuple[float, float]]]]:
    """Title, and the pairs of numbers in blocks as blank lines part them."""
    title, blocks = "", [[]]  # type: ignore[var-annotated]
    for number, line in enumerate(text.replace("\ufeff", "").splitlines(), start=1):
        cleaned = line.split("#")[0].replace(",", " ").replace(";", " ").strip()
        if not cleaned:
            if blocks[-1]:
                blocks.append([])
            continue
        words = cleaned.split()
        try:
            values = [float(word.replace("D", "E").replace("d", "e")) for word in words]
        except ValueError:
            values = []
        if len(values) < 2:
            started = any(blocks)
            if started and not title.startswith("\0"):
                raise ValueError(f"airfoil {title or name!r}: line {number} is no point (x z): {line.strip()!r}")
            title = title or cleaned
            continue
        if not np.all(np.isfinite(values[:2])):
            raise ValueError(
                f"airfoil {title or name!r}: line {number} holds a value that is not finite: {line.strip()!r}"
            )
        blocks[-1].append((values[0], values[1]))
    return title or name, [block for block in blocks if block]


def _fits(flat: list[tuple[float, float]]) -> bool:
    """Whether the first pair counts the points that follow."""
    return int(flat[0][0]) + int(flat[0][1]) == len(flat) - 1


def _lednicer(points: np.ndarray, upper: int) -> np.ndarray:
    """Two surfaces from the leading edge, joined to one loop."""
    return np.concatenate([points[:upper][::-1], points[upper:]])


def _ordered(points: np.ndarray, title: str) -> np.ndarray:
    """The loop in Selig order on a chord of one; an error where the points are in disorder."""
    low, high = points[:, 0].min(), points[:, 0].max()
    if high - low <= 0.0:
        raise ValueError(f"airfoil {title!r}: all points lie at x = {low:g}; the columns must be x and z")
    points = (points - [low, 0.0]) / (high - low)
    step = np.roll(points, -1, axis=0)
    if np.sum(points[:, 0] * step[:, 1] - step[:, 0] * points[:, 1]) < 0.0:
        points = points[::-1]
    nose = int(np.argmin(points[:, 0]))
    dx = np.diff(points[:, 0])
    backward = max(float(np.sum(np.maximum(dx[:nose], 0.0))), float(np.sum(np.maximum(-dx[nose:], 0.0))))
    if not 1 < nose < len(points) - 2 or backward > BACKWARD:
        raise ValueError(
            f"airfoil {title!r}: the points do not run once round an outline (trailing edge, one surface, leading "
            "edge, the other surface); check their order"
        )
    end = min(points[0, 0], points[-1, 0])
    if end < 0.9:
        raise ValueError(f"airfoil {title!r}: one surface ends at x = {end:g}, short of the trailing edge")
    return points
