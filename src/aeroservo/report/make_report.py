"""A report on one model: its parts one after the other, what fails told in its place, what is done kept.

Finished parts are kept in the user's cache folder under a hash of the inputs, of this package's version and of its
own code, so that an interrupted report goes on where it stopped, and a second one costs nothing.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from aeroservo.report.blocks import Failed, Part, Provenance
from aeroservo.report.part_cache import read_part, write_part
from aeroservo.studies.aircraft_report import ReportCase

PartOf = Callable[[ReportCase], Part]


@dataclass(frozen=True, kw_only=True)
class Section:
    """A part of the report before it is made.

    Attributes
    ----------
    title, anchor : str
        Of the part.
    make : callable
        From the case to the part.
    """

    title: str
    anchor: str
    make: PartOf


def sections(case: ReportCase) -> tuple[Section, ...]:
    """The parts that a kind of model has.

    Parameters
    ----------
    case : ReportCase
        The model.

    Returns
    -------
    sections : tuple of Section
        In the order of the page.
    """
    from aeroservo.aircraft.aircraft_schema import AircraftFile
    from aeroservo.aircraft.schema_other import StateSpaceFile
    from aeroservo.report import control_parts, gust_parts, linear_parts, model_parts
    from aeroservo.report.aero_parts import aero_part

    if isinstance(case.file, StateSpaceFile):
        return (
            Section(title="Summary", anchor="summary", make=linear_parts.linear_summary),
            Section(title="Simulations", anchor="simulations", make=linear_parts.linear_runs),
        )
    aircraft = isinstance(case.file, AircraftFile)
    if aircraft and case.file.structure is None:  # type: ignore[attr-defined]
        return (
            Section(title="Model", anchor="model", make=model_parts.rigid_part),
            Section(title="Aerodynamics", anchor="aerodynamics", make=aero_part),
        )
    steady = (Section(title="Aerodynamics", anchor="aerodynamics", make=aero_part),) if aircraft else ()
    return (
        Section(title="Summary", anchor="summary", make=model_parts.summary_part),
        Section(title="Live", anchor="live", make=control_parts.live_part),
        Section(title="Model", anchor="model", make=model_parts.model_part),
        *steady,
        Section(title="Modes", anchor="modes", make=model_parts.modes_part),
        Section(title="Flutter", anchor="flutter", make=model_parts.flutter_part),
        Section(title="Statics", anchor="statics", make=model_parts.static_part),
        Section(title="Control", anchor="control", make=control_parts.control_part),
        Section(title="Simulations", anchor="simulations", make=control_parts.simulation_part),
        Section(title="Gusts and turbulence", anchor="gusts", make=gust_parts.gust_part),
        Section(title="Envelope", anchor="envelope", make=gust_parts.envelope_part),
    )


def report_parts(
    case: ReportCase, *, folder: Path | None = None, progress: Callable[[str], None] | None = None
) -> tuple[Part, ...]:
    """All parts of a report.

    Parameters
    ----------
    case : ReportCase
        The model.
    folder : Path, optional
        Where finished parts are kept; None keeps none.
    progress : callable, optional
        Called with a line before and after each part.

    Returns
    -------
    parts : tuple of Part
        One for each section; what failed says why.
    """
    chosen = sections(case)
    place = None if folder is None else folder / f"{case.input_hash[:32]}-{code_hash()[:16]}"
    out = []
    for k, section in enumerate(chosen):
        where = f"{k + 1} of {len(chosen)}, {section.title}"
        kept = None if place is None else read_part(place / f"{section.anchor}.json")
        if kept is not None:
            out.append(kept)
            if progress is not None:
                progress(f"{where}: kept from before")
            continue
        if progress is not None:
            progress(where)
        started = time.perf_counter()
        part = made(section, case)
        failed = any(isinstance(block, Failed) for block in part.blocks)
        if place is not None and not failed:
            write_part(place / f"{section.anchor}.json", part)
        out.append(part)
        if progress is not None:
            progress(f"{where}: {'not computed' if failed else 'done'} after {time.perf_counter() - started:.1f} s")
    return tuple(out)


def made(section: Section, case: ReportCase) -> Part:
    """One part; whatever fails in it is told inside it, so that the others still come.

    Parameters
    ----------
    section : Section
        What to make.
    case : ReportCase
        The model.

    Returns
    -------
    part : Part
        The part, or its title and why it could not be computed.
    """
    try:
        return section.make(case)
    except ValueError as error:
        why = str(error)
    except Exception as error:  # a report is not lost for one part: what went wrong stands where the part would
        why = f"{type(error).__name__}: {error}"
    return Part(title=section.title, anchor=section.anchor, blocks=(Failed(why=why),))


def provenance_of(case: ReportCase, *, source: str, text: str, command: str) -> Provenance:
    """Where a report's numbers come from.

    Parameters
    ----------
    case : ReportCase
        The model.
    source : str
        Preset or path; its folder is left out.
    text : str
        The model file.
    command : str
        What made it.

    Returns
    -------
    provenance : Provenance
        Nothing of the machine in it.
    """
    from aeroservo import __version__

    o = case.options
    options = [("altitude", f"{o.altitude:g} m")]
    if o.aero is not None:
        options.append(("air forces", o.aero))
    if o.speed is not None:
        options.append(("speed", f"{o.speed:g} m/s"))
    if o.controller is not None:
        options.append(("controller", o.controller_name))
    return Provenance(
        version=__version__,
        source=Path(source).name,
        options=tuple(options),
        input_hash=case.input_hash,
        input_text=text,
        command=command,
    )


@cache
def code_hash() -> str:
    """Hash of this package's own source: kept parts are not taken from another version.

    Returns
    -------
    digest : str
        SHA-256.
    """
    root = Path(__file__).resolve().parents[1]
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()
