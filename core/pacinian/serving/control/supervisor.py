"""The supervisor: starts the server's other processes, restarts those that end or hang, and ends them in order."""

from __future__ import annotations

import contextlib
import math
import subprocess
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from pacinian.errors import ServerError
from pacinian.serving.ipc.hang_detection import WatchedTime, compute_sounding_hang_limit
from pacinian.serving.ipc.logs import log
from pacinian.serving.ipc.processes import Child

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

START_ORDER = "guard", "bus", "render"  # the processes, in the order in which they start
# Names of the guard, and of its spare, which waits to be activated.
GUARD, SPARE = "guard", "spare"
# The processes in the order in which they end. The guard is last, because the device is silenced last.
END_ORDER = "render", "bus", "guard"
# Time limit for the first heartbeat of a process [s]. It is long because other processes may occupy the CPUs.
MAX_FIRST_HEARTBEAT_TIME = 120.0
# Time after which the log names a process that has not sent its first heartbeat [s].
SLOW_START_TIME = 10.0
# Time limit for the first heartbeat of a spare that takes over soon after its start, while the device may sound [s].
MAX_SOUNDING_START_TIME = 5.0
# Delay from the end of a process to its restart: first, and largest value. It doubles each time [s].
MIN_RESTART_DELAY, MAX_RESTART_DELAY = 0.05, 5.0
# Time after which a running process is trusted again [s].
BACKOFF_RESET_TIME = 10.0
MAX_END_TIME = 3.0  # time limit for a process to end after it was asked to [s]
# Time limit for another guard to take over the device, at the end of the server [s].
MAX_TAKEOVER_TIME = 5.0
POLL_INTERVAL = 0.01  # interval between two checks whether a new guard has opened the device [s]


class SupervisedChild(Child, Protocol):
    """The part of `launched_child.LaunchedChild` that the supervisor needs."""

    def activate(self) -> None:
        """Let a spare begin; returns at once."""
        ...

    def close(self) -> None:
        """Close its standard input, which ends the process. For the end of the server."""
        ...


@dataclass
class ChildRecord:
    """What the supervisor knows of one process.

    started: when it was started, or activated if it was a spare [s]. start_limit: time limit for its first heartbeat
    [s]. due: when to restart it [s]; None while it runs. delay: time from its next end to its restart [s]. heartbeat:
    time of its last heartbeat [s]. heard: time watched until that heartbeat was noticed [s]. named: whether the log
    has named it because it starts slowly. sounded: whether there may have been sound since it started. If so, its end
    does not lengthen the restart delay, because a device without a watchdog sounds until the next guard opens it.
    """

    name: str
    process: SupervisedChild
    started: float
    start_limit: float = MAX_FIRST_HEARTBEAT_TIME
    due: float | None = None
    delay: float = MIN_RESTART_DELAY
    restarts: int = 0
    heartbeat: float = 0.0
    heard: float = 0.0
    named: bool = False
    sounded: bool = False


class Supervisor:
    """Starts the child processes and keeps them running.

    start_child: starts a process by name; its second argument is the process id to stand by for (a spare), or 0.
    hang_timeout: time without a heartbeat after which a process is killed [s]. trusted: whether all have been ready
    once. Until then, the end of a process is an error, because it would most likely end again. plugins: the plug-in
    that a process starts with, by process, for messages.

    Only time spent watching counts towards `hang_timeout`. If the whole machine stood still, or this process got no
    CPU, missing heartbeats prove nothing. (The permit's deadline silences the array in that case.)

    Once the processes are trusted, the guard has a spare. It takes over as soon as the guard has ended. The next spare
    is started after the new guard's first heartbeat (decision 35).
    """

    def __init__(
        self,
        start_child: Callable[[str, int], SupervisedChild],
        hang_timeout: float,
        clock: Callable[[], float] = time.perf_counter,
        plugins: Mapping[str, str] | None = None,
    ) -> None:
        self._plugins = plugins or {}
        self._start_child, self._hang_timeout, self._clock = start_child, hang_timeout, clock
        self.trusted = False
        self._watched = WatchedTime(clock())
        self._spare: ChildRecord | None = None
        self._spare_due = 0.0  # when to start the spare [s]
        self.children: dict[str, ChildRecord] = {}
        try:
            for name in START_ORDER:
                self.children[name] = ChildRecord(name, start_child(name, 0), clock())
        except BaseException:
            self.end()
            raise

    @property
    def restarts(self) -> dict[str, int]:
        """Number of restarts of each process."""
        return {name: child.restarts for name, child in self.children.items()}

    @property
    def ended(self) -> bool:
        """Whether a process has ended unnoticed by `check`, or the spare can take over: call `check` at once."""
        return any(
            (child.due is None or (child.name == GUARD and self._spare is not None))
            and child.process.poll() is not None
            for child in self.children.values()
        )

    def is_alive(self, name: str, heartbeat: float) -> bool:
        """Return whether the `heartbeat` [s] comes from the current process of that name."""
        child = self.children[name]
        return child.due is None and heartbeat >= child.started

    def check(self, heartbeats: dict[str, float], sound: bool = False) -> list[tuple[str, str]]:
        """Check all processes, given their last heartbeats [s]; return the names of those that ended, with reasons.

        sound: whether there may be sound. Raises ServerError if a process ends before all were ready.
        """
        ended: list[tuple[str, str]] = []
        self._watched.advance(self._clock())
        for name, child in self.children.items():
            now = self._clock()
            limit = self._hang_timeout
            if sound and name == GUARD:
                limit, child.sounded = compute_sounding_hang_limit(limit), True
            if child.due is not None:
                why = self._restart_or_promote_spare(child, now)
            elif why := self._check_child(child, heartbeats.get(name, 0.0), limit):
                if not self.trusted:
                    plugin = self._plugins.get(name)
                    starts = f", which starts {plugin}," if plugin else ""
                    raise ServerError(
                        f"the process {name!r}{starts} {why} before the server was ready"
                    )
                if now - child.started > BACKOFF_RESET_TIME:
                    child.delay = MIN_RESTART_DELAY
            if why:
                if child.due is None and child.sounded:
                    child.due = now + MIN_RESTART_DELAY
                else:
                    child.due = now + child.delay
                    child.delay = min(MAX_RESTART_DELAY, 2.0 * child.delay)
                ended.append((name, why))
                self._restart_or_promote_spare(child, now)  # the spare takes over at once
        if self.trusted and (why := self._look_after_spare(heartbeats)):
            ended.append((SPARE, why))
        return ended

    def _look_after_spare(self, heartbeats: dict[str, float]) -> str:
        """Start the spare if it is due; return why there is none."""
        guard, now = self.children[GUARD], self._clock()
        if self._spare is None:
            if now < self._spare_due or not self.is_alive(GUARD, heartbeats.get(GUARD, 0.0)):
                return ""
            try:
                self._spare = ChildRecord(SPARE, self._start_child(SPARE, guard.process.pid), now)
            except (OSError, ServerError) as error:
                why = f"could not be started: {error}"
            else:
                return ""
        elif not (why := self._check_child(self._spare, now, math.inf)):
            return ""
        self._spare, self._spare_due = None, now + guard.delay
        guard.delay = min(MAX_RESTART_DELAY, 2.0 * guard.delay)
        return why

    def _restart_or_promote_spare(self, child: ChildRecord, now: float) -> str:
        """Restart a process if it is due and the old one has ended; return why that failed, or ""."""
        if child.due is None or child.process.poll() is None:
            return ""
        spare = self._spare if child.name == GUARD else None
        if spare is not None and spare.process.poll() is None:
            child.process = spare.process
            self._spare, self._spare_due = None, child.due
            if now - spare.started > BACKOFF_RESET_TIME:  # it has loaded everything
                child.start_limit = self._hang_timeout
            elif child.sounded:  # the device of the last guard may sound meanwhile
                child.start_limit = max(self._hang_timeout, MAX_SOUNDING_START_TIME)
            else:
                child.start_limit = MAX_FIRST_HEARTBEAT_TIME
            child.process.activate()
        elif now < child.due:
            return ""
        else:
            try:
                child.process = self._start_child(child.name, 0)
            except (OSError, ServerError) as error:
                return f"could not be started: {error}"
            child.start_limit = MAX_FIRST_HEARTBEAT_TIME
        child.started, child.due, child.heard = now, None, self._watched.seconds
        child.named = child.sounded = False
        child.restarts += 1
        return ""

    def _check_child(self, child: ChildRecord, heartbeat: float, limit: float) -> str:
        if (code := child.process.poll()) is not None:
            return f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
        seen = heartbeat >= child.started
        if heartbeat != child.heartbeat:
            child.heartbeat, child.heard = heartbeat, self._watched.seconds
        waited = self._watched.seconds - child.heard
        if waited > SLOW_START_TIME and not (seen or child.named):
            child.named = True
            log().warning(
                "a process starts slowly",
                name=child.name,
                plugin=self._plugins.get(child.name, "none"),
                waited=f"{waited:.0f} s",
                limit=f"{child.start_limit:g} s",
            )
        if waited <= (limit if seen else child.start_limit):
            return ""
        child.process.kill()
        return "hung, and was killed" if seen else "did not start, and was killed"

    def end(self, has_device: Callable[[float], bool] = lambda since: True) -> list[str]:
        """End all processes in order; return the names of those that had to be killed.

        has_device: returns whether a guard has reported, after the given time [s], that it has opened the device. To
        open the device is to silence it. If the guard has not ended in order, its spare, or a new guard, opens the
        device once more. Raises ServerError if it cannot: the device may still sound.
        """
        killed = self._end_children()
        guard = self.children.get(GUARD)
        silenced = guard is None or not self.trusted or guard.process.poll() == 0
        if guard is not None and not silenced:
            silenced = self._silence_again(guard, has_device)
        if self._spare is not None:
            self._spare.process.kill()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._spare.process.wait(MAX_END_TIME)
        if not silenced:
            raise ServerError("the device may still sound, and cannot be reached: switch it off")
        return killed

    def _silence_again(self, guard: ChildRecord, has_device: Callable[[float], bool]) -> bool:
        """Let another guard open the device, and end it; return whether it has ended in order."""
        if guard.process.poll() is None:
            return False  # the system does not let it end
        since, guard.due = self._clock(), -math.inf
        try:
            if self._restart_or_promote_spare(guard, since):
                return False
            due = self._clock() + MAX_TAKEOVER_TIME
            while not (opened := has_device(since)) and guard.process.poll() is None:
                if self._clock() >= due:
                    break
                time.sleep(POLL_INTERVAL)
            guard.process.close()
            return guard.process.wait(MAX_END_TIME) == 0 and opened
        except subprocess.TimeoutExpired:
            guard.process.kill()
            return False

    def _end_children(self) -> list[str]:
        """End all processes but the spare, in order; return the names of those that had to be killed."""
        killed: list[str] = []
        for name in END_ORDER:
            child = self.children.get(name)
            if child is None or child.process.poll() is not None:
                continue
            child.process.close()
            try:
                child.process.wait(MAX_END_TIME)
            except subprocess.TimeoutExpired:
                child.process.kill()
                killed.append(name)
                # The system does not let it end.
                with contextlib.suppress(subprocess.TimeoutExpired):
                    child.process.wait(MAX_END_TIME)
        return killed
