"""Plants, controller files, regulators, integrals, filters, pole placement: against limits and second routes."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm, solve_discrete_lyapunov

from aeroservo.aeroelastic.build import build
from aeroservo.aircraft.files import read
from aeroservo.control.controller import (
    Controller,
    controller_content,
    read_controller,
    state_feedback,
    write_controller,
)
from aeroservo.control.design import Design, controls, feedback, joined, square, with_state_outputs
from aeroservo.control.filters import LowPass, Notch, PhaseFilter, series, tustin
from aeroservo.control.kalman import kalman_gain, sensor_deviations
from aeroservo.control.lqg import GYRO_RECOVERY, LQG, observer
from aeroservo.control.lqi import LQI, held_integrals
from aeroservo.control.lqr import LQR, bryson_weights, lqr_gain, riccati
from aeroservo.control.pid import PID
from aeroservo.control.plant import design_plant, sampled_plant
from aeroservo.control.poles import PolePlacement, place
from aeroservo.control.response import controller_response
from aeroservo.control.synthesis import synthesise, synthesise_system
from aeroservo.control.verify import (
    explain_filter,
    explain_regulator,
    modes_out_of_reach,
    modes_out_of_sight,
    riccati_residual,
    stability_margin,
)
from aeroservo.datatypes import Array, FlightCondition, LinearSystem
from aeroservo.servo import Actuator, Sensor

IDENTITY = 1e-12
TWO_ROUTES = 1e-9

CHANNELS = {"states": ("a", "b", "c"), "inputs": ("u", "v"), "outputs": ("x", "y", "z")}


def random_system(seed: int = 1) -> LinearSystem:
    """Three states, two inputs of which one acts at once on an output."""
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((3, 3)) - 1.5 * np.eye(3)
    B, C = rng.standard_normal((3, 2)), rng.standard_normal((3, 3))
    return LinearSystem(A=A, B=B, C=C, D=[[0.0, 0.0], [0.7, 0.0], [0.0, 0.0]], **CHANNELS)


def second_order(dt: float | None = None, **changes: object) -> LinearSystem:
    """An unstable oscillator with both states measured."""
    plant = LinearSystem(
        A=[[0.0, 1.0], [-4.0, 0.5]], B=[[0.0], [1.0]], C=np.eye(2), D=np.zeros((2, 1)), states=("x", "x_rate"),
        inputs=("u",), outputs=("x", "x_rate"),
    )  # fmt: skip
    plant = replace(plant, **changes)
    return plant if dt is None else sampled_plant(plant, dt)


# plants


@pytest.mark.parametrize("delay", [0.0, 1.0, 0.3, 2.5])
def test_sampled_plant_is_fine_stepping(delay: float) -> None:
    """Held and delayed inputs, stepped exactly on a grid a hundred times as fine; a sample sees the old command."""
    system, dt, fine = random_system(), 0.1, 100
    plant = sampled_plant(system, dt, delay_samples=delay)
    rng = np.random.default_rng(2)
    u = rng.standard_normal((20, 2))
    big = np.zeros((5, 5))
    big[:3, :3], big[:3, 3:] = system.A, system.B
    step = expm(big * dt / fine)

    def acting(i: int) -> Array:
        k = math.floor(i / fine - delay + 1e-9)
        return u[k] if k >= 0 else np.zeros(2)

    state, x = np.zeros(len(plant.states)), np.zeros(3)
    for k in range(20):
        before = acting(k * fine - 1) if k else np.zeros(2)
        np.testing.assert_allclose(plant.C @ state + plant.D @ u[k], system.C @ x + system.D @ before, atol=1e-12)
        state = plant.A @ state + plant.B @ u[k]
        for i in range(fine):
            x = step[:3, :3] @ x + step[:3, 3:] @ acting(k * fine + i)


def test_sampled_plant_of_a_batch_is_each_of_them() -> None:
    """Batches of continuous and of sampled systems."""
    first, second = random_system(1), random_system(2)
    stacked = {n: np.stack([getattr(first, n), getattr(second, n)]) for n in "ABCD"}
    both = sampled_plant(replace(first, **stacked), 0.05, delay_samples=1.2)
    for i, one in enumerate((first, second)):
        alone = sampled_plant(one, 0.05, delay_samples=1.2)
        np.testing.assert_allclose(both.A[i], alone.A, atol=IDENTITY)
        np.testing.assert_allclose(both.C[i], alone.C, atol=IDENTITY)
    assert both.states == alone.states
    again = sampled_plant(sampled_plant(first, 0.05), 0.05, delay_samples=2, inputs=["u"])
    assert again.states[-2:] == ("u_1_ago", "u_2_ago") and again.dt == 0.05


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"dt_s": 0.0}, "dt_s must be positive"),
        ({"delay_samples": -1.0}, "delay_samples must not be negative"),
        ({"delay_samples": 500.0}, "at most 200 samples"),
        ({"inputs": ["w"]}, "input 'w' does not exist"),
        ({"outputs": ["x", "x"]}, "outputs must differ"),
    ],
)
def test_bad_samplings(change: dict[str, object], message: str) -> None:
    """Named, with what is allowed."""
    with pytest.raises(ValueError, match=message):
        sampled_plant(random_system(), **({"dt_s": 0.1} | change))


def test_a_sampled_system_has_its_own_rate() -> None:
    """Another rate, or half a sample, is refused."""
    plant = sampled_plant(random_system(), 0.1)
    with pytest.raises(ValueError, match="whole samples of its own"):
        sampled_plant(plant, 0.2)
    with pytest.raises(ValueError, match="whole samples of its own"):
        sampled_plant(plant, 0.1, delay_samples=0.5)


def test_design_plant_holds_lags_and_leaves_free_heave_out() -> None:
    """Sensor lags are states; the heave of a free aircraft is not, unless asked for."""
    model = build(read("thesis-simulation"))
    model = replace(model, sensors=(Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0), bandwidth=50.0),))
    at = FlightCondition.at(0.0, V=40.0)
    slow = design_plant(model, at, sensors=["gyro"])
    raw = design_plant(model, at, sensors=["pitch_rate_rad_s"])
    s = 7j
    H, raw_H = (
        (p.C @ np.linalg.solve(s * np.eye(len(p.states)) - p.A, p.B.astype(complex)) + p.D)[0, 0] for p in (slow, raw)
    )
    assert H == pytest.approx(raw_H * 50.0 / (s + 50.0), rel=1e-12)
    free = build(read("thesis-aircraft"))
    assert "heave_m" not in design_plant(free, at).states
    assert "heave_m" in design_plant(free, at, keep_free=True).states
    same = [np.linalg.eigvals(design_plant(free, at, keep_free=keep).A) for keep in (True, False)]
    kept = sorted(same[0], key=abs)
    assert abs(kept[0]) < 1e-9
    np.testing.assert_allclose(np.poly(kept[1:]), np.poly(same[1]), rtol=1e-9)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"rate_Hz": -1.0}, "rate_Hz must be positive"),
        ({"delay_samples": 1.0}, "needs a sample rate"),
        ({"sensors": ["nose"]}, "sensor 'nose' does not exist; sensors: gyro"),
        ({"sensors": ["gyro"]}, "differ; give rate_Hz"),
    ],
)
def test_bad_design_plants(options: dict[str, object], message: str) -> None:
    """Named; an aged sensor has no continuous plant."""
    gyro = Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0), delay_s=0.002)
    model = replace(build(read("thesis-simulation")), sensors=(gyro,))
    with pytest.raises(ValueError, match=message):
        design_plant(model, FlightCondition.at(0.0, V=40.0), **options)


def test_dead_time_of_a_continuous_plant_is_no_state_and_is_refused_by_designs() -> None:
    """It is kept as input_delay_s, which margins take exactly."""
    slow = Actuator(control="elevon", omega=60.0, zeta=0.7, delay_s=0.004)
    model = replace(build(read("thesis-simulation")), actuators=(slow,))
    plant = design_plant(model, FlightCondition.at(0.0, V=40.0))
    assert plant.input_delay_s == 0.004
    with pytest.raises(ValueError, match="that is no state: sample it"):
        LQR(Q=[1.0], R=[1.0])(plant)


# files


def test_controller_files_there_and_back(tmp_path: Path) -> None:
    """A schedule with states, limits, delay and windup; a gain without states; a continuous one."""
    rng = np.random.default_rng(3)
    schedule = Controller(
        A=rng.standard_normal((3, 2, 2)), B=rng.standard_normal((3, 2, 1)), C=rng.standard_normal((3, 1, 2)),
        D=rng.standard_normal((3, 1, 1)), inputs=("gyro",), outputs=("elevon_command_rad",), dt_s=0.005, delay_s=0.005,
        limits=(0.3,), pressures=np.array([100.0, 500.0, 2000.0]), windup=rng.standard_normal((3, 2, 1)),
    )  # fmt: skip
    gain = state_feedback([[1.0, 2.0]], ("a", "b"), ("u",), 0.01)
    plain = replace(schedule, windup=None)
    for controller in (schedule, plain, gain, state_feedback([[1.0]], ("a",), ("u",), None)):
        write_controller(tmp_path / "c.json", controller)
        back = read_controller(tmp_path / "c.json")
        for name in (*"ABCD", "pressures", "windup"):
            np.testing.assert_array_equal(getattr(back, name), getattr(controller, name))
        for name in ("inputs", "outputs", "dt_s", "delay_s", "limits"):
            assert getattr(back, name) == getattr(controller, name)
    assert json.loads((tmp_path / "c.json").read_text())["schema_version"] == 1
    assert "windup" not in controller_content(plain)["points"][0]
    with pytest.raises(ValueError, match="cannot be written"):
        write_controller(tmp_path / "no" / "c.json", gain)
    with pytest.raises(ValueError, match="K must have shape"):
        state_feedback([[1.0, 2.0]], ("a",), ("u",), None)
    with pytest.raises(ValueError, match="they belong to the computer that samples it"):
        replace(plain, dt_s=None, delay_s=0.0, limits=(), A=plain.A[:1], B=plain.B[:1], C=plain.C[:1], D=plain.D[:1],
                pressures=None, windup=np.ones((1, 2, 1)))  # fmt: skip


# regulators


def test_regulator_cost_is_its_riccati_solution() -> None:
    """x'X x is the cost of the run from x, cross weights included: a second route by Lyapunov's equation."""
    plant = second_order(0.05)
    Q, R, N = np.diag([3.0, 1.0]), np.array([[0.5]]), np.array([[0.2], [0.1]])
    K, X = lqr_gain(plant.A, plant.B, Q, R, N=N, dt=plant.dt)
    closed = plant.A - plant.B @ K
    cost = Q + K.T @ R @ K - N @ K - (N @ K).T
    np.testing.assert_allclose(X, solve_discrete_lyapunov(closed.T, cost), rtol=TWO_ROUTES)
    for change in (np.array([[1e-3, 0.0]]), np.array([[0.0, -1e-3]])):  # and it is a minimum
        other = plant.A - plant.B @ (K + change)
        worse = solve_discrete_lyapunov(
            other.T, Q + (K + change).T @ R @ (K + change) - N @ (K + change) - (N @ (K + change)).T
        )
        assert np.linalg.eigvalsh(worse - X)[-1] > 0.0


def test_sampled_regulator_becomes_the_continuous_one() -> None:
    """With the step, the sampled gain goes to the continuous one, first order in the step."""
    continuous = LQR(Q=[3.0, 1.0], R=[0.5])(second_order()).K
    gains = [LQR(Q=[3.0, 1.0], R=[0.5])(second_order(dt)).K for dt in (2e-3, 1e-3, 1e-4)]
    errors = [np.abs(K / continuous - 1.0).max() for K in gains]
    assert errors[-1] < 1e-3 and errors[0] / errors[1] == pytest.approx(2.0, rel=0.05)


def test_batch_of_regulators_is_each_of_them() -> None:
    """One call for a row of speeds."""
    model = build(read("thesis-simulation"))
    V = np.array([30.0, 50.0, 70.0])
    plant = controls(design_plant(model, FlightCondition.at(3048.0, V=V), rate_Hz=100.0))
    design = LQR(Q=np.ones(4), R=[1.0])(plant)
    for i in range(3):
        alone = LQR(Q=np.ones(4), R=[1.0])(plant[i])
        np.testing.assert_allclose(design.K[i], alone.K, rtol=TWO_ROUTES)
        np.testing.assert_allclose(
            np.poly(design.closed_loop_eigenvalues[i]), np.poly(alone.closed_loop_eigenvalues), atol=1e-9
        )
    assert design.residual.shape == (3,) and design.as_controller(pressures=[1.0, 2.0, 3.0]).D.shape == (3, 1, 4)
    with pytest.raises(ValueError, match="needs one pressure for each design"):
        design.as_controller()


def test_bryson() -> None:
    """[6.11]."""
    Q, R = bryson_weights([0.1, math.inf, 2.0], [0.5], settling_s=[2.0, 1.0, 1.0], rho=3.0)
    np.testing.assert_allclose(Q, [50.0, 0.0, 0.25])
    np.testing.assert_allclose(R, [12.0])
    with pytest.raises(ValueError, match="must be positive"):
        bryson_weights([1.0], [0.0])


def test_ill_scaled_problem_is_refined() -> None:
    """States twelve decades apart: the residual stays at rounding."""
    scale = np.diag([1.0, 1e6, 1e-6])
    A = np.linalg.inv(scale) @ np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, -2.0, 3.0]]) @ scale
    B = np.linalg.inv(scale) @ np.array([[0.0], [0.0], [1.0]])
    Q = scale @ np.eye(3) @ scale
    X = riccati(A, B, Q, np.eye(1))
    assert riccati_residual(A, B, Q, np.eye(1), X) < 1e-7
    plain, _ = lqr_gain(scale @ A @ np.linalg.inv(scale), scale @ B, np.eye(3), np.eye(1))
    np.testing.assert_allclose(lqr_gain(A, B, Q, np.eye(1))[0] @ np.linalg.inv(scale), plain, rtol=1e-5)


@pytest.mark.parametrize("dt", [None, 0.05])
def test_no_solver_is_taken_at_its_word(monkeypatch: pytest.MonkeyPatch, dt: float | None) -> None:
    """A solution that is a little off is refined by Newton's method, one that is far off is refused."""
    import scipy.linalg

    plant = second_order(dt)
    Q, R, N = np.diag([3.0, 1.0]), np.array([[0.5]]), np.array([[0.2], [0.1]])
    name = "solve_continuous_are" if dt is None else "solve_discrete_are"
    true = getattr(scipy.linalg, name)
    exact = riccati(plant.A, plant.B, Q, R, N=N, dt=dt)
    for off, found in ((1e-4, True), (-30.0, False)):
        monkeypatch.setattr(scipy.linalg, name, lambda *a, off=off, **k: true(*a, **k) + off * np.eye(2))
        if found:
            better = riccati(plant.A, plant.B, Q, R, N=N, dt=dt)
            assert riccati_residual(plant.A, plant.B, Q, R, better, N=N, dt=dt) < 1e-11
            np.testing.assert_allclose(better, exact, rtol=1e-9)
            continue
        with pytest.raises(ValueError, match="relative residual of the Riccati equation"):
            riccati(plant.A, plant.B, Q, R, N=N, dt=dt)
        with pytest.raises(ValueError, match="ill-conditioned"):
            LQR(Q=Q, R=R)(plant)


NAMES = ("plunge", "pitch", "lag")


@pytest.mark.parametrize("dt", [None, 0.1])
def test_problems_without_solution_name_the_mode(dt: float | None) -> None:
    """Out of reach, out of sight, on the border without weight, hardly reached."""
    unstable = np.diag([0.5, -1.0, -2.0]) if dt is None else np.diag([1.05, 0.9, 0.8])
    B = np.array([[0.0], [1.0], [1.0]])
    with pytest.raises(ValueError, match=r"cannot be stabilised by elevon_rad: mode .*in plunge.*out of reach"):
        lqr_gain(unstable, B, np.eye(3), np.eye(1), dt=dt, states=NAMES, inputs=("elevon_rad",))
    with pytest.raises(ValueError, match=r"cannot be observed by gyro: mode .*in plunge.*out of sight"):
        kalman_gain(unstable, B.T, np.eye(3), np.eye(1), dt=dt, states=NAMES, outputs=("gyro",))
    border = np.diag([0.0, -1.0, -2.0]) if dt is None else np.diag([1.0, 0.9, 0.8])
    with pytest.raises(ValueError, match=r"on the border of stability and does not show in the state weights"):
        lqr_gain(border, np.ones((3, 1)), np.diag([0.0, 1.0, 1.0]), np.eye(1), dt=dt, states=NAMES)
    with pytest.raises(ValueError, match=r"on the border of stability and no noise reaches it"):
        kalman_gain(border, np.ones((1, 3)), np.diag([0.0, 1.0, 1.0]), np.eye(1), dt=dt, states=NAMES)
    # a stable mode out of reach is nobody's problem
    K, _ = lqr_gain(unstable[::-1, ::-1], B, np.eye(3), np.eye(1), dt=dt)
    assert stability_margin(unstable[::-1, ::-1] - B @ K, dt) > 0.0


def test_weak_modes_are_named_where_a_problem_is_ill_conditioned() -> None:
    """The words of the last resort."""
    A, B = np.diag([1.0, -1.0]), np.array([[1e-7], [1.0]])
    words = explain_regulator(A, B, np.eye(2), ("divergence", "flutter"), inputs=("elevon",))
    assert "is ill-conditioned: mode 1 (in divergence" in words and "hardly reached by elevon" in words
    words = explain_filter(A, B.T, np.eye(2), ("divergence", "flutter"), outputs=("gyro",))
    assert "hardly seen by gyro" in words
    stiff = np.array([[0.0, 1e9], [1e-9, -1.0]])
    assert "decades" in explain_regulator(stiff, np.ones((2, 1)), np.eye(2), ("m", "km"))
    assert "weights are too far apart (that of b is 1e+30" in explain_regulator(
        np.array([[0.0, 1.0], [-1.0, 0.0]]), np.array([[0.0], [1.0]]), np.diag([1.0, 1e30]), ("a", "b")
    )
    assert modes_out_of_reach(np.zeros((0, 0)), np.zeros((0, 1)), ()) == []


def test_pbh_finds_one_of_a_pair_and_what_is_seen_elsewhere() -> None:
    """An undamped pair that only the second sensor sees."""
    A = np.array([[0.0, 3.0, 0.0], [-3.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    blind = modes_out_of_sight(A, np.array([[0.0, 0.0, 1.0]]), ("h", "h_rate", "theta"))
    assert len(blind) == 1 and blind[0].eigenvalue == pytest.approx(3j) and set(blind[0].states) == {"h", "h_rate"}
    assert modes_out_of_sight(A, np.array([[1.0, 0.0, 1.0]]), ("h", "h_rate", "theta")) == []


def test_state_feedback_that_cannot_be_built() -> None:
    """Nothing measured, an unstable rest, an unknown state, weights that do not fit."""
    plant = second_order()
    design = {"method": "lqr", "residual": np.zeros(())}
    with pytest.raises(ValueError, match="no output of the plant shows one"):
        feedback(replace(plant, outputs=("y1", "y2")), np.ones((1, 2)), **design)
    with pytest.raises(ValueError, match="x_rate cannot be simulated inside"):
        feedback(plant, np.ones((1, 2)), measured=("x",), **design)
    with pytest.raises(ValueError, match="'z' is no state"):
        feedback(plant, np.ones((1, 2)), measured=("z",), **design)
    with pytest.raises(ValueError, match="no control to design for"):
        controls(replace(plant, inputs=("gust_m_s",)))
    for values, message in (
        ([1.0, 2.0, 3.0], "of at most 2, of x, x_rate; got shape"),
        ([[1.0, 1.0], [0.0, 1.0]], "must be symmetric"),
        ([-1.0], "must be not negative"),
        ([math.nan], "not finite"),
    ):
        with pytest.raises(ValueError, match=message):
            square(values, plant.states, "Q")
    with pytest.raises(ValueError, match="must be positive"):
        square([0.0], ("u",), "R", definite=True)


# integrals


def test_rank_test_of_the_thesis_integrals() -> None:
    """Plunge and pitch by one elevon [7.69]: rank 9 of 10 for the free aircraft with its actuator; leaky ones work."""
    servo = Actuator(control="elevon", omega=60.0, zeta=0.7)
    model = replace(build(read("thesis-aircraft")), actuators=(servo,))
    plant = controls(design_plant(model, FlightCondition.at(0.0, V=40.0), keep_free=True))
    assert len(plant.states) == 8
    weights = {"Q": np.ones(8), "R": [1.0], "Q_integrals": [1.0, 1.0]}
    two = ("heave_m", "torsion_1_rad")
    with pytest.raises(ValueError, match=r"is 9 of 10 at s = 0: 2 integrals .* by 1 control.*take leaky"):
        LQI(integrals=two, **weights)(plant)
    sampled = sampled_plant(plant, 0.005, delay_samples=1)
    with pytest.raises(ValueError, match="of 11 at z = 1"):
        LQI(integrals=two, **weights)(sampled)
    leaky = LQI(integrals=two, leak=0.5, **weights)(plant)
    assert leaky.closed_loop_eigenvalues.real.max() < 0.0 and "leaky" in leaky.notes[0]
    assert leaky.states[-2:] == ("integral_of_heave_m", "integral_of_torsion_1_rad")
    # a rate has a zero at s = 0: its integral is a state that is there already
    fixed = controls(design_plant(build(read("thesis-simulation")), FlightCondition.at(0.0, V=35.0)))
    with pytest.raises(ValueError, match="transmission zero"):
        LQI(Q=np.ones(4), R=[1.0], integrals=("pitch_rate_rad_s",), Q_integrals=[1.0])(fixed)


@pytest.mark.parametrize("dt", [None, 0.01])
def test_an_integral_removes_a_steady_error(dt: float | None) -> None:
    """A constant disturbance at the input leaves no error in the integrated output; a leaky one leaves a little."""
    plant = controls(design_plant(build(read("thesis-simulation")), FlightCondition.at(0.0, V=35.0)))
    plant = plant if dt is None else sampled_plant(plant, dt, delay_samples=1)
    errors = []
    for leak in (0.0, 0.2):
        design = LQI(Q=np.ones(4), R=[1.0], integrals=("pitch_rad",), Q_integrals=[50.0], leak=leak)(plant)
        closed = joined(plant, design.controller)
        assert stability_margin(closed, dt) > 0.0
        push = np.concatenate([plant.B[:, 0], np.zeros(len(design.controller.states))])
        x = np.linalg.solve((0.0 if dt is None else 1.0) * np.eye(len(closed)) - closed, push)
        errors.append(abs(x[plant.states.index("pitch_rad")]))
    assert errors[0] < 1e-12 < 1e-3 < errors[1]


def test_integral_controller_is_the_gain_on_the_augmented_plant() -> None:
    """The roots of the built controller are those of A - B K of the plant with integrals, and the simulated part's."""
    servo = Actuator(control="elevon", omega=60.0, zeta=0.7)
    model = replace(build(read("thesis-simulation")), actuators=(servo,))
    plant = controls(design_plant(model, FlightCondition.at(0.0, V=35.0), rate_Hz=100.0, delay_samples=2))
    design = LQI(Q=np.ones(4), R=[1.0], integrals=("pitch_rad",), Q_integrals=[50.0])(plant)
    held = held_integrals(plant, ["pitch_rad"])
    inside = [i for i, n in enumerate(plant.states) if n not in design.controller.inputs]
    wanted = np.concatenate(
        [np.linalg.eigvals(held.A - held.B @ design.K), np.linalg.eigvals(plant.A[np.ix_(inside, inside)])]
    )
    np.testing.assert_allclose(np.poly(design.closed_loop_eigenvalues), np.poly(wanted), atol=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"integrals": ()}, "at least one"),
        ({"Q_integrals": [0.0]}, "positive numbers"),
        ({"leak": -1.0}, "leak must not be negative"),
        ({"tracking_s": 0.0}, "tracking_s must be positive"),
    ],
)
def test_bad_integrals(change: dict[str, object], message: str) -> None:
    """Named."""
    with pytest.raises(ValueError, match=message):
        LQI(**({"Q": [1.0], "R": [1.0], "integrals": ("x",), "Q_integrals": [1.0]} | change))


# Kalman filters


def test_kalman_filter_is_the_best_predictor() -> None:
    """Covariance by Lyapunov's equation of its own error; any other gain is worse; cross covariance included."""
    plant = second_order(0.05)
    A, C = plant.A, plant.C[:1]
    W, V, S = np.diag([0.1, 0.4]), np.array([[0.3]]), np.array([[0.05], [0.1]])
    L, P = kalman_gain(A, C, W, V, S=S, dt=0.05)

    def spread(gain: Array) -> Array:
        noise = W + gain @ V @ gain.T - S @ gain.T - gain @ S.T
        return np.asarray(solve_discrete_lyapunov(A - gain @ C, noise))

    np.testing.assert_allclose(spread(L), P, rtol=TWO_ROUTES)
    for change in (np.array([[0.01], [0.0]]), np.array([[0.0], [-0.01]])):
        assert np.linalg.eigvalsh(spread(L + change) - P)[0] > -1e-12
        assert np.trace(spread(L + change)) > np.trace(P)
    with pytest.raises(ValueError, match="is not known by its unit"):
        sensor_deviations(("strain",))


def test_current_filter_knows_more_than_the_predictor() -> None:
    """Both separate; the current form has the smaller cost, which is trace(X W) and more."""
    plant = second_order(0.1, outputs=("x_m", "x_rate_m_s"))
    plant = replace(plant, C=plant.C[:1], D=plant.D[:1], outputs=("x_m",))
    spread = []
    for form in ("current", "predictor"):
        design = LQG(Q=[1.0, 1.0], R=[1.0], W=[0.0, 1.0], V=[0.01], form=form)(plant)
        assert design.residual < 1e-10 and np.all(np.abs(design.closed_loop_eigenvalues) < 1.0)
        closed, n = joined(plant, design.controller), 2
        # process noise and sensor noise through the whole loop
        noise = np.zeros((4, 3))
        noise[1, 0] = 1.0
        noise[:n, 1:2] = 0.1 * plant.B @ design.controller.D
        noise[n:, 1:2] = 0.1 * design.controller.B
        total = solve_discrete_lyapunov(closed, noise @ noise.T)
        spread.append(total[0, 0] + total[1, 1])
    assert spread[0] < spread[1]
    moved = replace(plant, D=[[1.0]])
    with pytest.raises(ValueError, match="take form='predictor'"):
        LQG(Q=[1.0, 1.0], R=[1.0], W=[1.0, 1.0], V=[1.0])(moved)
    algebraic = LQG(Q=[1.0, 1.0], R=[1.0], W=[1.0, 1.0], V=[1.0], form="predictor")(moved)
    assert algebraic.residual < 1e-9 and np.all(np.abs(algebraic.closed_loop_eigenvalues) < 1.0)


def test_recovery_approaches_full_state_where_zeros_allow_it() -> None:
    """Doyle and Stein: the loop at the input goes to K (sI - A)^-1 B; with a zero in the right half plane it cannot."""
    omega = np.logspace(-1, 1.0, 40)

    def loop(design: Design, plant: LinearSystem, s: complex) -> complex:
        c = design.controller
        n, m = len(c.states), len(plant.states)
        H = c.C @ np.linalg.solve(s * np.eye(n) - c.A, c.B.astype(complex)) + c.D
        P = plant.C @ np.linalg.solve(s * np.eye(m) - plant.A, plant.B.astype(complex))
        return complex(-(H @ P)[0, 0])

    gaps = {}
    for name, row in (("minimum phase", [[3.0, 1.0]]), ("zero at +3", [[3.0, -1.0]])):
        plant = second_order(C=row, D=[[0.0]], outputs=("y_rad",))
        for q in (0.1, 100.0):
            design = LQG(Q=[4.0, 1.0], R=[1.0], W=[0.01, 0.01], V=[1e-2], recovery=q)(plant)
            full = [
                complex((design.K @ np.linalg.solve(1j * w * np.eye(2) - plant.A, plant.B.astype(complex)))[0, 0])
                for w in omega
            ]
            got = [loop(design, plant, 1j * w) for w in omega]
            gaps[name, q] = float(np.max(np.abs(np.array(got) / np.array(full) - 1.0)))
        assert bool(design.notes) == (name == "zero at +3")
    assert "zeros in the right half plane, 1/s: 3" in design.notes[0]
    assert gaps["minimum phase", 100.0] < 0.02 < 0.3 < gaps["minimum phase", 0.1]
    assert gaps["zero at +3", 100.0] > 0.5


def test_recovery_noise_enters_behind_the_delay() -> None:
    """The memory of past commands is known exactly: no delay changes the filter of the physical states."""
    gyro = Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0))
    servo = Actuator(control="elevon", omega=60.0, zeta=0.7)
    model = replace(build(read("thesis-simulation")), sensors=(gyro,), actuators=(servo,))
    poles = []
    for delay in (0, 1, 3):
        plant = design_plant(
            model, FlightCondition.at(3048.0, V=60.0), rate_Hz=200.0, delay_samples=delay, sensors=["gyro"], gusts=True
        )
        design = GYRO_RECOVERY(plant)
        u = controls(plant)
        eigenvalues = np.linalg.eigvals(u.A - u.B @ design.K)
        left = list(design.closed_loop_eigenvalues)
        for value in eigenvalues:  # what is left of the loop's roots are the filter's
            left.pop(int(np.argmin(np.abs(np.array(left) - value))))
        poles.append(sorted(left, key=lambda z: -abs(z))[:4])
        assert any("delay state" in note for note in design.notes) == bool(delay)
    np.testing.assert_allclose(np.poly(poles[1]), np.poly(poles[0]), atol=1e-5)
    np.testing.assert_allclose(np.poly(poles[2]), np.poly(poles[0]), atol=1e-5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"gust": -1.0}, "gust must not be negative"),
        ({"recovery": math.nan}, "recovery must not be negative"),
        ({"form": "late"}, "form must be"),
    ],
)
def test_bad_lqg(change: dict[str, object], message: str) -> None:
    """Named."""
    with pytest.raises(ValueError, match=message):
        LQG(**({"Q": [1.0], "R": [1.0]} | change))


# PID and filters


def response(system: LinearSystem, omega: float) -> complex:
    """Transfer function of a single channel at a frequency."""
    point = 1j * omega if system.dt is None else np.exp(1j * omega * system.dt)
    n = len(system.states)
    return complex(
        (system.C @ np.linalg.solve(point * np.eye(n) - system.A, system.B.astype(complex)) + system.D)[0, 0]
    )


@pytest.mark.parametrize("dt", [None, 0.02])
def test_filters_are_what_they_say(dt: float | None) -> None:
    """At the frequency they are about, sampled or not; far from it; in series."""
    assert abs(response(LowPass(corner=30.0)("y", dt), 30.0)) == pytest.approx(math.sqrt(0.5), rel=1e-12)
    assert np.angle(response(LowPass(corner=30.0)("y", dt), 30.0)) == pytest.approx(-math.pi / 4, rel=1e-12)
    notch = Notch(frequency=40.0, depth=0.2, damping=0.3)("y", dt)
    assert response(notch, 40.0) == pytest.approx(0.2, rel=1e-9)
    assert response(notch, 1e-6) == pytest.approx(1.0, rel=1e-6)
    if dt is None:
        s = 13j
        wanted = (s * s + 2 * 0.2 * 0.3 * 40 * s + 1600) / (s * s + 2 * 0.3 * 40 * s + 1600)
        assert response(notch, 13.0) == pytest.approx(wanted, rel=1e-12)
    for phase in (0.7, -0.7):
        lead = response(PhaseFilter(frequency=25.0, phase=phase)("y", dt), 25.0)
        assert abs(lead) == pytest.approx(1.0, rel=1e-12) and np.angle(lead) == pytest.approx(phase, rel=1e-9)
    chain = series(LowPass(corner=30.0)("y", dt), notch, LowPass(corner=30.0)("y", dt))
    parts = response(LowPass(corner=30.0)("y", dt), 17.0) ** 2 * response(notch, 17.0)
    assert response(chain, 17.0) == pytest.approx(parts, rel=1e-12) and len(set(chain.states)) == 4


def test_bad_filters() -> None:
    """Named, with what is allowed."""
    for make, message in (
        (lambda: LowPass(corner=0.0), "corner must be positive"),
        (lambda: Notch(frequency=1.0, depth=2.0), "depth must be from 0 to 1"),
        (lambda: PhaseFilter(frequency=1.0, phase=2.0), "phase must be between"),
        (lambda: LowPass(corner=400.0)("y", 0.01), "below the Nyquist frequency of 314"),
        (lambda: tustin(LowPass(corner=4.0)("y", 0.01), 0.01), "only a continuous system"),
        (lambda: series(), "at least one"),
        (lambda: series(LowPass(corner=4.0)("y", 0.01), LowPass(corner=4.0)("y")), "must fit"),
    ):
        with pytest.raises(ValueError, match=message):
            make()


@pytest.mark.parametrize("dt", [None, 0.005])
def test_pid_is_its_formula(dt: float | None) -> None:
    """Each term, with a filter before it; Tustin's s at each frequency."""
    plant = second_order(dt)
    pid = PID(channel="x", kp=2.0, ki=3.0, kd=0.4, derivative_rad_s=50.0, filters=(LowPass(corner=80.0),))
    design = pid(plant)
    for omega in (0.3, 5.0, 40.0):
        s = 1j * omega
        z = np.exp(s * (dt or 1.0))
        p = s if dt is None else 2.0 / dt * (z - 1.0) / (z + 1.0)
        terms = 2.0 + 3.0 / p + 0.4 * 50.0 * p / (p + 50.0)
        wanted = -terms * response(LowPass(corner=80.0)("x", dt), omega)
        assert response(design.controller, omega) == pytest.approx(wanted, rel=1e-9)
    assert design.residual < 1e-10 and design.K.shape == (1, 0)


def test_pid_integral_follows_a_clipped_command() -> None:
    """A lasting error beyond the limit, then none: the command leaves its limit within the tracking time."""
    plant = second_order(0.01)
    design = PID(channel="x", kp=1.0, ki=20.0, tracking_s=0.05)(plant)
    controller = design.as_controller(limits=(0.5,))
    y = np.concatenate([np.ones(300), np.full(100, -0.1)])[:, None]
    u, _ = controller_response(controller, y)
    wound, _ = controller_response(replace(controller, windup=None), y)
    assert np.abs(u).max() == 0.5
    assert np.abs(u[310:, 0]).min() < 0.5 and u[330, 0] > -0.5
    assert np.all(wound[300:, 0] == -0.5)  # without tracking it stays at the stop: 3 s of error to unwind


def test_pid_says_what_it_cannot() -> None:
    """An unstable loop is an answer; a bad channel, two controls and no gains are refused."""
    plant = second_order(0.01)
    bad = PID(channel="x", kp=-50.0)(plant)
    assert "unstable" in bad.notes[0]
    with pytest.raises(ValueError, match="output 'z' does not exist"):
        PID(channel="z", kp=1.0)(plant)
    with pytest.raises(ValueError, match="all zero"):
        PID(channel="x")
    with pytest.raises(ValueError, match="kp must be finite"):
        PID(channel="x", kp=math.inf)
    with pytest.raises(ValueError, match="tracking_s must be positive"):
        PID(channel="x", kp=1.0, tracking_s=0.0)
    two = sampled_plant(random_system(), 0.1)
    with pytest.raises(ValueError, match="a PID drives one control"):
        PID(channel="x", kp=1.0)(two)
    assert PID(channel="x", kp=0.1, control="v")(two).controller.outputs == ("v",)


# poles


@pytest.mark.parametrize("dt", [None, 0.02])
def test_poles_arrive(dt: float | None) -> None:
    """Repeated, complex and, in a sampled plant with delay, at z = 0; several inputs."""
    plant = second_order()
    plant = plant if dt is None else sampled_plant(plant, dt, delay_samples=2)
    wanted = np.array([-3.0 + 2.0j, -3.0 - 2.0j])
    design = PolePlacement(poles=wanted)(plant)
    aim = wanted if dt is None else np.concatenate([np.exp(wanted * dt), [0.0, 0.0]])
    np.testing.assert_allclose(np.poly(plant.A - plant.B @ design.K), np.poly(aim).real, atol=1e-9)
    twice = PolePlacement(poles=[-2.0, -2.0])(plant)
    assert twice.residual < 1e-9
    rng = np.random.default_rng(5)
    A, B = rng.standard_normal((6, 6)), rng.standard_normal((6, 2))
    K, residual = place(A, B, np.array([-1.0, -2.0, -3.0, -4.0, -5.0, -6.0]), tuple("abcdef"))
    assert residual < 1e-8
    np.testing.assert_allclose(np.sort(np.linalg.eigvals(A - B @ K).real), [-6, -5, -4, -3, -2, -1], rtol=1e-6)


def test_poles_that_cannot_be_placed() -> None:
    """Wrong in number, not in pairs, out of reach, beyond the precision of numbers."""
    assert PolePlacement(poles=np.zeros(2))(second_order()).residual < 1e-9
    wing = controls(design_plant(build(read("thesis-simulation")), FlightCondition.at(3048.0, V=60.0)))
    with pytest.raises(ValueError, match="roots miss them"):  # the slow ones would be 3 % off
        PolePlacement(poles=[-1e9, -1.0, -2.0, -3.0])(wing)
    with pytest.raises(ValueError, match="conjugate pairs"):
        PolePlacement(poles=[-1.0 + 1.0j])
    with pytest.raises(ValueError, match=r"poles must be 2 \[1/s\]"):
        PolePlacement(poles=[-1.0])(second_order())
    with pytest.raises(ValueError, match="fewer are allowed"):
        PolePlacement(poles=[-1.0, -2.0, -3.0])(second_order(0.1))
    A, B = np.diag([1.0, -1.0]), np.array([[0.0], [1.0]])
    with pytest.raises(ValueError, match=r"mode 1 \(in fast"):
        place(A, B, np.array([-1.0, -2.0]), ("fast", "slow"))
    with pytest.raises(ValueError, match="out of reach"):
        place(A, np.zeros((2, 1)), np.array([-1.0, -2.0]), ("fast", "slow"))
    with pytest.raises(ValueError, match="cannot be placed"):
        place(A, np.array([[0.0, 0.0], [1.0, 2.0]]), np.array([-1.0, -2.0]), ("fast", "slow"))


# one call


def test_synthesis_of_models_and_systems() -> None:
    """A schedule and a linear model; limits of the actuator; refusals."""
    servo = Actuator(control="elevon", omega=60.0, zeta=0.7, limit=0.35)
    model = replace(build(read("thesis-simulation")), actuators=(servo,))
    row = FlightCondition.at(3048.0, V=[40.0, 60.0])
    weights = LQR(Q=[0.0, 800.0, 0.0, 1.0], R=[33.0])
    found = synthesise(model, weights, row, rate_Hz=200.0, delay_samples=1)
    assert found.controller.limits == (0.35,) and found.controller.delay_s == 0.005
    np.testing.assert_array_equal(found.controller.pressures, row.q)
    assert len(found.margins) == 2 and min(m.alpha for m in found.margins) > 0.5
    system = replace(second_order(), outputs=("y1", "y2"))
    one = synthesise_system(with_state_outputs(system), LQR(Q=[1.0], R=[1.0]), rate_Hz=50.0, delay_samples=1)
    assert one.controller.dt_s == 0.02 and one.margins[0].stable
    for call, message in (
        (lambda: synthesise(model, weights, row), "belongs to a sampled controller"),
        (lambda: synthesise(model, weights, row[::-1], rate_Hz=200.0), "ascending dynamic pressure"),
        (lambda: synthesise(model, weights, row[None], rate_Hz=200.0), "a row of conditions"),
        (lambda: synthesise_system(system, weights, delay_samples=1), "needs a sample rate"),
        (lambda: synthesise_system(system, weights, rate_Hz=-1.0), "rate_Hz must be positive"),
    ):
        with pytest.raises(ValueError, match=message):
            call()


def test_sensors_that_state_their_noise_are_believed() -> None:
    """A noisy gyro makes a filter that trusts it less; one that says nothing has the noise of its unit."""
    designs = []
    for noise in (0.0, math.radians(0.1), math.radians(3.0)):
        gyro = Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0), noise=noise)
        model = replace(build(read("thesis-simulation")), sensors=(gyro,))
        at = FlightCondition.at(3048.0, V=40.0)
        found = synthesise(model, LQG(Q=[0.0, 800.0, 0.0, 1.0], R=[33.0]), at, rate_Hz=200.0, sensors=["gyro"])
        designs.append(found.controller)
    np.testing.assert_array_equal(designs[0].A, designs[1].A)
    assert np.linalg.norm(designs[2].B) < 0.5 * np.linalg.norm(designs[1].B)


def test_observer_of_a_continuous_plant_with_direct_action() -> None:
    """A command that acts at once on a sensor is taken out of the innovation."""
    plant = second_order(C=[[1.0, 0.0]], D=[[0.7]], outputs=("y_m",))
    design = LQG(Q=[1.0, 1.0], R=[1.0], W=[1.0, 1.0], V=[0.1])(plant)
    assert design.residual < 1e-10 and design.closed_loop_eigenvalues.real.max() < 0.0
    L, P = kalman_gain(plant.A, plant.C, np.eye(2), 0.1 * np.eye(1))
    again = observer(plant, design.K, L, P, 0.1 * np.eye(1), np.zeros((2, 1)))
    np.testing.assert_allclose(again.A, design.controller.A, atol=1e-12)
