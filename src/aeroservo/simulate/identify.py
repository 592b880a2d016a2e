"""Frequency and damping from a record: logarithmic decrement, eigensystem realisation, growth, limit cycles."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True, kw_only=True)
class Oscillation:
    """One mode read from a record.

    Attributes
    ----------
    frequency : float
        Damped angular frequency. [rad/s]
    damping_ratio : float
        zeta = -Re(s)/|s|, positive stable. [-]
    growth : float
        Re(s). [1/s]
    share : float
        Its part of the record, by amplitude: 1 for the logarithmic decrement. [-]
    """

    frequency: float
    damping_ratio: float
    growth: float
    share: float = 1.0


@dataclass(frozen=True, kw_only=True)
class LimitCycle:
    """A steady oscillation.

    Attributes
    ----------
    amplitude : float
        Half of peak to peak. [unit of the record]
    fundamental : float
        Amplitude of the fundamental harmonic. [unit of the record]
    frequency_Hz : float
        Fundamental. [Hz]
    """

    amplitude: float
    fundamental: float
    frequency_Hz: float


def log_decrement(t: ArrayLike, y: ArrayLike) -> Oscillation:
    """Frequency and damping of a record of one mode, from its zero crossings and extremes.

    Zero crossings are interpolated; each extreme is that of the parabola through the three samples about it, and the
    logarithms of all extremes are fitted by a straight line. Valid for one mode, free, about a mean of zero.

    Parameters
    ----------
    t : array_like, shape (n,)
        Even times. [s]
    y : array_like, shape (n,)
        Record. [any]

    Returns
    -------
    oscillation : Oscillation
        Frequency [rad/s], damping ratio [-], growth [1/s].

    Raises
    ------
    ValueError
        If there are fewer than three extremes between zero crossings.

    References
    ----------
    L. Meirovitch, Fundamentals of Vibrations, 2001, section 2.3.

    Examples
    --------
    >>> t = np.linspace(0.0, 10.0, 5001)
    >>> found = log_decrement(t, np.exp(-0.1 * t) * np.cos(5.0 * t))
    >>> round(found.frequency, 4), round(found.growth, 5)
    (5.0, -0.1)
    """
    t, y = np.asarray(t, dtype=float), np.asarray(y, dtype=float)
    crossings = np.flatnonzero(np.signbit(y[1:]) != np.signbit(y[:-1]))
    if len(crossings) < 4:
        raise ValueError("the record has fewer than three half waves: no logarithmic decrement")
    at = t[crossings] - y[crossings] * (t[crossings + 1] - t[crossings]) / (y[crossings + 1] - y[crossings])
    peaks, when = [], []
    for left, right in pairwise(crossings.tolist()):
        i = left + 1 + int(np.argmax(np.abs(y[left + 1 : right + 1])))
        if 0 < i < len(y) - 1:
            a, b, c = np.abs(y[i - 1]), np.abs(y[i]), np.abs(y[i + 1])
            bend = a - 2.0 * b + c
            shift = 0.5 * (a - c) / bend if bend < 0.0 and abs(a - c) < 2.0 * abs(bend) else 0.0
            peaks.append(b - 0.25 * (a - c) * shift)
            when.append(t[i] + shift * (t[1] - t[0]))
    if len(peaks) < 3 or min(peaks) <= 0.0:
        raise ValueError("the record has fewer than three extremes: no logarithmic decrement")
    growth = float(np.polyfit(when, np.log(peaks), 1)[0])
    frequency = float(np.pi / np.polyfit(np.arange(len(at)), at, 1)[0])
    return Oscillation(frequency=frequency, growth=growth, damping_ratio=-growth / float(np.hypot(growth, frequency)))


def era(y: ArrayLike, dt: float, *, order: int, rows: int = 200) -> tuple[Oscillation, ...]:
    """Modes of a free decay by the eigensystem realisation algorithm of python-control.

    Parameters
    ----------
    y : array_like, shape (n,)
        Free decay on an even grid, from its first sample. [any]
    dt : float
        Step; take about 10 to 40 samples a period. [s]
    order : int
        Number of states: two for each mode.
    rows : int
        Rows of the Hankel matrix at most.

    Returns
    -------
    modes : tuple of Oscillation
        Oscillatory modes, largest share first. [rad/s, -, 1/s]

    Raises
    ------
    ValueError
        If the record is too short for the order.

    References
    ----------
    J.-N. Juang and R. S. Pappa, J. Guid. Control Dyn. 8(5), 1985; python-control user guide, `eigensys_realization`.

    Examples
    --------
    >>> t = 0.05 * np.arange(400)
    >>> [round(mode.frequency, 6) for mode in era(np.exp(-0.1 * t) * np.cos(5.0 * t), 0.05, order=2)]
    [5.0]
    """
    import control

    y = np.asarray(y, dtype=float)
    m = min(rows, (len(y) - 1) // 2)
    if m < order:
        raise ValueError(f"a record of {len(y)} samples is too short for ERA of order {order}")
    scale = np.abs(y).max()
    if not scale > 0.0:
        raise ValueError("the record is zero throughout: nothing to identify")
    system, _ = control.eigensys_realization((y / scale)[: 2 * m + 1], r=order, m=m, n=m, dt=dt)
    z, vectors = np.linalg.eig(system.A)
    s = np.log(z.astype(complex)) / dt
    weight = np.abs((system.C @ vectors)[0] * np.linalg.solve(vectors, system.B.astype(complex))[:, 0])
    keep = np.flatnonzero(s.imag > 1e-9 * np.abs(s).max())
    modes = [
        Oscillation(
            frequency=float(s[i].imag),
            growth=float(s[i].real),
            damping_ratio=float(-s[i].real / abs(s[i])),
            share=float(2.0 * weight[i] / max(weight.sum(), 1e-300)),
        )
        for i in keep
    ]
    return tuple(sorted(modes, key=lambda mode: -mode.share))


def envelope_growth(t: ArrayLike, y: ArrayLike) -> float | None:
    """Growth of the envelope of a free response over the second half of a record.

    The extremes between sign changes are fitted by e^(g t), over as much more of the record as it takes to have three
    of them; a record that does not change its sign in its second half is aperiodic and |y| itself is fitted.

    Parameters
    ----------
    t : array_like, shape (n,)
        Times. [s]
    y : array_like, shape (n,)
        Free response about its rest. [any]

    Returns
    -------
    growth : float or None
        g; None where the record is too short, or zero. [1/s]

    References
    ----------
    Project convention: contract.md, `simulate`, "growth_1_s".

    Examples
    --------
    >>> t = np.linspace(0.0, 20.0, 4001)
    >>> round(envelope_growth(t, np.exp(0.2 * t) * np.sin(6.0 * t)), 3)
    0.2
    """
    t, y = np.asarray(t, dtype=float), np.asarray(y, dtype=float)
    half = len(t) // 2
    if len(t) < 16 or not np.abs(y).max() > 0.0:
        return None
    for part in (slice(half, None), slice(len(t) // 5, None), slice(None)):
        try:
            return log_decrement(t[part], y[part]).growth
        except ValueError:
            continue
    t, y = t[half:], y[half:]
    if np.any(np.signbit(y) != np.signbit(y[0])):
        return None
    size = np.abs(y)
    if size.min() <= 1e-12 * size.max():
        return None
    return float(np.polyfit(t, np.log(size), 1)[0])


def pencil_growth(t: ArrayLike, y: ArrayLike, *, residual: float = 1e-2) -> float | None:
    """Growth of the exponential that dominates the end of a free response, by the matrix pencil.

    Modes that beat do not mislead it as they do an envelope. The record is thinned to at most 400 samples (what is
    folded keeps its growth) and taken as a sum of up to 16 exponentials.

    Parameters
    ----------
    t : array_like, shape (n,)
        Even times. [s]
    y : array_like, shape (n,)
        Free response about its rest. [any]
    residual : float
        Largest part of the record's RMS that the exponentials may leave. [-]

    Returns
    -------
    growth : float or None
        Re(s); None where the record is no sum of few exponentials, or too short. [1/s]

    References
    ----------
    Y. Hua and T. K. Sarkar, IEEE Trans. Acoust. Speech Signal Process. 38(5), 1990, section II.

    Examples
    --------
    >>> t = np.linspace(0.0, 20.0, 4001)
    >>> round(pencil_growth(t, np.exp(-0.05 * t) * (np.sin(6.0 * t) + np.sin(6.3 * t))), 6)
    -0.05
    """
    times, record = np.asarray(t, dtype=float), np.asarray(y, dtype=float)
    thin = max(1, len(times) // 400)
    times, record = times[::thin], record[::thin]
    n, size = len(record), float(np.abs(record).max(initial=0.0))
    if n < 40 or not 0.0 < size < np.inf:
        return None
    record = record / size
    hankel = np.lib.stride_tricks.sliding_window_view(record, n // 3 + 1)
    _, sigma, Vt = np.linalg.svd(hankel, full_matrices=False)
    order = min(16, max(1, int(np.sum(sigma > 1e-7 * sigma[0]))))
    V = Vt[:order]
    z = np.linalg.eigvals(V[:, 1:] @ np.linalg.pinv(V[:, :-1])).astype(complex)
    root = np.log(z[np.abs(z) > 1e-12])
    powers = np.exp(root * np.arange(n)[:, None] - np.maximum(root.real, 0.0) * (n - 1))  # at most 1 in size
    weight = np.linalg.lstsq(powers, record.astype(complex), rcond=None)[0]
    left = np.sqrt(np.mean(np.abs(powers @ weight - record) ** 2))
    if not left <= residual * np.sqrt(np.mean(record**2)):
        return None
    at_end = np.abs(weight * powers[-1])
    return float(root.real[np.argmax(at_end)] / (times[1] - times[0]))


def limit_cycle(t: ArrayLike, y: ArrayLike, *, drift: float = 0.01) -> LimitCycle | None:
    """The steady oscillation at the end of a record, if there is one.

    Over the last quarter, at least six periods: the largest positive extremes of its first and second half must agree
    to `drift`, the negative ones too.

    Parameters
    ----------
    t : array_like, shape (n,)
        Even times. [s]
    y : array_like, shape (n,)
        Record. [any]
    drift : float
        Largest relative difference. [-]

    Returns
    -------
    cycle : LimitCycle or None
        Amplitude of the record and of its fundamental harmonic, frequency. [unit of y, Hz]

    References
    ----------
    Project convention: contract.md, `simulate`, "limit_cycle".

    Examples
    --------
    >>> t = np.linspace(0.0, 40.0, 8001)
    >>> round(limit_cycle(t, 0.3 * np.sin(6.0 * t)).amplitude, 3)
    0.3
    """
    t, y = np.asarray(t, dtype=float), np.asarray(y, dtype=float)
    t, y = t[3 * len(t) // 4 :], y[3 * len(y) // 4 :]
    if len(t) < 16:
        return None
    middle = y - 0.5 * (y.max() + y.min())
    rising = np.flatnonzero((middle[:-1] < 0.0) & (middle[1:] >= 0.0))
    if len(rising) < 7:
        return None
    at = t[rising] - middle[rising] * (t[rising + 1] - t[rising]) / (middle[rising + 1] - middle[rising])
    h = len(y) // 2
    swing = y.max() - y.min()
    if max(abs(y[:h].max() - y[h:].max()), abs(y[:h].min() - y[h:].min())) > 0.5 * drift * swing:
        return None
    period = float((at[-1] - at[0]) / (len(at) - 1))
    inside = (t >= at[0]) & (t <= at[-1])
    turn = np.exp(-2j * np.pi * t[inside] / period)
    fundamental = 2.0 * abs(np.trapezoid(middle[inside] * turn, t[inside])) / (t[inside][-1] - t[inside][0])
    return LimitCycle(amplitude=float(0.5 * swing), fundamental=float(fundamental), frequency_Hz=1.0 / period)
