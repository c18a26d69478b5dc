"""The last steps before the device: envelopes on gains, gains to device levels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.plugins.backend import Capability, Frame

if TYPE_CHECKING:
    from pacinian.types import Floats, Gains


def modulate(gains: Gains, envelope: Floats, out: Gains) -> None:
    """Gains (N,) at K moments: the envelope, (K,), scales radiation pressure, so gains by its root.

    out: (K, N).
    """
    np.multiply(np.sqrt(envelope).astype(np.float32)[:, None], gains, out=out)


class Quantiser:
    """Rounds gains to a device's levels, into one frame that is reused.

    rows, columns: K and N of a frame.
    """

    def __init__(self, capability: Capability, rows: int, columns: int) -> None:
        self.capability = capability
        self._made = np.zeros(columns, dtype=np.complex64)
        self._phase = np.zeros((rows, columns), dtype=np.uint16)
        self._amplitude = np.zeros((rows, columns), dtype=np.uint16)
        turns = np.arange(capability.phases) / capability.phases
        self._unit = np.exp(2j * np.pi * turns).astype(np.complex64)
        levels = np.arange(capability.amplitudes) / (capability.amplitudes - 1)
        self._size = levels.astype(np.float32)

    def frame(self, gains: Gains, ceiling: float, sequence: int, time: float) -> Frame:
        """The frame for gains (K, N), no amplitude above `ceiling`, the gain limit; due at `time` [s]."""
        self._round(gains, ceiling)
        return Frame(sequence, time, self._phase, self._amplitude)

    def emitted(self, gains: Gains, ceiling: float) -> Gains:
        """What the device makes of gains (N,); the array is reused."""
        from pacinian.acoustics import kernels

        self._round(gains[None], ceiling)
        kernels.dequantise(self._phase[0], self._amplitude[0], self._unit, self._size, self._made)
        return self._made

    def _round(self, gains: Gains, ceiling: float) -> None:
        from pacinian.acoustics import kernels

        rows = len(gains)
        kernels.quantise(
            gains.reshape(-1),
            self.capability.phases,
            self.capability.amplitudes,
            np.float32(ceiling),
            self._phase[:rows].reshape(-1),
            self._amplitude[:rows].reshape(-1),
        )
