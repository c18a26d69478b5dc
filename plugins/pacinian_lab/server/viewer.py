"""Measure the cost of the live viewer: ticks of one server with the viewer closed and open, and frames of a page."""

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
from pacinian.scene.config_sections import Units
from pacinian.scene.hands.hand import Hand
from pacinian.serving.settings import Log, Settings
from pacinian.testing import run_server
from pacinian_lab.server.footprint import BALL
from pacinian_lab.server.viewer_pages import Chromium, Counts, Reader, feed, say
from pacinian_lab.solvers.timing import quantile

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator, Sequence

    from pacinian.wire.state import State

FRAME = 1.0 / 90.0  # [s] of the game
SETTLE = 3.0  # [s] before each window
LIMIT = 60.0  # [s] for the viewer to start, and for the game to reconnect
HOW = "closed", "feed", "slice"
ALL = "&power=all"  # in a page's address: draw every frame, changed or not


class Ticks(Struct, frozen=True):
    """Ticks of the loop in a window.

    p50, p99: quantiles of the tick time [ms]; medians over the window. They are read after each second in which the
    output sounds, or as soon as it sounds in the next second. sounding: fraction of the seconds after which it
    sounded. late: fraction of ticks.
    """

    p50: float
    p99: float
    sounding: float
    late: float


class Row(Struct, frozen=True):
    """Results of one window.

    how: the viewer is closed; open with a page that only reads (feed); that also requests a 128 x 128 slice (slice);
    in a browser (browser); in a browser that plays a recording as fast as it can, without a server (alone). ticks:
    None without a server. frames: drawn by the page per second. slices: received per second. viewer, browser: CPU use
    of their processes [cores].
    """

    how: str
    ticks: Ticks | None
    frames: float
    slices: float
    viewer: float
    browser: float


def measure(side: int, seconds: float, rounds: int, browser: str) -> Iterator[Row]:
    """Yield windows of `seconds` [s], `rounds` of each kind in turn, in front of `side` x `side` units.

    browser: a Chromium that also opens the page, if any. Raises ServerError.
    """
    settings = Settings(array=Units(side, side), log=Log(level="warning"))
    with tempfile.TemporaryDirectory(prefix="pacinian-") as name:
        folder = Path(name)
        with run_server(settings) as server, Client(server.connection, name="game") as game:
            game.put(BALL)
            game.arm()
            wait = partial(play, game)
            where = "--connection", str(server.connection)
            for _ in range(rounds):
                for how in (*HOW, "browser") if browser else HOW:
                    with contextlib.ExitStack() as stack:
                        viewer: psutil.Process | None = None
                        page: Reader | Chromium | None = None
                        if how != "closed":
                            viewer, url = stack.enter_context(run_viewer(folder, wait, *where))
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
                    run_viewer(folder, time.sleep, str(recording)) as (viewer, url),
                    Chromium(browser, url + ALL) as page,
                ):
                    yield _alone(url, seconds, viewer, page)


def play(game: Client, seconds: float) -> list[State]:
    """Move a hand over the ball for `seconds` [s], and return the state at the end of each second but the last.

    If the output is silent at the end of a second, the next sounding state within a second replaces that state, or
    else the last one does.
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
        except Refused:  # the game was late on a busy machine
            game.arm()
        except ConnectionLost:  # the game was very late
            _reconnect(game)
        time.sleep(FRAME)
        now = time.perf_counter()
    return found


def _reconnect(game: Client) -> None:
    """Reconnect, again and again, because a late client may also lose the next connection. Raises ConnectionLost."""
    end = time.perf_counter() + LIMIT
    while True:
        try:
            game.reconnect()
            game.put(BALL)
            game.arm(take=True)  # takes over from the lost session
            return
        except ConnectionLost:
            if time.perf_counter() > end:
                raise
            time.sleep(FRAME)


def _window(
    game: Client, how: str, seconds: float, viewer: psutil.Process | None, page: Reader | Chromium | None
) -> Row:  # fmt: skip
    _counts(game, page)  # waits until the page is there
    play(game, SETTLE)
    counts, before, meter = _counts(game, page), game.status(), Meter(viewer, page)
    seen = play(game, seconds)
    cores, after = meter.cores(), game.status()
    now = _wait_for_slice(partial(_counts, game, page), partial(play, game, SETTLE), counts)
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
    """Return the counts of the page, and play the game meanwhile."""
    if page is None:
        return Counts()
    with ThreadPoolExecutor(1) as pool:
        asked = pool.submit(page.counts)
        while not asked.done():
            play(game, FRAME)
        return asked.result()


def _record(game: Client, seconds: float, folder: Path, *where: str) -> None:
    """Record the viewer's feed into its folder."""
    with run_viewer(folder, partial(play, game), *where) as (_, url), feed(url) as socket:
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
    return Row("alone", None, *_wait_for_slice(page.counts, again, counts).rates(counts), *cores)


def _wait_for_slice(
    counts: Callable[[], Counts], go_on: Callable[[], object], before: Counts
) -> Counts:
    """Return the counts, after a new slice if the page requests slices: a window without a slice gives no rate."""
    end = time.perf_counter() + LIMIT
    while (now := counts()).slices == before.slices > 0 and time.perf_counter() < end:
        go_on()
    return now


class Meter:
    """Measures the CPU use of a viewer and of a page's browser since the meter was made."""

    def __init__(self, viewer: psutil.Process | None, page: Reader | Chromium | None) -> None:
        self._viewer = () if viewer is None else (viewer,)
        self._browser = () if page is None else page.processes
        self._begin, self._before = time.perf_counter(), self._measure_both()

    def cores(self) -> tuple[float, float]:
        """Return the CPU use of the viewer and of the browser, including their child processes [cores]."""
        took = time.perf_counter() - self._begin
        viewer, browser = (
            now - was for now, was in zip(self._measure_both(), self._before, strict=True)
        )
        return viewer / took, browser / took

    def _measure_both(self) -> tuple[float, float]:
        return _measure_cpu(self._viewer), _measure_cpu(self._browser)


def _measure_cpu(processes: Sequence[psutil.Process]) -> float:
    total = 0.0
    for process in processes:
        with contextlib.suppress(psutil.Error):
            for one in (process, *process.children(recursive=True)):
                times = one.cpu_times()
                total += times.user + times.system
    return total


@contextlib.contextmanager
def run_viewer(
    folder: Path, wait: Callable[[float], object], *arguments: str
) -> Generator[tuple[psutil.Process, str]]:
    """Run `pacinian view` in a folder and yield its process and address. wait: waits [s]. Raises ServerError."""
    command = [sys.executable, "-m", "pacinian", "view", "--no-browser", *arguments]
    with tempfile.TemporaryFile("w+b") as out:
        process = subprocess.Popen(command, stdout=out, cwd=folder)
        try:
            yield psutil.Process(process.pid), _address(out, wait)
        finally:
            process.terminate()
            process.wait()


def _address(out: IO[bytes], wait: Callable[[float], object]) -> str:
    """Return the address as soon as the viewer prints it. Raises ServerError."""
    end = time.perf_counter() + LIMIT
    while time.perf_counter() < end:
        wait(0.1)
        out.seek(0)
        if found := re.search(rb"http://\S+", out.read()):
            return found[0].decode()
    raise ServerError(f"the viewer has not started within {LIMIT:g} s")
