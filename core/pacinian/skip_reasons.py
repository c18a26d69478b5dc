"""What a loop leaves out: problems, and work that was not needed, each by its reason. docs/skipped.md explains all."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

# Problems
MISSED_TICKS = "missed ticks"
COARSENED_SAMPLES = "samples coarsened"
SAMPLES_OVER_BUDGET = "samples over budget"
OBJECTS_OUTSIDE = "objects outside the workspace"
SAMPLES_TOO_FAR = "samples too far from the array"
SAMPLES_HARDLY_REACHED = "samples hardly reached"
SAMPLES_ON_TRANSDUCER = "samples on a transducer"
FORCES_LIMITED = "forces above the pressure limit"
HANDS_LOST = "hands lost"
TICKS_HALTED = "halted"
MEASUREMENTS_FAILED = "measurements failed"
# Work that was not needed
NOTHING_MOVED = "solve, nothing moved"
UNDER_WAY = "solve, still under way"
NOT_DUE = "solve, not due"
STEP_KNOWN = "solve, step of a modulation known"
NOTHING_CHANGED = "drive, nothing changed"
AWAY_FROM_HANDS = "objects away from hands"
SAMPLES_MERGED = "samples merged"
SAMPLES_FAINT = "samples too faint to feel"

SAVED = frozenset(
    {
        NOTHING_MOVED,
        UNDER_WAY,
        NOT_DUE,
        STEP_KNOWN,
        NOTHING_CHANGED,
        AWAY_FROM_HANDS,
        SAMPLES_MERGED,
        SAMPLES_FAINT,
    }
)
"""Reasons that only save work. Every other reason is a problem."""


class Skips(NamedTuple):
    """Counts by reason, the most frequent first. saved: work that was not needed. problems: all others."""

    saved: dict[str, int]
    problems: dict[str, int]

    def __str__(self) -> str:
        parts = [_describe(reason, count) for reason, count in self.problems.items()]
        if self.saved:
            times = sum(self.saved.values())
            parts.append("work saved once" if times == 1 else f"work saved {times:,} times")
        return "; ".join(parts) or "nothing"


def _describe(reason: str, count: int) -> str:
    if reason == HANDS_LOST:  # one hand counts once in each tick
        return f"a hand lost in {count:,} tick{'s' * (count != 1)}"
    return f"{count:,} {reason}"


def split_skips(skipped: Mapping[str, int]) -> Skips:
    """Split the counts of `Report.skipped` or `State.skipped`; reasons without a count are left out."""
    counts = sorted(skipped.items(), key=lambda item: -item[1])
    return Skips(
        saved={reason: n for reason, n in counts if n and reason in SAVED},
        problems={reason: n for reason, n in counts if n and reason not in SAVED},
    )
