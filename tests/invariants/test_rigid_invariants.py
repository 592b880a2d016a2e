"""What a free rigid body keeps: energy, momentum, angular momentum."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.integrate import solve_ivp

from aeroservo.flight.rigid import (
    Airframe,
    aircraft_rates,
    angular_momentum,
    mechanical_energy,
    rigid_body_rates,
    rotation_to_earth,
)

CONSERVED = 1e-10  # issue 6
POINTWISE = 1e-11  # power balance: rounding of sums of order 1e3
G = 9.80665
TENSOR = np.array([[2.0, -0.2, -0.5], [-0.2, 3.5, 0.1], [-0.5, 0.1, 4.6]])  # no plane of symmetry
NOTHING = (np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3))
values = arrays(float, 12, elements=st.floats(-5.0, 5.0))
vectors = arrays(float, 3, elements=st.floats(-10.0, 10.0))


def fly(state, seconds, gravity, mass=7.0):
    zero = np.zeros(3)
    solution = solve_ivp(
        lambda t, x: rigid_body_rates(x, zero, zero, mass=mass, inertia=TENSOR, gravity=gravity),
        (0.0, seconds), state, method="DOP853", rtol=1e-13, atol=1e-13,
    )  # fmt: skip
    assert solution.success
    return solution.y.T


@pytest.mark.parametrize("gravity", [0.0, G])
def test_energy_and_angular_momentum_in_free_motion(gravity):
    """Spin near the axis of largest inertia, so that the angles stay clear of theta = 90 deg; 10 s, about 10 turns."""
    start = np.array([30.0, 2.0, -1.0, 0.8, -0.5, 6.0, 0.1, -0.2, 0.3, 0.0, 0.0, -500.0])
    path = fly(start, 10.0, gravity)
    assert np.abs(path[:, 7]).max() < 1.2
    energy = mechanical_energy(path, mass=7.0, inertia=TENSOR, gravity=gravity)
    assert np.abs(energy / energy[0] - 1.0).max() < CONSERVED
    H = angular_momentum(path, TENSOR)
    assert np.abs(H - H[0]).max() / np.linalg.norm(H[0]) < CONSERVED
    velocity = (rotation_to_earth(path[:, 6], path[:, 7], path[:, 8]) @ path[:, :3, None])[..., 0]
    horizontal = velocity[:, :2]
    assert np.abs(horizontal - horizontal[0]).max() < CONSERVED * np.linalg.norm(start[:3])


def test_free_fall_is_a_parabola():
    start = np.array([20.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    principal = np.diag([1.0, 2.0, 3.0])
    zero = np.zeros(3)
    end = solve_ivp(
        lambda t, x: rigid_body_rates(x, zero, zero, mass=1.0, inertia=principal, gravity=G),
        (0.0, 2.0), start, method="DOP853", rtol=1e-13, atol=1e-13,
    ).y[:, -1]  # fmt: skip
    np.testing.assert_allclose(end[9:], [40.0, 0.0, 2.0 * G], atol=1e-8)
    assert end[8] == pytest.approx(6.0)


@settings(max_examples=60, deadline=None)
@given(state=values, force=vectors, moment=vectors)
def test_power_balance_at_any_state(state, force, moment):
    """dE/dt = F v + M omega and dH/dt = R M, by a complex step along the motion."""
    if abs(np.cos(state[7])) < 0.05:
        state[7] = 0.3
    rate = rigid_body_rates(state, force, moment, mass=3.0, inertia=TENSOR, gravity=G)
    h = 1e-40
    ahead = state + 1j * h * rate
    power = mechanical_energy(ahead, mass=3.0, inertia=TENSOR, gravity=G).imag / h
    scale = 1e3 + np.abs(rate).max()
    assert abs(power - force @ state[:3] - moment @ state[3:6]) < POINTWISE * scale
    turning = angular_momentum(ahead, TENSOR).imag / h
    expected = rotation_to_earth(*state[6:9]) @ moment
    assert np.abs(turning - expected).max() < POINTWISE * scale


@settings(max_examples=40, deadline=None)
@given(angles=arrays(float, 3, elements=st.floats(-3.0, 3.0)))
def test_rotation_is_orthogonal_and_right_handed(angles):
    R = rotation_to_earth(*angles)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(R) == pytest.approx(1.0)


@settings(max_examples=40, deadline=None)
@given(state=values)
def test_attitude_rates_are_the_rotation_of_the_body(state):
    """R' = R omega x: the errata of (5.17) in one line."""
    if abs(np.cos(state[7])) < 0.05:
        state[7] = 0.3
    rate = rigid_body_rates(state, np.zeros(3), np.zeros(3), mass=1.0, inertia=TENSOR)
    h = 1e-40
    R_dot = rotation_to_earth(*(state[6:9] + 1j * h * rate[6:9])).imag / h
    p, q, r = state[3:6]
    cross = np.array([[0.0, -r, q], [r, 0.0, -p], [-q, p, 0.0]])
    np.testing.assert_allclose(R_dot, rotation_to_earth(*state[6:9]) @ cross, atol=1e-9)


def test_symmetric_aircraft_reduces_to_the_thesis_equations():
    """(5.7-5.12) written out, with I_xz."""
    body = Airframe(mass=4.0, Ixx=1.5, Iyy=2.0, Izz=3.0, Ixz=0.4)
    rng = np.random.default_rng(0)
    x = rng.normal(size=(50, 12))
    x[:, 7] *= 0.3
    F, M = rng.normal(size=(2, 50, 3))
    rate = rigid_body_rates(x, F, M, mass=body.mass, inertia=body.inertia, gravity=0.0)
    u, v, w, p, q, r = x[:, :6].T
    du, dv, dw, dp, dq, dr = rate[:, :6].T
    Ix, Iy, Iz, Ixz = body.Ixx, body.Iyy, body.Izz, body.Ixz
    left = np.stack([
        4 * (du - r * v + q * w), 4 * (dv - p * w + r * u), 4 * (dw - q * u + p * v),
        Ix * dp - (Iy - Iz) * q * r - Ixz * (p * q + dr),
        Iy * dq + (Ix - Iz) * p * r + Ixz * (p**2 - r**2),
        Iz * dr - (Ix - Iy) * p * q + Ixz * (q * r - dp),
    ], axis=-1)  # fmt: skip
    np.testing.assert_allclose(left, np.concatenate([F, M], axis=-1), atol=1e-12)


def test_aircraft_without_air_is_a_free_body_and_batches():
    body = Airframe(mass=4.0, Ixx=1.5, Iyy=2.0, Izz=3.0, Ixz=0.4)
    x = np.random.default_rng(1).normal(size=(3, 5, 12))
    x[..., 7] *= 0.3
    controls = np.zeros((3, 5, 4))
    got = aircraft_rates(x, controls, lambda s, c, a: NOTHING, body)
    want = rigid_body_rates(x, np.zeros(3), np.zeros(3), mass=4.0, inertia=body.inertia)
    np.testing.assert_array_equal(got, want)
    one = rigid_body_rates(x[2, 3], np.zeros(3), np.zeros(3), mass=4.0, inertia=body.inertia)
    np.testing.assert_allclose(got[2, 3], one, rtol=1e-14)
