"""One board: its frames, and how they are found again after one was cut."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TYPE_CHECKING

import pacinian as pc
from pacinian_plugins.backends.openmpd.protocol import CARRIER, FRAME, PAUSE, encode_off

if TYPE_CHECKING:
    from array import array
    from collections.abc import Callable, Sequence

    from pacinian.devices.usb_link import UsbLink

DARK = (0, 0, 0)


class Board:
    """A board behind a chip, which is closed with it.

    divide: of 40 kHz, for the frames that it plays. led: its light while it is open. timeout: for which it may
    take nothing [s]. clock: [s].
    """

    def __init__(
        self,
        link: UsbLink,
        divide: int,
        led: Sequence[int],
        timeout: float,
        clock: Callable[[], float],
    ) -> None:
        self.link, self.name = link, link.name
        self._divide, self._timeout, self._clock = divide, timeout, clock
        self._off = encode_off(divide, led)
        self._ready = -math.inf  # [s] when it is sure where frames begin

    def send(self, frames: array[int]) -> None:
        """Play frames. Raises BackendError; nothing is repeated."""
        if (left := self._ready - self._clock()) > 0.0:
            raise pc.BackendError(
                f"{self.name}: a frame was cut: it takes {left:.1f} s until the board has forgotten it"
            )
        self._write(frames)

    def silence(self) -> None:
        """Silence, whatever it has got before. Raises BackendError: then it goes on playing."""
        cut = self._clock() < self._ready
        if cut:
            with suppress(pc.BackendError):  # the next line tells
                self.link.mend()
        self._write(self._off)
        if cut:
            self.settle()

    def settle(self) -> None:
        """Take no frame until it is sure where the next one begins."""
        self._ready = self._clock() + PAUSE

    def close(self) -> None:
        """Silence it, switch its light off, and give it back. Never raises."""
        self._off = encode_off(self._divide, DARK)
        with suppress(pc.BackendError):
            self.silence()
        self.link.close()

    def _write(self, data: array[int]) -> None:
        queue = len(data) / FRAME * self._divide / CARRIER  # [s] until a full FIFO has room
        try:
            self.link.write(data, self._timeout + queue)
        except pc.BackendError:
            self.settle()
            raise
