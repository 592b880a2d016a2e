"""Figures of flutter, statics and modes: functions from a result to matplotlib axes, without a screen.

Damping is drawn as the damping ratio zeta = -Re(lambda)/|lambda|, positive stable; a second scale holds the thesis'
100 Re(lambda)/|lambda| in per cent, positive unstable, and each scale says which it is.
"""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from aeroservo.aeroelastic.flutter import FlutterResult
    from aeroservo.aeroelastic.static import StaticResult
    from aeroservo.datatypes import ModalModel
    from aeroservo.structure.modal import NaturalModes

_GREY = "0.6"


def plot_frequency(result: FlutterResult, ax: Axes) -> None:
    """Frequency of every mode against speed.

    Parameters
    ----------
    result : FlutterResult
        Of `aeroservo.flutter`.
    ax : matplotlib Axes
        Drawn into.
    """
    for j, name in enumerate(result.names):
        ax.plot(result.speeds[:, j], result.frequency[:, j] / (2.0 * np.pi), label=_text(name))
    _mark(result, ax)
    _range(result, ax)
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
    for j, name in enumerate(result.names):
        ax.plot(result.speeds[:, j], result.damping_ratio[:, j], label=_text(name))
    ax.axhline(0.0, color="black", linewidth=0.8)
    _mark(result, ax)
    _range(result, ax)
    ax.set_ylim(max(-1.05, ax.get_ylim()[0]), min(1.05, ax.get_ylim()[1]))
    ax.set_ylabel(r"damping ratio $\zeta$ (positive: stable)")
    percent = ax.secondary_yaxis("right", functions=(_to_percent, _to_percent_back))
    percent.set_ylabel(r"thesis: 100 Re $\lambda$/|$\lambda$|, % (positive: flutter)")


def plot_root_locus(result: FlutterResult, ax: Axes) -> None:
    """Roots in the complex plane as the speed grows, from open circle to dot.

    Parameters
    ----------
    result : FlutterResult
        Of `aeroservo.flutter`.
    ax : matplotlib Axes
        Drawn into.
    """
    for j, name in enumerate(result.names):
        root = result.roots[:, j]
        (line,) = ax.plot(root.real, root.imag, linewidth=1.0, label=_text(name))
        ends = np.flatnonzero(np.isfinite(root))
        if ends.size:
            first, last = root[ends[0]], root[ends[-1]]
            ax.plot(first.real, first.imag, "o", color=line.get_color(), fillstyle="none")
            ax.plot(last.real, last.imag, "o", color=line.get_color(), markersize=4)
    ax.axvline(0.0, color="black", linewidth=0.8)
    ax.set_xlabel(r"Re $\lambda$, 1/s (positive: unstable)")
    ax.set_ylabel(r"Im $\lambda$, rad/s")


def flutter_figure(result: FlutterResult, title: str) -> Figure:
    """Frequency and damping against speed, and the root locus.

    Damping away from the boundary is each method's own: the k method's is -g/2 of its artificial damping.

    Parameters
    ----------
    result : FlutterResult
        Of `aeroservo.flutter`.
    title : str
        Above the figure.

    Returns
    -------
    figure : matplotlib Figure
        For `as_bytes`.
    """
    figure = _figure(title, 3)
    axes: Any = figure.axes
    plot_frequency(result, axes[0])
    plot_damping(result, axes[1])
    plot_root_locus(result, axes[2])
    axes[0].legend(loc="best", fontsize="small")
    return figure


def static_figure(result: StaticResult, title: str) -> Figure:
    """Control effectiveness, twist and lift slope against speed.

    Parameters
    ----------
    result : StaticResult
        Of `aeroservo.static`.
    title : str
        Above the figure.

    Returns
    -------
    figure : matplotlib Figure
        For `as_bytes`.
    """
    figure = _figure(title, 2)
    axes: Any = figure.axes
    quantity = result.reversal_quantity or "no load"
    axes[0].plot(result.V, result.effectiveness, label=f"{quantity} per elevon, elastic/rigid")
    axes[0].plot(result.V, result.lift_slope_ratio, label="lift slope, elastic/rigid")
    axes[0].axhline(0.0, color="black", linewidth=0.8)
    axes[0].set_ylabel("ratio, elastic to rigid")
    axes[1].plot(result.V, result.twist, label="tip twist per radian of incidence")
    axes[1].set_ylabel("elastic twist per incidence, rad/rad")
    for ax in axes:
        _limit(ax)
        for speed, words in ((result.divergence.V, "divergence"), (result.reversal.V, "reversal")):
            if speed is not None and result.V[0] <= speed <= result.V[-1]:
                ax.axvline(speed, color=_GREY, linestyle="--" if words == "divergence" else ":", label=words)
        ax.set_xlabel("true airspeed, m/s")
        ax.legend(loc="best", fontsize="small")
    return figure


def modes_figure(modes: ModalModel, natural: NaturalModes, title: str, *, most: int = 5) -> Figure:
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
        For `as_bytes`.
    """
    shown = min(most, len(natural.omega))
    labels = [f"{natural.names[j]}, {natural.omega[j] / (2.0 * np.pi):.4g} Hz" for j in range(shown)]
    phi, grid = np.asarray(modes.phi), np.asarray(modes.grid)
    if len(grid) < 3:
        figure = _figure(title, 1)
        ax: Any = figure.axes[0]
        places = np.arange(modes.n)
        for j in range(shown):
            ax.bar(places + 0.8 * j / shown - 0.4, natural.shapes[:, j], 0.8 / shown, align="edge", label=labels[j])
        ax.set_xticks(places, [_text(name) for name in modes.names])
        ax.set_ylabel("part of each coordinate, largest 1")
        ax.legend(loc="best", fontsize="small")
        return figure
    figure = _figure(title, 2)
    axes: Any = figure.axes
    order = np.argsort(grid[:, 1], kind="stable")
    shapes = phi[order] @ natural.shapes[:, :shown]
    for j in range(shown):
        largest = np.abs(shapes[:, [2], j]).max() or 1.0
        axes[0].plot(grid[order, 1], shapes[:, 2, j] / largest, label=_text(labels[j]))
        axes[1].plot(grid[order, 1], shapes[:, 4, j] / largest, label=_text(labels[j]))
    axes[0].set_ylabel("deflection up, largest 1")
    axes[1].set_ylabel("twist nose up per deflection, rad/m")
    for ax in axes:
        ax.axhline(0.0, color="black", linewidth=0.8)
        ax.set_xlabel("y, m")
    axes[0].legend(loc="best", fontsize="small")
    return figure


def as_bytes(figure: Figure, ending: str) -> bytes:
    """A figure as the content of a file; the same figure gives the same bytes.

    Parameters
    ----------
    figure : matplotlib Figure
        Any.
    ending : str
        ".png" or ".pdf".

    Returns
    -------
    content : bytes
        To be written whole.

    Raises
    ------
    ValueError
        For another ending.
    """
    kind = ending.lower().lstrip(".")
    if kind not in ("png", "pdf"):
        raise ValueError(f"figures end in .png or .pdf, got {ending!r}")
    file = BytesIO()
    metadata: dict[str, Any] = {"CreationDate": None} if kind == "pdf" else {"Software": None}
    figure.savefig(file, format=kind, dpi=150, metadata=metadata)
    return file.getvalue()


def _figure(title: str, panels: int) -> Figure:
    """A figure with panels side by side."""
    from matplotlib.figure import Figure as NewFigure

    figure = NewFigure(figsize=(4.6 * panels, 4.2), layout="constrained")
    figure.subplots(1, panels)
    figure.suptitle(_text(title), fontsize="medium")
    for ax in figure.axes:
        ax.grid(visible=True, linewidth=0.3)
    return figure


def _to_percent(zeta: Any) -> Any:
    """The thesis' per cent of a damping ratio."""
    return -100.0 * zeta


def _to_percent_back(percent: Any) -> Any:
    """Damping ratio of the thesis' per cent."""
    return -0.01 * percent


def _mark(result: FlutterResult, ax: Any) -> None:
    """Flutter and divergence speeds as upright lines, named once."""
    for speed, style, words in (
        (result.flutter_speed, "-.", "flutter"),
        (result.divergence_speed, "--", "divergence (static)"),
    ):
        if speed is not None and result.V[0] <= speed <= result.V[-1]:
            ax.axvline(speed, color=_GREY, linestyle=style, linewidth=1.0, label=words)


def _range(result: FlutterResult, ax: Any) -> None:
    """The speeds of the sweep, and no others, whatever speeds the k method's curves reach."""
    ax.set_xlim(result.V[0], result.V[-1])
    ax.set_xlabel("true airspeed, m/s")


def _limit(ax: Any) -> None:
    """Curves that run to infinity at divergence are cut where they leave what matters."""
    low, high = ax.get_ylim()
    ax.set_ylim(max(low, -3.0), min(high, 6.0))


def _text(name: str) -> str:
    """Text that matplotlib takes literally."""
    return name.replace("\\", "\\\\").replace("$", r"\$") if "$" in name else name
