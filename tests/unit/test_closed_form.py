"""Closed forms of static aeroelasticity: each against a limit case and a second route (ODE, symbols, the model)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad, solve_bvp
from scipy.linalg import expm

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.closed_form import (
    UniformWing,
    binary_divergence_pressure,
    section_divergence_pressure,
    swept_divergence_pressure,
    wing_divergence_pressure,
    wing_twist,
)
from aeroservo.aeroelastic.closed_form_reversal import (
    ControlSlopes,
    lift_reversal_pressure,
    roll_moment,
    roll_rate_effectiveness,
    roll_reversal_pressure,
    wing_roll_reversal_pressure,
)
from aeroservo.aeroelastic.flexible_slopes import flexible_slopes
from aeroservo.aeroelastic.static import divergence, reversal, static
from aeroservo.aircraft.files import read, validate
from aeroservo.datatypes import FlightCondition
from aeroservo.structure.beam import BeamMass, SlenderBeam
from aeroservo.structure.beam_static import BeamLoad, static_deflection

#: The same formula written twice.
IDENTITY = 1e-12
#: Forty modes of the beam against the exact solution.
TWO_ROUTES = 1e-6

WING = UniformWing(GJ=0.9876e6, eccentricity=0.08, chord=1.8288, semi_span=6.096, lift_slope=2.0 * np.pi)
CONTROL = ControlSlopes(lift_per_rad=2.0, moment_per_rad=-0.5)
SEA = FlightCondition(V=1.0, rho=1.225)


def beam_file(**wing: Any) -> dict[str, Any]:
    """WING with CONTROL as a model file."""
    station = {
        "chord_m": 1.8288,
        "flexural_axis": 0.33,
        "cg_axis": 0.43,
        "mass_kg_per_m": 35.717,
        "inertia_kg_m": 8.642,
        "EI_N_m2": 9.773e6,
        "GJ_N_m2": 0.9876e6,
    }
    elevon = {"from_y_m": 0.0, "to_y_m": 6.096, "lift_per_rad": 2.0, "moment_per_rad": -0.5}
    stations = [station | {"y_m": y} for y in (0.0, 6.096)]
    return {"kind": "beam_wing", "wing": {"root": "clamped", "station": stations, "elevon": elevon} | wing}


def test_section_and_binary_from_work() -> None:
    """Virtual work of lift on assumed twists 1 and y/s, in symbols."""
    q, e, c, s, a, K, y = sp.symbols("q e c s a K y", positive=True)
    values = {e: 0.183, c: 0.53, s: 2.0, a: 3.0, K: 413.2}
    for shape, found in (
        (
            sp.Integer(1),
            section_divergence_pressure(
                pitch_stiffness=413.2, eccentricity=0.183, chord=0.53, span=2.0, lift_slope=3.0
            ),
        ),
        (
            y / s,
            binary_divergence_pressure(
                UniformWing(GJ=826.4, eccentricity=0.183, chord=0.53, semi_span=2.0, lift_slope=3.0)
            ),
        ),
    ):
        work = sp.integrate(q * e * c**2 * a * shape**2, (y, 0, s))
        wanted = float(sp.solve(sp.Eq(work, K), q)[0].subs(values))
        assert found == pytest.approx(wanted, rel=IDENTITY)


def test_binary_is_the_model() -> None:
    """The binary wing of the package diverges where the closed form says."""
    file = read("thesis-binary")
    w = file.wing  # type: ignore[attr-defined]
    wing = UniformWing(
        GJ=w.K_theta * w.semi_span_m,
        eccentricity=w.e,
        chord=w.chord_m,
        semi_span=w.semi_span_m,
        lift_slope=w.lift_slope_per_rad,
    )
    model = build(file)
    assert divergence(model, SEA).q == pytest.approx(binary_divergence_pressure(wing), rel=1e-12)
    control = ControlSlopes(lift_per_rad=w.elevon.lift_per_rad, moment_per_rad=w.elevon.moment_per_rad)
    assert reversal(model, SEA)[1].q == pytest.approx(roll_reversal_pressure(wing, control), rel=1e-12)
    assert reversal(model, SEA, quantity="lift")[1].q == pytest.approx(lift_reversal_pressure(wing, control), rel=1e-12)
    sweep = FlightCondition(V=[10.0, 30.0, 50.0], rho=1.225)
    result = static(model, sweep)
    assert result.effectiveness == pytest.approx(roll_rate_effectiveness(sweep.q, wing, control), rel=1e-10)
    rigid = sweep.q * w.chord_m * w.semi_span_m**2 * control.lift_per_rad
    assert result.moment_effectiveness == pytest.approx(roll_moment(sweep.q, wing, control) / rigid, rel=1e-10)


@pytest.mark.parametrize("e", [0.08, 1e-9, 0.0, -0.2])
def test_wing_twist_solves_its_equation(e: float) -> None:
    """A boundary-value solution of GJ theta'' + q c^2 (e a (alpha + theta) + C_M0) = 0, for every sign of e."""
    wing, q, alpha, cm0 = replace(WING, eccentricity=e), 2.0e4, 0.05, -0.02
    force = q * wing.chord**2 / wing.GJ
    y = np.linspace(0.0, wing.semi_span, 41)
    solved = solve_bvp(
        lambda y, u: np.stack([u[1], -force * (e * wing.lift_slope * (alpha + u[0]) + cm0)]),
        lambda root, tip: np.array([root[0], tip[1]]),
        y,
        np.zeros((2, y.size)),
        tol=1e-10,
    )
    found = wing_twist(y, wing, q=q, incidence=alpha, cm0=cm0)
    assert np.abs(found - solved.sol(y)[0]).max() < 1e-8 * np.abs(found).max()


def test_wing_twist_of_the_beam() -> None:
    """The beam wing's tip twist and divergence; thirds of the phase give 1/cos(60 deg) - 1."""
    q = wing_divergence_pressure(WING)
    assert q is not None
    model = build(validate(beam_file(), "test"))
    assert divergence(model, SEA).q == pytest.approx(q, rel=TWO_ROUTES)
    V = np.sqrt(2.0 * q / 1.225) * np.array([0.1, 2.0 / 3.0, 0.9])
    result = static(model, FlightCondition(V=V, rho=1.225))
    tip = wing_twist(WING.semi_span, WING, q=0.5 * 1.225 * V**2, incidence=1.0)
    assert result.twist == pytest.approx(tip, rel=TWO_ROUTES)
    assert tip[1] == pytest.approx(1.0, rel=IDENTITY)
    slope = np.tan(z := 0.5 * np.pi * V / np.sqrt(2.0 * q / 1.225)) / z
    assert result.lift_slope_ratio == pytest.approx(slope, rel=TWO_ROUTES)


def test_wing_that_does_not_diverge() -> None:
    """No eccentricity or a negative one: None, and twist at any pressure."""
    for e in (0.0, -0.1):
        wing = replace(WING, eccentricity=e)
        assert wing_divergence_pressure(wing) is None
        assert binary_divergence_pressure(wing) is None
        assert np.isfinite(wing_twist(1.0, wing, q=1e7, incidence=0.1))


def test_swept_wing_on_root_springs() -> None:
    """Virtual displacements of the lift's point of action: 2 x 2 equilibrium with its own geometry."""
    rng = np.random.default_rng(1)
    seen = {True: 0, False: 0}
    for _ in range(200):
        K_t, K_k, e, c, s, a = rng.uniform([1e2, 1e2, -0.1, 0.2, 1.0, 3.0], [1e4, 1e5, 0.4, 1.0, 4.0, 6.3])
        sweep = rng.uniform(-1.0, 1.0)
        sin, cos = np.sin(sweep), np.cos(sweep)
        # rotation vectors of unit twist (about the axis, outboard) and unit bending (tip up) in (x aft, y starboard)
        turn = {"twist": np.array([sin, cos]), "bend": np.array([cos, -sin])}
        centre = np.array([0.5 * s * np.tan(sweep) - e * c, 0.5 * s])
        arm = np.array([centre[1], -centre[0]])  # work of an upward force on w = R x r: w = R_x y - R_y x
        felt = np.array([turn[name][1] for name in ("twist", "bend")])
        moment = np.array([turn[name] @ arm for name in ("twist", "bend")])
        K = np.diag([K_t, K_k])
        pressure = 1.0 / (c * s * a * felt @ np.linalg.solve(K, moment))
        found = swept_divergence_pressure(
            pitch_stiffness=K_t, bending_stiffness=K_k, eccentricity=e, chord=c, span=s, lift_slope=a, sweep=sweep
        )
        seen[found is None] += 1
        if pressure < 0.0:
            assert found is None
        else:
            assert found == pytest.approx(pressure, rel=1e-9)
    assert min(seen.values()) > 20


def test_swept_wing_limits() -> None:
    """Unswept it is the section; stiff in bending it rises as 1/cos^2 with sweep of either sign."""
    wing = {"pitch_stiffness": 1e3, "eccentricity": 0.2, "chord": 0.5, "lift_slope": 6.0}
    straight = section_divergence_pressure(**wing, span=2.0)
    assert straight is not None
    for sweep in (-0.7, 0.0, 0.7):
        found = swept_divergence_pressure(**wing, bending_stiffness=np.inf, span=2.0, sweep=sweep)
        assert found == pytest.approx(straight / np.cos(sweep) ** 2, rel=IDENTITY)
    assert swept_divergence_pressure(**wing, bending_stiffness=1e3, span=2.0, sweep=0.6) is None


def test_reversals_from_work() -> None:
    """Equilibrium of a linear twist and zero roll or zero lift, solved in symbols."""
    q, e, c, s, a, GJ, ac, bc, y, t, p = sp.symbols("q e c s a GJ a_c b_c y t p")
    values = {e: 0.08, c: 1.8288, s: 6.096, a: 2.0 * np.pi, GJ: 0.9876e6, ac: 2.0, bc: -0.5}
    for roll, found in ((p, roll_reversal_pressure(WING, CONTROL)), (0, lift_reversal_pressure(WING, CONTROL))):
        angle = (t - roll) * y / s
        torsion = sp.integrate(q * c**2 * (e * a * angle + bc) * y / s, (y, 0, s)) - GJ * t / s
        arm = y if roll is p else 1
        load = sp.integrate((a * angle + ac) * arm, (y, 0, s))
        if roll is p:
            # the roll rate of the elastic wing is zero at reversal
            torsion, load = torsion.subs(p, 0), load.subs(p, 0)
        twist = sp.solve(load, t)[0]
        wanted = float(sp.solve(torsion.subs(t, twist), q)[0].subs(values))
        assert found == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("e", [0.08, 0.0, 1e-7, -0.2])
def test_wing_roll_reversal(e: float) -> None:
    """Rolling moment from the exact twist vanishes there; without eccentricity -(12/5) GJ a_c / (c^2 s^2 a b_c)."""
    wing = replace(WING, eccentricity=e)
    q = wing_roll_reversal_pressure(wing, CONTROL)
    assert q is not None

    def sectional(y: float) -> float:
        elastic = float(wing_twist(y, wing, q=q, incidence=0.0, cm0=CONTROL.moment_per_rad))
        return (wing.lift_slope * elastic + CONTROL.lift_per_rad) * y

    scale = 0.5 * CONTROL.lift_per_rad * wing.semi_span**2
    assert abs(quad(sectional, 0.0, wing.semi_span, epsabs=1e-12)[0]) < 1e-10 * scale
    if abs(e) < 1e-6:
        limit = -2.4 * wing.GJ * CONTROL.lift_per_rad / (wing.area_lift * CONTROL.moment_per_rad)
        assert q == pytest.approx(limit, rel=1e-6)


def test_wing_roll_reversal_of_the_beam() -> None:
    """The beam wing reverses at the exact solution, and earlier than a linear twist would."""
    model = build(validate(beam_file(), "test"))
    quantity, found = reversal(model, SEA)
    exact, linear = wing_roll_reversal_pressure(WING, CONTROL), roll_reversal_pressure(WING, CONTROL)
    assert quantity == "roll"
    assert found.q == pytest.approx(exact, rel=TWO_ROUTES)
    assert exact is not None and linear is not None
    assert 0.7 < exact / linear < 1.0


def test_no_reversal_without_a_nose_down_moment() -> None:
    """A control that twists the wing its own way does not reverse."""
    control = ControlSlopes(lift_per_rad=1.0, moment_per_rad=0.2)
    assert roll_reversal_pressure(WING, control) is None
    assert lift_reversal_pressure(WING, control) is None
    assert wing_roll_reversal_pressure(WING, control) is None


def swept_lift_slope(
    q: float, *, length: float, c: float, e: float, a: float, EI: float, GJ: float, sweep: float
) -> float:
    """C_L alpha of a uniform swept wing from the exponential of its equations: dM/ds = -(m + V n)."""
    sin, cos = np.sin(sweep), np.cos(sweep)
    A = np.zeros((6, 6))  # dw/ds, its derivative, V, theta, theta', 1
    A[0, 1] = A[3, 4] = 1.0
    lift = q * c * a * cos * np.array([-sin, 0.0, 0.0, cos, 0.0, 1.0])
    A[1] = e * c * lift * sin / EI
    A[1, 2] -= 1.0 / EI
    A[4] = -e * c * lift * cos / GJ
    A[2] = -lift
    X = expm(A * length)
    root = np.linalg.solve(X[np.ix_([1, 2, 4], [1, 2, 4])], -X[[1, 2, 4], 5])
    return float(root[1] / (q * c * length * cos))


@pytest.mark.parametrize("sweep_deg", [-30.0, 0.0, 25.0])
def test_flexible_slopes_of_swept_wings(sweep_deg: float) -> None:
    """[7.12] against the exact solution of the swept beam; 8 points are enough for rounding."""
    case = {"c": 1.8, "e": 0.1, "a": 5.0, "EI": 2e6, "GJ": 1e6}
    beam = SlenderBeam(y=[0.0, 6.0], mass=10.0, inertia=5.0, EI=2e6, GJ=1e6, sweep=np.radians(sweep_deg))
    found = flexible_slopes(beam, [1.0, 3000.0], chord=1.8, eccentricity=0.1, lift_slope=5.0, points=8)
    for q, slope in zip(found.q, found.CL_alpha):
        assert slope == pytest.approx(swept_lift_slope(q, length=6.0, sweep=np.radians(sweep_deg), **case), rel=1e-10)
    assert found.CL_alpha[0] == pytest.approx(5.0, rel=1e-3)
    # rigid: the lift acts at half span, tan(Lambda) s/2 behind the root's aerodynamic centre
    arm = 3.0 * np.sin(np.radians(sweep_deg)) / found.mac
    assert found.CM_alpha[0] == pytest.approx(-5.0 * arm, rel=1e-3, abs=1e-12)


def test_flexible_slopes_unswept() -> None:
    """a tan(lambda s) / (lambda s); kinked stations that are no kinks change nothing."""
    q = 0.5 * (wing_divergence_pressure(WING) or 0.0)
    z = 0.5 * np.pi * np.sqrt(0.5)
    for y in ([0.0, 6.096], [0.0, 1.0, 4.0, 6.096]):
        beam = SlenderBeam(y=y, mass=10.0, inertia=5.0, EI=2e6, GJ=0.9876e6)
        found = flexible_slopes(beam, q, chord=1.8288, eccentricity=0.08, lift_slope=2.0 * np.pi, points=10)
        assert found.CL_alpha[0] == pytest.approx(2.0 * np.pi * np.tan(z) / z, rel=1e-10)
        assert found.CM_alpha[0] == pytest.approx(0.0, abs=1e-12)


def test_flexible_slopes_of_a_free_wing() -> None:
    """[G]{mg} is the twist by weight of the finite elements; twist by lift less that of the weight carried."""
    lumps = (BeamMass(y=2.5, mass=30.0, x=0.4), BeamMass(y=6.0, mass=5.0, x=-0.3))
    beam = SlenderBeam(
        y=[0.0, 2.0, 6.0],
        mass=[30.0, 20.0, 8.0],
        inertia=20.0,
        cg_offset=0.1,
        EI=2e6,
        GJ=1e6,
        sweep=[0.3, 0.5, 0.5],
        masses=lumps,
    )
    q, W = np.array([2000.0]), 3000.0
    found = flexible_slopes(beam, q, chord=[2.0, 1.5, 1.0], eccentricity=0.1, lift_slope=5.0, aircraft_weight=W)
    s = np.interp(found.y, beam.position(beam.y)[:, 1], beam.y)
    y = np.unique(np.concatenate([np.linspace(0.0, 6.0, 61), beam.y]))
    weight = 9.80665 * np.interp(y, beam.y, beam.mass)
    load = BeamLoad(
        y=y,
        lift=-weight,
        torque=weight * 0.1,
        point_y=[lump.y for lump in lumps],
        point_lift=[-9.80665 * lump.mass for lump in lumps],
        point_torque=[9.80665 * lump.mass * lump.x for lump in lumps],
    )
    sag = static_deflection(beam, load, s).twist_streamwise
    assert found.G @ found.weight == pytest.approx(-sag, rel=1e-8, abs=1e-12)
    X = found.loading[0]
    lift = 2.0 * q[0] * found.W @ X
    incidence = found.A_s @ X
    assert incidence == pytest.approx(1.0 + q[0] * found.E @ X + lift / W * sag, rel=1e-9)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: replace(WING, GJ=0.0), "GJ must be positive"),
        (lambda: replace(WING, chord=-1.0), "chord must be positive"),
        (lambda: replace(WING, lift_slope=np.nan), "lift_slope must be positive"),
        (lambda: wing_twist(7.0, WING, q=1.0, incidence=0.1), "y must lie on the span"),
        (lambda: wing_twist(1.0, WING, q=1e6, incidence=0.1), "below divergence"),
        (lambda: wing_twist(1.0, WING, q=-1.0, incidence=0.1), "q must not be negative"),
        (lambda: roll_moment(1e6, WING, CONTROL), "below divergence"),
        (
            lambda: roll_rate_effectiveness(1.0, WING, ControlSlopes(lift_per_rad=0.0, moment_per_rad=1.0)),
            "lift_per_rad",
        ),
        (
            lambda: swept_divergence_pressure(
                pitch_stiffness=1.0,
                bending_stiffness=1.0,
                eccentricity=0.1,
                chord=1.0,
                span=1.0,
                lift_slope=6.0,
                sweep=np.pi / 2,
            ),
            "got 90 deg",
        ),
        (
            lambda: swept_divergence_pressure(
                pitch_stiffness=1.0,
                bending_stiffness=0.0,
                eccentricity=0.1,
                chord=1.0,
                span=1.0,
                lift_slope=6.0,
                sweep=0.0,
            ),
            "bending_stiffness must be positive",
        ),
        (lambda: slopes(q=-1.0), "q must not be negative"),
        (lambda: slopes(chord=0.0), "chord must be positive"),
        (lambda: slopes(aircraft_weight=0.0), "aircraft_weight must be positive"),
        (lambda: slopes(points=1), "points must be 2 or more"),
    ],
)
def test_refusals(call: Any, words: str) -> None:
    """Each names what is wrong."""
    with pytest.raises(ValueError, match=words):
        call()


def slopes(q: float = 1.0, chord: float = 1.0, aircraft_weight: float | None = None, points: int = 4) -> Any:
    """Flexible slopes of some wing."""
    beam = SlenderBeam(y=[0.0, 6.0], mass=10.0, inertia=5.0, EI=2e6, GJ=1e6)
    return flexible_slopes(
        beam, q, chord=chord, eccentricity=0.1, lift_slope=5.0, aircraft_weight=aircraft_weight, points=points
    )
