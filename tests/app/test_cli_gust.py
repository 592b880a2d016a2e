"""`gust`: the contract's JSON, the numbers of the Python functions, every kind of model, figures, bad input."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aeroservo.aircraft.files import read
from aeroservo.datatypes import FlightCondition
from aeroservo.gust.design_gusts import cs25_gradients
from aeroservo.gust.turbulence import cs25_turbulence
from aeroservo.studies.gust_loads import design_velocity, gust_loads
from aeroservo.studies.gust_plant import gust_plant
from aeroservo.studies.root_loads import with_loads

Cli = Callable[..., Any]
COMMON = {"schema_version", "model", "altitude_m", "density_kg_m3", "warnings"}
KEYS = COMMON | {
    "speed_m_s", "design", "stable", "growth_1_s", "cases", "critical", "rms_per_unit", "rms_per_unit_by_frequency",
    "turbulence",
}  # fmt: skip


def test_json_is_the_contracts_and_the_functions(cli: Cli) -> None:
    """Ten CS-25 gradients of BACT at 80 m/s: keys, and every number as `gust_loads` gives it."""
    found = cli("gust", "bact", "--speed", 80, "--json").json
    assert set(found) == KEYS
    assert (found["speed_m_s"], found["design"], found["stable"]) == (80.0, "cs25", True)
    model, loads = with_loads(read("bact"))
    plant = gust_plant(model, FlightCondition.at(0.0, V=80.0), loads=loads)
    velocity = design_velocity("cs25", altitude=0.0, density=float(FlightCondition.at(0.0, V=80.0).rho))
    own = gust_loads(plant, gradients=cs25_gradients(10), velocity=velocity)
    assert [case["gradient_m"] for case in found["cases"]] == pytest.approx(own.gradient.tolist())
    assert found["cases"][3]["peak"] == dict(zip(own.channels, own.peak[3].tolist()))
    assert found["cases"][9]["velocity_m_s"] == pytest.approx(17.07, rel=1e-4)
    assert own.critical is not None
    pitch = own.channels.index("pitch_rad")
    assert found["critical"]["pitch_rad"]["gradient_m"] == own.critical.gradient[pitch]
    assert found["critical"]["elevon_rad"] is None  # does not move
    assert found["rms_per_unit"]["pitch_rad"] == own.rms[pitch]
    assert found["rms_per_unit_by_frequency"]["pitch_rad"] == pytest.approx(own.rms[pitch], rel=1e-3)
    assert found["rms_per_unit"]["acceleration_m_s2"] is None  # the rate of the gust: infinite
    assert any("infinite" in note for note in found["warnings"])


@pytest.mark.parametrize(
    ("name", "speed", "load"),
    [
        ("goland", 90, "root_bending_N_m"),
        ("thesis-binary", 40, "tip_plunge_m"),
        ("thesis-aircraft", 30, "tip_twist_rad"),
        ("nasa-typical-section", 40, "plunge_spring_N_per_m"),
        ("thesis-simulation", 35, "pitch_spring_N_m"),
        ("thesis-uav", 40, "root_torque_N_m"),
    ],
)
def test_every_kind_of_model(cli: Cli, name: str, speed: float, load: str) -> None:
    """Peaks and RMS of each kind, finite and growing with the gust."""
    words = ("--speed", speed, "--design", "unit", "--gradients", "2:40:19", "--json")
    found = cli("gust", name, *words).json
    peaks = [case["peak"][load] for case in found["cases"]]
    assert len(peaks) == 3 and min(peaks) > 0.0
    assert found["critical"][load]["peak"] >= max(peaks) * (1.0 - 1e-9)
    assert found["rms_per_unit"][load] > 0.0 and found["rms_per_unit"]["gust_m_s"] == pytest.approx(1.0, rel=1e-6)


def test_modal_models_and_state_spaces(cli: Cli, tmp_path: Path) -> None:
    """A user's own modes with a gust column; a state space with a gust input, at its own speed."""
    k = np.array([0.0, 0.2, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0])
    Q = np.zeros((1, k.size, 1, 2), dtype=complex)
    Q[0, :, 0, 0], Q[0, :, 0, 1] = -1.0j * k, -1.0
    np.savez(
        tmp_path / "wing.npz", M=[[2.0]], D=[[0.0]], K=[[800.0]], k=k, mach=[0.0], Q=Q, b_m=0.5,
        mode_names=np.array(["bending"]), input_names=np.array(["bending", "gust"]),
    )  # fmt: skip
    file = tmp_path / "wing.toml"
    file.write_text('schema_version = 1\nkind = "modal"\nname = "mine"\n[modal]\ndata = "wing.npz"\n')
    found = cli("gust", file, "--speed", 30, "--design", "unit", "--gradients", "500:1000:500", "--json").json
    static = 0.5 * 1.225 * 30.0 / 800.0  # q_bar (w/V) / K
    assert found["cases"][1]["peak"]["bending"] == pytest.approx(static, rel=1e-2)
    system = tmp_path / "system.toml"
    system.write_text(
        'schema_version = 1\nkind = "state_space"\nname = "own"\n[model]\nA = [[0.0, 1.0], [-100.0, -2.0]]\n'
        'B = [[0.0], [5.0]]\nC = [[1.0, 0.0]]\nD = [[0.0]]\nstates = ["x", "v"]\ninputs = ["gust_m_s"]\n'
        'outputs = ["load_N"]\nspeed_m_s = 25.0\naltitude_m = 500.0\n'
    )
    found = cli("gust", system, "--json").json
    assert (found["speed_m_s"], found["altitude_m"]) == (25.0, 500.0)
    assert found["critical"]["load_N"]["peak"] > 0.0
    answer = cli("gust", "thesis-appendix", "--json")
    assert answer.code == 2 and "no gust input" in answer.err


def test_turbulence_of_cs25(cli: Cli) -> None:
    """A of CS-25.341(b): von Karman with L = 762 m, by the clause's own integral to the 0.25 % of the filter."""
    words = ("--speed", 80, "--turbulence-kind", "von_karman", "--json")
    found = cli("gust", "bact", *words).json
    assert found["turbulence"] == {"kind": "von_karman", "scale_length_m": 762.0, "intensity_m_s": 1.0}
    model, loads = with_loads(read("bact"))
    plant = gust_plant(model, FlightCondition.at(0.0, V=80.0), loads=loads)
    own = gust_loads(
        plant, gradients=[20.0], velocity=lambda H: np.ones(1), bounds=None, turbulence=cs25_turbulence(),
        model="von_karman",
    )  # fmt: skip
    for name in ("pitch_rad", "plunge_spring_N"):
        i = own.channels.index(name)
        assert found["rms_per_unit"][name] == own.rms[i]
        assert own.rms[i] == pytest.approx(own.rms_by_frequency[i], rel=2.5e-3)


def test_the_blocksets_filter_loses_the_flutter_band(cli: Cli) -> None:
    """Its rational filter against the exact spectrum on Goland's tip acceleration, which lives at 10 Hz."""
    words = ("--speed", 90, "--turbulence-kind", "von_karman_blockset", "--json")
    found = cli("gust", "goland", *words).json
    name = "tip_acceleration_m_s2"
    assert 0.4 < found["rms_per_unit"][name] / found["rms_per_unit_by_frequency"][name] < 0.7
    good = cli("gust", "goland", "--speed", 90, "--turbulence-kind", "von_karman", "--json").json
    assert good["rms_per_unit"][name] == pytest.approx(good["rms_per_unit_by_frequency"][name], rel=2.5e-3)


def test_unstable_is_an_answer(cli: Cli, tmp_path: Path) -> None:
    """Beyond flutter: exit 0, nulls, a warning, figures that say so."""
    plot = tmp_path / "gust.png"
    answer = cli("gust", "goland", "--speed", 160, "--plot", plot, "--json")
    found = answer.json
    assert answer.code == 0 and found["stable"] is False and found["critical"] is None
    assert set(found["cases"][0]["peak"].values()) == set(found["rms_per_unit"].values()) == {None}
    assert any("unstable at 160 m/s" in note for note in found["warnings"])
    assert plot.read_bytes().startswith(b"\x89PNG")
    assert "unstable" in cli("gust", "goland", "--speed", 160).out


def test_the_25_chord_gust_and_a_density(cli: Cli) -> None:
    """CS-23: one gradient of 12.5 chords, 15.24 m/s; a density has no altitude, so gusts are of 1 m/s."""
    found = cli("gust", "nasa-typical-section", "--speed", 30, "--design", "cs23", "--json").json
    assert [case["gradient_m"] for case in found["cases"]] == pytest.approx([12.5 * 0.6096])
    assert found["cases"][0]["velocity_m_s"] == pytest.approx(15.24, rel=1e-4) and found["critical"] is None
    assert "12.5" not in cli("gust", "nasa-typical-section", "--speed", 30, "--design", "cs23").err
    found = cli("gust", "bact", "--speed", 80, "--density", 1.0, "--json").json
    assert (found["design"], found["altitude_m"], found["cases"][0]["velocity_m_s"]) == ("unit", None, 1.0)


def test_controller_and_figures(cli: Cli, tmp_path: Path) -> None:
    """A continuous gain changes the answer; both figures are written; the table names the worst gradient."""
    file = tmp_path / "gain.json"
    law = {"A": [], "B": [], "C": [], "D": [[0.05]], "dt_s": None, "inputs": ["pitch_rate_rad_s"],
           "outputs": ["elevon_command_rad"]}  # fmt: skip
    file.write_text(json.dumps(law))
    words = ("gust", "bact", "--speed", 80, "--design", "unit", "--gradients", "5:40:5")
    plain = cli(*words, "--json").json
    plot, spectra = tmp_path / "g.pdf", tmp_path / "s.png"
    closed = cli(*words, "--controller", file, "--plot", plot, "--spectra", spectra, "--json").json
    assert closed["rms_per_unit"]["pitch_rad"] != pytest.approx(plain["rms_per_unit"]["pitch_rad"], rel=1e-2)
    assert closed["critical"]["elevon_rad"]["peak"] > 0.0
    assert plot.read_bytes().startswith(b"%PDF") and spectra.read_bytes().startswith(b"\x89PNG")
    file.write_text(json.dumps(law | {"dt_s": 0.005}))
    sampled = cli(*words, "--controller", file, "--plot", plot, "--json").json
    assert sampled["critical"] is None and any("instants" in note for note in sampled["warnings"])
    assert sampled["rms_per_unit"]["pitch_rad"] == pytest.approx(closed["rms_per_unit"]["pitch_rad"], rel=0.05)
    assert sampled["cases"][0]["peak"]["pitch_rad"] == pytest.approx(closed["cases"][0]["peak"]["pitch_rad"], rel=0.05)
    out = cli(*words).out
    assert "largest peak" in out and "pitch_rad" in out and "RMS per m/s" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "--speed"),
        (("--speed", -3), "airspeed"),
        (("--speed", 40, "--altitude", -100), "0 to 18288"),
        (("--speed", 40, "--altitude", 20_000), "0 to 18288"),
        (("--speed", 40, "--altitude", 100, "--density", 1), "not both"),
        (("--speed", 40, "--density", 1, "--design", "cs25"), "needs an altitude"),
        (("--speed", 40, "--design", "far25"), "--design"),
        (("--speed", 40, "--gradients", "5:50:5"), "9 to 107"),
        (("--speed", 40, "--design", "unit", "--gradients", "0:50:5"), "must be positive"),
        (("--speed", 40, "--design", "unit", "--gradients", "1:2"), "MIN:MAX:STEP"),
        (("--speed", 40, "--design", "unit", "--gradients", "1:20000:1"), "2,000"),
        (("--speed", 40, "--turbulence-kind", "kaimal"), "--turbulence-kind"),
        (("--speed", 40, "--scale-length", 0), "--scale-length"),
        (("--speed", 40, "--controller", "nowhere.json"), "nowhere.json"),
        (("--speed", 40, "--plot", "x.svg"), "--plot"),
        (("--speed", 40, "--spectra", "x.txt"), "--spectra"),
        (("--speed", 40, "--aero", "jones"), "derivatives"),
    ],
)  # fmt: skip
def test_bad_input(cli: Cli, words: tuple[Any, ...], message: str) -> None:
    """Exit code 2, the reason, nothing on stdout."""
    answer = cli("gust", "thesis-simulation", *words, "--json")
    assert (answer.code, answer.out) == (2, "")
    assert message in answer.err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--turbulence", -1), "must not be negative"),
        (("--turbulence", 1, "--spectrum", "kaimal"), "--spectrum"),
        (("--turbulence", 1, "--specification", "MIL-8785"), "--specification"),
        (("--spectrum", "dryden"), "--turbulence LEVEL"),
        (("--altitude", -20, "--turbulence", "light"), "below ground"),
        (("--altitude", -20, "--turbulence", 1), "below ground"),
        (("--altitude", 30_000, "--turbulence", "severe"), "must not exceed"),
        (("--density", 1, "--turbulence", "light"), "goes by altitude"),
        (("--gust", "cosine:1:0.02@0"), "at least 1 step"),
        (("--gust", "cosine:1:-3@0"), "must be positive"),
        (("--gust", "cosine:1:3@-1"), "must not be negative"),
    ],
)
def test_bad_weather_of_simulate(cli: Cli, words: tuple[Any, ...], message: str) -> None:
    """What issue 6 names: negative intensity, a gust shorter than the step, altitude below ground, unknown names."""
    answer = cli("simulate", "thesis-simulation", "--speed", 40, "--duration", 1, *words, "--json")
    assert (answer.code, answer.out) == (2, "")
    assert message in answer.err


def test_spectra_of_simulated_turbulence(cli: Cli, tmp_path: Path) -> None:
    """The Blockset's defaults leave less pitch; the specification's name changes nothing; the figure has a spectrum."""
    words = ("simulate", "thesis-simulation", "--speed", 40, "--duration", 40, "--turbulence", 2, "--seed", 1, "--json")
    plot = tmp_path / "flight.png"
    dryden = cli(*words, "--plot", plot).json
    assert plot.read_bytes().startswith(b"\x89PNG")
    other = cli(*words, "--specification", "MIL-HDBK-1797").json
    assert other["rms"]["pitch_rad"] == pytest.approx(dryden["rms"]["pitch_rad"], rel=1e-9)
    block = cli(*words, "--spectrum", "dryden_blockset").json
    assert block["rms"]["pitch_rate_rad_s"] < 0.9 * dryden["rms"]["pitch_rate_rad_s"]
    exact = cli(*words, "--spectrum", "von_karman").json
    assert exact["rms"]["gust_m_s"] > 0.0 and exact["rms"]["pitch_rad"] != dryden["rms"]["pitch_rad"]
