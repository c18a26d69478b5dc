"""Limit BLAS to one thread for small problems, where threads lose milliseconds waiting for each other."""

from __future__ import annotations

import functools
import threading
from contextlib import nullcontext
from importlib import import_module
from typing import TYPE_CHECKING, Any

from threadpoolctl import ThreadpoolController

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

# Number of elements of B below which BLAS does not start a second thread by itself.
MIN_ELEMENTS = 4_096
MAX_ELEMENTS = 1_000_000  # number of elements of B from which several threads are faster


def limit_blas_threads(elements: int = MIN_ELEMENTS) -> AbstractContextManager[object]:
    """Limit BLAS to one thread, if B has `MIN_ELEMENTS` to `MAX_ELEMENTS` elements. Costs 25 us, or nothing if nested.

    The limit applies to the whole process. The last context to exit restores the previous number of threads.
    """
    return ONE if MIN_ELEMENTS <= elements < MAX_ELEMENTS else NOTHING


class _One:
    """A context, shared by all threads, that limits BLAS while at least one thread is inside."""

    def __init__(self) -> None:
        self._inside = 0
        self._lock = threading.Lock()
        self._limiter: Any = None

    def __enter__(self) -> None:
        with self._lock:
            if not self._inside:
                self._limiter = _controller().limit(limits=1)
            self._inside += 1

    def __exit__(self, *error: object) -> None:
        with self._lock:
            self._inside -= 1
            if not self._inside:
                self._limiter.restore_original_limits()


NOTHING, ONE = nullcontext(), _One()


@functools.cache
def _controller() -> ThreadpoolController:
    """Find the BLAS libraries, once, because that takes milliseconds; imports those that solvers use first."""
    import_module("pacinian.solving.linalg")
    return ThreadpoolController()
