"""From a shaping filter to a recursion: exact discretisation and the spectra of the samples.

Sampling a continuous process at a step dt folds its spectrum at pi/dt. The recursion made here has exactly the
covariance of the continuous process at the sample times (Van Loan's integral), so its spectrum is the folded one to
rounding, at any step. Records are made in `records.py`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.datatypes import LinearSystem, frozen

__all__ = [
    "DiscreteNoise",
    "discrete_psd",
    "discretise",
    "folded_psd",
    "stationary_covariance",
    "step_covariance",
]

Array = NDArray[Any]
_ORDER = 16  # of the Taylor series, for |A| h <= 1/4: truncation below rounding


@dataclass(frozen=True, kw_only=True, eq=False)
class DiscreteNoise:
    """x[k+1] = Ad x[k] + Ld e[k], y[k] = C x[k], with e of independent normal numbers of unit variance.

    Attributes
    ----------
    Ad : ndarray, shape (..., n, n)
        Transition over one step. [-]
    Qd : ndarray, shape (..., n, n)
        Covariance of the noise of one step, Ld Ld^T. [states squared]
    Ld : ndarray, shape (..., n, n)
        A factor of it. [states]
    C : ndarray, shape (..., n_y, n)
        Outputs. [outputs per state]
    P : ndarray, shape (..., n, n)
        Stationary covariance of x, from which a record starts. [states squared]
    dt : float
        Step. [s]
    outputs : tuple of str
        Channel names.
    """

    Ad: Array
    Qd: Array
    Ld: Array
    C: Array
    P: Array
    dt: float
    outputs: tuple[str, ...]

    def __post_init__(self) -> None:
        for name in ("Ad", "Qd", "Ld", "C", "P"):
            object.__setattr__(self, name, frozen(getattr(self, name), name=name))


def discretise(system: LinearSystem, dt: float) -> DiscreteNoise:
    """Sample a noise-driven filter exactly: the samples have the covariance of the continuous process.

    Parameters
    ----------
    system : LinearSystem
        Continuous, stable, driven by unit white noises, without feed-through; leading axes are a batch (a sweep, or
        the steps of a flight).
    dt : float
        Step, positive. [s]

    Returns
    -------
    noise : DiscreteNoise
        Same leading axes.

    Raises
    ------
    ValueError
        If the step is not positive, or the system is discrete, unstable or has feed-through.

    References
    ----------
    C. F. Van Loan, IEEE Trans. Autom. Control 23(3), 1978, for the integral
    Qd = integral_0^dt e^(A s) B B^T e^(A^T s) ds; computed here by its Taylor series over dt/2^m and doubling,
    Q(2h) = Q(h) + e^(Ah) Q(h) e^(A^T h), carried on to its limit P.

    Examples
    --------
    >>> names = dict(states=("x",), inputs=("n",), outputs=("y",))
    >>> lag = LinearSystem(A=[[-1.0]], B=[[2.0**0.5]], C=[[1.0]], D=[[0.0]], **names)
    >>> noise = discretise(lag, 0.5)
    >>> bool(abs(noise.Qd[0, 0] - (1.0 - np.exp(-1.0))) < 1e-15)
    True
    """
    if not dt > 0.0:
        raise ValueError(f"time step dt must be positive [s], got {dt:g}")
    if system.dt is not None:
        raise ValueError(f"the filter must be continuous, got one sampled at {system.dt:g} [s]")
    if np.any(system.D != 0.0):
        raise ValueError("the filter must have no feed-through D: white noise through it has infinite variance")
    W = system.B @ np.swapaxes(system.B, -1, -2)
    Ad, Qd, Ld, P = (np.zeros(system.A.shape) for _ in range(4))
    for block in _independent(system.A, W):
        at = (..., block[:, None], block)
        F, Q = _transition(system.A[at], W[at], dt)
        Ad[at], Qd[at], Ld[at], P[at] = np.eye(block.size) + F, Q, _factor(Q), _limit(F, Q)
    return DiscreteNoise(Ad=Ad, Qd=Qd, Ld=Ld, C=system.C, P=P, dt=dt, outputs=system.outputs)


def _independent(A: Array, W: Array) -> list[Array]:
    """States in groups that neither the dynamics nor the noise couple: a cube of a sum becomes a sum of cubes."""
    from scipy.sparse.csgraph import connected_components

    pattern = ((A != 0.0) | (W != 0.0)).reshape(-1, *A.shape[-2:]).any(axis=0)
    count, label = connected_components(pattern, directed=False)
    return [np.flatnonzero(label == i) for i in range(count)]


def _transition(A: Array, W: Array, dt: float) -> tuple[Array, Array]:
    """e^(A dt) - 1 and the integral of e^(As) W e^(A^T s) over the step.

    The exponential is kept as its difference F from 1 through the doublings, so that slow states keep their digits
    beside fast ones.
    """
    norm = np.abs(A).sum(axis=-1).max(initial=0.0) * dt
    doublings = max(0, int(np.ceil(np.log2(max(norm, 1e-300) / 0.25))))
    h = dt / 2.0**doublings
    term_F, term_Q = A * h, W * h
    F, Q = term_F, term_Q
    for k in range(1, _ORDER + 1):
        half = A @ term_Q
        term_Q = (half + np.swapaxes(half, -1, -2)) * (h / (k + 1))
        term_F = term_F @ A * (h / (k + 1))
        F, Q = F + term_F, Q + term_Q
    for _ in range(doublings):
        F, Q = _doubled(F, Q)
    return F, Q


def _doubled(F: Array, Q: Array) -> tuple[Array, Array]:
    """F and Q of twice the step: 2F + F^2 and Q + (1 + F) Q (1 + F)^T."""
    FQ = F @ Q
    Q = 2.0 * Q + FQ + np.swapaxes(FQ, -1, -2) + FQ @ np.swapaxes(F, -1, -2)
    return 2.0 * F + F @ F, 0.5 * (Q + np.swapaxes(Q, -1, -2))


def _limit(F: Array, Q: Array) -> Array:
    """Stationary covariance: the integral over an endless step, by doubling."""
    for _ in range(80):
        before = Q
        with np.errstate(over="ignore", invalid="ignore"):  # an unstable filter: reported below
            F, Q = _doubled(F, Q)
        scale = np.sqrt(np.abs(np.diagonal(Q, axis1=-2, axis2=-1))).clip(1e-300)
        if not np.all(np.isfinite(scale)):
            break
        if np.all(np.abs(Q - before) <= 1e-15 * scale[..., :, None] * scale[..., None, :]):
            return Q
    raise ValueError("the filter must be stable: its covariance grows without limit")


def _factor(Q: Array) -> Array:
    """L with L L^T = Q for a positive semi-definite Q, scaled so that small states keep their digits."""
    scale = np.sqrt(np.maximum(np.diagonal(Q, axis1=-2, axis2=-1), 0.0))
    safe = np.where(scale > 0.0, scale, 1.0)
    value, vector = np.linalg.eigh(Q / (safe[..., :, None] * safe[..., None, :]))
    return scale[..., :, None] * vector * np.sqrt(np.maximum(value, 0.0))[..., None, :]


def step_covariance(A: ArrayLike, B: ArrayLike, dt: float) -> Array:
    """Covariance that white noise adds to the states of a linear system over one step, stable or not.

    Parameters
    ----------
    A : array_like, shape (..., n, n)
        System matrix. [1/s]
    B : array_like, shape (..., n, m)
        Inputs, independent unit white noises. [states/sqrt(s)]
    dt : float
        Step, positive. [s]

    Returns
    -------
    Qd : ndarray, shape (..., n, n)
        Integral over the step of e^(A s) B B^T e^(A^T s). [states squared]

    Raises
    ------
    ValueError
        If the step is not positive.

    References
    ----------
    C. F. Van Loan, IEEE Trans. Autom. Control 23(3), 1978.

    Examples
    --------
    >>> step_covariance([[0.0]], [[2.0]], 0.5)
    array([[2.]])
    """
    if not dt > 0.0:
        raise ValueError(f"time step dt must be positive [s], got {dt:g}")
    A, B = np.asarray(A, dtype=float), np.asarray(B, dtype=float)
    return _transition(A, B @ np.swapaxes(B, -1, -2), dt)[1]


def stationary_covariance(A: ArrayLike, B: ArrayLike) -> Array:
    """Covariance of the states of a stable system driven by unit white noise.

    Parameters
    ----------
    A : array_like, shape (..., n, n)
        System matrix, all eigenvalues in the left half plane. [1/s]
    B : array_like, shape (..., n, m)
        Inputs, independent unit white noises. [states/sqrt(s)]

    Returns
    -------
    P : ndarray, shape (..., n, n)
        Solution of A P + P A^T + B B^T = 0. [states squared]

    Raises
    ------
    ValueError
        If the system is not stable (its covariance is infinite).

    References
    ----------
    Lyapunov's equation; A. E. Bryson and Y.-C. Ho, Applied Optimal Control, 1975, section 11.4.

    Examples
    --------
    >>> stationary_covariance([[-2.0]], [[2.0]])
    array([[1.]])
    """
    from scipy.linalg import solve_continuous_lyapunov

    A, B = np.asarray(A, dtype=float), np.asarray(B, dtype=float)
    growth = np.linalg.eigvals(A).real.max(initial=-np.inf)
    if not growth < 0.0:
        raise ValueError(
            f"the system must be stable for a stationary response; largest Re(eigenvalue) {growth:g} [1/s]"
        )
    W = B @ np.swapaxes(B, -1, -2)
    flat_A, flat_W = A.reshape(-1, *A.shape[-2:]), np.broadcast_to(W, A.shape).reshape(-1, *A.shape[-2:])
    P = np.empty(flat_A.shape)
    for i in range(len(flat_A)):
        size = np.ones(A.shape[-1])
        for _ in range(2):  # once more in units of each state's own size, so that small states keep their digits
            P[i] = solve_continuous_lyapunov(flat_A[i] * size / size[:, None], -flat_W[i] / np.outer(size, size))
            P[i] *= np.outer(size, size)
            found = np.sqrt(np.abs(np.diag(P[i])))
            size = np.where(found > 0.0, found, 1.0)
    return 0.5 * (P + np.swapaxes(P, -1, -2)).reshape(A.shape)


def discrete_psd(noise: DiscreteNoise, omega: ArrayLike) -> Array:
    """One-sided power spectral density of the samples, from the recursion itself.

    Parameters
    ----------
    noise : DiscreteNoise
        One recursion (no leading axes).
    omega : array_like, shape (n_w,)
        Angular frequency, up to pi/dt. [rad/s]

    Returns
    -------
    Phi : ndarray, shape (n_w, n_y)
        (dt/pi) C (zI - Ad)^-1 Qd (zI - Ad)^-H C^T, z = e^(i omega dt): its integral to pi/dt is the variance.
        [(unit)^2 s/rad]

    Raises
    ------
    ValueError
        If given a batch.

    References
    ----------
    A. V. Oppenheim and R. W. Schafer, Discrete-Time Signal Processing, 1989, chapter 2, noise through linear systems.

    Examples
    --------
    >>> names = dict(states=("x",), inputs=("n",), outputs=("y",))
    >>> lag = LinearSystem(A=[[-1.0]], B=[[2.0**0.5]], C=[[1.0]], D=[[0.0]], **names)
    >>> bool(abs(discrete_psd(discretise(lag, 1e-3), [0.0])[0, 0] - 2.0 / np.pi) < 1e-6)
    True
    """
    if noise.Ad.ndim != 2:
        raise ValueError(f"one recursion is wanted, got a batch of shape {noise.Ad.shape[:-2]}")
    z = np.exp(1j * np.asarray(omega, dtype=float) * noise.dt)[:, None, None]
    n = noise.Ad.shape[0]
    G = noise.C @ np.linalg.solve(z * np.eye(n) - noise.Ad, np.broadcast_to(noise.Ld, (z.size, n, n)))
    return noise.dt / np.pi * np.sum(np.abs(G) ** 2, axis=-1)


def folded_psd(psd: Callable[[Array], Array], omega: ArrayLike, dt: float, *, folds: int = 50) -> Array:
    """Spectrum of a sampled process: the continuous one folded at the sample rate.

    Parameters
    ----------
    psd : callable
        One-sided power spectral density of angular frequency [rad/s], even, falling faster than 1/omega.
    omega : array_like, shape (...)
        Angular frequency, 0 to pi/dt. [rad/s]
    dt : float
        Step, positive. [s]
    folds : int
        Folds that are summed on each side; the rest is the integral of the power law that the tail follows.

    Returns
    -------
    Phi : ndarray, shape (...)
        Sum over n of psd(|omega + 2 pi n/dt|). [as psd]

    Raises
    ------
    ValueError
        If the step is not positive or folds < 1.

    References
    ----------
    gusts.md section 7 (c); Poisson's summation formula.

    Examples
    --------
    >>> folded = folded_psd(lambda w: 2.0 / np.pi / (1.0 + w**2), 1.0, 0.5)
    >>> exact = 0.5 / np.pi * (1.0 - np.exp(-1.0)) / np.abs(np.exp(0.5j) - np.exp(-0.5)) ** 2
    >>> bool(abs(folded / exact - 1.0) < 1e-9)
    True
    """
    if not dt > 0.0 or folds < 1:
        raise ValueError(f"dt must be positive [s] and folds >= 1, got {dt:g} and {folds}")
    omega = np.asarray(omega, dtype=float)
    turn = 2.0 * np.pi / dt
    total = np.asarray(psd(omega), dtype=float)
    for n in range(1, folds + 1):
        total = total + psd(turn * n + omega) + psd(turn * n - omega)
    for side in (omega, -omega):  # midpoint rule for the rest: integral of a local power law from half a fold further
        x = side + turn * (folds + 0.5)
        value = psd(x)
        power = -np.log(psd(2.0 * x) / value) / np.log(2.0)
        total = total + value * (x / turn / (power - 1.0) - power * turn / x / 24.0)
    return total
