"""Disk margins: how much gain and phase may change at once, in every loop at once, before stability is lost.

A stable loop stays stable for every perturbation f of each channel inside the disk f = (1 + delta/2)/(1 - delta/2),
|delta| < alpha (balanced, skew 0). For several channels perturbed independently the answer is a structured singular
value; here its upper bound by diagonal scaling is used (exact for up to three channels), so alpha is never too large.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from aeroservo.control.closed_loop import loop_plant
from aeroservo.control.controller import Controller
from aeroservo.control.loop import Loop, cut_loop, frequencies, is_stable, peak
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, LinearSystem

Cut = Literal["input", "output", "both"]

SCALINGS = 25
"""Steps of the descent that improves the diagonal scaling."""


@dataclass(frozen=True, kw_only=True)
class DiskMargin:
    """A balanced disk margin (skew 0).

    Attributes
    ----------
    alpha : float
        Size of the disk; 0 where the closed loop is unstable, 2 at most. [-]
    frequency : float or None
        Where it is smallest; None where the closed loop is unstable. [rad/s]
    at : {"input", "output", "both"}
        Where the loop is perturbed: the plant's inputs, its outputs, or both at once.
    channels : tuple of str
        The channels that are perturbed, all independently and at once.
    stable : bool
        Whether the closed loop is stable at all.
    """

    alpha: float
    frequency: float | None
    at: Cut
    channels: tuple[str, ...]
    stable: bool

    @property
    def gain(self) -> tuple[float, float]:
        """Range of gain in every channel, (2 - alpha)/(2 + alpha) to its inverse. [-]"""
        low = (2.0 - self.alpha) / (2.0 + self.alpha)
        return low, (math.inf if low <= 0.0 else 1.0 / low)

    @property
    def phase(self) -> float:
        """Change of phase in every channel, either way: 2 atan(alpha/2). [rad]"""
        return 2.0 * math.atan(0.5 * self.alpha)


@dataclass(frozen=True, kw_only=True, eq=False)
class MarginCurve:
    """Disk margins of one model over flight conditions and total delays.

    Attributes
    ----------
    V : ndarray, shape (n_V,)
        True airspeeds. [m/s]
    altitude : ndarray, shape (n_V,)
        Geopotential altitudes. [m]
    delays : ndarray, shape (n_delay,)
        Total delays: computing delay, dead time of the actuator and age of the sample together. [s]
    alpha : ndarray, shape (n_V, n_delay)
        Balanced disk margin; 0 is unstable, nan where the dead times alone are longer. [-]
    frequency : ndarray, shape (n_V, n_delay)
        Where each is smallest, nan where unstable. [rad/s]
    """

    V: Array
    altitude: Array
    delays: Array
    alpha: Array
    frequency: Array


def disk_margin(
    plant: LinearSystem,
    controller: Controller | LinearSystem,
    *,
    at: Cut = "input",
    pressure: float | None = None,
    delay_s: float = 0.0,
) -> DiskMargin:
    """Balanced disk margin of a loop: 1/max mu((S - T)/2).

    Parameters
    ----------
    plant : LinearSystem
        One condition. A continuous plant meets a sampled controller at its rate; delays are taken exactly. [SI]
    controller : Controller or LinearSystem
        Closes the loop; its outputs are added to the plant's inputs.
    at : {"input", "output", "both"}
        What is perturbed: all plant inputs, all outputs, or inputs and outputs at once.
    pressure : float, optional
        Dynamic pressure, for a schedule. [Pa]
    delay_s : float
        Delay on top of all others. [s]

    Returns
    -------
    margin : DiskMargin
        0 for a loop that is unstable. [-]

    Raises
    ------
    ValueError
        If the plant is a batch, a channel is missing, or the rates differ.

    References
    ----------
    P. Seiler, A. Packard and P. Gahinet, "An introduction to disk margins", IEEE Control Systems Magazine 40(5), 2020,
    78-95, theorem 1 and Eq. 27; A. Packard and J. Doyle, Automatica 29(1), 1993 (mu and its upper bound).

    Examples
    --------
    The loop 25/(s^3 + 10 s^2 + 10 s + 10) of Seiler, Packard and Gahinet: alpha = 0.46, gains 0.63 to 1.59.

    >>> names = {"states": ("a", "b", "c"), "inputs": ("u",), "outputs": ("y",)}
    >>> plant = LinearSystem(A=[[0, 1, 0], [0, 0, 1], [-10, -10, -10]], B=[[0], [0], [1]], C=[[25, 0, 0]], D=[[0]],
    ...                      **names)
    >>> gain = Controller(A=[], B=[], C=[], D=[[-1.0]], inputs=("y",), outputs=("u",))
    >>> margin = disk_margin(plant, gain)
    >>> round(margin.alpha, 2), round(margin.gain[0], 2), round(margin.gain[1], 2)
    (0.46, 0.63, 1.59)
    """
    return loop_disk_margin(cut_loop(plant, controller, pressure=pressure, delay_s=delay_s), at)


def loop_disk_margin(loop: Loop, at: Cut = "input") -> DiskMargin:
    """Balanced disk margin of a loop that is cut open already.

    Parameters
    ----------
    loop : Loop
        Of `cut_loop`.
    at : {"input", "output", "both"}
        What is perturbed.

    Returns
    -------
    margin : DiskMargin
        0 for a loop that is unstable. [-]

    Raises
    ------
    ValueError
        If `at` is none of the three.

    References
    ----------
    P. Seiler, A. Packard and P. Gahinet, "An introduction to disk margins", IEEE Control Systems Magazine 40(5), 2020,
    theorem 1.

    Examples
    --------
    >>> names = {"states": ("x",), "inputs": ("u",), "outputs": ("y",)}
    >>> integrator = LinearSystem(A=[[0.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]], **names)
    >>> gain = Controller(A=[], B=[], C=[], D=[[-2.0]], inputs=("y",), outputs=("u",))
    >>> round(loop_disk_margin(cut_loop(integrator, gain)).alpha, 6)
    2.0
    """
    if at not in ("input", "output", "both"):
        raise ValueError(f"a loop is cut at 'input', 'output' or 'both', got {at!r}")
    channels = loop.channels(at)
    if not is_stable(loop):
        return DiskMargin(alpha=0.0, frequency=None, at=at, channels=channels, stable=False)

    def size(omega: Array) -> Array:
        L = loop.transfer(1j * omega, at)
        one = np.eye(L.shape[-1])
        return mu_bound(np.linalg.inv(one + L) - 0.5 * one)  # (S - T)/2 with T = 1 - S

    largest, frequency = peak(size, frequencies(loop))
    return DiskMargin(alpha=1.0 / largest, frequency=frequency, at=at, channels=channels, stable=True)


def mu_bound(M: Array) -> Array:
    """Upper bound of the structured singular value for independent complex perturbations of every channel.

    min over diagonal D of the largest singular value of D M D^-1: Perron's scaling of |M|, improved by descent (the
    logarithm of the singular value is convex in the logarithm of D). Exact for up to three channels.

    Parameters
    ----------
    M : complex ndarray, shape (m, n, n)
        Matrices. [-]

    Returns
    -------
    bound : ndarray, shape (m,)
        Never below mu, never above the largest singular value. [-]

    References
    ----------
    A. Packard and J. Doyle, Automatica 29(1), 1993, section 8 (upper bound, exact for up to three blocks);
    M. G. Safonov, IEE Proceedings D 129(6), 1982 (Perron scaling).

    Examples
    --------
    >>> float(mu_bound(np.array([[[0.0, 100.0], [0.01, 0.0]]]))[0].round(5))
    1.0
    """
    m, n = M.shape[:2]
    plain = np.linalg.norm(M, 2, axis=(1, 2)) if n > 1 else np.abs(M[:, 0, 0])
    if n == 1:
        return np.asarray(plain)
    size = np.abs(M) + 1e-15 * np.abs(M).max(axis=(1, 2), keepdims=True) + 1e-300
    right, left = np.ones((m, n)), np.ones((m, n))
    for _ in range(40):
        right, left = np.einsum("mij,mj->mi", size, right), np.einsum("mji,mj->mi", size, left)
        right, left = right / right.sum(axis=1, keepdims=True), left / left.sum(axis=1, keepdims=True)
    d = 0.5 * np.log(left / right)
    best, slope = _scaled(M, d)
    if n > 1:
        step = np.ones(m)
        for _ in range(SCALINGS):
            value, new_slope = _scaled(M, d - step[:, None] * slope)
            better = value < best
            d = np.where(better[:, None], d - step[:, None] * slope, d)
            slope, best = np.where(better[:, None], new_slope, slope), np.where(better, value, best)
            step = np.where(better, 1.3 * step, 0.4 * step)
    return np.asarray(np.minimum(best, plain))


def _scaled(M: Array, d: Array) -> tuple[Array, Array]:
    """Largest singular value of D M D^-1 with D = exp(d), and the slope of its logarithm in d."""
    D = np.exp(d - d.mean(axis=1, keepdims=True))
    u, s, vh = np.linalg.svd(D[:, :, None] * M / D[:, None, :])
    return s[:, 0], np.abs(u[:, :, 0]) ** 2 - np.abs(vh[:, 0, :]) ** 2


def margin_curve(
    model: AeroelasticModel,
    condition: FlightCondition,
    controller: Controller,
    *,
    altitude: Array | float = 0.0,
    delays_s: Sequence[float] | None = None,
    at: Cut = "input",
) -> MarginCurve:
    """Disk margins of a controller over speeds and altitudes, and against the total delay of the loop.

    Parameters
    ----------
    model : AeroelasticModel
        With rational air forces.
    condition : FlightCondition
        Shape (n_V,).
    controller : Controller
        A schedule is interpolated at each dynamic pressure.
    altitude : float or ndarray, shape (n_V,)
        Of each condition, for the record. [m]
    delays_s : sequence of float, optional
        Total delays in the place of the loop's own (`total_delay`), which is the default. [s]
    at : {"input", "output", "both"}
        What is perturbed.

    Returns
    -------
    curve : MarginCurve
        One row for each condition, one column for each delay. [-]

    Raises
    ------
    ValueError
        If a channel is missing or a delay is negative.

    References
    ----------
    P. Seiler, A. Packard and P. Gahinet, IEEE Control Systems Magazine 40(5), 2020, theorem 1.

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> gain = Controller(A=[], B=[], C=[], D=[[0.1]], inputs=("pitch_rate_rad_s",), outputs=("elevon_command_rad",),
    ...                   dt_s=0.005)
    >>> curve = margin_curve(build(read("thesis-simulation")), FlightCondition.at(3048.0, V=[30.0, 60.0]), gain,
    ...                      delays_s=(0.005, 0.03))
    >>> curve.alpha.round(2).tolist()
    [[1.88, 1.35], [0.47, 0.07]]
    """
    own = total_delay(model, controller)
    delays = np.array([own] if delays_s is None else delays_s, dtype=float)
    alpha, frequency = (np.full((len(condition.V), len(delays)), np.nan) for _ in range(2))
    for j, delay in enumerate(delays):
        if delay < 0.0:
            raise ValueError(f"delays_s must not be negative [s], got {delay:g}")
        extra = float(delay) - own
        if extra < -controller.delay_s - 1e-12:
            continue
        plants = loop_plant(model, condition, controller, delay_s=max(extra, -controller.delay_s))
        for i, q in enumerate(condition.q):
            found = disk_margin(plants[i], controller, at=at, pressure=float(q))
            alpha[i, j] = found.alpha
            frequency[i, j] = np.nan if found.frequency is None else found.frequency
    return MarginCurve(
        V=condition.V,
        altitude=np.broadcast_to(np.asarray(altitude, dtype=float), condition.V.shape),
        delays=delays,
        alpha=alpha,
        frequency=frequency,
    )


def total_delay(model: AeroelasticModel, controller: Controller) -> float:
    """Delay of a loop from the instant that is measured to the command that acts, lags and hold left out.

    Parameters
    ----------
    model : AeroelasticModel
        Its actuators and sensors; of several the longest delay counts.
    controller : Controller
        What it reads and drives, and its computing delay.

    Returns
    -------
    delay : float
        Age of the sample + computing delay + dead time of the actuator. [s]

    References
    ----------
    Project convention: the total delay of a loop is the sum of its pure delays.

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> gain = Controller(A=[], B=[], C=[], D=[[0.1]], inputs=("acc_te",), outputs=("elevon_command_rad",), dt_s=0.005,
    ...                   delay_s=0.002)
    >>> total_delay(build(read("bact")), gain)
    0.002
    """
    driven = {name.removesuffix("_rad").removesuffix("_command") for name in controller.outputs}
    dead = max((a.delay_s for a in model.actuators if a.control in driven), default=0.0)
    age = max((s.delay_s for s in model.sensors if {s.name, s.channel} & set(controller.inputs)), default=0.0)
    return controller.delay_s + dead + age
