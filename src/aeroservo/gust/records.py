"""Records of turbulence: exact recursion, noise held as block diagrams do, and spectral synthesis.

`turbulence_record` is the one to use: exact at any step, and along a flight whose speed and height change.
`held_noise_record` reproduces the Aerospace Blockset's way for comparison: holding the noise over a step multiplies
the spectrum by sinc^2(omega step/2), and at the default step of 0.1 s nothing is left at 10 Hz.
`spectral_synthesis` gives any spectrum exactly, as a periodic record. JSBSim's default, the first-order digital form
of MIL-STD-1797A, is not offered: above its corner it has 4/3 of the true vertical spectrum.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.datatypes import LinearSystem
from aeroservo.gust._kernels import recursion
from aeroservo.gust.sampling import DiscreteNoise, _factor, _transition

__all__ = ["held_noise_attenuation", "held_noise_record", "spectral_synthesis", "turbulence_record"]

Array = NDArray[Any]


def turbulence_record(noise: DiscreteNoise, n: int | None = None, *, seed: int, hold: int = 1) -> Array:
    """A record of turbulence, stationary from its first sample.

    Parameters
    ----------
    noise : DiscreteNoise
        One recursion, or one for each `hold` steps (leading axis m): airspeed, height and intensity that vary along a
        flight.
    n : int, optional
        Number of samples; needed for one recursion, m `hold` otherwise.
    seed : int
        Seed of numpy's PCG64; the same seed always gives the same record.
    hold : int
        Steps that each recursion of a flight serves, at least 1. The states' covariance does not depend on airspeed
        and length, so the variance stays exact however long the filter is held.

    Returns
    -------
    y : ndarray, shape (n, n_y)
        Samples at 0, dt, 2 dt, ... [unit of the outputs]

    Raises
    ------
    ValueError
        If n is missing, below 1, or differs from the steps of the flight, or hold < 1.

    References
    ----------
    C. F. Van Loan, IEEE Trans. Autom. Control 23(3), 1978.

    Examples
    --------
    >>> from aeroservo.gust.sampling import discretise
    >>> names = dict(states=("x",), inputs=("n",), outputs=("y",))
    >>> lag = LinearSystem(A=[[-1.0]], B=[[2.0**0.5]], C=[[1.0]], D=[[0.0]], **names)
    >>> turbulence_record(discretise(lag, 0.1), 5, seed=1).shape
    (5, 1)
    """
    varying = noise.Ad.ndim == 3
    if noise.Ad.ndim > 3:
        raise ValueError(f"at most one leading axis (time) is allowed, got {noise.Ad.shape[:-2]}")
    steps = noise.Ad.shape[0] * hold if varying else n
    if hold < 1 or steps is None or steps < 1 or (n is not None and n != steps):
        raise ValueError(
            "number of samples n must be >= 1 and, along a flight, its steps times hold (>= 1); "
            f"got n = {n}, hold = {hold}"
        )
    arrays = [a if varying else a[None] for a in (noise.Ad, noise.Ld, noise.C, noise.P)]
    Ad, Ld, C, P = (np.ascontiguousarray(a) for a in arrays)
    rng = np.random.default_rng(seed)
    x0 = _factor(P[0]) @ rng.standard_normal(P.shape[-1])
    return recursion(Ad, Ld, C, x0, rng.standard_normal((steps, P.shape[-1])), hold)


def held_noise_attenuation(omega: ArrayLike, noise_step: float) -> Array:
    """Share of the spectrum that is left when white noise is held over a step.

    Parameters
    ----------
    omega : array_like, shape (...)
        Angular frequency. [rad/s]
    noise_step : float
        Step over which the noise is held, positive. [s]

    Returns
    -------
    share : ndarray, shape (...)
        sin^2(x)/x^2 with x = omega noise_step/2. [-]

    Raises
    ------
    ValueError
        If the step is not positive.

    References
    ----------
    gusts.md section 7: 0.875, 0.405, 0.000 at 2, 5, 10 Hz for the Aerospace Blockset's default of 0.1 s.

    Examples
    --------
    >>> held_noise_attenuation(2.0 * np.pi * np.array([2.0, 5.0, 10.0]), 0.1).round(3)
    array([0.875, 0.405, 0.   ])
    """
    if not noise_step > 0.0:
        raise ValueError(f"noise step must be positive [s], got {noise_step:g}")
    return np.sinc(np.asarray(omega, dtype=float) * noise_step / (2.0 * np.pi)) ** 2


def held_noise_record(
    system: LinearSystem, dt: float, n: int, *, seed: int, noise_step: float = 0.1, f_max: float | None = None
) -> Array:
    """A record as the Aerospace Blockset makes it: white noise held over a step, through the continuous filter.

    For comparison only: the default step loses the flutter band. The random numbers are numpy's, not MATLAB's; only
    the statistics compare.

    Parameters
    ----------
    system : LinearSystem
        One continuous filter for unit white noise, without feed-through.
    dt : float
        Step of the record, positive. [s]
    n : int
        Number of samples.
    seed : int
        Seed of numpy's PCG64.
    noise_step : float
        Step over which the noise is held, a whole number of dt; the Blockset's default is 0.1 s. [s]
    f_max : float, optional
        Highest frequency of interest: a warning is given if noise_step > 1/(20 f_max). [Hz]

    Returns
    -------
    y : ndarray, shape (n, n_y)
        Samples at 0, dt, ..., from rest. [unit of the outputs]

    Raises
    ------
    ValueError
        If a step is not positive, noise_step is not a whole number of dt, or the filter is a batch.

    References
    ----------
    Documentation of the Aerospace Blockset, "Dryden Wind Turbulence Model (Continuous)": noise sample time 0.1 s, noise
    variance 1/step; gusts.md section 6.

    Examples
    --------
    >>> names = dict(states=("x",), inputs=("n",), outputs=("y",))
    >>> lag = LinearSystem(A=[[-1.0]], B=[[2.0**0.5]], C=[[1.0]], D=[[0.0]], **names)
    >>> float(held_noise_record(lag, 0.05, 100, seed=1)[0, 0])
    0.0
    """
    if not (dt > 0.0 and noise_step > 0.0):
        raise ValueError(f"dt and noise_step must be positive [s], got {dt:g} and {noise_step:g}")
    repeat = round(noise_step / dt)
    if repeat < 1 or abs(repeat * dt - noise_step) > 1e-9 * noise_step:
        raise ValueError(f"noise_step must be a whole number of dt = {dt:g} [s], got {noise_step:g}")
    if system.A.ndim != 2 or np.any(system.D != 0.0):
        raise ValueError("one filter without feed-through is wanted")
    if f_max is not None and noise_step > 1.0 / (20.0 * f_max):
        left = float(held_noise_attenuation(2.0 * np.pi * f_max, noise_step))
        warnings.warn(
            f"noise held over {noise_step:g} s has {100.0 * left:.1f} % of its power left at {f_max:g} Hz: "
            f"use a step below {1.0 / (20.0 * f_max):g} s",
            stacklevel=2,
        )
    m, k = system.B.shape
    both = np.zeros((m + k, m + k))
    both[:m, :m], both[:m, m:] = system.A, system.B
    E = np.eye(m + k) + _transition(both, np.zeros_like(both), dt)[0]
    rng = np.random.default_rng(seed)
    held = rng.standard_normal((-(-n // repeat), k)) / np.sqrt(noise_step)
    drive = np.repeat(held, repeat, axis=0)[:n]
    parts = [np.ascontiguousarray(a)[None] for a in (E[:m, :m], E[:m, m:], system.C)]
    return recursion(parts[0], parts[1], parts[2], np.zeros(m), drive, 1)


def spectral_synthesis(psd: Callable[[Array], Array], dt: float, n: int, *, seed: int) -> Array:
    """A Gaussian record with any power spectrum, by inverse FFT: von Karman's exact one, for instance.

    The record is periodic over n dt, has no power above pi/dt (so its variance is the integral of psd to there) and
    none below 2 pi/(n dt): make it several times longer than the longest period of interest.

    Parameters
    ----------
    psd : callable
        One-sided power spectral density of angular frequency [rad/s].
    dt : float
        Step, positive. [s]
    n : int
        Number of samples, at least 4.
    seed : int
        Seed of numpy's PCG64.

    Returns
    -------
    w : ndarray, shape (n,)
        Record with mean zero. [unit whose square psd has]

    Raises
    ------
    ValueError
        If the step is not positive, n < 4, or the spectrum is negative or not finite.

    References
    ----------
    M. Shinozuka and C.-M. Jan, J. Sound Vib. 25(1), 1972, with Gaussian instead of fixed amplitudes, so that the record
    is Gaussian at any length.

    Examples
    --------
    >>> w = spectral_synthesis(lambda omega: np.where(omega < 10.0, 0.1, 0.0), 0.01, 10_000, seed=2)
    >>> bool(abs(w.var() - 1.0) < 0.2)
    True
    """
    if not dt > 0.0 or n < 4:
        raise ValueError(f"dt must be positive [s] and n >= 4, got {dt:g} and {n}")
    d_omega = 2.0 * np.pi / (n * dt)
    omega = d_omega * np.arange(n // 2 + 1)
    phi = np.asarray(psd(omega), dtype=float)
    phi[0] = 0.0
    if not (np.all(np.isfinite(phi)) and np.all(phi >= 0.0)):
        raise ValueError("the power spectral density must be finite and not negative")
    rng = np.random.default_rng(seed)
    normal = rng.standard_normal((2, omega.size))
    amplitude = np.sqrt(phi * d_omega) * (normal[0] - 1j * normal[1])  # variance phi d_omega of each cosine and sine
    if n % 2 == 0:
        amplitude[-1] = np.sqrt(phi[-1] * d_omega) * normal[0, -1]
    return np.fft.irfft(amplitude, n) * (n / 2.0)
