"""The server's other processes: started, watched, started again when they end or hang, ended in order."""

from __future__ import annotations

import contextlib
import subprocess
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from pacinian.errors import ServerError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import IO

CHILDREN = "guard", "bus", "render"  # in the order in which they are started
ENDED = "render", "bus", "guard"  # the device is silenced last, when nothing can sound any more
STARTING = 300.0  # [s] until the first sign of life: kernels may be compiled first
FIRST, LONGEST = 0.05, 5.0  # [s] from an end to a new start, twice as long each time
WELL = 10.0  # [s] after which one that lives is trusted again
PATIENCE = 3.0  # [s] in which one that was asked to end must have ended
LATE = (
    0.1  # [s] that count at most between two looks: who was late himself cannot tell who is silent
)


class Process(Protocol):
    """What is needed of `subprocess.Popen`."""

    @property
    def stdin(self) -> IO[bytes] | None:
        """Closed, it ends by itself."""
        ...

    def poll(self) -> int | None:
        """Its exit code; None while it runs."""
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

    started: when [s]. due: when it is to be started again [s]. wait: that long after its end [s]. beat: its last sign
    of life [s]; heard: how long it had been looked after by then [s].
    """

    name: str
    process: Process
    started: float
    due: float | None = None
    wait: float = FIRST
    restarts: int = 0
    beat: float = 0.0
    heard: float = 0.0


class Supervisor:
    """Starts the children and keeps them running.

    start: starts one by name. hung: time without a sign of life after which one is killed [s]. trusted: they have been
    ready once; before, one that ends is an error, as it will most likely end again.

    That time is what was spent looking after it: where the whole machine stood still, or this process did not get a
    processor, the others' silence proves nothing. (That the array is silent then, the permit's deadline sees to.)
    """

    def __init__(
        self,
        start: Callable[[str], Process],
        hung: float,
        clock: Callable[[], float] = time.perf_counter,
        names: Iterable[str] = CHILDREN,
    ) -> None:
        self._start, self._hung, self._clock = start, hung, clock
        self.trusted = False
        self._last = clock()  # [s] of the last look
        self._watched = 0.0  # [s]
        self.children: dict[str, Child] = {}
        try:
            for name in names:
                self.children[name] = Child(name, start(name), clock())
        except BaseException:
            self.end()
            raise

    @property
    def restarts(self) -> dict[str, int]:
        """How often each was started again."""
        return {name: child.restarts for name, child in self.children.items()}

    def alive(self, name: str, beat: float) -> bool:
        """Whether a sign of life, of `beat` [s], is of the process that runs now."""
        child = self.children[name]
        return child.due is None and beat >= child.started

    def check(self, beats: dict[str, float]) -> list[tuple[str, str]]:
        """Look after all, given their last signs of life [s]; return who has ended, and why. Raises ServerError."""
        ended: list[tuple[str, str]] = []
        now = self._clock()
        self._watched += min(now - self._last, LATE)
        self._last = now
        for name, child in self.children.items():
            now = self._clock()
            if child.due is not None:
                why = self._again(child, now)
            elif why := self._ended(child, beats.get(name, 0.0), now):
                if not self.trusted:
                    raise ServerError(f"the process {name!r} {why} before the server was ready")
                if now - child.started > WELL:
                    child.wait = FIRST
            if why:
                child.due, child.wait = now + child.wait, min(LONGEST, 2.0 * child.wait)
                ended.append((name, why))
        return ended

    def _again(self, child: Child, now: float) -> str:
        """Start it again if it is time, and the old one has ended; return why it cannot be."""
        if child.due is None or now < child.due or child.process.poll() is None:
            return ""
        try:
            child.process = self._start(child.name)
        except (OSError, ServerError) as error:
            return f"could not be started: {error}"
        child.started, child.due, child.heard = now, None, self._watched
        child.restarts += 1
        return ""

    def _ended(self, child: Child, beat: float, now: float) -> str:
        if (code := child.process.poll()) is not None:
            _closed(child.process)
            return f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
        seen = beat >= child.started
        if beat != child.beat:
            child.beat, child.heard = beat, self._watched
        if self._watched - child.heard <= (self._hung if seen else STARTING):
            return ""
        _killed(child.process)
        return "hung, and was killed" if seen else "did not start, and was killed"

    def end(self) -> list[str]:
        """End all, in order; return the names of those that had to be killed."""
        killed: list[str] = []
        rest = [name for name in self.children if name not in ENDED]
        for name in [*ENDED, *rest]:
            child = self.children.get(name)
            if child is None or child.process.poll() is not None:
                if child is not None:
                    _closed(child.process)
                continue
            _closed(child.process)
            try:
                child.process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                _killed(child.process)
                killed.append(name)
                with contextlib.suppress(subprocess.TimeoutExpired):  # the system holds it
                    child.process.wait(PATIENCE)
        return killed


def _closed(process: Process) -> None:
    with contextlib.suppress(OSError):
        if process.stdin is not None:
            process.stdin.close()


def _killed(process: Process) -> None:
    """It ends when the system lets it."""
    process.kill()
    _closed(process)
