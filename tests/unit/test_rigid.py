"""Rigid flight: linear models against complex steps through the nonlinear equations, trim, margins, modes."""

from dataclasses import replace

import numpy as np
import pytest

from aeroservo.flight.derivatives import (
    LateralDerivatives,
    LongitudinalDerivatives,
    StabilityDerivatives,
    flying_wing_derivatives,
    lateral_derivatives,
    longitudinal_derivatives,
)
from aeroservo.flight.forces import LiftDragAero, StabilityAxisAero
from aeroservo.flight.linear import lateral_model, longitudinal_model, pitch_model, pitch_rate_transfer
from aeroservo.flight.modes import FlightMode, flight_modes, root_movement
from aeroservo.flight.rigid import Airframe, aircraft_rates
from aeroservo.flight.trim import (
    LongitudinalCoefficients,
    about_centre_of_gravity,
    neutral_point,
    static_margin,
    trim_derivatives,
    trim_level,
)

TWO_ROUTES = 1e-10  # issue 6: linear models equal complex-step derivatives
G = 9.80665
LONGITUDINAL, LATERAL = [0, 2, 4, 7], [1, 3, 5, 6]  # u w q theta; v p r phi

FRAME = Airframe(mass=10.0, Ixx=0.9, Iyy=0.503, Izz=1.35, Ixz=0.11, area=1.0, chord=0.5267, span=2.0)
# The thesis' flying wing about its quarter-MAC: AVL 16 x 32 (case thesis_wing), drag polar assumed for the test.
WING = LongitudinalCoefficients(
    CL0=-0.094, CL_alpha=3.675, CL_delta=0.834 / 0.976, CL_q=3.79, CM0=0.0107, CM_alpha=0.008, CM_delta=-0.312 / 0.976,
    CM_q=-0.85, CL_alphadot=0.3, CM_alphadot=-0.5, CD0=0.012, CD_CL2=0.09, x=0.3589,
)  # fmt: skip
EVERYTHING = StabilityDerivatives(
    **{name: 0.01 * (i + 1) * (-1) ** i for i, name in enumerate(StabilityDerivatives.__dataclass_fields__)}
)


def jacobian(f, x, step=1e-40):
    """Derivatives exact to rounding: Im f(x + i h)/h."""
    return np.stack([f(x + 1j * step * e).imag / step for e in np.eye(x.size)], axis=-1)


def trimmed(V, theta):
    state = np.zeros(12)
    state[0], state[7] = V, theta
    return state


def assert_same(linear, exact):
    np.testing.assert_allclose(linear, exact, rtol=TWO_ROUTES, atol=TWO_ROUTES * np.abs(exact).max())


@pytest.mark.parametrize("theta", [0.0, 0.17, -0.4])
def test_linear_models_equal_complex_steps_with_every_derivative(theta):
    V, rho = 55.0, 1.1
    aero = StabilityAxisAero(derivatives=EVERYTHING, V=V, rho=rho, theta=theta)
    state, controls = trimmed(V, theta), np.zeros(4)
    assert np.abs(aircraft_rates(state, controls, aero, FRAME)[:9]).max() < 1e-12  # it is a trim
    A = jacobian(lambda x: aircraft_rates(x, controls, aero, FRAME), state)
    B = jacobian(lambda c: aircraft_rates(state, c, aero, FRAME), controls)
    long = longitudinal_model(
        longitudinal_derivatives(EVERYTHING, FRAME, V=V, rho=rho, theta=theta), FRAME, V=V, theta=theta
    )
    lat = lateral_model(lateral_derivatives(EVERYTHING, FRAME, V=V, rho=rho), FRAME, V=V, theta=theta)
    assert_same(long.A, A[np.ix_(LONGITUDINAL, LONGITUDINAL)])
    assert_same(long.B, B[np.ix_(LONGITUDINAL, [0, 3])])
    assert_same(lat.A, A[np.ix_(LATERAL, LATERAL)])
    assert_same(lat.B, B[np.ix_(LATERAL, [1, 2])])
    assert np.abs(A[np.ix_(LONGITUDINAL, LATERAL)]).max() < 1e-12  # the motions do not couple
    assert np.abs(A[np.ix_(LATERAL, LONGITUDINAL)]).max() < 1e-12


@pytest.mark.parametrize("gamma", [0.0, 0.1, -0.25])
@pytest.mark.parametrize("x_cg", [0.30, 0.3589, 0.40])
def test_flying_wing_from_coefficients_equals_complex_steps(gamma, x_cg):
    V, rho = 40.0, 0.9046
    wing = about_centre_of_gravity(WING, x_cg, FRAME.chord)
    trim = trim_level(wing, FRAME, V=V, rho=rho, gamma=gamma)
    aero = LiftDragAero(coefficients=wing, trim=trim)
    state, controls = trimmed(V, gamma), np.zeros(4)
    assert np.abs(aircraft_rates(state, controls, aero, FRAME)[:9]).max() < 1e-12
    A = jacobian(lambda x: aircraft_rates(x, controls, aero, FRAME), state)
    B = jacobian(lambda c: aircraft_rates(state, c, aero, FRAME), controls)
    d = longitudinal_derivatives(trim_derivatives(wing, FRAME, trim), FRAME, V=V, rho=rho, theta=gamma)
    system = longitudinal_model(d, FRAME, V=V, theta=gamma)
    assert_same(system.A, A[np.ix_(LONGITUDINAL, LONGITUDINAL)])
    assert_same(system.B, B[np.ix_(LONGITUDINAL, [0, 3])])


def test_thesis_matrix_as_printed():
    """(5.19) entry by entry, X_q = X_wdot = 0, theta_0 not zero."""
    d = LongitudinalDerivatives(
        X_u=-2.0, X_w=3.0, X_delta=0.7, Z_u=-11.0, Z_w=-90.0, Z_wdot=-1.5, Z_q=-20.0, Z_delta=-400.0, M_u=0.3, M_w=-9.0,
        M_wdot=-0.4, M_q=-6.0, M_delta=-150.0,
    )  # fmt: skip
    m, Iy, U, th = FRAME.mass, FRAME.Iyy, 50.0, 0.2
    mz = m - d.Z_wdot
    A = [
        [d.X_u / m, d.X_w / m, 0.0, -G * np.cos(th)],
        [d.Z_u / mz, d.Z_w / mz, (d.Z_q + m * U) / mz, -m * G * np.sin(th) / mz],
        [
            (d.M_u + d.M_wdot * d.Z_u / mz) / Iy,
            (d.M_w + d.M_wdot * d.Z_w / mz) / Iy,
            (d.M_q + d.M_wdot * (d.Z_q + m * U) / mz) / Iy,
            -d.M_wdot * m * G * np.sin(th) / mz / Iy,
        ],
        [0.0, 0.0, 1.0, 0.0],
    ]
    B = [d.X_delta / m, d.Z_delta / mz, (d.M_delta + d.M_wdot * d.Z_delta / mz) / Iy, 0.0]
    system = longitudinal_model(d, FRAME, V=U, theta=th)
    np.testing.assert_allclose(system.A, A, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(system.B[:, 0], B, rtol=1e-13)
    # (5.20) is its lower corner with alpha = w/u_0 at theta_0 = 0.
    level = longitudinal_model(d, FRAME, V=U)
    scale = np.diag([1.0 / U, 1.0, 1.0])
    np.testing.assert_allclose(
        pitch_model(d, FRAME, V=U).A, scale @ level.A[1:, 1:] @ np.linalg.inv(scale), rtol=1e-13, atol=1e-13
    )
    np.testing.assert_allclose(pitch_model(d, FRAME, V=U).B, scale @ level.B[1:, :1], rtol=1e-13)


def test_pitch_rate_transfer_is_the_pitch_models():
    d = longitudinal_derivatives(EVERYTHING, FRAME, V=50.0, rho=1.2)
    numerator, denominator = pitch_rate_transfer(d, FRAME, V=50.0)
    system = pitch_model(d, FRAME, V=50.0)
    for s in (0.3 + 1.1j, 2j, 7.0):
        H = (system.C @ np.linalg.solve(s * np.eye(3) - system.A, system.B))[1, 0]
        assert np.polyval(numerator, s) / np.polyval(denominator, s) == pytest.approx(H, rel=1e-11)


def test_pitch_rate_transfer_in_the_thesis_form():
    """(5.30-5.31), M_q and the rates of incidence zero."""
    d = replace(
        flying_wing_derivatives(
            V=55.0,
            rho=1.2,
            area=1.0,
            chord=0.53,
            lift_slope=3.7,
            drag=0.02,
            l_w=-0.03,
            CL_delta=0.87,
            CM_delta=-0.32,
            CM_q=0.0,
        )
    )
    m, Iy, U = FRAME.mass, FRAME.Iyy, 55.0
    numerator, denominator = pitch_rate_transfer(d, FRAME, V=U)
    np.testing.assert_allclose(numerator, [m * d.M_delta, d.M_w * d.Z_delta - d.M_delta * d.Z_w])
    np.testing.assert_allclose(denominator, [Iy * m, -Iy * d.Z_w, -m * U * d.M_w])
    assert d.M_w < 0.0  # centre of gravity ahead of the aerodynamic centre: restoring
    assert d.Z_w == pytest.approx(-0.5 * 1.2 * 55.0 * 3.72)


def test_flying_wing_short_form_agrees_with_the_general_derivatives():
    """Without lift by pitch rate and rates of incidence the two ways to Z_w, M_w, M_q, Z_delta, M_delta are one."""
    V, rho = 55.0, 1.1
    plain = replace(WING, CL_alphadot=0.0, CM_alphadot=0.0)
    wing = replace(about_centre_of_gravity(plain, 0.33, FRAME.chord), CL_q=0.0)
    trim = trim_level(wing, FRAME, V=V, rho=rho)
    general = longitudinal_derivatives(trim_derivatives(wing, FRAME, trim), FRAME, V=V, rho=rho)
    short = flying_wing_derivatives(
        V=V, rho=rho, area=1.0, chord=FRAME.chord, lift_slope=wing.CL_alpha, drag=float(trim.CD),
        l_w=0.33 - neutral_point(WING, FRAME.chord), CL_delta=wing.CL_delta, CM_delta=wing.CM_delta, CM_q=wing.CM_q,
    )  # fmt: skip
    for name in ("Z_w", "Z_delta", "M_w", "M_q", "M_delta"):
        assert getattr(short, name) == pytest.approx(getattr(general, name), rel=1e-12)


def test_trim_balances_forces_over_a_sweep():
    V, gamma = np.linspace(25.0, 70.0, 7), np.array([[-0.1], [0.0], [0.2]])
    trim = trim_level(WING, FRAME, V=V, rho=1.0, gamma=gamma)
    assert trim.alpha.shape == (3, 7)
    qS, weight = 0.5 * V**2, FRAME.mass * G
    lift = qS * (WING.CL0 + WING.CL_alpha * trim.alpha + WING.CL_delta * trim.delta)
    np.testing.assert_allclose(lift, weight * np.cos(gamma) + 0 * V, rtol=1e-12)
    moment = WING.CM0 + WING.CM_alpha * trim.alpha + WING.CM_delta * trim.delta
    np.testing.assert_allclose(moment, 0.0, atol=1e-15)
    np.testing.assert_allclose(trim.thrust, qS * trim.CD + weight * np.sin(gamma), rtol=1e-12)
    assert np.all(np.diff(trim.alpha[1]) < 0.0)  # faster is flatter
    glide = np.arctan(-trim.CD[1, 3] / trim.CL[1, 3])
    assert trim_level(WING, FRAME, V=V[3] * np.sqrt(np.cos(glide)), rho=1.0, gamma=glide).thrust == pytest.approx(
        0.0, abs=1e-9
    )


def test_moving_the_moment_point_and_static_margin():
    c = FRAME.chord
    x_np = neutral_point(WING, c)
    assert x_np == pytest.approx(0.3578, abs=1e-4)  # AVL's own neutral point (case thesis_wing)
    at_np = about_centre_of_gravity(WING, x_np, c)
    assert at_np.CM_alpha == pytest.approx(0.0, abs=1e-15)
    assert static_margin(WING, x_np + 0.05 * c, c) == pytest.approx(-0.05)
    for x in (0.2, 0.5):
        moved = about_centre_of_gravity(WING, x, c)
        assert static_margin(WING, x, c) == pytest.approx(-moved.CM_alpha / moved.CL_alpha)
        assert neutral_point(moved, c) == pytest.approx(x_np)
        back = about_centre_of_gravity(moved, WING.x, c)
        for name in WING.__dataclass_fields__:
            assert getattr(back, name) == pytest.approx(getattr(WING, name), abs=1e-12)


def test_moving_the_moment_point_moves_pitch_damping_as_a_rigid_plate():
    """A lifting point at x_a: C_L = a (alpha + q (x_a - x)/V), moment -(x_a - x) L: so C_Mq = -2 a d^2."""
    point = LongitudinalCoefficients(CL0=0.0, CL_alpha=4.0, CM0=0.0, CM_alpha=0.0, x=1.0)
    moved = about_centre_of_gravity(point, 0.6, 0.5)
    d = (1.0 - 0.6) / 0.5
    assert moved.CL_q == pytest.approx(2.0 * 4.0 * d)
    assert moved.CM_q == pytest.approx(-2.0 * 4.0 * d**2)
    assert moved.CM_alpha == pytest.approx(-4.0 * d)


def test_thesis_wing_modes_at_55_m_s():
    """Centre of gravity at the neutral point: a root at zero. 5 % of the chord behind it: a real unstable root."""
    wing = replace(WING, CL_alphadot=0.0, CM_alphadot=0.0)
    x_np = neutral_point(wing, FRAME.chord)
    moved = root_movement(wing, FRAME, x_np + FRAME.chord * np.array([-0.10, 0.0, 0.05]), V=55.0, rho=1.225)
    np.testing.assert_allclose(moved.static_margin, [0.10, 0.0, -0.05], atol=1e-12)
    ahead, at, behind = moved.roots
    assert ahead.real.max() < 0.0
    assert np.sum(ahead.imag > 0.0) == 2  # phugoid and short period
    assert np.abs(at).min() < 1e-10 * np.abs(at).max()
    unstable = behind[behind.real > 0.0]
    assert unstable.size == 1
    assert unstable.imag == pytest.approx(0.0)


def test_roots_move_continuously():
    x = neutral_point(WING, FRAME.chord) + FRAME.chord * np.linspace(-0.15, 0.05, 400)
    moved = root_movement(WING, FRAME, x, V=55.0, rho=1.225)
    assert np.abs(np.diff(moved.roots, axis=0)).max() < 0.15 * np.abs(moved.roots).max()
    assert moved.roots.shape == (400, 4)


def test_phugoid_tends_to_lanchesters():
    """No drag, very stiff in pitch: omega = sqrt(2) g/V, no damping."""
    stiff = replace(
        WING,
        CD0=0.0,
        CD_CL2=0.0,
        CM_alpha=-1e4,
        CL_q=0.0,
        CL_alphadot=0.0,
        CM_alphadot=0.0,
        CL_delta=0.0,
        CM0=0.0,
        CL0=0.0,
    )
    trim = trim_level(stiff, FRAME, V=60.0, rho=1.2)
    d = longitudinal_derivatives(trim_derivatives(stiff, FRAME, trim), FRAME, V=60.0, rho=1.2)
    phugoid = flight_modes(longitudinal_model(d, FRAME, V=60.0).A)[0]
    assert phugoid.name == "phugoid"
    assert phugoid.frequency == pytest.approx(np.sqrt(2.0) * G / 60.0, rel=1e-3)
    assert abs(phugoid.damping_ratio) < 1e-3


def test_short_period_is_the_two_by_two_problem():
    d = longitudinal_derivatives(
        StabilityDerivatives(CX_alpha=0.1, CZ_alpha=-4.0, CM_alpha=-0.5, CM_q=-3.0), FRAME, V=80.0, rho=1.2
    )
    _, denominator = pitch_rate_transfer(d, FRAME, V=80.0)
    omega = np.sqrt(denominator[2] / denominator[0])
    mode = flight_modes(longitudinal_model(d, FRAME, V=80.0).A)[1]
    assert mode.name == "short period"
    assert mode.frequency == pytest.approx(omega, rel=1e-3)
    assert mode.damping_ratio == pytest.approx(denominator[1] / denominator[0] / (2 * omega), rel=1e-2)


def test_mode_quantities():
    mode = FlightMode(name="phugoid", eigenvalue=-0.3 + 0.4j)
    assert (mode.frequency, mode.damping_ratio) == pytest.approx((0.5, 0.6))
    assert mode.period == pytest.approx(2 * np.pi / 0.4)
    assert mode.time_to_half == pytest.approx(np.log(2) / 0.3)
    real = FlightMode(name="aperiodic", eigenvalue=0.2 + 0j)
    assert real.period is None
    assert real.time_to_half == pytest.approx(-np.log(2) / 0.2)
    assert FlightMode(name="aperiodic", eigenvalue=0j).time_to_half is None
    assert FlightMode(name="aperiodic", eigenvalue=0j).damping_ratio == 0.0


def test_mode_names_when_they_lose_their_meaning():
    A = np.diag([1.0, -2.0, -3.0, -0.5])
    assert {m.name for m in flight_modes(A)} == {"aperiodic"}
    A[2:, 2:] = [[0.0, 4.0], [-4.0, -0.1]]
    assert [m.name for m in flight_modes(A)] == ["aperiodic", "aperiodic", "oscillation"]
    assert [m.name for m in flight_modes(A, "lateral")] == ["spiral", "roll", "Dutch roll"]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: Airframe(mass=0.0, Ixx=1, Iyy=1, Izz=1), r"mass must be positive \[kg\]"),
        (lambda: Airframe(mass=1.0, Ixx=1, Iyy=-1, Izz=1), r"Iyy must be positive \[kg m\^2\]"),
        (lambda: Airframe(mass=1.0, Ixx=1, Iyy=1, Izz=1, Ixz=1.5), "Ixz"),
        (lambda: longitudinal_derivatives(EVERYTHING, FRAME, V=0.0, rho=1.0), r"airspeed V must be positive \[m/s\]"),
        (lambda: lateral_derivatives(EVERYTHING, FRAME, V=1.0, rho=0.0), "density rho must be positive"),
        (lambda: StabilityAxisAero(derivatives=EVERYTHING, V=-1.0, rho=1.0), "airspeed V must be positive"),
        (lambda: longitudinal_model(LongitudinalDerivatives(), FRAME, V=-1.0), "airspeed V must be positive"),
        (
            lambda: longitudinal_model(LongitudinalDerivatives(Z_wdot=20.0), FRAME, V=1.0),
            "Z_wdot must be below the mass",
        ),
        (lambda: lateral_model(LateralDerivatives(), FRAME, V=0.0), "airspeed V must be positive"),
        (lambda: trim_level(WING, FRAME, V=0.0, rho=1.0), "airspeed V must be positive"),
        (lambda: trim_level(WING, FRAME, V=1.0, rho=-1.0), "density rho must be positive"),
        (lambda: trim_level(WING, FRAME, V=1.0, rho=1.0, gamma=2.0), "climb angle gamma"),
        (lambda: trim_level(replace(WING, CL_delta=0.0, CM_delta=0.0), FRAME, V=30.0, rho=1.0), "cannot trim"),
        (lambda: trim_derivatives(WING, FRAME, trim_level(WING, FRAME, V=[30.0, 40.0], rho=1.0)), "index it first"),
        (lambda: replace(WING, CL_alpha=0.0), "CL_alpha must be positive"),
        (lambda: replace(WING, CD0=-0.1), "CD0 and CD_CL2"),
        (lambda: static_margin(WING, 0.0, 0.0), "chord must be positive"),
        (lambda: about_centre_of_gravity(WING, 0.0, -1.0), "chord must be positive"),
        (lambda: flight_modes(np.eye(3)), "shape"),
        (lambda: flight_modes(np.eye(4), "roll"), "motion must be"),
    ],
)
def test_bad_input_says_why(call, words):
    with pytest.raises(ValueError, match=words):
        call()
