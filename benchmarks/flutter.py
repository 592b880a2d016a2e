"""Flutter sweeps against the bare eigenvalue calls they contain, and a population of models in one call."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.linear import state_matrix
from aeroservo.aeroelastic.pk import frequency_roots
from aeroservo.aeroelastic.population import population_flutter
from aeroservo.aeroelastic.roots import p_roots
from aeroservo.aeroelastic.tracking import follow, resolved_mesh
from aeroservo.aircraft.files import read
from aeroservo.datatypes import AeroelasticModel, AeroInput, FlightCondition, ModalModel, RationalAero
from benchmarks.side_by_side import Row, compare

MEMBERS = 10_000


def measure() -> list[Row]:
    """V-g sweeps by p, p-k with Theodorsen, and 10,000 flutter speeds at the promised rate."""
    rows = [_sweep(n) for n in (3, 10, 20)]
    rows.append(_p_k())
    seconds = _population()
    rows.append(
        Row(f"{MEMBERS} refined 3-DOF flutter speeds / the time at 2,500 a second", seconds, MEMBERS / 2500, 1.0)
    )
    return rows


def _sweep(n: int) -> Row:
    """400 speeds with eigenvectors and followed modes against numpy's eig of the same matrices."""
    model, sweep = random_model(n), FlightCondition(V=np.linspace(1.0, 120.0, 400), rho=1.225)

    def own() -> None:
        found = p_roots(model, sweep)
        _, values, steps = resolved_mesh(
            lambda V: np.linalg.eigvals(state_matrix(model, FlightCondition(V=V, rho=1.225))), sweep.V, found.values
        )
        follow(values, steps)

    A = state_matrix(model, sweep)
    return compare(f"V-g sweep, 400 speeds, {n} modes / bare eig", own, lambda: np.linalg.eig(A), target=1.5)


def _p_k() -> Row:
    """p-k of a section at 100 speeds against its own eigenvalue calls, recorded and repeated."""
    model = build(read("nasa-typical-section"), "theodorsen")
    sweep = FlightCondition(V=np.linspace(2.0, 120.0, 100), rho=1.225)
    calls: list[Callable[[], object]] = []
    eig, eigvals = np.linalg.eig, np.linalg.eigvals
    try:
        np.linalg.eig = lambda A: calls.append(lambda: eig(A)) or eig(A)  # type: ignore[assignment, func-returns-value]
        np.linalg.eigvals = lambda A: calls.append(lambda: eigvals(A)) or eigvals(A)  # type: ignore[assignment, func-returns-value]
        frequency_roots(model, sweep)
    finally:
        np.linalg.eig, np.linalg.eigvals = eig, eigvals
    return compare(
        "p-k, Theodorsen, 2 DOF, 100 speeds / its own eigenvalue calls",
        lambda: frequency_roots(model, sweep),
        lambda: [call() for call in calls],
        target=2.5,
    )


def random_model(n: int) -> AeroelasticModel:
    """A stable structure of n modes in weakly coupling quasi-steady air."""
    rng = np.random.default_rng(n)
    K = np.diag(np.linspace(10.0, 40.0 * n, n) ** 2)
    A0, A1 = (0.3 * rng.standard_normal((1, n, n)) - k * np.eye(n) for k in (0.0, 2.0))
    names = tuple(f"mode {j + 1}" for j in range(n))
    return AeroelasticModel(
        modes=ModalModel(M=np.eye(n), D=np.zeros((n, n)), K=K, names=names),
        aero=RationalAero(
            A0=A0, A1=A1, A2=0.0 * A0, b=0.5, inputs=tuple(AeroInput(name=name, kind="mode") for name in names)
        ),
    )


def _population() -> float:
    """Seconds for a population of wings with bending, torsion and a third mode in quasi-steady air."""
    rng = np.random.default_rng(0)
    b, a = rng.uniform(0.1, 1.0, MEMBERS), rng.uniform(-0.4, 0.2, MEMBERS)
    m = rng.uniform(5.0, 60.0, MEMBERS) * np.pi * 1.2 * b**2
    x, r2 = rng.uniform(0.0, 0.4, MEMBERS), rng.uniform(0.3, 0.6, MEMBERS)
    w = rng.uniform(5.0, 40.0, MEMBERS)
    M, K = (np.zeros((MEMBERS, 3, 3)) for _ in range(2))
    M[:, 0, 0], M[:, 1, 1], M[:, 2, 2] = m, m * (r2 + x**2) * b**2, 0.5 * m
    M[:, 0, 1] = M[:, 1, 0] = m * x * b
    M[:, 0, 2] = M[:, 2, 0] = 0.2 * m
    for j, factor in enumerate((1.0, rng.uniform(1.2, 4.0, MEMBERS), rng.uniform(5.0, 12.0, MEMBERS))):
        K[:, j, j] = M[:, j, j] * (w * factor) ** 2
    plunge, pitch = np.array([1.0, 0.0, 0.3]), np.array([0.0, 1.0, 0.2])
    lift = 2.0 * b * 2.0 * np.pi
    force = -lift[:, None] * plunge + (lift * 2.0 * b * 0.5 * (a + 0.5))[:, None] * pitch
    A0 = force[:, :, None] * pitch
    A1 = force[:, :, None] * plunge / b[:, None, None] - 2.4 * (b**2)[:, None, None] * pitch[:, None] * pitch
    none = np.zeros_like(M)
    population_flutter(M[:10], none[:10], K[:10], A0[:10], A1[:10], none[:10], b=b[:10], rho=1.2, V_range=(1.0, 400.0))
    start = time.perf_counter()
    population_flutter(M, none, K, A0, A1, none, b=b, rho=1.2, V_range=(1.0, 400.0))
    return time.perf_counter() - start
