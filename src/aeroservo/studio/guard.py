"""Who may talk to the studio: this machine, by its own name, from a page that the studio itself served."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from typing import Any

#: Names under which a browser on this machine may ask.
HOSTS = ("127.0.0.1", "localhost")

_POLICY = (
    "default-src 'none'; script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:; style-src 'self' 'unsafe-inline'; "
    "font-src 'self' data:; img-src 'self' data: blob:; "
    "connect-src 'self' ws://127.0.0.1:{port} ws://localhost:{port}; "
    "worker-src 'self' blob:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)

Asgi = Callable[[Any, Any, Any], Awaitable[None]]


class Guard:
    """An ASGI application in front of another: refuses foreign hosts and origins, sends a policy with every page."""

    def __init__(self, app: Asgi, port: int) -> None:
        self._app, self._port = app, port

    async def __call__(self, scope: Mapping[str, Any], receive: Any, send: Any) -> None:
        """Pass on what comes from this machine's own page; refuse the rest."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        if not allowed(dict(scope["headers"]), self._port):
            await _refuse(scope, receive, send)
            return

        async def with_policy(message: Any) -> None:
            if message["type"] == "http.response.start":
                extra = [
                    (b"content-security-policy", _POLICY.format(port=self._port).encode()),
                    (b"x-content-type-options", b"nosniff"),
                    (b"referrer-policy", b"no-referrer"),
                    (b"cross-origin-resource-policy", b"same-origin"),
                ]
                message = {**message, "headers": [*message.get("headers", ()), *extra]}
            await send(message)

        await self._app(scope, receive, with_policy)


def allowed(headers: Mapping[bytes, bytes], port: int) -> bool:
    """Whether a request is from this machine's own page.

    Parameters
    ----------
    headers : mapping of bytes to bytes
        Of the request, names in lower case.
    port : int
        That the studio listens at.

    Returns
    -------
    allowed : bool
        The host is 127.0.0.1 or localhost at this port, and the origin, where one is named, is that too.

    References
    ----------
    RFC 6455, section 10.2 (origin); RFC 9110, section 7.2 (host): DNS rebinding leaves the attacker's name in both.

    Examples
    --------
    >>> allowed({b"host": b"127.0.0.1:8080"}, 8080), allowed({b"host": b"evil.example:8080"}, 8080)
    (True, False)
    """
    own = {f"{host}:{port}".encode() for host in HOSTS} | ({h.encode() for h in HOSTS} if port == 80 else set())
    if headers.get(b"host", b"").lower() not in own:
        return False
    origin = headers.get(b"origin")
    return origin is None or origin.lower() in {b"http://" + name for name in own}


async def _refuse(scope: Mapping[str, Any], receive: Any, send: Any) -> None:
    """403, or a websocket that is closed before it opens."""
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 1008})
        return
    body = b"the studio answers pages of this machine only: open the address that it printed\n"
    await send({"type": "http.response.start", "status": 403, "headers": [(b"content-type", b"text/plain")]})
    await send({"type": "http.response.body", "body": body})
