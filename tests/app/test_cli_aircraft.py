"""The elastic wing of an aircraft file on the command line: one file, every analysis at once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import aeroservo as av
from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.static import static

Cli = Callable[..., Any]


def test_every_analysis_of_the_preset(cli: Cli) -> None:
    """`modes`, `static`, `flutter`, `linearize` of thesis-uav are the Python functions; notes say whence the loads."""
    model = build(av.read("thesis-uav"))
    modes = cli("modes", "thesis-uav", "--json").json
    assert modes["names"][:3] == ["bending 1", "torsion 1", "bending 2"]
    sweep = av.FlightCondition.at(3048.0, V=np.arange(60.0, 121.0, 20.0))
    still = cli("static", "thesis-uav", "--json", "--altitude", "3048", "--speeds", "60:120:20").json
    assert still["divergence_speed_m_s"] is None  # swept aft
    assert still["reversal_quantity"] == "roll"
    assert still["reversal_speed_m_s"] == static(model, sweep).reversal.V
    flutter = cli("flutter", "thesis-uav", "--json", "--altitude", "3048", "--speeds", "60:120:20").json
    assert (flutter["method"], flutter["aero"]) == ("pk", "theodorsen")
    assert flutter["flutter_speed_m_s"] == av.flutter(model, sweep, av.PK()).flutter_speed
    assert flutter["flutter_speed_m_s"] == pytest.approx(96.8, abs=0.1)
    linear = cli("linearize", "thesis-uav", "--json", "--speed", "40", "--aero", "quasi_steady_damped").json
    assert linear["inputs"] == ["elevon_antisymmetric_rad", "elevon_rad", "gust_m_s"]
    assert len(linear["states"]) == len(linear["A"]) == 2 * len(modes["names"])
    for answer in (modes, still, flutter, linear):
        assert any("lattice" in note for note in answer["warnings"])


@pytest.mark.parametrize("aero", ["quasi_steady", "jones"])
def test_other_air_forces(cli: Cli, aero: str) -> None:
    """`--aero` others."""
    found = cli("flutter", "thesis-uav", "--json", "--aero", aero, "--speeds", "20:110:30").json
    assert found["aero"] == aero
    assert found["found"] is True


def test_check_says_what_was_taken_from_where(cli: Cli) -> None:
    """The assumption about EI and GJ, and the sources of the strips."""
    problems = " ".join(cli("check", "thesis-uav", "--json").json["problems"])
    assert "EI = K_h s3/4 = 411 N m2, GJ = K_theta s = 413.2 N m2" in problems
    assert "elastic wing" in problems
    assert "span loading of the lattice" in problems


def test_a_rigid_aircraft_is_valid_and_does_not_flutter(cli: Cli, tmp_path: Path) -> None:
    """Without [structure], `check` passes and `flutter` says what to add."""
    path = tmp_path / "rigid.toml"
    path.write_text(
        'kind = "aircraft"\nname = "rigid"\n[[surface]]\nname = "wing"\n'
        "[[surface.section]]\ny_m = 0.0\nchord_m = 0.5\n[[surface.section]]\ny_m = 2.0\nchord_m = 0.5\n",
        encoding="utf-8",
    )
    assert cli("check", path).code == 0
    answer = cli("flutter", path)
    assert answer.code == 2
    assert "[structure]" in answer.err
    assert answer.out == ""


def test_a_sweep_over_the_stiffness(cli: Cli, tmp_path: Path) -> None:
    """`--over` a number of the structure: the stiffer in torsion, the later it flutters."""
    over = ("--over", "structure.station[1].GJ_N_m2=300:500:100", "--out", tmp_path / "sweep.json")
    answer = cli("flutter", "thesis-uav", "--json", "--speeds", "40:130:30", *over)
    assert answer.code == 0, answer.err
    speeds = [point["flutter_speed_m_s"] for point in answer.json["points"]]
    assert len(speeds) == 3
    assert speeds[0] < speeds[1] < speeds[2]


def test_pitch_plunge_model_of_an_aircraft(cli: Cli, tmp_path: Path) -> None:
    """`new thesis-uav FILE --as pitch_plunge_flap`: every number with its source; it runs; bad words are told."""
    file = tmp_path / "pp.toml"
    assert cli("new", "thesis-uav", file, "--as", "pitch_plunge_flap", "--pitch-axis", 0.374).code == 0
    text = file.read_text()
    assert "CL_alpha = 3.63868" in text and "# vortex lattice, 768 panels" in text and "x = 0.374 m (given)" in text
    answer = cli("static", file, "--json", "--altitude", 3048).json
    assert answer["divergence_speed_m_s"] == pytest.approx(119.6, abs=0.5)
    assert answer["reversal_speed_m_s"] == pytest.approx(35.9, abs=0.05)
    assert cli("simulate", file, "--speed", 15, "--duration", 1, "--json").json["bounded"]
    for words, message in (
        (("thesis-uav", file, "--as", "pitch_plunge_flap"), "exists already"),
        (("thesis-uav", tmp_path / "b.toml", "--as", "beam_wing"), "must be pitch_plunge_flap"),
        (("bact", tmp_path / "b.toml", "--as", "pitch_plunge_flap"), "holds no wing sections"),
        (("bact", tmp_path / "b.toml", "--pitch-axis", 0.3), "goes with --as"),
    ):
        answer = cli("new", *words)
        assert answer.code == 2 and message in answer.err
