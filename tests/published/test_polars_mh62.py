"""Section polars of MH 62 against XFOIL's own: shipped tables, NeuralFoil, and what the thesis says in figure 21."""

import csv
import json
from importlib.resources import files
from importlib.util import find_spec

import numpy as np
import pytest

from aeroservo.aero.airfoil_files import airfoil
from aeroservo.aero.polars import INSIDE, best_lift_to_drag, section_coefficients
from aeroservo.aero.polars_neuralfoil import neuralfoil_polar
from aeroservo.aero.polars_points import shipped_polar
from aeroservo.studies.wing_polar import trimmed_wing

CASE = files("aeroservo") / "cases" / "thesis_wing"
REFERENCE = json.loads((CASE / "reference.json").read_text(encoding="utf-8"))
SECTION = REFERENCE["section_control_derivatives_Re1e6_per_rad"]

LIFT, MOMENT = 0.006, 0.002  # mean errors that the project asks of NeuralFoil; the shipped tables do better
DERIVATIVE = 0.04  # relative: a slope over +-5 degrees with free transition, against one read from another sweep
BEST = 0.08  # relative: best L/D is a maximum over points half a degree apart, next to transition's jumps


def stored():
    """Sweeps by (flap [rad], Reynolds): alpha [rad], CL, CD, CM."""
    sweeps = {}
    for row in csv.DictReader((CASE / "xfoil_mh62_polars.csv").read_text(encoding="utf-8").splitlines()):
        key = (np.radians(float(row["flap"])), float(row["Re"]))
        sweeps.setdefault(key, []).append(
            [np.radians(float(row["alpha"])), *(float(row[k]) for k in ("CL", "CD", "CM"))]
        )
    return {key: np.array(sorted(rows)) for key, rows in sweeps.items()}


def linear(rows):
    return rows[(rows[:, 0] >= np.radians(-2.01)) & (rows[:, 0] <= np.radians(5.01))]


def test_shipped_table_is_xfoil_s_own_flap():
    """Our outline and XFOIL's flap, all twenty sweeps."""
    polar = shipped_polar("mh62", "hinged")
    lift, drag, moment, compared = [], [], [], 0
    for (delta, re), rows in stored().items():
        rows = linear(rows)
        p = section_coefficients(polar, rows[:, 0], reynolds=re, delta=delta)
        ok = np.isfinite(p.CL)
        compared += ok.sum()
        assert ok.mean() > 0.7, (np.degrees(delta), re)
        lift.append(np.mean(np.abs(p.CL - rows[:, 1])[ok]))
        drag.append(np.median(np.abs(p.CD / rows[:, 2] - 1)[ok]))
        moment.append(np.mean(np.abs(p.CM - rows[:, 3])[ok]))
    assert compared > 200
    assert np.mean(lift) < LIFT / 2 and np.mean(moment) < MOMENT / 2
    assert np.mean(drag) < 0.02


@pytest.mark.parametrize(("kind", "key"), [("hinged", "hinge_0.75"), ("morphed", "smooth_same_trailing_edge_drop")])
def test_section_control_derivatives(kind, key):
    polar = shipped_polar("mh62", kind)
    delta = np.radians([-5.0, 5.0])
    alpha = np.radians(np.array([0.0, 1.0, 2.0, 3.0]))[:, None]
    p = section_coefficients(polar, alpha, reynolds=1e6, delta=delta)
    slopes = [np.nanmean((v[:, 1] - v[:, 0]) / (delta[1] - delta[0])) for v in (p.CL, p.CM)]
    np.testing.assert_allclose(slopes, SECTION[key]["xfoil_viscous"], rtol=DERIVATIVE)


@pytest.mark.parametrize("reynolds", [0.5e6, 1.0e6, 1.5e6, 2.5e6])
def test_figure_21(reynolds):
    """Among -10 to +10 degrees the best section L/D is at +10, and it still grows at +15: trim has to be asked."""
    table = REFERENCE["best_L_over_D_2d_xfoil"]
    figures = dict(
        zip(
            table["flap_deg"], table[{0.5e6: "Re_0.5e6", 1e6: "Re_1e6", 1.5e6: "Re_1.5e6", 2.5e6: "Re_2.5e6"}[reynolds]]
        )
    )
    polar = shipped_polar("mh62", "hinged")
    found = {d: best_lift_to_drag(polar, reynolds=reynolds, delta=np.radians(d))[0] for d in figures}
    within = [-10, -5, 0, 5, 10]
    close = sorted(within, key=found.get)[-2:]
    assert 10 in close
    if reynolds > 0.5e6:  # at half a million +5, +7.5 and +10 degrees are within a few per cent of one another
        assert max(within, key=found.get) == 10
        assert found[15] > found[10]
    for d in within:
        assert found[d] == pytest.approx(figures[d], rel=BEST), d
    p = section_coefficients(polar, np.radians(4.0), reynolds=reynolds, delta=np.radians(15.0))
    if p.mark == INSIDE:
        assert p.CM < -0.1  # what that deflection asks of the rest of a flying wing


def test_a_trimmed_wing_does_not_fly_at_the_section_s_best():
    """The 2-D optimum is no design point: at the neutral point the elevon stays within a few degrees."""
    from aeroservo.aircraft.files import read

    trim = trimmed_wing(read("thesis-uav"), x_cg=[0.34, 0.3564], CL=0.3, speed=30.0)
    assert np.all(np.abs(np.degrees(trim.delta)) < 5.0)
    assert np.all(trim.polar.lift_to_drag < 30.0)


def test_morphed_gives_more_lift_per_degree():
    """The thesis' remark, with the reading that it needs: the same trailing-edge drop."""
    lift = {}
    for kind in ("hinged", "morphed"):
        p = section_coefficients(
            shipped_polar("mh62", kind), np.radians(2.0), reynolds=1e6, delta=np.radians([0.0, 5.0])
        )
        lift[kind] = float(p.CL[1] - p.CL[0])
    low, high = REFERENCE["morphed"]["CL_delta_ratio_to_hinged"]["same_drop"]
    assert low - 0.05 < lift["morphed"] / lift["hinged"] < high


@pytest.mark.skipif(find_spec("neuralfoil") is None, reason="NeuralFoil is not installed (extra: airfoil)")
def test_neuralfoil_against_xfoil():
    lift, moment = [], []
    for (delta, re), rows in stored().items():
        rows = linear(rows)
        p = neuralfoil_polar(airfoil("mh62"), alpha=rows[:, 0], delta=[delta], reynolds=[re], confidence=0.0)
        lift.append(np.mean(np.abs(p.CL[0, 0] - rows[:, 1])))
        moment.append(np.mean(np.abs(p.CM[0, 0] - rows[:, 3])))
    assert np.mean(lift) <= LIFT and np.mean(moment) <= MOMENT
