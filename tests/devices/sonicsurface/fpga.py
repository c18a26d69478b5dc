"""What a SonicSurface does with its bytes, as its VHDL says: commands, two buffers, pulses."""

from __future__ import annotations

import math

import numpy as np

TICKS = 32  # of a period
COUNTER = 256  # the highest that the byte counter may have


class Board:
    """A board, switched on: both of its buffers hold phase 0, so it sounds. secondary: which of the two builds."""

    def __init__(self, secondary: bool = False) -> None:
        self.heard, self.held = np.zeros(256, int), np.zeros(256, int)
        self.clocks = True
        self.swaps = 0
        self._mine = 0xC1 if secondary else 0xC0
        self._listens, self._at = True, 0

    def take(self, data: bytes) -> None:
        """Bytes from the line."""
        for byte in data:
            if byte == 0xFE and self._listens:
                self._at = 0
            elif byte == 0xFD:
                self.heard, self.held = self.held, self.heard
                self._at = 0
                self.swaps += 1
            elif byte in (0x96, 0x97):
                self.clocks = byte == 0x97
            elif byte in (0xC0, 0xC1):
                self._listens = byte == self._mine
            elif self._listens:
                assert self._at <= COUNTER
                self.held[self._at % 256] = byte if byte == 32 else byte & 31
                self._at += 1

    def pulses(self) -> np.ndarray:
        """What each transducer is driven with now, in the ticks of a period, (256, 32)."""
        since = (np.arange(TICKS) - 1 - self.heard[:, None]) % TICKS  # a tick after the match
        return np.asarray((self.heard < 32)[:, None] & (since < 16) & self.clocks)

    def gains(self) -> np.ndarray:
        """The sound of it, (256,): exp(j w t), 1 for half a period about tick 8.5, where phase 0 has its middle."""
        lag = np.exp(-2j * np.pi * (np.arange(TICKS) - 8.5) / TICKS)
        return np.asarray(self.pulses() @ lag * math.sin(math.pi / TICKS))
