"""What an OpenMPD board does with its bytes, as its VHDL says: FIFO, divider, command reader, pulses."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

BLOCK = 512  # bytes that leave the FIFO at once
STOP = 28 * BLOCK  # bytes in the FIFO from which on no more are fetched
CHIP = 1024  # bytes that the FT232H keeps
FORGET = 1.0  # [s] with less than a block after which the FIFO is cleared: 5e7 clocks of 50 MHz
CARRIER = 40_000.0  # [Hz]
TICKS = 128  # of a period


class Fpga:
    """A board, switched on and silent. now: its clock [s]."""

    def __init__(self, now: Callable[[], float] = time.perf_counter) -> None:
        self._now = now
        self.divider = 4
        self.colour = 0  # 24 bits: blue, green, red
        self.phase, self.duty = np.zeros(256, int), np.zeros(256, int)
        self.played: list[float] = []  # [s]
        self._chip, self._fifo = bytearray(), bytearray()
        self._free = -math.inf  # [s] when the next block may leave
        self._full = self._low = now()  # [s] since when there is a block, or less
        self._at: int | None = None  # of a frame, None between frames
        self._frame = bytearray(BLOCK)

    def take(self, data: bytes) -> int:
        """Bytes from USB: how many there was room for."""
        self.advance()
        room = CHIP - len(self._chip) + max(0, STOP - len(self._fifo))
        if len(self._fifo) < BLOCK:
            self._full = self._now()
        self._chip += data[:room]
        self.advance()
        return min(room, len(data))

    def purge(self) -> None:
        """Forget what the chip has not given away."""
        self._chip.clear()

    @property
    def waiting(self) -> int:
        """Bytes that wait to be played."""
        self.advance()
        return len(self._chip) + len(self._fifo)

    def advance(self) -> None:
        """Until now."""
        now = self._now()
        while True:
            fetched = max(0, STOP - len(self._fifo))
            self._fifo += self._chip[:fetched]
            del self._chip[:fetched]
            if len(self._fifo) < BLOCK:
                if (seconds := math.floor((now - self._low) / FORGET)) > 0:
                    self._fifo.clear()
                    self._low += seconds * FORGET
                return
            at = max(self._free, self._full)
            if at > now:
                self._low = now
                return
            block = bytes(self._fifo[:BLOCK])
            del self._fifo[:BLOCK]
            for byte in block:
                self._read(byte, at)
            self._free, self._low = at + self.divider / CARRIER, at

    def _read(self, byte: int, at: float) -> None:
        if self._at is None:
            if not byte & 0x80:
                return
            self._at = 0
        self._frame[self._at] = byte
        if self._at == 34 and byte & 0x80:
            self.divider = self._bits(26, 8) or 256
        self._at += 1
        if self._at == BLOCK:
            self._at = None
            self.phase = np.array([b & 127 for b in self._frame[:256]])
            self.duty = np.array([b & 127 for b in self._frame[256:]])
            if self._frame[25] & 0x80:
                self.colour = self._bits(1, 24)
            self.played.append(at)

    def _bits(self, begin: int, count: int) -> int:
        return sum(self._frame[begin + k] >> 7 << k for k in range(count))

    def pulses(self) -> np.ndarray:
        """What each transducer is driven with now, in the ticks of a period, (256, 128)."""
        self.advance()
        tick, begin = np.arange(TICKS), self.phase[:, None]
        end = begin + self.duty[:, None]
        return ((tick >= begin) & (tick < end)) | ((end >= TICKS) & (tick < end - TICKS))

    def gains(self) -> np.ndarray:
        """The sound of it, (256,): exp(j w t), 1 for half a period about tick 31.5, where the host has its zero."""
        lag = np.exp(-2j * np.pi * (np.arange(TICKS) - 31.5) / TICKS)
        return np.asarray(self.pulses() @ lag * math.sin(math.pi / TICKS))
