"""Keep the process itself from delaying the render loop."""

from __future__ import annotations

import gc
import sys
import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING

from pacinian.solving.blas import limit_blas_threads

if TYPE_CHECKING:
    from collections.abc import Generator


SWITCH_INTERVAL = 1e-4  # time for which another thread may keep the interpreter [s]


class _Often:
    """A context, shared by all threads, in which threads take turns often. The last to exit restores the interval."""

    def __init__(self) -> None:
        self._inside, self._before, self._lock = 0, 0.0, threading.Lock()

    def __enter__(self) -> None:
        with self._lock:
            if not self._inside:
                self._before = sys.getswitchinterval()
                sys.setswitchinterval(min(self._before, SWITCH_INTERVAL))
            self._inside += 1

    def __exit__(self, *error: object) -> None:
        with self._lock:
            self._inside -= 1
            if not self._inside:
                sys.setswitchinterval(self._before)


_OFTEN = _Often()


@contextmanager
def realtime_section() -> Generator[None]:
    """Limit BLAS to one thread, freeze the garbage collector's old objects, and let threads take turns often.

    Each of these would otherwise cost milliseconds.
    """
    gc.collect()
    gc.freeze()
    try:
        with limit_blas_threads(), _OFTEN:
            yield
    finally:
        gc.unfreeze()
