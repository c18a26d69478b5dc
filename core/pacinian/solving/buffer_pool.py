"""Space to work in, used again: none is allocated from one solve to the next."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, TypeVar, cast

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable

MAX_BUFFERS = 8  # rooms kept
MAX_BUFFER_SIZE = 1_000_000  # M N of those that are: to make larger ones takes no time that counts

T = TypeVar("T")

_free: OrderedDict[Hashable, object] = OrderedDict()


def acquire(key: Hashable, make: Callable[[], T]) -> T:
    """A room for `key`, maybe used before, else made; it is the caller's until given back."""
    room = _free.pop(key, None)
    return make() if room is None else cast("T", room)


def release(key: Hashable, room: object, size: int = 0) -> None:
    """Give a room of size M N back, for the next that takes one for that key; from any thread."""
    if size > MAX_BUFFER_SIZE:
        return
    _free[key] = room
    while len(_free) > MAX_BUFFERS:
        try:
            _free.popitem(last=False)
        except KeyError:  # another thread was quicker
            break
