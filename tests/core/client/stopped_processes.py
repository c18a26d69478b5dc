"""Stop a process for a while, as a busy machine may do to any process."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from pacinian.wire.connection_file import Connection

if TYPE_CHECKING:
    from collections.abc import Iterator

STILL = 0.75  # longer than most leases, half as long as a connection may be quiet [s]
SERVER = Path(__file__).with_name("fake_server.py")


@contextmanager
def server_apart() -> Iterator[tuple[subprocess.Popen[str], Connection]]:
    """Run a fake server in its own process."""
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
    """Stop the process for `STILL` seconds, then let it continue."""
    process.send_signal(signal.SIGSTOP)
    time.sleep(STILL)
    process.send_signal(signal.SIGCONT)
