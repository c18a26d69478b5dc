"""The backend `usb-autd`: sends frames to the devices of an array."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

import pacinian as pc
from pacinian.argument_checks import check_names, check_number
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

CHECK = RATE // 10  # rows between two status checks of a device
NAME = DEVICES.name
HOLD, FADE = 20, 10  # rows for which the last one holds, then fades, if the next frame is late


@dataclass
class UsbAutd(pc.Backend):
    """USB devices that use Pacinian's own format, docs/usb-autd.md, such as the paper's array.

    description: file that describes the boards of the array; without it, they are AUTD units in the order of
    `serials`, or of all serial numbers found. watchdog: time after the last frame at which a device falls silent [s].
    lead: time that frames wait in the device, which is how late the loop may be [s]. timeout: time that a device may
    take for a frame or an answer [s]; a hanging device blocks `send` for no longer. pretend: use models of devices.
    library: backend of pyusb instead of libusb's, for tests.
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
        """Open devices, in the array's order."""
        self._envelopes: dict[tuple[int, bool], Levels] = {}
        self._unchecked = 0  # rows since the last status check
        self._next = 0  # index of the device to check next

    @classmethod
    def find_devices(cls) -> Iterable[pc.FoundDevice]:
        """Return the connected devices by serial."""
        return [pc.FoundDevice(NAME, *one) for one in DEVICES.describe("AUTD units")]

    @property
    def capability(self) -> pc.Capability:
        """The capability of all devices of this format."""
        return self._capability

    def open(self, array: pc.Array) -> None:
        """Claim and arm the devices; they are silent until the first frame. Raises BackendError, SceneFileError."""
        self.close()
        try:
            if self.description:
                self._open_described(pc.DeviceDescription.load(self.description).wiring)
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
        """Send a frame to each device. Raises BackendError at the first that does not accept it; never retries.

        After an error, only some of the devices may have the frame; call `silence` next.
        """
        for board, message in zip(self.boards, self.pack_frame(frame), strict=True):
            board.send(message)
        self._unchecked += len(frame.phase)
        if self._unchecked >= CHECK:
            self._unchecked, self._next = 0, (self._next + 1) % len(self.boards)
            self.boards[self._next].check()

    def pack_frame(self, frame: pc.Frame) -> list[array[int]]:
        """Return the messages of a frame, one for each device, in reused buffers. Raises BackendError."""
        if not self.boards:
            raise pc.BackendError(f"{NAME} is not open")
        phase, amplitude, steps = frame.phase, frame.amplitude, len(frame.phase)
        room = min(board.can.queue for board in self.boards) - self._lead
        if steps > room:
            raise pc.BackendError(
                f"{NAME}: a tick has {steps} rows, but the device can hold only {room}: "
                f"run the loop at {RATE / max(room, 1):.0f} Hz or more, or with a shorter `lead`"
            )
        if phase.max() >= PHASES or amplitude.max() >= AMPLITUDES:
            raise pc.BackendError(f"{NAME}: a frame contains levels that the device cannot emit")
        same = bool((phase[1:] == phase[0]).all() and (amplitude[1:] == amplitude[0]).all())
        if same:
            phase, amplitude = phase[:1], amplitude[:1]
        envelope = self._envelope(steps, same)
        return [b.pack(phase, amplitude, envelope, self._lead, steps) for b in self.boards]

    def silence(self) -> None:
        """Silence every device at once. Raises BackendError if one does not answer; its watchdog silences it then."""
        problems: list[pc.BackendError] = []
        for board in self.boards:
            try:
                board.silence()
            except pc.BackendError as error:
                problems.append(error)
        if problems:
            raise problems[0]

    def close(self) -> None:
        """Silence, disarm and release the devices."""
        for board in self.boards:
            board.close()
        self.boards = []

    def _open_described(self, wirings: Sequence[pc.Wiring]) -> None:
        """Open the boards of a description."""
        listed = [] if self.pretend else DEVICES.list_devices(self.library)
        for wiring in wirings:
            self._open(
                SimulatedLink(1, wiring.size, wiring.serial)
                if self.pretend
                else Link(DEVICES.select(listed, wiring.serial), self.timeout)
            ).wire(wiring)

    def _in_order(self, N: int) -> None:
        """Open boards that consist of AUTD units, in order."""
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
        """Return the envelope: full for a frame's own rows, then the hold and fade in case the next one is late."""
        key = steps, same
        if key not in self._envelopes:
            fade = np.cos(0.5 * np.pi * np.arange(1, FADE + 1) / FADE) ** 2
            full = np.ones(steps + (HOLD if same else 0))
            made = np.rint(FULL * np.append(full, fade)).astype("<u2")
            self._envelopes[key] = made[: min(board.can.samples for board in self.boards)]
        return self._envelopes[key]


def keep_order(serial: str, start: int, size: int) -> pc.Wiring:
    """Return the wiring of a board that drives the array's transducers from `start` on, in order."""
    channels = np.arange(size)
    return pc.Wiring(serial, size, channels, start + channels)
