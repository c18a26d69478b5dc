"""The simulated array: keeps what was emitted, evaluates its field, and fails on request."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from msgspec import Meta

import pacinian as pc
from pacinian.checks import check_integer, check_number

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pacinian.types import ArrayLike, Complexes

Levels = Annotated[int, Meta(ge=2, le=1 << 16)]


@dataclass
class Simulated(pc.Backend):
    """An array that exists in memory only.

    phases, amplitudes: levels, as of `pacinian.Capability`; 256 of each, as AUTD3 (the paper's device has 320
    amplitudes).
    rate: frames per second [Hz]. keep: how many of the last frames stay in `frames`. wait: what a delayed
    or stalled frame calls with its seconds.

    To test what is built on it: `drop`, `delay`, `stall`, `refuse_silence` and `disconnect`.
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
        )  # which checks them
        self.frames: deque[pc.Frame] = deque(maxlen=self.keep)
        """The last frames emitted."""
        self.array: pc.Array | None = None
        self.received = self.dropped = 0
        self.silent = True
        self._drops, self._delays, self._refusals = 0, deque[float](), 0
        self._open, self._stalled, self._gone = False, False, False

    @property
    def capability(self) -> pc.Capability:
        """As set; it has no watchdog."""
        return self._capability

    def open(self, array: pc.Array) -> None:
        """Stand for `array`. Raises BackendError if disconnected."""
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
        """Stop all sound. A disconnected array is silent: it has no drive. Raises BackendError as told."""
        if self._refusals:
            self._refusals -= 1
            raise pc.BackendError("the simulated array refuses to be silent, as it was told")
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
        """Silence."""
        self._open = False
        self.silence()

    @property
    def gains(self) -> pc.Gains:
        """The gains that sound now, (N,). Raises BackendError before `open`."""
        if self.array is None:
            raise pc.BackendError("the simulated array is not open")
        if self.silent:
            return np.zeros(len(self.array), dtype=np.complex64)
        return np.asarray(self.frames[-1].gains(self.capability)[-1])

    def field(self, points: ArrayLike, medium: pc.Air | None = None) -> Complexes:
        """Complex sound pressure [Pa] that sounds now at points [m], (..., 3): see `pacinian.field`."""
        gains = self.gains
        assert self.array is not None  # `gains` has asked
        return pc.field(self.array, gains, points, medium)

    def drop(self, count: int) -> None:
        """Lose the next `count` frames without a word."""
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
        """Fail the next `count` calls of `silence`, and go on sounding."""
        self._refusals = check_integer("count", count, low=0)

    def disconnect(self) -> None:
        """Be gone, as if unplugged, until `reconnect`."""
        self._gone, self.silent = True, True

    def reconnect(self) -> None:
        """Be there again, silent."""
        self._gone = False

    def _require(self) -> None:
        if self._gone:
            raise pc.BackendError("the simulated array is disconnected: call `reconnect`")


@pc.hookimpl
def register_backends() -> Iterable[type[pc.Backend]]:
    """This plug-in's backend."""
    return [Simulated]
