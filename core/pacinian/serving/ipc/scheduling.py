"""Priorities, the real-time class and CPU affinity of the server's processes, as far as the system permits them."""

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

TIMERSLACK = 29  # number of PR_SET_TIMERSLACK, an option of Linux's prctl
AUTOGROUP = Path("/proc/self/autogroup")  # exists where Linux groups processes by session
URGENT = 15  # niceness -15: 97 % of a core shared with one normal process
EAGER = 5  # niceness -5: 75 % of a core shared with one normal process
ANY_CORE = -1  # number that stands for any core
_ALLOWED = frozenset(os.sched_getaffinity(0)) if sys.platform == "linux" else frozenset[int]()


def raise_priority(by: int = URGENT) -> None:
    """Raise the priority of this process, and ask for precise timers, where the system permits it.

    by: lowers niceness to `-by`, whatever the parent's is; 0 is normal. If the system permits less, the most permitted
    is used. Linux compares niceness within a session only; sessions are compared by autogroup, which this sets if the
    process leads its session, as each child does (sched(7)).
    """
    ask_for_precise_timers()
    for level in (by, min(by, _find_highest_priority())):
        with contextlib.suppress(AttributeError, OSError):
            os.setpriority(os.PRIO_PROCESS, 0, -level)
            break
    if sys.platform == "linux" and os.getsid(0) == os.getpid():
        with contextlib.suppress(OSError):
            AUTOGROUP.write_text(f"{-level}")


def ask_for_precise_timers() -> None:
    """On Linux, let waits of this thread end up to 1 us late, not 50 us. Its threads and children inherit that."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(TIMERSLACK, 1000)  # [ns]


def lower_child_priority(child: int) -> None:
    """Give a newly started process this one's priority, at most `EAGER`, until it is ready and calls `raise_priority`.

    Only on Linux, and only where the child can raise its priority again. Its session gets that priority among sessions.
    """
    if sys.platform == "linux":
        with contextlib.suppress(OSError):
            given = os.getpriority(os.PRIO_PROCESS, 0)
            if _read_priority_limit() < URGENT:
                os.setpriority(
                    os.PRIO_PROCESS, child, -URGENT - 1
                )  # fails without the privilege, whatever was given
            level = max(given, -EAGER)
            os.setpriority(os.PRIO_PROCESS, child, level)
            if level < 0 and os.getsid(child) == child:
                Path(f"/proc/{child}/autogroup").write_text(f"{level}")


def use_realtime_class() -> int:
    """On Linux, put this thread in the real-time class; its children do not inherit that.

    For a thread that mostly sleeps. Return the core that this thread is bound to, so that other threads can
    `avoid_cores` it (decision 28). Return `ANY_CORE` if the system refuses, or if there is only one core.
    """
    raise_priority()
    if sys.platform == "linux":
        with contextlib.suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(1))
            if len(_ALLOWED) > 1:
                own = sorted(_ALLOWED)[os.getppid() % len(_ALLOWED)]  # differs between servers
                os.sched_setaffinity(0, {own})
                return own
    return ANY_CORE


def avoid_cores(processor: int) -> None:
    """Keep this thread off the core that another thread is bound to."""
    if sys.platform == "linux" and (rest := _ALLOWED - {processor}):
        with contextlib.suppress(OSError):
            os.sched_setaffinity(0, rest)


def start_background_thread(work: Callable[[], object], name: str) -> None:
    """Run `work` in a new thread with priority at most `EAGER`.

    It may use any core, even if this thread is bound to one.
    """

    def run() -> None:
        if sys.platform == "linux":
            with contextlib.suppress(OSError):
                os.sched_setaffinity(0, _ALLOWED)
                os.setpriority(os.PRIO_PROCESS, 0, max(os.getpriority(os.PRIO_PROCESS, 0), -EAGER))
        work()

    threading.Thread(target=run, name=name, daemon=True).start()


def _find_highest_priority() -> int:
    """Return the highest priority available without a privilege: the current one, or up to the limit on niceness."""
    return (
        max(0, _read_priority_limit(), -os.getpriority(os.PRIO_PROCESS, 0))
        if sys.platform == "linux"
        else 0
    )


def _read_priority_limit() -> int:
    import resource

    return resource.getrlimit(resource.RLIMIT_NICE)[0] - 20
