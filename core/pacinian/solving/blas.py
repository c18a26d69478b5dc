"""One thread of linear algebra for small problems: more of them cost milliseconds of waiting for each other."""

from __future__ import annotations

import functools
import threading
from contextlib import nullcontext
from importlib import import_module
from typing import TYPE_CHECKING, Any

from threadpoolctl import ThreadpoolController

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

MIN_ELEMENTS = 4_096  # elements of B up to which BLAS does not think of a second thread
MAX_ELEMENTS = 1_000_000  # from which several threads are worth their while


def one_thread(elements: int = MIN_ELEMENTS) -> AbstractContextManager[object]:
    """Keep BLAS to one thread for `MIN_ELEMENTS` to `MAX_ELEMENTS` elements of B; costs 25 us, nested nothing.

    The threads are the process's: what there was comes back when the last that asked is done.
    """
    return ONE if MIN_ELEMENTS <= elements < MAX_ELEMENTS else NOTHING


class _One:
    """Limits while anyone is inside, from any thread."""

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
    """Finding the libraries takes milliseconds, so once: all that solvers use are loaded by then."""
    import_module("scipy.linalg.lapack")
    return ThreadpoolController()
