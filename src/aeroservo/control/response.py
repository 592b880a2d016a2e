"""What a sampled controller does with a record of measurements, sum by sum as the compiled engine and the C export do.

The order of every sum is that of `simulate/_kernels.control` and of the C99 code of `export_c.py`, so that the three
give the same bits: this is the reference that both are tested against.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.control.controller import Controller
from aeroservo.datatypes import Array


def controller_response(
    controller: Controller,
    measured: ArrayLike,
    pressure: ArrayLike | None = None,
    *,
    state: ArrayLike | None = None,
) -> tuple[Array, Array]:
    """Commands of a sampled controller for a record of measurements.

    Parameters
    ----------
    controller : Controller
        Sampled, with or without a schedule. Its `delay_s` is no part of this: the command is that of the same sample.
    measured : array_like, shape (n, n_in)
        Measured values at each sample. [unit of each input]
    pressure : array_like, shape (n,), optional
        Dynamic pressure at each sample; needed by a schedule. [Pa]
    state : array_like, shape (n_c,), optional
        State of the controller at the start; zero if not given. [SI]

    Returns
    -------
    commands : ndarray, shape (n, n_out)
        Within the controller's limits. [unit of each output]
    state : ndarray, shape (n_c,)
        After the last sample. [SI]

    Raises
    ------
    ValueError
        If the controller is continuous, a shape does not fit, a schedule has no pressure, or a value is not finite.

    References
    ----------
    contract.md, "Controller file (JSON)"; K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 1997,
    section 9.4 (the state is driven by the command that the limits let through).

    Examples
    --------
    >>> from aeroservo.control.controller import state_feedback
    >>> gain = state_feedback([[0.3]], ("gyro_rad_s",), ("elevon_rad",), 0.005)
    >>> controller_response(gain, [[1.0], [-2.0]])[0].tolist()
    [[-0.3], [0.6]]
    """
    c = controller
    if c.dt_s is None:
        raise ValueError("a continuous controller has no samples: give it a sample time (dt_s) [s]")
    y = np.asarray(measured, dtype=float)
    n_c, n_in = c.A.shape[-1], len(c.inputs)
    if y.ndim != 2 or y.shape[1] != n_in:
        raise ValueError(f"measured must have shape (n, {n_in}), got {y.shape}")
    if pressure is None and len(c.pressures) > 1:
        raise ValueError("a schedule needs the dynamic pressure at each sample: pressure [Pa]")
    q = np.zeros(len(y)) if pressure is None else np.asarray(pressure, dtype=float)
    if q.shape != (len(y),):
        raise ValueError(f"pressure must have shape ({len(y)},), got {q.shape}")
    x = np.zeros(n_c) if state is None else np.asarray(state, dtype=float)
    if x.shape != (n_c,):
        raise ValueError(f"state must have shape ({n_c},), got {x.shape}")
    if not (np.all(np.isfinite(y)) and np.all(np.isfinite(q)) and np.all(np.isfinite(x))):
        raise ValueError("measured, pressure and state must be finite")
    return _stepped(c, y, c.blend(q), x.tolist())


def _stepped(c: Controller, y: Array, blend: Array, x: list[float]) -> tuple[Array, Array]:
    """Every sample in turn, in plain numbers."""
    n_out = len(c.outputs)
    points = np.concatenate([c.A, c.B, c.windup], axis=2).tolist()
    outputs = np.concatenate([c.C, c.D], axis=2).tolist()
    limits, last = c.limits, len(points) - 1
    commands = np.zeros((len(y), n_out))
    for k, (sample, (left, weight)) in enumerate(zip(y.tolist(), blend.tolist())):
        i = int(left)
        j = min(i + 1, last)
        known = x + sample
        u = [_blended(low, high, weight, known) for low, high in zip(outputs[i], outputs[j])]
        held = [min(max(a, -b), b) if b > 0.0 else a for a, b in zip(u, limits)]
        known = known + [a - b for a, b in zip(held, u)]
        x = [_blended(low, high, weight, known) for low, high in zip(points[i], points[j])]
        commands[k] = held
    if not all(map(math.isfinite, x)) or not np.all(np.isfinite(commands)):
        raise ValueError("the controller itself runs away on this record: its states are no longer finite")
    return commands, np.array(x)


def _blended(low: list[float], high: list[float], weight: float, values: list[float]) -> float:
    """One row between two points of a schedule, times the values, summed from the left."""
    total = 0.0
    for a, b, v in zip(low, high, values):
        total += (a + weight * (b - a)) * v
    return total
