"""`flutter --sensitivities` and sweeps over altitude: the numbers of the Python functions, JSON, table, chart."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aeroservo.aeroelastic.flutter import P
from aeroservo.aeroelastic.sensitivity import sensitivities
from aeroservo.aircraft.files import read
from aeroservo.datatypes import FlightCondition

Cli = Callable[..., Any]
SPEEDS = ("--speeds", "20:120:10")


def test_sensitivities_json(cli: Cli, tmp_path: Path) -> None:
    """One row for each number, the same as in Python; the figure is the tornado chart."""
    plot = tmp_path / "t.png"
    answer = cli("flutter", "thesis-binary", *SPEEDS, "--sensitivities", "--plot", plot, "--json")
    assert answer.code == 0, answer.err
    rows = answer.json["sensitivities"]
    sweep = FlightCondition.at(0.0, V=np.arange(20.0, 121.0, 10.0))
    for row, one in zip(rows, sensitivities(read("thesis-binary"), sweep, P()), strict=True):
        assert set(row) == {"field", "value"} | {
            f"{kind}_{name}" for kind in ("dV", "relative") for name in ("flutter", "divergence", "reversal")
        }
        assert (row["field"], row["value"]) == (one.field, one.value)
        assert row["dV_flutter"] == pytest.approx(one.dV_flutter, rel=1e-9, abs=1e-12)
    assert plot.read_bytes().startswith(b"\x89PNG")


def test_sensitivities_table(cli: Cli) -> None:
    """For people: what moves a speed most comes first, and speeds that are not there are left open."""
    answer = cli("flutter", "thesis-binary", "--speeds", "5:20:5", "--sensitivities")
    assert answer.code == 0, answer.err
    table = answer.out[answer.out.index("field ") :].splitlines()
    assert table[2].split()[0] == "wing.chord_m"
    assert table[2].split()[2] == "-"


def test_sensitivities_and_over(cli: Cli) -> None:
    """Two questions at once are refused."""
    answer = cli("flutter", "thesis-binary", *SPEEDS, "--sensitivities", "--over", "wing.chord_m=0.5:0.6:0.1")
    assert (answer.code, answer.out) == (2, "")
    assert "one at a time" in answer.err


def test_over_altitude(cli: Cli) -> None:
    """Altitude is a number of the sweep: the speeds of single runs at that altitude, alone and with a field."""
    over = ("--over", "altitude_m=0:3000:1500", "--over", "wing.pitch_stiffness_N_m=400:500:100")
    answer = cli("flutter", "thesis-binary", *SPEEDS, *over, "--json")
    assert answer.code == 0, answer.err
    points = answer.json["points"]
    assert [p["values"] for p in points] == [[h, k] for h in (0.0, 1500.0, 3000.0) for k in (400.0, 500.0)]
    alone = cli("flutter", "thesis-binary", *SPEEDS, "--over", "altitude_m=0:3000:1500", "--json").json["points"]
    for point in alone:
        single = cli("flutter", "thesis-binary", *SPEEDS, "--altitude", point["values"][0], "--json").json
        assert point["flutter_speed_m_s"] == single["flutter_speed_m_s"]


def test_altitude_beyond_the_atmosphere(cli: Cli) -> None:
    """Refused before the first point."""
    answer = cli("flutter", "thesis-binary", *SPEEDS, "--over", "altitude_m=0:900000:300000")
    assert (answer.code, answer.out) == (2, "")
    assert "altitude" in answer.err
