"""The backend `autd3`: sends frames to AUTD3 units."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import pacinian as pc
from pacinian.argument_checks import check_integer, check_number
from pacinian.errors import ArgumentError
from pacinian_plugins.backends.autd3 import levels, open_transport, units
from pacinian_plugins.backends.autd3.packages import NAME
from pacinian_plugins.backends.autd3.row_commands import CARRIER, RowCommands

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian_plugins.backends.autd3.transport_interface import Transport

MAX_ROWS = 6  # maximum number of rows in a tick; the units buffer 7 messages


@dataclass
class Autd3(pc.Backend):
    """AUTD3 units, through the AUTD3 project's packages: docs/autd3.md.

    link: how to reach them: "udp", "simulator", "server", "loopback" or "emulator". interface: network interface,
    detected unless given. port: of the simulator or server, default unless given. description: file with the poses and
    the dead transducers of the units; without it, the array consists of whole units in the order of their cables.
    rate: rows per second [Hz], a divisor of 40 kHz. watchdog: time after the last frame at which units fall silent [s].
    lead: time by which rows are sent before they are due, to avoid jitter [s]. timeout: time for which units may not
    answer [s]. clock: [s], for tests.
    """

    name: ClassVar[str] = NAME

    link: str = "udp"
    interface: str = ""
    port: int = 0
    description: str = ""
    rate: int = 1000
    watchdog: float = 0.05
    lead: float = 0.0
    timeout: float = 0.1
    clock: Callable[[], float] = field(default=time.perf_counter, repr=False)
    line: Transport | None = field(default=None, init=False, repr=False)
    """Transport to the units, set by the last `open`."""

    def __post_init__(self) -> None:
        if self.link in open_transport.ETHERCAT:
            raise ArgumentError("link", f"{self.link!r} {open_transport.GONE}")
        if self.link not in open_transport.LINKS:
            there = ", ".join(map(repr, open_transport.LINKS))
            raise ArgumentError("link", f"must be one of {there}, not {self.link!r}")
        self.port = check_integer("port", self.port, low=0)
        self.rate = check_integer("rate", self.rate, low=100)
        if CARRIER % self.rate:
            raise ArgumentError("rate", f"must divide {CARRIER} Hz, not {self.rate}")
        self.watchdog = check_number("watchdog", self.watchdog, low=0.005, high=60.0)
        self.lead = check_number("lead", self.lead, low=0.0, high=0.02)
        self.timeout = check_number("timeout", self.timeout, low=0.02, high=10.0)
        watchdog = self.watchdog if self.link in open_transport.FAILSAFE else None
        self._capability = pc.Capability(levels.PHASES, levels.SIZES, self.rate, watchdog)
        self._open, self._failures = False, 0
        self._first: float | None = None  # [s] when the first row was due

    @property
    def capability(self) -> pc.Capability:
        """The capability: 256 phases, and all distinct amplitudes of the units' pulses."""
        return self._capability

    def open(self, array: pc.Array) -> None:
        """Connect to the units; they stay silent. Raises BackendError, SceneFileError, MissingExtra."""
        self.close()
        if self.description:
            described = pc.DeviceDescription.load(self.description)
            layout = units.layout_of_description(described, array)
        else:
            layout = units.layout_of_array(array)
        geometry = layout.geometry()
        self._row_commands, self._packer = RowCommands(geometry, self.rate), levels.Packer(layout)
        self._failures, self._first = 0, None
        self.line = open_transport.make_transport(
            self.link, geometry, self.interface, self.port, self.watchdog, self.timeout, self.clock
        )
        self._open = True

    def send(self, frame: pc.Frame) -> None:
        """Send the changes of a frame. Raises BackendError if the units are lost or refuse them."""
        line, rows = self._line(), frame.phase.shape
        if rows[0] > MAX_ROWS:
            raise pc.BackendError(
                f"{NAME}: a tick has {rows[0]} rows, but the units can hold only {MAX_ROWS}: "
                f"run the loop at {self.rate / MAX_ROWS:.0f} Hz or more, or lower `rate`"
            )
        line.check()
        if line.waits or line.failures != self._failures:
            self._failures = line.failures
            self._row_commands.forget()
        try:
            phase, intensity = self._packer.pack(frame.phase, frame.amplitude)
        except ValueError as error:
            raise pc.BackendError(
                f"{NAME}: a frame contains levels that the units cannot emit"
            ) from error
        self._first = frame.time if self._first is None else self._first
        first, now = round((frame.time - self._first) * self.rate), line.time + self.lead
        timed = self._row_commands.tell(first, phase, intensity, now)
        line.post(
            [(frames, now + row / self.rate if row or self.lead else None) for frames, row in timed]
        )

    def silence(self) -> None:
        """Stop all sound. Raises BackendError if the units do not answer; then their failsafe silences them."""
        if self._open:
            self._row_commands.forget()
            self._line().silence()

    def close(self) -> None:
        """Silence the units and disconnect."""
        if self._open:
            line, self._open = self._line(), False
            line.close()

    def _line(self) -> Transport:
        if not self._open or self.line is None:
            raise pc.BackendError(f"{NAME} is not open")
        return self.line
