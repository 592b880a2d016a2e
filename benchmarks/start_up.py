"""Start-up: importing the package, and asking for help, against importing numpy."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable

from benchmarks.side_by_side import Row, compare

HELP = "import sys; sys.argv = ['aeroservo', '--help']; from aeroservo.cli import main; main()"


def measure() -> list[Row]:
    """Wall time of fresh interpreters, ours and numpy's in turns; an interpreter's own start is in both."""
    numpy = fresh("import numpy")
    return [
        compare("import aeroservo / import numpy", fresh("import aeroservo"), numpy, target=2.0, rounds=11),
        compare("aeroservo --help / import numpy", fresh(HELP), numpy, target=2.0, rounds=11),
    ]


def fresh(code: str) -> Callable[[], object]:
    """A call that runs `code` in a fresh interpreter and fails if that fails."""
    return lambda: subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)
