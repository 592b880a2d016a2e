"""The process that computes for the studio: `python -m aeroservo.studio.worker`, fed by `pool` through its pipes.

A message is its length in eight bytes and a pickle; both ends are this program, and nobody else holds the pipes. A
thread reads, so that a cancellation is heard while something is computed, and so that the process ends at once when
the studio that it belongs to is gone.
"""

from __future__ import annotations

import os
import pickle
import struct
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import Any, BinaryIO, Literal

HEADER = struct.Struct(">Q")
"""Length of the pickle that follows."""


@dataclass(frozen=True, kw_only=True)
class Job:
    """Something to compute.

    Attributes
    ----------
    what : {"analyse", "fly", "report"}
        Which computation.
    text : str
        Model file.
    path : Path
        Where it lies, or would lie.
    options : Air or Flight
        Of that computation.
    """

    what: Literal["analyse", "fly", "report"]
    text: str
    path: Path
    options: Any


class Cancelled(Exception):
    """The user no longer wants the result."""


def compute(job: Job, tell: Callable[[str, float], None], partial: Callable[[Any], None]) -> Any:
    """Do a job.

    Parameters
    ----------
    job : Job
        What.
    tell : callable
        Hears of progress: what comes next, part done. [-]
    partial : callable
        Gets what is known before the end.

    Returns
    -------
    result : Analysis, Run or bytes
        By the kind of job.

    Raises
    ------
    ValueError
        If the input is refused.

    References
    ----------
    Project convention: contract.md, `studio`.

    Examples
    --------
    >>> from aeroservo.studio.analysis import Air
    >>> from aeroservo.studio.draft import opened
    >>> source = opened("bact", Path("."))
    >>> job = Job(what="analyse", text=source.text, path=source.path, options=Air())
    >>> compute(job, lambda what, part: None, lambda result: None).speeds[0].name
    'Flutter'
    """
    if job.what == "analyse":
        from aeroservo.studio.analysis import analyse

        return analyse(job.text, job.path, job.options, tell, partial)
    if job.what == "fly":
        from aeroservo.studio.flight import fly

        return fly(job.text, job.path, job.options, tell, partial)
    from aeroservo.studio.document import document

    return document(job.text, job.path, job.options, tell, partial)


def serve(source: BinaryIO, sink: BinaryIO, *, fly: bool = False) -> None:
    """Do the jobs that come in, one after the other, until the other end closes.

    Parameters
    ----------
    source, sink : binary file
        Where messages come from and go to.
    fly : bool
        Make ready for flights too, which takes long where the engine is not compiled yet.

    References
    ----------
    Project convention: module docstring.

    Examples
    --------
    >>> import io
    >>> out = io.BytesIO()
    >>> serve(io.BytesIO(), out)
    >>> pickle.loads(out.getvalue()[HEADER.size :])
    ('ready',)
    """
    jobs: SimpleQueue[tuple[int, Job] | None] = SimpleQueue()
    unwanted: set[int] = set()
    lock = threading.Lock()

    def send(*message: Any) -> None:
        content = pickle.dumps(message)
        with lock:
            sink.write(HEADER.pack(len(content)) + content)
            sink.flush()

    threading.Thread(target=_listen, args=(source, jobs, unwanted), daemon=True).start()
    _warm(fly)
    send("ready")
    while (item := jobs.get()) is not None:
        number, job = item

        def tell(what: str, part: float, number: int = number) -> None:
            if number in unwanted:
                raise Cancelled
            send("progress", number, what, part)

        def partial(result: Any, number: int = number) -> None:
            send("partial", number, result)

        try:
            send("done", number, compute(job, tell, partial))
        except Cancelled:
            send("cancelled", number)
        except ValueError as error:
            internal = type(error).__module__.startswith("numpy")  # LinAlgError is a ValueError, but not the user's
            send("failed" if internal else "refused", number, str(error))
        except MemoryError:
            send("failed", number, "not enough memory")
        except Exception as error:
            send("failed", number, f"{type(error).__name__}: {error}")


def _listen(source: BinaryIO, jobs: SimpleQueue[tuple[int, Job] | None], unwanted: set[int]) -> None:
    """Read messages; when the studio is gone, end."""
    while len(header := source.read(HEADER.size)) == HEADER.size:
        what, number, *rest = pickle.loads(source.read(HEADER.unpack(header)[0]))
        if what == "cancel":
            unwanted.add(number)
        else:
            jobs.put((number, rest[0]))
    jobs.put(None)
    if source is _pipe:
        os._exit(0)  # whatever is being computed: nobody will hear of it


_pipe: BinaryIO | None = None


def _warm(fly: bool) -> None:
    """Load what the first job would wait for; compile what is not compiled yet."""
    from aeroservo.studio.analysis import Air
    from aeroservo.studio.draft import opened
    from aeroservo.studio.flight import Flight

    source = opened("thesis-simulation", Path("."))
    options: dict[Any, Any] = {"analyse": Air()} | ({"fly": Flight(speed=20.0, duration=0.1)} if fly else {})
    for what, option in options.items():
        job = Job(what=what, text=source.text, path=source.path, options=option)
        compute(job, lambda *_: None, lambda *_: None)


def main() -> None:
    """Serve on the process' own pipes; anything that prints goes to stderr."""
    global _pipe
    sink = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    _pipe = sys.stdin.buffer
    serve(_pipe, sink, fly=sys.argv[1:] == ["fly"])


if __name__ == "__main__":
    main()
