"""A game that is written in another language, and does what it is told."""

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
from pacinian.wire import commands, control

from ..waiting import PATIENCE, eventually

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path
    from types import TracebackType

    from pacinian.wire.state import State
    from pacinian_lab.server.faults.logging_device import Log
    from pacinian_lab.server.faults.server import Server

    from ..core.client.fake import Fake
    from .slow import Slow

HEAVY = 120  # objects that are more than the sockets take
LEASE = 0.25  # [s], what a game asks for where its lease is to end
# of a server: the longest that it may have, so that neither a busy machine nor what ends a session lets a lease end
HELD = "[safety]\nlease = 10.0\nstale = 1.0\n"


class Game:
    """A process that reads commands, a line each, and tells what happens in lines of JSON; a context manager."""

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
        """A command, which is not waited for."""
        assert self.process.stdin is not None
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def do(self, line: str) -> dict[str, Any]:
        """A command, and what it tells when that is done."""
        self.say(line)
        return self.wait(lambda told: told.get("did") == line.split(maxsplit=1)[0])

    def status(self) -> dict[str, Any]:
        """How it stands."""
        self.say("status")
        return self.wait(lambda told: "status" in told)

    def felt(self, name: str) -> dict[str, Any]:
        """What is felt of an object."""
        self.say(f"felt {name}")
        return self.wait(lambda told: told.get("region") == name)

    def event(self, what: str, code: str = "") -> dict[str, Any]:
        """The next event of that kind, and of that code."""
        return self.wait(lambda t: t.get("event") == what and code in ("", t.get("code")))

    def wait(self, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """The next thing told that is wanted; what is told before it is not waited for any more."""
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
        """How it stands, when that is as wanted."""
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
        """How it stands when it sounds, and is as wanted; it arms again where that took longer than its lease."""

        def sounds(status: dict[str, Any]) -> bool:
            if not status["armed"]:
                self.do("arm")
            return bool(status["armed"] and status["output"] == "sounding" and wanted(status))

        return self.until(sounds)

    def end(self) -> int:
        """Let it end by itself.

        Its input ends, too: Mono, at its own end, interrupts a thread that reads only once, and waits for ever
        if that was just before the thread began to.
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
        """Let its thread stand still until it is told the next thing."""
        self.say("freeze")

    def kill(self) -> None:
        """End it in the middle of what it does."""
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
    """A game of a connection file. Times in [s]: the lease it asks for, 0: the server's; the life of its commands;
    how long an answer may take. more: its environment.
    """
    words = [*program, file, str(lease), str(life), str(timeout)]
    return Game(words, {**os.environ, **more})


def look(server: Server) -> State:
    """What a server says of itself. Each look is a session of its own, which nothing has to renew."""
    with pc.Client(server.file, name="onlooker", timeout=PATIENCE) as client:
        return client.status()


def count_parts(server: Server, name: str = "ball") -> int:
    """Of how many solids a volume consists. name: how its own name begins; of several the last."""
    with pc.Client(server.file, name="onlooker", timeout=PATIENCE) as client:
        objects = client.show().objects
    shape = next((objects[key].shape for key in reversed(objects) if key.startswith(name)), None)  # type: ignore[union-attr]
    return 0 if shape is None else len(getattr(shape, "parts", [shape]))


def find_server(file: Path) -> list[psutil.Process]:
    """The processes of the server that has written a connection file."""
    server = psutil.Process(json.loads(file.read_text(encoding="utf-8"))["pid"])
    return [server, *server.children(recursive=True)]


def sound(game: Game) -> None:
    """Put a ball and arm, until it sounds."""
    game.do("put ball 0 0.01 0.2 20")
    game.do("arm")
    game.sounding(lambda s: s["objects"] == 1)


def wait_until_free(server: Server) -> None:
    """Wait until nobody owns the output: the session that did has ended, not only its lease."""
    eventually(lambda: not look(server).owner)


def wait_for_silence(server: Server, since: float, log: Log | None = None) -> None:
    """Wait until the device, which has sounded, was silent after `since` [s], of `time.perf_counter`.

    It may have been silent before, where a busy machine kept its game waiting. log: of its other device.
    """
    log = log or server.log

    def is_silent() -> bool:
        events = log.read(max(0, log.count - 10_000))
        assert events["sounds"].any(), "it has never sounded"
        ends = events["sounds"] == 0
        return bool(ends[-1] or (ends & (events["time"] > since)).any())

    eventually(is_silent)


def wait_for_expiry(server: Server, since: float, stood: float = 0.0) -> None:
    """Wait until the device was silent after `since` [s], and control, too, finds the lease over.

    stood: shortest wait [s]. The lease counts from the last renewal, which may be earlier than a game's last tick.
    """
    wait_for_silence(server, since)
    eventually(lambda: not look(server).armed and time.perf_counter() > since + stood)


def sounded_since(server: Server, mark: int) -> bool:
    """Whether the device has sounded since it had told so much."""
    return bool(server.log.read(mark)["sounds"].any())


def kill(server: Server) -> None:
    """End the server's parent, and wait until all of it has ended."""
    server.signal("control", signal.SIGKILL)
    eventually(lambda: not server.list_running())


def fill(server: Fake, game: Game, wire: Slow) -> None:
    """Hold up its commands, and send until there is no room: what is put then waits.

    After each, its own thread says another thing to control: so none took the place of the one before.
    """
    server.until(
        lambda: bool(game.do("clear") and server.of(commands.Clear))
    )  # commands are connected
    wire.goes.clear()
    for _ in range(HEAVY):
        before = len(server.of(control.Reset))
        game.do("heavy rain 5000")
        game.do("reset")
        server.until(lambda n=before: len(server.of(control.Reset)) > n)  # type: ignore[misc]
