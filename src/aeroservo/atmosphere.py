"""The U.S. Standard Atmosphere 1976, as functions of arrays.

Altitudes are geopotential unless `geometric=True`. The standard builds pressure from seven layers in which the
temperature is linear in geopotential altitude; nothing here is interpolated from a table. Valid from -5 km to 80 km
in either measure. Above 80 km *geometric* (79.006 km geopotential) the air's composition starts to change: in that
last kilometre the temperature returned is the molecular-scale temperature, at most 0.003 % above the kinetic one.

No humidity, no day other than the standard one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "STANDARD_GRAVITY",
    "ALTITUDE_RANGE",
    "RHO_SEA_LEVEL",
    "Air",
    "atmosphere",
    "dynamic_viscosity",
    "equivalent_airspeed",
    "geometric_altitude",
    "geopotential_altitude",
    "speed_of_sound",
    "true_airspeed",
]

#: Lowest and highest altitude accepted, geopotential or geometric. [m]
ALTITUDE_RANGE = (-5_000.0, 80_000.0)

# Defining constants, US Standard Atmosphere 1976, Tables 2 and 4 and section 1.
_R_EARTH = 6_356_766.0  # effective radius of the Earth                 [m]
STANDARD_GRAVITY = 9.80665  # of the standard, and of every weight in this package [m/s^2]
_R_AIR = 8314.32 / 28.9644  # specific gas constant of dry air (R*/M0)      [J/(kg K)]
_GAMMA = 1.4  # ratio of specific heats                       [-]
_BETA, _SUTHERLAND = 1.458e-6, 110.4  # Sutherland's law   [kg/(m s sqrt(K))], [K]
_P0, _T0 = 101_325.0, 288.15  # sea level                                  [Pa], [K]
_H = (0.0, 11e3, 20e3, 32e3, 47e3, 51e3, 71e3)  # base of each layer, geopotential [m]
_LAPSE = (-6.5e-3, 0.0, 1.0e-3, 2.8e-3, 0.0, -2.8e-3, -2.0e-3)  # dT/dH in each layer   [K/m]

#: Density at sea level, 1.2250 kg/m^3 to the digits the standard prints. [kg/m^3]
RHO_SEA_LEVEL = _P0 / (_R_AIR * _T0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Air:
    """State of the standard atmosphere at one or many altitudes.

    Parameters
    ----------
    T : ndarray, shape (...)
        Temperature. [K]
    p : ndarray, shape (...)
        Static pressure. [Pa]
    rho : ndarray, shape (...)
        Density. [kg/m^3]
    a_sound : ndarray, shape (...)
        Speed of sound. [m/s]
    mu : ndarray, shape (...)
        Dynamic viscosity. [Pa s]

    References
    ----------
    U.S. Standard Atmosphere 1976, NOAA-S/T 76-1562.

    Examples
    --------
    >>> air = atmosphere(0.0)
    >>> float(air.T), float(air.p), round(float(air.nu), 9)
    (288.15, 101325.0, 1.4607e-05)
    """

    T: NDArray[np.float64]  # (...)  temperature        [K]
    p: NDArray[np.float64]  # (...)  static pressure    [Pa]
    rho: NDArray[np.float64]  # (...)  density            [kg/m^3]
    a_sound: NDArray[np.float64]  # (...)  speed of sound     [m/s]
    mu: NDArray[np.float64]  # (...)  dynamic viscosity  [Pa s]

    def __post_init__(self) -> None:
        for field in fields(self):
            value = np.array(getattr(self, field.name), dtype=float)
            value.flags.writeable = False
            object.__setattr__(self, field.name, value)

    @property
    def nu(self) -> NDArray[np.float64]:
        """Kinematic viscosity mu/rho, shape (...). [m^2/s]"""
        return np.asarray(self.mu / self.rho)


def atmosphere(altitude: ArrayLike, *, geometric: bool = False) -> Air:
    """Air of the standard day at an altitude.

    Parameters
    ----------
    altitude : array_like, shape (...)
        Altitude above mean sea level, from -5,000 to 80,000 m. [m]
    geometric : bool
        False (default): `altitude` is geopotential. True: it is the height a tape measure would give.

    Returns
    -------
    air : Air
        Temperature, pressure, density, speed of sound, viscosity, each of shape (...).

    Raises
    ------
    ValueError
        If any altitude is outside -5,000 to 80,000 m, or is not a number.

    References
    ----------
    U.S. Standard Atmosphere 1976, NOAA-S/T 76-1562, Eqs. 18, 23, 33a, 33b, 42, 50, 51.

    Examples
    --------
    >>> air = atmosphere(3048.0)
    >>> print(f"{air.T:.3f} {air.p:.1f} {air.rho:.6f} {air.a_sound:.3f}")
    268.338 69681.7 0.904637 328.387
    """
    z = _checked(altitude)
    H = geopotential_altitude(z) if geometric else z
    layer = np.searchsorted(_LAYER_H[1:], H, side="right")
    lapse, T_base = _LAYER_LAPSE[layer], _LAYER_T[layer]
    above = H - _LAYER_H[layer]
    T = T_base + lapse * above
    # ln(p/p_base) = -(g0/R) * integral dH/T; the integral is above/T_base * ln(1 + u)/u with u = lapse*above/T_base.
    u = lapse * above / T_base
    safe = np.where(u == 0.0, 1.0, u)
    integral = above / T_base * np.where(u == 0.0, 1.0, np.log1p(safe) / safe)
    p = _LAYER_P[layer] * np.exp(-STANDARD_GRAVITY / _R_AIR * integral)
    return Air(T=T, p=p, rho=p / (_R_AIR * T), a_sound=np.sqrt(_GAMMA * _R_AIR * T), mu=dynamic_viscosity(T))


def geopotential_altitude(altitude: ArrayLike) -> NDArray[np.float64]:
    """Geopotential altitude of a geometric one: H = r0 z/(r0 + z).

    Parameters
    ----------
    altitude : array_like, shape (...)
        Geometric altitude, above -r0 = -6,356,766 m. [m]

    Returns
    -------
    H : ndarray, shape (...)
        Geopotential altitude: the potential energy per unit mass over the standard gravity. [m]

    Raises
    ------
    ValueError
        If any altitude is at or below the centre of the standard's Earth, or is not a number.

    References
    ----------
    U.S. Standard Atmosphere 1976, NOAA-S/T 76-1562, Eq. 18.

    Examples
    --------
    >>> round(float(geopotential_altitude(80_000.0)), 1)
    79005.7
    """
    z = np.asarray(altitude, dtype=float)
    if not np.all(z > -_R_EARTH):
        raise ValueError(f"geometric altitude must be above {-_R_EARTH:,.0f} [m], got {_first(z, z > -_R_EARTH):g}")
    return np.asarray(_R_EARTH * z / (_R_EARTH + z))


def geometric_altitude(altitude: ArrayLike) -> NDArray[np.float64]:
    """Geometric altitude of a geopotential one: z = r0 H/(r0 - H).

    Parameters
    ----------
    altitude : array_like, shape (...)
        Geopotential altitude, below r0 = 6,356,766 m. [m]

    Returns
    -------
    z : ndarray, shape (...)
        Geometric altitude. [m]

    Raises
    ------
    ValueError
        If any altitude is at or above r0, which no geometric height reaches, or is not a number.

    References
    ----------
    U.S. Standard Atmosphere 1976, NOAA-S/T 76-1562, Eq. 19.

    Examples
    --------
    >>> round(float(geometric_altitude(geopotential_altitude(12_345.0))), 6)
    12345.0
    """
    H = np.asarray(altitude, dtype=float)
    if not np.all(H < _R_EARTH):
        raise ValueError(f"geopotential altitude must be below {_R_EARTH:,.0f} [m], got {_first(H, H < _R_EARTH):g}")
    return np.asarray(_R_EARTH * H / (_R_EARTH - H))


def speed_of_sound(T: ArrayLike) -> NDArray[np.float64]:
    """Speed of sound in dry air, sqrt(gamma R T), with gamma = 1.4.

    Parameters
    ----------
    T : array_like, shape (...)
        Temperature, positive. [K]

    Returns
    -------
    a_sound : ndarray, shape (...)
        Speed of sound. [m/s]

    Raises
    ------
    ValueError
        If any temperature is not positive.

    References
    ----------
    U.S. Standard Atmosphere 1976, NOAA-S/T 76-1562, Eq. 50.

    Examples
    --------
    >>> round(float(speed_of_sound(288.15)), 3)
    340.294
    """
    return np.sqrt(_GAMMA * _R_AIR * _positive(T, "temperature T", "K"))


def dynamic_viscosity(T: ArrayLike) -> NDArray[np.float64]:
    """Dynamic viscosity of air by Sutherland's law, beta T^(3/2)/(T + 110.4 K).

    Parameters
    ----------
    T : array_like, shape (...)
        Temperature, positive. The law is empirical: the standard itself warns of it above 80 km. [K]

    Returns
    -------
    mu : ndarray, shape (...)
        Dynamic viscosity. [Pa s]

    Raises
    ------
    ValueError
        If any temperature is not positive.

    References
    ----------
    U.S. Standard Atmosphere 1976, NOAA-S/T 76-1562, Eq. 51.

    Examples
    --------
    >>> print(f"{dynamic_viscosity(288.15):.4e}")
    1.7894e-05
    """
    T = _positive(T, "temperature T", "K")
    return _BETA * T * np.sqrt(T) / (T + _SUTHERLAND)


def equivalent_airspeed(V: ArrayLike, rho: ArrayLike) -> NDArray[np.float64]:
    """Equivalent airspeed: the speed at sea-level density with the same dynamic pressure.

    Parameters
    ----------
    V : array_like, shape (...)
        True airspeed. [m/s]
    rho : array_like, shape (...)
        Air density, positive. [kg/m^3]

    Returns
    -------
    V_eas : ndarray, shape (...)
        V sqrt(rho/rho_0) with rho_0 the sea-level density of this atmosphere. [m/s]

    Raises
    ------
    ValueError
        If any density is not positive.

    References
    ----------
    ISO 2533:1975, standard atmosphere; rho_0 from U.S. Standard Atmosphere 1976, NOAA-S/T 76-1562, Eq. 42.

    Examples
    --------
    >>> round(float(equivalent_airspeed(100.0, atmosphere(3048.0).rho)), 4)
    85.9348
    """
    return np.asarray(V, dtype=float) * np.sqrt(_positive(rho, "density rho", "kg/m^3") / RHO_SEA_LEVEL)


def true_airspeed(V_eas: ArrayLike, rho: ArrayLike) -> NDArray[np.float64]:
    """True airspeed of an equivalent one, the inverse of `equivalent_airspeed`.

    Parameters
    ----------
    V_eas : array_like, shape (...)
        Equivalent airspeed. [m/s]
    rho : array_like, shape (...)
        Air density, positive. [kg/m^3]

    Returns
    -------
    V : ndarray, shape (...)
        True airspeed V_eas sqrt(rho_0/rho). [m/s]

    Raises
    ------
    ValueError
        If any density is not positive.

    References
    ----------
    ISO 2533:1975, standard atmosphere; rho_0 from U.S. Standard Atmosphere 1976, NOAA-S/T 76-1562, Eq. 42.

    Examples
    --------
    >>> rho = atmosphere(3048.0).rho
    >>> round(float(true_airspeed(equivalent_airspeed(100.0, rho), rho)), 9)
    100.0
    """
    return np.asarray(V_eas, dtype=float) * np.sqrt(RHO_SEA_LEVEL / _positive(rho, "density rho", "kg/m^3"))


def _checked(altitude: ArrayLike) -> NDArray[np.float64]:
    """Altitude as a float array, inside the range of the standard."""
    z = np.asarray(altitude, dtype=float)
    low, high = ALTITUDE_RANGE
    inside = (z >= low) & (z <= high)  # False for NaN
    if not np.all(inside):
        raise ValueError(f"altitude must be from {low:,.0f} to {high:,.0f} [m], got {_first(z, inside):g}")
    return z


def _positive(x: ArrayLike, name: str, unit: str) -> NDArray[np.float64]:
    """Float array, every element positive."""
    x = np.asarray(x, dtype=float)
    if not np.all(x > 0.0):
        raise ValueError(f"{name} must be positive [{unit}], got {_first(x, x > 0.0):g}")
    return x


def _first(x: NDArray[np.float64], good: NDArray[np.bool_]) -> float:
    """First element that is not good."""
    return float(x[~good].flat[0])


def _layer_bases() -> tuple[list[float], list[float]]:
    """Temperature [K] and pressure [Pa] at the base of each layer, climbing from sea level."""
    T, p = [_T0], [_P0]
    for lapse, bottom, top in zip(_LAPSE[:-1], _H[:-1], _H[1:], strict=True):
        rise = lapse * (top - bottom)
        if lapse:
            p.append(p[-1] * (T[-1] / (T[-1] + rise)) ** (STANDARD_GRAVITY / (_R_AIR * lapse)))
        else:
            p.append(p[-1] * math.exp(-STANDARD_GRAVITY * (top - bottom) / (_R_AIR * T[-1])))
        T.append(T[-1] + rise)
    return T, p


_LAYER_H, _LAYER_LAPSE = np.array(_H), np.array(_LAPSE)
_LAYER_T, _LAYER_P = (np.array(base) for base in _layer_bases())
