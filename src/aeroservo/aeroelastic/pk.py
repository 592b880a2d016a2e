"""The p-k and g methods: roots whose frequency is that at which Q was taken.

Hassig's p-k in the real form of Rodden, and Chen's g method, which adds the change of Q off the
imaginary axis to first order. Both are exact on the axis, so they agree on every boundary.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.aeroelastic.linear import displacement_free
from aeroservo.aeroelastic.rootfinding import bracketed_roots
from aeroservo.aeroelastic.roots import RootSet, frequency_scale, normalised, slowest
from aeroservo.datatypes import AeroelasticModel, FlightCondition

Array = NDArray[Any]

SCAN_POINTS = 18
"""Frequencies at which p-k and g look for brackets before refining."""

NEWTON_STEPS = 14
"""Newton steps before a root is left to bracketing."""

APERIODIC_K = 1e-3
"""Reduced frequency at which p-k takes the aerodynamic damping Im Q / k of an aperiodic root."""


def frequency_matrix(model: AeroelasticModel, condition: FlightCondition, omega: Array, *, g_method: bool) -> Array:
    """State matrix of z = [q, q'] whose eigenvalue with Im p = omega is a root of the p-k or g method.

    p-k (Hassig, in the real form of Rodden): Q = Re Q + p (b/V) Im Q / k, hysteretic damping as
    g K / omega. g (Chen): Q = Q(ik) + Q'(ik) (p b/V - ik), complex. The complex modulus of a viscoelastic structure
    is taken at i omega as Q is, by either method.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    condition : FlightCondition
        Shape (...).
    omega : ndarray, shape (...)
        Frequency at which Q is taken, positive. [rad/s]
    g_method : bool
        The g method's matrix instead of the p-k method's.

    Returns
    -------
    A : ndarray, shape (..., 2n, 2n)
        Real for p-k, complex for g. [1/s and mixed]

    References
    ----------
    Hassig, J. Aircraft 8(11), 1971; Rodden, Harder, Bellinger, NASA CR-3094, 1979; Chen, AIAA J. 38(9), 2000.

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> model = AeroelasticModel(modes=one, aero=air)
    >>> frequency_matrix(model, FlightCondition(V=10.0, rho=1.2), np.array(2.0), g_method=False).round(1).tolist()[1][0]
    -4.0
    """
    n = model.modes.n
    stiffness, damping = _coefficients(model, condition, omega, g_method)
    A = np.zeros((*omega.shape, 2 * n, 2 * n), dtype=stiffness.dtype)
    A[..., np.arange(n), n + np.arange(n)] = 1.0
    inverse = np.linalg.inv(model.modes.M)
    A[..., n:, :n] = -inverse @ stiffness
    A[..., n:, n:] = -inverse @ damping
    return A


def _coefficients(
    model: AeroelasticModel, condition: FlightCondition, omega: Array, g_method: bool
) -> tuple[Array, Array]:
    """Stiffness and damping (..., n, n) of p^2 M + p D + K at the frequency where Q is taken."""
    modes, aero, n = model.modes, model.aero, model.modes.n
    k = omega * aero.b / condition.V
    V, q, w = (np.asarray(x)[..., None, None] for x in (condition.V, condition.q, omega))
    Q = aero(k, condition.mach)[..., :n]
    if g_method:
        slope = aero.slope(k, condition.mach)[..., :n]
        stiffness = modes.K * (1.0 + 1j * modes.hysteretic_g) - q * (Q - 1j * (w * aero.b / V) * slope)
        damping = modes.D - q * aero.b / V * slope
        if modes.relaxing:  # like Q, to first order off the axis
            rise = modes.relaxation_slope(1j * omega)
            stiffness, damping = stiffness + modes.relaxation(1j * omega) - 1j * w * rise, damping + rise
        return stiffness, damping
    stiffness, damping = modes.K - q * Q.real, modes.D - q / w * Q.imag + modes.hysteretic_g / w * modes.K
    if modes.relaxing:
        modulus = modes.relaxation(1j * omega)
        stiffness, damping = stiffness + modulus.real, damping + modulus.imag / w
    return stiffness, damping


def frequency_roots(model: AeroelasticModel, condition: FlightCondition, *, g_method: bool = False) -> RootSet:
    """Roots by the p-k or g method.

    The imaginary parts of the eigenvalues of p-k's `frequency_matrix`, in descending order, are
    continuous in omega; number m of them meets omega itself at a root. Each is bracketed from
    above and refined, so every speed stands alone: nothing is carried from speed to speed and no
    iteration can jump to another mode or fail to converge. The g method's roots are sought from
    p-k's. Roots slower than k = 0.001 count as aperiodic and come from the matrix near k = 0.

    Parameters
    ----------
    model : AeroelasticModel
        Any.
    condition : FlightCondition
        A row of speeds, shape (n_V,).
    g_method : bool
        Use the g method's first-order expansion of Q off the axis.

    Returns
    -------
    roots : RootSet
        2n roots at each speed, less the zeros of free modes. [1/s]

    References
    ----------
    Hassig, J. Aircraft 8(11), 1971; Chen, AIAA J. 38(9), 2000; equations.md, "One equation of motion".

    Examples
    --------
    >>> from aeroservo.datatypes import AeroInput, ModalModel, SampledAero
    >>> one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("h",))
    >>> air = SampledAero(k=[0.0], Q=[[[[0.0]]]], b=1.0, inputs=(AeroInput(name="h", kind="mode"),))
    >>> roots = frequency_roots(AeroelasticModel(modes=one, aero=air), FlightCondition(V=[10.0], rho=1.2))
    >>> round(float(np.nanmax(roots.values.imag)), 9)
    2.0
    """
    n, n_V = model.modes.n, condition.V.size
    free = displacement_free(model.modes, model.aero)
    n_roots = 3 * n - int(free.sum())  # room for aerodynamic roots beside those of the modes
    row, pair_values, pair_shapes = _oscillatory_roots(model, condition, g_method)
    real_values, real_shapes = _aperiodic_roots(model, condition, free)
    values = np.full((n_V, n_roots), np.nan, dtype=complex)
    shapes = np.full((n_V, n_roots, n), np.nan, dtype=complex)
    pairs = np.bincount(row, minlength=n_V)
    slot = 2 * (np.arange(len(row)) - np.concatenate([[0], np.cumsum(pairs)])[row])
    for offset, value, shape in ((0, pair_values, pair_shapes), (1, pair_values.conj(), pair_shapes.conj())):
        keep = slot + offset < n_roots
        values[row[keep], slot[keep] + offset] = value[keep]
        shapes[row[keep], slot[keep] + offset] = shape[keep]
    for j in range(real_values.shape[1]):
        place = 2 * pairs + j
        rows = np.flatnonzero((place < n_roots) & np.isfinite(real_values[:, j]))
        values[rows, place[rows]] = real_values[rows, j]
        shapes[rows, place[rows]] = real_shapes[rows, j]
    return RootSet(values=values, shapes=shapes)


def _oscillatory_roots(
    model: AeroelasticModel, condition: FlightCondition, g_method: bool
) -> tuple[Array, Array, Array]:
    """Row of the speed (ascending), value and shape of every root that swings: the g method starts from p-k's."""
    row, values, shapes = _p_k_roots(model, condition)
    if g_method:
        found, found_shapes, done = _newton(model, condition[row], values, True)
        done &= ~_repeated(row, np.where(done, found, values))  # two roots that would become one stay p-k's
        values, shapes = np.where(done, found, values), np.where(done[:, None], found_shapes, shapes)
    swinging = values.imag * model.aero.b > APERIODIC_K * condition.V[row]
    return row[swinging], values[swinging], normalised(shapes[swinging])


def _p_k_roots(model: AeroelasticModel, condition: FlightCondition) -> tuple[Array, Array, Array]:
    """Row, value and shape of every oscillatory root of the p-k equation.

    Root number m by bracket first, which cannot fail; then roots that the numbers hide, because another pair came
    up inside the same cell of the scan: branches matched across a cell that fall below omega in it.
    """
    scan, values = _scan(model, condition)
    over = values.imag - scan[:, None]
    row, m, left = _numbered(over)
    low, high = scan[left], scan[left + 1]
    at_low, at_high = over[row, left, m], over[row, left + 1, m]
    part = at_low / (at_low - at_high)
    start = values[row, left, m] * (1.0 - part) + values[row, left + 1, m] * part
    found, shapes, done = _newton(model, condition[row], start, False)
    done &= (found.imag >= low) & (found.imag <= high) & ~_repeated(row, found)
    again = np.flatnonzero(np.isin(row, row[~done]))  # numbers at one speed are found by one way
    if again.size:
        n, at = model.modes.n, condition[row[again]]

        def excess(omega: Array, index: Array) -> Array:
            imaginary = _descending(frequency_matrix(model, at[index], omega, g_method=False), n).imag
            return np.take_along_axis(imaginary, m[again[index], None], axis=1)[:, 0] - omega

        omega = bracketed_roots(excess, low[again], high[again], at_low[again], at_high[again])
        A = frequency_matrix(model, at, omega, g_method=False)
        found[again], shapes[again] = _nth_from_above(A, m[again])
    hidden_row, hidden_left, start = _matched(over, values, row, left)
    if not hidden_row.size:
        return row, found, shapes
    more, more_shapes, done = _newton(model, condition[hidden_row], start, False)
    done &= (more.imag >= scan[hidden_left]) & (more.imag <= scan[hidden_left + 1])
    row = np.concatenate([row, hidden_row[done]])
    found, shapes = np.concatenate([found, more[done]]), np.concatenate([shapes, more_shapes[done]])
    order = np.lexsort((np.abs(found), row))
    row, found, shapes = row[order], found[order], shapes[order]
    near = np.abs(np.diff(found)) <= 1e-8 * np.abs(found[1:])
    fresh = np.append(True, ~(near & (np.diff(row) == 0)))
    return row[fresh], found[fresh], shapes[fresh]


def _repeated(row: Array, values: Array) -> Array:
    """Roots that were found twice at one speed."""
    order = np.lexsort((np.abs(values), row))
    near = np.abs(np.diff(values[order])) <= 1e-8 * np.abs(values[order][1:])
    same = near & (np.diff(row[order]) == 0)
    repeated = np.zeros(len(row), dtype=bool)
    repeated[order[1:]] = same
    repeated[order[:-1]] |= same
    return repeated


def _scan(model: AeroelasticModel, condition: FlightCondition) -> tuple[Array, Array]:
    """Frequencies, few far below the structure's and more among them, and the n uppermost eigenvalues at each."""
    n, n_V, top = model.modes.n, condition.V.size, frequency_scale(model)
    middle = min(0.05 * slowest(model), 0.1 * top)
    slow = np.geomspace(1e-5 * top, middle, SCAN_POINTS // 3, endpoint=False)
    scan = np.concatenate([slow, np.geomspace(middle, 2.0 * top, SCAN_POINTS - slow.size)])
    rows, grid = np.repeat(np.arange(n_V), scan.size), np.tile(scan, n_V)
    A = frequency_matrix(model, condition[rows], grid, g_method=False)
    values = _descending(A, n).reshape(n_V, scan.size, n)
    while np.any(values[:, -1].imag >= scan[-1]) and scan.size < SCAN_POINTS + 20:
        scan = np.append(scan, 2.0 * scan[-1])
        A = frequency_matrix(model, condition, np.full(n_V, scan[-1]), g_method=False)
        values = np.concatenate([values, _descending(A, n)[:, None]], axis=1)
    return scan, values


def _numbered(over: Array) -> tuple[Array, Array, Array]:
    """Row, number m and cell of the last fall below omega of the m-th largest imaginary part."""
    falls = (over[:, :-1] > 0.0) & (over[:, 1:] <= 0.0)
    last = falls.shape[1] - 1 - np.argmax(falls[:, ::-1], axis=1)
    row, m = np.nonzero(falls.any(axis=1))
    return row, m, last[row, m]


def _matched(over: Array, values: Array, row: Array, left: Array) -> tuple[Array, Array, Array]:
    """Row, cell and first guess of branches that fall below omega in cells where the numbers show fewer roots."""
    nearest = np.argmin(np.abs(values[:, :-1, :, None] - values[:, 1:, None, :]), axis=3)
    right = np.take_along_axis(values[:, 1:], nearest, axis=2)
    over_right = np.take_along_axis(over[:, 1:], nearest, axis=2)
    falls = (over[:, :-1] > 0.0) & (over_right <= 0.0)
    known = np.zeros(falls.shape[:2], dtype=int)
    np.add.at(known, (row, left), 1)
    i, cell, j = np.nonzero(falls & (falls.sum(axis=2) > known)[:, :, None])
    part = over[i, cell, j] / (over[i, cell, j] - over_right[i, cell, j])
    return i, cell, values[i, cell, j] * (1.0 - part) + right[i, cell, j] * part


def _newton(
    model: AeroelasticModel, condition: FlightCondition, p: Array, g_method: bool
) -> tuple[Array, Array, Array]:
    """Newton's method on T(p, Im p) x = 0 for many roots at once: values, shapes, and which converged.

    Unknowns are x, sigma and omega; T depends on p through the polynomial and on omega through Q. The
    step is exact for p-k. For the g method the change of Q' along the axis is left out of it.
    """
    modes, aero, n = model.modes, model.aero, model.modes.n
    values, shapes = p.copy(), np.full((p.size, n), np.nan, dtype=complex)
    done, active = np.zeros(p.size, dtype=bool), np.arange(p.size)
    x = np.ones((p.size, n), dtype=complex) + 0.1j * np.arange(n)
    guide = x.copy()
    for iteration in range(NEWTON_STEPS):
        at, w = condition[active], np.maximum(p.imag, 1e-300)
        stiffness, damping = _coefficients(model, at, w, g_method)
        pp = p[:, None, None]
        T, by_p = (pp * modes.M + damping) * pp + stiffness, 2.0 * pp * modes.M + damping
        columns = [(by_p @ x[..., None])[..., 0]]
        if g_method:
            columns.append(np.zeros_like(columns[0]))
        else:
            rate = 1j * aero.slope(w * aero.b / at.V, at.mach)[..., :n]
            q, b_V, ww = at.q[:, None, None], (aero.b / at.V)[:, None, None], w[:, None, None]
            by_omega = -q * b_V * rate.real + pp * (
                q / ww**2 * aero(w * aero.b / at.V, at.mach)[..., :n].imag
                - q / ww * b_V * rate.imag
                - modes.hysteretic_g / ww**2 * modes.K
            )
            if modes.relaxing:
                turn = 1j * modes.relaxation_slope(1j * w)
                by_omega = by_omega + turn.real + pp * (turn.imag - modes.relaxation(1j * w).imag / ww) / ww
            columns.append((by_omega @ x[..., None])[..., 0])
        solution = _solve(T, np.stack(columns, axis=-1))
        a, c = np.moveaxis(np.einsum("ij,ijk->ik", guide.conj(), solution), -1, 0)
        ratio = c / a
        step = -1.0 / a  # (d sigma + i d omega) + ratio d omega = step, with guide^H x = 1
        d_omega = step.imag / (1.0 + ratio.imag)
        d_sigma = step.real - ratio.real * d_omega
        if iteration < 2:  # first let x find its direction at the guessed root
            d_sigma, d_omega = 0.0 * d_sigma, 0.0 * d_omega
            x_new = solution[..., 0]
        else:
            x_new = -(solution[..., 0] * (d_sigma + 1j * d_omega)[:, None] + solution[..., 1] * d_omega[:, None])
        guide = x_new / np.linalg.norm(x_new, axis=1)[:, None] ** 2
        x = x_new
        p = p + d_sigma + 1j * d_omega
        small = (np.hypot(d_sigma, d_omega) <= 1e-12 * np.abs(p)) & (iteration >= 2)
        broken = ~np.isfinite(p) | (p.imag <= 0.0)
        values[active[small]], shapes[active[small]], done[active[small]] = p[small], x[small], True
        keep = ~(small | broken)
        active, p, x, guide = active[keep], p[keep], x[keep], guide[keep]
        if not active.size:
            break
    return values, shapes, done


def _solve(T: Array, right: Array) -> Array:
    """Solutions of many systems; a system that is singular to rounding is met just beside it."""
    try:
        return np.linalg.solve(T, right)
    except np.linalg.LinAlgError:
        size = np.abs(T).max(axis=(1, 2))
        return np.linalg.solve(T + 1e-14 * size[:, None, None] * np.eye(T.shape[-1]), right)


def _descending(A: Array, n: int) -> Array:
    """The n eigenvalues of largest imaginary part, in descending order of it; real ones count as zero."""
    values = np.linalg.eigvals(A).astype(complex)
    values = np.take_along_axis(values, np.argsort(-values.imag, axis=-1)[..., :n], axis=-1)
    return np.asarray(values.real + 1j * np.maximum(values.imag, 0.0))


def _nth_from_above(A: Array, order: Array) -> tuple[Array, Array]:
    """Eigenvalue number `order` by descending imaginary part, and its displacement shape."""
    values, vectors = np.linalg.eig(A)
    pick = np.take_along_axis(np.argsort(-values.imag, axis=-1), order[:, None], axis=1)
    shape = np.take_along_axis(vectors, pick[:, None, :], axis=2)[..., 0]
    return np.take_along_axis(values, pick, axis=1)[:, 0], shape[:, : A.shape[-1] // 2]


def _aperiodic_roots(model: AeroelasticModel, condition: FlightCondition, free: Array) -> tuple[Array, Array]:
    """Real eigenvalues of the p-k matrix near k = 0, largest first; nan pads.

    The column of a free mode loses its displacement (it is zero at k = 0) and keeps its rate.
    """
    modes = model.modes
    n = modes.n
    elastic = replace(modes, hysteretic_g=0.0, relaxing=(), D=modes.D + modes.relaxation_slope(0.0).real)
    undamped = replace(model, modes=elastic)
    omega = np.full(condition.V.shape, APERIODIC_K) * condition.V / model.aero.b
    A = frequency_matrix(undamped, condition, omega, g_method=False)
    static = model.aero(0.0, condition.mach)[..., :n].real
    A[..., n:, :n] = -np.linalg.solve(modes.M, modes.relaxed_K - condition.q[:, None, None] * static)
    if free.any():  # at rest a free mode's rate is the incidence of a steady climb: no damping of another frequency
        rate = model.aero.slope(0.0, condition.mach)[..., :n][..., free].real
        damping = elastic.D[:, free] - (condition.q * model.aero.b / condition.V)[:, None, None] * rate
        A[:, n:, n + np.flatnonzero(free)] = -np.linalg.solve(modes.M, damping)
    keep = np.append(~free, np.ones(n, dtype=bool))
    values, vectors = np.linalg.eig(A[:, keep][:, :, keep])
    real = np.where(np.abs(values.imag) <= omega[:, None], values.real, np.nan)
    order = np.argsort(-real, axis=1)  # nan sorts last
    shapes = np.take_along_axis(vectors, order[:, None, :], axis=2)[:, int(keep[:n].sum()) :]
    return np.take_along_axis(real, order, axis=1), normalised(np.moveaxis(shapes, -1, -2))
