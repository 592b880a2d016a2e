"""Figures: what they show is in the result, every axis says what and in which unit, nothing covers anything."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.flutter import FlutterResult, K, P, flutter
from aeroservo.aeroelastic.static import StaticResult, static
from aeroservo.aircraft.files import read
from aeroservo.datatypes import FlightCondition
from aeroservo.report.figures import (
    as_bytes,
    modes_figure,
    plot_flutter,
    plot_static,
    shown_branches,
    static_figure,
    write_figure,
)
from aeroservo.report.style import style
from aeroservo.structure.modal import natural_modes

DRAWN = 1e-9  # a curve is drawn from the same floats that it is compared with


def sweep(first: float, last: float, step: float = 5.0) -> FlightCondition:
    """Speeds at sea level."""
    return FlightCondition.at(0.0, V=np.arange(first, last, step))


@pytest.fixture(scope="module")
def aircraft() -> FlutterResult:
    """Flutter, then two real roots, and Mach 0.3 inside the range."""
    return flutter(build(read("thesis-aircraft")), sweep(2.0, 130.0, 2.0), P())


@pytest.fixture(scope="module")
def calm() -> FlutterResult:
    """No instability in the range, none marked."""
    return flutter(build(read("thesis-binary")), sweep(2.0, 30.0), P())


@pytest.fixture(scope="module")
def wing_static() -> StaticResult:
    """Divergence and reversal inside the range."""
    return static(build(read("thesis-binary")), sweep(2.0, 100.0, 1.0))


def labels(figure: Figure) -> list[str]:
    """Entries of the one legend."""
    (legend,) = figure.legends
    return [text.get_text() for text in legend.get_texts()]


def upright(ax: object) -> dict[str, float]:
    """Marked speeds of a panel by the first word of their label."""
    lines = [x for x in ax.get_lines() if len(set(x.get_xdata())) == 1 and len(x.get_xdata()) == 2]  # type: ignore[attr-defined]
    return {str(x.get_label()).split()[0]: float(x.get_xdata()[0]) for x in lines}


def overlaps(figure: Figure) -> list[str]:
    """Texts and legends that lie on each other, or panels that do."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    boxes = [(f"panel {i}", ax.get_tightbbox(renderer)) for i, ax in enumerate(figure.axes)]
    boxes += [("legend", legend.get_window_extent(renderer)) for legend in figure.legends]
    if figure._suptitle is not None:  # type: ignore[attr-defined]
        boxes.append(("title", figure._suptitle.get_window_extent(renderer)))  # type: ignore[attr-defined]
    found = []
    for i, (name, box) in enumerate(boxes):
        found += [f"{name} on {other}" for other, its in boxes[:i] if box.padded(-1.0).overlaps(its.padded(-1.0))]
        if not (box.x0 >= -1 and box.y0 >= -1 and box.x1 <= figure.bbox.width + 1 and box.y1 <= figure.bbox.height + 1):
            found.append(f"{name} leaves the figure")
    return found


def test_flutter_figure_marks_what_was_found(aircraft: FlutterResult) -> None:
    figure = plot_flutter(aircraft, title="whole aircraft")
    for ax in figure.axes[:2]:
        marked = upright(ax)
        assert marked["flutter"] == aircraft.flutter_speed
        assert marked["divergence"] == aircraft.divergence_speed
        assert marked["Mach"] == pytest.approx(0.3 * float(aircraft.condition.a_sound[0]))
        spans = [patch.get_extents().transformed(ax.transData.inverted()) for patch in ax.patches]
        wanted = [(i.start, 128.0 if i.end is None else i.end) for i in aircraft.intervals]
        np.testing.assert_allclose([(box.x0, box.x1) for box in spans], wanted, rtol=1e-9)
    assert "flutter 48.17 m/s" in labels(figure)
    assert overlaps(figure) == []


def test_each_axis_says_quantity_unit_and_sign(aircraft: FlutterResult) -> None:
    frequency, damping, locus = plot_flutter(aircraft).axes
    assert frequency.get_ylabel() == "frequency, Hz"
    assert frequency.get_xlabel() == damping.get_xlabel() == "true airspeed V, m/s"
    assert "positive: stable" in damping.get_ylabel()
    (right,) = damping.child_axes
    assert "thesis" in right.get_ylabel()
    assert "% (positive: flutter)" in right.get_ylabel()
    assert "1/s (positive: unstable)" in locus.get_xlabel()
    assert "rad/s" in locus.get_ylabel()


def test_the_two_damping_scales_have_opposite_signs(aircraft: FlutterResult) -> None:
    """zeta = 0.1 is stable and stands at -10 % of the thesis' scale."""
    figure = plot_flutter(aircraft)
    FigureCanvasAgg(figure).draw()
    damping = figure.axes[1]
    right = damping.child_axes[0]
    for zeta in (0.1, 0.0, -0.5):
        height = damping.transData.transform((0.0, zeta))[1]
        assert right.transData.transform((0.0, -100.0 * zeta))[1] == pytest.approx(height, abs=1e-6)
    torsion = aircraft.names.index("torsion 1")
    line = next(x for x in damping.get_lines() if x.get_label() == "torsion 1")
    past = np.flatnonzero(aircraft.flutter_speed < aircraft.V)
    np.testing.assert_allclose(line.get_ydata(), aircraft.damping_ratio[:, torsion], rtol=DRAWN)
    assert np.all(np.asarray(line.get_ydata())[past] < 0.0)


def test_nothing_found_marks_nothing(calm: FlutterResult) -> None:
    figure = plot_flutter(calm)
    assert [upright(ax) for ax in figure.axes[:2]] == [{}, {}]
    assert not any(ax.patches for ax in figure.axes)
    assert labels(figure) == ["bending 1", "torsion 1"]
    low, high = figure.axes[1].get_ylim()
    assert low < 0.0 < high
    assert overlaps(figure) == []


def test_branches_of_nan(calm: FlutterResult) -> None:
    """A branch that exists nowhere, or none at all, still gives a figure that says so."""
    roots = np.array(calm.roots)
    roots[:, 0] = np.nan
    assert as_bytes(plot_flutter(replace(calm, roots=roots)), ".png").startswith(b"\x89PNG")
    empty = plot_flutter(replace(calm, roots=np.full_like(roots, np.nan)))
    said = [text.get_text() for ax in empty.axes for text in ax.texts]
    assert said == ["no mode has a root in this range"] * 3
    assert overlaps(empty) == []


def test_a_root_locus_has_no_line_between_a_pair_and_real_roots(aircraft: FlutterResult) -> None:
    locus = plot_flutter(aircraft).axes[2]
    line = next(x for x in locus.get_lines() if x.get_label() == "torsion 1")
    x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    both = np.isfinite(x[1:] + x[:-1])
    assert np.isnan(x).sum() == 1
    assert not np.any(both & ((y[1:] > 0.0) != (y[:-1] > 0.0)))
    cross = next(x for x in locus.get_lines() if x.get_label() == "flutter begins")
    assert cross.get_ydata()[0] == aircraft.flutter_frequency


def test_high_stable_modes_are_left_out_and_counted() -> None:
    """Ten modes of Goland's wing: five lowest are drawn, the others counted."""
    found = flutter(build(read("goland")), sweep(20.0, 200.0, 20.0), K())
    hidden = len(found.names) - len(shown_branches(found))
    assert hidden > 0
    figure = plot_flutter(found)
    assert figure.axes[0].get_title() == f"{hidden} higher modes, stable throughout, not drawn"
    unstable = {interval.mode for interval in found.intervals}
    assert unstable <= set(labels(figure))
    assert overlaps(figure) == []


def test_given_axes_are_drawn_into(calm: FlutterResult) -> None:
    figure = Figure()
    axes = list(figure.subplots(1, 2))
    assert plot_flutter(calm, axes) is figure
    assert figure.axes == axes
    assert not figure.legends
    with pytest.raises(ValueError, match="axes must be two or three, got 1"):
        plot_flutter(calm, axes[:1])
    with pytest.raises(ValueError, match="axes must be three, got 2"):
        plot_static(static(build(read("thesis-binary")), sweep(2.0, 20.0)), axes)


def test_statics(wing_static: StaticResult) -> None:
    figure = static_figure(wing_static, "statics", a_sound=300.0)
    twist, effectiveness, slope = figure.axes
    for ax in figure.axes:
        marked = upright(ax)
        assert marked["divergence"] == wing_static.divergence.V
        assert marked["reversal"] == wing_static.reversal.V
        assert marked["Mach"] == 90.0
        assert ax.get_xlabel() == "true airspeed V, m/s"
    assert "rad/rad" in twist.get_ylabel()
    assert "roll rate per elevon angle" in effectiveness.get_ylabel()
    assert slope.get_ylim()[1] < 7.0  # the pole at divergence is cut
    assert "reversal of roll 55.00 m/s" in labels(figure)
    assert overlaps(figure) == []
    assert "Mach" not in " ".join(labels(static_figure(wing_static, "statics")))


def test_statics_without_a_control_or_below_nothing() -> None:
    goland = plot_static(static(build(read("goland")), sweep(10.0, 200.0, 10.0)))
    assert [text.get_text() for ax in goland.axes for text in ax.texts] == ["this model has no control surface"]
    past = plot_static(static(build(read("thesis-binary")), sweep(90.0, 120.0)))
    assert [text.get_text() for ax in past.axes for text in ax.texts] == ["every speed is past divergence"] * 3


@pytest.mark.parametrize(("name", "panels"), [("goland", 2), ("thesis-aircraft", 2), ("nasa-typical-section", 1)])
def test_modes(name: str, panels: int) -> None:
    modes = build(read(name)).modes
    natural = natural_modes(modes)
    figure = modes_figure(modes, natural, name)
    assert len(figure.axes) == panels
    shown = min(5, len(natural.omega))
    assert labels(figure) == [f"{natural.names[j]}, {natural.omega[j] / 2 / np.pi:.4g} Hz" for j in range(shown)]
    assert all(ax.get_ylabel() for ax in figure.axes)
    assert overlaps(figure) == []


def bars() -> Figure:
    """A figure that is quick to draw."""
    modes = build(read("nasa-typical-section")).modes
    return modes_figure(modes, natural_modes(modes), "bars")


@pytest.mark.parametrize(("ending", "magic"), [(".png", b"\x89PNG"), (".pdf", b"%PDF"), (".PNG", b"\x89PNG")])
def test_files(tmp_path: Path, ending: str, magic: bytes) -> None:
    """Written whole; the same figure twice gives the same bytes; the figure keeps its resolution."""
    path = tmp_path / f"x{ending}"
    figure = bars()
    dpi = figure.dpi
    write_figure(figure, path)
    assert path.read_bytes().startswith(magic)
    assert path.read_bytes() == as_bytes(bars(), ending)
    assert figure.dpi == dpi
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_files_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"\.png or \.pdf, got '\.svg'"):
        write_figure(bars(), tmp_path / "x.svg")
    with pytest.raises(OSError, match="No such file"):
        write_figure(bars(), tmp_path / "nowhere" / "x.png")
    assert not list(tmp_path.iterdir())


def test_no_two_curves_look_alike() -> None:
    looks = [(style(j)["color"], str(style(j)["linestyle"])) for j in range(30)]
    assert len(set(looks)) == 30


def test_no_screen_is_needed() -> None:
    """Neither pyplot nor a backend with windows is loaded."""
    code = (
        "import sys; from aeroservo.report import figures, thesis_drawings; "
        "print('matplotlib.pyplot' in sys.modules, 'matplotlib' in sys.modules)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert run.stdout.split() == ["False", "False"]
