"""Table 1 and Figures 2 to 6, 18, 19 and 21 to 25 of the thesis beside ours."""

from __future__ import annotations

import numpy as np

from aeroservo.aero.vlm_loads import span_loading
from aeroservo.aeroelastic.aircraft_lattice import AircraftLattice
from aeroservo.studies.aircraft_aero import inputs_at_lift
from aeroservo.studies.thesis_design import (
    CRUISE_CL,
    FLAPS,
    SPEED,
    Design,
    Morphing,
    airfoil_numbers,
    morphing,
    outlines,
)
from aeroservo.studies.thesis_records import Compared, Curve, Entry, Plot

REYNOLDS = (0.5e6, 1.0e6, 1.5e6, 2.5e6)


def design_entries(design: Design) -> tuple[Entry, ...]:
    """Table 1 and the figures of chapters 2, 3.4, 8.1 and 9.1.

    Parameters
    ----------
    design : Design
        Of `thesis_design`.

    Returns
    -------
    entries : tuple of Entry
        In the thesis' order.
    """
    more = morphing(design)
    return (
        _table_1(design),
        _figure_2(design),
        _figure_3(design),
        _figure_4(design),
        *_figures_5_6(design, more),
        *_figures_18_19(design, more),
        _figure_21(design),
        *(_wing_figure(design, kind, viscous=viscous) for kind in ("hinged", "morphed") for viscous in (False, True)),
    )


def _table_1(design: Design) -> Entry:
    """Design properties."""
    d = design.model.derived()
    stiff = "the thesis' unit (kg/m, kg/rad) is a misprint: read as N/m and N m/rad"
    rows = (
        Compared(what="mass", unit="kg", thesis=10.0, ours=d["mass_kg"], reason="input"),
        Compared(
            what="inertia in pitch", unit="kg m2", thesis=0.503, ours=d["Iyy_about_moment_point_kg_m2"],
            reason="10 kg spread evenly over the planform, about the quarter of the mean chord",
        ),
        Compared(what="span", unit="m", thesis=2.0, ours=d["wing_span_m"], reason="input"),
        Compared(what="wing area", unit="m2", thesis=1.0, ours=d["wing_area_m2"], reason="follows from the chords"),
        Compared(what="mean aerodynamic chord", unit="m", thesis=0.53, ours=d["wing_mac_m"], reason="rounded there"),
        Compared(what="aspect ratio", unit="", thesis=4.0, ours=d["wing_aspect_ratio"], reason="follows"),
        Compared(what="taper ratio", unit="", thesis=0.43, ours=d["wing_taper"], reason="follows; rounded there"),
        Compared(
            what="effective sweep", unit="deg", thesis=23.0, ours=d["wing_sweep_quarter_chord_deg"],
            reason="of the quarter-chord line: leading-edge and half-chord readings give inertias of 0.455 and 0.557",
        ),
        Compared(what="plunge stiffness", unit="N/m", thesis=1644.0, ours=1644.0, reason=stiff),
        Compared(what="pitch stiffness", unit="N m/rad", thesis=413.2, ours=413.2, reason=stiff),
    )  # fmt: skip
    off = max(abs(r.difference or 0.0) / abs(float(r.thesis)) for r in rows if isinstance(r.thesis, float))
    return Entry(
        number="Table 1",
        title="Design properties",
        thesis="Mass, inertia, planform and two stiffnesses of a tailless flying wing.",
        finding=f"One planform fits every printed number: the largest difference is {100 * off:.1f} %.",
        compared=rows,
        plots=(planform_plot(design),),
        unsound="The table prints the span of the whole wing, its whole mass and stiffnesses without saying of what. "
        "Tables 2 and 3 come out only if these numbers are put straight into formulas of a HALF wing of 2 m and 10 kg.",
    )


def planform_plot(design: Design) -> Plot:
    """The wing from above, with its elevons.

    Parameters
    ----------
    design : Design
        Of `thesis_design`.

    Returns
    -------
    plot : Plot
        Metres, nose up.
    """
    (surface,) = design.model.surfaces()
    edge, chord = surface.leading_edge, surface.chords
    y, x = edge[:, 1], edge[:, 0]
    outline = np.concatenate([np.c_[y, x], np.c_[y, x + chord][::-1]])
    whole = np.concatenate([outline, outline[::-1] * [-1.0, 1.0]])
    curves = [Curve(name="outline", x=whole[:, 0], y=-whole[:, 1])]
    (control,) = surface.controls
    span = np.array([control.span_from, control.span_to]) * y[-1]
    nose, c = np.interp(span, y, x), np.interp(span, y, chord)
    hinge = nose + np.array([control.hinge_from, control.hinge_to]) * c
    for sign, name in ((1.0, "elevon, starboard"), (-1.0, "elevon, port")):
        ys = sign * np.array([span[0], span[1], span[1], span[0], span[0]])
        xs = np.array([hinge[0], hinge[1], nose[1] + c[1], nose[0] + c[0], hinge[0]])
        curves.append(Curve(name=name, x=ys, y=-xs))
    return Plot(
        title="Planform", x_label="y (starboard), m", y_label="-x (forward), m", curves=tuple(curves), equal=True
    )


def _figure_2(design: Design) -> Entry:
    """The airfoil."""
    t, x, thin, polar = airfoil_numbers(design)
    points = design.foil.points
    return Entry(
        number="Fig. 2",
        title="Airfoil MH 62",
        thesis="A flying-wing section, 9.30 % thick, with a very small moment coefficient.",
        finding=f"{100 * t:.2f} % thick at {100 * x:.0f} % of the chord. Moment at zero lift {thin:+.4f} by "
        "thin-aerofoil "
        f"theory and {polar:+.4f} by XFOIL at Re 1 million.",
        compared=(Compared(what="thickness", unit="%", thesis=9.30, ours=100.0 * t, reason="public coordinates"),),
        plots=(
            Plot(
                title="MH 62", x_label="x/c", y_label="z/c", equal=True,
                curves=(Curve(name="outline", x=points[:, 0], y=points[:, 1]),),
            ),
        ),
    )  # fmt: skip


def _elevon_share(design: Design) -> tuple[np.ndarray, np.ndarray]:
    """Static margin and the elevon's lift in trim over the weight."""
    trim = design.trims["hinged"]
    return trim.static_margin, design.slope("hinged") * trim.delta / CRUISE_CL


def _figure_3(design: Design) -> Entry:
    """What the tailplane's place costs, with the elevon in it."""
    margin, share = _elevon_share(design)
    good = np.isfinite(share)
    zero = float(np.interp(0.0, share[good][::-1], margin[good][::-1]))
    at = {m: float(np.interp(m, margin[good], share[good])) for m in (0.1, -0.05)}
    return Entry(
        number="Fig. 3",
        title="Weight and lift of a conventional aircraft",
        thesis="The wing must carry the weight and the tail's down force; moving the centre of gravity aft lessens it.",
        finding="For the flying wing the elevon stands in the tailplane's place: with 10 % static margin it takes "
        "away "
        f"{-100 * at[0.1]:.0f} % of the weight in lift, with the centre of gravity 5 % behind the neutral point it "
        "adds "
        f"{100 * at[-0.05]:.0f} %; it carries nothing at a static margin of {100 * zero:.1f} %.",
        plots=(
            Plot(
                title=f"Lift of the elevon in trim, CL {CRUISE_CL:g}", x_label="static margin, % of the mean chord",
                y_label="elevon lift / weight, %",
                curves=(Curve(name="hinged elevon", x=100.0 * margin, y=100.0 * share),),
                marks=((0.0, "neutral point"),),
            ),
        ),
    )  # fmt: skip


def _figure_4(design: Design) -> Entry:
    """What stability costs."""
    curves, words = [], []
    for kind, trim in design.trims.items():
        ratio = trim.polar.lift_to_drag
        curves.append(Curve(name=f"{kind} elevon", x=100.0 * trim.static_margin, y=ratio))
        i = int(np.nanargmax(ratio))
        ahead = float(np.interp(0.1, trim.static_margin, ratio))
        words.append(
            f"{kind}: {ahead:.1f} with 10 % static margin, {float(np.interp(0.0, trim.static_margin, ratio)):.1f} at "
            "the "
            f"neutral point, best {ratio[i]:.1f} at {100 * trim.static_margin[i]:+.0f} %"
        )
    return Entry(
        number="Fig. 4",
        title="Position of the centre of gravity",
        thesis="A forward centre of gravity costs drag; an aft one with a stability system flies best.",
        finding=f"Trimmed L/D at CL {CRUISE_CL:g}, {SPEED:g} m/s: " + "; ".join(words) + ".",
        plots=(
            Plot(
                title="Trimmed L/D against static margin", x_label="static margin, % of the mean chord",
                y_label="trimmed L/D", curves=tuple(curves), marks=((0.0, "neutral point"),),
            ),
        ),
    )  # fmt: skip


def _figures_5_6(design: Design, more: Morphing) -> tuple[Entry, Entry]:
    """Hinged and morphed sections, 10 degrees down."""
    shapes = outlines(design, 10.0)
    entries = []
    for number, kind, text in (
        ("Fig. 5", "hinged", "A conventional hinged trailing edge."),
        ("Fig. 6", "morphed", "A bent trailing edge; the maker quotes up to 12 % of fuel saved."),
    ):
        points = shapes[kind].points
        finding = (
            f"Ten degrees down about 75 % of the chord: the trailing edge drops by {-100 * points[0, 1]:.1f} % of it."
        )
        if kind == "morphed":
            gains = [100.0 * (design.at_equal_lift(1e6, d, more.polar) - 1.0) for d in (5.0, 10.0)]
            finding += (
                f" With the same drop it gives {more.same_drop:.2f} times the hinge's lift per angle (thin aerofoil; "
                "XFOIL "
                f"{more.polar:.2f}), with the same slope at the trailing edge {more.same_slope:.2f}. Best section "
                "L/D at "
                f"+5 and +10 deg against a hinge of the same lift: {gains[0]:+.0f} and {gains[1]:+.0f} % (Re 1 "
                "million); "
                "fuel is not computed here."
            )
        entries.append(
            Entry(
                number=number,
                title=f"{kind} design",
                thesis=text,
                finding=finding,
                plots=(
                    Plot(
                        title=f"MH 62, {kind}, +10 deg", x_label="x/c", y_label="z/c", equal=True,
                        curves=(
                            Curve(name="undeflected", x=design.foil.points[:, 0], y=design.foil.points[:, 1]),
                            Curve(name=kind, x=points[:, 0], y=points[:, 1]),
                        ),
                    ),
                ),
            )
        )  # fmt: skip
    return entries[0], entries[1]


def _figures_18_19(design: Design, more: Morphing) -> tuple[Entry, Entry]:
    """The wing model with its flaps down."""
    entries = []
    for number, kind in (("Fig. 18", "hinged"), ("Fig. 19", "morphed")):
        found = design.lattices[kind]
        d = found.derivatives
        curves = []
        for delta in (0.0, 10.0):
            y, load = _loading(found, inputs_at_lift(found, CRUISE_CL, float(np.radians(delta))))
            curves.append(Curve(name=f"elevons {delta:+g} deg" if delta else "elevons 0 deg", x=y, y=load))
        y = curves[0].x
        curves.append(Curve(name="elliptic", x=y, y=CRUISE_CL * 4.0 / np.pi * np.sqrt(np.maximum(1.0 - y**2, 0.0))))
        entries.append(
            Entry(
                number=number,
                title=f"Wing model, flaps down, {kind}",
                thesis="A drawing of the wing in XFLR5 with its flaps down.",
                finding=f"The same wing by our vortex lattice: lift slope {d.of('CL', 'alpha'):.3f}/rad, elevon lift "
                f"{design.slope(kind):.3f}/rad, neutral point x = {d.neutral_point:.4f} m."
                + (f" Morphed over hinged: {more.wing:.2f}." if kind == "morphed" else ""),
                plots=(
                    planform_plot(design),
                    Plot(
                        title=f"Span loading at CL {CRUISE_CL:g}, {kind}", x_label="y / half span",
                        y_label="c cl / mean chord", curves=tuple(curves),
                    ),
                ),
            )
        )  # fmt: skip
    return entries[0], entries[1]


def _loading(found: AircraftLattice, inputs: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Load c cl over the mean chord along the starboard half."""
    loading = span_loading(found.solution)
    mine = loading.side > 0
    order = np.argsort(loading.y[mine])
    y, chord, width = (v[mine][order] for v in (loading.y, loading.chord, loading.width))
    x = np.array([inputs.get(name, 0.0) for name in loading.names])
    tip = float(y[-1] + 0.5 * width[-1])
    return y / tip, (loading.cl[mine][order] @ x) * chord * np.sum(width) / np.sum(chord * width)


def _figure_21(design: Design) -> Entry:
    """Best section L/D against flap setting."""
    polar = design.sections["hinged"]
    degrees = np.degrees(polar.delta)
    curves = [
        Curve(name=f"Re {re / 1e6:g} million", x=degrees, y=[design.best("hinged", float(d), re) for d in degrees])
        for re in REYNOLDS
    ]
    table = {re: {d: design.best("hinged", d, re) for d in (*FLAPS, 15.0)} for re in REYNOLDS}
    rows = tuple(
        Compared(
            what=f"best of -10 to +10 deg, Re {re / 1e6:g} million", unit="deg", thesis=10.0,
            ours=max(FLAPS, key=lambda d, re=re: table[re][d]),  # type: ignore[misc]
            reason=f"L/D {table[re][-10.0]:.0f}, {table[re][0.0]:.0f}, {table[re][10.0]:.0f} at -10, 0, +10; "
            f"{table[re][15.0]:.0f} at +15 deg",
        )
        for re in REYNOLDS
    )  # fmt: skip
    return Entry(
        number="Fig. 21",
        title="Section L/D for flap settings and Reynolds numbers",
        thesis="Of flaps from -10 to 10 degrees, 10 degrees down has the highest L/D, Re 0.5 to 2.5 million.",
        finding=f"So it is at every Reynolds number, at the edge of what was tried: +15 deg is better still "
        f"({table[1e6][15.0]:.0f} against {table[1e6][10.0]:.0f} at Re 1 million). Untrimmed: the section's moment "
        "there "
        "must be held by something.",
        compared=rows,
        plots=(
            Plot(
                title="Best section L/D (median of three points)", x_label="flap, deg", y_label="best L/D",
                curves=tuple(curves), marks=((10.0, "the thesis' best"),),
            ),
        ),
    )  # fmt: skip


_NUMBERS = {("hinged", False): 22, ("hinged", True): 23, ("morphed", False): 24, ("morphed", True): 25}


def _wing_figure(design: Design, kind: str, *, viscous: bool) -> Entry:
    """Figures 22 to 25: drag, lift, moment and L/D against incidence."""
    polars = design.polars[kind]
    degrees = np.degrees(design.alpha)
    quantities = (
        ("CD", lambda p: p.CD if viscous else p.CD_induced, None),
        ("CL", lambda p: p.CL, None),
        ("CM about the reference point", lambda p: p.CM_viscous if viscous else p.CM, None),
        ("L/D", lambda p: p.lift_to_drag if viscous else p.lift_to_drag_inviscid, (-30.0, 30.0 if viscous else 100.0)),
    )
    plots = tuple(
        Plot(
            title=name, x_label="angle of attack, deg", y_label=name, y_range=room,
            curves=tuple(
                Curve(name=f"{d:+g} deg" if d else "0 deg", x=degrees, y=of(p)) for d, p in zip(FLAPS, polars)
            ),
        )
        for name, of, room in quantities
    )  # fmt: skip
    best = {d: design.best_of_wing(kind, d) for d in FLAPS}
    top = max(best, key=lambda d: best[d][0])
    if viscous:
        listed = ", ".join(f"{best[d][0]:.1f}" for d in FLAPS)
        finding = (
            f"Best L/D at flaps of -10, -5, 0, +5, +10 deg: {listed}; highest at {top:+g} deg, CL {best[top][1]:.2f}."
        )
    else:
        ratio = design.best_of_wing(kind, 0.0, viscous=False)[0]
        finding = (
            f"Induced drag only: at the lift where the viscous wing flies best (CL {best[0.0][1]:.2f}, flaps 0) L/D is "
            f"{ratio:.0f}, and it grows without bound towards zero lift: no best value is meant by this figure."
        )
    air = "viscous" if viscous else "inviscid"
    return Entry(
        number=f"Fig. {_NUMBERS[kind, viscous]}",
        title=f"Wing polars, {kind}, {air}",
        thesis="CD, CL, CM and L/D against incidence for flap settings, by XFLR5.",
        finding=finding
        + f" Elevon lift {design.slope(kind):.3f}/rad."
        + (" Strips that ask more of their section than its polar has end a curve." if viscous else ""),
        plots=plots,
    )
