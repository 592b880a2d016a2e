"""Bad input: code 2, one readable message each, nothing on stdout, nothing overwritten."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

Cli = Callable[..., Any]

#: Preset, what is replaced in it, words of the message.
BAD_FILES = {
    "unknown key": ("thesis-binary", ("chord_m = 0.53", "chord_m = 0.53\nchrod_m = 0.53"), ["chrod_m", "'chord_m'"]),
    "missing field": ("thesis-binary", ("semi_span_m", "# semi_span_m"), ["wing.semi_span_m is missing"]),
    "negative mass": ("goland", ("mass_kg_per_m = 35.717", "mass_kg_per_m = -35.717"), ["mass_kg_per_m = -35.717"]),
    "mass matrix": ("goland", ("inertia_kg_m = 8.642", "inertia_kg_m = 0.8642"), ["not positive definite"]),
    "section mass matrix": (
        "nasa-typical-section",
        ("static_moment_kg = 0.", "static_moment_kg = 3."),
        ["positive def"],
    ),
    "axis outside": ("thesis-binary", ("flexural_axis = 0.433", "flexural_axis = 1.433"), ["flexural_axis = 1.433"]),
    "nan": ("thesis-binary", ("lift_slope_per_rad = 3.0", "lift_slope_per_rad = nan"), ["lift_slope_per_rad = nan"]),
    "infinity": ("thesis-binary", ("lift_slope_per_rad = 3.0", "lift_slope_per_rad = inf"), ["finite"]),
    "speeds reversed": ("thesis-binary", ("[1.0, 150.0, 0.5]", "[150.0, 1.0, 0.5]"), ["speeds_m_s", "MIN <= MAX"]),
    "speeds zero": ("thesis-binary", ("[1.0, 150.0, 0.5]", "[0.0, 150.0, 0.5]"), ["speeds_m_s", "MIN = 0"]),
    "newer version": ("thesis-binary", ("schema_version = 1", "schema_version = 7"), ["schema_version = 7", "newer"]),
    "one station": ("goland", (None, None), ["wing.station needs at least 2 entries, got 1"]),
    "stations out of order": ("goland", ("y_m = 6.096", "y_m = 0.0"), ["ascending"]),
    "zero EI": ("goland", ("EI_N_m2 = 9.773e6", "EI_N_m2 = 0.0"), ["EI_N_m2 = 0.0", "greater than 0"]),
    "zero GJ": ("goland", ("GJ_N_m2 = 0.9876e6", "GJ_N_m2 = 0.0"), ["GJ_N_m2 = 0.0", "greater than 0"]),
    "90 degrees": ("goland", ("sweep_deg = 0.0", "sweep_deg = 90.0"), ["sweep_deg = 90.0", "at most 80"]),
    "two dampings": (
        "thesis-binary",
        ("[wing.elevon]", "[damping]\nmodal = {ratios = [0.1]}\nhysteretic = {g = 0.1}\n[wing.elevon]"),
        ["exactly one"],
    ),
    "unknown kind": ("goland", ('kind = "beam_wing"', 'kind = "beam_wings"'), ["did you mean 'beam_wing'"]),
}


def bad_file(cli: Cli, folder: Path, preset: str, old: str | None, new: str | None) -> Path:
    """A copy of a preset with one thing wrong."""
    path = folder / "wing.toml"
    assert cli("new", preset, path).code == 0
    text = path.read_text(encoding="utf-8")
    if old is None or new is None:
        text = "[[wing.station]]".join(text.split("[[wing.station]]")[:2])
    else:
        assert old in text
        text = text.replace(old, new, 1)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("what", BAD_FILES)
@pytest.mark.parametrize("command", [("check",), ("modes",), ("static",), ("flutter",), ("linearize", "--speed", "30")])
def test_bad_files(cli: Cli, tmp_path: Path, what: str, command: tuple[str, ...]) -> None:
    """Every bad file of issues 2 and 3, with every command that reads one."""
    preset, (old, new), words = BAD_FILES[what]
    path = bad_file(cli, tmp_path, preset, old, new)
    content = path.read_bytes()
    target = tmp_path / "old.png"
    target.write_bytes(b"precious")
    options = () if command[0] in ("check", "linearize") else ("--plot", target)
    for extra in ((), ("--json",)):
        answer = cli(command[0], path, *command[1:], *options, *extra)
        assert (answer.code, answer.out) == (2, "")
        for word in ["wing.toml", *words]:
            assert word in answer.err
        assert len(answer.err.splitlines()) == 1
    assert path.read_bytes() == content
    assert target.read_bytes() == b"precious"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["old.png", "wing.toml"]


@pytest.mark.parametrize(
    ("content", "word"), [(b"", "empty"), (b"\x7fELF\0\0\1", "binary"), (b"\xff\xfe", "UTF-8"), (b"a = [", "TOML")]
)
def test_no_model_files(cli: Cli, tmp_path: Path, content: bytes, word: str) -> None:
    """Empty, binary, other encodings, no TOML."""
    path = tmp_path / "wing.toml"
    path.write_bytes(content)
    answer = cli("flutter", path, "--json")
    assert (answer.code, answer.out) == (2, "")
    assert word in answer.err
    assert "wing.toml" in answer.err


@pytest.mark.parametrize("path", ["/tmp", "no-such-file.toml", "", "\0", "/dev/null", "/dev/zero", "a" * 5000])
def test_no_files(cli: Cli, path: str) -> None:
    """A directory, nothing, devices."""
    answer = cli("flutter", path)
    assert (answer.code, answer.out) == (2, "")
    assert len(answer.err) < 1000


def test_modal_data_of_wrong_shape(cli: Cli, tmp_path: Path) -> None:
    """A .npz whose arrays do not fit together."""
    names = np.array(["a", "b"])
    arrays = {"M": np.eye(2), "K": np.eye(2), "k": np.linspace(0, 1, 3), "mach": np.zeros(1), "b_m": 1.0}
    np.savez(tmp_path / "q.npz", **arrays, Q=np.zeros((1, 3, 2, 3)), mode_names=names, input_names=names)
    (tmp_path / "wing.toml").write_text('kind = "modal"\n[modal]\ndata = "q.npz"\n', encoding="utf-8")
    answer = cli("flutter", tmp_path / "wing.toml")
    assert (answer.code, answer.out) == (2, "")
    assert "Q must have shape (1, 3, 2, 2), got (1, 3, 2, 3)" in answer.err
    assert "q.npz" in answer.err


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--speeds", "100:50:1"], "MIN < MAX"),
        (["--speeds", "0:50:1"], "0 < MIN"),
        (["--speeds=-5:50:1"], "0 < MIN"),
        (["--speeds", "1:50:0"], "positive STEP"),
        (["--speeds", "1:50:-1"], "positive STEP"),
        (["--speeds", "1:50"], "MIN:MAX:STEP"),
        (["--speeds", "a:b:c"], "MIN:MAX:STEP"),
        (["--speeds", "1:nan:1"], "MIN < MAX"),
        (["--speeds", "1:inf:1"], "MIN < MAX"),
        (["--speeds", "1:50:1e-9"], "larger step"),
        (["--speeds", "1:1e300:1e299"], "10000"),
        (["--altitude", "80001"], "80,000"),
        (["--altitude=-6000"], "-5,000"),
        (["--altitude", "nan"], "80,000"),
        (["--altitude", "high"], "--altitude"),
        (["--density=-1"], "--density"),
        (["--density", "nan"], "--density"),
        (["--density", "inf"], "--density"),
        (["--density", "1", "--altitude", "0"], "not both"),
        (["--method", "q"], "'pk'"),
        (["--aero", "panel"], "'theodorsen'"),
        (["--aero", "dlm"], "does not exist yet"),
        (["--plot", "x.svg"], ".png or .pdf"),
        (["--plot", "/no/such/folder/x.png"], "folder does not exist"),
        (["--out", "x.txt"], ".json"),
        (["--fit-bound", "0"], "--fit-bound"),
        (["--fit-bound", "nan"], "--fit-bound"),
        (["--controller", "c.json"], "c.json"),
        (["--controller", "c.json", "--method", "pk"], "--method"),
        (["--bogus"], "--bogus"),
    ],
)
def test_bad_options(cli: Cli, options: list[str], word: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every option with a value that it cannot have."""
    monkeypatch.chdir(tmp_path)
    answer = cli("flutter", "thesis-binary", "--json", *options)
    assert (answer.code, answer.out) == (2, "")
    assert word in answer.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["check", "modes", "flutter"])
@pytest.mark.parametrize(
    ("preset", "damping", "word"),
    [
        ("thesis-binary", "modal = {ratios = [0.1, 0.1, 0.1]}", "ratios"),
    ],
)
def test_files_that_the_mechanics_refuse(
    cli: Cli, tmp_path: Path, command: str, preset: str, damping: str, word: str
) -> None:
    """Well formed, but there is no such model: `check` says so too."""
    path = tmp_path / "wing.toml"
    cli("new", preset, path)
    path.write_text(path.read_text(encoding="utf-8") + f"\n[damping]\n{damping}\n", encoding="utf-8")
    answer = cli(command, path, "--json")
    assert (answer.code, answer.out) == (2, "")
    assert word in answer.err
    assert preset in answer.err


@pytest.mark.parametrize("speed", ["0", "-3", "nan", "inf", "1e9", "fast"])
def test_linearize_needs_a_speed(cli: Cli, speed: str) -> None:
    """A speed that is none."""
    answer = cli("linearize", "thesis-binary", f"--speed={speed}")
    assert (answer.code, answer.out) == (2, "")
    assert "speed" in answer.err


@pytest.mark.parametrize("bound", ["0", "1", "nan", "-1"])
def test_linearize_needs_a_bound(cli: Cli, bound: str) -> None:
    """A bound of the fit that would let anything pass, or nothing."""
    answer = cli("linearize", "nasa-typical-section", "--speed", "30", f"--fit-bound={bound}")
    assert (answer.code, answer.out) == (2, "")
    assert "--fit-bound" in answer.err


def test_linearize_without_a_speed(cli: Cli) -> None:
    """--speed is required."""
    assert "--speed" in cli("linearize", "thesis-binary").err


@pytest.mark.parametrize(
    "over", ["wing.stiffness=1:2:1", "wing.chord_m", "wing.chord_m=2:1:1", "=1:2:1", "wing.chord_m=-1:1:1"]
)
def test_over_that_cannot_be(cli: Cli, over: str) -> None:
    """--over with an unknown field, without a range, into what is not allowed."""
    answer = cli("flutter", "thesis-binary", "--over", over)
    assert (answer.code, answer.out) == (2, "")
    assert "--over" in answer.err or "wing." in answer.err
    if "stiffness" in over:
        assert "wing.pitch_stiffness_N_m" in answer.err
