"""Constants of the wire protocol usb-autd 1.0: identity, sizes, requests, states and verdicts; see docs/usb-autd.md."""

from __future__ import annotations

from enum import IntEnum

MAJOR, MINOR = 1, 0
# class (vendor-specific), subclass and protocol, which identify the format
INTERFACE = 0xFF, 0x41, MAJOR
# of the reference: test IDs of pid.codes; manufacturers use their own
VENDOR, PRODUCT = 0x1209, 0x0001
ENDPOINT = 0x01  # bulk OUT, where it is free to choose

UNIT, MAX_TRANSDUCERS = 249, 16  # transducers per unit; units per device
PHASES, AMPLITUDES = 640, 320  # levels: ticks of 25.6 MHz in a period of 40 kHz, and in half of one
RATE = 2000  # [Hz] rows
FULL = 1 << 15  # of an envelope


class Request(IntEnum):
    """Vendor requests to the interface, on the control endpoint."""

    CAPABILITY = 1
    STATUS = 2
    ARM = 3
    SILENCE = 4
    DISARM = 5


class State(IntEnum):
    """State of a device."""

    DISARMED = 0
    SILENT = 1
    SOUNDING = 2


class Verdict(IntEnum):
    """Outcome of a message, checked in this order."""

    OK = 0
    VERSION = 1
    LENGTH = 2
    CORRUPT = 3
    KIND = 4
    UNITS = 5
    ROWS = 6
    ENVELOPE = 7
    LEVEL = 8
    DISARMED = 9
    SESSION = 10
    SEQUENCE = 11
