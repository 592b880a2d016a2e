"""Where a model leaves its range: Mach number, reduced frequency, small angles, as speeds."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from aeroservo.aeroelastic.roots import slowest
from aeroservo.aeroelastic.static import static
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, RationalAero

MACH = 0.3
"""Above it air forces without compressibility are drawn as beyond their limit. [-]"""

REDUCED_FREQUENCY = 0.2
"""Above it air forces without lags are beyond their limit. [-]"""

SMALL_ANGLE = math.radians(10.0)
"""Largest trim incidence and elastic twist of a linear model. [rad]"""


@dataclass(frozen=True, kw_only=True)
class Validity:
    """A speed beyond which a result is not to be trusted.

    Attributes
    ----------
    speed : float
        True airspeed. [m/s]
    side : {"above", "below"}
        Where the model leaves its range.
    why : str
        Which assumption ends there.
    """

    speed: float
    side: str
    why: str


def validity(model: AeroelasticModel, sweep: FlightCondition, omega: float | None) -> tuple[Validity, ...]:
    """Speeds at which a model leaves its range: Mach 0.3, reduced frequency, small angles.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    sweep : FlightCondition
        Speeds at one density, shape (n_V,). [m/s, kg/m^3]
    omega : float, optional
        Frequency at which it flutters; the lowest elastic one where it does not. [rad/s]

    Returns
    -------
    limits : tuple of Validity
        Within or beyond the sweep. [m/s]

    References
    ----------
    Bramstång 2015, section 3.1 (Mach 0.3); R. L. Bisplinghoff, H. Ashley and R. L. Halfman, Aeroelasticity, 1955,
    section 5-6 (quasi-steady air forces at low reduced frequency).
    """
    found = []
    if np.all(model.aero.mach == 0.0):
        found.append(
            Validity(speed=MACH * float(sweep.a_sound[0]), side="above", why=f"Mach {MACH:g}: incompressible theory")
        )
    omega = omega or slowest(model)
    if isinstance(model.aero, RationalAero) and not len(model.aero.lags):
        found.append(
            Validity(
                speed=omega * model.aero.b / REDUCED_FREQUENCY, side="below",
                why=f"reduced frequency {REDUCED_FREQUENCY:g} of flutter: air forces without lags",
            )
        )  # fmt: skip
    elif not isinstance(model.aero, RationalAero) and model.aero.k[-1] > 0.0 and len(model.aero.k) > 1:
        k = float(model.aero.k[-1])
        found.append(
            Validity(speed=omega * model.aero.b / k, side="below", why=f"reduced frequency {k:g}: the last sample")
        )
    still = static(model, sweep)
    for curve, why in (
        (still.trim_incidence, "trim incidence of 10 deg: small angles"),
        (still.trim_twist, "elastic twist of 10 deg in trim: small angles"),
    ):
        found += _small_angles(sweep.V, np.abs(curve), why)
    return tuple(found)


def _small_angles(V: Array, angle: Array, why: str) -> list[Validity]:
    """Where an angle first falls below its limit with speed, and where it next exceeds it."""
    known = np.flatnonzero(np.isfinite(angle))
    if not known.size:
        return []
    V, angle = V[known], angle[known]
    inside = angle <= SMALL_ANGLE
    if not inside.any():
        return [Validity(speed=float(V[-1]), side="below", why=why)]
    found = []
    first = int(np.argmax(inside))
    if first:
        found.append(Validity(speed=_between(V, angle, first), side="below", why=why))
    later = np.flatnonzero(~inside[first:])
    if later.size:
        found.append(Validity(speed=_between(V, angle, first + int(later[0])), side="above", why=why))
    return found


def _between(V: Array, angle: Array, i: int) -> float:
    """Speed between i - 1 and i at which the angle is at its limit, by a straight line."""
    part = (SMALL_ANGLE - angle[i - 1]) / (angle[i] - angle[i - 1])
    return float(V[i - 1] + part * (V[i] - V[i - 1]))
