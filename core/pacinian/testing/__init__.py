"""For the tests of programs and plug-ins: a clock that is told, a server of one's own, conformance."""

from pacinian.testing.clock import ManualClock
from pacinian.testing.conformance import NotConforming
from pacinian.testing.conformance_backend import check_backend
from pacinian.testing.conformance_solver import check_solver
from pacinian.testing.server import Running, Usage, serving

__all__ = [
    "ManualClock",
    "NotConforming",
    "Running",
    "Usage",
    "check_backend",
    "check_solver",
    "serving",
]
