"""Run the benchmarks: all of them, or those named on the command line. Exit code 1 if a target is missed.

python -m benchmarks                        # everything that can run here
python -m benchmarks flutter vlm            # some
python -m benchmarks --install-peers        # other programs, each into .venv-peers; what does not install is named
python -m benchmarks --page docs/benchmarks.md      # the page of the documentation from the results kept in this folder
"""

from __future__ import annotations

import importlib
import json
import os
import pkgutil
import platform
import sys
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from benchmarks.side_by_side import Row, Skipped

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "results"
NOT_BENCHMARKS = {"__main__", "side_by_side", "page", "peer_wing"}
PACKAGES = ("aeroservo", "numpy", "scipy", "numba", "PanelAero", "control")


def main(arguments: list[str]) -> int:
    """Measure, print and keep every benchmark wanted; all of them if none is named."""
    if arguments[:1] == ["--install-peers"]:
        from benchmarks.peers import install

        return install()
    if arguments[:1] == ["--page"]:
        from benchmarks.page import write_page

        write_page(Path(arguments[1]) if len(arguments) > 1 else HERE.parent / "docs" / "benchmarks.md", RESULTS)
        return 0
    found = sorted(m.name for m in pkgutil.iter_modules([str(HERE)]) if m.name not in NOT_BENCHMARKS)
    unknown = sorted(set(arguments) - set(found))
    if unknown:
        print(f"no benchmark named {', '.join(unknown)}; there are: {', '.join(found)}", file=sys.stderr)
        return 2
    here = machine()
    print("  ".join(f"{key}: {value}" for key, value in here.items() if key != "versions"))
    print("  ".join(f"{name} {number}" for name, number in here["versions"].items()))
    print(f"{'':58s}{'ours':>12s}{'peer':>12s}{'ratio':>9s}{'target':>9s}")
    results: dict[str, list[Row]] = {}
    skipped: dict[str, str] = {}
    now = datetime.now(UTC)
    for name in arguments or found:
        print(name)
        try:
            results[name] = [Row(*row) for row in importlib.import_module(f"benchmarks.{name}").measure()]
        except Skipped as why:
            skipped[name] = str(why)
            print(f"  skipped: {why}")
        for row in results.get(name, []):
            print(line(row), flush=True)
        kept = keep(now, here, results, skipped)  # after each: an interrupted run keeps what it has
    print(f"kept in {os.path.relpath(kept)}")
    return int(any(not row.met for rows in results.values() for row in rows))


def line(row: Row) -> str:
    """One row of the table, its accuracy below."""
    verdict = "" if row.met else "  MISSED"
    first = f"  {row.name:56s}{row.own_s:10.3e} s{row.peer_s:10.3e} s{row.ratio:9.3f}{row.target:9.3g}{verdict}"
    return first + (f"\n      accuracy: {row.accuracy}" if row.accuracy else "")


def machine() -> dict[str, Any]:
    """What the figures were measured on, and with which versions."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    models = [text.split(":", 1)[1].strip() for text in lines if text.startswith("model name")]
    versions = {}
    for name in PACKAGES:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            versions[name] = "not installed"
    return {
        "machine": models[0] if models else platform.processor() or platform.machine(),
        "cores": str(os.cpu_count()),
        "load": f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else "unknown",
        "system": platform.platform(terse=True),
        "python": platform.python_version(),
        "threads": os.environ.get("OMP_NUM_THREADS", "default"),
        "versions": versions,
    }


def keep(now: datetime, here: dict[str, Any], results: dict[str, list[Row]], skipped: dict[str, str]) -> Path:
    """Write the results as JSON under benchmarks/results/ and return the file."""
    data = {
        "at": now.isoformat(timespec="seconds"),
        **here,
        "benchmarks": {
            name: [{**row._asdict(), "ratio": row.ratio, "met": row.met} for row in rows]
            for name, rows in results.items()
        },
        "skipped": skipped,
    }
    path = RESULTS / f"{now:%Y%m%dT%H%M%SZ}.json"
    path.parent.mkdir(exist_ok=True)
    path.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    return path


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
