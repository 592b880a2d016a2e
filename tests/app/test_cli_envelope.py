"""The command `envelope` and `flutter --controller`: JSON of the contract, files, figures, interruption, bad input."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Cli = Callable[..., Any]
KEYS = {
    "altitude_m", "open_loop_intervals", "closed_loop_intervals", "divergence_m_s", "reversal_m_s", "margin_speed_m_s",
    "margin_criterion", "disk_margin", "valid_to_m_s", "valid_to_why",
}  # fmt: skip


@pytest.fixture
def damper(tmp_path: Path) -> Path:
    """A pitch-rate damper at 200 Hz, one sample late."""
    content = {
        "schema_version": 1, "A": [], "B": [], "C": [], "D": [[0.1]], "dt_s": 0.005, "delay_s": 0.005,
        "inputs": ["pitch_rate_rad_s"], "outputs": ["elevon_command_rad"], "limits": {"elevon_command_rad": 0.35},
    }  # fmt: skip
    path = tmp_path / "damper.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


def test_json_of_the_contract(cli: Cli, damper: Path) -> None:
    """All keys; intervals of both loops; criterion in words; null where there is nothing."""
    answer = cli("envelope", "thesis-simulation", "--controller", damper, "--altitudes", "0:3048:3048", "--json")
    assert answer.code == 0
    content = answer.json
    assert content["schema_version"] == 1
    assert content["model"] == "thesis-simulation"
    assert [p["altitude_m"] for p in content["altitudes"]] == [0.0, 3048.0]
    for p in content["altitudes"]:
        assert set(p) >= KEYS
        assert p["open_loop_intervals"][0]["kind"] == "flutter"
        assert p["closed_loop_intervals"][0]["kind"] == "divergence"
        assert "45 deg" in p["margin_criterion"]
        assert len(p["disk_margin"]["speed_m_s"]) == len(p["disk_margin"]["alpha"]) > 10
    assert content["altitudes"][1]["open_loop_intervals"][0]["from_m_s"] == pytest.approx(45.39, abs=0.05)
    assert content["altitudes"][1]["valid_to_m_s"] == pytest.approx(98.5, abs=0.05)
    assert "2 of 2 altitudes" in answer.err
    alone = cli("envelope", "thesis-simulation", "--altitudes", "3048", "--json").json["altitudes"][0]
    for key in ("closed_loop_intervals", "margin_speed_m_s", "margin_criterion", "disk_margin"):
        assert alone[key] is None


def test_text_files_and_figure(cli: Cli, damper: Path, tmp_path: Path) -> None:
    """A table for people; the same JSON in the file; a figure; gusts where asked for; no journal left."""
    out, plot = tmp_path / "e.json", tmp_path / "e.png"
    answer = cli(
        "envelope", "thesis-simulation", "--controller", damper, "--altitudes", "0,2000", "--gusts", "40:60:20",
        "--largest-gust", "2", "--margin", "0.05", "--out", out, "--plot", plot,
    )  # fmt: skip
    assert answer.code == 0
    for word in ("with control", "margin to", "largest gust suppressed at 0 m", ">= 2", "loop closed by damper.json"):
        assert word in answer.out
    content = json.loads(out.read_text(encoding="utf-8"))
    gusts = content["altitudes"][0]["largest_gust"]
    assert [g["speed_m_s"] for g in gusts] == [40.0, 60.0]
    assert gusts[0]["at_least"] is True
    assert plot.read_bytes().startswith(b"\x89PNG")
    assert not list(tmp_path.glob("*.part*"))


def test_a_wing_with_sampled_air_forces(cli: Cli) -> None:
    """A beam wing by p-k, without a controller: stability from the start of the range is said as such."""
    answer = cli("envelope", "goland", "--altitudes", "0", "--speeds", "140:200:20")
    assert answer.code == 0
    assert "below 140" in answer.out


def test_interruption_says_what_is_kept_and_resumes(
    cli: Cli, damper: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C: code 1, no traceback, the journal stays; the same command goes on."""
    from aeroservo.cli import envelope as command

    tell, seen = command.tell_progress, []

    def stop(now: int, count: int, what: str) -> None:
        seen.append(now)
        tell(now, count, what)
        if len(seen) == 1:
            raise KeyboardInterrupt

    monkeypatch.setattr(command, "tell_progress", stop)
    out = tmp_path / "e.json"
    words = ("envelope", "thesis-simulation", "--controller", damper, "--altitudes", "0,1000", "--out", out, "--json")
    first = cli(*words)
    assert (first.code, first.out) == (1, "")
    assert "interrupted after 1 of 2 altitudes" in first.err
    assert "e.json.part" in first.err
    second = cli(*words)
    assert (second.code, seen) == (0, [1, 2])
    assert len(second.json["altitudes"]) == 2
    seen.clear()
    without = cli(*words[:6])
    assert without.code == 1
    assert "give --out" in without.err


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--altitudes", "5:1:1"], "MIN < MAX"),
        (["--altitudes", "a"], "--altitudes"),
        (["--altitudes", "0,0"], "different"),
        (["--altitudes", "90000"], "80,000"),
        (["--margin", "2"], "between 0 and 2"),
        (["--margin", "nan"], "between 0 and 2"),
        (["--gusts", "0:10:1"], "speed"),
        (["--gusts", "40:60:20", "--largest-gust", "0"], "--largest-gust"),
        (["--controller", "nowhere.json"], "nowhere.json"),
        (["--plot", "x.svg"], ".png or .pdf"),
        (["--out", "x.txt"], ".json"),
    ],
)
def test_bad_input(cli: Cli, options: list[str], word: str) -> None:
    """Exit 2 with the reason, nothing on stdout."""
    answer = cli("envelope", "thesis-simulation", "--json", *options)
    assert (answer.code, answer.out) == (2, "")
    assert word in answer.err


def test_kinds_without_an_envelope(cli: Cli, damper: Path) -> None:
    """A linear model at one condition has no envelope and no flutter speed; a beam's controller needs its channel."""
    for words in (("envelope", "thesis-appendix"), ("flutter", "thesis-appendix", "--controller", damper)):
        answer = cli(*words)
        assert (answer.code, answer.out) == (2, "")
        assert "state_space" in answer.err
    assert cli("envelope", "goland", "--controller", damper, "--altitudes", "0").code == 2


def test_flutter_with_a_controller(cli: Cli, tmp_path: Path) -> None:
    """The regulator of 55 m/s: lost at 58.618 m/s through a real root; JSON as without, and the file's name."""
    content = {
        "A": [], "B": [], "C": [], "D": [[6.783, 1.69, 0.573, 0.916]], "dt_s": None,
        "inputs": ["plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s"], "outputs": ["elevon_command_rad"],
    }  # fmt: skip
    path, plot = tmp_path / "k.json", tmp_path / "k.png"
    path.write_text(json.dumps(content), encoding="utf-8")
    words = ("flutter", "thesis-simulation", "--altitude", "3048", "--controller", path)
    answer = cli(*words, "--json", "--plot", plot)
    assert answer.code == 0
    assert answer.json["controller"] == "k.json"
    assert answer.json["method"] == "p"
    first = answer.json["unstable_intervals"][0]
    assert first["from_m_s"] == pytest.approx(58.618, abs=0.01)
    assert first["kind"] == "divergence"
    assert answer.json["first_real_instability_m_s"] == first["from_m_s"]
    assert plot.exists()
    assert "loop closed by k.json" in cli(*words).out
    for option in (("--method", "pk"), ("--sensitivities",), ("--over", "model.m_kg=9:11:1")):
        refused = cli(*words, *option)
        assert (refused.code, refused.out) == (2, "")
        assert "--controller" in refused.err


def test_gusts_without_a_controller_on_sampled_air_forces(cli: Cli) -> None:
    """The air forces are fitted for the simulation: below flutter a beam wing outlives the gust, above it does not."""
    answer = cli(
        "envelope", "goland", "--altitudes", "0", "--speeds", "100:180:40", "--gusts", "100:180:80", "--largest-gust",
        "1", "--json",
    )  # fmt: skip
    gusts = answer.json["altitudes"][0]["largest_gust"]
    assert [(g["at_least"], g["amplitude_m_s"]) for g in gusts] == [(True, 1.0), (False, 0.0)]
