"""What the live viewer costs: the loop's ticks with it closed and open, in turn, on one server; what a page draws."""

from __future__ import annotations

import contextlib
import re
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import IO, TYPE_CHECKING

import psutil
from msgspec import Struct

from pacinian.acoustics.pose import Pose
from pacinian.client.client import Client
from pacinian.errors import ConnectionLost, Refused, ServerError
from pacinian.scene.file import Units
from pacinian.scene.hands.hand import Hand
from pacinian.scene.objects import Volume
from pacinian.scene.shapes import Sphere
from pacinian.serving.settings import Log, Settings
from pacinian.testing import serving
from pacinian_lab.server.viewer_pages import Chromium, Counts, Reader, feed, say
from pacinian_lab.solvers.timing import quantile

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator, Sequence

    from pacinian.wire.state import State

FRAME = 1.0 / 90.0  # [s] of the game
SETTLE = 3.0  # [s] before each window
LIMIT = 60.0  # [s] for the viewer to start, and to connect anew
BALL = Volume(name="ball", shape=Sphere(0.03), pose=Pose((0.0, 0.0, 0.175)), radiation_pressure=8.0)
HOW = "closed", "feed", "slice"
ALL = "&power=all"  # of a page's address: frames one after the other, changed or not


class Ticks(Struct, frozen=True):
    """Of the loop in a window.

    p50, p99: of ticks, as told after each second if it sounds then, or as soon as it does in the next; medians over the
    window [ms]. sounding: share of the seconds after which it did. late: share of ticks.
    """

    p50: float
    p99: float
    sounding: float
    late: float


class Row(Struct, frozen=True):
    """One window.

    how: the viewer closed; open with a page that only reads (feed); and asks for a slice of 128 x 128; in a browser;
    in a browser without a server, from a recording, all frames drawn that can be (alone). ticks: None without a server.
    frames: a second, that the page drew. slices: a second, that it got. viewer, browser: their processes [cores].
    """

    how: str
    ticks: Ticks | None
    frames: float
    slices: float
    viewer: float
    browser: float


def measure(side: int, seconds: float, rounds: int, browser: str = "") -> Iterator[Row]:
    """Windows of so many seconds, `rounds` of each kind in turn, before `side` x `side` units.

    browser: a Chromium that opens the page, too. Raises ServerError.
    """
    settings = Settings(array=Units(side, side), log=Log(level="warning"))
    with tempfile.TemporaryDirectory(prefix="pacinian-") as name:
        folder = Path(name)
        with serving(settings) as server, Client(server.connection, name="game") as game:
            game.put(BALL)
            game.arm()
            wait = partial(_playing, game)
            where = "--connection", str(server.connection)
            for _ in range(rounds):
                for how in (*HOW, "browser") if browser else HOW:
                    with contextlib.ExitStack() as stack:
                        viewer: psutil.Process | None = None
                        page: Reader | Chromium | None = None
                        if how != "closed":
                            viewer, url = stack.enter_context(viewing(folder, wait, *where))
                            page = (
                                Chromium(browser, url)
                                if how == "browser"
                                else Reader(url, sliced=how == "slice")
                            )
                            stack.enter_context(page)
                        yield _window(game, how, seconds, viewer, page)
            if browser:
                _record(game, seconds + 3 * SETTLE, folder, *where)
        if browser:
            (recording,) = folder.glob("*.feed")
            for _ in range(rounds):
                with (
                    viewing(folder, time.sleep, str(recording)) as (viewer, url),
                    Chromium(browser, url + ALL) as page,
                ):
                    yield _alone(url, seconds, viewer, page)


def play(game: Client, seconds: float) -> list[State]:
    """Move a hand over the ball for so long [s]; the state at the end of each second but the last.

    Where it does not sound just then, the first one until the end of the next second that does, or else the last.
    """
    begin = now = time.perf_counter()
    found: list[State] = []
    while now < begin + seconds:
        x = 0.02 * ((now % 2.0) - 1.0)
        try:
            game.hands(Hand.open("right", Pose((x, 0.0, 0.215))), wait=False)
            game.renew()
            if now - begin >= len(found) + 1.0:
                found.append(game.status())
            elif found and found[-1].output != "sounding":
                found[-1] = game.status()
        except Refused:  # late, on a busy machine
            game.arm()
        except ConnectionLost:  # very late
            _reconnect(game)
        time.sleep(FRAME)
        now = time.perf_counter()
    return found


def _reconnect(game: Client) -> None:
    """Until it plays on: who is late for one connection may be so for the next. Raises ConnectionLost."""
    end = time.perf_counter() + LIMIT
    while True:
        try:
            game.reconnect()
            game.put(BALL)
            game.arm(take=True)  # from the session that was lost
            return
        except ConnectionLost:
            if time.perf_counter() > end:
                raise
            time.sleep(FRAME)


def _playing(game: Client, seconds: float) -> None:
    play(game, seconds)


def _window(
    game: Client, how: str, seconds: float, viewer: psutil.Process | None, page: Reader | Chromium | None
) -> Row:  # fmt: skip
    _counts(game, page)  # it is there
    play(game, SETTLE)
    counts, before, meter = _counts(game, page), game.status(), Meter(viewer, page)
    seen = play(game, seconds)
    cores, after = meter.cores(), game.status()
    now = _sliced(partial(_counts, game, page), partial(play, game, SETTLE), counts)
    sounding = [state for state in seen if state.output == "sounding"]
    if not sounding:
        raise ServerError("nothing has sounded: the machine is too busy to measure this")
    ticks = Ticks(
        quantile(sorted(state.tick_ms[0] for state in sounding), 0.5),
        quantile(sorted(state.tick_ms[1] for state in sounding), 0.5),
        len(sounding) / len(seen),
        (after.late - before.late) / max(1, after.ticks - before.ticks),
    )
    return Row(how, ticks, *now.rates(counts), *cores)


def _counts(game: Client, page: Reader | Chromium | None) -> Counts:
    """The game goes on while the page is asked."""
    if page is None:
        return Counts()
    with ThreadPoolExecutor(1) as pool:
        asked = pool.submit(page.counts)
        while not asked.done():
            play(game, FRAME)
        return asked.result()


def _record(game: Client, seconds: float, folder: Path, *where: str) -> None:
    """A recording of the viewer, into its folder."""
    with viewing(folder, partial(_playing, game), *where) as (_, url), feed(url) as socket:
        say(socket, {"type": "record", "on": True})
        play(game, seconds)


def _alone(url: str, seconds: float, viewer: psutil.Process, page: Chromium) -> Row:

    def again() -> None:
        with feed(url) as socket:
            say(socket, {"type": "replay", "time": 0.0, "playing": True})
        time.sleep(SETTLE)

    page.counts()
    again()
    counts, meter = page.counts(), Meter(viewer, page)
    time.sleep(seconds)
    cores = meter.cores()
    return Row("alone", None, *_sliced(page.counts, again, counts).rates(counts), *cores)


def _sliced(counts: Callable[[], Counts], go_on: Callable[[], object], before: Counts) -> Counts:
    """The counts, once a slice has come since, where they are asked for: of a window without one no rate is known."""
    end = time.perf_counter() + LIMIT
    while (now := counts()).slices == before.slices > 0 and time.perf_counter() < end:
        go_on()
    return now


class Meter:
    """How much of the processors a viewer and a page's browser take, from when it is made."""

    def __init__(self, viewer: psutil.Process | None, page: Reader | Chromium | None) -> None:
        self._viewer = () if viewer is None else (viewer,)
        self._browser = () if page is None else page.processes
        self._begin, self._before = time.perf_counter(), self._used()

    def cores(self) -> tuple[float, float]:
        """Of the viewer and the browser, with all that they have started [cores]."""
        took = time.perf_counter() - self._begin
        viewer, browser = (now - was for now, was in zip(self._used(), self._before, strict=True))
        return viewer / took, browser / took

    def _used(self) -> tuple[float, float]:
        return _used(self._viewer), _used(self._browser)


def _used(processes: Sequence[psutil.Process]) -> float:
    total = 0.0
    for process in processes:
        with contextlib.suppress(psutil.Error):
            for one in (process, *process.children(recursive=True)):
                times = one.cpu_times()
                total += times.user + times.system
    return total


@contextlib.contextmanager
def viewing(
    folder: Path, wait: Callable[[float], object], *arguments: str
) -> Generator[tuple[psutil.Process, str]]:
    """`pacinian view` in a folder, and its address; `wait` waits for so long [s]. Raises ServerError."""
    command = [sys.executable, "-m", "pacinian", "view", "--no-browser", *arguments]
    with tempfile.TemporaryFile("w+b") as out:
        process = subprocess.Popen(command, stdout=out, cwd=folder)
        try:
            yield psutil.Process(process.pid), _address(out, wait)
        finally:
            process.terminate()
            process.wait()


def _address(out: IO[bytes], wait: Callable[[float], object]) -> str:
    """As soon as it is printed. Raises ServerError."""
    end = time.perf_counter() + LIMIT
    while time.perf_counter() < end:
        wait(0.1)
        out.seek(0)
        if found := re.search(rb"http://\S+", out.read()):
            return found[0].decode()
    raise ServerError(f"the viewer has not started within {LIMIT:g} s")
