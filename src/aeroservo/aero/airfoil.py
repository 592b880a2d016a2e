"""Airfoil outlines: re-panelling, thickness and camber.

An outline runs from the trailing edge over the upper surface to the leading edge and back below, x aft and z up, with
the chord from x = 0 to x = 1. The two surfaces may cross near the trailing edge, as those of reflexed airfoils with
rounded coordinates do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from aeroservo.aero.airfoil_naca import naca_camber
from aeroservo.datatypes import frozen

#: Fewest points that still say where an outline runs.
FEWEST = 7


@dataclass(frozen=True, kw_only=True, eq=False)
class Airfoil:
    """A named outline on a chord of one.

    Parameters
    ----------
    name : str
        Name.
    points : array_like, shape (n, 2)
        Outline from the upper trailing edge round the leading edge to the lower one, in chords. [-]
    """

    name: str
    points: np.ndarray

    def __post_init__(self) -> None:
        points = frozen(self.points, ndim=2, name=f"outline of {self.name!r}")
        if points.shape[1] != 2 or len(points) < FEWEST:
            raise ValueError(
                f"airfoil {self.name!r} needs {FEWEST} or more points (x, z) to say where it runs, got {len(points)}"
            )
        object.__setattr__(self, "points", points)


def repanel(foil: Airfoil, n: int = 160) -> Airfoil:
    """The same outline on n panels, closer together at leading and trailing edge.

    Parameters
    ----------
    foil : Airfoil
        The outline.
    n : int
        Number of panels, even, 20 or more.

    Returns
    -------
    Airfoil
        n + 1 points on the cubic spline through the given ones; both trailing-edge points are kept.

    Raises
    ------
    ValueError
        If n is odd or too small.

    References
    ----------
    M. Drela, XFOIL, 1989, section 3 of its guide (spline over the arc length).

    Examples
    --------
    >>> from aeroservo.aero.airfoil_files import airfoil
    >>> len(repanel(airfoil("mh62"), 100).points)
    101
    """
    if n < 20 or n % 2:
        raise ValueError(f"number of panels n must be even and >= 20, got {n}")
    spline, length, nose = _spline(foil)
    half = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, n // 2 + 1)))
    at = np.concatenate([nose * half, nose + (length - nose) * half[1:]])
    return Airfoil(name=foil.name, points=spline(at))


def surfaces(foil: Airfoil, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Height of the upper and lower surface.

    Parameters
    ----------
    foil : Airfoil
        The outline.
    x : array_like, shape (...)
        Stations in [0, 1]. [-]

    Returns
    -------
    upper, lower : ndarray, shape (...)
        Heights over the chord. [-]

    References
    ----------
    Project convention: a cubic spline over the arc length, read at x.

    Examples
    --------
    >>> from aeroservo.aero.airfoil_files import airfoil
    >>> upper, lower = surfaces(airfoil("naca0012"), np.array([0.3]))
    >>> round(float(upper[0] - lower[0]), 4)
    0.12
    """
    spline, length, nose = _spline(foil)
    dense = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 2001)))
    heights = []
    for low, high in ((0.0, nose), (nose, length)):
        p = spline(low + (high - low) * dense)
        p = p[np.argsort(p[:, 0], kind="stable")]
        heights.append(np.interp(np.asarray(x, dtype=float), p[:, 0], p[:, 1]))
    return heights[0], heights[1]


def thickness(foil: Airfoil) -> tuple[float, float]:
    """Largest thickness and where it is.

    Parameters
    ----------
    foil : Airfoil
        The outline.

    Returns
    -------
    t, x : float
        Largest vertical distance of the surfaces, and its station, in chords. [-]

    References
    ----------
    I. Abbott, A. von Doenhoff, Theory of Wing Sections, 1959, section 6.2.

    Examples
    --------
    >>> from aeroservo.aero.airfoil_files import airfoil
    >>> [round(v, 3) for v in thickness(airfoil("mh62"))]
    [0.093, 0.269]
    """
    x = np.linspace(0.0, 1.0, 1001)
    upper, lower = surfaces(foil, x)
    at = int(np.argmax(upper - lower))
    return float((upper - lower)[at]), float(x[at])


def mean_line(foil: Airfoil, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean line, half-way between the surfaces, and its slope.

    Parameters
    ----------
    foil : Airfoil
        The outline.
    x : array_like, shape (...)
        Stations in [0, 1]. [-]

    Returns
    -------
    z, slope : ndarray, shape (...)
        Height and dz/dx; -slope is the normalwash of the lattice. By formula for NACA airfoils; else the slope comes
        from a cubic spline through 41 stations and means little ahead of 1 % of the chord. [-]

    References
    ----------
    J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 5.

    Examples
    --------
    >>> from aeroservo.aero.airfoil_files import airfoil
    >>> z, slope = mean_line(airfoil("naca2412"), np.array([0.0]))
    >>> round(float(slope[0]), 3)
    0.1
    """
    x = np.asarray(x, dtype=float)
    digits = foil.name.replace("NACA ", "")
    if foil.name.startswith("NACA ") and digits.isdigit():
        return naca_camber(digits, x)
    stations = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 41)))
    upper, lower = surfaces(foil, stations)
    slope = CubicSpline(stations, (upper + lower) / 2.0)(x, 1)
    upper, lower = surfaces(foil, x)
    return (upper + lower) / 2.0, np.asarray(slope)


def _spline(foil: Airfoil) -> tuple[CubicSpline, float, float]:
    """Spline over the arc length, its length, and where the leading edge (smallest x) lies on it."""
    steps = np.hypot(*np.diff(foil.points, axis=0).T)
    s = np.concatenate([[0.0], np.cumsum(steps)])
    spline = CubicSpline(s, foil.points, bc_type="natural")
    i = int(np.argmin(foil.points[:, 0]))
    near = np.linspace(s[max(i - 1, 0)], s[min(i + 1, len(s) - 1)], 2001)
    nose = near[int(np.argmin(spline(near)[:, 0]))]
    return spline, float(s[-1]), float(nose)
