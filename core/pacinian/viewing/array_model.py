"""The array and medium of the field computation, as a server describes them."""

from __future__ import annotations

import functools
import pickle
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import Array
from pacinian.acoustics.directivity import DIRECTIVITIES
from pacinian.acoustics.transducer import Transducer
from pacinian.plugins.backend import Capability, Frame

if TYPE_CHECKING:
    from pacinian.viewing.messages import ArrayMessage
    from pacinian.wire.replies import Abilities
    from pacinian.wire.state import FrameState


@dataclass(frozen=True, eq=False)
class ArrayModel:
    """An array in a medium. sizes: amplitudes of the device's levels; empty if they are evenly spaced."""

    array: Array
    medium: Air
    sizes: tuple[float, ...] = ()

    @classmethod
    def of(cls, description: Abilities | ArrayMessage) -> Self | None:
        """Read a server's description; return None if it is missing or has an unknown directivity."""
        sound = description.sound
        if sound is None or sound.directivity not in DIRECTIVITIES:
            return None
        r, n = (
            np.frombuffer(rows, "<f4").reshape(-1, 3)
            for rows in (description.positions, description.normals)
        )
        response = np.frombuffer(sound.response, "<c8") if sound.response else None
        kind = Transducer(
            frequency=description.frequency, pressure=sound.pressure,
            directivity=DIRECTIVITIES[sound.directivity],
        )  # fmt: skip
        medium = Air(
            speed_of_sound=sound.speed_of_sound, density=sound.density, attenuation=sound.power,
            absorption=sound.absorption,
        )  # fmt: skip
        sizes = tuple(np.frombuffer(sound.sizes, "<f4").tolist())
        return cls(Array(r, n, kind, response), medium, sizes)

    @functools.cached_property
    def packed(self) -> bytes:
        """Array and medium as bytes, for another process."""
        return pickle.dumps((self.array, self.medium))

    def gains(self, frame: FrameState) -> bytes:
        """Convert a frame's levels to gains, (1, N) complex64; empty in silence. Raises ValueError, IndexError."""
        if not frame.phase:
            return b""
        phase, amplitude = (
            np.frombuffer(rows, "<u2")[None] for rows in (frame.phase, frame.amplitude)
        )
        if not phase.size == amplitude.size == len(self.array):
            raise ValueError(f"levels of {phase.size} transducers are not of {len(self.array)}")
        capability = Capability(frame.phases, self.sizes or frame.amplitudes)
        made = Frame(frame.sequence, frame.time, phase, amplitude).gains(capability)
        return made.tobytes()
