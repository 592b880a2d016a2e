"""Roots of an aeroelastic model at given speeds, and the p method's.

This and `pk` return, for every speed, the full set of roots closed under conjugation, in no
particular order: following modes from speed to speed is another matter (tracking.py), and flutter
speeds never depend on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.aeroelastic.linear import displacement_free, state_matrix
from aeroservo.datatypes import AeroelasticModel, FlightCondition

Array = NDArray[Any]


@dataclass(frozen=True, kw_only=True, eq=False)
class RootSet:
    """Roots at a row of speeds.

    Attributes
    ----------
    values : complex ndarray, shape (n_V, n_roots)
        Roots s = sigma + i omega, closed under conjugation; nan where there are fewer. [1/s]
    shapes : complex ndarray, shape (n_V, n_roots, n)
        Shape of each root in the modes of the model, largest entry 1. [-]
    """

    values: Array
    shapes: Array

    def __post_init__(self) -> None:
        """Lock the arrays (nan stands for a root that is not there)."""
        for name in ("values", "shapes"):
            array = np.array(getattr(self, name), dtype=complex)
            array.flags.writeable = False
            object.__setattr__(self, name, array)


def p_roots(model: AeroelasticModel, condition: FlightCondition) -> RootSet:
    """Roots by the p method: eigenvalues of the state matrix of rational air forces.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.
    condition : FlightCondition
        A row of speeds, shape (n_V,).

    Returns
    -------
    roots : RootSet
        All eigenvalues, lag roots included; the structural zeros of free modes left out. [1/s]

    References
    ----------
    equations.md, "One equation of motion"; Bramstång 2015, Eq. 7.24 and section 7.3.

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, RationalAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> zero = [[[0.0]]]
    >>> air = RationalAero(A0=zero, A1=zero, A2=zero, b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> roots = p_roots(AeroelasticModel(modes=one, aero=air), FlightCondition(V=[10.0], rho=1.2))
    >>> sorted(roots.values[0].imag.round(9).tolist())
    [-2.0, 2.0]
    """
    n = model.modes.n
    kept = int(np.sum(~displacement_free(model.modes, model.aero)))
    values, vectors = np.linalg.eig(state_matrix(model, condition))
    return RootSet(values=values, shapes=normalised(np.moveaxis(vectors[..., kept : kept + n, :], -1, -2)))


def p_values(model: AeroelasticModel, condition: FlightCondition) -> Array:
    """The values of `p_roots` without shapes, for searches.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.
    condition : FlightCondition
        A row of speeds, shape (n_V,).

    Returns
    -------
    values : complex ndarray, shape (n_V, n_roots)
        All eigenvalues. [1/s]

    References
    ----------
    As `p_roots`: Bramstång 2015, Eq. 7.24.

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, RationalAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> zero = [[[0.0]]]
    >>> air = RationalAero(A0=zero, A1=zero, A2=zero, b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> p_values(AeroelasticModel(modes=one, aero=air), FlightCondition(V=[10.0], rho=1.2)).shape
    (1, 2)
    """
    return np.asarray(np.linalg.eigvals(state_matrix(model, condition))).astype(complex)


def frequency_scale(model: AeroelasticModel) -> float:
    """Largest frequency of the structure in vacuum, the scale of every search. [rad/s]

    Parameters
    ----------
    model : AeroelasticModel
        Any.

    Returns
    -------
    omega : float
        sqrt of the largest eigenvalue of M^-1 K; 1 where there is no stiffness. [rad/s]

    References
    ----------
    Bramstång 2015, Eq. 7.24 with rho = 0.

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> frequency_scale(AeroelasticModel(modes=one, aero=air))
    2.0
    """
    largest = np.abs(np.linalg.eigvals(np.linalg.solve(model.modes.M, model.modes.K))).max()
    return float(np.sqrt(largest)) or 1.0


def slowest(model: AeroelasticModel) -> float:
    """Smallest frequency of the structure in vacuum that is not zero. [rad/s]

    Parameters
    ----------
    model : AeroelasticModel
        Any.

    Returns
    -------
    omega : float
        Lowest elastic frequency; 1 where there is no stiffness. [rad/s]

    References
    ----------
    Bramstång 2015, Eq. 7.24 with rho = 0.

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> slowest(AeroelasticModel(modes=one, aero=air))
    2.0
    """
    squares = np.abs(np.linalg.eigvals(np.linalg.solve(model.modes.M, model.modes.K)))
    elastic = squares[squares > 1e-12 * squares.max()]
    return float(np.sqrt(elastic.min())) if elastic.size else 1.0


def normalised(shapes: Array) -> Array:
    """Scale each shape (last axis) so that its largest entry is 1.

    Parameters
    ----------
    shapes : complex ndarray, shape (..., n)
        Shapes, nan where there is none. [unit of each coordinate]

    Returns
    -------
    shapes : complex ndarray, shape (..., n)
        The same directions. [-]

    References
    ----------
    Project convention: docs/architecture.md, "Tracking".

    Examples
    --------
    >>> normalised(np.array([1.0, -4.0])).tolist()
    [-0.25, 1.0]
    """
    largest = np.take_along_axis(shapes, np.argmax(np.abs(shapes), axis=-1)[..., None], axis=-1)
    return shapes / np.where(largest == 0.0, 1.0, largest)
