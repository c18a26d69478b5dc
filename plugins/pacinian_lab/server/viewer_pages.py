"""Pages of the live viewer for benchmarks: one that only reads, and one in Chromium that reports what it has drawn."""

from __future__ import annotations

import contextlib
import json
import subprocess
import tempfile
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Self
from urllib.parse import urlsplit
from urllib.request import urlopen

import msgpack
import psutil

from pacinian.closeable import Closeable
from pacinian.errors import MissingExtra, ServerError

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from websockets.sync.client import ClientConnection

SLICE = {
    "type": "slice", "id": 1, "centre": [0.0, 0.0, 0.2], "u": [1.0, 0.0, 0.0], "v": [0.0, 1.0, 0.0],
    "size": [0.2, 0.2], "shape": [128, 128],
}  # fmt: skip
LIMIT = 60.0  # [s] for a page to show everything
SHORT = 0.5  # [s] for the viewer to close a feed that nobody reads any more
POLL_INTERVAL = 0.2  # [s] between two polls of a page
# Like a Chromium without a graphics card: the CPU composes pages and renders WebGL.
CHROMIUM = (
    "--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", "--window-size=1280,800",
    "--remote-debugging-port=0", "--no-first-run", "--disable-background-networking", "--disable-sync",
)  # fmt: skip
PORT = "DevToolsActivePort"  # file in the profile; its first line is the port
COUNTS = "[performance.now() / 1e3, pacinian.frames, pacinian.slices, pacinian.link === 'live']"


class Counts(NamedTuple):
    """Counts of a page so far. at: time of the page's own clock [s]. frames: drawn. slices: received."""

    at: float = 0.0
    frames: int = 0
    slices: int = 0

    def rates(self, before: Counts) -> tuple[float, float]:
        """Return the frames and slices per second since `before`."""
        took = max(self.at - before.at, 1e-9)
        return (self.frames - before.frames) / took, (self.slices - before.slices) / took


class Reader:
    """Reads everything and draws nothing; `sliced`: requests a slice. A context manager. batches: read so far."""

    processes: tuple[psutil.Process, ...] = ()
    batches = 0

    def __init__(self, url: str, *, sliced: bool) -> None:
        self._opening, self._sliced, self._slices = feed(url), sliced, 0
        self._first, self._ended = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def counts(self) -> Counts:
        """Return the counts so far. If the page requests slices, waits for the first one. Raises ServerError."""
        if self._sliced and not self._first.wait(LIMIT):
            raise ServerError(f"no slice has come within {LIMIT:g} s")
        return Counts(time.perf_counter(), 0, self._slices)

    def _run(self) -> None:
        with self._opening as socket:
            if self._sliced:
                say(socket, SLICE)
            while not self._ended.is_set():
                with contextlib.suppress(TimeoutError):
                    kind = msgpack.unpackb(socket.recv(0.1), raw=False)["type"]
                    if kind == "batch":
                        self.batches += 1
                        say(socket, {"type": "ready"})
                    elif kind == "slice":
                        self._slices += 1
                        self._first.set()
                        say(socket, {"type": "seen", "id": SLICE["id"]})

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()


class Chromium(Closeable):
    """The page in a real headless browser, 1280 x 800. A context manager. Raises ServerError."""

    def __init__(self, program: str, url: str) -> None:
        self._name, self._stack = program, contextlib.ExitStack()
        folder = tempfile.TemporaryDirectory(prefix="pacinian-", ignore_cleanup_errors=True)
        self._profile = Path(self._stack.enter_context(folder))
        command = [program, *CHROMIUM, f"--user-data-dir={self._profile}", url]
        try:
            self._program = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )  # fmt: skip
        except OSError as error:
            self._stack.close()
            raise ServerError(f"{program} cannot be started: {error.strerror}") from error
        self._stack.callback(self._end)
        self.processes = (psutil.Process(self._program.pid),)

    def counts(self) -> Counts:
        """Return the counts so far. Waits until the page shows the server's state and a slice. Raises ServerError."""
        end = time.perf_counter() + LIMIT
        while time.perf_counter() < end and self._program.poll() is None:
            with contextlib.suppress(OSError, ValueError, LookupError):  # not ready yet
                at, frames, slices, live = self._evaluate(COUNTS)
                if live and slices:
                    return Counts(float(at), int(frames), int(slices))
            time.sleep(POLL_INTERVAL)
        raise ServerError(f"{self._name} has not shown the page and a slice within {LIMIT:g} s")

    def _evaluate(self, expression: str) -> list[float]:
        """Evaluate an expression by the DevTools protocol. Raises OSError, ValueError, LookupError."""
        from websockets.exceptions import WebSocketException
        from websockets.sync.client import connect

        port = int((self._profile / PORT).read_text(encoding="ascii").split()[0])
        with urlopen(f"http://127.0.0.1:{port}/json/list", timeout=LIMIT) as answer:
            pages: list[dict[str, Any]] = json.load(answer)
        (page,) = (page for page in pages if page["type"] == "page")
        asked = {"id": 1, "method": "Runtime.evaluate"}
        params = {"expression": expression, "returnByValue": True}
        try:
            with connect(page["webSocketDebuggerUrl"], compression=None) as socket:
                socket.send(json.dumps(asked | {"params": params}))
                found = json.loads(socket.recv(LIMIT))["result"]["result"]["value"]
        except WebSocketException as error:
            raise OSError(str(error)) from error
        if not isinstance(found, list):
            raise ValueError("nothing is shown yet")
        return found

    def _end(self) -> None:
        """Kill the browser and its child processes."""
        with contextlib.suppress(psutil.Error):
            for child in psutil.Process(self._program.pid).children(recursive=True):
                with contextlib.suppress(psutil.Error):
                    child.kill()
        self._program.kill()
        self._program.wait()

    def close(self) -> None:
        """End the browser, and remove its profile."""
        self._stack.close()


def feed(url: str) -> AbstractContextManager[ClientConnection]:
    """Open the websocket of a page's address. Raises MissingExtra."""
    try:
        from websockets.sync.client import connect
    except ImportError as error:
        raise MissingExtra("websockets", "view") from error
    parts = urlsplit(url)
    where = f"ws://{parts.netloc}/feed?{parts.query}"
    return connect(where, compression=None, max_size=None, close_timeout=SHORT)


def say(socket: ClientConnection, message: dict[str, Any]) -> None:
    """Send a message as a page does."""
    socket.send(msgpack.packb(message) or b"")
