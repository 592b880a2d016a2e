"""Strips: each theory against the section it is made of, sums over a wing, and sweep."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from aeroservo.aero.indicial import KUSSNER_SEARS_SPARKS, WAGNER_R_T_JONES, sears_function
from aeroservo.aero.strip import NO_WAKE, Indicial, QuasiSteady, Strips, StripShapes, Theodorsen, strip_aero
from aeroservo.aero.theodorsen import section_air, theodorsen_function

IDENTITY = 1e-12  # relative: the same sum by another route
SPLINE = 1e-7  # relative: cubic spline of the default samples against the function itself
K = np.array([0.0, 1e-4, 0.03, 0.2, 0.7, 2.0])


def strips(n=1, **changes):
    """n strips of one half wing."""
    given = {
        "y": np.linspace(0.3, 2.0, n),
        "width": np.full(n, 2.0 / n),
        "b": np.full(n, 0.4),
        "a": np.full(n, -0.2),
        "eccentricity": np.full(n, 0.15),
        "lift_slope": np.full(n, 5.5),
        "moment_rate": np.full(n, -1.2),
        "sweep": np.zeros(n),
        "elevon_lift": np.full(n, 1.1),
        "elevon_moment": np.full(n, -0.3),
        "incidence": np.full(n, 0.03),
        "cm0": np.full(n, 0.01),
        "span": 2.0,
    }
    return Strips(**(given | changes))


def shapes_of(n=1, flap=False, seed=1):
    rng = np.random.default_rng(seed)
    return StripShapes(
        h=rng.normal(size=(n, 3)),
        twist=rng.normal(size=(n, 3)),
        slope=np.zeros((n, 3)),
        flap=rng.normal(size=(n, 3)) if flap else None,
    )


NAMES = ("one", "two", "three")


def summed(wing, shapes, matrix):
    """Section matrices of each strip on the modes, by a plain loop."""
    columns = [shapes.h, shapes.twist] + ([] if shapes.flap is None else [shapes.flap])
    total = 0.0
    for j in range(len(wing.y)):
        work = np.stack([column[j] for column in columns])
        total = total + wing.width[j] * work.T @ matrix(j) @ work
    return total


@pytest.mark.parametrize("flap", [False, True])
@pytest.mark.parametrize(
    "theory", [Indicial(), Indicial(wagner=NO_WAKE), Theodorsen()], ids=["jones", "no wake", "exact"]
)
def test_modes_columns_are_the_sum_of_sections(theory, flap):
    n = 4
    wing = strips(n, b=np.array([0.5, 0.4, 0.4, 0.2]), hinge=0.5 if flap else None)
    shapes = shapes_of(n, flap)
    aero, _ = strip_aero(wing, shapes, NAMES, theory)
    deficiency = (
        (lambda p: theodorsen_function(p.imag))
        if isinstance(theory, Theodorsen)
        else (lambda p: theory.wagner.frequency_response(p))
    )
    for k in K:

        def section(j, k=k):
            air = section_air(wing.a[j], wing.b[j], lift_slope=wing.lift_slope[j], hinge=wing.hinge)
            return air(1j * k * wing.b[j] / aero.b, deficiency)

        expected = summed(wing, shapes, section)
        tolerance = SPLINE if isinstance(theory, Theodorsen) else IDENTITY
        np.testing.assert_allclose(aero(k)[:, :3], expected, rtol=tolerance, atol=tolerance * np.abs(expected).max())


@pytest.mark.parametrize("damped", [False, True])
def test_quasi_steady_is_3_18_and_3_20(damped):
    wing, p = strips(), 0.3j
    shapes = StripShapes(h=np.array([[1.0, 0.0]]), twist=np.array([[0.0, 1.0]]), slope=np.zeros((1, 2)))
    aero, _ = strip_aero(wing, shapes, ("h", "theta"), QuasiSteady(damped=damped))
    c, a_w, e, b = 0.8, 5.5, 0.15, 0.4
    angle = np.array([p / b, 1.0])  # theta + h'/V with h' = s h, s = p V/b
    rate = np.array([0.0, p / b]) * c / 4.0 * (-1.2 if damped else 0.0)  # M_thetadot theta' c / (4 V)
    expected = 2.0 * np.stack([-c * a_w * angle, c**2 * (e * a_w * angle + rate)])
    np.testing.assert_allclose(aero.laplace(p)[:, :2], expected, rtol=IDENTITY, atol=1e-15)


def test_every_theory_has_the_same_steady_forces():
    wing = strips(3, eccentricity=np.full(3, 0.15))
    shapes = shapes_of(3)
    every = [strip_aero(wing, shapes, NAMES, t) for t in (QuasiSteady(), Indicial(), Theodorsen())]
    for aero, loads in every[1:]:
        np.testing.assert_allclose(aero(0.0), every[0][0](0.0), rtol=1e-12, atol=1e-14)
        np.testing.assert_allclose(loads.Q, every[0][1].Q, rtol=1e-12, atol=1e-14)


def test_gust_column_is_the_entry_function_at_the_leading_edge():
    wing, shapes = strips(), shapes_of()
    column = 4  # three modes, the elevon, the gust
    steady = strip_aero(wing, shapes, NAMES, Theodorsen())[0](0.0)[:, column].real
    exact, lags = (strip_aero(wing, shapes, NAMES, t)[0] for t in (Theodorsen(), Indicial()))
    assert [i.kind for i in exact.inputs][3:5] == ["control", "gust"]
    S = sears_function(K, reference="leading_edge")
    np.testing.assert_allclose(exact(K)[:, :, column], S[:, None] * steady, rtol=SPLINE, atol=1e-8)
    S = KUSSNER_SEARS_SPARKS.frequency_response(1j * K)
    np.testing.assert_allclose(lags(K)[:, :, column], S[:, None] * steady, rtol=IDENTITY, atol=1e-14)
    assert not np.any(lags.A2[..., column])


def test_steady_columns_and_loads():
    wing, shapes = strips(5), shapes_of(5)
    aero, loads = strip_aero(wing, shapes, NAMES, QuasiSteady())
    index = {i.name: j for j, i in enumerate(aero.inputs)}
    chord, w = 0.8, wing.width
    lift = loads.row("lift")
    assert lift[index["incidence"]] == pytest.approx(np.sum(w) * chord * 5.5, rel=IDENTITY)
    assert lift[index["camber"]] == pytest.approx(np.sum(w) * chord * 5.5 * 0.03, rel=IDENTITY)
    assert lift[index["elevon"]] == pytest.approx(np.sum(w) * chord * 1.1, rel=IDENTITY)
    roll = loads.row("roll")
    assert roll[index["elevon"]] == pytest.approx(np.sum(w * wing.y) * chord * 1.1, rel=IDENTITY)
    # starboard wing down at helix angle 1: incidence y/s, lift up, against the roll
    assert roll[index["roll_rate"]] == pytest.approx(np.sum(w * wing.y**2) / 2.0 * chord * 5.5, rel=IDENTITY)
    moment = chord**2 * (0.15 * 5.5 * 0.03 + 0.01)
    force = np.stack([np.full(5, -chord * 5.5 * 0.03), np.full(5, moment)])
    expected = np.einsum("s,sj->j", w * force[0], shapes.h) + np.einsum("s,sj->j", w * force[1], shapes.twist)
    np.testing.assert_allclose(aero(0.0)[:, index["camber"]].real, expected, rtol=IDENTITY)


@pytest.mark.parametrize("theory", [QuasiSteady(), Indicial(), Theodorsen()], ids=["quasi", "jones", "exact"])
def test_sweep_is_the_normal_component(theory):
    # no slope: forces of the straight wing at V cos L, so q cos^2 L and k / cos L
    sweep = 0.5
    straight, swept = strips(3), strips(3, sweep=np.full(3, sweep))
    shapes = shapes_of(3)
    one, two = (strip_aero(wing, shapes, NAMES, theory)[0] for wing in (straight, swept))
    for k in (0.0, 0.1, 0.6):
        expected = np.cos(sweep) ** 2 * one(k / np.cos(sweep))[:, :3]
        np.testing.assert_allclose(two(k)[:, :3], expected, rtol=1e-7, atol=1e-7 * np.abs(expected).max())
    # an incidence in the plane of the flow is larger in the normal section
    index = [i.name for i in one.inputs].index("incidence")
    np.testing.assert_allclose(two(0.0)[:, index], np.cos(sweep) * one(0.0)[:, index], rtol=IDENTITY)


@pytest.mark.parametrize("theory", [Indicial(), Theodorsen()], ids=["jones", "exact"])
def test_flat_plate_that_turns_about_the_wind_axis_alone_has_no_steady_lift(theory):
    # a rigid swept wing that rolls by phi about the direction of flow keeps its incidence: twist and slope cancel
    sweep, n = 0.4, 3
    wing = strips(n, sweep=np.full(n, sweep))
    phi = np.stack([wing.y, 0 * wing.y, 0 * wing.y], axis=1)  # h = phi y, down on the starboard side
    twist = np.zeros((n, 3))
    twist[:, 0] = -np.sin(sweep)  # about the axis (sin, cos) the rotation -x has this nose-up part
    slope = np.zeros((n, 3))
    slope[:, 0] = np.cos(sweep)
    aero, loads = strip_aero(wing, StripShapes(h=phi, twist=twist, slope=slope), NAMES, theory)
    np.testing.assert_allclose(aero(0.0)[:, 0], 0.0, atol=1e-13)
    np.testing.assert_allclose(loads.Q[:, 0], 0.0, atol=1e-13)


def test_few_lags_where_strips_share_a_chord():
    aero, _ = strip_aero(strips(40), shapes_of(40), NAMES, Indicial())
    assert len(aero.lags) == 2 * 3 + 2  # two exponentials of Wagner on three modes, two of Kuessner
    poles = np.unique(np.round(aero.lags, 12))
    np.testing.assert_allclose(poles, np.unique([*WAGNER_R_T_JONES.exponents, *KUSSNER_SEARS_SPARKS.exponents]))


@pytest.mark.parametrize(
    ("change", "message"),
    [({"b": np.array([0.0])}, "semi-chord"), ({"sweep": np.array([1.6])}, "sweep"), ({"span": 0.0}, "span")],
)
def test_bad_strips_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        strips(1, **change)
    assert replace(strips(2), span=3.0).span == 3.0
