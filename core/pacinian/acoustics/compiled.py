"""Compile a kernel with Numba, say so once, and keep the result on disk for later starts."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numba

if TYPE_CHECKING:
    from collections.abc import Callable

F = TypeVar("F", bound="Callable[..., Any]")

# What the compiler may assume: sums may be reordered, and numbers are finite unless a kernel says otherwise.
FAST = {"nsz", "arcp", "contract", "afn", "reassoc"}
FINITE = {"nnan", "ninf"}
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
        try:
            kernel = numba.njit(list(signatures), cache=True, **options)(function)
        except RuntimeError:  # no folder for the cache can be written: compile at every start
            kernel = numba.njit(list(signatures), **options)(function)
        _announce(kernel)
        return cast("F", kernel)

    return decorate


def _announce(kernel: Any) -> None:
    global announced  # noqa: PLW0603
    if announced or kernel.stats.cache_hits:
        return
    announced = True
    logging.getLogger("pacinian").warning(
        "compiling numerical kernels for this machine: once after an installation, up to half a minute"
    )
