"""Gust alleviation of a rigid wing free in heave: Pratt's formula and the calculation it was fitted to.

A wing that may only plunge meets a gust; lift lags behind both the gust (Kussner) and the wing's own motion
(Wagner), and the wing starts to move with the air. The largest acceleration over that of a rigid wing in steady flow
is the alleviation factor K_g. The indicial functions come in as exponentials 1 - sum a_j exp(-b_j tau).

Valid for incompressible two-dimensional lag, no pitch, no apparent mass, no elasticity: a check, not a design load.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import lsim

__all__ = ["alleviation_factor", "gust_load_factor", "heave_response", "mass_ratio", "pratt_alleviation"]

Array = NDArray[Any]
Lags = tuple[ArrayLike, ArrayLike]


def mass_ratio(mass: ArrayLike, area: ArrayLike, density: ArrayLike, chord: ArrayLike, lift_slope: ArrayLike) -> Array:
    """Aeroplane mass ratio mu_g.

    Parameters
    ----------
    mass : array_like, shape (...)
        Mass, positive. [kg]
    area : array_like, shape (...)
        Wing area, positive. [m^2]
    density : array_like, shape (...)
        Air density, positive. [kg/m^3]
    chord : array_like, shape (...)
        Mean geometric chord, positive. [m]
    lift_slope : array_like, shape (...)
        Lift-curve slope of the aircraft, positive. [1/rad]

    Returns
    -------
    mu : ndarray, shape (...)
        2 m/(S rho c a). [-]

    Raises
    ------
    ValueError
        If an argument is not positive.

    References
    ----------
    14 CFR 23.341(c): mu_g = 2 (W/S)/(rho c a g); K. G. Pratt and W. G. Walker, NACA Report 1206, 1954.

    Examples
    --------
    >>> round(float(mass_ratio(10.0, 1.0, 1.225, 0.5267, 3.68)), 3)
    8.423
    """
    values = {"mass": mass, "area": area, "density": density, "chord": chord, "lift_slope": lift_slope}
    m, S, rho, c, a = (np.asarray(value, dtype=float) for value in values.values())
    for name, value in zip(values, (m, S, rho, c, a)):
        if not np.all(value > 0.0):
            raise ValueError(f"{name} must be positive (SI units), got {value.min():g}")
    return np.asarray(2.0 * m / (S * rho * c * a))


def pratt_alleviation(mu: ArrayLike) -> Array:
    """Gust alleviation factor of Pratt's formula, subsonic.

    Parameters
    ----------
    mu : array_like, shape (...)
        Mass ratio, positive. [-]

    Returns
    -------
    K_g : ndarray, shape (...)
        0.88 mu/(5.3 + mu). [-]

    Raises
    ------
    ValueError
        If a mass ratio is not positive.

    References
    ----------
    K. G. Pratt and W. G. Walker, NACA Report 1206, 1954; 14 CFR 23.341(c).

    Examples
    --------
    >>> round(float(pratt_alleviation(20.0)), 6)
    0.695652
    """
    mu = np.asarray(mu, dtype=float)
    if not np.all(mu > 0.0):
        raise ValueError(f"mass ratio mu must be positive [-], got {mu.min():g}")
    return 0.88 * mu / (5.3 + mu)


def gust_load_factor(
    U_de: ArrayLike, V_eas: ArrayLike, wing_loading: ArrayLike, lift_slope: ArrayLike, K_g: ArrayLike
) -> Array:
    """Increment of load factor of a rigid aircraft in the design gust.

    Parameters
    ----------
    U_de : array_like, shape (...)
        Derived gust velocity, equivalent airspeed. [m/s]
    V_eas : array_like, shape (...)
        Equivalent airspeed. [m/s]
    wing_loading : array_like, shape (...)
        Weight per wing area, positive. [N/m^2]
    lift_slope : array_like, shape (...)
        Lift-curve slope of the aircraft. [1/rad]
    K_g : array_like, shape (...)
        Alleviation factor. [-]

    Returns
    -------
    dn : ndarray, shape (...)
        K_g rho_0 U_de V a/(2 W/S), with rho_0 = 1.225 kg/m^3. [-]

    Raises
    ------
    ValueError
        If the wing loading is not positive.

    References
    ----------
    14 CFR 23.341(c): n = 1 +/- K_g U_de V a/(498 W/S) in ft/s, kt and lb/ft^2, of which this is the SI form.

    Examples
    --------
    >>> round(float(gust_load_factor(15.24, 55.0, 98.1, 3.68, 0.54)), 2)
    10.4
    """
    loading = np.asarray(wing_loading, dtype=float)
    if not np.all(loading > 0.0):
        raise ValueError(f"wing_loading must be positive [N/m^2], got {loading.min():g}")
    product = np.asarray(K_g) * np.asarray(U_de) * np.asarray(V_eas) * np.asarray(lift_slope)
    return np.asarray(0.5 * 1.225 * product / loading)


def heave_response(w: ArrayLike, step: float, mu: float, *, wagner: Lags, kussner: Lags) -> Array:
    """Acceleration of a rigid wing free in heave that flies through a gust.

    With v the upward velocity of the wing, tau = V t/b and mu the mass ratio,
    dv/dtau = (Psi * w - Phi * v)/(2 mu), each star a Duhamel integral. Solved exactly for a gust that is linear
    between its samples.

    Parameters
    ----------
    w : array_like, shape (n,)
        Gust velocity at the leading edge at equal steps of tau; a first sample that is not 0 is a sharp edge. [m/s]
    step : float
        Step of tau, in semi-chords, positive. [-]
    mu : float
        Mass ratio, positive. [-]
    wagner, kussner : pair of array_like, shape (n_lag,)
        Amplitudes a_j and exponents b_j of Phi and of Psi = 1 - sum a_j exp(-b_j tau). [-]

    Returns
    -------
    acceleration : ndarray, shape (n,)
        In units of rho V S a/(2 m) times 1 m/s, so that a unit step on an infinitely heavy wing tends to 1. [m/s]

    Raises
    ------
    ValueError
        If the step, mu or an exponent is not positive.

    References
    ----------
    Bramstång 2015, Eqs. 7.61-7.62 and section 7.10; NACA Report 1206, Eq. 1.

    Examples
    --------
    >>> jones, sears = ([0.165, 0.335], [0.0455, 0.3]), ([0.5, 0.5], [0.13, 1.0])
    >>> bool(abs(heave_response(np.ones(400), 1.0, 1e9, wagner=jones, kussner=sears)[-1] - 1.0) < 1e-6)
    True
    """
    if not (step > 0.0 and mu > 0.0):
        raise ValueError(f"step [semi-chords] and mass ratio mu [-] must be positive, got {step:g} and {mu:g}")
    (a_w, b_w), (a_k, b_k) = _exponentials(wagner, "wagner"), _exponentials(kussner, "kussner")
    n_w, n_k = a_w.size, a_k.size
    lift_v = np.concatenate([[1.0 - a_w.sum()], a_w, np.zeros(n_k)])
    lift_g = np.concatenate([np.zeros(1 + n_w), a_k])
    C, D = lift_g - lift_v, 1.0 - a_k.sum()
    A = np.zeros((1 + n_w + n_k,) * 2)
    A[0] = C / (2.0 * mu)
    A[1 : 1 + n_w, 0] = b_w
    A[1:, 1:] -= np.diag(np.concatenate([b_w, b_k]))
    B = np.concatenate([[D / (2.0 * mu)], np.zeros(n_w), b_k])
    w = np.asarray(w, dtype=float)
    _, y, _ = lsim((A, B[:, None], C[None, :], np.array([[D]])), w, step * np.arange(w.size))
    return np.atleast_1d(y)


def alleviation_factor(
    mu: ArrayLike, *, wagner: Lags, kussner: Lags, length: float = 50.0, samples: int = 5000
) -> Array:
    """Alleviation factor of a one-minus-cosine gust, computed rather than fitted.

    Parameters
    ----------
    mu : array_like, shape (...)
        Mass ratio, positive. [-]
    wagner, kussner : pair of array_like, shape (n_lag,)
        Amplitudes and exponents of the indicial functions, as `heave_response`. [-]
    length : float
        Whole length of the gust in SEMI-chords; 50 is the 25 chords of CS-23.333. [-]
    samples : int
        Points over the gust; the error falls with the square of their number.

    Returns
    -------
    K : ndarray, shape (...)
        Peak acceleration over rho V S a U/(2 m). [-]

    Raises
    ------
    ValueError
        If a mass ratio, the length or an exponent is not positive, or samples < 100.

    References
    ----------
    NACA Report 1206, 1954 (to which 0.88 mu/(5.3 + mu) was fitted).

    Examples
    --------
    >>> jones, leishman = ([0.165, 0.335], [0.0455, 0.3]), ([0.5792, 0.4208], [0.1393, 1.802])
    >>> round(float(alleviation_factor(20.0, wagner=jones, kussner=leishman)), 4)
    0.7091
    """
    if not (length > 0.0 and samples >= 100):
        raise ValueError(f"length must be positive [semi-chords] and samples >= 100, got {length:g} and {samples}")
    mu = np.asarray(mu, dtype=float)
    gust = np.sin(np.linspace(0.0, np.pi, samples + 1)) ** 2
    peaks = [heave_response(gust, length / samples, m, wagner=wagner, kussner=kussner).max() for m in mu.ravel()]
    return np.reshape(peaks, mu.shape)


def _exponentials(lags: Lags, name: str) -> tuple[Array, Array]:
    a, b = (np.atleast_1d(np.asarray(part, dtype=float)) for part in lags)
    if a.shape != b.shape or a.ndim != 1 or not np.all(b > 0.0):
        raise ValueError(f"{name} must be equally many amplitudes and positive exponents [-], got {a} and {b}")
    return a, b
