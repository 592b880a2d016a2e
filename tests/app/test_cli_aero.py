"""The command `aero`: the contract's JSON, tables, files, figures; and what it refuses."""

from __future__ import annotations

import csv
import json
import shutil
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aeroservo.studies import section_polar
from aeroservo.studies.aircraft_aero import aircraft_coefficients, kinematic_viscosity, read_aircraft
from aeroservo.studies.wing_polar import wing_polar

Cli = Callable[..., Any]

ACCEPT = json.loads((files("aeroservo") / "cases" / "thesis_wing" / "reference.json").read_text(encoding="utf-8"))[
    "acceptance"
]
SAME = 1e-12  # the command prints the floats that the function returns
KEYS = {
    "schema_version", "model", "altitude_m", "density_kg_m3", "warnings", "CL_alpha", "CM_alpha", "CL_q", "CM_q",
    "CL_delta", "CM_delta", "CL0", "CM0", "neutral_point_m", "span_efficiency", "reference",
}  # fmt: skip


def rows_of(path: Path) -> list[dict[str, str]]:
    """The lines of a CSV file under its comments."""
    return list(csv.DictReader(x for x in path.read_text(encoding="utf-8").splitlines() if not x.startswith("#")))


def changed(cli: Cli, folder: Path, old: str, new: str) -> Path:
    """A copy of thesis-uav with something else in it."""
    path = folder / "mine.toml"
    if not path.exists():
        assert cli("new", "thesis-uav", path).code == 0
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path


def test_json_is_the_contract_s(cli: Cli) -> None:
    """Exactly the keys of the contract, with the function's numbers, within what the issue accepts."""
    answer = cli("aero", "thesis-uav", "--json")
    assert answer.code == 0
    found = answer.json
    assert set(found) == KEYS
    own = aircraft_coefficients(read_aircraft("thesis-uav"))
    for key in ("CL_alpha", "CM_alpha", "CL_q", "CM_q", "CL0", "CM0", "span_efficiency"):
        assert found[key] == pytest.approx(getattr(own, key), rel=SAME)
    assert found["CL_delta"] == {"elevon": pytest.approx(own.CL_delta[0], rel=SAME)}
    assert found["CM_delta"] == {"elevon": pytest.approx(own.CM_delta[0], rel=SAME)}
    assert set(found["reference"]) == {"S_m2", "c_m", "span_m", "moment_point_m", "rates"}
    assert found["reference"]["rates"] == "c/(2V)"
    assert found["reference"]["moment_point_m"] == pytest.approx([0.35894, 0.0, 0.0], abs=1e-5)
    for key in ("CL_alpha", "CL_q", "CM_q"):
        target, tolerance = ACCEPT[key]
        assert found[key] == pytest.approx(target, rel=tolerance), key
    for key in ("CL_delta", "CM_delta"):
        target, tolerance = ACCEPT[f"{key}_streamwise"]
        assert found[key]["elevon"] == pytest.approx(target, rel=tolerance), key
    assert found["neutral_point_m"] == pytest.approx(ACCEPT["x_neutral_point_m"][0], abs=0.003)


def test_prandtl_glauert_and_panels(cli: Cli) -> None:
    """A higher Mach number means more lift; coarser panels another number, and the table says how many."""
    slow, fast = (cli("aero", "thesis-uav", "--mach", m, "--json").json["CL_alpha"] for m in (0.0, 0.5))
    assert 1.04 < fast / slow < 1.0 / np.sqrt(1.0 - 0.25)
    assert "vortex lattice, 48 panels" in cli("aero", "thesis-uav", "--panels", "6x8").out


def test_files_hold_what_the_functions_return(cli: Cli, tmp_path: Path) -> None:
    """Derivatives, wing polars and loading, each whole and with all digits."""
    out, polars, loading = (tmp_path / name for name in ("d.csv", "p.csv", "l.csv"))
    options = ("--out", out, "--polar-out", polars, "--loading-out", loading)
    answer = cli("aero", "thesis-uav", "--speed", "30", "--alpha", "0:6:2", "--deflection", "0,5", *options)
    assert answer.code == 0
    inputs = {row["input"]: row for row in rows_of(out)}
    assert set(inputs) == {"steady", "alpha", "beta", "p", "q", "r", "elevon", "elevon_antisymmetric"}
    assert float(inputs["elevon_antisymmetric"]["Cl"]) < 0.0  # starboard down rolls to port
    assert float(inputs["elevon_antisymmetric"]["CL"]) == 0.0
    model = read_aircraft("thesis-uav")
    own = aircraft_coefficients(model)
    assert float(inputs["alpha"]["CL"]) == pytest.approx(own.CL_alpha, rel=SAME)
    from aeroservo.studies.aircraft_aero import PANELS

    nu = kinematic_viscosity()
    wings = wing_polar(
        model, alpha=np.radians([0, 2, 4, 6]), delta=np.radians([0, 5]), speed=30.0, viscosity=nu, method=PANELS
    )
    table = rows_of(polars)
    assert [float(r["delta_deg"]) for r in table] == [0.0] * 4 + [5.0] * 4
    for name, value in (("CD", "CD"), ("CM", "CM_viscous"), ("L_over_D", "lift_to_drag")):
        expected = np.concatenate([getattr(w, value) for w in wings])
        np.testing.assert_allclose([float(r[name]) for r in table], expected, rtol=1e-9)
    strips = rows_of(loading)
    area = [float(r["chord_m"]) * float(r["width_m"]) for r in strips]
    lift = 2.0 * sum(a * float(r["cl_alpha"]) for a, r in zip(area, strips))  # both halves, S = 1
    assert lift == pytest.approx(own.CL_alpha, rel=1e-6)


def test_the_table_says_what_flies(cli: Cli) -> None:
    """Static margin against the file's centre of gravity, wing polars with a speed, a hint without."""
    alone = cli("aero", "thesis-uav")
    assert "unstable" in alone.out and "--speed" in alone.out
    flown = cli("aero", "thesis-uav", "--speed", "30", "--alpha", "2,4", "--deflection", "0")
    assert "XFOIL 6.99" in flown.out and "L/D" in flown.out


def test_marks_are_told(cli: Cli) -> None:
    """Angles far outside leave no drag behind, and the warning says so."""
    answer = cli("aero", "thesis-uav", "--speed", "30", "--alpha", "2,40", "--deflection", "0")
    assert answer.code == 0
    assert "1 of 2 angles are marked" in answer.err


@pytest.mark.parametrize("figure", ["polars", "morphed", "loading", "trim"])
def test_every_figure_is_written(cli: Cli, tmp_path: Path, figure: str) -> None:
    """Whole PNG files."""
    path = tmp_path / "figure.png"
    answer = cli("aero", "thesis-uav", "--speed", "30", "--panels", "8x12", "--figure", figure, "--plot", path)
    assert answer.code == 0
    assert path.read_bytes().startswith(b"\x89PNG") and path.stat().st_size > 20_000


@pytest.mark.parametrize("command", ["aero", "polar"])
@pytest.mark.parametrize("model", ["goland", "thesis-binary", "thesis-appendix", "thesis-simulation"])
def test_other_kinds_are_refused(cli: Cli, command: str, model: str) -> None:
    """Code 2, with the kind and what to use."""
    answer = cli(command, model, "--json")
    assert (answer.code, answer.out) == (2, "")
    assert "kind 'aircraft'" in answer.err and "thesis-uav" in answer.err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--speed", "3"), ["Reynolds number", "500000 to 2.5e+06", "--source"]),
        (("--speed", "30", "--deflection", "20"), ["deflection", "-10 to 15 deg"]),
        (("--figure", "trim", "--plot", "t.png"), ["--speed"]),
        (("--polar-out", "p.csv"), ["--speed"]),
        (("--out", "derivatives.txt"), ["--out", ".csv"]),
        (("--mach", "1.2"), ["--mach"]),
        (("--panels", "many"), ["--panels", "NxM"]),
        (("--alpha", "4:0:1"), ["--alpha", "MIN < MAX"]),
        (("--alpha", "a,b"), ["--alpha"]),
        (("--deflection", "nan"), ["--deflection", "-40 to 40"]),
        (("--speed", "-3"), ["airspeed"]),
        (("--altitude", "0", "--density", "1"), ["not both"]),
        (("--speed", "30", "--density", "0"), ["density"]),
    ],
)
def test_bad_options(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], words: list[str]
) -> None:
    """Code 2, nothing on stdout, nothing written."""
    monkeypatch.chdir(tmp_path)
    answer = cli("aero", "thesis-uav", *options, "--json")
    assert (answer.code, answer.out) == (2, "")
    for word in words:
        assert word in answer.err
    assert list(tmp_path.iterdir()) == []


SECOND_CONTROL = """[[surface.control]]
name = "tab"
from_span = {0}
to_span = {1}
hinge_from = 0.8

[[mass]]"""
FOLDED = """[[surface.section]]
y_m = 0.5
z_le_m = 0.2
chord_m = 0.4

[[surface.section]]
y_m = 0.5
z_le_m = -0.2
chord_m = 0.4

[[surface.control]]"""


@pytest.mark.parametrize("command", ["check", "aero", "polar"])
@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[[surface.control]]", FOLDED, ["crosses itself", "order the sections"]),
        ("chord_m = 0.3", "chord_m = 0.0", ["chord_m = 0.0", "greater than 0"]),
        ("y_m = 0.0", "y_m = -0.2", ["crosses its twin", "y must be >= 0"]),
        ("to_span = 1.0", "to_span = 1.2", ["to_span = 1.2", "at most 1"]),
        ("from_span = 0.5", "from_span = 1.0", ["from_span"]),
        ("[[mass]]", SECOND_CONTROL.format(0.4, 0.7), ["overlap", "shorten one"]),
    ],
)
def test_bad_geometry(cli: Cli, tmp_path: Path, command: str, old: str, new: str, words: list[str]) -> None:
    """A planform across itself, no chord, controls outside or over one another: each says what to do."""
    path = changed(cli, tmp_path, old, new)
    answer = cli(command, path)
    assert (answer.code, answer.out) == (2, "")
    for word in ["mine.toml", *words]:
        assert word in answer.err


def test_check_prints_and_draws(cli: Cli, tmp_path: Path) -> None:
    """Derived figures, assumptions, and three views for aircraft alone."""
    path = tmp_path / "views.pdf"
    answer = cli("check", "thesis-uav", "--plot", path, "--json")
    derived = answer.json["derived"]
    assert derived["wing_area_m2"] == pytest.approx(1.0, rel=1e-9)
    assert derived["wing_mac_m"] == pytest.approx(0.526667, abs=1e-6)
    assert derived["wing_aspect_ratio"] == pytest.approx(4.0, rel=1e-9)
    assert derived["wing_taper"] == pytest.approx(3.0 / 7.0, rel=1e-9)
    assert derived["cg_x_m"] == pytest.approx(0.4906, abs=1e-4)
    assert derived["Iyy_about_moment_point_kg_m2"] == pytest.approx(0.498, abs=1e-3)
    assert path.read_bytes().startswith(b"%PDF")
    people = cli("check", "thesis-uav").out
    assert people.count("assumed: ") >= 6 and "problem: assumed" not in people
    refused = cli("check", "goland", "--plot", tmp_path / "g.png")
    assert (refused.code, refused.out) == (2, "") and "planform" in refused.err
    assert not (tmp_path / "g.png").exists()


AVL = """Plank
0.0
0 0 0
4 1 4
0.25 0 0
SURFACE
Wing
8 1
YDUPLICATE
0
SECTION
0 0 0 1 0
AFILE
foil.dat
CONTROL
elevon 1 0.75 0 0 0 1
SECTION
0 2 0 1 0
AFILE
foil.dat
CONTROL
elevon 1 0.75 0 0 0 1
"""


def test_avl_files_become_model_files(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`new plank.avl plank.toml`, its airfoil found from any folder; over nothing that exists."""
    foil = (files("aeroservo.aero") / "airfoils" / "mh62.dat").read_bytes()
    (tmp_path / "foil.dat").write_bytes(foil)
    (tmp_path / "plank.avl").write_text(AVL, encoding="utf-8")
    target = tmp_path / "plank.toml"
    answer = cli("new", tmp_path / "plank.avl", target)
    assert answer.code == 0 and "streamwise" in answer.err
    assert 'airfoil = "foil.dat"' in target.read_text(encoding="utf-8")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    found = cli("aero", target, "--panels", "8x40", "--json").json
    assert found["CL_alpha"] == pytest.approx(3.64407, rel=0.01)  # rectangle of aspect ratio 4, lifting_surface
    assert found["CL0"] > 0.0  # camber of the file's airfoil
    content = target.read_bytes()
    assert cli("new", tmp_path / "plank.avl", target).code == 2
    assert target.read_bytes() == content
    assert cli("new", tmp_path / "no.avl", tmp_path / "no.toml").code == 2
    assert not (tmp_path / "no.toml").exists()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('airfoil = "mh62"', 'airfoil = "naca2412"', ["mixes airfoils (mh62, naca2412)", "split"]),
        ("hinge_to = 0.75", "hinge_to = 0.7", ["the hinge runs from 0.75 to 0.7", "one chord fraction"]),
        ("hinge_from = 0.75\nhinge_to = 0.75", "hinge_from = 0.7\nhinge_to = 0.7", ["0.7 of the chord", "pip install"]),
        ('kind = "hinged"', 'kind = "morphed"\nreading = "same_slope"', ["morphed", "pip install"]),
    ],
)
def test_a_table_is_never_taken_for_another_section(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, old: str, new: str, words: list[str]
) -> None:
    """The shipped table is of one hinge: any other control needs a program, and without one there is no drag."""
    monkeypatch.setattr(section_polar, "find_spec", lambda name: None)
    monkeypatch.setattr(shutil, "which", lambda name, *a, **k: None)
    path = tmp_path / "mine.toml"
    assert cli("new", "thesis-uav", path).code == 0
    lines = [x.split("  #")[0].rstrip() for x in path.read_text(encoding="utf-8").splitlines()]
    path.write_text("\n".join(lines), encoding="utf-8")
    changed(cli, tmp_path, old, new)
    answer = cli("aero", path, "--speed", "30", "--json")
    assert (answer.code, answer.out) == (2, "")
    for word in ["surface 'wing'", *words]:
        assert word in answer.err
    assert cli("aero", path, "--json").code == 0  # the lattice alone needs none of it
