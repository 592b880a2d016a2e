"""Design gusts of the certification codes: CS/FAR-25.341, CS/FAR-23.333, STANAG 4671.

Velocities U are EQUIVALENT airspeeds unless a name says otherwise; multiply by sqrt(rho_0/rho) for the true gust
(`aeroservo.atmosphere.true_airspeed`). The codes' turbulence intensity U_sigma is a TRUE airspeed already.

How far each clause was checked: U_ref was read in the text of ED Decision 2012/008/R and of the 2014 amendment of
FAR 25.341; F_g, U_sigma,ref and CS-23.333/STANAG 4671 were written from memory of the standards and checked for
consistency only. Read the clause before certifying anything by them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.atmosphere import true_airspeed
from aeroservo.gust.discrete import OneMinusCosine

__all__ = [
    "cs23_design_gust",
    "cs23_gust_velocity",
    "cs25_design_gust",
    "cs25_design_velocity",
    "cs25_gradients",
    "cs25_reference_velocity",
    "cs25_turbulence_intensity",
    "design_turbulence_load",
    "flight_profile_alleviation",
]

Array = NDArray[Any]

CS25_GRADIENT_RANGE = (9.0, 107.0)  # H of CS-25.341(a)(3), 30 to 350 ft [m]

_CS25_ALTITUDE, _CS25_U_REF = (0.0, 4572.0, 18288.0), (17.07, 13.41, 6.36)  # [m], [m/s] EAS
_CS25_SIGMA_ALTITUDE, _CS25_SIGMA = (0.0, 7315.0, 18288.0), (27.43, 24.08, 24.08)  # [m], [m/s] TAS
_CS23_ALTITUDE, _CS23_U_DE = (0.0, 6096.0, 15240.0), (15.24, 15.24, 7.62)  # [m], [m/s] EAS


def cs25_reference_velocity(altitude: ArrayLike, *, at_dive_speed: bool = False) -> Array:
    """Reference gust velocity U_ref of CS/FAR-25.341(a)(5).

    Parameters
    ----------
    altitude : array_like, shape (...)
        Altitude, 0 to 18,288 m (60,000 ft). [m]
    at_dive_speed : bool
        False: from V_B to V_C. True: at V_D, half.

    Returns
    -------
    U_ref : ndarray, shape (...)
        Equivalent airspeed. [m/s]

    Raises
    ------
    ValueError
        If an altitude is outside the range that the clause covers.

    References
    ----------
    CS-25.341(a)(5) (ED Decision 2012/008/R); 14 CFR 25.341(a)(5), amended 2014 (56.0, 44.0, 20.86 ft/s at 0, 15,000,
    60,000 ft). The FAR before 2014 went to 26 ft/s at 50,000 ft (from memory of the standard); not offered.

    Examples
    --------
    >>> cs25_reference_velocity([0.0, 2286.0, 18288.0])
    array([17.07, 15.24,  6.36])
    """
    return _table(altitude, _CS25_ALTITUDE, _CS25_U_REF) * (0.5 if at_dive_speed else 1.0)


def flight_profile_alleviation(
    altitude: ArrayLike, *, maximum_operating_altitude: float, landing_mass_ratio: float, zero_fuel_mass_ratio: float
) -> Array:
    """Flight profile alleviation factor F_g of CS/FAR-25.341(a)(6).

    Parameters
    ----------
    altitude : array_like, shape (...)
        Altitude, 0 to the maximum operating altitude. [m]
    maximum_operating_altitude : float
        Z_mo, positive. [m]
    landing_mass_ratio, zero_fuel_mass_ratio : float
        R1 = maximum landing over maximum take-off mass, R2 = maximum zero-fuel over maximum take-off mass, in
        (0, 1]. [-]

    Returns
    -------
    F_g : ndarray, shape (...)
        Linear from (F_gz + F_gm)/2 at sea level to 1 at Z_mo. [-]

    Raises
    ------
    ValueError
        If an altitude or a ratio is outside its range.

    References
    ----------
    CS-25.341(a)(6), 14 CFR 25.341(a)(6): F_gz = 1 - Z_mo/76,200 m, F_gm = sqrt(R2 tan(pi R1/4)); written from memory
    of the standard.

    Examples
    --------
    >>> round(float(flight_profile_alleviation(0.0, maximum_operating_altitude=12192.0, landing_mass_ratio=0.85,
    ...                                        zero_fuel_mass_ratio=0.75)), 4)
    0.8045
    """
    z = np.asarray(altitude, dtype=float)
    z_mo = maximum_operating_altitude
    if not 0.0 < z_mo < 76200.0:
        raise ValueError(f"maximum_operating_altitude must lie in (0, 76200) [m], got {z_mo:g}")
    for name, ratio in (("landing_mass_ratio", landing_mass_ratio), ("zero_fuel_mass_ratio", zero_fuel_mass_ratio)):
        if not 0.0 < ratio <= 1.0:
            raise ValueError(f"{name} must lie in (0, 1] [-], got {ratio:g}")
    if not np.all((z >= 0.0) & (z <= z_mo)):
        raise ValueError(
            f"altitude must lie in 0 to Z_mo = {z_mo:g} [m], got {z[~((z >= 0.0) & (z <= z_mo))].flat[0]:g}"
        )
    at_sea_level = 0.5 * (
        1.0 - z_mo / 76200.0 + np.sqrt(zero_fuel_mass_ratio * np.tan(0.25 * np.pi * landing_mass_ratio))
    )
    return at_sea_level + (1.0 - at_sea_level) * z / z_mo


def cs25_gradients(n: int = 10) -> Array:
    """Gust gradient distances H spread over the range of CS-25.341(a)(3).

    Parameters
    ----------
    n : int
        How many, at least 2: the clause asks for "a sufficient number".

    Returns
    -------
    H : ndarray, shape (n,)
        Equally spaced, 9 to 107 m. [m]

    Raises
    ------
    ValueError
        If n < 2.

    References
    ----------
    CS-25.341(a)(3): 9 m (30 ft) to 107 m (350 ft).

    Examples
    --------
    >>> cs25_gradients(3)
    array([  9.,  58., 107.])
    """
    if n < 2:
        raise ValueError(f"number of gradients n must be at least 2, got {n}")
    return np.linspace(*CS25_GRADIENT_RANGE, n)


def cs25_design_velocity(gradient: ArrayLike, U_ref: ArrayLike, F_g: ArrayLike = 1.0) -> Array:
    """Design gust velocity U_ds of CS/FAR-25.341(a)(4).

    Parameters
    ----------
    gradient : array_like, shape (...)
        Gust gradient distance H, 9 to 107 m: half the wavelength of the pulse. [m]
    U_ref : array_like, shape (...)
        Reference gust velocity, equivalent airspeed. [m/s]
    F_g : array_like, shape (...)
        Flight profile alleviation factor; 1 is conservative. [-]

    Returns
    -------
    U_ds : ndarray, shape (...)
        U_ref F_g (H/107 m)^(1/6), equivalent airspeed. [m/s]

    Raises
    ------
    ValueError
        If a gradient is outside the clause's range, or a velocity or factor is negative.

    References
    ----------
    CS-25.341(a)(4) (H/107 in metres); 14 CFR 25.341(a)(4) (H/350 in feet).

    Examples
    --------
    >>> cs25_design_velocity(107.0, 17.07)
    array(17.07)
    """
    distance = np.asarray(gradient, dtype=float)
    low, high = CS25_GRADIENT_RANGE
    inside = (distance >= low) & (distance <= high)
    if not np.all(inside):
        raise ValueError(
            f"gust gradient H must lie in {low:g} to {high:g} [m] (CS-25.341), got {distance[~inside].flat[0]:g}"
        )
    U_ref, F_g = np.asarray(U_ref, dtype=float), np.asarray(F_g, dtype=float)
    for name, unit, value in (("U_ref", "m/s", U_ref), ("F_g", "-", F_g)):
        if not np.all(value >= 0.0):
            raise ValueError(f"{name} must not be negative [{unit}], got {value.min():g}")
    return np.asarray(U_ref * F_g * (distance / high) ** (1.0 / 6.0))


def cs25_design_gust(
    gradient: float, altitude: float, density: float, *, F_g: float = 1.0, at_dive_speed: bool = False
) -> OneMinusCosine:
    """The 1-cosine design gust of CS/FAR-25.341(a), as a true gust velocity.

    Parameters
    ----------
    gradient : float
        Gust gradient distance H. [m]
    altitude : float
        Altitude. [m]
    density : float
        Air density there, for the conversion from equivalent to true. [kg/m^3]
    F_g : float
        Flight profile alleviation factor. [-]
    at_dive_speed : bool
        True at V_D: half.

    Returns
    -------
    gust : OneMinusCosine
        Amplitude U_ds sqrt(rho_0/rho) [m/s], length 2H [m].

    Raises
    ------
    ValueError
        If an argument is outside its range.

    References
    ----------
    CS-25.341(a)(2): U = (U_ds/2)(1 - cos(pi s/H)), 0 <= s <= 2H.

    Examples
    --------
    >>> cs25_design_gust(107.0, 0.0, 1.225).length
    214.0
    """
    U_ds = float(cs25_design_velocity(gradient, cs25_reference_velocity(altitude, at_dive_speed=at_dive_speed), F_g))
    return OneMinusCosine(amplitude=float(true_airspeed(U_ds, density)), length=2.0 * gradient)


def cs23_gust_velocity(altitude: ArrayLike, *, at_dive_speed: bool = False) -> Array:
    """Derived gust velocity U_de of CS/FAR-23.333(c), also used by STANAG 4671 for unmanned aircraft.

    Parameters
    ----------
    altitude : array_like, shape (...)
        Altitude, 0 to 15,240 m (50,000 ft). [m]
    at_dive_speed : bool
        False: at V_C (50 ft/s). True: at V_D (25 ft/s).

    Returns
    -------
    U_de : ndarray, shape (...)
        Constant to 6,096 m (20,000 ft), then linear to half at 15,240 m; equivalent airspeed. [m/s]

    Raises
    ------
    ValueError
        If an altitude is outside the range that the clause covers.

    References
    ----------
    CS-23.333(c)(1), 14 CFR 23.333(c)(1) (before Amendment 23-64), STANAG 4671 USAR.333; written from memory of the
    standards.

    Examples
    --------
    >>> cs23_gust_velocity([0.0, 6096.0, 15240.0])
    array([15.24, 15.24,  7.62])
    """
    return _table(altitude, _CS23_ALTITUDE, _CS23_U_DE) * (0.5 if at_dive_speed else 1.0)


def cs23_design_gust(altitude: float, density: float, chord: float, *, at_dive_speed: bool = False) -> OneMinusCosine:
    """The 25-chord design gust of CS/FAR-23.333(c) and STANAG 4671, as a true gust velocity.

    Parameters
    ----------
    altitude : float
        Altitude. [m]
    density : float
        Air density there. [kg/m^3]
    chord : float
        Mean geometric chord of the wing, positive. [m]
    at_dive_speed : bool
        True at V_D: half.

    Returns
    -------
    gust : OneMinusCosine
        Amplitude U_de sqrt(rho_0/rho) [m/s], length 25 chords [m].

    Raises
    ------
    ValueError
        If an argument is outside its range.

    References
    ----------
    CS-23.333(c)(2): U = (U_de/2)(1 - cos(2 pi s/(25 c))); written from memory of the standard.

    Examples
    --------
    >>> gust = cs23_design_gust(0.0, 1.225, 0.5)
    >>> round(gust.amplitude, 4), gust.length
    (15.24, 12.5)
    """
    if not chord > 0.0:
        raise ValueError(f"chord must be positive [m], got {chord:g}")
    U_de = float(cs23_gust_velocity(altitude, at_dive_speed=at_dive_speed))
    return OneMinusCosine(amplitude=float(true_airspeed(U_de, density)), length=25.0 * chord)


def cs25_turbulence_intensity(altitude: ArrayLike, F_g: ArrayLike = 1.0, *, at_dive_speed: bool = False) -> Array:
    """Limit turbulence intensity U_sigma of CS/FAR-25.341(b)(3).

    Parameters
    ----------
    altitude : array_like, shape (...)
        Altitude, 0 to 18,288 m (60,000 ft). [m]
    F_g : array_like, shape (...)
        Flight profile alleviation factor. [-]
    at_dive_speed : bool
        False: from V_B to V_C. True: at V_D, half.

    Returns
    -------
    U_sigma : ndarray, shape (...)
        U_sigma,ref F_g, TRUE airspeed. [m/s]

    Raises
    ------
    ValueError
        If an altitude is outside the clause's range or F_g is negative.

    References
    ----------
    CS-25.341(b)(3), 14 CFR 25.341(b)(3): 27.43 m/s (90 ft/s) at sea level, 24.08 (79) at 7,315 m, constant to 18,288 m;
    written from memory of the standard.

    Examples
    --------
    >>> cs25_turbulence_intensity([0.0, 7315.0, 18288.0])
    array([27.43, 24.08, 24.08])
    """
    F_g = np.asarray(F_g, dtype=float)
    if not np.all(F_g >= 0.0):
        raise ValueError(f"F_g must not be negative [-], got {F_g.min():g}")
    return F_g * _table(altitude, _CS25_SIGMA_ALTITUDE, _CS25_SIGMA) * (0.5 if at_dive_speed else 1.0)


def design_turbulence_load(steady: ArrayLike, rms_per_unit: ArrayLike, U_sigma: ArrayLike) -> tuple[Array, Array]:
    """Limit loads of continuous turbulence, P_1g -/+ U_sigma A.

    Parameters
    ----------
    steady : array_like, shape (...)
        Load in steady level flight, P_1g. [unit of the load]
    rms_per_unit : array_like, shape (...)
        A: RMS load per unit RMS turbulence, for von Karman's vertical spectrum with L = 762 m. [load/(m/s)]
    U_sigma : array_like, shape (...)
        Limit turbulence intensity, true airspeed. [m/s]

    Returns
    -------
    lower, upper : ndarray, shape (...)
        P_1g - U_sigma A and P_1g + U_sigma A. [unit of the load]

    Raises
    ------
    ValueError
        If A or U_sigma is negative.

    References
    ----------
    CS-25.341(b)(1)-(2), 14 CFR 25.341(b)(1)-(2).

    Examples
    --------
    >>> tuple(float(load) for load in design_turbulence_load(100.0, 2.0, 27.0))
    (46.0, 154.0)
    """
    A, U = np.asarray(rms_per_unit, dtype=float), np.asarray(U_sigma, dtype=float)
    if not (np.all(A >= 0.0) and np.all(U >= 0.0)):
        raise ValueError(f"rms_per_unit and U_sigma [m/s] must not be negative, got {A.min():g} and {U.min():g}")
    return np.asarray(steady - U * A), np.asarray(steady + U * A)


def _table(altitude: ArrayLike, nodes: tuple[float, ...], values: tuple[float, ...]) -> Array:
    """Straight lines between nodes; outside them the clause says nothing, so neither do we."""
    z = np.asarray(altitude, dtype=float)
    inside = (z >= nodes[0]) & (z <= nodes[-1])
    if not np.all(inside):
        raise ValueError(f"altitude must lie in {nodes[0]:g} to {nodes[-1]:g} [m], got {z[~inside].flat[0]:g}")
    return np.interp(z, nodes, values)
