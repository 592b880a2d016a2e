"""Goland's wing (J. Applied Mechanics 12(4), 1945, A197-A208) by Theodorsen strips at 1.225 kg/m^3."""

from __future__ import annotations

import json
from importlib.resources import files

import numpy as np
import pytest

from aeroservo.aeroelastic.build import THEORIES, build
from aeroservo.aeroelastic.flutter import PK, G, K, P, flutter
from aeroservo.aeroelastic.static import divergence
from aeroservo.aircraft.files import read, validate
from aeroservo.datatypes import FlightCondition
from aeroservo.structure.modal import natural_modes

CASE = json.loads((files("aeroservo") / "cases" / "goland" / "reference.json").read_text(encoding="utf-8"))
STRIP, JONES = CASE["strip_theodorsen"], CASE["strip_jones"]
SWEEP = FlightCondition(V=np.linspace(20.0, 300.0, 15), rho=STRIP["density_kg_m3"])
SAME_WING = 1e-4  # relative: a root mass so large that it does not move
TRUNCATED = 1e-4  # relative: the real root is that of a few modes, which twist less freely than the whole wing
GOLAND = read("goland")


def test_vacuum_frequencies():
    np.testing.assert_allclose(
        natural_modes(build(GOLAND).modes).omega[:5], CASE["vacuum"]["values"], rtol=CASE["vacuum"]["tolerance"]
    )


@pytest.mark.parametrize("method", [PK(), K(), G()])
def test_flutter_by_theodorsen_strips(method):
    result = flutter(build(GOLAND, "theodorsen"), SWEEP, method)
    assert result.flutter_speed == pytest.approx(STRIP["flutter_speed_m_s"], rel=STRIP["tolerance"])
    assert result.flutter_frequency == pytest.approx(STRIP["flutter_frequency_rad_s"], rel=STRIP["tolerance"])
    assert result.divergence_speed == pytest.approx(STRIP["divergence_speed_m_s"], rel=STRIP["tolerance"])
    if not isinstance(method, G):  # p-k and k see it as the real root that it is
        assert result.first_real_instability == pytest.approx(result.divergence_speed, rel=TRUNCATED)


def test_flutter_with_jones_lags():
    result = flutter(build(GOLAND, "jones"), SWEEP, P())
    assert result.flutter_speed == pytest.approx(JONES["flutter_speed_m_s"], rel=JONES["tolerance"])
    assert result.first_real_instability == pytest.approx(result.divergence_speed, rel=TRUNCATED)


def test_divergence_of_every_theory_and_of_the_closed_form():
    # q_D = (pi^2/4) GJ / (e c^2 s^2 a): a slender wing alone, so exact for strips; modes converge to it
    w = GOLAND.wing.station[0]
    e = w.flexural_axis - 0.25
    q = np.pi**2 / 4.0 * w.GJ_N_m2 / (e * w.chord_m**2 * CASE["inputs"]["length_m"] ** 2 * 2.0 * np.pi)
    speeds = [divergence(build(GOLAND, aero), SWEEP[0]).V for aero in THEORIES]
    np.testing.assert_allclose(speeds, speeds[0], rtol=1e-10)
    assert speeds[0] == pytest.approx(np.sqrt(2.0 * q / SWEEP.rho[0]), rel=2e-5)


def test_zero_density_gives_vacuum_frequencies():
    natural = natural_modes(build(GOLAND).modes).omega
    for aero, method in (("jones", P()), ("theodorsen", PK())):
        result = flutter(build(GOLAND, aero), FlightCondition(V=[50.0, 150.0], rho=0.0), method)
        np.testing.assert_allclose(result.frequency[0, :5], natural[:5], rtol=1e-8)
        assert not result.found


def test_free_wing_with_a_huge_root_mass_is_the_clamped_wing():
    data = GOLAND.model_dump(exclude_unset=True)
    data["wing"] |= {
        "root": "free",
        "symmetry": "symmetric",
        "mass": [{"y_m": 0.0, "x_m": 0.0, "mass_kg": 1e9, "inertia_kg_m2": 1e9}],
    }
    free = build(validate(data, "free goland"), "jones")
    clamped = build(GOLAND, "jones")
    one, two = (flutter(model, SWEEP, P()) for model in (clamped, free))
    assert two.flutter_speed == pytest.approx(one.flutter_speed, rel=SAME_WING)
    assert two.flutter_frequency == pytest.approx(one.flutter_frequency, rel=SAME_WING)
    assert two.divergence_speed == pytest.approx(one.divergence_speed, rel=SAME_WING)
