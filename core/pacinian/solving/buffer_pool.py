"""A pool of workspaces, so that repeated solves do not allocate."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, TypeVar, cast

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable

MAX_BUFFERS = 8  # largest number of workspaces that are kept
# Largest M N of a workspace that is kept; for larger problems, allocation takes a negligible time.
MAX_BUFFER_SIZE = 1_000_000

T = TypeVar("T")

_free: OrderedDict[Hashable, object] = OrderedDict()


def acquire(key: Hashable, make: Callable[[], T]) -> T:
    """Return a workspace for `key`: a released one, or a new one. It is the caller's until `release`."""
    room = _free.pop(key, None)
    return make() if room is None else cast("T", room)


def release(key: Hashable, room: object, size: int = 0) -> None:
    """Return a workspace of size M N to the pool, for the next `acquire` with this key; thread-safe."""
    if size > MAX_BUFFER_SIZE:
        return
    _free[key] = room
    while len(_free) > MAX_BUFFERS:
        try:
            _free.popitem(last=False)
        except KeyError:  # another thread emptied the pool
            break
