"""Gain schedules: exact at their points, without bumps between, stable where the check says so, cheap; the switch."""

from __future__ import annotations

import time

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from aeroservo.control.closed_loop import closed_loop, loop_plant
from aeroservo.control.controller import Controller, read_controller, state_feedback, write_controller
from aeroservo.control.lqg import GYRO_RECOVERY
from aeroservo.control.lqr import FULL_STATE
from aeroservo.control.plant import design_plant
from aeroservo.control.response import controller_response
from aeroservo.control.schedule import command_limits, design_schedule, refined, schedule_check, switched
from aeroservo.datatypes import FlightCondition
from aeroservo.studies.climb_flight import FULL_STATE_SENSORS, climb_model
from aeroservo.studies.schedule_margins import margin_against_delay, schedule_margins, speed_with_margin
from aeroservo.studies.switching import sinusoidal_airspeed, switch_study

MODEL = climb_model()
SPEEDS = FlightCondition.at(3048.0, V=np.linspace(15.0, 130.0, 24))


def schedule(conditions: FlightCondition = SPEEDS) -> Controller:
    """Full state, 200 Hz, one sample of delay."""
    return design_schedule(
        MODEL, FULL_STATE, conditions, rate_Hz=200.0, delay_samples=1, sensors=FULL_STATE_SENSORS
    )  # fmt: skip


def test_each_point_is_the_design_at_that_point() -> None:
    whole = schedule()
    assert np.array_equal(whole.pressures, SPEEDS.q)
    assert whole.delay_s == 0.005 and whole.limits == pytest.approx((np.radians(20.0),))
    for i in (0, 11, 23):
        plant = design_plant(MODEL, SPEEDS[i], rate_Hz=200.0, delay_samples=1, sensors=FULL_STATE_SENSORS)
        alone = FULL_STATE(plant).as_controller()
        for name in (*"ABCD", "windup"):
            np.testing.assert_allclose(getattr(whole, name)[i], getattr(alone, name)[0], rtol=1e-8, atol=1e-10)


def test_coordinates_are_the_same_at_all_points() -> None:
    """Physical states: no matrix entry jumps or turns its sign from point to point; twice the points, half the step."""

    def steps(points: int) -> float:
        c = design_schedule(
            MODEL, GYRO_RECOVERY, FlightCondition.at(3048.0, V=np.linspace(15.0, 120.0, points)), rate_Hz=200.0,
            delay_samples=1, sensors=("gyro",),
        )  # fmt: skip
        parts = [np.abs(np.diff(x, axis=0)).max(axis=0) / np.ptp(x, axis=0).clip(1e-9) for x in (c.A, c.B, c.C, c.D)]
        return max(float(p.max(initial=0.0)) for p in parts)

    coarse, fine = steps(40), steps(80)
    assert fine < 0.62 * coarse < 0.25


def test_commands_pass_points_without_bumps() -> None:
    """Under constant measurements a command changes with pressure continuously, and its slope by 1 % of the whole."""
    c = schedule()
    y = np.tile([[0.05, 0.02, 0.1, -0.2, 0.05]], (1, 1))
    for i in (1, 8, 16):
        q = c.pressures[i]
        near = [controller_response(c, y, [q + d])[0][0, 0] for d in (-1e-6 * q, 0.0, 1e-6 * q)]
        assert abs(near[2] - near[0]) < 1e-5 * max(abs(near[1]), 0.01)
        assert abs(near[2] - 2.0 * near[1] + near[0]) < 1e-7


def test_stability_between_points_is_found_and_refuted() -> None:
    """Second route: one eigenvalue problem at one condition. Two far points are stable, and not what is between."""
    ends = FlightCondition.at(3048.0, V=[15.0, 130.0])
    assert schedule_check(MODEL, schedule(ends), ends, between=0).stable
    between = schedule_check(MODEL, schedule(ends), ends, between=9)
    assert not between.stable and 40.0 < between.speeds[between.worst] < 100.0
    dense = schedule_check(MODEL, schedule(), SPEEDS)
    assert dense.stable and len(dense.decay) == 24 + 23 * 4
    assert dense.sentence().startswith("stable at all 116 conditions")
    here = FlightCondition.at(3048.0, V=62.5)
    c = schedule()
    loop = closed_loop(loop_plant(MODEL, here, c), c, pressure=float(here.q))
    alone = schedule_check(MODEL, c, FlightCondition(V=[62.5], rho=[float(here.rho)], a_sound=[float(here.a_sound)]))
    assert alone.decay[0] == pytest.approx(-np.log(np.abs(np.linalg.eigvals(loop.A)).max()) / 0.005, rel=1e-9)
    still = state_feedback([[0.0]], ("pitch_rate_rad_s",), ("elevon_command_rad",), 0.005)
    open_loop = schedule_check(MODEL, still, FlightCondition.at(3048.0, V=[40.0, 60.0]), between=3)
    onset = np.interp(0.0, -open_loop.decay, open_loop.speeds)
    assert 44.0 < onset < 47.5  # flutter at 45.39 m/s, targets.json; five speeds 5 m/s apart
    assert not open_loop.stable and open_loop.worst == 4
    assert open_loop.frequency[1] == pytest.approx(22.45, abs=0.5)
    assert "unstable at 3 of 5" in open_loop.sentence()


def test_other_altitudes_than_the_designed_ones() -> None:
    """Scheduled over dynamic pressure alone, designed at 3,048 m, flown at sea level and at 6,000 m."""
    c = schedule()
    for altitude in (0.0, 6000.0):
        top = 110.0 if altitude == 0.0 else 140.0
        assert schedule_check(MODEL, c, FlightCondition.at(altitude, V=np.linspace(15.0, top, 15))).stable


def test_a_schedule_survives_its_file(tmp_path) -> None:  # type: ignore[no-untyped-def]
    c = schedule()
    write_controller(tmp_path / "s.json", c)
    back = read_controller(tmp_path / "s.json")
    for name in (*"ABCD", "windup", "pressures"):
        np.testing.assert_array_equal(getattr(back, name), getattr(c, name))


def test_two_hundred_points_cost_at_most_three_times_their_riccati_equations() -> None:
    """Plants, gains, residuals and closed loops against scipy's bare solver on the same plants; the best of three."""
    conditions = FlightCondition.at(3048.0, V=np.linspace(15.0, 130.0, 200))
    plant = design_plant(MODEL, conditions, rate_Hz=200.0, delay_samples=1, sensors=FULL_STATE_SENSORS)
    n = plant.A.shape[-1]
    Q, R = np.zeros((n, n)), np.diag(FULL_STATE.R)
    Q[:4, :4] = np.diag(FULL_STATE.Q)
    own, bare = [], []
    for _ in range(3):
        start = time.perf_counter()
        schedule(conditions)
        middle = time.perf_counter()
        for i in range(200):
            solve_discrete_are(plant.A[i], plant.B[i], Q, R)
        own.append(middle - start)
        bare.append(time.perf_counter() - middle)
    assert min(own) <= 3.0 * min(bare)


def test_margins_reach_what_was_measured_before() -> None:
    """Issue 7's table, all four rows; the gyro with recovery keeps 0.55 at 120 m/s and 6 dB / 45 deg to 80 m/s."""
    rows = schedule_margins()
    for row in rows:
        assert np.all(row.alpha >= np.array(row.wanted)), row.name
        stable = row.check.decay > 0.0
        assert np.all(stable | (np.abs(row.check.speeds - 124.05) < 1.5)), row.name
    assert rows[0].check.stable
    assert rows[2].alpha[-1] >= 0.55
    assert rows[2].gain_dB[2] >= 6.0 and rows[2].phase[2] >= np.radians(45.0)
    assert speed_with_margin(step=5.0) >= 80.0


def test_margins_fall_with_delay_at_every_speed() -> None:
    alpha = margin_against_delay((1, 3, 6), (50.0, 80.0, 120.0), points=20)
    assert np.all(np.diff(alpha, axis=0) < 0.0) and np.all(np.diff(alpha, axis=1) < 0.0) and np.all(alpha > 0.25)


def test_the_gyro_cannot_hold_the_wing_at_divergence() -> None:
    """Its zero at s = 0 meets the root there: neutral at 124.05 m/s (targets.json), whatever the design."""
    c = design_schedule(MODEL, GYRO_RECOVERY, SPEEDS, rate_Hz=200.0, delay_samples=1, sensors=("gyro",))
    near = schedule_check(MODEL, c, FlightCondition.at(3048.0, V=np.linspace(123.55, 124.55, 41)), between=0)
    assert abs(near.decay[near.worst]) < 0.05 and near.frequency[near.worst] < 1e-6
    assert near.speeds[np.argmin(np.abs(near.decay))] == pytest.approx(124.05, abs=0.2)


def test_the_switch_oscillates_the_schedule_does_not_and_reversed_gains_are_lost() -> None:
    """Thesis 10.3: about 50 m/s the switch stays stable, with jumps; turning every sign there loses the wing."""
    smooth, switch, reverse = switch_study(duration=16.0)
    assert smooth.lost_at_s is None and switch.lost_at_s is None
    assert reverse.lost_at_s is not None and reverse.lost_at_s < 1.5
    assert reverse.decay < 0.0 < switch.decay < smooth.decay
    assert switch.jump_at_switch > 10.0 * smooth.jump_at_switch
    assert switch.largest_step > 5.0 * smooth.largest_step


def test_a_switch_changes_at_its_pressure_alone() -> None:
    soft, hard = (state_feedback([[k]], ("y",), ("u",), 0.1) for k in (1.0, 4.0))
    both = switched(soft, hard, 1500.0)
    got = controller_response(both, np.ones((4, 1)), [0.0, 1500.0, np.nextafter(1500.0, 2e3), 1e5])[0][:, 0]
    np.testing.assert_array_equal(got, [-1.0, -1.0, -4.0, -4.0])
    for other, pressure in ((state_feedback([[1.0]], ("z",), ("u",), 0.1), 1.0), (hard, -1.0), (both, 1.0)):
        with pytest.raises(ValueError, match="switch"):
            switched(soft, other, pressure)


def test_bad_schedules_are_refused() -> None:
    for V, words in (([50.0], "row of 2 to"), ([60.0, 50.0], "ascending"), (np.full((2, 2), 50.0), "row of 2 to")):
        with pytest.raises(ValueError, match=words):
            schedule(FlightCondition.at(0.0, V=V))
    with pytest.raises(ValueError, match="rate_Hz"):
        design_schedule(MODEL, FULL_STATE, SPEEDS, rate_Hz=0.0)
    continuous = state_feedback([[0.0]], ("pitch_rate_rad_s",), ("elevon_command_rad",), None)
    with pytest.raises(ValueError, match="sampled"):
        schedule_check(MODEL, continuous, SPEEDS)
    with pytest.raises(ValueError, match="row"):
        schedule_check(MODEL, schedule(), SPEEDS[0])
    with pytest.raises(ValueError, match="amplitude"):
        sinusoidal_airspeed(amplitude=60.0)
    assert command_limits(MODEL, ("elevon_rad", "flap_command_rad")) == (pytest.approx(np.radians(20.0)), 0.0)
    assert refined(SPEEDS, 0).V.shape == (24,)
