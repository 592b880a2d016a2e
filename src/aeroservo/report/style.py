"""How every figure looks: colours that colour-blind readers can tell apart, one legend below the panels, files whole.

Figures are made without a screen (no pyplot, the Agg canvas), so they work on a server and in any thread.
"""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.aircraft.files import write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from aeroservo.aeroelastic.flutter import FlutterResult

#: Okabe and Ito's colours without yellow (too pale) and without the vermilion kept for instability.
COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#000000")
#: Beside colour, so that prints in black and white can be read.
LINES = ("-", "--", "-.", (0, (1, 1)), (0, (5, 1, 1, 1, 1, 1)))
UNSTABLE = "#D55E00"
MARK = "0.25"
RESOLUTION = 150.0
"""Of PNG files. [1/inch]"""

MACH_LIMIT = 0.3
"""Above this Mach number incompressible theory is drawn as beyond its limit."""


def style(j: int) -> dict[str, Any]:
    """Colour and dashes of curve number j; no two of the first thirty are the same.

    Parameters
    ----------
    j : int
        Number of the curve.

    Returns
    -------
    style : dict
        Keywords of `Axes.plot`.
    """
    return {"color": COLOURS[j % len(COLOURS)], "linestyle": LINES[j % len(LINES)], "linewidth": 1.6}


def new_figure(title: str, rows: int, columns: int, *, width: float = 4.4, height: float = 3.6) -> Figure:
    """A figure with panels and a grid, not bound to any screen.

    Parameters
    ----------
    title : str
        Above the figure, taken literally.
    rows, columns : int
        Panels.
    width, height : float
        Of one panel. [inch]

    Returns
    -------
    figure : matplotlib Figure
        Its `axes` in reading order.
    """
    from matplotlib.figure import Figure as NewFigure

    figure = NewFigure(figsize=(width * columns, height * rows + 0.9))
    figure.set_layout_engine("constrained", wspace=0.05, hspace=0.05)
    figure.subplots(rows, columns)
    if title:
        figure.suptitle(literal(title), fontsize="medium")
    for ax in figure.axes:
        ax.grid(visible=True, linewidth=0.3)
    return figure


def literal(name: str) -> str:
    """Text that matplotlib takes literally.

    Parameters
    ----------
    name : str
        Any.

    Returns
    -------
    text : str
        Without markup.
    """
    return name.replace("$", r"\$")


def shared_legend(figure: Figure, *, columns: int | None = None) -> None:
    """One legend below all panels, each entry once: it can cover no curve.

    Parameters
    ----------
    figure : matplotlib Figure
        With labelled curves.
    columns : int, optional
        Entries side by side; default as many as fit.
    """
    entries: dict[str, Any] = {}
    for ax in figure.axes:
        for handle, label in zip(*ax.get_legend_handles_labels()):
            entries.setdefault(label, handle)
    if not entries:
        return
    longest = max(len(label) for label in entries)
    fits = max(1, int(figure.get_figwidth() / (0.075 * longest + 0.75)))
    figure.legend(
        list(entries.values()),
        list(entries),
        loc="outside lower center",
        ncols=columns or min(fits, len(entries)),
        fontsize="small",
        frameon=False,
    )


def speed_axis(ax: Axes, V: Any) -> None:
    """The speeds of a sweep, and no others, along the bottom.

    Parameters
    ----------
    ax : matplotlib Axes
        Drawn into.
    V : ndarray, shape (n_V,)
        Speeds. [m/s]
    """
    if len(V) > 1:
        ax.set_xlim(float(V[0]), float(V[-1]))
    ax.set_xlabel("true airspeed V, m/s")


def mark_speeds(ax: Axes, V: Any, speeds: Sequence[tuple[str, float | None]]) -> None:
    """Upright lines at named speeds inside the range, their values in the legend.

    Parameters
    ----------
    ax : matplotlib Axes
        Drawn into.
    V : ndarray, shape (n_V,)
        Speeds of the sweep. [m/s]
    speeds : sequence of (str, float or None)
        Names and speeds. [m/s]
    """
    lines = {"flutter": (0, (6, 2)), "divergence": (0, (3, 1, 1, 1)), "reversal": (0, (1, 1.5))}
    for name, speed in speeds:
        if speed is not None and V[0] <= speed <= V[-1]:
            colour = UNSTABLE if name == "flutter" else MARK
            dashes = next((dash for word, dash in lines.items() if name.startswith(word)), "-")
            ax.axvline(speed, color=colour, linestyle=dashes, linewidth=1.3, label=f"{literal(name)} {speed:.2f} m/s")


def shade_unstable(ax: Axes, result: FlutterResult) -> None:
    """Shade the speeds at which a root is unstable: plain for flutter, hatched for divergence.

    Parameters
    ----------
    ax : matplotlib Axes
        Drawn into.
    result : FlutterResult
        Of `aeroservo.flutter`.
    """
    looks: dict[str, dict[str, Any]] = {
        "flutter": {"facecolor": UNSTABLE, "alpha": 0.13, "label": "unstable oscillation"},
        "divergence": {"facecolor": "none", "edgecolor": "0.7", "hatch": "////", "label": "unstable real root"},
    }
    for kind, look in looks.items():
        for start, end in _joined(result, kind):
            ax.axvspan(start, end, linewidth=0.0, zorder=0, **look)


def _joined(result: FlutterResult, kind: str) -> list[tuple[float, float]]:
    """Unstable ranges of one kind; where several roots are unstable at once, one range."""
    first, last = float(result.V[0]), float(result.V[-1])
    ranges: list[tuple[float, float]] = []
    for i in sorted((i for i in result.intervals if i.kind == kind), key=lambda i: i.start or first):
        start, end = first if i.start is None else i.start, last if i.end is None else i.end
        if ranges and start <= ranges[-1][1]:
            ranges[-1] = (ranges[-1][0], max(end, ranges[-1][1]))
        else:
            ranges.append((start, end))
    return ranges


def mark_mach_limit(ax: Axes, V: Any, a_sound: float | None) -> None:
    """Dashed line at Mach 0.3, the limit of incompressible theory, where it lies in the range.

    Parameters
    ----------
    ax : matplotlib Axes
        Drawn into.
    V : ndarray, shape (n_V,)
        Speeds of the sweep. [m/s]
    a_sound : float, optional
        Speed of sound; None draws nothing. [m/s]
    """
    if a_sound is not None and V[0] < MACH_LIMIT * a_sound < V[-1]:
        ax.axvline(
            MACH_LIMIT * a_sound, color="0.55", linestyle=(0, (4, 4)), linewidth=1.3,
            label="Mach 0.3: beyond it incompressible theory errs",
        )  # fmt: skip


def nothing_to_show(ax: Axes, text: str) -> None:
    """Say inside an empty panel why it is empty.

    Parameters
    ----------
    ax : matplotlib Axes
        Drawn into.
    text : str
        Why.
    """
    ax.text(0.5, 0.5, literal(text), ha="center", va="center", transform=ax.transAxes, color="0.35")
    ax.set_yticks([])


def finite(values: Any) -> bool:
    """Whether there is any number to draw.

    Parameters
    ----------
    values : array_like, shape (...)
        Numbers, nan where there are none. [any]

    Returns
    -------
    finite : bool
        At least one is finite.
    """
    return bool(np.any(np.isfinite(np.asarray(values))))


def as_bytes(figure: Figure, ending: str) -> bytes:
    """A figure as the content of a file; the same figure gives the same bytes.

    Parameters
    ----------
    figure : matplotlib Figure
        Any.
    ending : str
        ".png" or ".pdf".

    Returns
    -------
    content : bytes
        To be written whole.

    Raises
    ------
    ValueError
        For another ending.
    """
    kind = ending.lower().lstrip(".")
    if kind not in ("png", "pdf"):
        raise ValueError(f"figures end in .png or .pdf, got {ending!r}")
    file, dpi = BytesIO(), figure.dpi
    try:  # the canvases themselves: Figure.savefig draws everything twice
        if kind == "png":
            from matplotlib.backends.backend_agg import FigureCanvasAgg

            figure.dpi = RESOLUTION
            FigureCanvasAgg(figure).print_png(file, metadata={"Software": None})
        else:
            from matplotlib.backends.backend_pdf import FigureCanvasPdf

            FigureCanvasPdf(figure).print_pdf(file, metadata={"CreationDate": None})
    finally:
        figure.dpi = dpi
    return file.getvalue()


def write_figure(figure: Figure, path: str | Path) -> None:
    """Write a figure, whole or not at all.

    Parameters
    ----------
    figure : matplotlib Figure
        Any.
    path : str or Path
        Ends in .png or .pdf.

    Raises
    ------
    ValueError
        For another ending.
    OSError
        If it cannot be written.
    """
    path = Path(path)
    write_whole(path, as_bytes(figure, path.suffix))
