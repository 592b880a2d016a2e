"""The wing with section polars: sums by hand, trim, marks; and the thesis' argument on the centre of gravity."""

from dataclasses import replace

import numpy as np
import pytest

from aeroservo.aero.polars import INSIDE, OUTSIDE, STALLED, Polar
from aeroservo.aero.trefftz import induced_drag
from aeroservo.aero.viscous_wing import WingSections, marks_in_words, trimmed, viscous_wing
from aeroservo.aero.vlm import VortexLattice
from aeroservo.aero.vlm_loads import span_loading
from aeroservo.aeroelastic.aircraft_lattice import aircraft_lattice
from aeroservo.aircraft.files import read
from aeroservo.studies.wing_polar import SEA_LEVEL_VISCOSITY, trimmed_wing, wing_polar, wing_sections

EXACT = 1e-12

OPTIONS = VortexLattice(chordwise=6, spanwise=16)
SPEED = 30.0


def formula(stall_deg=12.0, cm_delta=-0.6):
    """CL = 2 pi alpha + 3.8 delta to a stall, CD = 0.01 + 0.005 CL^2, CM = cm_delta delta, at any Reynolds number."""
    alpha, delta, reynolds = np.radians(np.arange(-20, 21.0)), np.radians(np.arange(-20, 21, 5.0)), np.array([1e5, 1e7])
    _, d, a = np.meshgrid(reynolds, delta, alpha, indexing="ij")
    top = np.radians(stall_deg)
    CL = 2 * np.pi * np.where(a > top, 2 * top - a, np.where(a < -top, -2 * top - a, a)) + 3.8 * d
    return Polar(
        name="formula",
        source="test",
        alpha=alpha,
        delta=delta,
        reynolds=reynolds,
        CL=CL,
        CD=0.01 + 0.005 * CL**2,
        CM=cm_delta * d,
    )


@pytest.fixture(scope="module")
def model():
    return read("thesis-uav")


@pytest.fixture(scope="module")
def found(model):
    return aircraft_lattice(model.surfaces(), model.references(), method=OPTIONS)


def run(model, found, inputs, polar):
    sections = wing_sections(model, found, speed=SPEED, polars=[polar])
    x = np.zeros((len(inputs), len(found.derivatives.names)))
    for row, values in zip(x, inputs):
        for name, value in values.items():
            row[found.derivatives.names.index(name)] = value
    return viscous_wing(
        span_loading(found.solution),
        found.derivatives,
        found.drag,
        sections,
        x,
        mirrored=found.solution.lattice.mirrored,
    )


def test_profile_drag_is_the_area_weighted_sum(model, found):
    polar = run(model, found, [{"steady": 1.0, "alpha": 0.05, "elevon": np.radians(5.0)}], formula())
    loading = span_loading(found.solution)
    lift = polar.section_lift[0]
    by_hand = 2 * np.sum((0.01 + 0.005 * lift**2) * loading.chord * loading.width) / 1.0
    assert polar.CD_profile[0] == pytest.approx(by_hand, rel=2e-3)  # the table is linear between whole degrees
    assert polar.CL[0] == pytest.approx(2 * np.sum(lift * loading.chord * loading.width), rel=5e-3)
    assert np.all(polar.mark == INSIDE) and not polar.stalled[0] and marks_in_words(polar) == ("",)
    x = np.zeros(len(found.derivatives.names))
    x[[found.derivatives.names.index(n) for n in ("steady", "alpha", "elevon")]] = 1.0, 0.05, np.radians(5.0)
    assert polar.CD_induced[0] == pytest.approx(x @ induced_drag(found.solution).matrix @ x, rel=EXACT)
    assert polar.lift_to_drag_inviscid[0] > polar.lift_to_drag[0] > 0


def test_viscous_moment_replaces_the_sections_own(model, found):
    """With sections whose moments are the lattice's, nothing changes; a shift of all of them shifts the wing's."""
    zero = run(model, found, [{"steady": 1.0, "alpha": 0.05}], formula(cm_delta=0.0))
    loading = span_loading(found.solution)
    steady = np.zeros(len(found.derivatives.names))
    steady[[found.derivatives.names.index(n) for n in ("steady", "alpha")]] = 1.0, 0.05
    own = 2 * np.sum((loading.cm_quarter @ steady) * loading.chord**2 * loading.width) / found.reference.c
    assert zero.CM_viscous[0] - zero.CM[0] == pytest.approx(-own, rel=1e-9)
    polar = formula(cm_delta=0.0)
    shifted = run(model, found, [{"steady": 1.0, "alpha": 0.05}], replace(polar, CM=polar.CM - 0.01))
    squared = 2 * np.sum(loading.chord**2 * loading.width) / found.reference.c
    assert shifted.CM_viscous[0] - zero.CM_viscous[0] == pytest.approx(-0.01 * squared, rel=1e-9)
    assert squared == pytest.approx(1.0, rel=0.01)  # the mean aerodynamic chord's own definition


def test_stall_and_table_ends_are_marked(model, found):
    conditions = [{"steady": 1.0, "alpha": a} for a in (0.05, 0.35, 3.0)]
    polar = run(model, found, conditions, formula(stall_deg=8.0))
    assert polar.stalled.tolist() == [False, True, True]
    assert np.any(polar.mark[1] == STALLED) and np.isfinite(polar.CD_profile[1])
    assert "lift is overestimated" in marks_in_words(polar)[1]
    slow = wing_sections(model, found, speed=1.0, polars=[formula()])
    x = np.zeros((1, len(found.derivatives.names)))
    out = viscous_wing(span_loading(found.solution), found.derivatives, found.drag, slow, x, mirrored=True)
    assert np.any(out.mark == OUTSIDE) and np.isnan(out.CD_profile[0]) and "outside" in marks_in_words(out)[0]


def test_half_and_full_lattices_agree(model, found):
    full = aircraft_lattice(model.surfaces(), model.references(), method=OPTIONS, full=True)
    inputs = [{"steady": 1.0, "alpha": 0.06, "elevon": -0.05}]
    a, b = run(model, found, inputs, formula()), run(model, full, inputs, formula())
    for name in ("CL", "CD_induced", "CD_profile", "CM", "CM_viscous"):
        np.testing.assert_allclose(getattr(a, name), getattr(b, name), rtol=1e-9, err_msg=name)
    with pytest.raises(ValueError, match="full=True"):
        run(model, found, [{"p": 0.1}], formula())
    run(model, full, [{"p": 0.1}], formula())


def test_trim_is_in_balance(model, found):
    x_cg = np.linspace(0.30, 0.40, 5)
    sections = wing_sections(model, found, speed=SPEED, polars=[formula()])
    trim = trimmed(
        span_loading(found.solution),
        found.derivatives,
        found.drag,
        sections,
        CL=0.25,
        x_cg=x_cg,
        control="elevon",
        mirrored=True,
    )
    np.testing.assert_allclose(trim.polar.CL, 0.25, atol=1e-9)
    arm = (x_cg - found.reference.x) / found.reference.c
    np.testing.assert_allclose(trim.polar.CM_viscous + arm * trim.polar.CL, 0.0, atol=1e-9)
    assert np.all(np.diff(trim.delta) > 0) and np.all(np.diff(trim.static_margin) < 0)
    assert trim.static_margin[0] == pytest.approx((found.derivatives.neutral_point - 0.30) / found.reference.c)
    with pytest.raises(ValueError, match="no input 'flap'"):
        trimmed(
            span_loading(found.solution),
            found.derivatives,
            found.drag,
            sections,
            CL=0.2,
            x_cg=x_cg,
            control="flap",
            mirrored=True,
        )


def test_sections_of_a_wing(model, found):
    sections = wing_sections(model, found, speed=SPEED, polars=[formula()])
    grid = found.solution.lattice
    np.testing.assert_allclose(sections.reynolds, SPEED * grid.strip_chord / SEA_LEVEL_VISCOSITY)
    elevon = sections.gain[:, found.derivatives.names.index("elevon")]
    np.testing.assert_array_equal(elevon, (grid.strip_span > 0.5).astype(float))
    with pytest.raises(ValueError, match="speed"):
        wing_sections(model, found, speed=0.0)
    with pytest.raises(ValueError, match="one for each of 1 surface"):
        wing_sections(model, found, speed=1.0, polars=[formula()] * 2)
    with pytest.raises(ValueError, match="columns"):
        viscous_wing(
            span_loading(found.solution), found.derivatives, found.drag, sections, np.zeros((1, 2)), mirrored=True
        )
    assert isinstance(sections, WingSections)


def test_the_thesis_argument_on_the_centre_of_gravity(model):
    """Figure 4 in numbers: at one lift the trimmed L/D grows as the centre of gravity moves aft of a stable place."""
    trim = trimmed_wing(model, x_cg=[0.31, 0.33, 0.35, 0.37], CL=0.3, speed=SPEED, method=OPTIONS)
    assert trim.static_margin[0] > 0.08 and trim.static_margin[-1] < 0
    assert not np.any(trim.polar.stalled)
    ratio = trim.polar.lift_to_drag
    assert np.all(np.diff(ratio) > 0)
    assert ratio[-1] / ratio[0] > 1.1  # what the stability of a flying wing costs here: more than 10 %
    assert np.all(np.diff(trim.delta) > 0)


def test_wing_polar_of_every_deflection(model):
    """Figures 22-25: lift and nose-down moment grow with the elevon; friction takes its share at every angle."""
    alpha, delta = np.radians([2.0, 4.0, 6.0]), np.radians([-5.0, 0.0, 5.0])
    found = wing_polar(model, alpha=alpha, delta=delta, speed=SPEED, method=OPTIONS)
    CL, CM = (np.array([getattr(p, n) for p in found]) for n in ("CL", "CM_viscous"))
    assert np.all(np.diff(CL, axis=0) > 0.05) and np.all(np.diff(CM, axis=0) < -0.015)
    assert np.all([p.CD_induced < p.CD for p in found])
    assert np.all(np.diff(CL, axis=1) > 0)


def test_morphed_beside_hinged(model):
    """Figures 22-25 side by side: at one lift coefficient the wing's L/D differs by little, as the thesis found."""
    other = model.model_copy(
        update={
            "surface": (
                model.surface[0].model_copy(
                    update={"control": (model.surface[0].control[0].model_copy(update={"kind": "morphed"}),)}
                ),
            )
        }
    )
    alpha = np.radians(np.arange(0.0, 9.0))
    best = {}
    for name, this in (("hinged", model), ("morphed", other)):
        (found,) = wing_polar(this, alpha=alpha, delta=np.radians([5.0]), speed=SPEED, method=OPTIONS)
        best[name] = np.interp(0.4, found.CL, found.lift_to_drag)
        assert not np.any(found.stalled)
    assert best["morphed"] == pytest.approx(best["hinged"], rel=0.08)
