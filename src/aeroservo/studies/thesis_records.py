"""What the re-run of the thesis consists of: figures as curves, printed numbers beside ours, claims with a verdict.

Plain data without drawing: `report.thesis_parts` makes a page of it, `report.thesis_markdown` the page of the docs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from aeroservo.studies.surface import DampingSurface

Verdict = Literal["holds", "holds in part", "does not hold"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """One curve of a plot; nan breaks it.

    Attributes
    ----------
    name : str
        In the legend.
    x, y : array_like, shape (n,)
        Points; kept as arrays. [axis]
    points : bool
        Drawn as points, not as a line.
    """

    name: str
    x: Any
    y: Any
    points: bool = False

    def __post_init__(self) -> None:
        """Flat arrays of one length."""
        for name in ("x", "y"):
            array = np.array(getattr(self, name), dtype=float).ravel()
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        if self.x.shape != self.y.shape:
            raise ValueError(f"curve {self.name!r}: x and y must have one length, got {self.x.size} and {self.y.size}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Plot:
    """Curves over two axes.

    Attributes
    ----------
    title : str
        What is shown.
    x_label, y_label : str
        Quantity and unit.
    curves : tuple of Curve
        In the order of the legend.
    marks : tuple of (float, str)
        Upright lines at values of x, with their names. [axis]
    x_range, y_range : (float, float), optional
        Of the axes. [axis]
    equal : bool
        One unit is as long on both axes.
    """

    title: str
    x_label: str
    y_label: str
    curves: tuple[Curve, ...]
    marks: tuple[tuple[float, str], ...] = ()
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    equal: bool = False


@dataclass(frozen=True, kw_only=True)
class Compared:
    """A number or statement of the thesis beside ours.

    Attributes
    ----------
    what : str
        Of what.
    unit : str
        Of both, "" where there is none.
    thesis, ours : float, str or None
        As printed, and as computed; None where one of them gives none. [unit]
    reason : str
        Why they differ, or why they agree.
    """

    what: str
    unit: str
    thesis: float | str | None
    ours: float | str | None
    reason: str = ""

    @property
    def difference(self) -> float | None:
        """Ours less the thesis'. [unit]"""
        if isinstance(self.thesis, str) or isinstance(self.ours, str) or self.thesis is None or self.ours is None:
            return None
        return float(self.ours - self.thesis)


@dataclass(frozen=True, kw_only=True, eq=False)
class Entry:
    """A figure or table of the thesis, computed again.

    Attributes
    ----------
    number : str
        "Fig. 21", "Table 1".
    title : str
        What it is about.
    thesis : str
        What the thesis shows or says, in our words.
    finding : str
        What comes out here; numbers in it are computed.
    compared : tuple of Compared
        Numbers side by side.
    plots : tuple of Plot
        Our curves.
    unsound : str
        What is wrong with the thesis' way, and what stands beside it; "" where nothing is.
    surface : DampingSurface, optional
        Damping over speed and another number.
    """

    number: str
    title: str
    thesis: str
    finding: str
    compared: tuple[Compared, ...] = ()
    plots: tuple[Plot, ...] = ()
    unsound: str = ""
    surface: DampingSurface | None = None


@dataclass(frozen=True, kw_only=True)
class Claim:
    """A statement of the thesis, judged.

    Attributes
    ----------
    section : str
        Where it stands.
    statement : str
        In our words.
    verdict : {"holds", "holds in part", "does not hold"}
        Follows from the numbers.
    numbers : str
        Those that say so.
    """

    section: str
    statement: str
    verdict: Verdict
    numbers: str


def verdict(*, whole: bool, part: bool = False) -> Verdict:
    """The word for what the numbers say.

    Parameters
    ----------
    whole : bool
        Every part of the statement is borne out.
    part : bool
        At least a part is.

    Returns
    -------
    verdict : str
        Of a claim.
    """
    return "holds" if whole else "holds in part" if part else "does not hold"


def number(value: Any, digits: int = 4) -> str:
    """A number in words.

    Parameters
    ----------
    value : any
        Number, text or None.
    digits : int
        Significant digits.

    Returns
    -------
    text : str
        "none" where there is none.
    """
    if value is None:
        return "none"
    if isinstance(value, str):
        return value
    return f"{float(value):.{digits}g}" if np.isfinite(value) else "none"
