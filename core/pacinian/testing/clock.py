"""Time that stands still until it is told to go on."""

from __future__ import annotations


class ManualClock:
    """A clock for `pacinian.Renderer`: waiting takes no time, `advance` does.

    time: now [s].
    """

    def __init__(self, time: float = 0.0) -> None:
        self.time = time
        self.waits: list[float] = []
        """Every moment that was waited for [s]."""

    def now(self) -> float:
        """Seconds."""
        return self.time

    def wait_until(self, due: float) -> None:
        """Be at `due` [s], unless it is past."""
        self.waits.append(due)
        self.time = max(self.time, due)

    def advance(self, seconds: float) -> None:
        """Let `seconds` [s] pass: as a slow solver or device would."""
        self.time += seconds
