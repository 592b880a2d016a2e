"""`demo`: the thesis' tables beside ours with reasons, and figures that exist."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aeroservo.report import demo
from aeroservo.studies import thesis

Cli = Callable[..., Any]


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few speeds and few k: flutter speeds are refined whatever the step."""
    real = thesis.thesis_study

    def few(*, progress: Callable[[str], None] | None = None) -> thesis.ThesisStudy:
        return real(speeds=np.arange(10.0, 130.0, 10.0), k=np.geomspace(0.3, 0.6, 5), progress=progress)

    monkeypatch.setattr(demo, "thesis_study", few)


@pytest.mark.usefixtures("coarse")
def test_demo(cli: Cli, tmp_path: Path) -> None:
    """Both tables on stdout, each printed speed with ours; figures and a page where it says they are."""
    folder = tmp_path / "new" / "folder"
    answer = cli("demo", "--out", folder)
    assert answer.code == 0, answer.err
    for ours in ("49.16", "56.77", "62.12", "70.50", "48.17", "55.35", "41.01", "46.83", "94.26", "64.00"):
        assert ours in answer.out
    assert "inferred" in answer.out
    assert str(folder) in answer.out.replace("\n", "")
    written = [path for path in folder.rglob("*") if path.is_file()]
    assert not [path for path in written if path.name.endswith(".tmp")]
    pictures = [path for path in written if path.suffix == ".png"]
    assert len(pictures) >= 4
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in pictures)


def test_demo_needs_a_folder(cli: Cli, tmp_path: Path) -> None:
    """A file in the way is refused before any work."""
    path = tmp_path / "file"
    path.write_text("precious", encoding="utf-8")
    for out in (path, path / "below"):
        answer = cli("demo", "--out", out)
        assert (answer.code, answer.out) == (2, "")
        assert "--out" in answer.err
    assert path.read_text(encoding="utf-8") == "precious"
    assert os.listdir(tmp_path) == ["file"]
