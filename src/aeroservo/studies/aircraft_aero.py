"""The steady aerodynamics of an aircraft file in one call: derivatives, and the section polars of its surfaces."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence

import numpy as np

from aeroservo.aero.coefficients import AeroCoefficients
from aeroservo.aero.polars import Polar
from aeroservo.aero.vlm import VortexLattice
from aeroservo.aeroelastic.aircraft_lattice import AircraftLattice, aircraft_lattice, lattice_coefficients
from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.aircraft.files import read
from aeroservo.aircraft.geometry import ControlKind, LiftingSurface, MorphReading
from aeroservo.atmosphere import atmosphere
from aeroservo.studies.section_polar import Source, section_polar

#: Panels of the command `aero`: the thesis wing's derivatives are then within 1 % of their limits.
PANELS = VortexLattice(chordwise=24, spanwise=32)
#: Axes of a polar that is computed for a whole wing. [rad]
_ALPHA = np.radians(np.arange(-10.0, 16.25, 0.5))


def read_aircraft(name_or_path: str | os.PathLike[str]) -> AircraftFile:
    """Read a model file of kind `aircraft`, and no other.

    Parameters
    ----------
    name_or_path : str or path
        Preset or file.

    Returns
    -------
    model : AircraftFile
        As `aeroservo.read` gives it.

    Raises
    ------
    ValueError
        If the file is of another kind.
    """
    model = read(name_or_path)
    if not isinstance(model, AircraftFile):
        raise ValueError(
            f"{model.name}: kind {model.kind!r} holds no wing sections, airfoils or controls; this needs a model of "
            "kind 'aircraft' (see aeroservo new thesis-uav FILE.toml)"
        )
    return model


def aircraft_coefficients(model: AircraftFile, *, method: VortexLattice = PANELS) -> AeroCoefficients:
    """Longitudinal coefficients of an aircraft file from the lattice.

    Parameters
    ----------
    model : AircraftFile
        The aircraft.
    method : VortexLattice
        Panels and Mach number.

    Returns
    -------
    coefficients : AeroCoefficients
        About the file's reference point. [1/rad]
    """
    return lattice_coefficients(aircraft_lattice(model.surfaces(), model.references(), method=method))


def kinematic_viscosity(altitude: float = 0.0, density: float | None = None) -> float:
    """Kinematic viscosity of the standard day, or at sea-level temperature of a given density.

    Parameters
    ----------
    altitude : float
        Geopotential altitude. [m]
    density : float, optional
        In place of the altitude, greater than 0. [kg/m^3]

    Returns
    -------
    viscosity : float
        nu = mu/rho. [m^2/s]

    Raises
    ------
    ValueError
        If the density is not positive.
    """
    if density is None:
        return float(atmosphere(altitude).nu)
    if not density > 0.0:
        raise ValueError(f"density must be > 0 [kg/m^3] for a Reynolds number, got {density:g}")
    return float(atmosphere(0.0).mu) / density


def surface_polars(
    model: AircraftFile,
    *,
    speed: float,
    viscosity: float,
    delta: Sequence[float] | np.ndarray,
    source: Source = "auto",
    progress: Callable[[str], None] | None = None,
) -> tuple[Polar, ...]:
    """A section polar for each surface, over the Reynolds numbers of its chords at one speed.

    Parameters
    ----------
    model : AircraftFile
        The aircraft.
    speed : float
        Airspeed. [m/s]
    viscosity : float
        Kinematic viscosity. [m^2/s]
    delta : array_like, shape (n_d,)
        Deflections that will be asked for. [rad]
    source : {"auto", "table", "neuralfoil", "xfoil"}
        As for `section_polar`.
    progress : callable, optional
        As for `section_polar`.

    Returns
    -------
    polars : tuple of Polar
        For `studies.wing_polar`; the shipped table as it is where it fits the surface.

    Raises
    ------
    ValueError
        If speed or viscosity are not positive, the sections of a surface differ in airfoil, its controls in kind or
        hinge, the table does not reach, or what is needed is not installed.
    """
    if not (speed > 0.0 and viscosity > 0.0):
        raise ValueError(f"speed [m/s] and viscosity [m^2/s] must be > 0, got {speed:g} and {viscosity:g}")
    surfaces = model.surfaces()
    for surface in surfaces:  # before any program runs for minutes
        _one_section(surface)
    return tuple(_surface_polar(s, speed / viscosity, np.asarray(delta, float), source, progress) for s in surfaces)


def with_control_kind(model: AircraftFile, kind: ControlKind) -> AircraftFile:
    """The same aircraft with every control hinged, or every control morphed behind the same hinge line.

    Parameters
    ----------
    model : AircraftFile
        The aircraft.
    kind : {"hinged", "morphed"}
        Kind of the controls.

    Returns
    -------
    model : AircraftFile
        A copy; what equal deflection means stays as the file says.
    """
    surfaces = [
        s.model_copy(update={"control": tuple(c.model_copy(update={"kind": kind}) for c in s.control)})
        for s in model.surface
    ]
    return model.model_copy(update={"surface": tuple(surfaces)})


def inputs_at_lift(found: AircraftLattice, CL: float, delta: float) -> dict[str, float]:
    """Angle of attack, and all symmetric controls at one deflection, that carry a lift coefficient.

    Parameters
    ----------
    found : AircraftLattice
        The lattice.
    CL : float
        Lift coefficient. [-]
    delta : float
        Deflection, trailing edge down. [rad]

    Returns
    -------
    inputs : dict
        Amounts by name of input: "steady" 1, "alpha" and the controls. [rad]
    """
    d = found.derivatives
    given = d.of("CL", "steady") + delta * sum(d.of("CL", name) for name in found.controls)
    alpha = (CL - given) / d.of("CL", "alpha")
    return {"steady": 1.0, "alpha": alpha} | dict.fromkeys(found.controls, delta)


def _one_section(surface: LiftingSurface) -> tuple[str, ControlKind, MorphReading, float]:
    """Airfoil, kind and reading of the control, and hinge, which the whole surface must share."""
    names = {s.airfoil for s in surface.sections}
    looks = {(c.kind, c.reading, c.hinge_from, c.hinge_to) for c in surface.controls}
    if len(names) > 1 or len(looks) > 1:
        raise ValueError(
            f"surface {surface.name!r} mixes airfoils ({', '.join(sorted(names))}) or kinds and hinges of controls: "
            "the viscous wing takes one section polar for each surface; split it into surfaces of one airfoil each"
        )
    if names == {"flat"}:
        raise ValueError(
            f"surface {surface.name!r}: its airfoil is 'flat', a plate without thickness, which has no polar; name an "
            "airfoil in the model file, or leave out --speed for the lattice alone"
        )
    kind, reading, hinge, hinge_to = looks.pop() if looks else ("hinged", "same_drop", 0.75, 0.75)
    if hinge != hinge_to:
        raise ValueError(
            f"surface {surface.name!r}: the hinge runs from {hinge:g} to {hinge_to:g} of the chord; the viscous wing "
            "takes one section polar for each surface, so the hinge must stay at one chord fraction"
        )
    return names.pop(), kind, reading, hinge


def _surface_polar(
    surface: LiftingSurface,
    per_metre: float,
    delta: np.ndarray,
    source: Source,
    progress: Callable[[str], None] | None,
) -> Polar:
    """One surface's polar; `per_metre` is the Reynolds number of a chord of one metre."""
    name, kind, reading, hinge = _one_section(surface)
    reynolds = per_metre * np.array([surface.chords.min(), surface.chords.max()])
    axis = np.geomspace(reynolds[0] * 0.99, reynolds[1] * 1.01, 3)
    reach = np.unique(np.concatenate([[0.0], delta]))
    steps = max(2, int(np.ceil((reach[-1] - reach[0]) / np.radians(5.0))) + 1) if len(reach) > 1 else 1
    grid = np.unique(np.concatenate([reach, np.linspace(reach[0], reach[-1], steps)]).round(12))
    try:
        return section_polar(
            name, alpha=_ALPHA, delta=grid, reynolds=axis, hinge=hinge, kind=kind, reading=reading,
            source=source, whole_table=True, progress=progress,
        )  # fmt: skip
    except ValueError as error:
        raise ValueError(f"surface {surface.name!r}: {error}") from error
