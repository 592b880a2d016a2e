"""Stability derivatives of an aircraft about a trimmed flight, with and without dimensions.

Stability axes: body axes whose x axis lies along the flight path at trim (W_e = 0). Non-dimensional derivatives are
per radian or per reduced rate (q c/(2V), p b/(2V), alpha-dot c/(2V)) and per u/u_0; forces X, Y, Z are along body axes
and their coefficients are those of Etkin and Reid: C_X, C_Z contain the thrust, and are about the CENTRE OF GRAVITY.
Valid for small disturbances; `StabilityAxisAero` in `forces.py` makes nonlinear forces of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.atmosphere import STANDARD_GRAVITY
from aeroservo.flight.rigid import Airframe

__all__ = [
    "LateralDerivatives",
    "LongitudinalDerivatives",
    "StabilityDerivatives",
    "flying_wing_derivatives",
    "lateral_derivatives",
    "longitudinal_derivatives",
]


@dataclass(frozen=True, kw_only=True)
class StabilityDerivatives:
    """Non-dimensional derivatives in stability axes about the centre of gravity; those not given are 0.

    Attributes
    ----------
    CX_u, CX_alpha, CX_alphadot, CX_q, CX_delta : float
        Forward force; _u per u/u_0, _alphadot per alpha-dot c/(2V), _q per q c/(2V), _delta per rad of elevator. [-]
    CZ_u, CZ_alpha, CZ_alphadot, CZ_q, CZ_delta : float
        Downward force: CZ_alpha = -(CL_alpha + CD). [-]
    CM_u, CM_alpha, CM_alphadot, CM_q, CM_delta : float
        Pitching moment, nose up, by the chord. [-]
    CY_beta, CY_p, CY_r, CY_aileron, CY_rudder : float
        Side force, to starboard; rates by b/(2V). [-]
    Cl_beta, Cl_p, Cl_r, Cl_aileron, Cl_rudder : float
        Rolling moment, starboard wing down, by the span. [-]
    Cn_beta, Cn_p, Cn_r, Cn_aileron, Cn_rudder : float
        Yawing moment, nose to starboard, by the span. [-]
    """

    CX_u: float = 0.0
    CX_alpha: float = 0.0
    CX_alphadot: float = 0.0
    CX_q: float = 0.0
    CX_delta: float = 0.0
    CZ_u: float = 0.0
    CZ_alpha: float = 0.0
    CZ_alphadot: float = 0.0
    CZ_q: float = 0.0
    CZ_delta: float = 0.0
    CM_u: float = 0.0
    CM_alpha: float = 0.0
    CM_alphadot: float = 0.0
    CM_q: float = 0.0
    CM_delta: float = 0.0
    CY_beta: float = 0.0
    CY_p: float = 0.0
    CY_r: float = 0.0
    CY_aileron: float = 0.0
    CY_rudder: float = 0.0
    Cl_beta: float = 0.0
    Cl_p: float = 0.0
    Cl_r: float = 0.0
    Cl_aileron: float = 0.0
    Cl_rudder: float = 0.0
    Cn_beta: float = 0.0
    Cn_p: float = 0.0
    Cn_r: float = 0.0
    Cn_aileron: float = 0.0
    Cn_rudder: float = 0.0


@dataclass(frozen=True, kw_only=True)
class LongitudinalDerivatives:
    """Dimensional longitudinal derivatives in stability axes.

    Attributes
    ----------
    X_u, X_w, Z_u, Z_w : float
        [N s/m]
    X_q, Z_q, M_u, M_w : float
        [N s/rad] and [N m s/m], that is [N s].
    X_wdot, Z_wdot : float
        [N s^2/m] = [kg]
    M_q : float
        [N m s/rad]
    M_wdot : float
        [N m s^2/m] = [kg m]
    X_delta, Z_delta, M_delta : float
        Per radian of elevator. [N/rad], [N m/rad]
    """

    X_u: float = 0.0
    X_w: float = 0.0
    X_wdot: float = 0.0
    X_q: float = 0.0
    X_delta: float = 0.0
    Z_u: float = 0.0
    Z_w: float = 0.0
    Z_wdot: float = 0.0
    Z_q: float = 0.0
    Z_delta: float = 0.0
    M_u: float = 0.0
    M_w: float = 0.0
    M_wdot: float = 0.0
    M_q: float = 0.0
    M_delta: float = 0.0


@dataclass(frozen=True, kw_only=True)
class LateralDerivatives:
    """Dimensional lateral derivatives in stability axes.

    Attributes
    ----------
    Y_v : float
        [N s/m]
    Y_p, Y_r, L_v, N_v : float
        [N s]
    L_p, L_r, N_p, N_r : float
        [N m s/rad]
    Y_aileron, Y_rudder : float
        [N/rad]
    L_aileron, L_rudder, N_aileron, N_rudder : float
        [N m/rad]
    """

    Y_v: float = 0.0
    Y_p: float = 0.0
    Y_r: float = 0.0
    Y_aileron: float = 0.0
    Y_rudder: float = 0.0
    L_v: float = 0.0
    L_p: float = 0.0
    L_r: float = 0.0
    L_aileron: float = 0.0
    L_rudder: float = 0.0
    N_v: float = 0.0
    N_p: float = 0.0
    N_r: float = 0.0
    N_aileron: float = 0.0
    N_rudder: float = 0.0


def longitudinal_derivatives(
    derivatives: StabilityDerivatives,
    airframe: Airframe,
    *,
    V: float,
    rho: float,
    theta: float = 0.0,
    gravity: float = STANDARD_GRAVITY,
) -> LongitudinalDerivatives:
    """Dimensional longitudinal derivatives of an aircraft in trimmed flight.

    Parameters
    ----------
    derivatives : StabilityDerivatives
        Non-dimensional, in stability axes about the centre of gravity.
    airframe : Airframe
        Mass and reference dimensions.
    V : float
        True airspeed u_0 at trim, positive. [m/s]
    rho : float
        Air density, positive. [kg/m^3]
    theta : float
        Angle of the flight path (and of the stability x axis) above the horizon. [rad]
    gravity : float
        Acceleration of gravity. [m/s^2]

    Returns
    -------
    dimensional : LongitudinalDerivatives

    Raises
    ------
    ValueError
        If V or rho is not positive.

    References
    ----------
    B. Etkin and L. D. Reid, Dynamics of Flight, 3rd ed., 1996, Table 4.4, with C_X0 = C_W0 sin(theta_0) and
    C_Z0 = -C_W0 cos(theta_0).

    Examples
    --------
    >>> wing = Airframe(mass=10.0, Ixx=1.0, Iyy=0.5, Izz=1.5, area=1.0, chord=0.5)
    >>> longitudinal_derivatives(StabilityDerivatives(CZ_alpha=-4.0), wing, V=50.0, rho=1.2).Z_w
    -120.0
    """
    _check_flight(V, rho)
    d, S, c = derivatives, airframe.area, airframe.chord
    force, weight = 0.5 * rho * V * S, airframe.mass * gravity
    arm, slow = 0.5 * c * force, 0.5 * c * force / V
    return LongitudinalDerivatives(
        X_u=2.0 * weight * np.sin(theta) / V + force * d.CX_u,
        X_w=force * d.CX_alpha,
        X_wdot=slow * d.CX_alphadot,
        X_q=arm * d.CX_q,
        X_delta=V * force * d.CX_delta,
        Z_u=-2.0 * weight * np.cos(theta) / V + force * d.CZ_u,
        Z_w=force * d.CZ_alpha,
        Z_wdot=slow * d.CZ_alphadot,
        Z_q=arm * d.CZ_q,
        Z_delta=V * force * d.CZ_delta,
        M_u=c * force * d.CM_u,
        M_w=c * force * d.CM_alpha,
        M_wdot=c * slow * d.CM_alphadot,
        M_q=c * arm * d.CM_q,
        M_delta=c * V * force * d.CM_delta,
    )


def lateral_derivatives(
    derivatives: StabilityDerivatives, airframe: Airframe, *, V: float, rho: float
) -> LateralDerivatives:
    """Dimensional lateral derivatives of an aircraft in trimmed symmetric flight.

    Parameters
    ----------
    derivatives : StabilityDerivatives
        Non-dimensional, in stability axes about the centre of gravity.
    airframe : Airframe
        Reference dimensions.
    V : float
        True airspeed u_0 at trim, positive. [m/s]
    rho : float
        Air density, positive. [kg/m^3]

    Returns
    -------
    dimensional : LateralDerivatives

    Raises
    ------
    ValueError
        If V or rho is not positive.

    References
    ----------
    B. Etkin and L. D. Reid, Dynamics of Flight, 3rd ed., 1996, Table 4.5.

    Examples
    --------
    >>> wing = Airframe(mass=10.0, Ixx=1.0, Iyy=0.5, Izz=1.5, area=1.0, span=2.0)
    >>> lateral_derivatives(StabilityDerivatives(Cl_p=-0.5), wing, V=50.0, rho=1.2).L_p
    -30.0
    """
    _check_flight(V, rho)
    d, b = derivatives, airframe.span
    force = 0.5 * rho * V * airframe.area
    rate, full = 0.5 * b * force, V * force
    return LateralDerivatives(
        Y_v=force * d.CY_beta,
        Y_p=rate * d.CY_p,
        Y_r=rate * d.CY_r,
        Y_aileron=full * d.CY_aileron,
        Y_rudder=full * d.CY_rudder,
        L_v=b * force * d.Cl_beta,
        L_p=b * rate * d.Cl_p,
        L_r=b * rate * d.Cl_r,
        L_aileron=b * full * d.Cl_aileron,
        L_rudder=b * full * d.Cl_rudder,
        N_v=b * force * d.Cn_beta,
        N_p=b * rate * d.Cn_p,
        N_r=b * rate * d.Cn_r,
        N_aileron=b * full * d.Cn_aileron,
        N_rudder=b * full * d.Cn_rudder,
    )


def flying_wing_derivatives(
    *,
    V: float,
    rho: float,
    area: float,
    chord: float,
    lift_slope: float,
    drag: float,
    l_w: float,
    CL_delta: float,
    CM_delta: float,
    CM_q: float,
) -> LongitudinalDerivatives:
    """Derivatives of a flying wing in the thesis' short form: no tail, no rate of incidence, no lift by pitch rate.

    The thesis sets M_q = 0 as well. That is poor here (C_Mq is about -0.85 for its own wing), so it must be given.

    Parameters
    ----------
    V : float
        True airspeed, positive. [m/s]
    rho : float
        Air density, positive. [kg/m^3]
    area, chord : float
        Wing area [m^2] and mean chord [m].
    lift_slope : float
        a_w. [1/rad]
    drag : float
        Drag coefficient at trim. [-]
    l_w : float
        x_cg - x_ac, positive when the centre of gravity lies AFT of the aerodynamic centre. [m]
    CL_delta, CM_delta : float
        Elevon lift, up, and moment about the centre of gravity, nose up. [1/rad]
    CM_q : float
        Pitch damping per q c/(2V). [-]

    Returns
    -------
    dimensional : LongitudinalDerivatives
        Only Z_w, Z_delta, M_w, M_q, M_delta.

    Raises
    ------
    ValueError
        If V or rho is not positive.

    References
    ----------
    Bramstång 2015, Eqs. 5.24-5.27 without tail, corrected as in equations.md, "Flight mechanics".

    Examples
    --------
    >>> d = flying_wing_derivatives(V=50.0, rho=1.2, area=1.0, chord=0.5, lift_slope=4.0, drag=0.0, l_w=0.1,
    ...                             CL_delta=0.8, CM_delta=-0.3, CM_q=-0.85)
    >>> d.Z_w, round(d.M_w, 9)
    (-120.0, 12.0)
    """
    _check_flight(V, rho)
    force = 0.5 * rho * V * area
    return LongitudinalDerivatives(
        Z_w=-force * (lift_slope + drag),
        Z_delta=-V * force * CL_delta,
        M_w=force * lift_slope * l_w,
        M_q=0.5 * force * chord**2 * CM_q,
        M_delta=V * force * chord * CM_delta,
    )


def _check_flight(V: float, rho: float) -> None:
    for name, unit, value in (("airspeed V", "m/s", V), ("density rho", "kg/m^3", rho)):
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} must be positive [{unit}], got {value:g}")
