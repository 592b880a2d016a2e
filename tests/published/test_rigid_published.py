"""The Boeing 747-100 of Etkin and Reid: published derivatives in, published modes out.

B. Etkin and L. D. Reid, Dynamics of Flight: Stability and Control, 3rd ed., Wiley, 1996, sections 6.2 and 6.7: cruise
at 40,000 ft, Mach 0.8 (page 166 for the longitudinal data, 187-188 for the lateral; the aircraft is that of NASA
CR-2144). Every derivative below was read in two or more independent public transcriptions of the book's tables (course
programs); the longitudinal matrix in feet and the aperiodic lateral roots (roll -0.562; spiral within 1 % of -0.00734)
in online copies. The remaining digits of the published eigenvalues are from memory of the book; the book's own
dimensional derivatives reproduce them here, which no wrong memory would.
"""

import numpy as np
import pytest

from aeroservo.flight.derivatives import (
    LateralDerivatives,
    LongitudinalDerivatives,
    StabilityDerivatives,
    lateral_derivatives,
    longitudinal_derivatives,
)
from aeroservo.flight.linear import lateral_model, longitudinal_model
from aeroservo.flight.modes import flight_modes
from aeroservo.flight.rigid import Airframe

V, RHO, G = 235.9, 0.3045, 9.81
BOEING = Airframe(
    mass=2.83176e6 / G, Ixx=0.247e8, Iyy=0.449e8, Izz=0.673e8, Ixz=-0.212e7, area=511.0, chord=8.324, span=59.64
)
COEFFICIENTS = StabilityDerivatives(
    CX_u=-0.1080, CX_alpha=0.2193, CZ_u=-0.1060, CZ_alpha=-4.920, CZ_q=-5.921, CZ_alphadot=5.896,
    CM_u=0.1043, CM_alpha=-1.023, CM_q=-23.92, CM_alphadot=-6.314,
    CY_beta=-0.8771, Cl_beta=-0.2797, Cn_beta=0.1946, Cl_p=-0.3295, Cn_p=-0.04073, Cl_r=0.3040, Cn_r=-0.2737,
)  # fmt: skip
DIMENSIONAL = LongitudinalDerivatives(
    X_u=-1.982e3, X_w=4.025e3, Z_u=-2.595e4, Z_w=-9.030e4, Z_q=-4.524e5, Z_wdot=1.909e3, M_u=1.593e4, M_w=-1.563e5,
    M_q=-1.521e7, M_wdot=-1.702e4,
)  # fmt: skip
LATERAL = LateralDerivatives(
    Y_v=-1.610e4, L_v=-3.062e5, L_p=-1.076e7, L_r=9.925e6, N_v=2.131e5, N_p=-1.330e6, N_r=-8.934e6
)
PRINTED_DERIVATIVES = 2e-3  # four-digit products of four-digit factors, some of which the book rounds twice
PRINTED_MODES = 2e-3  # of |lambda|: the same rounding, through the eigenvalues


def test_dimensional_derivatives_follow_from_the_coefficients():
    got = longitudinal_derivatives(COEFFICIENTS, BOEING, V=V, rho=RHO, gravity=G)
    for name in ("X_u", "X_w", "Z_u", "Z_w", "Z_q", "Z_wdot", "M_u", "M_w", "M_q", "M_wdot"):
        assert getattr(got, name) == pytest.approx(getattr(DIMENSIONAL, name), rel=PRINTED_DERIVATIVES), name
    got = lateral_derivatives(COEFFICIENTS, BOEING, V=V, rho=RHO)
    for name in ("Y_v", "L_v", "L_p", "L_r", "N_v", "N_p", "N_r"):
        assert getattr(got, name) == pytest.approx(getattr(LATERAL, name), rel=PRINTED_DERIVATIVES), name


@pytest.mark.parametrize("from_coefficients", [True, False])
def test_phugoid_and_short_period(from_coefficients):
    """-0.003289 +/- 0.06723i (period 93.4 s, zeta 0.0489) and -0.3719 +/- 0.8875i (7.08 s, 0.387)."""
    d = longitudinal_derivatives(COEFFICIENTS, BOEING, V=V, rho=RHO, gravity=G) if from_coefficients else DIMENSIONAL
    phugoid, short = flight_modes(longitudinal_model(d, BOEING, V=V, gravity=G).A)
    assert (phugoid.name, short.name) == ("phugoid", "short period")
    for mode, published in ((phugoid, -0.003289 + 0.06723j), (short, -0.3719 + 0.8875j)):
        assert abs(mode.eigenvalue - published) < PRINTED_MODES * abs(published)
    assert phugoid.period == pytest.approx(93.4, rel=2e-3)
    assert phugoid.damping_ratio == pytest.approx(0.0489, rel=5e-3)
    assert short.period == pytest.approx(7.08, rel=2e-3)
    assert short.damping_ratio == pytest.approx(0.387, rel=2e-3)
    assert phugoid.time_to_half == pytest.approx(211.0, rel=5e-3)
    assert short.time_to_half == pytest.approx(1.86, rel=5e-3)


def test_state_matrix_in_the_units_of_nasa_cr_2144():
    """Longitudinal matrix of the same flight in feet, as printed in many courses."""
    A = longitudinal_model(DIMENSIONAL, BOEING, V=V, gravity=G).A.copy()
    ft = 0.3048
    A[:2, 2:] /= ft
    A[2:, :2] *= ft
    printed = np.array(
        [
            [-0.006868, 0.01395, 0.0, -32.2],
            [-0.09055, -0.3151, 773.98, 0.0],
            [0.0001187, -0.001026, -0.4285, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ]
    )
    np.testing.assert_allclose(A, printed, rtol=PRINTED_DERIVATIVES, atol=1e-9)


@pytest.mark.parametrize("from_coefficients", [True, False])
def test_lateral_modes(from_coefficients):
    """Spiral -0.0072973, roll -0.56248, Dutch roll -0.033011 +/- 0.94655i."""
    d = lateral_derivatives(COEFFICIENTS, BOEING, V=V, rho=RHO) if from_coefficients else LATERAL
    spiral, roll, dutch = flight_modes(lateral_model(d, BOEING, V=V, gravity=G).A, "lateral")
    assert (spiral.name, roll.name, dutch.name) == ("spiral", "roll", "Dutch roll")
    assert spiral.eigenvalue.real == pytest.approx(-0.0072973, rel=5e-3)
    assert roll.eigenvalue.real == pytest.approx(-0.56248, rel=PRINTED_MODES)
    assert abs(dutch.eigenvalue - (-0.033011 + 0.94655j)) < PRINTED_MODES * 0.947
