"""Deflected outlines: a hinged flap with its corner and its bend, and a smoothly morphed trailing edge."""

from __future__ import annotations

from typing import Literal

import numpy as np

from aeroservo.aero.airfoil import Airfoil, repanel, surfaces

#: Largest deflection accepted: beyond it neither thin surfaces nor attached flow are left. [rad]
LARGEST = np.radians(40.0)
#: Largest angle between two points of the rounded bend on the stretched side. [rad]
ARC_STEP = np.radians(2.0)


def hinged_outline(foil: Airfoil, hinge: float, delta: float, *, height: float = 0.5, panels: int = 200) -> Airfoil:
    """Outline with a flap turned about a hinge point between the surfaces.

    Parameters
    ----------
    foil : Airfoil
        The outline.
    hinge : float
        Hinge from the leading edge, in chords, in [0.2, 0.98]. [-]
    delta : float
        Deflection, trailing edge down. [rad]
    height : float
        Hinge point between the lower (0) and the upper (1) surface. [-]
    panels : int
        Panels of the undeflected outline.

    Returns
    -------
    Airfoil
        On the stretched side the gap is closed by an arc about the hinge point; on the other side the surfaces are cut
        where they meet.

    Raises
    ------
    ValueError
        If the hinge or the deflection lies outside its range.

    References
    ----------
    The construction of M. Drela, XFOIL, 1989, guide section "FLAP".

    Examples
    --------
    >>> from aeroservo.aero.airfoil_files import airfoil
    >>> down = hinged_outline(airfoil("naca0012"), 0.75, np.radians(10.0))
    >>> round(float(down.points[0, 1]), 4)
    -0.0434
    """
    _check(hinge, delta)
    if not 0.0 <= height <= 1.0:
        raise ValueError(f"height of the hinge must lie in [0, 1] between the surfaces, got {height:g}")
    outline = repanel(foil, panels).points
    upper_z, lower_z = (float(z) for z in surfaces(foil, np.array(hinge)))
    pivot = np.array([hinge, lower_z + height * (upper_z - lower_z)])
    nose = int(np.argmin(outline[:, 0]))
    # both surfaces from the leading edge aft
    upper = _turned(outline[: nose + 1][::-1], pivot, delta, stretched=delta > 0.0)
    lower = _turned(outline[nose:], pivot, delta, stretched=delta < 0.0)
    return Airfoil(name=_named(foil, "hinged", hinge, delta), points=np.concatenate([upper[::-1], lower[1:]]))


def morphed_outline(
    foil: Airfoil,
    hinge: float,
    delta: float,
    *,
    reading: Literal["same_drop", "same_slope"] = "same_drop",
    panels: int = 200,
) -> Airfoil:
    """Outline whose camber grows smoothly behind the "hinge".

    Parameters
    ----------
    foil : Airfoil
        The outline.
    hinge : float
        Where the bending starts, in chords, in [0.2, 0.98]. [-]
    delta : float
        Deflection, trailing edge down. [rad]
    reading : {"same_drop", "same_slope"}
        Equal deflection means: the trailing edge drops as far as a hinged control's, or ends with its slope.
    panels : int
        Panels of the outline.

    Returns
    -------
    Airfoil
        Both surfaces moved by dz = -tan(delta) s (x - x_h)^2/(1 - x_h), s = 1 or 1/2: thickness is kept.

    Raises
    ------
    ValueError
        If the hinge, the deflection or the reading lies outside its range.

    References
    ----------
    Bramstång 2015, figure 6 (the idea); the increment is this project's reading.

    Examples
    --------
    >>> from aeroservo.aero.airfoil_files import airfoil
    >>> down = morphed_outline(airfoil("naca0012"), 0.75, np.radians(10.0))
    >>> round(float(down.points[0, 1]), 4)
    -0.0441
    """
    _check(hinge, delta)
    if reading not in ("same_drop", "same_slope"):
        raise ValueError(f'reading must be "same_drop" or "same_slope", got {reading!r}')
    outline = np.array(repanel(foil, panels).points)
    s = 1.0 if reading == "same_drop" else 0.5
    aft = np.maximum(outline[:, 0] - hinge, 0.0)
    outline[:, 1] -= np.tan(delta) * s * aft**2 / (1.0 - hinge)
    return Airfoil(name=_named(foil, "morphed", hinge, delta), points=outline)


def _check(hinge: float, delta: float) -> None:
    if not 0.2 <= hinge <= 0.98:
        raise ValueError(f"hinge must lie in [0.2, 0.98] of the chord, got {hinge:g}")
    if not abs(delta) <= LARGEST:
        raise ValueError(f"deflection must lie within +-{np.degrees(LARGEST):g} deg, got {np.degrees(delta):g} deg")


def _named(foil: Airfoil, kind: str, hinge: float, delta: float) -> str:
    return f"{foil.name} {kind} {hinge:g} {np.degrees(delta):+g} deg"


def _turned(side: np.ndarray, pivot: np.ndarray, delta: float, *, stretched: bool) -> np.ndarray:
    """One surface, from the leading edge aft, with the part behind the pivot turned trailing edge down.

    The surface parts at its point nearest to the pivot: there it is square to the arm, so that an arc about the pivot
    joins both parts without a kink, and on the other side both parts reach their meeting point.
    """
    if delta == 0.0:
        return side
    cos, sin = np.cos(delta), np.sin(delta)
    turn = np.array([[cos, -sin], [sin, cos]])  # row vectors; positive delta carries +x towards -z
    k, foot = _nearest(side, pivot)
    fore, aft = side[: k + 1], side[k + 1 :]
    fore = np.concatenate([fore[np.hypot(*(fore - foot).T) > 1e-6], [foot]])
    aft = np.concatenate([[foot], aft[np.hypot(*(aft - foot).T) > 1e-6]])
    aft = (aft - pivot) @ turn + pivot
    if stretched:
        steps = int(np.ceil(abs(delta) / ARC_STEP))
        angle = np.linspace(0.0, delta, steps + 1)[1:-1]
        x, z = foot - pivot
        arc = np.stack([x * np.cos(angle) + z * np.sin(angle), z * np.cos(angle) - x * np.sin(angle)], axis=-1)
        return np.concatenate([fore, arc + pivot, aft])
    cut = _meeting(fore, aft)
    if cut is None:  # the pivot lies on this surface: nothing overlaps
        return np.concatenate([fore, aft[1:]])
    i, j, point = cut
    clear = 0.3 * float(np.hypot(*(side[k + 1] - side[k])))  # a point closer than this would kink a spline
    fore, aft = fore[: i + 1], aft[j + 1 :]
    fore = fore[np.hypot(*(fore - point).T) > clear]
    aft = aft[np.hypot(*(aft - point).T) > clear]
    return np.concatenate([fore, [point], aft])


def _nearest(side: np.ndarray, pivot: np.ndarray) -> tuple[int, np.ndarray]:
    """Segment and point of a polyline nearest to a point."""
    start, along = side[:-1], np.diff(side, axis=0)
    t = np.clip(np.sum((pivot - start) * along, axis=1) / np.sum(along**2, axis=1), 0.0, 1.0)
    points = start + t[:, None] * along
    k = int(np.argmin(np.hypot(*(points - pivot).T)))
    return k, points[k]


def _meeting(fore: np.ndarray, aft: np.ndarray) -> tuple[int, int, np.ndarray] | None:
    """Where two polylines cross: the foremost segment of `fore`, the last one of `aft`, and the point."""
    for i in range(len(fore) - 1):
        p, r = fore[i], fore[i + 1] - fore[i]
        for j in range(len(aft) - 2, -1, -1):
            q, s = aft[j], aft[j + 1] - aft[j]
            cross = r[0] * s[1] - r[1] * s[0]
            if cross == 0.0:
                continue
            t = ((q[0] - p[0]) * s[1] - (q[1] - p[1]) * s[0]) / cross
            u = ((q[0] - p[0]) * r[1] - (q[1] - p[1]) * r[0]) / cross
            if 0.0 <= t <= 1.0 and 0.0 <= u <= 1.0:
                return i, j, p + t * r
    return None
