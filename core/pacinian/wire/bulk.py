"""Bulk numbers: little-endian float32 or uint32 in a `bin`, checked without a copy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from pacinian.types import ArrayLike, Singles


def rows(
    name: str,
    data: bytes,
    width: int,
    count: int | None,
    *,
    empty: bool = False,
    low: float | None = -10.0,
    high: float = 10.0,
) -> None:
    """Refuse data that is not `count` (None: any number of) rows of `width` float32 in low..high.

    empty: no data will do, too. low: None for any numbers, NaN too. Raises ValueError, which the decoder
    turns into one with a path.
    """
    if empty and not data:
        return
    if len(data) % (4 * width) or (count is not None and len(data) != 4 * width * count):
        wanted = "rows" if count is None else f"{count} rows"
        raise ValueError(f"`{name}` must be {wanted} of {width} float32, not {len(data)} bytes")
    if low is None or not data:
        return
    values = np.frombuffer(data, "<f4")
    if not (values.min() >= low and values.max() <= high):
        raise ValueError(f"`{name}` must be from {low:g} to {high:g}, without NaN")


def indices(name: str, data: bytes, width: int, below: int) -> None:
    """Refuse data that is not rows of `width` uint32, all less than `below`. Raises ValueError."""
    if len(data) % (4 * width):
        raise ValueError(f"`{name}` must be rows of {width} uint32, not {len(data)} bytes")
    if data and np.frombuffer(data, "<u4").max() >= below:
        raise ValueError(f"`{name}` must be indices of the {below} that there are")


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
