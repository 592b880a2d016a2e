"""The thesis' Tables 2 and 3 again: flutter, divergence and reversal of its binary wing and whole aircraft.

The printed numbers come from the package's case `thesis_tables`, the models from the presets `thesis-binary` and
`thesis-aircraft`, whose parameters are inferred (SOURCE.md of the case says how). Every other number is computed here
by the same public functions that users call. Nothing is adjusted to meet a printed number.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any, Literal

import numpy as np

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.flutter import PK, FlutterResult, P, flutter
from aeroservo.aeroelastic.static import StaticResult, static
from aeroservo.aircraft.files import read
from aeroservo.aircraft.overrides import override
from aeroservo.datatypes import AeroelasticModel, Array, FlightCondition
from aeroservo.studies.thesis_fixed_k import FixedKCurve, fixed_k_curve, k_that_prints

Model = Literal["binary", "aircraft"]
Column = Literal["quasi", "unsteady"]
Quantity = Literal["flutter", "divergence", "reversal"]
Slope = Literal["a_w", "2 pi"]

MODELS: tuple[Model, ...] = ("binary", "aircraft")
SLOPES: tuple[Slope, ...] = ("a_w", "2 pi")
ALTITUDES = (0.0, 3048.0)
"""Of Table 2 and Table 3. [m]"""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One number of the thesis beside ours.

    Attributes
    ----------
    table : int
        2 or 3.
    altitude : float
        Geopotential. [m]
    model, column, quantity : str
        "binary" or "aircraft"; "quasi" or "unsteady"; "flutter", "divergence" or "reversal".
    theory : str
        What ours is computed with.
    printed : int
        The thesis' number. [m/s]
    computed : float or None
        Ours; None where there is none in the range. [m/s]
    reason : str
        Why they differ, or why they agree.
    """

    table: int
    altitude: float
    model: Model
    column: Column
    quantity: Quantity
    theory: str
    printed: int
    computed: float | None
    reason: str

    @property
    def difference(self) -> float | None:
        """Ours less the thesis'. [m/s]"""
        return None if self.computed is None else self.computed - self.printed


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """One model at one altitude with one theory.

    Attributes
    ----------
    model : str
        "binary" or "aircraft".
    altitude : float
        Geopotential. [m]
    theory : str
        "quasi_steady_damped" or "theodorsen".
    slope : str
        Circulatory lift slope: "a_w" or "2 pi".
    flutter : FlutterResult
        By p (quasi-steady) or p-k (Theodorsen). [SI]
    static : StaticResult
        Statics, always with a_w. [SI]
    b : float
        Semi-chord, for reduced frequencies. [m]
    """

    model: Model
    altitude: float
    theory: str
    slope: Slope
    flutter: FlutterResult
    static: StaticResult
    b: float

    @property
    def reduced_frequency(self) -> float | None:
        """k at the flutter speed, None without flutter. [-]"""
        if self.flutter.flutter_speed is None or self.flutter.flutter_frequency is None:
            return None
        return self.flutter.flutter_frequency * self.b / self.flutter.flutter_speed


@dataclass(frozen=True, kw_only=True, eq=False)
class Held:
    """Flutter with derivatives held at one k, against that k, beside the thesis' unsteady number.

    Attributes
    ----------
    model : str
        "binary" or "aircraft".
    altitude : float
        Geopotential. [m]
    slope : str
        "a_w" or "2 pi".
    printed : int
        The thesis' unsteady flutter speed. [m/s]
    curve : FixedKCurve
        Speeds over k. [m/s]
    ranges : tuple of (float, float)
        k at which the curve rounds to the printed number; empty where none does. [-]
    own_k, own_speed : float or None
        Where the curve meets the flutter of consistent Theodorsen p-k. [-, m/s]
    """

    model: Model
    altitude: float
    slope: Slope
    printed: int
    curve: FixedKCurve
    ranges: tuple[tuple[float, float], ...]
    own_k: float | None
    own_speed: float | None


@dataclass(frozen=True, kw_only=True, eq=False)
class ThesisStudy:
    """Tables 2 and 3, their runs and the curves over k.

    Attributes
    ----------
    rows : tuple of Row
        Every analytic number of the two tables; unsteady flutter with both lift slopes.
    runs : tuple of Run
        What they were read from.
    held : tuple of Held
        Flutter with derivatives held at one k.
    """

    rows: tuple[Row, ...]
    runs: tuple[Run, ...]
    held: tuple[Held, ...]

    def run(self, model: Model, altitude: float, theory: str, slope: Slope = "a_w") -> Run:
        """The run of one model at one altitude [m] with one theory."""
        wanted = (model, altitude, theory, slope)
        return next(r for r in self.runs if (r.model, r.altitude, r.theory, r.slope) == wanted)


@cache
def _reference() -> dict[str, Any]:
    """The case `thesis_tables`."""
    text = (files("aeroservo") / "cases" / "thesis_tables" / "reference.json").read_text(encoding="utf-8")
    content: dict[str, Any] = json.loads(text)
    return content


def printed_speed(model: Model, column: Column, quantity: Quantity, altitude: float) -> int:
    """A number of Table 2 or 3 as the thesis prints it.

    Parameters
    ----------
    model : {"binary", "aircraft"}
        "2DOF" or "3DOF" in the thesis.
    column : {"quasi", "unsteady"}
        Of the table.
    quantity : {"flutter", "divergence", "reversal"}
        V_f, V_div or V_rev.
    altitude : float
        0 (Table 2) or 3048 (Table 3). [m]

    Returns
    -------
    speed : int
        As printed. [m/s]

    Raises
    ------
    ValueError
        If there is no table for that altitude.

    References
    ----------
    Bramstång 2015, Tables 2 and 3.

    Examples
    --------
    >>> printed_speed("binary", "unsteady", "flutter", 3048.0)
    60
    """
    for table in _reference()["tables"]:
        if table["altitude_m"] == altitude:
            return int(table["printed_m_s"][f"{model}_{column}"][quantity])
    raise ValueError(f"altitude must be one of {ALTITUDES} [m], those of Tables 2 and 3, got {altitude:g}")


def printed_simulation(column: str, quantity: str, altitude: float) -> str:
    """An entry of the simulation columns of Table 2 or 3 as the thesis prints it.

    Parameters
    ----------
    column : {"simulation_lqr", "simulation_adaptive"}
        The second stands in Table 3 only.
    quantity : {"flutter", "divergence", "reversal"}
        V_f, V_div or V_rev.
    altitude : float
        0 (Table 2) or 3048 (Table 3). [m]

    Returns
    -------
    printed : str
        A number [m/s], ">120" or "NA".

    References
    ----------
    Bramstång 2015, Tables 2 and 3.

    Examples
    --------
    >>> printed_simulation("simulation_adaptive", "flutter", 3048.0)
    '>120'
    """
    table = _reference()["tables"][ALTITUDES.index(altitude)]
    value = table["printed_m_s"][column][quantity]
    return "NA" if value is None else str(value)


def thesis_model(model: Model, theory: str, slope: Slope = "a_w") -> AeroelasticModel:
    """The binary wing or whole aircraft of the thesis with one section theory.

    Parameters
    ----------
    model : {"binary", "aircraft"}
        Which preset.
    theory : str
        As `aeroservo.build` takes it.
    slope : {"a_w", "2 pi"}
        Circulatory lift slope: the preset's, or the thin aerofoil's.

    Returns
    -------
    model : AeroelasticModel
        Without airspeed or density. [SI]

    References
    ----------
    Bramstång 2015, Eqs. 7.27-7.36 and 7.43-7.46.

    Examples
    --------
    >>> thesis_model("aircraft", "theodorsen", "2 pi").modes.names
    ('bending 1', 'torsion 1', 'heave')
    """
    file = read(f"thesis-{model}")
    if slope == "2 pi":
        file = override(file, {"wing.lift_slope_per_rad": 2.0 * np.pi})
    return build(file, theory)


def thesis_study(
    *, speeds: Array | None = None, k: Array | None = None, progress: Callable[[str], None] | None = None
) -> ThesisStudy:
    """Both models at both altitudes by every theory, beside Tables 2 and 3.

    Parameters
    ----------
    speeds : ndarray, shape (n_V,), optional
        Sweep; default 1 to 130 by 1. [m/s]
    k : ndarray, shape (n_k,), optional
        Reduced frequencies of the held derivatives; default 61 from 1e-4 to 2. [-]
    progress : callable, optional
        Told in words what comes next.

    Returns
    -------
    study : ThesisStudy
        Rows, runs, curves. [SI]

    References
    ----------
    Bramstång 2015, section 9.5, Tables 2 and 3; sections 9.2-9.3.

    Examples
    --------
    >>> study = thesis_study(speeds=np.arange(20.0, 100.0, 4.0), k=np.array([0.4, 0.5]))
    >>> [round(r.computed, 1) for r in study.rows if r.quantity == "flutter" and r.column == "quasi"]
    [49.2, 48.2, 56.8, 55.3]
    """
    speeds = np.arange(1.0, 131.0) if speeds is None else np.asarray(speeds, dtype=float)
    k = np.geomspace(1e-4, 2.0, 61) if k is None else np.asarray(k, dtype=float)
    runs: list[Run] = []
    held: list[Held] = []
    for altitude in ALTITUDES:
        sweep = FlightCondition.at(altitude, V=speeds)
        for model in MODELS:
            if progress is not None:
                progress(f"{model} at {altitude:g} m")
            found = tuple(_runs(model, altitude, sweep))
            runs += found
            held += [_held(run, sweep, k) for run in found if run.theory == "theodorsen"]
    rows = tuple(row for altitude in ALTITUDES for row in _rows(altitude, runs))
    return ThesisStudy(rows=rows, runs=tuple(runs), held=tuple(held))


def _runs(model: Model, altitude: float, sweep: FlightCondition) -> Iterator[Run]:
    """Quasi-steady by p, Theodorsen with each slope by p-k; statics with a_w throughout."""
    quasi = thesis_model(model, "quasi_steady_damped")
    rest = static(quasi, sweep)
    b = quasi.aero.b
    yield Run(
        model=model, altitude=altitude, theory="quasi_steady_damped", slope="a_w", flutter=flutter(quasi, sweep, P()),
        static=rest, b=b,
    )  # fmt: skip
    for slope in SLOPES:
        found = flutter(thesis_model(model, "theodorsen", slope), sweep, PK())
        yield Run(
            model=model, altitude=altitude, theory="theodorsen", slope=slope, flutter=found, static=rest, b=b
        )  # fmt: skip


def _held(run: Run, sweep: FlightCondition, k: Array) -> Held:
    """The curve over k that belongs to a Theodorsen run."""
    printed = printed_speed(run.model, "unsteady", "flutter", run.altitude)
    curve = fixed_k_curve(thesis_model(run.model, "theodorsen", run.slope), sweep, k)
    return Held(
        model=run.model,
        altitude=run.altitude,
        slope=run.slope,
        printed=printed,
        curve=curve,
        ranges=k_that_prints(curve, printed),
        own_k=run.reduced_frequency,
        own_speed=run.flutter.flutter_speed,
    )


def _rows(altitude: float, runs: list[Run]) -> Iterator[Row]:
    """The rows of one table in the thesis' order of columns."""
    for model in MODELS:
        mine = [run for run in runs if (run.model, run.altitude) == (model, altitude)]
        for run in mine:
            column: Column = "quasi" if run.theory == "quasi_steady_damped" else "unsteady"
            theory = "quasi-steady" if column == "quasi" else f"Theodorsen {run.slope}"
            yield _row(run, column, "flutter", theory, run.flutter.flutter_speed)
        for quantity, speed in (("divergence", mine[0].static.divergence.V), ("reversal", mine[0].static.reversal.V)):
            for column in ("quasi", "unsteady"):
                yield _row(mine[0], column, quantity, "statics", speed)  # type: ignore[arg-type]


def _row(run: Run, column: Column, quantity: Quantity, theory: str, computed: float | None) -> Row:
    """One row with its reason."""
    return Row(
        table=2 + ALTITUDES.index(run.altitude),
        altitude=run.altitude,
        model=run.model,
        column=column,
        quantity=quantity,
        theory=theory,
        printed=printed_speed(run.model, column, quantity, run.altitude),
        computed=computed,
        reason=_reason(run, column, quantity),
    )


def _reason(run: Run, column: Column, quantity: Quantity) -> str:
    """Why ours and the thesis' number differ or agree."""
    high = run.altitude > 0.0
    if quantity == "flutter" and column == "unsteady":
        return "ours is consistent (p-k); the thesis held its derivatives at one k that it does not name: see k below"
    if quantity == "flutter" and run.model == "binary":
        return f"x_f/c was inferred from 49 and 56 m/s{'; the thesis seems to cut 56.8 to 56' if high else ''}"
    if quantity == "flutter":
        return "not fitted: the binary wing's inputs with heave; the thesis' centre mass is unknown, ours is 0"
    if quantity == "divergence":
        return "follows from sea level by density" if high else "e a_w was inferred from this number"
    return "follows from sea level by density" if high else "b_c/a_c was inferred from this number"
