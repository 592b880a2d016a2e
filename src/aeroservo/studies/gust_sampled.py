"""Gust loads with a sampled controller in the loop: its samples are held, its delay counts.

The RMS is exact at the controller's sample instants: plant and shaping filter are sampled together, the noise of one
sample by Van Loan's integral, the loop closed there, and the covariance solves the discrete Lyapunov equation. The
peaks are those of the simulation engine, whose base step is a part of the sample.

Delays of sensors count in the peaks and are left out of the RMS.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.control.closed_loop import closed_loop
from aeroservo.control.controller import Controller
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, LinearSystem
from aeroservo.gust.intensity import Turbulence, constant_turbulence
from aeroservo.gust.sampling import step_covariance
from aeroservo.gust.turbulence import Model, vertical_filter
from aeroservo.simulate.disturbances import CosineGust
from aeroservo.simulate.engine import linearised, run_prepared
from aeroservo.simulate.prepare import prepare
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario, Stepping
from aeroservo.studies.gust_loads import GustLoads
from aeroservo.studies.gust_plant import GustPlant, gust_plant

if TYPE_CHECKING:
    from aeroservo.studies.root_loads import LoadRows

#: Time that is simulated after a gust. [s]
TAIL = 5.0


def sampled_gust_loads(
    model: AeroelasticModel,
    condition: FlightCondition,
    controller: Controller,
    *,
    gradients: ArrayLike,
    velocity: Callable[[ArrayLike], ArrayLike],
    turbulence: Turbulence | None = None,
    filter: Model = "dryden",
    loads: LoadRows | None = None,
) -> GustLoads:
    """Peaks and RMS of a model under a sampled controller.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.
    condition : FlightCondition
        One condition, shape ().
    controller : Controller
        Sampled.
    gradients : array_like, shape (n,)
        Gust gradient distances, positive. [m]
    velocity : callable
        Of `design_velocity`.
    turbulence : Turbulence, optional
        Lengths, and an intensity of 1 m/s; default L = 533.4 m.
    filter : {"dryden", "von_karman", "von_karman_blockset"}
        Spectrum.
    loads : LoadRows, optional
        Internal loads; their RMS is given, their peaks are not (the engine has no such channels).

    Returns
    -------
    found : GustLoads
        `critical` is None, `rms_by_frequency` nan; all nan and a note where the loop is unstable.

    Raises
    ------
    ValueError
        If a gradient is not positive, a channel of the controller is missing, or a gust is shorter than a step.
    """
    H = np.atleast_1d(np.asarray(gradients, dtype=float))
    if not np.all((H > 0.0) & np.isfinite(H)):
        raise ValueError(f"gust gradients must be positive [m], got {np.min(H):g}")
    U = np.asarray(velocity(H), dtype=float)
    plant = gust_plant(model, condition, loads=loads)
    state = constant_turbulence(1.0) if turbulence is None else turbulence
    growth, rms, infinite = _rms(plant, controller, state, filter, float(condition.q))
    empty = np.full((len(H), len(plant.outputs)), np.nan)
    notes = [*plant.notes, "RMS at the instants of the controller's samples; the critical gradient is not sought"]
    if growth < 0.0:
        peak, lowest, highest = _peaks(model, condition, controller, plant, H, U)
        if infinite:
            notes.append(f"{', '.join(infinite)}: the air forces hold the rate of the gust, whose RMS is infinite")
    else:
        peak = lowest = highest = empty
        notes.append(f"the closed loop is unstable at {plant.V:g} m/s (it grows at {growth:.4g} 1/s): no peaks, no RMS")
    return GustLoads(
        channels=plant.outputs, gradient=H, velocity=U, peak=peak, lowest=lowest, highest=highest, critical=None,
        rms=rms, rms_by_frequency=empty[0], growth=growth, notes=tuple(notes),
    )  # fmt: skip


def _rms(
    plant: GustPlant, controller: Controller, state: Turbulence, filter: Model, pressure: float
) -> tuple[float, Array, tuple[str, ...]]:
    """Growth of the loop, RMS of every channel at the samples, and the channels whose RMS is infinite."""
    from scipy.linalg import solve_discrete_lyapunov

    if np.ptp(plant.x_offset):
        raise ValueError("a sampled controller with gust zones apart has no exact RMS here: use `simulate`")
    gust, dt = vertical_filter(state, plant.V, model=filter), controller.dt_s
    assert dt is not None
    n, k = plant.A.shape[0], gust.A.shape[0]
    A = np.zeros((n + k, n + k))
    A[:n, :n], A[:n, n:], A[n:, n:] = plant.A, plant.B.sum(axis=1, keepdims=True) @ gust.C, gust.A
    C = np.concatenate([plant.C, plant.D.sum(axis=1, keepdims=True) @ gust.C], axis=1)
    states = tuple(f"{i}" for i in range(n + k))
    finite = ~np.any(plant.rate != 0.0, axis=1)
    names = tuple(name for name, ok in zip(plant.outputs, finite) if ok)
    open_loop = LinearSystem(
        A=A, B=np.vstack([plant.B_command, np.zeros((k, len(plant.commands)))]), C=C[finite],
        D=plant.D_command[finite], states=states, inputs=plant.commands, outputs=names,
        input_delay_s=plant.command_delay,
    )  # fmt: skip
    loop = closed_loop(open_loop, controller, pressure=pressure)
    growth = float(np.log(max(np.abs(np.linalg.eigvals(loop.A)).max(), 1e-300)) / dt)
    rms = np.full(len(plant.outputs), np.nan)
    if growth < 0.0:
        W = np.zeros(loop.A.shape)
        at = [loop.states.index(name) for name in states]
        W[np.ix_(at, at)] = step_covariance(A, np.vstack([np.zeros((n, 1)), gust.B]), dt)
        P = solve_discrete_lyapunov(loop.A, W)
        rms[finite] = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", loop.C, P, loop.C), 0.0))
    return growth, rms, tuple(name for name, ok in zip(plant.outputs, finite) if not ok)


def _peaks(
    model: AeroelasticModel, condition: FlightCondition, controller: Controller, plant: GustPlant, H: Array, U: Array
) -> tuple[Array, Array, Array]:
    """Largest magnitude and extremes of the channels that the engine has; nan for the others."""
    peak, lowest, highest = (np.full((len(H), len(plant.outputs)), np.nan) for _ in range(3))
    flight = level(plant.V, density=float(condition.rho))
    for row, (gradient, amplitude) in enumerate(zip(H, U)):
        gust = CosineGust(amplitude=float(amplitude), length=2.0 * float(gradient), start=0.0)
        scenario = Scenario(
            profile=flight, duration=2.0 * float(gradient) / plant.V + TAIL, gusts=(gust,), controller=controller
        )
        run = run_prepared(prepare(linearised(model), scenario, Stepping()))
        assert run.history is not None
        for j, name in enumerate(plant.outputs):
            if name in run.channels:
                peak[row, j] = run.peak[run.channels.index(name)]
                values = run.history[name]
                lowest[row, j], highest[row, j] = min(values.min(), 0.0), max(values.max(), 0.0)
    return peak, lowest, highest
