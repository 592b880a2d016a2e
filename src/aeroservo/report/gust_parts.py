"""Parts on gusts and turbulence, and on the envelope over speed and altitude."""

from __future__ import annotations

import numpy as np

from aeroservo.datatypes import FlightCondition
from aeroservo.gust.design_gusts import cs25_gradients
from aeroservo.gust.intensity import constant_turbulence
from aeroservo.report.blocks import Block, Chart, Failed, Part, Prose, Series, Table
from aeroservo.report.case_marks import words
from aeroservo.studies.aircraft_report import MACH_LIMIT, ReportCase
from aeroservo.studies.envelope import envelope
from aeroservo.studies.gust_loads import GustLoads, design_velocity, gust_loads
from aeroservo.studies.gust_plant import gust_plant
from aeroservo.studies.root_loads import with_loads
from aeroservo.studies.turbulence_spectra import response_spectra

#: Altitudes of the envelope. [m]
ALTITUDES = (0.0, 1500.0, 3000.0, 4500.0, 6000.0, 8000.0)
#: Speeds of the search at each altitude: boundaries do not depend on them.
SPEEDS = 41
#: Channels drawn in one chart.
MOST_CHANNELS = 6


def gust_part(case: ReportCase) -> Part:
    """Peaks in design gusts and RMS in turbulence at the reference speed.

    Parameters
    ----------
    case : ReportCase
        The model.

    Returns
    -------
    part : Part
        Charts and a table; nothing but the reason where the model is unstable.
    """
    model, rows = with_loads(case.file, case.options.aero)
    V = case.speed
    condition = FlightCondition(V=np.asarray(V), rho=np.asarray(case.rho), a_sound=np.asarray(case.a_sound))
    plant = gust_plant(model, condition, loads=rows)
    gradients = cs25_gradients(10)
    velocity = design_velocity("cs25", altitude=case.options.altitude, density=case.rho)
    state = constant_turbulence(1.0)
    found = gust_loads(plant, gradients=gradients, velocity=velocity, turbulence=state)
    blocks: list[Block] = [
        Prose(
            text=f"At {V:.4g} m/s, loop open: 1-cosine gusts of CS-25.341(a), whose velocity grows with their gradient "
            "H (half their length), and Dryden turbulence of 1 m/s RMS, L = 533.4 m."
        ),
        *(Prose(text=note, kind="note") for note in found.notes),
    ]
    if not found.stable:
        why = f"the model is unstable at {V:.4g} m/s: it has no steady response to turbulence"
        return Part(title="Gusts and turbulence", anchor="gusts", blocks=(*blocks, Failed(why=why)))
    blocks += _peaks(found)
    blocks.append(_critical(found))
    blocks += _spectra(found, *response_spectra(plant, state))
    return Part(title="Gusts and turbulence", anchor="gusts", blocks=tuple(blocks))


def _peaks(found: GustLoads) -> list[Block]:
    """Largest magnitudes against gradient, a chart for each unit."""
    out: list[Block] = []
    for unit, columns in _by_unit(found.channels, found.peak).items():
        series = tuple(
            Series(name=_plain(found.channels[k]), x=found.gradient, y=found.peak[:, k])
            for k in columns[:MOST_CHANNELS]
        )
        out.append(
            Chart(
                series=series,
                x_label="gust gradient H, m",
                y_label=f"largest magnitude, {unit}",
                title=f"Peaks in design gusts, {unit}",
                caption="The critical gradient is where a curve is highest; a maximum at an end is not one.",
            )
        )
    return out


def _critical(found: GustLoads) -> Table:
    """Worst gradient and RMS of every channel."""
    critical, rows = found.critical, []
    for k, name in enumerate(found.channels):
        worst = None if critical is None else float(critical.gradient[k])
        peak = None if critical is None else float(critical.peak[k])
        end = "at an end" if critical is not None and bool(critical.at_limit[k]) else ""
        rows.append((name, worst, end, peak, float(found.rms[k]), float(found.rms_by_frequency[k])))
    return Table(
        columns=("channel", "critical H, m", "", "peak there", "RMS per m/s", "RMS per m/s, by frequency"),
        rows=tuple(rows),
        title="Critical gusts and turbulence",
        caption="RMS computed twice: from Lyapunov's equation, and by integrating the spectrum of the response.",
    )


def _spectra(found: GustLoads, frequency: np.ndarray, density: np.ndarray) -> list[Block]:
    """Spectral densities of the response, a chart for each unit."""
    out: list[Block] = []
    for unit, columns in _by_unit(found.channels, found.peak).items():
        series = tuple(
            Series(name=_plain(found.channels[k]), x=frequency, y=np.where(density[:, k] > 0, density[:, k], np.nan))
            for k in columns[:MOST_CHANNELS]
        )
        out.append(
            Chart(
                series=series,
                x_label="frequency, Hz",
                y_label=f"spectral density, ({unit})²/Hz",
                x_log=True,
                y_log=True,
                title=f"Response to turbulence, {unit}",
                caption="Peaks are the modes; the sharper, the less they are damped.",
                hover="point",
            )
        )
    return out


#: Units at the end of a channel's name, the longer ones first.
UNITS = {
    "m_s2": "m/s²",
    "m_s": "m/s",
    "rad_s": "rad/s",
    "N_per_m": "N/m",
    "N_m": "N m",
    "rad": "rad",
    "m": "m",
    "N": "N",
}


def _unit(channel: str) -> str:
    return next((u for u in UNITS if channel.endswith("_" + u)), "")


def _by_unit(channels: tuple[str, ...], peak: np.ndarray) -> dict[str, list[int]]:
    """Channels that move, by unit; rates and the gust itself are left to the table, modal coordinates too."""
    out: dict[str, list[int]] = {}
    for k, name in enumerate(channels):
        unit = _unit(name)
        if unit and "rate" not in name and not name.startswith("gust") and np.any(peak[:, k] > 0.0):
            out.setdefault(UNITS[unit], []).append(k)
    return out


def _plain(channel: str) -> str:
    return channel.removesuffix("_" + _unit(channel)).replace("_", " ")


def envelope_part(case: ReportCase) -> Part:
    """Boundaries over altitude.

    Parameters
    ----------
    case : ReportCase
        The model.

    Returns
    -------
    part : Part
        A chart and a table.
    """
    V = case.sweep.V
    controller = case.options.controller
    points = envelope(
        case.file,
        ALTITUDES,
        np.linspace(V[0], V[-1], SPEEDS).tolist(),
        method=case.method,
        controller=controller,
        aero=case.options.aero,
    )
    altitude = np.array([p.altitude for p in points])
    flutter = _first([[i.start for i in p.open_loop if i.kind == "flutter"] for p in points])
    curves = [("flutter, loop open", flutter), ("divergence", _values([p.divergence for p in points]))]
    quantity = points[0].reversal_quantity
    curves.append((f"reversal of {quantity}", _values([p.reversal for p in points])))
    if controller is not None:
        curves.append(("instability, loop closed", _first([[i.start for i in p.closed_loop or ()] for p in points])))
        curves.append(("margin asked for", _values([p.margin_speed for p in points])))
    sound = FlightCondition.at(altitude, V=np.ones(len(altitude))).a_sound
    curves.append(("Mach 0.3", MACH_LIMIT * sound))
    series = tuple(Series(name=name, x=x, y=altitude, kind="line") for name, x in curves if np.any(np.isfinite(x)))
    rows = tuple(
        (p.altitude, p.density, *(None if not np.isfinite(x[k]) else float(x[k]) for _, x in curves))
        for k, p in enumerate(points)
    )
    why = dict.fromkeys(
        f"{v.side} {words(v.speed, 'm/s')} at {p.altitude:g} m: {v.why}"
        for p in points[:1]
        for v in p.validity
        if V[0] < v.speed < V[-1]
    )
    blocks: list[Block] = [
        Chart(
            series=series, x_label="true airspeed V, m/s", y_label="altitude, m", title="Envelope",
            caption="Fly to the left of every curve. True airspeeds grow with altitude as the air thins.",
            hover="point",
            x_range=(0.0, float(min(V[-1], np.nanmax([np.nanmax(s.x) for s in series]) * 1.1))),
        ),
        Table(
            columns=("altitude, m", "density, kg/m³", *(f"{name}, m/s" for name, _ in curves)),
            rows=rows,
            title="Boundaries",
            caption="True airspeeds; a dash: none in the sweep.",
        ),
        *(Prose(text=f"Not to be trusted {text}", kind="note") for text in why),
    ]  # fmt: skip
    return Part(title="Envelope", anchor="envelope", blocks=tuple(blocks))


def _values(values: list[float | None]) -> np.ndarray:
    return np.array([np.nan if v is None else v for v in values], dtype=float)


def _first(starts: list[list[float | None]]) -> np.ndarray:
    return _values([min((s for s in row if s is not None), default=None) for row in starts])
