"""Installed backends with a log of when they sound, for swaps between them."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any, ClassVar

import pacinian as pc
from pacinian.plugins import registry
from pacinian_lab.server.faults.logging_device import Probe

if TYPE_CHECKING:
    from collections.abc import Iterable


class Through(Probe):
    """An installed backend. Its frames count as sounding as soon as it has taken them."""

    backend: ClassVar[str]
    options: ClassVar[dict[str, Any]] = {}

    def __init__(self) -> None:
        super().__init__()
        self.inner: Any = registry.backend(self.backend, **self.options)
        self._begins = math.inf  # [s] time from which sent frames sound

    @property
    def capability(self) -> pc.Capability:
        """The capability of the backend."""
        can: pc.Capability = self.inner.capability
        return can

    def open(self, array: pc.Array) -> None:
        """Open the backend, silent. Raises its errors; BackendError while unplugged."""
        self._require()
        self.inner.open(array)
        super().open(array)

    def send(self, frame: pc.Frame) -> None:
        """Send a frame, or silence. Raises the backend's errors; BackendError while unplugged."""
        self._require()
        if not frame.amplitude.any():
            self.silence()
            return
        self.inner.send(frame)
        now = time.perf_counter()
        self._begins = min(self._begins, now + self.wait(frame))
        if self._log is not None and now >= self._begins:
            if not self._sounds:
                self._log.write(True, self._begins)
            self._log.write(True, now)
            self._sounds = True

    def wait(self, frame: pc.Frame) -> float:
        """Return the longest time until a frame that is sent now, during silence, sounds [s]."""
        return 0.0

    def silence(self) -> None:
        """End the sound."""
        self.inner.silence()
        self._begins = math.inf
        super().silence()

    def close(self) -> None:
        """End the sound and close the backend."""
        super().close()
        self.inner.close()


class Simulated(Through):
    """The simulated array."""

    name: ClassVar[str] = "probe-simulated"
    backend: ClassVar[str] = "simulated"


class Models(Through):
    """Models of `usb-autd` devices. Frames wait in their buffers, as the models report."""

    name: ClassVar[str] = "probe-usb-autd"
    backend: ClassVar[str] = "usb-autd"
    options: ClassVar[dict[str, Any]] = {"pretend": True}

    def wait(self, frame: pc.Frame) -> float:
        """Return the time until the rows before the frame have been played."""
        if math.isfinite(self._begins):
            return math.inf
        rows = max(board.status().waiting for board in self.inner.boards) - len(frame.phase)
        return float((rows + 1) / self.capability.rate)


@pc.hookimpl
def register_backends() -> Iterable[type[pc.Backend]]:
    """Return both backends."""
    return [Simulated, Models]
