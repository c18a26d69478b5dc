"""The guard process: the only process that holds the device, and the one that must fail last.

It has no socket and solves nothing. A new permit or frame wakes it; output_gate.py makes the decisions.
However it ends, it silences the device last. If the guard cannot end by itself, the operating system kills it, which
closes the device.
"""

from __future__ import annotations

import contextlib
import functools
import gc
import math
import os
import signal
import sys
import threading
import time
from typing import TYPE_CHECKING

import msgspec
from msgspec.msgpack import Decoder

from pacinian.errors import describe_error
from pacinian.scene.config_sections import PluginConfig
from pacinian.serving.guard.device_manager import DeviceManager
from pacinian.serving.guard.output_gate import OutputGate
from pacinian.serving.guard.spare_guard import stand_by
from pacinian.serving.ipc import parent_link, scheduling, shared_memory
from pacinian.serving.ipc.logs import configure, log
from pacinian.serving.ipc.messages import (
    DeviceStatus,
    Permit,
    Selections,
    open_wake_pipe,
    open_wakes,
    pack,
)
from pacinian.serving.ipc.plugin_list import find_plugin, publish_offers
from pacinian.serving.ipc.refused_setting import refuse_setting
from pacinian.serving.ipc.shared_memory import RegisterReader, SharedRegister
from pacinian.serving.ipc.system_setup import trim_memory

if TYPE_CHECKING:
    from pathlib import Path
    from types import FrameType

    from pacinian.serving.settings import Settings
    from pacinian.wire.replies import Plugin

# Polling interval while there may be sound and nothing wakes the guard in time, and otherwise [s].
POLL_INTERVAL, IDLE_INTERVAL = 0.25e-3, 1e-3
# Interval between two status reports while there is something to do, and while there is nothing to do [s].
REPORT_INTERVAL, REST_REPORT_INTERVAL = 0.01, 0.05
# Thread switch interval [s]. A thread that opens a device yields to the sounding one after this time.
THREAD_SWITCH_INTERVAL = 1e-4
MAX_EXIT_TIME = 1.0  # time limit for the guard to end after its parent has gone [s]
# Time to wait for the parent's lock on the shared memory after the parent has gone [s].
LOCK_WAIT = 0.1
# Alarm delay, as a multiple of `hang_timeout`: control can tell a slow guard from a hung one, so it gets to
# kill the guard first.
ALARM_FACTOR = 2.0


class GuardLoop:
    """Connects an output gate to the shared memory in `folder`. A context manager: leaving it silences the device.

    The constructor does the slow work; entering opens the device. backends: the backends that can be selected; None
    until they are known, or those that the previous guard reported. The guard reports nothing until it knows `backends`
    and has a device or a fault, unless it replaces another guard. Raises ServerError if the folder lacks a file.
    """

    def __init__(self, folder: Path, settings: Settings) -> None:
        with contextlib.ExitStack() as stack:
            permit, frame, selections = (
                stack.enter_context(SharedRegister.attach(folder / name))
                for name in ("permit", "frame", "selections")
            )
            path = folder / "device"
            device = stack.enter_context(SharedRegister.attach(path, open_wakes(path)))
            self._wake = open_wake_pipe(folder, "guard")
            stack.callback(self._wake.close)
            self._stack = stack.pop_all()
        self._permit = RegisterReader(permit, Permit.unpack, Permit())
        self._frame = RegisterReader(frame, bytes, b"")
        self._selections = RegisterReader(selections, Decoder(Selections).decode, Selections())
        self._last: RegisterReader[DeviceStatus | None] = RegisterReader(
            device, Decoder(DeviceStatus).decode, None
        )
        self._device = device
        self.backends: tuple[Plugin, ...] | None = None
        self._replaces = False
        array = settings.array.make()
        self.gate = OutputGate(
            len(array), gain=settings.gain, frame_timeout=settings.safety.frame_timeout
        )
        chosen = settings.backend
        configured = chosen if isinstance(chosen, PluginConfig) else PluginConfig(chosen)
        self.devices = DeviceManager(self.gate, array, configured, settings.rate)
        self.processor = scheduling.ANY_CORE
        self._reported_at = -REPORT_INTERVAL  # [s]
        # There is nothing to do until time passes, or a new permit, frame or selection ends the wait.
        self._listens = False
        self._selections.look()
        with contextlib.suppress(Exception):  # opening the device reports the same error
            find_plugin(
                "backend", (self._selections.value.backend[1] or configured).name
            )  # imports it

    @property
    def first(self) -> bool:
        """Whether there was no guard before this one, so that the settings have not proved themselves."""
        return not self._replaces

    def read_heartbeat(self) -> tuple[float, bool]:
        """Return the running guard's last heartbeat [s], and whether there may be sound. A spare calls this."""
        last = self._read_last_status()
        self._permit.look()
        if last is None or not last.generation:
            return 0.0, False
        return last.heartbeat, last.sounding or self._permit.value.armed > 0

    def __enter__(self) -> GuardLoop:
        """Start opening the device; take over from the previous guard, if there was one."""
        self._selections.look()
        last = self._read_last_status()
        if last is not None:
            self._replaces, self.backends = True, last.backends
            self.gate.take_over_from(last)
        elif published := self._device.number:
            # The previous guard's status cannot be read, so its device may still sound. Each device was reported at
            # least once, so the number of reports is at least the last generation.
            self._replaces = True
            unknown = DeviceStatus(published, 0, "", 2, 2, 1.0, None, -math.inf, sounding=True)
            self.gate.take_over_from(unknown)
        self.devices.begin(self._selections.value, last.choice if last else None)
        return self

    def _read_last_status(self) -> DeviceStatus | None:
        """Return the newest status of the previous guard; None if there is none, or it cannot be read."""
        try:
            self._last.look()
        except (msgspec.DecodeError, ValueError) as error:
            log().error("the previous guard's status cannot be read", error=describe_error(error))
            self._last.value = None
        return self._last.value

    def run_round(self) -> float:
        """Run one round; return the time to `wait` until the next [s]."""
        gate = self.gate
        if self._selections.look():
            self.devices.follow(self._selections.value)
        self.devices.poll()
        frame = self._frame.value if self._frame.look() else None
        # Read the permit after the frame, so that it is never older than the permit the frame was
        # made for.
        self._permit.look()
        switched = gate.step(self._permit.value, frame)
        now = time.perf_counter()
        known = self.backends is not None and (self._replaces or gate.backend or gate.fault)
        if known and (gate.changed or now - self._reported_at >= REPORT_INTERVAL):
            self.publish_status()
            self._reported_at = now
        if switched:
            return 0.0
        permit, pending = self._permit.value, gate.stuck or self.devices.busy
        if not (permit.armed or gate.loud):
            self._listens = bool(known) and not pending
            return REST_REPORT_INTERVAL if self._listens else IDLE_INTERVAL
        left = gate.compute_time_left(permit)
        self._listens = self._wake.works and not pending and left > 0.0
        if not self._listens:
            return POLL_INTERVAL
        return min(left, max(REPORT_INTERVAL - (now - self._reported_at), POLL_INTERVAL))

    def wait(self, seconds: float) -> None:
        """Wait until the next round; if only time can change anything, until a new permit, frame or selection."""
        if self._listens:
            self._wake.wait(seconds, lambda: self._permit.waiting or self._selections.waiting)
        else:
            time.sleep(seconds)

    def wake(self) -> None:
        """End the wait. May be called from any thread, and from a signal handler."""
        self._wake.wake()

    def publish_status(self) -> None:
        """Publish the device status."""
        self.gate.changed = False
        self._device.write(
            pack(
                self.gate.make_status(
                    self.devices.results, self.backends or (), self.processor, self.devices.choice
                )
            )
        )

    def __exit__(self, *_: object) -> None:
        """Silence the device, report the final status, and close everything."""
        gate, due = self.gate, time.perf_counter() + 0.5 * MAX_EXIT_TIME
        with self._stack:
            gate.silence("end")
            while gate.loud and time.perf_counter() < due:
                time.sleep(IDLE_INTERVAL)
                gate.silence("end")
            with contextlib.suppress(Exception):
                self.publish_status()
            for backend in (gate.backend, gate.next_backend, *gate.to_close):
                if backend is not None:
                    with contextlib.suppress(BaseException):  # whatever a plug-in raises
                        backend.close()


def _rearm_alarm(seconds: float) -> None:
    """Arm a SIGALRM that kills this process, and so closes the device, unless re-armed in `seconds`; 0 disables it."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, seconds)  # SIGALRM has no handler


def main() -> None:
    """Run until the parent ends or asks this process to end. A spare first waits until it is activated."""
    ended = threading.Event()

    def end() -> None:
        ended.set()
        loop.wake()

    def orphaned() -> None:
        end()
        time.sleep(MAX_EXIT_TIME)
        os._exit(1)  # a backend blocks the exit; the system closes the device

    def asked(number: int, frame: FrameType | None) -> None:
        end()

    parent = parent_link.Parent()
    config = parent.config
    configure(config.settings.log, "guard")
    sys.setswitchinterval(THREAD_SWITCH_INTERVAL)
    loop = GuardLoop(config.path, config.settings)
    if config.spare:
        parent.prepare()
        _settle(loop)
        stand_by(parent, config.settings.safety.hang_timeout, loop.read_heartbeat)
    for name in (signal.SIGTERM, signal.SIGINT):
        signal.signal(name, asked)
    parent.watch(orphaned, kill=False)
    with loop:
        while not (ended.is_set() or loop.gate.backend or loop.gate.fault):
            loop.run_round()  # opening a device may take long
            time.sleep(IDLE_INTERVAL)
        if loop.devices.wrong_setting and loop.first:
            problem = loop.gate.fault
            loop.gate.clear()  # control reports the setting instead of a fault
            refuse_setting(config.path, loop.devices.wrong_setting, problem)
        if loop.backends is None:
            # Listing the backends takes long, but an open device is still silent here.
            publish_offers("backend", functools.partial(setattr, loop, "backends"))
        _settle(loop)
        while not ended.is_set():
            # While a released device is still open, let the alarm kill this process, which closes
            # the device.
            if not loop.gate.stuck:
                # No alarm while there is no device: opening one may take long.
                _rearm_alarm(
                    ALARM_FACTOR * config.settings.safety.hang_timeout if loop.gate.backend else 0.0
                )
            loop.wait(loop.run_round())
        _rearm_alarm(MAX_EXIT_TIME)
    # If the parent has gone, it cannot remove the files itself.
    shared_memory.remove(config.path, LOCK_WAIT)


def _settle(loop: GuardLoop) -> None:
    """Turn off garbage collection and use the real-time class, because from here on the process mostly sleeps."""
    trim_memory()
    gc.disable()
    loop.processor = scheduling.use_realtime_class()


if __name__ == "__main__":
    main()
