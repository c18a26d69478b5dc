"""Runs the viewer, from start to end."""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import secrets
import socket
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from pacinian.client.server_session import read_version
from pacinian.errors import ArgumentError, MissingExtra, ServerError
from pacinian.viewing.app import make_app
from pacinian.viewing.feed_file import SUFFIX, FeedFile, FeedRecorder, FeedWriter
from pacinian.viewing.feed_player import FeedPlayer
from pacinian.viewing.hub import Hub
from pacinian.viewing.messages import MAX_BYTES, Hello
from pacinian.viewing.recording_to_feed import convert_recording
from pacinian.viewing.server_connection import ServerConnection
from pacinian.viewing.slices import FieldWorker

try:
    import uvicorn
except ImportError as error:
    raise MissingExtra("uvicorn", "view") from error

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from starlette.types import ASGIApp


async def view(
    connection: Path | str | None = None,
    recording: Path | None = None,
    *,
    samples: bool = False,
    host: str = "127.0.0.1",
    port: int = 0,
    folder: Path | None = None,
    ready: Callable[[str], object] = lambda url: None,
    ended: asyncio.Event | None = None,
) -> None:
    """Serve the page until `ended`, or Ctrl-C.

    connection: connection file of the server to watch. recording: recording of a viewer or a renderer to play instead.
    samples: also show the samples of a renderer's recording, which takes as long as rendering it. folder: folder for
    new recordings; by default the current one. ready: called with the page's address. Raises ArgumentError,
    ServerError, RecordingError.
    """
    token, hub, fields = secrets.token_urlsafe(32), Hub(), FieldWorker()
    with contextlib.ExitStack() as stack:
        listening = stack.enter_context(bind(host, port))
        stack.callback(fields.close)
        hub.put(
            "hello",
            Hello(viewer=read_version(), recording="" if recording is None else recording.name),
        )
        if recording is None:
            server = ServerConnection(hub, asyncio.get_running_loop(), connection)
            recorder = FeedRecorder(hub, folder or Path())
            server.start()
            stack.callback(server.close)
            stack.callback(recorder.close)
        else:
            recorded = stack.enter_context(open_view(recording, samples=samples))
            playing = asyncio.create_task(FeedPlayer(hub, recorded).run())
            stack.callback(playing.cancel)
        name = f"[{host}]" if ":" in host else host
        ready(f"http://{name}:{listening.getsockname()[1]}/?token={token}")
        await _serve(make_app(hub, fields, token), listening, ended)


async def _serve(made: ASGIApp, listening: socket.socket, ended: asyncio.Event | None) -> None:
    config = uvicorn.Config(
        made,
        log_level="warning",  # `info` would log the address with the token
        access_log=False,
        ws="websockets-sansio",
        ws_max_size=MAX_BYTES,
        ws_per_message_deflate=False,
        lifespan="off",
        server_header=False,
        timeout_graceful_shutdown=1,
    )
    server = uvicorn.Server(config)

    async def end() -> None:
        if ended is not None:
            await ended.wait()
            server.should_exit = True

    ending = asyncio.create_task(end())
    try:
        await server.serve([listening])
    finally:
        ending.cancel()


@contextlib.contextmanager
def open_view(path: Path, *, samples: bool = False) -> Generator[FeedFile]:
    """Open a recording of a viewer or a renderer. samples: include the renderer's. Raises RecordingError."""
    from pacinian.rendering.recording import Recording, is_recording

    with contextlib.ExitStack() as stack:
        if is_recording(path):
            rendered = Recording(path)
            kept = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="pacinian-")))
            with contextlib.closing(FeedWriter(kept / f"feed{SUFFIX}")) as writer:
                for at, kind, data in convert_recording(rendered, samples=samples):
                    writer.write(at, kind, data)
            path = writer.path
        found = FeedFile(path)
        stack.callback(found.close)
        yield found


def bind(host: str, port: int) -> socket.socket:
    """Return a socket that listens on loopback only. Raises ArgumentError, ServerError."""
    address = "127.0.0.1" if host == "localhost" else host
    try:
        if not ipaddress.ip_address(address).is_loopback:
            raise ValueError
    except ValueError:
        problem = f"must be an address of this machine alone, as 127.0.0.1 or ::1, not {host!r}"
        raise ArgumentError("host", f"{problem}; from elsewhere, use a tunnel (ssh -L)") from None
    made = socket.socket(socket.AF_INET6 if ":" in address else socket.AF_INET)
    try:
        made.bind((address, port))
        made.listen()
    except OSError as error:
        made.close()
        raise ServerError(f"{address}:{port} cannot be bound: {error.strerror}") from error
    return made
