"""The guard of a server, a process of its own, with the real backend; and what it needs of the other processes."""

from __future__ import annotations

import subprocess
import sys
import time
from contextlib import ExitStack
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from pacinian.scene.config_sections import PluginConfig, Units
from pacinian.serving.ipc import launch_config, launched_child, shared_memory
from pacinian.serving.ipc.messages import (
    CAPACITIES,
    DeviceStatus,
    FrameHead,
    Permit,
    Selections,
    compute_frame_capacity,
    pack,
)
from pacinian.serving.settings import Safety, Settings
from pacinian.wire.replies import Plugin

from .device_setup import LONG, TIMEOUT, until

if TYPE_CHECKING:
    from collections.abc import Callable

UNIT = 249  # transducers
# [s]; so a device's buffer outlasts its watchdog, which is what ends the sound
ROWS, LEAD = 4, 0.006
PARENT = """
import subprocess, sys
guard = subprocess.Popen([sys.executable, "-m", "pacinian.serving.guard.process"], stdin=subprocess.PIPE)
guard.stdin.write(bytes.fromhex(sys.argv[1]))
guard.stdin.flush()
sys.exit(guard.wait())
"""


class Server:
    """For one AUTD unit. Permits are put where control puts them, frames where the render process does.

    A context manager; the guard is started by `start`, or by `adopted` below a parent of its own.
    """

    def __init__(self) -> None:
        self._stack = ExitStack()
        self.folder = self._stack.enter_context(shared_memory.open_folder())
        sizes = {**CAPACITIES, "frame": compute_frame_capacity(UNIT)}
        names = "permit", "frame", "selections", "device"
        self.files = {
            n: shared_memory.SharedRegister.create(self.folder / n, sizes[n]) for n in names
        }
        options: dict[str, bool | int | float | str] = {"timeout": TIMEOUT, "lead": LEAD}
        settings = Settings(
            array=Units(1, 1),
            backend=PluginConfig("usb-autd", options),
            safety=Safety(frame_timeout=1.0, hang_timeout=60.0),
        )
        self.told = launch_config.LaunchConfig(str(self.folder), settings)
        # as if by a guard before this one: the first asks all plug-ins what they offer, and so compiles kernels
        before = DeviceStatus(
            generation=0, next_generation=0, name="", phases=2, amplitudes=2, rate=1.0, watchdog=None, heartbeat=0.0,
            sounding=False, backends=(Plugin(name="usb-autd"),),
        )  # fmt: skip
        self.files["device"].write(pack(before))
        self._process: launched_child.LaunchedChild | subprocess.Popen[bytes] | None = None
        self._sequence = self._resets = 0

    def start(self) -> launched_child.LaunchedChild:
        """As control starts it."""
        self._process = process = launched_child.start_child("guard", self.told)
        self._wait_until_open()
        return process

    def adopted(self) -> subprocess.Popen[bytes]:
        """Its parent, which can be killed."""
        told = msgspec.json.encode(self.told)
        words = (len(told).to_bytes(4, "little") + told).hex()
        self._process = subprocess.Popen([sys.executable, "-S", "-c", PARENT, words])
        self._wait_until_open()
        return self._process

    def _wait_until_open(self) -> None:
        """Reset after each fault: the guest may be too slow to open the device in the time that a guard gives it."""

        def is_open(device: DeviceStatus) -> bool:
            if device.fault and f"reset {self._resets}" in (*device.results, "reset 0"):
                self._select_reset()
            return device.generation > 0

        self.until(is_open)

    def device(self) -> DeviceStatus:
        """What the guard tells."""
        read = self.files["device"].read()
        assert read is not None
        return msgspec.msgpack.decode(read[1], type=DeviceStatus)

    def play(self) -> None:
        """A permit, and the next frame."""
        self._sequence += 1
        self.files["permit"].write(Permit(1, time.perf_counter() + LONG, 1).pack())
        head = FrameHead(self._sequence, 0.0, 1, self.device().generation, ROWS, UNIT)
        levels = np.full((2, ROWS, UNIT), 200, np.uint16)
        self.files["frame"].write(head.pack(), levels.data)

    def reset(self) -> None:
        """What a client's reset becomes."""
        self._select_reset()
        self.until(lambda device: f"reset {self._resets}" in device.results)

    def _select_reset(self) -> None:
        self._resets += 1
        self.files["selections"].write(pack(Selections(reset=self._resets)))

    def until(self, so: Callable[[DeviceStatus], object], *, playing: bool = False) -> DeviceStatus:
        """What the guard tells once it is so; meanwhile, frames go on or not."""

        def look() -> DeviceStatus | None:
            if self._process is not None:
                assert self._process.poll() is None, f"the guard ended: {self._process.wait()}"
            if playing:
                self.play()
            device = self.device()
            return device if so(device) else None

        try:
            found: DeviceStatus = until(look)
        except AssertionError as error:
            error.add_note(f"the guard tells: {self.device()}")
            raise
        return found

    def __enter__(self) -> Server:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            if isinstance(self._process, launched_child.LaunchedChild):
                self._process.close()
        for file in self.files.values():
            file.close()
        self._stack.close()
