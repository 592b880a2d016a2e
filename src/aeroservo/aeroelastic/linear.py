"""State matrices of an AeroelasticModel with rational air forces at a flight condition."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.datatypes import AeroelasticModel, FlightCondition, LinearSystem, ModalModel, RationalAero, SampledAero
from aeroservo.servo import Actuator

Array = NDArray[Any]


def displacement_free(modes: ModalModel, aero: SampledAero | RationalAero) -> Array:
    """Which modes feel no force from their displacement, at any speed.

    Their columns of K - q_bar Q(0) are identically zero, so each owns a root at s = 0 that says
    only that the aircraft may fly anywhere: analyses remove it by keeping the rate of the mode as
    a state and not the displacement.

    Parameters
    ----------
    modes : ModalModel
        Structure.
    aero : SampledAero or RationalAero
        Air forces on the same modes.

    Returns
    -------
    free : bool ndarray, shape (n,)
        True for such a mode. [-]

    References
    ----------
    equations.md, "Whole aircraft [7.43-7.46]"; contract.md, "flutter".

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput
    >>> heave = ModalModel(M=[[1.0]], D=[[0.0]], K=[[0.0]], names=("heave",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="heave", kind="mode"),))
    >>> displacement_free(heave, air)
    array([ True])
    """
    n = modes.n
    Q0 = np.abs(aero(np.zeros(len(aero.mach)), aero.mach)[..., :n])
    K = np.abs(modes.K)
    no_spring = K.max(axis=0) <= 1e-13 * K.max(initial=0.0)
    no_air = Q0.max(axis=(0, 1)) <= 1e-13 * Q0.max(initial=0.0)
    return np.asarray(no_spring & no_air)


def state_matrix(model: AeroelasticModel, condition: FlightCondition, *, keep: Array | None = None) -> Array:
    """Matrix A of z' = A z with z = [q kept, q', internal states]; the p method's matrix.

    Internal states are the lags of the air and, after them, those of a viscoelastic structure (`internal_states`).

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces and no hysteretic damping.
    condition : FlightCondition
        Any shape (...).
    keep : bool ndarray, shape (n,), optional
        Modes whose displacement is a state; default those of `displacement_free` are left out.

    Returns
    -------
    A : ndarray, shape (..., n_keep + n + n_in, n_keep + n + n_in)
        State matrix. [1/s and mixed]

    Raises
    ------
    ValueError
        If the air forces are samples, or the damping is hysteretic: neither has a state space.

    References
    ----------
    equations.md, "One equation of motion" (lag states x_j' = q' - (V/b) gamma_j x_j);
    Bramstång 2015, Eq. 7.24 and section 7.8 (internal states y of relaxation: time y' = R q - y, K_j = R^T R).

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> zero = [[[0.0]]]
    >>> air = RationalAero(A0=zero, A1=zero, A2=zero, b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> state_matrix(AeroelasticModel(modes=one, aero=air), FlightCondition(V=10.0, rho=1.2)).tolist()
    [[0.0, 1.0], [-4.0, 0.0]]
    """
    modes, aero = model.modes, model.aero
    if not isinstance(aero, RationalAero):
        raise ValueError("a state space needs rational air forces: fit the samples first (fit_rational)")
    if modes.hysteretic_g:
        raise ValueError(
            "hysteretic damping has no state space: use a frequency-domain method (pk, k, g) or modal damping"
        )
    n, n_lag = modes.n, len(aero.lags)
    kept = np.flatnonzero(~displacement_free(modes, aero) if keep is None else keep)
    m = len(kept)
    A0, A1, A2, lag_D = (x[..., :n] if i < 3 else x for i, x in enumerate(aero.matrices(condition.mach)))
    V, rho, q = (np.asarray(x)[..., None, None] for x in (condition.V, condition.rho, condition.q))
    inverse = _inverse_mass(modes, aero, A2, condition)
    strains = [branch.strain for branch in modes.relaxing]
    R = np.concatenate([*strains, np.zeros((0, n))])
    n_in = n_lag + len(R)
    blocks = [q * A0 - modes.K, 0.5 * rho * V * aero.b * A1 - modes.D, q * lag_D, R.T]
    blocks = [np.broadcast_to(block, (*condition.V.shape, *block.shape[-2:])) for block in blocks]
    rows = inverse @ np.concatenate(blocks, axis=-1)
    A = np.zeros((*condition.V.shape, m + n + n_in, m + n + n_in))
    A[..., np.arange(m), m + kept] = 1.0
    A[..., m : m + n, :m] = rows[..., kept]
    A[..., m : m + n, m:] = rows[..., n:]
    if n_lag:
        A[..., m + n : m + n + n_lag, m : m + n] = aero.lag_E[:, :n]
        lag = np.arange(m + n, m + n + n_lag)
        A[..., lag, lag] = -condition.V[..., None] / aero.b * aero.lags
    if len(R):
        rate = 1.0 / np.concatenate([np.full(len(x), b.time) for x, b in zip(strains, modes.relaxing)])
        inner = np.arange(m + n + n_lag, m + n + n_in)
        A[..., inner, :m] = (rate[:, None] * R)[:, kept]
        A[..., inner, inner] = -rate
    return A


def internal_states(model: AeroelasticModel) -> tuple[str, ...]:
    """Names of the states of a model beside displacements and rates: lags of the air, then of relaxation.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.

    Returns
    -------
    names : tuple of str
        "lag_1" ... "relaxation_1" ... in the order of `state_matrix`.

    References
    ----------
    equations.md, "One equation of motion"; Bramstång 2015, section 7.8.

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> internal_states(build(read("goland"), "jones"))[:2]
    ('lag_1', 'lag_2')
    """
    lags = len(model.aero.lags) if isinstance(model.aero, RationalAero) else 0
    relaxing = sum(len(branch.strain) for branch in model.modes.relaxing)
    return (*(f"lag_{j + 1}" for j in range(lags)), *(f"relaxation_{j + 1}" for j in range(relaxing)))


def linear_system(model: AeroelasticModel, condition: FlightCondition, *, actuators: bool = True) -> LinearSystem:
    """Named state space of a model at a flight condition, or at a batch of them, about its equilibrium.

    States are every displacement, every rate, the lag states y of y' = E q' - (V/b) gamma (y + E u), the internal
    states of a viscoelastic structure, then the deflection (and its rate) of each actuator; inputs the controls [rad],
    commands where an actuator moves them, and the gust zones w_g [m/s, up positive, met at the zone's own leading
    edge]; outputs the displacements, rates, deflections behind actuators and sensors. Limits, backlash, dead times and
    bandwidths of sensors are left out.

    A gust column with a rate term (A1) would take w_g' and a sharp edge would be an impulse: the jump of the rates that
    it gives is taken out of the state, so that the rates are C x + D w_g.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.
    condition : FlightCondition
        Any shape (...).
    actuators : bool
        Whether actuators are part of the system; without them the controls are the inputs.

    Returns
    -------
    system : LinearSystem
        Batched as `condition`. [SI]

    Raises
    ------
    ValueError
        If the air forces are samples, the damping is hysteretic, or a control has rate terms without an actuator, or
        acceleration or inertia terms without one of relative degree two.

    References
    ----------
    equations.md, "One equation of motion" (gust columns: no derivative of w_g); Bramstång 2015, Eq. 7.70.

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("plunge",), units=("m",))
    >>> zero = [[[0.0]]]
    >>> air = RationalAero(A0=zero, A1=zero, A2=zero, b=1.0, inputs=(AeroInput(name="plunge", kind="mode"),))
    >>> linear_system(AeroelasticModel(modes=one, aero=air), FlightCondition(V=10.0, rho=1.2)).states
    ('plunge_m', 'plunge_rate_m_s')
    """
    modes, aero = model.modes, model.aero
    A = state_matrix(model, condition, keep=np.ones(modes.n, dtype=bool))
    assert isinstance(aero, RationalAero)  # state_matrix refused anything else
    moved = {a.control: a for a in model.actuators} if actuators else {}
    check_control_terms(model, moved)
    plant = PlantRows(model, condition)
    internal = internal_states(model)
    batch, n_plant = condition.V.shape, 2 * modes.n + len(internal)
    names = [aero.inputs[j].name for j in plant.controls]
    chosen = [moved.get(name) for name in names]
    width = [0 if a is None else a.order for a in chosen]
    n_x, n_gust = n_plant + sum(width), len(plant.gusts)
    full, B = np.zeros((*batch, n_x, n_x)), np.zeros((*batch, n_x, len(names) + n_gust))
    full[..., :n_plant, :n_plant] = A
    row = n_plant
    for j, actuator in enumerate(chosen):
        if actuator is None:
            B[..., :n_plant, j] = plant.delta[..., j]
            continue
        full[..., :n_plant, row] += plant.delta[..., j]
        rate = np.zeros((actuator.order, 1 + actuator.order))  # of the actuator's states, per state and per command
        w = actuator.omega
        if actuator.zeta is None:
            rate[0] = -w, w * actuator.gain
        else:
            rate[0, 1] = 1.0
            rate[1] = -w * w, -2.0 * actuator.zeta * w, w * w * actuator.gain
        full[..., row : row + actuator.order, row : row + actuator.order] = rate[:, :-1]
        B[..., row : row + actuator.order, j] = rate[:, -1]
        velocity, acceleration = (rate[0], None) if actuator.order == 1 else (np.array([0.0, 1.0, 0.0]), rate[1])
        for effect, source in ((plant.delta_rate[..., j], velocity), (plant.delta_acceleration[..., j], acceleration)):
            if source is not None:
                full[..., :n_plant, row : row + actuator.order] += effect[..., None] * source[:-1]
                B[..., :n_plant, j] += effect * source[-1]
        row += actuator.order
    jump = np.zeros((*batch, n_x, n_gust))
    jump[..., :n_plant, :] = plant.gust_rate
    B[..., :n_plant, len(names) :] = plant.gust
    B[..., len(names) :] += full @ jump
    return _named(model, full, B, jump, plant, [a for a in chosen if a is not None], internal)


def check_control_terms(model: AeroelasticModel, moved: Mapping[str, Actuator]) -> None:
    """Refuse controls whose rate or acceleration acts but is not known.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.
    moved : mapping of str to Actuator
        Actuator of each control that has one.

    Raises
    ------
    ValueError
        If a control has rate terms and no actuator, or acceleration or inertia terms and none of second order.

    References
    ----------
    Project convention: architecture.md, "An actuator of relative degree two or more".

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> check_control_terms(build(read("bact")), {})  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    ValueError: control 'elevon' has acceleration or inertia terms: it needs an actuator of relative degree two...
    """
    aero = model.aero
    assert isinstance(aero, RationalAero)
    for index, j in enumerate(aero.columns("control")):
        name = aero.inputs[j].name
        order = moved[name].order if name in moved else 0
        inertia = model.modes.M_control[:, index] if model.modes.M_control.shape[1] else np.zeros(1)
        if order < 2 and (np.any(aero.A2[..., j]) or np.any(inertia)):
            raise ValueError(
                f"control {name!r} has acceleration or inertia terms: it needs an actuator of relative degree two "
                "(give the actuator a zeta)"
            )
        if order < 1 and np.any(aero.A1[..., j]):
            raise ValueError(f"control {name!r} has rate terms: it needs an actuator")


class PlantRows:
    """What controls and gusts do to the rows [q', q'', lag'] of a model, batched as the condition.

    Attributes
    ----------
    controls, gusts : list of int
        Their columns of Q.
    inverse : ndarray, shape (..., n, n) or (n, n)
        Inverse of the mass with the air that moves along. [SI]
    delta, delta_rate, delta_acceleration : ndarray, shape (..., 2n + n_in, n_u)
        Per control angle, rate and acceleration; zero in the states of relaxation. [SI]
    gust, gust_rate : ndarray, shape (..., 2n + n_in, n_w)
        Per gust velocity and its rate of change. [SI]
    """

    def __init__(self, model: AeroelasticModel, condition: FlightCondition) -> None:
        modes, aero = model.modes, model.aero
        assert isinstance(aero, RationalAero)
        n, n_lag, n_in = modes.n, len(aero.lags), len(internal_states(model))
        self.controls, self.gusts = aero.columns("control"), aero.columns("gust")
        A0, A1, A2, lag_D = aero.matrices(condition.mach)
        V, rho, q = (np.asarray(x)[..., None, None] for x in (condition.V, condition.rho, condition.q))
        inverse = self.inverse = _inverse_mass(modes, aero, A2[..., :n], condition)

        def rows(force: Array, lag: Array | None = None) -> Array:
            """Accelerations of a force, and the drive of the lags."""
            out = np.zeros((*condition.V.shape, 2 * n + n_in, force.shape[-1]))
            out[..., n : 2 * n, :] = inverse @ np.broadcast_to(force, (*condition.V.shape, *force.shape[-2:]))
            if lag is not None:
                out[..., 2 * n : 2 * n + n_lag, :] = lag
            return out

        def of(columns: list[int]) -> tuple[Array, Array]:
            E = aero.lag_E[:, columns]
            return q * (A0[..., columns] + lag_D @ E), -V / aero.b * aero.lags[:, None] * E

        inertia = modes.M_control if modes.M_control.shape[1] else np.zeros((n, len(self.controls)))
        c, g = self.controls, self.gusts
        self.delta = rows(*of(c))
        self.delta_rate = rows(0.5 * rho * V * aero.b * A1[..., c])
        self.delta_acceleration = rows(0.5 * rho * aero.b**2 * A2[..., c] - inertia)
        self.gust = rows(*of(g)) / V
        self.gust_rate = rows(0.5 * rho * aero.b * A1[..., g])


def _named(
    model: AeroelasticModel,
    A: Array,
    B: Array,
    jump: Array,
    plant: PlantRows,
    moved: list[Actuator],
    internal: tuple[str, ...],
) -> LinearSystem:
    """Outputs and names: rates hold the jump of the gust."""
    modes, aero, n = model.modes, model.aero, model.modes.n
    n_x, batch = A.shape[-1], A.shape[:-2]
    deflection = np.cumsum([2 * n + len(internal), *(a.order for a in moved)])[:-1].astype(int)
    direct = np.eye(n_x)[[*range(2 * n), *deflection]]
    C = np.broadcast_to(direct, (*batch, *direct.shape))
    n_gust = jump.shape[-1]
    D = np.zeros((*batch, len(direct), B.shape[-1]))
    D[..., B.shape[-1] - n_gust :] = C @ jump
    for sensor in model.sensors:
        rows = [np.array(r) if len(r) else np.zeros(n) for r in (sensor.displacement, sensor.rate, sensor.acceleration)]
        position = np.concatenate([rows[0], rows[1], np.zeros(n_x - 2 * n)])
        c = position + rows[2] @ A[..., n : 2 * n, :]
        d = np.zeros((*batch, B.shape[-1]))
        d[..., B.shape[-1] - n_gust :] = np.asarray(position @ jump)
        C = np.concatenate([C, c[..., None, :]], axis=-2)
        D = np.concatenate([D, (d + rows[2] @ B[..., n : 2 * n, :])[..., None, :]], axis=-2)
    names = [name.replace(" ", "_") for name in modes.names]
    displacement = [name + (f"_{unit}" if unit else "") for name, unit in zip(names, modes.units)]
    rate = [f"{name}_rate" + (f"_{unit}_s" if unit else "_1_s") for name, unit in zip(names, modes.units)]
    states = [*displacement, *rate, *internal]
    for actuator in moved:
        states += [f"{actuator.control}_rad", f"{actuator.control}_rate_rad_s"][: actuator.order]
    commanded = {a.control for a in moved}
    inputs = [f"{aero.inputs[j].name}_{'command_' * (aero.inputs[j].name in commanded)}rad" for j in plant.controls]
    return LinearSystem(
        A=A,
        B=B,
        C=C,
        D=D,
        states=tuple(states),
        inputs=(*inputs, *(f"{aero.inputs[j].name}_m_s" for j in plant.gusts)),
        outputs=(*displacement, *rate, *(f"{a.control}_rad" for a in moved), *(s.channel for s in model.sensors)),
    )


def _inverse_mass(modes: ModalModel, aero: RationalAero, A2: Array, condition: FlightCondition) -> Array:
    """Inverse of the mass with the air that moves along; one matrix where density and A2 are one."""
    rho = condition.rho
    if A2.ndim == 2 and rho.size and np.all(rho == rho.flat[0]):
        rho = rho.flat[0]
    return np.asarray(np.linalg.inv(modes.M - 0.5 * np.asarray(rho)[..., None, None] * aero.b**2 * A2))
