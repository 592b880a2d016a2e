"""Figure of an envelope: altitude against speed with and without control, margins and gusts beside it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.report.style import MARK, UNSTABLE, nothing_to_show, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from aeroservo.aeroelastic.branches import Interval
    from aeroservo.studies.envelope import EnvelopePoint

#: Curves of margins and gusts, at most.
CURVES = 4

_ALONE: dict[str, Any] = {"facecolor": "none", "edgecolor": "0.72", "hatch": "////", "linewidth": 0.0, "zorder": 0}
_ALONE["label"] = "unstable without control"
_CLOSED: dict[str, Any] = {"facecolor": UNSTABLE, "alpha": 0.28, "linewidth": 0.0, "zorder": 1}
_CLOSED["label"] = "unstable with control"


def envelope_figure(
    points: Sequence[EnvelopePoint], speeds: tuple[float, float], title: str, *, margin: float, criterion: str
) -> Figure:
    """Boundaries over speed and altitude; where there is a controller, its margin and the gusts it suppresses.

    Parameters
    ----------
    points : sequence of EnvelopePoint
        Of `envelope`. [SI]
    speeds : tuple of float
        Lowest and highest speed. [m/s]
    title : str
        Above the figure.
    margin : float
        Disk margin asked for. [-]
    criterion : str
        The same in words.

    Returns
    -------
    figure : matplotlib Figure
        For `figures.as_bytes`.
    """
    from matplotlib.figure import Figure as NewFigure

    closed, gusts = any(p.closed_loop is not None for p in points), any(p.gusts for p in points)
    panels = 1 + closed + gusts
    figure = NewFigure(figsize=(8.0 + 4.2 * (panels - 1), 6.2))
    figure.set_layout_engine("constrained", wspace=0.05)
    widths = [1.4, *[1.0] * (panels - 1)]
    axes: Any = np.atleast_1d(figure.subplots(1, panels, width_ratios=widths))
    figure.suptitle(title.replace("$", r"\$"), fontsize="medium")
    points = sorted(points, key=lambda p: p.altitude)
    _boundaries(axes[0], points, speeds, criterion)
    shown = [points[i] for i in sorted({round(x) for x in np.linspace(0, len(points) - 1, CURVES)})]
    if closed:
        _margins(axes[1], shown, speeds, margin, criterion)
    if gusts:
        _gusts(axes[-1], shown, speeds)
    for ax in axes:
        ax.grid(visible=True, linewidth=0.3)
        ax.set_xlim(*speeds)
        ax.set_xlabel("true airspeed, m/s")
    handles, labels = axes[0].get_legend_handles_labels()
    entries = dict(zip(labels, handles))
    figure.legend(
        list(entries.values()), list(entries), loc="outside lower center", ncols=2 if panels < 3 else 3,
        fontsize="small", frameon=False,
    )  # fmt: skip
    return figure


def _boundaries(ax: Axes, points: Sequence[EnvelopePoint], speeds: tuple[float, float], criterion: str) -> None:
    """Shaded unstable ranges, lines of statics and margin, dashed limits of validity."""
    _shade(ax, points, [p.open_loop for p in points], speeds, _ALONE)
    altitude = [p.altitude for p in points]
    onset = [_onset(p.open_loop, speeds[0]) for p in points]
    ax.plot(onset, altitude, color="0.35", linewidth=1.6, label="first instability without control")
    if any(p.closed_loop is not None for p in points):
        _shade(ax, points, [p.closed_loop or () for p in points], speeds, _CLOSED)
        first = [_onset(p.closed_loop or (), speeds[0]) for p in points]
        ax.plot(first, altitude, color=UNSTABLE, linewidth=2.2, label="first instability with control", zorder=4)
        margin = [np.nan if p.margin_speed is None else p.margin_speed for p in points]
        ax.plot(margin, altitude, color="#0072B2", linewidth=2.0, label=f"{criterion} to here")
    for name, values, dashes in (
        ("divergence (static)", [p.divergence for p in points], (0, (3, 1, 1, 1))),
        (f"reversal of {points[0].reversal_quantity or 'control'}", [p.reversal for p in points], (0, (1, 1.5))),
    ):
        x = np.array([np.nan if v is None else v for v in values])
        if np.any((x >= speeds[0]) & (x <= speeds[1])):
            ax.plot(x, altitude, color=MARK, linestyle=dashes, linewidth=1.5, label=name, zorder=5)
    for number, why in enumerate(dict.fromkeys(v.why for p in points for v in p.validity)):
        limits = [next((v for v in p.validity if v.why == why), None) for p in points]
        x = np.array([np.nan if v is None else v.speed for v in limits])
        if np.any((x >= speeds[0]) & (x <= speeds[1])):
            side = next(v.side for v in limits if v is not None)
            beyond = "not valid " + ("right" if side == "above" else "left") + " of this: "
            dashes = ((0, (6, 4)), (0, (2, 3)), (0, (8, 3, 2, 3)), (0, (4, 6)))[number % 4]
            ax.plot(x, altitude, color="#009E73", linestyle=dashes, linewidth=1.3, label=beyond + why, zorder=5)
    ax.set_ylabel("altitude, m")
    if len(points) > 1:
        ax.set_ylim(points[0].altitude, points[-1].altitude)
    else:
        ax.set_ylim(points[0].altitude - 1.0, points[0].altitude + 1.0)
        ax.set_yticks([points[0].altitude])


def _onset(intervals: Sequence[Interval], low: float) -> float:
    """Lowest unstable speed."""
    return min((low if i.start is None else i.start for i in intervals), default=np.nan)


def _shade(
    ax: Axes,
    points: Sequence[EnvelopePoint],
    intervals: Sequence[Sequence[Interval]],
    speeds: tuple[float, float],
    look: dict[str, Any],
) -> None:
    """Union of the unstable ranges, joined from altitude to altitude where they are as many."""
    joined = [_union(one, speeds) for one in intervals]
    altitude = [p.altitude for p in points]
    if len(points) == 1:
        for start, end in joined[0]:
            ax.axvspan(start, end, **look)
        return
    for i in range(len(points) - 1):
        below, above, low, high = joined[i], joined[i + 1], altitude[i], altitude[i + 1]
        if len(below) == len(above):
            for one, other in zip(below, above):
                ax.fill_betweenx([low, high], [one[0], other[0]], [one[1], other[1]], **look)
            continue
        middle = 0.5 * (low + high)
        for ranges, ends in ((below, (low, middle)), (above, (middle, high))):
            for start, end in ranges:
                ax.fill_betweenx(ends, [start, start], [end, end], **look)


def _union(intervals: Sequence[Interval], speeds: tuple[float, float]) -> list[tuple[float, float]]:
    """Unstable ranges, overlapping ones as one."""
    found: list[tuple[float, float]] = []
    ends = ((speeds[0] if i.start is None else i.start, speeds[1] if i.end is None else i.end) for i in intervals)
    for start, end in sorted(ends):
        if found and start <= found[-1][1]:
            found[-1] = found[-1][0], max(end, found[-1][1])
        else:
            found.append((start, end))
    return found


def _margins(
    ax: Axes, points: Sequence[EnvelopePoint], speeds: tuple[float, float], margin: float, criterion: str
) -> None:
    """Disk margin against speed at a few altitudes."""
    for j, p in enumerate(points):
        ax.plot(p.margin_speeds, p.margin_alpha, **style(j), label=f"{p.altitude:g} m")
    ax.axhline(margin, color=MARK, linewidth=1.0)
    ax.text(speeds[1], margin, f"{criterion} ", ha="right", va="bottom", fontsize="small", color=MARK)
    ax.legend(title="altitude", loc="upper right", fontsize="small")
    ax.set_ylim(0.0, 2.05)
    ax.set_ylabel(r"balanced disk margin $\alpha$ (0: unstable)")


def _gusts(ax: Axes, points: Sequence[EnvelopePoint], speeds: tuple[float, float]) -> None:
    """Largest gust that is still suppressed, at a few altitudes."""
    drawn = False
    for j, p in enumerate(points):
        if p.gusts:
            V, w = [g.speed for g in p.gusts], [g.amplitude for g in p.gusts]
            ax.plot(V, w, marker="o", markersize=4, **style(j), label=f"{p.altitude:g} m")
            open_end = [(g.speed, g.amplitude) for g in p.gusts if g.at_least]
            if open_end:
                x, y = zip(*open_end)
                label = None if drawn else "or more: the largest tried"
                ax.plot(x, y, linestyle="none", marker="^", markersize=8, color="0.35", label=label)
            drawn = True
    if not drawn:
        nothing_to_show(ax, "no gusts were tried")
    else:
        ax.legend(title="altitude", loc="lower left", fontsize="small")
    ax.set_ylim(bottom=0.0)
    ax.set_ylabel("largest 1-cosine gust suppressed, m/s")
