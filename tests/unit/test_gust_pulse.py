"""Peaks in 1-cosine gusts against an adaptive solver, zones, rates, and how well the critical gradient is found."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from aeroservo.gust.critical import critical_gradient
from aeroservo.gust.pulse import pulse_peaks
from aeroservo.gust.response import frequency_response, rms_response
from aeroservo.gust.sampling import stationary_covariance
from aeroservo.gust.turbulence import cs25_turbulence, vertical_filter

V = 50.0
#: Tops of parabolas through samples at a twentieth of the shortest period, against a solver's dense output.
TWO_ROUTES = 1e-5


def oscillator(frequency: float, damping: float, zones: int = 1) -> tuple[np.ndarray, ...]:
    """Displacement, rate and acceleration of a mass on a spring that every zone pushes alike."""
    w2, d = frequency**2, 2.0 * damping * frequency
    A = np.array([[0.0, 1.0], [-w2, -d]])
    B = np.array([[0.0] * zones, [w2 / zones] * zones])
    return A, B, np.array([[1.0, 0.0], [0.0, 1.0], [-w2, -d]]), np.vstack([np.zeros((2, zones)), B[1:]])


def solved(plant: tuple[np.ndarray, ...], amplitude: float, length: float, offsets: np.ndarray) -> np.ndarray:
    """Outputs on a fine grid by DOP853, restarted at every corner of every zone's gust."""
    A, B, C, D = plant

    def gusts(t: float) -> np.ndarray:
        x = V * t - offsets
        return np.where((x > 0.0) & (x < length), 0.5 * amplitude * (1.0 - np.cos(2.0 * np.pi * x / length)), 0.0)

    corners = np.unique(
        np.concatenate([[0.0], offsets / V, (offsets + length) / V, [(length + offsets.max()) / V + 3]])
    )
    state, rows = np.zeros(len(A)), []
    for a, b in pairwise(corners):
        run = solve_ivp(
            lambda t, x: A @ x + B @ gusts(t), (a, b), state, method="DOP853", rtol=1e-11, atol=1e-13, dense_output=True
        )
        t = np.linspace(a, b, 20_001)
        rows.append(C @ run.sol(t) + D @ np.stack([gusts(s) for s in t], axis=1))
        state = run.y[:, -1]
    return np.concatenate(rows, axis=1)


@pytest.mark.parametrize(("frequency", "damping"), [(20.0, 0.05), (3.0, 0.4), (150.0, 0.01)])
def test_peaks_of_an_oscillator(frequency: float, damping: float) -> None:
    """Three gusts at once, each against the solver; extremes of both signs."""
    plant = oscillator(frequency, damping)
    lengths, amplitudes = np.array([6.0, 20.0, 70.0]), np.array([1.0, -2.0, 3.0])
    found = pulse_peaks(plant, amplitudes, lengths, V)
    for i, (w0, length) in enumerate(zip(amplitudes, lengths)):
        y = solved(plant, w0, length, np.zeros(1))
        scale = np.abs(y).max(axis=1)
        assert np.abs(found.peak[i] - scale).max() < TWO_ROUTES * scale.max()
        assert np.all(np.abs(found.highest[i] - np.maximum(y.max(axis=1), 0.0)) < TWO_ROUTES * scale)
        assert np.all(np.abs(found.lowest[i] - np.minimum(y.min(axis=1), 0.0)) < TWO_ROUTES * scale)


def test_zones_meet_the_gust_in_turn() -> None:
    """Two zones half a gust apart, the foremost ahead of the reference point."""
    plant, offsets = oscillator(12.0, 0.1, zones=2), np.array([-2.0, 7.37])
    found = pulse_peaks(plant, 1.0, 18.0, V, x_offset=offsets).peak[0]
    y = np.abs(solved(plant, 1.0, 18.0, offsets - offsets.min())).max(axis=1)
    np.testing.assert_allclose(found, y, rtol=TWO_ROUTES)
    together = pulse_peaks(plant, 1.0, 18.0, V).peak[0]
    np.testing.assert_allclose(together, pulse_peaks(oscillator(12.0, 0.1), 1.0, 18.0, V).peak[0], rtol=1e-12)
    assert abs(found[0] / together[0] - 1.0) > 0.02


def test_outputs_that_feel_the_rate_of_the_gust() -> None:
    """An output w' alone peaks at pi w0 V / L."""
    still = (np.array([[-1.0]]), np.zeros((1, 1)), np.zeros((1, 1)), np.zeros((1, 1)))
    found = pulse_peaks(still, 2.0, [10.0, 40.0], V, rate=[[1.0]])
    np.testing.assert_allclose(found.peak[:, 0], np.pi * 2.0 * V / np.array([10.0, 40.0]), rtol=1e-6)


def test_long_gusts_are_steady_and_short_ones_an_impulse() -> None:
    """L -> infinity: the static gain; L -> 0: w0 L/(2V) times the peak of the impulse response."""
    plant = oscillator(20.0, 0.3)
    assert pulse_peaks(plant, 1.0, 3e3, V).peak[0, 0] == pytest.approx(1.0, abs=1e-4)
    z, w = 0.3, 20.0
    root = np.sqrt(1.0 - z * z)
    impulse = w * np.exp(-z / root * np.arctan2(root, z))  # largest displacement after a unit impulse on w^2
    assert pulse_peaks(plant, 1.0, 0.1, V).peak[0, 0] == pytest.approx(0.1 / 2.0 / V * impulse, rel=1e-4)


def test_peak_against_gradient_has_its_maximum_to_a_thousandth() -> None:
    """The critical gradient of an oscillator under CS-25's growth of the gust, against 1,001 gradients around it."""
    plant = oscillator(6.0, 0.05)

    def response(H: np.ndarray) -> np.ndarray:
        return pulse_peaks(plant, (H / 107.0) ** (1.0 / 6.0), 2.0 * H, V).peak

    found = critical_gradient(response, tolerance=1e-3)
    assert not found.at_limit[0]
    for j in range(2):
        scan = np.linspace(0.9 * found.gradient[j], 1.1 * found.gradient[j], 1001)
        best = scan[response(scan)[:, j].argmax()]
        assert found.gradient[j] == pytest.approx(best, rel=1e-3)
    assert found.gradients.size < 120


def test_search_is_frugal_and_knows_the_ends() -> None:
    """Smooth, kinked and monotone curves; what was evaluated is returned."""
    calls: list[int] = []

    def counted(H: np.ndarray) -> np.ndarray:
        calls.append(H.size)
        return np.stack([np.exp(-(np.log(H / 31.0) ** 2)), 90.0 - np.abs(H - 47.3), H, 1.0 / H], axis=1)

    found = critical_gradient(counted, tolerance=1e-3)
    np.testing.assert_allclose(found.gradient, [31.0, 47.3, 107.0, 9.0], rtol=1e-3)
    assert found.at_limit.tolist() == [False, False, True, True]
    assert sum(calls) == found.gradients.size < 70


@pytest.mark.parametrize("n", [1, 7, 60])
def test_frequency_response_by_one_triangle(n: int) -> None:
    """Schur's form for all frequencies, against a solve at each; defective systems (equal lags) included."""
    rng = np.random.default_rng(n)
    A = rng.normal(size=(n, n)) - 2.0 * n * np.eye(n)
    if n > 4:
        A[:4] = 0.0
        A[:4, :4] = -3.0 * np.eye(4) + np.diag(np.ones(3), 1)  # a Jordan block
    B, C, D = rng.normal(size=(n, 2)), rng.normal(size=(3, n)), rng.normal(size=(3, 2))
    omega = np.geomspace(0.01, 1e3, 9)
    H = frequency_response((A, B, C, D), omega)
    for i, w in enumerate(omega):
        np.testing.assert_allclose(H[i], C @ np.linalg.solve(1j * w * np.eye(n) - A, B) + D, rtol=1e-9, atol=1e-12)


def test_rms_of_zones_apart() -> None:
    """Two zones late by different times: Lyapunov with e^(A tau), against the frequency integral with its phase."""
    plant = oscillator(9.0, 0.1, zones=2)
    plant = (plant[0], plant[1] * [1.0, -0.4], plant[2], plant[3] * [1.0, -0.4])
    gust = vertical_filter(cs25_turbulence(), V, model="von_karman")
    shaping = (gust.A, gust.B, np.tile(gust.C, (2, 1)), np.zeros((2, 1)))
    for delays in ([0.0, 0.08], [0.3, 0.1]):
        exact = rms_response(plant, shaping, delays=delays)
        low, high = np.geomspace(1e-5, 1.0, 3000), np.geomspace(60.0, 1e5, 4000)
        omega = np.concatenate([low, np.linspace(1.0, 60.0, 60_000)[1:-1], high])
        H = np.einsum("wym,wm->wy", frequency_response(plant, omega), np.exp(-1j * omega[:, None] * np.array(delays)))
        psd = np.abs(frequency_response((gust.A, gust.B, gust.C, gust.D), omega)[:, 0, 0]) ** 2 / np.pi
        density = np.abs(H) ** 2 * psd[:, None]
        total = np.sqrt(np.trapezoid(density, omega, axis=0) + density[0] * omega[0])
        np.testing.assert_allclose(exact[:2], total[:2], rtol=1e-4)
    same = rms_response(plant, shaping, delays=[0.2, 0.2])
    np.testing.assert_allclose(same, rms_response(plant, shaping), rtol=1e-12)
    P = stationary_covariance(gust.A, gust.B)
    assert (gust.C @ P @ gust.C.T)[0, 0] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: pulse_peaks(oscillator(3.0, -0.1), 1.0, 10.0, V), "must be stable"),
        (lambda: pulse_peaks(oscillator(3.0, 0.1), 1.0, 0.0, V), r"gust length must be positive \[m\]"),
        (lambda: pulse_peaks(oscillator(3.0, 0.1), 1.0, 10.0, 0.0), r"airspeed V must be positive \[m/s\]"),
        (lambda: pulse_peaks(oscillator(3.0, 0.1), 1.0, 10.0, V, rate=np.zeros((2, 1))), "shapes"),
        (lambda: rms_response(oscillator(3.0, 0.1, 2), oscillator(3.0, 0.1), delays=[0.0, 1.0]), "delays and outputs"),
    ],
)  # fmt: skip
def test_bad_input_says_why(call, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        call()
