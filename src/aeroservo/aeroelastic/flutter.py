"""Flutter: the speeds at which a model becomes unstable, by the p, p-k, k or g method."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.aero.rational import RationalFit, fit_rational
from aeroservo.aeroelastic.branches import Branches, Interval, follow_branches, unstable_intervals
from aeroservo.aeroelastic.creep import at_creep_divergence
from aeroservo.aeroelastic.kmethod import k_boundaries, k_curves
from aeroservo.aeroelastic.pk import frequency_roots
from aeroservo.aeroelastic.roots import RootSet, frequency_scale, p_roots, p_values, slowest
from aeroservo.aeroelastic.stability import Boundary, boundaries
from aeroservo.aeroelastic.static import divergence
from aeroservo.datatypes import AeroelasticModel, FlightCondition, RationalAero

Array = NDArray[Any]

SEARCH_POINTS = 129
"""Speeds of the stability search besides the user's own, so that results do not depend on the step."""


@dataclass(frozen=True, kw_only=True)
class P:
    """p method: eigenvalues of the state space; sampled air forces are fitted first.

    Attributes
    ----------
    fit_bound : float
        Largest allowed error of that fit, as part of the largest |Q| of each column. [-]
    """

    fit_bound: float = 0.01


@dataclass(frozen=True, kw_only=True)
class PK:
    """p-k method: eigenvalues whose frequency is that at which Q was taken."""


@dataclass(frozen=True, kw_only=True)
class G:
    """g method: p-k with Q expanded to first order off the imaginary axis."""


@dataclass(frozen=True, kw_only=True)
class K:
    """k method: harmonic motion with the structural damping that would sustain it."""


Method = P | PK | K | G


@dataclass(frozen=True, kw_only=True, eq=False)
class FlutterResult:
    """What `flutter` found.

    Attributes
    ----------
    condition : FlightCondition
        The sweep. [m/s, kg/m^3]
    method : str
        "p", "pk", "k" or "g".
    names : tuple of str
        Branches, in order of the natural frequencies.
    speeds : ndarray, shape (n_points, n_branches)
        Speeds at which each branch is given: those of the sweep, or of the k method's curves. [m/s]
    roots : complex ndarray, shape (n_points, n_branches)
        Followed roots, nan where a branch does not exist; the k method's are omega (g/2 + i)
        with g its artificial damping, nan where the harmonic motion has no speed. [1/s]
    shapes : complex ndarray, shape (n_points, n_branches, n)
        Their shapes in the modes of the model. [-]
    boundaries : tuple of Boundary
        Every change of stability in the range, in order. [m/s]
    intervals : tuple of Interval
        Unstable ranges, in order of their start. [m/s]
    flutter_speed, flutter_frequency : float or None
        Lowest crossing into an oscillatory instability. [m/s, rad/s]
    flutter_mode : str or None
        The mode that crosses.
    divergence_speed : float or None
        Static divergence with rigid-body modes fixed, whatever the range of the sweep. [m/s]
    first_real_instability : float or None
        Lowest speed in the range where a real root of the full model becomes positive. [m/s]
    fit : RationalFit or None
        The fit that the p method made of sampled air forces.
    warnings : tuple of str
        What to know before trusting the numbers.
    """

    condition: FlightCondition
    method: str
    names: tuple[str, ...]
    speeds: Array
    roots: Array
    shapes: Array
    boundaries: tuple[Boundary, ...]
    intervals: tuple[Interval, ...]
    flutter_speed: float | None
    flutter_frequency: float | None
    flutter_mode: str | None
    divergence_speed: float | None
    first_real_instability: float | None
    fit: RationalFit | None
    warnings: tuple[str, ...]

    @property
    def found(self) -> bool:
        """Whether any instability lies in the range of the sweep."""
        return bool(self.intervals)

    @property
    def V(self) -> Array:
        """Speeds of the sweep, shape (n_V,). [m/s]"""
        return self.condition.V

    @property
    def frequency(self) -> Array:
        """Frequencies |Im s| of the branches, shape (n_points, n_branches). [rad/s]"""
        return np.where(np.isfinite(self.roots.real), np.abs(self.roots.imag), np.nan)

    @property
    def damping_ratio(self) -> Array:
        """zeta = -Re s / |s|, positive stable, shape (n_points, n_branches). [-]"""
        size = np.abs(self.roots)
        return -self.roots.real / np.where(size > 0.0, size, 1.0)

    @property
    def crossings(self) -> Array:
        """Speed and frequency of every oscillatory crossing, shape (n, 2). [m/s, rad/s]"""
        rows = [(b.V, b.root.imag) for b in self.boundaries if b.kind == "oscillatory"]
        return np.array(rows).reshape(-1, 2)


def flutter(model: AeroelasticModel, sweep: FlightCondition, method: Method = PK()) -> FlutterResult:
    """Speeds at which a model flutters or becomes unstable aperiodically.

    The search counts unstable roots, refines every change to better than 1e-6 and maximises growth
    between speeds; it uses speeds of its own besides those of the sweep, so the answer does not
    depend on the step. Modes are followed for their names and for plots only.

    Parameters
    ----------
    model : AeroelasticModel
        Any; nonlinear springs are taken by their linear stiffness.
    sweep : FlightCondition
        Two or more ascending speeds at one density, shape (n_V,). [m/s, kg/m^3]
    method : P, PK, K or G
        How roots are found.

    Returns
    -------
    result : FlutterResult
        Speeds, intervals, branches. [SI]

    Raises
    ------
    ValueError
        If the sweep is not an ascending row at one density, or the method cannot treat the model.

    References
    ----------
    contract.md, "flutter"; Bramstång 2015, section 7.3; Hassig 1971; Chen 2000; NACA Report 685.

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.1]], K=[[4.0]], names=("h",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> flutter(AeroelasticModel(modes=one, aero=air), FlightCondition(V=[1.0, 9.0], rho=1.2)).found
    False
    """
    check_sweep(sweep)
    model, fit = prepared(model, method)
    scale = frequency_scale(model)

    def fresh_roots(V: Array) -> RootSet:
        condition = FlightCondition(V=V, rho=sweep.rho[0], a_sound=sweep.a_sound[0])
        if isinstance(method, P):
            return p_roots(model, condition)
        return frequency_roots(model, condition, g_method=isinstance(method, G))

    def fresh_values(V: Array) -> Array:
        if isinstance(method, P):
            return p_values(model, FlightCondition(V=V, rho=sweep.rho[0], a_sound=sweep.a_sound[0]))
        return fresh_roots(V).values

    values_at = remembered(fresh_values)
    mesh = np.union1d(sweep.V, np.linspace(sweep.V[0], sweep.V[-1], SEARCH_POINTS))
    changes = boundaries(values_at, mesh, values_at(mesh), scale)
    if model.modes.relaxing:
        changes = at_creep_divergence(model, sweep[0], changes)
    if isinstance(method, K):
        found = [b for b in changes if b.kind == "real"] + k_boundaries(model, sweep)
        changes = sorted(found, key=lambda boundary: boundary.V)
    mesh = np.union1d(mesh, [b.V for b in changes])
    start = 1e-3 * slowest(model) * model.aero.b
    branches = follow_branches(model.modes, fresh_roots, values_at, mesh, start)
    intervals = unstable_intervals(changes, branches, float(sweep.V[0]), scale)
    if isinstance(method, K):
        names, speeds, roots, shapes = k_curves(model, sweep)
    else:
        names, roots, shapes = _on_sweep(branches, fresh_roots(sweep.V), sweep.V, intervals)
        speeds = np.broadcast_to(sweep.V[:, None], roots.shape)
    onset = _onset(changes, intervals)
    real = [b.V for b in changes if (b.kind == "real" and b.opens) or b.kind == "split"]
    return FlutterResult(
        condition=sweep,
        method=type(method).__name__.lower(),
        names=names,
        speeds=speeds,
        roots=roots,
        shapes=shapes,
        boundaries=tuple(changes),
        intervals=tuple(intervals),
        flutter_speed=onset.V if onset else None,
        flutter_frequency=onset.root.imag if onset else None,
        flutter_mode=branches.name_at(onset.V, onset.root) if onset else None,
        divergence_speed=divergence(model, sweep[0]).V,
        first_real_instability=real[0] if real else None,
        fit=fit,
        warnings=tuple(_warnings(model, sweep, intervals)),
    )


def check_sweep(sweep: FlightCondition) -> None:
    """Refuse a sweep that is not two or more ascending speeds at one density.

    Parameters
    ----------
    sweep : FlightCondition
        The sweep. [m/s, kg/m^3]

    Raises
    ------
    ValueError
        Naming what is wrong.

    References
    ----------
    contract.md, common options (`--speeds MIN:MAX:STEP`).

    Examples
    --------
    >>> check_sweep(FlightCondition(V=[1.0, 2.0], rho=1.2))
    """
    if sweep.V.ndim != 1 or sweep.V.size < 2 or np.any(np.diff(sweep.V) <= 0.0):
        raise ValueError(f"the sweep must be two or more ascending speeds [m/s], got shape {sweep.V.shape}")
    if np.ptp(sweep.rho) > 0.0 or np.ptp(sweep.a_sound) > 0.0:
        raise ValueError("a sweep has one density and one speed of sound; call once for each altitude")


def remembered(values_at: Callable[[Array], Array]) -> Callable[[Array], Array]:
    """The same function of speed, each speed computed once.

    Parameters
    ----------
    values_at : callable
        Roots (m, n_roots) at speeds (m,), each row by its speed alone. [1/s]

    Returns
    -------
    values_at : callable
        With a memory of its own. [1/s]

    References
    ----------
    Project convention: docs/architecture.md, "Tracking".

    Examples
    --------
    >>> slow = remembered(lambda V: V[:, None] + 0j)
    >>> slow(np.array([1.0, 2.0, 1.0]))[:, 0].real.tolist()
    [1.0, 2.0, 1.0]
    """
    memory: dict[float, Array] = {}

    def recalled(V: Array) -> Array:
        unknown = np.array([v for v in dict.fromkeys(V.tolist()) if v not in memory])
        if unknown.size:
            memory.update(zip(unknown.tolist(), values_at(unknown)))
        return np.stack([memory[v] for v in V.tolist()])

    return recalled


def prepared(model: AeroelasticModel, method: Method) -> tuple[AeroelasticModel, RationalFit | None]:
    """The model with rational air forces where the p method needs them.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    method : P, PK, K or G
        The method to be used.

    Returns
    -------
    model : AeroelasticModel
        Ready for the method.
    fit : RationalFit or None
        The fit that was made.

    Raises
    ------
    ValueError
        If the error of the fit exceeds the method's bound.

    References
    ----------
    contract.md, `--method p` on sampled aero.

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.1]], K=[[4.0]], names=("h",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> prepared(AeroelasticModel(modes=one, aero=air), PK())[1] is None
    True
    """
    if not isinstance(method, P) or isinstance(model.aero, RationalAero):
        return model, None
    fit = fit_rational(model.aero)
    if fit.error > method.fit_bound:
        raise ValueError(
            f"the rational fit of these air forces is off by {100 * fit.error:.3g} % of the largest |Q| of column "
            f"{fit.worst_input!r}, more than the bound of {100 * method.fit_bound:g} %: use p-k, or allow more"
        )
    return replace(model, aero=fit.aero), fit


def _onset(changes: Sequence[Boundary], intervals: Sequence[Interval]) -> Boundary | None:
    """Lowest crossing into oscillatory instability, None where an oscillation is unstable from the start."""
    if any(interval.start is None and interval.kind == "flutter" for interval in intervals):
        return None
    return next((b for b in changes if b.kind == "oscillatory" and b.opens), None)


def _on_sweep(
    branches: Branches, found: RootSet, V: Array, intervals: Sequence[Interval]
) -> tuple[tuple[str, ...], Array, Array]:
    """Named branches, and lag branches that are ever unstable, at the speeds of the sweep."""
    values = branches.roots[np.searchsorted(branches.V, V)]
    lag = np.array([name.startswith("lag ") for name in branches.names])
    unstable = np.array([any(i.mode == name for i in intervals) for name in branches.names])
    shown = np.flatnonzero(branches.primary & (~lag | unstable))
    start = np.where(np.isfinite(branches.roots[0]), branches.roots[0].imag, 0.0)
    shown = shown[np.lexsort((start[shown], lag[shown]))]
    values = values[:, shown]
    distance = np.abs(np.where(np.isfinite(found.values), found.values, np.inf)[:, None, :] - values[:, :, None])
    pick = np.argmin(np.where(np.isfinite(distance), distance, np.inf), axis=2)
    shapes = np.take_along_axis(found.shapes, pick[..., None], axis=1)
    return tuple(branches.names[j] for j in shown), values, shapes


def _warnings(model: AeroelasticModel, sweep: FlightCondition, intervals: Sequence[Interval]) -> list[str]:
    """What to know before trusting the numbers."""
    notes = []
    top = float(sweep.mach.max())
    if np.all(model.aero.mach == 0.0) and top > 0.3:
        notes.append("speeds above Mach 0.3: incompressible theory")
    elif len(model.aero.mach) > 1 and not model.aero.mach[0] <= sweep.mach.min() <= top <= model.aero.mach[-1]:
        notes.append(
            f"Mach numbers {sweep.mach.min():.3g} to {top:.3g} leave the air forces' {model.aero.mach[0]:g} to "
            f"{model.aero.mach[-1]:g}: the nearest is used"
        )
    if any(interval.start is None for interval in intervals):
        notes.append(f"already unstable at the lowest speed, {sweep.V[0]:g} m/s: start the sweep lower")
    if model.springs:
        notes.append("nonlinear springs are taken by their linear stiffness, without freeplay")
    return notes
