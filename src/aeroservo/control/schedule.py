"""Gain schedules over dynamic pressure: designed in one batch, blended without bumps, checked between their points.

All points share the coordinates of their states (physical ones: measured channels, observed displacements and rates,
commands of some samples ago), so that matrices may be blended one by one. What is checked between points is frozen:
every flight condition by itself. A flight that changes fast against the controlled modes is for a simulation to judge.

Only dynamic pressure is scheduled. Along a line of design conditions with rising dynamic pressure (one altitude, or a
climb) that is exact at the points; at another density the same pressure comes with another airspeed, thus another
damping: `schedule_check` takes conditions at any altitude and says where that matters.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from aeroservo.control.closed_loop import closed_loop, loop_plant
from aeroservo.control.controller import Controller
from aeroservo.control.design import Design
from aeroservo.control.plant import design_plant
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, LinearSystem, frozen

MOST_POINTS = 2000
"""Most points of a schedule."""

SAME_POINT = 1e-9
"""Part of the highest pressure by which two points of a schedule must differ at least."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ScheduleCheck:
    """Frozen stability of a closed loop over flight conditions, at the points of a schedule and between them.

    Attributes
    ----------
    speeds : ndarray, shape (n,)
        True airspeeds that were checked. [m/s]
    pressures : ndarray, shape (n,)
        Dynamic pressures. [Pa]
    densities : ndarray, shape (n,)
        Air densities. [kg/m^3]
    decay : ndarray, shape (n,)
        Rate of the slowest root of the closed loop, negative where it is unstable. [1/s]
    frequency : ndarray, shape (n,)
        Frequency of that root. [rad/s]
    """

    speeds: Array
    pressures: Array
    densities: Array
    decay: Array
    frequency: Array

    def __post_init__(self) -> None:
        """Lock the arrays."""
        for name in ("speeds", "pressures", "densities", "decay", "frequency"):
            object.__setattr__(self, name, frozen(getattr(self, name), ndim=1, name=name))

    @property
    def stable(self) -> bool:
        """Whether every checked condition is stable. [-]"""
        return bool(np.all(self.decay > 0.0))

    @property
    def worst(self) -> int:
        """Number of the condition with the least decay. [-]"""
        return int(np.argmin(self.decay))

    def sentence(self) -> str:
        """The result in words, the worst condition named."""
        i = self.worst
        where = f"{self.speeds[i]:.4g} m/s ({self.pressures[i]:.4g} Pa, {self.densities[i]:.4g} kg/m^3)"
        what = f"{self.decay[i]:.3g} 1/s at {self.frequency[i]:.3g} rad/s"
        if self.stable:
            return f"stable at all {len(self.decay)} conditions checked; least decay {what}, at {where}"
        bad = int(np.sum(self.decay <= 0.0))
        return f"unstable at {bad} of {len(self.decay)} conditions checked; worst decay {what}, at {where}"


def design_schedule(
    model: AeroelasticModel,
    design: Callable[[LinearSystem], Design],
    conditions: FlightCondition,
    *,
    rate_Hz: float,
    delay_samples: float = 0.0,
    sensors: Sequence[str] | None = None,
    limits: Sequence[float] = (),
    gusts: bool = True,
) -> Controller:
    """A controller designed at every one of a row of conditions, scheduled by dynamic pressure.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces; its actuators, sensor lags and dead times are inside the plants.
    design : callable
        From a batch of sampled plants to a `Design` (`LQR`, `LQG`, ...).
    conditions : FlightCondition
        Shape (p,), p of 2 or more, of ascending dynamic pressure.
    rate_Hz : float
        Sample rate. [Hz]
    delay_samples : float
        Computing delay. [sample]
    sensors : sequence of str, optional
        What is measured; all outputs of the model if not given.
    limits : sequence of float, length n_out
        Largest magnitude of each command; those of the actuators if not given. [rad]
    gusts : bool
        Whether plants carry their gust inputs, from which designs with observers take the disturbance.

    Returns
    -------
    controller : Controller
        With one point for each condition. [SI]

    Raises
    ------
    ValueError
        If the conditions are no ascending row, or the design fails at one of them.

    References
    ----------
    Bramstång 2015, section 10.3 (a lookup table); contract.md, "Controller file (JSON)" (linear blending of matrices,
    held beyond the ends); W. J. Rugh and J. S. Shamma, Automatica 36(10), 2000, section 3.

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> from aeroservo.control.lqr import LQR
    >>> speeds = FlightCondition.at(0.0, V=np.linspace(50.0, 140.0, 4))
    >>> gains = LQR(Q=np.eye(6), R=np.eye(1))
    >>> design_schedule(build(read("bact")), gains, speeds, rate_Hz=200.0, delay_samples=1).pressures.round()
    array([ 1531.,  3920.,  7411., 12005.])
    """
    q = conditions.q
    if q.ndim != 1 or not 2 <= len(q) <= MOST_POINTS:
        raise ValueError(f"conditions of a schedule must be a row of 2 to {MOST_POINTS}, got shape {q.shape}")
    if np.any(np.diff(q) <= SAME_POINT * q[-1]):
        raise ValueError("conditions of a schedule must have ascending dynamic pressures [Pa]")
    if not rate_Hz > 0.0:
        raise ValueError(f"rate_Hz of a schedule must be positive [Hz], got {rate_Hz}")
    plant = design_plant(model, conditions, rate_Hz=rate_Hz, delay_samples=delay_samples, sensors=sensors, gusts=gusts)
    found = design(plant)
    names = found.controller.outputs
    return found.as_controller(
        delay_s=delay_samples / rate_Hz, limits=tuple(limits) or command_limits(model, names), pressures=q
    )


def command_limits(model: AeroelasticModel, outputs: Sequence[str]) -> tuple[float, ...]:
    """Largest command that the actuator behind each output lets through.

    Parameters
    ----------
    model : AeroelasticModel
        With its actuators.
    outputs : sequence of str
        Commands.

    Returns
    -------
    limits : tuple of float, length n_out
        Position limit over the actuator's gain; 0 where there is none. [rad]

    References
    ----------
    Project convention: a controller knows the limits of what it drives, so that its states hear of clipped commands.

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> command_limits(build(read("thesis-simulation")), ("elevon_rad",))
    (0.0,)
    """
    largest = {a.control: a.limit / abs(a.gain) for a in model.actuators if a.limit is not None and a.gain}
    return tuple(largest.get(name.removesuffix("_rad").removesuffix("_command"), 0.0) for name in outputs)


def schedule_check(
    model: AeroelasticModel, controller: Controller, conditions: FlightCondition, *, between: int = 4
) -> ScheduleCheck:
    """Close the loop of a schedule over conditions, and between neighbouring ones, and look for its slowest root.

    Parameters
    ----------
    model : AeroelasticModel
        The wing.
    controller : Controller
        Sampled; with or without a schedule.
    conditions : FlightCondition
        Shape (n,), in the order in which they neighbour; airspeed and density run straight between them.
    between : int
        Conditions between each pair of neighbours.

    Returns
    -------
    check : ScheduleCheck
        Decay at every condition, the given ones first to last with those between.

    Raises
    ------
    ValueError
        If the controller is continuous, or the conditions are no row.

    References
    ----------
    W. J. Rugh and J. S. Shamma, Automatica 36(10), 2000, section 3 (stability at fixed operating conditions; it says
    nothing of fast changes between them).

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> from aeroservo.control.controller import state_feedback
    >>> still = state_feedback([[0.0]], ("pitch_rate_rad_s",), ("elevon_command_rad",), 0.005)
    >>> speeds = FlightCondition.at(0.0, V=[20.0, 60.0])
    >>> schedule_check(build(read("thesis-simulation")), still, speeds, between=0).decay.round(2)
    array([ 2.18, -3.61])
    """
    if controller.dt_s is None:
        raise ValueError("the schedule to check must be sampled: dt_s [s]")
    if conditions.V.ndim != 1 or between < 0:
        raise ValueError(f"conditions must be a row and between at least 0, got {conditions.V.shape} and {between}")
    here = refined(conditions, between)
    loop = closed_loop(loop_plant(model, here, controller), controller, pressure=here.q)
    z = np.linalg.eigvals(loop.A)
    slowest = np.take_along_axis(z, np.abs(z).argmax(axis=-1)[:, None], axis=-1)[:, 0]
    s = np.log(np.where(slowest == 0.0, 1e-300, slowest).astype(complex)) / controller.dt_s
    return ScheduleCheck(speeds=here.V, pressures=here.q, densities=here.rho, decay=-s.real, frequency=np.abs(s.imag))


def refined(conditions: FlightCondition, between: int) -> FlightCondition:
    """A row of conditions with others between neighbours, airspeed and density on straight lines.

    Parameters
    ----------
    conditions : FlightCondition
        Shape (n,).
    between : int
        Conditions to put between each pair.

    Returns
    -------
    conditions : FlightCondition
        Shape (n + (n - 1) between,). [m/s, kg/m^3]

    References
    ----------
    Project convention: between two conditions of a sweep, airspeed and density are linear.

    Examples
    --------
    >>> refined(FlightCondition.at(0.0, V=[20.0, 60.0]), 3).V
    array([20., 30., 40., 50., 60.])
    """
    n = len(conditions.V)
    at = np.linspace(0.0, n - 1.0, (n - 1) * (between + 1) + 1)
    known = np.arange(n)
    V, rho, a = (np.interp(at, known, x) for x in (conditions.V, conditions.rho, conditions.a_sound))
    return FlightCondition(V=V, rho=rho, a_sound=a)


def switched(below: Controller, above: Controller, pressure: float) -> Controller:
    """One controller below a dynamic pressure and another from there on: a switch, as the thesis' adaptive controller.

    The states are handed over as they are, so both controllers must have states of the same meaning.

    Parameters
    ----------
    below, above : Controller
        Sampled alike, with the same channels and number of states, without schedules.
    pressure : float
        Highest dynamic pressure of the first. [Pa]

    Returns
    -------
    controller : Controller
        A schedule of two points, as close together as numbers can be. [SI]

    Raises
    ------
    ValueError
        If the two do not go together, or the pressure is not positive.

    References
    ----------
    Bramstång 2015, sections 9.4.8 and 10.3 (the switch at 50 m/s).

    Examples
    --------
    >>> from aeroservo.control.controller import state_feedback
    >>> soft, hard = (state_feedback([[k]], ("y",), ("u",), 0.1) for k in (1.0, 4.0))
    >>> switched(soft, hard, 1000.0).blend(np.array([1000.0, 1001.0]))[:, 1]
    array([0., 1.])
    """
    if not 0.0 < pressure < np.inf:
        raise ValueError(f"pressure of a switch must be positive [Pa], got {pressure}")
    pairs = [(getattr(below, n), getattr(above, n)) for n in ("inputs", "outputs", "dt_s", "delay_s", "limits")]
    alike = all(a == b for a, b in pairs) and below.A.shape == above.A.shape
    if not alike or below.dt_s is None or len(below.pressures) > 1:
        raise ValueError(
            "a switch needs two sampled controllers without schedules, with the same channels, sample time, delay, "
            "limits and number of states"
        )
    A, B, C, D, windup = (
        np.concatenate([getattr(below, name), getattr(above, name)]) for name in (*"ABCD", "windup")
    )  # fmt: skip
    at = np.array([pressure, np.nextafter(pressure, np.inf)])
    return replace(below, A=A, B=B, C=C, D=D, windup=windup, pressures=at)
