"""Chapters 8 and 9 of the thesis, computed again from the preset files alone: figures, tables, claims, misprints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from aeroservo.aeroelastic.closed_form_reversal import ControlSlopes, wing_roll_reversal_pressure
from aeroservo.aircraft.files import read
from aeroservo.datatypes import Array, FlightCondition
from aeroservo.studies.thesis import ALTITUDES, Model, printed_simulation, printed_speed
from aeroservo.studies.thesis_aeroelastic import Aeroelastic, binary_in_closed_form, thesis_aeroelastic
from aeroservo.studies.thesis_aeroelastic_claims import aeroelastic_claims
from aeroservo.studies.thesis_aeroelastic_figures import aeroelastic_entries
from aeroservo.studies.thesis_design import Design, thesis_design
from aeroservo.studies.thesis_design_claims import design_claims
from aeroservo.studies.thesis_design_figures import design_entries
from aeroservo.studies.thesis_fixed_k import common_ranges
from aeroservo.studies.thesis_flight import SEEDS, Flight, thesis_flight
from aeroservo.studies.thesis_flight_claims import flight_claims
from aeroservo.studies.thesis_flight_figures import flight_entries
from aeroservo.studies.thesis_gains import HIGH
from aeroservo.studies.thesis_linear import Appendix, thesis_appendix
from aeroservo.studies.thesis_linear_figures import linear_claims, linear_entries
from aeroservo.studies.thesis_misprints import Misprint, thesis_misprints
from aeroservo.studies.thesis_records import Claim, Compared, Entry, number

Quantity = Literal["flutter", "divergence", "reversal"]
COLUMNS: tuple[tuple[str, str], ...] = (
    ("binary_quasi", "binary wing, quasi-steady"),
    ("binary_unsteady", "binary wing, unsteady"),
    ("aircraft_quasi", "whole aircraft, quasi-steady"),
    ("aircraft_unsteady", "whole aircraft, unsteady"),
    ("simulation_lqr", "simulation, LQR"),
    ("simulation_adaptive", "simulation, adaptive"),
)
"""Of Tables 2 and 3; the last of Table 3 only."""


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One number of Table 2 or 3, ours by the thesis' method, and what a sounder method gives.

    Attributes
    ----------
    table : int
        2 or 3.
    altitude : float
        Geopotential. [m]
    column, quantity : str
        Of the table.
    thesis : str
        As printed.
    ours : float, str or None
        By the thesis' method. [m/s]
    sound : float, str or None
        By the sounder method. [m/s]
    method : str
        Which that is.
    reason : str
        Why ours and the thesis' differ, or agree.
    """

    table: int
    altitude: float
    column: str
    quantity: Quantity
    thesis: str
    ours: float | str | None
    sound: float | str | None
    method: str
    reason: str

    @property
    def difference(self) -> float | None:
        """Ours less the thesis'; None where one of them is no number. [m/s]"""
        try:
            printed = float(self.thesis)
        except ValueError:
            return None
        return None if self.ours is None or isinstance(self.ours, str) else self.ours - printed


@dataclass(frozen=True, kw_only=True, eq=False)
class ThesisBook:
    """The thesis, computed again.

    Attributes
    ----------
    cells : tuple of Cell
        Tables 2 and 3, complete.
    entries : tuple of Entry
        Table 1 and every figure with computed content, in the thesis' order.
    claims : tuple of Claim
        Its statements, judged.
    misprints : tuple of Misprint
        What was put right first.
    design, aeroelastic, appendix, flight
        What all of it was read from.
    """

    cells: tuple[Cell, ...]
    entries: tuple[Entry, ...]
    claims: tuple[Claim, ...]
    misprints: tuple[Misprint, ...]
    design: Design
    aeroelastic: Aeroelastic
    appendix: Appendix
    flight: Flight

    def entry(self, name: str) -> Entry:
        """The entry of a figure or table, by its number."""
        return next(e for e in self.entries if e.number == name)


def thesis_book(
    *,
    speeds: Array | None = None,
    k: Array | None = None,
    points: int = 21,
    seeds: range = SEEDS,
    progress: Callable[[str], None] | None = None,
) -> ThesisBook:
    """Re-run chapters 8 and 9.

    Parameters
    ----------
    speeds : ndarray, shape (n_V,), optional
        Sweep of the tables' runs. [m/s]
    k : ndarray, shape (n_k,), optional
        Reduced frequencies of the held derivatives. [-]
    points : int
        Values of the other number of Figures 29 and 30.
    seeds : range
        Of the climbs.
    progress : callable, optional
        Told in words what comes next.

    Returns
    -------
    book : ThesisBook
        Everything that page, JSON and docs are made of.

    References
    ----------
    Bramstång 2015, chapters 8 and 9.
    """
    say = progress or (lambda words: None)
    aeroelastic = thesis_aeroelastic(speeds=speeds, k=k, points=points, progress=progress)
    say("efficiency: section polars, lattice, trim")
    design = thesis_design()
    appendix = thesis_appendix()
    flight = thesis_flight(seeds=seeds, progress=progress)
    found = {
        e.number: e
        for e in (
            *design_entries(design),
            *linear_entries(appendix),
            *aeroelastic_entries(aeroelastic),
            _flow(),
            *flight_entries(flight),
        )
    }
    return ThesisBook(
        cells=tuple(cell for altitude in ALTITUDES for cell in _cells(aeroelastic, flight, altitude)),
        entries=tuple(found[name] for name in sorted(found, key=_order)),
        claims=(
            *design_claims(design),
            *aeroelastic_claims(aeroelastic),
            *linear_claims(appendix),
            *flight_claims(flight, aeroelastic),
        ),
        misprints=thesis_misprints(appendix, aeroelastic),
        design=design,
        aeroelastic=aeroelastic,
        appendix=appendix,
        flight=flight,
    )


def _order(name: str) -> tuple[int, int]:
    """Tables first, then figures by number, equations last."""
    kind, _, rest = name.partition(" ")
    return ("Table", "Fig.", "Eqs.").index(kind), int(rest) if rest.isdecimal() else 0


def _flow() -> Entry:
    """Figure 17: the study's own flow."""
    steps = (
        ("design and airfoil", "presets/thesis-uav.toml", "Table 1, Figs 2, 5, 6, 18, 19"),
        ("section polars with flaps", "XFOIL tables of MH 62 in the package", "Fig. 21"),
        ("wing polars, trim, efficiency", "vortex lattice with section polars", "Figs 3, 4, 22-25"),
        ("statics", "presets thesis-binary, thesis-aircraft: divergence, reversal", "Figs 14, 26, Tables 2-3"),
        ("flutter", "p (quasi-steady), p-k (Theodorsen), held derivatives", "Figs 15, 27-30, Tables 2-3"),
        ("linear model", "presets/thesis-appendix.toml: roots, LQR", "Figs 9-11, 31, 32"),
        ("simulation model", "presets/thesis-simulation.toml, BACT", "Figs 16, 33, 37"),
        ("control", "LQR, switch, schedule with servo; zeros, margins of stability", "Figs 34, 38, 40"),
        ("flight", "gusts, Dryden turbulence, climb and acceleration", "Figs 35, 36, 39"),
        ("judgement", "claims and misprints", "this study"),
    )
    return Entry(
        number="Fig. 17",
        title="Flow of the study",
        thesis="A flow chart from design over analysis to simulation, done once by hand in four programs.",
        finding="The same steps, in one command and from preset files alone.",
        compared=tuple(Compared(what=what, unit="", thesis=None, ours=how, reason=shows) for what, how, shows in steps),
    )


def _cells(a: Aeroelastic, f: Flight, altitude: float) -> list[Cell]:
    """One of the two tables."""
    cells: list[Cell] = []
    for column, _ in COLUMNS:
        if column == "simulation_adaptive" and altitude == 0.0:
            continue
        simulated = column.startswith("simulation")
        for quantity in ("flutter", "divergence", "reversal"):
            given = (
                _simulated(a, f, altitude, column, quantity) if simulated else _analytic(a, altitude, column, quantity)
            )
            cells.append(
                Cell(
                    table=2 + ALTITUDES.index(altitude), altitude=altitude, column=column, quantity=quantity,
                    thesis=given[0], ours=given[1], sound=given[2], method=given[3], reason=given[4],
                )
            )  # fmt: skip
    return cells


Given = tuple[str, Any, Any, str, str]


def _analytic(a: Aeroelastic, altitude: float, column: str, quantity: str) -> Given:
    """The four analytic columns."""
    model: Model = "binary" if column.startswith("binary") else "aircraft"
    kind = "quasi" if column.endswith("quasi") else "unsteady"
    printed = str(printed_speed(model, kind, quantity, altitude))  # type: ignore[arg-type]
    if quantity == "flutter":
        exact = a.flutter(model, altitude, "theodorsen")
        thin = a.flutter(model, altitude, "theodorsen", "2 pi")
        method = f"Theodorsen p-k, slope a_w ({thin:.2f} with 2 pi)"
        if kind == "quasi":
            reason = "x_f/c inferred from 49 and 56" if model == "binary" else "not fitted; the centre mass is unknown"
            return printed, a.flutter(model, altitude), exact, method, reason
        return printed, _held_words(a, model, altitude), exact, method, "derivatives held at one k that is not named"
    still = a.study.run(model, altitude, "quasi_steady_damped").static
    wing, control = binary_in_closed_form(), _elevon()
    rho = float(FlightCondition.at(altitude, V=1.0).rho)
    if quantity == "divergence":
        beam = a.divergence["uniform beam"] * np.sqrt(1.225 / rho)
        inferred = "e a_w inferred from 81" if altitude == 0.0 else "follows by density"
        return printed, still.divergence.V, beam, "uniform beam, not held to a linear twist", inferred
    q = wing_roll_reversal_pressure(wing, control)
    beam = None if q is None else float(np.sqrt(2.0 * q / rho))
    inferred = "b_c/a_c inferred from 55" if altitude == 0.0 else "follows by density"
    return printed, still.reversal.V, beam, "uniform beam, not held to a linear twist", inferred


def _elevon() -> ControlSlopes:
    """The elevon of the binary wing."""
    elevon = read("thesis-binary").wing.elevon  # type: ignore[attr-defined]
    return ControlSlopes(lift_per_rad=elevon.lift_per_rad, moment_per_rad=elevon.moment_per_rad)


def _held_words(a: Aeroelastic, model: Model, altitude: float) -> str:
    """Which k and slope print both altitudes' unsteady numbers."""
    said = []
    for slope in ("a_w", "2 pi"):
        both = [h for h in a.study.held if (h.model, h.slope) == (model, slope)]
        common = common_ranges(both[0].ranges, both[1].ranges)
        said += [f"printed at k {low:.2g} to {high:.2g}, {slope}" for low, high in common]
    return "; ".join(said) or "no one k prints both altitudes"


def _simulated(a: Aeroelastic, f: Flight, altitude: float, column: str, quantity: str) -> Given:
    """The two simulation columns."""
    printed = printed_simulation(column, quantity, altitude)
    _, V_D, V_R = a.simulation[altitude]
    check = f.check if altitude == HIGH else f.check_low
    schedule = f"stable to {number(check.speeds.max())}" if check.stable else check.sentence()
    if quantity == "reversal":
        reason = "lift per elevon angle; CM_delta calibrated to 53 at 10,000 ft" + (
            "" if altitude == HIGH else "; 51 does not follow from it: open"
        )
        return printed, V_R, f.lattice_reversal[altitude], "the lattice's own CM_delta", reason
    if column == "simulation_lqr":
        reason = "lost through a real root: flutter and divergence at once" + (
            "" if altitude == HIGH else "; 66 does not follow from constant dynamic pressure: open"
        )
        method = "gains at every speed, servo, 200 Hz, one sample of delay"
        if quantity == "divergence" and altitude == 0.0:
            return printed, f.lost[altitude], V_D, "the wing without control", "the thesis prints none"
        if quantity == "divergence":
            return printed, f.lost[altitude], V_D, "the wing without control", reason
        return printed, f.lost[altitude], schedule, method, reason
    reached = np.array(f.climbs["switch"].reached)
    if quantity == "flutter":
        climbs = f"climbs reach {reached.min():.1f} to {reached.max():.1f}"
        reason = f"a switch at 50 m/s, the second gain our own: {climbs}, their median stands here"
        return printed, float(np.median(reached)), schedule, "frozen loops, servo inside", reason
    return printed, V_D, V_D, "the wing without control", "CM_alpha calibrated to it"
