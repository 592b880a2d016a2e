"""Plant and controller joined: against python-control and the engine, by names, with delays and schedules."""

from __future__ import annotations

from dataclasses import replace

import control
import numpy as np
import pytest

import aeroservo as av
from aeroservo.control.closed_flutter import closed_flutter
from aeroservo.control.closed_loop import closed_loop, controller_at, loop_plant, roots
from aeroservo.control.controller import Controller, state_feedback
from aeroservo.control.plant import design_plant
from aeroservo.datatypes import FlightCondition, LinearSystem
from aeroservo.servo import Actuator, Sensor
from aeroservo.simulate.engine import linearised, simulate
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario

STATES = ("plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s")
#: Published gain of the thesis' regulator at 55 m/s, 10,000 ft (Q = I, R = 1), delta = -K x.
K_55 = np.array([[-6.783, -1.69, -0.573, -0.916]])
COMMAND = ("elevon_command_rad",)


def system(A: object, B: object, C: object, D: object, dt: float | None = None, prefix: str = "") -> LinearSystem:
    """A system with numbered channels."""
    A, B, C, D = (np.atleast_2d(np.asarray(one, dtype=float)) for one in (A, B, C, D))
    n, m, p = A.shape[-1], B.shape[-1], C.shape[-2]
    names = [tuple(f"{c}{i}" for i in range(k)) for c, k in (("x", n), ("u", m), ("y", p))]
    if prefix:
        names[1], names[2] = tuple(f"y{i}" for i in range(m)), tuple(f"u{i}" for i in range(p))
    return LinearSystem(A=A, B=B, C=C, D=D, states=names[0], inputs=names[1], outputs=names[2], dt=dt)


@pytest.mark.parametrize("dt", [None, 0.1])
def test_against_python_control(dt: float | None) -> None:
    """Two inputs, two outputs, dynamic controller, D on both sides: feedback() with the sign of added outputs."""
    random = np.random.default_rng(1)
    draw = random.standard_normal
    plant = system(draw((3, 3)), draw((3, 2)), draw((2, 3)), 0.3 * draw((2, 2)), dt)
    own = system(draw((2, 2)), draw((2, 2)), draw((2, 2)), 0.3 * draw((2, 2)), dt, prefix="c")
    ours = closed_loop(plant, own)
    theirs = control.feedback(plant.to_control(), own.to_control(), sign=1)
    s = np.array([0.3 + 0.7j, 2j, -0.4 + 1.1j])
    for point in s:
        G = ours.C @ np.linalg.solve(point * np.eye(5) - ours.A, ours.B) + ours.D
        assert G == pytest.approx(theirs(point), rel=1e-9, abs=1e-11)


def test_batch_equals_one_by_one_and_schedule_is_interpolated() -> None:
    """A batch of speeds in one call; between two points of a schedule the matrices are their mean."""
    model = av.build(av.read("thesis-simulation"))
    sweep = FlightCondition.at(3048.0, V=[30.0, 40.0, 50.0])
    q = sweep.q
    schedule = Controller(
        A=[], B=[], C=[], D=np.array([-K_55, -3.0 * K_55]), inputs=STATES, outputs=COMMAND, dt_s=0.005,
        pressures=np.array([q[0], q[2]]),
    )  # type: ignore[arg-type]  # fmt: skip
    loop = closed_loop(loop_plant(model, sweep, schedule), schedule, pressure=q)
    for i in range(3):
        weight = (q[i] - q[0]) / (q[2] - q[0])
        own = state_feedback((1.0 + 2.0 * weight) * K_55, STATES, COMMAND, 0.005)
        assert loop.A[i] == pytest.approx(closed_loop(loop_plant(model, sweep[i], own), own).A, abs=1e-12)
    assert controller_at(schedule, 0.0)[3] == pytest.approx(-K_55)  # held below
    assert controller_at(schedule, 1e9)[3] == pytest.approx(-3.0 * K_55)
    with pytest.raises(ValueError, match="dynamic pressure"):
        closed_loop(loop_plant(model, sweep, schedule), schedule)


def test_batched_controllers_meet_batched_plants() -> None:
    """Three plants with three controllers at once, as a schedule design does."""
    draw = np.random.default_rng(2).standard_normal
    plants = system(draw((3, 2, 2)), draw((3, 2, 1)), draw((3, 1, 2)), np.zeros((3, 1, 1)), 0.1)
    own = system(draw((3, 1, 1)), draw((3, 1, 1)), draw((3, 1, 1)), draw((3, 1, 1)), 0.1, prefix="c")
    together = closed_loop(plants, own)
    for i in range(3):
        assert together.A[i] == pytest.approx(closed_loop(plants[i], own[i]).A, abs=1e-13)


def servo_model() -> tuple[object, Controller]:
    """A model with everything in the loop: actuator with dead time, gyro with lag and delay."""
    model = replace(
        linearised(av.build(av.read("thesis-simulation"))),
        limits=(),
        actuators=(Actuator(control="elevon", omega=60.0, zeta=0.7, delay_s=0.004),),
        sensors=(Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0), bandwidth=150.0, delay_s=0.006),),
    )
    filtered = Controller(
        A=[[0.6]], B=[[0.4]], C=[[0.05]], D=[[0.12]], inputs=("gyro",), outputs=COMMAND, dt_s=0.005, delay_s=0.003
    )  # type: ignore[arg-type]
    return model, filtered


@pytest.mark.parametrize("V", [35.0, 48.0])
def test_roots_are_the_growth_that_the_engine_simulates(V: float) -> None:
    """Actuator, dead times, sensor lag and delay, computing delay: the engine's growth is the largest root."""
    model, filtered = servo_model()
    condition = FlightCondition.at(3048.0, V=V)
    values = roots(closed_loop(loop_plant(model, condition, filtered), filtered))  # type: ignore[arg-type]
    run = simulate(
        model,  # type: ignore[arg-type]
        Scenario(
            profile=level(V, altitude=3048.0), duration=12.0, controller=filtered, initial=(("pitch_rad", 0.001),)
        ),
    )
    assert run.growth == pytest.approx(float(np.nanmax(values.real)), rel=2e-3, abs=2e-3)


def test_boundary_with_the_whole_servo_is_where_growth_changes_sign() -> None:
    """closed_flutter on the same loop: bounded just below its speed, growing just above, by simulation."""
    model, filtered = servo_model()
    found = closed_flutter(model, FlightCondition.at(3048.0, V=np.arange(10.0, 80.0, 2.0)), filtered)  # type: ignore[arg-type]
    assert found.flutter_speed is not None
    for V, grows in ((found.flutter_speed * 0.995, False), (found.flutter_speed * 1.005, True)):
        run = simulate(
            model,  # type: ignore[arg-type]
            Scenario(
                profile=level(V, altitude=3048.0), duration=20.0, controller=filtered, initial=(("pitch_rad", 0.001),)
            ),
        )
        assert (run.growth is not None and run.growth > 0.0) is grows
    assert "actuator elevon" in found.names


@pytest.mark.parametrize(("altitude", "lost"), [(3048.0, 58.618), (0.0, 50.374)])
@pytest.mark.parametrize("dt", [None, 0.005])
def test_the_thesis_regulator_is_lost_through_a_real_root(altitude: float, lost: float, dt: float | None) -> None:
    """Designed at 55 m/s, 10,000 ft: lost at 58.618 m/s there (the thesis' 59), at 50.374 at sea level; both rates."""
    model = av.build(av.read("thesis-simulation"))
    sweep = FlightCondition.at(altitude, V=np.arange(5.0, 85.0, 5.0))
    found = closed_flutter(model, sweep, state_feedback(K_55, STATES, COMMAND, dt))
    first = found.intervals[0]
    assert first.kind == "divergence"
    assert first.start == pytest.approx(lost, abs=0.01)
    assert found.first_real_instability == first.start
    finer = closed_flutter(
        model, FlightCondition.at(altitude, V=np.arange(5.0, 85.0, 0.7)), state_feedback(K_55, STATES, COMMAND, dt)
    )
    assert finer.intervals[0].start == pytest.approx(first.start or 0.0, rel=1e-6)


@pytest.mark.parametrize("name", ["thesis-simulation", "thesis-binary", "thesis-aircraft", "bact"])
@pytest.mark.parametrize("dt", [None, 0.005])
def test_without_gain_it_is_the_p_method(name: str, dt: float | None) -> None:
    """Zero gains, sampled and continuous: the same flutter, intervals and modes as p, free heave included."""
    model = av.build(av.read(name))
    sweep = FlightCondition.at(0.0, V=np.arange(10.0, 150.0, 2.0))
    plant = design_plant(model, sweep[0])
    still = state_feedback(np.zeros((len(plant.inputs), 1)), (plant.outputs[-1],), plant.inputs, dt)
    if dt is None and model.sensors:
        still = state_feedback(np.zeros((len(plant.inputs), 1)), (plant.outputs[0],), plant.inputs, dt)
    ours, theirs = closed_flutter(model, sweep, still), av.flutter(model, sweep, av.P())
    assert len(ours.intervals) == len(theirs.intervals) > 0
    for a, b in zip(ours.intervals, theirs.intervals):
        assert (a.kind, a.end is None, a.mode) == (b.kind, b.end is None, b.mode)
        assert a.start == pytest.approx(b.start or 0.0, rel=1e-6)
        assert a.frequency == pytest.approx(b.frequency, rel=1e-6, abs=1e-6)
    assert ours.divergence_speed == theirs.divergence_speed


def test_slow_second_order_actuator() -> None:
    """60 rad/s, zeta 0.7 in the regulator's loop: unstable at its own design point, +10.3 +- 74.5i."""
    model = replace(
        av.build(av.read("thesis-simulation")), actuators=(Actuator(control="elevon", omega=60.0, zeta=0.7),)
    )
    one = state_feedback(K_55, STATES, COMMAND, None)
    values = roots(closed_loop(loop_plant(model, FlightCondition.at(3048.0, V=55.0), one), one))
    worst = values[np.argmax(values.real)]
    assert worst.real == pytest.approx(10.3, abs=0.05)
    assert abs(worst.imag) == pytest.approx(74.5, abs=0.05)


def test_too_high_a_gain_at_too_low_a_rate_flips_at_every_sample() -> None:
    """A root through z = -1 is an instability of the sampling, with half the sample rate as its frequency."""
    model = av.build(av.read("thesis-simulation"))
    found = closed_flutter(
        model, FlightCondition.at(3048.0, V=np.arange(20.0, 120.0, 5.0)), state_feedback(K_55, STATES, COMMAND, 0.005)
    )
    last = found.intervals[-1]
    assert (last.kind, last.mode) == ("flutter", "sampling")
    assert last.frequency == pytest.approx(np.pi / 0.005)


def test_warnings_and_refusals() -> None:
    """Held schedules, limits, a start that is unstable; delays of continuous loops, channels, algebraic loops."""
    model = av.build(av.read("thesis-simulation"))
    sweep = FlightCondition.at(3048.0, V=np.arange(60.0, 150.0, 10.0))
    limited = Controller(
        A=[], B=[], C=[], D=np.zeros((2, 1, 1)), inputs=("pitch_rad",), outputs=COMMAND, dt_s=0.005, limits=(0.1,),
        pressures=np.array([10.0, 20.0]),
    )  # type: ignore[arg-type]  # fmt: skip
    text = " ".join(closed_flutter(model, sweep, limited).warnings)
    for word in ("Mach 0.3", "already unstable", "limits", "held outside"):
        assert word in text
    plant = system([[0.0]], [[1.0]], [[1.0]], [[1.0]])
    with pytest.raises(ValueError, match="algebraic"):
        closed_loop(plant, Controller(A=[], B=[], C=[], D=[[1.0]], inputs=("y0",), outputs=("u0",)))  # type: ignore[arg-type]
    late = replace(plant, input_delay_s=0.1)
    one = Controller(A=[], B=[], C=[], D=[[-1.0]], inputs=("y0",), outputs=("u0",))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="no state space"):
        closed_loop(late, one)
    with pytest.raises(ValueError, match="no state space"):
        closed_loop(plant, replace(system([[-1.0]], [[1.0]], [[1.0]], [[0.0]], prefix="c"), input_delay_s=0.1))
    with pytest.raises(ValueError, match="reads 'z'"):
        closed_loop(plant, Controller(A=[], B=[], C=[], D=[[1.0]], inputs=("z",), outputs=("u0",)))  # type: ignore[arg-type]
