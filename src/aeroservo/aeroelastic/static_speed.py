"""Dynamic pressures at which static equilibrium is lost, and the speeds that go with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.datatypes import AeroelasticModel, FlightCondition

Array = NDArray[Any]


@dataclass(frozen=True, kw_only=True)
class StaticSpeed:
    """A dynamic pressure and the speed that goes with it at one density.

    Attributes
    ----------
    q : float or None
        Dynamic pressure; None where there is none. [Pa]
    V : float or None
        True airspeed. [m/s]
    """

    q: float | None
    V: float | None


def lowest_pressure(K: Array, Q0: Array) -> float | None:
    """Smallest positive real q with det(K - q Q0) = 0, from the eigenvalues 1/q of K^-1 Q0.

    Parameters
    ----------
    K, Q0 : ndarray, shape (n, n)
        Stiffness and steady air forces per dynamic pressure. [SI]

    Returns
    -------
    q : float or None
        None where there is none. [Pa]

    References
    ----------
    equations.md, "Static aeroelasticity" [7.6].

    Examples
    --------
    >>> lowest_pressure(np.array([[4.0]]), np.array([[0.5]]))
    8.0
    """
    if not K.size:
        return None
    inverse = np.linalg.eigvals(np.linalg.solve(K, Q0))
    size = np.abs(inverse).max(initial=0.0)
    real = inverse.real[(np.abs(inverse.imag) <= 1e-9 * size) & (inverse.real > 1e-12 * size)]
    return float(1.0 / real.max()) if real.size else None


def within_limit(q: float | None, model: AeroelasticModel) -> float | None:
    """The pressure, None where it lies beyond what the model's modes resolve.

    Parameters
    ----------
    q : float or None
        Dynamic pressure. [Pa]
    model : AeroelasticModel
        Its `loads.limit` is the bound.

    Returns
    -------
    q : float or None
        As given, or None. [Pa]

    References
    ----------
    equations.md, "Static aeroelasticity" [7.11], "does not diverge" as an answer.

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> within_limit(1e9, build(read("goland"))) is None
    True
    """
    return None if q is None or (model.loads is not None and q > model.loads.limit) else q


def at_own_mach(
    lowest: Callable[[float], float | None], model: AeroelasticModel, condition: FlightCondition
) -> StaticSpeed:
    """Solve q = lowest(Mach of the speed that goes with q) from below; one step where Q has one Mach number.

    Parameters
    ----------
    lowest : callable
        Lowest dynamic pressure [Pa], or None, with the air forces of a Mach number [-].
    model : AeroelasticModel
        For the Mach numbers of its air forces.
    condition : FlightCondition
        One condition, for density and speed of sound.

    Returns
    -------
    speed : StaticSpeed
        None and None where there is none. [Pa, m/s]

    References
    ----------
    contract.md, "divergence_speed_m_s".

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> at_own_mach(lambda mach: 50.0, build(read("goland")), FlightCondition(V=1.0, rho=1.0))
    StaticSpeed(q=50.0, V=10.0)
    """
    rho, a_sound = float(condition.rho), float(condition.a_sound)
    if rho == 0.0:
        return StaticSpeed(q=None, V=None)
    mach = model.aero.mach
    if len(mach) == 1:
        q = lowest(float(mach[0]))
        return StaticSpeed(q=q, V=None if q is None else float(np.sqrt(2.0 * q / rho)))
    from scipy.optimize import brentq

    def excess(V: float) -> float:
        q = lowest(V / a_sound)
        return (np.inf if q is None else q) - 0.5 * rho * V * V

    grid = np.linspace(1e-3 * a_sound, 1.05 * mach[-1] * a_sound, 400)
    values = np.array([excess(V) for V in grid])
    below = np.flatnonzero(values <= 0.0)
    if below.size == 0:
        q = lowest(float(mach[-1]))
        return StaticSpeed(q=q, V=None if q is None else float(np.sqrt(2.0 * q / rho)))
    j = int(below[0])
    V = grid[0] if j == 0 else brentq(lambda v: np.clip(excess(v), -1e30, 1e30), grid[j - 1], grid[j], xtol=1e-12)
    return StaticSpeed(q=0.5 * rho * V * V, V=float(V))
