"""The renderer's backend in the server: passes frames to the guard, which alone has the device."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from pacinian.errors import ArgumentError, BackendError, describe_error
from pacinian.plugins.backend import Backend, Capability
from pacinian.rendering.row_times import check_server_rate
from pacinian.serving.ipc.messages import FrameHead

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.plugins.backend import Frame
    from pacinian.rendering.renderer import Renderer
    from pacinian.serving.ipc.messages import DeviceStatus, Permit
    from pacinian.serving.ipc.shared_memory import RegisterReader, SharedRegister
    from pacinian.types import Levels


class Input(NamedTuple):
    """The newest hand update in a frame, the start of its scene and its place in a cycle, as in `FrameHead`."""

    input: int = 0
    sent: float = 0.0
    received: float = 0.0
    start: float = 0.0
    part: int = 0
    parts: int = 0


class SharedFrameBackend(Backend):
    """A backend that writes frames for one device to shared memory.

    file: `frame`. device, permit: as last read. generation, capability: of the device that the frames are for. tag:
    returns what belongs to the frame that is being sent.
    """

    name: ClassVar[str] = "output"

    def __init__(
        self,
        file: SharedRegister,
        device: RegisterReader[DeviceStatus],
        permit: RegisterReader[Permit],
        generation: int,
        capability: Capability,
        tag: Callable[[], Input],
    ) -> None:
        self.generation = generation
        self._file, self._device, self._permit = file, device, permit
        self._capability, self._tag = capability, tag
        self._sequence, self._time, self._columns = 0, 0.0, 0

    @property
    def capability(self) -> Capability:
        """The capability of the device."""
        return self._capability

    def open(self, array: Array) -> None:
        """Set the number of transducers. Nothing sounds before the first frame."""
        self._columns = len(array)

    def send(self, frame: Frame) -> None:
        """Write a frame. Raises BackendError if the device has a fault."""
        if fault := self._device.value.fault:
            raise BackendError(fault)
        self._sequence, self._time = frame.sequence, frame.time
        head = self._make_head(len(frame.phase), self._tag())
        self._file.write(head.pack(), _encode_levels(frame.phase), _encode_levels(frame.amplitude))

    def silence(self) -> None:
        """Write a frame without rows, of no known time in the scene."""
        self._file.write(self._make_head(0, Input(start=self._time)).pack())

    def close(self) -> None:
        """Silence the device."""
        self.silence()

    def _make_head(self, rows: int, tag: Input) -> FrameHead:
        epoch = self._permit.value.epoch
        return FrameHead(
            self._sequence, self._time, epoch, self.generation, rows, self._columns, *tag
        )


class OutputSwitcher:
    """Makes an output for each device that the guard has.

    rate: of the loop [Hz]. file, device, permit, tag: as for `SharedFrameBackend`.
    """

    def __init__(
        self,
        file: SharedRegister,
        device: RegisterReader[DeviceStatus],
        permit: RegisterReader[Permit],
        rate: float,
        tag: Callable[[], Input],
    ) -> None:
        self._file, self._device, self._permit, self._tag = file, device, permit, tag
        self._rate = rate
        self._tried = 0  # last generation tried
        self._newest: SharedFrameBackend | None = None  # the output that `follow` made last

    def make_first(self) -> SharedFrameBackend:
        """Return an output for the current device. Without a device, the loop runs until one comes."""
        try:
            return self._make_output()
        except ArgumentError:
            self._tried = 0  # `follow` reports the error
            return self._make_output_for(0, Capability(rate=self._rate))

    def follow(self, renderer: Renderer) -> dict[str, str]:
        """Let the renderer make frames for the device that needs them; return the errors of a new device.

        A device takes over with its first frame. While the renderer is halted, it makes none, so this writes an empty
        one.
        """
        device, problems = self._device.value, dict[str, str]()
        generation = device.next_generation or device.generation
        if generation not in (0, self._tried):
            problems = self._switch(renderer, generation)
        newest = self._newest
        if renderer.halted is not None and newest and newest.generation == device.next_generation:
            newest.silence()
        return problems

    def _switch(self, renderer: Renderer, generation: int) -> dict[str, str]:
        """Let the renderer make frames for a new device; return its errors."""
        self._tried = generation
        try:
            made = self._make_output()
            made.open(renderer.session.array)
            # The old output stays open, because the guard continues with its last frame.
            renderer.use(made)
        except ArgumentError as error:
            return {f"device {generation}": describe_error(error)}
        self._newest = made
        return {}

    def _make_output(self) -> SharedFrameBackend:
        """Make an output for the device that needs the next frames.

        Raises ArgumentError if the loop does not suit it.
        """
        device = self._device.value
        generation = self._tried = device.next_generation or device.generation
        if not generation:
            raise ArgumentError("backend", "must be open")
        check_server_rate(device.rate, self._rate)
        return self._make_output_for(generation, device.capability)

    def _make_output_for(self, generation: int, capability: Capability) -> SharedFrameBackend:
        return SharedFrameBackend(
            self._file, self._device, self._permit, generation, capability, self._tag
        )


def _encode_levels(levels: Levels) -> memoryview:
    return np.ascontiguousarray(levels, dtype="<u2").data.cast("B")
