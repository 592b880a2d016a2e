"""Model files of kind `beam_wing`: a slender wing as a beam, stations along its flexural axis."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, Strict, model_validator

from aeroservo.aircraft.schema_base import LONGEST, FileModel, Table, WingDamping, positive_definite, quantity
from aeroservo.aircraft.schema_material import ViscoelasticTable, material_notes
from aeroservo.aircraft.schema_servo import Actuator, WingSensor, check_servo
from aeroservo.aircraft.schema_wing import Elevon

_SWEEP = "sweep of the panel outboard, positive aft; default the wing's"
_COUPLING = "bend-twist coupling stiffness"


class Station(Table):
    """`[[wing.station]]`: the wing's properties at one place, linear between stations."""

    y_m: float = quantity("distance from the root along the flexural axis", "m", ge=0.0, le=LONGEST)
    chord_m: float = quantity("chord normal to the flexural axis", "m", gt=0.0, le=LONGEST)
    flexural_axis: float = quantity("flexural axis x/c from the leading edge", "-", ge=0.0, le=1.0)
    cg_axis: float = quantity("mass axis x/c from the leading edge", "-", ge=-10.0, le=10.0)
    mass_kg_per_m: float = quantity("mass per metre", "kg/m", gt=0.0)
    inertia_kg_m: float = quantity("moment of inertia about the flexural axis, per metre", "kg m", gt=0.0)
    EI_N_m2: float = quantity("bending stiffness EI", "N m^2", gt=0.0)
    GJ_N_m2: float = quantity("torsion stiffness GJ", "N m^2", gt=0.0)
    sweep_deg: float | None = quantity(_SWEEP, "deg", ge=-80.0, le=80.0, default=None)
    coupling_N_m2: float = quantity(_COUPLING, "N m^2", default=0.0)
    incidence_deg: float = quantity("built-in incidence, nose up", "deg", ge=-45.0, le=45.0, default=0.0)
    cm0: float = quantity("moment coefficient of the section at no lift, nose up", "-", ge=-10.0, le=10.0, default=0.0)

    @property
    def static_moment_kg(self) -> float:
        """Static moment per metre about the flexural axis, positive aft. [kg]"""
        return self.mass_kg_per_m * (self.cg_axis - self.flexural_axis) * self.chord_m

    @model_validator(mode="after")
    def _physical(self) -> Station:
        where = f"station at y_m = {self.y_m:g}"
        positive_definite(self.mass_kg_per_m, self.inertia_kg_m, self.static_moment_kg, where, "kg^2")
        if not self.coupling_N_m2**2 < self.EI_N_m2 * self.GJ_N_m2:
            raise ValueError(
                f"coupling_N_m2 = {self.coupling_N_m2:g} must be smaller in magnitude than sqrt(EI GJ) = "
                f"{math.sqrt(self.EI_N_m2 * self.GJ_N_m2):g} [N m^2], or the beam has no stiffness left"
            )
        return self


class Lump(Table):
    """`[[wing.mass]]`: a rigid mass on the wing."""

    y_m: float = quantity("distance from the root along the flexural axis", "m", ge=0.0, le=LONGEST)
    x_m: float = quantity("distance of its centre of gravity aft of the flexural axis", "m", ge=-LONGEST, le=LONGEST)
    mass_kg: float = quantity("mass", "kg", ge=0.0)
    inertia_kg_m2: float = quantity("moment of inertia about its own centre of gravity", "kg m^2", ge=0.0, default=0.0)


class BeamElevon(Elevon):
    """`[wing.elevon]` of a beam wing: section derivatives over a part of the span."""

    from_y_m: float = quantity("inboard end along the flexural axis", "m", ge=0.0, le=LONGEST)
    to_y_m: float = quantity("outboard end along the flexural axis", "m", gt=0.0, le=LONGEST)


class BeamWingTable(Table):
    """`[wing]` of a beam wing."""

    root: Literal["clamped", "free"] = Field(description="how the root is held")
    symmetry: Literal["symmetric", "antisymmetric"] = Field(
        "symmetric", description="motion of the other half, where the root is free"
    )
    sweep_deg: float = quantity("sweep of the flexural axis, positive aft", "deg", ge=-80.0, le=80.0, default=0.0)
    lift_slope_per_rad: float = quantity(
        "slope of the lift of the section normal to the axis", "1/rad", gt=0.0, le=100.0, default=2.0 * math.pi
    )
    lift_slope_correction: Literal["none", "helmbold", "polhamus"] = Field(
        "none", description="correction of the lift slope for a finite span"
    )
    station: Annotated[tuple[Station, ...], Strict(False)] = Field(
        description="properties along the span, root to tip", min_length=2
    )
    mass: Annotated[tuple[Lump, ...], Strict(False)] = Field((), description="rigid masses on the wing")
    elevon: BeamElevon | None = Field(None, description="elevon over a part of the span")

    @model_validator(mode="after")
    def _along_the_span(self) -> BeamWingTable:
        y = [station.y_m for station in self.station]
        for i, (inner, outer) in enumerate(pairwise(y)):
            if not outer > inner:
                raise ValueError(
                    f"stations must be in ascending order of y_m [m]: station[{i + 1}] at {outer:g} does not lie "
                    f"outboard of station[{i}] at {inner:g}"
                )
        for i, lump in enumerate(self.mass):
            if not y[0] <= lump.y_m <= y[-1]:
                raise ValueError(
                    f"mass[{i}].y_m must lie on the wing, from {y[0]:g} to {y[-1]:g} [m], got {lump.y_m:g}"
                )
        if self.elevon is not None and not y[0] <= self.elevon.from_y_m < self.elevon.to_y_m <= y[-1]:
            raise ValueError(
                f"elevon: {y[0]:g} <= from_y_m < to_y_m <= {y[-1]:g} [m] must hold, got from_y_m = "
                f"{self.elevon.from_y_m:g}, to_y_m = {self.elevon.to_y_m:g}"
            )
        return self


class BeamWing(FileModel):
    """A model file of kind `beam_wing`."""

    description: ClassVar[str] = "slender wing as a beam in bending and torsion, clamped or free at its root"

    kind: Literal["beam_wing"] = Field(description="kind of model")
    wing: BeamWingTable = Field(description="the half wing")
    damping: WingDamping | None = Field(None, description="structural damping")
    viscoelastic: ViscoelasticTable | None = Field(None, description="stiffness that relaxes")
    actuator: Actuator | None = Field(None, description="what moves the elevon")
    sensor: Annotated[tuple[WingSensor, ...], Strict(False)] = Field((), description="what is measured")

    @model_validator(mode="after")
    def _servo(self) -> BeamWing:
        y = self.wing.station
        check_servo(self.actuator, self.sensor, self.wing.elevon is not None, y[0].y_m, y[-1].y_m)
        return self

    def problems(self) -> tuple[str, ...]:
        """Findings that do not stop a computation: see `FileModel.problems`."""
        found = [
            f"wing.station[{i}]: the mass axis at x/c = {s.cg_axis:g} is outside the chord by more than a chord"
            for i, s in enumerate(self.wing.station)
            if not -1.0 <= s.cg_axis <= 2.0
        ]
        if self.wing.root == "clamped" and "symmetry" in self.wing.model_fields_set:
            found.append("wing.symmetry says nothing about a clamped root and is not used")
        return (*found, *material_notes(self.viscoelastic))

    def derived(self) -> dict[str, Any]:
        """Span, area, mass of the half wing, its static moments: see `FileModel.derived`."""
        stations, lumps = self.wing.station, self.wing.mass
        span = stations[-1].y_m - stations[0].y_m
        area = _trapezium(stations, "chord_m")
        mass = _trapezium(stations, "mass_kg_per_m")
        return {
            "semi_span_m": span,
            "half_wing_area_m2": area,
            "aspect_ratio": 2.0 * span**2 / area,
            "half_wing_mass_kg": mass + sum(lump.mass_kg for lump in lumps),
            "structure_mass_kg": mass,
            "stations": len(stations),
        }


def _trapezium(stations: tuple[Station, ...], field: str) -> float:
    """Integral over the span of a field that is linear between stations. [unit of the field x m]"""
    return sum(0.5 * (getattr(a, field) + getattr(b, field)) * (b.y_m - a.y_m) for a, b in pairwise(stations))
