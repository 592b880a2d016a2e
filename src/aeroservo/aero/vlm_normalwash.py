"""Vortex lattice: the right-hand sides, one column for every input.

Normalwash is per unit airspeed. The wind over the aircraft in geometry axes (x aft, y to starboard, z up) is
(1, -beta, alpha) to first order, and -Omega x (r - r_ref) with Omega = (-p, q, -r)/V for the rates of flight mechanics
(p starboard wing down, q nose up, r nose to starboard).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from aeroservo.aero.vlm import Hinge, Lattice
from aeroservo.datatypes import frozen

RIGID = ("alpha", "beta", "p", "q", "r")
RIGID_PARITY = (1, -1, -1, 1, -1)


@dataclass(frozen=True, kw_only=True, eq=False)
class Normalwash:
    """Right-hand sides: outward normal velocity of the onset flow at the control points, per unit of each input.

    Parameters
    ----------
    names : tuple of str, length m
        Names of the inputs.
    values : ndarray, shape (n, m)
        Normal velocity over airspeed, per unit of the input. [-]
    parity : ndarray, shape (m,)
        +1 where the port half does the same as the starboard half, -1 where it does the opposite. A half lattice
        needs it; a full one carries both halves in `values`.
    """

    names: tuple[str, ...]
    values: np.ndarray
    parity: np.ndarray

    def __post_init__(self) -> None:
        values = frozen(self.values, ndim=2, name="normalwash")
        parity = frozen(self.parity, dtype=int, ndim=1, name="parity")
        if values.shape[1] != len(self.names) or parity.shape != (len(self.names),):
            raise ValueError(f"{len(self.names)} names do not fit values {values.shape} and parity {parity.shape}")
        if not np.all(np.abs(parity) == 1):
            raise ValueError(f"parity must be +1 or -1, got {self.parity}")
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "parity", parity)


def rigid_normalwash(lattice: Lattice, point: Sequence[float] | np.ndarray) -> Normalwash:
    """Columns of angle of attack, sideslip and the three rates.

    Parameters
    ----------
    lattice : Lattice
        The panels.
    point : array_like, shape (3,)
        Point about which the aircraft turns. [m]

    Returns
    -------
    Normalwash
        Columns ``alpha``, ``beta`` [per rad] and ``p``, ``q``, ``r`` [per rad/m: rate over airspeed].

    References
    ----------
    M. Drela, Flight Vehicle Aerodynamics, 2014, section 6.5; signs of the project's conventions.

    Examples
    --------
    >>> from aeroservo.aero.vlm import VortexLattice, lattice, lattice_surface
    >>> one = VortexLattice(chordwise=1, spanwise=1)
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1], options=one)])
    >>> np.round(rigid_normalwash(grid, [0.25, 0.0, 0.0]).values, 12)
    array([[1. , 0. , 1. , 0.5, 0. ]])
    """
    x, y, z = (lattice.control - np.asarray(point, dtype=float)).T
    n_y, n_z = lattice.normal[:, 1], lattice.normal[:, 2]
    values = np.stack([n_z, -n_y, -n_y * z + n_z * y, n_z * x, n_y * x], axis=-1)
    return Normalwash(names=RIGID, values=values + 0.0, parity=np.array(RIGID_PARITY))


def slope_normalwash(lattice: Lattice, name: str, slope: np.ndarray, *, parity: int = 1) -> Normalwash:
    """Column of a steady shape: twist, camber or a deflected mode, by its slope at the control points.

    Parameters
    ----------
    lattice : Lattice
        The panels.
    name : str
        Name of the input.
    slope : array_like, shape (n,)
        d(normal displacement)/dx at the control points per unit of the input; nose-up twist has slope -1. [-]
    parity : {1, -1}
        Whether the port half does the same or the opposite.

    Returns
    -------
    Normalwash
        One column, -slope.

    References
    ----------
    Flow tangency of thin-airfoil theory; J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 5.

    Examples
    --------
    >>> from aeroservo.aero.vlm import VortexLattice, lattice, lattice_surface
    >>> one = VortexLattice(chordwise=1, spanwise=1)
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1], options=one)])
    >>> float(slope_normalwash(grid, "twist", [-0.1]).values[0, 0])
    0.1
    """
    slope = np.broadcast_to(np.asarray(slope, dtype=float), (len(lattice),))
    return Normalwash(names=(name,), values=-slope[:, None], parity=np.array([parity]))


def control_normalwash(
    lattice: Lattice,
    name: str,
    surface: str,
    hinge: Hinge,
    *,
    kind: Literal["hinged", "morphed"] = "hinged",
    reading: Literal["same_drop", "same_slope"] = "same_drop",
    parity: int = 1,
    gain: float = 1.0,
) -> Normalwash:
    """Column of a control deflected trailing edge down, per radian of streamwise deflection.

    Parameters
    ----------
    lattice : Lattice
        The panels.
    name, surface : str
        Name of the input, and of the surface that carries the control.
    hinge : Hinge
        Hinge line.
    kind, reading : str
        Hinged, or morphed with the trailing-edge drop or the end slope of a hinged control.
    parity : {1, -1}
        +1: both sides together; -1: port side the other way.
    gain : float
        Deflection of the starboard side per unit of the input. [-]

    Returns
    -------
    Normalwash
        One column. A panel's normalwash is the mean of the slope over the chord between its vortex and the next
        one: the lift of a hinged control then converges with the square of the panel size. The value at the
        control point alone loses half a panel of the control: 3 % of its lift at 16 panels with a hinge at 75 %.

    Raises
    ------
    ValueError
        If the lattice has no such surface.

    References
    ----------
    Thin-airfoil theory of a bent mean line: H. Glauert, ARC Reports and Memoranda no. 1095, 1927. The deflection is
    streamwise (a hinge swept by L turns by delta/cos L about itself). Camber of the morphed control:
    dz = -tan(delta) s (x - x_h)^2/(1 - x_h), s = 1 (same drop) or 1/2 (same slope).

    Examples
    --------
    >>> from aeroservo.aero.vlm import VortexLattice, lattice, lattice_surface
    >>> flap = Hinge(span_from=0.0, span_to=1.0, chord_from=0.5, chord_to=0.5)
    >>> two = VortexLattice(chordwise=2, spanwise=1)
    >>> s = lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1], hinges=[flap], options=two)
    >>> control_normalwash(lattice([s]), "flap", "w", flap).values.ravel()
    array([0.25, 1.  ])
    """
    if surface not in lattice.surfaces:
        raise ValueError(f"the lattice has no surface {surface!r}; it has {', '.join(lattice.surfaces)}")
    here = lattice.strip_surface == lattice.surfaces.index(surface)
    strip_hinge = np.where(here, hinge.at(lattice.strip_span), np.nan)[lattice.strip]
    low, high = panel_cells(lattice)
    if kind == "hinged":
        share = np.clip((high - strip_hinge) / (high - low), 0.0, 1.0)
    else:
        factor = 2.0 if reading == "same_drop" else 1.0
        at = lattice.fraction @ np.array([0.25, 0.75])
        share = factor * np.maximum(at - strip_hinge, 0.0) / (1.0 - strip_hinge)
    share = gain * np.where(np.isfinite(strip_hinge), share, 0.0)
    if parity < 0:
        share = share * lattice.strip_side[lattice.strip]
    return Normalwash(names=(name,), values=share[:, None], parity=np.array([parity]))


def motion_normalwash(
    lattice: Lattice,
    names: Sequence[str],
    displacement: np.ndarray,
    slope: np.ndarray,
    reduced: float | np.ndarray,
    parity: np.ndarray,
) -> Normalwash:
    """Columns of any mode shapes that also move: tilt of the surface, less its own normal velocity.

    Parameters
    ----------
    lattice : Lattice
        The panels.
    names : sequence of str, length m
        Names of the modes.
    displacement, slope : array_like, shape (n, m)
        Displacement along the normal at the control points [m per unit] and its derivative along x. [1/unit]
    reduced : float or array_like, shape (m,)
        Rate of the mode over airspeed: 0 for a static shape. [1/m]
    parity : array_like, shape (m,)
        +1 or -1.

    Returns
    -------
    Normalwash
        -slope - reduced * displacement, the quasi-steady limit without the wake's memory.

    References
    ----------
    Substantial derivative of the surface; thesis [3.13] at C(k) = 1 without apparent mass.

    Examples
    --------
    >>> from aeroservo.aero.vlm import VortexLattice, lattice, lattice_surface
    >>> one = VortexLattice(chordwise=1, spanwise=1)
    >>> grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1], options=one)])
    >>> motion_normalwash(grid, ["heave up"], [[1.0]], [[0.0]], 0.1, [1]).values.tolist()
    [[-0.1]]
    """
    values = -np.asarray(slope, dtype=float) - np.asarray(reduced, dtype=float) * np.asarray(displacement, dtype=float)
    values = np.broadcast_to(values, (len(lattice), len(names)))
    return Normalwash(names=tuple(names), values=values, parity=np.asarray(parity))


def join_normalwash(parts: Sequence[Normalwash]) -> Normalwash:
    """All columns side by side.

    Parameters
    ----------
    parts : sequence of Normalwash
        Columns on the same panels.

    Returns
    -------
    Normalwash
        The columns in order.

    Raises
    ------
    ValueError
        If a name comes twice.

    References
    ----------
    J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 12: any number of right-hand sides, one matrix.

    Examples
    --------
    >>> one = Normalwash(names=("a",), values=np.ones((2, 1)), parity=np.array([1]))
    >>> two = Normalwash(names=("b",), values=np.zeros((2, 1)), parity=np.array([-1]))
    >>> join_normalwash([one, two]).names
    ('a', 'b')
    """
    names = tuple(name for part in parts for name in part.names)
    if len(set(names)) != len(names):
        raise ValueError(f"names of inputs must differ, got {names}")
    return Normalwash(
        names=names,
        values=np.concatenate([p.values for p in parts], axis=1),
        parity=np.concatenate([p.parity for p in parts]),
    )


def panel_cells(lattice: Lattice) -> tuple[np.ndarray, np.ndarray]:
    """The stretch of the chord that each control point stands for: from its panel's vortex to the next one.

    Parameters
    ----------
    lattice : Lattice
        The panels, strip by strip.

    Returns
    -------
    low, high : ndarray, shape (n,)
        Chord fractions; the first cell of a strip starts at its vortex, the last ends at the trailing edge. [-]

    References
    ----------
    R. M. James, Computer Methods in Applied Mechanics and Engineering 1(1), 1972, on what the 1/4-3/4 rule integrates.

    Examples
    --------
    >>> from aeroservo.aero.vlm import VortexLattice, lattice, lattice_surface
    >>> two = VortexLattice(chordwise=2, spanwise=1)
    >>> panel_cells(lattice([lattice_surface("w", [[0, 0, 0], [0, 2, 0]], [1, 1], options=two)]))[1]
    array([0.625, 1.   ])
    """
    front, rear = lattice.fraction.T
    low = front + 0.25 * (rear - front)
    last = np.append(lattice.strip[1:] != lattice.strip[:-1], True)
    return low, np.where(last, 1.0, np.append(low[1:], 1.0))


def mean_slope(slope: Callable[[np.ndarray], np.ndarray], low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Mean of a mean line's slope over stretches of the chord, weighted as thin-airfoil theory weighs it.

    Parameters
    ----------
    slope : callable
        Slope dz/dx at chord fractions (...). [-]
    low, high : array_like, shape (n,)
        Chord fractions of the ends, as of `panel_cells`. [-]

    Returns
    -------
    mean : ndarray, shape (n,)
        Weighted with sqrt(x/(1 - x)), the weight of the lift integral: the zero-lift angle of a reflexed foil is then
        right with few panels, where the slope at the control point misses the trailing edge. [-]

    References
    ----------
    M. Munk, NACA Report 142, 1922, section on the integral for the zero-lift angle.

    Examples
    --------
    >>> bool(abs(mean_slope(lambda x: x, np.array([0.9]), np.array([1.0]))[0] - 0.9667) < 1e-3)
    True
    """
    node, weight = np.polynomial.legendre.leggauss(8)
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    start = np.arccos(1.0 - 2.0 * low)
    end = np.arccos(1.0 - 2.0 * high)
    t = start[:, None] + (end - start)[:, None] * (node + 1.0) / 2.0
    weights = weight * (1.0 - np.cos(t))
    return np.asarray(np.sum(weights * slope((1.0 - np.cos(t)) / 2.0), axis=1) / np.sum(weights, axis=1))
