"""Chromium on the viewer's page: what it shows, what it complains of, what it asks for elsewhere."""

from __future__ import annotations

import contextlib
import importlib.util
import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from filelock import FileLock

import pacinian as pc

from .watching import LIMIT

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import ModuleType

    from playwright.sync_api import Browser, Page

    from pacinian.wire.state import State

ROOT = Path(__file__).parents[2]
ARGUMENTS = (
    "--headless=new", "--no-sandbox", "--disable-gpu-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run",
)  # fmt: skip
SMALL = 960, 540  # [px]: all is drawn by the processor


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

    with FileLock(
        Path(tempfile.gettempdir()) / "pacinian-page.lock"
    ):  # another worker may build it
        hook().build(ROOT)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=ARGUMENTS
        )
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

    def until(self, what: Callable[[], object]) -> None:
        """Wait until something is so."""
        end = time.monotonic() + LIMIT
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
        assert not shown.said, shown.said
