"""What the live viewer costs the loop: ticks with the viewer closed and open, in turn, on one server."""

from __future__ import annotations

import contextlib
import re
import subprocess
import sys
import tempfile
import threading
import time
from typing import IO, TYPE_CHECKING
from urllib.parse import urlsplit

import msgpack
import psutil
from msgspec import Struct

from pacinian.acoustics.pose import Pose
from pacinian.bench.timing import quantile
from pacinian.client.client import Client
from pacinian.errors import ConnectionLost, MissingExtra, Refused, ServerError
from pacinian.scene.file import Units
from pacinian.scene.hands.hand import Hand
from pacinian.scene.objects import Volume
from pacinian.scene.shapes import Sphere
from pacinian.serving.settings import Log, Settings
from pacinian.testing import serving

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator, Sequence
    from pathlib import Path

    from pacinian.wire.state import State

FRAME = 1.0 / 90.0  # [s] of the game
SETTLE = 3.0  # [s] before each window
LIMIT = 60.0  # [s] for the viewer to start
BALL = Volume(name="ball", shape=Sphere(0.03), pose=Pose((0.0, 0.0, 0.175)), radiation_pressure=8.0)
SLICE = {
    "type": "slice", "id": 1, "centre": [0.0, 0.0, 0.2], "u": [1.0, 0.0, 0.0], "v": [0.0, 1.0, 0.0],
    "size": [0.2, 0.2], "shape": [128, 128],
}  # fmt: skip
HOW = "closed", "feed", "slice"
BROWSER = "--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"


class Row(Struct, frozen=True):
    """One window. how: the viewer closed; open; open with a slice of 128 x 128; or in a browser.

    p50, p99: of the ticks of each second in which it sounded, medians over the window [ms]. sounding: share of those
    seconds. late: share of ticks. states, slices: a second, that came to the page.
    cpu: of the viewer's processes [cores].
    """

    how: str
    p50: float
    p99: float
    sounding: float
    late: float
    states: float
    slices: float
    cpu: float


class Page:
    """Stands in for a page: it reads all, and acknowledges slices. A context manager."""

    def __init__(self, url: str, *, sliced: bool) -> None:
        try:
            from websockets.sync.client import connect
        except ImportError as error:
            raise MissingExtra("websockets", "view") from error
        parts = urlsplit(url)
        self.states = self.slices = 0
        self._opening = connect(
            f"ws://{parts.netloc}/feed?{parts.query}", compression=None, max_size=None
        )
        self._sliced, self._ended = sliced, threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def _run(self) -> None:
        with self._opening as socket:
            if self._sliced:
                socket.send(msgpack.packb(SLICE) or b"")
            while not self._ended.is_set():
                with contextlib.suppress(TimeoutError):
                    data = socket.recv(0.1)
                    kind = msgpack.unpackb(data, raw=False)["type"]
                    self.states += kind == "state"
                    if kind == "slice":
                        self.slices += 1
                        socket.send(msgpack.packb({"type": "seen", "id": SLICE["id"]}) or b"")

    def __enter__(self) -> Page:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()


def measure(side: int, seconds: float, rounds: int, browser: str = "") -> Iterator[Row]:
    """Windows of so many seconds, `rounds` of each kind in turn, before `side` x `side` units.

    browser: a Chromium that opens the page, too. Raises ServerError.
    """
    settings = Settings(array=Units(side, side), log=Log(level="warning"))
    with serving(settings) as server, Client(server.connection, name="game") as game:
        game.put(BALL)
        game.arm()
        for _ in range(rounds):
            for how in (*HOW, "browser") if browser else HOW:
                with viewed(server.connection, how, browser, game) as (processes, page):
                    play(game, SETTLE)
                    yield _window(game, how, seconds, processes, page)


def play(game: Client, seconds: float) -> list[State]:
    """Move a hand over the ball for so long [s]; the state at the end of each second."""
    begin = now = time.perf_counter()
    found: list[State] = []
    while now < begin + seconds:
        x = 0.02 * ((now % 2.0) - 1.0)
        try:
            game.hands(Hand.open("right", Pose((x, -0.03, 0.215))), wait=False)
            game.renew()
            if now - begin >= len(found) + 1.0:
                found.append(game.status())
        except Refused:  # late, on a busy machine
            game.arm()
        except ConnectionLost:  # very late
            game.reconnect()
            game.put(BALL)
            game.arm()
        time.sleep(FRAME)
        now = time.perf_counter()
    return found


def _window(
    game: Client, how: str, seconds: float, processes: Sequence[psutil.Process], page: Page | None
) -> Row:
    before, used = game.status(), _used(processes)
    states, slices = (page.states, page.slices) if page else (0, 0)
    begin = time.perf_counter()
    seen = play(game, seconds)
    took, after = time.perf_counter() - begin, game.status()
    sounding = [state for state in seen if state.output == "sounding"]
    if not sounding:
        raise ServerError("nothing has sounded: the machine is too busy to measure this")
    return Row(
        how,
        quantile(sorted(state.tick_ms[0] for state in sounding), 0.5),
        quantile(sorted(state.tick_ms[1] for state in sounding), 0.5),
        len(sounding) / len(seen),
        (after.late - before.late) / max(1, after.ticks - before.ticks),
        (page.states - states) / took if page else 0.0,
        (page.slices - slices) / took if page else 0.0,
        (_used(processes) - used) / took,
    )


def _used(processes: Sequence[psutil.Process]) -> float:
    total = 0.0
    for process in processes:
        with contextlib.suppress(psutil.Error):
            for one in (process, *process.children(recursive=True)):
                times = one.cpu_times()
                total += times.user + times.system
    return total


@contextlib.contextmanager
def viewed(
    connection: Path, how: str, browser: str, game: Client
) -> Generator[tuple[list[psutil.Process], Page | None]]:
    """The viewer, open in one way; and its processes. The game goes on while it starts."""
    if how == "closed":
        yield [], None
        return
    command = [
        sys.executable,
        "-m",
        "pacinian",
        "view",
        "--no-browser",
        "--connection",
        str(connection),
    ]
    with contextlib.ExitStack() as stack:
        out = stack.enter_context(tempfile.TemporaryFile("w+b"))
        process = subprocess.Popen(command, stdout=out)
        stack.callback(process.wait)
        stack.callback(process.terminate)
        url = _address(out, game)
        if how == "browser":
            folder = tempfile.TemporaryDirectory(prefix="pacinian-", ignore_cleanup_errors=True)
            program = [browser, *BROWSER, f"--user-data-dir={stack.enter_context(folder)}", url]
            shown = subprocess.Popen(program, stderr=subprocess.DEVNULL)
            stack.callback(_end, shown)
            yield [psutil.Process(process.pid), psutil.Process(shown.pid)], None
        else:
            page = stack.enter_context(Page(url, sliced=how == "slice"))
            yield [psutil.Process(process.pid)], page


def _end(program: subprocess.Popen[bytes]) -> None:
    """A browser and all that it has started."""
    with contextlib.suppress(psutil.Error):
        for child in psutil.Process(program.pid).children(recursive=True):
            with contextlib.suppress(psutil.Error):
                child.kill()
    program.kill()
    program.wait()


def _address(out: IO[bytes], game: Client) -> str:
    """Of the viewer, as soon as it has printed it. Raises ServerError."""
    end = time.perf_counter() + LIMIT
    while time.perf_counter() < end:
        play(game, 0.1)
        out.seek(0)
        if found := re.search(rb"http://\S+", out.read()):
            return found[0].decode()
    raise ServerError(f"the viewer has not started within {LIMIT:g} s")
