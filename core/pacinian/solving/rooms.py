"""Space for solvers to work in, used again: none is allocated from one solve to the next."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, TypeVar, cast

if TYPE_CHECKING:
    from collections.abc import Callable

MOST = 4  # rooms kept

T = TypeVar("T")

_free: OrderedDict[object, object] = OrderedDict()


def take(kind: Callable[[int, int], T], M: int, N: int) -> T:
    """A room made by `kind(M, N)`, maybe used before; it is the caller's until given back."""
    room = _free.pop((kind, M, N), None)
    return kind(M, N) if room is None else cast("T", room)


def give(kind: Callable[[int, int], T], M: int, N: int, room: T) -> None:
    """Give a room back, for the next that takes one of its kind and size; from any thread."""
    _free[kind, M, N] = room
    while len(_free) > MOST:
        try:
            _free.popitem(last=False)
        except KeyError:  # another thread was quicker
            break
