"""Model files of kinds `modal`, `pitch_plunge_flap` and `state_space`."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, PrivateAttr, Strict, field_validator, model_validator

from aeroservo.aircraft.schema_base import (
    LONGEST,
    FileModel,
    Numbers,
    SpringNonlinearity,
    Strings,
    Table,
    positive_definite,
    quantity,
)
from aeroservo.aircraft.schema_servo import Actuator, AxisSensor, ControlActuator, GridSensor, names_differ

if TYPE_CHECKING:
    from aeroservo.aircraft.modal_data import ModalData

Matrix = Annotated[tuple[Numbers, ...], Strict(False)]


class ModalTable(Table):
    """`[modal]`: where the user's own modes and air forces are."""

    data: str = Field(
        description="file of arrays, .npz or .mat, relative to the folder of the model file",
        min_length=5,
        max_length=4096,
    )

    @field_validator("data")
    @classmethod
    def _known_format(cls, data: str) -> str:
        if not data.lower().endswith((".npz", ".mat")):
            raise ValueError("the data file must end in .npz or .mat")
        if not data.isprintable():
            raise ValueError("the name of the data file must be printable characters")
        return data


class ModalFile(FileModel):
    """A model file of kind `modal`; `read` fills in `arrays`."""

    description: ClassVar[str] = "your own modes and air forces, from .npz or .mat (Nastran users start here)"

    kind: Literal["modal"] = Field(description="kind of model")
    modal: ModalTable = Field(description="the data file")
    actuator: Annotated[tuple[ControlActuator, ...], Strict(False)] = Field((), description="what moves the controls")
    sensor: Annotated[tuple[GridSensor, ...], Strict(False)] = Field((), description="what is measured")
    _arrays: ModalData | None = PrivateAttr(None)

    @property
    def arrays(self) -> ModalData:
        """The arrays of the data file.

        Returns
        -------
        arrays : ModalData
            Structure and air forces in the user's modes. [SI]

        Raises
        ------
        ValueError
            If this model was not made by `read`.
        """
        if self._arrays is None:
            raise ValueError("this model of kind 'modal' has no arrays yet: load it with aeroservo.read")
        return self._arrays

    @model_validator(mode="after")
    def _names_differ(self) -> ModalFile:
        names_differ([s.name for s in self.sensor], "sensor names")
        names_differ([a.control for a in self.actuator], "controls of actuators")
        return self

    def derived(self) -> dict[str, Any]:
        """Sizes of the arrays: see `FileModel.derived`."""
        x = self.arrays
        _, n_k, n, n_in = x.Q.shape
        return {
            "modes": n,
            "mode_names": list(x.mode_names),
            "inputs": n_in,
            "input_names": list(x.input_names),
            "reduced_frequencies": n_k,
            "mach": [float(mach) for mach in x.mach],
            "semi_chord_m": x.b_m,
            "grid_points": 0 if x.grid is None else len(x.grid),
        }


class PitchPlungeParameters(Table):
    """`[model]` of kind `pitch_plunge_flap`: rigid wing on two springs; rates of the derivatives with c/(2U)."""

    m_kg: float = quantity("mass", "kg", gt=0.0)
    I_theta_kg_m2: float = quantity("moment of inertia about the pitch axis", "kg m^2", gt=0.0)
    S_htheta_kg_m: float = quantity("static moment about the pitch axis, positive aft", "kg m", default=0.0)
    K_h_N_m: float = quantity("plunge spring", "N/m", ge=0.0)
    K_theta_N_m_rad: float = quantity("pitch spring", "N m/rad", ge=0.0)
    S_m2: float = quantity("reference area", "m^2", gt=0.0)
    c_m: float = quantity("reference chord", "m", gt=0.0, le=LONGEST)
    l_m: float = quantity("distance l of alpha's l theta_dot/U", "m", ge=-LONGEST, le=LONGEST, default=0.0)
    zeta_h: float = quantity("structural damping ratio in plunge", "-", ge=0.0, lt=1.0, default=0.0)
    zeta_theta: float = quantity("structural damping ratio in pitch", "-", ge=0.0, lt=1.0, default=0.0)
    CL_alpha: float = quantity("lift slope", "1/rad", ge=-1e3, le=1e3)
    CM_alpha: float = quantity("moment slope about the pitch axis", "1/rad", ge=-1e3, le=1e3)
    CL_delta: float = quantity("lift per elevon", "1/rad", ge=-1e3, le=1e3, default=0.0)
    CM_delta: float = quantity("moment per elevon about the pitch axis", "1/rad", ge=-1e3, le=1e3, default=0.0)
    CL_q: float = quantity("lift per pitch rate c/(2U)", "1/rad", ge=-1e3, le=1e3, default=0.0)
    CM_q: float = quantity("moment per pitch rate c/(2U)", "1/rad", ge=-1e3, le=1e3, default=0.0)
    CL_alphadot: float = quantity("lift per rate of alpha c/(2U)", "1/rad", ge=-1e3, le=1e3, default=0.0)
    CM_alphadot: float = quantity("moment per rate of alpha c/(2U)", "1/rad", ge=-1e3, le=1e3, default=0.0)
    CL_deltadot: float = quantity("lift per elevon rate c/(2U)", "1/rad", ge=-1e3, le=1e3, default=0.0)
    CM_deltadot: float = quantity("moment per elevon rate c/(2U)", "1/rad", ge=-1e3, le=1e3, default=0.0)
    S_hdelta: float = quantity("inertia coupling of plunge and elevon", "kg m", default=0.0)
    S_thetadelta: float = quantity("inertia coupling of pitch and elevon", "kg m^2", default=0.0)
    CL0: float = quantity("lift coefficient at alpha = 0", "-", ge=-100.0, le=100.0, default=0.0)
    CM0: float = quantity("moment coefficient at alpha = 0", "-", ge=-100.0, le=100.0, default=0.0)
    theta_trim_rad: float = quantity("pitch attitude of the trim", "rad", ge=-1.5, le=1.5, default=0.0)

    def lift_reversal(self, CM_delta: float) -> float | None:
        """Dynamic pressure at which the elevon gives no lift, q = K_theta CL_d/(S c (CM_a CL_d - CL_a CM_d)). [Pa]"""
        bottom = self.S_m2 * self.c_m * (self.CM_alpha * self.CL_delta - self.CL_alpha * CM_delta)
        top = self.K_theta_N_m_rad * self.CL_delta
        return top / bottom if top * bottom > 0.0 else None

    @model_validator(mode="after")
    def _masses(self) -> PitchPlungeParameters:
        positive_definite(self.m_kg, self.I_theta_kg_m2, self.S_htheta_kg_m, "model", "kg^2 m^2")
        return self


class Limits(Table):
    """`[limits]`: leaving them ends a simulation."""

    pitch_deg: float | None = quantity("largest pitch either way", "deg", gt=0.0, le=180.0, default=None)
    plunge_m: float | None = quantity("largest plunge either way", "m", gt=0.0, le=LONGEST, default=None)


class FlapNonlinearity(SpringNonlinearity):
    """`[nonlinear]` of kind `pitch_plunge_flap`: springs, and a tabulated lift curve."""

    CL_alpha_table: Matrix | None = Field(
        None, description="rows [alpha, CL] in ascending alpha [deg, -]", min_length=2
    )

    @field_validator("CL_alpha_table")
    @classmethod
    def _ascending(cls, table: tuple[tuple[float, ...], ...] | None) -> tuple[tuple[float, ...], ...] | None:
        if table is not None:
            if any(len(row) != 2 for row in table):
                raise ValueError("each row must be [alpha_deg, CL]")
            if any(after[0] <= before[0] for before, after in pairwise(table)):
                raise ValueError("alpha must ascend from row to row [deg]")
        return table


class Comparison(Table):
    """`[comparison]`: a moment per elevon from another source; `check` says what it would give, no more."""

    CM_delta: float = quantity("moment per elevon about the pitch axis", "1/rad", ge=-1e3, le=1e3)
    source: str = Field(description="where it comes from", min_length=1, max_length=200)


class PitchPlungeFlap(FileModel):
    """A model file of kind `pitch_plunge_flap`."""

    description: ClassVar[str] = "rigid wing on a plunge and a pitch spring, with the derivatives of the whole wing"

    kind: Literal["pitch_plunge_flap"] = Field(description="kind of model")
    model: PitchPlungeParameters = Field(description="masses, springs and derivatives")
    actuator: Actuator | None = Field(None, description="what moves the elevon")
    sensor: Annotated[tuple[AxisSensor, ...], Strict(False)] = Field((), description="what is measured")
    limits: Limits | None = Field(None, description="where a simulation ends")
    nonlinear: FlapNonlinearity | None = Field(None, description="springs and lift that are not straight lines")
    comparison: Comparison | None = Field(None, description="another source's moment per elevon, for `check` only")

    @model_validator(mode="after")
    def _names_differ(self) -> PitchPlungeFlap:
        names_differ([s.name for s in self.sensor], "sensor names")
        return self

    def derived(self) -> dict[str, Any]:
        """Uncoupled frequencies, offset of the mass, divergence and lift reversal: see `FileModel.derived`."""
        m = self.model
        found = {
            "uncoupled_plunge_rad_s": math.sqrt(m.K_h_N_m / m.m_kg),
            "uncoupled_pitch_rad_s": math.sqrt(m.K_theta_N_m_rad / m.I_theta_kg_m2),
            "mass_aft_of_pitch_axis_m": m.S_htheta_kg_m / m.m_kg,
            "divergence_pressure_Pa": m.K_theta_N_m_rad / (m.S_m2 * m.c_m * m.CM_alpha) if m.CM_alpha > 0.0 else None,
            "lift_reversal_pressure_Pa": m.lift_reversal(m.CM_delta),
        }
        if self.comparison is not None:
            other = m.lift_reversal(self.comparison.CM_delta)
            found |= {
                "comparison_CM_delta": self.comparison.CM_delta,
                "comparison_lift_reversal_pressure_Pa": other,
                "comparison_lift_reversal_sea_level_m_s": None if other is None else math.sqrt(2.0 * other / 1.225),
            }
        return found

    def problems(self) -> tuple[str, ...]:
        """Another source's moment per elevon, a stall curve that does not continue the slope: see `FileModel`."""
        m, notes = self.model, []
        if self.comparison is not None:
            own, other = m.lift_reversal(m.CM_delta), m.lift_reversal(self.comparison.CM_delta)
            if own is not None and other is not None:
                notes.append(
                    f"CM_delta = {m.CM_delta:g} reverses lift at {own:.0f} Pa; {self.comparison.source} has "
                    f"{self.comparison.CM_delta:g}, which would reverse it at {other:.0f} Pa, "
                    f"{math.sqrt(other / own):.3f} times that speed"
                )
        if self.nonlinear is not None and self.nonlinear.CL_alpha_table is not None:
            slope = _slope_at(self.nonlinear.CL_alpha_table, math.degrees(m.theta_trim_rad))
            if abs(slope - m.CL_alpha) > 0.05 * abs(m.CL_alpha):
                notes.append(
                    f"CL_alpha_table rises by {slope:.3g} 1/rad at the trim, CL_alpha is {m.CL_alpha:g}: linear "
                    "analyses use CL_alpha, simulations the table"
                )
        return tuple(notes)


class StateSpaceTable(Table):
    """`[model]` of kind `state_space`: x' = A x + B u, y = C x + D u at one flight condition."""

    A: Matrix = Field(description="state matrix, rows of numbers", min_length=1)
    B: Matrix = Field(description="input matrix, one row for each state", min_length=1)
    C: Matrix = Field(description="output matrix, one row for each output", min_length=1)
    D: Matrix = Field(description="direct matrix, one row for each output", min_length=1)
    states: Strings = Field(description="names of the states", min_length=1)
    inputs: Strings = Field(description="names of the inputs", min_length=1)
    outputs: Strings = Field(description="names of the outputs", min_length=1)
    speed_m_s: float = quantity("true airspeed at which the model holds", "m/s", gt=0.0, le=1e4)
    altitude_m: float = quantity("geopotential altitude at which it holds", "m", ge=-5e3, le=8e4)

    @model_validator(mode="after")
    def _shapes(self) -> StateSpaceTable:
        for what in ("states", "inputs", "outputs"):
            names_differ(getattr(self, what), what)
        n, n_u, n_y = len(self.states), len(self.inputs), len(self.outputs)
        for name, (rows, columns) in {"A": (n, n), "B": (n, n_u), "C": (n_y, n), "D": (n_y, n_u)}.items():
            matrix = getattr(self, name)
            if len(matrix) != rows or any(len(row) != columns for row in matrix):
                got = f"{len(matrix)} rows of {', '.join(sorted({str(len(row)) for row in matrix}))}"
                raise ValueError(f"{name} must be {rows} x {columns} (states, inputs, outputs), got {got}")
        return self


class StateSpaceFile(FileModel):
    """A model file of kind `state_space`."""

    description: ClassVar[str] = "a linear model at one flight condition"

    kind: Literal["state_space"] = Field(description="kind of model")
    model: StateSpaceTable = Field(description="the matrices, their names, where they hold")

    def derived(self) -> dict[str, Any]:
        """Sizes of the system: see `FileModel.derived`."""
        m = self.model
        return {"states": len(m.states), "inputs": len(m.inputs), "outputs": len(m.outputs)}


def _slope_at(table: tuple[tuple[float, ...], ...], alpha: float) -> float:
    """Slope of the table's part that holds an angle [deg], per radian."""
    rows = next((pair for pair in pairwise(table) if pair[0][0] <= alpha <= pair[1][0]), (table[0], table[0]))
    rise = rows[1][0] - rows[0][0]
    return (rows[1][1] - rows[0][1]) / math.radians(rise) if rise else 0.0
