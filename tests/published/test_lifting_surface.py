"""The lattice against published wings, stored results of other programs, and closed forms of lifting-surface theory."""

import json
from importlib.resources import files

import numpy as np
import pytest

from aeroservo.aero.coefficients import Reference
from aeroservo.aero.trefftz import induced_drag, span_efficiency
from aeroservo.aero.vlm import Hinge, VortexLattice, lattice, lattice_surface
from aeroservo.aero.vlm_loads import hinge_moments, lattice_derivatives
from aeroservo.aero.vlm_normalwash import control_normalwash, join_normalwash, rigid_normalwash
from aeroservo.aero.vlm_solve import solve_lattice

CASES = files("aeroservo") / "cases"
SURFACES = json.loads((CASES / "lifting_surface" / "reference.json").read_text(encoding="utf-8"))
THESIS = json.loads((CASES / "thesis_wing" / "reference.json").read_text(encoding="utf-8"))

PUBLISHED = 0.01  # relative: Warren-12, the case's own tolerance
SAME_GRID = 0.01  # relative: rectangles on the same kind of grid, the case's own tolerance
ELLIPTIC = 0.005  # the project's requirement on the elliptic wing's efficiency
AVL_GAP = 0.03  # relative: AVL's figures are those of its 16 x 32 grid with the hinge inside a panel

ELEVON = Hinge(span_from=0.5, span_to=1.0, chord_from=0.75, chord_to=0.75)


def derivatives(edge, chord, reference, options, hinges=()):
    """Rigid derivatives, and those of each control d0, d1 ..., with the induced drag."""
    grid = lattice([lattice_surface("wing", edge, chord, hinges=hinges, options=options)])
    parts = [rigid_normalwash(grid, reference.point)]
    parts += [control_normalwash(grid, f"d{i}", "wing", h) for i, h in enumerate(hinges)]
    solution = solve_lattice(grid, join_normalwash(parts), mach=options.mach)
    return solution, lattice_derivatives(solution, reference)


def thesis_wing(chordwise, spanwise, **options):
    g = THESIS["geometry"]
    tip = 0.25 * (g["root_chord_m"] - g["tip_chord_m"]) + np.tan(np.radians(g["quarter_chord_sweep_deg"]))
    reference = Reference(S=1.0, c=g["mac_m"], b=2.0, point=(0.35894, 0.0, 0.0))
    return derivatives(
        [[0, 0, 0], [tip, 1, 0]],
        [0.7, 0.3],
        reference,
        VortexLattice(chordwise=chordwise, spanwise=spanwise, **options),
        hinges=[ELEVON],
    )


def test_warren_12():
    edge = [[0, 0, 0], [1.414 * np.tan(np.radians(53.54)), 1.414, 0]]
    reference = Reference(S=2.828, c=1.0, b=2.828)
    published = SURFACES["warren_12"]["published"]
    for options in (
        VortexLattice(chordwise=12, spanwise=60, spacing="uniform"),
        VortexLattice(chordwise=8, spanwise=24),
    ):
        _, d = derivatives(edge, [1.5, 0.5], reference, options)
        assert d.of("CL", "alpha") == pytest.approx(published["CL_alpha"], rel=PUBLISHED)
        assert d.of("CM", "alpha") == pytest.approx(published["CM_alpha"], rel=PUBLISHED)


@pytest.mark.parametrize("grid", ["1x4", "4x10", "6x20", "10x40"])
def test_warren_12_on_the_stored_grids(grid):
    chordwise, spanwise = (int(n) for n in grid.split("x"))
    edge = [[0, 0, 0], [1.414 * np.tan(np.radians(53.54)), 1.414, 0]]
    options = VortexLattice(chordwise=chordwise, spanwise=spanwise, spacing="uniform")
    _, d = derivatives(edge, [1.5, 0.5], Reference(S=2.828, c=1.0, b=2.828), options)
    stored = SURFACES["warren_12"]["horseshoe_lattice_grids(chordwise x spanwise per half)"][grid]
    # the same method on the same panels: what is left is the sweep's printed digits
    np.testing.assert_allclose([d.of("CL", "alpha"), d.of("CM", "alpha")], stored, rtol=3e-4)


@pytest.mark.parametrize("ratio", [2, 4, 6, 8, 10, 20, 100, 1000])
def test_rectangles(ratio):
    stored = SURFACES["rectangular_8x40"][f"AR{ratio}"]
    reference = Reference(S=ratio, c=1.0, b=ratio, point=(0.25, 0.0, 0.0))
    options = VortexLattice(chordwise=8, spanwise=40, spacing="uniform")
    _, d = derivatives([[0, 0, 0], [0, ratio / 2, 0]], [1, 1], reference, options)
    values = [d.of("CL", "alpha"), d.of("CL", "q"), d.of("CM", "q"), d.neutral_point]
    np.testing.assert_allclose(values, [stored[k] for k in ("CLa", "CLq", "CMq", "xcp_c")], rtol=SAME_GRID)


@pytest.mark.parametrize(
    ("chordwise", "spanwise", "spacing"), [(24, 32, "cosine"), (16, 32, "uniform"), (32, 64, "cosine")]
)
def test_thesis_wing(chordwise, spanwise, spacing):
    accept = THESIS["acceptance"]
    _, d = thesis_wing(chordwise, spanwise, spacing=spacing)
    for key, value in {
        "CL_alpha": d.of("CL", "alpha"),
        "CL_q": d.of("CL", "q"),
        "CM_q": d.of("CM", "q"),
        "CL_delta_streamwise": d.of("CL", "d0"),
        "CM_delta_streamwise": d.of("CM", "d0"),
    }.items():
        target, tolerance = accept[key]
        assert value == pytest.approx(target, rel=tolerance), key
    assert d.neutral_point == pytest.approx(accept["x_neutral_point_m"][0], abs=0.003)


def test_thesis_wing_against_avl():
    stored = THESIS["derivatives_per_rad_about_quarter_mac_x_0.3589_m"]
    avl = dict(zip(stored["columns"], stored["AVL_16x32"]))
    _, d = thesis_wing(16, 32)
    streamwise = np.cos(np.radians(12.7))  # AVL turns the elevon about its swept hinge
    assert d.of("CL", "alpha") == pytest.approx(avl["CL_alpha"], rel=AVL_GAP)
    assert d.of("CL", "q") == pytest.approx(avl["CL_q"], rel=AVL_GAP)
    assert d.of("CM", "q") == pytest.approx(avl["CM_q"], rel=AVL_GAP)
    assert d.of("CL", "d0") == pytest.approx(avl["CL_delta"] / streamwise, rel=AVL_GAP)
    assert d.of("CM", "d0") == pytest.approx(avl["CM_delta"] / streamwise, rel=AVL_GAP)
    assert d.neutral_point == pytest.approx(avl["x_neutral_point_m"], abs=0.003)


def test_elliptic_wing_has_efficiency_one():
    eta = np.append(np.sin(np.linspace(0, np.pi / 2, 81))[:-1], 0.99999)
    chord, span = np.sqrt(1 - eta**2), 8.0
    edge = np.stack([0.25 - 0.25 * chord, eta * span / 2, 0 * eta], axis=-1)
    reference = Reference(S=np.pi * span / 4, c=1.0, b=span, point=(0.25, 0.0, 0.0))
    solution, d = derivatives(edge, chord, reference, VortexLattice(chordwise=4, spanwise=80, spacing="tip"))
    drag = induced_drag(solution).matrix[0, 0]
    assert span_efficiency(d.of("CL", "alpha") * reference.S, drag, span) == pytest.approx(1.0, abs=ELLIPTIC)


def thin_hinge(x_h):
    """Lift, moment about the quarter chord and hinge moment of a bent plate per radian (Glauert, R&M 1095)."""
    t = np.arccos(1 - 2 * x_h)
    lift = 2 * (np.pi - t + np.sin(t))
    moment = -0.5 * np.sin(t) * (1 - np.cos(t))
    return lift, moment


def thin_smooth(x_h, reading):
    """The same for the parabolic camber behind x_h, by numerical integrals of thin-airfoil theory."""
    t = np.linspace(0, np.pi, 200_001)
    t = (t[1:] + t[:-1]) / 2
    x = (1 - np.cos(t)) / 2
    factor = {"same_drop": 2.0, "same_slope": 1.0}[reading]
    slope = -factor * np.maximum(x - x_h, 0) / (1 - x_h)
    a1, a2 = 2 * np.mean(slope * np.cos(t)), 2 * np.mean(slope * np.cos(2 * t))
    return 2 * np.pi * (-np.mean(slope) + a1 / 2), np.pi / 4 * (a2 - a1)


def test_thin_airfoil_limits_for_growing_aspect_ratio():
    target = thin_hinge(0.75)
    stored = THESIS["section_control_derivatives_Re1e6_per_rad"]["hinge_0.75"]["thin_airfoil"]
    np.testing.assert_allclose(target, stored, rtol=2e-3)
    errors = []
    for ratio in (20.0, 200.0, 2e6):
        reference = Reference(S=ratio, c=1.0, b=ratio, point=(0.25, 0.0, 0.0))
        hinge = Hinge(span_from=0.0, span_to=1.0, chord_from=0.75, chord_to=0.75)
        _, d = derivatives(
            [[0, 0, 0], [0, ratio / 2, 0]], [1, 1], reference, VortexLattice(chordwise=32, spanwise=16), [hinge]
        )
        got = np.array([d.of("CL", "alpha"), d.of("CL", "d0"), d.of("CM", "d0"), d.of("CM", "q")])
        errors.append(np.abs(got / [2 * np.pi, *target, -np.pi / 4] - 1))
    assert np.all(np.array(errors[1]) < np.array(errors[0]))
    # 32 panels: the hinged lift is within 2e-4, moment and pitch damping fall with the square of the panels
    assert np.all(errors[-1] < [1e-4, 4e-4, 2e-3, 2e-3])


@pytest.mark.parametrize("reading", ["same_drop", "same_slope"])
def test_thin_airfoil_limit_of_the_morphed_control(reading):
    lift, moment = thin_smooth(0.75, reading)
    if reading == "same_drop":
        stored = THESIS["section_control_derivatives_Re1e6_per_rad"]["smooth_same_trailing_edge_drop"]["thin_airfoil"]
        np.testing.assert_allclose([lift, moment], stored, rtol=2e-3)
    ratio = 2e6
    hinge = Hinge(span_from=0.0, span_to=1.0, chord_from=0.75, chord_to=0.75)
    edge = [[0, 0, 0], [0, ratio / 2, 0]]
    grid = lattice(
        [lattice_surface("w", edge, [1, 1], hinges=[hinge], options=VortexLattice(chordwise=32, spanwise=8))]
    )
    solution = solve_lattice(grid, control_normalwash(grid, "d", "w", hinge, kind="morphed", reading=reading))
    d = lattice_derivatives(solution, Reference(S=ratio, c=1.0, b=ratio, point=(0.25, 0, 0)))
    assert d.of("CL", "d") == pytest.approx(lift, rel=1e-3)
    assert d.of("CM", "d") == pytest.approx(moment, rel=3e-3)


def test_hinge_moment_limit():
    # two-dimensional pressures of thin-airfoil theory, integrated behind the hinge
    x_h, t_h = 0.75, np.arccos(1 - 2 * 0.75)
    t = np.linspace(t_h, np.pi, 100_001)
    t = (t[1:] + t[:-1]) / 2
    dt, x = (np.pi - t_h) / 100_000, (1 - np.cos(t)) / 2
    by_alpha = -np.sum(4 * (1 + np.cos(t)) / np.sin(t) * (x - x_h) * np.sin(t) / 2) * dt / (1 - x_h) ** 2
    series = 0.5 * np.log(np.abs(np.sin((t + t_h) / 2) / np.sin((t - t_h) / 2)))  # of sin(n t_h) sin(n t)/n
    jump = 4 / np.pi * (np.pi - t_h) * (1 + np.cos(t)) / np.sin(t) + 8 / np.pi * series
    by_delta = -np.sum(jump * (x - x_h) * np.sin(t) / 2) * dt / (1 - x_h) ** 2
    hinge = Hinge(span_from=0.0, span_to=1.0, chord_from=x_h, chord_to=x_h)
    edge = [[0, 0, 0], [0, 1e6, 0]]
    errors = []
    for panels in (16, 32, 64):
        options = VortexLattice(chordwise=panels, spanwise=4)
        grid = lattice([lattice_surface("w", edge, [1, 1], hinges=[hinge], options=options)])
        parts = [rigid_normalwash(grid, [0, 0, 0]), control_normalwash(grid, "d", "w", hinge)]
        c, *_ = hinge_moments(solve_lattice(grid, join_normalwash(parts)), "w", hinge)
        errors.append([abs(c[0] / by_alpha - 1), abs(c[5] / by_delta - 1)])
    assert np.all(np.diff(errors, axis=0) < 0)
    assert errors[-1][0] < 2e-3 and errors[-1][1] < 2e-2  # the load is logarithmic at the hinge: first order


def test_order_of_convergence():
    """Second order along the chord (the hinge too) and at least first over the span, to one limit from two spacings."""
    chordwise = [thesis_wing(n, 24)[1] for n in (8, 16, 32, 64)]
    for what in (("CL", "d0"), ("CM", "d0")):
        values = np.array([d.of(*what) for d in chordwise])
        steps = np.abs(np.diff(values))
        assert steps[-1] < steps[0] / 3, what
    limits = []
    for spacing in ("uniform", "cosine"):
        values = np.array([thesis_wing(8, n, spacing=spacing)[1].of("CL", "alpha") for n in (16, 32, 64)])
        steps = np.diff(values)
        order = np.log2(steps[0] / steps[1])
        assert order > 0.9
        limits.append(values[-1] + steps[-1] / (2**order - 1))
    assert limits[0] == pytest.approx(limits[1], rel=2e-3)
