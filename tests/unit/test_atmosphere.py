"""The standard atmosphere against two other programs, its own printed tables, and hydrostatics."""

import doctest
import subprocess
import sys

import numpy as np
import pytest

from aeroservo import atmosphere as atm

IDENTITY = 2e-14  # relative: the same formulas in double precision, exponentials of up to 11
ROUNDED_R = 1e-6  # relative: `ambiance` takes R = 287.05287 J/(kg K), the ICAO's rounding
ROUNDED_P = 1e-5  # the same in exp(-11.2), the pressure's fall to 80 km

Z = np.concatenate([np.linspace(-5000.0, 80000.0, 1701), [11000.0, 20000.0, 32000.0, 47000.0, 51000.0, 71000.0]])


def test_geometric_equals_fluids():
    from fluids import ATMOSPHERE_1976

    air = atm.atmosphere(Z, geometric=True)
    ours = np.stack([air.T, air.p, air.rho, air.a_sound, air.mu])
    theirs = np.array([[o.T, o.P, o.rho, o.v_sonic, o.mu] for o in map(ATMOSPHERE_1976, Z)]).T
    np.testing.assert_allclose(ours, theirs, rtol=IDENTITY)


def test_geopotential_equals_ambiance():
    from ambiance import Atmosphere

    H = np.linspace(-5000.0, 79000.0, 337)
    air, other = atm.atmosphere(H), Atmosphere(atm.geometric_altitude(H))
    np.testing.assert_allclose(air.T, other.temperature, rtol=ROUNDED_R)
    np.testing.assert_allclose(air.p, other.pressure, rtol=ROUNDED_P)
    np.testing.assert_allclose(air.rho, other.density, rtol=ROUNDED_P)
    np.testing.assert_allclose(air.a_sound, other.speed_of_sound, rtol=ROUNDED_R)
    np.testing.assert_allclose(air.mu, other.dynamic_viscosity, rtol=ROUNDED_R)
    np.testing.assert_allclose(air.nu, other.kinematic_viscosity, rtol=ROUNDED_P)


def test_at_ten_thousand_feet_as_printed():
    """The project's printed figures; half a unit of the last digit."""
    air = atm.atmosphere(3048.0)
    assert abs(air.T - 268.338) < 5e-4
    assert abs(air.p - 69681.7) < 5e-2
    assert abs(air.rho - 0.904637) < 5e-7
    assert abs(air.a_sound - 328.387) < 5e-4
    assert abs(atm.atmosphere(3048.0, geometric=True).rho - 0.904773) < 5e-7


@pytest.mark.parametrize(
    ("H", "T", "p", "half_digit"),
    [  # base of each layer as published programs of the 1976 standard tabulate it (seven digits)
        (0.0, 288.15, 101325.0, 0.0),
        (11000.0, 216.65, 22632.06, 5e-3),
        (20000.0, 216.65, 5474.889, 5e-4),
        (32000.0, 228.65, 868.0187, 5e-5),
        (47000.0, 270.65, 110.9063, 5e-5),
        (51000.0, 270.65, 66.93887, 5e-6),
        (71000.0, 214.65, 3.956420, 5e-7),
    ],
)
def test_bases_of_the_layers_as_tabulated(H, T, p, half_digit):
    air = atm.atmosphere(H)
    np.testing.assert_allclose(air.T, T, atol=1e-9)
    np.testing.assert_allclose(air.p, p, rtol=0, atol=half_digit)


def test_hydrostatic_balance_and_gas_law():
    """dp/dH = -rho g0 everywhere, the corners included: the layers are joined."""
    H, step = np.linspace(-4990.0, 79990.0, 2000), 0.5
    slope = (atm.atmosphere(H + step).p - atm.atmosphere(H - step).p) / (2 * step)
    air = atm.atmosphere(H)
    np.testing.assert_allclose(slope, -air.rho * 9.80665, rtol=3e-8)
    np.testing.assert_allclose(air.p, air.rho * (8314.32 / 28.9644) * air.T, rtol=IDENTITY)
    corners = np.array([11e3, 20e3, 32e3, 47e3, 51e3, 71e3])
    below, above = atm.atmosphere(np.nextafter(corners, 0.0)), atm.atmosphere(corners)
    np.testing.assert_allclose(below.p, above.p, rtol=IDENTITY)
    np.testing.assert_allclose(below.T, above.T, rtol=IDENTITY)


def test_isothermal_limit_is_continuous_in_the_lapse():
    """The tropopause by the logarithm's limit: p falls by exp(-g0 dH/(R T))."""
    p = atm.atmosphere([11000.0, 15000.0]).p
    np.testing.assert_allclose(np.log(p[1] / p[0]), -9.80665 * 4000.0 / (8314.32 / 28.9644 * 216.65), rtol=1e-13)


def test_altitude_measures():
    np.testing.assert_allclose(atm.geometric_altitude(atm.geopotential_altitude(Z)), Z, rtol=1e-14)
    np.testing.assert_allclose(atm.geopotential_altitude(86000.0), 84852.0, atol=0.1)  # the standard, Table 4
    z = np.linspace(-4990.0, 80000.0, 1000)
    direct, through_H = atm.atmosphere(z, geometric=True), atm.atmosphere(atm.geopotential_altitude(z))
    np.testing.assert_array_equal(direct.p, through_H.p)


def test_equivalent_airspeed_keeps_dynamic_pressure():
    rho = atm.atmosphere(np.linspace(0.0, 30000.0, 7)).rho
    V_eas = atm.equivalent_airspeed(123.0, rho)
    np.testing.assert_allclose(atm.RHO_SEA_LEVEL * V_eas**2, rho * 123.0**2, rtol=1e-14)
    assert V_eas[0] == 123.0
    np.testing.assert_allclose(atm.true_airspeed(V_eas, rho), 123.0, rtol=1e-14)


def test_shapes_and_locks():
    air = atm.atmosphere(np.zeros((3, 1, 2)))
    assert air.T.shape == air.mu.shape == air.nu.shape == (3, 1, 2)
    assert atm.atmosphere(0).rho.shape == ()
    assert atm.atmosphere([]).rho.shape == (0,)
    with pytest.raises(ValueError, match="read-only"):
        air.T[0] = 1.0


@pytest.mark.parametrize("geometric", [False, True])
@pytest.mark.parametrize("bad", [-5000.1, 80000.1, np.nan, np.inf, [0.0, 1e6]])
def test_outside_the_atmosphere_is_refused(bad, geometric):
    with pytest.raises(ValueError, match=r"altitude must be from -5,000 to 80,000 \[m\], got"):
        atm.atmosphere(bad, geometric=geometric)
    atm.atmosphere([-5000.0, 80000.0], geometric=geometric)


def test_other_bad_input():
    with pytest.raises(ValueError, match=r"density rho must be positive \[kg/m\^3\], got -1"):
        atm.equivalent_airspeed(10.0, [-1.0, 1.0])
    with pytest.raises(ValueError, match=r"density rho must be positive"):
        atm.true_airspeed(10.0, np.nan)
    with pytest.raises(ValueError, match=r"temperature T must be positive \[K\], got 0"):
        atm.speed_of_sound(0.0)
    with pytest.raises(ValueError, match=r"temperature T must be positive"):
        atm.dynamic_viscosity(-3.0)
    with pytest.raises(ValueError, match=r"geometric altitude must be above"):
        atm.geopotential_altitude(-7e6)
    with pytest.raises(ValueError, match=r"geopotential altitude must be below"):
        atm.geometric_altitude(7e6)


def test_imports_nothing_heavy():
    code = "import sys, aeroservo.atmosphere; assert 'scipy' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_examples():
    assert doctest.testmod(atm).failed == 0
