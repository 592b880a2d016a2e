"""Polars from points: gridding converged points, dropping wild ones, the tables that come with the package."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from importlib.resources import files

import numpy as np

from aeroservo.aero.polars import Polar

#: Widest gap in angle of attack over which a table is filled by a straight line. [rad]
WIDEST_GAP = float(np.radians(2.01))


def polar_from_points(
    name: str, source: str, points: np.ndarray, *, alpha_step: float = float(np.radians(0.5))
) -> Polar:
    """A polar on a regular grid from scattered converged points.

    Parameters
    ----------
    name, source : str
        Labels.
    points : array_like, shape (n, 6)
        Rows of Reynolds number [-], deflection [rad], angle of attack [rad], CL, CD, CM [-].
    alpha_step : float
        Step of the angle of attack. [rad]

    Returns
    -------
    Polar
        Linear between neighbouring points no farther apart than 2 degrees; NaN elsewhere.

    Raises
    ------
    ValueError
        If there is no point.

    References
    ----------
    Project convention: polars, "gaps".

    Examples
    --------
    >>> rows = [(1e6, 0.0, a, 6 * a, 0.01, 0.0) for a in (-0.02, 0.0, 0.02)]
    >>> polar_from_points("plate", "formula", rows, alpha_step=0.01).alpha.round(3).tolist()
    [-0.02, -0.01, 0.0, 0.01, 0.02]
    """
    rows = np.asarray(points, dtype=float).reshape(-1, 6)
    if not len(rows):
        raise ValueError(f"polar {name!r} has no converged point")
    reynolds = np.unique(rows[:, 0])
    _, first = np.unique(np.round(rows[:, 1], 9), return_index=True)
    delta = rows[first, 1]
    low, high = np.round(rows[:, 2].min() / alpha_step), np.round(rows[:, 2].max() / alpha_step)
    alpha = np.arange(low, high + 0.5) * alpha_step
    tables = np.full((3, len(reynolds), len(delta), len(alpha)), np.nan)
    for i, re in enumerate(reynolds):
        for j, d in enumerate(delta):
            mine = rows[(rows[:, 0] == re) & (np.abs(rows[:, 1] - d) < 1e-8)]
            mine = mine[np.argsort(mine[:, 2])]
            if len(mine):
                tables[:, i, j] = _gridded(alpha, mine)
    return Polar(
        name=name, source=source, alpha=alpha, delta=delta, reynolds=reynolds, CL=tables[0], CD=tables[1], CM=tables[2]
    )


def shipped_polar(name: str, kind: str) -> Polar:
    """A table that comes with the package.

    Parameters
    ----------
    name : str
        "mh62".
    kind : {"hinged", "morphed"}
        Kind of the control over the last quarter of the chord; morphed with the hinged one's trailing-edge drop.

    Returns
    -------
    Polar
        MH 62 for Reynolds numbers 0.5 to 2.5 million and -10 to 15 degrees of deflection (in steps of 2.5 degrees, the
        morphed one of 5), Ncrit 9, free transition.

    Raises
    ------
    ValueError
        If there is no such table.

    References
    ----------
    M. Drela, XFOIL 6.99, 2013; made by `scripts/make_polars.py`, see aero/airfoils/SOURCE.md.

    Examples
    --------
    >>> shipped_polar("mh62", "hinged").delta.size
    11
    """
    key = "".join(c for c in name.lower() if c.isalnum())
    resource = files("aeroservo.aero") / "airfoils" / f"{key}_{kind}.csv"
    if not resource.is_file():
        raise ValueError(f"no shipped polar of {name!r}, {kind!r}: there are mh62 hinged and mh62 morphed")
    lines = resource.read_text(encoding="utf-8").splitlines()
    source = next((line[1:].strip() for line in lines if line.startswith("# source:")), "")
    rows = list(csv.reader(line for line in lines if line and line[0] not in "#r"))
    points = np.array(rows, dtype=float)
    points[:, 1:3] = np.radians(points[:, 1:3])
    return polar_from_points(f"{name} {kind}", source.removeprefix("source:").strip(), points)


def reject_wild_points(rows: Sequence[Sequence[float]], *, lift: float = 0.06, drag: float = 0.4) -> np.ndarray:
    """Converged points without the isolated ones that jump away from both neighbours.

    Parameters
    ----------
    rows : sequence, shape (n, m)
        Points of one sweep in ascending angle of attack [rad]: alpha, CL, CD first, anything behind them. [-]
    lift : float
        Largest jump of CL against the line between the neighbours, both ways. [-]
    drag : float
        Largest jump of the logarithm of CD. [-]

    Returns
    -------
    kept : ndarray, shape (k, m)
        The points left. [-]

    References
    ----------
    Project convention: a point goes only if both neighbours agree with each other and not with it.

    Examples
    --------
    >>> rows = [(0.00, 0.0, 0.01), (0.01, 0.06, 0.01), (0.02, 0.12, 0.001), (0.03, 0.18, 0.01), (0.04, 0.24, 0.01)]
    >>> reject_wild_points(rows)[:, 0].tolist()
    [0.0, 0.01, 0.03, 0.04]
    """
    table = np.asarray(rows, dtype=float)
    if len(table) < 5:
        return table
    keep = np.ones(len(table), dtype=bool)
    for i in range(1, len(table) - 1):
        before, here, after = table[i - 1], table[i], table[i + 1]
        if after[0] - before[0] > 2.0 * WIDEST_GAP:
            continue
        t = (here[0] - before[0]) / (after[0] - before[0])
        jump_lift = abs(here[1] - before[1] - t * (after[1] - before[1]))
        log = np.log(np.maximum([before[2], here[2], after[2]], 1e-9))
        jump_drag = abs(log[1] - log[0] - t * (log[2] - log[0]))
        smooth_lift = abs(after[1] - before[1]) < 8.0 * (after[0] - before[0])
        keep[i] = not ((jump_lift > lift and smooth_lift) or (jump_drag > drag and abs(log[2] - log[0]) < drag))
    return table[keep]


def _gridded(alpha: np.ndarray, mine: np.ndarray) -> np.ndarray:
    """One sweep on the regular axis, shape (3, n_a)."""
    out = np.full((3, len(alpha)), np.nan)
    x = mine[:, 2]
    right = np.clip(np.searchsorted(x, alpha - 1e-9), 0, len(x) - 1)
    left = np.maximum(right - 1, 0)
    exact = np.abs(x[right] - alpha) < 1e-9
    width = x[right] - x[left]
    between = (alpha > x[0]) & (alpha < x[-1]) & (width > 0.0) & (width <= WIDEST_GAP)
    t = np.where(width > 0.0, (alpha - x[left]) / np.where(width > 0.0, width, 1.0), 0.0)
    for k in range(3):
        y = mine[:, 3 + k]
        out[k] = np.where(exact, y[right], np.where(between, y[left] + t * (y[right] - y[left]), np.nan))
    return out
