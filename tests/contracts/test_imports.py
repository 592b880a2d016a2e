"""Start-up stays light: importing the package and asking for help load no heavy library."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

HEAVY = ("scipy", "numba", "control", "matplotlib")
REPORT = """
import json, sys
print(json.dumps([m for m in {modules!r} if m in sys.modules]), file=sys.stderr)
"""
HELP = """
import sys
sys.argv = ["aeroservo", "--help"]
from aeroservo.cli import main
try:
    main()
except SystemExit as stop:
    assert not stop.code, stop.code
"""


def loaded(code: str) -> tuple[list[str], str]:
    """Heavy libraries that a fresh interpreter holds after running `code`, and what it printed."""
    script = code + REPORT.format(modules=HEAVY)
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stderr.splitlines()[-1]), result.stdout


@pytest.mark.parametrize("module", HEAVY)
def test_the_check_sees_a_heavy_import(module: str) -> None:
    """Each library is installed and would be seen: otherwise the tests below would prove nothing."""
    found, _ = loaded(f"import {module}")
    assert module in found


def test_importing_the_package_is_light() -> None:
    """`import aeroservo` loads none of the heavy libraries."""
    found, _ = loaded("import aeroservo")
    assert found == []


def test_help_is_light() -> None:
    """`aeroservo --help` prints help and loads none of the heavy libraries."""
    found, printed = loaded(HELP)
    assert "Usage" in printed
    assert found == []
