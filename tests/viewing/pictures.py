"""Draw the viewer's pictures for the documentation: `python -m tests.viewing.pictures docs/pictures`.

It runs a server with nine units, a game and Chromium: a hand on a ball, a plate in the air, and no server.
"""

from __future__ import annotations

import io
import sys
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event, Thread
from typing import TYPE_CHECKING

from PIL import Image

import pacinian as pc
from pacinian.scene.config_sections import Units
from pacinian.serving.settings import Safety, Settings
from pacinian.testing.server import Running, run_server
from pacinian.viewing import slices

from .browser import chromium, seen
from .watching import viewer

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .browser import Seen

SIZE = 1280, 800  # [px]
COLOURS = 256
LEGENDS = (894, 123, 12, 200), (30, 540, 70, 70)  # left, top, width, height of bar and wheel [px]
SHOW_SAMPLES = "() => document.getElementById('samples').scrollIntoView({ block: 'end' })"
SETTLED = 12_000  # [ms]
HAND = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.215)))
BALL = pc.Volume(
    name="ball", shape=pc.Sphere(0.03), pose=pc.Pose((0.0, 0.0, 0.175)), radiation_pressure=8.0
)
PLATE = pc.Surface(
    name="plate",
    shape=pc.Rectangle(0.04, 0.025),
    pose=pc.Pose((0.0, 0.0, 0.2)),
    radiation_pressure=5.0,
)


class Game:
    """Puts objects, with or without a hand, and renews in a thread of its own. A context manager."""

    def __init__(self, connection: Path, item: pc.Object, *hands: pc.Hand) -> None:
        self._connection, self._item, self._hands = connection, item, hands
        self._ended = Event()
        self._thread = Thread(target=self._run)

    def _run(self) -> None:
        with suppress(pc.ConnectionLost), pc.Client(self._connection, name="example") as client:
            client.put(self._item)
            if self._hands:
                client.hands(*self._hands)
            client.arm()
            while not self._ended.is_set():
                client.hold(0.02)
                if self._hands:
                    client.hands(*self._hands, wait=False)

    def __enter__(self) -> None:
        self._thread.start()

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()


@contextmanager
def open_viewer(safety: Safety, size: tuple[int, int]) -> Iterator[tuple[Running, Seen]]:
    """Start a server of nine units, and a viewer in a browser window of this size [px]."""
    slices.FIELD_NICENESS = 0  # compute fields even if the machine is busy
    with (
        run_server(Settings(array=Units(3, 3), safety=safety)) as server,
        viewer(server.connection) as url,
        chromium() as browser,
        seen(browser, url, size) as shown,
    ):
        yield server, shown


def pictures() -> Iterator[tuple[str, bytes]]:
    """Yield the name and the PNG data of each picture."""
    with open_viewer(Safety(lease=10.0), SIZE) as (server, shown):
        page = shown.page
        with Game(server.connection, BALL, HAND):
            settle(shown, "ball")
            yield "viewer-hand", take(shown)
            page.select_option("#slice-size", "0.05")
            page.check("[name=of][value=error]")
            page.check("[name=axis][value=z]")
            settle(shown, "ball")
            for key in 5 * ["ArrowUp"] + 5 * ["+"]:
                page.press("canvas", key)
            page.evaluate("() => document.activeElement.blur()")
            page.evaluate(SHOW_SAMPLES)
            page.wait_for_timeout(1000)
            yield "viewer-error", take(shown)
        page.evaluate("() => document.getElementById('panels').scrollTo(0, 0)")
        page.check("[name=of][value=pressure]")
        page.check("[name=axis][value=auto]")
        page.select_option("#slice-size", "0.1")
        page.fill("#level", "45")
        page.select_option("#box-size", "0.06")
        page.check("#surface-on")
        with Game(server.connection, PLATE):
            settle(shown, "plate")
            shown.until(lambda: shown.get("surface.triangles") > 0)
            page.wait_for_timeout(1000)
            yield "viewer-field", take(shown)
            server.process.kill()
            shown.until(lambda: shown.get("link") == "lost")
            page.wait_for_timeout(2000)
            yield "viewer-gone", page.screenshot()


def take(shown: Seen) -> bytes:
    """Return a picture, taken while the output sounds; on a busy machine, sound pauses now and then."""
    shown.until(lambda: shown.get("output") == "sounding")
    return shown.page.screenshot()


def settle(shown: Seen, name: str) -> None:
    """Fit an object into the view, and wait until charts and means have enough data."""
    shown.until(lambda: name in shown.text("#samples") and "%" in shown.text("#samples"))
    for button in ("[data-from=home]", "[data-from=near]"):
        shown.page.click(button)
    shown.page.wait_for_timeout(SETTLED)
    shown.until(lambda: shown.get("slices") > 0)  # there is no second slice if nothing moves


def reduced(data: bytes) -> Image.Image:
    """Reduce the number of colours. The legends are copied into the sample, so that their colours count."""
    image = Image.open(io.BytesIO(data)).convert("RGB")
    sample = image.copy()
    for k, (x, y, width, height) in enumerate(LEGENDS):
        part = image.crop((x, y, x + width, y + height)).resize((400, 300))
        sample.paste(part, (400 * k, 500))
    return image.quantize(palette=sample.quantize(COLOURS, kmeans=2), dither=Image.Dither.NONE)


if __name__ == "__main__":
    for name, data in pictures():
        reduced(data).save(Path(sys.argv[1]) / f"{name}.png", "PNG", optimize=True)
