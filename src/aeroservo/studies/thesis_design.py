"""Chapters 2, 3.4, 8.1 and 9.1 of the thesis again: the design, its airfoil, its controls, its efficiency."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from aeroservo.aero.airfoil import Airfoil, thickness
from aeroservo.aero.airfoil_files import airfoil
from aeroservo.aero.airfoil_thin import camber_coefficients, hinged_derivatives, morphed_derivatives
from aeroservo.aero.polars import Polar, best_lift_to_drag, section_at_lift
from aeroservo.aero.polars_points import shipped_polar
from aeroservo.aero.trefftz import span_efficiency
from aeroservo.aero.viscous_wing import Trim, WingPolar
from aeroservo.aeroelastic.aircraft_lattice import AircraftLattice, aircraft_lattice
from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.aircraft.geometry import LiftingSurface, ReferenceQuantities, WingSection
from aeroservo.studies.aero_views import WingCase
from aeroservo.studies.aircraft_aero import read_aircraft, with_control_kind
from aeroservo.studies.section_polar import deflected

FLAPS = (-10.0, -5.0, 0.0, 5.0, 10.0)
"""Deflections of the thesis' polars. [deg]"""
SPEED = 30.0
"""Airspeed of the wing polars: Reynolds numbers 0.6 to 1.4 million. [m/s]"""
CRUISE_CL = 0.35
"""Lift coefficient of the trimmed comparison: level flight near 24 m/s at sea level. [-]"""
HINGE = 0.75
TAPERS = tuple(np.round(np.arange(0.1, 1.01, 0.1), 1))


@dataclass(frozen=True, kw_only=True, eq=False)
class Design:
    """Everything that chapters 3.4 and 9.1 rest on.

    Attributes
    ----------
    model : AircraftFile
        The preset.
    foil : Airfoil
        MH 62.
    sections : dict of str to Polar
        Hinged and morphed section polars.
    lattices : dict of str to AircraftLattice
        Of the wing with either kind of control.
    polars : dict of str to tuple of WingPolar
        For the deflections of `FLAPS`.
    alpha : ndarray, shape (n_a,)
        Angles of attack. [rad]
    trims : dict of str to Trim
        Trimmed states against the centre of gravity.
    efficiency : dict of float to ndarray
        Oswald's efficiency of flat wings against `TAPERS`, shape (n,), for a sweep of the quarter chord [deg]. [-]
    """

    model: AircraftFile
    foil: Airfoil
    sections: dict[str, Polar]
    lattices: dict[str, AircraftLattice]
    polars: dict[str, tuple[WingPolar, ...]]
    alpha: np.ndarray
    trims: dict[str, Trim]
    efficiency: dict[float, np.ndarray]

    def best(self, kind: str, delta: float, reynolds: float) -> float:
        """Best section L/D at a deflection [deg] and Reynolds number. [-]"""
        return best_lift_to_drag(self.sections[kind], reynolds=reynolds, delta=float(np.radians(delta)))[0]

    def best_of_wing(self, kind: str, delta: float, *, viscous: bool = True) -> tuple[float, float]:
        """Best L/D of the wing without stalled strips at a deflection [deg], and its CL. [-]"""
        polar = self.polars[kind][FLAPS.index(delta)]
        i = int(np.nanargmax(np.where(polar.stalled, np.nan, polar.lift_to_drag)))
        ratio = polar.lift_to_drag if viscous else polar.lift_to_drag_inviscid
        return float(ratio[i]), float(polar.CL[i])

    def slope(self, kind: str) -> float:
        """Lift of the wing per elevon angle, lattice. [1/rad]"""
        found = self.lattices[kind]
        return float(found.derivatives.of("CL", found.controls[0]))

    def at_equal_lift(self, reynolds: float, delta: float, more: float) -> float:
        """Best section L/D, morphed at a deflection [deg] over hinged at the larger one of the same lift. [-]"""
        degrees = np.degrees(self.sections["hinged"].delta)
        hinged = [self.best("hinged", float(d), reynolds) for d in degrees]
        return self.best("morphed", delta, reynolds) / float(np.interp(delta * more, degrees, hinged))


def thesis_design() -> Design:
    """The thesis' flying wing by section polars and vortex lattice.

    Returns
    -------
    design : Design
        Polars, trims, efficiencies.

    References
    ----------
    Bramstång 2015, chapters 3.4, 8.1, 9.1.
    """
    model = read_aircraft("thesis-uav")
    alpha = np.radians(np.arange(-5.0, 14.01, 1.0))
    case = WingCase(model=model, alpha=alpha, delta=np.radians(FLAPS), speed=SPEED, viscosity=1.4607e-5)
    models = {kind: with_control_kind(model, kind) for kind in ("hinged", "morphed")}
    return Design(
        model=model,
        foil=airfoil("mh62"),
        sections={kind: shipped_polar("mh62", kind) for kind in models},
        lattices={kind: aircraft_lattice(m.surfaces(), m.references()) for kind, m in models.items()},
        polars={kind: replace(case, model=m).polars() for kind, m in models.items()},
        alpha=alpha,
        trims=dict(case.trims(CRUISE_CL)),
        efficiency={sweep: taper_efficiency(sweep) for sweep in (0.0, 23.0)},
    )


def taper_efficiency(sweep_deg: float, tapers: tuple[float, ...] = TAPERS) -> np.ndarray:
    """Oswald's efficiency of flat untwisted wings of the thesis' area and span against taper.

    Parameters
    ----------
    sweep_deg : float
        Of the quarter-chord line. [deg]
    tapers : tuple of float
        Tip over root chord. [-]

    Returns
    -------
    e : ndarray, shape (n,)
        1 for the elliptic loading. [-]
    """
    found = []
    for taper in tapers:
        root = 1.0 / (1.0 + taper)
        tip = taper * root
        x_tip = np.tan(np.radians(sweep_deg)) + 0.25 * (root - tip)
        surface = LiftingSurface(
            name="wing", sections=(WingSection(y=0.0, chord=root), WingSection(y=1.0, x_le=float(x_tip), chord=tip))
        )
        lattice = aircraft_lattice([surface], ReferenceQuantities(S=1.0, c=0.5, b=2.0))
        x = np.array([1.0 if name == "alpha" else 0.0 for name in lattice.derivatives.names])
        found.append(span_efficiency(lattice.derivatives.of("CL", "alpha"), float(lattice.drag.area(x)), 2.0))
    return np.array(found)


@dataclass(frozen=True, kw_only=True)
class Morphing:
    """Lift per angle of a bent trailing edge over that of a hinged one.

    Attributes
    ----------
    same_drop, same_slope : float
        Thin aerofoil, for equal drop of the trailing edge and for equal slope there. [-]
    polar : float
        From the section polars, equal drop, 0 to 5 degrees at 2 degrees of incidence and Re 1 million. [-]
    wing : float
        From the lattice of the wing, equal drop. [-]
    """

    same_drop: float
    same_slope: float
    polar: float
    wing: float


def morphing(design: Design) -> Morphing:
    """How much more lift per angle a morphed control gives, read four ways.

    Parameters
    ----------
    design : Design
        Of `thesis_design`.

    Returns
    -------
    ratios : Morphing
        Morphed over hinged. [-]
    """
    lift = float(np.asarray(hinged_derivatives(HINGE)[0]))
    drop, slope = (float(np.asarray(morphed_derivatives(HINGE, reading=r)[0])) for r in ("same_drop", "same_slope"))
    gains = []
    for polar in (design.sections["morphed"], design.sections["hinged"]):
        i = int(np.argmin(np.abs(polar.reynolds - 1e6)))
        a = int(np.argmin(np.abs(polar.alpha - np.radians(2.0))))
        lo, hi = (int(np.argmin(np.abs(polar.delta - np.radians(d)))) for d in (0.0, 5.0))
        gains.append(float(polar.CL[i, hi, a] - polar.CL[i, lo, a]))
    return Morphing(
        same_drop=drop / lift,
        same_slope=slope / lift,
        polar=gains[0] / gains[1],
        wing=design.slope("morphed") / design.slope("hinged"),
    )


def outlines(design: Design, delta: float) -> dict[str, Airfoil]:
    """Outlines of the section with its control down.

    Parameters
    ----------
    design : Design
        Of `thesis_design`.
    delta : float
        Deflection. [deg]

    Returns
    -------
    outlines : dict of str to Airfoil
        "hinged" and "morphed".
    """
    d = float(np.radians(delta))
    return {kind: deflected(design.foil, HINGE, d, kind=kind, reading="same_drop") for kind in ("hinged", "morphed")}


def airfoil_numbers(design: Design) -> tuple[float, float, float, float]:
    """Thickness, where it is largest, moment at zero lift by thin-aerofoil theory and by polar.

    Parameters
    ----------
    design : Design
        Of `thesis_design`.

    Returns
    -------
    numbers : tuple of float
        t/c, x/c, CM0 of thin aerofoil, CM at zero lift of the polar at Re 1 million, about c/4. [-]
    """
    t, x = thickness(design.foil)
    polar = design.sections["hinged"]
    point = section_at_lift(polar, np.array([0.0]), reynolds=1e6, delta=0.0)
    return float(t), float(x), float(camber_coefficients(design.foil)[1]), float(point.CM[0])
