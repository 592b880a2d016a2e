"""Manoeuvres: airspeed and altitude against time, by straight lines between points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.datatypes import Array, FlightCondition, frozen


@dataclass(frozen=True, kw_only=True, eq=False)
class Profile:
    """Airspeed and altitude (or density) at points in time, linear between them, held outside.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Times, ascending from 0. [s]
    V : ndarray, shape (n,)
        True airspeed, positive. [m/s]
    altitude : ndarray, shape (n,), optional
        Geopotential altitude; without it give `density`. [m]
    density : float, optional
        Air density, the same all along. [kg/m^3]
    """

    t: Array
    V: Array
    altitude: Array | None = None
    density: float | None = None

    def __post_init__(self) -> None:
        """Lock the arrays and check them."""
        object.__setattr__(self, "t", frozen(self.t, ndim=1, name="t"))
        for name in ("V", "altitude"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, frozen(np.broadcast_to(value, self.t.shape), ndim=1, name=name))
        if self.t[0] != 0.0 or np.any(np.diff(self.t) <= 0.0):
            raise ValueError("times t of a profile must ascend from 0 [s]")
        if (self.altitude is None) == (self.density is None):
            raise ValueError("a profile needs either altitude [m] or density [kg/m^3]")
        self.condition(self.t)

    @property
    def moving(self) -> bool:
        """Whether airspeed or altitude changes. [-]"""
        altitude = self.V[:1] if self.altitude is None else self.altitude
        return bool(np.ptp(self.V) or np.ptp(altitude))

    @property
    def duration(self) -> float:
        """Time of the last point. [s]"""
        return float(self.t[-1])

    def speed(self, t: ArrayLike) -> Array:
        """True airspeed at times (...), same shape. [m/s]"""
        return np.asarray(np.interp(np.asarray(t, dtype=float), self.t, self.V))

    def condition(self, t: ArrayLike) -> FlightCondition:
        """Flight condition at times (...), same shape. [m/s, kg/m^3]"""
        V = self.speed(t)
        if self.altitude is None:
            return FlightCondition(V=V, rho=np.full(np.shape(V), self.density))
        return FlightCondition.at(np.interp(np.asarray(t, dtype=float), self.t, self.altitude), V=V)

    def distance(self, t: ArrayLike) -> Array:
        """Way flown since t = 0 at times (...), same shape; exact for straight lines. [m]"""
        t = np.asarray(t, dtype=float)
        at = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(self.t) * (self.V[1:] + self.V[:-1]))])
        i = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, len(self.t) - 1)
        inside = t - self.t[i]
        return np.asarray(at[i] + 0.5 * inside * (self.V[i] + self.speed(t)))


def level(V: float, *, altitude: float | None = None, density: float | None = None) -> Profile:
    """Constant airspeed and height.

    Parameters
    ----------
    V : float
        True airspeed. [m/s]
    altitude : float, optional
        Geopotential altitude, 0 where neither is given. [m]
    density : float, optional
        Air density instead. [kg/m^3]

    Returns
    -------
    profile : Profile
        Of one point.
    """
    if density is None and altitude is None:
        altitude = 0.0
    return Profile(
        t=np.zeros(1), V=np.array([V]), altitude=None if altitude is None else np.array([altitude]), density=density
    )


def climb(
    *,
    V: tuple[float, float] = (15.0, 130.0),
    altitude: tuple[float, float] = (0.0, 3048.0),
    duration: float = 115.0,
) -> Profile:
    """Two ramps, of airspeed and of altitude; the defaults are the thesis' climb and acceleration.

    Parameters
    ----------
    V : tuple of float, length 2
        True airspeed at the start and the end. [m/s]
    altitude : tuple of float, length 2
        Geopotential altitude at the start and the end. [m]
    duration : float
        Time of the ramps. [s]

    Returns
    -------
    profile : Profile
        Of two points.

    Raises
    ------
    ValueError
        If the duration is not positive.

    References
    ----------
    Bramstång 2015, section 8.4 and Fig. 36: 15 m/s at sea level to 130 m/s at 3,048 m (10,000 ft) in 115 s.
    """
    if not duration > 0.0:
        raise ValueError(f"duration of a climb must be positive [s], got {duration:g}")
    return Profile(t=np.array([0.0, duration]), V=np.array(V), altitude=np.array(altitude))
