"""The thesis' Figures 26 to 28 from our own results, and unsteady flutter speeds against a fixed k."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.report.figures import plot_damping, plot_frequency
from aeroservo.report.style import (
    COLOURS,
    UNSTABLE,
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
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from aeroservo.aeroelastic.flutter import FlutterResult
    from aeroservo.aeroelastic.static import StaticResult
    from aeroservo.studies.thesis import Held, Model, ThesisStudy

NEAR_DIVERGENCE = 0.95
"""Twist is drawn in per cent of that at this part of the divergence speed: at divergence itself it has no bound."""


def plot_response_against_speed(static: StaticResult, flutter: FlutterResult, *, title: str = "") -> Figure:
    """Fig. 26: twist, control effectiveness and damping against speed, all in per cent as the thesis has them.

    Parameters
    ----------
    static : StaticResult
        Of `aeroservo.static`.
    flutter : FlutterResult
        Of `aeroservo.flutter`, at the same density.
    title : str
        Above the figure.

    Returns
    -------
    figure : matplotlib Figure
        For `write_figure`.

    References
    ----------
    Bramstång 2015, section 9.2, Figure 26.
    """
    figure = new_figure(title, 1, 1, width=7.5, height=4.6)
    ax: Any = figure.axes[0]
    drawn = 0
    V, twist, largest = _twist_per_cent(static)
    if finite(twist):
        ax.plot(V, twist, label=f"twist, % of that at {largest}", **style(0))
        drawn += 1
    if finite(static.effectiveness):
        ax.plot(static.V, 100.0 * static.effectiveness, label="roll effectiveness, % of rigid", **style(1))
        drawn += 1
    for j, name in enumerate(flutter.names):
        swings = np.isfinite(flutter.roots[:, j]) & (flutter.frequency[:, j] > 0.0)
        percent = np.where(swings, -100.0 * flutter.damping_ratio[:, j], np.nan)
        if finite(percent):
            ax.plot(flutter.speeds[:, j], percent, label=f"damping of {literal(name)}, %", **style(2 + j))
            drawn += 1
    if not drawn:
        nothing_to_show(ax, "nothing to show in this range")
    ax.axhline(0.0, color="black", linewidth=0.8)
    ax.set_ylim(-105.0, 105.0)
    shade_unstable(ax, flutter)
    marks = (("flutter", flutter.flutter_speed), ("divergence", static.divergence.V), ("reversal", static.reversal.V))
    mark_speeds(ax, static.V, marks)
    incompressible = any("Mach 0.3" in note for note in flutter.warnings)
    mark_mach_limit(ax, static.V, float(flutter.condition.a_sound[0]) if incompressible else None)
    speed_axis(ax, static.V)
    ax.set_ylabel(
        "per cent; damping as in the thesis:\n" + r"$+100\,\mathrm{Re}\,\lambda/|\lambda|$, positive: flutter"
    )
    shared_legend(figure, columns=2)
    return figure


def _twist_per_cent(static: StaticResult) -> tuple[Any, Any, str]:
    """Speeds, twist in per cent of the largest drawn, and which that is."""
    V_D, known = static.divergence.V, np.isfinite(static.twist)
    if V_D is None or static.V[-1] < NEAR_DIVERGENCE * V_D or not np.any(known):
        largest = np.nanmax(np.abs(static.twist)) if np.any(known) else np.nan
        return static.V, 100.0 * static.twist / largest, f"{static.V[-1]:g} m/s"
    end = NEAR_DIVERGENCE * V_D
    part, last = (static.V[known] / V_D) ** 2, NEAR_DIVERGENCE**2
    size = static.twist[known] * (1.0 - part) / part  # for one shape of twist a constant, else smooth up to divergence
    largest = np.interp(end, static.V[known], size) * last / (1.0 - last)
    n = int(np.searchsorted(static.V, end))
    V, twist = np.append(static.V[:n], end), np.append(static.twist[:n], largest)
    return V, 100.0 * twist / largest, f"{NEAR_DIVERGENCE:g} of the divergence speed"


def plot_flutter_prediction(study: ThesisStudy, model: Model, altitude: float) -> Figure:
    """Figs. 27 and 28: frequency and damping against speed, quasi-steady beside unsteady.

    Parameters
    ----------
    study : ThesisStudy
        Of `thesis_study`.
    model : {"binary", "aircraft"}
        Fig. 27 or Fig. 28.
    altitude : float
        0 or 3048. [m]

    Returns
    -------
    figure : matplotlib Figure
        For `write_figure`.

    References
    ----------
    Bramstång 2015, section 9.3, Figures 27-28.
    """
    whole = {"binary": "Fig. 27, binary wing", "aircraft": "Fig. 28, whole aircraft"}[model]
    figure = new_figure(f"{whole} at {altitude:g} m", 2, 3, width=4.7, height=3.7)
    axes: Any = figure.axes
    columns = (
        ("quasi_steady_damped", "a_w", "quasi-steady with pitch damping (p)"),
        ("theodorsen", "a_w", "unsteady: Theodorsen, slope a_w (p-k)"),
        ("theodorsen", "2 pi", "unsteady: Theodorsen, slope 2 pi (p-k)"),
    )
    for j, (theory, slope, words) in enumerate(columns):
        run = study.run(model, altitude, theory, slope)  # type: ignore[arg-type]
        plot_frequency(run.flutter, axes[j])
        plot_damping(run.flutter, axes[3 + j])
        speed = run.flutter.flutter_speed
        found = "no flutter in this range" if speed is None else f"flutter at {speed:.2f} m/s"
        axes[j].set_title(f"{words}\n{found}", fontsize="small")
    _unnumbered(axes)
    shared_legend(figure)
    return figure


def _unnumbered(axes: Any) -> None:
    """Marked speeds differ from panel to panel: their numbers stand in the titles, their names in one legend."""
    for ax in axes:
        for line in ax.get_lines():
            label = str(line.get_label())
            if label.startswith(("flutter", "divergence")):
                line.set_label(label.rsplit(" ", 2)[0])


def plot_fixed_k(study: ThesisStudy) -> Figure:
    """Flutter speed with derivatives held at one k against that k, and which k prints the thesis' number.

    Parameters
    ----------
    study : ThesisStudy
        Of `thesis_study`.

    Returns
    -------
    figure : matplotlib Figure
        One panel for each model and altitude.

    References
    ----------
    Bramstång 2015, Eqs. 7.34-7.36 and Tables 2 and 3.
    """
    figure = new_figure("Flutter with oscillatory derivatives held at one reduced frequency", 2, 2, width=5.4)
    cases = list(dict.fromkeys((held.altitude, held.model) for held in study.held))
    for ax, (altitude, model) in zip(figure.axes, cases):
        mine = [held for held in study.held if (held.altitude, held.model) == (altitude, model)]
        _panel_fixed_k(ax, mine)
        ax.set_title(f"{model}, {altitude:g} m: the thesis prints {mine[0].printed} m/s", fontsize="small")
    shared_legend(figure, columns=2)
    return figure


def _panel_fixed_k(ax: Any, mine: list[Held]) -> None:
    """One model at one altitude."""
    printed = mine[0].printed
    ax.axhspan(
        printed - 0.5, printed + 0.5, facecolor=UNSTABLE, alpha=0.35, linewidth=0.0,
        label="rounds to the number that the thesis prints",
    )  # fmt: skip
    for j, held in enumerate(mine):
        curve, colour = held.curve, COLOURS[j]
        name = {"a_w": r"$a_1 = a_w = 3$", "2 pi": r"$a_1 = 2\pi$"}[held.slope]
        for real, dashes, words in ((False, "-", name), (True, ":", f"{name}, a real root is unstable as well")):
            k, V = _broken(curve.k, curve.flutter_speed, curve.joined, curve.real_unstable == real)
            ax.plot(k, V, color=colour, linestyle=dashes, linewidth=1.7, label=words)
        if held.own_k is not None and held.own_speed is not None:
            ax.plot(
                held.own_k, held.own_speed, "o", color=colour, markeredgecolor="black", markersize=7, zorder=5,
                label=f"{name}: Theodorsen p-k, consistent k",
            )  # fmt: skip
    if not any(finite(held.curve.flutter_speed) for held in mine):
        nothing_to_show(ax, "no flutter at any k")
    ax.set_xscale("log")
    ax.set_xlim(mine[0].curve.k[0], mine[0].curve.k[-1])
    ax.set_xlabel(r"reduced frequency $k=\omega b/V$ of the held derivatives")
    ax.set_ylabel("flutter speed, m/s")


def _broken(k: Any, V: Any, joined: Any, wanted: Any) -> tuple[Any, Any]:
    """Points of the segments that are wanted and do not jump to another branch, with gaps between."""
    xs, ys = [], []
    for i in np.flatnonzero(joined & (wanted[:-1] | wanted[1:]) & wanted[1:]):
        xs += [k[i], k[i + 1], np.nan]
        ys += [V[i], V[i + 1], np.nan]
    return np.array(xs), np.array(ys)
