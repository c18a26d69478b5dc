"""A server and a viewer that all tests of a file share, and a game."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, Self

import pytest
import zmq
from msgspec.structs import replace

import pacinian as pc
from pacinian.client import link
from pacinian.client.emergency_stop import emergency_stop
from pacinian.client.reconnecting_client import ReconnectingClient
from pacinian.scene.config_sections import Units
from pacinian.serving.settings import Log, Safety, Settings
from pacinian.testing.server import Running, run_server
from pacinian.viewing import demonstration, slices, states

from .browser import chromium
from .watching import LIMIT, viewer

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from playwright.sync_api import Browser

SETTINGS = Settings(
    array=Units(1, 1),
    rate=250.0,
    log=Log(level="warning"),
    safety=Safety(lease=10.0, frame_timeout=1.0, hang_timeout=60.0, session_timeout=3600.0),
)
"""Long limits, so that nothing ends if the machine stops for a moment."""
CALM = replace(SETTINGS, rate=50.0, state_rate=20.0)
"""For pages in a browser, which draw fewer frames than that. At 1 kHz, the server works more than the browser."""


class Game:
    """Puts a ball, a plate and a point, and renews in a thread of its own. A context manager.

    PACE: of its renewals [s]. names: the objects that it puts. envelope: of the plate. moves: whether the plate moves.
    refused: error codes of the server.
    """

    PACE = 0.02

    def __init__(
        self,
        connection: Path,
        scene: str = "room",
        names: tuple[str, ...] = ("ball", "plate", "spark"),
        envelope: pc.Constant | pc.Sine | None = None,
    ) -> None:
        self._connection, self._scene, self._names = connection, scene, names
        self._envelope = envelope or pc.Constant()
        self._ended, self._sounds = threading.Event(), threading.Event()
        self.moves = False
        self.refused: list[str] = []
        self._thread = threading.Thread(target=self._run)

    def _run(self) -> None:
        ball = pc.Volume(
            name="ball", shape=pc.Sphere(0.02), pose=pc.Pose((0.0, 0.0, 0.15)),
            radiation_pressure=5.0,
        )  # fmt: skip
        plate = pc.Surface(
            name="plate", shape=pc.Disc(0.01), pose=pc.Pose((0.03, 0.03, 0.15)),
            radiation_pressure=5.0, envelope=self._envelope,
        )  # fmt: skip
        spark = pc.Point(name="spark", position=(-0.03, -0.03, 0.15), radiation_pressure=5.0)
        with pc.Client(self._connection, name="game", scene=self._scene) as client:
            client.put(*(item for item in (ball, plate, spark) if item.name in self._names))
            client.arm(take=True)
            step = 0
            while not self._ended.is_set():
                step += 1
                try:
                    client.hold(self.PACE)
                    if self.moves:
                        client.move("plate", pc.Pose((0.03, 0.03, 0.15 + 1e-4 * (step % 100))))
                    if client.status().output == "sounding":
                        self._sounds.set()
                except pc.Refused as error:
                    self.refused.append(error.code)
                except pc.ConnectionLost:
                    return

    def __enter__(self) -> Self:
        self._thread.start()
        assert self._sounds.wait(LIMIT)
        return self

    def __exit__(self, *_: Any) -> None:
        self._ended.set()
        self._thread.join(LIMIT)
        assert not self._thread.is_alive()


class CalmGame(Game):
    """A game that a page follows."""

    PACE = 0.1


@pytest.fixture(scope="module")
def server(request: pytest.FixtureRequest) -> Iterator[Running]:
    """Run a real server with one unit, and the `SETTINGS` of the module, if it has some."""
    with run_server(getattr(request.module, "SETTINGS", SETTINGS)) as running:
        yield running


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Start Chromium."""
    with chromium() as found:
        yield found


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the viewer's recordings."""
    return tmp_path_factory.mktemp("recordings")


@pytest.fixture(scope="module")
def url(server: Running, folder: Path, patient: None) -> Iterator[str]:
    """Return the address of a viewer, which all tests of a file share."""
    with viewer(server.connection, folder=folder) as address:
        yield address


@pytest.fixture(scope="module")
def patient() -> Iterator[None]:
    """Compute fields without low priority, and lose no server or page that stops for a moment."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(slices, "FIELD_NICENESS", 0)
        patch.setattr(states, "MAX_STATE_AGE", LIMIT)
        patch.setattr(demonstration, "QUIET", LIMIT)
        for call in (ReconnectingClient.__init__, emergency_stop):
            patch.setitem(call.__kwdefaults__, "timeout", LIMIT)
        for limit in (zmq.HEARTBEAT_TTL, zmq.HEARTBEAT_TIMEOUT):
            patch.setitem(link.HEARTBEAT, limit, int(1e3 * LIMIT))
        yield
