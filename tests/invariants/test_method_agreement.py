"""Wings on which one method once lost a root that the others saw."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.flutter import PK, G, K, P, flutter
from aeroservo.aircraft.files import parse, read
from aeroservo.aircraft.overrides import override
from aeroservo.datatypes import FlightCondition

TWO_ROUTES = 1e-6
MODEL_GAP = 1e-3  # an independent program with its own number of modes

FORWARD = """
kind = "beam_wing"
[wing]
root = "clamped"
sweep_deg = -16.34565156238326
lift_slope_per_rad = 4.519173543814238
"""
STATION = """
[[wing.station]]
y_m = {y}
chord_m = 0.865461691919825
flexural_axis = 0.41300678319017986
cg_axis = 0.5605669069431534
mass_kg_per_m = 11.46787177452986
inertia_kg_m = 0.6913616586855783
EI_N_m2 = 89071.86943976628
GJ_N_m2 = 4589.749546129942
"""
ASSUMED = """
kind = "binary_wing"
[wing]
semi_span_m = 1.270514535064457
chord_m = 0.28516214205728324
flexural_axis = 0.3687317207793874
mass_kg_per_m2 = 6.736826969142039
lift_slope_per_rad = 4.879818668726136
EI_N_m2 = 76.67282905908456
pitch_stiffness_N_m = 13.28648837624117
leading_edge_mass_kg_per_m = 0.21628969822206723
"""


@pytest.mark.parametrize(
    ("text", "top", "restabilises"),
    [
        (FORWARD + STATION.format(y=0.0) + STATION.format(y=3.236957427317355), 310.0, 293.0216),
        (ASSUMED, 200.0, 132.33764),
    ],
    ids=["its number taken by another pair inside a cell of the scan (p-k)", "restabilised past divergence (g)"],
)
def test_every_method_sees_the_end_of_flutter(text, top, restabilises):
    model = build(parse(text, Path("wing.toml")), "jones")
    sweep = FlightCondition(V=np.arange(1.0, top), rho=1.225)
    p = flutter(model, sweep, P())
    first = p.intervals[0]
    assert first.end == pytest.approx(restabilises, rel=MODEL_GAP)
    for method in (PK(), G(), K()):
        found = flutter(model, sweep, method)
        np.testing.assert_allclose(found.crossings, p.crossings, rtol=TWO_ROUTES)
        assert found.intervals[0].start == pytest.approx(first.start, rel=TWO_ROUTES)
        assert found.intervals[0].end == pytest.approx(first.end, rel=TWO_ROUTES)


def test_a_free_swept_wing_in_steady_climb_is_no_divergence():
    """Pitch and heave rate together leave the incidence alone: a root at rest at every speed, which nothing crosses."""
    text = (FORWARD + STATION.format(y=0.0) + STATION.format(y=3.2)).replace('"clamped"', '"free"')
    model = build(parse(text.replace("-16.34", "12.34"), Path("wing.toml")), "jones")
    sweep = FlightCondition(V=np.arange(1.0, 60.0), rho=1.225)
    answers = [flutter(model, sweep, method).first_real_instability for method in (P(), PK(), G())]
    assert answers[1:] == [pytest.approx(answers[0], rel=TWO_ROUTES) if answers[0] else None] * 2


def test_a_station_that_interpolation_would_give_changes_nothing():
    """Every field is linear between stations; the offset of the mass axis in metres is the product of two of them."""
    tip_fields = {"chord_m": 0.9, "cg_axis": 0.38, "mass_kg_per_m": 20.0, "inertia_kg_m": 2.0}
    wide = override(read("goland"), {f"wing.station[1].{name}": value for name, value in tip_fields.items()})
    root, tip = wide.wing.station
    half = {name: 0.5 * (getattr(root, name) + getattr(tip, name)) for name in type(root).model_fields
            if isinstance(getattr(root, name), float)}  # fmt: skip
    finer = wide.model_copy(
        update={"wing": wide.wing.model_copy(update={"station": (root, root.model_copy(update=half), tip)})}
    )
    sweep = FlightCondition(V=np.linspace(1.0, 600.0, 60), rho=1.225)
    one, two = (flutter(build(model), sweep) for model in (wide, finer))
    assert two.flutter_speed == pytest.approx(one.flutter_speed, rel=TWO_ROUTES)
