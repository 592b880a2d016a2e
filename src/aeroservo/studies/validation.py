"""The published cases, re-run: what `aeroservo validate` prints.

A case is a folder of `aeroservo/cases` with a `runs.toml`: which model, which analysis with which options, which
quantity against which reference; or which function with which arguments (`case_calls`). Long references may lie in a
`reference.json` beside it ("@key"), model files too (a `model` that ends in .toml). What cannot be computed yet is
listed under `[[not_yet]]`. A new case is such a folder and no code.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aeroservo.studies.case_calls import evaluated, part

if TYPE_CHECKING:
    from aeroservo.datatypes import AeroelasticModel, FlightCondition

CASES = Path(__file__).parents[1] / "cases"
_RUN_KEYS = {
    "what",
    "model",
    "analysis",
    "method",
    "aero",
    "altitude_m",
    "density_kg_m3",
    "speeds_m_s",
    "change",
    "call",
    "arguments",
    "check",
}
_CHECK_KEYS = {"quantity", "reference", "relative", "absolute"}
_CALL_CHECK_KEYS = _CHECK_KEYS | {"of", "index", "power"}


@dataclass(frozen=True, kw_only=True)
class Check:
    """One quantity of a published case beside its reference.

    Attributes
    ----------
    name : str
        Case, and what was run.
    quantity : str
        What is compared, its unit in the name.
    reference : float
        The published or independently computed value. [unit of `quantity`]
    result : float or None
        Ours; None where there is none. [unit of `quantity`]
    tolerance : float
        Largest difference allowed. [unit of `quantity`]
    citation : str
        Where the reference is from.
    """

    name: str
    quantity: str
    reference: float
    result: float | None
    tolerance: float
    citation: str

    @property
    def difference(self) -> float | None:
        """Result less reference. [unit of `quantity`]"""
        return None if self.result is None else self.result - self.reference

    @property
    def passed(self) -> bool:
        """Whether the difference is within the tolerance."""
        return self.difference is not None and abs(self.difference) <= self.tolerance


@dataclass(frozen=True, kw_only=True)
class NotYet:
    """A published number that this version cannot compute.

    Attributes
    ----------
    name : str
        Case, and what it is.
    quantity : str
        What would be compared.
    reference : str
        The published value.
    why : str
        What is missing.
    citation : str
        Where the reference is from.
    """

    name: str
    quantity: str
    reference: str
    why: str
    citation: str


def cases() -> tuple[str, ...]:
    """Names of the cases that can be re-run.

    Returns
    -------
    names : tuple of str
        In alphabetical order.
    """
    return tuple(sorted(path.parent.name for path in CASES.glob("*/runs.toml")))


def validate(case: str | None = None, *, progress: Callable[[str], None] | None = None) -> tuple[Check, ...]:
    """Re-run the published cases.

    Parameters
    ----------
    case : str, optional
        One case; all if left out.
    progress : callable, optional
        Called with the name of each run before it starts.

    Returns
    -------
    checks : tuple of Check
        In the order of the case files.

    Raises
    ------
    ValueError
        If there is no such case.
    """
    if case is not None and case not in cases():
        raise ValueError(f"no case named {case[:60]!r}; the cases are {', '.join(cases())}")
    found: list[Check] = []
    for name in cases() if case is None else (case,):
        content = _content(name)
        stored = CASES / name / "reference.json"
        data = json.loads(stored.read_text(encoding="utf-8")) if stored.exists() else {}
        for run in content["run"]:
            label = f"{name}: {run['what']}"
            if str(run.get("model", "")).endswith(".toml"):
                run["model"] = str(CASES / name / run["model"])
            if progress is not None:
                progress(label)
            found += checked(label, run, content["citation"], data)
    return tuple(found)


def not_yet_computed(case: str | None = None) -> tuple[NotYet, ...]:
    """Published numbers that cases hold and this version cannot compute.

    Parameters
    ----------
    case : str, optional
        One case; all if left out.

    Returns
    -------
    missing : tuple of NotYet
        In the order of the case files.
    """
    return tuple(
        NotYet(
            name=f"{name}: {entry['what']}",
            quantity=entry["quantity"],
            reference=entry["reference"],
            why=entry["why"],
            citation=content["citation"],
        )
        for name in (cases() if case is None else (case,))
        for content in (_content(name),)
        for entry in content.get("not_yet", [])
    )


def _content(name: str) -> dict[str, Any]:
    """The case file."""
    return tomllib.loads((CASES / name / "runs.toml").read_text(encoding="utf-8"))


def checked(label: str, run: dict[str, Any], citation: str, data: dict[str, Any]) -> list[Check]:
    """Carry out one run of a case file and compare.

    Parameters
    ----------
    label : str
        Name of the checks.
    run : dict
        A `[[run]]` table.
    citation : str
        Source of the references.
    data : dict
        The case's `reference.json`; empty where it has none.

    Returns
    -------
    checks : list of Check
        One for each `[[run.check]]`; of a column of numbers, the one that is farthest off for its tolerance.

    Raises
    ------
    ValueError
        If the table has a key that means nothing, or a column has the wrong length.
    """
    known = _CALL_CHECK_KEYS if run["analysis"] == "call" else _CHECK_KEYS
    strangers = (set(run) - _RUN_KEYS) | {key for check in run["check"] for key in set(check) - known}
    if strangers:
        raise ValueError(f"{label}: unknown keys {sorted(strangers)}")
    if run["analysis"] == "call":
        answer = evaluated({"call": run["call"], "arguments": run.get("arguments", {})}, data)
        pairs = [_compared(label, answer, check, data) for check in run["check"]]
    else:
        quantities = _ANALYSES[run["analysis"]](run)
        pairs = [(quantities[check["quantity"]], float(check["reference"]), "") for check in run["check"]]
    checks = []
    for check, (result, reference, which) in zip(run["check"], pairs):
        tolerance = check["absolute"] if "absolute" in check else check["relative"] * abs(reference)
        checks.append(
            Check(
                name=label,
                quantity=check["quantity"] + which,
                reference=reference,
                result=None if result is None else float(result),
                tolerance=float(tolerance),
                citation=citation,
            )
        )
    return checks


def _compared(label: str, answer: Any, check: dict[str, Any], data: dict[str, Any]) -> tuple[float, float, str]:
    """Result and reference of a check on a call, and which of how many they are."""
    import numpy as np

    result = np.asarray(part(answer, check.get("of", "")), dtype=float)
    result = (result[check["index"]] if "index" in check else result) ** check.get("power", 1.0)
    reference = np.asarray(evaluated(check["reference"], data), dtype=float)
    if result.shape != reference.shape:
        raise ValueError(f"{label}: {check['quantity']} has shape {result.shape}, its reference {reference.shape}")
    if reference.ndim == 0:
        return float(result), float(reference), ""
    tolerance = (
        np.full(reference.shape, check["absolute"]) if "absolute" in check else check["relative"] * np.abs(reference)
    )
    excess = np.abs(result - reference) / tolerance
    worst = int(np.argmax(np.where(np.isfinite(excess), excess, np.inf)))
    return float(result.flat[worst]), float(reference.flat[worst]), f" (number {worst + 1}, the worst of {result.size})"


def _flutter(run: dict[str, Any]) -> dict[str, Any]:
    from aeroservo.aeroelastic.build import DEFAULTS
    from aeroservo.aeroelastic.flutter import PK, G, K, P, flutter
    from aeroservo.aircraft.files import read

    methods: dict[str, P | PK | K | G] = {"p": P(), "pk": PK(), "k": K(), "g": G()}
    method = methods[run.get("method") or DEFAULTS[read(run["model"]).kind].method]
    model = _model(run)
    result = flutter(model, _sweep(run), method)
    V, omega = result.flutter_speed, result.flutter_frequency
    intervals = {f"unstable_from_m_s[{i}]": interval.start for i, interval in enumerate(result.intervals)}
    intervals |= {f"unstable_to_m_s[{i}]": interval.end for i, interval in enumerate(result.intervals)}
    return intervals | {
        "flutter_speed_m_s": V,
        "flutter_dynamic_pressure_Pa": None if V is None else 0.5 * float(result.condition.rho[0]) * V**2,
        "flutter_frequency_rad_s": omega,
        "flutter_reduced_frequency": None if V is None or omega is None else omega * model.aero.b / V,
        "divergence_speed_m_s": result.divergence_speed,
        "first_real_instability_m_s": result.first_real_instability,
    }


def _static(run: dict[str, Any]) -> dict[str, Any]:
    from aeroservo.aeroelastic.static import static

    result = static(_model(run), _sweep(run))
    return {"divergence_speed_m_s": result.divergence.V, "reversal_speed_m_s": result.reversal.V}


def _modes(run: dict[str, Any]) -> dict[str, Any]:
    from aeroservo.structure.modal import natural_modes

    omega = natural_modes(_model(run).modes).omega
    return {f"frequencies_rad_s[{i}]": value for i, value in enumerate(omega)}


_ANALYSES: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
    "flutter": _flutter,
    "static": _static,
    "modes": _modes,
}


def _model(run: dict[str, Any]) -> AeroelasticModel:
    """The model of a run, with its changes."""
    from aeroservo.aeroelastic.build import build
    from aeroservo.aircraft.files import read
    from aeroservo.aircraft.overrides import override

    return build(override(read(run["model"]), run.get("change", {})), run.get("aero"))


def _sweep(run: dict[str, Any]) -> FlightCondition:
    """The air and the speeds of a run."""
    import numpy as np

    from aeroservo.datatypes import FlightCondition

    low, high, step = run["speeds_m_s"]
    V = np.append(np.arange(low, high, step), high)
    if "density_kg_m3" in run:
        return FlightCondition(V=V, rho=run["density_kg_m3"])
    return FlightCondition.at(run.get("altitude_m", 0.0), V=V)
