"""Model files of kinds `binary_wing` and `whole_aircraft`: the rectangular half wing with two assumed shapes."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, Strict, model_validator

from aeroservo.aircraft.schema_base import LONGEST, FileModel, Table, WingDamping, quantity
from aeroservo.aircraft.schema_material import ViscoelasticTable, material_notes
from aeroservo.aircraft.schema_servo import Actuator, WingSensor, check_servo

_EI = "bending stiffness EI instead of the plunge spring: K_h = 4 EI/s^3"
_GJ = "torsion stiffness GJ instead of the pitch spring: K_theta = GJ/s"


class Elevon(Table):
    """`[wing.elevon]`: section derivatives of an elevon over the whole span."""

    lift_per_rad: float = quantity("lift slope a_c of the section, trailing edge down", "1/rad", ge=-100.0, le=100.0)
    moment_per_rad: float = quantity(
        "moment slope b_c of the section about the flexural axis, nose up", "1/rad", ge=-100.0, le=100.0
    )


class Wing(Table):
    """`[wing]` of a binary wing: clamped at the root, bending as (y/s)^2, twist as y/s."""

    semi_span_m: float = quantity("semi-span along the flexural axis", "m", gt=0.0, le=LONGEST)
    chord_m: float = quantity("chord normal to the flexural axis", "m", gt=0.0, le=LONGEST)
    flexural_axis: float = quantity("flexural axis x_f/c from the leading edge", "-", ge=0.0, le=1.0)
    mass_kg_per_m2: float = quantity("mass per area, uniform", "kg/m^2", gt=0.0)
    plunge_stiffness_N_per_m: float | None = quantity("bending spring K_h at the tip", "N/m", gt=0.0, default=None)
    EI_N_m2: float | None = quantity(_EI, "N m^2", gt=0.0, default=None)
    pitch_stiffness_N_m: float | None = quantity("torsion spring K_theta", "N m/rad", gt=0.0, default=None)
    GJ_N_m2: float | None = quantity(_GJ, "N m^2", gt=0.0, default=None)
    lift_slope_per_rad: float = quantity("slope a_w of the wing's lift", "1/rad", gt=0.0, le=100.0)
    eccentricity: float | None = quantity(
        "e, flexural axis behind the aerodynamic centre in chords; default flexural_axis - 1/4",
        "-",
        ge=-2.0,
        le=2.0,
        default=None,
    )
    moment_rate_derivative: float = quantity(
        "M_thetadot of quasi_steady_damped", "-", ge=-100.0, le=100.0, default=-1.2
    )
    leading_edge_mass_kg_per_m: float = quantity("strip mass along the leading edge", "kg/m", ge=0.0, default=0.0)
    sweep_deg: float = quantity("sweep of the flexural axis, positive aft", "deg", ge=-80.0, le=80.0, default=0.0)
    elevon: Elevon | None = Field(None, description="elevon over the whole span")

    @property
    def K_h(self) -> float:
        """Bending spring, given or 4 EI/s^3. [N/m]"""
        if self.plunge_stiffness_N_per_m is not None:
            return self.plunge_stiffness_N_per_m
        return 4.0 * float(self.EI_N_m2 or 0.0) / self.semi_span_m**3

    @property
    def K_theta(self) -> float:
        """Torsion spring, given or GJ/s. [N m/rad]"""
        if self.pitch_stiffness_N_m is not None:
            return self.pitch_stiffness_N_m
        return float(self.GJ_N_m2 or 0.0) / self.semi_span_m

    @property
    def e(self) -> float:
        """Flexural axis behind the aerodynamic centre, given or x_f/c - 1/4. [-]"""
        return self.flexural_axis - 0.25 if self.eccentricity is None else self.eccentricity

    @property
    def a(self) -> float:
        """Theodorsen's a, always from the flexural axis. [-]"""
        return 2.0 * self.flexural_axis - 1.0

    @model_validator(mode="after")
    def _one_of_each(self) -> Wing:
        for spring, beam in (("plunge_stiffness_N_per_m", "EI_N_m2"), ("pitch_stiffness_N_m", "GJ_N_m2")):
            given = [name for name in (spring, beam) if getattr(self, name) is not None]
            if len(given) != 1:
                raise ValueError(f"give exactly one of {spring} and {beam}; got {' and '.join(given) or 'neither'}")
        return self


class AircraftWing(Wing):
    """`[wing]` of a whole aircraft: the binary wing and half of the centre body, free to heave."""

    centre_mass_kg: float = quantity("rigid centre mass, per half", "kg", ge=0.0, default=0.0)


class _WingFile(FileModel):
    wing: Wing = Field(description="the half wing and its springs")
    damping: WingDamping | None = Field(None, description="structural damping")
    viscoelastic: ViscoelasticTable | None = Field(None, description="stiffness that relaxes")
    actuator: Actuator | None = Field(None, description="what moves the elevon")
    sensor: Annotated[tuple[WingSensor, ...], Strict(False)] = Field((), description="what is measured")

    @model_validator(mode="after")
    def _servo(self) -> _WingFile:
        check_servo(self.actuator, self.sensor, self.wing.elevon is not None, 0.0, self.wing.semi_span_m)
        return self

    def problems(self) -> tuple[str, ...]:
        """Findings that do not stop a computation: see `FileModel.problems`."""
        w = self.wing
        if abs(w.e - (w.flexural_axis - 0.25)) <= 1e-9:
            return material_notes(self.viscoelastic)
        return (
            f"wing.eccentricity = {w.e:g} disagrees with flexural_axis - 1/4 = {w.flexural_axis - 0.25:g}: "
            "Theodorsen's a is taken from flexural_axis, the quasi-steady forms take eccentricity",
            *material_notes(self.viscoelastic),
        )

    def derived(self) -> dict[str, Any]:
        """Area, masses, springs, eccentricity: see `FileModel.derived`."""
        w = self.wing
        mass = w.semi_span_m * (w.mass_kg_per_m2 * w.chord_m + w.leading_edge_mass_kg_per_m)
        derived = {
            "half_wing_area_m2": w.semi_span_m * w.chord_m,
            "aspect_ratio": 2.0 * w.semi_span_m / w.chord_m,
            "half_wing_mass_kg": mass,
            "plunge_stiffness_N_per_m": w.K_h,
            "pitch_stiffness_N_m": w.K_theta,
            "EI_N_m2": w.K_h * w.semi_span_m**3 / 4.0,
            "GJ_N_m2": w.K_theta * w.semi_span_m,
            "eccentricity": w.e,
            "theodorsen_a": w.a,
            "cos_sweep": math.cos(math.radians(w.sweep_deg)),
        }
        if isinstance(w, AircraftWing):
            derived["half_aircraft_mass_kg"] = mass + w.centre_mass_kg
        return derived


class BinaryWing(_WingFile):
    """A model file of kind `binary_wing`."""

    description: ClassVar[str] = "clamped rectangular half wing, one bending and one torsion shape"
    kind: Literal["binary_wing"] = Field(description="kind of model")


class WholeAircraft(_WingFile):
    """A model file of kind `whole_aircraft`."""

    description: ClassVar[str] = "the binary wing on a centre mass that is free to heave"
    kind: Literal["whole_aircraft"] = Field(description="kind of model")
    wing: AircraftWing = Field(description="the half wing, its springs and the centre mass")
