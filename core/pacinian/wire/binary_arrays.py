"""Bulk numbers: little-endian float32 or uint32 in a `bin`, checked without copying."""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from pacinian.types import ArrayLike, Singles


MIN_VECTORISED = 14  # numbers; a plain loop checks up to this many faster than NumPy


class Rows(NamedTuple):
    """Rule that a field holds rows of `width` float32 in low..high.

    counts: allowed numbers of rows; by default any. each: name of a field that has one item per row. empty: whether
    the field may be empty. low: None if any number is allowed, also NaN.
    """

    name: str
    width: int
    counts: tuple[int, ...] = ()
    each: str = ""
    empty: bool = False
    low: float | None = -10.0
    high: float = 10.0

    def check(self, message: Any) -> None:
        """Check the field of a message. Raises ValueError, as msgspec requires."""
        data: bytes = getattr(message, self.name)
        counts = (len(getattr(message, self.each)),) if self.each else self.counts
        if data or not self.empty:
            _check_rows(self.name, data, self.width, counts)
            _check_range(self.name, data, self.low, self.high)


class Grid(NamedTuple):
    """Rule that a field holds float32 in low..high, as many as the message's `grid` gives; its last side is a row."""

    name: str
    low: float
    high: float

    def check(self, message: Any) -> None:
        """Check the field of a message. Raises ValueError."""
        data: bytes = getattr(message, self.name)
        *sides, width = message.grid
        _check_rows(self.name, data, width, (math.prod(sides),))
        _check_range(self.name, data, self.low, self.high)


class Indices(NamedTuple):
    """Rule that a field holds rows of three uint32, which are indices into the (V, 3) float32 of the field `into`."""

    name: str
    into: str

    def check(self, message: Any) -> None:
        """Check the field of a message. Raises ValueError."""
        data: bytes = getattr(message, self.name)
        below = len(getattr(message, self.into)) // 12
        if len(data) % 12:
            raise ValueError(f"`{self.name}` must be rows of 3 uint32, not {len(data)} bytes")
        if data and np.frombuffer(data, "<u4").max() >= below:
            raise ValueError(f"`{self.name}` must be indices of the {below} that there are")


def check_arrays(message: Any) -> None:
    """Check a message against the rules in `BULK` of its class. Raises ValueError."""
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
    """Return float32 bytes as rows, shape (K, width), read-only."""
    return np.frombuffer(data, "<f4").reshape(-1, width)


def pack(values: ArrayLike) -> bytes:
    """Return numbers as float32 bytes. Numbers too large for float32 become infinite."""
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(values, dtype="<f4").tobytes()


def unpack_indices(data: bytes, width: int) -> NDArray[np.uint32]:
    """Return uint32 bytes as rows, shape (K, width), read-only."""
    return np.frombuffer(data, "<u4").reshape(-1, width)


def pack_indices(values: ArrayLike) -> bytes:
    """Return integers as uint32 bytes."""
    return np.ascontiguousarray(values, dtype="<u4").tobytes()
