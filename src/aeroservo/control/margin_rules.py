"""Margins that specifications ask for, as rows that pass or fail. WRITTEN FROM MEMORY of the standards: check the text.

MIL-F-9490D (and SAE AS94900 after it), table of gain and phase margins: below the first aeroelastic mode 6 dB and
45 deg between the operational speeds, 4.5 dB and 30 deg at the limit speed; above it 8 dB and 60 deg, then 6 dB and
45 deg; stable at 1.15 times the limit speed. CS-25.629 (b) asks for freedom from aeroelastic instability to 1.15 V_D,
CS-23.629 for 1.2 V_D where it is shown by analysis. All margins are of one loop at a time, the others closed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from aeroservo.aeroelastic.branches import Interval
from aeroservo.control.closed_loop import loop_plant
from aeroservo.control.controller import Controller
from aeroservo.control.margins import LoopMargin, loop_margins
from aeroservo.datatypes import AeroelasticModel, FlightCondition
from aeroservo.structure.modal import natural_modes

FROM_MEMORY = "written from memory of the standard"
"""Mark of every row."""

MIL_F_9490D = {"V_o": ((6.0, 45.0), (8.0, 60.0)), "V_L": ((4.5, 30.0), (6.0, 45.0))}
"""Gain [dB] and phase [deg] asked for below and above the first aeroelastic mode, at each speed."""


@dataclass(frozen=True, kw_only=True)
class Requirement:
    """One row of a specification.

    Attributes
    ----------
    rule : str
        Document, and that it is written from memory.
    what : str
        Speed and band of frequencies.
    speed : float
        True airspeed at which it holds. [m/s]
    asked_gain_dB, asked_phase_deg : float or None
        Gain margin either way [dB] and phase margin [deg]; None where only stability is asked for.
    gain_dB, phase_deg : float or None
        What there is; inf without crossover, None where the loop is unstable. [dB, deg]
    passed : bool
        Whether it is met.
    """

    rule: str
    what: str
    speed: float
    asked_gain_dB: float | None
    asked_phase_deg: float | None
    gain_dB: float | None
    phase_deg: float | None
    passed: bool


def mil_f_9490d(
    model: AeroelasticModel,
    controller: Controller,
    condition: FlightCondition,
    *,
    V_o: float,
    V_L: float,
    first_elastic: float | None = None,
) -> tuple[Requirement, ...]:
    """Aeroservoelastic margins of MIL-F-9490D / AS94900, every loop at the plant's inputs cut one at a time.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.
    controller : Controller
        A schedule is interpolated.
    condition : FlightCondition
        For density and speed of sound; its V does not matter.
    V_o, V_L : float
        Largest operational and limit true airspeed. [m/s]
    first_elastic : float, optional
        Frequency that divides the bands; default the lowest elastic mode without air. [rad/s]

    Returns
    -------
    rows : tuple of Requirement
        Two bands at V_o and V_L, stability at 1.15 V_L. [dB, deg]

    Raises
    ------
    ValueError
        Unless 0 < V_o <= V_L.

    References
    ----------
    MIL-F-9490D, 1975, section 3.1.3.6.1, table III (from memory); SAE AS94900, 2007 (from memory).

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> damper = Controller(A=[], B=[], C=[], D=[[0.05]], inputs=("pitch_rate_rad_s",), outputs=("elevon_command_rad",),
    ...                     dt_s=0.005)
    >>> rows = mil_f_9490d(build(read("thesis-simulation")), damper, FlightCondition.at(3048.0, V=1.0), V_o=30.0,
    ...                    V_L=35.0)
    >>> len(rows), rows[-1].what
    (5, 'stable at 1.15 V_L')
    """
    if not 0.0 < V_o <= V_L < math.inf:
        raise ValueError(f"speeds must have 0 < V_o <= V_L [m/s], got {V_o:g} and {V_L:g}")
    divide = first_elastic
    if divide is None:
        omega = natural_modes(model.modes).omega
        divide = float(omega[omega > 0.0].min()) if np.any(omega > 0.0) else 0.0
    rule = f"MIL-F-9490D / AS94900, {FROM_MEMORY}"

    def margins(V: float) -> tuple[LoopMargin, ...]:
        at = FlightCondition(V=np.asarray(V), rho=condition.rho.flat[0], a_sound=condition.a_sound.flat[0])
        return loop_margins(loop_plant(model, at, controller), controller, pressure=float(at.q))

    rows = []
    for (name, bands), V in zip(MIL_F_9490D.items(), (V_o, V_L)):
        found = margins(V)
        for band, (gain, phase) in zip(("below", "above"), bands):
            low, high = (0.0, divide) if band == "below" else (divide, math.inf)
            got_gain, got_phase = _in_band(found, low, high)
            rows.append(
                Requirement(
                    rule=rule, what=f"{name}, {band} the first elastic mode at {divide:.4g} rad/s", speed=V,
                    asked_gain_dB=gain, asked_phase_deg=phase, gain_dB=got_gain, phase_deg=got_phase,
                    passed=got_gain is not None and got_phase is not None and got_gain >= gain and got_phase >= phase,
                )
            )  # fmt: skip
    stable = all(m.stable for m in margins(1.15 * V_L))
    rows.append(
        Requirement(
            rule=rule, what="stable at 1.15 V_L", speed=1.15 * V_L, asked_gain_dB=None, asked_phase_deg=None,
            gain_dB=None, phase_deg=None, passed=stable,
        )
    )  # fmt: skip
    return tuple(rows)


def flutter_clearance(intervals: Sequence[Interval], *, V_D: float, searched_to: float) -> tuple[Requirement, ...]:
    """Freedom from aeroelastic instability to 1.15 V_D (CS-25.629) and 1.2 V_D (CS-23.629, by analysis).

    At one altitude a factor on equivalent airspeed is the same factor on true airspeed.

    Parameters
    ----------
    intervals : sequence of Interval
        Unstable ranges with the loop as it flies: of `closed_flutter`, or of `flutter` for the aircraft alone. [m/s]
    V_D : float
        Design dive speed, true. [m/s]
    searched_to : float
        Highest speed of the search. [m/s]

    Returns
    -------
    rows : tuple of Requirement
        Two; a search that ends below the speed asked for does not pass. [m/s]

    Raises
    ------
    ValueError
        If V_D is not positive.

    References
    ----------
    CS-25.629 (b) and CS-23.629, EASA (both from memory).

    Examples
    --------
    >>> late = Interval(start=60.0, end=None, frequency=20.0, mode="pitch", kind="flutter")
    >>> [row.passed for row in flutter_clearance([late], V_D=51.0, searched_to=80.0)]
    [True, False]
    """
    if not 0.0 < V_D < math.inf:
        raise ValueError(f"V_D must be positive [m/s], got {V_D:g}")
    first = min((0.0 if i.start is None else i.start for i in intervals), default=math.inf)
    rows = []
    for rule, factor in (("CS-25.629 (b)", 1.15), ("CS-23.629, by analysis", 1.2)):
        speed = factor * V_D
        rows.append(
            Requirement(
                rule=f"{rule}, {FROM_MEMORY}", what=f"no instability to {factor:g} V_D", speed=speed,
                asked_gain_dB=None, asked_phase_deg=None, gain_dB=None, phase_deg=None,
                passed=first > speed and searched_to >= speed * (1.0 - 1e-12),
            )
        )  # fmt: skip
    return tuple(rows)


def _in_band(margins: Sequence[LoopMargin], low: float, high: float) -> tuple[float | None, float | None]:
    """Smallest gain margin either way [dB] and phase margin [deg] of crossovers in a band; None where unstable."""
    if not all(m.stable for m in margins):
        return None, None
    gain = [abs(20.0 * math.log10(g)) for m in margins for w, g in m.phase_crossovers if low <= w < high]
    phase = [math.degrees(abs(p)) for m in margins for w, p in m.gain_crossovers if low <= w < high]
    return min(gain, default=math.inf), min(phase, default=math.inf)
