"""HTTP on loopback: the page, and one websocket for each page that is open, for who has the token and nobody else."""

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

from pacinian.viewing.feed import PageConnection

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from pacinian.viewing.hub import Hub
    from pacinian.viewing.slices import FieldWorker

log = logging.getLogger(__name__)
PAGE = Path(__file__).parent / "page"
LOCAL = "127.0.0.1", "localhost", "::1"  # hosts that a browser on this machine calls us by
CLOSED, FAILED = 1008, 1011  # codes of a websocket's end: not allowed, a mistake of ours
HEADERS = {
    "content-security-policy": "default-src 'self'; object-src 'none'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'",
    "referrer-policy": "no-referrer",  # the token is in the address
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "cache-control": "no-store",
}
UNBUILT = "This installation has no page: with Node.js (npm) there, `pip install` Pacinian again."


def make_app(hub: Hub, fields: FieldWorker, token: str, page: Path = PAGE) -> ASGIApp:
    """The application. token: of those who may open the feed. page: folder of what the browser loads."""

    async def feed(socket: WebSocket) -> None:
        given = socket.query_params.get("token", "")
        if not secrets.compare_digest(given.encode(), token.encode()):
            await socket.close(CLOSED)
            return
        await socket.accept()

        async def send(data: bytes) -> None:
            try:
                await socket.send_bytes(data)
            except RuntimeError as error:  # it has been closed meanwhile
                raise WebSocketDisconnect from error

        await _talk(socket, PageConnection(hub, fields, send))

    async def unbuilt(scope: Scope, receive: Receive, send: Send) -> None:
        await PlainTextResponse(UNBUILT, 503)(scope, receive, send)

    built = (page / "index.html").is_file()
    files: ASGIApp = StaticFiles(directory=page, html=True) if built else unbuilt
    made = Starlette(routes=[WebSocketRoute("/feed", feed), Mount("/", files)])
    return HostGuard(made)


async def _talk(socket: WebSocket, page: PageConnection) -> None:
    """Until the page goes."""
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
        await asyncio.sleep(0.0)  # others' turn, however much this one says


def _gone(error: Exception) -> bool:
    """Whether all that went wrong is that the page is not there any more."""
    if isinstance(error, ExceptionGroup):
        parts: tuple[Exception, ...] = error.exceptions
        return all(map(_gone, parts))
    return isinstance(error, WebSocketDisconnect)


class HostGuard:
    """Lets in who calls us by a name of this machine, and of websockets only those of our own page.

    So no name that resolves to this machine by another's will, and no other site's page, gets to the feed.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """An ASGI application."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if not allowed(Headers(scope=scope)):
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


def allowed(headers: Headers) -> bool:
    """Whether a request is to this machine by its own name, and, if a page makes it, by a page of ours."""
    host, origin = headers.get("host", ""), headers.get("origin")
    try:
        name = urlsplit(f"//{host}").hostname
    except ValueError:
        return False
    return name in LOCAL and origin in (None, f"http://{host}")
