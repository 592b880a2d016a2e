"""Charts of the studio as options of ECharts: data only, every text drawn literally."""

from __future__ import annotations

from typing import Any

import numpy as np

from aeroservo.datatypes import Array
from aeroservo.report.style import COLOURS, UNSTABLE
from aeroservo.studio.analysis import Analysis, Curves, Speed
from aeroservo.studio.flight import Run

_DASHES: tuple[Any, ...] = ("solid", "dashed", "dotted", [8, 3, 2, 3], [12, 4])
_BEFORE = "#909090"
#: Damping ratios beyond these are left to zooming: what matters lies near zero.
_ZETA = (-0.3, 0.5)


def frequency_chart(now: Analysis, before: Analysis | None, *, dark: bool = False) -> dict[str, Any]:
    """Frequency against airspeed, the file's curves grey behind.

    Parameters
    ----------
    now, before : Analysis
        Of the edited model, and of the file.
    dark : bool
        Whether the page is dark.

    Returns
    -------
    options : dict
        Of ECharts. [m/s, Hz]

    References
    ----------
    contract.md, "flutter".

    Examples
    --------
    >>> empty = Analysis(name="", kind="", heading="", speeds=())
    >>> frequency_chart(empty, None)["yAxis"]["name"]
    'frequency, Hz'
    """
    return _over_speed(now, before, "frequency", "frequency, Hz", dark)


def damping_chart(now: Analysis, before: Analysis | None, *, dark: bool = False) -> dict[str, Any]:
    """Damping ratio against airspeed, the file's curves grey behind; unstable below zero.

    Parameters
    ----------
    now, before : Analysis
        Of the edited model, and of the file.
    dark : bool
        Whether the page is dark.

    Returns
    -------
    options : dict
        Of ECharts. [m/s, -]

    References
    ----------
    contract.md, "flutter".

    Examples
    --------
    >>> empty = Analysis(name="", kind="", heading="", speeds=())
    >>> damping_chart(empty, None)["yAxis"]["name"]
    'damping ratio, stable above 0'
    """
    options = _over_speed(now, before, "damping", "damping ratio, stable above 0", dark)
    values = [c.damping for c in (now.curves, None if before is None else before.curves) if c is not None]
    seen = np.concatenate([v[np.isfinite(v)] for v in values]) if values else np.zeros(0)
    low, high = (float(seen.min()), float(seen.max())) if seen.size else (-0.1, 0.1)
    options["yAxis"] |= {"min": _rounded(max(low, _ZETA[0]), -1), "max": _rounded(min(high, _ZETA[1]), 1)}
    options["series"].append(
        {
            "type": "line", "name": "unstable", "data": [], "silent": True,
            "markArea": {
                "silent": True, "itemStyle": {"color": UNSTABLE, "opacity": 0.12},
                "data": [[{"yAxis": 0}, {"yAxis": options["yAxis"]["min"]}]],
            },
        }
    )  # fmt: skip
    return options


def history_chart(run: Run, channel: int, before: Run | None, *, dark: bool = False) -> dict[str, Any]:
    """One channel against time, the run before it grey behind.

    Parameters
    ----------
    run : Run
        A flight.
    channel : int
        Number of its channel.
    before : Run, optional
        Another.
    dark : bool
        Whether the page is dark.

    Returns
    -------
    options : dict
        Of ECharts. [s, unit of the channel]

    References
    ----------
    contract.md, `simulate`.

    Examples
    --------
    >>> flown = Run(name="", flight=None, t=np.zeros(1), data=np.zeros((1, 1)), channels=("pitch_rad",), units=("rad",),
    ...             peak=(0.0,), rms=(0.0,), facts=(), notes=(), csv=b"")
    >>> history_chart(flown, 0, None)["yAxis"]["name"]
    'pitch, rad'
    """
    name, unit = run.channels[channel], run.units[channel]
    label = channel_label(name, unit)
    options = _frame("time, s", label, dark)
    options["xAxis"] |= {"min": 0, "max": _rounded(float(run.t[-1]), 1)}
    options["legend"]["show"] = False
    options["grid"]["bottom"] = 30
    if before is not None and name in before.channels:
        old = before.data[:, before.channels.index(name)]
        options["series"].append(_line("the run before", before.t, old, _BEFORE, "dashed", 1.0))
    options["series"].append(_line("this run", run.t, run.data[:, channel], COLOURS[0], "solid", 1.5))
    return options


def channel_label(name: str, unit: str) -> str:
    """A channel in words, with its unit.

    Parameters
    ----------
    name, unit : str
        As in a history.

    Returns
    -------
    label : str
        For people.

    References
    ----------
    contract.md, `simulate`.

    Examples
    --------
    >>> channel_label("elevon_command_rad", "rad")
    'elevon command, rad'
    """
    suffix = "_" + unit.replace("^", "").replace("/", "_").replace(" ", "_") if unit else ""
    bare = name.removesuffix(suffix) if suffix else name
    return f"{bare.replace('_', ' ')}{', ' + unit if unit else ''}"


def _over_speed(now: Analysis, before: Analysis | None, what: str, label: str, dark: bool) -> dict[str, Any]:
    options = _frame("true airspeed, m/s", label, dark)
    if before is not None and before.curves is not None:
        for j in range(len(before.curves.names)):
            options["series"].append(_branch(before.curves, j, what, _BEFORE, "dashed", 1.2, "the file's"))
    if now.curves is not None:
        for j, name in enumerate(now.curves.names):
            colour, dash = COLOURS[j % len(COLOURS)], _DASHES[j // len(COLOURS) % len(_DASHES)]
            if dark and colour == "#000000":
                colour = "#FFFFFF"
            options["series"].append(_branch(now.curves, j, what, colour, dash, 2.0, name))
        V = now.curves.V
        options["xAxis"] |= {"min": float(np.nanmin(V)), "max": float(np.nanmax(V))}
        options["series"].extend(_marks(now.speeds, float(np.nanmax(V)), dark))
    options["legend"]["data"] = list(dict.fromkeys(s["name"] for s in options["series"] if s["data"]))[:24]
    return options


def _branch(curves: Curves, j: int, what: str, colour: str, dash: Any, width: float, name: str) -> dict[str, Any]:
    return _line(name, curves.V[:, j], getattr(curves, what)[:, j], colour, dash, width)


def _line(name: str, x: Array, y: Array, colour: str, dash: Any, width: float) -> dict[str, Any]:
    return {
        "type": "line",
        "name": name,
        "data": [[float(f"{a:.6g}"), float(f"{b:.5g}") if np.isfinite(b) else None] for a, b in zip(x, y)],
        "showSymbol": False,
        "lineStyle": {"color": colour, "type": dash, "width": width},
        "itemStyle": {"color": colour},
        "sampling": "minmax",
        "animation": False,
    }


def _marks(speeds: tuple[Speed, ...], top: float, dark: bool) -> list[dict[str, Any]]:
    """Vertical lines at the speeds that matter."""
    looks = (
        ("solid", UNSTABLE, "insideEndTop"),
        ("dashed", "#CC79A7", "insideEndTop"),
        ("dotted", "#56B4E9", "insideStartTop"),
    )
    series = []
    for i, (speed, (dash, colour, where)) in enumerate(zip(speeds, looks)):
        if speed.value is None or speed.value > top:
            continue
        mark = {
            "symbol": "none", "silent": True, "lineStyle": {"type": dash, "color": colour, "width": 1.5},
            "label": {"formatter": speed.name, "color": _ink(dark), "fontSize": 11, "position": where},
            "data": [{"xAxis": speed.value}],
        }  # fmt: skip
        series.append({"type": "line", "name": f"mark {i}", "data": [], "markLine": mark, "silent": True})
    return series


def _frame(x: str, y: str, dark: bool) -> dict[str, Any]:
    ink, grid = _ink(dark), "#444444" if dark else "#DDDDDD"
    axis: dict[str, Any] = {
        "type": "value", "nameTextStyle": {"color": ink}, "axisLabel": {"color": ink, "hideOverlap": True},
        "axisLine": {"show": True, "lineStyle": {"color": ink}}, "splitLine": {"lineStyle": {"color": grid}},
    }  # fmt: skip
    return {
        "animation": False,
        "backgroundColor": "transparent",
        "aria": {"enabled": True},
        "grid": {"left": 8, "right": 18, "top": 34, "bottom": 56, "containLabel": True},
        "legend": {"type": "scroll", "bottom": 0, "textStyle": {"color": ink}, "data": []},
        "tooltip": {"trigger": "axis", "renderMode": "richText", "confine": True},
        "dataZoom": [{"type": "inside", "zoomOnMouseWheel": "ctrl", "moveOnMouseWheel": False}],
        "xAxis": axis | {"name": x, "nameLocation": "middle", "nameGap": 26},
        "yAxis": axis | {"name": y, "nameTextStyle": {"color": ink, "align": "left"}, "scale": True},
        "series": [],
    }


def _ink(dark: bool) -> str:
    return "#DDDDDD" if dark else "#333333"


def _rounded(value: float, direction: int) -> float:
    """The next round number up (1) or down (-1)."""
    if value == 0.0 or not np.isfinite(value):
        return 0.0
    step = 10.0 ** np.floor(np.log10(abs(value))) / 10.0
    return float(f"{(np.ceil if direction > 0 else np.floor)(value / step) * step:.6g}")
