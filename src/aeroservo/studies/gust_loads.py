"""Gust and turbulence response of any model at one flight condition: peaks, critical gradients, RMS.

Discrete gusts are 1-cosine pulses whose gradient H is half their length; their velocity follows a design law (one
metre per second, CS-25.341(a) or CS-23.333(c)). Continuous turbulence has an RMS of 1 m/s. The RMS of each channel is
computed twice: from Lyapunov's equation of plant and shaping filter, which has no frequency grid, and from the
frequency response under the exact spectrum, which has no filter; they differ by the fit of von Karman's filter, at most
0.25 %, and by the loss of the Blockset's filters where these are asked for.

All of it is linear, about the equilibrium. Where the model is unstable there is no answer, and the result says so.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.atmosphere import true_airspeed
from aeroservo.datatypes import Array, frozen
from aeroservo.gust.critical import CriticalGradient, critical_gradient
from aeroservo.gust.design_gusts import (
    CS25_GRADIENT_RANGE,
    cs23_gust_velocity,
    cs25_design_velocity,
    cs25_reference_velocity,
)
from aeroservo.gust.intensity import Turbulence, constant_turbulence
from aeroservo.gust.pulse import PulsePeaks, pulse_peaks
from aeroservo.gust.response import frequency_grid, frequency_response, rms_from_frequency_response, rms_response
from aeroservo.gust.turbulence import Model, component_psd, vertical_filter
from aeroservo.studies.gust_plant import GustPlant

Design = Literal["unit", "cs25", "cs23"]

#: Relative accuracy of the critical gradient. [-]
TOLERANCE = 1e-3
#: First grid of the search for it.
SAMPLES = 25


@dataclass(frozen=True, kw_only=True, eq=False)
class GustLoads:
    """Response of a model to gusts and turbulence; nan where there is none.

    Attributes
    ----------
    channels : tuple of str
        The unit as suffix.
    gradient : ndarray, shape (n,)
        Gust gradient distances H: half the length of a pulse. [m]
    velocity : ndarray, shape (n,)
        Peak velocity of each pulse, true. [m/s]
    peak, lowest, highest : ndarray, shape (n, n_channels)
        Largest magnitude, and extremes with their signs. [unit of the channel]
    critical : CriticalGradient or None
        Worst gradient of each channel; None where it was not sought or the model is unstable.
    rms : ndarray, shape (n_channels,)
        Per unit RMS of the turbulence, by Lyapunov's equation. [unit of the channel/(m/s)]
    rms_by_frequency : ndarray, shape (n_channels,)
        The same from the frequency response under the exact spectrum. [unit of the channel/(m/s)]
    growth : float
        Largest real part of an eigenvalue: negative is stable. [1/s]
    notes : tuple of str
        What to know before trusting the numbers.
    """

    channels: tuple[str, ...]
    gradient: Array
    velocity: Array
    peak: Array
    lowest: Array
    highest: Array
    critical: CriticalGradient | None
    rms: Array
    rms_by_frequency: Array
    growth: float
    notes: tuple[str, ...]

    def __post_init__(self) -> None:
        """Lock the arrays; nan is allowed."""
        for name in ("gradient", "velocity"):
            object.__setattr__(self, name, frozen(getattr(self, name), ndim=1, name=name))
        for name in ("peak", "lowest", "highest", "rms", "rms_by_frequency"):
            value = np.array(getattr(self, name), dtype=float)
            value.flags.writeable = False
            object.__setattr__(self, name, value)

    @property
    def stable(self) -> bool:
        """Whether the model is stable, so that there is an answer. [-]"""
        return self.growth < 0.0


def design_velocity(design: Design, *, altitude: float | None, density: float) -> Callable[[ArrayLike], Array]:
    """True gust velocity against gradient under a design law.

    Parameters
    ----------
    design : {"unit", "cs25", "cs23"}
        1 m/s whatever the gradient; CS-25.341(a)(4)-(5) with F_g = 1; CS-23.333(c) at V_C.
    altitude : float, optional
        Altitude; needed by the codes. [m]
    density : float
        Air density, for the conversion from equivalent to true. [kg/m^3]

    Returns
    -------
    velocity : callable
        From gradients of shape (n,) [m] to velocities of shape (n,). [m/s]

    Raises
    ------
    ValueError
        If the law is unknown, or needs an altitude and has none.
    """
    if design not in ("unit", "cs25", "cs23"):
        raise ValueError(f"design must be unit, cs25 or cs23, got {design!r}")
    if design == "unit":
        return lambda H: np.ones(np.shape(H))
    if altitude is None:
        raise ValueError(f"design {design!r} needs an altitude, where its gust velocities are tabulated [m]")
    if design == "cs23":
        derived = float(true_airspeed(float(cs23_gust_velocity(altitude)), density))
        return lambda H: np.full(np.shape(H), derived)
    U_ref = float(cs25_reference_velocity(altitude))
    return lambda H: np.asarray(true_airspeed(cs25_design_velocity(H, U_ref), density))


def gust_loads(
    plant: GustPlant,
    *,
    gradients: ArrayLike,
    velocity: Callable[[ArrayLike], ArrayLike],
    bounds: tuple[float, float] | None = CS25_GRADIENT_RANGE,
    turbulence: Turbulence | None = None,
    model: Model = "dryden",
) -> GustLoads:
    """Peaks in discrete gusts, the critical gradient of every channel, and RMS in continuous turbulence.

    Parameters
    ----------
    plant : GustPlant
        Of `gust_plant`: any model at one flight condition.
    gradients : array_like, shape (n,)
        Gust gradient distances, positive. [m]
    velocity : callable
        Of `design_velocity`: true gust velocity [m/s] of gradients [m].
    bounds : pair of float, optional
        Range in which the critical gradients are sought, to 0.1 %; None leaves that out. [m]
    turbulence : Turbulence, optional
        Lengths, and an intensity of 1 m/s, of the vertical component; default L = 533.4 m.
    model : {"dryden", "von_karman", "von_karman_blockset"}
        Spectrum.

    Returns
    -------
    loads : GustLoads
        nan, and a note, where the model is unstable.

    Raises
    ------
    ValueError
        If a gradient is not positive, or a name unknown.
    """
    H = np.atleast_1d(np.asarray(gradients, dtype=float))
    if H.ndim != 1 or not np.all((H > 0.0) & np.isfinite(H)):
        raise ValueError(f"gust gradients must be positive [m], got {np.min(H):g}")
    U = np.asarray(velocity(H), dtype=float)
    growth, notes = plant.growth, list(plant.notes)
    state = constant_turbulence(1.0) if turbulence is None else turbulence
    empty = np.full((len(H), len(plant.outputs)), np.nan)
    if not growth < 0.0:
        notes.append(
            f"the model is unstable at {plant.V:g} m/s (a root grows at {growth:.4g} 1/s): "
            "there are no peaks and no RMS, only time histories (simulate)"
        )
        return GustLoads(
            channels=plant.outputs, gradient=H, velocity=U, peak=empty, lowest=empty, highest=empty, critical=None,
            rms=empty[0], rms_by_frequency=empty[0], growth=growth, notes=tuple(notes),
        )  # fmt: skip

    def responses(at: Array) -> PulsePeaks:
        return pulse_peaks(plant.matrices, velocity(at), 2.0 * at, plant.V, rate=plant.rate, x_offset=plant.x_offset)

    found = responses(H)
    critical = None
    if bounds is not None:
        critical = critical_gradient(lambda at: responses(at).peak, bounds=bounds, samples=SAMPLES, tolerance=TOLERANCE)
    rms, by_frequency, infinite = turbulence_rms(plant, state, model)
    if infinite:
        notes.append(
            f"{', '.join(infinite)}: the air forces hold the rate of the gust, whose RMS in turbulence is infinite; "
            "in a 1-cosine gust the peak exists"
        )
    return GustLoads(
        channels=plant.outputs, gradient=H, velocity=U, peak=found.peak, lowest=found.lowest, highest=found.highest,
        critical=critical, rms=rms, rms_by_frequency=by_frequency, growth=growth, notes=tuple(notes),
    )  # fmt: skip


def turbulence_rms(
    plant: GustPlant, state: Turbulence, model: Model = "dryden"
) -> tuple[Array, Array, tuple[str, ...]]:
    """RMS of every channel in vertical turbulence, by Lyapunov's equation and by frequency response.

    Parameters
    ----------
    plant : GustPlant
        Stable.
    state : Turbulence
        Intensity and length of the vertical component.
    model : {"dryden", "von_karman", "von_karman_blockset"}
        Spectrum.

    Returns
    -------
    rms, by_frequency : ndarray, shape (n_channels,)
        nan where the RMS is infinite. [unit of the channel]
    infinite : tuple of str
        Those channels.

    Raises
    ------
    ValueError
        If the plant is unstable.
    """
    gust, m = vertical_filter(state, plant.V, model=model), plant.B.shape[1]
    shaping = (gust.A, gust.B, np.tile(gust.C, (m, 1)), np.zeros((m, 1)))
    finite = ~np.any(plant.rate != 0.0, axis=1)
    A, B, C, D = plant.A, plant.B, plant.C[finite], plant.D[finite]
    rms, by_frequency = (np.full(len(plant.outputs), np.nan) for _ in range(2))
    rms[finite] = rms_response((A, B, C, D), shaping, delays=plant.x_offset / plant.V)
    scale = plant.V / float(state.length[..., 2])
    fastest = max(float(np.abs(np.linalg.eigvals(A)).max(initial=0.0)), scale)
    omega = frequency_grid(A, 1e-4 * scale, 1e4 * fastest, per_peak=300)
    late = np.exp(-1j * omega[:, None] * plant.x_offset / plant.V)
    H = np.einsum("wym,wm->wy", frequency_response((A, B, C, D), omega), late)
    spectrum = component_psd(omega, state, plant.V, component="w", model=model)
    by_frequency[finite] = rms_from_frequency_response(H, spectrum, omega)
    return rms, by_frequency, tuple(name for name, ok in zip(plant.outputs, finite) if not ok)
