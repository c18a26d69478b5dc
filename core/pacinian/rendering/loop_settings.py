"""Settings of a render loop that do not change while it runs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from pacinian.argument_checks import check_integer, check_kind, check_number
from pacinian.rendering.smoothing import Smoothing

if TYPE_CHECKING:
    from typing import Self


class LoopSettings(NamedTuple):
    """The settings of one render loop. `Renderer` describes each of them.

    period: of a tick [s]. smoothing: slew-rate limit from row to row. adaptive: whether to solve in the background if
    ticks would be late, to end solves in time, and to reduce the number of samples, except those of regions. strict:
    never leave anything out, and do not adapt. max_cycle_frames: largest number of frames in a cycle. peak: highest
    radiation pressure on the skin of the hands [Pa]; infinite for no limit. It also limits the pressure of objects
    that have a `force`, and the target of each frame of a cycle, but the latter never to less than the target of the
    whole cycle.
    """

    period: float
    smoothing: Smoothing
    adaptive: bool
    strict: bool
    max_cycle_frames: int
    peak: float

    @classmethod
    def make_checked(
        cls, rate: float, smoothing: Smoothing | None, *, adaptive: bool, strict: bool, max_cycle_frames: int,
        peak: float,
    ) -> Self:  # fmt: skip
        """Make settings from a caller's arguments. rate: ticks per second [Hz]. Raises ArgumentError."""
        smoothing = Smoothing() if smoothing is None else smoothing
        check_kind("smoothing", smoothing, Smoothing)
        rate = check_number("rate", rate, low=1.0, high=100_000.0)
        most = check_integer("max_cycle_frames", max_cycle_frames, low=1)
        peak = math.inf if peak == math.inf else check_number("peak", peak, low=0.0)
        check_kind("strict", strict, bool)
        return cls(1.0 / rate, smoothing, bool(adaptive) and not strict, strict, most, peak)
