"""Roots of an aeroelastic model at given speeds: the p, p-k and g methods.

Each function returns, for every speed, the full set of roots closed under conjugation, in no
particular order: following modes from speed to speed is another matter (tracking.py), and flutter
speeds never depend on it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.aeroelastic.linear import displacement_free, state_matrix
from aeroservo.aeroelastic.rootfinding import bracketed_roots
from aeroservo.datatypes import AeroelasticModel, FlightCondition

Array = NDArray[Any]

SCAN_POINTS = 14
"""Frequencies at which p-k and g look for brackets before refining."""

APERIODIC_K = 1e-3
"""Reduced frequency at which p-k takes the aerodynamic damping Im Q / k of an aperiodic root."""


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
    return RootSet(values=values, shapes=_normalised(np.moveaxis(vectors[..., kept : kept + n, :], -1, -2)))


def p_values(model: AeroelasticModel, condition: FlightCondition) -> Array:
    """The values of `p_roots` without shapes, for searches: shape (n_V, n_roots). [1/s]"""
    return np.asarray(np.linalg.eigvals(state_matrix(model, condition))).astype(complex)


def frequency_matrix(model: AeroelasticModel, condition: FlightCondition, omega: Array, *, g_method: bool) -> Array:
    """State matrix of z = [q, q'] whose eigenvalue with Im p = omega is a root of the p-k or g method.

    p-k (Hassig, in the real form of Rodden): Q = Re Q + p (b/V) Im Q / k, hysteretic damping as
    g K / omega. g (Chen): Q = Q(ik) + Q'(ik) (p b/V - ik), complex.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    condition : FlightCondition
        Shape (...).
    omega : ndarray, shape (...)
        Frequency at which Q is taken, positive. [rad/s]
    g_method : bool
        The g method's matrix instead of the p-k method's.

    Returns
    -------
    A : ndarray, shape (..., 2n, 2n)
        Real for p-k, complex for g. [1/s and mixed]

    References
    ----------
    Hassig, J. Aircraft 8(11), 1971; Rodden, Harder, Bellinger, NASA CR-3094, 1979; Chen, AIAA J. 38(9), 2000.

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> model = AeroelasticModel(modes=one, aero=air)
    >>> frequency_matrix(model, FlightCondition(V=10.0, rho=1.2), np.array(2.0), g_method=False).tolist()
    [[0.0, 1.0], [-4.0, -0.0]]
    """
    modes, aero = model.modes, model.aero
    n = modes.n
    k = omega * aero.b / condition.V
    V, q, w = (np.asarray(x)[..., None, None] for x in (condition.V, condition.q, omega))
    Q = aero(k, condition.mach)[..., :n]
    if g_method:
        slope = aero.slope(k, condition.mach)[..., :n]
        stiffness = modes.K * (1.0 + 1j * modes.hysteretic_g) - q * (Q - 1j * (w * aero.b / V) * slope)
        damping = modes.D - q * aero.b / V * slope
    else:
        stiffness = modes.K - q * Q.real
        damping = modes.D - q / w * Q.imag + modes.hysteretic_g / w * modes.K
    A = np.zeros((*k.shape, 2 * n, 2 * n), dtype=stiffness.dtype)
    A[..., np.arange(n), n + np.arange(n)] = 1.0
    inverse = np.linalg.inv(modes.M)
    A[..., n:, :n] = -inverse @ stiffness
    A[..., n:, n:] = -inverse @ damping
    return A


def frequency_roots(model: AeroelasticModel, condition: FlightCondition, *, g_method: bool = False) -> RootSet:
    """Roots by the p-k or g method.

    The imaginary parts of the eigenvalues of `frequency_matrix`, in descending order, are
    continuous in omega; number m of them meets omega itself at a root. Each is bracketed from
    above and refined, so every speed stands alone: nothing is carried from speed to speed and no
    iteration can jump to another mode or fail to converge. Where number m meets omega only at zero,
    the root is aperiodic and comes from the matrix near omega = 0 without hysteretic damping.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    condition : FlightCondition
        A row of speeds, shape (n_V,).
    g_method : bool
        Use the g method's first-order expansion of Q off the axis.

    Returns
    -------
    roots : RootSet
        2n roots at each speed, less the zeros of free modes. [1/s]

    References
    ----------
    Hassig, J. Aircraft 8(11), 1971; Chen, AIAA J. 38(9), 2000; equations.md, "One equation of motion".

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> roots = frequency_roots(AeroelasticModel(modes=one, aero=air), FlightCondition(V=[10.0], rho=1.2))
    >>> sorted(roots.values[0].imag.round(9).tolist())
    [-2.0, 2.0]
    """
    n, n_V = model.modes.n, condition.V.size
    free = displacement_free(model.modes, model.aero)
    n_roots = 2 * n - int(free.sum())
    omega = _root_frequencies(model, condition, g_method)
    rows, order = np.nonzero(omega > 0.0)
    A = frequency_matrix(model, condition[rows], omega[rows, order], g_method=g_method)
    pair_values, pair_shapes = _nth_from_above(A, order)
    real_values, real_shapes = _aperiodic_roots(model, condition, free)
    values = np.full((n_V, n_roots), np.nan, dtype=complex)
    shapes = np.full((n_V, n_roots, n), np.nan, dtype=complex)
    slot = np.cumsum(omega > 0.0, axis=1)[rows, order] - 1
    for offset, conjugate in ((0, False), (1, True)):
        keep = 2 * slot + offset < n_roots
        values[rows[keep], 2 * slot[keep] + offset] = pair_values[keep].conj() if conjugate else pair_values[keep]
        shapes[rows[keep], 2 * slot[keep] + offset] = pair_shapes[keep].conj() if conjugate else pair_shapes[keep]
    pairs = (omega > 0.0).sum(axis=1)
    for j in range(real_values.shape[1]):
        place = 2 * pairs + j
        rows_j = np.flatnonzero((place < n_roots) & np.isfinite(real_values[:, j]))
        values[rows_j, place[rows_j]] = real_values[rows_j, j]
        shapes[rows_j, place[rows_j]] = real_shapes[rows_j, j]
    return RootSet(values=values, shapes=shapes)


def _root_frequencies(model: AeroelasticModel, condition: FlightCondition, g_method: bool) -> Array:
    """Frequency of root number m at each speed, 0 where it is aperiodic: shape (n_V, n)."""
    n, n_V = model.modes.n, condition.V.size

    def excess(omega: Array, row: Array, m: Array) -> Array:
        imaginary = _descending_imaginary(frequency_matrix(model, condition[row], omega, g_method=g_method), n)
        return np.take_along_axis(imaginary, m[:, None], axis=1)[:, 0] - omega

    top = frequency_scale(model)
    scan = np.geomspace(1e-5 * top, 2.0 * top, SCAN_POINTS)
    while True:
        grid = np.broadcast_to(scan, (n_V, scan.size))
        rows = np.repeat(np.arange(n_V), scan.size)
        A = frequency_matrix(model, condition[rows], grid.ravel(), g_method=g_method)
        over = _descending_imaginary(A, n).reshape(n_V, scan.size, n) - grid[..., None]
        if np.all(over[:, -1] < 0.0) or scan.size > SCAN_POINTS + 20:
            break
        scan = np.append(scan, 2.0 * scan[-1])
    falls = (over[:, :-1] > 0.0) & (over[:, 1:] <= 0.0)
    last = scan.size - 2 - np.argmax(falls[:, ::-1], axis=1)
    row, m = np.nonzero(falls.any(axis=1))
    left = last[row, m]
    omega = np.zeros((n_V, n))
    omega[row, m] = bracketed_roots(
        lambda x, i: excess(x, row[i], m[i]), scan[left], scan[left + 1], over[row, left, m], over[row, left + 1, m]
    )
    return omega


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


def _descending_imaginary(A: Array, n: int) -> Array:
    """The n largest imaginary parts of the eigenvalues, none below zero."""
    imaginary = np.sort(np.linalg.eigvals(A).imag, axis=-1)[..., : -n - 1 : -1]
    return np.maximum(imaginary, 0.0)


def _nth_from_above(A: Array, order: Array) -> tuple[Array, Array]:
    """Eigenvalue number `order` by descending imaginary part, and its displacement shape."""
    if not len(order):
        return np.zeros(0, complex), np.zeros((0, A.shape[-1] // 2), complex)
    values, vectors = np.linalg.eig(A)
    pick = np.take_along_axis(np.argsort(-values.imag, axis=-1), order[:, None], axis=1)
    shape = np.take_along_axis(vectors, pick[:, None, :], axis=2)[..., 0]
    return np.take_along_axis(values, pick, axis=1)[:, 0], _normalised(shape[:, : A.shape[-1] // 2])


def _aperiodic_roots(model: AeroelasticModel, condition: FlightCondition, free: Array) -> tuple[Array, Array]:
    """Real eigenvalues of the p-k matrix near k = 0, largest first; nan pads.

    The column of a free mode loses its displacement (it is zero at k = 0) and keeps its rate.
    """
    modes = model.modes
    n = modes.n
    undamped = replace(model, modes=replace(modes, hysteretic_g=0.0))
    omega = np.full(condition.V.shape, APERIODIC_K) * condition.V / model.aero.b
    A = frequency_matrix(undamped, condition, omega, g_method=False)
    static = model.aero(0.0, condition.mach)[..., :n].real
    A[..., n:, :n] = -np.linalg.solve(modes.M, modes.K - condition.q[:, None, None] * static)
    keep = np.append(~free, np.ones(n, dtype=bool))
    values, vectors = np.linalg.eig(A[:, keep][:, :, keep])
    real = np.where(np.abs(values.imag) == 0.0, values.real, np.nan)
    order = np.argsort(-real, axis=1)  # nan sorts last
    shapes = np.take_along_axis(vectors, order[:, None, :], axis=2)[:, int(keep[:n].sum()) :]
    return np.take_along_axis(real, order, axis=1), _normalised(np.moveaxis(shapes, -1, -2))


def _normalised(shapes: Array) -> Array:
    """Scale each shape (last axis) so that its largest entry is 1."""
    largest = np.take_along_axis(shapes, np.argmax(np.abs(shapes), axis=-1)[..., None], axis=-1)
    return shapes / np.where(largest == 0.0, 1.0, largest)
