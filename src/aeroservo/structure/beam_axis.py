"""Definition of a slender beam along a straight or kinked flexural axis.

What is modelled: transverse deflection with Bernoulli-Euler bending and St Venant torsion about
the flexural axis, with the line of the centres of gravity beside it. In-plane bending (lead-lag),
axial stretching, shear deformation, warping restraint and rotary inertia of the sections about
the chord are not.

Axes: x aft, y to starboard, z up. At a panel of sweep Lambda the flexural axis points along
t = (sin Lambda, cos Lambda, 0) and the chord of the section normal to it, positive aft, along
n = (cos Lambda, -sin Lambda, 0). A rotation vector R = (Rx, Ry, 0) is a slope of the upward
deflection dw/ds = R.n and a nose-up twist theta = R.t; plunge is h = -w, positive down.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

from aeroservo.datatypes import frozen
from aeroservo.structure.viscoelastic import Viscoelastic

Array = NDArray[np.float64]
Root = Literal["clamped", "free"]
Symmetry = Literal["symmetric", "antisymmetric"]

_STATION_FIELDS = ("mass", "inertia", "cg_offset", "chord", "EI", "GJ", "coupling", "sweep")


@dataclass(frozen=True, kw_only=True, eq=False)
class BeamMass:
    """A lump fixed to the flexural axis.

    Attributes
    ----------
    y : float
        Where it is attached, along the flexural axis. [m]
    mass : float
        Mass, not negative. [kg]
    x : float
        Its centre of gravity aft of the flexural axis, along the chord normal to the axis. [m]
    inertia : float
        Its own moment of inertia in twist, about its own centre of gravity; `mass * x**2` is added. [kg m^2]
    roll_inertia : float
        Its own moment of inertia about the x axis, about its own centre of gravity (of half a fuselage, say). [kg m^2]

    Raises
    ------
    ValueError
        If a mass or an inertia is negative, or a value not finite.

    Notes
    -----
    At a kink of the axis the lump belongs to the panel outboard of it.

    Examples
    --------
    >>> BeamMass(y=3.0, mass=2.0, x=0.1).mass
    2.0
    """

    y: float
    mass: float
    x: float = 0.0
    inertia: float = 0.0
    roll_inertia: float = 0.0

    def __post_init__(self) -> None:
        """Check the values."""
        for name, unit in (("y", "m"), ("mass", "kg"), ("x", "m"), ("inertia", "kg m^2"), ("roll_inertia", "kg m^2")):
            value = float(getattr(self, name))
            if not np.isfinite(value):
                raise ValueError(f"{name} of a lump must be finite [{unit}], got {value}")
            if value < 0.0 and name not in ("y", "x"):
                raise ValueError(f"{name} of a lump must be >= 0 [{unit}], got {value:g}")
            object.__setattr__(self, name, value)


@dataclass(frozen=True, kw_only=True, eq=False)
class SlenderBeam:
    """A wing as a beam: properties at stations along the flexural axis, linear between them.

    Attributes
    ----------
    y : array_like, shape (n,)
        Stations along the flexural axis (not along the span when swept), ascending, two or more; the first is the
        root. [m]
    mass : array_like, shape (n,) or scalar
        Mass per length of axis. [kg/m]
    inertia : array_like, shape (n,) or scalar
        Moment of inertia per length about the flexural axis. [kg m]
    EI, GJ : array_like, shape (n,) or scalar
        Bending and torsional stiffness. [N m^2]
    cg_offset : array_like, shape (n,) or scalar
        Centre of gravity aft of the flexural axis, along the chord normal to it, as a part of `chord`. [-, m where
        chord is left at 1 m]
    chord : array_like, shape (n,) or scalar
        Chord that `cg_offset` is a part of, linear between stations like everything else, so that the offset in
        metres of a tapered wing is the product of two straight lines. [m]
    coupling : array_like, shape (n,) or scalar
        Bend-twist stiffness K of the strain energy 1/2 (EI h''^2 + 2 K h'' theta' + GJ theta'^2), h down and theta
        nose up: K > 0 twists the section nose up where it is bent up (wash-in). K^2 < EI GJ. [N m^2]
    sweep : array_like, shape (n,) or scalar
        Sweep of the panel outboard of each station, positive aft; the last value is not used. [rad]
    masses : tuple of BeamMass
        Lumps.
    root : {"clamped", "free"}
        A free root is half of a free wing, cut by its plane of symmetry.
    symmetry : {"symmetric", "antisymmetric"}
        Of a free root: heave and pitch free, or roll free.
    origin : array_like, shape (3,)
        Where the root of the flexural axis lies in geometry axes (origin of these: root leading edge). [m]
    material : Viscoelastic, optional
        How EI and GJ, which are then the instantaneous ones, relax; the coupling stays elastic.

    Raises
    ------
    ValueError
        For fewer than two stations, stations not ascending, EI or GJ not positive, a sweep of 90 degrees or more, a
        negative mass, an inertia below mass * (cg_offset * chord)^2 anywhere, a coupling with K^2 >= EI GJ, a lump
        off the span.

    References
    ----------
    Bramstång 2015, section 4.1 (Eqs. 4.1-4.4); equations.md, Conventions.

    Examples
    --------
    >>> wing = SlenderBeam(y=[0.0, 6.096], mass=35.717, inertia=8.642, cg_offset=0.18288, EI=9.773e6, GJ=0.9876e6)
    >>> wing.length
    6.096
    """

    y: Array
    mass: Array
    inertia: Array
    EI: Array
    GJ: Array
    cg_offset: Array = 0.0  # type: ignore[assignment]
    chord: Array = 1.0  # type: ignore[assignment]
    coupling: Array = 0.0  # type: ignore[assignment]
    sweep: Array = 0.0  # type: ignore[assignment]
    masses: tuple[BeamMass, ...] = ()
    root: Root = "clamped"
    symmetry: Symmetry = "symmetric"
    origin: Array = (0.0, 0.0, 0.0)  # type: ignore[assignment]
    material: Viscoelastic | None = None

    def __post_init__(self) -> None:
        """Broadcast the properties over the stations, lock and check them."""
        y = frozen(self.y, name="y")
        if y.ndim != 1 or y.size < 2:
            raise ValueError(f"y must hold two or more stations [m], got shape {y.shape}")
        if np.any(np.diff(y) <= 0.0):
            raise ValueError(f"y must ascend from station to station [m], got {y.tolist()}")
        object.__setattr__(self, "y", y)
        for name in _STATION_FIELDS:
            value = np.asarray(getattr(self, name), dtype=float)
            if value.ndim != 0 and value.shape != y.shape:
                raise ValueError(f"{name} must be a number or one value per station {y.shape}, got shape {value.shape}")
            object.__setattr__(self, name, frozen(np.broadcast_to(value, y.shape), name=name))
        object.__setattr__(self, "origin", frozen(self.origin, name="origin"))
        if self.origin.shape != (3,):
            raise ValueError(f"origin must be three coordinates [m], got shape {self.origin.shape}")
        object.__setattr__(self, "masses", tuple(self.masses))
        _check_beam(self)

    @property
    def length(self) -> float:
        """Length of the flexural axis [m]."""
        return float(self.y[-1] - self.y[0])

    def at(self, name: str, y: ArrayLike) -> Array:
        """Property `name` ("EI", ...) at `y` along the axis [its SI unit], linear between stations; sweep is a step."""
        y = np.asarray(y, dtype=float)
        if name == "sweep":
            return np.asarray(self.sweep[self.panel(y)])
        value = np.asarray(np.interp(y, self.y, getattr(self, name)))
        return value * self.at("chord", y) if name == "cg_offset" else value

    def panel(self, y: ArrayLike) -> NDArray[np.intp]:
        """Number of the panel at `y`; at a station the panel outboard of it, at the tip the last."""
        found = np.searchsorted(self.y, np.asarray(y, dtype=float), side="right") - 1
        return np.clip(found, 0, self.y.size - 2)

    def position(self, y: ArrayLike) -> Array:
        """Points of the flexural axis at `y`, shape (..., 3), in geometry axes [m]."""
        y = np.asarray(y, dtype=float)
        tangent = axis_directions(self.sweep[:-1])[0]
        steps = tangent * np.diff(self.y)[:, None]
        corners = self.origin + np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
        panel = self.panel(y)
        return np.asarray(corners[panel] + tangent[panel] * (y - self.y[panel])[..., None])


def axis_directions(sweep: ArrayLike) -> tuple[Array, Array]:
    """Unit vectors along the flexural axis and along the chord normal to it.

    Parameters
    ----------
    sweep : array_like, shape (...)
        Sweep of the axis, positive aft. [rad]

    Returns
    -------
    tangent, chordwise : ndarray, shape (..., 3)
        t outboard along the axis, n aft along the chord, in geometry axes (x aft, y starboard, z up). [-]

    References
    ----------
    equations.md, Conventions (geometry axes); a nose-up twist is the rotation +theta about t.

    Examples
    --------
    >>> t, n = axis_directions(0.0)
    >>> t.tolist(), n.tolist()
    ([0.0, 1.0, 0.0], [1.0, -0.0, 0.0])
    """
    sweep = np.asarray(sweep, dtype=float)
    s, c, zero = np.sin(sweep), np.cos(sweep), np.zeros_like(sweep)
    return np.stack([s, c, zero], axis=-1), np.stack([c, -s, zero], axis=-1)


def gauss_points(nodes: ArrayLike, n: int) -> tuple[Array, Array]:
    """Gauss points and weights on each interval between ascending nodes.

    Parameters
    ----------
    nodes : array_like, shape (m,)
        Ends of the intervals. [m]
    n : int
        Points per interval.

    Returns
    -------
    y, weight : ndarray, shape ((m - 1) n,)
        Points [m] and weights [m].

    References
    ----------
    M. Abramowitz and I. Stegun, Handbook of Mathematical Functions, 1964, Eq. 25.4.29.

    Examples
    --------
    >>> y, weight = gauss_points([0.0, 1.0, 3.0], 2)
    >>> round(float(weight @ y**3), 9)
    20.25
    """
    nodes = np.asarray(nodes, dtype=float)
    xi, weight = legendre.leggauss(n)
    half = 0.5 * np.diff(nodes)[:, None]
    return (nodes[:-1, None] + half * (1.0 + xi)).ravel(), (half * weight).ravel()


def _check_beam(beam: SlenderBeam) -> None:
    """Refuse what no beam can be, naming field, unit, range and value."""
    for name in ("EI", "GJ"):
        value = getattr(beam, name)
        if np.any(value <= 0.0):
            raise ValueError(f"{name} must be positive at every station [N m^2], got {value.min():g}")
    worst = np.abs(beam.sweep).max()
    if np.degrees(worst) >= 90.0 - 1e-6:
        raise ValueError(f"sweep must lie between -90 and 90 deg, both excluded, got {np.degrees(worst):g} deg")
    if np.any(beam.mass < 0.0):
        raise ValueError(f"mass must be >= 0 at every station [kg/m], got {beam.mass.min():g}")
    # between stations m d^2 is cubic and EI GJ - K^2 quadratic, so the ends alone do not bound them
    y = np.unique(np.concatenate([np.linspace(a, b, 33) for a, b in zip(beam.y[:-1], beam.y[1:])]))
    m, inertia, d = beam.at("mass", y), beam.at("inertia", y), beam.at("cg_offset", y)
    short = inertia - m * d**2
    scale = 1e-9 * float(np.max(np.abs(inertia)))
    if np.any(short < -scale):
        i = int(np.argmin(short))
        raise ValueError(
            f"inertia about the flexural axis must be at least mass * cg_offset^2 = {m[i] * d[i] ** 2:g} kg m "
            f"at y = {y[i]:g} m, got {inertia[i]:g}"
        )
    margin = beam.at("EI", y) * beam.at("GJ", y) - beam.at("coupling", y) ** 2
    if np.any(margin <= 0.0):
        i = int(np.argmin(margin))
        found = float(beam.at("coupling", y[i]))
        raise ValueError(f"coupling^2 must stay below EI * GJ [N^2 m^4], got coupling {found:g} at y = {y[i]:g} m")
    for lump in beam.masses:
        if not beam.y[0] <= lump.y <= beam.y[-1]:
            raise ValueError(f"y of a lump must lie on the span, {beam.y[0]:g} to {beam.y[-1]:g} m, got {lump.y:g}")
    if beam.root not in ("clamped", "free"):
        raise ValueError(f'root must be "clamped" or "free", got {beam.root!r}')
    if beam.symmetry not in ("symmetric", "antisymmetric"):
        raise ValueError(f'symmetry must be "symmetric" or "antisymmetric", got {beam.symmetry!r}')
