"""Make the polar tables that come with the package: MH 62 with a hinged and a morphed control, by XFOIL.

    python scripts/make_polars.py [--folder src/aeroservo/aero/airfoils] [--only hinged]

Needs XFOIL 6.99 (Debian: apt-get install xfoil) and a C compiler, see aeroservo/aero/polars_xfoil.py. The outline is
deflected by aeroservo/aero/airfoil_deflect.py, so every source of polars sees the same shape. Two runs give the same
files: XFOIL starts afresh for every deflection and Reynolds number. What is done is kept in the cache, so that a run
that was stopped goes on where it was.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from aeroservo.aero.airfoil import Airfoil
from aeroservo.aero.airfoil_deflect import hinged_outline, morphed_outline
from aeroservo.aero.airfoil_files import airfoil
from aeroservo.aero.polars_xfoil import Xfoil, xfoil_points

HINGE = 0.75
OPTIONS = Xfoil(alpha_to=float(np.radians(16.0)), seconds=120.0)
DEFLECTIONS_DEG = {"hinged": np.arange(-10.0, 15.1, 2.5), "morphed": np.arange(-10.0, 15.1, 5.0)}
REYNOLDS = (0.5e6, 1.0e6, 1.5e6, 2.5e6)
SOURCE = "XFOIL 6.99, Ncrit 9, free transition, incompressible, MH 62, control over the last 25 % of the chord"


def outline(kind: str, deflection_deg: float) -> Airfoil:
    """The deflected MH 62."""
    foil = airfoil("mh62")
    if deflection_deg == 0.0:
        return foil
    shape = hinged_outline if kind == "hinged" else morphed_outline
    return shape(foil, HINGE, float(np.radians(deflection_deg)))


def table(kind: str) -> list[str]:
    """Lines of one file."""
    lines = [
        f"# source: {SOURCE}, {kind}" + (" (same trailing-edge drop)" if kind == "morphed" else ""),
        "# made by scripts/make_polars.py; CM about the quarter chord; only converged points, wild ones dropped",
        "reynolds,delta_deg,alpha_deg,CL,CD,CM",
    ]
    jobs = [(re, d) for re in REYNOLDS for d in DEFLECTIONS_DEG[kind]]

    def points(job: tuple[float, float]) -> np.ndarray:
        re, d = job
        return xfoil_points(outline(kind, d), re, options=OPTIONS, cache=True)

    with ThreadPoolExecutor(max_workers=2) as pool:
        for (re, d), rows in zip(jobs, pool.map(points, jobs)):
            print(f"{kind} Re {re:.3g} delta {d:+5.1f} deg: {len(rows)} points", flush=True)
            lines += [f"{re:.0f},{d:g},{np.degrees(a):.1f},{cl:.4f},{cd:.5f},{cm:.4f}" for a, cl, cd, cm in rows]
    return lines


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("src/aeroservo/aero/airfoils"))
    parser.add_argument("--only", choices=("hinged", "morphed"))
    arguments = parser.parse_args()
    for kind in (arguments.only,) if arguments.only else ("hinged", "morphed"):
        (arguments.folder / f"mh62_{kind}.csv").write_text("\n".join(table(kind)) + "\n", encoding="ascii")
