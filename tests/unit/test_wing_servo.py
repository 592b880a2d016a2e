"""Actuators and sensors of model files on wings: what a sensor measures is what the shapes say at its place."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

import aeroservo as av
from aeroservo.aeroelastic.build_beam import BEAM_MODES, slender_beam
from aeroservo.aircraft.file_errors import ModelFileError
from aeroservo.structure.beam import beam_modes

CASES = Path(av.__file__).parent / "aircraft" / "presets"

SERVO = """
[actuator]
omega_rad_s = 60.0
zeta = 0.7
limit_deg = 20.0

[[sensor]]
name = "gyro"
kind = "gyro"
y_m = 1.0

[[sensor]]
name = "tip_accelerometer"
kind = "accelerometer"
y_m = {tip}
x_m = 0.3
"""


def written(tmp_path: Path, preset: str, more: str, old: str = "", new: str = "") -> Path:
    """A preset with more tables."""
    text = (CASES / f"{preset}.toml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "model.toml"
    path.write_text(text.replace(old, new, 1) + more, encoding="utf-8")
    tomllib.loads(path.read_text(encoding="utf-8"))
    return path


ELEVON = "\n[wing.elevon]\nfrom_y_m = 3.0\nto_y_m = 6.0\nlift_per_rad = 3.0\nmoment_per_rad = -0.5\n"


def test_sensors_of_a_beam_measure_the_motion_of_its_points(tmp_path: Path) -> None:
    model = av.build(av.read(written(tmp_path, "goland", ELEVON + SERVO.format(tip=6.096))), "quasi_steady_damped")
    shapes = beam_modes(
        slender_beam(av.read("goland")),  # type: ignore[arg-type]
        n=BEAM_MODES,
        points=[1.0, 6.096],
    )
    gyro, tip = model.sensors
    np.testing.assert_allclose(gyro.rate, shapes.twist[0], rtol=1e-9, atol=1e-12)  # unswept: twist is pitch
    np.testing.assert_allclose(tip.acceleration, shapes.h[1] + 0.3 * shapes.twist[1], rtol=1e-9, atol=1e-12)
    assert [a.control for a in model.actuators] == ["elevon"] and model.actuators[0].limit == pytest.approx(0.34906585)
    system = av.linear_system(model, av.FlightCondition.at(0.0, V=50.0))
    assert system.inputs[0] == "elevon_command_rad"
    assert {"gyro_rad_s", "tip_accelerometer_m_s2", "elevon_rad"} <= set(system.outputs)


def test_the_accelerometer_of_a_linear_system_is_the_second_derivative_of_its_point(tmp_path: Path) -> None:
    """s^2 times the transfer function to the point's motion, from the matrices without any sensor."""
    path = written(tmp_path, "goland", ELEVON + SERVO.format(tip=6.096))
    model = av.build(av.read(path), "quasi_steady_damped")
    system = av.linear_system(model, av.FlightCondition.at(0.0, V=50.0))
    s = 37.0j
    x = np.linalg.solve(s * np.eye(len(system.A)) - system.A, system.B[:, 0])
    measured = system.C[system.outputs.index("tip_accelerometer_m_s2")] @ x
    measured += system.D[system.outputs.index("tip_accelerometer_m_s2"), 0]
    point = np.array(model.sensors[1].acceleration)
    assert measured == pytest.approx(s**2 * (point @ x[: model.modes.n]), rel=1e-9)


def test_a_binary_wing_measures_what_its_assumed_shapes_say(tmp_path: Path) -> None:
    """h = (y/s)^2 q_b + d (y/s) q_t at d aft of the axis [7.27]."""
    model = av.build(av.read(written(tmp_path, "thesis-binary", SERVO.format(tip=2.0))))
    gyro, tip = model.sensors
    np.testing.assert_allclose(gyro.rate, [0.0, 0.5], atol=1e-14)
    np.testing.assert_allclose(tip.acceleration, [1.0, 0.3], atol=1e-14)


def test_an_aircraft_places_sensors_in_its_own_axes_and_moves_its_controls(tmp_path: Path) -> None:
    more = """
[[actuator]]
control = "elevon"
omega_rad_s = 60.0
zeta = 0.7

[[sensor]]
name = "on_axis"
kind = "plunge"
y_m = 0.8

[[sensor]]
name = "behind"
kind = "plunge"
y_m = 0.8
x_m = 0.9

[[sensor]]
name = "turn"
kind = "angle"
y_m = 0.8
"""
    model = av.build(av.read(written(tmp_path, "thesis-uav", more)), "quasi_steady_damped")
    assert [a.control for a in model.actuators] == ["elevon_antisymmetric", "elevon"]
    on, behind, turn = (np.array(s.displacement) for s in model.sensors)
    axis = 0.8 * 0.524475 + 0.433 * (0.7 - 0.4 * 0.8)  # leading edge and chord at y = 0.8 m
    np.testing.assert_allclose(behind - on, (0.9 - axis) * turn, rtol=1e-9, atol=1e-12)
    assert np.abs(turn).max() > 0.0


def test_modal_files_read_their_own_grid(tmp_path: Path) -> None:
    phi = np.zeros((2, 6, 1))
    phi[1, 2], phi[1, 4] = -1.0, 0.25
    np.savez(
        tmp_path / "m.npz", M=[[1.0]], D=[[0.0]], K=[[4.0]], phi=phi, grid=[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        k=[0.0, 1.0], mach=[0.0], Q=np.zeros((1, 2, 1, 2), complex), b_m=1.0, mode_names=["h"],
        input_names=["h", "flap"],
    )  # fmt: skip
    text = 'schema_version = 1\nkind = "modal"\nname = "mine"\n[modal]\ndata = "m.npz"\n'
    sensor = '[[sensor]]\nname = "gyro"\nkind = "gyro"\ngrid_point = {}\n'
    path = tmp_path / "m.toml"
    path.write_text(text + '[[actuator]]\ncontrol = "flap"\nomega_rad_s = 60.0\nzeta = 0.7\n' + sensor.format(1))
    model = av.build(av.read(path))
    assert model.sensors[0].rate == (0.25,) and model.actuators[0].control == "flap"
    path.write_text(text + sensor.format(2))
    with pytest.raises(ValueError, match="grid_point must be below 2"):
        av.build(av.read(path))
    path.write_text(text + '[[actuator]]\ncontrol = "slat"\nomega_rad_s = 60.0\n')
    with pytest.raises(ValueError, match="no input of the data is called 'slat'"):
        av.build(av.read(path))


@pytest.mark.parametrize(
    ("preset", "more", "message"),
    [
        ("goland", SERVO.format(tip=6.0), "there is no .wing.elevon."),
        ("goland", ELEVON + SERVO.format(tip=7.0), "sensor.1..y_m must lie on the wing, from 0 to 6.096"),
        ("thesis-binary", SERVO.format(tip=2.5), "sensor.1..y_m must lie on the wing, from 0 to 2"),
        ("thesis-binary", SERVO.format(tip=2.0).replace("tip_accelerometer", "gyro"), "sensor names must differ"),
        ("thesis-uav", '[[actuator]]\ncontrol = "rudder"\nomega_rad_s = 60.0\n', "control must be one of"),
        ("thesis-uav", '[[sensor]]\nname = "a"\nkind = "gyro"\ny_m = 2.0\n', "sensor.0..y_m must lie on the wing"),
    ],
)
def test_bad_tables_are_refused(tmp_path: Path, preset: str, more: str, message: str) -> None:
    with pytest.raises(ModelFileError, match=message):
        av.read(written(tmp_path, preset, more))
