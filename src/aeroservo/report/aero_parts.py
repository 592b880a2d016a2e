"""Part on steady aerodynamics of an aircraft: derivatives, polars, trimmed lift over drag, span loading."""

from __future__ import annotations

import numpy as np

from aeroservo.aero.vlm_loads import span_loading
from aeroservo.aeroelastic.aircraft_lattice import aircraft_lattice
from aeroservo.report.blocks import Block, Chart, Mark, Part, Prose, Series, Table
from aeroservo.studies.aircraft_aero import inputs_at_lift
from aeroservo.studies.aircraft_report import ReportCase


def aero_part(case: ReportCase) -> Part:
    """Polars, trim and span loading.

    Parameters
    ----------
    case : ReportCase
        Of kind `aircraft`.

    Returns
    -------
    part : Part
        All from the lattice and the sections' polars.
    """
    CL, wing = case.wing
    found = aircraft_lattice(wing.model.surfaces(), wing.model.references(), method=wing.method)
    d = found.derivatives
    rows = tuple(
        (name, *(_tidy(getattr(d, key)[i]) for key in ("CL", "CY", "Cl", "CM", "Cn"))) for i, name in enumerate(d.names)
    )
    blocks: list[Block] = [
        Prose(
            text=f"Vortex lattice with section polars, {wing.speed:.4g} m/s (where CL = {CL:g} carries the "
            f"weight), {case.options.altitude:g} m. Section polars: {wing.said()}."
        ),
        Table(
            columns=("per radian of", "CL", "CY", "Cl", "CM", "Cn"),
            rows=rows,
            title="Derivatives",
            caption="'steady' is camber and twist as they are; p, r with b/(2V), q with c/(2V); moments about the "
            "reference point.",
        ),
    ]
    blocks += _polars(case)
    blocks += _trim(case, d.neutral_point)
    blocks += _loading(case, found)
    return Part(title="Aerodynamics", anchor="aerodynamics", blocks=tuple(blocks))


def _tidy(value: float) -> float:
    """Rounding errors and minus zero are zero."""
    return 0.0 if abs(value) < 1e-12 else float(value)


def _polars(case: ReportCase) -> list[Block]:
    """Lift, drag, moment, lift over drag."""
    wing = case.wing[1]
    alpha, polars = np.degrees(wing.alpha), wing.polars()
    names = [f"deflection {d:+.3g}°" if d else "deflection 0°" for d in np.degrees(wing.delta).round(9)]
    angle = "angle of attack, °"
    marked = any(np.any(p.stalled) for p in polars)
    note = (
        " Some points have strips that are stalled or outside their polars: those of the CSV of `aeroservo aero`."
        if marked
        else ""
    )
    return [
        Chart(
            series=tuple(Series(name=n, x=alpha, y=p.CL) for n, p in zip(names, polars)),
            x_label=angle,
            y_label="CL, -",
            title="Lift",
            caption="Straight until strips stall, which the lattice does not know." + note,
        ),
        Chart(
            series=tuple(Series(name=n, x=p.CD, y=p.CL) for n, p in zip(names, polars)),
            x_label="CD, -",
            y_label="CL, -",
            title="Drag polar",
            hover="point",
            caption="Induced drag from the Trefftz plane, profile drag from the section polars.",
        ),
        Chart(
            series=tuple(Series(name=n, x=alpha, y=p.CM_viscous) for n, p in zip(names, polars)),
            x_label=angle,
            y_label="CM about the reference point, -",
            title="Pitching moment",
            caption="A falling curve is stable about the reference point.",
        ),
        Chart(
            series=tuple(Series(name=n, x=p.CL, y=p.lift_to_drag) for n, p in zip(names, polars)),
            x_label="CL, -",
            y_label="CL/CD, -",
            title="Lift over drag",
            hover="point",
            caption="Not in trim: each curve keeps its deflection.",
        ),
    ]


def _trim(case: ReportCase, neutral_point: float) -> list[Block]:
    """Lift over drag in trim, and the deflection that it takes."""
    CL, wing = case.wing
    trims = wing.trims(CL)
    ratio = tuple(Series(name=n, x=100.0 * t.static_margin, y=t.polar.lift_to_drag) for n, t in trims)
    angle = tuple(Series(name=n, x=100.0 * t.static_margin, y=np.degrees(t.delta)) for n, t in trims)
    own = wing.model.masses()
    lines, where = [Mark(at=0.0, text="neutral point", kind="zero")], ""
    if own is not None:
        c = wing.model.references().c
        at = 100.0 * (neutral_point - float(own.cg[0])) / c
        lines.append(Mark(at=at, text=f"the file's centre of gravity: {at:.3g} %", kind="reversal"))
        where = f" The file's own centre of gravity is at {at:.3g} %.".replace("-", "−")
    label = "static margin, % of the reference chord"
    return [
        Chart(
            series=ratio,
            x_label=label,
            y_label="CL/CD in trim, -",
            title="Trimmed lift over drag",
            marks=tuple(lines),
            caption=f"At CL = {CL:g}: what stability costs; curves end where no balance lies inside the polars."
            + where,
        ),
        Chart(
            series=angle,
            x_label=label,
            y_label="deflection that trims, °",
            title="Deflection in trim",
            marks=tuple(lines),
            caption="Trailing edge down is positive, the same on both sides.",
        ),
    ]


def _loading(case: ReportCase, found: object) -> list[Block]:
    """Load along the half span beside the elliptic one."""
    CL = case.wing[0]
    loading = span_loading(found.solution)  # type: ignore[attr-defined]
    mine = (loading.surface == 0) & (loading.side > 0)
    order = np.argsort(loading.y[mine])
    y, chord, width = (v[mine][order] for v in (loading.y, loading.chord, loading.width))
    tip = float(y[-1]) + 0.5 * float(width[-1])
    mean = float(np.sum(chord * width) / np.sum(width))
    load, local = [], []
    for d in (-5.0, 0.0, 5.0):
        inputs = inputs_at_lift(found, CL, float(np.radians(d)))  # type: ignore[arg-type]
        x = np.array([inputs.get(name, 0.0) for name in loading.names])
        cl = loading.cl[mine][order] @ x
        name = f"deflection {d:+.3g}°" if d else "deflection 0°"
        load.append(Series(name=name, x=y / tip, y=cl * chord / mean))
        local.append(Series(name=name, x=y / tip, y=cl))
        if d == 0.0:
            ellipse = np.sqrt(np.maximum(1.0 - (y / tip) ** 2, 0.0))
            elliptic = ellipse * np.sum(cl * chord / mean * width) / np.sum(ellipse * width)
    load.append(Series(name="elliptic, the same lift", x=y / tip, y=elliptic, colour=5))
    return [
        Chart(
            series=tuple(load),
            x_label="y / half span, -",
            y_label="c cl / mean chord, -",
            title="Span loading",
            x_range=(0.0, 1.0),
            caption=f"At CL = {CL:g}. The nearer to the ellipse, the less induced drag.",
        ),
        Chart(
            series=tuple(local),
            x_label="y / half span, -",
            y_label="local lift coefficient cl, -",
            title="Local lift",
            x_range=(0.0, 1.0),
            caption="Stall begins where this is highest: inboard is benign, at the tips it rolls the aircraft.",
        ),
    ]
