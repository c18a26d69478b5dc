"""Band-limited noise as an envelope."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.argument_checks import check_integer
from pacinian.errors import ArgumentError
from pacinian.scene.modulation.waves import bounds, frequency, interpolate_table

if TYPE_CHECKING:
    from pacinian.types import Floats

LENGTH = 1 << 16  # number of values in the table
VALUES_PER_PERIOD = 16  # values per period of the highest frequency
CREST = 2.5  # standard deviations from the middle to low and high
MIN_BANDWIDTH = 0.01  # smallest bandwidth, as a fraction of the highest frequency


class Noise(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="noise"):
    """Noise around the middle of low and high, with a flat spectrum from low_frequency to high_frequency [Hz].

    low and high are 2.5 standard deviations from the middle. Values beyond them (1.2 % of the time) are clipped, which
    puts 0.1 to 0.3 % of the power outside the band. Equal seeds give equal noise, independent of the order of calls.
    The noise repeats after 4096 periods of high_frequency. Raises ArgumentError.
    """

    low_frequency: float
    high_frequency: float
    low: float = 0.0
    high: float = 1.0
    seed: int = 0

    def __post_init__(self) -> None:
        frequency(self, "low_frequency")
        frequency(self, "high_frequency", above=True)
        bounds(self)
        force_setattr(self, "seed", check_integer("seed", self.seed, low=0))
        least = (1.0 - MIN_BANDWIDTH) * self.high_frequency
        if not self.low_frequency <= least:
            raise ArgumentError(
                "low_frequency", f"must be at most {least:g} Hz, 1 % below the high"
            )

    def at(self, t: Floats) -> Floats:
        """Return the factor at times t [s], in the same shape."""
        table = _tabulate_noise(self.low_frequency / self.high_frequency, self.seed)
        place = (VALUES_PER_PERIOD * self.high_frequency * t) % LENGTH
        return self.low + (self.high - self.low) * interpolate_table(table, place)


@functools.lru_cache(maxsize=64)
def _tabulate_noise(lowest: float, seed: int) -> Floats:
    """Return one period of noise in 0..1, and its first two values again.

    lowest: the lowest frequency over the highest one.
    """
    # frequency over the highest one
    lines = np.arange(LENGTH // 2 + 1) * VALUES_PER_PERIOD / LENGTH
    band = (lines >= lowest) & (lines > 0.0) & (lines <= 1.0)
    turns = np.random.default_rng(seed).random(len(lines))
    x = np.fft.irfft(band * np.exp(2j * np.pi * turns), LENGTH)
    table = 0.5 + 0.5 * np.clip(x / (CREST * x.std()), -1.0, 1.0)
    return np.concatenate([table, table[:2]])
