"""What tests of the server's processes share."""

from __future__ import annotations

import psutil

from pacinian.serving.settings import Log, Safety, Settings

PATIENT = Settings(log=Log(level="warning"), safety=Safety(lease=10.0, forget=3600.0, hung=60.0))
"""A server with leases and watchdogs that do not end where the machine stands still."""


def runs(pid: int) -> bool:
    """Whether a process runs, and is not only waiting to be forgotten."""
    try:
        return bool(psutil.Process(pid).status() != psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return False
