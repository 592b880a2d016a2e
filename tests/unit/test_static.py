"""Statics against the closed forms of equations.md, "Static aeroelasticity"."""

from __future__ import annotations

import numpy as np
import pytest

from aeroservo.aero.strip import QuasiSteady, Strips, StripShapes, strip_aero
from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.static import divergence, elastic_stiffness, reversal, static
from aeroservo.aircraft.files import read
from aeroservo.aircraft.overrides import override
from aeroservo.datatypes import AeroelasticModel, AeroInput, FlightCondition, ModalModel, SampledAero, StaticLoads

CLOSED = 1e-12  # relative: one closed form by two routes
AIR = FlightCondition(V=1.0, rho=1.225)
BINARY = build(read("thesis-binary"))
WING = read("thesis-binary").wing


def at_pressures(q):
    """A sweep with given dynamic pressures."""
    return FlightCondition(V=np.sqrt(2.0 * np.asarray(q) / 1.225), rho=1.225)


def reversal_pressures(w):
    """Roll (7.18-7.19) and lift reversal of the binary wing, GJ = K_theta s."""
    GJ, c, s, a, e = w.K_theta * w.semi_span_m, w.chord_m, w.semi_span_m, w.lift_slope_per_rad, w.e
    lift, moment = w.elevon.lift_per_rad, w.elevon.moment_per_rad
    roll = 3.0 * GJ * lift / (c**2 * s**2 * a * (e * lift - moment))
    return roll, 12.0 * GJ * lift / (c**2 * s**2 * a * (4.0 * e * lift - 3.0 * moment))


def test_divergence_of_a_section():
    section = read("nasa-typical-section").section
    q = section.pitch_stiffness_N / (section.e * section.chord_m**2 * section.lift_slope_per_rad)
    assert divergence(build(read("nasa-typical-section"), "jones"), AIR).q == pytest.approx(q, rel=CLOSED)


def test_divergence_of_the_binary_wing():
    q = 3.0 * WING.K_theta / (WING.e * WING.chord_m**2 * WING.semi_span_m * WING.lift_slope_per_rad)
    found = divergence(BINARY, AIR)
    assert found.q == pytest.approx(q, rel=CLOSED)
    assert pytest.approx(81.00479, rel=1e-6) == found.V


def test_whole_aircraft_diverges_as_the_clamped_wing():
    aircraft = build(read("thesis-aircraft"))
    assert elastic_stiffness(aircraft)[0].tolist() == [0, 1]
    assert divergence(aircraft, AIR).q == pytest.approx(divergence(BINARY, AIR).q, rel=CLOSED)


@pytest.mark.parametrize("moment", [-0.05, -0.1861452, -0.4])
def test_reversal_of_roll_and_of_lift(moment):
    file = override(read("thesis-binary"), {"wing.elevon.moment_per_rad": moment})
    roll, lift = reversal_pressures(file.wing)
    model = build(file)
    assert reversal(model, AIR)[0] == "roll"
    assert reversal(model, AIR)[1].q == pytest.approx(roll, rel=CLOSED)
    assert reversal(model, AIR, quantity="lift")[1].q == pytest.approx(lift, rel=CLOSED)


def test_roll_effectiveness_is_linear_in_pressure_and_held_roll_is_singular_at_divergence():
    q_R, q_D = reversal_pressures(WING)[0], divergence(BINARY, AIR).q
    q = q_D * np.array([1e-6, 0.1, 0.3, 0.46, 0.8, 0.99])
    result = static(BINARY, at_pressures(q))
    np.testing.assert_allclose(result.effectiveness, 1.0 - q / q_R, rtol=0, atol=1e-11)
    held = (1.0 - q / q_R) / (1.0 - q / q_D)
    np.testing.assert_allclose(result.moment_effectiveness, held, rtol=1e-10, atol=1e-11)
    # [7.20-7.21]: M/delta = q c s^2 [C_Ld + q c^2 s^2 C_La C_Md / (3 GJ - q c^2 s^2 e C_La)], over its value at rest
    c2s2, GJ = (WING.chord_m * WING.semi_span_m) ** 2, WING.K_theta * WING.semi_span_m
    a, lift, moment = WING.lift_slope_per_rad, WING.elevon.lift_per_rad, WING.elevon.moment_per_rad
    thesis = 1.0 + q * c2s2 * a * moment / lift / (3.0 * GJ - q * c2s2 * WING.e * a)
    np.testing.assert_allclose(result.moment_effectiveness, thesis, rtol=1e-10, atol=1e-11)


def test_nothing_is_given_past_divergence():
    q_D = divergence(BINARY, AIR).q
    result = static(BINARY, at_pressures([0.5 * q_D, 1.5 * q_D]))
    for values in (result.effectiveness, result.moment_effectiveness, result.twist, result.trim_twist):
        assert np.isfinite(values[0])
        assert np.isnan(values[1])


def test_twist_and_lift_slope_of_the_binary_wing():
    # one twist shape: q_t = (q/q_D) (3/2) / (1 - q/q_D) per radian of incidence, lift ratio 1 + q_t/2
    q_D = divergence(BINARY, AIR).q
    part = np.array([0.1, 0.5, 0.9])
    result = static(BINARY, at_pressures(part * q_D))
    np.testing.assert_allclose(result.twist, 1.5 * part / (1.0 - part), rtol=1e-10)
    np.testing.assert_allclose(result.lift_slope_ratio, 1.0 + 0.75 * part / (1.0 - part), rtol=1e-10)
    rigid = BINARY.mass * 9.80665 / (part * q_D * WING.chord_m * WING.semi_span_m * WING.lift_slope_per_rad)
    np.testing.assert_allclose(result.trim_incidence, rigid / result.lift_slope_ratio, rtol=1e-10)
    np.testing.assert_allclose(result.trim_twist, result.trim_incidence * result.twist, rtol=1e-10)


def test_uniform_wing_by_many_modes_7_9_and_7_10():
    # lambda^2 = q e c^2 a/GJ; twist (per incidence) tan(ls) sin(ly) + cos(ly) - 1; diverges at ls = pi/2
    goland = read("goland")
    w, s = goland.wing.station[0], 6.096
    model = build(goland, "quasi_steady")
    e, a = w.flexural_axis - 0.25, goland.wing.lift_slope_per_rad
    q_D = np.pi**2 / 4.0 * w.GJ_N_m2 / (e * w.chord_m**2 * s**2 * a)
    assert divergence(model, AIR).q == pytest.approx(q_D, rel=1e-4)  # modes twist less freely than the wing
    q = q_D * np.array([0.05, 0.3, 0.6, 0.9])
    ls = 0.5 * np.pi * np.sqrt(q / q_D)
    result = static(model, at_pressures(q))
    np.testing.assert_allclose(result.twist, np.tan(ls) * np.sin(ls) + np.cos(ls) - 1.0, rtol=2e-3)
    np.testing.assert_allclose(result.lift_slope_ratio, np.tan(ls) / ls, rtol=2e-3)


def rigid_swept_wing(sweep, K_kappa, K_theta, e=0.2):
    """Rigid wing of streamwise chord 1 and span 3 on two root springs; the modes are its two rotations."""
    chord, span, slope = 1.0 * np.cos(sweep), 3.0, 5.0
    points, weight = np.polynomial.legendre.leggauss(8)
    along, width = 0.5 * span / np.cos(sweep) * (points + 1.0), 0.5 * span / np.cos(sweep) * weight
    one = np.ones(8)
    strips = Strips(
        y=along * np.cos(sweep),
        width=width,
        b=0.5 * chord * one,
        a=(2.0 * (e + 0.25) - 1.0) * one,
        eccentricity=e * one,
        lift_slope=slope * one,
        moment_rate=0.0 * one,
        sweep=sweep * one,
        elevon_lift=0.0 * one,
        elevon_moment=0.0 * one,
        incidence=0.0 * one,
        cm0=0.0 * one,
        span=span,
    )
    zero = 0.0 * one
    shapes = StripShapes(
        h=np.stack([along, zero], axis=1), twist=np.stack([zero, one], axis=1), slope=np.stack([one, zero], axis=1)
    )
    aero = strip_aero(strips, shapes, ("kappa", "theta"), QuasiSteady())[0]
    modes = ModalModel(M=np.eye(2), D=np.zeros((2, 2)), K=np.diag([K_kappa, K_theta]), names=("kappa", "theta"))
    return AeroelasticModel(modes=modes, aero=aero), slope * np.cos(sweep), span


@pytest.mark.parametrize("sweep_deg", [-35.0, -10.0, 0.0, 5.0, 20.0, 45.0])
@pytest.mark.parametrize("K_kappa", [1e2, 1e3, 1e12])
def test_swept_divergence_on_root_springs_7_11(sweep_deg, K_kappa):
    # 1/q_D = a_w [e c^2 s cos^2 L / K_theta - c s^2 tan L / (2 K_kappa)]; strips normal to the axis have their centre
    # of pressure normal to it, so the term e c^2 s sin^2 L / K_kappa of streamwise sections is not theirs
    sweep, K_theta, e = np.radians(sweep_deg), 300.0, 0.2
    model, a_w, s = rigid_swept_wing(sweep, K_kappa, K_theta, e)
    inverse = a_w * (e * s * np.cos(sweep) ** 2 / K_theta - s**2 * np.tan(sweep) / (2.0 * K_kappa))
    found = divergence(model, AIR)
    if inverse <= 0.0:
        assert found.q is None
        assert found.V is None
        assert any("does not diverge" in note for note in static(model, at_pressures([10.0, 20.0])).warnings)
    else:
        assert found.q == pytest.approx(1.0 / inverse, rel=1e-10)


def test_rigid_root_makes_sweep_of_either_sign_raise_divergence():
    q = {d: divergence(rigid_swept_wing(np.radians(d), 1e13, 300.0)[0], AIR).q for d in (-40.0, 0.0, 40.0)}
    # a_w = a cos L of the normal component, and 1/cos^2 L
    assert q[-40.0] == pytest.approx(q[0.0] / np.cos(np.radians(40.0)) ** 3, rel=1e-8)
    assert q[40.0] == pytest.approx(q[-40.0], rel=1e-8)


def test_mach_number_of_the_answer_is_that_of_its_speed():
    # Q grows with Mach by Prandtl-Glauert: q_D sqrt(...) must hold at its own Mach number
    mach = np.linspace(0.0, 0.9, 91)
    Q = 0.01 / np.sqrt(1.0 - mach**2)
    air = SampledAero(
        k=[0.0], mach=mach, Q=Q[:, None, None, None], b=1.0, inputs=(AeroInput(name="pitch", kind="mode"),)
    )
    one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[400.0]], names=("pitch",))
    found = divergence(AeroelasticModel(modes=one, aero=air), AIR)
    M = found.V / 340.294
    assert found.q == pytest.approx(400.0 / np.interp(M, mach, Q), rel=1e-9)
    assert 0.5 < M < 0.9


def test_control_without_effect_has_no_reversal_and_unknown_control_is_refused():
    one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[4.0]], names=("pitch",))
    inputs = (AeroInput(name="pitch", kind="mode"), AeroInput(name="elevon", kind="control"))
    air = SampledAero(k=[0.0], Q=[[[[0.5, -0.5]]]], b=1.0, inputs=inputs)
    model = AeroelasticModel(modes=one, aero=air, loads=StaticLoads(names=("lift",), Q=[[1.0, 0.0]]))
    assert reversal(model, AIR)[1].q is None
    with pytest.raises(ValueError, match="no control 'rudder'"):
        reversal(model, AIR, control="rudder")


def test_vacuum_has_no_divergence():
    assert divergence(BINARY, FlightCondition(V=1.0, rho=0.0)).V is None
