"""Recorded waves as envelopes."""

from __future__ import annotations

import functools
import math
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.argument_checks import check_number, check_numbers
from pacinian.errors import ArgumentError
from pacinian.scene.modulation.wav import read_wav
from pacinian.scene.modulation.waves import EDGE, compute_gate, interpolate_table

if TYPE_CHECKING:
    from pacinian.types import Floats, Singles

MAX_DURATION = 600.0  # longest wave [s]
MAX_RATE = 1e6  # highest sample rate of a wave [Hz]
# Lowest sample rate of the table [Hz]. A device at 1, 2, 4 or 8 kHz mostly reads its values without interpolation.
MIN_TABLE_RATE = 16_000.0
FELT = 1000.0  # skin feels no higher frequencies [Hz]
SMOOTH = 0.02  # smoothing time of the mode "loudness" [s]


class Table(NamedTuple):
    """A filtered wave. values: 0..1, two more than the duration needs. rate: of the values [Hz]. duration: [s]."""

    values: Singles
    rate: float
    duration: float


class Wave(
    Struct, frozen=True, forbid_unknown_fields=True, dict=True, tag_field="type", tag="wave"
):
    """A recorded wave from a WAV file (8 to 32 bits, or float; the mean of its channels), or from samples.

    file: path; a scene file gives it relative to its own folder. samples: x in -1..1 (larger values are clipped), at
    `rate` [Hz]. loop: whether the wave repeats. Otherwise it plays once from t = 0, and the factor is 0 before and
    after, with edges of 1.5 ms.

    mode: "waveform": the radiation pressure follows the wave itself, (1 + x) / 2. This is the default, because only it
    keeps the frequencies, by which skin distinguishes waves. Silence is a steady factor of 1/2, which is hardly felt.
    "loudness": the radiation pressure follows the strength of the wave, which is |x| smoothed over 20 ms, and 1 for a
    tone at full scale. Add a vibration with a technique (AM).

    A waveform is low-pass filtered once, flat to 900 Hz and down by 60 dB from 1 kHz on. Skin feels nothing above, and
    a device at 2 kHz would alias it. Files are at most 64 MiB, and waves at most 600 s. Raises ArgumentError; for a
    file, only at its first use by `duration` or `at`.
    """

    file: str = ""
    samples: tuple[float, ...] = ()
    rate: float | None = None
    loop: bool = True
    mode: Literal["waveform", "loudness"] = "waveform"

    def __post_init__(self) -> None:
        if self.mode not in ("waveform", "loudness"):
            raise ArgumentError("mode", f'must be "waveform" or "loudness", not {self.mode!r}')
        x = check_numbers("samples", self.samples, (None,))
        force_setattr(self, "samples", tuple(x.tolist()))
        force_setattr(self, "file", str(self.file))
        if bool(self.file) == bool(len(x)):
            raise ArgumentError("wave", "needs either a file or samples, and not both")
        if bool(self.file) == (self.rate is not None):
            raise ArgumentError("rate", "is needed with samples; a file has its own")
        if self.rate is not None:
            force_setattr(self, "rate", _rate("rate", self.rate, len(x)))

    @property
    def duration(self) -> float:
        """Duration of the wave [s]."""
        return self._table.duration

    def at(self, t: Floats) -> Floats:
        """Return the factor at times t [s], in the same shape."""
        values, rate, duration = self._table
        if self.loop:
            return interpolate_table(values, (t % duration) * rate)
        edge = min(EDGE, duration / 2.0)
        within = compute_gate(t, duration - edge, edge)
        return within * interpolate_table(values, np.clip(t, 0.0, duration) * rate)

    @functools.cached_property
    def _table(self) -> Table:
        if self.rate is not None:
            x = np.array(self.samples, dtype=np.float32)
            return _tabulate_wave(x, self.rate, self.loop, self.mode)
        try:
            stat = Path(self.file).stat()
        except (OSError, ValueError) as error:
            problem = error.strerror if isinstance(error, OSError) else error
            raise ArgumentError("wave", f"{self.file} cannot be read: {problem}") from error
        return _load(self.file, stat.st_mtime_ns, stat.st_size, self.loop, self.mode)


@functools.lru_cache(maxsize=16)
def _load(file: str, time: int, size: int, loop: bool, mode: str) -> Table:
    """Return the table of a file; `time` and `size` identify its current contents in the cache."""
    rate, x = read_wav(file)
    return _tabulate_wave(x, _rate(f"wave {file}", rate, len(x)), loop, mode)


def _rate(name: str, rate: float, count: int) -> float:
    """Check the rate of `count` samples [Hz], and their duration. Returns the rate."""
    rate = check_number(name, rate, low=1.0, high=MAX_RATE)
    if not 0 < count <= MAX_DURATION * rate:
        raise ArgumentError(name, f"must last up to {MAX_DURATION:g} s, not {count / rate:g} s")
    return rate


def _tabulate_wave(x: Singles, rate: float, loop: bool, mode: str) -> Table:
    """Make the table of samples x, (L,), in -1..1."""
    from scipy.signal import oaconvolve

    x = np.clip(x, -1.0, 1.0)
    count, duration = len(x), len(x) / rate
    up, down = max(1, math.ceil(MIN_TABLE_RATE / rate)), max(1, int(rate // MIN_TABLE_RATE))
    if mode == "loudness":
        x, h = np.abs(x), _hann(rate * up, max(SMOOTH, 2.0 / rate))
    else:
        h = _low_pass(rate * up, min(FELT, rate / 2.0))
    beyond = len(h) // (2 * up) + 1 + 2 * down  # samples that the filter needs beyond either end
    x = np.pad(x, beyond, mode="wrap" if loop else "constant")
    stuffed = np.zeros(len(x) * up, dtype=np.float32)
    stuffed[::up] = up * x
    y = oaconvolve(stuffed, h, mode="same")[beyond * up :][: count * up + 2 * down : down]
    y = np.pi / 2.0 * y if mode == "loudness" else (1.0 + y) / 2.0
    return Table(np.clip(y, 0.0, 1.0).astype(np.float32), rate * up / down, duration)


def _low_pass(rate: float, edge: float) -> Singles:
    """Make a low-pass filter at `rate` [Hz]: flat to 0.9 `edge`, and down by 60 dB from `edge` [Hz] on."""
    from scipy.signal import firwin, kaiserord

    taps, beta = kaiserord(60.0, 0.1 * edge / (rate / 2.0))
    h = firwin(taps | 1, 0.95 * edge, window=("kaiser", beta), fs=rate)
    return np.asarray(h, dtype=np.float32)


def _hann(rate: float, seconds: float) -> Singles:
    """Make a Hann filter of length `seconds` [s] at `rate` [Hz], whose values sum to 1."""
    h = np.hanning(2 * round(seconds * rate / 2.0) + 1)
    return np.asarray(h / h.sum(), dtype=np.float32)
