"""Rigid flight of an aircraft file: its coefficients, mass and modes, with what the elastic wing takes away.

The lattice's coefficients go over to those of the flight mechanics unchanged but for the rates, which are always
made dimensionless with c/(2V) there. Elastic corrections are quasi-static (thesis, section 5.2.4): the wing bends and
twists at once under the lift of incidence, elevon and camber, root held. It is right for a rigid motion that is slow
against the lowest bending mode, and below divergence. Weight and pitch rate are taken not to bend it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from aeroservo.aero.coefficients import AeroCoefficients, rate_length
from aeroservo.aero.strip import QuasiSteady
from aeroservo.aeroelastic.aircraft_wing import aircraft_wing
from aeroservo.aeroelastic.build_beam import beam_model
from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.atmosphere import STANDARD_GRAVITY
from aeroservo.datatypes import Array
from aeroservo.flight.derivatives import LongitudinalDerivatives, longitudinal_derivatives
from aeroservo.flight.linear import longitudinal_model, pitch_rate_transfer
from aeroservo.flight.modes import FlightMode, RootMovement, flight_modes, root_movement
from aeroservo.flight.rigid import Airframe
from aeroservo.flight.trim import (
    LongitudinalCoefficients,
    TrimState,
    about_centre_of_gravity,
    static_margin,
    trim_derivatives,
    trim_level,
)
from aeroservo.studies.aircraft_aero import aircraft_coefficients
from aeroservo.studies.root_loads import root_loads


@dataclass(frozen=True, kw_only=True, eq=False)
class FlightModel:
    """An aircraft in one trimmed flight.

    Attributes
    ----------
    coefficients : LongitudinalCoefficients
        About the centre of gravity, elastic where that was asked for.
    airframe : Airframe
        Mass, inertia, reference dimensions.
    trim : TrimState
        Incidence, elevon, thrust.
    derivatives : LongitudinalDerivatives
        Dimensional.
    modes : tuple of FlightMode
        Slowest first.
    static_margin : float
        (x_np - x_cg)/c. [-]
    pitch_rate : tuple of ndarray, length 2
        Numerator and denominator of pitch rate per elevon, falling powers of s. [1/s]
    """

    coefficients: LongitudinalCoefficients
    airframe: Airframe
    trim: TrimState
    derivatives: LongitudinalDerivatives
    modes: tuple[FlightMode, ...]
    static_margin: float
    pitch_rate: tuple[Array, Array]


def flight_coefficients(
    coefficients: AeroCoefficients, *, control: str | None = None, CD0: float | None = None
) -> LongitudinalCoefficients:
    """Aerodynamic coefficients in the form that flight mechanics takes.

    Parameters
    ----------
    coefficients : AeroCoefficients
        From a lattice, polars or a tunnel; rates in any normalisation.
    control : str, optional
        Which control is the elevon; default all of them, deflected together.
    CD0 : float, optional
        Drag without lift; default that of the coefficients, 0 where they have none. [-]

    Returns
    -------
    flight : LongitudinalCoefficients
        About the same point; derivatives that are not known are 0. [-, 1/rad]

    Raises
    ------
    ValueError
        If there is no such control.
    """
    k = coefficients
    if control is not None and control not in k.controls:
        raise ValueError(f"control must be one of {', '.join(k.controls) or '(none)'}, got {control!r}")
    chosen = [i for i, name in enumerate(k.controls) if control in (None, name)]
    to_half_chord = 0.5 * k.reference.c / rate_length(k.rates, k.reference.c)
    aspect = k.reference.b**2 / k.reference.S
    induced = 0.0 if not k.span_efficiency else 1.0 / (np.pi * aspect * k.span_efficiency)

    def rate(value: float | None) -> float:
        """Per unit of c/(2V): the derivative to omega l/V times l' / l is to omega l'/V."""
        return 0.0 if value is None else value / to_half_chord

    return LongitudinalCoefficients(
        CL0=k.CL0,
        CL_alpha=k.CL_alpha,
        CL_delta=float(sum(k.CL_delta[i] for i in chosen)),
        CM0=k.CM0,
        CM_alpha=k.CM_alpha,
        CM_delta=float(sum(k.CM_delta[i] for i in chosen)),
        CL_q=rate(k.CL_q),
        CM_q=rate(k.CM_q),
        CL_alphadot=rate(k.CL_alphadot),
        CM_alphadot=rate(k.CM_alphadot),
        CD0=(k.CD0 or 0.0) if CD0 is None else CD0,
        CD_CL2=float(induced),
        x=k.reference.x,
    )


def aircraft_airframe(model: AircraftFile) -> Airframe:
    """Mass, inertia and reference dimensions of an aircraft file, in body axes.

    Parameters
    ----------
    model : AircraftFile
        With masses.

    Returns
    -------
    airframe : Airframe
        About the centre of gravity. [SI]

    Raises
    ------
    ValueError
        If the file has no masses.
    """
    masses, reference = model.masses(), model.references()
    if masses is None:
        raise ValueError(f"{model.name}: flight mechanics needs masses, the file has no [[mass]] table")
    I = masses.inertia  # noqa: E741 - geometry axes: half a turn about y leads to body axes, which changes no xz
    return Airframe(
        mass=masses.mass,
        Ixx=float(I[0, 0]),
        Iyy=float(I[1, 1]),
        Izz=float(I[2, 2]),
        Ixz=float(-I[0, 2]),
        area=reference.S,
        chord=reference.c,
        span=reference.b,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class ElasticChange:
    """What bending and twisting of the held wing does to lift and moment of one column.

    Attributes
    ----------
    lift_ratio : float
        Elastic lift over rigid lift. [-]
    CL, CM : float
        Elastic less rigid coefficient per unit of the column; CM about the point asked for. [-, or 1/rad]
    """

    lift_ratio: float
    CL: float
    CM: float


def elastic_changes(model: AircraftFile, q: float, *, x: float) -> dict[str, ElasticChange]:
    """Quasi-static change of lift and moment by the elastic wing, root held.

    Parameters
    ----------
    model : AircraftFile
        With `[structure]`.
    q : float
        Dynamic pressure, not negative. [Pa]
    x : float
        Moment point, aft of the datum. [m]

    Returns
    -------
    changes : dict of str to ElasticChange
        For "incidence" [1/rad], "camber" (camber and washout) and every control of the wing that acts on both halves
        alike. [1/rad]

    Raises
    ------
    ValueError
        If the file has no structure, q is negative or beyond divergence.
    """
    if not q >= 0.0:
        raise ValueError(f"dynamic pressure q must not be negative [Pa], got {q:g}")
    wing, section = aircraft_wing(model), QuasiSteady(damped=False)
    statics = beam_model(wing, section).statics
    assert statics is not None
    held, rows = root_loads(wing, statics, section)
    assert rows.air is not None
    n, reference = held.modes.n, model.references()
    forces, loads = np.asarray(held.aero(0.0)).real, rows.air.A0
    stiffness = held.modes.K - q * forces[:, :n]
    if q and np.linalg.eigvals(np.linalg.solve(held.modes.K, forces[:, :n])).real.max() * q >= 1.0:
        raise ValueError(f"dynamic pressure q = {q:g} [Pa] is beyond the divergence of the wing")
    root = float(wing.beam.position(wing.beam.y[0])[0])
    changes = {}
    for j, column in enumerate(held.aero.inputs):
        if column.kind not in ("control", "steady") or column.name == "roll_rate" or "antisymmetric" in column.name:
            continue
        bent = loads[:, :n] @ np.linalg.solve(stiffness, q * forces[:, j])
        lift, moment = bent[0], bent[2] - (root - x) * bent[0]
        changes[column.name] = ElasticChange(
            lift_ratio=float(1.0 + lift / loads[0, j]) if loads[0, j] else 1.0,
            CL=float(2.0 * lift / reference.S),
            CM=float(2.0 * moment / (reference.S * reference.c)),
        )
    return changes


def elastic_coefficients(
    coefficients: LongitudinalCoefficients, model: AircraftFile, q: float, *, control: str = "elevon"
) -> LongitudinalCoefficients:
    """Coefficients of the aircraft with its wing bent and twisted by the air forces of each motion.

    Parameters
    ----------
    coefficients : LongitudinalCoefficients
        Of the rigid aircraft, about any point.
    model : AircraftFile
        With `[structure]`.
    q : float
        Dynamic pressure. [Pa]
    control : str
        Name of the elevon in the file.

    Returns
    -------
    elastic : LongitudinalCoefficients
        Lift and moment of incidence, elevon and camber changed; rates and drag as they were.

    Raises
    ------
    ValueError
        As `elastic_changes`, or if there is no such control.

    Notes
    -----
    Thesis, section 5.2.4: torsion takes effect from the elevon; bending of an unswept wing hardly counts.
    """
    k, change = coefficients, elastic_changes(model, q, x=coefficients.x)
    if control not in change:
        raise ValueError(f"control must be one of {', '.join(set(change) - {'incidence', 'camber'})}, got {control!r}")
    alpha, delta, camber = change["incidence"], change[control], change["camber"]
    return replace(
        k,
        CL_alpha=k.CL_alpha + alpha.CL,
        CM_alpha=k.CM_alpha + alpha.CM,
        CL_delta=k.CL_delta + delta.CL,
        CM_delta=k.CM_delta + delta.CM,
        CL0=k.CL0 + camber.CL,
        CM0=k.CM0 + camber.CM,
    )


def aircraft_flight(
    model: AircraftFile, *, V: float, rho: float, x_cg: float | None = None, CD0: float = 0.0, elastic: bool = False
) -> FlightModel:
    """Trim, linear model and longitudinal modes of an aircraft file in level flight.

    Parameters
    ----------
    model : AircraftFile
        With masses; with `[structure]` for the elastic one.
    V : float
        True airspeed. [m/s]
    rho : float
        Air density. [kg/m^3]
    x_cg : float, optional
        Centre of gravity, aft of the datum; default the file's. Mass and inertia are kept. [m]
    CD0 : float
        Drag without lift, which the lattice does not know. [-]
    elastic : bool
        Whether the wing gives way.

    Returns
    -------
    flight : FlightModel
        In stability axes. [SI]

    Raises
    ------
    ValueError
        If the file lacks masses or structure, or the aircraft cannot be trimmed.
    """
    airframe, whole = aircraft_airframe(model), flight_coefficients(aircraft_coefficients(model), CD0=CD0)
    if elastic:
        whole = elastic_coefficients(whole, model, 0.5 * rho * V**2)
    masses = model.masses()
    assert masses is not None
    at = float(masses.cg[0]) if x_cg is None else x_cg
    about = about_centre_of_gravity(whole, at, airframe.chord)
    trim = trim_level(about, airframe, V=V, rho=rho)
    derivatives = longitudinal_derivatives(trim_derivatives(about, airframe, trim), airframe, V=V, rho=rho)
    return FlightModel(
        coefficients=about,
        airframe=airframe,
        trim=trim,
        derivatives=derivatives,
        modes=flight_modes(longitudinal_model(derivatives, airframe, V=V).A),
        static_margin=float(static_margin(whole, at, airframe.chord)),
        pitch_rate=pitch_rate_transfer(derivatives, airframe, V=V),
    )


def aircraft_roots(
    model: AircraftFile, margins: Array, *, V: float, rho: float, CD0: float = 0.0, elastic: bool = False
) -> RootMovement:
    """Longitudinal roots of an aircraft file as its centre of gravity moves.

    Parameters
    ----------
    model : AircraftFile
        With masses.
    margins : ndarray, shape (n,)
        Static margins, in the order in which to follow the roots. [-]
    V : float
        True airspeed. [m/s]
    rho : float
        Air density. [kg/m^3]
    CD0 : float
        Drag without lift. [-]
    elastic : bool
        Whether the wing gives way.

    Returns
    -------
    movement : RootMovement
        Trimmed anew at every point; g is standard gravity. [SI]

    Raises
    ------
    ValueError
        As `aircraft_flight`.
    """
    airframe, whole = aircraft_airframe(model), flight_coefficients(aircraft_coefficients(model), CD0=CD0)
    if elastic:
        whole = elastic_coefficients(whole, model, 0.5 * rho * V**2)
    neutral = whole.x - airframe.chord * whole.CM_alpha / whole.CL_alpha
    x_cg = neutral - airframe.chord * np.asarray(margins, dtype=float)
    return root_movement(whole, airframe, x_cg, V=V, rho=rho, gravity=STANDARD_GRAVITY)
