"""The guard's decision in each round: send the frame to the device, or silence the device.

How old a frame may be is `Safety.frame_timeout` in settings.py.
"""

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
from pacinian.rendering.row_times import MAX_SERVER_ROWS
from pacinian.serving.ipc.messages import HAND_UPDATE, HEAD_BYTES, DeviceStatus, FrameHead, Permit
from pacinian.serving.ipc.scheduling import ANY_CORE

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.plugins.backend import Backend
    from pacinian.scene.config_sections import PluginConfig
    from pacinian.wire.replies import Plugin

# Largest number of hand updates kept for the status.
MAX_INPUTS = 256
REJECTED_FRAME = FrameHead(0, 0.0, -1, -1, 0, 0)


class OutputGate:
    """Passes frames to a device while they are permitted and fresh; otherwise silences the device at once.

    columns: number of transducers. gain: upper limit of every amplitude. frame_timeout: the device is
    silenced when its newest frame is older than this [s].

    A device plays a frame until it gets the next one. The age of a frame therefore counts from the time at which the
    gate first saw it. When a permit ends, at `until` or earlier, silence follows within at most one round: the pause
    between two calls of `step`, plus the duration of both calls. If a backend does not return, the gate cannot silence
    the device. The guard's heartbeat then stops, and the guard is killed, which closes the device.
    """

    def __init__(
        self,
        columns: int,
        *,
        gain: float,
        frame_timeout: float,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.backend: Backend | None = None
        self.next_backend: Backend | None = None
        """An open device that takes over with the first frame for it."""
        self.to_close: list[Backend] = []
        """Released and replaced devices. The device manager closes them, because that may take long."""
        self._stuck: list[Backend] = []  # released while loud, and not closed yet
        self._why = ""  # the fault for which the newest of these devices was released
        self.loud = False
        """A frame was sent since the last silence."""
        self.generation = self.next_generation = 0
        self.fault = ""
        self.sounding = self.is_stale = False
        self.changed = True
        """There is news to report at once; the reporter clears it."""
        self._columns, self._gain, self._max_age, self._clock = columns, gain, frame_timeout, clock
        self._generations = 0
        self._capability = self._next_capability = Capability()
        self._head, self._data = REJECTED_FRAME, b""  # the newest frame
        self._waits = False  # the newest frame has not been let through yet
        # Times at which the newest frame, and the last one for this device and epoch, were seen [s].
        self._seen = self._last_valid_frame_seen = -math.inf
        self._epoch, self._epoch_began = -1, -math.inf
        # When the last frame of this epoch was let through [s].
        self._passed = math.nan
        self._gap = 0.0  # longest gap between frames in this epoch [s]
        self._frames = self._input = self._input_count = 0
        self._reasons: Counter[str] = Counter()
        self._inputs: deque[bytes] = deque(maxlen=MAX_INPUTS)

    def adopt_device(self, backend: Backend, can: Capability) -> int:
        """Take an open device and return its generation.

        The device takes over with its first frame, or at once if there is no other.
        """
        self._generations += 1
        self.changed = True
        if self.backend is None:
            self._end_sound("replaced")
            self.backend, self.generation, self._capability = backend, self._generations, can
        else:
            if self.next_backend is not None:
                self.to_close.append(self.next_backend)
            self.next_backend, self.next_generation, self._next_capability = (
                backend,
                self._generations,
                can,
            )
        return self._generations

    def take_over_from(self, last: DeviceStatus) -> None:
        """Take over from another guard. Devices get new generations, so that frames for its devices are rejected.

        Opening this guard's device ends the sound of the previous guard's device.
        """
        self._generations = max(last.generation, last.next_generation, self._generations)
        self.sounding, self.changed = last.sounding, True

    @property
    def stuck(self) -> bool:
        """Whether a released device may still sound, because it is not closed yet."""
        return bool(self._stuck)

    def release(self) -> Backend | None:
        """Detach the device and return it, to be closed. Afterwards there is no device."""
        backend, self.backend = self.backend, None
        if backend is not None and self.loud:
            self._stuck.append(backend)
            self._why = self.fault
        self.loud = False
        self._end_sound("fault")
        return backend

    def mark_closed(self, backend: Backend) -> None:
        """Note that a released device is closed, and so silent. May be called from any thread."""
        with suppress(ValueError):
            self._stuck.remove(backend)
            self.changed = True

    @property
    def problem(self) -> str:
        """The fault, or the cleared fault of a released device that is not closed yet."""
        return self.fault or (self._why if self._stuck else "")

    def fail(self, problem: str) -> None:
        """Set the fault: silence until `clear`."""
        if not self.fault:
            self.fault, self.changed = problem, True

    def clear(self) -> None:
        """Clear the fault."""
        self.fault, self.changed = "", True

    def step(self, permit: Permit, frame: bytes | None = None) -> bool:
        """Run one round. permit: the newest. frame: the newest; None if it is that of the last round.

        Returns True if another device has taken over: run the next round at once, with the permit at that time.
        """
        now = self._clock()
        if permit.epoch != self._epoch:
            self._epoch, self._epoch_began = permit.epoch, now
            self._passed, self._gap = math.nan, 0.0
        if frame is not None:
            self._note_frame(frame, now)
            if self.next_generation and self._head.device == self.next_generation:
                self.switch_device()
                return True
        reason = self._find_reason(permit, now)
        if self.is_stale != (reason == "stale"):
            self.is_stale, self.changed = not self.is_stale, True
        if reason:
            self.silence(reason)
        if self._waits and reason in ("", "empty"):
            self._waits = False
            if reason or self._send():
                self._record_passed()
        return False

    def compute_time_left(self, permit: Permit) -> float:
        """Return the time after which the device must be silenced, unless a newer permit or frame comes [s].

        Infinite if it is silent; 0 if it should be.
        """
        if not self.loud:
            return math.inf
        now = self._clock()
        return (
            0.0
            if self._find_reason(permit, now)
            else min(permit.until, self._seen + self._max_age) - now
        )

    def _note_frame(self, frame: bytes, now: float) -> None:
        try:
            self._head, self._data = FrameHead.unpack(frame), frame
        except struct.error:
            self._head = REJECTED_FRAME
            self.fail("the frame is cut off")
        self._seen, self._waits = now, True

    def _find_reason(self, permit: Permit, now: float) -> str:
        """Return the reason why there must be silence; "" if there may be sound."""
        if self.fault or self._stuck or self.backend is None:
            return "fault"
        if permit.stopped:
            return "stopped"
        if not permit.armed:
            return "disarmed"
        if not now < permit.until:
            return "expired"
        if self._head.epoch == permit.epoch and self._head.device == self.generation:
            self._last_valid_frame_seen = self._seen
            if now - self._seen < self._max_age:
                return "" if self._head.rows else "empty"
        waited = now - max(self._last_valid_frame_seen, self._epoch_began)
        return "stale" if waited >= self._max_age else "waiting"

    def silence(self, reason: str) -> None:
        """Silence the device if it may sound. Call again while `loud` is still set."""
        if self.backend is None or not self.loud:
            return
        try:
            self.backend.silence()
        except Exception as error:
            self.fail(describe_error(error))
            return
        self.loud = False
        self._end_sound(reason)

    def _end_sound(self, reason: str) -> None:
        if self.sounding:
            self.sounding, self.changed = False, True
            self._reasons[reason] += 1

    def switch_device(self) -> None:
        """Let the waiting device take over, unless the current one refuses to be silent: then set the fault."""
        faulty = bool(self.fault)
        self.silence("switched")
        if self.loud and not faulty:
            return
        if (old := self.release()) is not None:
            self.to_close.append(old)
        self.backend, self.generation, self._capability = (
            self.next_backend,
            self.next_generation,
            self._next_capability,
        )
        self.next_backend, self.next_generation, self.changed = None, 0, True

    def _send(self) -> bool:
        """Send the newest frame; return whether that succeeded."""
        backend, head = self.backend, self._head
        if backend is None:
            return False
        try:
            frame = _decode_frame(head, self._data, self._columns, self._capability, self._gain)
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

    def _record_passed(self) -> None:
        """Record that the newest frame, or its silence, is now at the device."""
        now, head = self._clock(), self._head
        self._gap = max(self._gap, now - self._passed)
        self._passed = now
        if head.input and head.input != self._input:  # 0: a silent frame, which has no input
            self._input = head.input
            self._inputs.append(HAND_UPDATE.pack(head.input, head.sent, head.received, now))
            self._input_count += 1

    def make_status(
        self,
        results: dict[str, str],
        backends: tuple[Plugin, ...],
        processor: int = ANY_CORE,
        choice: PluginConfig | None = None,
    ) -> DeviceStatus:
        """Return the status to report to the other processes."""
        can = self._capability if self.next_backend is None else self._next_capability
        return DeviceStatus(
            generation=0 if self.backend is None else self.generation,
            next_generation=self.next_generation,
            # The registry has checked the name of the class, not that of the instance.
            name="" if self.backend is None else shorten(type(self.backend).name),
            phases=can.phases,
            amplitudes=len(can.sizes),
            rate=can.rate,
            watchdog=can.watchdog,
            heartbeat=self._clock(),
            sounding=self.sounding or self.stuck,
            fault=self.problem,
            frames=self._frames,
            silences=self._reasons.total(),
            stale=self.is_stale,
            longest_gap=self._gap,
            inputs=b"".join(self._inputs),
            input_count=self._input_count,
            results=results,
            backends=backends,
            reasons=dict(self._reasons),
            processor=processor,
            choice=choice,
            sizes=b"" if can.uniform else can.sizes.astype("<f4").tobytes(),
        )


def _decode_frame(
    head: FrameHead, data: bytes, columns: int, can: Capability, gain: float
) -> Frame:
    """Return the frame with this head. Raises BackendError for a frame that no device may get."""
    size = HEAD_BYTES + 4 * head.rows * columns
    if head.columns != columns or not 0 < head.rows <= MAX_SERVER_ROWS or len(data) != size:
        raise BackendError(
            f"a frame has {head.rows} x {head.columns} levels in {len(data)} bytes, but the array has "
            f"{columns} transducers"
        )
    levels = np.frombuffer(data, "<u2", offset=HEAD_BYTES)
    phase, amplitude = levels.reshape(2, head.rows, columns)
    if phase.max() >= can.phases or amplitude.max() > can.highest(gain):
        raise BackendError(
            f"a frame contains levels that the device cannot emit, or that exceed the gain limit {gain:g}"
        )
    return Frame(head.sequence, head.time, phase, amplitude)
