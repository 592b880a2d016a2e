"""Linear models of rigid flight about a symmetric trim: longitudinal, lateral, pitch only.

All in stability axes (W_e = 0), from dimensional derivatives. Small disturbances; the two motions do not couple for
an aircraft with a plane of symmetry in wings-level flight.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.atmosphere import STANDARD_GRAVITY
from aeroservo.datatypes import LinearSystem
from aeroservo.flight.derivatives import LateralDerivatives, LongitudinalDerivatives
from aeroservo.flight.rigid import Airframe

__all__ = ["lateral_model", "longitudinal_model", "pitch_model", "pitch_rate_transfer"]

Array = NDArray[Any]


def longitudinal_model(
    derivatives: LongitudinalDerivatives,
    airframe: Airframe,
    *,
    V: float,
    theta: float = 0.0,
    gravity: float = STANDARD_GRAVITY,
) -> LinearSystem:
    """Longitudinal motion (u, w, q, theta) of a rigid aircraft.

    Parameters
    ----------
    derivatives : LongitudinalDerivatives
        Dimensional, in stability axes.
    airframe : Airframe
        Mass and I_yy.
    V : float
        True airspeed u_0 at trim, positive. [m/s]
    theta : float
        Angle of the flight path above the horizon. [rad]
    gravity : float
        Acceleration of gravity. [m/s^2]

    Returns
    -------
    system : LinearSystem
        States u, w [m/s], q [rad/s], theta [rad]; inputs elevator [rad] and thrust [N]; outputs the states.

    Raises
    ------
    ValueError
        If V is not positive, or Z_wdot makes the apparent mass m - Z_wdot not positive.

    References
    ----------
    Bramstång 2015, Eq. 5.19 (stability axes), here also with X_q and X_wdot; B. Etkin and L. D. Reid, 1996,
    Eq. 4.9,18.

    Examples
    --------
    >>> body = Airframe(mass=2.0, Ixx=1.0, Iyy=1.0, Izz=1.0)
    >>> longitudinal_model(LongitudinalDerivatives(Z_w=-4.0), body, V=10.0).A[1].round(6) + 0.0
    array([ 0., -2., 10.,  0.])
    """
    d, m = derivatives, airframe.mass
    _check(V, m, d.Z_wdot)
    inertia = np.diag([m, m - d.Z_wdot, airframe.Iyy, 1.0])
    inertia[0, 1], inertia[2, 1] = -d.X_wdot, -d.M_wdot
    rhs = np.array(
        [
            [d.X_u, d.X_w, d.X_q, -m * gravity * np.cos(theta)],
            [d.Z_u, d.Z_w, d.Z_q + m * V, -m * gravity * np.sin(theta)],
            [d.M_u, d.M_w, d.M_q, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ]
    )
    inputs = np.array([[d.X_delta, 1.0], [d.Z_delta, 0.0], [d.M_delta, 0.0], [0.0, 0.0]])
    names = ("u_m_s", "w_m_s", "q_rad_s", "theta_rad")
    return LinearSystem(
        A=np.linalg.solve(inertia, rhs),
        B=np.linalg.solve(inertia, inputs),
        C=np.eye(4),
        D=np.zeros((4, 2)),
        states=names,
        inputs=("elevator_rad", "thrust_N"),
        outputs=names,
    )


def lateral_model(
    derivatives: LateralDerivatives,
    airframe: Airframe,
    *,
    V: float,
    theta: float = 0.0,
    gravity: float = STANDARD_GRAVITY,
) -> LinearSystem:
    """Lateral motion (v, p, r, phi) of a rigid aircraft.

    Parameters
    ----------
    derivatives : LateralDerivatives
        Dimensional, in stability axes.
    airframe : Airframe
        Mass, I_xx, I_zz and I_xz IN STABILITY AXES.
    V : float
        True airspeed u_0 at trim, positive. [m/s]
    theta : float
        Angle of the flight path above the horizon. [rad]
    gravity : float
        Acceleration of gravity. [m/s^2]

    Returns
    -------
    system : LinearSystem
        States v [m/s], p, r [rad/s], phi [rad]; inputs aileron and rudder [rad]; outputs the states.

    Raises
    ------
    ValueError
        If V is not positive.

    References
    ----------
    Bramstång 2015, Eqs. 5.16-5.17; B. Etkin and L. D. Reid, 1996, Eq. 4.9,19.

    Examples
    --------
    >>> body = Airframe(mass=2.0, Ixx=1.0, Iyy=1.0, Izz=1.0)
    >>> lateral_model(LateralDerivatives(L_p=-3.0), body, V=10.0).A[1] + 0.0
    array([ 0., -3.,  0.,  0.])
    """
    d, m = derivatives, airframe.mass
    _check(V, m, 0.0)
    inertia = np.diag([m, airframe.Ixx, airframe.Izz, 1.0])
    inertia[1, 2] = inertia[2, 1] = -airframe.Ixz
    rhs = np.array(
        [
            [d.Y_v, d.Y_p, d.Y_r - m * V, m * gravity * np.cos(theta)],
            [d.L_v, d.L_p, d.L_r, 0.0],
            [d.N_v, d.N_p, d.N_r, 0.0],
            [0.0, 1.0, np.tan(theta), 0.0],
        ]
    )
    inputs = np.array([[d.Y_aileron, d.Y_rudder], [d.L_aileron, d.L_rudder], [d.N_aileron, d.N_rudder], [0.0, 0.0]])
    names = ("v_m_s", "p_rad_s", "r_rad_s", "phi_rad")
    return LinearSystem(
        A=np.linalg.solve(inertia, rhs),
        B=np.linalg.solve(inertia, inputs),
        C=np.eye(4),
        D=np.zeros((4, 2)),
        states=names,
        inputs=("aileron_rad", "rudder_rad"),
        outputs=names,
    )


def pitch_model(derivatives: LongitudinalDerivatives, airframe: Airframe, *, V: float) -> LinearSystem:
    """Motion (alpha, q, theta) at constant speed from level flight.

    Parameters
    ----------
    derivatives : LongitudinalDerivatives
        Dimensional, in stability axes; those of u and X are not used.
    airframe : Airframe
        Mass and I_yy.
    V : float
        True airspeed u_0 at trim, positive. [m/s]

    Returns
    -------
    system : LinearSystem
        States alpha [rad], q [rad/s], theta [rad]; input elevator [rad]; outputs the states. Theta integrates q: one
        root is 0.

    Raises
    ------
    ValueError
        If V is not positive, or Z_wdot makes the apparent mass m - Z_wdot not positive.

    References
    ----------
    Bramstång 2015, Eq. 5.20 at theta_0 = 0, restated in equations.md: alpha' = Z_w alpha/(m - Z_wdot) +
    (Z_q + m u_0) q/(u_0 (m - Z_wdot)) + Z_delta delta/(u_0 (m - Z_wdot)).

    Examples
    --------
    >>> body = Airframe(mass=2.0, Ixx=1.0, Iyy=1.0, Izz=1.0)
    >>> pitch_model(LongitudinalDerivatives(Z_w=-4.0), body, V=10.0).A[0] + 0.0
    array([-2.,  1.,  0.])
    """
    d = derivatives
    _check(V, airframe.mass, d.Z_wdot)
    apparent = airframe.mass - d.Z_wdot
    alpha = np.array([d.Z_w, (d.Z_q + airframe.mass * V) / V, 0.0, d.Z_delta / V]) / apparent
    q = (np.array([d.M_w * V, d.M_q, 0.0, d.M_delta]) + d.M_wdot * V * alpha) / airframe.Iyy
    rows = np.array([alpha, q, [0.0, 1.0, 0.0, 0.0]])
    names = ("alpha_rad", "q_rad_s", "theta_rad")
    return LinearSystem(
        A=rows[:, :3],
        B=rows[:, 3:],
        C=np.eye(3),
        D=np.zeros((3, 1)),
        states=names,
        inputs=("elevator_rad",),
        outputs=names,
    )


def pitch_rate_transfer(derivatives: LongitudinalDerivatives, airframe: Airframe, *, V: float) -> tuple[Array, Array]:
    """Transfer function from elevator to pitch rate at constant speed.

    Parameters
    ----------
    derivatives : LongitudinalDerivatives
        Dimensional, in stability axes; those of u and X are not used.
    airframe : Airframe
        Mass and I_yy.
    V : float
        True airspeed, positive. [m/s]

    Returns
    -------
    numerator : ndarray, shape (2,)
        Falling powers of s. With Z_wdot = Z_q = M_wdot = M_q = 0: s m M_delta + M_w Z_delta - M_delta Z_w.
    denominator : ndarray, shape (3,)
        The same: s^2 I_y m - s I_y Z_w - m U M_w; the quotient is in 1/s. [SI]

    Raises
    ------
    ValueError
        If V is not positive, or Z_wdot makes the apparent mass m - Z_wdot not positive.

    References
    ----------
    Bramstång 2015, Eqs. 5.30-5.31 ([5.29] prints eta for delta), with the terms that the thesis sets to zero kept.

    Examples
    --------
    >>> body = Airframe(mass=2.0, Ixx=1.0, Iyy=3.0, Izz=1.0)
    >>> pitch_rate_transfer(LongitudinalDerivatives(Z_w=-4.0, M_w=-5.0, M_delta=-7.0), body, V=10.0)
    (array([-14., -28.]), array([  6.,  12., 100.]))
    """
    d, Iy = derivatives, airframe.Iyy
    _check(V, airframe.mass, d.Z_wdot)
    apparent, turn = airframe.mass - d.Z_wdot, airframe.mass * V + d.Z_q
    # (apparent s - Z_w) w - turn q = Z_delta;  -(M_wdot s + M_w) w + (Iy s - M_q) q = M_delta
    numerator = np.array(
        [apparent * d.M_delta + d.M_wdot * d.Z_delta, d.M_w * d.Z_delta - d.M_delta * d.Z_w], dtype=float
    )
    denominator = np.array(
        [apparent * Iy, -apparent * d.M_q - Iy * d.Z_w - turn * d.M_wdot, d.Z_w * d.M_q - turn * d.M_w], dtype=float
    )
    return numerator, denominator


def _check(V: float, mass: float, Z_wdot: float) -> None:
    if not (np.isfinite(V) and V > 0.0):
        raise ValueError(f"airspeed V must be positive [m/s], got {V:g}")
    if not mass - Z_wdot > 0.0:
        raise ValueError(f"Z_wdot must be below the mass, {mass:g} [kg], got {Z_wdot:g}")
