"""Dryden turbulence: power spectra and the shaping filters that have exactly these spectra.

Every spectrum is one-sided in angular frequency, sigma^2 = integral from 0 to infinity of Phi d(omega). The filters
take unit white noise (autocorrelation delta(t): variance 1/dt when held over dt), for which Phi = |H|^2/pi.

Filters come as a `core`, three arrays that are numbers only: with T = L/V (2 L/V for the v and w of MIL-HDBK-1797),

    A = A0/T,  B = B0/sqrt(T),  C = sigma C0.

In that form the covariance of the states does not depend on T, so a filter whose airspeed, height and length change
along a flight keeps its variance sigma^2 exactly, and samples one frozen field in distance.

Components are those of the specification's body axes (u forward, v right, w down); the project's upward gust is -w.
Angular rates p, q, r are the gradients of the velocity over the aircraft; b is the full WINGSPAN here.
"""

from __future__ import annotations

from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.gust.intensity import Specification, _check_specification

__all__ = ["Component", "dryden_core", "dryden_psd", "rate_attenuation", "roll_rate_psd", "time_scale"]

Array = NDArray[Any]
Component = Literal["u", "v", "w", "p", "q", "r"]


def dryden_psd(
    omega: ArrayLike,
    *,
    component: Component,
    V: ArrayLike,
    length: ArrayLike,
    intensity: ArrayLike,
    span: float | None = None,
    specification: Specification = "MIL-F-8785C",
) -> Array:
    """One-sided Dryden power spectral density of any of the six components.

    Parameters
    ----------
    omega : array_like, shape (...)
        Angular frequency. [rad/s]
    component : {"u", "v", "w", "p", "q", "r"}
        Velocity or angular rate; p and q belong to w, r to v.
    V : array_like, shape (...)
        True airspeed, positive. [m/s]
    length, intensity : array_like, shape (...)
        Scale length [m] and RMS [m/s] of the velocity to which the component belongs, in the convention of
        `specification`.
    span : float, optional
        Wingspan b, needed for the rates. [m]
    specification : {"MIL-F-8785C", "MIL-HDBK-1797"}
        1797 has 2L where 8785C has L, in v, w and the rates.

    Returns
    -------
    Phi : ndarray, shape (...)
        [(m/s)^2 s/rad], or [(rad/s)^2 s/rad] for the rates.

    Raises
    ------
    ValueError
        If a name is unknown, V or length is not positive, intensity is negative, or the span is missing.

    References
    ----------
    Bramstång 2015, Eqs. 7.63-7.65 (the form of 1797; printed with sigma misplaced and 1 + 4(L Omega)^2 to be read
    squared); MIL-F-8785C, section 3.7; the rates from memory of the standard, agreeing with the documentation of the
    Aerospace Blockset.

    Examples
    --------
    >>> round(float(dryden_psd(0.0, component="w", V=50.0, length=533.4, intensity=1.0)), 4)
    3.3957
    """
    sigma, T = _scales(component, V, length, intensity, specification)
    omega = np.asarray(omega, dtype=float)
    if component == "p":
        return roll_rate_psd(omega, V=V, length=length, intensity=sigma, span=span, specification=specification)
    x = (T * omega) ** 2
    if component == "u":
        return sigma**2 * (2.0 * T / np.pi) / (1.0 + x)
    phi = sigma**2 * (T / np.pi) * (1.0 + 3.0 * x) / (1.0 + x) ** 2
    return phi if component in ("v", "w") else phi * rate_attenuation(omega, component, V, span)


def rate_attenuation(omega: ArrayLike, component: Component, V: ArrayLike, span: float | None) -> Array:
    """Ratio of the spectrum of a pitch or yaw rate to that of the velocity it belongs to.

    Parameters
    ----------
    omega : array_like, shape (...)
        Angular frequency. [rad/s]
    component : {"q", "r"}
        q from w, r from v.
    V : array_like, shape (...)
        True airspeed. [m/s]
    span : float
        Wingspan b, positive. [m]

    Returns
    -------
    ratio : ndarray, shape (...)
        (omega/V)^2/(1 + (4 b omega/(pi V))^2) for q, with 3 for 4 for r. [rad^2/m^2]

    Raises
    ------
    ValueError
        If the component is neither q nor r, or the span is missing or not positive.

    References
    ----------
    MIL-F-8785C, section 3.7, written from memory of the standard; agrees with the documentation of the Aerospace
    Blockset's Dryden block.

    Examples
    --------
    >>> float(rate_attenuation(0.0, "q", 50.0, 2.0))
    0.0
    """
    x = np.asarray(omega, dtype=float) / np.asarray(V, dtype=float)
    return x**2 / (1.0 + (rate_length(component, span) * x) ** 2)


def rate_length(component: str, span: float | None) -> float:
    """Length that limits the gradient over the aircraft: 4 b/pi for p and q, 3 b/pi for r.

    Parameters
    ----------
    component : {"p", "q", "r"}
        Angular rate.
    span : float
        Wingspan b, positive. [m]

    Returns
    -------
    l : float
        The filter's time constant is l/V. [m]

    Raises
    ------
    ValueError
        If the component is not a rate, or the span is missing or not positive.

    References
    ----------
    MIL-F-8785C, section 3.7, written from memory of the standard.

    Examples
    --------
    >>> round(rate_length("q", 2.0), 4)
    2.5465
    """
    factors = {"p": 4.0, "q": 4.0, "r": 3.0}
    if component not in factors:
        raise ValueError(f"rate component must be one of p, q, r, got {component!r}")
    if span is None or not span > 0.0:
        raise ValueError(f"span must be positive [m] for the angular rates, got {span}")
    return factors[component] * span / np.pi


def roll_rate_psd(
    omega: ArrayLike,
    *,
    V: ArrayLike,
    length: ArrayLike,
    intensity: ArrayLike,
    span: float | None,
    specification: Specification = "MIL-F-8785C",
) -> Array:
    """One-sided power spectral density of the roll rate p, the same for Dryden and von Karman.

    Parameters
    ----------
    omega : array_like, shape (...)
        Angular frequency. [rad/s]
    V : array_like, shape (...)
        True airspeed. [m/s]
    length, intensity : array_like, shape (...)
        L_w [m] and sigma_w [m/s].
    span : float
        Wingspan b, positive. [m]
    specification : {"MIL-F-8785C", "MIL-HDBK-1797"}
        1797 has 2 L_w in place of L_w.

    Returns
    -------
    Phi : ndarray, shape (...)
        sigma_w^2/(V L_w) 0.8 (pi L_w/(4 b))^(1/3)/(1 + (4 b omega/(pi V))^2). [(rad/s)^2 s/rad]

    Raises
    ------
    ValueError
        If an argument is outside its range.

    References
    ----------
    MIL-F-8785C, section 3.7, and MIL-HDBK-1797, Appendix A, written from memory of the standards; agrees with the
    documentation of the Aerospace Blockset's Dryden block.

    Examples
    --------
    >>> phi = roll_rate_psd([0.0, 1e9], V=50.0, length=500.0, intensity=1.0, span=10.0)
    >>> bool(phi[0] > 0.0 and phi[1] < 1e-12)
    True
    """
    sigma, T = _scales("p", V, length, intensity, specification)
    speed = np.asarray(V, dtype=float)
    L, limit = T * speed, rate_length("p", span)
    level = sigma**2 / (speed * L) * 0.8 * (L / limit) ** (1.0 / 3.0)
    return level / (1.0 + (limit * np.asarray(omega, dtype=float) / speed) ** 2)


def dryden_core(component: Component) -> tuple[Array, Array, Array]:
    """State-space numbers of a Dryden velocity filter, in units of its time scale.

    Parameters
    ----------
    component : {"u", "v", "w"}
        Velocity component; v and w share one.

    Returns
    -------
    A0 : ndarray, shape (n, n)
        A = A0/T. [-]
    B0 : ndarray, shape (n, 1)
        B = B0/sqrt(T). [-]
    C0 : ndarray, shape (1, n)
        C = sigma C0. [-]

    Raises
    ------
    ValueError
        If the component is not a velocity.

    References
    ----------
    gusts.md section 1: H_u = sigma sqrt(2T)/(1 + Ts), H_v,w = sigma sqrt(T)(1 + sqrt(3) T s)/(1 + T s)^2 for unit white
    noise, from the spectra of MIL-F-8785C, section 3.7, by factoring.

    Examples
    --------
    >>> A0, B0, C0 = dryden_core("u")
    >>> round(float(C0[0, 0]) ** 2, 12)
    2.0
    """
    if component == "u":
        return np.array([[-1.0]]), np.array([[1.0]]), np.array([[np.sqrt(2.0)]])
    if component not in ("v", "w"):
        raise ValueError(f"velocity component must be one of u, v, w, got {component!r}")
    root = np.sqrt(3.0)
    return np.array([[-1.0, 0.0], [1.0, -1.0]]), np.array([[1.0], [0.0]]), np.array([[root, 1.0 - root]])


def time_scale(component: Component, V: ArrayLike, length: ArrayLike, specification: Specification) -> Array:
    """Time scale T of a filter or spectrum in MIL-F-8785C's form.

    Parameters
    ----------
    component : {"u", "v", "w", "p", "q", "r"}
        Component.
    V : array_like, shape (...)
        True airspeed, positive. [m/s]
    length : array_like, shape (...)
        Scale length in the convention of `specification`, positive. [m]
    specification : {"MIL-F-8785C", "MIL-HDBK-1797"}
        Whose length it is.

    Returns
    -------
    T : ndarray, shape (...)
        L/V; 2 L/V in 1797 except for u. [s]

    Raises
    ------
    ValueError
        If a name is unknown, or V or length is not positive.

    References
    ----------
    MIL-F-8785C, section 3.7; MIL-HDBK-1797, Appendix A; gusts.md section 1.

    Examples
    --------
    >>> time_scale("w", 50.0, 250.0, "MIL-HDBK-1797")
    array(10.)
    """
    if component not in get_args(Component):
        raise ValueError(f"unknown component {component!r}: use one of {', '.join(get_args(Component))}")
    _check_specification(specification)
    V, length = np.asarray(V, dtype=float), np.asarray(length, dtype=float)
    for name, unit, value in (("airspeed V", "m/s", V), ("scale length", "m", length)):
        if not np.all(value > 0.0):
            raise ValueError(f"{name} must be positive [{unit}], got {value.min():g}")
    double = specification == "MIL-HDBK-1797" and component != "u"
    return np.asarray((2.0 if double else 1.0) * length / V)


def _scales(
    component: Component, V: ArrayLike, length: ArrayLike, intensity: ArrayLike, specification: Specification
) -> tuple[Array, Array]:
    """Checked intensity and time scale."""
    sigma = np.asarray(intensity, dtype=float)
    if not np.all(sigma >= 0.0):
        raise ValueError(f"turbulence intensity must not be negative [m/s], got {sigma.min():g}")
    return sigma, time_scale(component, V, length, specification)
