"""How strong an object is over time: a factor in 0..1 on its radiation pressure."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.checks import number
from pacinian.types import Floats


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
        _check(self)

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
        _check(self)
        force_setattr(self, "duty", number("duty", self.duty, low=0.0, high=1.0))

    def at(self, t: Floats) -> Floats:
        """The factor at times t [s], same shape."""
        return np.where((self.frequency * t) % 1.0 < self.duty, self.high, self.low)


class Function(Struct, frozen=True):
    """Any function of times [s], (K,) -> (K,); what leaves 0..1 is clipped, NaN is 0."""

    function: Callable[[Floats], Floats]

    def at(self, t: Floats) -> Floats:
        """The factor at times t [s], same shape."""
        value = np.broadcast_to(np.asarray(self.function(t), dtype=np.float64), t.shape)
        return np.clip(np.nan_to_num(value, nan=0.0), 0.0, 1.0)


if TYPE_CHECKING:
    Envelope = Constant | Sine | Square | Function
else:  # what a scene file may hold
    Envelope = Constant | Sine | Square

STEADY = Constant()


FASTEST = 100_000.0  # [Hz], more than any device can follow


def _check(wave: Sine | Square) -> None:
    force_setattr(wave, "frequency", number("frequency", wave.frequency, low=0.0, high=FASTEST))
    force_setattr(wave, "low", number("low", wave.low, low=0.0, high=1.0))
    force_setattr(wave, "high", number("high", wave.high, low=wave.low, high=1.0))
