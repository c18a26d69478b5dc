"""The wire of OpenMPD boards, as bytes: see docs/openmpd.md."""

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

BOARD, FRAME = 256, 512  # transducers of a board, bytes of a frame
PHASES, DUTY = 128, 64  # levels in a turn; the longest pulse, half a period
SIZES = tuple(math.sin(0.5 * math.pi * n / DUTY) for n in range(DUTY + 1))
"""Sound pressure of each pulse length, of the strongest."""
CARRIER, SLOWEST = 40_000.0, 255  # [Hz]; the largest divider of it
PAUSE = 1.3  # [s] without a whole frame in which the FPGA forgets part of one; it needs 1.0

FLAG = 0x80  # bit 7 of a phase
COLOUR, DIVIDER = (
    1,
    26,
)  # where its bits begin, the lowest first; the byte behind them says to take it
CENTRE = ((DUTY - np.arange(DUTY + 1)) // 2).astype(np.uint16)
"""By how much later a pulse begins the shorter it is, so that its middle stays."""


def encode_divider(rate: float) -> int:
    """What of 40 kHz plays a little faster than `rate` [Hz], so that frames do not pile up."""
    return min(max(math.ceil(CARRIER / rate) - 1, 1), SLOWEST)


def encode_off(divide: int, led: Sequence[int]) -> array[int]:
    """What silences a board, whatever it has got before: three frames of bytes.

    Of what has been cut, the zeros before are the rest; behind it they are nothing, but push it out of the FIFO, which
    gives away 512 bytes at a time. Sets the divider, and the light: red, green, blue, 0 to 255.
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
    """Frames of an array to the bytes of each of its boards, in buffers that are reused."""

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
        """K frames for each board. phase, amplitude: levels of the whole array, (K, N), in range."""
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
        begin = (CENTRE.take(a) - p) & (PHASES - 1)  # the board counts lags, and levels are leads
        begin, a = begin.reshape(K, B, BOARD), a.reshape(K, B, BOARD)
        for b, view in enumerate(views):
            view[:, 0], view[:, 1] = begin[:, b], a[:, b]
            view[:, 0, 0] |= FLAG
        return buffers
