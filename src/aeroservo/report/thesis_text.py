"""The re-run of the thesis in words: Tables 2 and 3 for a terminal, the page of the documentation in Markdown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from aeroservo.studies.thesis_records import Entry, number
from aeroservo.studies.thesis_study import COLUMNS, Cell, ThesisBook

if TYPE_CHECKING:
    from rich.console import Console

SHORT = {
    "binary_quasi": "binary quasi",
    "binary_unsteady": "binary unsteady",
    "aircraft_quasi": "aircraft quasi",
    "aircraft_unsteady": "aircraft unsteady",
    "simulation_lqr": "simulated LQR",
    "simulation_adaptive": "simulated switch",
}
WHERE = {2: "sea level", 3: "10,000 ft (3048 m)"}
PICTURES = ("Fig. 4", "Fig. 21", "Fig. 26", "Fig. 29", "Fig. 30", "Fig. 37", "Fig. 39", "Fig. 40")
"""Figures shown in the documentation; all are in the report."""


def print_tables(book: ThesisBook, console: Console) -> None:
    """Print Tables 2 and 3 and how many claims hold; lines fit 80 columns.

    Parameters
    ----------
    book : ThesisBook
        Of `thesis_book`.
    console : rich Console
        Printed to.
    """
    from rich import box
    from rich.table import Table
    from rich.text import Text

    for table in (2, 3):
        drawn = Table(
            title=Text(f"Table {table}: {WHERE[table]}, true airspeeds in m/s", style="bold"), title_justify="left",
            box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0),
        )  # fmt: skip
        drawn.show_edge = drawn.pad_edge = False
        for name in ("model", "speed", "thesis", "ours", "diff", "sounder method"):
            drawn.add_column(name, justify="right" if name in ("thesis", "diff") else "left")
        previous = ""
        for cell in (c for c in book.cells if c.table == table):
            if previous and cell.column != previous:
                drawn.add_section()
            previous = cell.column
            drawn.add_row(*(Text(text) for text in _terminal_row(cell)))
        with console.capture() as captured:
            console.print(drawn)
        console.file.write("\n" + "\n".join(line.rstrip() for line in captured.get().splitlines()) + "\n")
    count = Counter(claim.verdict for claim in book.claims)
    console.file.write(
        f"\n{len(book.claims)} claims of the thesis: {count['holds']} hold, {count['holds in part']} hold in part, "
        f"{count['does not hold']} do not\n"
    )
    console.file.flush()


def _terminal_row(cell: Cell) -> tuple[str, ...]:
    """Model, speed, thesis, ours, difference, sounder."""
    ours = cell.ours if isinstance(cell.ours, str) else _two(cell.ours)
    if isinstance(cell.ours, str) and cell.ours.startswith("printed at"):
        ours = "k not named"
    return (SHORT[cell.column], cell.quantity, cell.thesis, ours, _two(cell.difference, sign=True), _two(cell.sound))


def _two(value: Any, *, sign: bool = False) -> str:
    """A speed with two decimals, a dash where there is none."""
    if value is None:
        return "-"
    if isinstance(value, str):
        return value
    return f"{value:+.2f}" if sign else f"{value:.2f}"


def markdown(book: ThesisBook, *, folder: str = "img/thesis") -> str:
    """The page docs/thesis.md.

    Parameters
    ----------
    book : ThesisBook
        Of `thesis_book`.
    folder : str
        Where the pictures of `PICTURES` lie, seen from the page.

    Returns
    -------
    text : str
        Markdown; the same run gives the same text.
    """
    count = Counter(claim.verdict for claim in book.claims)
    lines = [
        "# The thesis, computed again",
        "",
        "<!-- Made by `aeroservo study thesis --markdown docs/thesis.md`; do not edit. -->",
        "",
        "N. B. Bramstång, *Analysis of a Flutter Suppression System for an Efficiently Designed UAV*, Luleå 2015: its",
        "chapters 8 and 9, from the preset files alone. `aeroservo study thesis -o thesis.html` writes this page "
        "with all",
        "curves, each downloadable, in under two minutes.",
        "",
        "The thesis does not print the inputs of its models; they were inferred from Tables 1 to 3, and notes say "
        "which",
        "numbers agree by construction. Nothing is adjusted to meet a printed number. The sounder method stands "
        "beside.",
        "",
        f"Of {len(book.claims)} claims, **{count['holds']} hold, {count['holds in part']} hold in part, "
        f"{count['does not hold']} do not hold.**",
    ]  # fmt: skip
    names = dict(COLUMNS)
    for table in (2, 3):
        cells = [c for c in book.cells if c.table == table]
        lines += ["", f"## Table {table}: {WHERE[table]}", "", "True airspeeds in m/s.", ""]
        lines += _rows(
            ("model", "speed", "thesis", "ours, its method", "difference", "sounder", "by", "note"),
            [
                (
                    names[c.column], c.quantity, c.thesis, _two(c.ours), _two(c.difference, sign=True), _two(c.sound),
                    c.method, c.reason,
                )
                for c in cells
            ],
        )  # fmt: skip
    lines += ["", "## Claims, judged", "", "Each verdict follows from the numbers beside it.", ""]
    lines += _rows(
        ("section", "claim", "verdict", "numbers"),
        [(c.section, c.statement, f"**{c.verdict}**", c.numbers) for c in book.claims],
    )
    lines += ["", "## Misprints put right", ""]
    lines += _rows(
        ("where", "printed", "right", "what it changes"),
        [(m.where, m.printed, m.right, m.effect) for m in book.misprints],
    )
    lines += ["", "## Figures and tables", ""]
    for entry in book.entries:
        lines += _entry(entry, folder)
    return "\n".join(lines).rstrip() + "\n"


def _entry(entry: Entry, folder: str) -> list[str]:
    """One figure."""
    lines = [
        f"### {entry.number}: {entry.title}",
        "",
        f"*The thesis:* {_safe(entry.thesis)}",
        "",
        _safe(entry.finding),
        "",
    ]
    if entry.unsound:
        lines += [f"**To know:** {_safe(entry.unsound)}", ""]
    if entry.compared:
        lines += _rows(
            ("quantity", "unit", "thesis", "ours", "difference", "why"),
            [
                (
                    c.what, c.unit, number(c.thesis, 5) if c.thesis is not None else "-", number(c.ours, 5),
                    "-" if c.difference is None else f"{c.difference:+.4g}", c.reason,
                )
                for c in entry.compared
            ],
        )  # fmt: skip
        lines.append("")
    if entry.number in PICTURES:
        lines += [f"![{entry.number}]({folder}/{picture_name(entry)})", ""]
    return lines


def picture_name(entry: Entry) -> str:
    """File name of an entry's picture.

    Parameters
    ----------
    entry : Entry
        Of the re-run.

    Returns
    -------
    name : str
        "fig-21.png".
    """
    return entry.number.lower().replace(". ", "-").replace(" ", "-") + ".png"


def _rows(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """A table of Markdown."""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return lines + ["| " + " | ".join(_safe(str(cell)).replace("|", "\\|") for cell in row) + " |" for row in rows]


def _safe(text: str) -> str:
    """Text that Markdown takes literally; asterisks are ours, for bold."""
    return text.replace("_", "\\_").replace("<", "&lt;").replace("±", "&plusmn;")
