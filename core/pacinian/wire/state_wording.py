"""Words for the figures of a state."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping


def count(number: int, what: str) -> str:
    """Return a number and what it counts, in the plural if it is not 1."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"


def share(part: int, whole: int) -> str:
    """Return part / whole in percent; "0 %" only if there are none."""
    if not part:
        return "0 %"
    percent = 100.0 * part / max(1, whole)
    return f"{percent:.0f} %" if percent >= 1.0 else f"{max(percent, 0.01):.2f} %"


def list_counts(counts: Mapping[str, int]) -> str:
    """Return the counts that are not 0, each with its name."""
    return ", ".join(f"{n} {name}" for name, n in counts.items() if n)
