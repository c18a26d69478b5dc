"""A viewer in a thread, and pages that are no browser: a websocket and what came over it, by type."""

from __future__ import annotations

import asyncio
import contextlib
import queue
import threading
import time
from collections import Counter, deque
from typing import TYPE_CHECKING, Any, Self
from urllib.parse import urlsplit

import msgpack
from websockets.sync.client import ClientConnection, connect

from pacinian.viewing.run import view

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

LIMIT = 60.0  # [s] ends a test that hangs


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
    """What a page hears. newest: of each type. counts: by type. refusals: but those of `catch_up`. frames: the last."""

    def __init__(self, url: str, **options: Any) -> None:
        parts = urlsplit(url)
        opening = connect(
            f"ws://{parts.netloc}/feed?{parts.query}",
            origin=options.pop("origin", f"http://{parts.netloc}"),
            max_size=None,
            compression=None,
            ping_interval=None,
            open_timeout=LIMIT,
            close_timeout=0.2,  # one that does not read on waits for the answer so long
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
        """Listen until something is so."""
        end = time.monotonic() + LIMIT
        while not what():
            assert time.monotonic() < end, (self.counts, self.newest.get("state"))
            self.hear(0.1)

    def next(self, kind: str) -> dict[str, Any]:
        """The next message of a type."""
        before = self.counts[kind]
        self.until(lambda: self.counts[kind] > before)
        return dict(self.newest[kind])

    @property
    def output(self) -> str:
        """What the newest state says of it; "" before the first."""
        return str(self.newest.get("state", {}).get("output", ""))

    def catch_up(self) -> None:
        """Listen until the viewer has taken all that was said: what it had to tell this page has come, too."""
        before = self._answers
        self.say("replay")  # which a viewer of a server refuses at once
        self.until(lambda: self._answers > before)

    def __enter__(self) -> Self:
        return self

    def close(self) -> None:
        self._stack.close()

    def __exit__(self, *_: object) -> None:
        self.close()
