"""One HTML file that holds everything: parts in, page out; it opens from disk and asks no one for anything.

A policy inside the page (Content-Security-Policy) lets only the scripts run that this package wrote, known by their
hashes, and forbids every request; every text is escaped, so that a name in a model file stays a name. The same parts
give the same bytes.
"""

from __future__ import annotations

import base64
import hashlib
import json
import math
from collections.abc import Sequence
from functools import cache
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from aeroservo.report.blocks import (
    Band,
    Block,
    Chart,
    Facts,
    Failed,
    LivePanel,
    Mark,
    Part,
    Picture,
    Prose,
    Provenance,
    Scene,
    Series,
    Table,
)
from aeroservo.report.html_blocks import PageBuilder

__all__ = [
    "Band",
    "Block",
    "Chart",
    "Facts",
    "Failed",
    "LivePanel",
    "Mark",
    "Part",
    "Picture",
    "Prose",
    "Provenance",
    "Scene",
    "Series",
    "Table",
    "asset",
    "page_html",
    "plain_data",
    "write_page",
]


def write_page(
    path: str | Path, parts: Sequence[Part], provenance: Provenance, *, title: str = "", lead: str = ""
) -> None:
    """Write a page, whole or not at all.

    Parameters
    ----------
    path : str or Path
        Where to.
    parts : sequence of Part
        In order; each with its own anchor.
    provenance : Provenance
        Where the numbers come from.
    title : str
        Of the page; default the name of the source.
    lead : str
        One line below the title.

    Raises
    ------
    OSError
        If it cannot be written.
    ValueError
        If two parts have one anchor.
    """
    from aeroservo.aircraft.files import write_whole

    write_whole(Path(path), page_html(parts, provenance, title=title, lead=lead).encode())


def page_html(parts: Sequence[Part], provenance: Provenance, *, title: str = "", lead: str = "") -> str:
    """A page as text.

    Parameters
    ----------
    parts : sequence of Part
        In order; each with its own anchor.
    provenance : Provenance
        Where the numbers come from.
    title : str
        Of the page; default the name of the source.
    lead : str
        One line below the title.

    Returns
    -------
    html : str
        A whole document.

    Raises
    ------
    ValueError
        If two parts have one anchor.
    """
    anchors = [part.anchor for part in parts]
    if len(set(anchors)) != len(anchors):
        raise ValueError(f"every part must have its own anchor, got {anchors}")
    title = title or provenance.source
    builder = PageBuilder()
    body = "".join(builder.part(part) for part in parts)
    scripts = _scripts(builder)
    style = asset("page.css")
    contents = "".join(f'<li><a href="#{part.anchor}">{escape(part.title)}</a></li>' for part in parts)
    policy = (
        "default-src 'none'; img-src data: blob:; base-uri 'none'; form-action 'none'; "
        f"style-src '{_hash(style)}'; script-src {' '.join(repr(_hash(s)) for s in scripts)}"
    )
    return "".join(
        (
            '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">',
            f'<meta http-equiv="Content-Security-Policy" content="{policy}">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            '<meta name="referrer" content="no-referrer"><meta name="color-scheme" content="light dark">',
            f'<link rel="icon" href="data:,"><title>{escape(title)}</title><style>{style}</style></head><body>',
            '<a class="skip" href="#main">To the content</a>',
            f'<header><h1>{escape(title)}</h1><p class="lead">{escape(lead)}</p>',
            '<button type="button" id="theme" title="Colours: as the system, dark, light">Colours: system</button>',
            f'</header><nav aria-label="Contents"><ol>{contents}</ol></nav><main id="main">{body}</main>',
            f"<footer>{_provenance(provenance)}</footer>",
            '<div id="tip" role="status" aria-live="polite" hidden></div>',
            f'<script type="application/json" id="data">{json_for_html(builder.data)}</script>',
            *(f"<script>{script}</script>" for script in scripts),
            "</body></html>\n",
        )
    )


def _scripts(builder: PageBuilder) -> list[str]:
    """The scripts that the page needs, in order."""
    names = ["page.js"]
    if builder.data["scenes"] or builder.data["live"]:
        names += ["three.min.js", "wing3d.js"]
    if builder.data["live"]:
        names += ["live_model.js", "live.js"]
    if len(names) > 1:
        names += ["start.js"]
    return [asset(name) for name in names]


@cache
def asset(name: str) -> str:
    """Text of a file of `report/assets`.

    Parameters
    ----------
    name : str
        Its name.

    Returns
    -------
    text : str
        Safe between the tags of a script or a style sheet.

    Raises
    ------
    ValueError
        If the text would end its own tag.
    """
    text = (files("aeroservo.report") / "assets" / name).read_text(encoding="utf-8")
    if "</script" in text.lower() or "</style" in text.lower() or "<!--" in text:
        raise ValueError(f"{name} holds a tag that would end it inside a page")
    return text


def _hash(text: str) -> str:
    """Hash of a script or style as the policy names it."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def json_for_html(value: Any) -> str:
    """JSON that no text inside can end: every `<`, `>` and `&` is written as its number.

    Parameters
    ----------
    value : any
        As `plain_data` takes it. [any]

    Returns
    -------
    text : str
        To stand inside a script element of type application/json.
    """
    text = json.dumps(plain_data(value), allow_nan=False, ensure_ascii=True, separators=(",", ":"))
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def plain_data(value: Any) -> Any:
    """Arrays as lists, numbers with seven digits, what is not finite as null.

    Parameters
    ----------
    value : any
        Made of mappings, sequences, arrays, numbers, texts, None. [any]

    Returns
    -------
    value : any
        As JSON knows it. [unit of `value`]

    Raises
    ------
    TypeError
        If it is something else.
    """
    if value is None or isinstance(value, bool | str | int):
        return value
    if isinstance(value, float):
        return float(f"{value:.7g}") if math.isfinite(value) else None
    if hasattr(value, "items"):
        return {str(key): plain_data(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain_data(inner) for inner in value]
    if hasattr(value, "tolist"):
        return plain_data(value.tolist())
    raise TypeError(f"{type(value).__name__} has no place in a page")


def _provenance(provenance: Provenance) -> str:
    """Where the numbers come from."""
    rows = [
        ("made by", f"aeroservo {provenance.version}"),
        ("model", provenance.source),
        *provenance.options,
        ("inputs, SHA-256", provenance.input_hash),
        ("command", provenance.command),
    ]
    cells = "".join(f"<dt>{escape(name)}</dt><dd>{escape(text)}</dd>" for name, text in rows if text)
    text = provenance.input_text
    source = f"<details><summary>The model file</summary><pre>{escape(text)}</pre></details>" if text else ""
    return (
        f'<h2 id="provenance">Provenance</h2><dl>{cells}</dl>{source}<p>Three-dimensional views: three.js, MIT '
        "licence, © three.js authors. This page is one file; it makes no request.</p>"
    )
