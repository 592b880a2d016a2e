"""Flutter speeds of many models in one call: polynomial aerodynamics, Routh's criterion.

For studies of thousands of sections or wings with quasi-steady air forces (no lag states): no
eigenvalues, no modes, only the lowest flutter speed of each. A hump narrower than a step of the
scan is not seen; `flutter` sees it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.aeroelastic.rootfinding import bracketed_roots
from aeroservo.datatypes import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Population:
    """Flutter speeds of a population; nan where a member does not flutter in the range.

    Attributes
    ----------
    speed : ndarray, shape (n_members,)
        Lowest speed at which an oscillatory root crosses into instability. [m/s]
    frequency : ndarray, shape (n_members,)
        Frequency there. [rad/s]
    """

    speed: Array
    frequency: Array


def population_flutter(
    M: ArrayLike,
    D: ArrayLike,
    K: ArrayLike,
    A0: ArrayLike,
    A1: ArrayLike,
    A2: ArrayLike,
    *,
    b: ArrayLike,
    rho: ArrayLike,
    V_range: tuple[float, float],
    steps: int = 160,
) -> Population:
    """Lowest flutter speed of each of many models with Q = A0 + A1 p + A2 p^2.

    The coefficients of the characteristic polynomial are polynomials in V, found from 2n + 1 speeds.
    The last Hurwitz determinant but one changes sign where a pair crosses the imaginary axis (Orlando);
    its sign changes are bracketed on a scan of speeds, refined, and confirmed by the roots themselves.

    Parameters
    ----------
    M, D, K : array_like, shape (n_members, n, n)
        Structures. [SI]
    A0, A1, A2 : array_like, shape (n_members, n, n)
        Air forces per dynamic pressure. [SI]
    b, rho : array_like, shape (n_members,) or scalar
        Semi-chord of p and density. [m, kg/m^3]
    V_range : (float, float)
        Range of speeds searched. [m/s]
    steps : int
        Speeds of the scan, spaced geometrically.

    Returns
    -------
    population : Population
        Speeds refined to 1e-10 relative. [m/s, rad/s]

    Raises
    ------
    ValueError
        If the range of speeds is not two ascending positive numbers.

    References
    ----------
    Routh 1877; Orlando, Mathematische Annalen 71, 1911; Bramstång 2015, Eq. 7.24.

    Examples
    --------
    >>> M, K = [[[1.0, 0.1], [0.1, 0.25]]], [[[1.0, 0.0], [0.0, 1.0]]]
    >>> A0, A1, none = [[[0.0, -1.0], [0.0, 0.2]]], [[[-1.0, 0.0], [0.2, -0.3]]], [[[0.0, 0.0], [0.0, 0.0]]]
    >>> found = population_flutter(M, none, K, A0, A1, none, b=1.0, rho=0.1, V_range=(0.1, 50.0))
    >>> found.speed.shape
    (1,)
    """
    low, high = V_range
    if not 0.0 < low < high:
        raise ValueError(f"V_range must be two ascending positive speeds [m/s], got {V_range}")
    M, D, K, A0, A1, A2 = (np.asarray(x, dtype=float) for x in (M, D, K, A0, A1, A2))
    b, rho = (np.broadcast_to(np.asarray(x, dtype=float), len(M))[:, None, None] for x in (b, rho))
    mass = M - 0.5 * rho * b**2 * A2
    scale = np.sqrt(np.abs(np.trace(np.linalg.solve(mass, K), axis1=1, axis2=2)) / M.shape[1])
    scale = np.where(scale > 0.0, scale, 1.0)[:, None, None]
    inverse = np.linalg.inv(mass)
    by_V = [
        np.concatenate([first / scale**2, second / scale], axis=2)
        for first, second in ((-inverse @ K, -inverse @ D), (0.0 * K, inverse @ (0.5 * rho * b * A1)),
                              (inverse @ (0.5 * rho * A0), 0.0 * K))
    ]  # fmt: skip
    coefficients = _polynomials(by_V, high)
    mesh = np.geomspace(low, high, steps) / high
    hurwitz = np.stack([_hurwitz(coefficients, np.full(len(M), x)) for x in mesh], axis=1)
    return _refined(coefficients, by_V, mesh, hurwitz, high, scale[:, 0, 0])


def _state(by_V: list[Array], V: Array) -> Array:
    """State matrices (m, 2n, 2n) in units of each member's own frequency scale."""
    n = by_V[0].shape[1]
    A = np.zeros((len(V), 2 * n, 2 * n))
    A[:, np.arange(n), n + np.arange(n)] = 1.0
    V = V[:, None, None]
    A[:, n:] = by_V[0] + V * (by_V[1] + V * by_V[2])
    return A


def _polynomials(by_V: list[Array], high: float) -> Array:
    """Coefficients (n_members, N + 1 powers of s descending, N + 1 powers of V/high ascending)."""
    N = 2 * by_V[0].shape[1]
    nodes = 0.5 - 0.5 * np.cos(np.pi * np.arange(N + 1) / N)
    values = np.stack([_characteristic(_state(by_V, np.full(len(by_V[0]), high * x))) for x in nodes], axis=2)
    return values @ np.linalg.inv(np.vander(nodes, increasing=True)).T


def _characteristic(A: Array) -> Array:
    """Characteristic polynomials (m, N + 1), leading 1, by Faddeev and Le Verrier."""
    N = A.shape[-1]
    c = np.ones((len(A), N + 1))
    B = np.broadcast_to(np.eye(N), A.shape)
    for j in range(1, N + 1):
        AB = A @ B
        c[:, j] = -np.trace(AB, axis1=1, axis2=2) / j
        B = AB + c[:, j, None, None] * np.eye(N)
    return c


def _hurwitz(coefficients: Array, x: Array) -> Array:
    """Last Hurwitz determinant but one at V = x high, one value of x a member."""
    N = coefficients.shape[1] - 1
    c = coefficients[..., -1]
    for j in range(coefficients.shape[2] - 2, -1, -1):
        c = c * x[:, None] + coefficients[..., j]
    H = np.zeros((len(x), N - 1, N - 1))
    for i in range(N - 1):
        for j in range(N - 1):
            if 0 <= 2 * (j + 1) - (i + 1) <= N:
                H[:, i, j] = c[:, 2 * (j + 1) - (i + 1)]
    size = np.abs(H).max(axis=(1, 2), keepdims=True)
    return np.linalg.det(H / np.where(size > 0.0, size, 1.0))


def _refined(
    coefficients: Array, by_V: list[Array], mesh: Array, hurwitz: Array, high: float, scale: Array
) -> Population:
    """First sign change of each member that is a pair losing stability."""
    speed, frequency = np.full(len(hurwitz), np.nan), np.full(len(hurwitz), np.nan)
    change = hurwitz[:, :-1] * hurwitz[:, 1:] < 0.0
    open_ = np.flatnonzero(change.any(axis=1))
    while open_.size:
        cell = np.argmax(change[open_], axis=1)
        x = bracketed_roots(
            lambda x, i: _hurwitz(coefficients[open_[i]], x),  # noqa: B023
            mesh[cell], mesh[cell + 1], hurwitz[open_, cell], hurwitz[open_, cell + 1], rtol=1e-12,
        )  # fmt: skip
        part = [matrix[open_] for matrix in by_V]
        roots = np.linalg.eigvals(_state(part, high * x))
        ahead = np.linalg.eigvals(_state(part, high * x * (1.0 + 1e-5)))
        swinging = np.where(roots.imag > 1e-6 * np.abs(roots), np.abs(roots.real), np.inf)
        row, nearest = np.arange(len(open_)), np.argmin(swinging, axis=1)
        root = roots[row, nearest]
        on_axis = swinging[row, nearest] < 1e-6 * np.abs(root)
        later = ahead[row, np.argmin(np.abs(ahead - root[:, None]), axis=1)]
        good = on_axis & (later.real > root.real)
        speed[open_[good]], frequency[open_[good]] = high * x[good], root[good].imag * scale[open_[good]]
        change[open_, cell] = False
        open_ = open_[~good & change[open_].any(axis=1)]
    return Population(speed=speed, frequency=frequency)
