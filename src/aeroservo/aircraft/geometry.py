"""Lifting surfaces of an aircraft: sections, panels, control surfaces and what follows from them.

Axes: x aft, y to starboard, z up [m]; angles in radians. A surface is a row of sections joined by straight
lines; a mirrored one has a twin across the plane y = 0. Areas and mean chords are those of the trapezoids
between the sections: fairings and rounded tips are not in them.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

ControlKind = Literal["hinged", "morphed"]
MorphReading = Literal["same_drop", "same_slope"]


@dataclass(frozen=True, kw_only=True, eq=False)
class WingSection:
    """One streamwise section of a lifting surface.

    Parameters
    ----------
    y, x_le, z_le : float
        Leading edge of the section. [m]
    chord : float
        Streamwise chord, positive. [m]
    twist : float
        Incidence of the section, positive nose up; washout is negative. [rad]
    airfoil : str
        Name of the section's airfoil (a shipped name, ``naca2412``-like, or a file's stem).
    """

    y: float
    x_le: float = 0.0
    z_le: float = 0.0
    chord: float
    twist: float = 0.0
    airfoil: str = "flat"

    def __post_init__(self) -> None:
        for name in ("y", "x_le", "z_le", "chord", "twist"):
            value = float(getattr(self, name))
            if not np.isfinite(value):
                raise ValueError(f"section {name} must be finite, got {value}")
            object.__setattr__(self, name, value)
        if self.chord <= 0.0:
            raise ValueError(f"section chord must be > 0 [m], got {self.chord:g} at y = {self.y:g} m")
        if abs(self.twist) >= np.pi / 2:
            raise ValueError(f"section twist must lie within +-pi/2 [rad], got {self.twist:g}")


@dataclass(frozen=True, kw_only=True, eq=False)
class ControlSurface:
    """A trailing-edge control over part of a surface's span; deflection is positive trailing edge down.

    Parameters
    ----------
    name : str
        Name of the control.
    span_from, span_to : float
        Ends, as fractions of the surface's developed length from its first section. [-]
    hinge_from, hinge_to : float
        Hinge line at those ends as a fraction of the local chord. [-]
    kind : {"hinged", "morphed"}
        A sharp hinge, or a parabolic increase of camber behind the hinge line.
    reading : {"same_drop", "same_slope"}
        What "equal deflection" means for a morphed control: the trailing edge drops as far as the hinged one's,
        or its slope at the trailing edge is the hinged one's.
    symmetric, antisymmetric : float
        Mixing gains: the starboard surface deflects by symmetric*elevator + antisymmetric*aileron, its mirror
        twin by symmetric*elevator - antisymmetric*aileron, so positive aileron is starboard trailing edge
        down and rolls to port. [-]
    """

    name: str
    span_from: float
    span_to: float
    hinge_from: float
    hinge_to: float
    kind: ControlKind = "hinged"
    reading: MorphReading = "same_drop"
    symmetric: float = 1.0
    antisymmetric: float = 1.0

    def __post_init__(self) -> None:
        where = f"control surface {self.name!r}"
        if not (0.0 <= self.span_from < self.span_to <= 1.0):
            raise ValueError(
                f"{where}: need 0 <= span_from < span_to <= 1 (fractions of the span) so that it lies on the wing, "
                f"got {self.span_from:g} to {self.span_to:g}"
            )
        for name in ("hinge_from", "hinge_to"):
            value = float(getattr(self, name))
            if not 0.0 <= value < 1.0:
                raise ValueError(f"{where}: {name} must lie in [0, 1) of the chord, got {value:g}")
        if self.kind not in ("hinged", "morphed"):
            raise ValueError(f'{where}: kind must be "hinged" or "morphed", got {self.kind!r}')
        if self.reading not in ("same_drop", "same_slope"):
            raise ValueError(f'{where}: reading must be "same_drop" or "same_slope", got {self.reading!r}')


@dataclass(frozen=True, kw_only=True, eq=False)
class LiftingSurface:
    """A row of sections from root to tip, with its controls.

    Parameters
    ----------
    name : str
        Name of the surface.
    sections : tuple of WingSection
        Two or more, from root to tip, joined by straight lines.
    mirrored : bool
        Whether a twin exists across y = 0.
    controls : tuple of ControlSurface
        Controls; they may not overlap one another.

    Raises
    ------
    ValueError
        For fewer than two sections, two sections at one place, a planform that crosses itself or its twin,
        or overlapping controls.
    """

    name: str
    sections: tuple[WingSection, ...]
    mirrored: bool = True
    controls: tuple[ControlSurface, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "sections", tuple(self.sections))
        object.__setattr__(self, "controls", tuple(self.controls))
        if len(self.sections) < 2:
            raise ValueError(f"surface {self.name!r} needs two or more sections, got {len(self.sections)}")
        _check_front_view(self)
        _check_controls(self)

    @property
    def leading_edge(self) -> np.ndarray:
        """Leading edge of the sections, shape (n, 3) [m]."""
        return np.array([(s.x_le, s.y, s.z_le) for s in self.sections])

    @property
    def chords(self) -> np.ndarray:
        """Chords of the sections, shape (n,) [m]."""
        return np.array([s.chord for s in self.sections])

    @property
    def twists(self) -> np.ndarray:
        """Twist of the sections, shape (n,) [rad]."""
        return np.array([s.twist for s in self.sections])


@dataclass(frozen=True, kw_only=True, eq=False)
class ReferenceQuantities:
    """What coefficients are made dimensionless with.

    Parameters
    ----------
    S, c, b : float
        Area [m^2], chord [m] and span [m]; all positive.
    x, y, z : float
        Point about which moments are taken. [m]
    """

    S: float
    c: float
    b: float
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0

    def __post_init__(self) -> None:
        for name, unit in (("S", "m^2"), ("c", "m"), ("b", "m")):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise ValueError(f"reference {name} must be > 0 [{unit}], got {value:g}")


def span_stations(surface: LiftingSurface) -> np.ndarray:
    """Developed distance of the sections from the first one, along the front view.

    Parameters
    ----------
    surface : LiftingSurface
        The surface.

    Returns
    -------
    s : ndarray, shape (n_sections,)
        Arc length in the y-z plane, starting at 0. [m]

    References
    ----------
    Elementary geometry; thesis Table 1 for the terms.

    Examples
    --------
    >>> tip = WingSection(y=3.0, z_le=4.0, chord=1.0)
    >>> wing = LiftingSurface(name="w", sections=(WingSection(y=0.0, chord=1.0), tip))
    >>> float(span_stations(wing)[-1])
    5.0
    """
    steps = np.diff(surface.leading_edge[:, 1:], axis=0)
    return np.concatenate([[0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))])


def section_at(surface: LiftingSurface, fraction: np.ndarray | float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Leading edge, chord and twist at fractions of the developed span, linear between sections.

    Parameters
    ----------
    surface : LiftingSurface
        The surface.
    fraction : array_like, shape (...)
        Fraction of the developed span from the first section, in [0, 1]. [-]

    Returns
    -------
    leading_edge : ndarray, shape (..., 3)
        Leading-edge points. [m]
    chord : ndarray, shape (...)
        Chords. [m]
    twist : ndarray, shape (...)
        Twist. [rad]

    Raises
    ------
    ValueError
        If a fraction lies outside [0, 1].

    References
    ----------
    Ruled surface between sections, as AVL and XFLR5 define it.

    Examples
    --------
    >>> wing = LiftingSurface(name="w", sections=(WingSection(y=0.0, chord=1.0), WingSection(y=2.0, chord=0.5)))
    >>> float(section_at(wing, 0.5)[1])
    0.75
    """
    fraction = np.asarray(fraction, dtype=float)
    if np.any((fraction < -1e-12) | (fraction > 1.0 + 1e-12)):
        raise ValueError(f"span fraction must lie in [0, 1], got {fraction.min():g} to {fraction.max():g}")
    s = span_stations(surface)
    at = fraction * s[-1]
    edge = np.stack([np.interp(at, s, column) for column in surface.leading_edge.T], axis=-1)
    return edge, np.interp(at, s, surface.chords), np.interp(at, s, surface.twists)


def _check_front_view(surface: LiftingSurface) -> None:
    """Reject coincident sections, surfaces across their own mirror, and front views that cross themselves."""
    yz = surface.leading_edge[:, 1:]
    steps = np.hypot(*np.diff(yz, axis=0).T)
    if np.any(steps <= 0.0):
        i = int(np.argmin(steps))
        raise ValueError(
            f"surface {surface.name!r}: sections {i} and {i + 1} lie at one span station (y = {yz[i, 0]:g} m, "
            f"z = {yz[i, 1]:g} m); move one or drop it"
        )
    if surface.mirrored and np.any(yz[:, 0] < 0.0):
        raise ValueError(
            f"surface {surface.name!r} is mirrored, so y must be >= 0 [m], got {yz[:, 0].min():g}: it crosses its twin"
        )
    if surface.mirrored and np.all(yz[:, 0] == 0.0):
        raise ValueError(f"surface {surface.name!r} lies in the mirror plane y = 0; set mirrored = false")
    n = len(yz) - 1
    for i in range(n):
        for j in range(i + 1, n):
            if _segments_touch(yz[i], yz[i + 1], yz[j], yz[j + 1], adjacent=j == i + 1):
                raise ValueError(
                    f"surface {surface.name!r} crosses itself: panel {i} (from y = {yz[i, 0]:g} m) meets panel {j} "
                    f"(from y = {yz[j, 0]:g} m) in front view; order the sections from root to tip"
                )


def _segments_touch(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray, *, adjacent: bool) -> bool:
    """Whether two plane segments share a point (for neighbours: besides their common end)."""

    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> float:
        value = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        scale = np.hypot(*(q - p)) * max(np.hypot(*(r - p)), np.hypot(*(r - q)))
        return 0.0 if abs(value) <= 1e-12 * scale else float(np.sign(value))

    if adjacent:
        return side(a, b, d) == 0.0 and float(np.dot(b - a, d - c)) < 0.0
    s1, s2, s3, s4 = side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b)
    if s1 * s2 < 0 and s3 * s4 < 0:
        return True

    def within(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> bool:
        return bool(np.all(r >= np.minimum(p, q) - 1e-12) and np.all(r <= np.maximum(p, q) + 1e-12))

    touches = ((s1, a, b, c), (s2, a, b, d), (s3, c, d, a), (s4, c, d, b))
    return any(s == 0 and within(p, q, r) for s, p, q, r in touches)


def _check_controls(surface: LiftingSurface) -> None:
    """Reject controls that share a name or a stretch of span."""
    names = [c.name for c in surface.controls]
    if len(set(names)) != len(names):
        raise ValueError(f"surface {surface.name!r}: control names must differ, got {names}")
    ordered = sorted(surface.controls, key=lambda c: c.span_from)
    for inner, outer in pairwise(ordered):
        if outer.span_from < inner.span_to - 1e-12:
            raise ValueError(
                f"surface {surface.name!r}: control surfaces {inner.name!r} (to {inner.span_to:g} of the span) and "
                f"{outer.name!r} (from {outer.span_from:g}) overlap; shorten one"
            )
