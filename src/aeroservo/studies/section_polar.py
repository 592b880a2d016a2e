"""A section polar of any airfoil with a control, from whatever can give it: shipped table, NeuralFoil, XFOIL."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

import numpy as np

from aeroservo.aero.airfoil import Airfoil, repanel
from aeroservo.aero.airfoil_deflect import hinged_outline, morphed_outline
from aeroservo.aero.airfoil_files import airfoil
from aeroservo.aero.polars import Polar, best_lift_to_drag, section_coefficients
from aeroservo.aero.polars_neuralfoil import neuralfoil_polar
from aeroservo.aero.polars_points import polar_from_points, shipped_polar
from aeroservo.aero.polars_xfoil import Xfoil, parse_xfoil_polar, xfoil_points
from aeroservo.aircraft.geometry import ControlKind, MorphReading

Source = Literal["auto", "table", "neuralfoil", "xfoil"]
#: Hinge of the shipped tables, in chords.
TABLE_HINGE = 0.75
_OTHERS = (
    "for any other airfoil, hinge, Reynolds number or deflection use --source neuralfoil (pip install "
    "aeroservo[airfoil]) or --source xfoil (Debian: apt-get install xfoil)"
)


def section_polar(
    name: str,
    *,
    alpha: Sequence[float] | np.ndarray,
    delta: Sequence[float] | np.ndarray,
    reynolds: Sequence[float] | np.ndarray,
    hinge: float = TABLE_HINGE,
    kind: ControlKind = "hinged",
    reading: MorphReading = "same_drop",
    source: Source = "auto",
    whole_table: bool = False,
    xfoil: Xfoil | None = None,
    progress: Callable[[str], None] | None = None,
) -> Polar:
    """Lift, drag and moment of a section over angle of attack, deflection and Reynolds number.

    Parameters
    ----------
    name : str
        Airfoil: shipped, NACA 4- or 5-digit, or the path of a coordinate file.
    alpha, delta, reynolds : array_like, shapes (n_a,), (n_d,), (n_r,)
        Ascending axes: angle of attack [rad], deflection [rad], Reynolds number [-].
    hinge : float
        Hinge, or where the bending starts, in chords. [-]
    kind : {"hinged", "morphed"}
        Kind of the control.
    reading : {"same_drop", "same_slope"}
        What equal deflection means for a morphed control.
    source : {"auto", "table", "neuralfoil", "xfoil"}
        "auto" takes the shipped table where there is one for this airfoil and control, else NeuralFoil, else XFOIL,
        whichever is installed. It never leaves a table whose range does not hold what was asked.
    whole_table : bool
        Give a shipped table as it is, on its own axes, once its range is known to hold those asked for.
    xfoil : Xfoil, optional
        How to run XFOIL; its sweep otherwise holds the angles asked for.
    progress : callable, optional
        Called with each run of XFOIL before it starts.

    Returns
    -------
    polar : Polar
        NaN where there is no converged or trusted point; nothing is extrapolated. CM about the quarter chord. [-]

    Raises
    ------
    ValueError
        If there is no such airfoil, the table does not reach, or what is needed is not installed.
    """
    alpha, delta, reynolds = (np.unique(np.asarray(v, dtype=float)) for v in (alpha, delta, reynolds))
    if not np.all(reynolds > 0.0):
        raise ValueError(f"Reynolds numbers must be > 0 [-], got {reynolds.min():g}")
    chosen = _chosen(name, hinge, kind, reading, source)
    if chosen == "table":
        table = shipped_polar(name, kind)
        _check_reach(table, delta, reynolds)
        return table if whole_table else resampled(table, alpha, delta, reynolds)
    foil = airfoil(name)
    if chosen == "neuralfoil" and not (kind == "morphed" and reading == "same_slope"):
        return neuralfoil_polar(foil, alpha=alpha, delta=delta, reynolds=reynolds, hinge=hinge, kind=kind)
    if chosen == "neuralfoil":  # half the drop: the outline of tan(d') = tan(d)/2 with the other reading
        half = np.arctan(0.5 * np.tan(delta))
        found = neuralfoil_polar(foil, alpha=alpha, delta=half, reynolds=reynolds, hinge=hinge, kind=kind)
        tables = {key: getattr(found, key) for key in ("CL", "CD", "CM", "alpha", "reynolds", "source")}
        return Polar(name=f"{foil.name} morphed (same slope)", delta=delta, **tables)
    options = xfoil or Xfoil(alpha_from=min(float(alpha[0]), 0.0), alpha_to=max(float(alpha[-1]), 0.0))
    rows = []
    for re in reynolds:
        for d in delta:
            if progress is not None:
                progress(f"XFOIL: {name}, Re {re:g}, deflection {np.degrees(d):g} deg")
            outline = deflected(foil, hinge, float(d), kind=kind, reading=reading)
            rows += [(re, d, *point) for point in xfoil_points(outline, float(re), options=options)]
    label = f"XFOIL (installed), Ncrit {options.n_crit:g}, deflected outline"
    found = polar_from_points(f"{foil.name} {kind}", label, np.array(rows).reshape(-1, 6))
    return _on_axes(found, alpha, delta, reynolds)


def polar_of_files(paths: Sequence[str | Path]) -> Polar:
    """A polar from XFOIL's or XFLR5's own polar files, one for each Reynolds number, undeflected.

    Parameters
    ----------
    paths : sequence of str or path
        The files.

    Returns
    -------
    polar : Polar
        On a grid of half degrees. [-]

    Raises
    ------
    ValueError
        If a file cannot be read or is no polar, or two are of one Reynolds number.
    """
    rows: list[tuple[float, ...]] = []
    seen: dict[float, Path] = {}
    name = ""
    for path in map(Path, paths):
        try:
            text = path.read_text(encoding="utf-8", errors="replace")
        except OSError as error:
            raise ValueError(f"polar file {path} cannot be read: {error.strerror}") from None
        try:
            polar = parse_xfoil_polar(text)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
        if polar.reynolds in seen:
            raise ValueError(f"{path} and {seen[polar.reynolds]} are both of Reynolds number {polar.reynolds:g}")
        seen[polar.reynolds], name = path, polar.name
        rows += [(polar.reynolds, 0.0, *point) for point in zip(polar.alpha, polar.CL, polar.CD, polar.CM)]
    return polar_from_points(name, f"polar files {', '.join(p.name for p in seen.values())}", np.array(rows))


def best_section(*, name: str, reynolds: float, delta_deg: float, kind: ControlKind = "hinged") -> float:
    """Largest L/D of a shipped section at one Reynolds number and deflection: a point of the thesis' figure 21.

    Parameters
    ----------
    name : str
        Airfoil with a shipped table.
    reynolds : float
        Reynolds number. [-]
    delta_deg : float
        Deflection, trailing edge down. [deg]
    kind : {"hinged", "morphed"}
        Kind of the control.

    Returns
    -------
    ratio : float
        CL/CD, by a running median of three points. [-]

    Raises
    ------
    ValueError
        If there is no such table, or it does not reach.
    """
    return best_lift_to_drag(shipped_polar(name, kind), reynolds=reynolds, delta=float(np.radians(delta_deg)))[0]


def resampled(polar: Polar, alpha: np.ndarray, delta: np.ndarray, reynolds: np.ndarray) -> Polar:
    """A polar on other axes, NaN outside its own.

    Parameters
    ----------
    polar : Polar
        Any.
    alpha, delta, reynolds : ndarray, shapes (n_a,), (n_d,), (n_r,)
        New axes. [rad, rad, -]

    Returns
    -------
    polar : Polar
        Linear between the points of the first one. [-]
    """
    p = section_coefficients(polar, alpha, reynolds=reynolds[:, None, None], delta=delta[:, None])
    return Polar(
        name=polar.name, source=polar.source, alpha=alpha, delta=delta, reynolds=reynolds, CL=p.CL, CD=p.CD, CM=p.CM
    )


def deflected(foil: Airfoil, hinge: float, delta: float, *, kind: ControlKind, reading: MorphReading) -> Airfoil:
    """The outline with its control deflected.

    Parameters
    ----------
    foil : Airfoil
        Undeflected.
    hinge : float
        In chords. [-]
    delta : float
        Trailing edge down. [rad]
    kind : {"hinged", "morphed"}
        Kind of the control.
    reading : {"same_drop", "same_slope"}
        Of a morphed one.

    Returns
    -------
    foil : Airfoil
        Re-panelled.
    """
    if delta == 0.0:
        return repanel(foil, 200)
    if kind == "hinged":
        return hinged_outline(foil, hinge, delta)
    return morphed_outline(foil, hinge, delta, reading=reading)


def _chosen(name: str, hinge: float, kind: ControlKind, reading: MorphReading, source: Source) -> str:
    """The source in force; what "auto" means here and now."""
    if name == "flat":
        raise ValueError(
            "the section's airfoil is 'flat', a plate without thickness: it has no polar. Name an airfoil in the "
            "model file, or with polar --airfoil"
        )
    try:
        shipped_polar(name, kind)
        fits = abs(hinge - TABLE_HINGE) < 1e-9 and (kind == "hinged" or reading == "same_drop")
    except ValueError:
        fits = False
    if source == "table" and not fits:
        raise ValueError(
            f"no shipped table of {name!r}, {kind} at {hinge:g} of the chord: there are those of mh62, hinged and "
            f"morphed (same drop) at {TABLE_HINGE:g}; {_OTHERS}"
        )
    if source != "auto":
        return source
    if fits:
        return "table"
    airfoil(name)  # an unknown name is told before anything else
    if find_spec("neuralfoil") is not None:
        return "neuralfoil"
    if shutil.which("xfoil") is not None:
        return "xfoil"
    raise ValueError(
        f"no polar of {name!r}, {kind} at {hinge:g} of the chord: the shipped tables hold mh62 at {TABLE_HINGE:g} "
        "only. Install NeuralFoil (pip install aeroservo[airfoil]) or XFOIL (Debian: apt-get install xfoil)"
    )


def _check_reach(table: Polar, delta: np.ndarray, reynolds: np.ndarray) -> None:
    """Refuse Reynolds numbers and deflections outside a table."""
    low, high = float(table.reynolds[0]), float(table.reynolds[-1])
    if reynolds[0] < low * (1.0 - 1e-9) or reynolds[-1] > high * (1.0 + 1e-9):
        got = f"{reynolds[0]:.4g}" if len(reynolds) == 1 else f"{reynolds[0]:.4g} to {reynolds[-1]:.4g}"
        raise ValueError(
            f"Reynolds number {got} lies outside the shipped table of {table.name!r}, {low:g} to {high:g}: choose "
            f"another speed, altitude or Reynolds number; {_OTHERS}"
        )
    first, last = float(table.delta[0]), float(table.delta[-1])
    if delta[0] < first - 1e-9 or delta[-1] > last + 1e-9:
        raise ValueError(
            f"deflection {np.degrees(delta[0]):g} to {np.degrees(delta[-1]):g} deg lies outside the shipped table of "
            f"{table.name!r}, {np.degrees(first):g} to {np.degrees(last):g} deg; {_OTHERS}"
        )


def _on_axes(found: Polar, alpha: np.ndarray, delta: np.ndarray, reynolds: np.ndarray) -> Polar:
    """A computed polar on the axes asked for; a sweep without a point is all NaN."""
    tables = {key: np.full((len(reynolds), len(delta), len(alpha)), np.nan) for key in ("CL", "CD", "CM")}
    for i, re in enumerate(reynolds):
        for j, d in enumerate(delta):
            at = np.flatnonzero(found.reynolds == re), np.flatnonzero(np.abs(found.delta - d) < 1e-8)
            if len(at[0]) and len(at[1]) and len(found.alpha) > 1:
                one = {k: getattr(found, k)[at[0][0] : at[0][0] + 1, at[1][0] : at[1][0] + 1] for k in tables}
                curve = Polar(
                    name=found.name,
                    source="",
                    alpha=found.alpha,
                    delta=np.zeros(1),
                    reynolds=np.ones(1),
                    **one,
                )
                p = section_coefficients(curve, alpha, reynolds=1.0)
                for key in tables:
                    tables[key][i, j] = getattr(p, key)
    return Polar(name=found.name, source=found.source, alpha=alpha, delta=delta, reynolds=reynolds, **tables)
