"""Any aeroelastic model as a linear system from the gust to its channels: what peaks and RMS are computed on.

The rows are those that the simulation engine steps, so the channels, the actuators, the sensors and a continuous
controller are the same and mean the same. Springs, stall and weight are left out: it is the response about the
equilibrium. Limits and play of actuators count as not reached.

Added to the engine's channels, where the model has them: deflection, twist and acceleration of the tip
(`tip_plunge_m`, `tip_twist_rad`, `tip_acceleration_m_s2`), and the internal loads of `studies.root_loads`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.control.controller import Controller
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, LinearSystem, RationalAero
from aeroservo.simulate.assemble import Stepper, linear_stepper, stepper
from aeroservo.simulate.engine import linearised
from aeroservo.studies.root_loads import AirRows, LoadRows

#: Columns of A below this part of its largest entry are nothing: the state drifts.
NOTHING = 1e-13


@dataclass(frozen=True, kw_only=True, eq=False)
class GustPlant:
    """x' = A x + B w, y = C x + D w + rate w', with w the upward gust velocity at each zone.

    Attributes
    ----------
    A, B, C, D, rate : ndarray, shapes (n, n), (n, m), (n_y, n), (n_y, m), (n_y, m)
        [SI]
    outputs : tuple of str
        Channels, the unit as suffix.
    x_offset : ndarray, shape (m,)
        Distance of each zone aft of the reference point. [m]
    V : float
        True airspeed. [m/s]
    drifting : tuple of str
        Displacements that nothing brings back; left out of the outputs.
    notes : tuple of str
        What was left out.
    commands : tuple of str
        Commands that a sampled controller may hold.
    B_command, D_command : ndarray, shapes (n, n_u) and (n_y, n_u)
        Their effect on states and channels. [SI]
    command_delay : float
        Dead time of the actuators. [s]
    """

    A: Array
    B: Array
    C: Array
    D: Array
    rate: Array
    outputs: tuple[str, ...]
    x_offset: Array
    V: float
    drifting: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    commands: tuple[str, ...] = ()
    B_command: Array = None  # type: ignore[assignment]
    D_command: Array = None  # type: ignore[assignment]
    command_delay: float = 0.0

    @property
    def matrices(self) -> tuple[Array, Array, Array, Array]:
        """A, B, C, D. [SI]"""
        return self.A, self.B, self.C, self.D

    @property
    def growth(self) -> float:
        """Largest real part of an eigenvalue: negative is stable. [1/s]"""
        return float(np.linalg.eigvals(self.A).real.max(initial=-np.inf))


def gust_plant(
    model: AeroelasticModel | LinearSystem,
    condition: FlightCondition,
    *,
    controller: Controller | None = None,
    loads: LoadRows | None = None,
) -> GustPlant:
    """The linear system from gust velocities to channels at one flight condition.

    Parameters
    ----------
    model : AeroelasticModel or LinearSystem
        With rational air forces; of a linear system the inputs named `gust...` are gusts [m/s].
    condition : FlightCondition
        One condition, shape ().
    controller : Controller, optional
        A continuous one that closes the loop; for a sampled one see `sampled_gust_loads`.
    loads : LoadRows, optional
        Internal loads to be added to the channels, from `with_loads`, which made the model as well.

    Returns
    -------
    plant : GustPlant
        Without the displacements that nothing brings back (heave of a free wing).

    Raises
    ------
    ValueError
        If the model feels no gust, has no state space, or the controller is sampled.
    """
    if condition.V.ndim:
        raise ValueError(f"one flight condition is wanted, got shape {condition.V.shape}")
    inside = None if controller is None else controller.continuous
    if controller is not None and inside is None:
        raise ValueError(
            f"this plant takes a continuous controller (dt_s null), this one is sampled every {controller.dt_s} s: "
            "use `sampled_gust_loads`"
        )
    if isinstance(model, LinearSystem):
        if inside is not None:
            raise ValueError("a controller needs an aeroelastic model, this is a linear system")
        s = linear_stepper(model)
    else:
        s = stepper(linearised(model), condition, inside)
    if not s.inputs:
        raise ValueError("the model has no gust input: its air forces have no gust column")
    rows, names, notes = _linear(s, condition)
    n, m, live = len(s.states), len(s.inputs), len(s.states) + 2 * len(s.inputs)
    A, B, B_rate = rows[:n, :n], rows[:n, n : n + m], rows[:n, n + m : live]
    out = rows[n:]
    if not isinstance(model, LinearSystem):
        if np.all(model.aero.mach == 0.0) and float(condition.mach) > 0.3:
            notes.append("speeds above Mach 0.3: incompressible theory")
        if model.springs or model.lift_curve is not None:
            notes.append("nonlinear springs and stall are left out: it is the linear response about the equilibrium")
        extra, more = _tip_and_loads(model, condition, s, rows, loads)
        out, names = np.concatenate([out, extra]), [*names, *more]
    C, D, rate = out[:, :n], out[:, n : n + m], out[:, n + m : live]
    # a rate that drives the states (a lagging accelerometer) is taken into the state: x - B_rate w
    plant = GustPlant(
        A=A,
        B=B + A @ B_rate,
        C=C,
        D=D + C @ B_rate,
        rate=rate,
        outputs=tuple(names),
        x_offset=s.offsets,
        V=float(condition.V),
        notes=tuple(notes),
        commands=s.commands,
        B_command=rows[:n, live:],
        D_command=out[:, live:],
        command_delay=float(s.delays_s.max(initial=0.0)),
    )
    return _without_drift(plant, s.states)


def _linear(s: Stepper, condition: FlightCondition) -> tuple[Array, list[str], list[str]]:
    """Rows of states and outputs over the columns [x, w, w', commands], elements taken as straight lines."""
    Z = s.rows(condition[None])[0]
    n_x, n_w, n_s, n_phi, _ = s.sizes
    live, first, n_u = n_x + n_w, n_x + n_w + n_s, n_s // 2
    held = Z[:, live : live + n_u] * s.gains + Z[:, live + n_u : first]  # what acts, and what is asked for
    own = np.concatenate([Z[:, :live], held], axis=1)
    values = np.zeros((n_phi, live + n_u))
    for j in range(n_phi):
        values[j] = own[n_x + j] + Z[n_x + j, first : first + j] @ values[:j]
    rows = own + Z[:, first : first + n_phi] @ values
    keep = [*range(n_x), *range(n_x + n_phi, len(Z))]
    notes = [f"{name} is taken as not reached: the response is linear" for name in s.elements.names]
    if not isinstance(s.model, LinearSystem) and np.any(s.delays_s) and s.controller is not None:
        notes.append("the dead time of the actuators is left out of a continuous loop")
    return rows[keep], list(s.outputs), notes


def _tip_and_loads(
    model: AeroelasticModel, condition: FlightCondition, s: Stepper, rows: Array, loads: LoadRows | None
) -> tuple[Array, list[str]]:
    """Rows of the elastic motion of the tip and of internal loads."""
    from aeroservo.structure.modal import tip_motion

    n, n_x, m = model.modes.n, len(s.states), len(s.inputs)
    q, rate, acceleration = np.eye(n, rows.shape[1]), rows[:n], rows[n : 2 * n].copy()
    acceleration[:, n_x + m : n_x + 2 * m] += rate[:, n_x : n_x + m]  # the jump of the rates follows the gust
    out: list[Array] = []
    names: list[str] = []
    if len(model.modes.grid) and "plunge" not in model.modes.names:
        elastic = np.any(model.modes.K != 0.0, axis=0)
        h, twist = tip_motion(model.modes)
        out += [(elastic * h) @ q, h @ acceleration, (elastic * twist) @ q]
        names += ["tip_plunge_m", "tip_acceleration_m_s2", "tip_twist_rad"]
    if loads is not None and loads.names:
        if loads.springs.shape[1] != n:
            raise ValueError(f"loads {loads.names} must have a column for each of {n} modes")
        found = loads.springs @ q + loads.inertia @ acceleration
        if loads.air is not None:
            found = found + _air_loads(model, condition, s, rows, loads.air, (q, rate, acceleration))
        out += [*found]
        names += loads.names
    return np.array(out).reshape(-1, rows.shape[1]), names


def _air_loads(
    model: AeroelasticModel,
    condition: FlightCondition,
    s: Stepper,
    rows: Array,
    air: AirRows,
    motion: tuple[Array, Array, Array],
) -> Array:
    """Air forces of internal loads; their lags are the states behind the rates. Controls act by their angle."""
    aero, n, n_x = model.aero, model.modes.n, len(s.states)
    assert isinstance(aero, RationalAero)
    V, rho, q_bar, b = float(condition.V), float(condition.rho), float(condition.q), aero.b
    q, rate, acceleration = motion
    found = q_bar * air.A0[:, :n] @ q + 0.5 * rho * V * b * air.A1[:, :n] @ rate
    found = found + 0.5 * rho * b**2 * air.A2[:, :n] @ acceleration
    found[:, 2 * n : 2 * n + len(aero.lags)] += q_bar * air.lag_D
    for j, zone in enumerate(aero.columns("gust")):
        found[:, n_x + j] += q_bar / V * (air.A0[:, zone] + air.lag_D @ aero.lag_E[:, zone])
    for control in aero.columns("control"):
        deflection = rows[n_x + s.outputs.index(f"{aero.inputs[control].name}_rad")]
        found = found + q_bar * np.outer(air.A0[:, control] + air.lag_D @ aero.lag_E[:, control], deflection)
    return found


def _without_drift(plant: GustPlant, states: tuple[str, ...]) -> GustPlant:
    """Without the states that nothing depends on, and the outputs that are made of them."""
    scale = np.abs(plant.A).max(initial=0.0)
    free = np.abs(plant.A).max(axis=0, initial=0.0) <= NOTHING * scale
    felt = np.abs(plant.C[:, free]).max(axis=1, initial=0.0) > 0.0
    if not np.any(free):
        return plant
    kept = ~free
    names = tuple(name for name, gone in zip(plant.outputs, felt) if gone)
    return GustPlant(
        A=plant.A[np.ix_(kept, kept)],
        B=plant.B[kept],
        C=plant.C[np.ix_(~felt, kept)],
        D=plant.D[~felt],
        rate=plant.rate[~felt],
        outputs=tuple(name for name, gone in zip(plant.outputs, felt) if not gone),
        x_offset=plant.x_offset,
        V=plant.V,
        drifting=names,
        commands=plant.commands,
        B_command=plant.B_command[kept],
        D_command=plant.D_command[~felt],
        command_delay=plant.command_delay,
        notes=(*plant.notes, f"{', '.join(names)}: nothing brings it back, so it has neither a peak nor an RMS"),
    )
