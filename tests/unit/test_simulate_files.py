"""Histories to and from files, controller files, identification, profiles, words of disturbances."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from aeroservo.control.controller import controller_of, read_controller
from aeroservo.datatypes import LinearSystem
from aeroservo.simulate.disturbances import CosineGust, Gustiness, SharpGust, parse_gust
from aeroservo.simulate.history import Event, TimeHistory, even, read_history, unit_of, write_history
from aeroservo.simulate.identify import envelope_growth, era, limit_cycle, log_decrement, pencil_growth
from aeroservo.simulate.profiles import Profile, climb, level


def history() -> TimeHistory:
    """Two channels and an event."""
    t = np.linspace(0.0, 2.0, 41)
    return TimeHistory(
        t=t,
        data=np.stack([np.sin(t), np.exp(-t)], axis=1),
        channels=("pitch_rad", "acceleration_m_s2"),
        events=(Event(t=1.5, text="pitch_rad left its limit"),),
    )


@pytest.mark.parametrize("ending", [".nc", ".csv"])
def test_round_trip(tmp_path: Path, ending: str) -> None:
    """NetCDF and CSV give back every bit; NetCDF also units and events."""
    file = tmp_path / f"run{ending}"
    write_history(file, history())
    back = read_history(file)
    np.testing.assert_array_equal(back.t, history().t)
    np.testing.assert_array_equal(back.data, history().data)
    assert (back.channels, back.units) == (("pitch_rad", "acceleration_m_s2"), ("rad", "m/s^2"))
    assert ending == ".csv" or (back.events[0].t, back.events[0].text) == (1.5, "pitch_rad left its limit")


def test_mat_and_netcdf_for_others(tmp_path: Path) -> None:
    """Names, values and units as MATLAB and a NetCDF reader see them."""
    from scipy.io import netcdf_file

    for ending in (".mat", ".nc"):
        write_history(tmp_path / f"run{ending}", history())
    found = loadmat(tmp_path / "run.mat")
    np.testing.assert_array_equal(found["pitch_rad"][:, 0], history()["pitch_rad"])
    np.testing.assert_array_equal(found["time_s"][:, 0], history().t)
    with netcdf_file(str(tmp_path / "run.nc"), mmap=False) as nc:
        assert nc.variables["acceleration_m_s2"].units == b"m/s^2"
        assert nc.variables["time"].units == b"s"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time_s,a\n0,1\n1,x\n", "line 3"),
        ("time_s,a\n0,1\n1\n", "line 3"),
        ("time_s,a\n0,1\n1,nan\n", "finite"),
        ("time_s,a\n1,1\n0,2\n", "ascend"),
        ("time_s,a,a\n0,1,1\n1,2,2\n", "differ"),
        ("time_s\n", "rows"),
    ],
)
def test_bad_csv_names_the_line(tmp_path: Path, text: str, message: str) -> None:
    """A record of a test that cannot be read says where."""
    file = tmp_path / "test.csv"
    file.write_text(text)
    with pytest.raises(ValueError, match=message) as caught:
        read_history(file)
    assert "test.csv" in str(caught.value)


def test_history_knows_its_channels() -> None:
    """Units by suffix; unknown names are refused; uneven times are put on an even grid."""
    assert [unit_of(n) for n in ("gyro_rad_s", "x_m", "bending_1", "a_m_s2")] == ["rad/s", "m", "", "m/s^2"]
    with pytest.raises(ValueError, match="no channel 'roll_rad'"):
        history()["roll_rad"]
    t = np.array([0.0, 1.0, 2.5, 3.0])
    y, dt = even(TimeHistory(t=t, data=(2.0 * t)[:, None], channels=("x_m",)), "x_m")
    np.testing.assert_allclose(y, 2.0 * dt * np.arange(4))


def test_log_decrement_and_era_find_what_was_put_in() -> None:
    """One mode, both signs of damping; two close modes, from the file of a record."""
    t = np.linspace(0.0, 8.0, 8001)
    for sigma, omega in ((-0.4, 26.3), (0.25, 26.3), (-1e-4, 10.0)):
        found = log_decrement(t, np.exp(sigma * t) * np.cos(omega * t + 0.3))
        assert found.growth == pytest.approx(sigma, abs=2e-5)
        assert found.frequency == pytest.approx(omega, rel=1e-5)
        assert found.damping_ratio == pytest.approx(-sigma / np.hypot(sigma, omega), abs=1e-5)
        assert envelope_growth(t, np.exp(sigma * t) * np.cos(omega * t)) == pytest.approx(sigma, abs=1e-4)
    t = 0.02 * np.arange(600)
    y = np.exp(-0.5 * t) * np.cos(20.0 * t) + 0.4 * np.exp(-0.2 * t) * np.sin(25.0 * t)
    modes = sorted(era(y, 0.02, order=4), key=lambda mode: mode.frequency)
    assert [m.frequency for m in modes] == pytest.approx([20.0, 25.0], rel=1e-9)
    assert [m.growth for m in modes] == pytest.approx([-0.5, -0.2], rel=1e-7)
    assert modes[0].share > modes[1].share


def test_growth_is_not_misled_by_beats() -> None:
    """Two modes that beat, both decaying, in a record of half a beat: the envelope grows, the pencil does not."""
    t = np.linspace(0.0, 5.0, 2001)
    y = np.exp(-0.05 * t) * (np.sin(20.0 * t) - np.sin(20.6 * t))
    envelope, pencil = envelope_growth(t, y), pencil_growth(t, y)
    assert envelope is not None and envelope > 0.05
    assert pencil == pytest.approx(-0.05, abs=1e-6)
    assert pencil_growth(t, np.random.default_rng(1).standard_normal(2001)) is None
    assert pencil_growth(t, np.exp(0.4 * t) - 5.0 * np.exp(-3.0 * t)) == pytest.approx(0.4, rel=1e-6)


def test_era_stands_noise() -> None:
    """1 % noise on a record: frequency to 0.1 %, damping ratio to 0.002."""
    t = 0.02 * np.arange(800)
    noise = 0.01 * np.random.default_rng(3).standard_normal(800)
    mode = era(np.exp(-0.3 * t) * np.cos(26.0 * t) + noise, 0.02, order=6)[0]
    assert mode.frequency == pytest.approx(26.0, rel=1e-3)
    assert mode.damping_ratio == pytest.approx(0.3 / 26.0, abs=0.002)


def test_limit_cycle_is_not_seen_where_there_is_none() -> None:
    """A steady square-like wave has one; a decay, a growth, a rest have none."""
    t = np.linspace(0.0, 60.0, 12001)
    found = limit_cycle(t, np.sin(5.0 * t) + np.sin(15.0 * t) / 3.0 + 0.2)
    assert found is not None
    assert found.fundamental == pytest.approx(1.0, rel=1e-3)
    assert found.frequency_Hz == pytest.approx(5.0 / (2.0 * np.pi), rel=1e-4)
    for y in (np.exp(-0.01 * t) * np.sin(5.0 * t), np.exp(0.01 * t) * np.sin(5.0 * t), 0.0 * t, t):
        assert limit_cycle(t, y) is None


def test_controller_file(tmp_path: Path) -> None:
    """A gain, a schedule held beyond its ends, and a LinearSystem are one thing."""
    file = tmp_path / "c.json"
    gain = {"A": [], "B": [], "C": [], "D": [[-1.0, 2.0]], "dt_s": 0.005, "delay_s": 0.001}
    names = {"inputs": ["pitch_rad", "gyro"], "outputs": ["elevon_command_rad"]}
    file.write_text(json.dumps(gain | names | {"limits": {"elevon_command_rad": 0.3}}))
    c = read_controller(file)
    assert (c.D.tolist(), c.dt_s, c.delay_s, c.limits, c.A.shape) == ([[[-1.0, 2.0]]], 0.005, 0.001, (0.3,), (1, 0, 0))
    points = [{"dynamic_pressure_Pa": q, "D": [[q, 0.0]]} for q in (100.0, 300.0, 900.0)]
    file.write_text(json.dumps(names | {"dt_s": 0.01, "points": points, "interpolation": "linear"}))
    s = read_controller(file)
    weights = s.blend(np.array([50.0, 200.0, 300.0, 600.0, 2000.0]))
    left, f = weights[:, 0].astype(int), weights[:, 1]
    D = s.D[:, 0, 0]
    np.testing.assert_allclose(
        (1.0 - f) * D[left] + f * D[np.minimum(left + 1, 2)], [100.0, 200.0, 300.0, 600.0, 900.0]
    )
    system = LinearSystem(
        A=[[0.5]], B=[[1.0]], C=[[2.0]], D=[[0.0]], states=("x",), inputs=("gyro",), outputs=("elevon_rad",), dt=0.01
    )
    assert controller_of(system).dt_s == 0.01 and controller_of(system).continuous is None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"D": [[1.0]]}, "D must be 1 x 2"),
        ({"D": [[1.0, "x"]]}, "D must be rows"),
        ({"dt_s": -1.0}, "dt_s"),
        ({"dt_s": None, "delay_s": 0.1}, "continuous"),
        ({"inputs": []}, "inputs"),
        ({"inputs": ["a", "a"]}, "differ"),
        ({"limits": {"rudder": 1.0}}, "limits"),
        ({"schema_version": 9}, "schema_version"),
        ({"delay": 0.005}, "'delay' is no field of a controller file; fields: .*delay_s"),
        ({"points": [{"dynamic_pressure_Pa": 1.0, "D": [[1, 2]]}], "D": [[1, 2]]}, "'D' is no field"),
        ({"points": [{"dynamic_pressure_Pa": 1.0, "D": [[1, 2]], "dt_s": 1.0}]}, "'dt_s' is no field in a point"),
        (
            {"points": [{"dynamic_pressure_Pa": 2.0, "D": [[1, 2]]}, {"dynamic_pressure_Pa": 1.0, "D": [[1, 2]]}]},
            "ascend",
        ),
    ],
)
def test_bad_controller_files(tmp_path: Path, change: dict[str, object], message: str) -> None:
    """Field and rule are named, and the file."""
    law = {} if "points" in change else {"D": [[1.0, 2.0]]}
    good = law | {"inputs": ["a", "b"], "outputs": ["elevon_rad"], "dt_s": 0.01}
    file = tmp_path / "bad.json"
    file.write_text(json.dumps(good | change))
    with pytest.raises(ValueError, match=message) as caught:
        read_controller(file)
    assert "bad.json" in str(caught.value)


def test_controller_files_that_are_none(tmp_path: Path) -> None:
    """Not there, not JSON, NaN, not an object."""
    with pytest.raises(ValueError, match="cannot be read"):
        read_controller(tmp_path / "none.json")
    file = tmp_path / "x.json"
    for text, message in (("{", "not valid JSON"), ("[]", "one JSON object"), ('{"dt_s": NaN}', "x.json: NaN")):
        file.write_text(text)
        with pytest.raises(ValueError, match=message):
            read_controller(file)


def test_profiles() -> None:
    """The climb's ends; distance of a ramp; refusals."""
    c = climb()
    assert c.duration == 115.0 and c.moving
    end = c.condition(115.0)
    assert float(end.V) == 130.0 and float(end.rho) == pytest.approx(0.904637, rel=1e-6)
    t = np.linspace(0.0, 120.0, 100_001)
    numeric = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(t) * (c.speed(t[1:]) + c.speed(t[:-1])))])
    np.testing.assert_allclose(c.distance(t), numeric, rtol=1e-9, atol=1e-6)
    assert not level(50.0).moving and float(level(50.0, density=1.0).condition(3.0).rho) == 1.0
    for bad in ({"t": [1.0], "V": [2.0]}, {"t": [0.0, 0.0], "V": [1.0, 2.0]}, {"t": [0.0], "V": [-1.0]}):
        with pytest.raises(ValueError):
            Profile(**bad, altitude=[0.0] * len(bad["t"]))  # type: ignore[arg-type]


def test_words_of_gusts() -> None:
    """What `--gust` takes and refuses."""
    assert parse_gust("sharp:2.5@1") == SharpGust(amplitude=2.5, start=1.0)
    assert parse_gust("cosine:5:30@0.5") == CosineGust(amplitude=5.0, length=30.0, start=0.5)
    for bad in ("sharp:2.5", "cosine:5@1", "ramp:1@2", "sharp:x@1", "cosine:1:-3@1", "sharp:nan@1", "sharp:1@-2", ""):
        with pytest.raises(ValueError):
            parse_gust(bad)
    with pytest.raises(ValueError, match="turbulence"):
        Gustiness(level="heavy")  # type: ignore[arg-type]


def test_to_xarray() -> None:
    """Channels as variables over time, with units and events; where xarray is not installed it says what to install."""
    try:
        import xarray  # noqa: F401
    except ImportError:
        with pytest.raises(ImportError, match="pip install xarray"):
            history().to_xarray()
        pytest.skip("xarray is not installed (extra)")
    found = history().to_xarray()
    np.testing.assert_array_equal(found["pitch_rad"].values, history()["pitch_rad"])
    np.testing.assert_array_equal(found.coords["time"].values, history().t)
    assert found["acceleration_m_s2"].attrs["units"] == "m/s^2"
