"""`aeroservo demo`: tables that can be read in a pipe, a page that needs no network, and nobody's files overwritten."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aeroservo.report import demo as demo_module
from aeroservo.report.demo import MADE_BY, drawings, prepare_folder, study_json, write_demo
from aeroservo.report.thesis_text import held_conclusions, html_tables, text_tables
from aeroservo.studies.thesis import ThesisStudy, thesis_study

Cli = Callable[..., Any]


@pytest.fixture(scope="module")
def study() -> ThesisStudy:
    """Few speeds, for flutter speeds are refined whatever the step."""
    return thesis_study(speeds=np.arange(10.0, 131.0, 10.0), k=np.geomspace(3e-4, 1.6, 31))


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch, study: ThesisStudy) -> None:
    """The command with that study and one figure."""
    monkeypatch.setattr(demo_module, "thesis_study", lambda *, progress: study)
    monkeypatch.setattr(demo_module, "drawings", lambda study: drawings(study)[:1])


class Page(HTMLParser):
    """What a page asks for and shows."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.asks: list[str] = []
        self.pictures: list[dict[str, str | None]] = []
        self.tags: list[str] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect."""
        given = dict(attrs)
        self.tags.append(tag)
        self.asks += [value for name, value in attrs if name in ("src", "href", "srcset", "action") and value]
        if tag == "img":
            self.pictures.append(given)


@pytest.mark.usefixtures("quick")
def test_demo(cli: Cli, tmp_path: Path, study: ThesisStudy) -> None:
    """Both tables, each number with difference and note; the last line is what to open."""
    folder = tmp_path / "new" / "folder"
    answer = cli("demo", "--out", folder)
    assert answer.code == 0, answer.err
    lines = answer.out.splitlines()
    for words in (
        ("binary", "flutter", "quasi", "49", "49.16", "+0.16"),
        ("binary", "flutter", "quasi", "56", "56.77", "+0.77"),
        ("binary", "flutter", "unsteady", "Theodorsen a_w", "54", "62.12", "+8.12"),
        ("binary", "flutter", "unsteady", "Theodorsen 2 pi", "60", "47.79", "-12.21"),
        ("aircraft", "flutter", "quasi", "49", "48.17", "-0.83"),
        ("aircraft", "flutter", "unsteady", "Theodorsen 2 pi", "40", "41.01", "+1.01"),
        ("binary", "divergence", "both", "94", "94.26", "+0.26"),
        ("aircraft", "reversal", "both", "55", "55.00", "+0.00"),
    ):
        assert any(all(word in line for word in words) for line in lines), words
    assert max(len(line) for line in lines[:-1]) <= 80
    assert "\x1b" not in answer.out
    assert "inferred" in answer.out
    assert lines[-1] == str(folder / "index.html")
    assert {p.name for p in folder.iterdir()} == {
        "index.html",
        "results.json",
        "fig26-response.png",
        "fig26-response.pdf",
    }
    assert (folder / "fig26-response.pdf").read_bytes().startswith(b"%PDF")
    assert json.loads((folder / "results.json").read_text(encoding="utf-8")) == json.loads(
        json.dumps(study_json(study))
    )


@pytest.mark.usefixtures("quick")
def test_demo_again_replaces_itself_and_speaks_json(cli: Cli, tmp_path: Path) -> None:
    assert cli("demo", "--out", tmp_path).code == 0
    page = tmp_path / "index.html"
    page.write_text("old", encoding="utf-8")
    answer = cli("demo", "--out", tmp_path, "--json")
    assert answer.code == 0, answer.err
    assert "replacing the earlier demo" in answer.err
    assert page.read_text(encoding="utf-8") != "old"
    assert answer.json["schema_version"] == 1
    assert answer.json["page"] == str(page)


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize("content", ["precious", '{"made_by": "me"}', "[]", None])
def test_demo_overwrites_nothing_of_others(cli: Cli, tmp_path: Path, content: str | None) -> None:
    """A folder that is not empty and not ours is refused before any work, whatever its results.json says."""
    (tmp_path / "index.html").write_text("mine", encoding="utf-8")
    if content is not None:
        (tmp_path / "results.json").write_text(content, encoding="utf-8")
    before = sorted(os.listdir(tmp_path))
    answer = cli("demo", "--out", tmp_path)
    assert (answer.code, answer.out) == (2, "")
    assert "not empty and was not made by" in answer.err
    assert sorted(os.listdir(tmp_path)) == before
    assert (tmp_path / "index.html").read_text(encoding="utf-8") == "mine"


@pytest.mark.usefixtures("quick")
def test_demo_needs_a_folder(cli: Cli, tmp_path: Path) -> None:
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


def test_a_disk_that_fills_leaves_no_page(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, study: ThesisStudy) -> None:
    """The page comes last: what can be opened is complete."""
    real = demo_module.write_whole

    def full(path: Path, content: bytes) -> None:
        if path.suffix == ".pdf":
            raise OSError(28, "No space left on device")
        real(path, content)

    monkeypatch.setattr(demo_module, "write_whole", full)
    with pytest.raises(ValueError, match="cannot be written: No space left"):
        write_demo(study, tmp_path)
    assert "index.html" not in os.listdir(tmp_path)
    assert prepare_folder(tmp_path)  # and the next demo may go on here


def test_page_is_self_contained(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, study: ThesisStudy) -> None:
    """Every figure, every table; nothing is asked of any network; links lead to files that exist."""
    real = demo_module.as_bytes  # drawing takes time: PDFs are looked at in test_demo
    monkeypatch.setattr(demo_module, "as_bytes", lambda figure, e: real(figure, e) if e == ".png" else b"no PDF")
    page = Page(write_demo(study, tmp_path).read_text(encoding="utf-8"))
    names = [drawing.name for drawing in drawings(study)]
    assert len(page.pictures) == len(names) == 10
    assert all(str(p["src"]).startswith("data:image/png;base64,") and p["alt"] for p in page.pictures)
    assert page.tags.count("table") == 3
    assert not {"script", "link", "iframe", "object"} & set(page.tags)
    local = [x for x in page.asks if not x.startswith("data:")]
    assert all((tmp_path / x).is_file() for x in local)
    for name in names:
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert set(os.listdir(tmp_path)) == {f"{n}.{e}" for n in names for e in ("png", "pdf")} | {
        "index.html",
        "results.json",
    }


def test_results(study: ThesisStudy) -> None:
    """JSON without NaN, with every run and curve; absent speeds are null."""
    content = json.loads(json.dumps(study_json(study), allow_nan=False))
    assert content["made_by"] == MADE_BY
    assert len(content["tables"]) == len(study.rows) == 28
    assert len(content["runs"]) == 12
    assert len(content["held_derivatives"]) == 8
    quasi = next(r for r in content["runs"] if r["aero"] == "quasi_steady_damped")
    assert quasi["flutter_speed_m_s"] == study.run("binary", 0.0, "quasi_steady_damped").flutter.flutter_speed
    held = [h for h in content["held_derivatives"] if h["model"] == "binary"]
    assert all(h["flutter_speed_m_s"][-1] is None for h in held if h["lift_slope"] == "a_w")  # no flutter at k = 1.6


def test_tables_in_words(study: ThesisStudy) -> None:
    """Nothing is lost on the way from rows to text; both columns are merged only where they agree."""
    two, three, held = text_tables(study)
    for number, table in ((2, two), (3, three)):
        rows = [row for row in study.rows if row.table == number]
        assert {(r.model, r.quantity, str(r.printed)) for r in rows} == {(r[0], r[1], r[4]) for r in table.rows}
        assert all(1 <= int(row[-1]) <= len(table.notes) for row in table.rows)
    assert len(held.rows) == len(study.held)
    assert len(held_conclusions(study.held)) == 4
    assert "<script" not in html_tables(study)


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
