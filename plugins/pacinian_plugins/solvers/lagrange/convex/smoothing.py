"""Smoothing of the dual, which decreases as the ascent proceeds."""

from __future__ import annotations

from typing import NamedTuple

FIRST_COST_SHARE = 0.1  # cost of the smoothing at first, as a share of D
COST_SHARE = 0.01  # its cost later, as a share of the ascent that the last step promised
LAST_COST_SHARE = 0.1  # its least cost, as a share of the tolerance
MIN_REMAINING_SHARE = 0.1  # least factor by which the smoothing of the gains decreases in one step


class Smoothing(NamedTuple):
    """Allowed cost of smoothing, as a share of D, for quiet rows, and for gains when the strength is maximised."""

    rows: float = FIRST_COST_SHARE
    gains: float = FIRST_COST_SHARE

    def next(self, promised: float, tolerance: float) -> Smoothing:
        """Return the smoothing of the next step. promised: ascent promised by the last step, as a share of D."""
        least, share = LAST_COST_SHARE * tolerance, COST_SHARE * promised
        return Smoothing(
            max(min(self.rows, share), least),
            max(min(self.gains, max(share, MIN_REMAINING_SHARE * self.gains)), least),
        )
