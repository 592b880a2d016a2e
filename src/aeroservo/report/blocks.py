"""What a page is made of: parts, and in them prose, tables, charts, drawings that move.

Everything here is data that knows nothing of HTML. Names may come from anybody's model file: whoever draws a block
escapes every text in it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

#: What an anchor may be: it ends up in addresses and file names.
ANCHOR = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")


#: Beyond this a number is a run that ran away.
LARGEST = 1e150


@dataclass(frozen=True, kw_only=True, eq=False)
class Prose:
    """Plain text; an empty line begins a new paragraph.

    Attributes
    ----------
    text : str
        Taken literally: no markup.
    kind : {"text", "note", "warning"}
        How much it stands out.
    """

    text: str
    kind: Literal["text", "note", "warning"] = "text"


@dataclass(frozen=True, kw_only=True, eq=False)
class Table:
    """Rows of texts and numbers; a number is shown with five digits, None and nan as a dash.

    Attributes
    ----------
    columns : tuple of str
        Headings, with units.
    rows : tuple of tuple
        Texts, numbers, None.
    caption : str
        What to read in it.
    title : str
        Above it, and the name of its CSV.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]
    caption: str = ""
    title: str = ""

    def __post_init__(self) -> None:
        """Every row is as long as the heading."""
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ValueError(f"every row must have {len(self.columns)} cells, got {len(row)}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Facts:
    """The few numbers that matter, large.

    Attributes
    ----------
    items : tuple of (str, str, str)
        Name, value with unit, remark.
    """

    items: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Series:
    """One curve of a chart; nan breaks it.

    Attributes
    ----------
    name : str
        In the legend.
    x, y : ndarray, shape (n,)
        Points, in the units of the chart's axes. [axis]
    kind : {"line", "points", "steps"}
        How it is drawn.
    colour : int, optional
        Number of its colour and dashes; default its place in the chart.
    along : ndarray, shape (n,), optional
        A third quantity told when a point is pointed at, such as the speed along a root locus. [any]
    along_label : str
        Its name and unit.
    """

    name: str
    x: Array
    y: Array
    kind: Literal["line", "points", "steps"] = "line"
    colour: int | None = None
    along: Array | None = None
    along_label: str = ""

    def __post_init__(self) -> None:
        """Flat arrays of one length; what is not finite, or has no place in any drawing, is nan."""
        n = None
        for name in ("x", "y", "along"):
            value = getattr(self, name)
            if value is None:
                continue
            array = np.array(value, dtype=float).ravel()
            array[~(np.abs(array) < LARGEST)] = np.nan
            array.flags.writeable = False
            n = len(array) if n is None else n
            if len(array) != n:
                raise ValueError(f"{name} of series {self.name!r} must have {n} values, got {len(array)}")
            object.__setattr__(self, name, array)


@dataclass(frozen=True, kw_only=True, eq=False)
class Mark:
    """A straight line through the whole chart at one value of x or y.

    Attributes
    ----------
    at : float
        Where. [axis]
    text : str
        In the legend.
    kind : {"flutter", "divergence", "reversal", "limit", "zero"}
        How it looks.
    axis : {"x", "y"}
        Which axis `at` belongs to.
    """

    at: float
    text: str
    kind: Literal["flutter", "divergence", "reversal", "limit", "zero"] = "limit"
    axis: Literal["x", "y"] = "x"


@dataclass(frozen=True, kw_only=True, eq=False)
class Band:
    """A shaded range of x.

    Attributes
    ----------
    start, end : float
        From and to. [axis]
    text : str
        In the legend.
    kind : {"flutter", "divergence", "limit"}
        Plain for flutter, hatched for divergence, pale beyond a limit.
    """

    start: float
    end: float
    text: str
    kind: Literal["flutter", "divergence", "limit"] = "flutter"


@dataclass(frozen=True, kw_only=True, eq=False)
class Chart:
    """Curves over two axes; downloadable as CSV.

    Attributes
    ----------
    series : tuple of Series
        The curves.
    x_label, y_label : str
        Quantity and unit of each axis ("true airspeed V, m/s").
    title : str
        What is shown; the name of the CSV follows from it.
    caption : str
        What to read in it.
    marks : tuple of Mark
        Straight lines.
    bands : tuple of Band
        Shaded ranges of x.
    x_range, y_range : (float, float), optional
        Of the axes; default what the series need. [axis]
    x_log, y_log : bool
        Logarithmic axes.
    x_down, y_down : bool
        Axes that run the other way.
    equal : bool
        One unit is as long on both axes.
    hover : {"x", "point"}
        Whether pointing tells all curves at one x, or the nearest point.
    """

    series: tuple[Series, ...]
    x_label: str
    y_label: str
    title: str
    caption: str = ""
    marks: tuple[Mark, ...] = ()
    bands: tuple[Band, ...] = ()
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    x_log: bool = False
    y_log: bool = False
    y_down: bool = False
    equal: bool = False
    hover: Literal["x", "point"] = "x"


@dataclass(frozen=True, kw_only=True, eq=False)
class Picture:
    """A picture inside the page.

    Attributes
    ----------
    png : bytes
        Content of a PNG file.
    alternative : str
        What it shows, for those who cannot see it.
    caption : str
        What to read in it.
    """

    png: bytes
    alternative: str
    caption: str = ""

    def __post_init__(self) -> None:
        """Nothing but PNG."""
        if not self.png.startswith(b"\x89PNG\r\n\x1a\n"):
            raise ValueError("png must be the content of a PNG file")


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """A wing that moves, in three dimensions: `report/scene.py` says what `data` holds.

    Attributes
    ----------
    data : mapping
        Made of dict, list, str, numbers and arrays.
    title : str
        Above it.
    caption : str
        What to look for.
    """

    data: Mapping[str, Any]
    title: str
    caption: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class LivePanel:
    """A simulation inside the page: `report/live.py` says what `data` holds.

    Attributes
    ----------
    data : mapping
        Linear models, gains, scene.
    title : str
        Above it.
    caption : str
        What to try.
    """

    data: Mapping[str, Any]
    title: str
    caption: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class Failed:
    """Why something is not there.

    Attributes
    ----------
    why : str
        In words.
    """

    why: str


Block: TypeAlias = Prose | Table | Facts | Chart | Picture | Scene | LivePanel | Failed


@dataclass(frozen=True, kw_only=True, eq=False)
class Part:
    """A section of a page.

    Attributes
    ----------
    title : str
        Heading.
    anchor : str
        Small letters, digits and hyphens; one part each.
    blocks : tuple of Block
        In order.
    """

    title: str
    anchor: str
    blocks: tuple[Block, ...] = ()

    def __post_init__(self) -> None:
        """The anchor is safe in an address."""
        if not ANCHOR.fullmatch(self.anchor):
            raise ValueError(f"anchor must be small letters, digits and hyphens, got {self.anchor[:40]!r}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Provenance:
    """Where the numbers of a page come from; nothing in it depends on the machine or on the day.

    Attributes
    ----------
    version : str
        Of this package.
    source : str
        Name of the preset or of the file (without its folder).
    options : tuple of (str, str)
        What was asked for.
    input_hash : str
        SHA-256 of the inputs in a canonical form.
    input_text : str
        The model file itself, shown at the end.
    command : str
        That makes this page again.
    """

    version: str
    source: str
    options: tuple[tuple[str, str], ...] = ()
    input_hash: str = ""
    input_text: str = field(default="", repr=False)
    command: str = ""
