"""What shakes a model: discrete gusts, command doublets, turbulence, initial conditions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from aeroservo.datatypes import Array, FlightCondition, LinearSystem
from aeroservo.gust.dryden import time_scale
from aeroservo.gust.intensity import Specification, Turbulence, constant_turbulence, turbulence
from aeroservo.gust.sampling import DiscreteNoise, discretise
from aeroservo.gust.turbulence import Model, vertical_filter

Severity = Literal["light", "moderate", "severe"]
Spectrum = Literal["dryden", "von_karman", "dryden_blockset", "von_karman_blockset"]

BLOCKSET_STEP = 0.1
"""Noise sample time of the Aerospace Blockset's turbulence blocks. [s]"""


@dataclass(frozen=True, kw_only=True)
class SharpGust:
    """A step of upward gust that stays; it begins at the base step at or after `start`.

    Attributes
    ----------
    amplitude : float
        Positive up. [m/s]
    start : float
        When the reference point meets it. [s]
    """

    amplitude: float
    start: float

    def __post_init__(self) -> None:
        """Check the numbers."""
        _finite(amplitude=self.amplitude, start=self.start)


@dataclass(frozen=True, kw_only=True)
class CosineGust:
    """A 1-cosine pulse (amplitude/2)(1 - cos(2 pi x/length)), x the way flown since `start`.

    Attributes
    ----------
    amplitude : float
        Peak, positive up. [m/s]
    length : float
        Whole wavelength. [m]
    start : float
        When the reference point meets it. [s]
    """

    amplitude: float
    length: float
    start: float

    def __post_init__(self) -> None:
        """Check the numbers."""
        _finite(amplitude=self.amplitude, start=self.start, length=self.length)
        if not self.length > 0.0:
            raise ValueError(f"length of a 1-cosine gust must be positive [m], got {self.length:g}")


@dataclass(frozen=True, kw_only=True)
class Doublet:
    """A command of `amplitude` for half of `duration`, then of minus that; edges on base steps.

    Attributes
    ----------
    amplitude : float
        Added to the command. [rad]
    start, duration : float
        Begin, and length of both halves together. [s]
    command : str
        Name of the command channel, "" for the first.
    """

    amplitude: float
    start: float
    duration: float
    command: str = ""

    def __post_init__(self) -> None:
        """Check the numbers."""
        _finite(amplitude=self.amplitude, start=self.start, duration=self.duration)
        if not self.duration > 0.0:
            raise ValueError(f"duration of a doublet must be positive [s], got {self.duration:g}")


@dataclass(frozen=True, kw_only=True)
class Gustiness:
    """Continuous Dryden or von Karman turbulence, its vertical component.

    Attributes
    ----------
    level : float or {"light", "moderate", "severe"}
        RMS with L = 533.4 m at every height, or the tables along the flight. [m/s]
    model : {"dryden", "von_karman", "dryden_blockset", "von_karman_blockset"}
        Spectrum. The last two are the Aerospace Blockset's defaults, for comparison only: its filters from rest, driven
        by noise that is held for 0.1 s, which leaves nothing at 10 Hz.
    specification : {"MIL-F-8785C", "MIL-HDBK-1797"}
        Whose convention of lengths; the spectra are the same.
    """

    level: float | Severity
    model: Spectrum = "dryden"
    specification: Specification = "MIL-F-8785C"

    def __post_init__(self) -> None:
        """Check the level and the names."""
        if isinstance(self.level, str):
            if self.level not in get_args(Severity):
                raise ValueError(f"turbulence must be light, moderate, severe or an RMS [m/s], got {self.level!r}")
        elif not (math.isfinite(self.level) and self.level >= 0.0):
            raise ValueError(f"turbulence RMS must not be negative [m/s], got {self.level}")
        for name, known in (("model", Spectrum), ("specification", Specification)):
            if getattr(self, name) not in get_args(known):
                raise ValueError(
                    f"turbulence {name} must be one of {', '.join(get_args(known))}, got {getattr(self, name)!r}"
                )

    @property
    def noise_step(self) -> float | None:
        """Time for which the noise is held; None where the samples are exact. [s]"""
        return BLOCKSET_STEP if self.model.endswith("_blockset") else None

    @property
    def filter(self) -> Model:
        """Name of the shaping filter. [-]"""
        return "dryden" if self.model == "dryden_blockset" else self.model

    def state(self, altitude: Array) -> Turbulence:
        """Intensities and lengths at altitudes.

        Parameters
        ----------
        altitude : ndarray, shape (...)
            Above ground. [m]

        Returns
        -------
        state : Turbulence
            Arrays of shape (..., 3); of shape (3,) for an RMS that is the same at every height. [m/s, m]

        Raises
        ------
        ValueError
            If an altitude is below ground or above the tables.
        """
        if isinstance(self.level, str):
            spectrum: Literal["dryden", "von_karman"] = "dryden" if self.filter == "dryden" else "von_karman"
            return turbulence(altitude, severity=self.level, spectrum=spectrum, specification=self.specification)
        if not np.all(np.asarray(altitude) >= 0.0):
            raise ValueError(f"altitude must not be below ground, 0 [m], got {np.min(altitude):g}")
        return constant_turbulence(self.level, specification=self.specification)

    def filters(self, condition: FlightCondition, altitude: Array, dt: float) -> DiscreteNoise:
        """Exact recursions of the upward gust w_g at conditions (m,), for one step dt [s]. [m/s]"""
        return discretise(self._continuous(condition, altitude), dt)

    def held_drive(self, condition: FlightCondition, altitude: Array, dt: float) -> Array:
        """Effect of noise held over one step dt [s] on the states of `filters`, in the first column (m, n, n). [SI]"""
        system = self._continuous(condition, altitude)
        n = len(system.states)
        both = np.zeros((*system.A.shape[:-2], n + 1, n + 1))
        both[..., :n, :n], both[..., :n, n:] = system.A * dt, system.B * dt
        from scipy.linalg import expm

        drive = np.zeros(system.A.shape)
        drive[..., 0] = expm(both)[..., :n, n]
        return drive

    def _continuous(self, condition: FlightCondition, altitude: Array) -> LinearSystem:
        """Shaping filters of the upward gust at conditions (m,)."""
        return vertical_filter(self.state(altitude), condition.V, model=self.filter)

    def correlation_time(self, condition: FlightCondition, altitude: Array) -> float:
        """Shortest time scale L/V of the vertical component over conditions (m,). [s]"""
        state = self.state(altitude)
        return float(np.min(time_scale("w", condition.V, state.length[..., 2], state.specification)))


def parse_gust(text: str) -> SharpGust | CosineGust:
    """A discrete gust from the words of `--gust`.

    Parameters
    ----------
    text : str
        `sharp:W@T` or `cosine:W:LENGTH@T`; W in m/s, LENGTH in m (whole wavelength), T in s.

    Returns
    -------
    gust : SharpGust or CosineGust
        As written.

    Raises
    ------
    ValueError
        If it is neither.
    """
    wanted = f"--gust {text[:80]!r} must be sharp:W@T or cosine:W:LENGTH@T [m/s, m, s]"
    body, _, start = text.partition("@")
    kind, *numbers = body.split(":")
    try:
        values = [float(number) for number in numbers]
        begin = float(start)
    except ValueError:
        raise ValueError(wanted) from None
    if kind == "sharp" and len(values) == 1:
        gust: SharpGust | CosineGust = SharpGust(amplitude=values[0], start=begin)
    elif kind == "cosine" and len(values) == 2:
        gust = CosineGust(amplitude=values[0], length=values[1], start=begin)
    else:
        raise ValueError(wanted)
    return gust


def _finite(**values: float) -> None:
    """Refuse numbers that are not finite, and a start before the run."""
    for name, value in values.items():
        if not math.isfinite(value):
            raise ValueError(f"{name} of a disturbance must be finite, got {value}")
    if values["start"] < 0.0:
        raise ValueError(f"start of a disturbance must not be negative [s], got {values['start']:g}")
