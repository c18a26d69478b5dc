"""How a spare guard waits: until the guard has ended. It kills a guard that hangs (decision 35)."""

from __future__ import annotations

import contextlib
import math
import os
import select
import signal
import sys
import time
from typing import TYPE_CHECKING

from pacinian.serving.ipc.hang_detection import WatchedTime, compute_sounding_hang_limit

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.serving.ipc.parent_link import Parent

# Interval between two checks of the guard, while there may be sound and otherwise [s].
CHECK_INTERVAL, IDLE_INTERVAL = 0.02, 0.1


class HangDetector:
    """Detects a guard that hangs. limit: time without a heartbeat while there may be sound [s], as in `Supervisor`."""

    def __init__(self, limit: float) -> None:
        self._limit = limit
        self._watched = WatchedTime(-math.inf)
        self._heartbeat = 0.0  # the last one [s]
        self._heard = 0.0  # time watched until it came [s]

    def detect_hang(self, heartbeat: float, sound: bool, now: float) -> bool:
        """Check the last `heartbeat` [s] at `now` [s]; return whether the guard hangs.

        sound: whether there may be sound.
        """
        self._watched.advance(now)
        if heartbeat != self._heartbeat or not sound:
            self._heartbeat, self._heard = heartbeat, self._watched.seconds
        return self._watched.seconds - self._heard > self._limit


def stand_by(parent: Parent, hang_timeout: float, look: Callable[[], tuple[float, bool]]) -> None:
    """Return when this spare must take over: the parent activates it, or the guard has ended.

    hang_timeout: as in the settings [s]. look: returns the guard's last heartbeat [s] and whether there may be sound.
    Where the system cannot report the end of another process, this waits for the parent only. Raises SystemExit when
    the parent has gone.
    """
    if sys.platform != "linux":
        parent.wait()
        return
    try:
        guard = os.pidfd_open(parent.config.spare)
    except OSError:  # the guard has ended already, and the parent knows it
        parent.wait()
        return
    detector, poll = HangDetector(compute_sounding_hang_limit(hang_timeout)), select.poll()
    poll.register(guard, select.POLLIN)
    poll.register(parent.pipe, select.POLLIN)
    sound = False
    while not (ready := poll.poll(1e3 * (CHECK_INTERVAL if sound else IDLE_INTERVAL))):
        heartbeat, sound = look()
        if detector.detect_hang(heartbeat, sound, time.perf_counter()):
            with contextlib.suppress(OSError):
                signal.pidfd_send_signal(guard, signal.SIGKILL)
    if parent.pipe in dict(ready):
        parent.wait()
    os.close(guard)
