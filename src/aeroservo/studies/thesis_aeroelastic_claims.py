"""What the thesis says about divergence, reversal and flutter of its wing, judged by the numbers of the re-run."""

from __future__ import annotations

import numpy as np

from aeroservo.studies.thesis import ALTITUDES, MODELS
from aeroservo.studies.thesis_aeroelastic import HIGH, SURFACES, SWEEPS, Aeroelastic
from aeroservo.studies.thesis_records import Claim, verdict


def aeroelastic_claims(a: Aeroelastic) -> tuple[Claim, ...]:
    """The claims of chapters 5.2.4, 7 and 9.2 to 9.5 about the models without control.

    Parameters
    ----------
    a : Aeroelastic
        Of `thesis_aeroelastic`.

    Returns
    -------
    claims : tuple of Claim
        In the thesis' order.
    """
    return (
        _bending_and_torsion(a),
        _divergence_and_sweep(a),
        _rate_derivative(a),
        _structural_damping(a),
        _sweep(a),
        _order(a),
        _detail(a),
        _altitude(a),
        _stiffness(a),
        _unsteady(a),
        _rigid_body(a),
        _mission(a),
    )


def _bending_and_torsion(a: Aeroelastic) -> Claim:
    torsion_only, bending_only, both = a.relief
    return Claim(
        section="5.2.4",
        statement="bending hardly changes what the elevons do (2 %), torsion does much",
        verdict=verdict(whole=1.0 - bending_only < 0.05 < 1.0 - torsion_only, part=torsion_only < bending_only),
        numbers=f"roll effectiveness of the wing as drawn at 60 m/s, 10,000 ft: {bending_only:.3f} with bending only, "
        f"{torsion_only:.3f} with torsion only, {both:.3f} with both",
    )


def _divergence_and_sweep(a: Aeroelastic) -> Claim:
    ahead, none, aft = (a.swept[SWEEPS.index(x)] for x in (-30.0, 0.0, 30.0))
    stiff_ahead, stiff_none = (a.stiff_in_bending[SWEEPS.index(x)] for x in (-30.0, 0.0))
    soft = ahead < none and (aft > none or not np.isfinite(aft))
    drawn = a.uav[0.0][1]
    return Claim(
        section="7.2.1",
        statement="sweep back raises the divergence speed, forward sweep lowers it",
        verdict=verdict(whole=soft and stiff_ahead < stiff_none, part=soft),
        numbers=f"rigid wing on root springs, -30, 0, +30 deg: {ahead:.1f}, {none:.1f}, {aft:.1f} m/s; stiff in "
        "bending, forward "
        f"sweep raises it too: {stiff_none:.1f} to {stiff_ahead:.1f}; the wing as drawn, 23 deg aft, "
        + ("does not diverge" if drawn is None else f"diverges at {drawn:.1f} m/s"),
    )


def _rate_derivative(a: Aeroelastic) -> Claim:
    with_it = a.flutter("binary", 0.0)
    return Claim(
        section="3.3",
        statement="the pitch-damping derivative is of significant importance",
        verdict=verdict(whole=abs(with_it / a.without_rate - 1.0) > 0.1),
        numbers=f"flutter of the binary wing at sea level {a.without_rate:.2f} m/s without it, {with_it:.2f} with "
        "it; consistent "
        f"unsteady theory, which needs no such number: {a.flutter('binary', 0.0, 'theodorsen'):.2f}",
    )


def _structural_damping(a: Aeroelastic) -> Claim:
    changes = {m: [a.damped[m, g] for g in (0.0, 0.02, 0.05)] for m in MODELS}
    speeds = np.array([[np.nan if v is None else v for v in row] for row in changes.values()])
    step = np.diff(speeds[:, :2], axis=1)
    return Claim(
        section="7.4.1",
        statement="a little structural damping can raise the flutter speed, and can also lower it",
        verdict=verdict(whole=bool(np.any(step > 0.0) and np.any(step < 0.0)), part=bool(np.any(step > 0.0))),
        numbers="; ".join(
            f"{m}: {row[0]:.2f}, {row[1]:.2f}, {row[2]:.2f} m/s at g = 0, 0.02, 0.05" for m, row in zip(changes, speeds)
        )
        + " (p-k, 10,000 ft): here it raises; no case of ours lowers",
    )


def _sweep(a: Aeroelastic) -> Claim:
    angles, V = a.wing_sweep.T
    law = V * np.cos(np.radians(angles)) / V[0]
    return Claim(
        section="7.7",
        statement="sweep raises the flutter speed, by the component normal to the axis",
        verdict=verdict(whole=bool(np.all(np.diff(V) > 0.0) and np.ptp(law) < 0.01), part=bool(V[-1] > V[0])),
        numbers=", ".join(f"{v:.1f} m/s at {x:.0f} deg" for x, v in a.wing_sweep)
        + f"; V cos(sweep) is the same within {100 * np.ptp(law):.2f} % by construction of the model",
    )


def _order(a: Aeroelastic) -> Claim:
    rows, good = [], []
    for model in MODELS:
        for altitude in ALTITUDES:
            still = a.study.run(model, altitude, "quasi_steady_damped").static
            V_f, V_r, V_d = a.flutter(model, altitude), still.reversal.V or np.inf, still.divergence.V or np.inf
            good.append(V_f < V_r < V_d)
            rows.append(f"{model} {altitude:g} m: {V_f:.1f}, {V_r:.1f}, {V_d:.1f}")
    exact = [a.flutter(m, h, "theodorsen") for m in MODELS for h in ALTITUDES]
    reversal = [a.study.run(m, h, "theodorsen").static.reversal.V or np.inf for m in MODELS for h in ALTITUDES]
    sound = all(V < R for V, R in zip(exact, reversal))
    return Claim(
        section="9.2, Fig. 26, Tables 2-3",
        statement="flutter comes first, then reversal, then divergence",
        verdict=verdict(whole=all(good) and sound, part=all(good)),
        numbers="; ".join(rows)
        + "; with consistent unsteady air of slope a_w flutter comes "
        + ("before" if sound else "after")
        + f" reversal ({', '.join(f'{v:.1f}' for v in exact)} m/s) and before divergence",
    )


def _detail(a: Aeroelastic) -> Claim:
    found = {
        f"{m} {t} {s}": a.flutter(m, HIGH, t, s)
        for m in MODELS
        for t, s in (("quasi_steady_damped", "a_w"), ("theodorsen", "a_w"), ("theodorsen", "2 pi"))
    }
    low, high = min(found.values()), max(found.values())
    drawn = a.uav[HIGH][0] or np.nan
    return Claim(
        section="9.3.3",
        statement="the flutter speed depends highly on how detailed the model is",
        verdict=verdict(whole=high / low > 1.2),
        numbers=f"{low:.1f} to {high:.1f} m/s at 10,000 ft over theory and model; {drawn:.1f} for the wing as drawn, "
        "with the "
        "lattice's loading and a beam",
    )


def _altitude(a: Aeroelastic) -> Claim:
    surface = a.surfaces[SURFACES[0]]
    V = surface.flutter_speed
    return Claim(
        section="9.3.3, Fig. 29",
        statement="the flutter speed grows with altitude",
        verdict=verdict(whole=bool(np.all(np.diff(V) > 0.0)), part=bool(V[-1] > V[0])),
        numbers=f"{V[0]:.1f} m/s at sea level, {V[-1]:.1f} m/s at {surface.over.values[-1]:.0f} m, true airspeed",
    )


def _stiffness(a: Aeroelastic) -> Claim:
    V = a.plunge[:, 1]
    return Claim(
        section="10.2",
        statement="higher stiffness does not necessarily mean a higher flutter speed",
        verdict=verdict(whole=bool(np.any(np.diff(V) < 0.0))),
        numbers="plunge stiffness of the whole aircraft: "
        + ", ".join(f"{v:.1f} m/s at {k:.0f} N/m" for k, v in a.plunge),
    )


def _unsteady(a: Aeroelastic) -> Claim:
    quasi = {(m, h, "a_w"): a.flutter(m, h) for m in MODELS for h in ALTITUDES}
    quasi |= {(m, h, "2 pi"): a.equal_slope[m, h] for m in MODELS for h in ALTITUDES}
    change = {key: a.flutter(key[0], key[1], "theodorsen", key[2]) - V for key, V in quasi.items()}
    mixed = [a.flutter(m, h, "theodorsen", "2 pi") - a.flutter(m, h) for m in MODELS for h in ALTITUDES]
    up = sum(x > 0.0 for x in change.values())
    return Claim(
        section="9.5",
        statement="unsteady terms sometimes raise and sometimes lower the flutter speed",
        verdict=verdict(whole=0 < up < len(change), part=any(x < 0.0 for x in mixed)),
        numbers=f"at an equal lift slope they raise it in {up} of {len(change)} cases, by {min(change.values()):.1f} "
        "to "
        f"{max(change.values()):.1f} m/s; against quasi-steady air of slope a_w, unsteady air of slope 2 pi changes "
        "it by "
        f"{min(mixed):.1f} to {max(mixed):.1f}: it is the slope that lowers it",
    )


def _rigid_body(a: Aeroelastic) -> Claim:
    kinds = (("quasi_steady_damped", "a_w"), ("theodorsen", "a_w"), ("theodorsen", "2 pi"))
    change = [a.flutter("aircraft", h, *kind) - a.flutter("binary", h, *kind) for h in ALTITUDES for kind in kinds]
    lower = sum(x < 0.0 for x in change)
    return Claim(
        section="9.5",
        statement="rigid-body freedom generally lowers the flutter speed",
        verdict=verdict(whole=lower == len(change), part=2 * lower > len(change)),
        numbers=f"lower in {lower} of {len(change)} cases, by {min(change):.1f} to {max(change):+.1f} m/s; the "
        "thesis' unsteady "
        "columns print 14 m/s",
    )


def _mission(a: Aeroelastic) -> Claim:
    speeds = [a.flutter(m, h, t) for m in MODELS for h in ALTITUDES for t in ("quasi_steady_damped", "theodorsen")]
    drawn = [a.uav[h][0] or np.inf for h in ALTITUDES]
    return Claim(
        section="2.2",
        statement="the structure handles at least 60 m/s",
        verdict=verdict(whole=min(*speeds, *drawn) > 60.0, part=max(*speeds, *drawn) > 60.0),
        numbers=f"without control, flutter at {min(speeds):.1f} to {max(speeds):.1f} m/s in the tables' models; the "
        "wing as drawn "
        f"{drawn[0]:.1f} and {drawn[1]:.1f} m/s",
    )
