"""Figure of what a controller does to a wing: margins against speed, against delay, zeros of what it reads."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.report.style import MARK, new_figure, nothing_to_show, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from aeroservo.studies.controller_check import ControllerCheck

#: Curves against delay, at most.
CURVES = 6


def margins_figure(check: ControllerCheck, title: str) -> Figure:
    """Four panels: gain and phase margin of every loop, disk margins, margin against delay, right-half-plane zeros.

    Parameters
    ----------
    check : ControllerCheck
        Of `controller_check`. [SI]
    title : str
        Above the figure.

    Returns
    -------
    figure : matplotlib Figure
        For `figures.as_bytes`.
    """
    figure = new_figure(title, 2, 2, width=5.2, height=3.6)
    V = check.condition.V
    gain, disk, delay, zeros = figure.axes
    _classical(gain, check)
    for j, (name, margins) in enumerate(
        (("all inputs", check.inputs), ("all outputs", check.outputs), ("both at once", check.both))
    ):
        disk.plot(V, [m.alpha for m in margins], **style(j), label=name)
    disk.axhline(2.0 * math.tan(math.pi / 8.0), color=MARK, linewidth=0.9)
    disk.text(V[0], 2.0 * math.tan(math.pi / 8.0), " 6 dB and 45 deg", va="bottom", fontsize="small", color=MARK)
    disk.set_ylabel(r"disk margin $\alpha$ (0: unstable)")
    disk.set_ylim(0.0, 2.05)
    chosen = sorted({round(x) for x in np.linspace(0, len(V) - 1, CURVES)})
    for j, i in enumerate(chosen):
        delay.plot(1e3 * check.delays.delays, check.delays.alpha[i], marker="o", markersize=3, **style(j),
                   label=f"{V[i]:.4g} m/s")  # fmt: skip
    delay.axvline(1e3 * check.own_delay, color=MARK, linestyle=(0, (1, 1.5)), label="delay as it is")
    delay.set_xlabel("total delay, ms")
    delay.set_ylabel(r"disk margin $\alpha$ at the inputs")
    delay.set_ylim(bottom=0.0)
    _zeros(zeros, check)
    for ax in (gain, disk, zeros):
        ax.set_xlabel("true airspeed, m/s")
        ax.set_xlim(float(V[0]), float(V[-1]))
    for ax in (gain, disk, delay, zeros):
        if ax.get_legend_handles_labels()[0]:
            ax.legend(fontsize="small", loc="best")
    return figure


def _classical(ax: Axes, check: ControllerCheck) -> None:
    """Gain margins in dB on the left axis, phase margin on the right, of the loops at the plant's inputs."""
    V = check.condition.V
    right: Any = ax.twinx()
    drawn = False
    for j in [j for j, m in enumerate(check.loops[0]) if m.at == "input"]:
        up, down, phase = (
            np.array([_number(getattr(row[j], name)) for row in check.loops])
            for name in ("gain_up", "gain_down", "phase")
        )
        with np.errstate(divide="ignore"):
            up, down = 20.0 * np.log10(up), 20.0 * np.log10(down)
        name = "" if sum(m.at == "input" for m in check.loops[0]) == 1 else f" of {check.loops[0][j].channel}"
        for values, text, k in ((up, "gain up", 0), (down, "gain down", 1)):
            finite = np.where(np.isfinite(values), values, np.nan)
            drawn |= bool(np.isfinite(finite).any())
            ax.plot(V, finite, **style(3 * j + k), label=f"{text}{name}, dB")
        ax.plot([], [], **style(3 * j + 2), label=f"phase{name}, deg (right)")
        right.plot(V, np.degrees(np.where(np.isfinite(phase), phase, np.nan)), **style(3 * j + 2))
        drawn |= bool(np.isfinite(phase).any())
    ax.axhline(0.0, color="0.6", linewidth=0.8)
    ax.set_ylabel("gain margins, dB (none: no limit, or unstable)")
    right.set_ylabel("phase margin, deg")
    right.set_ylim(0.0, 180.0)
    if not drawn:
        nothing_to_show(ax, "no loop has a crossover")


def _zeros(ax: Axes, check: ControllerCheck) -> None:
    """Real part of the largest zero in the right half plane of each channel."""
    V = check.condition.V
    drawn = False
    for j, curve in enumerate(check.zeros):
        if np.isfinite(curve.right).any():
            ax.plot(V, curve.right, marker=".", **style(j), label=curve.sensor)
            drawn = True
    if not drawn:
        nothing_to_show(ax, "every channel that is read is minimum phase here")
    ax.set_ylabel("largest right-half-plane zero, 1/s")


def _number(value: float | None) -> float:
    return math.nan if value is None else value
