"""NACA R-496's flexure-torsion case as recomputed by NASA (Perry, NASA/TP-2015-218765, Appendix C)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from aeroservo.aero.lift_deficiency import generalized_theodorsen_function
from aeroservo.aero.strip import NO_WAKE, Indicial, QuasiSteady, Strips, Theodorsen, strip_aero, strip_shapes
from aeroservo.aero.theodorsen import section_air
from aeroservo.aeroelastic.build import THEORIES, build
from aeroservo.aeroelastic.flutter import PK, G, K, P, flutter
from aeroservo.aeroelastic.static import divergence
from aeroservo.aircraft.files import read
from aeroservo.datatypes import AeroelasticModel, FlightCondition, RationalAero, SampledAero
from aeroservo.structure.section import typical_section

FOOT = 0.3048  # m
RHO = 1.225  # kg/m^3, for which the preset's mass is made
EXACT = 1e-5  # relative, the case's own tolerance on exact C(k)
JONES = 1e-4  # relative: an approximation of C(k), figure given to six digits
SAME = 1e-10  # relative: one number by algebra that differs in rounding only
SWEEP = FlightCondition(V=np.linspace(5.0, 120.0, 24), rho=RHO)


def nasa(aero):
    return build(read("nasa-typical-section"), aero)


def without_wake():
    """C = 1 with apparent mass: a Python option that has no word of its own on the command line."""
    section = read("nasa-typical-section").section
    modes = typical_section(
        mass=section.mass_kg_per_m,
        static_moment=section.static_moment_kg,
        inertia=section.inertia_kg_m,
        plunge_stiffness=section.plunge_stiffness_N_per_m2,
        pitch_stiffness=section.pitch_stiffness_N,
    )
    zero, one = np.zeros(1), np.ones(1)
    strips = Strips(
        y=one,
        width=one,
        b=section.b * one,
        a=section.a * one,
        eccentricity=section.e * one,
        lift_slope=2.0 * np.pi * one,
        moment_rate=zero,
        sweep=zero,
        elevon_lift=zero,
        elevon_moment=zero,
        incidence=zero,
        cm0=zero,
        span=1.0,
    )
    air = strip_aero(strips, strip_shapes(modes, zero), modes.names, Indicial(wagner=NO_WAKE))[0]
    return AeroelasticModel(modes=modes, aero=air)


@pytest.mark.parametrize("method", [PK(), K(), G()])
def test_flutter_with_exact_circulation(method):
    result = flutter(nasa("theodorsen"), SWEEP, method)
    assert result.flutter_speed / FOOT == pytest.approx(173.26235, rel=EXACT)
    assert result.flutter_frequency == pytest.approx(75.46202, rel=EXACT)
    k = result.flutter_frequency * FOOT / result.flutter_speed
    assert k == pytest.approx(0.4355361, rel=EXACT)
    assert abs(result.flutter_speed / FOOT - 173.26) < 0.005  # as published
    assert abs(k - 0.4355) < 0.00005


@pytest.mark.parametrize("method", [P(), PK(), K(), G()])
def test_flutter_with_jones_lags(method):
    assert flutter(nasa("jones"), SWEEP, method).flutter_speed / FOOT == pytest.approx(172.857, rel=JONES)


@pytest.mark.parametrize(
    ("model", "speed"),
    [(nasa("quasi_steady"), 96.225), (nasa("quasi_steady_damped"), 133.982), (without_wake(), 100.011)],
)
def test_flutter_without_wake(model, speed):
    for method in (P(), PK(), K()):
        assert flutter(model, SWEEP, method).flutter_speed / FOOT == pytest.approx(speed, rel=EXACT)


@pytest.mark.parametrize("method", [PK(), K()])
def test_divergence_is_the_real_instability(method):
    result = flutter(nasa("theodorsen"), SWEEP, method)
    assert result.divergence_speed / FOOT == pytest.approx(353.553391, abs=6e-7)  # as printed
    assert result.first_real_instability == pytest.approx(result.divergence_speed, rel=1e-7)


def test_divergence_is_that_of_every_theory():
    speeds = [divergence(nasa(aero), SWEEP[0]).V for aero in THEORIES]
    speeds.append(divergence(without_wake(), SWEEP[0]).V)
    np.testing.assert_allclose(speeds, speeds[0], rtol=SAME)


def solved(determinant, root):
    """Newton's method on det F(s) = 0 for a function that need not be analytic."""
    s = root
    for _ in range(40):
        step = 1e-6 * abs(s)
        by_sigma = (determinant(s + step) - determinant(s - step)) / (2.0 * step)
        by_omega = (determinant(s + 1j * step) - determinant(s - 1j * step)) / (2.0 * step)
        value = determinant(s)
        jacobian = np.array([[by_sigma.real, by_omega.real], [by_sigma.imag, by_omega.imag]])
        change = np.linalg.solve(jacobian, [value.real, value.imag])
        s = s - (change[0] + 1j * change[1])
    return s


def air_forces(aero, form, V):
    """Q of a p-k method at s: with C(k) alone frozen (as the reference), or by Rodden's real form (as ours)."""
    section = section_air(-0.4, FOOT)

    def Q(s):
        if form == "C frozen":
            return section(s * FOOT / V, lambda p: generalized_theodorsen_function(1j * s.imag * FOOT / V))
        harmonic = aero(s.imag * FOOT / V)[:, :2]
        return harmonic.real + s / s.imag * harmonic.imag

    return Q


@pytest.mark.parametrize(("speed", "root"), [(170.0, -1.144 + 75.99j), (180.0, 2.144 + 74.59j)])
def test_roots_by_p_k_away_from_the_boundary(speed, root):
    # they differ by definition: the reference freezes C(k) alone, we take Re Q + p Im Q / k (NASA CR-3094)
    model, V = nasa("theodorsen"), speed * FOOT
    found = {}
    for form in ("C frozen", "Rodden"):
        Q = air_forces(model.aero, form, V)

        def determinant(s, Q=Q):
            return np.linalg.det(model.modes.dynamic_stiffness(s) - 0.5 * RHO * V**2 * Q(s))

        found[form] = solved(determinant, root)
    assert abs(found["C frozen"].real - root.real) < 0.0006
    assert abs(found["C frozen"].imag - root.imag) < 0.006
    result = flutter(model, FlightCondition(V=[V, 1.1 * V], rho=RHO), PK())
    assert np.abs(result.roots[0] - found["Rodden"]).min() < 1e-9 * abs(root)
    assert 0.01 < abs(found["Rodden"] - found["C frozen"]) < 0.5


def test_root_by_lags_at_170_feet_per_second():
    result = flutter(nasa("jones"), FlightCondition(V=[170.0 * FOOT, 60.0], rho=RHO), P())
    assert np.abs(result.roots[0] - (-1.047 + 75.03j)).min() < 0.006


@pytest.mark.parametrize(
    ("speed", "root", "digits"),
    [(170.0, -1.1504 + 75.8683j, 6e-5), (170.0, -31.4233 + 63.4831j, 6e-5), (180.0, 2.132 + 74.78j, 6e-3)],
)
def test_roots_with_circulation_continued_off_the_axis(speed, root, digits):
    modes, V, b = nasa("jones").modes, speed * FOOT, FOOT
    air = section_air(-0.4, b)

    def smallest(s):
        p = s * b / V
        C = generalized_theodorsen_function(p)
        Q = air.A0 + air.A1 * p + air.A2 * p**2 + C * np.outer(air.R, air.w0 + air.w1 * p)
        return np.linalg.det(modes.dynamic_stiffness(s) - 0.5 * RHO * V**2 * Q)

    s = root
    for _ in range(20):  # Newton, with a complex difference for the slope
        step = 1e-6 * abs(s)
        s = s - smallest(s) * 2.0 * step / (smallest(s + step) - smallest(s - step))
    assert abs(s.real - root.real) < digits
    assert abs(s.imag - root.imag) < digits


@pytest.mark.parametrize("aero", ["jones", "theodorsen"])
def test_vacuum_leaves_the_frequencies_of_the_structure(aero):
    sweep = FlightCondition(V=[5.0, 50.0, 100.0], rho=0.0)
    model = nasa(aero)
    # (1 - x^2/r^2) z^2 - (1 + w^2) z + w^2 = 0 in z = (omega/100)^2, w = 1/2, x = 0.2, r^2 = 0.25
    natural = 100.0 * np.sqrt(np.sort(np.roots([1.0 - 0.2**2 / 0.25, -1.25, 0.25]).real))
    for method in (P(fit_bound=0.1), PK(), G()):
        result = flutter(model, sweep, method)
        swinging = np.sort(result.frequency[:, :2], axis=1)
        np.testing.assert_allclose(swinging, np.broadcast_to(natural, (3, 2)), rtol=1e-9)
        np.testing.assert_allclose(result.damping_ratio[:, :2], 0.0, atol=1e-9)
        assert not result.found


def transformed(model, T):
    """The same model in other coordinates q = T q'."""
    m, a, n = model.modes, model.aero, model.modes.n
    modes = replace(m, M=T.T @ m.M @ T, D=T.T @ m.D @ T, K=T.T @ m.K @ T, phi=m.phi @ T)
    right = np.eye(len(a.inputs))
    right[:n, :n] = T
    if isinstance(a, SampledAero):
        return replace(model, modes=modes, aero=replace(a, Q=T.T @ a.Q @ right), loads=None)
    assert isinstance(a, RationalAero)
    parts = {name: T.T @ getattr(a, name) @ right for name in ("A0", "A1", "A2")}
    return replace(model, modes=modes, aero=replace(a, **parts, lag_D=T.T @ a.lag_D, lag_E=a.lag_E @ right), loads=None)


@pytest.mark.parametrize(
    "T",
    [np.diag([1000.0, 0.01]), np.diag([-1.0, 1.0]), np.array([[1.0, 0.3], [-0.2, 1.0]])],
    ids=["scaled", "sign", "mixed"],
)
@pytest.mark.parametrize(("aero", "method"), [("jones", P()), ("theodorsen", PK()), ("theodorsen", K())])
def test_coordinates_move_no_speed(aero, method, T):
    one, two = (flutter(model, SWEEP, method) for model in (nasa(aero), transformed(nasa(aero), T)))
    np.testing.assert_allclose(two.crossings, one.crossings, rtol=1e-9)
    assert two.divergence_speed == pytest.approx(one.divergence_speed, rel=SAME)
    if not isinstance(method, K):
        np.testing.assert_allclose(np.sort_complex(two.roots), np.sort_complex(one.roots), rtol=1e-8, atol=1e-7)


def test_theories_are_the_ones_they_say():
    assert isinstance(THEORIES["theodorsen"](), Theodorsen)
    assert isinstance(THEORIES["jones"](), Indicial)
    assert THEORIES["quasi_steady"]() == QuasiSteady(damped=False)
    assert THEORIES["quasi_steady_damped"]() == QuasiSteady(damped=True)
