"""Many scalar roots at once: bracketing and maximisation of vectorised functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


def bracketed_roots(
    f: Callable[[Array, Array], Array], low: Array, high: Array, f_low: Array, f_high: Array, *, rtol: float = 1e-13
) -> Array:
    """Zeros of many scalar functions, one in each bracket, by Chandrupatla's method.

    Parameters
    ----------
    f : callable
        `f(x, index)` gives the values of the functions number `index` at `x`, all of shape (m,).
    low, high : ndarray, shape (n,)
        Ends of the brackets. [unit of x]
    f_low, f_high : ndarray, shape (n,)
        Values there; of opposite sign, or zero. [unit of f]
    rtol : float
        Width of a bracket, relative to its position, at which it counts as a root. [-]

    Returns
    -------
    root : ndarray, shape (n,)
        The zero in each bracket. [unit of x]

    Raises
    ------
    ValueError
        If a bracket has values of one sign.

    References
    ----------
    Chandrupatla, Advances in Engineering Software 28(3), 1997, 145-149.

    Examples
    --------
    >>> one, two = np.array([1.0]), np.array([2.0])
    >>> x = bracketed_roots(lambda x, i: x**2 - 2.0, one, two, -one, two)
    >>> round(float(x[0]), 12)
    1.414213562373
    """
    a, b, fa, fb = (np.array(v, dtype=float) for v in (high, low, f_high, f_low))
    if np.any(fa * fb > 0.0):
        raise ValueError("a bracket has values of one sign at both ends")
    root = np.where(np.abs(fa) < np.abs(fb), a, b)
    index = np.flatnonzero((fa != 0.0) & (fb != 0.0))
    a, b, fa, fb = a[index], b[index], fa[index], fb[index]
    c, fc, t = a, fa, np.full(a.shape, 0.5)
    for _ in range(200):
        if not index.size:
            break
        x = a + t * (b - a)
        fx = f(x, index)
        same = np.sign(fx) == np.sign(fa)
        c, fc = np.where(same, a, b), np.where(same, fa, fb)
        b, fb = np.where(same, b, a), np.where(same, fb, fa)
        a, fa = x, fx
        best = np.where(np.abs(fa) < np.abs(fb), a, b)
        tolerance = rtol * np.abs(best) + 1e-300
        width = np.abs(b - a)
        done = (width < 2.0 * tolerance) | (fx == 0.0)
        root[index[done]] = best[done]
        keep = ~done
        index, a, b, c, fa, fb, fc = (v[keep] for v in (index, a, b, c, fa, fb, fc))
        if index.size:
            t = _next_fraction(a, b, c, fa, fb, fc, (tolerance / np.where(width > 0.0, width, 1.0))[keep])
    root[index] = a
    return root


def _next_fraction(a: Array, b: Array, c: Array, fa: Array, fb: Array, fc: Array, edge: Array) -> Array:
    """Inverse quadratic step where it is safe, else halving."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        t = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        safe = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi) & np.isfinite(t)
    return np.clip(np.where(safe, t, 0.5), np.minimum(edge, 0.5), 1.0 - np.minimum(edge, 0.5))


def largest_between(
    f: Callable[[Array, Array], Array], low: Array, high: Array, *, steps: int = 22
) -> tuple[Array, Array]:
    """Place and value of the largest value of many functions, each inside its interval.

    Golden-section search; it ends early for a function that has turned positive, since the
    callers only ask whether a hump reaches above zero.

    Parameters
    ----------
    f : callable
        `f(x, index)` gives the values of the functions number `index` at `x`, all of shape (m,).
    low, high : ndarray, shape (n,)
        Ends of the intervals. [unit of x]
    steps : int
        Number of section steps; each narrows the interval by 0.618.

    Returns
    -------
    x, value : ndarray, shape (n,)
        Best point found and its value. [unit of x, unit of f]

    References
    ----------
    Kiefer, Proc. American Mathematical Society 4(3), 1953, 502-506.

    Examples
    --------
    >>> x, v = largest_between(lambda x, i: -((x - 0.3) ** 2) - 1.0, np.array([0.0]), np.array([1.0]))
    >>> round(float(x[0]), 4), round(float(v[0]), 4)
    (0.3, -1.0)
    """
    golden = (np.sqrt(5.0) - 1.0) / 2.0
    every = np.arange(len(low))
    a, b = np.array(low, dtype=float), np.array(high, dtype=float)
    x1, x2 = b - golden * (b - a), a + golden * (b - a)
    f1, f2 = f(x1, every), f(x2, every)
    for _ in range(steps):
        active = np.flatnonzero(np.maximum(f1, f2) <= 0.0)
        if not active.size:
            break
        left = f1[active] >= f2[active]
        i, j = active[left], active[~left]
        b[i], x2[i], f2[i] = x2[i], x1[i], f1[i]
        x1[i] = b[i] - golden * (b[i] - a[i])
        a[j], x1[j], f1[j] = x1[j], x2[j], f2[j]
        x2[j] = a[j] + golden * (b[j] - a[j])
        fresh = f(np.where(left, x1[active], x2[active]), active)
        f1[i], f2[j] = fresh[left], fresh[~left]
    return np.where(f1 >= f2, x1, x2), np.maximum(f1, f2)
