"""Flutter of random physical sections and wings: what must hold of every one of them.

Every model is made from `numpy.random.default_rng([KIND, seed])`; a failure prints the kind and the seed, and
`model_of(kind, seed)` makes the same model again.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.flutter import PK, FlutterResult, G, K, P, flutter
from aeroservo.aeroelastic.linear import state_matrix
from aeroservo.aircraft.files import read, validate
from aeroservo.datatypes import AeroelasticModel, FlightCondition
from aeroservo.structure.damping import modal_damping

AGREEMENT = 1e-6  # relative, speed and frequency of a crossing: contract.md, "Methods agree"
RHO = 1.225


# --- random models ----------------------------------------------------------------------------------------------------


def random_section(rng: np.random.Generator) -> tuple[dict, float]:
    """A typical section and the speed b omega sqrt(mass ratio), on which all its speeds scale."""
    b, mass_ratio = 10 ** rng.uniform(-1.0, 0.3), 10 ** rng.uniform(0.5, 2.0)
    m, x = mass_ratio * np.pi * RHO * b**2, rng.uniform(-0.2, 0.5)
    r2 = x**2 + rng.uniform(0.1, 0.5)
    omega, ratio = 10 ** rng.uniform(0.5, 2.5), rng.uniform(0.1, 1.6)
    section = {
        "chord_m": 2.0 * b,
        "flexural_axis": rng.uniform(0.2, 0.6),
        "mass_kg_per_m": m,
        "static_moment_kg": m * x * b,
        "inertia_kg_m": m * r2 * b**2,
        "plunge_stiffness_N_per_m2": m * (ratio * omega) ** 2,
        "pitch_stiffness_N": m * r2 * b**2 * omega**2,
        "moment_rate_derivative": -rng.uniform(0.0, 2.0),
    }
    if rng.random() < 0.15:
        hinge, part = rng.uniform(0.65, 0.9), rng.uniform(0.02, 0.1)
        chord = 2.0 * b * (1.0 - hinge)
        inertia = part * m * chord**2 / 3.0
        section["flap"] = {
            "hinge": hinge,
            "flap_static_moment_kg": rng.uniform(0.0, 0.5) * part * m * chord,
            "flap_inertia_kg_m": inertia,
            "hinge_stiffness_N": inertia * (rng.uniform(0.5, 4.0) * omega) ** 2,
        }
    data = {"kind": "typical_section", "name": "random", "section": section} | damping_of(rng, 2)
    return data, b * omega * np.sqrt(mass_ratio * r2)


def random_assumed(rng: np.random.Generator) -> tuple[dict, float]:
    """A binary wing, or the same with heave."""
    s, c = rng.uniform(1.0, 10.0), rng.uniform(0.2, 2.5)
    mu, omega = 10 ** rng.uniform(0.7, 2.3) * c, 10 ** rng.uniform(0.7, 2.0)
    axis = rng.uniform(0.3, 0.55)
    wing = {
        "semi_span_m": s,
        "chord_m": c,
        "flexural_axis": axis,
        "mass_kg_per_m2": mu,
        "plunge_stiffness_N_per_m": mu * s * c / 5.0 * (rng.uniform(0.1, 1.2) * omega) ** 2,
        "pitch_stiffness_N_m": mu * s * c**3 * (1.0 / 3.0 - axis + axis**2) / 3.0 * omega**2,
        "lift_slope_per_rad": rng.uniform(2.5, 6.3),
        "moment_rate_derivative": -rng.uniform(0.0, 1.5),
        "elevon": {"lift_per_rad": rng.uniform(0.3, 2.0), "moment_per_rad": -rng.uniform(0.05, 0.5)},
    }
    kind = "binary_wing"
    if rng.random() < 0.5:
        kind, wing["centre_mass_kg"] = "whole_aircraft", rng.uniform(0.0, 3.0) * mu * s * c
    data = {"kind": kind, "name": "random", "wing": wing} | damping_of(rng, 2)
    return data, c * omega * np.sqrt(mu / (RHO * c))


def random_beam(rng: np.random.Generator) -> tuple[dict, float]:
    """A tapered, perhaps swept, perhaps free beam wing of two or three stations."""
    s, c, count = rng.uniform(2.0, 12.0), rng.uniform(0.3, 2.0), int(rng.integers(2, 4))
    m, omega, taper = 10 ** rng.uniform(1.0, 1.7) * c**2, 10 ** rng.uniform(1.0, 2.0), rng.uniform(0.4, 1.0)
    inertia = m * c**2 * rng.uniform(0.06, 0.12)
    bending = rng.uniform(0.1, 1.0) * omega
    axis, offset = rng.uniform(0.28, 0.5), rng.uniform(-0.05, 0.15)
    stations = []
    for eta in np.linspace(0.0, 1.0, count):
        part = 1.0 - (1.0 - taper) * eta
        stations.append(
            {
                "y_m": s * eta,
                "chord_m": c * part,
                "flexural_axis": axis,
                "cg_axis": axis + offset,
                "mass_kg_per_m": m * part**2,
                "inertia_kg_m": (inertia + m * (offset * c) ** 2) * part**4,
                "EI_N_m2": m * s**4 * (bending / 3.516) ** 2 * part**4,
                "GJ_N_m2": inertia * (2.0 * s * omega / np.pi) ** 2 * part**4,
            }
        )
    wing = {
        "station": stations,
        "sweep_deg": rng.uniform(-20.0, 35.0) if rng.random() < 0.5 else 0.0,
        "root": "clamped",
    }
    if rng.random() < 0.3:
        wing |= {"root": "free", "symmetry": "symmetric" if rng.random() < 0.5 else "antisymmetric"}
        wing["mass"] = [{"y_m": 0.0, "x_m": 0.0, "mass_kg": m * s, "inertia_kg_m2": m * s * c**2}]
    return {"kind": "beam_wing", "name": "random", "wing": wing}, c * omega * np.sqrt(m / (RHO * c**2))


def damping_of(rng: np.random.Generator, n: int) -> dict:
    """No damping, or a little of every mode."""
    return {"damping": {"modal": {"ratios": [*rng.uniform(0.0, 0.03, n)]}}} if rng.random() < 0.4 else {}


KINDS = {"section": random_section, "assumed": random_assumed, "beam": random_beam}


def model_of(kind: str, seed: int, aero: str) -> tuple[AeroelasticModel, float, float]:
    """The random model number `seed` of a kind, and lowest and highest speed of its sweep."""
    rng = np.random.default_rng([list(KINDS).index(kind), seed])
    data, speed = KINDS[kind](rng)
    low, high = speed * np.array([rng.uniform(0.02, 0.1), rng.uniform(1.0, 3.0)])
    return build(validate(data, f"{kind} {seed}"), aero), low, high


def sweep(low: float, high: float, n: int) -> FlightCondition:
    return FlightCondition(V=np.linspace(low, high, n), rho=RHO)


# --- what must hold ---------------------------------------------------------------------------------------------------


def problems_of(result: FlutterResult, model: AeroelasticModel, low: float, high: float) -> list[str]:
    """Everything about one result that cannot be right."""
    found = []
    edges = [b.V for b in result.boundaries]
    if edges != sorted(edges) or any(not low <= V <= high for V in edges):
        found.append(f"boundaries not in order or range: {edges}")
    starts = [low if i.start is None else i.start for i in result.intervals]
    if starts != sorted(starts):
        found.append(f"intervals not in order: {result.intervals}")
    for i, start in zip(result.intervals, starts):
        if not (start < (high if i.end is None else i.end) or start == i.end == low):
            found.append(f"empty interval {i}")
        born_real = any(b.kind == "merge" and i.start == b.V for b in result.boundaries)  # two real roots met: from 0
        if not np.isfinite(i.frequency) or (i.kind == "flutter" and not born_real) != (i.frequency > 0.0):
            found.append(f"frequency of {i}")
        for V in (i.start, i.end):
            if V is not None and V not in edges:
                found.append(f"{i} ends at no boundary")
    if result.flutter_speed is not None and not np.isfinite([result.flutter_speed, result.flutter_frequency]).all():
        found.append("flutter speed is not finite")
    if len(set(result.names)) != len(result.names):
        found.append(f"names used twice: {result.names}")
    if result.method == "p" and not np.isfinite(result.roots).all():
        found.append("the p method has every root at every speed, yet some are nan")
    if np.isinf(result.roots).any() or np.isinf(result.shapes).any():
        found.append("infinite root or shape")
    return found


def uncovered(result: FlutterResult, model: AeroelasticModel, low: float, high: float) -> list[str]:
    """Speeds where eigenvalues of the state matrix (bare, not by our search) and intervals disagree."""
    V = np.linspace(low, high, 101)
    edges = np.array([b.V for b in result.boundaries])
    if edges.size:
        V = V[np.all(np.abs(V[:, None] - edges) > 1e-5 * high, axis=1)]
    values = np.linalg.eigvals(state_matrix(model, FlightCondition(V=V, rho=RHO)))
    size = np.abs(values).max()
    pairs = np.sum((values.imag > 0.0) & (values.real > 1e-7 * np.abs(values)), axis=1)
    reals = np.sum((values.imag == 0.0) & (values.real > 1e-9 * size), axis=1)
    found = []
    for speed, n_pairs, n_reals in zip(V, pairs, reals):
        inside = [
            i for i in result.intervals if (i.start is None or i.start < speed) and (i.end is None or speed < i.end)
        ]
        flutters = sum(i.kind == "flutter" for i in inside)
        if flutters != n_pairs or (n_reals > 0) != (flutters < len(inside)):
            found.append(
                f"at {speed:.9g} m/s {n_pairs} pairs and {n_reals} real roots are unstable, intervals: {inside}"
            )
    return found[:1]


def difference(one: FlutterResult, two: FlutterResult) -> list[str]:
    """How names, intervals and boundaries of two results on different grids differ."""
    found = []
    if one.names != two.names:
        found.append(f"names {one.names} and {two.names}")
    labels = [[(i.kind, i.mode) for i in r.intervals] for r in (one, two)]
    if labels[0] != labels[1]:
        found.append(f"intervals {one.intervals} and {two.intervals}")
    kinds = [[(b.kind, b.opens) for b in r.boundaries] for r in (one, two)]
    if kinds[0] != kinds[1]:
        found.append(f"boundaries {one.boundaries} and {two.boundaries}")
    elif not np.allclose([b.V for b in one.boundaries], [b.V for b in two.boundaries], rtol=AGREEMENT, atol=0.0):
        found.append(f"speeds {one.boundaries} and {two.boundaries}")
    return found + crossings_differ(one, two)


def crossings_differ(one: FlutterResult, two: FlutterResult, limit: float = np.inf) -> list[str]:
    """How the sets of (speed, frequency) crossings below a speed differ."""
    a, b = (r.crossings[r.crossings[:, 0] < limit] for r in (one, two))
    if a.shape != b.shape or not np.allclose(a, b, rtol=AGREEMENT, atol=0.0):
        return [f"crossings by {one.method} {a.tolist()} and by {two.method} {b.tolist()}"]
    return []


def grid_problems(kind: str, seed: int, aero: str, method: P | PK | K | G, n: int) -> list[str]:
    """Run one model on three grids; what is wrong with the results or differs between them."""
    model, low, high = model_of(kind, seed, aero)
    results = [flutter(model, sweep(low, high, m), method) for m in (n, 2 * n, 3 * n + 1)]
    found = [p for r in results for p in problems_of(r, model, low, high)]
    found += [p for r in results[1:] for p in difference(results[0], r)]
    if isinstance(method, P):
        found += uncovered(results[0], model, low, high)
    return [f"{kind}, seed {seed}, {aero}, {method}: {p}" for p in found]


def method_problems(kind: str, seed: int, aero: str, methods: tuple) -> list[str]:
    """Run one model by several methods; how their crossings differ."""
    model, low, high = model_of(kind, seed, aero)
    results = [flutter(model, sweep(low, high, 21), method) for method in methods]
    found = [p for r in results for p in problems_of(r, model, low, high)]
    for other in results[1:]:
        # the g method's expansion has roots of its own past divergence, and may lose one there to them
        limit = results[0].first_real_instability if isinstance(methods[results.index(other)], G) else None
        found += crossings_differ(results[0], other, np.inf if limit is None else limit)
    return [f"{kind}, seed {seed}, {aero}: {p}" for p in found]


GROUP = 25


def groups(total: int) -> list[range]:
    return [range(i, min(i + GROUP, total)) for i in range(0, total, GROUP)]


@pytest.mark.parametrize("seeds", groups(400), ids=str)
def test_random_sections_on_three_grids(seeds):
    found = [p for seed in seeds for p in grid_problems("section", seed, "jones", P(), 15)]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("seeds", groups(150), ids=str)
def test_random_assumed_wings_and_aircraft_on_three_grids(seeds):
    found = [p for seed in seeds for p in grid_problems("assumed", seed, "jones", P(), 15)]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("seeds", groups(25), ids=str)
def test_random_beams_on_three_grids(seeds):
    found = [p for seed in seeds for p in grid_problems("beam", seed, "quasi_steady_damped", P(), 15)]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("kind", ["section", "assumed"])
def test_sampled_air_forces_on_three_grids(kind):
    found = [p for seed in range(4) for p in grid_problems(kind, seed, "theodorsen", PK(), 15)]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(("kind", "count"), [("section", 8), ("assumed", 3)])
def test_p_pk_k_and_g_agree_on_the_same_rational_air_forces(kind, count):
    found = [p for seed in range(count) for p in method_problems(kind, seed, "jones", (P(), PK(), K(), G()))]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(("kind", "count"), [("section", 6), ("assumed", 3)])
def test_pk_k_and_g_agree_on_the_same_samples(kind, count):
    found = [p for seed in range(20, 20 + count) for p in method_problems(kind, seed, "theodorsen", (PK(), K(), G()))]
    assert not found, "\n".join(found)


# --- a hump narrower than the step ------------------------------------------------------------------------------------


ELASTIC = 2  # modes of the thesis aircraft besides heave


def with_damping(model: AeroelasticModel, ratio: float) -> AeroelasticModel:
    return replace(model, modes=replace(model.modes, D=modal_damping(model.modes, [ratio] * ELASTIC)))


def humped(width: float) -> tuple[AeroelasticModel, float, float]:
    """Thesis aircraft with lags, modal damping tuned so that bending is unstable over `width` m/s; its two edges.

    Undamped, bending is unstable from 61.7 to 77.7 m/s; damping shrinks that range to nothing. Found by the growth of
    bare eigenvalues on a fine grid and bisection, without the search that is under test.
    """
    model = build(read("thesis-aircraft"), "jones")
    V = np.linspace(50.0, 90.0, 401)

    def growth(ratio: float, V: np.ndarray) -> np.ndarray:
        values = np.linalg.eigvals(state_matrix(with_damping(model, ratio), FlightCondition(V=V, rho=RHO)))
        return np.where(values.imag > 35.0, values.real, -np.inf).max(axis=1)  # torsion swings below 35 rad/s there

    def edges(ratio: float) -> tuple[float, float]:
        top = V[np.argmax(growth(ratio, V))]
        top = minimize_scalar(
            lambda v: -growth(ratio, np.array([v]))[0], bounds=(top - 0.2, top + 0.2), method="bounded"
        ).x
        if growth(ratio, np.array([top]))[0] <= 0.0:
            return top, top
        ends = [brentq(lambda v: growth(ratio, np.array([v]))[0], top, far, xtol=1e-12) for far in (50.0, 90.0)]
        return ends[0], ends[1]

    ratio = brentq(lambda r: np.subtract(*edges(r)[::-1]) - width, 0.0, 0.3, xtol=1e-15)
    return with_damping(model, ratio), *edges(ratio)


@pytest.mark.parametrize("width", [2.0, 0.2, 0.02])
def test_hump_a_fifth_of_a_step_wide_is_found(width):
    model, first, last = humped(width)
    assert last - first == pytest.approx(width, rel=1e-3)
    step = 5.0 * width
    for shift in (0.1, 0.5, 0.77):  # where the hump lies between two speeds of the sweep
        low = first - step * (3.0 + shift)
        # so many steps that the search's own speeds are no closer than the sweep's
        for V in (low + step * np.arange(8), low + step * np.arange(160) * (160 * step < 60.0)):
            V = np.unique(V[(V > 1.0) & (V < 0.99 * 300.0)])
            if V.size < 4:
                continue
            found = flutter(model, FlightCondition(V=V, rho=RHO), P())
            near = [b for b in found.boundaries if abs(b.V - first) < width or abs(b.V - last) < width]
            assert [b.opens for b in near if b.root.imag > 35.0] == [True, False], (width, shift, found.boundaries)
            speeds = [b.V for b in near if b.root.imag > 35.0]
            np.testing.assert_allclose(speeds, [first, last], rtol=AGREEMENT)
