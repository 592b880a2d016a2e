"""Thin-airfoil theory: what camber, a hinged and a morphed control do to lift and moment."""

from __future__ import annotations

from typing import Literal

import numpy as np

from aeroservo.aero.airfoil import Airfoil, mean_line


def hinged_derivatives(hinge: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Lift and moment of a control with a sharp hinge.

    Parameters
    ----------
    hinge : array_like, shape (...)
        Hinge from the leading edge, in chords, in [0, 1). [-]

    Returns
    -------
    cl_delta, cm_delta : ndarray, shape (...)
        Per radian, trailing edge down; moment about the quarter chord, nose up. [1/rad]

    Raises
    ------
    ValueError
        If a hinge lies outside [0, 1).

    References
    ----------
    H. Glauert, ARC Reports and Memoranda no. 1095, 1927; J. Katz, A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 5.

    Examples
    --------
    >>> cl, cm = hinged_derivatives(0.75)
    >>> round(float(cl), 3), round(float(cm), 3)
    (3.826, -0.65)
    """
    t = _angle(hinge)
    return 2.0 * (np.pi - t + np.sin(t)), -0.5 * np.sin(t) * (1.0 - np.cos(t))


def morphed_derivatives(
    hinge: np.ndarray | float, *, reading: Literal["same_drop", "same_slope"] = "same_drop"
) -> tuple[np.ndarray, np.ndarray]:
    """Lift and moment of a control that bends smoothly: parabolic camber behind the "hinge".

    Parameters
    ----------
    hinge : array_like, shape (...)
        Where the bending starts, in chords, in [0, 1). [-]
    reading : {"same_drop", "same_slope"}
        Equal deflection means: the trailing edge drops as far as a hinged control's, or ends with its slope.

    Returns
    -------
    cl_delta, cm_delta : ndarray, shape (...)
        Per radian, trailing edge down; moment about the quarter chord, nose up. [1/rad]

    Raises
    ------
    ValueError
        If a hinge lies outside [0, 1) or the reading is unknown.

    References
    ----------
    Fourier coefficients of the mean line dz = -tan(delta) s (x - x_h)^2/(1 - x_h), s = 1 or 1/2; theory of J. Katz,
    A. Plotkin, Low-Speed Aerodynamics, 2001, chapter 5.

    Examples
    --------
    >>> cl, cm = morphed_derivatives(0.75)
    >>> round(float(cl), 3), round(float(cm), 3)
    (5.196, -1.047)
    """
    if reading not in ("same_drop", "same_slope"):
        raise ValueError(f'reading must be "same_drop" or "same_slope", got {reading!r}')
    t = _angle(hinge)
    sin, cos = np.sin(t), np.cos(t)
    k = (2.0 if reading == "same_drop" else 1.0) / (1.0 + cos)
    a0 = k / np.pi * ((np.pi - t) * cos + sin)
    a1 = k / np.pi * (np.pi - t + sin * cos)
    a2 = 2.0 * k / np.pi * (cos * np.sin(2.0 * t) / 2.0 - (sin + np.sin(3.0 * t) / 3.0) / 2.0)
    return 2.0 * np.pi * (a0 + a1 / 2.0), np.pi / 4.0 * (a2 - a1)


def camber_coefficients(foil: Airfoil) -> tuple[float, float]:
    """Zero-lift angle and moment of the mean line.

    Parameters
    ----------
    foil : Airfoil
        The outline.

    Returns
    -------
    alpha_0, cm_0 : float
        Zero-lift angle [rad] and moment about the quarter chord at any angle [-].

    References
    ----------
    M. Munk, NACA Report 142, 1922: integrals over the mean line's height, the slope's integrated by parts once.

    Examples
    --------
    >>> from aeroservo.aero.airfoil_files import airfoil
    >>> a, m = camber_coefficients(airfoil("naca2412"))
    >>> round(float(np.degrees(a)), 2), round(m, 3)
    (-2.08, -0.053)
    """
    t = (np.arange(4000) + 0.5) * np.pi / 4000
    x = (1.0 - np.cos(t)) / 2.0
    z, _ = mean_line(foil, x)
    ends, _ = mean_line(foil, np.array([0.0, 1.0]))
    z = z - ends[0] - (ends[1] - ends[0]) * x
    tilt = float(ends[1] - ends[0])
    alpha_0 = tilt - 2.0 * np.mean(z / (1.0 + np.cos(t)))
    cm_0 = -np.pi * np.mean(z * (2.0 * (1.0 - np.cos(t)) - (2.0 * np.cos(t) + 1.0) / (1.0 + np.cos(t))))
    return float(alpha_0), float(cm_0)


def _angle(hinge: np.ndarray | float) -> np.ndarray:
    hinge = np.asarray(hinge, dtype=float)
    if np.any((hinge < 0.0) | (hinge >= 1.0)):
        raise ValueError(f"hinge must lie in [0, 1) of the chord, got {hinge.min():g} to {hinge.max():g}")
    return np.arccos(1.0 - 2.0 * hinge)
