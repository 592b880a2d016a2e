"""Figures of time histories: plunge, pitch, elevon, gust, speed, altitude over time, as the thesis' Figs. 31 to 36."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.report.style import literal, new_figure, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from aeroservo.simulate.history import TimeHistory

#: Channels drawn, in this order, as far as they are there and move: name, label, factor.
PANELS = (
    ("plunge_m", "plunge (down), m", 1.0),
    ("pitch_rad", "pitch (nose up), deg", 180.0 / np.pi),
    ("elevon_rad", "elevon (trailing edge down), deg", 180.0 / np.pi),
    ("gust_m_s", "gust (up), m/s", 1.0),
    ("speed_m_s", "airspeed, m/s", 1.0),
    ("altitude_m", "altitude, m", 1.0),
)


def plot_channel(history: TimeHistory, channel: str, ax: Axes, *, label: str = "", factor: float = 1.0) -> None:
    """One channel over time.

    Parameters
    ----------
    history : TimeHistory
        The run.
    channel : str
        Which.
    ax : matplotlib Axes
        Drawn into.
    label : str
        Of the vertical axis; by default name and unit.
    factor : float
        Multiplies the values. [-]
    """
    ax.plot(history.t, factor * history[channel], linewidth=0.9, color=style(0)["color"])
    unit = history.units[history.channels.index(channel)]
    ax.set_ylabel(label or literal(f"{channel}, {unit}" if unit else channel), fontsize="small")
    ax.set_xlim(history.t[0], max(history.t[-1], history.t[0] + 1e-9))
    for event in history.events:
        ax.axvline(event.t, color="black", linewidth=0.8, linestyle=":")


def shown_panels(history: TimeHistory) -> list[str]:
    """Channels that have a panel: the usual ones that are there and move; of other models their own coordinates.

    Parameters
    ----------
    history : TimeHistory
        The run.

    Returns
    -------
    channels : list of str
        Names, from the top.
    """
    named = [name for name, _, _ in PANELS]
    shown = [
        name for name in named if name in history.channels and (np.ptp(history[name]) > 0.0 or name == "pitch_rad")
    ]
    if not {"plunge_m", "pitch_rad"} & set(shown):
        others = [c for c in history.channels if "_rate" not in c and c not in named and "command" not in c]
        shown = others[:4] + shown
    return shown


def history_figure(history: TimeHistory, title: str, *, axes: Sequence[Axes] | None = None) -> Figure:
    """A panel for each of the usual channels that are there and move; for other models their own coordinates.

    Parameters
    ----------
    history : TimeHistory
        The run.
    title : str
        Above the panels.
    axes : sequence of matplotlib Axes, optional
        To draw into, one for each of `shown_panels`; default a new figure.

    Returns
    -------
    figure : matplotlib Figure
        Time in seconds to the right; events as dotted lines, named below.
    """
    named = {name: (label, factor) for name, label, factor in PANELS}
    shown = shown_panels(history)
    if axes is None:
        axes = new_figure(title, len(shown), 1, width=7.0, height=1.7).axes
    figure: Any = axes[0].figure
    for ax, name in zip(axes, shown):
        label, factor = named.get(name, ("", 1.0))
        plot_channel(history, name, ax, label=label, factor=factor)
        ax.tick_params(labelbottom=ax is axes[-1])
    below = "time, s"
    if history.events:
        below += "   (dotted: " + "; ".join(f"{event.t:.4g} s, {event.text}" for event in history.events) + ")"
    axes[-1].set_xlabel(literal(below))
    figure.align_ylabels(list(axes))
    return figure
