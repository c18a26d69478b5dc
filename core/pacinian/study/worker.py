"""What a local worker process does first: Dask preloads it."""

from __future__ import annotations

import importlib
import signal
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from distributed import Worker


def dask_setup(worker: Worker) -> None:
    """Load what is needed before anything is timed; leave Ctrl-C to the command, which ends its workers."""
    importlib.import_module("pacinian.study.measuring")
    signal.signal(signal.SIGINT, signal.SIG_IGN)
