"""How strong an object is over time: a factor in 0..1 on its radiation pressure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from pacinian.errors import ArgumentError
from pacinian.scene.modulation.noise import Noise
from pacinian.scene.modulation.presets import PRESETS, Preset, PresetName
from pacinian.scene.modulation.recorded_wave import Wave
from pacinian.scene.modulation.waves import Constant, Function, Pulse, Sine, Square

if TYPE_CHECKING:
    from pacinian.types import Floats

__all__ = [
    "STEADY",
    "Constant",
    "Envelope",
    "Function",
    "Noise",
    "Preset",
    "Pulse",
    "Sine",
    "Square",
    "Timed",
    "Wave",
    "resolve",
]


class Timed(Protocol):
    """What an envelope does."""

    def at(self, t: Floats) -> Floats:
        """The factor in 0..1 at times t [s], same shape."""
        ...


if TYPE_CHECKING:
    Envelope = PresetName | Timed
else:  # what a scene file may hold
    Envelope = PresetName | Constant | Sine | Square | Pulse | Noise | Wave | Preset

STEADY = Constant()

_PRESETS = {name: Preset(name) for name in PRESETS}


def resolve(envelope: Envelope) -> Timed:
    """An envelope, or the preset of that name. Raises ArgumentError."""
    if isinstance(envelope, str):
        return _PRESETS.get(envelope) or Preset(envelope)
    if not callable(getattr(envelope, "at", None)):
        raise ArgumentError("envelope", f"must be an envelope, not {envelope!r}")
    return envelope
