"""One server for all tests of a file that need one, and a game."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, Self

import pytest

import pacinian as pc
from pacinian.scene.file import Units
from pacinian.serving.settings import Log, Safety, Settings
from pacinian.testing.server import Running, serving
from pacinian.viewing import slices

from .watching import viewer

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

SETTINGS = Settings(
    array=Units(1, 1), log=Log(level="warning"), safety=Safety(lease=10.0, stale=1.0)
)
"""A machine that is late ends nothing: leases are `test_letting_go`'s."""


class Game:
    """Lets a ball be felt, in a thread of its own, until it is left. move: whether a plate moves."""

    def __init__(self, connection: Path, scene: str = "room") -> None:
        self._connection, self._scene = connection, scene
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
            radiation_pressure=5.0,
        )  # fmt: skip
        with pc.Client(self._connection, name="game", scene=self._scene) as client:
            client.put(ball, plate)
            client.arm(take=True)
            step = 0
            while not self._ended.is_set():
                step += 1
                try:
                    client.hold(0.02)
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
        assert self._sounds.wait(30.0)
        return self

    def __exit__(self, *_: Any) -> None:
        self._ended.set()
        self._thread.join(30.0)
        assert not self._thread.is_alive()


@pytest.fixture(scope="module")
def settings() -> Settings:
    """Of the server; for the tests of a file that has its own."""
    return SETTINGS


@pytest.fixture(scope="module")
def server(settings: Settings) -> Iterator[Running]:
    """A real one, of a single unit."""
    with serving(settings) as running:
        yield running


@pytest.fixture
def url(server: Running, tmp_path: Path) -> Iterator[str]:
    """The address of a viewer of that server."""
    with viewer(server.connection, folder=tmp_path) as address:
        yield address


@pytest.fixture(autouse=True)
def eager(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fields are computed as soon as anything else, so that no test waits for an idle machine."""
    monkeypatch.setattr(slices, "CALM", 0)
