"""Creep of a viscoelastic wing in steady air: the elastic wing it is at once, the relaxed one it becomes, and when.

Inertia and unsteady air are left out: relaxation is taken as slow against the modes. Linear: twists stay small.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from aeroservo.aeroelastic.linear import displacement_free
from aeroservo.aeroelastic.stability import Boundary
from aeroservo.aeroelastic.static import divergence, elastic_stiffness, reversal
from aeroservo.aeroelastic.static_speed import StaticSpeed
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, ModalModel
from aeroservo.structure.modal import tip_motion

POINTS = 400
"""Times at which the creep is looked at before the first passage is refined."""

LONGEST = 1e3
"""Creep is followed for so many of its longest time constants."""

NEAR = 0.7
"""Least part of the speed at which a slow root is seen to grow, at which it may have begun to."""

SLOWEST = 1e-9
"""A growth slower than this part of the slowest relaxation counts as no faster than that."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CreepSpeeds:
    """Divergence and reversal of a viscoelastic wing at once (glassy) and in the long run (relaxed).

    Attributes
    ----------
    glassy_divergence, relaxed_divergence : StaticSpeed
        Between them a disturbed wing is held at first and twists on for ever: creep divergence. [Pa, m/s]
    glassy_reversal, relaxed_reversal : StaticSpeed
        Of the first control. [Pa, m/s]
    """

    glassy_divergence: StaticSpeed
    relaxed_divergence: StaticSpeed
    glassy_reversal: StaticSpeed
    relaxed_reversal: StaticSpeed


def glassy(model: AeroelasticModel) -> AeroelasticModel:
    """The elastic model on the instantaneous stiffness.

    Parameters
    ----------
    model : AeroelasticModel
        Any.

    Returns
    -------
    model : AeroelasticModel
        The same where nothing relaxes.

    References
    ----------
    Christensen, Theory of Viscoelasticity, 1982, section 1.6 (glassy and rubbery limits).

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> glassy(build(read("goland"))).modes.relaxing
    ()
    """
    return _with(model, lambda modes: replace(modes, relaxing=()))


def relaxed(model: AeroelasticModel) -> AeroelasticModel:
    """The elastic model on the long-term stiffness, in the same modes.

    Parameters
    ----------
    model : AeroelasticModel
        Any.

    Returns
    -------
    model : AeroelasticModel
        The same where nothing relaxes.

    References
    ----------
    Christensen, Theory of Viscoelasticity, 1982, section 1.6 (glassy and rubbery limits).

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> relaxed(build(read("goland"))).modes.relaxing
    ()
    """
    return _with(model, lambda modes: replace(modes, K=modes.relaxed_K, relaxing=()))


def creep_speeds(model: AeroelasticModel, condition: FlightCondition) -> CreepSpeeds:
    """Divergence and reversal at once and in the long run.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    condition : FlightCondition
        One condition, for its density and speed of sound.

    Returns
    -------
    speeds : CreepSpeeds
        Equal pairs where nothing relaxes. [Pa, m/s]

    References
    ----------
    equations.md, "Static aeroelasticity" [7.6, 7.18-7.21], with the moduli at once and in the long run.

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> found = creep_speeds(build(read("goland")), FlightCondition.at(0.0, V=1.0))
    >>> found.glassy_divergence.V == found.relaxed_divergence.V
    True
    """
    stiff = glassy(model)
    return CreepSpeeds(
        glassy_divergence=divergence(stiff, condition),
        relaxed_divergence=divergence(model, condition),
        glassy_reversal=reversal(stiff, condition)[1],
        relaxed_reversal=reversal(model, condition)[1],
    )


def creep_twist(model: AeroelasticModel, condition: FlightCondition, t: Array, *, incidence: float = 1.0) -> Array:
    """Elastic twist of the tip after the air meets the wing at an incidence, all of a sudden, at t = 0.

    Parameters
    ----------
    model : AeroelasticModel
        With grid points and the steady column "incidence".
    condition : FlightCondition
        One speed below glassy divergence.
    t : ndarray, shape (n_t,)
        Time since then, not negative. [s]
    incidence : float
        Of the root. [rad]

    Returns
    -------
    twist : ndarray, shape (n_t,)
        From the twist of the glassy wing to that of the relaxed one, or on without end. [rad]

    Raises
    ------
    ValueError
        If the wing diverges at once, or the model has no such column or no grid.

    References
    ----------
    Bramstång 2015, section 7.8; equations.md, "Static aeroelasticity" with K(t).

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> twist = creep_twist(build(read("goland")), FlightCondition.at(0.0, V=100.0), np.array([0.0, 9.0]))
    >>> bool(twist[0] == twist[1])
    True
    """
    motion = _Creep(model, condition)
    return incidence * motion.twist(np.asarray(t, dtype=float))


def creep_time(model: AeroelasticModel, condition: FlightCondition, *, twist: float, incidence: float = 1.0) -> Array:
    """Time until the twist of the tip reaches a stated value, at each speed of a sweep.

    Parameters
    ----------
    model : AeroelasticModel
        As `creep_twist`.
    condition : FlightCondition
        Speeds at one density, shape (n_V,).
    twist : float
        Elastic twist of the tip, either way. [rad]
    incidence : float
        Of the root, from t = 0 on. [rad]

    Returns
    -------
    time : ndarray, shape (n_V,)
        0 where the glassy wing twists that far at once (or diverges), inf where it never does. [s]

    Raises
    ------
    ValueError
        If the twist is not positive, or as `creep_twist`.

    References
    ----------
    Bramstång 2015, section 7.8; equations.md, "Static aeroelasticity" with K(t).

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> creep_time(build(read("goland")), FlightCondition.at(0.0, V=[100.0, 300.0]), twist=1.0).tolist()
    [inf, 0.0]
    """
    if not twist > 0.0:
        raise ValueError(f"twist must be positive [rad], got {twist}")
    at_once = divergence(glassy(model), condition[0]).V
    return np.array(
        [
            0.0
            if at_once is not None and float(V) >= at_once
            else _first(_Creep(model, condition[i]), twist, incidence)
            for i, V in enumerate(condition.V)
        ]
    )


def at_creep_divergence(model: AeroelasticModel, condition: FlightCondition, changes: list[Boundary]) -> list[Boundary]:
    """Boundaries with the onset of creep where it is: growth just above it is slower than roots can be told from zero.

    Parameters
    ----------
    model : AeroelasticModel
        Viscoelastic, in the modes whose roots were searched.
    condition : FlightCondition
        One condition, for density and speed of sound.
    changes : list of Boundary
        As `boundaries` found them, in order of speed.

    Returns
    -------
    changes : list of Boundary
        The first real root's loss of stability moved to det(K - q_bar Q(0)) = 0 with the long-term K, in order.

    References
    ----------
    equations.md, "Static aeroelasticity" [7.6], with the long-term moduli.

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> at_creep_divergence(build(read("goland")), FlightCondition.at(0.0, V=1.0), [])
    []
    """
    first = next((b for b in changes if b.kind == "real" and b.opens), None)
    if first is None or np.any(displacement_free(model.modes, model.aero)):
        return changes
    V = divergence(replace(model, statics=None), condition).V
    if V is None or not NEAR * first.V <= V <= first.V:
        return changes
    moved = [replace(b, V=V) if b is first else b for b in changes]
    return sorted(moved, key=lambda boundary: boundary.V)


def _first(motion: _Creep, twist: float, incidence: float) -> float:
    """First passage of the twist: looked for on a grid of times, then refined."""
    from scipy.optimize import brentq

    def above(t: Any) -> Any:
        return np.abs(incidence * motion.twist(np.atleast_1d(t))) - twist

    if above(0.0)[0] >= 0.0:
        return 0.0
    times = motion.times()
    with np.errstate(over="ignore", invalid="ignore"):
        height = above(times)
    over = np.flatnonzero(~(height < 0.0))
    if not over.size:
        return float(np.inf)
    j = int(over[0])
    low, high = (0.0 if j == 0 else times[j - 1]), times[j]
    while not np.isfinite(above(high)[0]):  # a growth that has run away by then
        middle = 0.5 * (low + high)
        low, high = (middle, high) if above(middle)[0] < 0.0 else (low, middle)
    return float(brentq(lambda t: float(above(t)[0]), low, high, xtol=1e-15 * times[0], rtol=1e-12))


class _Creep:
    """Internal states y of relaxation under a steady load: y' = A y + B, twist = c + C y."""

    def __init__(self, model: AeroelasticModel, condition: FlightCondition) -> None:
        model = model.statics or model
        column = model.column("incidence")
        if column is None or not len(model.modes.grid):
            raise ValueError("creep needs a model with an incidence and a tip: it has no such column or no grid")
        index, _ = elastic_stiffness(model)
        q, Q0 = float(condition.q), model.aero(0.0, float(condition.mach)).real
        stiff = model.modes.K[np.ix_(index, index)] - q * Q0[np.ix_(index, index)]
        strains = [branch.strain[:, index] for branch in model.modes.relaxing]
        R = np.concatenate([*strains, np.zeros((0, len(index)))])
        self.rate = np.concatenate(
            [*(np.full(len(x), 1.0 / b.time) for x, b in zip(strains, model.modes.relaxing)), []]
        )
        at_once = divergence(glassy(model), condition).V
        if at_once is not None and float(condition.V) >= at_once:
            raise ValueError(
                f"the wing diverges at once at {float(condition.V):g} m/s: glassy divergence is at {at_once:g} m/s"
            )
        solved = np.linalg.solve(stiff, np.concatenate([R.T, q * Q0[index, column][:, None]], axis=1))
        shape = tip_motion(model.modes)[1][index]
        flexible, load = solved[:, :-1], solved[:, -1]
        self.start, self.by_state = float(shape @ load), shape @ flexible
        A, B = self.rate[:, None] * (R @ flexible - np.eye(len(R))), self.rate * (R @ load)
        self.roots, vectors = np.linalg.eig(A)
        self.drive = np.linalg.solve(vectors, B.astype(complex)) if len(B) else B
        self.by_root = self.by_state @ vectors

    def twist(self, t: Array) -> Array:
        """Twist per radian of incidence at times (n_t,)."""
        if not len(self.roots):
            return np.full(t.shape, self.start)
        z = t[:, None] * self.roots
        small = np.abs(z) < 1e-12
        grown = np.where(small, t[:, None], np.expm1(np.where(small, 0.0, z)) / np.where(small, 1.0, self.roots))
        return np.asarray(self.start + (grown @ (self.by_root * self.drive)).real)

    def times(self) -> Array:
        """Times from far below the shortest to far beyond the longest time constant."""
        if not len(self.roots):
            return np.zeros(1)
        speed = np.concatenate([np.abs(self.roots), self.rate])
        slowest = max(speed.min(), SLOWEST * self.rate.min())
        return np.geomspace(1e-6 / speed.max(), LONGEST / slowest, POINTS)


def _with(model: AeroelasticModel, change: Any) -> AeroelasticModel:
    """The model and what it carries for statics, with other modes."""

    def of(inner: AeroelasticModel | None) -> AeroelasticModel | None:
        if inner is None:
            return None
        modes: ModalModel = change(inner.modes)
        return replace(inner, modes=modes)

    found = of(replace(model, statics=of(model.statics), rolling=of(model.rolling)))
    assert found is not None
    return found
