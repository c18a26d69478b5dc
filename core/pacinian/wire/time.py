"""Envelopes and techniques on the wire: as in scene files, but with waves as numbers, not as files."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

from pacinian.wire.binary_arrays import Rows, check_arrays
from pacinian.wire.protocol import MAX_VALUES, Angle, Frequency, Length, Seconds, Share
from pacinian.wire.shapes import Curve

PresetName = Literal["impulsive", "rapturous", "trembling", "buzzing"]
Period = Annotated[float, Meta(gt=0.0, le=1e6, description="[s]")]
Passages = Annotated[float, Meta(gt=0.0, le=20_000.0, description="[Hz]")]


class Constant(Struct, frozen=True, tag_field="type", tag="constant"):
    """The same at all times. level: how strong."""

    level: Share = 1.0


class Sine(Struct, frozen=True, tag_field="type", tag="sine"):
    """Up and down, starting at its lowest. frequency: how often. low: at its lowest. high: at its highest."""

    frequency: Frequency
    low: Share = 0.0
    high: Share = 1.0


class Square(Struct, frozen=True, tag_field="type", tag="square"):
    """High, then low. frequency: how often. low, high: how strong then. duty: share of a period that is high."""

    frequency: Frequency
    low: Share = 0.0
    high: Share = 1.0
    duty: Share = 0.5


class Pulse(Struct, frozen=True, tag_field="type", tag="pulse"):
    """High for a while, else low.

    width: for how long. period: after which it comes again; only once unless given. start: when it is first high.
    rise: how long it takes up, and again down, within the width. low, high: how strong then.
    """

    width: Period
    period: Period | None = None
    start: Seconds = 0.0
    rise: Annotated[float, Meta(ge=0.0, le=1e6, description="[s]")] = 0.0
    low: Share = 0.0
    high: Share = 1.0


class Noise(Struct, frozen=True, tag_field="type", tag="noise"):
    """Random about the middle of low and high, with an even spectrum.

    low_frequency, high_frequency: ends of its band. low, high: 2.5 standard deviations below and above its middle;
    what goes beyond is clipped. seed: the same is the same noise.
    """

    low_frequency: Frequency
    high_frequency: Passages
    low: Share = 0.0
    high: Share = 1.0
    seed: Annotated[int, Meta(ge=0, le=2**32 - 1)] = 0


class Preset(Struct, frozen=True, tag_field="type", tag="preset"):
    """One of the four textures of Hasegawa and Shinoda. name: of it, which alone will do, too."""

    name: PresetName


class Wave(Struct, frozen=True, kw_only=True, tag_field="type", tag="wave"):
    """A recorded wave. samples: x in -1..1, (L,) float32. rate: of these. loop: again and again, else once.

    mode: "waveform": the radiation pressure follows (1 + x) / 2; "loudness": it follows how loud x is.
    """

    samples: Annotated[bytes, Meta(min_length=4, max_length=4 * MAX_VALUES)]
    rate: Annotated[float, Meta(ge=1.0, le=1e6, description="[Hz]")]
    loop: bool = True
    mode: Literal["waveform", "loudness"] = "waveform"

    BULK = (Rows("samples", 1),)

    def __post_init__(self) -> None:
        check_arrays(self)


STEADY = Constant()
Envelope = PresetName | Constant | Sine | Square | Pulse | Noise | Preset | Wave


class Simultaneous(Struct, frozen=True, tag_field="type", tag="simultaneous"):
    """All samples at once, always."""


class AM(Struct, frozen=True, tag_field="type", tag="am"):
    """Amplitude modulation: pressure up and down as a sine. frequency: of it. depth: 1 goes down to nothing."""

    frequency: Frequency = 200.0
    depth: Share = 1.0


class STM(Struct, frozen=True, tag_field="type", tag="stm"):
    """Spatio-temporal modulation: a single focus that runs along a route.

    frequency: how often it passes the whole route. along: "samples": from
    one to the next; "outline": around them all; or a curve in their tangent plane.
    dwell: time at each place; a 720th of the period unless given.
    """

    frequency: Passages
    along: Literal["samples", "outline"] | Curve = "samples"
    dwell: Period | None = None


class LM(Struct, frozen=True, tag_field="type", tag="lm"):
    """Lateral modulation: every sample moves to and fro across its normal, as a sine.

    frequency: how often. amplitude: to either side. angle: from the frame's x-axis, about the normal.
    """

    frequency: Frequency
    amplitude: Length
    angle: Angle = 0.0


Technique = Simultaneous | AM | STM | LM
