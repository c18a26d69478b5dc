"""How a spare guard waits: until the guard has ended, which it sees to itself where that hangs (decision 35)."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
import time
from typing import TYPE_CHECKING

from pacinian.serving.ipc.child_process import MAX_LOOK_GAP, compute_hang_limit

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.serving.ipc.child_process import Parent

LOOK, IDLE = 0.02, 0.1  # [s] between two looks at the guard, while there may be sound and otherwise


class HangDetector:
    """Whether the guard hangs. limit: time without a sign of life while there may be sound [s], as in `Supervisor`."""

    def __init__(self, limit: float) -> None:
        self._limit = limit
        self._beat = self._silent = 0.0  # [s]: the last sign of life; looked on since then
        self._last = -1.0  # [s] the last look

    def missed(self, beat: float, sound: bool, now: float) -> bool:
        """Look at its last sign of life, `beat` [s], at `now` [s]. sound: there may be some."""
        self._silent += min(now - self._last, MAX_LOOK_GAP)
        self._last = now
        if beat != self._beat or not sound:
            self._beat, self._silent = beat, 0.0
        return self._silent > self._limit


def stand_by(parent: Parent, hung: float, look: Callable[[], tuple[float, bool]]) -> None:
    """Return when this spare is to take over: it is called, or the guard has ended.

    hung: as in the settings [s]. look: at the guard's last sign of life [s], and whether there may be sound. Where the
    system cannot tell of another process's end, the parent alone does. Raises SystemExit when the parent has gone.
    """
    if sys.platform != "linux":
        parent.wait()
        return
    try:
        guard = os.pidfd_open(parent.told.spare)
    except OSError:  # it is gone already, and the parent knows
        parent.wait()
        return
    pulse, poll = HangDetector(compute_hang_limit(hung, sound=True)), select.poll()
    poll.register(guard, select.POLLIN)
    poll.register(parent.pipe, select.POLLIN)
    sound = False
    while not (ready := poll.poll(1e3 * (LOOK if sound else IDLE))):
        beat, sound = look()
        if pulse.missed(beat, sound, time.perf_counter()):
            with contextlib.suppress(OSError):
                signal.pidfd_send_signal(guard, signal.SIGKILL)
    if parent.pipe in dict(ready):
        parent.wait()
    os.close(guard)
