"""Envelopes given by a formula: constant, sine, square, pulse, and any function of time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.argument_checks import check_number, check_real
from pacinian.types import Floats

MAX_FREQUENCY = 100_000.0  # highest frequency of an envelope [Hz], more than any device can follow
# Shortest time from low to high or back [s]. A shorter edge is louder, and a longer one feels weaker (decision 45).
EDGE = 1.5e-3
SLIP = 1e-9  # time added so that rounding does not delay an edge by one frame [s]


class Constant(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="constant"):
    """A constant. level: 0..1. Raises ArgumentError."""

    level: float = 1.0

    def __post_init__(self) -> None:
        force_setattr(self, "level", check_number("level", self.level, low=0.0, high=1.0))

    def at(self, t: Floats) -> Floats:
        """Return the factor at times t [s], in the same shape."""
        return np.full(np.shape(t), self.level)


class Sine(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="sine"):
    """A sine between low and high, which starts at low. frequency: [Hz]. Raises ArgumentError."""

    frequency: float
    low: float = 0.0
    high: float = 1.0

    def __post_init__(self) -> None:
        frequency(self, "frequency")
        bounds(self)

    def at(self, t: Floats) -> Floats:
        """Return the factor at times t [s], in the same shape."""
        half = (self.high - self.low) / 2.0
        return self.low + half * (1.0 - np.cos(2.0 * np.pi * self.frequency * t))


class Square(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="square"):
    """A square wave: high for the fraction `duty` of each period, then low. frequency: [Hz].

    The wave starts at low. Because steps are audible, each edge is half a cosine of 1.5 ms, or shorter if high or low
    do not last as long. Raises ArgumentError.
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
        """Return the factor at times t [s], in the same shape."""
        return self._at(t, min(EDGE * self.frequency, self.duty, 1.0 - self.duty))

    def compute_steps(self, t: Floats) -> Floats:
        """Return the factor with steps instead of edges, for devices that are either on or off."""
        return self._at(t, 0.0)

    def _at(self, t: Floats, edge: float) -> Floats:
        place = (self.frequency * (t + SLIP)) % 1.0  # in the period
        return self.low + (self.high - self.low) * compute_gate(place, self.duty, edge)


class Pulse(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="pulse"):
    """A pulse: high for `width` [s] from `start` [s] on, and otherwise low.

    period: of repetition [s]; None for a single pulse. rise: duration of each edge within the width, half a cosine [s].
    Because steps are audible, the edges take at least 1.5 ms if the width and the rest of the period allow it. Raises
    ArgumentError.
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
        """Return the factor at times t [s], in the same shape."""
        s, falls, edge = t - self.start + SLIP, self.width - self.rise, EDGE
        if self.period is not None:
            s, edge = s % self.period, min(EDGE, self.period - falls)
        edge = max(self.rise, min(edge, falls))
        return self.low + (self.high - self.low) * compute_gate(s, falls, edge)


class Function(Struct, frozen=True):
    """Any function of times [s], (K,) -> (K,). Values outside 0..1 are clipped, and NaN is 0. Steps are audible.

    function: gets a copy of the times, which it may change.
    """

    function: Callable[[Floats], Floats]

    def at(self, t: Floats) -> Floats:
        """Return the factor at times t [s], in the same shape. Raises ArgumentError for other values than numbers."""
        value = np.broadcast_to(check_real("function", self.function(t.copy())), t.shape)
        return np.clip(np.nan_to_num(value, nan=0.0), 0.0, 1.0)


def raise_cosine(share: Floats) -> Floats:
    """Return half a cosine from 0 to 1 as `share` goes from 0 to 1; 0 before, and 1 after."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.clip(share, 0.0, 1.0)))


def compute_gate(place: Floats, falls: float, edge: float) -> Floats:
    """Return 1 from 0 to `falls`, and otherwise 0. Each edge starts there and takes `edge`, if that is not 0."""
    if not edge > 0.0:
        return np.asarray((place >= 0.0) & (place < falls), dtype=np.float64)
    up, down = (np.clip(place - after, 0.0, edge) / edge for after in (0.0, falls))
    return raise_cosine(up) - raise_cosine(down)


def frequency(wave: Any, name: str, *, above: bool = False) -> None:
    """Check a frequency [Hz] of a wave; `above` excludes 0."""
    value = check_number(name, getattr(wave, name), low=0.0, high=MAX_FREQUENCY, above=above)
    force_setattr(wave, name, value)


def bounds(wave: Any) -> None:
    """Check the limits `low` and `high` of a wave."""
    force_setattr(wave, "low", check_number("low", wave.low, low=0.0, high=1.0))
    force_setattr(wave, "high", check_number("high", wave.high, low=wave.low, high=1.0))


def interpolate_table(table: Any, place: Floats) -> Floats:
    """Interpolate the values of a table, (L,), linearly at fractional places from 0 up to, but not including, L - 1."""
    i = place.astype(np.intp)
    a = table[i]
    return np.asarray(a + (place - i) * (table[i + 1] - a))
