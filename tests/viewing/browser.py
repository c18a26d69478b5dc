"""Chromium on the viewer's page: what it shows, what it complains of, what it asks for elsewhere."""

from __future__ import annotations

import contextlib
import importlib.util
import itertools
import os
import shutil
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self
from urllib.parse import urlsplit

import pytest

import pacinian as pc

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import ModuleType

    from playwright.sync_api import Browser, Page

    from pacinian.wire.state import State

ROOT = Path(__file__).parents[2]
CHROMIUM = "chromium"  # Debian's
ARGUMENTS = (
    "--headless=new", "--no-sandbox", "--disable-gpu-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run",
)  # fmt: skip
SMALL = 960, 540  # [px]: all is drawn by the processor
LIMIT = 60.0  # [s] for something to be shown


def absent(what: str) -> None:
    """Skip the test; fail it where CI is set."""
    if os.environ.get("CI"):
        pytest.fail(f"CI must have {what}")
    pytest.skip(f"there is no {what}")


def hook() -> ModuleType:
    """The build hook, hatch_build.py."""
    name = "hatch_build"
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, ROOT / "hatch_build.py")
        assert spec is not None
        assert spec.loader is not None
        sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules[name])
    return sys.modules[name]


@contextlib.contextmanager
def chromium() -> Iterator[Browser]:
    """A browser, and the page as its sources are now. Belongs to this thread, which has an event loop meanwhile."""
    from playwright.sync_api import sync_playwright

    executable = shutil.which(CHROMIUM)
    if executable is None:
        absent(CHROMIUM)
    if hook().stale(ROOT) and hook().tools() is None:
        absent("npm")
    hook().build(ROOT)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=ARGUMENTS)
        yield browser
        browser.close()


class Seen:
    """A page that is open, and what it shows: `window.pacinian`. said: what its console and network complain of."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.said: list[str] = []
        self.asked: set[str] = set()
        page.on("console", self._heard)
        page.on("pageerror", lambda error: self.said.append(f"error: {error}"))
        page.on("request", lambda request: self.asked.add(urlsplit(request.url).netloc))
        page.on("websocket", lambda socket: self.asked.add(urlsplit(socket.url).netloc))

    def _heard(self, message: Any) -> None:
        if message.type in ("error", "warning"):
            self.said.append(f"{message.type}: {message.text}")

    def get(self, what: str) -> Any:
        """A value of `window.pacinian`, as an expression."""
        return self.page.evaluate(f"() => pacinian.{what}")

    def until(self, what: Callable[[], object], limit: float = LIMIT) -> None:
        """Wait until something is so."""
        end = time.monotonic() + limit
        while not what():
            assert time.monotonic() < end, self.page.evaluate("() => document.body.innerText")
            self.page.wait_for_timeout(50)

    def text(self, css: str) -> str:
        """What an element says."""
        return str(self.page.inner_text(css))


def status(connection: Path) -> State:
    """What the server says now, to one who comes and goes."""
    with pc.Client(connection, name="witness") as client:
        return client.status()


class Game:
    """Lets a ball, a plate and a point be felt, in a thread of its own. moves: whether the plate does.

    Where a busy machine makes it lose its lease or its connection, it begins again.
    """

    def __init__(self, connection: Path) -> None:
        self.moves = False
        self._connection, self._ended = connection, threading.Event()
        self._thread = threading.Thread(target=self._run)

    def _run(self) -> None:
        ball = pc.Volume(
            shape=pc.Sphere(0.02), pose=_at(0.0, 0.15), radiation_pressure=5.0, name="ball"
        )
        plate = pc.Surface(
            shape=pc.Disc(0.01), pose=_at(0.03, 0.15), radiation_pressure=5.0, name="plate"
        )
        spark = pc.Point(position=(-0.03, -0.03, 0.15), radiation_pressure=5.0, name="spark")
        while not self._ended.wait(0.05):
            with (
                contextlib.suppress(pc.ServerError),
                pc.Client(self._connection, name="game", scene="room") as client,
            ):
                client.put(ball, plate, spark)
                client.arm(take=True)
                for step in itertools.count():
                    if self._ended.is_set():
                        return
                    client.hold(0.02)
                    if self.moves:
                        client.move("plate", _at(0.03, 0.15 + 1e-4 * (step % 100)))

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join(LIMIT)
        assert not self._thread.is_alive()


def _at(x: float, z: float) -> pc.Pose:
    return pc.Pose((x, x, z))


@contextlib.contextmanager
def seen(
    browser: Browser, url: str, size: tuple[int, int] = SMALL, live: bool = True
) -> Iterator[Seen]:
    """A page in a session of its own, live unless said otherwise. Nothing may be asked for elsewhere, or go wrong."""
    with contextlib.closing(
        browser.new_context(viewport={"width": size[0], "height": size[1]})
    ) as context:
        context.set_default_timeout(1000.0 * LIMIT)
        shown = Seen(context.new_page())
        shown.page.goto(url)
        if live:
            shown.until(lambda: shown.get("link") == "live" and shown.get("output"))
        yield shown
        assert shown.asked == {urlsplit(url).netloc}
        assert not shown.said
