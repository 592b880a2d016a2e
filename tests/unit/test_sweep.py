"""Sweeps over numbers of a file: boundaries without names, altitude, damping surfaces and their figures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.flutter import PK, G, K, Method, P, flutter
from aeroservo.aeroelastic.onset import onset
from aeroservo.aircraft.file_errors import ModelFileError
from aeroservo.aircraft.files import read
from aeroservo.datatypes import FlightCondition
from aeroservo.report.figures import as_bytes
from aeroservo.report.surfaces import surface_figure
from aeroservo.report.tornado import tornado_figure
from aeroservo.studies.boundary import Over, flutter_boundary
from aeroservo.studies.surface import damping_surface

SWEEP = FlightCondition.at(0.0, V=np.linspace(20.0, 90.0, 15))
ALTITUDES = Over(field="altitude_m", values=(0.0, 4000.0, 8000.0))
STIFFNESS = Over(field="wing.pitch_stiffness_N_m", values=(300.0, 500.0))


@pytest.mark.parametrize(("method", "aero"), [(P(), None), (PK(), "theodorsen"), (K(), "theodorsen"), (G(), "jones")])
def test_onset_is_flutter(method: Method, aero: str | None) -> None:
    """The same numbers to the last digit, in range, above the range of speeds, and unstable from the start."""
    model = build(read("thesis-binary"), aero)
    for low, high in ((20.0, 120.0), (5.0, 20.0), (95.0, 120.0)):
        sweep = FlightCondition(V=np.linspace(low, high, 9), rho=1.225)
        found, whole = onset(model, sweep, method), flutter(model, sweep, method)
        assert found.found == whole.found
        assert found.flutter_speed == whole.flutter_speed
        assert found.flutter_frequency == whole.flutter_frequency
        assert found.divergence_speed == whole.divergence_speed


def test_boundary_without_names() -> None:
    """Two fields, one of them the altitude: the speeds with names, and single runs."""
    file = read("thesis-binary")
    over = (ALTITUDES, STIFFNESS)
    quick, named = (flutter_boundary(file, over, SWEEP, P(), names=names) for names in (False, True))
    assert [replace(point, flutter_mode=None) for point in named] == list(quick)
    assert {point.flutter_mode for point in named if point.flutter_speed is not None} == {"torsion 1"}
    assert [point.values for point in quick] == [(h, k) for h in ALTITUDES.values for k in STIFFNESS.values]
    alone = flutter_boundary(file, (ALTITUDES,), SWEEP, P(), names=False)
    for point in alone:
        sweep = FlightCondition.at(point.values[0], V=SWEEP.V)
        assert point.flutter_speed == flutter(build(file), sweep, P()).flutter_speed


def test_journal_tells_names_apart(tmp_path: Path) -> None:
    """A journal with names is not taken over by a sweep without."""
    journal = tmp_path / "x.part"
    file = read("thesis-binary")
    flutter_boundary(file, (STIFFNESS,), SWEEP, P(), journal=journal)
    with pytest.raises(ValueError, match="another sweep"):
        flutter_boundary(file, (STIFFNESS,), SWEEP, P(), journal=journal, names=False)


@pytest.mark.parametrize("over", [ALTITUDES, STIFFNESS])
def test_damping_surface(over: Over) -> None:
    """Rows are single runs; damping changes sign at the flutter speed; progress counts to the end."""
    done = []
    found = damping_surface(read("thesis-binary"), over, SWEEP, P(), progress=lambda i, n: done.append((i, n)))
    count = len(over.values)
    assert done == [(i + 1, count) for i in range(count)]
    assert found.names == ("bending 1", "torsion 1")
    assert found.damping_ratio.shape == found.frequency.shape == (count, SWEEP.V.size, 2)
    torsion = found.damping_ratio[..., 1]
    for row, V in zip(torsion, found.flutter_speed):
        assert np.all(row[SWEEP.V < V] > 0.0)
        assert np.all(row[SWEEP.V > V] < 0.0)
    figure = surface_figure(found, "binary $ wing")
    assert as_bytes(figure, ".png").startswith(b"\x89PNG")
    assert figure.axes[0].get_ylabel() == over.field
    assert len(figure.axes) == 3  # two modes and the scale


def test_surface_of_one_value() -> None:
    """One row has no contours, and a mode may be chosen."""
    over = replace(STIFFNESS, values=(400.0,))
    found = damping_surface(read("thesis-binary"), over, SWEEP, P())
    figure = surface_figure(found, "one", modes=("torsion 1",))
    assert len(figure.axes) == 1


def test_tornado_without_speeds() -> None:
    """Nothing in the range: a chart that says so."""
    figure = tornado_figure((), "nothing")
    assert "no flutter speed" in figure.axes[0].texts[0].get_text()


def test_refusals() -> None:
    """Unknown field, altitude out of the atmosphere, k method."""
    file = read("thesis-binary")
    with pytest.raises(ModelFileError, match="pitch_stiffness_N_m"):
        damping_surface(file, Over(field="wing.pitch", values=(1.0, 2.0)), SWEEP, P())
    with pytest.raises(ValueError, match="altitude"):
        damping_surface(file, replace(ALTITUDES, values=(0.0, 9e5)), SWEEP, P())
    with pytest.raises(ValueError, match="instead of the k method"):
        damping_surface(file, STIFFNESS, SWEEP, K())
