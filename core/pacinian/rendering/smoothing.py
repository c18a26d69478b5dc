"""Interpolate the gains from one solution to the next, and limit their slew rate, because jumps are audible."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.argument_checks import check_integer, check_kind, check_number
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.types import Gains


@dataclass(frozen=True, kw_only=True)
class Smoothing:
    """How far the output may move from row to row of a frame.

    rate: largest change of any gain per second, relative to the largest present or target gain [1/s]; None for no
        limit. The loudest transducer can then turn its phase by `rate` radians per second. A focus that moves at speed
        v needs at most k v. With 750, a focus at 1 m/s is followed without lag, and any sound, strong or weak, starts
        or stops within 1.3 ms. The limit is relative to the full pressure of the objects: a lightly pressed contact may
        change faster, by the square root of the ratio. A focus that must jump (spatio-temporal modulation) needs None.
    align: turn the global phase of each solution, which is free, to that of the row before.
    Raises ArgumentError.
    """

    rate: float | None = 750.0
    align: bool = True

    def __post_init__(self) -> None:
        if self.rate is not None:
            rate = check_number("rate", self.rate, low=0.0, high=1e9, above=True)
            object.__setattr__(self, "rate", rate)
        check_kind("align", self.align, bool)


class GainSmoother:
    """Follows target gains at a limited slew rate, starting from silence.

    If the limit binds, or a change is spread over several rows, the output moves from the previous row towards the
    target gains, by the same fraction for all transducers. Intermediate rows therefore keep every convex limit that
    both ends keep (gain, power, quiet zones), and they keep a focus that both ends have in phase.

    settings: may be replaced at any time. columns: number of transducers N. Raises ArgumentError.
    """

    def __init__(self, settings: Smoothing, columns: int) -> None:
        from pacinian.native import rendering as kernels

        check_kind("settings", settings, Smoothing)
        self.settings = settings
        self.gains: Gains = np.zeros(check_integer("columns", columns, low=1), dtype=np.complex64)
        """The last row of output, (N,)."""
        self.settled = False
        """Whether that row has reached the target gains, so that the same gains need no more work."""
        self._loudest = np.zeros(1, dtype=np.float32)
        self._follow = kernels.follow

    def follow(
        self, gains: Gains, seconds: float, out: Gains, span: int = 1, growth: float = 1.0, phases: int = 0
    ) -> None:  # fmt: skip
        """Write the next rows of output to `out`, (K, N), for target `gains`, (K, N), or (1, N) for all rows.

        gains: complex64, contiguous, without envelopes, because intended vibration must not be smoothed.
        seconds: from row to row [s]. span: rows over which to spread a change evenly; more if the limit binds.
        growth: factor by which the gains will still grow while they fade in; the limit is relative to the final gains.
        phases: number of the device's phase levels, if gains are to be turned by whole levels, so that they are rounded
        as before they were turned; 0 for any angle.
        No |out_n| exceeds the larger of |gains_n| and that of the previous row.
        Raises ArgumentError.
        """
        K, N = out.shape
        if gains.shape not in ((K, N), (1, N)) or len(self.gains) != N or not K:
            raise ArgumentError("gains", f"must have shape {out.shape}, not {gains.shape}")
        rate = self.settings.rate
        step = math.inf if rate is None else rate * seconds
        align, settled = self.settings.align, self.settled
        self.settled = self._follow(
            gains, step, span, growth, align, phases, settled, self._loudest, self.gains, out
        )

    def rest(self) -> None:
        """Note that the output is constant, so that louder gains of the past no longer count."""
        self._loudest[:] = 0.0

    def reset(self) -> None:
        """Start the next rows from silence."""
        self.gains[:] = self._loudest[:] = 0.0
        self.settled = False
