"""The binary wing's matrices derived from the virtual work, symbol by symbol, and compared with the code's numbers."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from aeroservo.aero.strip import QuasiSteady, Strips, strip_aero, strip_shapes
from aeroservo.structure.assumed import binary_wing, whole_aircraft

IDENTITY = 1e-13  # relative: the same polynomial integrals, symbolic and numeric

VALUES = {"s": 2.3, "c": 0.7, "x_f": 0.28, "mu": 6.0, "m_s": 0.9, "M_c": 1.7}
AERO = {"a_w": 4.1, "e": 0.17, "M_td": -0.8, "a_c": 1.3, "b_c": -0.27}

y, x = sp.symbols("y x")
s, c, x_f, mu, m_s, M_c = sp.symbols("s c x_f mu m_s M_c", positive=True)
a_w, e, M_td, a_c, b_c, rho, V, w_g, delta = sp.symbols("a_w e M_td a_c b_c rho V w_g delta")
q = sp.Matrix(sp.symbols("q_b q_t q_h"))
rates = sp.Matrix(sp.symbols("r_b r_t r_h"))
SHAPE_H = sp.Matrix([[(y / s) ** 2, 0, 1]])  # plunge of the axis, down
SHAPE_T = sp.Matrix([[0, y / s, 0]])  # twist, nose up


def kinetic_matrix():
    """Second derivatives of the kinetic energy: h = (y/s)^2 q_b + (x - x_f)(y/s) q_t + q_h."""
    velocity = (SHAPE_H * rates)[0] + (x - x_f) * (SHAPE_T * rates)[0]
    energy = mu / 2 * sp.integrate(sp.integrate(sp.expand(velocity**2), (x, 0, c)), (y, 0, s))
    edge = velocity.subs(x, 0)
    energy += m_s / 2 * sp.integrate(sp.expand(edge**2), (y, 0, s)) + M_c / 2 * rates[2] ** 2
    return sp.hessian(energy, list(rates))


def generalised_force():
    """Virtual work of dL (up) on h (down) and of dM (nose up) on theta, over the span."""
    h_rate, theta, theta_rate = (SHAPE_H * rates)[0], (SHAPE_T * q)[0], (SHAPE_T * rates)[0]
    alpha = theta + h_rate / V + w_g / V
    lift = rho * V**2 / 2 * c * (a_w * alpha + a_c * delta)
    moment = rho * V**2 / 2 * c**2 * (e * a_w * alpha + b_c * delta + M_td * theta_rate * c / (4 * V))
    work = -lift * SHAPE_H.T + moment * SHAPE_T.T
    return work.applyfunc(lambda f: sp.integrate(sp.expand(f), (y, 0, s)))


def number(matrix):
    values = {sp.Symbol(k, positive=True): v for k, v in VALUES.items()} | {sp.Symbol(k): v for k, v in AERO.items()}
    return np.array(matrix.subs(values).tolist(), dtype=float)


def ours():
    v = VALUES
    common = {"semi_span": v["s"], "chord": v["c"], "flexural_axis": v["x_f"] / v["c"], "mass_per_area": v["mu"]}
    common |= {"plunge_stiffness": 900.0, "pitch_stiffness": 300.0, "leading_edge_mass": v["m_s"]}
    points, weight = np.polynomial.legendre.leggauss(6)
    points, weight = 0.5 * v["s"] * (points + 1.0), 0.5 * v["s"] * weight
    modes = whole_aircraft(**common, centre_mass=v["M_c"], points=points)
    one = np.ones(6)
    strips = Strips(
        y=points,
        width=weight,
        b=0.5 * v["c"] * one,
        a=(2.0 * v["x_f"] / v["c"] - 1.0) * one,
        eccentricity=AERO["e"] * one,
        lift_slope=AERO["a_w"] * one,
        moment_rate=AERO["M_td"] * one,
        sweep=0.0 * one,
        elevon_lift=AERO["a_c"] * one,
        elevon_moment=AERO["b_c"] * one,
        incidence=0.0 * one,
        cm0=0.0 * one,
        span=v["s"],
    )
    aero = strip_aero(strips, strip_shapes(modes, strips.sweep), modes.names, QuasiSteady(damped=True))[0]
    return modes, aero, binary_wing(**common)


def test_mass_matrix_of_the_kinetic_energy():
    modes, _, clamped = ours()
    expected = number(kinetic_matrix())
    np.testing.assert_allclose(modes.M, expected, rtol=IDENTITY)
    np.testing.assert_allclose(clamped.M, expected[:2, :2], rtol=IDENTITY)
    np.testing.assert_allclose(np.diag(modes.K), [900.0, 300.0, 0.0])


def test_mass_matrix_is_that_of_the_equations():
    A = sp.Matrix(
        [[c / 5, (c**2 / 2 - c * x_f) / 4], [(c**2 / 2 - c * x_f) / 4, (c**3 / 3 - c**2 * x_f + c * x_f**2) / 3]]
    )
    assert sp.simplify(kinetic_matrix()[:2, :2].subs({m_s: 0}) - mu * s * A) == sp.zeros(2, 2)
    assert sp.simplify(
        kinetic_matrix()[:2, 2].subs({m_s: 0}) - mu * s * sp.Matrix([c / 3, (c**2 / 2 - c * x_f) / 2])
    ) == (sp.zeros(2, 1))


def test_air_forces_of_the_virtual_work():
    aero = ours()[1]
    force = generalised_force()
    b = 0.5 * VALUES["c"]
    # F = q_bar (A0 q + A1 (b/V) q' + columns), q_bar = rho V^2/2
    A0 = number((force.jacobian(q) * 2 / (rho * V**2)).applyfunc(sp.simplify))
    A1 = number((force.jacobian(rates) * 2 / (rho * V)).applyfunc(sp.simplify)) / b
    np.testing.assert_allclose(aero.A0[0][:, :3], A0, rtol=IDENTITY, atol=1e-15)
    np.testing.assert_allclose(aero.A1[0][:, :3], A1, rtol=IDENTITY, atol=1e-15)
    assert not np.any(aero.A2)
    columns = {i.name: j for j, i in enumerate(aero.inputs)}
    g = number((force.jacobian([delta]) * 2 / (rho * V**2)).applyfunc(sp.simplify))[:, 0]
    h_g = number((force.jacobian([w_g]) * 2 / (rho * V)).applyfunc(sp.simplify))[:, 0]
    np.testing.assert_allclose(aero.A0[0][:, columns["elevon"]], g, rtol=IDENTITY)
    np.testing.assert_allclose(aero.A0[0][:, columns["gust"]], h_g, rtol=IDENTITY)
    np.testing.assert_allclose(aero(0.0)[:, columns["incidence"]].real, h_g, rtol=IDENTITY)


def test_virtual_work_gives_the_matrices_of_the_equations():
    # equations.md, "Binary wing" and "Whole aircraft": rho V B q' and rho V^2 C q on the left
    force = generalised_force()
    B = -(force.jacobian(rates) / (rho * V)).applyfunc(sp.simplify)
    C = -(force.jacobian(q) / (rho * V**2)).applyfunc(sp.simplify)
    binary_B = sp.Matrix([[c * s * a_w / 10, 0], [-(c**2) * s * e * a_w / 8, -(c**3) * s * M_td / 24]])
    binary_C = sp.Matrix([[0, c * s * a_w / 8], [0, -(c**2) * s * e * a_w / 6]])
    assert sp.simplify(B[:2, :2] - binary_B) == sp.zeros(2, 2)
    assert sp.simplify(C[:2, :2] - binary_C) == sp.zeros(2, 2)
    heave = sp.Matrix([c * s * a_w / 6, -(c**2) * s * e * a_w / 4, c * s * a_w / 2])
    assert sp.simplify(B[:, 2] - heave) == sp.zeros(3, 1)
    assert sp.simplify(B[2, 0] - c * s * a_w / 6) == 0
    assert sp.simplify(C[2, 1] - c * s * a_w / 4) == 0
    elevon = (force.jacobian([delta]) / (rho * V**2)).applyfunc(sp.simplify)
    assert sp.simplify(elevon - sp.Matrix([-c * s * a_c / 6, c**2 * s * b_c / 4, -c * s * a_c / 2])) == sp.zeros(3, 1)
    gust = (force.jacobian([w_g]) / (rho * V)).applyfunc(sp.simplify)
    assert sp.simplify(gust - sp.Matrix([-c * s * a_w / 6, c**2 * s * e * a_w / 4, -c * s * a_w / 2])) == sp.zeros(3, 1)


def test_strip_mass_moves_the_centre_of_mass_as_7_41():
    # X_cm = m c^2 / (2 (m c + m_s)): ratio of the heave row's static moment about the leading edge to its mass
    modes, _, _ = ours()
    v = VALUES
    mass = modes.M[2, 2] - v["M_c"]
    moment = 2.0 * modes.M[1, 2] + v["x_f"] * mass  # int y/s = s/2: the coupling is half the static moment
    assert moment / mass == pytest.approx(v["mu"] * v["c"] ** 2 / (2.0 * (v["mu"] * v["c"] + v["m_s"])), rel=IDENTITY)


def test_grid_and_shapes_of_a_swept_wing():
    sweep = 0.4
    modes = whole_aircraft(
        semi_span=2.0,
        chord=0.5,
        flexural_axis=0.4,
        mass_per_area=5.0,
        plunge_stiffness=1.0,
        pitch_stiffness=1.0,
        sweep=sweep,
    )
    np.testing.assert_allclose(modes.grid[-1], [0.2 / np.cos(sweep) + 2.0 * np.sin(sweep), 2.0 * np.cos(sweep), 0.0])
    shapes = strip_shapes(modes, np.array([sweep]))
    np.testing.assert_allclose(shapes.h, [[1.0, 0.0, 1.0]], atol=1e-15)
    np.testing.assert_allclose(shapes.twist, [[0.0, 1.0, 0.0]], atol=1e-15)
    np.testing.assert_allclose(shapes.slope, [[1.0, 0.0, 0.0]], atol=1e-15)  # d(y/s)^2/dy = 2/s at the tip
