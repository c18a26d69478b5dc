"""The four textures that the paper names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from msgspec import Struct

from pacinian.errors import ArgumentError
from pacinian.scene.modulation.noise import Noise
from pacinian.scene.modulation.waves import EDGE, Sine, raise_cosine

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.types import Floats

PresetName = Literal["impulsive", "rapturous", "trembling", "buzzing"]

TREMBLE, WANDER = Sine(40.0), Noise(0.5, 8.0, low=0.2)
THRILL, SWELL = Sine(150.0), Sine(2.0 / 3.0)


class Preset(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="preset"):
    """One of the four textures of Hasegawa and Shinoda (their Figure 2), by its name.

    They show waveforms and give no numbers: these are ours.

    impulsive: taps, 4 a second: up within 1.5 ms, and away within about 40 ms (a time constant of 15).
    rapturous: a vibration of 150 Hz that swells and fades once in 1.5 s.
    trembling: a vibration of 40 Hz whose strength wanders irregularly, some times a second.
    buzzing: a steady vibration of 250 Hz, where Pacinian corpuscles feel best. Raises ArgumentError.
    """

    name: PresetName

    def __post_init__(self) -> None:
        if self.name not in get_args(PresetName):
            names = ", ".join(f'"{name}"' for name in PRESETS)
            raise ArgumentError("preset", f"must be one of {names}, not {self.name!r}")

    def at(self, t: Floats) -> Floats:
        """The factor at times t [s], same shape."""
        return PRESETS[self.name](t)


def impulsive(t: Floats) -> Floats:
    """Taps."""
    s = t % 0.25
    return raise_cosine(s / EDGE) * np.exp(-s / 0.015)


def rapturous(t: Floats) -> Floats:
    """Swells."""
    return THRILL.at(t) * SWELL.at(t)


def trembling(t: Floats) -> Floats:
    """Irregular."""
    return TREMBLE.at(t) * WANDER.at(t)


PRESETS: dict[PresetName, Callable[[Floats], Floats]] = {
    "impulsive": impulsive,
    "rapturous": rapturous,
    "trembling": trembling,
    "buzzing": Sine(250.0).at,
}
