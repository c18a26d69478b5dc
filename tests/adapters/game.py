"""A game that is written in another language, and executes commands."""

from __future__ import annotations

import json
import os
import queue
import signal
import subprocess
import threading
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import psutil

import pacinian as pc
from pacinian.wire import commands, control, replies

from ..waiting import PATIENCE, eventually

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path
    from types import TracebackType

    from pacinian.wire.state import State
    from pacinian_lab.server.faults.logging_device import Log
    from pacinian_lab.server.faults.server import Server

    from ..core.client.fake_server import Fake
    from .blockable_link import BlockableLink

HEAVY = 120  # more objects than the sockets take
LEASE = 0.25  # [s], requested by a game whose lease is to end
# of a server: the longest that it may have, so that neither a busy machine nor what ends a session lets a lease end
HELD = "[safety]\nlease = 10.0\nframe_timeout = 1.0\n"
RATE = 125.0  # [Hz] of frames, of which no client knows; at 1 kHz, the server works more than the games


class Game:
    """A process that reads commands, one per line, and prints events as lines of JSON; a context manager."""

    def __init__(
        self, command: Sequence[str | Path], environment: Mapping[str, str] | None = None
    ) -> None:
        self.told: list[dict[str, Any]] = []
        """All that it has told."""
        self._new: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self.process = subprocess.Popen(
            [str(word) for word in command], env=environment, text=True, encoding="utf-8",
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def say(self, line: str) -> None:
        """Send a command, and do not wait."""
        assert self.process.stdin is not None
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def do(self, line: str) -> dict[str, Any]:
        """Send a command, and return its result."""
        self.say(line)
        return self.wait(lambda told: told.get("did") == line.split(maxsplit=1)[0])

    def status(self) -> dict[str, Any]:
        """Return the game's status."""
        self.say("status")
        return self.wait(lambda told: "status" in told)

    def felt(self, name: str) -> dict[str, Any]:
        """Return what is felt of an object."""
        self.say(f"felt {name}")
        return self.wait(lambda told: told.get("region") == name)

    def event(self, what: str, code: str = "") -> dict[str, Any]:
        """Return the next event of this kind and code."""
        return self.wait(lambda t: t.get("event") == what and code in ("", t.get("code")))

    def wait(self, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """Return the next wanted event; drop the events before it."""
        end = time.monotonic() + PATIENCE
        while True:
            try:
                told = self._new.get(timeout=max(0.0, end - time.monotonic()))
            except queue.Empty:
                raise AssertionError(f"not told: {self.told[-5:]}") from None
            assert told is not None, f"it has ended: {self.told[-5:]}"
            if wanted(told):
                return told

    def until(self, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """Return the status as soon as it is as wanted."""
        status: dict[str, Any] = {}

        def stands() -> bool:
            status.update(self.status())
            return wanted(status)

        try:
            eventually(stands)
        except AssertionError as late:
            unasked = [told for told in self.told if "event" in told]
            raise AssertionError(f"{late}: {status}, after {unasked[-5:]}") from None
        return status

    def sounding(self, wanted: Callable[[dict[str, Any]], bool] = bool) -> dict[str, Any]:
        """Return the status as soon as it sounds and is as wanted; arm again if that took longer than the lease."""

        def sounds(status: dict[str, Any]) -> bool:
            if not status["armed"]:
                self.do("arm")
            return bool(status["armed"] and status["output"] == "sounding" and wanted(status))

        return self.until(sounds)

    def end(self) -> int:
        """Let the game end by itself.

        This also ends its input. At its own end, Mono interrupts a reading thread only once, and would wait for ever if
        that was just before the thread began to read.
        """
        with suppress(OSError, ValueError):
            self.say("end")
        if self.process.stdin is not None:
            with suppress(OSError):
                self.process.stdin.close()
        code = self.process.wait(PATIENCE)
        self._close()
        return code

    def stand_still(self) -> None:
        """Block the game's thread until the next command."""
        self.say("freeze")

    def kill(self) -> None:
        """Kill the game."""
        self.process.kill()
        self.process.wait()
        self._close()

    def __enter__(self) -> Game:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self.process.poll() is None:
            self.kill()
        self._close()

    def _close(self) -> None:
        self._reader.join()
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None:
                with suppress(OSError):
                    stream.close()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            try:
                told = json.loads(line)
            except ValueError:
                told = {"said": line.rstrip()}
            self.told.append(told)
            self._new.put(told)
        self._new.put(None)


def begin(
    program: list[str | Path],
    file: Path | str = "-",
    lease: float = 0.0,
    life: float = 60.0,
    timeout: float = 600.0,
    **more: str,
) -> Game:
    """Start a game with a connection file.

    Times in [s]: the lease that it requests, 0: the server's; the time to live of its commands; the timeout of an
    answer. more: environment variables.
    """
    words = [*program, file, str(lease), str(life), str(timeout)]
    return Game(words, {**os.environ, **more})


def look(server: Server) -> State:
    """Return what a server says of itself. Each call opens a session, which needs no renewal."""
    with pc.Client(server.file, name="onlooker", timeout=PATIENCE) as client:
        return client.status()


def count_parts(server: Server, name: str = "ball") -> int:
    """Return the number of solids in a volume. name: the start of its name; if several match, the last counts."""
    with pc.Client(server.file, name="onlooker", timeout=PATIENCE) as client:
        objects = client.show().objects
    shape = next((objects[key].shape for key in reversed(objects) if key.startswith(name)), None)  # type: ignore[union-attr]
    return 0 if shape is None else len(getattr(shape, "parts", [shape]))


def refuse_zones(server: Fake, game: Game) -> None:
    """Refuse the game's quiet zones: they are sent again if they are too many for now, but not if they are wrong."""
    server.until(lambda: len(server.of(commands.Quiet)) == 1)
    server.say(replies.Error(code="limit", message="too many", path="$.zones"), socket=1)
    server.until(lambda: len(server.of(commands.Quiet)) == 2)
    server.say(replies.Error(code="argument", message="wrong", path="$.zones[0]"), socket=1)
    game.event("refused")
    game.event("refused")
    refused = time.monotonic()
    eventually(lambda: bool(game.status()) and time.monotonic() > refused + 1.5)
    assert len(server.of(commands.Quiet)) == 2


def find_server(file: Path) -> list[psutil.Process]:
    """Return the processes of the server that has written a connection file."""
    server = psutil.Process(json.loads(file.read_text(encoding="utf-8"))["pid"])
    return [server, *server.children(recursive=True)]


def sound(game: Game) -> None:
    """Put a ball and arm, until it sounds."""
    game.do("put ball 0 0.01 0.2 20")
    game.do("arm")
    game.sounding(lambda s: s["objects"] == 1)


def wait_until_free(server: Server) -> None:
    """Wait until nobody owns the output: the owner's session has ended, not only its lease."""
    eventually(lambda: not look(server).owner)


def wait_for_silence(server: Server, since: float, log: Log | None = None) -> None:
    """Wait until the device, which has sounded, was silent after `since` [s], a time of `time.perf_counter`.

    It may have been silent before, if a busy machine delayed its game. log: of its other device.
    """
    log = log or server.log

    def is_silent() -> bool:
        events = log.read(max(0, log.count - 10_000))
        assert events["sounds"].any(), "it has never sounded"
        ends = events["sounds"] == 0
        return bool(ends[-1] or (ends & (events["time"] > since)).any())

    eventually(is_silent)


def wait_for_expiry(server: Server, since: float, stood: float = 0.0) -> None:
    """Wait until the device was silent after `since` [s], and control also finds the lease over.

    stood: shortest wait [s]. The lease counts from the last renewal, which may be earlier than a game's last tick.
    """
    wait_for_silence(server, since)
    eventually(lambda: not look(server).armed and time.perf_counter() > since + stood)


def sounded_since(server: Server, mark: int) -> bool:
    """Return whether the device has sounded since the entry `mark` of its log."""
    return bool(server.log.read(mark)["sounds"].any())


def kill(server: Server) -> None:
    """Kill the server's parent, and wait until all of the server has ended."""
    server.signal("control", signal.SIGKILL)
    eventually(lambda: not server.list_running())


def fill(server: Fake, game: Game, wire: BlockableLink) -> None:
    """Block the game's commands, and send until there is no room; then new ones wait.

    After each command, the client's thread sends a message to control. This proves that no command replaced the one
    before.
    """
    server.until(
        lambda: bool(game.do("clear") and server.of(commands.Clear))
    )  # commands are connected
    wire.goes.clear()
    for _ in range(HEAVY):
        game.do("heavy rain 5000")
        await_step(server, game)


def await_step(server: Fake, game: Game) -> None:
    """Wait until the client's thread has sent a message to control, which is not blocked."""
    before = len(server.of(control.Reset))
    game.do("reset")
    server.until(lambda: len(server.of(control.Reset)) > before)
