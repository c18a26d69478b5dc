"""The backend `usb-autd`: an array's frames, to the devices that it is made of."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

import pacinian as pc
from pacinian.checks import check_names, check_number
from pacinian_plugins.backends.usb_autd.board import Board
from pacinian_plugins.backends.usb_autd.link import DEVICES, Link
from pacinian_plugins.backends.usb_autd.protocol import (
    AMPLITUDES,
    FULL,
    MAX_TRANSDUCERS,
    PHASES,
    RATE,
    UNIT,
)
from pacinian_plugins.backends.usb_autd.simulated_link import SimulatedLink

if TYPE_CHECKING:
    from array import array
    from collections.abc import Iterable, Sequence

    from pacinian.types import Levels

CHECK = RATE // 10  # rows between two looks at a device
NAME = DEVICES.name
HOLD, FADE = 20, 10  # rows: the last goes on while the next frame is late, and then fades


@dataclass
class UsbAutd(pc.Backend):
    """Devices on USB that speak Pacinian's own format, docs/usb-autd.md: the paper's array.

    description: a file that says of which boards the array is made; without one they are AUTD units, in the order
    of `serials`, or else of all serial numbers that are found. watchdog: after which a device is silent when
    frames stop [s]. lead: for which frames wait in the device, so that the loop may be late by so much [s].
    timeout: how long a device may take for a frame, or an answer [s]; one that hangs holds `send` up for no
    longer. pretend: use models of devices. library: a backend of pyusb instead of libusb's, for tests.
    """

    name: ClassVar[str] = NAME
    usb = DEVICES.usb

    description: str = ""
    serials: str | Sequence[str] = ()
    watchdog: float = 0.02
    lead: float = 0.002
    timeout: float = 0.01
    pretend: bool = False
    library: Any = field(default=None, repr=False)

    def __post_init__(self) -> None:
        self.watchdog = check_number("watchdog", self.watchdog, low=0.001, high=1.0)
        self._lead = round(check_number("lead", self.lead, low=0.0, high=0.1) * RATE)
        self.timeout = check_number("timeout", self.timeout, low=0.001, high=1.0)
        self.serials = check_names("serials", self.serials)
        self._capability = pc.Capability(PHASES, AMPLITUDES, RATE, self.watchdog)
        self.boards: list[Board] = []
        """Those that are open, in the array's order."""
        self._envelopes: dict[tuple[int, bool], Levels] = {}
        self._unchecked = 0  # rows since the last look at a device
        self._next = 0  # whose turn it is

    @classmethod
    def found(cls) -> Iterable[pc.Found]:
        """The devices that are connected, by serial."""
        return [pc.Found(NAME, *one) for one in DEVICES.describe("AUTD units")]

    @property
    def capability(self) -> pc.Capability:
        """What all devices of this format can do."""
        return self._capability

    def open(self, array: pc.Array) -> None:
        """Claim the devices, and arm them: silent until the first frame. Raises BackendError, SceneFileError."""
        self.close()
        try:
            if self.description:
                self._described(pc.DeviceDescription.load(self.description).wiring)
            else:
                self._in_order(len(array))
            driven = sum(len(board.wiring.indices) for board in self.boards)
            if driven != len(array):
                boards = ", ".join(f"{b.name} ({b.size})" for b in self.boards)
                raise pc.BackendError(
                    f"{NAME}: the array has {len(array)} transducers, and its devices {driven}: {boards}"
                )
            for board in self.boards:
                board.arm(self.watchdog)
        except BaseException:
            self.close()
            raise

    def send(self, frame: pc.Frame) -> None:
        """Send a frame to each device. Raises BackendError at the first that does not take it; nothing is repeated.

        Then some devices may have it, and others not: `silence` comes next.
        """
        for board, message in zip(self.boards, self.packed(frame), strict=True):
            board.send(message)
        self._unchecked += len(frame.phase)
        if self._unchecked >= CHECK:
            self._unchecked, self._next = 0, (self._next + 1) % len(self.boards)
            self.boards[self._next].check()

    def packed(self, frame: pc.Frame) -> list[array[int]]:
        """The messages of a frame, one for each device, in buffers that are reused. Raises BackendError."""
        if not self.boards:
            raise pc.BackendError(f"{NAME} is not open")
        phase, amplitude, steps = frame.phase, frame.amplitude, len(frame.phase)
        room = min(board.can.queue for board in self.boards) - self._lead
        if steps > room:
            raise pc.BackendError(
                f"{NAME}: a tick has {steps} rows, and the device room for {room}: "
                f"run the loop at {RATE / max(room, 1):.0f} Hz or more, or with a shorter `lead`"
            )
        if phase.max() >= PHASES or amplitude.max() >= AMPLITUDES:
            raise pc.BackendError(f"{NAME}: a frame has levels that the device does not have")
        same = bool((phase[1:] == phase[0]).all() and (amplitude[1:] == amplitude[0]).all())
        if same:
            phase, amplitude = phase[:1], amplitude[:1]
        envelope = self._envelope(steps, same)
        return [b.pack(phase, amplitude, envelope, self._lead, steps) for b in self.boards]

    def silence(self) -> None:
        """Silence every device at once. Raises BackendError if one does not answer: its watchdog silences it."""
        problems: list[pc.BackendError] = []
        for board in self.boards:
            try:
                board.silence()
            except pc.BackendError as error:
                problems.append(error)
        if problems:
            raise problems[0]

    def close(self) -> None:
        """Silence, disarm, and give the devices back."""
        for board in self.boards:
            board.close()
        self.boards = []

    def _described(self, wirings: Sequence[pc.Wiring]) -> None:
        """Open the boards of a description."""
        listed = [] if self.pretend else DEVICES.list_devices(self.library)
        for wiring in wirings:
            self._open(
                SimulatedLink(1, wiring.size, wiring.serial)
                if self.pretend
                else Link(DEVICES.select(listed, wiring.serial), self.timeout)
            ).wire(wiring)

    def _in_order(self, N: int) -> None:
        """Open boards of AUTD units, one after the other."""
        if N % UNIT:
            raise pc.BackendError(
                f"{NAME}: {N} transducers are no whole AUTD units of {UNIT}: give a `description`"
            )
        links: Iterable[Link | SimulatedLink]
        if self.pretend:
            left = range(N // UNIT, 0, -MAX_TRANSDUCERS)
            links = [SimulatedLink(min(units, MAX_TRANSDUCERS), UNIT) for units in left]
        else:
            listed = DEVICES.list_devices(self.library)
            serials = self.serials or [one.serial for one in listed if not one.problem] or [""]
            links = (Link(DEVICES.select(listed, serial), self.timeout) for serial in serials)
        start = 0
        for link in links:
            board = self._open(link)
            board.wire(keep_order(link.serial, start, board.size))
            start += board.size

    def _open(self, link: Link | SimulatedLink) -> Board:
        board = Board(link)
        self.boards.append(board)
        board.open()
        return board

    def _envelope(self, steps: int, same: bool) -> Levels:
        """Full for a frame's own rows; then what is to be heard if the next one is late: it holds, and fades."""
        key = steps, same
        if key not in self._envelopes:
            fade = np.cos(0.5 * np.pi * np.arange(1, FADE + 1) / FADE) ** 2
            full = np.ones(steps + (HOLD if same else 0))
            made = np.rint(FULL * np.append(full, fade)).astype("<u2")
            self._envelopes[key] = made[: min(board.can.samples for board in self.boards)]
        return self._envelopes[key]


def keep_order(serial: str, start: int, size: int) -> pc.Wiring:
    """A board that drives the array's transducers from `start` on, in their order."""
    channels = np.arange(size)
    return pc.Wiring(serial, size, channels, start + channels)
