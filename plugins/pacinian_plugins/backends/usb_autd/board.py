"""One device of an array: packs and sends its part of each frame, and checks its status."""

from __future__ import annotations

import os
import struct
from array import array
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

import pacinian as pc
from pacinian.devices.usb_errors import RESET_ADVICE
from pacinian_plugins.backends.usb_autd import frames, protocol
from pacinian_plugins.backends.usb_autd.link import DEVICES
from pacinian_plugins.backends.usb_autd.protocol import Request, Verdict
from pacinian_plugins.backends.usb_autd.report_layout import CapabilityReport, StatusReport

if TYPE_CHECKING:
    from pacinian.types import Levels
    from pacinian_plugins.backends.usb_autd.link import Link
    from pacinian_plugins.backends.usb_autd.simulated_link import SimulatedLink


class Board:
    """A device behind a link. Closing the board closes the link. can: its capability, known after `open`."""

    def __init__(self, link: Link | SimulatedLink) -> None:
        self.link, self.name = link, f"{DEVICES.name} {link.serial}"
        self.can = CapabilityReport()
        self._session = self._sequence = 0
        self._accepted = self._checked = 0  # accepted frames, and sequence, at the last check
        self._failed = False
        self._buffers: dict[tuple[int, int], tuple[array[int], memoryview]] = {}
        self._part: slice | None = None  # its transducers, if contiguous in the array
        self._levels = np.zeros((2, 0, 0), np.uint16)
        self.wiring: pc.Wiring

    @property
    def size(self) -> int:
        """Number of its transducers."""
        return self.can.units * self.can.transducers

    def open(self) -> None:
        """Query its capability. Raises BackendError if it does not use this format."""
        try:
            can = self.can = CapabilityReport.unpack(self.link.ask(Request.CAPABILITY))
        except ValueError as error:
            raise pc.BackendError(f"{self.name}: is no device of this format: {error}") from error
        reported = can.version[0], can.phases, can.amplitudes, can.rate
        known = protocol.MAJOR, protocol.PHASES, protocol.AMPLITUDES, protocol.RATE
        if reported != known:
            raise pc.BackendError(
                f"{self.name}: has version, phases, amplitudes and rate {reported}, not {known}: "
                "update Pacinian, or the device's firmware"
            )

    def wire(self, wiring: pc.Wiring) -> None:
        """Set which of the array's transducers it drives. Raises BackendError."""
        if wiring.size != self.size:
            raise pc.BackendError(
                f"{self.name}: has {self.size} transducers, and should have {wiring.size}"
            )
        self.wiring = wiring
        if len(wiring.indices) == self.size and (np.diff(wiring.indices) == 1).all():
            first = int(wiring.indices[0])
            self._part = slice(first, first + self.size)

    def arm(self, watchdog: float) -> None:
        """Arm the device; it is silent until the first frame. watchdog: [s]. Raises BackendError."""
        least, most, _ = self.can.watchdog
        wanted = round(1e3 * watchdog)
        if not least <= wanted <= most:
            raise pc.BackendError(
                f"{self.name}: its watchdog can be {least} to {most} ms, not {wanted} ms"
            )
        self.link.clear_halt()
        self._session, self._sequence = int.from_bytes(os.urandom(4), "little") or 1, 0
        self.link.tell(Request.ARM, struct.pack("<IHH", self._session, wanted, 0))
        self._checked, self._accepted = 0, self.status().accepted

    def pack(
        self, phase: Levels, amplitude: Levels, envelope: Levels, lead: int, steps: int
    ) -> array[int]:
        """Pack the next message into a reused buffer. phase, amplitude: levels of the whole array, (rows, N)."""
        phase, amplitude = self._own(phase, amplitude)
        key = len(phase), len(envelope)
        if key not in self._buffers:
            made = array("B", bytes(frames.size(len(phase), self.size, len(envelope))))
            self._buffers[key] = made, memoryview(made)
        message, view = self._buffers[key]
        self._sequence = self._sequence + 1 & 0xFFFFFFFF
        head = self._session, self._sequence, (1 << self.can.units) - 1, lead, steps
        frames.pack(head, envelope, phase, amplitude, view)
        return message

    def send(self, message: array[int]) -> None:
        """Write a message of `pack`. Raises BackendError at once; never retries."""
        try:
            self.link.write(message)
        except pc.BackendError:
            self._failed = True
            raise

    def status(self) -> StatusReport:
        """Return the status of the device. Raises BackendError."""
        try:
            return StatusReport.unpack(self.link.ask(Request.STATUS))
        except ValueError as error:
            raise pc.BackendError(f"{self.name}: {error}") from error

    def check(self) -> None:
        """Raise BackendError if the device does not accept frames."""
        status = self.status()
        if status.session != self._session:
            raise pc.BackendError(
                f"{self.name}: is disarmed: it was reset, is too hot, or another program has it: "
                f"{RESET_ADVICE}"
            )
        if status.accepted == self._accepted and self._sequence != self._checked:
            known = status.refusal in Verdict.__members__.values()
            why = Verdict(status.refusal).name.lower() if known else str(status.refusal)
            raise pc.BackendError(f"{self.name}: accepts no frames: the last refusal was {why!r}")
        self._accepted, self._checked = status.accepted, self._sequence

    def silence(self) -> None:
        """Silence at once, and discard all frames under way. A device that was unplugged is silent by itself.

        Raises BackendError.
        """
        try:
            self.link.tell(Request.SILENCE, self._sequence.to_bytes(4, "little"))
            if self._failed:  # only if it answers: for others, the system would wait for seconds
                self.link.clear_halt()
                self._failed = False
        except pc.BackendError:
            if not self.link.gone:
                raise

    def close(self) -> None:
        """Silence, disarm and release the device. Never raises."""
        with suppress(pc.BackendError):
            self.silence()
        with suppress(pc.BackendError):
            self.link.tell(Request.DISARM)
        self.link.close()

    def _own(self, phase: Levels, amplitude: Levels) -> tuple[Levels, Levels]:
        """Return its levels in the order of its channels, (rows, size) each."""
        if self._part is not None:
            return phase[:, self._part], amplitude[:, self._part]
        shape = 2, len(phase), self.size
        if self._levels.shape != shape:
            self._levels = np.zeros(shape, np.uint16)  # dead transducers stay 0
        to, of = self.wiring.channels, self.wiring.indices
        self._levels[0][:, to], self._levels[1][:, to] = phase[:, of], amplitude[:, of]
        return self._levels[0], self._levels[1]
