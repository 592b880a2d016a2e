"""What `aeroservo demo` leaves behind: figures, results and one page that shows them without any network."""

from __future__ import annotations

import base64
import errno
import json
import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from aeroservo.aircraft.files import write_whole
from aeroservo.report.figures import as_bytes, plot_flutter
from aeroservo.report.surfaces import surface_figure
from aeroservo.report.thesis_figures import plot_fixed_k, plot_flutter_prediction, plot_response_against_speed
from aeroservo.report.thesis_text import held_conclusions, html_tables
from aeroservo.studies.thesis import ALTITUDES, MODELS, Run, ThesisStudy, thesis_study
from aeroservo.studies.thesis_surface import thesis_surface

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RESULTS = "results.json"
PAGE = "index.html"
MADE_BY = "aeroservo demo"


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """A figure of the demo.

    Attributes
    ----------
    name : str
        Of its files, without ending.
    caption : str
        Below it.
    draw : callable
        Makes the figure.
    """

    name: str
    caption: str
    draw: Callable[[], Figure]


def prepare_folder(folder: Path) -> bool:
    """Make a folder for the demo, or check that it may be used, before any work is done.

    Parameters
    ----------
    folder : Path
        To be written into.

    Returns
    -------
    earlier : bool
        Whether it holds an earlier demo, which will be replaced.

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
        raise ValueError(f"--out {folder}: cannot be used as a folder: {what}") from None
    if not names:
        return False
    if not _is_demo(folder / RESULTS):
        raise ValueError(
            f"--out {folder}: the folder is not empty and was not made by `aeroservo demo`: "
            "name a new or an empty one, so that nothing is overwritten"
        )
    return True


def _is_demo(results: Path) -> bool:
    """Whether results.json says that this program made it."""
    try:
        content = json.loads(results.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(content, dict) and content.get("made_by") == MADE_BY


def write_demo(study: ThesisStudy, folder: Path, *, progress: Callable[[str], None] | None = None) -> Path:
    """Write figures (PNG and PDF), results (JSON) and the page that shows them; each file whole or not at all.

    Parameters
    ----------
    study : ThesisStudy
        Of `thesis_study`.
    folder : Path
        Of `prepare_folder`.
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
        content = json.dumps(study_json(study), allow_nan=False, ensure_ascii=False, indent=1)
        write_whole(folder / RESULTS, content.encode())
        shown = []
        for drawing in drawings(study):
            if progress is not None:
                progress(f"figure {drawing.name}")
            figure = drawing.draw()
            png = as_bytes(figure, ".png")
            figure.set_layout_engine("none")  # the layout is found: the PDF takes it as it is
            write_whole(folder / f"{drawing.name}.png", png)
            write_whole(folder / f"{drawing.name}.pdf", as_bytes(figure, ".pdf"))
            shown.append((drawing, png))
        write_whole(folder / PAGE, _page(study, shown).encode())
    except OSError as error:
        raise ValueError(f"--out {folder}: cannot be written: {error.strerror}") from None
    return folder / PAGE


def demo(folder: Path, *, progress: Callable[[str], None] | None = None) -> tuple[ThesisStudy, Path]:
    """Compute the thesis' tables and write everything that `aeroservo demo` writes.

    Parameters
    ----------
    folder : Path
        Made if it is not there.
    progress : callable, optional
        Told in words what comes next.

    Returns
    -------
    study : ThesisStudy
        Tables, runs, curves. [SI]
    page : Path
        What to open.

    Raises
    ------
    ValueError
        If the folder cannot be used.
    """
    if prepare_folder(folder) and progress is not None:
        progress(f"replacing the earlier demo in {folder}")
    study = thesis_study(progress=progress)
    return study, write_demo(study, folder, progress=progress)


def drawings(study: ThesisStudy) -> tuple[Drawing, ...]:
    """The figures of the demo, not yet drawn.

    Parameters
    ----------
    study : ThesisStudy
        Of `thesis_study`.

    Returns
    -------
    drawings : tuple of Drawing
        In the order of the page.
    """
    high = ALTITUDES[-1]
    whole = {"binary": "binary wing", "aircraft": "whole aircraft"}
    response = study.run("binary", high, "quasi_steady_damped")
    found = [
        Drawing(
            name="fig26-response",
            caption="As the thesis' Fig. 26: twist, roll effectiveness and damping of the binary wing against speed, "
            f"{high:g} m, quasi-steady. From its own the thesis reads flutter 56, reversal 63, divergence about 90.",
            draw=lambda: plot_response_against_speed(
                response.static, response.flutter, title=f"Binary wing, quasi-steady, {high:g} m (thesis Fig. 26)"
            ),
        )
    ]
    for number, model in zip((27, 28), MODELS):
        found.append(
            Drawing(
                name=f"fig{number}-{model}",
                caption=f"As the thesis' Fig. {number}: flutter prediction of the {whole[model]}, {high:g} m; "
                "consistent Theodorsen p-k in place of derivatives held at one k.",
                draw=lambda model=model: plot_flutter_prediction(study, model, high),  # type: ignore[misc]
            )
        )
    for number, field, what in (
        (29, "altitude_m", "altitude"),
        (30, "wing.pitch_stiffness_N_m", f"pitch stiffness, {high:g} m"),
    ):
        title = f"Whole aircraft: damping over speed and {what} (thesis Fig. {number})"
        found.append(
            Drawing(
                name=f"fig{number}-{what.split(',')[0].replace(' ', '-')}",
                caption=f"As the thesis' Fig. {number}: damping ratio of the whole aircraft over speed and {what}, "
                "quasi-steady with pitch damping; the line is flutter.",
                draw=lambda field=field, title=title: surface_figure(  # type: ignore[misc]
                    thesis_surface(field), title
                ),
            )
        )
    found.append(
        Drawing(
            name="fixed-k",
            caption="Flutter speed with the oscillatory derivatives held at one reduced frequency, against it. "
            + "; ".join(held_conclusions(study.held))
            + ".",
            draw=lambda: plot_fixed_k(study),
        )
    )
    for altitude in ALTITUDES:
        where = "sea level" if altitude == 0.0 else "10,000 ft"
        for model in MODELS:
            run = study.run(model, altitude, "quasi_steady_damped")
            title = f"{whole[model].capitalize()}, quasi-steady with pitch damping, {where}"
            found.append(
                Drawing(
                    name=f"flutter-{model}-{where.replace(' ', '-').replace(',', '')}",
                    caption=f"{title}: frequency, damping and root locus over speed, p method.",
                    draw=lambda run=run, title=title: plot_flutter(run.flutter, title=title),  # type: ignore[misc]
                )
            )
    return tuple(found)


def study_json(study: ThesisStudy) -> dict[str, Any]:
    """The study as JSON takes it: no NaN, absent is null.

    Parameters
    ----------
    study : ThesisStudy
        Of `thesis_study`.

    Returns
    -------
    content : dict
        Units in the names.
    """
    return {
        "schema_version": 1,
        "made_by": MADE_BY,
        "tables": [
            {
                "table": row.table,
                "altitude_m": row.altitude,
                "model": row.model,
                "column": row.column,
                "quantity": row.quantity,
                "theory": row.theory,
                "thesis_m_s": row.printed,
                "computed_m_s": _number(row.computed),
                "difference_m_s": _number(row.difference),
                "reason": row.reason,
            }
            for row in study.rows
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
                "consistent_k": _number(h.own_k),
                "consistent_flutter_speed_m_s": _number(h.own_speed),
            }
            for h in study.held
        ],
        "conclusions": list(held_conclusions(study.held)),
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
        "flutter_speed_m_s": _number(found.flutter_speed),
        "flutter_frequency_rad_s": _number(found.flutter_frequency),
        "flutter_mode": found.flutter_mode,
        "reduced_frequency": _number(run.reduced_frequency),
        "unstable_intervals": [
            {
                "from_m_s": _number(i.start),
                "to_m_s": _number(i.end),
                "frequency_rad_s": i.frequency,
                "mode": i.mode,
                "kind": i.kind,
            }
            for i in found.intervals
        ],
        "divergence_speed_m_s": _number(found.divergence_speed),
        "first_real_instability_m_s": _number(found.first_real_instability),
        "reversal_speed_m_s": _number(run.static.reversal.V),
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


def _number(x: float | None) -> float | None:
    """A number, or None where there is none."""
    return None if x is None or not math.isfinite(x) else float(x)


def _numbers(values: Any) -> list[float | None]:
    """Numbers, None where there are none."""
    return [_number(float(x)) for x in values]


STYLE = """body{font:16px/1.5 system-ui,sans-serif;max-width:70rem;margin:2rem auto;padding:0 1rem;color:#222;
background:#fff}table{border-collapse:collapse;font-variant-numeric:tabular-nums}th,td{padding:.2rem .7rem;
text-align:left;border-bottom:1px solid #ddd}.n{text-align:right}.wide{overflow-x:auto}img{max-width:100%;height:auto}
figure{margin:2rem 0}figcaption{color:#444}ol{font-size:.9rem;color:#444}"""


def _page(study: ThesisStudy, shown: list[tuple[Drawing, bytes]]) -> str:
    """One page that carries its pictures with it: it may be moved or mailed, and asks no network for anything."""
    figures = "\n".join(
        f'<figure><img alt="{escape(drawing.caption)}" src="data:image/png;base64,{base64.b64encode(png).decode()}">'
        f"<figcaption>{escape(drawing.caption)} <a href='{drawing.name}.pdf'>PDF</a></figcaption></figure>"
        for drawing, png in shown
    )
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>aeroservo demo: the thesis' Tables 2 and 3</title><style>{STYLE}</style></head><body>
<h1>The thesis' Tables 2 and 3, computed again</h1>
<p>Flutter, divergence and reversal of the binary wing and the whole aircraft of Bramstång (2015) by aeroservo, beside
the numbers that the thesis prints. The thesis does not print the inputs of these models; they were inferred from
Tables 1 to 3, and the notes say which numbers agree by construction. All numbers:
<a href="{RESULTS}">{RESULTS}</a>.</p>
{html_tables(study)}
<h2>Figures</h2>
<p>Damping ratio &zeta; = &minus;Re &lambda;/|&lambda;|: positive is stable. The thesis plots
+100 Re &lambda;/|&lambda;| in per cent: positive is flutter. Each axis says which it is.</p>
{figures}
</body></html>
"""
