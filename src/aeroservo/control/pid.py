"""PID on one sensor: filters, filtered derivative, anti-windup; continuous or sampled, as the plant is.

What limits do: a command beyond its limit is clipped by the controller (`Controller.limits`) or by the actuator. The
first is known to the controller, and its integral follows it back within `tracking_s` (back-calculation). The second is
not: give the controller the actuator's limit, or its integral winds up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from aeroservo.control.design import Design, controls, joined
from aeroservo.control.filters import Filter, series, tustin
from aeroservo.control.plant import chosen
from aeroservo.control.verify import stability_margin
from aeroservo.datatypes import Array, LinearSystem


@dataclass(frozen=True, kw_only=True)
class PID:
    """u = -(kp y + ki integral of y + kd N s/(s + N) y), y behind its filters: a set point of zero.

    Attributes
    ----------
    channel : str
        Output of the plant that is fed back.
    kp, ki, kd : float
        Gains; u is added to the plant's input, so that positive ones are negative feedback. [rad/y, rad/(y s), rad s/y]
    derivative_rad_s : float
        N, where the derivative rolls off. [rad/s]
    filters : tuple of LowPass, Notch or PhaseFilter
        On the measurement, in this order.
    control : str, optional
        Input of the plant that is driven; the only one if not given.
    tracking_s : float
        Time in which the integral follows a clipped command. [s]
    """

    channel: str
    kp: float = 0.0
    ki: float = 0.0
    kd: float = 0.0
    derivative_rad_s: float = 100.0
    filters: tuple[Filter, ...] = ()
    control: str | None = None
    tracking_s: float = 0.1

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("kp", "ki", "kd"):
            if not math.isfinite(getattr(self, name)):
                raise ValueError(f"{name} must be finite, got {getattr(self, name)}")
        if self.kp == self.ki == self.kd == 0.0:
            raise ValueError("kp, ki and kd are all zero: nothing is fed back")
        for name, unit in (("derivative_rad_s", "rad/s"), ("tracking_s", "s")):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} must be positive [{unit}], got {getattr(self, name)}")

    def __call__(self, plant: LinearSystem) -> Design:
        """The controller, sampled if the plant is (Tustin), and what it does to the plant.

        Parameters
        ----------
        plant : LinearSystem
            Continuous or sampled; gust inputs are left alone. [SI]

        Returns
        -------
        design : Design
            Without K; residual: the loop's characteristic polynomial against det(I + L). An unstable loop is an answer:
            a note says so. [SI]

        Raises
        ------
        ValueError
            If the channel or the control does not exist, or a filter lies above the Nyquist frequency.

        References
        ----------
        Bramstång 2015, section 6.4.1 (PID); K. J. Åström and T. Hägglund, Advanced PID Control, 2006, sections 3.3
        (derivative filter) and 3.5 (back-calculation).

        Examples
        --------
        >>> names = {"states": ("x",), "inputs": ("elevon_rad",), "outputs": ("gyro_rad_s",)}
        >>> plant = LinearSystem(A=[[1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
        >>> PID(channel="gyro_rad_s", kp=3.0, ki=1.0)(plant).closed_loop_eigenvalues.round(9).tolist()
        [(-1+0j), (-1+0j)]
        """
        u = controls(plant)
        control = self.control
        if control is None:
            if len(u.inputs) > 1:
                raise ValueError(f"a PID drives one control: say which (control) of {', '.join(u.inputs)}")
            control = u.inputs[0]
        u = chosen(u, inputs=[control], outputs=[self.channel])
        one, windup = self._controller(control, u.dt)
        batch = u.A.shape[:-2]
        A, B, C, D = (np.broadcast_to(x, (*batch, *x.shape)) for x in (one.A, one.B, one.C, one.D))
        controller = replace(one, A=A, B=B, C=C, D=D)
        closed = joined(u, controller)
        margin = np.asarray(stability_margin(closed, u.dt))
        notes = () if np.all(margin > 0.0) else (f"the closed loop is unstable (by {-margin.min():.3g})",)
        return Design(
            method="pid",
            controller=controller,
            K=np.zeros((*batch, 1, 0)),
            states=(),
            closed_loop_eigenvalues=np.linalg.eigvals(closed),
            residual=loop_residual(u, controller),
            windup=np.broadcast_to(windup, (*batch, *windup.shape)),
            notes=notes,
        )

    def _controller(self, control: str, dt: float | None) -> tuple[LinearSystem, Array]:
        """Filters, then the three terms; and how the integral hears of a clipped command."""
        N = self.derivative_rad_s
        states = (*(["integral"] if self.ki else []), *(["derivative"] if self.kd else []))
        A = np.diag([{"integral": 0.0, "derivative": -N}[name] for name in states]).reshape(len(states), len(states))
        B = np.ones((len(states), 1))
        C = np.array([[{"integral": -self.ki, "derivative": self.kd * N * N}[name] for name in states]])
        terms = LinearSystem(
            A=A, B=B, C=C.reshape(1, len(states)), D=[[-self.kp - self.kd * N]],  # type: ignore[arg-type]
            states=states, inputs=(self.channel,), outputs=(control,),
        )  # fmt: skip
        if dt is not None:
            terms = tustin(terms, dt)
        whole = series(*(f(self.channel, dt) for f in self.filters), terms)
        windup = np.zeros((len(whole.states), 1))
        if self.ki and dt is not None:
            windup[whole.states.index("integral")] = -min(1.0, dt / self.tracking_s) / self.ki
        return whole, windup


def loop_residual(plant: LinearSystem, controller: LinearSystem) -> Array:
    """How far a joined loop is from det(s I - A_closed) = det(s I - A) det(s I - A_c) det(I - P C), at test points.

    Parameters
    ----------
    plant, controller : LinearSystem
        Of one batch shape (...); the controller reads all outputs and drives all inputs, in order. [SI]

    Returns
    -------
    residual : ndarray, shape (...)
        Largest relative difference. [-]

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed. 2005, section 4.9.2 (determinant of the
    return difference).

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> plant = LinearSystem(A=[[1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> lag = LinearSystem(A=[[-5.0]], B=[[1.0]], C=[[-9.0]], D=[[0.0]], states=("c",), inputs=("y",), outputs=("u",))
    >>> float(loop_residual(plant, lag)) < 1e-14
    True
    """
    closed = joined(plant, controller)
    size = 1.0 if plant.dt is not None else float(np.abs(np.linalg.eigvals(closed)).max(initial=1.0))
    worst = np.zeros(plant.A.shape[:-2])
    for angle in (0.3, 1.1, 2.0, 2.9):
        point = 1.5 * size * np.exp(1j * angle)
        P, C = (_value(x, point) for x in (plant, controller))
        difference = np.eye(P.shape[-2]) - P @ C
        parts = [np.linalg.slogdet(point * np.eye(x.shape[-1]) - x) for x in (closed, plant.A, controller.A)]
        parts.append(np.linalg.slogdet(difference))
        sign = parts[0][0] / (parts[1][0] * parts[2][0] * parts[3][0])
        logs = parts[0][1] - parts[1][1] - parts[2][1] - parts[3][1]
        worst = np.maximum(worst, np.abs(sign * np.exp(logs) - 1.0))
    return np.asarray(worst)


def _value(system: LinearSystem, point: complex) -> Array:
    """Transfer matrix at one point."""
    pencil = point * np.eye(len(system.states)) - system.A
    return np.asarray(system.C @ np.linalg.solve(pencil, system.B.astype(complex)) + system.D)
