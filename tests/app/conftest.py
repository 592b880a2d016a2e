"""Run the command line inside the test process."""

from __future__ import annotations

import json
import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest

from aeroservo.cli import main


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What a command answered."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        """The one JSON object on stdout; NaN and infinity are no JSON."""

        def refuse(word: str) -> None:
            raise AssertionError(f"{word} in JSON")

        answer: dict[str, Any] = json.loads(self.out, parse_constant=refuse)
        return answer


@pytest.fixture
def cli(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Callable[..., Answer]:
    """`cli("flutter", "goland")` runs that command."""

    def run(*arguments: Any) -> Answer:
        monkeypatch.setattr(sys, "argv", ["aeroservo", *(str(a) for a in arguments)])
        capsys.readouterr()
        code = 0
        with warnings.catch_warnings():
            try:
                main()
            except SystemExit as stop:
                code = stop.code if isinstance(stop.code, int) else 0 if stop.code is None else 1
        out, err = capsys.readouterr()
        assert "Traceback" not in out + err
        return Answer(code=code, out=out, err=err)

    return run
