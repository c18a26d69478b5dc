"""A wait that nothing ends would hang these tests."""

from __future__ import annotations

import sys
import threading
from typing import TYPE_CHECKING

import pytest

from pacinian.serving.ipc.wake_pipe import BYTES, WakePipe

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="has no named pipes")
HANGS = 1e5  # [s]


def test_a_wait_ends_when_another_wakes_it_before_or_during_it(tmp_path: Path) -> None:
    waits, wakes = WakePipe(tmp_path / "a"), WakePipe(tmp_path / "a")
    wakes.wake()
    waits.wait(HANGS)
    threading.Timer(0.01, wakes.wake).start()
    waits.wait(HANGS)
    waits.wait(-1.0)  # and without, at once or after its time
    waits.clear()
    wakes.close()
    waits.close()
    waits.close()


def test_who_wakes_never_waits_and_a_wait_takes_all_wakes_before_it(tmp_path: Path) -> None:
    pipe = WakePipe(tmp_path / "a")
    for _ in range(2 * BYTES):
        pipe.wake()
    pipe.wait(HANGS)
    pipe.wait(0.0)
    pipe.wake()
    pipe.wait(HANGS)
    pipe.close()
