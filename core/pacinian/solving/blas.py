"""One thread of linear algebra for small problems: more of them cost milliseconds of waiting for each other."""

from __future__ import annotations

import functools
from contextlib import AbstractContextManager, contextmanager, nullcontext
from importlib import import_module
from typing import TYPE_CHECKING

from threadpoolctl import ThreadpoolController

if TYPE_CHECKING:
    from collections.abc import Generator

FEW = 4_096  # elements of B up to which BLAS does not think of a second thread
MANY = 1_000_000  # from which several threads are worth their while

_NOTHING = nullcontext()
_inside = 0


def one_thread(elements: int = FEW) -> AbstractContextManager[None]:
    """Keep BLAS to one thread for `FEW` to `MANY` elements of B; costs 25 us, nested nothing."""
    return _NOTHING if _inside or not FEW <= elements < MANY else _limited()


@contextmanager
def _limited() -> Generator[None]:
    global _inside  # noqa: PLW0603
    _inside += 1
    try:
        with _controller().limit(limits=1):
            yield
    finally:
        _inside -= 1


@functools.cache
def _controller() -> ThreadpoolController:
    """Finding the libraries takes milliseconds, so once: all that solvers use are loaded by then."""
    import_module("scipy.linalg.lapack")
    return ThreadpoolController()
