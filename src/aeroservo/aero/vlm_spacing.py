"""Where the edges of strips and panels lie: even, or closer together where the loading changes fast."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

Spacing = Literal["uniform", "cosine", "tip"]
SPACINGS = ("uniform", "cosine", "tip")


def span_edges(n: int, breaks: Sequence[float] = (), *, spacing: Spacing = "cosine") -> tuple[np.ndarray, np.ndarray]:
    """Edges and control stations of n strips over [0, 1] that fall on given breaks.

    Parameters
    ----------
    n : int
        Number of strips.
    breaks : sequence of float
        Stations that must be edges: sections and ends of controls. [-]
    spacing : {"cosine", "tip", "uniform"}
        Strips closer together at both ends, at 1 only, or evenly.

    Returns
    -------
    edges : ndarray, shape (n + 1,)
        Ascending, from 0 to 1. [-]
    control : ndarray, shape (n,)
        Stations half-way in the spacing's own parameter. [-]

    Raises
    ------
    ValueError
        If n is smaller than the number of intervals between the breaks.

    References
    ----------
    J. DeYoung, NASA SP-405, 1976, "Optimum lattice arrangement": control stations half-way in the angle make the
    induced drag converge fast.

    Examples
    --------
    >>> np.round(span_edges(4, [0.5])[0], 4)
    array([0.    , 0.1464, 0.5   , 0.8536, 1.    ])
    """
    shape, inverse = {
        "uniform": (lambda t: t, lambda s: s),
        "cosine": (lambda t: 0.5 * (1.0 - np.cos(np.pi * t)), lambda s: np.arccos(1.0 - 2.0 * s) / np.pi),
        "tip": (lambda t: np.sin(0.5 * np.pi * t), lambda s: np.arcsin(s) * 2.0 / np.pi),
    }[spacing]
    points = np.unique(np.round([0.0, *breaks, 1.0], 12))
    if points[0] < 0.0 or points[-1] > 1.0:
        raise ValueError(f"breaks must lie in [0, 1] of the span, got {points[0]:g} to {points[-1]:g}")
    if n < len(points) - 1:
        raise ValueError(f"{n} strips cannot resolve the {len(points) - 1} intervals between sections and controls")
    knots = inverse(points)
    index = np.round(knots * n).astype(int)
    for i in range(1, len(index)):
        index[i] = max(index[i], index[i - 1] + 1)
    index[-1] = n
    for i in range(len(index) - 2, -1, -1):
        index[i] = min(index[i], index[i + 1] - 1)
    edges = shape(np.interp(np.arange(n + 1), index, knots))
    edges[index] = points
    return edges, shape(np.interp(np.arange(n) + 0.5, index, knots))


def chord_edges(n: int, hinge: float | None = None, *, spacing: str = "uniform") -> np.ndarray:
    """Chord fractions of the edges of n panels, with an edge on the hinge.

    Parameters
    ----------
    n : int
        Number of panels.
    hinge : float or None
        Chord fraction of the hinge; None, 0 or a single panel leave it out. [-]
    spacing : {"uniform", "cosine"}
        Even, or closer at both edges.

    Returns
    -------
    edges : ndarray, shape (n + 1,)
        Ascending, from 0 to 1. [-]

    References
    ----------
    R. M. James, Computer Methods in Applied Mechanics and Engineering 1(1), 1972: with the 1/4-3/4 rule the
    flat plate's lift is exact on even panels.

    Examples
    --------
    >>> chord_edges(4, 0.75)
    array([0.  , 0.25, 0.5 , 0.75, 1.  ])
    """
    if hinge is None or hinge <= 0.0 or n < 2:
        return span_edges(n, spacing="cosine" if spacing == "cosine" else "uniform")[0]
    return span_edges(n, [hinge], spacing="cosine" if spacing == "cosine" else "uniform")[0]
