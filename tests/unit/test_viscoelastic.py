"""Viscoelastic structures: the material against closed forms, the wing by internal states and by complex modulus."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import aeroservo as av
from aeroservo.aeroelastic.creep import creep_speeds, creep_time, creep_twist, glassy, relaxed
from aeroservo.aeroelastic.linear import internal_states, state_matrix
from aeroservo.aeroelastic.pk import frequency_matrix, frequency_roots
from aeroservo.aeroelastic.sensitivity import sensitivities
from aeroservo.aircraft.file_errors import ModelFileError
from aeroservo.aircraft.files import validate
from aeroservo.aircraft.schema_base import FileModel
from aeroservo.datatypes import AeroelasticModel, FlightCondition, ModalModel, Relaxation
from aeroservo.simulate.disturbances import SharpGust
from aeroservo.simulate.engine import simulate
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario, Stepping
from aeroservo.structure.beam import SlenderBeam, beam_modes, modes
from aeroservo.structure.viscoelastic import (
    Prony,
    Viscoelastic,
    complex_modulus,
    creep_compliance,
    relaxation_modulus,
    relaxing,
    wlf_shift,
)

#: Identities: rounding of what is solved on either side.
IDENTITY = 1e-9
#: The target for two methods on one structure and one air.
TWO_ROUTES = 1e-6
THREE = Prony(ratios=(0.2, 0.15, 0.3), times=(0.003, 0.4, 20.0))
BENDING = {"ratios": [0.1, 0.15], "times_s": [0.01, 1.0]}
TORSION = {"ratios": [0.15, 0.2], "times_s": [0.02, 5.0]}
SECTION = {
    "kind": "typical_section",
    "name": "section",
    "section": {
        "chord_m": 0.6096, "flexural_axis": 0.40, "mass_kg_per_m": 36.0, "static_moment_kg": 1.1, "inertia_kg_m": 0.84,
        "plunge_stiffness_N_per_m2": 90000.0, "pitch_stiffness_N": 8400.0,
    },
}  # fmt: skip


def section(**tables: Any) -> FileModel:
    """The section of these tests, with other tables of its file."""
    return validate(SECTION | tables, "section")


def viscous(name: str, **changes: Any) -> FileModel:
    """A preset of bending and torsion that relax."""
    file = av.read(name)
    data = file.model_dump(exclude_none=True) | {"viscoelastic": {"bending": BENDING, "torsion": TORSION}} | changes
    return validate(data, name)


def sweep(high: float, altitude: float = 0.0) -> FlightCondition:
    """Speeds from 5 m/s on."""
    return FlightCondition.at(altitude, V=np.arange(5.0, high, 5.0))


# the material


def test_standard_linear_solid() -> None:
    """One branch: modulus, relaxation and creep in closed form; creep is slower than relaxation by the relaxed part."""
    g, tau, t = 0.4, 2.0, np.linspace(0.0, 20.0, 50)
    one = Prony(ratios=(g,), times=(tau,))
    r, w = 1.0 - g, np.geomspace(0.01, 100.0, 30)
    storage, loss = (1 - g) + g * (w * tau) ** 2 / (1 + (w * tau) ** 2), g * w * tau / (1 + (w * tau) ** 2)
    np.testing.assert_allclose(complex_modulus(one, 1j * w), storage + 1j * loss, rtol=1e-13)
    np.testing.assert_allclose(relaxation_modulus(one, t), r + g * np.exp(-t / tau), rtol=1e-13)
    np.testing.assert_allclose(creep_compliance(one, t), 1 / r - (1 / r - 1) * np.exp(-r * t / tau), rtol=1e-13)


@pytest.mark.parametrize("t", [1e-4, 0.01, 1.0, 30.0])
def test_creep_by_laplace_inversion_and_by_time_integration(t: float) -> None:
    """J~ = 1/(s^2 E~) inverted numerically (Talbot, 30 digits); the internal states integrated (Radau)."""
    mpmath.mp.dps = 30

    def modulus(s: Any) -> Any:
        return 1 - sum(g / (1 + s * tau) for g, tau in zip(THREE.ratios, THREE.times))

    inverted = float(mpmath.invertlaplace(lambda s: 1 / (s * modulus(s)), t, method="talbot"))
    g, tau = np.array(THREE.ratios), np.array(THREE.times)
    states = solve_ivp(lambda _, y: (1.0 + g @ y - y) / tau, (0.0, t), np.zeros(3), "Radau", rtol=1e-10, atol=1e-13)
    found = float(creep_compliance(THREE, t))
    assert found == pytest.approx(inverted, rel=1e-10)
    assert found == pytest.approx(1.0 + g @ states.y[:, -1], rel=1e-8)


def test_laplace_identity() -> None:
    """s times the transform of the relaxation modulus is the complex modulus; the two compliances multiply to 1."""
    for s in (0.02, 1.0, 300.0):
        area = mpmath.quad(
            lambda t, s=s: mpmath.exp(-s * t) * float(relaxation_modulus(THREE, float(t))), [0, 0.01 / s, 1 / s, 60 / s]
        )
        assert s * float(area) == pytest.approx(float(complex_modulus(THREE, s).real), rel=1e-7)
    assert complex_modulus(THREE, 0.0).real == pytest.approx(THREE.relaxed)
    assert creep_compliance(THREE, 1e6) == pytest.approx(1.0 / THREE.relaxed, rel=IDENTITY)
    assert creep_compliance(Prony(), [0.0, 1.0]).tolist() == [1.0, 1.0]


def test_wlf_may_refer_to_any_temperature() -> None:
    """Ferry's change of reference: C1' = C1 C2/(C2 + d), C2' = C2 + d, and a_T' = a_T(T)/a_T(T')."""
    C1, C2, first, second = 17.44, 51.6, 20.0, 45.0
    T = np.linspace(0.0, 120.0, 13)
    old = wlf_shift(T, reference=first, C1=C1, C2=C2)
    d = second - first
    new = wlf_shift(T, reference=second, C1=C1 * C2 / (C2 + d), C2=C2 + d)
    np.testing.assert_allclose(new, old / wlf_shift(second, reference=first, C1=C1, C2=C2), rtol=1e-12)
    with pytest.raises(ValueError, match=r"must be above -31\.6"):
        wlf_shift(-40.0, reference=first, C1=C1, C2=C2)


def test_bad_materials() -> None:
    """Series that are none."""
    for ratios, times, message in (
        ((0.5,), (), "one time for each"),
        ((0.6, 0.5), (1.0, 2.0), "less than 1"),
        ((-0.1,), (1.0,), "positive"),
        ((0.1,), (1e12,), "never, leave it out"),
    ):
        with pytest.raises(ValueError, match=message):
            Prony(ratios=ratios, times=times)
    one = {"M": [[1.0]], "D": [[0.0]], "K": [[4.0]], "names": ("h",)}
    with pytest.raises(ValueError, match="symmetric"):
        Relaxation(time=1.0, K=[[1.0, 1.0], [0.0, 1.0]])
    with pytest.raises(ValueError, match="must not be negative"):
        Relaxation(time=1.0, K=[[-1.0]])
    with pytest.raises(ValueError, match="time of a relaxation"):
        Relaxation(time=0.0, K=[[1.0]])
    branch = Relaxation(time=1.0, K=[[5.0]])
    with pytest.raises(ValueError, match="relaxed stiffness is negative"):
        ModalModel(**one, relaxing=(branch,))
    with pytest.raises(ValueError, match="own damping"):
        ModalModel(**one, relaxing=(Relaxation(time=1.0, K=[[1.0]]),), hysteretic_g=0.01)
    with pytest.raises(ValueError, match="shape of K"):
        ModalModel(**one, relaxing=(Relaxation(time=1.0, K=np.eye(2)),))


# the structure


def test_internal_states_are_the_complex_modulus() -> None:
    """Eliminating the internal states of the state matrix gives the dynamic stiffness, in vacuum, off the axis too."""
    model = av.build(viscous("goland"), "quasi_steady")
    n = model.modes.n
    A = state_matrix(model, FlightCondition(V=10.0, rho=0.0), keep=np.ones(n, dtype=bool))
    for s in (3.0 + 40.0j, -2.0 + 90.0j, 0.5 + 0.0j):
        full = s * np.eye(len(A)) - A
        schur = full[:, : 2 * n][: 2 * n] - full[: 2 * n, 2 * n :] @ np.linalg.solve(
            full[2 * n :, 2 * n :], full[2 * n :, : 2 * n]
        )
        wanted = model.modes.dynamic_stiffness(s)  # M is the unit matrix
        np.testing.assert_allclose(schur[n:, :n] + s * schur[n:, n:], wanted, atol=1e-9 * np.abs(wanted).max())


def test_parts_of_a_beams_stiffness() -> None:
    """Bending and torsion add up to K; with one law for both, all of K relaxes alike and modes stay modes."""
    wing = SlenderBeam(y=[0.0, 3.0, 6.0], mass=30.0, inertia=8.0, EI=[2e7, 1e7, 5e6], GJ=1e6, cg_offset=0.2, sweep=0.3)
    found = beam_modes(wing, n=6)
    np.testing.assert_allclose(found.bending_K + found.torsion_K, found.K, atol=IDENTITY * found.K.max())
    np.testing.assert_allclose(np.diag(found.torsion_K) / np.diag(found.K), found.torsion_share, rtol=1e-8)
    one = Prony(ratios=(0.3,), times=(1.0,))
    branches = relaxing(found.bending_K, found.torsion_K, Viscoelastic(bending=one, torsion=one))
    assert len(branches) == 1
    np.testing.assert_allclose(branches[0].K, 0.3 * found.K, atol=IDENTITY * found.K.max())
    more, less = (beam_modes(replace(wing, GJ=wing.GJ * f), n=6).omega ** 2 for f in (1.001, 0.999))
    np.testing.assert_allclose((more - less) / 0.002, np.diag(found.torsion_K), rtol=1e-4)  # d(omega^2)/d(ln GJ)


def test_elastic_limit_is_exact() -> None:
    """An empty law leaves every matrix as it was; slow times give the glassy flutter, fast ones the relaxed."""
    plain = av.build(av.read("goland"), "jones")
    wing = SlenderBeam(y=[0.0, 6.0], mass=30.0, inertia=8.0, EI=1e7, GJ=1e6)
    empty = modes(replace(wing, material=Viscoelastic()), n=4)
    np.testing.assert_array_equal(empty.K, modes(wing, n=4).K)
    assert empty.relaxing == () and plain.modes.relaxing == ()
    file = {"bending": {"ratios": [0.25], "times_s": [1.0]}, "torsion": {"ratios": [0.35], "times_s": [1.0]}}
    shift = {"reference_temperature_C": 20.0, "wlf_C1": 10.0, "wlf_C2_K": 100.0}

    def flutter(T: float) -> float:
        table = file | shift | {"temperature_C": T}
        return float(av.flutter(av.build(section(viscoelastic=table), "jones"), sweep(200.0), av.P()).flutter_speed)

    model = av.build(section(viscoelastic=file), "jones")
    stiff, soft = (float(av.flutter(m(model), sweep(200.0), av.P()).flutter_speed) for m in (glassy, relaxed))
    cold, hot = flutter(-20.0), flutter(200.0)  # a_T = 4.6e6 and 3.7e-7
    assert cold == pytest.approx(stiff, rel=1e-6) and hot == pytest.approx(soft, rel=1e-4)
    assert abs(stiff - soft) > 1.0
    assert av.build(section(), "jones").modes.K.tolist() == glassy(model).modes.K.tolist()


@pytest.mark.parametrize(
    ("name", "high", "altitude"),
    [
        ("section", 250.0, 0.0),
        ("goland", 300.0, 6096.0),
        ("wright-cooper-binary", 200.0, 0.0),
        ("thesis-aircraft", 150.0, 3048.0),
    ],
)
def test_methods_meet_at_the_crossing(name: str, high: float, altitude: float) -> None:
    """p with internal states, p-k and g with the complex modulus: one flutter speed, one creep divergence."""
    file = section(viscoelastic={"bending": BENDING, "torsion": TORSION}) if name == "section" else viscous(name)
    model = av.build(file, "jones")
    p, pk, g = (av.flutter(model, sweep(high, altitude), m) for m in (av.P(), av.PK(), av.G()))
    assert p.flutter_speed is not None and p.flutter_frequency is not None
    for other in (pk, g):
        assert other.flutter_speed == pytest.approx(p.flutter_speed, rel=TWO_ROUTES)
        assert other.flutter_frequency == pytest.approx(p.flutter_frequency, rel=TWO_ROUTES)
        if name != "thesis-aircraft":  # there it is a pair that becomes real off the axis: each method's own
            assert other.first_real_instability == pytest.approx(p.first_real_instability, rel=TWO_ROUTES)
    stiff = av.flutter(glassy(model), sweep(high, altitude), av.P())
    assert stiff.flutter_speed is not None and abs(stiff.flutter_speed - p.flutter_speed) > 1e-3 * p.flutter_speed
    with pytest.raises(ValueError, match="does not depend on frequency"):
        av.flutter(model, sweep(high, altitude), av.K())


def test_newton_step_of_p_k_knows_the_modulus() -> None:
    """The p-k root is an eigenvalue of its matrix at its own frequency: the modulus is in both."""
    model = av.build(section(viscoelastic={"bending": BENDING, "torsion": TORSION}), "theodorsen")
    at = FlightCondition.at(0.0, V=[100.0])
    roots = frequency_roots(model, at).values[0]
    for root in roots[(roots.imag > 1.0)]:
        matrix = frequency_matrix(model, at, np.array([root.imag]), g_method=False)[0]
        assert np.abs(np.linalg.eigvals(matrix) - root).min() < 1e-8 * abs(root)


# creep


def pitching(gamma: float = 0.35, tau: float = 4.0) -> AeroelasticModel:
    """Section stiff in plunge that twists and relaxes in torsion alone, damped."""
    table = {"torsion": {"ratios": [gamma], "times_s": [tau]}}
    damped = {"viscous": {"plunge_N_s_per_m2": 2000.0, "pitch_N_s": 60.0}}
    return av.build(section(viscoelastic=table, damping=damped), "quasi_steady")


def test_creep_divergence_of_the_standard_linear_solid() -> None:
    """q = (1 - g) q_D; below, the twist grows from r/(1 - r) to r/(1 - g - r), r = q/q_D; above, on and on."""
    g, tau, model = 0.35, 4.0, pitching()
    at = FlightCondition.at(0.0, V=[1.0])
    found = creep_speeds(model, at[0])
    q_D = found.glassy_divergence.q
    assert q_D is not None and found.relaxed_divergence.q == pytest.approx((1.0 - g) * q_D, rel=IDENTITY)
    c, e, a = 0.6096, 0.15, 2.0 * math.pi
    assert q_D == pytest.approx(8400.0 / (c**2 * e * a), rel=IDENTITY)
    real = av.flutter(model, sweep(250.0), av.P()).first_real_instability
    assert real == pytest.approx(found.relaxed_divergence.V, rel=IDENTITY)
    t = np.linspace(0.0, 12.0, 25)
    for r in (0.3, 0.5, 0.65, 0.8):
        here = FlightCondition.at(0.0, V=found.glassy_divergence.V * math.sqrt(r))
        rate = (g - 1.0 + r) / ((1.0 - r) * tau)
        y = (r / (1.0 - r) / tau) * (np.expm1(rate * t) / rate if abs(rate) > 1e-12 else t)
        twist = (r + g * y) / (1.0 - r)
        np.testing.assert_allclose(creep_twist(model, here, t), twist, rtol=1e-8)
        for goal in (1.5 * twist[0], twist[10]):
            first = float(creep_time(model, here[None], twist=float(goal), incidence=1.0)[0])
            level_off = r / (1.0 - g - r) if r < 1.0 - g - 1e-9 else math.inf
            if goal >= level_off:
                assert math.isinf(first)
            else:
                assert first == pytest.approx(float(np.interp(goal, twist, t)), abs=0.05)
                assert float(creep_twist(model, here, np.array([first]))[0]) == pytest.approx(goal, rel=1e-9)


@pytest.mark.parametrize("tau", [1.0, 1e2, 1e4, 1e6])
def test_slow_creep_begins_where_the_relaxed_wing_diverges(tau: float) -> None:
    """However slow: p and p-k, whose roots near there cannot be told from zero, and statics give one speed."""
    model = av.build(section(viscoelastic={"torsion": {"ratios": [0.35], "times_s": [tau]}}), "jones")
    V = creep_speeds(model, FlightCondition.at(0.0, V=1.0)).relaxed_divergence.V
    for method in (av.P(), av.PK()):
        found = av.flutter(model, FlightCondition.at(0.0, V=np.arange(100.0, 260.0, 5.0)), method)
        assert found.first_real_instability == pytest.approx(V, rel=1e-6)
        assert any(i.kind == "divergence" and i.start == pytest.approx(V, rel=1e-6) for i in found.intervals)


def test_creep_time_at_the_ends() -> None:
    """Past glassy divergence at once; a twist that is there at once; one that is never there."""
    model = pitching()
    V = creep_speeds(model, FlightCondition.at(0.0, V=1.0)).glassy_divergence.V
    assert V is not None
    speeds = FlightCondition.at(0.0, V=[0.3 * V, 0.9 * V, 1.1 * V])
    times = creep_time(model, speeds, twist=5.0)
    assert math.isinf(times[0]) and 0.0 < times[1] < 4.0 and times[2] == 0.0
    assert creep_time(model, speeds[:1], twist=0.01).tolist() == [0.0]
    with pytest.raises(ValueError, match="diverges at once"):
        creep_twist(model, speeds[2], np.zeros(1))
    with pytest.raises(ValueError, match="must be positive"):
        creep_time(model, speeds, twist=0.0)


def test_simulation_creeps_as_told() -> None:
    """A sharp-edged gust is a sudden incidence: the damped section follows the creep between the two divergences."""
    model = pitching()
    V = creep_speeds(model, FlightCondition.at(0.0, V=1.0)).glassy_divergence.V
    assert V is not None
    speed, w = 0.7 * V, 0.5
    for method in ("exact", "rk4"):
        run = simulate(
            model,
            Scenario(profile=level(speed), duration=8.0, gusts=(SharpGust(amplitude=w, start=0.0),)),
            stepping=Stepping(method=method),  # type: ignore[arg-type]
        )
        assert run.history is not None and run.history.t[-1] > 7.9
        late = run.history.t > 2.0
        t, pitch = run.history.t[late], run.history["pitch_rad"][late]
        twist = creep_twist(model, FlightCondition.at(0.0, V=speed), t, incidence=w / speed)
        np.testing.assert_allclose(pitch, twist, rtol=5e-3)  # inertia and dampers are not in the creep


def test_beam_wing_creeps_with_its_torsion() -> None:
    """Straight uniform wing: divergence goes with GJ alone, so q falls by exactly the relaxed part of torsion."""
    model = av.build(viscous("goland"))
    found = creep_speeds(model, FlightCondition.at(0.0, V=1.0))
    assert found.glassy_divergence.V == pytest.approx(252.355, abs=0.01)
    assert found.relaxed_divergence.q == pytest.approx(0.65 * float(found.glassy_divergence.q or 0.0), rel=1e-7)
    still = av.static(model, sweep(200.0))
    assert still.divergence.V == found.relaxed_divergence.V


def test_names_of_states_and_free_roots() -> None:
    """Heave of a whole aircraft has no spring and no internal state; names say what a state is."""
    model = av.build(viscous("thesis-aircraft"))
    assert internal_states(model) == ("relaxation_1", "relaxation_2", "relaxation_3", "relaxation_4")
    system = av.linear_system(model, FlightCondition.at(0.0, V=20.0))
    assert len(system.states) == 6 + 4
    decoupled = np.abs(np.linalg.eigvals(system.A))
    assert decoupled.min() < 1e-9  # the free heave


def test_sensitivities_of_a_viscoelastic_wing() -> None:
    """dV/dp through the complex modulus equals a difference of flutter speeds, of a spring and of a temperature."""
    table = {"bending": BENDING, "torsion": TORSION, "temperature_C": 30.0}
    table |= {"reference_temperature_C": 20.0, "wlf_C1": 10.0, "wlf_C2_K": 100.0}
    file = section(viscoelastic=table)
    found = {s.field: s for s in sensitivities(file, sweep(200.0), av.PK())}

    def speed(**changes: Any) -> float:
        other = section(
            viscoelastic=table | changes.get("viscoelastic", {}), section=changes.get("section", SECTION["section"])
        )
        return float(av.flutter(av.build(other), sweep(200.0), av.PK()).flutter_speed)

    h, K = 1e-4, 8400.0
    springs = [speed(section=SECTION["section"] | {"pitch_stiffness_N": K * f}) for f in (1.0 + h, 1.0 - h)]  # type: ignore[operator]
    assert found["section.pitch_stiffness_N"].dV_flutter == pytest.approx(
        -np.diff(springs)[0] / (2.0 * h * K), rel=1e-5
    )
    warm = [speed(viscoelastic={"temperature_C": T}) for T in (30.01, 29.99)]
    assert found["viscoelastic.temperature_C"].dV_flutter == pytest.approx(-np.diff(warm)[0] / 0.02, rel=1e-4)


# files


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        ({"viscoelastic": {}}, "viscoelastic.bending"),
        ({"viscoelastic": {"torsion": {"ratios": [0.5], "times_s": [1.0, 2.0]}}}, "one of times_s"),
        ({"viscoelastic": {"torsion": {"ratios": [0.5, 0.6], "times_s": [1.0, 2.0]}}}, "less than 1"),
        ({"viscoelastic": {"torsion": {"ratios": [0.5], "times_s": [0.0]}}}, "must be positive"),
        ({"viscoelastic": {"torsion": TORSION, "temperature_C": 20.0}}, "needs all of"),
        (
            {
                "viscoelastic": {"torsion": TORSION},
                "section": SECTION["section"] | {"nonlinear": {"pitch_stiffness_polynomial": [1.0, 0.0, 5.0]}},  # type: ignore[operator]
            },
            "two laws",
        ),
    ],
)
def test_bad_tables(tables: dict[str, Any], message: str) -> None:
    """Refused with the reason."""
    with pytest.raises(ModelFileError, match=message):
        section(**tables)


def test_tables_that_make_no_model() -> None:
    """Too cold for WLF, relaxed before any analysis could see it, with hysteretic damping."""
    shift = {"reference_temperature_C": 20.0, "wlf_C1": 17.44, "wlf_C2_K": 51.6}
    with pytest.raises(ValueError, match=r"must be above -31\.6"):
        av.build(section(viscoelastic={"torsion": TORSION, "temperature_C": -50.0} | shift))
    hot = av.build(section(viscoelastic={"torsion": TORSION, "temperature_C": 400.0} | shift))
    cold = av.build(section(viscoelastic={"torsion": TORSION, "temperature_C": -30.0} | shift))
    assert {b.time for b in hot.modes.relaxing} == {1e-7} and {b.time for b in cold.modes.relaxing} == {1e6}
    with pytest.raises(ValueError, match="own damping"):
        av.build(section(viscoelastic={"torsion": TORSION}, damping={"hysteretic": {"g": 0.02}}))


def test_aircraft_file_relaxes_too(tmp_path: Path) -> None:
    """`[viscoelastic]` appended to thesis-uav: flutter by p and p-k at one speed, reversal lower than the elastic."""
    file = av.read("thesis-uav")
    soft = validate(file.model_dump(exclude_none=True) | {"viscoelastic": {"torsion": TORSION}}, "uav")
    model = av.build(soft, "jones")
    found = creep_speeds(model, FlightCondition.at(0.0, V=1.0))
    assert found.relaxed_reversal.V is not None and found.glassy_reversal.V == pytest.approx(102.29, abs=0.05)
    assert found.relaxed_reversal.V < 0.9 * found.glassy_reversal.V
    assert any("65 % of torsion" in note for note in soft.problems())
