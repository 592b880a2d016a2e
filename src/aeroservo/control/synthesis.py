"""A design in one call: the plant with sensors, actuators and delay, the controller, its margins."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from aeroservo.control.controller import Controller
from aeroservo.control.design import Design, controls
from aeroservo.control.disk_margins import DiskMargin, disk_margin
from aeroservo.control.kalman import sensor_deviations
from aeroservo.control.lqg import LQG
from aeroservo.control.plant import design_plant, sampled_plant
from aeroservo.control.schedule import command_limits
from aeroservo.datatypes import AeroelasticModel, FlightCondition, LinearSystem


@dataclass(frozen=True, kw_only=True, eq=False)
class Synthesis:
    """A design with the plant that it was made for and the margins that it has there.

    Attributes
    ----------
    plant : LinearSystem
        Controls (and gusts) to what is measured, actuators and delay inside; batched as the conditions. [SI]
    design : Design
        Gains, roots, residual. [SI]
    controller : Controller
        As files and simulations take it; a schedule over dynamic pressure where there was a row of conditions. [SI]
    margins : tuple of DiskMargin
        At the plant's inputs, one for each condition.
    """

    plant: LinearSystem
    design: Design
    controller: Controller
    margins: tuple[DiskMargin, ...]


def synthesise(
    model: AeroelasticModel,
    design: Callable[[LinearSystem], Design],
    condition: FlightCondition,
    *,
    rate_Hz: float | None = None,
    delay_samples: float = 0.0,
    actuators: bool = True,
    sensors: Sequence[str] | None = None,
    limits: tuple[float, ...] | None = None,
) -> Synthesis:
    """Design for a model at a flight condition, or a schedule over a row of them.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.
    design : callable
        `LQR`, `LQI`, `LQG`, `PID`, `PolePlacement` with their options; an `LQG` without V takes the noise that the
        model's sensors state.
    condition : FlightCondition
        Shape (), or (p,) with ascending dynamic pressure for a schedule.
    rate_Hz : float, optional
        Sample rate; None is continuous, which has no schedule. [Hz]
    delay_samples : float
        Computing delay. [sample]
    actuators : bool
        Whether actuators are inside the plant.
    sensors : sequence of str, optional
        What is measured, by sensor name or channel; all outputs of the model if not given.
    limits : tuple of float, optional
        Largest magnitude of each command; those of the actuators if not given. [rad]

    Returns
    -------
    synthesis : Synthesis
        Plant, design, controller and margins. [SI]

    Raises
    ------
    ValueError
        If the conditions are no row, dynamic pressures do not ascend, a schedule is continuous, or no design exists.

    References
    ----------
    contract.md, "design".

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> from aeroservo.control.lqr import LQR
    >>> model, at = build(read("thesis-simulation")), FlightCondition.at(3048.0, V=55.0)
    >>> synthesise(model, LQR(Q=[1.0, 1.0, 1.0, 1.0], R=[1.0]), at).design.K.round(3).tolist()
    [[-6.783, -1.69, -0.573, -0.916]]
    """
    if condition.V.ndim > 1:
        raise ValueError(f"a schedule needs a row of conditions, got shape {condition.V.shape}")
    row = condition.V.ndim == 1
    if row and rate_Hz is None:
        raise ValueError("a schedule belongs to a sampled controller: give rate_Hz [Hz]")
    if row and (len(condition.V) < 2 or np.any(np.diff(condition.q) <= 0.0)):
        raise ValueError("a schedule needs two or more conditions of ascending dynamic pressure [Pa]")
    plant = design_plant(
        model, condition, rate_Hz=rate_Hz, delay_samples=delay_samples, actuators=actuators, sensors=sensors,
        gusts=True,
    )  # fmt: skip
    if isinstance(design, LQG) and design.V is None:
        design = replace(design, V=sensor_deviations(plant.outputs, model.sensors) ** 2)
    found = design(plant)
    if rate_Hz is None:
        limits = ()
    elif limits is None:
        limits = command_limits(model, found.controller.outputs)
    delay_s = 0.0 if rate_Hz is None else delay_samples / rate_Hz
    return _finished(plant, found, delay_s, limits, condition if row else None)


def synthesise_system(
    system: LinearSystem,
    design: Callable[[LinearSystem], Design],
    *,
    rate_Hz: float | None = None,
    delay_samples: float = 0.0,
    limits: tuple[float, ...] = (),
) -> Synthesis:
    """Design for a linear system at its one condition.

    Parameters
    ----------
    system : LinearSystem
        Continuous, or sampled at the rate asked for. [SI]
    design : callable
        `LQR`, `LQI`, `LQG`, `PID`, `PolePlacement` with their options.
    rate_Hz : float, optional
        Sample rate; None is as the system is. [Hz]
    delay_samples : float
        Computing delay. [sample]
    limits : tuple of float
        Largest magnitude of each command. [unit of the command]

    Returns
    -------
    synthesis : Synthesis
        Plant, design, controller and margins. [SI]

    Raises
    ------
    ValueError
        If a delay comes without a rate, or no design exists.

    References
    ----------
    contract.md, "design".

    Examples
    --------
    >>> from aeroservo.control.lqr import LQR
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("x",)}
    >>> unstable = LinearSystem(A=[[1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> round(synthesise_system(unstable, LQR(Q=[0.0], R=[1.0])).margins[0].alpha, 6)
    0.666667
    """
    if rate_Hz is None and delay_samples:
        raise ValueError("a delay in samples needs a sample rate: rate_Hz [Hz]")
    if rate_Hz is not None and not 0.0 < rate_Hz < np.inf:
        raise ValueError(f"rate_Hz must be positive [Hz], got {rate_Hz}")
    plant = system if rate_Hz is None else sampled_plant(system, 1.0 / rate_Hz, delay_samples=delay_samples)
    return _finished(plant, design(plant), 0.0 if rate_Hz is None else delay_samples / rate_Hz, limits, None)


def _finished(
    plant: LinearSystem, found: Design, delay_s: float, limits: tuple[float, ...], row: FlightCondition | None
) -> Synthesis:
    """Margins and the controller of a design."""
    seen = controls(plant)
    pressures = None if row is None else row.q
    controller = found.as_controller(delay_s=delay_s, limits=limits, pressures=pressures)
    one = [(seen, found.controller)] if row is None else [(seen[i], found.controller[i]) for i in range(len(row.q))]
    return Synthesis(
        plant=plant, design=found, controller=controller, margins=tuple(disk_margin(p, c) for p, c in one)
    )  # fmt: skip
