"""LQG: a Kalman filter for the sensors there are, the regulator's gain on its estimate, loop-transfer recovery.

Time. The filter of a sampled design is by default the *current* one: the command of sample k uses the measurement of
sample k, and the time to compute it is the plant's delay (`delay_samples` of `design_plant`), stated once and inside.
The *predictor* uses measurements up to k - 1: one sample of computing time that needs no delay in the plant.

Recovery. Noise added at the plant's input (q B B' on top of W) lets the loop, cut there, approach that of full state
feedback as q grows - where the plant from command to sensors has no zeros in the right half plane (outside the unit
circle). Zeros there stay in the loop; the design names them. A sampled plant nearly always has some: those of sampling
lie outside the unit circle where the relative degree is three or more, and a delay acts alike: recovery is never whole.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from aeroservo.control.design import Design, controls, joined, square
from aeroservo.control.kalman import filter_residual, kalman_gain, sensor_deviations
from aeroservo.control.lqr import FULL_STATE, lqr_gain
from aeroservo.control.verify import riccati_residual
from aeroservo.control.zeros import transmission_zeros
from aeroservo.datatypes import Array, LinearSystem, frozen


@dataclass(frozen=True, kw_only=True, eq=False)
class LQG:
    """LQR on the estimate of a Kalman filter, from the outputs that the plant has.

    Attributes
    ----------
    Q : ndarray, shape (k,) or (k, k)
        State weights, as of `LQR`. [1/state^2]
    R : ndarray, shape (m,) or (m, m)
        Input weights, positive. [1/input^2]
    gust : float
        Standard deviation of every gust input of the plant. [m/s]
    W : ndarray, shape (k,) or (n, n), optional
        Covariance of further noise on the states. [state^2]
    V : ndarray, shape (p,) or (p, p), optional
        Covariance of the sensors, positive; by their units if not given (`kalman.SENSOR_NOISE`). [output^2]
    recovery : float
        Standard deviation of the fictitious noise of every command; 0 is no recovery. [unit of the command, rad]
    form : {"current", "predictor"}
        Whether a sampled command uses the measurement of its own sample.
    """

    Q: Array
    R: Array
    gust: float = 0.1
    W: Array | None = None
    V: Array | None = None
    recovery: float = 0.0
    form: Literal["current", "predictor"] = "current"

    def __post_init__(self) -> None:
        """Lock the weights and check the options."""
        for name in ("Q", "R", "W", "V"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, frozen(np.atleast_1d(np.asarray(value, dtype=float)), name=name))
        for name, unit in (("gust", "m/s"), ("recovery", "rad")):
            value = getattr(self, name)
            if not 0.0 <= value < math.inf:
                raise ValueError(f"{name} must not be negative [{unit}], got {value}")
        if self.form not in ("current", "predictor"):
            raise ValueError(f"form must be 'current' or 'predictor', got {self.form!r}")

    def __call__(self, plant: LinearSystem) -> Design:
        """Design for a plant, or for each of a batch.

        Parameters
        ----------
        plant : LinearSystem
            Continuous or sampled, with the sensors as its outputs and, for their noise, gusts as inputs. [SI]

        Returns
        -------
        design : Design
            Residual: the larger of the two Riccati equations and of the separation of the closed loop's roots. [SI]

        Raises
        ------
        ValueError
            If a weight does not fit, the current form meets sensors that a command moves at once, or no stabilising
            solution exists: which mode, and why.

        References
        ----------
        B. D. O. Anderson and J. B. Moore, Optimal Control, 1990, chapters 7 and 8; J. C. Doyle and G. Stein, IEEE
        Trans. Autom. Control 26(1), 1981 (recovery).

        Examples
        --------
        >>> names = {"states": ("x", "v"), "inputs": ("u",), "outputs": ("x_m",)}
        >>> two = LinearSystem(A=[[0, 1], [0, 0]], B=[[0], [1]], C=[[1, 0]], D=[[0]], **names)
        >>> LQG(Q=[1.0, 1.0], R=[1.0], W=[0.0, 1.0], V=[1.0])(two).closed_loop_eigenvalues.real.max() < -0.5
        np.True_
        """
        u = controls(plant)
        Q, R = square(self.Q, u.states, "Q"), square(self.R, u.inputs, "R", definite=True)
        W, V, S = _noise(self, plant, u)
        K, X = lqr_gain(u.A, u.B, Q, R, dt=u.dt, states=u.states, inputs=u.inputs)
        L, P = kalman_gain(u.A, u.C, W, V, S=S, dt=u.dt, states=u.states, outputs=u.outputs)
        controller = observer(u, K, L, P, V, S, form=self.form)
        loop = joined(u, controller)
        residual = np.maximum(
            riccati_residual(u.A, u.B, Q, R, X, dt=u.dt), filter_residual(u.A, u.C, W, V, P, S=S, dt=u.dt)
        )
        return Design(
            method="lqg",
            controller=controller,
            K=K,
            states=u.states,
            closed_loop_eigenvalues=np.linalg.eigvals(loop),
            residual=np.maximum(residual, separation_residual(u, loop, K, L)),
            windup=u.B,
            notes=_limits_of_recovery(u) if self.recovery else (),
        )


GYRO_ACCELEROMETER = LQG(Q=FULL_STATE.Q, R=FULL_STATE.R, gust=0.1, V=np.array([math.radians(0.1) ** 2, 0.1**2]))
"""Flutter suppression of a pitch-plunge model from a gyro and an accelerometer (in this order), without recovery: the
weights of `FULL_STATE`; gusts of 0.1 m/s, sensors of 0.1 deg/s and 0.1 m/s^2."""

GYRO_RECOVERY = LQG(
    Q=np.array([0.0, 1.0 / math.radians(5.0) ** 2, 0.0, 1.0 / math.radians(60.0) ** 2]),
    R=FULL_STATE.R,
    gust=0.1,
    W=np.array([0.0, math.radians(0.5) ** 2]),
    V=np.array([math.radians(0.1) ** 2]),
    recovery=math.radians(100.0),
)
"""The same from the gyro alone, with loop-transfer recovery: 5 deg of pitch and 60 deg/s are worth 10 deg of elevon;
100 deg of fictitious command noise against 0.1 deg/s of the gyro. A gyro does not see a steady pitch angle (its zero
at s = 0), which recovery would make the filter integrate for minutes; 0.5 deg of noise on pitch itself lets the spring
tell it, in seconds below 80 m/s, at no cost in margin."""


def observer(
    plant: LinearSystem, K: Array, L: Array, P: Array, V: Array, S: Array,
    *, form: Literal["current", "predictor"] = "current",
) -> LinearSystem:  # fmt: skip
    """Controller of a Kalman filter and a gain on its estimate.

    Parameters
    ----------
    plant : LinearSystem
        Controls to sensors. [SI]
    K : ndarray, shape (..., m, n)
        u = -K x. [SI]
    L, P : ndarray, shapes (..., n, p), (..., n, n)
        Of `kalman_gain`. [SI]
    V, S : ndarray, shapes (p, p), (..., n, p)
        Covariance of the sensors, and its cross covariance with the states' noise. [SI]
    form : {"current", "predictor"}
        Of a sampled filter.

    Returns
    -------
    controller : LinearSystem
        From sensors to commands. [SI]

    Raises
    ------
    ValueError
        If the current form meets sensors that a command moves at once.

    References
    ----------
    G. F. Franklin, J. D. Powell and M. L. Workman, Digital Control of Dynamic Systems, 1998, section 8.2 (current and
    predictor estimators).

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> plant = LinearSystem(A=[[1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], dt=0.1, **names)
    >>> one, none = np.eye(1), np.zeros((1, 1))
    >>> observer(plant, 0.5 * one, 0.5 * one, one, one, none, form="predictor").A.tolist()
    [[0.0]]
    """
    A, B, C, D = plant.A, plant.B, plant.C, plant.D
    moved = A - B @ K
    if plant.dt is None or form == "predictor":
        Ac, Bc, Cc = moved - L @ (C - D @ K), L, -K
        Dc = np.zeros((*A.shape[:-2], K.shape[-2], C.shape[-2]))
    else:
        if np.any(D):
            raise ValueError("a command moves a sensor at once: the current form is algebraic; take form='predictor'")
        Ct = np.swapaxes(C, -1, -2)
        spread = np.linalg.inv(C @ P @ Ct + V)
        M = P @ Ct @ spread
        jump = np.eye(A.shape[-1]) - M @ C
        Ac, Bc = moved @ jump - S @ spread @ C, moved @ M + S @ spread
        Cc, Dc = -K @ jump, -K @ M
    return LinearSystem(
        A=Ac, B=Bc, C=Cc, D=Dc, states=tuple(f"{name}_estimate" for name in plant.states), inputs=plant.outputs,
        outputs=plant.inputs, dt=plant.dt,
    )  # fmt: skip


def separation_residual(plant: LinearSystem, loop: Array, K: Array, L: Array) -> Array:
    """How far the joined loop is from the separation principle, by its characteristic polynomial at test points.

    det(z I - A_closed) must be det(z I - A + B K) det(z I - A + L C), which never forms the controller.

    Parameters
    ----------
    plant : LinearSystem
        Controls to sensors. [SI]
    loop : ndarray, shape (..., 2n, 2n)
        State matrix of plant and controller joined. [SI]
    K, L : ndarray, shapes (..., m, n), (..., n, p)
        Gains of regulator and predictor. [SI]

    Returns
    -------
    residual : ndarray, shape (...)
        Largest relative difference. [-]

    References
    ----------
    B. D. O. Anderson and J. B. Moore, Optimal Control, 1990, section 8.2 (separation).

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> plant = LinearSystem(A=[[1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], dt=0.1, **names)
    >>> one, none = np.eye(1), np.zeros((1, 1))
    >>> c = observer(plant, 0.5 * one, 0.5 * one, one, one, none, form="predictor")
    >>> float(separation_residual(plant, joined(plant, c), 0.5 * one, 0.5 * one)) < 1e-15
    True
    """
    first, second = plant.A - plant.B @ K, plant.A - L @ plant.C
    size = 1.0 if plant.dt is not None else float(np.abs(np.linalg.eigvals(loop)).max(initial=1.0))
    worst = np.zeros(plant.A.shape[:-2])
    for angle in (0.3, 1.1, 2.0, 2.9):
        point = 1.5 * size * np.exp(1j * angle)
        sign, logs = zip(*(np.linalg.slogdet(point * np.eye(x.shape[-1]) - x) for x in (loop, first, second)))
        ratio = sign[0] / (sign[1] * sign[2]) * np.exp(logs[0] - logs[1] - logs[2])
        worst = np.maximum(worst, np.abs(ratio - 1.0))
    return np.asarray(worst)


def _noise(options: LQG, plant: LinearSystem, u: LinearSystem) -> tuple[Array, Array, Array]:
    """Covariances W (..., n, n), V (p, p), S (..., n, p) of the options."""
    if not u.outputs:
        raise ValueError("the plant has no output to measure")
    gusts = [j for j, name in enumerate(plant.inputs) if name.startswith("gust")]
    Bg, Dg = options.gust * plant.B[..., gusts], options.gust * plant.D[..., gusts]
    Bu = options.recovery * _at_input(u)
    extra = 0.0 if options.W is None else square(options.W, u.states, "W")
    W = Bg @ np.swapaxes(Bg, -1, -2) + Bu @ np.swapaxes(Bu, -1, -2) + extra
    given = sensor_deviations(u.outputs) ** 2 if options.V is None else options.V
    V = square(given, u.outputs, "V", definite=True)
    turned = np.swapaxes(Dg, -1, -2)
    return W, V + Dg @ turned, Bg @ turned


def _at_input(u: LinearSystem) -> Array:
    """Column of each command where it meets the plant, behind the delay that the controller remembers."""
    column = np.array(u.B)
    for j, name in enumerate(u.inputs):
        memory = [i for i, state in enumerate(u.states) if state.startswith(f"{name}_") and state.endswith("_ago")]
        column[..., memory, j] = 0.0
        for i in memory:
            physical = u.A[..., :, i].copy()
            physical[..., memory] = 0.0
            column[..., :, j] += physical
    return column


def _limits_of_recovery(u: LinearSystem) -> tuple[str, ...]:
    """Zeros that recovery cannot pass, of the first of a batch."""
    if len(u.inputs) != len(u.outputs):
        return ()
    try:
        zeros = transmission_zeros(u[(0,) * (u.A.ndim - 2)])
    except ValueError:  # every s is a zero: the Riccati equations have said what there is to say
        return ()
    if u.dt is None:
        bad = [z for z in zeros if 1e-6 < z.real < 1e6]
        words = ", ".join(f"{z.real:.3g}{z.imag:+.3g}i" if abs(z.imag) > 1e-9 else f"{z.real:.3g}" for z in bad)
        return (f"recovery is limited by zeros in the right half plane, 1/s: {words}",) if bad else ()
    bad = [z for z in zeros if 1.0 + 1e-6 < abs(z) < 1e6]
    delay = sum(name.endswith("_ago") for name in u.states)
    words = ", ".join(f"{z.real:.3g}{z.imag:+.3g}i" if abs(z.imag) > 1e-9 else f"{z.real:.3g}" for z in bad)
    notes = [f"zeros outside the unit circle: {words}"] if bad else []
    notes += [f"{delay} delay state(s)"] if delay else []
    return (f"recovery is limited by {' and '.join(notes)}",) if notes else ()
