"""LQR with integrals of outputs, and the rank test that says how many integrals a plant can hold.

An integral of an output adds a root at s = 0 (z = 1), which the controls must be able to move: the plant must have no
transmission zero there, and there can be no more integrals than controls. The thesis integrates plunge and pitch with
one elevon: one combination of the two integrals is beyond any controller. Leaky integrals, x' = y - leak x, have no
root at the border and always work; they hold a steady error down instead of removing it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from aeroservo.control.design import Design, controls, feedback, joined, square
from aeroservo.control.lqr import lqr_gain
from aeroservo.control.verify import HIDDEN, riccati_residual
from aeroservo.datatypes import Array, LinearSystem, frozen


@dataclass(frozen=True, kw_only=True, eq=False)
class LQI:
    """LQR on the plant with integrals of outputs: u = -K x - K_i x_i, x_i' = y - leak x_i.

    Attributes
    ----------
    Q : ndarray, shape (k,) or (k, k)
        Weights of the plant's states, as of `LQR`. [1/state^2]
    R : ndarray, shape (m,) or (m, m)
        Input weights, positive. [1/input^2]
    integrals : tuple of str
        Outputs that are integrated.
    Q_integrals : ndarray, shape (n_i,)
        Weights of the integrals, positive. [1/(output s)^2]
    leak : float
        Rate at which the integrals forget; 0 is a true integral. [1/s]
    tracking_s : float
        Time in which the integrals follow a clipped command (anti-windup). [s]
    measured : tuple of str, optional
        States that the controller reads, as of `LQR`.
    """

    Q: Array
    R: Array
    integrals: tuple[str, ...]
    Q_integrals: Array
    leak: float = 0.0
    tracking_s: float = 0.1
    measured: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        """Lock the weights and check the options."""
        for name in ("Q", "R", "Q_integrals"):
            value = np.atleast_1d(np.asarray(getattr(self, name), dtype=float))
            object.__setattr__(self, name, frozen(value, name=name))
        if not self.integrals:
            raise ValueError("integrals must name at least one output")
        if self.Q_integrals.shape != (len(self.integrals),) or np.any(self.Q_integrals <= 0.0):
            raise ValueError(f"Q_integrals must be {len(self.integrals)} positive numbers, got {self.Q_integrals}")
        if not 0.0 <= self.leak < math.inf:
            raise ValueError(f"leak must not be negative [1/s], got {self.leak}")
        if not 0.0 < self.tracking_s < math.inf:
            raise ValueError(f"tracking_s must be positive [s], got {self.tracking_s}")

    def __call__(self, plant: LinearSystem) -> Design:
        """Design for a plant, or for each of a batch.

        Parameters
        ----------
        plant : LinearSystem
            Continuous or sampled; gust inputs are left alone. [SI]

        Returns
        -------
        design : Design
            K over the plant's states and `integral_of_...`; residual of the Riccati equation. [SI]

        Raises
        ------
        ValueError
            If the integrals fail the rank test (with the reason, and leaky integrals offered), an output is unknown, a
            weight does not fit, or no stabilising solution exists.

        References
        ----------
        Bramstång 2015, Eq. 7.69; E. J. Davison, IEEE Trans. Autom. Control 21(1), 1976 (when integrals exist).

        Examples
        --------
        >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("x",)}
        >>> lag = LinearSystem(A=[[-1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
        >>> LQI(Q=[0.0], R=[1.0], integrals=("x",), Q_integrals=[1.0])(lag).K.round(6).tolist()
        [[0.732051, 1.0]]
        """
        plant = controls(plant)
        held = held_integrals(plant, self.integrals, leak=self.leak)
        if self.leak == 0.0:
            _check_rank(plant, held, self.integrals)
        n, n_i = len(plant.states), len(self.integrals)
        Q = np.zeros((n + n_i, n + n_i))
        Q[:n, :n] = square(self.Q, plant.states, "Q")
        Q[n:, n:] = np.diag(self.Q_integrals)
        R = square(self.R, plant.inputs, "R", definite=True)
        names = {"states": held.states, "inputs": held.inputs}
        K, X = lqr_gain(held.A, held.B, Q, R, dt=held.dt, **names)
        residual = riccati_residual(held.A, held.B, Q, R, X, dt=held.dt)
        design = feedback(plant, K[..., :n], method="lqi", residual=residual, measured=self.measured)
        return _with_integrals(plant, held, K, design, self)


def held_integrals(plant: LinearSystem, integrals: Sequence[str], *, leak: float = 0.0) -> LinearSystem:
    """The plant with integrals of outputs as states, x_i' = y - leak x_i (sampled: exact for an output that is held).

    Parameters
    ----------
    plant : LinearSystem
        Any batch. [SI]
    integrals : sequence of str
        Outputs that are integrated.
    leak : float
        Rate at which the integrals forget. [1/s]

    Returns
    -------
    plant : LinearSystem
        States of the plant, then `integral_of_<output>`, which are outputs too. [SI]

    Raises
    ------
    ValueError
        If an output does not exist.

    References
    ----------
    Bramstång 2015, Eq. 7.69; equations.md, "Control" (the appendix' leaky integral of pitch).

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> lag = LinearSystem(A=[[-1.0]], B=[[1.0]], C=[[3.0]], D=[[0.0]], **names)
    >>> held_integrals(lag, ["y"], leak=0.5).A.tolist()
    [[-1.0, 0.0], [3.0, -0.5]]
    """
    rows = []
    for name in integrals:
        if name not in plant.outputs:
            raise ValueError(f"integral of {name!r}: no such output; there are {', '.join(plant.outputs)}")
        rows.append(plant.outputs.index(name))
    n, n_i, n_u, batch = len(plant.states), len(rows), len(plant.inputs), plant.A.shape[:-2]
    keep, gain = _integrator(plant.dt, leak)
    A, B = np.zeros((*batch, n + n_i, n + n_i)), np.zeros((*batch, n + n_i, n_u))
    A[..., :n, :n], B[..., :n, :] = plant.A, plant.B
    A[..., n:, :n], A[..., n:, n:] = gain * plant.C[..., rows, :], keep * np.eye(n_i)
    B[..., n:, :] = gain * plant.D[..., rows, :]
    n_y = len(plant.outputs)
    C = np.zeros((*batch, n_y + n_i, n + n_i))
    C[..., :n_y, :n], C[..., n_y:, n:] = plant.C, np.eye(n_i)
    names = tuple(f"integral_of_{name}" for name in integrals)
    return replace(
        plant, A=A, B=B, C=C, D=np.concatenate([plant.D, np.zeros((*batch, n_i, n_u))], axis=-2),
        states=(*plant.states, *names), outputs=(*plant.outputs, *names),
    )  # fmt: skip


def _integrator(dt: float | None, leak: float) -> tuple[float, float]:
    """Own coefficient and gain of an integral: x' = keep x + gain y, or x[k+1]."""
    if dt is None:
        return -leak, 1.0
    return math.exp(-leak * dt), dt if leak == 0.0 else -math.expm1(-leak * dt) / leak


def _check_rank(plant: LinearSystem, held: LinearSystem, integrals: Sequence[str]) -> None:
    """PBH test at s = 0 (z = 1) with true integrals; refused with the reason."""
    point, n = (0.0 if plant.dt is None else 1.0), len(held.states)
    batch = plant.A.shape[:-2]
    for i in np.ndindex(*batch):
        pencil = np.concatenate([held.A[i] - point * np.eye(n), held.B[i]], axis=1)
        size = np.linalg.norm(pencil, axis=1, keepdims=True)  # rows and columns of one size: units do not matter
        pencil = pencil / np.where(size > 0.0, size, 1.0)
        width = np.linalg.norm(pencil, axis=0)
        values = np.linalg.svd(pencil / np.where(width > 0.0, width, 1.0), compute_uv=False)
        rank = int(np.sum(values > HIDDEN * values[0]))
        if rank == n:
            continue
        many = len(integrals) > len(plant.inputs)
        why = (
            f"{len(integrals)} integrals cannot all be driven to zero by {len(plant.inputs)} control(s)"
            if many
            else "an integrated output has a transmission zero there: no steady command moves it"
        )
        raise ValueError(
            f"integrals of {', '.join(integrals)} fail the rank test: rank [A - {point:g} I, B] is {rank} of {n} at "
            f"{'s = 0' if plant.dt is None else 'z = 1'}: {why}. Integrate fewer, or take leaky integrals (leak > 0)"
        )


def _with_integrals(plant: LinearSystem, held: LinearSystem, K: Array, design: Design, options: LQI) -> Design:
    """The controller of the plant's states with the integrals beside its own states."""
    c, n, n_i = design.controller, len(plant.states), len(options.integrals)
    Ki, batch = K[..., n:], plant.A.shape[:-2]
    inputs = (*c.inputs, *(name for name in options.integrals if name not in c.inputs))
    n_c, n_in = len(c.states), len(inputs)
    keep, gain = _integrator(plant.dt, options.leak)
    A, B = np.zeros((*batch, n_c + n_i, n_c + n_i)), np.zeros((*batch, n_c + n_i, n_in))
    A[..., :n_c, :n_c], A[..., n_c:, n_c:] = c.A, keep * np.eye(n_i)
    A[..., :n_c, n_c:] = -design.windup @ Ki  # the simulated states hear the whole command
    B[..., :n_c, : len(c.inputs)] = c.B
    for row, name in enumerate(options.integrals):
        B[..., n_c + row, inputs.index(name)] = gain
    D = np.concatenate([c.D, np.zeros((*batch, len(plant.inputs), n_in - len(c.inputs)))], axis=-1)
    controller = LinearSystem(
        A=A, B=B, C=np.concatenate([c.C, -Ki], axis=-1), D=D,
        states=(*c.states, *(f"integral_of_{name}" for name in options.integrals)), inputs=inputs, outputs=c.outputs,
        dt=c.dt,
    )  # fmt: skip
    share = 1.0 if plant.dt is None else min(1.0, plant.dt / options.tracking_s)
    windup = np.concatenate([design.windup, -share * np.linalg.pinv(Ki)], axis=-2)
    notes = design.notes
    if options.leak:
        slow = f"{1.0 / options.leak:.3g} s"
        notes = (*notes, f"leaky integrals forget in {slow}: steady errors are held down, not removed")
    return replace(
        design, controller=controller, K=K, states=held.states, windup=windup, notes=notes,
        closed_loop_eigenvalues=np.linalg.eigvals(joined(plant, controller)),
    )  # fmt: skip
