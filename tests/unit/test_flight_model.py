"""Rigid flight of an aircraft file: coefficients handed over, masses, elastic corrections, the thesis wing's modes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from aeroservo.aero.coefficients import AeroCoefficients, Reference
from aeroservo.aero.strip import QuasiSteady
from aeroservo.aeroelastic.aircraft_wing import aircraft_wing
from aeroservo.aeroelastic.build_beam import beam_model
from aeroservo.aircraft.files import read
from aeroservo.flight.trim import neutral_point
from aeroservo.studies.aircraft_aero import aircraft_coefficients, read_aircraft
from aeroservo.studies.flight_model import (
    aircraft_airframe,
    aircraft_flight,
    aircraft_roots,
    elastic_changes,
    elastic_coefficients,
    flight_coefficients,
)

V, RHO = 55.0, 1.225
UAV = read_aircraft("thesis-uav")
#: Two sums over the same strips.
IDENTITY = 1e-9


def given(rates, q: float) -> AeroCoefficients:
    """Coefficients whose CL_q and CM_q are `q`, in a normalisation."""
    return AeroCoefficients(
        reference=Reference(S=2.0, c=0.5, b=4.0, point=(0.3, 0.0, 0.0)), rates=rates, CL0=0.1, CM0=0.02, CL_alpha=5.0,
        CM_alpha=-0.4, CL_q=q, CM_q=-q, controls=("elevon", "flap"), CL_delta=(0.8, 0.3), CM_delta=(-0.3, -0.1),
        span_efficiency=0.9,
    )  # fmt: skip


def test_coefficients_are_handed_over_with_their_rates_and_controls() -> None:
    """q c/(2V), q c/V and q/V of the same derivative; one control or all; induced drag from the span efficiency."""
    same = [flight_coefficients(given(*x)) for x in (("c/(2V)", 4.0), ("c/V", 2.0), ("1/V", 1.0))]
    assert [round(k.CL_q, 12) for k in same] == [4.0, 4.0, 4.0] and same[1].CM_q == pytest.approx(-4.0)
    k = same[0]
    assert (k.CL_delta, k.CM_delta, k.x, k.CL_alphadot) == pytest.approx((1.1, -0.4, 0.3, 0.0))
    assert pytest.approx(1.0 / (np.pi * 8.0 * 0.9)) == k.CD_CL2
    assert flight_coefficients(given("c/V", 1.0), control="flap", CD0=0.02).CL_delta == pytest.approx(0.3)
    assert flight_coefficients(given("c/V", 1.0), CD0=0.02).CD0 == 0.02
    assert neutral_point(k, 0.5) == pytest.approx(given("c/V", 1.0).neutral_point)
    with pytest.raises(ValueError, match="control must be one of elevon, flap, got 'rudder'"):
        flight_coefficients(given("c/V", 1.0), control="rudder")


def test_masses_in_body_axes() -> None:
    """Half a turn about y keeps every term of a symmetric aircraft."""
    body, masses = aircraft_airframe(UAV), UAV.masses()
    assert masses is not None
    assert (body.mass, body.Iyy, body.Ixz) == pytest.approx((masses.mass, masses.inertia[1, 1], -masses.inertia[0, 2]))
    assert (body.area, body.chord, body.span) == pytest.approx((1.0, 0.52667, 2.0), abs=1e-4)
    with pytest.raises(ValueError, match="needs masses"):
        aircraft_airframe(UAV.model_copy(update={"mass": ()}))


def test_thesis_wing_at_55_m_s_from_its_file() -> None:
    """Centre of gravity at the neutral point: one root at zero. 5 % of the chord behind it: one root, unstable, real.

    Lattice 24 x 32; CD0 = 0.012. The pitch-up doubles every 0.059 s with the inertia of the file.
    """
    moved = aircraft_roots(UAV, np.array([0.1, 0.0, -0.05]), V=V, rho=RHO, CD0=0.012)
    np.testing.assert_allclose(moved.static_margin, [0.1, 0.0, -0.05], atol=1e-12)
    ahead, at, behind = moved.roots
    assert np.sum(ahead.imag > 0.0) == 2 and ahead.real.max() < 0.0  # phugoid and short period
    assert np.abs(at).min() < 1e-9 * np.abs(at).max() and np.sort(at.real)[-2] < 0.0
    unstable = behind[behind.real > 0.0]
    assert unstable.size == 1 and unstable[0].imag == pytest.approx(0.0, abs=1e-9)
    assert unstable[0].real == pytest.approx(11.70, abs=0.05)
    whole = flight_coefficients(aircraft_coefficients(UAV), CD0=0.012)
    body = aircraft_airframe(UAV)
    x_np = neutral_point(whole, body.chord)
    flight = aircraft_flight(UAV, V=V, rho=RHO, x_cg=x_np + 0.05 * body.chord, CD0=0.012)
    assert flight.static_margin == pytest.approx(-0.05)
    names = [mode.name for mode in flight.modes]
    assert names.count("aperiodic") == 2 and names.count("oscillation") == 1
    doubling = min(mode.time_to_half for mode in flight.modes if mode.eigenvalue.real > 0.0)
    assert doubling == pytest.approx(-np.log(2.0) / 11.70, rel=5e-3)
    # (5.30): the pitch model's denominator has the same unstable root as the four-state model
    fast = np.roots(flight.pitch_rate[1])
    assert fast.real.max() == pytest.approx(unstable[0].real, rel=2e-2)


def test_elastic_changes_are_the_strips_own() -> None:
    """Lift and pitching moment of the bent wing, summed a second time over the strips of its static model."""
    q = 0.5 * RHO * V**2
    x = 0.36
    statics = beam_model(aircraft_wing(UAV), QuasiSteady(damped=False)).statics
    assert statics is not None and statics.loads is not None
    n, loads = statics.modes.n, statics.loads
    forces = np.asarray(statics.aero(0.0)).real
    wing = aircraft_wing(UAV)
    places = statics.modes.grid[: len(loads.y)]
    s = np.interp(places[:, 1], wing.beam.position(wing.beam.y)[:, 1], wing.beam.y)
    cos = np.cos(wing.beam.at("sweep", s))
    changes = elastic_changes(UAV, q, x=x)
    assert set(changes) == {"incidence", "camber", "elevon"}
    for name, change in changes.items():
        j = statics.column(name)
        bent = np.linalg.solve(statics.modes.K - q * forces[:, :n], q * forces[:, j])
        lift, torque = loads.lift[:, :n] @ bent, loads.torque[:, :n] @ bent
        moment = loads.width @ (torque * cos - lift * (places[:, 0] - x))
        reference = UAV.references()
        assert change.CL == pytest.approx(2.0 * loads.width @ lift / reference.S, rel=IDENTITY)
        assert change.CM == pytest.approx(2.0 * moment / (reference.S * reference.c), rel=IDENTITY)
        rigid = loads.row("lift")[j]
        assert change.lift_ratio == pytest.approx(1.0 + loads.row("lift")[:n] @ bent / rigid, rel=IDENTITY)


def test_elastic_corrections_have_their_limits() -> None:
    """None without air, first order in q; torsion takes half of the elevon's lift at 55 m/s, 8 % of the wing's."""
    whole = flight_coefficients(aircraft_coefficients(UAV))
    still = elastic_coefficients(whole, UAV, 0.0)
    assert still == whole
    small, smaller = (elastic_changes(UAV, q, x=whole.x)["elevon"].CL for q in (2.0, 1.0))
    assert small / smaller == pytest.approx(2.0, rel=2e-3)
    change = elastic_changes(UAV, 0.5 * RHO * V**2, x=whole.x)
    assert change["elevon"].lift_ratio == pytest.approx(0.519, abs=2e-3)
    assert change["incidence"].lift_ratio == pytest.approx(0.915, abs=2e-3)
    soft = elastic_coefficients(whole, UAV, 0.5 * RHO * V**2)
    assert 0.0 < soft.CL_delta < 0.6 * whole.CL_delta and whole.CM_delta < soft.CM_delta < 0.0
    flight = [aircraft_flight(UAV, V=V, rho=RHO, x_cg=0.33, elastic=e) for e in (False, True)]
    assert abs(flight[1].trim.delta) > abs(flight[0].trim.delta)
    stations = [s.model_copy(update={"EI_N_m2": 1e9, "GJ_N_m2": 1e9}) for s in UAV.structure.station]
    stiff = UAV.model_copy(update={"structure": UAV.structure.model_copy(update={"station": tuple(stations)})})
    assert elastic_changes(stiff, 1e3, x=0.3)["elevon"].lift_ratio == pytest.approx(1.0, abs=1e-5)
    assert replace(whole) == whole


def test_bad_input_says_why() -> None:
    """Negative pressure, beyond divergence, no such control, no structure."""
    whole = flight_coefficients(aircraft_coefficients(UAV))
    with pytest.raises(ValueError, match="must not be negative"):
        elastic_changes(UAV, -1.0, x=0.0)
    with pytest.raises(ValueError, match="control must be one of elevon, got 'rudder'"):
        elastic_coefficients(whole, UAV, 100.0, control="rudder")
    with pytest.raises(ValueError, match="rigid"):
        elastic_changes(UAV.model_copy(update={"structure": None}), 100.0, x=0.0)
    forward = [s.model_copy(update={"GJ_N_m2": 1.0}) for s in UAV.structure.station]
    soft = UAV.model_copy(update={"structure": UAV.structure.model_copy(update={"station": tuple(forward)})})
    with pytest.raises(ValueError, match="beyond the divergence"):
        elastic_changes(soft, 5e5, x=0.0)
    assert read("thesis-uav").name == UAV.name
