"""Margins against closed forms, python-control and published examples; stability counted two independent ways."""

from __future__ import annotations

import math
from dataclasses import replace

import control
import numpy as np
import pytest
from scipy.linalg import solve_continuous_are

from aeroservo.aeroelastic.branches import Interval
from aeroservo.aeroelastic.build import build
from aeroservo.aircraft.files import read
from aeroservo.control.closed_loop import closed_loop, loop_plant
from aeroservo.control.controller import Controller, state_feedback
from aeroservo.control.disk_margins import disk_margin, margin_curve, mu_bound, total_delay
from aeroservo.control.loop import cut_loop, is_stable, unstable_roots
from aeroservo.control.margin_rules import flutter_clearance, mil_f_9490d
from aeroservo.control.margins import largest_delay, loop_margins
from aeroservo.datatypes import FlightCondition, LinearSystem
from aeroservo.servo import Actuator

IDENTITY = 1e-9  # the same number by a closed form
TWO_ROUTES = 1e-6  # the same number by another program's search
STATES = ("plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s")


def plant_of(A: object, B: object, C: object, D: object, dt: float | None = None) -> LinearSystem:
    """A system with channels x, u, y, numbered."""
    A, B, C, D = (np.atleast_2d(np.asarray(m, dtype=float)) for m in (A, B, C, D))
    names = (("x", A.shape[1]), ("u", B.shape[1]), ("y", C.shape[0]))
    states, inputs, outputs = (tuple(f"{n}{i}" for i in range(k)) for n, k in names)
    return LinearSystem(A=A, B=B, C=C, D=D, states=states, inputs=inputs, outputs=outputs, dt=dt)


def gain_of(K: object, dt: float | None = None, delay: float = 0.0) -> Controller:
    """u = -K y."""
    K = np.atleast_2d(np.asarray(K, dtype=float))
    inputs, outputs = (tuple(f"{n}{i}" for i in range(k)) for n, k in (("y", K.shape[1]), ("u", K.shape[0])))
    return Controller(A=[], B=[], C=[], D=-K, inputs=inputs, outputs=outputs, dt_s=dt, delay_s=delay)  # type: ignore[arg-type]


THIRD = plant_of([[0, 1, 0], [0, 0, 1], [-10, -10, -10]], [[0], [0], [1]], [[25, 0, 0]], [[0]])
SATELLITE = plant_of([[0, 10], [-10, 0]], np.eye(2), [[1, 10], [-10, 1]], np.zeros((2, 2)))


def test_published_disk_margin() -> None:
    """Seiler, Packard, Gahinet 2020, 25/(s^3+10s^2+10s+10): 0.46, gain 0.63 to 1.59, 25.8 deg; GM 3.6, PM 29.1."""
    margin = disk_margin(THIRD, gain_of(1.0))
    assert margin.alpha == pytest.approx(0.46, abs=0.005)
    assert margin.gain == pytest.approx((0.63, 1.59), abs=0.005)
    assert math.degrees(margin.phase) == pytest.approx(25.8, abs=0.05)
    one = loop_margins(THIRD, gain_of(1.0))[0]
    assert one.gain_up == pytest.approx(3.6, rel=IDENTITY)
    assert math.degrees(one.phase or 0.0) == pytest.approx(29.1, abs=0.05)


def test_published_satellite() -> None:
    """Loops with infinite gain margin and 90 deg each, but 0.0997 together (MathWorks' satellite, after Doyle)."""
    loops = loop_margins(SATELLITE, gain_of(np.eye(2)), at="both")
    assert len(loops) == 4
    for one in loops:
        assert (one.gain_up, one.gain_down) == (math.inf, 0.0)
        assert math.degrees(one.phase or 0.0) == pytest.approx(90.0, rel=IDENTITY)
    together = disk_margin(SATELLITE, gain_of(np.eye(2)))
    assert together.alpha == pytest.approx(0.0997, abs=6e-5)
    assert math.degrees(together.phase) == pytest.approx(5.71, abs=0.005)
    both = disk_margin(SATELLITE, gain_of(np.eye(2)), at="both")
    assert both.alpha < together.alpha
    assert both.channels == ("u0", "u1", "y0", "y1")


def test_published_coupled_satellite_and_mu() -> None:
    """K = [[1, -2], [0, 1]]: 0.3754 by SLICOT (python-control) within 0.3 %; mu of two channels exactly, by phases."""
    margin = disk_margin(SATELLITE, gain_of([[1.0, -2.0], [0.0, 1.0]]))
    assert margin.alpha == pytest.approx(0.3754, rel=3e-3)
    loop = cut_loop(SATELLITE, gain_of([[1.0, -2.0], [0.0, 1.0]]))
    L = loop.transfer(np.array([1e-6j]))[0]
    M = np.linalg.inv(np.eye(2) + L) - 0.5 * np.eye(2)
    phases = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 4001))
    mu = max(np.abs(np.linalg.eigvals(M @ np.diag([1.0, p]))).max() for p in phases)
    assert margin.alpha == pytest.approx(1.0 / mu, rel=1e-5)


def test_mu_bound_lies_between_its_limits_and_knows_scalings() -> None:
    """Between spectral radius and largest singular value; a matrix that is diagonally similar to another has its mu."""
    random = np.random.default_rng(3)
    M = random.standard_normal((40, 3, 3)) + 1j * random.standard_normal((40, 3, 3))
    bound = mu_bound(M)
    assert np.all(bound <= np.linalg.norm(M, 2, axis=(1, 2)) + 1e-12)
    assert np.all(bound >= np.abs(np.linalg.eigvals(M)).max(axis=1) - 1e-12)
    D = np.diag([1e3, 1.0, 1e-2])
    assert mu_bound(D @ M @ np.linalg.inv(D)) == pytest.approx(bound, rel=2e-3)
    phases = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 73)[:-1])
    p, q = (x.ravel() for x in np.meshgrid(phases, phases))
    delta = np.stack([np.ones_like(p), p, q], axis=1)
    mu = [np.abs(np.linalg.eigvals(m * delta[:, None, :])).max() for m in M[:8]]
    assert bound[:8] == pytest.approx(mu, rel=5e-3)  # exact for three channels, the grid of phases is coarse


@pytest.mark.parametrize("seed", range(6))
def test_against_python_control(seed: int) -> None:
    """Random stable loops: classical margins of `stability_margins`, disk margin on a dense grid, peak S by `norm`."""
    random = np.random.default_rng(seed)
    A = random.standard_normal((4, 4))
    A = A - (np.linalg.eigvals(A).real.max() + 0.3) * np.eye(4)
    plant = plant_of(A, random.standard_normal((4, 1)), random.standard_normal((1, 4)), [[0.0]])
    k = 0.5 / np.abs(plant.to_control()(1j * np.geomspace(1e-3, 1e3, 400))).max()
    found, P = loop_margins(plant, gain_of(k))[0], control.ss(plant.A, plant.B, k * plant.C, 0)
    assert found.stable
    gain, phase, sensitivity, *_ = control.stability_margins(P, returnall=True)
    every = [g for _, g in found.phase_crossovers]
    for g in gain[np.isfinite(gain) & (gain < 1e6)]:
        assert min(abs(g / other - 1.0) for other in every) < TWO_ROUTES
    assert phase.size == len(found.gain_crossovers)
    omega = np.geomspace(1e-4, 1e4, 20001)
    assert found.disk.alpha == pytest.approx(float(control.disk_margins(P, omega)[0]), rel=1e-5)
    S = control.feedback(1, P)
    assert found.sensitivity == pytest.approx(float(control.norm(S, "inf")), rel=1e-5)
    assert found.least_return == pytest.approx(1.0 / found.sensitivity)
    assert sensitivity.size == 0 or found.least_return <= sensitivity.min() * (1.0 + 1e-4)


def test_a_lightly_damped_mode_is_not_missed() -> None:
    """A resonance of zeta = 1e-6 between any two frequencies of a grid: the peak's height is its closed form."""
    zeta, omega = 1e-6, 37.123456
    plant = plant_of([[0, 1], [-(omega**2), -2 * zeta * omega]], [[0], [1]], [[0, 2 * zeta * omega]], [[0]])
    # L = g 2 zeta w s/(s^2 + 2 zeta w s + w^2), L(i w) = g: 1 + L is real there, (1 - L)/(1 + L)/2 with g = -0.9
    one = loop_margins(plant, gain_of(-0.9))[0]
    assert one.disk.alpha == pytest.approx(2.0 * 0.1 / 1.9, rel=1e-6)
    assert one.sensitivity == pytest.approx(10.0, rel=1e-6)
    assert one.gain_up == pytest.approx(1.0 / 0.9, rel=1e-6)


def test_ideal_regulator() -> None:
    """LQR: |1 + L| >= 1, gain from 1/2 to infinity, 60 deg, balanced alpha >= 2/3; the thesis' model at 55 m/s."""
    model, condition = build(read("thesis-simulation")), FlightCondition.at(3048.0, V=55.0)
    still = state_feedback(np.zeros((1, 4)), STATES, ("elevon_command_rad",), None)
    plant = loop_plant(model, condition, still)
    P = solve_continuous_are(plant.A, plant.B, np.eye(4), np.eye(1))
    ideal = loop_margins(plant, state_feedback(plant.B.T @ P, STATES, ("elevon_command_rad",), None))[0]
    assert ideal.least_return == pytest.approx(1.0, abs=1e-6)
    assert ideal.gain_up == math.inf
    assert (ideal.gain_down or 0.0) <= 0.5
    assert math.degrees(ideal.phase or 0.0) >= 60.0
    assert ideal.disk.alpha >= 2.0 / 3.0


def test_exact_delay_of_an_integrator() -> None:
    """k e^(-s tau)/s: gain margin pi/(2 k tau), phase margin pi/2 - k tau, delay margin pi/(2k) - tau."""
    k, tau = 3.0, 0.2
    one = loop_margins(plant_of([[0.0]], [[1.0]], [[1.0]], [[0.0]]), gain_of(k), delay_s=tau)[0]
    assert one.gain_up == pytest.approx(math.pi / (2.0 * k * tau), rel=IDENTITY)
    assert one.phase == pytest.approx(math.pi / 2.0 - k * tau, rel=IDENTITY)
    assert one.delay_s == pytest.approx(math.pi / (2.0 * k) - tau, rel=IDENTITY)
    assert not loop_margins(plant_of([[0.0]], [[1.0]], [[1.0]], [[0.0]]), gain_of(k), delay_s=0.53)[0].stable


def test_sampled_delay_limit_meets_the_continuous_one() -> None:
    """A fast sampled gain on an integrator: the hold is half a sample of delay; exact with fractions of a sample."""
    dt, k = 1e-2, 30.0
    found = largest_delay(plant_of([[0.0]], [[1.0]], [[1.0]], [[0.0]]), gain_of(k, dt))
    assert found == pytest.approx(math.pi / (2.0 * k) - 0.5 * dt, rel=0.02)
    plant = plant_of([[0.0]], [[1.0]], [[1.0]], [[0.0]])
    for extra, stable in ((-1e-6, True), (1e-6, False)):
        assert is_stable(cut_loop(plant, gain_of(k, dt), delay_s=(found or 0.0) + extra)) is stable
    assert largest_delay(plant, gain_of(-1.0, dt)) is None
    with pytest.raises(ValueError, match="continuous plant"):
        largest_delay(plant, gain_of(k))


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("dt", [None, 0.05])
def test_encirclements_count_the_unstable_roots(seed: int, dt: float | None) -> None:
    """Two independent counts agree: det(I + L) around the origin, and eigenvalues of the closed loop."""
    random = np.random.default_rng(seed)
    plant = plant_of(random.standard_normal((4, 4)), random.standard_normal((4, 2)), random.standard_normal((2, 4)),
                     np.zeros((2, 2)))  # fmt: skip
    gain = gain_of(random.standard_normal((2, 2)), dt)
    values = np.linalg.eigvals(closed_loop(plant, gain).A)
    unstable = int(np.sum(values.real > 0.0) if dt is None else np.sum(np.abs(values) > 1.0))
    loop = cut_loop(plant, gain)
    assert unstable_roots(loop) == unstable
    assert is_stable(loop) is (unstable == 0)


def test_encirclements_with_a_delay_meet_a_pade_expansion() -> None:
    """An unstable plant with an exact delay: the count of a 10th-order Pade expansion, across its stability limit."""
    plant = plant_of([[1.0]], [[1.0]], [[1.0]], [[0.0]])
    for tau in (0.1, 0.3, 0.5, 0.6, 0.7, 1.5):
        num, den = control.pade(tau, 10)
        pade = control.feedback(2.0 * control.tf([1], [1, -1]) * control.tf(num, den), 1)
        unstable = int(np.sum(np.asarray(pade.poles()).real > 0.0))
        assert unstable_roots(cut_loop(plant, gain_of(2.0), delay_s=tau)) == unstable


def test_an_unstable_loop_has_no_margin() -> None:
    """It says so instead of measuring a distance."""
    one = loop_margins(THIRD, gain_of(4.0))[0]
    assert not one.stable
    assert (one.gain_up, one.gain_down, one.phase, one.delay_s) == (None, None, None, None)
    assert (one.disk.alpha, one.least_return) == (0.0, 0.0)
    margin = disk_margin(THIRD, gain_of(4.0))
    assert (margin.alpha, margin.frequency, margin.stable) == (0.0, None, False)


@pytest.mark.parametrize("factor", [0.999, 1.001])
def test_margins_are_where_stability_ends(factor: float) -> None:
    """Gains just inside and outside the margins of a sampled loop at 55 m/s; a disk perturbation at its worst."""
    model, condition = build(read("thesis-simulation")), FlightCondition.at(3048.0, V=55.0)
    K = np.array([[-6.783, -1.69, -0.573, -0.916]])

    def stable(f: float) -> bool:
        scaled = state_feedback(f * K, STATES, ("elevon_command_rad",), 0.005)
        return is_stable(cut_loop(loop_plant(model, condition, scaled), scaled))

    one = state_feedback(K, STATES, ("elevon_command_rad",), 0.005)
    margin = loop_margins(loop_plant(model, condition, one), one)[0]
    assert stable((margin.gain_up or 0.0) * factor) is (factor < 1.0)
    assert stable((margin.gain_down or 0.0) / factor) is (factor < 1.0)
    low, high = margin.disk.gain
    assert stable(low * 1.001) and stable(high * 0.999)


def test_margins_fall_with_delay() -> None:
    """A damper at 200 Hz with 5 to 30 ms of computing delay; zero delay in the curve is the loop's own margin."""
    model = build(read("thesis-simulation"))
    damper = Controller(
        A=[], B=[], C=[], D=[[0.1]], inputs=("pitch_rate_rad_s",), outputs=("elevon_command_rad",), dt_s=0.005,
        delay_s=0.005,
    )  # type: ignore[arg-type]  # fmt: skip
    sweep = FlightCondition.at(3048.0, V=[50.0, 60.0])
    curve = margin_curve(model, sweep, damper, altitude=3048.0, delays_s=(0.0, 0.005, 0.0125, 0.03))
    assert np.all(np.diff(curve.alpha, axis=1) < 0.0)
    for i in range(2):
        own = disk_margin(loop_plant(model, sweep[i], damper), damper)
        assert curve.alpha[i, 1] == pytest.approx(own.alpha, rel=IDENTITY)
    with pytest.raises(ValueError, match="delays_s"):
        margin_curve(model, sweep, damper, delays_s=(-0.001,))
    late = replace(model, actuators=(Actuator(control="elevon", omega=400.0, delay_s=0.01),))
    assert total_delay(late, damper) == pytest.approx(0.015)
    whole = margin_curve(late, sweep, damper, delays_s=(0.005, 0.015, 0.02))
    assert np.all(np.isnan(whole.alpha[:, 0]))  # the dead time alone is longer
    assert whole.alpha[:, 1] == pytest.approx(margin_curve(late, sweep, damper).alpha[:, 0], rel=IDENTITY)
    assert np.all(whole.alpha[:, 2] < whole.alpha[:, 1])


def test_refusals() -> None:
    """Batches, unknown channels, unequal rates, another cut."""
    batch = plant_of(np.zeros((1, 1)), [[1.0]], [[1.0]], [[0.0]])
    batch = LinearSystem(
        A=np.zeros((2, 1, 1)), B=np.ones((2, 1, 1)), C=np.ones((2, 1, 1)), D=np.zeros((2, 1, 1)), states=batch.states,
        inputs=batch.inputs, outputs=batch.outputs,
    )  # fmt: skip
    with pytest.raises(ValueError, match="one condition"):
        disk_margin(batch, gain_of(1.0))
    with pytest.raises(ValueError, match="'input', 'output' or 'both'"):
        disk_margin(THIRD, gain_of(1.0), at="elsewhere")  # type: ignore[arg-type]
    odd = Controller(A=[], B=[], C=[], D=[[1.0]], inputs=("y0",), outputs=("v",))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="drives 'v'"):
        disk_margin(THIRD, odd)
    with pytest.raises(ValueError, match="rates must agree"):
        disk_margin(plant_of([[0.5]], [[1.0]], [[1.0]], [[0.0]], dt=0.1), gain_of(1.0, dt=0.2))
    with pytest.raises(ValueError, match="fall off"):
        unstable_roots(cut_loop(plant_of([[-1.0]], [[1.0]], [[1.0]], [[1.0]]), gain_of(1.0), delay_s=0.1))


def test_rules_of_the_standards() -> None:
    """Rows carry what they ask for and pass on the side of it; marked as from memory."""
    model, at = build(read("thesis-simulation")), FlightCondition.at(3048.0, V=1.0)
    damper = Controller(
        A=[], B=[], C=[], D=[[0.1]], inputs=("pitch_rate_rad_s",), outputs=("elevon_command_rad",), dt_s=0.005
    )  # type: ignore[arg-type]
    rows = mil_f_9490d(model, damper, at, V_o=50.0, V_L=60.0)
    assert [row.speed for row in rows] == pytest.approx([50.0, 50.0, 60.0, 60.0, 69.0])
    assert [(row.asked_gain_dB, row.asked_phase_deg) for row in rows[:4]] == [(6, 45), (8, 60), (4.5, 30), (6, 45)]
    assert all("from memory" in row.rule for row in rows)
    loop = loop_margins(loop_plant(model, FlightCondition.at(3048.0, V=50.0), damper), damper)[0]
    every = [abs(20.0 * math.log10(g)) for _, g in loop.phase_crossovers]
    assert min(row.gain_dB or 0.0 for row in rows[:2]) == pytest.approx(min(every))
    assert all(row.passed == (row.gain_dB >= row.asked_gain_dB and row.phase_deg >= row.asked_phase_deg)
               for row in rows[:4] if row.gain_dB is not None and row.phase_deg is not None
               and row.asked_gain_dB is not None and row.asked_phase_deg is not None)  # fmt: skip
    assert rows[4].passed
    lost = mil_f_9490d(model, gain_none(), at, V_o=50.0, V_L=60.0)
    assert not any(row.passed for row in lost)
    assert lost[0].gain_dB is None
    with pytest.raises(ValueError, match="V_o <= V_L"):
        mil_f_9490d(model, damper, at, V_o=70.0, V_L=60.0)
    late = Interval(start=60.0, end=None, frequency=20.0, mode="pitch", kind="flutter")
    assert [row.passed for row in flutter_clearance([late], V_D=51.0, searched_to=80.0)] == [True, False]
    assert [row.passed for row in flutter_clearance([], V_D=51.0, searched_to=60.0)] == [True, False]
    with pytest.raises(ValueError, match="V_D"):
        flutter_clearance([], V_D=0.0, searched_to=60.0)


def gain_none() -> Controller:
    """A controller that does nothing: past flutter the loop is unstable."""
    return Controller(
        A=[], B=[], C=[], D=[[0.0]], inputs=("pitch_rate_rad_s",), outputs=("elevon_command_rad",), dt_s=0.005
    )  # type: ignore[arg-type]


def test_delays_of_controllers_and_of_sampled_plants() -> None:
    """A delay in a continuous controller is one in the loop; a sampled plant takes whole samples more, no fractions."""
    plant = plant_of([[0.0]], [[1.0]], [[1.0]], [[0.0]])
    late = LinearSystem(
        A=[[-50.0]], B=[[50.0]], C=[[-3.0]], D=[[0.0]], states=("z",), inputs=("y0",), outputs=("u0",),
        input_delay_s=0.1,
    )  # type: ignore[arg-type]  # fmt: skip
    prompt = replace(late, input_delay_s=0.0)
    one, two = loop_margins(plant, late)[0], loop_margins(plant, prompt, delay_s=0.1)[0]
    assert one.gain_up == pytest.approx(two.gain_up, rel=IDENTITY)
    assert one.delay_s == pytest.approx((loop_margins(plant, prompt)[0].delay_s or 0.0) - 0.1, rel=1e-6)
    sampled = plant_of([[1.0]], [[0.1]], [[1.0]], [[0.0]], dt=0.1)
    gain = gain_of(2.0, dt=0.1)
    own = loop_margins(sampled, gain)[0]
    shifted = loop_margins(sampled, gain, delay_s=0.1)[0]
    assert shifted.delay_s == pytest.approx((own.delay_s or 0.0) - 0.1, rel=1e-6)
    with pytest.raises(ValueError, match="whole samples"):
        loop_margins(sampled, gain, delay_s=0.05)


def test_a_resonance_crosses_gain_one_between_two_frequencies() -> None:
    """Tops and bottoms of |L| between frequencies of the grid give their crossovers, in pairs."""
    zeta, omega = 1e-5, 20.0
    plant = plant_of([[0, 1], [-(omega**2), -2 * zeta * omega]], [[0], [1]], [[0, 2 * zeta * omega]], [[0]])
    one = loop_margins(plant, gain_of(1.0 + 1e-6))[0]
    assert len(one.gain_crossovers) == 2
    width = omega * zeta * math.sqrt(2e-6)  # |L| = g/sqrt(1 + ((w - w0)/(zeta w0))^2)
    assert [w for w, _ in one.gain_crossovers] == pytest.approx([omega - width, omega + width], abs=0.01 * width)


def test_a_sweep_beyond_a_schedule_is_said() -> None:
    """Dynamic pressures of 100 to 200 Pa; at 1.2 kg/m3 that is 12.9 to 18.3 m/s."""
    from aeroservo.control.closed_flutter import held_notes
    from aeroservo.control.controller import Controller

    own = Controller(
        A=[], B=[], C=[], D=[[[0.0]], [[0.0]]], inputs=("pitch_rad",), outputs=("elevon_rad",), dt_s=0.01,
        pressures=[100.0, 200.0],
    )  # fmt: skip
    assert held_notes(own, FlightCondition(V=[13.0, 18.0], rho=1.2)) == ()
    assert held_notes(own, FlightCondition(V=[13.0, 19.0], rho=1.2))[0].startswith("the schedule is held")
