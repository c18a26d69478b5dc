"""Quantise gains to the device's levels, the last step before the device."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from pacinian.plugins.backend import Capability, Frame

if TYPE_CHECKING:
    from pacinian.types import Gains, Levels, Singles

Rounding = Literal["dithered", "nearest", "down"]
"""How amplitudes are rounded: with the thresholds of `dither_thresholds`, to the nearest level, or down."""
SURE = 1.0 / 256.0  # amplitudes this close to a level are always rounded to it [levels]
PARTS = 4096  # entries of the lookup table from amplitude, 0..1, to the level where a search starts


def dither_thresholds(count: int) -> Singles:
    """Return fixed dither thresholds, (count,): how far below a level an amplitude is rounded up to it [levels].

    The thresholds are uniformly distributed over the transducers, in random order. Without dither, transducers that
    focus at one point with equal amplitudes would have equal rounding errors, which add up like their sound.
    """
    order = np.random.PCG64(0).random_raw(count).argsort().argsort()
    return (SURE + (1.0 - 2.0 * SURE) * (order + 0.5) / count).astype(np.float32)


class Quantiser:
    """Rounds gains to a device's levels. All frames share the same arrays.

    rows, columns: K and N of a frame.
    """

    def __init__(self, capability: Capability, rows: int, columns: int) -> None:
        self.capability = capability
        self._phase = np.zeros((rows, columns), dtype=np.uint16)
        self._amplitude = np.zeros((rows, columns), dtype=np.uint16)
        # what frames show of these arrays, which a backend must not change
        self._shown = self._phase.view(), self._amplitude.view()
        for levels in self._shown:
            levels.flags.writeable = False
        self._thresholds: dict[Rounding, Singles] = {
            "dithered": np.tile(dither_thresholds(columns), rows),
            "nearest": np.full(rows * columns, 0.5, np.float32),
            "down": np.zeros(rows * columns, np.float32),
        }
        """How far below a level an amplitude is rounded up to it, for each gain of a frame [levels]."""
        turns = np.arange(capability.phases) / capability.phases
        self._unit = np.exp(2j * np.pi * turns).astype(np.complex64)
        self._size = capability.sizes.copy()  # kernels need a writable array
        self._inverse = None if capability.uniform else invert_levels(self._size)

    def make_frame(
        self,
        gains: Gains,
        ceiling: float,
        sequence: int,
        time: float,
        rounding: Rounding = "dithered",
    ) -> Frame:
        """Return the frame for gains, (K, N), due at `time` [s], with no amplitude above `ceiling`, the gain limit."""
        phase, amplitude = self._phase.reshape(-1), self._amplitude.reshape(-1)
        self._round(gains.reshape(-1), ceiling, rounding, phase, amplitude)
        return Frame(sequence, time, *self._shown)

    def quantise_gains(
        self, gains: Gains, ceiling: float, rounding: Rounding = "dithered"
    ) -> Gains:
        """Return gains, (N,), as rounded by the device. Threads may call this at the same time."""
        from pacinian.native import rendering as kernels

        phase, amplitude = np.zeros((2, len(gains)), dtype=np.uint16)
        made = np.zeros(len(gains), dtype=np.complex64)
        self._round(gains, ceiling, rounding, phase, amplitude)
        kernels.dequantise(phase, amplitude, self._unit, self._size, made)
        return made

    def _round(
        self, g: Gains, ceiling: float, rounding: Rounding, phase: Levels, amplitude: Levels
    ) -> None:
        from pacinian.native import rendering as kernels

        can, threshold = self.capability, self._thresholds[rounding]
        top, highest = len(self._size) - 1, can.highest(ceiling)
        if self._inverse is None:
            kernels.quantise(g, can.phases, top, highest, threshold, phase, amplitude)
        else:
            kernels.quantise_by(g, can.phases, *self._inverse, highest, threshold, phase, amplitude)


def limit_rows(gains: Gains, ceiling: float) -> None:
    """Scale down, in place, each row of gains, (K, N), that has an amplitude above `ceiling`.

    Under their envelopes, parts of the gains that cancel in a quiet zone may add up to more than `ceiling`. Clipping
    single gains would not keep the zone quiet.
    """
    gains /= np.maximum(np.abs(gains).max(axis=1, keepdims=True) / ceiling, 1.0)


def invert_levels(size: Singles) -> tuple[Singles, Singles, Levels]:
    """Return the lookup tables of the kernel `quantise_by`: size, slope and first."""
    slope = np.append(1.0 / np.diff(size.astype(np.float64)), 0.0).astype(np.float32)
    starts = np.arange(PARTS + 1, dtype=np.float32) / np.float32(PARTS)
    first = np.searchsorted(size, starts, side="right") - 1
    return np.append(size, np.float32(np.inf)), slope, first.astype(np.uint16)
