"""Vortex lattice against PanelAero's on the same panels; cost against panel count by `python benchmarks/vlm.py`.

PanelAero (pip install PanelAero; in the extra `test`): matrix of a full wing of 16 x 64 panels, its inverse, ten
right-hand sides. Circulations are compared before anything is timed.
"""

from __future__ import annotations

import os
import time
import tracemalloc

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")  # one thread each: a busy machine then slows both sides alike

import numpy as np  # noqa: E402

from aeroservo.aero.vlm import Lattice, VortexLattice, lattice, lattice_surface  # noqa: E402
from aeroservo.aero.vlm_normalwash import Normalwash  # noqa: E402
from aeroservo.aero.vlm_solve import solve_lattice  # noqa: E402
from benchmarks.side_by_side import Row, Skipped  # noqa: E402

ROOT_CHORD, TIP_CHORD, HALF_SPAN, TIP_OFFSET = 0.7, 0.3, 1.0, 0.5245


def wing(chordwise: int, half_strips: int, *, full: bool) -> Lattice:
    """The thesis wing with even panels: both codes are then on the same points."""
    options = VortexLattice(chordwise=chordwise, spanwise=half_strips, spacing="uniform")
    edge = [[0.0, 0.0, 0.0], [TIP_OFFSET, HALF_SPAN, 0.0]]
    return lattice([lattice_surface("wing", edge, [ROOT_CHORD, TIP_CHORD], options=options)], full=full)


def panelaero_grid(grid: Lattice) -> dict:
    """The same panels in PanelAero's dictionary (its vortex runs the other way round in z: only signs differ)."""
    along = grid.b - grid.a
    width = np.hypot(along[:, 1], along[:, 2])
    return {
        "n": len(grid),
        "offset_j": grid.control.copy(),
        "offset_P1": grid.a.copy(),
        "offset_P3": grid.b.copy(),
        "N": grid.normal.copy(),
        "A": grid.chord * width,
        "l": grid.chord.copy(),
    }


def right_hand_sides(grid: Lattice, count: int = 10) -> Normalwash:
    """Smooth columns, half of them antisymmetric."""
    x, y = grid.control[:, 0], grid.control[:, 1]
    parity = np.array([1 if i % 2 == 0 else -1 for i in range(count)])
    values = [x ** (i // 2) * (y if parity[i] < 0 else 1.0) for i in range(count)]
    return Normalwash(names=tuple(f"w{i}" for i in range(count)), values=np.stack(values, axis=-1), parity=parity)


def best_of(functions, repeats: int) -> list[float]:
    """Shortest wall time of each function [s], taken in turns so that a busy machine hits all of them alike."""
    times: list[list[float]] = [[] for _ in functions]
    for _ in range(repeats):
        for function, taken in zip(functions, times):
            start = time.perf_counter()
            function()
            taken.append(time.perf_counter() - start)
    return [min(taken) for taken in times]


def measure() -> list[Row]:
    """Full wing of 16 x 64 panels, ten right-hand sides, with symmetry and without."""
    try:
        from panelaero import VLM
    except ImportError:
        raise Skipped("PanelAero is not installed: pip install PanelAero") from None
    half, full = wing(16, 32, full=False), wing(16, 32, full=True)
    w_half, w_full = right_hand_sides(half), right_hand_sides(full)
    other = panelaero_grid(full)

    def theirs() -> np.ndarray:
        qjj, _ = VLM.calc_Qjj(other, 0.0)
        return qjj @ w_full.values

    ours_half = solve_lattice(half, w_half).gamma
    ours_full = solve_lattice(full, w_full).gamma
    # PanelAero returns pressure coefficients: cp = 2 Gamma/(V chord)
    cp = theirs()
    apart = np.abs(2.0 * ours_full / full.chord[:, None] - cp).max() / np.abs(cp).max()
    twin = np.abs(ours_half - ours_full[: len(half)]).max() / np.abs(ours_full).max()
    t_other, t_full, t_half = best_of(
        (theirs, lambda: solve_lattice(full, w_full), lambda: solve_lattice(half, w_half)), 9
    )
    return [
        Row(
            "full wing 16 x 64, 10 right-hand sides, no symmetry / PanelAero", t_full, t_other, 1.0 / 3.0,
            f"largest difference of pressures {apart:.1e}",
        ),
        Row(
            "the same with symmetry / PanelAero", t_half, t_other, 1.0 / 15.0,
            f"half from full {twin:.1e}",
        ),
    ]  # fmt: skip


def cost() -> None:
    """Time and memory against the number of panels, without symmetry."""
    print("panels   time [ms]   per panel^2 [ns]   peak memory [MB]   matrix [MB]")
    for chordwise, strips in ((4, 16), (8, 16), (8, 32), (16, 32), (20, 50), (20, 100)):
        grid = wing(chordwise, strips, full=True)
        columns = right_hand_sides(grid)
        solve_lattice(grid, columns)
        seconds = best_of([lambda g=grid, c=columns: solve_lattice(g, c)], 2 if len(grid) > 2000 else 5)[0]
        tracemalloc.start()
        solve_lattice(grid, columns)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        n = len(grid)
        print(f"{n:6d} {seconds * 1e3:11.1f} {seconds / n**2 * 1e9:18.1f} {peak / 1e6:18.1f} {8 * n * n / 1e6:13.1f}")


if __name__ == "__main__":
    cost()
