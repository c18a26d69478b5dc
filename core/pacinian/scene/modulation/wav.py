"""WAV files, read by SciPy."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.types import Singles

MAX_BYTES = 64 << 20  # largest WAV file [bytes]


def read_wav(file: str) -> tuple[float, Singles]:
    """Read the rate of a WAV file [Hz], and the mean of its channels, (L,), -1..1 at full scale.

    file: path of a file of integers of up to 64 bits, or floats. Raises ArgumentError if it is not a WAV file, is cut
    short, is empty, or is larger than 64 MiB.
    """
    from scipy.io import wavfile

    try:
        content = _content(Path(file))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", wavfile.WavFileWarning)  # unknown chunks
            warnings.filterwarnings("error", "Reached EOF", wavfile.WavFileWarning)
            rate, data = wavfile.read(io.BytesIO(content))
    except ArgumentError:
        raise
    except Exception as error:
        raise ArgumentError("wave", f"{file} cannot be read as a WAV file: {error}") from error
    if not len(data):
        raise ArgumentError("wave", f"{file} holds no samples")
    x = _convert_samples(data).reshape(len(data), -1).mean(axis=1)
    if not np.isfinite(x).all():
        raise ArgumentError("wave", f"{file} has values that are not finite")
    return float(rate), x


def _content(path: Path) -> bytes:
    if not path.is_file():
        raise ArgumentError("wave", f"{path} is not there, or not a file")
    with path.open("rb") as file:
        content = file.read(MAX_BYTES + 1)
    if len(content) > MAX_BYTES:
        raise ArgumentError("wave", f"{path} is larger than {MAX_BYTES >> 20} MiB")
    return content


def _convert_samples(data: Any) -> Singles:
    """Convert samples of any type to floats, -1..1 at full scale."""
    x = np.asarray(data, dtype=np.float32)
    if data.dtype.kind == "u":  # 8 bits: silence is 128
        return (x - np.float32(128.0)) / np.float32(128.0)
    if data.dtype.kind == "i":
        return x / np.float32(2.0 ** (8 * data.dtype.itemsize - 1))
    return x
