"""What keeps the loop from being held up by its own process."""

from __future__ import annotations

import gc
from contextlib import contextmanager
from typing import TYPE_CHECKING

from pacinian.solving.blas import one_thread

if TYPE_CHECKING:
    from collections.abc import Generator


@contextmanager
def realtime_section() -> Generator[None]:
    """One thread of linear algebra, and nothing old to search for garbage: both cost milliseconds."""
    gc.collect()
    gc.freeze()
    try:
        with one_thread():
            yield
    finally:
        gc.unfreeze()
