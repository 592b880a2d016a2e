"""The engine against what it must equal: matrix exponential, DOP853, order, energy, Jacobian, ramps, held samples."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import aeroservo as av
from aeroservo.control.controller import Controller, state_feedback
from aeroservo.datatypes import AeroelasticModel, AeroInput, FlightCondition, ModalModel, RationalAero, Spring
from aeroservo.gust.intensity import constant_turbulence
from aeroservo.gust.response import rms_response
from aeroservo.gust.turbulence import shaping_filter
from aeroservo.servo import Actuator
from aeroservo.simulate import _kernels
from aeroservo.simulate.assemble import stepper
from aeroservo.simulate.disturbances import CosineGust, Doublet, Gustiness, SharpGust
from aeroservo.simulate.engine import Simulation, linearised, simulate
from aeroservo.simulate.prepare import prepare
from aeroservo.simulate.profiles import Profile, climb, level
from aeroservo.simulate.scenario import Scenario, Stepping

#: Two exact ways to the same numbers: rounding over some thousand steps.
IDENTITY = 1e-11
STATES = ("plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s")


def model(name: str = "thesis-simulation", **changes: object) -> AeroelasticModel:
    """A preset, without its weight and limits."""
    return replace(linearised(av.build(av.read(name))), limits=(), **changes)  # type: ignore[arg-type]


def columns(run: Simulation, names: tuple[str, ...] = STATES) -> np.ndarray:
    """Channels of a history."""
    assert run.history is not None
    return np.stack([run.history[name] for name in names], axis=1)


def largest(difference: np.ndarray, reference: np.ndarray) -> float:
    """Largest difference of each channel, part of its largest value."""
    return float(np.max(np.abs(difference).max(axis=0) / np.abs(reference).max(axis=0)))


@pytest.mark.parametrize(("method", "bound"), [("exact", IDENTITY), ("rk4", 1e-8)])
def test_free_response_is_the_matrix_exponential(method: str, bound: float) -> None:
    """Over 2 s, at the step that the halving check picks; the reference comes from the analytic linear system."""
    bact, condition = model("bact"), FlightCondition(V=125.0, rho=1.01628)
    scenario = Scenario(
        profile=level(125.0, density=1.01628), duration=2.0, initial=(("pitch_rad", 0.01), ("plunge_m", -0.02))
    )
    run = simulate(bact, scenario, stepping=Stepping(method=method))  # type: ignore[arg-type]
    assert run.method == method
    A = av.linear_system(bact, condition).A
    start = np.array([-0.02, 0.01, 0.0, 0.0, 0.0, 0.0])
    assert run.history is not None
    reference = np.array([expm(A * t) @ start for t in run.history.t[::100]])[:, :4]
    assert largest(columns(run)[::100] - reference, reference) < bound


@pytest.mark.parametrize(("name", "theory", "V"), [("thesis-binary", None, 45.0), ("goland", "jones", 130.0)])
def test_any_model_steps_through_a_sharp_edge(name: str, theory: str | None, V: float) -> None:
    """Binary wing, and a beam wing with lag states: the held gust against the exponential of [A B; 0 0]."""
    plant = av.build(av.read(name), theory)
    system = av.linear_system(plant, FlightCondition.at(0.0, V=V))
    run = simulate(plant, Scenario(profile=level(V), duration=0.5, gusts=(SharpGust(amplitude=3.0, start=0.1),)))
    n = len(system.states)
    both = np.zeros((n + 1, n + 1))
    both[:n, :n], both[:n, n] = system.A, system.B[:, -1] * 3.0
    assert run.history is not None
    seen = run.history.between(0.1, 0.5)
    reference = np.array([(expm(both * (t - 0.1)) @ np.eye(n + 1)[n])[:n] for t in seen.t[::40]])
    names = tuple(system.states[:4])
    got = np.stack([seen[name] for name in names], axis=1)[::40]
    assert largest(got - reference[:, :4], reference[:, :4]) < 1e-9  # stiff lags: more rounding than IDENTITY


def test_gust_rate_terms_are_a_jump_at_the_edge() -> None:
    """BACT's alphadot derivatives see w_g': the rates jump by M^-1 rho b A1/2 times w_g, as linear_system says."""
    bact, condition = model("bact"), FlightCondition(V=100.0, rho=1.0)
    system = av.linear_system(bact, condition)
    scenario = Scenario(profile=level(100.0, density=1.0), duration=0.2, gusts=(SharpGust(amplitude=2.0, start=0.05),))
    run = simulate(bact, scenario)
    got = columns(run)[50]
    np.testing.assert_allclose(got, 2.0 * system.D[:4, 1], atol=1e-15)
    assert abs(got[3]) > 1e-4


def test_accelerometers_feel_the_rate_of_a_smooth_gust() -> None:
    """The acceleration channel is the derivative of the plunge rate through a 1-cosine gust, M^-1 A1 w_g' included."""
    gust = (CosineGust(amplitude=5.0, length=20.0, start=0.05),)
    run = simulate(model("bact"), Scenario(profile=level(100.0, density=1.0), duration=0.4, gusts=gust))
    rate, felt = columns(run, ("plunge_rate_m_s", "acceleration_m_s2")).T
    slope = (8.0 * (rate[3:-1] - rate[1:-3]) - (rate[4:] - rate[:-4])) / (12.0 * run.dt)
    edges = [50, 250]  # where the pulse begins and ends its second derivative jumps
    away = np.all(np.abs(np.arange(2, len(felt) - 2)[:, None] - edges) > 2, axis=1)
    assert np.abs(slope - felt[2:-2])[away].max() < 1e-6 * np.abs(felt).max()


def limited() -> tuple[AeroelasticModel, Controller, np.ndarray]:
    """The thesis' model with a rate- and position-limited actuator and continuous state feedback."""
    servo = Actuator(control="elevon", omega=120.0, zeta=1.0, limit=np.radians(1.5), rate_limit=np.radians(40.0))
    K = np.array([[-6.783, -1.69, -0.573, -0.916]])
    return model(actuators=(servo,)), state_feedback(K, STATES, ("elevon_command_rad",), None), K


def test_limits_on_smooth_inputs_against_dop853() -> None:
    """A 1-cosine gust, saturated command and rate: 1e-6 of each channel; the reference is written out here."""
    plant, controller, K = limited()
    gust = CosineGust(amplitude=4.0, length=12.0, start=0.05)
    V, altitude = 48.0, 3048.0
    scenario = Scenario(profile=level(V, altitude=altitude), duration=2.0, controller=controller, gusts=(gust,))
    run = simulate(plant, scenario, stepping=Stepping(dt=1e-3, substeps=8))
    bare = av.linear_system(plant, FlightCondition.at(altitude, V=V), actuators=False)
    servo = plant.actuators[0]
    assert servo.zeta is not None and servo.limit is not None and servo.rate_limit is not None
    w, zeta, top, fast = servo.omega, servo.zeta, servo.limit, servo.rate_limit
    active = {"rate": 0, "position": 0}

    def wind(t: float) -> float:
        x = V * (t - gust.start)
        return 0.5 * gust.amplitude * (1.0 - np.cos(2.0 * np.pi * x / gust.length)) if 0.0 < x < gust.length else 0.0

    def slope(t: float, z: np.ndarray) -> np.ndarray:
        g = wind(t)
        y = z[:4] + bare.D[:4, 1] * g
        command = float(-(K @ y)[0])
        pull = w / (2.0 * zeta) * (np.clip(command, -top, top) - z[4])
        active["rate"] += abs(pull) > fast
        active["position"] += abs(command) > top
        plant_rate = bare.A @ z[:4] + bare.B[:, 0] * z[4] + bare.B[:, 1] * g
        return np.array([*plant_rate, z[5], 2.0 * zeta * w * (np.clip(pull, -fast, fast) - z[5])])

    assert run.history is not None
    t = run.history.t
    edges = [0.0, gust.start, gust.start + gust.length / V, 2.0]
    z, found = np.zeros(6), [np.zeros((1, 6))]
    for left, right in itertools.pairwise(edges):
        at = t[(t > left + 1e-12) & (t <= right + 1e-12)]
        solution = solve_ivp(slope, (left, right), z, "DOP853", t_eval=at, rtol=1e-11, atol=1e-14, max_step=2e-3)
        found.append(solution.y.T)
        z = solution.y[:, -1] if abs(at[-1] - right) < 1e-9 else solve_ivp(
            slope, (left, right), z, "DOP853", rtol=1e-11, atol=1e-14, max_step=2e-3
        ).y[:, -1]  # fmt: skip
    reference = np.concatenate(found)
    rates = bare.D[:4, 1] * np.array([wind(s) for s in t])[:, None]
    assert active["rate"] > 100 and active["position"] > 100
    got = columns(run, (*STATES, "elevon_rad"))
    expected = np.concatenate([reference[:, :4] + rates, reference[:, 4:5]], axis=1)
    assert largest(got - expected, expected) < 1e-6  # steps end at the corners: about 1e-8
    assert np.abs(run.history["elevon_rad"]).max() <= top * (1.0 + 1e-12)


def hardening(V_ratio: float = 1.0) -> AeroelasticModel:
    """A section whose pitch spring hardens, on quasi-steady air."""
    plant = av.build(av.read("nasa-typical-section"), "quasi_steady_damped")
    return replace(plant, springs=(Spring(mode="pitch", polynomial=(1.0, 0.0, 40.0)),))


def test_order_four() -> None:
    """Errors fall by 2^4 when a smooth nonlinear model is stepped twice as finely."""
    plant = hardening()
    scenario = Scenario(profile=level(25.0), duration=1.0, initial=(("pitch_rad", 0.2),))

    def final(substeps: int) -> np.ndarray:
        run = simulate(plant, scenario, stepping=Stepping(dt=1e-2, substeps=substeps, method="rk4"))
        return columns(run)[-1]

    truth = final(1024)
    errors = [np.abs(final(n) - truth).max() for n in (16, 32, 64)]
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all((orders > 3.8) & (orders < 4.3)), orders


def oscillator(omega: float) -> AeroelasticModel:
    """One undamped mode in still air."""
    one = ModalModel(M=[[1.0]], D=[[0.0]], K=[[omega**2]], names=("plunge",), units=("m",))
    zero = np.zeros((1, 1, 1))
    air = RationalAero(A0=zero, A1=zero, A2=zero, b=1.0, inputs=(AeroInput(name="plunge", kind="mode"),))
    return AeroelasticModel(modes=one, aero=air)


def test_energy_loss_of_an_undamped_mode() -> None:
    """The classical method takes z^6/72 of the energy at each step, z = omega h."""
    omega, dt = 50.0, 2e-3
    scenario = Scenario(profile=level(10.0), duration=4.0, initial=(("plunge_m", 1.0),))
    run = simulate(oscillator(omega), scenario, stepping=Stepping(dt=dt, substeps=1, method="rk4"))
    x = columns(run, ("plunge_m", "plunge_rate_m_s"))
    energy = 0.5 * x[:, 1] ** 2 + 0.5 * (omega * x[:, 0]) ** 2
    loss = 1.0 - (energy[-1] / energy[0]) ** (1.0 / (len(x) - 1))
    assert loss == pytest.approx((omega * dt) ** 6 / 72.0, rel=0.1)


def test_halving_check_says_so_when_it_fails() -> None:
    """A base step far too long for a fast actuator and a hard tolerance: a warning, not silence."""
    scenario = Scenario(profile=level(10.0), duration=1.0, initial=(("plunge_m", 1.0),))
    fine = prepare(oscillator(50.0), scenario, Stepping(method="rk4"))
    assert fine.halving is not None and fine.halving <= 1e-7 and not fine.warnings
    hard = prepare(oscillator(50.0), scenario, Stepping(method="rk4", dt=0.1, tolerance=1e-17))
    assert any("halving" in note for note in hard.warnings)


def test_jacobian_is_the_analytic_linearisation() -> None:
    """About the sagged equilibrium of a hardening BACT: the tangent springs, and weight on a tilted mass."""
    bact = av.build(av.read("bact"))
    springs = (
        Spring(mode="plunge", polynomial=(1.0, 0.5, 30.0), stiffness=float(bact.modes.K[0, 0])),
        Spring(mode="pitch", polynomial=(1.0, 0.0, 2000.0), stiffness=float(bact.modes.K[1, 1])),
    )
    bact, condition = replace(bact, springs=springs), FlightCondition(V=110.0, rho=1.01628)
    s = stepper(bact, condition)
    Z = s.rows(condition[None])[0]
    n_x, n_w, n_s, n_phi, _ = s.sizes
    assert s.equilibrium[0] > 0.01

    def rate(x: np.ndarray) -> np.ndarray:
        xi = np.zeros(Z.shape[1])
        xi[:n_x], xi[-1] = x, 1.0
        memory = np.zeros(n_phi)
        return _kernels.derivative(Z, n_x, n_x + n_w + n_s, s.elements.kinds, s.elements.parameters, memory, xi)

    assert np.abs(rate(s.equilibrium)).max() < 1e-10
    h = 1e-5
    J = np.stack([(rate(s.equilibrium + h * e) - rate(s.equilibrium - h * e)) / (2.0 * h) for e in np.eye(n_x)], axis=1)
    q = s.equilibrium[:2]
    K = np.array(bact.modes.K)
    K[0, 0] *= 1.0 + 2.0 * 0.5 * q[0] + 3.0 * 30.0 * q[0] ** 2
    K[1, 1] *= 1.0 + 3.0 * 2000.0 * q[1] ** 2
    assert bact.gravity is not None
    K[1, 1] += bact.gravity.turning[1] * np.sin(q[1])
    A = av.linear_system(bact.with_K(K), condition).A
    assert np.abs(J - A).max() < 1e-8 * np.abs(A).max()


def test_slow_ramp_is_frozen_speed() -> None:
    """A ramp over a millionth of the speed, through knots and interpolation, against the exact frozen run."""
    plant, start = model(), (("pitch_rad", 0.01),)
    frozen = simulate(plant, Scenario(profile=level(40.0, altitude=1000.0), duration=2.0, initial=start))
    ramp = Profile(t=[0.0, 2.0], V=[40.0, 40.00004], altitude=[1000.0, 1000.001])
    moving = simulate(plant, Scenario(profile=ramp, duration=2.0, initial=start))
    assert (frozen.method, moving.method) == ("exact", "rk4")
    assert largest(columns(moving) - columns(frozen), columns(frozen)) < 1e-5


def test_ramp_follows_the_eigenvalues() -> None:
    """ln of the envelope along 38 -> 41 m/s is the integral of Re(lambda - l r'/(l r)) of the least damped mode.

    l and r are its left and right eigenvectors at the speed of the moment, pitch of r being 1 (adiabatic theorem, first
    order in the ramp).
    """
    plant = model()
    ramp = Profile(t=[0.0, 60.0], V=[38.0, 41.0], altitude=[0.0, 0.0])
    run = simulate(plant, Scenario(profile=ramp, duration=60.0, initial=(("pitch_rad", 0.01),)))
    assert run.history is not None
    V = np.linspace(38.0, 41.0, 3001)
    A = av.linear_system(plant, FlightCondition.at(0.0, V=V)).A
    roots, right = np.linalg.eig(A)
    at = np.arange(len(V)), np.argmax(np.where(roots.imag > 0.0, roots.real, -np.inf), axis=1)
    left = np.linalg.inv(right)[at]
    r = right[at[0], :, at[1]]
    left, r = left * r[:, [1]], r / r[:, [1]]
    t = 20.0 * (V - 38.0)
    slope = (roots[at] - np.sum(left * np.gradient(r, t, axis=0), axis=1)).real
    y, when = run.history["pitch_rad"], run.history.t
    crossings = np.flatnonzero((y[:-1] < 0.0) & (y[1:] >= 0.0))

    def amplitude(time: float) -> tuple[float, float]:
        """Middle and pitch amplitude of the period before a time."""
        i, k = crossings[crossings < round(time / (when[1] - when[0]))][-2:]
        return float(0.5 * (when[i] + when[k])), float(np.sqrt(2.0 * np.mean(y[i:k] ** 2)))

    (begin, first), (end, last) = amplitude(20.0), amplitude(55.0)
    inside = (t >= begin) & (t <= end)
    expected = np.trapezoid(slope[inside], t[inside])
    assert np.log(last / first) == pytest.approx(expected, abs=0.01)
    assert abs(expected) > 0.3


def test_held_samples_stay_held_when_the_step_is_halved() -> None:
    """Turbulence and noise on the base grid: exact steps, and Runge-Kutta with 1, 2 and 4 substeps, are one response.

    Noise read by time index inside the stages made the response 2.09 times as large.
    """
    plant = model()
    scenario = Scenario(profile=level(38.0), duration=5.0, turbulence=Gustiness(level=2.0))
    exact = columns(simulate(plant, scenario, seed=4))
    for substeps in (1, 2, 4):
        stepping = Stepping(method="rk4", substeps=substeps)
        assert largest(columns(simulate(plant, scenario, seed=4, stepping=stepping)) - exact, exact) < 1e-7


def test_rms_in_turbulence_is_lyapunovs() -> None:
    """Twelve seeds of 300 s against the covariance of plant and Dryden filter together."""
    plant, V = model(), 36.0
    scenario = Scenario(profile=level(V), duration=300.0, turbulence=Gustiness(level=1.5))
    prepared = prepare(plant, scenario, Stepping(history=False))
    from aeroservo.simulate.engine import run_prepared

    runs = [run_prepared(prepared, seed=seed) for seed in range(12)]
    system = av.linear_system(plant, FlightCondition.at(0.0, V=V))
    filters = shaping_filter(constant_turbulence(1.5), V)
    row = filters.outputs.index("w_g_m_s")
    C = filters.C[row : row + 1]
    none = np.zeros((4, 1)), np.zeros((1, filters.B.shape[1]))
    wanted = rms_response((system.A, system.B[:, 1:], np.eye(4), none[0]), (filters.A, filters.B, C, none[1]))
    channel = runs[0].channels.index("pitch_rad")
    got = np.sqrt(np.mean([run.rms[channel] ** 2 for run in runs]))
    assert got == pytest.approx(float(np.ravel(wanted)[1]), rel=0.06)


def sampled_reference(
    plant: AeroelasticModel, c: Controller, V: float, duration: float, dt: float, delay: int
) -> tuple[np.ndarray, np.ndarray]:
    """The sampled loop written out on the base grid, exact between commands."""
    system = av.linear_system(plant, FlightCondition.at(0.0, V=V))
    n = len(system.states)
    both = np.zeros((n + 1, n + 1))
    both[:n, :n], both[:n, n] = system.A, system.B[:, 0]
    step = expm(both * dt)
    assert c.dt_s is not None
    period = round(c.dt_s / dt)
    x, xc = np.zeros(n), np.zeros(c.A.shape[-1])
    x[1] = 0.02
    commands, states, latest = [], [], 0.0
    for k in range(round(duration / dt) + 1):
        if k % period == 0:
            y = np.round(x[:4] / 1e-5) * 1e-5
            latest = float(np.clip((c.C[0] @ xc + c.D[0] @ y)[0], -c.limits[0], c.limits[0]))
            xc = c.A[0] @ xc + c.B[0] @ y
        commands.append(latest)
        states.append(x[:4].copy())
        u = commands[k - delay] if k >= delay else 0.0
        x = step[:n, :n] @ x + step[:n, n] * u
    return np.array(states), np.array(commands)


def test_sampled_controller_with_delay_quantiser_and_limit() -> None:
    """A dynamic 200 Hz controller, 3 ms of computing, quantised sensors: equal to the loop written out."""
    rng = np.random.default_rng(5)
    c = Controller(
        A=np.diag([0.5, -0.3]),
        B=0.2 * rng.standard_normal((2, 4)),
        C=rng.standard_normal((1, 2)),
        D=[[1.0, 0.4, 0.2, 0.3]],
        inputs=("h", "theta", "h_rate", "theta_rate"),
        outputs=("elevon_command_rad",),
        dt_s=0.005,
        delay_s=0.003,
        limits=(0.01,),
    )
    from aeroservo.servo import Sensor

    rows = {"h": (1.0, 0.0), "theta": (0.0, 1.0)}
    sensors = [Sensor(name=k, unit="m" if k == "h" else "rad", displacement=v, quantum=1e-5) for k, v in rows.items()]
    sensors += [Sensor(name=f"{k}_rate", unit="x", rate=v, quantum=1e-5) for k, v in rows.items()]
    plant = model(sensors=tuple(sensors))
    scenario = Scenario(profile=level(38.0), duration=1.0, controller=c, initial=(("pitch_rad", 0.02),))
    run = simulate(plant, scenario)
    reference, commands = sampled_reference(plant, c, 38.0, 1.0, run.dt, 3)
    assert run.method == "exact"
    assert np.abs(commands).max() == pytest.approx(0.01)
    assert largest(columns(run) - reference, reference) < 1e-9
    assert run.history is not None
    np.testing.assert_allclose(run.history["elevon_command_rad"][3:], commands[:-3], atol=1e-13)


def test_sensor_delay_and_dead_time() -> None:
    """A delay in the sensor, in the computer or in the actuator is the same delay once the loop is closed."""
    from aeroservo.servo import Sensor

    def run(sensor: float, computing: float, dead: float) -> np.ndarray:
        gyro = Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0), delay_s=sensor)
        servo = Actuator(control="elevon", omega=200.0, zeta=0.7, delay_s=dead)
        c = Controller(
            A=[], B=[], C=[], D=[[0.3]], inputs=("gyro",), outputs=("elevon_command_rad",), dt_s=0.01, delay_s=computing
        )
        start = (("pitch_rate_rad_s", 0.5),)
        scenario = Scenario(profile=level(35.0), duration=1.0, controller=c, initial=start)
        return columns(simulate(model(sensors=(gyro,), actuators=(servo,)), scenario))

    computer, actuator = run(0.0, 0.004, 0.0), run(0.0, 0.0, 0.004)
    np.testing.assert_allclose(computer, actuator, atol=1e-14)
    assert largest(computer - run(0.0, 0.0, 0.0), computer) > 1e-3
    both = run(0.01, 0.0, 0.0)  # one sample late: the first command is that of the start, held once more
    assert largest(both - run(0.0, 0.0, 0.0), both) > 1e-3


def test_actuator_keeps_its_limits() -> None:
    """A soft actuator thrown about by a doublet: hard stop, rate limit; first order too."""
    for zeta in (0.3, None):
        servo = Actuator(control="elevon", omega=60.0, zeta=zeta, limit=0.1, rate_limit=2.0, gain=3.0)
        doublet = Doublet(amplitude=0.3, start=0.1, duration=0.6)
        run = simulate(model(actuators=(servo,)), Scenario(profile=level(30.0), duration=1.0, doublets=(doublet,)))
        delta = columns(run, ("elevon_rad",))[:, 0]
        assert np.abs(delta).max() == pytest.approx(0.1, rel=1e-3) and np.abs(delta).max() <= 0.1 * (1.0 + 1e-12)
        assert np.abs(np.diff(delta)).max() / run.dt <= 2.0 * (1.0 + 1e-9)
        assert np.abs(np.diff(delta)).max() / run.dt > 1.9


def test_backlash_is_a_play() -> None:
    """Behind a play of +-g the surface lags the actuator by g in the sense of its motion, and rests on reversals."""
    g = 0.01
    servo = Actuator(control="elevon", omega=80.0, zeta=1.0, backlash=g)
    sharp = Actuator(control="elevon", omega=80.0, zeta=1.0)
    doublet = Doublet(amplitude=0.1, start=0.1, duration=0.8)
    scenario = Scenario(profile=level(20.0), duration=1.5, doublets=(doublet,))
    loose = columns(simulate(model(actuators=(servo,)), scenario), ("elevon_rad",))[:, 0]
    tight = columns(simulate(model(actuators=(sharp,)), scenario), ("elevon_rad",))[:, 0]
    expected, at = [], 0.0
    for x in tight:
        at = min(max(at, x - g), x + g)
        expected.append(at)
    assert np.abs(loose - expected).max() < 2e-4
    assert loose[-1] == pytest.approx(-g, abs=1e-6)


def test_freeplay_and_lift_table() -> None:
    """Inside the gap the spring is not there; a straight table changes nothing; a stalled one holds the lift down."""
    y = np.array([-0.03, -0.01, 0.0, 0.005, 0.02])
    K, gap, c = 5.0, 0.01, (1.0, 0.0, 7.0)
    parameters = np.array([[K * c[0], gap, K, 3.0, *c]])
    value = np.array([_kernels.element(_kernels.SPRING, x, parameters, 0, 0.0) for x in y])
    inner = np.sign(y) * np.maximum(np.abs(y) - gap, 0.0)
    np.testing.assert_allclose(value, K * y - K * (c[0] + c[2] * inner**2) * inner, atol=1e-15)

    file = av.read("thesis-simulation")

    def run(table: list[list[float]]) -> np.ndarray:
        from aeroservo.aircraft.files import validate

        data = file.model_dump(exclude_none=True, exclude={"limits", "comparison"}) | {
            "nonlinear": {"CL_alpha_table": table}
        }
        plant = replace(av.build(validate(data, "test")), limits=())
        gust = (CosineGust(amplitude=8.0, length=8.0, start=0.05),)
        return columns(simulate(plant, Scenario(profile=level(30.0), duration=1.0, gusts=gust)))

    slope = 3.68 * np.pi / 180.0
    straight = run([[-90.0, -90.0 * slope], [90.0, 90.0 * slope]])
    linear = columns(
        simulate(
            replace(av.build(file), limits=()),
            Scenario(profile=level(30.0), duration=1.0, gusts=(CosineGust(amplitude=8.0, length=8.0, start=0.05),)),
        )
    )
    assert largest(straight - linear, linear) < 1e-9
    stalled = run([[-90.0, -5.0 * slope], [-5.0, -5.0 * slope], [5.0, 5.0 * slope], [90.0, 5.0 * slope]])
    assert np.abs(stalled[:200, 0]).max() < 0.8 * np.abs(linear[:200, 0]).max()


@pytest.mark.parametrize("factor", [1.02, 1.1, 1.3])
def test_limit_cycle_of_a_hardening_section(factor: float) -> None:
    """K (1 + 40 theta^2) theta, Jones' two lags: fundamental within 2 % of the describing function K (1 + 30 A^2).

    The amplitude A is where the linear model on that stiffness is neutral at factor times its flutter speed. Inputs:
    mass ratio 20 at sea level, b = 0.3 m, x_alpha = 0.2, r_alpha^2 = 0.25, omega_h/omega_alpha = 0.6, axis at 35 %. The
    difference is the describing function's: it grows with the square of the amplitude (0.08, 0.6, 1.7 %).
    """
    from aeroservo.aircraft.files import validate

    b, mass, omega = 0.3, 20.0 * np.pi * 1.225 * 0.3**2, 30.0
    section = {
        "chord_m": 2.0 * b,
        "flexural_axis": 0.35,
        "mass_kg_per_m": mass,
        "static_moment_kg": mass * 0.2 * b,
        "inertia_kg_m": mass * 0.25 * b**2,
        "plunge_stiffness_N_per_m2": mass * (0.6 * omega) ** 2,
        "pitch_stiffness_N": mass * 0.25 * b**2 * omega**2,
        "nonlinear": {"pitch_stiffness_polynomial": [1.0, 0.0, 40.0]},
    }
    plant = av.build(validate({"kind": "typical_section", "section": section}, "test"), "jones")
    assert len(plant.springs) > 0
    flutter = av.flutter(plant, FlightCondition.at(0.0, V=np.arange(5.0, 60.0, 0.5)), av.P())
    assert flutter.flutter_speed is not None
    V = factor * flutter.flutter_speed

    def growth(A: float) -> float:
        K = np.array(plant.modes.K)
        K[1, 1] *= 1.0 + 30.0 * A**2
        return float(np.linalg.eigvals(av.linear_system(plant.with_K(K), FlightCondition.at(0.0, V=V)).A).real.max())

    from scipy.optimize import brentq

    A = brentq(growth, 1e-4, 1.0)
    run = simulate(plant, Scenario(profile=level(V), duration=40.0, initial=(("pitch_rad", 0.9 * A),)))
    assert run.limit_cycle is not None and run.bounded
    assert run.limit_cycle.fundamental == pytest.approx(A, rel=0.02)


def test_limits_and_overflow_stop_cleanly() -> None:
    """Time and channel of a limit left; numbers that run away are caught; nothing is ever NaN."""
    plant = av.build(av.read("thesis-simulation"))
    start = (("pitch_rad", 0.01),)
    run = simulate(plant, Scenario(profile=level(60.0), duration=30.0, initial=start))
    assert run.limit_left is not None and run.limit_left.channel == "pitch_rad" and not run.bounded
    assert run.history is not None and run.history.t[-1] <= run.limit_left.at_s == run.duration < 30.0
    assert np.abs(run.history["pitch_rad"]).max() <= 1.05 * np.pi
    wild = simulate(replace(plant, limits=()), Scenario(profile=level(140.0), duration=300.0, initial=start))
    assert wild.overflow_at is not None and wild.overflow_at == wild.duration < 300.0 and not wild.bounded
    assert wild.history is not None and np.all(np.isfinite(wild.history.data)) and np.all(np.isfinite(wild.rms))
    assert "overflow" in wild.history.events[0].text


def test_pieces_do_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    """A climb with turbulence, sensor noise and delays, computed in pieces of 20,000 and of 777 steps."""
    from aeroservo.servo import Sensor
    from aeroservo.simulate import engine

    gyro = Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0), noise=1e-3, delay_s=0.002)
    c = Controller(
        A=[[0.9]], B=[[1.0]], C=[[0.01]], D=[[0.05]], inputs=("gyro",), outputs=("elevon_command_rad",),
        dt_s=0.005, delay_s=0.002,
    )  # fmt: skip
    profile = climb(V=(30.0, 34.0), altitude=(0.0, 200.0), duration=4.0)
    scenario = Scenario(
        profile=profile, duration=4.0, controller=c, gusts=(SharpGust(amplitude=1.0, start=1.2345),),
    )  # fmt: skip
    whole = columns(simulate(model(sensors=(gyro,)), scenario, seed=11))
    monkeypatch.setattr(engine, "PIECE", 777)
    parts = columns(simulate(model(sensors=(gyro,)), scenario, seed=11))
    np.testing.assert_array_equal(parts, whole)
    frozen = replace(scenario, profile=level(32.0), turbulence=Gustiness(level=1.0))
    parts = columns(simulate(model(sensors=(gyro,)), frozen, seed=11))
    monkeypatch.setattr(engine, "PIECE", 20_000)
    np.testing.assert_array_equal(columns(simulate(model(sensors=(gyro,)), frozen, seed=11)), parts)


def test_refusals() -> None:
    """What the engine cannot do it says, by name."""
    plant = model()
    flight = level(30.0)
    with pytest.raises(ValueError, match="no state"):
        simulate(plant, Scenario(profile=flight, duration=1.0, initial=(("pitch", 0.1),)))
    with pytest.raises(ValueError, match="method 'exact' needs"):
        simulate(hardening(), Scenario(profile=flight, duration=1.0), stepping=Stepping(method="exact"))
    with pytest.raises(ValueError, match="gust"):
        simulate(oscillator(5.0), Scenario(profile=flight, duration=1.0, gusts=(SharpGust(amplitude=1.0, start=0.0),)))
    with pytest.raises(ValueError, match="no channel"):
        c = state_feedback(np.ones((1, 1)), ("roll_rad",), ("elevon_command_rad",), 0.01)
        simulate(plant, Scenario(profile=flight, duration=1.0, controller=c))
    with pytest.raises(ValueError, match="relative degree"):
        simulate(model("bact", actuators=()), Scenario(profile=flight, duration=1.0))
    with pytest.raises(ValueError, match="accelerometer"):
        c = state_feedback(np.ones((1, 1)), ("acc_te",), ("elevon_command_rad",), None)
        simulate(model("bact"), Scenario(profile=flight, duration=1.0, controller=c))


def test_a_spring_without_a_linear_part() -> None:
    """c0 = 0: the cubic spring of a file, next to no air: its period is Gamma(1/4)^2/(sqrt(pi k) amplitude)."""
    from scipy.special import gamma

    from aeroservo.aircraft.files import validate

    inertia, K, c2, amplitude = 0.84, 8400.0, 20.0, 0.05
    data = {
        "kind": "typical_section",
        "section": {
            "chord_m": 0.6, "flexural_axis": 0.4, "mass_kg_per_m": 36.0, "static_moment_kg": 0.0,
            "inertia_kg_m": inertia, "plunge_stiffness_N_per_m2": 9e4, "pitch_stiffness_N": K,
            "nonlinear": {"pitch_stiffness_polynomial": [0.0, 0.0, c2]},
        },
    }  # fmt: skip
    plant = av.build(validate(data, "cubic"), "jones")
    assert plant.modes.K[1, 1] == 0.0
    period = gamma(0.25) ** 2 / np.sqrt(np.pi * K * c2 / inertia) / amplitude  # of x'' + k x^3 = 0
    flight = level(30.0, density=1e-9, altitude=None)
    scenario = Scenario(profile=flight, duration=3.0 * period, initial=(("pitch_rad", amplitude),))
    run = simulate(plant, scenario, stepping=Stepping(record_s=1e-3))
    assert run.history is not None
    t, x = run.history.t, run.history["pitch_rad"]
    falls = np.flatnonzero((x[:-1] > 0.0) & (x[1:] <= 0.0))
    crossings = t[falls] + x[falls] / (x[falls] - x[falls + 1]) * (t[1] - t[0])
    assert np.diff(crossings) == pytest.approx(period, rel=1e-5)
    assert crossings[0] == pytest.approx(period / 4.0, rel=1e-5)
