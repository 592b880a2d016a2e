"""What a synthesis returns, and how a state-feedback gain becomes a controller that reads what is measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.control.closed_loop import closed_loop
from aeroservo.control.controller import Controller
from aeroservo.control.plant import chosen
from aeroservo.control.verify import stability_margin
from aeroservo.datatypes import Array, LinearSystem, frozen

UNIT = 1e-12
"""An output row this close to a unit row shows its state. [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Design:
    """A synthesised controller, with what it was checked by.

    Attributes
    ----------
    method : str
        "lqr", "lqi", "lqg", "pid" or "poles".
    controller : LinearSystem
        Reads measured channels, its outputs are added to the plant's inputs; batched as the plant. Delays are the
        plant's: `input_delay_s` is 0. [SI]
    K : ndarray, shape (..., n_u, n)
        State-feedback gain, u = -K x; no columns where the method has none. [SI]
    states : tuple of str
        The x of K.
    closed_loop_eigenvalues : complex ndarray, shape (..., n_cl)
        Of plant and controller joined; s, or z of a sampled loop. [1/s or -]
    residual : ndarray, shape (...)
        Largest relative residual of what was solved, recomputed independently (see each method). [-]
    windup : ndarray, shape (..., n_c, n_u)
        What the controller's states hear of a clipped command. [SI]
    notes : tuple of str
        What to know before trusting it.
    """

    method: str
    controller: LinearSystem
    K: Array
    states: tuple[str, ...]
    closed_loop_eigenvalues: Array
    residual: Array
    windup: Array
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Lock the arrays."""
        for name in ("K", "residual", "windup"):
            object.__setattr__(self, name, frozen(getattr(self, name), name=name))
        object.__setattr__(
            self, "closed_loop_eigenvalues", frozen(self.closed_loop_eigenvalues, dtype=complex, name="eigenvalues")
        )

    def as_controller(
        self, *, delay_s: float = 0.0, limits: tuple[float, ...] = (), pressures: ArrayLike | None = None
    ) -> Controller:
        """The controller as files and simulations take it.

        Parameters
        ----------
        delay_s : float
            Computing delay that the design plant had inside. [s]
        limits : tuple of float
            Largest magnitude of each output. [unit of the output]
        pressures : array_like, shape (p,), optional
            Dynamic pressures of a batch, ascending. [Pa]

        Returns
        -------
        controller : Controller
            With windup where it is sampled. [SI]

        Raises
        ------
        ValueError
            If a batch comes without its pressures, or the other way round.

        References
        ----------
        contract.md, "Controller file (JSON)".

        Examples
        --------
        >>> from aeroservo.control.lqr import LQR
        >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("x",)}
        >>> plant = LinearSystem(A=[[1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], dt=0.1, **names)
        >>> LQR(Q=[1.0], R=[1.0])(plant).as_controller(limits=(0.3,)).limits
        (0.3,)
        """
        c = self.controller
        if (c.A.ndim == 3) != (pressures is not None) or c.A.ndim > 3:
            raise ValueError(f"a schedule needs one pressure for each design, got a batch of shape {c.A.shape[:-2]}")
        return Controller(
            A=c.A,
            B=c.B,
            C=c.C,
            D=c.D,
            inputs=c.inputs,
            outputs=c.outputs,
            dt_s=c.dt,
            delay_s=delay_s,
            limits=limits,
            pressures=None if pressures is None else np.asarray(pressures, dtype=float),  # type: ignore[arg-type]
            windup=None if c.dt is None else self.windup,  # type: ignore[arg-type]
        )


def controls(plant: LinearSystem) -> LinearSystem:
    """The plant without its gust inputs: what a controller drives.

    Parameters
    ----------
    plant : LinearSystem
        Inputs named `gust...` are disturbances.

    Returns
    -------
    plant : LinearSystem
        Controls only. [SI]

    Raises
    ------
    ValueError
        If there is no control, or the plant still has a delay that is not a state.

    References
    ----------
    Project convention: inputs named `gust...` are disturbances.

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u", "gust_m_s"), "outputs": ("y",)}
    >>> controls(LinearSystem(A=[[-1.0]], B=[[1.0, 2.0]], C=[[1.0]], D=[[0.0, 0.0]], **names)).inputs
    ('u',)
    """
    names = [name for name in plant.inputs if not name.startswith("gust")]
    if not names:
        raise ValueError(f"the plant has no control to design for; inputs: {', '.join(plant.inputs) or 'none'}")
    if plant.input_delay_s:
        raise ValueError(
            f"the plant has a delay of {plant.input_delay_s:g} s that is no state: sample it (sampled_plant, or a "
            "rate for design_plant)"
        )
    return chosen(plant, inputs=names)


def square(values: ArrayLike, names: Sequence[str], what: str, *, definite: bool = False) -> Array:
    """A weight or covariance as a matrix, from a diagonal or a matrix; where that is short, zeros follow.

    Parameters
    ----------
    values : array_like, shape (k,) or (k, k)
        Diagonal or matrix of the first k <= n. [SI]
    names : sequence of str, length n
        What is weighed.
    what : str
        Name of the weight, for errors.
    definite : bool
        Whether it must be positive definite; then k = n.

    Returns
    -------
    weight : ndarray, shape (n, n)
        Symmetric. [SI]

    Raises
    ------
    ValueError
        If the size is wrong, a value is not finite, or it is not symmetric or not (semi)definite.

    References
    ----------
    Project convention: a diagonal shorter than the states weighs the first ones.

    Examples
    --------
    >>> square([2.0], ("a", "b"), "Q").tolist()
    [[2.0, 0.0], [0.0, 0.0]]
    """
    value = np.atleast_1d(np.asarray(values, dtype=float))
    n = len(names)
    if not np.all(np.isfinite(value)):
        raise ValueError(f"{what} holds a value that is not finite")
    k = len(value)
    if value.shape not in ((k,), (k, k)) or k > n or (definite and k != n):
        most = "" if definite else "at most "
        raise ValueError(
            f"{what} must be a diagonal or a square matrix of {most}{n}, of {', '.join(names)}; got shape {value.shape}"
        )
    square = np.zeros((n, n))
    square[:k, :k] = np.diag(value) if value.ndim == 1 else value
    value = square
    if not np.allclose(value, value.T, rtol=1e-12, atol=1e-12 * np.abs(value).max(initial=0.0)):
        raise ValueError(f"{what} must be symmetric")
    least = float(np.linalg.eigvalsh(value)[0]) if n else 1.0
    if least < -1e-12 * np.abs(value).max(initial=0.0) or (definite and least <= 0.0):
        kind = "positive" if definite else "not negative"
        raise ValueError(f"{what} must be {kind} (its eigenvalues), got {least:g}")
    return value


def feedback(
    plant: LinearSystem, K: Array, *, method: str, residual: Array, measured: Sequence[str] | None = None,
    notes: tuple[str, ...] = (),
) -> Design:  # fmt: skip
    """A design from a gain on all states: measured ones are read, the others simulated inside the controller.

    Delay states are the controller's own past commands; the states of an actuator and the lags of the air are driven
    by what is measured and commanded. Their errors die out by themselves, so that the roots of the loop are those of
    A - B K and those of the simulated part.

    Parameters
    ----------
    plant : LinearSystem
        Controls only (`controls`), any batch. [SI]
    K : ndarray, shape (..., n_u, n)
        u = -K x. [SI]
    method : str
        Name of the method.
    residual : ndarray, shape (...)
        Of its solution. [-]
    measured : sequence of str, optional
        States that are read; default those that outputs of the same name show.
    notes : tuple of str
        What to know.

    Returns
    -------
    design : Design
        With its closed loop. [SI]

    Raises
    ------
    ValueError
        If a measured state is no output, none is, or what is not measured is unstable by itself.

    References
    ----------
    D. G. Luenberger, "An introduction to observers", IEEE Trans. Autom. Control 16(6), 1971 (the part of the state that
    is not measured).

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("x",)}
    >>> plant = LinearSystem(A=[[1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> feedback(plant, np.array([[3.0]]), method="poles", residual=np.zeros(())).closed_loop_eigenvalues.tolist()
    [(-2+0j)]
    """
    shown = [name for name in plant.states if _shows(plant, name)]
    if measured is None:
        measured = shown
    if not measured:
        raise ValueError(
            "state feedback reads states, and no output of the plant shows one under its own name: add them "
            "(with_state_outputs), or design an observer (lqg)"
        )
    for name in measured:
        if name not in shown:
            raise ValueError(f"{name!r} is no state that an output shows; there are {', '.join(shown) or 'none'}")
    m = [plant.states.index(name) for name in measured]
    z = [i for i in range(len(plant.states)) if i not in m]
    A, B = plant.A, plant.B
    inner = A[..., z, :][..., z]
    if np.any(stability_margin(inner, plant.dt) <= 0.0):
        names = ", ".join(plant.states[i] for i in z)
        raise ValueError(f"{names} cannot be simulated inside the controller: unstable alone; measure more, or use lqg")
    Km, Kz, Bz = K[..., m], K[..., z], B[..., z, :]
    controller = LinearSystem(
        A=inner - Bz @ Kz,
        B=A[..., z, :][..., m] - Bz @ Km,
        C=-Kz,
        D=-Km,
        states=tuple(f"{plant.states[i]}_inside" for i in z),
        inputs=tuple(measured),
        outputs=plant.inputs,
        dt=plant.dt,
    )
    return Design(
        method=method,
        controller=controller,
        K=K,
        states=plant.states,
        closed_loop_eigenvalues=np.linalg.eigvals(joined(plant, controller)),
        residual=residual,
        windup=Bz,
        notes=notes,
    )


def joined(plant: LinearSystem, controller: LinearSystem) -> Array:
    """State matrix of a loop, for one plant and controller or for a batch of both.

    Parameters
    ----------
    plant, controller : LinearSystem
        Of one batch shape (...). [SI]

    Returns
    -------
    A : ndarray, shape (..., n + n_c, n + n_c)
        Closed loop. [SI]

    References
    ----------
    Project convention: one way to close a loop (`closed_loop`).

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> plant = LinearSystem(A=[[1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> from aeroservo.control.controller import state_feedback
    >>> joined(plant, state_feedback([[3.0]], ("y",), ("u",), None).continuous).tolist()
    [[-2.0]]
    """
    batch = plant.A.shape[:-2]
    if not batch:
        return closed_loop(plant, controller).A
    if len(batch) == 1 and plant.dt is not None:  # as a schedule whose point i is at "pressure" i: one call for all
        at = np.arange(batch[0], dtype=float)
        c = controller
        row = Controller(
            A=c.A, B=c.B, C=c.C, D=c.D, inputs=c.inputs, outputs=c.outputs, dt_s=c.dt, pressures=at
        )  # fmt: skip
        return closed_loop(plant, row, pressure=at).A
    found = [closed_loop(plant[i], controller[i]).A for i in np.ndindex(*batch)]
    return np.reshape(found, (*batch, *found[0].shape)) if found else np.zeros((*batch, 0, 0))


def with_state_outputs(plant: LinearSystem) -> LinearSystem:
    """The plant with its states as outputs of the same names, before its other outputs; past commands are no states.

    Parameters
    ----------
    plant : LinearSystem
        Any batch.

    Returns
    -------
    plant : LinearSystem
        Whose states can be fed back. [SI]

    References
    ----------
    Project convention: full-state feedback reads outputs named as the states.

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> with_state_outputs(LinearSystem(A=[[1.0]], B=[[1.0]], C=[[2.0]], D=[[0.0]], **names)).outputs
    ('x', 'y')
    """
    batch = plant.A.shape[:-2]
    shown = [i for i, name in enumerate(plant.states) if not name.endswith("_ago")]
    names = [plant.states[i] for i in shown]
    rows = [i for i, name in enumerate(plant.outputs) if name not in names]
    unit = np.eye(len(plant.states))[shown]
    return replace(
        plant,
        C=np.concatenate([np.broadcast_to(unit, (*batch, *unit.shape)), plant.C[..., rows, :]], axis=-2),
        D=np.concatenate([np.zeros((*batch, len(shown), len(plant.inputs))), plant.D[..., rows, :]], axis=-2),
        outputs=(*names, *(plant.outputs[i] for i in rows)),
    )


def _shows(plant: LinearSystem, name: str) -> bool:
    """Whether an output of that name is that state and nothing else."""
    if name not in plant.outputs:
        return False
    row = plant.outputs.index(name)
    unit = np.zeros(len(plant.states))
    unit[plant.states.index(name)] = 1.0
    return bool(np.abs(plant.C[..., row, :] - unit).max() <= UNIT and np.abs(plant.D[..., row, :]).max() <= UNIT)
