"""Figure of a flutter boundary over one or two numbers of the model file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from aeroservo.studies.boundary import Over, Point


def boundary_figure(over: tuple[Over, ...], points: tuple[Point, ...], title: str) -> Figure:
    """Flutter and divergence speed over one field as curves, flutter speed over two as filled contours.

    Parameters
    ----------
    over : tuple of Over, length 1 or 2
        What varied.
    points : tuple of Point
        Of `flutter_boundary`. [m/s]
    title : str
        Above the figure.

    Returns
    -------
    figure : matplotlib Figure
        For `figures.as_bytes`; where nothing was found in the range of speeds it is left white.
    """
    from matplotlib.figure import Figure as NewFigure

    figure = NewFigure(figsize=(7.0, 4.6), layout="constrained")
    ax: Any = figure.subplots()
    figure.suptitle(title.replace("$", r"\$"), fontsize="medium")
    flutter = np.array([np.nan if p.flutter_speed is None else p.flutter_speed for p in points])
    if len(over) == 1:
        divergence = [np.nan if p.divergence_speed is None else p.divergence_speed for p in points]
        ax.plot(over[0].values, flutter, label="flutter")
        ax.plot(over[0].values, divergence, "--", label="divergence (static)")
        ax.set_ylabel("true airspeed, m/s")
        ax.grid(visible=True, linewidth=0.3)
        ax.legend(loc="best", fontsize="small")
    else:
        shape = (len(over[0].values), len(over[1].values))
        if np.isfinite(flutter).any() and min(shape) > 1:
            filled = ax.contourf(over[0].values, over[1].values, np.ma.masked_invalid(flutter.reshape(shape).T), 16)
            figure.colorbar(filled, ax=ax, label="flutter speed, m/s")
        ax.set_ylabel(over[1].field)
    ax.set_xlabel(over[0].field)
    return figure
