"""What the thesis says about its wing under control, judged by the numbers of the re-run."""

from __future__ import annotations

import numpy as np

from aeroservo.datatypes import FlightCondition
from aeroservo.studies.thesis import MODELS
from aeroservo.studies.thesis_aeroelastic import Aeroelastic
from aeroservo.studies.thesis_flight import Flight
from aeroservo.studies.thesis_flight_figures import peak
from aeroservo.studies.thesis_gains import DESIGN_SPEED, HIGH, SWITCH_SPEED, sign_changes
from aeroservo.studies.thesis_records import Claim, verdict


def flight_claims(f: Flight, a: Aeroelastic) -> tuple[Claim, ...]:
    """The claims of chapters 8.4, 9.4, 9.5, 10 and 11.

    Parameters
    ----------
    f : Flight
        Of `thesis_flight`.
    a : Aeroelastic
        Of `thesis_aeroelastic`.

    Returns
    -------
    claims : tuple of Claim
        In the thesis' order.
    """
    return (
        _settles(f),
        _turbulence(f),
        _hard_flutter(f),
        _reversal_speed(a),
        _reversal_ends_lqr(f, a),
        _reversed_outputs(f),
        _adaptive(f),
        _switch(f),
        _poles(f),
        _static_effects(f, a),
        _gain_of_lqr(f, a),
        _twice(f),
        _safe_speed(f),
        _mach(f),
        _unstable_without(f, a),
        _suppressed(f),
    )


def _at(f: Flight, V: float) -> int:
    return int(np.argmin(np.abs(f.V - V)))


def _settles(f: Flight) -> Claim:
    run, servo = f.runs["cosine"], f.servo_root
    settle = 4.0 / -(run.growth or np.nan)
    elevon = float(np.degrees(peak(run, "elevon_rad")))
    return Claim(
        section="9.4.4, Fig. 34",
        statement="the LQR settles after a 5 m/s gust in about the 6 s of its design",
        verdict=verdict(whole=run.bounded and 4.0 < settle < 8.0 and elevon < 25.0, part=run.bounded),
        numbers=f"{settle:.1f} s with our inputs, asking {elevon:.0f} degrees of elevon; with a servo of 60 rad/s "
        "inside it is "
        f"unstable, {servo.real:+.1f} ± {abs(servo.imag):.1f}i 1/s",
    )


def _turbulence(f: Flight) -> Claim:
    lqr, sound = f.peaks["lqr"], f.peaks["schedule"]
    good = lqr[:, 0].max() <= 0.04 and lqr[:, 1].max() <= 0.08
    few = np.degrees(lqr[:, 2].max()) < 5.0
    return Claim(
        section="9.4.4, Fig. 35",
        statement="the LQR handles turbulence well: plunge within 4 and 8 cm, pitch within a few degrees",
        verdict=verdict(whole=bool(good and few), part=bool(few)),
        numbers=f"in 1.83 m/s RMS plunge reaches {100 * lqr[:, :2].max():.0f} cm and pitch "
        f"{np.degrees(lqr[:, 2].max()):.0f} degrees; a "
        f"schedule with servo {100 * sound[:, :2].max():.0f} cm and {np.degrees(sound[:, 2].max()):.1f} degrees (the "
        "thesis' intensity "
        "is not named)",
    )


def _hard_flutter(f: Flight) -> Claim:
    V, root = f.lost[HIGH], f.lost_root
    return Claim(
        section="9.4.5, Table 3",
        statement="with the LQR flutter and divergence come at once, at 59 m/s at 10,000 ft",
        verdict=verdict(whole=abs(V - 59.0) < 1.0 and abs(root.imag) < 1e-6, part=abs(V - 59.0) < 1.0),
        numbers=f"lost at {V:.3f} m/s through a {'real root: no oscillation' if abs(root.imag) < 1e-6 else 'pair'}; "
        "at sea level at "
        f"{f.lost[0.0]:.3f} (the thesis prints 66, which constant dynamic pressure does not give: open)",
    )


def _reversal_speed(a: Aeroelastic) -> Claim:
    high, low = a.simulation[HIGH][2] or np.nan, a.simulation[0.0][2] or np.nan
    return Claim(
        section="9.4.6, Tables 2-3",
        statement="control reversal of the simulation model lies near 54 m/s at 10,000 ft, 51 at sea level",
        verdict=verdict(whole=abs(high - 53.5) < 1.0 and abs(low - 51.0) < 1.0, part=abs(high - 53.5) < 1.0),
        numbers=f"lift per elevon angle reverses at {high:.2f} m/s at 10,000 ft (one derivative is calibrated to it) "
        f"and {low:.2f} at "
        "sea level",
    )


def _reversal_ends_lqr(f: Flight, a: Aeroelastic) -> Claim:
    reversal = a.simulation[HIGH][2] or np.nan
    beyond = f.V > reversal
    designed = f.growth["designed here"][beyond]
    return Claim(
        section="9.4.6",
        statement="reversal ends the LQR: controls then amplify flutter",
        verdict=verdict(whole=f.lost[HIGH] <= reversal, part=bool(np.any(designed > 0.0))),
        numbers=f"the gain of {DESIGN_SPEED:g} m/s holds {f.lost[HIGH] - reversal:.2f} m/s past reversal; LQR gains "
        "designed beyond it "
        f"stabilise at all {np.count_nonzero(beyond)} speeds to {f.V[-1]:g} m/s (slowest root {designed.max():.2f} "
        "1/s)",
    )


def _reversed_outputs(f: Flight) -> Claim:
    i = [_at(f, V) for V in (60.0, 80.0, 98.5, 120.0)]
    flipped = [f.growth[name][i] for name in ("that gain reversed", "designed here, reversed")]
    changed, crossing = sign_changes(f.V, f.gains)
    where = ", ".join(f"{name} at {V:.1f} m/s" for name, V in crossing.items())
    return Claim(
        section="9.4.6, 9.4.7",
        statement="past reversal the controller's outputs must be reversed",
        verdict=verdict(whole=bool(np.max(flipped) < 0.0), part=any(changed)),
        numbers=f"every sign flipped, the loop grows by {np.min(flipped):.0f} 1/s or more at 60 to 120 m/s; "
        f"{4 - sum(changed)} of the 4 "
        f"optimal gains keep their sign, others pass smoothly through zero ({where}), and a zero of plunge "
        "crosses over: slow lift and altitude loops change sign, the flutter loop does not",
    )


def _adaptive(f: Flight) -> Claim:
    switch = f.climbs["switch"]
    reach = sum(V >= 120.0 for V in switch.reached)
    others = "; ".join(
        f"{name} {sum(V >= 120.0 for V in run.reached)} of {len(run.reached)}, lowest {min(run.reached):.1f}"
        for name, run in f.climbs.items()
        if name in ("schedule", "gyro", "adaptive")
    )
    return Claim(
        section="9.4.8, Fig. 39",
        statement="with the adapted controller the wing flies beyond 120 m/s",
        verdict=verdict(whole=reach == len(switch.reached), part=2 * reach > len(switch.reached)),
        numbers=f"a switch at {SWITCH_SPEED:g} m/s reaches 120 in {reach} of {len(switch.reached)} climbs, lowest "
        f"{min(switch.reached):.1f}; with servo and delay: {others}; linear, incompressible theory (Mach 0.3 is "
        f"{f.speed['manual']:.1f} m/s)",
    )


def _switch(f: Flight) -> Claim:
    run = f.runs["sine"]
    return Claim(
        section="10.3",
        statement="switching at 50 m/s is stable when airspeed fluctuates around it",
        verdict=verdict(whole=run.bounded, part=False),
        numbers=f"airspeed 47 to 53 m/s, five seconds a cycle, in turbulence for 30 s: pitch stays within "
        f"{np.degrees(peak(run, 'pitch_rad')):.1f} degrees, plunge within {100 * peak(run, 'plunge_m'):.0f} cm",
    )


def _poles(f: Flight) -> Claim:
    return Claim(
        section="9.4.9, Fig. 40",
        statement="at Mach 0.15 with LQR all poles are stable",
        verdict=verdict(whole=bool(f.poles.real.max() < 0.0)),
        numbers=f"slowest pole {f.poles.real.max():.2f} 1/s at {f.speed['poles']:.2f} m/s",
    )


def _static_effects(f: Flight, a: Aeroelastic) -> Claim:
    _, V_D, V_R = a.simulation[HIGH]
    analytic = a.study.run("binary", HIGH, "quasi_steady_damped").static
    lower = [(V_R or np.inf) < (analytic.reversal.V or 0.0), (V_D or np.inf) < (analytic.divergence.V or 0.0)]
    return Claim(
        section="9.5, 10.2",
        statement="static effects come at lower speeds in the simulation model than in the analytic ones",
        verdict=verdict(whole=all(lower), part=any(lower)),
        numbers=f"reversal {V_R or np.nan:.1f} against {analytic.reversal.V or np.nan:.1f} m/s; divergence of the "
        f"plant {V_D or np.nan:.1f} "
        f"against {analytic.divergence.V or np.nan:.1f}: the thesis' 59 is the loss of its gain, not divergence of "
        "the wing",
    )


def _gain_of_lqr(f: Flight, a: Aeroelastic) -> Claim:
    open_loop = {h: a.simulation[h][0] or np.nan for h in (HIGH, 0.0)}
    same = {h: f.lost[h] - open_loop[h] for h in open_loop}
    printed = {h: [r.printed for r in a.study.rows if r.altitude == h and r.quantity == "flutter"] for h in open_loop}
    columns = [f.lost[HIGH] - a.flutter(m, HIGH) for m in MODELS]
    largest = {HIGH: 59 - min(printed[HIGH]), 0.0: 66 - min(printed[0.0])}
    last = f.check.speeds[f.check.decay > 0.0].max() - open_loop[HIGH]
    return Claim(
        section="9.5",
        statement="an LQR raises the flutter speed by at most 13 m/s",
        verdict=verdict(
            whole=max(*same.values(), *largest.values()) < 13.5 and last < 13.5, part=abs(same[HIGH] - 13.0) < 1.0
        ),
        numbers=f"the same plant with and without that gain: {same[HIGH]:+.1f} m/s at 10,000 ft, {same[0.0]:+.1f} at "
        "sea level; the "
        f"thesis' {largest[HIGH]} compares two models (59 and {min(printed[HIGH])}), and its Table 2 has "
        f"{largest[0.0]} (66 and "
        f"{min(printed[0.0])}); against our quasi-steady columns {columns[0]:+.1f} and {columns[1]:+.1f}. Gains "
        "designed at every speed "
        f"hold {last:.0f} m/s and more above the open loop",
    )


def _twice(f: Flight) -> Claim:
    ratio = float(np.median(f.climbs["switch"].reached)) / f.lost[HIGH]
    return Claim(
        section="9.5",
        statement="the adapted controller reaches up to twice the speed of the LQR",
        verdict=verdict(whole=1.9 < ratio, part=ratio > 1.5),
        numbers=f"median of the climbs over {f.lost[HIGH]:.1f} m/s: {ratio:.2f}",
    )


def _safe_speed(f: Flight) -> Claim:
    reached = np.array(f.climbs["lqr level"].reached)
    return Claim(
        section="10.2",
        statement="with LQR not faster than 59 m/s at 10,000 ft, for safety never above 56",
        verdict=verdict(whole=bool(reached.min() > 56.0), part=bool(np.median(reached) > 55.0)),
        numbers=f"in gusts and turbulence lost between {reached.min():.1f} and {reached.max():.1f} m/s, "
        f"{int(np.sum(reached < 56.0))} of {len(reached)} below 56",
    )


def _mach(f: Flight) -> Claim:
    limit = 0.3 * float(FlightCondition.at(HIGH, V=1.0).a_sound or np.nan)
    return Claim(
        section="10.2",
        statement="Mach 0.3, the end of incompressible theory, is 98.5 m/s at 10,000 ft",
        verdict=verdict(whole=abs(limit - 98.5) < 0.05),
        numbers=f"{limit:.2f} m/s",
    )


def _unstable_without(f: Flight, a: Aeroelastic) -> Claim:
    stable = f.V[f.growth["open"] < 0.0]
    return Claim(
        section="9.5, 10.2",
        statement="without any controller the simulation model is completely unstable",
        verdict=verdict(whole=stable.size == 0, part=stable.size < 0.1 * f.V.size),
        numbers=f"with our inputs it is stable up to {a.simulation[HIGH][0] or np.nan:.2f} m/s at 10,000 ft: springs "
        "hold it",
    )


def _suppressed(f: Flight) -> Claim:
    stable = f.check.stable
    return Claim(
        section="11",
        statement="flutter can be suppressed by feedback beyond the open-loop boundary",
        verdict=verdict(whole=stable, part=f.lost[HIGH] > 46.0),
        numbers=f"with servo, sampling and delay: {f.check.sentence()}",
    )
