"""Flutter with oscillatory derivatives held at one reduced frequency, as the thesis does it [7.34-7.36].

The thesis takes the derivatives L_h ... M_thetadot at one k, which makes B and C of [7.24] constant matrices, and
calls the eigenvalues of that quasi-polynomial its unsteady result. It is true only where the flutter found has that
same k; elsewhere the air remembers a motion that is not there. A free heave even gets a spring from the air, L_h(k),
that has no right to exist at rest, and with it real roots that are no property of the aircraft.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from aeroservo.aeroelastic.roots import p_values
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition, RationalAero, SampledAero, frozen

STEP = 0.5
"""Step of the speeds at which the roots are taken before a crossing is refined. [m/s]"""

OTHER_BRANCH = 0.2
"""Between two k, a change of frequency by more than this part of it means that another root flutters first."""

PARTS = 32
"""Parts into which the step that holds a crossing is cut, again and again."""

CUTS = 8
"""How often: 0.5 m/s becomes 5e-13."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FixedKCurve:
    """Flutter speed against the reduced frequency at which the derivatives are held.

    Attributes
    ----------
    k : ndarray, shape (n_k,)
        Reduced frequencies, ascending. [-]
    flutter_speed : ndarray, shape (n_k,)
        Lowest crossing into oscillatory instability, nan where there is none. [m/s]
    flutter_frequency : ndarray, shape (n_k,)
        Its frequency, nan where there is none. [rad/s]
    real_unstable : bool ndarray, shape (n_k,)
        Whether a real root is unstable already at that speed (anywhere in the range where there is none). [-]
    """

    k: Array
    flutter_speed: Array
    flutter_frequency: Array
    real_unstable: Array

    def __post_init__(self) -> None:
        """Lock the arrays; nan stands for a speed that does not exist."""
        object.__setattr__(self, "k", frozen(self.k, ndim=1, name="k"))
        for name in ("flutter_speed", "flutter_frequency", "real_unstable"):
            array = np.array(getattr(self, name))
            if array.shape != self.k.shape:
                raise ValueError(f"{name} must have shape {self.k.shape}, got {array.shape}")
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    @property
    def joined(self) -> Array:
        """Whether points i and i + 1 lie on the same branch, bool, shape (n_k - 1,). [-]"""
        omega = self.flutter_frequency
        return np.isfinite(omega[1:] + omega[:-1]) & (np.abs(np.diff(omega)) <= OTHER_BRANCH * omega[:-1])


def fixed_k_aero(aero: SampledAero | RationalAero, k: float) -> RationalAero:
    """Air forces of the real derivative form at one k: A0 = Re Q(ik), A1 = Im Q(ik)/k, nothing else.

    With Q of Theodorsen strips on the binary wing, -rho V^2/2 A0 is the thesis' rho V^2 C and
    -rho V b/2 A1 its rho V B of [7.34-7.36]; apparent mass stands in C, as in the thesis.

    Parameters
    ----------
    aero : SampledAero or RationalAero
        Air forces at every k.
    k : float
        Reduced frequency at which they are held, positive. [-]

    Returns
    -------
    aero : RationalAero
        Without lags. [SI]

    Raises
    ------
    ValueError
        If k is not positive and finite.

    References
    ----------
    Bramstång 2015, Eqs. 7.34-7.36 and appendix .1-.2, put right in equations.md, "Binary wing".

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> exact = build(read("thesis-binary"), "theodorsen").aero
    >>> held = fixed_k_aero(exact, 0.2)
    >>> bool(np.allclose(held(0.2), exact(0.2), atol=1e-12)), bool(np.allclose(held(0.4), exact(0.4)))
    (True, False)
    """
    if not (np.isfinite(k) and k > 0.0):
        raise ValueError(f"reduced frequency k must be positive [-] (at 0 the derivatives have no limit), got {k:g}")
    Q = np.stack([aero(k, mach) for mach in aero.mach])
    A1 = Q.imag / k
    return RationalAero(A0=Q.real, A1=A1, A2=np.zeros_like(A1), b=aero.b, inputs=aero.inputs, mach=aero.mach)


def fixed_k_curve(model: AeroelasticModel, sweep: FlightCondition, k: Array) -> FixedKCurve:
    """Flutter speed with the derivatives held at each k of a row.

    Roots are taken every `STEP` over the range of the sweep and the first change of sign is refined, so a hump
    narrower than that is not seen (`aeroservo.flutter` on `fixed_k_aero` sees it).

    Parameters
    ----------
    model : AeroelasticModel
        With air forces at every k (Theodorsen strips).
    sweep : FlightCondition
        Its ends, density and speed of sound, shape (n_V,). [m/s, kg/m^3]
    k : ndarray, shape (n_k,)
        Reduced frequencies, positive and ascending. [-]

    Returns
    -------
    curve : FixedKCurve
        One speed for each k. [m/s]

    Raises
    ------
    ValueError
        If a k is not positive and finite.

    References
    ----------
    Bramstång 2015, Eqs. 7.24, 7.34-7.36.

    Examples
    --------
    >>> from aeroservo.aeroelastic.build import build
    >>> from aeroservo.aircraft.files import read
    >>> wing = build(read("thesis-binary"), "theodorsen")
    >>> sweep = FlightCondition.at(0.0, V=np.array([40.0, 80.0]))
    >>> fixed_k_curve(wing, sweep, np.array([0.181236])).flutter_speed.round(2).tolist()  # its own k: exact
    [62.12]
    """
    rows = [_first_crossing(replace(model, aero=fixed_k_aero(model.aero, float(x))), sweep) for x in k]
    speed, frequency, real = (np.array(column) for column in zip(*rows))
    return FixedKCurve(k=k, flutter_speed=speed, flutter_frequency=frequency, real_unstable=real)


def _first_crossing(model: AeroelasticModel, sweep: FlightCondition) -> tuple[float, float, bool]:
    """Speed and frequency of the first crossing of a pair, and whether a real root is unstable there."""

    def values(V: Array) -> Array:
        return p_values(model, FlightCondition(V=V, rho=sweep.rho[0], a_sound=sweep.a_sound[0]))

    def fastest_growth(roots: Array) -> Array:
        return np.where(roots.imag > 0.0, roots.real, -np.inf).max(axis=-1)

    first, last = float(sweep.V[0]), float(sweep.V[-1])
    V = np.linspace(first, last, int(np.ceil((last - first) / STEP)) + 1)
    roots = values(V)
    sigma = fastest_growth(roots)
    for i in np.flatnonzero((sigma[:-1] <= 0.0) & (sigma[1:] > 0.0)):
        low, high = V[i], V[i + 1]
        for _ in range(CUTS):
            cut = np.linspace(low, high, PARTS + 1)
            j = int(np.argmax(fastest_growth(values(cut[1:])) > 0.0))
            low, high = cut[j], cut[j + 1]
        found = values(np.array([high]))[0]
        j = int(np.argmax(np.where(found.imag > 0.0, found.real, -np.inf)))
        if abs(found[j].real) <= 1e-6 * abs(found[j]):  # else two real roots met and became an unstable pair
            return high, float(found[j].imag), bool(np.any((found.imag == 0.0) & (found.real > 0.0)))
    return np.nan, np.nan, bool(np.any((roots.imag == 0.0) & (roots.real > 0.0)))


def k_that_prints(curve: FixedKCurve, printed: float, *, half_width: float = 0.5) -> tuple[tuple[float, float], ...]:
    """Ranges of k whose flutter speed rounds to a printed number, by interpolation of the curve in log k.

    Parameters
    ----------
    curve : FixedKCurve
        Of `fixed_k_curve`.
    printed : float
        Number printed. [m/s]
    half_width : float
        What rounding hides. [m/s]

    Returns
    -------
    ranges : tuple of (float, float)
        Ends of each range, ascending; empty where no k of the curve prints the number. [-]

    References
    ----------
    Bramstång 2015, Tables 2 and 3.

    Examples
    --------
    >>> curve = FixedKCurve(k=[0.1, 1.0], flutter_speed=[50.0, 60.0], flutter_frequency=[1.0, 1.0],
    ...                     real_unstable=[False, False])
    >>> [[round(x, 3) for x in pair] for pair in k_that_prints(curve, 55.0)]
    [[0.282, 0.355]]
    """
    log_k, V, joined = np.log(curve.k), curve.flutter_speed, curve.joined
    pieces: list[tuple[float, float]] = []
    for i in np.flatnonzero(joined):
        x0, x1, v0, v1 = log_k[i], log_k[i + 1], V[i], V[i + 1]
        low, high = sorted((v0, v1))
        bottom, top = max(low, printed - half_width), min(high, printed + half_width)
        if bottom > top:
            continue
        ends = sorted(x0 + (x1 - x0) * ((v - v0) / (v1 - v0) if v1 != v0 else 0.5) for v in (bottom, top))
        if pieces and abs(pieces[-1][1] - ends[0]) < 1e-9:
            pieces[-1] = (pieces[-1][0], ends[1])
        else:
            pieces.append((ends[0], ends[1]))
    return tuple((float(np.exp(a)), float(np.exp(b))) for a, b in pieces)


def common_ranges(
    first: tuple[tuple[float, float], ...], second: tuple[tuple[float, float], ...]
) -> tuple[tuple[float, float], ...]:
    """Where two sets of ranges overlap.

    Parameters
    ----------
    first, second : tuple of (float, float)
        Ranges in ascending order. [-]

    Returns
    -------
    ranges : tuple of (float, float)
        Their intersection. [-]

    References
    ----------
    Project convention: equations.md, "Conventions".

    Examples
    --------
    >>> common_ranges(((0.0, 2.0),), ((1.0, 3.0), (4.0, 5.0)))
    ((1.0, 2.0),)
    """
    overlap = ((max(a, c), min(b, d)) for a, b in first for c, d in second)
    return tuple(pair for pair in overlap if pair[0] <= pair[1])
