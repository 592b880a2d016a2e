"""Identification in flight: the recursion against batch least squares, its invariants, and what the supervisor says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from aeroservo.aeroelastic.build import build
from aeroservo.aircraft.files import read
from aeroservo.control.adaptive import WHITE, Adaptation, control_adaptation, recursive_least_squares
from aeroservo.control.controller import state_feedback
from aeroservo.datatypes import FlightCondition
from aeroservo.servo import Actuator
from aeroservo.simulate import _kernels
from aeroservo.simulate.disturbances import Gustiness
from aeroservo.simulate.engine import Simulation, simulate
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario, Stepping
from aeroservo.studies.climb_flight import climb_model, climb_schedule
from aeroservo.studies.control_identification import ACTUAL, identification_study, unexcited_estimate

MODEL = climb_model()
CONDITIONS = FlightCondition.at(3048.0, V=np.linspace(15.0, 130.0, 20))
SCHEDULE = climb_schedule(MODEL, "full state", CONDITIONS)
WIDE = np.full((3, 2), 1e9)


def kernel(
    phi: np.ndarray, y: np.ndarray, *, forget: float = 1.0, ceiling: float = 1e30, robust: float = 0.0,
    bound: float = 1e9, prior: float = 1e8,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # fmt: skip
    """Parameters after each sample, covariance after the last, and its trace after each, of the compiled recursion."""
    n, m = phi.shape[1], y.shape[1]
    root, theta, noise, push = np.sqrt(prior) * np.eye(n), np.zeros((n, m)), np.zeros(m + 1), np.zeros((n, m))
    limit = np.full((n, m), bound)
    out, trace = np.zeros((len(phi), n, m)), np.zeros(len(phi))
    for k in range(len(phi)):
        _kernels.least_squares(phi[k], y[k], forget, ceiling, robust, -limit, limit, root, theta, noise, push)
        out[k], trace[k] = theta, np.sum(root**2)
    return out, root @ root.T, trace


def data(n_t: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Regressors of very different sizes, and targets with noise."""
    rng = np.random.default_rng(seed)
    phi = rng.standard_normal((n_t, 3)) * [1.0, 0.1, 5.0]
    y = phi @ np.array([[1.0, -2.0], [3.0, 0.5], [0.2, 0.0]]) + 0.3 * rng.standard_normal((n_t, 2))
    return phi, y


@pytest.mark.parametrize("forget", [1.0, 0.98])
def test_recursion_is_the_batch_solution_with_the_same_weights(forget: float) -> None:
    """Weighted normal equations, the prior included; the textbook form and the compiled square root alike."""
    phi, y = data(300)
    got, P, _ = kernel(phi, y, forget=forget)
    plain, P_plain = recursive_least_squares(phi, y, forget=forget)
    for k in (5, 60, 299):
        weight = forget ** np.arange(k, -1, -1)
        information = (phi[: k + 1].T * weight) @ phi[: k + 1] + forget ** (k + 1) * 1e-8 * np.eye(3)
        batch = np.linalg.solve(information, (phi[: k + 1].T * weight) @ y[: k + 1])
        np.testing.assert_allclose(got[k], batch, rtol=1e-7, atol=1e-9)
        np.testing.assert_allclose(plain[k], batch, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(P, np.linalg.inv(information), rtol=1e-7)
    np.testing.assert_allclose(P_plain, np.linalg.inv(information), rtol=1e-7)


def test_covariance_stays_positive_over_a_million_steps() -> None:
    """With forgetting and long pauses of excitation: symmetric, positive definite, below its ceiling."""
    rng = np.random.default_rng(4)
    root, theta, noise, push = 1e2 * np.eye(3), np.zeros((3, 2)), np.zeros(3), np.zeros((3, 2))
    least, most = np.inf, 0.0
    size = np.array([1.0, 1e-3, 1e2])
    for block in range(1000):
        phi = rng.standard_normal((1000, 3)) * size
        if block % 3 == 1:
            phi[:, 1:] = 0.0  # one direction alone
        elif block % 3 == 2:
            phi[:] = 0.0
        y = rng.standard_normal((1000, 2))
        for k in range(1000):
            _kernels.least_squares(phi[k], y[k], 0.999, 1e4, 3.0, -WIDE, WIDE, root, theta, noise, push)
        P = root @ root.T
        assert np.array_equal(P, P.T)
        values = np.linalg.eigvalsh(P)
        least, most = min(least, float(values[0])), max(most, float(np.trace(P)))
    assert least > 0.0
    assert most <= 1e4 * (1.0 + 1e-9)
    assert np.all(np.isfinite(theta))


def test_parameters_stay_within_their_bounds() -> None:
    phi, y = data(400)
    got, _, _ = kernel(phi, y, bound=1.5, prior=1e2)
    assert np.all(np.abs(got) <= 1.5)
    assert np.mean(got[50:, 1, 0] == 1.5) > 0.3 and np.mean(got[50:, 0, 1] == -1.5) > 0.3  # free: 3 and -2
    assert abs(got[-1, 2, 0] - 0.2) < 0.05


def test_without_excitation_nothing_is_forgotten_beyond_the_ceiling() -> None:
    phi, y = data(500)
    phi[100:] = 0.0
    trace = kernel(phi, y, forget=0.9, ceiling=50.0, prior=1.0)[2]
    assert np.all(trace <= 50.0 * (1.0 + 1e-12)) and trace[-1] > 40.0


def test_outliers_weigh_less() -> None:
    phi, y = data(600)
    y[300:600:10] += 60.0
    true = np.array([[1.0, -2.0], [3.0, 0.5], [0.2, 0.0]])
    plain, robust = (np.abs(kernel(phi, y, robust=r)[0][-1] - true).max() for r in (0.0, 3.0))
    assert robust < 0.5 * plain


def test_whitening_turns_the_increments_of_a_walks_means_white() -> None:
    """(1 + a/z) is the spectral factor of 1/6, 4/6, 1/6; sampled means of a fine random walk come out uncorrelated."""
    factor = np.array([1.0, WHITE])
    np.testing.assert_allclose(factor[0] * factor[1] / (factor @ factor), 0.25, rtol=1e-14)
    rng = np.random.default_rng(0)
    walk = np.cumsum(rng.standard_normal(20 * 100_000)).reshape(-1, 20).mean(axis=1)
    from scipy.signal import lfilter

    out = lfilter([1.0, -1.0], factor, walk)[50:]
    plain = np.diff(walk)
    lag = [float(x[1:] @ x[:-1] / (x @ x)) for x in (plain, out)]
    assert lag[0] == pytest.approx(0.25, abs=0.01)
    assert abs(lag[1]) < 0.01


def test_the_filter_explains_a_flight_without_gusts() -> None:
    """No turbulence: what is left over is the elevon's own effect, 0.7 and 1.3 times the model's.

    Only the quadrature over a sample is between: 0.3 % for a smooth oscillation, 0.6 % for the square wave,
    whose kinks the parabola through three samples does not see.
    """
    aircraft = climb_model(lift_effect=0.7, moment_effect=1.3)
    square = control_adaptation(MODEL, SCHEDULE, CONDITIONS)
    sine = replace(square, dither=np.radians(3.0) * np.sin(2.0 * np.pi * np.arange(20) / 20.0)[:, None])
    for made, bound in ((sine, 0.003), (square, 0.006)):
        run = fly(aircraft, made, turbulence=None, duration=6.0, kick=0.0)
        assert run.adaptation is not None
        np.testing.assert_allclose(run.adaptation.data[-1, :2], [0.7, 1.3], rtol=bound)
        assert run.adaptation["identified"][-1] == 1.0


def fly(
    aircraft: object,
    adaptation: Adaptation,
    *,
    turbulence: float | None,
    duration: float,
    V: float = 53.0,
    kick: float = 0.01,
) -> Simulation:
    """A straight flight with the adaptive schedule, disturbed at the start."""
    scenario = Scenario(
        profile=level(V, altitude=3048.0), duration=duration, controller=SCHEDULE, adaptation=adaptation,
        turbulence=None if turbulence is None else Gustiness(level=turbulence), initial=(("pitch_rad", kick),),
    )  # fmt: skip
    return simulate(aircraft, scenario, stepping=Stepping(record_s=0.005))  # type: ignore[arg-type]


def test_estimates_within_ten_per_cent_after_five_seconds_of_light_turbulence() -> None:
    """At 40, 53 and 70 m/s in closed loop, also where the elevon has 0.7 of the lift it should have; 10 seeds."""
    study = identification_study(seeds=range(10))
    assert study.lost == 0 and np.all(study.identified)
    assert np.abs(study.error[0]).max() < 0.10
    within = np.all(np.abs(study.error) < 0.10, axis=-1)
    assert within.mean() > 0.98
    spread = np.sqrt(np.mean(study.error**2, axis=2))  # against what the supervisor states
    stated = study.stated.mean(axis=2) / np.array(ACTUAL)[:, None, :]
    assert np.all(spread < 1.6 * stated) and np.all(stated < 2.0 * spread)
    assert np.abs(np.mean(study.error, axis=2)).max() < 0.02  # no bias from the feedback
    assert np.all(study.gain[1] > 1.3) and np.all(study.gain[2] < 0.9)  # the loop's gain is restored


def test_without_excitation_it_is_not_identifiable_and_the_schedule_flies_as_it_is() -> None:
    identified, gains = unexcited_estimate(duration=10.0)
    assert identified == 0.0
    np.testing.assert_array_equal(gains, [1.0, 1.0])


def test_an_unidentified_adaptation_is_the_schedule_bit_by_bit() -> None:
    """Same run, with and without: gain 1 and no oscillation leave every sample alone."""
    never = replace(control_adaptation(MODEL, SCHEDULE, CONDITIONS, dither=0.0), accuracy=1e-12)
    scenario = Scenario(
        profile=level(60.0, altitude=3048.0), duration=2.0, controller=SCHEDULE, turbulence=Gustiness(level=1.0)
    )  # fmt: skip
    alone = simulate(MODEL, scenario, seed=3)
    beside = simulate(MODEL, replace(scenario, adaptation=never), seed=3)
    assert alone.history is not None and beside.history is not None
    np.testing.assert_array_equal(alone.history.data, beside.history.data)
    assert alone.adaptation is None and beside.adaptation is not None
    assert not np.any(beside.adaptation["identified"])


def test_gains_are_bounded_and_slow() -> None:
    """An elevon with a fifth of its effect: the estimate stays at its bound, the gain at 2, by 0.25 a second."""
    made = control_adaptation(MODEL, SCHEDULE, CONDITIONS)
    run = fly(climb_model(lift_effect=0.2, moment_effect=0.2), made, turbulence=0.5, duration=8.0, V=40.0)
    assert run.adaptation is not None
    told = run.adaptation
    assert np.all((told.data[:, :2] >= 0.3) & (told.data[:, :2] <= 3.0))
    assert told["effect_pitch"].min() == 0.3 and told["effect_pitch"][-400:].max() < 0.303
    assert np.all((told["gain"] >= 0.5) & (told["gain"] <= 2.0)) and told["gain"].max() == 2.0
    assert np.abs(np.diff(told["gain"])).max() <= 0.25 * 0.005 * (1.0 + 1e-9)


def test_too_little_excitation_is_not_identifiable_however_sharp_the_estimate() -> None:
    """The deflection moves, but less than asked for: the gain stays 1, and so the schedule as it is."""
    made = replace(control_adaptation(MODEL, SCHEDULE, CONDITIONS), quiet=np.radians(0.5))
    run = fly(climb_model(lift_effect=0.7, moment_effect=0.7), made, turbulence=1.0, duration=6.0)
    assert run.adaptation is not None
    assert not np.any(run.adaptation["identified"]) and np.all(run.adaptation["gain"] == 1.0)
    assert run.warnings[-1].startswith("the effect of the controls was not identifiable during 100 % of the run")


def test_pieces_of_a_run_are_one_run(monkeypatch: pytest.MonkeyPatch) -> None:
    from aeroservo.simulate import engine

    made = control_adaptation(MODEL, SCHEDULE, CONDITIONS)
    whole = fly(MODEL, made, turbulence=None, duration=1.5)
    monkeypatch.setattr(engine, "PIECE", 257)
    cut = fly(MODEL, made, turbulence=None, duration=1.5)
    assert whole.adaptation is not None and cut.adaptation is not None
    np.testing.assert_array_equal(whole.adaptation.data, cut.adaptation.data)
    assert len(whole.adaptation.t) == 301


def test_what_it_cannot_do_is_refused() -> None:
    names = ("pitch_rad", "pitch_rate_rad_s")
    blind = state_feedback([[0.1, 0.1]], names, ("elevon_command_rad",), 0.005)
    one = FlightCondition.at(3048.0, V=[50.0])
    with pytest.raises(ValueError, match="must measure plunge_m"):
        control_adaptation(MODEL, blind, one)
    with pytest.raises(ValueError, match="condition for each point"):
        control_adaptation(MODEL, SCHEDULE, one)
    bact = build(read("bact"))
    bact = replace(bact, actuators=(Actuator(control="elevon", omega=165.0, zeta=0.7),))
    full = (*names, "plunge_m", "plunge_rate_m_s", "elevon_rad")
    with pytest.raises(ValueError, match="rate or inertia terms"):
        control_adaptation(bact, state_feedback(np.zeros((1, 5)), full, ("elevon_command_rad",), 0.005), one)
    with pytest.raises(ValueError, match="no control"):
        other = (*names, "plunge_m", "plunge_rate_m_s", "flap_rad")
        control_adaptation(MODEL, state_feedback(np.zeros((1, 5)), other, ("flap_command_rad",), 0.005), one)
    goland = build(read("goland"), "jones")
    with pytest.raises(ValueError, match="without lags"):
        control_adaptation(goland, blind, one)
    with pytest.raises(ValueError, match="dither"):
        control_adaptation(MODEL, SCHEDULE, CONDITIONS, dither_samples=1)
    made = control_adaptation(MODEL, SCHEDULE, CONDITIONS)
    profile = level(50.0, altitude=3048.0)
    with pytest.raises(ValueError, match="its controller too"):
        Scenario(profile=profile, duration=1.0, adaptation=made)
    with pytest.raises(ValueError, match="another controller"):
        Scenario(profile=profile, duration=1.0, controller=blind, adaptation=made)
    for change, words in (
        ({"effects": ("a",)}, "name 2 parameters"),
        ({"lower": np.zeros((2, 2))}, "lower must have shape"),
        ({"force": 0.0 * made.force}, "force must not be zero"),
        ({"lower": 2.0 * made.start}, "between lower and upper"),
        ({"scaled": ()}, "one truth"),
        ({"memory_s": 0.0}, "memory_s"),
        ({"gains": (1.5, 2.0)}, "enclose 1"),
    ):
        with pytest.raises(ValueError, match=words):
            replace(made, **change)  # type: ignore[arg-type]
    for arguments, words in (
        (((np.zeros(3), np.zeros((3, 1)))), "tables of equal length"),
        (((np.zeros((3, 1)), np.zeros((3, 1)))), "forget"),
    ):
        with pytest.raises(ValueError, match=words):
            recursive_least_squares(*arguments, forget=2.0)
    with pytest.raises(ValueError, match="start must have shape"):
        recursive_least_squares(np.zeros((3, 1)), np.zeros((3, 1)), start=np.zeros((2, 1)))
