"""A viewer in a thread, and pages that are no browser: a websocket and what came over it, by type."""

from __future__ import annotations

import asyncio
import contextlib
import queue
import threading
import time
from collections import Counter
from typing import TYPE_CHECKING, Any, Self
from urllib.parse import urlsplit

import msgpack
from websockets.sync.client import ClientConnection, connect

from pacinian.viewing.run import view

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

LIMIT = 30.0  # [s]


@contextlib.contextmanager
def viewer(
    connection: Path | None = None, recording: Path | None = None, folder: Path | None = None
) -> Iterator[str]:
    """Its address, while it runs."""
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
    try:
        yield url
    finally:
        loop.call_soon_threadsafe(ended.set)
        thread.join(LIMIT)
        assert not thread.is_alive()


class Page:
    """What a page hears. newest: of each type. counts: by type. All that came last is in `heard`."""

    def __init__(self, url: str, **options: Any) -> None:
        parts = urlsplit(url)
        opening = connect(
            f"ws://{parts.netloc}/feed?{parts.query}",
            origin=options.pop("origin", f"http://{parts.netloc}"),
            max_size=None,
            compression=None,
            ping_interval=None,
            close_timeout=0.2,  # one that does not read on waits for the answer so long
            **options,
        )
        with contextlib.ExitStack() as stack:
            self.socket: ClientConnection = stack.enter_context(opening)
            self._stack = stack.pop_all()
        self.newest: dict[str, Any] = {}
        self.counts: Counter[str] = Counter()
        self.objects: dict[str, Any] = {}
        self.acknowledges = True

    def say(self, kind: str, **fields: Any) -> None:
        self.socket.send(msgpack.packb({"type": kind, **fields}) or b"")

    def hear(self, timeout: float = 1.0) -> dict[str, Any] | None:
        try:
            data = self.socket.recv(timeout)
        except TimeoutError:
            return None
        message: dict[str, Any] = msgpack.unpackb(data)  # type: ignore[arg-type]
        kind = message["type"]
        self.counts[kind] += 1
        self.newest[kind] = message
        if kind == "scenery":
            self.objects |= message["objects"]
            self.objects = {n: o for n, o in self.objects.items() if n in message["poses"]}
        if kind in ("slice", "volume") and self.acknowledges:
            self.say("seen", id=message["id"])
        return message

    def until(self, what: Callable[[], object], limit: float = LIMIT) -> None:
        """Listen until something is so."""
        end = time.monotonic() + limit
        while not what():
            assert time.monotonic() < end, (self.counts, self.newest.get("state"))
            self.hear(0.1)

    def next(self, kind: str, limit: float = LIMIT) -> dict[str, Any]:
        """The next message of a type."""
        before = self.counts[kind]
        self.until(lambda: self.counts[kind] > before, limit)
        return dict(self.newest[kind])

    def listen(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self.hear(min(left, 0.1))

    def __enter__(self) -> Self:
        return self

    def close(self) -> None:
        self._stack.close()

    def __exit__(self, *_: object) -> None:
        self.close()
