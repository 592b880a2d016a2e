"""Disk margins of the flutter-suppression schedules at 10,000 ft, against speed and against delay.

Each row designs its own schedule and is analysed as it would fly: at the rate of the controller, actuator and delay
inside, the schedule blended to the very speed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from aeroservo.control.closed_loop import loop_plant
from aeroservo.control.controller import Controller
from aeroservo.control.design import Design
from aeroservo.control.disk_margins import disk_margin
from aeroservo.control.lqg import GYRO_ACCELEROMETER, GYRO_RECOVERY
from aeroservo.control.lqr import FULL_STATE
from aeroservo.control.schedule import ScheduleCheck, design_schedule, schedule_check
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, LinearSystem, frozen
from aeroservo.studies.climb_flight import FULL_STATE_SENSORS, RATE_HZ, climb_model

ALTITUDE = 3048.0
"""Of the table: 10,000 ft. [m]"""

SPEEDS = (50.0, 60.0, 80.0, 100.0, 120.0)
"""Of the table. [m/s]"""

RANGE = (15.0, 130.0)
"""Speeds over which the schedules are designed and their stability is checked. [m/s]"""

SOFTER = replace(FULL_STATE, Q=GYRO_RECOVERY.Q)
"""Full state with the weights of the gyro's design: 5 deg of pitch instead of 2."""

ROWS: tuple[tuple[str, Callable[[LinearSystem], Design], tuple[str, ...], int, tuple[float, ...]], ...] = (
    ("full state", SOFTER, FULL_STATE_SENSORS, 1, (1.18, 1.00, 0.78, 0.66, 0.575)),
    ("gyro + accelerometer", GYRO_ACCELEROMETER, ("gyro", "accelerometer"), 1, (0.5, 0.35, 0.19, 0.14, 0.11)),
    ("gyro with recovery", GYRO_RECOVERY, ("gyro",), 1, (1.37, 1.05, 0.86, 0.73, 0.61)),
    ("gyro with recovery, 4 samples", GYRO_RECOVERY, ("gyro",), 4, (1.08, 0.83, 0.55, 0.40, 0.30)),
)
"""Name, design, sensors, samples of delay and the margins measured before, at `SPEEDS`."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MarginRow:
    """One schedule of the table.

    Attributes
    ----------
    name : str
        What it reads.
    delay_samples : int
        Computing delay. [sample]
    speeds : ndarray, shape (n,)
        True airspeeds. [m/s]
    alpha : ndarray, shape (n,)
        Balanced disk margin (skew 0) at the elevon. [-]
    wanted : tuple of float
        The same as measured before, at `SPEEDS`; empty elsewhere. [-]
    check : ScheduleCheck
        Frozen stability over `RANGE`.
    """

    name: str
    delay_samples: int
    speeds: Array
    alpha: Array
    wanted: tuple[float, ...]
    check: ScheduleCheck

    def __post_init__(self) -> None:
        """Lock the arrays."""
        for name in ("speeds", "alpha"):
            object.__setattr__(self, name, frozen(getattr(self, name), ndim=1, name=name))

    @property
    def gain_dB(self) -> Array:
        """Gain margin that the disk guarantees, shape (n,). [dB]"""
        return np.asarray(20.0 * np.log10((2.0 + self.alpha) / (2.0 - self.alpha)))

    @property
    def phase(self) -> Array:
        """Phase margin that the disk guarantees, shape (n,). [rad]"""
        return np.asarray(2.0 * np.arctan(self.alpha / 2.0))


def schedule_margins(speeds: Sequence[float] = SPEEDS, *, points: int = 60) -> tuple[MarginRow, ...]:
    """The four schedules and their margins.

    Parameters
    ----------
    speeds : sequence of float
        True airspeeds at 3,048 m. [m/s]
    points : int
        Points of each schedule.

    Returns
    -------
    rows : tuple of MarginRow
        In the order of `ROWS`.

    References
    ----------
    P. Seiler, A. Packard and P. Gahinet, "An introduction to disk margins", IEEE Control Systems Magazine 40(5), 2020;
    equations.md, "Near reversal, what really changes sign".

    Examples
    --------
    >>> [row.name for row in schedule_margins([60.0], points=12)][2]
    'gyro with recovery'
    """
    model, conditions = climb_model(), _conditions(points)
    rows = []
    for name, design, sensors, delay, wanted in ROWS:
        schedule = design_schedule(
            model, design, conditions, rate_Hz=RATE_HZ, delay_samples=delay, sensors=sensors
        )  # fmt: skip
        rows.append(
            MarginRow(
                name=name,
                delay_samples=delay,
                speeds=np.array(speeds, dtype=float),
                alpha=np.array([_alpha(model, schedule, V) for V in speeds]),
                wanted=wanted if tuple(speeds) == SPEEDS else (),
                check=schedule_check(model, schedule, conditions),
            )
        )
    return tuple(rows)


def margin_against_delay(
    delays: Sequence[int] = (1, 2, 3, 4, 5, 6), speeds: Sequence[float] = SPEEDS, *, points: int = 30
) -> Array:
    """Disk margin of the gyro with recovery, designed anew for each delay.

    Parameters
    ----------
    delays : sequence of int
        Computing delays; one sample is 5 ms. [sample]
    speeds : sequence of float
        True airspeeds at 3,048 m. [m/s]
    points : int
        Points of each schedule.

    Returns
    -------
    alpha : ndarray, shape (n_delay, n_V)
        Balanced disk margins. [-]

    References
    ----------
    P. Seiler, A. Packard and P. Gahinet, "An introduction to disk margins", IEEE Control Systems Magazine 40(5), 2020.

    Examples
    --------
    >>> bool(np.all(np.diff(margin_against_delay([1, 4], [80.0], points=8)[:, 0]) < 0.0))
    True
    """
    model, conditions = climb_model(), _conditions(points)
    rows = []
    for delay in delays:
        schedule = design_schedule(
            model, GYRO_RECOVERY, conditions, rate_Hz=RATE_HZ, delay_samples=delay, sensors=("gyro",)
        )  # fmt: skip
        rows.append([_alpha(model, schedule, V) for V in speeds])
    return np.array(rows)


def speed_with_margin(alpha: float = 2.0 * math.tan(math.radians(22.5)), *, step: float = 1.0) -> float:
    """Speed to which the gyro with recovery keeps a margin, one sample of delay: 6 dB and 45 deg are alpha 0.83.

    Parameters
    ----------
    alpha : float
        Balanced disk margin that is asked for. [-]
    step : float
        Between the speeds that are looked at. [m/s]

    Returns
    -------
    speed : float
        The last speed below the first at which it is missing, between 50 and 130 m/s. [m/s]

    References
    ----------
    MIL-F-9490D, section 3.1.3.6 (from memory: 6 dB and 45 deg).

    Examples
    --------
    >>> speed_with_margin(step=10.0) >= 80.0
    True
    """
    model, conditions = climb_model(), _conditions(60)
    schedule = design_schedule(
        model, GYRO_RECOVERY, conditions, rate_Hz=RATE_HZ, delay_samples=1, sensors=("gyro",)
    )  # fmt: skip
    good = 50.0 - step
    for V in np.arange(50.0, RANGE[1] + 0.5 * step, step):
        if _alpha(model, schedule, float(V)) < alpha:
            break
        good = float(V)
    return good


def _conditions(points: int) -> FlightCondition:
    """Points of the schedules, equally far apart in speed."""
    return FlightCondition.at(ALTITUDE, V=np.linspace(*RANGE, points))


def _alpha(model: AeroelasticModel, schedule: Controller, V: float) -> float:
    """Disk margin at one speed."""
    condition = FlightCondition.at(ALTITUDE, V=V)
    plant = loop_plant(model, condition, schedule)
    return disk_margin(plant, schedule, pressure=float(condition.q)).alpha
