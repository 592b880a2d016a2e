"""Parts on a linear model that holds at one flight condition: its roots, its response, a regulator."""

from __future__ import annotations

import numpy as np

from aeroservo.aircraft.schema_other import StateSpaceFile
from aeroservo.datatypes import LinearSystem
from aeroservo.report.blocks import Block, Chart, Facts, Mark, Part, Prose, Series, Table
from aeroservo.report.case_marks import words
from aeroservo.simulate.engine import simulate
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario, Stepping
from aeroservo.studies.aircraft_report import ReportCase

#: First state at the start of the free response.
KICK = 0.01


def linear_summary(case: ReportCase) -> Part:
    """Matrices and roots.

    Parameters
    ----------
    case : ReportCase
        Of kind `state_space`.

    Returns
    -------
    part : Part
        Summary.
    """
    file = case.file
    assert isinstance(file, StateSpaceFile)
    m, system = file.model, _system(file)
    values = np.linalg.eigvals(system.A)
    values = values[np.lexsort((values.imag, values.real))[::-1]]
    stable = bool(np.all(values.real < 0.0))
    rows = tuple(
        (float(v.real), float(v.imag), float(abs(v) / (2 * np.pi)), float(-v.real / abs(v)) if abs(v) > 0 else None)
        for v in values
    )
    facts = (
        (
            "The model is",
            "stable" if stable else "unstable",
            f"largest growth {words(float(values.real.max()), '1/s')}",
        ),
        ("It holds at", words(m.speed_m_s, "m/s"), f"{m.altitude_m:g} m, and nowhere else"),
    )
    matrix = tuple((name, *map(float, row), *map(float, b)) for name, row, b in zip(system.states, system.A, system.B))
    blocks: tuple[Block, ...] = (
        Facts(items=facts),
        Prose(
            text="A linear model at one flight condition has no airspeed in it: flutter, statics and the envelope need "
            "another kind of model."
        ),
        *(Prose(text=note, kind="warning") for note in file.problems()),
        Table(
            columns=("Re λ, 1/s", "Im λ, rad/s", "|λ|/2π, Hz", "damping ratio, -"), rows=rows, title="Roots",
            caption="Of the matrix A; a positive real part grows.",
        ),
        Chart(
            series=(Series(name="roots", x=values.real, y=values.imag, kind="points"),), x_label="Re λ, 1/s",
            y_label="Im λ, rad/s", title="Roots in the plane", caption="What lies to the right of zero is unstable.",
            marks=(Mark(at=0.0, text="", kind="zero"),), hover="point",
        ),
        Table(
            columns=("d/dt of", *system.states, *system.inputs), rows=matrix, title="Matrices A and B",
            caption="Rows of x' = A x + B u.",
        ),
    )  # fmt: skip
    return Part(title="Summary", anchor="summary", blocks=blocks)


def linear_runs(case: ReportCase) -> Part:
    """The free response.

    Parameters
    ----------
    case : ReportCase
        Of kind `state_space`.

    Returns
    -------
    part : Part
        One chart for each unit.
    """
    file = case.file
    assert isinstance(file, StateSpaceFile)
    system = _system(file)
    slow = np.abs(np.linalg.eigvals(system.A))
    duration = float(np.clip(30.0 / max(float(np.min(slow[slow > 0.0], initial=1.0)), 1e-3), 1.0, 60.0))
    start = "pitch_rad" if "pitch_rad" in system.states else system.states[0]
    scenario = Scenario(
        profile=level(file.model.speed_m_s, altitude=file.model.altitude_m),
        duration=duration,
        initial=((start, KICK),),
    )
    found = simulate(system, scenario, stepping=Stepping(record_s=duration / 1500.0))
    h = found.history
    assert h is not None
    units: dict[str, list[Series]] = {}
    for name, unit in zip(h.channels, h.units):
        if np.any(h[name]) and name not in ("speed_m_s", "altitude_m"):
            units.setdefault(unit or "-", []).append(Series(name=name, x=h.t, y=h[name]))
    charts = tuple(
        Chart(
            series=tuple(series), x_label="time t, s", y_label=f"response, {unit}", title=f"Free response, {unit}",
            caption=f"From {start} = {KICK:g}, loop open.",
        )
        for unit, series in units.items()
    )  # fmt: skip
    return Part(title="Simulations", anchor="simulations", blocks=charts)


def _system(file: StateSpaceFile) -> LinearSystem:
    m = file.model
    A, B, C, D = (np.array(x, dtype=float) for x in (m.A, m.B, m.C, m.D))
    return LinearSystem(A=A, B=B, C=C, D=D, states=m.states, inputs=m.inputs, outputs=m.outputs)
