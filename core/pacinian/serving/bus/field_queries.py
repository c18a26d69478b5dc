"""Sound-field queries, processed in chunks so that commands do not wait. Pure: callers pass the emitted gains."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.propagation import CHUNK, field
from pacinian.argument_checks import check_near, check_numbers
from pacinian.errors import ArgumentError, WireError, describe_error
from pacinian.plugins.backend import Frame
from pacinian.serving.ipc.messages import HEAD_BYTES, FrameHead
from pacinian.wire.binary_arrays import pack, unpack
from pacinian.wire.replies import Error, Pressures

if TYPE_CHECKING:
    from collections.abc import Generator

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.plugins.backend import Capability
    from pacinian.serving.bus.message_admission import BusSession
    from pacinian.serving.ipc.messages import DeviceStatus
    from pacinian.types import Floats, Gains
    from pacinian.wire.commands import Field
    from pacinian.wire.replies import Reply

Answer = tuple["BusSession", "Reply"]


class EmittedGains:
    """The gains that the device emits, from the frame and the status of the device."""

    def __init__(self, transducers: int) -> None:
        self._silence = np.zeros(transducers, np.complex64)
        self._devices: dict[int, Capability] = {}
        self._sounding = False

    def note_device(self, device: DeviceStatus) -> None:
        """Note the status of the device. Its levels are those of the next device, if there is one."""
        known, generation = self._devices, device.next_generation or device.generation
        levels = known.get(generation) or device.capability
        self._devices = {
            device.generation: known.get(device.generation, levels),
            generation: levels,
        }
        self._sounding = device.sounding

    def decode_gains(self, frame: bytes) -> tuple[Gains, float]:
        """Return the gains (N,) of a frame's last row, and its time [s]; zeros in silence."""
        if not frame:
            return self._silence, 0.0
        head = FrameHead.unpack(frame)
        capability = self._devices.get(head.device)
        levels = np.frombuffer(frame, "<u2", offset=HEAD_BYTES)
        fits = head.columns == len(self._silence) and len(levels) == 2 * head.rows * head.columns
        if capability is None or not self._sounding or not head.rows or not fits:
            return self._silence, head.time
        phase, amplitude = levels.reshape(2, head.rows, head.columns)[:, -1:]
        if amplitude.max() >= len(capability.sizes):  # the guard refuses such a frame
            return self._silence, head.time
        return Frame(head.sequence, head.time, phase, amplitude).gains(capability)[0], head.time


class FieldQueries:
    """Field queries, at most one for each client. They take turns, a chunk each."""

    def __init__(self, array: Array, medium: Air) -> None:
        self._array, self._medium = array, medium
        # Points per chunk: few enough to take less than 1 ms, without other threads.
        self._chunk = max(1, CHUNK // len(array) // 2)
        self._running: dict[BusSession, Generator[None, None, Reply]] = {}

    def __len__(self) -> int:
        return len(self._running)

    def begin(self, client: BusSession, query: Field, emitted: tuple[Gains, float]) -> Error | None:
        """Begin a query, or return the error. Raises WireError."""
        if not query.id:
            raise WireError("must not be 0, because a field query needs an answer", "$.id")
        if client in self._running:
            problem = "the last query is not answered yet"
            return Error(id=query.id, code="busy", message=problem, advice="wait for its answer")
        try:
            points = check_numbers("points", unpack(query.points, 3), (None, 3))
            check_near("points", points, self._array.centre)
        except ArgumentError as error:
            raise WireError(describe_error(error), "$.points") from error
        self._running[client] = self._work(points, query.id, *emitted)
        return None

    def run_chunk(self) -> Answer | None:
        """Process a chunk of the query that waits longest; return the answer if that was the last chunk."""
        client = next(iter(self._running), None)
        if client is None:
            return None
        work = self._running.pop(client)
        try:
            next(work)
        except StopIteration as end:
            return client, end.value
        self._running[client] = work
        return None

    def forget(self, client: BusSession) -> None:
        """Drop the query of a client that has gone."""
        self._running.pop(client, None)

    def _work(
        self,
        points: Floats,
        id: int,  # noqa: A002
        gains: Gains,
        time: float,
    ) -> Generator[None, None, Reply]:
        pressures = np.zeros(len(points), np.complex64)
        for begin in range(0, len(points), self._chunk):
            part = slice(begin, begin + self._chunk)
            try:
                pressures[part] = field(self._array, gains, points[part], self._medium)
            except ArgumentError as error:
                return Error(id=id, code="argument", message=describe_error(error), path="$.points")
            yield
        return Pressures(id=id, pressures=pack(pressures.view(np.float32)), time=time)
