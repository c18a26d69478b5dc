"""A game that is written in another language, and does what it is told."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import threading
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import pacinian as pc
from pacinian.wire import commands, control

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path
    from types import TracebackType

    from ..core.client.fake import Fake
    from .slow import Slow

PATIENCE = 20.0  # [s]
LEASE = 0.25  # [s], what a game asks for where its lease is to end
# of a server: else whatever ends, the lease alone would soon end the sound, too, and so would a late frame
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

    def event(self, what: str, code: str = "") -> dict[str, Any]:
        """The next event of that kind, and of that code."""
        return self.wait(lambda t: t.get("event") == what and code in ("", t["code"]))

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
        end = time.monotonic() + PATIENCE
        while not wanted(status := self.status()):
            assert time.monotonic() < end, status
            time.sleep(0.01)  # until it has ticked
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
    life: float = 1.0,
    **more: str,
) -> Game:
    """A game of a connection file. lease: 0: the server's [s]. life: of its commands [s]. more: its environment."""
    return Game([*program, file, str(lease), str(life)], {**os.environ, **more})


def free(file: Path) -> None:
    """Wait until nobody owns the output of this server: not even a game that was killed just now."""
    with pc.Client(file, timeout=PATIENCE) as client:
        end = time.monotonic() + PATIENCE
        while owner := client.status().owner:
            assert time.monotonic() < end, owner
            time.sleep(0.01)


def fill(server: Fake, game: Game, wire: Slow) -> None:
    """Hold up its commands, and send until there is no room: what is put then waits.

    After each, its own thread says another thing to control: so none took the place of the one before.
    """
    server.until(
        lambda: bool(game.do("clear") and server.of(commands.Clear))
    )  # commands are connected
    wire.goes.clear()
    for _ in range(120):
        before = len(server.of(control.Reset))
        game.do("heavy rain 5000")
        game.do("reset")
        server.until(lambda n=before: len(server.of(control.Reset)) > n)  # type: ignore[misc]
