"""Independent checks of a synthesis, and answers to one that has no solution: which mode, and why.

No solver is taken at its word: Riccati solutions are put back into their equation, closed loops are formed and their
roots computed. Where a problem has no solution, the Popov-Belevitch-Hautus (PBH) test names the mode that the inputs do
not reach or the outputs do not show, and the states in which it lives.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.datatypes import Array

HIDDEN = 1e-9
"""A mode whose PBH measure is below this is out of reach, or out of sight. [-]"""

WEAK = 1e-5
"""Below this it is named where a problem turns out ill-conditioned. [-]"""

FAR_APART = 6.0
"""Decades between the sizes of states above which they are blamed. [-]"""

BORDER = 1e-8
"""Roots this close to the border of stability, part of the largest root, are on it. [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Mode:
    """One mode of a system under the PBH test.

    Attributes
    ----------
    eigenvalue : complex
        Its root: s, or z of a sampled system. [1/s or -]
    measure : float
        Smallest singular value of [A - lambda I, B] in balanced states over the norm of A: 0 is hidden. [-]
    states : tuple of str
        States that take part most, largest first.
    """

    eigenvalue: complex
    measure: float
    states: tuple[str, ...]

    def __str__(self) -> str:
        """In words."""
        value = self.eigenvalue
        shown = f"{value.real:.4g}" if abs(value.imag) < 1e-9 * max(1.0, abs(value)) else f"{value:.4g}"
        return f"mode {shown} (in {', '.join(self.states)}; PBH measure {self.measure:.1e})"


def riccati_residual(
    A: ArrayLike, B: ArrayLike, Q: ArrayLike, R: ArrayLike, X: ArrayLike, *, N: ArrayLike | None = None,
    dt: float | None = None,
) -> Array:  # fmt: skip
    """How far X is from solving its Riccati equation, relative to the terms of the equation.

    Parameters
    ----------
    A, B, Q, R : array_like, shapes (..., n, n), (..., n, m), (..., n, n), (..., m, m)
        Plant and weights. [SI]
    X : array_like, shape (..., n, n)
        Claimed solution. [SI]
    N : array_like, shape (..., n, m), optional
        Cross weights. [SI]
    dt : float, optional
        Sample time; None is the continuous equation. [s]

    Returns
    -------
    residual : ndarray, shape (...)
        Frobenius norm of the equation over the sum of the norms of its terms. [-]

    References
    ----------
    B. D. O. Anderson and J. B. Moore, Optimal Control, 1990, Eq. 3.1-13 (continuous) and appendix B (discrete).

    Examples
    --------
    >>> float(riccati_residual([[0.0]], [[1.0]], [[4.0]], [[1.0]], [[2.0]]))
    0.0
    """
    A, B, Q, R, X = (np.asarray(x, dtype=float) for x in (A, B, Q, R, X))
    N = np.zeros(B.shape) if N is None else np.asarray(N, dtype=float)
    At, Bt, Nt = (np.swapaxes(x, -1, -2) for x in (A, B, N))
    if dt is None:
        drive = X @ B + N
        terms = [At @ X, X @ A, Q, -drive @ np.linalg.solve(R, np.swapaxes(drive, -1, -2))]
    else:
        drive = At @ X @ B + N
        terms = [At @ X @ A, -X, Q, -drive @ np.linalg.solve(R + Bt @ X @ B, Bt @ X @ A + Nt)]
    norms = sum(np.linalg.norm(term, axis=(-2, -1)) for term in terms)
    return np.asarray(np.linalg.norm(sum(terms), axis=(-2, -1)) / np.where(norms > 0.0, norms, 1.0))


def stability_margin(A: ArrayLike, dt: float | None = None) -> Array:
    """Distance of the roots of A from the border of stability, positive inside.

    Parameters
    ----------
    A : array_like, shape (..., n, n)
        State matrix. [SI]
    dt : float, optional
        Sample time; None is continuous. [s]

    Returns
    -------
    margin : ndarray, shape (...)
        -max Re(s), or 1 - max |z|; infinite without states. [1/s or -]

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 1997, section 3.3.

    Examples
    --------
    >>> float(stability_margin([[-2.0]])), float(stability_margin([[0.5]], 0.1))
    (2.0, 0.5)
    """
    values = np.linalg.eigvals(np.asarray(A, dtype=float))
    if values.shape[-1] == 0:
        return np.full(values.shape[:-1], math.inf)
    return np.asarray(-values.real.max(axis=-1) if dt is None else 1.0 - np.abs(values).max(axis=-1))


def modes_out_of_reach(
    A: ArrayLike, B: ArrayLike, states: Sequence[str], *, dt: float | None = None, below: float = HIDDEN,
    border_only: bool = False,
) -> list[Mode]:  # fmt: skip
    """Unstable or undamped modes that the inputs do not reach: why a system cannot be stabilised.

    Parameters
    ----------
    A, B : array_like, shapes (n, n), (n, m)
        One system. [SI]
    states : sequence of str, length n
        Names.
    dt : float, optional
        Sample time; None is continuous. [s]
    below : float
        PBH measure under which a mode counts. [-]
    border_only : bool
        Test the modes on the border of stability only, not those beyond it.

    Returns
    -------
    modes : list of Mode
        Weakest first; empty where all can be reached.

    References
    ----------
    M. L. J. Hautus, "Controllability and observability conditions of linear autonomous systems", Indagationes
    Mathematicae 31, 1969; T. Kailath, Linear Systems, 1980, section 2.4.3 (PBH tests).

    Examples
    --------
    >>> modes_out_of_reach([[1.0, 0.0], [0.0, -1.0]], [[0.0], [1.0]], ("fast", "slow"))[0].states
    ('fast',)
    """
    return _weak(np.asarray(A, float), np.asarray(B, float), states, dt, below, border_only, dual=False)


def modes_out_of_sight(
    A: ArrayLike, C: ArrayLike, states: Sequence[str], *, dt: float | None = None, below: float = HIDDEN,
    border_only: bool = False,
) -> list[Mode]:  # fmt: skip
    """Unstable or undamped modes that the outputs do not show: why a system cannot be observed.

    Parameters
    ----------
    A, C : array_like, shapes (n, n), (p, n)
        One system. [SI]
    states : sequence of str, length n
        Names.
    dt : float, optional
        Sample time; None is continuous. [s]
    below : float
        PBH measure under which a mode counts. [-]
    border_only : bool
        Test the modes on the border of stability only, not those beyond it.

    Returns
    -------
    modes : list of Mode
        Weakest first; empty where all can be seen.

    References
    ----------
    T. Kailath, Linear Systems, 1980, section 2.4.3 (PBH tests).

    Examples
    --------
    An integrator is invisible in its own rate of change:

    >>> modes_out_of_sight([[0.0, 1.0], [0.0, -1.0]], [[0.0, 1.0]], ("position", "rate"))[0].states
    ('position',)
    """
    A, C = np.asarray(A, float), np.asarray(C, float)
    return _weak(A.T, C.T, states, dt, below, border_only, dual=True)


def explain_regulator(
    A: Array, B: Array, Q: Array, states: Sequence[str], *, dt: float | None = None, inputs: Sequence[str] = ()
) -> str:
    """Why a regulator problem has no usable solution, in words.

    Parameters
    ----------
    A, B, Q : ndarray, shapes (n, n), (n, m), (n, n)
        One plant and its state weights. [SI]
    states : sequence of str, length n
        Names.
    dt : float, optional
        Sample time; None is continuous. [s]
    inputs : sequence of str
        Names of the inputs.

    Returns
    -------
    reason : str
        Modes and states.

    References
    ----------
    B. D. O. Anderson and J. B. Moore, Optimal Control, 1990, section 3.2 (stabilisability, detectability).

    Examples
    --------
    >>> explain_regulator(np.eye(1), np.zeros((1, 1)), np.eye(1), ("x",), inputs=("elevon_rad",))[:53]
    'cannot be stabilised by elevon_rad: mode 1 (in x; PBH'
    """
    by = ", ".join(inputs) or "the inputs"
    found = modes_out_of_reach(A, B, states, dt=dt)
    if found:
        return f"cannot be stabilised by {by}: {_list(found)} is out of reach"
    found = modes_out_of_sight(A, _root(Q), states, dt=dt, border_only=True)
    if found:
        return (
            f"has no stabilising optimum: {_list(found)} is on the border of stability and does not show in the state "
            "weights; give its states a weight"
        )
    weak = modes_out_of_reach(A, B, states, dt=dt, below=WEAK)
    weak += modes_out_of_sight(A, _root(Q), states, dt=dt, below=WEAK, border_only=True)
    return _ill(A, Q, weak, states, f"hardly reached by {by}, or hardly weighed")


def explain_filter(
    A: Array, C: Array, W: Array, states: Sequence[str], *, dt: float | None = None, outputs: Sequence[str] = ()
) -> str:
    """Why a Kalman filter has no usable solution, in words.

    Parameters
    ----------
    A, C, W : ndarray, shapes (n, n), (p, n), (n, n)
        One plant and the covariance of its noise. [SI]
    states : sequence of str, length n
        Names.
    dt : float, optional
        Sample time; None is continuous. [s]
    outputs : sequence of str
        Names of the sensors.

    Returns
    -------
    reason : str
        Modes and states.

    References
    ----------
    B. D. O. Anderson and J. B. Moore, Optimal Filtering, 1979, section 4.4.

    Examples
    --------
    >>> explain_filter(np.eye(1), np.zeros((1, 1)), np.eye(1), ("x",), outputs=("gyro",))[:46]
    'cannot be observed by gyro: mode 1 (in x; PBH '
    """
    by = ", ".join(outputs) or "the outputs"
    found = modes_out_of_sight(A, C, states, dt=dt)
    if found:
        return f"cannot be observed by {by}: {_list(found)} is out of sight"
    found = modes_out_of_reach(A, _root(W), states, dt=dt, border_only=True)
    if found:
        return (
            f"has no stable filter: {_list(found)} is on the border of stability and no noise reaches it; add noise "
            "(gust, W, recovery)"
        )
    weak = modes_out_of_sight(A, C, states, dt=dt, below=WEAK)
    weak += modes_out_of_reach(A, _root(W), states, dt=dt, below=WEAK, border_only=True)
    return _ill(A, W, weak, states, f"hardly seen by {by}, or hardly driven")


def _weak(
    A: Array, B: Array, states: Sequence[str], dt: float | None, below: float, border_only: bool, *, dual: bool
) -> list[Mode]:
    """PBH test of the modes on or beyond the border of stability, in balanced states."""
    from scipy.linalg import matrix_balance

    n = len(A)
    if not n:
        return []
    balanced, (scale, _) = matrix_balance(A, permute=False, separate=True)
    reach = B / scale[:, None]
    size = np.linalg.norm(balanced, 2) or 1.0
    largest = np.linalg.norm(reach, 2)
    reach = reach * (size / largest) if largest > 0.0 else reach
    values, vectors = np.linalg.eig(balanced.T if dual else balanced)
    border = 0.0 if dt is None else 1.0
    where = values.real if dt is None else np.abs(values)
    edge = BORDER * np.abs(values).max(initial=1.0)
    tested = np.abs(where - border) <= edge if border_only else where >= border - edge
    found = []
    for i in np.flatnonzero(tested & (values.imag >= 0.0)):
        pencil = np.concatenate([balanced - values[i] * np.eye(n), reach], axis=1)
        measure = float(np.linalg.svd(pencil, compute_uv=False)[-1] / size)
        if measure < below:
            part = np.abs(vectors[:, i])
            order = [j for j in np.argsort(-part, kind="stable") if part[j] > 0.3 * part.max()][:3]
            found.append(Mode(eigenvalue=complex(values[i]), measure=measure, states=tuple(states[j] for j in order)))
    return sorted(found, key=lambda mode: mode.measure)


def _root(Q: Array) -> Array:
    """A matrix H with H' H = Q, rows of no size left in."""
    value, vector = np.linalg.eigh(0.5 * (Q + Q.T))
    return np.asarray(np.sqrt(np.maximum(value, 0.0))[:, None] * vector.T)


def _list(modes: list[Mode]) -> str:
    """Modes in words."""
    return " and ".join(str(mode) for mode in modes)


def _ill(A: Array, weight: Array, weak: list[Mode], states: Sequence[str], how: str) -> str:
    """Words for a problem that has a solution which numbers of this precision do not give."""
    from scipy.linalg import matrix_balance

    if weak:
        return f"is ill-conditioned: {_list(weak)} is {how}"
    scale = matrix_balance(A, permute=False, separate=True)[1][0]
    decades = float(np.ptp(np.log10(scale)))
    if decades >= FAR_APART:
        low, high = states[int(np.argmin(scale))], states[int(np.argmax(scale))]
        return f"is ill-conditioned: states differ in size by {decades:.0f} decades ({low} to {high}); scale them"
    largest = int(np.argmax(np.diag(weight)))
    return (
        f"is ill-conditioned: the weights are too far apart (that of {states[largest]} is "
        f"{weight[largest, largest]:.3g} against those of inputs or sensors); bring them closer"
    )
