"""Let clients wait long, so that a stopped machine costs no connection."""

from __future__ import annotations

import pytest

from .long_timeouts import wait_long


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    wait_long(monkeypatch)
