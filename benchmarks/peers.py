"""Our vortex lattice against other programs' on the thesis wing, each in its own environment (.venv-peers).

AeroSandbox (VortexLatticeMethod) and PteraSoftware (steady ring vortices): 8 x 24 panels on each half, lift slope of
the flat wing. Both sides make their lattice, solve it and give the lift; imports are not counted. The peers run in
their own interpreter, so turns are not possible: the shortest of five on each side. SHARPy and DLMs need a fortran
compiler and a build of their own and are not installed here.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from aeroservo.aero.vlm import VortexLattice
from aeroservo.aeroelastic.aircraft_lattice import aircraft_lattice
from aeroservo.aircraft.geometry import LiftingSurface, ReferenceQuantities, WingSection
from benchmarks.side_by_side import Row, Skipped

ROOT = Path(__file__).resolve().parents[1]
ENVIRONMENT = ROOT / ".venv-peers"
PEERS = ("aerosandbox", "pterasoftware")
PANELS = (8, 24)
FINE = (24, 96)
ANSWERS = ENVIRONMENT / "installed.json"


def install() -> int:
    """Make the environment, install each peer by itself, keep what happened."""
    python = _python()
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(ENVIRONMENT)], check=True)
    happened = {}
    for peer in PEERS:
        command = [sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", peer]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        problems = [text for text in run.stderr.splitlines() if text.startswith("ERROR")]
        happened[peer] = "" if run.returncode == 0 else (problems or ["pip failed"])[-1][:200]
        print(f"{peer}: {happened[peer] or 'installed'}")
    ANSWERS.write_text(json.dumps(happened, indent=1) + "\n", encoding="utf-8")
    return 0


def _python() -> Path:
    """Interpreter of the environment."""
    return ENVIRONMENT / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def own_wing(panels: tuple[int, int]) -> tuple[float, float]:
    """Shortest time of five and lift slope of the flat wing."""
    surface = LiftingSurface(
        name="wing", sections=(WingSection(y=0.0, chord=0.7), WingSection(y=1.0, x_le=0.524475, chord=0.3))
    )
    reference = ReferenceQuantities(S=1.0, c=0.52667, b=2.0)
    taken, slope = [], np.nan
    for _ in range(6):
        start = time.perf_counter()
        method = VortexLattice(chordwise=panels[0], spanwise=panels[1], spacing="uniform")
        slope = aircraft_lattice([surface], reference, method=method).derivatives.of("CL", "alpha")
        taken.append(time.perf_counter() - start)
    return min(taken[1:]), float(slope)


def measure() -> list[Row]:
    """One row for each peer that runs."""
    if not _python().exists():
        raise Skipped("no other programs installed: python -m benchmarks --install-peers")
    exact = own_wing(FINE)[1]
    own, slope = own_wing(PANELS)
    rows, problems = [], []
    for peer in PEERS:
        command = [str(_python()), str(Path(__file__).with_name("peer_wing.py")), peer, *map(str, PANELS)]
        try:
            run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
        except subprocess.TimeoutExpired:
            problems.append(f"{peer}: no answer in 300 s")
            continue
        if run.returncode:
            problems.append(f"{peer}: {(run.stderr.strip().splitlines() or ['failed'])[-1][:160]}")
            continue
        answer = json.loads(run.stdout.strip().splitlines()[-1])
        rows.append(
            Row(
                f"thesis wing, {PANELS[0]} x {PANELS[1]} a half, all inputs / {peer} {answer['version']}, one state",
                own, answer["seconds"], 1.0,
                f"lift slope off its converged value ({exact:.4f}): ours {slope - exact:+.4f}, "
                f"theirs {answer['CL_alpha'] - exact:+.4f}",
            )
        )  # fmt: skip
    if not rows:
        raise Skipped("; ".join(problems))
    for problem in problems:
        print(f"  skipped: {problem}")
    return rows
