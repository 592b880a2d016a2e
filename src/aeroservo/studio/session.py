"""What one browser tab knows: the model it edits, what was computed of it, what is being computed."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from aeroservo.aircraft.file_errors import ModelFileError, dotted
from aeroservo.studio.analysis import Air, Analysis
from aeroservo.studio.draft import Draft, Finding, Source, changes, checked, opened
from aeroservo.studio.folder import saved
from aeroservo.studio.layout import text_of
from aeroservo.studio.pool import Died, Pool, Refused
from aeroservo.studio.worker import Job

State = Literal["computing", "done", "wrong", "refused", "died", "cancelled"]


class Session:
    """One tab; `notify` hears that something is new."""

    def __init__(self, folder: Path, pool: Pool, notify: Callable[[], None]) -> None:
        self.folder, self._pool, self._notify = folder, pool, notify
        self.source: Source
        self.draft: Draft = {}
        self.findings: tuple[Finding, ...] = ()
        self.air = Air()
        self.before: Analysis | None = None
        self.now: Analysis | None = None
        self.state: State = "computing"
        self.says, self.part = "", 0.0
        self._task: asyncio.Task[None] | None = None

    def open(self, name: str) -> None:
        """Take a model of the folder, or a preset; raises `ModelFileError` and stays as it was where it is refused."""
        self.source = opened(name, self.folder)
        self.draft = self.source.draft
        self.before = self.now = None
        self.findings = ()
        self.recompute()

    def edit(self, draft: Draft) -> None:
        """Take a new draft; compute it if it is a model file."""
        self.draft = draft
        self.findings = checked(draft, self.source)
        if self.findings:
            self._stop()
            first = self.findings[0]
            more = len(self.findings) - 1
            self.state = "wrong"
            place = dotted(first.place)
            self.says = f"{place}{': ' * bool(place)}{first.message}{f' (and {more} more)' if more else ''}"
            self._notify()
        else:
            self.recompute()

    def analysed(self, air: Air) -> None:
        """Analyse at another place or in another way."""
        self.air, self.before = air, None
        if not self.findings:
            self.recompute()

    def recompute(self) -> None:
        """Compute the draft, and the file it came from where that is not known yet."""
        self._stop()
        self.state, self.says, self.part = "computing", "", 0.0
        self._task = asyncio.get_running_loop().create_task(self._compute())
        self._notify()

    def cancel(self) -> None:
        """Stop computing."""
        if self._stop():
            self.state, self.says = "cancelled", "cancelled: the numbers shown are older than the form"
            self._notify()

    @property
    def changed(self) -> tuple[str, ...]:
        """Fields that differ from the file."""
        return changes(self.source.draft, self.draft)

    @property
    def text(self) -> str:
        """The model file as it would be saved."""
        return text_of(self.draft, self.source)

    def job(self, what: Literal["analyse", "fly", "report"], options: Any, text: str | None = None) -> Job:
        """A job on the draft."""
        return Job(what=what, text=self.text if text is None else text, path=self.source.path, options=options)

    async def run(self, job: Job, tell: Callable[[str, float], None]) -> Any:
        """The result of a job."""
        return await self._pool.run(job, tell)

    def save(self, name: str, *, force: bool) -> Path:
        """Write the model file into the folder; it is what changes are measured against from then on.

        Parameters
        ----------
        name : str
            File name.
        force : bool
            Replace an existing file.

        Returns
        -------
        path : Path
            The file written.

        Raises
        ------
        FileExistsError
            If it exists and `force` is not set.
        ModelFileError
            If the draft is no model file, or the name is not allowed.
        """
        if self.findings:
            raise ModelFileError(f"not saved: {self.says}")
        path = saved(self.folder, name, ".toml", self.text.encode(), force=force)
        self.source = opened(name, self.folder)
        self.draft = self.source.draft
        self.before = None
        self.recompute()
        return path

    def close(self) -> None:
        """Stop everything."""
        self._stop()

    def _stop(self) -> bool:
        running = self._task is not None and not self._task.done()
        if running and self._task is not None:
            self._task.cancel()
        self._task = None
        return running

    def _tell(self, what: str, part: float) -> None:
        self.says, self.part = what, part
        self._notify()

    async def _compute(self) -> None:
        """The file first where it is not known, then the draft."""
        with contextlib.suppress(asyncio.CancelledError):
            try:
                if self.before is None:
                    await self._file()
                if self.draft == self.source.draft:
                    self.now = self.before if self.before is not None else self.now
                    if self.before is None:
                        await self._edited()
                else:
                    await self._edited()
                self.state, self.says, self.part = "done", "", 1.0
            except Refused as error:
                self.state, self.says = "refused", str(error).removeprefix(f"{self.source.path}: ")
            except Died as error:
                self.state, self.says = "died", f"{error}; the studio goes on: edit, or compute again"
            self._notify()

    async def _file(self) -> None:
        """What the file gives; where it is refused the draft may still be right."""

        def partial(result: Analysis) -> None:
            if self.draft == self.source.draft:
                self._first(result)

        text = self.source.text
        try:
            self.before = await self._pool.run(self.job("analyse", self.air, text), self._tell, partial)
        except Refused:
            if self.draft == self.source.draft:
                raise

    async def _edited(self) -> None:
        self.now = await self._pool.run(self.job("analyse", self.air), self._tell, self._first)

    def _first(self, result: Analysis) -> None:
        """Speeds that are known before the curves: the curves shown meanwhile are those before."""
        old = self.now
        self.now = replace(result, curves=old.curves, scene=old.scene) if old is not None else result
        self._notify()
