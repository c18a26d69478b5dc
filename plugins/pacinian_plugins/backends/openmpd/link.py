"""The FT232H of one board, claimed: its 8-bit FIFO, from USB to the FPGA.

What is to be told to the chip is pyftdi's; its driver is not: that writes the rest of a short write by itself, loses
the number of an error, and resets the chip both before it claims it and behind the last frame.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pacinian as pc
from pacinian.devices.usb import UsbKind
from pacinian.devices.usb_link import UsbLink

if TYPE_CHECKING:
    from pacinian.devices.usb import ListedDevice

PORT = 1  # the chip's only one
PINS = 0xFF
LATENCY = 2  # [ms], of what it says to the host: nothing
SETUP = 1.0  # [s] that it may take to be set up
CHIPS = UsbKind(
    name="openmpd",
    usb=((0x0403, 0x6014),),  # FTDI's FT232H, whatever it is built into
    gone=(
        "it is gone: unplugged or reset. While it has power it PLAYS ITS LAST FRAME: switch it off, or plug it in "
        "and reset the server, or open the backend again"
    ),
    hangs="the board hangs, has no power, or the bus is overloaded",
    anonymous=(
        "it has no serial number: write one to its EEPROM, with FTDI's FT_PROG or pyftdi's ftconf.py"
    ),
)


def open_port(one: ListedDevice) -> UsbLink:
    """A chip, claimed, and set up as after power-up: the FIFO mode that its EEPROM says, nothing in its buffers.

    one: as `CHIPS.seen` found it. Raises BackendError, MissingExtra.
    """
    try:
        from pyftdi.ftdi import Ftdi
    except ImportError as error:
        raise pc.MissingExtra("pyftdi", "devices") from error
    link = UsbLink(CHIPS, one)
    try:
        for request, value in (
            (Ftdi.SIO_REQ_RESET, Ftdi.SIO_RESET_SIO),
            (Ftdi.SIO_REQ_SET_BITMODE, Ftdi.BitMode.RESET << 8 | PINS),
            (Ftdi.SIO_REQ_SET_LATENCY_TIMER, LATENCY),
            (Ftdi.SIO_REQ_RESET, Ftdi.SIO_RESET_PURGE_RX),
            (Ftdi.SIO_REQ_RESET, Ftdi.SIO_RESET_PURGE_TX),
        ):
            link.control((Ftdi.REQ_OUT, request, value, PORT), b"", SETUP, "opening it")
    except BaseException:
        link.close()
        raise
    return link
