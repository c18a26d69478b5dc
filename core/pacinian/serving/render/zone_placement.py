"""Quiet zones in the render process.

They are prepared outside the loop, with a margin for movement, which takes 0.5 to 1 s for one unit, 4 to 15 s for nine.
Until then, there is silence.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from pacinian.errors import ArgumentError, describe_error
from pacinian.solving.budget import Budget
from pacinian.solving.quiet_subspace import Preparation

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.solving.limits import Limits
    from pacinian.solving.quiet_zone import Zone

AT_ONCE = Budget.until(0.0)
MOVEMENT_MARGIN = (
    0.02  # distance by which the prepared ball is larger than a zone that may move [m]
)


class ZonePlacement:
    """Prepares quiet zones for an array in a medium. limits: of gain and power. fixed: number of zones that never move.

    note: the status to show while there is silence.
    """

    def __init__(self, array: Array, medium: Air, limits: Limits, fixed: int = 0) -> None:
        self.note = ""
        self.limits = limits
        """Limits that include the prepared zones."""
        self._array, self._medium, self._fixed = array, medium, fixed
        self._preparation = Preparation()
        self._next: tuple[Zone, ...] | None = None
        self._seen: tuple[Zone, ...] | None = None

    @property
    def preparing(self) -> bool:
        """Whether zones are being prepared, so that `keeps` must be called again."""
        return self._next is not None

    def prepare(self, zones: tuple[Zone, ...]) -> None:
        """Prepare zones that never move, and wait for that: 0.5 to 1 s for one unit, 4 to 15 s for nine.

        Raises ArgumentError.
        """
        rms = self.limits.compute_max_rms(len(self._array))
        self._preparation.get(self._array, self._medium, zones, rms, Budget())
        self.limits = replace(self.limits, zones=zones)

    def keeps(self, zones: tuple[Zone, ...] | None) -> bool:
        """Whether `limits` keeps all these zones quiet. May replace `limits`. Does not wait for a preparation.

        Never if `zones` is None, because the zones are not known.
        """
        self.note = ""
        if zones is None:
            self.note = "silent: the quiet zones are not valid: set them again"
            return False
        if not zones:
            self._next = None
            if self.limits.zones:
                self.limits = replace(self.limits, zones=())
            return True
        moved, self._seen = zones is not self._seen, zones
        if moved and self._next is None and not self._suits(zones):
            self._next = self._widen(zones)
        if self._next is not None:
            self._look(zones)
        return _compute_room(self.limits.zones, zones) >= 0.0

    def _look(self, zones: tuple[Zone, ...]) -> None:
        """Take the result of a preparation, if there is one."""
        assert self._next is not None
        rms = self.limits.compute_max_rms(len(self._array))
        self.note = "silent: the quiet zones are being prepared"
        try:
            made = self._preparation.get(self._array, self._medium, self._next, rms, AT_ONCE)
        except ArgumentError as error:
            self.note = f"silent: {describe_error(error)}"
            self._next = zones  # without a margin, or at the current places
            return
        if made is not None:
            self.limits, self._next, self._seen = replace(self.limits, zones=self._next), None, None

    def _widen(self, zones: tuple[Zone, ...]) -> tuple[Zone, ...]:
        """Return the zones with a margin for those that may move."""
        n = self._fixed
        return (
            *zones[:n],
            *(replace(one, radius=one.radius + MOVEMENT_MARGIN) for one in zones[n:]),
        )

    def _suits(self, zones: tuple[Zone, ...]) -> bool:
        """Whether the prepared zones are made for these: no stricter or larger, and half of the margin is left."""
        kept, n = self.limits.zones, self._fixed
        return (
            len(kept) == len(zones)
            and all(
                big.pressure == wide.pressure and big.radius <= wide.radius
                for big, wide in zip(kept, self._widen(zones), strict=True)
            )
            and _compute_room(kept[:n], zones[:n]) >= 0.0
            and _compute_room(kept[n:], zones[n:]) >= 0.5 * MOVEMENT_MARGIN
        )


def _compute_room(kept: tuple[Zone, ...], zones: tuple[Zone, ...]) -> float:
    """Return how far each of `zones` may still move within the ball prepared for it [m]; negative if any is outside."""
    if len(kept) != len(zones):
        return -math.inf
    rooms = [
        big.radius - small.radius - math.dist(big.position, small.position)
        if big.pressure <= small.pressure
        else -math.inf
        for big, small in zip(kept, zones, strict=True)
    ]
    return min(rooms, default=math.inf)
