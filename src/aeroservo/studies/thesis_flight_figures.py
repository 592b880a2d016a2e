"""Figures 33 to 40 of the thesis beside ours."""

from __future__ import annotations

import numpy as np

from aeroservo.simulate.engine import Simulation
from aeroservo.studies.thesis_flight import GUST, TURBULENCE, Climbed, Flight
from aeroservo.studies.thesis_gains import (
    BELOW,
    DESIGN_SPEED,
    GAINS,
    HIGH,
    PITCH_LIMIT,
    PLUNGE_LIMIT,
    SWITCH_SPEED,
    sign_changes,
)
from aeroservo.studies.thesis_records import Compared, Curve, Entry, Plot

CHANNELS = (
    ("plunge_m", "plunge (down), cm", 100.0),
    ("pitch_rad", "pitch (nose up), deg", 180.0 / np.pi),
    ("elevon_rad", "elevon (trailing edge down), deg", 180.0 / np.pi),
)
MOST = 1200
"""Points of a curve of time."""
WORDS = {"plunge_m": "to plunge", "pitch_rad": "to pitch", "pitch_rate_rad_s": "to pitch rate"}
INPUTS = "The thesis prints no inputs of its simulation: ours are pinned (preset thesis-simulation)."
ACTUATOR = (
    "The thesis' loop has no actuator, no sampling and no delay. With a servo of 60 rad/s, 200 Hz and one sample of "
    "delay "
    "inside, gains designed at every speed stand beside it."
)


def flight_entries(f: Flight) -> tuple[Entry, ...]:
    """The figures of chapter 9.4.

    Parameters
    ----------
    f : Flight
        Of `thesis_flight`.

    Returns
    -------
    entries : tuple of Entry
        In the thesis' order.
    """
    return (
        _figure_33(f),
        _figure_34(f),
        _figure_35(f),
        _figure_36(f),
        _figure_37(f),
        _figure_38(f),
        _figure_39(f),
        _figure_40(f),
    )


def history_plots(runs: dict[str, Simulation], *, flight: bool = False) -> tuple[Plot, ...]:
    """Plunge, pitch and elevon of runs over time, and where they went.

    Parameters
    ----------
    runs : dict of str to Simulation
        By the name of their curves.
    flight : bool
        Whether airspeed and altitude are shown as well.

    Returns
    -------
    plots : tuple of Plot
        One for each quantity.
    """
    shown = (*CHANNELS, ("speed_m_s", "airspeed, m/s", 1.0), ("altitude_m", "altitude, m", 1.0))
    plots = []
    for channel, label, factor in shown if flight else CHANNELS:
        curves = []
        for name, run in runs.items():
            history = run.history
            if history is None or channel not in history.channels:
                continue
            every = max(1, len(history.t) // MOST)
            curves.append(Curve(name=name, x=history.t[::every], y=factor * history[channel][::every]))
        plots.append(Plot(title=label.split(",")[0], x_label="time, s", y_label=label, curves=tuple(curves)))
    return tuple(plots)


def peak(run: Simulation, channel: str) -> float:
    """Largest magnitude of a channel.

    Parameters
    ----------
    run : Simulation
        The run.
    channel : str
        Which.

    Returns
    -------
    peak : float
        Over the run. [unit of the channel]
    """
    return float(run.peak[run.channels.index(channel)])


def _degrees(run: Simulation, channel: str) -> float:
    return float(np.degrees(peak(run, channel)))


def _figure_33(f: Flight) -> Entry:
    run = f.runs["free"]
    i = int(np.argmin(np.abs(f.V - f.speed["lqr"])))
    return Entry(
        number="Fig. 33",
        title="Simulation without control",
        thesis="Oscillation of growing amplitude, as in Fig. 31; pitch ends at 180 degrees.",
        finding=f"At {f.speed['lqr']:.2f} m/s, {HIGH:g} m, from 0.01 rad of pitch: it grows by "
        f"{f.growth['open'][i]:.2f} 1/s "
        + (f"and passes 180 degrees of pitch after {run.duration:.2f} s." if run.limit_left is not None else "slowly."),
        compared=(
            Compared(what="pitch at the end", unit="deg", thesis=180.0, ours=_degrees(run, "pitch_rad"),
                     reason="the run stops there: linear forces mean nothing beyond"),
        ),
        plots=history_plots({"without control": run})[:2],
        unsound=INPUTS
        + " Ours swings with the flutter mode. The thesis calls its response comparable to Fig. 31, which swings once "
        " in three seconds: that is the pitch-lag loop of its linear model, not flutter.",
    )  # fmt: skip


def _figure_34(f: Flight) -> Entry:
    cosine, sharp, sound, servo = (f.runs[name] for name in ("cosine", "sharp", "schedule", "servo"))
    decay = -(cosine.growth or np.nan)
    return Entry(
        number="Fig. 34",
        title="LQR at Mach 0.172 in a gust of 5 m/s",
        thesis="It settles in about the time of Fig. 32.",
        finding=f"1-cosine gust of 25 chords: settles with {decay:.2f} 1/s (4 over it: {4 / decay:.1f} s), but the "
        "gain asks "
        f"{_degrees(cosine, 'elevon_rad'):.0f} degrees of elevon and lets the wing pitch by "
        f"{_degrees(cosine, 'pitch_rad'):.1f}; a "
        f"sharp edge asks {_degrees(sharp, 'elevon_rad'):.0f}. The schedule with its servo inside meets the same "
        "gust with "
        f"{_degrees(sound, 'elevon_rad'):.1f} degrees of elevon and {_degrees(sound, 'pitch_rad'):.1f} of pitch.",
        compared=(
            Compared(what="settling time", unit="s", thesis=6.0, ours=4.0 / decay, reason="another plant: " + INPUTS),
        ),
        plots=history_plots(
            {"LQR, 1-cosine": cosine, "LQR, sharp edge": sharp, "schedule with servo, 1-cosine": sound}
        ),
        unsound=ACTUATOR
        + f" With that servo the thesis' gain is unstable at its own design point ({f.servo_root.real:+.1f} ± "
        f"{abs(f.servo_root.imag):.1f}i): pitch passes {_degrees(servo, 'pitch_rad'):.0f} degrees after "
        f"{servo.duration:.1f} s.",
    )


def _figure_35(f: Flight) -> Entry:
    rows = []
    lqr, sound = f.peaks["lqr"], f.peaks["schedule"]
    for j, (what, thesis) in enumerate((("plunge up", 0.04), ("plunge down", 0.08))):
        rows.append(
            Compared(
                what=f"largest {what}, mean of {len(lqr)} seeds", unit="m", thesis=thesis, ours=float(lqr[:, j].mean()),
                reason=f"the thesis names no intensity; ours {TURBULENCE:g} m/s RMS",
            )
        )  # fmt: skip
    rows.append(
        Compared(
            what="largest pitch, mean of the seeds", unit="deg", thesis="a few",
            ours=float(np.degrees(lqr[:, 2].mean())), reason="close to where the gain is lost",
        )
    )  # fmt: skip
    return Entry(
        number="Fig. 35",
        title="LQR at Mach 0.172 in turbulence",
        thesis="It begins to struggle, but plunge stays within 4 cm up and 8 cm down, pitch within a few degrees.",
        finding=f"Dryden, {TURBULENCE:g} m/s RMS: plunge to {100 * lqr[:, :2].max():.0f} cm, pitch to "
        f"{np.degrees(lqr[:, 2].max()):.0f} degrees with the LQR; {100 * sound[:, :2].max():.0f} cm and "
        f"{np.degrees(sound[:, 2].max()):.1f} degrees with the schedule and its servo. Plunge follows lift slowly on "
        "its "
        "spring; it is the pitch that tells the two apart.",
        compared=tuple(rows),
        plots=history_plots({"LQR": f.runs["turbulence, lqr"], "schedule with servo": f.runs["turbulence, schedule"]}),
        unsound=ACTUATOR,
    )


def _climb_rows(climbs: dict[str, Climbed], thesis: dict[str, tuple[float, str]]) -> tuple[Compared, ...]:
    rows = []
    for name, (value, reason) in thesis.items():
        reached = np.array(climbs[name].reached)
        rows.append(
            Compared(
                what=f"{name}: speed reached, median of {len(reached)} seeds ({reached.min():.1f} to "
                f"{reached.max():.1f})",
                unit="m/s", thesis=value, ours=float(np.median(reached)), reason=reason,
            )
        )  # fmt: skip
    return tuple(rows)


def _figure_36(f: Flight) -> Entry:
    level, both = f.climbs["lqr level"], f.climbs["lqr"]
    lost = f"|theta| > {np.degrees(PITCH_LIMIT):.0f} degrees or |h| > {PLUNGE_LIMIT:g} m"
    return Entry(
        number="Fig. 36",
        title="Climb and acceleration with LQR, gusts and turbulence",
        thesis="Stable until 59 m/s at 10,000 ft, then flutter of growing amplitude; for safety not above 56 m/s.",
        finding=f"One gain for 55 m/s, Dryden {TURBULENCE:g} m/s RMS, a gust of {GUST:g} m/s every 10 s; lost means "
        f"{lost}. "
        f"Accelerating at 10,000 ft it is lost between {min(level.reached):.1f} and {max(level.reached):.1f} m/s; "
        "climbing from "
        f"sea level, where pressures are higher, between {min(both.reached):.1f} and {max(both.reached):.1f}. In "
        "still air it "
        f"is lost at {f.lost[HIGH]:.3f} m/s through a real root.",
        compared=(
            *_climb_rows(
                f.climbs,
                {
                    "lqr level": (59.0, "the weather ends it before the root does"),
                    "lqr": (59.0, "both ramps over the whole climb: the thesis' 59 is at 10,000 ft"),
                },
            ),
            Compared(what="still air, 10,000 ft", unit="m/s", thesis=59.0, ours=f.lost[HIGH], reason="real root"),
        ),
        plots=history_plots({"level, 10,000 ft": level.first, "climb": both.first}, flight=True),
        unsound=ACTUATOR,
    )


def _figure_37(f: Flight) -> Entry:
    lift, V = f.effect["lift"], f.V
    top, zero = float(V[int(np.argmax(lift))]), _zero(V, lift)
    other = _zero(V, f.effect["lift with the lattice's CM_delta"])
    return Entry(
        number="Fig. 37",
        title="Control effectiveness",
        thesis="'Moment per elevon angle' grows to a maximum at 46 m/s, is gone at 54 m/s and reversed beyond.",
        finding="The quantity that reverses is LIFT per elevon angle, with the pitch that the spring allows: "
        f"largest at {top:.1f}, "
        f"zero at {zero:.2f} m/s. The moment about the pitch axis never reverses in this model.",
        compared=(
            Compared(what="reversal", unit="m/s", thesis=54.0, ours=zero,
                     reason="Table 3 has 53; CM_delta calibrated to that"),
            Compared(what="largest effectiveness", unit="m/s", thesis=46.0, ours=top,
                     reason="q (1 - q/q_R) peaks near q_R/2; a peak at 46 fits no linear quantity of this model: open"),
            Compared(what="reversal with the lattice's CM_delta", unit="m/s", thesis=54.0, ours=other,
                     reason="-0.297 about this axis instead of -0.117"),
        ),
        plots=(
            Plot(
                title="Lift per elevon angle", x_label="true airspeed, m/s", y_label="N per degree",
                curves=tuple(
                    Curve(name=name, x=V, y=np.radians(f.effect[name]))
                    for name in ("lift", "rigid lift", "lift with the lattice's CM_delta")
                ),
                marks=((zero, "reversal"),), y_range=(-30.0, 30.0),
            ),
            Plot(
                title="Moment about the pitch axis per elevon angle", x_label="true airspeed, m/s",
                y_label="N m per degree", curves=(Curve(name="moment", x=V, y=np.radians(f.effect["moment"])),),
                y_range=(-20.0, 5.0),
            ),
        ),
    )  # fmt: skip


def _zero(V: np.ndarray, y: np.ndarray) -> float:
    """Where a curve first changes its sign."""
    i = int(np.argmax(y < 0.0))
    return float(np.interp(0.0, y[[i, i - 1]], V[[i, i - 1]])) if i else float("nan")


def _figure_38(f: Flight) -> Entry:
    run = f.runs["manual"]
    here = {V: f.gains[int(np.argmin(np.abs(f.V - V)))] for V in (DESIGN_SPEED, f.speed["manual"])}
    slow, fast = here.values()
    changed, crossing = sign_changes(f.V, f.gains)
    kept = [name for name, moved in zip(GAINS, changed) if not moved]
    through = "; ".join(f"that of {name} passes smoothly through zero at {V:.1f} m/s" for name, V in crossing.items())
    i = int(np.argmin(np.abs(f.V - f.speed["manual"])))
    return Entry(
        number="Fig. 38",
        title="A controller tuned by hand at Mach 0.3",
        thesis="Hand-tuned gains hold the wing at Mach 0.3 in a gust and turbulence; the elevon's output has changed "
        "sign.",
        finding=f"The schedule holds it at {f.speed['manual']:.1f} m/s with at most "
        f"{_degrees(run, 'elevon_rad'):.1f} degrees of elevon "
        f"and {_degrees(run, 'pitch_rad'):.1f} of pitch. Of the four gains of Q = I, R = 1, those of "
        f"{', '.join(kept)} keep their "
        f"sign from {BELOW:g} m/s on; {through}. All signs reversed, the loop grows by "
        f"{f.growth['designed here, reversed'][i]:.0f} 1/s.",
        compared=(
            Compared(
                what="gains at 55 m/s: h, theta, h', theta'", unit="", thesis=None,
                ours=", ".join(f"{k:.3f}" for k in slow), reason="Q = I, R = 1",
            ),
            Compared(
                what=f"gains at {f.speed['manual']:.1f} m/s", unit="", thesis="not printed",
                ours=", ".join(f"{k:.3f}" for k in fast), reason="Q = I, R = 1",
            ),
        ),
        plots=(
            *history_plots({"schedule, Mach 0.3": run}),
            Plot(
                title="LQR gains against the speed of their design", x_label="true airspeed, m/s", y_label="gain",
                curves=tuple(
                    Curve(name=f"{name}{scale}", x=f.V, y=f.gains[:, j] * factor)
                    for j, (name, scale, factor) in enumerate(
                        zip(GAINS, ("", " / 10", " x 10", " x 10"), (1.0, 0.1, 10.0, 10.0))
                    )
                ),
                marks=((_zero(f.V, f.effect["lift"]), "lift reversal"),),
            ),
        ),
        unsound="What reverses at 53 m/s is the static gain to lift and plunge: slow loops on lift and altitude, and "
        "integrators, "
        "must change sign there. A sign flip of every gain is a defect.",
    )  # fmt: skip


def _figure_39(f: Flight) -> Entry:
    words = {
        "switch": "the thesis' idea, our own second gain, without servo",
        "schedule": "gains at 60 points, the whole state measured",
        "gyro": "the same points, a gyro and nothing else measured",
        "adaptive": "the schedule, the elevon's effect identified in flight",
    }
    said = []
    for name, what in words.items():
        c = f.climbs[name]
        lost = sum(x is not None for x in c.lost)
        said.append(f"{name} ({what}): {lost} of {len(c.lost)} lost, the slowest at {min(c.reached):.1f} m/s")
    return Entry(
        number="Fig. 39",
        title="Climb and acceleration with the adaptive controller",
        thesis="LQR to about 50 m/s, then a hand-tuned gain: reaches 120 m/s before flutter and divergence.",
        finding="; ".join(said) + f". Frozen loops of the schedule: {f.check.sentence()}.",
        compared=_climb_rows(
            f.climbs,
            {
                name: (120.0, "the thesis: above 120, lost by 124" if name == "switch" else "servo, 200 Hz, one delay")
                for name in words
            },
        ),
        plots=history_plots({name: f.climbs[name].first for name in ("switch", "schedule", "adaptive")}, flight=True),
        unsound="A switch between two gains is no adaptation: nothing is identified in flight. Incompressible theory "
        f"ends at Mach 0.3 ({f.speed['manual']:.1f} m/s), small angles at a few degrees; feedback holds the static "
        "divergence at 124 m/s in a linear model, but full elevon does not hold a finite gust there.",
    )


def _figure_40(f: Flight) -> Entry:
    curves = [Curve(name="poles, closed loop", x=f.poles.real, y=f.poles.imag, points=True)]
    curves += [Curve(name=f"zeros to {name}", x=z.real, y=z.imag, points=True) for name, z in f.zeros.items()]
    plunge = next(z for z in f.zero_curves if "plunge" in z.sensor)
    moving = tuple(
        Curve(name=WORDS.get(z.sensor, z.sensor), x=z.V, y=np.nanmax(z.zeros.real, axis=1)) for z in f.zero_curves
    )
    words = ", ".join(f"{V:.2f} m/s" for V in plunge.crossings) or "no speed"
    return Entry(
        number="Fig. 40",
        title="Poles and zeros at Mach 0.15 with LQR",
        thesis="All poles lie in the stable region.",
        finding=f"At {f.speed['poles']:.2f} m/s all four do, the slowest at {f.poles.real.max():.2f} and the fastest "
        "at "
        f"{f.poles.real.min():.1f} 1/s. What "
        "reversal changes are zeros: "
        f"one of plunge crosses into the right half plane at {words}; those of pitch and of pitch rate stay on the "
        "left "
        "(pitch rate has one at zero).",
        compared=(
            Compared(
                what="largest real part of the poles", unit="1/s", thesis="negative", ours=float(f.poles.real.max())
            ),
        ),
        plots=(
            Plot(
                title="Poles and zeros", x_label="Re, 1/s (positive: unstable)",
                x_range=(-25.0, 5.0), y_label="Im, rad/s",
                curves=tuple(curves), marks=((0.0, "border of stability"),),
            ),
            Plot(
                title="Rightmost zero against speed", x_label="true airspeed, m/s", y_label="Re, 1/s", curves=moving,
                y_range=(-20.0, 60.0), marks=((SWITCH_SPEED, "the thesis' switch"),),
            ),
        ),
    )  # fmt: skip
