"""Model files of kind `typical_section`: a rigid aerofoil on a plunge and a pitch spring, with or without a flap."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal

from pydantic import Field, model_validator

from aeroservo.aircraft.schema_base import (
    LONGEST,
    FileModel,
    SectionDamping,
    SpringNonlinearity,
    Table,
    positive_definite,
    quantity,
)
from aeroservo.aircraft.schema_material import ViscoelasticTable, material_notes


class SectionFlap(Table):
    """`[section.flap]`: a trailing-edge flap on a hinge spring, per metre of span."""

    hinge: float = quantity("hinge line x/c from the leading edge", "-", gt=0.0, lt=1.0)
    flap_static_moment_kg: float = quantity("static moment of the flap about its hinge, positive aft", "kg")
    flap_inertia_kg_m: float = quantity("moment of inertia of the flap about its hinge", "kg m", gt=0.0)
    hinge_stiffness_N: float = quantity("stiffness of the hinge spring", "N m/rad per m", ge=0.0)


class Section(Table):
    """`[section]`, per metre of span; h down, theta nose up, about the flexural axis."""

    chord_m: float = quantity("chord", "m", gt=0.0, le=LONGEST)
    flexural_axis: float = quantity("flexural axis x_f/c from the leading edge", "-", ge=0.0, le=1.0)
    mass_kg_per_m: float = quantity("mass per metre", "kg/m", gt=0.0)
    static_moment_kg: float = quantity("static moment m x_alpha b, positive for a centre of gravity aft", "kg")
    inertia_kg_m: float = quantity("moment of inertia about the flexural axis, per metre", "kg m", gt=0.0)
    plunge_stiffness_N_per_m2: float = quantity("plunge spring, per metre", "N/m^2", ge=0.0)
    pitch_stiffness_N: float = quantity("pitch spring, per metre", "N m/rad per m", ge=0.0)
    lift_slope_per_rad: float = quantity("slope of the lift", "1/rad", gt=0.0, le=100.0, default=2.0 * math.pi)
    moment_rate_derivative: float = quantity(
        "M_thetadot of quasi_steady_damped", "-", ge=-100.0, le=100.0, default=-1.2
    )
    flap: SectionFlap | None = Field(None, description="third degree of freedom")
    nonlinear: SpringNonlinearity | None = Field(None, description="springs that are not straight lines")

    @property
    def b(self) -> float:
        """Semi-chord. [m]"""
        return 0.5 * self.chord_m

    @property
    def e(self) -> float:
        """Flexural axis behind the quarter chord, x_f/c - 1/4. [-]"""
        return self.flexural_axis - 0.25

    @property
    def a(self) -> float:
        """Theodorsen's a, flexural axis behind mid-chord in semi-chords. [-]"""
        return 2.0 * self.flexural_axis - 1.0

    @property
    def cg_axis(self) -> float:
        """Centre of gravity x/c from the leading edge. [-]"""
        return self.flexural_axis + self.static_moment_kg / (self.mass_kg_per_m * self.chord_m)

    @model_validator(mode="after")
    def _masses(self) -> Section:
        positive_definite(self.mass_kg_per_m, self.inertia_kg_m, self.static_moment_kg, "section", "kg^2")
        if self.flap is not None:
            self._flap_masses(self.flap)
        return self

    def _flap_masses(self, flap: SectionFlap) -> None:
        m, inertia, S = self.mass_kg_per_m, self.inertia_kg_m, self.static_moment_kg
        S_f, I_f = flap.flap_static_moment_kg, flap.flap_inertia_kg_m
        cross = I_f + (flap.hinge - self.flexural_axis) * self.chord_m * S_f
        determinant = m * (inertia * I_f - cross**2) - S * (S * I_f - cross * S_f) + S_f * (S * cross - inertia * S_f)
        if not (m * I_f > S_f**2 and determinant > 0.0):
            raise ValueError(
                "mass matrix of section and flap is not positive definite: mass, static moments and inertias of the "
                f"flap (S = {S_f:g} kg, I = {I_f:g} kg m about the hinge) must fit inside those of the whole section"
            )


class TypicalSection(FileModel):
    """A model file of kind `typical_section`."""

    description: ClassVar[str] = "aerofoil on a plunge and a pitch spring, per metre of span"

    kind: Literal["typical_section"] = Field(description="kind of model")
    section: Section = Field(description="the aerofoil and its springs")
    damping: SectionDamping | None = Field(None, description="structural damping")
    viscoelastic: ViscoelasticTable | None = Field(None, description="stiffness that relaxes")

    @model_validator(mode="after")
    def _one_law(self) -> TypicalSection:
        if self.viscoelastic is not None and self.section.nonlinear is not None:
            raise ValueError("[viscoelastic] and [section.nonlinear] are two laws for one spring: leave one out")
        return self

    def problems(self) -> tuple[str, ...]:
        """Findings that do not stop a computation: see `FileModel.problems`."""
        cg = self.section.cg_axis
        if -1.0 <= cg <= 2.0:
            return material_notes(self.viscoelastic)
        return (
            f"section: the mass axis at x/c = {cg:.3g} is outside the chord by more than a chord",
            *material_notes(self.viscoelastic),
        )

    def derived(self) -> dict[str, Any]:
        """Semi-chord, offsets, radius of gyration, uncoupled frequencies: see `FileModel.derived`."""
        s = self.section
        omega_h = math.sqrt(s.plunge_stiffness_N_per_m2 / s.mass_kg_per_m)
        omega_theta = math.sqrt(s.pitch_stiffness_N / s.inertia_kg_m)
        return {
            "semi_chord_m": s.b,
            "eccentricity": s.e,
            "theodorsen_a": s.a,
            "cg_axis": s.cg_axis,
            "x_alpha": s.static_moment_kg / (s.mass_kg_per_m * s.b),
            "r_alpha_squared": s.inertia_kg_m / (s.mass_kg_per_m * s.b**2),
            "mass_ratio_sea_level": s.mass_kg_per_m / (math.pi * 1.225 * s.b**2),
            "uncoupled_plunge_Hz": omega_h / (2.0 * math.pi),
            "uncoupled_pitch_Hz": omega_theta / (2.0 * math.pi),
        }
