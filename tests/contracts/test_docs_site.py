"""The documentation site builds without a warning, and its drawings are those of the script that draws them."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def test_the_site_builds_and_its_reference_holds_the_public_names(tmp_path: Path) -> None:
    pytest.importorskip("material", reason="mkdocs-material (extra docs) is not installed")
    pytest.importorskip("mkdocstrings", reason="mkdocstrings (extra docs) is not installed")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--quiet", "--site-dir", str(tmp_path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
    )
    assert done.returncode == 0, done.stderr[-4000:]
    reference = "".join(page.read_text(encoding="utf-8") for page in (tmp_path / "reference").glob("*.html"))
    stub = (ROOT / "src" / "aeroservo" / "__init__.pyi").read_text(encoding="utf-8")
    for line in stub.splitlines():
        if line.startswith("from ."):
            module, _, name = line.removeprefix("from .").partition(" import ")
            full = f"aeroservo.{module}.{name.split(' as ')[-1]}"
            assert f'id="{full}"' in reference, f"{full} is not in the reference"
    pages = "".join(page.read_text(encoding="utf-8") for page in tmp_path.rglob("*.html"))
    assert "fonts.googleapis" not in pages and "cdn." not in pages, "the site fetches something from elsewhere"


def test_every_sign_has_its_drawing() -> None:
    spec = importlib.util.spec_from_file_location("draw_signs", ROOT / "scripts" / "draw_signs.py")
    assert spec is not None and spec.loader is not None
    draw_signs = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(draw_signs)
    conventions = (ROOT / "docs" / "conventions.md").read_text(encoding="utf-8")
    signs = conventions.split("## Signs")[1].split("## ")[0]
    rows = [line for line in signs.splitlines() if line.startswith("| ") and "drawn" not in line]
    assert len(rows) == len(draw_signs.DRAWINGS)
    for name in draw_signs.DRAWINGS:
        assert sum(f"img/signs/{name}.svg" in row for row in rows) == 1, f"no row shows {name}"
        committed = (draw_signs.FOLDER / f"{name}.svg").read_text(encoding="utf-8")
        assert committed == draw_signs.drawing(name), f"{name}.svg is old: run scripts/draw_signs.py"
