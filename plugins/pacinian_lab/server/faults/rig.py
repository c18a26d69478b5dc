"""The test rig for faults: a server, a game that makes it sound, and an onlooker."""

from __future__ import annotations

import json
import math
import subprocess
import sys
import threading
import time
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from pacinian.closeable import Closeable
from pacinian_lab.server.faults.hanging_solver import STUCK
from pacinian_lab.server.faults.logging_device import BLOCKED, UNPLUGGED
from pacinian_lab.server.faults.misbehaving_client import MisbehavingClient, Silent

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from pacinian_lab.server.faults.server import Server

POLL = 0.005  # [s]
STEADY = 0.2  # [s] of sound before a fault
QUIET = 0.1  # [s] of silence; shorter silences are a late renderer's
WAIT = 30.0  # [s] longest wait for an expected event
T = TypeVar("T")


class Times(NamedTuple):
    """Times of one fault [s].

    silence: from the fault to silence. recovery: until sound, from the fault or from its undoing. gap: the longest
    time between two frames, for faults during which the output should continue; undisturbed: the same just before,
    without a fault. note: other observations.
    """

    silence: float = math.nan
    recovery: float = math.nan
    gap: float = math.nan
    undisturbed: float = math.nan
    note: str = ""


class Rig(Closeable):
    """Runs a game and an onlooker on a running server; a context manager."""

    def __init__(self, server: Server) -> None:
        self.server = server
        self.game: subprocess.Popen[str] | None = None
        self.answers: list[dict[str, Any]] = []
        """Answers to the game's requests."""
        self.at = 0.0
        """Time of the fault [s]."""
        self._marks = [0] * len(server.logs)
        self._quiet = QUIET
        self._onlooker: MisbehavingClient | None = None

    @property
    def onlooker(self) -> MisbehavingClient:
        """A second client, with a session."""
        if self._onlooker is not None and self._onlooker.session:
            self._onlooker.drain()
            try:
                if self._onlooker.ask("status", 1.0)["type"] == "state":
                    return self._onlooker
            except Silent:
                pass
        self.leave()
        self._onlooker = MisbehavingClient(self.server.file)
        self._onlooker.hello(client="onlooker")
        return self._onlooker

    def play(self, **hide: str) -> None:
        """Start the game. hide: as in `MisbehavingClient`."""
        command = [sys.executable, "-m", "pacinian_lab.server.faults.game", str(self.server.file)]
        command += [f"{key}={value}" for key, value in hide.items()]
        self.game = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf-8"
        )
        self.answers = []
        threading.Thread(target=self._hear, args=(self.game, self.answers), daemon=True).start()

    @staticmethod
    def _hear(game: subprocess.Popen[str], answers: list[dict[str, Any]]) -> None:
        if game.stdout is not None:
            with game.stdout as lines:
                for line in lines:
                    answers += [json.loads(line)]

    def tell(self, kind: str, **fields: Any) -> None:
        """Send an order to the game."""
        if self.game is not None and self.game.stdin is not None:
            self.game.stdin.write(json.dumps({"type": kind, **fields}) + "\n")
            self.game.stdin.flush()

    def select(self, **fields: Any) -> dict[str, Any]:
        """Let the game select, and return the answer."""
        self.answers.clear()
        self.tell("select", **fields)
        until(lambda: bool(self.answers))
        return self.answers[-1]

    def end(self) -> None:
        """Kill the game."""
        if self.game is not None:
            self.game.kill()
            self.game.wait()
            if self.game.stdin is not None:
                self.game.stdin.close()
            self.game = None

    def wait_for_sound(self) -> None:
        """Wait until the output sounds steadily. Events count from there on."""
        if self.game is None:
            self.play()
        since = time.perf_counter()  # earlier sound may be the end of another game

        def steady() -> bool:
            now = time.perf_counter()
            if now < since + STEADY:
                return False
            self._marks = [max(0, log.count - int(2e3 * STEADY)) for log in self.server.logs]
            events = self.events()
            late = events[events["time"] > now - STEADY]
            return len(late) > 0.2e3 * STEADY and float(late["sounds"].mean()) > 0.9

        until(steady)

    def events(self) -> NDArray[np.void]:
        """Return the events of all devices since the output sounded, in order."""
        logs = zip(self.server.logs, self._marks, strict=True)
        every = np.concatenate([log.read(mark) for log, mark in logs])
        return every[np.argsort(every["time"], kind="stable")]

    def inject_fault(self, act: Callable[[], object], quiet: float = QUIET) -> float:
        """Inject a fault while the output sounds. Returns the time until silence that lasts longer than `quiet` [s]."""
        self.wait_for_sound()
        self._quiet = quiet
        self.at = time.perf_counter()
        act()
        return self.measure_quiet() - self.at

    def recover(self, act: Callable[[], object] | None = None, after: float = math.nan) -> float:
        """Undo a fault and return the time until sound [s]. after: length of a fault that ends by itself [s]."""
        since = time.perf_counter() if math.isnan(after) else self.at + after
        if act is not None:
            act()
        return self.find_heard(max(since, self.measure_quiet())) - since

    def measure_quiet(self) -> float:
        """Return when the sound ended after the fault [s], ignoring the short silences of a late renderer."""

        def found() -> float:
            now, events = time.perf_counter(), self.events()
            events = events[events["time"] > self.at]
            ends = events["time"][events["sounds"] == 0]
            starts = np.append(events["time"][events["sounds"] == 1], math.inf)
            after = starts[np.searchsorted(starts, ends)]
            long = ends[np.minimum(after, now) - ends > self._quiet]
            return float(long[0]) if len(long) else 0.0

        return until(found)

    def find_heard(self, since: float) -> float:
        """Return when the output first sounded after `since` [s]. Raises TimeoutError."""

        def found() -> float:
            events = self.events()
            times = events["time"][(events["time"] > since) & (events["sounds"] == 1)]
            return float(times[0]) if len(times) else 0.0

        return until(found)

    def measure_gap(self, act: Callable[[], object], seconds: float = 1.0) -> float:
        """Call `act` while the output sounds. Returns the longest time without a frame in the next `seconds` [s]."""
        self.wait_for_sound()
        self.at = time.perf_counter()
        act()
        time.sleep(max(0.0, self.at + seconds - time.perf_counter()))
        events = self.events()
        times = events["time"][events["sounds"] == 1]
        times = times[times > self.at - 0.01]
        return float(np.diff(times, append=time.perf_counter()).max())

    def leave(self) -> None:
        """Close the onlooker."""
        if self._onlooker is not None:
            self._onlooker.close()
            self._onlooker = None

    def close(self) -> None:
        """End the game, and remove the files that block, unplug or hang."""
        self.end()
        self.leave()
        for name in (BLOCKED, UNPLUGGED, STUCK):
            (self.server.folder / name).unlink(missing_ok=True)


def until(found: Callable[[], T]) -> T:
    """Return the value of `found` as soon as it is true. Raises TimeoutError."""
    end = time.perf_counter() + WAIT
    while not (value := found()):
        if time.perf_counter() > end:
            raise TimeoutError(f"nothing within {WAIT:g} s")
        time.sleep(POLL)
    return value
