"""Taper and washout against the elliptic loading: what a straight-tapered wing's planform costs in induced drag."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from aeroservo.aero.trefftz import induced_drag, span_efficiency
from aeroservo.aero.vlm import VortexLattice, lattice, lattice_surface
from aeroservo.aero.vlm_loads import lattice_loads, strip_circulation
from aeroservo.aero.vlm_normalwash import join_normalwash, slope_normalwash
from aeroservo.aero.vlm_solve import solve_lattice
from aeroservo.aeroelastic.aircraft_lattice import DEFAULT


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadingStudy:
    """Efficiency and shape of the span loading over taper and washout; see `loading_study`."""

    taper: np.ndarray  # (n_t,) [-] tip chord over root chord
    washout: np.ndarray  # (n_w,) [rad] tip incidence less root incidence, negative
    efficiency: np.ndarray  # (n_t, n_w) [-] Oswald's, 1 for the elliptic loading
    deviation: np.ndarray  # (n_t, n_w) [-] root mean square of (circulation - elliptic)/(elliptic at the root)
    tip_margin: np.ndarray  # (n_t, n_w) [-] largest local lift coefficient of the inner half over the outer half's


def loading_study(
    *,
    aspect_ratio: float,
    sweep: float,
    taper: Sequence[float] | np.ndarray,
    washout: Sequence[float] | np.ndarray,
    CL: float,
    method: VortexLattice = DEFAULT,
) -> LoadingStudy:
    """Induced drag of straight-tapered wings of one aspect ratio and one sweep, at one lift.

    Parameters
    ----------
    aspect_ratio : float
        Span squared over area. [-]
    sweep : float
        Sweep of the quarter-chord line. [rad]
    taper : array_like, shape (n_t,)
        Tip chord over root chord, positive. [-]
    washout : array_like, shape (n_w,)
        Tip incidence less root incidence, linear between; washout is negative. [rad]
    CL : float
        Lift coefficient at which the wings are compared. [-]
    method : VortexLattice
        Panels.

    Returns
    -------
    LoadingStudy
        One lattice for each taper serves every washout, for the solution is linear.

    Raises
    ------
    ValueError
        If a taper, the aspect ratio or the lift coefficient is not positive.

    References
    ----------
    Bramstång 2015, chapter 9.1.3 (a taper close to 0.4 for an elliptic loading); L. Prandtl, NACA Report 116, 1921.

    Examples
    --------
    >>> found = loading_study(aspect_ratio=4.0, sweep=0.0, taper=[0.4], washout=[0.0], CL=0.3)
    >>> bool(found.efficiency[0, 0] > 0.98)
    True
    """
    tapers, washouts = np.atleast_1d(np.asarray(taper, float)), np.atleast_1d(np.asarray(washout, float))
    if np.any(tapers <= 0.0) or aspect_ratio <= 0.0 or CL <= 0.0:
        raise ValueError(f"taper, aspect_ratio and CL must be > 0 [-], got {tapers.min():g}, {aspect_ratio:g}, {CL:g}")
    shape = (len(tapers), len(washouts))
    out = {name: np.zeros(shape) for name in ("efficiency", "deviation", "tip_margin")}
    for i, ratio in enumerate(tapers):
        root = 2.0 / (aspect_ratio * (1.0 + ratio)) * 2.0  # semi-span 1
        offset = np.tan(sweep) + 0.25 * root * (1.0 - ratio)
        edge = np.array([[0.0, 0.0, 0.0], [offset, 1.0, 0.0]])
        surface = lattice_surface("wing", edge, np.array([root, ratio * root]), options=method)
        grid = lattice([surface])
        span = grid.strip_span[grid.strip]
        wash = join_normalwash(
            [slope_normalwash(grid, "alpha", -np.ones(len(grid))), slope_normalwash(grid, "twist", -span)]
        )
        solution = solve_lattice(grid, wash, mach=method.mach)
        area = root * (1.0 + ratio)
        lift = lattice_loads(solution, [0.0, 0.0, 0.0]).force[:, 2]
        drag, circulation = induced_drag(solution), strip_circulation(solution)
        elliptic = np.sqrt(1.0 - grid.strip_span**2)
        for j, twist in enumerate(washouts):
            x = np.array([(CL * area - twist * lift[1]) / lift[0], twist])
            out["efficiency"][i, j] = span_efficiency(CL * area, float(drag.area(x)), 2.0)
            loading = circulation @ x
            fitted = elliptic * np.sum(loading * grid.strip_width) / np.sum(elliptic * grid.strip_width)
            square = np.sum((loading - fitted) ** 2 * grid.strip_width) / np.sum(grid.strip_width)
            out["deviation"][i, j] = np.sqrt(square) / fitted.max()
            cl = 2.0 * loading / grid.strip_chord
            inner = grid.strip_span < 0.5
            out["tip_margin"][i, j] = cl[inner].max() / cl[~inner].max()
    return LoadingStudy(taper=tapers, washout=washouts, **out)
