"""A feedback loop cut open: frequency responses with exact delays, frequencies that miss no peak, stability both ways.

Negative feedback throughout: controllers' outputs are added to the plant's inputs, so the loop transfer is
L_u = -K P at the plant's inputs and L_y = -P K at its outputs; S = (I + L)^-1, T = I - S.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from aeroservo.control.closed_loop import at_rate, closed_loop, controller_at, roots, wiring
from aeroservo.control.controller import Controller, controller_of
from aeroservo.datatypes import Array, LinearSystem

PER_DECADE = 40
"""Frequencies in a decade besides those around the roots."""

AROUND = np.array([0.0, 0.25, 0.5, 1.0, 1.5, 2.5, 4.0, 7.0, 12.0, 25.0])
"""Frequencies around a root, in units of its distance from the axis."""

OVERDAMPED = 0.5
"""Roots farther from the axis than this part of their size make no sharp peak: the even grid sees them."""

EDGE = 1e-9
"""Distance from the axis, part of the largest root, along which encirclements are counted; nearer roots are stable."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Loop:
    """A plant and a controller at one condition, cut open.

    Attributes
    ----------
    plant : LinearSystem
        From what the controller drives to what it reads; `input_delay_s` is taken exactly. [SI]
    controller : tuple of ndarray
        Its A, B, C, D at this condition, shapes (n_c, n_c), (n_c, n_y), (n_u, n_c), (n_u, n_y). [SI]
    closed : ndarray, shape (n, n)
        State matrix of the closed loop, without `input_delay_s`. [SI]
    drives, reads : tuple of str
        Channels at the plant's inputs and outputs.
    """

    plant: LinearSystem
    controller: tuple[Array, Array, Array, Array]
    closed: Array
    drives: tuple[str, ...]
    reads: tuple[str, ...]

    @property
    def dt(self) -> float | None:
        """Sample time; None is continuous. [s]"""
        return self.plant.dt

    @property
    def nyquist(self) -> float:
        """Largest frequency. [rad/s]"""
        return math.inf if self.dt is None else math.pi / self.dt

    def responses(self, s: Array) -> tuple[Array, Array]:
        """Plant (m, n_y, n_u) and controller (m, n_u, n_y) at points s (m,), sampled ones at e^(s dt). [SI]"""
        x = np.asarray(s, dtype=complex) if self.dt is None else np.exp(np.asarray(s, dtype=complex) * self.dt)
        G = self._plant(x)
        if self.plant.input_delay_s:
            G = G * np.exp(-np.asarray(s) * self.plant.input_delay_s)[:, None, None]
        return G, self._controller(x)

    @cached_property
    def _plant(self) -> _Triangular:
        return _Triangular(self.plant.A, self.plant.B, self.plant.C, self.plant.D)

    @cached_property
    def _controller(self) -> _Triangular:
        return _Triangular(*self.controller)

    def transfer(self, s: Array, at: str = "input") -> Array:
        """Loop transfer L (m, n, n) at points s (m,), cut at "input", "output", or "both" at once. [-]"""
        P, K = self.responses(s)
        if at == "input":
            return -K @ P
        if at == "output":
            return -P @ K
        zero_u, zero_y = (np.zeros((len(P), k, k)) for k in (K.shape[1], P.shape[1]))
        return -np.concatenate([np.concatenate([zero_u, K], axis=2), np.concatenate([P, zero_y], axis=2)], axis=1)

    def channels(self, at: str = "input") -> tuple[str, ...]:
        """Names of the channels of L. [-]"""
        return {"input": self.drives, "output": self.reads, "both": (*self.drives, *self.reads)}[at]


def cut_loop(
    plant: LinearSystem,
    controller: Controller | LinearSystem,
    *,
    pressure: float | None = None,
    delay_s: float = 0.0,
) -> Loop:
    """Cut a loop open for analysis.

    Parameters
    ----------
    plant : LinearSystem
        One condition, continuous or sampled. [SI]
    controller : Controller or LinearSystem
        Closes the loop; its outputs are added to the plant's inputs.
    pressure : float, optional
        Dynamic pressure, for a schedule. [Pa]
    delay_s : float
        Delay on top of those in plant and controller; of a sampled plant a whole number of samples. [s]

    Returns
    -------
    loop : Loop
        Sampled loops at the controller's rate. [SI]

    Raises
    ------
    ValueError
        If the plant is a batch, a channel is missing, or the rates differ.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed. 2005, section 2.2.

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> integrator = LinearSystem(A=[[0.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> gain = Controller(A=[], B=[], C=[], D=[[-2.0]], inputs=("y",), outputs=("u",))
    >>> complex(cut_loop(integrator, gain).transfer(np.array([2j]))[0, 0, 0])
    -1j
    """
    if plant.A.ndim != 2:
        raise ValueError(f"margins are of one condition: index this batch of shape {plant.A.shape[:-2]} first")
    if isinstance(controller, LinearSystem):
        late = controller.input_delay_s if controller.dt is None else 0.0
        plant = replace(plant, input_delay_s=plant.input_delay_s + late)
        controller = controller_of(replace(controller, input_delay_s=0.0) if late else controller)
    plant = at_rate(replace(plant, input_delay_s=plant.input_delay_s + delay_s), controller)
    if plant.dt is not None and plant.input_delay_s:
        from aeroservo.control.plant import sampled_plant

        plant = sampled_plant(plant, plant.dt)
    scatter, rows = wiring(plant, controller)
    driven = [int(np.argmax(column)) for column in scatter.T]
    plant = replace(
        plant, B=plant.B[:, driven], C=plant.C[rows], D=plant.D[rows][:, driven], inputs=controller.outputs,
        outputs=controller.inputs,
    )  # fmt: skip
    closed = closed_loop(replace(plant, input_delay_s=0.0), replace(controller, delay_s=0.0), pressure=pressure)
    return Loop(
        plant=plant,
        controller=controller_at(controller, pressure),
        closed=closed.A,
        drives=controller.outputs,
        reads=controller.inputs,
    )


def is_stable(loop: Loop) -> bool:
    """Whether the closed loop is stable: by its eigenvalues, or, with an exact delay, by encirclements.

    Parameters
    ----------
    loop : Loop
        Cut open.

    Returns
    -------
    stable : bool
        No root in the right half plane, or outside the unit circle; roots on the border are not stable.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed. 2005, section 4.9.2.

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> integrator = LinearSystem(A=[[0.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> gain = Controller(A=[], B=[], C=[], D=[[-2.0]], inputs=("y",), outputs=("u",))
    >>> is_stable(cut_loop(integrator, gain)), is_stable(cut_loop(integrator, gain, delay_s=0.8))
    (True, False)
    """
    if loop.plant.input_delay_s:
        return unstable_roots(loop) == 0
    values = np.linalg.eigvals(loop.closed)
    if loop.dt is not None:
        return bool(np.abs(values).max(initial=0.0) < 1.0 - 1e-12)
    return bool(values.real.max(initial=-1.0) < -1e-12 * np.abs(values).max(initial=0.0))


def unstable_roots(loop: Loop) -> int:
    """Unstable roots of the closed loop, counted by the encirclements of the origin by det(I + L).

    An independent count: it never forms the closed loop, and takes a delay exactly. Roots closer to the axis than
    `EDGE` of the largest count as stable.

    Parameters
    ----------
    loop : Loop
        Cut open.

    Returns
    -------
    count : int
        Roots in the right half plane, or outside the unit circle.

    Raises
    ------
    ValueError
        If a continuous loop with a delay does not fall off with frequency: its roots cannot be counted.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed. 2005, theorem 4.9 (generalised
    Nyquist).

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> unstable = LinearSystem(A=[[1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> gain = Controller(A=[], B=[], C=[], D=[[-2.0]], inputs=("y",), outputs=("u",))
    >>> unstable_roots(cut_loop(unstable, gain)), unstable_roots(cut_loop(unstable, gain, delay_s=0.7))
    (0, 2)
    """
    poles = np.concatenate([roots(loop.plant), _controller_roots(loop)])
    poles = poles[np.isfinite(poles)]
    scale = np.abs(poles).max(initial=1.0)
    edge = EDGE * scale
    omega = frequencies(loop, floor=edge)
    if loop.plant.input_delay_s and np.any(loop.controller[3] @ loop.plant.D):
        raise ValueError("a continuous loop with a delay must fall off with frequency: a command acts at once")
    omega = np.concatenate([[0.0], omega])

    def determinant(w: Array) -> Array:
        L = loop.transfer(edge + 1j * w)
        return np.asarray(np.linalg.det(np.eye(L.shape[-1]) + L))

    value = determinant(omega)
    for _ in range(40):
        turn = np.abs(np.angle(value[1:] / value[:-1]))
        coarse = np.flatnonzero(turn > 0.5)
        if not coarse.size:
            break
        middle = 0.5 * (omega[coarse] + omega[coarse + 1])
        omega = np.insert(omega, coarse + 1, middle)
        value = np.insert(value, coarse + 1, determinant(middle))
    turns = float(np.sum(np.angle(value[1:] / value[:-1]))) / math.pi  # both halves of the contour
    unstable = int(np.sum(poles.real > edge))
    return round(unstable - turns)


def frequencies(loop: Loop, *, floor: float = 0.0) -> Array:
    """Frequencies that miss no lightly damped mode: around every root of plant, controller and loop, and between.

    Parameters
    ----------
    loop : Loop
        Cut open.
    floor : float
        Least distance of a root from the axis that is resolved. [rad/s]

    Returns
    -------
    omega : ndarray, shape (m,)
        Ascending, positive, up to Nyquist's frequency (included), or far beyond the fastest root. [rad/s]

    References
    ----------
    Project convention: frequencies are seeded by the roots of the loop, peaks refined between them.

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> lag = LinearSystem(A=[[0.5]], B=[[1.0]], C=[[1.0]], D=[[0.0]], dt=0.1, **names)
    >>> gain = Controller(A=[], B=[], C=[], D=[[-0.1]], inputs=("y",), outputs=("u",), dt_s=0.1)
    >>> round(float(frequencies(cut_loop(lag, gain))[-1]), 3)
    31.416
    """
    closed = np.linalg.eigvals(loop.closed).astype(complex)
    if loop.dt is not None:
        closed = np.log(closed[np.abs(closed) > 1e-6]) / loop.dt
    poles = np.concatenate([roots(loop.plant), _controller_roots(loop), closed])
    poles = poles[np.isfinite(poles) & (poles.imag >= 0.0)]
    size = np.abs(poles)
    size = size[size > 1e-9 * size.max(initial=0.0)]
    low, high = (1e-4 * size.min(), 1e3 * size.max()) if size.size else (1e-3, 1e3)
    high = min(high, loop.nyquist)
    low = min(low, 1e-4 * high)
    swinging = poles[np.abs(poles.real) < OVERDAMPED * np.abs(poles)]
    reach = np.maximum(np.abs(swinging.real), max(floor, 1e-7 * high))
    near = swinging.imag[:, None] + reach[:, None] * np.concatenate([-AROUND, AROUND])
    even = np.geomspace(low, high, max(2, math.ceil(PER_DECADE * math.log10(high / low))))
    omega = np.concatenate([near.ravel(), size, even])
    if loop.plant.input_delay_s:  # the phase of a delay turns evenly
        omega = np.append(omega, np.arange(1.0, 400.0) * 0.25 / loop.plant.input_delay_s)
    omega = np.unique(np.clip(omega[omega > 0.0], low, high))
    return omega if loop.dt is not None else np.append(omega, 1e6 * high)  # what is left at infinity


def peak(function: Callable[[Array], Array], omega: Array) -> tuple[float, float]:
    """Largest value of a positive function of frequency, refined between the frequencies of a grid.

    Parameters
    ----------
    function : callable
        Positive values (m,) at frequencies (m,). [any]
    omega : ndarray, shape (m,)
        Ascending, fine enough to have a point on the flank of every peak. [rad/s]

    Returns
    -------
    value, at : float
        The largest value and its frequency. [any, rad/s]

    References
    ----------
    Project convention: a grid is narrowed around each peak fivefold, nine times; a smooth peak is exact to 1e-11.

    Examples
    --------
    >>> value, at = peak(lambda w: 1.0 / (1.0 + (w - 2.0) ** 2), np.array([0.5, 1.0, 3.0, 5.0]))
    >>> round(value, 9), round(at, 6)
    (1.0, 2.0)
    """
    value = function(omega)
    inner = np.flatnonzero((value[1:-1] >= value[:-2]) & (value[1:-1] >= value[2:])) + 1
    best = int(np.argmax(value))
    near = np.sort(inner[np.argsort(-value[inner])][:8])
    near = near[value[near] > 0.3 * value[best]]
    if not near.size:
        return float(value[best]), float(omega[best])
    low, high = omega[near - 1], omega[near + 1]
    for _ in range(9):  # each looks at eleven frequencies of every peak at once and keeps the fifth around the best
        x = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, 11)
        values = function(x.ravel()).reshape(x.shape)
        k = np.argmax(values, axis=1)
        rows = np.arange(len(x))
        low, high = x[rows, np.maximum(k - 1, 0)], x[rows, np.minimum(k + 1, 10)]
    x, top = x[rows, k], values[rows, k]
    k = int(np.argmax(top))
    if top[k] >= value[best]:
        return float(top[k]), float(x[k])
    return float(value[best]), float(omega[best])


def _controller_roots(loop: Loop) -> Array:
    """Roots of the controller as s."""
    z = np.linalg.eigvals(loop.controller[0]).astype(complex)
    if loop.dt is None:
        return np.asarray(z)
    return np.asarray(np.log(z[np.abs(z) > 1e-3]) / loop.dt)


class _Triangular:
    """A system on its complex Schur form, so that its response at many points costs n^2 each, not n^3."""

    def __init__(self, A: Array, B: Array, C: Array, D: Array) -> None:
        from scipy.linalg import schur

        self.D = D
        form: tuple[Array, Array] = (A, A) if not len(A) else schur(A, output="complex")
        self.T, Q = form
        self.B, self.C = Q.conj().T @ B, C @ Q

    def __call__(self, x: Array) -> Array:
        """C (x I - A)^-1 B + D at points x (m,), by back substitution for all of them at once."""
        n, k = self.B.shape
        if not n:
            return np.broadcast_to(self.D.astype(complex), (len(x), *self.D.shape))
        state = np.zeros((n, len(x), k), dtype=complex)
        for i in range(n - 1, -1, -1):
            drive = (self.T[i, i + 1 :] @ state[i + 1 :].reshape(n - i - 1, len(x) * k)).reshape(len(x), k)
            pivot = x - self.T[i, i]
            pivot = np.where(pivot == 0.0, 1e-14 * np.abs(x) + 1e-300, pivot)  # a pole to the last digit: beside it
            state[i] = (self.B[i] + drive) / pivot[:, None]
        return np.asarray(np.einsum("yn,nmk->myk", self.C, state) + self.D)
