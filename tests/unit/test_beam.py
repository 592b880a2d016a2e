"""Slender beams: against a textbook assembly in nodal displacements, transcendental equations and invariants."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.linalg import eigh
from scipy.optimize import brentq

from aeroservo.datatypes import ModalModel
from aeroservo.structure.beam import BeamMass, SlenderBeam, beam_matrices, beam_modes, modes
from aeroservo.structure.beam_axis import gauss_points
from aeroservo.structure.beam_elements import beam_mesh, stiffness_blocks
from aeroservo.structure.beam_static import BeamLoad, flexibility, static_deflection

IDENTITY = 1e-11  # the same number by the same or an exactly equivalent formula: rounding of a few hundred operations
NODAL = 1e-6  # against nodal displacement elements, whose own rounding grows with (elements)^4 (about 1e-9 here)
SERIES = 1e-9  # against converged solutions of another kind
UNIFORM = dict(y=[0.0, 6.096], mass=35.717, inertia=8.642, EI=9.773e6, GJ=0.9876e6)
TAPERED = dict(
    y=[0.0, 2.0, 3.5, 6.0],
    mass=[12.0, 9.0, 8.0, 3.0],
    inertia=[1.2, 0.8, 0.5, 0.1],
    cg_offset=[0.05, 0.08, -0.03, 0.02],
    EI=[9e4, 6e4, 4e4, 1e4],
    GJ=[5e4, 4e4, 2e4, 8e3],
)
KINKED = np.radians([-10.0, 35.0, 15.0, 0.0])
LUMPS = (BeamMass(y=2.0, mass=4.0, x=-0.2, inertia=0.3), BeamMass(y=6.0, mass=1.5, x=0.1, inertia=0.05))


# --- a second route: nodal displacements, Hermite cubics, quadratic twist, written out on its own ---------------------


def nodal_matrices(beam: SlenderBeam, per_panel: int) -> tuple[np.ndarray, np.ndarray]:
    """M and K in (w, rotation about x, rotation about y) per node plus one mid-element twist, all nodes free.

    Elements are equal in each panel, lumps must sit on stations.
    """
    nodes = np.concatenate([np.linspace(a, b, per_panel + 1)[:-1] for a, b in zip(beam.y[:-1], beam.y[1:])])
    nodes = np.append(nodes, beam.y[-1])
    n_el = nodes.size - 1
    size = 3 * nodes.size + n_el
    M, K = np.zeros((size, size)), np.zeros((size, size))
    xi, weight = np.polynomial.legendre.leggauss(7)
    for e in range(n_el):
        h = nodes[e + 1] - nodes[e]
        y = nodes[e] + 0.5 * h * (1 + xi)
        t = 0.5 * (1 + xi)
        sweep = float(beam.at("sweep", nodes[e]))
        # local w: (w_a, slope_a, w_b, slope_b); local twist: (twist_a, twist_mid, twist_b)
        N = np.stack([1 - 3 * t**2 + 2 * t**3, h * (t - 2 * t**2 + t**3), 3 * t**2 - 2 * t**3, h * (t**3 - t**2)])
        B = np.stack([-6 + 12 * t, h * (-4 + 6 * t), 6 - 12 * t, h * (6 * t - 2)]) / h**2
        Q = np.stack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)])
        dQ = np.stack([4 * t - 3, 4 - 8 * t, 4 * t - 1]) / h
        s, c = np.sin(sweep), np.cos(sweep)
        # slope = Rx cos - Ry sin, twist = Rx sin + Ry cos; local order w_a slope_a w_b slope_b twist_a mid twist_b
        T = np.zeros((7, 7))
        T[0, 0] = T[2, 3] = T[5, 6] = 1.0
        T[1, 1:3] = T[3, 4:6] = [c, -s]
        T[4, 1:3] = T[6, 4:6] = [s, c]
        wv = np.vstack([N, np.zeros((3, xi.size))])
        th = np.vstack([np.zeros((4, xi.size)), Q])
        kap = np.vstack([B, np.zeros((3, xi.size))])
        tau = np.vstack([np.zeros((4, xi.size)), dQ])
        q = 0.5 * h * weight
        m, d, inertia = (beam.at(name, y) * q for name in ("mass", "cg_offset", "inertia"))
        d = beam.at("cg_offset", y)
        EI, GJ, coupling = (beam.at(name, y) * q for name in ("EI", "GJ", "coupling"))
        Me = (wv * m) @ wv.T - (wv * m * d) @ th.T - (th * m * d) @ wv.T + (th * inertia) @ th.T
        Ke = (kap * EI) @ kap.T - (kap * coupling) @ tau.T - (tau * coupling) @ kap.T + (tau * GJ) @ tau.T
        dof = [*range(3 * e, 3 * e + 6), 3 * nodes.size + e]
        M[np.ix_(dof, dof)] += T.T @ Me @ T
        K[np.ix_(dof, dof)] += T.T @ Ke @ T
    for lump in beam.masses:
        i = int(np.argmin(np.abs(nodes - lump.y)))
        assert abs(nodes[i] - lump.y) < 1e-12
        sweep = float(beam.at("sweep", lump.y))
        s, c = np.sin(sweep), np.cos(sweep)
        # velocity of the lump's centre of gravity, x aft of the axis: w - x twist
        at_cg = np.array([1.0, -lump.x * s, -lump.x * c])
        twist = np.array([0.0, s, c])
        dof = [3 * i, 3 * i + 1, 3 * i + 2]
        M[np.ix_(dof, dof)] += lump.mass * np.outer(at_cg, at_cg) + lump.inertia * np.outer(twist, twist)
        M[3 * i + 1, 3 * i + 1] += lump.roll_inertia
    return M, K


def nodal_frequencies(beam: SlenderBeam, per_panel: int, n: int) -> np.ndarray:
    """Lowest n frequencies, rigid-body ones included, under the root condition."""
    M, K = nodal_matrices(beam, per_panel)
    fixed = {"clamped": [0, 1, 2], "symmetric": [1], "antisymmetric": [0, 2]}
    keep = np.setdiff1d(np.arange(len(M)), fixed[beam.root if beam.root == "clamped" else beam.symmetry])
    return np.sqrt(np.abs(eigh(K[np.ix_(keep, keep)], M[np.ix_(keep, keep)], eigvals_only=True)[:n]))


@pytest.mark.parametrize("root", ["clamped", "symmetric", "antisymmetric"])
@pytest.mark.parametrize("sweep", [0.0, KINKED], ids=["straight", "kinked"])
def test_cubic_elements_have_the_ritz_values_of_nodal_displacement_elements(root, sweep):
    # the same space of functions in another basis: the same Ritz values, at a coarse mesh as at a fine one
    beam = SlenderBeam(
        **TAPERED,
        sweep=sweep,
        coupling=[8e3, 0.0, -4e3, 1e3],
        masses=LUMPS,
        root="clamped" if root == "clamped" else "free",
        symmetry="antisymmetric" if root == "antisymmetric" else "symmetric",
    )
    mesh = beam_mesh(beam, elements=12, degree=3)
    # 12 elements over 6 m with panels of 2, 1.5 and 2.5 m: 4, 3 and 5; the textbook mesh wants the same in all: 12 each
    assert mesh.nodes.size == 13
    n = 8
    ours = beam_modes(beam, n=n, elements=200, degree=3).omega
    theirs = nodal_frequencies(beam, 67, n)
    r = {"clamped": 0, "symmetric": 2, "antisymmetric": 1}[root]
    assert np.all(ours[:r] == 0.0)
    assert theirs[:r].max(initial=0.0) < 1e-2 * ours[r]
    np.testing.assert_allclose(ours[r:], theirs[r:], rtol=NODAL)


def test_cubic_elements_match_nodal_elements_at_the_same_coarse_mesh():
    beam = SlenderBeam(**UNIFORM, cg_offset=0.18288)
    ours = beam_modes(beam, n=6, elements=5, degree=3).omega
    np.testing.assert_allclose(ours, nodal_frequencies(beam, 5, 6), rtol=1e-9)


# --- mass lumps and root conditions -----------------------------------------------------------------------------------


def test_tip_mass_of_a_cantilever_obeys_its_transcendental_equation():
    L, m, EI, tip = 2.0, 3.0, 50.0, 4.5
    beam = SlenderBeam(y=[0.0, L], mass=m, inertia=1e-3, EI=EI, GJ=1e6, masses=(BeamMass(y=L, mass=tip),))

    def equation(b):
        return 1 + np.cos(b) * np.cosh(b) + tip / (m * L) * b * (np.cos(b) * np.sinh(b) - np.sin(b) * np.cosh(b))

    betas = np.array([brentq(equation, 0.5, 1.8, xtol=1e-14), brentq(equation, 3.0, 4.6, xtol=1e-14)])
    np.testing.assert_allclose(beam_modes(beam, n=2).omega, (betas / L) ** 2 * np.sqrt(EI / m), rtol=SERIES)


def test_tip_inertia_of_a_torsion_bar_obeys_its_transcendental_equation():
    L, inertia, GJ, tip = 2.0, 0.7, 30.0, 1.1
    beam = SlenderBeam(
        y=[0.0, L], mass=1e-3, inertia=inertia, EI=1e9, GJ=GJ, masses=(BeamMass(y=L, mass=0.0, inertia=tip),)
    )
    ratio = inertia * L / tip
    b = brentq(lambda b: b * np.tan(b) - ratio, 1e-6, np.pi / 2 - 1e-6, xtol=1e-14)
    found = beam_modes(beam, n=1)
    assert found.names == ("torsion 1",)
    np.testing.assert_allclose(found.omega[0], b / L * np.sqrt(GJ / inertia), rtol=SERIES)


def test_massless_beam_with_a_tip_mass_is_one_oscillator():
    beam = SlenderBeam(y=[0.0, 2.0], mass=0.0, inertia=0.0, EI=40.0, GJ=3.0, masses=(BeamMass(y=2.0, mass=5.0),))
    np.testing.assert_allclose(beam_modes(beam, n=1).omega, np.sqrt(3 * 40.0 / 2.0**3 / 5.0), rtol=IDENTITY)
    with pytest.raises(ValueError, match="only 1 elastic mode"):
        beam_modes(beam, n=2)


def test_offset_tip_mass_on_a_massless_beam_is_a_two_by_two_problem():
    L, EI, GJ, m, x, own = 2.0, 40.0, 3.0, 5.0, 0.3, 0.2
    lump = BeamMass(y=L, mass=m, x=x, inertia=own)
    beam = SlenderBeam(y=[0.0, L], mass=0.0, inertia=0.0, EI=EI, GJ=GJ, masses=(lump,))
    # flexibility in (h down, twist); inertia of a mass x aft of the axis in the same: h + x theta goes down
    C = np.diag([L**3 / (3 * EI), L / GJ])
    M = np.array([[m, m * x], [m * x, m * x**2 + own]])
    mu = np.sort(np.linalg.eigvals(C @ M))[::-1]
    found = beam_modes(beam, n=2, points=[L])
    np.testing.assert_allclose(found.omega, mu**-0.5, rtol=IDENTITY)
    for i, value in enumerate(mu):
        shape = np.array([found.h[0, i], found.twist[0, i]])
        np.testing.assert_allclose(C @ M @ shape, value * shape, rtol=1e-9)


def test_lump_anywhere_in_a_panel_is_the_limit_of_a_short_heavy_stretch():
    lump = SlenderBeam(**UNIFORM, masses=(BeamMass(y=2.7, mass=60.0, x=0.25, inertia=2.0),))
    error = []
    for width in (0.02, 0.01):
        y = np.array([0.0, 2.7 - width / 2, 2.7 - width / 2 + 1e-6, 2.7 + width / 2 - 1e-6, 2.7 + width / 2, 6.096])
        heavy = np.array([0, 0, 1, 1, 0, 0]) / width
        total = 35.717 + 60.0 * heavy
        beam = SlenderBeam(
            y=y,
            mass=total,
            inertia=8.642 + (2.0 + 60.0 * 0.25**2) * heavy,
            cg_offset=60.0 * heavy * 0.25 / total,
            EI=9.773e6,
            GJ=0.9876e6,
        )
        error.append(np.abs(beam_modes(beam, n=4).omega / beam_modes(lump, n=4).omega - 1).max())
    assert error[0] < 2e-3 and error[1] < 0.6 * error[0]


@pytest.mark.parametrize("sweep", [0.0, np.radians(30.0), KINKED], ids=["straight", "swept", "kinked"])
def test_huge_root_mass_clamps_a_free_root(sweep):
    free = SlenderBeam(**TAPERED, sweep=sweep, root="free", masses=(*LUMPS, BeamMass(y=0.0, mass=1e12, inertia=1e12)))
    clamped = dataclasses.replace(free, root="clamped", masses=LUMPS)
    a, b = beam_modes(free, n=7, elements=16), beam_modes(clamped, n=5, elements=16)
    assert a.names == ("heave", "pitch", *b.names)
    np.testing.assert_allclose(a.omega[2:], b.omega, rtol=1e-10)
    np.testing.assert_allclose(a.phi[:, :, 2:], b.phi, atol=1e-8 * np.abs(b.phi).max())


def test_huge_roll_inertia_clamps_an_antisymmetric_root():
    free = SlenderBeam(
        **TAPERED, root="free", symmetry="antisymmetric", masses=(BeamMass(y=0.0, mass=0.0, roll_inertia=1e14),)
    )
    clamped = dataclasses.replace(free, root="clamped", masses=())
    np.testing.assert_allclose(
        beam_modes(free, n=6, elements=16).omega[1:], beam_modes(clamped, n=5, elements=16).omega, rtol=1e-10
    )


# --- rigid-body modes -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("symmetry", ["symmetric", "antisymmetric"])
def test_rigid_body_modes_are_exact_on_a_kinked_axis(symmetry):
    beam = SlenderBeam(**TAPERED, sweep=KINKED, masses=LUMPS, root="free", symmetry=symmetry, origin=[0.4, 0.3, 0.1])
    matrices = beam_matrices(beam)
    r = len(matrices.rigid_names)
    assert np.all(matrices.K[:r] == 0.0) and np.all(matrices.K[:, :r] == 0.0)
    # the same wing as a cloud of 120 000 points of mass, in the aircraft's axes
    s = (np.arange(120_000) + 0.5) * 6.0 / 120_000
    m, d, inertia = (beam.at(name, s) * 6.0 / 120_000 for name in ("mass", "cg_offset", "inertia"))
    d = beam.at("cg_offset", s)
    sweep = beam.at("sweep", s)
    aft = np.stack([np.cos(sweep), -np.sin(sweep)], axis=1)
    spread = np.sqrt(inertia / m - d**2)  # each section as two points about its centre of gravity
    axis = beam.position(s)[:, :2]
    cloud = np.concatenate([axis + (d + spread)[:, None] * aft, axis + (d - spread)[:, None] * aft])
    mass = np.concatenate([m / 2, m / 2])
    for lump in LUMPS:
        direction = np.array([np.cos(beam.at("sweep", lump.y)), -np.sin(beam.at("sweep", lump.y))])
        radius = np.sqrt(lump.inertia / lump.mass)
        for side in (radius, -radius):
            cloud = np.vstack([cloud, beam.position(lump.y)[:2] + (lump.x + side) * direction])
            mass = np.append(mass, lump.mass / 2)
    if symmetry == "symmetric":
        x_cg = mass @ cloud[:, 0] / mass.sum()
        expected = [mass.sum(), mass @ (cloud[:, 0] - x_cg) ** 2]
        assert matrices.x_cg == pytest.approx(x_cg, rel=1e-8)
    else:
        expected = [mass @ cloud[:, 1] ** 2]
    np.testing.assert_allclose(np.diag(matrices.M)[:r], expected, rtol=1e-8)


@pytest.mark.parametrize("symmetry", ["symmetric", "antisymmetric"])
def test_elastic_modes_carry_no_momentum_in_the_rigid_body_modes(symmetry):
    beam = SlenderBeam(**TAPERED, sweep=KINKED, root="free", symmetry=symmetry)
    # Gauss points between the ends of the elements: exact for what is handed out
    y, weight = gauss_points(beam_mesh(beam, elements=12).nodes, 8)
    found = beam_modes(beam, n=6, points=y, elements=12)
    m, d, inertia = beam.at("mass", y), beam.at("cg_offset", y), beam.at("inertia", y)
    h, twist = found.h, found.twist
    M = np.einsum("g,gi,gj->ij", weight * m, h, h) + np.einsum("g,gi,gj->ij", weight * inertia, twist, twist)
    mixed = np.einsum("g,gi,gj->ij", weight * m * d, h, twist)
    # unit generalised masses and orthogonality, from the shapes handed out alone
    np.testing.assert_allclose(M + mixed + mixed.T, np.eye(6), atol=1e-9)


def test_rigid_shapes_are_rigid():
    beam = SlenderBeam(**TAPERED, sweep=KINKED, root="free", origin=[0.5, 0.0, 0.0])
    found = beam_modes(beam, n=2)
    heave, pitch = found.phi[..., 0], found.phi[..., 1]
    np.testing.assert_allclose(heave / heave[0, 2], np.tile([0, 0, 1.0, 0, 0, 0], (33, 1)), atol=1e-14)
    assert np.all(heave[:, 2] < 0.0)  # heave is down
    assert np.all(pitch[:, 4] > 0.0)  # nose up
    np.testing.assert_allclose(np.ptp(pitch[:, 4]), 0.0, atol=1e-14)
    slope = np.diff(pitch[:, 2]) + pitch[0, 4] * np.diff(found.grid[:, 0])
    np.testing.assert_allclose(slope, 0.0, atol=1e-12)
    roll = beam_modes(dataclasses.replace(beam, symmetry="antisymmetric"), n=1)
    np.testing.assert_allclose(roll.phi[:, 2, 0], roll.phi[0, 3, 0] * found.grid[:, 1], atol=1e-12)
    assert roll.phi[-1, 2, 0] < 0.0  # starboard wing down


# --- axes, signs, names -----------------------------------------------------------------------------------------------


def test_turning_the_whole_axis_changes_no_frequency_and_only_turns_the_shapes():
    straight = SlenderBeam(**TAPERED, coupling=[8e3, 0.0, -4e3, 1e3], masses=LUMPS, sweep=KINKED - KINKED[0])
    turned = dataclasses.replace(straight, sweep=KINKED)
    a, b = beam_modes(straight, n=8), beam_modes(turned, n=8)
    np.testing.assert_allclose(b.omega, a.omega, rtol=IDENTITY)
    assert a.names == b.names
    np.testing.assert_allclose(b.h, a.h, atol=1e-10 * np.abs(a.h).max())
    angle = KINKED[0]
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])  # in (x, y), seen from above
    np.testing.assert_allclose(
        b.phi[:, 3:5], np.einsum("ij,gjn->gin", turn, a.phi[:, 3:5]), atol=1e-10 * np.abs(a.phi[:, 3:5]).max()
    )
    np.testing.assert_allclose(b.grid[:, :2], a.grid[:, :2] @ turn.T, atol=1e-12)


def test_shapes_in_the_two_sets_of_axes_agree():
    beam = SlenderBeam(**TAPERED, sweep=np.radians(25.0), masses=LUMPS)
    found = beam_modes(beam, n=5, points=np.linspace(0.0, 6.0, 401))
    s, c = np.sin(np.radians(25.0)), np.cos(np.radians(25.0))
    np.testing.assert_allclose(found.phi[:, 2], -found.h, atol=0.0)
    np.testing.assert_allclose(found.phi[:, 4], found.twist * c + found.slope * s, atol=1e-12)
    np.testing.assert_allclose(found.phi[:, 3], found.twist * s - found.slope * c, atol=1e-12)
    assert np.all(found.phi[:, [0, 1, 5]] == 0.0)
    # slope is the derivative of h along the axis
    step = found.y[1] - found.y[0]
    numerical = (found.h[2:] - found.h[:-2]) / (2 * step)
    np.testing.assert_allclose(found.slope[1:-1], numerical, atol=2e-4 * np.abs(found.slope).max())


def test_mass_aft_of_the_axis_twists_the_first_bending_mode_nose_up_on_the_way_down():
    # far below the torsion resonance a mass behind the axis, vibrating in bending (tip down), twists the wing
    # through its inertia force -m h'' = + m omega^2 h: it acts down at the mass, aft of the axis, hence nose up. So h
    # down and twist nose up have the same sign in the first bending mode of the Goland wing.
    aft = beam_modes(SlenderBeam(**UNIFORM, cg_offset=0.18288), n=1, points=[6.096])
    forward = beam_modes(SlenderBeam(**UNIFORM, cg_offset=-0.18288), n=1, points=[6.096])
    assert aft.h[0, 0] > 0.0 and aft.twist[0, 0] > 0.0
    assert forward.h[0, 0] > 0.0 and forward.twist[0, 0] < 0.0
    np.testing.assert_allclose(forward.omega, aft.omega, rtol=IDENTITY)


def test_names_follow_the_larger_strain_energy_and_signs_are_settled():
    found = beam_modes(SlenderBeam(**UNIFORM), n=4)
    assert found.names == ("bending 1", "torsion 1", "torsion 2", "bending 2")
    np.testing.assert_allclose(found.torsion_share, [0.0, 1.0, 1.0, 0.0], atol=1e-12)
    tip = found.y.size - 1
    assert found.h[tip, 0] > 0.0 and found.h[tip, 3] > 0.0 and found.twist[tip, 1] > 0.0 and found.twist[tip, 2] > 0.0
    # neither the number of elements nor where the axis points changes a name or a sign
    coupled = SlenderBeam(**TAPERED, masses=LUMPS)
    a = beam_modes(coupled, n=8, elements=19)
    for other in (
        beam_modes(coupled, n=8, elements=23),
        beam_modes(dataclasses.replace(coupled, sweep=0.4), n=8, elements=19),
    ):
        assert other.names == a.names
        np.testing.assert_allclose(other.h, a.h, atol=1e-6 * np.abs(a.h).max())


def test_modal_model_holds_the_modes():
    beam = SlenderBeam(**TAPERED, root="free")
    model, found = modes(beam, n=5, points=[0.0, 3.0, 6.0]), beam_modes(beam, n=5, points=[0.0, 3.0, 6.0])
    assert isinstance(model, ModalModel)
    np.testing.assert_array_equal(model.M, np.eye(5))
    np.testing.assert_array_equal(model.K, np.diag(found.omega**2))
    np.testing.assert_array_equal(model.phi, found.phi)
    np.testing.assert_array_equal(model.grid, found.grid)
    assert model.names == found.names and np.all(model.D == 0.0)
    assert np.all(model.K[:2] == 0.0)


@pytest.mark.parametrize("n", [1, 2])
def test_few_modes_of_a_free_wing_are_its_rigid_ones(n):
    found = beam_modes(SlenderBeam(**UNIFORM, root="free"), n=n)
    assert found.names == ("heave", "pitch")[:n] and np.all(found.omega == 0.0) and found.phi.shape == (33, 6, n)


# --- convergence and conditioning -------------------------------------------------------------------------------------


def test_stations_almost_on_top_of_each_other_cost_no_accuracy():
    # nodal displacement elements lose all digits here: their stiffness grows with 1 / length^3
    plain = SlenderBeam(**UNIFORM, cg_offset=0.18288)
    y = [0.0, 2.0, 2.0 + 1e-9, 4.0, 6.096 - 1e-7, 6.096]
    crowded = SlenderBeam(**{**UNIFORM, "y": y}, cg_offset=0.18288)
    np.testing.assert_allclose(
        beam_modes(crowded, n=5, elements=16).omega, beam_modes(plain, n=5, elements=16).omega, rtol=1e-9
    )


def test_strong_taper_against_a_ritz_solution_in_polynomials():
    L, coupling = 3.0, 40.0
    EI, GJ, m, inertia, d = ([1000.0, 100.0], [700.0, 60.0], [8.0, 2.0], [0.6, 0.1], [0.1, -0.05])
    beam = SlenderBeam(y=[0.0, L], mass=m, inertia=inertia, cg_offset=d, EI=EI, GJ=GJ, coupling=coupling)
    n = 24
    xi, weight = np.polynomial.legendre.leggauss(60)
    y, weight = L * (1 + xi) / 2, L / 2 * weight
    shapes = [np.polynomial.Legendre.basis(k, domain=[0, L]) for k in range(n)]
    square, line = Polynomial([0, 0, 1 / L**2]), Polynomial([0, 1 / L])
    w = [square(y) * p(y) for p in shapes]
    kappa = [
        square.deriv(2)(y) * p(y) + 2 * square.deriv()(y) * p.deriv()(y) + square(y) * p.deriv(2)(y) for p in shapes
    ]
    th = [line(y) * p(y) for p in shapes]
    tau = [line.deriv()(y) * p(y) + line(y) * p.deriv()(y) for p in shapes]
    w, kappa, th, tau = (np.array(x) for x in (w, kappa, th, tau))
    EI, GJ, m, inertia, d = (a + (b - a) * y / L for a, b in (EI, GJ, m, inertia, d))
    cross_m, cross_k = (w * weight * m * d) @ th.T, (kappa * weight * coupling) @ tau.T
    # here w is taken DOWN: coupling of mass and of stiffness enter with a plus
    M = np.block([[(w * weight * m) @ w.T, cross_m], [cross_m.T, (th * weight * inertia) @ th.T]])
    K = np.block([[(kappa * weight * EI) @ kappa.T, cross_k], [cross_k.T, (tau * weight * GJ) @ tau.T]])
    expected = np.sqrt(eigh(K, M, eigvals_only=True)[:5])
    np.testing.assert_allclose(beam_modes(beam, n=5, elements=32, degree=6).omega, expected, rtol=SERIES)


@pytest.mark.parametrize("degree, order", [(3, 4), (4, 6), (5, 8)])
def test_coupled_squared_frequencies_converge_at_the_order_of_the_elements(degree, order):
    beam = SlenderBeam(**UNIFORM, cg_offset=0.18288)
    exact = beam_modes(beam, n=5, elements=40, degree=7).omega ** 2
    coarse, fine = (beam_modes(beam, n=5, elements=e, degree=degree).omega ** 2 / exact - 1 for e in (6, 12))
    rate = np.log2(coarse / fine)
    assert np.all(coarse > 0.0)  # from above, as Ritz values must
    assert np.all(rate[2:] > order - 0.2) and np.all(rate[2:] < order + 0.3)


def test_defaults_converge_modes_asked_for():
    beam = SlenderBeam(**UNIFORM, cg_offset=0.18288)
    for n in (5, 12, 24):
        np.testing.assert_allclose(
            beam_modes(beam, n=n).omega, beam_modes(beam, n=n, elements=60, degree=7).omega, rtol=1e-6
        )


def test_scaling_laws():
    beam = SlenderBeam(**TAPERED, masses=LUMPS)
    base = beam_modes(beam, n=4).omega
    stiff = dataclasses.replace(beam, EI=4 * beam.EI, GJ=4 * beam.GJ)
    np.testing.assert_allclose(beam_modes(stiff, n=4).omega, 2 * base, rtol=IDENTITY)
    heavy = dataclasses.replace(
        beam,
        mass=9 * beam.mass,
        inertia=9 * beam.inertia,
        masses=tuple(dataclasses.replace(a, mass=9 * a.mass, inertia=9 * a.inertia) for a in LUMPS),
    )
    np.testing.assert_allclose(beam_modes(heavy, n=4).omega, base / 3, rtol=IDENTITY)


# --- static -----------------------------------------------------------------------------------------------------------


def test_cranked_cantilever_under_a_tip_load_by_castigliano():
    a, b, kink, EI, GJ, F = 2.0, 1.5, np.radians(55.0), 300.0, 90.0, 7.0
    beam = SlenderBeam(y=[0.0, a, a + b], mass=1.0, inertia=1.0, EI=EI, GJ=GJ, sweep=[0.0, kink, 0.0])
    tip = static_deflection(beam, BeamLoad(point_y=[a + b], point_lift=F), [a + b])
    # inner part: bending moment F (a - s + b cos kink), torque -F b sin kink (a lift behind the axis: nose down)
    reach, c = b * np.cos(kink), b * np.sin(kink)
    up = F * (b**3 / (3 * EI) + ((a + reach) ** 3 - reach**3) / (3 * EI) + c**2 * a / GJ)
    np.testing.assert_allclose(-tip.h[0], up, rtol=IDENTITY)
    inner = static_deflection(beam, BeamLoad(point_y=[a + b], point_lift=F), [0.5 * a])
    np.testing.assert_allclose(inner.twist[0], -F * c * 0.5 * a / GJ, rtol=IDENTITY)


def test_positive_coupling_washes_in():
    EI, GJ, K, L, F = 300.0, 90.0, 60.0, 2.0, 5.0
    beam = SlenderBeam(y=[0.0, L], mass=1.0, inertia=1.0, EI=EI, GJ=GJ, coupling=K)
    y = np.linspace(0.0, L, 5)
    found = static_deflection(beam, BeamLoad(point_y=[L], point_lift=F), y)
    # no torque: GJ theta' = K w''; then w'' = M GJ / (EI GJ - K^2)
    bend = F * (L * y**2 / 2 - y**3 / 6)
    np.testing.assert_allclose(found.h, -bend * GJ / (EI * GJ - K * K), atol=1e-14)
    np.testing.assert_allclose(found.twist, F * (L * y - y**2 / 2) * K / (EI * GJ - K * K), atol=1e-14)
    assert np.all(found.twist[1:] > 0.0)


def test_flexibility_is_reciprocal_and_repeats_static_deflections():
    beam = SlenderBeam(**TAPERED, sweep=KINKED, coupling=[8e3, 0.0, -4e3, 1e3])
    points = np.array([0.7, 2.0, 3.1, 6.0])
    C = flexibility(beam, points)
    np.testing.assert_array_equal(C, C.transpose(2, 3, 0, 1))
    for i, y in enumerate(points):
        lift = static_deflection(beam, BeamLoad(point_y=[y], point_lift=1.0), points)
        np.testing.assert_allclose(C[:, :, i, 0], lift.displacement[:, 2:5], rtol=1e-8, atol=1e-12)
    assert np.linalg.eigvalsh(C.reshape(12, 12)).min() > 0.0


def test_all_modes_together_are_the_flexibility():
    # the sum of phi phi' / omega^2 over every mode of a mesh is the flexibility of that mesh
    beam = SlenderBeam(**TAPERED, sweep=KINKED, coupling=[8e3, 0.0, -4e3, 1e3], masses=LUMPS)
    points = beam.y[1:]
    coordinates = beam_mesh(beam, elements=4, degree=3).n_strain
    found = beam_modes(beam, n=coordinates, points=points, elements=4, degree=3)
    shapes = found.phi[:, 2:5].reshape(9, -1)
    C = flexibility(beam, points, elements=4, degree=3).reshape(9, 9)
    np.testing.assert_allclose((shapes / found.omega**2) @ shapes.T, C, atol=1e-10 * np.abs(C).max())


# --- bad input --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "change, message",
    [
        ({"y": [0.0]}, "y must hold two or more stations"),
        ({"y": [0.0, 2.0, 1.0, 6.0]}, "y must ascend"),
        ({"y": [0.0, 2.0, 2.0, 6.0]}, "y must ascend"),
        ({"EI": [1.0, 0.0, 1.0, 1.0]}, "EI must be positive"),
        ({"GJ": -3.0}, "GJ must be positive"),
        ({"EI": [1.0, 2.0]}, "EI must be a number or one value per station"),
        ({"mass": -1.0}, "mass must be >= 0"),
        ({"mass": float("nan")}, "mass holds a value that is not finite"),
        ({"sweep": np.pi / 2}, "sweep must lie between -90 and 90 deg"),
        ({"sweep": [0.0, -1.6, 0.0, 0.0]}, "sweep must lie between -90 and 90 deg"),
        ({"cg_offset": 3.0}, r"inertia about the flexural axis must be at least mass \* cg_offset"),
        ({"inertia": -1.0}, "inertia about the flexural axis"),
        ({"coupling": 1e6}, "coupling.2 must stay below EI"),
        ({"masses": (BeamMass(y=6.1, mass=1.0),)}, "y of a lump must lie on the span"),
        ({"root": "hinged"}, "root must be"),
        ({"symmetry": "port"}, "symmetry must be"),
        ({"origin": [0.0, 1.0]}, "origin must be three"),
    ],
)
def test_bad_beams_are_refused_by_name(change, message):
    with pytest.raises(ValueError, match=message):
        SlenderBeam(**{**TAPERED, **change})


def test_inertia_short_only_between_stations_is_refused():
    # m d^2 bulges between the stations: both ends are fine, the middle is not
    with pytest.raises(ValueError, match="at y = "):
        SlenderBeam(y=[0.0, 1.0], mass=[10.0, 0.1], cg_offset=[0.1, 2.0], inertia=[0.11, 0.41], EI=1.0, GJ=1.0)


@pytest.mark.parametrize("field", ["mass", "inertia", "roll_inertia"])
def test_bad_lumps_are_refused(field):
    with pytest.raises(ValueError, match=f"{field} of a lump must be >= 0"):
        BeamMass(**{"y": 0.0, "mass": 1.0, field: -1.0})
    with pytest.raises(ValueError, match=f"{field} of a lump must be finite"):
        BeamMass(**{"y": 0.0, "mass": 1.0, field: float("nan")})


def test_bad_calls_are_refused():
    beam = SlenderBeam(**TAPERED)
    free = dataclasses.replace(beam, root="free")
    for call, message in [
        (lambda: beam_modes(beam, n=0), "n, the number of modes"),
        (lambda: beam_modes(beam, n=100, elements=3, degree=3), "need more elements"),
        (lambda: beam_modes(beam, points=[7.0]), "points must lie on the span"),
        (lambda: beam_modes(beam, elements=0), "elements must be 1 or more"),
        (lambda: beam_modes(beam, degree=2), "degree of the elements must be 3 or more"),
        (lambda: static_deflection(free, BeamLoad(), [1.0]), 'root must be "clamped"'),
        (lambda: flexibility(free, [1.0]), 'root must be "clamped"'),
        (lambda: flexibility(beam, [-1.0]), "points must lie on the span"),
        (lambda: static_deflection(beam, BeamLoad(point_y=[9.0]), [1.0]), "must lie on the span"),
        (lambda: static_deflection(beam, BeamLoad(y=[0.0, 9.0], lift=1.0), [1.0]), "must lie on the span"),
        (lambda: BeamLoad(y=[1.0], lift=1.0), "two or more places"),
        (lambda: BeamLoad(y=[1.0, 0.0], lift=1.0), "must ascend"),
        (lambda: BeamLoad(y=[0.0, 1.0], lift=[1.0, 2.0, 3.0]), "lift must be one number or as many"),
    ]:
        with pytest.raises(ValueError, match=message):
            call()
    nothing = SlenderBeam(y=[0.0, 1.0], mass=0.0, inertia=0.0, EI=1.0, GJ=1.0, root="free")
    with pytest.raises(ValueError, match="needs mass or inertia in heave"):
        beam_modes(nothing)


def test_strain_blocks_are_the_second_derivative_of_the_strain_energy():
    beam = SlenderBeam(y=[0.0, 3.0], mass=1.0, inertia=1.0, EI=[6.0, 2.0], GJ=4.0, coupling=[1.0, 0.5])
    block = stiffness_blocks(beam_mesh(beam, elements=1, degree=3))[0]
    c = np.array([0.3, -0.2, 0.5, 0.4])  # curvature up and twist rate, each constant plus linear
    y, weight = np.polynomial.legendre.leggauss(8)
    kappa, tau = c[0] + c[1] * y, c[2] + c[3] * y
    EI, K = 4.0 - 2.0 * y, 0.75 - 0.25 * y
    energy = 1.5 * weight @ (0.5 * EI * kappa**2 - K * kappa * tau + 2.0 * tau**2)
    assert 0.5 * c @ block @ c == pytest.approx(energy, rel=IDENTITY)
