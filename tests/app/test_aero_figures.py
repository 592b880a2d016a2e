"""Figures of steady aerodynamics: curves are the result's numbers, every axis has a name, nothing hides a mark."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from aeroservo.aero.polars import INSIDE, Polar, best_lift_to_drag
from aeroservo.aero.polars_points import shipped_polar
from aeroservo.aero.vlm import VortexLattice
from aeroservo.aeroelastic.aircraft_lattice import AircraftLattice, aircraft_lattice
from aeroservo.aircraft.avl import parse_avl
from aeroservo.aircraft.files import read
from aeroservo.report.aero_figures import (
    section_polar_figure,
    span_loading_figure,
    trim_figure,
    wing_polar_figure,
)
from aeroservo.report.planform import planform_figure
from aeroservo.report.style import as_bytes
from aeroservo.studies.aero_views import WingCase
from aeroservo.studies.aircraft_aero import inputs_at_lift, read_aircraft
from aeroservo.studies.section_polar import resampled

DRAWN = 1e-9  # a curve is drawn from the same floats that it is compared with
ALPHA = np.radians(np.arange(-6.0, 14.1, 1.0))
DELTA = np.radians([-5.0, 0.0, 5.0])


@pytest.fixture(scope="module")
def polar() -> Polar:
    """The shipped table on a coarser grid, as the command gives it."""
    return resampled(shipped_polar("mh62", "hinged"), ALPHA, np.radians([-10.0, 0, 10, 15]), np.array([1e6, 2e6]))


@pytest.fixture(scope="module")
def case() -> WingCase:
    """The thesis' wing at 30 m/s on a coarse lattice."""
    return WingCase(
        model=read_aircraft("thesis-uav"),
        alpha=ALPHA,
        delta=DELTA,
        speed=30.0,
        viscosity=1.4607e-5,
        method=VortexLattice(chordwise=6, spanwise=16),
    )


@pytest.fixture(scope="module")
def found(case: WingCase) -> AircraftLattice:
    """Its lattice."""
    return aircraft_lattice(case.model.surfaces(), case.model.references(), method=case.method)


def is_drawn(ax: object, y: Sequence[float] | np.ndarray, x: Sequence[float] | np.ndarray) -> bool:
    """Whether one of the axes' curves goes through these points and no others."""
    for line in ax.lines:  # type: ignore[attr-defined]
        u, v = (np.asarray(a, dtype=float) for a in line.get_data())
        if (
            u.shape == np.shape(x)
            and np.allclose(u, x, atol=DRAWN, equal_nan=True)
            and np.allclose(v, y, atol=DRAWN, rtol=DRAWN, equal_nan=True)
        ):
            return True
    return False


def check(figure: Figure) -> bytes:
    """Every shown panel has names on both axes, no text leaves the page or lies over another panel's text."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    page = figure.bbox
    for ax in figure.axes:
        if not ax.axison or not ax.lines:
            continue
        for label in (ax.xaxis.label, ax.yaxis.label):
            if label.get_text():
                box = label.get_window_extent()
                assert box.x0 >= page.x0 - 1 and box.x1 <= page.x1 + 1, label.get_text()
                assert box.y0 >= page.y0 - 1 and box.y1 <= page.y1 + 1, label.get_text()
    texts = [t.get_text() for ax in figure.axes for t in (ax.xaxis.label, ax.yaxis.label)]
    assert any(texts)
    return as_bytes(figure, ".png")


def test_section_polars(polar: Polar) -> None:
    """Lift, moment and L/D over alpha; figure 21's best L/D against deflection for each Reynolds number."""
    figure = section_polar_figure(polar, "MH 62")
    check(figure)
    lift, drag, moment, ratio, best, moment_at_best = figure.axes
    degrees = np.degrees(polar.alpha)
    for j in range(len(polar.delta)):
        assert is_drawn(lift, polar.CL[1, j], degrees)
        assert is_drawn(drag, polar.CL[1, j], polar.CD[1, j])
        assert is_drawn(moment, polar.CM[1, j], degrees)
        assert is_drawn(ratio, polar.CL[1, j] / polar.CD[1, j], degrees)
    for re in polar.reynolds:
        values = [best_lift_to_drag(polar, reynolds=re, delta=d)[0] for d in polar.delta]
        assert is_drawn(best, values, np.degrees(polar.delta))
        assert values[-2] > values[0] and values[-2] > values[1]  # the thesis' claim, and
        assert values[-1] > values[-2]  # what lies beyond it
    assert len(moment_at_best.lines) == len(polar.reynolds)
    assert "Re 2 million" in lift.get_title()


def test_a_gap_in_the_table_is_a_gap_in_the_curve(polar: Polar) -> None:
    """NaN is not bridged, and a sweep without a point has no best L/D."""
    hole = np.array(polar.CL)
    hole[:, 0, :] = np.nan
    fields = {k: getattr(polar, k) for k in ("name", "source", "alpha", "delta", "reynolds", "CD", "CM")}
    figure = section_polar_figure(Polar(CL=hole, **fields), "gap")
    check(figure)
    best = figure.axes[4].lines[0].get_ydata()
    assert np.isnan(best[0]) and np.all(np.isfinite(best[1:]))


def test_wing_polars_side_by_side(case: WingCase) -> None:
    """Hinged beside morphed with equal scales, viscous and inviscid, stalled or outside strips marked."""
    groups = case.both_kinds()
    figure = wing_polar_figure(case.alpha, groups, "thesis-uav")
    check(figure)
    axes = np.array(figure.axes).reshape(4, 2)
    degrees = np.degrees(case.alpha)
    for column, (name, _, polars) in enumerate(groups):
        assert axes[0, column].get_title() == name
        for p in polars:
            assert is_drawn(axes[0, column], p.CL, degrees)
            assert is_drawn(axes[1, column], p.CD, degrees)
            assert is_drawn(axes[1, column], p.CD_induced, degrees)
            assert is_drawn(axes[2, column], p.CM_viscous, degrees)
            assert is_drawn(axes[2, column], p.CM, degrees)
            assert is_drawn(axes[3, column], p.lift_to_drag, degrees)
            if p.stalled.any():
                assert is_drawn(axes[0, column], p.CL[p.stalled], degrees[p.stalled])
    assert any(p.stalled.any() for _, _, polars in groups for p in polars)
    for row in axes:
        assert row[0].get_ylim() == row[1].get_ylim()
    top = max(np.nanmax(p.lift_to_drag) for _, _, polars in groups for p in polars)
    assert axes[3, 0].get_ylim()[1] > top
    assert not np.array_equal(groups[0][2][0].CL, groups[1][2][0].CL)


def test_span_loading_carries_the_lift(found: AircraftLattice) -> None:
    """Every state has the same lift, and its elliptic load too, drawn once."""
    states = [(f"{d:g}", inputs_at_lift(found, 0.3, np.radians(d))) for d in (-5.0, 0.0, 5.0)]
    figure = span_loading_figure(found, states, "loading")
    check(figure)
    left, right = figure.axes
    grid = found.solution.lattice
    curves = [line for line in left.lines if len(line.get_xdata()) == len(grid.strip_chord)]
    assert len(curves) == 4  # three states and one ellipse
    order = np.argsort(grid.strip_edge[:, 1])
    width = grid.strip_width[order]
    for line in curves:
        mean = np.sum(np.asarray(line.get_ydata()) * width) / np.sum(width)
        assert mean == pytest.approx(0.3, rel=2e-3)
    assert len([line for line in right.lines if len(line.get_xdata()) == len(order)]) == 3


def test_trim_against_the_centre_of_gravity(case: WingCase, found: AircraftLattice) -> None:
    """L/D and deflection over the static margin; what cannot be trimmed inside the polars is a gap, not a number."""
    trims = case.trims(0.3)
    figure = trim_figure(trims, "trim", neutral_point=found.derivatives.neutral_point, x_cg=0.36)
    check(figure)
    above, below = figure.axes[:2]
    for _, trim in trims:
        margin = 100.0 * trim.static_margin
        assert is_drawn(above, trim.polar.lift_to_drag, margin)
        assert is_drawn(below, np.degrees(trim.delta), margin)
        kept = np.isfinite(trim.delta)
        assert kept.sum() > 20
        assert np.all(np.diff(trim.delta[kept]) < 0.0)  # forward centre of gravity: elevon up
        np.testing.assert_allclose(trim.polar.CL[kept], 0.3, atol=1e-9)
        assert np.all(trim.polar.mark[kept] == INSIDE)
    hinged = dict(trims)["hinged"]
    at = dict(zip(np.round(hinged.static_margin, 3), hinged.polar.lift_to_drag))
    assert at[-0.02] > at[0.05] > at[0.10]  # stability costs: the thesis' figure 4 in numbers
    FigureCanvasAgg(figure).draw()
    labels = [t for t in above.child_axes[0].get_xticklabels() if t.get_text()]
    places = [t.get_window_extent().x0 for t in sorted(labels, key=lambda t: float(t.get_text()))]
    assert len(places) > 3 and np.all(np.diff(places) < 0.0)  # margin to the right: centre of gravity forward


def test_trim_outside_the_polars_is_nan_on_a_half_lattice(case: WingCase) -> None:
    """A lift that no deflection of the table trims gives NaN, not an error about symmetry."""
    hinged = dict(case.trims(0.9))["hinged"]
    assert np.isnan(hinged.delta).any()
    assert np.all(np.isnan(hinged.polar.CL) == np.isnan(hinged.delta))


PLANE = """Plane
0.0
0 0 0
12 1.2 10
0.4 0 0.1
SURFACE
Wing
8 16
YDUPLICATE
0
SECTION
0 0 0 1.5 2
CONTROL
flap 1 0.75 0 0 0 1
SECTION
0.2 2.5 0.2 1.2 1
CONTROL
flap 1 0.75 0 0 0 1
SECTION
0.5 5 0.5 0.8 0
SURFACE
Fin
6 8
SECTION
4.8 0 0.3 1.0 0
SECTION
5.3 0 1.5 0.6 0
"""


def test_three_views_of_the_thesis_wing() -> None:
    """Outline, elevons on both sides behind their hinge, mean chord, centre of gravity and reference point."""
    model = read_aircraft("thesis-uav")
    figure = planform_figure(model, "thesis-uav")
    check(figure)
    above, facts, front, side = figure.axes
    assert is_drawn(above, [0.0, 0.524475, 0.824475, 0.7], [0.0, 1.0, 1.0, 0.0])
    assert is_drawn(above, [0.0, 0.524475, 0.824475, 0.7], [0.0, -1.0, -1.0, 0.0])
    corners = [p.get_xy() for p in above.patches if str(p.get_label()).startswith("elevon")]
    assert len(corners) == 2
    for sign, points in zip((1.0, -1.0), corners):
        assert np.all((sign * points[:, 0] >= 0.5 - 1e-9) & (sign * points[:, 0] <= 1.0 + 1e-9))
        assert points[:, 1].min() == pytest.approx(0.2622375 + 0.75 * 0.5, abs=1e-9)
    assert is_drawn(above, [model.masses().cg[0]], [0.0]) and is_drawn(above, [model.references().x], [0.0])
    assert is_drawn(side, [0.0], [model.masses().cg[0]])
    words = " ".join(t.get_text() for t in facts.texts)
    assert "0.5267 m" in words and "0.4286" in words and "10 kg" in words
    ends = np.concatenate([p.get_xy() for p in front.patches])
    assert ends[:, 1].max() == pytest.approx(0.3 * np.tan(np.radians(5.0)), abs=1e-9)  # washout lifts the trailing edge


def test_three_views_of_a_plane_with_a_fin() -> None:
    """Several surfaces, dihedral, an upright fin, no masses: each where the file puts it."""
    figure = planform_figure(parse_avl(PLANE).model, "plane")
    check(figure)
    above, facts, front, side = figure.axes
    assert max(np.max(p.get_xy()[:, 1]) for p in side.patches) == pytest.approx(1.5)
    assert max(np.max(np.abs(p.get_xy()[:, 0])) for p in front.patches) == pytest.approx(5.0)
    assert sum(str(p.get_label()).startswith("flap") for p in above.patches) == 2
    assert "mass" not in [t.get_text() for t in facts.texts]
    assert above.yaxis_inverted()


def test_same_figure_same_bytes(polar: Polar) -> None:
    """A figure depends on its result alone."""
    assert as_bytes(section_polar_figure(polar, "x"), ".png") == as_bytes(section_polar_figure(polar, "x"), ".png")
    model = read("thesis-uav")
    assert as_bytes(planform_figure(model, "x"), ".pdf") == as_bytes(planform_figure(model, "x"), ".pdf")
