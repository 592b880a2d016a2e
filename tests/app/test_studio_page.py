"""The studio in a real browser: what it shows is what Python computes, whatever is typed, opened or killed."""

from __future__ import annotations

import http.client
import os
import shutil
import signal
import socket
import threading
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.flutter import PK, P, flutter
from aeroservo.aircraft.files import new, read
from aeroservo.aircraft.overrides import override
from aeroservo.datatypes import FlightCondition

pytest.importorskip("nicegui", reason="the extra 'studio' is not installed")
playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
CHROMIUM = shutil.which("chromium")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")

FLAGS = [
    "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-sandbox",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run",
]  # fmt: skip
STATUS = "document.querySelector('[data-status]').textContent"
FLUTTER = "document.querySelector('[data-speed=flutter] .ae-number').textContent"
STIFFNESS = "wing.pitch_stiffness_N_m"
WAIT = int(os.environ.get("STUDIO_WAIT", "40000"))
"""Longest wait for anything on a busy machine. [ms]"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("studio").resolve()


@pytest.fixture(scope="module")
def studio(folder: Path) -> Iterator[Any]:
    from aeroservo.studio.server import Choice, Studio

    _hostile(folder)
    running, ready = Studio(Choice(folder=folder)), threading.Event()
    thread = threading.Thread(target=running.serve, args=(ready.set,), daemon=True)
    thread.start()
    assert ready.wait(30.0)
    yield running
    running.stop()
    thread.join(20.0)
    assert not thread.is_alive()
    assert not running.pools[0].every


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as pw:
        found = pw.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield found
        found.close()


@pytest.fixture(scope="module")
def context(browser: Any) -> Iterator[Any]:
    found = browser.new_context()
    yield found
    found.close()


@pytest.fixture
def tab(studio: Any, context: Any, browser: Any) -> Iterator[Any]:
    """`tab()` opens a tab of its own; nothing in any tab may complain, fail or ask outside."""
    pages: list[Any] = []
    trouble: list[str] = []
    own = (studio.url, studio.url.replace("http", "ws"), "data:", "blob:")

    def opened(**options: Any) -> Any:
        page = browser.new_page(**options) if options else context.new_page()
        pages.append(page)
        page.on(
            "console", lambda m: trouble.append(m.text) if m.type in ("error", "warning") and _counts(m.text) else 0
        )
        page.on("pageerror", lambda e: trouble.append(str(e)))
        page.on("requestfailed", lambda r: trouble.append(f"failed {r.url}") if "socket.io" not in r.url else None)
        page.on("response", lambda r: trouble.append(f"{r.status} {r.url}") if r.status >= 400 else None)
        for event in ("request", "websocket"):
            page.on(event, lambda r: None if r.url.startswith(own) else trouble.append(r.url))
        page.goto(studio.url)
        settled(page)
        return page

    yield opened
    for page in pages:
        page.close()
    assert trouble == []


def _counts(message: str) -> bool:
    """Chromium's remark about reading pixels in software is about speed, not about the page."""
    return "GPU stall due to ReadPixels" not in message


def settled(page: Any) -> None:
    page.wait_for_function(f"document.querySelector('[data-status]') && {STATUS} === 'Up to date.'", timeout=WAIT)


def field(page: Any, name: str) -> Any:
    return page.locator(f"[data-field='{name}'] >> visible=true").first


def typed(page: Any, name: str, value: str) -> None:
    page.locator(f"input[data-field='{name}'], textarea[data-field='{name}']").fill(value)


def beside(page: Any, name: str) -> str:
    """The error beside a field."""
    told = page.locator(".ae-value").filter(has=page.locator(f"[data-field='{name}']")).locator(".ae-error:visible")
    return told.inner_text() if told.count() else ""


def python_flutter(name: str | Path, **changes: float) -> float:
    model = read(name)
    model = override(model, changes) if changes else model
    low, high, step = model.speeds_m_s or (1.0, 350.0, 1.0)
    V = np.minimum(low + step * np.arange(round((high - low) / step) + 1), high)
    method = P() if model.kind in ("binary_wing", "whole_aircraft", "pitch_plunge_flap") else PK()
    found = flutter(build(model), FlightCondition.at(0.0, V=V), method).flutter_speed
    assert found is not None
    return found


def test_opens_with_the_numbers_of_python_and_a_wing_that_moves(tab: Any) -> None:
    page = tab()
    assert page.evaluate(FLUTTER) == f"{python_flutter('thesis-binary'):#.5g} m/s"
    assert page.locator(".ae-chart canvas").count() == 2
    page.wait_for_function("document.querySelector('[data-wing=wing-modes]').aeroWing?.frames > 0", timeout=WAIT)
    wing = "document.querySelector('[data-wing=wing-modes]').aeroWing"
    page.locator("[data-wing=wing-modes]").scroll_into_view_if_needed()
    before = page.evaluate(f"{wing}.positions()")
    page.locator("[data-wing=wing-modes] button.play").click()
    page.wait_for_function(f"{wing}.frames > 8", timeout=WAIT)
    after = page.evaluate(f"{wing}.positions()")
    assert np.abs(np.array(after) - np.array(before)).max() > 1e-3


def test_stiffness_to_flutter_speed_on_screen_in_under_a_second(tab: Any) -> None:
    page, times = tab(), []
    page.evaluate(
        "s => { window.log = []; const n = document.querySelector('[data-speed=flutter] .ae-number');"
        "const all = {subtree: true, childList: true, characterData: true}, now = () => performance.now();"
        "new MutationObserver(() => log.push(now())).observe(n, all);"
        "document.querySelector(s).addEventListener('input', () => { window.began = now(); log.length = 0; }); }",
        f"input[data-field='{STIFFNESS}']",
    )
    for value in (500.0, 450.0, 380.0, 350.0):
        typed(page, STIFFNESS, str(value))
        expected = f"{python_flutter('thesis-binary', **{STIFFNESS: value}):#.5g} m/s"
        page.wait_for_function(f"{FLUTTER} === '{expected}'", timeout=WAIT)
        times.append(page.evaluate("log[log.length - 1] - window.began") / 1e3)
        settled(page)
    assert min(times) / _busy() < 1.0
    change = page.locator("[data-speed=flutter] .ae-delta").inner_text()
    old, now = python_flutter("thesis-binary"), python_flutter("thesis-binary", **{STIFFNESS: 350.0})
    assert change == f"file: {old:#.5g} ({now - old:+.4g}, {100.0 * (now - old) / old:+.2f} %)"
    assert field(page, STIFFNESS).locator("xpath=ancestor::*[@class='ae-value']").inner_text().endswith("file: 413.2")
    page.get_by_role("button", name="Back to the file's values").click()
    page.wait_for_function(f"{FLUTTER} === '{old:#.5g} m/s'", timeout=WAIT)


def test_bad_input_is_told_beside_its_field(tab: Any) -> None:
    page = tab()
    cases = {
        "wide": "must be a number", "-3": "must be greater than 0 and at most 1e+15", "nan": "must be a finite number",
        "1e999": "must be a finite number",
    }  # fmt: skip
    for text, message in cases.items():
        typed(page, STIFFNESS, text)
        page.wait_for_function(f"{STATUS}.startsWith('Not computed')", timeout=WAIT)
        page.wait_for_function("m => document.body.innerText.includes(m)", arg=message, timeout=WAIT)
        assert beside(page, STIFFNESS) == message
        assert beside(page, "wing.chord_m") == ""
    typed(page, STIFFNESS, "413.2")
    typed(page, "wing.GJ_N_m2", "800")  # two springs in torsion: told at both
    page.wait_for_function(f"{STATUS}.includes('give exactly one of')", timeout=WAIT)
    page.wait_for_timeout(200)
    assert all("give exactly one of" in beside(page, name) for name in (STIFFNESS, "wing.GJ_N_m2"))
    assert beside(page, "wing.EI_N_m2") == ""
    typed(page, "wing.GJ_N_m2", "")
    page.get_by_role("button", name="add [damping]").click()
    page.get_by_role("button", name="add [damping.modal]").click()
    typed(page, "damping.modal.ratios", "0.02, 0.02, 0.02")  # for two modes: only the mechanics can know
    page.wait_for_function(f"{STATUS}.startsWith('Cannot be computed')", timeout=WAIT)
    assert "ratios" in beside(page, "damping.modal.ratios")
    typed(page, "damping.modal.ratios", "0.0, 0.0")
    typed(page, "speeds_m_s", "10, x, 1")
    page.wait_for_function(f"{STATUS}.includes('speeds_m_s[1]')", timeout=WAIT)
    assert beside(page, "speeds_m_s") == "must be a number"
    typed(page, "speeds_m_s", "1, 150, 0.5")
    settled(page)
    assert page.locator(".ae-error:visible").count() == 0
    assert page.evaluate(FLUTTER) == f"{python_flutter('thesis-binary'):#.5g} m/s"


def test_rows_tables_and_columns_of_an_aircraft(tab: Any, folder: Path) -> None:
    page = tab()
    _open(page, "light.toml", title="thesis-uav")
    page.get_by_label("scale structure.station GJ_N_m2").click()
    page.get_by_label("factor").fill("1.5")
    page.get_by_role("button", name="Multiply").click()
    changes = {f"structure.station[{i}].GJ_N_m2": 1.5 * 413.2 for i in range(5)}
    expected = f"{python_flutter(folder / 'light.toml', **changes):#.5g} m/s"
    page.wait_for_function(f"{FLUTTER} === '{expected}'", timeout=WAIT)
    settled(page)
    page.get_by_label("remove structure.station[4]").click()
    page.wait_for_function(f"{STATUS}.includes('must run from root to tip')", timeout=WAIT)
    page.get_by_role("button", name="Back to the file's values").click()
    settled(page)
    page.get_by_role("button", name="add [damping]").click()
    page.wait_for_function(f"{STATUS}.includes('needs exactly one of')", timeout=WAIT)
    page.get_by_role("button", name="add [damping.hysteretic]").click()
    page.wait_for_function(f"{STATUS}.includes('damping.hysteretic.g: is missing')", timeout=WAIT)
    typed(page, "damping.hysteretic.g", "0.02")
    page.wait_for_function(f"!{STATUS}.startsWith('Not computed')", timeout=WAIT)
    assert page.locator(".ae-error:visible").count() == 0


def test_two_tabs_do_not_disturb_each_other(tab: Any) -> None:
    one, two = tab(), tab()
    _open(two, "thesis-simulation")
    other = two.evaluate(FLUTTER)
    typed(one, STIFFNESS, "600")
    typed(one, "wing.chord_m", "x")
    one.wait_for_function(f"{STATUS}.startsWith('Not computed')", timeout=WAIT)
    two.wait_for_timeout(300)
    assert two.evaluate(FLUTTER) == other == f"{python_flutter('thesis-simulation'):#.5g} m/s"
    assert two.evaluate(STATUS) == "Up to date."
    typed(two, "model.K_theta_N_m_rad", "500")
    changed = python_flutter("thesis-simulation", **{"model.K_theta_N_m_rad": 500.0})
    two.wait_for_function(f"{FLUTTER} === '{changed:#.5g} m/s'", timeout=WAIT)
    typed(one, "wing.chord_m", "0.53")
    expected = python_flutter("thesis-binary", **{STIFFNESS: 600.0})
    one.wait_for_function(f"{FLUTTER} === '{expected:#.5g} m/s'", timeout=WAIT)


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_killed_computation_is_told_and_the_studio_goes_on(tab: Any, studio: Any) -> None:
    page = tab()
    workers = _workers(studio)
    for worker in workers:
        os.kill(worker.process.pid, signal.SIGSTOP)
    typed(page, STIFFNESS, "555")
    page.wait_for_function(f"{STATUS} !== 'Up to date.'", timeout=WAIT)
    for worker in workers:
        os.kill(worker.process.pid, signal.SIGKILL)
    page.wait_for_function(f"{STATUS}.startsWith('The computation crashed')", timeout=WAIT)
    assert "killed by SIGKILL; the studio goes on" in page.evaluate(STATUS)
    page.get_by_role("button", name="Compute again").click()
    expected = python_flutter("thesis-binary", **{STIFFNESS: 555.0})
    page.wait_for_function(f"{FLUTTER} === '{expected:#.5g} m/s'", timeout=WAIT)
    settled(page)


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_computation_that_hangs_can_be_cancelled(tab: Any, studio: Any) -> None:
    page = tab()
    _until(lambda: studio.pools[0]._starting == 0)  # one that started later would not be stopped
    stopped = _workers(studio)
    for worker in stopped:
        os.kill(worker.process.pid, signal.SIGSTOP)
    typed(page, STIFFNESS, "556")
    page.get_by_role("button", name="Cancel", exact=True).first.click()
    page.wait_for_function(f"{STATUS}.startsWith('cancelled')", timeout=WAIT)
    assert page.locator("[data-speed=flutter].ae-stale").count() == 1
    until = time.monotonic() + 1e-3 * WAIT
    while all(worker.alive for worker in stopped):  # the one that computes does not answer, so it is killed
        assert time.monotonic() < until, "the deaf process was not killed"
        page.wait_for_timeout(100)
    for worker in stopped:
        if worker.alive:
            os.kill(worker.process.pid, signal.SIGCONT)
    page.get_by_role("button", name="Compute again").click()
    expected = python_flutter("thesis-binary", **{STIFFNESS: 556.0})
    page.wait_for_function(f"{FLUTTER} === '{expected:#.5g} m/s'", timeout=WAIT)


def test_saves_a_file_that_read_accepts_and_never_over_another_unasked(tab: Any, folder: Path) -> None:
    page = tab()
    typed(page, STIFFNESS, "480.5")
    settled(page)
    _save(page, "mine.toml")
    page.wait_for_selector("text=wrote", timeout=WAIT)
    saved = read(folder / "mine.toml")
    assert saved.wing.pitch_stiffness_N_m == 480.5  # type: ignore[attr-defined]
    text = (folder / "mine.toml").read_text(encoding="utf-8")
    assert "# N m/rad. Table 1, INFERRED" in text and text.startswith("# Binary wing read out of the thesis")
    settled(page)
    assert page.locator("[data-speed=flutter] .ae-delta").inner_text() == ""  # the file is now what was edited
    typed(page, STIFFNESS, "300")
    settled(page)
    for name, refused in {
        "../out.toml": "no folders",
        "/tmp/out.toml": "no folders",
        "x.txt": "must end in .toml",
    }.items():
        _save(page, name)
        page.wait_for_selector(f"text={refused}", timeout=WAIT)
        page.get_by_role("button", name="Close").click()
        page.wait_for_timeout(300)
    _save(page, "mine.toml")
    page.wait_for_selector("text=exists already", timeout=WAIT)
    assert read(folder / "mine.toml").wing.pitch_stiffness_N_m == 480.5  # type: ignore[attr-defined]
    page.get_by_role("button", name="Replace mine.toml").click()
    _until(lambda: tomllib.loads((folder / "mine.toml").read_text())["wing"]["pitch_stiffness_N_m"] == 300.0)
    assert not [path for path in folder.parent.rglob("*out.toml")] and not Path("/tmp/out.toml").exists()


def test_the_report_is_of_the_draft(tab: Any, folder: Path) -> None:
    page = tab()
    typed(page, STIFFNESS, "470.25")
    settled(page)
    page.get_by_role("button", name="Report").click()
    page.get_by_role("button", name="Save", exact=True).click()
    page.wait_for_selector("text=wrote", timeout=WAIT)
    text = (folder / "thesis-binary.html").read_text(encoding="utf-8")
    expected = python_flutter("thesis-binary", **{STIFFNESS: 470.25})
    assert "470.25" in text and f"{expected:.4g}" in text
    page.get_by_role("button", name="Report").click()
    with page.expect_download(timeout=WAIT) as download:
        page.get_by_role("button", name="Download instead").click()
    assert "470.25" in Path(download.value.path()).read_text(encoding="utf-8")
    page.get_by_role("button", name="Save", exact=True).click()
    page.wait_for_selector("text=exists already", timeout=WAIT)


def test_flights_are_those_of_python_and_can_be_seen(tab: Any) -> None:
    from aeroservo.studio.flight import Flight, fly

    page = tab()
    _open(page, "thesis-simulation")
    page.get_by_role("tab", name="Simulation").click()
    page.locator("input[data-flight=speed]").fill("fast")
    page.get_by_role("button", name="Simulate").click()
    page.wait_for_selector("text=must be a number", timeout=WAIT)
    page.locator("input[data-flight=speed]").fill("45")
    _pick(page, "what happens", "1-cosine gust")
    page.get_by_role("button", name="Simulate").click()
    page.wait_for_selector("text=Bounded: no", timeout=WAIT)
    _pick(page, "controller", "LQR designed here")
    page.get_by_role("button", name="Simulate").click()
    page.wait_for_selector("text=Bounded: yes", timeout=WAIT)
    model = read("thesis-simulation")
    text = (Path(__file__).parents[2] / "src/aeroservo/aircraft/presets/thesis-simulation.toml").read_text()
    flight = Flight(speed=45.0, shake="cosine", regulated=True)
    run = fly(text, Path(f"{model.name}.toml"), flight, lambda *_: None, lambda *_: None)
    with page.expect_download() as download:
        page.get_by_role("button", name="History as CSV").click()
    assert Path(download.value.path()).read_bytes() == run.csv
    growth = dict(run.facts)["Growth of the envelope"]
    assert growth in page.locator("text=Bounded: yes").inner_text()
    wing = "document.querySelector('[data-wing=wing-flight]').aeroWing"
    page.locator("[data-wing=wing-flight]").scroll_into_view_if_needed()
    page.wait_for_function(f"{wing}?.playing && {wing}.frames > 3 && {wing}.time > 0.1", timeout=WAIT)
    assert page.locator(".ae-history canvas").count() >= 3


def test_a_hostile_model_runs_nothing_and_shows_its_text(tab: Any, folder: Path) -> None:
    page = tab()
    page.evaluate("window.pwned = 0")
    _open(page, "hostile.toml", title="<img src=x")
    assert page.evaluate("window.pwned") == 0
    assert page.locator("img[src=x], svg[onload], script[data-evil]").count() == 0
    assert "<img src=x onerror=" in page.locator("#model .ae-name").first.inner_text()
    page.get_by_role("tab", name="Simulation").click()
    page.locator("input[data-flight=speed]").fill("20")
    page.get_by_role("button", name="Simulate").click()
    page.wait_for_selector("text=Bounded", timeout=WAIT)
    page.get_by_role("button", name="Save model").click()
    page.get_by_role("button", name="Close").click()
    page.get_by_role("tab", name="Flutter and modes").click()
    _pick(page, "model", "modes.toml")
    page.wait_for_selector("text=<b onmouseover", timeout=WAIT)  # names of modes come out of the data file
    _pick(page, "model", "deep.toml")
    page.wait_for_selector("text=nested too deeply", timeout=WAIT)
    _pick(page, "model", "huge.toml")
    page.wait_for_selector("text=must be a finite number", timeout=WAIT)
    assert page.evaluate("window.pwned") == 0
    names = page.evaluate("[...document.querySelectorAll('.q-item')].map(e => e.textContent).join()")
    assert "link.toml" not in names  # leads out of the folder


def test_a_phone_has_everything_in_its_width(tab: Any) -> None:
    page = tab(viewport={"width": 390, "height": 844}, has_touch=True)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.get_by_role("link", name="Model").click()
    typed(page, STIFFNESS, "500")
    expected = python_flutter("thesis-binary", **{STIFFNESS: 500.0})
    page.wait_for_function(f"{FLUTTER} === '{expected:#.5g} m/s'", timeout=WAIT)
    box = page.locator("[data-speed=flutter]").bounding_box()
    assert 0 <= box["y"] < 400  # the speeds stay in sight while one edits
    page.get_by_label("dark or light").click()
    page.wait_for_selector("body.body--dark", timeout=WAIT)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_strangers_are_refused(studio: Any) -> None:
    def status(**headers: str) -> int:
        connection = http.client.HTTPConnection("127.0.0.1", studio.port, timeout=10)
        connection.request("GET", "/", headers=headers)
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        if answer.status == 200:
            assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]
        else:
            assert b"of this machine only" in content
        return answer.status

    own = f"127.0.0.1:{studio.port}"
    assert status() == 200
    assert status(Host=f"localhost:{studio.port}") == 200
    assert status(Host=f"evil.example:{studio.port}") == 403  # DNS rebinding
    assert status(Host="127.0.0.1:1") == 403
    assert status(Host=own, Origin="http://evil.example") == 403
    assert status(Host=own, Origin=f"http://{own}") == 200
    assert _websocket(studio.port, "http://evil.example") == 403
    assert _websocket(studio.port, f"http://{own}") == 101


def _busy() -> float:
    """How many times longer than its processor time something takes on this machine now: 1 where nothing else runs."""
    wall, processor = time.perf_counter(), time.thread_time()
    while time.thread_time() - processor < 0.2:
        sum(range(10_000))
    return (time.perf_counter() - wall) / (time.thread_time() - processor)


def _websocket(port: int, origin: str) -> int:
    """Status of an upgrade to a websocket."""
    asked = (
        "GET /_nicegui_ws/socket.io/?EIO=4&transport=websocket HTTP/1.1\r\n"
        f"Host: 127.0.0.1:{port}\r\nOrigin: {origin}\r\n"
        "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        "Sec-WebSocket-Version: 13\r\n\r\n".encode()
    )
    with socket.create_connection(("127.0.0.1", port), timeout=10.0) as connection:
        connection.sendall(asked)
        return int(connection.recv(4096).split()[1])


def _open(page: Any, name: str, title: str = "") -> None:
    _pick(page, "model", name)
    page.wait_for_function(
        "t => document.querySelector('#model .ae-name').textContent.startsWith(t)", arg=title or name
    )
    settled(page)


def _pick(page: Any, label: str, option: str, *, exact: bool = False) -> None:
    page.get_by_label(label, exact=True).first.click()
    page.get_by_role("option", name=option, exact=exact).first.click()


def _save(page: Any, name: str) -> None:
    page.get_by_role("button", name="Save model").click()
    page.get_by_label("file name").fill(name)
    page.wait_for_timeout(300)
    page.get_by_role("button", name="Save", exact=True).click()


def _workers(studio: Any) -> list[Any]:
    return [worker for worker in studio.pools[0].every if worker.alive]


def _until(true: Any) -> None:
    end = time.monotonic() + WAIT / 1e3
    while not true():
        assert time.monotonic() < end
        time.sleep(0.1)


def _hostile(folder: Path) -> None:
    """Model files that try to get out of the page and out of the folder."""
    name = "<img src=x onerror=window.pwned=1>`${window.pwned=1}`</script><script data-evil>window.pwned=1</script>"
    new("thesis-uav", folder / "light.toml")
    light = (folder / "light.toml").read_text(encoding="utf-8")
    (folder / "light.toml").write_text(light.replace("[1.0, 130.0, 1.0]", "[70.0, 110.0, 5.0]"), encoding="utf-8")
    new("thesis-simulation", folder / "plain.toml")
    text = (folder / "plain.toml").read_text(encoding="utf-8")
    text = text.replace('name = "thesis-simulation"', f"name = '{name}'")
    text = text.replace('source = "the vortex lattice"', "source = '<svg onload=window.pwned=1>{{window.pwned=1}}'")
    (folder / "hostile.toml").write_text(text, encoding="utf-8")
    (folder / "deep.toml").write_text("kind = 'modal'\na = " + "[" * 3000 + "]" * 3000, encoding="utf-8")
    (folder / "huge.toml").write_text(text.replace("m_kg = 10.0", "m_kg = 1e999"), encoding="utf-8")
    one, zero = np.eye(2), np.zeros((2, 2))
    arrays = {
        "M": one,
        "D": 0.02 * one,
        "K": np.diag([100.0, 900.0]),
        "k": np.array([0.0, 1.0]),
        "mach": np.array([0.0]),
    }
    Q = np.zeros((1, 2, 2, 2), complex) + np.stack([zero, zero])
    names = np.array(["<b onmouseover=window.pwned=1>a</b>", "'\"><img src=x onerror=window.pwned=1>"])
    np.savez(folder / "modes.npz", **arrays, Q=Q, b_m=1.0, mode_names=names, input_names=names)
    (folder / "modes.toml").write_text(
        "kind = 'modal'\nname = 'modes'\n[modal]\ndata = 'modes.npz'\n", encoding="utf-8"
    )
    if os.name == "posix":
        (folder.parent / "outside.toml").write_text(text, encoding="utf-8")
        (folder / "link.toml").symlink_to(folder.parent / "outside.toml")
