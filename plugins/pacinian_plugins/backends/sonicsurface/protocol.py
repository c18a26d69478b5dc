"""The wire of SonicSurface, as bytes: see docs/sonicsurface.md."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pacinian as pc
    from pacinian.types import Levels

BOARD, PHASES = 256, 32  # transducers of a board, levels in a turn
BAUD = 230_400
BYTE = 10.0 / BAUD  # [s]: 8 bits, start and stop

OFF = 0x20  # in place of a phase
CLOCKS = 0x97  # on, after a stray 0x96
START, SWAP = 0xFE, 0xFD
SELECT = 0xC0, 0xC1  # by which the first and the second of two boards listen


def frame_message(pattern: bytes, select: Sequence[int]) -> bytes:
    """What puts a pattern into the buffer that is not heard, and swaps. pattern: 256 bytes for each board."""
    if len(pattern) == BOARD:
        return bytes([START, *pattern, SWAP])
    made = bytearray()
    for b, chosen in enumerate(select):
        made += bytes([chosen, START]) + pattern[BOARD * b :][:BOARD]
    return bytes(made) + bytes([SWAP])


class Packer:
    """Rows of an array to the patterns of its boards."""

    def __init__(self, wirings: Sequence[pc.Wiring]) -> None:
        self._pattern = np.full(BOARD * len(wirings), OFF, np.uint8)
        self._channels = np.concatenate([BOARD * b + w.channels for b, w in enumerate(wirings)])
        self._indices = np.concatenate([wiring.indices for wiring in wirings])

    def pack(self, phase: Levels, amplitude: Levels) -> bytes:
        """The pattern of a row. phase, amplitude: levels of the whole array, (N,), in range."""
        lag = -phase & (PHASES - 1)  # the board counts lags, and levels are leads
        row = np.where(amplitude, lag, OFF)
        self._pattern[self._channels] = row[self._indices]
        return self._pattern.tobytes()
