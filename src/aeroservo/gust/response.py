"""RMS response to continuous turbulence: exactly by Lyapunov's equation, and by frequency response.

The plant is a linear system whose gust input is the velocity w_g [m/s]; the turbulence is a shaping filter driven by
unit white noise. In series they are one system driven by white noise, whose covariance solves Lyapunov's equation:
no frequency grid, no truncation. The frequency integral is the certification codes' own definition and takes any
spectrum and any frequency response; it is a second route to the same number.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aeroservo.gust.sampling import stationary_covariance

__all__ = ["frequency_grid", "frequency_response", "rms_from_frequency_response", "rms_response", "series"]

Array = NDArray[Any]
Matrices = tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike]
_CHUNK = 4096  # frequencies solved at once


def series(plant: Matrices, shaping: Matrices) -> tuple[Array, Array, Array, Array]:
    """Plant behind a shaping filter: white noise in, plant outputs out.

    Parameters
    ----------
    plant : tuple of array_like, shapes (..., n, n), (..., n, m), (..., n_y, n), (..., n_y, m)
        A, B, C, D from the m gust velocities to the outputs.
    shaping : tuple of array_like, shapes (..., k, k), (..., k, m_e), (..., m, k), (..., m, m_e)
        A, B, C, D from the noises to the same gust velocities.

    Returns
    -------
    A, B, C, D : ndarray, shapes (..., n + k, n + k), (..., n + k, m_e), (..., n_y, n + k), (..., n_y, m_e)
        The two in series; states of the plant first. [SI]

    Raises
    ------
    ValueError
        If the gust channels differ in number.

    References
    ----------
    T. Kailath, Linear Systems, 1980, chapter 2, on systems in cascade.

    Examples
    --------
    >>> one = ([[-1.0]], [[1.0]], [[1.0]], [[0.0]])
    >>> series(one, one)[0]
    array([[-1.,  1.],
           [ 0., -1.]])
    """
    A, B, C, D = (np.asarray(x, dtype=float) for x in plant)
    a, b, c, d = (np.asarray(x, dtype=float) for x in shaping)
    if B.shape[-1] != c.shape[-2]:
        raise ValueError(f"the plant has {B.shape[-1]} gust inputs, the filter {c.shape[-2]} outputs: they must agree")
    batch = np.broadcast_shapes(A.shape[:-2], a.shape[:-2])
    n, k = A.shape[-1], a.shape[-1]
    both = np.zeros((*batch, n + k, n + k))
    both[..., :n, :n], both[..., :n, n:], both[..., n:, n:] = A, B @ c, a
    drive = np.zeros((*batch, n + k, b.shape[-1]))
    drive[..., :n, :], drive[..., n:, :] = B @ d, b
    out = np.zeros((*batch, C.shape[-2], n + k))
    out[..., :n], out[..., n:] = C, D @ c
    return both, drive, out, np.broadcast_to(D @ d, (*batch, C.shape[-2], b.shape[-1])).copy()


def rms_response(plant: Matrices, shaping: Matrices, *, delays: ArrayLike | None = None) -> Array:
    """RMS of every output in continuous turbulence, exactly.

    Parameters
    ----------
    plant : tuple of array_like
        A, B, C, D of a stable plant from gust velocities [m/s] to outputs, as in `series`.
    shaping : tuple of array_like
        A, B, C, D of the shaping filter for unit white noise; with unit intensity the result is A of CS-25.341(b).
    delays : array_like, shape (m,), optional
        How much later than its own time each gust input meets the filter's output: gust zones aft of one another,
        x_offset/V. One system only, no batch. [s]

    Returns
    -------
    sigma : ndarray, shape (..., n_y)
        RMS of each output. [unit of the output]

    Raises
    ------
    ValueError
        If the series is unstable, an output carries white noise itself (infinite RMS), or delays are given to a batch.

    References
    ----------
    CS-25.341(b)(2) (what A is); Lyapunov's equation; F. M. Hoblit, Gust Loads on Aircraft, 1988.

    Examples
    --------
    >>> gain = ([[-1.0]], [[0.0]], [[0.0]], [[3.0]])
    >>> unit = ([[-2.0]], [[2.0]], [[1.0]], [[0.0]])
    >>> rms_response(gain, unit).round(12)
    array([3.])
    """
    if delays is not None and np.ptp(np.asarray(delays, dtype=float)):
        return _rms_delayed(plant, shaping, np.asarray(delays, dtype=float))
    A, B, C, D = series(plant, shaping)
    if np.any(D != 0.0):
        raise ValueError("an output carries the white noise itself: its RMS is infinite (filter with feed-through D)")
    P = stationary_covariance(A, B)
    variance = np.einsum("...ij,...jk,...ik->...i", C, P, C)
    return np.sqrt(np.maximum(variance, 0.0))


def _rms_delayed(plant: Matrices, shaping: Matrices, delays: Array) -> Array:
    """RMS where the inputs come late: a plant for each input, all behind one filter, and their covariance in time.

    The output is the sum over inputs of C_z x(t - delay_z); Cov(x(t + tau), x(t)) = e^(A tau) P for tau >= 0.
    """
    from scipy.linalg import expm

    A, B, C, D = (np.asarray(x, dtype=float) for x in plant)
    a, b, c, d = (np.asarray(x, dtype=float) for x in shaping)
    if A.ndim != 2 or a.ndim != 2:
        raise ValueError("delays need one system, got a batch")
    n, m, k = A.shape[0], B.shape[1], a.shape[0]
    if delays.shape != (m,) or c.shape[0] != m:
        raise ValueError(f"delays and outputs of the filter must be {m}, as the gust inputs, got {delays.shape}")
    if np.any(d != 0.0):
        raise ValueError("an output carries the white noise itself: its RMS is infinite (filter with feed-through D)")
    size = m * n + k
    both, rows = np.zeros((size, size)), np.zeros((m, C.shape[0], size))
    for z in range(m):
        here = slice(z * n, (z + 1) * n)
        both[here, here], both[here, m * n :] = A, np.outer(B[:, z], c[z])
        rows[z][:, here], rows[z][:, m * n :] = C, np.outer(D[:, z], c[z])
    both[m * n :, m * n :] = a
    P = stationary_covariance(both, np.vstack([np.zeros((m * n, b.shape[1])), b]))
    variance = np.zeros(C.shape[0])
    for z in range(m):
        for y in range(m):
            later = delays[y] - delays[z]  # x_z is seen at t - delay_z, that much after x_y
            between = expm(both * later) @ P if later >= 0.0 else P @ expm(-both * later).T
            variance += np.einsum("ij,jk,ik->i", rows[z], between, rows[y])
    return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


def frequency_response(plant: Matrices, omega: ArrayLike) -> Array:
    """Frequency response of a linear system.

    Parameters
    ----------
    plant : tuple of array_like, shapes (n, n), (n, m), (n_y, n), (n_y, m)
        A, B, C, D.
    omega : array_like, shape (n_w,)
        Angular frequency. [rad/s]

    Returns
    -------
    H : complex ndarray, shape (n_w, n_y, m)
        C (i omega - A)^-1 B + D. [outputs per unit of inputs]

    References
    ----------
    T. Kailath, Linear Systems, 1980, chapter 2; time factor e^(+i omega t); A. J. Laub, IEEE Trans. Autom. Control
    26(2), 1981, for one reduction of A that serves all frequencies (here to Schur's triangle).

    Examples
    --------
    >>> frequency_response(([[-1.0]], [[1.0]], [[1.0]], [[0.0]]), [1.0])[0, 0, 0]
    np.complex128(0.5-0.5j)
    """
    from scipy.linalg import schur

    A, B, C, D = (np.asarray(x, dtype=float) for x in plant)
    omega = np.asarray(omega, dtype=float)
    H = np.empty((omega.size, *D.shape), dtype=complex)
    T, Q = schur(A, output="complex") if A.size else (np.zeros((0, 0), complex), np.zeros((0, 0), complex))
    right, left = Q.conj().T @ B, C @ Q
    for start in range(0, omega.size, _CHUNK):
        s = 1j * omega[start : start + _CHUNK, None]
        x = np.empty((A.shape[0], s.size, B.shape[1]), dtype=complex)
        for i in range(A.shape[0] - 1, -1, -1):  # (s - T) x = right, from the last row up
            x[i] = (right[i] + np.tensordot(T[i, i + 1 :], x[i + 1 :], axes=1)) / (s - T[i, i])
        H[start : start + _CHUNK] = np.einsum("yn,nwm->wym", left, x, optimize=True) + D
    return H


def frequency_grid(A: ArrayLike, low: float, high: float, *, per_decade: int = 200, per_peak: int = 800) -> Array:
    """Frequencies that resolve every resonance of a system, however little damped.

    Parameters
    ----------
    A : array_like, shape (n, n)
        System matrix. [1/s]
    low, high : float
        Range, positive and ascending. [rad/s]
    per_decade : int
        Points in each decade, equal ratios.
    per_peak : int
        Points around each resonance, spaced as omega_0 + |Re(lambda)| sinh(x).

    Returns
    -------
    omega : ndarray, shape (n_w,)
        Ascending, from low to high. [rad/s]

    Raises
    ------
    ValueError
        If the range is not positive and ascending.

    References
    ----------
    Project convention: the spacing follows the half-width |Re(lambda)| of a resonance.

    Examples
    --------
    >>> grid = frequency_grid([[0.0, 1.0], [-1.0, -0.002]], 0.1, 10.0)
    >>> bool(np.diff(grid).min() < 1e-4)
    True
    """
    if not 0.0 < low < high:
        raise ValueError(f"range must be positive and ascending [rad/s], got {low:g} to {high:g}")
    n = int(np.ceil(per_decade * np.log10(high / low))) + 1
    grids = [np.geomspace(low, high, n)]
    for root in np.linalg.eigvals(np.asarray(A, dtype=float)):
        width = max(abs(root.real), 1e-12 * abs(root))
        if root.imag > 0.0 and width > 0.0:
            reach = np.arcsinh(max(root.imag, high) / width)
            grids.append(root.imag + width * np.sinh(np.linspace(-reach, reach, 2 * per_peak + 1)))
    omega = np.unique(np.concatenate(grids))
    inside = omega[(omega > low) & (omega < high)]
    return np.concatenate([[low], inside, [high]])


def rms_from_frequency_response(H: ArrayLike, psd: Callable[[Array], Array] | ArrayLike, omega: ArrayLike) -> Array:
    """RMS of outputs in turbulence from a frequency response: the codes' own definition.

    Parameters
    ----------
    H : array_like, shape (n_w, ...)
        Response to a harmonic gust velocity, one column per output. [unit of the output/(m/s)]
    psd : callable or array_like, shape (n_w,)
        One-sided spectrum of the gust at omega. [(m/s)^2 s/rad]
    omega : array_like, shape (n_w,)
        Ascending; the range below the first is taken at its value there, the range above the last is left out.
        [rad/s]

    Returns
    -------
    sigma : ndarray, shape (...)
        sqrt(integral |H|^2 Phi d(omega)), trapezoids. [unit of the output]

    Raises
    ------
    ValueError
        If omega does not ascend from a value that is not negative, or the shapes disagree.

    References
    ----------
    CS-25.341(b)(2), 14 CFR 25.341(b)(2): A = sqrt(integral_0^inf |H(Omega)|^2 Phi(Omega) dOmega).

    Examples
    --------
    >>> omega = np.linspace(0.0, 4.0, 401)
    >>> round(float(rms_from_frequency_response(np.ones(401), np.full(401, 0.25), omega)), 12)
    1.0
    """
    omega, H = np.asarray(omega, dtype=float), np.asarray(H)
    if omega.ndim != 1 or omega.size < 2 or np.any(np.diff(omega) <= 0.0) or omega[0] < 0.0:
        raise ValueError("omega must ascend and not be negative [rad/s]")
    phi = np.asarray(psd(omega) if callable(psd) else psd, dtype=float)
    if H.shape[:1] != omega.shape or phi.shape != omega.shape:
        raise ValueError(f"H and psd must have {omega.size} frequencies first, got {H.shape} and {phi.shape}")
    density = np.abs(H) ** 2 * phi.reshape(-1, *(1,) * (H.ndim - 1))
    return np.sqrt(np.trapezoid(density, omega, axis=0) + density[0] * omega[0])
