"""Compile a kernel with Numba, say so once, and keep the result on disk for later starts."""

from __future__ import annotations

import logging
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numba
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

F = TypeVar("F", bound="Callable[..., Any]")

# What the compiler may assume: sums may be reordered, and numbers are finite unless a kernel says otherwise.
FAST = {"nsz", "arcp", "contract", "afn", "reassoc"}
FINITE = {"nnan", "ninf"}
helpers: dict[bool, dict[Any, Any]] = {True: {}, False: {}}  # compiled: powers, complex products
announced = False


def compiled(*signatures: Any, finite: bool = True) -> Callable[[F], F]:
    """Compile a kernel for `signatures`; inside it the interpreter lock is released.

    finite: whether its numbers always are, so that it may be compiled without regard to NaN.
    """

    def decorate(function: F) -> F:
        options: dict[str, Any] = {
            "fastmath": FAST | FINITE if finite else FAST,
            "nogil": True,
            "error_model": "numpy",
        }
        with _helped(finite):
            try:
                kernel = numba.njit(list(signatures), cache=True, **options)(function)
            except RuntimeError:  # no folder for the cache can be written: compile at every start
                kernel = numba.njit(list(signatures), **options)(function)
        _announce(kernel)
        return cast("F", kernel)

    return decorate


@contextmanager
def _helped(finite: bool) -> Generator[None]:
    """With helpers of such kernels alone: Numba compiles each once, by what the first kernel may assume."""
    context: Any = cpu_target.target_context
    with global_compiler_lock:
        others, context.cached_internal_func = context.cached_internal_func, helpers[finite]
        try:
            yield
        finally:
            context.cached_internal_func = others


def _announce(kernel: Any) -> None:
    global announced  # noqa: PLW0603
    if announced or kernel.stats.cache_hits:
        return
    announced = True
    logging.getLogger("pacinian").warning(
        "compiling numerical kernels for this machine: once after an installation, up to half a minute"
    )
