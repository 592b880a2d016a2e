"""Classical margins of every loop, cut one at a time with the others closed: gain, phase, delay, sensitivity peaks.

A margin of a loop that is unstable when closed means nothing: it is None, and `stable` says so. Crossovers are refined
between frequencies seeded by the roots of the loop; delays are taken exactly.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from aeroservo.aeroelastic.rootfinding import bracketed_roots, largest_between
from aeroservo.control.controller import Controller
from aeroservo.control.disk_margins import Cut, DiskMargin
from aeroservo.control.loop import Loop, cut_loop, frequencies, is_stable, peak
from aeroservo.datatypes import Array, LinearSystem

SMALL = 1e-7
"""Loop gains below this part of one are none: a gain margin beyond its inverse is infinite."""

Response = Callable[[Array], Array]

LONGEST_DELAY = 1.0
"""Delay up to which the largest one that keeps a loop stable is sought. [s]"""


@dataclass(frozen=True, kw_only=True)
class LoopMargin:
    """Margins of one loop with the others closed.

    Attributes
    ----------
    channel : str
        Where it is cut.
    at : {"input", "output"}
        Of the plant.
    stable : bool
        Whether the closed loop is stable; if not, there are no margins.
    gain_crossovers : tuple of (float, float)
        Frequency at which |L| = 1, and the angle of L from -1 there, -pi to pi. [rad/s, rad]
    phase_crossovers : tuple of (float, float)
        Frequency at which L is real and negative, and the gain factor that would make it -1. [rad/s, -]
    sensitivity, complementary : float
        Largest |S| and |T|, inf where unstable. [-]
    least_return : float
        Smallest |1 + L|, 0 where unstable. [-]
    disk : DiskMargin
        Of this loop alone.
    """

    channel: str
    at: Cut
    stable: bool
    gain_crossovers: tuple[tuple[float, float], ...]
    phase_crossovers: tuple[tuple[float, float], ...]
    sensitivity: float
    complementary: float
    least_return: float
    disk: DiskMargin

    @property
    def gain_up(self) -> float | None:
        """Factor by which the gain may rise, inf where it may rise at will, None where unstable. [-]"""
        return min((g for _, g in self.phase_crossovers if g > 1.0), default=math.inf) if self.stable else None

    @property
    def gain_down(self) -> float | None:
        """Factor to which the gain may fall, 0 where it may vanish, None where unstable. [-]"""
        return max((g for _, g in self.phase_crossovers if g < 1.0), default=0.0) if self.stable else None

    @property
    def phase(self) -> float | None:
        """Smallest change of phase that ends stability; inf without crossover, None where unstable. [rad]"""
        return min((abs(p) for _, p in self.gain_crossovers), default=math.inf) if self.stable else None

    @property
    def delay_s(self) -> float | None:
        """Largest additional delay; inf without crossover, None where unstable. [s]"""
        if not self.stable:
            return None
        return min((p % (2.0 * math.pi) / w for w, p in self.gain_crossovers), default=math.inf)


def loop_margins(
    plant: LinearSystem,
    controller: Controller | LinearSystem,
    *,
    at: Cut = "input",
    pressure: float | None = None,
    delay_s: float = 0.0,
) -> tuple[LoopMargin, ...]:
    """Margins of every loop, cut one at a time at the plant's inputs or outputs, the others closed.

    The delay margin is that of an additional delay e^(-s tau) of the loop; for a sampled loop that is exact for whole
    samples (`largest_delay` is exact for any).

    Parameters
    ----------
    plant : LinearSystem
        One condition. A continuous plant meets a sampled controller at its rate. [SI]
    controller : Controller or LinearSystem
        Closes the loop; its outputs are added to the plant's inputs.
    at : {"input", "output", "both"}
        Cut the inputs one by one, the outputs, or first these and then those.
    pressure : float, optional
        Dynamic pressure, for a schedule. [Pa]
    delay_s : float
        Delay on top of all others. [s]

    Returns
    -------
    margins : tuple of LoopMargin
        One for each channel. [SI]

    Raises
    ------
    ValueError
        If the plant is a batch, a channel is missing, or the rates differ.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed. 2005, section 2.4.3; P. Seiler,
    A. Packard and P. Gahinet, IEEE Control Systems Magazine 40(5), 2020, Fig. 3 (loop at a time).

    Examples
    --------
    >>> names = {"states": ("a", "b", "c"), "inputs": ("u",), "outputs": ("y",)}
    >>> plant = LinearSystem(A=[[0, 1, 0], [0, 0, 1], [-10, -10, -10]], B=[[0], [0], [1]], C=[[25, 0, 0]], D=[[0]],
    ...                      **names)
    >>> gain = Controller(A=[], B=[], C=[], D=[[-1.0]], inputs=("y",), outputs=("u",))
    >>> margin = loop_margins(plant, gain)[0]
    >>> round(margin.gain_up, 3), round(math.degrees(margin.phase), 1)
    (3.6, 29.1)
    """
    loop = cut_loop(plant, controller, pressure=pressure, delay_s=delay_s)
    stable = is_stable(loop)
    cuts: tuple[Cut, ...] = ("input", "output") if at == "both" else (at,)
    return tuple(_margin(loop, cut, i, stable) for cut in cuts for i in range(len(loop.channels(cut))))


def largest_delay(plant: LinearSystem, controller: Controller, *, pressure: float | None = None) -> float | None:
    """Largest delay on top of all others that keeps a sampled loop stable, of all its commands at once.

    The continuous plant is discretised anew with each delay, fractions of a sample included, and judged by its
    eigenvalues.

    Parameters
    ----------
    plant : LinearSystem
        Continuous, one condition. [SI]
    controller : Controller
        Sampled.
    pressure : float, optional
        Dynamic pressure, for a schedule. [Pa]

    Returns
    -------
    delay : float or None
        To 1e-9 s; inf where `LONGEST_DELAY` does no harm, None where the loop is unstable without it. [s]

    Raises
    ------
    ValueError
        If plant or controller is of the wrong kind.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 1997, section 3.2 (systems with time delay).

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> integrator = LinearSystem(A=[[0.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> gain = Controller(A=[], B=[], C=[], D=[[-1.0]], inputs=("y",), outputs=("u",), dt_s=1e-2)
    >>> round(largest_delay(integrator, gain), 3)
    inf
    """
    if plant.dt is not None or controller.dt_s is None:
        raise ValueError("largest_delay wants a continuous plant and a sampled controller; see loop_margins for others")

    def stable(delay: float) -> bool:
        return is_stable(cut_loop(plant, controller, pressure=pressure, delay_s=delay))

    if not stable(0.0):
        return None
    low, high, step = 0.0, controller.dt_s / 8.0, controller.dt_s / 8.0
    while stable(high):
        step = min(1.2 * step, 0.5 * controller.dt_s)
        low, high = high, high + step
        if low > min(LONGEST_DELAY, 150.0 * controller.dt_s):
            return math.inf
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


def _margin(loop: Loop, cut: Cut, i: int, stable: bool) -> LoopMargin:
    """Margins of channel i."""
    name = loop.channels(cut)[i]
    if not stable:
        disk = DiskMargin(alpha=0.0, frequency=None, at=cut, channels=(name,), stable=False)
        return LoopMargin(
            channel=name, at=cut, stable=False, gain_crossovers=(), phase_crossovers=(), sensitivity=math.inf,
            complementary=math.inf, least_return=0.0, disk=disk,
        )  # fmt: skip

    def single(omega: Array) -> Array:
        """Loop transfer of this channel, the others closed: 1 + L = 1/S_ii."""
        L = loop.transfer(1j * omega, cut)
        if L.shape[-1] == 1:
            return np.asarray(L[:, 0, 0])
        S = np.linalg.inv(np.eye(L.shape[-1]) + L)[:, i, i]
        return np.asarray((1.0 - S) / np.where(S == 0.0, 1e-300, S))

    omega = frequencies(loop)
    sensitivity, _ = peak(lambda w: 1.0 / np.abs(1.0 + single(w)), omega)
    complementary, _ = peak(lambda w: np.abs((lambda L: L / (1.0 + L))(single(w))), omega)
    largest, where = peak(lambda w: 0.5 * np.abs((lambda L: (1.0 - L) / (1.0 + L))(single(w))), omega)
    return LoopMargin(
        channel=name,
        at=cut,
        stable=True,
        gain_crossovers=_gain_crossovers(single, omega),
        phase_crossovers=_phase_crossovers(loop, single, omega),
        sensitivity=sensitivity,
        complementary=complementary,
        least_return=1.0 / sensitivity,
        disk=DiskMargin(alpha=1.0 / largest, frequency=where, at=cut, channels=(name,), stable=True),
    )


def _gain_crossovers(single: Response, omega: Array) -> tuple[tuple[float, float], ...]:
    """Frequencies at which |L| = 1 and the angle of L from -1."""

    def height(w: Array, _: Array | None = None) -> Array:
        h = np.log(np.abs(single(w)) + 1e-300)
        return np.where(h == 0.0, 1e-16, h)

    h = height(omega)
    for sign in (1.0, -1.0):  # tops below one and bottoms above that cross between two frequencies
        g = sign * h
        i = np.flatnonzero((g[1:-1] < 0.0) & (g[1:-1] > -1.0) & (g[1:-1] >= g[:-2]) & (g[1:-1] >= g[2:])) + 1
        if i.size:

            def signed(w: Array, _: Array, sign: float = sign) -> Array:
                return sign * height(w)

            x, top = largest_between(signed, omega[i - 1], omega[i + 1])
            x = np.setdiff1d(x[top > 0.0], omega)
            place = np.searchsorted(omega, x)
            omega, h = np.insert(omega, place, x), np.insert(h, place, height(x) if x.size else x)
    i = np.flatnonzero(h[:-1] * h[1:] < 0.0)
    if not i.size:
        return ()
    w = bracketed_roots(height, omega[i], omega[i + 1], h[i], h[i + 1])
    return tuple(zip(w.tolist(), np.angle(-single(w)).tolist()))


def _phase_crossovers(loop: Loop, single: Response, omega: Array) -> tuple[tuple[float, float], ...]:
    """Frequencies at which L is real and negative, and -1/L there; the ends of the axis included."""

    def height(w: Array, _: Array) -> Array:
        y = np.asarray(single(w).imag)
        return np.where(y == 0.0, 1e-300, y)

    L, y = single(omega), height(omega, omega)
    i = np.flatnonzero(((y[:-1] > 0.0) != (y[1:] > 0.0)) & (np.minimum(L.real[:-1], L.real[1:]) < 0.0))
    found = []
    if i.size:
        w = bracketed_roots(height, omega[i], omega[i + 1], y[i], y[i + 1])
        value = single(w)
        real = (np.abs(value.imag) < 1e-6 * np.abs(value)) & (value.real < -SMALL)
        found = list(zip(w[real].tolist(), (-1.0 / value.real[real]).tolist()))
    ends = [] if loop.dt is None else [loop.nyquist]
    poles = np.concatenate([np.linalg.eigvals(x) for x in (loop.plant.A, loop.controller[0])]).astype(complex)
    poles = poles if loop.dt is None else (poles - 1.0) / loop.dt
    if poles.size == 0 or np.abs(poles).min() > 1e-9 * np.abs(poles).max():
        ends.append(0.0)  # a real root may cross there: the loop at rest
    for end in ends:
        at_end = float(single(np.array([end]))[0].real)
        if -1.0 / SMALL < at_end < -SMALL:
            found.append((end, -1.0 / at_end))
    return tuple(sorted(found))
