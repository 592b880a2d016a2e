"""Figures of steady aerodynamics: section polars, wing polars, span loading, what trim costs (thesis 4 and 21-25).

The argument `title` of each stands above the figure; every number drawn is in the result that goes in.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.report.style import finite, literal, new_figure, nothing_to_show, shared_legend, style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from aeroservo.aero.polars import Polar
    from aeroservo.aero.viscous_wing import Trim, WingPolar
    from aeroservo.aeroelastic.aircraft_lattice import AircraftLattice

#: Look of the points whose strips are stalled or outside their polars.
_OPEN = {"marker": "o", "fillstyle": "none", "linestyle": "none", "markersize": 4.5}


def section_polar_figure(polar: Polar, title: str) -> Figure:
    """Lift, drag, moment and L/D against angle of attack, and the best L/D against deflection (thesis figure 21).

    Parameters
    ----------
    polar : Polar
        Over angle of attack, deflection and Reynolds number.
    title : str
        Above the figure.

    Returns
    -------
    figure : matplotlib Figure
        Curves over alpha at the middle Reynolds number, one for each deflection; below, one curve of the best L/D for
        each Reynolds number where there are two deflections or more.
    """
    middle = len(polar.reynolds) // 2
    figure = new_figure(title, 2, 3, width=4.2, height=3.3)
    (lift, drag, moment, ratio, best, spare) = figure.axes
    degrees = np.degrees(polar.alpha)
    for j, d in enumerate(np.degrees(polar.delta)):
        label = f"deflection {_signed(d)}"
        CL, CD, CM = (t[middle, j] for t in (polar.CL, polar.CD, polar.CM))
        lift.plot(degrees, CL, label=label, **style(j))
        drag.plot(CD, CL, label=label, **style(j))
        moment.plot(degrees, CM, label=label, **style(j))
        ratio.plot(degrees, CL / CD, label=label, **style(j))
    for ax, name in ((lift, "lift coefficient CL"), (moment, "moment about c/4, CM"), (ratio, "CL/CD")):
        ax.set_ylabel(name)
        ax.set_xlabel("angle of attack, deg")
    drag.set_xlabel("drag coefficient CD")
    drag.set_ylabel("lift coefficient CL")
    drag.set_xlim(left=0.0)
    for ax in (lift, drag, moment, ratio):
        ax.set_title(f"Re {polar.reynolds[middle] / 1e6:g} million", fontsize="small")
    _best_ratio(polar, best, spare)
    shared_legend(figure)
    return figure


def _best_ratio(polar: Polar, best: Any, spare: Any) -> None:
    """Best L/D, and the moment that goes with it, against deflection for each Reynolds number."""
    degrees = np.degrees(polar.delta)
    for i, re in enumerate(polar.reynolds):
        found = [_best_point(polar, i, j) for j in range(len(degrees))]
        look = style(i) | {"marker": "osv^Dx"[i % 6], "markersize": 4}
        best.plot(degrees, [f[0] for f in found], label=f"Re {re / 1e6:g} million", **look)
        spare.plot(degrees, [f[1] for f in found], label=f"Re {re / 1e6:g} million", **look)
    best.set_ylabel("best CL/CD (median of three points)")
    spare.set_ylabel("CM at the best CL/CD")
    for ax in (best, spare):
        ax.set_xlabel("deflection, trailing edge down, deg")
        if len(degrees) < 2:
            nothing_to_show(ax, "one deflection only")


def _best_point(polar: Polar, i: int, j: int) -> tuple[float, float]:
    """Best L/D of one sweep, by a running median of three points, and the moment there."""
    from aeroservo.aero.polars import best_lift_to_drag

    if np.isfinite(polar.CL[i, j] / polar.CD[i, j]).sum() < 3:
        return float("nan"), float("nan")
    ratio, alpha = best_lift_to_drag(polar, reynolds=float(polar.reynolds[i]), delta=float(polar.delta[j]))
    return ratio, float(polar.CM[i, j, int(np.argmin(np.abs(polar.alpha - alpha)))])


def wing_polar_figure(
    alpha: Sequence[float] | np.ndarray,
    groups: Sequence[tuple[str, Sequence[float] | np.ndarray, Sequence[WingPolar]]],
    title: str,
) -> Figure:
    """CL, CD, CM and L/D of the wing against angle of attack, inviscid and viscous (thesis figures 22-25).

    Parameters
    ----------
    alpha : array_like, shape (n_a,)
        Angles of attack. [rad]
    groups : sequence of (str, array_like, sequence of WingPolar)
        Name ("hinged", "morphed"), deflections of shape (n_d,) [rad] and one polar for each, whose arrays have shape
        (n_a,) [-]; a column for each group, with the same scales.
    title : str
        Above the figure.

    Returns
    -------
    figure : matplotlib Figure
        Lines with profile drag and the sections' moments, thin lines without; open circles where strips are stalled
        or outside their polars.
    """
    columns = len(groups)
    if columns == 1:
        figure = new_figure(title, 2, 2, width=5.4, height=3.3)
    else:
        figure = new_figure(title, 4, columns, width=4.9, height=2.7)
    axes = np.array(figure.axes).reshape(4, columns)
    degrees = np.degrees(np.asarray(alpha, dtype=float))
    for column, (name, deltas, polars) in enumerate(groups):
        for j, (d, p) in enumerate(zip(np.degrees(deltas), polars)):
            label = f"deflection {_signed(d)}"
            curves = (
                (p.CL, None),
                (p.CD, p.CD_induced),
                (p.CM_viscous, p.CM),
                (p.lift_to_drag, p.lift_to_drag_inviscid),
            )
            for ax, (viscous, inviscid) in zip(axes[:, column], curves):
                ax.plot(degrees, viscous, label=label, **style(j))
                ax.plot(degrees[p.stalled], viscous[p.stalled], color=style(j)["color"], **_OPEN)
                if inviscid is not None:
                    look = style(j) | {"linewidth": 0.7}
                    ax.plot(degrees, inviscid, **look)
        axes[0, column].set_title(literal(name), fontsize="medium")
        for ax in axes[2:, column] if columns == 1 else axes[3:, column]:
            ax.set_xlabel("angle of attack, deg")
    for ax, text in zip(axes[:, 0], ("CL", "CD", "CM about the reference point", "CL/CD")):
        ax.set_ylabel(text)
    _say_lines(axes[0, 0])
    _same_scales(axes, groups)
    shared_legend(figure)
    return figure


def _say_lines(ax: Any) -> None:
    """Entries of the legend for what thick, thin and circles mean."""
    ax.plot([], [], color="black", linewidth=1.6, label="with section polars")
    ax.plot([], [], color="black", linewidth=0.7, label="inviscid")
    ax.plot([], [], color="black", label="strips stalled or outside their polars", **_OPEN)


def _same_scales(axes: np.ndarray, groups: Sequence[tuple[str, Any, Sequence[WingPolar]]]) -> None:
    """One scale for each row; inviscid L/D grows without bound near zero lift, so viscous values set that row's."""
    polars = [p for _, _, many in groups for p in many]
    for row in axes:
        limits = np.array([ax.get_ylim() for ax in row])
        for ax in row:
            ax.set_ylim(limits[:, 0].min(), limits[:, 1].max())
    ratios = np.concatenate([p.lift_to_drag for p in polars])
    if finite(ratios):
        low, high = float(np.nanmin(ratios)), float(np.nanmax(ratios))
        for ax in axes[3]:
            ax.set_ylim(1.3 * min(low, 0.0) - 2.0, 1.6 * max(high, 0.0) + 2.0)
    for ax in axes[1]:
        ax.set_ylim(bottom=0.0)


def span_loading_figure(
    found: AircraftLattice, states: Sequence[tuple[str, dict[str, float]]], title: str, *, surface: int = 0
) -> Figure:
    """Load and local lift coefficient along the half span beside the elliptic load of the same lift.

    Parameters
    ----------
    found : AircraftLattice
        The lattice.
    states : sequence of (str, dict)
        Label and amounts of the inputs by name; "steady" = 1 for camber and twist. [rad]
    title : str
        Above the figure.
    surface : int
        Index of the surface.

    Returns
    -------
    figure : matplotlib Figure
        Left c cl over the mean chord, with the elliptic load of the same lift in grey; right the local cl.
    """
    from aeroservo.aero.vlm_loads import span_loading

    loading = span_loading(found.solution)
    mine = (loading.surface == surface) & (loading.side > 0)
    order = np.argsort(loading.y[mine])
    y, chord, width = (v[mine][order] for v in (loading.y, loading.chord, loading.width))
    tip = float(np.max(y + 0.0)) + 0.5 * float(width[-1])
    eta = y / tip
    mean = float(np.sum(chord * width) / np.sum(width))
    figure = new_figure(title, 1, 2, width=4.9, height=3.7)
    left, right = figure.axes
    ellipse = np.sqrt(np.maximum(1.0 - eta**2, 0.0))
    drawn: list[np.ndarray] = []
    for j, (label, inputs) in enumerate(states):
        x = np.array([inputs.get(name, 0.0) for name in loading.names])
        cl = (loading.cl[mine][order]) @ x
        load = cl * chord / mean
        elliptic = ellipse * np.sum(load * width) / np.sum(ellipse * width)
        left.plot(eta, load, label=label, **style(j))
        if not drawn or not any(np.allclose(elliptic, other, rtol=1e-6, atol=1e-9) for other in drawn):
            left.plot(eta, elliptic, color="0.6", linewidth=2.4, zorder=1, label="elliptic, the same lift")
        drawn.append(elliptic)
        right.plot(eta, cl, label=label, **style(j))
    left.set_ylabel("load c cl / mean chord")
    right.set_ylabel("local lift coefficient cl")
    for ax in (left, right):
        ax.set_xlabel("y / half span")
        ax.set_xlim(0.0, 1.0)
        ax.axhline(0.0, color="black", linewidth=0.8)
    shared_legend(figure)
    return figure


def trim_figure(
    trims: Sequence[tuple[str, Trim]], title: str, *, neutral_point: float, x_cg: float | None = None
) -> Figure:
    """Trimmed L/D and the deflection that trims against the centre of gravity: what stability costs (thesis figure 4).

    Parameters
    ----------
    trims : sequence of (str, Trim)
        Label and trimmed states.
    title : str
        Above the figure.
    neutral_point : float
        Position of the neutral point. [m]
    x_cg : float, optional
        The aircraft's own centre of gravity. [m]

    Returns
    -------
    figure : matplotlib Figure
        L/D above, deflection below; gaps where no balance lies inside the polars.
    """
    figure = new_figure(title, 2, 1, width=6.4, height=2.8)
    above, below = figure.axes
    for j, (label, trim) in enumerate(trims):
        margin = 100.0 * np.asarray(trim.static_margin)
        above.plot(margin, trim.polar.lift_to_drag, label=label, **style(j))
        below.plot(margin, np.degrees(trim.delta), label=label, **style(j))
    if not any(finite(t.polar.lift_to_drag) for _, t in trims):
        nothing_to_show(above, "no balance inside the section polars")
    above.set_ylabel("trimmed CL/CD")
    below.set_ylabel("deflection that trims, deg")
    below.set_xlabel("static margin, % of the reference chord (positive: stable)")
    _say_position(above, trims)
    for ax in figure.axes:
        ax.axvline(0.0, color="black", linewidth=0.8, label=f"neutral point, x = {neutral_point:.4f} m")
    if x_cg is not None and len(trims):
        first = trims[0][1]
        own = float(np.interp(x_cg, first.x_cg, 100.0 * first.static_margin, left=np.nan, right=np.nan))
        for ax in figure.axes if np.isfinite(own) else ():
            ax.axvline(own, color="0.35", linestyle="--", label=f"centre of gravity of the file, x = {x_cg:.4f} m")
    below.axhline(0.0, color="black", linewidth=0.6)
    shared_legend(figure)
    return figure


def _say_position(ax: Any, trims: Sequence[tuple[str, Trim]]) -> None:
    """A second scale above: where the centre of gravity is, in metres."""
    if not trims or len(trims[0][1].x_cg) < 2:
        return
    x, margin = np.asarray(trims[0][1].x_cg), 100.0 * np.asarray(trims[0][1].static_margin)
    slope = (x[-1] - x[0]) / (margin[-1] - margin[0])
    scale = ax.secondary_xaxis(
        "top", functions=(lambda m: x[0] + slope * (m - margin[0]), lambda p: margin[0] + (p - x[0]) / slope)
    )
    scale.set_xlabel("centre of gravity x, m")


def _signed(degrees: float) -> str:
    """An angle with its sign: 0 without one."""
    return "0°" if abs(degrees) < 1e-9 else f"{degrees:+g}°"
