"""HTTP on loopback: serves the page, and a websocket to each open page that has the token."""

from __future__ import annotations

import asyncio
import logging
import secrets
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from pacinian.errors import MissingExtra

try:
    from starlette.applications import Starlette
    from starlette.datastructures import Headers, MutableHeaders
    from starlette.responses import PlainTextResponse
    from starlette.routing import Mount, WebSocketRoute
    from starlette.staticfiles import StaticFiles
    from starlette.websockets import WebSocket, WebSocketDisconnect
except ImportError as error:
    raise MissingExtra("starlette", "view") from error

from pacinian.viewing.page_connection import PageConnection

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from pacinian.viewing.hub import Hub
    from pacinian.viewing.slices import FieldWorker

log = logging.getLogger(__name__)
PAGE = Path(__file__).parent / "page"  # folder of the files that the browser loads
LOCAL = "127.0.0.1", "localhost", "::1"  # names of this host that a browser on this machine uses
CLOSED, FAILED = 1008, 1011  # websocket close codes: policy violation, internal error
HEADERS = {
    "content-security-policy": "default-src 'self'; object-src 'none'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'",
    "referrer-policy": "no-referrer",  # the address contains the token
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "cache-control": "no-store",
}
UNBUILT = "This installation has no page: with Node.js (npm) there, `pip install` Pacinian again."


def make_app(hub: Hub, fields: FieldWorker, token: str) -> ASGIApp:
    """Make the application. token: opens the feed."""

    async def feed(socket: WebSocket) -> None:
        given = socket.query_params.get("token", "")
        if not secrets.compare_digest(given.encode(), token.encode()):
            await socket.close(CLOSED)
            return
        await socket.accept()

        async def send(data: bytes) -> None:
            try:
                await socket.send_bytes(data)
            except RuntimeError as error:  # it was closed in the meantime
                raise WebSocketDisconnect from error

        await _talk(socket, PageConnection(hub, fields, send))

    async def unbuilt(scope: Scope, receive: Receive, send: Send) -> None:
        await PlainTextResponse(UNBUILT, 503)(scope, receive, send)

    built = (PAGE / "index.html").is_file()
    files: ASGIApp = StaticFiles(directory=PAGE, html=True) if built else unbuilt
    made = Starlette(routes=[WebSocketRoute("/feed", feed), Mount("/", files)])
    return HostGuard(made)


async def _talk(socket: WebSocket, page: PageConnection) -> None:
    """Serve a page until it disconnects."""
    tasks = [asyncio.create_task(page.run()), asyncio.create_task(_listen(socket, page))]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        page.close()
        for task in tasks:
            task.cancel()
        ends = await asyncio.gather(*tasks, return_exceptions=True)
    for error in ends:
        if isinstance(error, Exception) and not _gone(error):
            log.error("a page has failed", exc_info=error)
            with suppress(WebSocketDisconnect, RuntimeError):
                await socket.close(FAILED)


async def _listen(socket: WebSocket, page: PageConnection) -> None:
    while (message := await socket.receive())["type"] == "websocket.receive":
        page.hear(message.get("bytes") or b"")
        await asyncio.sleep(0.0)  # let other tasks run, even if this page floods us


def _gone(error: Exception) -> bool:
    """Whether the error only says that the page has disconnected."""
    if isinstance(error, ExceptionGroup):
        parts: tuple[Exception, ...] = error.exceptions
        return all(map(_gone, parts))
    return isinstance(error, WebSocketDisconnect)


class HostGuard:
    """Admits only requests that name this machine as the host, and whose origin, if they have one, is our own page.

    This keeps DNS rebinding and the pages of other sites away from the feed.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request as an ASGI application."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if not is_allowed(Headers(scope=scope)):
            if scope["type"] == "websocket":
                await WebSocket(scope, receive, send).close(CLOSED)
            else:
                await PlainTextResponse("Not for you.\n", 403)(scope, receive, send)
            return

        async def sent(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(HEADERS)
            await send(message)

        await self._app(scope, receive, sent)


def is_allowed(headers: Headers) -> bool:
    """Whether the host is a name of this machine and the origin, if there is one, is our own page."""
    host, origin = headers.get("host", ""), headers.get("origin")
    try:
        name = urlsplit(f"//{host}").hostname
    except ValueError:
        return False
    return name in LOCAL and origin in (None, f"http://{host}")
