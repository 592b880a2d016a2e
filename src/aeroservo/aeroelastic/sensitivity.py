"""Derivatives of flutter, divergence and reversal speeds to the numbers of a model file, by adjoints.

At a flutter boundary F(i omega, V; p) x = 0 and y^H F = 0. A change of p moves omega and V so that

    y^H (F_p dp + i F_s d omega + F_V dV) x = 0,

one complex equation for two real unknowns; nothing is iterated, and the change of the null vectors plays no part. A
static boundary, G(V; p) x = 0, moves by dV = -(y G_p x) / (y G_V x) dp. F_s and F_V are exact. F_p and G_p, the
derivatives of the MATRICES at fixed frequency and speed, are differences of fourth order (error about 1e-11) of the
matrices that the builders make: every number of a file, structural, inertial, aerodynamic or geometric, is treated
alike, and no derivative can be forgotten.

Where the modes of a beam change with the number, so does their basis; x and y being null vectors, a turn of the basis
drops out of y^H F_p x, and modes are turned back onto those of the file before differencing, so that close or crossing
frequencies do no harm. What is differentiated is the speed of the model as it is built, truncation included.

It stops being valid where two boundaries meet, and where the first boundary is not the same branch on both sides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.flutter import PK, Method, flutter, prepared
from aeroservo.aeroelastic.static import divergence, elastic_stiffness, reversal
from aeroservo.aircraft.overrides import numbers, override
from aeroservo.aircraft.schema_base import FileModel
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition

STENCILS = (
    (np.array([-2.0, -1.0, 1.0, 2.0]), np.array([1.0, -8.0, 8.0, -1.0]) / 12.0),
    (np.arange(5.0), np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12.0),
    (-np.arange(5.0), -np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12.0),
)
"""Steps and weights of first derivatives of fourth order: central, and to one side where a limit is near. [-]"""

STEP, NOISE = 5e-4, 1e-5
"""Step relative to the number; smallest relative change of a matrix entry that rounding cannot spoil. [-]"""


@dataclass(frozen=True, kw_only=True)
class Sensitivity:
    """How three speeds change with one number of a model file; None where there is no such speed.

    Attributes
    ----------
    field : str
        Dotted path of the number.
    value : float
        Its value. [unit of the field]
    dV_flutter, dV_divergence, dV_reversal : float or None
        Change of true airspeed per unit of the field. [m/s per unit of the field]
    relative_flutter, relative_divergence, relative_reversal : float or None
        (dV / V) / (dp / p), zero where the number is zero. [-]
    """

    field: str
    value: float
    dV_flutter: float | None
    dV_divergence: float | None
    dV_reversal: float | None
    relative_flutter: float | None
    relative_divergence: float | None
    relative_reversal: float | None


def sensitivities(
    file: FileModel,
    sweep: FlightCondition,
    method: Method | None = None,
    *,
    aero: str | None = None,
    fields: tuple[str, ...] | None = None,
) -> tuple[Sensitivity, ...]:
    """Derivatives of the flutter, divergence and reversal speeds to numbers of a model file.

    Parameters
    ----------
    file : FileModel
        From `aeroservo.read`.
    sweep : FlightCondition
        Range in which flutter is sought, as for `flutter`. [m/s, kg/m^3]
    method : P, PK, K or G, optional
        How roots are found, default p-k; all agree on a boundary, but p on sampled air forces differentiates its fit.
    aero : str, optional
        Section theory; default that of the kind.
    fields : tuple of str, optional
        Dotted paths; default every number that the file has.

    Returns
    -------
    sensitivities : tuple of Sensitivity
        In the order of the fields; those that cannot be varied at all (fixed by a rule of the file) or not
        smoothly (a control's end on a station of the beam: beside it the beam has one part more) are left out.

    Raises
    ------
    ModelFileError
        If a field names no number of the model.
    ValueError
        As `build` and `flutter`.

    References
    ----------
    Lancaster, Numerische Mathematik 6, 1964, 377-387; Cardani & Mantegazza, AIAA J. 17(4), 1979 (flutter derivatives).

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> sweep = FlightCondition(V=np.linspace(20.0, 120.0, 11), rho=1.225)
    >>> found = sensitivities(read("thesis-binary"), sweep, fields=("wing.pitch_stiffness_N_m",))[0]
    >>> round(found.relative_divergence, 9)  # V_D goes as the root of K_theta
    0.5
    """
    method = method or PK()
    known = numbers(file)
    if fields is not None:
        override(file, {field: known.get(field) or 0.0 for field in fields if known.get(field) is None})
    model = build(file, aero)
    boundaries = _boundaries(model, sweep, method)
    found = []
    for field in fields if fields is not None else tuple(known):
        value = known[field]
        if value is None:
            continue
        slopes = _matrix_slopes(file, field, value, aero, model, boundaries)
        if slopes is None:
            continue
        dV = [None if b is None else b.shift(slope) for b, slope in zip(boundaries, slopes)]
        relative = [None if b is None or d is None else d * value / b.V for b, d in zip(boundaries, dV)]
        found.append(
            Sensitivity(
                field=field,
                value=value,
                dV_flutter=dV[0],
                dV_divergence=dV[1],
                dV_reversal=dV[2],
                relative_flutter=relative[0],
                relative_divergence=relative[1],
                relative_reversal=relative[2],
            )
        )
    return tuple(found)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Boundary:
    """A boundary: its speed, the matrix that is singular there, and what a change of it does to the speed."""

    V: float
    matrix: Callable[[AeroelasticModel], Array]
    shift: Callable[[complex], float]
    left: Array
    right: Array


def _boundaries(
    model: AeroelasticModel, sweep: FlightCondition, method: Method
) -> tuple[_Boundary | None, _Boundary | None, _Boundary | None]:
    """Flutter, divergence and reversal; None where there is none."""
    condition = sweep[0]
    result = flutter(model, sweep, method)
    oscillatory = None
    if result.flutter_speed is not None and result.flutter_frequency is not None:
        oscillatory = _flutter_boundary(model, condition, method, result.flutter_speed, result.flutter_frequency)
    V_divergence, V_reversal = divergence(model, condition).V, reversal(model, condition)[1].V
    return (
        oscillatory,
        None if V_divergence is None else _static_boundary(model, condition, V_divergence, bordered=False),
        None if V_reversal is None else _static_boundary(model, condition, V_reversal, bordered=True),
    )


def _flutter_boundary(
    model: AeroelasticModel, condition: FlightCondition, method: Method, V: float, omega: float
) -> _Boundary:
    """F(i omega) at the flutter speed."""
    rho, a_sound, s = float(condition.rho), float(condition.a_sound), 1j * omega

    def forces(varied: AeroelasticModel, speed: float) -> Array:
        ready, _ = prepared(varied, method)
        return (
            0.5
            * rho
            * speed**2
            * np.asarray(ready.aero(omega * ready.aero.b / speed, speed / a_sound))[:, : ready.modes.n]
        )

    def matrix(varied: AeroelasticModel) -> Array:
        return np.asarray(varied.modes.dynamic_stiffness(s) - forces(varied, V))

    ready, _ = prepared(model, method)
    n, b, q = ready.modes.n, ready.aero.b, 0.5 * rho * V**2
    k, mach, step = omega * b / V, V / a_sound, 1e-6
    slope = ready.aero.slope(k, mach)[:, :n]
    by_mach = (ready.aero(k, mach + step) - ready.aero(k, max(mach - step, 0.0)))[:, :n] / (2.0 * step)
    F_s = 2.0 * s * ready.modes.M + ready.modes.D - q * b / V * slope + ready.modes.relaxation_slope(s)
    F_V = -rho * V * ready.aero(k, mach)[:, :n] + q * s * b / V**2 * slope - q / a_sound * by_mach
    left, right = _null(matrix(model))
    a, turn = left @ F_V @ right, 1j * (left @ F_s @ right)

    def shift(c: complex) -> float:
        return float(-(c * turn.conjugate()).imag / (a * turn.conjugate()).imag)

    return _Boundary(V=V, matrix=matrix, shift=shift, left=left, right=right)


def _static_boundary(model: AeroelasticModel, condition: FlightCondition, V: float, *, bordered: bool) -> _Boundary:
    """K - q Q(0) of the elastic modes; bordered by the load row and the control column for reversal."""
    rho, a_sound = float(condition.rho), float(condition.a_sound)

    def at(varied: AeroelasticModel, speed: float) -> Array:
        wing = (bordered and varied.rolling) or varied.statics or varied
        index, K = elastic_stiffness(wing)
        q, Q0 = 0.5 * rho * speed**2, wing.aero(0.0, speed / a_sound).real
        matrix = K - q * Q0[np.ix_(index, index)]
        if not bordered or wing.loads is None:
            return np.asarray(matrix)
        control = wing.columns("control")[0]
        row = wing.loads.row("roll" if "roll" in wing.loads.names else "lift")
        return np.block([[matrix, -q * Q0[index, control][:, None]], [row[index], row[control]]])

    left, right = _null(at(model, V))
    step = 1e-4 * V
    G_V = sum(w * at(model, V + x * step) for x, w in zip(*STENCILS[0])) / step
    a = float(left @ G_V @ right)
    return _Boundary(
        V=V, matrix=lambda varied: at(varied, V), shift=lambda c: -float(c.real) / a, left=left, right=right
    )


def _null(matrix: Array) -> tuple[Array, Array]:
    """Left (as a row to multiply with) and right null vectors."""
    scale = np.sqrt(np.abs(np.diag(matrix)))
    scale = np.where(scale > 0.0, scale, 1.0)
    left, _, right = np.linalg.svd(matrix / np.outer(scale, scale))
    return left[:, -1].conj() / scale, right[-1].conj() / scale


def _matrix_slopes(
    file: FileModel,
    field: str,
    value: float,
    aero: str | None,
    model: AeroelasticModel,
    boundaries: tuple[_Boundary | None, ...],
) -> list[complex] | None:
    """y F_p x of each boundary; None where the number cannot be varied."""
    step = STEP * abs(value) or STEP
    slopes: list[complex] | None = None
    for _ in range(8):
        varied = _varied(file, field, value, step, aero, model)
        if varied is None:
            return slopes
        models, weights = varied
        models = [_turned(other, model) for other in models]
        slopes, change = [], 0.0
        for boundary in boundaries:
            if boundary is None:
                slopes.append(0.0)
                continue
            matrices = [boundary.matrix(other) for other in models]
            products = np.array([boundary.left @ matrix @ boundary.right for matrix in matrices])
            size = max(float(np.abs(boundary.left) @ np.abs(matrix) @ np.abs(boundary.right)) for matrix in matrices)
            change = max(change, float(np.ptp(products.real) + np.ptp(products.imag)) / (size or 1.0))
            slopes.append(complex(weights @ products) / step)
        if change > NOISE or value != 0.0:
            return slopes
        step *= 10.0
    return slopes


def _varied(
    file: FileModel, field: str, value: float, step: float, aero: str | None, model: AeroelasticModel
) -> tuple[list[AeroelasticModel], Array] | None:
    """Models at the points of the first stencil that the file's rules allow without a change of size, its weights."""
    for steps, weights in STENCILS:
        try:
            models = [build(override(file, {field: value + x * step}), aero) for x in steps]
        except ValueError:
            continue
        if all(_size(other) == _size(model) for other in models):
            return models, weights
    return None


def _size(model: AeroelasticModel) -> tuple[int, int]:
    """Coordinates of the model and of the one for statics: where an end moves off a station, there is one part more."""
    return model.modes.n, 0 if model.statics is None else model.statics.modes.n


def _turned(model: AeroelasticModel, onto: AeroelasticModel) -> AeroelasticModel:
    """The model in the basis that best gives the shapes of another: close modes then do not turn into each other."""
    phi, target = np.asarray(model.modes.phi), np.asarray(onto.modes.phi)
    n = model.modes.n
    if phi.shape != target.shape or not phi.size or model.statics is None:
        return model
    T = np.linalg.lstsq(phi.reshape(-1, n), target.reshape(-1, n), rcond=None)[0]
    modes = replace(
        model.modes,
        M=_symmetric(T.T @ model.modes.M @ T),
        D=T.T @ model.modes.D @ T,
        K=T.T @ model.modes.K @ T,
        phi=phi @ T,
        relaxing=tuple(replace(branch, K=_symmetric(T.T @ branch.K @ T)) for branch in model.modes.relaxing),
    )
    return replace(model, modes=modes, aero=_turned_air(model.aero, T))


def _turned_air(aero: Any, T: Array) -> Any:
    """Air forces on modes and of modes in the new basis."""
    n = len(T)

    def both(Q: Array) -> Array:
        Q = T.T @ Q
        return np.concatenate([Q[..., :n] @ T, Q[..., n:]], axis=-1)

    if hasattr(aero, "Q"):
        return replace(aero, Q=both(aero.Q))
    lag_E = np.concatenate([aero.lag_E[:, :n] @ T, aero.lag_E[:, n:]], axis=-1)
    return replace(aero, A0=both(aero.A0), A1=both(aero.A1), A2=both(aero.A2), lag_D=T.T @ aero.lag_D, lag_E=lag_E)


def _symmetric(M: Array) -> Array:
    """Rounded to symmetry."""
    return 0.5 * (M + M.T)
