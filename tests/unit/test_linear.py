"""State spaces: the same eigenvalues and the same frequency responses as the equation they were made from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.linear import displacement_free, linear_system, state_matrix
from aeroservo.aircraft.files import read
from aeroservo.datatypes import FlightCondition

IDENTITY = 1e-9  # relative: transfer functions by states and by the s-plane equation, rounding of one solve each
PRESETS = [
    ("nasa-typical-section", "jones"),
    ("thesis-binary", "quasi_steady_damped"),
    ("thesis-binary", "jones"),
    ("thesis-aircraft", "jones"),
    ("goland", "jones"),
]
SWEEP = FlightCondition(V=[15.0, 45.0, 80.0], rho=1.1)


def with_damper(model):
    rng = np.random.default_rng(6)
    R = rng.normal(size=model.modes.M.shape)
    D = 0.05 * np.sqrt(np.diag(model.modes.M))[:, None] * (R @ R.T) * np.sqrt(np.diag(model.modes.M))
    return replace(model, modes=replace(model.modes, D=D))


def response(model, condition, s):
    """q / u from (s^2 M + s D + K - q_bar Q(s b/V)) q = q_bar Q_u u, gusts per m/s."""
    n, aero = model.modes.n, model.aero
    columns = aero.columns("control") + aero.columns("gust")
    Q = aero.laplace(s * aero.b / condition.V, condition.mach)
    unit = np.array([1.0] * len(aero.columns("control")) + [1.0 / condition.V] * len(aero.columns("gust")))
    F = model.modes.dynamic_stiffness(s) - condition.q * Q[:, :n]
    return np.linalg.solve(F, condition.q * Q[:, columns] * unit)


@pytest.mark.parametrize(("preset", "aero"), PRESETS)
def test_frequency_response_is_that_of_the_equation(preset, aero):
    model = with_damper(build(read(preset), aero))
    system, n = linear_system(model, SWEEP), model.modes.n
    for i in range(3):
        one = system[i]
        for s in (0.3j, 20.0j, 200.0j, 1.0 + 30.0j):
            x = np.linalg.solve(s * np.eye(len(one.states)) - one.A, one.B)
            expected = response(model, SWEEP[i], s)
            scale = np.abs(expected).max()
            np.testing.assert_allclose((one.C @ x + one.D)[:n], expected, rtol=1e-7, atol=IDENTITY * scale)
            np.testing.assert_allclose((one.C @ x)[n : 2 * n], s * expected, rtol=1e-7, atol=IDENTITY * scale * abs(s))


@pytest.mark.parametrize(("preset", "aero"), PRESETS)
def test_eigenvalues_are_those_of_the_p_method_and_the_zeros_of_free_modes(preset, aero):
    model = build(read(preset), aero)
    free = int(displacement_free(model.modes, model.aero).sum())
    assert free == (1 if preset == "thesis-aircraft" else 0)
    full = np.linalg.eigvals(linear_system(model, SWEEP).A)
    reduced = np.linalg.eigvals(state_matrix(model, SWEEP))
    for a, b in zip(full, reduced):
        size = np.abs(a).max()
        zeros = np.argsort(np.abs(a))[:free]
        np.testing.assert_allclose(np.abs(a[zeros]), 0.0, atol=1e-9 * size)
        rest = np.delete(a, zeros)
        # lags share poles: multiple eigenvalues split by the square root of rounding
        distance = np.abs(rest[:, None] - b[None, :]).min(axis=1)
        assert distance.max() < 1e-6 * size


@pytest.mark.parametrize(("preset", "aero"), PRESETS)
def test_roots_solve_the_equation(preset, aero):
    model = build(read(preset), aero)
    values = np.linalg.eigvals(state_matrix(model, SWEEP))
    n = model.modes.n
    for i in range(3):
        for s in values[i][values[i].imag > 1.0]:
            condition = SWEEP[i]
            Q = model.aero.laplace(s * model.aero.b / condition.V)[:, :n]
            F = model.modes.dynamic_stiffness(s) - condition.q * Q
            scale = 1.0 / np.sqrt(np.abs(np.diag(s**2 * model.modes.M)))
            F = F * np.outer(scale, scale)
            sizes = np.linalg.svd(F, compute_uv=False)
            assert sizes[-1] < 1e-8 * sizes[0]


def test_batch_is_the_stack_of_its_conditions():
    model = build(read("thesis-binary"), "jones")
    grid = FlightCondition(V=[[20.0, 30.0], [40.0, 50.0]], rho=[[1.2], [0.9]])
    batch = linear_system(model, grid)
    assert batch.A.shape[:2] == (2, 2)
    one = linear_system(model, grid[1, 0])
    for name in "ABCD":
        np.testing.assert_allclose(getattr(batch[1, 0], name), getattr(one, name), rtol=1e-14)


def test_names_carry_units_and_become_python_control():
    system = linear_system(build(read("nasa-typical-section"), "jones"), SWEEP[0])
    assert system.states[:4] == ("plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s")
    assert system.inputs == ("gust_m_s",)
    view = system.to_control()
    s = 40.0j
    np.testing.assert_allclose(view(s), system.C @ np.linalg.solve(s * np.eye(len(system.states)) - system.A, system.B))


def test_steady_response_to_a_long_gust_is_that_to_an_incidence():
    # w_g / V for ever is an incidence: the clamped wing settles at its static deflection
    model = build(read("thesis-binary"), "jones")
    condition = SWEEP[0]
    system = linear_system(model, condition)
    gust = system.inputs.index("gust_m_s")
    settled = -np.linalg.solve(system.A, system.B)[:2, gust] * condition.V
    Q = model.aero(0.0).real
    K = model.modes.K - condition.q * Q[:, :2]
    expected = np.linalg.solve(K, condition.q * Q[:, model.column("incidence")])
    np.testing.assert_allclose(settled, expected, rtol=1e-10)


def test_what_has_no_state_space_is_refused():
    with pytest.raises(ValueError, match="fit the samples first"):
        state_matrix(build(read("goland"), "theodorsen"), SWEEP)
    model = build(read("thesis-binary"), "jones")
    with pytest.raises(ValueError, match="hysteretic"):
        state_matrix(replace(model, modes=replace(model.modes, hysteretic_g=0.02)), SWEEP)
