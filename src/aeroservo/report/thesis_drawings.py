"""Figures of the re-run of the thesis for papers: one matplotlib figure for each of its figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.report.style import MARK, UNSTABLE, literal, new_figure, nothing_to_show, shared_legend, style
from aeroservo.report.surfaces import surface_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from aeroservo.studies.thesis_records import Entry, Plot

MOST_COLUMNS = 3


def entry_figure(entry: Entry) -> Figure | None:
    """All plots of an entry in one figure.

    Parameters
    ----------
    entry : Entry
        Of the re-run.

    Returns
    -------
    figure : matplotlib Figure or None
        The damping surface where there is one, else a panel for each plot; None where there is nothing to draw.
    """
    title = f"{entry.number}: {entry.title}"
    if entry.surface is not None:
        return surface_figure(entry.surface, title)
    if not entry.plots:
        return None
    columns = 2 if len(entry.plots) == 4 else min(len(entry.plots), MOST_COLUMNS)
    rows = -(-len(entry.plots) // columns)
    figure = new_figure(title, rows, columns, width=4.6, height=3.1)
    axes: Any = figure.axes
    for ax, plot in zip(axes, entry.plots):
        _panel(ax, plot)
    for ax in axes[len(entry.plots) :]:
        ax.axis("off")
    shared_legend(figure)
    return figure


def _panel(ax: Any, plot: Plot) -> None:
    """One plot."""
    for j, curve in enumerate(plot.curves):
        look = style(j)
        if curve.points:
            look = {"color": look["color"], "linestyle": "none", "marker": "xosv^D"[j % 6], "fillstyle": "none"}
        ax.plot(curve.x, curve.y, label=literal(curve.name), **look)
    if not any(np.isfinite(curve.y).any() for curve in plot.curves):
        nothing_to_show(ax, "nothing in this range")
    for at, text in plot.marks:
        if np.isfinite(at):
            colour = UNSTABLE if "flutter" in text else MARK
            ax.axvline(at, color=colour, linestyle=(0, (5, 2)), linewidth=1.1, label=literal(text))
    ax.set_title(literal(plot.title), fontsize="small")
    ax.set_xlabel(literal(plot.x_label))
    ax.set_ylabel(literal(plot.y_label))
    if plot.x_range is not None:
        ax.set_xlim(*plot.x_range)
    if plot.y_range is not None:
        ax.set_ylim(*plot.y_range)
    if plot.equal:
        ax.set_aspect("equal", adjustable="datalim")
