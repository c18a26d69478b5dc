"""A backend on the units' own software, behind a real socket."""

from __future__ import annotations

import asyncio
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

import pacinian as pc
from pacinian_plugins.backends.autd3 import Autd3
from pacinian_plugins.backends.autd3.levels import LEVELS
from pacinian_plugins.backends.autd3.udp_transport import UdpTransport

from ...waiting import PATIENCE, eventually

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

PATIENT = {"watchdog": 5.0, "timeout": 6.0}  # [s]; a quarter of it is for each answer


def frame(sequence: int, level: int | None = None, N: int = 249) -> pc.Frame:
    """In which all transducers have the same phase: another one than that of the frame before, unless given."""
    phase = np.full((1, N), sequence % 2 if level is None else level, np.uint16)
    return pc.Frame(sequence, 1e-3 * sequence, phase, np.full_like(phase, LEVELS - 1))


def refusal(backend: pc.Backend, what: pc.Frame) -> str:
    """Why it does not take a frame; "" where it does."""
    try:
        backend.send(what)
    except pc.BackendError as error:
        return str(error)
    return ""


def lost(backend: Any, following: Callable[[], pc.Frame]) -> str:
    """Wait until it is known that units do not answer: what that is told as. following: makes frames."""
    backend.line._timeout = 0.5
    problem = eventually(lambda: refusal(backend, following()))
    backend.line._timeout = PATIENT["timeout"]
    return problem


class Played:
    """A backend that is open, on the units' own software."""

    def __init__(self, units: int = 1, **options: Any) -> None:
        self.array = pc.autd(units, 1)
        self.backend = Autd3(link="loopback", **{**PATIENT, **options})
        self.backend.open(self.array)
        self._sequence = 0

    @property
    def line(self) -> UdpTransport:
        assert isinstance(self.backend.line, UdpTransport)
        return self.backend.line

    def frame(self, phase: int | None = None) -> pc.Frame:
        """The next one."""
        self._sequence += 1
        return frame(self._sequence, phase, N=len(self.array))

    def send(self, phase: int | None = None) -> None:
        """Send a frame in which all transducers are alike, but not as they were unless the phase is given."""
        self.backend.send(self.frame(phase))

    def lost(self) -> str:
        """Wait until it is known that units do not answer: what that is told as."""
        return lost(self.backend, self.frame)

    def settle(self) -> None:
        """Wait until all has been sent and answered."""
        eventually(
            lambda: not self.line._next and len(self.line._tasks) == 1
        )  # that which waits for more

    def ask(self, what: str) -> Any:
        """What the first unit says."""

        async def asked() -> Any:
            return (await getattr(self.line._client, f"read_{what}")())[0]

        return asyncio.run_coroutine_threadsafe(asked(), self.line._loop).result(PATIENCE)

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
