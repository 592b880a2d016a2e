"""Figures of flutter and statics (modes: mode_figures.py): a result goes in, a matplotlib figure comes out.

Damping is drawn as the damping ratio zeta = -Re(lambda)/|lambda|, positive stable; a second scale holds the thesis'
100 Re(lambda)/|lambda| in per cent, positive flutter, and each scale says which it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.report.mode_figures import modes_figure, plot_modes
from aeroservo.report.style import (
    UNSTABLE,
    as_bytes,
    finite,
    literal,
    mark_mach_limit,
    mark_speeds,
    new_figure,
    nothing_to_show,
    shade_unstable,
    shared_legend,
    speed_axis,
    style,
    write_figure,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from aeroservo.aeroelastic.flutter import FlutterResult
    from aeroservo.aeroelastic.static import StaticResult

__all__ = [
    "as_bytes",
    "flutter_figure",
    "modes_figure",
    "plot_damping",
    "plot_flutter",
    "plot_frequency",
    "plot_modes",
    "plot_root_locus",
    "plot_static",
    "static_figure",
    "write_figure",
]


MOST_BRANCHES = 5
"""Branches drawn where there are more: the lowest, and every one that becomes unstable."""


def shown_branches(result: FlutterResult) -> list[int]:
    """Branches that a figure shows: the lowest in frequency, and every one that is ever unstable.

    Parameters
    ----------
    result : FlutterResult
        Of `aeroservo.flutter`.

    Returns
    -------
    index : list of int
        Ascending. [-]
    """
    growth = np.where(np.isfinite(result.roots), result.roots.real, -np.inf)
    unstable = np.any(growth > 1e-9 * np.abs(np.where(np.isfinite(result.roots), result.roots, 0.0)), axis=0)
    return [j for j in range(len(result.names)) if j < MOST_BRANCHES or unstable[j]]


def plot_frequency(result: FlutterResult, ax: Axes) -> None:
    """Frequency of every mode against speed.

    Parameters
    ----------
    result : FlutterResult
        Of `aeroservo.flutter`.
    ax : matplotlib Axes
        Drawn into.
    """
    for j in shown_branches(result):
        hertz = np.where(np.isfinite(result.roots[:, j]), result.frequency[:, j], np.nan) / (2.0 * np.pi)
        ax.plot(result.speeds[:, j], hertz, label=literal(result.names[j]), **style(j))
    _say_hidden(result, ax)
    if not finite(result.roots):
        nothing_to_show(ax, "no mode has a root in this range")
    _speeds(result, ax)
    ax.set_ylabel("frequency, Hz")
    ax.set_ylim(bottom=0.0)


def plot_damping(result: FlutterResult, ax: Axes) -> None:
    """Damping ratio of every mode against speed, with the thesis' scale of the opposite sign on the right.

    Parameters
    ----------
    result : FlutterResult
        Of `aeroservo.flutter`.
    ax : matplotlib Axes
        Drawn into.
    """
    for j in shown_branches(result):
        ax.plot(result.speeds[:, j], result.damping_ratio[:, j], label=literal(result.names[j]), **style(j))
    if not finite(result.roots):
        nothing_to_show(ax, "no mode has a root in this range")
    ax.axhline(0.0, color="black", linewidth=0.8)
    _speeds(result, ax)
    limits = _damping_limits(result)
    ax.set_ylim(*limits)
    _say_off_scale(result, ax, limits)
    ax.set_ylabel(r"damping ratio $\zeta$ (positive: stable)")
    percent = ax.secondary_yaxis("right", functions=(_to_percent, _to_percent_back))
    percent.set_ylabel(r"thesis: $100\,\mathrm{Re}\,\lambda/|\lambda|$, % (positive: flutter)")


def _say_off_scale(result: FlutterResult, ax: Axes, limits: tuple[float, float]) -> None:
    """Name the branches that never swing: their damping ratio is 1 or -1 and may lie outside the panel."""
    hidden = [
        result.names[j]
        for j in shown_branches(result)
        if finite(zeta := result.damping_ratio[:, j]) and not np.any((zeta > limits[0]) & (zeta < limits[1]))
    ]
    if hidden:
        ax.set_title(literal(f"off this scale, not oscillating: {', '.join(hidden)}"), fontsize="small")


def _damping_limits(result: FlutterResult) -> tuple[float, float]:
    """Room for every root that swings; a real root has zeta = 1 or -1 and leaves the panel."""
    shown = shown_branches(result)
    zeta, frequency = result.damping_ratio[:, shown], result.frequency[:, shown]
    zeta = zeta[np.isfinite(zeta) & (frequency > 0.0)]
    if not zeta.size:
        return -1.05, 1.05
    low, high = min(float(zeta.min()), -0.02), max(float(zeta.max()), 0.02)
    room = 0.08 * (high - low)
    return max(low - room, -1.05), min(high + room, 1.05)


def plot_root_locus(result: FlutterResult, ax: Axes) -> None:
    """Roots of the upper half plane as the speed grows, from open circle to dot, a cross where flutter begins.

    Parameters
    ----------
    result : FlutterResult
        Of `aeroservo.flutter`.
    ax : matplotlib Axes
        Drawn into.
    """
    for j in shown_branches(result):
        root = result.roots[:, j]
        ax.plot(*_locus(root), label=literal(result.names[j]), **style(j))
        ends = np.flatnonzero(np.isfinite(root))
        if ends.size:
            colour = style(j)["color"]
            first, last = root[ends[0]], root[ends[-1]]
            ax.plot(first.real, abs(first.imag), "o", color=colour, fillstyle="none", markersize=6)
            ax.plot(last.real, abs(last.imag), "o", color=colour, markersize=4)
    if not finite(result.roots):
        nothing_to_show(ax, "no mode has a root in this range")
    ax.axvline(0.0, color="black", linewidth=0.8)
    if result.flutter_speed is not None and result.flutter_frequency is not None:
        ax.plot(0.0, result.flutter_frequency, "X", color=UNSTABLE, markersize=8, label="flutter begins", zorder=5)
    _locus_limits(result, ax)
    ax.set_ylim(bottom=-0.02 * ax.get_ylim()[1])
    ax.set_xlabel(r"Re $\lambda$, 1/s (positive: unstable)")
    ax.set_ylabel(r"Im $\lambda$, rad/s")
    V = result.V
    ax.set_title(f"from {V[0]:g} m/s (circle) to {V[-1]:g} m/s (dot)", fontsize="small")


def _locus(root: Any) -> tuple[Any, Any]:
    """A branch with a gap where a pair becomes real roots or the reverse: nothing lies on a line between the two."""
    meets = np.flatnonzero(np.diff(np.abs(root.imag) > 0.0) & np.isfinite(root[1:] + root[:-1])) + 1
    gapped = np.insert(root, meets, np.nan)
    return gapped.real, np.abs(gapped.imag)


def _locus_limits(result: FlutterResult, ax: Axes) -> None:
    """Real roots that run far away are cut where the oscillations still show."""
    shown = shown_branches(result)
    roots, frequency = result.roots[:, shown], result.frequency[:, shown]
    swinging = roots[np.isfinite(roots) & (frequency > 0.0)]
    if swinging.size:
        low, high = min(float(swinging.real.min()), 0.0), max(float(swinging.real.max()), 0.0)
        room = 0.12 * max(high - low, 1e-3)
        ax.set_xlim(low - room, high + room)


def plot_flutter(result: FlutterResult, axes: Sequence[Axes] | None = None, *, title: str = "") -> Figure:
    """Frequency and damping against speed, and the root locus.

    Unstable speeds are shaded; flutter and divergence speeds are marked; a dashed line stands at Mach 0.3 where the
    theory has no Mach number. Damping away from the boundary is each method's own: the k method's is -g/2 of its
    artificial damping.

    Parameters
    ----------
    result : FlutterResult
        Of `aeroservo.flutter`.
    axes : sequence of matplotlib Axes, optional
        Two (frequency, damping) or three (root locus too) to draw into; default a new figure of three.
    title : str
        Above a new figure.

    Returns
    -------
    figure : matplotlib Figure
        That of the axes.

    Raises
    ------
    ValueError
        If neither two nor three axes are given.
    """
    if axes is not None and len(axes) not in (2, 3):
        raise ValueError(f"axes must be two or three, got {len(axes)}")
    figure = new_figure(title, 1, 3, width=4.7, height=4.0) if axes is None else None
    panels: Any = figure.axes if figure is not None else axes
    for panel, draw in zip(panels, (plot_frequency, plot_damping, plot_root_locus)):
        draw(result, panel)
    if figure is not None:
        shared_legend(figure)
        return figure
    whole: Figure = panels[0].figure
    return whole


def flutter_figure(result: FlutterResult, title: str) -> Figure:
    """`plot_flutter` in a new figure.

    Parameters
    ----------
    result : FlutterResult
        Of `aeroservo.flutter`.
    title : str
        Above the figure.

    Returns
    -------
    figure : matplotlib Figure
        For `as_bytes` or `write_figure`.
    """
    return plot_flutter(result, title=title)


def plot_static(
    result: StaticResult, axes: Sequence[Axes] | None = None, *, title: str = "", a_sound: float | None = None
) -> Figure:
    """Twist, control effectiveness and lift slope against speed.

    Parameters
    ----------
    result : StaticResult
        Of `aeroservo.static`.
    axes : sequence of matplotlib Axes, optional
        Three to draw into; default a new figure.
    title : str
        Above a new figure.
    a_sound : float, optional
        Speed of sound, for the line at Mach 0.3. [m/s]

    Returns
    -------
    figure : matplotlib Figure
        That of the axes.

    Raises
    ------
    ValueError
        If not three axes are given.
    """
    if axes is not None and len(axes) != 3:
        raise ValueError(f"axes must be three, got {len(axes)}")
    figure = new_figure(title, 1, 3, height=3.8) if axes is None else None
    panels: Any = figure.axes if figure is not None else axes
    quantity = result.reversal_quantity or "control"
    per = "steady roll rate" if quantity == "roll" else "lift"
    curves = (
        (result.twist, "tip twist per root incidence, rad/rad", "no twist", 5.0),
        (result.effectiveness, f"{per} per elevon angle, elastic/rigid", "no control surface", 2.0),
        (result.lift_slope_ratio, "lift slope, elastic/rigid", "no lift", 6.0),
    )
    for j, (panel, (values, label, lacks, room)) in enumerate(zip(panels, curves)):
        panel.set_ylabel(label)
        speed_axis(panel, result.V)
        if not finite(values):
            past = result.divergence.V is not None and bool(np.all(result.V >= result.divergence.V))
            nothing_to_show(panel, "every speed is past divergence" if past else f"this model has {lacks}")
            continue
        panel.plot(result.V, values, **style(j))
        _cut(panel, values, room)
        panel.axhline(0.0, color="black", linewidth=0.8)
        marks = [("divergence", result.divergence.V), (f"reversal of {quantity}", result.reversal.V)]
        mark_speeds(panel, result.V, marks)
        if result.divergence.V is not None and result.V[-1] > result.divergence.V:
            start = max(float(result.V[0]), result.divergence.V)
            panel.axvspan(
                start, float(result.V[-1]), facecolor="0.9", zorder=0, label="past divergence: no equilibrium"
            )
        mark_mach_limit(panel, result.V, a_sound)
    if figure is not None:
        shared_legend(figure)
        return figure
    whole: Figure = panels[0].figure
    return whole


def static_figure(result: StaticResult, title: str, *, a_sound: float | None = None) -> Figure:
    """`plot_static` in a new figure.

    Parameters
    ----------
    result : StaticResult
        Of `aeroservo.static`.
    title : str
        Above the figure.
    a_sound : float, optional
        Speed of sound, for the line at Mach 0.3. [m/s]

    Returns
    -------
    figure : matplotlib Figure
        For `as_bytes` or `write_figure`.
    """
    return plot_static(result, title=title, a_sound=a_sound)


def _speeds(result: FlutterResult, ax: Any) -> None:
    """What every panel over speed has in common."""
    shade_unstable(ax, result)
    marks = [("flutter", result.flutter_speed), ("divergence (static)", result.divergence_speed)]
    mark_speeds(ax, result.V, marks)
    incompressible = any("Mach 0.3" in note for note in result.warnings)
    mark_mach_limit(ax, result.V, float(result.condition.a_sound[0]) if incompressible else None)
    speed_axis(ax, result.V)


def _say_hidden(result: FlutterResult, ax: Any) -> None:
    """Say how many modes are left out."""
    hidden = len(result.names) - len(shown_branches(result))
    if hidden:
        text = f"{hidden} higher mode{'s' if hidden > 1 else ''}, stable throughout, not drawn"
        ax.set_title(text, fontsize="small")


def _cut(ax: Any, values: Any, room: float) -> None:
    """Curves that run to infinity at divergence are cut at plus and minus `room`."""
    low, high = min(0.0, float(np.nanmin(values))), max(0.0, float(np.nanmax(values)))
    low, high = max(low, -room), min(high, room)
    spare = 0.05 * max(high - low, 1e-12)
    ax.set_ylim(low - spare, high + spare)


def _to_percent(zeta: Any) -> Any:
    """The thesis' per cent of a damping ratio."""
    return -100.0 * zeta


def _to_percent_back(percent: Any) -> Any:
    """Damping ratio of the thesis' per cent."""
    return -0.01 * percent
