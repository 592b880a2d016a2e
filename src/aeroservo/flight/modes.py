"""Modes of rigid flight, with their usual names, and how the roots move with the centre of gravity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linear_sum_assignment

from aeroservo.atmosphere import STANDARD_GRAVITY
from aeroservo.datatypes import frozen
from aeroservo.flight.derivatives import longitudinal_derivatives
from aeroservo.flight.linear import longitudinal_model
from aeroservo.flight.rigid import Airframe
from aeroservo.flight.trim import (
    LongitudinalCoefficients,
    about_centre_of_gravity,
    static_margin,
    trim_derivatives,
    trim_level,
)

__all__ = ["FlightMode", "RootMovement", "flight_modes", "root_movement"]

Array = NDArray[Any]


@dataclass(frozen=True, kw_only=True)
class FlightMode:
    """One mode of rigid flight: a pair of complex roots or one real root.

    Attributes
    ----------
    name : str
        "phugoid", "short period", "Dutch roll", "spiral", "roll", or what a less usual root is: "oscillation",
        "aperiodic".
    eigenvalue : complex
        The root, with positive imaginary part for a pair. [rad/s]
    """

    name: str
    eigenvalue: complex

    @property
    def frequency(self) -> float:
        """Undamped natural frequency |lambda|. [rad/s]"""
        return abs(self.eigenvalue)

    @property
    def damping_ratio(self) -> float:
        """-Re(lambda)/|lambda|, positive is stable; 0 for a root at the origin. [-]"""
        return -self.eigenvalue.real / self.frequency if self.frequency else 0.0

    @property
    def period(self) -> float | None:
        """Period 2 pi/Im(lambda), None if aperiodic. [s]"""
        return 2.0 * np.pi / self.eigenvalue.imag if self.eigenvalue.imag > 0.0 else None

    @property
    def time_to_half(self) -> float | None:
        """Time to half amplitude; NEGATIVE is the time to double, None neither. [s]"""
        return float(-np.log(2.0) / self.eigenvalue.real) if self.eigenvalue.real else None


@dataclass(frozen=True, kw_only=True, eq=False)
class RootMovement:
    """Longitudinal roots against the position of the centre of gravity.

    Attributes
    ----------
    x_cg : ndarray, shape (n,)
        Centre of gravity, aft of the datum. [m]
    static_margin : ndarray, shape (n,)
        (x_np - x_cg)/c. [-]
    roots : complex ndarray, shape (n, 4)
        Each column follows one root. [rad/s]
    """

    x_cg: Array
    static_margin: Array
    roots: Array

    def __post_init__(self) -> None:
        for name, kind in (("x_cg", float), ("static_margin", float), ("roots", complex)):
            object.__setattr__(self, name, frozen(getattr(self, name), dtype=kind, name=name))


def flight_modes(
    A: ArrayLike, motion: Literal["longitudinal", "lateral"] = "longitudinal", *, tolerance: float = 1e-9
) -> tuple[FlightMode, ...]:
    """Modes of a longitudinal or lateral model, slowest first.

    Two oscillations of the longitudinal motion are the phugoid and the short period. With the centre of gravity well
    aft these names lose their meaning (an oscillation and real roots of mixed origin): the roots are then named by
    what they are. Of the lateral motion, an oscillation is the Dutch roll, the slower of two real roots the spiral and
    the faster the roll.

    Parameters
    ----------
    A : array_like, shape (4, 4)
        State matrix of `longitudinal_model` or `lateral_model`. [1/s]
    motion : {"longitudinal", "lateral"}
        Which of them.
    tolerance : float
        Imaginary parts below this share of the largest root count as zero. [-]

    Returns
    -------
    modes : tuple of FlightMode
        Ascending in |lambda|.

    Raises
    ------
    ValueError
        If A is not 4 by 4 or the motion unknown.

    References
    ----------
    Bramstång 2015, section 6.2; B. Etkin and L. D. Reid, 1996, sections 6.2 and 6.7.

    Examples
    --------
    >>> A = np.zeros((4, 4)); A[:2, :2], A[2:, 2:] = [[0, 1], [-0.01, -0.01]], [[0, 1], [-4, -2]]
    >>> [mode.name for mode in flight_modes(A)]
    ['phugoid', 'short period']
    """
    A = np.asarray(A, dtype=float)
    if A.shape != (4, 4):
        raise ValueError(f"A must be of shape (4, 4), got {A.shape}")
    if motion not in ("longitudinal", "lateral"):
        raise ValueError(f"motion must be 'longitudinal' or 'lateral', got {motion!r}")
    roots = np.linalg.eigvals(A)
    limit = tolerance * np.abs(roots).max(initial=0.0)
    pairs = sorted((complex(z) for z in roots if z.imag > limit), key=abs)
    single = sorted((complex(z.real) for z in roots if abs(z.imag) <= limit), key=abs)
    pair_names = ["oscillation"] * len(pairs)
    single_names = ["aperiodic"] * len(single)
    if motion == "longitudinal" and len(pairs) == 2:
        pair_names = ["phugoid", "short period"]
    elif motion == "lateral" and len(pairs) == 1:
        pair_names, single_names = ["Dutch roll"], ["spiral", "roll"]
    named = [FlightMode(name=n, eigenvalue=z) for n, z in zip(pair_names + single_names, pairs + single)]
    return tuple(sorted(named, key=lambda mode: abs(mode.eigenvalue)))


def root_movement(
    coefficients: LongitudinalCoefficients,
    airframe: Airframe,
    x_cg: ArrayLike,
    *,
    V: float,
    rho: float,
    gamma: float = 0.0,
    gravity: float = STANDARD_GRAVITY,
) -> RootMovement:
    """Longitudinal roots of a trimmed aircraft as its centre of gravity moves; mass and inertia are kept.

    Parameters
    ----------
    coefficients : LongitudinalCoefficients
        About any point.
    airframe : Airframe
        Mass, I_yy and reference dimensions.
    x_cg : array_like, shape (n,)
        Centres of gravity, aft of the datum, in the order in which to follow the roots. [m]
    V : float
        True airspeed, positive. [m/s]
    rho : float
        Air density, positive. [kg/m^3]
    gamma : float
        Climb angle. [rad]
    gravity : float
        Acceleration of gravity. [m/s^2]

    Returns
    -------
    movement : RootMovement
        The aircraft is trimmed anew at every point.

    Raises
    ------
    ValueError
        If an argument is outside its range or the aircraft cannot be trimmed.

    References
    ----------
    Bramstång 2015, sections 6.1-6.2 and Eq. 6.3.

    Examples
    --------
    >>> wing = LongitudinalCoefficients(CL0=0.0, CL_alpha=4.0, CM0=0.02, CM_alpha=0.0, CL_delta=0.9, CM_delta=-0.3,
    ...                                 CM_q=-1.0, CD0=0.01)
    >>> body = Airframe(mass=10.0, Ixx=1.0, Iyy=0.5, Izz=1.5, chord=0.5)
    >>> moved = root_movement(wing, body, [-0.05, 0.05], V=50.0, rho=1.2)
    >>> moved.static_margin.round(3), bool(moved.roots[0].real.max() < 0.0), bool(moved.roots[1].real.max() > 0.0)
    (array([ 0.1, -0.1]), True, True)
    """
    positions = np.atleast_1d(np.asarray(x_cg, dtype=float))
    roots = np.empty((positions.size, 4), dtype=complex)
    for i, x in enumerate(positions):
        moved = about_centre_of_gravity(coefficients, float(x), airframe.chord)
        trim = trim_level(moved, airframe, V=V, rho=rho, gamma=gamma, gravity=gravity)
        derivatives = longitudinal_derivatives(
            trim_derivatives(moved, airframe, trim), airframe, V=V, rho=rho, theta=gamma, gravity=gravity
        )
        new = np.linalg.eigvals(longitudinal_model(derivatives, airframe, V=V, theta=gamma, gravity=gravity).A)
        if i:
            new = new[linear_sum_assignment(np.abs(roots[i - 1][:, None] - new))[1]]
        else:
            new = new[np.lexsort((-new.imag, np.abs(new)))]
        roots[i] = new
    return RootMovement(
        x_cg=positions, static_margin=static_margin(coefficients, positions, airframe.chord), roots=roots
    )
