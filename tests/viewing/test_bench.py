"""`pacinian bench view`: a row for each kind of window, and in each what a page of that kind has."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.bench import view
from pacinian.bench.view import measure

if TYPE_CHECKING:
    import pytest


def test_all_kinds_of_windows_are_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(view, "SETTLE", 0.5)
    rows = {row.how: row for row in measure(1, 1.2, 1)}
    assert list(rows) == ["closed", "feed", "slice"]
    for how, row in rows.items():
        assert (row.viewer > 0.0) == (how != "closed")
        assert row.frames == row.browser == 0.0
        assert how == "slice" or not row.slices  # and then as many as the machine has time for
        assert row.ticks is not None
        assert 0.0 < row.ticks.p50 <= row.ticks.p99
        assert 0.0 < row.ticks.sounding <= 1.0
        assert 0.0 <= row.ticks.late <= 1.0
