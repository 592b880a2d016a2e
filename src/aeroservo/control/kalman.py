"""Kalman filters, continuous and sampled, for the sensors that an aircraft has.

Noise of a design plant: each gust input w_g, each command (the noise of loop-transfer recovery), and each sensor. For a
sampled plant they are standard deviations of values held over a sample; for a continuous one their squares are
intensities. The gain depends on their ratios only, so the same numbers mean nearly the same filter at any rate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.control.lqr import riccati
from aeroservo.control.verify import explain_filter, riccati_residual
from aeroservo.datatypes import Array
from aeroservo.servo import Sensor

SENSOR_NOISE = {
    "rad_s": math.radians(0.1),
    "rad": math.radians(0.1),
    "m_s2": 0.1,
    "m_s": 0.01,
    "m": 0.001,
}
"""Standard deviation of a sensor where none is given, by unit: a small MEMS gyro and accelerometer. [SI]"""


def kalman_gain(
    A: ArrayLike, C: ArrayLike, W: ArrayLike, V: ArrayLike, *, S: ArrayLike | None = None, dt: float | None = None,
    states: Sequence[str] | None = None, outputs: Sequence[str] | None = None,
) -> tuple[Array, Array]:  # fmt: skip
    """Gain of the Kalman filter in predictor form, x' = A x + L (y - C x), and the covariance of its error.

    Parameters
    ----------
    A, C : array_like, shapes (..., n, n), (..., p, n)
        Plants. [SI]
    W, V : array_like, shapes (..., n, n), (..., p, p)
        Covariance (sampled) or intensity (continuous) of the noise of states and sensors; V positive definite. [SI]
    S : array_like, shape (..., n, p), optional
        Cross covariance of the two. [SI]
    dt : float, optional
        Sample time; None is continuous. [s]
    states, outputs : sequence of str, optional
        Names, for errors.

    Returns
    -------
    L : ndarray, shape (..., n, p)
        Gain. [SI]
    P : ndarray, shape (..., n, n)
        Covariance of the error; of a sampled filter before the sample is read. [SI]

    Raises
    ------
    ValueError
        If no stable filter exists or none is found to precision: which mode, and why.

    References
    ----------
    B. D. O. Anderson and J. B. Moore, Optimal Filtering, 1979, chapter 4 and section 5.4.

    Examples
    --------
    >>> L, P = kalman_gain([[0.0]], [[1.0]], [[4.0]], [[1.0]])
    >>> round(float(L[0, 0]), 12)
    2.0
    """
    A, C, W, V = (np.asarray(x, dtype=float) for x in (A, C, W, V))
    names = states or tuple(f"x{i + 1}" for i in range(A.shape[-1]))
    batch, n, p = A.shape[:-2], A.shape[-1], C.shape[-2]
    W, V = np.broadcast_to(W, (*batch, n, n)), np.broadcast_to(V, (*batch, p, p))
    cross = np.broadcast_to(np.zeros((n, p)) if S is None else np.asarray(S, dtype=float), (*batch, n, p))
    P, L = np.zeros((*batch, n, n)), np.zeros((*batch, n, p))
    for i in np.ndindex(*batch):
        N = cross[i] if np.any(cross[i]) else None
        try:
            P[i] = riccati(A[i].T, C[i].T, W[i], V[i], N=N, dt=dt)
        except (np.linalg.LinAlgError, ValueError) as error:
            why = explain_filter(A[i], C[i], W[i], names, dt=dt, outputs=outputs or ())
            where = f"{list(i)} of the batch: " if i else ""
            raise ValueError(f"{where}the filter problem {why} ({error})") from None
        if dt is None:
            L[i] = np.linalg.solve(V[i], (P[i] @ C[i].T + cross[i]).T).T
        else:
            L[i] = np.linalg.solve(V[i] + C[i] @ P[i] @ C[i].T, (A[i] @ P[i] @ C[i].T + cross[i]).T).T
    return L, P


def filter_residual(
    A: ArrayLike, C: ArrayLike, W: ArrayLike, V: ArrayLike, P: ArrayLike, *, S: ArrayLike | None = None,
    dt: float | None = None,
) -> Array:  # fmt: skip
    """How far P is from solving the filter's Riccati equation, relative to the terms of the equation.

    Parameters
    ----------
    A, C, W, V : array_like, shapes (..., n, n), (..., p, n), (..., n, n), (..., p, p)
        Plant and noise. [SI]
    P : array_like, shape (..., n, n)
        Claimed solution. [SI]
    S : array_like, shape (..., n, p), optional
        Cross covariance. [SI]
    dt : float, optional
        Sample time; None is continuous. [s]

    Returns
    -------
    residual : ndarray, shape (...)
        As `riccati_residual` of the dual problem. [-]

    References
    ----------
    B. D. O. Anderson and J. B. Moore, Optimal Filtering, 1979, section 4.4; duality: T. Kailath, Linear Systems, 1980,
    section 2.4.

    Examples
    --------
    >>> float(filter_residual([[0.0]], [[1.0]], [[4.0]], [[1.0]], [[2.0]]))
    0.0
    """
    A, C = np.asarray(A, dtype=float), np.asarray(C, dtype=float)
    return riccati_residual(np.swapaxes(A, -1, -2), np.swapaxes(C, -1, -2), W, V, P, N=S, dt=dt)


def sensor_deviations(outputs: Sequence[str], sensors: Sequence[Sensor] = ()) -> Array:
    """Standard deviations of sensors: their own noise where they state it, else by the unit in their channel name.

    Parameters
    ----------
    outputs : sequence of str
        Channel names, with the unit as suffix.
    sensors : sequence of Sensor
        Those of the model.

    Returns
    -------
    deviations : ndarray, shape (n_y,)
        Of the sensors or of `SENSOR_NOISE`. [SI]

    Raises
    ------
    ValueError
        If a channel has no known unit: its noise must be given.

    References
    ----------
    Project convention: order of magnitude of small MEMS sensors (0.1 deg/s and 0.1 m/s^2 over 100 Hz).

    Examples
    --------
    >>> sensor_deviations(("acc_te_m_s2",)).tolist()
    [0.1]
    """
    own = {sensor.channel: sensor.noise for sensor in sensors if sensor.noise > 0.0}
    found = []
    for name in outputs:
        if name in own:
            found.append(own[name])
            continue
        unit = next((u for u in SENSOR_NOISE if name == u or name.endswith(f"_{u}")), None)
        if unit is None:
            raise ValueError(f"the noise of {name!r} is not known by its unit: give V")
        found.append(SENSOR_NOISE[unit])
    return np.array(found)
