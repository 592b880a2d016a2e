"""What a report draws of every model: marks of its boundaries, numbers in words, scenes, ranges of curves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.report.blocks import Band, Failed, Mark, Scene
from aeroservo.report.lattice3d import Lattice3D, lattice3d
from aeroservo.studies.aircraft_report import MACH_LIMIT, ReportCase

Array = NDArray[Any]


def words(value: float | None, unit: str, digits: int = 4) -> str:
    """A number with its unit, or "none".

    Parameters
    ----------
    value : float, optional
        What. [`unit`]
    unit : str
        Its unit.
    digits : int
        Significant digits.

    Returns
    -------
    text : str
        For people.
    """
    if value is None or not np.isfinite(value):
        return "none"
    return f"{value:.{digits}g} {unit}".strip().replace("-", "−")


def bands(case: ReportCase) -> tuple[Band, ...]:
    """Unstable speeds and those beyond Mach 0.3, as far as they lie in the sweep.

    Parameters
    ----------
    case : ReportCase
        With flutter.

    Returns
    -------
    bands : tuple of Band
        For charts over airspeed. [m/s]
    """
    V, out = case.sweep.V, []
    for i in case.found.intervals:
        text = "unstable oscillation" if i.kind == "flutter" else "unstable, not oscillating"
        start = float(V[0]) if i.start is None else i.start
        end = float(V[-1]) if i.end is None else i.end
        out.append(Band(start=start, end=end, text=text, kind="flutter" if i.kind == "flutter" else "divergence"))
    return tuple(out)


def marks(case: ReportCase, *names: str) -> tuple[Mark, ...]:
    """Upright lines at the speeds that matter.

    Parameters
    ----------
    case : ReportCase
        With flutter and statics.
    *names : str
        Out of flutter, divergence, reversal, mach; all if none.

    Returns
    -------
    marks : tuple of Mark
        Those inside the sweep. [m/s]
    """
    V = case.sweep.V
    mach = MACH_LIMIT * case.a_sound
    reversal = case.static.reversal.V if not names or "reversal" in names else None
    every: tuple[tuple[str, float | None, str], ...] = (
        ("flutter", case.found.flutter_speed, "flutter"),
        ("divergence", case.found.divergence_speed, "divergence"),
        ("reversal", reversal, f"reversal of {case.static.reversal_quantity}" if reversal else ""),
        ("mach", mach, "Mach 0.3: beyond it incompressible theory errs"),
    )
    return tuple(
        Mark(at=at, text=text if name == "mach" else f"{text} {at:.4g} m/s", kind="limit" if name == "mach" else name)  # type: ignore[arg-type]
        for name, at, text in every
        if (not names or name in names) and at is not None and V[0] <= at <= V[-1]
    )


def drawn(case: ReportCase, data: Callable[[Lattice3D], dict[str, Any]], *, title: str, caption: str) -> Scene | Failed:
    """A scene of the model, or why there is none.

    Parameters
    ----------
    case : ReportCase
        The model.
    data : callable
        From the lattice to the data of the scene.
    title, caption : str
        Of the scene.

    Returns
    -------
    block : Scene or Failed
        Modes without a grid cannot be drawn; whatever else the part holds still comes.
    """
    try:
        lattice = lattice3d(case.file, case.model)
    except ValueError as error:
        return Failed(why=f"{title}: {error}")
    return Scene(data=data(lattice), title=title, caption=caption)


def thinned(count: int, most: int) -> slice:
    """Every k-th of `count`, at most `most`.

    Parameters
    ----------
    count, most : int
        How many there are, and may be.

    Returns
    -------
    part : slice
        Of the samples.
    """
    return slice(None, None, max(1, -(-count // most)))


def range_of(values: Sequence[Array], *, low: float | None = None, high: float | None = None) -> tuple[float, float]:
    """A range that holds all finite values, cut at `low` and `high`.

    Parameters
    ----------
    values : sequence of ndarray, shape (n,)
        Any. [any]
    low, high : float, optional
        Limits. [unit of the values]

    Returns
    -------
    range : (float, float)
        With a little room. [unit of the values]
    """
    flat = np.concatenate([np.ravel(v) for v in values])
    flat = flat[np.isfinite(flat)]
    if low is not None:
        flat = flat[flat >= low]
    if high is not None:
        flat = flat[flat <= high]
    if not flat.size:
        return (0.0 if low is None else low), (1.0 if high is None else high)
    a, b = float(flat.min()), float(flat.max())
    room = 0.06 * (b - a) or 0.5 * abs(b) or 1.0
    return a - room, b + room
