"""Named branches of roots over speed, and the unstable intervals they make."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from aeroservo.aeroelastic.roots import RootSet
from aeroservo.aeroelastic.stability import Boundary, unstable_counts
from aeroservo.aeroelastic.tracking import follow, resolved_mesh
from aeroservo.datatypes import ModalModel
from aeroservo.structure.modal import natural_modes

Array = NDArray[Any]

AT_REST = 1e-6
"""Roots smaller than this part of the largest lie at zero, as far as names are concerned."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Branches:
    """Roots followed from near rest through a range of speeds.

    Attributes
    ----------
    V : ndarray, shape (n_V,)
        Ascending speeds. [m/s]
    roots : complex ndarray, shape (n_V, n_roots)
        One branch a column, nan where it does not exist. [1/s]
    names : tuple of str
        Name of each branch; the two of a conjugate pair share it.
    primary : bool ndarray, shape (n_roots,)
        False for the lower half of a conjugate pair. [-]
    """

    V: Array
    roots: Array
    names: tuple[str, ...]
    primary: Array

    def name_at(self, V: float, root: complex, *, meeting: bool = False) -> str:
        """Name of the branch at a root; of two that share a pair or meet there, a mode before a lag."""
        i = int(np.argmin(np.abs(self.V - V)))
        row = self.roots[i]
        distance = np.where(np.isfinite(row), np.abs(row - root), np.inf)
        mirrored = np.where(np.isfinite(row), np.abs(row - np.conj(root)), np.inf)
        candidates = [int(np.argmin(distance)), int(np.argmin(mirrored))]
        resting = np.flatnonzero(distance <= AT_REST * np.nanmax(np.abs(row)))
        if root == 0.0 and resting.size > 1:  # one passes, the others stay at zero: the one that is unstable beside V
            around = self.roots[max(i - 1, 0) : i + 2][:, resting]
            return self.names[resting[int(np.argmax(np.nanmax(around.real, axis=0)))]]
        if meeting:
            candidates = [int(j) for j in np.argsort(distance, kind="stable")[:2]]
        return self.names[min(candidates, key=lambda j: (self.names[j].startswith("lag "), j))]


@dataclass(frozen=True, kw_only=True)
class Interval:
    """A range of speeds in which one root is unstable.

    Attributes
    ----------
    start, end : float or None
        Its ends; None where the root is already, or still, unstable at the end of the sweep. [m/s]
    frequency : float
        Frequency at the start (at the lowest speed where `start` is None); 0 for divergence. [rad/s]
    mode : str
        Name of the mode whose root it is.
    kind : {"flutter", "divergence"}
        Oscillatory or aperiodic.
    """

    start: float | None
    end: float | None
    frequency: float
    mode: str
    kind: Literal["flutter", "divergence"]


def follow_branches(
    modes: ModalModel,
    roots_at: Callable[[Array], RootSet],
    values_at: Callable[[Array], Array],
    mesh: Array,
    start: float,
) -> Branches:
    """Follow every root from a speed near rest through a mesh, with more speeds where a match is in doubt.

    Parameters
    ----------
    modes : ModalModel
        The structure, for names.
    roots_at, values_at : callable
        Roots with and without shapes at speeds (m,). [1/s]
    mesh : ndarray, shape (n_V,)
        Ascending speeds. [m/s]
    start : float
        Speed so low that the roots are those of the structure in still air. [m/s]

    Returns
    -------
    branches : Branches
        On a mesh that contains the given one and a lead-in from `start`. [m/s, 1/s]

    References
    ----------
    docs/architecture.md, "Tracking".

    Examples
    --------
    >>> import numpy as np
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> def roots_at(V):
    ...     return RootSet(values=np.tile([2j, -2j], (len(V), 1)), shapes=np.ones((len(V), 2, 1)))
    >>> follow_branches(one, roots_at, lambda V: roots_at(V).values, np.array([1.0, 2.0]), 0.1).names
    ('h', 'h')
    """
    lead = np.geomspace(start, mesh[0], 12)[:-1] if start < mesh[0] else np.zeros(0)
    mesh = np.concatenate([lead, mesh])
    mesh, values, steps = resolved_mesh(values_at, mesh, values_at(mesh))
    roots = np.take_along_axis(values, follow(values, steps), axis=1)
    first = roots_at(mesh[:1])
    names = _branch_names(modes, first.values[0], first.shapes[0])
    labels: list[str] = []
    primary = np.ones(roots.shape[1], dtype=bool)
    for j, root in enumerate(roots[0]):
        if np.isfinite(root):
            labels.append(names[int(np.nanargmin(np.abs(first.values[0] - root)))])
            primary[j] = root.imag >= 0.0
        else:  # appears at a higher speed
            labels.append(f"lag {len(modes.names) + j + 1}")
    return Branches(V=mesh, roots=roots, names=tuple(labels), primary=primary)


def _branch_names(modes: ModalModel, values: Array, shapes: Array) -> list[str]:
    """Names of the roots near rest: elastic modes by frequency, rigid ones by shape, the rest are lags."""
    natural = natural_modes(modes)
    elastic = [name for name, omega in zip(natural.names, natural.omega) if omega > 0.0]
    names = [""] * len(values)
    upper = np.flatnonzero(values.imag > 0.0)
    fastest = upper[np.argsort(-values[upper].imag)][: len(elastic)]
    for name, j in zip(elastic, fastest[np.argsort(values[fastest].imag)]):
        partner = int(np.nanargmin(np.abs(values - values[j].conj())))
        names[j] = names[partner] = name
    for row, (name, omega) in enumerate(zip(natural.names, natural.omega)):
        rest = [j for j, taken in enumerate(names) if not taken and np.isfinite(values[j])]
        if omega == 0.0 and rest:
            share = np.abs(shapes[rest] @ natural.shapes[:, row].conj()) / np.linalg.norm(shapes[rest], axis=1)
            j = rest[int(np.argmax(share))]
            names[j] = names[int(np.nanargmin(np.abs(values - values[j].conj())))] = name
    lags = [j for j, taken in enumerate(names) if not taken]
    for number, j in enumerate(sorted(lags, key=lambda j: (abs(values[j]), values[j].imag))):
        names[j] = f"lag {number + 1}"
    return names


def unstable_intervals(
    changes: Sequence[Boundary], branches: Branches, first_speed: float, scale: float
) -> list[Interval]:
    """Unstable ranges from the changes of stability and the roots unstable at the start.

    An interval ends where its root restabilises, or where an unstable pair becomes two unstable
    real roots: then a divergence interval opens at the same speed, and the reverse.

    Parameters
    ----------
    changes : sequence of Boundary
        In order of speed. [m/s]
    branches : Branches
        For names, and for what is unstable at the start.
    first_speed : float
        Start of the range. [m/s]
    scale : float
        Frequency scale of the model. [rad/s]

    Returns
    -------
    intervals : list of Interval
        In order of their start. [m/s]

    References
    ----------
    contract.md, "flutter".

    Examples
    --------
    >>> import numpy as np
    >>> still = Branches(V=np.array([1.0]), roots=np.array([[-1 + 2j, -1 - 2j]]), names=("h", "h"),
    ...                  primary=np.array([True, False]))
    >>> change = Boundary(V=3.0, kind="oscillatory", opens=True, root=2j)
    >>> unstable_intervals([change], still, 1.0, 2.0)[0].start
    3.0
    """
    open_: list[dict[str, Any]] = []
    closed: list[dict[str, Any]] = []
    row = branches.roots[int(np.argmin(np.abs(branches.V - first_speed)))]
    for root, name in zip(row, branches.names):
        pairs, reals = unstable_counts(np.array([[root]]), scale)
        if pairs[0] or reals[0]:
            kind, name = ("flutter", branches.name_at(first_speed, root)) if pairs[0] else ("divergence", name)
            open_.append({"start": None, "frequency": float(root.imag), "mode": name, "kind": kind, "roots": 1})

    def close(kind: str, change: Boundary, name: str) -> None:
        candidates = [i for i in open_ if i["kind"] == kind]
        if not candidates:
            return
        interval = min(candidates, key=lambda i: (i["mode"] != name, abs(i["frequency"] - change.root.imag)))
        interval["roots"] -= 1
        if interval["roots"] == 0:
            open_.remove(interval)
            closed.append({**interval, "end": change.V})

    for change in changes:
        name = branches.name_at(change.V, change.root, meeting=change.kind in ("split", "merge"))
        opening = {"start": change.V, "frequency": float(change.root.imag), "mode": name, "roots": 1}
        if change.kind in ("oscillatory", "real"):
            kind = "flutter" if change.kind == "oscillatory" else "divergence"
            if change.opens:
                open_.append({**opening, "kind": kind})
            else:
                close(kind, change, name)
        elif change.kind == "split":
            close("flutter", change, name)
            open_.append({**opening, "kind": "divergence", "roots": 2})
        else:
            close("divergence", change, name)
            close("divergence", change, name)
            open_.append({**opening, "kind": "flutter"})
    every = closed + [{**interval, "end": None} for interval in open_]
    every.sort(key=lambda i: (-1.0 if i["start"] is None else i["start"], i["kind"] != "flutter"))
    return [Interval(**{key: i[key] for key in ("start", "end", "frequency", "mode", "kind")}) for i in every]
