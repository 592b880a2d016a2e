"""Published beams: frequency parameters, Goland's wing in vacuum, and the thesis' closed forms of chapter 4."""

from __future__ import annotations

import json
from importlib.resources import files

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.linalg import expm
from scipy.optimize import brentq

from aeroservo.structure.beam import SlenderBeam, beam_matrices, beam_modes
from aeroservo.structure.beam_elements import beam_mesh, stiffness_blocks
from aeroservo.structure.beam_static import BeamLoad, static_deflection

BEAMS = json.loads((files("aeroservo") / "cases" / "beams" / "reference.json").read_text(encoding="utf-8"))
GOLAND = json.loads((files("aeroservo") / "cases" / "goland" / "reference.json").read_text(encoding="utf-8"))
CLOSED_FORM = (
    1e-10  # thesis chapter 4: polynomials that the elements hold exactly, so rounding (of a fit, where one is made)
)
PRINTED = 1e-10  # ten digits after the point


# --- frequency parameters ---------------------------------------------------------------------------------------------


def bending_betas(length: float, **options) -> np.ndarray:
    """Frequency parameters (omega^2 m / EI)^(1/4) times `length` of the elastic bending modes, EI 70, m 3."""
    scale = options.pop("scale", 1.0)
    n = options.pop("n")
    settings = {k: options.pop(k) for k in ("elements", "degree") if k in options}
    beam = SlenderBeam(y=[0.0, length], mass=3.0, inertia=1e-6, EI=70.0, GJ=1e6, **options)
    found = beam_modes(beam, n=n, **settings)
    omega = found.omega[found.omega > 0.0]
    return scale * length * (omega**2 * 3.0 / 70.0) ** 0.25


def test_cantilever_frequency_parameters():
    case = BEAMS["cantilever_betaL"]
    np.testing.assert_allclose(bending_betas(2.5, n=4), case["values"], rtol=case["tolerance"])


def test_free_free_frequency_parameters_from_the_two_halves():
    case = BEAMS["free_free_betaL"]
    symmetric = bending_betas(2.5, n=3, scale=2.0, root="free")[0]
    antisymmetric = bending_betas(2.5, n=2, scale=2.0, root="free", symmetry="antisymmetric")[0]
    np.testing.assert_allclose([symmetric, antisymmetric], case["values"], rtol=case["tolerance"])


def test_reference_digits_are_the_roots_of_the_frequency_equations():
    for name, sign in (("cantilever_betaL", 1.0), ("free_free_betaL", -1.0)):
        for value in BEAMS[name]["values"]:
            root = brentq(lambda x: np.cos(x) + sign / np.cosh(x), value - 0.1, value + 0.1, xtol=1e-14)  # noqa: B023
            assert value == pytest.approx(root, abs=PRINTED)
    np.testing.assert_allclose(
        BEAMS["torsion_clamped_free_betaL"]["values"], (2 * np.arange(1, 4) - 1) * np.pi / 2, rtol=PRINTED
    )


def test_torsion_of_a_clamped_free_bar():
    case = BEAMS["torsion_clamped_free_betaL"]
    beam = SlenderBeam(y=[0.0, 2.5], mass=1e-6, inertia=0.7, EI=1e6, GJ=30.0)
    found = beam_modes(beam, n=3)
    assert found.names == ("torsion 1", "torsion 2", "torsion 3")
    np.testing.assert_allclose(found.omega * 2.5 * np.sqrt(0.7 / 30.0), case["values"], rtol=case["tolerance"])


@pytest.mark.parametrize("i", range(3))
def test_squared_frequencies_converge_at_the_right_order(i):
    case = BEAMS["convergence_order_of_omega_squared"]
    degree, order = case["degree"][i], case["values"][i]
    mode, elements = 3, 8
    exact = brentq(lambda x: np.cos(x) + 1.0 / np.cosh(x), 10.9, 11.1, xtol=1e-14) ** 4
    coarse, fine = (
        bending_betas(2.5, n=4, elements=e, degree=degree)[mode] ** 4 / exact - 1 for e in (elements, 2 * elements)
    )
    assert coarse > fine > 0.0
    assert np.log2(coarse / fine) == pytest.approx(order, abs=case["tolerance"])
    # torsion: degree - 1 in the elements, the same order
    exact = (5 * np.pi / 2) ** 2
    beam = SlenderBeam(y=[0.0, 1.0], mass=1e-6, inertia=1.0, EI=1e9, GJ=1.0)
    coarse, fine = (
        beam_modes(beam, n=3, elements=e, degree=degree).omega[2] ** 2 / exact - 1 for e in (elements, 2 * elements)
    )
    assert np.log2(coarse / fine) == pytest.approx(order, abs=case["tolerance"])


# --- Goland -----------------------------------------------------------------------------------------------------------


def goland(cg: float | None = None) -> SlenderBeam:
    """Goland's wing, or the same with its centre of gravity at `cg` chords."""
    wing = GOLAND["inputs"]
    cg = wing["cg_axis"] if cg is None else cg
    return SlenderBeam(
        y=[0.0, wing["length_m"]],
        mass=wing["mass_kg_per_m"],
        inertia=wing["inertia_kg_m"],
        cg_offset=(cg - wing["flexural_axis"]) * wing["chord_m"],
        EI=wing["EI_N_m2"],
        GJ=wing["GJ_N_m2"],
    )


def test_goland_in_vacuum():
    wing, case = goland(), GOLAND["vacuum"]
    np.testing.assert_allclose(wing.mass * wing.cg_offset, GOLAND["inputs"]["static_moment_kg"], rtol=1e-12)
    found = beam_modes(wing, n=5)
    np.testing.assert_allclose(found.omega, case["values"], rtol=case["tolerance"])
    assert found.names == ("bending 1", "torsion 1", "torsion 2", "bending 2", "torsion 3")


def test_goland_digits_are_those_of_the_exact_solution():
    wing = goland()
    L, m, S, inertia = wing.length, wing.mass[0], wing.mass[0] * wing.cg_offset[0], wing.inertia[0]
    EI, GJ = wing.EI[0], wing.GJ[0]

    def determinant(omega):
        # h, h', h'', h''' and theta, theta' along y/L; EI h'''' = w^2 (m h + S th), -GJ th'' = w^2 (I th + S h), h down
        A = np.zeros((6, 6))
        A[0, 1] = A[1, 2] = A[2, 3] = A[4, 5] = 1.0
        A[3, 0], A[3, 4] = omega**2 * L**4 / EI * np.array([m, S])
        A[5, 0], A[5, 4] = -(omega**2) * L**2 / GJ * np.array([S, inertia])
        return np.linalg.det(expm(A)[np.ix_([2, 3, 5], [2, 3, 5])])

    exact = [brentq(determinant, 0.999 * w, 1.001 * w, xtol=1e-12) for w in GOLAND["vacuum"]["values"]]
    np.testing.assert_allclose(GOLAND["vacuum"]["values"], exact, rtol=1e-11)
    np.testing.assert_allclose(beam_modes(wing, n=5, elements=20, degree=6).omega, exact, rtol=1e-11)


def test_goland_uncoupled():
    found = beam_modes(goland(cg=0.33), n=4)
    for kind in ("bending", "torsion"):
        case = GOLAND[f"uncoupled_{kind}"]
        omega = [w for w, name in zip(found.omega, found.names) if name.startswith(kind)]
        np.testing.assert_allclose(omega, case["values"], rtol=case["tolerance"])


# --- Bramstång 2015, chapter 4 ----------------------------------------------------------------------------------------

EI, GJ, SPAN, LOAD, TORQUE = 900.0, 250.0, 3.0, 40.0, 12.0


def uniform(**changes) -> SlenderBeam:
    """A uniform cantilever half wing."""
    return SlenderBeam(**{"y": [0.0, SPAN], "mass": 2.0, "inertia": 0.3, "EI": EI, "GJ": GJ, **changes})


def fitted(load: BeamLoad, name: str, degree: int) -> Polynomial:
    """The deflection as one polynomial over the span, so that it can be differentiated."""
    y = np.linspace(0.0, SPAN, 3 * degree)
    values = getattr(static_deflection(uniform(), load, y, elements=1), name)
    polynomial, (residual, *_) = Polynomial.fit(y, values, degree, domain=[0.0, SPAN], full=True)
    assert residual.size == 0 or residual[0] < 1e-24 * np.abs(values).max() ** 2 + 1e-30
    return polynomial


def test_uniform_load_4_1_to_4_10():
    h = fitted(BeamLoad(y=[0.0, SPAN], lift=LOAD), "h", 4)
    y = np.linspace(0.0, SPAN, 11)
    W, s = LOAD, SPAN
    scale = W * s**2 / 2
    # [4.1] with the load positive up and h down: EI h'''' = -W
    np.testing.assert_allclose(EI * h.deriv(4)(y), -W, rtol=1e-8)
    # [4.2], [4.6], [4.7]
    np.testing.assert_allclose(EI * h.deriv(2)(y), -W / 2 * (s - y) ** 2, atol=CLOSED_FORM * scale)
    np.testing.assert_allclose(EI * h.deriv(2)(y), -W / 2 * (s**2 - 2 * s * y + y**2), atol=CLOSED_FORM * scale)
    # [4.8] with C1 = 0, from the polynomial and from the slope handed out
    slope = -W / 2 * (s**2 * y - s * y**2 + y**3 / 3) / EI
    np.testing.assert_allclose(h.deriv()(y), slope, atol=CLOSED_FORM)
    found = static_deflection(uniform(), BeamLoad(y=[0.0, s], lift=W), y)
    np.testing.assert_allclose(found.slope, slope, atol=1e-13)
    # [4.9] and [4.10], which take a minus for h down
    np.testing.assert_allclose(found.h, -W / 2 * (s**2 * y**2 / 2 - s * y**3 / 3 + y**4 / 12) / EI, atol=1e-13)
    np.testing.assert_allclose(found.h, -W / (24 * EI) * (6 * s**2 * y**2 - 4 * s * y**3 + y**4), atol=1e-13)


def test_uniform_torque_4_3():
    theta = fitted(BeamLoad(y=[0.0, SPAN], torque=TORQUE), "twist", 2)
    y = np.linspace(0.0, SPAN, 11)
    np.testing.assert_allclose(GJ * theta.deriv()(y), TORQUE * (SPAN - y), atol=CLOSED_FORM * TORQUE * SPAN)


def test_strain_energy_4_4_is_half_the_work_of_the_load():
    # the thesis' torsion term is GJ (d theta/dy)^2 / 2
    load = BeamLoad(y=[0.0, SPAN], lift=LOAD, torque=TORQUE)
    h, theta = fitted(load, "h", 4), fitted(load, "twist", 2)
    energy = ((h.deriv(2) ** 2) * EI / 2 + (theta.deriv() ** 2) * GJ / 2).integ()
    work = (h * -LOAD / 2).integ()(SPAN) - (h * -LOAD / 2).integ()(0.0)
    work += (theta * TORQUE / 2).integ()(SPAN) - (theta * TORQUE / 2).integ()(0.0)
    assert energy(SPAN) - energy(0.0) == pytest.approx(work, rel=CLOSED_FORM)
    assert work == pytest.approx(LOAD**2 * SPAN**5 / (40 * EI) + TORQUE**2 * SPAN**3 / (6 * GJ), rel=CLOSED_FORM)


def test_assumed_shapes_4_11_and_4_12_lie_in_the_elements():
    # h = (y/s)^2 q_b and theta = (y/s) q_t give the binary wing's E = diag(4 EI/s^3, GJ/s) and its A
    m, d, inertia = 2.0, 0.11, 0.3
    beam = uniform(cg_offset=d)
    mesh = beam_mesh(beam, elements=3, degree=3)
    shape = np.zeros((2, 3, 2, mesh.terms))  # assumed shape, element, kind of strain, term
    shape[0, :, 0, 0] = -2.0 / SPAN**2  # h down: curvature of w is negative
    shape[1, :, 1, 0] = 1.0 / SPAN
    shape = shape.reshape(2, -1)
    matrices = beam_matrices(beam, elements=3, degree=3)
    np.testing.assert_allclose(shape @ matrices.K @ shape.T, np.diag([4 * EI / SPAN**3, GJ / SPAN]), atol=1e-10)
    A = np.array([[m * SPAN / 5, m * d * SPAN / 4], [m * d * SPAN / 4, inertia * SPAN / 3]])
    np.testing.assert_allclose(shape @ matrices.M @ shape.T, A, rtol=1e-12)
    assert stiffness_blocks(mesh).shape == (3, 2 * mesh.terms, 2 * mesh.terms)
