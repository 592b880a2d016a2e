"""Trim and load redistribution of beam wings: closed form of the uniform wing, finite elements for the weight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.build_beam import slender_beam
from aeroservo.aeroelastic.closed_form import UniformWing, wing_twist
from aeroservo.aeroelastic.span_load import span_load
from aeroservo.aeroelastic.static import static
from aeroservo.aircraft.files import read, validate
from aeroservo.aircraft.overrides import override
from aeroservo.datatypes import AeroelasticModel, FlightCondition
from aeroservo.structure.beam_static import BeamLoad, static_deflection

#: Strains of finite elements against exact solutions.
TWO_ROUTES = 1e-7
WING = UniformWing(GJ=0.9876e6, eccentricity=0.08, chord=1.8288, semi_span=6.096, lift_slope=2.0 * np.pi)
SWEEP = FlightCondition(V=[60.0, 150.0, 240.0, 260.0], rho=1.225)
MASS, GRAVITY = 35.717 * 6.096, 9.80665


def swept(sweep_deg: float) -> AeroelasticModel:
    """The Goland wing, swept."""
    return build(override(read("goland"), {"wing.sweep_deg": sweep_deg}), "quasi_steady")


def test_unswept_wing_in_closed_form() -> None:
    """Lift a c q (alpha + theta), theta under incidence and under the torque m g d of the weight, which is a C_M0."""
    found = span_load(swept(0.0), SWEEP)
    for row, V in enumerate(SWEEP.V[:3]):
        q = 0.5 * 1.225 * V**2
        cm_weight = 35.717 * GRAVITY * 0.1 * 1.8288 / (q * 1.8288**2)
        theta = wing_twist(found.y, WING, q=q, incidence=found.incidence[row], cm0=cm_weight)
        lift = q * WING.chord * WING.lift_slope * (found.incidence[row] + theta)
        near = TWO_ROUTES * np.abs(lift).max()
        assert found.lift[row] == pytest.approx(lift, abs=near)
        assert found.torque[row] == pytest.approx(lift * 0.08 * 1.8288, abs=near)
        assert found.bending_moment[row] == pytest.approx(found.width @ (found.y * lift), rel=TWO_ROUTES)
        assert found.rigid_lift[row] == pytest.approx(MASS * GRAVITY / 6.096, rel=1e-12)
        assert found.rigid_bending_moment[row] == pytest.approx(MASS * GRAVITY * 3.048, rel=1e-9)
    assert np.all(np.isnan(found.lift[3]))
    assert np.isnan(found.incidence[3])


@pytest.mark.parametrize("sweep_deg", [-20.0, 0.0, 50.0])
def test_lift_is_the_weight(sweep_deg: float) -> None:
    """Elastic or not, at any load factor; under a fuselage load moves inboard where washout by bending,
    tan(Lambda) s^3 / (6 EI), outweighs the twist by lift, e c s^2 / (2 GJ): beyond 36 degrees here."""
    data = override(read("goland"), {"wing.sweep_deg": sweep_deg}).model_dump(exclude_unset=True)
    data["wing"]["mass"] = [{"y_m": 0.0, "x_m": 0.0, "mass_kg": 2000.0}]
    model = build(validate(data, "test"), "quasi_steady")
    sweep = FlightCondition(V=[40.0, 70.0], rho=1.225)
    for n in (1.0, 2.5):
        found = span_load(model, sweep, load_factor=n)
        for lift in (found.lift, found.rigid_lift):
            assert lift @ found.width == pytest.approx(np.full(2, n * (MASS + 2000.0) * GRAVITY), rel=1e-10)
    moved = found.bending_moment / found.rigid_bending_moment - 1.0
    assert np.all((moved > 0.0) == (sweep_deg <= 0.0))


def test_trim_of_static_is_the_same() -> None:
    """`static` gives the incidence and the tip twist of the same equilibrium; weight deflects the wing at no speed."""
    model = swept(25.0)
    found, result = span_load(model, SWEEP), static(model, SWEEP)
    assert result.trim_incidence == pytest.approx(found.incidence, rel=1e-12)
    slow = FlightCondition(V=[1e-3], rho=1.225)
    beam = slender_beam(override(read("goland"), {"wing.sweep_deg": 25.0}))  # type: ignore[arg-type]
    weight = BeamLoad(y=[0.0, 6.096], lift=-35.717 * GRAVITY, torque=35.717 * GRAVITY * 0.18288)
    lift = BeamLoad(y=[0.0, 6.096], lift=35.717 * GRAVITY, torque=35.717 * GRAVITY * 0.08 * 1.8288)
    tip = sum(static_deflection(beam, load, [6.096]).twist[0] for load in (weight, lift))
    assert static(model, slow).trim_twist[0] == pytest.approx(tip, rel=1e-6)


def test_stiff_wing_is_rigid() -> None:
    """A wing a million times stiffer carries the rigid load."""
    stiff = {f"wing.station[{i}].{name}_N_m2": 1e13 for i in (0, 1) for name in ("EI", "GJ")}
    found = span_load(build(override(read("goland"), stiff)), SWEEP)
    assert found.lift == pytest.approx(found.rigid_lift, rel=1e-5)


def test_refusals() -> None:
    """No strips, no mass, no row."""
    model = swept(0.0)
    assert model.statics is not None
    with pytest.raises(ValueError, match="strips, a mass"):
        span_load(replace(model, mass=None), SWEEP)
    with pytest.raises(ValueError, match="strips, a mass"):
        span_load(replace(model, loads=None, statics=None), SWEEP)
    with pytest.raises(ValueError, match="row of speeds"):
        span_load(model, FlightCondition(V=10.0, rho=1.0))
