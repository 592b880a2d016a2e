"""Spectra of turbulence as it is made: the specification's curve, our samples, and what other ways leave of it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from aeroservo.datatypes import Array
from aeroservo.gust.intensity import Turbulence
from aeroservo.gust.records import held_noise_attenuation, turbulence_record
from aeroservo.gust.response import frequency_response
from aeroservo.gust.sampling import discrete_psd, discretise
from aeroservo.gust.turbulence import Model, component_psd, vertical_filter
from aeroservo.simulate.disturbances import BLOCKSET_STEP

if TYPE_CHECKING:
    from aeroservo.simulate.history import TimeHistory
    from aeroservo.simulate.scenario import Scenario
    from aeroservo.studies.gust_plant import GustPlant


@dataclass(frozen=True, kw_only=True, eq=False)
class TurbulenceSpectra:
    """One-sided spectral densities of the vertical gust.

    Attributes
    ----------
    frequency : ndarray, shape (n_f,)
        [Hz]
    analytic : ndarray, shape (n_f,)
        Of the specification. [(m/s)^2/Hz]
    curves : dict of str to ndarray, shape (n_f,)
        By name: our samples, and the Blockset's defaults. [(m/s)^2/Hz]
    measured_frequency, measured, measured_analytic : ndarray, shape (n_b,)
        Band averages of records, and of the curve of the specification in the same bands. [Hz, (m/s)^2/Hz]
    seeds : int
        Number of records.
    duration : float
        Length of each. [s]
    """

    frequency: Array
    analytic: Array
    curves: dict[str, Array]
    measured_frequency: Array
    measured: Array
    measured_analytic: Array
    seeds: int
    duration: float


def turbulence_spectra(
    state: Turbulence, V: float, *, model: Model = "dryden", dt: float = 1e-3, seeds: int = 12, duration: float = 300.0
) -> TurbulenceSpectra:
    """Spectra of the vertical gust, 0.01 to 100 Hz.

    Parameters
    ----------
    state : Turbulence
        One state.
    V : float
        True airspeed. [m/s]
    model : {"dryden", "von_karman", "von_karman_blockset"}
        Spectrum and filter.
    dt : float
        Step of our samples. [s]
    seeds : int
        Records that are measured, seeds 0, 1, ...
    duration : float
        Length of each. [s]

    Returns
    -------
    spectra : TurbulenceSpectra
        With the Aerospace Blockset's filter driven by noise that is held for 0.1 s. [(m/s)^2/Hz]

    Raises
    ------
    ValueError
        If a name is unknown or an argument outside its range.
    """
    from scipy.signal import welch

    f = np.geomspace(0.01, min(100.0, 0.45 / dt), 500)
    noise = discretise(vertical_filter(state, V, model=model), dt)
    held = held_noise_attenuation(2.0 * np.pi * f, BLOCKSET_STEP)
    theirs = vertical_filter(state, V, model="dryden" if model == "dryden" else "von_karman_blockset")
    H = frequency_response((theirs.A, theirs.B, theirs.C, theirs.D), 2.0 * np.pi * f)[:, 0, 0]
    per_hertz = 2.0 * np.pi
    curves = {
        f"samples every {1e3 * dt:g} ms": per_hertz * discrete_psd(noise, 2.0 * np.pi * f)[:, 0],
        f"Aerospace Blockset's defaults (noise held {BLOCKSET_STEP:g} s)": 2.0 * np.abs(H) ** 2 * held,
    }
    n, segment = round(duration / dt), round(min(60.0, duration / 4.0) / dt)
    power = np.zeros(segment // 2 + 1)
    for seed in range(seeds):
        at, one = welch(
            turbulence_record(noise, n, seed=seed)[:, 0], fs=1.0 / dt, nperseg=segment, detrend=False, window="hann"
        )
        power += one / seeds
    edges = np.geomspace(3.0 / (segment * dt), f[-1], 40)
    bands = [mask for low, high in pairwise(edges) if np.any(mask := (at >= low) & (at < high))]
    exact = np.zeros(at.size)
    exact[1:] = per_hertz * component_psd(2.0 * np.pi * at[1:], state, V, component="w", model=model)
    return TurbulenceSpectra(
        frequency=f,
        analytic=per_hertz * component_psd(2.0 * np.pi * f, state, V, component="w", model=model),
        curves=curves,
        measured_frequency=np.array([at[mask].mean() for mask in bands]),
        measured=np.array([power[mask].mean() for mask in bands]),
        measured_analytic=np.array([exact[mask].mean() for mask in bands]),
        seeds=seeds,
        duration=duration,
    )


def response_spectra(plant: GustPlant, state: Turbulence, model: Model = "dryden") -> tuple[Array, Array]:
    """Spectral densities of all channels of a stable plant in turbulence.

    Parameters
    ----------
    plant : GustPlant
        Stable.
    state : Turbulence
        Intensity and length.
    model : {"dryden", "von_karman", "von_karman_blockset"}
        The exact spectrum is taken.

    Returns
    -------
    frequency : ndarray, shape (n_f,)
        0.01 to 100 Hz, dense at the resonances. [Hz]
    density : ndarray, shape (n_f, n_channels)
        Channels that feel the rate of the gust included. [unit^2/Hz]
    """
    from aeroservo.gust.response import frequency_grid

    omega = frequency_grid(plant.A, 0.02 * np.pi, 200.0 * np.pi, per_peak=100)
    late = np.exp(-1j * omega[:, None] * plant.x_offset / plant.V)
    H = frequency_response(plant.matrices, omega) + 1j * omega[:, None, None] * plant.rate
    total = np.einsum("wym,wm->wy", H, late)
    spectrum = 2.0 * np.pi * component_psd(omega, state, plant.V, component="w", model=model)
    return omega / (2.0 * np.pi), np.abs(total) ** 2 * spectrum[:, None]


@dataclass(frozen=True, kw_only=True, eq=False)
class MetSpectrum:
    """Spectrum of the gust that a run met, and that of the specification.

    Attributes
    ----------
    frequency : ndarray, shape (n_f,)
        Positive. [Hz]
    measured : ndarray, shape (n_f,)
        Welch's averages over eighths of the run. [(m/s)^2/Hz]
    analytic : ndarray, shape (n_f,)
        Of the specification. [(m/s)^2/Hz]
    """

    frequency: Array
    measured: Array
    analytic: Array


def met_spectrum(history: TimeHistory, scenario: Scenario) -> MetSpectrum | None:
    """Spectrum of the turbulence in a run beside the curve of the specification.

    Parameters
    ----------
    history : TimeHistory
        With the channel `gust_m_s`.
    scenario : Scenario
        What was run.

    Returns
    -------
    spectrum : MetSpectrum or None
        None where there is no one spectrum: no turbulence, discrete gusts in it, a changing flight, or a short run.
    """
    from scipy.signal import welch

    weather, flight, channel = scenario.turbulence, scenario.profile, "gust_m_s"
    if weather is None or weather.level == 0.0 or scenario.gusts or flight.moving or channel not in history.channels:
        return None
    if len(history.t) < 256:
        return None
    w, step = history[channel], float(history.t[1] - history.t[0])
    f, power = welch(w, fs=1.0 / step, nperseg=len(w) // 8, detrend=False, window="hann")
    altitude = np.zeros(1) if flight.altitude is None else flight.altitude[:1]
    state, V = weather.state(altitude), float(flight.V[0])
    one = state if state.intensity.ndim == 1 else state[0]
    analytic = 2.0 * np.pi * component_psd(2.0 * np.pi * f[1:], one, V, component="w", model=weather.filter)
    return MetSpectrum(frequency=f[1:], measured=power[1:], analytic=analytic)
