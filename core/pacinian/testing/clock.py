"""A clock that tests advance by hand."""

from __future__ import annotations


class ManualClock:
    """A clock for `pacinian.Renderer`. Waiting returns at once; `advance` lets time pass.

    time: current time [s].
    """

    def __init__(self, time: float = 0.0) -> None:
        self.time = time
        self.waits: list[float] = []
        """Every time passed to `wait_until` [s]."""

    def now(self) -> float:
        """Return the current time [s]."""
        return self.time

    def wait_until(self, due: float) -> None:
        """Advance to `due` [s], unless it has passed."""
        self.waits.append(due)
        self.time = max(self.time, due)

    def advance(self, seconds: float) -> None:
        """Let `seconds` [s] pass, as a slow solver or device would."""
        self.time += seconds
