"""The validation book as a page of the documentation, in Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from aeroservo.studies.validation import CASES, Check, NotYet


def validation_markdown(checks: Sequence[Check], missing: Sequence[NotYet]) -> str:
    """The page docs/validation.md.

    Parameters
    ----------
    checks : sequence of Check
        Of `aeroservo.studies.validation.validate`.
    missing : sequence of NotYet
        Of `not_yet_computed`.

    Returns
    -------
    text : str
        Markdown; the same run gives the same text.
    """
    failed = sum(not check.passed for check in checks)
    lines = [
        "# The validation book",
        "",
        "<!-- Made by `aeroservo validate --markdown docs/validation.md`; do not edit. -->",
        "",
        "Published and independently computed cases, re-run: `aeroservo validate` does it on your machine in under a "
        "minute.",
        "A case is a folder of data under `src/aeroservo/cases/`, without code; `SOURCE.md` in it says where each "
        "number is",
        "from and why its tolerance is what it is. The thesis has [a page of its own](thesis.md).",
        "",
        f"**{len(checks) - failed} of {len(checks)} comparisons pass.**",
    ]
    for name, group in groupby(checks, key=_case):
        mine = list(group)
        lines += ["", f"## {_title(name)}", "", _safe(mine[0].citation) + ".", ""]
        lines += [
            "| run | quantity | reference | result | difference | tolerance | |",
            "|---|---|---|---|---|---|---|",
        ]
        lines += [
            "| "
            + " | ".join(
                (
                    _safe(c.name.split(": ", 1)[1]),
                    _safe(c.quantity),
                    f"{c.reference:.7g}",
                    "none" if c.result is None else f"{c.result:.7g}",
                    "-" if c.difference is None else f"{c.difference:.2g}",
                    f"{c.tolerance:.2g}",
                    "pass" if c.passed else "**fails**",
                )
            )
            + " |"
            for c in mine
        ]
    lines += ["", "## Not yet computed", ""]
    lines += [f"- {_safe(m.name)}: {_safe(m.quantity)}, {_safe(m.reference)}: {m.why}." for m in missing]
    return "\n".join(lines) + "\n"


def _case(check: Check) -> str:
    return check.name.split(":")[0]


def _title(name: str) -> str:
    """First heading of the case's SOURCE.md."""
    text = (CASES / name / "SOURCE.md").read_text(encoding="utf-8")
    return next(line.lstrip("# ") for line in text.splitlines() if line.startswith("#"))


def _safe(text: str) -> str:
    """Text that Markdown takes literally."""
    return text.replace("_", "\\_").replace("*", "\\*").replace("|", "\\|").replace("<", "&lt;")
