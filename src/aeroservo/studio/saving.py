"""Saving in the page: the model file and the report, into the chosen folder or to the browser."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

from nicegui import ui

from aeroservo.aircraft.file_errors import ModelFileError
from aeroservo.studio.folder import saved
from aeroservo.studio.pool import Died, Refused
from aeroservo.studio.session import Session


class SaveDialogs:
    """The two dialogs of one tab."""

    def __init__(self, session: Session, told: Callable[[str], None]) -> None:
        self._session, self._told = session, told
        self._task: asyncio.Task[None] | None = None
        self._force = ""
        with ui.dialog() as self._dialog, ui.card().style("width: 460px; max-width: 95vw"):
            self._title = ui.label().classes("ae-name")
            self._folder = ui.label().classes("ae-hint")
            self._name = ui.input("file name").props("dense outlined").style("width: 100%")
            self._name.on_value_change(lambda: self._asking(""))
            self._says = ui.label().classes("ae-error").props("role=alert")
            self._bar = ui.linear_progress(0.0, show_value=False)
            with ui.row():
                self._write = ui.button("Save", on_click=self._save).props("no-caps color=primary")
                self._fetch = ui.button("Download instead", on_click=self._download).props("flat no-caps")
                ui.button("Close", on_click=self.close).props("flat no-caps")
        self._what = "model"

    def model(self) -> None:
        """Ask where the model file is to go."""
        source = self._session.source
        self._ask("model", "Save the model file", f"{source.preset}.toml" if source.preset else source.path.name)

    def report(self) -> None:
        """Ask where the report is to go."""
        self._ask("report", "Save a report of this model", f"{self._session.source.path.stem}.html")

    def close(self) -> None:
        """Close, and stop what is being made."""
        if self._task is not None:
            self._task.cancel()
            self._task = None
        self._dialog.close()

    def _ask(self, what: str, title: str, name: str) -> None:
        self._what = what
        self._title.text = title
        self._folder.text = (
            f"Into the folder {self._session.folder}, and nowhere else. Never over a file without asking."
        )
        self._name.value = name
        self._bar.visible = False
        self._asking("")
        self._dialog.open()

    def _asking(self, name: str, message: str = "") -> None:
        """Ask before a file is replaced."""
        self._force = name
        self._write.text = f"Replace {name}" if name else "Save"
        self._says.text = message
        self._says.visible = bool(message)

    def _save(self) -> None:
        if self._what == "model":
            self._kept(lambda name, force: self._session.save(name, force=force))
        else:
            self._begin(self._keep_report)

    def _download(self) -> None:
        if self._what == "report":
            self._begin(self._send_report)
        elif self._session.findings:
            self._asking("", f"not saved: {self._session.says}")
        else:
            ui.download.content(self._session.text, self._safe_name(".toml"), "application/toml")

    def _kept(self, write: Callable[[str, bool], Any]) -> bool:
        name = (self._name.value or "").strip()
        try:
            path = write(name, self._force == name)
        except FileExistsError:
            self._asking(name, f"{name} exists already.")
        except (ValueError, OSError) as error:
            self._asking("", str(error))
        else:
            self._told(f"wrote {path}")
            self._dialog.close()
            return True
        return False

    def _begin(self, then: Callable[[bytes], None]) -> None:
        if self._session.findings:
            self._asking("", f"no report: {self._session.says}")
            return
        if self._task is not None:
            self._task.cancel()
        self._task = asyncio.get_running_loop().create_task(self._report(then))

    async def _report(self, then: Callable[[bytes], None]) -> None:
        def tell(what: str, part: float) -> None:
            self._bar.value = part
            self._says.visible = True
            self._says.text = what

        self._bar.visible = True
        try:
            then(await self._session.run(self._session.job("report", self._session.air), tell))
        except (Refused, Died, ModelFileError) as error:
            self._asking("", str(error))
        self._bar.visible = False

    def _keep_report(self, content: bytes) -> None:
        folder = self._session.folder
        self._asking(self._force)
        self._kept(lambda name, force: saved(folder, name, ".html", content, force=force))

    def _send_report(self, content: bytes) -> None:
        self._asking("")
        with self._dialog:
            ui.download.content(content, self._safe_name(".html"), "text/html")

    def _safe_name(self, ending: str) -> str:
        """A name for the browser, which has folders of its own."""
        stem = "".join(c if c.isalnum() or c in "-_ ." else "_" for c in (self._name.value or "")).strip(". ")
        return f"{stem.removesuffix(ending) or 'model'}{ending}"
