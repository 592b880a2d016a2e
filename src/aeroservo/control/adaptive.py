"""Adaptive control: the effect of the controls identified in flight, and a schedule whose commands are scaled by it.

Recursive least squares with forgetting, projection and bounded gains. What is identified is how much force each control
makes on each coordinate, as a part of what the model says (1 is the model). The regressor is the measured deflection;
the target is the change of the rates within a sample that the model does not explain by its motion. Both go through

    F(z) = (1 - 1/z) / (1 + (2 - sqrt(3))/z),

which makes what turbulence leaves in the target white: over a sample a gust is a random walk (Dryden and von Karman
spectra fall with the square of the frequency), its mean over a sample has increments whose neighbours correlate by 1/4,
and (1 + (2 - sqrt(3))/z) is the spectral factor of that. With a white disturbance least squares are not biased by the
feedback that carries the disturbance into the deflection.

A supervisor uses an estimate only while the deflection moves (trace of the covariance) and the estimate is sharp
(standard deviation by the covariance and the residuals); else it says *not identifiable* and returns to the schedule as
it is. A small oscillation of the command, fast against the controlled modes, is added until the estimate is sharp; it
gives way to commands beyond a third of their limit, and is gone at two thirds.

It needs every displacement and rate and the deflection measured, one control, air forces without lags. Sensor noise
limits it: rates are differenced. It corrects wrong effects of the controls, not wrong stiffness or damping.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aeroservo.aeroelastic.linear import PlantRows, state_matrix
from aeroservo.control.controller import Controller
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, RationalAero, frozen

WHITE = 2.0 - math.sqrt(3.0)
"""Zero of the spectral factor of the increments of a random walk's means over samples. [-]"""

BLOCK = 20
"""Samples over which residuals are summed before they are squared: their colour counts in the error. [sample]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Adaptation:
    """What is identified beside a schedule, and how its commands are scaled; data for the compiled engine.

    The command is gain times the schedule's; measured deflections are handed to the schedule divided by the gain, so
    that it sees the deflection that its own model of the control would need.

    Attributes
    ----------
    watch : Controller
        Filter from what the schedule measures to m targets, then n regressors; at the schedule's points.
    force : ndarray, shape (p, m)
        What each target is divided by: the model's force per unit of the regressor, at the schedule's points. [SI]
    effects : tuple of str, length n m
        Names of the parameters, regressor by regressor.
    start, lower, upper : ndarray, shape (n, m)
        Parameters at the start, and between what they are held. [-]
    shares : ndarray, shape (p, n, m)
        Part that each parameter has in the effect of the command, summing up to 1 at each point. [-]
    scaled : tuple of bool, length n_in
        Measured values that are divided by the gain.
    dither : ndarray, shape (n_d, n_out)
        Oscillation added to the commands while the estimate is not sharp, repeated. [rad]
    memory_s : float
        Time constant of forgetting. [s]
    robust : float
        Residuals of more standard deviations than this weigh less; 0: all weigh alike. [-]
    accuracy : float
        Largest standard deviation of a parameter that is used. [-]
    sharp : float
        Standard deviation below which no oscillation is added. [-]
    quiet : float
        RMS change of the deflection in a sample below which excitation is missing. [rad]
    gains : tuple of float, length 2
        Least and largest gain. [-]
    gain_rate : float
        Largest rate of change of the gain. [1/s]
    wait_s : float
        Time before anything is used. [s]
    """

    watch: Controller
    force: Array
    effects: tuple[str, ...]
    start: Array
    lower: Array
    upper: Array
    shares: Array
    scaled: tuple[bool, ...]
    dither: Array
    memory_s: float = 5.0
    robust: float = 3.0
    accuracy: float = 0.08
    sharp: float = 0.015
    quiet: float = math.radians(0.02)
    gains: tuple[float, float] = (0.5, 2.0)
    gain_rate: float = 0.25
    wait_s: float = 1.0

    def __post_init__(self) -> None:
        """Lock the arrays and check shapes and numbers."""
        for name in ("force", "start", "lower", "upper", "dither"):
            object.__setattr__(self, name, frozen(getattr(self, name), ndim=2, name=name))
        object.__setattr__(self, "shares", frozen(self.shares, ndim=3, name="shares"))
        n, m = self.start.shape
        points = len(self.watch.pressures)
        if n < 1 or m < 1 or len(self.watch.outputs) != n + m or len(self.effects) != n * m:
            raise ValueError(f"watch must give {m} targets and {n} regressors, and effects name {n * m} parameters")
        shapes = {"lower": (n, m), "upper": (n, m), "shares": (points, n, m), "force": (points, m)}
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name} must have shape {shape}, got {getattr(self, name).shape}")
        if np.any(self.force == 0.0):
            raise ValueError("force must not be zero at any point")
        if np.any(self.lower > self.start) or np.any(self.start > self.upper):
            raise ValueError("start must lie between lower and upper [-]")
        if len(self.scaled) != len(self.watch.inputs) or not len(self.dither):
            raise ValueError("scaled must name one truth for each measured value, dither one row or more")
        for name in ("memory_s", "accuracy", "sharp", "quiet", "gain_rate"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} of an adaptation must be positive, got {getattr(self, name)}")
        if not (0.0 < self.gains[0] <= 1.0 <= self.gains[1] < math.inf and self.robust >= 0.0 and self.wait_s >= 0.0):
            raise ValueError(f"gains must enclose 1, robust and wait_s not be negative, got {self.gains}")

    @property
    def numbers(self) -> Array:
        """What the kernel `adapt` takes, in its order. [mixed]"""
        dt = self.watch.dt_s or 1.0
        forget = math.exp(-dt / self.memory_s)
        moving = (1.0 - forget) / (self.quiet * dt) ** 2 * self.start.shape[0]
        return np.array(
            [forget, 100.0 * moving, self.robust, self.accuracy, *self.gains, self.gain_rate * dt, self.sharp,
             round(self.wait_s / dt), moving, BLOCK]
        )  # fmt: skip

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of what the engine records at each sample."""
        return (*self.effects, *(f"{name}_error" for name in self.effects), "gain", "identified")

    def check(self, controller: Controller) -> None:
        """Refuse a controller that this adaptation was not made for.

        Parameters
        ----------
        controller : Controller
            The schedule.

        Raises
        ------
        ValueError
            If channels, sample time or points differ.

        References
        ----------
        Project convention: an adaptation and its schedule share channels, sample time and points.

        Examples
        --------
        >>> hasattr(Adaptation, "check")
        True
        """
        w, c = self.watch, controller
        alike = w.inputs == c.inputs and w.dt_s == c.dt_s and np.array_equal(w.pressures, c.pressures)
        if not alike or self.dither.shape[1] != len(c.outputs):
            raise ValueError(
                "the adaptation was made for another controller: channels, sample time and points must agree"
            )


def control_adaptation(
    model: AeroelasticModel,
    schedule: Controller,
    conditions: FlightCondition,
    *,
    dither: float = math.radians(3.0),
    dither_samples: int = 20,
    bounds: tuple[float, float] = (0.3, 3.0),
) -> Adaptation:
    """Identification of the effect of the one control that a schedule drives, on every coordinate that it moves.

    Parameters
    ----------
    model : AeroelasticModel
        What the schedule was designed for: without lags, the control without rate and inertia terms.
    schedule : Controller
        Sampled; measures every displacement and rate, and the deflection of the control.
    conditions : FlightCondition
        Shape (p,): those of the schedule's points.
    dither : float
        Amplitude of the square wave that is added until the estimate is sharp; 0 adds none. [rad]
    dither_samples : int
        Its period, 2 or more: the deflection should change fast, so near the bandwidth of the actuator. [sample]
    bounds : tuple of float, length 2
        Between what each effect is held; 1 is the model. [-]

    Returns
    -------
    adaptation : Adaptation
        Effects are named after the coordinates: `effect_plunge` of lift, `effect_pitch` of moment. [-]

    Raises
    ------
    ValueError
        If something that it needs is not measured, or the model does not fit.

    References
    ----------
    Bramstång 2015, sections 6.4.1 and 10.3 (least squares instead of look-up tables); K. J. Åström and B. Wittenmark,
    Adaptive Control, 1995, sections 2.2 (recursive least squares) and 11.5 (forgetting, projection); L. Ljung, System
    Identification, 1999, section 13.4 (closed loop: the disturbance must be made white).

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> from aeroservo.control.controller import state_feedback
    >>> names = ("plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s", "elevon_rad")
    >>> gain = state_feedback([[0.0, 0.5, 0.0, -0.2, 0.0]], names, ("elevon_command_rad",), 0.005)
    >>> made = control_adaptation(build(read("thesis-simulation")), gain, FlightCondition.at(3048.0, V=[50.0]))
    >>> made.effects
    ('effect_plunge', 'effect_pitch')
    """
    aero, names = model.aero, [name.replace(" ", "_") for name in model.modes.names]
    if not isinstance(aero, RationalAero) or len(aero.lags):
        raise ValueError("the identification of a control needs air forces without lags (quasi-steady)")
    if schedule.dt_s is None or len(schedule.outputs) != 1 or conditions.V.shape != schedule.pressures.shape:
        raise ValueError("a schedule to adapt must be sampled, drive one control and have a condition for each point")
    units = model.modes.units
    displacements = [n + (f"_{u}" if u else "") for n, u in zip(names, units)]
    rates = [f"{n}_rate" + (f"_{u}_s" if u else "_1_s") for n, u in zip(names, units)]
    if dither_samples < 2 or not 0.0 <= dither < math.inf:
        raise ValueError(
            f"dither must not be negative [rad] and last 2 samples or more, got {dither}, {dither_samples}"
        )
    control = schedule.outputs[0].removesuffix("_rad").removesuffix("_command")
    needed = [*displacements, *rates, f"{control}_rad"]
    missing = [name for name in needed if name not in schedule.inputs]
    if missing:
        raise ValueError(f"the schedule to adapt must measure {', '.join(missing)}")
    columns = [aero.inputs[j].name for j in aero.columns("control")]
    if control not in columns:
        raise ValueError(f"the schedule drives {control!r}, which is no control; controls: {', '.join(columns)}")
    u = columns.index(control)
    rows = PlantRows(model, conditions)
    if np.any(rows.delta_rate[..., u]) or np.any(rows.delta_acceleration[..., u]):
        raise ValueError(f"control {control!r} has rate or inertia terms: its effect is no single number")
    n = model.modes.n
    M = np.broadcast_to(np.linalg.inv(rows.inverse), (*conditions.V.shape, n, n))
    own = rows.delta[:, n : 2 * n, u]  # accelerations per rad
    force = np.einsum("pij,pj->pi", M, own)
    moved = np.flatnonzero(np.abs(force).min(axis=0) > 1e-12 * np.abs(force).max())
    A = state_matrix(model, conditions, keep=np.ones(n, dtype=bool))[:, n:]
    where = [schedule.inputs.index(name) for name in needed]
    watch = _watch(schedule, where, np.einsum("pij,pjk->pik", M, A)[:, moved], M[:, moved])
    shares = _shares(schedule, where[n : 2 * n], rows.inverse, force, own, moved)
    sides = np.where(np.arange(dither_samples) < dither_samples // 2, 1.0, -1.0)
    one = np.ones((1, len(moved)))
    return Adaptation(
        watch=watch,
        force=force[:, moved],
        effects=tuple(f"effect_{names[i]}" for i in moved),
        start=one,
        lower=bounds[0] * one,
        upper=bounds[1] * one,
        shares=shares[:, None],
        scaled=tuple(name in (f"{control}_rad", f"{control}_rate_rad_s") for name in schedule.inputs),
        dither=dither * sides[:, None],
    )


def recursive_least_squares(
    regressors: ArrayLike,
    targets: ArrayLike,
    *,
    forget: float = 1.0,
    start: ArrayLike | None = None,
    covariance: ArrayLike | None = None,
) -> tuple[Array, Array]:
    """Least squares sample by sample with exponential forgetting: the textbook form, without bounds.

    The compiled engine runs the same recursion on a root of the covariance, with projection, a ceiling and weights.

    Parameters
    ----------
    regressors, targets : array_like, shapes (n_t, n), (n_t, m)
        What is known and what is to be explained at each sample. [SI]
    forget : float
        Weight of the past at each new sample, in (0, 1]. [-]
    start : array_like, shape (n, m), optional
        Parameters before the first sample; zero if not given. [SI]
    covariance : array_like, shape (n, n), optional
        Before the first sample, in units of the residuals' variance; 1e8 times the identity if not given. [SI]

    Returns
    -------
    parameters : ndarray, shape (n_t, n, m)
        After each sample. [SI]
    covariance : ndarray, shape (n, n)
        After the last. [SI]

    Raises
    ------
    ValueError
        If shapes do not fit, or forget is outside (0, 1].

    References
    ----------
    K. J. Åström and B. Wittenmark, Adaptive Control, 1995, section 2.2, Theorem 2.4.

    Examples
    --------
    >>> known = np.array([[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]])
    >>> recursive_least_squares(known, known @ [[2.0], [3.0]])[0][-1].round(3).ravel().tolist()
    [2.0, 3.0]
    """
    phi, y = np.asarray(regressors, dtype=float), np.asarray(targets, dtype=float)
    if phi.ndim != 2 or y.ndim != 2 or len(phi) != len(y):
        raise ValueError(f"regressors and targets must be tables of equal length, got {phi.shape} and {y.shape}")
    if not 0.0 < forget <= 1.0:
        raise ValueError(f"forget must lie in (0, 1] [-], got {forget}")
    n, m = phi.shape[1], y.shape[1]
    theta = np.zeros((n, m)) if start is None else np.array(start, dtype=float)
    P = 1e8 * np.eye(n) if covariance is None else np.array(covariance, dtype=float)
    if theta.shape != (n, m) or P.shape != (n, n):
        raise ValueError(f"start must have shape {(n, m)} and covariance {(n, n)}, got {theta.shape} and {P.shape}")
    out = np.zeros((len(phi), n, m))
    for k in range(len(phi)):
        gain = P @ phi[k] / (forget + phi[k] @ P @ phi[k])
        theta = theta + np.outer(gain, y[k] - phi[k] @ theta)
        P = (P - np.outer(gain, phi[k] @ P)) / forget
        P = 0.5 * (P + P.T)
        out[k] = theta
    return out, P


def _watch(schedule: Controller, where: list[int], motion: Array, M: Array) -> Controller:
    """The filter from measured values to what the model does not explain, and to the deflection, both whitened.

    Raw rows use y now and y a sample ago: M (v - v') - dt M A (x + x')/2; and the integral of the deflection over
    the sample by the parabola through it now and one and two samples ago. States are y a sample ago, the
    deflection two ago, then those of F: F r = r + s, s' = -r - WHITE F r.
    """
    dt = schedule.dt_s or 1.0
    points, m, n2 = motion.shape
    n, n_in, k = n2 // 2, len(schedule.inputs), m + 1
    now, ago = np.zeros((points, k, n_in)), np.zeros((points, k, n_in + 1))
    for rows, sign in ((now, 1.0), (ago, -1.0)):
        rows[:, :m, where[:n2]] = -0.5 * dt * motion
        rows[:, :m, where[n:n2]] += sign * M
    now[:, m, where[n2]], ago[:, m, where[n2]], ago[:, m, n_in] = dt * np.array([5.0, 8.0, -1.0]) / 12.0
    held = n_in + 1
    A, B = np.zeros((points, held + k, held + k)), np.zeros((points, held + k, n_in))
    B[:, :n_in] = np.eye(n_in)
    A[:, n_in, where[n2]] = 1.0
    A[:, held:, :held], B[:, held:] = -(1.0 + WHITE) * ago, -(1.0 + WHITE) * now
    A[:, held:, held:] = -WHITE * np.eye(k)
    C = np.concatenate([ago, np.broadcast_to(np.eye(k), (points, k, k))], axis=2)
    outputs = (*(f"unexplained_{i + 1}" for i in range(m)), "deflection")
    return Controller(
        A=A, B=B, C=C, D=now, inputs=schedule.inputs, outputs=outputs, dt_s=schedule.dt_s,
        pressures=schedule.pressures if points > 1 else None,  # type: ignore[arg-type]
    )  # fmt: skip


def _shares(schedule: Controller, rates: list[int], inverse: Array, force: Array, own: Array, moved: Array) -> Array:
    """Part of each coordinate's force in K_v times the acceleration that the control makes: the loop's leading gain."""
    Kv = -schedule.D[:, 0, rates]
    each = np.einsum("pi,pij,pj->pj", Kv, np.broadcast_to(inverse, (len(Kv), *inverse.shape[-2:])), force)[:, moved]
    total = np.einsum("pi,pi->p", Kv, own)[:, None]
    part = np.clip(np.divide(each, total, out=np.full_like(each, 1.0 / len(moved)), where=total != 0.0), 0.0, 1.0)
    summed = part.sum(axis=1, keepdims=True)
    return np.where(summed > 0.0, part / np.where(summed > 0.0, summed, 1.0), 1.0 / len(moved))
