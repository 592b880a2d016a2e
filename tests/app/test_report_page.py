"""Reports in a real Chromium, from disk: what loads, what moves, what sliders say, what it asks of the network."""

from __future__ import annotations

import csv
import io
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import aeroservo as av
from aeroservo.atmosphere import atmosphere
from aeroservo.datatypes import FlightCondition, LinearSystem
from aeroservo.report.blocks import Failed, Part, Prose, Scene
from aeroservo.report.lattice3d import lattice3d
from aeroservo.report.make_report import Section, made, provenance_of, sections
from aeroservo.report.page import write_page
from aeroservo.report.scene import mode_data, scene_data
from aeroservo.simulate.disturbances import CosineGust
from aeroservo.simulate.profiles import level
from aeroservo.studies.aircraft_report import ReportCase, ReportOptions, report_case
from aeroservo.studies.live_model import exact_system

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
try:
    from playwright.sync_api import sync_playwright
except ImportError:  # pragma: no cover - the test extra brings it
    sync_playwright = None  # type: ignore[assignment]

pytestmark = pytest.mark.skipif(
    CHROMIUM is None or sync_playwright is None, reason="no Chromium on this machine, or no playwright"
)

FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-gpu-sandbox",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
EVIL = "</script><script>window.hacked=1</script><img src=x onerror=window.hacked=2>"
LEAST_RATE = 25.0
"""Frames per second of the wing in software rendering (issue 8)."""
CLOSE = 1e-3
"""Trajectories in the page against Python's (issue 8)."""
READ = 1e-4
"""Numbers on the page have five digits."""


class Opened:
    """A page with everything that it logged and asked for."""

    def __init__(self, page: Any, path: Path) -> None:
        self.page, self.path = page, path
        self.complaints: list[str] = []
        self.requests: list[str] = []
        page.on("console", lambda m: self.complaints.append(m.text) if m.type in ("error", "warning") else None)
        page.on("pageerror", lambda e: self.complaints.append(str(e)))
        page.on("requestfailed", lambda r: self.complaints.append(f"failed: {r.url}"))
        page.on("request", lambda r: self.requests.append(r.url))
        page.on("dialog", lambda d: (self.complaints.append("dialog"), d.dismiss()))
        page.goto(path.as_uri())

    def until(self, script: str, seconds: float = 20.0) -> Any:
        """Wait for a value; the page's policy forbids `wait_for_function`, which evaluates text."""
        for _ in range(int(seconds * 20)):
            value = self.page.evaluate(script)
            if value:
                return value
            self.page.wait_for_timeout(50)
        raise AssertionError(f"never true: {script}")

    def drawn(self, scene: int) -> None:
        """Wait for two frames of the page: what was asked for is drawn."""
        script = "() => new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(() => r(true))))"
        assert self.page.evaluate(script)
        assert self.page.evaluate(f"aeroservoPage.scenes[{scene}].frames") > 0

    def show(self, anchor: str) -> None:
        self.page.evaluate(f"document.getElementById('{anchor}').scrollIntoView()")

    def slide(self, selector: str, value: float) -> None:
        """Move a slider as a hand would."""
        act = "(e, v) => { e.step = 'any'; e.value = v; e.dispatchEvent(new Event('input', {bubbles: true})); }"
        self.page.eval_on_selector(selector, act, value)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_playwright() as play:
        found = play.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield found
        found.close()


@pytest.fixture(scope="module")
def case() -> ReportCase:
    return report_case("thesis-simulation", ReportOptions())


def written(case: ReportCase, path: Path, *names: str) -> Path:
    chosen: list[Section] = [s for s in sections(case) if not names or s.anchor in names]
    parts = [made(section, case) for section in chosen]
    assert not [b.why for p in parts for b in p.blocks if isinstance(b, Failed)]
    write_page(path, parts, provenance_of(case, source="m.toml", text="x", command="c"))
    return path


@pytest.fixture(scope="module")
def report(case: ReportCase, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(
        case, tmp_path_factory.mktemp("report") / "r.html", "summary", "live", "modes", "flutter", "simulations"
    )


@pytest.fixture
def opened(browser: Any) -> Iterator[Callable[..., Opened]]:
    pages = []

    def open_(path: Path, **options: Any) -> Opened:
        page = browser.new_page(**({"viewport": {"width": 1280, "height": 900}} | options))
        pages.append(page)
        return Opened(page, path)

    yield open_
    for page in pages:
        page.close()


def test_it_opens_from_disk_in_silence_and_soon(report: Path, opened: Callable[..., Opened]) -> None:
    o = opened(report)
    paint = o.until("performance.getEntriesByName('first-contentful-paint')[0]?.startTime")
    assert paint < 2000.0
    for anchor in ("live", "modes", "simulations", "flutter"):
        o.show(anchor)
        o.page.wait_for_timeout(150)
    o.until("aeroservoPage.live[0] && aeroservoPage.scenes[0] && aeroservoPage.scenes[1]")
    assert o.complaints == []
    assert o.requests == [report.as_uri()]
    assert report.stat().st_size < 10e6


def test_names_do_not_run(tmp_path: Path, opened: Callable[..., Opened]) -> None:
    from aeroservo.report.blocks import Chart, Facts, Provenance, Series, Table

    x = np.arange(3.0)
    scene = Scene(data={"patches": [], "points": [], "shapes": [{"name": EVIL, "xyz": []}]}, title=EVIL)
    blocks = (
        Prose(text=EVIL), Facts(items=((EVIL, EVIL, EVIL),)), Table(columns=(EVIL,), rows=((EVIL,),), title=EVIL),
        Chart(series=(Series(name=EVIL, x=x, y=x),), x_label=EVIL, y_label=EVIL, title=EVIL), scene, Failed(why=EVIL),
    )  # fmt: skip
    write_page(
        tmp_path / "e.html",
        (Part(title=EVIL, anchor="a", blocks=blocks),),
        Provenance(version="1", source=EVIL, input_text=EVIL),
        title=EVIL,
    )
    o = opened(tmp_path / "e.html")
    o.page.hover("svg.chart")
    o.page.wait_for_timeout(300)
    assert o.page.evaluate("window.hacked === undefined && document.images.length === 0")
    assert o.requests == [(tmp_path / "e.html").as_uri()] and "dialog" not in o.complaints
    # what would run if escaping failed is stopped by the policy
    o.page.evaluate(
        "const s = document.createElement('script'); s.textContent = 'window.hacked = 3'; document.body.append(s)"
    )
    assert o.page.evaluate("window.hacked === undefined")


def expected(case: ReportCase, V: float, altitude: float, factor: float) -> tuple[float, float, complex]:
    """Density, dynamic pressure and the root that grows most."""
    rho = float(atmosphere(altitude).rho)
    family = case.family
    roots = np.linalg.eigvals(exact_system(family.model, family.K_torsion, V, rho, factor).A)
    top = roots[np.argmax(roots.real)]
    if top.real <= 0.0:  # then the page tells the oscillation that decays slowest
        top = max(roots[np.abs(roots.imag) > 1e-6 * np.abs(roots)], key=lambda s: s.real)
    return rho, 0.5 * rho * V * V, complex(top.real, abs(top.imag))


def test_sliders_say_what_python_says(case: ReportCase, report: Path, opened: Callable[..., Opened]) -> None:
    o = opened(report)
    o.show("live")
    o.until("aeroservoPage.live[0]")

    def number(name: str) -> float:
        return float(o.page.inner_text(f"dd[data-name={name}]").replace("−", "-"))

    state = {"V": case.speed, "altitude": 0.0, "factor": 1.0}
    for name, value in (("V", 30.0), ("V", 50.0), ("altitude", 4000.0), ("factor", 0.7)):
        state[name] = value
        o.slide(f"input[name={name}]", value)
        o.until("aeroservoPage.live[0].settled")
        rho, pressure, root = expected(case, **state)
        assert number("rho") == pytest.approx(rho, rel=READ)
        assert number("pressure") == pytest.approx(pressure, rel=READ)
        assert number("growth") == pytest.approx(root.real, rel=READ)
        assert number("frequency") == pytest.approx(root.imag / (2 * np.pi), rel=READ)
        assert ("unstable" in o.page.inner_text("dd[data-name=verdict]")) == (root.real > 0.0)
    assert root.real > 0.0
    o.page.check("input[name=on]")
    o.until("aeroservoPage.live[0].settled")
    assert number("growth") < 0.0 and o.page.inner_text("dd[data-name=verdict]") == "stable"


def test_the_page_flies_as_python_flies(case: ReportCase, report: Path, opened: Callable[..., Opened]) -> None:
    o = opened(report)
    o.show("live")
    o.until("aeroservoPage.live[0]")
    script = """(w) => { const run = aeroservoPage.live[0].model.run(w, 10), x = [];
        run.gust(1.0, 12.0, 0.1);
        for (let k = 0; k <= 1000; k++) { if (k % 10 === 0) x.push(Array.from(run.x)); run.step(); }
        return x; }"""
    family = case.family
    V, altitude, factor = 48.0, 1500.0, 0.9
    rho = float(atmosphere(altitude).rho)
    true = exact_system(family.model, family.K_torsion, V, rho, factor)
    n = len(true.states)
    plant = LinearSystem(
        A=true.A, B=true.B, C=np.eye(n), D=np.zeros((n, true.B.shape[1])), states=true.states, inputs=true.inputs,
        outputs=true.states,
    )  # fmt: skip
    for on in (False, True):
        from aeroservo.control.controller import state_feedback

        K = family.gain(0.5 * rho * V * V)
        controller = state_feedback(K, family.states, family.inputs[:1], family.dt_s) if on else None
        gust = CosineGust(amplitude=1.0, length=12.0, start=0.1)
        scenario = av.Scenario(
            profile=level(V, altitude=altitude),
            duration=10 * 100 * family.dt_s / 10,
            controller=controller,
            gusts=(gust,),
        )
        history = av.simulate(plant, scenario).history
        assert history is not None
        page = np.array(o.page.evaluate(script, {"V": V, "altitude": altitude, "factor": factor, "on": on}))
        for j, name in enumerate(family.states):
            here = np.interp(family.dt_s * np.arange(len(page)), history.t, history[name])
            assert np.abs(page[:-1, j] - here[:-1]).max() < CLOSE * np.abs(here).max(), (on, name)


def test_play_moves_the_mesh_and_pause_stops_it(report: Path, opened: Callable[..., Opened]) -> None:
    o = opened(report)
    o.show("modes")
    o.until("aeroservoPage.scenes[0] && aeroservoPage.scenes[0].frames > 1")
    assert o.page.evaluate("aeroservoPage.scenes[0].webgl")
    places = "aeroservoPage.scenes[0].positions()"
    box = o.page.locator("#modes .moving")
    start = o.page.evaluate(places)
    box.locator("button.play").click()
    o.page.evaluate("(p) => { window.began = p; }", start)
    o.until(f"{places}.some((v, i) => Math.abs(v - began[i]) > 1e-3)")
    box.locator("button.play").click()
    assert not o.page.evaluate("aeroservoPage.scenes[0].playing")
    o.drawn(0)
    held = o.page.evaluate(places)
    o.page.wait_for_timeout(300)
    assert o.page.evaluate(places) == held
    o.page.evaluate("aeroservoPage.scenes[0].setSpeed(3)")
    o.drawn(0)
    assert o.page.evaluate(places) != held
    o.page.focus("#modes canvas")
    o.page.keyboard.press("Space")
    assert o.page.evaluate("aeroservoPage.scenes[0].playing")


def test_a_replay_stands_where_its_history_says(case: ReportCase, report: Path, opened: Callable[..., Opened]) -> None:
    o = opened(report)
    o.show("simulations")
    o.until("aeroservoPage.scenes[1] && aeroservoPage.scenes[1].frames > 1")
    run = case.runs[0]
    history = run.found.history
    assert history is not None
    lattice = lattice3d(case.file, case.model)
    t = 0.4 * float(history.t[-1])
    o.page.evaluate(f"aeroservoPage.scenes[1].setScale(1), aeroservoPage.scenes[1].seek({t})")
    o.drawn(1)
    values = [np.interp(t, history.t, history[c]) for c in ("plunge_m", "pitch_rad")]
    true = lattice.points + np.einsum("j,jpk->pk", values, lattice.shapes[:2])
    here = np.array(o.page.evaluate("aeroservoPage.scenes[1].positions()")).reshape(-1, 3)
    size = np.abs(true - lattice.points).max()
    assert np.abs(here - true).max() < 0.01 * size + 1e-6


def test_the_live_panel_moves_and_comes_to_rest(report: Path, opened: Callable[..., Opened]) -> None:
    o = opened(report)
    o.show("live")
    o.until("aeroservoPage.live[0]")
    o.page.click("#live button.play")
    o.until("Math.max(...aeroservoPage.live[0].run.x.map(Math.abs)) > 1e-4")
    o.page.click("#live button.play")
    assert not o.page.evaluate("aeroservoPage.live[0].playing")
    o.page.click("text=At rest")
    assert o.page.evaluate("aeroservoPage.live[0].run.x.every((v) => v === 0)")
    assert o.complaints == []


def test_charts_answer_to_mouse_and_keys_and_give_their_data(
    case: ReportCase, report: Path, opened: Callable[..., Opened]
) -> None:
    o = opened(report)
    box = o.page.locator("#flutter .chart-box").nth(1)
    box.scroll_into_view_if_needed()
    box.locator("svg.chart").hover()
    assert "damping ratio" in o.page.inner_text("#tip") or "airspeed" in o.page.inner_text("#tip")
    box.locator("svg.chart").focus()
    o.page.keyboard.press("ArrowRight")
    first = o.page.inner_text("#tip")
    o.page.keyboard.press("PageDown")
    assert o.page.inner_text("#tip") != first
    o.page.keyboard.press("Escape")
    assert o.page.locator("#tip").is_hidden()
    box.locator(".legend button").first.click()
    assert box.locator(".series.off").count() == 1
    with o.page.expect_download() as download:
        box.locator("button.csv").click()
    rows = list(csv.reader(io.StringIO(download.value.path().read_text())))
    assert download.value.suggested_filename == "damping-against-airspeed.csv" and "airspeed" in rows[0][0]
    name = case.found.names.index(rows[0][1].split(" (")[0])
    k = 40
    at = int(np.argmin(np.abs(case.sweep.V - float(rows[k][0]))))
    assert float(rows[k][1]) == pytest.approx(case.found.damping_ratio[at, name], rel=1e-6)


@pytest.mark.parametrize(("width", "scheme"), [(360, "light"), (1280, "dark")])
def test_it_fits_a_phone_and_the_dark(report: Path, opened: Callable[..., Opened], width: int, scheme: str) -> None:
    o = opened(report, viewport={"width": width, "height": 800}, color_scheme=scheme)
    for anchor in ("live", "modes", "flutter", "simulations"):
        o.show(anchor)
        o.page.wait_for_timeout(150)
    assert o.page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    paper = o.page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (paper == "rgb(255, 255, 255)") == (scheme == "light")
    o.page.evaluate("scrollTo(0, 0)")
    o.page.click("#theme")
    assert o.page.evaluate("document.documentElement.dataset.theme") == "dark"
    assert o.complaints == []


def test_it_prints(report: Path, opened: Callable[..., Opened]) -> None:
    o = opened(report)
    o.page.emulate_media(media="print")
    assert o.page.locator("nav").is_hidden() and o.page.locator(".chart").first.is_visible()
    assert o.page.pdf(format="A4").startswith(b"%PDF")


def test_the_thesis_wing_moves_at_25_frames_a_second(tmp_path: Path, opened: Callable[..., Opened]) -> None:
    file = av.read("thesis-uav")
    model = av.build(file)
    found = av.flutter(model, FlightCondition.at(0.0, V=np.linspace(5.0, 120.0, 24)), av.PK())
    lattice = lattice3d(file, model)
    data = scene_data(lattice, modes=mode_data(lattice, found))
    case = report_case("thesis-uav", ReportOptions(speed=70.0))
    live = next(s for s in sections(case) if s.anchor == "live")
    parts = (Part(title="Modes", anchor="modes", blocks=(Scene(data=data, title="t"),)), made(live, case))
    write_page(tmp_path / "u.html", parts, provenance_of(case, source="u", text="", command=""))
    o = opened(tmp_path / "u.html")
    idle = "() => new Promise((r) => { let n = 0; const t = performance.now(), f = () => { n++; const d = performance.now() - t; d > 600 ? r(1000 * n / d) : requestAnimationFrame(f); }; requestAnimationFrame(f); })"  # noqa: E501
    o.show("provenance")
    resting = o.page.evaluate(idle)
    for anchor, frames in (("modes", "aeroservoPage.scenes[0].frames"), ("live", "aeroservoPage.live[0].wing.frames")):
        o.show(anchor)
        o.until(f"aeroservoPage.{'scenes' if anchor == 'modes' else 'live'}[0]")
        o.page.click(f"#{anchor} button.play")
        o.page.wait_for_timeout(800)
        rates = []
        for _ in range(4):
            first = o.page.evaluate(f"[{frames}, performance.now()]")
            o.page.wait_for_timeout(700)
            last = o.page.evaluate(f"[{frames}, performance.now()]")
            rates.append(1000.0 * (last[0] - first[0]) / (last[1] - first[1]))
            if max(rates) >= LEAST_RATE:
                break
        o.page.click(f"#{anchor} button.play")
        if max(rates) < LEAST_RATE and (resting < 50.0 or os.getloadavg()[0] > 0.75 * (os.cpu_count() or 1)):
            pytest.skip(f"this machine is busy: {resting:.0f} frames/s at rest, load {os.getloadavg()[0]:.1f}: {rates}")
        assert max(rates) >= LEAST_RATE, (anchor, rates)
    assert o.complaints == []
