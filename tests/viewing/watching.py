"""Run a viewer in a thread, and connect to it as a page does: by a websocket that sorts messages by type."""

from __future__ import annotations

import asyncio
import contextlib
import queue
import threading
import time
from collections import Counter, deque
from typing import TYPE_CHECKING, Any, Self
from urllib.error import HTTPError
from urllib.parse import urlsplit
from urllib.request import urlopen

import msgpack
from websockets.sync.client import ClientConnection, connect

from pacinian.viewing.run import view

from ..waiting import PATIENCE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

LIMIT = PATIENCE  # ends a test that hangs [s]


@contextlib.contextmanager
def viewer(
    connection: Path | None = None, recording: Path | None = None, folder: Path | None = None
) -> Iterator[str]:
    """Run a viewer; return its address."""
    told: queue.Queue[Any] = queue.Queue()

    async def run() -> None:
        ended = asyncio.Event()

        def ready(url: str) -> None:
            told.put((url, asyncio.get_running_loop(), ended))

        await view(connection, recording, folder=folder, ready=ready, ended=ended)

    def main() -> None:
        try:
            asyncio.run(run())
        except BaseException as error:
            told.put(error)
            raise

    thread = threading.Thread(target=main)
    thread.start()
    found = told.get(timeout=LIMIT)
    assert isinstance(found, tuple), found
    url, loop, ended = found
    with contextlib.suppress(HTTPError), urlopen(url, timeout=LIMIT):
        pass  # its loggers exist now: pytest fails if a thread makes one while a test begins
    try:
        yield url
    finally:
        loop.call_soon_threadsafe(ended.set)
        thread.join(LIMIT)
        assert not thread.is_alive()


class Page:
    """A page. newest: message by type. counts: by type. refusals: except those of `catch_up`. frames: the last ones."""

    def __init__(self, url: str, **options: Any) -> None:
        parts = urlsplit(url)
        opening = connect(
            f"ws://{parts.netloc}/feed?{parts.query}",
            origin=options.pop("origin", f"http://{parts.netloc}"),
            max_size=None,
            compression=None,
            ping_interval=None,
            open_timeout=LIMIT,
            close_timeout=0.2,  # a page that no longer reads waits for this time [s]
            **options,
        )
        with contextlib.ExitStack() as stack:
            self.socket: ClientConnection = stack.enter_context(opening)
            self._stack = stack.pop_all()
        self.newest: dict[str, Any] = {}
        self.counts: Counter[str] = Counter()
        self.objects: dict[str, Any] = {}
        self.refusals: list[dict[str, Any]] = []
        self.frames: deque[dict[str, Any]] = deque(maxlen=10)
        self._answers = 0

    def say(self, kind: str, **fields: Any) -> None:
        self.socket.send(msgpack.packb({"type": kind, **fields}) or b"")

    def hear(self, timeout: float = 1.0) -> dict[str, Any] | None:
        try:
            data = self.socket.recv(timeout)
        except TimeoutError:
            return None
        message: dict[str, Any] = msgpack.unpackb(data)  # type: ignore[arg-type]
        kind = message["type"]
        if kind == "batch":
            self.say("ready")
        self.counts[kind] += 1
        self.newest[kind] = message
        if kind == "frame":
            self.frames.append(message)
        if kind == "scenery":
            self.objects |= message["objects"]
            self.objects = {n: o for n, o in self.objects.items() if n in message["poses"]}
        if kind in ("slice", "volume", "skin"):
            self.say("seen", id=message["id"])
        if kind == "refused" and message["action"] == "replay":
            self._answers += 1
        elif kind == "refused":
            self.refusals.append(message)
        return message

    def until(self, what: Callable[[], object]) -> None:
        """Receive messages until a condition is true."""
        end = time.monotonic() + LIMIT
        while not what():
            assert time.monotonic() < end, (self.counts, self.newest.get("state"))
            self.hear(0.1)

    def next(self, kind: str) -> dict[str, Any]:
        """Return the next message of a type."""
        before = self.counts[kind]
        self.until(lambda: self.counts[kind] > before)
        return dict(self.newest[kind])

    @property
    def output(self) -> str:
        """The output by the newest state; "" before the first."""
        return str(self.newest.get("state", {}).get("output", ""))

    def catch_up(self) -> None:
        """Wait until the viewer has handled all messages sent so far. Its replies have then arrived."""
        before = self._answers
        self.say("replay")  # a viewer of a server refuses it at once
        self.until(lambda: self._answers > before)

    def __enter__(self) -> Self:
        return self

    def close(self) -> None:
        self._stack.close()

    def __exit__(self, *_: object) -> None:
        self.close()
