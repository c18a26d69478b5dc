"""Noise as an envelope."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.checks import check_integer
from pacinian.errors import ArgumentError
from pacinian.scene.modulation.waves import between, bounds, frequency

if TYPE_CHECKING:
    from pacinian.types import Floats

LENGTH = 1 << 16  # of the table
FINE = 16  # values for each period of the highest frequency
CREST = 2.5  # standard deviations from the middle to low and high
NARROWEST = 0.01  # band, as a share of its high end


class Noise(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="noise"):
    """Random about the middle of low and high, with an even spectrum from low_frequency to high_frequency [Hz].

    2.5 standard deviations reach low and high. What goes beyond, 1.2 % of the time, is clipped, and
    leaves 0.1 to 0.3 % of the power outside of the band. The same seed is the same noise, whatever is
    asked first; it repeats after 4096 periods of high_frequency. Raises ArgumentError.
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
        least = (1.0 - NARROWEST) * self.high_frequency
        if not self.low_frequency <= least:
            raise ArgumentError(
                "low_frequency", f"must be at most {least:g} Hz, 1 % below the high"
            )

    def at(self, t: Floats) -> Floats:
        """The factor at times t [s], same shape."""
        table = _table(self.low_frequency / self.high_frequency, self.seed)
        place = (FINE * self.high_frequency * t) % LENGTH
        return self.low + (self.high - self.low) * between(table, place)


@functools.lru_cache(maxsize=64)
def _table(lowest: float, seed: int) -> Floats:
    """One repeat of noise in 0..1 from `lowest` of its highest frequency on, and two values more."""
    lines = np.arange(LENGTH // 2 + 1) * FINE / LENGTH  # share of the highest frequency
    band = (lines >= lowest) & (lines > 0.0) & (lines <= 1.0)
    turns = np.random.default_rng(seed).random(len(lines))
    x = np.fft.irfft(band * np.exp(2j * np.pi * turns), LENGTH)
    table = 0.5 + 0.5 * np.clip(x / (CREST * x.std()), -1.0, 1.0)
    return np.concatenate([table, table[:2]])
