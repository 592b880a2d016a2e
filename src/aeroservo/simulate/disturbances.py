"""What shakes a model: discrete gusts, command doublets, turbulence, initial conditions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from aeroservo.datatypes import Array, FlightCondition
from aeroservo.gust.dryden import time_scale
from aeroservo.gust.intensity import Turbulence, constant_turbulence, turbulence
from aeroservo.gust.sampling import DiscreteNoise, discretise
from aeroservo.gust.turbulence import shaping_filter

Severity = Literal["light", "moderate", "severe"]


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
    model : {"dryden", "von_karman"}
        Spectrum.
    """

    level: float | Severity
    model: Literal["dryden", "von_karman"] = "dryden"

    def __post_init__(self) -> None:
        """Check the level."""
        if isinstance(self.level, str):
            if self.level not in get_args(Severity):
                raise ValueError(f"turbulence must be light, moderate, severe or an RMS [m/s], got {self.level!r}")
        elif not (math.isfinite(self.level) and self.level >= 0.0):
            raise ValueError(f"turbulence RMS must not be negative [m/s], got {self.level}")

    def state(self, altitude: Array) -> Turbulence:
        """Intensities and lengths at altitudes (...), shape (..., 3). [m/s, m]"""
        if isinstance(self.level, str):
            return turbulence(altitude, severity=self.level, spectrum=self.model)
        return constant_turbulence(self.level)

    def filters(self, condition: FlightCondition, altitude: Array, dt: float) -> DiscreteNoise:
        """Exact recursions of the upward gust w_g at conditions (m,), for one step dt [s]. [m/s]"""
        full = shaping_filter(self.state(altitude), condition.V, model=self.model)
        state = [i for i, name in enumerate(full.states) if name.startswith("x_w")]
        noise = [i for i, name in enumerate(full.inputs) if name == "noise_w"]
        row = [i for i, name in enumerate(full.outputs) if name == "w_g_m_s"]
        names = tuple(full.states[i] for i in state)
        from aeroservo.datatypes import LinearSystem

        return discretise(
            LinearSystem(
                A=full.A[..., state, :][..., state],
                B=full.B[..., state, :][..., noise],
                C=-full.C[..., row, :][..., state],  # w of the specification is down
                D=full.D[..., row, :][..., noise],
                states=names,
                inputs=("noise_w",),
                outputs=("gust_m_s",),
            ),
            dt,
        )

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
