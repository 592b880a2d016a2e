"""Tornado chart: which numbers of a model file move a speed most."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from aeroservo.aeroelastic.sensitivity import Sensitivity

SPEEDS = ("flutter", "divergence", "reversal")
"""Speeds that a chart may show, in this order."""


def tornado_figure(found: tuple[Sensitivity, ...], title: str, *, most: int = 12) -> Figure:
    """Change of each speed, in per cent, for one per cent more of each number; the largest on top.

    Parameters
    ----------
    found : tuple of Sensitivity
        Of `aeroservo.aeroelastic.sensitivity.sensitivities`.
    title : str
        Above the figure.
    most : int
        Bars in each panel.

    Returns
    -------
    figure : matplotlib Figure
        For `figures.as_bytes`. Numbers that are zero have no relative change and no bar.
    """
    from matplotlib.figure import Figure as NewFigure

    shown = [name for name in SPEEDS if any(getattr(one, f"relative_{name}") is not None for one in found)]
    panels = shown or ["flutter"]
    figure = NewFigure(figsize=(6.4 * len(panels), 1.2 + 0.3 * most), layout="constrained")
    axes: Any = figure.subplots(1, len(panels), squeeze=False)[0]
    figure.suptitle(title.replace("$", r"\$"), fontsize="medium")
    for ax, name in zip(axes, panels):
        bars = [(getattr(one, f"relative_{name}") or 0.0, one.field) for one in found]
        bars = sorted((bar for bar in bars if abs(bar[0]) > 1e-9), key=lambda bar: abs(bar[0]))[-most:]
        values = [value for value, _ in bars]
        places = range(len(bars))
        ax.barh(places, values, color=["tab:blue" if value > 0.0 else "tab:red" for value in values])
        ax.set_yticks(places, [field.replace("$", r"\$") for _, field in bars], fontsize="small")
        ax.axvline(0.0, color="black", linewidth=0.8)
        ax.grid(visible=True, axis="x", linewidth=0.3)
        largest = max((abs(value) for value in values), default=1.0)
        ax.set_xlim(-1.15 * largest, 1.15 * largest)
        ax.set_xlabel(f"change of {name} speed, %, for 1 % more of the number")
        if not bars:
            ax.text(0.0, 0.5, f"no {name} speed in the range", ha="center", transform=ax.get_xaxis_transform())
            ax.set_yticks([])
    return figure
