"""Rows of an aeroelastic model over the columns xi = [x, w, s, phi, 1]: plant, servo, sensors, outputs."""

from __future__ import annotations

import numpy as np

from aeroservo.aeroelastic.linear import PlantRows, check_control_terms, internal_states, state_matrix
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, LinearSystem, RationalAero
from aeroservo.servo import Actuator, Sensor
from aeroservo.simulate._kernels import CLIP, COSINE, PLAY, SPRING, TABLE


class ModelRows:
    """Rows of one model at a row of conditions; names and elements come with them.

    Attributes
    ----------
    stack : ndarray, shape (n_knot, n_x + n_phi + n_y, n_col)
        The rows. [SI]
    states, outputs, controls : list of str
        Names.
    kinds, parameters, element_names : list
        Nonlinear elements in order of evaluation.
    stops : list
        State of a surface, of its rate, largest deflection. [-, -, rad]
    """

    def __init__(
        self, model: AeroelasticModel, controller: LinearSystem | None, condition: FlightCondition, equilibrium: Array
    ) -> None:
        self.model, self.controller, self.condition = model, controller, condition
        aero, modes = model.aero, model.modes
        if not isinstance(aero, RationalAero):
            raise ValueError("a simulation needs rational air forces: fit the samples first (fit_rational)")
        self.aero, self.n, self.internal = aero, modes.n, internal_states(model)
        moved = {a.control: a for a in model.actuators}
        check_control_terms(model, moved)
        self.plant = PlantRows(model, condition)
        self.controls = [aero.inputs[j].name for j in self.plant.controls]
        self.actuators = [moved.get(name) for name in self.controls]
        self.lagging = [s for s in model.sensors if s.bandwidth is not None]
        self.continuous = controller is not None
        self.kinds: list[int] = []
        self.parameters: list[list[float]] = []
        self.element_names: list[str] = []
        self.stops: list[list[float]] = []
        self._count()
        self.knots = len(condition.V)
        self.at_rest = equilibrium if len(equilibrium) else np.zeros(self.n_x)
        self.Z = np.zeros((self.knots, self.n_x + self.n_phi, self.n_col))
        self.jump = self.plant.gust_rate
        self._kinematics()
        self._servo()
        self._plant()
        self._sensors()
        self.stack = np.concatenate([self.Z, self._outputs()], axis=1)

    def _count(self) -> None:
        """Names of states, number of elements, first columns of each block."""
        model = self.model
        names = [name.replace(" ", "_") for name in model.modes.names]
        units = model.modes.units
        self.displacements = [name + (f"_{unit}" if unit else "") for name, unit in zip(names, units)]
        self.rates = [f"{name}_rate" + (f"_{unit}_s" if unit else "_1_s") for name, unit in zip(names, units)]
        states = [*self.displacements, *self.rates, *self.internal]
        self.act_at: list[int | None] = []
        for name, actuator in zip(self.controls, self.actuators):
            self.act_at.append(None if actuator is None else len(states))
            if actuator is not None:
                states += [f"{name}_rad", f"{name}_rate_rad_s"][: actuator.order]
        self.lag_at = {s.name: len(states) + j for j, s in enumerate(self.lagging)}
        states += [f"{s.channel}_lagged" for s in self.lagging]
        self.ctrl_at = len(states)
        if self.controller is not None:
            states += [f"controller_{name}" for name in self.controller.states]
        self.states, self.n_x = states, len(states)
        self.zones, self.n_u = len(self.plant.gusts), len(self.controls)
        self.n_w = 2 * self.zones
        self.n_phi = len(model.springs) + (model.lift_curve is not None) + (model.gravity is not None)
        for actuator in self.actuators:
            if actuator is not None:
                self.n_phi += (actuator.rate_limit is not None) + (actuator.backlash > 0.0)
                self.n_phi += self.continuous and actuator.limit is not None
        self.s_at = self.n_x + self.n_w
        self.phi_at = self.s_at + 2 * self.n_u
        self.n_col = self.phi_at + self.n_phi + 1

    def _row(self) -> Array:
        """An empty row at every knot."""
        return np.zeros((self.knots, self.n_col))

    def _unit(self, column: int, value: float = 1.0) -> Array:
        row = self._row()
        row[:, column] = value
        return row

    def _element(self, kind: int, argument: Array, parameters: list[float], name: str) -> Array:
        """Add an element; the row that is its value."""
        j = len(self.kinds)
        self.Z[:, self.n_x + j] = argument
        self.kinds.append(kind)
        self.parameters.append(parameters)
        self.element_names.append(name)
        return self._unit(self.phi_at + j)

    def _kinematics(self) -> None:
        """Rows of displacement and true rate over the columns; the rate holds the jump of the gust."""
        n = self.n
        self.q = np.zeros((self.knots, n, self.n_col))
        self.v = np.zeros((self.knots, n, self.n_col))
        self.q[:, np.arange(n), np.arange(n)] = 1.0
        self.v[:, np.arange(n), n + np.arange(n)] = 1.0
        self.v[:, :, self.n_x : self.n_x + self.zones] = self.jump[:, n : 2 * n]
        self.Z[:, :n] = self.v

    def _servo(self) -> None:
        """Actuators: rows of deflection, rate and acceleration of every control, and of its raw command."""
        self.delta, self.delta_rate, self.delta_acceleration, self.command = [], [], [], []
        for j, (name, actuator) in enumerate(zip(self.controls, self.actuators)):
            raw = self._unit(self.s_at + self.n_u + j)
            effective = self._unit(self.s_at + j)
            if self.controller is not None:
                raw = raw + self._feedback(name)
                gain = 1.0 if actuator is None else actuator.gain
                effective = gain * raw
                if actuator is not None and actuator.limit is not None:
                    effective = self._element(CLIP, effective, [actuator.limit], f"{name} command limit")
            self.command.append(raw)
            at = self.act_at[j]
            if actuator is None or at is None:
                self.delta.append(effective)
                self.delta_rate.append(self._row())
                self.delta_acceleration.append(self._row())
                continue
            self._actuator(name, actuator, at, effective)

    def _actuator(self, name: str, a: Actuator, at: int, effective: Array) -> None:
        """Rows of one actuator's states, its stop, its play."""
        deflection, w = self._unit(at), a.omega
        pull = (w if a.zeta is None else w / (2.0 * a.zeta)) * (effective - deflection)
        if a.rate_limit is not None:
            pull = self._element(CLIP, pull, [a.rate_limit], f"{name} rate limit")
        if a.zeta is None:
            self.Z[:, at] = pull
            rate, acceleration = pull, self._row()
        else:
            rate = self._unit(at + 1)
            acceleration = 2.0 * a.zeta * w * (pull - rate)
            self.Z[:, at], self.Z[:, at + 1] = rate, acceleration
        if a.limit is not None and a.zeta is not None:
            self.stops.append([at, at + 1, a.limit])
        if a.backlash > 0.0:
            j = self.controls.index(name)
            terms = [x[..., j] for x in (self.plant.delta_rate, self.plant.delta_acceleration)]
            if any(np.any(x) for x in terms):
                raise ValueError(f"backlash of {name!r}: the control has rate or inertia terms, which play has not")
            deflection = self._element(PLAY, deflection, [a.backlash], f"{name} backlash")
        self.delta.append(deflection)
        self.delta_rate.append(rate)
        self.delta_acceleration.append(acceleration)

    def _feedback(self, control: str) -> Array:
        """Row of the output of a continuous controller that drives a control; fills the controller's states."""
        c = self.controller
        assert c is not None
        inputs = np.stack([self._measured(name) for name in c.inputs], axis=1)
        here = slice(self.ctrl_at, self.ctrl_at + len(c.states))
        state = np.zeros((self.knots, len(c.states), self.n_col))
        state[:, np.arange(len(c.states)), np.arange(here.start, here.stop)] = 1.0
        self.Z[:, here] = c.A @ state + c.B @ inputs
        outputs = c.C @ state + c.D @ inputs
        row = self._row()
        for i, name in enumerate(c.outputs):
            if name in (f"{control}_command_rad", f"{control}_rad"):
                row = row + outputs[:, i]
        return row

    def _measured(self, name: str) -> Array:
        """Row of a channel that a continuous controller may read: nothing that depends on accelerations."""
        for names, rows in ((self.displacements, self.q), (self.rates, self.v)):
            if name in names:
                return self._from_rest(rows[:, names.index(name)])
        for control, at in zip(self.controls, self.act_at):
            if at is not None and name == f"{control}_rad":  # the actuator's own, ahead of any play
                return self._unit(at)
        for sensor in self.model.sensors:
            if name in (sensor.name, sensor.channel):
                if sensor.bandwidth is not None:
                    return self._unit(self.lag_at[sensor.name])
                if len(sensor.acceleration):
                    raise ValueError(
                        f"a continuous controller cannot read the accelerometer {name!r} without a bandwidth: give the "
                        "sensor bandwidth_rad_s, or sample the controller (dt_s)"
                    )
                return self._sensor_row(sensor, None)
        raise ValueError(f"the controller reads {name!r}, which is not measured; channels: {', '.join(self.channels)}")

    @property
    def channels(self) -> list[str]:
        """What a controller may read. [-]"""
        moved = [f"{control}_rad" for control, at in zip(self.controls, self.act_at) if at is not None]
        return [*self.displacements, *self.rates, *moved, *(s.channel for s in self.model.sensors)]

    def _from_rest(self, row: Array) -> Array:
        """The same row, measured from the equilibrium."""
        row = row.copy()
        row[:, -1] -= row[:, : self.n_x] @ self.at_rest
        return row

    def _plant(self) -> None:
        """Accelerations and lags."""
        n, model = self.n, self.model
        n_plant = 2 * n + len(self.internal)
        A = state_matrix(model, self.condition, keep=np.ones(n, dtype=bool))
        rows = np.zeros((self.knots, n_plant, self.n_col))
        rows[:, n:, :n_plant] = A[:, n:]
        rows[:, n:, self.n_x : self.n_x + self.zones] = (self.plant.gust + A @ self.jump)[:, n:]
        for j in range(self.n_u):
            effects = (
                (self.plant.delta, self.delta),
                (self.plant.delta_rate, self.delta_rate),
                (self.plant.delta_acceleration, self.delta_acceleration),
            )
            for effect, source in effects:
                rows[:, n:] += effect[:, n:, j, None] * source[j][:, None]
        self.inverse = np.broadcast_to(self.plant.inverse, (self.knots, n, n))
        self._nonlinear(rows)
        self.Z[:, n:n_plant] = rows[:, n:]

    def _nonlinear(self, rows: Array) -> None:
        """Springs, stall, weight: forces on the modes."""
        n, model, aero = self.n, self.model, self.aero
        V, q_bar = self.condition.V[:, None], self.condition.q[:, None]

        def push(force: Array, row: Array) -> None:
            """Add inverse mass times a force (n,) or (n_knot, n), times a row."""
            acceleration = np.einsum("kij,kj->ki", self.inverse, np.broadcast_to(force, (self.knots, n)))
            rows[:, n : 2 * n] += acceleration[..., None] * row[:, None]

        for spring in model.springs:
            i = model.modes.names.index(spring.mode)
            linear = float(model.modes.K[i, i])
            K = spring.stiffness
            if K is None:
                if not spring.polynomial[0]:
                    raise ValueError(f"spring of {spring.mode!r}: c0 = 0 needs the spring's own stiffness")
                K = linear / spring.polynomial[0]
            own = K * spring.polynomial[0]
            parameters = [own, spring.freeplay, K, float(len(spring.polynomial)), *spring.polynomial]
            value = self._element(SPRING, self.q[:, i], parameters, f"{spring.mode} spring")
            push(np.eye(n)[i], value)
        if model.lift_curve is not None:
            c = model.lift_curve
            if self.zones > 1:
                raise ValueError("a lift curve needs one gust zone: the incidence of several is not one number")
            alpha = np.einsum("i,kic->kc", c.displacement, self.q)
            alpha = alpha + aero.b / V * np.einsum("i,kic->kc", c.rate, self.v)
            alpha[:, -1] += model.incidence
            if self.zones:
                alpha[:, self.n_x] += 1.0 / V[:, 0]
            parameters = [c.CL0, c.CL_alpha, float(len(c.alpha)), *c.alpha, *c.CL]
            push(q_bar * np.array(c.direction), self._element(TABLE, alpha, parameters, "lift curve"))
        if model.gravity is not None:
            g = model.gravity
            turned = self._element(COSINE, self.q[:, model.modes.names.index(g.mode)], [], "gravity on pitch")
            one = self._unit(self.n_col - 1)
            push(np.array(g.turning), turned + one)
            push(np.array(g.steady), one)
            A0 = aero.matrices(self.condition.mach)[0]
            for name, size in (("camber", 1.0), ("incidence", model.incidence)):
                column = model.column(name)
                if column is not None and size:
                    push(q_bar * np.asarray(A0)[..., column] * size, one)

    def _sensors(self) -> None:
        """Lags of the sensors that have a bandwidth."""
        n = self.n
        self.acceleration = self.Z[:, n : 2 * n].copy()
        rates = slice(self.n_x + self.zones, self.n_x + 2 * self.zones)
        self.acceleration[:, :, rates] += self.jump[:, n : 2 * n]
        for sensor in self.lagging:
            at = self.lag_at[sensor.name]
            value = self._sensor_row(sensor, self.acceleration)
            assert sensor.bandwidth is not None
            self.Z[:, at] = sensor.bandwidth * (value - self._unit(at))

    def _sensor_row(self, sensor: Sensor, acceleration: Array | None) -> Array:
        """What a sensor feels, before its lag: displacements from the equilibrium; at rest there is no acceleration."""
        row = self._row()
        for weights, source in (
            (sensor.displacement, self.q),
            (sensor.rate, self.v),
            (sensor.acceleration, acceleration),
        ):
            if len(weights) and source is not None:
                felt = np.einsum("i,kic->kc", np.asarray(weights), source)
                row = row + (self._from_rest(felt) if source is self.q else felt)
        return row

    def _outputs(self) -> Array:
        """Rows of all outputs, from the equilibrium."""
        names = [*self.displacements, *self.rates]
        rows = [*map(self._from_rest, np.moveaxis(self.q, 1, 0)), *np.moveaxis(self.v, 1, 0)]
        for name, delta, command in zip(self.controls, self.delta, self.command):
            names += [f"{name}_rad", f"{name}_command_rad"]
            rows += [delta, command]
        for j, column in enumerate(self.plant.gusts):
            names.append(f"{self.aero.inputs[column].name}_m_s")
            rows.append(self._unit(self.n_x + j))
        if "plunge" in self.model.modes.names:
            names.append("acceleration_m_s2")
            rows.append(self.acceleration[:, self.model.modes.names.index("plunge")])
        for sensor in self.model.sensors:
            names.append(sensor.channel)
            lagged = sensor.bandwidth is not None
            rows.append(self._unit(self.lag_at[sensor.name]) if lagged else self._sensor_row(sensor, self.acceleration))
        self.outputs = names
        return np.stack(rows, axis=1)


def equilibrium(rows: ModelRows) -> Array:
    """State at rest without gust and command, by Newton's method; zero where nothing loads the model.

    Parameters
    ----------
    rows : ModelRows
        At one condition.

    Returns
    -------
    x : ndarray, shape (n_x,)
        Where x' = 0. [SI]

    Raises
    ------
    ValueError
        If there is no such state, or it is not found.
    """
    from aeroservo.simulate._kernels import element

    n_x, n_phi, n_col = rows.n_x, rows.n_phi, rows.n_col
    Z, x = rows.stack[0], np.zeros(rows.n_x)
    xi = np.zeros(n_col)
    xi[-1] = 1.0

    def slope(x: Array, width: float) -> tuple[Array, Array]:
        """x' and its Jacobian, the elements by central differences of a width."""
        xi[:n_x] = x
        gradient = np.zeros((n_phi, n_x))
        for j in range(n_phi):
            row = Z[n_x + j]
            y = float(row @ xi)
            parameters = np.zeros((1, max(8, len(rows.parameters[j]))))
            parameters[0, : len(rows.parameters[j])] = rows.parameters[j]
            step = width * max(1.0, abs(y))
            xi[rows.phi_at + j] = element(rows.kinds[j], y, parameters, 0, 0.0)
            up, down = (element(rows.kinds[j], y + d, parameters, 0, 0.0) for d in (step, -step))
            inner = row[:n_x] + row[rows.phi_at : rows.phi_at + n_phi] @ gradient
            gradient[j] = (up - down) / (2.0 * step) * inner
        return Z[:n_x] @ xi, Z[:n_x, :n_x] + Z[:n_x, rows.phi_at : rows.phi_at + n_phi] @ gradient

    if not np.any(slope(x, 1e-6)[0]):
        return x
    for width in (1e-6, 1e-2, 1e-1, 1.0):  # Newton; where play or stall make it wander, chords that span them
        x = np.zeros(n_x)
        for _ in range(100):
            rate, J = slope(x, width)
            if np.linalg.cond(J) > 1e14:
                break
            move = np.linalg.solve(J, -rate)
            x = x + move
            if not np.all(np.isfinite(x)):
                break
            if np.abs(move).max() <= 1e-13 * max(1e-3, np.abs(x).max()):
                return x
    if np.linalg.cond(slope(np.zeros(n_x), 1.0)[1]) > 1e14:
        raise ValueError("the model has no equilibrium at the start: nothing carries its weight or its steady lift")
    raise ValueError("the equilibrium at the start was not found: check the nonlinear springs and the lift curve")
