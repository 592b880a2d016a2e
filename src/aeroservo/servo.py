"""What hangs on an aeroelastic model beside structure and air: actuators, sensors, gravity, stall, limits.

Data only, of numbers and names: the compiled engine reads it, linear analyses take its linear part. This module
stands below `datatypes` and imports nothing of ours.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise


@dataclass(frozen=True, kw_only=True)
class Actuator:
    """What moves one control: u -> dead time -> gain, position limit -> lag of first or second order -> backlash.

    First order: delta' = clip(omega (gain u - delta), rate limit). Second order: the rate is pulled towards
    clip(omega/(2 zeta) (gain u - delta), rate limit) with the time constant 1/(2 zeta omega), which is the ordinary
    second-order lag while nothing is clipped and keeps the rate within its limit always.

    Attributes
    ----------
    control : str
        Name of the control that it moves.
    omega : float
        Bandwidth. [rad/s]
    zeta : float, optional
        Damping ratio; None is a lag of first order. [-]
    gain : float
        Static gain. [-]
    limit : float, optional
        Largest deflection either way: of the command, and a hard stop of the surface. [rad]
    rate_limit : float, optional
        Largest rate either way. [rad/s]
    delay_s : float
        Dead time of the command. [s]
    backlash : float
        Half width of the play between actuator and surface. [rad]
    """

    control: str
    omega: float
    zeta: float | None = None
    gain: float = 1.0
    limit: float | None = None
    rate_limit: float | None = None
    delay_s: float = 0.0
    backlash: float = 0.0

    def __post_init__(self) -> None:
        """Refuse numbers that no actuator has."""
        positive = {"omega": self.omega, "zeta": self.zeta, "limit": self.limit, "rate_limit": self.rate_limit}
        units = {"omega": "rad/s", "zeta": "-", "limit": "rad", "rate_limit": "rad/s"}
        for name, value in positive.items():
            if value is not None and not 0.0 < value < math.inf:
                raise ValueError(f"actuator of {self.control!r}: {name} must be positive [{units[name]}], got {value}")
        for name, value, unit in (("delay_s", self.delay_s, "s"), ("backlash", self.backlash, "rad")):
            if not 0.0 <= value < math.inf:
                raise ValueError(f"actuator of {self.control!r}: {name} must not be negative [{unit}], got {value}")
        if not math.isfinite(self.gain):
            raise ValueError(f"actuator of {self.control!r}: gain must be finite [-], got {self.gain}")

    @property
    def order(self) -> int:
        """Relative degree from command to deflection. [-]"""
        return 1 if self.zeta is None else 2


@dataclass(frozen=True, kw_only=True)
class Sensor:
    """A measurement: rows on displacement, rate and acceleration of the modes, then lag, delay, noise, steps.

    Attributes
    ----------
    name : str
        Name of the sensor.
    unit : str
        Unit as a suffix of channel names: "rad", "rad_s", "m", "m_s2".
    displacement, rate, acceleration : tuple of float, length n or 0
        Measured value per unit of each mode, of its rate, of its acceleration. [SI]
    bandwidth : float, optional
        Corner of a lag of first order; None is without lag. [rad/s]
    noise : float
        Standard deviation of white noise added at each sample. [unit of the sensor]
    quantum : float
        Step to which each sample is rounded, 0 for none. [unit of the sensor]
    delay_s : float
        Age of a sample when it is read. [s]
    """

    name: str
    unit: str
    displacement: tuple[float, ...] = ()
    rate: tuple[float, ...] = ()
    acceleration: tuple[float, ...] = ()
    bandwidth: float | None = None
    noise: float = 0.0
    quantum: float = 0.0
    delay_s: float = 0.0

    def __post_init__(self) -> None:
        """Refuse numbers that no sensor has."""
        if self.bandwidth is not None and not 0.0 < self.bandwidth < math.inf:
            raise ValueError(f"sensor {self.name!r}: bandwidth must be positive [rad/s], got {self.bandwidth}")
        for name in ("noise", "quantum", "delay_s"):
            value = getattr(self, name)
            if not 0.0 <= value < math.inf:
                raise ValueError(f"sensor {self.name!r}: {name} must not be negative, got {value}")

    @property
    def channel(self) -> str:
        """Channel name, with the unit where the name does not end in it. [-]"""
        return self.name if self.name.endswith("_" + self.unit) else f"{self.name}_{self.unit}"


@dataclass(frozen=True, kw_only=True)
class LiftCurve:
    """Lift that is no straight line: q_bar direction (table(alpha) - CL0 - CL_alpha alpha) is added to the forces.

    alpha = trim + displacement q + (b/V) rate q' + w_g/V. Beyond its ends the table is held.

    Attributes
    ----------
    alpha, CL : tuple of float, length 2 or more
        The table, ascending. [rad, -]
    CL0, CL_alpha : float
        The straight line that linear analyses use. [-, 1/rad]
    direction : tuple of float, length n
        Generalised force per unit CL and dynamic pressure. [m^2, m^3]
    displacement, rate : tuple of float, length n
        Incidence per unit of each mode, and per unit of each rate times b/V. [rad per unit]
    """

    alpha: tuple[float, ...]
    CL: tuple[float, ...]
    CL0: float
    CL_alpha: float
    direction: tuple[float, ...]
    displacement: tuple[float, ...]
    rate: tuple[float, ...]

    def __post_init__(self) -> None:
        """Check the table."""
        if len(self.alpha) != len(self.CL) or len(self.alpha) < 2:
            raise ValueError("a lift curve needs two or more rows [alpha, CL]")
        if any(after <= before for before, after in pairwise(self.alpha)):
            raise ValueError("alpha of a lift curve must ascend [rad]")


@dataclass(frozen=True, kw_only=True)
class Gravity:
    """Weight on the modes: steady + turning cos(q[mode]), and the trim attitude at which both are taken.

    Attributes
    ----------
    steady, turning : tuple of float, length n
        Generalised forces, the second times the cosine of one coordinate. [N, N m]
    mode : str
        That coordinate, an angle.
    """

    steady: tuple[float, ...]
    turning: tuple[float, ...]
    mode: str


@dataclass(frozen=True, kw_only=True)
class Limit:
    """Where a simulation ends: the largest magnitude of a coordinate, from its equilibrium.

    Attributes
    ----------
    mode : str
        Name of the coordinate.
    largest : float
        Either way. [unit of the coordinate]
    """

    mode: str
    largest: float
