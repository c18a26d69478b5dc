"""Shared by tests of the server's processes."""

from __future__ import annotations

import psutil

from pacinian.serving.settings import Log, Safety, Settings

PATIENT = Settings(
    log=Log(level="warning"), safety=Safety(lease=10.0, session_timeout=3600.0, hang_timeout=60.0)
)
"""Settings with leases and watchdogs that outlast a stopped machine."""


def runs(pid: int) -> bool:
    """Return whether a process runs and is not a zombie."""
    try:
        return bool(psutil.Process(pid).status() != psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return False
