"""Wright & Cooper's bend-twist wing (Introduction to Aircraft Aeroelasticity and Loads, 2nd ed. 2015, ch. 10)."""

from __future__ import annotations

import numpy as np
import pytest

from aeroservo.aeroelastic.build import THEORIES, build
from aeroservo.aeroelastic.flutter import PK, G, K, P, flutter
from aeroservo.aeroelastic.static import divergence
from aeroservo.aircraft.files import read
from aeroservo.aircraft.overrides import override
from aeroservo.datatypes import FlightCondition
from aeroservo.structure.modal import natural_modes

TOLERANCE = 1e-4  # relative, the case's own: speeds to six digits
SWEEP = FlightCondition(V=np.linspace(5.0, 250.0, 26), rho=1.225)
FILE = read("wright-cooper-binary")


def test_wind_off_frequencies():
    frequencies = natural_modes(build(FILE).modes).omega / (2.0 * np.pi)
    np.testing.assert_allclose(frequencies, [2.8253, 4.5075], atol=0.00006)


@pytest.mark.parametrize("method", [P(), PK(), K(), G()])
@pytest.mark.parametrize(
    ("aero", "speed", "hertz"), [("quasi_steady", 39.6090, 4.3723), ("quasi_steady_damped", 82.2221, 3.8828)]
)
def test_flutter(aero, speed, hertz, method):
    result = flutter(build(FILE, aero), SWEEP, method)
    assert result.flutter_speed == pytest.approx(speed, rel=TOLERANCE)
    assert result.flutter_frequency / (2.0 * np.pi) == pytest.approx(hertz, rel=TOLERANCE)


@pytest.mark.parametrize("aero", [*THEORIES])
def test_divergence(aero):
    # 3 K_theta / (e c^2 s a_w), whatever the unsteady theory
    w = FILE.wing
    q = 3.0 * w.K_theta / (w.e * w.chord_m**2 * w.semi_span_m * w.lift_slope_per_rad)
    found = divergence(build(FILE, aero), SWEEP[0])
    assert pytest.approx(173.57112, rel=1e-7) == found.V
    assert found.q == pytest.approx(q, rel=1e-10)


@pytest.mark.parametrize("scale", [0.25, 0.5, 3.0])
def test_flutter_speed_does_not_know_the_scale_of_mass(scale):
    # without pitch damping: quasi-steady flutter is where the growth of both modes balances, whatever their mass
    lighter = override(FILE, {"wing.mass_kg_per_m2": scale * FILE.wing.mass_kg_per_m2})
    one, two = (flutter(build(file, "quasi_steady"), SWEEP, P()) for file in (FILE, lighter))
    assert two.flutter_speed == pytest.approx(one.flutter_speed, rel=1e-9)
    assert two.flutter_frequency == pytest.approx(one.flutter_frequency / np.sqrt(scale), rel=1e-9)
    if scale == 0.5:
        assert two.flutter_frequency / (2.0 * np.pi) == pytest.approx(6.1834, rel=TOLERANCE)


def test_zero_density_gives_vacuum_frequencies():
    natural = natural_modes(build(FILE).modes).omega
    for aero, method in (("quasi_steady_damped", P()), ("jones", P()), ("theodorsen", PK()), ("theodorsen", G())):
        result = flutter(build(FILE, aero), FlightCondition(V=[10.0, 100.0, 200.0], rho=0.0), method)
        np.testing.assert_allclose(result.frequency[:, :2], np.broadcast_to(natural, (3, 2)), rtol=1e-9)
        assert result.divergence_speed is None
        assert not result.found


def test_same_equivalent_airspeed_at_every_density_without_apparent_mass_and_damping():
    # M_thetadot = 0: flutter does not know the mass ratio, so it comes at one dynamic pressure
    speeds = [
        flutter(build(FILE, "quasi_steady"), FlightCondition(V=SWEEP.V, rho=rho), P()).flutter_speed * np.sqrt(rho)
        for rho in (1.225, 0.9, 0.6)
    ]
    np.testing.assert_allclose(speeds, speeds[0], rtol=1e-9)
