"""From an aircraft file to the pitch-plunge-elevon model: rigid wing, two springs, the derivatives of its lattice.

A crude model by its nature: the whole aircraft, rigid, on the springs of one half wing, as the thesis' simulations have
it. The elastic wing of the same file (`build`) is the better model of flutter; this one is for simulation beside the
thesis'.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from aeroservo.aero.vlm import VortexLattice
from aeroservo.aeroelastic.aircraft_axis import carrier
from aeroservo.aeroelastic.aircraft_lattice import aircraft_lattice
from aeroservo.aircraft.aircraft_schema import AircraftFile, StructureStation
from aeroservo.aircraft.file_errors import ModelFileError
from aeroservo.aircraft.files import parse, write_whole
from aeroservo.aircraft.planform import planform
from aeroservo.aircraft.schema_other import PitchPlungeFlap

#: Panels of the lattice: derivatives of the thesis wing are then within 1 % of their limits.
PANELS = VortexLattice(chordwise=24, spanwise=32)

_LEFT_OUT: tuple[tuple[str, float, str], ...] = (
    ("CL_deltadot", 0.0, "left out: a steady lattice has no rate of the elevon"),
    ("CM_deltadot", 0.0, "left out, the same"),
    ("S_hdelta", 0.0, "the file has no mass of the elevon"),
    ("S_thetadelta", 0.0, "the file has no mass of the elevon"),
)


@dataclass(frozen=True, kw_only=True)
class Taken:
    """One number of the model and where it comes from.

    Attributes
    ----------
    field : str
        Name in `[model]`, unit as suffix.
    value : float
        [unit in the name]
    source : str
        What it was taken from, one line.
    """

    field: str
    value: float
    source: str


def pitch_plunge_numbers(
    model: AircraftFile,
    *,
    pitch_axis: float | None = None,
    CM_alphadot: float = 0.0,
    method: VortexLattice = PANELS,
) -> tuple[Taken, ...]:
    """Every number of the pitch-plunge-elevon model of an aircraft, with its source.

    Parameters
    ----------
    model : AircraftFile
        With `[[mass]]` and `[structure]`.
    pitch_axis : float, optional
        Distance of the pitch axis behind the origin of the file; default the flexural axis at the mean aerodynamic
        chord. [m]
    CM_alphadot : float
        Moment per rate of alpha with c/(2U), about the pitch axis: a steady lattice has none. [1/rad]
    method : VortexLattice
        Panels and Mach number.

    Returns
    -------
    numbers : tuple of Taken
        In the order of `[model]`.

    Raises
    ------
    ValueError
        If the file has no mass or no structure, or the pitch axis is not finite.

    References
    ----------
    Bramstång 2015, section 7.6; equations.md, "Binary wing" (E = diag(4EI/s^3, GJ/s) in the shapes (y/s)^2, y/s).

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> numbers = {x.field: x.value for x in pitch_plunge_numbers(read("thesis-uav"))}
    >>> round(numbers["K_h_N_m"]), round(numbers["K_theta_N_m_rad"], 1), round(numbers["CL_alpha"], 1)
    (1644, 413.2, 3.6)
    """
    surface, masses, structure = carrier(model), model.masses(), model.structure
    assert structure is not None  # carrier refused it
    if masses is None:
        raise ValueError("mass: the pitch-plunge model needs the aircraft's mass: give [[mass]] items")
    if pitch_axis is not None and not math.isfinite(pitch_axis):
        raise ValueError(f"pitch axis must be finite [m], got {pitch_axis}")
    mean = planform(surface)
    where = "given"
    if pitch_axis is None:
        y, axis = np.array([(s.y_m, s.flexural_axis) for s in structure.station]).T
        fraction = float(np.interp(mean.mac_y, y, axis))
        pitch_axis = mean.mac_x + fraction * mean.mac
        where = f"the flexural axis, {fraction:.4g} of the mean aerodynamic chord"
    r = replace(model.references(), x=pitch_axis)
    found = aircraft_lattice(model.surfaces(), r, method=method)
    d = found.derivatives
    lattice = f"vortex lattice, {len(found.solution.lattice)} panels, Mach {d.mach:g}"
    about = f"{lattice}, about x = {pitch_axis:.4g} m"
    controls = " + ".join(found.controls) or "none in the file"
    K_h, K_theta = _tip_springs(structure.station)
    ratios = () if model.damping is None or model.damping.modal is None else model.damping.modal.ratios
    zeta = [*ratios[:2], 0.0, 0.0][:2]
    damped = "[damping.modal] ratios of the file" if ratios else "the file has no [damping.modal]"
    rates, about_rates = f"{lattice}; rates with c/(2U)", f"{about}; rates with c/(2U)"
    no_rate = "a steady lattice has no rate of alpha"
    unsteady = f"left out: {no_rate} (an unsteady one has about -0.5 for a wing of aspect ratio 4)"
    x_cg, y_cg, z_cg = (float(x) for x in masses.cg)
    inertia = float(masses.about(np.array([pitch_axis, y_cg, z_cg]))[1, 1])
    rows: list[tuple[str, float, str]] = [
        ("m_kg", masses.mass, "[[mass]], the whole aircraft"),
        ("I_theta_kg_m2", inertia, f"[[mass]], about the pitch axis at x = {pitch_axis:.4g} m ({where})"),
        ("S_htheta_kg_m", masses.mass * (x_cg - pitch_axis), f"[[mass]]: centre of gravity at x = {x_cg:.4g} m"),
        ("K_h_N_m", K_h, "[structure] EI of one half wing in the shape (y/s)^2, sweep left out"),
        ("K_theta_N_m_rad", K_theta, "[structure] GJ of one half wing in the shape y/s, sweep left out"),
        ("S_m2", r.S, "reference area of the file"),
        ("c_m", r.c, "reference chord of the file"),
        ("l_m", 0.0, "alpha is taken at the pitch axis, as the lattice turns about it"),
        ("zeta_h", zeta[0], damped),
        ("zeta_theta", zeta[1], damped),
        ("CL_alpha", d.of("CL", "alpha"), lattice),
        ("CM_alpha", d.of("CM", "alpha"), about),
        ("CL_delta", sum(d.of("CL", name) for name in found.controls), f"{lattice}: {controls}"),
        ("CM_delta", sum(d.of("CM", name) for name in found.controls), f"{about}: {controls}"),
        ("CL_q", d.of("CL", "q"), rates),
        ("CM_q", d.of("CM", "q"), about_rates),
        ("CL_alphadot", 0.0, f"left out: {no_rate}"),
        ("CM_alphadot", CM_alphadot, "given" if CM_alphadot else unsteady),
        *_LEFT_OUT,
        ("CL0", d.of("CL", "steady"), f"{lattice}: camber and twist"),
        ("CM0", d.of("CM", "steady"), f"{about}: camber and twist"),
    ]
    return tuple(Taken(field=name, value=float(f"{value:.6g}"), source=source) for name, value, source in rows)


def pitch_plunge_text(model: AircraftFile, numbers: tuple[Taken, ...]) -> str:
    """The model file of kind `pitch_plunge_flap`, every number with its source beside it.

    Parameters
    ----------
    model : AircraftFile
        Where the numbers come from.
    numbers : tuple of Taken
        Of `pitch_plunge_numbers`.

    Returns
    -------
    text : str
        TOML.

    References
    ----------
    contract.md, kind "pitch_plunge_flap".

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> uav = read("thesis-uav")
    >>> pitch_plunge_text(uav, pitch_plunge_numbers(uav)).splitlines()[3]
    'kind = "pitch_plunge_flap"'
    """
    name = f"{model.name} pitch-plunge"[:200]
    quoted = name.replace("\\", "\\\\").replace('"', '\\"')
    rows = [f"{x.field} = {x.value!r}".ljust(32) + f"# {x.source}" for x in numbers]
    head = [
        f"# Pitch-plunge-elevon model of {model.name!r}: the whole aircraft, rigid, on the springs of one half wing",
        "# Plunge down, pitch nose up, lift up, elevon trailing edge down, x aft. SI units.",
        "schema_version = 1",
        'kind = "pitch_plunge_flap"',
        f'name = "{quoted}"',
        *([] if model.speeds_m_s is None else [f"speeds_m_s = {list(model.speeds_m_s)}"]),
        "",
        "[model]",
    ]
    return "\n".join([*head, *rows, ""])


def pitch_plunge_of(
    model: AircraftFile, *, pitch_axis: float | None = None, CM_alphadot: float = 0.0, method: VortexLattice = PANELS
) -> PitchPlungeFlap:
    """The pitch-plunge-elevon model of an aircraft, ready for `build`.

    Parameters
    ----------
    model : AircraftFile
        With `[[mass]]` and `[structure]`.
    pitch_axis : float, optional
        As `pitch_plunge_numbers`. [m]
    CM_alphadot : float
        As `pitch_plunge_numbers`. [1/rad]
    method : VortexLattice
        Panels and Mach number.

    Returns
    -------
    file : PitchPlungeFlap
        As `aeroservo.read` gives it.

    Raises
    ------
    ValueError
        As `pitch_plunge_numbers`.

    References
    ----------
    Bramstång 2015, section 7.6, as `pitch_plunge_numbers`.

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> pitch_plunge_of(read("thesis-uav")).kind
    'pitch_plunge_flap'
    """
    numbers = pitch_plunge_numbers(model, pitch_axis=pitch_axis, CM_alphadot=CM_alphadot, method=method)
    file = parse(pitch_plunge_text(model, numbers), Path("pitch-plunge.toml"))
    assert isinstance(file, PitchPlungeFlap)
    return file


def new_pitch_plunge(
    model: AircraftFile, file: str | os.PathLike[str], *, pitch_axis: float | None = None, force: bool = False
) -> Path:
    """Write the pitch-plunge-elevon model of an aircraft as a model file.

    Parameters
    ----------
    model : AircraftFile
        With `[[mass]]` and `[structure]`.
    file : str or path
        Where to.
    pitch_axis : float, optional
        As `pitch_plunge_numbers`. [m]
    force : bool
        Replace an existing file.

    Returns
    -------
    path : Path
        The file written, whole or not at all.

    Raises
    ------
    ModelFileError
        If the file exists and `force` is not set, or it cannot be written.

    References
    ----------
    contract.md, `new`.

    Examples
    --------
    >>> import tempfile
    >>> from aeroservo.aircraft.files import read
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     read(new_pitch_plunge(read("thesis-uav"), Path(folder) / "mine.toml")).kind
    'pitch_plunge_flap'
    """
    path = Path(file)
    if path.is_dir():
        raise ModelFileError(f"{path}: is a folder; give the name of the file to write")
    text = pitch_plunge_text(model, pitch_plunge_numbers(model, pitch_axis=pitch_axis))
    parse(text, path)  # what is written can be read
    try:
        write_whole(path, text.encode(), force=force)
    except FileExistsError:
        raise ModelFileError(f"{path}: exists already and is left as it is; --force replaces it") from None
    except OSError as error:
        raise ModelFileError(f"{path}: cannot be written: {error.strerror or error}") from None
    return path


def _tip_springs(stations: tuple[StructureStation, ...]) -> tuple[float, float]:
    """Stiffness of the tip in plunge [N/m] and twist [N m/rad]: integrals of EI (2/s^2)^2 and GJ/s^2 over the span."""
    s = stations[-1].y_m - stations[0].y_m
    EI = sum(0.5 * (a.EI_N_m2 + b.EI_N_m2) * (b.y_m - a.y_m) for a, b in pairwise(stations))
    GJ = sum(0.5 * (a.GJ_N_m2 + b.GJ_N_m2) * (b.y_m - a.y_m) for a, b in pairwise(stations))
    return 4.0 * EI / s**4, GJ / s**2
