"""Nonlinear aerodynamic forces of a rigid aircraft, in the form `aircraft_rates` takes them.

`StabilityAxisAero` is an aircraft known by its stability derivatives about one trim; `LiftDragAero` one known by its
lift, drag and pitching-moment coefficients (from polars, a lattice or a tunnel). Both take body axes that lie along
the flight path at trim. Coefficients are linear (drag: quadratic in lift); dynamic pressure and incidence are exact,
so moderate disturbances stay physical. No stall, no Mach number.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.atmosphere import STANDARD_GRAVITY
from aeroservo.flight.derivatives import StabilityDerivatives, _check_flight
from aeroservo.flight.rigid import Airframe
from aeroservo.flight.trim import LongitudinalCoefficients, TrimState

__all__ = ["LiftDragAero", "StabilityAxisAero"]

Array = NDArray[Any]


@dataclass(frozen=True, kw_only=True)
class StabilityAxisAero:
    """Nonlinear forces of an aircraft given by stability derivatives about one trimmed flight.

    Attributes
    ----------
    derivatives : StabilityDerivatives
        Non-dimensional, about the centre of gravity.
    V, rho, theta : float
        Airspeed [m/s], density [kg/m^3] and path angle [rad] of the trim.
    gravity : float
        Acceleration of gravity. [m/s^2]
    """

    derivatives: StabilityDerivatives
    V: float
    rho: float
    theta: float = 0.0
    gravity: float = STANDARD_GRAVITY

    def __post_init__(self) -> None:
        _check_flight(self.V, self.rho)

    def __call__(self, state: Array, controls: Array, airframe: Airframe) -> tuple[Array, Array, Array, Array]:
        """Force [N], moment [N m] and their slopes with alpha-dot [N s], [N m s]; body axes, shape (..., 3).

        Dynamic pressure is that of the true speed; incidence is atan(w/u), sideslip asin(v/V).
        """
        d, V0, c, b = self.derivatives, self.V, airframe.chord, airframe.span
        u, v, w, p, q, r = (state[..., i] for i in range(6))
        delta, aileron, rudder, thrust = (controls[..., i] for i in range(4))
        speed2 = u * u + v * v + w * w
        qS = 0.5 * self.rho * speed2 * airframe.area
        du, alpha, beta = u / V0 - 1.0, np.arctan(w / u), np.arcsin(v / np.sqrt(speed2))
        q_hat, p_hat, r_hat = q * c / (2.0 * V0), p * b / (2.0 * V0), r * b / (2.0 * V0)
        CW = airframe.mass * self.gravity / (0.5 * self.rho * V0**2 * airframe.area)
        CX = CW * np.sin(self.theta) + d.CX_u * du + d.CX_alpha * alpha + d.CX_q * q_hat + d.CX_delta * delta
        CZ = -CW * np.cos(self.theta) + d.CZ_u * du + d.CZ_alpha * alpha + d.CZ_q * q_hat + d.CZ_delta * delta
        CM = d.CM_u * du + d.CM_alpha * alpha + d.CM_q * q_hat + d.CM_delta * delta
        CY = d.CY_beta * beta + d.CY_p * p_hat + d.CY_r * r_hat + d.CY_aileron * aileron + d.CY_rudder * rudder
        Cl = d.Cl_beta * beta + d.Cl_p * p_hat + d.Cl_r * r_hat + d.Cl_aileron * aileron + d.Cl_rudder * rudder
        Cn = d.Cn_beta * beta + d.Cn_p * p_hat + d.Cn_r * r_hat + d.Cn_aileron * aileron + d.Cn_rudder * rudder
        slope, zero = qS * c / (2.0 * V0), np.zeros_like(qS)
        return (
            np.stack([qS * CX + thrust, qS * CY, qS * CZ], axis=-1),
            np.stack([qS * b * Cl, qS * c * CM, qS * b * Cn], axis=-1),
            np.stack([slope * d.CX_alphadot, zero, slope * d.CZ_alphadot], axis=-1),
            np.stack([zero, slope * c * d.CM_alphadot, zero], axis=-1),
        )


@dataclass(frozen=True, kw_only=True)
class LiftDragAero:
    """Nonlinear longitudinal forces of an aircraft given by its coefficients, in stability axes of a trim.

    Thrust is constant and acts through the centre of gravity along the stability x axis. There are no lateral forces.

    Attributes
    ----------
    coefficients : LongitudinalCoefficients
        About the centre of gravity.
    trim : TrimState
        One trim (scalars): its incidence is that of the stability x axis, its thrust and elevon are the zero of the
        controls.
    """

    coefficients: LongitudinalCoefficients
    trim: TrimState

    def __call__(self, state: Array, controls: Array, airframe: Airframe) -> tuple[Array, Array, Array, Array]:
        """Force [N], moment [N m] and their slopes with alpha-dot [N s], [N m s]; body axes, shape (..., 3)."""
        k, trim, c = self.coefficients, self.trim, airframe.chord
        u, v, w, q = state[..., 0], state[..., 1], state[..., 2], state[..., 4]
        speed2 = u * u + v * v + w * w
        speed = np.sqrt(speed2)
        qS = 0.5 * trim.rho * speed2 * airframe.area
        path = np.arctan(w / u)
        alpha, delta = trim.alpha + path, trim.delta + controls[..., 0]
        q_hat = q * c / (2.0 * speed)
        static = k.CL0 + k.CL_alpha * alpha + k.CL_delta * delta
        CL, CD = static + k.CL_q * q_hat, k.CD0 + k.CD_CL2 * static * static
        CM = k.CM0 + k.CM_alpha * alpha + k.CM_delta * delta + k.CM_q * q_hat
        X = qS * (CL * np.sin(path) - CD * np.cos(path)) + trim.thrust + controls[..., 3]
        Z = -qS * (CL * np.cos(path) + CD * np.sin(path))
        slope, zero = qS * c / (2.0 * speed), np.zeros_like(qS)
        return (
            np.stack([X, zero, Z], axis=-1),
            np.stack([zero, qS * c * CM, zero], axis=-1),
            slope[..., None] * k.CL_alphadot * np.stack([np.sin(path), zero, -np.cos(path)], axis=-1),
            np.stack([zero, slope * c * k.CM_alphadot, zero], axis=-1),
        )
