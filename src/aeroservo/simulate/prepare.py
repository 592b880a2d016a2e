"""From a model and a scenario to what the compiled engine steps: grid, rows, exact matrices, number of substeps."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from aeroservo.control.controller import Controller
from aeroservo.datatypes import AeroelasticModel, Array, LinearSystem
from aeroservo.gust.discrete import check_sampling
from aeroservo.simulate._kernels import CLIP, PLAY
from aeroservo.simulate.assemble import Stepper, linear_stepper, stepper
from aeroservo.simulate.disturbances import CosineGust
from aeroservo.simulate.profiles import Profile
from aeroservo.simulate.scenario import Prepared, Scenario, Stepping, start_state
from aeroservo.simulate.state import RunState

STEPS_PER_PERIOD = 30
"""Runge-Kutta steps in the shortest period before the halving check."""

INTERPOLATION = 1e-7
"""Largest error of rows between knots, part of the largest entry of each row."""

PROBE_S = 2.0
"""Length of the halving check. [s]"""

BASE_STEP = 1e-3
"""Base step where none is asked for. [s]"""

ROUGH = 1e-5
"""Tolerance of the halving check for models with corners (clips, play, gaps, tables)."""

HALVINGS = 7
"""Halvings before the check gives up and says so."""


def prepare(model: AeroelasticModel | LinearSystem, scenario: Scenario, stepping: Stepping) -> Prepared:
    """Make a scenario ready to run; runs of other seeds need nothing more.

    Parameters
    ----------
    model : AeroelasticModel or LinearSystem
        What is stepped.
    scenario : Scenario
        What happens.
    stepping : Stepping
        How.

    Returns
    -------
    prepared : Prepared
        Ready. [SI]

    Raises
    ------
    ValueError
        If the model has no state space, a name is unknown, or the method does not fit the model.
    """
    controller = scenario.controller
    inside = None if controller is None else controller.continuous
    if isinstance(model, LinearSystem):
        if inside is not None:
            raise ValueError("a continuous controller needs an aeroelastic model: give it a sample time (dt_s)")
        s = linear_stepper(model)
    else:
        s = stepper(model, scenario.profile.condition(0.0), inside)
    check_names(s, scenario)
    dt, period, computing, notes = base_grid(s, controller, stepping)
    for gust in scenario.gusts:
        if isinstance(gust, CosineGust):
            check_sampling(gust.length, scenario.profile.V, dt)
    moving = scenario.profile.moving and not isinstance(model, LinearSystem)
    knots = np.zeros((0, 0, 0)) if moving else s.rows(scenario.profile.condition(np.zeros(1)))
    per_knot = spacing(s, scenario.profile, dt) if moving else 1
    linear = not moving and not len(s.elements.kinds) and not len(s.stops)
    if stepping.method == "exact" and not linear:
        raise ValueError(
            "method 'exact' needs a linear model in a flight that does not change; this one has "
            + (", ".join(s.elements.names) or ("hard stops" if len(s.stops) else "a changing flight"))
        )
    exact = (np.zeros((0, 0)), np.zeros((4, 0, 0)))
    if linear and stepping.method != "rk4":
        exact = exact_step(knots[0], s.sizes, dt)
    prepared = Prepared(
        stepper=s,
        scenario=scenario,
        stepping=stepping,
        dt=dt,
        steps=max(1, math.floor(scenario.duration / dt + 1e-6)),
        period=period,
        computing=computing,
        knots=knots,
        per_knot=per_knot,
        exact=exact,
        substeps=stepping.substeps or 1,
        halving=None,
        warnings=tuple(notes),
    )
    RunState(prepared, 0).external(np.zeros(1))  # names are checked before any work is done
    return prepared if exact[0].size or stepping.substeps else _checked(prepared)


def check_names(s: Stepper, scenario: Scenario) -> None:
    """Refuse gusts that a model does not feel, doublets without a command, states that do not exist.

    Parameters
    ----------
    s : Stepper
        Names.
    scenario : Scenario
        What happens.

    Raises
    ------
    ValueError
        Naming what is missing.
    """
    if (scenario.gusts or scenario.turbulence) and not s.inputs:
        raise ValueError("the model has no gust input: its air forces have no gust column")
    weather, profile = scenario.turbulence, scenario.profile
    if weather is not None and isinstance(weather.level, str) and profile.altitude is None:
        raise ValueError(
            f"turbulence {weather.level!r} goes by altitude, and there is only a density: give an RMS [m/s]"
        )
    if weather is not None and profile.altitude is not None:
        weather.state(profile.altitude)  # refuses what lies below ground or above the tables
    if scenario.doublets and not s.commands:
        raise ValueError("the model has no control for a doublet")
    start_state(s, scenario)


def base_grid(s: Stepper, controller: Controller | None, stepping: Stepping) -> tuple[float, int, int, list[str]]:
    """Base step, steps in a controller's sample and in its delay, and what had to be rounded.

    Parameters
    ----------
    s : Stepper
        Its dead times.
    controller : Controller, optional
        Its sample and computing delay.
    stepping : Stepping
        The step asked for.

    Returns
    -------
    dt, period, computing, notes : float, int, int, list of str
        Step [s] and counts.
    """
    wanted = stepping.dt or BASE_STEP
    sensors = () if isinstance(s.model, LinearSystem) else s.model.sensors
    delays = {f"dead time of {name}": float(d) for name, d in zip(s.commands, s.delays_s) if d}
    period, computing = 1, 0
    if controller is not None and controller.dt_s is not None:
        delays |= {f"delay of sensor {x.name}": x.delay_s for x in sensors if x.delay_s}
        if controller.delay_s:
            delays["computing delay"] = controller.delay_s
        least = max(1, math.ceil(controller.dt_s / wanted - 1e-9))
        fits = [m for m in range(least, least + 65) if all(_whole(d * m / controller.dt_s) for d in delays.values())]
        period = fits[0] if fits else least
        dt = controller.dt_s / period
        computing = round(controller.delay_s / dt)
    else:
        dt = wanted
    notes = [
        f"{name} of {d:g} s is rounded to {round(d / dt) * dt:g} s, a whole number of base steps"
        for name, d in delays.items()
        if not _whole(d / dt)
    ]
    return dt, period, computing, notes


def spacing(s: Stepper, profile: Profile, dt: float) -> int:
    """Base steps between knots, such that rows between them are right to `INTERPOLATION`.

    Parameters
    ----------
    s : Stepper
        Makes rows.
    profile : Profile
        The flight.
    dt : float
        Base step. [s]

    Returns
    -------
    per_knot : int
        A power of two.
    """
    starts = np.linspace(0.0, profile.duration, 41)[:-1]
    per_knot = 1024
    while per_knot > 1:
        width = per_knot * dt
        left, middle, right = (s.rows(profile.condition(starts + f * width)) for f in (0.0, 0.5, 1.0))
        error = np.abs(0.5 * (left + right) - middle).max(axis=-1)
        scale = np.abs(middle).max(axis=-1)
        corner = (starts < profile.duration - width)[:, None]
        if np.all(error <= INTERPOLATION * scale + 1e-300) or not np.any(corner):
            return per_knot
        per_knot //= 2
    return 1


def exact_step(Z: Array, sizes: tuple[int, int, int, int, int], dt: float) -> tuple[Array, Array]:
    """Matrices of one exact step: transition, and drives of held inputs and of gusts by a parabola over the step.

    Parameters
    ----------
    Z : ndarray, shape (n_row, n_col)
        Rows. [SI]
    sizes : tuple of int
        n_x, n_w, n_s, n_phi, n_y.
    dt : float
        Base step. [s]

    Returns
    -------
    Phi : ndarray, shape (n_x, n_x)
        Transition. [SI]
    drive : ndarray, shape (4, n_x, n)
        Of what is held (and the one), of gusts at the start, the middle and the end of the step. [SI]

    References
    ----------
    C. F. Van Loan, IEEE Trans. Autom. Control 23(3), 1978; C. Moler and C. Van Loan, SIAM Rev. 45(1), 2003.
    """
    from scipy.linalg import expm

    n_x, n_w, n_s, _, _ = sizes
    held = np.concatenate([Z[:n_x, n_x + n_w : n_x + n_w + n_s], Z[:n_x, -1:]], axis=1)
    gust = Z[:n_x, n_x : n_x + n_w]
    m = held.shape[1]
    big = np.zeros((n_x + m + 3 * n_w, n_x + m + 3 * n_w))
    big[:n_x, :n_x], big[:n_x, n_x : n_x + m] = Z[:n_x, :n_x] * dt, held * dt
    at = n_x + m
    big[:n_x, at : at + n_w] = gust * dt  # a chain: w = c0 + c1 f + c2 f^2/2 over the fraction f of the step
    for i in range(2):
        rows = np.arange(at + i * n_w, at + (i + 1) * n_w)
        big[rows, rows + n_w] = 1.0
    E = expm(big)
    c0, c1, c2 = (E[:n_x, at + i * n_w : at + (i + 1) * n_w] for i in range(3))
    drive = np.zeros((4, n_x, max(m, n_w)))
    drive[0, :, :m] = E[:n_x, n_x : n_x + m]
    # f^2 coefficient 2(a - 2b + c), f coefficient -3a + 4b - c of the parabola through a, b, c at 0, 1/2, 1
    drive[1, :, :n_w] = c0 - 3.0 * c1 + 4.0 * c2
    drive[2, :, :n_w] = 4.0 * c1 - 8.0 * c2
    drive[3, :, :n_w] = -c1 + 4.0 * c2
    return E[:n_x, :n_x].copy(), drive


def fastest(prepared: Prepared) -> float:
    """Largest magnitude of an eigenvalue over the run, elements taken as straight lines.

    Parameters
    ----------
    prepared : Prepared
        Rows.

    Returns
    -------
    rate : float
        Of any mode, lag, actuator or filter. [rad/s]
    """
    s = prepared.stepper
    n_x, n_w, n_s, n_phi, _ = s.sizes
    times = np.linspace(0.0, prepared.steps * prepared.dt, 21)
    knots = prepared.knots if prepared.knots.size else s.rows(prepared.scenario.profile.condition(times))
    A = knots[:, :n_x, :n_x].copy()
    gradient = np.zeros((len(knots), n_phi, n_x))
    for j in range(n_phi):
        inner = knots[:, n_x + j]
        slope = inner[:, :n_x] + np.einsum("kp,kpx->kx", inner[:, n_x + n_w + n_s : -1], gradient)
        gradient[:, j] = slope if s.elements.kinds[j] in (CLIP, PLAY) else 0.0
    A += knots[:, :n_x, n_x + n_w + n_s : -1] @ gradient
    return float(np.abs(np.linalg.eigvals(A)).max(initial=0.0))


def _checked(prepared: Prepared) -> Prepared:
    """With the number of substeps that passes the halving check."""
    s, stepping = prepared.stepper, prepared.stepping
    rate = fastest(prepared)
    substeps = max(1, math.ceil(prepared.dt * rate * STEPS_PER_PERIOD / (2.0 * math.pi) - 1e-9))
    tolerance = stepping.tolerance if s.elements.smooth and not len(s.stops) else max(ROUGH, stepping.tolerance)
    before, difference = _probe(prepared, substeps), math.inf
    for _ in range(HALVINGS):
        after = _probe(prepared, 2 * substeps)
        n = min(len(before), len(after))
        scale = np.abs(after[:n] - s.equilibrium).max(axis=0, initial=0.0)
        scale = np.maximum(scale, 1e-12 * scale.max(initial=0.0))
        difference = float(np.max(np.abs(before[:n] - after[:n]) / np.where(scale > 0.0, scale, 1.0), initial=0.0))
        substeps *= 2
        if difference <= tolerance:
            return replace(prepared, substeps=substeps, halving=difference)
        before = after
    note = f"halving the step still changes the response by {difference:.1e} of its largest value: take a smaller dt"
    return replace(prepared, substeps=substeps, halving=difference, warnings=(*prepared.warnings, note))


def _probe(prepared: Prepared, substeps: int) -> Array:
    """States at base steps over the first two seconds; a kick where nothing moves the model at the start."""
    s = prepared.stepper
    n = min(prepared.steps, math.ceil(PROBE_S / prepared.dt))
    start = start_state(s, prepared.scenario)
    if not np.any(start):
        start[: min(2, len(start))] = 1e-3
    state = RunState(prepared, 0, initial=start)
    trace = np.zeros((n * substeps, s.sizes[0]))
    code, steps, _, _ = state.advance(0, n, 1, np.zeros((0, s.sizes[4])), trace, substeps=substeps)
    done = steps if code else n
    return trace[substeps - 1 : done * substeps : substeps]


def _whole(x: float) -> bool:
    """Whether a ratio is a whole number to rounding."""
    return abs(x - round(x)) <= 1e-6
