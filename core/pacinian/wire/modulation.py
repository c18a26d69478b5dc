"""Envelopes and techniques on the wire: as in scene files, but with waves as numbers instead of files."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

from pacinian.wire.binary_arrays import Rows, check_arrays
from pacinian.wire.protocol import MAX_VALUES, Angle, Duration, Frequency, Length, Seconds, Share
from pacinian.wire.shapes import Curve

PresetName = Literal["impulsive", "rapturous", "trembling", "buzzing"]
PositiveFrequency = Annotated[float, Meta(gt=0.0, le=20_000.0, description="[Hz]")]


class Constant(Struct, frozen=True, tag_field="type", tag="constant"):
    """A constant envelope. level: strength."""

    level: Share = 1.0


class Sine(Struct, frozen=True, tag_field="type", tag="sine"):
    """A sine that starts at its minimum. frequency: frequency of the sine. low: minimum. high: maximum."""

    frequency: Frequency
    low: Share = 0.0
    high: Share = 1.0


class Square(Struct, frozen=True, tag_field="type", tag="square"):
    """A square wave that starts high.

    frequency: frequency of the wave. low: level in the low phase. high: level in the high phase. duty: share of the
    high phase.
    """

    frequency: Frequency
    low: Share = 0.0
    high: Share = 1.0
    duty: Share = 0.5


class Pulse(Struct, frozen=True, tag_field="type", tag="pulse"):
    """A pulse.

    width: duration of the pulse. period: time between the starts of pulses; by default there is only one pulse. start:
    start of the first pulse. rise: duration of the rise and of the fall, which are part of the width. low: level
    outside of pulses. high: level of pulses.
    """

    width: Duration
    period: Duration | None = None
    start: Seconds = 0.0
    rise: Annotated[float, Meta(ge=0.0, le=1e6, description="[s]")] = 0.0
    low: Share = 0.0
    high: Share = 1.0


class Noise(Struct, frozen=True, tag_field="type", tag="noise"):
    """Random noise about the mean of low and high, with a flat spectrum.

    low_frequency: lower limit of the band. high_frequency: upper limit of the band. low: value 2.5 standard deviations
    below the mean; lower values are clipped. high: value 2.5 standard deviations above the mean; higher values are
    clipped. seed: equal seeds give equal noise.
    """

    low_frequency: Frequency
    high_frequency: PositiveFrequency
    low: Share = 0.0
    high: Share = 1.0
    seed: Annotated[int, Meta(ge=0, le=2**32 - 1)] = 0


class Preset(Struct, frozen=True, tag_field="type", tag="preset"):
    """One of the four textures of Hasegawa and Shinoda. name: its name, which may stand alone as the envelope."""

    name: PresetName


class Wave(Struct, frozen=True, kw_only=True, tag_field="type", tag="wave"):
    """A recorded wave. samples: x in -1..1, (L,) float32. rate: sampling rate. loop: whether it repeats or plays once.

    mode: "waveform" if the radiation pressure follows (1 + x) / 2, "loudness" if it follows the loudness of x.
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
    """All samples at once, at all times."""


class AM(Struct, frozen=True, tag_field="type", tag="am"):
    """Amplitude modulation by a sine. frequency: frequency of the sine. depth: 1 if the pressure falls to zero."""

    frequency: Frequency = 200.0
    depth: Share = 1.0


class STM(Struct, frozen=True, tag_field="type", tag="stm"):
    """Spatio-temporal modulation: a single focus that runs along a path.

    frequency: passages of the whole path per second. along: "samples" to go from sample to sample, "outline" to go
    around all of them, or a curve in their tangent plane. dwell: time at each position; by default 1/720 of the period.
    """

    frequency: PositiveFrequency
    along: Literal["samples", "outline"] | Curve = "samples"
    dwell: Duration | None = None


class LM(Struct, frozen=True, tag_field="type", tag="lm"):
    """Lateral modulation: every sample oscillates as a sine, perpendicular to its normal.

    frequency: frequency of the sine. amplitude: displacement to either side. angle: angle of the motion from the
    frame's x-axis, turned about the normal.
    """

    frequency: Frequency
    amplitude: Length
    angle: Angle = 0.0


Technique = Simultaneous | AM | STM | LM
