"""Figures of gusts and turbulence: peaks against gradient, spectra of the response, spectra of turbulence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from aeroservo.report.history import history_figure
from aeroservo.report.style import UNSTABLE, literal, new_figure, nothing_to_show, shared_legend, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from aeroservo.datatypes import Array
    from aeroservo.simulate.history import TimeHistory
    from aeroservo.simulate.scenario import Scenario
    from aeroservo.studies.gust_loads import GustLoads
    from aeroservo.studies.turbulence_spectra import TurbulenceSpectra

#: Channels drawn first, as far as they are there: loads, then motion.
FIRST = (
    "root_bending_N_m", "root_torque_N_m", "root_shear_N", "plunge_spring_N", "pitch_spring_N_m",
    "plunge_spring_N_per_m", "pitch_spring_N", "tip_plunge_m", "plunge_m", "tip_twist_rad", "pitch_rad",
    "tip_acceleration_m_s2", "acceleration_m_s2", "elevon_rad",
)  # fmt: skip
MOST = 5
"""Channels in one panel."""

FLUTTER_BAND = (1.0, 30.0)
"""Where flutter of small and large wings lives: shaded in spectra. [Hz]"""


def shown_channels(channels: Sequence[str], size: Array) -> list[int]:
    """The channels that a figure shows: loads first, then motion, then whatever else moves.

    Parameters
    ----------
    channels : sequence of str
        Names.
    size : ndarray, shape (n_channels,)
        Peak of each: what does not move is not drawn. [unit of each]

    Returns
    -------
    index : list of int
        At most `MOST`. [-]
    """
    moving = [i for i in range(len(channels)) if np.isfinite(size[i]) and size[i] > 0.0]
    order = {name: i for i, name in enumerate(FIRST)}
    wanted = sorted((i for i in moving if channels[i] in order), key=lambda i: order[channels[i]])
    rest = [i for i in moving if i not in wanted and "_rate" not in channels[i] and not channels[i].startswith("gust")]
    return (wanted + rest)[:MOST]


def plot_peaks(loads: GustLoads, ax: Axes) -> None:
    """Peak of the main channels against gust gradient, each as part of its largest value.

    Parameters
    ----------
    loads : GustLoads
        Of `gust_loads`.
    ax : matplotlib Axes
        Drawn into; dots are the gradients asked for, crosses the worst ones.
    """
    if not loads.stable:
        nothing_to_show(ax, "unstable at this speed:\nthere are no peaks")
        return
    found = loads.critical
    largest = loads.peak.max(axis=0) if found is None else np.maximum(found.peak, loads.peak.max(axis=0))
    for j, i in enumerate(shown_channels(loads.channels, largest)):
        look, scale = style(j), largest[i]
        if found is not None:
            ax.plot(found.gradients, found.peaks[:, i] / scale, label=literal(loads.channels[i]), **look)
            if not found.at_limit[i]:
                ax.plot(found.gradient[i], found.peak[i] / scale, "x", color=look["color"], markersize=8, zorder=5)
        name = literal(loads.channels[i]) if found is None else None
        ax.plot(loads.gradient, loads.peak[:, i] / scale, "o", color=look["color"], markersize=3.5, label=name)
    ax.set_xlabel("gust gradient H, m (half the length)")
    ax.set_ylabel("peak, part of the largest")
    ax.set_ylim(0.0, 1.08)


def plot_response_spectra(
    frequency: Array, density: Array, channels: Sequence[str], ax: Axes, *, rms: Array | None = None
) -> None:
    """Where in frequency the RMS of each channel comes from: f S(f) over its integral, on a logarithmic axis.

    Parameters
    ----------
    frequency : ndarray, shape (n_f,)
        Ascending, positive. [Hz]
    density : ndarray, shape (n_f, n_channels)
        Spectral density of each channel. [unit^2/Hz]
    channels : sequence of str
        Their names.
    ax : matplotlib Axes
        Drawn into: equal areas under a curve are equal parts of the variance.
    rms : ndarray, shape (n_channels,), optional
        Which channels move. [unit of each]
    """
    size = np.sqrt(np.trapezoid(density, frequency, axis=0)) if rms is None else np.asarray(rms)
    for j, i in enumerate(shown_channels(channels, size)):
        share = frequency * density[:, i] / np.trapezoid(density[:, i], frequency)
        ax.semilogx(frequency, share, label=literal(channels[i]), **style(j))
    ax.set_xlabel("frequency, Hz")
    ax.set_ylabel(r"$f\,S(f)/\sigma^2$: share of the variance")
    ax.set_ylim(bottom=0.0)


def gust_figure(loads: GustLoads, title: str, *, spectra: tuple[Array, Array] | None = None) -> Figure:
    """Peaks against gradient beside the spectra of the response to turbulence.

    Parameters
    ----------
    loads : GustLoads
        Of `gust_loads`.
    title : str
        Above the panels.
    spectra : pair of ndarray, shapes (n_f,) and (n_f, n_channels), optional
        Of `response_spectra`. [Hz, unit^2/Hz]

    Returns
    -------
    figure : matplotlib Figure
        Two panels.
    """
    figure = new_figure(title, 1, 2, width=5.2, height=3.9)
    plot_peaks(loads, figure.axes[0])
    if spectra is None:
        why = "sampled controller:\nthe RMS is at its samples" if loads.stable else "unstable at this speed"
        nothing_to_show(figure.axes[1], f"{why}:\nno stationary response to turbulence" if not loads.stable else why)
    else:
        plot_response_spectra(*spectra, loads.channels, figure.axes[1])
        figure.axes[1].set_title("response to turbulence", fontsize="small")
    figure.axes[0].set_title("1-cosine gusts", fontsize="small")
    shared_legend(figure)
    return figure


def spectrum_figure(found: TurbulenceSpectra, title: str) -> Figure:
    """Turbulence as it is made, beside the curve of the specification and what other ways leave of it.

    Parameters
    ----------
    found : TurbulenceSpectra
        Of `turbulence_spectra`.
    title : str
        Above the panels.

    Returns
    -------
    figure : matplotlib Figure
        Spectral density above, its ratio to the analytic curve below.
    """
    figure = new_figure(title, 2, 1, width=7.2, height=3.1)
    upper, lower = figure.axes
    f = found.frequency
    upper.loglog(f, found.analytic, color="black", linewidth=2.2, label="specification")
    curves: Mapping[str, Array] = found.curves
    for j, (name, values) in enumerate(curves.items()):
        shown = values > 1e-12 * found.analytic
        look = style(j)
        upper.loglog(f[shown], values[shown], label=literal(name), **look)
        lower.semilogx(f[shown], (values / found.analytic)[shown], **look)
    for ax in (upper, lower):
        ax.plot(
            found.measured_frequency,
            found.measured / (1.0 if ax is upper else found.measured_analytic),
            ".", color=UNSTABLE, markersize=4, label=f"record, {found.seeds} x {found.duration:g} s", zorder=1,
        )  # fmt: skip
        ax.axvspan(*FLUTTER_BAND, color="0.9", zorder=0, linewidth=0.0, label="flutter band")
        ax.set_xlim(f[0], f[-1])
    lower.axhline(1.0, color="black", linewidth=0.8)
    lower.set_ylim(0.0, 1.5)
    upper.set_ylim(bottom=1e-3 * float(found.analytic.min()))
    upper.set_ylabel(r"$\Phi_w$, (m/s)$^2$/Hz")
    lower.set_ylabel("ratio to the specification")
    lower.set_xlabel("frequency, Hz")
    shared_legend(figure)
    return figure


def flight_figure(history: TimeHistory, scenario: Scenario, title: str) -> Figure:
    """A time history; in turbulence at one speed, the spectrum of the gust that was met and the analytic curve below.

    Parameters
    ----------
    history : TimeHistory
        The run.
    scenario : Scenario
        What was run.
    title : str
        Above the panels.

    Returns
    -------
    figure : matplotlib Figure
        The panels of `history_figure`, and one more where there is a spectrum to compare with.
    """
    from aeroservo.studies.turbulence_spectra import met_spectrum

    found = met_spectrum(history, scenario)
    if found is None:
        return history_figure(history, title)
    from aeroservo.report.history import shown_panels

    rows = len(shown_panels(history))
    figure = new_figure(title, rows + 1, 1, width=7.0, height=1.9)
    history_figure(history, title, axes=figure.axes[:rows])
    ax = figure.axes[rows]
    ax.loglog(found.frequency, found.measured, color=style(0)["color"], linewidth=0.8, label="gust of this run")
    ax.loglog(found.frequency, found.analytic, color="black", linewidth=1.6, label="specification")
    ax.set_ylim(bottom=0.1 * float(found.analytic.min()))
    ax.set_xlabel("frequency, Hz")
    ax.set_ylabel(r"gust, (m/s)$^2$/Hz", fontsize="small")
    ax.legend(fontsize="small", frameon=False, loc="lower left")
    return figure
