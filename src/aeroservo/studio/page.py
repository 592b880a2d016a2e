"""The page of the studio: header, speeds, form, results. One call for each browser tab; tabs share nothing."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nicegui import ui

from aeroservo.aircraft.file_errors import ModelFileError
from aeroservo.aircraft.files import presets
from aeroservo.studio.analysis import Air
from aeroservo.studio.draft import Finding, typed
from aeroservo.studio.folder import files_in
from aeroservo.studio.form import FormView
from aeroservo.studio.pool import Pool
from aeroservo.studio.results import ResultView, SpeedCards
from aeroservo.studio.saving import SaveDialogs
from aeroservo.studio.session import Session
from aeroservo.studio.simulation import SimulationView
from aeroservo.studio.wing import load_scripts

if TYPE_CHECKING:
    from aeroservo.studio.server import Choice

_CSS = Path(__file__).with_name("studio.css")
_AERO = {
    "": "air forces: by kind of model", "quasi_steady": "quasi-steady", "quasi_steady_damped": "quasi-steady, damped",
    "jones": "Jones strips", "theodorsen": "Theodorsen strips",
}  # fmt: skip
_METHODS = {"": "method: by kind of model", "p": "p", "pk": "p-k", "k": "k", "g": "g"}


async def page(choice: Choice, pool: Pool) -> None:
    """Build the page of a new tab.

    Parameters
    ----------
    choice : Choice
        What the studio was started with.
    pool : Pool
        Processes that compute.
    """
    load_scripts()
    ui.add_css(_CSS)
    tab = _Tab(choice, pool)
    client = ui.context.client
    client.on_delete(tab.close)
    await client.connected(timeout=30.0)
    tab.open(choice.model)


class _Tab:
    """The widgets of one tab and the session behind them."""

    def __init__(self, choice: Choice, pool: Pool) -> None:
        self._session = Session(choice.folder, pool, self._update)
        self._dark = ui.dark_mode(None)
        self._client = ui.context.client
        self._header()
        with ui.element("div").classes("ae-speeds"):
            self._cards = SpeedCards()
            with ui.element("div").classes("ae-status"):
                self._bar = ui.linear_progress(0.0, show_value=False)
                self._says = ui.label().classes("ae-says").props("aria-live=polite data-status")
                self._cancel = ui.button("Cancel", on_click=self._session.cancel).props("flat dense no-caps size=sm")
                self._again = ui.button("Compute again", on_click=self._session.recompute)
                self._again.props("flat dense no-caps size=sm")
                with ui.element("nav").classes("ae-jump"):
                    ui.link("Model", "#model")
                    ui.link("Results", "#results")
        with ui.element("div").classes("ae-body"):
            with ui.element("section").classes("ae-panel").props("id=model"):
                with ui.row().classes("ae-title"):
                    self._title = ui.label().classes("ae-name").props("role=heading aria-level=2")
                    self._back = ui.button("Back to the file's values", icon="undo", on_click=self._reset)
                    self._back.props("flat dense no-caps size=sm")
                container = ui.element("div")
                self._form = FormView(container, self._edited)
            self._right()
        self._saving = SaveDialogs(self._session, self._tell)
        with ui.dialog() as self._sure, ui.card():
            ui.label("The model was changed and not saved. Discard the changes?")
            with ui.row():
                ui.button("Discard", on_click=lambda: self._sure.submit(True)).props("no-caps color=negative")
                ui.button("Keep editing", on_click=lambda: self._sure.submit(False)).props("flat no-caps")
        self._name = ""

    def open(self, name: str) -> None:
        """Open a model and show its form; where it is refused, say why and stay."""
        try:
            self._session.open(name)
        except (ModelFileError, OSError) as error:
            self._tell(str(error), bad=True)
            self._open.value = self._name or None
            return
        self._name = name
        self._open.value = name
        self._flights.forget()
        self._rebuild()
        self._update()

    def close(self) -> None:
        """The tab is gone."""
        with contextlib.suppress(RuntimeError):
            self._flights.cancel()
            self._saving.close()
        self._session.close()

    def _header(self) -> None:
        self._names = {p.name: f"{p.name} (preset, {p.kind.replace('_', ' ')})" for p in presets()}
        self._names |= {name: name for name in files_in(self._session.folder, ".toml")}
        with ui.element("header").classes("ae-top"):
            ui.label("aeroservo studio").classes("ae-brand").props("role=heading aria-level=1")
            self._open = (
                ui.select(self._names, label="model", on_change=self._chosen).props("dense outlined").classes("ae-open")
            )
            self._altitude = (
                ui.input("altitude", value="0").props("dense outlined suffix=m debounce=200").style("width: 110px")
            )
            self._altitude.on_value_change(self._moved)
            self._aero = ui.select(_AERO, value="", on_change=self._moved).props("dense outlined options-dense")
            self._method = ui.select(_METHODS, value="", on_change=self._moved).props("dense outlined options-dense")
            ui.button("Save model", icon="save", on_click=lambda: self._saving.model()).props("no-caps dense flat")
            ui.button("Report", icon="description", on_click=lambda: self._saving.report()).props("no-caps dense flat")
            night = ui.button(icon="contrast", on_click=self._night).props(
                'flat dense round aria-label="dark or light"'
            )
            night.tooltip("dark or light")

    def _right(self) -> None:
        with ui.element("section").classes("ae-panel ae-right").props("id=results"):
            with ui.tabs().props("dense no-caps align=left") as tabs:
                results, flights = ui.tab("Flutter and modes"), ui.tab("Simulation")
            with ui.tab_panels(tabs, value=results, animated=False, keep_alive=True):
                with ui.tab_panel(results):
                    self._results = ResultView()
                with ui.tab_panel(flights):
                    self._flights = SimulationView(self._session)

    async def _chosen(self, event: Any) -> None:
        name = event.value
        if not name or name == self._name:
            return
        if self._name and self._session.changed and not await self._sure:
            self._open.value = self._name
            return
        self.open(name)

    def _edited(self, draft: Any) -> None:
        self._session.edit(draft)
        self._form.mark(self._session.findings)
        self._heading()

    def _reset(self) -> None:
        self._session.edit(self._session.source.draft)
        self._rebuild()

    def _rebuild(self) -> None:
        session = self._session
        self._form.show(session.source.model.kind, session.draft, session.source.draft)
        self._form.mark(session.findings)
        self._heading()

    def _heading(self) -> None:
        source, n = self._session.source, len(self._session.changed)
        where = "preset" if source.preset else source.path.name
        self._title.text = f"{source.model.name} ({where})" + (f", {n} change{'s' * (n > 1)}" if n else "")
        self._back.visible = bool(n)

    def _moved(self) -> None:
        altitude = typed("number", self._altitude.value or "0")
        if not isinstance(altitude, float) or not -5e3 <= altitude <= 8e4:
            self._altitude.error = "-5000 to 80000 m"
            return
        self._altitude.error = None
        self._session.analysed(Air(altitude=altitude, aero=self._aero.value or None, method=self._method.value or None))

    def _night(self) -> None:
        dark = not self._results.dark
        self._dark.value = dark
        self._results.dark = dark
        self._results.show(self._session.now, self._session.before)
        self._flights.redraw(dark=dark)
        self._client.run_javascript("setTimeout(() => document.dispatchEvent(new Event('themechange')), 200)")

    def _update(self) -> None:
        """Show what the session knows."""
        session = self._session
        busy = session.state == "computing"
        stale = session.state in ("wrong", "refused", "died", "cancelled")
        self._cards.show(session.now, session.before, stale=stale)
        self._bar.visible = self._cancel.visible = busy
        self._again.visible = session.state in ("died", "cancelled")
        self._bar.value = session.part
        words = {"wrong": "Not computed: ", "refused": "Cannot be computed: ", "died": "The computation crashed: "}
        done = "computing" if busy else "Up to date."
        self._says.text = f"{words.get(session.state, '')}{session.says or done}"
        self._says.classes(add="ae-bad" if stale else "", remove="" if stale else "ae-bad")
        if session.state == "done":
            self._flights.offer()
        elif session.state == "refused":  # told by the mechanics: beside the fields that it names
            self._form.mark((Finding(place=(), message=session.says),))
        self._results.show(session.now, session.before)

    def _tell(self, message: str, *, bad: bool = False) -> None:
        """A line that comes and goes; after saving, the file is what is edited."""
        with self._client:
            ui.notify(
                message, type="negative" if bad else "positive", close_button="OK" if bad else False, multi_line=True
            )
        if not bad and self._session.source.path.name != self._name and not self._session.source.preset:
            self._name = self._session.source.path.name
            self._names[self._name] = self._name
            self._open.set_options(self._names, value=self._name)
        if not bad:
            self._rebuild()
