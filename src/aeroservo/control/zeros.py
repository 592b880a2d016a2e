"""Transmission zeros of a plant, sensor by sensor, against speed: what control reversal really changes.

A zero in the right half plane bounds what any controller can do with that sensor. Where lift reverses, the zero of
plunge (and of an accelerometer) crosses through s = 0: the static gain changes its sign, the modes' controllability
does not. Zeros are found by the reduction of Emami-Naeini and Van Dooren, which removes those at infinity exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from aeroservo.control.plant import chosen, design_plant
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, LinearSystem

RANK = 1e-10
"""Singular values below this part of the largest are zero. [-]"""

AXIS = 1e-8
"""Zeros closer to the origin than this part of the largest root of the plant lie there. [-]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class ZeroCurve:
    """Zeros from one input to one sensor against speed.

    Attributes
    ----------
    sensor : str
        Channel that is measured.
    V : ndarray, shape (n_V,)
        True airspeeds. [m/s]
    zeros : complex ndarray, shape (n_V, n_z)
        Finite zeros in order of their real part, the largest first; nan where there are fewer. [1/s]
    crossings : tuple of float
        Speeds at which a zero crosses the imaginary axis, in order. [m/s]
    """

    sensor: str
    V: Array
    zeros: Array
    crossings: tuple[float, ...]

    @property
    def right(self) -> Array:
        """Largest real part of a zero in the right half plane, nan where there is none, shape (n_V,). [1/s]"""
        real = np.where(np.isfinite(self.zeros), self.zeros.real, -np.inf).max(axis=1, initial=-np.inf)
        return np.where(real > 0.0, real, np.nan)


def transmission_zeros(system: LinearSystem, *, input: str | None = None, output: str | None = None) -> Array:
    """Finite transmission zeros of one system; those at infinity are removed exactly.

    Parameters
    ----------
    system : LinearSystem
        Continuous or sampled, one condition. [SI]
    input, output : str, optional
        Channels; all if not given (a square or rectangular system).

    Returns
    -------
    zeros : complex ndarray, shape (n_z,)
        In s, or in z for a sampled system, largest real part first. [1/s]

    Raises
    ------
    ValueError
        If the system is a batch, a channel is unknown, or every s is a zero (the input does not reach the output).

    References
    ----------
    A. Emami-Naeini and P. Van Dooren, Automatica 18(4), 1982, 415-430.

    Examples
    --------
    >>> names = {"states": ("a", "b"), "inputs": ("u",), "outputs": ("y",)}
    >>> one = LinearSystem(A=[[0, 1], [-2, -3]], B=[[0], [1]], C=[[-5, 1]], D=[[0]], **names)
    >>> transmission_zeros(one).real.round(9).tolist()
    [5.0]
    """
    if system.A.ndim != 2:
        raise ValueError(f"zeros are of one condition: index this batch of shape {system.A.shape[:-2]} first")
    system = chosen(system, inputs=None if input is None else [input], outputs=None if output is None else [output])
    A, B, C, D = _balanced(system)
    A, B, C, D = _reduced(A, B, C, D)
    A, B, C, D = (x.T for x in _reduced(A.T, C.T, B.T, D.T))
    A, B, C, D = A, C, B, D
    if D.shape[0] != D.shape[1] or (D.size and np.linalg.matrix_rank(D) < len(D)):
        raise ValueError(f"every s is a zero: {', '.join(system.inputs)} does not reach {', '.join(system.outputs)}")
    if not D.size and not _reaches(system):
        raise ValueError(f"every s is a zero: {', '.join(system.inputs)} does not reach {', '.join(system.outputs)}")
    values = np.linalg.eigvals(A - B @ np.linalg.solve(D, C) if D.size else A).astype(complex)
    return np.asarray(values[np.lexsort((values.imag, -values.real))])


def zeros_against_speed(
    model: AeroelasticModel,
    sweep: FlightCondition,
    *,
    sensors: Sequence[str] | None = None,
    control: str | None = None,
    actuators: bool = True,
) -> tuple[ZeroCurve, ...]:
    """Transmission zeros from one control to each sensor over a sweep of speeds, and where they cross the axis.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.
    sweep : FlightCondition
        Ascending speeds at one density, shape (n_V,). [m/s, kg/m^3]
    sensors : sequence of str, optional
        Names or channels; default displacements, rates and sensors of the model.
    control : str, optional
        Name of the input channel; default the first.
    actuators : bool
        Whether actuators are inside (they add no zeros, but controls with inertia need them).

    Returns
    -------
    curves : tuple of ZeroCurve
        One for each sensor. Crossings are refined to 1e-9 of the speed. [m/s, 1/s]

    Raises
    ------
    ValueError
        If a channel is unknown or the model has no state space.

    References
    ----------
    equations.md, "Near reversal, what really changes sign"; A. Emami-Naeini and P. Van Dooren, Automatica 18(4), 1982.

    Examples
    --------
    The zero of plunge of the thesis' model passes into the right half plane where its lift reverses.

    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> sweep = FlightCondition.at(3048.0, V=np.linspace(40.0, 110.0, 15))
    >>> curve = zeros_against_speed(build(read("thesis-simulation")), sweep, sensors=["plunge_m"])[0]
    >>> [round(V, 2) for V in curve.crossings], round(float(curve.right[-1]), 1)
    ([53.29], 46.5)
    """
    model = replace(  # a delay adds no finite zeros
        model,
        actuators=tuple(replace(a, delay_s=0.0) for a in model.actuators),
        sensors=tuple(replace(s, delay_s=0.0) for s in model.sensors),
    )

    def plant_at(V: Array) -> LinearSystem:
        condition = FlightCondition(V=V, rho=sweep.rho[0], a_sound=sweep.a_sound[0])
        return design_plant(model, condition, actuators=actuators, sensors=sensors)

    plants = plant_at(sweep.V)
    name = plants.inputs[0] if control is None else control
    moved = {a.control for a in model.actuators} if actuators else set()
    shown = [o for o in plants.outputs if o.removesuffix("_rad") not in moved]
    curves = []
    for output in shown:

        def at(V: float, output: str = output) -> Array:
            return _settled(plant_at(np.array([V]))[0], name, output)

        rows = [_settled(plants[i], name, output) for i in range(len(sweep.V))]
        values = np.full((len(rows), max(map(len, rows))), complex(np.nan, np.nan))
        for i, row in enumerate(rows):
            values[i, : len(row)] = row
        counts = [int(np.sum(row.real > 0.0)) for row in rows]
        crossings = []
        for i in np.flatnonzero(np.diff(counts)).tolist():
            low, high, before = float(sweep.V[i]), float(sweep.V[i + 1]), counts[i]
            while high - low > 1e-9 * high:
                middle = 0.5 * (low + high)
                same = int(np.sum(at(middle).real > 0.0)) == before
                low, high = (middle, high) if same else (low, middle)
            crossings.append(0.5 * (low + high))
        curves.append(ZeroCurve(sensor=output, V=sweep.V, zeros=values, crossings=tuple(crossings)))
    return tuple(curves)


def _settled(plant: LinearSystem, control: str, output: str) -> Array:
    """Zeros, those as good as at the origin exactly there."""
    zeros = transmission_zeros(plant, input=control, output=output)
    scale = np.abs(np.linalg.eigvals(plant.A)).max(initial=1.0)
    return np.where(np.abs(zeros) > AXIS * scale, zeros, 0.0)


def _balanced(system: LinearSystem) -> tuple[Array, Array, Array, Array]:
    """States, inputs and outputs scaled by powers of two so that entries are of one size; zeros stay."""
    from scipy.linalg import matrix_balance

    A, (scale, _) = matrix_balance(system.A, permute=False, separate=True)
    B, C, D = system.B / scale[:, None], system.C * scale, system.D
    column = np.maximum(np.abs(B).max(axis=0, initial=0.0), np.abs(D).max(axis=0, initial=0.0))
    column = np.where(column > 0.0, column, 1.0)
    row = np.maximum(np.abs(C).max(axis=1, initial=0.0), np.abs(D / column).max(axis=1, initial=0.0))
    row = np.where(row > 0.0, row, 1.0)
    size = max(float(np.abs(A).max(initial=0.0)), 1e-300)
    return A, B / column * size, C / row[:, None], D / column / row[:, None] * size


def _reduced(A: Array, B: Array, C: Array, D: Array) -> tuple[Array, Array, Array, Array]:
    """A system with the same finite zeros whose D has full row rank."""
    while len(D):
        size = max(float(np.abs(x).max(initial=0.0)) for x in (A, B, C, D)) or 1.0
        U, s, _ = np.linalg.svd(D) if D.size else (np.eye(len(D)), np.zeros(0), None)
        rank = int(np.sum(s > RANK * size))
        C, D = U.T @ C, U.T @ D
        D[rank:] = 0.0
        rest = C[rank:]
        if not len(rest):
            break
        _, s, Vh = np.linalg.svd(rest) if rest.size else (None, np.zeros(0), np.eye(len(A)))
        seen = int(np.sum(s > RANK * size))
        if not seen:
            C, D = C[:rank], D[:rank]
            break
        V = np.roll(Vh.T, -seen, axis=1)  # columns that the rest does not see come first
        m = len(A) - seen
        A, B, C = V.T @ A @ V, V.T @ B, C[:rank] @ V
        C, D = np.concatenate([C[:, :m], A[m:, :m]]), np.concatenate([D[:rank], B[m:]])
        A, B = A[:m, :m], B[:m]
    return A, B, C, D


def _reaches(system: LinearSystem) -> bool:
    """Whether the transfer function is not zero, at a point that is no root."""
    s = 1.7 + 0.9j * (1.0 + np.abs(system.A).max(initial=0.0))
    value = system.C @ np.linalg.solve(s * np.eye(len(system.A)) - system.A, system.B) + system.D
    return bool(np.linalg.matrix_rank(value) == min(value.shape))
