"""What `aeroservo study thesis` and `aeroservo demo` leave behind: a page, results, figures on request."""

from __future__ import annotations

import errno
import json
import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from aeroservo.aircraft.files import write_whole
from aeroservo.report.blocks import Provenance
from aeroservo.report.page import page_html
from aeroservo.report.style import as_bytes
from aeroservo.report.thesis_drawings import entry_figure
from aeroservo.report.thesis_parts import thesis_parts
from aeroservo.report.thesis_text import PICTURES, markdown, picture_name
from aeroservo.studies.thesis import Run
from aeroservo.studies.thesis_records import Compared
from aeroservo.studies.thesis_study import ThesisBook

RESULTS = "results.json"
PAGE = "index.html"
MADE_BY = "aeroservo study thesis"
EARLIER = (MADE_BY, "aeroservo demo")
TITLE = "The thesis, computed again"
LEAD = "Bramstång (2015), chapters 8 and 9: every figure and table beside ours, every claim judged"


def prepare_folder(folder: Path, option: str = "--out") -> bool:
    """Make a folder for the study, or check that it may be used, before any work is done.

    Parameters
    ----------
    folder : Path
        To be written into.
    option : str
        Named in errors.

    Returns
    -------
    earlier : bool
        Whether it holds an earlier study, which will be replaced.

    Raises
    ------
    ValueError
        If it is no folder, cannot be made or written, or holds something else.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        names = {entry.name for entry in folder.iterdir()}
        probe = folder / f".aeroservo-{os.getpid()}.tmp"
        with open(probe, "xb"):
            pass
        probe.unlink()
    except OSError as error:
        taken = error.errno in (errno.EEXIST, errno.ENOTDIR)
        what = "a file is in the way" if taken else f"{error.strerror}"
        raise ValueError(f"{option} {folder}: cannot be used as a folder: {what}") from None
    if not names:
        return False
    if not _is_ours(folder / RESULTS):
        raise ValueError(
            f"{option} {folder}: the folder is not empty and was not made by `aeroservo study` or `aeroservo demo`: "
            "name a new or an empty one, so that nothing is overwritten"
        )
    return True


def _is_ours(results: Path) -> bool:
    """Whether results.json says that this program made it."""
    try:
        content = json.loads(results.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(content, dict) and content.get("made_by") in EARLIER


def write_study(
    book: ThesisBook, folder: Path, *, figures: bool = False, progress: Callable[[str], None] | None = None
) -> Path:
    """Write results (JSON), figures on request (PNG and PDF), and last the page; each file whole or not at all.

    Parameters
    ----------
    book : ThesisBook
        Of `thesis_book`.
    folder : Path
        Of `prepare_folder`.
    figures : bool
        Whether every figure is written as PNG and PDF as well.
    progress : callable, optional
        Told the name of each figure.

    Returns
    -------
    page : Path
        What to open.

    Raises
    ------
    ValueError
        If a file cannot be written.
    """
    try:
        content = json.dumps(book_json(book), allow_nan=False, ensure_ascii=False, indent=1)
        write_whole(folder / RESULTS, content.encode())
        if figures:
            for entry in book.entries:
                figure = entry_figure(entry)
                if figure is None:
                    continue
                if progress is not None:
                    progress(f"figure {entry.number}")
                stem = picture_name(entry).removesuffix(".png")
                write_whole(folder / f"{stem}.png", as_bytes(figure, ".png"))
                figure.set_layout_engine("none")  # the layout is found: the PDF takes it as it is
                write_whole(folder / f"{stem}.pdf", as_bytes(figure, ".pdf"))
        if progress is not None:
            progress("page")
        write_whole(folder / PAGE, study_page(book).encode())
    except OSError as error:
        raise ValueError(f"{folder}: cannot be written: {error.strerror}") from None
    return folder / PAGE


def study_page(book: ThesisBook) -> str:
    """The page, which carries everything with it and asks no network for anything.

    Parameters
    ----------
    book : ThesisBook
        Of `thesis_book`.

    Returns
    -------
    html : str
        A whole document.
    """
    from aeroservo import __version__

    where = Provenance(
        version=__version__,
        source="presets thesis-uav, thesis-binary, thesis-aircraft, thesis-simulation, thesis-appendix, bact",
        command="aeroservo study thesis",
    )
    return page_html(thesis_parts(book), where, title=TITLE, lead=LEAD)


def write_docs(book: ThesisBook, path: Path) -> None:
    """Write the page of the documentation and the pictures that it shows.

    Parameters
    ----------
    book : ThesisBook
        Of `thesis_book`.
    path : Path
        The Markdown file; pictures go into img/thesis beside it.

    Raises
    ------
    ValueError
        If a file cannot be written.
    """
    try:
        pictures = path.parent / "img" / "thesis"
        pictures.mkdir(parents=True, exist_ok=True)
        for name in PICTURES:
            entry = book.entry(name)
            figure = entry_figure(entry)
            if figure is not None:
                write_whole(pictures / picture_name(entry), as_bytes(figure, ".png"))
        write_whole(path, markdown(book).encode())
    except OSError as error:
        raise ValueError(f"--markdown {path}: cannot be written: {error.strerror}") from None


def book_json(book: ThesisBook) -> dict[str, Any]:
    """The study as JSON takes it: no NaN, absent is null.

    Parameters
    ----------
    book : ThesisBook
        Of `thesis_book`.

    Returns
    -------
    content : dict
        Units in the names.
    """
    study = book.aeroelastic.study
    return {
        "schema_version": 1,
        "made_by": MADE_BY,
        "tables": [
            {
                "table": c.table,
                "altitude_m": c.altitude,
                "column": c.column,
                "quantity": c.quantity,
                "thesis_m_s": c.thesis,
                "computed_m_s": _value(c.ours),
                "difference_m_s": _value(c.difference),
                "sounder_m_s": _value(c.sound),
                "sounder_method": c.method,
                "reason": c.reason,
            }
            for c in book.cells
        ],
        "claims": [
            {"section": c.section, "claim": c.statement, "verdict": c.verdict, "numbers": c.numbers}
            for c in book.claims
        ],
        "figures": [
            {
                "number": e.number,
                "title": e.title,
                "thesis": e.thesis,
                "finding": e.finding,
                "unsound": e.unsound,
                "compared": [_compared(c) for c in e.compared],
            }
            for e in book.entries
        ],
        "misprints": [
            {"where": m.where, "printed": m.printed, "right": m.right, "effect": m.effect} for m in book.misprints
        ],
        "runs": [_run_json(run) for run in study.runs],
        "held_derivatives": [
            {
                "model": h.model,
                "altitude_m": h.altitude,
                "lift_slope": h.slope,
                "thesis_m_s": h.printed,
                "k": _numbers(h.curve.k),
                "flutter_speed_m_s": _numbers(h.curve.flutter_speed),
                "flutter_frequency_rad_s": _numbers(h.curve.flutter_frequency),
                "real_root_unstable": [bool(x) for x in h.curve.real_unstable],
                "k_that_prints_thesis": [list(pair) for pair in h.ranges],
                "consistent_k": _value(h.own_k),
                "consistent_flutter_speed_m_s": _value(h.own_speed),
            }
            for h in study.held
        ],
    }


def _compared(c: Compared) -> dict[str, Any]:
    return {
        "what": c.what,
        "unit": c.unit,
        "thesis": _value(c.thesis),
        "ours": _value(c.ours),
        "difference": _value(c.difference),
        "reason": c.reason,
    }


def _run_json(run: Run) -> dict[str, Any]:
    """One run: speeds, intervals, branches."""
    found = run.flutter
    return {
        "model": f"thesis-{run.model}",
        "altitude_m": run.altitude,
        "density_kg_m3": float(found.condition.rho[0]),
        "aero": run.theory,
        "lift_slope": run.slope,
        "method": found.method,
        "found": found.found,
        "flutter_speed_m_s": _value(found.flutter_speed),
        "flutter_frequency_rad_s": _value(found.flutter_frequency),
        "flutter_mode": found.flutter_mode,
        "reduced_frequency": _value(run.reduced_frequency),
        "unstable_intervals": [
            {
                "from_m_s": _value(i.start),
                "to_m_s": _value(i.end),
                "frequency_rad_s": i.frequency,
                "mode": i.mode,
                "kind": i.kind,
            }
            for i in found.intervals
        ],
        "divergence_speed_m_s": _value(found.divergence_speed),
        "first_real_instability_m_s": _value(found.first_real_instability),
        "reversal_speed_m_s": _value(run.static.reversal.V),
        "modes": [
            {
                "name": name,
                "speed_m_s": _numbers(found.speeds[:, j]),
                "frequency_rad_s": _numbers(np.where(np.isfinite(found.roots[:, j]), found.frequency[:, j], np.nan)),
                "damping_ratio": _numbers(found.damping_ratio[:, j]),
            }
            for j, name in enumerate(found.names)
        ],
        "warnings": list(found.warnings),
    }


def _value(x: Any) -> Any:
    """A number or text, None where there is none."""
    if isinstance(x, str):
        return x
    return None if x is None or not math.isfinite(x) else float(x)


def _numbers(values: Any) -> list[float | None]:
    """Numbers, None where there are none."""
    return [_value(float(x)) for x in values]
