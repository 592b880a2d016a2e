"""What the studio's processes compute, and the processes themselves: results, refusals, cancellation, death."""

from __future__ import annotations

import asyncio
import io
import os
import pickle
import signal
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aeroservo.aeroelastic.build import DEFAULTS, build
from aeroservo.aeroelastic.flutter import PK, P, flutter
from aeroservo.aeroelastic.static import static
from aeroservo.aircraft.files import read
from aeroservo.datatypes import FlightCondition
from aeroservo.simulate.disturbances import CosineGust
from aeroservo.simulate.engine import simulate
from aeroservo.simulate.profiles import level
from aeroservo.simulate.scenario import Scenario
from aeroservo.studio.analysis import MOST_SPEEDS, Air, Analysis, analyse
from aeroservo.studio.charts import damping_chart, frequency_chart, history_chart
from aeroservo.studio.draft import Source, opened, put
from aeroservo.studio.flight import Flight, Run, fly, regulator
from aeroservo.studio.guard import allowed
from aeroservo.studio.layout import text_of
from aeroservo.studio.pool import Died, Pool, Refused
from aeroservo.studio.worker import HEADER, Job, compute, serve

HERE = Path(".")
QUICK = 1e-9
"""Speeds come twice, from searches on different grids, each refined to 1e-12: their relative difference. [-]"""


def quiet(what: str, part: float) -> None:
    assert what and 0.0 <= part <= 1.0


def analysed(source: Source, air: Air = Air(), text: str | None = None) -> tuple[Analysis, list[Analysis]]:  # noqa: B008
    first: list[Analysis] = []
    return analyse(source.text if text is None else text, source.path, air, quiet, first.append), first


@pytest.mark.parametrize("name", ["thesis-binary", "thesis-aircraft", "thesis-simulation", "thesis-uav", "bact"])
def test_speeds_are_those_of_flutter_and_static(name: str) -> None:
    source = opened(name, HERE)
    found, first = analysed(source)
    model, (low, high, step) = build(source.model), source.model.speeds_m_s or (1.0, 350.0, 1.0)
    sweep = FlightCondition.at(0.0, V=np.minimum(low + step * np.arange(round((high - low) / step) + 1), high))
    method = P() if DEFAULTS[source.model.kind].method == "p" else PK()
    speeds, statics = flutter(model, sweep, method), static(model, sweep)
    assert [s.value for s in found.speeds] == [speeds.flutter_speed, statics.divergence.V, statics.reversal.V]
    for quick, full in zip(first[0].speeds, found.speeds):
        assert quick.value == (None if full.value is None else pytest.approx(full.value, rel=QUICK))
    assert not first[0].complete and found.complete
    curves = found.curves
    assert curves is not None and curves.names == speeds.names[: len(curves.names)]
    np.testing.assert_array_equal(curves.damping[:, 0][np.isfinite(curves.damping[:, 0])],
                                  speeds.damping_ratio[:, 0][np.isfinite(curves.damping[:, 0])])  # fmt: skip
    assert '"modes"' in found.scene and "<" not in found.scene


def test_altitude_air_and_method_are_heard() -> None:
    source = opened("thesis-binary", HERE)
    sea, high = analysed(source)[0], analysed(source, Air(altitude=3048.0))[0]
    ratio = FlightCondition.at(0.0, V=1.0).rho / FlightCondition.at(3048.0, V=1.0).rho
    assert high.speeds[1].value == pytest.approx(sea.speeds[1].value * float(np.sqrt(ratio)), rel=1e-12)
    other = analysed(source, Air(aero="theodorsen"))[0]
    assert "theodorsen" in other.heading and "p-k" in other.heading
    assert other.speeds[0].value != sea.speeds[0].value
    assert "k method" in analysed(source, Air(aero="theodorsen", method="k"))[0].heading


def test_models_without_flutter_say_so_and_fine_steps_are_thinned() -> None:
    notes = analysed(opened("thesis-appendix", HERE))[0].notes
    assert any("no flutter analysis" in note for note in notes)
    uav = opened("thesis-uav", HERE)
    rigid = text_of(put(uav.draft, ("structure",), None), uav)
    assert any("rigid" in note for note in analysed(uav, text=rigid)[0].notes)
    source = opened("thesis-binary", HERE)
    fine = analysed(source, text=source.text.replace("150.0, 0.5]", "150.0, 0.001]"))[0]
    assert fine.curves is not None and len(fine.curves.V) == MOST_SPEEDS
    assert any("401 speeds" in note for note in fine.notes)
    assert fine.speeds[0].value == pytest.approx(analysed(source)[0].speeds[0].value, rel=QUICK)
    low = analysed(source, text=source.text.replace("[1.0, 150.0", "[1.0, 20.0"))[0]
    assert low.speeds[0].value is None and low.speeds[0].remark == "none up to 20 m/s"
    late = analysed(source, text=source.text.replace("[1.0, 150.0", "[52.0, 60.0"))[0]
    assert late.speeds[0].value is None and "unstable already at 52 m/s" in late.speeds[0].remark
    with pytest.raises(ValueError, match="two or more speeds"):
        analysed(source, text=source.text.replace("[1.0, 150.0, 0.5]", "[20.0, 20.0, 1.0]"))


def flown(name: str, flight: Flight) -> Run:
    source = opened(name, HERE)
    return fly(source.text, source.path, flight, quiet, lambda result: None)


def test_a_flight_is_that_of_simulate() -> None:
    run = flown("thesis-simulation", Flight(speed=30.0, shake="cosine", gust=2.0, length=10.0))
    gust = CosineGust(amplitude=2.0, length=10.0, start=0.5)
    found = simulate(build(read("thesis-simulation")), Scenario(profile=level(30.0), duration=5.0, gusts=(gust,)))
    assert dict(zip(run.channels, run.peak))["pitch_rad"] == dict(zip(found.channels, found.peak))["pitch_rad"] > 0.0
    assert run.csv.startswith(b"time") or b"pitch_rad" in run.csv.splitlines()[0]
    assert '"histories"' in run.scene
    for shake in ("sharp", "light", "moderate", "severe"):
        assert flown("thesis-simulation", Flight(speed=30.0, shake=shake, duration=1.0)).peak[0] > 0.0


def test_a_linear_model_flies_at_its_own_condition_only() -> None:
    own = read("thesis-appendix").model  # type: ignore[attr-defined]
    run = flown("thesis-appendix", Flight(speed=own.speed_m_s, altitude=own.altitude_m, duration=1.0))
    assert run.scene == "" and len(run.t) > 100
    with pytest.raises(ValueError, match="holds at"):
        flown("thesis-appendix", Flight(speed=own.speed_m_s + 1.0))
    with pytest.raises(ValueError, match="controller file"):
        flown("thesis-appendix", Flight(speed=own.speed_m_s, altitude=own.altitude_m, regulated=True))


@pytest.mark.parametrize(("name", "V"), [("thesis-simulation", 45.0), ("thesis-binary", 55.0), ("bact", 115.0)])
def test_the_regulator_holds_what_flutters(name: str, V: float) -> None:
    growths = []
    for regulated in (False, True):
        run = flown(name, Flight(speed=V, regulated=regulated))
        growths.append(float(dict(run.facts)["Growth of the envelope"].split()[0]))
        assert dict(run.facts)["Bounded"] == ("yes" if regulated else "no")
    assert growths[0] > 0.1 and growths[1] < -0.5


def test_the_regulator_does_not_depend_on_units() -> None:
    """A model in other coordinates, q = T x, has the same roots with its regulator."""
    from dataclasses import replace

    from aeroservo.control.closed_loop import closed_loop
    from aeroservo.control.plant import design_plant

    model, condition = build(read("thesis-binary")), FlightCondition.at(0.0, V=55.0)
    roots = []
    for T in (np.eye(2), np.diag([100.0, 0.01])):
        m, air = model.modes, model.aero
        wide = np.diag([*np.diag(T), *np.ones(len(air.inputs) - 2)])
        modes = replace(m, **{k: T @ getattr(m, k) @ T for k in "MDK"}, phi=m.phi @ T if m.phi is not None else None)
        aero = replace(air, **{k: T @ getattr(air, k) @ wide for k in ("A0", "A1", "A2")})
        scaled = replace(model, modes=modes, aero=aero, loads=None)
        controller, _ = regulator(scaled, condition)
        loop = closed_loop(design_plant(scaled, condition), controller)
        roots.append(np.sort_complex(np.linalg.eigvals(loop.A)))
    np.testing.assert_allclose(roots[1], roots[0], rtol=1e-7)
    assert roots[0].real.max() < 0.0


def test_controllers_come_from_files_and_models_without_controls_have_none(tmp_path: Path) -> None:
    from aeroservo.control.controller import write_controller

    controller, notes = regulator(build(read("thesis-simulation")), FlightCondition.at(0.0, V=45.0))
    assert "K = " in notes[-1]
    write_controller(tmp_path / "k.json", controller)
    own = flown("thesis-simulation", Flight(speed=45.0, regulated=True))
    read_back = flown("thesis-simulation", Flight(speed=45.0, controller=tmp_path / "k.json"))
    np.testing.assert_allclose(read_back.data, own.data, rtol=1e-9, atol=1e-12)
    with pytest.raises(ValueError, match="no control"):
        flown("goland", Flight(speed=100.0, regulated=True))


@pytest.mark.parametrize(
    ("name", "value"),
    [("speed", 0.0), ("speed", float("nan")), ("duration", 1e9), ("gust", 1e9), ("length", 0.0), ("seed", -1),
     ("altitude", 1e6)],
)  # fmt: skip
def test_flights_out_of_range_are_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"^{name} must be from"):
        Flight(**{"speed": 30.0, name: value})
    with pytest.raises(ValueError, match="shake must be one of"):
        Flight(speed=30.0, shake="hard")  # type: ignore[arg-type]


def test_charts_say_what_they_show() -> None:
    source = opened("thesis-binary", HERE)
    before = analysed(source)[0]
    now = analysed(source, text=source.text.replace("413.2 ", "300.0 "))[0]
    for dark in (False, True):
        frequency, damping = frequency_chart(now, before, dark=dark), damping_chart(now, before, dark=dark)
        assert frequency["legend"]["data"] == ["the file's", "bending 1", "torsion 1"]
        marks = {s["markLine"]["data"][0]["xAxis"] for s in damping["series"] if "markLine" in s}
        assert marks == {speed.value for speed in now.speeds}
        assert damping["yAxis"]["min"] < 0.0 < damping["yAxis"]["max"] <= 0.5
        assert frequency["tooltip"]["renderMode"] == "richText"  # no HTML, whatever a mode is called
    now_V, first = now.curves.V[:, 0], frequency["series"][2]  # type: ignore[union-attr]
    assert [x for x, _ in first["data"]] == pytest.approx(now_V.tolist(), rel=1e-5)
    run = flown("thesis-binary", Flight(speed=30.0))
    chart = history_chart(run, 0, run)
    assert [s["name"] for s in chart["series"]] == ["the run before", "this run"]
    assert chart["yAxis"]["name"] == "bending 1, m"


def test_only_this_machines_own_page_is_answered() -> None:
    own = {b"host": b"127.0.0.1:80"}
    assert allowed(own, 80) and allowed({b"host": b"localhost"}, 80)
    assert not allowed({}, 80) and not allowed({b"host": b"127.0.0.1.evil.example:80"}, 80)
    assert not allowed({**own, b"origin": b"null"}, 80)
    assert not allowed({**own, b"origin": b"https://127.0.0.1:80"}, 80)
    assert allowed({**own, b"origin": b"http://LOCALHOST:80"}, 80)


def job(what: Any = "analyse", name: str = "thesis-binary", options: Any = None, text: str | None = None) -> Job:
    source = opened(name, HERE)
    return Job(what=what, text=source.text if text is None else text, path=source.path, options=options or Air())


def test_the_report_is_that_of_the_model_that_is_edited() -> None:
    told: list[str] = []
    options = Air(altitude=1000.0, aero="jones")
    text = opened("thesis-binary", HERE).text.replace("413.2 ", "470.25 ")
    page = compute(job("report", options=options, text=text), lambda what, part: told.append(what), lambda _: None)
    assert page.startswith(b"<!") and b"470.25" in page
    assert b"--altitude 1000 --aero jones" in page
    assert told[0] == "report: reading the model" and any("Flutter" in line for line in told)


def answers(*messages: Any) -> list[Any]:
    """What a process says to messages."""
    source = io.BytesIO(b"".join(HEADER.pack(len(p := pickle.dumps(m))) + p for m in messages))
    sink = io.BytesIO()
    serve(source, sink)
    said, content = [], sink.getvalue()
    while content:
        (length,) = HEADER.unpack(content[: HEADER.size])
        said.append(pickle.loads(content[HEADER.size : HEADER.size + length]))
        content = content[HEADER.size + length :]
    return said


def test_a_process_answers_refuses_and_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    from aeroservo.studio import analysis

    said = answers(
        ("cancel", 1), ("run", 1, job()), ("run", 2, job(text="kind = 1")), ("run", 3, job(options=3)),
        ("run", 4, job("fly", options=Flight(speed=30.0, duration=0.2))), ("run", 5, job()),
    )  # fmt: skip
    ends = {number: what for what, number, *_ in said[1:] if what not in ("progress", "partial")}
    assert said[0] == ("ready",)
    assert ends == {1: "cancelled", 2: "refused", 3: "failed", 4: "done", 5: "done"}
    assert [number for what, number, *_ in said[1:] if what == "partial"] == [5]

    def fail(error: Exception) -> Any:
        def broken(*_: Any) -> None:
            raise error

        return broken

    for error, word in ((MemoryError(), "not enough memory"), (np.linalg.LinAlgError("singular"), "singular")):
        monkeypatch.setattr("aeroservo.studio.worker._warm", lambda fly: None)
        monkeypatch.setattr(analysis, "analyse", fail(error))
        assert answers(("run", 1, job()))[-1] == ("failed", 1, word)


def test_processes_compute_refuse_stop_and_may_die(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("aeroservo.studio.pool.GRACE", 0.3)
    asyncio.run(_life_of_a_pool())


async def _life_of_a_pool() -> None:
    pool, told = Pool(), []
    pool.start()
    result = await pool.run(job(), lambda what, part: told.append(what))
    assert result.speeds[0].value == analysed(opened("thesis-binary", HERE))[0].speeds[0].value
    assert told[0] == "starting a process" and "flutter speed" in told
    with pytest.raises(Refused, match="kind = 1"):
        await pool.run(job(text="kind = 1"), quiet)
    with pytest.raises(Died, match="the computation failed"):
        await pool.run(job(options=3), quiet)
    if os.name == "posix":
        first = next(iter(pool.every))
        long = job("fly", "thesis-simulation", Flight(speed=20.0, duration=600.0))
        task = asyncio.create_task(pool.run(long, lambda what, part: told.append(what)))
        while not told[-1].startswith("simulating: "):
            await asyncio.sleep(0.01)
        task.cancel()  # hears it between pieces
        with pytest.raises(asyncio.CancelledError):
            await task
        await asyncio.sleep(0.0)
        others = [worker for worker in pool.every if worker.alive]
        for worker in others:
            os.kill(worker.process.pid, signal.SIGSTOP)
        task = asyncio.create_task(pool.run(job(), quiet))
        await asyncio.sleep(0.2)
        task.cancel()  # is deaf, and replaced
        with pytest.raises(asyncio.CancelledError):
            await task
        for worker in others:
            os.kill(worker.process.pid, signal.SIGKILL)
        assert (await pool.run(job(), lambda *_: None)).complete
        assert first not in pool.every
    processes = [worker.process for worker in pool.every]
    await pool.close()
    assert processes and all(process.returncode is not None for process in processes)


def test_a_process_ends_when_its_studio_is_gone() -> None:
    async def orphan() -> int:
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-m",
            "aeroservo.studio.worker",
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
        )
        assert process.stdin is not None and process.stdout is not None
        await process.stdout.readexactly(HEADER.size)
        content = pickle.dumps(("run", 1, job("fly", "thesis-simulation", Flight(speed=20.0, duration=600.0))))
        process.stdin.write(HEADER.pack(len(content)) + content)
        await process.stdin.drain()
        await asyncio.sleep(0.3)
        process.stdin.close()
        return await asyncio.wait_for(process.wait(), 20.0)

    assert asyncio.run(orphan()) == 0
