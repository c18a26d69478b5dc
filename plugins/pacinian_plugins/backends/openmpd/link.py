"""The FT232H of one board, claimed: its 8-bit FIFO, from USB to the FPGA.

What is to be told to the chip is pyftdi's; its driver is not: that writes the rest of a short write by itself, loses
the number of an error, and resets the chip both before it claims it and behind the last frame.
"""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import pacinian as pc
from pacinian_plugins.backends.openmpd.discovery import configured
from pacinian_plugins.backends.openmpd.troubles import NAME, explained

if TYPE_CHECKING:
    from array import array

    from pacinian_plugins.backends.openmpd.discovery import Seen

PORT = 1  # the chip's only one
PINS = 0xFF
LATENCY = 2  # [ms], of what it says to the host: nothing
SETUP = 1.0  # [s] that it may take to be set up


class Ft232h:
    """A board's chip, claimed and set up.

    one: as `seen` found it. Raises BackendError, MissingExtra.
    """

    def __init__(self, one: Seen) -> None:
        import usb.core
        import usb.util

        self.serial, self.name, self._device = one.serial, f"{NAME} {one.serial}", one.device
        self._detached = False
        try:
            if configured(self._device) is None:  # to set it again is a reset
                self._device.set_configuration()
            interface = self._device.get_active_configuration()[(0, 0)]
            self._interface = int(interface.bInterfaceNumber)
            self._endpoint = next(e for e in interface if not e.bEndpointAddress & 0x80)
            self._detach()
            usb.util.claim_interface(self._device, self._interface)
            self._setup()
        except (usb.core.USBError, NotImplementedError, StopIteration) as error:
            self.close()
            raise self._explained(error, "opening it") from error
        except BaseException:
            self.close()
            raise

    def write(self, data: array[int], timeout: float) -> None:
        """All of it, within `timeout` [s]. Raises BackendError; what of it has arrived is not known then."""
        import usb.core

        milliseconds = max(1, round(1e3 * timeout))
        try:
            taken = self._endpoint.write(data, milliseconds)
        except usb.core.USBError as error:
            raise self._explained(error, "sending") from error
        if taken != len(data):
            raise pc.BackendError(
                f"{self.name}: sending: it took {taken} of {len(data)} bytes in {milliseconds} ms: the board "
                "hangs, has no power, or the bus is overloaded"
            )

    def mend(self) -> None:
        """After a failed write: let the next be taken. Raises BackendError."""
        import usb.core

        try:
            self._endpoint.clear_halt()
        except usb.core.USBError as error:
            raise self._explained(error, "ending a stall") from error

    def close(self) -> None:
        """Give the chip back, and the driver that it had. Never raises."""
        import usb.util

        device = self._device
        with suppress(Exception):
            usb.util.release_interface(device, self._interface)
        if self._detached:
            self._detached = False
            with suppress(Exception):
                device.attach_kernel_driver(self._interface)
        with suppress(Exception):
            usb.util.dispose_resources(device)

    def _setup(self) -> None:
        """As after power-up: the FIFO mode that its EEPROM says, nothing in its buffers."""
        try:
            from pyftdi.ftdi import Ftdi
        except ImportError as error:
            raise pc.MissingExtra("pyftdi", "devices") from error
        for request, value in (
            (Ftdi.SIO_REQ_RESET, Ftdi.SIO_RESET_SIO),
            (Ftdi.SIO_REQ_SET_BITMODE, Ftdi.BitMode.RESET << 8 | PINS),
            (Ftdi.SIO_REQ_SET_LATENCY_TIMER, LATENCY),
            (Ftdi.SIO_REQ_RESET, Ftdi.SIO_RESET_PURGE_RX),
            (Ftdi.SIO_REQ_RESET, Ftdi.SIO_RESET_PURGE_TX),
        ):
            milliseconds = round(1e3 * SETUP)
            self._device.ctrl_transfer(Ftdi.REQ_OUT, request, value, PORT, None, milliseconds)

    def _detach(self) -> None:
        """Take the interface from a driver that has it; not all systems know of such."""
        with suppress(NotImplementedError):
            if self._device.is_kernel_driver_active(self._interface):
                self._device.detach_kernel_driver(self._interface)
                self._detached = True

    def _explained(self, error: Exception, doing: str) -> pc.BackendError:
        place = self._device.bus or 0, self._device.address or 0
        return explained(error, self.name, doing, place)
