"""Run a guard process without a server: write what the other processes would write, and arm it again and again."""

from __future__ import annotations

import sys
import time
from contextlib import ExitStack
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from pacinian.closeable import Closeable
from pacinian.errors import ServerError
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

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.serving.settings import Settings

MAX_WAIT = 20.0  # [s] longest wait for an answer
# Longest time to write a value [s]; runs with a slower write do not count. A busy machine may need longer for each
# write, so the limit grows by itself with every TRIES writes.
PROMPT, TRIES = 100e-6, 10
POLL_INTERVAL = 50e-6  # [s] between polls
MAX_FRAME_WAIT = 0.2  # [s] longest wait for the guard to take a frame
PARENT = """
import time
from pacinian.serving.ipc import launched_child, parent_link
started = launched_child.start_child("guard", parent_link.Parent().config)
time.sleep(3600)
"""


class GuardProcess(Closeable):
    """A context manager. orphan: `process` is the parent of the guard, so that the parent can be killed."""

    def __init__(self, settings: Settings, *, orphan: bool = False) -> None:
        self._array = settings.array.make()
        self._levels = levels(self._array)
        self._stack = ExitStack()
        self._folder = self._stack.enter_context(open_folder())
        sizes = {**CAPACITIES, "frame": compute_frame_capacity(len(self._array))}
        names = "permit", "frame", "selections", "device"
        self._memory = {
            path.name: SharedRegister.create(path, sizes[path.name], open_wakes(path))
            for path in map(self._folder.joinpath, names)
        }
        self._epoch = self._sequence = 0
        config = launch_config.LaunchConfig(str(self._folder), settings)
        if orphan:
            self.process = launched_child.start_command([sys.executable, "-c", PARENT], config)
        else:
            self.process = launched_child.start_child("guard", config)

    def close(self) -> None:
        """End the process, and remove what it shares."""
        launched_child.end_child(self.process)
        for memory in self._memory.values():
            memory.close()
        self._stack.close()

    def wait(self, so: Callable[[DeviceStatus], bool]) -> DeviceStatus:
        """Wait until `so` accepts the guard's status, and return the status. Raises ServerError after a timeout."""
        if (device := self._look_for(so, MAX_WAIT)) is None:
            raise ServerError(f"the guard has not answered within {MAX_WAIT:g} s")
        return device

    def _look_for(self, so: Callable[[DeviceStatus], bool], limit: float) -> DeviceStatus | None:
        """Return the guard's status once `so` accepts it; None after a time `limit` [s]."""
        due = time.perf_counter() + limit
        while time.perf_counter() < due:
            if (read := self._memory["device"].read()) is not None:
                device = msgspec.msgpack.decode(read[1], type=DeviceStatus)
                if so(device):
                    return device
            time.sleep(POLL_INTERVAL)
        return None

    def permit(self, until: float, stopped: int = 0) -> None:
        """Write the permit of this epoch."""
        self._memory["permit"].write(Permit(1, until, self._epoch, stopped).pack())

    def sound(self) -> tuple[DeviceStatus, float]:
        """Arm the output and wait until a frame sounds.

        Returns the guard's status, and when the frame was written [s].
        """
        device = self.wait(lambda device: device.generation > 0 and not device.sounding)
        self._epoch += 1
        self.permit(time.perf_counter() + MAX_WAIT)
        due, tries = time.perf_counter() + MAX_WAIT, 0
        # Repeat if the machine was so late that the frame was stale, and if the guard dropped the frame, because it
        # read the permit before this one, and then the frame.
        while time.perf_counter() < due:
            self._sequence += 1
            now = time.perf_counter()
            head = FrameHead(
                self._sequence, now, self._epoch, device.generation, 1, len(self._array)
            )
            self._memory["frame"].write(head.pack(), self._levels)
            prompt = time.perf_counter() - now < PROMPT * (1 + tries // TRIES)
            tries += 1
            frames = device.frames
            taken = self._look_for(
                lambda device, frames=frames: device.frames > frames,  # type: ignore[misc]
                MAX_FRAME_WAIT,
            )
            device = taken or device
            if taken is not None and taken.sounding and prompt:
                return taken, now
        raise ServerError(f"the guard has not sounded within {MAX_WAIT:g} s")

    def silent(self, reason: str, before: DeviceStatus) -> float | None:
        """Return when the output fell silent, by the guard's clock [s], or None if the reason was another one."""
        after = self.wait(lambda device: device.silences > before.silences)
        counted = after.reasons.get(reason, 0) > before.reasons.get(reason, 0)
        return after.heartbeat if counted else None


def levels(array: Array) -> bytes:
    """Return the levels of a one-row frame that sounds."""
    return np.full((2, 1, len(array)), 5, np.uint16).tobytes()
