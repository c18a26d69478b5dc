"""A backend on the units' own software, behind a real socket."""

from __future__ import annotations

import asyncio
import threading
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

import pacinian as pc
from pacinian_plugins.backends.autd3 import Autd3
from pacinian_plugins.backends.autd3.levels import LEVELS
from pacinian_plugins.backends.autd3.udp import UdpLine

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

DEADLINE = 30.0  # [s]


class Played:
    """A backend that is open, on the units' own software."""

    def __init__(self, units: int = 1, **options: Any) -> None:
        self.array = pc.autd(units, 1)
        self.backend = Autd3(link="loopback", **{"watchdog": 5.0, "timeout": 3.0, **options})
        self.backend.open(self.array)
        self._sequence = 0

    @property
    def line(self) -> UdpLine:
        assert isinstance(self.backend.line, UdpLine)
        return self.backend.line

    def send(self, phase: int = 0, rows: int = 1, amplitude: int = LEVELS - 1) -> None:
        """Send a frame in which all transducers are alike."""
        self._sequence += 1
        levels = np.full((rows, len(self.array)), phase, np.uint16)
        frame = pc.Frame(
            self._sequence, 1e-3 * self._sequence, levels, np.full_like(levels, amplitude)
        )
        self.backend.send(frame)

    def settle(self) -> None:
        """Wait until all has been sent and answered."""
        until(
            lambda: not self.line._next and len(self.line._tasks) == 1
        )  # that which waits for more

    def ask(self, what: str) -> Any:
        """What the first unit says."""

        async def asked() -> Any:
            return (await getattr(self.line._client, f"read_{what}")())[0]

        return asyncio.run_coroutine_threadsafe(asked(), self.line._loop).result(DEADLINE)

    def processed(self) -> int:
        """How many messages the first unit has got, less what it is asked here."""
        return int(self.ask("telemetry").processed)


@contextmanager
def played(units: int = 1, **options: Any) -> Generator[Played]:
    it = Played(units, **options)
    try:
        yield it
    finally:
        it.backend.close()


def until(what: Callable[[], Any], pause: float = 0.01) -> Any:
    """Wait for it to be true."""
    due = time.monotonic() + DEADLINE
    while not (found := what()):
        assert time.monotonic() < due, "it must happen in time"
        threading.Event().wait(pause)
    return found
