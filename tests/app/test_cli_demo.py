"""`demo`: the thesis' tables beside ours with reasons, and figures that exist."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from aeroservo.report import figures
from aeroservo.studies import thesis

Cli = Callable[..., Any]


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few speeds, for flutter speeds are refined whatever the step; and all figures but two left blank."""
    real = thesis.thesis_study

    def few(*, progress: Callable[[str], None]) -> thesis.ThesisStudy:
        return real(speeds=np.arange(10.0, 130.0, 10.0), k=np.geomspace(0.3, 0.6, 5), progress=progress)

    monkeypatch.setattr(thesis, "thesis_study", few)
    draw, drawn = figures.flutter_figure, []

    def sketch(result: Any, title: str) -> Figure:
        drawn.append(title)
        return draw(result, title) if len(drawn) <= 2 else Figure(figsize=(1.0, 1.0))

    monkeypatch.setattr(figures, "flutter_figure", sketch)


@pytest.mark.usefixtures("coarse")
def test_demo(cli: Cli, tmp_path: Path) -> None:
    """Both tables, each number with its difference and reason; figures are written where they are announced."""
    folder = tmp_path / "new" / "folder"
    answer = cli("demo", "--out", folder)
    assert answer.code == 0, answer.err
    lines = answer.out.splitlines()
    for words in (
        ("binary, quasi", "flutter", "49", "49.16", "+0.16"),
        ("binary, quasi", "flutter", "56", "56.77", "+0.77"),
        ("binary, unsteady", "flutter", "54", "62.12", "+8.12"),
        ("aircraft, quasi", "flutter", "49", "48.17", "-0.83"),
        ("aircraft, unsteady", "flutter", "40", "41.01", "+1.01"),
        ("binary, quasi", "divergence", "94", "94.26", "+0.26"),
        ("binary, quasi", "reversal", "55", "55.00", "+0.00"),
    ):
        assert any(all(word in line for word in words) for line in lines), words
    assert "inferred" in answer.out
    written = sorted(folder.iterdir())
    assert len(written) >= 14
    assert f"{len(written)} figures" in answer.out
    for path in written:
        assert path.read_bytes().startswith(b"\x89PNG")
        assert str(path) in answer.err
    assert str(folder / "thesis-binary_quasi-steady_0-m.png") in answer.out


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
