"""A game that plays on, whatever happens to its server."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

import pacinian as pc

from ..waiting import PATIENCE

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.wire.state import State
    from pacinian_lab.server.faults.server import Server

QUIET = 0.3  # [s] of silence, which is not that of one late frame
LEASE = 0.25  # [s]
RADIUS, HEIGHT, TURN = 0.02, 0.2, 6.0  # [m], [m], [rad/s]
POINT = pc.Point(name="thing", position=(RADIUS, 0.0, HEIGHT), radiation_pressure=20.0)


class Game:
    """A client that moves an object. A context manager. If it is no longer armed, it puts its object and arms again.

    told: what its calls raised. states: all that it saw.
    """

    def __init__(self, server: Server, lease: float | None = None, name: str = "game") -> None:
        self.server, self.log = server, server.log
        self.client = pc.Client(server.file, name=name, reconnect=True, lease=lease)
        self.told: list[pc.ServerError] = []
        self.states: list[State] = []

    def play(self, until: Callable[[], Any]) -> Any:
        """Play until something is true; return it."""
        due = time.monotonic() + PATIENCE
        while True:
            for step in (self.client.renew, self._tick, until):
                try:
                    value = step()
                except pc.ServerError as error:
                    self.told.append(error)
                    value = None
            if value:
                return value
            assert time.monotonic() < due, (self.told[-3:], self.states[-1:])
            time.sleep(0.001)

    def _tick(self) -> None:
        if not self.client.armed:
            self.client.put(POINT)
            self.client.arm()
        angle = TURN * time.perf_counter()
        pose = pc.Pose((RADIUS * math.cos(angle), RADIUS * math.sin(angle), HEIGHT))
        self.client.move("thing", pose, wait=False, ttl=60.0)
        if (state := self.client.poll_state()) is not None:
            self.states.append(state)

    def sound(self) -> None:
        """Play until more is heard."""
        mark = self.log.count
        self.play(lambda: bool(self.log.read(mark)["sounds"].any()))

    def fall_silent(self) -> None:
        """Play until nothing has been heard for a while."""

        def silent() -> bool:
            (last,) = self.log.read(self.log.count - 1)[-1:]
            return bool(not last["sounds"] and time.perf_counter() - last["time"] > QUIET)

        self.play(silent)

    def __enter__(self) -> Game:
        self.sound()
        return self

    def __exit__(self, *_: object) -> None:
        self.client.close()
