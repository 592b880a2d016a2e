"""Tables `[actuator]` and `[[sensor]]` of model files: what moves the controls, and what is measured where."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from aeroservo.aircraft.schema_base import LONGEST, Table, quantity

_AFT = "place aft of the flexural axis"


class Actuator(Table):
    """`[actuator]`: first order, or second order where `zeta` is given."""

    gain: float = quantity("static gain", "-", default=1.0)
    omega_rad_s: float = quantity("bandwidth", "rad/s", gt=0.0)
    zeta: float | None = quantity("damping ratio; without it the actuator is of first order", "-", gt=0.0, default=None)
    limit_deg: float | None = quantity("largest deflection either way", "deg", gt=0.0, le=180.0, default=None)
    rate_deg_s: float | None = quantity("largest rate either way", "deg/s", gt=0.0, default=None)
    delay_s: float = quantity("dead time", "s", ge=0.0, le=100.0, default=0.0)
    backlash_deg: float = quantity("half width of the play", "deg", ge=0.0, le=90.0, default=0.0)


class ControlActuator(Actuator):
    """`[[actuator]]` of a model with several controls."""

    control: str = Field(description="control that it moves, by its name", min_length=1, max_length=100)


class Sensor(Table):
    """What sensors have in common."""

    name: str = Field(
        description="name of the sensor", min_length=1, max_length=100, pattern=r"^[A-Za-z_][A-Za-z0-9_]*$"
    )
    kind: Literal["gyro", "accelerometer", "angle", "plunge"] = Field(
        description="what it measures: pitch rate, acceleration (positive down), pitch angle, motion (down)"
    )
    bandwidth_rad_s: float | None = quantity("corner of its lag of first order", "rad/s", gt=0.0, default=None)
    noise: float = quantity("standard deviation of white noise at each sample", "SI", ge=0.0, default=0.0)
    quantum: float = quantity("step to which samples are rounded", "SI", ge=0.0, default=0.0)
    delay_s: float = quantity("age of a sample when it is read", "s", ge=0.0, le=100.0, default=0.0)


class AxisSensor(Sensor):
    """`[[sensor]]` of kind `pitch_plunge_flap`."""

    x_m: float = quantity("place aft of the pitch axis", "m", ge=-LONGEST, le=LONGEST, default=0.0)


class WingSensor(Sensor):
    """`[[sensor]]` of a half wing with a flexural axis."""

    y_m: float = quantity("place along the flexural axis, from the root", "m", ge=0.0, le=LONGEST, default=0.0)
    x_m: float = quantity(_AFT + ", streamwise", "m", ge=-LONGEST, le=LONGEST, default=0.0)


class AircraftSensor(Sensor):
    """`[[sensor]]` of an aircraft, in the axes of the file."""

    y_m: float = quantity("place from the plane of symmetry", "m", ge=0.0, le=LONGEST, default=0.0)
    x_m: float | None = quantity("place aft; default on the flexural axis", "m", ge=-LONGEST, le=LONGEST, default=None)


class GridSensor(Sensor):
    """`[[sensor]]` of kind `modal`."""

    grid_point: int = Field(description="row of `grid` and `phi`, from 0 [-]", ge=0)


def names_differ(names: list[str] | tuple[str, ...], what: str) -> None:
    """Refuse names that occur twice.

    Parameters
    ----------
    names : list of str
        All of them.
    what : str
        What they name, for the message.

    Raises
    ------
    ValueError
        Naming those that occur twice.

    References
    ----------
    Project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> names_differ(["gyro", "accelerometer"], "sensor names")
    """
    twice = sorted({name for name in names if list(names).count(name) > 1})
    if twice:
        raise ValueError(f"{what} must differ, twice: {', '.join(twice)}")


def check_servo(
    actuator: Actuator | None, sensors: tuple[WingSensor, ...], elevon: bool, root: float, tip: float
) -> None:
    """Refuse an actuator without an elevon, sensors of one name, and sensors off the wing.

    Parameters
    ----------
    actuator : Actuator, optional
        Of the file.
    sensors : tuple of WingSensor
        Of the file.
    elevon : bool
        Whether the file has one.
    root, tip : float
        Ends of the flexural axis. [m]

    Raises
    ------
    ValueError
        Naming the table and what is allowed.

    References
    ----------
    Project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> check_servo(None, (), False, 0.0, 2.0)
    """
    if actuator is not None and not elevon:
        raise ValueError("actuator: there is no [wing.elevon] for it to move")
    names_differ([s.name for s in sensors], "sensor names")
    for i, s in enumerate(sensors):
        if not root <= s.y_m <= tip:
            raise ValueError(f"sensor[{i}].y_m must lie on the wing, from {root:g} to {tip:g} [m], got {s.y_m:g}")
