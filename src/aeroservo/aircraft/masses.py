"""Mass items and what they add up to: mass, centre of gravity, inertia.

Geometry axes throughout (x aft, y to starboard, z up). The inertia matrix follows the usual definition,
diag = integral of (y^2 + z^2) etc. and MINUS the products off the diagonal. Turning it to body axes (x forward,
z down) changes the sign of the xy and yz terms only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from aeroservo.aircraft.geometry import LiftingSurface, span_stations


@dataclass(frozen=True, kw_only=True, eq=False)
class MassItem:
    """A rigid lump.

    Parameters
    ----------
    name : str
        Name of the item.
    mass : float
        Mass, not negative. [kg]
    position : array_like, shape (3,)
        Centre of gravity of the item. [m]
    inertia : array_like, shape (3, 3)
        Inertia about the item's own centre of gravity. [kg m^2]
    mirrored : bool
        Whether a twin exists at -y (its mass comes on top).
    """

    name: str
    mass: float
    position: np.ndarray
    inertia: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))
    mirrored: bool = False

    def __post_init__(self) -> None:
        position = np.array(self.position, dtype=float)
        inertia = np.array(self.inertia, dtype=float)
        if not (np.isfinite(self.mass) and self.mass >= 0.0):
            raise ValueError(f"mass of {self.name!r} must be >= 0 [kg], got {self.mass:g}")
        if position.shape != (3,) or not np.all(np.isfinite(position)):
            raise ValueError(f"position of {self.name!r} must be three finite numbers [m], got {self.position}")
        if inertia.shape != (3, 3) or not np.allclose(inertia, inertia.T, rtol=1e-9, atol=1e-12):
            raise ValueError(f"inertia of {self.name!r} must be a symmetric 3 x 3 matrix [kg m^2], got {self.inertia}")
        if np.linalg.eigvalsh(inertia).min() < -1e-9 * max(1e-300, np.abs(inertia).max()):
            raise ValueError(f"inertia of {self.name!r} must not have a negative principal value [kg m^2]")
        for name, value in (("position", position), ("inertia", inertia)):
            value.flags.writeable = False
            object.__setattr__(self, name, value)


@dataclass(frozen=True, kw_only=True, eq=False)
class MassProperties:
    """What mass items add up to, in geometry axes."""

    mass: float  # [kg]
    cg: np.ndarray  # (3,) [m] centre of gravity
    inertia: np.ndarray  # (3, 3) [kg m^2] about the centre of gravity

    def about(self, point: np.ndarray) -> np.ndarray:
        """Inertia about another point (3,) [m], shape (3, 3) [kg m^2]."""
        return self.inertia + _steiner(self.mass, self.cg - np.asarray(point, dtype=float))


def mass_properties(items: Sequence[MassItem]) -> MassProperties:
    """Total mass, centre of gravity, and inertia about it.

    Parameters
    ----------
    items : sequence of MassItem
        The lumps; mirrored ones count twice.

    Returns
    -------
    MassProperties
        In geometry axes.

    Raises
    ------
    ValueError
        If the total mass is zero.

    References
    ----------
    Parallel-axis theorem; thesis [5.17] uses the result.

    Examples
    --------
    >>> both = mass_properties([MassItem(name="tip", mass=1.0, position=[0.0, 2.0, 0.0], mirrored=True)])
    >>> both.mass, both.cg.tolist(), float(both.inertia[0, 0])
    (2.0, [0.0, 0.0, 0.0], 8.0)
    """
    lumps = [lump for item in items for lump in _both_sides(item)]
    total = sum(item.mass for item in lumps)
    if total <= 0.0:
        raise ValueError(f"the total mass must be > 0 [kg], got {total:g} from {len(items)} item(s)")
    cg = sum((item.mass * item.position for item in lumps), np.zeros(3)) / total
    inertia = sum((item.inertia + _steiner(item.mass, item.position - cg) for item in lumps), np.zeros((3, 3)))
    return MassProperties(mass=float(total), cg=cg, inertia=inertia)


def planform_mass(surface: LiftingSurface, mass: float, *, name: str = "") -> MassItem:
    """A mass spread evenly over the planform of a surface and its twin.

    Parameters
    ----------
    surface : LiftingSurface
        The surface; its thickness is neglected (a flat lamina, along the chord lines).
    mass : float
        Mass of the surface with its twin. [kg]
    name : str
        Name of the item; that of the surface when empty.

    Returns
    -------
    MassItem
        One lump with its centre of gravity and inertia, exact for trapezoids.

    Raises
    ------
    ValueError
        If the mass is negative.

    References
    ----------
    Lamina of constant mass per area; the check of I_y = 0.498 kg m^2 against thesis Table 1 (0.503) uses it.

    Examples
    --------
    >>> from aeroservo.aircraft.geometry import WingSection
    >>> plate = LiftingSurface(name="p", sections=(WingSection(y=0.0, chord=1.0), WingSection(y=1.0, chord=1.0)))
    >>> item = planform_mass(plate, 12.0)
    >>> [round(float(v), 9) for v in (item.position[0], item.inertia[1, 1], item.inertia[0, 0])]
    [0.5, 1.0, 4.0]
    """
    points, weights = _lamina(surface)
    lumps = weights / weights.sum() * mass
    items = [MassItem(name="dm", mass=m, position=p) for m, p in zip(lumps, points)]
    if mass < 0.0 or not items:
        raise ValueError(f"mass of {surface.name!r} must be >= 0 [kg], got {mass:g}")
    if mass == 0.0:
        return MassItem(name=name or surface.name, mass=0.0, position=weights @ points / weights.sum())
    total = mass_properties(items)
    centre = total.cg * [1.0, 0.0 if surface.mirrored else 1.0, 1.0]  # on the plane of symmetry, to the last digit
    return MassItem(name=name or surface.name, mass=mass, position=centre, inertia=total.inertia)


def _lamina(surface: LiftingSurface) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points (n, 3) and area weights of the planform; exact for quadratic functions on trapezoids."""
    node_s, weight_s = np.polynomial.legendre.leggauss(3)
    node_c, weight_c = np.polynomial.legendre.leggauss(2)
    t, xi = (node_s + 1.0) / 2.0, (node_c + 1.0) / 2.0
    lengths = np.diff(span_stations(surface))
    edge, chord = surface.leading_edge, surface.chords
    points, weights = [], []
    for i, length in enumerate(lengths):
        e = edge[i] + t[:, None] * (edge[i + 1] - edge[i])
        c = chord[i] + t * (chord[i + 1] - chord[i])
        grid = e[:, None, :] + np.stack([np.outer(c, xi), np.zeros((3, 2)), np.zeros((3, 2))], axis=-1)
        points.append(grid.reshape(-1, 3))
        weights.append((length * weight_s[:, None] / 2.0 * c[:, None] * weight_c[None, :] / 2.0).ravel())
    p, w = np.concatenate(points), np.concatenate(weights)
    if surface.mirrored:
        p, w = np.concatenate([p, p * [1.0, -1.0, 1.0]]), np.concatenate([w, w])
    return p, w


def _both_sides(item: MassItem) -> tuple[MassItem, ...]:
    if not item.mirrored:
        return (item,)
    flip = np.diag([1.0, -1.0, 1.0])
    twin = MassItem(name=item.name, mass=item.mass, position=flip @ item.position, inertia=flip @ item.inertia @ flip)
    return (MassItem(name=item.name, mass=item.mass, position=item.position, inertia=item.inertia), twin)


def _steiner(mass: float, r: np.ndarray) -> np.ndarray:
    return mass * (np.dot(r, r) * np.eye(3) - np.outer(r, r))
