"""Rational fits of samples: what must be exact, what is reported, what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from aeroservo.aero.rational import fit_rational
from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.flutter import PK, P, flutter
from aeroservo.aircraft.files import read
from aeroservo.datatypes import AeroInput, FlightCondition, RationalAero, SampledAero

INPUTS = (AeroInput(name="h", kind="mode"), AeroInput(name="theta", kind="mode"), AeroInput(name="gust", kind="gust"))


def rational(lags, mach=(0.0,), seed=2):
    """Random Roger air forces with the given poles, nothing but lags on the gust."""
    rng = np.random.default_rng(seed)
    n_mach, n, n_in = len(mach), 2, 3
    A = rng.normal(size=(3, n_mach, n, n_in))
    A[1:, ..., 2] = 0.0
    D = rng.normal(size=(n_mach, n, n_in * len(lags)))
    E = np.tile(np.eye(n_in), (len(lags), 1))
    return RationalAero(
        A0=A[0],
        A1=A[1],
        A2=A[2],
        b=0.5,
        inputs=INPUTS,
        mach=np.array(mach),
        lags=np.repeat(lags, n_in),
        lag_D=D,
        lag_E=E,
    )


def samples(aero, k):
    return SampledAero(k=k, mach=aero.mach, Q=np.stack([aero(k, m) for m in aero.mach]), b=aero.b, inputs=aero.inputs)


@pytest.mark.parametrize("mach", [(0.0,), (0.2, 0.5, 0.7)])
def test_rational_air_forces_are_found_again(mach):
    lags = np.array([0.05, 0.3, 1.1])
    exact = rational(lags, mach)
    fit = fit_rational(samples(exact, np.linspace(0.0, 2.0, 41)), lags=lags)
    assert fit.error < 1e-10
    p = np.array([0.1j, 0.3 + 0.4j, -0.02 + 1.0j])  # off the axis too: the poles are the same
    for m in mach:
        np.testing.assert_allclose(fit.aero.laplace(p, m), exact.laplace(p, m), rtol=1e-7, atol=1e-8)


def test_steady_forces_stay_exact_and_gusts_get_no_impulse():
    model = build(read("goland"), "theodorsen")
    fit = fit_rational(model.aero)
    np.testing.assert_allclose(fit.aero(0.0), model.aero(0.0), rtol=0, atol=1e-14)
    gust = fit.aero.columns("gust")
    assert not np.any(fit.aero.A1[..., gust])
    assert not np.any(fit.aero.A2[..., gust])


def test_error_is_the_largest_over_the_samples_of_each_column():
    model = build(read("nasa-typical-section"), "theodorsen")
    fit = fit_rational(model.aero)
    k = model.aero.k[model.aero.k <= fit.k_max]
    off = np.abs(fit.aero(k) - model.aero(k)).max(axis=(0, 1))
    largest = np.abs(model.aero(k)).max(axis=(0, 1))
    np.testing.assert_allclose(fit.column_errors, off / np.where(largest > 0.0, largest, 1.0), rtol=1e-9, atol=1e-15)
    assert fit.error == fit.column_errors.max()
    assert fit.worst_input == model.aero.inputs[int(np.argmax(fit.column_errors))].name
    assert fit.k_max == 3.0


def test_more_poles_fit_no_worse():
    model = build(read("nasa-typical-section"), "theodorsen")
    errors = [fit_rational(model.aero, lags=np.geomspace(0.01, 3.0, n)).error for n in (2, 4, 8)]
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.01  # the contract's bound of a fit


def test_fitted_flutter_approaches_that_of_the_samples():
    model = build(read("nasa-typical-section"), "theodorsen")
    sweep = FlightCondition(V=np.linspace(10.0, 90.0, 9), rho=1.225)
    exact, fitted = flutter(model, sweep, PK()), flutter(model, sweep, P())
    assert fitted.fit is not None
    assert exact.fit is None
    # the speed is off by no more than the forces are
    assert fitted.flutter_speed == pytest.approx(exact.flutter_speed, rel=fitted.fit.error)
    assert fitted.divergence_speed == pytest.approx(exact.divergence_speed, rel=1e-12)
    with pytest.raises(ValueError, match=r"off by .* % of the largest"):
        flutter(model, sweep, P(fit_bound=1e-9))


def test_constant_columns_take_no_lags():
    k = np.linspace(0.0, 2.0, 21)
    Q = np.ones((1, 21, 2, 3), dtype=complex)
    Q[..., 1] = 1.0 / (1.0 + 1j * k)[None, :, None]
    fit = fit_rational(SampledAero(k=k, Q=Q, b=1.0, inputs=INPUTS))
    assert not np.any(fit.aero.lag_E[:, [0, 2]])
    np.testing.assert_allclose(fit.aero(k)[..., [0, 2]], 1.0, rtol=0, atol=1e-14)


def test_refusals():
    k = np.array([0.0, 0.1, 0.2])
    Q = (1.0 + 1j * k)[None, :, None, None] * np.ones((1, 3, 2, 3))
    few = SampledAero(k=k, Q=Q, b=1.0, inputs=INPUTS)
    with pytest.raises(ValueError, match="needs 5 or more reduced frequencies"):
        fit_rational(few)
    with pytest.raises(ValueError, match="positive"):
        fit_rational(few, lags=np.array([-0.1]))
