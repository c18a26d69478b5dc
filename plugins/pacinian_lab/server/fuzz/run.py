"""Alternate between flooding a server that sounds and loading the machine as much without sending."""

from __future__ import annotations

import math
import re
import socket
import tempfile
import time
import urllib.request
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pacinian_lab.server.faults.rig import Rig
from pacinian_lab.server.faults.server import Server
from pacinian_lab.server.fuzz.observer import Phase, Watch

if TYPE_CHECKING:
    from collections.abc import Callable

SHARES = {"command": 0.6, "control": 0.3, "raw": 0.1}  # fractions of the messages
BUSY = len(SHARES) + 2  # processes that a flood keeps busy: the senders, control and the bus
CHUNK = 200_000  # messages between two control runs
CONFIGURATION = """[clients]
max_rate = 1e6
[metrics]
port = {port}
"""  # the high rate limit makes the server decode the messages, not only count them
COUNT = re.compile(r"^pacinian_control_(\w+)_total (\S+)$", re.MULTILINE)


@dataclass
class Found:
    """Results of a run.

    growth: of memory, late minus early; memory: maximum; both by process [bytes]. same: no process was replaced.
    ended: exit code after SIGTERM. counts: counters of the control process, as in its metrics.
    """

    flooded: Phase
    burdened: Phase
    idle: Phase
    growth: dict[str, float]
    memory: dict[str, float]
    same: bool
    ended: int
    counts: dict[str, int]

    @property
    def messages(self) -> int:
        """Number of messages sent."""
        return self.flooded.sent.total()


def run(
    messages: int,
    seconds: float,
    seed: int,
    tell: Callable[[int], object] = lambda done: None,
) -> Found:
    """Send `messages` messages within about `seconds` [s]. Returns the results."""
    flooded, burdened, idle = Phase("flooded"), Phase("equal CPU load"), Phase("idle")
    port = _free()
    with (
        tempfile.TemporaryDirectory(prefix="pacinian-hostile-") as folder,
        Server(Path(folder), CONFIGURATION.format(port=port)) as server,
        Rig(server) as rig,
    ):
        rig.wait_for_sound()
        watch, end = Watch(rig), time.perf_counter() + seconds
        watch.phase(idle, {}, seed, min(3.0, 0.1 * seconds))
        while (done := flooded.sent.total()) < messages and time.perf_counter() < end:
            todo = min(CHUNK, messages - done)
            left, before = end - time.perf_counter(), flooded.seconds
            floods = {kind: math.ceil(share * todo) for kind, share in SHARES.items()}
            watch.phase(flooded, floods, seed + done, left)
            took = flooded.seconds - before
            watch.phase(burdened, {"burn": 1 << 60}, seed, min(5.0, 0.3 * took), BUSY)
            tell(flooded.sent.total())
        same, growth = watch.same, watch.growth()
        memory = {name: float(max(values)) for name, values in watch.memory.items()}
        counts = _counts(port)
        rig.close()
        ended = server.terminate()
    return Found(flooded, burdened, idle, growth, memory, same, ended, counts)


def _free() -> int:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return int(probe.getsockname()[1])


def _counts(port: int) -> dict[str, int]:
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=5.0) as answer:
        text = answer.read().decode()
    return {name: int(float(value)) for name, value in COUNT.findall(text)}
