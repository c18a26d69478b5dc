"""Open the viewer's page in Chromium, and read what it shows, its errors, and its requests to other hosts."""

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
SMALL = 960, 540  # small, because rendering is in software [px]


def hook() -> ModuleType:
    """Return the build hook, hatch_build.py."""
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
    """Build the page, and start a browser. Only this thread may use it; the thread has an event loop meanwhile."""
    from playwright.sync_api import sync_playwright

    with FileLock(
        Path(tempfile.gettempdir()) / "pacinian-page.lock"
    ):  # another worker may be building it
        hook().build(ROOT)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=ARGUMENTS
        )
        yield browser
        browser.close()


class Seen:
    """An open page, and what it shows: `window.pacinian`. said: errors of its console and network."""

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
        """Return the value of an expression that begins at `window.pacinian`."""
        return self.page.evaluate(f"() => pacinian.{what}")

    def until(self, what: Callable[[], object]) -> None:
        """Wait until a condition is true."""
        end = time.monotonic() + LIMIT
        while not what():
            assert time.monotonic() < end, self.page.evaluate("() => document.body.innerText")
            self.page.wait_for_timeout(50)

    def text(self, css: str) -> str:
        """Return the text of an element."""
        return str(self.page.inner_text(css))


def status(connection: Path) -> State:
    """Return the server's state, by a client that connects for it."""
    with pc.Client(connection, name="witness") as client:
        return client.status()


@contextlib.contextmanager
def seen(
    browser: Browser, url: str, size: tuple[int, int] = SMALL, live: bool = True
) -> Iterator[Seen]:
    """Open a page, and wait until it is live, if `live`. Errors and requests to other hosts fail the test."""
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
