"""One thread of linear algebra for small problems: more of them cost milliseconds of waiting for each other."""

from __future__ import annotations

import functools
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING

from threadpoolctl import ThreadpoolController

if TYPE_CHECKING:
    from collections.abc import Generator

MANY = 1_000_000  # elements of B from which several threads are worth their while

_inside = 0


@contextmanager
def one_thread(elements: int = 0) -> Generator[None]:
    """Keep BLAS to one thread while B has fewer than `MANY` elements; costs 10 us, nested nothing."""
    global _inside  # noqa: PLW0603
    if _inside or elements >= MANY:
        yield
        return
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
