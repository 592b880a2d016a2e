"""Where the stability of a model changes with speed, found without following modes.

Sorted by growth, the roots of one kind are continuous functions of speed whoever they belong to.
So the number of unstable roots is all one needs: between two speeds where it differs there is a
boundary, and where it does not, the largest negative growths are maximised to see whether a hump
reaches above zero between them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from aeroservo.aeroelastic.rootfinding import bracketed_roots, largest_between

Array = NDArray[Any]
Kind = Literal["oscillatory", "real", "split", "merge"]

NEUTRAL = 1e-9
"""Growth below this part of |s| (of the frequency scale for a real root) counts as neutral."""

CROSSES = 1e-6
"""Growth below this part of the frequency scale, where a boundary was refined to, is a crossing of zero."""

SPLIT_GAP = 1e-3
"""A pair and the two real roots that it becomes may change at speeds this part of the speed apart (p-k, g)."""

NARROWEST = 1e-4
"""Two boundaries closer than this part of the speed may be seen as one or none."""


@dataclass(frozen=True, kw_only=True)
class Boundary:
    """A speed at which the set of unstable roots changes.

    Attributes
    ----------
    V : float
        True airspeed. [m/s]
    kind : {"oscillatory", "real", "split", "merge"}
        A pair crosses the axis, a real root crosses zero, an unstable pair becomes two unstable
        real roots, or the reverse.
    opens : bool
        True where a root becomes unstable with growing speed (split and merge: True).
    root : complex
        The root that changes (omega >= 0). [1/s]
    """

    V: float
    kind: Kind
    opens: bool
    root: complex


def unstable_counts(values: Array, scale: float) -> tuple[Array, Array]:
    """Numbers of unstable pairs and of unstable real roots.

    Parameters
    ----------
    values : complex ndarray, shape (n_V, n_roots)
        Roots, nan where absent. [1/s]
    scale : float
        Frequency scale for the neutral band of real roots. [rad/s]

    Returns
    -------
    pairs, reals : int ndarray, shape (n_V,)
        Counts. [-]

    References
    ----------
    contract.md, "flutter" (intervals and their kinds).

    Examples
    --------
    >>> unstable_counts(np.array([[1 + 2j, 1 - 2j, 0.5, -3.0]]), 1.0)
    (array([1]), array([1]))
    """
    pairs = (values.imag > 0.0) & (values.real > NEUTRAL * np.abs(values))
    reals = (values.imag == 0.0) & (values.real > NEUTRAL * scale)
    return pairs.sum(axis=-1), reals.sum(axis=-1)


def growth(values: Array, *, oscillatory: bool) -> Array:
    """Real parts of the roots of one kind in descending order; -inf where there are fewer.

    Parameters
    ----------
    values : complex ndarray, shape (n_V, n_roots)
        Roots. [1/s]
    oscillatory : bool
        Upper-half-plane roots, else real ones.

    Returns
    -------
    sigma : ndarray, shape (n_V, n_roots)
        Growth rates. [1/s]

    References
    ----------
    equations.md, "Conventions" (s = sigma + i omega).

    Examples
    --------
    >>> growth(np.array([[-1 + 2j, -1 - 2j, 0.5, -3.0]]), oscillatory=False)[0, :2]
    array([ 0.5, -3. ])
    """
    member = values.imag > 0.0 if oscillatory else values.imag == 0.0
    sigma = np.where(member & np.isfinite(values.real), values.real, -np.inf)
    return -np.sort(-sigma, axis=-1)


def boundaries(values_at: Callable[[Array], Array], mesh: Array, values: Array, scale: float) -> list[Boundary]:
    """Every change of stability between the ends of a mesh of speeds.

    Parameters
    ----------
    values_at : callable
        Roots (m, n_roots) at speeds (m,). [1/s]
    mesh : ndarray, shape (n_V,)
        Ascending speeds. [m/s]
    values : complex ndarray, shape (n_V, n_roots)
        Roots there. [1/s]
    scale : float
        Frequency scale of the model. [rad/s]

    Returns
    -------
    boundaries : list of Boundary
        In order of speed, refined to 1e-12 relative (splits and merges 1e-9; a real root that passes another at
        rest at zero, to the neutral band).

    References
    ----------
    contract.md, "flutter".

    Examples
    --------
    >>> def values_at(V):
    ...     return np.stack([0.1 * (V - 3.0) + 2j, 0.1 * (V - 3.0) - 2j], axis=1)
    >>> V = np.array([1.0, 2.0, 4.0])
    >>> round(boundaries(values_at, V, values_at(V), 2.0)[0].V, 9)
    3.0
    """
    for oscillatory in (True, False):
        for sign in (1.0, -1.0):
            mesh, values = _with_extremes(values_at, mesh, values, oscillatory, sign)
    mesh, values = _with_meetings(values_at, mesh, values, scale)
    low, high = _isolated(values_at, mesh, values, scale)
    if not low.size:
        return []
    low, high = _joined(values_at, low, high, scale)
    before, after = (np.stack(unstable_counts(values_at(V), scale), axis=1) for V in (low, high))
    split = ((after - before)[:, 0] * (after - before)[:, 1]) < 0
    found = _splits(values_at, low[split], high[split], before[split], after[split], scale)
    for kind, oscillatory in enumerate((True, False)):
        counts = before[~split, kind], after[~split, kind]
        found += _crossings(values_at, low[~split], high[~split], counts, oscillatory, scale, (mesh[0], mesh[-1]))
    return sorted(found, key=lambda boundary: boundary.V)


def _with_extremes(
    values_at: Callable[[Array], Array], mesh: Array, values: Array, oscillatory: bool, sign: float
) -> tuple[Array, Array]:
    """The mesh with the tops of humps (sign 1), bottoms of dips (-1), that reach past zero between its speeds."""
    missing = -1e30
    sigma = growth(values, oscillatory=oscillatory)
    used = int(np.sum(np.any(np.isfinite(sigma), axis=0)))
    sigma = np.where(np.isfinite(sigma[:, :used]), sign * sigma[:, :used], missing)
    left = np.vstack([sigma[:1], sigma[:-1]])
    right = np.vstack([sigma[1:], sigma[-1:]])
    reach = 2.0 * np.maximum(sigma - left, sigma - right)
    top = (sigma < 0.0) & (sigma >= left) & (sigma >= right) & (sigma + reach > 0.0) & (sigma > missing)
    if len(mesh) > 2:  # at an end, a top lies inside only if the curve bends back
        for end, one, two in ((0, 1, 2), (-1, -2, -3)):
            first = (sigma[one] - sigma[end]) / abs(mesh[one] - mesh[end])
            second = (sigma[two] - sigma[one]) / abs(mesh[two] - mesh[one])
            bend = (first - second) / abs(mesh[two] - mesh[end]) * abs(mesh[one] - mesh[end])
            top[end] &= first + 2.0 * bend > 0.0
    i, m = np.nonzero(top)
    if not i.size:
        return mesh, values

    def height(V: Array, index: Array) -> Array:
        value = growth(values_at(V), oscillatory=oscillatory)
        value = sign * np.take_along_axis(value, m[index][:, None], axis=1)[:, 0]
        return np.where(np.isfinite(value), value, missing)

    low, high = mesh[np.maximum(i - 1, 0)], mesh[np.minimum(i + 1, len(mesh) - 1)]
    V, peak = largest_between(height, low, high)
    V = np.setdiff1d(V[peak > 0.0], mesh)
    if not V.size:
        return mesh, values
    place = np.searchsorted(mesh, V)
    return np.insert(mesh, place, V), np.insert(values, place, values_at(V), axis=0)


def _with_meetings(
    values_at: Callable[[Array], Array], mesh: Array, values: Array, scale: float
) -> tuple[Array, Array]:
    """The mesh with speeds at which an unstable pair is real, or unstable real roots a pair, for part of a cell only.

    The counts at both ends of the cell agree, so it is the square of the lowest frequency, or of the least
    distance between neighbours on the real axis, that is followed towards zero.
    """
    counts = np.stack(unstable_counts(values, scale), axis=1)
    for kind in (0, 1):
        apart = _apart(values, scale)[:, kind]
        left, right = np.append(apart[0], apart[:-1]), np.append(apart[1:], apart[-1])
        inner = np.all(counts == np.vstack([counts[:1], counts[:-1]]), axis=1)
        inner &= np.all(counts == np.vstack([counts[1:], counts[-1:]]), axis=1)
        reach = 2.0 * np.maximum(left - apart, right - apart)
        i = np.flatnonzero(inner & (apart < scale**2) & (apart <= left) & (apart <= right) & (apart < reach))
        if not i.size:
            continue

        def height(V: Array, index: Array, kind: int = kind, i: Array = i, counts: Array = counts) -> Array:
            found = values_at(V)
            now = np.stack(unstable_counts(found, scale), axis=1)
            square = _apart(found, scale)[:, kind]
            return np.where(now[:, kind] < counts[i[index], kind], scale**2, -square)

        V, peak = largest_between(height, mesh[np.maximum(i - 1, 0)], mesh[np.minimum(i + 1, len(mesh) - 1)])
        V = np.setdiff1d(V[peak > 0.0], mesh)
        place = np.searchsorted(mesh, V)
        if V.size:
            mesh, values = np.insert(mesh, place, V), np.insert(values, place, values_at(V), axis=0)
            counts = np.stack(unstable_counts(values, scale), axis=1)
    return mesh, values


def _apart(values: Array, scale: float) -> Array:
    """Squares (n_V, 2) of the lowest frequency of an unstable pair, and half the least gap of unstable reals."""
    pair = (values.imag > 0.0) & (values.real > NEUTRAL * np.abs(values))
    lowest = np.where(pair, values.imag, np.inf).min(axis=1)
    real = (values.imag == 0.0) & (values.real > NEUTRAL * scale)
    ordered = np.sort(np.where(real, values.real, np.nan), axis=1)
    gaps = np.fmin.reduce(np.diff(ordered, axis=1), axis=1, initial=np.inf)
    return np.asarray(np.minimum(np.stack([lowest, 0.5 * gaps], axis=1), scale) ** 2)


def _isolated(values_at: Callable[[Array], Array], mesh: Array, values: Array, scale: float) -> tuple[Array, Array]:
    """Cells, no wider than NARROWEST, across which the counts of unstable roots differ."""
    counts = np.stack(unstable_counts(values, scale), axis=1)
    differ = np.any(counts[1:] != counts[:-1], axis=1)
    low, high = mesh[:-1][differ], mesh[1:][differ]
    count_low, count_high = counts[:-1][differ], counts[1:][differ]
    while True:
        wide = (high - low) > NARROWEST * high
        if not wide.any():
            return low, high
        middle = 0.5 * (low[wide] + high[wide])
        count = np.stack(unstable_counts(values_at(middle), scale), axis=1)
        first = np.any(count != count_low[wide], axis=1)
        second = np.any(count != count_high[wide], axis=1)
        new_low = np.concatenate([low[~wide], low[wide][first], middle[second]])
        new_high = np.concatenate([high[~wide], middle[first], high[wide][second]])
        count_low = np.concatenate([count_low[~wide], count_low[wide][first], count[second]])
        count_high = np.concatenate([count_high[~wide], count[first], count_high[wide][second]])
        low, high = new_low, new_high


def _joined(values_at: Callable[[Array], Array], low: Array, high: Array, scale: float) -> tuple[Array, Array]:
    """Cells in which a pair goes and its two real roots come, or the reverse, as one.

    p-k and g take aperiodic roots from another matrix than oscillations, so the two need not change at one speed.
    """
    order = np.argsort(low)
    low, high = low[order], high[order]
    before, after = (np.stack(unstable_counts(values_at(V), scale), axis=1) for V in (low, high))
    change = (after - before).tolist()
    keep = np.ones(len(low), dtype=bool)
    for j in range(len(low) - 1):
        together = sorted([change[j], change[j + 1]])
        near = low[j + 1] - high[j] <= SPLIT_GAP * high[j]
        if keep[j] and near and together in ([[-1, 0], [0, 2]], [[0, -2], [1, 0]]):
            high[j], keep[j + 1] = high[j + 1], False
    return low[keep], high[keep]


def _crossings(
    values_at: Callable[[Array], Array],
    low: Array,
    high: Array,
    counts: tuple[Array, Array],
    oscillatory: bool,
    scale: float,
    limits: tuple[float, float],
) -> list[Boundary]:
    """Zeros of the growth of each root of one kind that is unstable at one end of a cell only.

    Where the growth does not change sign (a root leaves the neutral band without having crossed zero), or a
    root at rest at zero hides the crossing of another, the edge of the neutral band is the boundary.
    """
    cells = [
        (j, m) for j, (first, second) in enumerate(zip(*counts)) for m in range(min(first, second), max(first, second))
    ]
    if not cells:
        return []
    cell, number = np.array(cells).T
    banded = np.zeros(len(cells), dtype=bool)

    def height(V: Array, index: Array) -> Array:
        values = values_at(V)
        sigma = growth(values, oscillatory=oscillatory)
        value = np.take_along_axis(sigma, number[index][:, None], axis=1)[:, 0]
        band = NEUTRAL * scale
        if oscillatory:
            same = (values.imag > 0.0) & (values.real == value[:, None])
            band = NEUTRAL * np.where(same, np.abs(values), 0.0).max(axis=1)
        return np.maximum(value - np.where(banded[index], band, 0.0), -scale)

    def resting(V: Array) -> Array:
        values = values_at(V)
        return np.any((values.imag == 0.0) & (np.abs(values.real) <= NEUTRAL * scale), axis=1)

    low, high, every = low[cell], high[cell], np.arange(len(cell))
    if not oscillatory:
        banded |= resting(low) | resting(high)
    banded |= height(low, every) * height(high, every) >= 0.0
    at_low, at_high = height(low, every), height(high, every)
    V = bracketed_roots(height, low, high, at_low, at_high)
    opens = at_low < at_high
    for reach in (1e-6, 1e-5, 1e-4, 1e-3) if oscillatory else ():  # a shallow crossing lies a little before the band
        edge = np.flatnonzero(banded)
        if not edge.size:
            break
        far = np.clip(V[edge] * (1.0 + np.where(opens[edge], -reach, reach)), *limits)
        banded[edge] = False
        at_edge, at_far = height(V[edge], edge), height(far, edge)
        crossed = at_edge * at_far < 0.0
        banded[edge[~crossed]] = True
        back = edge[crossed]

        def plain(V: Array, index: Array, back: Array = back) -> Array:
            return height(V, back[index])

        if back.size:
            V[back] = bracketed_roots(plain, far[crossed], V[back], at_far[crossed], at_edge[crossed])
    passes = np.abs(height(V, every)) <= CROSSES * scale  # else a root that came or went where it was
    return _at_crossings(values_at, V[passes], opens[passes], oscillatory)


def _at_crossings(values_at: Callable[[Array], Array], V: Array, opens: Array, oscillatory: bool) -> list[Boundary]:
    """Boundaries at refined speeds, each with the root that is neutral there."""
    found = []
    for speed, unstable in zip(V, opens):
        values = values_at(np.array([speed]))[0]
        member = values[values.imag > 0.0] if oscillatory else np.zeros(1, dtype=complex)
        root = 1j * member[np.argmin(np.abs(member.real))].imag
        kind: Kind = "oscillatory" if oscillatory else "real"
        found.append(Boundary(V=float(speed), kind=kind, opens=bool(unstable), root=complex(root)))
    return found


def _splits(
    values_at: Callable[[Array], Array], low: Array, high: Array, before: Array, after: Array, scale: float
) -> list[Boundary]:
    """Where an unstable pair becomes two unstable real roots, or the reverse."""
    if not low.size:
        return []
    while np.any(high - low > 1e-10 * high):
        middle = 0.5 * (low + high)
        same = np.all(np.stack(unstable_counts(values_at(middle), scale), axis=1) == before, axis=1)
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    found = []
    for j, V in enumerate(high):
        splits = bool(after[j, 0] < before[j, 0])
        pair = values_at(np.array([low[j] if splits else V]))[0]
        unstable = pair[(pair.imag > 0.0) & (pair.real > 0.0)]
        root = complex(unstable[np.argmin(unstable.imag)].real) if unstable.size else 0j
        found.append(Boundary(V=float(V), kind="split" if splits else "merge", opens=True, root=root))
    return found
