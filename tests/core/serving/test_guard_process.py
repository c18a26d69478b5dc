from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import msgspec
import numpy as np
import pytest

from pacinian.acoustics.array import lattice
from pacinian.scene.file import Choice, Lattice
from pacinian.serving import child
from pacinian.serving.memory import Latest, folder
from pacinian.serving.messages import (
    CAPACITIES,
    Device,
    FrameHead,
    Orders,
    Permit,
    frame_capacity,
    pack,
)
from pacinian.serving.settings import Safety, Settings
from pacinian.wire.control import Choice as Selected

from ...waiting import PATIENCE, eventually

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

FOREVER = 1e6  # [s]
N = len(lattice(0.05, 0.05))
PLUGIN = '''
import ctypes
import os
import pacinian as pc

class Logged(pc.Backend):
    """Writes down what it is told."""
    name = "logged"

    def __init__(self, log: str = "", does: str = ""):
        self.log, self.does, self.frames = log or os.environ["LOGGED"], does, 0

    @property
    def capability(self):
        return pc.Capability(64, 64)

    def told(self, what):
        with open(self.log, "a") as file:
            file.write(what + "\\n")

    def open(self, array):
        self.told("open")

    def send(self, frame):
        self.told("send")
        self.frames += 1
        if self.frames == 3 and self.does == "hold":
            ctypes.PyDLL(None).sleep(600)  # with the interpreter's lock
        if self.frames == 3 and self.does == "exit":
            raise SystemExit(5)

    def silence(self):
        self.told("silence")

    def close(self):
        self.told("close")

@pc.hookimpl
def register_backends():
    return [Logged]
'''
PARENT = """
import sys, time
import msgspec
from pacinian.serving import child
told = msgspec.json.decode(sys.argv[1], type=child.Told)
print(child.start("guard", told).pid, flush=True)
time.sleep(600)
"""


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the plug-in, which is installed now, writes."""
    (tmp_path / "logged.py").write_text(PLUGIN)
    told = tmp_path / "logged-1.0.dist-info"
    told.mkdir()
    (told / "METADATA").write_text("Metadata-Version: 2.1\nName: logged\nVersion: 1.0\n")
    (told / "entry_points.txt").write_text("[pacinian]\nlogged = logged\n")
    path = os.pathsep.join((str(tmp_path), os.environ.get("PYTHONPATH", "")))
    monkeypatch.setenv("PYTHONPATH", path)
    monkeypatch.setenv("LOGGED", str(tmp_path / "log"))
    return tmp_path / "log"


class Server:
    """What a guard needs of the others."""

    def __init__(self) -> None:
        self.folder = folder()
        sizes = {**CAPACITIES, "frame": frame_capacity(N)}
        names = "permit", "frame", "orders", "device"
        self.memory = {n: Latest.create(self.folder / n, sizes[n]) for n in names}
        self.processes: list[subprocess.Popen[bytes]] = []
        self.sequence, self.epoch = 0, 1

    def make_config(
        self, log: Path | None = None, does: str = "", hung: float = 60.0
    ) -> child.Told:
        options: dict[str, bool | int | float | str] = {"log": str(log), "does": does}
        settings = Settings(
            array=Lattice(0.05, 0.05),
            backend=Choice("logged", options) if log else "simulated",
            safety=Safety(stale=1.0, hung=hung),
        )
        return child.Told(str(self.folder), settings)

    def start(self, told: child.Told) -> subprocess.Popen[bytes]:
        self.processes.append(child.start("guard", told))
        return self.processes[-1]

    @property
    def device(self) -> Device | None:
        read = self.memory["device"].read()
        return None if read is None else msgspec.msgpack.decode(read[1], type=Device)

    def until(
        self, so: Callable[[Device], object], each: Callable[[], object] = lambda: None
    ) -> Device:
        """What the device tells once it is so."""
        told: Device = eventually(lambda: (d := self.device) and so(d) and d, each)
        return told

    def permit(self, until: float = FOREVER, armed: int = 1, stopped: int = 0) -> None:
        permit = Permit(armed, time.perf_counter() + until, self.epoch, stopped)
        self.memory["permit"].write(permit.pack())

    def frame(self) -> None:
        device = self.device
        assert device is not None
        self.sequence += 1
        made_for = device.next or device.generation
        head = FrameHead(self.sequence, 0.0, self.epoch, made_for, 2, N)
        levels = np.full((2, 2, N), 5, np.uint16)
        self.memory["frame"].write(head.pack(), levels.data)

    def sound(self) -> Device:
        self.until(lambda device: device.generation > 0)
        self.permit()
        return self.until(lambda device: device.sounding, self.frame)

    def silenced(self, reason: str, **permit: float) -> None:
        """It sounds until another permit ends that; where this process stood still, no frames did: once more."""
        while reason not in self.until(lambda _: True).reasons:
            self.sound()
            self.permit(**permit)  # type: ignore[arg-type]
            self.until(lambda device: not device.sounding)

    def close(self) -> None:
        for process in self.processes:
            child.end(process, PATIENCE)
        for memory in self.memory.values():
            memory.close()
        shutil.rmtree(self.folder, ignore_errors=True)  # a guard without a parent has done so


@pytest.fixture
def server() -> Iterator[Server]:
    made = Server()
    yield made
    made.close()


def ended(process: subprocess.Popen[bytes]) -> int:
    assert process.stdin is not None
    status = process.wait(PATIENCE)
    process.stdin.close()
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

    # another device, while the old one goes on
    server.sound()
    server.memory["orders"].write(pack(Orders(backend=(1, Selected(name="logged")))))
    after = server.until(lambda device: "backend 1" in device.results, server.frame)
    assert after.results["backend 1"] == ""
    assert (after.name, after.amplitudes) == ("logged", 64)
    assert after.generation == before.generation + 1
    server.sound()

    # one that is not there
    server.memory["orders"].write(pack(Orders(backend=(2, Selected(name="no such one")))))
    after = server.until(lambda device: "backend 2" in device.results, server.frame)
    assert "no backend is called" in after.results["backend 2"]
    server.sound()
    assert not after.fault

    assert child.end(process, PATIENCE) == 0
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
    process.send_signal(number)
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
    # one started anew takes no frame that was made for the old one's device
    server.start(server.make_config(log))
    second = server.until(
        lambda device: device.beat > first.beat and device.generation > first.generation
    )
    assert second.generation == first.generation + 1
    assert second.frames == 0
