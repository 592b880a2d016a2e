"""`flutter --sensitivities`: derivatives of the speeds to the numbers of the model file."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from aeroservo.cli.loaded import draw
from aeroservo.cli.output import table

if TYPE_CHECKING:
    from aeroservo.aeroelastic.flutter import Method
    from aeroservo.aircraft.schema_base import FileModel
    from aeroservo.datatypes import FlightCondition


def sensitivity_rows(
    file: FileModel, sweep: FlightCondition, method: Method, *, aero: str | None, plot: Path | None, title: str
) -> list[dict[str, Any]]:
    """The rows of `sensitivities`, and their tornado chart.

    Parameters
    ----------
    file : FileModel
        The model file.
    sweep : FlightCondition
        Speeds. [m/s, kg/m^3]
    method : P, PK, K or G
        How roots are found.
    aero : str, optional
        Air forces.
    plot : Path, optional
        Tornado chart.
    title : str
        Above the chart.

    Returns
    -------
    rows : list of dict
        `field`, `value`, `dV_flutter`, ... [m/s per unit of the field]
    """
    from aeroservo.aeroelastic.sensitivity import sensitivities

    found = sensitivities(file, sweep, method, aero=aero)
    if plot is not None:
        from aeroservo.report.tornado import tornado_figure

        draw(plot, tornado_figure(found, title))
    return [asdict(one) for one in found]


def print_sensitivities(rows: list[dict[str, Any]]) -> None:
    """The rows for people, those that move flutter (else divergence) most first.

    Parameters
    ----------
    rows : list of dict
        Of `sensitivity_rows`.
    """

    def weight(row: dict[str, Any]) -> float:
        relative = [row["relative_flutter"], row["relative_divergence"], row["relative_reversal"]]
        return max(abs(value or 0.0) for value in relative)

    keys = (
        "relative_flutter",
        "relative_divergence",
        "relative_reversal",
        "dV_flutter",
        "dV_divergence",
        "dV_reversal",
    )
    cells = [
        (row["field"], row["value"], *(_clean(row[key]) for key in keys))
        for row in sorted(rows, key=weight, reverse=True)
    ]
    names = (
        "field",
        "value",
        "% flutter per %",
        "divergence",
        "reversal",
        "dV flutter/d field, m/s",
        "divergence",
        "reversal",
    )
    typer.echo(table(cells, names))


def _clean(value: float | None) -> float | None:
    """Rounding shown as zero."""
    return 0.0 if value is not None and abs(value) < 1e-12 else value
