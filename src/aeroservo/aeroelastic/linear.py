"""State matrices of an AeroelasticModel with rational air forces at a flight condition."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.datatypes import AeroelasticModel, FlightCondition, LinearSystem, ModalModel, RationalAero, SampledAero

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
    """Matrix A of z' = A z with z = [q kept, q', lag states]; the p method's matrix.

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
    A : ndarray, shape (..., n_keep + n + n_lag, n_keep + n + n_lag)
        State matrix. [1/s and mixed]

    Raises
    ------
    ValueError
        If the air forces are samples, or the damping is hysteretic: neither has a state space.

    References
    ----------
    equations.md, "One equation of motion" (lag states x_j' = q' - (V/b) gamma_j x_j);
    Bramstång 2015, Eq. 7.24.

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
    blocks = [q * A0 - modes.K, 0.5 * rho * V * aero.b * A1 - modes.D, q * lag_D]
    blocks = [np.broadcast_to(block, (*condition.V.shape, *block.shape[-2:])) for block in blocks]
    rows = inverse @ np.concatenate(blocks, axis=-1)
    A = np.zeros((*condition.V.shape, m + n + n_lag, m + n + n_lag))
    A[..., np.arange(m), m + kept] = 1.0
    A[..., m : m + n, :m] = rows[..., kept]
    A[..., m : m + n, m:] = rows[..., n:]
    if n_lag:
        A[..., m + n :, m : m + n] = aero.lag_E[:, :n]
        lag = np.arange(m + n, m + n + n_lag)
        A[..., lag, lag] = -condition.V[..., None] / aero.b * aero.lags
    return A


def linear_system(model: AeroelasticModel, condition: FlightCondition) -> LinearSystem:
    """Named state space of a model at a flight condition, or at a batch of them.

    States are every displacement, every rate and the lag states y of y' = E q' - (V/b) gamma
    (y + E u); inputs the controls [rad] and the gust zones w_g [m/s, up positive, met at the zone's
    own leading edge]; outputs the displacements and rates.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces; controls without rate or acceleration terms.
    condition : FlightCondition
        Any shape (...).

    Returns
    -------
    system : LinearSystem
        Batched as `condition`. [SI]

    Raises
    ------
    ValueError
        If the air forces are samples, the damping is hysteretic, or a control has rate, acceleration
        or inertia terms: it then needs an actuator of relative degree two or more.

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
    controls, gusts = aero.columns("control"), aero.columns("gust")
    if np.any(aero.A1[..., controls]) or np.any(aero.A2[..., controls]) or np.any(modes.M_control):
        raise ValueError(
            "a control has rate, acceleration or inertia terms: it needs an actuator of relative degree two"
        )
    n, n_lag, columns = modes.n, len(aero.lags), controls + gusts
    A0, _, A2, lag_D = aero.matrices(condition.mach)
    V, q = (np.asarray(x)[..., None, None] for x in (condition.V, condition.q))
    lag_E = aero.lag_E[:, columns]
    per_unit = np.concatenate([np.ones_like(V).repeat(len(controls), -1), (1.0 / V).repeat(len(gusts), -1)], axis=-1)
    force = _inverse_mass(modes, aero, A2[..., :n], condition) @ (q * (A0[..., columns] + lag_D @ lag_E))
    B = np.zeros((*condition.V.shape, 2 * n + n_lag, len(columns)))
    B[..., n : 2 * n, :] = force * per_unit
    B[..., 2 * n :, :] = -V / aero.b * aero.lags[:, None] * lag_E * per_unit
    names = [name.replace(" ", "_") for name in modes.names]
    displacement = [name + (f"_{unit}" if unit else "") for name, unit in zip(names, modes.units)]
    rate = [f"{name}_rate" + (f"_{unit}_s" if unit else "_1_s") for name, unit in zip(names, modes.units)]
    lags = [f"lag_{j + 1}" for j in range(n_lag)]
    inputs = [f"{aero.inputs[j].name}_rad" for j in controls] + [f"{aero.inputs[j].name}_m_s" for j in gusts]
    batch = condition.V.shape
    return LinearSystem(
        A=A,
        B=B,
        C=np.broadcast_to(np.eye(2 * n, 2 * n + n_lag), (*batch, 2 * n, 2 * n + n_lag)),
        D=np.zeros((*batch, 2 * n, len(columns))),
        states=tuple(displacement + rate + lags),
        inputs=tuple(inputs),
        outputs=tuple(displacement + rate),
    )


def _inverse_mass(modes: ModalModel, aero: RationalAero, A2: Array, condition: FlightCondition) -> Array:
    """Inverse of the mass with the air that moves along; one matrix where density and A2 are one."""
    rho = condition.rho
    if A2.ndim == 2 and rho.size and np.all(rho == rho.flat[0]):
        rho = rho.flat[0]
    return np.asarray(np.linalg.inv(modes.M - 0.5 * np.asarray(rho)[..., None, None] * aero.b**2 * A2))
