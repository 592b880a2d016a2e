"""Commands that compute: the contract's JSON to the key, and the same numbers as the Python functions."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat, savemat

import aeroservo as av
from aeroservo.aeroelastic.build import build

Cli = Callable[..., Any]
COMMON = {"schema_version", "model", "altitude_m", "density_kg_m3", "warnings"}
FLUTTER = COMMON | {
    "method",
    "aero",
    "speeds_m_s",
    "found",
    "flutter_speed_m_s",
    "flutter_speed_eas_m_s",
    "flutter_frequency_rad_s",
    "flutter_mode",
    "unstable_intervals",
    "divergence_speed_m_s",
    "first_real_instability_m_s",
    "modes",
}
#: Coarse: the answer does not depend on the step, and a test has no time to waste.
SPEEDS = ("--speeds", "20:120:10")


def test_flutter_json(cli: Cli) -> None:
    """Keys of contract.md, "flutter", and the figures of targets.json for the inferred binary wing."""
    answer = cli("flutter", "thesis-binary", "--json", *SPEEDS)
    found = answer.json
    assert answer.code == 0
    assert set(found) == FLUTTER
    assert found["schema_version"] == 1
    assert (found["model"], found["method"], found["aero"]) == ("thesis-binary", "p", "quasi_steady_damped")
    assert found["speeds_m_s"] == [20.0, 120.0, 10.0]
    assert found["found"] is True
    assert found["flutter_speed_m_s"] == pytest.approx(49.1632, rel=1e-5)
    assert found["flutter_speed_eas_m_s"] == pytest.approx(found["flutter_speed_m_s"], rel=1e-6)
    assert found["flutter_frequency_rad_s"] == pytest.approx(2.0 * math.pi * 8.077, rel=1e-4)
    assert found["divergence_speed_m_s"] == pytest.approx(81.00479, rel=1e-6)
    assert found["altitude_m"] == 0.0
    assert found["density_kg_m3"] == pytest.approx(1.225, rel=1e-6)
    assert set(found["unstable_intervals"][0]) == {"from_m_s", "to_m_s", "frequency_rad_s", "mode", "kind"}
    assert found["unstable_intervals"][0]["from_m_s"] == found["flutter_speed_m_s"]
    for mode in found["modes"]:
        assert set(mode) == {"name", "speed_m_s", "frequency_rad_s", "damping_ratio"}
        assert len(mode["speed_m_s"]) == len(mode["frequency_rad_s"]) == len(mode["damping_ratio"]) == 11
        assert mode["speed_m_s"] == [20.0 + 10.0 * i for i in range(11)]
    flutters = next(mode for mode in found["modes"] if mode["name"] == found["flutter_mode"])
    assert flutters["damping_ratio"][0] > 0.0 > flutters["damping_ratio"][-1]


def test_flutter_out(cli: Cli, tmp_path: Path) -> None:
    """--out holds what --json prints, replaces an older file, and leaves nothing else."""
    path = tmp_path / "x.json"
    path.write_text("old", encoding="utf-8")
    answer = cli("flutter", "thesis-binary", "--json", *SPEEDS, "--out", path)
    assert json.loads(path.read_text(encoding="utf-8")) == answer.json
    assert str(path) in answer.err
    assert [p.name for p in tmp_path.iterdir()] == ["x.json"]


def test_flutter_is_the_python_function(cli: Cli) -> None:
    """The command gives what `aeroservo.flutter` gives, bit for bit."""
    found = cli("flutter", "thesis-aircraft", "--json", "--altitude", "3048", *SPEEDS).json
    sweep = av.FlightCondition.at(3048.0, V=np.arange(20.0, 121.0, 10.0))
    same = av.flutter(build(av.read("thesis-aircraft")), sweep, av.P())
    assert found["flutter_speed_m_s"] == same.flutter_speed
    assert found["flutter_frequency_rad_s"] == same.flutter_frequency
    assert found["divergence_speed_m_s"] == same.divergence_speed
    assert found["first_real_instability_m_s"] == same.first_real_instability
    assert found["flutter_speed_eas_m_s"] == pytest.approx(same.flutter_speed * math.sqrt(0.904637 / 1.225), rel=1e-5)
    assert [mode["name"] for mode in found["modes"]] == list(same.names)
    assert found["altitude_m"] == 3048.0
    assert found["density_kg_m3"] == sweep.rho[0]


def test_no_flutter_is_an_answer(cli: Cli) -> None:
    """Below every speed of instability: found is false, the speed null, the code 0."""
    answer = cli("flutter", "thesis-binary", "--json", "--speeds", "1:40:1")
    assert answer.code == 0
    assert answer.json["found"] is False
    assert answer.json["flutter_speed_m_s"] is None
    assert answer.json["flutter_speed_eas_m_s"] is None
    assert answer.json["unstable_intervals"] == []
    assert answer.json["divergence_speed_m_s"] == pytest.approx(81.00479, rel=1e-6)
    assert "none in this range" in cli("flutter", "thesis-binary", "--speeds", "1:40:1").out


def test_unstable_from_the_start(cli: Cli) -> None:
    """A root unstable at the lowest speed: from is null, found is true, the flutter speed is null, and a warning."""
    answer = cli("flutter", "thesis-binary", "--json", "--speeds", "55:75:1")
    assert answer.json["found"] is True
    assert answer.json["flutter_speed_m_s"] is None
    assert answer.json["unstable_intervals"][0]["from_m_s"] is None
    assert answer.json["warnings"]
    assert all(warning in answer.err for warning in answer.json["warnings"])


@pytest.mark.parametrize(
    ("options", "method", "aero"),
    [
        ([], "p", "quasi_steady_damped"),
        (["--aero", "theodorsen"], "pk", "theodorsen"),
        (["--aero", "jones"], "p", "jones"),
        (["--aero", "quasi_steady", "--method", "g"], "g", "quasi_steady"),
        (["--method", "k", "--aero", "theodorsen"], "k", "theodorsen"),
    ],
)
def test_method_and_aero_in_force_are_named(cli: Cli, options: list[str], method: str, aero: str) -> None:
    """Options, else the default of the kind; samples are taken by p-k unless p is asked for."""
    found = cli("flutter", "thesis-binary", "--json", *SPEEDS, *options).json
    assert (found["method"], found["aero"]) == (method, aero)
    assert found["found"] is True


def test_p_on_samples_tells_its_fit(cli: Cli) -> None:
    """--method p on Theodorsen's samples fits them first, says how well, and refuses beyond the bound."""
    answer = cli("flutter", "nasa-typical-section", "--method", "p", "--json", *SPEEDS)
    assert answer.code == 0
    assert "rational fit" in answer.err
    assert answer.json["flutter_speed_m_s"] == pytest.approx(52.81036, rel=1e-3)
    refused = cli("flutter", "nasa-typical-section", "--method", "p", "--fit-bound", "1e-6", "--json", *SPEEDS)
    assert (refused.code, refused.out) == (2, "")
    assert "bound" in refused.err


def test_nasa_section_to_its_digits(cli: Cli) -> None:
    """173.26235 ft/s by p-k and k at 1.225 kg/m3 (NASA/TP-2015-218765, Appendix C, recomputed to 1e-5)."""
    for method in ("pk", "k"):
        found = cli("flutter", "nasa-typical-section", "--density", "1.225", "--method", method, "--json", *SPEEDS).json
        assert found["flutter_speed_m_s"] / 0.3048 == pytest.approx(173.26235, rel=1e-5)
        assert found["altitude_m"] is None
        assert found["density_kg_m3"] == 1.225


def test_static_json(cli: Cli) -> None:
    """Keys of the contract; divergence 81, roll reversal 55 m/s; effectiveness passes through zero there."""
    answer = cli("static", "thesis-binary", "--json", "--speeds", "5:100:5")
    found = answer.json
    assert set(found) == COMMON | {
        "divergence_speed_m_s",
        "divergence_dynamic_pressure_Pa",
        "reversal_speed_m_s",
        "reversal_dynamic_pressure_Pa",
        "reversal_quantity",
        "effectiveness",
        "twist",
    }
    assert set(found["effectiveness"]) == {"speed_m_s", "value"}
    assert set(found["twist"]) == {"speed_m_s", "value_rad"}
    assert found["divergence_speed_m_s"] == pytest.approx(81.00479, rel=1e-6)
    assert found["reversal_speed_m_s"] == pytest.approx(55.0, rel=1e-4)
    assert found["reversal_quantity"] == "roll"
    for what in ("divergence", "reversal"):
        q = 0.5 * found["density_kg_m3"] * found[f"{what}_speed_m_s"] ** 2
        assert found[f"{what}_dynamic_pressure_Pa"] == pytest.approx(q, rel=1e-12)
    at = dict(zip(found["effectiveness"]["speed_m_s"], found["effectiveness"]["value"]))
    assert at[50.0] > 0.0 > at[60.0]
    assert at[85.0] is None  # past divergence linear statics mean nothing
    assert "55" in cli("static", "thesis-binary").out


def test_modes_json(cli: Cli) -> None:
    """Keys of the contract; 4.54206 and 11.61581 Hz (targets.json)."""
    found = cli("modes", "thesis-binary", "--json").json
    assert set(found) == COMMON | {"frequencies_Hz", "frequencies_rad_s", "names", "generalized_mass"}
    assert found["frequencies_Hz"] == pytest.approx([4.54206, 11.61581], rel=1e-5)
    assert np.array(found["frequencies_rad_s"]) == pytest.approx(2.0 * math.pi * np.array(found["frequencies_Hz"]))
    assert len(found["names"]) == len(found["generalized_mass"]) == 2


def test_linearize_json_and_files(cli: Cli, tmp_path: Path) -> None:
    """The named state space on stdout, in a .json and in a .mat file; its eigenvalues flutter where flutter says."""
    speed = 49.16322
    answer = cli("linearize", "thesis-binary", "--speed", speed, "--json", "--out", tmp_path / "x.json")
    found = answer.json
    assert set(found) == COMMON | {"A", "B", "C", "D", "states", "inputs", "outputs", "dt_s"}
    assert found["dt_s"] is None
    assert json.loads((tmp_path / "x.json").read_text(encoding="utf-8")) == found
    roots = np.linalg.eigvals(np.array(found["A"]))
    assert abs(roots.real).min() < 1e-4
    assert np.array(found["B"]).shape == (len(found["states"]), len(found["inputs"]))
    assert np.array(found["C"]).shape == (len(found["outputs"]), len(found["states"]))
    assert all("_m" in name or "_rad" in name for name in found["states"])
    assert cli("linearize", "thesis-binary", "--speed", speed, "--out", tmp_path / "x.mat").code == 0
    matlab = loadmat(tmp_path / "x.mat")
    np.testing.assert_array_equal(matlab["A"], found["A"])
    assert [str(cell[0]) for cell in matlab["states"].ravel()] == found["states"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["x.json", "x.mat"]


def test_linearize_fits_samples(cli: Cli) -> None:
    """Theodorsen's samples become lag states, with the error told."""
    answer = cli("linearize", "nasa-typical-section", "--speed", "50", "--json")
    assert "rational fit" in answer.err
    assert any(name.startswith("lag") for name in answer.json["states"])


@pytest.mark.parametrize(
    ("arguments", "name", "magic"),
    [
        (("flutter", "thesis-aircraft", *SPEEDS), "x.png", b"\x89PNG"),
        (("flutter", "thesis-aircraft", *SPEEDS), "x.pdf", b"%PDF"),
        (("static", "thesis-binary", *SPEEDS), "x.PNG", b"\x89PNG"),
        (("modes", "thesis-binary"), "x.pdf", b"%PDF"),
        (("modes", "nasa-typical-section"), "x.png", b"\x89PNG"),
    ],
)
def test_plots(cli: Cli, tmp_path: Path, arguments: tuple[str, ...], name: str, magic: bytes) -> None:
    """--plot writes a figure of that format, and only that; the JSON stays alone on stdout."""
    path = tmp_path / name
    answer = cli(*arguments, "--plot", path, "--json")
    assert answer.code == 0, answer.err
    assert answer.json["schema_version"] == 1
    content = path.read_bytes()
    assert content.startswith(magic)
    assert len(content) > 5000
    assert [p.name for p in tmp_path.iterdir()] == [name]


def test_a_hostile_name_in_a_plot(cli: Cli, tmp_path: Path) -> None:
    """A name with markup of matplotlib is drawn as it is."""
    path = tmp_path / "wing.toml"
    cli("new", "thesis-binary", path)
    name = r"$\\frac{1}{$ <script>alert(1)</script> %s {0}"
    text = path.read_text(encoding="utf-8").replace('name = "thesis-binary"', f'name = "{name}"')
    path.write_text(text, encoding="utf-8")
    answer = cli("flutter", path, *SPEEDS, "--plot", tmp_path / "x.png", "--json")
    assert answer.code == 0, answer.err
    assert answer.json["model"] == name.replace("\\\\", "\\")


def test_file_gives_the_default_sweep(cli: Cli, tmp_path: Path) -> None:
    """speeds_m_s of the file, else 1:350:1; the option beats both; both ends are included."""
    assert cli("flutter", "thesis-binary", "--json").json["speeds_m_s"] == [1.0, 150.0, 0.5]
    path = tmp_path / "wing.toml"
    cli("new", "thesis-binary", path)
    text = "".join(line for line in path.read_text(encoding="utf-8").splitlines(True) if "speeds_m_s" not in line)
    path.write_text(text, encoding="utf-8")
    found = cli("flutter", path, "--json").json
    assert found["speeds_m_s"] == [1.0, 350.0, 1.0]
    assert found["modes"][0]["speed_m_s"][-1] == 350.0
    uneven = cli("flutter", path, "--json", "--speeds", "1:10:4").json
    assert uneven["modes"][0]["speed_m_s"] == [1.0, 5.0, 9.0, 10.0]


def test_vacuum(cli: Cli) -> None:
    """Without air nothing flutters or diverges, and that is an answer."""
    found = cli("flutter", "thesis-binary", "--density", "0", "--json", *SPEEDS).json
    assert found["found"] is False
    assert found["divergence_speed_m_s"] is None


def test_findings_about_the_file_are_warnings(cli: Cli, tmp_path: Path) -> None:
    """What `check` calls a problem, the analyses repeat as a warning."""
    path = tmp_path / "wing.toml"
    cli("new", "thesis-binary", path)
    path.write_text(path.read_text(encoding="utf-8").replace("eccentricity = 0.183", "eccentricity = 0.2"))
    answer = cli("static", path, "--json")
    assert any("eccentricity" in warning for warning in answer.json["warnings"])
    assert "eccentricity" in answer.err


def test_goland_modes(cli: Cli) -> None:
    """Vacuum frequencies of the Goland wing to 1e-4 (goland.json)."""
    found = cli("modes", "goland", "--json").json
    wanted = [48.155425079, 95.719346893, 243.772143610, 347.614830280, 444.191989704]
    assert found["frequencies_rad_s"][:5] == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("ending", [".npz", ".mat"])
def test_own_modes_and_air_forces(cli: Cli, tmp_path: Path, ending: str) -> None:
    """Kind `modal`: the NASA section handed over as bare arrays flutters where the section does, by p-k, k and g."""
    section = build(av.read("nasa-typical-section"), "theodorsen")
    n = section.modes.n
    k = np.linspace(0.0, 1.2, 241)
    arrays: dict[str, Any] = {
        "M": section.modes.M,
        "K": section.modes.K,
        "k": k,
        "mach": np.zeros(1),
        "Q": section.aero(k)[None, :, :, :n],
        "b_m": section.aero.b,
        "mode_names": np.array(section.modes.names),
        "input_names": np.array(section.modes.names),
    }
    if ending == ".npz":
        np.savez(tmp_path / "mine.npz", **arrays)
    else:
        names = np.array(list(section.modes.names), dtype=object)
        savemat(tmp_path / "mine.mat", arrays | {"mode_names": names, "input_names": names})
    path = tmp_path / "mine.toml"
    path.write_text(f'kind = "modal"\n[modal]\ndata = "mine{ending}"\n', encoding="utf-8")
    for method in ("pk", "k", "g"):
        found = cli("flutter", path, "--density", "1.225", "--method", method, "--json", *SPEEDS).json
        assert (found["model"], found["method"], found["aero"]) == ("mine", method, "own")
        assert found["flutter_speed_m_s"] == pytest.approx(52.81036, rel=1e-5)
        assert found["divergence_speed_m_s"] == pytest.approx(107.7630736, rel=1e-6)
    assert cli("modes", path, "--json").json["frequencies_rad_s"] == pytest.approx([48.795, 111.803], rel=1e-4)
    assert cli("check", path, "--json").json["derived"]["mode_names"] == ["plunge", "pitch"]
    refused = cli("flutter", path, "--aero", "jones")
    assert (refused.code, refused.out) == (2, "")
    assert "mine" in refused.err


def test_linearize_a_state_space(cli: Cli, tmp_path: Path) -> None:
    """Kind `state_space` is handed through at the one condition where it holds; what needs an airspeed exits 2."""
    path = tmp_path / "mine.toml"
    path.write_text(
        'kind = "state_space"\n[model]\nA = [[-1, 2], [0, -3]]\nB = [[0], [1]]\nC = [[1, 0]]\nD = [[0]]\n'
        'states = ["a", "b"]\ninputs = ["u"]\noutputs = ["y"]\nspeed_m_s = 55\naltitude_m = 3048\n',
        encoding="utf-8",
    )
    found = cli("linearize", path, "--json").json
    assert found["A"] == [[-1.0, 2.0], [0.0, -3.0]]
    assert found["states"] == ["a", "b"]
    assert found["altitude_m"] == 3048.0
    assert found["density_kg_m3"] == pytest.approx(0.904637, rel=1e-6)
    assert cli("linearize", path, "--speed", "55", "--altitude", "3048", "--json").json == found
    for options in (["--speed", "56"], ["--altitude", "0"], ["--density", "1.2"], ["--aero", "jones"]):
        answer = cli("linearize", path, *options)
        assert (answer.code, answer.out) == (2, "")
        assert "mine" in answer.err
    for command in ("flutter", "static", "modes"):
        answer = cli(command, path)
        assert (answer.code, answer.out) == (2, "")
        assert "state_space" in answer.err
