"""Flutter with the loop closed: where a model with its controller becomes unstable.

The search is that of `flutter` (p method): unstable roots are counted, every change refined, growth maximised between
speeds. Roots are eigenvalues of the closed loop; of a sampled one s = log(z)/dt. Limits of controller and actuators are
left out: this is the boundary of small motions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from aeroservo.aeroelastic.branches import Branches, unstable_intervals
from aeroservo.aeroelastic.flutter import SEARCH_POINTS, FlutterResult, P, check_sweep, prepared, remembered
from aeroservo.aeroelastic.roots import frequency_scale, normalised, slowest
from aeroservo.aeroelastic.stability import Boundary, boundaries
from aeroservo.aeroelastic.static import divergence
from aeroservo.aeroelastic.tracking import follow, resolved_mesh
from aeroservo.control.closed_loop import as_rates, closed_loop, loop_plant
from aeroservo.control.controller import Controller
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, LinearSystem
from aeroservo.structure.modal import natural_modes

Roots = Callable[[Array], Array]


def closed_flutter(
    model: AeroelasticModel, sweep: FlightCondition, controller: Controller, *, fit_bound: float = 0.01
) -> FlutterResult:
    """Speeds at which a model with its controller flutters or becomes unstable aperiodically.

    Parameters
    ----------
    model : AeroelasticModel
        Any; actuators, sensor lags and dead times are part of the loop, nonlinear springs are taken by their linear
        stiffness, sampled air forces are fitted first.
    sweep : FlightCondition
        Two or more ascending speeds at one density, shape (n_V,). [m/s, kg/m^3]
    controller : Controller
        Continuous or sampled; a schedule is interpolated at each dynamic pressure.
    fit_bound : float
        Largest allowed error of the fit, part of the largest |Q| of each column. [-]

    Returns
    -------
    result : FlutterResult
        As of `flutter`; the static divergence speed in it is that of the wing alone. Branches are the modes, the
        actuators, and whatever else is ever unstable. [SI]

    Raises
    ------
    ValueError
        If the sweep is not an ascending row at one density, the model has no state space, or a channel is missing.

    References
    ----------
    contract.md, "flutter" (`--controller`); Bramstång 2015, section 9.4; K. J. Åström and B. Wittenmark,
    Computer-Controlled Systems, 1997, section 2.6.

    Examples
    --------
    A pitch-rate damper moves the flutter of the thesis' model (45.4 m/s) out of the range.

    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> from aeroservo.control.controller import state_feedback
    >>> gain = state_feedback(np.array([[-0.1]]), ("pitch_rate_rad_s",), ("elevon_command_rad",), None)
    >>> sweep = FlightCondition.at(3048.0, V=np.linspace(20.0, 90.0, 71))
    >>> closed_flutter(build(read("thesis-simulation")), sweep, gain).found
    False
    """
    check_sweep(sweep)
    model, fit = prepared(model, P(fit_bound=fit_bound))
    scale = frequency_scale(model)

    def loop_at(V: Array) -> LinearSystem:
        condition = FlightCondition(V=V, rho=sweep.rho[0], a_sound=sweep.a_sound[0])
        return closed_loop(loop_plant(model, condition, controller), controller, pressure=condition.q)

    values_at = remembered(lambda V: _rates(loop_at(V).A, controller.dt_s))
    mesh = np.union1d(sweep.V, np.linspace(sweep.V[0], sweep.V[-1], SEARCH_POINTS))
    changes = boundaries(values_at, mesh, values_at(mesh), scale)
    mesh = np.union1d(mesh, [b.V for b in changes])
    start = 1e-3 * slowest(model) * model.aero.b
    branches = _branches(model, controller, values_at, loop_at, mesh, start)
    intervals = tuple(unstable_intervals(changes, branches, float(sweep.V[0]), scale))
    unstable = {i.mode for i in intervals}
    intervals = tuple(replace(i, mode=_at_nyquist(i.frequency, controller, i.mode)) for i in intervals)
    names, values, shapes = _shown(model, branches, loop_at(sweep.V), sweep.V, unstable)
    onset = None
    if not any(i.start is None and i.kind == "flutter" for i in intervals):
        onset = next((b for b in changes if b.kind == "oscillatory" and b.opens), None)
    return FlutterResult(
        condition=sweep,
        method="p",
        names=names,
        speeds=np.broadcast_to(sweep.V[:, None], values.shape),
        roots=values,
        shapes=shapes,
        boundaries=tuple(changes),
        intervals=intervals,
        flutter_speed=onset.V if onset else None,
        flutter_frequency=onset.root.imag if onset else None,
        flutter_mode=_at_nyquist(onset.root.imag, controller, branches.name_at(onset.V, onset.root)) if onset else None,
        divergence_speed=divergence(model, sweep[0]).V,
        first_real_instability=_first_real(changes),
        fit=fit,
        warnings=_warnings(model, sweep, controller, any(i.start is None for i in intervals)),
    )


def _rates(A: Array, dt: float | None) -> Array:
    """Eigenvalues as s."""
    z = np.asarray(np.linalg.eigvals(A)).astype(complex)
    return z if dt is None else as_rates(z, dt)


def _at_nyquist(frequency: float, controller: Controller, name: str) -> str:
    """A root on the negative real axis of z is no mode: commands that change their sign at every sample."""
    dt = controller.dt_s
    return "sampling" if dt is not None and abs(frequency * dt - np.pi) < 1e-9 else name


def _first_real(changes: list[Boundary]) -> float | None:
    return next((b.V for b in changes if (b.kind == "real" and b.opens) or b.kind == "split"), None)


def _branches(
    model: AeroelasticModel,
    controller: Controller,
    values_at: Roots,
    loop_at: Callable[[Array], LinearSystem],
    mesh: Array,
    start: float,
) -> Branches:
    """Roots followed from near rest, where they are the modes, the actuators, the sensors, the controller, the lags."""
    lead = np.geomspace(start, mesh[0], 12)[:-1] if start < mesh[0] else np.zeros(0)
    mesh = np.concatenate([lead, mesh])
    mesh, values, steps = resolved_mesh(values_at, mesh, values_at(mesh), quarterings=3)
    followed = np.take_along_axis(values, follow(values, steps), axis=1)
    names = _names(model, controller, loop_at(mesh[:1])[0], followed[0])
    primary = np.array([not np.isfinite(root) or root.imag >= 0.0 for root in followed[0]])
    return Branches(V=mesh, roots=followed, names=tuple(names), primary=primary)


def _names(model: AeroelasticModel, controller: Controller, loop: LinearSystem, first: Array) -> list[str]:
    """Names of the roots near rest, each nearest to what it is without air."""
    natural = natural_modes(model.modes)
    known: list[tuple[str, complex]] = [(name, 1j * float(w)) for name, w in zip(natural.names, natural.omega)]
    for a in model.actuators:
        pole = -a.omega + 0j if a.zeta is None else a.omega * (-a.zeta + np.emath.sqrt(a.zeta**2 - 1.0))
        known.append((f"actuator {a.control}", complex(pole)))
    known += [(f"sensor {s.name}", complex(-s.bandwidth)) for s in model.sensors if s.bandwidth is not None]
    own = np.asarray(np.linalg.eigvals(controller.A[0])).astype(complex)
    own = own if controller.dt_s is None else as_rates(own, controller.dt_s)
    own = own[np.isfinite(own) & (own.imag >= 0.0)]
    known += [(f"controller {j + 1}", complex(s)) for j, s in enumerate(own)]
    names = [""] * len(first)
    for name, pole in known:
        free = [j for j, taken in enumerate(names) if not taken and np.isfinite(first[j]) and first[j].imag >= 0.0]
        if not free:
            break
        j = min(free, key=lambda j: abs(first[j] - pole))
        names[j] = name
        if first[j].imag > 0.0:
            mirror = int(np.nanargmin(np.abs(first - first[j].conj())))
            names[mirror] = names[mirror] or name
    lags = sorted((abs(first[j]) if np.isfinite(first[j]) else np.inf, j) for j, name in enumerate(names) if not name)
    for number, (_, j) in enumerate(lags):
        names[j] = f"lag {number + 1}"
    return names


def _shown(
    model: AeroelasticModel, branches: Branches, loop: LinearSystem, V: Array, unstable: set[str]
) -> tuple[tuple[str, ...], Array, Array]:
    """Modes, actuators and what is ever unstable, at the speeds of the sweep, with shapes in the modes."""
    modes = {*model.modes.names, *natural_modes(model.modes).names}
    wanted = [
        j
        for j, name in enumerate(branches.names)
        if branches.primary[j] and (name in modes or name.startswith("actuator ") or name in unstable)
    ]
    rank = np.array([branches.names[j] not in modes for j in wanted])
    start = np.array([np.nan_to_num(branches.roots[0, j].imag) for j in wanted])
    wanted = [wanted[k] for k in np.lexsort((start, rank))]
    values = branches.roots[np.searchsorted(branches.V, V)][:, wanted]
    z, vectors = np.linalg.eig(loop.A)
    s = z.astype(complex) if loop.dt is None else as_rates(z.astype(complex), loop.dt)
    at = [loop.states.index(name) for name in _displacements(model) if name in loop.states]
    shape = np.zeros((*z.shape, model.modes.n), dtype=complex)
    kept = [i for i, name in enumerate(_displacements(model)) if name in loop.states]
    shape[..., kept] = np.moveaxis(vectors[..., at, :], -1, -2)
    distance = np.abs(np.where(np.isfinite(s), s, np.inf)[:, None, :] - values[:, :, None])
    pick = np.argmin(np.where(np.isfinite(distance), distance, np.inf), axis=2)
    return tuple(branches.names[j] for j in wanted), values, np.take_along_axis(normalised(shape), pick[..., None], 1)


def _displacements(model: AeroelasticModel) -> list[str]:
    """State names of the displacements."""
    units = model.modes.units
    return [name.replace(" ", "_") + (f"_{unit}" if unit else "") for name, unit in zip(model.modes.names, units)]


def _warnings(
    model: AeroelasticModel, sweep: FlightCondition, controller: Controller, from_start: bool
) -> tuple[str, ...]:
    """What to know before trusting the numbers."""
    notes = []
    if np.all(model.aero.mach == 0.0) and float(sweep.mach.max()) > 0.3:
        notes.append("speeds above Mach 0.3: incompressible theory")
    if from_start:
        notes.append(f"already unstable at the lowest speed, {sweep.V[0]:g} m/s: start the sweep lower")
    if model.springs:
        notes.append("nonlinear springs are taken by their linear stiffness, without freeplay")
    if any(controller.limits) or any(a.limit or a.rate_limit for a in model.actuators):
        notes.append("limits of controller and actuators are left out: small motions; larger ones by simulation")
    return (*notes, *held_notes(controller, sweep))


def held_notes(controller: Controller, sweep: FlightCondition) -> tuple[str, ...]:
    """Whether a sweep leaves the dynamic pressures of a schedule.

    Parameters
    ----------
    controller : Controller
        With or without a schedule.
    sweep : FlightCondition
        Any shape.

    Returns
    -------
    notes : tuple of str
        One sentence if it does: beyond its ends a schedule is held.

    References
    ----------
    contract.md, "Controller file (JSON)": no extrapolation beyond the ends.

    Examples
    --------
    >>> from aeroservo.control.controller import state_feedback
    >>> held_notes(state_feedback([[1.0]], ("pitch_rad",), ("elevon_rad",), None), FlightCondition(V=50.0, rho=1.2))
    ()
    """
    low, high = float(controller.pressures[0]), float(controller.pressures[-1])
    inside = sweep.q.min() >= low * (1.0 - 1e-9) and sweep.q.max() <= high * (1.0 + 1e-9)
    if inside or len(controller.pressures) < 2:
        return ()
    return (f"the schedule is held outside its {low:.6g} to {high:.6g} Pa",)
