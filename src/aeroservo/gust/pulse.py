"""Largest responses of a linear aircraft to 1-cosine gusts: any number of gusts in one exact calculation.

Between samples the system is stepped by its matrix exponential, the gust by the parabola through its values at both
ends and the middle of a step: exact for the system however stiff it is, of fourth order in the step for the gust, which
has two hundred steps or more. All gusts go together, many steps in one matrix product. Peaks between samples are those
of the parabola through three samples.

The tail after a gust is followed until what is left has decayed, for a minute at most: near flutter, where it does not
decay, a beat that tops the first swings later than that is not seen.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.datatypes import frozen

__all__ = ["PulsePeaks", "pulse_peaks"]

Array = NDArray[Any]

STEPS_PER_PULSE = 200
"""Samples in the shortest gust, at least."""

STEPS_PER_PERIOD = 20
"""Samples in the shortest period that counts."""

HARMONICS = 25.0
"""Modes faster than this many times the frequency of the shortest gust follow it without delay."""

LONGEST_TAIL = 60.0
"""Time that is followed after the longest gust, at most. [s]"""

MOST_STEPS = 400_000
_BLOCK = 32


@dataclass(frozen=True, kw_only=True, eq=False)
class PulsePeaks:
    """Largest responses to gusts.

    Attributes
    ----------
    peak : ndarray, shape (n_gusts, n_y)
        Largest magnitude of each output. [unit of the output]
    lowest, highest : ndarray, shape (n_gusts, n_y)
        Extreme values with their signs; 0 where the output never has that sign. [unit of the output]
    dt : float
        Step. [s]
    duration : float
        Time that was computed, from the first touch of the gust. [s]
    """

    peak: Array
    lowest: Array
    highest: Array
    dt: float
    duration: float

    def __post_init__(self) -> None:
        for name in ("peak", "lowest", "highest"):
            object.__setattr__(self, name, frozen(getattr(self, name), ndim=2, name=name))


def pulse_peaks(
    plant: tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike],
    amplitude: ArrayLike,
    length: ArrayLike,
    V: float,
    *,
    rate: ArrayLike | None = None,
    x_offset: ArrayLike = 0.0,
) -> PulsePeaks:
    """Largest responses to a set of 1-cosine gusts.

    Parameters
    ----------
    plant : tuple of array_like, shapes (n, n), (n, m), (n_y, n), (n_y, m)
        A, B, C, D of a stable system from the gust velocities w_g at m zones [m/s] to the outputs.
    amplitude, length : array_like, shape (n_gusts,)
        Peak velocity [m/s] and whole wavelength [m] of each gust.
    V : float
        True airspeed, positive. [m/s]
    rate : array_like, shape (n_y, m), optional
        Outputs per rate of change of w_g, where accelerations feel it. [unit of the output per m/s^2]
    x_offset : array_like, shape (m,) or scalar
        Distance of each zone aft of the reference point: it meets the gust x_offset/V later. [m]

    Returns
    -------
    peaks : PulsePeaks
        Of every output in every gust.

    Raises
    ------
    ValueError
        If the system is unstable, a length or the airspeed is not positive, or the shapes disagree.

    References
    ----------
    CS-25.341(a)(2)-(3); C. F. Van Loan, IEEE Trans. Autom. Control 23(3), 1978 (matrices of one step).

    Examples
    --------
    >>> fast = ([[-1e4]], [[1e4]], [[1.0]], [[0.0]])  # follows the gust at once
    >>> pulse_peaks(fast, [2.0, 3.0], [20.0, 40.0], 50.0).peak.round(3).ravel()
    array([2., 3.])
    """
    A, B, C, D = (np.atleast_2d(np.asarray(x, dtype=float)) for x in plant)
    w0, L = np.broadcast_arrays(np.atleast_1d(np.asarray(amplitude, float)), np.atleast_1d(np.asarray(length, float)))
    m = B.shape[1]
    D_rate = np.zeros_like(D) if rate is None else np.asarray(rate, dtype=float)
    offset = np.broadcast_to(np.asarray(x_offset, dtype=float), (m,))
    roots = _check(A, B, C, D, D_rate, L, V)
    dt, pulse, steps = _grid(roots, L, V, offset)
    step = _step(A, B, dt)
    blocks, count = -(-steps // _BLOCK), _BLOCK
    lifted = _lift(step, C, D, D_rate, count)
    X, extreme = np.zeros((A.shape[0], w0.size)), np.zeros((2, C.shape[0], w0.size))
    before = np.zeros((2, C.shape[0], w0.size))
    for block in range(blocks):
        t = dt * (block * count + 0.5 * np.arange(2 * count + 1))
        Y, X = _advance(lifted, X, t, w0, L, V, offset, pulse)
        extreme = _extremes(extreme, np.concatenate([before, Y]))
        before = Y[-2:]
    lowest, highest = extreme[0].T, extreme[1].T
    return PulsePeaks(
        peak=np.maximum(-lowest, highest), lowest=lowest, highest=highest, dt=dt, duration=blocks * count * dt
    )


def _check(A: Array, B: Array, C: Array, D: Array, D_rate: Array, L: Array, V: float) -> Array:
    """Eigenvalues of a system that may be used."""
    n, m, n_y = A.shape[0], B.shape[1], C.shape[0]
    if (A.shape, B.shape, C.shape, D.shape, D_rate.shape) != ((n, n), (n, m), (n_y, n), (n_y, m), (n_y, m)):
        raise ValueError(
            f"plant must have shapes (n, n), (n, m), (n_y, n), (n_y, m) and rate (n_y, m), got "
            f"{A.shape}, {B.shape}, {C.shape}, {D.shape} and {D_rate.shape}"
        )
    if not V > 0.0:
        raise ValueError(f"airspeed V must be positive [m/s], got {V:g}")
    if not np.all((L > 0.0) & np.isfinite(L)):
        raise ValueError(f"gust length must be positive [m], got {np.min(L):g}")
    roots = np.linalg.eigvals(A)
    growth = roots.real.max(initial=-np.inf)
    if not growth < 0.0:
        raise ValueError(f"the system must be stable for peaks to exist; largest Re(eigenvalue) {growth:g} [1/s]")
    return roots


def _grid(roots: Array, L: Array, V: float, offset: Array) -> tuple[float, float, int]:
    """Step, time at which the last zone has left the longest gust, number of steps."""
    shortest = float(L.min()) / V
    swings = np.abs(roots.imag[np.abs(roots.imag) > 0.1 * np.abs(roots.real)])  # less than that never swings back
    fast = min(float(swings.max(initial=0.0)), HARMONICS * 2.0 * np.pi / shortest)
    dt = shortest / STEPS_PER_PULSE
    if fast:
        dt = min(dt, 2.0 * np.pi / (STEPS_PER_PERIOD * fast))
    pulse = (float(L.max()) + float(np.ptp(np.append(offset, 0.0)))) / V
    slow = 4.0 / float(np.abs(roots.real).min()) if roots.size else 0.0
    period = 4.0 * np.pi / float(swings.min()) if swings.size else 0.0
    tail = min(max(slow, period), LONGEST_TAIL)
    steps = int(np.ceil((pulse + tail) / dt))
    if steps > MOST_STEPS:
        steps = max(MOST_STEPS, int(np.ceil(1.2 * pulse / dt)))
    return dt, pulse, steps


def _step(A: Array, B: Array, dt: float) -> tuple[Array, Array]:
    """Transition, and drives (3, n, m) of the gust at the start, the middle and the end of a step."""
    from scipy.linalg import expm

    n, m = B.shape
    chain = np.zeros((n + 3 * m, n + 3 * m))
    chain[:n, :n], chain[:n, n : n + m] = A * dt, B * dt  # w = c0 + c1 f + c2 f^2/2 over the fraction f of the step
    for i in range(2):
        rows = np.arange(n + i * m, n + (i + 1) * m)
        chain[rows, rows + m] = 1.0
    E = expm(chain)
    c0, c1, c2 = (E[:n, n + i * m : n + (i + 1) * m] for i in range(3))
    return E[:n, :n], np.stack([c0 - 3.0 * c1 + 4.0 * c2, 4.0 * c1 - 8.0 * c2, 4.0 * c2 - c1])


def _lift(step: tuple[Array, Array], C: Array, D: Array, D_rate: Array, count: int) -> tuple[Array, ...]:
    """Many steps as one: outputs from state, gusts and their rates at half steps; the state at the end likewise."""
    Phi, drive = step
    n, m = drive.shape[1:]
    power, L = np.eye(n), np.zeros((n, (2 * count + 1) * m))
    Y_x, Y_w = [], []
    for k in range(count):
        Y_x.append(C @ power)
        now = C @ L
        now[:, 2 * k * m : (2 * k + 1) * m] += D
        Y_w.append(now)
        power, L = Phi @ power, Phi @ L
        for i in range(3):
            L[:, (2 * k + i) * m : (2 * k + i + 1) * m] += drive[i]
    return np.concatenate(Y_x), np.concatenate(Y_w), D_rate, power, L


def _advance(
    lifted: tuple[Array, ...], X: Array, t: Array, w0: Array, L: Array, V: float, offset: Array, pulse: float
) -> tuple[Array, Array]:
    """Outputs (count, n_y, n_gusts) over one block and the states after it; `t` are its half steps."""
    Y_x, Y_w, D_rate, power, L_w = lifted
    n_y, count = D_rate.shape[0], (t.size - 1) // 2
    if t[0] > pulse + abs(float(offset.min(initial=0.0))) / V:
        return (Y_x @ X).reshape(count, n_y, -1), power @ X
    first = float(min(offset.min(initial=0.0), 0.0))
    x = V * t[:, None, None] + first - offset[:, None]  # (half steps, zones, gusts): the first zone meets it at t = 0
    turn = 2.0 * np.pi / L
    inside = (x > 0.0) & (x < L)
    w = np.where(inside, 0.5 * w0 * (1.0 - np.cos(turn * x)), 0.0).reshape(-1, w0.size)
    Y = (Y_x @ X + Y_w @ w).reshape(count, n_y, -1)
    if np.any(D_rate):
        w_dot = np.where(inside, 0.5 * w0 * turn * V * np.sin(turn * x), 0.0)[: 2 * count : 2]
        Y = Y + np.einsum("ym,kmg->kyg", D_rate, w_dot)
    return Y, power @ X + L_w @ w


def _extremes(extreme: Array, Y: Array) -> Array:
    """Extremes so far and those of samples (k, n_y, n_gusts), with the tops of parabolas between them."""
    left, middle, right = Y[:-2], Y[1:-1], Y[2:]
    bend = left - 2.0 * middle + right
    slope = right - left
    inside = (np.abs(slope) < 2.0 * np.abs(bend)) & (bend != 0.0)  # the top lies within half a sample of the middle
    top = middle - np.where(inside, slope**2 / (8.0 * np.where(inside, bend, 1.0)), 0.0)
    values = np.concatenate([Y, top])
    return np.stack([np.minimum(extreme[0], values.min(axis=0)), np.maximum(extreme[1], values.max(axis=0))])
