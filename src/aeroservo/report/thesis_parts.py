"""The re-run of the thesis as parts of a page: tables, claims, every figure with what the thesis shows beside it."""

from __future__ import annotations

import re
from collections import Counter
from typing import Literal

from aeroservo.report.blocks import Block, Chart, Facts, Mark, Part, Picture, Prose, Series, Table
from aeroservo.report.style import as_bytes
from aeroservo.report.surfaces import surface_figure
from aeroservo.studies.thesis_records import Entry, Plot
from aeroservo.studies.thesis_study import COLUMNS, ThesisBook

MARKS: tuple[Literal["flutter", "divergence", "reversal"], ...] = ("flutter", "divergence", "reversal")


def thesis_parts(book: ThesisBook, *, pictures: bool = True) -> tuple[Part, ...]:
    """The whole re-run.

    Parameters
    ----------
    book : ThesisBook
        Of `thesis_book`.
    pictures : bool
        Whether damping surfaces are drawn.

    Returns
    -------
    parts : tuple of Part
        Tables 2 and 3, claims, misprints, then every table and figure in the thesis' order.
    """
    return (
        _summary(book),
        _claims(book),
        _misprints(book),
        *(entry_part(entry, pictures=pictures) for entry in book.entries),
    )


def _summary(book: ThesisBook) -> Part:
    """What the re-run says, and the tables of speeds."""
    count = Counter(claim.verdict for claim in book.claims)
    compared = [c for e in book.entries for c in e.compared if c.difference is not None]
    return Part(
        title="Tables 2 and 3",
        anchor="thesis-tables",
        blocks=(
            Prose(
                text="Chapters 8 and 9 of N. B. Bramstång's thesis (2015), computed again from the preset files "
                "alone. The "
                "thesis does not print the inputs of its models; they were inferred from Tables 1 to 3, and the "
                "notes say which "
                "numbers agree by construction. The sounder method stands beside each number."
            ),
            Facts(
                items=(
                    ("claims that hold", str(count["holds"]), f"of {len(book.claims)}"),
                    ("hold in part", str(count["holds in part"]), ""),
                    ("do not hold", str(count["does not hold"]), ""),
                    ("figures and tables", str(len(book.entries) + 2), f"{len(compared)} numbers side by side"),
                )
            ),
            *(speed_table(book, number) for number in (2, 3)),
        ),
    )


def speed_table(book: ThesisBook, table: int) -> Table:
    """Table 2 or 3.

    Parameters
    ----------
    book : ThesisBook
        Of `thesis_book`.
    table : int
        2 or 3.

    Returns
    -------
    table : Table
        A row for each number. [m/s]
    """
    names = dict(COLUMNS)
    cells = [cell for cell in book.cells if cell.table == table]
    where = "sea level" if table == 2 else "10,000 ft"
    return Table(
        title=f"Table {table}: {where}, true airspeeds in m/s",
        columns=("model", "speed", "thesis", "ours", "diff.", "sounder", "the sounder method; note"),
        rows=tuple(
            (
                names[c.column],
                c.quantity,
                c.thesis,
                _speed(c.ours),
                _speed(c.difference, sign=True),
                _speed(c.sound),
                f"{c.method}; {c.reason}",
            )
            for c in cells
        ),
        caption="Divergence and reversal of the analytic columns are those of a wing held to a linear twist.",
    )


def _speed(value: float | str | None, *, sign: bool = False) -> str | None:
    """A speed with two decimals."""
    if value is None or isinstance(value, str):
        return value
    return f"{value:+.2f}" if sign else f"{value:.2f}"


def _claims(book: ThesisBook) -> Part:
    return Part(
        title="Claims of the thesis, judged",
        anchor="thesis-claims",
        blocks=(
            Table(
                title="Claims",
                columns=("section", "claim", "verdict", "numbers"),
                rows=tuple((c.section, c.statement, c.verdict, c.numbers) for c in book.claims),
                caption="Each verdict follows from the numbers beside it; they are computed with every run.",
            ),
        ),
    )


def _misprints(book: ThesisBook) -> Part:
    return Part(
        title="Misprints put right",
        anchor="thesis-misprints",
        blocks=(
            Table(
                title="Misprints",
                columns=("where", "printed", "right", "what it changes"),
                rows=tuple((m.where, m.printed, m.right, m.effect) for m in book.misprints),
            ),
        ),
    )


def entry_part(entry: Entry, *, pictures: bool = True) -> Part:
    """A figure or table of the thesis.

    Parameters
    ----------
    entry : Entry
        Of the re-run.
    pictures : bool
        Whether a damping surface is drawn.

    Returns
    -------
    part : Part
        What the thesis shows, what comes out, numbers side by side, curves.
    """
    blocks: list[Block] = [Prose(text=f"The thesis: {entry.thesis}", kind="note"), Prose(text=entry.finding)]
    if entry.unsound:
        blocks.append(Prose(text=entry.unsound, kind="warning"))
    if entry.compared:
        blocks.append(compared_table(entry))
    blocks += [chart(plot) for plot in entry.plots]
    if entry.surface is not None and pictures:
        figure = surface_figure(entry.surface, f"{entry.number}: {entry.title}")
        caption = "Damping ratio of the least damped mode; the line is flutter."
        blocks.append(Picture(png=as_bytes(figure, ".png"), alternative=entry.title, caption=caption))
    return Part(title=f"{entry.number}: {entry.title}", anchor=anchor(entry), blocks=tuple(blocks))


def anchor(entry: Entry) -> str:
    """Where a figure stands in a page.

    Parameters
    ----------
    entry : Entry
        Of the re-run.

    Returns
    -------
    anchor : str
        "thesis-fig-21".
    """
    return "thesis-" + "-".join(re.findall(r"[a-z0-9]+", entry.number.lower()))


def compared_table(entry: Entry) -> Table:
    """The numbers of an entry, side by side.

    Parameters
    ----------
    entry : Entry
        Of the re-run.

    Returns
    -------
    table : Table
        Thesis, ours, difference, reason.
    """
    return Table(
        title=f"{entry.number}: thesis and ours",
        columns=("quantity", "unit", "thesis", "ours", "difference", "why"),
        rows=tuple((c.what, c.unit, c.thesis, c.ours, c.difference, c.reason) for c in entry.compared),
    )


def chart(plot: Plot) -> Chart:
    """A plot of the re-run as a chart.

    Parameters
    ----------
    plot : Plot
        Curves.

    Returns
    -------
    chart : Chart
        For a page.
    """
    return Chart(
        title=plot.title,
        x_label=plot.x_label,
        y_label=plot.y_label,
        series=tuple(Series(name=c.name, x=c.x, y=c.y, kind="points" if c.points else "line") for c in plot.curves),
        marks=tuple(
            Mark(at=at, text=text, kind=next((kind for kind in MARKS if kind in text), "limit"))
            for at, text in plot.marks
            if at == at
        ),
        x_range=plot.x_range,
        y_range=plot.y_range,
        equal=plot.equal,
        hover="point" if plot.equal or any(c.points for c in plot.curves) else "x",
    )
