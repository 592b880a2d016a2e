"""A family of linear models over airspeed, density and torsional stiffness, small enough to travel in a page.

Where the air forces do not change with Mach number, every entry of A and B is a polynomial: of second degree in
airspeed, of first in stiffness, and a smooth function of density (the moving air adds mass). So few nodes carry all of
it; `live_family` takes as many as interpolation at other places needs to be right to `TOLERANCE`, and says how right it
is. Gains of a regulator come along, scheduled by dynamic pressure.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from aeroservo.aeroelastic.aircraft_lattice import ANTISYMMETRIC
from aeroservo.aeroelastic.linear import displacement_free, linear_system
from aeroservo.aircraft.schema_base import FileModel
from aeroservo.control.lqr import LQR
from aeroservo.control.plant import sampled_plant
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, LinearSystem
from aeroservo.structure.modal import natural_modes, tip_motion
from aeroservo.studies.live_parts import small_model, torsional_stiffness

TOLERANCE = 2e-10
"""Largest error of interpolated matrices, part of the largest entry of each row."""
MOST_NODES = 7
GUST_ENERGY = 0.02
"""Tip deflection that is worth the largest control deflection, of the span."""
LARGEST_CONTROL = np.radians(10.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class LiveFamily:
    """Linear models on a grid of nodes, and gains; see `live_family`.

    Attributes
    ----------
    V, rho, factor : ndarray, shapes (n_V,), (n_rho,), (n_f,)
        Nodes: true airspeed [m/s], density [kg/m^3], torsional stiffness over that of the model [-].
    A : ndarray, shape (n_V, n_rho, n_f, n_x, n_x)
        State matrices. [SI]
    B : ndarray, shape (n_V, n_rho, n_f, n_x, n_u)
        Inputs: controls [rad], then gust zones [m/s]. [SI]
    states, inputs : tuple of str
        Names with units.
    controls : int
        How many of the inputs are controls.
    offsets : ndarray, shape (n_gust,)
        Places of the gust zones behind the reference point. [m]
    tip : ndarray, shape (2, n_x)
        Deflection up [m] and twist nose up [rad] of the tip, per state.
    pressures : ndarray, shape (n_q,)
        Dynamic pressures of the gains, ascending; empty where there is no control. [Pa]
    K : ndarray, shape (n_q, n_c, n_x)
        State feedback u = -K x, sampled and held. [SI]
    dt_s : float
        Its sample time. [s]
    modes : tuple of str
        Coordinates that are kept.
    error : float
        Error of interpolation at other places, part of the largest entry of each row. [-]
    fit_error : float, optional
        Error of the fit of sampled air forces. [-]
    model : AeroelasticModel
        That the family was made of.
    K_torsion : ndarray, shape (n, n)
        The part of the stiffness that `factor` multiplies; zero where it is not known. [SI]
    """

    V: Array
    rho: Array
    factor: Array
    A: Array
    B: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    controls: int
    offsets: Array
    tip: Array
    pressures: Array
    K: Array
    dt_s: float
    modes: tuple[str, ...]
    error: float
    fit_error: float | None
    model: AeroelasticModel
    K_torsion: Array

    def at(self, V: float, rho: float, factor: float = 1.0) -> LinearSystem:
        """The model between the nodes; its outputs are its states. [SI]"""
        weights = [lagrange(nodes, x) for nodes, x in ((self.V, V), (self.rho, rho), (self.factor, factor))]
        A, B = (np.einsum("i,j,k,ijk...->...", *weights, X) for X in (self.A, self.B))
        n = len(self.states)
        return LinearSystem(
            A=A, B=B, C=np.eye(n), D=np.zeros((n, len(self.inputs))), states=self.states, inputs=self.inputs,
            outputs=self.states,
        )  # fmt: skip

    def gain(self, pressure: float) -> Array:
        """Gain at a dynamic pressure [Pa], linear between designs, held outside, shape (n_c, n_x). [SI]"""
        at = np.clip(np.interp(pressure, self.pressures, np.arange(len(self.pressures))), 0, len(self.pressures) - 1)
        low = min(int(at), len(self.pressures) - 2) if len(self.pressures) > 1 else 0
        high = min(low + 1, len(self.pressures) - 1)
        return np.asarray(self.K[low] + (at - low) * (self.K[high] - self.K[low]))


def lagrange(nodes: Array, x: float) -> Array:
    """Weights of the polynomial through values at nodes.

    Parameters
    ----------
    nodes : ndarray, shape (n,)
        Different. [any]
    x : float
        Where it is wanted. [unit of the nodes]

    Returns
    -------
    weights : ndarray, shape (n,)
        Their sum is 1. [-]
    """
    return np.array(
        [np.prod([(x - b) / (a - b) for j, b in enumerate(nodes) if j != i]) for i, a in enumerate(nodes)], dtype=float
    )


def live_family(
    file: FileModel,
    model: AeroelasticModel,
    *,
    V: tuple[float, float],
    rho: tuple[float, float],
    factor: tuple[float, float] = (0.5, 1.5),
    designs: int = 12,
    rate_Hz: float = 100.0,
) -> LiveFamily:
    """Linear models of a wing over airspeed, density and torsional stiffness.

    Parameters
    ----------
    file : FileModel
        From `aeroservo.read`.
    model : AeroelasticModel
        Built from it; its first modes are taken, and sampled air forces are fitted.
    V, rho, factor : (float, float)
        Ranges. [m/s, kg/m^3, -]
    designs : int
        Dynamic pressures at which a regulator is designed, between those of both ends of the range at its highest
        density.
    rate_Hz : float
        Sample rate of the controller. [Hz]

    Returns
    -------
    family : LiveFamily
        Nodes, matrices, gains. [SI]

    Raises
    ------
    ValueError
        If the air forces cannot be fitted, or change with airspeed in a way that few nodes do not follow.
    """
    model, fit_error = small_model(model)
    K_torsion = torsional_stiffness(file, model)
    span = factor if np.any(K_torsion) and not model.modes.relaxing else (1.0, 1.0)  # what relaxes stays as it is
    nodes, A, B, system = _matrices(model, K_torsion, (V, rho, span))
    controls = [k for k, name in enumerate(system.inputs) if not name.startswith("gust")]
    chosen = [k for k in controls if ANTISYMMETRIC not in system.inputs[k]] or controls
    order = [*chosen, *(k for k in range(len(system.inputs)) if k not in controls)]
    h, twist = tip_motion(model.modes)
    tip = np.zeros((2, len(system.states)))
    tip[:, : model.modes.n] = -h, twist
    free = np.flatnonzero(displacement_free(model.modes, model.aero))
    kept = np.setdiff1d(np.arange(len(system.states)), free)  # where it flies, nothing depends on
    A, B, tip = A[..., kept, :][..., kept], B[..., kept, :], tip[:, kept]
    family = LiveFamily(
        V=nodes[0], rho=nodes[1], factor=nodes[2], A=A, B=B[..., order], states=tuple(system.states[k] for k in kept),
        inputs=tuple(system.inputs[k] for k in order), controls=len(chosen),
        offsets=np.array([i.x_offset for i in model.aero.inputs if i.kind == "gust"]), tip=tip,
        pressures=np.zeros(0), K=np.zeros((0, len(chosen), len(system.states))), dt_s=1.0 / rate_Hz,
        modes=model.modes.names, error=0.0, fit_error=fit_error, model=model, K_torsion=K_torsion,
    )  # fmt: skip
    family = replace(family, error=interpolation_error(family))
    return _with_gains(family, V, rho[1], designs) if chosen else family


def interpolation_error(family: LiveFamily, *, places: int = 12) -> float:
    """Error of interpolated matrices against those of the model at other places.

    Parameters
    ----------
    family : LiveFamily
        Of `live_family`.
    places : int
        How many; the same ones each time.

    Returns
    -------
    error : float
        The largest, part of the largest entry of each row. [-]
    """
    random = np.random.default_rng(1)
    worst = 0.0
    for x in random.uniform(size=(places, 3)):
        at = [nodes[0] + f * (nodes[-1] - nodes[0]) for nodes, f in zip((family.V, family.rho, family.factor), x)]
        here = family.at(*at)
        true = exact_system(family.model, family.K_torsion, *at)
        kept = [true.states.index(name) for name in family.states]
        order = [true.inputs.index(name) for name in family.inputs]
        worst = max(worst, _error(here.A, true.A[np.ix_(kept, kept)]), _error(here.B, true.B[np.ix_(kept, order)]))
    return worst


def exact_system(model: AeroelasticModel, K_torsion: Array, V: float, rho: float, factor: float) -> LinearSystem:
    """The linear system of a model at one place of the family, without interpolation.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.
    K_torsion : ndarray, shape (n, n)
        Part of the stiffness that `factor` multiplies. [SI]
    V, rho, factor : float
        Airspeed, density, stiffness over that of the model. [m/s, kg/m^3, -]

    Returns
    -------
    system : LinearSystem
        One condition. [SI]
    """
    changed = model.with_K(model.modes.K + (factor - 1.0) * K_torsion)
    return linear_system(changed, FlightCondition(V=np.asarray(V), rho=np.asarray(rho)))


def _matrices(
    model: AeroelasticModel, K_torsion: Array, ranges: tuple[tuple[float, float], ...]
) -> tuple[list[Array], Array, Array, LinearSystem]:
    """Nodes and matrices: more nodes along an axis until one more changes nothing."""
    count = [3, 2, 2]
    for axis, (low, high) in enumerate(ranges):
        if high <= low:
            count[axis] = 1
    while True:
        nodes = [_chebyshev(low, high, n) for (low, high), n in zip(ranges, count)]
        A, B, system = _batch(model, K_torsion, nodes)
        worst = _axis_errors(model, K_torsion, nodes, A)
        bad = [k for k in range(3) if worst[k] > TOLERANCE and count[k] > 1]
        if not bad:
            return nodes, A, B, system
        for k in bad:
            count[k] += 1
        if max(count) > MOST_NODES:
            raise ValueError("the model changes with airspeed or density in a way that few linear models do not follow")


def _chebyshev(low: float, high: float, n: int) -> Array:
    """Points thickest at the ends."""
    if n == 1:
        return np.array([0.5 * (low + high)])
    return 0.5 * (low + high) - 0.5 * (high - low) * np.cos(np.pi * np.arange(n) / (n - 1))


def _batch(model: AeroelasticModel, K_torsion: Array, nodes: list[Array]) -> tuple[Array, Array, LinearSystem]:
    """Matrices at all nodes."""
    V, rho = np.meshgrid(nodes[0], nodes[1], indexing="ij")
    systems = [
        linear_system(model.with_K(model.modes.K + (f - 1.0) * K_torsion), FlightCondition(V=V, rho=rho))
        for f in nodes[2]
    ]
    return np.stack([s.A for s in systems], axis=2), np.stack([s.B for s in systems], axis=2), systems[0]


def _axis_errors(model: AeroelasticModel, K_torsion: Array, nodes: list[Array], A: Array) -> list[float]:
    """Error between the nodes of each axis, on the others' last node."""
    out = [0.0, 0.0, 0.0]
    for axis in range(3):
        at = [float(n[-1]) for n in nodes]
        for middle in 0.5 * (nodes[axis][1:] + nodes[axis][:-1]):
            at[axis] = float(middle)
            weights = [lagrange(n, x) for n, x in zip(nodes, at)]
            here = np.einsum("i,j,k,ijk...->...", *weights, A)
            out[axis] = max(out[axis], _error(here, exact_system(model, K_torsion, *at).A))
    return out


def _error(here: Array, true: Array) -> float:
    scale = np.abs(true).max(axis=-1, keepdims=True)
    return float(np.max(np.abs(here - true) / np.where(scale > 0.0, scale, 1.0), initial=0.0))


def _with_gains(family: LiveFamily, V: tuple[float, float], rho: float, designs: int) -> LiveFamily:
    """Regulators over dynamic pressure: energy of motion against deflection of the controls."""
    speeds = np.linspace(V[0], V[1], designs)
    Q, R = energy_weights(family)
    inputs = family.inputs[: family.controls]
    K = [LQR(Q=Q, R=R)(sampled_plant(family.at(v, rho), family.dt_s, inputs=inputs)).K for v in speeds]
    return replace(family, pressures=0.5 * rho * speeds**2, K=np.array(K))


def energy_weights(family: LiveFamily) -> tuple[Array, Array]:
    """Weights of the regulator: the energy of the first mode at a tip deflection of 2 % of the span (2 % of a radian
    where there is no span) is worth ten degrees of every control.

    Parameters
    ----------
    family : LiveFamily
        Of `live_family`.

    Returns
    -------
    Q, R : ndarray, shapes (n_x, n_x), (n_c, n_c)
        For `LQR`. [SI]
    """
    m = family.model.modes
    n, natural = m.n, natural_modes(m)
    first = int(np.flatnonzero(natural.omega > 0.0)[0])
    shape = natural.shapes[:, first]
    h, twist = tip_motion(m)
    span = float(np.ptp(m.grid[:, 1])) or 1.0
    reach = max(abs(h @ shape) / span, abs(twist @ shape) / 4.0)
    energy = 0.5 * shape @ m.K @ shape * (GUST_ENERGY / reach) ** 2
    free = np.flatnonzero(displacement_free(m, family.model.aero))
    size = len(family.states) + len(free)
    Q = np.zeros((size, size))
    Q[:n, :n], Q[n : 2 * n, n : 2 * n] = 0.5 * m.K / energy, 0.5 * m.M / energy
    return np.delete(np.delete(Q, free, axis=0), free, axis=1), np.eye(family.controls) / LARGEST_CONTROL**2
