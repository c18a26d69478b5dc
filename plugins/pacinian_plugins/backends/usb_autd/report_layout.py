"""The layout of a device's reports about itself, 64 bytes each."""

from __future__ import annotations

import struct
from dataclasses import astuple, dataclass
from typing import Any

from pacinian_plugins.backends.usb_autd.protocol import (
    AMPLITUDES,
    MAJOR,
    MAX_TRANSDUCERS,
    MINOR,
    PHASES,
    RATE,
    UNIT,
    State,
    Verdict,
)

CAPABILITY_LAYOUT = struct.Struct("<4B10H2I16s16s")
STATUS_LAYOUT = struct.Struct("<3Bx11I2Hh10x")


@dataclass(frozen=True)
class CapabilityReport:
    """The report of what a device can do.

    units: number of units, with `transducers` each. queue: largest number of waiting rows. samples: largest number of
    samples of an envelope. watchdog: shortest, longest and default time [ms]. longest: largest length of a message
    [bytes]. frequency: of the ultrasound [mHz].
    """

    units: int = 9
    transducers: int = UNIT
    phases: int = PHASES
    amplitudes: int = AMPLITUDES
    rate: int = RATE
    queue: int = 16
    samples: int = 64
    watchdog: tuple[int, int, int] = (5, 100, 20)
    longest: int = 1 << 17
    frequency: int = 40_000_000
    serial: str = ""
    firmware: str = ""
    version: tuple[int, int] = (MAJOR, MINOR)

    def pack(self) -> bytes:
        """Return the report, 64 bytes."""
        names = (text.encode("ascii") for text in (self.serial, self.firmware))
        return CAPABILITY_LAYOUT.pack(
            64,
            *self.version,
            self.units,
            self.transducers,
            self.phases,
            self.amplitudes,
            self.rate,
            self.queue,
            self.samples,
            *self.watchdog,
            0,
            self.longest,
            self.frequency,
            *names,
        )

    @classmethod
    def unpack(cls, report: bytes) -> CapabilityReport:
        """Decode a report; fields that a newer version has added are ignored. Raises ValueError."""
        v = _fields(CAPABILITY_LAYOUT, report)
        if not (1 <= v[3] <= MAX_TRANSDUCERS and v[4]):
            raise ValueError(f"{v[3]} units of {v[4]} transducers")
        serial, firmware = (_text(v[i]) for i in (16, 17))
        given: list[Any] = [*v[3:10], v[10:13], *v[14:16], serial, firmware, v[1:3]]
        return cls(*given)


@dataclass
class StatusReport:
    """The report of a device's state. Counters count from power-up, modulo 2^32.

    refusal: last verdict other than OK. session: 0 while disarmed. sequence: of the last accepted frame. corrupt,
    skipped: messages with a wrong CRC, and bytes that belong to no message. lost: frames missing from the sequence.
    starved, overrun: frames that came too late, and too early. tripped: number of times the watchdog silenced it.
    uptime, watchdog: [ms]. waiting: number of waiting rows. temperature: [0.1 °C].
    """

    state: int = State.DISARMED
    refusal: int = Verdict.OK
    session: int = 0
    sequence: int = 0
    accepted: int = 0
    refused: int = 0
    corrupt: int = 0
    skipped: int = 0
    lost: int = 0
    starved: int = 0
    overrun: int = 0
    tripped: int = 0
    uptime: int = 0
    watchdog: int = 0
    waiting: int = 0
    temperature: int = -32768  # unknown

    def pack(self) -> bytes:
        """Return the report, 64 bytes."""
        state, refusal, *counters, watchdog, waiting, temperature = astuple(self)
        counters = [n & 0xFFFFFFFF for n in counters]
        return STATUS_LAYOUT.pack(64, state, refusal, *counters, watchdog, waiting, temperature)

    @classmethod
    def unpack(cls, report: bytes) -> StatusReport:
        """Decode a report; fields that a newer version has added are ignored. Raises ValueError."""
        return cls(*_fields(STATUS_LAYOUT, report)[1:])


def _fields(layout: struct.Struct, report: bytes) -> tuple[Any, ...]:
    if len(report) < layout.size or report[0] < layout.size:
        said = report[0] if report else 0
        raise ValueError(
            f"the report has {len(report)} bytes and states a length of {said}; at least {layout.size} are needed"
        )
    return layout.unpack(report[: layout.size])


def _text(name: bytes) -> str:
    return name.split(b"\0")[0].decode("ascii", errors="replace")
