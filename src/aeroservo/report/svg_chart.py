"""A chart as SVG: readable without a script, in print, in dark and in light; a script adds pointing and switching.

Colours and dashes are classes of the style sheet (`assets/page.css`), the same palette as the other figures
(`report/style.py`), so that one drawing serves a dark screen and white paper.
"""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.report.blocks import Band, Chart, Mark, Series
from aeroservo.report.svg_axes import BOTTOM, HEIGHT, LEFT, RIGHT, TOP, WIDTH, Axis, axes_of

Array = NDArray[Any]

#: Classes of colour and of dashes in the style sheet; no two of the first thirty curves are the same.
COLOURS, DASHES = 6, 5
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
#: Points closer than this are one. [px]
NEAR = 0.35


def chart_svg(chart: Chart, number: int) -> str:
    """A chart as an SVG element.

    Parameters
    ----------
    chart : Chart
        Any; all text in it is escaped.
    number : int
        Of the chart in its page: makes identifiers differ.

    Returns
    -------
    svg : str
        One element, its axes and curves as classes of `assets/page.css`.
    """
    x, y = axes_of(chart)
    clip = f"clip-{number}"
    box = f'x="{LEFT:g}" y="{TOP:g}" width="{WIDTH - LEFT - RIGHT:g}" height="{HEIGHT - TOP - BOTTOM:g}"'
    pieces = [
        f'<svg class="chart" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" tabindex="0" '
        f'aria-label="{escape(chart.title)}. {escape(chart.x_label)} to the right, {escape(chart.y_label)} up." '
        f'data-x="{_axis_data(x)}" data-y="{_axis_data(y)}" data-hover="{chart.hover}">',
        f'<defs><clipPath id="{clip}"><rect {box}/></clipPath>'
        f'<pattern id="hatch-{number}" width="7" height="7" patternUnits="userSpaceOnUse" '
        'patternTransform="rotate(45)"><line class="hatch" x1="0" y1="0" x2="0" y2="7"/></pattern></defs>',
        *(_band(band, x, number) for band in chart.bands),
        *_grid(x, y),
        f'<g clip-path="url(#{clip})">',
        *(_mark(mark, x, y) for mark in chart.marks),
        *(_series(series, k, x, y) for k, series in enumerate(chart.series)),
        "</g>",
        f'<rect class="frame" {box}/>',
        f'<text class="label" x="{0.5 * (LEFT + WIDTH - RIGHT):g}" y="{HEIGHT - 8:g}" text-anchor="middle">'
        f"{escape(chart.x_label)}</text>",
        f'<text class="label" transform="translate(14 {0.5 * (TOP + HEIGHT - BOTTOM):g}) rotate(-90)" '
        f'text-anchor="middle">{escape(chart.y_label)}</text>',
    ]
    if not any(np.any(np.isfinite(s.y)) for s in chart.series):
        pieces.append(f'<text class="label" x="{0.5 * WIDTH:g}" y="{0.4 * HEIGHT:g}">nothing to draw</text>')
    return "".join([*pieces, '<g class="cursor"></g></svg>'])


def legend_entries(chart: Chart) -> list[tuple[str, str, int | None]]:
    """What the legend of a chart lists, each look once.

    Parameters
    ----------
    chart : Chart
        Any.

    Returns
    -------
    entries : list of (str, str, int or None)
        A small SVG of the look, the text (not yet escaped), and the number of the series that it switches.
    """
    entries: list[tuple[str, str, int | None]] = []
    x, y = axes_of(chart)
    for k, series in enumerate(chart.series):
        if not series.name:
            continue
        look = _look(series, k)
        sample = (
            f'<circle class="{look} dot" cx="13" cy="6" r="3.5"/>'
            if series.kind == "points"
            else f'<path class="{look} curve" d="M1 6H25"/>'
        )
        entries.append((f'<svg class="sample" viewBox="0 0 26 12">{sample}</svg>', series.name, k))
    for mark in chart.marks:
        axis = x if mark.axis == "x" else y
        if mark.text and axis.low <= mark.at <= axis.high:
            line = f'<path class="mark m-{mark.kind}" d="M1 6H25"/>'
            entries.append((f'<svg class="sample" viewBox="0 0 26 12">{line}</svg>', mark.text, None))
    for kind, text in dict.fromkeys(
        (b.kind, b.text) for b in chart.bands if b.text and b.end > x.low and b.start < x.high
    ):
        box = f'<rect class="band b-{kind}" x="1" y="1" width="24" height="10"/>'
        if kind == "divergence":
            box += '<path class="hatch" d="M3 11L11 1M9 11L17 1M15 11L23 1"/>'
        entries.append((f'<svg class="sample" viewBox="0 0 26 12">{box}</svg>', text, None))
    return entries


def _axis_data(axis: Axis) -> str:
    """What the script needs to go from places to values."""
    return f"{axis.low!r},{axis.high!r},{axis.start:g},{axis.end:g},{int(axis.log)}"


def _look(series: Series, k: int) -> str:
    number = k if series.colour is None else series.colour
    return f"c{number % COLOURS} d{number % DASHES}"


def _grid(x: Axis, y: Axis) -> list[str]:
    """Grid lines and the numbers beside them."""
    pieces = []
    for value, place in zip(x.ticks(), x.place(np.array(x.ticks()))):
        pieces.append(f'<path class="grid" d="M{place:.1f} {TOP:g}V{HEIGHT - BOTTOM:g}"/>')
        below = HEIGHT - BOTTOM + 16
        text = _tick(value, x.log)
        pieces.append(f'<text class="tick" x="{place:.1f}" y="{below:g}" text-anchor="middle">{text}</text>')
    for value, place in zip(y.ticks(), y.place(np.array(y.ticks()))):
        zero = " zero" if value == 0.0 and not y.log else ""
        pieces.append(f'<path class="grid{zero}" d="M{LEFT:g} {place:.1f}H{WIDTH - RIGHT:g}"/>')
        pieces.append(
            f'<text class="tick" x="{LEFT - 6:g}" y="{place + 4:.1f}" text-anchor="end">{_tick(value, y.log)}</text>'
        )
    if not x.log and x.low < 0.0 < x.high:
        place = float(x.place(np.array(0.0)))
        pieces.append(f'<path class="grid zero" d="M{place:.1f} {TOP:g}V{HEIGHT - BOTTOM:g}"/>')
    return pieces


def _tick(value: float, log: bool = False) -> str:
    """A tick's number, with a true minus sign; a power of ten where the axis is logarithmic."""
    if log and value > 0.0 and not 1e-2 <= value < 1e4:
        power = round(np.log10(value))
        if abs(value / 10.0**power - 1.0) < 1e-9:
            return "10" + str(power).translate(RAISED)
    size = abs(value)
    text = f"{value:.6g}" if size == 0.0 or 1e-3 <= size < 1e5 else f"{value:.3g}"
    return text.replace("e+0", "e").replace("e-0", "e-").replace("-", "−")


def _band(band: Band, x: Axis, number: int) -> str:
    """A shaded range."""
    left, right = np.sort(np.clip(x.place(np.array([band.start, band.end])), LEFT, WIDTH - RIGHT))
    if not right > left:
        return ""
    box = f'x="{left:.1f}" y="{TOP:g}" width="{right - left:.1f}" height="{HEIGHT - TOP - BOTTOM:g}"'
    hatch = f'<rect {box} fill="url(#hatch-{number})"/>' if band.kind == "divergence" else ""
    return f'<rect class="band b-{band.kind}" {box}/>{hatch}'


def _mark(mark: Mark, x: Axis, y: Axis) -> str:
    """A line through the chart."""
    place = float((x if mark.axis == "x" else y).place(np.array(mark.at)))
    if not np.isfinite(place):
        return ""
    d = f"M{place:.1f} {TOP:g}V{HEIGHT - BOTTOM:g}" if mark.axis == "x" else f"M{LEFT:g} {place:.1f}H{WIDTH - RIGHT:g}"
    return f'<path class="mark m-{mark.kind}" d="{d}"/>'


def _series(series: Series, k: int, x: Axis, y: Axis) -> str:
    """A curve, or its points."""
    px, py = x.place(series.x), y.place(series.y)
    far = 4.0 * HEIGHT
    py = np.clip(py, -far, HEIGHT + far)  # far outside the paper: some viewers overflow
    look = _look(series, k)
    if series.kind == "points":
        good = np.isfinite(px) & np.isfinite(py)
        dots = "".join(f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3"/>' for a, b in zip(px[good], py[good]))
        return f'<g class="series dot {look}" data-k="{k}">{dots}</g>'
    if series.kind == "steps" and len(px) > 1:
        px, py = np.repeat(px, 2)[1:], np.repeat(py, 2)[:-1]
    return f'<path class="series curve {look}" data-k="{k}" d="{_path(px, py)}"/>'


def _path(px: Array, py: Array) -> str:
    """Path through places; nan breaks it, points that fall together are one, a point alone is a dot."""
    runs: list[list[tuple[float, float]]] = [[]]
    held: tuple[float, float] | None = None
    for a, b in zip(px.tolist(), py.tolist()):
        run = runs[-1]
        if a != a or b != b:
            if held is not None:
                run.append(held)
            held = None
            runs.append([])
        elif run and abs(a - run[-1][0]) < NEAR and abs(b - run[-1][1]) < NEAR:
            held = (a, b)
        else:
            run.append((a, b))
            held = None
    if held is not None:
        runs[-1].append(held)
    pieces = [[f"{a:.1f} {b:.1f}" for a, b in run] for run in runs if run]
    return " ".join(f"M{one[0]}" + (f"L{' '.join(one[1:])}" if len(one) > 1 else "h0") for one in pieces)
