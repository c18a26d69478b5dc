"""Measure the latency from sending a hand pose to its frame, with real processes and sockets, next to a bare echo."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.scene.config_sections import Units
from pacinian.serving.settings import Safety, Settings
from pacinian.testing import run_server
from pacinian_lab.server.echo import Echo
from pacinian_lab.server.latency_sender import Task, Times
from pacinian_lab.server.worker_process import WorkerProcess

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

RATES = 90.0, 1000.0  # [Hz]: frames of a headset; a tracker as fast as the loop
MAX_WAIT = 120.0  # [s] to wait for the result beyond the measured time


def settings(side: int) -> Settings:
    """Settings of a server with `side` x `side` AUTD units. The long lease keeps late senders from being silenced."""
    return Settings(array=Units(side, side), safety=Safety(lease=10.0))


def measure(side: int, seconds: float, rates: Sequence[float] = RATES) -> Iterator[Times]:
    """Yield the times at each rate [Hz], measured with a separate server for `seconds` [s]."""
    for rate in rates:
        with (
            run_server(settings(side)) as server,
            WorkerProcess("echo") as other,
            WorkerProcess("latency_sender") as game,
        ):
            game.send(Task(str(server.connection), other.receive(Echo), rate, seconds))
            yield game.receive(Times, limit=2.0 * seconds + MAX_WAIT)
