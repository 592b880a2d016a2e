"""From an aeroelastic model, its servo and a continuous controller to the rows that the compiled engine steps.

Columns are xi = [x, w, s, phi, 1]; states x = [displacements, rates less the jump of the gust, lags, actuators, sensor
lags, controller]. Every row is a stack over flight conditions (knots), linear between them in the engine.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, LinearSystem, RationalAero
from aeroservo.simulate._kernels import CLIP, PLAY, SPRING, TABLE
from aeroservo.simulate.rows import ModelRows, equilibrium


@dataclass(frozen=True, kw_only=True, eq=False)
class Elements:
    """Nonlinear elements in the order in which they are evaluated.

    Attributes
    ----------
    kinds : int ndarray, shape (n_phi,)
        Codes of `_kernels`.
    parameters : ndarray, shape (n_phi, n_par)
        Numbers of each, padded. [SI]
    names : tuple of str
        What each is.
    """

    kinds: Array
    parameters: Array
    names: tuple[str, ...]

    @property
    def smooth(self) -> bool:
        """Whether all derivatives exist: no clip, play, gap or table. [-]"""
        gap = (self.kinds == SPRING) & (self.parameters[:, 1] > 0.0) if len(self.kinds) else np.zeros(0, bool)
        return not np.any(np.isin(self.kinds, (CLIP, PLAY, TABLE)) | gap)


@dataclass(frozen=True, kw_only=True, eq=False)
class Stepper:
    """What the engine needs of a model: names, sizes, elements; rows come from `rows`.

    Attributes
    ----------
    model : AeroelasticModel or LinearSystem
        What is stepped.
    controller : LinearSystem, optional
        The continuous controller inside the rows.
    states, inputs, commands, outputs : tuple of str
        Names of x, of the gusts w, of the controls, of the outputs; units as suffixes.
    elements : Elements
        Nonlinear elements.
    stops : ndarray, shape (n_stop, 3)
        State of a surface, of its rate (or -1), largest deflection. [-, -, rad]
    gains : ndarray, shape (n_u,)
        Of the actuators, applied to the held command. [-]
    command_limits : ndarray, shape (n_u,)
        Largest held command after the gain; 0 is none. [rad]
    delays_s : ndarray, shape (n_u,)
        Dead time of each actuator. [s]
    offsets : ndarray, shape (n_w,)
        Distance of each gust zone behind the reference point. [m]
    equilibrium : ndarray, shape (n_x,)
        State at rest at the first condition, from which outputs are measured. [SI]
    """

    model: AeroelasticModel | LinearSystem
    controller: LinearSystem | None
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    commands: tuple[str, ...]
    outputs: tuple[str, ...]
    elements: Elements
    stops: Array
    gains: Array
    command_limits: Array
    delays_s: Array
    offsets: Array
    equilibrium: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def sizes(self) -> tuple[int, int, int, int, int]:
        """n_x, n_w, n_s, n_phi, n_y. [-]"""
        n_phi = len(self.elements.kinds)
        return len(self.states), 2 * len(self.inputs), 2 * len(self.commands), n_phi, len(self.outputs)

    def rows(self, condition: FlightCondition) -> Array:
        """The stack of rows at conditions of shape (n_knot,), shape (n_knot, n_x + n_phi + n_y, n_col). [SI]"""
        if isinstance(self.model, LinearSystem):
            return _linear_rows(self.model)
        return ModelRows(self.model, self.controller, condition, self.equilibrium).stack


def stepper(model: AeroelasticModel, condition: FlightCondition, controller: LinearSystem | None = None) -> Stepper:
    """Prepare a model for the engine.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces and no hysteretic damping.
    condition : FlightCondition
        Where the run starts, shape (): its equilibrium is the zero of the outputs.
    controller : LinearSystem, optional
        A continuous controller (dt None, no delay); a sampled one is not part of the rows.

    Returns
    -------
    stepper : Stepper
        Names, elements and the function that makes rows.

    Raises
    ------
    ValueError
        If the model has no state space, a control lacks the actuator it needs, backlash meets rate or inertia terms, or
        a continuous controller reads an accelerometer without bandwidth.
    """
    first = condition[None] if condition.V.ndim == 0 else condition[:1]
    rows = ModelRows(model, controller, first, np.zeros(0))
    rest = _rest(model, controller, first)
    aero = model.aero
    assert isinstance(aero, RationalAero)
    moved = {a.control: a for a in model.actuators}
    controls = [aero.inputs[j].name for j in aero.columns("control")]
    held = [None if rows.continuous else moved.get(name) for name in controls]
    width = max([5, *(len(p) for p in rows.parameters)])
    parameters = np.zeros((len(rows.kinds), width))
    for row, numbers in enumerate(rows.parameters):
        parameters[row, : len(numbers)] = numbers
    return Stepper(
        model=model,
        controller=controller,
        states=tuple(rows.states),
        inputs=tuple(f"{aero.inputs[j].name}_m_s" for j in aero.columns("gust")),
        commands=tuple(f"{name}_command_rad" for name in controls),
        outputs=tuple(rows.outputs),
        elements=Elements(
            kinds=np.array(rows.kinds, dtype=np.int64), parameters=parameters, names=tuple(rows.element_names)
        ),
        stops=np.array(rows.stops, dtype=float).reshape(-1, 3),
        gains=np.array([1.0 if a is None else a.gain for a in held]),
        command_limits=np.array([0.0 if a is None or a.limit is None else a.limit for a in held]),
        delays_s=np.array([0.0 if a is None else a.delay_s for a in held]),
        offsets=np.array([aero.inputs[j].x_offset for j in aero.columns("gust")]),
        equilibrium=rest,
    )


def _rest(model: AeroelasticModel, controller: LinearSystem | None, first: FlightCondition) -> Array:
    """State at rest with an idle controller: it, and sensors that lag, read from there, so their states are zero."""
    rest = equilibrium(ModelRows(model, None, first, np.zeros(0)))
    rest = equilibrium(ModelRows(model, None, first, rest))  # measured from the equilibrium, lags are empty
    return np.concatenate([rest, np.zeros(0 if controller is None else len(controller.states))])


def linear_stepper(system: LinearSystem) -> Stepper:
    """Prepare a linear model at one flight condition for the engine: its inputs are held commands, or gusts [m/s].

    Parameters
    ----------
    system : LinearSystem
        Continuous, without delay, one condition. Inputs named `gust...` are gusts.

    Returns
    -------
    stepper : Stepper
        Without nonlinear elements.

    Raises
    ------
    ValueError
        If the system is a batch, sampled or delayed.
    """
    if system.A.ndim != 2 or system.dt is not None or system.input_delay_s:
        raise ValueError("a linear model to simulate must be one continuous system without delay")
    gusts = tuple(name for name in system.inputs if name.startswith("gust"))
    commands = tuple(name for name in system.inputs if not name.startswith("gust"))
    n_u = len(commands)
    return Stepper(
        model=system,
        controller=None,
        states=system.states,
        inputs=gusts,
        commands=commands,
        outputs=_linear_outputs(system),
        elements=Elements(kinds=np.zeros(0, np.int64), parameters=np.zeros((0, 5)), names=()),
        stops=np.zeros((0, 3)),
        gains=np.ones(n_u),
        command_limits=np.zeros(n_u),
        delays_s=np.zeros(n_u),
        offsets=np.zeros(len(gusts)),
        equilibrium=np.zeros(len(system.states)),
    )


def _linear_outputs(system: LinearSystem) -> tuple[str, ...]:
    """States, inputs, then the outputs that are not among them."""
    known = (*system.states, *system.inputs)
    return (*known, *(name for name in system.outputs if name not in known))


def _linear_rows(system: LinearSystem) -> Array:
    """Rows of a linear model, shape (1, n_x + n_y, n_col)."""
    n = len(system.states)
    gust = [j for j, name in enumerate(system.inputs) if name.startswith("gust")]
    command = [j for j in range(len(system.inputs)) if j not in gust]
    at = {j: n + i for i, j in enumerate(gust)} | {j: n + 2 * len(gust) + i for i, j in enumerate(command)}
    names = _linear_outputs(system)
    Z = np.zeros((1, n + len(names), n + 2 * len(gust) + 2 * len(command) + 1))
    columns = [at[j] for j in range(len(system.inputs))]
    Z[0, :n, :n], Z[0, :n, columns] = system.A, system.B.T
    for row, name in enumerate(names, n):
        if name in system.states:
            Z[0, row, system.states.index(name)] = 1.0
        elif name in system.inputs:
            Z[0, row, columns[system.inputs.index(name)]] = 1.0
        else:
            i = system.outputs.index(name)
            Z[0, row, :n], Z[0, row, columns] = system.C[i], system.D[i]
    return Z
