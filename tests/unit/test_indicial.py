"""Wagner's, Küssner's and Sears' functions: transforms of one another, limits, and the approximations as data."""

import doctest
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from aeroservo.aero import indicial
from aeroservo.aero.indicial import (
    KUSSNER_LEISHMAN,
    KUSSNER_SEARS_SPARKS,
    WAGNER_R_T_JONES,
    WAGNER_W_P_JONES,
    IndicialFunction,
    garrick_wagner,
    kussner_function,
    rational_kussner,
    sears_function,
    wagner_function,
)
from aeroservo.aero.theodorsen import generalized_theodorsen_function, theodorsen_function

QUADRATURE = 1e-13  # absolute: the trapezoidal rule's own error
TWO_ROUTES = 1e-10  # adaptive quadrature of a transform on the other side
APPROXIMATIONS = [WAGNER_R_T_JONES, WAGNER_W_P_JONES, KUSSNER_SEARS_SPARKS, KUSSNER_LEISHMAN]


@pytest.mark.parametrize("s", [0.7, 3.0, 25.0])
def test_wagner_by_an_integral_over_frequency(s):
    """phi = 2/pi integral F(k) sin(ks)/k dk, a route off the cut.

    F - 1/2 - 1/(2(1 + k^2)) is integrated, which is small at both ends; the sine transform of the rest is known.
    """

    def rest(k):
        return (theodorsen_function(k).real - 0.5 - 0.5 / (1.0 + k**2)) / k if k > 0.0 else -np.pi / 2

    integral = quad(rest, 0.0, np.inf, weight="sin", wvar=s, epsabs=1e-11, limlst=500)[0]
    assert abs(0.5 + 0.5 * (1.0 - np.exp(-s)) + 2.0 / np.pi * integral - wagner_function(s)) < TWO_ROUTES


@pytest.mark.parametrize("p", [0.05, 0.3, 1.0, 4.0])
def test_laplace_transforms(p):
    """p times the transform of Wagner's function is C(p); of Küssner's, Sears' function at the leading edge."""
    cuts = np.concatenate([[0.0], np.geomspace(1e-6, 40.0 / p, 30)])

    def transform(f):  # of the step response less its final value
        return 1.0 + sum(
            quad(lambda s: p * np.exp(-p * s) * (f(s) - 1.0), *ends, epsabs=1e-15, epsrel=1e-12)[0]
            for ends in pairwise(cuts)
        )

    assert abs(transform(wagner_function) - generalized_theodorsen_function(p).real) < TWO_ROUTES
    assert abs(transform(kussner_function) - sears_function(-1j * p).real) < 1e-9  # square root at the start


def test_wagner_lags_are_theodorsen_off_the_axis():
    """C(p) = 1 - sum of W p/(p + x) over Wagner's row of lags, also in the left half-plane away from the cut."""
    rates, weights = indicial._wagner_lags()
    rng = np.random.default_rng(3)
    p = 10 ** rng.uniform(-3, 1.5, 400) * np.exp(1j * rng.uniform(-2.0, 2.0, 400))
    row = IndicialFunction(constant=1.0, amplitudes=weights, exponents=rates)
    np.testing.assert_allclose(row.frequency_response(p), generalized_theodorsen_function(p), rtol=1e-10)


def test_kussner_lags_are_sears_off_the_axis():
    """S(p) at the leading edge = 1 - sum of W p/(p + x) over Küssner's row of lags."""
    rates, weights = indicial._kussner_lags()
    p = np.array([0.1j, 1j, 0.5 + 2j, 3.0 + 0j])
    by_lags = 1.0 - (p[:, None] / (p[:, None] + rates)) @ weights
    np.testing.assert_allclose(by_lags, sears_function(-1j * p), rtol=1e-10)


def test_limits():
    assert wagner_function(0.0) == 0.5 and kussner_function(0.0) == 0.0
    np.testing.assert_array_equal(wagner_function([-1e-9, -3.0, np.inf]), [0.0, 0.0, 1.0])
    np.testing.assert_array_equal(kussner_function([-1e-9, -np.inf, np.inf]), [0.0, 0.0, 1.0])
    # the quadrature itself reaches the start, not only the value put in for s = 0
    np.testing.assert_allclose(wagner_function(1e-14), 0.5, atol=QUADRATURE)
    s = np.array([1e-6, 1e-5, 1e-4])
    np.testing.assert_allclose((wagner_function(s) - 0.5) / s, 1 / 8, rtol=1e-4)
    np.testing.assert_allclose(kussner_function(s), np.sqrt(2 * s) / np.pi, rtol=1e-4)
    far = np.array([1e4, 1e6])
    np.testing.assert_allclose((1 - wagner_function(far)) * far, 1.0, atol=0.01)
    np.testing.assert_allclose((1 - kussner_function(far)) * far, 1.0, atol=0.01)


@pytest.mark.parametrize("f", [wagner_function, kussner_function])
def test_monotone_and_shaped(f):
    s = np.linspace(0.0, 300.0, 9999)
    assert np.all(np.diff(f(s)) > 0.0)
    assert f(s.reshape(3, -1, 11)).shape == (3, 303, 11)
    assert f([]).shape == (0,) and f(2.0).shape == ()
    mixed = f(np.array([0.0, 1e-8, 5.0, 1e5]))  # the dropping of dead lags does not show
    np.testing.assert_allclose(mixed, [f(x) for x in (0.0, 1e-8, 5.0, 1e5)], rtol=0, atol=1e-15)


def test_sears_by_bessel_functions_of_the_first_kind():
    """S = (J0 - i J1) C + i J1 at mid-chord, another formula; and the leading edge lags it by k."""
    from scipy.special import j0, j1

    k = np.concatenate([[0.0], np.geomspace(1e-6, 300.0, 400)])
    S = (j0(k) - 1j * j1(k)) * theodorsen_function(k) + 1j * j1(k)
    np.testing.assert_allclose(sears_function(k, reference="midchord"), S, rtol=0, atol=1e-14)
    np.testing.assert_allclose(sears_function(k), S * np.exp(-1j * k), rtol=0, atol=1e-14)
    assert sears_function(0.0) == 1.0
    # far out |S|^2 -> 1/(2 pi k), and nothing overflows
    np.testing.assert_allclose(
        np.abs(sears_function([1e4, 1e9])) ** 2 * 2 * np.pi * np.array([1e4, 1e9]), 1.0, rtol=1e-4
    )


@pytest.mark.parametrize("f", APPROXIMATIONS, ids=lambda f: f.name)
def test_exponentials_and_their_transfer_function_agree(f):
    start = 0.5 if f.name.startswith("Wagner") else 0.0
    assert abs(f(0.0) - start) < 1e-15 and f(-1.0) == 0.0 and f(np.inf) == 1.0
    assert f.frequency_response(0.0) == 1.0
    assert abs(f.frequency_response(1e12j) - start) < 1e-11
    p = 0.3 + 0.2j
    s = np.linspace(0.0, 200.0, 400001)
    transform = p * np.trapezoid(np.exp(-p * s) * f(s), s)
    np.testing.assert_allclose(transform, f.frequency_response(p), atol=1e-7)


def test_garrick_and_rational_ends():
    np.testing.assert_allclose(garrick_wagner([-1.0, 0.0, 2.0, np.inf]), [0.0, 0.5, 2 / 3, 1.0])
    np.testing.assert_allclose(rational_kussner([-1.0, 0.0, 3.0, np.inf]), [0.0, 0.0, 12 / 18.26, 1.0])


@pytest.mark.parametrize(
    "f",
    [wagner_function, kussner_function, garrick_wagner, rational_kussner, WAGNER_R_T_JONES],
    ids=lambda f: getattr(f, "__name__", "exponentials"),
)
def test_nan_is_refused(f):
    with pytest.raises(ValueError, match=r"distance travelled s must be a number \[semichords\]"):
        f([1.0, np.nan])


def test_bad_input():
    with pytest.raises(ValueError, match=r"reduced frequency k must be >= 0 \[-\], got -0.1"):
        sears_function([0.1, -0.1])
    with pytest.raises(ValueError, match="must be finite"):
        sears_function(np.inf)
    with pytest.raises(ValueError, match='"leading_edge" or "midchord", got \'nose\''):
        sears_function(0.1, reference="nose")
    with pytest.raises(ValueError, match="exponents must be positive"):
        IndicialFunction(constant=1.0, amplitudes=[1.0], exponents=[0.0])
    with pytest.raises(ValueError, match="of one length, got 2 and 1"):
        IndicialFunction(constant=1.0, amplitudes=[1.0, 2.0], exponents=[0.1])
    with pytest.raises(ValueError, match="must not be a pole"):
        WAGNER_R_T_JONES.frequency_response([-0.3, 0.1])
    with pytest.raises(ValueError, match="must be finite"):
        WAGNER_R_T_JONES.frequency_response(np.nan)
    with pytest.raises(ValueError, match="read-only"):
        WAGNER_R_T_JONES.amplitudes[0] = 1.0


def test_examples():
    assert doctest.testmod(indicial).failed == 0
