"""Wing geometry and masses: closed forms, second routes, and every refusal."""

import numpy as np
import pytest

from aeroservo.aircraft.geometry import (
    ControlSurface,
    LiftingSurface,
    ReferenceQuantities,
    WingSection,
    section_at,
    span_stations,
)
from aeroservo.aircraft.masses import MassItem, MassProperties, mass_properties, planform_mass
from aeroservo.aircraft.planform import planform, reference_quantities, sweep

IDENTITY = 1e-12  # exact formulas in floating point
QUADRATURE = 2e-6  # a fine midpoint sum against an exact integral
THESIS_INERTIA = 0.01  # I_y of Table 1, 0.503 kg m^2, against an even spread of the mass: its reading of the sweep


def thesis_wing(quarter_sweep=23.0):
    tip = 0.25 * (0.7 - 0.3) + np.tan(np.radians(quarter_sweep))
    return LiftingSurface(
        name="wing",
        sections=(WingSection(y=0.0, chord=0.7), WingSection(y=1.0, x_le=tip, chord=0.3, twist=np.radians(-5))),
    )


def cranked():
    return LiftingSurface(
        name="wing",
        sections=(
            WingSection(y=0.2, x_le=0.1, z_le=0.3, chord=1.2),
            WingSection(y=1.1, x_le=0.4, z_le=0.5, chord=0.9),
            WingSection(y=3.0, x_le=1.9, z_le=0.6, chord=0.2),
        ),
    )


def test_thesis_planform():
    p = planform(thesis_wing())
    np.testing.assert_allclose(
        [p.area, p.span, p.mac, p.mac_y, p.aspect_ratio, p.taper, p.sweep_quarter_chord],
        [1.0, 2.0, 0.5266666666666666, 0.43333333333333335, 4.0, 3 / 7, np.radians(23)],
        rtol=IDENTITY,
    )
    assert np.degrees(p.sweep_leading_edge) == pytest.approx(27.7, abs=0.05)
    assert p.mac_quarter == pytest.approx(0.3589, abs=5e-5)


def test_planform_against_sums():
    wing = cranked()
    y = np.linspace(0.2, 3.0, 200_001)
    y = (y[1:] + y[:-1]) / 2
    s = wing.sections
    chord = np.interp(y, [q.y for q in s], [q.chord for q in s])
    edge = np.interp(y, [q.y for q in s], [q.x_le for q in s])
    area = chord.mean() * 2.8
    p = planform(wing)
    assert p.area == pytest.approx(2 * area, rel=QUADRATURE)
    assert p.mac == pytest.approx((chord**2).mean() * 2.8 / area, rel=QUADRATURE)
    assert p.mac_y == pytest.approx((chord * y).mean() * 2.8 / area, rel=QUADRATURE)
    assert p.mac_x == pytest.approx((chord * edge).mean() * 2.8 / area, rel=QUADRATURE)
    assert p.span == pytest.approx(6.0, rel=IDENTITY)  # the gap at the root is part of the span


def test_fin_is_measured_upright():
    fin = LiftingSurface(
        name="fin", mirrored=False, sections=(WingSection(y=0.0, chord=1.0), WingSection(y=0.0, z_le=2.0, chord=0.5))
    )
    p = planform(fin)
    assert p.area == pytest.approx(1.5, rel=IDENTITY)
    assert p.span == pytest.approx(2.0, rel=IDENTITY)


def test_sweep_and_stations():
    wing = thesis_wing()
    assert sweep(wing, 0.25)[0] == pytest.approx(np.radians(23), rel=IDENTITY)
    assert span_stations(cranked())[-1] == pytest.approx(np.hypot(0.9, 0.2) + np.hypot(1.9, 0.1), rel=IDENTITY)
    edge, chord, twist = section_at(wing, np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(chord, [0.7, 0.5, 0.3], rtol=IDENTITY)
    np.testing.assert_allclose(np.degrees(twist), [0, -2.5, -5], atol=1e-12)
    assert edge[1, 1] == pytest.approx(0.5)
    with pytest.raises(ValueError, match="fraction"):
        section_at(wing, 1.2)


def test_reference_point_is_the_quarter_mean_chord():
    ref = reference_quantities(thesis_wing())
    assert (ref.S, ref.b, ref.y) == (1.0, 2.0, 0.0)
    assert ref.x == pytest.approx(0.35894, abs=1e-5)
    with pytest.raises(ValueError, match=r"reference S must be > 0 \[m\^2\]"):
        ReferenceQuantities(S=0.0, c=1.0, b=1.0)


def test_even_mass_gives_the_thesis_inertia_only_with_quarter_chord_sweep():
    def pitch_inertia(sweep_deg):
        wing = thesis_wing(sweep_deg)
        item = planform_mass(wing, 10.0)
        about = [planform(wing).mac_quarter, 0.0, 0.0]
        return MassProperties(mass=10.0, cg=item.position, inertia=item.inertia).about(about)[1, 1]

    assert pitch_inertia(23.0) == pytest.approx(0.503, rel=THESIS_INERTIA)
    assert pitch_inertia(23.0) == pytest.approx(0.498, abs=5e-4)


def test_lamina_against_a_cloud_of_points():
    wing = cranked()
    rng = np.random.default_rng(3)
    f, xi = rng.random(400_000), rng.random(400_000)
    edge, chord, _ = section_at(wing, f)
    points = edge + np.stack([xi * chord, 0 * f, 0 * f], axis=-1)
    weight = chord / chord.sum() * 7.0
    item = planform_mass(wing, 14.0)
    mean = weight @ points / 7.0
    np.testing.assert_allclose(item.position, [mean[0], 0.0, mean[2]], atol=4e-3)
    I_yy = weight @ ((points[:, 0] - mean[0]) ** 2 + (points[:, 2] - mean[2]) ** 2) * 2
    assert item.inertia[1, 1] == pytest.approx(I_yy, rel=5e-3)


def test_mass_properties_do_not_depend_on_the_order_or_the_grouping():
    rng = np.random.default_rng(1)
    items = [MassItem(name=str(i), mass=rng.random(), position=rng.normal(size=3)) for i in range(6)]
    whole = mass_properties(items)
    shuffled = mass_properties(items[::-1])
    part = mass_properties(items[:3])
    grouped = mass_properties(
        [MassItem(name="part", mass=part.mass, position=part.cg, inertia=part.inertia), *items[3:]]
    )
    for other in (shuffled, grouped):
        np.testing.assert_allclose(other.inertia, whole.inertia, atol=1e-12)
        np.testing.assert_allclose(other.cg, whole.cg, atol=1e-12)


def test_mirrored_item_has_no_lateral_products():
    item = MassItem(name="engine", mass=2.0, position=[1.0, 3.0, -0.5], mirrored=True)
    both = mass_properties([item])
    assert both.mass == 4.0
    np.testing.assert_allclose(both.inertia[[0, 1], [1, 2]], 0.0, atol=IDENTITY)
    assert both.inertia[2, 2] == pytest.approx(36.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"chord": 0.0}, r"chord must be > 0 \[m\]"),
        ({"chord": -1.0}, r"chord must be > 0 \[m\]"),
        ({"y": np.nan}, "y must be finite"),
        ({"twist": 2.0}, "twist"),
    ],
)
def test_bad_sections_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        WingSection(**({"y": 0.0, "chord": 1.0} | change))


def surface(points, **options):
    return LiftingSurface(name="w", sections=tuple(WingSection(y=y, z_le=z, chord=1.0) for y, z in points), **options)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([(0, 0)], "two or more"),
        ([(0, 0), (0, 0)], "one span station"),
        ([(0, 0), (2, 0), (1, 0)], "crosses itself"),
        ([(0, 0), (2, 0), (2, 1), (1, -1)], "crosses itself"),
        ([(-1, 0), (2, 0)], "cross"),
        ([(0, 0), (0, 1)], "mirrored = false"),
    ],
)
def test_planforms_that_cross_themselves_are_refused(points, message):
    with pytest.raises(ValueError, match=message):
        surface(points)


def test_winglets_and_closed_tips_are_allowed():
    surface([(0, 0), (2, 0), (2, 1)])
    surface([(0, 0), (2, 0), (2, 1), (0.5, 1)])


def control(**change):
    return ControlSurface(
        **({"name": "a", "span_from": 0.5, "span_to": 1.0, "hinge_from": 0.75, "hinge_to": 0.75} | change)
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"span_to": 1.2}, "lies on the wing"),
        ({"span_from": -0.1}, "lies on the wing"),
        ({"span_from": 0.9, "span_to": 0.9}, "span_from < span_to"),
        ({"hinge_from": 1.0}, r"hinge_from must lie in \[0, 1\)"),
        ({"kind": "slotted"}, "kind"),
        ({"reading": "angle"}, "reading"),
    ],
)
def test_bad_controls_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        control(**change)


def test_overlapping_controls_are_refused():
    with pytest.raises(ValueError, match="overlap"):
        surface([(0, 0), (1, 0)], controls=(control(), control(name="b", span_from=0.2, span_to=0.6)))
    with pytest.raises(ValueError, match="names must differ"):
        surface([(0, 0), (1, 0)], controls=(control(), control(span_from=0.2, span_to=0.3)))
    surface([(0, 0), (1, 0)], controls=(control(), control(name="b", span_from=0.2, span_to=0.5)))


def test_bad_masses_are_refused():
    with pytest.raises(ValueError, match=r">= 0 \[kg\]"):
        MassItem(name="x", mass=-1.0, position=[0, 0, 0])
    with pytest.raises(ValueError, match="symmetric"):
        MassItem(name="x", mass=1.0, position=[0, 0, 0], inertia=np.triu(np.ones((3, 3))))
    with pytest.raises(ValueError, match="negative principal"):
        MassItem(name="x", mass=1.0, position=[0, 0, 0], inertia=-np.eye(3))
    with pytest.raises(ValueError, match="total mass"):
        mass_properties([])
    with pytest.raises(ValueError, match="three finite"):
        MassItem(name="x", mass=1.0, position=[0, 0])
