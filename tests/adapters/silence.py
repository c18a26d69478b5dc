"""When a server's device sounds."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pacinian.bench.faults.device import Log
    from pacinian.bench.faults.server import Server

PATIENCE = 20.0  # [s]


def silent(server: Server, since: float, log: Log | None = None) -> float:
    """When the device was silent for the first time after `since` [s], both of `time.perf_counter`.

    log: of its other device.
    """
    log = log or server.log
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        events = log.read(max(0, log.count - 10_000))
        ends = events["time"][(events["time"] > since) & (events["sounds"] == 0)]
        if len(ends):
            return float(ends[0])
        time.sleep(0.005)
    raise AssertionError("it sounds on")


def heard(server: Server, mark: int) -> bool:
    """Whether the device has sounded since it had told so much."""
    return bool(server.log.read(mark)["sounds"].any())
