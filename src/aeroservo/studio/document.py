"""The report of the model that is edited: the same page as `aeroservo report` writes."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from aeroservo.studio.analysis import Air, Tell

_WHERE = re.compile(r"(\d+) of (\d+)")


def document(text: str, path: Path, air: Air, tell: Tell, partial: Callable[[Any], None]) -> bytes:
    """A report as the bytes of an HTML file.

    Parameters
    ----------
    text : str
        Of the model file.
    path : Path
        Where it lies, or would lie.
    air : Air
        Altitude and air forces.
    tell : callable
        Hears of progress, section by section.
    partial : callable
        Not used: a report has no first part.

    Returns
    -------
    content : bytes
        One offline page.

    Raises
    ------
    ValueError
        If there is no such model.

    References
    ----------
    contract.md, `report`.
    """
    from aeroservo.aircraft.files import parse
    from aeroservo.report.make_report import provenance_of, report_parts
    from aeroservo.report.page import page_html
    from aeroservo.studies.aircraft_report import ReportCase, ReportOptions

    def progress(line: str) -> None:
        found = _WHERE.search(line)
        part = (int(found[1]) - 1) / int(found[2]) if found else 0.0
        tell(f"report: {line}", part)

    tell("report: reading the model", 0.0)
    case = ReportCase(file=parse(text, path), options=ReportOptions(altitude=air.altitude, aero=air.aero))
    parts = report_parts(case, folder=None, progress=progress)
    words = ["aeroservo", "report", path.name, "-o", f"{path.stem}.html"]
    words += ["--altitude", f"{air.altitude:g}"] if air.altitude else []
    words += ["--aero", air.aero] if air.aero else []
    made = provenance_of(case, source=path.name, text=text, command=shlex.join(words))
    lead = f"{case.file.kind.replace('_', ' ')}, {air.altitude:g} m"
    return page_html(parts, made, title=case.file.name, lead=lead).encode()
