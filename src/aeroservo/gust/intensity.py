"""Scale lengths and intensities of turbulence against altitude: MIL-F-8785C and MIL-HDBK-1797.

Height above ground is taken to be the altitude given, and never below 10 ft (3.048 m) in the formulas. Below
1,000 ft the length and intensity follow the height and the wind at 20 ft; above 2,000 ft the air is isotropic and
the intensity follows from a probability of exceedance; between them both are joined by straight lines in altitude.
The low-altitude values belong to axes along the mean wind, the high ones to body axes; the join ignores the
difference, as the specification's users do.

MIL-HDBK-1797 writes its v and w spectra with 2L where MIL-F-8785C writes L, and halves those lengths: the spectra
are the same curves. Lengths of one in the formulas of the other are wrong by a factor two: always pass both from
the same `specification`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.datatypes import frozen

__all__ = [
    "EXCEEDANCES",
    "Severity",
    "Specification",
    "Spectrum",
    "Turbulence",
    "constant_turbulence",
    "high_altitude_intensity",
    "low_altitude_intensity",
    "scale_lengths",
    "severity_levels",
    "turbulence",
]

Array = NDArray[Any]
Specification = Literal["MIL-F-8785C", "MIL-HDBK-1797"]
Spectrum = Literal["dryden", "von_karman"]
Severity = Literal["light", "moderate", "severe"]

_FT, _KT = 0.3048, 1852.0 / 3600.0
_LOWEST, _LOW_TOP, _HIGH_BOTTOM = 10.0 * _FT, 1000.0 * _FT, 2000.0 * _FT

_SEVERITIES: dict[str, tuple[float, float]] = {
    "light": (15.0 * _KT, 1e-2),
    "moderate": (30.0 * _KT, 1e-3),
    "severe": (45.0 * _KT, 1e-5),
}

#: Probabilities of exceedance for which MIL-F-8785C draws a curve. [-]
EXCEEDANCES = (2e-1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)

_HIGH_LENGTH = {"dryden": 1750.0 * _FT, "von_karman": 2500.0 * _FT}
_TABLE_ALTITUDE = _FT * np.array([500, 1750, 3750, 7500, 15000, 25000, 35000, 45000, 55000, 65000, 75000, 80000.0])
# MIL-F-8785C, Figure 7, as digitised identically by JSBSim's wind model and TU Braunschweig's LADAC. [ft/s]
_TABLE_SIGMA = _FT * np.array(
    [
        [3.2, 2.2, 1.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [4.2, 3.6, 3.3, 1.6, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [6.6, 6.9, 7.4, 6.7, 4.6, 2.7, 0.4, 0.0, 0.0, 0.0, 0.0, 0.0],
        [8.6, 9.6, 10.6, 10.1, 8.0, 6.6, 5.0, 4.2, 2.7, 0.0, 0.0, 0.0],
        [11.8, 13.0, 16.0, 15.1, 11.6, 9.7, 8.1, 8.2, 7.9, 4.9, 3.2, 2.1],
        [15.6, 17.6, 23.0, 23.6, 22.1, 20.0, 16.0, 15.1, 12.1, 7.9, 6.2, 5.1],
        [18.7, 21.5, 28.4, 30.2, 30.7, 31.0, 25.2, 23.1, 17.5, 10.7, 8.4, 7.2],
    ]
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Turbulence:
    """RMS intensities and scale lengths of the three velocity components.

    Attributes
    ----------
    intensity : ndarray, shape (..., 3)
        sigma_u, sigma_v, sigma_w, not negative. [m/s]
    length : ndarray, shape (..., 3)
        L_u, L_v, L_w in the convention of `specification`, positive. [m]
    specification : {"MIL-F-8785C", "MIL-HDBK-1797"}
        Whose spectra the lengths belong to.
    """

    intensity: Array
    length: Array
    specification: Specification = "MIL-F-8785C"

    def __post_init__(self) -> None:
        _check_specification(self.specification)
        sigma, L = np.broadcast_arrays(self.intensity, self.length)
        object.__setattr__(self, "intensity", frozen(sigma, name="intensity"))
        object.__setattr__(self, "length", frozen(L, name="length"))
        if self.intensity.shape[-1:] != (3,):
            raise ValueError(f"intensity and length must end in 3 components, got shape {self.intensity.shape}")
        if np.any(self.intensity < 0.0):
            raise ValueError(f"turbulence intensity must not be negative [m/s], got {self.intensity.min():g}")
        if np.any(self.length <= 0.0):
            raise ValueError(f"scale length must be positive [m], got {self.length.min():g}")

    def __getitem__(self, index: Any) -> Turbulence:
        """One state, or a part, of a profile (leading axes)."""
        return Turbulence(intensity=self.intensity[index], length=self.length[index], specification=self.specification)


def turbulence(
    altitude: ArrayLike,
    *,
    severity: Severity = "light",
    wind_6m: float | None = None,
    exceedance: float | None = None,
    spectrum: Spectrum = "dryden",
    specification: Specification = "MIL-F-8785C",
) -> Turbulence:
    """Intensities and scale lengths at an altitude, at any height.

    Parameters
    ----------
    altitude : array_like, shape (...)
        Height above ground, 0 to 24,384 m (80,000 ft). [m]
    severity : {"light", "moderate", "severe"}
        W20 = 15, 30, 45 kt below 1,000 ft and P = 1e-2, 1e-3, 1e-5 above 2,000 ft.
    wind_6m : float, optional
        Wind at 20 ft (6 m) in place of the severity's. [m/s]
    exceedance : float, optional
        Probability of exceedance in place of the severity's, one of `EXCEEDANCES`. [-]
    spectrum : {"dryden", "von_karman"}
        Decides the length at altitude, 533.4 m (1,750 ft) or 762 m (2,500 ft).
    specification : {"MIL-F-8785C", "MIL-HDBK-1797"}
        Convention of the lengths.

    Returns
    -------
    state : Turbulence
        Arrays of shape (..., 3).

    Raises
    ------
    ValueError
        If the altitude is below ground or above the table, the wind negative, or a name unknown.

    References
    ----------
    MIL-F-8785C, section 3.7 and Figure 7; MIL-HDBK-1797, Appendix A; the join from 1,000 to 2,000 ft as
    in the documentation of the Aerospace Blockset's Dryden block.

    Examples
    --------
    >>> state = turbulence(3048.0, severity="moderate")
    >>> state.length.round(1), state.intensity.round(3)
    (array([533.4, 533.4, 533.4]), array([2.865, 2.865, 2.865]))
    """
    named_wind, named_exceedance = severity_levels(severity)
    wind = named_wind if wind_6m is None else wind_6m
    z = _check_altitude(altitude)
    low = low_altitude_intensity(np.minimum(z, _LOW_TOP), wind)
    top = np.maximum(z, _HIGH_BOTTOM)
    high = high_altitude_intensity(top, named_exceedance if exceedance is None else exceedance)[..., None]
    return Turbulence(
        intensity=low + _above_low(z)[..., None] * (high - low),
        length=scale_lengths(z, spectrum=spectrum, specification=specification),
        specification=specification,
    )


def severity_levels(severity: Severity) -> tuple[float, float]:
    """Wind at 6 m and probability of exceedance that a named severity stands for.

    Parameters
    ----------
    severity : {"light", "moderate", "severe"}
        Name.

    Returns
    -------
    wind_6m : float
        15, 30, 45 kt. [m/s]
    exceedance : float
        1e-2, 1e-3, 1e-5. [-]

    Raises
    ------
    ValueError
        If the name is unknown.

    References
    ----------
    MIL-F-8785C, section 3.7 (winds at 20 ft of the low-altitude model; curves of Figure 7); contract.md.

    Examples
    --------
    >>> round(severity_levels("moderate")[0], 3)
    15.433
    """
    if severity not in _SEVERITIES:
        raise ValueError(f"unknown severity {severity!r}: use one of {', '.join(_SEVERITIES)}")
    return _SEVERITIES[severity]


def constant_turbulence(intensity: float, *, specification: Specification = "MIL-F-8785C") -> Turbulence:
    """The same intensity in all three components and one scale length, at every height.

    Parameters
    ----------
    intensity : float
        RMS velocity, not negative. [m/s]
    specification : {"MIL-F-8785C", "MIL-HDBK-1797"}
        Convention of the lengths: L = 533.4 m (1,750 ft) for all, or half of it for v and w. The same spectra.

    Returns
    -------
    state : Turbulence
        Arrays of shape (3,).

    Raises
    ------
    ValueError
        If the intensity is negative or the specification unknown.

    References
    ----------
    Project convention: `--turbulence SIGMA` of contract.md; the length is MIL-F-8785C's above 2,000 ft.

    Examples
    --------
    >>> constant_turbulence(1.5).intensity
    array([1.5, 1.5, 1.5])
    """
    _check_specification(specification)
    half = 0.5 if specification == "MIL-HDBK-1797" else 1.0
    length = _HIGH_LENGTH["dryden"] * np.array([1.0, half, half])
    return Turbulence(intensity=np.full(3, intensity), length=length, specification=specification)


def scale_lengths(
    altitude: ArrayLike, *, spectrum: Spectrum = "dryden", specification: Specification = "MIL-F-8785C"
) -> Array:
    """Turbulence scale lengths L_u, L_v, L_w against height.

    Parameters
    ----------
    altitude : array_like, shape (...)
        Height above ground, not negative; below 10 ft the formulas take 10 ft. [m]
    spectrum : {"dryden", "von_karman"}
        Decides the length above 2,000 ft.
    specification : {"MIL-F-8785C", "MIL-HDBK-1797"}
        1797 halves L_v and L_w, and its formulas have 2L in place of L.

    Returns
    -------
    L : ndarray, shape (..., 3)
        To 1,000 ft: L_w = h, L_u = L_v = h/(0.177 + 0.000823 h)^1.2, h in ft; above 2,000 ft 1,750 ft (Dryden) or
        2,500 ft (von Karman); linear between. [m]

    Raises
    ------
    ValueError
        If an altitude is negative or a name unknown.

    References
    ----------
    MIL-F-8785C, section 3.7; MIL-HDBK-1797, Appendix A (halved lengths), from memory of the standards; the formulas
    agree with the documentation of the Aerospace Blockset's Dryden block.

    Examples
    --------
    >>> scale_lengths([304.8, 457.2, 609.6]).round(1)[:, 2]
    array([304.8, 419.1, 533.4])
    """
    _check_specification(specification)
    if spectrum not in get_args(Spectrum):
        raise ValueError(f"unknown spectrum {spectrum!r}: use one of {', '.join(get_args(Spectrum))}")
    z = _check_altitude(altitude)
    h = np.clip(z, _LOWEST, _LOW_TOP)
    horizontal = h / (0.177 + 0.000823 * h / _FT) ** 1.2
    low = np.stack([horizontal, horizontal, h], axis=-1)
    length = low + _above_low(z)[..., None] * (_HIGH_LENGTH[spectrum] - low)
    return length * (np.array([1.0, 0.5, 0.5]) if specification == "MIL-HDBK-1797" else 1.0)


def low_altitude_intensity(altitude: ArrayLike, wind_6m: ArrayLike) -> Array:
    """RMS intensities from 10 to 1,000 ft above ground.

    Parameters
    ----------
    altitude : array_like, shape (...)
        Height above ground, 0 to 304.8 m; below 10 ft the formulas take 10 ft. [m]
    wind_6m : array_like, shape (...)
        Mean wind at 20 ft (6 m), not negative. [m/s]

    Returns
    -------
    sigma : ndarray, shape (..., 3)
        sigma_w = 0.1 W20, sigma_u = sigma_v = sigma_w/(0.177 + 0.000823 h)^0.4, h in ft. [m/s]

    Raises
    ------
    ValueError
        If a height is outside 0 to 304.8 m or the wind is negative.

    References
    ----------
    MIL-F-8785C, section 3.7 (low-altitude disturbance model), from memory of the standard; agrees with the
    documentation of the Aerospace Blockset's Dryden block.

    Examples
    --------
    >>> low_altitude_intensity(304.8, 10.0)
    array([1., 1., 1.])
    """
    z, wind = np.broadcast_arrays(_check_altitude(altitude), np.asarray(wind_6m, dtype=float))
    if not np.all(z <= _LOW_TOP * (1.0 + 1e-12)):
        raise ValueError(f"low-altitude formulas hold up to {_LOW_TOP:g} [m], got {z.max():g}")
    if not np.all(wind >= 0.0):
        raise ValueError(f"wind at 20 ft must not be negative [m/s], got {wind.min():g}")
    h = np.maximum(z, _LOWEST) / _FT
    sigma_w = 0.1 * wind
    sigma_u = sigma_w / (0.177 + 0.000823 * h) ** 0.4
    return np.stack([sigma_u, sigma_u, sigma_w], axis=-1)


def high_altitude_intensity(altitude: ArrayLike, exceedance: float) -> Array:
    """RMS intensity with a given probability of exceedance, above the ground's influence.

    Linear in altitude between the nodes of the table; the value at 500 ft is held below it.

    Parameters
    ----------
    altitude : array_like, shape (...)
        Altitude, 0 to 24,384 m (80,000 ft). [m]
    exceedance : float
        Probability of exceedance, one of `EXCEEDANCES`: the specification draws no curves between them. [-]

    Returns
    -------
    sigma : ndarray, shape (...)
        RMS velocity of each component. [m/s]

    Raises
    ------
    ValueError
        If an altitude is outside the table or the probability is not one of its curves.

    References
    ----------
    MIL-F-8785C, Figure 7, as digitised identically in JSBSim's wind model and in TU Braunschweig's LADAC.

    Examples
    --------
    >>> high_altitude_intensity([533.4, 838.2, 1143.0], 1e-5).round(4)
    array([5.3645, 6.1874, 7.0104])
    """
    z = _check_altitude(altitude)
    if not np.all(z <= _TABLE_ALTITUDE[-1]):
        raise ValueError(f"altitude must not exceed the table's {_TABLE_ALTITUDE[-1]:g} [m], got {z.max():g}")
    match = np.isclose(EXCEEDANCES, exceedance, rtol=1e-9, atol=0.0)
    if not match.any():
        raise ValueError(
            f"exceedance must be one of {', '.join(f'{p:g}' for p in EXCEEDANCES)} [-], got {exceedance:g}"
        )
    return np.interp(z, _TABLE_ALTITUDE, _TABLE_SIGMA[match.argmax()])


def _check_specification(specification: str) -> None:
    """Refuse an unknown specification."""
    if specification not in get_args(Specification):
        raise ValueError(
            f"unknown turbulence specification {specification!r}: use one of {', '.join(get_args(Specification))}"
        )


def _check_altitude(altitude: ArrayLike) -> Array:
    """Heights as a float array, none below ground."""
    z = np.asarray(altitude, dtype=float)
    if not np.all(z >= 0.0):
        raise ValueError(f"altitude must not be below ground, 0 [m], got {z[~(z >= 0.0)].flat[0]:g}")
    return z


def _above_low(z: Array) -> Array:
    """0 up to 1,000 ft, 1 from 2,000 ft, linear between."""
    return np.clip((z - _LOW_TOP) / (_HIGH_BOTTOM - _LOW_TOP), 0.0, 1.0)
