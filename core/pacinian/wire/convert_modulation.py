"""Conversion of wire envelopes and techniques to those of `pacinian.scene` and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.msgpack import Decoder
from msgspec.structs import asdict

from pacinian.errors import WireError
from pacinian.scene.modulation import envelope as scene_envelope
from pacinian.scene.modulation import technique as scene_technique
from pacinian.scene.modulation import wav
from pacinian.wire import modulation
from pacinian.wire.binary_arrays import pack, unpack
from pacinian.wire.codec import check_part
from pacinian.wire.convert_shapes import (
    degrees_to_radians,
    radians_to_degrees,
    shape_to_scene,
    shape_to_wire,
)
from pacinian.wire.decode_errors import locate_errors
from pacinian.wire.protocol import MAX_VALUES

ENVELOPES: dict[type, type] = {  # classes whose fields have the same names
    modulation.Constant: scene_envelope.Constant,
    modulation.Sine: scene_envelope.Sine,
    modulation.Square: scene_envelope.Square,
    modulation.Pulse: scene_envelope.Pulse,
    modulation.Noise: scene_envelope.Noise,
    modulation.Preset: scene_envelope.Preset,
}
TECHNIQUES: dict[type, type] = {
    modulation.Simultaneous: scene_technique.Simultaneous,
    modulation.AM: scene_technique.AM,
}
ENVELOPES_BACK: dict[type, type] = {theirs: ours for ours, theirs in ENVELOPES.items()}
TECHNIQUES_BACK: dict[type, type] = {theirs: ours for ours, theirs in TECHNIQUES.items()}

_envelopes: Decoder[modulation.Envelope] = Decoder(modulation.Envelope)
_techniques: Decoder[modulation.Technique] = Decoder(modulation.Technique)

if TYPE_CHECKING:
    from collections.abc import Callable

    Technique = scene_technique.Technique


def envelope_to_scene(
    envelope: modulation.Envelope, path: str = "$.envelope"
) -> scene_envelope.Envelope:
    """Convert a wire envelope to a scene envelope. Raises WireError."""
    if envelope == modulation.STEADY:  # the common case: share one object, so that it is recognised
        return scene_envelope.STEADY
    return locate_errors(path, _envelope_to_scene, envelope)


def envelope_to_wire(
    envelope: scene_envelope.Envelope, path: str = "$.envelope"
) -> modulation.Envelope:
    """Convert a scene envelope to a wire envelope. Reads its file. Raises WireError, also beyond the wire's bounds."""
    if envelope is scene_envelope.STEADY:
        return modulation.STEADY
    return check_part(_envelopes, locate_errors(path, _envelope_to_wire, envelope), path)


def technique_to_scene(technique: modulation.Technique, path: str = "$.technique") -> Technique:
    """Convert a wire technique to a scene technique. Raises WireError."""
    made: Technique = locate_errors(path, _technique_to_scene, technique)
    return made


def technique_to_wire(technique: Technique, path: str = "$.technique") -> modulation.Technique:
    """Convert a scene technique to a wire technique. Raises WireError, also beyond the wire's bounds."""
    return check_part(_techniques, locate_errors(path, _technique_to_wire, technique), path)


def _envelope_to_scene(envelope: Any) -> Any:
    if isinstance(envelope, str):
        return scene_envelope.resolve(envelope)  # type: ignore[arg-type]
    if isinstance(envelope, modulation.Wave):
        samples: Any = unpack(envelope.samples, 1)[:, 0]
        return scene_envelope.Wave("", samples, envelope.rate, envelope.loop, envelope.mode)
    return ENVELOPES[type(envelope)](**asdict(envelope))


def _envelope_to_wire(envelope: Any) -> Any:
    if isinstance(envelope, str):
        return envelope
    if isinstance(envelope, scene_envelope.Wave):
        return _wave_to_wire(envelope)
    if (kind := ENVELOPES_BACK.get(type(envelope))) is None:
        raise WireError("a function cannot be sent: give a Wave with its samples")
    return kind(**asdict(envelope))


def _wave_to_wire(wave: scene_envelope.Wave) -> modulation.Wave:
    if wave.rate is None:
        rate, x = wav.read_wav(wave.file)
    else:
        rate, x = wave.rate, np.array(wave.samples)
    if len(x) > MAX_VALUES:
        raise WireError(
            f"is {len(x):,} samples: keep to {MAX_VALUES:,}, at a lower rate; "
            "skin feels nothing above 1 kHz",
            ".samples",
        )
    samples = pack(np.clip(x, -1.0, 1.0))
    return modulation.Wave(samples=samples, rate=rate, loop=wave.loop, mode=wave.mode)


def _technique_to_scene(technique: Any) -> Any:
    if isinstance(technique, modulation.STM):
        along: Any = _along(technique.along, shape_to_scene)
        return scene_technique.STM(technique.frequency, along, technique.dwell)
    if isinstance(technique, modulation.LM):
        angle = degrees_to_radians(technique.angle)
        return scene_technique.LM(technique.frequency, technique.amplitude, angle)
    return TECHNIQUES[type(technique)](**asdict(technique))


def _technique_to_wire(technique: Any) -> Any:
    if isinstance(technique, scene_technique.STM):
        along: Any = _along(technique.along, shape_to_wire)
        return modulation.STM(technique.frequency, along, technique.dwell)
    if isinstance(technique, scene_technique.LM):
        angle = radians_to_degrees(technique.angle)
        return modulation.LM(technique.frequency, technique.amplitude, angle)
    if (kind := TECHNIQUES_BACK.get(type(technique))) is None:
        raise WireError(f"is no technique: {technique!r}")
    return kind(**asdict(technique))


def _along(along: object, convert: Callable[[Any], Any]) -> object:
    return along if isinstance(along, str) else locate_errors(".along", convert, along)
