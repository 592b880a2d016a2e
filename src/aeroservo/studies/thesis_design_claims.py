"""What the thesis says about the efficiency of its design, judged by the numbers of the re-run."""

from __future__ import annotations

import numpy as np

from aeroservo.studies.thesis_design import FLAPS, TAPERS, Design, Morphing, morphing
from aeroservo.studies.thesis_design_figures import REYNOLDS
from aeroservo.studies.thesis_records import Claim, verdict


def design_claims(design: Design) -> tuple[Claim, ...]:
    """What the thesis says about efficiency, judged.

    Parameters
    ----------
    design : Design
        Of `thesis_design`.

    Returns
    -------
    claims : tuple of Claim
        In the thesis' order.
    """
    more = morphing(design)
    return (_cg_claim(design), _taper_claim(design), *_flap_claims(design), *_morphing_claims(design, more))


def _cg_claim(design: Design) -> Claim:
    trim = design.trims["hinged"]
    ratio, margin = trim.polar.lift_to_drag, trim.static_margin
    good = np.isfinite(ratio)
    at = {m: float(np.interp(m, margin[good], ratio[good])) for m in (0.1, 0.05, 0.0, -0.05, -0.1)}
    rises = at[0.1] < at[0.05] < at[0.0]
    return Claim(
        section="3.4, Fig. 4",
        statement="an aft centre of gravity is more efficient",
        verdict=verdict(whole=rises and at[0.0] < at[-0.05] < at[-0.1], part=rises),
        numbers=f"trimmed L/D {at[0.1]:.1f}, {at[0.05]:.1f}, {at[0.0]:.1f}, {at[-0.05]:.1f}, {at[-0.1]:.1f} at "
        "static margins of "
        "10, 5, 0, -5, -10 %",
    )


def _taper_claim(design: Design) -> Claim:
    best = {sweep: TAPERS[int(np.argmax(e))] for sweep, e in design.efficiency.items()}
    loss = {sweep: float(e.max() - e[TAPERS.index(0.4)]) for sweep, e in design.efficiency.items()}
    return Claim(
        section="3.4, 9.1.3",
        statement="a taper of 0.4 comes closest to the elliptic wing",
        verdict=verdict(whole=all(abs(b - 0.4) < 0.05 for b in best.values()), part=max(loss.values()) < 0.005),
        numbers=f"induced drag is least at a taper of {best[0.0]:g} unswept and {best[23.0]:g} with 23 deg of sweep; "
        "0.4 costs "
        f"{100 * loss[0.0]:.2f} and {100 * loss[23.0]:.2f} %",
    )


def _flap_claims(design: Design) -> tuple[Claim, ...]:
    table = {re: {d: design.best("hinged", d, re) for d in (*FLAPS, 15.0)} for re in REYNOLDS}
    ten = all(max(FLAPS, key=lambda d, re=re: table[re][d]) == 10.0 for re in REYNOLDS)  # type: ignore[misc]
    wing = {d: design.best_of_wing("hinged", d)[0] for d in FLAPS}
    top = max(wing, key=lambda d: wing[d])
    inviscid = design.best_of_wing("hinged", 0.0, viscous=False)[0]
    return (
        Claim(
            section="9.1.1, Fig. 21",
            statement="the section has its best L/D with the flap 10 degrees down",
            verdict=verdict(whole=ten, part=table[1e6][10.0] > table[1e6][0.0]),
            numbers=f"among -10 to +10 deg at each of Re 0.5 to 2.5 million; Re 1 million: {table[1e6][0.0]:.0f} at 0, "
            f"{table[1e6][10.0]:.0f} at +10, and {table[1e6][15.0]:.0f} beyond it at +15",
        ),
        Claim(
            section="9.1.1",
            statement="efficiency is somewhat higher with the flap down",
            verdict=verdict(whole=top >= 10.0, part=table[1e6][10.0] > table[1e6][0.0]),
            numbers=f"the section gains {100 * (table[1e6][10.0] / table[1e6][0.0] - 1):.0f} % at +10 deg, Re 1 "
            "million; the wing "
            f"with elevons on its outer halves and 5 deg of washout has {wing[0.0]:.1f} at 0, {wing[5.0]:.1f} at +5 "
            "and "
            f"{wing[10.0]:.1f} at +10",
        ),
        Claim(
            section="9.1.3",
            statement="viscous polars give a much smaller L/D than inviscid ones",
            verdict=verdict(whole=wing[0.0] < 0.7 * inviscid, part=wing[0.0] < inviscid),
            numbers=f"{wing[0.0]:.1f} against {inviscid:.1f} at the same lift, flaps 0",
        ),
    )


def _morphing_claims(design: Design, more: Morphing) -> tuple[Claim, ...]:
    gains = [design.at_equal_lift(1e6, d, more.polar) - 1.0 for d in (5.0, 10.0)]
    wing = {k: max(design.best_of_wing(k, d)[0] for d in FLAPS) for k in ("hinged", "morphed")}
    return (
        Claim(
            section="9.1.3",
            statement="the morphed elevon gives more lift per angle than the hinged one",
            verdict=verdict(whole=more.same_slope > 1.0 and more.wing > 1.0, part=more.wing > 1.0),
            numbers=f"{more.same_drop:.2f} times (section) and {more.wing:.2f} times (wing) if equal angle means "
            "equal drop of "
            f"the trailing edge; {more.same_slope:.2f} if it means equal slope there",
        ),
        Claim(
            section="9.1.3",
            statement="otherwise morphing is a small improvement only",
            verdict=verdict(whole=all(0.0 < g < 0.1 for g in gains), part=any(abs(g) < 0.1 for g in gains)),
            numbers=f"section L/D {100 * gains[0]:+.0f} and {100 * gains[1]:+.0f} % at +5 and +10 deg against a "
            "hinge of the "
            f"same lift, Re 1 million; best of the untrimmed wing {wing['morphed']:.1f} against {wing['hinged']:.1f}",
        ),
    )
