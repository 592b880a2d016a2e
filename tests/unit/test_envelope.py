"""The envelope study: each number by the function it comes from, margins bracketed, gusts lost when they should."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import aeroservo as av
from aeroservo.aeroelastic.branches import Interval
from aeroservo.control.closed_flutter import closed_flutter
from aeroservo.control.closed_loop import loop_plant
from aeroservo.control.controller import Controller
from aeroservo.control.disk_margins import disk_margin
from aeroservo.datatypes import FlightCondition
from aeroservo.report.envelope_figure import envelope_figure
from aeroservo.report.figures import as_bytes
from aeroservo.studies.envelope import SIX_DB, EnvelopePoint, envelope
from aeroservo.studies.gust_limit import PITCH, PLUNGE, GustSearch
from aeroservo.studies.validity import Validity, validity

SPEEDS = np.arange(5.0, 150.0, 1.0)
DAMPER = Controller(
    A=[], B=[], C=[], D=[[0.1]], inputs=("pitch_rate_rad_s",), outputs=("elevon_command_rad",), dt_s=0.005,
    delay_s=0.005, limits=(0.35,),
)  # type: ignore[arg-type]  # fmt: skip


@pytest.fixture(scope="module")
def points() -> tuple[EnvelopePoint, ...]:
    """Sea level and 10,000 ft with a pitch-rate damper."""
    return envelope(av.read("thesis-simulation"), (0.0, 3048.0), SPEEDS, method=av.P(), controller=DAMPER)


def test_numbers_are_those_of_the_single_analyses(points: tuple[EnvelopePoint, ...]) -> None:
    """flutter, closed_flutter, statics, at each altitude."""
    model = av.build(av.read("thesis-simulation"))
    for point in points:
        sweep = FlightCondition.at(point.altitude, V=SPEEDS)
        alone, closed = av.flutter(model, sweep, av.P()), closed_flutter(model, sweep, DAMPER)
        assert [(i.start, i.kind) for i in point.open_loop] == [(i.start, i.kind) for i in alone.intervals]
        assert point.closed_loop is not None
        assert [(i.start, i.kind) for i in point.closed_loop] == [(i.start, i.kind) for i in closed.intervals]
        still = av.static(model, sweep)
        assert (point.divergence, point.reversal) == (still.divergence.V, still.reversal.V)
        assert point.reversal_quantity == "lift"
        assert point.density == float(sweep.rho[0])


def test_a_damper_moves_the_boundary_to_divergence(points: tuple[EnvelopePoint, ...]) -> None:
    """A rate feedback cannot move a static instability: with control the wing is lost where it diverges."""
    for point in points:
        assert point.closed_loop is not None
        assert point.closed_loop[0].start == pytest.approx(point.divergence, rel=1e-6)
        assert point.closed_loop[0].kind == "divergence"
        assert (point.open_loop[0].start or 0.0) < (point.margin_speed or 0.0) < (point.closed_loop[0].start or 0.0)


def test_margin_speed_is_where_the_margin_ends(points: tuple[EnvelopePoint, ...]) -> None:
    """Just below it the margin holds, just above it does not; SIX_DB is 45 degrees and more than 6 dB."""
    assert 2.0 * math.degrees(math.atan(0.5 * SIX_DB)) == pytest.approx(45.0)
    assert 20.0 * math.log10((2.0 + SIX_DB) / (2.0 - SIX_DB)) > 6.0
    model = av.build(av.read("thesis-simulation"))
    for point in points:
        for factor, holds in ((0.9995, True), (1.0005, False)):
            at = FlightCondition.at(point.altitude, V=(point.margin_speed or 0.0) * factor)
            assert (disk_margin(loop_plant(model, at, DAMPER), DAMPER).alpha >= SIX_DB) is holds
        assert not point.margin_to_end
        first = np.argmax(np.array(point.margin_alpha) < SIX_DB)
        assert point.margin_speeds[first - 1] <= (point.margin_speed or 0.0) <= point.margin_speeds[first]


def test_validity_limits(points: tuple[EnvelopePoint, ...]) -> None:
    """Mach 0.3 = 98.5 m/s at 10,000 ft; reduced frequency at flutter; trim incidence, each by its formula."""
    point = points[1]
    assert point.valid_to is not None
    assert point.valid_to.speed == pytest.approx(98.5, abs=0.05)
    assert point.valid_to.why.startswith("Mach 0.3")
    model = av.build(av.read("thesis-simulation"))
    low = {v.why.split(" of ")[0]: v.speed for v in point.validity if v.side == "below"}
    found = av.flutter(model, FlightCondition.at(3048.0, V=SPEEDS), av.P())
    assert low["reduced frequency 0.2"] == pytest.approx((found.flutter_frequency or 0.0) * model.aero.b / 0.2)
    V = low["trim incidence"]
    still = av.static(model, FlightCondition.at(3048.0, V=[V]))
    assert math.degrees(still.trim_incidence[0]) == pytest.approx(10.0, abs=0.05)
    slow = validity(model, FlightCondition.at(0.0, V=[3.0, 6.0]), None)
    assert Validity(speed=6.0, side="below", why="trim incidence of 10 deg: small angles") in slow
    goland = validity(av.build(av.read("goland")), FlightCondition.at(0.0, V=np.arange(10.0, 200.0, 5.0)), 70.0)
    assert any(v.why.endswith("the last sample") for v in goland)


def test_without_a_controller_and_with_a_margin_that_holds() -> None:
    """The open loop alone; a margin of next to nothing holds to the end; one of nearly two nowhere."""
    file = av.read("thesis-simulation")
    alone = envelope(file, (3048.0,), SPEEDS, method=av.P())[0]
    assert (alone.closed_loop, alone.margin_speed, alone.margin_speeds) == (None, None, ())
    assert alone.open_loop[0].start == pytest.approx(45.39, abs=0.05)
    slow = np.arange(5.0, 60.0, 1.0)
    little = envelope(file, (3048.0,), slow, method=av.P(), controller=DAMPER, margin=0.05)[0]
    assert (little.margin_speed, little.margin_to_end) == (slow[-1], True)
    much = envelope(file, (3048.0,), slow, method=av.P(), controller=DAMPER, margin=1.9999)[0]
    assert (much.margin_speed, much.margin_to_end) == (None, False)


def test_largest_gust_is_found_and_saturation_makes_it_smaller() -> None:
    """A limit of 2 degrees loses what 20 degrees hold; the gust found is suppressed, a larger one is not."""
    file, search = av.read("thesis-simulation"), GustSearch(speeds=(60.0, 200.0), largest=16.0)
    model = av.build(file)
    found = {}
    for limit in (math.radians(2.0), math.radians(20.0)):
        own = replace(DAMPER, limits=(limit,))
        (one,) = search(model, own, 3048.0, (5.0, 150.0))
        found[limit] = one
        assert one.speed == 60.0
    small, large = found.values()
    assert 0.0 < small.amplitude < 0.5 * large.amplitude
    assert small.why
    assert not small.at_least
    from aeroservo.simulate.disturbances import CosineGust
    from aeroservo.simulate.engine import simulate
    from aeroservo.simulate.profiles import level
    from aeroservo.simulate.scenario import Scenario

    def lost(amplitude: float) -> bool:
        gust = CosineGust(amplitude=amplitude, length=25.0 * 2.0 * model.aero.b, start=0.5)
        own = replace(DAMPER, limits=(math.radians(2.0),))
        run = simulate(
            model, Scenario(profile=level(60.0, altitude=3048.0), duration=12.0, controller=own, gusts=(gust,))
        )
        pitch, plunge = (run.peak[run.channels.index(name)] for name in ("pitch_rad", "plunge_m"))
        return bool(run.limit_left or run.overflow_at or pitch > PITCH or plunge > PLUNGE or not run.bounded)

    assert not lost(small.amplitude)
    assert lost(small.amplitude + 0.2)


def test_past_flutter_without_control_no_gust_is_suppressed() -> None:
    """The open loop at 60 m/s runs away from anything."""
    (one,) = GustSearch(speeds=(60.0,))(av.build(av.read("thesis-simulation")), None, 3048.0, (5.0, 150.0))
    assert (one.amplitude, one.at_least) == (0.0, False)
    with pytest.raises(ValueError, match="largest"):
        GustSearch(speeds=(60.0,), largest=0.0)


def test_an_interruption_loses_nothing(tmp_path: Path) -> None:
    """Stopped after one altitude of three: the second call computes two; another envelope is refused."""
    file, journal, done = av.read("thesis-simulation"), tmp_path / "x.part", []

    def stop(now: int, _: int) -> None:
        done.append(now)
        if len(done) == 1:
            raise KeyboardInterrupt

    heights = (0.0, 1000.0, 2000.0)
    gusts = GustSearch(speeds=(40.0,), largest=2.0)
    options = {"method": av.P(), "controller": DAMPER, "gusts": gusts, "journal": journal, "progress": stop}
    with pytest.raises(KeyboardInterrupt):
        envelope(file, heights, SPEEDS[::4], **options)  # type: ignore[arg-type]
    whole = envelope(file, heights, SPEEDS[::4], **options)  # type: ignore[arg-type]
    assert done == [1, 2, 3]
    fresh = envelope(file, heights, SPEEDS[::4], method=av.P(), controller=DAMPER, gusts=gusts)
    for a, b in zip(whole, fresh):
        assert a == b
    with pytest.raises(ValueError, match="another sweep"):
        envelope(file, (0.0,), SPEEDS[::4], **options)  # type: ignore[arg-type]
    text = journal.read_text(encoding="utf-8").splitlines()
    journal.write_text(text[0] + '\n{"altitude": 0.0}\n', encoding="utf-8")
    with pytest.raises(ValueError, match="damaged"):
        envelope(file, heights, SPEEDS[::4], **options)  # type: ignore[arg-type]


def test_refusals() -> None:
    """Margins out of range, no altitudes, channels that do not exist: before any work."""
    file = av.read("thesis-simulation")
    with pytest.raises(ValueError, match="between 0 and 2"):
        envelope(file, (0.0,), SPEEDS, method=av.P(), margin=2.0)
    with pytest.raises(ValueError, match="one altitude"):
        envelope(file, (), SPEEDS, method=av.P())
    with pytest.raises(ValueError, match="nowhere"):
        envelope(file, (0.0,), SPEEDS, method=av.P(), controller=replace(DAMPER, inputs=("nowhere",)))
    with pytest.raises(ValueError, match="state_space"):
        envelope(av.read("thesis-appendix"), (0.0,), SPEEDS, method=av.P())


def test_figure_draws_any_number_of_intervals(points: tuple[EnvelopePoint, ...]) -> None:
    """Ranges that begin and end between altitudes, one altitude, gusts: each drawn, with what it says in the legend."""
    pocket = Interval(start=60.0, end=70.0, frequency=20.0, mode="pitch", kind="flutter")
    odd = (replace(points[0], closed_loop=(pocket, *(points[0].closed_loop or ()))), points[1])
    model = av.build(av.read("thesis-simulation"))
    gusts = GustSearch(speeds=(40.0, 60.0), largest=2.0)(model, DAMPER, 0.0, (5.0, 150.0))
    for some in (odd, points[:1], (replace(points[0], gusts=gusts), points[1])):
        figure = envelope_figure(some, (5.0, 150.0), "x $y$", margin=SIX_DB, criterion="6 dB")
        text = " ".join(t.get_text() for t in figure.legends[0].get_texts())
        for word in ("without control", "with control", "divergence", "reversal of lift", "Mach 0.3", "6 dB"):
            assert word in text
        assert as_bytes(figure, ".png").startswith(b"\x89PNG")
    alone = tuple(replace(p, closed_loop=None, margin_speeds=(), margin_alpha=()) for p in points)
    assert len(envelope_figure(alone, (5.0, 150.0), "x", margin=SIX_DB, criterion="6 dB").axes) == 1
