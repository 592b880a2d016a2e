"""The linear model of the thesis' appendix: its roots, its gain, what is misprinted in it and what is hidden in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from aeroservo.aircraft.files import read
from aeroservo.control.lqr import LQR
from aeroservo.control.plant import chosen
from aeroservo.datatypes import Array, LinearSystem

GAIN = np.array([[8.6714, 3.4228, 18.1660, 0.1854, 2.5293]])
"""K of appendix .9; delta = -K x. [SI]"""
PRINTED_CLOSED = np.array(
    [
        [-1.0, 0.0, -1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0],
        [70.7138, -217.7978, -616.9943, -27.5706, -34.5308],
        [14.7525, 8.0503, 16.9407, 0.1127, -7.1042],
    ]
)
"""A - B K of appendix .8. [SI]"""
DIGIT = 5e-5
"""Rounding of the printed numbers. [SI]"""
SETTLED = 0.02
"""Band about rest that counts as settled, of the largest deflection. [-]"""
LENGTH, POINTS = 20.0, 2001


@dataclass(frozen=True, kw_only=True, eq=False)
class Appendix:
    """The appendix' model computed again.

    Attributes
    ----------
    open_roots, misprinted_roots, bare_roots, closed_roots : complex ndarray, shapes (5,), (5,), (4,), (5,)
        Of A put right, of A as printed, of A without the pitch-lag loop, of A - B K. [1/s]
    ratio : float
        Of the first columns of A and B: the gain of the loop hidden in A. [-]
    K : ndarray, shape (1, 5)
        Our LQR gain for Q = I, R = 1. [SI]
    gain_error : float
        Its largest relative difference from the printed one. [-]
    closed_error : float
        Largest difference of A - B K from the printed matrix, in units of what rounding allows. [-]
    t : ndarray, shape (n,)
        Times. [s]
    free : ndarray, shape (n, 5)
        States without control, from a pitch of 1 degree. [SI]
    held : ndarray, shape (n, 5)
        States with control, from the same start. [SI]
    step : ndarray, shape (n, 5)
        States with control after a unit step of the elevon command. [SI]
    settling : float
        Time after which plunge stays within 2 % of its largest value, with control. [s]
    least_return : float
        Smallest |1 + K (i omega - A)^-1 B| of our gain. [-]
    integrals : tuple of int
        Rank of the plant with integrals of plunge and pitch at s = 0, and what it would have to be. [-]
    """

    open_roots: Array
    misprinted_roots: Array
    bare_roots: Array
    closed_roots: Array
    ratio: float
    K: Array
    gain_error: float
    closed_error: float
    t: Array
    free: Array
    held: Array
    step: Array
    settling: float
    least_return: float
    integrals: tuple[int, int]

    @property
    def least_damped(self) -> tuple[complex, complex, complex]:
        """Rightmost root, upper half plane, of A, of A - B K, of A without its hidden loop. [1/s]"""
        found = [max(r, key=lambda s: (s.real, s.imag)) for r in (self.open_roots, self.closed_roots, self.bare_roots)]
        return complex(found[0]), complex(found[1]), complex(found[2])


def appendix_system() -> LinearSystem:
    """The preset `thesis-appendix` as a linear system.

    Returns
    -------
    system : LinearSystem
        Five states, elevon to six outputs. [SI]

    References
    ----------
    Bramstång 2015, appendix .4 to .7, its misprint put right.
    """
    file: Any = read("thesis-appendix")
    m = file.model
    return LinearSystem(A=m.A, B=m.B, C=m.C, D=m.D, states=m.states, inputs=m.inputs, outputs=m.outputs)


def thesis_appendix() -> Appendix:
    """Everything about the appendix' model.

    Returns
    -------
    appendix : Appendix
        Roots, gain, responses.

    References
    ----------
    Bramstång 2015, sections 9.4.1, 9.4.2, appendix .4 to .9, Eqs. 6.9, 6.11, 7.69.
    """
    system = appendix_system()
    A, B = system.A, system.B
    misprinted = A.copy()
    misprinted[0, 2] = 1.0
    closed = A - B @ GAIN
    K = LQR(Q=np.ones(5), R=[1.0])(chosen(_with_states(system), outputs=system.states)).K  # type: ignore[arg-type]
    t = np.linspace(0.0, LENGTH, POINTS)
    start = np.array([0.0, 0.0, np.radians(1.0), 0.0, 0.0])
    held = free_response(closed, start, t)
    plunge = np.abs(held[:, 1])
    omega = np.geomspace(1e-2, 1e4, 4000)
    loop = np.array([(K @ np.linalg.solve(1j * w * np.eye(5) - A, B))[0, 0] for w in omega])
    return Appendix(
        open_roots=np.linalg.eigvals(A),
        misprinted_roots=np.linalg.eigvals(misprinted),
        bare_roots=np.linalg.eigvals(A[1:, 1:]),
        closed_roots=np.linalg.eigvals(closed),
        ratio=float(np.mean(A[3:, 0] / B[3:, 0])),
        K=K,
        gain_error=float(np.max(np.abs(K - GAIN) / np.abs(GAIN))),
        closed_error=float(np.max(np.abs(closed - PRINTED_CLOSED) / (DIGIT * (2.0 + np.abs(B) + np.abs(GAIN))))),
        t=t,
        free=free_response(A, start, t),
        held=held,
        step=step_response(closed, B[:, 0], t),
        settling=float(t[np.flatnonzero(plunge > SETTLED * plunge.max())[-1]]),
        least_return=float(np.abs(1.0 + loop).min()),
        integrals=integral_rank(A[1:, 1:], B[1:], np.eye(4)[:2]),
    )


def _with_states(system: LinearSystem) -> LinearSystem:
    """The same plant with its states as outputs."""
    n = len(system.states)
    return LinearSystem(
        A=system.A, B=system.B, C=np.eye(n), D=np.zeros((n, 1)), states=system.states, inputs=system.inputs,
        outputs=system.states,
    )  # fmt: skip


def free_response(A: Array, start: Array, t: Array) -> Array:
    """Motion from a start, exactly, at evenly spaced times.

    Parameters
    ----------
    A : ndarray, shape (n, n)
        State matrix. [SI]
    start : ndarray, shape (n,)
        State at t = 0. [SI]
    t : ndarray, shape (m,)
        Times, evenly spaced from 0. [s]

    Returns
    -------
    x : ndarray, shape (m, n)
        States. [SI]
    """
    from scipy.linalg import expm

    step = expm(A * (t[1] - t[0]))
    x = np.empty((len(t), len(start)))
    x[0] = start
    for i in range(1, len(t)):
        x[i] = step @ x[i - 1]
    return x


def step_response(A: Array, b: Array, t: Array) -> Array:
    """Motion from rest after a unit step of one input, exactly.

    Parameters
    ----------
    A : ndarray, shape (n, n)
        State matrix. [SI]
    b : ndarray, shape (n,)
        Input column. [SI]
    t : ndarray, shape (m,)
        Times, evenly spaced from 0. [s]

    Returns
    -------
    x : ndarray, shape (m, n)
        States. [SI]
    """
    n = len(b)
    big = np.zeros((n + 1, n + 1))
    big[:n, :n], big[:n, n] = A, b
    return free_response(big, np.append(np.zeros(n), 1.0), t)[:, :n]


def integral_rank(A: Array, B: Array, C: Array) -> tuple[int, int]:
    """Whether integrals of outputs can be moved: rank of [A B; C 0], and the rank that it needs.

    Parameters
    ----------
    A, B : ndarray, shapes (n, n), (n, m)
        Plant. [SI]
    C : ndarray, shape (p, n)
        What is integrated. [SI]

    Returns
    -------
    rank, needed : tuple of int
        As many independent integrals as there are inputs, at most.

    References
    ----------
    E. J. Davison and H. W. Smith, Automatica 7(4), 1971, theorem 1; Bramstång 2015, Eq. 7.69.
    """
    n, p = len(A), len(C)
    big = np.block([[A, B], [C, np.zeros((p, B.shape[1]))]])
    return int(np.linalg.matrix_rank(big / np.abs(big).max(axis=1, keepdims=True), tol=1e-9)), n + p
