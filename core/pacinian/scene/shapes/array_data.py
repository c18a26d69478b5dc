"""Arrays in scenes, given as numbers or read from a file.

A scene keeps them as the bytes of a .npy file, so that they compare and serialise like any other field.
"""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.argument_checks import check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.types import ArrayLike

    Array = np.ndarray[Any, np.dtype[Any]]

MAX_NUMBERS = 100_000_000  # largest number of elements in an array, and of pixels in a picture


def encode_array(name: str, values: ArrayLike | None, file: str, dimension: int) -> bytes | None:
    """Encode numbers as the bytes of a .npy file. Returns None if they are in `file`. Raises ArgumentError."""
    if (values is None) == (not file):
        raise ArgumentError(name, "or `file` must be given, and not both")
    if values is None:
        return None
    try:
        array = _array(values) if isinstance(values, bytes) else np.asarray(values)
    except Exception as error:
        raise ArgumentError(name, f"must be numbers on a grid: {error}") from error
    out = BytesIO()
    np.lib.format.write_array(out, _check_array(name, array, dimension), allow_pickle=False)
    return out.getvalue()


def decode_array(name: str, values: ArrayLike | None, file: str, dimension: int) -> Array:
    """Decode an array from the bytes that `encode_array` made, or read it from `file`. Raises ArgumentError."""
    try:
        return _check_array(name, _read(file), dimension) if file else _array(values)
    except Exception as error:
        problem = str(error).removeprefix(f"`{name}` ")
        raise ArgumentError(name, f"of {file} do not load: {problem}") from error


def check_within(name: str, array: Array) -> None:
    """Raise ArgumentError unless all numbers are in 0..1."""
    low, high = float(array.min()), float(array.max())
    if low < 0.0 or high > 1.0:
        raise ArgumentError(name, f"must be from 0 to 1, not from {low:g} to {high:g}")


def _array(values: Any) -> Array:
    return np.lib.format.read_array(BytesIO(values), allow_pickle=False)


def _check_array(name: str, array: Array, dimension: int) -> Array:
    """Return a copy in memory, after checking that it has at most `MAX_NUMBERS` real and finite numbers."""
    if array.ndim != dimension or not array.size:
        raise ArgumentError(name, f"must have {dimension} dimensions, not shape {array.shape}")
    if array.size > MAX_NUMBERS:
        raise ArgumentError(name, f"are {array.size:,} numbers: keep to {MAX_NUMBERS:,}")
    real = check_numbers(name, array, (None,) * dimension)
    return np.array(array if array.dtype.kind in "biuf" else real, order="C")


def _read(file: str) -> Array:
    """Read a .npy file, or a picture as the brightness of its pixels, 0..1, (rows, columns).

    Raises ValueError for anything but a file: to open a pipe would wait for a writer.
    """
    if not Path(file).is_file():
        raise ValueError("it is not there, or not a file")
    if file.endswith(".npy"):
        return np.lib.format.open_memmap(file, mode="r")
    from PIL import Image

    with Image.open(file) as image:
        if image.width * image.height > MAX_NUMBERS:
            raise ValueError(f"{image.width} x {image.height} pixels are too many")
        if image.mode.startswith("I"):  # 16 bits
            return np.asarray(image, dtype=np.float64) / 65535.0
        return np.asarray(image.convert("L"), dtype=np.float64) / 255.0
