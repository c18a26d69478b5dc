from __future__ import annotations

import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING

import msgspec
import pytest

from pacinian.serving.ipc import launched_child
from pacinian.serving.ipc.messages import (
    Selections,
    pack,
)
from pacinian.wire.control import Choice as Selected

from ....waiting import PATIENCE
from ..guards import Server, log

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["log"]

PARENT = """
import sys, time
import msgspec
from pacinian.serving.ipc import launch_config, launched_child
told = msgspec.json.decode(sys.argv[1], type=launch_config.LaunchConfig)
print(launched_child.start_child("guard", told).pid, flush=True)
time.sleep(600)
"""


@pytest.fixture
def server() -> Iterator[Server]:
    made = Server()
    yield made
    made.close()


def ended(process: launched_child.LaunchedChild) -> int:
    status = process.wait(PATIENCE)
    process.close()
    return status


def test_a_guard_from_its_start_to_its_end(server: Server, log: Path) -> None:
    process = server.start(server.make_config())
    before = server.sound()
    assert before.name == "simulated"
    assert {"simulated", "logged"} <= {offer.name for offer in before.backends}

    server.silenced("expired", until=0.01)
    server.silenced("stopped", stopped=1)
    server.sound()
    server.until(lambda device: device.stale)

    # another device, while the old one continues
    server.sound()
    server.memory["selections"].write(pack(Selections(backend=(1, Selected(name="logged")))))
    after = server.until(lambda device: "backend 1" in device.results, server.frame)
    assert after.results["backend 1"] == ""
    assert (after.name, after.amplitudes) == ("logged", 64)
    assert after.generation == before.generation + 1
    server.sound()

    # an unknown device
    server.memory["selections"].write(pack(Selections(backend=(2, Selected(name="no such one")))))
    after = server.until(lambda device: "backend 2" in device.results, server.frame)
    assert "no backend is called" in after.results["backend 2"]
    server.sound()
    assert not after.fault

    assert launched_child.end_child(process, PATIENCE) == 0
    said = log.read_text().split()
    assert said[0] == "open"
    assert said[-2:] == ["silence", "close"]
    last = server.device
    assert last is not None
    assert not last.sounding


@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_with_silence(number: int, server: Server, log: Path) -> None:
    process = server.start(server.make_config(log))
    server.sound()
    os.kill(process.pid, number)
    assert ended(process) == 0
    assert log.read_text().split()[-2:] == ["silence", "close"]


def test_its_parent_s_death_ends_it_with_silence(server: Server, log: Path) -> None:
    text = msgspec.json.encode(server.make_config(log)).decode()
    with subprocess.Popen([sys.executable, "-c", PARENT, text], stdout=subprocess.PIPE) as parent:
        server.sound()
        parent.kill()
    server.until(lambda device: device.reasons.get("end"))
    server.until(lambda _: log.read_text().split()[-2:] == ["silence", "close"])


def test_whatever_it_dies_of_the_last_thing_is_silence(server: Server, log: Path) -> None:
    process = server.start(server.make_config(log, "exit"))
    server.until(lambda device: device.generation > 0)
    server.permit()
    server.until(lambda _: process.poll() is not None, server.frame)
    assert ended(process) == 5
    assert log.read_text().split()[-2:] == ["silence", "close"]


@pytest.mark.skipif(sys.platform != "linux", reason="needs alarms, and the C library's sleep")
def test_a_backend_that_never_returns_takes_the_guard_with_it(server: Server, log: Path) -> None:
    process = server.start(server.make_config(log, "hold", hung=2.0))
    first = server.until(lambda device: device.generation > 0)
    server.permit()
    server.until(lambda device: log.read_text().count("send") == 3, server.frame)
    assert ended(process) == -signal.SIGALRM
    # a restarted guard takes no frame for the device of the old one
    server.start(server.make_config(log))
    second = server.until(
        lambda device: device.heartbeat > first.heartbeat and device.generation > first.generation
    )
    assert second.generation == first.generation + 1
    assert second.frames == 0


@pytest.mark.skipif(sys.platform != "linux", reason="needs alarms")
def test_a_device_that_may_sound_and_does_not_close_takes_the_guard_with_it(
    server: Server, log: Path
) -> None:
    """The system then closes the device, and another guard can open it."""
    process = server.start(server.make_config(log, "stick", hung=1.0))
    server.until(lambda device: device.generation > 0)
    server.permit()
    server.until(lambda device: device.fault, server.frame)
    server.memory["selections"].write(pack(Selections(reset=1)))
    assert ended(process) == -signal.SIGALRM
    assert log.read_text().split()[-2:] == ["silence", "close"]
