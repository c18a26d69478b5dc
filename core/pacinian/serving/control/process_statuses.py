"""Reads the newest statuses of the other processes, and the newest frame, from shared memory."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, TypeVar

import msgspec
from msgspec import Struct
from msgspec.structs import replace

from pacinian.serving.ipc.messages import (
    HEAD_BYTES,
    NO_DEVICE,
    BusStatus,
    FrameHead,
    RendererStatus,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pacinian.serving.ipc.shared_memory import SharedRegister

S = TypeVar("S", bound=Struct)

NO_RENDERER_STATUS = RendererStatus(-float("inf"), {})
NO_BUS_STATUS = BusStatus(-float("inf"))
NO_FRAME = FrameHead(0, 0.0, 0, 0, 0, 0)


class ProcessStatuses:
    """The newest statuses of the other processes. Values that cannot be read are counted and skipped.

    guarded: whether the guard that sent `device` still runs.
    """

    def __init__(self, memory: Mapping[str, SharedRegister]) -> None:
        self.renderer_status, self.device, self.bus_status = (
            NO_RENDERER_STATUS,
            NO_DEVICE,
            NO_BUS_STATUS,
        )
        self.frame, self.levels = NO_FRAME, b""
        self.unreadable, self.guarded = 0, True
        self._memory = memory
        self._numbers = dict.fromkeys(memory, 0)

    def look(self) -> None:
        """Read the new statuses, except the frame. The known plug-ins are kept while a process restarts."""
        new, known = (
            self._read("renderer_status", self.renderer_status),
            self.renderer_status.solvers,
        )
        self.renderer_status = new if new.solvers else replace(new, solvers=known)
        self.device = self._read("device", self.device)
        self.bus_status = self._read("bus_status", self.bus_status)

    def look_at_frame(self) -> None:
        """Read the newest frame."""
        if new := self._memory["frame"].read(self._numbers["frame"]):
            self._numbers["frame"], data = new
            try:
                self.frame, self.levels = FrameHead.unpack(data), data[HEAD_BYTES:]
            except struct.error:
                self.unreadable += 1

    def _read(self, name: str, old: S) -> S:
        if not (new := self._memory[name].read(self._numbers[name])):
            return old
        self._numbers[name], data = new
        try:
            return msgspec.msgpack.decode(data, type=type(old))
        except (msgspec.DecodeError, ValueError):
            self.unreadable += 1
            return old

    @property
    def any_fault(self) -> bool:
        """Whether the device or the renderer reports a fault."""
        return bool(self.device.fault or self.renderer_status.halted)

    @property
    def results(self) -> dict[str, str]:
        """Results of selections and resets, by "kind number"."""
        return {**self.renderer_status.results, **self.device.results}
