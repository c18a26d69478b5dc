"""Clients that wait for the answer to their goodbye, however busy the server is."""

from __future__ import annotations

import pytest

from pacinian.client import dialogue


@pytest.fixture(autouse=True)
def unhurried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dialogue, "FAREWELL", 10.0)
