"""Who of the server's processes runs before whom, and before all else, and where: as far as the system lets them."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

TIMERSLACK = 29  # of Linux's prctl
AUTOGROUP = Path("/proc/self/autogroup")  # of Linux, where it groups by session
URGENT = 15  # of a processor shared with one usual process it has 97 %
EAGER = 5  # 75 %
ANY = -1  # processor
_ALLOWED = frozenset(os.sched_getaffinity(0)) if sys.platform == "linux" else frozenset[int]()


def raise_priority(by: int = URGENT) -> None:
    """Ask the system to prefer this process, and to wake it in time, where it may be asked.

    by: how much, whatever its parent's; 0 as usual. Where so much is not allowed, as much as is. Linux counts it among
    the threads of a session, and that of the session's leader, as each child is, among sessions (sched(7), autogroup).
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(TIMERSLACK, 1000)  # [ns], in place of 50,000
    for level in (by, min(by, _most())):
        with contextlib.suppress(AttributeError, OSError):
            os.setpriority(os.PRIO_PROCESS, 0, -level)
            break
    if sys.platform == "linux" and os.getsid(0) == os.getpid():
        with contextlib.suppress(OSError):
            AUTOGROUP.write_text(f"{-level}")


def lower_child_priority(child: int) -> None:
    """Let a process that has just been started be `EAGER` at most, until it is ready and asks to be `raise_priority`.

    On Linux; not where it could not ask for it again.
    """
    if sys.platform == "linux":
        with contextlib.suppress(OSError):
            given = os.getpriority(os.PRIO_PROCESS, child)
            if _limit() < URGENT:
                os.setpriority(
                    os.PRIO_PROCESS, child, -URGENT - 1
                )  # which needs a right, whatever was given
            os.setpriority(os.PRIO_PROCESS, child, max(given, -EAGER))


def use_realtime_class() -> int:
    """On Linux, let this thread go before all usual ones, but not what it starts: for one that mostly sleeps.

    Return the core that this thread is bound to, so that other threads can `avoid_cores` it (decision 28). Return `ANY`
    where the system refuses, or where there is only one core.
    """
    raise_priority()
    if sys.platform == "linux":
        with contextlib.suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(1))
            if len(_ALLOWED) > 1:
                own = sorted(_ALLOWED)[os.getppid() % len(_ALLOWED)]  # not the same for all servers
                os.sched_setaffinity(0, {own})
                return own
    return ANY


def avoid_cores(processor: int) -> None:
    """Keep this thread off a processor that another one keeps to."""
    if sys.platform == "linux" and (rest := _ALLOWED - {processor}):
        with contextlib.suppress(OSError):
            os.sched_setaffinity(0, rest)


def start_background_thread(work: Callable[[], object], name: str) -> None:
    """Do work in a thread of its own, on any processor, wherever this one keeps to, and `EAGER` at most."""

    def run() -> None:
        if sys.platform == "linux":
            with contextlib.suppress(OSError):
                os.sched_setaffinity(0, _ALLOWED)
                os.setpriority(os.PRIO_PROCESS, 0, max(os.getpriority(os.PRIO_PROCESS, 0), -EAGER))
        work()

    threading.Thread(target=run, name=name, daemon=True).start()


def _most() -> int:
    """How much may be asked for without a right of its own: what there is already, or up to the limit on niceness."""
    return max(0, _limit(), -os.getpriority(os.PRIO_PROCESS, 0)) if sys.platform == "linux" else 0


def _limit() -> int:
    import resource

    return resource.getrlimit(resource.RLIMIT_NICE)[0] - 20
