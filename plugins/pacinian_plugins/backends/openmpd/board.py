"""One board: sends its frames, and resynchronises after a truncated frame."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TYPE_CHECKING

import pacinian as pc
from pacinian_plugins.backends.openmpd.protocol import CARRIER, FRAME, RESYNC_PAUSE, encode_off

if TYPE_CHECKING:
    from array import array
    from collections.abc import Callable, Sequence

    from pacinian.devices.usb_link import UsbLink

DARK = (0, 0, 0)


class Board:
    """A board behind a chip. Closing the board closes the link.

    divide: divider of 40 kHz for the frame rate. led: its light while it is open. timeout: time for which it may
    accept no data [s]. clock: [s].
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
        self._ready = -math.inf  # time when frame boundaries are known again [s]

    def send(self, frames: array[int]) -> None:
        """Play frames. Raises BackendError; never retries."""
        if (left := self._ready - self._clock()) > 0.0:
            raise pc.BackendError(
                f"{self.name}: a frame was cut: it takes {left:.1f} s until the board has forgotten it"
            )
        self._write(frames)

    def silence(self) -> None:
        """Silence the board, whatever it received before. Raises BackendError if it continues to play."""
        cut = self._clock() < self._ready
        if cut:
            with suppress(pc.BackendError):  # the next write reports the error
                self.link.clear_halt()
        self._write(self._off)
        if cut:
            self.settle()

    def settle(self) -> None:
        """Reject frames until the board has discarded an incomplete one."""
        self._ready = self._clock() + RESYNC_PAUSE

    def close(self) -> None:
        """Silence the board, switch its light off, and release it. Never raises."""
        self._off = encode_off(self._divide, DARK)
        with suppress(pc.BackendError):
            self.silence()
        self.link.close()

    def _write(self, data: array[int]) -> None:
        queue = len(data) / FRAME * self._divide / CARRIER  # time until a full FIFO has room [s]
        try:
            self.link.write(data, self._timeout + queue)
        except pc.BackendError:
            self.settle()
            raise
