"""Blocks as HTML: every text escaped; what scripts need goes into one JSON object beside them."""

from __future__ import annotations

import base64
import math
import re
from html import escape
from typing import Any

from aeroservo.report.blocks import (
    Block,
    Chart,
    Facts,
    Failed,
    LivePanel,
    Part,
    Picture,
    Prose,
    Scene,
    Table,
)
from aeroservo.report.svg_chart import chart_svg, legend_entries

#: Rows that a table shows; all are in its CSV.
MOST_ROWS = 60
#: Columns of a table that fit half a page; longer texts than this need the whole width as well.
MOST_COLUMNS, LONG_TEXT = 5, 60
#: Characters of a text that a cell keeps on one line.
SHORT = 24


class PageBuilder:
    """Turns parts into HTML and gathers the data of their charts, scenes and panels.

    Attributes
    ----------
    data : dict
        "charts", "tables", "scenes", "live": what the scripts read.
    """

    def __init__(self) -> None:
        self.data: dict[str, list[Any]] = {"charts": [], "tables": [], "scenes": [], "live": []}

    def part(self, part: Part) -> str:
        """A section of the page, escaped."""
        blocks = "".join(self.block(block) for block in part.blocks)
        return (
            f'<section id="{part.anchor}" aria-labelledby="h-{part.anchor}">'
            f'<h2 id="h-{part.anchor}">{escape(part.title)}</h2><div class="blocks">{blocks}</div></section>'
        )

    def block(self, block: Block) -> str:
        """One block, escaped."""
        if isinstance(block, Prose):
            paragraphs = "".join(f"<p>{inline(p.strip())}</p>" for p in re.split(r"\n\s*\n", block.text) if p.strip())
            return f'<div class="prose {block.kind}">{paragraphs}</div>'
        if isinstance(block, Facts):
            return _facts(block)
        if isinstance(block, Table):
            return self._table(block)
        if isinstance(block, Chart):
            return self._chart(block)
        if isinstance(block, Picture):
            image = base64.b64encode(block.png).decode()
            return (
                f'<figure class="picture"><img alt="{escape(block.alternative)}" src="data:image/png;base64,{image}">'
                f"<figcaption>{inline(block.caption)}</figcaption></figure>"
            )
        if isinstance(block, Scene | LivePanel):
            return self._moving(block)
        return _failed(block)

    def _chart(self, chart: Chart) -> str:
        number = len(self.data["charts"])
        self.data["charts"].append(
            {
                "file": file_name(chart.title),
                "x": chart.x_label,
                "y": chart.y_label,
                "series": [
                    {"name": s.name, "x": s.x, "y": s.y}
                    | ({} if s.along is None else {"along": s.along, "along_label": s.along_label})
                    for s in chart.series
                ],
            }
        )
        entries = "".join(
            f"<li>{sample}{escape(text)}</li>"
            if k is None
            else f'<li><button type="button" data-k="{k}" aria-pressed="true">{sample}{escape(text)}</button></li>'
            for sample, text, k in legend_entries(chart)
        )
        return (
            f'<figure class="chart-box" data-chart="{number}"><h3>{escape(chart.title)}</h3>{chart_svg(chart, number)}'
            f'<ul class="legend">{entries}</ul><figcaption>{inline(chart.caption)}</figcaption>'
            '<p class="tools"><button type="button" class="csv">CSV</button>'
            '<button type="button" class="enlarge" aria-pressed="false">Larger</button></p></figure>'
        )

    def _table(self, table: Table) -> str:
        number = len(self.data["tables"])
        rows = [[_exact(value) for value in row] for row in table.rows]
        self.data["tables"].append({"file": file_name(table.title or "table"), "columns": table.columns, "rows": rows})
        right = [all(_is_number(row[j]) for row in table.rows) for j in range(len(table.columns))]
        head = "".join(
            f'<th scope="col"{" class=number" if r else ""}>{escape(name)}</th>'
            for name, r in zip(table.columns, right)
        )
        body = "".join("<tr>" + "".join(_cell(value) for value in row) + "</tr>" for row in table.rows[:MOST_ROWS])
        more = len(table.rows) - MOST_ROWS
        note = f"<p>… and {more} more rows in the CSV.</p>" if more > 0 else ""
        title = f"<h3>{escape(table.title)}</h3>" if table.title else ""
        wide = " wide" if len(table.columns) > MOST_COLUMNS or _wordy(table) else ""
        return (
            f'<figure class="table-box{wide}" data-table="{number}">{title}<div class="scroll" tabindex="0"><table>'
            f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>{note}<figcaption>{inline(table.caption)}"
            '</figcaption><p class="tools"><button type="button" class="csv">CSV</button></p></figure>'
        )

    def _moving(self, block: Scene | LivePanel) -> str:
        kind = "scenes" if isinstance(block, Scene) else "live"
        number = len(self.data[kind])
        self.data[kind].append(block.data)
        return (
            f'<figure class="moving {kind}" data-{kind}="{number}"><h3>{escape(block.title)}</h3>'
            f'<div class="stage"></div><figcaption>{inline(block.caption)}</figcaption></figure>'
        )


def inline(text: str) -> str:
    """Escaped text in which `words between backticks` stand as code.

    Parameters
    ----------
    text : str
        Of any origin.

    Returns
    -------
    html : str
        Nothing but text and code elements.
    """
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(text))


def _wordy(table: Table) -> bool:
    """Whether a table has a text that half a page would break into many lines."""
    return any(isinstance(cell, str) and len(cell) > LONG_TEXT for row in table.rows for cell in row)


def file_name(title: str) -> str:
    """A file name of small letters, digits and hyphens.

    Parameters
    ----------
    title : str
        Any text, of any origin.

    Returns
    -------
    name : str
        Without an ending; never empty, no path in it.
    """
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")[:60] or "data"


def shown(value: Any) -> str:
    """A cell as text: numbers with five digits and a true minus sign.

    Parameters
    ----------
    value : any
        Text, number or None. [any]

    Returns
    -------
    text : str
        Not yet escaped.
    """
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value + 0.0:.5g}".replace("e+0", "e").replace("e-0", "e-").replace("-", "−")
    return str(value)


def _is_number(value: Any) -> bool:
    return value is None or (isinstance(value, int | float) and not isinstance(value, bool))


def _cell(value: Any) -> str:
    text = shown(value)
    look = " class=number" if _is_number(value) else " class=short" if len(text) <= SHORT else ""
    return f"<td{look}>{escape(text)}</td>"


def _exact(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _facts(block: Facts) -> str:
    items = "".join(
        f"<div><dt>{escape(name)}</dt><dd><strong>{escape(value)}</strong><span>{escape(remark)}</span></dd></div>"
        for name, value, remark in block.items
    )
    return f'<dl class="facts">{items}</dl>'


def _failed(block: Failed) -> str:
    return f'<div class="failed" role="note"><strong>Not computed.</strong> {escape(block.why)}</div>'
