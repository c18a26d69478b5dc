"""Techniques: how the samples of one object are presented in time. Any object can use any technique."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.argument_checks import check_angle, check_length, check_number
from pacinian.errors import ArgumentError
from pacinian.scene.modulation.waves import SLIP, frequency
from pacinian.scene.shapes.curves import Curve

if TYPE_CHECKING:
    from pacinian.types import Floats

PLACES = 720  # default number of places on a path: 0.3 mm apart on a path of 0.2 m
MAX_PLACES = 10_000  # largest number of places on a path
SWING = 64  # steps of a lateral movement to either side


class _Technique(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type"):
    keeps_places: ClassVar[bool] = True
    """Whether all samples sound at their places, so that one solution serves all times."""
    single: ClassVar[bool] = False
    """Whether one sample sounds at a time."""

    def factor(self, t: Floats) -> Floats:
        """Return the factor on the object's envelope, 0..1, at times t [s], (K,)."""
        return np.ones(len(t))

    def step(self, t: float) -> int | None:
        """Return the step, a periodic integer, that decides what sounds at t [s]; None if time does not matter."""
        return None


class Simultaneous(_Technique, frozen=True, tag="simultaneous"):
    """All samples sound at once, all the time."""


class AM(_Technique, frozen=True, tag="am"):
    """Amplitude modulation: all samples sound at once, and their radiation pressure follows a sine.

    frequency: [Hz]. depth: 1 modulates down to zero, 0 does not modulate. The sine starts at its minimum and multiplies
    the object's own envelope. Raises ArgumentError.
    """

    frequency: float = 200.0
    depth: float = 1.0

    def __post_init__(self) -> None:
        frequency(self, "frequency")
        force_setattr(self, "depth", check_number("depth", self.depth, low=0.0, high=1.0))

    def factor(self, t: Floats) -> Floats:
        """Return the factor on the object's envelope, 1 - depth to 1, at times t [s], (K,)."""
        return 1.0 - self.depth / 2.0 * (1.0 + np.cos(2.0 * np.pi * self.frequency * t))


class STM(_Technique, frozen=True, tag="stm"):
    """Spatio-temporal modulation: a single focus that moves along a path, again and again.

    frequency: of the whole path [Hz]. along: "samples" moves from one sample to the next, with the radiation pressure
    of each, for equal times; "outline" moves around all samples; a curve is followed in their tangent plane, around
    their centre. On an outline or a curve, the radiation pressure is the mean of the samples, weighted by their
    pressures.

    dwell: time at each place [s]. The path is divided into a whole number of `places`, at most 10,000, so that the time
    at each is nearest to this. By default there are 720 places, which are enough for the focus to move in every frame
    of a device. If there are more samples than places, or than frames in a period, some are left out. Raises
    ArgumentError.
    """

    keeps_places: ClassVar[bool] = False
    single: ClassVar[bool] = True
    frequency: float
    along: Literal["samples", "outline"] | Curve = "samples"
    dwell: float | None = None

    def __post_init__(self) -> None:
        frequency(self, "frequency", above=True)
        if isinstance(self.along, str):
            known = self.along in ("samples", "outline")
        else:
            known = callable(getattr(self.along, "at", None))
        if not known:
            raise ArgumentError(
                "along", f'must be "samples", "outline" or a curve, not {self.along!r}'
            )
        if self.dwell is None:
            return
        period = 1.0 / self.frequency
        dwell = check_number("dwell", self.dwell, low=period / MAX_PLACES, high=period)
        force_setattr(self, "dwell", dwell)

    @property
    def places(self) -> int:
        """Number of places on the path."""
        return PLACES if self.dwell is None else round(1.0 / (self.frequency * self.dwell))

    def step(self, t: float) -> int:
        """Return the place of the focus at t [s], from 0 on."""
        n = self.places
        return int((self.frequency * (t + SLIP)) % 1.0 * n) % n


class LM(_Technique, frozen=True, tag="lm"):
    """Lateral modulation: every sample oscillates across its normal, as a sine.

    frequency: [Hz]. amplitude: to either side [m]. angle: of the movement, from the frame's x-axis about the normal
    [rad]. Raises ArgumentError.

    Takahashi, Hasegawa and Shinoda moved a focus to and fro, or in a circle, on the skin. They found lower thresholds
    than with amplitude modulation (EuroHaptics 2018), and stronger sensations at the same output from 10 to 200 Hz
    (IEEE Transactions on Haptics 13, 2020, 334-342).
    """

    keeps_places: ClassVar[bool] = False
    frequency: float
    amplitude: float
    angle: float = 0.0

    def __post_init__(self) -> None:
        frequency(self, "frequency")
        force_setattr(self, "amplitude", check_length("amplitude", self.amplitude))
        force_setattr(self, "angle", check_angle("angle", self.angle))

    def step(self, t: float) -> int:
        """Return the step of the movement at t [s], -64 to 64."""
        return round(SWING * math.sin(2.0 * math.pi * ((self.frequency * t) % 1.0)))


Technique = Simultaneous | AM | STM | LM
"""Any technique."""

SIMULTANEOUS = Simultaneous()
