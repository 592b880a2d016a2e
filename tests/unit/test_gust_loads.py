"""Gust loads of whole models: root loads, two routes to the RMS, BACT in turbulence, ten gradients in one call."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

import aeroservo as av
from aeroservo.aeroelastic import build_beam
from aeroservo.aeroelastic.aircraft_wing import aircraft_wing
from aeroservo.aeroelastic.build_beam import beam_wing
from aeroservo.aircraft.files import read
from aeroservo.atmosphere import STANDARD_GRAVITY
from aeroservo.control.controller import Controller
from aeroservo.datatypes import AeroelasticModel, AeroInput, FlightCondition, LinearSystem, ModalModel, RationalAero
from aeroservo.gust.design_gusts import cs25_gradients
from aeroservo.gust.intensity import constant_turbulence
from aeroservo.gust.turbulence import cs25_turbulence, vertical_filter
from aeroservo.simulate.disturbances import CosineGust, Gustiness
from aeroservo.simulate.engine import run_prepared, simulate
from aeroservo.simulate.prepare import prepare
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario, Stepping
from aeroservo.structure.beam import beam_modes
from aeroservo.structure.modal import tip_motion
from aeroservo.studies.gust_loads import design_velocity, gust_loads, turbulence_rms
from aeroservo.studies.gust_plant import gust_plant
from aeroservo.studies.root_loads import ROOT, with_loads

IDENTITY = 1e-9
#: The engine steps the same rows with another step: 1 ms, and peaks at its samples.
ENGINE = 2e-4
#: Von Karman's filter is within 0.5 % in power.
FIT = 2.5e-3


def plant_of(name: str, V: float, rho: float = 1.225, aero: str | None = None):
    """Plant of a preset with its loads."""
    model, loads = with_loads(read(name), aero)
    return gust_plant(model, FlightCondition(V=V, rho=rho), loads=loads), model


@pytest.mark.parametrize(
    ("name", "V", "aero"),
    [("bact", 90.0, None), ("thesis-binary", 40.0, "jones"), ("nasa-typical-section", 40.0, "jones"),
     ("thesis-simulation", 38.0, None), ("thesis-aircraft", 30.0, None), ("goland", 90.0, "jones")],
)  # fmt: skip
def test_peaks_are_those_of_the_engine(name: str, V: float, aero: str | None) -> None:
    """One gust through the simulation engine and through the plant: every channel that both have."""
    model = av.build(read(name), aero)
    plain = replace(model, springs=(), lift_curve=None, gravity=None)
    plant = gust_plant(model, FlightCondition(V=V, rho=1.0))
    found = gust_loads(plant, gradients=[12.0], velocity=lambda H: 3.0 + 0.0 * np.asarray(H), bounds=None)
    gust = CosineGust(amplitude=3.0, length=24.0, start=0.0)
    run = simulate(plain, Scenario(profile=level(V, density=1.0), duration=24.0 / V + 3.0, gusts=(gust,)))
    both = [c for c in run.channels if c in plant.outputs]
    assert len(both) >= 5
    for channel in both:
        got, wanted = found.peak[0, plant.outputs.index(channel)], run.peak[run.channels.index(channel)]
        assert got == pytest.approx(wanted, rel=ENGINE, abs=1e-12), channel


@pytest.mark.parametrize("name", ["goland", "thesis-uav"])
def test_root_loads_of_a_steady_gust_are_the_strips_own(name: str) -> None:
    """Shear is the lift, bending the rolling moment about the root, of the bent and twisted wing; inertia is weight."""
    plant, model = plant_of(name, 60.0)
    _, loads = with_loads(read(name))
    assert loads is not None
    np.testing.assert_allclose(loads.inertia[0] * STANDARD_GRAVITY, model.loads.weight, rtol=1e-9)
    x = -np.linalg.solve(plant.A, plant.B[:, 0])
    y = dict(zip(plant.outputs, plant.C @ x + plant.D[:, 0]))
    u = np.zeros(len(model.aero.inputs))
    u[: model.modes.n], u[model.columns("gust")[0]] = x[: model.modes.n], 1.0 / plant.V
    q = 0.5 * 1.225 * plant.V**2
    assert y["root_shear_N"] == pytest.approx(q * model.loads.row("lift") @ u, rel=IDENTITY)
    assert y["root_bending_N_m"] == pytest.approx(q * model.loads.row("roll") @ u, rel=IDENTITY)
    assert y["tip_plunge_m"] < 0.0 < y["tip_twist_rad"] and y["root_bending_N_m"] > 0.0


@pytest.mark.parametrize("name", ["goland", "thesis-uav"])
def test_root_loads_of_free_vibration_are_the_strains_at_the_root(name: str) -> None:
    """Mode by mode: -M_r q'' is EI times the curvature, GJ times the rate of twist, of that mode at the root."""
    file = read(name)
    wing = beam_wing(file) if name == "goland" else aircraft_wing(file)
    _, loads = with_loads(file)
    assert loads is not None and loads.names == ROOT
    beam, n = wing.beam, 6
    inner = beam.y[0] + np.linspace(0.0, (beam.y[1] - beam.y[0]) / 80.0, 5)  # within the first element: polynomials
    found = beam_modes(beam, n=n, points=inner, elements=40)
    EI, GJ = (float(beam.at(what, inner[:1])[0]) for what in ("EI", "GJ"))
    sweep = float(beam.at("sweep", inner[:1])[0])
    for j in range(n):
        force = loads.inertia[:, j] * -(found.omega[j] ** 2)
        bend, twist = (np.polynomial.polynomial.polyfit(inner, f[:, j], 4)[1] for f in (found.slope, found.twist))
        M, T = -EI * bend, GJ * twist  # h down: a tip that bends up has a negative slope
        about = np.array([M * np.cos(sweep) + T * np.sin(sweep), T * np.cos(sweep) - M * np.sin(sweep)])
        np.testing.assert_allclose(force[1:], about, rtol=2e-5, atol=2e-5 * np.abs(about).max())


@pytest.mark.parametrize(("H", "dt"), [(10.0, 1e-3), (107.0, 2.5e-3)])
def test_peaks_against_the_exact_functions_by_fft(H: float, dt: float) -> None:
    """Goland at 100 m/s on exact Theodorsen and Sears, harmonic by harmonic: the fit is within 0.1 %, Jones 3 %."""
    V, n_t = 100.0, 2**15
    condition, model = FlightCondition.at(0.0, V=V), av.build(read("goland"))
    n, gust = model.modes.n, model.columns("gust")[0]
    t = dt * np.arange(n_t)
    w = np.where(V * t < 2.0 * H, 0.5 * (1.0 - np.cos(np.pi * V * t / H)), 0.0)
    omega, q = 2.0 * np.pi * np.fft.rfftfreq(n_t, dt), float(condition.q)
    Q = model.aero(omega * model.aero.b / V)
    Z = -(omega[:, None, None] ** 2) * model.modes.M + model.modes.K - q * Q[:, :, :n]
    X = np.linalg.solve(Z, (q / V * Q[:, :, gust])[:, :, None])[:, :, 0]
    exact = np.abs(np.fft.irfft(X @ tip_motion(model.modes)[0] * np.fft.rfft(w), n_t)).max()
    for aero, bound in ((None, 1e-3), ("jones", 3e-2)):
        plant, _ = plant_of("goland", V, float(condition.rho), aero)
        found = gust_loads(plant, gradients=[H], velocity=lambda H: np.ones(1), bounds=None)
        assert found.peak[0, plant.outputs.index("tip_plunge_m")] == pytest.approx(exact, rel=bound)


def test_lumps_beyond_the_root_count_and_those_at_it_do_not() -> None:
    """An engine half way out is in shear and moments; a fuselage at the root is inboard of the cut."""
    file = read("goland")
    bare, _ = with_loads(file)
    lumps = (
        {"y_m": 3.0, "x_m": -0.4, "mass_kg": 20.0, "inertia_kg_m2": 1.5},
        {"y_m": 0.0, "x_m": 0.0, "mass_kg": 500.0, "inertia_kg_m2": 9.0},
    )
    with_lumps = type(file).model_validate(file.model_dump() | {"wing": file.wing.model_dump() | {"mass": lumps}})
    model, loads = with_loads(with_lumps)
    assert loads is not None and bare.modes.n == model.modes.n
    np.testing.assert_allclose(loads.inertia[0] * STANDARD_GRAVITY, model.loads.weight, rtol=1e-9)  # root: h = 0 there
    found = beam_modes(beam_wing(with_lumps).beam, n=2, points=np.linspace(0.0, 0.05, 5), elements=40)
    for j in range(2):
        bend = np.polynomial.polynomial.polyfit(found.y, found.slope[:, j], 4)[1]
        assert -(found.omega[j] ** 2) * loads.inertia[1, j] == pytest.approx(-9.773e6 * bend, rel=1e-4)


def test_notes_of_speed_and_springs() -> None:
    """Beyond Mach 0.3, and a section whose springs are not straight."""
    fast, _ = plant_of("goland", 110.0)
    assert "speeds above Mach 0.3: incompressible theory" in fast.notes
    file = read("nasa-typical-section")
    bent = file.section.model_dump() | {"nonlinear": {"pitch_stiffness_polynomial": [1.0, 0.0, 3.0]}}
    model, _ = with_loads(type(file).model_validate(file.model_dump() | {"section": bent}))
    assert model.springs
    assert any("nonlinear springs" in note for note in gust_plant(model, FlightCondition(V=30.0, rho=1.0)).notes)


def test_springs_of_sections() -> None:
    """Their forces are K q."""
    for name, force in (("nasa-typical-section", "plunge_spring_N_per_m"), ("bact", "plunge_spring_N")):
        plant, model = plant_of(name, 40.0)
        i, j = plant.outputs.index(force), plant.outputs.index("plunge_m")
        np.testing.assert_allclose(plant.C[i], model.modes.K[0, 0] * plant.C[j] + model.modes.K[0, 1] * plant.C[j + 1])


@pytest.mark.parametrize("model", ["dryden", "von_karman"])
@pytest.mark.parametrize(
    ("name", "V"),
    [("bact", 90.0), ("goland", 110.0), ("thesis-binary", 40.0), ("thesis-uav", 45.0), ("thesis-aircraft", 40.0)],
)
def test_rms_two_ways(name: str, V: float, model) -> None:
    """Lyapunov's equation with the filter, and the frequency integral under the exact spectrum."""
    plant, _ = plant_of(name, V)
    state = constant_turbulence(1.0) if model == "dryden" else cs25_turbulence()
    exact, integral, infinite = turbulence_rms(plant, state, model)
    finite = np.isfinite(exact)
    assert set(infinite) == {name for name, ok in zip(plant.outputs, finite) if not ok}
    moving = finite & (exact > 0.0)
    np.testing.assert_allclose(integral[moving], exact[moving], rtol=FIT if model == "von_karman" else 4e-4)
    assert exact[plant.outputs.index("gust_m_s")] == pytest.approx(1.0, abs=5e-4)


def test_bact_below_flutter_in_simulated_turbulence() -> None:
    """RMS over sixteen runs of 120 s against Lyapunov's, within 3 standard errors of the sixteen; BACT at 90 m/s.

    Runs are independent (other seeds, the filter stationary from the start, the plant after 20 s), so the error of the
    mean square is their scatter over the root of sixteen; a false alarm in any of four channels has a chance of 1 %.
    """
    V, runs, settling = 90.0, 16, 20.0
    model = av.build(read("bact"))
    plant = gust_plant(model, FlightCondition(V=V, rho=1.01628))
    exact, _, _ = turbulence_rms(plant, constant_turbulence(1.0))
    scenario = Scenario(profile=level(V, density=1.01628), duration=140.0, turbulence=Gustiness(level=1.0))
    prepared = prepare(model, scenario, Stepping(record_s=0.005))
    channels = ("plunge_m", "pitch_rad", "plunge_rate_m_s", "pitch_rate_rad_s")
    squares = np.empty((runs, len(channels)))
    for seed in range(runs):
        history = run_prepared(prepared, seed=seed).history
        assert history is not None
        late = history.t >= settling
        squares[seed] = [np.mean(history[c][late] ** 2) for c in channels]
    wanted = np.array([exact[plant.outputs.index(c)] ** 2 for c in channels])
    error = squares.std(axis=0, ddof=1) / np.sqrt(runs)
    assert np.all(np.abs(squares.mean(axis=0) - wanted) < 3.0 * error)
    assert np.all(error < 0.1 * wanted)  # and the bound means something


def test_ten_cs25_gradients_on_twenty_modes_in_one_call(monkeypatch: pytest.MonkeyPatch) -> None:
    """Goland's wing in twenty modes, 100 m/s: 0.6 s of one core; each number as from a call of its own."""
    monkeypatch.setattr(build_beam, "BEAM_MODES", 20)
    model, loads = with_loads(read("goland"))
    assert model.modes.n == 20
    plant = gust_plant(model, FlightCondition.at(0.0, V=100.0), loads=loads)
    H, velocity = cs25_gradients(10), design_velocity("cs25", altitude=0.0, density=1.225)
    start = time.process_time()
    together = gust_loads(plant, gradients=H, velocity=velocity, bounds=None)
    elapsed = time.process_time() - start
    assert elapsed < 10.0  # of this process: 0.6 s; a wide margin for other machines
    assert together.peak.shape == (10, len(plant.outputs)) and np.all(np.isfinite(together.peak))
    root = plant.outputs.index("root_bending_N_m")
    for i in (0, 4, 9):
        alone = gust_loads(plant, gradients=H[i], velocity=velocity, bounds=None)
        np.testing.assert_allclose(together.peak[i, root], alone.peak[0, root], rtol=1e-6)
    monkeypatch.setattr(build_beam, "BEAM_MODES", 10)
    fewer, _ = plant_of("goland", 100.0)
    ten = gust_loads(fewer, gradients=H, velocity=velocity, bounds=None)
    np.testing.assert_allclose(ten.peak[:, fewer.outputs.index("root_bending_N_m")], together.peak[:, root], rtol=2e-3)


def test_unstable_models_have_no_answer_and_say_so() -> None:
    """Goland beyond flutter: nan everywhere, a note, no exception."""
    plant, _ = plant_of("goland", 160.0)
    found = gust_loads(plant, gradients=[10.0, 50.0], velocity=design_velocity("unit", altitude=None, density=1.0))
    assert not found.stable and found.critical is None
    assert np.all(np.isnan(found.peak)) and np.all(np.isnan(found.rms))
    assert "unstable at 160 m/s" in found.notes[-1]


def test_displacements_that_nothing_brings_back_are_left_out() -> None:
    """Heave of the free aircraft drifts; its rate does not, and long gusts carry the aircraft along."""
    plant, _ = plant_of("thesis-aircraft", 30.0)
    assert plant.drifting == ("heave_m",) and "heave_m" not in plant.outputs
    assert "nothing brings it back" in plant.notes[-1]
    rate = plant.outputs.index("heave_rate_m_s")
    found = gust_loads(
        plant, gradients=[5e3], velocity=design_velocity("unit", altitude=None, density=1.0), bounds=None
    )
    assert found.peak[0, rate] == pytest.approx(1.0, rel=1e-2)


def test_a_continuous_controller_closes_the_loop() -> None:
    """Feedback of pitch rate: the closed plant is the open one with the gain in it; BACT's actuator lies between."""
    model = av.build(read("bact"))
    condition = FlightCondition(V=90.0, rho=1.01628)
    gain = Controller(
        A=np.zeros((0, 0)), B=np.zeros((0, 0)), C=np.zeros((0, 0)), D=np.array([[0.05]]),
        inputs=("pitch_rate_rad_s",), outputs=("elevon_command_rad",),
    )  # fmt: skip
    closed = gust_plant(model, condition, controller=gain)
    system = av.linear_system(model, condition)
    i, j = system.inputs.index("elevon_command_rad"), system.outputs.index("pitch_rate_rad_s")
    expected = np.linalg.eigvals(system.A + 0.05 * np.outer(system.B[:, i], system.C[j]))
    for root in np.linalg.eigvals(closed.A):
        assert np.abs(expected - root).min() < 1e-8 * np.abs(expected).max()
    elevon = closed.outputs.index("elevon_rad")
    velocity = design_velocity("unit", altitude=None, density=1.0)
    assert gust_loads(closed, gradients=[10.0], velocity=velocity, bounds=None).peak[0, elevon] > 0.0
    with pytest.raises(ValueError, match=r"continuous controller .* use `sampled_gust_loads`"):
        gust_plant(model, condition, controller=replace(gain, dt_s=0.01))


def test_lagging_accelerometers_feel_the_gust_rate() -> None:
    """A sensor with a bandwidth whose input holds w': the same peak as the engine's."""
    model = av.build(read("bact"))
    sensors = tuple(replace(s, bandwidth=60.0) for s in model.sensors)
    model = replace(model, sensors=sensors)
    plant = gust_plant(model, FlightCondition(V=80.0, rho=1.0))
    found = gust_loads(
        plant, gradients=[5.0], velocity=design_velocity("unit", altitude=None, density=1.0), bounds=None
    )
    gust = CosineGust(amplitude=1.0, length=10.0, start=0.0)
    run = simulate(model, Scenario(profile=level(80.0, density=1.0), duration=3.0, gusts=(gust,)))
    for s in sensors:
        wanted = run.peak[run.channels.index(s.channel)]
        assert found.peak[0, plant.outputs.index(s.channel)] == pytest.approx(wanted, rel=1e-3)
        assert np.isfinite(found.rms[plant.outputs.index(s.channel)])


def two_zones(distance: float) -> AeroelasticModel:
    """A plunging mass with a fore and an aft wing: two gust columns, the second `distance` behind."""
    one = np.ones((1, 1))
    modes = ModalModel(M=2.0 * one, D=3.0 * one, K=180.0 * one, names=("plunge",), units=("m",))
    inputs = (
        AeroInput(name="plunge", kind="mode"), AeroInput(name="gust_front", kind="gust"),
        AeroInput(name="gust_rear", kind="gust", x_offset=distance),
    )  # fmt: skip
    A0, none = np.array([[[0.0, -0.5, -0.3]]]), np.zeros((1, 1, 3))
    return AeroelasticModel(modes=modes, aero=RationalAero(A0=A0, A1=none, A2=none, b=0.5, inputs=inputs))


def test_zones_in_the_same_turbulence_simulated_and_by_lyapunov() -> None:
    """The engine's zones meet one field in turn: RMS over twelve runs within 3 standard errors, and not that of zones
    that meet it together."""
    V, distance, runs = 25.0, 6.5, 12
    model = two_zones(distance)
    plant = gust_plant(model, FlightCondition(V=V, rho=1.225))
    exact, integral, _ = turbulence_rms(plant, constant_turbulence(1.0))
    np.testing.assert_allclose(exact, integral, rtol=4e-4)
    scenario = Scenario(profile=level(V), duration=200.0, turbulence=Gustiness(level=1.0))
    prepared = prepare(model, scenario, Stepping(record_s=0.01))
    i = plant.outputs.index("plunge_rate_m_s")
    histories = [run_prepared(prepared, seed=seed).history for seed in range(runs)]
    squares = np.array([np.mean(h["plunge_rate_m_s"][h.t > 10.0] ** 2) for h in histories if h is not None])
    error = squares.std(ddof=1) / np.sqrt(runs)
    assert abs(squares.mean() - exact[i] ** 2) < 3.0 * error
    together, _, _ = turbulence_rms(
        gust_plant(two_zones(0.0), FlightCondition(V=V, rho=1.225)), constant_turbulence(1.0)
    )
    assert abs(squares.mean() - together[i] ** 2) > 10.0 * error
    first = histories[0]
    assert first is not None
    late = round(distance / V / 0.01)
    np.testing.assert_allclose(first["gust_rear_m_s"][late:], first["gust_front_m_s"][:-late], atol=1e-9)


def test_a_linear_system_with_a_gust_input() -> None:
    """A user's state space: its own outputs; without gust input it is refused."""
    system = LinearSystem(
        A=[[0.0, 1.0], [-25.0, -1.0]], B=[[0.0, 0.0], [1.0, 2.0]], C=[[1.0, 0.0]], D=[[0.0, 0.0]],
        states=("x", "v"), inputs=("flap_rad", "gust_m_s"), outputs=("load_N",),
    )  # fmt: skip
    plant = gust_plant(system, FlightCondition(V=20.0, rho=1.0))
    static = gust_loads(
        plant, gradients=[2e3], velocity=design_velocity("unit", altitude=None, density=1.0), bounds=None
    )
    assert static.peak[0, plant.outputs.index("load_N")] == pytest.approx(2.0 / 25.0, rel=1e-3)
    with pytest.raises(ValueError, match="no gust input"):
        gust_plant(replace(system, inputs=("flap_rad", "flap_2_rad")), FlightCondition(V=20.0, rho=1.0))


def test_design_velocities() -> None:
    """Laws, and what they need."""
    assert design_velocity("unit", altitude=None, density=0.5)([3.0, 500.0]).tolist() == [1.0, 1.0]
    high = design_velocity("cs25", altitude=4572.0, density=0.7708)(np.array([107.0]))
    assert high[0] == pytest.approx(13.41 * np.sqrt(1.225 / 0.7708))
    assert design_velocity("cs23", altitude=0.0, density=1.225)([6.0])[0] == pytest.approx(15.24)
    for call, words in (
        (lambda: design_velocity("cs25", altitude=None, density=1.0), "needs an altitude"),
        (lambda: design_velocity("cs22", altitude=0.0, density=1.0), "design must be"),  # type: ignore[arg-type]
        (lambda: design_velocity("cs25", altitude=0.0, density=1.0)([5.0]), "gradient H must lie in 9 to 107"),
        (lambda: gust_plant(two_zones(1.0), FlightCondition(V=[1.0, 2.0], rho=1.0)), "one flight condition"),
        (
            lambda: gust_loads(plant_of("bact", 80.0)[0], gradients=[0.0], velocity=lambda H: np.ones(1)),
            "gradients must be positive",
        ),
    ):
        with pytest.raises(ValueError, match=words):
            call()


def test_vertical_filter_is_upward() -> None:
    """The specification's w is down."""
    gust = vertical_filter(constant_turbulence(1.0), np.array([20.0, 40.0]))
    assert gust.A.shape == (2, 2, 2) and gust.outputs == ("gust_m_s",)
    assert np.all(-(gust.C @ np.linalg.solve(gust.A, gust.B)) < 0.0)
