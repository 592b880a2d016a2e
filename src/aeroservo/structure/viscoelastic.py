"""Viscoelastic stiffness: the generalised Maxwell body (Prony series), its temperature shift, and what it relaxes to.

Moduli are parts of the instantaneous (glassy) one: E(t)/E(0) = 1 - sum g_j (1 - exp(-t/tau_j)), in the Laplace domain
s E~(s)/E(0) = 1 - sum g_j/(1 + s tau_j). Linear: strains are small and the material does not age. Temperature shifts
all times alike (thermorheologically simple), by WLF, which holds from the glass transition to about 100 K above it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.datatypes import Array, Relaxation

#: Relaxation times that analyses can tell apart from "at once" and "never". [s]
TIMES = (1e-7, 1e6)


@dataclass(frozen=True, kw_only=True)
class Prony:
    """A modulus that relaxes.

    Attributes
    ----------
    ratios : tuple of float
        g_j, parts of the instantaneous modulus that relax; each positive, their sum below 1. [-]
    times : tuple of float
        Relaxation times tau_j, of constant strain. [s]
    """

    ratios: tuple[float, ...] = ()
    times: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Check the series."""
        if len(self.ratios) != len(self.times):
            raise ValueError(
                f"a Prony series needs one time for each ratio, got {len(self.ratios)} and {len(self.times)}"
            )
        if any(not g > 0.0 for g in self.ratios) or not sum(self.ratios) < 1.0:
            raise ValueError(
                f"ratios of a Prony series must be positive and add up to less than 1 [-], got {self.ratios}"
            )
        for time in self.times:
            if not TIMES[0] <= time <= TIMES[1]:
                raise ValueError(
                    f"relaxation times must lie between {TIMES[0]:g} and {TIMES[1]:g} s at the temperature of the "
                    f"structure, got {time:g}: a shorter one is relaxed at once, a longer one never, leave it out"
                )

    @property
    def relaxed(self) -> float:
        """Long-term modulus over the instantaneous one. [-]"""
        return 1.0 - sum(self.ratios)


@dataclass(frozen=True, kw_only=True)
class Viscoelastic:
    """How bending and torsion relax, at the temperature of the structure.

    Attributes
    ----------
    bending, torsion : Prony
        Of EI and of GJ (of the plunge and of the pitch spring).
    """

    bending: Prony = Prony()
    torsion: Prony = Prony()


def wlf_shift(temperature: ArrayLike, *, reference: float, C1: float, C2: float) -> Array:
    """Factor a_T by which relaxation times change with temperature (Williams, Landel, Ferry).

    Parameters
    ----------
    temperature : array_like, shape (...)
        Of the structure. [deg C or K]
    reference : float
        Temperature of the given times, in the same scale. [deg C or K]
    C1 : float
        Constant of the material, for log10. [-]
    C2 : float
        Constant of the material. [K]

    Returns
    -------
    a_T : ndarray, shape (...)
        1 at the reference, below 1 above it. [-]

    Raises
    ------
    ValueError
        Where the temperature is C2 or more below the reference: there the law has no meaning.

    References
    ----------
    Williams, Landel, Ferry, J. Am. Chem. Soc. 77(14), 1955, Eq. 1: log10 a_T = -C1 (T - T_ref)/(C2 + T - T_ref).

    Examples
    --------
    >>> float(wlf_shift(25.0, reference=25.0, C1=17.44, C2=51.6))
    1.0
    >>> f"{float(wlf_shift(35.0, reference=25.0, C1=17.44, C2=51.6)):.3e}"
    '1.475e-03'
    """
    rise = np.asarray(temperature, dtype=float) - reference
    if np.any(C2 + rise <= 0.0):
        raise ValueError(
            f"temperature must be above {reference - C2:g}, the reference less C2, for WLF, got {np.min(temperature):g}"
        )
    return np.asarray(10.0 ** np.clip(-C1 * rise / (C2 + rise), -300.0, 300.0))


def complex_modulus(prony: Prony, s: ArrayLike) -> Array:
    """s E~(s) over the instantaneous modulus: storage and loss modulus at s = i omega.

    Parameters
    ----------
    prony : Prony
        The modulus.
    s : array_like, shape (...)
        Laplace variable. [1/s]

    Returns
    -------
    ratio : complex ndarray, shape (...)
        1 at infinite frequency, the relaxed part at 0. [-]

    References
    ----------
    Christensen, Theory of Viscoelasticity, 1982, section 1.6; Bramstång 2015, section 7.8.

    Examples
    --------
    >>> complex(complex_modulus(Prony(ratios=(0.5,), times=(1.0,)), 1j))
    (0.75+0.25j)
    """
    s = np.asarray(s, dtype=complex)[..., None]
    return np.asarray(1.0 - np.sum(np.array(prony.ratios) / (1.0 + s * np.array(prony.times)), axis=-1))


def relaxation_modulus(prony: Prony, t: ArrayLike) -> Array:
    """Stress after a unit step of strain, over the instantaneous one.

    Parameters
    ----------
    prony : Prony
        The modulus.
    t : array_like, shape (...)
        Time since the step, not negative. [s]

    Returns
    -------
    ratio : ndarray, shape (...)
        From 1 to the relaxed part. [-]

    References
    ----------
    Christensen, Theory of Viscoelasticity, 1982, section 1.6.

    Examples
    --------
    >>> float(relaxation_modulus(Prony(ratios=(0.5,), times=(1.0,)), 0.0))
    1.0
    """
    t = np.asarray(t, dtype=float)[..., None]
    return np.asarray(1.0 - np.sum(np.array(prony.ratios) * -np.expm1(-t / np.array(prony.times)), axis=-1))


def creep_compliance(prony: Prony, t: ArrayLike) -> Array:
    """Strain after a unit step of stress, times the instantaneous modulus.

    From the internal states y' = (e - y)/tau, e = 1 + sum g y, by eigenvalues: exact.

    Parameters
    ----------
    prony : Prony
        The modulus.
    t : array_like, shape (...)
        Time since the step, not negative. [s]

    Returns
    -------
    ratio : ndarray, shape (...)
        From 1 to 1/relaxed. [-]

    References
    ----------
    Christensen, Theory of Viscoelasticity, 1982, section 1.2 (s^2 E~ J~ = 1); for one branch (the standard linear
    solid) J = 1/r - (1/r - 1) exp(-r t/tau), r the relaxed part.

    Examples
    --------
    >>> np.round(creep_compliance(Prony(ratios=(0.5,), times=(1.0,)), [0.0, 1e6]), 9).tolist()
    [1.0, 2.0]
    """
    g, tau, t = np.array(prony.ratios), np.array(prony.times), np.asarray(t, dtype=float)
    if not len(g):
        return np.ones(t.shape)
    # symmetric in z = sqrt(g tau) y: rates are real and negative
    root = np.sqrt(g / tau)
    rates, vectors = np.linalg.eigh(np.outer(root, root) - np.diag(1.0 / tau))
    weight = (root @ vectors) ** 2
    return np.asarray(1.0 + np.sum(weight * np.expm1(t[..., None] * rates) / rates, axis=-1))


def relaxing(bending: Array, torsion: Array, material: Viscoelastic) -> tuple[Relaxation, ...]:
    """Relaxing parts of a stiffness matrix.

    Parameters
    ----------
    bending, torsion : ndarray, shape (n, n)
        Parts of the instantaneous stiffness that bending and torsion hold. [SI]
    material : Viscoelastic
        How each relaxes.

    Returns
    -------
    branches : tuple of Relaxation
        One for each time; what bending and torsion share in time is one branch.

    References
    ----------
    Bramstång 2015, section 7.8; Christensen, Theory of Viscoelasticity, 1982, section 1.6.

    Examples
    --------
    >>> same = Prony(ratios=(0.5,), times=(1.0,))
    >>> both = relaxing(np.diag([4.0, 0.0]), np.diag([0.0, 2.0]), Viscoelastic(bending=same, torsion=same))
    >>> len(both), both[0].K.tolist()
    (1, [[2.0, 0.0], [0.0, 1.0]])
    """
    found: dict[float, Array] = {}
    for part, prony in ((bending, material.bending), (torsion, material.torsion)):
        for ratio, time in zip(prony.ratios, prony.times):
            found[time] = found.get(time, np.zeros_like(part)) + ratio * part
    return tuple(Relaxation(time=time, K=0.5 * (K + K.T)) for time, K in sorted(found.items()))
