"""The SonicSurface wire protocol; see docs/sonicsurface.md."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pacinian as pc
    from pacinian.types import Levels

BOARD, PHASES = 256, 32  # transducers per board; phase levels per turn
BAUD = 230_400
BYTE = 10.0 / BAUD  # duration of a byte [s]: 8 bits, start and stop

OFF = 0x20  # sent in place of a phase to switch a transducer off
CLOCKS = 0x97  # switches the clocks on, in case a stray 0x96 switched them off
START, SWAP = 0xFE, 0xFD
SELECT = 0xC0, 0xC1  # commands that select the first and the second of two boards


def frame_message(pattern: bytes, select: Sequence[int]) -> bytes:
    """Encode a pattern for the back buffer, then a swap. pattern: 256 bytes for each board."""
    if len(pattern) == BOARD:
        return bytes([START, *pattern, SWAP])
    made = bytearray()
    for b, chosen in enumerate(select):
        made += bytes([chosen, START]) + pattern[BOARD * b :][:BOARD]
    return bytes(made) + bytes([SWAP])


class Packer:
    """Converts rows of an array to the patterns of its boards."""

    def __init__(self, wirings: Sequence[pc.Wiring]) -> None:
        self._pattern = np.full(BOARD * len(wirings), OFF, np.uint8)
        self._channels = np.concatenate([BOARD * b + w.channels for b, w in enumerate(wirings)])
        self._indices = np.concatenate([wiring.indices for wiring in wirings])

    def pack(self, phase: Levels, amplitude: Levels) -> bytes:
        """Return the pattern of a row. phase, amplitude: levels of the whole array, (N,), in range."""
        lag = -phase & (PHASES - 1)  # the board counts phase lags, levels are phase leads
        row = np.where(amplitude, lag, OFF)
        self._pattern[self._channels] = row[self._indices]
        return self._pattern.tobytes()
