"""Many runs: over seeds and over variants of a model, on any executor, interruptible and resumable."""

from __future__ import annotations

import io
import json
import os
import pickle
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass, replace
from hashlib import sha256
from multiprocessing.context import SpawnContext, SpawnProcess
from pathlib import Path
from typing import Any

import numpy as np

from aeroservo.datatypes import AeroelasticModel, Array, LinearSystem, frozen
from aeroservo.simulate.engine import run_prepared
from aeroservo.simulate.prepare import prepare
from aeroservo.simulate.scenario import Scenario, Stepping

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True, kw_only=True, eq=False)
class Variant:
    """One model and what happens to it.

    Attributes
    ----------
    name : str
        What to call it; names of variants differ.
    model : AeroelasticModel, LinearSystem or callable
        What is simulated; a callable without arguments makes the model in the process that runs it.
    scenario : Scenario
        What happens.
    """

    name: str
    model: AeroelasticModel | LinearSystem | Callable[[], AeroelasticModel]
    scenario: Scenario


@dataclass(frozen=True, kw_only=True, eq=False)
class Ensemble:
    """Statistics of many runs; rows that were not computed are nan and not `done`.

    Attributes
    ----------
    variants : tuple of str
        Names of the variants.
    channels : tuple of str
        Names of the channels.
    peak, rms : ndarray, shape (n_variant, n_run, n_channel)
        Of each run. [unit of each channel]
    duration : ndarray, shape (n_variant, n_run)
        Time until the end, or until a limit was left or numbers ran away. [s]
    survived : bool ndarray, shape (n_variant, n_run)
        Whether the run reached its end. [-]
    done : bool ndarray, shape (n_variant, n_run)
        Whether it was computed. [-]
    """

    variants: tuple[str, ...]
    channels: tuple[str, ...]
    peak: Array
    rms: Array
    duration: Array
    survived: Array
    done: Array

    def __post_init__(self) -> None:
        """Lock the arrays (nan stands for a run that was not computed)."""
        for name in ("peak", "rms", "duration"):
            array = np.array(getattr(self, name), dtype=float)
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        for name in ("survived", "done"):
            object.__setattr__(self, name, frozen(getattr(self, name), dtype=bool, name=name))


def run_seeds(seed: int, variant: int, runs: Sequence[int]) -> list[int]:
    """Seeds of runs: of the ensemble's seed, the variant's number and the run's number alone.

    Parameters
    ----------
    seed : int
        Of the ensemble.
    variant : int
        Number of the variant.
    runs : sequence of int
        Numbers of the runs.

    Returns
    -------
    seeds : list of int
        128 bits each; the same whatever the number of workers or the order of work.
    """
    words = (np.random.SeedSequence(seed, spawn_key=(variant, run)).generate_state(4) for run in runs)
    return [int.from_bytes(np.asarray(w, dtype="<u4").tobytes(), "little") for w in words]


def ensemble(
    variants: Sequence[Variant],
    *,
    runs: int,
    seed: int = 0,
    stepping: Stepping = Stepping(history=False),  # noqa: B008 - frozen
    executor: Executor | None = None,
    batch: int = 100,
    journal: str | Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Ensemble:
    """Run every variant `runs` times.

    A batch of runs is one task: it prepares its variant once. On Ctrl-C (KeyboardInterrupt) tasks that have not begun
    are cancelled; what is done is in the journal and returned, with `done` false for the rest; with the same journal
    the next call goes on.

    Parameters
    ----------
    variants : sequence of Variant
        Models and scenarios.
    runs : int
        Of each variant.
    seed : int
        Of the ensemble.
    stepping : Stepping
        How; no history is kept.
    executor : Executor, optional
        Any of the `concurrent.futures` interface; without one the runs are made here.
    batch : int
        Runs in a task: make it seconds of work.
    journal : str or Path, optional
        File of finished tasks, one JSON object a line, appended as they finish.
    progress : callable, optional
        Called with runs done and runs in all.

    Returns
    -------
    ensemble : Ensemble
        Statistics. [unit of each channel]

    Raises
    ------
    ValueError
        If there is nothing to run, names are twice there, or the journal belongs to another ensemble.
    """
    if not variants or runs < 1 or batch < 1:
        raise ValueError(f"give one or more variants, runs and a batch of at least 1, got {runs} and {batch}")
    names = [v.name for v in variants]
    if len(set(names)) != len(names):
        raise ValueError(f"names of variants must differ, got {names}")
    stepping = replace(stepping, history=False)
    head = {"seed": seed, "runs": runs, "batch": batch, "variants": names, "is": _mark(variants, stepping)}
    book = _Journal(journal, head)
    tasks = [(v, first) for v in range(len(variants)) for first in range(0, runs, batch)]
    finished = dict(book.read())
    left = [task for task in tasks if task not in finished]

    def arguments(task: tuple[int, int]) -> tuple[Variant, list[int], Stepping]:
        v, first = task
        return variants[v], run_seeds(seed, v, range(first, min(first + batch, runs))), stepping

    try:
        for task, found in _results(left, arguments, executor):
            finished[task] = found
            book.write(task, found)
            if progress is not None:
                progress(sum(len(f["duration"]) for f in finished.values()), runs * len(variants))
    except KeyboardInterrupt:
        if not finished:
            raise
    return _collected(names, runs, finished)


def local_pool(workers: int | None = None) -> ProcessPoolExecutor:
    """A pool of processes on this machine, started afresh (not forked: threads and compiled code stay whole).

    Each keeps to one thread of linear algebra, unless the environment says otherwise: the runs are what goes side by
    side.

    Parameters
    ----------
    workers : int, optional
        Processes, by default one for each core.

    Returns
    -------
    pool : ProcessPoolExecutor
        To be used with `with`.
    """
    return ProcessPoolExecutor(
        max_workers=workers or os.cpu_count(), mp_context=_OneThread(), initializer=_leave_interrupts
    )


def _leave_interrupts() -> None:
    """Ctrl-C is for the process that asked: workers end their task and are told to stop."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


class _Alone(SpawnProcess):
    """A process whose libraries of linear algebra start one thread."""

    def start(self) -> None:
        """Start with the environment that those libraries read when they are loaded."""
        own = {name: "1" for name in _THREADS if name not in os.environ}
        os.environ.update(own)
        try:
            super().start()
        finally:
            for name in own:
                os.environ.pop(name, None)


class _OneThread(SpawnContext):
    """Spawned processes of one thread each."""

    Process = _Alone


def run_batch(variant: Variant, seeds: list[int], stepping: Stepping) -> dict[str, Any]:
    """One task: runs of one variant. It may run in another process.

    Parameters
    ----------
    variant : Variant
        Model and scenario.
    seeds : list of int
        One run each.
    stepping : Stepping
        How.

    Returns
    -------
    found : dict
        channels, and lists of peak, rms, duration, survived: what JSON takes.
    """
    model = variant.model() if callable(variant.model) else variant.model
    prepared = prepare(model, variant.scenario, stepping)
    found = [run_prepared(prepared, seed=seed) for seed in seeds]
    return {
        "channels": list(found[0].channels),
        "peak": [f.peak.tolist() for f in found],
        "rms": [f.rms.tolist() for f in found],
        "duration": [f.duration for f in found],
        "survived": [f.limit_left is None and f.overflow_at is None for f in found],
    }


def _results(left: list[tuple[int, int]], arguments: Any, executor: Executor | None) -> Iterator[tuple[Any, Any]]:
    """Results as they come; on an interrupt what has not begun is cancelled."""
    if executor is None:
        for task in left:
            yield task, run_batch(*arguments(task))
        return
    futures: dict[Future[Any], tuple[int, int]] = {executor.submit(run_batch, *arguments(task)): task for task in left}
    try:
        waiting = set(futures)
        while waiting:
            ready, waiting = wait(waiting, timeout=0.5, return_when=FIRST_COMPLETED)
            for future in ready:
                yield futures[future], future.result()
    finally:
        for future in futures:
            future.cancel()


def _collected(names: list[str], runs: int, finished: dict[tuple[int, int], dict[str, Any]]) -> Ensemble:
    """Arrays from the tasks that are there."""
    channels: list[str] = next((f["channels"] for f in finished.values()), [])
    shape = (len(names), runs)
    peak, rms = np.full((*shape, len(channels)), np.nan), np.full((*shape, len(channels)), np.nan)
    duration, survived, done = np.full(shape, np.nan), np.zeros(shape, bool), np.zeros(shape, bool)
    for (v, first), found in finished.items():
        if found["channels"] != channels:
            raise ValueError(f"variants must have the same channels, got {channels} and {found['channels']}")
        here = (v, slice(first, first + len(found["duration"])))
        peak[here], rms[here] = found["peak"], found["rms"]
        duration[here], survived[here], done[here] = found["duration"], found["survived"], True
    return Ensemble(
        variants=tuple(names),
        channels=tuple(channels),
        peak=peak,
        rms=rms,
        duration=duration,
        survived=survived,
        done=done,
    )


def _mark(variants: Sequence[Variant], stepping: Stepping) -> str:
    """Fingerprint of the models and scenarios: a journal of others is not taken up."""
    content = io.BytesIO()
    _Fields(content, protocol=4).dump((list(variants), stepping))
    return sha256(content.getvalue()).hexdigest()[:16]


class _Fields(pickle.Pickler):
    """Model files by their fields in order: pydantic adds a set of names, whose order differs in each process."""

    def reducer_override(self, value: Any) -> Any:
        """What stands for a value."""
        if isinstance(value, type) or not hasattr(value, "model_dump"):
            return NotImplemented
        return tuple, ((type(value).__qualname__, value.model_dump()),)


class _Journal:
    """Finished tasks on disk, one line each, flushed when they finish; a torn last line is left out."""

    def __init__(self, path: str | Path | None, head: dict[str, Any]) -> None:
        self.path, self.head = None if path is None else Path(path), head

    def read(self) -> Iterator[tuple[tuple[int, int], dict[str, Any]]]:
        """Tasks that are there."""
        if self.path is None or not self.path.exists() or not self.path.stat().st_size:
            return
        lines = self.path.read_text(encoding="utf-8").splitlines()
        try:
            head = json.loads(lines[0])
        except ValueError:
            head = None
        if head != self.head:
            raise ValueError(f"{self.path}: is the journal of another ensemble: take another name, or remove it")
        for line in lines[1:]:
            try:
                entry = json.loads(line)
            except ValueError:
                continue
            yield tuple(entry["task"]), entry["found"]

    def write(self, task: tuple[int, int], found: dict[str, Any]) -> None:
        """Append a task."""
        if self.path is None:
            return
        new = not self.path.exists() or not self.path.stat().st_size
        torn = not new and not self.path.read_bytes().endswith(b"\n")
        with open(self.path, "a", encoding="utf-8") as file:
            if new:
                file.write(json.dumps(self.head) + "\n")
            if torn:
                file.write("\n")
            file.write(json.dumps({"task": task, "found": found}) + "\n")
            file.flush()
            os.fsync(file.fileno())
