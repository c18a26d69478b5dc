"""The backend `sonicsurface`: sends frames as fast as the serial line accepts them."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

import pacinian as pc
from pacinian.argument_checks import check_integer, check_number
from pacinian.errors import ArgumentError
from pacinian_plugins.backends.sonicsurface import ports
from pacinian_plugins.backends.sonicsurface.protocol import BOARD, CLOCKS, PHASES, SELECT, Packer
from pacinian_plugins.backends.sonicsurface.serial_writer import SerialWriter
from pacinian_plugins.backends.sonicsurface.write_scheduler import WriteScheduler

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence


@dataclass
class SonicSurface(pc.Backend):
    """SonicSurface: 256 transducers, on or off, on a serial port: docs/sonicsurface.md.

    port: name of the port, or serial number of its adapter; no other port is touched. description: file that
    describes the wiring of the board, or of two boards on one port; without it, the array's transducers are in the
    order of the channels. The serial of its first board selects the port unless `port` is given. rate: of the loop
    [Hz]; whenever the line is free, 89 times a second, the newest frame is sent. select: commands that select the
    first and the second of two boards. timeout: time that the system may hold bytes back [s]. clock: for tests.
    """

    name: ClassVar[str] = ports.NAME

    description: str = ""
    port: str = ""
    rate: float = 1000.0
    select: Sequence[int] = SELECT
    timeout: float = 0.1
    clock: Callable[[], float] = field(default=time.perf_counter, repr=False)

    def __post_init__(self) -> None:
        self.rate = check_number("rate", self.rate, low=1.0, high=10_000.0)
        self.timeout = check_number("timeout", self.timeout, low=0.01, high=1.0)
        self.select = [check_integer("select", byte, low=0) for byte in self.select]
        if len(self.select) != 2 or max(self.select) > 255:
            raise ArgumentError("select", f"must be two bytes, not {self.select}")
        self._capability = pc.Capability(PHASES, 2, self.rate)
        self._columns = 0
        self._packer: Packer | None = None
        self._line: SerialWriter | None = None

    @classmethod
    def find_devices(cls) -> Iterable[pc.FoundDevice]:
        """Return the connected serial adapters, whatever they are attached to."""
        try:
            return ports.find_boards()
        except pc.MissingExtra as error:
            return [pc.FoundDevice(ports.NAME, "", "", str(error))]

    @property
    def capability(self) -> pc.Capability:
        """The capability; there is no watchdog."""
        return self._capability

    def open(self, array: pc.Array) -> None:
        """Open the port and silence the array. Raises BackendError, SceneFileError, MissingExtra."""
        self.close()
        name, wirings = self._find_wirings(len(array))
        feed = WriteScheduler(len(wirings), self.select)
        port = ports.open_port(name, self.timeout)
        self._line = SerialWriter(port, feed, self.timeout, self.clock)
        try:
            port.write(bytes([CLOCKS]))
            self._line.silence()
        except BaseException as error:
            self.close()
            if isinstance(error, OSError):
                raise pc.BackendError(ports.explain(error, port.port)) from error
            raise
        self._packer, self._columns = Packer(wirings), len(array)

    def send(self, frame: pc.Frame) -> None:
        """Queue the last row of a frame until the line is free; a newer frame replaces it. Raises BackendError."""
        if self._line is None or self._packer is None:
            raise pc.BackendError(f"{self.name} is not open")
        phase, amplitude = frame.phase[-1], frame.amplitude[-1]
        if len(phase) != self._columns or phase.max() >= PHASES or amplitude.max() > 1:
            raise pc.BackendError(
                f"{self.name}: a frame contains levels that the array cannot emit"
            )
        self._line.show(self._packer.pack(phase, amplitude))

    def silence(self) -> None:
        """Silence the array after the frame on the line. Raises BackendError if the sound continues."""
        if self._line is not None:
            self._line.silence()

    def close(self) -> None:
        """Silence the array and release the port."""
        line, self._line = self._line, None
        if line is not None:
            line.close()

    def _find_wirings(self, N: int) -> tuple[str, Sequence[pc.Wiring]]:
        """Return the port and the wirings of its boards. Raises BackendError, SceneFileError."""
        wirings: Sequence[pc.Wiring]
        if self.description:
            wirings = pc.DeviceDescription.load(self.description).wiring
        else:
            channels = np.arange(BOARD)
            wirings = tuple(
                pc.Wiring("", BOARD, channels, BOARD * b + channels)
                for b in range(max(1, -(-N // BOARD)))
            )
        if not self.description and N > 2 * BOARD:
            raise pc.BackendError(
                f"{self.name}: the array has {N} transducers, a port drives {BOARD} or {2 * BOARD}: set `array` in the "
                "server's settings (docs/sonicsurface.md)"
            )
        if len(wirings) not in (1, 2) or any(wiring.size != BOARD for wiring in wirings):
            raise pc.BackendError(
                f"{self.name}: a port has one or two boards of {BOARD} transducers, not "
                f"{', '.join(str(wiring.size) for wiring in wirings)}"
            )
        driven = sum(len(wiring.indices) for wiring in wirings)
        if driven != N:
            raise pc.BackendError(
                f"{self.name}: the array has {N} transducers, and its boards drive {driven}: set `array` "
                "in the server's settings (docs/sonicsurface.md)"
            )
        return self.port or wirings[0].serial, wirings
