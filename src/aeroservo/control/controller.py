"""Controllers as data: the JSON file of the contract, sampled or continuous, with or without a schedule.

A continuous controller holds no delay, limits or schedule, and is refused with the reason if given any: between
samples there is no moment at which a command could be delayed, clipped or blended as a computer does it, and a
computer is what flies it. Give it a sample time.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.control.controller_json import fields_of, no_constant
from aeroservo.datatypes import Array, LinearSystem, frozen

LARGEST = 10_000_000
"""Largest controller file read. [byte]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Controller:
    """x[k+1] = A x[k] + B y[k] + windup (clip(u[k]) - u[k]), u[k] = C x[k] + D y[k]; clip(u) is added to the inputs.

    Attributes
    ----------
    A, B, C, D : ndarray, shapes (p, n_c, n_c), (p, n_c, n_in), (p, n_out, n_c), (p, n_out, n_in)
        Matrices at p points of a schedule, 1 where there is none. [SI]
    inputs, outputs : tuple of str
        Channels that it reads, and commands that it adds to.
    dt_s : float, optional
        Sample time; None is continuous. [s]
    delay_s : float
        Computing delay: a command acts that much later than its sample. [s]
    limits : tuple of float, length n_out
        Largest magnitude of each output, 0 for none. [unit of the output]
    pressures : ndarray, shape (p,)
        Dynamic pressure of each point, ascending; held beyond the ends. [Pa]
    windup : ndarray, shape (p, n_c, n_out)
        What the states hear of a clipped command, so that integrals stop and observers know what was done; default
        zero. [SI]
    """

    A: Array
    B: Array
    C: Array
    D: Array
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    dt_s: float | None = None
    delay_s: float = 0.0
    limits: tuple[float, ...] = ()
    pressures: Array = None  # type: ignore[assignment]
    windup: Array = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        """Lock the arrays and check shapes, sample time, delay and schedule."""
        n_in, n_out = len(self.inputs), len(self.outputs)
        n_c = np.shape(self.A)[-1] if np.size(self.A) else 0
        points = 1 if self.pressures is None else len(self.pressures)
        shapes = {"A": (n_c, n_c), "B": (n_c, n_in), "C": (n_out, n_c), "D": (n_out, n_in)}
        for name, shape in (shapes | {"windup": (n_c, n_out)}).items():
            given = getattr(self, name)
            value = np.asarray(() if name == "windup" and given is None else given, dtype=float)
            if value.size == 0:
                value = np.zeros((points, *shape))
            array = frozen(value.reshape(1, *value.shape) if value.ndim == 2 else value, ndim=3, name=name)
            if array.shape != (points, *shape):
                raise ValueError(f"{name} must have shape {shape} at each of {points} points, got {array.shape}")
            object.__setattr__(self, name, array)
        pressures = frozen(np.zeros(1) if self.pressures is None else self.pressures, ndim=1, name="pressures")
        if np.any(np.diff(pressures) <= 0.0):
            raise ValueError("dynamic pressures of a schedule must ascend [Pa]")
        object.__setattr__(self, "pressures", pressures)
        object.__setattr__(self, "limits", self.limits or (0.0,) * n_out)
        if len(self.limits) != n_out or min(self.limits, default=0.0) < 0.0:
            raise ValueError(f"limits must be {n_out} numbers, not negative, got {self.limits}")
        if self.dt_s is not None and not 0.0 < self.dt_s < math.inf:
            raise ValueError(f"dt_s must be positive [s] or null, got {self.dt_s}")
        if not 0.0 <= self.delay_s < math.inf:
            raise ValueError(f"delay_s must not be negative [s], got {self.delay_s}")
        if self.dt_s is None and (self.delay_s or points > 1 or any(self.limits) or np.any(self.windup)):
            raise ValueError(
                "a continuous controller (dt_s null) cannot have delay_s, limits, windup or a schedule: they belong "
                "to the computer that samples it; give it a sample time (dt_s)"
            )

    @property
    def continuous(self) -> LinearSystem | None:
        """The controller as a continuous system; None where it is sampled. [SI]"""
        if self.dt_s is not None:
            return None
        states = tuple(f"x{i + 1}" for i in range(self.A.shape[-1]))
        return LinearSystem(
            A=self.A[0], B=self.B[0], C=self.C[0], D=self.D[0], states=states, inputs=self.inputs, outputs=self.outputs
        )

    def blend(self, pressure: Array) -> Array:
        """Point to the left and weight of the one to the right at pressures (n,) [Pa], shape (n, 2). [-]"""
        held = np.clip(pressure, self.pressures[0], self.pressures[-1])
        last = max(len(self.pressures) - 2, 0)
        left = np.clip(np.searchsorted(self.pressures, held, side="right") - 1, 0, last)
        right = np.minimum(left + 1, len(self.pressures) - 1)
        width = self.pressures[right] - self.pressures[left]
        weight = np.where(width > 0.0, (held - self.pressures[left]) / np.where(width > 0.0, width, 1.0), 0.0)
        return np.stack([left.astype(float), weight], axis=1)


def controller_of(system: LinearSystem) -> Controller:
    """A linear system as a controller; its input delay becomes the computing delay.

    Parameters
    ----------
    system : LinearSystem
        One system, continuous or sampled. [SI]

    Returns
    -------
    controller : Controller
        The same matrices. [SI]

    Raises
    ------
    ValueError
        If it is a batch, or continuous with a delay.

    References
    ----------
    contract.md, "Controller file (JSON)".

    Examples
    --------
    >>> names = {"states": (), "inputs": ("gyro_rad_s",), "outputs": ("elevon_rad",)}
    >>> empty = {"A": np.zeros((0, 0)), "B": np.zeros((0, 1)), "C": np.zeros((1, 0)), "D": [[0.3]]}
    >>> controller_of(LinearSystem(**empty, **names, dt=0.005)).D.tolist()
    [[[0.3]]]
    """
    if system.A.ndim != 2:
        raise ValueError(f"one controller is wanted, got a batch of shape {system.A.shape[:-2]}")
    return Controller(
        A=system.A,
        B=system.B,
        C=system.C,
        D=system.D,
        inputs=system.inputs,
        outputs=system.outputs,
        dt_s=system.dt,
        delay_s=system.input_delay_s,
    )


def state_feedback(K: ArrayLike, inputs: tuple[str, ...], outputs: tuple[str, ...], dt_s: float | None) -> Controller:
    """u = -K y, sampled or continuous.

    Parameters
    ----------
    K : array_like, shape (n_out, n_in)
        Gains. [SI]
    inputs, outputs : tuple of str
        Channels read, commands driven.
    dt_s : float, optional
        Sample time; None is continuous. [s]

    Returns
    -------
    controller : Controller
        With D = -K. [SI]

    Raises
    ------
    ValueError
        If K does not fit the channels, or the sample time is not positive.

    References
    ----------
    equations.md, "Control" (u = -K x throughout).

    Examples
    --------
    >>> state_feedback([[2.0, 0.5]], ("pitch_rad", "pitch_rate_rad_s"), ("elevon_rad",), None).D.tolist()
    [[[-2.0, -0.5]]]
    """
    K = np.atleast_2d(np.asarray(K, dtype=float))
    if K.shape != (len(outputs), len(inputs)):
        raise ValueError(f"K must have shape {(len(outputs), len(inputs))}, got {K.shape}")
    return Controller(
        A=np.zeros((0, 0)), B=np.zeros((0, 0)), C=np.zeros((0, 0)), D=-K, inputs=inputs,
        outputs=outputs, dt_s=dt_s,
    )  # fmt: skip


def read_controller(path: str | Path) -> Controller:
    """A controller from its JSON file.

    Parameters
    ----------
    path : str or Path
        JSON with A, B, C, D, dt_s, delay_s, inputs, outputs, limits, or `points` of a schedule.

    Returns
    -------
    controller : Controller
        Checked. [SI]

    Raises
    ------
    ValueError
        Naming the file, the field and what is allowed.

    References
    ----------
    contract.md, "Controller file (JSON)".

    Examples
    --------
    >>> import tempfile
    >>> gain = state_feedback([[0.3]], ("gyro_rad_s",), ("elevon_rad",), 0.005)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_controller(Path(folder) / "gain.json", gain)
    ...     read_controller(Path(folder) / "gain.json").dt_s
    0.005
    """
    path = Path(path)
    try:
        if path.stat().st_size > LARGEST:
            raise ValueError(f"is larger than {LARGEST / 1e6:.0f} MB")
        data = json.loads(path.read_text(encoding="utf-8"), parse_constant=no_constant)
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror or error}") from None
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise ValueError(f"{path}: is not valid JSON: {error}") from None
    except RecursionError:
        raise ValueError(f"{path}: is nested too deeply") from None
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    try:
        return Controller(**fields_of(data))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def write_controller(path: str | Path, controller: Controller | LinearSystem) -> None:
    """Write a controller to its JSON file, whole or not at all; `read_controller` reads the same numbers back.

    Parameters
    ----------
    path : str or Path
        Where to; an existing file is replaced.
    controller : Controller or LinearSystem
        One controller, or a schedule. [SI]

    Raises
    ------
    ValueError
        If the file cannot be written, or a linear system is no controller (see `controller_of`).

    References
    ----------
    contract.md, "Controller file (JSON)".

    Examples
    --------
    >>> import tempfile
    >>> gain = state_feedback([[0.3]], ("gyro_rad_s",), ("elevon_rad",), 0.005)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "gain.json"
    ...     write_controller(path, gain)
    ...     json.loads(path.read_text())["D"]
    [[-0.3]]
    """
    from aeroservo.aircraft.files import write_whole

    content = controller_content(controller)
    try:
        write_whole(Path(path), (json.dumps(content, allow_nan=False, indent=1) + "\n").encode())
    except OSError as error:
        raise ValueError(f"{path}: cannot be written: {error.strerror or error}") from None


def controller_content(controller: Controller | LinearSystem) -> dict[str, Any]:
    """What a controller file holds, as lists and numbers for JSON.

    Parameters
    ----------
    controller : Controller or LinearSystem
        One controller, or a schedule. [SI]

    Returns
    -------
    content : dict
        Keys of the contract; `points` where there is a schedule.

    Raises
    ------
    ValueError
        If a linear system is no controller (see `controller_of`).

    References
    ----------
    contract.md, "Controller file (JSON)".

    Examples
    --------
    >>> controller_content(state_feedback([[0.3]], ("gyro_rad_s",), ("elevon_rad",), None))["dt_s"] is None
    True
    """
    c = controller_of(controller) if isinstance(controller, LinearSystem) else controller
    head: dict[str, Any] = {
        "schema_version": 1,
        "inputs": list(c.inputs),
        "outputs": list(c.outputs),
        "dt_s": c.dt_s,
        "delay_s": c.delay_s,
        "limits": {name: limit for name, limit in zip(c.outputs, c.limits) if limit},
    }
    kept = [*"ABCD", *(["windup"] if np.any(c.windup) else [])]
    points = [{name: getattr(c, name)[i].tolist() for name in kept} for i in range(len(c.pressures))]
    if len(points) == 1:
        return head | points[0]
    pressures = [{"dynamic_pressure_Pa": float(q)} for q in c.pressures]
    return head | {"interpolation": "linear", "points": [q | point for q, point in zip(pressures, points)]}
