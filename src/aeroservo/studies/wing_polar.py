"""Wing polars of an aircraft file: lift, drag, moment, L/D against angle of attack, and in trim (thesis, 9.1)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from aeroservo.aero.polars import Polar
from aeroservo.aero.polars_points import shipped_polar
from aeroservo.aero.viscous_wing import Trim, WingPolar, WingSections, trimmed, viscous_wing
from aeroservo.aero.vlm import VortexLattice
from aeroservo.aero.vlm_loads import span_loading
from aeroservo.aeroelastic.aircraft_lattice import DEFAULT, AircraftLattice, aircraft_lattice, hinge_of
from aeroservo.aircraft.aircraft_schema import AircraftFile

#: Kinematic viscosity of air at sea level, ISO 2533. [m^2/s]
SEA_LEVEL_VISCOSITY = 1.4607e-5


def wing_polar(
    model: AircraftFile,
    *,
    alpha: Sequence[float] | np.ndarray,
    delta: Sequence[float] | np.ndarray,
    speed: float,
    viscosity: float = SEA_LEVEL_VISCOSITY,
    method: VortexLattice = DEFAULT,
    polars: Sequence[Polar] = (),
) -> tuple[WingPolar, ...]:
    """Coefficients against angle of attack for each symmetric deflection of the controls.

    Parameters
    ----------
    model : AircraftFile
        The aircraft.
    alpha : array_like, shape (n_a,)
        Angles of attack. [rad]
    delta : array_like, shape (n_d,)
        Deflections of all controls together, trailing edge down. [rad]
    speed : float
        Airspeed, for the Reynolds numbers of the sections. [m/s]
    viscosity : float
        Kinematic viscosity. [m^2/s]
    method : VortexLattice
        Panels.
    polars : sequence of Polar
        One polar for each surface; without them the shipped ones of its airfoil and kind of control.

    Returns
    -------
    polars : tuple of WingPolar, length n_d
        One for each deflection, with n_a conditions each.

    Raises
    ------
    ValueError
        If there is no polar for an airfoil, or speed or viscosity are not positive.

    References
    ----------
    Bramstång 2015, figures 22-25.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> p = wing_polar(read("thesis-uav"), alpha=np.radians([0.0, 4.0]), delta=np.radians([0.0, 5.0]), speed=25.0)
    >>> bool(p[1].CL[0] > p[0].CL[0])
    True
    """
    found = aircraft_lattice(model.surfaces(), model.references(), method=method)
    sections = wing_sections(model, found, speed=speed, viscosity=viscosity, polars=polars)
    names = found.derivatives.names
    alpha = np.atleast_1d(np.asarray(alpha, dtype=float))
    out = []
    for d in np.atleast_1d(np.asarray(delta, dtype=float)):
        x = np.zeros((len(alpha), len(names)))
        x[:, names.index("steady")] = 1.0
        x[:, names.index("alpha")] = alpha
        for control in found.controls:
            x[:, names.index(control)] = d
        out.append(
            viscous_wing(
                span_loading(found.solution),
                found.derivatives,
                found.drag,
                sections,
                x,
                mirrored=found.solution.lattice.mirrored,
            )
        )
    return tuple(out)


def trimmed_wing(
    model: AircraftFile,
    *,
    x_cg: Sequence[float] | np.ndarray,
    CL: float,
    speed: float,
    control: str = "",
    viscosity: float = SEA_LEVEL_VISCOSITY,
    method: VortexLattice = DEFAULT,
    polars: Sequence[Polar] = (),
) -> Trim:
    """Trimmed state and L/D for each centre of gravity: what stability costs (thesis figure 4, in numbers).

    Parameters
    ----------
    model : AircraftFile
        The aircraft.
    x_cg : array_like, shape (k,)
        Centres of gravity. [m]
    CL : float
        Lift coefficient. [-]
    speed : float
        Airspeed, for the Reynolds numbers of the sections. [m/s]
    control : str
        Control that trims; the first one when empty.
    viscosity : float
        Kinematic viscosity. [m^2/s]
    method : VortexLattice
        Panels.
    polars : sequence of Polar
        As for `wing_polar`.

    Returns
    -------
    Trim
        Deflection, static margin and coefficients.

    Raises
    ------
    ValueError
        If the aircraft has no symmetric control.

    References
    ----------
    Bramstång 2015, figure 4.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> trim = trimmed_wing(read("thesis-uav"), x_cg=[0.34], CL=0.3, speed=25.0)
    >>> bool(abs(trim.polar.CL[0] - 0.3) < 1e-9)
    True
    """
    found = aircraft_lattice(model.surfaces(), model.references(), method=method)
    if not found.controls:
        raise ValueError("the aircraft has no control with a symmetric share: nothing can trim it")
    sections = wing_sections(model, found, speed=speed, viscosity=viscosity, polars=polars)
    return trimmed(
        span_loading(found.solution),
        found.derivatives,
        found.drag,
        sections,
        CL=CL,
        x_cg=x_cg,
        control=control or found.controls[0],
        mirrored=found.solution.lattice.mirrored,
    )


def wing_sections(
    model: AircraftFile,
    found: AircraftLattice,
    *,
    speed: float,
    viscosity: float = SEA_LEVEL_VISCOSITY,
    polars: Sequence[Polar] = (),
) -> WingSections:
    """Polar, Reynolds number and control of every strip.

    Parameters
    ----------
    model : AircraftFile
        The aircraft.
    found : AircraftLattice
        Its lattice.
    speed : float
        Airspeed. [m/s]
    viscosity : float
        Kinematic viscosity. [m^2/s]
    polars : sequence of Polar
        One for each surface; without them the shipped ones.

    Returns
    -------
    WingSections
        For `viscous_wing`.

    Raises
    ------
    ValueError
        If speed or viscosity are not positive, or a surface has no shipped polar.

    References
    ----------
    Re = V c/nu on the strip's own streamwise chord: J. Anderson, Fundamentals of Aerodynamics, 2011, section 1.7.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> model = read("thesis-uav")
    >>> found = aircraft_lattice(model.surfaces(), model.references())
    >>> round(float(wing_sections(model, found, speed=25.0).reynolds.max()) / 1e6, 1)
    1.2
    """
    if not (speed > 0.0 and viscosity > 0.0):
        raise ValueError(f"speed [m/s] and viscosity [m^2/s] must be > 0, got {speed:g} and {viscosity:g}")
    surfaces = model.surfaces()
    if polars and len(polars) != len(surfaces):
        raise ValueError(f"polars: one for each of {len(surfaces)} surface(s), got {len(polars)}")
    chosen = []
    for surface in surfaces:
        names = {section.airfoil for section in surface.sections}
        kinds: set[Literal["hinged", "morphed"]] = {c.kind for c in surface.controls} or {"hinged"}
        if polars:
            continue
        if len(names) > 1 or len(kinds) > 1:
            raise ValueError(f"surface {surface.name!r} mixes airfoils or kinds of control: give its polar yourself")
        looks = {(c.hinge_from, c.hinge_to, c.reading) for c in surface.controls}
        if looks - {(0.75, 0.75, "same_drop")}:
            raise ValueError(
                f"surface {surface.name!r}: the shipped polars are for a hinge at 0.75 of the chord and the same "
                "trailing-edge drop: give its polar yourself (studies.aircraft_aero.surface_polars)"
            )
        chosen.append(shipped_polar(names.pop(), kinds.pop()))
    grid, names_in = found.solution.lattice, found.derivatives.names
    gain = np.zeros((len(grid.strip_chord), len(names_in)))
    for index, surface in enumerate(surfaces):
        for control in surface.controls:
            inside = (grid.strip_surface == index) & np.isfinite(hinge_of(control).at(grid.strip_span))
            if control.name in names_in:
                gain[inside, names_in.index(control.name)] = control.symmetric
    return WingSections(
        polars=tuple(polars) or tuple(chosen),
        which=grid.strip_surface,
        reynolds=speed * grid.strip_chord / viscosity,
        gain=gain,
    )
