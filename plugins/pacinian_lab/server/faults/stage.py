"""A server, a game that makes it sound, and an onlooker: what faults are done to."""

from __future__ import annotations

import json
import math
import subprocess
import sys
import threading
import time
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from pacinian_lab.server.faults.device import BLOCKED, UNPLUGGED
from pacinian_lab.server.faults.raw_client import Peer, Silent
from pacinian_lab.server.faults.solvers import STUCK

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

    from numpy.typing import NDArray

    from pacinian_lab.server.faults.server import Server

POLL = 0.005  # [s]
STEADY = 0.2  # [s] of sound before something is broken
QUIET = 0.1  # [s] of silence that is more than a late renderer's
WAIT = 30.0  # [s] until what should happen has
T = TypeVar("T")


class Times(NamedTuple):
    """Of one fault [s].

    silence: from it to silence. recovery: to sound again, from the fault, or from when it was undone.
    gap: the longest between two frames, where it should sound on; undisturbed: the same just before, when nothing
    was done. note: what else was seen.
    """

    silence: float = math.nan
    recovery: float = math.nan
    gap: float = math.nan
    undisturbed: float = math.nan
    note: str = ""


class Stage:
    """Around a running server; a context manager."""

    def __init__(self, server: Server) -> None:
        self.server = server
        self.game: subprocess.Popen[str] | None = None
        self.answers: list[dict[str, Any]] = []
        """Of the game's requests."""
        self.at = 0.0
        """When it was broken [s]."""
        self._marks = [0] * len(server.logs)
        self._quiet = QUIET
        self._onlooker: Peer | None = None

    @property
    def onlooker(self) -> Peer:
        """Another client, with a session."""
        if self._onlooker is not None and self._onlooker.session:
            self._onlooker.drain()
            try:
                if self._onlooker.ask("status", 1.0)["type"] == "state":
                    return self._onlooker
            except Silent:
                pass
        self.leave()
        self._onlooker = Peer(self.server.file)
        self._onlooker.hello(client="onlooker")
        return self._onlooker

    def play(self, **hide: str) -> None:
        """Start the game. hide: as in `Peer`."""
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
        """Tell the game."""
        if self.game is not None and self.game.stdin is not None:
            self.game.stdin.write(json.dumps({"type": kind, **fields}) + "\n")
            self.game.stdin.flush()

    def select(self, **fields: Any) -> dict[str, Any]:
        """Let the game select; the answer."""
        self.answers.clear()
        self.tell("select", **fields)
        until(lambda: bool(self.answers))
        return self.answers[-1]

    def end(self) -> None:
        """Kill the game at once."""
        if self.game is not None:
            self.game.kill()
            self.game.wait()
            if self.game.stdin is not None:
                self.game.stdin.close()
            self.game = None

    def sounding(self) -> None:
        """Wait until it sounds steadily; from there on events count."""
        if self.game is None:
            self.play()
        since = time.perf_counter()  # what sounded before may be the end of another game

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
        """Of all devices since it sounded, in order."""
        logs = zip(self.server.logs, self._marks, strict=True)
        every = np.concatenate([log.read(mark) for log, mark in logs])
        return every[np.argsort(every["time"], kind="stable")]

    def broken(self, act: Callable[[], object], quiet: float = QUIET) -> float:
        """Do it while it sounds; how long until it is silent, for longer than `quiet` [s]."""
        self.sounding()
        self._quiet = quiet
        self.at = time.perf_counter()
        act()
        return self.quiet() - self.at

    def healed(self, act: Callable[[], object] | None = None, after: float = math.nan) -> float:
        """Undo it; how long until it sounds [s]. after: of the fault [s], when it ends by itself."""
        since = time.perf_counter() if math.isnan(after) else self.at + after
        if act is not None:
            act()
        return self.heard(max(since, self.quiet())) - since

    def quiet(self) -> float:
        """When the sound ended since it was broken [s]; a late renderer's short silences are none."""

        def found() -> float:
            now, events = time.perf_counter(), self.events()
            events = events[events["time"] > self.at]
            ends = events["time"][events["sounds"] == 0]
            starts = np.append(events["time"][events["sounds"] == 1], math.inf)
            after = starts[np.searchsorted(starts, ends)]
            long = ends[np.minimum(after, now) - ends > self._quiet]
            return float(long[0]) if len(long) else 0.0

        return until(found)

    def heard(self, since: float) -> float:
        """When it sounded first after `since` [s]. Raises TimeoutError."""

        def found() -> float:
            events = self.events()
            times = events["time"][(events["time"] > since) & (events["sounds"] == 1)]
            return float(times[0]) if len(times) else 0.0

        return until(found)

    def gap(self, act: Callable[[], object], seconds: float = 1.0) -> float:
        """Do it while it sounds; the longest time without a frame from then to `seconds` [s] after [s]."""
        self.sounding()
        self.at = time.perf_counter()
        act()
        time.sleep(max(0.0, self.at + seconds - time.perf_counter()))
        events = self.events()
        times = events["time"][events["sounds"] == 1]
        times = times[times > self.at - 0.01]
        return float(np.diff(times, append=time.perf_counter()).max())

    def leave(self) -> None:
        """The onlooker goes."""
        if self._onlooker is not None:
            self._onlooker.close()
            self._onlooker = None

    def close(self) -> None:
        """End the game; nothing is blocked, unplugged or stuck."""
        self.end()
        self.leave()
        for name in (BLOCKED, UNPLUGGED, STUCK):
            (self.server.folder / name).unlink(missing_ok=True)

    def __enter__(self) -> Stage:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def until(found: Callable[[], T], wait: float = WAIT) -> T:
    """What `found` gives as soon as that is something. Raises TimeoutError after `wait` [s]."""
    end = time.perf_counter() + wait
    while not (value := found()):
        if time.perf_counter() > end:
            raise TimeoutError(f"nothing within {wait:g} s")
        time.sleep(POLL)
    return value
