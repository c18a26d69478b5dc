"""Serial adapters with a board behind them: a real pseudo-terminal, and one in memory that fails when told."""

from __future__ import annotations

import os
import threading
import tty
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import serial

import pacinian as pc

from .fpga import Board

if TYPE_CHECKING:
    from collections.abc import Callable

ARRAY = pc.lattice(0.16, 0.16, 0.0105)
NAME = "/dev/ttyUSB7"


class Terminal:
    """A pseudo-terminal; what is written to `name` reaches the board when it is pumped."""

    def __init__(self) -> None:
        self.board = Board()
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.name = os.ttyname(self._slave)
        self.there = True

    def pump(self) -> bytes:
        """Let the board have what has been written."""
        got = b""
        with suppress(BlockingIOError, OSError):
            while self.there:
                got += os.read(self._master, 4096)
        self.board.take(got)
        return got

    def unplug(self) -> None:
        if self.there:
            self.pump()
            self.there = False
            os.close(self._master)

    def close(self) -> None:
        self.unplug()
        os.close(self._slave)


class Port:
    """In place of `serial.Serial`; as one of Linux, whose writes are taken by the system and sent later.

    hangs: nothing is sent. gone: unplugged. full: the system takes nothing.
    """

    def __init__(self, name: str, *rest: Any, **settings: Any) -> None:
        self.port, self.board = name, Board()
        self.hangs = self.gone = self.full = self.closed = False
        self.held = b""
        self.writes: list[bytes] = []
        self._lock = threading.Lock()

    @property
    def out_waiting(self) -> int:
        if self.gone:
            raise OSError(5, "Input/output error")
        with self._lock:
            if not self.hangs:
                self.board.take(self.held)
                self.held = b""
            return len(self.held)

    def write(self, data: bytes) -> int:
        if self.gone:
            try:
                raise OSError(5, "Input/output error")
            except OSError as error:
                raise serial.SerialException(f"write failed: {error}")  # noqa: B904  as pyserial
        if self.full:
            raise serial.SerialTimeoutException("Write timeout")
        with self._lock:
            self.writes.append(bytes(data))
            self.held += bytes(data)
        return len(data)

    def reset_output_buffer(self) -> None:
        if self.gone:
            raise OSError(5, "Input/output error")
        with self._lock:
            self.held = b""

    def close(self) -> None:
        self.closed = True


def frame(level: int = 1, phase: int = 0, rows: int = 1) -> pc.Frame:
    shape = rows, 256
    return pc.Frame(0, 0.0, np.full(shape, phase, np.uint16), np.full(shape, level, np.uint16))


def refused(act: Callable[[], object], message: str) -> None:
    with pytest.raises(pc.BackendError) as caught:
        act()
    assert str(caught.value) == message
