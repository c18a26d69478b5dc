"""The claimed FT232H of one board: its 8-bit FIFO from USB to the FPGA.

The request codes are pyftdi's, but its driver is not used. That driver silently completes short writes, loses error
numbers, and resets the chip both before it claims the chip and after the last frame.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pacinian as pc
from pacinian.devices.usb import UsbKind
from pacinian.devices.usb_errors import RESET_ADVICE
from pacinian.devices.usb_link import UsbLink

if TYPE_CHECKING:
    from pacinian.devices.usb import ListedDevice

PORT = 1  # the only port of the chip
PINS = 0xFF
LATENCY = 2  # latency timer of data to the host [ms], of which there is none
SETUP = 1.0  # timeout of each set-up request [s]
CHIPS = UsbKind(
    name="openmpd",
    usb=((0x0403, 0x6014),),  # FTDI's FT232H, whatever it is built into
    gone=(
        "it is gone: unplugged or reset. While it has power it PLAYS ITS LAST FRAME: switch it off, or plug it in "
        f"and {RESET_ADVICE}"
    ),
    hangs="the board hangs, has no power, or the bus is overloaded",
    anonymous=(
        "it has no serial number: write one to its EEPROM, with FTDI's FT_PROG or pyftdi's ftconf.py"
    ),
)


def open_port(one: ListedDevice) -> UsbLink:
    """Claim a chip, and reset it to its state after power-up: the FIFO mode of its EEPROM, and empty buffers.

    one: from `CHIPS.list_devices`. Raises BackendError, MissingExtra.
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
