"""The command `margins`: JSON, text, figure, standards, bad input; the numbers are those of the functions behind it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import aeroservo as av
from aeroservo.control.closed_loop import loop_plant
from aeroservo.control.controller import read_controller
from aeroservo.control.disk_margins import disk_margin
from aeroservo.datatypes import FlightCondition
from aeroservo.studies.controller_check import controller_check

Cli = Callable[..., Any]


@pytest.fixture
def rate_loop(tmp_path: Path) -> Path:
    """An autopilot's pitch-rate loop with a filter, 200 Hz, one sample late, fed plunge too (with no gain)."""
    content = {
        "A": [[0.5]], "B": [[0.0, 0.5]], "C": [[0.1]], "D": [[0.0, 0.0]], "dt_s": 0.005, "delay_s": 0.005,
        "inputs": ["plunge_m", "pitch_rate_rad_s"], "outputs": ["elevon_command_rad"],
    }  # fmt: skip
    path = tmp_path / "autopilot.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


def test_json(cli: Cli, rate_loop: Path) -> None:
    """Every speed, every loop at inputs and outputs; delays; zeros of what is read; nothing infinite."""
    words = ("margins", "thesis-simulation", "--controller", rate_loop, "--altitude", 3048, "--speeds", "40:140:50")
    content = cli(*words, "--delays", "0.005:0.02:0.005", "--json").json
    assert content["total_delay_s"] == 0.005
    assert [p["speed_m_s"] for p in content["speeds"]] == [40.0, 90.0, 140.0]
    own, model = read_controller(rate_loop), av.build(av.read("thesis-simulation"))
    for p in content["speeds"]:
        at = FlightCondition.at(3048.0, V=p["speed_m_s"])
        alpha = disk_margin(loop_plant(model, at, own), own).alpha
        assert p["disk_margin"]["inputs"] == pytest.approx(alpha, rel=1e-9)
        assert p["stable"] is (alpha > 0.0)
        assert next((m["at"], m["channel"]) for m in p["loops"]) == ("input", "elevon_command_rad")
        assert len(p["loops"]) == 3
    lost = content["speeds"][-1]  # past divergence, which no rate loop moves
    assert not lost["stable"]
    assert lost["loops"][0]["gain_up_dB"] is None
    alpha = np.array(content["delays"]["alpha"])
    assert alpha.shape == (3, 4)
    assert np.all(np.diff(alpha[0]) < 0.0)
    assert np.all(np.diff(alpha[1][alpha[1] > 0.0]) < 0.0)  # unstable from 15 ms on
    assert np.all(alpha[2] == 0.0)
    zeros = {z["sensor"]: z for z in content["zeros"]}
    assert zeros["plunge_m"]["crossings_m_s"] == pytest.approx([53.29], abs=0.01)
    assert zeros["pitch_rate_rad_s"]["right_half_plane_1_s"] == [None, None, None]


def test_text_figure_and_standards(cli: Cli, rate_loop: Path, tmp_path: Path) -> None:
    """A table for people, rows that pass and fail, a figure, a file."""
    out, plot = tmp_path / "m.json", tmp_path / "m.png"
    answer = cli(
        "margins", "thesis-simulation", "--controller", rate_loop, "--speeds", "30:110:40", "--vo", 45, "--vl", 60,
        "--vd", 95, "--out", out, "--plot", plot,
    )  # fmt: skip
    assert answer.code == 0
    for word in ("total delay 5 ms", "crosses the axis", "from memory", "pass", "FAIL", "30 ms"):
        assert word in answer.out
    rules = json.loads(out.read_text(encoding="utf-8"))["rules"]
    assert len(rules) == 7
    assert not rules[-1]["pass"]  # 1.2 V_D = 114 m/s lies past divergence at sea level
    assert plot.read_bytes().startswith(b"\x89PNG")
    unstable = cli("margins", "thesis-simulation", "--controller", rate_loop, "--speeds", "130:150:20", "--plot", plot)
    assert "unstable" in unstable.out


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--vo", "40"], "both V_o and V_L"),
        (["--vo", "60", "--vl", "50"], "V_o <= V_L"),
        (["--vd", "-3"], "V_D"),
        (["--delays", "0:2:0.5"], "from 0 to 1"),
        (["--delays", "x"], "--delays"),
        (["--plot", "x.svg"], ".png or .pdf"),
        (["--fit-bound", "0"], "--fit-bound"),
    ],
)
def test_bad_input(cli: Cli, rate_loop: Path, options: list[str], word: str) -> None:
    """Exit 2 with the reason, nothing on stdout."""
    answer = cli("margins", "thesis-simulation", "--controller", rate_loop, "--speeds", "40:60:20", "--json", *options)
    assert (answer.code, answer.out) == (2, "")
    assert word in answer.err


def test_other_refusals(cli: Cli, tmp_path: Path) -> None:
    """No controller, a file that is none, a model without a state space."""
    assert cli("margins", "thesis-simulation").code == 2
    assert cli("margins", "thesis-simulation", "--controller", tmp_path / "none.json").code == 2
    path = tmp_path / "k.json"
    path.write_text('{"D": [[0.1]], "dt_s": 0.01, "inputs": ["x"], "outputs": ["y"]}', encoding="utf-8")
    answer = cli("margins", "thesis-appendix", "--controller", path)
    assert (answer.code, answer.out) == (2, "")


def test_free_positions_have_no_zeros() -> None:
    """The heave of a free aircraft is no part of the plant of zeros, and no reason to fail."""
    model = av.build(av.read("thesis-aircraft"))
    from aeroservo.control.controller import state_feedback

    sweep = FlightCondition.at(0.0, V=[30.0, 40.0])
    own = state_feedback(np.array([[0.0, 0.01]]), ("heave_m", "torsion_1_rate_rad_s"), ("elevon_rad",), 0.005)
    check = controller_check(model, sweep, own, delays_s=(0.005,))
    assert [z.sensor for z in check.zeros] == [own.inputs[1]]
