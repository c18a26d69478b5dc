"""What a tick read from the clock: all that is decided by time can so be decided again."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


class RecordingClock:
    """A clock that notes what it told, or tells what was noted.

    now: the clock that it listens to.
    """

    def __init__(self, now: Callable[[], float]) -> None:
        self._now = now
        self._noted: list[float] = []
        self._told: list[float] | None = None
        self._place = 0

    def now(self) -> float:
        """Seconds. Raises LookupError where a replay asks more often than was noted."""
        if self._told is None:
            time = self._now()
            self._noted.append(time)
            return time
        if self._place >= len(self._told):
            raise LookupError("the clock was not read so often when this was recorded")
        self._place += 1
        return self._told[self._place - 1]

    def take(self) -> list[float]:
        """What was told since this was last asked, and begin anew."""
        noted, self._noted = self._noted, []
        return noted

    def tell(self, noted: list[float]) -> None:
        """Tell these next, instead of the time."""
        self._told, self._place = noted, 0
