"""The wing with section polars: profile drag and viscous moment looked up on the lattice's span loading.

Each strip keeps the lift that the lattice gives it; its section polar says, at that lift, that Reynolds number and that
deflection, what it costs in drag and what moment it has. Strips that ask for more lift than their polar has are marked
as stalled and the total lift is then too high; strips outside the table make the drag NaN. Induced drag comes from the
Trefftz plane. Valid for attached flow on wings without much sweep of the boundary layer (up to about 30 degrees).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from aeroservo.aero.polars import INSIDE, OUTSIDE, STALLED, Polar, section_at_lift
from aeroservo.aero.trefftz import InducedDrag
from aeroservo.aero.vlm_loads import LatticeDerivatives, SpanLoading


@dataclass(frozen=True, kw_only=True, eq=False)
class WingSections:
    """What each strip of the lattice is made of.

    Parameters
    ----------
    polars : tuple of Polar
        The section polars in use.
    which : array_like of int, shape (n_strips,)
        Index of each strip's polar: int.
    reynolds : array_like, shape (n_strips,)
        Reynolds number of each strip on its own chord. [-]
    gain : array_like, shape (n_strips, m)
        Section deflection per unit of each input: 1 behind a control's own input, else 0. [-]
    """

    polars: tuple[Polar, ...]
    which: np.ndarray
    reynolds: np.ndarray
    gain: np.ndarray


@dataclass(frozen=True, kw_only=True, eq=False)
class WingPolar:
    """Coefficients of the whole wing at k conditions; see `viscous_wing`."""

    CL: np.ndarray  # (k,) [-] lift, the lattice's
    CD_induced: np.ndarray  # (k,) [-]
    CD_profile: np.ndarray  # (k,) [-] NaN where a strip lies outside its polar
    CM: np.ndarray  # (k,) [-] about the reference point, the lattice's
    CM_viscous: np.ndarray  # (k,) [-] with the sections' moments from their polars
    mark: np.ndarray  # (k, n_strips) index INSIDE, STALLED or OUTSIDE of each strip: int
    section_lift: np.ndarray  # (k, n_strips) [-] lift coefficients of the strips

    @property
    def CD(self) -> np.ndarray:
        """Induced and profile drag (k,) [-]."""
        return self.CD_induced + self.CD_profile

    @property
    def lift_to_drag(self) -> np.ndarray:
        """CL/CD with profile drag (k,) [-]."""
        return self.CL / self.CD

    @property
    def lift_to_drag_inviscid(self) -> np.ndarray:
        """CL/CD_induced (k,) [-]."""
        return self.CL / self.CD_induced

    @property
    def stalled(self) -> np.ndarray:
        """Whether any strip is stalled or outside its polar (k,), a mask [-]."""
        return np.any(self.mark != INSIDE, axis=1)


@dataclass(frozen=True, kw_only=True, eq=False)
class Trim:
    """A trimmed state for each centre of gravity; see `trimmed`."""

    x_cg: np.ndarray  # (k,) [m] centre of gravity
    alpha: np.ndarray  # (k,) [rad] angle of attack
    delta: np.ndarray  # (k,) [rad] deflection
    static_margin: np.ndarray  # (k,) [-] of the reference chord, positive when stable
    polar: WingPolar  # coefficients at the trimmed states


def viscous_wing(
    loading: SpanLoading,
    derivatives: LatticeDerivatives,
    drag: InducedDrag,
    sections: WingSections,
    inputs: np.ndarray,
    *,
    mirrored: bool,
) -> WingPolar:
    """Coefficients of a wing with section polars at any number of conditions.

    Parameters
    ----------
    loading : SpanLoading
        Strips, per unit of each input.
    derivatives : LatticeDerivatives
        Coefficients, per unit of each input.
    drag : InducedDrag
        Quadratic form of the induced drag.
    sections : WingSections
        Polars of the strips.
    inputs : array_like, shape (k, m)
        Amounts of the inputs in the order of `derivatives.names`. [rad]
    mirrored : bool
        Whether the strips are one half of the wing; inputs must then be symmetric.

    Returns
    -------
    WingPolar
        With every strip marked.

    Raises
    ------
    ValueError
        If shapes differ, or a half lattice is given inputs that are not symmetric.

    References
    ----------
    J. Anderson, Fundamentals of Aerodynamics, 2011, section 5.4 (section data on the span loading); Bramstång 2015,
    figures 22-25.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> from aeroservo.studies.wing_polar import wing_polar
    >>> swept = wing_polar(read("thesis-uav"), alpha=np.radians([2.0, 4.0]), delta=[0.0], speed=25.0)
    >>> bool(swept[0].lift_to_drag[0] < swept[0].lift_to_drag_inviscid[0])
    True
    """
    x = np.atleast_2d(np.asarray(inputs, dtype=float))
    names, ref = derivatives.names, derivatives.reference
    if x.shape[1] != len(names):
        raise ValueError(f"inputs must have {len(names)} columns ({', '.join(names)}), got {x.shape[1]}")
    if mirrored:
        odd = [n for n in names if n in ("beta", "p", "r") or n.endswith("_antisymmetric")]
        used = [n for n in odd if np.any(x[:, names.index(n)] != 0.0)]
        if used:
            raise ValueError(f"inputs {', '.join(used)} are not symmetric: build the lattice with full=True")
    lift = x @ loading.cl.T
    delta = x @ np.asarray(sections.gain, dtype=float).T
    profile, moment, mark = _sections(sections, lift, delta)
    sides = 2.0 if mirrored else 1.0
    area = sides * loading.chord * loading.width
    lattice_moment = x @ loading.cm_quarter.T
    # rates are per p b/2V in the derivatives and per p/V in the loading: only angles are used here
    CM = x @ derivatives.CM
    change = (moment - lattice_moment) @ (area * loading.chord) / (ref.S * ref.c)
    return WingPolar(
        CL=x @ derivatives.CL,
        CD_induced=drag.area(x) / ref.S,
        CD_profile=profile @ area / ref.S,
        CM=CM,
        CM_viscous=CM + change,
        mark=mark,
        section_lift=lift,
    )


def trimmed(
    loading: SpanLoading,
    derivatives: LatticeDerivatives,
    drag: InducedDrag,
    sections: WingSections,
    *,
    CL: float,
    x_cg: Sequence[float] | np.ndarray,
    control: str,
    mirrored: bool,
) -> Trim:
    """Angle of attack and deflection that carry a lift without moment about each centre of gravity.

    Parameters
    ----------
    loading, derivatives, drag, sections : SpanLoading, LatticeDerivatives, InducedDrag, WingSections
        As for `viscous_wing`; must hold an input ``steady``.
    CL : float
        Lift coefficient to be carried. [-]
    x_cg : array_like, shape (k,)
        Centres of gravity. [m]
    control : str
        Name of the input that trims.
    mirrored : bool
        Whether the strips are one half of the wing.

    Returns
    -------
    Trim
        With the viscous moment in balance to 1e-9; NaN where no balance was found inside the polars.

    Raises
    ------
    ValueError
        If the control is not an input, or cannot trim.

    References
    ----------
    Bramstång 2015, figure 4 (the argument made quantitative); statics.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> from aeroservo.studies.wing_polar import trimmed_wing
    >>> trim = trimmed_wing(read("thesis-uav"), x_cg=[0.33, 0.35], CL=0.3, speed=25.0)
    >>> bool(trim.delta[1] > trim.delta[0])  # centre of gravity aft: elevon down
    True
    """
    names, ref = derivatives.names, derivatives.reference
    if control not in names:
        raise ValueError(f"no input {control!r} to trim with; there are {', '.join(names)}")
    a, d = names.index("alpha"), names.index(control)
    x_cg = np.atleast_1d(np.asarray(x_cg, dtype=float))
    arm = (x_cg - ref.x) / ref.c
    CM_a = derivatives.CM[a] + arm * derivatives.CL[a]
    CM_d = derivatives.CM[d] + arm * derivatives.CL[d]
    determinant = derivatives.CL[a] * CM_d - derivatives.CL[d] * CM_a
    if np.any(np.abs(determinant) < 1e-9):
        raise ValueError(f"control {control!r} cannot trim: it moves lift and moment as the angle of attack does")
    x = np.zeros((len(x_cg), len(names)))
    x[:, names.index("steady")] = 1.0
    for _ in range(60):
        polar = viscous_wing(loading, derivatives, drag, sections, x, mirrored=mirrored)
        lift_error = CL - polar.CL
        moment_error = -(polar.CM_viscous + arm * polar.CL)
        if np.all(~np.isfinite(moment_error) | (np.abs(moment_error) + np.abs(lift_error) < 1e-10)):
            break
        x[:, a] += (lift_error * CM_d - derivatives.CL[d] * moment_error) / determinant
        x[:, d] += (derivatives.CL[a] * moment_error - CM_a * lift_error) / determinant
    failed = ~(np.abs(moment_error) + np.abs(lift_error) < 1e-9)
    x[np.ix_(failed, [a, d])] = np.nan  # the others stay 0: a half lattice takes symmetric inputs only
    polar = viscous_wing(loading, derivatives, drag, sections, x, mirrored=mirrored)
    return Trim(
        x_cg=x_cg,
        alpha=x[:, a],
        delta=x[:, d],
        static_margin=np.asarray(derivatives.static_margin(x_cg)),
        polar=polar,
    )


def marks_in_words(polar: WingPolar) -> tuple[str, ...]:
    """What the marks of each condition mean, for warnings.

    Parameters
    ----------
    polar : WingPolar
        The wing.

    Returns
    -------
    words : tuple of str, length k
        Empty where every strip is inside its polar.

    References
    ----------
    Project convention: polars, "no extrapolation".

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> from aeroservo.studies.wing_polar import wing_polar
    >>> marks_in_words(wing_polar(read("thesis-uav"), alpha=np.radians([3.0, 40.0]), delta=[0.0], speed=25.0)[0])[0]
    ''
    """
    words = []
    for row in polar.mark:
        stalled, outside = int(np.sum(row == STALLED)), int(np.sum(row == OUTSIDE))
        parts = [f"{stalled} of {len(row)} strips stalled: lift is overestimated"] if stalled else []
        parts += [f"{outside} of {len(row)} strips outside their polar: no profile drag"] if outside else []
        words.append("; ".join(parts))
    return tuple(words)


def _sections(sections: WingSections, lift: np.ndarray, delta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Drag, moment and mark of every strip at every condition, shape (k, n_strips)."""
    profile, moment = np.full(lift.shape, np.nan), np.full(lift.shape, np.nan)
    mark = np.full(lift.shape, OUTSIDE)
    which, reynolds = np.asarray(sections.which), np.asarray(sections.reynolds, dtype=float)
    for index, polar in enumerate(sections.polars):
        mine = which == index
        known = np.isfinite(lift[:, mine]) & np.isfinite(delta[:, mine])
        point = section_at_lift(
            polar,
            np.where(known, lift[:, mine], 0.0),
            reynolds=reynolds[mine],
            delta=np.where(known, delta[:, mine], 0.0),
        )
        profile[:, mine] = np.where(known, point.CD, np.nan)
        moment[:, mine] = np.where(known, point.CM, np.nan)
        mark[:, mine] = np.where(known, point.mark, OUTSIDE)
    return profile, moment, mark
