"""What a controller does to a wing: margins of every loop against speed and delay, zeros, the rows of the standards."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from aeroservo.aeroelastic.linear import displacement_free
from aeroservo.control.closed_flutter import closed_flutter
from aeroservo.control.closed_loop import loop_plant
from aeroservo.control.controller import Controller
from aeroservo.control.disk_margins import Cut, DiskMargin, MarginCurve, disk_margin, margin_curve, total_delay
from aeroservo.control.margin_rules import Requirement, flutter_clearance, mil_f_9490d
from aeroservo.control.margins import LoopMargin, loop_margins
from aeroservo.control.zeros import ZeroCurve, zeros_against_speed
from aeroservo.datatypes import AeroelasticModel, FlightCondition


@dataclass(frozen=True, kw_only=True, eq=False)
class ControllerCheck:
    """Margins, zeros and rules of one controller on one wing at one altitude.

    Attributes
    ----------
    condition : FlightCondition
        The speeds, shape (n_V,). [m/s, kg/m^3]
    loops : tuple of tuple of LoopMargin
        At each speed, every loop at the plant's inputs, then at its outputs, cut one at a time. [SI]
    inputs, outputs, both : tuple of DiskMargin
        At each speed, all inputs, all outputs, and all of them at once. [-]
    delays : MarginCurve
        Disk margin at the inputs against the total delay. [-]
    own_delay : float
        Total delay of the loop as it is. [s]
    zeros : tuple of ZeroCurve
        Of every channel that the controller reads. [1/s]
    rules : tuple of Requirement
        Rows of the standards for which speeds were given; written from memory.
    """

    condition: FlightCondition
    loops: tuple[tuple[LoopMargin, ...], ...]
    inputs: tuple[DiskMargin, ...]
    outputs: tuple[DiskMargin, ...]
    both: tuple[DiskMargin, ...]
    delays: MarginCurve
    own_delay: float
    zeros: tuple[ZeroCurve, ...]
    rules: tuple[Requirement, ...]


def controller_check(
    model: AeroelasticModel,
    condition: FlightCondition,
    controller: Controller,
    *,
    altitude: float = 0.0,
    delays_s: Sequence[float] = (0.005, 0.01, 0.015, 0.02, 0.025, 0.03),
    V_o: float | None = None,
    V_L: float | None = None,
    V_D: float | None = None,
) -> ControllerCheck:
    """Check a controller at a row of speeds.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.
    condition : FlightCondition
        Two or more ascending speeds at one density, shape (n_V,). [m/s, kg/m^3]
    controller : Controller
        The user's own, or a design; a schedule is interpolated.
    altitude : float
        For the record. [m]
    delays_s : sequence of float
        Total delays at which the margin is given too. [s]
    V_o, V_L : float, optional
        Largest operational and limit speed: rows of MIL-F-9490D / AS94900. [m/s]
    V_D : float, optional
        Design dive speed: rows of CS-25.629 and CS-23.629. [m/s]

    Returns
    -------
    check : ControllerCheck
        Margins against speed and delay, zeros, rules. [SI]

    Raises
    ------
    ValueError
        If only one of V_o and V_L is given, a channel is missing, or the model has no state space.

    References
    ----------
    MIL-F-9490D, 1975, table III, CS-25.629 (b) and CS-23.629 (from memory); P. Seiler, A. Packard and P. Gahinet, IEEE
    Control Systems Magazine 40(5), 2020.
    """
    if (V_o is None) != (V_L is None):
        raise ValueError("the rows of MIL-F-9490D need both V_o and V_L [m/s]")
    plants = loop_plant(model, condition, controller)
    q = condition.q.tolist()
    at = [(plants[i], controller) for i in range(len(q))]
    loops = tuple(loop_margins(*one, at="both", pressure=p) for one, p in zip(at, q))
    cuts: tuple[Cut, ...] = ("input", "output", "both")
    disks = [[disk_margin(*one, at=cut, pressure=p) for one, p in zip(at, q)] for cut in cuts]
    rules: tuple[Requirement, ...] = ()
    if V_o is not None and V_L is not None:
        rules += mil_f_9490d(model, controller, condition, V_o=V_o, V_L=V_L)
    if V_D is not None:
        top = max(1.2 * V_D, float(condition.V[-1]))
        sweep = FlightCondition(
            V=np.linspace(float(condition.V[0]), top, 60), rho=condition.rho[0], a_sound=condition.a_sound[0]
        )
        found = closed_flutter(model, sweep, controller)
        rules += flutter_clearance(found.intervals, V_D=V_D, searched_to=top)
    return ControllerCheck(
        condition=condition,
        loops=loops,
        inputs=tuple(disks[0]),
        outputs=tuple(disks[1]),
        both=tuple(disks[2]),
        delays=margin_curve(model, condition, controller, altitude=altitude, delays_s=delays_s),
        own_delay=total_delay(model, controller),
        zeros=_zeros(model, condition, controller),
        rules=rules,
    )


def _zeros(model: AeroelasticModel, condition: FlightCondition, controller: Controller) -> tuple[ZeroCurve, ...]:
    """Zeros of what is read; positions that nothing depends on are no part of the plant."""
    free = displacement_free(model.modes, model.aero)
    gone = {
        name.replace(" ", "_") + (f"_{unit}" if unit else "")
        for name, unit, out in zip(model.modes.names, model.modes.units, free)
        if out
    }
    sensors = [name for name in controller.inputs if name not in gone]
    return zeros_against_speed(model, condition, sensors=sensors) if sensors else ()
