"""The simulated array: stores emitted frames, evaluates their field, and fails on request."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from msgspec import Meta

import pacinian as pc
from pacinian.argument_checks import check_integer, check_number

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pacinian.types import ArrayLike, Complexes

Levels = Annotated[int, Meta(ge=2, le=1 << 16)]


@dataclass
class Simulated(pc.Backend):
    """An array that exists in memory only.

    phases, amplitudes: levels, as in `pacinian.Capability`; 256 of each by default, like AUTD3 (the paper's device
    has 320 amplitudes). rate: rows per second [Hz]. keep: number of recent frames stored in `frames`.
    wait: function called with the delay [s] of a delayed frame.

    Use `drop`, `delay`, `stall`, `refuse_silence` and `disconnect` to inject faults in tests.
    """

    name: ClassVar[str] = "simulated"

    phases: Levels = 256
    amplitudes: Levels | tuple[float, ...] = 256
    rate: Annotated[float, Meta(ge=1.0, le=1e6)] = 1000.0
    keep: int = 256
    wait: Callable[[float], None] = field(default=time.sleep, repr=False)

    def __post_init__(self) -> None:
        self.keep = check_integer("keep", self.keep, low=1)
        self._capability = pc.Capability(
            self.phases, self.amplitudes, self.rate
        )  # checks its arguments
        self.frames: deque[pc.Frame] = deque(maxlen=self.keep)
        """The last frames emitted."""
        self.array: pc.Array | None = None
        self.received = self.dropped = 0
        self.silent = True
        self._drops, self._delays, self._refusals = 0, deque[float](), 0
        self._open, self._stalled, self._gone = False, False, False

    @property
    def capability(self) -> pc.Capability:
        """The capability, as configured; there is no watchdog."""
        return self._capability

    def open(self, array: pc.Array) -> None:
        """Open the backend for `array`. Raises BackendError if disconnected."""
        self._require()
        self.array, self._open, self.silent = array, True, True

    def send(self, frame: pc.Frame) -> None:
        """Emit a frame. Raises BackendError if not open, disconnected or stalled."""
        self._require()
        if not self._open:
            raise pc.BackendError("the simulated array is not open")
        if self._stalled:
            raise pc.BackendError("the simulated array has stalled: call `resume`")
        if self._delays:
            self.wait(self._delays.popleft())
        if self._drops:
            self._drops -= 1
            self.dropped += 1
            return
        self.received += 1
        self.silent = not frame.amplitude.any()
        kept = replace(frame, phase=frame.phase.copy(), amplitude=frame.amplitude.copy())
        self.frames.append(kept)

    def silence(self) -> None:
        """Stop all sound. A disconnected array is already silent. Raises BackendError after `refuse_silence`."""
        if self._refusals:
            self._refusals -= 1
            raise pc.BackendError("the simulated array refuses to be silent, as requested")
        if self.silent:
            return
        self.silent = True
        last = self.frames[-1]
        after = last.time + len(last.phase) / self.rate
        quiet = pc.Frame(
            last.sequence, after, np.zeros_like(last.phase), np.zeros_like(last.amplitude)
        )
        self.frames.append(quiet)

    def close(self) -> None:
        """Silence the array and close it."""
        self._open = False
        self.silence()

    @property
    def gains(self) -> pc.Gains:
        """The gains emitted now, (N,). Raises BackendError before `open`."""
        if self.array is None:
            raise pc.BackendError("the simulated array is not open")
        if self.silent:
            return np.zeros(len(self.array), dtype=np.complex64)
        return np.asarray(self.frames[-1].gains(self.capability)[-1])

    def field(self, points: ArrayLike, medium: pc.Air) -> Complexes:
        """Return the current complex sound pressure [Pa] at points [m], (..., 3); see `pacinian.field`."""
        gains = self.gains
        assert self.array is not None  # checked by `gains`
        return pc.field(self.array, gains, points, medium)

    def drop(self, count: int) -> None:
        """Drop the next `count` frames without an error."""
        self._drops = check_integer("count", count, low=0)

    def delay(self, seconds: float, count: int = 1) -> None:
        """Take `seconds` [s] for each of the next `count` frames."""
        self._delays.extend([check_number("seconds", seconds, low=0.0)] * count)

    def stall(self) -> None:
        """Refuse frames until `resume`."""
        self._stalled = True

    def resume(self) -> None:
        """Take frames again."""
        self._stalled = False

    def refuse_silence(self, count: int = 1) -> None:
        """Fail the next `count` calls of `silence`; the sound continues."""
        self._refusals = check_integer("count", count, low=0)

    def disconnect(self) -> None:
        """Disconnect the array, as if unplugged, until `reconnect`."""
        self._gone, self.silent = True, True

    def reconnect(self) -> None:
        """Connect the array again; it is silent."""
        self._gone = False

    def _require(self) -> None:
        if self._gone:
            raise pc.BackendError("the simulated array is disconnected: call `reconnect`")


@pc.hookimpl
def register_backends() -> Iterable[type[pc.Backend]]:
    """Return this plug-in's backend."""
    return [Simulated]
