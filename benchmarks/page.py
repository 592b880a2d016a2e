"""docs/benchmarks.md from the results that are kept: of each benchmark its newest run."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

HEAD = """# Benchmarks

<!-- Made by `python -m benchmarks --page docs/benchmarks.md` from benchmarks/results/*.json; do not edit. -->

Every figure is a **ratio of our time to a peer's, or to the bare arithmetic inside, timed in turns in one run**:
seconds drift from machine to machine and from hour to hour, ratios hold. Where a target is missed it says so. `make
bench` measures them on your machine; `python -m benchmarks --install-peers` fetches other programs into an
environment of their own. The load is the number of other jobs on the machine while it measured.
"""


def newest(results: Path) -> list[tuple[str, dict[str, Any], dict[str, Any]]]:
    """Name, run and content of the newest result of each benchmark, in alphabetical order."""
    found: dict[str, tuple[dict[str, Any], Any]] = {}
    for path in sorted(results.glob("*.json")):
        data = json.loads(path.read_text(encoding="utf-8"))
        for name, rows in data["benchmarks"].items():
            found[name] = (data, rows)
        for name, why in data.get("skipped", {}).items():
            found.setdefault(name, (data, why))
    return [(name, *found[name]) for name in sorted(found)]


def page(results: Path) -> str:
    """The page as Markdown."""
    lines = [HEAD]
    for name, run, rows in newest(results):
        versions = ", ".join(f"{k} {v}" for k, v in run.get("versions", {"numpy": run.get("numpy", "?")}).items())
        lines += [
            f"## {name}",
            "",
            f"{run['at'][:10]}, {run['machine']}, {run['cores']} cores, load {run.get('load', 'not recorded')}, "
            f"{run['threads']} thread(s), Python {run['python']}, {versions}.",
            "",
        ]
        if isinstance(rows, str):
            lines += [f"Skipped: {rows}", ""]
            continue
        lines += [
            "| what / against what | ours, s | peer, s | ratio | target | | accuracy |",
            "|---|---|---|---|---|---|---|",
        ]
        lines += [
            f"| {row['name']} | {row['own_s']:.3g} | {row['peer_s']:.3g} | {row['ratio']:.3f} | {row['target']:.3g} | "
            f"{'met' if row['met'] else '**missed**'} | {row.get('accuracy', '')} |"
            for row in rows
        ]
        lines.append("")
    return "\n".join(lines).rstrip() + "\n"


def write_page(path: Path, results: Path) -> None:
    """Write it."""
    path.write_text(page(results), encoding="utf-8")
    print(f"wrote {path}")
