"""How smooth the dual is made: less so as it is climbed."""

from __future__ import annotations

from typing import NamedTuple

FIRST = 0.1  # share of D that smoothing may cost at first,
SHARE = 0.01  # later share of what the last step promised,
LAST = 0.1  # and at least share of the tolerance
PACE = 0.1  # that of gains is lowered to no less than this share at a time


class Smoothing(NamedTuple):
    """What smoothing may cost, as a share of D: of quiet rows, and of gains if strength is asked for."""

    rows: float = FIRST
    gains: float = FIRST

    def next(self, promised: float, tolerance: float) -> Smoothing:
        """For the next step; promised: by the last one, as a share of D."""
        least, share = LAST * tolerance, SHARE * promised
        return Smoothing(
            max(min(self.rows, share), least),
            max(min(self.gains, max(share, PACE * self.gains)), least),
        )
