"""What every kind of model file shares: strict tables, quantities with units, damping, the top of the file.

A model file is data only. The classes here check it (names, types, ranges, a few rules across fields) and know no
mechanics: building matrices from a file is `aeroelastic.build`'s work.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field, Strict, field_validator, model_validator

#: Newest version of the file format that this program reads.
SCHEMA_VERSION = 1
#: Largest magnitude that any physical number in a file may have, in its own unit.
HUGE = 1.0e15
#: Smallest positive number accepted where a number must be positive: below it rounding, not physics, decides.
TINY = 1.0e-15
#: Longest length accepted. [m]
LONGEST = 1.0e5

_STRICT = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)

#: A list of numbers in TOML, a tuple here.
Numbers = Annotated[tuple[float, ...], Strict(False)]
#: A list of strings in TOML, a tuple here.
Strings = Annotated[tuple[str, ...], Strict(False)]


def quantity(
    text: str,
    unit: str,
    *,
    default: Any = ...,
    gt: float | None = None,
    ge: float | None = None,
    lt: float | None = None,
    le: float | None = None,
) -> Any:
    """A number of a model file: what it is, its unit, and the range that is allowed.

    Parameters
    ----------
    text : str
        What the number means.
    unit : str
        Its unit, printed in brackets; "-" where it has none.
    default : optional
        Value where the file leaves it out; required if not given. [unit]
    gt, ge, lt, le : float, optional
        The range: greater than (0: at least `TINY`), at least, less than, at most. A side left out is limited to
        `HUGE`. [unit]

    Returns
    -------
    field : pydantic FieldInfo
        To be assigned to an attribute of a `Table`.

    References
    ----------
    Project convention: contract.md, "Model files (TOML)".

    Examples
    --------
    >>> quantity("chord", "m", gt=0.0).description
    'chord [m]'
    """
    if gt is None and ge is None:
        ge = -HUGE
    if gt == 0.0:
        gt, ge = None, TINY
    if lt is None and le is None:
        le = HUGE
    return Field(default, description=f"{text} [{unit}]", gt=gt, ge=ge, lt=lt, le=le)


class Table(BaseModel):
    """A table of a model file: unknown keys, wrong types, NaN and infinity are refused."""

    model_config = _STRICT


class Modal(Table):
    """`[damping.modal]`."""

    ratios: Numbers = Field(description="damping ratio of each mode, in order of frequency [-]", min_length=1)

    @field_validator("ratios")
    @classmethod
    def _in_range(cls, ratios: tuple[float, ...]) -> tuple[float, ...]:
        for ratio in ratios:
            if not 0.0 <= ratio < 1.0:
                raise ValueError(f"each ratio must be at least 0 and less than 1 [-], got {ratio:g}")
        return ratios


class Rayleigh(Table):
    """`[damping.rayleigh]`: D = alpha M + beta K."""

    alpha: float = quantity("factor of the mass matrix", "1/s", ge=0.0)
    beta: float = quantity("factor of the stiffness matrix", "s", ge=0.0)


class Hysteretic(Table):
    """`[damping.hysteretic]`: K becomes K (1 + i g), in frequency-domain methods only."""

    g: float = quantity("structural damping", "-", ge=0.0, lt=1.0)


class SectionViscous(Table):
    """`[damping.viscous]` of a section, per metre of span."""

    plunge_N_s_per_m2: float = quantity("damper in plunge, per metre", "N s/m^2", ge=0.0, default=0.0)
    pitch_N_s: float = quantity("damper in pitch, per metre", "N s", ge=0.0, default=0.0)


class WingViscous(Table):
    """`[damping.viscous]` of a wing, on its bending and torsion coordinates."""

    plunge_N_s_per_m: float = quantity("damper on bending (tip deflection)", "N s/m", ge=0.0, default=0.0)
    pitch_N_m_s: float = quantity("damper on torsion (tip twist)", "N m s/rad", ge=0.0, default=0.0)


_ONE_DAMPING = {"json_schema_extra": {"minProperties": 1, "maxProperties": 1}}


class _Damping(Table):
    modal: Modal | None = Field(None, description="a damping ratio for each mode")
    rayleigh: Rayleigh | None = Field(None, description="damping from mass and stiffness matrices")
    hysteretic: Hysteretic | None = Field(None, description="structural damping of frequency-domain methods")

    @model_validator(mode="after")
    def _exactly_one(self) -> _Damping:
        given = [name for name in type(self).model_fields if getattr(self, name) is not None]
        if len(given) != 1:
            names = ", ".join(f"[damping.{name}]" for name in type(self).model_fields)
            raise ValueError(f"[damping] needs exactly one of {names}; got {len(given)}: {', '.join(given) or 'none'}")
        return self


class SectionDamping(_Damping):
    """`[damping]` of a typical section: exactly one sub-table."""

    model_config = ConfigDict(**_STRICT, **_ONE_DAMPING)  # type: ignore[typeddict-item]
    viscous: SectionViscous | None = Field(None, description="dampers beside the springs, per metre of span")


class WingDamping(_Damping):
    """`[damping]` of a wing: exactly one sub-table."""

    model_config = ConfigDict(**_STRICT, **_ONE_DAMPING)  # type: ignore[typeddict-item]
    viscous: WingViscous | None = Field(None, description="dampers beside the springs")


class SpringNonlinearity(Table):
    """Springs that are not straight lines: force = K (c0 + c1 x + c2 x^2 ...) x outside a dead band."""

    plunge_stiffness_polynomial: Numbers = Field(
        (1.0,), description="coefficients c0, c1, c2 ... of the plunge spring [-, 1/m, 1/m^2 ...]", min_length=1
    )
    pitch_stiffness_polynomial: Numbers = Field(
        (1.0,), description="coefficients c0, c1, c2 ... of the pitch spring [-, 1/rad, 1/rad^2 ...]", min_length=1
    )
    freeplay_rad: float = quantity("half width of the dead band in pitch", "rad", ge=0.0, le=1.6, default=0.0)


class FileModel(Table):
    """The top of every model file; one subclass for each `kind`."""

    description: ClassVar[str] = ""

    schema_version: int = Field(1, description="version of the file format; absent means 1 [-]", ge=1)
    kind: str = Field(description="kind of model")
    name: str = Field("", description="name of the model, for headings and results", max_length=200)
    speeds_m_s: Annotated[tuple[float, float, float], Strict(False)] | None = Field(
        None, description="default sweep of true airspeed: lowest, highest, step [m/s]"
    )

    @field_validator("schema_version")
    @classmethod
    def _not_newer(cls, version: int) -> int:
        if version > SCHEMA_VERSION:
            raise ValueError(
                f"this file is of schema version {version}, newer than the {SCHEMA_VERSION} that this program reads: "
                "use a newer aeroservo"
            )
        return version

    @field_validator("name")
    @classmethod
    def _one_line(cls, name: str) -> str:
        if not name.isprintable():
            raise ValueError("the name must be one line of printable characters")
        return name

    @field_validator("speeds_m_s")
    @classmethod
    def _sweep(cls, speeds: tuple[float, float, float] | None) -> tuple[float, float, float] | None:
        return None if speeds is None else checked_speeds(speeds)

    def problems(self) -> tuple[str, ...]:
        """Findings that do not stop a computation.

        Returns
        -------
        problems : tuple of str
            One sentence each; empty where nothing is odd.

        References
        ----------
        Project convention: contract.md, `check`.

        Examples
        --------
        >>> from aeroservo.aircraft.files import read
        >>> read("goland").problems()
        ()
        """
        return ()

    def derived(self) -> dict[str, Any]:
        """Numbers that follow from the file by arithmetic alone, for `aeroservo check`.

        Returns
        -------
        derived : dict of str to number
            Each key carries its unit. [SI]

        References
        ----------
        Project convention: contract.md, `check`.

        Examples
        --------
        >>> from aeroservo.aircraft.files import read
        >>> read("goland").derived()["semi_span_m"]
        6.096
        """
        return {}


def checked_speeds(speeds: tuple[float, float, float]) -> tuple[float, float, float]:
    """A sweep of airspeeds (lowest, highest, step), or an error that says what is wrong with it.

    Parameters
    ----------
    speeds : tuple of float, length 3
        Lowest, highest, step. [m/s]

    Returns
    -------
    speeds : tuple of float, length 3
        The same. [m/s]

    Raises
    ------
    ValueError
        Unless 0 < lowest <= highest <= 10,000 m/s, the step is positive and there are at most 1,000,000 speeds.

    References
    ----------
    Project convention: contract.md, "Common options".

    Examples
    --------
    >>> checked_speeds((1.0, 350.0, 1.0))
    (1.0, 350.0, 1.0)
    """
    low, high, step = speeds
    if not 0.0 < low <= high <= 1.0e4:
        raise ValueError(f"speeds must satisfy 0 < MIN <= MAX <= 10000 [m/s], got MIN = {low:g}, MAX = {high:g}")
    if not 0.0 < step < float("inf"):
        raise ValueError(f"the step of speeds must be positive [m/s], got {step:g}")
    if (high - low) / step > 1.0e6:
        raise ValueError(f"speeds {low:g}:{high:g}:{step:g} are more than 1,000,000: take a larger step")
    return speeds


def positive_definite(mass: float, inertia: float, static_moment: float, where: str, units: str) -> None:
    """Refuse a mass, inertia and static moment that no body can have.

    Parameters
    ----------
    mass, inertia, static_moment : float
        Of one body, the last two about the same axis. [`units`]
    where : str
        What to call the body in the error.
    units : str
        Unit of mass x inertia, for the message.

    Raises
    ------
    ValueError
        Unless mass x inertia > static moment squared.

    References
    ----------
    Parallel-axis theorem: the inertia about the centre of gravity, I - S^2/m, must be positive.

    Examples
    --------
    >>> positive_definite(2.0, 1.0, 1.0, "section", "kg^2")
    """
    if not mass * inertia > static_moment**2:
        raise ValueError(
            f"mass matrix of the {where} is not positive definite: mass x inertia = {mass * inertia:g} must be greater "
            f"than static moment squared = {static_moment**2:g} [{units}]; is the inertia about the flexural axis?"
        )
