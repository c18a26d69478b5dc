"""What a run emitted: gains over time, on an even grid of times, for pictures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pacinian.argument_checks import check_kind, check_number
from pacinian.errors import ArgumentError, RecordingError
from pacinian.rendering.recording import Recording
from pacinian.rendering.renderer import Renderer
from pacinian.scene.scene import Scene

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import Gains

MAX_GAINS = 1 << 27  # gains of one emission: 1 GiB
MAX_GAP = 0.1  # time for which a device repeats its last frame if ticks were missed [s]
SIMULATED = "simulated"

Run = Recording | Renderer | str | Path


@dataclass(frozen=True, eq=False)
class Emission:
    """Gains over time.

    array, medium: of the run. rate: rows per second [Hz]. start: time of the first row, from the run's begin [s].
    gains: (T, N), each row is held until the next. scenes: for each tick, its first row, the time of its scene [s] and
    the scene.
    """

    array: Array
    medium: Air
    rate: float
    start: float
    gains: Gains
    scenes: tuple[tuple[int, float, Scene], ...]

    @property
    def duration(self) -> float:
        """Time from the first row to the end of the last one [s]."""
        return len(self.gains) / self.rate

    def find_scene(self, row: int) -> tuple[float, Scene]:
        """Return the scene that a row belongs to, and its time [s]; an empty one if none was recorded."""
        before = [(t, scene) for first, t, scene in self.scenes if first <= row]
        return before[-1] if before else (0.0, Scene())


def collect_emission(run: Run, start: float = 0.0, duration: float | None = None) -> Emission:
    """Return what a run emitted from `start` on, for `duration` [s]; default: until the end of a recording.

    run: a recording, its file, or a renderer with the simulated backend, which is then run without waiting, from its
    start. Raises ArgumentError, RecordingError, and what the renderer raises when it is opened.
    """
    start = check_number("start", start, low=0.0)
    if duration is not None:
        duration = check_number("duration", duration, low=0.0, above=True)
    if isinstance(run, Renderer):
        return _of_renderer(run, start, duration)
    recording = Recording(run) if isinstance(run, (str, Path)) else run
    check_kind("run", recording, Recording, Renderer)
    return _of_recording(recording, start, duration)


class _Rows:
    """Collects frames into rows at an even rate. size: of a row."""

    def __init__(self, rate: float, start: float, duration: float | None, size: int) -> None:
        self.rate, self.first = rate, round(start * rate)
        self.count = math.inf if duration is None else max(1, round(duration * rate))
        self.size = size
        self._check(0 if duration is None else self.count)
        self._parts: list[Gains] = []
        self._scenes: list[tuple[int, float, Scene]] = []
        self._end = 0  # row after the last one

    def _check(self, count: float) -> None:
        if count * self.size > MAX_GAINS:
            most = MAX_GAINS / self.size / self.rate
            raise ArgumentError("duration", f"must be at most {most:.3g} s: more fills the memory")

    @property
    def full(self) -> bool:
        """Whether all rows are there."""
        return self._end >= self.first + self.count

    def add(self, at: float, gains: Gains, t: float, scene: Scene | None, begins: bool) -> None:
        """Add a frame. at: its time from the begin of the run [s]. gains: (K, N). t: of its scene [s]."""
        row = max(self._end, round(at * self.rate))
        gap = row - self._end
        if gap and self._end:
            silent = begins or gap > MAX_GAP * self.rate
            self._check(row - self.first)
            last = 0.0 * self._parts[-1][-1:] if silent else self._parts[-1][-1:]
            self._parts.append(np.repeat(last, gap, axis=0))
        self._parts.append(gains)
        if scene is not None:
            self._scenes.append((max(0, row - self.first), t, scene))
        self._end = row + len(gains)
        self._check(self._end - self.first)
        if self._end <= self.first:  # keep the last frame only
            self._parts = [self._parts[-1][-1:]]
            self._scenes = self._scenes[-1:]

    def finish(self, array: Array, medium: Air, start: float) -> Emission:
        """Return the rows. Raises ArgumentError if there are none."""
        if self._end <= self.first:
            raise ArgumentError(
                "start", f"is {start:g} s, but the run ends after {self._end / self.rate:.3g} s"
            )
        gains = np.concatenate(self._parts)
        gains = gains[max(0, len(gains) - (self._end - self.first)) :]
        if self.count < len(gains):
            gains = gains[: int(self.count)]
        return Emission(array, medium, self.rate, start, gains, tuple(self._scenes))


def _of_recording(recording: Recording, start: float, duration: float | None) -> Emission:
    can = recording.capability
    rows = _Rows(can.rate, start, duration, len(recording.positions))
    begin, scene = math.nan, None
    for tick in recording.ticks():
        if math.isnan(begin):
            begin = tick.frame.time
        scene = scene if tick.asked is None else tick.asked.scene
        rows.add(tick.frame.time - begin, tick.frame.gains(can), tick.time, scene, tick.begins)
        if rows.full:
            break
    if math.isnan(begin):
        raise RecordingError(recording.path, "has no tick")
    return rows.finish(recording.array, recording.medium, start)


def _of_renderer(renderer: Renderer, start: float, duration: float | None) -> Emission:
    if renderer.backend.name != SIMULATED:
        raise ArgumentError(
            "run",
            f"drives {renderer.backend.name!r}, which would sound: use the backend "
            f"{SIMULATED!r}, or record the run and give the recording",
        )
    if duration is None:
        raise ArgumentError("duration", "must be given: a renderer runs for ever")
    can, session = renderer.backend.capability, renderer.session
    rows = _Rows(can.rate, start, duration, len(session.array))
    ticks = 0
    with renderer:
        while not rows.full:
            at = ticks * renderer.period
            renderer.tick(renderer.start + at)
            if renderer.halted is not None:
                raise ArgumentError("run", f"stopped: {renderer.halted.message}")
            rows.add(at, renderer.last_frame.gains(can), at, renderer.rendered_scene, False)
            ticks += 1
    return rows.finish(session.array, session.medium, start)
