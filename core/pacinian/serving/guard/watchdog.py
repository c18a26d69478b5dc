"""What the guard decides in each round: this frame goes to the device, or there is silence."""

from __future__ import annotations

import math
import struct
import time
from collections import Counter, deque
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from pacinian.errors import BackendError, describe_error, shorten
from pacinian.plugins.backend import Capability, Frame
from pacinian.serving.ipc.messages import HEAD, MAX_ROWS, DeviceStatus, FrameHead, Permit
from pacinian.serving.ipc.scheduling import ANY

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.plugins.backend import Backend
    from pacinian.scene.file import Choice as Configured
    from pacinian.wire.replies import Plugin

MAX_INPUTS = 256  # inputs
NONE = FrameHead(0, 0.0, -1, -1, 0, 0)
_INPUT = struct.Struct("<4d")  # sequence, sent, received, emitted


class OutputGate:
    """Lets frames through to a device while they are permitted and fresh; anything else is silence, at once.

    columns: transducers. gain: no amplitude is above it. stale: age of the newest frame at which there is
    silence [s].

    A device sounds its last frame until the next one, so a frame's age counts from when it was first seen here.
    From `until`, or any other end, to silence it is at most one round: the pause between two calls of `step`, and
    what they take. A backend that does not return cannot be helped from here: the guard's beat stops, and the
    guard is killed, which closes the device.
    """

    def __init__(
        self,
        columns: int,
        *,
        gain: float,
        stale: float,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.backend: Backend | None = None
        self.coming: Backend | None = None
        """Open, and waits for the first frame for it."""
        self.leaving: list[Backend] = []
        """To be closed."""
        self._stuck: list[Backend] = []  # left while loud, and not closed yet
        self._why = ""  # the fault by which the last of them was
        self.loud = False
        """Something was sent since the last silence."""
        self.generation = self.next = 0
        self.fault = ""
        self.sounding = self.stale = False
        self.changed = True
        """There is something that others should know at once; set back by who tells them."""
        self._columns, self._gain, self._stale, self._clock = columns, gain, stale, clock
        self._generations = 0
        self._can = self._coming_can = Capability()
        self._head, self._data = NONE, b""  # the newest frame
        self._waits = False  # it has not been let through yet
        # [s]: when it was seen, and the last one that was ours, and the epoch
        self._seen = self._fed = self._armed = -math.inf
        self._epoch = -1
        self._passed = math.nan  # [s] when the last frame of this epoch was let through
        self._gap = 0.0  # [s]
        self._frames = self._input = self._inputs_until = 0
        self._reasons: Counter[str] = Counter()
        self._inputs: deque[bytes] = deque(maxlen=MAX_INPUTS)

    def take(self, backend: Backend, can: Capability) -> int:
        """An open device, which takes over with the first frame for it, or at once from none; its generation."""
        self._generations += 1
        self.changed = True
        if self.backend is None:
            self._ended("replaced")
            self.backend, self.generation, self._can = backend, self._generations, can
        else:
            if self.coming is not None:
                self.leaving.append(self.coming)
            self.coming, self.next, self._coming_can = backend, self._generations, can
        return self._generations

    def replace(self, last: DeviceStatus) -> None:
        """Go on after another guard: frames for its devices are not for ours, which ends its sound once it is open."""
        self._generations = max(last.generation, last.next, self._generations)
        self.sounding, self.changed = last.sounding, True

    @property
    def stuck(self) -> bool:
        """A device that was left may sound, and is not closed yet."""
        return bool(self._stuck)

    def release(self) -> Backend | None:
        """The device, to be closed; there is none from now on."""
        backend, self.backend = self.backend, None
        if backend is not None and self.loud:
            self._stuck.append(backend)
            self._why = self.fault
        self.loud = False
        self._ended("fault")
        return backend

    def closed(self, backend: Backend) -> None:
        """A device that was left is closed, and so silent; from any thread."""
        with suppress(ValueError):
            self._stuck.remove(backend)
            self.changed = True

    @property
    def problem(self) -> str:
        """The fault, also one that is mended as soon as the device that was left is closed."""
        return self.fault or (self._why if self._stuck else "")

    def fail(self, problem: str) -> None:
        """Silence until `clear`."""
        if not self.fault:
            self.fault, self.changed = problem, True

    def clear(self) -> None:
        """The fault is mended."""
        self.fault, self.changed = "", True

    def step(self, permit: Permit, frame: bytes | None = None) -> bool:
        """One round. permit: the newest. frame: the newest; None if it is that of the last round.

        Whether the next round is to follow at once, with the permit of then: another device has taken over.
        """
        now = self._clock()
        if permit.epoch != self._epoch:
            self._epoch, self._armed, self._passed, self._gap = permit.epoch, now, math.nan, 0.0
        if frame is not None:
            self._see(frame, now)
            if self.next and self._head.device == self.next:
                self.switch()
                return True
        reason = self._reason(permit, now)
        if self.stale != (reason == "stale"):
            self.stale, self.changed = not self.stale, True
        if reason:
            self.silence(reason)
        if self._waits and reason in ("", "empty"):
            self._waits = False
            if reason or self._send():
                self._note()
        return False

    def _see(self, frame: bytes, now: float) -> None:
        try:
            self._head, self._data = FrameHead.unpack(frame), frame
        except struct.error:
            self._head = NONE
            self.fail("frame: it is cut off")
        self._seen, self._waits = now, True

    def _reason(self, permit: Permit, now: float) -> str:
        """Why there must be silence; "" if there may be sound."""
        if self.fault or self._stuck or self.backend is None:
            return "fault"
        if permit.stopped:
            return "stopped"
        if not permit.armed:
            return "disarmed"
        if not now < permit.until:
            return "expired"
        if self._head.epoch == permit.epoch and self._head.device == self.generation:
            self._fed = self._seen
            if now - self._seen < self._stale:
                return "" if self._head.rows else "empty"
        return "stale" if now - max(self._fed, self._armed) >= self._stale else "waiting"

    def silence(self, reason: str) -> None:
        """If there may be sound, end it; to be asked for again while `loud`."""
        if self.backend is None or not self.loud:
            return
        try:
            self.backend.silence()
        except Exception as error:
            self.fail(describe_error(error))
            return
        self.loud = False
        self._ended(reason)

    def _ended(self, reason: str) -> None:
        if self.sounding:
            self.sounding, self.changed = False, True
            self._reasons[reason] += 1

    def switch(self) -> None:
        """The device that waits takes over: but first, one that refuses to be silent is a fault."""
        faulty = bool(self.fault)
        self.silence("switched")
        if self.loud and not faulty:
            return
        if (old := self.release()) is not None:
            self.leaving.append(old)
        self.backend, self.generation, self._can = self.coming, self.next, self._coming_can
        self.coming, self.next, self.changed = None, 0, True

    def _send(self) -> bool:
        """The newest frame goes out; whether it did."""
        backend, head = self.backend, self._head
        if backend is None:
            return False
        try:
            frame = _frame(head, self._data, self._columns, self._can, self._gain)
            self.loud = True
            backend.send(frame)
        except Exception as error:
            self.fail(describe_error(error))
            self.silence("fault")
            return False
        self._frames += 1
        sounding = bool(frame.amplitude.any())
        if sounding != self.sounding:
            self.sounding, self.changed = sounding, True
        return True

    def _note(self) -> None:
        """The newest frame, or its silence, is what the device does now."""
        now, head = self._clock(), self._head
        self._gap = max(self._gap, now - self._passed)
        self._passed = now
        if head.input and head.input != self._input:  # silence has none
            self._input = head.input
            self._inputs.append(_INPUT.pack(head.input, head.sent, head.received, now))
            self._inputs_until += 1

    def device(
        self,
        results: dict[str, str],
        backends: tuple[Plugin, ...],
        processor: int = ANY,
        choice: Configured | None = None,
    ) -> DeviceStatus:
        """What others are told."""
        can = self._can if self.coming is None else self._coming_can
        return DeviceStatus(
            generation=0 if self.backend is None else self.generation,
            next=self.next,
            name="" if self.backend is None else shorten(self.backend.name),
            phases=can.phases,
            amplitudes=len(can.sizes),
            rate=can.rate,
            watchdog=can.watchdog,
            beat=self._clock(),
            sounding=self.sounding,
            fault=self.problem,
            frames=self._frames,
            silences=self._reasons.total(),
            stale=self.stale,
            longest_gap=self._gap,
            inputs=b"".join(self._inputs),
            inputs_until=self._inputs_until,
            results=results,
            backends=backends,
            reasons=dict(self._reasons),
            processor=processor,
            choice=choice,
            sizes=b"" if can.even else can.sizes.astype("<f4").tobytes(),
        )


def _frame(head: FrameHead, data: bytes, columns: int, can: Capability, gain: float) -> Frame:
    """The frame whose head this is. Raises BackendError for one that no device of ours is to get."""
    size = HEAD + 4 * head.rows * columns
    if head.columns != columns or not 0 < head.rows <= MAX_ROWS or len(data) != size:
        raise BackendError(
            f"a frame of {head.rows} x {head.columns} levels in {len(data)} bytes for {columns} transducers"
        )
    levels = np.frombuffer(data, "<u2", offset=HEAD)
    phase, amplitude = levels.reshape(2, head.rows, columns)
    if phase.max() >= can.phases or amplitude.max() > can.highest(gain):
        raise BackendError(f"a frame with levels beyond the device's, or the gain limit {gain:g}")
    return Frame(head.sequence, head.time, phase, amplitude)
