"""Deviations: where and when the output was not what the scene asked for."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from pacinian.scene.sampling.sample_counts import (
    FACES_AWAY,
    HAND_FADING,
    HAND_LOST,
    LEFT_OUT,
    NO_SURFACE,
    TOO_FAST,
    TOO_FINE,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    Reasons = Mapping[str, Mapping[str, int]]  # counts by label of the object and reason

LATE = "late"
MISSED = "missed"
HALTED = "silent after a fault"
INTERPOLATED = "interpolated"
OUT_OF_TIME = "solved in part"
AVERAGED = "envelope averaged"
WEAKENED = "weakened"
MISSED_TARGET = "weaker than asked"
SLEW_LIMITED = "slew limited"
SKIN_LIMITED = "limited on skin"
ZONE_LIMITED = "limited in quiet zones"
FEWER_FRAMES = "in fewer frames"
UNEVEN = "measured uneven"
PRESSED_BESIDE = "pressed beside"
BY_TICK = frozenset(
    {
        LATE, MISSED, HALTED, INTERPOLATED, OUT_OF_TIME, AVERAGED, SKIN_LIMITED, ZONE_LIMITED, SLEW_LIMITED,
        FEWER_FRAMES, UNEVEN, PRESSED_BESIDE, TOO_FINE, TOO_FAST, FACES_AWAY, NO_SURFACE, HAND_LOST, HAND_FADING,
    }
)  # fmt: skip
"""Reasons that count ticks, not samples."""
MAX_SPANS = 10_000  # largest number of spans that are kept
# Largest number of objects in all kept spans together, so that a scene of many objects keeps fewer spans.
MAX_NAMED = 50_000
MAX_LABELS = 1000  # largest number of objects with totals of their own
OTHERS = "other objects"
NOTHING: Reasons = {}


@dataclass
class Deviation:
    """Successive ticks that deviated in the same way.

    tick: number of the first. ticks: their number. time, until: scene time of the first and the last [s]. objects: for
    each object, by label, the reasons and their counts in each of these ticks: samples, or ticks. A label is the
    object's name, or its type and index in the scene, or "hand" and the hand's name.
    """

    tick: int
    ticks: int
    time: float
    until: float
    objects: Reasons


class Total(NamedTuple):
    """All deviations of one object for one reason.

    ticks: number of ticks. total: sum over these ticks of samples, or of missed ticks. first, last: scene time of the
    first and the last of these ticks [s].
    """

    ticks: int
    total: int
    first: float
    last: float


class Deviations:
    """The deviations of a run, by time and by object.

    spans: the most recent ones, oldest first; the totals count all. ticks: number of ticks in which anything deviated.
    """

    def __init__(self) -> None:
        self.spans: deque[Deviation] = deque()
        self.ticks = 0
        self._totals: dict[str, dict[str, Total]] = {}  # without the last span
        self._named = 0  # number of objects in the spans

    def add(self, tick: int, time: float, objects: Reasons) -> None:
        """Add a tick at scene time `time` [s]."""
        if not objects:
            return
        self.ticks += 1
        last = self.spans[-1] if self.spans else None
        if last is not None:
            same = last.objects is objects or last.objects == objects
            if same and last.tick + last.ticks == tick:
                last.ticks, last.until = last.ticks + 1, time
                return
            _add_span(self._totals, last)
        self.spans.append(Deviation(tick, 1, time, time, objects))
        self._named += len(objects)
        while len(self.spans) > MAX_SPANS or (self._named > MAX_NAMED and len(self.spans) > 1):
            self._named -= len(self.spans.popleft().objects)

    @property
    def totals(self) -> dict[str, dict[str, Total]]:
        """The totals of each object, by label and reason."""
        totals = {label: dict(reasons) for label, reasons in self._totals.items()}
        if self.spans:
            _add_span(totals, self.spans[-1])
        return totals


def _add_span(totals: dict[str, dict[str, Total]], span: Deviation) -> None:
    for label, reasons in span.objects.items():
        full = label not in totals and len(totals) >= MAX_LABELS
        own = totals.setdefault(OTHERS if full else label, {})
        for reason, count in reasons.items():
            ticks, summed, first, last = own.get(reason, Total(0, 0, span.time, span.until))
            own[reason] = Total(
                ticks + span.ticks,
                summed + span.ticks * count,
                min(first, span.time),
                max(last, span.until),
            )


def mark(objects: Reasons, labels: Iterable[str], reason: str, count: int = 1) -> Reasons:
    """Return the deviations of a tick with a further reason for the objects of these labels."""
    made = dict(objects)
    for label in labels:
        made[label] = {**made.get(label, {}), reason: count}
    return made


def mark_lateness(objects: Reasons, labels: Iterable[str], *, late: bool, missed: int) -> Reasons:
    """Return the deviations of a tick, marked as late if it is, and with the number of ticks skipped before it."""
    objects = mark(objects, labels, LATE) if late else objects
    return mark(objects, labels, MISSED, missed) if missed else objects


def describe_totals(reasons: Mapping[str, Total]) -> str:
    """Describe the deviations of one object in words."""
    parts: list[str] = []
    for reason, (ticks, count, first, last) in reasons.items():
        if reason in BY_TICK:
            text = f"{reason} in {_count_ticks(max(ticks, count))}"
        else:
            kind = "samples " if reason in LEFT_OUT or reason in (WEAKENED, MISSED_TARGET) else ""
            text = f"{kind}{reason} in {_count_ticks(ticks)}"
            text += f" ({count / ticks:.3g} in each)" if kind else ""
        begin, end = (f"{round(time, 3) + 0.0:.3f}" for time in (first, last))
        parts.append(f"{text}, " + (f"at {begin} s" if begin == end else f"{begin} to {end} s"))
    return "; ".join(parts)


def _count_ticks(count: int) -> str:
    return f"{count:,} tick{'s' * (count != 1)}"
