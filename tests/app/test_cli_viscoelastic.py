"""Viscoelastic wings on the command line: every analysis works or says why not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import aeroservo as av
from aeroservo.aeroelastic.creep import creep_time

Cli = Callable[..., Any]
TABLE = """
[viscoelastic]
temperature_C = 30.0
reference_temperature_C = 20.0
wlf_C1 = 10.0
wlf_C2_K = 100.0
[viscoelastic.bending]
ratios = [0.1, 0.15]
times_s = [0.01, 1.0]
[viscoelastic.torsion]
ratios = [0.15, 0.2]
times_s = [0.02, 50.0]
"""


@pytest.fixture
def goland(cli: Cli, tmp_path: Path) -> Path:
    """The Goland wing of a material that creeps."""
    file = tmp_path / "goland.toml"
    assert cli("new", "goland", file).code == 0
    file.write_text(file.read_text() + TABLE)
    return file


def test_statics_glassy_and_relaxed(cli: Cli, goland: Path) -> None:
    """The speeds of the long run first, those at once beside them, and the time to a twist."""
    answer = cli("static", goland, "--json", "--speeds", "100:260:20", "--creep-to", 10).json
    two = answer["viscoelastic"]
    assert two["glassy_divergence_speed_m_s"] == pytest.approx(252.355, abs=0.01)
    assert answer["divergence_speed_m_s"] == two["relaxed_divergence_speed_m_s"]
    assert answer["divergence_speed_m_s"] == pytest.approx(252.355 * np.sqrt(0.65), abs=0.01)
    creep = two["creep"]
    model = av.build(av.read(goland))
    times = creep_time(model, av.FlightCondition.at(0.0, V=np.array(creep["speed_m_s"])), twist=10.0)
    assert [t for t in creep["time_s"] if t is not None] == pytest.approx(times[np.isfinite(times)].tolist())
    assert creep["time_s"][0] is None and creep["time_s"][-1] == 0.0
    between = creep["time_s"][creep["speed_m_s"].index(220.0)]
    assert 0.0 < between < 50.0  # creep divergence: held at once, gone within the material's own time
    people = cli("static", goland, "--speeds", "100:260:20", "--creep-to", 10)
    assert "at once (glassy)" in people.out and "time until the tip twists 10" in people.out
    assert "65 % of torsion remains" in people.err
    refused = cli("static", "goland", "--creep-to", 2)
    assert refused.code == 2 and "needs a viscoelastic structure" in refused.err


def test_modes_glassy_and_relaxed(cli: Cli, goland: Path) -> None:
    """Frequencies at once are the elastic ones; in the long run lower, between the roots of what is left."""
    answer, elastic = cli("modes", goland, "--json").json, cli("modes", "goland", "--json").json
    np.testing.assert_allclose(answer["frequencies_rad_s"], elastic["frequencies_rad_s"], rtol=1e-12)
    ratio = np.array(answer["relaxed"]["frequencies_rad_s"]) / np.array(elastic["frequencies_rad_s"])
    assert np.all((ratio > np.sqrt(0.65) - 1e-9) & (ratio < np.sqrt(0.75) + 1e-9))
    assert "relaxed: in the long run" in cli("modes", goland).out


def test_analyses_work_or_say_why(cli: Cli, goland: Path) -> None:
    """p-k and p agree; k is refused; states of relaxation have names; the wing can be simulated and varied."""
    speeds = ("--speeds", "50:200:10", "--json")
    p = cli("flutter", goland, "--method", "p", "--aero", "jones", *speeds).json
    pk = cli("flutter", goland, "--method", "pk", "--aero", "jones", *speeds).json
    assert p["flutter_speed_m_s"] == pytest.approx(pk["flutter_speed_m_s"], rel=1e-6)
    refused = cli("flutter", goland, "--method", "k", *speeds)
    assert refused.code == 2 and "does not depend on frequency" in refused.err
    states = cli("linearize", goland, "--speed", 50, "--aero", "jones", "--json").json["states"]
    lags, relaxing = (sum(name.startswith(word) for name in states) for word in ("lag_", "relaxation_"))
    assert states[-1].startswith("relaxation_") and len(states) == 20 + lags + relaxing and 20 < relaxing <= 40
    peaks = cli("gust", goland, "--speed", 50, "--json").json["cases"][0]["peak"]
    assert peaks["root_bending_N_m"] > 0.0
    words = ("--speed", 50, "--aero", "quasi_steady_damped", "--duration", 0.5, "--json")
    assert cli("simulate", goland, *words).json["bounded"]
    vary = ("--vary", "viscoelastic.temperature_C=uniform:10:40", "--runs", 2, "--workers", 1)
    assert cli("simulate", goland, *words, *vary).json["done"] == 2
    cold = goland.with_name("cold.toml")
    cold.write_text(goland.read_text().replace("temperature_C = 30.0", "temperature_C = -90.0", 1))
    answer = cli("flutter", cold)
    assert answer.code == 2 and "must be above -80" in answer.err
