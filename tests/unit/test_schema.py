"""Model files say what they mean or are refused: ranges, alternatives, rules across fields, the JSON Schema."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from aeroservo.aircraft.file_errors import ModelFileError
from aeroservo.aircraft.files import parse, presets, read, validate
from aeroservo.aircraft.schema import SCHEMA_FILE, json_schema, kinds

Data = dict[str, Any]


def section() -> Data:
    """A typical section that is valid."""
    return {
        "kind": "typical_section",
        "section": {
            "chord_m": 0.6096,
            "flexural_axis": 0.30,
            "mass_kg_per_m": 36.0,
            "static_moment_kg": 1.1,
            "inertia_kg_m": 0.84,
            "plunge_stiffness_N_per_m2": 90000.0,
            "pitch_stiffness_N": 8400.0,
        },
    }


def wing(kind: str = "binary_wing") -> Data:
    """A binary wing that is valid."""
    return {
        "kind": kind,
        "wing": {
            "semi_span_m": 2.0,
            "chord_m": 0.5,
            "flexural_axis": 0.4,
            "mass_kg_per_m2": 9.0,
            "plunge_stiffness_N_per_m": 1600.0,
            "pitch_stiffness_N_m": 400.0,
            "lift_slope_per_rad": 3.0,
        },
    }


def station(y: float) -> Data:
    """A station of a beam wing that is valid."""
    return {
        "y_m": y,
        "chord_m": 1.8,
        "flexural_axis": 0.33,
        "cg_axis": 0.43,
        "mass_kg_per_m": 35.7,
        "inertia_kg_m": 8.6,
        "EI_N_m2": 9.8e6,
        "GJ_N_m2": 9.9e5,
    }


def beam() -> Data:
    """A beam wing that is valid."""
    return {"kind": "beam_wing", "wing": {"root": "clamped", "station": [station(0.0), station(6.0)]}}


def flap() -> Data:
    """A pitch-plunge-flap model that is valid."""
    model = {"m_kg": 10.0, "I_theta_kg_m2": 0.5, "K_h_N_m": 1644.0, "K_theta_N_m_rad": 413.2, "S_m2": 1.0, "c_m": 0.53}
    return {"kind": "pitch_plunge_flap", "model": model | {"CL_alpha": 3.68, "CM_alpha": 0.112}}


def state_space() -> Data:
    """A state-space model that is valid."""
    matrices = {"A": [[-1.0, 0.0], [1.0, -2.0]], "B": [[1.0], [0.0]], "C": [[0.0, 1.0]], "D": [[0.0]]}
    names = {"states": ["a", "b"], "inputs": ["u"], "outputs": ["y"]}
    return {"kind": "state_space", "model": matrices | names | {"speed_m_s": 50.0, "altitude_m": 0.0}}


def changed(data: Data, path: str, value: Any) -> Data:
    """`data` with one value set, or taken away where it is None, at a path such as "wing.station.0.y_m"."""
    inner: Any = data
    *way, last = [int(part) if part.isdecimal() else part for part in path.split(".")]
    for part in way:
        inner = inner.setdefault(part, {}) if isinstance(inner, dict) else inner[part]
    if value is None:
        del inner[last]
    else:
        inner[last] = value
    return data


def refusal(data: Data) -> str:
    """The message with which a table is refused."""
    with pytest.raises(ModelFileError) as caught:
        validate(data, "wing.toml")
    return str(caught.value)


@pytest.mark.parametrize("make", [section, wing, lambda: wing("whole_aircraft"), beam, flap, state_space])
def test_valid_models_of_each_kind(make: Any) -> None:
    """The smallest file of each kind is taken, without a finding."""
    model = validate(make(), "wing.toml")
    assert model.kind == make()["kind"]
    assert model.problems() == ()
    assert all(value is None or isinstance(value, int | float | list | str) for value in model.derived().values())


@pytest.mark.parametrize(
    ("make", "path", "value", "words"),
    [
        (section, "section.chord_m", -0.6, ["section.chord_m = -0.6", "greater than 0", "[m]"]),
        (section, "section.chord_m", 1e-300, ["section.chord_m = 1e-300", "greater than 0 (at least 1e-15)"]),
        (wing, "wing.pitch_stiffness_N_m", 1e-200, ["pitch_stiffness_N_m = 1e-200", "greater than 0"]),
        (section, "section.chord_m", None, ["section.chord_m is missing", "[m]"]),
        (section, "section.mass_kg_per_m", -36.0, ["section.mass_kg_per_m = -36.0", "greater than 0", "[kg/m]"]),
        (section, "section.flexural_axis", 1.3, ["section.flexural_axis = 1.3", "at least 0 and at most 1"]),
        (section, "section.flexural_axis", -0.1, ["section.flexural_axis = -0.1", "at least 0 and at most 1"]),
        (section, "section.static_moment_kg", 9.0, ["section", "not positive definite", "30.24", "81"]),
        (section, "section.static_moment_kg", float("nan"), ["section.static_moment_kg = nan", "finite"]),
        (section, "section.inertia_kg_m", float("inf"), ["section.inertia_kg_m = inf", "finite"]),
        (section, "section.inertia_kg_m", 1e300, ["section.inertia_kg_m = 1e+300", "at most 1e+15"]),
        (section, "section.inertia_kg_m", 10**400, ["section.inertia_kg_m", "huge", "number"]),
        (section, "section.inertia_kg_m", True, ["section.inertia_kg_m = True", "must be a number"]),
        (section, "section.inertia_kg_m", "0.84", ["section.inertia_kg_m = '0.84'", "must be a number"]),
        (section, "section.inertia_kg_m", [0.84], ["section.inertia_kg_m = [0.84]", "must be a number"]),
        (section, "section", 3, ["section must be a table"]),
        (section, "section.cord_m", 0.6, ["unknown key section.cord_m", "did you mean 'chord_m'", "[section]"]),
        (section, "sections", {}, ["unknown key sections", "did you mean 'section'", "top of the file"]),
        (section, "schema_version", 2, ["schema_version = 2", "newer than 1"]),
        (section, "schema_version", 0, ["schema_version = 0", "at least 1"]),
        (section, "schema_version", "1", ["schema_version = '1'", "whole number"]),
        (section, "speeds_m_s", [350.0, 1.0, 1.0], ["speeds_m_s", "MIN <= MAX", "MIN = 350, MAX = 1"]),
        (section, "speeds_m_s", [0.0, 350.0, 1.0], ["speeds_m_s", "0 < MIN", "MIN = 0"]),
        (section, "speeds_m_s", [1.0, 350.0, 0.0], ["speeds_m_s", "step", "positive"]),
        (section, "speeds_m_s", [1.0, 350.0], ["speeds_m_s", "missing"]),
        (section, "speeds_m_s", [1.0, 350.0, 1e-9], ["speeds_m_s", "larger step"]),
        (section, "name", "two\nlines", ["name", "printable"]),
        (section, "name", "x" * 201, ["name", "200"]),
        (section, "name", 7, ["name = 7", "text"]),
        (section, "section.flap.hinge", 0.8, ["section.flap.flap_static_moment_kg is missing"]),
        (section, "damping", {}, ["[damping]", "exactly one", "got 0"]),
        (section, "damping.modal.ratios", [], ["damping.modal.ratios", "at least 1"]),
        (section, "damping.modal.ratios", [0.1, 1.5], ["damping.modal.ratios", "less than 1", "1.5"]),
        (section, "damping.hysteretic.g", -0.1, ["damping.hysteretic.g = -0.1", "at least 0"]),
        (section, "damping.viscous.plunge_N_s_per_m", 1.0, ["unknown key damping.viscous.plunge_N_s_per_m", "per_m2"]),
        (wing, "wing.EI_N_m2", 3.0, ["wing", "exactly one of plunge_stiffness_N_per_m and EI_N_m2"]),
        (wing, "wing.pitch_stiffness_N_m", None, ["wing", "exactly one of pitch_stiffness_N_m and GJ_N_m2", "neither"]),
        (wing, "wing.mass_kg_per_m2", -9.0, ["wing.mass_kg_per_m2 = -9.0", "greater than 0"]),
        (wing, "wing.sweep_deg", 90.0, ["wing.sweep_deg = 90.0", "at most 80"]),
        (wing, "wing.centre_mass_kg", 1.0, ["unknown key wing.centre_mass_kg"]),
        (wing, "wing.elevon", {"lift_per_rad": 1.0}, ["wing.elevon.moment_per_rad is missing"]),
        (beam, "wing.station", [station(0.0)], ["wing.station", "at least 2", "got 1"]),
        (beam, "wing.station.1.y_m", 0.0, ["wing", "ascending", "station[1] at 0"]),
        (beam, "wing.station.1.y_m", -1.0, ["wing.station[1].y_m = -1.0", "at least 0"]),
        (beam, "wing.station.0.EI_N_m2", 0.0, ["wing.station[0].EI_N_m2 = 0.0", "greater than 0"]),
        (beam, "wing.station.1.GJ_N_m2", 0.0, ["wing.station[1].GJ_N_m2 = 0.0", "greater than 0"]),
        (beam, "wing.station.1.inertia_kg_m", 0.1, ["wing.station[1]", "not positive definite"]),
        (beam, "wing.station.1.coupling_N_m2", 1e8, ["wing.station[1]", "coupling_N_m2", "sqrt(EI GJ)"]),
        (beam, "wing.sweep_deg", 90.0, ["wing.sweep_deg = 90.0", "at least -80 and at most 80"]),
        (beam, "wing.sweep_deg", -90.0, ["wing.sweep_deg = -90.0", "at least -80 and at most 80"]),
        (beam, "wing.station.0.sweep_deg", 90.0, ["wing.station[0].sweep_deg = 90.0", "at most 80"]),
        (beam, "wing.root", "glued", ["wing.root = 'glued'", "'clamped' or 'free'"]),
        (beam, "wing.lift_slope_correction", "x", ["lift_slope_correction", "'helmbold'"]),
        (beam, "wing.mass", [{"y_m": 7.0, "x_m": 0.0, "mass_kg": 1.0}], ["mass[0].y_m", "from 0 to 6", "7"]),
        (
            beam,
            "wing.elevon",
            {"from_y_m": 3.0, "to_y_m": 2.0, "lift_per_rad": 1.0, "moment_per_rad": -0.5},
            ["elevon", "from_y_m < to_y_m", "= 3"],
        ),
        (flap, "model.S_htheta_kg_m", 3.0, ["model", "not positive definite"]),
        (flap, "sensor", [{"name": "a", "kind": "gyro"}] * 2, ["sensor names must differ", "a"]),
        (flap, "sensor", [{"name": "<b>", "kind": "gyro"}], ["sensor[0].name = '<b>'"]),
        (flap, "nonlinear.CL_alpha_table", [[0.0, 0.0], [0.0, 1.0]], ["nonlinear.CL_alpha_table", "ascend"]),
        (flap, "nonlinear.CL_alpha_table", [[0.0, 0.0, 1.0], [1.0, 1.0]], ["nonlinear.CL_alpha_table", "alpha_deg"]),
        (state_space, "model.B", [[1.0, 2.0], [0.0, 1.0]], ["model", "B must be 2 x 1", "2 rows of 2"]),
        (state_space, "model.states", ["a", "a"], ["model", "states must differ"]),
        (state_space, "model.altitude_m", 9e4, ["model.altitude_m = 90000.0", "at most 80000"]),
    ],
)
def test_bad_values_are_refused_in_words(make: Any, path: str, value: Any, words: list[str]) -> None:
    """File, field, value and the allowed range are in the message, and nothing of pydantic is."""
    message = refusal(changed(make(), path, value))
    for word in ["wing.toml", *words]:
        assert word in message
    assert "pydantic" not in message
    assert "Input should" not in message


def test_two_dampings_are_refused() -> None:
    """`[damping]` has exactly one sub-table."""
    data = section() | {"damping": {"modal": {"ratios": [0.02]}, "hysteretic": {"g": 0.02}}}
    assert "exactly one" in refusal(data)
    assert "got 2: modal, hysteretic" in refusal(data)


@pytest.mark.parametrize("kind", ["wings", "", 3, None, ["x"], "binary-wing"])
def test_unknown_kind(kind: Any) -> None:
    """An unknown kind is answered with those that exist."""
    message = refusal({"kind": kind})
    assert all(known in message for known in kinds())
    if kind == "binary-wing":
        assert "did you mean 'binary_wing'" in message


def test_every_finding_is_told_but_not_without_end() -> None:
    """Several findings give several lines; a hundred give eight and a count."""
    data = section()
    data["section"] |= {f"x{i}": 1.0 for i in range(100)}
    lines = refusal(data).splitlines()
    assert len(lines) == 9
    assert lines[-1].endswith("and 92 more")


def test_flap_that_does_not_fit_into_the_section() -> None:
    """The 3 x 3 mass matrix decides, not the 2 x 2 ones alone."""
    data = section()
    data["section"]["flap"] = {
        "hinge": 0.8,
        "flap_static_moment_kg": 0.05,
        "flap_inertia_kg_m": 0.004,
        "hinge_stiffness_N": 100.0,
    }
    validate(data, "wing.toml")
    data["section"]["flap"]["flap_inertia_kg_m"] = 0.9  # more than the whole section has
    assert "section and flap is not positive definite" in refusal(data)


def test_stiffness_from_the_beam() -> None:
    """K_h = 4 EI/s^3 and K_theta = GJ/s."""
    data = wing()
    for spring in ("plunge_stiffness_N_per_m", "pitch_stiffness_N_m"):
        del data["wing"][spring]
    data["wing"] |= {"EI_N_m2": 30.0, "GJ_N_m2": 50.0}
    model: Any = validate(data, "wing.toml")
    assert model.wing.K_h == pytest.approx(4.0 * 30.0 / 8.0, rel=1e-15)
    assert model.wing.K_theta == pytest.approx(25.0, rel=1e-15)


def test_eccentricity_defaults_and_disagrees() -> None:
    """e is x_f/c - 1/4 unless given; where both are given and differ, that is a finding, not an error."""
    model: Any = validate(wing(), "wing.toml")
    assert model.wing.e == pytest.approx(0.15)
    model = validate(changed(wing(), "wing.eccentricity", 0.2), "wing.toml")
    assert model.wing.e == 0.2
    assert "disagrees with flexural_axis - 1/4 = 0.15" in model.problems()[0]
    assert model.wing.a == pytest.approx(-0.2)


@pytest.mark.parametrize(("axis", "findings"), [(1.99, 0), (2.01, 1), (-0.99, 0), (-1.01, 1)])
def test_mass_axis_far_outside_the_chord_is_only_a_finding(axis: float, findings: int) -> None:
    """More than a chord outside the chord warns; the file is still taken."""
    data = changed(beam(), "wing.station.0.cg_axis", axis)
    model = validate(changed(data, "wing.station.0.inertia_kg_m", 1e4), "wing.toml")
    assert len(model.problems()) == findings
    mass, chord, flexural = 36.0, 0.6096, 0.30
    data = changed(section(), "section.static_moment_kg", mass * chord * (axis - flexural))
    model = validate(changed(data, "section.inertia_kg_m", 1e3), "wing.toml")
    assert len(model.problems()) == findings


def test_derived_numbers_of_the_nasa_section() -> None:
    """The preset's SI numbers are the report's ratios again."""
    derived = read("nasa-typical-section").derived()
    assert derived["mass_ratio_sea_level"] == pytest.approx(10.0, rel=1e-14)
    assert derived["theodorsen_a"] == pytest.approx(-0.4, rel=1e-14)
    assert derived["x_alpha"] == pytest.approx(0.2, rel=1e-14)
    assert derived["r_alpha_squared"] == pytest.approx(0.25, rel=1e-14)
    assert 2.0 * math.pi * derived["uncoupled_plunge_Hz"] == pytest.approx(50.0, rel=1e-14)
    assert 2.0 * math.pi * derived["uncoupled_pitch_Hz"] == pytest.approx(100.0, rel=1e-14)


def test_thesis_presets_hold_the_inferred_values() -> None:
    """`inferred_binary_half_wing`: mass 10 kg, e a_w = 0.549, b_c/a_c = -0.21396, reversal and divergence pressures."""
    for name in ("thesis-binary", "thesis-aircraft"):
        w = read(name).wing  # type: ignore[attr-defined]
        assert w.mass_kg_per_m2 * w.semi_span_m * w.chord_m == pytest.approx(10.0, rel=1e-12)
        assert w.e * w.lift_slope_per_rad == pytest.approx(0.549, rel=1e-12)
        assert w.elevon.moment_per_rad / w.elevon.lift_per_rad == pytest.approx(-0.21396, rel=1e-12)
        # 3 K_theta/(e c^2 s a_w) at sea level: 81.00479 m/s (targets.json)
        q = 3.0 * w.K_theta / (w.e * w.chord_m**2 * w.semi_span_m * w.lift_slope_per_rad)
        assert math.sqrt(2.0 * q / 1.225) == pytest.approx(81.00479, rel=1e-6)


def test_presets_are_found_valid_and_described() -> None:
    """Those of the first release are there; every preset is valid and names its kind."""
    found = {preset.name: preset for preset in presets()}
    assert {"thesis-binary", "thesis-aircraft", "wright-cooper-binary", "nasa-typical-section", "goland"} <= set(found)
    for name, preset in found.items():
        model = read(name)
        assert model.kind == preset.kind
        assert model.name == name
        assert 20 < len(preset.description) < 140


def test_json_schema_is_current() -> None:
    """The shipped schema is what the classes say: `python -m aeroservo.aircraft.schema` renews it."""
    assert json.loads(SCHEMA_FILE.read_text(encoding="utf-8")) == json_schema()


def test_json_schema_describes_every_number() -> None:
    """Every number has a description with a unit, and limits on both sides."""

    def numbers(schema: Any) -> Any:
        if isinstance(schema, dict):
            for name, field in schema.get("properties", {}).items():
                options = [field, *field.get("anyOf", [])]
                yield from ((name, field, option) for option in options if option.get("type") == "number")
            for inner in schema.values():
                yield from numbers(inner)

    found = list(numbers(json_schema()))
    assert len(found) > 80
    for name, field, option in found:
        assert field["description"].endswith("]"), name
        assert {"minimum", "exclusiveMinimum"} & option.keys(), name
        assert {"maximum", "exclusiveMaximum"} & option.keys(), name


def test_crlf_and_byte_order_mark_are_read(tmp_path: Path) -> None:
    """A file written on Windows is a model file."""
    text = Path(SCHEMA_FILE.parent, "presets", "goland.toml").read_text(encoding="utf-8")
    path = tmp_path / "wing.toml"
    path.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert read(path).derived() == read("goland").derived()


def test_a_nameless_model_is_named_after_its_file() -> None:
    """The file's stem is the name where the file gives none."""
    text = 'kind = "state_space"\n[model]\nA = [[1]]\nB = [[1]]\nC = [[1]]\nD = [[0]]\nstates = ["a"]\n'
    text += 'inputs = ["u"]\noutputs = ["y"]\nspeed_m_s = 3\naltitude_m = 0\n'
    assert parse(text, Path("folder/mine.toml")).name == "mine"
