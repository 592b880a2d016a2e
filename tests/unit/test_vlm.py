"""Pieces of the lattice: kernels against quadrature, placing of panels, drag by two routes, and every refusal."""

import numpy as np
import pytest
from scipy.integrate import quad

from aeroservo.aero.coefficients import Reference
from aeroservo.aero.trefftz import induced_drag, span_efficiency, trefftz_influence
from aeroservo.aero.vlm import Hinge, LatticeSurface, VortexLattice, lattice, lattice_surface
from aeroservo.aero.vlm_kernels import normal_influence, velocity_influence
from aeroservo.aero.vlm_loads import hinge_moments, lattice_derivatives, lattice_loads, panel_forces, span_loading
from aeroservo.aero.vlm_normalwash import (
    Normalwash,
    control_normalwash,
    join_normalwash,
    motion_normalwash,
    rigid_normalwash,
    slope_normalwash,
)
from aeroservo.aero.vlm_solve import normal_velocity, solve_lattice
from aeroservo.aero.vlm_spacing import chord_edges, span_edges

QUADRATURE = 1e-9  # Biot-Savart by adaptive integration
CLOSE = 1e-6  # the same beside the vortex, where the integrand peaks

RECTANGLE = [[0, 0, 0], [0, 2, 0]]
WING = [[0, 0, 0], [0.6, 2, 0.2]]


def biot_savart(point, a, b):
    """Velocity of a unit horseshoe by integrating dl x r/|r|^3, legs to infinity by substitution."""
    point, a, b = (np.asarray(v, dtype=float) for v in (point, a, b))

    def element(at, direction):
        r = point - at
        return np.cross(direction, r) / np.linalg.norm(r) ** 3 / (4 * np.pi)

    def integral(f, low, high):
        return np.array([quad(lambda t, k=k: f(t)[k], low, high, limit=400, epsabs=1e-13)[0] for k in range(3)])

    e = np.array([1.0, 0.0, 0.0])
    bound = integral(lambda t: element(a + t * (b - a), b - a), 0, 1)
    leg_b = integral(lambda t: element(b + t / (1 - t) * e, e) / (1 - t) ** 2, 0, 1)
    leg_a = integral(lambda t: element(a + t / (1 - t) * e, -e) / (1 - t) ** 2, 0, 1)
    return bound + leg_a + leg_b


def one(function, point, a, b, *normal):
    arrays = [np.array([v], dtype=float) for v in (*point, *normal, *a, *b)]
    out = np.zeros((1, 1) if normal else (1, 1, 3))
    function(*arrays, 0.0, out)
    return out[0, 0]


@pytest.mark.parametrize(
    ("point", "tolerance"),
    [
        ((1.0, 0.3, 0.2), QUADRATURE),
        ((-2.0, 0.3, -0.4), QUADRATURE),
        ((8.0, 1.4, 0.01), QUADRATURE),
        ((0.31, 0.4, 0.0), CLOSE),
        ((0.0, -3.0, 0.0), QUADRATURE),
    ],
)
def test_horseshoe_against_biot_savart(point, tolerance):
    a, b = (0.1, -0.5, 0.0), (0.4, 0.9, 0.1)
    expected = biot_savart(point, a, b)
    np.testing.assert_allclose(one(velocity_influence, point, a, b), expected, rtol=tolerance, atol=1e-11)
    n = np.array([-0.6, 0.8])
    assert one(normal_influence, point, a, b, *n) == pytest.approx(expected[1:] @ n, rel=tolerance, abs=1e-11)


def test_long_vortex_keeps_its_digits_close_by():
    """A segment 2e6 long, 0.25 away: 1/(2 pi d), where the textbook denominator cancels to nothing."""
    w = one(normal_influence, (0.25, 0.0, 0.0), (0.0, -1e6, 0.0), (0.0, 1e6, 0.0), 0.0, 1.0)
    assert w == pytest.approx(-1 / (2 * np.pi * 0.25), rel=1e-5)


def test_a_vortex_does_not_act_on_itself():
    a, b = (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    arrays = [np.array([v]) for v in (0.0, 0.5, 0.0, *a, *b)]
    out = np.zeros((1, 1, 3))
    velocity_influence(*arrays, 1e-12, out)
    assert np.all(np.isfinite(out)) and abs(out[0, 0, 0]) == 0


def test_far_wake_is_the_limit_of_the_horseshoe():
    grid = lattice([lattice_surface("w", WING, [1, 0.6], options=VortexLattice(chordwise=1, spanwise=5))])
    far = grid.strip_edge + np.array([1e5, 0, 0])
    out = np.zeros((5, 5))
    split = [np.ascontiguousarray(v) for v in (*far.T, *grid.normal.T[1:], *grid.a.T, *grid.b.T)]
    normal_influence(*split, 0.0, out)
    np.testing.assert_allclose(trefftz_influence(grid), out, rtol=1e-6, atol=1e-9)


def test_prandtl_glauert_is_a_stretched_wing():
    """At Mach M the lift slope is that of the wing stretched by 1/beta along x, over beta (Goethert)."""
    options, beta = VortexLattice(chordwise=4, spanwise=12), np.sqrt(1 - 0.6**2)
    edge, chord = np.array([[0, 0, 0], [0.9, 2.0, 0.0]]), np.array([1.0, 0.5])
    slopes = []
    for factor, mach in ((1.0, 0.6), (1 / beta, 0.0)):
        grid = lattice([lattice_surface("w", edge * [factor, 1, 1], chord * factor, options=options)])
        solution = solve_lattice(grid, rigid_normalwash(grid, [0, 0, 0]), mach=mach)
        slopes.append(lattice_loads(solution, [0, 0, 0]).force[0, 2])
    # the circulation is the stretched wing's, and so is the lift over dynamic pressure
    assert slopes[0] == pytest.approx(slopes[1], rel=1e-12)
    wide = lattice([lattice_surface("w", [[0, 0, 0], [0, 1e5, 0]], [1, 1], options=options)])
    d = lattice_derivatives(
        solve_lattice(wide, rigid_normalwash(wide, [0, 0, 0]), mach=0.6), Reference(S=2e5, c=1.0, b=2e5)
    )
    assert d.of("CL", "alpha") == pytest.approx(2 * np.pi / beta, rel=1e-3)


def test_near_field_and_trefftz_drag_agree():
    """A straight bound vortex feels half the far wake's downwash: Kutta-Joukowsky gives the far wake's drag."""
    options = VortexLattice(chordwise=1, spanwise=15)
    grid = lattice([lattice_surface("w", RECTANGLE, [0.4, 0.4], options=options)], full=True)
    solution = solve_lattice(grid, slope_normalwash(grid, "a", -np.ones(len(grid))))
    at = grid.strip_edge + np.array([0.1, 0, 0])  # on the quarter-chord line, at the control stations
    velocity = np.zeros((len(grid), len(grid), 3))
    split = [np.ascontiguousarray(v) for v in (*at.T, *grid.a.T, *grid.b.T)]
    velocity_influence(*split, grid.core**2, velocity)
    w = velocity[:, :, 2] @ solution.gamma[:, 0]
    near = -2 * np.sum(w * solution.gamma[:, 0] * (grid.b - grid.a)[:, 1])
    assert near == pytest.approx(induced_drag(solution).matrix[0, 0], rel=1e-10)


def test_span_loading_adds_up_to_the_loads():
    options = VortexLattice(chordwise=6, spanwise=20, spacing="uniform")
    grid = lattice([lattice_surface("w", RECTANGLE, [0.8, 0.8], options=options)])
    solution = solve_lattice(grid, rigid_normalwash(grid, [0.2, 0, 0]))
    loading, loads = span_loading(solution), lattice_loads(solution, [0.2, 0, 0])
    alpha = 0
    assert 2 * np.sum(loading.cl[:, alpha] * loading.chord * loading.width) == pytest.approx(loads.force[alpha, 2])
    moment = 2 * np.sum(loading.cm_quarter[:, alpha] * loading.chord**2 * loading.width)
    assert moment == pytest.approx(loads.moment[alpha, 1], rel=1e-10)
    force, _ = panel_forces(solution)
    assert np.all(force[:, :, 0] == 0)


def test_hinge_moment_of_a_swept_hinge():
    """A sheared wing of constant chord: the arm is normal to the hinge, area and chord follow."""
    flap = Hinge(span_from=0.25, span_to=0.75, chord_from=0.8, chord_to=0.8)
    grid = lattice([lattice_surface("w", [[0, 0, 0], [2.0, 2.0, 0]], [1, 1], hinges=[flap])])
    solution = solve_lattice(grid, rigid_normalwash(grid, [0, 0, 0]))
    _, area, chord = hinge_moments(solution, "w", flap)
    assert area == pytest.approx(0.2 * 1.0)
    assert chord == pytest.approx(0.2 * np.cos(np.pi / 4))
    single = lattice(
        [lattice_surface("w", [[0, 0, 0], [2.0, 2.0, 0]], [1, 1], hinges=[flap], options=VortexLattice(spanwise=3))]
    )
    _, _, chord = hinge_moments(solve_lattice(single, rigid_normalwash(single, [0, 0, 0])), "w", flap)
    assert chord == pytest.approx(0.2 * np.cos(np.pi / 4))
    coarse = lattice([lattice_surface("w", RECTANGLE, [1, 1], options=VortexLattice(chordwise=2))])
    solution = solve_lattice(coarse, rigid_normalwash(coarse, [0, 0, 0]))
    with pytest.raises(ValueError, match="behind the hinge"):
        hinge_moments(solution, "w", flap)
    with pytest.raises(ValueError, match="no surface 'tail'"):
        hinge_moments(solution, "tail", flap)


@pytest.mark.parametrize("spacing", ["uniform", "cosine", "tip"])
def test_edges_fall_on_breaks(spacing):
    for breaks in ([0.5], [0.31, 0.33], [0.01, 0.5, 0.99]):
        for n in (len(breaks) + 1, 12, 40):
            edges, control = span_edges(n, breaks, spacing=spacing)
            assert len(edges) == n + 1 and np.all(np.diff(edges) > 0)
            assert all(np.min(np.abs(edges - b)) < 1e-12 for b in breaks)
            assert np.all((control > edges[:-1]) & (control < edges[1:]))
    with pytest.raises(ValueError, match="cannot resolve"):
        span_edges(2, [0.3, 0.6], spacing=spacing)
    with pytest.raises(ValueError, match=r"breaks must lie in \[0, 1\]"):
        span_edges(4, [1.5], spacing=spacing)


def test_chord_edges():
    assert 0.73 in chord_edges(9, 0.73)
    np.testing.assert_allclose(chord_edges(4), [0, 0.25, 0.5, 0.75, 1])
    assert np.diff(chord_edges(9, spacing="cosine"))[0] < 0.05


def test_mean_over_the_panel_makes_the_hinge_converge():
    """What the mean is for: the error against thin-airfoil theory falls fourfold, and by half without it."""
    x_h, t_h = 0.7, np.arccos(1 - 2 * 0.7)
    exact = 2 * (np.pi - t_h + np.sin(t_h))
    hinge = Hinge(span_from=0.0, span_to=1.0, chord_from=x_h, chord_to=x_h)
    errors = []
    for n in (10, 20, 40):
        options = VortexLattice(chordwise=n, spanwise=1)
        grid = lattice([lattice_surface("w", [[0, 0, 0], [0, 1e5, 0]], [1, 1], hinges=[hinge], options=options)])
        mean = control_normalwash(grid, "mean", "w", hinge)
        point = slope_normalwash(grid, "point", np.where(grid.fraction[:, 0] >= x_h - 1e-9, -1.0, 0.0))
        force = lattice_loads(solve_lattice(grid, join_normalwash([mean, point])), [0, 0, 0]).force[:, 2] / 2e5
        errors.append(np.abs(force / exact - 1))
    errors = np.array(errors)
    assert np.all(errors[:-1, 0] / errors[1:, 0] > 3.0)
    assert np.all(errors[:-1, 1] / errors[1:, 1] < 2.3)
    assert errors[0, 0] < 3e-3 < 0.03 < errors[0, 1]


def test_normalwash_signs_on_a_full_lattice():
    flap = Hinge(span_from=0.5, span_to=1.0, chord_from=0.75, chord_to=0.75)
    grid = lattice([lattice_surface("w", RECTANGLE, [1, 1], hinges=[flap])], full=True)
    aileron = control_normalwash(grid, "a", "w", flap, parity=-1, gain=0.5).values[:, 0]
    starboard = grid.control[:, 1] > 0
    assert aileron[starboard].max() == 0.5 and aileron[starboard].min() == 0
    assert aileron[~starboard].min() == -0.5 and aileron[~starboard].max() == 0
    heave = motion_normalwash(grid, ["up"], np.ones((len(grid), 1)), np.zeros((len(grid), 1)), 1.0, np.array([1]))
    lift = lattice_loads(solve_lattice(grid, heave), [0, 0, 0]).force[0, 2]
    assert lift < 0  # moving up lowers the angle of attack
    with pytest.raises(ValueError, match="no surface 'x'"):
        control_normalwash(grid, "a", "x", flap)


def test_refusals():
    with pytest.raises(ValueError, match="subsonic"):
        VortexLattice(mach=1.0)
    with pytest.raises(ValueError, match="chordwise must be an integer"):
        VortexLattice(chordwise=0)
    with pytest.raises(ValueError, match="spacing must be one of"):
        VortexLattice(spacing="even")
    with pytest.raises(ValueError, match="chordwise_spacing"):
        VortexLattice(chordwise_spacing="tip")
    with pytest.raises(ValueError, match="at least one surface"):
        lattice([])
    grid = lattice([lattice_surface("w", RECTANGLE, [1, 1])])
    wash = rigid_normalwash(grid, [0, 0, 0])
    with pytest.raises(ValueError, match="subsonic"):
        normal_velocity(grid, mach=-0.1)
    with pytest.raises(ValueError, match="rows"):
        solve_lattice(grid, Normalwash(names=("a",), values=np.ones((3, 1)), parity=np.array([1])))
    with pytest.raises(ValueError, match="parity"):
        Normalwash(names=("a",), values=np.ones((3, 1)), parity=np.array([0]))
    with pytest.raises(ValueError, match="do not fit"):
        Normalwash(names=("a", "b"), values=np.ones((3, 1)), parity=np.array([1]))
    with pytest.raises(ValueError, match="not finite"):
        Normalwash(names=("a",), values=np.full((3, 1), np.nan), parity=np.array([1]))
    with pytest.raises(ValueError, match="must differ"):
        join_normalwash([wash, wash])
    solution = solve_lattice(grid, wash)
    with pytest.raises(ValueError, match="full=True"):
        lattice_loads(solution, [0, 1, 0])
    derivatives = lattice_derivatives(solution, Reference(S=4.0, c=1.0, b=4.0))
    with pytest.raises(ValueError, match="no input 'delta'"):
        derivatives.of("CL", "delta")
    with pytest.raises(ValueError, match="no coefficient 'CZ'"):
        derivatives.of("CZ", "alpha")
    with pytest.raises(ValueError, match="drag area must be > 0"):
        span_efficiency(1.0, 0.0, 2.0)
    surface = lattice_surface("w", RECTANGLE, [1, 1])
    fields = {"leading_edge": surface.leading_edge, "span": surface.span, "control_span": surface.control_span}
    with pytest.raises(ValueError, match="must be > 0"):
        LatticeSurface(name="w", chord=-surface.chord, fractions=surface.fractions, **fields)
    with pytest.raises(ValueError, match="ascend"):
        LatticeSurface(name="w", chord=surface.chord, fractions=surface.fractions[:, ::-1], **fields)
    with pytest.raises(ValueError, match="do not fit"):
        LatticeSurface(name="w", chord=surface.chord, fractions=surface.fractions[1:], **fields)


def test_static_margin():
    grid = lattice([lattice_surface("w", WING, [1, 0.6])])
    d = lattice_derivatives(
        solve_lattice(grid, rigid_normalwash(grid, [0.3, 0, 0])), Reference(S=3.2, c=0.8, b=4.0, point=(0.3, 0, 0))
    )
    assert d.static_margin(d.neutral_point) == pytest.approx(0, abs=1e-12)
    assert d.static_margin(0.3) == pytest.approx(-d.of("CM", "alpha") / d.of("CL", "alpha"))
