"""Four methods side by side: one boundary, each its own damping away from it."""

from __future__ import annotations

import numpy as np
import pytest

from aeroservo.aeroelastic.build import build
from aeroservo.aircraft.files import read
from aeroservo.aircraft.overrides import override
from aeroservo.datatypes import FlightCondition
from aeroservo.studies.methods import compare_methods

SWEEP = FlightCondition(V=np.linspace(20.0, 120.0, 41), rho=1.225)


def test_crossings_agree_and_damping_differs() -> None:
    """On rational air forces the four agree to 1e-6 at the crossing; before and after it only in sign."""
    answers = {one.method: one for one in compare_methods(build(read("thesis-binary"), "jones"), SWEEP)}
    assert list(answers) == ["p", "pk", "k", "g"]
    first = answers["p"]
    assert first.flutter_speed is not None
    for one in answers.values():
        assert one.refusal == ""
        assert one.flutter_speed == pytest.approx(first.flutter_speed, rel=1e-6)
        assert one.flutter_frequency == pytest.approx(first.flutter_frequency, rel=1e-6)
        assert one.damping_before is not None and one.damping_after is not None
        assert one.damping_before > 0.0 > one.damping_after
        assert one.fit_error is None
    assert len({round(one.damping_after or 0.0, 6) for one in answers.values()}) > 1
    # g keeps the first order off the axis that p-k leaves out: it lies closer to p
    off = {name: abs((one.damping_after or 0.0) - (first.damping_after or 0.0)) for name, one in answers.items()}
    assert off["g"] < off["pk"]


def test_a_refusal_is_an_answer() -> None:
    """Hysteretic damping has no state space: the p method says so, the others go on."""
    data = read("thesis-binary").model_dump(exclude_unset=True) | {"damping": {"hysteretic": {"g": 0.02}}}
    model = build(type(read("thesis-binary")).model_validate(data), "jones")
    answers = {one.method: one for one in compare_methods(model, SWEEP)}
    assert "hysteretic" in answers["p"].refusal
    assert answers["p"].flutter_speed is None
    assert answers["pk"].flutter_speed == pytest.approx(answers["k"].flutter_speed, rel=1e-6)


def test_no_flutter() -> None:
    """Nothing to compare the damping at."""
    model = build(override(read("thesis-binary"), {"wing.flexural_axis": 0.25}), "jones")
    for one in compare_methods(model, FlightCondition(V=[1.0, 5.0], rho=1.225)):
        assert (one.flutter_speed, one.damping_before, one.damping_after) == (None, None, None)
