"""Strip theory: section air forces on any set of modes, summed over strips of a wing.

Each strip is a section normal to the flexural axis in the normal component of the flow (V cos Lambda,
chord normal to the axis), Bramstång 2015, section 7.7. Strips do not feel each other: the theory
stops being valid at low aspect ratio, near tips and at strong sweep; a lift slope lower than 2 pi is
the only finite-span correction there is.

A slope sigma = dh/ds of the axis convects with the spanwise flow like a plunge rate, h' + V_n tan(Lambda)
sigma: that is the washout of a bent aft-swept wing.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from aeroservo.aero.indicial import KUSSNER_SEARS_SPARKS, WAGNER_R_T_JONES, IndicialFunction, sears_function
from aeroservo.aero.strip_geometry import StripControl, Strips, StripShapes, strip_shapes
from aeroservo.aero.theodorsen import section_air, theodorsen_function
from aeroservo.datatypes import AeroInput, Array, RationalAero, SampledAero, StaticLoads

__all__ = [
    "NO_WAKE",
    "Indicial",
    "QuasiSteady",
    "StripControl",
    "StripShapes",
    "Strips",
    "Theodorsen",
    "Theory",
    "strip_aero",
    "strip_shapes",
]


@dataclass(frozen=True, kw_only=True)
class QuasiSteady:
    """Simplified quasi-steady theory: L = q c a_w (theta + h'/V), M = q c^2 [e a_w (theta + h'/V) + M_thetadot ...].

    Attributes
    ----------
    damped : bool
        Keep the pitch damping M_thetadot theta' c / (4 V).
    """

    damped: bool = True


@dataclass(frozen=True, kw_only=True)
class Indicial:
    """Theodorsen's section with exponential indicial functions: apparent mass, and lag states for the wake.

    Attributes
    ----------
    wagner : IndicialFunction
        Growth of lift with motion; `NO_WAKE` gives C = 1 with apparent mass.
    kussner : IndicialFunction
        Growth of lift with entry into a gust, referred to the leading edge.
    """

    wagner: IndicialFunction = WAGNER_R_T_JONES
    kussner: IndicialFunction = KUSSNER_SEARS_SPARKS


NO_WAKE = IndicialFunction(constant=1.0, amplitudes=np.zeros(0), exponents=np.zeros(0), name="no wake")
"""C(k) = 1: quasi-steady circulation with apparent mass, a third thing beside `QuasiSteady`."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Theodorsen:
    """Theodorsen's section with the exact C(k), and Sears' function for gusts, as samples.

    Attributes
    ----------
    k : ndarray, shape (n_k,)
        Reduced frequencies of the reference semi-chord; ascending from 0. [-]
    """

    k: Array = field(default_factory=lambda: np.concatenate([[0.0], np.geomspace(1e-6, 2e3, 420)]))


Theory = QuasiSteady | Indicial | Theodorsen


def strip_aero(
    strips: Strips, shapes: StripShapes, names: tuple[str, ...], theory: Theory, *, axis_moment_rolls: bool = True
) -> tuple[RationalAero | SampledAero, StaticLoads]:
    """Generalised air forces of strips on modes, and the lift and rolling moment in the same columns.

    Columns are the modes, the control "elevon" (where a section carries one) and the strips' `controls`
    (quasi-steady with every theory), the gust "gust" (met by every strip at once, its phase at the leading
    edges), and the steady columns "incidence" (1 rad of the whole wing, in the plane of the flow), "camber"
    (built-in incidence and moment) and "roll_rate" (helix angle p s / V of 1, starboard wing down).

    Parameters
    ----------
    strips : Strips
        The wing.
    shapes : StripShapes
        Motion of the strips in each mode.
    names : tuple of str, length n
        Names of the modes.
    theory : QuasiSteady, Indicial or Theodorsen
        Section theory.
    axis_moment_rolls : bool
        Whether the moment about a swept axis counts in the rolling moment; the thesis' wings, whose sweep is
        V cos(Lambda) and nothing else, leave it out.

    Returns
    -------
    aero : RationalAero or SampledAero
        Samples for `Theodorsen`, else rational. [SI]
    loads : StaticLoads
        "lift" [m^2 per unit] and "roll" [m^3 per unit], and the loads of every strip.

    References
    ----------
    Bramstång 2015, Eqs. 3.13-3.20, 7.7, 7.30-7.36, 7.66-7.68 as put right in equations.md;
    NACA Report 496; NACA Report 1014 (swept strips).

    Examples
    --------
    >>> strips = Strips(y=[0.5], width=[1.0], b=0.5, a=-0.2, eccentricity=0.15, lift_slope=6.0, moment_rate=-1.2,
    ...                 sweep=0.0, elevon_lift=0.0, elevon_moment=0.0, incidence=0.0, cm0=0.0, span=1.0)
    >>> shapes = StripShapes(h=np.array([[1.0, 0.0]]), twist=np.array([[0.0, 1.0]]), slope=np.zeros((1, 2)))
    >>> aero, loads = strip_aero(strips, shapes, ("plunge", "pitch"), QuasiSteady())
    >>> round(float(loads.row("lift")[1]), 9)
    6.0
    """
    motion = [shapes.h, shapes.twist] + ([] if shapes.flap is None else [shapes.flap])
    work = np.stack(motion, axis=1)
    full = np.concatenate([work, shapes.slope[:, None, :]], axis=1)
    section = _sections(strips, theory)
    b_ref = float(np.average(strips.b, weights=strips.width))
    ratio = strips.b / (b_ref * np.cos(strips.sweep))
    weight = strips.width * np.cos(strips.sweep) ** 2
    A = [_work_done(weight * ratio**j, work, section.A[j] @ full) for j in range(3)]
    circulation = _Circulation(
        R=np.einsum("s,sci,sc->si", weight, work, section.R),
        w0=np.einsum("sd,sdj->sj", section.w0, full),
        w1=np.einsum("s,sd,sdj->sj", ratio, section.w1, full),
        ratio=ratio,
    )
    fixed, inputs = _fixed_columns(strips, section, names)
    Q_fixed = _work_done(weight, work, fixed)
    n, gust = len(names), [i.kind for i in inputs].index("gust")
    if isinstance(theory, Theodorsen):
        aero: RationalAero | SampledAero = _sampled(theory, A, circulation, Q_fixed, gust - n, b_ref, inputs, strips)
    else:
        wagner, kussner = (theory.wagner, theory.kussner) if isinstance(theory, Indicial) else (NO_WAKE, NO_WAKE)
        aero = _rational(wagner, kussner, A, circulation, Q_fixed, gust - n, b_ref, inputs, strips)
    static = np.concatenate([section.static @ full, fixed], axis=2)
    rows = np.zeros((2, len(strips.y), work.shape[1]))
    rows[0, :, 0], rows[1, :, 0] = -1.0, -strips.y
    if axis_moment_rolls:
        rows[1, :, 1] = np.sin(strips.sweep)
    per_length = static * np.cos(strips.sweep)[:, None, None] ** 2
    loads = StaticLoads(
        names=("lift", "roll"),
        Q=_work_done(weight, np.moveaxis(rows, 0, 2), static),
        y=strips.y,
        width=strips.width,
        lift=-per_length[:, 0],
        torque=per_length[:, 1],
    )
    return aero, loads


def _work_done(weight: Array, work: Array, force: Array) -> Array:
    """Sum over strips and coordinates of weight (s,) times work (s, c, i) times force (s, c, j)."""
    weighted = weight[:, None, None] * work
    return np.asarray(weighted.reshape(-1, work.shape[2]).T @ force.reshape(-1, force.shape[2]))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Section:
    """Section forces on (h, theta[, flap]) per (h, theta[, flap], slope), in the section's own p."""

    A: tuple[Array, Array, Array]
    R: Array
    w0: Array
    w1: Array

    @property
    def static(self) -> Array:
        """Forces at p = 0, (n_s, n_c, n_c + 1)."""
        return self.A[0] + self.R[:, :, None] * self.w0[:, None, :]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Circulation:
    """Circulatory part on the modes: force of each strip times the downwash angle it feels."""

    R: Array
    w0: Array
    w1: Array
    ratio: Array


def _sections(strips: Strips, theory: Theory) -> _Section:
    """The theory's section matrices with the column of the slope appended."""
    air = section_air(strips.a, strips.b, lift_slope=strips.lift_slope, hinge=strips.hinge)
    A, R, w0, w1 = [np.array(x) for x in (air.A0, air.A1, air.A2)], np.array(air.R), np.array(air.w0), np.array(air.w1)
    if isinstance(theory, QuasiSteady):
        chord = 2.0 * strips.b
        A[1], A[2] = np.zeros_like(A[1]), np.zeros_like(A[2])
        if theory.damped:
            A[1][:, 1, 1] = 0.5 * chord**2 * strips.moment_rate
        R[:, 1] = chord**2 * strips.eccentricity * strips.lift_slope
        w1[:, 1:] = 0.0
    lean = (strips.b * np.tan(strips.sweep))[:, None]
    slope = [lean * A[1][:, :, 0], lean * A[2][:, :, 0], 0.0 * A[2][:, :, 0]]
    extended = tuple(np.concatenate([A[j], slope[j][:, :, None]], axis=2) for j in range(3))
    return _Section(
        A=extended,  # type: ignore[arg-type]
        R=R,
        w0=np.concatenate([w0, lean * w1[:, :1]], axis=1),
        w1=np.concatenate([w1, 0.0 * lean], axis=1),
    )


def _fixed_columns(strips: Strips, section: _Section, names: tuple[str, ...]) -> tuple[Array, tuple[AeroInput, ...]]:
    """Section forces (n_s, n_c, n_fixed) of the columns that are not modes, at p = 0, and all inputs."""
    chord, n_c = 2.0 * strips.b, section.R.shape[1]
    per_angle = section.R / np.cos(strips.sweep)[:, None]
    columns, inputs = [], [AeroInput(name=name, kind="mode") for name in names]
    controls = list(strips.controls)
    if np.any(strips.elevon_lift) or np.any(strips.elevon_moment):
        controls.insert(0, StripControl(name="elevon", lift=strips.elevon_lift, moment=strips.elevon_moment))
    for control in controls:
        column = np.zeros((len(chord), n_c))
        column[:, 0], column[:, 1] = -chord * control.lift, chord**2 * control.moment
        columns.append(column)
        inputs.append(AeroInput(name=control.name, kind="control"))
    columns += [per_angle, per_angle]
    inputs += [AeroInput(name="gust", kind="gust"), AeroInput(name="incidence", kind="steady")]
    camber = section.R * strips.incidence[:, None]
    camber[:, 1] += chord**2 * strips.cm0
    columns += [camber, per_angle * strips.roll_angle[:, None]]
    inputs += [AeroInput(name="camber", kind="steady"), AeroInput(name="roll_rate", kind="steady")]
    return np.stack(columns, axis=2), tuple(inputs)


def _sampled(
    theory: Theodorsen,
    A: list[Array],
    circulation: _Circulation,
    Q_fixed: Array,
    gust: int,
    b_ref: float,
    inputs: tuple[AeroInput, ...],
    strips: Strips,
) -> SampledAero:
    """Samples of A0 + A1 ik + A2 (ik)^2 + C(k) R (w0 + w1 ik), Sears' function on the gust column."""
    k = np.asarray(theory.k, dtype=float)
    ik = 1j * k[:, None, None]
    local, which = np.unique(circulation.ratio, return_inverse=True)
    C, S = theodorsen_function(np.outer(k, local)), sears_function(np.outer(k, local), reference="leading_edge")
    groups = [np.flatnonzero(which == g) for g in range(len(local))]
    R, w0, w1 = circulation.R, circulation.w0, circulation.w1
    steady = np.stack([R[g].T @ w0[g] for g in groups])
    rate = np.stack([R[g].T @ w1[g] for g in groups])
    Q = A[0] + ik * (A[1] + ik * A[2])
    Q = Q + np.einsum("kg,gij->kij", C, steady) + ik * np.einsum("kg,gij->kij", C, rate)
    columns = np.broadcast_to(Q_fixed, (len(k), *Q_fixed.shape)).astype(complex)
    angle = R / np.cos(strips.sweep)[:, None]
    columns[:, :, gust] = np.einsum("kg,gi->ki", S, np.stack([angle[g].sum(axis=0) for g in groups]))
    return SampledAero(k=k, Q=np.concatenate([Q, columns], axis=2)[None], b=b_ref, inputs=inputs)


def _rational(
    wagner: IndicialFunction,
    kussner: IndicialFunction,
    A: list[Array],
    circulation: _Circulation,
    Q_fixed: Array,
    gust: int,
    b_ref: float,
    inputs: tuple[AeroInput, ...],
    strips: Strips,
) -> RationalAero:
    """Lag states of the indicial functions: one set for each distinct pole, no more of them than modes."""
    R, w0, w1, ratio = circulation.R, circulation.w0, circulation.w1, circulation.ratio
    n, n_in = A[0].shape[0], len(inputs)
    A0, A1, A2 = (np.zeros((n, n_in)) for _ in range(3))
    A0[:, :n] = A[0] + wagner.constant * R.T @ w0
    A1[:, :n] = A[1] + (wagner.constant - wagner.amplitudes.sum()) * R.T @ w1
    A2[:, :n] = A[2]
    A0[:, n:] = Q_fixed
    lags, lag_D, lag_E = [], [], []
    for local in np.unique(ratio):
        strip = np.flatnonzero(ratio == local)
        for amplitude, exponent in zip(wagner.amplitudes, wagner.exponents):
            pole = exponent / local
            force, downwash = -amplitude * R[strip].T, w0[strip] - pole * w1[strip]
            if len(strip) > n:
                force, downwash = force @ downwash, np.eye(n)
            lags += [pole] * len(downwash)
            lag_D.append(force)
            lag_E.append(np.hstack([downwash, np.zeros((len(downwash), n_in - n))]))
        for amplitude, exponent in zip(kussner.amplitudes, kussner.exponents):
            lags.append(exponent / local)
            lag_D.append(-amplitude * (R[strip] / np.cos(strips.sweep[strip])[:, None]).sum(axis=0)[:, None])
            lag_E.append(np.eye(n_in)[[n + gust]])
    return RationalAero(
        A0=A0[None],
        A1=A1[None],
        A2=A2[None],
        b=b_ref,
        inputs=inputs,
        lags=np.array(lags),
        lag_D=np.hstack([np.zeros((n, 0)), *lag_D])[None],
        lag_E=np.vstack([np.zeros((0, n_in)), *lag_E]),
    )
