"""Render a recording's scenes again. On the same machine, the frames are equal bit for bit."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.errors import RecordingError
from pacinian.plugins.backend import Backend, Capability, Frame
from pacinian.rendering.renderer import Renderer
from pacinian.rendering.slew_limiter import Smoothing
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import ClassVar

    from pacinian.acoustics.array import Array
    from pacinian.rendering.clock import Clock
    from pacinian.rendering.recording import Recording, Tick


class CaptureBackend(Backend):
    """A backend that keeps the last frame. capability: of the recorded device."""

    name: ClassVar[str] = "kept"

    def __init__(self, capability: Capability) -> None:
        self._capability = capability
        self.frame: Frame | None = None

    @property
    def capability(self) -> Capability:
        """The capability of the recorded device."""
        return self._capability

    def open(self, array: Array) -> None:
        """Nothing to do."""

    def send(self, frame: Frame) -> None:
        """Keep the frame."""
        self.frame = frame

    def silence(self) -> None:
        """Nothing to do."""

    def close(self) -> None:
        """Nothing to do."""


class FixedClock:
    """A clock that returns the time of the tick being rendered again. time: [s]."""

    def __init__(self) -> None:
        self.time = 0.0

    def now(self) -> float:
        """Return `time` [s]."""
        return self.time

    def wait_until(self, due: float) -> None:
        """Return at once."""


def rerender(recording: Recording) -> tuple[int, int]:
    """Render the recorded scenes again; return the number of ticks, and of those whose frames, (K, N), differ.

    Decisions that depend on time are repeated with the recorded clock readings. Raises RecordingError if the recording
    has no scenes, or is damaged.
    """
    ticks = different = 0
    for tick, renderer in iterate_rerendered(recording):
        different += not are_equal(tick.frame, renderer.sent)
        ticks += 1
    return ticks, different


def iterate_rerendered(recording: Recording) -> Iterator[tuple[Tick, Renderer]]:
    """Yield each recorded tick, with the renderer after it has rendered that tick again. Raises RecordingError."""
    clock = FixedClock()
    try:
        renderer = from_config(
            recording.settings, recording.array, CaptureBackend(recording.capability), clock
        )
    except Exception as error:  # damaged settings can raise anything
        raise RecordingError(
            recording.path, f"has no settings with which to render it again: {error}"
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
    """Return whether two frames have the same levels."""
    return np.array_equal(a.phase, b.phase) and np.array_equal(a.amplitude, b.amplitude)


def from_config(settings: dict[str, Any], array: Array, backend: Backend, clock: Clock) -> Renderer:
    """Make a renderer with these settings and an empty scene; array: as recorded. May raise any Exception."""
    if settings["transducer"]["directivity"] is None:
        raise ValueError(
            "the transducers had a directivity that is a Python function, which cannot be recorded: record with "
            "`pacinian.DirectivityTable.sample(function)`"
        )
    return Renderer(
        array,
        Scene(),
        medium=Air(**settings["medium"]),
        backend=backend,
        rate=settings["rate"],
        sampler=Sampler(**settings["sampler"]),
        smoothing=Smoothing(**settings["smoothing"]),
        governed=settings["governed"],
        cycle=settings.get("cycle", 1),
        peak=settings.get("peak", math.inf),
        clock=clock,
    )
