"""The field in planes and boxes, by `pacinian.field`, in a process of its own that gives way to all others."""

from __future__ import annotations

import asyncio
import functools
import multiprocessing
import os
import pickle
import signal
import sys
import threading
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pacinian.errors import ArgumentError
from pacinian.viewing.messages import Slice

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import Floats
    from pacinian.viewing.hub import Drive
    from pacinian.viewing.messages import Volume

PAIRS = 5e7  # of points and transducers, worked off in one go: 0.1 s of a processor
CALM = 19  # nice
AUTOGROUP = Path("/proc/self/autogroup")  # of Linux, where it groups by session


def points(asked: Slice | Volume) -> Floats:
    """Where the field is asked for, (K, 3) [m], in the order of the answer."""
    if isinstance(asked, Slice):
        rows, columns = asked.shape
        x = ((np.arange(columns) + 0.5) / columns - 0.5) * asked.size[0]
        y = ((np.arange(rows) + 0.5) / rows - 0.5) * asked.size[1]
        plane = y[:, None, None] * np.array(asked.v) + x[:, None] * np.array(asked.u)
        return np.asarray(plane + np.array(asked.centre)).reshape(-1, 3)
    grid = np.moveaxis(np.indices(asked.shape, dtype=np.float64), 0, -1)
    return np.asarray(grid * asked.spacing + np.array(asked.origin)).reshape(-1, 3)


class Fields:
    """Computes for all pages, a part of each in turn."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None

    async def pressure(
        self, asked: Slice | Volume, drive: Drive, wanted: Callable[[], bool]
    ) -> bytes | None:
        """Radiation pressure, float32 [Pa], in the order of the answer; None once it is not `wanted` any more.

        NaN on a transducer. Raises ArgumentError.
        """
        at = points(asked)
        if not drive.gains:
            return bytes(4 * len(at))
        step = max(256, int(PAIRS / len(drive.model.array)))
        made: list[bytes] = []
        for begin in range(0, len(at), step):
            if not wanted():
                return None
            made.append(await self._part(drive, at[begin : begin + step]))
        return b"".join(made)

    async def _part(self, drive: Drive, at: Floats) -> bytes:
        """In the other process; a new one, if it was killed."""
        loop = asyncio.get_running_loop()
        for _ in range(2):
            if self._pool is None:
                context = multiprocessing.get_context("spawn")
                self._pool = ProcessPoolExecutor(1, context, initializer=calm, initargs=(CALM,))
            pool, work = self._pool, (drive.model.packed, drive.gains, at)
            try:
                return await loop.run_in_executor(pool, pressure, *work)
            except BrokenProcessPool:
                if pool is self._pool:
                    self.close()
        raise ArgumentError("slice", "cannot be computed: the process that does was killed twice")

    def close(self) -> None:
        """End the process."""
        if self._pool is not None:
            self._pool.shutdown(wait=False, cancel_futures=True)
            self._pool = None


def pressure(model: bytes, gains: bytes, at: Floats) -> bytes:
    """Radiation pressure at points (K, 3) [m], float32 [Pa]; NaN on a transducer. Raises ArgumentError."""
    from pacinian.acoustics.pressure import radiation_pressure
    from pacinian.acoustics.propagation import field
    from pacinian.errors import PointOnTransducer

    array, medium = _unpacked(model)
    g = np.frombuffer(gains, np.complex64)
    found = np.full(len(at), np.nan, np.float32)
    here = np.ones(len(at), np.bool_)
    try:
        p = field(array, g, at, medium)
    except PointOnTransducer as error:
        here[list(error.indices)] = False
        p = field(array, g, at[here], medium)
    found[here] = radiation_pressure(p, medium)
    return found.tobytes()


@functools.lru_cache(maxsize=2)
def _unpacked(model: bytes) -> tuple[Array, Air]:
    made: tuple[Array, Air] = pickle.loads(model)  # of our own
    return made


def calm(nice: int) -> None:
    """Give way to all others, and end with the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's
    if sys.platform != "win32":
        with suppress(OSError):
            os.setsid()
        os.nice(nice)
    if sys.platform == "linux":
        with suppress(OSError):
            AUTOGROUP.write_text(str(nice))
    threading.Thread(target=_with_parent, daemon=True).start()


def _with_parent() -> None:
    if (parent := multiprocessing.parent_process()) is not None:
        parent.join()
        os._exit(0)
