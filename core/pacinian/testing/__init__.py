"""Tools for testing programs and plug-ins: a manual clock, a private server, simulated USB, conformance checks."""

from pacinian.testing.clock import ManualClock
from pacinian.testing.conformance import NotConforming
from pacinian.testing.conformance_backend import check_backend
from pacinian.testing.conformance_solver import check_solver
from pacinian.testing.server import Running, Usage, run_server
from pacinian.testing.usb_bus import UsbBus
from pacinian.testing.usb_device import UsbDevice

__all__ = [
    "ManualClock",
    "NotConforming",
    "Running",
    "Usage",
    "UsbBus",
    "UsbDevice",
    "check_backend",
    "check_solver",
    "run_server",
]
