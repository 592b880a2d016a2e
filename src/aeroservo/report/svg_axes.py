"""Axes of a drawn chart: ranges, round ticks, and from numbers to places on the paper."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.report.blocks import Chart

Array = NDArray[Any]

#: Of one chart, in its own units (CSS pixels where it is as wide as it wants to be).
WIDTH, HEIGHT = 460.0, 300.0
LEFT, RIGHT, TOP, BOTTOM = 62.0, 12.0, 10.0, 44.0


@dataclass(frozen=True, kw_only=True)
class Axis:
    """One axis: values from low to high lie between two places.

    Attributes
    ----------
    low, high : float
        Range. [axis]
    start, end : float
        Their places. [px]
    log : bool
        Logarithmic.
    """

    low: float
    high: float
    start: float
    end: float
    log: bool = False

    def place(self, values: Array) -> Array:
        """Places of values. [px]"""
        v = np.asarray(values, dtype=float)
        if self.log:
            with np.errstate(divide="ignore", invalid="ignore"):
                v = np.where(v > 0.0, np.log10(np.where(v > 0.0, v, 1.0)), np.nan)
            low, high = np.log10(self.low), np.log10(self.high)
        else:
            low, high = self.low, self.high
        return self.start + (v - low) / (high - low) * (self.end - self.start)

    def ticks(self) -> list[float]:
        """Round values in the range, five or so. [axis]"""
        return log_ticks(self.low, self.high) if self.log else round_ticks(self.low, self.high)


def round_ticks(low: float, high: float, wanted: int = 6) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten inside a range.

    Parameters
    ----------
    low, high : float
        The range. [axis]
    wanted : int
        About how many.

    Returns
    -------
    ticks : list of float
        Ascending. [axis]
    """
    raw = (high - low) / wanted
    power = 10.0 ** np.floor(np.log10(raw))
    step = power * min((1.0, 2.0, 5.0, 10.0), key=lambda m: abs(np.log(m * power / raw)))
    first, last = int(np.ceil(low / step - 1e-9)), int(np.floor(high / step + 1e-9))
    return [0.0 if k == 0 else float(f"{k * step:.12g}") for k in range(first, last + 1)]


def log_ticks(low: float, high: float) -> list[float]:
    """Powers of ten inside a range; with 2 and 5 where there are few.

    Parameters
    ----------
    low, high : float
        The range, positive. [axis]

    Returns
    -------
    ticks : list of float
        Ascending. [axis]
    """
    first, last = int(np.floor(np.log10(low))), int(np.ceil(np.log10(high)))
    mantissas = (1.0,) if last - first > 3 else (1.0, 2.0, 5.0)
    step = max(1, (last - first) // 7)
    values = [m * 10.0**p for p in range(first, last + 1, step) for m in mantissas]
    return [v for v in values if low * (1.0 - 1e-9) <= v <= high * (1.0 + 1e-9)]


def axes_of(chart: Chart) -> tuple[Axis, Axis]:
    """Both axes of a chart.

    Parameters
    ----------
    chart : Chart
        Any.

    Returns
    -------
    x, y : Axis
        Never empty.
    """
    x_low, x_high = _range(chart, "x")
    y_low, y_high = _range(chart, "y")
    wide, high = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM
    if chart.equal and not (chart.x_log or chart.y_log):
        per_pixel = max((x_high - x_low) / wide, (y_high - y_low) / high)
        x_low, x_high = _widened(x_low, x_high, per_pixel * wide)
        y_low, y_high = _widened(y_low, y_high, per_pixel * high)
    top, bottom = (HEIGHT - BOTTOM, TOP) if chart.y_down else (TOP, HEIGHT - BOTTOM)
    x = Axis(low=x_low, high=x_high, start=LEFT, end=WIDTH - RIGHT, log=chart.x_log)
    return x, Axis(low=y_low, high=y_high, start=bottom, end=top, log=chart.y_log)


def _widened(low: float, high: float, length: float) -> tuple[float, float]:
    middle = 0.5 * (low + high)
    return middle - 0.5 * length, middle + 0.5 * length


def _range(chart: Chart, axis: str) -> tuple[float, float]:
    """Range of one axis: as asked for, else what the curves and the marks across it need, with room."""
    given = chart.x_range if axis == "x" else chart.y_range
    log = chart.x_log if axis == "x" else chart.y_log
    values = [getattr(s, axis) for s in chart.series]
    if axis == "y":
        values = [_inside(s.x, s.y, chart.x_range) for s in chart.series]
        values += [np.array([m.at]) for m in chart.marks if m.axis == "y"]
    flat = np.concatenate([np.asarray(v, dtype=float) for v in values]) if values else np.zeros(0)
    flat = flat[np.isfinite(flat) & ((flat > 0.0) | (not log))]
    low, high = (float(flat.min()), float(flat.max())) if flat.size else (1.0, 10.0) if log else (0.0, 1.0)
    if given is not None:
        low, high = given
    elif axis == "y" and not log:
        room = 0.06 * (high - low)
        low, high = low - room * (low != 0.0), high + room
    return _not_empty(low, high, log)


def _inside(x: Array, y: Array, limits: tuple[float, float] | None) -> Array:
    """Values of a curve inside the range of x."""
    return y if limits is None else y[(x >= limits[0]) & (x <= limits[1])]


def _not_empty(low: float, high: float, log: bool) -> tuple[float, float]:
    """A range that has a length, far above rounding."""
    if log:
        low, high = max(low, 1e-300), max(high, 1e-300)
        return (low / 1.5, high * 1.5) if high < 1.001 * low else (low, high)
    least = max(1e-9 * max(abs(low), abs(high)), 1e-300)
    if high - low < least:
        half = 0.5 * max(abs(low), abs(high)) or 0.5
        return low - half, high + half
    return low, high
