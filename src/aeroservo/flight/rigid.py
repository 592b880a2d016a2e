"""Six degrees of freedom of a rigid aircraft over a flat Earth.

Body axes: x forward, y right, z down; Earth axes: north, east, down. Angles phi, theta, psi in the order yaw, pitch,
roll. The state is (u, v, w, p, q, r, phi, theta, psi, x_E, y_E, z_E) on the last axis; leading axes are a batch.
Everything is analytic in the state (no absolute values, no branches), so that a complex step through it gives exact
derivatives.

Singular at theta = +/-90 deg, as any set of three angles is somewhere. Flat, non-rotating Earth, constant gravity.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.atmosphere import STANDARD_GRAVITY

__all__ = [
    "Aerodynamics",
    "Airframe",
    "aircraft_rates",
    "angular_momentum",
    "mechanical_energy",
    "rigid_body_rates",
    "rotation_to_earth",
]

Array = NDArray[Any]


@dataclass(frozen=True, kw_only=True)
class Airframe:
    """Mass, inertia and reference dimensions of an aircraft with a plane of symmetry.

    Attributes
    ----------
    mass : float
        Mass, positive. [kg]
    Ixx, Iyy, Izz : float
        Moments of inertia about the centre of gravity in body (or stability) axes, positive. [kg m^2]
    Ixz : float
        Product of inertia, integral of x z dm. [kg m^2]
    area, chord, span : float
        Reference area [m^2], chord [m] and span [m] of the coefficients, positive.
    """

    mass: float
    Ixx: float
    Iyy: float
    Izz: float
    Ixz: float = 0.0
    area: float = 1.0
    chord: float = 1.0
    span: float = 1.0

    def __post_init__(self) -> None:
        units = {
            "mass": "kg",
            "Ixx": "kg m^2",
            "Iyy": "kg m^2",
            "Izz": "kg m^2",
            "area": "m^2",
            "chord": "m",
            "span": "m",
        }
        for name, unit in units.items():
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} must be positive [{unit}], got {value}")
        if not self.Ixz**2 < self.Ixx * self.Izz:
            raise ValueError(f"Ixz^2 must be below Ixx Izz [kg^2 m^4], got Ixz = {self.Ixz}")

    @property
    def inertia(self) -> Array:
        """Inertia tensor, shape (3, 3). [kg m^2]"""
        return np.array([[self.Ixx, 0.0, -self.Ixz], [0.0, self.Iyy, 0.0], [-self.Ixz, 0.0, self.Izz]])


class Aerodynamics(Protocol):
    """Any callable that gives the forces and moments other than weight, linear in the rate of incidence.

    Returns (force, moment, force per alpha-dot, moment per alpha-dot) in body axes, each of shape (..., 3);
    controls are (elevator, aileron, rudder [rad], thrust increment [N]) on the last axis.
    """

    def __call__(self, state: Array, controls: Array, airframe: Airframe) -> tuple[Array, Array, Array, Array]: ...


def rotation_to_earth(phi: ArrayLike, theta: ArrayLike, psi: ArrayLike) -> Array:
    """Matrix that turns components in body axes into components in Earth axes.

    Parameters
    ----------
    phi, theta, psi : array_like, shape (...)
        Roll, pitch and yaw angle. [rad]

    Returns
    -------
    R : ndarray, shape (..., 3, 3)
        Orthogonal; Earth = R body. [-]

    References
    ----------
    B. Etkin and L. D. Reid, Dynamics of Flight, 3rd ed., 1996, Eq. 4.4,3.

    Examples
    --------
    >>> rotation_to_earth(0.0, 0.0, np.pi / 2).round(12)[1, 0]
    np.float64(1.0)
    """
    phi, theta, psi = np.broadcast_arrays(phi, theta, psi)
    s, c = np.sin, np.cos
    rows = [
        [
            c(theta) * c(psi),
            s(phi) * s(theta) * c(psi) - c(phi) * s(psi),
            c(phi) * s(theta) * c(psi) + s(phi) * s(psi),
        ],
        [
            c(theta) * s(psi),
            s(phi) * s(theta) * s(psi) + c(phi) * c(psi),
            c(phi) * s(theta) * s(psi) - s(phi) * c(psi),
        ],
        [-s(theta), s(phi) * c(theta), c(phi) * c(theta)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def rigid_body_rates(
    state: ArrayLike,
    force: ArrayLike,
    moment: ArrayLike,
    *,
    mass: float,
    inertia: ArrayLike,
    gravity: float = STANDARD_GRAVITY,
) -> Array:
    """Time derivative of the state of a rigid body under a force, a moment and its weight.

    Parameters
    ----------
    state : array_like, shape (..., 12)
        u, v, w [m/s], p, q, r [rad/s], phi, theta, psi [rad], x_E, y_E, z_E [m].
    force, moment : array_like, shape (..., 3)
        Force without weight [N] and moment about the centre of gravity [N m], in body axes.
    mass : float
        Mass. [kg]
    inertia : array_like, shape (3, 3)
        Inertia tensor about the centre of gravity; any tensor, symmetric aircraft or not. [kg m^2]
    gravity : float
        Acceleration of gravity. [m/s^2]

    Returns
    -------
    rate : ndarray, shape (..., 12)
        Derivative of the state; complex if an argument is. [SI, per second]

    References
    ----------
    Bramstång 2015, Eqs. 5.7-5.12 and 5.17; its last three rows are misprinted:
    phi' = p + (q sin phi + r cos phi) tan theta, theta' = q cos phi - r sin phi,
    psi' = (q sin phi + r cos phi)/cos theta (equations.md, "Flight mechanics").

    Examples
    --------
    >>> falling = rigid_body_rates(np.zeros(12), np.zeros(3), np.zeros(3), mass=2.0, inertia=np.eye(3))
    >>> float(falling[2])
    9.80665
    """
    x = np.asarray(state)
    tensor = np.asarray(inertia)
    velocity, omega = x[..., 0:3], x[..., 3:6]
    phi, theta, psi = x[..., 6], x[..., 7], x[..., 8]
    weight = np.stack([-np.sin(theta), np.cos(theta) * np.sin(phi), np.cos(theta) * np.cos(phi)], axis=-1) * gravity
    acceleration = np.asarray(force) / mass + weight - np.cross(omega, velocity)
    momentum = omega @ tensor.T
    turning = np.linalg.solve(tensor, (np.asarray(moment) - np.cross(omega, momentum))[..., None])[..., 0]
    p, q, r = omega[..., 0], omega[..., 1], omega[..., 2]
    nod = q * np.sin(phi) + r * np.cos(phi)
    attitude = np.stack([p + nod * np.tan(theta), q * np.cos(phi) - r * np.sin(phi), nod / np.cos(theta)], axis=-1)
    position = (rotation_to_earth(phi, theta, psi) @ velocity[..., None])[..., 0]
    return np.concatenate(np.broadcast_arrays(acceleration, turning, attitude, position), axis=-1)


def aircraft_rates(
    state: ArrayLike,
    controls: ArrayLike,
    aerodynamics: Aerodynamics,
    airframe: Airframe,
    *,
    gravity: float = STANDARD_GRAVITY,
) -> Array:
    """Time derivative of an aircraft's state, rate-of-incidence forces included.

    Forces that depend on alpha-dot make the equations implicit. They are linear in it, and
    alpha-dot = (u w' - w u')/(u^2 + w^2) is linear in the accelerations, so one division solves them exactly.

    Parameters
    ----------
    state : array_like, shape (..., 12)
        As in `rigid_body_rates`; u must not be zero. [SI]
    controls : array_like, shape (..., 4)
        Elevator, aileron, rudder [rad] and thrust increment [N].
    aerodynamics : Aerodynamics
        Forces and moments but weight.
    airframe : Airframe
        Mass, inertia, reference dimensions.
    gravity : float
        Acceleration of gravity. [m/s^2]

    Returns
    -------
    rate : ndarray, shape (..., 12)
        Derivative of the state. [SI, per second]

    References
    ----------
    Bramstång 2015, Eq. 5.17; B. Etkin and L. D. Reid, 1996, section 4.9 (derivatives with respect to alpha-dot).

    Examples
    --------
    >>> glide = lambda state, controls, airframe: (np.zeros(3),) * 4
    >>> body = Airframe(mass=1.0, Ixx=1.0, Iyy=1.0, Izz=1.0)
    >>> state = np.zeros(12); state[0] = 10.0
    >>> float(aircraft_rates(state, np.zeros(4), glide, body)[2])
    9.80665
    """
    x = np.asarray(state)
    force, moment, force_rate, moment_rate = aerodynamics(x, np.asarray(controls), airframe)
    mass, inertia = airframe.mass, airframe.inertia
    u, w = x[..., 0], x[..., 2]
    plain = rigid_body_rates(x, force, moment, mass=mass, inertia=inertia, gravity=gravity)
    square = u * u + w * w
    alpha_dot = (u * plain[..., 2] - w * plain[..., 0]) / square
    gain = (u * force_rate[..., 2] - w * force_rate[..., 0]) / (square * mass)
    alpha_dot = (alpha_dot / (1.0 - gain))[..., None]
    force, moment = force + force_rate * alpha_dot, moment + moment_rate * alpha_dot
    return rigid_body_rates(x, force, moment, mass=mass, inertia=inertia, gravity=gravity)


def mechanical_energy(state: ArrayLike, *, mass: float, inertia: ArrayLike, gravity: float = STANDARD_GRAVITY) -> Array:
    """Kinetic and potential energy of a rigid body.

    Parameters
    ----------
    state : array_like, shape (..., 12)
        As in `rigid_body_rates`. [SI]
    mass : float
        Mass. [kg]
    inertia : array_like, shape (3, 3)
        Inertia tensor. [kg m^2]
    gravity : float
        Acceleration of gravity. [m/s^2]

    Returns
    -------
    E : ndarray, shape (...)
        m v^2/2 + omega I omega/2 - m g z_E (z down). [J]

    References
    ----------
    H. Goldstein, Classical Mechanics, 2nd ed., 1980, chapter 5: what `rigid_body_rates` keeps without force and moment.

    Examples
    --------
    >>> state = np.zeros(12); state[0] = 3.0
    >>> float(mechanical_energy(state, mass=2.0, inertia=np.eye(3)))
    9.0
    """
    x = np.asarray(state)
    velocity, omega = x[..., 0:3], x[..., 3:6]
    spin = np.sum(omega * (omega @ np.asarray(inertia).T), axis=-1)
    return 0.5 * mass * np.sum(velocity * velocity, axis=-1) + 0.5 * spin - mass * gravity * x[..., 11]


def angular_momentum(state: ArrayLike, inertia: ArrayLike) -> Array:
    """Angular momentum about the centre of gravity, in Earth axes.

    Parameters
    ----------
    state : array_like, shape (..., 12)
        As in `rigid_body_rates`. [SI]
    inertia : array_like, shape (3, 3)
        Inertia tensor. [kg m^2]

    Returns
    -------
    H : ndarray, shape (..., 3)
        R I omega. [kg m^2/s]

    References
    ----------
    H. Goldstein, Classical Mechanics, 2nd ed., 1980, chapter 5: what `rigid_body_rates` keeps without moment.

    Examples
    --------
    >>> state = np.zeros(12); state[3] = 2.0
    >>> angular_momentum(state, np.diag([3.0, 1.0, 1.0]))
    array([6., 0., 0.])
    """
    x = np.asarray(state)
    momentum = x[..., 3:6] @ np.asarray(inertia).T
    return (rotation_to_earth(x[..., 6], x[..., 7], x[..., 8]) @ momentum[..., None])[..., 0]
