"""Model files of kind `aircraft`: surfaces, controls, masses, and the structure along the span."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, Strict, model_validator

from aeroservo.aircraft.geometry import ControlSurface, LiftingSurface, ReferenceQuantities, WingSection
from aeroservo.aircraft.masses import MassItem, MassProperties, mass_properties, planform_mass
from aeroservo.aircraft.planform import planform, reference_quantities
from aeroservo.aircraft.schema_base import LONGEST, FileModel, Strings, Table, WingDamping, positive_definite, quantity
from aeroservo.aircraft.schema_material import ViscoelasticTable, material_notes
from aeroservo.aircraft.schema_servo import AircraftSensor, ControlActuator, names_differ

_Name = Annotated[str, Field(min_length=1, max_length=100, pattern=r"^[A-Za-z_][A-Za-z0-9_-]*$")]


class Section(Table):
    """`[[surface.section]]`: one streamwise section, from root to tip, straight lines between."""

    y_m: float = quantity("distance from the plane of symmetry, to starboard", "m", ge=-LONGEST, le=LONGEST)
    x_le_m: float = quantity("leading edge, aft", "m", ge=-LONGEST, le=LONGEST, default=0.0)
    z_le_m: float = quantity("leading edge, up", "m", ge=-LONGEST, le=LONGEST, default=0.0)
    chord_m: float = quantity("streamwise chord", "m", gt=0.0, le=LONGEST)
    twist_deg: float = quantity("incidence, nose up; washout is negative", "deg", gt=-90.0, lt=90.0, default=0.0)
    airfoil: str = Field("flat", description="shipped airfoil, naca2412 and the like, a file, or flat", max_length=300)

    def to_section(self) -> WingSection:
        """The section with its angle in radians."""
        return WingSection(
            y=self.y_m,
            x_le=self.x_le_m,
            z_le=self.z_le_m,
            chord=self.chord_m,
            twist=math.radians(self.twist_deg),
            airfoil=self.airfoil,
        )


class Control(Table):
    """`[[surface.control]]`: a trailing-edge control, positive trailing edge down."""

    name: _Name = Field(description="name of the control")
    from_span: float = quantity("inboard end, fraction of the surface's developed span", "-", ge=0.0, lt=1.0)
    to_span: float = quantity("outboard end, fraction of the surface's developed span", "-", gt=0.0, le=1.0)
    hinge_from: float = quantity("hinge line x/c at the inboard end", "-", ge=0.0, lt=1.0)
    hinge_to: float | None = quantity(
        "hinge line x/c at the outboard end; default the same", "-", ge=0.0, lt=1.0, default=None
    )
    kind: Literal["hinged", "morphed"] = Field("hinged", description="a sharp hinge, or smooth camber behind it")
    reading: Literal["same_drop", "same_slope"] = Field(
        "same_drop", description="a morphed control's deflection has the hinged one's trailing-edge drop, or end slope"
    )
    symmetric: float = quantity("share of the elevator command", "-", ge=-10.0, le=10.0, default=1.0)
    antisymmetric: float = quantity("share of the aileron command, starboard", "-", ge=-10.0, le=10.0, default=0.0)

    def to_control(self) -> ControlSurface:
        """The control of the geometry."""
        return ControlSurface(
            name=self.name,
            span_from=self.from_span,
            span_to=self.to_span,
            hinge_from=self.hinge_from,
            hinge_to=self.hinge_from if self.hinge_to is None else self.hinge_to,
            kind=self.kind,
            reading=self.reading,
            symmetric=self.symmetric,
            antisymmetric=self.antisymmetric,
        )


class Surface(Table):
    """`[[surface]]`: a lifting surface with its sections and controls."""

    name: _Name = Field(description="name of the surface")
    mirrored: bool = Field(True, description="whether a twin exists on the other side of y = 0")
    section: Annotated[tuple[Section, ...], Strict(False)] = Field(description="sections, root to tip", min_length=2)
    control: Annotated[tuple[Control, ...], Strict(False)] = Field((), description="controls")

    def to_surface(self) -> LiftingSurface:
        """The surface of the geometry."""
        return LiftingSurface(
            name=self.name,
            mirrored=self.mirrored,
            sections=tuple(s.to_section() for s in self.section),
            controls=tuple(c.to_control() for c in self.control),
        )

    @model_validator(mode="after")
    def _sound(self) -> Surface:
        self.to_surface()
        return self


class Mass(Table):
    """`[[mass]]`: a lump, or a mass spread evenly over a surface's planform."""

    name: str = Field(description="name of the item", min_length=1, max_length=100)
    mass_kg: float = quantity("mass; of a surface with its twin where spread_over is given", "kg", ge=0.0)
    spread_over: str = Field("", description="surface over whose planform the mass is spread evenly")
    x_m: float = quantity("centre of gravity, aft", "m", ge=-LONGEST, le=LONGEST, default=0.0)
    y_m: float = quantity("centre of gravity, to starboard", "m", ge=-LONGEST, le=LONGEST, default=0.0)
    z_m: float = quantity("centre of gravity, up", "m", ge=-LONGEST, le=LONGEST, default=0.0)
    Ixx_kg_m2: float = quantity("own inertia in roll", "kg m^2", ge=0.0, default=0.0)
    Iyy_kg_m2: float = quantity("own inertia in pitch", "kg m^2", ge=0.0, default=0.0)
    Izz_kg_m2: float = quantity("own inertia in yaw", "kg m^2", ge=0.0, default=0.0)
    mirrored: bool = Field(False, description="whether a twin exists at -y")

    def to_item(self, surfaces: tuple[LiftingSurface, ...]) -> MassItem:
        """The lump, or the lamina of the surface it is spread over."""
        if self.spread_over:
            surface = next(s for s in surfaces if s.name == self.spread_over)
            return planform_mass(surface, self.mass_kg, name=self.name)
        return MassItem(
            name=self.name,
            mass=self.mass_kg,
            position=np.array([self.x_m, self.y_m, self.z_m]),
            inertia=np.diag([self.Ixx_kg_m2, self.Iyy_kg_m2, self.Izz_kg_m2]),
            mirrored=self.mirrored,
        )


class Reference(Table):
    """`[reference]`: what coefficients refer to; what is left out comes from the first surface."""

    S_m2: float | None = quantity("area", "m^2", gt=0.0, default=None)
    c_m: float | None = quantity("chord", "m", gt=0.0, default=None)
    b_m: float | None = quantity("span", "m", gt=0.0, default=None)
    x_m: float | None = quantity("moment point, aft; default the quarter mean chord", "m", default=None)
    z_m: float | None = quantity("moment point, up", "m", default=None)


class StructureStation(Table):
    """`[[structure.station]]`: the half wing's beam at one place of the span, linear between stations."""

    y_m: float = quantity("distance from the plane of symmetry", "m", ge=0.0, le=LONGEST)
    flexural_axis: float = quantity("flexural axis x/c", "-", ge=0.0, le=1.0)
    cg_axis: float = quantity("mass axis x/c", "-", ge=-10.0, le=10.0)
    mass_kg_per_m: float = quantity("mass per metre of span", "kg/m", gt=0.0)
    inertia_kg_m: float = quantity("moment of inertia about the flexural axis, per metre", "kg m", gt=0.0)
    EI_N_m2: float = quantity("bending stiffness EI", "N m^2", gt=0.0)
    GJ_N_m2: float = quantity("torsion stiffness GJ", "N m^2", gt=0.0)


class Structure(Table):
    """`[structure]`: the beam inside one surface, its root clamped or free."""

    surface: str = Field(description="surface that the beam carries")
    root: Literal["clamped", "free"] = Field("clamped", description="how the root is held")
    symmetry: Literal["symmetric", "antisymmetric"] = Field(
        "symmetric", description="motion of the other half, root free"
    )
    station: Annotated[tuple[StructureStation, ...], Strict(False)] = Field(description="root to tip", min_length=2)

    @model_validator(mode="after")
    def _ascending(self) -> Structure:
        y = [s.y_m for s in self.station]
        if any(b <= a for a, b in pairwise(y)):
            raise ValueError(f"stations must ascend in y_m [m], got {y}")
        return self


class AircraftFile(FileModel):
    """A whole aircraft: surfaces, masses, structure; see docs for a commented example (`aeroservo new thesis-uav`)."""

    description: ClassVar[str] = "surfaces with controls, masses, and the structure along the span"

    kind: Literal["aircraft"] = Field(description="kind of model")
    assumptions: Strings = Field((), description="what the source left open and this file assumes, one sentence each")
    surface: Annotated[tuple[Surface, ...], Strict(False)] = Field(description="lifting surfaces", min_length=1)
    mass: Annotated[tuple[Mass, ...], Strict(False)] = Field((), description="mass items")
    reference: Reference = Field(Reference(), description="what coefficients refer to")
    structure: Structure | None = Field(None, description="beam along the span of one surface")
    damping: WingDamping | None = Field(None, description="structural damping")
    viscoelastic: ViscoelasticTable | None = Field(None, description="stiffness that relaxes")
    actuator: Annotated[tuple[ControlActuator, ...], Strict(False)] = Field((), description="what moves the controls")
    sensor: Annotated[tuple[AircraftSensor, ...], Strict(False)] = Field((), description="what is measured")

    def surfaces(self) -> tuple[LiftingSurface, ...]:
        """The lifting surfaces as geometry."""
        return tuple(s.to_surface() for s in self.surface)

    def masses(self) -> MassProperties | None:
        """Mass, centre of gravity and inertia; None where the file has no mass items."""
        if not self.mass:
            return None
        surfaces = self.surfaces()
        return mass_properties([m.to_item(surfaces) for m in self.mass])

    def references(self) -> ReferenceQuantities:
        """Reference area, chord, span and moment point."""
        own = reference_quantities(self.surface[0].to_surface())
        r = self.reference
        return ReferenceQuantities(
            S=own.S if r.S_m2 is None else r.S_m2,
            c=own.c if r.c_m is None else r.c_m,
            b=own.b if r.b_m is None else r.b_m,
            x=own.x if r.x_m is None else r.x_m,
            z=own.z if r.z_m is None else r.z_m,
        )

    def problems(self) -> tuple[str, ...]:
        """Assumptions of the file, a missing mass, and what the elastic wing takes from where."""
        found = [f"assumed: {text}" for text in self.assumptions]
        if self.structure is not None:
            found += self._elastic_wing(self.structure)
        if not self.mass:
            found.append("no [[mass]] items: centre of gravity and inertia are unknown")
        return (*found, *material_notes(self.viscoelastic))

    def _elastic_wing(self, structure: Structure) -> list[str]:
        """Sources of the beam and its strips, and masses that do not agree."""
        surface = next(s for s in self.surface if s.name == structure.surface)
        found = [
            f"elastic wing: beam from [structure], in {surface.name!r} only; strips normal to its flexural axis, with "
            "lift slopes, built-in incidence and moment, and control derivatives from the span loading of the lattice "
            "(steady, Mach 0), aerodynamic centres at the quarter chord; slopes are those of the lattice in roll "
            "for roll and for antisymmetric motion of a free root, else those of uniform incidence"
        ]
        if any(s.z_le_m != surface.section[0].z_le_m for s in surface.section):
            found.append(f"elastic wing: {surface.name!r} has dihedral, of which only the developed length is kept")
        beam = sum(
            0.5 * (a.mass_kg_per_m + b.mass_kg_per_m) * (b.y_m - a.y_m) for a, b in pairwise(structure.station)
        ) * (2.0 if surface.mirrored else 1.0)
        spread = sum(m.mass_kg for m in self.mass if m.spread_over == surface.name)
        if spread > 0.0 and abs(beam - spread) > 0.01 * spread:
            found.append(
                f"elastic wing: structure.station adds up to {beam:.4g} kg on both sides, the mass spread over "
                f"{surface.name!r} is {spread:.4g} kg: flutter takes the first, flight mechanics the second"
            )
        lone = [m.name for m in self.mass if not m.spread_over and m.y_m != 0.0 and not m.mirrored]
        if lone:
            found.append(f"elastic wing: masses on one side only are left out of the half wing: {', '.join(lone)}")
        return found

    def derived(self) -> dict[str, Any]:
        """Planforms, reference quantities, mass, centre of gravity, inertia: see `FileModel.derived`."""
        out: dict[str, Any] = {}
        for surface in self.surfaces():
            p, key = planform(surface), surface.name
            out |= {
                f"{key}_area_m2": p.area,
                f"{key}_span_m": p.span,
                f"{key}_mac_m": p.mac,
                f"{key}_mac_y_m": p.mac_y,
                f"{key}_mac_x_m": p.mac_x,
                f"{key}_aspect_ratio": p.aspect_ratio,
                f"{key}_taper": p.taper,
                f"{key}_sweep_leading_edge_deg": math.degrees(p.sweep_leading_edge),
                f"{key}_sweep_quarter_chord_deg": math.degrees(p.sweep_quarter_chord),
                f"{key}_dihedral_deg": math.degrees(p.dihedral),
            }
        r = self.references()
        out |= {"reference_area_m2": r.S, "reference_chord_m": r.c, "reference_span_m": r.b, "moment_point_x_m": r.x}
        m = self.masses()
        if m is not None:
            about = m.about(np.array([r.x, 0.0, r.z]))
            out |= {
                "mass_kg": m.mass,
                "cg_x_m": float(m.cg[0]),
                "cg_y_m": float(m.cg[1]),
                "cg_z_m": float(m.cg[2]),
                "Ixx_kg_m2": float(m.inertia[0, 0]),
                "Iyy_kg_m2": float(m.inertia[1, 1]),
                "Izz_kg_m2": float(m.inertia[2, 2]),
                "Ixz_kg_m2": float(-m.inertia[0, 2]),
                "Iyy_about_moment_point_kg_m2": float(about[1, 1]),
            }
        return out

    @model_validator(mode="after")
    def _consistent(self) -> AircraftFile:
        names = [s.name for s in self.surface]
        if len(set(names)) != len(names):
            raise ValueError(f"names of surfaces must differ, got {names}")
        controls = [c.name for s in self.surface for c in s.control]
        if len(set(controls)) != len(controls):
            raise ValueError(f"names of controls must differ, got {controls}")
        for item in self.mass:
            if item.spread_over and item.spread_over not in names:
                raise ValueError(
                    f"mass {item.name!r}: spread_over must name a surface, got {item.spread_over!r}; there are {names}"
                )
        if self.structure is not None:
            self._check_structure(self.structure)
        self._check_servo(controls)
        return self

    def _check_servo(self, controls: list[str]) -> None:
        """Reject actuators of unknown controls, sensors of one name, and sensors off the elastic wing."""
        names_differ([s.name for s in self.sensor], "sensor names")
        names_differ([a.control for a in self.actuator], "controls of actuators")
        for a in self.actuator:
            if a.control not in controls:
                raise ValueError(f"actuator: control must be one of {controls}, got {a.control!r}")
        if self.structure is not None:
            first, last = self.structure.station[0].y_m, self.structure.station[-1].y_m
            for i, s in enumerate(self.sensor):
                if not first <= s.y_m <= last:
                    raise ValueError(
                        f"sensor[{i}].y_m must lie on the wing, from {first:g} to {last:g} [m], got {s.y_m:g}"
                    )

    def _check_structure(self, structure: Structure) -> None:
        """Reject a beam that is not of this aircraft, or whose mass is no mass."""
        chosen = [s for s in self.surface if s.name == structure.surface]
        if not chosen:
            names = ", ".join(s.name for s in self.surface)
            raise ValueError(f"structure.surface must name a surface ({names}), got {structure.surface!r}")
        y, chord = [s.y_m for s in chosen[0].section], [s.chord_m for s in chosen[0].section]
        first, last = structure.station[0].y_m, structure.station[-1].y_m
        if abs(first - y[0]) > 1e-6 or abs(last - y[-1]) > 1e-6:
            raise ValueError(
                f"structure.station must run from root to tip of {structure.surface!r}, y_m = {y[0]:g} to "
                f"{y[-1]:g} [m], got {first:g} to {last:g}"
            )
        for s in structure.station:
            local = float(np.interp(s.y_m, y, chord))
            static = s.mass_kg_per_m * (s.cg_axis - s.flexural_axis) * local
            positive_definite(s.mass_kg_per_m, s.inertia_kg_m, static, f"structure.station at y_m = {s.y_m:g}", "kg^2")


def with_airfoils(model: FileModel, folder: Path) -> FileModel:
    """The aircraft with the paths of airfoil files that lie beside its own file, as they can be opened.

    Parameters
    ----------
    model : FileModel
        An `AircraftFile`.
    folder : Path
        Where its file lies.

    Returns
    -------
    model : FileModel
        The same with paths in place of bare names of files.

    References
    ----------
    Project convention: contract.md, kind "aircraft".

    Examples
    --------
    >>> from aeroservo.aircraft.files import read
    >>> with_airfoils(read("thesis-uav"), Path(".")).name
    'thesis-uav'
    """
    assert isinstance(model, AircraftFile)
    found = []
    for surface in model.surface:
        sections = tuple(
            s.model_copy(update={"airfoil": str(folder / s.airfoil)})
            if Path(s.airfoil).suffix and (folder / s.airfoil).is_file()
            else s
            for s in surface.section
        )
        found.append(surface.model_copy(update={"section": sections}))
    return model.model_copy(update={"surface": tuple(found)})
