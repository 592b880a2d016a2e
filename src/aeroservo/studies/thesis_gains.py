"""The thesis' wing on springs under control: its LQR, its switch, and a schedule with the servo inside.

Two ways stand side by side. The thesis' way: continuous feedback of the whole state without actuator, gains from
Q = I, R = 1 at 55 m/s. The sounder way: gains designed at every speed with a servo of 60 rad/s inside, sampled at
200 Hz with one sample of delay, elevons limited to 20 degrees and 400 degrees a second (`climb_flight`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.linear import linear_system
from aeroservo.aircraft.files import read
from aeroservo.control.controller import Controller
from aeroservo.control.lqr import FULL_STATE, LQR
from aeroservo.control.plant import design_plant
from aeroservo.control.schedule import switched
from aeroservo.control.zeros import transmission_zeros
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition
from aeroservo.servo import Limit
from aeroservo.simulate.engine import linearised
from aeroservo.studies.climb_flight import LOST, RATE_HZ, climb_model

HIGH = 3048.0
"""10,000 ft. [m]"""
DESIGN_SPEED, SWITCH_SPEED = 55.0, 50.0
"""Of the thesis' LQR, and where its adaptive controller takes over. [m/s]"""
PITCH_LIMIT, PLUNGE_LIMIT = LOST["pitch"], LOST["plunge"]
"""Beyond these an aircraft counts as lost. [rad, m]"""
STATES = ("plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s")
GAINS = ("h", "theta", "h'", "theta'")
BELOW = 40.0
"""Speeds from here on are looked at for changes of sign: below, the gains are small. [m/s]"""
LQR_THESIS = LQR(Q=np.ones(4), R=np.ones(1))
CHECKED_SPEEDS = np.arange(15.0, 130.1, 2.5)
"""At which frozen loops are looked at, and between. [m/s]"""


def bare_wing() -> AeroelasticModel:
    """The simulation model without actuator, linear, lost beyond 20 degrees or 3 m.

    Returns
    -------
    model : AeroelasticModel
        Preset `thesis-simulation`. [SI]
    """
    limits = (Limit(mode="pitch", largest=PITCH_LIMIT), Limit(mode="plunge", largest=PLUNGE_LIMIT))
    return replace(linearised(build(read("thesis-simulation"))), limits=limits)


def gain_at(model: AeroelasticModel, V: float, altitude: float = HIGH) -> Array:
    """The thesis' LQR, Q = I, R = 1 on [h, theta, h', theta'], continuous.

    Parameters
    ----------
    model : AeroelasticModel
        Without actuator.
    V : float
        True airspeed of the design. [m/s]
    altitude : float
        Geopotential. [m]

    Returns
    -------
    K : ndarray, shape (1, 4)
        u = -K x. [SI]
    """
    return LQR_THESIS(design_plant(model, FlightCondition.at(altitude, V=V), actuators=False)).K


def closed_matrices(model: AeroelasticModel, K: Array, V: Array, altitude: float) -> Array:
    """Closed-loop matrices of state feedback without actuator, over speeds.

    Parameters
    ----------
    model : AeroelasticModel
        The wing.
    K : ndarray, shape (1, 4)
        Gain, u = -K x. [SI]
    V : ndarray, shape (n,)
        True airspeeds. [m/s]
    altitude : float
        Geopotential. [m]

    Returns
    -------
    A : ndarray, shape (n, 4, 4)
        A - B K. [SI]
    """
    system = linear_system(model, FlightCondition.at(altitude, V=V), actuators=False)
    return system.A - system.B[..., :1] @ K


def lost_at(model: AeroelasticModel, K: Array, altitude: float) -> tuple[float, complex]:
    """First speed above that of the design at which a gain no longer stabilises, and the root that crosses.

    Parameters
    ----------
    model : AeroelasticModel
        Without actuator.
    K : ndarray, shape (1, 4)
        Gain, u = -K x. [SI]
    altitude : float
        Geopotential. [m]

    Returns
    -------
    V, root : float, complex
        True airspeed and root, nan where it holds to 150 m/s. [m/s, 1/s]
    """
    V = np.arange(40.0, 150.01, 0.25)
    growth = np.linalg.eigvals(closed_matrices(model, K, V, altitude)).real.max(axis=1)
    i = int(np.argmax(growth > 0.0))
    if not growth[i] > 0.0:
        return float("nan"), complex("nan")
    low, high = V[i - 1], V[i]
    for _ in range(50):
        middle = 0.5 * (low + high)
        unstable = np.linalg.eigvals(closed_matrices(model, K, np.array([middle]), altitude)).real.max() > 0.0
        low, high = (low, middle) if unstable else (middle, high)
    roots = np.linalg.eigvals(closed_matrices(model, K, np.array([high]), altitude))[0]
    return float(high), complex(roots[int(np.argmax(roots.real))])


def growth_with_gains(model: AeroelasticModel, gain: Array, V: Array) -> tuple[Array, dict[str, Array]]:
    """Gains designed at each speed, and growth with several of them, 10,000 ft.

    Parameters
    ----------
    model : AeroelasticModel
        Without actuator.
    gain : ndarray, shape (1, 4)
        That of 55 m/s. [SI]
    V : ndarray, shape (n,)
        True airspeeds. [m/s]

    Returns
    -------
    K, growth : ndarray and dict of str to ndarray, shapes (n, 4) and (n,)
        Gains, and largest real parts. [SI, 1/s]
    """
    condition = FlightCondition.at(HIGH, V=V)
    K = np.stack([gain_at(model, float(v))[0] for v in V])
    system = linear_system(model, condition, actuators=False)
    own = K[:, None, :]
    cases = {
        "open": 0.0 * own,
        "designed here": own,
        "gain of 55 m/s": gain,
        "that gain reversed": -gain,
        "designed here, reversed": -own,
    }
    return K, {name: np.linalg.eigvals(system.A - system.B[..., :1] @ k).real.max(axis=-1) for name, k in cases.items()}


def root_with_servo(gain: Array) -> complex:
    """What the thesis' gain does with the servo inside, at its own design point.

    Parameters
    ----------
    gain : ndarray, shape (1, 4)
        u = -K x. [SI]

    Returns
    -------
    root : complex
        The fastest growing one. [1/s]
    """
    system = design_plant(climb_model(), FlightCondition.at(HIGH, V=DESIGN_SPEED))
    rows = [system.outputs.index(name) for name in STATES]
    roots = np.linalg.eigvals(system.A - system.B[:, :1] @ gain @ system.C[rows])
    return complex(roots[int(np.argmax(roots.real + 1e-9 * roots.imag))])


def elevon_effect(V: Array) -> dict[str, Array]:
    """Lift and moment per elevon angle, with the pitch that the spring allows.

    Parameters
    ----------
    V : ndarray, shape (n,)
        True airspeeds, 10,000 ft. [m/s]

    Returns
    -------
    effect : dict of str to ndarray, shape (n,)
        "lift" and "rigid lift" [N/rad]; "moment" about the pitch axis [N m/rad]; "lift with the lattice's CM_delta"
        [N/rad].

    References
    ----------
    equations.md, "Reversal" (simulation model); Bramstång 2015, Figure 37.
    """
    file = read("thesis-simulation")
    m = file.model  # type: ignore[attr-defined]
    qS = FlightCondition.at(HIGH, V=V).q * m.S_m2

    def lift(CM_delta: float) -> tuple[Array, Array]:
        pitch = qS * m.c_m * CM_delta / (m.K_theta_N_m_rad - qS * m.c_m * m.CM_alpha)
        return qS * (m.CL_delta + m.CL_alpha * pitch), qS * m.c_m * (CM_delta + m.CM_alpha * pitch)

    elastic, moment = lift(m.CM_delta)
    other = file.comparison.CM_delta  # type: ignore[attr-defined]
    return {
        "lift": elastic,
        "rigid lift": qS * m.CL_delta,
        "moment": moment,
        "lift with the lattice's CM_delta": lift(other)[0],
    }


def thesis_switch(model: AeroelasticModel, V: float) -> Controller:
    """The thesis' adaptive controller: its LQR to 50 m/s, from there on a gain for higher speeds.

    The thesis found the second gain by hand and does not print it; here it is an LQR for `V`.

    Parameters
    ----------
    model : AeroelasticModel
        Without actuator.
    V : float
        Speed of the second design. [m/s]

    Returns
    -------
    controller : Controller
        Sampled at 200 Hz, no delay. [SI]
    """
    found = []
    for speed, design in ((DESIGN_SPEED, LQR_THESIS), (V, FULL_STATE)):
        plant = design_plant(model, FlightCondition.at(HIGH, V=speed), rate_Hz=RATE_HZ, actuators=False, sensors=STATES)
        found.append(design(plant).as_controller())
    return switched(found[0], found[1], float(FlightCondition.at(HIGH, V=SWITCH_SPEED).q))


def poles_and_zeros(model: AeroelasticModel, gain: Array, V: float) -> tuple[Array, dict[str, Array]]:
    """Poles of the loop closed by a gain, and zeros of its plant: feedback moves poles, not zeros.

    Parameters
    ----------
    model : AeroelasticModel
        Without actuator.
    gain : ndarray, shape (1, 4)
        u = -K x. [SI]
    V : float
        True airspeed, 10,000 ft. [m/s]

    Returns
    -------
    poles, zeros : complex ndarray and dict of str to complex ndarray, shapes (4,) and (n,)
        Zeros from the elevon to "plunge" and "pitch". [1/s]
    """
    poles = np.linalg.eigvals(closed_matrices(model, gain, np.array([V]), HIGH))[0]
    plant = design_plant(model, FlightCondition.at(HIGH, V=V), actuators=False)
    names = {"plunge": "plunge_m", "pitch": "pitch_rad"}
    return poles, {
        word: transmission_zeros(plant, input=plant.inputs[0], output=channel) for word, channel in names.items()
    }


def sign_changes(V: Array, gains: Array) -> tuple[list[bool], dict[str, float]]:
    """Which of the LQR gains designed at each speed change their sign on the way up, and where.

    Parameters
    ----------
    V : ndarray, shape (n,)
        True airspeeds. [m/s]
    gains : ndarray, shape (n, 4)
        At each of them. [SI]

    Returns
    -------
    changed, where : list of bool, dict of str to float
        For h, theta, h', theta'; the speed of the last change. [m/s]
    """
    V, K = V[V >= BELOW], gains[V >= BELOW]
    turns = np.sign(K[1:]) != np.sign(K[:-1])
    changed = [bool(x) for x in turns.any(axis=0)]
    return changed, {
        name: float(V[1:][turns[:, j]][-1]) for j, (name, moved) in enumerate(zip(GAINS, changed)) if moved
    }
