"""Figures 14 to 16 and 26 to 30 of the thesis beside ours, and what it holds derivatives at."""

from __future__ import annotations

import numpy as np

from aeroservo.aeroelastic.flutter import FlutterResult
from aeroservo.datatypes import FlightCondition
from aeroservo.studies.thesis import ALTITUDES, MODELS, Column, Held, Model, Run
from aeroservo.studies.thesis_aeroelastic import HIGH, SURFACES, SWEEPS, Aeroelastic
from aeroservo.studies.thesis_fixed_k import common_ranges
from aeroservo.studies.thesis_records import Compared, Curve, Entry, Plot, number

NEAR = 0.95
"""Twist is drawn to this part of the divergence speed: at it, twist has no bound."""
LONG = {"binary": "binary wing", "aircraft": "whole aircraft"}
THEORIES = (
    ("quasi_steady_damped", "a_w", "quasi-steady (p)"),
    ("theodorsen", "a_w", "Theodorsen, a_w (p-k)"),
    ("theodorsen", "2 pi", "Theodorsen, 2 pi (p-k)"),
)


def aeroelastic_entries(a: Aeroelastic) -> tuple[Entry, ...]:
    """The figures of chapters 7, 9.2 and 9.3.

    Parameters
    ----------
    a : Aeroelastic
        Of `thesis_aeroelastic`.

    Returns
    -------
    entries : tuple of Entry
        In the thesis' order; last the derivatives held at one k.
    """
    return (
        _figure_14(a),
        _figure_15(a),
        _figure_16(a),
        _figure_26(a),
        *(_prediction(a, figure, model) for figure, model in zip((27, 28), MODELS)),
        _figure_29(a),
        _figure_30(a),
        _held(a),
    )


def _figure_14(a: Aeroelastic) -> Entry:
    """Divergence: the angle grows as q/(q_D - q)."""
    curves = []
    for name, V_D in a.divergence.items():
        V = np.linspace(0.0, 0.97 * V_D, 60)
        curves.append(Curve(name=f"{name}, {V_D:.1f} m/s", x=V, y=V**2 / (V_D**2 - V**2)))
    d = a.divergence
    return Entry(
        number="Fig. 14",
        title="Torsional divergence",
        thesis="A section on a torsion spring, twisted by its own lift; equations 7.5 and 7.6 give the angle and the "
        "speed at which it has no bound. Aft sweep raises that speed, forward sweep lowers it (7.11).",
        finding=f"With the inputs of the binary wing: {d['section']:.2f} m/s for the section on a spring, "
        f"{d['linear twist']:.2f} for a wing that twists linearly, {d['uniform beam']:.2f} for a uniform beam. The "
        "tables' 81 "
        "is that of linear twist.",
        compared=(
            Compared(
                what="divergence, sea level, linear twist", unit="m/s", thesis=81.0, ours=d["linear twist"],
                reason="e a_w was inferred from this number",
            ),
        ),
        plots=(
            Plot(
                title="Elastic over rigid angle", x_label="true airspeed, m/s", y_label="theta / alpha",
                curves=tuple(curves), y_range=(0.0, 12.0),
            ),
            Plot(
                title="Divergence against sweep, rigid wing on root springs", x_label="sweep, deg (aft positive)",
                y_label="divergence, m/s",
                curves=(
                    Curve(name="spring in bending K_h s2", x=np.array(SWEEPS), y=a.swept),
                    Curve(name="stiff in bending", x=np.array(SWEEPS), y=a.stiff_in_bending),
                ),
            ),
        ),
        unsound="Equation 7.11 as printed has a wrong sign and lacks a factor s; put right, and with stiff bending, "
        "the "
        "speed rises with sweep of either sign. Equation 7.2 prints 'theta + theta' for theta_0 + theta.",
    )  # fmt: skip


def _figure_15(a: Aeroelastic) -> Entry:
    """Two degrees of freedom: what flutter is."""
    found = a.study.run("binary", HIGH, "quasi_steady_damped").flutter
    ratio, phase = a.motion
    curves = tuple(
        Curve(name=name, x=found.speeds[:, j], y=found.roots[:, j].real) for j, name in enumerate(found.names)
    )
    return Entry(
        number="Fig. 15",
        title="Flutter in two degrees of freedom",
        thesis="Bending and twist on two springs; growth below, at and above zero is stable, neutral, unstable (7.22).",
        finding=f"Growth of both roots of the binary wing: zero at {number(found.flutter_speed)} m/s, at "
        f"{(found.flutter_frequency or np.nan) / 2 / np.pi:.2f} Hz. There the tip bends by {ratio:.2f} chords for "
        "each radian of twist, "
        f"bending (down) {np.degrees(phase):.0f} degrees ahead of twist (nose up): one growing motion of both, not "
        "two.",
        plots=(
            Plot(
                title="Growth of the roots, binary wing, 10,000 ft", x_label="true airspeed, m/s",
                y_label="growth, 1/s (positive: unstable)", curves=curves,
                marks=((found.flutter_speed or np.nan, "flutter"),),
            ),
        ),
    )  # fmt: skip


def _figure_16(a: Aeroelastic) -> Entry:
    """The pitch-plunge-elevon model: BACT, then the thesis' wing in it."""
    psf, hertz = a.bact
    rows = [
        Compared(
            what="BACT, flutter in the tunnel", unit="psf", thesis="148 to 150", ours=psf,
            reason="the model's published inputs; 149.08 published for them",
        ),
        Compared(what="BACT, flutter frequency", unit="Hz", thesis="near 4", ours=hertz, reason="the same"),
    ]  # fmt: skip
    for altitude, (V_f, V_d, V_r) in a.simulation.items():
        where = "sea level" if altitude == 0.0 else "10,000 ft"
        rows.append(
            Compared(
                what=f"thesis' wing, open loop, {where}: flutter, divergence, lift reversal", unit="m/s", thesis=None,
                ours=f"{number(V_f)}, {number(V_d, 5)}, {number(V_r)}",
                reason="pinned inputs, preset thesis-simulation",
            )
        )  # fmt: skip
    return Entry(
        number="Fig. 16",
        title="Pitch, plunge and elevon",
        thesis="The model of NASA's BACT wing, 'proven to comply well with the real model', is used for the "
        "simulations.",
        finding=f"With BACT's own inputs it flutters at {psf:.2f} psf and {hertz:.2f} Hz; the tunnel's boundary is "
        "148 to 150 psf.",
        compared=tuple(rows),
        unsound="Equation 7.48 has (theta + delta) squared for the rate, 7.53 lacks cos theta in the weight of the "
        "pitch "
        "row, 7.47's alpha_0 would count the trim twice, and appendix .3 misplaces c/2U and a sign: put right here. "
        "The "
        "inputs of the thesis' own wing in this model are printed nowhere.",
    )


def _figure_26(a: Aeroelastic) -> Entry:
    """Twist, effectiveness and damping against speed in one figure."""
    run = a.study.run("binary", HIGH, "quasi_steady_damped")
    still, found = run.static, run.flutter
    V_D = still.divergence.V or np.inf
    kept = (still.V <= NEAR * V_D) & np.isfinite(still.twist)
    curves = [
        Curve(
            name=f"twist, % of that at {still.V[kept][-1]:.0f} m/s", x=still.V[kept],
            y=100.0 * still.twist[kept] / still.twist[kept][-1],
        ),
        Curve(name="roll effectiveness, % of rigid", x=still.V, y=100.0 * still.effectiveness),
        *(
            Curve(name=f"damping of {name}, % (positive: flutter)", x=found.speeds[:, j], y=_percent(found, j))
            for j, name in enumerate(found.names)
        ),
    ]  # fmt: skip
    rows = (
        Compared(
            what="flutter", unit="m/s", thesis=56.0, ours=found.flutter_speed, reason="the thesis cuts 56.8 to 56"
        ),
        Compared(
            what="divergence", unit="m/s", thesis=90.0, ours=still.divergence.V,
            reason="'around 90' is read from the figure; the thesis' own Table 3 has 94",
        ),
        Compared(
            what="roll reversal", unit="m/s", thesis=63.0, ours=still.reversal.V,
            reason="read from the figure; Table 3 has 64",
        ),
    )  # fmt: skip
    return Entry(
        number="Fig. 26",
        title="Twist, control effectiveness and damping against speed",
        thesis="At 10,000 ft flutter at 56, reversal at 63, divergence at around 90 m/s.",
        finding="The same order and, to what can be read from a figure, the same speeds.",
        compared=rows,
        plots=(
            Plot(
                title="Aeroelastic response, binary wing, quasi-steady, 10,000 ft", x_label="true airspeed, m/s",
                y_label="per cent", curves=tuple(curves), y_range=(-105.0, 105.0),
                marks=tuple((float(r.ours), r.what) for r in rows if isinstance(r.ours, float)),
            ),
        ),
    )  # fmt: skip


def _percent(found: FlutterResult, j: int) -> np.ndarray:
    """Damping as the thesis has it, where the branch swings."""
    swings = np.isfinite(found.roots[:, j]) & (found.frequency[:, j] > 0.0)
    return np.where(swings, -100.0 * found.damping_ratio[:, j], np.nan)


def _prediction(a: Aeroelastic, figure: int, model: Model) -> Entry:
    """Figures 27 and 28: frequency and damping, quasi-steady beside unsteady."""
    rows, plots = [], []
    for theory, slope, words in THEORIES:
        run = a.study.run(model, HIGH, theory, slope)  # type: ignore[arg-type]
        plots += _sweep_plots(run, words)
    for altitude in ALTITUDES:
        where = "sea level" if altitude == 0.0 else "10,000 ft"
        printed = {r.column: r.printed for r in a.study.rows
                   if (r.model, r.altitude, r.quantity) == (model, altitude, "flutter")}  # fmt: skip
        for theory, slope, words in THEORIES:
            column: Column = "quasi" if theory == "quasi_steady_damped" else "unsteady"
            rows.append(
                Compared(
                    what=f"flutter, {words}, {where}", unit="m/s", thesis=float(printed[column]),
                    ours=a.flutter(model, altitude, theory, slope),
                    reason="inputs inferred" if column == "quasi" else "the thesis' k is not named; ours is consistent",
                )
            )  # fmt: skip
    real = a.study.run("aircraft", HIGH, "quasi_steady_damped").flutter.first_real_instability
    binary = (
        "Consistent unsteady terms raise the boundary when the lift slope stays what it was; the thesis' derivatives "
        "go "
        "over to 2 pi with them, and that lowers it."
    )
    whole = (
        "Past the boundary the quasi-steady oscillation of the whole aircraft stops swinging and becomes two real "
        "roots "
        f"that stay unstable, at {number(real, 5)} m/s: the 'bifurcations' of the thesis. With consistent p-k the "
        "unsteady "
        "result is as clear as the quasi-steady one."
    )
    return Entry(
        number=f"Fig. {figure}",
        title=f"Flutter prediction of the {LONG[model]}",
        thesis="Frequencies and damping against speed, quasi-steady beside unsteady"
        + ("." if model == "binary" else "; with unsteady terms 'the results become unclear' and bifurcations appear."),
        finding=binary if model == "binary" else whole,
        compared=tuple(rows),
        plots=tuple(plots),
        unsound="The unsteady columns hold the oscillatory derivatives at one reduced frequency for every speed and "
        "mode "
        "(7.34-7.36), and appendix .2 prints 1/9 for 1/8 in M_theta and stray factors k. A held k is right only "
        "where it "
        "is the flutter's own; p-k, beside it, makes it so.",
    )


def _sweep_plots(run: Run, words: str) -> list[Plot]:
    """Frequency and damping of a run."""
    found = run.flutter
    marks = () if found.flutter_speed is None else ((found.flutter_speed, "flutter"),)
    frequency, damping = [], []
    for j, name in enumerate(found.names[:3]):
        frequency.append(Curve(name=name, x=found.speeds[:, j], y=found.frequency[:, j] / (2.0 * np.pi)))
        damping.append(Curve(name=name, x=found.speeds[:, j], y=_percent(found, j)))
    label = "true airspeed, m/s"
    return [
        Plot(title=f"{words}: frequency", x_label=label, y_label="Hz", curves=tuple(frequency), marks=marks),
        Plot(
            title=f"{words}: damping", x_label=label, y_label="damping, % (positive: flutter)",
            curves=tuple(damping), marks=marks,
        ),
    ]  # fmt: skip


def _figure_29(a: Aeroelastic) -> Entry:
    """Damping over speed and altitude."""
    surface = a.surfaces[SURFACES[0]]
    height, V = np.array(surface.over.values), surface.flutter_speed
    rho = FlightCondition.at(height, V=np.ones_like(height)).rho
    equivalent = V * np.sqrt(rho / 1.225)
    return Entry(
        number="Fig. 29",
        title="Damping over speed and altitude",
        thesis="The flutter speed depends on density, which decreases with altitude.",
        finding=f"True flutter speed rises from {V[0]:.1f} m/s at sea level to {V[-1]:.1f} m/s at {height[-1]:.0f} "
        "m; equivalent "
        f"airspeed stays between {np.nanmin(equivalent):.1f} and {np.nanmax(equivalent):.1f} m/s.",
        plots=(
            Plot(
                title="Flutter boundary, whole aircraft, quasi-steady", x_label="altitude, m", y_label="m/s",
                curves=(
                    Curve(name="true airspeed", x=height, y=V),
                    Curve(name="equivalent airspeed", x=height, y=equivalent),
                ),
            ),
        ),
        surface=surface,
    )  # fmt: skip


def _figure_30(a: Aeroelastic) -> Entry:
    """Damping over speed and pitch stiffness."""
    surface = a.surfaces[SURFACES[1]]
    K, V = np.array(surface.over.values), surface.flutter_speed
    least = surface.damping_ratio[..., 0]
    pockets = K[[bool(np.any(row[surface.V > first] > 0.0)) for row, first in zip(least, V + 2.0)]]
    pocket = f" Up to {pockets[-1]:.0f} N m it is stable again between two ranges of flutter." if pockets.size else ""
    return Entry(
        number="Fig. 30",
        title="Damping over speed and pitch stiffness",
        thesis="The flutter speed depends on the stiffness in torsion.",
        finding=f"From {V[0]:.1f} m/s at {K[0]:.0f} N m to {V[-1]:.1f} m/s at {K[-1]:.0f} N m, "
        + ("rising all the way." if np.all(np.diff(V) > 0.0) else "not rising all the way.")
        + pocket,
        plots=(
            Plot(
                title="Flutter boundary, whole aircraft, quasi-steady, 10,000 ft", x_label="pitch stiffness, N m",
                y_label="flutter, m/s", curves=(Curve(name="flutter", x=K, y=V),),
                marks=((413.2, "the thesis' value"),),
            ),
        ),
        surface=surface,
    )  # fmt: skip


def _held(a: Aeroelastic) -> Entry:
    """Which k, if any, prints the thesis' unsteady numbers."""
    rows, plots, said = [], [], []
    for model in MODELS:
        for slope in ("a_w", "2 pi"):
            both = [h for h in a.study.held if (h.model, h.slope) == (model, slope)]
            common = common_ranges(both[0].ranges, both[1].ranges)
            found = ", ".join(f"{low:.3g} to {high:.3g}" for low, high in common) or "none"
            said.append(f"{LONG[model]}, {slope}: {found}")
        for altitude in ALTITUDES:
            mine = [h for h in a.study.held if (h.model, h.altitude) == (model, altitude)]
            where = "sea level" if altitude == 0.0 else "10,000 ft"
            rows += [
                Compared(
                    what=f"{LONG[model]}, {where}, {h.slope}: p-k at its own k = {number(h.own_k, 3)}", unit="m/s",
                    thesis=float(h.printed), ours=h.own_speed, reason="the only k at which held derivatives are right",
                )
                for h in mine
            ]  # fmt: skip
            curves = [_broken(h) for h in mine]
            points = [
                Curve(name=f"p-k, {h.slope}", x=[np.log10(h.own_k)], y=[h.own_speed], points=True)
                for h in mine
                if h.own_k is not None
            ]
            ends = np.log10(mine[0].curve.k[[0, -1]])
            printed = Curve(name="printed", x=ends, y=[mine[0].printed] * 2)
            plots.append(
                Plot(
                    title=f"{LONG[model]}, {where}: the thesis prints {mine[0].printed} m/s",
                    x_label="log10 of the held reduced frequency", y_label="flutter, m/s",
                    curves=(*curves, *points, printed),
                )
            )  # fmt: skip
    return Entry(
        number="Eqs. 7.34-7.36",
        title="Derivatives held at one reduced frequency",
        thesis="The unsteady columns use oscillatory derivatives at one k, which is not named.",
        finding="k that prints both altitudes: " + "; ".join(said) + ".",
        compared=tuple(rows),
        plots=tuple(plots),
        unsound="Derivatives held at a k belong to motion at that k. Only where k = omega b/V of the flutter itself "
        "do they "
        "describe it; there they agree with p-k. At any other k the speed is that of a motion which does not occur.",
    )


def _broken(held: Held) -> Curve:
    """Flutter speed over log k, with gaps where the curve changes to another branch; a point alone is no curve."""
    joined = held.curve.joined
    alone = ~(np.append(joined, False) | np.insert(joined, 0, False))
    V = np.where(alone, np.nan, held.curve.flutter_speed)
    jumps = np.flatnonzero(~joined) + 1
    k, V = (np.insert(values, jumps, np.nan) for values in (np.log10(held.curve.k), V))
    return Curve(name=f"slope {held.slope}", x=k, y=V)
