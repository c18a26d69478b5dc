"""Keep the process itself from delaying the render loop."""

from __future__ import annotations

import gc
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

from pacinian.solving.blas import limit_blas_threads

if TYPE_CHECKING:
    from collections.abc import Generator


SWITCH_INTERVAL = 1e-4  # time for which another thread may keep the interpreter [s]


@contextmanager
def realtime_section() -> Generator[None]:
    """Limit BLAS to one thread, freeze the garbage collector's old objects, and let threads take turns often.

    Each of these would otherwise cost milliseconds.
    """
    gc.collect()
    gc.freeze()
    before = sys.getswitchinterval()
    sys.setswitchinterval(min(before, SWITCH_INTERVAL))
    try:
        with limit_blas_threads():
            yield
    finally:
        sys.setswitchinterval(before)
        gc.unfreeze()
