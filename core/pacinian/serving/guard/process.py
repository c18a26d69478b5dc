"""The guard process: the only one that has the device, and the last that may fail.

It has no socket and solves nothing: it looks at the permit and the newest frame, again and again, and decides
(guarding.py). Whatever ends it, the last thing that the device is told is silence; what cannot be ended otherwise,
the system ends, which closes the device.
"""

from __future__ import annotations

import contextlib
import gc
import os
import signal
import sys
import threading
import time
from typing import TYPE_CHECKING

from msgspec.msgpack import Decoder

from pacinian.scene.file import Choice
from pacinian.serving.guard.device_switcher import DeviceSwitcher, import_backend
from pacinian.serving.guard.spare import stand_by
from pacinian.serving.guard.watchdog import OutputGate
from pacinian.serving.ipc import child_process, scheduling, shared_memory
from pacinian.serving.ipc.messages import DeviceStatus, Permit, RequestedSettings, pack
from pacinian.serving.ipc.plugin_list import list_offers
from pacinian.serving.ipc.shared_memory import RegisterReader, SharedRegister

if TYPE_CHECKING:
    from pathlib import Path
    from types import FrameType

    from pacinian.serving.settings import Settings
    from pacinian.wire.replies import Plugin

ROUND, IDLE = 0.25e-3, 1e-3  # [s] between two looks, while there may be sound and otherwise
TELL = 0.01  # [s] between two reports
SWITCH = 1e-4  # [s] in which a thread that opens a device lets the one that sounds go on
LAST = 1.0  # [s] in which it ends once its parent has gone
LEFT = 0.1  # [s] that it then waits for the parent's lock on their shared memory
ALONE = 2.0  # times `hung`: control, which can tell slow from hung, kills it before it does itself


class GuardLoop:
    """Joins a guard to the shared memory in `folder`. A context manager: at its end there is silence.

    What takes long is done before it is entered; then the device is opened. backends: that can be selected, None before
    they are known: as a guard before this one told. Nothing is told before that, and before there is a device or a
    fault, unless this guard takes the place of another. Raises ServerError if the folder lacks something.
    """

    def __init__(self, folder: Path, settings: Settings) -> None:
        with contextlib.ExitStack() as stack:
            permit, frame, orders, device = (
                stack.enter_context(SharedRegister.attach(folder / name))
                for name in ("permit", "frame", "orders", "device")
            )
            self._stack = stack.pop_all()
        self._permit = RegisterReader(permit, Permit.unpack, Permit())
        self._frame = RegisterReader(frame, bytes, b"")
        self._orders = RegisterReader(
            orders, Decoder(RequestedSettings).decode, RequestedSettings()
        )
        self._last: RegisterReader[DeviceStatus | None] = RegisterReader(
            device, Decoder(DeviceStatus).decode, None
        )
        self._device = device
        self.backends: tuple[Plugin, ...] | None = None
        self._replaces = False
        array = settings.array.make()
        self.guard = OutputGate(len(array), gain=settings.gain, stale=settings.safety.stale)
        chosen = settings.backend
        configured = chosen if isinstance(chosen, Choice) else Choice(chosen)
        self.devices = DeviceSwitcher(self.guard, array, configured, settings.rate)
        self.processor = scheduling.ANY
        self._told = -TELL  # [s]
        self._orders.look()
        with contextlib.suppress(Exception):  # it is told when it is to be opened
            import_backend(self._orders.value.backend[1] or configured)

    def watch(self) -> tuple[float, bool]:
        """Of the guard that goes round now: its last sign of life [s], and whether there may be sound."""
        self._last.look()
        self._permit.look()
        last = self._last.value
        if last is None or not last.generation:
            return 0.0, False
        return last.beat, last.sounding or self._permit.value.armed > 0

    def __enter__(self) -> GuardLoop:
        """Begin, in place of the guard that was there before, if there was one."""
        self._orders.look()
        self._last.look()
        last = self._last.value
        if last is not None:
            self._replaces, self.backends = True, last.backends
            self.guard.replace(last)
        self.devices.begin(self._orders.value, last.choice if last else None)
        return self

    def turn(self) -> float:
        """One round; how long to wait until the next [s]."""
        guard = self.guard
        if self._orders.look():
            self.devices.follow(self._orders.value)
        self.devices.poll()
        frame = self._frame.value if self._frame.look() else None
        self._permit.look()  # after the frame: so it is never older than what the frame was made for
        switched = guard.step(self._permit.value, frame)
        now = time.perf_counter()
        known = self.backends is not None and (self._replaces or guard.backend or guard.fault)
        if known and (guard.changed or now - self._told >= TELL):
            self.tell()
            self._told = now
        if switched:
            return 0.0
        return ROUND if self._permit.value.armed or guard.loud else IDLE

    def tell(self) -> None:
        """Publish how it is."""
        self.guard.changed = False
        self._device.write(
            pack(
                self.guard.device(
                    self.devices.results, self.backends or (), self.processor, self.devices.choice
                )
            )
        )

    def __exit__(self, *_: object) -> None:
        """Silence, tell, and close."""
        guard, due = self.guard, time.perf_counter() + 0.5 * LAST
        with self._stack:
            guard.silence("end")
            while guard.loud and time.perf_counter() < due:
                time.sleep(IDLE)
                guard.silence("end")
            with contextlib.suppress(Exception):
                self.tell()
            for backend in (guard.backend, guard.coming, *guard.leaving):
                if backend is not None:
                    with contextlib.suppress(Exception):
                        backend.close()


def _rearm_alarm(seconds: float) -> None:
    """Have the system end this process, and so close the device, unless asked again so soon; 0: not at all."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, seconds)  # SIGALRM, which nobody handles


def main() -> None:
    """Run until the parent goes, or tells it to; a spare first waits until it is called."""
    ended = threading.Event()

    def orphaned() -> None:
        ended.set()
        time.sleep(LAST)
        os._exit(1)  # a backend holds it up: the system closes the device

    def asked(number: int, frame: FrameType | None) -> None:
        ended.set()

    starter = child_process.Parent()
    told = starter.told
    sys.setswitchinterval(SWITCH)
    rounds = GuardLoop(told.path, told.settings)
    if told.spare:
        _settle(rounds)
        stand_by(starter, told.settings.safety.hung, rounds.watch)
    for name in (signal.SIGTERM, signal.SIGINT):
        signal.signal(name, asked)
    starter.watch(orphaned, kill=False)
    with rounds:
        while not (ended.is_set() or rounds.guard.backend or rounds.guard.fault):
            rounds.turn()  # a device may take its time
            time.sleep(IDLE)
        if rounds.backends is None:
            rounds.backends = list_offers(
                "backend"
            )  # takes long, and a device that is open is silent
        _settle(rounds)
        while not ended.is_set():
            if not rounds.guard.stuck:  # else the system is to close what does not close
                # not while there is none: one may take its time to open
                _rearm_alarm(ALONE * told.settings.safety.hung if rounds.guard.backend else 0.0)
            time.sleep(rounds.turn())
        _rearm_alarm(LAST)
    shared_memory.remove(told.path, LEFT)  # where the parent has gone, which would have removed it


def _settle(rounds: GuardLoop) -> None:
    """Nothing that takes long follows: from here on it mostly sleeps."""
    gc.collect()
    gc.freeze()
    gc.disable()
    rounds.processor = scheduling.use_realtime_class()


if __name__ == "__main__":
    main()
