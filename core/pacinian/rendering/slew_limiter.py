"""Smooth output: gains that go from frame to frame without jumps, which would be heard."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.checks import check_integer, check_kind, check_number
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.types import Gains


@dataclass(frozen=True, kw_only=True)
class Smoothing:
    """How far the output may go from row to row of a frame.

    rate: the largest change of any gain per second, over the loudest gain that sounds or is asked [1/s]; None for no
        limit. The loudest transducer turns its phase by as many radians a second, so that a focus at speed v needs
        k v at most: 750 lets one at 1 m/s pass without lag, and any sound come or go in 1.3 ms, be it strong or weak.
        A focus that is meant to jump (spatio-temporal modulation) needs None.
    align: turn each solution's global phase, which is free, to that of the row before.
    Raises ArgumentError.
    """

    rate: float | None = 750.0
    align: bool = True

    def __post_init__(self) -> None:
        if self.rate is not None:
            rate = check_number("rate", self.rate, low=0.0, high=1e9, above=True)
            object.__setattr__(self, "rate", rate)
        check_kind("align", self.align, bool)


class SlewRateLimiter:
    """Follows solved gains smoothly, from silence on.

    Where the limit binds, or a change is spread over more rows, the output fades from the row before to the
    gains that are asked, all transducers by the same fraction. So what both keep is kept on the way: limits of
    gain and power and quiet zones are convex, and a focus that both have in phase stays.

    settings: may be replaced at any time. columns: N. Raises ArgumentError.
    """

    def __init__(self, settings: Smoothing, columns: int) -> None:
        from pacinian.native import rendering as kernels

        check_kind("settings", settings, Smoothing)
        self.settings = settings
        self.gains: Gains = np.zeros(check_integer("columns", columns, low=1), dtype=np.complex64)
        """The last row given out, (N,)."""
        self.settled = False
        """Whether that row is what was asked: with the same gains, nothing is left to do."""
        self._loudest = np.zeros(1, dtype=np.float32)
        self._follow = kernels.follow

    def follow(
        self, gains: Gains, seconds: float, out: Gains, span: int = 1, growth: float = 1.0
    ) -> None:
        """Write the next rows of output, (K, N), for the solved `gains`, (K, N), or (1, N) for all rows.

        gains: complex64, contiguous, before any envelope: what is meant to vibrate is not smoothed.
        seconds: from row to row [s]. span: rows from now on over which a change is spread evenly; more where the limit
        binds. growth: how many times louder the gains are going to be, if they come up: the limit is of that.
        No |out| is more than those of the gains and of the row before.
        Raises ArgumentError.
        """
        K, N = out.shape
        if gains.shape not in ((K, N), (1, N)) or len(self.gains) != N or not K:
            raise ArgumentError("gains", f"must have shape {out.shape}, not {gains.shape}")
        rate = self.settings.rate
        step = math.inf if rate is None else rate * seconds
        align, settled = self.settings.align, self.settled
        self.settled = self._follow(
            gains, step, span, growth, align, settled, self._loudest, self.gains, out
        )

    def rest(self) -> None:
        """All stays as it is: what was louder before does not count any more."""
        self._loudest[:] = 0.0

    def reset(self) -> None:
        """Silence: the next rows start from nothing."""
        self.gains[:] = self._loudest[:] = 0.0
        self.settled = False
