"""Figures of damping surfaces: the thesis' Figs. 29 and 30 as filled contours, the flutter boundary drawn on them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from aeroservo.studies.surface import DampingSurface


def surface_figure(surface: DampingSurface, title: str, *, modes: tuple[str, ...] = ()) -> Figure:
    """Damping ratio over speed and the number that varies, one panel for each mode.

    Parameters
    ----------
    surface : DampingSurface
        Of `aeroservo.studies.surface.damping_surface`.
    title : str
        Above the figure.
    modes : tuple of str
        Which modes; default the first two.

    Returns
    -------
    figure : matplotlib Figure
        For `figures.as_bytes`. Blue is damped, red unstable, white neutral; the scale is the same on all panels.
    """
    from matplotlib.figure import Figure as NewFigure

    shown = modes or surface.names[:2]
    figure = NewFigure(figsize=(5.6 * len(shown), 4.4), layout="constrained")
    axes: Any = figure.subplots(1, len(shown), squeeze=False, sharey=True)[0]
    figure.suptitle(title.replace("$", r"\$"), fontsize="medium")
    values = np.array(surface.over.values)
    columns = [surface.names.index(name) for name in shown]
    chosen = surface.damping_ratio[..., columns]
    swinging = np.abs(chosen[np.abs(chosen) < 0.999])  # aperiodic roots have a damping ratio of 1 or -1
    largest = float(np.percentile(swinging, 98.0)) if swinging.size else 1.0
    levels = np.linspace(-largest, largest, 25)
    filled = None
    for ax, name, j in zip(axes, shown, columns):
        damping = np.ma.masked_invalid(surface.damping_ratio[..., j])
        if min(damping.shape) > 1:
            filled = ax.contourf(surface.V, values, damping, levels, cmap="RdBu", extend="both")
            ax.contour(surface.V, values, damping, [0.0], colors="black", linewidths=0.8)
        ax.plot(surface.flutter_speed, values, "k-.", linewidth=1.4, label="flutter")
        ax.plot(surface.divergence_speed, values, "k--", linewidth=1.0, label="divergence (static)")
        ax.set_xlim(surface.V[0], surface.V[-1])
        if values.size > 1:
            ax.set_ylim(values[0], values[-1])
        ax.set_title(name.replace("$", r"\$"), fontsize="medium")
        ax.set_xlabel("true airspeed, m/s")
    axes[0].set_ylabel(surface.over.field)
    axes[0].legend(loc="upper left", fontsize="small")
    if filled is not None:
        figure.colorbar(filled, ax=list(axes), label=r"damping ratio $\zeta$ (positive: stable)")
    return figure
