"""The files that a guard process shares with other processes, and a device that logs its calls."""

from __future__ import annotations

import os
import time
from contextlib import ExitStack
from typing import TYPE_CHECKING

import msgspec
import numpy as np
import pytest

from pacinian.acoustics.array import lattice
from pacinian.scene.config_sections import Lattice, PluginConfig
from pacinian.serving.ipc import launch_config, launched_child
from pacinian.serving.ipc.messages import (
    CAPACITIES,
    DeviceStatus,
    FrameHead,
    Permit,
    compute_frame_capacity,
    open_wakes,
)
from pacinian.serving.ipc.shared_memory import SharedRegister, open_folder
from pacinian.serving.settings import Safety, Settings

from ...waiting import PATIENCE, eventually

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

FOREVER = 1e6  # longer than any test [s]
N = len(lattice(0.05, 0.05))
PLUGIN = '''
import ctypes
import os
import time
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
        if self.frames == 3 and self.does == "stick":
            raise OSError("gone")

    def silence(self):
        self.told("silence")
        if self.frames == 3 and self.does == "stick":
            raise OSError("gone")

    def close(self):
        self.told("close")
        if self.does == "stick":
            time.sleep(600)

@pc.hookimpl
def register_backends():
    return [Logged]
'''


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Install the plug-in; return the path of its log."""
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
    """The other processes, as far as a guard needs them."""

    def __init__(self) -> None:
        self.stack = ExitStack()
        self.folder = self.stack.enter_context(open_folder())
        sizes = {**CAPACITIES, "frame": compute_frame_capacity(N)}
        names = "permit", "frame", "selections", "device"
        self.memory = {
            path.name: SharedRegister.create(path, sizes[path.name], open_wakes(path))
            for path in map(self.folder.joinpath, names)
        }
        self.processes: list[launched_child.LaunchedChild] = []
        self.sequence, self.epoch = 0, 1

    def make_config(
        self, log: Path | None = None, does: str = "", hung: float = 60.0
    ) -> launch_config.LaunchConfig:
        options: dict[str, bool | int | float | str] = {"log": str(log), "does": does}
        settings = Settings(
            array=Lattice(0.05, 0.05),
            backend=PluginConfig("logged", options) if log else "simulated",
            safety=Safety(frame_timeout=1.0, hang_timeout=hung),
        )
        return launch_config.LaunchConfig(str(self.folder), settings)

    def start(self, told: launch_config.LaunchConfig) -> launched_child.LaunchedChild:
        self.processes.append(launched_child.start_child("guard", told))
        return self.processes[-1]

    @property
    def device(self) -> DeviceStatus | None:
        read = self.memory["device"].read()
        return None if read is None else msgspec.msgpack.decode(read[1], type=DeviceStatus)

    def until(
        self, so: Callable[[DeviceStatus], object], each: Callable[[], object] = lambda: None
    ) -> DeviceStatus:
        """Wait until the status of the device satisfies `so`; return it."""
        told: DeviceStatus = eventually(lambda: (d := self.device) and so(d) and d, each)
        return told

    def permit(self, until: float = FOREVER, armed: int = 1, stopped: int = 0) -> None:
        permit = Permit(armed, time.perf_counter() + until, self.epoch, stopped)
        self.memory["permit"].write(permit.pack())

    def frame(self) -> None:
        device = self.device
        assert device is not None
        self.sequence += 1
        made_for = device.next_generation or device.generation
        head = FrameHead(self.sequence, 0.0, self.epoch, made_for, 2, N)
        levels = np.full((2, 2, N), 5, np.uint16)
        self.memory["frame"].write(head.pack(), levels.data)

    def sound(self) -> DeviceStatus:
        self.until(lambda device: device.generation > 0)
        self.permit()
        return self.until(lambda device: device.sounding, self.frame)

    def silenced(self, reason: str, **permit: float) -> None:
        """Check that a permit ends sound with this reason. Repeat if sound had ended before, because no frames came."""
        while reason not in self.until(lambda _: True).reasons:
            self.sound()
            self.permit(**permit)  # type: ignore[arg-type]
            self.until(lambda device: not device.sounding)

    def close(self) -> None:
        for process in self.processes:
            launched_child.end_child(process, PATIENCE)
        for memory in self.memory.values():
            memory.close()
        self.stack.close()
