"""The lattice that the three-dimensional view draws: patches of points, and how each coordinate moves them.

Every kind of model has one. An aircraft is drawn as its surfaces; a beam, an assumed-mode wing as its half (both halves
where the model is free); a section or a pitch-and-plunge wing as a plate of its chord and of the span that its area
gives. Sections stay rigid: a point d from the flexural axis moves with the deflection and the rotation that the modes
have at its own y.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.aircraft.schema_base import FileModel
from aeroservo.aircraft.schema_beam import BeamWing
from aeroservo.aircraft.schema_other import PitchPlungeFlap
from aeroservo.aircraft.schema_section import TypicalSection
from aeroservo.aircraft.schema_wing import BinaryWing, WholeAircraft
from aeroservo.datatypes import AeroelasticModel, ModalModel

Array = NDArray[Any]

#: Points of a patch along the chord and along the half span.
ALONG, ACROSS = 7, 25
#: Where an elevon is drawn that a file gives no place for: behind this part of the chord.
HINGE = 0.75
#: Width of a section's plate, in chords.
PLATE = 2.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Patch:
    """A grid of points.

    Attributes
    ----------
    points : ndarray, shape (rows, cols, 3)
        Along the chord, across the span; x aft, y starboard, z up. [m]
    kind : {"wing", "control", "other"}
        What it is.
    side : int
        1 starboard, -1 port.
    control : str
        Name of the control, empty for what is fixed.
    """

    points: Array
    kind: Literal["wing", "control", "other"] = "wing"
    side: int = 1
    control: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class Lattice3D:
    """Points, and how they move.

    Attributes
    ----------
    patches : tuple of Patch
        What is drawn.
    names : tuple of str
        Coordinates of the structure, then controls.
    shapes : ndarray, shape (n_names, n_points, 3)
        Displacement per unit of each. [m per unit]
    """

    patches: tuple[Patch, ...]
    names: tuple[str, ...]
    shapes: Array

    @property
    def points(self) -> Array:
        """All points, shape (n_points, 3). [m]"""
        return np.concatenate([p.points.reshape(-1, 3) for p in self.patches])


def lattice3d(file: FileModel, model: AeroelasticModel) -> Lattice3D:
    """What is drawn of a model.

    Parameters
    ----------
    file : FileModel
        From `aeroservo.read`.
    model : AeroelasticModel
        Built from it.

    Returns
    -------
    lattice : Lattice3D
        Patches, and shapes named as the model's coordinates and controls. [m]

    Raises
    ------
    ValueError
        If the modes have no grid, so that nothing is known of where they move.
    """
    modes = model.modes
    if not len(modes.grid):
        raise ValueError("the modes of this model come without a grid: there is nothing to draw")
    patches = _patches(file, modes, any(i.kind == "control" for i in model.aero.inputs))
    points = np.concatenate([p.points.reshape(-1, 3) for p in patches])
    port = np.concatenate([np.full(p.points.shape[0] * p.points.shape[1], p.side < 0) for p in patches])
    other = np.concatenate([np.full(p.points.shape[0] * p.points.shape[1], p.kind == "other") for p in patches])
    shapes = [_carried(modes, j, points, port, other, _antisymmetric(file)) for j in range(modes.n)]
    controls = [model.aero.inputs[j].name for j in model.columns("control")]
    shapes += [_deflected(patches, name) for name in controls]
    return Lattice3D(patches=tuple(patches), names=(*modes.names, *controls), shapes=np.array(shapes))


def rigid_lattice(file: AircraftFile) -> Lattice3D:
    """Surfaces of an aircraft that does not bend.

    Parameters
    ----------
    file : AircraftFile
        With or without a structure.

    Returns
    -------
    lattice : Lattice3D
        Without shapes. [m]
    """
    return at_rest(tuple(_aircraft(file)))


def at_rest(patches: tuple[Patch, ...]) -> Lattice3D:
    """Patches that do not move.

    Parameters
    ----------
    patches : tuple of Patch
        What is drawn. [m]

    Returns
    -------
    lattice : Lattice3D
        Without shapes. [m]
    """
    count = sum(p.points.shape[0] * p.points.shape[1] for p in patches)
    return Lattice3D(patches=patches, names=(), shapes=np.zeros((0, count, 3)))


def _antisymmetric(file: FileModel) -> bool:
    root = file.structure if isinstance(file, AircraftFile) else file.wing if isinstance(file, BeamWing) else None
    return root is not None and root.root == "free" and root.symmetry == "antisymmetric"


def _carried(modes: ModalModel, j: int, points: Array, port: Array, other: Array, antisymmetric: bool) -> Array:
    """Displacement (n, 3) of points by coordinate j: translation and rotation at their own y."""
    order = np.argsort(modes.grid[:, 1], kind="stable")
    grid, phi = modes.grid[order], modes.phi[order, :, j]
    starboard = points * np.array([1.0, 1.0, 1.0])
    starboard[port, 1] *= -1.0
    y = np.where(other, grid[0, 1], starboard[:, 1])
    at = np.stack([np.interp(y, grid[:, 1], grid[:, k]) for k in range(3)], axis=-1)
    motion = np.stack([np.interp(y, grid[:, 1], phi[:, k]) for k in range(6)], axis=-1)
    if len(grid) == 1:
        at = np.broadcast_to(grid[0], points.shape).copy()
        at[:, 1] = starboard[:, 1]
    out = motion[:, :3] + np.cross(motion[:, 3:], starboard - at)
    out[port, 1] *= -1.0
    if antisymmetric:
        out[port] *= -1.0
        out[port, 1] *= -1.0
    return np.asarray(out)


def _deflected(patches: list[Patch], name: str) -> Array:
    """Displacement (n, 3) per radian of a control, trailing edge down, about the front edge of its patches."""
    from aeroservo.aeroelastic.aircraft_lattice import ANTISYMMETRIC

    plain = name.removesuffix(ANTISYMMETRIC)
    out = []
    for p in patches:
        down = np.zeros(p.points.shape)
        if p.control == plain:
            down[..., 2] = -(p.points[..., 0] - p.points[:1, :, 0])
            down *= p.side if name != plain else 1
        out.append(down.reshape(-1, 3))
    return np.concatenate(out)


def _patches(file: FileModel, modes: ModalModel, controlled: bool) -> list[Patch]:
    """Patches by kind of file."""
    if isinstance(file, AircraftFile):
        return _aircraft(file)
    grid = modes.grid[np.argsort(modes.grid[:, 1])]
    if isinstance(file, BeamWing):
        y = np.array([s.y_m for s in file.wing.station])
        return _along(file, grid, y, np.array([s.chord_m for s in file.wing.station]),
                      np.array([s.flexural_axis for s in file.wing.station]), file.wing.root == "free")  # fmt: skip
    if isinstance(file, BinaryWing | WholeAircraft):
        w = file.wing
        two, ends = np.ones(2), np.array([0.0, w.semi_span_m])
        return _along(file, grid, ends, w.chord_m * two, w.flexural_axis * two, isinstance(file, WholeAircraft))
    if isinstance(file, TypicalSection):
        s = file.section
        hinge = HINGE if s.flap is None else s.flap.hinge
        return _plate(s.chord_m, s.flexural_axis, PLATE * s.chord_m, "flap" if s.flap else "", hinge)
    if isinstance(file, PitchPlungeFlap):
        m = file.model
        axis = 0.25 + (m.CM_alpha / m.CL_alpha if m.CL_alpha else 0.0)
        return _plate(m.c_m, float(np.clip(axis, 0.0, 1.0)), m.S_m2 / m.c_m, "elevon" if controlled else "", HINGE)
    return _ribbon(grid)


def _grid(x: Array, y: Array, z: Array) -> Array:
    return np.stack(np.broadcast_arrays(x, y, z), axis=-1)


def _aircraft(file: AircraftFile) -> list[Patch]:
    """The surfaces of the file; those that carry no beam follow the root."""
    from aeroservo.aircraft.geometry import section_at

    carrier = file.surface[0].name if file.structure is None else file.structure.surface
    out = []
    for surface in file.surfaces():
        kind: Literal["wing", "other"] = "wing" if surface.name == carrier else "other"
        cuts = [0.0, 1.0, *(x for c in surface.controls for x in (c.span_from, c.span_to))]
        ends = np.unique(np.round(cuts, 9))
        for a, b in pairwise(ends):
            control = next((c for c in surface.controls if c.span_from <= 0.5 * (a + b) <= c.span_to), None)
            f = np.linspace(a, b, max(3, round(ACROSS * (b - a)) + 1))
            edge, chord, twist = section_at(surface, f)
            hinge: Any = 1.0
            if control is not None:
                share = np.clip((f - control.span_from) / (control.span_to - control.span_from), 0.0, 1.0)
                hinge = control.hinge_from + share * (control.hinge_to - control.hinge_from)
            for part, name in (((0.0, hinge), ""), ((hinge, 1.0), control.name if control else "")):
                if control is None and part[1] == 1.0 and part[0] == 1.0:
                    continue
                rows = max(2, round((ALONG - 1) * float(np.mean(part[1] - part[0]))) + 1)
                x = part[0] + np.linspace(0.0, 1.0, rows)[:, None] * (part[1] - part[0])
                points = edge + (x * chord)[..., None] * np.stack([0 * twist + 1.0, 0 * twist, -np.tan(twist)], axis=-1)
                for side in (1, -1) if surface.mirrored else (1,):
                    out.append(Patch(points=points * np.array([1.0, side, 1.0]), kind="control" if name else kind,
                                     side=side, control=name))  # fmt: skip
    return out


def _along(file: Any, grid: Array, y: Array, chord: Array, axis: Array, both: bool) -> list[Patch]:
    """A wing along the flexural axis of the grid; its chords at `y` along that axis are normal to it."""
    cos = float(np.cos(np.deg2rad(file.wing.sweep_deg)))
    at = np.linspace(0.0, 1.0, ACROSS)
    span = np.linspace(min(0.0, float(grid[0, 1])), float(grid[-1, 1]), ACROSS)
    foot = np.interp(span, grid[:, 1], grid[:, 0])
    foot = foot + np.where(span < grid[0, 1], (span - grid[0, 1]) * _slope(grid), 0.0)
    c, f = (np.interp(at, (y - y[0]) / (y[-1] - y[0]), v) for v in (chord / cos, axis))
    elevon = file.wing.elevon
    ends = [0.0, 1.0]
    if isinstance(file, BeamWing) and elevon is not None:
        ends = [(v - y[0]) / (y[-1] - y[0]) for v in (elevon.from_y_m, elevon.to_y_m)]
    out = []
    for a, b in pairwise(sorted({0.0, 1.0, *ends})):
        here = np.linspace(a, b, max(3, round(ACROSS * (b - a))))
        moving = elevon is not None and ends[0] <= 0.5 * (a + b) <= ends[1]
        yy, xf, cc, ff = (np.interp(here, at, v) for v in (span, foot, c, f))
        for low, high, name in ((0.0, HINGE, ""), (HINGE, 1.0, "elevon")) if moving else ((0.0, 1.0, ""),):
            x = np.linspace(low, high, max(2, round((ALONG - 1) * (high - low)) + 1))[:, None]
            points = _grid(xf + (x - ff) * cc, yy, np.zeros(1))
            for side in (1, -1) if both else (1,):
                mirrored = points * np.array([1.0, side, 1.0])
                out.append(Patch(points=mirrored, kind="control" if name else "wing", side=side, control=name))
    return out


def _slope(grid: Array) -> float:
    """dx/dy of the axis at its inner end."""
    return float((grid[1, 0] - grid[0, 0]) / (grid[1, 1] - grid[0, 1])) if len(grid) > 1 else 0.0


def _plate(chord: float, axis: float, span: float, control: str, hinge: float) -> list[Patch]:
    """A plate about its axis at x = 0."""
    y = np.linspace(-0.5 * span, 0.5 * span, 15)
    parts = [(0.0, hinge, ""), (hinge, 1.0, control)] if control else [(0.0, 1.0, "")]
    out = []
    for low, high, name in parts:
        x = np.linspace(low, high, max(3, round(ALONG * (high - low)) + 1))[:, None]
        points = _grid((x - axis) * chord, y, np.zeros(1))
        out.append(Patch(points=points, kind="control" if name else "wing", control=name))
    return out


def _ribbon(grid: Array) -> list[Patch]:
    """A narrow strip along grid points of which no more is known."""
    width = 0.08 * float(np.ptp(grid, axis=0).max()) or 0.5
    across = np.linspace(-0.5, 0.5, 3)[:, None, None] * np.array([width, 0.0, 0.0])
    points = grid if len(grid) > 1 else grid + np.array([[0.0, -0.5, 0.0], [0.0, 0.5, 0.0]])
    return [Patch(points=points[None] + across)]
