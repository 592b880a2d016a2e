"""Following roots from speed to speed. Pure bookkeeping: no flutter speed depends on it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

RATIO = 0.35
"""A match is clear when a root moved less than this part of the distance to its nearest rival."""

OVERDAMPED = 0.2
"""Roots with |omega| below this part of |s| (lags, mostly) are matched as well as may be, never pursued."""


def steps_between(values: Array) -> tuple[Array, Array]:
    """Match the roots at each speed to those at the next, and say which matches are clear.

    Parameters
    ----------
    values : complex ndarray, shape (n_V, n_roots)
        Roots in any order, nan where absent. [1/s]

    Returns
    -------
    step : int ndarray, shape (n_V - 1, n_roots)
        Root j at speed i goes on as root step[i, j] at speed i + 1; each row is a permutation. [-]
    clear : bool ndarray, shape (n_V - 1,)
        Whether every root that swings was matched beyond doubt. [-]

    References
    ----------
    docs/architecture.md, "Tracking"; eigenvalues are continuous in V (Kato, Perturbation Theory, II.5).

    Examples
    --------
    >>> step, clear = steps_between(np.array([[1j, 5j], [5.1j, 1.1j]]))
    >>> step.tolist(), clear.tolist()
    ([[1, 0]], [True])
    """
    step, clear, sure = _nearest(values)
    return _settled(values, step, sure), clear


def _nearest(values: Array) -> tuple[Array, Array, Array]:
    """Nearest root at the next speed, which cells are clear, and in which of them that is a permutation too."""
    filled = _filled(values)
    distance = np.abs(filled[:-1, :, None] - filled[1:, None, :])
    step = np.argmin(distance, axis=2)
    if values.shape[1] == 1:
        return step, np.ones(len(step), dtype=bool), np.ones(len(step), dtype=bool)
    flat, chosen = distance.reshape(-1, step.shape[1]), (np.arange(step.size), step.ravel())
    nearest = flat[chosen].reshape(step.shape)
    flat[chosen] = np.inf
    rival = distance.min(axis=2)
    swinging = np.abs(filled[:-1].imag) > OVERDAMPED * np.abs(filled[:-1])
    clear = ~np.any((nearest > RATIO * rival) & swinging, axis=1)
    one_to_one = np.all(np.sort(step, axis=1) == np.arange(step.shape[1]), axis=1)
    return step, clear, clear & one_to_one


def _settled(values: Array, step: Array, sure: Array) -> Array:
    """The matches, those that are not sure replaced by the assignment of least movement."""
    doubtful = np.flatnonzero(~sure)
    if doubtful.size:
        filled = _filled(values)
        for i in doubtful:
            step[i] = _assignment(filled[i], filled[i + 1])
    return step


def _filled(values: Array) -> Array:
    """Absent roots as numbers: far off, but not so far that sums forget the others."""
    present = np.isfinite(values)
    if present.all():
        return values
    return np.where(present, values, 1e3 * np.abs(np.where(present, values, 0.0)).max(initial=1.0))


def _assignment(left: Array, right: Array) -> Array:
    """Least total movement; real roots, which cannot pass each other, keep their order.

    Where a pair became two real roots, they are neighbours, and its upper half goes on as the larger; the reverse
    where two real roots became a pair. Roots that are not closed under conjugation (the k method's) just move least.
    """
    if any(np.sum(x.imag > 0.0) != np.sum(x.imag < 0.0) for x in (left, right)):
        rows, columns = _least(np.abs(left[:, None] - right[None, :]))
        return columns[np.argsort(rows)]
    if np.sum(left.imag > 0.0) < np.sum(right.imag > 0.0):
        step = np.empty(len(left), dtype=int)
        step[_assignment(right, left)] = np.arange(len(left))
        return step
    upper_left, upper_right = np.flatnonzero(left.imag > 0.0), np.flatnonzero(right.imag > 0.0)
    real_left, real_right = (np.flatnonzero(x.imag == 0.0) for x in (left, right))
    real_left, real_right = (
        real_left[np.argsort(-left[real_left].real)],
        real_right[np.argsort(-right[real_right].real)],
    )
    movement = np.abs(left[upper_left][:, None] - right[upper_right][None, :])
    places = [(i, j) for i in range(len(upper_left)) for j in range(len(real_right) - 1)]
    if len(upper_left) == len(upper_right):
        chosen, pairs = None, _least(movement)
    elif len(upper_left) == len(upper_right) + 1 and places:
        costs = []
        for i, j in places:
            rows, columns = _least(np.delete(movement, i, axis=0))
            others = np.abs(left[real_left] - right[np.delete(real_right, [j, j + 1])])
            met = np.abs(left[upper_left[i]] - right[real_right[[j, j + 1]]])
            costs.append(np.delete(movement, i, axis=0)[rows, columns].sum() + 0.5 * (met.sum() + others.sum()))
        chosen = places[int(np.argmin(costs))]
        rows, columns = _least(np.delete(movement, chosen[0], axis=0))
        pairs = np.delete(np.arange(len(upper_left)), chosen[0])[rows], columns
    else:  # several at once: a finer mesh will tell
        rows, columns = _least(np.abs(left[:, None] - right[None, :]))
        return columns[np.argsort(rows)]
    step = np.empty(len(left), dtype=int)
    for half in (1.0, -1.0):
        left_half, right_half = (_halves(x, u, half) for x, u in ((left, upper_left), (right, upper_right)))
        step[left_half[pairs[0]]] = right_half[pairs[1]]
    if chosen is not None:
        i, j = chosen
        step[upper_left[i]], step[_halves(left, upper_left, -1.0)[i]] = real_right[j], real_right[j + 1]
        real_right = np.delete(real_right, [j, j + 1])
    step[real_left] = real_right
    return step


def _least(movement: Array) -> tuple[Array, Array]:
    """Rows and columns of the assignment of least total movement."""
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(movement)
    return rows, columns


def _halves(values: Array, upper: Array, half: float) -> Array:
    """Indices of the upper halves of pairs, or of their conjugates."""
    if half > 0.0:
        return upper
    lower = np.flatnonzero(values.imag < 0.0)
    distance = np.abs(values[upper].conj()[:, None] - values[lower][None, :])
    rows, columns = _least(distance)
    return np.asarray(lower[columns[np.argsort(rows)]], dtype=int)


def follow(values: Array, steps: Array) -> Array:
    """Chain the matches of `steps_between` into branches.

    Parameters
    ----------
    values : complex ndarray, shape (n_V, n_roots)
        Roots. [1/s]
    steps : int ndarray, shape (n_V - 1, n_roots)
        From `steps_between`. [-]

    Returns
    -------
    order : int ndarray, shape (n_V, n_roots)
        Branch j is root order[i, j] at speed i; branches are numbered as the roots at the first speed. [-]

    References
    ----------
    docs/architecture.md, "Tracking".

    Examples
    --------
    >>> values = np.array([[1j, 5j], [5.1j, 1.1j], [1.2j, 5.2j]])
    >>> follow(values, steps_between(values)[0]).tolist()
    [[0, 1], [1, 0], [0, 1]]
    """
    row = list(range(values.shape[1]))
    order = [row]
    for step in steps.tolist():  # lists: faster than arrays for rows this short
        row = [step[j] for j in row]
        order.append(row)
    return np.array(order)


def resolved_mesh(
    values_at: Callable[[Array], Array], mesh: Array, values: Array, *, quarterings: int = 6
) -> tuple[Array, Array, Array]:
    """Add speeds where roots cannot be matched beyond doubt, until they can or the cell is tiny.

    Parameters
    ----------
    values_at : callable
        Roots (m, n_roots) at speeds (m,). [1/s]
    mesh : ndarray, shape (n_V,)
        Ascending speeds. [m/s]
    values : complex ndarray, shape (n_V, n_roots)
        Roots there. [1/s]
    quarterings : int
        How often a cell may be cut into four.

    Returns
    -------
    mesh, values, steps : ndarray, shapes (n,), (n, n_roots) and (n - 1, n_roots)
        The finer mesh, which contains the given one, its roots, and the matches of
        `steps_between`. [m/s, 1/s, -]

    References
    ----------
    docs/architecture.md, "Tracking".

    Examples
    --------
    >>> def values_at(V):
    ...     return np.stack([1j * (1.0 + V), 1j * (2.1 - V)], axis=1)
    >>> V = np.array([0.0, 0.5, 1.0])
    >>> len(resolved_mesh(values_at, V, values_at(V))[0]) > 3
    True
    """
    steps, clear, sure = _nearest(values)
    doubtful = ~clear
    depth = np.zeros(len(mesh) - 1, dtype=int)
    while True:
        cells = np.flatnonzero(doubtful & (depth < quarterings))
        if not cells.size:
            return mesh, values, _settled(values, steps, sure)
        inside = (mesh[cells, None] + np.diff(mesh)[cells, None] * np.array([0.25, 0.5, 0.75])).ravel()
        depth[cells] += 1
        place = np.repeat(cells + 1, 3)
        mesh = np.insert(mesh, place, inside)
        values = np.insert(values, place, values_at(inside), axis=0)
        depth, doubtful, sure = (np.insert(x, place, np.repeat(x[cells], 3)) for x in (depth, doubtful, sure))
        steps = np.insert(steps, place, 0, axis=0)
        parts = (cells + 3 * np.arange(cells.size))[:, None] + np.arange(4)
        parts = parts.ravel()
        pairs = np.empty((2 * parts.size, values.shape[1]), dtype=complex)
        pairs[0::2], pairs[1::2] = values[parts], values[parts + 1]
        found, clear, certain = _nearest(pairs)
        steps[parts], doubtful[parts], sure[parts] = found[0::2], ~clear[0::2], certain[0::2]
