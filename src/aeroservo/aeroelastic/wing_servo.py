"""Actuators and sensors of model files on any structure: rows of the mode shapes at the places where sensors sit."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.aircraft.schema_servo import Actuator as FileActuator
from aeroservo.aircraft.schema_servo import Sensor as FileSensor
from aeroservo.datatypes import Array
from aeroservo.servo import Actuator, Sensor


@dataclass(frozen=True, kw_only=True)
class PlacedSensor:
    """A sensor of a file and its place on a flexural axis.

    Attributes
    ----------
    sensor : Sensor of a model file
        Kind, noise, bandwidth.
    y : float
        Along the flexural axis, from the root. [m]
    aft : float
        Streamwise distance aft of the axis. [m]
    """

    sensor: FileSensor
    y: float
    aft: float


def actuator(table: FileActuator, control: str) -> Actuator:
    """The actuator of a control, from its table.

    Parameters
    ----------
    table : Actuator of a model file
        Degrees as in the file.
    control : str
        Column of the air forces that it moves.

    Returns
    -------
    actuator : Actuator
        [rad, rad/s, s]

    References
    ----------
    contract.md, `[actuator]`.

    Examples
    --------
    >>> actuator(FileActuator(omega_rad_s=60.0, zeta=0.7), "elevon").order
    2
    """
    return Actuator(
        control=control,
        omega=table.omega_rad_s,
        zeta=table.zeta,
        gain=table.gain,
        limit=None if table.limit_deg is None else math.radians(table.limit_deg),
        rate_limit=None if table.rate_deg_s is None else math.radians(table.rate_deg_s),
        delay_s=table.delay_s,
        backlash=math.radians(table.backlash_deg),
    )


def sensor(table: FileSensor, down: ArrayLike, nose_up: ArrayLike) -> Sensor:
    """A sensor, from its table and the motion of the place where it sits.

    Parameters
    ----------
    table : Sensor of a model file
        Kind, noise, bandwidth.
    down, nose_up : array_like, shape (n,)
        Motion of that place per unit of each mode. [m, rad per unit]

    Returns
    -------
    sensor : Sensor
        Accelerometers positive down, gyros nose up.

    References
    ----------
    contract.md, `[[sensor]]`.

    Examples
    --------
    >>> gyro = FileSensor(name="gyro", kind="gyro")
    >>> sensor(gyro, [1.0, 0.2], [0.0, 1.0]).rate
    (0.0, 1.0)
    """
    point, angle = (tuple(np.asarray(x, dtype=float).tolist()) for x in (down, nose_up))
    return Sensor(
        name=table.name,
        unit={"gyro": "rad_s", "accelerometer": "m_s2", "angle": "rad", "plunge": "m"}[table.kind],
        displacement={"angle": angle, "plunge": point}.get(table.kind, ()),
        rate=angle if table.kind == "gyro" else (),
        acceleration=point if table.kind == "accelerometer" else (),
        bandwidth=table.bandwidth_rad_s,
        noise=table.noise,
        quantum=table.quantum,
        delay_s=table.delay_s,
    )


def sensors_on_shapes(placed: Iterable[PlacedSensor], phi: Array) -> tuple[Sensor, ...]:
    """Sensors on rigid streamwise arms at points of a flexural axis.

    Parameters
    ----------
    placed : iterable of PlacedSensor, length m
        One for each point.
    phi : ndarray, shape (m, 6, n)
        Shapes there, geometry axes. [m, rad per unit]

    Returns
    -------
    sensors : tuple of Sensor, length m
        A point d aft of the axis moves down by h + d theta, theta the rotation about y.

    References
    ----------
    conventions.md, "Signs": h down is -z, nose up is a rotation about +y.

    Examples
    --------
    >>> phi = np.zeros((1, 6, 1)); phi[0, 2], phi[0, 4] = -1.0, 0.5
    >>> table = FileSensor(name="acc", kind="accelerometer")
    >>> sensors_on_shapes([PlacedSensor(sensor=table, y=1.0, aft=0.4)], phi)[0].acceleration
    (1.2,)
    """
    return tuple(sensor(p.sensor, -row[2] + p.aft * row[4], row[4]) for p, row in zip(placed, phi))
