"""Flutter boundaries over a grid: the Goland wing with Jones lags, 200 speeds, against the bare eigenvalue work.

The promise is about 60 x 60 points; a part of that grid is timed here, which scales since points are computed one by
one. The peer does nothing but the eigenvalues of the 200 state matrices of each point.

python -m benchmarks surfaces           # 4 x 3 points
python benchmarks/surfaces.py --whole   # 60 x 60 points, with the total
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.flutter import P
from aeroservo.aeroelastic.linear import state_matrix
from aeroservo.aircraft.files import read
from aeroservo.datatypes import FlightCondition
from aeroservo.studies.boundary import Over, flutter_boundary
from benchmarks.side_by_side import Row, compare

SPEEDS = FlightCondition.at(0.0, V=np.linspace(1.0, 350.0, 200))
FIELDS = ("wing.station[1].GJ_N_m2", "wing.station[1].cg_axis"), ("altitude_m", "wing.station[1].GJ_N_m2")


def grid(fields: tuple[str, str], n: int, m: int) -> tuple[Over, Over]:
    """n by m values of two fields."""
    ranges = {
        "wing.station[1].GJ_N_m2": (0.5e6, 1.5e6),
        "wing.station[1].cg_axis": (0.36, 0.46),
        "altitude_m": (0.0, 9000.0),
    }
    first, second = (
        Over(field=field, values=tuple(np.linspace(*ranges[field], count))) for field, count in zip(fields, (n, m))
    )
    return first, second


def bare(points: int) -> None:
    """Eigenvalues of the state matrices, nothing else."""
    for _ in range(points):
        np.linalg.eigvals(MATRICES)


MATRICES = state_matrix(build(read("goland"), "jones"), SPEEDS)


def measure() -> list[Row]:
    """Two grids: structure and inertia; altitude and stiffness."""
    model, rows = read("goland"), []
    for fields in FIELDS:
        over = grid(fields, 4, 3)
        rows.append(
            compare(
                f"12 points x 200 speeds over {fields[0].split('.')[-1]} and {fields[1].split('.')[-1]} / eigenvalues",
                lambda over=over: flutter_boundary(model, over, SPEEDS, P(), aero="jones", names=False),  # type: ignore[misc]
                lambda: bare(12),
                target=6.0,
                rounds=3,
            )
        )
    return rows


def whole() -> None:
    """The whole of 60 x 60 points, once."""
    start = time.perf_counter()
    points = flutter_boundary(read("goland"), grid(FIELDS[0], 60, 60), SPEEDS, P(), aero="jones", names=False)
    own = time.perf_counter() - start
    start = time.perf_counter()
    bare(360)
    peer = 10.0 * (time.perf_counter() - start)
    print(f"{len(points)} points: {own:.1f} s, eigenvalues alone {peer:.1f} s, ratio {own / peer:.2f}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--whole", action="store_true", help="60 x 60 points")
    if parser.parse_args().whole:
        whole()
    else:
        for row in measure():
            print(row, row.ratio)
