"""Lift slopes of wings of finite span, for strips that know nothing of their tips."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.datatypes import Array


def helmbold_slope(aspect_ratio: ArrayLike, section_slope: ArrayLike = 2.0 * np.pi) -> Array:
    """Lift slope of a straight wing, from slender to very long.

    Parameters
    ----------
    aspect_ratio : array_like, shape (...)
        Span squared over area, positive. [-]
    section_slope : array_like, shape (...)
        Slope of the section. [1/rad]

    Returns
    -------
    slope : ndarray, shape (...)
        a_0 A / (sqrt(A^2 + (a_0/pi)^2) + a_0/pi); pi A / 2 for a slender wing. [1/rad]

    Raises
    ------
    ValueError
        If the aspect ratio is not positive.

    References
    ----------
    Helmbold, Jahrbuch der deutschen Luftfahrtforschung, 1942, section I, p. 111.

    Examples
    --------
    >>> round(float(helmbold_slope(6.0)), 4)
    4.5287
    """
    return polhamus_slope(aspect_ratio, 0.0, section_slope)


def polhamus_slope(aspect_ratio: ArrayLike, sweep: ArrayLike, section_slope: ArrayLike = 2.0 * np.pi) -> Array:
    """Slope of a swept wing of finite span, referred to its sections normal to the axis.

    The wing's streamwise slope is a_0 A / (sqrt((A / cos L)^2 + (a_0/pi)^2) + a_0/pi); divided by cos L it is
    the slope that strips of normal sections need to give the same lift.

    Parameters
    ----------
    aspect_ratio : array_like, shape (...)
        Span squared over area, positive. [-]
    sweep : array_like, shape (...)
        Sweep of the axis, below 90 degrees. [rad]
    section_slope : array_like, shape (...)
        Slope of the normal section. [1/rad]

    Returns
    -------
    slope : ndarray, shape (...)
        For use with the normal component of the flow. [1/rad]

    Raises
    ------
    ValueError
        If the aspect ratio is not positive or the sweep is 90 degrees or more.

    References
    ----------
    Lowry & Polhamus, NACA Technical Note 3911, 1957, Eq. 1, without compressibility; Helmbold 1942, p. I 111.

    Examples
    --------
    >>> bool(abs(polhamus_slope(1e9, 0.5) - 2.0 * np.pi) < 1e-6)
    True
    """
    A, sweep, a_0 = (np.asarray(x, dtype=float) for x in (aspect_ratio, sweep, section_slope))
    if np.any(A <= 0.0):
        raise ValueError(f"aspect ratio must be positive, got {A.min():g}")
    if np.any(np.abs(sweep) >= 0.5 * np.pi):
        raise ValueError("sweep must lie between -90 and 90 degrees")
    cos, ratio = np.cos(sweep), a_0 / np.pi
    return np.asarray(a_0 * A / (np.sqrt((A / cos) ** 2 + ratio**2) + ratio) / cos)
