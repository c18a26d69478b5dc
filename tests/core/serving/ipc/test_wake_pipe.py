"""Wakes end waits. If they did not, these tests would hang."""

from __future__ import annotations

import sys
import threading
from typing import TYPE_CHECKING

import pytest

from pacinian.serving.ipc.wake_pipe import POLL_INTERVAL, READ_BYTES, WakePipe

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="has no named pipes")
HANGS = 1e5  # timeout that no test reaches [s]


def never() -> bool:
    """Fail: `news` may be called only on systems without named pipes."""
    raise AssertionError


def test_a_wait_ends_when_another_wakes_it_before_or_during_it(tmp_path: Path) -> None:
    waits, wakes = WakePipe(tmp_path / "a"), WakePipe(tmp_path / "a")
    wakes.wake()
    waits.wait(HANGS, never)
    threading.Timer(0.01, wakes.wake).start()
    waits.wait(HANGS, never)
    waits.wait(-1.0, never)  # and without, at once or after its time
    waits.clear()
    wakes.close()
    waits.close()
    waits.close()


def test_who_wakes_never_waits_and_a_wait_takes_all_wakes_before_it(tmp_path: Path) -> None:
    pipe = WakePipe(tmp_path / "a")
    for _ in range(2 * READ_BYTES):
        pipe.wake()
    pipe.wait(HANGS, never)
    pipe.wait(0.0, never)
    pipe.wake()
    pipe.wait(HANGS, never)
    pipe.close()


def test_without_named_pipes_a_wait_asks_for_news_and_ends_with_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pauses: list[float] = []
    monkeypatch.setattr("pacinian.serving.ipc.wake_pipe.time.sleep", pauses.append)
    pipe = WakePipe(tmp_path / "no folder" / "a")
    assert not pipe.works
    pipe.wake()
    news = iter([False, False, False, True])
    pipe.wait(HANGS, lambda: next(news))
    assert pauses == [POLL_INTERVAL] * 3
    pipe.wait(0.0, lambda: False)
    pipe.close()
