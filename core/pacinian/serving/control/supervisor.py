"""The server's other processes: started, watched, started again when they end or hang, ended in order."""

from __future__ import annotations

import contextlib
import math
import subprocess
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from pacinian.errors import ServerError
from pacinian.serving.ipc.child_process import MAX_LOOK_GAP, compute_hang_limit

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import IO

CHILDREN = "guard", "bus", "render"  # in the order in which they are started
GUARD, SPARE = "guard", "spare"  # of which there is another, which waits to be called
ENDED = "render", "bus", "guard"  # the device is silenced last, when nothing can sound any more
STARTING = 120.0  # [s] until the first sign of life: other processes may have the processors
FIRST, LONGEST = 0.05, 5.0  # [s] from an end to a new start, twice as long each time
WELL = 10.0  # [s] after which one that lives is trusted again
MAX_END_TIME = 3.0  # [s] in which one that was asked to end must have ended


class Process(Protocol):
    """What is needed of `subprocess.Popen`."""

    @property
    def pid(self) -> int:
        """Its number."""
        ...

    @property
    def stdin(self) -> IO[bytes] | None:
        """Closed, it ends by itself."""
        ...

    def poll(self) -> int | None:
        """Its exit code; None while it runs."""
        ...

    def call(self) -> None:
        """Let a spare begin; returns at once."""
        ...

    def kill(self) -> None:
        """End it, whatever it does."""
        ...

    def wait(self, timeout: float | None = None) -> int:
        """Until it has ended."""
        ...


@dataclass
class Child:
    """One process.

    started: when, or called [s]. patience: until its first sign of life [s]. due: when it is to be started again [s].
    wait: that long after its end [s]. beat: its last sign of life [s]; heard: how long it had been looked after by
    then [s].
    """

    name: str
    process: Process
    started: float
    patience: float = STARTING
    due: float | None = None
    wait: float = FIRST
    restarts: int = 0
    beat: float = 0.0
    heard: float = 0.0


class Supervisor:
    """Starts the children and keeps them running.

    start: starts one by name; a spare with the number of the process that it is of, others with 0. hung: time without
    a sign of life after which one is killed [s]. trusted: they have been ready once; before, one that ends is an error,
    as it will most likely end again.

    That time is what was spent looking after it: where the whole machine stood still, or this process did not get a
    processor, the others' silence proves nothing. (That the array is silent then, the permit's deadline sees to.)

    Of the guard there is a spare from when they are trusted: it takes over as soon as the guard has ended, and the next
    spare is started once it has given a sign of life (decision 35).
    """

    def __init__(
        self,
        start: Callable[[str, int], Process],
        hung: float,
        clock: Callable[[], float] = time.perf_counter,
        names: Iterable[str] = CHILDREN,
    ) -> None:
        self._start, self._hung, self._clock = start, hung, clock
        self.trusted = False
        self._last = clock()  # [s] of the last look
        self._watched = 0.0  # [s]
        self._spare: Child | None = None
        self._spare_due = 0.0  # [s] when it is to be started
        self.children: dict[str, Child] = {}
        try:
            for name in names:
                self.children[name] = Child(name, start(name, 0), clock())
        except BaseException:
            self.end()
            raise

    @property
    def restarts(self) -> dict[str, int]:
        """How often each was started again."""
        return {name: child.restarts for name, child in self.children.items()}

    @property
    def ended(self) -> bool:
        """Whether one has ended that `check` does not know of, or the spare can take over: ask it at once."""
        return any(
            (child.due is None or (child.name == GUARD and self._spare is not None))
            and child.process.poll() is not None
            for child in self.children.values()
        )

    def alive(self, name: str, beat: float) -> bool:
        """Whether a sign of life, of `beat` [s], is of the process that runs now."""
        child = self.children[name]
        return child.due is None and beat >= child.started

    def check(self, beats: dict[str, float], sound: bool = False) -> list[tuple[str, str]]:
        """Look after all, given their last signs of life [s]; return who has ended, and why. Raises ServerError.

        sound: there may be some.
        """
        ended: list[tuple[str, str]] = []
        now = self._clock()
        self._watched += min(now - self._last, MAX_LOOK_GAP)
        self._last = now
        for name, child in self.children.items():
            now = self._clock()
            hung = compute_hang_limit(self._hung, sound=sound and name == GUARD)
            if child.due is not None:
                why = self._again(child, now)
            elif why := self._ended(child, beats.get(name, 0.0), hung, now):
                if not self.trusted:
                    raise ServerError(f"the process {name!r} {why} before the server was ready")
                if now - child.started > WELL:
                    child.wait = FIRST
            if why:
                child.due, child.wait = now + child.wait, min(LONGEST, 2.0 * child.wait)
                ended.append((name, why))
                self._again(child, now)  # one that has a spare
        if self.trusted and (why := self._look_after_spare(beats)):
            ended.append((SPARE, why))
        return ended

    def _look_after_spare(self, beats: dict[str, float]) -> str:
        """Start it if it is time; return why there is none."""
        guard, now = self.children[GUARD], self._clock()
        if self._spare is None:
            if now < self._spare_due or not self.alive(GUARD, beats.get(GUARD, 0.0)):
                return ""
            try:
                self._spare = Child(SPARE, self._start(SPARE, guard.process.pid), now)
            except (OSError, ServerError) as error:
                why = f"could not be started: {error}"
            else:
                return ""
        elif not (why := self._ended(self._spare, now, math.inf, now)):
            return ""
        self._spare, self._spare_due = None, now + guard.wait
        guard.wait = min(LONGEST, 2.0 * guard.wait)
        return why

    def _again(self, child: Child, now: float) -> str:
        """Start it again if it is time, and the old one has ended; return why it cannot be."""
        if child.due is None or child.process.poll() is None:
            return ""
        spare = self._spare if child.name == GUARD else None
        if spare is not None and spare.process.poll() is None:
            child.process, self._spare, self._spare_due = spare.process, None, child.due
            child.patience = self._hung if now - spare.started > WELL else STARTING
            child.process.call()
        elif now < child.due:
            return ""
        else:
            try:
                child.process, child.patience = self._start(child.name, 0), STARTING
            except (OSError, ServerError) as error:
                return f"could not be started: {error}"
        child.started, child.due, child.heard = now, None, self._watched
        child.restarts += 1
        return ""

    def _ended(self, child: Child, beat: float, hung: float, now: float) -> str:
        if (code := child.process.poll()) is not None:
            _closed(child.process)
            return f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
        seen = beat >= child.started
        if beat != child.beat:
            child.beat, child.heard = beat, self._watched
        if self._watched - child.heard <= (hung if seen else child.patience):
            return ""
        _killed(child.process)
        return "hung, and was killed" if seen else "did not start, and was killed"

    def end(self) -> list[str]:
        """End all, in order; return the names of those that had to be killed."""
        killed: list[str] = []
        if self._spare is not None:  # which has no device
            _killed(self._spare.process)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._spare.process.wait(MAX_END_TIME)
        rest = [name for name in self.children if name not in ENDED]
        for name in [*ENDED, *rest]:
            child = self.children.get(name)
            if child is None or child.process.poll() is not None:
                if child is not None:
                    _closed(child.process)
                continue
            _closed(child.process)
            try:
                child.process.wait(MAX_END_TIME)
            except subprocess.TimeoutExpired:
                _killed(child.process)
                killed.append(name)
                with contextlib.suppress(subprocess.TimeoutExpired):  # the system holds it
                    child.process.wait(MAX_END_TIME)
        return killed


def _closed(process: Process) -> None:
    with contextlib.suppress(OSError):
        if process.stdin is not None:
            process.stdin.close()


def _killed(process: Process) -> None:
    """It ends when the system lets it."""
    process.kill()
    _closed(process)
