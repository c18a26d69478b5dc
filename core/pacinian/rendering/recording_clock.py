"""Record the clock readings of a tick, so that a replay repeats all decisions that depend on time."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable


class RecordingClock:
    """A clock that records its readings, or replays recorded ones.

    now: the underlying clock [s]. stops: whether a replay that reads the clock more often than was recorded gets the
    last reading again, otherwise an error. A solver for another array may read it more often.
    """

    def __init__(self, now: Callable[[], float], *, stops: bool = False) -> None:
        self._now, self._stops = now, stops
        self._recorded: list[float] = []
        self._replayed: list[float] | None = None
        self._place = 0
        self._last: float | None = None  # reading that was replayed last [s]

    @property
    def replays(self) -> bool:
        """Whether recorded readings are replayed."""
        return self._replayed is not None

    def now(self) -> float:
        """Return the time [s]. Raises LookupError if a replay reads the clock more often than was recorded."""
        return self.record_decision(self._now)

    def record_decision(self, read: Callable[[], float]) -> float:
        """Return `read()`, or in a replay what it returned when it was recorded. Raises LookupError as `now` does."""
        if self._replayed is None:
            value = read()
            self._recorded.append(value)
            return value
        if self._place >= len(self._replayed):
            if self._stops and self._last is not None:
                return self._last
            raise LookupError("the clock is read more often than in the recording")
        self._last = self._replayed[self._place]
        self._place += 1
        return self._last

    def take(self) -> list[float]:
        """Return the readings since the last call, and clear them."""
        recorded, self._recorded = self._recorded, []
        return recorded

    def tell(self, recorded: list[float]) -> None:
        """Replay these readings from now on, instead of the time."""
        self._replayed, self._place = recorded, 0


class RecordingClocks(NamedTuple):
    """The clocks of a render loop. tick: of the ticks. job: of sampling and solving, which may run beside the ticks."""

    tick: RecordingClock
    job: RecordingClock

    @classmethod
    def make(cls, now: Callable[[], float]) -> RecordingClocks:
        """Make clocks that read the same underlying clock, `now` [s]."""
        return cls(RecordingClock(now), RecordingClock(now, stops=True))
