"""The engine against a bare compiled loop, `scipy.integrate.solve_ivp`, its own second worker, its own memory.

- Bare loop: numba code written out for one model below, the same Runge-Kutta arithmetic, controller, limits and noise,
  nothing general. Its final state is checked against the engine's before anything is timed.
- solve_ivp (scipy, RK45): restarted at every sample of what is held (turbulence: 1 ms); 1 s of it, scaled to 60 s. Once
  at rtol 1e-6, once at 1e-10, which is what the engine's own step is checked for (1e-7 over two seconds of thousands of
  steps); and, the limits left out, against the engine's exact steps. A restart costs scipy 0.1 to 0.2 ms whatever the
  model: ratios of a thousand and more belong to smaller plants that need one Runge-Kutta step for each sample.
- Two workers against one: 1,000 runs, warm pools, in turns; and the processor time of both, which a busy machine does
  not spoil.
- Memory: peak of a run ten times as long, statistics only, over that of the short one.
- Second start: a fresh process with a warm cache of compiled code against one that imports numba and compiles nothing.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
import tracemalloc
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

import aeroservo as av
from aeroservo.control.controller import Controller
from aeroservo.datatypes import AeroelasticModel, FlightCondition
from aeroservo.servo import Actuator, Sensor
from aeroservo.simulate.disturbances import Gustiness
from aeroservo.simulate.engine import linearised, run_prepared, simulate
from aeroservo.simulate.montecarlo import Variant, ensemble, local_pool, run_batch, run_seeds
from aeroservo.simulate.prepare import prepare
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Prepared, Scenario, Stepping
from aeroservo.simulate.state import RunState
from benchmarks.side_by_side import Row, compare

V, DURATION, SAMPLE = 38.0, 60.0, 0.005
LIMIT, RATE = 0.2, 3.0
#: Part of the thousand runs that is timed in each round: about 60 s of work in all rounds.
WORK = 1000


def plant() -> AeroelasticModel:
    """Plant 4 + actuator 2 + five sensors with a lag: 11 states, and three more in the sampled controller."""
    model = replace(linearised(av.build(av.read("thesis-simulation"))), limits=())
    rows = {"gyro": ((), (0.0, 1.0)), "angle": ((0.0, 1.0), ()), "height": ((1.0, 0.0), ()), "sink": ((), (1.0, 0.0))}
    sensors = [
        Sensor(name=name, unit="x", displacement=d, rate=r, bandwidth=200.0, noise=1e-4)
        for name, (d, r) in rows.items()
    ]
    sensors.append(Sensor(name="tip", unit="x", displacement=(1.0, 0.3), bandwidth=200.0, noise=1e-4))
    servo = Actuator(control="elevon", omega=165.0, zeta=1.0, limit=LIMIT, rate_limit=RATE)
    return replace(model, sensors=tuple(sensors), actuators=(servo,))


def controller() -> Controller:
    """Filtered feedback of five noisy sensors at 200 Hz."""
    return Controller(
        A=np.diag([0.8, 0.7, 0.6]),
        B=0.1 * np.array([[1.0, 0, 0, 0, 0], [0, 1.0, 0, 0, 0.2], [0, 0, 1.0, 1.0, 0]]),
        C=[[0.05, 0.1, 0.1]],
        D=[[0.05, 0.1, 0.1, 0.05, 0.01]],
        inputs=("gyro", "angle", "height", "sink", "tip"),
        outputs=("elevon_command_rad",),
        dt_s=SAMPLE,
    )


def scenario() -> Scenario:
    """60 s of closed loop in turbulence."""
    return Scenario(profile=level(V), duration=DURATION, controller=controller(), turbulence=Gustiness(level=2.0))


@njit(cache=True)
def bare(A, Bw, Bs, pull_row, pull_s, at, w, zeta, rate, limit, Ac, Bc, Cc, Dc, C, noise, gust, x, n_sub, dt, period):
    """The same run written out: A without the actuator's pull, which is clipped; statistics of the states."""
    n, m = x.shape[0], Ac.shape[0]
    xc, new = np.zeros(m), np.zeros(m)
    y = np.zeros(C.shape[0])
    k1, total, stage_x = np.zeros(n), np.zeros(n), np.zeros(n)
    peak, square = np.zeros(n), np.zeros(n)
    u, h = 0.0, dt / n_sub
    for k in range(gust.shape[0]):
        if k % period == 0:
            for i in range(C.shape[0]):
                value = noise[k // period, i]
                for j in range(n):
                    value += C[i, j] * x[j]
                y[i] = value
            u = 0.0
            for j in range(m):
                u += Cc[0, j] * xc[j]
            for j in range(C.shape[0]):
                u += Dc[0, j] * y[j]
            for i in range(m):
                value = 0.0
                for j in range(m):
                    value += Ac[i, j] * xc[j]
                for j in range(C.shape[0]):
                    value += Bc[i, j] * y[j]
                new[i] = value
            for i in range(m):
                xc[i] = new[i]
            u = min(max(u, -limit), limit)
        for i in range(n):
            peak[i] = max(peak[i], abs(x[i]))
            square[i] += x[i] * x[i]
        for _ in range(n_sub):
            for i in range(n):
                k1[i] = 0.0
                total[i] = 0.0
            for stage in range(4):
                ahead = 0.0 if stage == 0 else (h if stage == 3 else 0.5 * h)
                weight = 1.0 if stage == 0 or stage == 3 else 2.0
                for i in range(n):
                    stage_x[i] = x[i] + ahead * k1[i]
                pull = pull_s * u
                for j in range(n):
                    pull += pull_row[j] * stage_x[j]
                pull = min(max(pull, -rate), rate)
                for i in range(n):
                    value = Bw[i] * gust[k] + Bs[i] * pull
                    for j in range(n):
                        value += A[i, j] * stage_x[j]
                    k1[i] = value
                for i in range(n):
                    total[i] += weight * k1[i]
            for i in range(n):
                x[i] += h / 6.0 * total[i]
            if x[at] > limit:
                x[at] = limit
            elif x[at] < -limit:
                x[at] = -limit
    return x, peak, square


def bare_arguments(prepared: Prepared, seed: int) -> tuple:
    """What the bare loop needs, taken from the prepared run; the same noise and gusts."""
    s, c = prepared.stepper, controller()
    n_x, n_w, n_s, n_phi, _ = s.sizes
    assert n_phi == 1 and s.elements.names == ("elevon rate limit",)
    Z, phi = prepared.knots[0], n_x + n_w + n_s
    C = np.zeros((len(c.inputs), n_x))
    for i, name in enumerate(c.inputs):
        C[i] = Z[n_x + n_phi + s.outputs.index(f"{name}_x"), :n_x]
    state = RunState(prepared, seed)
    t = prepared.dt * np.arange(prepared.steps + 2)
    pieces, noise = [], []
    for start in range(0, prepared.steps + 1, 20_000):  # as the engine draws them
        n = min(20_000, prepared.steps + 1 - start)
        pieces.append(state._held(t[start : start + n + 1], n)[:, 0])
        noise.append(state._samples(start, n)[1])
    arrays = (Z[:n_x, :n_x], Z[:n_x, n_x], Z[:n_x, phi], Z[n_x, :n_x])
    A, Bw, Bs, pull_row = (np.ascontiguousarray(a) for a in arrays)
    at = s.states.index("elevon_rad")
    law = [np.ascontiguousarray(m[0]) for m in (c.A, c.B, c.C, c.D)]
    tail = (np.concatenate(noise), np.concatenate(pieces), s.equilibrium.copy(), prepared.substeps, prepared.dt)
    head = (A, Bw, Bs, pull_row, float(Z[n_x, n_x + n_w]), at, 165.0, 1.0, RATE, LIMIT)
    return (*head, *law, C, *tail, prepared.period)


def closed_loop() -> list[Row]:
    """Engine against the bare loop, then against solve_ivp restarted per sample."""
    prepared = prepare(plant(), scenario(), Stepping(history=False))
    arguments = bare_arguments(prepared, 1)
    x_at = 17  # position of x in the arguments
    end, _, _ = bare(*arguments[:x_at], arguments[x_at].copy(), *arguments[x_at + 1 :])
    state = RunState(prepared, 1)
    done = 0
    while done < prepared.steps + 1:
        n = min(20_000, prepared.steps + 1 - done)
        state.advance(done, n, 10**9, np.zeros((0, 0)), np.zeros((0, 0)))
        done += n
    difference = np.abs(end - state.x).max() / np.abs(state.x).max()
    assert difference < 1e-6, f"bare loop and engine differ by {difference:.1e}"
    assert prepared.stepper.sizes[0] + 3 >= 14

    def engine() -> None:
        run_prepared(prepared, seed=1)

    def loop() -> None:
        bare(*bare_arguments(prepared, 1)[:x_at], arguments[x_at].copy(), *arguments[x_at + 1 :])

    rows = [compare("60 s closed loop, 14 states / bare compiled loop", engine, loop, target=3.0, rounds=5)]
    for rtol, target in ((1e-6, 0.05), (1e-10, 0.02)):
        name = f"60 s closed loop / solve_ivp restarted per sample, rtol {rtol:g}"
        rows.append(Row(name, rows[0].own_s, restarted(arguments, rtol), target=target))
    free = replace(plant(), actuators=(Actuator(control="elevon", omega=165.0, zeta=1.0),))
    linear = prepare(free, scenario(), Stepping(history=False))
    assert linear.exact[0].size
    run_prepared(linear, seed=1)
    begin = time.perf_counter()
    run_prepared(linear, seed=1)
    own = time.perf_counter() - begin
    name = "60 s without limits, exact steps / solve_ivp restarted per sample, rtol 1e-10"
    rows.append(Row(name, own, rows[-1].peer_s, target=0.005))
    return rows


def restarted(arguments: tuple, rtol: float) -> float:
    """Seconds for 60 s by solve_ivp, restarted at each held sample of turbulence; from 1 s of it."""
    A, Bw, Bs, pull_row, pull_s = arguments[:5]
    x, gust = arguments[17].copy(), arguments[16]
    begin = time.perf_counter()
    step = 1e-3
    for k in range(round(1.0 / step)):
        g = gust[k]

        def slope(_: float, x: np.ndarray, g: float = g) -> np.ndarray:
            return A @ x + Bw * g + Bs * np.clip(pull_row @ x + pull_s * 0.01, -RATE, RATE)

        x = solve_ivp(slope, (0.0, step), x, rtol=rtol, atol=1e-3 * rtol).y[:, -1]
    return (time.perf_counter() - begin) * DURATION


def timed(variant: Variant, seeds: list[int], stepping: Stepping) -> float:
    """Processor time of one task, in the process that does it."""
    begin = time.process_time()
    run_batch(variant, seeds, stepping)
    return time.process_time() - begin


def workers() -> list[Row]:
    """1,000 runs on two warm workers against one, in turns, median of five; at most 1/1.6 of the time.

    And what does not depend on what else the machine does: processor time of the same runs on two workers over that
    on one. Where it is 1, two workers are twice as fast on two cores that are free.
    """
    one = Variant(name="loop", model=plant(), scenario=scenario())
    prepared = prepare(one.model, one.scenario, Stepping(history=False))
    begin = time.perf_counter()
    run_prepared(prepared, seed=0)
    single = time.perf_counter() - begin
    length = DURATION * min(1.0, 6.0 / (WORK * single))  # rounds of some six seconds: sixty in all
    one = replace(one, scenario=replace(one.scenario, duration=length))
    times: dict[int, list[float]] = {1: [], 2: []}
    busy: dict[int, list[float]] = {1: [], 2: []}
    pools: dict[int, ProcessPoolExecutor] = {n: local_pool(n) for n in times}
    stepping = Stepping(history=False)
    try:
        for number in range(6):
            for n, pool in pools.items():
                begin = time.perf_counter()
                ensemble([one], runs=WORK, seed=number, batch=125, executor=pool)
                times[n].append(time.perf_counter() - begin)
                tasks = [run_seeds(number, 0, range(first, first + 50)) for first in range(0, WORK // 5, 50)]
                done = [pool.submit(timed, one, seeds, stepping) for seeds in tasks]
                busy[n].append(sum(future.result() for future in done))
    finally:
        for pool in pools.values():
            pool.shutdown()
    own, peer = (statistics.median(times[n][1:]) for n in (2, 1))
    cpu, alone = (statistics.median(busy[n][1:]) for n in (2, 1))
    return [
        Row("1,000 runs, two workers / one", own, peer, target=1.0 / 1.6),
        Row("processor time of 200 runs, two workers / one", cpu, alone, target=2.0 / 1.6),
    ]


def memory() -> Row:
    """Peak memory of 1,200 s over that of 120 s, statistics only (bytes in place of seconds)."""

    def peak(duration: float) -> float:
        tracemalloc.start()
        simulate(plant(), replace(scenario(), duration=duration), stepping=Stepping(history=False))
        size = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return float(size)

    peak(1.0)
    return Row("peak memory (bytes), 1,200 s / 120 s, statistics only", peak(1200.0), peak(120.0), target=1.05)


def second_start() -> Row:
    """A fresh process that simulates one second from the cache, against importing numba and scipy.linalg alone."""
    run = "from benchmarks.simulate import *; simulate(plant(), replace(scenario(), duration=1.0))"
    bare_start = "import numpy, scipy.linalg, scipy.integrate, numba, pydantic; numba.njit(lambda: 0)"

    def start(code: str) -> None:
        subprocess.run([sys.executable, "-c", code], check=True)

    start(run)
    return compare(
        "second start with warm cache / importing what it needs", lambda: start(run), lambda: start(bare_start),
        target=3.0, rounds=3,
    )  # fmt: skip


def check_condition() -> None:
    """The loop is worth timing: stable without control at this speed, so that limits and noise are what it meets."""
    A = av.linear_system(plant(), FlightCondition.at(0.0, V=V)).A
    assert np.linalg.eigvals(A).real.max() < 0.0


def measure() -> list[Row]:
    """All rows."""
    check_condition()
    return [*closed_loop(), *workers(), memory(), second_start()]
