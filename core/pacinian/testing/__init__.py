"""Tools for testing programs and plug-ins: a manual clock, a private server, simulated USB, conformance checks.

clock.py                `ManualClock`: time that a test advances
server.py               `run_server`: a real server for a test; its log, memory, processor time
conformance.py          what both kits share: rules, time limits, report (`NotConforming`)
conformance_backend.py  `check_backend`: does a backend keep the contract?
conformance_solver.py   `check_solver`: does a solver keep the contract?
problems.py             problems of `check_solver`
shapes.py               samples of squares, rings, fingers, for problems with regions
usb_bus.py              `UsbBus`: a simulated bus for pyusb, with failures of real ones, such as a stall or unplugging
usb_device.py           `UsbDevice` on that bus, and pyusb's errors
"""

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
