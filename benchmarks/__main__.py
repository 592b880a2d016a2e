"""Run the benchmarks: all of them, or those named on the command line. Exit code 1 if a target is missed."""

from __future__ import annotations

import importlib
import json
import os
import pkgutil
import platform
import sys
from datetime import UTC, datetime
from pathlib import Path

from benchmarks.side_by_side import Row

HERE = Path(__file__).resolve().parent
NOT_BENCHMARKS = {"__main__", "side_by_side"}


def main(wanted: list[str]) -> int:
    """Measure, print and keep every benchmark wanted; all of them if none is named."""
    found = sorted(m.name for m in pkgutil.iter_modules([str(HERE)]) if m.name not in NOT_BENCHMARKS)
    unknown = sorted(set(wanted) - set(found))
    if unknown:
        print(f"no benchmark named {', '.join(unknown)}; there are: {', '.join(found)}", file=sys.stderr)
        return 2
    here = machine()
    print("  ".join(f"{key}: {value}" for key, value in here.items()))
    print(f"{'':58s}{'ours':>12s}{'peer':>12s}{'ratio':>9s}{'target':>9s}")
    results: dict[str, list[Row]] = {}
    for name in wanted or found:
        print(name)
        measure = getattr(importlib.import_module(f"benchmarks.{name}"), "measure", None)
        if measure is None:
            print(f"  prints its own tables: {os.path.relpath(sys.executable)} benchmarks/{name}.py")
            continue
        results[name] = [Row(*row) for row in measure()]
        for row in results[name]:
            print(line(row), flush=True)
    print(f"kept in {os.path.relpath(keep(here, results))}")
    return int(any(not row.met for rows in results.values() for row in rows))


def line(row: Row) -> str:
    """One row of the table."""
    verdict = "" if row.met else "  MISSED"
    return f"  {row.name:56s}{row.own_s:10.3e} s{row.peer_s:10.3e} s{row.ratio:9.3f}{row.target:9.3g}{verdict}"


def machine() -> dict[str, str]:
    """What the figures were measured on."""
    import numpy as np

    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    models = [text.split(":", 1)[1].strip() for text in lines if text.startswith("model name")]
    return {
        "machine": models[0] if models else platform.processor() or platform.machine(),
        "cores": str(os.cpu_count()),
        "system": platform.platform(terse=True),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "threads": os.environ.get("OMP_NUM_THREADS", "default"),
    }


def keep(here: dict[str, str], results: dict[str, list[Row]]) -> Path:
    """Write the results as JSON under benchmarks/results/ (not in git) and return the file."""
    now = datetime.now(UTC)
    data = {
        "at": now.isoformat(timespec="seconds"),
        **here,
        "benchmarks": {
            name: [{**row._asdict(), "ratio": row.ratio, "met": row.met} for row in rows]
            for name, rows in results.items()
        },
    }
    path = HERE / "results" / f"{now:%Y%m%dT%H%M%SZ}.json"
    path.parent.mkdir(exist_ok=True)
    path.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    return path


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
