"""Section polars over angle of attack, Reynolds number and deflection: one type, whatever they come from.

A lookup outside a table, or beyond stall, is marked, and outside it gives NaN: nothing is extrapolated. Sources:
shipped tables (`polars_points`), XFOIL (`polars_xfoil`), NeuralFoil (`polars_neuralfoil`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aeroservo.datatypes import frozen

#: Meaning of the marks of a lookup.
INSIDE, STALLED, OUTSIDE = 0, 1, 2
#: A place this close to a point of an axis, in steps of it, is that point: degrees turned to radians and back.
SNAP = 1e-7


@dataclass(frozen=True, kw_only=True, eq=False)
class Polar:
    """Lift, drag and moment of a section; NaN where there is no converged point.

    Parameters
    ----------
    name : str
        Airfoil and kind of control.
    source : str
        What computed or measured it, with the version.
    alpha, delta, reynolds : array_like, shapes (n_a,), (n_d,), (n_r,)
        Ascending axes: angle of attack [rad], deflection [rad], Reynolds number [-].
    CL, CD, CM : array_like, shape (n_r, n_d, n_a)
        CM about the quarter chord, nose up. [-]
    """

    name: str
    source: str
    alpha: np.ndarray
    delta: np.ndarray
    reynolds: np.ndarray
    CL: np.ndarray
    CD: np.ndarray
    CM: np.ndarray

    def __post_init__(self) -> None:
        for name in ("alpha", "delta", "reynolds"):
            axis = frozen(getattr(self, name), ndim=1, name=name)
            if not len(axis) or np.any(np.diff(axis) <= 0.0):
                raise ValueError(f"axis {name} of polar {self.name!r} must ascend without repeats")
            object.__setattr__(self, name, axis)
        if self.reynolds[0] <= 0.0:
            raise ValueError(f"reynolds of polar {self.name!r} must be > 0 [-], got {self.reynolds[0]:g}")
        shape = (len(self.reynolds), len(self.delta), len(self.alpha))
        for name in ("CL", "CD", "CM"):
            table = np.array(getattr(self, name), dtype=float)
            if table.shape != shape:
                raise ValueError(f"{name} of polar {self.name!r} must have shape {shape}, got {table.shape}")
            table.flags.writeable = False
            object.__setattr__(self, name, table)


@dataclass(frozen=True, kw_only=True, eq=False)
class PolarPoint:
    """Result of a lookup; see `section_coefficients` and `section_at_lift`."""

    alpha: np.ndarray  # (...) [rad] angle of attack
    CL: np.ndarray  # (...) [-] lift coefficient
    CD: np.ndarray  # (...) [-] drag coefficient
    CM: np.ndarray  # (...) [-] moment coefficient about the quarter chord
    mark: np.ndarray  # (...) INSIDE (index 0), STALLED (1) or OUTSIDE (2): int


def section_coefficients(
    polar: Polar, alpha: np.ndarray, *, reynolds: np.ndarray | float, delta: np.ndarray | float = 0.0
) -> PolarPoint:
    """Coefficients at angles of attack, linear in alpha, delta and the logarithm of the Reynolds number.

    Parameters
    ----------
    polar : Polar
        The table.
    alpha : array_like, shape (...)
        Angles of attack. [rad]
    reynolds : array_like, shape that broadcasts to (...)
        Reynolds numbers. [-]
    delta : array_like, shape that broadcasts to (...)
        Deflections, trailing edge down. [rad]

    Returns
    -------
    PolarPoint
        NaN and the mark OUTSIDE where the table has no points; STALLED beyond the largest or smallest lift.

    References
    ----------
    Project convention: polars, "no extrapolation".

    Examples
    --------
    >>> from aeroservo.aero.polars_points import shipped_polar
    >>> p = section_coefficients(shipped_polar("mh62", "hinged"), np.radians([0.0, 60.0]), reynolds=1e6)
    >>> p.mark.tolist()
    [0, 2]
    """
    alpha, reynolds, delta = np.broadcast_arrays(np.asarray(alpha, float), reynolds, delta)
    curves, known = _curves(polar, reynolds, delta)
    axis = polar.alpha
    position = np.clip((alpha - axis[0]) / (axis[-1] - axis[0]) * (len(axis) - 1), 0, len(axis) - 1)
    i = np.minimum(np.searchsorted(axis, alpha, side="right") - 1, len(axis) - 2)
    i = np.maximum(i, 0)
    t = (alpha - axis[i]) / (axis[i + 1] - axis[i])
    t = np.where(np.abs(t - np.round(t)) < SNAP, np.round(t), t)
    inside = known & (t >= 0.0) & (t <= 1.0) & np.isfinite(position)
    values = [_between(c, i, t) for c in curves]
    inside &= np.isfinite(values[0]) & np.isfinite(values[1]) & np.isfinite(values[2])
    values = [np.where(inside, v, np.nan) for v in values]
    low, high = _stall(polar, curves[0])
    stalled = inside & ((alpha < low - 1e-12) | (alpha > high + 1e-12))
    mark = np.where(inside, np.where(stalled, STALLED, INSIDE), OUTSIDE)
    return PolarPoint(alpha=np.array(alpha), CL=values[0], CD=values[1], CM=values[2], mark=mark)


def section_at_lift(
    polar: Polar, lift: np.ndarray, *, reynolds: np.ndarray | float, delta: np.ndarray | float = 0.0
) -> PolarPoint:
    """The state of a section that carries a given lift, on the branch between the stalls.

    Parameters
    ----------
    polar : Polar
        The table.
    lift : array_like, shape (...)
        Lift coefficients. [-]
    reynolds : array_like, shape that broadcasts to (...)
        Reynolds numbers. [-]
    delta : array_like, shape that broadcasts to (...)
        Deflections. [rad]

    Returns
    -------
    PolarPoint
        Where no angle gives the lift: STALLED, with the values at the largest (or smallest) lift of the table, so
        its CL is less than asked; OUTSIDE with NaN where Reynolds number or deflection lie outside, or where the
        table ends before its lift does.

    References
    ----------
    Project convention: polars, "no extrapolation".

    Examples
    --------
    >>> from aeroservo.aero.polars_points import shipped_polar
    >>> p = section_at_lift(shipped_polar("mh62", "hinged"), np.array([0.3, 5.0]), reynolds=1e6)
    >>> p.mark.tolist(), bool(p.CL[1] < 2.0)
    ([0, 1], True)
    """
    lift, reynolds, delta = np.broadcast_arrays(np.asarray(lift, float), reynolds, delta)
    curves, known = _curves(polar, reynolds, delta)
    flat = [np.ascontiguousarray(c.reshape(-1, len(polar.alpha))) for c in curves]
    out = np.full((4, lift.size), np.nan)
    mark = np.full(lift.size, OUTSIDE)
    for k, wanted in enumerate(lift.ravel()):
        if known.ravel()[k]:
            mark[k] = _invert(polar.alpha, [f[k] for f in flat], wanted, out[:, k])
    shaped = [o.reshape(lift.shape) for o in out]
    return PolarPoint(alpha=shaped[0], CL=shaped[1], CD=shaped[2], CM=shaped[3], mark=mark.reshape(lift.shape))


def best_lift_to_drag(polar: Polar, *, reynolds: float, delta: float = 0.0) -> tuple[float, float]:
    """Largest L/D of a section, by a running median of three points so that one wild point cannot win.

    Parameters
    ----------
    polar : Polar
        The table.
    reynolds : float
        Reynolds number. [-]
    delta : float
        Deflection. [rad]

    Returns
    -------
    ratio, alpha : float
        CL/CD [-] and where it is [rad].

    Raises
    ------
    ValueError
        If Reynolds number or deflection lie outside the table.

    References
    ----------
    Bramstång 2015, figure 21.

    Examples
    --------
    >>> from aeroservo.aero.polars_points import shipped_polar
    >>> best_lift_to_drag(shipped_polar("mh62", "hinged"), reynolds=1e6)[0] > 80
    True
    """
    curves, known = _curves(polar, np.array(float(reynolds)), np.array(float(delta)))
    if not known:
        raise ValueError(
            f"reynolds {reynolds:g} [-] and deflection {np.degrees(delta):g} deg must lie in the table of "
            f"{polar.name!r}: {polar.reynolds[0]:g} to {polar.reynolds[-1]:g}, "
            f"{np.degrees(polar.delta[0]):g} to {np.degrees(polar.delta[-1]):g} deg"
        )
    ratio = curves[0] / curves[1]
    ok = np.flatnonzero(np.isfinite(ratio))
    ratio, alpha = ratio[ok], polar.alpha[ok]
    middle = np.median(np.stack([ratio[:-2], ratio[1:-1], ratio[2:]]), axis=0)
    best = int(np.argmax(middle))
    return float(middle[best]), float(alpha[best + 1])


def _curves(polar: Polar, reynolds: np.ndarray, delta: np.ndarray) -> tuple[list[np.ndarray], np.ndarray]:
    """CL, CD, CM over alpha at each (Reynolds, delta), shape (..., n_a), and whether that lies in the table."""
    found = []
    known = np.ones(np.shape(reynolds), dtype=bool)
    for axis, value in ((np.log(polar.reynolds), np.log(np.maximum(reynolds, 1e-300))), (polar.delta, delta)):
        if len(axis) == 1:
            i, t = np.zeros(np.shape(value), dtype=int), np.zeros(np.shape(value))
            known &= np.abs(value - axis[0]) < 1e-6
        else:
            i = np.clip(np.searchsorted(axis, value, side="right") - 1, 0, len(axis) - 2)
            t = (value - axis[i]) / (axis[i + 1] - axis[i])
            t = np.where(np.abs(t - np.round(t)) < SNAP, np.round(t), t)
            known &= (t >= 0.0) & (t <= 1.0)
        found.append((i, np.clip(t, 0.0, 1.0)))
    (i, s), (j, t) = found
    i2, j2 = np.minimum(i + 1, len(polar.reynolds) - 1), np.minimum(j + 1, len(polar.delta) - 1)
    curves = []
    for table in (polar.CL, polar.CD, polar.CM):
        low = _mix(table[i, j], table[i, j2], t)
        high = _mix(table[i2, j], table[i2, j2], t)
        curves.append(_mix(low, high, s))
    return curves, known


def _mix(a: np.ndarray, b: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Linear between two curves; an end that weighs nothing may be NaN."""
    t = np.asarray(t)[..., None]
    return np.where(t == 0.0, a, np.where(t == 1.0, b, a + t * (b - a)))


def _between(curve: np.ndarray, i: np.ndarray, t: np.ndarray) -> np.ndarray:
    a = np.take_along_axis(curve, np.asarray(i)[..., None], axis=-1)[..., 0]
    b = np.take_along_axis(curve, np.asarray(i)[..., None] + 1, axis=-1)[..., 0]
    return np.where(t == 0.0, a, np.where(t == 1.0, b, a + t * (b - a)))


def _stall(polar: Polar, CL: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles of the smallest and largest lift of each curve."""
    top = np.argmax(np.where(np.isfinite(CL), CL, -np.inf), axis=-1)
    bottom = np.argmin(np.where(np.isfinite(CL), CL, np.inf), axis=-1)
    return polar.alpha[bottom], polar.alpha[top]


def _invert(alpha: np.ndarray, curves: list[np.ndarray], wanted: float, out: np.ndarray) -> int:
    """Write alpha, CL, CD, CM of the state with the wanted lift; return its mark."""
    ok = np.isfinite(curves[0]) & np.isfinite(curves[1]) & np.isfinite(curves[2])
    if ok.sum() < 2:
        return OUTSIDE
    points = [alpha[ok], *(c[ok] for c in curves)]
    CL = points[1]
    low, high = int(np.argmin(CL)), int(np.argmax(CL))
    if low >= high:
        return OUTSIDE
    branch = [p[low : high + 1] for p in points]
    rising = np.maximum.accumulate(branch[1])
    if wanted > rising[-1] or wanted < rising[0]:
        end = high if wanted > rising[-1] else low
        at_edge = end in (0, len(CL) - 1)
        out[:] = [p[end] for p in points]
        if at_edge:  # the table ends while lift still grows: it does not know what follows
            out[:] = np.nan
            return OUTSIDE
        return STALLED
    k = int(np.clip(np.searchsorted(rising, wanted, side="left"), 1, len(rising) - 1))
    t = (wanted - rising[k - 1]) / max(rising[k] - rising[k - 1], 1e-300)
    out[:] = [p[k - 1] + t * (p[k] - p[k - 1]) for p in branch]
    return INSIDE
