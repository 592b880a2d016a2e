"""The material of a model file: Prony series at the temperature of the structure."""

from __future__ import annotations

import numpy as np

from aeroservo.aircraft.schema_material import PronySeries, ViscoelasticTable
from aeroservo.structure.viscoelastic import TIMES, Prony, Viscoelastic, wlf_shift


def material(table: ViscoelasticTable | None) -> Viscoelastic | None:
    """How bending and torsion relax at the temperature of the file.

    Parameters
    ----------
    table : ViscoelasticTable, optional
        `[viscoelastic]` of a model file.

    Returns
    -------
    material : Viscoelastic or None
        None where the structure is elastic. Times are held between 1e-7 and 1e6 s, which no analysis can tell from
        "at once" and "never".

    Raises
    ------
    ValueError
        If the temperature is outside WLF.

    References
    ----------
    Williams, Landel, Ferry, J. Am. Chem. Soc. 77(14), 1955, Eq. 1; Bramstång 2015, section 7.8.

    Examples
    --------
    >>> series = PronySeries(ratios=(0.3,), times_s=(2.0,))
    >>> material(ViscoelasticTable(torsion=series)).torsion.relaxed
    0.7
    """
    if table is None:
        return None
    factor = 1.0
    if table.temperature_C is not None:
        assert table.reference_temperature_C is not None and table.wlf_C1 is not None and table.wlf_C2_K is not None
        factor = float(
            wlf_shift(table.temperature_C, reference=table.reference_temperature_C, C1=table.wlf_C1, C2=table.wlf_C2_K)
        )
    return Viscoelastic(bending=_series(table.bending, factor), torsion=_series(table.torsion, factor))


def _series(series: PronySeries | None, factor: float) -> Prony:
    """Shifted series; none is elastic."""
    if series is None:
        return Prony()
    return Prony(ratios=series.ratios, times=tuple(float(np.clip(factor * time, *TIMES)) for time in series.times_s))
