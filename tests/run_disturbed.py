"""Run a command on a machine that is disturbed, to find tests that know how fast the machine is.

    python tests/run_disturbed.py --busy 4 -- python -m pytest       # beside four processes that keep the cores busy
    python tests/run_disturbed.py --stop 1.0 -- python -m pytest     # stopped for 1 s at random moments

`--stop` stops either the command with all processes that it started, or pytest alone, so that what the tests
started goes on without them. The exit code is the command's.
"""

from __future__ import annotations

import argparse
import contextlib
import random
import shutil
import signal
import subprocess
import sys
import threading
from typing import TYPE_CHECKING

import psutil

if TYPE_CHECKING:
    from collections.abc import Iterator

BUSY = [sys.executable, "-c", "while True: pass"]


@contextlib.contextmanager
def keep_busy(count: int) -> Iterator[None]:
    """Start `count` busy processes, each in its own session, because Linux shares CPU time among sessions."""
    processes = [subprocess.Popen(BUSY, start_new_session=True) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def choose_processes(command: psutil.Process, choose: random.Random) -> list[psutil.Process]:
    """Return all of the command's processes, or only pytest and its workers; parents first."""
    workers = command.children()
    if choose.random() < 0.5:
        return [command, *command.children(recursive=True)]
    return [command, *(w for w in workers if w.name().startswith("python"))]


def stop_at_random(
    pid: int, seconds: float, every: float, seed: int, ended: threading.Event
) -> None:
    """Stop processes for `seconds`, on average once in `every` seconds, until `ended`."""
    choose = random.Random(seed)
    while not ended.wait(choose.expovariate(1.0 / every)):
        with contextlib.suppress(psutil.Error):
            chosen = choose_processes(psutil.Process(pid), choose)
            stopped = []
            for process in chosen:
                with contextlib.suppress(psutil.Error):
                    if process.status() != psutil.STATUS_STOPPED:  # a test has stopped that one
                        process.suspend()
                        stopped.append(process)
            ended.wait(seconds)
            for process in reversed(stopped):
                with contextlib.suppress(psutil.Error):
                    process.resume()


def parse_amount(text: str) -> float:
    """Read a number above 0."""
    if not 0.0 < (amount := float(text)) < float("inf"):
        raise argparse.ArgumentTypeError(f"more than 0, not {text}")
    return amount


def interrupt(_signal: int, _frame: object) -> None:
    """End as Ctrl+C does, so that nothing that was started stays."""
    raise KeyboardInterrupt


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--busy", type=int, default=0, help="processes that keep the cores busy")
    parser.add_argument(
        "--stop", type=parse_amount, default=0.0, help="how long the command is stopped [s]"
    )
    parser.add_argument(
        "--every", type=parse_amount, default=10.0, help="mean time between two stops [s]"
    )
    parser.add_argument("--seed", type=int, default=1, help="of the moments of the stops")
    parser.add_argument("command", nargs="+")
    given = parser.parse_args()
    if shutil.which(given.command[0]) is None:
        parser.error(f"there is no program {given.command[0]!r}")
    ended = threading.Event()
    signal.signal(signal.SIGTERM, interrupt)  # of `timeout`
    with keep_busy(given.busy), subprocess.Popen(given.command) as process:
        stops = (process.pid, given.stop, given.every, given.seed, ended)
        thread = threading.Thread(target=stop_at_random, args=stops)
        if given.stop:
            thread.start()
        try:
            return process.wait()
        except KeyboardInterrupt:
            process.send_signal(signal.SIGINT)
            return process.wait()
        finally:
            ended.set()
            if given.stop:
                thread.join()


if __name__ == "__main__":
    sys.exit(main())
