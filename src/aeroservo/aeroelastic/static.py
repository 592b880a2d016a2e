"""Static aeroelasticity: divergence, reversal, effectiveness, trim and twist."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.aeroelastic.static_speed import StaticSpeed, at_own_mach, lowest_pressure, within_limit
from aeroservo.atmosphere import STANDARD_GRAVITY
from aeroservo.datatypes import AeroelasticModel, FlightCondition
from aeroservo.structure.modal import tip_motion

Array = NDArray[Any]


@dataclass(frozen=True, kw_only=True, eq=False)
class StaticResult:
    """What `static` found; nan where a quantity has no meaning (past divergence, or not in the model).

    Attributes
    ----------
    V : ndarray, shape (n_V,)
        Speeds of the sweep. [m/s]
    divergence, reversal : StaticSpeed
        Lowest of each. [Pa, m/s]
    reversal_quantity : str or None
        "roll" or "lift": what an elevon no longer gives.
    effectiveness : ndarray, shape (n_V,)
        Elastic over rigid steady roll rate per elevon angle (lift per elevon angle where the model
        cannot roll). [-]
    moment_effectiveness : ndarray, shape (n_V,)
        Elastic over rigid rolling moment (or lift) with roll (or pitch) held. [-]
    twist : ndarray, shape (n_V,)
        Elastic twist about the flexural axis, of the tip where there is one, per radian of root incidence. [rad]
    trim_incidence, trim_twist : ndarray, shape (n_V,)
        Root incidence at which lift equals weight, and the twist there. [rad]
    lift_slope_ratio : ndarray, shape (n_V,)
        Elastic over rigid lift per incidence. [-]
    warnings : tuple of str
        What to know before trusting the numbers.
    """

    V: Array
    divergence: StaticSpeed
    reversal: StaticSpeed
    reversal_quantity: str | None
    effectiveness: Array
    moment_effectiveness: Array
    twist: Array
    trim_incidence: Array
    trim_twist: Array
    lift_slope_ratio: Array
    warnings: tuple[str, ...]


def divergence(model: AeroelasticModel, condition: FlightCondition) -> StaticSpeed:
    """Static divergence with rigid-body modes fixed: the lowest q_bar with det(K - q_bar Q(0)) = 0.

    K is the long-term stiffness: of a viscoelastic structure this is creep divergence, above which a disturbed wing
    twists on for ever; `creep.glassy` gives the elastic figures.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    condition : FlightCondition
        One condition, for its density and speed of sound; its V does not matter.

    Returns
    -------
    divergence : StaticSpeed
        None and None where the wing does not diverge at any speed. [Pa, m/s]

    References
    ----------
    equations.md, "Static aeroelasticity" [7.6, 7.9-7.11]; contract.md, "divergence_speed_m_s".

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("pitch",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.5]]]], b=1.0, inputs=(AeroInput(name="pitch", kind="mode"),))
    >>> divergence(AeroelasticModel(modes=one, aero=air), FlightCondition(V=1.0, rho=1.0))
    StaticSpeed(q=8.0, V=4.0)
    """
    model = model.statics or model
    fixed, K = elastic_stiffness(model)

    def lowest(mach: float) -> float | None:
        Q0 = model.aero(0.0, mach).real[np.ix_(fixed, fixed)]
        return within_limit(lowest_pressure(K, Q0), model)

    return at_own_mach(lowest, model, condition)


def elastic_stiffness(model: AeroelasticModel) -> tuple[Array, Array]:
    """Indices of the modes that have stiffness, and their long-term K: rigid-body modes are held fixed.

    Parameters
    ----------
    model : AeroelasticModel
        Any.

    Returns
    -------
    index : int ndarray, shape (m,)
        Modes with a spring. [-]
    K : ndarray, shape (m, m)
        Their stiffness. [SI]

    References
    ----------
    contract.md, "divergence_speed_m_s is static, with rigid-body modes fixed".

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("pitch",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.5]]]], b=1.0, inputs=(AeroInput(name="pitch", kind="mode"),))
    >>> elastic_stiffness(AeroelasticModel(modes=one, aero=air))[1].tolist()
    [[4.0]]
    """
    K = model.modes.relaxed_K
    size = np.abs(K).max(axis=0) / np.sqrt(np.diag(model.modes.M))
    index = np.flatnonzero(size > 1e-13 * size.max(initial=0.0))
    return index, K[np.ix_(index, index)]


def static(model: AeroelasticModel, sweep: FlightCondition) -> StaticResult:
    """Divergence, reversal, and effectiveness, twist and trim against speed.

    Rigid-body modes are held fixed; linear theory, so nothing is given past divergence.

    Parameters
    ----------
    model : AeroelasticModel
        With `loads` for all but divergence and twist, and the steady columns "incidence" and "roll_rate".
    sweep : FlightCondition
        Speeds at one density, shape (n_V,). [m/s, kg/m^3]

    Returns
    -------
    result : StaticResult
        Speeds and curves. [SI]

    References
    ----------
    Bramstång 2015, Eqs. 7.5-7.6, 7.14-7.21 as put right in equations.md, "Static aeroelasticity".

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("pitch",))
    >>> inputs = (AeroInput(name="pitch", kind="mode"), AeroInput(name="incidence", kind="steady"))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.5, 0.5]]]], b=1.0, inputs=inputs)
    >>> static(AeroelasticModel(modes=one, aero=air), FlightCondition(V=[2.0], rho=1.0)).divergence
    StaticSpeed(q=8.0, V=4.0)
    """
    diverges = divergence(model, sweep[0])
    quantity, reverses = reversal(model, sweep[0])
    rolling, model = model.rolling, model.statics or model
    stable = np.ones(sweep.V.shape, bool) if diverges.V is None else sweep.V < diverges.V * (1.0 - 1e-12)
    nothing = np.full(sweep.V.shape, np.nan)
    usable = sweep[stable] if stable.any() else sweep[:0]
    response = _Elastic(model, usable)
    controlled = response if rolling is None or quantity != "roll" else _Elastic(rolling, usable)

    def spread(values: Array | None) -> Array:
        out = nothing.copy()
        if values is not None:
            out[stable] = values
        return out

    notes = []
    if model.loads is None:
        notes.append("the model carries no lift or rolling moment: no reversal, effectiveness or trim")
    elif reverses.V is None and quantity is not None:
        notes.append("the controls do not reverse at any speed")
    if diverges.V is None:
        notes.append("does not diverge at any speed")
    incidence, twist = response.trim()
    return StaticResult(
        V=sweep.V,
        divergence=diverges,
        reversal=reverses,
        reversal_quantity=quantity,
        effectiveness=spread(controlled.rate_effectiveness(quantity)),
        moment_effectiveness=spread(controlled.held_effectiveness(quantity)),
        twist=spread(response.twist("incidence")),
        trim_incidence=spread(incidence),
        trim_twist=spread(twist),
        lift_slope_ratio=spread(response.slope_ratio()),
        warnings=tuple(notes),
    )


def reversal(
    model: AeroelasticModel, condition: FlightCondition, *, quantity: str | None = None, control: str | None = None
) -> tuple[str | None, StaticSpeed]:
    """Lowest dynamic pressure at which a control no longer gives roll (or lift).

    The load row joins the equilibrium: det [[K - q Q_qq, -q Q_qu], [Q_lq, Q_lu]] = 0.

    Parameters
    ----------
    model : AeroelasticModel
        With `loads` and a control.
    condition : FlightCondition
        One condition, for density and speed of sound.
    quantity : {"roll", "lift"}, optional
        Default roll where the model has it, else lift.
    control : str, optional
        Name of the control; default the first.

    Returns
    -------
    quantity : str or None
        What reverses; None without loads or controls.
    reversal : StaticSpeed
        None and None where it never does. [Pa, m/s]

    Raises
    ------
    ValueError
        If the model has no such control.

    References
    ----------
    equations.md, "Reversal" [7.18-7.21].

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero, StaticLoads
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("pitch",))
    >>> inputs = (AeroInput(name="pitch", kind="mode"), AeroInput(name="elevon", kind="control"))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.5, -0.5]]]], b=1.0, inputs=inputs)
    >>> loads = StaticLoads(names=("lift",), Q=[[1.0, 1.0]])
    >>> reversal(AeroelasticModel(modes=one, aero=air, loads=loads), FlightCondition(V=1.0, rho=1.0))[1].q
    4.0
    """
    rolling, model = model.rolling, model.statics or model
    column = _control_column(model, control)
    if model.loads is None or column is None:
        return None, StaticSpeed(q=None, V=None)
    quantity = quantity or ("roll" if "roll" in model.loads.names else "lift")
    loads = model.loads
    if quantity == "roll" and rolling is not None and rolling.loads is not None:
        model, loads = rolling, rolling.loads
    row, (index, K) = loads.row(quantity), elastic_stiffness(model)

    def lowest(mach: float) -> float | None:
        Q0 = model.aero(0.0, mach).real
        stiffness = np.block([[K, np.zeros((len(index), 1))], [row[index], row[column]]])
        air = np.block([[Q0[np.ix_(index, index)], Q0[index, column][:, None]], [np.zeros((1, len(index) + 1))]])
        if row[column] == 0.0:
            return None
        return within_limit(lowest_pressure(stiffness, air), model)

    return quantity, at_own_mach(lowest, model, condition)


class _Elastic:
    """Static response of the elastic modes at each speed of a sweep."""

    def __init__(self, model: AeroelasticModel, sweep: FlightCondition) -> None:
        self.model, self.sweep = model, sweep
        self.index, K = elastic_stiffness(model)
        self.q = sweep.q[:, None, None]
        self.Q0 = model.aero(np.zeros(sweep.V.shape), sweep.mach).real[:, self.index]
        self.matrix = K - self.q * self.Q0[..., self.index]
        self.control = _control_column(model, None)

    def modes(self, column: int) -> Array:
        """Elastic coordinates per unit of an input, shape (n_V, m)."""
        return np.linalg.solve(self.matrix, self.q * self.Q0[..., [column]])[..., 0]

    def load(self, row: Array, column: int) -> Array:
        """Elastic load per unit of an input and of q_bar, shape (n_V,)."""
        return row[column] + self.modes(column) @ row[self.index]

    def held_effectiveness(self, quantity: str | None) -> Array | None:
        """Elastic over rigid load of the control, the rigid body held."""
        if quantity is None or self.control is None or self.model.loads is None:
            return None
        row = self.model.loads.row(quantity)
        return self.load(row, self.control) / row[self.control] if row[self.control] else None

    def rate_effectiveness(self, quantity: str | None) -> Array | None:
        """Elastic over rigid steady roll rate per control angle; of lift there is no steady rate: held."""
        rate = self.model.column("roll_rate")
        if quantity != "roll" or rate is None or self.model.loads is None or self.control is None:
            return self.held_effectiveness(quantity)
        row, n = self.model.loads.row("roll"), len(self.index)
        system = np.zeros((len(self.sweep.V), n + 1, n + 1))
        system[:, :n, :n] = self.matrix
        system[:, :n, n:] = -self.q * self.Q0[..., [rate]]
        system[:, n, :n], system[:, n, n] = row[self.index], row[rate]
        right = np.concatenate(
            [self.q * self.Q0[..., [self.control]], np.broadcast_to(-row[self.control], (len(self.sweep.V), 1, 1))],
            axis=1,
        )
        elastic = np.linalg.solve(system, right)[:, n, 0]
        return elastic / (-row[self.control] / row[rate])

    def twist(self, name: str) -> Array | None:
        """Elastic twist at the outermost point per unit of a named input."""
        column, shape = self.model.column(name), _twist_shape(self.model)
        if column is None or shape is None:
            return None
        return self.modes(column) @ shape[self.index]

    def slope_ratio(self) -> Array | None:
        """Elastic over rigid lift per incidence."""
        column = self.model.column("incidence")
        if column is None or self.model.loads is None:
            return None
        row = self.model.loads.row("lift")
        return self.load(row, column) / row[column]

    def trim(self) -> tuple[Array | None, Array | None]:
        """Incidence at which lift carries the weight, and the elastic twist there, under air forces and weight."""
        column, built_in = self.model.column("incidence"), self.model.column("camber")
        if column is None or self.model.loads is None or self.model.mass is None:
            return None, None
        row, shape = self.model.loads.row("lift"), _twist_shape(self.model)
        sagging = self.sagging()
        steady = sagging @ row[self.index] + (self.load(row, built_in) if built_in is not None else 0.0)
        incidence = (self.model.mass * STANDARD_GRAVITY / self.sweep.q - steady) / self.load(row, column)
        if shape is None:
            return incidence, None
        coordinates = incidence[:, None] * self.modes(column) + sagging
        if built_in is not None:
            coordinates = coordinates + self.modes(built_in)
        return incidence, coordinates @ shape[self.index]

    def sagging(self) -> Array:
        """Elastic coordinates under the wing's own weight, shape (n_V, m); zero where it is not known."""
        weight = self.model.loads.weight if self.model.loads is not None else np.zeros(0)
        if not weight.size:
            return np.zeros(self.matrix.shape[:2])
        return np.linalg.solve(self.matrix, np.broadcast_to(weight[self.index][:, None], (*self.matrix.shape[:2], 1)))[
            ..., 0
        ]


def _twist_shape(model: AeroelasticModel) -> Array | None:
    """Twist of the tip about the flexural axis per unit of each mode; None without shapes."""
    return tip_motion(model.modes)[1] if len(model.modes.grid) else None


def _control_column(model: AeroelasticModel, name: str | None) -> int | None:
    """Column of a control; the first one where no name is given."""
    controls = model.columns("control")
    if name is None:
        return controls[0] if controls else None
    found = model.column(name)
    if found not in controls:
        known = [model.aero.inputs[j].name for j in controls]
        raise ValueError(f"the model has no control {name!r}; its controls are {known}")
    return found
