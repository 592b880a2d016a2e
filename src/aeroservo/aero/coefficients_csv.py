"""Coefficients from a wind tunnel's CSV file, or from any table: reading, converting, fitting the linear part.

An edge of the package: angles in files are in degrees, and their names say so.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from aeroservo.aero.coefficients import AeroCoefficients, CoefficientTable, Reference, wind_axes

COLUMNS = ("alpha_deg", "delta_deg", "reynolds", "CL", "CD", "CN", "CA", "CM")


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearFit:
    """Least-squares plane through a table; see `linear_fit`."""

    CL0: float  # [-]
    CL_alpha: float  # [1/rad]
    CL_delta: float  # [1/rad] 0 where the table has one deflection
    CM0: float  # [-]
    CM_alpha: float  # [1/rad]
    CM_delta: float  # [1/rad]
    CL_residual: float  # [-] root mean square
    CM_residual: float  # [-]
    points: int  # number of points used


def read_coefficients(
    path: str | Path,
    reference: Reference,
    *,
    alpha_range: tuple[float, float] = (-0.07, 0.07),
    delta_range: tuple[float, float] = (-0.175, 0.175),
    control: str = "delta",
) -> AeroCoefficients:
    """Coefficients from a CSV file of measurements.

    Parameters
    ----------
    path : str or Path
        File with a header line. Columns ``alpha_deg``, ``CL`` and ``CM``, or body axes ``CN`` and ``CA`` instead of
        ``CL`` and ``CD``; optional ``CD``, ``delta_deg``, ``reynolds``. Lines starting with # are comments. Points
        need not fill the grid.
    reference : Reference
        What the measurements were made dimensionless with, and their moment point.
    alpha_range, delta_range : tuple of float
        Range of the linear fit. [rad]
    control : str
        Name of the control that ``delta_deg`` deflects.

    Returns
    -------
    AeroCoefficients
        The linear fit, with the whole table beside it. Rate derivatives are None: a static test has none.

    Raises
    ------
    ValueError
        If a column is missing or unknown, a value is no finite number, a point comes twice, or the linear
        range holds too few points.

    References
    ----------
    Project convention: columns named here.

    Examples
    --------
    >>> import tempfile, os
    >>> name = os.path.join(tempfile.mkdtemp(), "tunnel.csv")
    >>> with open(name, "w") as f:
    ...     n = f.write("alpha_deg,CL,CM\\n-2,-0.1,0.01\\n0,0.0,0.0\\n2,0.1,-0.01\\n")
    >>> round(read_coefficients(name, Reference(S=1.0, c=1.0, b=4.0)).CL_alpha, 4)
    2.8648
    """
    path = Path(path)
    table = _table(path, _rows(path))
    fit = linear_fit(table, alpha_range=alpha_range, delta_range=delta_range)
    several = len(table.delta) > 1
    near = np.abs(table.alpha) <= max(abs(a) for a in alpha_range)
    zero = int(np.argmin(np.abs(table.delta)))
    drag = table.CD[:, zero, near]
    return AeroCoefficients(
        reference=reference,
        CL0=fit.CL0,
        CM0=fit.CM0,
        CD0=float(np.nanmin(drag)) if np.any(np.isfinite(drag)) else None,
        CL_alpha=fit.CL_alpha,
        CM_alpha=fit.CM_alpha,
        controls=(control,) if several else (),
        CL_delta=(fit.CL_delta,) if several else (),
        CM_delta=(fit.CM_delta,) if several else (),
        table=table,
        source=f"wind tunnel: {path.name}, linear fit of {fit.points} points",
    )


def linear_fit(
    table: CoefficientTable, *, alpha_range: tuple[float, float], delta_range: tuple[float, float]
) -> LinearFit:
    """Least-squares planes CL and CM over alpha and delta, over all Reynolds numbers of the table.

    Parameters
    ----------
    table : CoefficientTable
        The points.
    alpha_range, delta_range : tuple of float
        Points outside are left out. [rad]

    Returns
    -------
    LinearFit
        Coefficients and the scatter about them.

    Raises
    ------
    ValueError
        If the range holds too few different angles.

    References
    ----------
    Bramstång 2015, thesis [3.5].

    Examples
    --------
    >>> a = np.array([-0.05, 0.0, 0.05])
    >>> t = CoefficientTable(alpha=a, delta=[0.0], reynolds=[0.0], CL=[[5 * a]], CD=[[0 * a]], CM=[[-a]])
    >>> round(linear_fit(t, alpha_range=(-0.1, 0.1), delta_range=(-0.1, 0.1)).CL_alpha, 9)
    5.0
    """
    _, delta, alpha = np.meshgrid(table.reynolds, table.delta, table.alpha, indexing="ij")
    margin = 1e-9
    use = np.isfinite(table.CL) & np.isfinite(table.CM)
    use &= (alpha >= alpha_range[0] - margin) & (alpha <= alpha_range[1] + margin)
    use &= (delta >= delta_range[0] - margin) & (delta <= delta_range[1] + margin)
    if len(np.unique(alpha[use])) < 2:
        raise ValueError(
            f"the linear range {np.degrees(alpha_range[0]):g} to {np.degrees(alpha_range[1]):g} deg holds "
            f"{len(np.unique(alpha[use]))} different angle(s) of attack; two are needed: widen alpha_range"
        )
    several = len(np.unique(delta[use])) > 1
    basis = [np.ones(use.sum()), alpha[use], *([delta[use]] if several else [])]
    matrix = np.stack(basis, axis=-1)
    lift, *_ = np.linalg.lstsq(matrix, table.CL[use], rcond=None)
    moment, *_ = np.linalg.lstsq(matrix, table.CM[use], rcond=None)
    return LinearFit(
        CL0=float(lift[0]),
        CL_alpha=float(lift[1]),
        CL_delta=float(lift[2]) if several else 0.0,
        CM0=float(moment[0]),
        CM_alpha=float(moment[1]),
        CM_delta=float(moment[2]) if several else 0.0,
        CL_residual=float(np.sqrt(np.mean((matrix @ lift - table.CL[use]) ** 2))),
        CM_residual=float(np.sqrt(np.mean((matrix @ moment - table.CM[use]) ** 2))),
        points=int(use.sum()),
    )


def _rows(path: Path) -> list[dict[str, float]]:
    """The file's lines as numbers, with its header checked."""
    lines = [
        line for line in path.read_text(encoding="utf-8-sig").splitlines() if line.strip() and line.strip()[0] != "#"
    ]
    reader = csv.DictReader(lines, skipinitialspace=True)
    header = [name.strip() for name in reader.fieldnames or []]
    reader.fieldnames = header
    unknown = sorted(set(header) - set(COLUMNS))
    if unknown:
        raise ValueError(f"{path.name}: unknown column(s) {', '.join(unknown)}; known are {', '.join(COLUMNS)}")
    body = {"CN", "CA"} <= set(header)
    missing = {"alpha_deg", "CM"} - set(header) | (set() if body or "CL" in header else {"CL (or CN and CA)"})
    if missing:
        raise ValueError(f"{path.name}: column(s) missing: {', '.join(sorted(missing))}")
    if body and "CL" in header:
        raise ValueError(f"{path.name}: give CL and CD, or CN and CA, not both")
    rows = []
    for number, row in enumerate(reader, start=2):
        values = {}
        for name in header:
            try:
                values[name] = float(row[name])
            except (TypeError, ValueError):
                raise ValueError(f"{path.name}: line {number}, column {name}: {row[name]!r} is no number") from None
            if not np.isfinite(values[name]):
                raise ValueError(f"{path.name}: line {number}, column {name} must be finite, got {values[name]}")
        rows.append(values)
    if not rows:
        raise ValueError(f"{path.name}: holds no measurement")
    return rows


def _table(path: Path, rows: list[dict[str, float]]) -> CoefficientTable:
    """The rows on their grid, NaN where a point is missing."""
    alpha = np.radians([row["alpha_deg"] for row in rows])
    delta = np.radians([row.get("delta_deg", 0.0) for row in rows])
    reynolds = np.array([row.get("reynolds", 0.0) for row in rows])
    if "CL" in rows[0]:
        CL = np.array([row["CL"] for row in rows])
        CD = np.array([row.get("CD", np.nan) for row in rows])
    else:
        CL, CD = wind_axes(np.array([r["CN"] for r in rows]), np.array([r["CA"] for r in rows]), alpha)
    CM = np.array([row["CM"] for row in rows])
    unique = [np.unique(x, return_inverse=True) for x in (reynolds, delta, alpha)]
    axes, index = [u[0] for u in unique], tuple(u[1] for u in unique)
    place = np.ravel_multi_index(index, [len(axis) for axis in axes])
    if np.unique(place).size != place.size:
        raise ValueError(f"{path.name}: a point (reynolds, delta, alpha) comes twice; average repeats first")
    tables = []
    for values in (CL, CD, CM):
        full = np.full(tuple(len(axis) for axis in axes), np.nan)
        full[index] = values
        tables.append(full)
    return CoefficientTable(reynolds=axes[0], delta=axes[1], alpha=axes[2], CL=tables[0], CD=tables[1], CM=tables[2])
