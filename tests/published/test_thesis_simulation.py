"""The thesis' simulation model and the linear model of its appendix (Bramstång 2015, sections 7.6, 9.4, appendix).

The inputs are the pinned set of the preset; references are the figures computed from it when it was pinned, and the
thesis' own where they follow from it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import aeroservo as av
from aeroservo.aircraft.schema_other import StateSpaceFile
from aeroservo.control.controller import state_feedback
from aeroservo.datatypes import FlightCondition, LinearSystem
from aeroservo.servo import Actuator
from aeroservo.simulate.engine import Simulation, linearised, simulate
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario

STATES = ("plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s")
#: lqr(A, B, I, 1) at 55 m/s, 10,000 ft; delta = -K x.
K_55 = np.array([[-6.783, -1.69, -0.573, -0.916]])


@pytest.mark.parametrize(
    ("altitude", "flutter", "omega", "divergence", "reversal"),
    [(3048.0, 45.39, 22.45, 124.05, 53.29), (0.0, 40.3, 22.56, 106.61, 45.8)],
)
def test_boundaries(altitude: float, flutter: float, omega: float, divergence: float, reversal: float) -> None:
    """Flutter, divergence and lift reversal to 0.05 m/s at both altitudes."""
    model = av.build(av.read("thesis-simulation"))
    sweep = FlightCondition.at(altitude, V=np.arange(5.0, 150.0, 1.0))
    found, still = av.flutter(model, sweep, av.P()), av.static(model, sweep)
    assert found.flutter_speed == pytest.approx(flutter, abs=0.05)
    assert found.flutter_frequency == pytest.approx(omega, abs=0.01)
    assert found.divergence_speed == pytest.approx(divergence, abs=0.05)
    assert pytest.approx(reversal, abs=0.05) == still.reversal.V
    assert still.reversal_quantity == "lift"


def test_lift_reversal_has_its_closed_form_and_the_lattices_is_printed() -> None:
    """q_R = K_theta CL_delta/(S c (CM_alpha CL_delta - CL_alpha CM_delta)); the lattice's CM_delta gives 35.5 m/s."""
    file = av.read("thesis-simulation")
    derived = file.derived()
    still = av.static(av.build(file), FlightCondition.at(3048.0, V=[30.0]))
    assert still.reversal.q == pytest.approx(derived["lift_reversal_pressure_Pa"], rel=1e-9)
    other = derived["comparison_lift_reversal_pressure_Pa"]
    assert np.sqrt(2.0 * other / float(FlightCondition.at(3048.0, V=1.0).rho)) == pytest.approx(35.5, abs=0.05)
    assert any("-0.297" in note and "lattice" in note for note in file.problems())


def closed_loop(V: float, *, servo: tuple[Actuator, ...] = (), altitude: float = 3048.0) -> Simulation:
    """The gain of 55 m/s, continuous, at another speed."""
    model = replace(linearised(av.build(av.read("thesis-simulation"))), limits=(), actuators=servo)
    c = state_feedback(K_55, STATES, ("elevon_command_rad",), None)
    return simulate(
        model,
        Scenario(profile=level(V, altitude=altitude), duration=20.0, controller=c, initial=(("pitch_rad", 0.01),)),
    )


@pytest.mark.parametrize(("altitude", "lost"), [(3048.0, 58.618), (0.0, 50.374)])
def test_lqr_is_lost_through_a_real_root(altitude: float, lost: float) -> None:
    """The thesis' 59 m/s: bounded just below, growing without oscillation just above; growth is the eigenvalue."""
    below, above = closed_loop(lost - 0.2, altitude=altitude), closed_loop(lost + 0.2, altitude=altitude)
    assert below.bounded and not above.bounded
    for run, V in ((below, lost - 0.2), (above, lost + 0.2)):
        system = av.linear_system(av.build(av.read("thesis-simulation")), FlightCondition.at(altitude, V=V))
        root = max(np.linalg.eigvals(system.A - system.B[:, :1] @ K_55), key=lambda s: s.real)
        assert root.imag == 0.0
        assert run.growth == pytest.approx(root.real, rel=1e-3)


def test_a_slow_second_order_actuator_undoes_the_lqr() -> None:
    """60 rad/s, zeta 0.7: +10.3 +- 74.5i at its own design point; 165 rad/s leaves it stable; a first-order lag too."""
    run = closed_loop(55.0, servo=(Actuator(control="elevon", omega=60.0, zeta=0.7),))
    assert run.growth == pytest.approx(10.3, abs=0.05)
    assert (run.history is not None and run.overflow_at is None) or not run.bounded
    assert closed_loop(55.0, servo=(Actuator(control="elevon", omega=165.0, zeta=0.7),)).bounded
    assert closed_loop(55.0, servo=(Actuator(control="elevon", omega=60.0),)).bounded


def appendix() -> LinearSystem:
    """The preset as a linear system."""
    file = av.read("thesis-appendix")
    assert isinstance(file, StateSpaceFile)
    m = file.model
    return LinearSystem(A=m.A, B=m.B, C=m.C, D=m.D, states=m.states, inputs=m.inputs, outputs=m.outputs)


K_APPENDIX = np.array([[8.6714, 3.4228, 18.166, 0.1854, 2.5293]])


def test_appendix_roots_and_the_loop_inside_it() -> None:
    """Open 0.338 +- 2.083i, closed -0.618 +- 1.940i; without the pitch-lag loop one real root, +0.443."""
    system = appendix()
    roots = np.linalg.eigvals(system.A)
    assert np.abs(roots - (0.337903 + 2.08286j)).min() < 1e-5
    closed = np.linalg.eigvals(system.A - system.B @ K_APPENDIX)
    assert np.abs(closed - (-0.618152 + 1.940473j)).min() < 1e-5
    ratio = system.A[3:, 0] / system.B[3:, 0]
    np.testing.assert_allclose(ratio, 29.0, atol=2e-3)
    assert np.abs(np.linalg.eigvals(system.A[1:, 1:]) - 0.442946).min() < 1e-5


def test_appendix_printed_closed_loop_needs_the_minus() -> None:
    """A - B K agrees with the printed matrix, to the digits printed, with -theta in the first row only."""
    system = appendix()
    printed = np.array(
        [
            [-1, 0, -1, 0, 0],
            [0, 0, 0, 1, 0],
            [0, 0, 0, 0, 1],
            [70.7138, -217.7978, -616.9943, -27.5706, -34.5308],
            [14.7525, 8.0503, 16.9407, 0.1127, -7.1042],
        ]
    )
    digit = 5e-5  # all three matrices are rounded to the fourth decimal
    rounding = digit * (2.0 + np.abs(system.B) + np.abs(K_APPENDIX))
    assert np.all(np.abs(system.A - system.B @ K_APPENDIX - printed) <= rounding)
    assert np.abs((system.A + 2.0 * np.outer(np.eye(5)[0], np.eye(5)[2]) - printed)[0, 2]) == 2.0  # the misprint


def test_appendix_simulated() -> None:
    """Growth with and without the gain, sampled at 200 Hz: within 1 % of the eigenvalues; 6.5 s to settle."""
    start = (("pitch_rad", 0.01),)
    free = simulate(appendix(), Scenario(profile=level(56.48), duration=20.0, initial=start))
    assert free.growth == pytest.approx(0.337903, rel=1e-3) and not free.bounded
    c = state_feedback(K_APPENDIX, appendix().states, ("elevon_rad",), 0.005)
    held = simulate(appendix(), Scenario(profile=level(56.48), duration=12.0, initial=start, controller=c))
    assert held.growth == pytest.approx(-0.618152, rel=0.01) and held.bounded
    assert held.history is not None
    y = np.abs(held.history["plunge_m"])
    settled = held.history.t[np.flatnonzero(y > 0.02 * y.max())[-1]]
    assert 5.0 < settled < 7.0


def test_nonlinear_response_without_control_ends_at_half_a_turn() -> None:
    """Section 9.4.3: the oscillation grows until pitch reaches 180 degrees; here the limit stops it there."""
    run = simulate(
        av.build(av.read("thesis-simulation")),
        Scenario(profile=level(56.48, altitude=3048.0), duration=60.0, initial=(("pitch_rad", 0.01),)),
    )
    assert run.limit_left is not None and run.limit_left.channel == "pitch_rad" and not run.bounded
