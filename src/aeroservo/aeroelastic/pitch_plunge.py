"""From a file of kind `pitch_plunge_flap` to an AeroelasticModel: springs, derivatives, servo, weight, stall."""

from __future__ import annotations

import math

from aeroservo.aero.derivatives_air import WingDerivatives, derivative_air
from aeroservo.aeroelastic.wing_servo import actuator, sensor
from aeroservo.aircraft.schema_other import PitchPlungeFlap
from aeroservo.atmosphere import STANDARD_GRAVITY
from aeroservo.datatypes import AeroelasticModel, Spring
from aeroservo.servo import Gravity, LiftCurve, Limit
from aeroservo.structure.pitch_plunge import pitch_plunge


def pitch_plunge_model(file: PitchPlungeFlap) -> AeroelasticModel:
    """Couple structure and derivatives of a `pitch_plunge_flap` file.

    Parameters
    ----------
    file : PitchPlungeFlap
        From `aeroservo.read`.

    Returns
    -------
    model : AeroelasticModel
        Coordinates plunge [m, down] and pitch [rad, nose up], control elevon [rad, trailing edge down].

    Raises
    ------
    ValueError
        If the first coefficient of a spring polynomial is negative.

    References
    ----------
    contract.md, kind "pitch_plunge_flap"; equations.md, "Simulation model [7.47-7.58 and appendix .3]".

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> pitch_plunge_model(read("bact")).modes.names
    ('plunge', 'pitch')
    """
    m = file.model
    n = file.nonlinear
    stiffness = {"plunge": m.K_h_N_m, "pitch": m.K_theta_N_m_rad}
    springs: tuple[Spring, ...] = ()
    linear = (1.0, 1.0)
    if n is not None:
        polynomials = {"plunge": n.plunge_stiffness_polynomial, "pitch": n.pitch_stiffness_polynomial}
        linear = (polynomials["plunge"][0], polynomials["pitch"][0])
        if min(linear) < 0.0:
            raise ValueError(f"the first coefficient of a stiffness polynomial must not be negative [-], got {linear}")
        gaps = {"plunge": 0.0, "pitch": n.freeplay_rad}
        springs = tuple(
            Spring(mode=name, polynomial=polynomials[name], freeplay=gaps[name], stiffness=stiffness[name])
            for name in stiffness
            if polynomials[name] != (1.0,) or gaps[name]
        )
    modes = pitch_plunge(
        mass=m.m_kg,
        static_moment=m.S_htheta_kg_m,
        inertia=m.I_theta_kg_m2,
        plunge_stiffness=m.K_h_N_m * linear[0],
        pitch_stiffness=m.K_theta_N_m_rad * linear[1],
        plunge_damping=m.zeta_h,
        pitch_damping=m.zeta_theta,
        control_moments=(m.S_hdelta, m.S_thetadelta),
    )
    aero, loads = derivative_air(wing_derivatives(file))
    weight = STANDARD_GRAVITY * math.cos(m.theta_trim_rad)
    return AeroelasticModel(
        modes=modes,
        aero=aero,
        name=file.name,
        loads=loads,
        springs=springs,
        mass=m.m_kg,
        actuators=() if file.actuator is None else (actuator(file.actuator, "elevon"),),
        sensors=tuple(sensor(s, (1.0, s.x_m), (0.0, 1.0)) for s in file.sensor),
        lift_curve=_lift_curve(file),
        gravity=Gravity(steady=(m.m_kg * weight, 0.0), turning=(0.0, m.S_htheta_kg_m * weight), mode="pitch"),
        incidence=m.theta_trim_rad,
        limits=_limits(file),
    )


def wing_derivatives(file: PitchPlungeFlap) -> WingDerivatives:
    """The derivatives of a file under the names of the theory.

    Parameters
    ----------
    file : PitchPlungeFlap
        From `aeroservo.read`.

    Returns
    -------
    wing : WingDerivatives
        About the pitch axis. [1/rad]

    References
    ----------
    contract.md, kind "pitch_plunge_flap".

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> wing_derivatives(read("bact")).CL_alpha
    4.584
    """
    m = file.model
    return WingDerivatives(
        S=m.S_m2,
        c=m.c_m,
        l=m.l_m,
        CL_alpha=m.CL_alpha,
        CM_alpha=m.CM_alpha,
        CL_delta=m.CL_delta,
        CM_delta=m.CM_delta,
        CL_q=m.CL_q,
        CM_q=m.CM_q,
        CL_alphadot=m.CL_alphadot,
        CM_alphadot=m.CM_alphadot,
        CL_deltadot=m.CL_deltadot,
        CM_deltadot=m.CM_deltadot,
        CL0=m.CL0,
        CM0=m.CM0,
    )


def _lift_curve(file: PitchPlungeFlap) -> LiftCurve | None:
    """Lift acts through the same aerodynamic centre with and without stall: the moment goes with it."""
    if file.nonlinear is None or file.nonlinear.CL_alpha_table is None:
        return None
    m, table = file.model, file.nonlinear.CL_alpha_table
    arm = m.CM_alpha / m.CL_alpha if m.CL_alpha else 0.0
    b = 0.5 * m.c_m
    return LiftCurve(
        alpha=tuple(math.radians(row[0]) for row in table),
        CL=tuple(row[1] for row in table),
        CL0=m.CL0,
        CL_alpha=m.CL_alpha,
        direction=(-m.S_m2, m.S_m2 * m.c_m * arm),
        displacement=(0.0, 1.0),
        rate=(1.0 / b, m.l_m / b),
    )


def _limits(file: PitchPlungeFlap) -> tuple[Limit, ...]:
    """Largest plunge and pitch."""
    if file.limits is None:
        return ()
    pitch = None if file.limits.pitch_deg is None else math.radians(file.limits.pitch_deg)
    return tuple(
        Limit(mode=name, largest=value)
        for name, value in (("plunge", file.limits.plunge_m), ("pitch", pitch))
        if value is not None
    )
