"""Filters of a control loop: roll-off, notch, phase lead and lag, continuous or sampled; systems in series.

Sampled forms are Tustin's, each warped so that it is exact at the frequency that the filter is about.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.datatypes import Array, LinearSystem


@dataclass(frozen=True, kw_only=True)
class LowPass:
    """First-order roll-off corner/(s + corner).

    Attributes
    ----------
    corner : float
        Where the gain is 1/sqrt(2). [rad/s]
    """

    corner: float

    def __post_init__(self) -> None:
        """Check the corner."""
        _positive("corner", self.corner, "rad/s")

    def __call__(self, channel: str, dt: float | None = None) -> LinearSystem:
        """The filter on a channel.

        Parameters
        ----------
        channel : str
            Name of input and output.
        dt : float, optional
            Sample time; None is continuous. [s]

        Returns
        -------
        filter : LinearSystem
            One state. [SI]

        Raises
        ------
        ValueError
            If the corner is at or above the Nyquist frequency.

        References
        ----------
        G. F. Franklin, J. D. Powell and M. L. Workman, Digital Control of Dynamic Systems, 1998, section 6.1.

        Examples
        --------
        >>> LowPass(corner=10.0)("gyro_rad_s").A.tolist()
        [[-10.0]]
        """
        w = self.corner
        return _filter([[-w]], [[1.0]], [[w]], [[0.0]], channel, "low_pass", dt, w)


@dataclass(frozen=True, kw_only=True)
class Notch:
    """Notch (s^2 + 2 depth damping w s + w^2)/(s^2 + 2 damping w s + w^2): unit gain far from w, `depth` at w.

    Attributes
    ----------
    frequency : float
        Its centre w. [rad/s]
    depth : float
        Gain at the centre, 0 to 1. [-]
    damping : float
        Damping ratio of its poles: half its relative width. [-]
    """

    frequency: float
    depth: float = 0.1
    damping: float = 0.5

    def __post_init__(self) -> None:
        """Check the numbers."""
        _positive("frequency", self.frequency, "rad/s")
        _positive("damping", self.damping, "-")
        if not 0.0 <= self.depth <= 1.0:
            raise ValueError(f"depth must be from 0 to 1 [-], got {self.depth}")

    def __call__(self, channel: str, dt: float | None = None) -> LinearSystem:
        """The filter on a channel.

        Parameters
        ----------
        channel : str
            Name of input and output.
        dt : float, optional
            Sample time; None is continuous. [s]

        Returns
        -------
        filter : LinearSystem
            Two states. [SI]

        Raises
        ------
        ValueError
            If the centre is at or above the Nyquist frequency.

        References
        ----------
        G. F. Franklin, J. D. Powell and M. L. Workman, Digital Control of Dynamic Systems, 1998, section 6.1.

        Examples
        --------
        >>> notch = Notch(frequency=25.0, depth=0.1)("gyro_rad_s", 0.005)
        >>> z = np.exp(25j * 0.005)
        >>> H = notch.C @ np.linalg.solve(z * np.eye(2) - notch.A, notch.B) + notch.D
        >>> round(abs(complex(H[0, 0])), 12)
        0.1
        """
        w, a = self.frequency, 2.0 * self.damping * self.frequency
        # states scaled by w, so that both are of the size of the input
        A, B = [[0.0, w], [-w, -a]], [[0.0], [1.0]]
        return _filter(A, B, [[0.0, (self.depth - 1.0) * a]], [[1.0]], channel, "notch", dt, w)


@dataclass(frozen=True, kw_only=True)
class PhaseFilter:
    """Lead or lag of first order with unit gain and the wanted phase at one frequency.

    Attributes
    ----------
    frequency : float
        Where gain and phase are exact. [rad/s]
    phase : float
        Positive is lead, between -pi/2 and pi/2. [rad]
    """

    frequency: float
    phase: float

    def __post_init__(self) -> None:
        """Check the numbers."""
        _positive("frequency", self.frequency, "rad/s")
        if not abs(self.phase) < 0.5 * math.pi:
            raise ValueError(f"phase must be between -pi/2 and pi/2 [rad], got {self.phase}")

    def __call__(self, channel: str, dt: float | None = None) -> LinearSystem:
        """The filter on a channel.

        Parameters
        ----------
        channel : str
            Name of input and output.
        dt : float, optional
            Sample time; None is continuous. [s]

        Returns
        -------
        filter : LinearSystem
            One state. [SI]

        Raises
        ------
        ValueError
            If the frequency is at or above the Nyquist frequency.

        References
        ----------
        G. F. Franklin, J. D. Powell and A. Emami-Naeini, Feedback Control of Dynamic Systems, 2015, section 6.7 (lead
        compensation: spread (1 + sin phi)/(1 - sin phi) of zero and pole).

        Examples
        --------
        >>> lead = PhaseFilter(frequency=25.0, phase=0.5)("gyro_rad_s")
        >>> H = lead.C / (25j - lead.A) * lead.B + lead.D
        >>> round(abs(complex(H[0, 0])), 12), round(float(np.angle(H[0, 0])), 12)
        (1.0, 0.5)
        """
        spread = math.sqrt((1.0 + math.sin(self.phase)) / (1.0 - math.sin(self.phase)))
        zero, pole = self.frequency / spread, self.frequency * spread
        # pole/(frequency) (s + zero)/(s + pole), which is 1 in size at the frequency
        gain = spread
        return _filter([[-pole]], [[1.0]], [[gain * (zero - pole)]], [[gain]], channel, "phase", dt, self.frequency)


Filter = LowPass | Notch | PhaseFilter


def tustin(system: LinearSystem, dt: float, *, exact_at: float | None = None) -> LinearSystem:
    """Tustin's sampled form of a continuous controller or filter: s = g (z - 1)/(z + 1).

    Parameters
    ----------
    system : LinearSystem
        Continuous, any batch, without delay. [SI]
    dt : float
        Sample time. [s]
    exact_at : float, optional
        Frequency at which the response is exact (prewarping), below pi/dt; default 0. [rad/s]

    Returns
    -------
    sampled : LinearSystem
        With the same channels; states are those of the system. [SI]

    Raises
    ------
    ValueError
        If the system is sampled or delayed, or the frequency not below the Nyquist frequency.

    References
    ----------
    G. F. Franklin, J. D. Powell and M. L. Workman, Digital Control of Dynamic Systems, 1998, section 6.1.

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("y",), "outputs": ("u",)}
    >>> integral = LinearSystem(A=[[0.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> half = tustin(integral, 0.1)
    >>> half.A.tolist(), half.B.tolist(), half.D.tolist()
    ([[1.0]], [[0.1]], [[0.05]])
    """
    if system.dt is not None or system.input_delay_s:
        raise ValueError("only a continuous system without delay has a Tustin form")
    _positive("dt", dt, "s")
    if exact_at is None:
        h = 0.5 * dt
    elif not 0.0 < exact_at * dt < math.pi:
        raise ValueError(
            f"a filter at {exact_at:g} rad/s cannot be sampled every {dt:g} s: its frequency must be below the Nyquist "
            f"frequency of {math.pi / dt:g} rad/s"
        )
    else:
        h = math.tan(0.5 * exact_at * dt) / exact_at
    one = np.eye(len(system.states))
    inverse = np.linalg.inv(one - h * system.A)
    return replace(
        system,
        A=inverse @ (one + h * system.A),
        B=2.0 * h * inverse @ system.B,
        C=system.C @ inverse,
        D=system.D + h * system.C @ inverse @ system.B,
        dt=dt,
    )


def series(*systems: LinearSystem) -> LinearSystem:
    """Systems one after the other: the outputs of each are the inputs of the next, in order.

    Parameters
    ----------
    *systems : LinearSystem
        One condition each, all continuous or all of one sample time, without delay. [SI]

    Returns
    -------
    system : LinearSystem
        Inputs of the first, outputs of the last. [SI]

    Raises
    ------
    ValueError
        If there is none, channels do not fit in number, or sample times differ.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed. 2005, section 3.2 (cascade rule).

    Examples
    --------
    >>> series(LowPass(corner=1.0)("y"), LowPass(corner=2.0)("y")).A.tolist()
    [[-1.0, 0.0], [1.0, -2.0]]
    """
    if not systems:
        raise ValueError("series needs at least one system")
    whole = systems[0]
    for system in systems[1:]:
        if len(system.inputs) != len(whole.outputs) or system.dt != whole.dt:
            raise ValueError(
                f"systems in series must fit: {len(whole.outputs)} outputs at dt {whole.dt} meet {len(system.inputs)} "
                f"inputs at dt {system.dt}"
            )
        n, m = len(whole.states), len(system.states)
        A = np.zeros((n + m, n + m))
        A[:n, :n], A[n:, :n], A[n:, n:] = whole.A, system.B @ whole.C, system.A
        names = tuple(name if name not in whole.states else f"{name}_{n + i}" for i, name in enumerate(system.states))
        whole = LinearSystem(
            A=A,
            B=np.concatenate([whole.B, system.B @ whole.D]),
            C=np.concatenate([system.D @ whole.C, system.C], axis=1),
            D=system.D @ whole.D,
            states=(*whole.states, *names),
            inputs=whole.inputs,
            outputs=system.outputs,
            dt=whole.dt,
        )
    return whole


def _filter(
    A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike, channel: str, kind: str, dt: float | None, exact_at: float
) -> LinearSystem:
    """A filter on a channel, sampled where a sample time is given."""
    matrices: list[Array] = [np.asarray(x, dtype=float) for x in (A, B, C, D)]
    states = tuple(f"{channel}_{kind}_{i + 1}" for i in range(len(matrices[0])))
    system = LinearSystem(
        A=matrices[0], B=matrices[1], C=matrices[2], D=matrices[3], states=states, inputs=(channel,), outputs=(channel,)
    )
    return system if dt is None else tustin(system, dt, exact_at=exact_at)


def _positive(name: str, value: float, unit: str) -> None:
    """Refuse what is not positive."""
    if not 0.0 < value < math.inf:
        raise ValueError(f"{name} must be positive [{unit}], got {value}")
