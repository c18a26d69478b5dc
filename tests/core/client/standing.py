"""Processes that stand still for a while, as all do on a machine that is busy with something else."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from pacinian.wire.connection import Connection

if TYPE_CHECKING:
    from collections.abc import Iterator

STILL = 0.75  # [s]: longer than most leases, half as long as a link may be quiet
SERVER = Path(__file__).with_name("fake.py")


@contextmanager
def server_apart() -> Iterator[tuple[subprocess.Popen[str], Connection]]:
    """A fake server in a process of its own."""
    command = [sys.executable, str(SERVER)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout is not None
            yield process, msgspec.json.decode(process.stdout.readline(), type=Connection)
        finally:
            process.kill()


def stand_still(process: subprocess.Popen[Any]) -> None:
    """Stop it, and let it go on."""
    process.send_signal(signal.SIGSTOP)
    time.sleep(STILL)
    process.send_signal(signal.SIGCONT)
