"""A spare guard, with a manual clock, and with real processes."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from msgspec.structs import replace

from pacinian.scene.config_sections import PluginConfig
from pacinian.serving.guard.spare_guard import CHECK_INTERVAL, HangDetector
from pacinian.serving.ipc.hang_detection import MAX_CHECK_GAP
from pacinian.serving.ipc.messages import DeviceStatus, Selections, pack
from pacinian.wire.control import Choice as Selected

from ....waiting import eventually
from ..guards import Server, log
from ..processes import runs

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.serving.ipc import launch_config, launched_child

__all__ = ["log"]

linux = pytest.mark.skipif(
    sys.platform != "linux", reason="only Linux tells a spare of the guard's end"
)
LIMIT = 0.25  # time without a heartbeat after which a guard is hung [s]


# manual clock


def looked(seconds: float, sound: bool, every: float = CHECK_INTERVAL) -> float:
    """Return the time after which a guard without a heartbeat is reported as hung [s]; `seconds` if it is not."""
    detector, now = HangDetector(LIMIT), 100.0
    assert not detector.detect_hang(now, sound, now)
    beat, since = now, now
    while now < since + seconds:
        now += every
        if detector.detect_hang(beat, sound, now):
            return now - since
    return seconds


def test_a_guard_without_a_sign_of_life_is_missed_while_there_may_be_sound() -> None:
    assert LIMIT < looked(10.0, sound=True) <= LIMIT + 2 * CHECK_INTERVAL
    assert looked(10.0, sound=False) == 10.0


def test_one_that_lives_is_not_missed() -> None:
    detector = HangDetector(LIMIT)
    assert not any(
        detector.detect_hang(0.2 * (k // 10), True, CHECK_INTERVAL * k) for k in range(1000)
    )


def test_what_was_not_looked_at_proves_nothing() -> None:
    """After a long gap between checks, the machine may have stopped; a missing heartbeat then proves nothing."""
    assert looked(1e4, sound=True, every=1e3) >= 1e3 * LIMIT / MAX_CHECK_GAP


# real processes


@pytest.fixture
def server() -> Iterator[Server]:
    made = Server()
    yield made
    made.close()


def begin(
    server: Server, told: launch_config.LaunchConfig
) -> tuple[launched_child.LaunchedChild, launched_child.LaunchedChild, DeviceStatus]:
    """Start a guard and a spare. Return both, and the device's status, once it sounds and the spare waits."""
    guard = server.start(told)
    server.sound()
    spare = server.start(replace(told, spare=guard.pid))
    files = Path(f"/proc/{spare.pid}/fd")

    def waits() -> bool:
        """Return whether the spare holds the guard's pidfd."""
        with contextlib.suppress(FileNotFoundError):  # the file has just been closed
            return any("pidfd" in os.readlink(file) for file in files.iterdir())
        return False

    eventually(waits)
    return guard, spare, server.sound()


@linux
def test_a_spare_takes_over_by_itself_from_one_that_is_killed(server: Server, log: Path) -> None:
    told = server.make_config(log)
    guard, spare, before = begin(server, told)
    assert log.read_text().count("open") == 1, "a spare opens nothing"
    os.kill(guard.pid, signal.SIGKILL)
    after = server.until(lambda device: device.generation > before.generation)
    assert not after.sounding
    assert after.backends == before.backends
    assert log.read_text().split()[-1] == "open"
    assert spare.poll() is None
    server.sound()


@linux
def test_a_spare_ends_a_guard_that_stands_still_while_it_may_sound(
    server: Server, log: Path
) -> None:
    told = server.make_config(log, hung=2.0)
    guard, _, before = begin(server, told)
    os.kill(guard.pid, signal.SIGSTOP)
    server.until(lambda device: device.generation > before.generation)
    assert guard.wait(1.0) == -signal.SIGKILL


@linux
def test_a_spare_first_silences_what_sounded_though_another_was_selected(
    server: Server, log: Path
) -> None:
    told = server.make_config(log)
    guard, _, before = begin(server, told)
    assert before.choice == PluginConfig("logged", {"log": str(log), "does": ""})
    os.kill(guard.pid, signal.SIGSTOP)  # so that it does not see the selection
    server.memory["selections"].write(pack(Selections(backend=(1, Selected(name="simulated")))))
    os.kill(guard.pid, signal.SIGKILL)
    after = server.until(lambda device: device.generation > before.generation)
    assert after.name == "simulated"
    assert log.read_text().split()[-2:] == ["open", "close"]


@linux
def test_a_spare_ends_with_its_parent_and_opens_nothing(server: Server, log: Path) -> None:
    guard, spare, _ = begin(server, server.make_config(log))
    spare.close()
    eventually(lambda: not runs(spare.pid))
    assert guard.poll() is None
    assert log.read_text().count("open") == 1


def test_a_spare_whose_guard_nobody_knows_begins_when_it_is_called(
    server: Server, log: Path
) -> None:
    spare = server.start(replace(server.make_config(log), spare=1 << 30))
    spare.activate()
    server.until(lambda device: device.generation == 1)
    assert log.read_text().split() == ["open"]
