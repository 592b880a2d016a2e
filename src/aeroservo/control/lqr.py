"""Linear-quadratic regulators, continuous and sampled: Riccati equations solved, checked and, if need be, explained."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.control.design import Design, controls, feedback, square
from aeroservo.control.verify import explain_regulator, riccati_residual, stability_margin
from aeroservo.datatypes import Array, LinearSystem, frozen

EXACT = 1e-11
"""Relative residual above which a Riccati solution is refined by Newton's method. [-]"""

USABLE = 1e-7
"""Relative residual above which it is refused. [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class LQR:
    """Minimise the integral (continuous) or sum (sampled) of x'Q x + u'R u + 2 x'N u by u = -K x.

    The plant says which: a sampled plant (`plant.dt`) with its actuator and delay inside gives the sampled design.

    Attributes
    ----------
    Q : ndarray, shape (k,) or (k, k)
        State weights: a diagonal in the order of the plant's states, zeros following, or a matrix likewise. [1/state^2]
    R : ndarray, shape (m,) or (m, m)
        Input weights, positive. [1/input^2]
    N : ndarray, shape (n, m), optional
        Cross weights. [1/(state input)]
    measured : tuple of str, optional
        States that the controller reads; the others it simulates. Default: those that outputs of the same name show.
    """

    Q: Array
    R: Array
    N: Array | None = None
    measured: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        """Lock the weights."""
        for name in ("Q", "R", "N"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, frozen(np.atleast_1d(np.asarray(value, dtype=float)), name=name))

    def __call__(self, plant: LinearSystem) -> Design:
        """Design for a plant, or for each of a batch.

        Parameters
        ----------
        plant : LinearSystem
            Continuous or sampled; gust inputs are left alone. [SI]

        Returns
        -------
        design : Design
            Residual: of the Riccati equation. [SI]

        Raises
        ------
        ValueError
            If a weight does not fit, or no stabilising solution exists: which mode, and why.

        References
        ----------
        Bramstång 2015, Eq. 6.11 with u = -K x; B. D. O. Anderson and J. B. Moore, Optimal Control, 1990, section 3.

        Examples
        --------
        >>> from aeroservo.control.design import with_state_outputs
        >>> names = {"states": ("x", "v"), "inputs": ("u",), "outputs": ("x",)}
        >>> two = LinearSystem(A=[[0, 1], [0, 0]], B=[[0], [1]], C=[[1, 0]], D=[[0]], **names)
        >>> LQR(Q=[1.0, 1.0], R=[1.0])(with_state_outputs(two)).K.round(6).tolist()
        [[1.0, 1.732051]]
        """
        plant = controls(plant)
        Q, R = square(self.Q, plant.states, "Q"), square(self.R, plant.inputs, "R", definite=True)
        K, X = lqr_gain(
            plant.A, plant.B, Q, R, N=self.N, dt=plant.dt, states=plant.states, inputs=plant.inputs
        )  # fmt: skip
        residual = riccati_residual(plant.A, plant.B, Q, R, X, N=self.N, dt=plant.dt)
        return feedback(plant, K, method="lqr", residual=residual, measured=self.measured)


FULL_STATE = LQR(Q=np.array([0.0, 1.0 / math.radians(2.0) ** 2, 0.0, 1.0 / math.radians(60.0) ** 2]),
                 R=np.array([1.0 / math.radians(10.0) ** 2]))  # fmt: skip
"""Flutter suppression of a pitch-plunge model, by Bryson's rule: 2 deg of pitch and 60 deg/s of pitch rate are worth
10 deg of elevon; plunge is left to the springs, so that the design holds through the reversal of lift."""


def lqr_gain(
    A: ArrayLike, B: ArrayLike, Q: ArrayLike, R: ArrayLike, *, N: ArrayLike | None = None, dt: float | None = None,
    states: Sequence[str] | None = None, inputs: Sequence[str] | None = None,
) -> tuple[Array, Array]:  # fmt: skip
    """Gain of the linear-quadratic regulator, u = -K x, and the solution of its Riccati equation.

    Parameters
    ----------
    A, B : array_like, shapes (..., n, n), (..., n, m)
        Plants. [SI]
    Q, R : array_like, shapes (n, n), (m, m)
        Weights; R positive definite. [SI]
    N : array_like, shape (n, m), optional
        Cross weights. [SI]
    dt : float, optional
        Sample time of sampled plants; None is continuous. [s]
    states, inputs : sequence of str, optional
        Names, for errors.

    Returns
    -------
    K : ndarray, shape (..., m, n)
        Gain. [SI]
    X : ndarray, shape (..., n, n)
        Cost of a start x is x'X x. [SI]

    Raises
    ------
    ValueError
        If no stabilising solution exists or none is found to precision: which mode, and why.

    References
    ----------
    B. D. O. Anderson and J. B. Moore, Optimal Control, 1990, section 3; W. F. Arnold and A. J. Laub, Proc. IEEE 72(12),
    1984 (generalised eigenproblem); D. L. Kleinman, IEEE Trans. Autom. Control 13(1), 1968 (Newton's method).

    Examples
    --------
    >>> K, X = lqr_gain([[1.0]], [[1.0]], [[0.0]], [[1.0]])
    >>> round(float(K[0, 0]), 12)  # the least effort mirrors an unstable root
    2.0
    """
    A, B, Q, R = (np.asarray(x, dtype=float) for x in (A, B, Q, R))
    names = states or tuple(f"x{i + 1}" for i in range(A.shape[-1]))
    cross = None if N is None else np.asarray(N, dtype=float)
    batch = A.shape[:-2]
    n, m = B.shape[-2:]
    X, K = np.zeros((*batch, n, n)), np.zeros((*batch, m, n))
    for i in np.ndindex(*batch):
        try:
            X[i] = riccati(A[i], B[i], Q, R, N=cross, dt=dt)
        except (np.linalg.LinAlgError, ValueError) as error:
            why = explain_regulator(A[i], B[i], Q, names, dt=dt, inputs=inputs or ())
            where = f"{list(i)} of the batch: " if i else ""
            raise ValueError(f"{where}the regulator problem {why} ({error})") from None
        K[i] = gain(A[i], B[i], R, X[i], N=cross, dt=dt)
    return K, X


def gain(
    A: ArrayLike, B: ArrayLike, R: ArrayLike, X: ArrayLike, *, N: ArrayLike | None = None, dt: float | None = None
) -> Array:
    """K of a Riccati solution: R^-1 (B'X + N'), or (R + B'X B)^-1 (B'X A + N') of a sampled plant.

    Parameters
    ----------
    A, B, R, X : array_like, shapes (n, n), (n, m), (m, m), (n, n)
        Plant, input weights, solution. [SI]
    N : array_like, shape (n, m), optional
        Cross weights. [SI]
    dt : float, optional
        Sample time; None is continuous. [s]

    Returns
    -------
    K : ndarray, shape (m, n)
        u = -K x. [SI]

    References
    ----------
    B. D. O. Anderson and J. B. Moore, Optimal Control, 1990, Eqs. 3.1-14 and B-9.

    Examples
    --------
    >>> gain([[1.0]], [[1.0]], [[1.0]], [[2.0]]).tolist()
    [[2.0]]
    """
    A, B, R, X = (np.asarray(x, dtype=float) for x in (A, B, R, X))
    cross = 0.0 if N is None else np.asarray(N, dtype=float).T
    if dt is None:
        return np.asarray(np.linalg.solve(R, B.T @ X + cross))
    return np.asarray(np.linalg.solve(R + B.T @ X @ B, B.T @ X @ A + cross))


def riccati(A: Array, B: Array, Q: Array, R: Array, *, N: Array | None = None, dt: float | None = None) -> Array:
    """Stabilising solution of a Riccati equation, checked by its residual and its closed loop.

    Parameters
    ----------
    A, B, Q, R : ndarray, shapes (n, n), (n, m), (n, n), (m, m)
        One plant and its weights. [SI]
    N : ndarray, shape (n, m), optional
        Cross weights. [SI]
    dt : float, optional
        Sample time; None is the continuous equation. [s]

    Returns
    -------
    X : ndarray, shape (n, n)
        Symmetric. [SI]

    Raises
    ------
    ValueError
        If the residual is large or the closed loop not stable.

    References
    ----------
    W. F. Arnold and A. J. Laub, Proc. IEEE 72(12), 1984; D. L. Kleinman, IEEE Trans. Autom. Control 13(1), 1968;
    G. A. Hewer, IEEE Trans. Autom. Control 16(4), 1971.

    Examples
    --------
    >>> riccati(np.zeros((1, 1)), np.eye(1), 4.0 * np.eye(1), np.eye(1)).round(12).tolist()
    [[2.0]]
    """
    from scipy.linalg import solve_continuous_are, solve_discrete_are

    solve = solve_continuous_are if dt is None else solve_discrete_are
    X = np.asarray(solve(A, B, Q, R, s=N, balanced=True))
    X = 0.5 * (X + X.T)
    residual = float(riccati_residual(A, B, Q, R, X, N=N, dt=dt))
    for _ in range(3):
        if residual <= EXACT:
            break
        better = _newton(A, B, Q, R, X, N, dt)
        after = float(riccati_residual(A, B, Q, R, better, N=N, dt=dt)) if better is not None else math.inf
        if better is None or not after < residual:
            break
        X, residual = better, after
    if not residual <= USABLE:
        raise ValueError(f"relative residual of the Riccati equation {residual:.1e}")
    inside = float(stability_margin(A - B @ gain(A, B, R, X, N=N, dt=dt), dt))
    if not inside > 0.0:
        raise ValueError(f"closed loop on or beyond the border of stability by {-inside:.1e}")
    return X


def bryson_weights(
    largest_states: ArrayLike, largest_inputs: ArrayLike, *, settling_s: ArrayLike | None = None, rho: float = 1.0
) -> tuple[Array, Array]:
    """Diagonals Q and R by Bryson's rule: q_i = 1/(t_i x_i^2), r_i = rho/u_i^2.

    Parameters
    ----------
    largest_states : array_like, shape (k,)
        Largest acceptable magnitude of each state; infinite or 0 leaves it out. [unit of the state]
    largest_inputs : array_like, shape (m,)
        Largest acceptable magnitude of each input. [unit of the input]
    settling_s : array_like, shape (k,), optional
        Desired settling time of each state; default 1 s, which is Bryson's own rule. [s]
    rho : float
        Price of control against that of motion. [-]

    Returns
    -------
    Q, R : ndarray, shapes (k,), (m,)
        Diagonals. [1/state^2, 1/input^2]

    Raises
    ------
    ValueError
        If an input, a time or rho is not positive.

    References
    ----------
    Bramstång 2015, Eq. 6.11; A. E. Bryson and Y.-C. Ho, Applied Optimal Control, 1975, section 5.2.

    Examples
    --------
    >>> [w.tolist() for w in bryson_weights([0.0, 0.5], [0.1], rho=2.0)]
    [[0.0, 4.0], [199.99999999999997]]
    """
    x, u = np.abs(np.asarray(largest_states, dtype=float)), np.asarray(largest_inputs, dtype=float)
    t = np.ones(x.shape) if settling_s is None else np.asarray(settling_s, dtype=float)
    if np.any(u <= 0.0) or np.any(t <= 0.0) or not rho > 0.0 or t.shape != x.shape:
        raise ValueError("largest inputs, settling times [s] (one for each state) and rho [-] must be positive")
    used = np.isfinite(x) & (x > 0.0)
    return np.where(used, 1.0 / (t * np.where(used, x, 1.0) ** 2), 0.0), rho / u**2


def _newton(A: Array, B: Array, Q: Array, R: Array, X: Array, N: Array | None, dt: float | None) -> Array | None:
    """One step of Kleinman (Hewer): the Lyapunov equation of the present gain; None where that does not stabilise."""
    from scipy.linalg import solve_continuous_lyapunov, solve_discrete_lyapunov

    K = gain(A, B, R, X, N=N, dt=dt)
    closed = A - B @ K
    if not float(stability_margin(closed, dt)) > 0.0:
        return None
    cross = np.zeros_like(Q) if N is None else N @ K
    cost = Q + K.T @ R @ K - cross - cross.T
    if dt is None:
        better = solve_continuous_lyapunov(closed.T, -cost)
    else:
        better = solve_discrete_lyapunov(closed.T, cost)
    return np.asarray(0.5 * (better + better.T))
