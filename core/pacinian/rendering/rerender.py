"""A recording's scenes rendered again: the same frames, bit for bit, on the same machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.errors import RecordingError
from pacinian.plugins.backend import Backend, Capability, Frame
from pacinian.rendering.settings import from_config

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import ClassVar

    from pacinian.acoustics.array import Array
    from pacinian.rendering.recording import Recording, Tick
    from pacinian.rendering.renderer import Renderer


class CaptureBackend(Backend):
    """Keeps the last frame. capability: of the device that was recorded."""

    name: ClassVar[str] = "kept"

    def __init__(self, capability: Capability) -> None:
        self._capability = capability
        self.frame: Frame | None = None

    @property
    def capability(self) -> Capability:
        """As recorded."""
        return self._capability

    def open(self, array: Array) -> None:
        """Nothing to do."""

    def send(self, frame: Frame) -> None:
        """Keep it."""
        self.frame = frame

    def silence(self) -> None:
        """Nothing to do."""

    def close(self) -> None:
        """Nothing to do."""


class FixedClock:
    """A clock that tells the time of the tick being rendered again. time: [s]."""

    def __init__(self) -> None:
        self.time = 0.0

    def now(self) -> float:
        """Seconds."""
        return self.time

    def wait_until(self, due: float) -> None:
        """At once."""


def rerender(recording: Recording) -> tuple[int, int]:
    """Render the recorded scenes again; return how many ticks, and in how many the frames (K, N) differ.

    recording: with its scenes. All that was decided by time is decided again by the times that were
    noted. Raises RecordingError if the recording lacks its scenes, or is damaged.
    """
    ticks = different = 0
    for tick, renderer in iterate_rerendered(recording):
        different += not are_equal(tick.frame, renderer.sent)
        ticks += 1
    return ticks, different


def iterate_rerendered(recording: Recording) -> Iterator[tuple[Tick, Renderer]]:
    """Each tick as it was, and the renderer as it is after that tick. Raises RecordingError."""
    clock = FixedClock()
    try:
        renderer = from_config(
            recording.settings, recording.array, CaptureBackend(recording.capability), clock
        )
    except Exception as error:  # the file may say anything
        raise RecordingError(
            recording.path, f"has no settings to render it with again: {error}"
        ) from error
    with renderer:
        for number, tick in enumerate(recording.ticks()):
            if tick.asked is None:
                raise RecordingError(recording.path, f"lacks the scene of tick {number}")
            if tick.begins and number:
                renderer.reset()
            renderer.scene, renderer.limits = tick.asked.scene, tick.asked.limits
            renderer.session.solver = tick.asked.solver
            renderer.tape.tell(list(tick.clock))
            clock.time = tick.time
            renderer.tick(tick.time)
            if renderer.halted is not None:
                problem = f"tick {number} cannot be rendered again: {renderer.halted.message}"
                raise RecordingError(recording.path, problem)
            yield tick, renderer


def are_equal(a: Frame, b: Frame) -> bool:
    """Whether two frames have the same levels."""
    return np.array_equal(a.phase, b.phase) and np.array_equal(a.amplitude, b.amplitude)
