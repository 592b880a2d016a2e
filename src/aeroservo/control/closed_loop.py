"""A plant and a controller joined: the closed loop as a linear system, and its roots.

Controllers' outputs are added to the plant's inputs: u = r + K y. A sampled controller on a continuous plant gives the
discrete loop at its rate, with held commands and dead times inside (`plant.sampled_plant`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from aeroservo.control.controller import Controller, controller_of
from aeroservo.control.plant import design_plant, sampled_plant
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, LinearSystem

FORGOTTEN = 1e-3
"""Roots of a sampled system that keep less than this of themselves from sample to sample are as good as gone. [-]"""

_UNITS = ("rad", "rad_s", "m", "m_s", "m_s2")


def closed_loop(
    plant: LinearSystem, controller: Controller | LinearSystem, *, pressure: Array | float | None = None
) -> LinearSystem:
    """Join a plant and a controller.

    A continuous plant meets a sampled controller at the controller's rate, with its own `input_delay_s` and the
    controller's computing delay inside. A sampled plant is what the controller sees (`design_plant`): its delays,
    computing delay included, are inside already. Limits of the controller are left out.

    Parameters
    ----------
    plant : LinearSystem
        Continuous, or sampled at the controller's rate; leading axes are a batch. [SI]
    controller : Controller or LinearSystem
        Reads outputs and drives inputs of the plant by name (sensor names without unit are understood). A system may
        be a batch that broadcasts against the plant's.
    pressure : float or ndarray, shape (...), optional
        Dynamic pressure, for a controller with a schedule. [Pa]

    Returns
    -------
    system : LinearSystem
        Inputs and outputs of the plant (inputs add to the controller's commands); states of the plant, then of the
        controller. [SI]

    Raises
    ------
    ValueError
        If a channel is missing, the rates differ, a schedule lacks its pressure, a continuous loop has a delay, or
        the loop is algebraic without a solution.

    References
    ----------
    contract.md, "Controller file (JSON)"; equations.md, "Control" (u = -K x); K. J. Åström and B. Wittenmark,
    Computer-Controlled Systems, 1997, section 3.2.

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> unstable = LinearSystem(A=[[1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> gain = LinearSystem(A=np.zeros((0, 0)), B=np.zeros((0, 1)), C=np.zeros((1, 0)), D=[[-3.0]], states=(),
    ...                     inputs=("y",), outputs=("u",))
    >>> closed_loop(unstable, gain).A.tolist()
    [[-2.0]]
    """
    if isinstance(controller, LinearSystem):
        matrices: tuple[Array, ...] = controller.A, controller.B, controller.C, controller.D
        controller = _from_system(controller)
    else:
        matrices = controller_at(controller, pressure)
    plant = at_rate(plant, controller)
    if plant.input_delay_s:
        raise ValueError(
            f"a continuous loop with a delay of {plant.input_delay_s:g} s has no state space: sample the controller "
            "(dt_s), or ask for its margins, which take the delay exactly"
        )
    Ak, Bk, Ck, Dk = matrices
    scatter, rows = wiring(plant, controller)
    C_m, D_m = plant.C[..., rows, :], plant.D[..., rows, :]
    loop = np.eye(len(rows)) - D_m @ scatter @ Dk
    if np.any(np.abs(np.linalg.det(loop)) < 1e-12):
        raise ValueError("the loop is algebraic and has no solution: a command acts at once on what it is made from")
    E = np.linalg.inv(loop)
    n, n_c = len(plant.states), Ak.shape[-1]
    batch = np.broadcast_shapes(plant.A.shape[:-2], Ak.shape[:-2])

    def over(*blocks: Array) -> Array:
        return np.concatenate([np.broadcast_to(b, (*batch, *b.shape[-2:])) for b in blocks], axis=-1)

    # measured y = y_x [x, z] + y_v v, and u = u_x [x, z] + u_v v with v the outside inputs
    y_x, y_v = E @ over(C_m, D_m @ scatter @ Ck), E @ D_m
    none = np.zeros((len(plant.inputs), n))
    u_x, u_v = over(none, scatter @ Ck) + scatter @ Dk @ y_x, np.eye(len(plant.inputs)) + scatter @ Dk @ y_v
    top = over(plant.A, np.zeros((n, n_c))) + plant.B @ u_x
    low = over(np.zeros((n_c, n)), Ak) + Bk @ y_x
    return LinearSystem(
        A=np.concatenate([top, low], axis=-2),
        B=np.concatenate([np.broadcast_to(plant.B @ u_v, (*batch, n, len(plant.inputs))),
                          np.broadcast_to(Bk @ y_v, (*batch, n_c, len(plant.inputs)))], axis=-2),
        C=over(plant.C, np.zeros((len(plant.outputs), n_c))) + plant.D @ u_x,
        D=np.broadcast_to(plant.D @ u_v, (*batch, *plant.D.shape[-2:])),
        states=(*plant.states, *(f"controller_{i + 1}" for i in range(n_c))),
        inputs=plant.inputs,
        outputs=plant.outputs,
        dt=plant.dt,
    )  # fmt: skip


def loop_plant(
    model: AeroelasticModel, condition: FlightCondition, controller: Controller, *, delay_s: float = 0.0
) -> LinearSystem:
    """The plant that a controller sees: its channels, at its rate, with its computing delay.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces; its actuators, sensor lags and dead times are inside.
    condition : FlightCondition
        Any shape (...).
    controller : Controller
        Names what is read and driven.
    delay_s : float
        Delay on top of all others. [s]

    Returns
    -------
    plant : LinearSystem
        Sampled, or continuous for a continuous controller; batched as `condition`. [SI]

    Raises
    ------
    ValueError
        If a channel does not exist, or a continuous loop would have several delays.

    References
    ----------
    Project convention: one plant for design, margins and closed-loop flutter (`plant.design_plant`).

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> from aeroservo.control.controller import state_feedback
    >>> still = state_feedback(np.zeros((1, 1)), ("acc_te",), ("elevon_command_rad",), 0.01)
    >>> loop_plant(build(read("bact")), FlightCondition.at(0.0, V=100.0), still).dt
    0.01
    """
    dt = controller.dt_s
    names = [name.replace(" ", "_") for name in model.modes.names]
    displacements = {n + (f"_{u}" if u else "") for n, u in zip(names, model.modes.units)}
    plant = design_plant(
        model,
        condition,
        rate_Hz=None if dt is None else 1.0 / dt,
        delay_samples=0.0 if dt is None else (controller.delay_s + delay_s) / dt,
        sensors=controller.inputs,
        keep_free=bool(displacements & set(controller.inputs)),
    )
    if dt is None:
        return replace(plant, input_delay_s=plant.input_delay_s + delay_s)
    return replace(plant, dt=dt)


def at_rate(plant: LinearSystem, controller: Controller) -> LinearSystem:
    """A plant at the time base of a controller.

    Parameters
    ----------
    plant : LinearSystem
        Continuous or sampled. [SI]
    controller : Controller
        Continuous or sampled.

    Returns
    -------
    plant : LinearSystem
        Discretised with the controller's delay where it was continuous and the controller is not. [SI]

    Raises
    ------
    ValueError
        If the plant is sampled and the controller is not, or at another rate.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 1997, section 3.2.

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> lag = LinearSystem(A=[[-1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> gain = Controller(A=[], B=[], C=[], D=[[-1.0]], inputs=("y",), outputs=("u",), dt_s=0.1)
    >>> at_rate(lag, gain).dt
    0.1
    """
    dt = controller.dt_s
    if plant.dt is None and dt is not None:
        return sampled_plant(plant, dt, delay_samples=controller.delay_s / dt)
    if plant.dt is not None and (dt is None or abs(dt - plant.dt) > 1e-9 * plant.dt):
        rate = "continuous" if dt is None else f"sampled at {dt:g} s"
        raise ValueError(f"the plant is sampled at {plant.dt:g} s and the controller is {rate}: their rates must agree")
    return plant


def wiring(plant: LinearSystem, controller: Controller) -> tuple[Array, list[int]]:
    """Which inputs of a plant a controller drives and which outputs it reads.

    Parameters
    ----------
    plant : LinearSystem
        Its channel names.
    controller : Controller
        Its channel names.

    Returns
    -------
    scatter : ndarray, shape (n_u, n_out)
        One where output j of the controller is added to input i of the plant. [-]
    rows : list of int, length n_in
        Outputs of the plant that are read.

    Raises
    ------
    ValueError
        Naming a channel that the plant does not have, and those that it has.

    References
    ----------
    contract.md, "Controller file (JSON)".

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("elevon_rad",), "outputs": ("gyro_rad_s",)}
    >>> lag = LinearSystem(A=[[-1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> gain = Controller(A=[], B=[], C=[], D=[[-1.0]], inputs=("gyro",), outputs=("elevon_command_rad",))
    >>> wiring(lag, gain)[1]
    [0]
    """
    scatter = np.zeros((len(plant.inputs), len(controller.outputs)))
    driven = [name.replace("_command_", "_") for name in plant.inputs]
    for j, name in enumerate(controller.outputs):
        plain = name.replace("_command_", "_")
        if plain not in driven:
            raise ValueError(f"the controller drives {name!r}, which is no input; inputs: {', '.join(plant.inputs)}")
        scatter[driven.index(plain), j] = 1.0
    rows = []
    for name in controller.inputs:
        found = [o for o in plant.outputs if o == name] or [
            o for o in plant.outputs if o in {f"{name}_{unit}" for unit in _UNITS}
        ]
        if len(found) != 1:
            raise ValueError(f"the controller reads {name!r}, which is no output; outputs: {', '.join(plant.outputs)}")
        rows.append(plant.outputs.index(found[0]))
    return scatter, rows


def controller_at(controller: Controller, pressure: Array | float | None = None) -> tuple[Array, Array, Array, Array]:
    """Matrices of a controller at dynamic pressures.

    Parameters
    ----------
    controller : Controller
        With or without a schedule.
    pressure : float or ndarray, shape (...), optional
        Dynamic pressure. [Pa]

    Returns
    -------
    A, B, C, D : ndarray
        Batched as `pressure` where there is a schedule, else one system. [SI]

    Raises
    ------
    ValueError
        If a schedule is asked for without a pressure.

    References
    ----------
    contract.md, "interpolation": "linear" of matrices, no extrapolation beyond the ends.

    Examples
    --------
    >>> two = Controller(A=[], B=[], C=[], D=[[[-1.0]], [[-3.0]]], inputs=("y",), outputs=("u",), dt_s=0.1,
    ...                  pressures=np.array([0.0, 100.0]))
    >>> float(controller_at(two, 50.0)[3][0, 0])
    -2.0
    """
    stacks = controller.A, controller.B, controller.C, controller.D
    if len(controller.pressures) == 1:
        return tuple(x[0] for x in stacks)
    if pressure is None:
        raise ValueError("a controller with a schedule needs the dynamic pressure [Pa]")
    wanted = np.asarray(pressure, dtype=float)
    blend = controller.blend(wanted.ravel())
    left, weight = blend[:, 0].astype(int), blend[:, 1][:, None, None]
    right = np.minimum(left + 1, len(controller.pressures) - 1)
    return tuple(((1.0 - weight) * x[left] + weight * x[right]).reshape(*wanted.shape, *x.shape[-2:]) for x in stacks)


def roots(system: LinearSystem) -> Array:
    """Roots of a system as s, whether it is continuous or sampled (s = log(z)/dt).

    Parameters
    ----------
    system : LinearSystem
        Any batch.

    Returns
    -------
    s : complex ndarray, shape (..., n_x)
        Eigenvalues; nan for roots of a sampled system that are gone within a sample. A single root on the negative
        real axis of z is given with the frequency pi/dt. [1/s]

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 1997, section 2.6 (poles of sampled systems).

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> half = LinearSystem(A=[[0.5]], B=[[1.0]], C=[[1.0]], D=[[0.0]], dt=0.1, **names)
    >>> roots(half).round(3).tolist()
    [(-6.931+0j)]
    """
    z = np.asarray(np.linalg.eigvals(system.A)).astype(complex)
    return z if system.dt is None else as_rates(z, system.dt)


def as_rates(z: Array, dt: float) -> Array:
    """Roots of a sampled system as s = log(z)/dt.

    Parameters
    ----------
    z : complex ndarray, shape (...)
        Eigenvalues. [-]
    dt : float
        Sample time. [s]

    Returns
    -------
    s : complex ndarray, shape (...)
        nan where |z| is below `FORGOTTEN`. [1/s]

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 1997, section 2.6.

    Examples
    --------
    >>> as_rates(np.array([1.0 + 0j]), 0.1).tolist()
    [0j]
    """
    kept = np.abs(z) > FORGOTTEN
    return np.where(kept, np.log(np.where(kept, z, 1.0)) / dt, complex(np.nan, np.nan))


def _from_system(system: LinearSystem) -> Controller:
    """A linear system as a controller, the first of a batch for its names; a continuous one with a delay is refused."""
    if system.dt is None and system.input_delay_s:
        raise ValueError(
            f"a continuous controller with a delay of {system.input_delay_s:g} s has no state space: sample it (dt)"
        )
    return controller_of(system[(0,) * (system.A.ndim - 2)] if system.A.ndim > 2 else system)
