"""`aeroservo demo`: nobody's files are overwritten, and Ctrl-C leaves neither traceback nor half a page."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Cli = Callable[..., Any]


@pytest.mark.parametrize("command", [("demo", "--out"), ("study", "thesis", "-o")])
@pytest.mark.parametrize("content", ["precious", '{"made_by": "me"}', "[]", None])
def test_overwrites_nothing_of_others(cli: Cli, tmp_path: Path, command: tuple[str, ...], content: str | None) -> None:
    """A folder that is not empty and not ours is refused before any work, whatever its results.json says."""
    (tmp_path / "index.html").write_text("mine", encoding="utf-8")
    if content is not None:
        (tmp_path / "results.json").write_text(content, encoding="utf-8")
    before = sorted(os.listdir(tmp_path))
    answer = cli(*command, tmp_path)
    assert (answer.code, answer.out) == (2, "")
    assert "not empty and was not made by" in answer.err
    assert sorted(os.listdir(tmp_path)) == before
    assert (tmp_path / "index.html").read_text(encoding="utf-8") == "mine"


def test_needs_a_folder(cli: Cli, tmp_path: Path) -> None:
    """A file in the way, and a place where nothing can be made, are refused before any work."""
    path = tmp_path / "file"
    path.write_text("precious", encoding="utf-8")
    for out in (path, path / "below"):
        answer = cli("demo", "--out", out)
        assert (answer.code, answer.out) == (2, "")
        assert "--out" in answer.err
        assert "a file is in the way" in answer.err
    if Path("/proc/self").exists():
        answer = cli("demo", "--out", "/proc/aeroservo-demo")
        assert (answer.code, answer.out) == (2, "")
        assert "cannot be used as a folder" in answer.err
    assert path.read_text(encoding="utf-8") == "precious"
    assert os.listdir(tmp_path) == ["file"]


@pytest.mark.skipif(os.name == "nt" or not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root writes anywhere")
def test_read_only_folder(cli: Cli, tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        answer = cli("demo", "--out", tmp_path)
    finally:
        tmp_path.chmod(0o700)
    assert (answer.code, answer.out) == (2, "")
    assert "Permission denied" in answer.err


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_interrupt_without_traceback(tmp_path: Path) -> None:
    """Ctrl-C while it computes: no traceback, not exit code 0, no page."""
    command = [sys.executable, "-m", "aeroservo.cli", "demo", "--out", str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        first = process.stderr.readline()
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert "binary at 0 m" in first
    assert process.returncode not in (0, 2)
    assert "Traceback" not in out + err
    assert os.listdir(tmp_path) == []
