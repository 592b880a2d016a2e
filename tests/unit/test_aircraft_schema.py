"""Model files of kind aircraft: the preset, what follows from it, and every refusal."""

import copy
import tomllib
from importlib.resources import files

import numpy as np
import pytest
from pydantic import ValidationError

from aeroservo.aero.vlm import VortexLattice
from aeroservo.aeroelastic.aircraft_lattice import aircraft_lattice, lattice_coefficients
from aeroservo.aircraft.aircraft_schema import AircraftFile

PRESET = tomllib.loads((files("aeroservo.aircraft") / "presets" / "thesis-uav.toml").read_text(encoding="utf-8"))
AVL_CL0 = (
    0.01  # AVL's CL0 on 16 x 32 panels takes the mean line's slope at points; the reflex is shorter than its panels
)
AVL_CM0 = 0.0015


def changed(*path_and_value):
    """The preset with one entry replaced."""
    data = copy.deepcopy(PRESET)
    *path, key, value = path_and_value
    place = data
    for step in path:
        place = place[step]
    place[key] = value
    return data


def test_table_1():
    model = AircraftFile.model_validate(PRESET)
    d = model.derived()
    expected = {
        "wing_area_m2": 1.0,
        "wing_span_m": 2.0,
        "wing_mac_m": 0.52667,
        "wing_mac_y_m": 0.43333,
        "wing_aspect_ratio": 4.0,
        "wing_taper": 0.42857,
        "wing_sweep_quarter_chord_deg": 23.0,
        "mass_kg": 10.0,
        "moment_point_x_m": 0.35894,
        "Iyy_about_moment_point_kg_m2": 0.498,
        "cg_x_m": 0.49061,
    }
    for key, value in expected.items():
        assert d[key] == pytest.approx(value, rel=2e-4), key
    assert d["cg_y_m"] == 0.0
    assumed = [p for p in model.problems() if p.startswith("assumed: ")]
    assert len(assumed) == len(model.assumptions) >= 5
    assert [p[:13] for p in model.problems() if p not in assumed] == ["elastic wing:"]  # what it takes from where


def test_the_beam_carries_the_mass_items():
    """The stations' mass and inertia are those of the evenly spread 10 kg."""
    model = AircraftFile.model_validate(PRESET)
    stations = model.structure.station
    y = [s.y_m for s in stations]
    assert 2 * np.trapezoid([s.mass_kg_per_m for s in stations], y) == pytest.approx(10.0, rel=1e-3)
    for s in stations:
        c = 0.7 - 0.4 * s.y_m
        inertia = 10 * (c**3 / 12 + c * ((0.5 - 0.433) * c) ** 2)
        assert s.inertia_kg_m == pytest.approx(inertia, rel=1e-5)
        assert s.EI_N_m2 == pytest.approx(1644 / 4, rel=1e-12) and s.GJ_N_m2 == 413.2


def test_from_file_to_coefficients():
    """AVL's figures for the whole chain: camber, washout, elevon."""
    model = AircraftFile.model_validate(PRESET)
    found = lattice_coefficients(
        aircraft_lattice(model.surfaces(), model.references(), method=VortexLattice(chordwise=16, spanwise=32))
    )
    assert pytest.approx(-0.094, abs=AVL_CL0) == found.CL0
    assert pytest.approx(0.0107, abs=AVL_CM0) == found.CM0
    assert found.neutral_point == pytest.approx(0.358, abs=0.003)
    assert found.CL_delta[0] == pytest.approx(0.87, rel=0.03)
    assert found.controls == ("elevon",)
    coarse = lattice_coefficients(aircraft_lattice(model.surfaces(), model.references()))
    assert pytest.approx(found.CL0, abs=1e-3) == coarse.CL0  # eight panels already see the reflex


def test_antisymmetric_elevon_rolls_and_does_not_lift():
    model = AircraftFile.model_validate(PRESET)
    for full in (False, True):
        d = aircraft_lattice(model.surfaces(), model.references(), full=full).derivatives
        assert abs(d.of("CL", "elevon_antisymmetric")) < 1e-12
        assert d.of("Cl", "elevon_antisymmetric") < -0.05
        assert abs(d.of("Cl", "elevon")) < 1e-12


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (changed("surface", 0, "section", 0, "chord_m", 0.0), "chord_m"),
        (changed("surface", 0, "section", 0, "chrod_m", 1.0), "chrod_m"),
        (changed("surface", 0, "section", 1, "y_m", 0.0), "one span station"),
        (changed("surface", 0, "section", 1, "y_m", -1.0), "crosses its twin"),
        (changed("surface", 0, "control", 0, "to_span", 1.2), "to_span"),
        (changed("surface", 0, "control", 0, "from_span", 1.0), "from_span"),
        (changed("surface", 0, "control", 0, "hinge_from", 1.0), "hinge_from"),
        (changed("surface", 0, "control", [PRESET["surface"][0]["control"][0]] * 2), "names must differ"),
        (changed("surface", PRESET["surface"] * 2), "names of surfaces must differ"),
        (changed("mass", 0, "spread_over", "tail"), "spread_over must name a surface"),
        (changed("mass", 0, "mass_kg", -1.0), "mass_kg"),
        (changed("structure", "surface", "tail"), "must name a surface"),
        (changed("structure", "station", PRESET["structure"]["station"][:-1]), "from root to tip"),
        (changed("structure", "station", PRESET["structure"]["station"][::-1]), "ascend"),
        (changed("structure", "station", 0, "inertia_kg_m", 1e-6), "structure.station at y_m = 0"),
        (changed("surface", []), "surface"),
    ],
)
def test_bad_files_are_refused(data, message):
    with pytest.raises(ValidationError, match=message):
        AircraftFile.model_validate(data)


def test_several_surfaces_and_lumps():
    data = copy.deepcopy(PRESET)
    data["surface"].append(
        {
            "name": "fin",
            "mirrored": False,
            "section": [
                {"y_m": 0.0, "x_le_m": 0.5, "chord_m": 0.2},
                {"y_m": 0.0, "x_le_m": 0.55, "z_le_m": 0.2, "chord_m": 0.15},
            ],
        }
    )
    data["mass"].append({"name": "motor", "mass_kg": 1.0, "x_m": -0.1, "y_m": 0.3, "mirrored": True})
    model = AircraftFile.model_validate(data)
    assert model.masses().mass == 12.0
    assert model.masses().cg[0] == pytest.approx((10 * 0.4906058 - 0.2) / 12, rel=1e-6)
    d = aircraft_lattice(model.surfaces(), model.references()).derivatives
    assert d.of("Cn", "beta") > 0
    data["mass"] = []
    assert "no [[mass]] items" in AircraftFile.model_validate(data).problems()[-1]


@pytest.mark.parametrize(("reading", "low", "high"), [("same_drop", 1.26, 1.40), ("same_slope", 0.64, 0.71)])
def test_morphed_against_hinged_elevon(reading, low, high):
    """Lift per degree of a morphed elevon over a hinged one: the ranges of the case `thesis_wing`."""
    lift = {}
    for kind in ("hinged", "morphed"):
        data = changed("surface", 0, "control", 0, "kind", kind)
        data["surface"][0]["control"][0]["reading"] = reading
        model = AircraftFile.model_validate(data)
        lift[kind] = lattice_coefficients(aircraft_lattice(model.surfaces(), model.references())).CL_delta[0]
    assert low < lift["morphed"] / lift["hinged"] < high
