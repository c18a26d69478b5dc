"""Play with a server for a long time, and record its resources and ticks window by window."""

from __future__ import annotations

import time
from contextlib import ExitStack
from typing import TYPE_CHECKING

from msgspec import Struct

from pacinian.scene.config_sections import Units
from pacinian.serving.settings import Log, Settings
from pacinian.testing import run_server
from pacinian_lab.server.killed_client import Visit
from pacinian_lab.server.soak_game import SCENE, Heard, Play, Window
from pacinian_lab.server.worker_process import WorkerProcess

if TYPE_CHECKING:
    from collections.abc import Iterator

WINDOWS = 120  # windows of a run
MIN_WINDOW = 0.5  # [s] minimum length of a window
MAX_WAIT = 60.0  # [s] longest wait for an answer
VISIT_INTERVAL = 4  # windows from one client that is killed to the next


class Row(Struct, frozen=True):
    """A window. t: its end, from the start [s]. memory [MB], files, cpu (fraction of a core): by process."""

    t: float
    heard: Heard
    memory: dict[str, float]
    files: dict[str, int]
    cpu: dict[str, float]


def measure(side: int, seconds: float) -> Iterator[Row]:
    """Yield the windows of a run of `seconds` [s], on `side` x `side` AUTD units."""
    length = max(MIN_WINDOW, seconds / WINDOWS)
    settings = Settings(array=Units(side, side), log=Log(level="error"))
    with ExitStack() as stack:
        server = stack.enter_context(run_server(settings))
        game = stack.enter_context(WorkerProcess("soak_game"))
        game.send(Play(str(server.connection), min(1.0, length / 10.0)))
        begin = time.perf_counter()
        for k in range(max(4, round(seconds / length))):
            before, start = server.usage(), time.perf_counter()
            with ExitStack() as visit:
                if k % VISIT_INTERVAL == 1:
                    killed = visit.enter_context(WorkerProcess("killed_client"))
                    killed.send(Visit(str(server.connection), SCENE))
                game.send(Window(length))
                heard = game.receive(Heard, length + MAX_WAIT)
            after, end = server.usage(), time.perf_counter()
            yield Row(
                t=end - begin,
                heard=heard,
                memory={name: used.memory / 1e6 for name, used in after.items()},
                files={name: used.files for name, used in after.items()},
                cpu={
                    name: (used.cpu - before[name].cpu) / (end - start)
                    for name, used in after.items()
                    if name in before
                },
            )
