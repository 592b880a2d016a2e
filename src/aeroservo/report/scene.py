"""Data of the three-dimensional view, for `assets/wing3d.js`.

`createWing(container, data)` takes an object with

- `patches`: list of {start, rows, cols, kind}: grids of points, `start` the first point's number, row by row;
- `points`: 3 n numbers, x aft, y starboard, z up [m];
- `shapes`: list of {name, xyz}: displacement of every point (3 n numbers) per unit of a coordinate or a control;
- `scale`: multiplies what is drawn of all motion (a slider changes it) [-];
- `modes` (optional): {speeds: [m/s], start, branches: [{name, omega, growth, damping, shape}]}, each a list over the
  speeds: imaginary part [rad/s] and real part [1/s] of the root, damping ratio, and the shape as [re, im, re, im, ...]
  over the coordinates, sized so that the largest displacement is a tenth of the span;
- `histories` (optional): list of {name, t, values: {shape: [...]}, gust, speed, rate, scale, readings: [{name, unit,
  values}]}: values over time t [s], gust velocity at the reference point [m/s, up positive], airspeed [m/s], time on
  the screen per second of time, scale of the motion to begin with.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.aeroelastic.flutter import FlutterResult
from aeroservo.report.figures import shown_branches
from aeroservo.report.lattice3d import Lattice3D
from aeroservo.simulate.history import TimeHistory

Array = NDArray[Any]

#: Largest displacement of a mode that is shown, part of the largest extent.
SIZE = 0.1
#: Speeds at which modes can be looked at, and samples of a history, at most.
MOST_SPEEDS, MOST_SAMPLES = 60, 1500


def scene_data(
    lattice: Lattice3D, *, modes: Mapping[str, Any] | None = None, histories: Sequence[Mapping[str, Any]] = ()
) -> dict[str, Any]:
    """A whole scene.

    Parameters
    ----------
    lattice : Lattice3D
        What is drawn.
    modes : mapping, optional
        Of `mode_data`.
    histories : sequence of mapping
        Of `history_data`.

    Returns
    -------
    data : dict
        As above. [SI]
    """
    patches, start = [], 0
    for p in lattice.patches:
        rows, cols = p.points.shape[:2]
        patches.append({"start": start, "rows": rows, "cols": cols, "kind": p.kind})
        start += rows * cols
    data: dict[str, Any] = {
        "patches": patches,
        "points": np.round(lattice.points.ravel(), 6),
        "shapes": [{"name": n, "xyz": short(xyz.ravel())} for n, xyz in zip(lattice.names, lattice.shapes)],
        "scale": 1.0,
    }
    if modes is not None:
        data["modes"] = dict(modes)
    if histories:
        data["histories"] = [dict(h) for h in histories]
    return data


def mode_data(lattice: Lattice3D, found: FlutterResult) -> dict[str, Any]:
    """Modes along the root locus.

    Parameters
    ----------
    lattice : Lattice3D
        What is drawn.
    found : FlutterResult
        Of `aeroservo.flutter`, with followed branches.

    Returns
    -------
    modes : dict
        As `scene_data` takes it: the branches that figures show, at speeds evenly over the sweep. [SI]
    """
    n_points = len(found.V)
    chosen = np.unique(np.linspace(0, n_points - 1, min(MOST_SPEEDS, n_points)).round().astype(int))
    extent = float(np.ptp(lattice.points, axis=0).max())
    branches = []
    for j in shown_branches(found):
        roots, shapes = found.roots[chosen, j], found.shapes[chosen, j]
        steady = _aligned(shapes)
        sized = [_sized(lattice, s, SIZE * extent) for s in steady]
        branches.append(
            {
                "name": found.names[j],
                "omega": np.abs(roots.imag),
                "growth": roots.real,
                "damping": found.damping_ratio[chosen, j],
                "shape": [short(np.stack([s.real, s.imag], axis=-1).ravel()) for s in sized],
            }
        )
    V = found.V[chosen]
    start = 0 if found.flutter_speed is None else int(np.argmin(np.abs(V - found.flutter_speed)))
    return {"speeds": V, "start": start, "branches": branches}


def history_data(
    lattice: Lattice3D,
    history: TimeHistory,
    *,
    name: str,
    channels: Mapping[str, str],
    speed: float,
    scale: float | None = None,
    rate: float = 1.0,
) -> dict[str, Any]:
    """A run to be replayed.

    Parameters
    ----------
    lattice : Lattice3D
        What is drawn.
    history : TimeHistory
        The run.
    name : str
        What to call it.
    channels : mapping of str to str
        Channel of each shape that moves.
    speed : float
        Airspeed with which the gust passes. [m/s]
    scale : float, optional
        Of the motion; default so that its largest is a tenth of the span, no less than true. [-]
    rate : float
        Seconds of the run per second on the screen. [-]

    Returns
    -------
    history : dict
        As `scene_data` takes it. [SI]
    """
    step = max(1, -(-len(history.t) // MOST_SAMPLES))
    values = {shape: np.asarray(history[c])[::step] for shape, c in channels.items() if c in history.channels}
    motion = np.zeros((len(history.t[::step]), len(lattice.names)))
    for shape, value in values.items():
        motion[:, lattice.names.index(shape)] = value
    if scale is None:
        few = motion[:: max(1, len(motion) // 120)]
        moved = np.abs(np.einsum("tj,jpk->tpk", few, lattice.shapes)).max(initial=0.0)
        extent = float(np.ptp(lattice.points, axis=0).max())
        scale = float(np.clip(SIZE * extent / moved, 1.0, 100.0)) if moved > 0.0 else 1.0
    gust = np.asarray(history["gust_m_s"])[::step] if "gust_m_s" in history.channels else None
    readings = [
        {"name": label, "unit": unit, "values": short(factor * np.asarray(history[c])[::step])}
        for c, label, unit, factor in _READINGS
        if c in history.channels and np.any(history[c])
    ]
    return {
        "name": name,
        "t": np.round(history.t[::step], 6),
        "values": {shape: short(value) for shape, value in values.items()},
        "gust": None if gust is None or not np.any(gust) else short(gust),
        "speed": speed,
        "rate": rate,
        "scale": scale,
        "readings": readings,
    }


#: Channels read out beside the picture: name, label, unit, factor.
_READINGS = (
    ("plunge_m", "plunge (down)", "m", 1.0),
    ("pitch_rad", "pitch (nose up)", "°", 180.0 / np.pi),
    ("elevon_rad", "elevon (trailing edge down)", "°", 180.0 / np.pi),
    ("gust_m_s", "gust (up)", "m/s", 1.0),
    ("speed_m_s", "airspeed", "m/s", 1.0),
)


def short(values: Array) -> Array:
    """Values with five digits of the largest: what a drawing needs.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Any. [any]

    Returns
    -------
    values : ndarray, shape (n,)
        Rounded; nan stays. [unit of `values`]
    """
    size = float(np.nanmax(np.abs(values), initial=0.0)) if np.any(np.isfinite(values)) else 0.0
    if size == 0.0:
        return np.asarray(values)
    return np.asarray(np.round(values, int(5 - np.ceil(np.log10(size)))))


def _sized(lattice: Lattice3D, shape: Array, size: float) -> Array:
    """A complex shape whose largest displacement is `size`."""
    if not np.all(np.isfinite(shape)):
        return np.zeros(shape.shape, complex)
    moved = np.einsum("j,jpk->pk", shape, lattice.shapes[: len(shape)])
    largest = float(np.sqrt(np.sum(np.abs(moved) ** 2, axis=-1)).max(initial=0.0))
    return shape * (size / largest) if largest > 0.0 else shape


def _aligned(shapes: Array) -> Array:
    """Phases so that the shape changes little from speed to speed."""
    out = np.array(shapes, dtype=complex)
    last = None
    for k in range(len(out)):
        if not np.all(np.isfinite(out[k])):
            continue
        if last is None:
            lead = out[k][np.argmax(np.abs(out[k]))]
        else:
            lead = np.vdot(last, out[k])
        if abs(lead) > 0.0:
            out[k] = out[k] * (np.conj(lead) / abs(lead))
        last = out[k]
    return out
