"""`simulate`: the contract's JSON to the key, files, figures, and the same numbers as the Python functions."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import aeroservo as av
from aeroservo.simulate.disturbances import CosineGust, Gustiness
from aeroservo.simulate.engine import simulate
from aeroservo.simulate.history import read_history
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario

Cli = Callable[..., Any]
COMMON = {"schema_version", "model", "altitude_m", "density_kg_m3", "warnings"}
KEYS = COMMON | {"bounded", "growth_1_s", "limit_cycle", "peak", "rms", "limit_left"}
CHANNELS = {
    "plunge_m",
    "plunge_rate_m_s",
    "pitch_rad",
    "pitch_rate_rad_s",
    "elevon_rad",
    "elevon_command_rad",
    "gust_m_s",
    "speed_m_s",
    "altitude_m",
    "acceleration_m_s2",
}


def test_json_is_the_contracts(cli: Cli) -> None:
    """Keys, channels, and the numbers of the Python function."""
    answer = cli("simulate", "thesis-simulation", "--speed", 38, "--duration", 2, "--gust", "cosine:5:20@0.2", "--json")
    found = answer.json
    assert answer.code == 0
    assert set(found) == KEYS
    assert set(found["peak"]) == set(found["rms"]) == CHANNELS
    assert (found["altitude_m"], found["bounded"], found["limit_left"], found["limit_cycle"]) == (0.0, True, None, None)
    gust = CosineGust(amplitude=5.0, length=20.0, start=0.2)
    run = simulate(av.build(av.read("thesis-simulation")), Scenario(profile=level(38.0), duration=2.0, gusts=(gust,)))
    assert found["peak"] == dict(zip(run.channels, run.peak.tolist()))
    assert found["growth_1_s"] == run.growth
    assert found["peak"]["gust_m_s"] == pytest.approx(5.0, rel=1e-4)


def test_flutter_of_bact_from_the_command_line(cli: Cli) -> None:
    """Below 118.52 m/s bounded and decaying, above growing; density instead of altitude has no altitude channel."""
    for speed, bounded in ((116, True), (121, False)):
        found = cli("simulate", "bact", "--speed", speed, "--density", 1.01628, "--json").json
        assert found["bounded"] is bounded and (found["growth_1_s"] < 0.0) is bounded
        assert "altitude_m" not in found["peak"] and found["altitude_m"] is None
        assert any("starts with pitch_rad" in note for note in found["warnings"])


def test_seed_and_turbulence(cli: Cli, tmp_path: Path) -> None:
    """The same seed writes the same file, another one another; growth is null; the file is the run."""
    files = [tmp_path / f"{i}.csv" for i in range(3)]
    for file, seed in zip(files, (5, 5, 6)):
        words = ("--speed", 35, "--turbulence", 1.5, "--duration", 3, "--seed", seed, "--out", file, "--json")
        found = cli("simulate", "thesis-simulation", *words).json
        assert found["growth_1_s"] is None
    assert files[0].read_bytes() == files[1].read_bytes() != files[2].read_bytes()
    scenario = Scenario(profile=level(35.0), duration=3.0, turbulence=Gustiness(level=1.5))
    run = simulate(av.build(av.read("thesis-simulation")), scenario, seed=5)
    assert run.history is not None
    np.testing.assert_array_equal(read_history(files[0]).data, run.history.data)


def test_climb_with_turbulence_and_figure(cli: Cli, tmp_path: Path) -> None:
    """The thesis' climb without control: flutter on the way, stopped where pitch reaches half a turn; NetCDF, PNG."""
    out, plot = tmp_path / "climb.nc", tmp_path / "climb.png"
    words = ("--profile", "climb", "--turbulence", "light", "--seed", 3, "--out", out, "--plot", plot, "--json")
    found = cli("simulate", "thesis-simulation", *words).json
    assert found["limit_left"]["channel"] == "pitch_rad" and found["bounded"] is False
    assert found["altitude_m"] is None and 45.0 < found["peak"]["speed_m_s"] < 60.0
    history = read_history(out)
    assert history.t[-1] <= found["limit_left"]["at_s"] and "limit" in history.events[0].text
    assert plot.read_bytes().startswith(b"\x89PNG")


def test_controller_file_closes_the_loop(cli: Cli, tmp_path: Path) -> None:
    """55 m/s at 10,000 ft is beyond flutter: unbounded as it is, bounded with the sampled LQR."""
    file = tmp_path / "lqr.json"
    gains = [[6.783, 1.69, 0.573, 0.916]]
    names = ["plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s"]
    law = {"A": [], "B": [], "C": [], "D": gains, "dt_s": 0.002, "inputs": names, "outputs": ["elevon_command_rad"]}
    file.write_text(json.dumps(law))
    words = ("--speed", 55, "--altitude", 3048, "--initial", "pitch_rad=0.01", "--json")
    alone, closed = (cli("simulate", "thesis-simulation", *words, *more).json for more in ((), ("--controller", file)))
    assert alone["bounded"] is False and closed["bounded"] is True
    assert alone["peak"]["elevon_rad"] == 0.0 < closed["peak"]["elevon_rad"]


def test_other_kinds(cli: Cli) -> None:
    """A linear model at its own condition; a beam wing on fitted Theodorsen strips."""
    found = cli("simulate", "thesis-appendix", "--duration", 20, "--json").json
    assert found["growth_1_s"] == pytest.approx(0.337903, rel=1e-3)
    answer = cli("simulate", "goland", "--speed", 120, "--gust", "sharp:2@0.1", "--duration", 1, "--json")
    assert answer.json["bounded"] is True and "rational fit" in answer.err
    assert {"bending_1", "torsion_1"} <= set(answer.json["peak"])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "--speed"),
        (("--speed", 30, "--profile", "climb"), "one of them"),
        (("--profile", "loop"), "climb"),
        (("--profile", "climb", "--altitude", 10), "own altitudes"),
        (("--speed", 30, "--gust", "box:1@2"), "--gust"),
        (("--speed", 30, "--turbulence", "heavy"), "--turbulence"),
        (("--speed", 30, "--turbulence", -1), "negative"),
        (("--speed", 30, "--initial", "roll=1"), "no state"),
        (("--speed", 30, "--initial", "pitch_rad"), "STATE=VALUE"),
        (("--speed", 30, "--duration", -1), "duration"),
        (("--speed", -3,), "airspeed"),
        (("--speed", 30, "--controller", "nowhere.json"), "nowhere.json"),
        (("--speed", 30, "--out", "x.txt"), "--out"),
        (("--speed", 30, "--aero", "jones"), "derivatives"),
    ],
)  # fmt: skip
def test_bad_input(cli: Cli, words: tuple[Any, ...], message: str) -> None:
    """Exit code 2, a message, nothing on stdout."""
    answer = cli("simulate", "thesis-simulation", *words, "--json")
    assert (answer.code, answer.out) == (2, "")
    assert message in answer.err


def test_table_for_people(cli: Cli) -> None:
    """Without --json: what was done, and every channel."""
    answer = cli("simulate", "bact", "--speed", 110, "--density", 1.0, "--duration", 1)
    assert answer.code == 0
    assert "bounded" in answer.out and "acc_te_m_s2" in answer.out and "Runge-Kutta" in answer.out


def test_a_gust_that_never_comes_and_a_seed_that_is_none(cli: Cli) -> None:
    """The first is said, the second refused."""
    flight = ("simulate", "thesis-simulation", "--speed", 38, "--duration", 1, "--gust")
    assert "--gust at 50 s comes after the end" in " ".join(cli(*flight, "sharp:1@50", "--json").json["warnings"])
    answer = cli(*flight, "sharp:1@0.1", "--seed", "-1")
    assert answer.code == 2 and "--seed must not be negative" in answer.err
