"""The table `[viscoelastic]` of model files: stiffness that relaxes with time and temperature."""

from __future__ import annotations

from pydantic import Field, model_validator

from aeroservo.aircraft.schema_base import Numbers, Table, quantity

_SHIFT = ("temperature_C", "reference_temperature_C", "wlf_C1", "wlf_C2_K")


class PronySeries(Table):
    """`[viscoelastic.bending]` or `[viscoelastic.torsion]`: a generalised Maxwell body."""

    ratios: Numbers = Field(description="parts of the instantaneous stiffness that relax [-]", min_length=1)
    times_s: Numbers = Field(description="relaxation time of each, at the reference temperature [s]", min_length=1)

    @model_validator(mode="after")
    def _series(self) -> PronySeries:
        if len(self.ratios) != len(self.times_s):
            raise ValueError(f"give one of times_s for each of ratios, got {len(self.times_s)} and {len(self.ratios)}")
        if min(self.ratios) <= 0.0 or sum(self.ratios) >= 1.0:
            raise ValueError(f"ratios must be positive and add up to less than 1 [-], got {list(self.ratios)}")
        if min(self.times_s) <= 0.0:
            raise ValueError(f"times_s must be positive [s], got {list(self.times_s)}")
        return self


class ViscoelasticTable(Table):
    """`[viscoelastic]`: how bending and torsion relax; stiffness elsewhere in the file is the instantaneous one."""

    bending: PronySeries | None = Field(None, description="of the plunge spring, or EI")
    torsion: PronySeries | None = Field(None, description="of the pitch spring, or GJ")
    temperature_C: float | None = quantity("temperature of the structure", "deg C", ge=-273.15, le=2e3, default=None)
    reference_temperature_C: float | None = quantity(
        "temperature at which times_s hold", "deg C", ge=-273.15, le=2e3, default=None
    )
    wlf_C1: float | None = quantity("first constant of WLF, for log10", "-", gt=0.0, le=1e3, default=None)
    wlf_C2_K: float | None = quantity("second constant of WLF", "K", gt=0.0, le=1e4, default=None)

    @model_validator(mode="after")
    def _complete(self) -> ViscoelasticTable:
        if self.bending is None and self.torsion is None:
            raise ValueError("give [viscoelastic.bending] or [viscoelastic.torsion], or both")
        given = [name for name in _SHIFT if getattr(self, name) is not None]
        if given and len(given) != len(_SHIFT):
            raise ValueError(f"a shift with temperature needs all of {', '.join(_SHIFT)}; got {', '.join(given)} alone")
        return self


def material_notes(table: ViscoelasticTable | None) -> tuple[str, ...]:
    """What a reader of results must know of a viscoelastic structure.

    Parameters
    ----------
    table : ViscoelasticTable, optional
        Of the file.

    Returns
    -------
    notes : tuple of str
        For `FileModel.problems`.

    References
    ----------
    Project convention: docs/contract.md, `check`.

    Examples
    --------
    >>> material_notes(None)
    ()
    """
    if table is None:
        return ()
    left = {name: 1.0 - sum(s.ratios) for name, s in (("bending", table.bending), ("torsion", table.torsion)) if s}
    parts = ", ".join(f"{100.0 * part:.4g} % of {name}" for name, part in left.items())
    return (
        f"viscoelastic: stiffness in the file is instantaneous (glassy), {parts} remains in the long run (relaxed); "
        "frequencies and modes are the glassy ones; divergence, reversal, twist and trim those of the relaxed wing",
    )
