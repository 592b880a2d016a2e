"""Tables 2 and 3 of the thesis beside ours as rows of text, as plain-text tables for a terminal and as HTML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

from aeroservo.studies.thesis import ALTITUDES, MODELS, SLOPES, Held, Row, ThesisStudy
from aeroservo.studies.thesis_fixed_k import common_ranges

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table as RichTable

SLOPE_TEXT = {"a_w": "a_1 = a_w", "2 pi": "a_1 = 2 pi"}


@dataclass(frozen=True, kw_only=True)
class TextTable:
    """A table in words.

    Attributes
    ----------
    title : str
        Above it.
    header : tuple of str
        Names of the columns.
    rows : tuple of tuple of str
        Cells.
    numbers : tuple of int
        Columns set to the right.
    notes : tuple of str
        Below it, numbered in the column "note" where it has one.
    """

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: tuple[int, ...]
    notes: tuple[str, ...]


def text_tables(study: ThesisStudy) -> tuple[TextTable, ...]:
    """Table 2, Table 3, and which k prints the thesis' unsteady flutter speeds.

    Parameters
    ----------
    study : ThesisStudy
        Of `thesis_study`.

    Returns
    -------
    tables : tuple of TextTable
        Three.
    """
    printed = [_speeds(altitude, [r for r in study.rows if r.altitude == altitude]) for altitude in ALTITUDES]
    return (*printed, _held_table(study.held))


def _speeds(altitude: float, rows: Sequence[Row]) -> TextTable:
    """Table 2 or 3; divergence and reversal stand once where both columns print and compute the same."""
    notes: list[str] = []
    cells = []
    for row in rows:
        twin = [r for r in rows if (r.model, r.quantity) == (row.model, row.quantity)]
        same = row.quantity != "flutter" and len({(r.printed, r.computed) for r in twin}) == 1
        if same and row is not twin[0]:
            continue
        if row.reason not in notes:
            notes.append(row.reason)
        cells.append(
            (
                row.model,
                row.quantity,
                "both" if same else row.column,
                row.theory,
                str(row.printed),
                "none" if row.computed is None else f"{row.computed:.2f}",
                "-" if row.difference is None else f"{row.difference:+.2f}",
                str(notes.index(row.reason) + 1),
            )
        )
    where = "sea level" if altitude == 0.0 else "10,000 ft (3048 m)"
    return TextTable(
        title=f"Table {rows[0].table}: {where}, true airspeeds in m/s",
        header=("model", "speed", "column", "ours by", "thesis", "ours", "diff", "note"),
        rows=tuple(cells),
        numbers=(4, 5, 6, 7),
        notes=tuple(notes),
    )


def _held_table(held: Iterable[Held]) -> TextTable:
    """Which k of the held derivatives rounds to the printed number."""
    held = tuple(sorted(held, key=lambda h: (MODELS.index(h.model), SLOPES.index(h.slope), h.altitude)))
    cells = tuple(
        (
            h.model,
            "sea level" if h.altitude == 0.0 else "10,000 ft",
            h.slope,
            str(h.printed),
            _ranges(h.ranges),
            "-" if h.own_k is None else f"{h.own_k:.3f}",
            "none" if h.own_speed is None else f"{h.own_speed:.2f}",
        )
        for h in held
    )
    return TextTable(
        title="Unsteady flutter: derivatives held at one k, and consistent p-k; m/s",
        header=("model", "altitude", "a_1", "thesis", "k that prints it", "own k", "p-k m/s"),
        rows=cells,
        numbers=(3, 5, 6),
        notes=(*held_conclusions(held), *_CAUTIONS),
    )


_CAUTIONS = (
    "held derivatives are the thesis' form (Eqs. 7.34-7.36): one k for every speed and mode",
    "own k is that of the flutter itself: there held derivatives and Theodorsen p-k are the same; at any other k the "
    "held ones belong to a motion that does not occur",
    "a_1 is the slope of the circulatory lift; divergence and reversal above keep a_w = 3 per rad",
)


def held_conclusions(held: Iterable[Held]) -> tuple[str, ...]:
    """For each model, whether one k prints both of the thesis' unsteady numbers.

    Parameters
    ----------
    held : iterable of Held
        Of `thesis_study`.

    Returns
    -------
    sentences : tuple of str
        One for each model and slope.
    """
    held = tuple(held)
    sentences = []
    for model in MODELS:
        for slope in SLOPES:
            both = [h for h in held if (h.model, h.slope) == (model, slope)]
            if len(both) != 2:
                continue
            numbers = " and ".join(str(h.printed) for h in both)
            common = common_ranges(both[0].ranges, both[1].ranges)
            verdict = f"k = {_ranges(common)} prints {numbers}" if common else f"no k prints {numbers}"
            sentences.append(f"{model}, {SLOPE_TEXT[slope]}: {verdict}")
    return tuple(sentences)


def _ranges(ranges: Sequence[tuple[float, float]]) -> str:
    """Ranges of k in words."""
    return " or ".join(f"{low:.3g} to {high:.3g}" for low, high in ranges) or "none"


def print_tables(study: ThesisStudy, console: Console) -> None:
    """Print the tables; lines fit the console, 80 columns where it is a pipe.

    Parameters
    ----------
    study : ThesisStudy
        Of `thesis_study`.
    console : rich Console
        Printed to.
    """
    for table in text_tables(study):
        with console.capture() as captured:
            console.print(_drawn(table))
            console.print(_notes(table.notes))
        console.file.write("\n" + "\n".join(line.rstrip() for line in captured.get().splitlines()) + "\n")
    console.file.flush()


def _drawn(table: TextTable) -> RichTable:
    """A table with a rule between models."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    drawn = Table(
        title=Text(table.title, style="bold"), title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0)
    )
    drawn.show_edge = drawn.pad_edge = False
    for j, name in enumerate(table.header):
        drawn.add_column(name, justify="right" if j in table.numbers else "left")
    previous = table.rows[0][0] if table.rows else ""
    for row in table.rows:
        if row[0] != previous:
            drawn.add_section()
        previous = row[0]
        drawn.add_row(*(Text(cell) for cell in row))
    return drawn


def _notes(notes: Sequence[str]) -> RichTable:
    """Numbered notes with a hanging indent."""
    from rich.table import Table
    from rich.text import Text

    grid = Table.grid(padding=(0, 1))
    grid.add_column(justify="right", width=3)
    grid.add_column(overflow="fold")
    for number, note in enumerate(notes, 1):
        grid.add_row(str(number), Text(note))
    return grid


def html_tables(study: ThesisStudy) -> str:
    """The tables as HTML, every text escaped.

    Parameters
    ----------
    study : ThesisStudy
        Of `thesis_study`.

    Returns
    -------
    html : str
        Sections without a page around them.
    """
    parts = []
    for table in text_tables(study):
        head = "".join(f"<th{_right(j, table)}>{escape(name)}</th>" for j, name in enumerate(table.header))
        body = "".join(
            "<tr>" + "".join(f"<td{_right(j, table)}>{escape(cell)}</td>" for j, cell in enumerate(row)) + "</tr>"
            for row in table.rows
        )
        notes = "".join(f"<li>{escape(note)}</li>" for note in table.notes)
        parts.append(
            f"<h2>{escape(table.title)}</h2><div class='wide'><table><thead><tr>{head}</tr></thead>"
            f"<tbody>{body}</tbody></table></div><ol>{notes}</ol>"
        )
    return "\n".join(parts)


def _right(j: int, table: TextTable) -> str:
    """Attribute of a cell set to the right."""
    return " class='n'" if j in table.numbers else ""
