"""Preset envelopes: the four textures that Hasegawa and Shinoda name."""

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
BUZZ = Sine(250.0)
# Periods of the presets that have one [s].
PRESET_PERIODS: dict[str, float] = {
    "impulsive": 0.25, "rapturous": 1.0 / SWELL.frequency, "buzzing": 1.0 / BUZZ.frequency
}  # fmt: skip


class Preset(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="preset"):
    """One of the four textures of Hasegawa and Shinoda (their Figure 2), by name.

    They show waveforms without numbers, so the numbers are ours.

    impulsive: 4 taps per second. Each rises within 1.5 ms and decays within about 40 ms (time constant 15 ms).
    rapturous: a vibration of 150 Hz that swells and fades once in 1.5 s.
    trembling: a vibration of 40 Hz whose strength varies irregularly, several times per second.
    buzzing: a steady vibration of 250 Hz, where Pacinian corpuscles are most sensitive. Raises ArgumentError.
    """

    name: PresetName

    def __post_init__(self) -> None:
        if self.name not in get_args(PresetName):
            names = ", ".join(f'"{name}"' for name in PRESETS)
            raise ArgumentError("preset", f"must be one of {names}, not {self.name!r}")

    def at(self, t: Floats) -> Floats:
        """Return the factor at times t [s], in the same shape."""
        return PRESETS[self.name](t)


def impulsive(t: Floats) -> Floats:
    """Return the factor of the preset "impulsive" at times t [s]."""
    s = t % PRESET_PERIODS["impulsive"]
    return raise_cosine(s / EDGE) * np.exp(-s / 0.015)


def rapturous(t: Floats) -> Floats:
    """Return the factor of the preset "rapturous" at times t [s]."""
    return THRILL.at(t) * SWELL.at(t)


def trembling(t: Floats) -> Floats:
    """Return the factor of the preset "trembling" at times t [s]."""
    return TREMBLE.at(t) * WANDER.at(t)


PRESETS: dict[PresetName, Callable[[Floats], Floats]] = {
    "impulsive": impulsive,
    "rapturous": rapturous,
    "trembling": trembling,
    "buzzing": BUZZ.at,
}
