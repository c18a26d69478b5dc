"""A short flood; `pacinian bench hostile` sends a million messages and measures."""

from __future__ import annotations

import pytest

from pacinian_lab.server.faults.server import Server
from pacinian_lab.server.fuzz import run, tables

from ..waiting import PATIENCE

MESSAGES, SECONDS = 5_000, 600.0
BUSY = 10  # times what is aimed at: the tests' machine does other things, too


@pytest.mark.deep
def test_a_flood_ends_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    terminate = Server.terminate
    monkeypatch.setattr(Server, "terminate", lambda self, wait=PATIENCE: terminate(self, wait))
    found = run.run(MESSAGES, SECONDS, seed=7)
    assert found.messages >= MESSAGES
    assert found.same
    assert found.ended == 0
    assert found.flooded.answers
    assert not found.counts.get("failed", 0)
    assert {"malformed", "refused_protocol", "refused_secret"} <= set(found.counts)
    assert max(found.growth.values()) < BUSY * tables.GROWN
    assert len(found.flooded.gap)
