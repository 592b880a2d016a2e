"""Area, mean chord, aspect ratio and sweep of a lifting surface, exact for its trapezoids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.aircraft.geometry import LiftingSurface, ReferenceQuantities, span_stations


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanformProperties:
    """Derived figures of one surface with its twin; see `planform`."""

    area: float  # [m^2] projected on z = 0 (on y = 0 for an upright fin)
    span: float  # [m] tip to tip, projected
    mac: float  # [m] mean aerodynamic chord
    mac_y: float  # [m] span station of the mean aerodynamic chord, on the half with the sections
    mac_x: float  # [m] its leading edge
    mac_z: float  # [m]
    aspect_ratio: float  # [-] span^2/area
    taper: float  # [-] tip chord over root chord
    sweep_leading_edge: float  # [rad]
    sweep_quarter_chord: float  # [rad] root to tip
    dihedral: float  # [rad] root to tip

    @property
    def mac_quarter(self) -> float:
        """Position x of the quarter point of the mean aerodynamic chord [m]."""
        return self.mac_x + 0.25 * self.mac


def planform(surface: LiftingSurface) -> PlanformProperties:
    """Area, mean aerodynamic chord, aspect ratio, taper and sweep of a surface with its twin.

    Parameters
    ----------
    surface : LiftingSurface
        The surface.

    Returns
    -------
    PlanformProperties
        Exact integrals over the trapezoids; areas are projected on z = 0, or on y = 0 for an upright fin.

    References
    ----------
    Thesis Table 1; the mean aerodynamic chord is (1/S) * integral of c^2 dy.

    Examples
    --------
    >>> from aeroservo.aircraft.geometry import WingSection
    >>> wing = LiftingSurface(name="w", sections=(WingSection(y=0.0, chord=0.7), WingSection(y=1.0, chord=0.3)))
    >>> p = planform(wing)
    >>> round(p.area, 12), round(p.mac, 5), round(p.mac_y, 5), round(p.aspect_ratio, 12)
    (1.0, 0.52667, 0.43333, 4.0)
    """
    edge, chord = surface.leading_edge, surface.chords
    lengths = np.abs(np.diff(edge[:, 1]))
    upright = lengths.sum() <= 1e-9 * span_stations(surface)[-1]
    if upright:
        lengths = np.abs(np.diff(edge[:, 2]))
    c0, c1 = chord[:-1], chord[1:]
    half_area = float(np.sum(lengths * (c0 + c1) / 2.0))

    def weighted(a0: np.ndarray, a1: np.ndarray) -> float:
        """Integral of c * a over the span for linear a, over the half area."""
        return float(np.sum(lengths * (c0 * (2 * a0 + a1) + c1 * (a0 + 2 * a1)) / 6.0)) / half_area

    sides = 2.0 if surface.mirrored else 1.0
    root_offset = 2.0 * min(abs(edge[0, 1]), abs(edge[-1, 1])) if surface.mirrored and not upright else 0.0
    span = float(sides * lengths.sum() + root_offset)
    area = sides * half_area
    run = float(np.hypot(*(edge[-1, 1:] - edge[0, 1:])))
    quarter = edge[:, 0] + 0.25 * chord
    return PlanformProperties(
        area=area,
        span=span,
        mac=weighted(c0, c1),
        mac_x=weighted(edge[:-1, 0], edge[1:, 0]),
        mac_y=weighted(edge[:-1, 1], edge[1:, 1]),
        mac_z=weighted(edge[:-1, 2], edge[1:, 2]),
        aspect_ratio=span**2 / area,
        taper=float(chord[-1] / chord[0]),
        sweep_leading_edge=float(np.arctan2(edge[-1, 0] - edge[0, 0], run)),
        sweep_quarter_chord=float(np.arctan2(quarter[-1] - quarter[0], run)),
        dihedral=float(np.arctan2(edge[-1, 2] - edge[0, 2], abs(edge[-1, 1] - edge[0, 1]))),
    )


def sweep(surface: LiftingSurface, chord_fraction: float) -> np.ndarray:
    """Sweep of a line of constant chord fraction, panel by panel.

    Parameters
    ----------
    surface : LiftingSurface
        The surface.
    chord_fraction : float
        0 for the leading edge, 0.25 for the quarter-chord line, 1 for the trailing edge. [-]

    Returns
    -------
    angle : ndarray, shape (n_sections - 1,)
        Sweep in the developed plane, positive aft. [rad]

    References
    ----------
    Elementary geometry; thesis Table 1 ("effective sweep").

    Examples
    --------
    >>> from aeroservo.aircraft.geometry import WingSection
    >>> tip = WingSection(y=1.0, x_le=1.0, chord=1.0)
    >>> wing = LiftingSurface(name="w", sections=(WingSection(y=0.0, chord=1.0), tip))
    >>> float(np.round(np.degrees(sweep(wing, 0.25))[0], 9))
    45.0
    """
    x = surface.leading_edge[:, 0] + chord_fraction * surface.chords
    return np.arctan2(np.diff(x), np.diff(span_stations(surface)))


def reference_quantities(surface: LiftingSurface) -> ReferenceQuantities:
    """Reference area, chord, span and moment point (quarter mean chord, centre plane) of a wing.

    Parameters
    ----------
    surface : LiftingSurface
        The wing that lends its figures to the aircraft.

    Returns
    -------
    ReferenceQuantities
        Area, mean aerodynamic chord, span; moments about the quarter of the mean chord.

    References
    ----------
    The usual convention of stability derivatives; thesis [5.24-5.27].

    Examples
    --------
    >>> from aeroservo.aircraft.geometry import WingSection
    >>> wing = LiftingSurface(name="w", sections=(WingSection(y=0.0, chord=1.0), WingSection(y=3.0, chord=1.0)))
    >>> ref = reference_quantities(wing)
    >>> ref.S, ref.c, ref.b, ref.x
    (6.0, 1.0, 6.0, 0.25)
    """
    p = planform(surface)
    y = 0.0 if surface.mirrored else p.mac_y
    return ReferenceQuantities(S=p.area, c=p.mac, b=p.span, x=p.mac_quarter, y=y, z=p.mac_z)
