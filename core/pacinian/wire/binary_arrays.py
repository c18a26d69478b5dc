"""Bulk numbers: little-endian float32 or uint32 in a `bin`, checked without a copy."""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from pacinian.types import ArrayLike, Singles


MIN_VECTORISED = 14  # numbers: so many are sooner checked one by one than all at once


class Rows(NamedTuple):
    """That a field is rows of `width` float32 in low..high.

    counts: of rows: one of these, any unless given. each: a field for each of whose items there is a row. empty: no
    data will do, too. low: None for any numbers, NaN too.
    """

    name: str
    width: int
    counts: tuple[int, ...] = ()
    each: str = ""
    empty: bool = False
    low: float | None = -10.0
    high: float = 10.0

    def check(self, message: Any) -> None:
        """Refuse a message whose field is anything else. Raises ValueError, as msgspec wants it."""
        data: bytes = getattr(message, self.name)
        counts = (len(getattr(message, self.each)),) if self.each else self.counts
        if data or not self.empty:
            _check_rows(self.name, data, self.width, counts)
            _check_range(self.name, data, self.low, self.high)


class Grid(NamedTuple):
    """That a field is float32 in low..high, as many as the message's `grid` says; its last side is of a row."""

    name: str
    low: float
    high: float

    def check(self, message: Any) -> None:
        """Refuse a message whose field is anything else. Raises ValueError."""
        data: bytes = getattr(message, self.name)
        *sides, width = message.grid
        _check_rows(self.name, data, width, (math.prod(sides),))
        _check_range(self.name, data, self.low, self.high)


class Indices(NamedTuple):
    """That a field is rows of three uint32 that count the (V, 3) float32 of the field `into`."""

    name: str
    into: str

    def check(self, message: Any) -> None:
        """Refuse a message whose field is anything else. Raises ValueError."""
        data: bytes = getattr(message, self.name)
        below = len(getattr(message, self.into)) // 12
        if len(data) % 12:
            raise ValueError(f"`{self.name}` must be rows of 3 uint32, not {len(data)} bytes")
        if data and np.frombuffer(data, "<u4").max() >= below:
            raise ValueError(f"`{self.name}` must be indices of the {below} that there are")


def check_arrays(message: Any) -> None:
    """Refuse a message that breaks one of these rules, which its class has as `BULK`. Raises ValueError."""
    for rule in message.BULK:
        rule.check(message)


def _check_rows(name: str, data: bytes, width: int, counts: tuple[int, ...]) -> None:
    if len(data) % (4 * width) or (counts and len(data) // (4 * width) not in counts):
        wanted = f"{counts[0]} rows" if counts else "rows"
        raise ValueError(f"`{name}` must be {wanted} of {width} float32, not {len(data)} bytes")


def _check_range(name: str, data: bytes, low: float | None, high: float) -> None:
    if low is None or not data:
        return
    if len(data) <= 4 * MIN_VECTORISED:
        inside = all(low <= x <= high for x in struct.unpack(f"<{len(data) // 4}f", data))
    else:
        values = np.frombuffer(data, "<f4")
        inside = bool(values.min() >= low and values.max() <= high)
    if not inside:
        raise ValueError(f"`{name}` must be from {low:g} to {high:g}, without NaN")


def unpack(data: bytes, width: int) -> Singles:
    """The rows, (K, width), read-only."""
    return np.frombuffer(data, "<f4").reshape(-1, width)


def pack(values: ArrayLike) -> bytes:
    """Numbers as float32 bytes; those that are too large for it become infinite."""
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(values, dtype="<f4").tobytes()


def unpack_indices(data: bytes, width: int) -> NDArray[np.uint32]:
    """The rows, (K, width), read-only."""
    return np.frombuffer(data, "<u4").reshape(-1, width)


def pack_indices(values: ArrayLike) -> bytes:
    """Whole numbers as uint32 bytes."""
    return np.ascontiguousarray(values, dtype="<u4").tobytes()
