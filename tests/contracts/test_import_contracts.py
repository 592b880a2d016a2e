"""The import contracts of pyproject.toml bite: each is broken on purpose in a copy of the tree, and must say so."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
UPPER = ["cli", "studio", "report", "studies", "simulate", "control", "aeroelastic"]
FLOORS = [*UPPER, "aero", "structure", "flight", "gust", "aircraft"]


def lint(folder: Path) -> subprocess.CompletedProcess[str]:
    """Run import-linter with the project's own contracts on a package named aeroservo in `folder`."""
    command = [sys.executable, "-c", "from importlinter.cli import lint_imports_command as main; main()"]
    arguments = ["--config", str(ROOT / "pyproject.toml"), "--no-cache"]
    environment = {"PYTHONPATH": str(folder), "PYTHONIOENCODING": "utf-8", "COLUMNS": "200"}
    return subprocess.run([*command, *arguments], cwd=folder, env=environment, capture_output=True, text=True)


def plant(folder: Path, path: str, line: str, *, floors: list[str] = FLOORS) -> None:
    """A bare package with one module on every floor, and one import statement in one of them."""
    package = folder / "aeroservo"
    for name in floors:
        (package / name).mkdir(parents=True, exist_ok=True)
        (package / name / "__init__.py").write_text("")
        (package / name / "part.py").write_text("")
    for name in ("__init__", "datatypes", "atmosphere"):
        (package / f"{name}.py").write_text("")
    (package / path).write_text(line + "\n")


@pytest.mark.parametrize(
    ("path", "line"),
    [
        ("cli/part.py", "from aeroservo.report import part"),
        ("aeroelastic/part.py", "from aeroservo.aero import part"),
        ("atmosphere.py", "import numpy"),
        ("report/part.py", "import matplotlib.pyplot"),
    ],
)
def test_allowed_imports_pass(tmp_path: Path, path: str, line: str) -> None:
    """The bare tree with an import in the right direction passes: failures below are due to what was planted."""
    plant(tmp_path, path, line)
    result = lint(tmp_path)
    assert result.returncode == 0, result.stdout + result.stderr


def test_floors_not_built_yet_are_no_failure(tmp_path: Path) -> None:
    """A tree with only some floors passes."""
    plant(tmp_path, "aero/part.py", "import aeroservo.datatypes", floors=["aero"])
    result = lint(tmp_path)
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize(
    ("path", "line"),
    [
        ("aero/part.py", "from aeroservo.structure import part"),
        ("flight/part.py", "from aeroservo.gust import part"),
        ("aircraft/part.py", "def late():\n    from aeroservo.aero import part"),
        ("aero/part.py", "from aeroservo.aeroelastic import part"),
        ("control/part.py", "from aeroservo.simulate import part"),
        ("report/part.py", "from aeroservo.cli import part"),
        ("datatypes.py", "from aeroservo.aero import part"),
        ("atmosphere.py", "from aeroservo import datatypes"),
        ("aeroelastic/part.py", "def late():\n    import matplotlib.pyplot"),
        ("cli/part.py", "import matplotlib"),
        ("newcomer.py", ""),
    ],
)
def test_forbidden_imports_fail(tmp_path: Path, path: str, line: str) -> None:
    """Sideways, upward and plot imports break a contract, also inside functions; so does an unknown floor."""
    plant(tmp_path, path, line)
    result = lint(tmp_path)
    assert result.returncode == 1, result.stdout + result.stderr
    assert "BROKEN" in result.stdout or "newcomer" in result.stdout + result.stderr
