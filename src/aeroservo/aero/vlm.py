"""Vortex lattice: how a lifting surface becomes strips and panels.

Linear lifting-surface theory: the vortices lie on the mean surface without twist and camber, whose strips are
parallel to x, and their legs leave along +x; twist, camber, deflections and motion enter through the normalwash
(`aeroservo.aero.vlm_solve`), loads follow in `vlm_loads`, induced drag in `trefftz`. That is the zero-frequency
limit of a doublet lattice on the same panels. It holds for thin surfaces at small angles and attached flow, at
subsonic Mach numbers without shocks (about 0.7 for thin wings).

Each panel carries a bound vortex on its quarter-chord line and one control point on its three-quarter-chord line.
Axes: x aft, y to starboard, z up. A bound vortex runs from `a` to `b`; the panel's normal is e_x x (b - a),
upward for a wing given from root to starboard tip.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from aeroservo.aero.vlm_spacing import SPACINGS, Spacing, chord_edges, span_edges
from aeroservo.datatypes import frozen


@dataclass(frozen=True, kw_only=True)
class VortexLattice:
    """Options of the lattice: panels along the chord and over each surface's own span, and how they are spaced.

    Parameters
    ----------
    chordwise, spanwise : int
        Panels along the chord, and strips over the span of each surface (of one half where it is mirrored).
    spacing : {"cosine", "tip", "uniform"}
        Strips closer together at both ends of a surface, at its tip only, or evenly.
    chordwise_spacing : {"uniform", "cosine"}
        Even panels along the chord, or closer at leading and trailing edge.
    mach : float
        Mach number of the Prandtl-Glauert rule, in [0, 1). [-]
    """

    chordwise: int = 8
    spanwise: int = 24
    spacing: Spacing = "cosine"
    chordwise_spacing: Literal["uniform", "cosine"] = "uniform"
    mach: float = 0.0

    def __post_init__(self) -> None:
        for name in ("chordwise", "spanwise"):
            value = getattr(self, name)
            if not (isinstance(value, (int, np.integer)) and value >= 1):
                raise ValueError(f"{name} must be an integer >= 1, got {value!r}")
        if self.spacing not in SPACINGS:
            raise ValueError(f"spacing must be one of {SPACINGS}, got {self.spacing!r}")
        if self.chordwise_spacing not in ("uniform", "cosine"):
            raise ValueError(f'chordwise_spacing must be "uniform" or "cosine", got {self.chordwise_spacing!r}')
        if not 0.0 <= self.mach < 1.0:
            raise ValueError(f"mach must lie in [0, 1): the Prandtl-Glauert rule is subsonic, got {self.mach:g}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Hinge:
    """Hinge line of a control, straight between its ends."""

    span_from: float  # [-] fraction of the surface's developed span
    span_to: float  # [-]
    chord_from: float  # [-] fraction of the chord there
    chord_to: float  # [-]

    def at(self, span: np.ndarray) -> np.ndarray:
        """Hinge's chord fraction at span fractions (...), NaN beside the control [-]."""
        t = (np.asarray(span, dtype=float) - self.span_from) / (self.span_to - self.span_from)
        inside = (t > 0.0) & (t < 1.0)
        return np.where(inside, self.chord_from + t * (self.chord_to - self.chord_from), np.nan)


@dataclass(frozen=True, kw_only=True, eq=False)
class LatticeSurface:
    """Strips of one surface, all with the same number of panels along the chord.

    Parameters
    ----------
    name : str
        Name of the surface.
    leading_edge : ndarray, shape (n_strips + 1, 3)
        Leading edge at the edges of the strips, from the surface's first section to its last. [m]
    chord : ndarray, shape (n_strips + 1,)
        Chord there. [m]
    span : ndarray, shape (n_strips + 1,)
        Fraction of the developed span there, from 0 to 1. [-]
    control_span : ndarray, shape (n_strips,)
        Fraction of the developed span at the control points. [-]
    fractions : ndarray, shape (n_strips, n_chord + 1)
        Chord fractions of the panels' edges, from 0 to 1. [-]
    mirrored : bool
        Whether a twin exists across y = 0.
    """

    name: str
    leading_edge: np.ndarray
    chord: np.ndarray
    span: np.ndarray
    control_span: np.ndarray
    fractions: np.ndarray
    mirrored: bool = True

    def __post_init__(self) -> None:
        for name in ("leading_edge", "chord", "span", "control_span", "fractions"):
            object.__setattr__(self, name, frozen(getattr(self, name), name=f"{name} of surface {self.name!r}"))
        m = len(self.chord) - 1
        shapes = (self.leading_edge.shape, self.span.shape, self.control_span.shape, self.fractions.shape[:1])
        if m < 1 or shapes != ((m + 1, 3), (m + 1,), (m,), (m,)):
            raise ValueError(f"lattice surface {self.name!r}: shapes {shapes} do not fit {m} strips")
        if np.any(self.chord <= 0.0):
            raise ValueError(f"chord of lattice surface {self.name!r} must be > 0 [m], got {self.chord.min():g}")
        if np.any(np.diff(self.fractions, axis=1) <= 0.0):
            raise ValueError(f"fractions of lattice surface {self.name!r} must ascend along the chord")


@dataclass(frozen=True, kw_only=True, eq=False)
class Lattice:
    """Panels (n) in strips (m), strip by strip from leading to trailing edge.

    When `mirrored`, only the panels at y >= 0 are here and the flow is completed by their images.
    """

    a: np.ndarray  # (n, 3) [m] start of the bound vortex
    b: np.ndarray  # (n, 3) [m] its end
    control: np.ndarray  # (n, 3) [m] control point
    normal: np.ndarray  # (n, 3) [-] unit normal of the mean surface, no x component
    chord: np.ndarray  # (n,) [m] panel chord at the control point
    fraction: np.ndarray  # (n, 2) [-] chord fractions of the panel's front and rear edge
    strip: np.ndarray  # (n,) index of the strip
    strip_edge_a: np.ndarray  # (m, 3) [m] leading edge at the strip's ends, in the order of a and b
    strip_edge_b: np.ndarray  # (m, 3) [m]
    strip_edge: np.ndarray  # (m, 3) [m] leading edge at the control points' station
    strip_chord: np.ndarray  # (m,) [m] chord there
    strip_mean_chord: np.ndarray  # (m,) [m] mean of the two ends: mean chord times width is the strip's area
    strip_span: np.ndarray  # (m,) [-] fraction of the surface's developed span at the control points
    strip_surface: np.ndarray  # (m,) index of the surface
    strip_side: np.ndarray  # (m,) +1, or -1 for the explicit twin of a mirrored surface
    surfaces: tuple[str, ...]  # names of the surfaces
    mirrored: bool  # whether images complete the flow

    @property
    def strip_width(self) -> np.ndarray:
        """Width of the strips in the y-z plane, shape (m,) [m]."""
        return np.hypot(*(self.strip_edge_b - self.strip_edge_a)[:, 1:].T)

    @property
    def core(self) -> float:
        """Radius inside which a vortex does not act [m]: a millionth of the narrowest strip or shortest panel."""
        return 1e-6 * float(min(self.strip_width.min(), self.chord.min()))

    def __len__(self) -> int:
        return len(self.chord)


def lattice_surface(
    name: str,
    leading_edge: np.ndarray,
    chord: np.ndarray,
    *,
    hinges: Sequence[Hinge] = (),
    options: VortexLattice = VortexLattice(),
    mirrored: bool = True,
) -> LatticeSurface:
    """Strips of a surface given by its sections, with edges at every section, control end and hinge.

    Parameters
    ----------
    name : str
        Name of the surface.
    leading_edge : array_like, shape (k, 3)
        Leading edge of the sections, from root to tip. [m]
    chord : array_like, shape (k,)
        Their chords. [m]
    hinges : sequence of Hinge
        Hinge lines of the controls, not overlapping.
    options : VortexLattice
        Numbers of panels and their spacing.
    mirrored : bool
        Whether a twin exists across y = 0.

    Returns
    -------
    LatticeSurface
        The strips.

    Raises
    ------
    ValueError
        If there are fewer strips than intervals between sections and control ends.

    References
    ----------
    J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 12.

    Examples
    --------
    >>> s = lattice_surface("wing", [[0, 0, 0], [0, 2, 0]], [1, 1], options=VortexLattice(chordwise=2, spanwise=4))
    >>> s.fractions.shape, float(s.chord[0])
    ((4, 3), 1.0)
    """
    leading_edge, chord = np.asarray(leading_edge, dtype=float), np.asarray(chord, dtype=float)
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(leading_edge[:, 1:], axis=0).T))])
    station = lengths / lengths[-1]
    breaks = [*station, *(h.span_from for h in hinges), *(h.span_to for h in hinges)]
    edges, control = span_edges(options.spanwise, breaks, spacing=options.spacing)
    rows = []
    for at in control:
        hinge = next((float(h.at(at)) for h in hinges if np.isfinite(h.at(at))), None)
        rows.append(chord_edges(options.chordwise, hinge, spacing=options.chordwise_spacing))
    return LatticeSurface(
        name=name,
        leading_edge=np.stack([np.interp(edges, station, x) for x in leading_edge.T], axis=-1),
        chord=np.interp(edges, station, chord),
        span=edges,
        control_span=control,
        fractions=np.array(rows),
        mirrored=mirrored,
    )


def lattice(surfaces: Sequence[LatticeSurface], *, full: bool = False) -> Lattice:
    """Panels of one or more surfaces.

    Parameters
    ----------
    surfaces : sequence of LatticeSurface
        The surfaces.
    full : bool
        Give the twins of mirrored surfaces panels of their own. Without it, and when every surface is mirrored, only
        the given halves become panels and their images complete the flow: half the unknowns, the same answer.

    Returns
    -------
    Lattice
        The panels. Where one surface lies behind another in the same plane, their strips should have the same edges: a
        control point close to another strip's trailing vortex feels its singular core, not a wake.

    Raises
    ------
    ValueError
        If there is no surface.

    References
    ----------
    J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 12 (horseshoe elements, image of a half wing).

    Examples
    --------
    >>> s = lattice_surface("wing", [[0, 0, 0], [0, 2, 0]], [1, 1], options=VortexLattice(chordwise=2, spanwise=4))
    >>> len(lattice([s])), len(lattice([s], full=True))
    (8, 16)
    """
    if not surfaces:
        raise ValueError("a lattice needs at least one surface, got none")
    half = not full and all(s.mirrored for s in surfaces)
    parts = []
    for index, surface in enumerate(surfaces):
        part = _panels(surface, index)
        parts.append(part)
        if surface.mirrored and not half:
            parts.append(_twin(part))
    first, joined = 0, {}
    for part in parts:
        part["strip"] = part["strip"] + first
        first += len(part["strip_chord"])
    for key in parts[0]:
        joined[key] = np.concatenate([part[key] for part in parts])
        joined[key].flags.writeable = False
    return Lattice(**joined, surfaces=tuple(s.name for s in surfaces), mirrored=half)


def _panels(s: LatticeSurface, index: int) -> dict[str, np.ndarray]:
    """Panels of one surface, without its twin."""
    m, n_chord = s.fractions.shape[0], s.fractions.shape[1] - 1
    t = (s.control_span - s.span[:-1]) / np.diff(s.span)
    edge_a, edge_b = s.leading_edge[:-1], s.leading_edge[1:]
    chord_a, chord_b = s.chord[:-1], s.chord[1:]
    edge = edge_a + t[:, None] * (edge_b - edge_a)
    chord = chord_a + t * (chord_b - chord_a)
    front, rear = s.fractions[:, :-1], s.fractions[:, 1:]
    vortex, collocation = front + 0.25 * (rear - front), front + 0.75 * (rear - front)

    def points(e: np.ndarray, c: np.ndarray, fraction: np.ndarray) -> np.ndarray:
        out = np.repeat(e[:, None, :], n_chord, axis=1)
        out[:, :, 0] += c[:, None] * fraction
        return out.reshape(-1, 3)

    along = edge_b - edge_a
    normal = np.stack([np.zeros(m), -along[:, 2], along[:, 1]], axis=-1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return {
        "a": points(edge_a, chord_a, vortex),
        "b": points(edge_b, chord_b, vortex),
        "control": points(edge, chord, collocation),
        "normal": np.repeat(normal, n_chord, axis=0),
        "chord": (chord[:, None] * (rear - front)).ravel(),
        "fraction": np.stack([front.ravel(), rear.ravel()], axis=-1),
        "strip": np.repeat(np.arange(m), n_chord),
        "strip_edge_a": edge_a.copy(),
        "strip_edge_b": edge_b.copy(),
        "strip_edge": edge,
        "strip_chord": chord,
        "strip_mean_chord": (chord_a + chord_b) / 2.0,
        "strip_span": s.control_span.copy(),
        "strip_surface": np.full(m, index),
        "strip_side": np.ones(m),
    }


def _twin(part: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The mirror image of panels across y = 0; bound vortices keep running to starboard."""
    flip = np.array([1.0, -1.0, 1.0])
    twin = dict(part)
    twin["a"], twin["b"] = part["b"] * flip, part["a"] * flip
    twin["strip_edge_a"], twin["strip_edge_b"] = part["strip_edge_b"] * flip, part["strip_edge_a"] * flip
    for key in ("control", "normal", "strip_edge"):
        twin[key] = part[key] * flip
    twin["strip_side"] = -part["strip_side"]
    return twin
