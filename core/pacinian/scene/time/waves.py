"""Envelopes by formula: constant, sine, square, pulse, and any function of time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.checks import number
from pacinian.types import Floats

FASTEST = 100_000.0  # [Hz], more than any device can follow
SLIP = 1e-9  # [s]; an edge due on a frame must not come one frame late by rounding


class Constant(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="constant"):
    """The same at all times. level: 0..1. Raises ArgumentError."""

    level: float = 1.0

    def __post_init__(self) -> None:
        force_setattr(self, "level", number("level", self.level, low=0.0, high=1.0))

    def at(self, t: Floats) -> Floats:
        """The factor at times t [s], same shape."""
        return np.full(np.shape(t), self.level)


class Sine(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="sine"):
    """Between low and high, frequency times a second [Hz]; starts at low. Raises ArgumentError."""

    frequency: float
    low: float = 0.0
    high: float = 1.0

    def __post_init__(self) -> None:
        frequency(self, "frequency")
        bounds(self)

    def at(self, t: Floats) -> Floats:
        """The factor at times t [s], same shape."""
        half = (self.high - self.low) / 2.0
        return self.low + half * (1.0 - np.cos(2.0 * np.pi * self.frequency * t))


class Square(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="square"):
    """High for `duty` of each period, then low; frequency [Hz]. Raises ArgumentError."""

    frequency: float
    low: float = 0.0
    high: float = 1.0
    duty: float = 0.5

    def __post_init__(self) -> None:
        frequency(self, "frequency")
        bounds(self)
        force_setattr(self, "duty", number("duty", self.duty, low=0.0, high=1.0))

    def at(self, t: Floats) -> Floats:
        """The factor at times t [s], same shape."""
        return np.where((self.frequency * (t + SLIP)) % 1.0 < self.duty, self.high, self.low)


class Pulse(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="pulse"):
    """High for `width` [s] from `start` [s] on, and again every `period` [s], or only once; else low.

    rise: how long it takes up, and again down, within the width [s]: half a cosine. Raises ArgumentError.
    """

    width: float
    period: float | None = None
    start: float = 0.0
    rise: float = 0.0
    low: float = 0.0
    high: float = 1.0

    def __post_init__(self) -> None:
        bounds(self)
        force_setattr(self, "width", number("width", self.width, low=0.0, above=True))
        force_setattr(self, "start", number("start", self.start))
        half = self.width / 2.0
        force_setattr(self, "rise", number("rise", self.rise, low=0.0, high=half))
        if self.period is not None:
            force_setattr(self, "period", number("period", self.period, low=self.width))

    def at(self, t: Floats) -> Floats:
        """The factor at times t [s], same shape."""
        s = t - self.start + SLIP
        if self.period is not None:
            s = s % self.period
        if not self.rise:
            return np.where((s >= 0.0) & (s < self.width), self.high, self.low)
        up = np.clip(np.minimum(s, self.width - s), 0.0, self.rise) / self.rise
        half = (self.high - self.low) / 2.0
        return np.asarray(self.low + half * (1.0 - np.cos(np.pi * up)))


class Function(Struct, frozen=True):
    """Any function of times [s], (K,) -> (K,); what leaves 0..1 is clipped, NaN is 0."""

    function: Callable[[Floats], Floats]

    def at(self, t: Floats) -> Floats:
        """The factor at times t [s], same shape."""
        value = np.broadcast_to(np.asarray(self.function(t), dtype=np.float64), t.shape)
        return np.clip(np.nan_to_num(value, nan=0.0), 0.0, 1.0)


def frequency(wave: Any, name: str, *, above: bool = False) -> None:
    """Check a frequency [Hz] of a wave; `above` excludes 0."""
    value = number(name, getattr(wave, name), low=0.0, high=FASTEST, above=above)
    force_setattr(wave, name, value)


def bounds(wave: Any) -> None:
    """Check the low and the high of a wave."""
    force_setattr(wave, "low", number("low", wave.low, low=0.0, high=1.0))
    force_setattr(wave, "high", number("high", wave.high, low=wave.low, high=1.0))


def between(table: Any, place: Floats) -> Floats:
    """The values of a table, (L,), at places in 0..L-2, any fraction: straight from one to the next."""
    i = place.astype(np.intp)
    a = table[i]
    return np.asarray(a + (place - i) * (table[i + 1] - a))
