"""For the tests of programs and plug-ins: time that stands still until it is told to go on, a server of one's own."""

from pacinian.testing.clock import ManualClock
from pacinian.testing.server import Running, Usage, serving

__all__ = ["ManualClock", "Running", "Usage", "serving"]
