"""From a hand's pose sent to the frame that it is in: with real processes, real sockets, beside a bare echo."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.scene.file import Units
from pacinian.serving.settings import Safety, Settings
from pacinian.testing import serving
from pacinian_lab.server.echo import Echo
from pacinian_lab.server.sender import Task, Times
from pacinian_lab.server.worker_process import WorkerProcess

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

RATES = 90.0, 1000.0  # [Hz]: a headset's frames, a tracker that is as quick as the loop
SLACK = 120.0  # [s] beyond what is measured


def settings(side: int) -> Settings:
    """A server with `side` x `side` AUTD units. No sender is so late that it is silenced, and not measured."""
    return Settings(array=Units(side, side), safety=Safety(lease=10.0))


def measure(side: int, seconds: float, rates: Sequence[float] = RATES) -> Iterator[Times]:
    """For each rate [Hz] a server of its own, for `seconds` [s]."""
    for rate in rates:
        with (
            serving(settings(side)) as server,
            WorkerProcess("echo") as other,
            WorkerProcess("sender") as game,
        ):
            game.send(Task(str(server.connection), other.receive(Echo), rate, seconds))
            yield game.receive(Times, limit=2.0 * seconds + SLACK)
