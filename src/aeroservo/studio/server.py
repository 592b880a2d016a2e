"""Start and stop the studio: one address on 127.0.0.1, one page for each browser tab, processes that compute."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import socket
import threading
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aeroservo.studio.guard import HOSTS, Guard


@dataclass(frozen=True, kw_only=True)
class Choice:
    """What the studio is started with.

    Attributes
    ----------
    folder : Path
        The one folder that it reads models from and writes to.
    model : str
        Preset or name of a file in the folder, opened first.
    port : int
        Of the address; 0 takes a free one.
    """

    folder: Path
    model: str = "thesis-binary"
    port: int = 0


class Studio:
    """A studio that runs until it is stopped; `url` is known once it is bound."""

    def __init__(self, choice: Choice) -> None:
        os.environ.setdefault("NICEGUI_STORAGE_PATH", os.devnull)  # nothing is stored
        self._socket = _bound(choice.port)
        self.port = int(self._socket.getsockname()[1])
        self._choice = choice
        self._server: Any = None
        self.pools: list[Any] = []

    @property
    def url(self) -> str:
        """The address to open."""
        return f"http://{HOSTS[0]}:{self.port}/"

    def serve(self, started: Callable[[], None] | None = None) -> None:
        """Serve until stopped; `started` is called once pages are answered."""
        import uvicorn

        logging.getLogger("uvicorn.error").setLevel(logging.ERROR)
        application = _application(self._choice, self.pools, started)
        config = uvicorn.Config(
            Guard(application, self.port), log_level="error", access_log=False, timeout_graceful_shutdown=1,
            ws_max_size=4_000_000, server_header=False, lifespan="on",
        )  # fmt: skip
        self._server = uvicorn.Server(config)
        with contextlib.suppress(KeyboardInterrupt), warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            self._server.run(sockets=[self._socket])

    def stop(self) -> None:
        """Stop serving."""
        if self._server is not None:
            self._server.should_exit = True


def _bound(port: int) -> socket.socket:
    """A socket on 127.0.0.1, or an error that says why not."""
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    if os.name == "posix":
        found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind((HOSTS[0], port))
    except (OSError, OverflowError) as error:
        found.close()
        reason = getattr(error, "strerror", None) or error
        raise ValueError(f"--port {port}: cannot listen there: {reason}; leave it out for a free one") from None
    return found


def _application(choice: Choice, pools: list[Any], started: Callable[[], None] | None) -> Any:
    """The web application with its page and its processes."""
    from fastapi import FastAPI
    from nicegui import app, ui

    from aeroservo.studio.page import page
    from aeroservo.studio.pool import Pool
    from aeroservo.studio.wing import serve_scripts

    serve_scripts()
    application = FastAPI(openapi_url=None, docs_url=None, redoc_url=None)

    async def begin() -> None:
        pools.append(Pool())
        pools[0].start()
        if started is not None:
            threading.Thread(target=started, daemon=True).start()

    async def end() -> None:
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(pools[0].close(), 5.0)

    app.on_startup(begin)
    app.on_shutdown(end)

    @ui.page("/", title="aeroservo studio", response_timeout=30)
    async def _page() -> None:
        await page(choice, pools[0])

    ui.run_with(
        application, title="aeroservo studio", show_welcome_message=False, dark=None, reconnect_timeout=10.0,
        tailwind=False, favicon=_ICON,
    )  # fmt: skip
    return application


_ICON = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32"><rect width="32" height="32" rx="6" fill="#0072B2"/>'
    '<path d="M3 20 16 8l13 12-13-5z" fill="#fff"/></svg>'
)
