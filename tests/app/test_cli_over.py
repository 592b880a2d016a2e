"""`flutter --over`: the numbers of single runs, streamed to disk, resumed after an interruption with nothing lost."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from aeroservo.aeroelastic import flutter as flutter_module

Cli = Callable[..., Any]
COMMON = {"schema_version", "model", "altitude_m", "density_kg_m3", "warnings"}
FAST = ("--speeds", "10:140:10")


def test_one_field(cli: Cli, tmp_path: Path) -> None:
    """Each point is what a single run of the changed file gives; result and figure are written, the journal is gone."""
    out, plot = tmp_path / "o.json", tmp_path / "o.pdf"
    over = "wing.pitch_stiffness_N_m=200:800:300"
    answer = cli("flutter", "thesis-binary", *FAST, "--over", over, "--out", out, "--plot", plot, "--json")
    assert answer.code == 0, answer.err
    found = answer.json
    assert set(found) == COMMON | {"method", "aero", "speeds_m_s", "over", "points"}
    assert found["over"] == [{"field": "wing.pitch_stiffness_N_m", "values": [200.0, 500.0, 800.0]}]
    assert json.loads(out.read_text(encoding="utf-8")) == found
    assert sorted(p.name for p in tmp_path.iterdir()) == ["o.json", "o.pdf"]
    for point in found["points"]:
        path = tmp_path / "wing.toml"
        cli("new", "thesis-binary", path, "--force")
        path.write_text(path.read_text(encoding="utf-8").replace("413.2 ", f"{point['values'][0]} "), encoding="utf-8")
        single = cli("flutter", path, *FAST, "--json").json
        for key in ("found", "flutter_speed_m_s", "flutter_frequency_rad_s", "flutter_mode", "divergence_speed_m_s"):
            assert point[key] == single[key]
    speeds = [point["flutter_speed_m_s"] for point in found["points"]]
    assert speeds == sorted(speeds)


def test_two_fields(cli: Cli, tmp_path: Path) -> None:
    """Every combination, the last field fastest; a finding at a corner is told with its values."""
    over = ("--over", "wing.mass_kg_per_m2=8:10:1", "--over", "wing.flexural_axis=0.40:0.45:0.05")
    answer = cli("flutter", "thesis-binary", *FAST, *over, "--plot", tmp_path / "o.png", "--json")
    assert answer.code == 0, answer.err
    values = [point["values"] for point in answer.json["points"]]
    assert values == [[m, x] for m in (8.0, 9.0, 10.0) for x in (0.40, 0.45)]
    assert any("flexural_axis = 0.45" in w and "eccentricity" in w for w in answer.json["warnings"])
    assert (tmp_path / "o.png").read_bytes().startswith(b"\x89PNG")


def test_an_interrupted_sweep_goes_on(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Stopped after three of seven points, its last line cut: only the rest is computed, to the same end."""
    arguments = ("flutter", "thesis-binary", *FAST, "--over", "wing.pitch_stiffness_N_m=200:800:100", "--json")
    whole = cli(*arguments).json
    real, calls = flutter_module.flutter, []

    def counted(*given: Any) -> Any:
        if len(calls) == limit:
            raise RuntimeError("the lights went out")
        calls.append(given)
        return real(*given)

    monkeypatch.setattr(flutter_module, "flutter", counted)
    out, journal = tmp_path / "o.json", tmp_path / "o.json.part"
    limit = 3
    assert cli(*arguments, "--out", out).code == 1
    assert not out.exists()
    assert len(journal.read_text(encoding="utf-8").splitlines()) == 4
    with open(journal, "a", encoding="utf-8") as file:
        file.write('{"values": [500.0], "fou')
    calls.clear()
    limit = 99
    again = cli(*arguments, "--out", out)
    assert again.code == 0, again.err
    assert len(calls) == 4
    assert again.json == whole
    assert not journal.exists()


def test_the_journal_of_another_sweep_is_left_alone(cli: Cli, tmp_path: Path) -> None:
    """Another range, another model, or no journal at all: refused, and the file is as it was."""
    out, journal = tmp_path / "o.json", tmp_path / "o.json.part"
    for content in ("", "precious\n", '{"model": {}}\n', "\x00\xff"):
        journal.write_text(content, encoding="utf-8")
        answer = cli("flutter", "thesis-binary", *FAST, "--over", "wing.chord_m=0.5:0.6:0.1", "--out", out)
        assert (answer.code, answer.out) == (2, "")
        assert "journal of another sweep" in answer.err
        assert journal.read_text(encoding="utf-8") == content
    assert not out.exists()


@pytest.mark.parametrize(
    ("over", "words"),
    [
        (["wing.chord_m=0.5:0.6:0.1"] * 2, "two different ones"),
        (["wing.chord_m=0.5:0.6:0.1", "wing.sweep_deg=0:1:1", "wing.flexural_axis=0.4:0.5:0.1"], "one field or two"),
        (["wing.sweep_deg=0:60:0.01", "wing.chord_m=0.5:0.6:0.001"], "100,000 points"),
        (["wing.sweep_deg=0:90:10"], "wing.sweep_deg = 90"),
        (["wing.GJ_N_m2=100:200:100"], "exactly one of"),
        (["wing.chord_m=0:1:nan"], "MIN < MAX"),
    ],
)
def test_sweeps_that_cannot_be(cli: Cli, over: list[str], words: str) -> None:
    """Refused before the first point."""
    answer = cli("flutter", "thesis-binary", *FAST, *(part for text in over for part in ("--over", text)))
    assert (answer.code, answer.out) == (2, "")
    assert words in answer.err
    assert "points" not in answer.err or "100,000" in answer.err
