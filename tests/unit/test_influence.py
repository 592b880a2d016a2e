"""Influence functions of the swept wing: the corrected [4.15-4.20] literally, reciprocity, the beam's own answers."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.integrate import quad, solve_bvp

from aeroservo.structure.beam_axis import SlenderBeam
from aeroservo.structure.beam_static import BeamLoad, flexibility, static_deflection
from aeroservo.structure.influence import influence_deflection, influence_functions

IDENTITY = 1e-12
TWO_ROUTES = 1e-8  # issue 3 wants 1e-6; measured here 2e-9 (flexibility at a 8:1 taper) and 2e-11 (deflections)
QUADRATURE = 1e-9  # of scipy.integrate.quad, at its own error estimate

TAPERED = dict(
    y=[0.0, 2.0, 3.5, 6.0],
    mass=1.0,
    inertia=1.0,
    EI=[9e4, 6e4, 4e4, 5e3],
    GJ=[5e4, 4e4, 2e4, 3e3],
)
KINKED = np.radians([-10.0, 35.0, 15.0, 0.0])
COUPLING = [8e3, 0.0, -4e3, 1e3]
LOAD = BeamLoad(
    y=[0.5, 3.0, 5.5],
    lift=[300.0, 200.0, 50.0],
    torque=[-20.0, 30.0, 10.0],
    point_y=[1.3, 3.5, 6.0],
    point_lift=[40.0, -25.0, 10.0],
    point_torque=[5.0, 8.0, -3.0],
)


def printed(beam: SlenderBeam, sweep: float, y: float, eta: float) -> tuple[float, float, float, float]:
    """[4.15-4.20] as equations.md has them, y and eta across the flow: C^zz, C^thth, C^thz, C^zth."""
    c, s = np.cos(sweep), np.sin(sweep)
    m = min(y, eta) / c
    stations = [float(v) for v in beam.y if 0.0 < v < m]

    def integral(f):
        return quad(f, 0.0, m, points=stations or None, epsabs=0.0, epsrel=1e-11, limit=200)[0]

    def EI(x):
        return float(np.interp(x, beam.y, beam.EI))

    def GJ(x):
        return float(np.interp(x, beam.y, beam.GJ))

    return (
        integral(lambda x: (y / c - x) * (eta / c - x) / EI(x)),
        integral(lambda x: c**2 / GJ(x) + s**2 / EI(x)),
        -s * integral(lambda x: (eta / c - x) / EI(x)),
        -s * integral(lambda x: (y / c - x) / EI(x)),
    )


@pytest.mark.parametrize("sweep_deg", [-40.0, 0.0, 25.0, 45.0])
def test_corrected_formulas_of_the_thesis(sweep_deg):
    sweep = np.radians(sweep_deg)
    beam = SlenderBeam(**TAPERED, sweep=sweep)
    points = np.array([1.1, 3.5, 4.2, 6.0])
    found = influence_functions(beam, points, points)
    for i, y in enumerate(points):
        for j, eta in enumerate(points):
            expected = printed(beam, sweep, y * np.cos(sweep), eta * np.cos(sweep))
            ours = [c[i, j] for c in (found.zz, found.theta_theta, found.theta_z, found.z_theta)]
            np.testing.assert_allclose(ours, expected, rtol=QUADRATURE, atol=1e-18)


def test_the_thesis_equality_breaks_reciprocity_and_ours_keeps_it():
    beam = SlenderBeam(**TAPERED, sweep=np.radians(30.0))
    y, eta = [1.0, 2.5], [4.0, 6.0]
    there, back = influence_functions(beam, y, eta), influence_functions(beam, eta, y)
    np.testing.assert_allclose(there.z_theta, back.theta_z.T, rtol=IDENTITY)
    assert np.all(np.abs(there.z_theta / there.theta_z - 1.0) > 0.3)


@pytest.mark.parametrize("GK", [None, [3e4, 2e4, 1e4, 4e3]])
def test_reciprocity_of_everything(GK):
    beam = SlenderBeam(**TAPERED, sweep=KINKED, coupling=COUPLING)
    rng = np.random.default_rng(4)
    y, eta = rng.uniform(0.0, 6.0, 7), rng.uniform(0.0, 6.0, 5)
    there, back = influence_functions(beam, y, eta, GK=GK), influence_functions(beam, eta, y, GK=GK)
    scale = np.abs(there.C).max()
    np.testing.assert_allclose(there.C, back.C.transpose(2, 3, 0, 1), atol=IDENTITY * scale)


def test_flexibility_of_the_finite_elements():
    for sweep in (0.0, np.radians(-30.0), KINKED):
        beam = SlenderBeam(**TAPERED, sweep=sweep, coupling=COUPLING)
        points = np.array([0.6, 2.0, 3.7, 6.0])
        scale = np.sqrt(np.einsum("ipip->ip", influence_functions(beam, points, points).C))
        difference = influence_functions(beam, points, points).C - flexibility(beam, points)
        assert np.abs(difference / (scale[:, :, None, None] * scale)).max() < TWO_ROUTES


@pytest.mark.parametrize("coupling", [0.0, COUPLING], ids=["uncoupled", "coupled"])
@pytest.mark.parametrize("sweep", [0.0, np.radians(-35.0), np.radians(35.0), KINKED], ids=["0", "-35", "35", "kinked"])
def test_static_deflection_by_both_routes(sweep, coupling):
    beam = SlenderBeam(**TAPERED, sweep=sweep, coupling=coupling)
    points = np.linspace(0.0, 6.0, 13)
    by_elements, by_influence = static_deflection(beam, LOAD, points), influence_deflection(beam, LOAD, points)
    for name in ("h", "slope", "twist", "twist_streamwise", "displacement"):
        a, b = getattr(by_elements, name), getattr(by_influence, name)
        np.testing.assert_allclose(a, b, atol=TWO_ROUTES * np.abs(b).max())


def test_static_deflection_against_a_boundary_value_solution():
    # (EI w'')'' = lift, (GJ theta')' = -torque on the same tapered wing, by collocation; linear load over one panel
    L, EI, GJ = 4.0, (900.0, 200.0), (400.0, 90.0)
    lift, torque = (30.0, 5.0), (-4.0, 6.0)
    beam = SlenderBeam(y=[0.0, L], mass=1.0, inertia=1.0, EI=EI, GJ=GJ, sweep=0.5)
    load = BeamLoad(y=[0.0, L], lift=lift, torque=torque)

    def line(ends, y):
        return ends[0] + (ends[1] - ends[0]) * y / L

    def rates(y, v):  # w, w', EI w'', (EI w'')', theta, GJ theta'
        _, slope, moment, shear, _, twisting = v
        return [slope, moment / line(EI, y), shear, line(lift, y), twisting / line(GJ, y), -line(torque, y)]

    def ends(a, b):
        return [a[0], a[1], b[2], b[3], a[4], b[5]]

    mesh = np.linspace(0.0, L, 101)
    solved = solve_bvp(rates, ends, mesh, np.zeros((6, mesh.size)), tol=1e-10, max_nodes=20000)
    assert solved.success
    points = np.array([1.0, 2.3, 4.0])
    w, slope, _, _, theta, _ = solved.sol(points)
    for found in (influence_deflection(beam, load, points), static_deflection(beam, load, points)):
        np.testing.assert_allclose(found.h, -w, rtol=1e-7)
        np.testing.assert_allclose(found.slope, -slope, rtol=1e-7)
        np.testing.assert_allclose(found.twist, theta, rtol=1e-7)
        np.testing.assert_allclose(found.twist_streamwise, theta * np.cos(0.5) - slope * np.sin(0.5), rtol=1e-7)


def test_lift_washes_an_aft_swept_wing_out_and_a_forward_swept_one_in():
    load = BeamLoad(y=[0.0, 6.0], lift=100.0)
    for sweep_deg, sign in ((30.0, -1.0), (-30.0, 1.0)):
        found = influence_deflection(SlenderBeam(**TAPERED, sweep=np.radians(sweep_deg)), load, [3.0, 6.0])
        assert np.all(sign * found.twist_streamwise > 0.0)
        assert np.all(np.abs(found.twist) < 1e-15)
        assert np.all(found.h < 0.0)


def test_deflection_of_a_point_off_the_axis():
    # [4.14] with x - y tan(sweep) for x: a force at (xi, eta) is seen at (x, y), and by Maxwell the other way round
    sweep = np.radians(25.0)
    beam = SlenderBeam(**TAPERED, sweep=sweep)

    def C(x, y, xi, eta):
        f = influence_functions(beam, [y / np.cos(sweep)], [eta / np.cos(sweep)])
        x, xi = x - y * np.tan(sweep), xi - eta * np.tan(sweep)
        return (f.zz - x * f.theta_z + x * xi * f.theta_theta - xi * f.z_theta)[0, 0]

    a, b = (1.9, 2.0), (2.4, 4.5)
    assert C(*a, *b) == pytest.approx(C(*b, *a), rel=IDENTITY)
    # built up from a force and the moment it makes about y where its streamwise chord meets the axis
    offset = b[0] - b[1] * np.tan(sweep)
    eta = b[1] / np.cos(sweep)
    f = influence_functions(beam, [a[1] / np.cos(sweep)], [eta]).C[0, :, 0, :]
    motion = f @ np.array([1.0, 0.0, -offset])
    assert C(*a, *b) == pytest.approx(motion[0] - (a[0] - a[1] * np.tan(sweep)) * motion[2], rel=IDENTITY)


def test_shear_adds_its_own_deflection_and_nothing_else():
    beam = SlenderBeam(y=[0.0, 3.0], mass=1.0, inertia=1.0, EI=50.0, GJ=20.0, sweep=0.3)
    plain, sheared = influence_functions(beam, [1.0, 2.5], [2.0]), influence_functions(beam, [1.0, 2.5], [2.0], GK=8.0)
    np.testing.assert_allclose(sheared.zz - plain.zz, [[1.0 / 8.0], [2.0 / 8.0]], rtol=IDENTITY)
    np.testing.assert_array_equal(sheared.C[:, 1:], plain.C[:, 1:])
    # linear shear stiffness: integral of 1 / GK
    tapered = influence_functions(beam, [3.0], [3.0], GK=[9.0, 1.0]).zz - influence_functions(beam, [3.0], [3.0]).zz
    assert tapered[0, 0] == pytest.approx(3.0 / 8.0 * np.log(9.0), rel=IDENTITY)


def test_extreme_taper_is_integrated_exactly():
    # EI from 1 to 1e-4 over one panel: integral of (L - s)^2 / EI in closed form
    L, a, b = 2.0, 1.0, 1e-4
    beam = SlenderBeam(y=[0.0, L], mass=1.0, inertia=1.0, EI=[a, b], GJ=[a, b])
    k = (b - a) / L
    # with u = EI: L - s = (b - u)/k
    exact = (b**2 * np.log(b / a) - 2 * b * (b - a) + (b**2 - a**2) / 2) / k**3
    found = influence_functions(beam, [L], [L])
    assert found.zz[0, 0] == pytest.approx(exact, rel=1e-11)
    assert found.theta_theta[0, 0] == pytest.approx(np.log(b / a) / k, rel=1e-11)


def test_root_and_tip_are_in_their_places():
    beam = SlenderBeam(**TAPERED, sweep=KINKED)
    found = influence_functions(beam, [0.0, 6.0], [0.0, 6.0]).C
    assert np.all(found[0] == 0.0) and np.all(found[:, :, 0] == 0.0)
    assert np.linalg.eigvalsh(found[1, :, 1, :]).min() > 0.0


def test_bad_calls_are_refused():
    beam = SlenderBeam(**TAPERED)
    for call, message in [
        (lambda: influence_functions(beam, [7.0], [1.0]), "y must lie on the span"),
        (lambda: influence_functions(beam, [1.0], [-1.0]), "eta must lie on the span"),
        (lambda: influence_functions(dataclasses.replace(beam, root="free"), [1.0], [1.0]), 'root must be "clamped"'),
        (lambda: influence_functions(beam, [1.0], [1.0], GK=0.0), "GK must be positive"),
        (
            lambda: influence_functions(beam, [1.0], [1.0], GK=[1.0, 2.0]),
            "GK must be a number or one value per station",
        ),
        (lambda: influence_deflection(beam, LOAD, [9.0]), "must lie on the span"),
        (lambda: influence_deflection(beam, BeamLoad(point_y=[9.0]), [1.0]), "must lie on the span"),
    ]:
        with pytest.raises(ValueError, match=message):
            call()
