"""Monte Carlo over numbers of a model file: draws that depend on nothing but the seed and the number of the run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args
from zlib import crc32

import numpy as np

from aeroservo.aero.rational import fit_rational
from aeroservo.aeroelastic.build import build
from aeroservo.aircraft.overrides import override
from aeroservo.aircraft.schema_base import FileModel
from aeroservo.datatypes import AeroelasticModel, SampledAero
from aeroservo.simulate.montecarlo import Variant
from aeroservo.simulate.scenario import Scenario

Law = Literal["normal", "uniform"]

#: Sets the draws of parameters apart from the seeds of the runs.
_STREAM = 0x7061


@dataclass(frozen=True, kw_only=True)
class Spread:
    """How one number of a model file varies.

    Attributes
    ----------
    field : str
        Dotted path: `model.CL_alpha`.
    law : {"normal", "uniform"}
        Mean and standard deviation, or lowest and highest.
    first, second : float
        The two numbers of the law. [unit of the field]
    """

    field: str
    law: Law
    first: float
    second: float

    def __post_init__(self) -> None:
        """Check the law."""
        if self.law not in get_args(Law):
            raise ValueError(f"the law of {self.field} must be one of {', '.join(get_args(Law))}, got {self.law!r}")
        if not (math.isfinite(self.first) and math.isfinite(self.second)):
            raise ValueError(f"both numbers of the law of {self.field} must be finite, got {self.first}, {self.second}")
        if self.law == "normal" and self.second < 0.0:
            raise ValueError(f"the standard deviation of {self.field} must not be negative, got {self.second:g}")
        if self.law == "uniform" and self.second < self.first:
            raise ValueError(f"the lowest {self.field} must not be above the highest: {self.first:g}, {self.second:g}")


@dataclass(frozen=True, kw_only=True, eq=False)
class VariedModel:
    """A model file with some numbers changed, made into a model where and when it is needed.

    Attributes
    ----------
    file : FileModel
        As read.
    changes : tuple of (str, float)
        Fields and their values. [unit of each field]
    aero : str, optional
        Section theory; by kind of model if not given.
    fit_bound : float
        Largest error of a rational fit. [-]
    """

    file: FileModel
    changes: tuple[tuple[str, float], ...]
    aero: str | None = None
    fit_bound: float = 0.01

    def __call__(self) -> AeroelasticModel:
        """The model, its air forces rational.

        Returns
        -------
        model : AeroelasticModel
            Of the changed file. [SI]

        Raises
        ------
        ValueError
            If the fit of its air forces is worse than the bound.
        """
        model = build(override(self.file, dict(self.changes)), self.aero)
        if not isinstance(model.aero, SampledAero):
            return model
        fit = fit_rational(model.aero)
        if fit.error > self.fit_bound:
            raise ValueError(
                f"{', '.join(f'{k} = {v:g}' for k, v in self.changes)}: the rational fit is off by "
                f"{100.0 * fit.error:.2f} % of the largest |Q| of column {fit.worst_input!r}"
            )
        return replace(model, aero=fit.aero)


def drawn(spread: Spread, *, seed: int, run: int) -> float:
    """The value of one field in one run.

    Parameters
    ----------
    spread : Spread
        Field and law.
    seed : int
        Of the ensemble.
    run : int
        Number of the run.

    Returns
    -------
    value : float
        The same whatever else varies, however many runs there are. [unit of the field]
    """
    key = (_STREAM, run, crc32(spread.field.encode()))
    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))
    if spread.law == "normal":
        return float(random.normal(spread.first, spread.second))
    return float(random.uniform(spread.first, spread.second))


def variants(
    file: FileModel,
    spreads: Sequence[Spread],
    scenario: Scenario,
    *,
    runs: int,
    seed: int = 0,
    aero: str | None = None,
    fit_bound: float = 0.01,
) -> tuple[Variant, ...]:
    """One variant for each run, for `ensemble` with one run of each.

    Parameters
    ----------
    file : FileModel
        The model file.
    spreads : sequence of Spread
        What varies.
    scenario : Scenario
        What happens.
    runs : int
        How many. [-]
    seed : int
        Of the draws; turbulence and noise have their own, of `ensemble`.
    aero : str, optional
        Section theory.
    fit_bound : float
        Largest error of a rational fit. [-]

    Returns
    -------
    variants : tuple of Variant
        Their models are made where they run.

    Raises
    ------
    ValueError
        If a field is no number of the file or given twice, or a draw is not allowed there.
    """
    fields = [spread.field for spread in spreads]
    if len(set(fields)) != len(fields):
        raise ValueError(f"each field may vary once, got {fields}")
    found = []
    for run in range(runs):
        changes = tuple((spread.field, drawn(spread, seed=seed, run=run)) for spread in spreads)
        try:
            override(file, dict(changes))
        except ValueError as error:
            raise ValueError(f"run {run}: {error}; take a narrower law, or a uniform one") from None
        source = VariedModel(file=file, changes=changes, aero=aero, fit_bound=fit_bound)
        found.append(Variant(name=f"run {run}", model=source, scenario=scenario))
    return tuple(found)
