"""What must hold for every wing, on 240 random planforms: signs, symmetry, linearity, panel order, moment transfer."""

from dataclasses import fields, replace

import numpy as np
import pytest

from aeroservo.aero.coefficients import Reference
from aeroservo.aero.trefftz import induced_drag
from aeroservo.aero.vlm import Hinge, Lattice, VortexLattice, lattice, lattice_surface
from aeroservo.aero.vlm_loads import lattice_derivatives, lattice_loads, span_loading
from aeroservo.aero.vlm_normalwash import (
    Normalwash,
    control_normalwash,
    join_normalwash,
    rigid_normalwash,
    slope_normalwash,
)
from aeroservo.aero.vlm_solve import solve_lattice

TWO_ROUTES = 1e-9  # relative to the largest value of its kind: two solves of differently arranged equations

PLANFORMS = 240


def random_wing(seed):
    """Sections, a control, and options: sweep -35 to 55 degrees, dihedral, kinks, taper to 0.15."""
    rng = np.random.default_rng(seed)
    n = rng.integers(2, 5)
    y = np.concatenate([[0.0], np.cumsum(rng.uniform(0.3, 2.0, n - 1))])
    sweep, dihedral = np.radians(rng.uniform(-35, 55)), np.radians(rng.uniform(-15, 20))
    x = np.concatenate([[0.0], np.cumsum(np.diff(y) * np.tan(sweep + rng.uniform(-0.15, 0.15, n - 1)))])
    z = y * np.tan(dihedral)
    chord = rng.uniform(0.5, 1.5) * np.cumprod(np.concatenate([[1.0], rng.uniform(0.55, 1.0, n - 1)]))
    start = rng.uniform(0.0, 0.7)
    hinge = Hinge(
        span_from=start,
        span_to=rng.uniform(start + 0.2, 1.0),
        chord_from=rng.uniform(0.55, 0.85),
        chord_to=rng.uniform(0.55, 0.85),
    )
    options = VortexLattice(
        chordwise=int(rng.integers(3, 7)),
        spanwise=int(rng.integers(8, 13)),
        spacing=str(rng.choice(["uniform", "cosine", "tip"])),
        chordwise_spacing=str(rng.choice(["uniform", "cosine"])),
        mach=float(rng.choice([0.0, 0.3, 0.6])),
    )
    return np.stack([x, y, z], axis=-1), chord, hinge, options, str(rng.choice(["hinged", "morphed"]))


def columns(grid, hinge, kind, point):
    x, y = grid.control[:, 0], np.abs(grid.control[:, 1])
    return join_normalwash(
        [
            rigid_normalwash(grid, point),
            control_normalwash(grid, "elevator", "wing", hinge, kind=kind),
            control_normalwash(grid, "aileron", "wing", hinge, kind=kind, parity=-1),
            slope_normalwash(grid, "twist", -0.1 + 0.03 * y),
            slope_normalwash(grid, "mode", np.sin(x) * y),
        ]
    )


@pytest.fixture(scope="module", params=range(0, PLANFORMS, 40))
def wings(request):
    """Forty solved planforms, as a half and in full."""
    found = []
    for seed in range(request.param, request.param + 40):
        edge, chord, hinge, options, kind = random_wing(seed)
        surface = lattice_surface("wing", edge, chord, hinges=[hinge], options=options)
        b = 2 * edge[-1, 1]
        ref = Reference(S=b * chord.mean(), c=chord.mean(), b=b, point=(0.4 * edge[-1, 0], 0.0, 0.1))
        solved = []
        for full in (False, True):
            grid = lattice([surface], full=full)
            solved.append(solve_lattice(grid, columns(grid, hinge, kind, ref.point), mach=options.mach))
        found.append((seed, ref, options, *solved))
    return found


def test_signs_of_controls(wings):
    for seed, ref, _, half, _ in wings:
        d, loading = lattice_derivatives(half, ref), span_loading(half)
        elevator = d.names.index("elevator")
        assert d.of("CL", "elevator") > 0, seed
        # about its own quarter chord every section behind a control pitches down
        local = np.sum(loading.cm_quarter[:, elevator] * loading.chord**2 * loading.width)
        assert local < 0, seed
        assert d.of("Cl", "elevator") == 0 and d.of("CY", "elevator") == 0, seed
        # starboard trailing edge down: port wing goes down, and there is no lift and no pitch
        assert d.of("Cl", "aileron") < 0, seed
        assert d.of("CL", "aileron") == 0 and d.of("CM", "aileron") == 0, seed


def test_signs_of_motion(wings):
    for seed, ref, _, half, _ in wings:
        d = lattice_derivatives(half, ref)
        assert d.of("CL", "alpha") > 0, seed
        assert d.of("Cl", "p") < 0, seed  # roll is damped
        drag = induced_drag(half)
        assert drag.matrix[0, 0] > 0, seed
        even = half.normalwash.parity > 0
        for group in (even, ~even):
            values = np.linalg.eigvalsh(drag.matrix[np.ix_(group, group)])
            assert values.min() > -1e-9 * values.max(), seed


def test_a_full_wing_is_its_mirrored_half(wings):
    for seed, ref, _, half, full in wings:
        a, b = lattice_derivatives(half, ref), lattice_derivatives(full, ref)
        for name in ("CL", "CY", "Cl", "CM", "Cn"):
            x, y = getattr(a, name), getattr(b, name)
            np.testing.assert_allclose(x, y, atol=TWO_ROUTES * np.abs(b.CL).max(), err_msg=f"{name}, seed {seed}")
        x, y = induced_drag(half).matrix, induced_drag(full).matrix
        np.testing.assert_allclose(x, y, atol=TWO_ROUTES * np.abs(y).max(), err_msg=str(seed))


def test_linear_in_every_input(wings):
    for seed, _, options, half, _ in wings:
        rng = np.random.default_rng(seed + 10_000)
        for sign in (1, -1):
            chosen = half.normalwash.parity == sign
            weights = rng.normal(size=chosen.sum())
            mixed = Normalwash(
                names=("mix",), values=half.normalwash.values[:, chosen] @ weights[:, None], parity=np.array([sign])
            )
            got = solve_lattice(half.lattice, mixed, mach=options.mach).gamma[:, 0]
            expected = half.gamma[:, chosen] @ weights
            np.testing.assert_allclose(got, expected, atol=TWO_ROUTES * np.abs(expected).max(), err_msg=str(seed))


def permuted(grid, order):
    """The same panels in another order."""
    of_panels = ("a", "b", "control", "normal", "chord", "fraction", "strip")
    return replace(grid, **{f.name: getattr(grid, f.name)[order] for f in fields(Lattice) if f.name in of_panels})


def test_order_of_panels_does_not_matter(wings):
    for seed, ref, options, half, _ in wings:
        order = np.random.default_rng(seed).permutation(len(half.lattice))
        wash = replace(half.normalwash, values=half.normalwash.values[order])
        other = solve_lattice(permuted(half.lattice, order), wash, mach=options.mach)
        np.testing.assert_allclose(other.gamma, half.gamma[order], atol=TWO_ROUTES * np.abs(half.gamma).max())
        x, y = lattice_derivatives(other, ref), lattice_derivatives(half, ref)
        np.testing.assert_allclose(x.CM, y.CM, atol=TWO_ROUTES * np.abs(y.CM).max(), err_msg=str(seed))


def test_moments_transfer(wings):
    for seed, ref, _, _, full in wings:
        here = lattice_loads(full, ref.point)
        there = np.random.default_rng(seed).normal(size=3)
        expected = here.moment + np.cross(np.asarray(ref.point) - there, here.force)
        np.testing.assert_allclose(lattice_loads(full, there).moment, expected, atol=1e-10 * np.abs(here.moment).max())


def test_turning_about_another_point(wings):
    """q about x' is q about x with an angle of attack (x - x') q/V."""
    for seed, ref, options, half, _ in wings[:10]:
        moved = np.add(ref.point, [0.37, 0.0, 0.0])
        other = solve_lattice(half.lattice, rigid_normalwash(half.lattice, moved), mach=options.mach)
        q = half.names.index("q")
        expected = half.gamma[:, q] - 0.37 * half.gamma[:, half.names.index("alpha")]
        got = other.gamma[:, other.names.index("q")]
        np.testing.assert_allclose(got, expected, atol=TWO_ROUTES * np.abs(expected).max(), err_msg=str(seed))


def test_several_surfaces_with_a_fin():
    """Wing, tail and central fin: order of surfaces does not matter; the fin answers sideslip and not lift."""
    options = VortexLattice(chordwise=4, spanwise=10)
    wing = lattice_surface("wing", [[0, 0, 0], [0.5, 3, 0.2]], [1.0, 0.6], options=options)
    tail = lattice_surface("tail", [[4, 0, 0.4], [4.2, 1, 0.4]], [0.5, 0.4], options=options)
    fin = lattice_surface("fin", [[4, 0, 0.4], [4.5, 0, 1.4]], [0.6, 0.4], options=options, mirrored=False)
    ref = Reference(S=4.8, c=0.8, b=6.0, point=(0.3, 0.0, 0.0))
    results = []
    for surfaces in ([wing, tail, fin], [fin, wing, tail]):
        grid = lattice(surfaces)
        assert not grid.mirrored
        results.append(lattice_derivatives(solve_lattice(grid, rigid_normalwash(grid, ref.point)), ref))
    first, second = results
    for name in ("CL", "CY", "Cl", "CM", "Cn"):
        np.testing.assert_allclose(getattr(first, name), getattr(second, name), atol=1e-10)
    assert first.of("CY", "beta") < 0 and first.of("Cn", "beta") > 0 and first.of("Cn", "r") < 0
    assert first.of("Cl", "beta") < 0  # fin above the point, and dihedral
    assert abs(first.of("CY", "alpha")) < 1e-12
    alone = lattice([wing])
    single = lattice_derivatives(solve_lattice(alone, rigid_normalwash(alone, ref.point)), ref)
    assert first.neutral_point > single.neutral_point  # a tail moves it aft
    assert first.of("CM", "q") < single.of("CM", "q") < 0
