"""Control: schedules against the bare Riccati solves they contain, the envelope against the time it is allowed.

- Schedule: LQR (and LQG with recovery) designed at 200 points over dynamic pressure, with actuator, sampling, delay and
  the independent checks of every point, against `scipy.linalg.solve_discrete_are` on the very matrices of its solves.
- Envelope: 20 altitudes with a scheduled controller (boundaries with and without it, 41 margins each, statics), against
  `ALLOWED` seconds; without gusts, which are simulations.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import scipy.linalg

import aeroservo as av
from aeroservo.control.controller import Controller
from aeroservo.control.lqg import LQG
from aeroservo.control.lqr import LQR
from aeroservo.control.schedule import design_schedule
from aeroservo.datatypes import FlightCondition
from aeroservo.servo import Actuator, Sensor
from aeroservo.studies.envelope import envelope
from benchmarks.side_by_side import Row, compare

POINTS = 200
ALTITUDES = np.linspace(0.0, 6000.0, 20)
#: Time that an envelope over 20 altitudes may take on a machine of two cores. [s]
ALLOWED = 30.0
#: Weights: 2 degrees of pitch, 60 degrees a second, 10 degrees of elevon.
PITCH, RATE, ELEVON = (1.0 / np.radians(x) ** 2 for x in (2.0, 60.0, 10.0))


def measure() -> list[Row]:
    """Schedules and envelope."""
    file = av.read("thesis-simulation")
    gyro = Sensor(name="gyro", unit="rad_s", rate=(0.0, 1.0))
    servo = Actuator(control="elevon", omega=60.0, zeta=0.7)
    model = replace(av.build(file), actuators=(servo,), sensors=(gyro,))
    sweep = FlightCondition.at(3048.0, V=np.linspace(15.0, 130.0, POINTS))
    regulator = LQR(Q=np.array([0.0, PITCH, 0.0, RATE, 0.0, 0.0, 0.0]), R=np.array([ELEVON]))
    observer = LQG(Q=np.array([0.0, PITCH, 0.0, RATE]), R=np.array([ELEVON]), recovery=0.1)

    def full_state() -> Controller:
        return design_schedule(model, regulator, sweep, rate_Hz=200.0, delay_samples=1)

    def gyro_alone() -> Controller:
        return design_schedule(model, observer, sweep, rate_Hz=200.0, delay_samples=1, sensors=["gyro"])

    rows = []
    for name, design in (("LQR", full_state), ("gyro LQG with recovery", gyro_alone)):
        solves = riccati_problems(design)

        def bare(solves: list[tuple[Any, ...]] = solves) -> None:
            for one in solves:
                scipy.linalg.solve_discrete_are(*one)

        title = f"{name} schedule, {POINTS} points / {len(solves)} Riccati solves"
        rows.append(compare(title, design, bare, target=3.0, rounds=5))
    schedule = design_schedule(
        av.build(file), replace(regulator, Q=np.array([0.0, PITCH, 0.0, RATE, 0.0])), sweep[::10], rate_Hz=200.0,
        delay_samples=1,
    )  # fmt: skip
    speeds = np.arange(5.0, 150.0, 0.5).tolist()
    envelope(file, (0.0,), speeds, method=av.P(), controller=schedule)
    start = time.perf_counter()
    envelope(file, ALTITUDES.tolist(), speeds, method=av.P(), controller=schedule)
    took = time.perf_counter() - start
    return [*rows, Row(f"envelope over {len(ALTITUDES)} altitudes / {ALLOWED:g} s allowed", took, ALLOWED, 1.0)]


def riccati_problems(design: Callable[[], Any]) -> list[tuple[Any, ...]]:
    """The matrices of every Riccati equation that a design solves: one for each point."""
    solve, seen = scipy.linalg.solve_discrete_are, []

    def spy(a: Any, b: Any, q: Any, r: Any, *more: Any, **options: Any) -> Any:
        seen.append((a, b, q, r, *more))
        return solve(a, b, q, r, *more, **options)

    scipy.linalg.solve_discrete_are = spy
    try:
        design()
    finally:
        scipy.linalg.solve_discrete_are = solve
    return seen


if __name__ == "__main__":
    for row in measure():
        print(f"{row.name:60s}{row.own_s:10.3f} s{row.peer_s:10.3f} s{row.ratio:8.3f} (at most {row.target:g})")
