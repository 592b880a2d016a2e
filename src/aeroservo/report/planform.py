"""The aircraft in three views: from above, from the front, from starboard, with controls, mean chord and masses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.report.style import COLOURS, UNSTABLE, literal, shared_legend

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from aeroservo.aircraft.aircraft_schema import AircraftFile
    from aeroservo.aircraft.geometry import ControlSurface, LiftingSurface

#: Line of the wing's outline.
_EDGE = {"color": "black", "linewidth": 1.1}
_FILL = "0.9"
#: Colours of controls: all but that of the mean chord, and black.
_CONTROLS = (0, 1, 3, 4)


def planform_figure(model: AircraftFile, title: str) -> Figure:
    """Three views, each with equal scales.

    Parameters
    ----------
    model : AircraftFile
        The aircraft.
    title : str
        Above the figure.

    Returns
    -------
    figure : matplotlib Figure
        From above (starboard to the right, nose up), from the front as seen from behind, and from starboard; controls
        shaded, the mean chord of the first surface, reference point and centre of gravity marked.
    """
    from matplotlib.figure import Figure as NewFigure

    span, length, height = _extent(model)
    low = max(1.3 * height, 0.16 * span)
    figure = NewFigure(figsize=(10.5, 3.0 + 5.2 * (length + low) / (span + length)))
    figure.set_layout_engine("constrained", w_pad=0.1, h_pad=0.06)
    axes = figure.subplots(
        2, 2, width_ratios=(span, max(length, 0.42 * span)), height_ratios=(max(length, 0.3 * span), low)
    )
    (above, spare), (front, side) = axes
    spare.axis("off")
    names = [c.name for surface in model.surfaces() for c in surface.controls]
    colours = {name: COLOURS[_CONTROLS[k % len(_CONTROLS)]] for k, name in enumerate(names)}
    for surface in model.surfaces():
        for sign in (1.0, -1.0) if surface.mirrored else (1.0,):
            _surface(above, front, side, surface, sign, colours)
    _marks(above, front, side, model)
    _facts(spare, model)
    middle = _middle(model)
    for ax, across, up, name in (
        (above, "y (starboard), m", "x (aft), m", "from above"),
        (front, "y (starboard), m", "z (up), m", "from behind"),
        (side, "x (aft), m", "z (up), m", "from port"),
    ):
        if ax is not above:
            left = float(np.mean(ax.get_xlim()))
            ax.plot([left, left], [middle - 0.5 * low, middle + 0.5 * low], linestyle="none")  # room above and below
        ax.set_aspect("equal", adjustable="box" if ax is above else "datalim")
        ax.set_xlabel(across)
        ax.set_ylabel(up)
        ax.set_title(name, fontsize="small")
        ax.grid(visible=True, linewidth=0.3)
        ax.set_axisbelow(True)
        ax.locator_params(axis="y", nbins=4)
    above.invert_yaxis()
    figure.draw_without_rendering()  # the scales settle first, the places of their labels after that
    figure.suptitle(literal(title), fontsize="medium")
    shared_legend(figure)
    return figure


def _extent(model: AircraftFile) -> tuple[float, float, float]:
    """Span, length and height of everything [m]."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for surface in model.surfaces():
        edge = surface.leading_edge
        points = np.concatenate([edge, edge + np.stack([surface.chords, 0 * surface.chords, 0 * surface.chords], -1)])
        if surface.mirrored:
            points = np.concatenate([points, points * [1.0, -1.0, 1.0]])
        low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
    length, span, height = high - low
    return max(float(span), 1e-3), max(float(length), 1e-3), float(height)


def _middle(model: AircraftFile) -> float:
    """Height between the lowest and the highest leading edge [m]."""
    z = np.concatenate([s.leading_edge[:, 2] for s in model.surfaces()])
    return float(0.5 * (z.min() + z.max()))


def _surface(above: Any, front: Any, side: Any, surface: LiftingSurface, sign: float, colours: dict[str, str]) -> None:
    """One half of a surface in the three views."""
    edge, chord = surface.leading_edge, surface.chords
    x, y, z = edge.T
    y = sign * y
    drop = chord * np.tan(surface.twists)  # the chord of the file is streamwise, whatever the twist
    back = x + chord
    outline = np.concatenate([x, back[::-1], x[:1]]), np.concatenate([y, y[::-1], y[:1]])
    above.fill(outline[1], outline[0], facecolor=_FILL, edgecolor="none")
    closed = len(outline[0]) if y[0] != 0.0 or not surface.mirrored else -1  # no line where the halves meet
    above.plot(outline[1][:closed], outline[0][:closed], **_EDGE)
    quarter = x + 0.25 * chord
    above.plot(y, quarter, color="0.4", linewidth=0.8, linestyle="-.", label="quarter-chord line")
    heights = np.concatenate([z, (z - drop)[::-1], z[:1]])
    front.fill(np.concatenate([y, y[::-1], y[:1]]), heights, facecolor=_FILL, edgecolor="black", linewidth=0.8)
    side.fill(outline[0], heights, facecolor=_FILL, edgecolor="none")
    for i in range(len(x)):
        side.plot([x[i], back[i]], [z[i], z[i] - drop[i]], **(_EDGE | {"linewidth": 1.6 if i == 0 else 0.9}))
    side.plot(x, z, color="0.5", linewidth=0.8)
    side.plot(back, z - drop, color="0.5", linewidth=0.8)
    for control in surface.controls:
        corners, colour = _control(surface, control), colours[control.name]
        above.fill(sign * corners[:, 1], corners[:, 0], facecolor=colour, alpha=0.45, edgecolor=colour,
                   label=f"{literal(control.name)} ({control.kind})")  # fmt: skip


def _control(surface: LiftingSurface, control: ControlSurface) -> np.ndarray:
    """Outline (n, 3) of a control on the starboard half, through every section that it spans [m]."""
    from aeroservo.aircraft.geometry import section_at, span_stations

    s = span_stations(surface)
    inner = [f for f in s / s[-1] if control.span_from < f < control.span_to]
    at = np.array([control.span_from, *inner, control.span_to])
    edge, chord, _ = section_at(surface, at)
    hinge = np.interp(at, [control.span_from, control.span_to], [control.hinge_from, control.hinge_to])
    ahead = np.stack([hinge * chord, 0 * chord, 0 * chord], axis=-1)
    behind = np.stack([chord, 0 * chord, 0 * chord], axis=-1)
    return np.concatenate([edge + ahead, (edge + behind)[::-1]])


def _marks(above: Any, front: Any, side: Any, model: AircraftFile) -> None:
    """Mean chord, reference point, centre of gravity and mass items."""
    from aeroservo.aircraft.planform import planform

    p = planform(model.surfaces()[0])
    above.plot(
        [p.mac_y, p.mac_y], [p.mac_x, p.mac_x + p.mac], color=COLOURS[2], linewidth=2.2, label="mean aerodynamic chord"
    )
    r = model.references()
    look = {"marker": "x", "color": COLOURS[0], "linestyle": "none", "markersize": 8, "label": "reference point"}
    for ax, (a, b) in ((above, (0.0, r.x)), (front, (0.0, r.z)), (side, (r.x, r.z))):
        ax.plot([a], [b], **look)
    masses = model.masses()
    if masses is not None:
        x, y, z = masses.cg
        look = {"marker": "o", "color": UNSTABLE, "linestyle": "none", "markersize": 7, "label": "centre of gravity"}
        for ax, (a, b) in ((above, (y, x)), (front, (y, z)), (side, (x, z))):
            ax.plot([a], [b], **look)
    lumps = [m for m in model.mass if not m.spread_over]
    for m in lumps:
        for sign in (1.0, -1.0) if m.mirrored else (1.0,):
            look = {"marker": "s", "color": "0.3", "fillstyle": "none", "linestyle": "none", "label": "mass item"}
            for ax, (a, b) in (
                (above, (sign * m.y_m, m.x_m)),
                (front, (sign * m.y_m, m.z_m)),
                (side, (m.x_m, m.z_m)),
            ):
                ax.plot([a], [b], **look)


def _facts(ax: Any, model: AircraftFile) -> None:
    """The figures that belong to the drawing, as text."""
    from aeroservo.aircraft.planform import planform

    p = planform(model.surfaces()[0])
    rows = [
        (f"{model.surface[0].name}: area", f"{p.area:.4g} m²"),
        ("span", f"{p.span:.4g} m"),
        ("mean aerodynamic chord", f"{p.mac:.4g} m"),
        ("aspect ratio", f"{p.aspect_ratio:.4g}"),
        ("taper ratio", f"{p.taper:.4g}"),
        ("quarter-chord sweep", f"{np.degrees(p.sweep_quarter_chord):.4g}°"),
    ]
    masses = model.masses()
    if masses is not None:
        rows += [
            ("mass", f"{masses.mass:.4g} kg"),
            ("centre of gravity x", f"{masses.cg[0]:.4g} m"),
            ("Ixx, Iyy, Izz", ", ".join(f"{v:.3g}" for v in np.diag(masses.inertia)) + " kg m²"),
        ]
    for k, (name, value) in enumerate(rows):
        ax.text(0.0, 1.0 - 0.105 * k, literal(name), transform=ax.transAxes, fontsize="small", va="top")
        ax.text(1.0, 1.0 - 0.105 * k, literal(value), transform=ax.transAxes, fontsize="small", va="top", ha="right")
