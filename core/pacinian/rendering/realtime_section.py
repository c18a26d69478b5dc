"""Keep the process itself from delaying the render loop."""

from __future__ import annotations

import gc
from contextlib import contextmanager
from typing import TYPE_CHECKING

from pacinian.solving.blas import limit_blas_threads

if TYPE_CHECKING:
    from collections.abc import Generator


@contextmanager
def realtime_section() -> Generator[None]:
    """Limit BLAS to one thread and freeze the garbage collector's old objects, which both cost milliseconds."""
    gc.collect()
    gc.freeze()
    try:
        with limit_blas_threads():
            yield
    finally:
        gc.unfreeze()
