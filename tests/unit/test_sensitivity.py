"""Derivatives of speeds by adjoints against differences of the speeds themselves, to 1e-5 and far better."""

from __future__ import annotations

import numpy as np
import pytest

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.flutter import PK, K, Method, P, flutter
from aeroservo.aeroelastic.sensitivity import Sensitivity, sensitivities
from aeroservo.aeroelastic.static import divergence, reversal
from aeroservo.aircraft.file_errors import ModelFileError
from aeroservo.aircraft.files import read
from aeroservo.aircraft.overrides import override
from aeroservo.aircraft.schema_base import FileModel
from aeroservo.datatypes import FlightCondition

#: Asked for by the issue.
ASKED = 1e-5
#: Differences of speeds of order 50 m/s known to 1e-13 over steps of 1e-3.
NOTHING = 1e-8

BINARY = FlightCondition(V=np.linspace(40.0, 60.0, 5), rho=1.225)
GOLAND = FlightCondition(V=np.linspace(130.0, 145.0, 3), rho=1.225)


def speeds(file: FileModel, sweep: FlightCondition, method: Method) -> list[float | None]:
    """Flutter, divergence, reversal."""
    model = build(file)
    return [flutter(model, sweep, method).flutter_speed, divergence(model, sweep[0]).V, reversal(model, sweep[0])[1].V]


def check(file: FileModel, found: Sensitivity, sweep: FlightCondition, method: Method) -> None:
    """Central differences of fourth order of each speed."""
    step = 1e-3 * (abs(found.value) or 1.0)
    rows = [speeds(override(file, {found.field: found.value + x * step}), sweep, method) for x in (-2, -1, 1, 2)]
    base = speeds(file, sweep, method)
    for name, V, column in zip(("flutter", "divergence", "reversal"), base, zip(*rows)):
        slope, relative = getattr(found, f"dV_{name}"), getattr(found, f"relative_{name}")
        if V is None:
            assert (slope, relative) == (None, None)
            continue
        wanted = float(np.dot([1.0, -8.0, 8.0, -1.0], column)) / (12.0 * step)
        assert slope == pytest.approx(wanted, rel=ASKED, abs=NOTHING * V / (abs(found.value) or 1.0))
        assert relative == pytest.approx(wanted * found.value / V, rel=ASKED, abs=NOTHING)


def test_every_number_of_the_binary_wing() -> None:
    """Structural, inertial, aerodynamic and of the control: all that can be varied both ways."""
    file = read("thesis-binary")
    found = {one.field: one for one in sensitivities(file, BINARY, P())}
    assert len(found) == 13
    for field, one in found.items():
        if field != "wing.leading_edge_mass_kg_per_m":  # at its limit: tested below
            check(file, one, BINARY, P())


def test_a_number_at_its_limit_is_varied_inwards() -> None:
    """A leading-edge mass of 0 may not be negative: one-sided differences."""
    file = read("thesis-binary")
    (found,) = sensitivities(file, BINARY, P(), fields=("wing.leading_edge_mass_kg_per_m",))
    V = [speeds(override(file, {found.field: m}), BINARY, P())[0] for m in (0.0, 1e-3, 2e-3, 3e-3, 4e-3)]
    wanted = float(np.dot([-25.0, 48.0, -36.0, 16.0, -3.0], V)) / 12e-3
    assert found.dV_flutter == pytest.approx(wanted, rel=ASKED)
    assert found.relative_flutter == 0.0


def test_numbers_of_the_goland_wing() -> None:
    """Natural modes change with the number and turn; flutter on samples by p-k."""
    file = read("goland")
    fields = ("wing.station[1].GJ_N_m2", "wing.station[0].cg_axis", "wing.station[1].chord_m")
    for one in sensitivities(file, GOLAND, PK(), fields=fields):
        check(file, one, GOLAND, PK())


def test_known_exponents() -> None:
    """V scales with the root of all stiffnesses and of 1/rho: the relative derivatives of EI and GJ add up to 1/2."""
    file = read("goland")
    fields = tuple(f"wing.station[{i}].{name}" for i in (0, 1) for name in ("EI_N_m2", "GJ_N_m2"))
    found = sensitivities(file, GOLAND, K(), fields=fields)
    assert sum(one.relative_divergence or 0.0 for one in found) == pytest.approx(0.5, rel=1e-8)
    assert sum(one.relative_flutter or 0.0 for one in found) == pytest.approx(0.5, rel=1e-6)
    heavier = tuple(f"wing.station[{i}].{name}" for i in (0, 1) for name in ("mass_kg_per_m", "inertia_kg_m"))
    assert all(abs(one.relative_divergence or 0.0) < 1e-12 for one in sensitivities(file, GOLAND, K(), fields=heavier))


def test_close_frequencies() -> None:
    """Where two natural frequencies almost meet, modes turn into each other; the derivative takes no notice."""
    file = override(read("goland"), {f"wing.station[{i}].cg_axis": 0.33 for i in (0, 1)})
    meeting = 9.773e6 * (93.0 / 50.0) ** 2  # bending 1 near torsion 1, uncoupled: they cross freely
    file = override(file, {f"wing.station[{i}].EI_N_m2": meeting for i in (0, 1)})
    sweep = FlightCondition(V=np.linspace(100.0, 400.0, 4), rho=1.225)
    (found,) = sensitivities(file, sweep, fields=("wing.station[1].EI_N_m2",))
    check(file, found, sweep, PK())


def test_no_speed_no_derivative() -> None:
    """Nothing flutters in the range, nothing reverses: None, never NaN."""
    sweep = FlightCondition(V=[10.0, 20.0], rho=1.225)
    (found,) = sensitivities(read("goland"), sweep, fields=("wing.lift_slope_per_rad",))
    assert (found.dV_flutter, found.relative_flutter, found.dV_reversal) == (None, None, None)
    assert found.relative_divergence == pytest.approx(-0.5, rel=1e-9)


def test_unknown_field() -> None:
    """Named, with what there is."""
    with pytest.raises(ModelFileError, match=r"pitch_stiffness_N_m"):
        sensitivities(read("thesis-binary"), BINARY, P(), fields=("wing.pitch_stiffness",))
