"""The command line as such: help, version, presets, new files, exit codes, what goes to which stream."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import aeroservo
from aeroservo.aircraft import files

Cli = Callable[..., Any]

#: Every command of the contract.
COMMANDS = (
    *("list", "new", "check", "polar", "aero", "modes", "static", "flutter", "linearize", "design", "simulate", "gust"),
    *("envelope", "report", "studio", "study", "validate", "demo"),
)
#: Keys that every JSON has (contract.md, "Other JSON").
COMMON = {"schema_version", "model", "altitude_m", "density_kg_m3", "warnings"}


def test_help_lists_every_command(cli: Cli) -> None:
    """`aeroservo --help` names all commands of the contract, each command its options."""
    answer = cli("--help")
    assert answer.code == 0
    for command in COMMANDS:
        assert f"\n  {command} " in answer.out
        assert cli(command, "--help").code == 0
    flutter = cli("flutter", "--help").out
    for option in ("method", "aero", "altitude", "density", "speeds", "fit-bound", "controller", "over", "out", "json"):
        assert f"--{option}" in flutter
    assert "--sensitivities" in flutter
    assert "--plot" in flutter


def test_version(cli: Cli) -> None:
    """`--version` prints the package's."""
    assert cli("--version").out.strip() == aeroservo.__version__


def test_no_command_and_unknown_commands(cli: Cli) -> None:
    """Misuse is code 2 with a hint on stderr."""
    assert cli().code == 2
    answer = cli("fluter")
    assert answer.code == 2
    assert answer.out == ""
    assert "flutter" in answer.err


def test_list(cli: Cli) -> None:
    """`list` gives name, kind and description of each preset."""
    answer = cli("list", "--json")
    assert set(answer.json) == COMMON | {"presets"}
    assert {"name", "kind", "description"} == set(answer.json["presets"][0])
    names = {preset["name"] for preset in answer.json["presets"]}
    assert {"thesis-binary", "thesis-aircraft", "goland", "wright-cooper-binary", "nasa-typical-section"} <= names
    assert all(name in cli("list").out for name in names)


def test_new_then_check(cli: Cli, tmp_path: Path) -> None:
    """A new file is the preset, is valid, and is not overwritten without --force."""
    path = tmp_path / "mine.toml"
    answer = cli("new", "thesis-binary", path)
    assert (answer.code, answer.out) == (0, "")
    assert str(path) in answer.err
    assert path.read_bytes() == (Path(files.__file__).parent / "presets" / "thesis-binary.toml").read_bytes()
    path.write_text(path.read_text(encoding="utf-8").replace("413.2", "500.0"), encoding="utf-8")
    mine = path.read_bytes()
    refused = cli("new", "goland", path)
    assert (refused.code, refused.out) == (2, "")
    assert "exists already" in refused.err
    assert path.read_bytes() == mine
    assert cli("new", "goland", path, "--force").code == 0
    assert path.read_bytes() != mine
    assert os.listdir(tmp_path) == ["mine.toml"]


def test_check(cli: Cli, tmp_path: Path) -> None:
    """`check` gives the kind, what follows from the file, and what is odd about it."""
    answer = cli("check", "nasa-typical-section", "--json")
    assert set(answer.json) == COMMON | {"kind", "derived", "problems"}
    assert answer.json["problems"] == []
    assert answer.json["derived"]["theodorsen_a"] == pytest.approx(-0.4)
    path = tmp_path / "odd.toml"
    cli("new", "thesis-binary", path)
    path.write_text(path.read_text(encoding="utf-8").replace("eccentricity = 0.183", "eccentricity = 0.2"))
    assert "eccentricity" in cli("check", path, "--json").json["problems"][0]
    assert "eccentricity" in cli("check", path).out


def test_check_of_an_invalid_file_prints_nothing_on_stdout(cli: Cli, tmp_path: Path) -> None:
    """An invalid file exits 2, with or without --json."""
    path = tmp_path / "bad.toml"
    path.write_text('kind = "beam_wing"\n', encoding="utf-8")
    for options in ([], ["--json"]):
        answer = cli("check", path, *options)
        assert (answer.code, answer.out) == (2, "")
        assert "bad.toml: wing is missing" in answer.err


def test_a_fault_of_ours_is_code_1(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is not the user's doing is code 1, in one line."""

    def broken() -> None:
        raise RuntimeError("boom")

    monkeypatch.setattr(files, "presets", broken)
    answer = cli("list")
    assert (answer.code, answer.out) == (1, "")
    assert answer.err.strip() == "aeroservo: internal error, please report it: RuntimeError: boom"


def test_a_failed_decomposition_is_not_called_bad_input(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    """numpy's LinAlgError is a ValueError, but not the user's."""
    import numpy as np

    def broken() -> None:
        raise np.linalg.LinAlgError("Eigenvalues did not converge")

    monkeypatch.setattr(files, "presets", broken)
    answer = cli("list")
    assert answer.code == 1
    assert "Eigenvalues did not converge" in answer.err


def test_as_a_process() -> None:
    """The installed program: exit code, streams, an odd terminal encoding, a pipe that closes."""
    program = [sys.executable, "-c", "from aeroservo.cli import main; main()"]
    environment = os.environ | {"PYTHONIOENCODING": "ascii", "LC_ALL": "C"}
    done = subprocess.run([*program, "check", "Flügel\u202e.toml"], capture_output=True, env=environment, timeout=60)
    assert (done.returncode, done.stdout) == (2, b"")
    assert b"Traceback" not in done.stderr
    assert b"no such file" in done.stderr
    done = subprocess.run([*program, "list", "--json"], capture_output=True, env=environment, timeout=60)
    assert done.returncode == 0
    assert done.stderr == b""
    with subprocess.Popen([*program, "list"], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert b"Traceback" not in process.stderr.read()
