"""The wire protocol of OpenMPD boards; see docs/openmpd.md."""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pacinian as pc
    from pacinian.types import Levels

Bytes: TypeAlias = NDArray[np.uint8]

BOARD, FRAME = 256, 512  # transducers per board; bytes per frame
PHASES, MAX_PULSE = 128, 64  # phase levels per turn; longest pulse, half a period
PULSE_PRESSURES = tuple(math.sin(0.5 * math.pi * n / MAX_PULSE) for n in range(MAX_PULSE + 1))
"""Sound pressure of each pulse length, relative to the strongest."""
CARRIER, MAX_DIVIDER = 40_000.0, 255  # carrier frequency [Hz]; its largest divider
RESYNC_PAUSE = 1.3  # pause after which the FPGA discards a partial frame [s]; it needs 1.0

FLAG = 0x80  # bit 7 of a phase
# where its bits begin, the lowest first; the byte behind them says to take it
COLOUR, DIVIDER = 1, 26
CENTRE = ((MAX_PULSE - np.arange(MAX_PULSE + 1)) // 2).astype(np.uint16)
"""Delay of each pulse length that keeps the centre of the pulse in place."""


def encode_divider(rate: float) -> int:
    """Return the divider of 40 kHz that plays slightly faster than `rate` [Hz], so that frames do not pile up."""
    return min(max(math.ceil(CARRIER / rate) - 1, 1), MAX_DIVIDER)


def encode_off(divide: int, led: Sequence[int]) -> array[int]:
    """Encode the three frames that silence a board, whatever it received before.

    The leading zeros complete a truncated frame. The trailing zeros only push the middle frame out of the FIFO, which
    delivers 512 bytes at a time. The frames also set the divider and the light: red, green, blue, 0 to 255.
    """
    made = np.zeros((3, FRAME), np.uint8)
    frame = made[1]
    frame[0] = FLAG
    for begin, values in ((COLOUR, led), (DIVIDER, [divide])):
        bits = np.unpackbits(np.array(values, np.uint8), bitorder="little")
        frame[begin : begin + len(bits)] = FLAG * bits
        frame[begin + len(bits)] = FLAG
    return array("B", made.tobytes())


class Packer:
    """Converts frames of an array to the bytes of each board, in reused buffers."""

    def __init__(self, wirings: Sequence[pc.Wiring]) -> None:
        N = BOARD * len(wirings)
        indices, alive = np.zeros(N, np.intp), np.zeros(N, bool)
        for b, wiring in enumerate(wirings):
            channels = BOARD * b + wiring.channels
            indices[channels], alive[channels] = wiring.indices, True
        self._indices, self._dead = indices, np.flatnonzero(~alive)
        self._boards = len(wirings)
        self._made: dict[int, tuple[Levels, list[array[int]], list[Bytes]]] = {}

    def pack(self, phase: Levels, amplitude: Levels) -> list[array[int]]:
        """Return K frames for each board. phase, amplitude: levels of the whole array, (K, N), in range."""
        K, B = len(phase), self._boards
        if K not in self._made:
            levels = np.empty((2, K, B * BOARD), np.uint16)
            buffers = [array("B", bytes(K * FRAME)) for _ in range(B)]
            views = [np.frombuffer(buffer, np.uint8).reshape(K, 2, BOARD) for buffer in buffers]
            self._made[K] = levels, buffers, views
        (p, a), buffers, views = self._made[K]
        np.take(phase, self._indices, axis=1, out=p, mode="clip")
        np.take(amplitude, self._indices, axis=1, out=a, mode="clip")
        a[:, self._dead] = 0
        begin = (CENTRE.take(a) - p) & (PHASES - 1)  # boards count lags, levels are leads
        begin, a = begin.reshape(K, B, BOARD), a.reshape(K, B, BOARD)
        for b, view in enumerate(views):
            view[:, 0], view[:, 1] = begin[:, b], a[:, b]
            view[:, 0, 0] |= FLAG
        return buffers
