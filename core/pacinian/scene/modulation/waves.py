"""Envelopes by formula: constant, sine, square, pulse, and any function of time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.checks import check_number
from pacinian.types import Floats

MAX_FREQUENCY = 100_000.0  # [Hz], more than any device can follow
EDGE = 1.5e-3  # [s] from low to high or back, at least: less is louder, more is felt as weaker (decision 45)
SLIP = 1e-9  # [s]; an edge due on a frame must not come one frame late by rounding


class Constant(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="constant"):
    """The same at all times. level: 0..1. Raises ArgumentError."""

    level: float = 1.0

    def __post_init__(self) -> None:
        force_setattr(self, "level", check_number("level", self.level, low=0.0, high=1.0))

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
    """High for `duty` of each period, then low; frequency [Hz]; starts at low.

    Up and down it goes by half a cosine within 1.5 ms, or as long as high and low last, for steps are heard.
    Raises ArgumentError.
    """

    frequency: float
    low: float = 0.0
    high: float = 1.0
    duty: float = 0.5

    def __post_init__(self) -> None:
        frequency(self, "frequency")
        bounds(self)
        force_setattr(self, "duty", check_number("duty", self.duty, low=0.0, high=1.0))

    def at(self, t: Floats) -> Floats:
        """The factor at times t [s], same shape."""
        return self._at(t, min(EDGE * self.frequency, self.duty, 1.0 - self.duty))

    def switched(self, t: Floats) -> Floats:
        """The same with steps, for devices that are on or off."""
        return self._at(t, 0.0)

    def _at(self, t: Floats, edge: float) -> Floats:
        place = (self.frequency * (t + SLIP)) % 1.0  # in the period
        return self.low + (self.high - self.low) * between_edges(place, self.duty, edge)


class Pulse(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="pulse"):
    """High for `width` [s] from `start` [s] on, and again every `period` [s], or only once; else low.

    rise: how long it takes up, and again down, within the width [s], by half a cosine. Less than 1.5 ms is made up to
    that, as far as the width and the rest of the period allow, for steps are heard. Raises ArgumentError.
    """

    width: float
    period: float | None = None
    start: float = 0.0
    rise: float = 0.0
    low: float = 0.0
    high: float = 1.0

    def __post_init__(self) -> None:
        bounds(self)
        force_setattr(self, "width", check_number("width", self.width, low=0.0, above=True))
        force_setattr(self, "start", check_number("start", self.start))
        half = self.width / 2.0
        force_setattr(self, "rise", check_number("rise", self.rise, low=0.0, high=half))
        if self.period is not None:
            force_setattr(self, "period", check_number("period", self.period, low=self.width))

    def at(self, t: Floats) -> Floats:
        """The factor at times t [s], same shape."""
        s, falls, edge = t - self.start + SLIP, self.width - self.rise, EDGE
        if self.period is not None:
            s, edge = s % self.period, min(EDGE, self.period - falls)
        edge = max(self.rise, min(edge, falls))
        return self.low + (self.high - self.low) * between_edges(s, falls, edge)


class Function(Struct, frozen=True):
    """Any function of times [s], (K,) -> (K,); what leaves 0..1 is clipped, NaN is 0. Its steps are heard."""

    function: Callable[[Floats], Floats]

    def at(self, t: Floats) -> Floats:
        """The factor at times t [s], same shape."""
        value = np.broadcast_to(np.asarray(self.function(t), dtype=np.float64), t.shape)
        return np.clip(np.nan_to_num(value, nan=0.0), 0.0, 1.0)


def raise_cosine(share: Floats) -> Floats:
    """From 0 to 1 by half a cosine, at shares of the way; less than 0 is 0, more than 1 is 1."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.clip(share, 0.0, 1.0)))


def between_edges(place: Floats, falls: float, edge: float) -> Floats:
    """0 before 0, 1 until `falls`, then 0; up and down within `edge` after that, if it is not 0."""
    if not edge > 0.0:
        return np.asarray((place >= 0.0) & (place < falls), dtype=np.float64)
    up, down = (np.clip(place - after, 0.0, edge) / edge for after in (0.0, falls))
    return raise_cosine(up) - raise_cosine(down)


def frequency(wave: Any, name: str, *, above: bool = False) -> None:
    """Check a frequency [Hz] of a wave; `above` excludes 0."""
    value = check_number(name, getattr(wave, name), low=0.0, high=MAX_FREQUENCY, above=above)
    force_setattr(wave, name, value)


def bounds(wave: Any) -> None:
    """Check the low and the high of a wave."""
    force_setattr(wave, "low", check_number("low", wave.low, low=0.0, high=1.0))
    force_setattr(wave, "high", check_number("high", wave.high, low=wave.low, high=1.0))


def between(table: Any, place: Floats) -> Floats:
    """The values of a table, (L,), at places in 0..L-2, any fraction: straight from one to the next."""
    i = place.astype(np.intp)
    a = table[i]
    return np.asarray(a + (place - i) * (table[i + 1] - a))
