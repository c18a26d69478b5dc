"""Techniques: how the samples of one object are presented in time. Any object may have any of them."""

from __future__ import annotations

import functools
import math
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.checks import check_length, check_number
from pacinian.errors import ArgumentError
from pacinian.scene.modulation.waves import SLIP, frequency
from pacinian.scene.shapes.curves import Curve

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats

PLACES = 720  # of a continuous route: 0.3 mm apart on one of 0.2 m
MAX_PLACES = 10_000  # places
SWING = 64  # steps of a lateral movement to either side
MAX_CACHED = 128  # sets of samples in motion that are at hand
WORLD = np.eye(3)


class _Still(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type"):
    still: ClassVar[bool] = True
    """Whether `present` gives the samples as they are, so that one solution serves all times."""
    single: ClassVar[bool] = False
    """Whether it gives one at a time."""

    def factor(self, t: Floats) -> Floats:
        """What the object's envelope is multiplied by at times t [s], (K,): 0..1."""
        return np.ones(len(t))

    def step(self, t: float) -> int | None:
        """All that matters of t [s] to `present`: a whole number that comes again each period, or None."""
        return None

    def present(self, samples: Samples, t: float, frame: Floats = WORLD) -> Samples:
        """The samples of one object that are sounded at t [s]; the same object for the same step.

        frame: the object's axes as columns, (3, 3); directions in tangent planes start from its x-axis.
        """
        return samples


class _Moving(_Still, frozen=True, forbid_unknown_fields=True, tag_field="type"):
    still: ClassVar[bool] = False

    def present(self, samples: Samples, t: float, frame: Floats = WORLD) -> Samples:
        step = self.step(t)
        if step is None or not len(samples):
            return samples
        key = id(samples), id(self), frame.tobytes()
        kept = _kept.get(key)
        if kept is None:
            while len(_kept) >= MAX_CACHED:
                del _kept[next(iter(_kept))]
            motion = functools.lru_cache(PLACES)(self.motion(samples, frame))
            kept = _kept[key] = samples, self, motion  # all: their ids stay taken
        return kept[2](step)

    def motion(self, samples: Samples, frame: Floats) -> Callable[[int], Samples]:
        """What is sounded at each step."""
        raise NotImplementedError


_kept: dict[tuple[int, int, bytes], tuple[Samples, _Moving, Callable[[int], Samples]]] = {}


class Simultaneous(_Still, frozen=True, tag="simultaneous"):
    """All samples at once, always."""


class AM(_Still, frozen=True, tag="am"):
    """Amplitude modulation: all samples at once, their radiation pressure up and down as a sine.

    frequency: [Hz]. depth: 1 goes down to nothing, 0 not at all. It starts at its lowest, and comes on
    top of the object's own envelope. Raises ArgumentError.
    """

    frequency: float = 200.0
    depth: float = 1.0

    def __post_init__(self) -> None:
        frequency(self, "frequency")
        force_setattr(self, "depth", check_number("depth", self.depth, low=0.0, high=1.0))

    def factor(self, t: Floats) -> Floats:
        """What the object's envelope is multiplied by at times t [s], (K,): 1 - depth to 1."""
        return 1.0 - self.depth / 2.0 * (1.0 + np.cos(2.0 * np.pi * self.frequency * t))


class STM(_Moving, frozen=True, tag="stm"):
    """Spatio-temporal modulation: a single focus that runs along a route, again and again.

    frequency: how often it passes the whole route [Hz]. along: "samples": from one to the next, each with
    its own radiation pressure, for an equal time; "outline": around them all; or a curve in their tangent
    plane, about their centre. On these two it is the samples' mean, weighted by itself.

    dwell: time at each place [s]: the route is divided into the whole number of places, at most 10,000,
    for which this comes nearest (`places`). Unless given, 720: it moves on with each frame of a device.
    More samples than places, or than frames in a period, and some are left out. The focus has one key,
    -1 less the object's index, always. Raises ArgumentError.
    """

    frequency: float
    along: Literal["samples", "outline"] | Curve = "samples"
    single: ClassVar[bool] = True
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
        """How many places the focus takes on each passage."""
        return PLACES if self.dwell is None else round(1.0 / (self.frequency * self.dwell))

    def step(self, t: float) -> int:
        """At which place the focus is at t [s]."""
        n = self.places
        return int((self.frequency * (t + SLIP)) % 1.0 * n) % n

    def motion(self, samples: Samples, frame: Floats) -> Callable[[int], Samples]:
        """The focus at each place."""
        from pacinian.scene.modulation import stm_paths

        if self.along == "samples":
            route = stm_paths.visit_one_by_one(samples)
        elif self.along == "outline":
            route = stm_paths.visit_around(samples, frame)
        else:
            route = stm_paths.visit_along(samples, self.along, frame)
        n = self.places
        return lambda i: route(i, n)


class LM(_Moving, frozen=True, tag="lm"):
    """Lateral modulation: every sample moves to and fro across its normal, as a sine.

    frequency: [Hz]. amplitude: to either side [m]. angle: from the frame's x-axis, about the normal [deg].
    With a focus that moves to and fro or round on the skin, Takahashi, Hasegawa and Shinoda found lower
    thresholds than with amplitude modulation (EuroHaptics 2018), and stronger sensations at the same
    output, at 10 to 200 Hz (IEEE Transactions on Haptics 13, 2020, 334-342). Raises ArgumentError.
    """

    frequency: float
    amplitude: float
    angle: float = 0.0

    def __post_init__(self) -> None:
        frequency(self, "frequency")
        force_setattr(self, "amplitude", check_length("amplitude", self.amplitude))
        force_setattr(self, "angle", check_number("angle", self.angle))

    def step(self, t: float) -> int:
        """Where in its movement every sample is at t [s]: -64 to 64."""
        return round(SWING * math.sin(2.0 * math.pi * ((self.frequency * t) % 1.0)))

    def motion(self, samples: Samples, frame: Floats) -> Callable[[int], Samples]:
        """The samples at each step."""
        from pacinian.scene.modulation.tangent_plane import find_tangents

        d = self.amplitude * find_tangents(samples.normals, math.radians(self.angle), frame)
        return lambda i: replace(samples, positions=samples.positions + i / SWING * d)


Technique = Simultaneous | AM | STM | LM
"""Any of them."""

SIMULTANEOUS = Simultaneous()
