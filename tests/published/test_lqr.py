"""Linear-quadratic regulators of textbooks, of the thesis, of its simulation model and of the BACT wing.

Numbers of the textbooks and of the thesis' appendix: `lqr.json` of the project's validation set (MATLAB's `lqr`
documentation for the pendulum on a cart; the Control Tutorials for MATLAB and Simulink, "Aircraft Pitch", for the two
aircraft gains; Bramstång 2015, appendix, for the linear model, its K and the printed A - B K). Numbers of the
simulation model: issue 7 of this project.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from aeroservo.aeroelastic.build import build
from aeroservo.aircraft.files import read
from aeroservo.control.closed_loop import closed_loop
from aeroservo.control.design import Design, controls, with_state_outputs
from aeroservo.control.disk_margins import disk_margin, margin_curve
from aeroservo.control.lqg import GYRO_ACCELEROMETER, GYRO_RECOVERY, LQG
from aeroservo.control.lqr import FULL_STATE, LQR, lqr_gain
from aeroservo.control.plant import design_plant
from aeroservo.datatypes import AeroelasticModel, FlightCondition, LinearSystem
from aeroservo.servo import Actuator, Sensor

PRINTED = 1e-9
"""The textbook gains are given to sixteen digits; two solvers agree to this."""

THESIS_K = 2e-4
"""The thesis prints A and K to four or five digits: rounding of A alone moves K by 1.6e-4."""

#: name: A, B, Q, K; R = 1 (lqr.json, "inputs" and "textbook").
TEXTBOOK = {
    "double integrator": ([[0, 1], [0, 0]], [0, 1], np.eye(2), [0.9999999999999992, 1.7320508075688774]),
    "pendulum on a cart": (
        [[0, 1, 0, 0], [0, -0.1, 3, 0], [0, 0, 0, 1], [0, -0.5, 30, 0]],
        [0, 2, 0, 5],
        np.diag([1.0, 0.0, 1.0, 0.0]),
        [-1.000000000000006, -1.7558592618524105, 16.914490065716276, 3.227358768653237],
    ),
    "aircraft pitch, p = 2": (
        [[-0.313, 56.7, 0], [-0.0139, -0.426, 0], [0, 56.7, 0]],
        [0.232, 0.0203, 0],
        np.diag([0.0, 0.0, 2.0]),
        [-0.5033512433651298, 52.864511513345526, 1.414213562373083],
    ),
    "aircraft pitch, p = 50": (
        [[-0.313, 56.7, 0], [-0.0139, -0.426, 0], [0, 56.7, 0]],
        [0.232, 0.0203, 0],
        np.diag([0.0, 0.0, 50.0]),
        [-0.6434566566242317, 169.6950186339677, 7.071067811865473],
    ),
}

#: Gains that the thesis prints, and the roots of A, of A - B K and of the plant without its pitch-lag loop (lqr.json).
K_PRINTED = [8.6714, 3.4228, 18.166, 0.1854, 2.5293]
OPEN = [0.337903 + 2.08286j, -4.8058, -14.532153 + 4.874948j]
CLOSED = [-0.618152 + 1.940473j, -5.111378, -14.663522 + 4.862892j]
BARE = [0.442946, -3.527207, -14.555019 + 4.891338j]
#: A - B K as the thesis prints it, fourth and fifth rows.
ENHANCED = [
    [70.7138, -217.7978, -616.9943, -27.5706, -34.5308],
    [14.7525, 8.0503, 16.9407, 0.1127, -7.1042],
]

HIGH = 3048.0  # 10,000 ft
BACT_RHO = 1.01628
BACT_LIMIT = math.sqrt(2.0 * 200.0 * 47.88025898 / BACT_RHO)  # 200 psf


@pytest.mark.parametrize("name", TEXTBOOK)
def test_textbook_gains(name: str) -> None:
    """To the printed digits."""
    A, B, Q, K = TEXTBOOK[name]
    found, _ = lqr_gain(A, np.array(B, float)[:, None], Q, np.eye(1))
    np.testing.assert_allclose(found[0], K, rtol=PRINTED)


def appendix() -> LinearSystem:
    """The thesis' linear model, all of whose states are measured."""
    m = read("thesis-appendix").model
    return with_state_outputs(
        LinearSystem(A=m.A, B=m.B, C=m.C, D=m.D, states=m.states, inputs=m.inputs, outputs=m.outputs)
    )


def upper(values: np.ndarray) -> list[complex]:
    """One of each pair, the largest real part first."""
    kept = [complex(v) for v in values if v.imag > -1e-9]
    return sorted(kept, key=lambda v: -v.real)


def test_gain_of_the_thesis() -> None:
    """K of Q = I and R = 1 is the thesis' to 2e-4; A - B K of the printed K is the printed one, roots and all."""
    plant = appendix()
    design = LQR(Q=np.ones(5), R=np.ones(1))(plant)
    np.testing.assert_allclose(design.K[0], K_PRINTED, rtol=THESIS_K)
    assert design.residual < 1e-12
    enhanced = plant.A - plant.B @ np.array([K_PRINTED])
    # half a unit of the last printed digit of K, of B, of A and of A - B K
    rounding = np.abs(plant.B) @ np.array([[5e-5, 5e-5, 5e-4, 5e-5, 5e-5]]) + 5e-5 * np.abs(K_PRINTED) + 1e-4
    assert np.all(np.abs(enhanced[3:] - ENHANCED) <= rounding[3:])
    for A, wanted in ((plant.A, OPEN), (enhanced, CLOSED)):
        np.testing.assert_allclose(upper(np.linalg.eigvals(A)), wanted, atol=2e-6)
    bare = plant.A[1:, 1:]
    np.testing.assert_allclose(upper(np.linalg.eigvals(bare)), BARE, atol=2e-6)


def test_thesis_settles_in_six_to_seven_seconds() -> None:
    """2 % settling of the slowest pair: 4/0.618; and of the response itself from a pitch angle, by the exponential."""
    from scipy.linalg import expm

    plant = appendix()
    design = LQR(Q=np.ones(5), R=np.ones(1))(plant)
    assert 6.0 < 4.0 / -design.closed_loop_eigenvalues.real.max() < 7.0
    step = expm(0.01 * (plant.A - plant.B @ design.K))
    x, pitch = np.array([0.0, 0.0, 1.0, 0.0, 0.0]), []
    for _ in range(1500):
        pitch.append(x[2])
        x = step @ x
    left = np.flatnonzero(np.abs(pitch) > 0.02 * np.max(np.abs(pitch)))[-1] * 0.01
    assert 5.0 < left < 7.0


@pytest.mark.parametrize("which", ["appendix", "simulation model"])
def test_return_difference_of_a_continuous_regulator(which: str) -> None:
    """|1 + L(iw)| >= 1 at every frequency: gain margin without bound, 60 degrees of phase (Kalman's inequality)."""
    plant = appendix() if which == "appendix" else at(55.0)
    design = LQR(Q=np.ones(len(plant.states)), R=np.ones(1))(plant)
    omega = np.logspace(-3, 4, 4000)
    n = len(plant.states)
    L = design.K @ np.linalg.solve(1j * omega[:, None, None] * np.eye(n) - plant.A, plant.B.astype(complex))
    assert np.abs(1.0 + L[:, 0, 0]).min() >= 1.0 - 1e-9
    assert np.abs(1.0 + L[:, 0, 0]).max() > 1.2  # and it is not one everywhere


def at(V: float, altitude: float = HIGH, actuator: Actuator | None = None) -> LinearSystem:
    """The simulation model at a speed, with an actuator or none."""
    model = build(read("thesis-simulation"))
    model = replace(model, actuators=() if actuator is None else (actuator,))
    return controls(design_plant(model, FlightCondition.at(altitude, V=V)))


SERVO = Actuator(control="elevon", omega=60.0, zeta=0.7)


def lost(design: Design, altitude: float, low: float, high: float) -> float:
    """Speed at which a fixed gain loses the model."""

    def growth(V: float) -> float:
        return float(np.linalg.eigvals(closed_loop(at(V, altitude), design.controller).A).real.max())

    return float(brentq(growth, low, high, xtol=1e-6))


def test_regulator_of_the_simulation_model() -> None:
    """55 m/s, 10,000 ft, no actuator; lost at 58.618 m/s through a real root (the thesis' hard flutter at 59)."""
    design = LQR(Q=np.ones(4), R=np.ones(1))(at(55.0))
    np.testing.assert_allclose(design.K[0], [-6.783, -1.690, -0.573, -0.916], atol=1e-3)
    V = lost(design, HIGH, 57.0, 60.0)
    assert V == pytest.approx(58.618, abs=0.01)
    values = np.linalg.eigvals(closed_loop(at(V), design.controller).A)
    worst = values[np.argmax(values.real)]
    assert abs(worst.imag) == 0.0 and abs(worst.real) < 1e-4
    # the same gain at sea level; the thesis' 66 m/s is not reproducible
    assert lost(design, 0.0, 48.0, 53.0) == pytest.approx(50.374, abs=0.01)
    # the same dynamic pressure: what is lost is static
    ratio = FlightCondition.at(HIGH, V=1.0).rho / FlightCondition.at(0.0, V=1.0).rho
    assert V * math.sqrt(float(ratio)) == pytest.approx(lost(design, 0.0, 48.0, 53.0), abs=2e-3)


def test_an_actuator_undoes_the_regulator_at_its_own_design_point() -> None:
    """The gain designed without actuator, behind one of 60 rad/s: +10.3 +- 74.5i."""
    design = LQR(Q=np.ones(4), R=np.ones(1))(at(55.0))
    controller = replace(design.controller, outputs=("elevon_command_rad",))
    values = np.linalg.eigvals(closed_loop(at(55.0, actuator=SERVO), controller).A)
    worst = max(values, key=lambda v: v.real)
    assert worst.real == pytest.approx(10.3, abs=0.05) and abs(worst.imag) == pytest.approx(74.5, abs=0.05)
    # designed with the actuator inside it is stable, and so is the plain gain behind a fast one
    inside = LQR(Q=np.ones(4), R=np.ones(1))(at(55.0, actuator=SERVO))
    assert inside.closed_loop_eigenvalues.real.max() < -1.0
    fast = at(55.0, actuator=replace(SERVO, omega=600.0))
    assert np.linalg.eigvals(closed_loop(fast, controller).A).real.max() < -1.0


def flying() -> AeroelasticModel:
    """The simulation model with the issue's actuator, a gyro and an accelerometer at the pitch axis."""
    gyro = Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0))
    accelerometer = Sensor(name="acc", unit="m_s2", acceleration=(1.0, 0.0))
    return replace(build(read("thesis-simulation")), actuators=(SERVO,), sensors=(gyro, accelerometer))


#: alpha at 50, 60, 80, 100, 120 m/s: what the issue asks to reach or beat, and what these designs have (to 0.5 %).
ROWS = {
    "full state": (FULL_STATE, None, 1, [1.18, 1.00, 0.78, 0.66, 0.575], [1.280, 1.075, 0.884, 0.762, 0.667]),
    "gyro and accelerometer": (
        GYRO_ACCELEROMETER, ("gyro", "acc"), 1, [0.5, 0.35, 0.19, 0.14, 0.11], [0.577, 0.468, 0.348, 0.282, 0.216],
    ),
    "gyro, recovery": (
        GYRO_RECOVERY, ("gyro",), 1, [1.37, 1.05, 0.86, 0.73, 0.61], [1.388, 1.099, 0.908, 0.783, 0.660],
    ),
    "gyro, recovery, four samples": (
        GYRO_RECOVERY, ("gyro",), 4, [1.08, 0.83, 0.55, 0.40, 0.30], [1.173, 0.934, 0.677, 0.518, 0.406],
    ),
}  # fmt: skip


@pytest.mark.parametrize("row", ROWS)
def test_disk_margins_of_the_schedule(row: str) -> None:
    """60 rad/s actuator, 200 Hz, delay: stable from 15 to 130 m/s, margins at least those of the issue."""
    options, sensors, delay, asked, measured = ROWS[row]
    V = np.array([15.0, 30.0, 50.0, 60.0, 80.0, 100.0, 120.0, 130.0])
    plant = design_plant(
        flying(), FlightCondition.at(HIGH, V=V), rate_Hz=200.0, delay_samples=delay, sensors=sensors, gusts=True
    )
    plant = with_state_outputs(plant) if sensors is None else plant
    design = options(plant)
    assert np.all(np.abs(design.closed_loop_eigenvalues) < 1.0)
    assert design.residual.max() < 1e-9
    seen = controls(plant)
    alpha = [disk_margin(seen[i], design.controller[i]).alpha for i in range(len(V))]
    assert np.all(np.array(alpha[2:7]) >= asked)
    np.testing.assert_allclose(alpha[2:7], measured, rtol=5e-3)
    if row == "gyro, recovery":
        assert alpha[6] >= 0.55 and min(alpha[:5]) >= 0.83  # 6 dB and 45 degrees to 80 m/s


def test_margin_against_delay() -> None:
    """Delay on top of the designed one costs margin, steadily, until the loop is lost; a fixed design, 60 m/s."""
    plant = design_plant(
        flying(), FlightCondition.at(HIGH, V=60.0), rate_Hz=200.0, delay_samples=1, sensors=("gyro",), gusts=True
    )
    design = GYRO_RECOVERY(plant)
    delays = tuple(0.005 * samples for samples in range(1, 7))
    condition = FlightCondition.at(HIGH, V=[60.0])
    alpha = margin_curve(flying(), condition, design.as_controller(delay_s=0.005), delays_s=delays).alpha[0]
    print("alpha at 60 m/s against a delay of 5 to 30 ms, designed for 5 ms:", np.round(alpha, 3))
    assert alpha[0] == pytest.approx(1.099, rel=5e-3)
    assert np.all(np.diff(alpha) < 0.0) and alpha[3] > 0.2
    late = design_plant(flying(), condition[0], rate_Hz=200.0, delay_samples=3, sensors=("gyro",))
    assert alpha[2] == pytest.approx(disk_margin(late, design.controller).alpha, rel=1e-6)


def bact() -> AeroelasticModel:
    """The BACT wing with a gyro beside its accelerometers."""
    model = build(read("bact"))
    gyro = Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0))
    return replace(model, sensors=(*model.sensors, gyro))


WEIGHTS = {"Q": [0.0, 1.0 / math.radians(2.0) ** 2, 0.0, 1.0 / math.radians(60.0) ** 2], "R": FULL_STATE.R}


@pytest.mark.parametrize("kind", ["full state", "gyro and accelerometer"])
def test_bact_to_200_psf(kind: str) -> None:
    """Controllers for the trailing-edge actuator hold the wing from far below its flutter at 118.5 m/s to 137.28."""
    assert BACT_LIMIT == pytest.approx(137.28, abs=0.01)
    V = np.array([60.0, 100.0, 115.0, 120.0, 125.0, 130.0, BACT_LIMIT])
    condition = FlightCondition(V=V, rho=BACT_RHO)
    if kind == "full state":
        plant = controls(design_plant(bact(), condition, rate_Hz=200.0, delay_samples=1))
        options: LQR | LQG = LQR(**WEIGHTS)
    else:
        plant = design_plant(
            bact(), condition, rate_Hz=200.0, delay_samples=1, sensors=("gyro", "acc_te"), gusts=True
        )  # fmt: skip
        options = LQG(**WEIGHTS, gust=0.1, recovery=math.radians(10.0))
    design = options(plant)
    seen = controls(plant)
    alpha = np.array([disk_margin(seen[i], design.controller[i]).alpha for i in range(len(V))])
    print(f"BACT, {kind}: alpha at {np.round(V, 1)} m/s: {np.round(alpha, 3)}")
    assert np.linalg.eigvals(design_plant(bact(), condition).A[-1]).real.max() > 0.8  # open loop: flutter
    assert np.all(alpha > 0.5)
    # one fixed controller, of 130 m/s, over all speeds
    fixed = [disk_margin(seen[i], design.controller[5]) for i in range(len(V))]
    assert all(margin.stable for margin in fixed) and fixed[-1].alpha > 0.4
