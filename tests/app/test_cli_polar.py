"""The command `polar`: the contract's JSON, sources, files; and what it refuses."""

from __future__ import annotations

import csv
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aeroservo.aero.polars import section_coefficients
from aeroservo.aero.polars_points import shipped_polar
from aeroservo.studies import section_polar as sources

Cli = Callable[..., Any]

KEYS = {
    "schema_version", "model", "altitude_m", "density_kg_m3", "warnings", "alpha_deg", "reynolds", "deflection_deg",
    "CL", "CD", "CM", "L_over_D", "source",
}  # fmt: skip


def test_json_is_the_contract_s(cli: Cli) -> None:
    """Axes, and tables nested [reynolds][deflection][alpha] that are the shipped table's."""
    answer = cli("polar", "thesis-uav", "--alpha", "0:4:1", "--deflection", "0,5,10", "--reynolds", "1e6,2e6", "--json")
    found = answer.json
    assert set(found) == KEYS
    assert found["alpha_deg"] == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert found["deflection_deg"] == [0.0, 5.0, 10.0]
    assert found["reynolds"] == [1e6, 2e6]
    assert "XFOIL 6.99" in found["source"]
    p = section_coefficients(
        shipped_polar("mh62", "hinged"),
        np.radians(np.arange(5.0)),
        reynolds=np.array([1e6, 2e6])[:, None, None],
        delta=np.radians([0.0, 5.0, 10.0])[:, None],
    )
    for key in ("CL", "CD", "CM"):
        np.testing.assert_allclose(found[key], getattr(p, key), rtol=1e-12)
    np.testing.assert_allclose(found["L_over_D"], p.CL / p.CD, rtol=1e-12)


def test_outside_is_null_and_told(cli: Cli) -> None:
    """Beyond the table there is no number, not an extrapolated one."""
    answer = cli("polar", "thesis-uav", "--alpha", "2,60", "--deflection", "0", "--reynolds", "1e6", "--json")
    assert answer.json["CL"][0][0][1] is None and answer.json["L_over_D"][0][0][1] is None
    assert "1 of 2 points" in answer.json["warnings"][0]


def test_speed_gives_the_reynolds_number_of_the_mean_chord(cli: Cli) -> None:
    """Re = V c/nu of the standard day, lower at altitude."""
    low, high = (
        cli("polar", "thesis-uav", "--speed", "30", "--altitude", h, "--json").json["reynolds"][0] for h in (0, 3000)
    )
    assert low == pytest.approx(30.0 * 0.526667 / 1.4607e-5, rel=1e-4)
    assert 0.7 < high / low < 0.8


def test_morphed_is_another_table(cli: Cli) -> None:
    """More lift for the same trailing-edge drop."""
    options = ("--alpha", "2,3", "--deflection", "0,5", "--reynolds", "1e6", "--json")
    gain = {}
    for kind in ("hinged", "morphed"):
        CL = cli("polar", "thesis-uav", "--kind", kind, *options).json["CL"][0]
        gain[kind] = CL[1][0] - CL[0][0]
    assert 1.2 < gain["morphed"] / gain["hinged"] < 1.4


def test_file_table_and_figure(cli: Cli, tmp_path: Path) -> None:
    """CSV with every point, a PNG file, and the best L/D for people."""
    out, plot = tmp_path / "p.csv", tmp_path / "p.png"
    answer = cli("polar", "thesis-uav", "--out", out, "--plot", plot, "--alpha", "0:8:0.5", "--deflection", "0,5")
    assert answer.code == 0 and "best L/D" in answer.out and "mh62 hinged" in answer.out
    rows = list(csv.DictReader(x for x in out.read_text(encoding="utf-8").splitlines() if x[0] != "#"))
    assert len(rows) == 4 * 2 * 17
    full = next(r for r in rows if r["CL"])
    assert float(full["L_over_D"]) == pytest.approx(float(full["CL"]) / float(full["CD"]), rel=1e-12)
    assert plot.read_bytes().startswith(b"\x89PNG")


XFOIL_FILE = """
       XFOIL         Version 6.99
 Calculated polar for: NACA 0012
 xtrf =   1.000 (top)        1.000 (bottom)
 Mach =   0.000     Re =     {re} e 6     Ncrit =   9.000
   alpha    CL        CD       CDp       CM     Top_Xtr  Bot_Xtr
  ------ -------- --------- --------- -------- -------- --------
   0.000   0.0000   0.00540   0.00050   0.0000   0.68     0.68
   1.000   0.1100   0.00550   0.00050   0.0001   0.65     0.70
   2.000   0.2200   0.00600   0.00050   0.0002   0.60     0.75
"""


def test_xfoil_s_own_files_are_read(cli: Cli, tmp_path: Path) -> None:
    """As they are, each its Reynolds number; two of one number are refused."""
    paths = [tmp_path / "a.txt", tmp_path / "b.txt"]
    for path, re in zip(paths, ("1.000", "2.000")):
        path.write_text(XFOIL_FILE.format(re=re), encoding="utf-8")
    options = ("--polar-file", paths[0], "--polar-file", paths[1])
    found = cli("polar", "thesis-uav", *options, "--alpha", "0:2:1", "--json").json
    assert found["reynolds"] == [1e6, 2e6]
    np.testing.assert_allclose(found["CL"][1][0], [0.0, 0.11, 0.22], atol=1e-9)
    paths[1].write_text(XFOIL_FILE.format(re="1.000"), encoding="utf-8")
    assert cli("polar", "thesis-uav", *options).code == 2
    paths[1].write_text("no polar", encoding="utf-8")
    answer = cli("polar", "thesis-uav", *options)
    assert answer.code == 2 and "b.txt" in answer.err
    assert cli("polar", "thesis-uav", "--polar-file", tmp_path / "absent.txt").code == 2


@pytest.fixture
def bare(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine with neither NeuralFoil nor XFOIL."""
    monkeypatch.setattr(sources, "find_spec", lambda name: None)
    monkeypatch.setattr("aeroservo.aero.polars_neuralfoil.find_spec", lambda name: None)
    monkeypatch.setattr(shutil, "which", lambda name, *a, **k: None)


@pytest.mark.usefixtures("bare")
@pytest.mark.parametrize("source", ["auto", "neuralfoil", "xfoil"])
def test_a_missing_program_says_what_to_install(cli: Cli, source: str) -> None:
    """For an airfoil without a table; the shipped one still works."""
    answer = cli("polar", "thesis-uav", "--airfoil", "naca2412", "--source", source, "--json")
    assert (answer.code, answer.out) == (2, "")
    assert "pip install aeroservo[airfoil]" in answer.err
    assert ("apt-get install xfoil" in answer.err) is (source != "neuralfoil")
    assert cli("polar", "thesis-uav", "--json").code == 0


@pytest.mark.skipif(shutil.which("xfoil") is None, reason="XFOIL is not installed")
def test_xfoil_runs_for_any_other_airfoil(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A symmetric section: no lift and no moment at zero, a slope near 2 pi."""
    monkeypatch.setenv("AEROSERVO_CACHE", str(tmp_path))
    options = ("--airfoil", "naca0012", "--source", "xfoil", "--alpha", "0:2:2", "--deflection", "0")
    found = cli("polar", "thesis-uav", *options, "--reynolds", "1e6", "--json").json
    assert "XFOIL" in found["source"]
    assert found["CL"][0][0][0] == pytest.approx(0.0, abs=0.01)
    assert found["CM"][0][0][0] == pytest.approx(0.0, abs=0.005)
    assert found["CL"][0][0][1] / np.radians(2.0) == pytest.approx(2.0 * np.pi, rel=0.15)


NAN_FOIL = "bad\n1 0\n0.75 0.03\n0.5 nan\n0.25 0.04\n0 0\n0.25 -0.03\n0.5 -0.04\n0.75 -0.03\n1 0\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (NAN_FOIL, ["line 4", "not finite"]),
        ("short\n1 0\n0 0\n1 0\n", ["3 point(s)", "are needed"]),
        ("", ["0 point(s)"]),
    ],
)
def test_bad_airfoil_files(cli: Cli, tmp_path: Path, text: str, words: list[str]) -> None:
    """NaN, three points, nothing: told with the line or the number, before any program runs."""
    path = tmp_path / "bad.dat"
    path.write_text(text, encoding="utf-8")
    answer = cli("polar", "thesis-uav", "--airfoil", path)
    assert (answer.code, answer.out) == (2, "")
    for word in words:
        assert word in answer.err
    model = tmp_path / "mine.toml"
    assert cli("new", "thesis-uav", model).code == 0
    model.write_text(model.read_text(encoding="utf-8").replace('"mh62"', '"bad.dat"'), encoding="utf-8")
    for command in ("polar", "aero"):
        answer = cli(command, model)
        assert (answer.code, answer.out) == (2, "")
        for word in words:
            assert word in answer.err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--reynolds", "1e5"), ["Reynolds number 1e+05", "500000 to 2.5e+06", "--source"]),
        (("--reynolds", "3e6"), ["Reynolds number 3e+06"]),
        (("--reynolds", "-1"), ["--reynolds"]),
        (("--reynolds", "1e6", "--speed", "30"), ["not both"]),
        (("--deflection", "-20"), ["-10 to 15 deg", "--source"]),
        (("--airfoil", "mh63"), ["mh63", "mh62"]),
        (("--airfoil", "naca2412", "--source", "table"), ["no shipped table", "--source"]),
        (("--surface", "tail"), ["--surface", "wing"]),
        (("--alpha", "50,60"), ["no point", "--alpha"]),
        (("--out", "p.xlsx"), ["--out", ".csv"]),
        (("--plot", "p.svg"), ["--plot", ".png"]),
        (("--speed", "0"), ["airspeed"]),
    ],
)
def test_bad_options(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], words: list[str]
) -> None:
    """Code 2, nothing on stdout, nothing written."""
    monkeypatch.chdir(tmp_path)
    answer = cli("polar", "thesis-uav", *options, "--json")
    assert (answer.code, answer.out) == (2, "")
    for word in words:
        assert word in answer.err
    assert list(tmp_path.iterdir()) == []
