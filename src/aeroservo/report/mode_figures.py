"""Figures of natural modes: shapes along the span, or bars where there is no span."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.report.style import literal, new_figure, shared_legend, style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from aeroservo.datatypes import ModalModel
    from aeroservo.structure.modal import NaturalModes


def plot_modes(modes: ModalModel, natural: NaturalModes, *, title: str = "", most: int = 5) -> Figure:
    """Deflection and twist along the span of each natural mode; bars of the coordinates where there is no span.

    Parameters
    ----------
    modes : ModalModel
        The structure.
    natural : NaturalModes
        Of `aeroservo.natural_modes`.
    title : str
        Above the figure.
    most : int
        Modes shown.

    Returns
    -------
    figure : matplotlib Figure
        For `as_bytes` or `write_figure`.
    """
    shown = min(most, len(natural.omega))
    labels = [f"{literal(natural.names[j])}, {natural.omega[j] / (2.0 * np.pi):.4g} Hz" for j in range(shown)]
    phi, grid = np.asarray(modes.phi), np.asarray(modes.grid)
    if len(grid) < 3:
        return _mode_bars(modes, natural, labels, title)
    figure = new_figure(title, 1, 2, width=5.2)
    axes: Any = figure.axes
    order = np.argsort(grid[:, 1], kind="stable")
    shapes = phi[order] @ natural.shapes[:, :shown]
    y = grid[order, 1]
    wide = float(np.ptp(y)) or 1.0
    for j in range(shown):
        deflection, twist = shapes[:, 2, j], shapes[:, 4, j]
        largest = max(np.abs(deflection).max(), 0.25 * wide * np.abs(twist).max()) or 1.0
        sign = np.sign(deflection[-1] if abs(deflection[-1]) > 1e-6 * largest else twist[-1]) or 1.0
        for ax, part in zip(axes, (deflection, twist)):
            ax.plot(y, sign * part / largest, label=labels[j], marker="." if len(y) < 16 else "", **style(j))
    axes[0].set_ylabel("deflection up, m per m")
    axes[1].set_ylabel("twist nose up, rad per m")
    for ax in axes:
        ax.axhline(0.0, color="black", linewidth=0.8)
        ax.set_xlabel("spanwise position y, m")
    shared_legend(figure)
    return figure


def _mode_bars(modes: ModalModel, natural: NaturalModes, labels: Sequence[str], title: str) -> Figure:
    """Part of each coordinate in each mode."""
    figure = new_figure(title, 1, 1, width=6.0)
    ax: Any = figure.axes[0]
    places, shown = np.arange(modes.n), len(labels)
    for j, label in enumerate(labels):
        ax.bar(
            places + 0.8 * j / shown - 0.4, natural.shapes[:, j], 0.8 / shown, align="edge", label=label,
            color=style(j)["color"],
        )  # fmt: skip
    units = getattr(modes, "units", None) or ("",) * modes.n
    ax.set_xticks(places, [literal(f"{name} [{unit}]" if unit else name) for name, unit in zip(modes.names, units)])
    ax.set_ylabel("part of each coordinate, largest 1")
    ax.axhline(0.0, color="black", linewidth=0.8)
    shared_legend(figure)
    return figure


def modes_figure(modes: ModalModel, natural: NaturalModes, title: str, *, most: int = 5) -> Figure:
    """`plot_modes` with its title first.

    Parameters
    ----------
    modes : ModalModel
        The structure.
    natural : NaturalModes
        Of `aeroservo.natural_modes`.
    title : str
        Above the figure.
    most : int
        Modes shown.

    Returns
    -------
    figure : matplotlib Figure
        For `as_bytes` or `write_figure`.
    """
    return plot_modes(modes, natural, title=title, most=most)
