"""Render a recording's scenes again. On the same machine, the frames are equal bit for bit."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.errors import ArgumentError, RecordingError
from pacinian.plugins.backend import Backend, Capability, Frame
from pacinian.rendering.library_versions import compare_versions, list_versions
from pacinian.rendering.renderer import Renderer
from pacinian.rendering.smoothing import Smoothing
from pacinian.scene.sampling.sample_counts import ObjectSampleCounts
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from typing import ClassVar

    from pacinian.acoustics.array import Array
    from pacinian.rendering.clock import Clock
    from pacinian.rendering.recording import Recording, Tick


# Two forces count as equal if they differ by at most this, relative or in [N].
SAME_FORCE = 1e-6
NO_SAMPLES = ObjectSampleCounts(0, 0, 0.0, {})


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


@dataclass(frozen=True)
class Rerendering:
    """How a recording compares with the same scenes rendered again.

    ticks: number of ticks. different: number of those whose frames, (K, N), differ. environment: versions, and variants
    of kernels and libraries, that differ, in words. array: what of the array differs, in words. objects: by
    label, in words, how the samples of an object differed in the first tick in which they did.
    """

    ticks: int
    different: int
    environment: tuple[str, ...] = ()
    array: tuple[str, ...] = ()
    objects: dict[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        lines = [f"{self.ticks} ticks rendered again, {self.different} frames differ"]
        lines += [*self.environment, *self.array]
        lines += [f"object {label!r}: {what}" for label, what in self.objects.items()]
        return "\n".join(lines)


def rerender(recording: Recording, array: Array | None = None) -> Rerendering:
    """Render the recorded scenes again, and compare the frames, (K, N) each.

    Decisions that depend on time are repeated with the recorded clock readings. array: by default the recorded one.
    Raises RecordingError if the recording has no scenes, or is damaged, and ArgumentError if the array has another
    number of transducers.
    """
    ticks = different = 0
    objects: dict[str, str] = {}
    for tick, renderer in iterate_rerendered(recording, array):
        different += not are_equal(tick.frame, renderer.last_frame)
        if renderer.sample_counts != tick.objects:
            for label, what in _compare_objects(tick, renderer.sample_counts):
                objects.setdefault(label, what)
        ticks += 1
    environment = compare_versions(recording.environment, list_versions())
    changes = () if array is None else recording.compare_array(array)
    return Rerendering(ticks, different, environment, changes, objects)


def _compare_objects(
    tick: Tick, now: Mapping[str, ObjectSampleCounts]
) -> Iterator[tuple[str, str]]:
    """Yield the label of each object that was not rendered as recorded, and what differs in words."""
    for label in {**tick.objects, **now}:
        one, other = tick.objects.get(label, NO_SAMPLES), now.get(label, NO_SAMPLES)
        same = math.isclose(one.force, other.force, rel_tol=SAME_FORCE, abs_tol=SAME_FORCE)
        if one[:2] != other[:2] or not same:
            text = f"{one.rendered} of {one.asked} samples, {1e3 * one.force:.4g} mN when recorded"
            text += f", {other.rendered} of {other.asked}, {1e3 * other.force:.4g} mN now"
            yield label, f"{text}, from {tick.time:.3f} s on"


def iterate_rerendered(
    recording: Recording, array: Array | None = None
) -> Iterator[tuple[Tick, Renderer]]:
    """Yield each recorded tick, with the renderer after it has rendered that tick again.

    array: by default the recorded one. Raises RecordingError, ArgumentError.
    """
    clock = FixedClock()
    if array is not None and len(array) != len(recording.positions):
        count = len(recording.positions)
        raise ArgumentError(
            "array", f"must have {count} transducers, as recorded, not {len(array)}"
        )
    try:
        renderer = from_config(
            recording.settings,
            recording.array if array is None else array,
            CaptureBackend(recording.capability),
            clock,
            given=array is not None,
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
            renderer.recording_clocks.tick.tell(list(tick.clock))
            renderer.recording_clocks.job.tell(list(tick.job_clock))
            clock.time = tick.time
            renderer.tick(tick.time)
            if renderer.halted is not None:
                problem = f"tick {number} cannot be rendered again: {renderer.halted.message}"
                raise RecordingError(recording.path, problem)
            yield tick, renderer


def are_equal(a: Frame, b: Frame) -> bool:
    """Return whether two frames have the same levels."""
    return np.array_equal(a.phase, b.phase) and np.array_equal(a.amplitude, b.amplitude)


def from_config(
    settings: dict[str, Any], array: Array, backend: Backend, clock: Clock, *, given: bool = False
) -> Renderer:
    """Make a renderer with these settings and an empty scene. May raise any Exception.

    array: as recorded, or another one that is `given`.
    """
    if not given and settings["transducer"]["directivity"] is None:
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
        adaptive=settings["adaptive"],
        strict=settings["strict"],
        max_cycle_frames=settings["max_cycle_frames"],
        peak=settings["peak"],
        clock=clock,
    )
