"""C(k), the T-functions and the section's air forces, against routes that share no formula with the package."""

import doctest

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from aeroservo.aero import flap, lift_deficiency, theodorsen
from aeroservo.aero.indicial import WAGNER_R_T_JONES, sears_function
from aeroservo.aero.theodorsen import (
    flap_functions,
    generalized_theodorsen_function,
    oscillatory_derivatives,
    scaled_macdonald,
    section_air,
    theodorsen_function,
)

SPECIAL = 2e-14  # relative: library Bessel functions against 40 digits
IDENTITY = 1e-13  # the same number by algebra
SERIES = 1e-9  # absolute: 100,000 terms of a Fourier series whose slowest product falls as n^-3


# ---------------------------------------------------------------- C(k)


def exact_C(p):
    with mpmath.workdps(40):
        K0, K1 = mpmath.besselk(0, mpmath.mpc(p)), mpmath.besselk(1, mpmath.mpc(p))
        return complex(K1 / (K0 + K1))


def test_deficiency_on_the_axis_in_forty_digits():
    k = np.concatenate([np.geomspace(1e-12, 1e6, 61), [39.999999, 40.0, 40.000001]])
    C, exact = theodorsen_function(k), np.array([exact_C(1j * x) for x in k])
    np.testing.assert_allclose(C, exact, rtol=SPECIAL)
    np.testing.assert_allclose(C.imag, exact.imag, rtol=1e-12)  # G alone: G/k enters the derivatives


def test_deficiency_off_the_axis_in_forty_digits():
    """Both half-planes, close to the cut on both sides, from 1e-10 to 1e5."""
    rng = np.random.default_rng(7)
    angle = np.concatenate([rng.uniform(-np.pi, np.pi, 160), np.pi - 10.0 ** rng.uniform(-7, -1, 20)])
    angle = np.concatenate([angle, -angle[-20:]])
    p = 10.0 ** rng.uniform(-10, 5, angle.size) * np.exp(1j * angle)
    np.testing.assert_allclose(generalized_theodorsen_function(p), [exact_C(x) for x in p], rtol=SPECIAL)


def test_the_two_entrances_agree_and_join_their_series():
    k = np.concatenate([[0.0], np.geomspace(1e-9, 1e5, 500)])
    K0, K1 = scaled_macdonald(1j * k)  # complex Bessel functions; the real ones serve C on the axis
    np.testing.assert_allclose(theodorsen_function(k), K1 / (K0 + K1), rtol=SPECIAL)
    np.testing.assert_array_equal(theodorsen_function(k), generalized_theodorsen_function(1j * k))
    np.testing.assert_allclose(
        generalized_theodorsen_function(1j * k[1:] + 1e-300), theodorsen_function(k[1:]), rtol=SPECIAL
    )
    np.testing.assert_array_equal(theodorsen_function(k + 0j), generalized_theodorsen_function(1j * k))


def test_deficiency_limits():
    assert theodorsen_function(0.0) == 1.0 and theodorsen_function(0) == 1.0
    assert theodorsen_function(np.inf) == 0.5
    np.testing.assert_array_equal(generalized_theodorsen_function([0.0, 1e-320]), [1.0, 1.0])
    for angle in (0.0, np.pi / 2, 3.0, -3.0):
        np.testing.assert_allclose(generalized_theodorsen_function(1e200 * np.exp(1j * angle)), 0.5, rtol=1e-15)
    k = 1e-8  # G -> k (ln(k/2) + Euler's constant), F -> 1 - pi k/2
    np.testing.assert_allclose(theodorsen_function(k).imag / k, np.log(k / 2) + np.euler_gamma, rtol=1e-4)
    np.testing.assert_allclose((1.0 - theodorsen_function(k).real) / k, np.pi / 2, rtol=1e-4)
    np.testing.assert_allclose(theodorsen_function(1e5).imag, -1 / 8e5, rtol=1e-8)


def test_deficiency_symmetry_and_monotony():
    rng = np.random.default_rng(11)
    p = 10.0 ** rng.uniform(-3, 3, 300) * np.exp(1j * rng.uniform(0.001, 3.14, 300))
    np.testing.assert_array_equal(generalized_theodorsen_function(p.conj()), generalized_theodorsen_function(p).conj())
    growth = generalized_theodorsen_function(np.geomspace(1e-6, 1e6, 999))
    assert np.all(growth.imag == 0.0) and np.all(np.diff(growth.real) < 0.0)
    C = theodorsen_function(np.geomspace(1e-6, 1e5, 999))
    assert np.all(np.diff(C.real) < 0.0) and np.all(C.imag < 0.0) and np.all(C.real > 0.5)


def test_the_cut_is_taken_from_above():
    x = np.array([0.1, 1.0, 5.0, 20.0])
    above = generalized_theodorsen_function(-x + 1e-13j)
    np.testing.assert_allclose(generalized_theodorsen_function(-x), above, rtol=1e-10)
    np.testing.assert_allclose(generalized_theodorsen_function(np.conj(-x + 0j)), above, rtol=1e-10)
    K0, _ = scaled_macdonald([-50.0, complex(-50.0, -0.0), -50.0 + 1e-13j])
    np.testing.assert_allclose(K0, K0[2], rtol=1e-12)


def test_scaled_functions_join_and_do_not_overflow():
    for angle in np.linspace(-3.1, 3.1, 9):
        inside, outside = (scaled_macdonald(r * np.exp(1j * angle)) for r in (40.0 * (1 - 1e-12), 40.0 * (1 + 1e-12)))
        np.testing.assert_allclose(inside, outside, rtol=1e-11)
    assert np.all(np.isfinite(scaled_macdonald([1e-310, 1e300, -1e300 + 1j, 1e300j])))


# ---------------------------------------------------------------- T-functions


@pytest.mark.parametrize("c", [-0.7, 0.0, 0.5, 0.82])
@pytest.mark.parametrize("a", [-0.4, 0.3])
def test_t_functions_as_the_integrals_they_stand_for(c, a):
    """Pressures of the flat plate, integrated over the flap with its lever."""
    T = flap_functions(c, a)

    def over_flap(f):  # with x = cos(angle): no end singularity
        g = lambda t: f(np.cos(t), np.sin(t)) * np.sin(t)  # noqa: E731
        return quad(g, 0.0, np.arccos(c), epsabs=1e-14, epsrel=1e-13)[0]

    expected = {
        "T1": -2 * over_flap(lambda x, r: r * (x - c)),
        "T4": -2 * over_flap(lambda x, r: r),
        "T10": over_flap(lambda x, r: (1 + x) / r),
        "T11": 2 * over_flap(lambda x, r: (x - c) * (1 + x) / r),
        "T12": 2 * over_flap(lambda x, r: (x - c) * (1 - x) / r),
        "T13": 0.5 * over_flap(lambda x, r: (x - c) * r * (x - 2 * a)),
    }
    for name, value in expected.items():
        np.testing.assert_allclose(getattr(T, name), value, atol=1e-12, err_msg=name)
    # T7 from the added moment of inertia about mid-chord; T9 is half the flap's share of (a - x) times the ellipse
    np.testing.assert_allclose(T.T7, -over_flap(lambda x, r: (x - c) * r * x) - c * T.T1, atol=1e-12)
    np.testing.assert_allclose(T.T9, 0.5 * over_flap(lambda x, r: (x - 2 * a) * r), atol=1e-12)


# ---------------------------------------------------------------- air forces by another route


def kernel_route(a, c, C, p):
    """Q(p) of the flapped section, b = 1, from the potential and the wake rather than from T-functions.

    Shapes z = 1, x - a, (x - c)+ (down), downwash angle D z with D = p + d/dx. (1) With no circulation the potential
    jump over the plate is 4/(pi n) times the sine coefficients of the downwash, Fourier series in x = cos t, and the
    force -2 <z_i, D jump_j>, integrated by parts since the jump vanishes at both edges. (2) Wake vortices with
    their images, and Kutta's condition: load downward -2 rho V^2 W [C (1 - x) + x]/sqrt(1 - x^2), over the dynamic
    pressure -4 W [...], with W = (1/pi) integral sqrt((1 + x)/(1 - x)) D z dx.
    """
    n = np.arange(1, 100_001.0)

    def cosine(m, phi):  # integral of cos(m t) from 0 to phi
        return np.where(m == 0, phi, np.sin(m * phi) / np.where(m == 0, 1.0, m))

    def sine_coefficients(lever, phi):  # of (cos t - lever), or of 1 where lever is None, on 0..phi
        one = (cosine(n - 1, phi) - cosine(n + 1, phi)) / 2
        return one if lever is None else (cosine(n - 2, phi) - cosine(n + 2, phi)) / 4 - lever * one

    phi = np.arccos(c)
    z = np.stack([sine_coefficients(None, np.pi), sine_coefficients(a, np.pi), sine_coefficients(c, phi)])
    slope = np.stack([0 * n, sine_coefficients(None, np.pi), sine_coefficients(None, phi)])
    Q = -8 / np.pi * ((p * z - slope) / n) @ (p * z + slope).T

    def integral(f, end):
        return quad(f, 0.0, end, epsabs=1e-13, epsrel=1e-12)[0]

    def row(f, d, end):
        return integral(lambda t: (1 + np.cos(t)) * (p * f(np.cos(t)) + d) / np.pi, end)

    def column(f, end):
        return integral(lambda t: -4 * (C * (1 - np.cos(t)) + np.cos(t)) * f(np.cos(t)), end)

    shapes = [(lambda x: 1.0, 0.0, np.pi), (lambda x: x - a, 1.0, np.pi), (lambda x: x - c, 1.0, phi)]
    downwash = np.array([row(*shape) for shape in shapes])
    force = np.array([column(f, end) for f, _, end in shapes])
    return Q + np.outer(force, downwash)


@pytest.mark.parametrize("a", [-0.4, 0.0, 0.3])
@pytest.mark.parametrize("c", [-0.6, 0.2, 0.5, 0.8])
def test_flapped_section_by_potential_and_wake(a, c):
    """Real p > 0 makes every integral real; entries of p^0, p^1, p^2 and C(p) are told apart by four values of p."""
    air = section_air(a=a, b=1.0, hinge=c)
    for p in (0.0, 0.17, 1.0, 3.1):
        C = float(generalized_theodorsen_function(p).real)
        np.testing.assert_allclose(air(p).real, kernel_route(a, c, C, p), atol=SERIES * (1 + p**2))
    np.testing.assert_allclose(
        air(0.4, deficiency=lambda p: 0.7 + 0 * p).real, kernel_route(a, c, 0.7, 0.4), atol=SERIES
    )


def test_flap_of_the_whole_chord_is_pitch_about_the_leading_edge():
    air = section_air(a=-1.0, b=0.7, hinge=-1.0)
    Q = air(np.array([0.0, 0.3j, 0.2 + 1j]))
    np.testing.assert_allclose(Q[:, :, 1], Q[:, :, 2], atol=IDENTITY * 10)
    np.testing.assert_allclose(Q[:, 1, :], Q[:, 2, :], atol=IDENTITY * 10)


def test_flap_vanishes_with_its_chord():
    air = section_air(a=-0.2, b=1.0, hinge=1.0 - 1e-12)
    Q = air(0.5j)
    assert np.max(np.abs(Q[:, 2])) < 1e-5 and np.max(np.abs(Q[2, :])) < 1e-5


@pytest.mark.parametrize("c", [0.0, 0.5, 0.6])
def test_steady_flap_is_glauerts(c):
    """cl = 2 (pi - t + sin t), cm about the quarter chord = -(sin t - sin 2t/2)/2, hinge at angle t from the nose."""
    b, t = 0.65, np.arccos(-c)
    Q = section_air(a=-0.5, b=b, hinge=c)(0.0).real
    np.testing.assert_allclose(-Q[0, 2] / (2 * b), 2 * (np.pi - t + np.sin(t)), rtol=IDENTITY)
    np.testing.assert_allclose(Q[1, 2] / (2 * b) ** 2, -(np.sin(t) - np.sin(2 * t) / 2) / 2, rtol=IDENTITY)


def test_steady_hinge_moment_is_restoring_and_known():
    """Incidence and deflection both push the flap back; the full-chord flap about its nose has c_m = -pi/2."""
    Q = section_air(a=-0.2, b=1.0, hinge=[-1.0, 0.0, 0.5, 0.9])(0.0).real
    assert np.all(Q[:, 2, 1] < 0.0) and np.all(Q[:, 2, 2] < 0.0)
    np.testing.assert_allclose(Q[0, 2, 2] / 4.0, -np.pi / 2, rtol=IDENTITY)


def test_apparent_mass_is_symmetric_and_only_ever_adds_inertia():
    rng = np.random.default_rng(5)
    air = section_air(a=rng.uniform(-1, 1, 200), b=rng.uniform(0.1, 3, 200), hinge=rng.uniform(-0.9, 0.9, 200))
    np.testing.assert_allclose(air.A2, np.swapaxes(air.A2, -1, -2), atol=IDENTITY * 100)
    assert np.all(np.linalg.eigvalsh(-air.A2) > 0.0)


def test_kinetic_energy_of_a_flat_plate():
    """The classical apparent masses pi rho b^2 and pi rho b^4/8 about mid-chord."""
    b, rho = 0.3, 1.2
    A2 = section_air(a=0.0, b=b).A2 * 0.5 * rho * b**2  # q p^2 -> s^2: rho b^2/2
    np.testing.assert_allclose(A2, -np.diag([np.pi * rho * b**2, np.pi * rho * b**4 / 8]), atol=1e-15)


def test_locked_flap_is_the_section_without_one():
    rng = np.random.default_rng(6)
    a, b, slope, c = rng.uniform([[-1], [0.1], [1], [-1]], [[1], [3], [7], [1]], (4, 50))
    p = rng.normal(size=(8, 1)) + 1j * rng.normal(size=(8, 1))
    with_flap, without = (section_air(a=a, b=b, lift_slope=slope, hinge=h)(p) for h in (c, None))
    np.testing.assert_allclose(with_flap[..., :2, :2], without, rtol=IDENTITY, atol=IDENTITY)
    assert without.shape == (8, 50, 2, 2)


def test_moving_the_axis_is_a_change_of_coordinates():
    """The same air about two axes: h at the new one is h + b (a2 - a1) theta."""
    b, a1, a2, p = 0.8, -0.4, 0.25, 0.1 + 0.6j
    T = np.array([[1.0, b * (a1 - a2), 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])  # (h1, theta, beta) of (h2, ...)
    Q1, Q2 = (section_air(a=a, b=b, hinge=0.4)(p) for a in (a1, a2))
    np.testing.assert_allclose(T.T @ Q1 @ T, Q2, rtol=1e-12, atol=1e-13)


def test_semichord_is_the_unit_of_length():
    b, p = 2.3, 0.4j
    scale = np.array([1.0, b, b])
    Q1, Qb = (section_air(a=-0.3, b=x, hinge=0.4)(p) for x in (1.0, b))
    np.testing.assert_allclose(Qb, Q1 * scale[:, None] * scale, rtol=IDENTITY)


def test_against_the_equations_in_time():
    """[3.13-3.14] with derivatives of exp(st) put in by hand, any slope; L up, M nose up."""
    rho, V, b, a, slope, s = 1.1, 37.0, 0.4, -0.15, 5.1, 2.0 + 60j
    C = generalized_theodorsen_function(s * b / V)
    air = section_air(a=a, b=b, lift_slope=slope)
    for h, theta in ((1.0, 0.0), (0.0, 1.0)):
        w = s * h + V * theta + b * (0.5 - a) * s * theta
        L = np.pi * rho * b**2 * (s**2 * h + V * s * theta - b * a * s**2 * theta) + slope * rho * V * b * C * w
        M = (
            np.pi
            * rho
            * b**2
            * (b * a * s**2 * h - V * b * (0.5 - a) * s * theta - b**2 * (1 / 8 + a**2) * s**2 * theta)
            + slope * rho * V * b**2 * (a + 0.5) * C * w
        )
        force = 0.5 * rho * V**2 * air(s * b / V) @ np.array([h, theta])
        np.testing.assert_allclose(force, [-L, M], rtol=IDENTITY)


def test_lift_slope_scales_the_wake_alone():
    half, full = (section_air(a=-0.2, b=1.0, hinge=0.5, lift_slope=x) for x in (np.pi, 2 * np.pi))
    np.testing.assert_array_equal(half.A2, full.A2)
    np.testing.assert_array_equal(half.A1, full.A1)
    np.testing.assert_allclose(2 * half.R, full.R, rtol=1e-15)


def test_gust_column_pushes_up_at_the_quarter_chord():
    air = section_air(a=0.2, b=0.5)
    L, M = -air.R[0] * sears_function(0.3), air.R[1] * sears_function(0.3)
    np.testing.assert_allclose(L / (4 * np.pi * 0.5), sears_function(0.3), rtol=IDENTITY)
    np.testing.assert_allclose(M / L, 0.5 * (0.2 + 0.5), rtol=IDENTITY)


# ---------------------------------------------------------------- oscillatory derivatives


@pytest.mark.parametrize("slope", [2 * np.pi, 4.4])
def test_oscillatory_derivatives_are_the_same_forces(slope):
    k, a, b = np.geomspace(1e-6, 30.0, 40)[:, None], np.linspace(-1, 1, 9), 0.37
    d = oscillatory_derivatives(k, a, lift_slope=slope)
    p = 1j * k
    Q = 2 * np.stack(
        [
            np.stack([-(d.L_h + p * d.L_hdot), -b * (d.L_theta + p * d.L_thetadot)], -1),
            np.stack([b * (d.M_h + p * d.M_hdot), b**2 * (d.M_theta + p * d.M_thetadot)], -1),
        ],
        -2,
    )
    np.testing.assert_allclose(Q, section_air(a=a, b=b, lift_slope=slope)(p), rtol=1e-12, atol=1e-13)


def test_oscillatory_derivatives_at_low_frequency():
    k, a = 1e-9, 0.1
    d = oscillatory_derivatives(k, a)
    np.testing.assert_allclose([d.L_hdot, d.L_theta], 2 * np.pi, rtol=1e-7)
    np.testing.assert_allclose([d.M_hdot, d.M_theta], 2 * np.pi * 0.6, rtol=1e-7)
    np.testing.assert_allclose([d.L_h, d.M_h], 0.0, atol=1e-15)
    growth = 2 * np.pi * (np.log(k / 2) + np.euler_gamma)
    np.testing.assert_allclose(d.L_thetadot, np.pi + 2 * np.pi * 0.4 + growth, rtol=1e-6)
    fixed = oscillatory_derivatives([1e-3, 1e-9], -0.5)  # axis at the quarter chord: no logarithm left
    np.testing.assert_allclose(fixed.M_thetadot, -np.pi, rtol=1e-12)


# ---------------------------------------------------------------- the NASA section, end to end


# NASA/TP-2015-218765, Appendix C (NACA R-496's flexure-torsion case), as recomputed two ways for this project.
A, X_ALPHA, R2_ALPHA, KAPPA, OMEGA_H, OMEGA_T = -0.4, 0.2, 0.25, 0.1, 50.0, 100.0  # b = 1 ft, rho = 1
MASS = np.pi / KAPPA
M = MASS * np.array([[1.0, X_ALPHA], [X_ALPHA, R2_ALPHA]])
K = MASS * np.diag([OMEGA_H**2, R2_ALPHA * OMEGA_T**2])
AIR = section_air(a=A, b=1.0)


def flutter_by_k(deficiency):
    """(V [ft/s], k) where a root of K - omega^2 (M + Q(ik)/(2 k^2)) needs no structural damping: the k-method."""

    def roots(k):  # (1 + ig)/omega^2
        return np.linalg.eigvals(np.linalg.solve(K, M + AIR(1j * k, deficiency) / (2 * k**2)))

    def damping_needed(k):
        mu = roots(k)
        return (mu.imag / mu.real).max()

    grid = np.geomspace(2.0, 0.2, 200)
    g = np.array([damping_needed(k) for k in grid])
    i = np.flatnonzero((g[:-1] < 0) & (g[1:] >= 0))[0]
    k = brentq(damping_needed, grid[i + 1], grid[i], xtol=1e-14)
    mu = roots(k)
    omega = mu[np.argmax(mu.imag / mu.real)].real ** -0.5
    return omega / k, k


def test_nasa_section_flutters_where_published():
    V, k = flutter_by_k(generalized_theodorsen_function)
    assert abs(V - 173.26) < 0.005 and abs(k - 0.4355) < 0.00005  # published digits: half the last one
    np.testing.assert_allclose(V, 173.26235, rtol=1e-7)
    np.testing.assert_allclose([k, V * k], [0.4355361, 75.46202], rtol=2e-7)


def test_nasa_section_with_other_wakes():
    np.testing.assert_allclose(flutter_by_k(WAGNER_R_T_JONES.frequency_response)[0], 172.857, atol=5e-4)
    np.testing.assert_allclose(flutter_by_k(lambda p: np.ones_like(p))[0], 100.011, atol=5e-4)


def test_nasa_section_diverges_where_published():
    Q0 = AIR(0.0).real
    V = brentq(lambda V: np.linalg.det(K - 0.5 * V**2 * Q0), 300.0, 400.0, xtol=1e-12)
    np.testing.assert_allclose(V, 353.553391, rtol=1e-8)


@pytest.mark.parametrize(
    ("V", "expected"), [(170.0, -1.1504 + 75.8683j), (170.0, -31.4233 + 63.4831j), (180.0, 2.132 + 74.78j)]
)
def test_nasa_section_roots_off_the_axis(V, expected):
    """Growing and decaying roots with C(p) continued analytically, as published to four or two decimals."""

    def determinant(s):
        return np.linalg.det(s**2 * M + K - 0.5 * V**2 * AIR(s / V))

    s0, s1 = expected, expected + 0.1
    f0, f1 = determinant(s0), determinant(s1)
    for _ in range(30):
        if s1 == s0 or f1 == f0:
            break
        s0, s1, f0 = s1, s1 - f1 * (s1 - s0) / (f1 - f0), f1
        f1 = determinant(s1)
    half_digit = 5e-5 if V == 170.0 else 5e-3
    assert abs(s1.real - expected.real) < half_digit and abs(s1.imag - expected.imag) < half_digit


# ---------------------------------------------------------------- bad input, examples


def test_bad_input():
    with pytest.raises(ValueError, match=r"reduced frequency k must be >= 0 \[-\], got -0.2"):
        theodorsen_function([0.1, -0.2])
    with pytest.raises(ValueError, match="reduced frequency k must be >= 0"):
        theodorsen_function(np.nan)
    with pytest.raises(ValueError, match="reduced Laplace variable p must be finite"):
        generalized_theodorsen_function(complex(np.inf, 0.0))
    with pytest.raises(ValueError, match="reduced Laplace variable p must be finite"):
        generalized_theodorsen_function(complex(0.0, np.inf))
    with pytest.raises(ValueError, match=r"semichord b must be positive \[m\], got 0"):
        section_air(a=0.0, b=0.0)
    with pytest.raises(ValueError, match="pitch axis a holds a value that is not finite"):
        section_air(a=np.nan, b=1.0)
    with pytest.raises(ValueError, match=r"hinge must be from -1 to below 1 .*, got 1$"):
        section_air(a=0.0, b=1.0, hinge=[0.5, 1.0])
    with pytest.raises(ValueError, match="hinge must be from -1"):
        flap_functions(np.nan, 0.0)
    with pytest.raises(ValueError, match=r"reduced frequency k must be positive .*, got 0"):
        oscillatory_derivatives([0.0, 0.1], 0.0)
    air = section_air(a=0.0, b=1.0)
    with pytest.raises(ValueError, match=r"A0, A1, A2 must be \(..., 2, 2\)"):
        type(air)(A0=np.zeros((3, 3)), A1=air.A1, A2=air.A2, R=air.R, w0=air.w0, w1=air.w1)
    with pytest.raises(ValueError, match=r"R, w0, w1 must be \(2,\)"):
        type(air)(A0=air.A0, A1=air.A1, A2=air.A2, R=air.R, w0=np.zeros(3), w1=air.w1)
    with pytest.raises(ValueError, match="read-only"):
        air.A0[0, 0] = 1.0


@pytest.mark.parametrize("module", [theodorsen, flap, lift_deficiency])
def test_examples(module):
    assert doctest.testmod(module).failed == 0
