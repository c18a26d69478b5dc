"""What a loop leaves out: work that was not needed, and problems, each by its reason."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

SAVED = frozenset(
    {
        "solve, nothing moved",
        "solve, still under way",
        "solve, not due",
        "solve, step of a modulation known",
        "drive, nothing changed",
        "objects away from hands",
        "samples merged",
        "samples too faint to feel",
    }
)
"""Reasons that only save work. Every other reason is a problem."""


class Skips(NamedTuple):
    """Counts by reason, the most frequent first. saved: work that was not needed. problems: all others."""

    saved: dict[str, int]
    problems: dict[str, int]

    def __str__(self) -> str:
        parts = [f"{count:,} {reason}" for reason, count in self.problems.items()]
        if self.saved:
            times = sum(self.saved.values())
            parts.append("work saved once" if times == 1 else f"work saved {times:,} times")
        return "; ".join(parts) or "nothing"


def split_skips(skipped: Mapping[str, int]) -> Skips:
    """Split the counts of `Report.skipped` or `State.skipped`; reasons without a count are left out."""
    counts = sorted(skipped.items(), key=lambda item: -item[1])
    return Skips(
        saved={reason: n for reason, n in counts if n and reason in SAVED},
        problems={reason: n for reason, n in counts if n and reason not in SAVED},
    )
