"""Warm processes that compute for the studio, so that a computation can be cancelled and may crash."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Callable
from typing import Any

from aeroservo.studio.worker import HEADER, Job

#: Processes at the start, how many more than are used are kept ready, and the most there may be.
FIRST, READY, MOST = 2, 1, 4
#: Time that a cancelled computation has to stop by itself. [s]
GRACE = 2.0


class Refused(ValueError):
    """The input of a job is wrong; the message is for the user."""


class Died(RuntimeError):
    """The process that computed is gone."""


class Worker:
    """One process and what it says."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self.process = process

    @classmethod
    async def started(cls, *, fly: bool) -> Worker:
        """Start a process and wait until it is ready.

        Parameters
        ----------
        fly : bool
            Whether it is made ready for flights too.

        Returns
        -------
        worker : Worker
            That has said so.

        Raises
        ------
        Died
            Where it ends instead.
        """
        single = {name: os.environ.get(name, "1") for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
        apart: dict[str, Any] = (
            {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}  # type: ignore[attr-defined]
            if sys.platform == "win32"
            else {"start_new_session": True}
        )  # Ctrl-C is for the studio, which closes the pipes
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "aeroservo.studio.worker", *(["fly"] * fly)),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, **single},
            **apart,
        )
        worker = cls(process)
        await anext(worker.messages())
        return worker

    @property
    def alive(self) -> bool:
        """Whether the process runs."""
        return self.process.returncode is None

    def send(self, *message: Any) -> None:
        """Say something; a process that is gone does not hear it."""
        assert self.process.stdin is not None
        content = pickle.dumps(message)
        with contextlib.suppress(OSError, RuntimeError):
            self.process.stdin.write(HEADER.pack(len(content)) + content)

    async def messages(self) -> AsyncIterator[tuple[Any, ...]]:
        """What it says, until it is gone.

        Returns
        -------
        messages : async iterator of tuple
            What happened, the number of the job, and what belongs to it.

        Raises
        ------
        Died
            When the process has ended.
        """
        assert self.process.stdout is not None
        while True:
            try:
                header = await self.process.stdout.readexactly(HEADER.size)
                yield pickle.loads(await self.process.stdout.readexactly(HEADER.unpack(header)[0]))
            except asyncio.IncompleteReadError:
                code = await self.process.wait()
                raise Died(_how(code)) from None

    async def end(self) -> None:
        """Close its pipe, which ends it; kill it where that does not help."""
        assert self.process.stdin is not None
        with contextlib.suppress(OSError, RuntimeError):
            self.process.stdin.close()
        try:
            await asyncio.wait_for(self.process.wait(), 1.0)
        except TimeoutError:
            with contextlib.suppress(ProcessLookupError):
                self.process.kill()
            await self.process.wait()


class Pool:
    """Processes, and who may use them next."""

    def __init__(self) -> None:
        self.every: set[Worker] = set()
        self._idle: list[Worker] = []
        self._starting = 0
        self._free = asyncio.Condition()
        self._tasks: set[asyncio.Task[Any]] = set()
        self._numbers = itertools.count(1)
        self._closed = False

    def start(self) -> None:
        """Begin to start the processes that are kept ready, one after the other."""
        self._later(self._fill(FIRST))

    async def run(
        self, job: Job, tell: Callable[[str, float], None], partial: Callable[[Any], None] | None = None
    ) -> Any:
        """The result of a job; cancel the task that waits for it to cancel the job.

        Parameters
        ----------
        job : Job
            What.
        tell : callable
            Hears of progress.
        partial : callable, optional
            Gets what is known before the end.

        Returns
        -------
        result : any
            By the kind of job.

        Raises
        ------
        Refused
            If the input is wrong.
        Died
            If the computation crashed, or its process was killed.
        """
        worker = await self._taken(tell)
        number = next(self._numbers)
        worker.send("run", number, job)
        try:
            async for what, about, *rest in worker.messages():
                if about != number:
                    continue
                if what == "progress":
                    tell(*rest)
                elif what == "partial" and partial is not None:
                    partial(*rest)
                elif what in ("done", "refused", "failed"):
                    self._give_back(worker)
                    if what == "done":
                        return rest[0]
                    raise Refused(rest[0]) if what == "refused" else Died(f"the computation failed: {rest[0]}")
        except asyncio.CancelledError:
            worker.send("cancel", number)
            self._later(self._reclaim(worker, number))
            raise
        except Died:
            if not worker.alive:
                self._forget(worker)
            raise
        raise Died("the computation ended without a result")

    async def close(self) -> None:
        """End every process."""
        self._closed = True
        for task in list(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        await asyncio.gather(*(worker.end() for worker in self.every), return_exceptions=True)
        self.every.clear()

    async def _taken(self, tell: Callable[[str, float], None]) -> Worker:
        """A process of one's own; where all are busy, the next that is free."""
        while True:
            async with self._free:
                while self._idle:
                    worker = self._idle.pop()
                    if worker.alive:
                        self._later(self._fill())
                        return worker
                    self.every.discard(worker)
                self._later(self._fill())
                busy = len(self.every) + self._starting >= MOST
                tell("waiting for a free process" if busy else "starting a process", 0.0)
                await self._free.wait()

    async def _fill(self, ready: int = READY) -> None:
        """Start processes until enough are ready, or there may be no more."""
        while not self._closed:
            self.every = {worker for worker in self.every if worker.alive}
            self._idle = [worker for worker in self._idle if worker.alive]
            if len(self._idle) + self._starting >= ready or len(self.every) + self._starting >= MOST:
                return
            self._starting += 1
            try:
                worker = await Worker.started(fly=bool(self.every))
            except Died:
                await asyncio.sleep(1.0)  # a machine that cannot start processes is not asked to at full speed
                continue
            finally:
                self._starting -= 1
            self.every.add(worker)
            self._give_back(worker)

    async def _reclaim(self, worker: Worker, number: int) -> None:
        """Wait for a cancelled computation to stop; kill it where it does not."""

        async def stopped() -> None:
            async for what, about, *_ in worker.messages():
                if about == number and what in ("done", "refused", "failed", "cancelled"):
                    return

        try:
            await asyncio.wait_for(stopped(), GRACE)
        except (TimeoutError, Died):
            if worker.alive:
                worker.process.kill()
                await worker.process.wait()
            self._forget(worker)
        else:
            self._give_back(worker)

    def _give_back(self, worker: Worker) -> None:
        if worker.alive and not self._closed:
            self._idle.append(worker)
        self._later(self._announce())

    def _forget(self, worker: Worker) -> None:
        self.every.discard(worker)
        self._later(self._fill())

    async def _announce(self) -> None:
        async with self._free:
            self._free.notify()

    def _later(self, work: Any) -> None:
        if self._closed:
            work.close()
            return
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)


def _how(code: int) -> str:
    """How a process ended, in words."""
    if code < 0:
        with contextlib.suppress(ValueError):
            return f"the computing process was killed by {signal.Signals(-code).name}"
    return f"the computing process ended with code {code}"
