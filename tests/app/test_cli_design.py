"""`design`: the contract's JSON, the same numbers as the Python functions, files that fly, and every refusal."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat

import aeroservo as av
from aeroservo.control.controller import read_controller
from aeroservo.control.lqg import LQG
from aeroservo.control.synthesis import synthesise
from aeroservo.datatypes import FlightCondition

Cli = Callable[..., Any]
KEYS = {"schema_version", "model", "altitude_m", "density_kg_m3", "warnings", "method", "speed_m_s", "states", "inputs",
        "measured", "K", "closed_loop_eigenvalues", "residual", "disk_margin_alpha", "dt_s", "delay_s",
        "dynamic_pressure_Pa"}  # fmt: skip
LQR_55 = ("design", "thesis-simulation", "--method", "lqr", "--speed", 55, "--altitude", 3048, "--q", "1,1,1,1",
          "--r", "1", "--no-actuator")  # fmt: skip


def test_json_is_the_contracts(cli: Cli) -> None:
    """Keys, K of the issue, roots in pairs, and words for people with the same numbers."""
    found = cli(*LQR_55, "--json").json
    assert set(found) == KEYS
    np.testing.assert_allclose(found["K"], [[-6.783, -1.690, -0.573, -0.916]], atol=1e-3)
    assert found["states"] == ["plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s"]
    assert found["inputs"] == ["elevon_rad"] and found["method"] == "lqr" and found["speed_m_s"] == 55.0
    assert len(found["closed_loop_eigenvalues"]) == 4 and all(len(v) == 2 for v in found["closed_loop_eigenvalues"])
    assert found["residual"] < 1e-12 and found["dt_s"] is None
    # Kalman's inequality: |S| <= 1, so that alpha of a continuous regulator is at least 2/3
    assert 2.0 / 3.0 <= found["disk_margin_alpha"] <= 2.0
    text = cli(*LQR_55).out
    assert "-6.78306" in text and "disk margin alpha" in text and "continuous" in text


def test_the_thesis_gain_from_its_appendix(cli: Cli) -> None:
    """A state_space model: designed at its own condition."""
    found = cli("design", "thesis-appendix", "--method", "lqr", "--q", "1,1,1,1,1", "--r", "1", "--json").json
    np.testing.assert_allclose(found["K"][0], [8.6714, 3.4228, 18.166, 0.1854, 2.5293], rtol=2e-4)
    assert found["speed_m_s"] == pytest.approx(56.48)
    named = cli("design", "thesis-appendix", "--method", "lqg", "--q", "pitch_rad=1", "--w", "1,1,1,1,1",
                "--sensors", "pitch_rate_rad_s,plunge_m", "--rate", 100, "--json")  # fmt: skip
    assert named.code == 0 and named.json["measured"] == ["pitch_rate_rad_s", "plunge_m"]
    outputs = cli("design", "thesis-appendix", "--method", "pid", "--kp", "-20", "--sensors", "nose_down_rad", "--json")
    assert outputs.code == 0 and outputs.json["measured"] == ["nose_down_rad"]


def test_lqg_of_bact_is_the_python_function_and_flies(cli: Cli, tmp_path: Path) -> None:
    """Sensors of the file, one sample of delay; the controller file closes the loop of `simulate` beyond flutter."""
    file = tmp_path / "bact.json"
    found = cli(
        "design", "bact", "--method", "lqg", "--speed", 125, "--density", 1.01628, "--q", "0,800,0,1", "--r", "33",
        "--sensors", "acc_te,pitch_rate_rad_s", "--rate", 200, "--delay-samples", 1, "--recovery", 10,
        "--v", "0.1,0.002", "--limit-deg", 12, "--out", file, "--json",
    ).json  # fmt: skip
    design = LQG(
        Q=[0.0, 800.0, 0.0, 1.0], R=[33.0], gust=0.1, V=np.array([0.1, 0.002]) ** 2, recovery=math.radians(10.0)
    )
    same = synthesise(
        av.build(av.read("bact")), design, FlightCondition(V=125.0, rho=1.01628), rate_Hz=200.0, delay_samples=1,
        sensors=("acc_te", "pitch_rate_rad_s"),
    )  # fmt: skip
    np.testing.assert_allclose(found["K"], same.design.K, rtol=1e-12)
    assert found["disk_margin_alpha"] == same.margins[0].alpha > 0.5
    assert (found["dt_s"], found["delay_s"], found["measured"]) == (0.005, 0.005, ["acc_te_m_s2", "pitch_rate_rad_s"])
    assert max(math.hypot(*z) for z in found["closed_loop_eigenvalues"]) < 1.0
    controller = read_controller(file)
    np.testing.assert_array_equal(controller.A, same.controller.A)
    assert controller.limits == (math.radians(12.0),) and np.any(controller.windup)
    words = ("simulate", "bact", "--speed", 125, "--density", 1.01628, "--duration", 6, "--json")
    assert cli(*words).json["bounded"] is False
    assert cli(*words, "--controller", file).json["bounded"] is True


def test_an_autopilot_rate_loop_is_checked_for_what_it_does_to_the_wing(cli: Cli, tmp_path: Path) -> None:
    """A user's PID with its filters, from its file: flutter with the loop closed, and the margin of the design."""
    file = tmp_path / "autopilot.json"
    words = ("--method", "pid", "--sensors", "pitch_rate_rad_s", "--kp", "-0.4", "--rate", 200, "--delay-samples", 1,
             "--filter", "lowpass:150", "--speed", 50, "--altitude", 3048)  # fmt: skip
    found = cli("design", "thesis-simulation", *words, "--out", file, "--json").json
    sweep = ("--altitude", 3048, "--speeds", "30:60:10", "--json")
    alone = cli("flutter", "thesis-simulation", *sweep).json
    assert alone["flutter_speed_m_s"] == pytest.approx(45.4, abs=0.1)
    closed = cli("flutter", "thesis-simulation", *sweep, "--controller", file).json
    assert closed["flutter_speed_m_s"] is None and found["disk_margin_alpha"] > 0.4
    margins = cli("margins", "thesis-simulation", *sweep, "--controller", file).out
    assert f"{found['disk_margin_alpha']:.8f}"[:9] in margins


def test_a_schedule_is_a_list_of_designs(cli: Cli, tmp_path: Path) -> None:
    """Every value a list over its points; the file has them; the sentence says how stable it is between."""
    file = tmp_path / "schedule.json"
    answer = cli("design", "bact", "--method", "lqr", "--speeds", "60:140:20", "--density", 1.01628, "--rate", 200,
                 "--delay-samples", 1, "--q", "pitch_rad=800,pitch_rate_rad_s=1", "--r", "33", "--out", file,
                 "--json")  # fmt: skip
    found = answer.json
    assert found["speed_m_s"] == [60.0, 80.0, 100.0, 120.0, 140.0]
    assert np.shape(found["K"]) == (5, 1, len(found["states"])) and len(found["disk_margin_alpha"]) == 5
    assert "stable at all" in answer.err and min(found["disk_margin_alpha"]) > 0.5
    np.testing.assert_allclose(read_controller(file).pressures, found["dynamic_pressure_Pa"])
    assert len(json.loads(file.read_text())["points"]) == 5
    table = cli("design", "bact", "--method", "lqr", "--speeds", "100:140:20", "--rate", 200, "--q", "1,1").out
    assert "disk margin" in table and len(table.splitlines()) == 7


def test_files_for_matlab_and_c(cli: Cli, tmp_path: Path) -> None:
    """.mat holds one controller as matrices, a schedule with its points last; .c is C."""
    words = ("design", "thesis-simulation", "--altitude", 3048, "--rate", 200, "--method", "lqr", "--q", "0,1000,0,1")
    assert cli(*words, "--speed", 50, "--out", tmp_path / "one.mat").code == 0
    one = loadmat(tmp_path / "one.mat")
    assert one["D"].shape == (1, 4) and one["dt_s"][0, 0] == 0.005
    assert cli(*words, "--speeds", "40:60:10", "--out", tmp_path / "row.mat").code == 0
    row = loadmat(tmp_path / "row.mat")
    assert row["D"].shape == (1, 4, 3) and row["dynamic_pressure_Pa"].size == 3
    np.testing.assert_array_equal(row["D"][..., 1], one["D"])
    assert cli(*words, "--speed", 50, "--out", tmp_path / "one.c").code == 0
    assert "double" in (tmp_path / "one.c").read_text()


def test_pid_poles_and_integrals(cli: Cli) -> None:
    """The other methods: filters in series, roots where they were asked for, leaky integrals."""
    words = ("design", "thesis-simulation", "--altitude", 3048, "--speed", 50, "--json")
    pid = cli(*words, "--method", "pid", "--sensors", "pitch_rate_rad_s", "--kp", "-0.4", "--rate", 200,
              "--filter", "notch:60:0.3:0.5", "--filter", "lowpass:150", "--filter", "phase:25:-5").json  # fmt: skip
    assert pid["disk_margin_alpha"] > 0.3 and pid["K"] is None and len(pid["closed_loop_eigenvalues"]) == 8
    assert any(
        "unstable" in w for w in cli(*words, "--method", "pid", "--sensors", "pitch_rad", "--kp", "5").json["warnings"]
    )
    poles = cli(*words, "--method", "poles", "--poles", "-5+12j,-5-12j,-9+3i,-9-3i").json
    assert poles["residual"] < 1e-8
    roots = sorted(map(tuple, np.round(poles["closed_loop_eigenvalues"], 6).tolist()))
    assert roots == [(-9.0, -3.0), (-9.0, 3.0), (-5.0, -12.0), (-5.0, 12.0)]
    integral = ("--method", "lqi", "--q", "1,1,1,1", "--integrals")
    assert cli(*words, *integral, "pitch_rad", "--q-integrals", 10).json["states"][-1] == "integral_of_pitch_rad"
    refused = cli(*words, *integral, "plunge_m,pitch_rad")
    assert refused.code == 2 and "rank [A - 0 I, B] is 5 of 6" in refused.err and "leaky" in refused.err
    assert cli(*words, *integral, "plunge_m,pitch_rad", "--leak", 0.5).code == 0


def test_any_kind_of_model(cli: Cli) -> None:
    """A binary wing on lagged strips: lags of the air are simulated inside the controller."""
    found = cli("design", "thesis-binary", "--aero", "jones", "--method", "lqr", "--speed", 60, "--q", "1,1,1,1",
                "--json").json  # fmt: skip
    assert any(name.startswith("lag_") for name in found["states"])
    assert not any(name.startswith("lag_") for name in found["measured"])
    assert max(re for re, _ in found["closed_loop_eigenvalues"]) < 0.0
    text = cli("design", "thesis-binary", "--aero", "theodorsen", "--method", "lqr", "--speed", 60, "--q", "1,1").out
    assert " more" in text
    free = cli("design", "thesis-aircraft", "--method", "lqr", "--speed", 50, "--q", "1,1,1,1,1", "--json").json
    assert "heave_m" not in free["states"] and "heave_rate_m_s" in free["states"]


REFUSED = [
    (("--method", "lqx", "--speed", 50), "lqx"),
    (("--method", "lqr", "--q", "1"), "give --speed M_S, or --speeds"),
    (("--method", "lqr", "--speed", 50, "--speeds", "40:60:10", "--rate", 100, "--q", "1"), "one of them"),
    (("--method", "lqr", "--speed", 50), "needs --q, weights of the states plunge_m"),
    (("--method", "lqr", "--speed", 50, "--q", "1,1,1,1,1"), "--q has 5 values and must have at most 4: plunge_m"),
    (("--method", "lqr", "--speed", 50, "--q", "heave=1"), "'heave' does not exist"),
    (("--method", "lqr", "--speed", 50, "--q", "1,x"), "'x' is no number"),
    (("--method", "lqr", "--speed", 50, "--q", "-1"), "not negative"),
    (("--method", "lqr", "--speed", 50, "--q", "1,,1"), "names with commas"),
    (("--method", "lqr", "--speed", 50, "--q", "1", "--r", "1,1"), "--r has 2 values and must have 1"),
    (("--method", "lqr", "--speed", 50, "--q", "1", "--r", "0"), "R must be positive"),
    (("--method", "lqr", "--speed", 50, "--q", "1", "--rate", "-5"), "--rate must lie"),
    (("--method", "lqr", "--speed", 50, "--q", "1", "--delay-samples", "1"), "needs --rate HZ"),
    (("--method", "lqr", "--speed", 50, "--q", "1", "--delay-samples", "-1", "--rate", 9), "--delay-samples must be"),
    (("--method", "lqr", "--speeds", "40:60:10", "--q", "1"), "give --rate HZ"),
    (("--method", "lqr", "--speeds", "40:60:0.01", "--q", "1", "--rate", 9), "2 to 400 points"),
    (("--method", "lqr", "--speed", 50, "--q", "1", "--limit-deg", "5"), "give --rate HZ"),
    (("--method", "lqr", "--speed", 50, "--q", "1", "--limit-deg", "0", "--rate", 9), "--limit-deg must be positive"),
    (("--method", "lqr", "--speed", 50, "--q", "1", "--poles", "1"), "--poles belongs to --method poles"),
    (("--method", "pid", "--speed", 50, "--q", "1"), "--q belongs to --method lqr or lqi or lqg"),
    (("--method", "pid", "--speed", 50, "--sensors", "pitch_rad"), "needs a gain"),
    (("--method", "pid", "--speed", 50, "--kp", "1"), "feeds back one sensor"),
    (("--method", "pid", "--speed", 50, "--kp", "1", "--sensors", "nose"), "sensor 'nose' does not exist"),
    (("--method", "pid", "--speed", 50, "--kp", "1", "--sensors", "pitch_rad", "--filter", "comb:3"), "'comb:3' must"),
    (("--method", "lqi", "--speed", 50, "--q", "1"), "needs --integrals"),
    (("--method", "poles", "--speed", 50), "needs --poles"),
    (("--method", "poles", "--speed", 50, "--poles", "a"), "is no number such as"),
    (("--method", "poles", "--speed", 50, "--poles", "-1,-2"), "poles must be 4"),
    (("--method", "lqg", "--speed", 50, "--q", "1"), "has no sensors"),
    (("--method", "lqg", "--speed", 50, "--q", "1", "--sensors", "pitch_rad", "--gust-noise", "-1"), "gust must not"),
    (("--method", "lqr", "--speed", 50, "--q", "1", "--sensors", "nose"), "'nose' is no state"),
    (("--method", "lqr", "--speed", -50, "--q", "1"), "airspeed"),
    (("--method", "lqr", "--speed", 50, "--q", "1", "--out", "no/where.json"), "its folder does not exist"),
    (("--method", "lqr", "--speed", 50, "--q", "1", "--out", "controller.txt"), "must end in .json or .mat or .c"),
    (("--method", "lqr", "--speed", 50, "--q", "1", "--out", "controller.c"), "give --rate HZ"),
]  # fmt: skip


@pytest.mark.parametrize(("words", "message"), REFUSED)
def test_bad_input(cli: Cli, words: tuple[Any, ...], message: str) -> None:
    """Exit 2, the option and what is allowed on stderr, nothing on stdout."""
    answer = cli("design", "thesis-simulation", *words)
    assert (answer.code, answer.out) == (2, "")
    assert message in " ".join(answer.err.split())


def test_models_that_cannot(cli: Cli) -> None:
    """No control; a control that needs its actuator; a state_space model elsewhere."""
    for words, message in (
        (("goland", "--method", "lqr", "--speed", 100, "--q", "1"), "no control to design for"),
        (("bact", "--method", "lqr", "--speed", 100, "--q", "1", "--no-actuator"), "needs an actuator"),
        (("thesis-appendix", "--method", "lqr", "--speed", 40, "--q", "1"), "holds at model.speed_m_s"),
        (("thesis-appendix", "--method", "lqg", "--q", "1"), "needs --sensors, out of"),
        (("thesis-appendix", "--method", "lqr", "--q", "1", "--speeds", "1:2:1", "--rate", 9), "has no --speeds"),
        (("thesis-appendix", "--method", "lqg", "--q", "1", "--sensors", "nose"), "output 'nose' does not exist"),
    ):
        answer = cli("design", *words)
        assert (answer.code, answer.out) == (2, "")
        assert message in answer.err
