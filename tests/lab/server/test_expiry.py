from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from rich.console import Console

from pacinian.serving.settings import Settings
from pacinian_lab.server.expiry import BOUND, Sizes, measure, tabulate
from pacinian_lab.server.guard_process import GuardProcess

if TYPE_CHECKING:
    import pytest


def test_from_the_end_of_a_permit_to_silence_it_is_at_most_a_round() -> None:
    rows = list(measure(Sizes(500, 10, 5, 3, 2, 1)))
    told, *real = rows
    assert told.count >= 500
    assert 0.0 < told.p50 < told.worst <= 1.0
    assert told.over == 0.0
    assert [row.count for row in real] == [10, 5, 3, 2, 1]
    for row in real:  # how late depends on the machine
        assert 0.0 < row.p50 <= row.p99 <= row.p999 <= row.worst
        assert 0.0 <= row.over <= 1.0
    assert rows[4].p50 > 0.02  # no more frames: not before they are old
    console = Console(width=120, record=True)
    console.print(tabulate(rows))
    assert f"{1e3 * BOUND:.3f}" in console.export_text()


def test_a_frame_that_the_guard_drops_is_sent_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """The guard drops frames of another epoch than that of the permit that it has read."""
    with GuardProcess(Settings()) as real:
        permit = real.permit
        monkeypatch.setattr(
            real, "permit", lambda until: threading.Timer(0.05, permit, (until,)).start()
        )
        status, _ = real.sound()
        assert status.sounding
