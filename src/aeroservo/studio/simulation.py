"""Flights in the page: what happens, charts of the channels, the replay in three dimensions."""

from __future__ import annotations

import asyncio
import math
from typing import Any, get_args

from nicegui import ui

from aeroservo.aircraft.file_errors import ModelFileError
from aeroservo.aircraft.schema_other import StateSpaceFile
from aeroservo.studio.charts import channel_label, history_chart
from aeroservo.studio.draft import typed
from aeroservo.studio.flight import KICK, LQR, Flight, Run, Shake
from aeroservo.studio.folder import files_in, inside
from aeroservo.studio.pool import Died, Refused
from aeroservo.studio.results import notes
from aeroservo.studio.session import Session
from aeroservo.studio.wing import WingView

_SHAKES = {
    "kick": f"start displaced by {KICK:g}",
    "sharp": "sharp-edged gust",
    "cosine": "1-cosine gust",
    "light": "light turbulence",
    "moderate": "moderate turbulence",
    "severe": "severe turbulence",
}
_OFF = "off"
#: Most charts of channels.
_MOST = 6


class SimulationView:
    """The panel of one tab."""

    def __init__(self, session: Session) -> None:
        self._session, self.dark = session, False
        self._task: asyncio.Task[None] | None = None
        self.run: Run | None = None
        self._last: Run | None = None
        self._inputs: dict[str, Any] = {}
        with ui.element("div").classes("ae-controls"):
            self._number("speed", "true airspeed", "m/s", "")
            self._number("duration", "duration", "s", "5")
            self._shake = (
                ui.select(_SHAKES, value="kick", label="what happens").props("dense outlined").classes("ae-wide")
            )
            self._number("gust", "gust velocity, up", "m/s", "1")
            self._number("length", "gust wavelength", "m", "20")
            self._number("seed", "seed", "", "0")
            self._controller = (
                ui.select([_OFF], value=_OFF, label="controller").props("dense outlined").classes("ae-wide")
            )
        assert set(_SHAKES) == set(get_args(Shake))
        self._shake.on_value_change(self._fields)
        self._fields()
        with ui.row().classes("ae-status"):
            self.start = ui.button("Simulate", icon="play_arrow", on_click=self.begin).props(
                "no-caps dense color=primary"
            )
            self._stop = ui.button("Cancel", on_click=self.cancel).props("flat dense no-caps")
            self._bar = ui.linear_progress(0.0, show_value=False)
            self._says = ui.label().classes("ae-says").props("aria-live=polite")
        self._facts = ui.label().classes("ae-meaning")
        self._notes = ui.element("div")
        self._wing = WingView("wing-flight")
        self._pick = ui.select([], multiple=True, label="channels", on_change=self._draw)
        self._pick.props("dense outlined use-chips").style("width: 100%")
        self._charts = ui.element("div").classes("ae-charts")
        self._hint = ui.label("Grey dashes: the run before.").classes("ae-hint")
        self._csv = ui.button("History as CSV", icon="download", on_click=self._download).props("flat dense no-caps")
        self._busy(False)
        self._results(False)

    def offer(self) -> None:
        """Take over what the session has: controllers in the folder, a speed to begin with."""
        files = [_OFF, LQR, *files_in(self._session.folder, ".json")]
        self._controller.set_options(files, value=self._controller.value if self._controller.value in files else _OFF)
        speed = self._inputs["speed"]
        model = self._session.source.model
        if isinstance(model, StateSpaceFile):
            speed.value = f"{model.model.speed_m_s:g}"
        elif not speed.value and self._session.now is not None and self._session.now.speeds:
            flutter = self._session.now.speeds[0].value
            high = (model.speeds_m_s or (1.0, 100.0, 1.0))[1]
            speed.value = f"{0.9 * flutter if flutter else 0.3 * high:.3g}"

    def forget(self) -> None:
        """Another model: nothing of the last one stays."""
        self.cancel()
        self.run = self._last = None
        self._inputs["speed"].value = ""
        self._results(False)
        self._says.text = ""

    def begin(self) -> None:
        """Simulate what the panel says."""
        self.cancel()
        try:
            flight = self._flight()
            job = self._session.job("fly", flight)
        except (ValueError, ModelFileError) as error:
            self._complain(str(error))
            return
        self._busy(True)
        self._task = asyncio.get_running_loop().create_task(self._fly(job))

    def cancel(self) -> None:
        """Stop simulating."""
        if self._task is not None and not self._task.done():
            self._task.cancel()
            self._busy(False)
            self._says.text = "cancelled"
        self._task = None

    def _flight(self) -> Flight:
        """What the panel says, or an error beside the field that is wrong."""
        if self._session.findings:
            raise ValueError(f"correct the model first: {self._session.says}")
        values: dict[str, Any] = {}
        for name, field in self._inputs.items():
            field.error = None
            value = typed("whole" if name == "seed" else "number", field.value or "")
            if isinstance(value, str) or value is None or not math.isfinite(value):
                field.error = "must be a number"
                raise ValueError(f"{name} must be a number, got {str(field.value)[:40]!r}")
            values[name] = value
        controller = self._controller.value
        path = None if controller in (_OFF, LQR) else inside(self._session.folder, controller, ".json")
        air = self._session.air
        altitude = air.altitude
        model = self._session.source.model
        if isinstance(model, StateSpaceFile):
            altitude = model.model.altitude_m
        try:
            return Flight(
                **values, altitude=altitude, aero=air.aero, shake=self._shake.value, controller=path,
                regulated=controller == LQR,
            )  # fmt: skip
        except ValueError as error:
            named = self._inputs.get(str(error).split(" ")[0])
            if named is not None:
                named.error = str(error).split(" ", 1)[1]
            raise

    async def _fly(self, job: Any) -> None:
        def tell(what: str, part: float) -> None:
            self._says.text, self._bar.value = what, part

        try:
            run = await self._session.run(job, tell)
        except Refused as error:
            self._complain(str(error))
        except Died as error:
            self._complain(f"{error}; the studio goes on: simulate again")
        else:
            self._last, self.run = self.run, run
            self._show(run)
        self._busy(False)

    def _show(self, run: Run) -> None:
        flight = run.flight
        on = (
            "no controller"
            if flight.controller is None and not flight.regulated
            else f"controller {self._controller.value}"
        )
        self._says.text = f"{flight.speed:g} m/s at {flight.altitude:g} m, {_SHAKES[flight.shake]}, {on}"
        self._facts.text = "   ·   ".join(f"{name}: {value}" for name, value in run.facts)
        notes(self._notes, run.notes)
        labels = {i: channel_label(c, u) for i, (c, u) in enumerate(zip(run.channels, run.units))}
        same = self._last is not None and self._last.channels == run.channels
        kept = [i for i in self._pick.value or [] if i in labels] if same else []
        self._pick.set_options(labels, value=[*kept, *(i for i in _telling(run) if i not in kept)][:_MOST])
        self._results(True)
        self._wing.show(run.scene, play=True)
        self._draw()

    def _draw(self) -> None:
        if self.run is None:
            return
        chosen = list(self._pick.value or [])[:_MOST]
        self._charts.clear()
        with self._charts:
            for i in chosen:
                ui.echart(history_chart(self.run, i, self._last, dark=self.dark)).classes("ae-history")

    def redraw(self, *, dark: bool) -> None:
        """Draw in other colours."""
        self.dark = dark
        self._draw()

    def _download(self) -> None:
        if self.run is not None:
            ui.download.content(self.run.csv, "history.csv", "text/csv")

    def _number(self, name: str, label: str, unit: str, value: str) -> None:
        field = ui.input(label, value=value).props("dense outlined hide-bottom-space")
        field.props["suffix"] = unit
        field.props["data-flight"] = name
        self._inputs[name] = field

    def _fields(self) -> None:
        """Show the fields that matter."""
        shake = self._shake.value
        self._inputs["gust"].visible = shake in ("sharp", "cosine")
        self._inputs["length"].visible = shake == "cosine"
        self._inputs["seed"].visible = shake in ("light", "moderate", "severe")

    def _busy(self, busy: bool) -> None:
        self._stop.visible = self._bar.visible = busy
        self.start.enabled = not busy
        self._says.classes(remove="ae-bad")

    def _complain(self, message: str) -> None:
        self._busy(False)
        self._says.text = message
        self._says.classes(add="ae-bad")

    def _results(self, there: bool) -> None:
        for element in (self._facts, self._notes, self._pick, self._charts, self._csv, self._hint):
            element.visible = there
        if not there:
            self._wing.show("")


def _telling(run: Run) -> list[int]:
    """Channels to begin with: displacements that move most, the elevon, the gust."""
    moving = [i for i in range(len(run.channels)) if run.peak[i] > 0.0]
    ends = ("rate_m_s", "rate_rad_s", "rate_1_s", "command_rad", "speed_m_s", "altitude_m", "acceleration_m_s2")
    first = [i for i in moving if not run.channels[i].endswith((*ends, "gust_m_s")) and "elevon" not in run.channels[i]]
    controls = [i for i in moving if "elevon" in run.channels[i] and not run.channels[i].endswith(ends)]
    gusts = [i for i in moving if run.channels[i] == "gust_m_s"]
    return [*first[:2], *controls[-1:], *gusts[:1]]
