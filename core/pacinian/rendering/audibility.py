"""How much of a sequence of frames can be heard: the audible part of the ultrasound's envelope.

Stands for: the square of the envelope, |p|^2, which air (Westervelt, JASA 35, 535, 1963), ear and
microphone turn into audible sound, at the given points, and the transducers' slowness, which makes a
dip of every step of phase. Leaves out: how the sound made along the whole beam adds up at the ear,
which favours high frequencies (with their square in Berktay's far field, J. Sound Vib. 2, 435, 1965);
the times of travel, as if what all transducers do arrived at once (in truth within about a
millisecond); a device's rounding. So it compares frames with frames; it is no level in a room.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.propagation import matrix
from pacinian.checks import check_number, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Complexes, Floats

BANDWIDTH = 2000.0  # [Hz] at -6 dB; a 40 kHz transducer's data sheet (Pro-Wave 400PT120)
BAND = (20.0, 20_000.0)  # [Hz] that people hear
SAMPLING = 96_000.0  # [Hz] at least


def compute_envelope(
    gains: Complexes, rate: float, array: Array, points: ArrayLike,
    medium: Air | None = None, bandwidth: float | None = BANDWIDTH,
) -> tuple[Floats, float]:  # fmt: skip
    """|p|^2 [Pa^2] over time, (S, M), and its samples per second [Hz].

    gains: of T frames, (T, N), each held until the next, `rate` a second [Hz]; the first has sounded
    for long. points: [m], (M, 3), or (T, M, 3) where they move with the frames. bandwidth: of the
    transducers at -6 dB [Hz], as one resonance; None where they follow at once. Raises ArgumentError.
    """
    g = np.asarray(gains)
    if g.ndim != 2 or not len(g) or g.shape[1] != len(array) or not np.isfinite(g).all():
        raise ArgumentError("gains", f"must be finite, of shape (T, {len(array)})")
    rate = check_number("rate", rate, low=0.0, above=True)
    q = np.asarray(points)
    moving = q.ndim == 3
    q = check_numbers("points", q, (len(g), None, 3) if moving else (None, 3))
    held = math.ceil(SAMPLING / rate)  # samples of a frame
    rest = np.zeros(held + 1)  # of the frame before, from sample to sample
    if bandwidth is not None:
        W = check_number("bandwidth", bandwidth, low=0.0, above=True)
        tau = math.sqrt(3.0) / (math.pi * W)  # [s]: |1 / (1 + j pi W tau)| = 1/2
        rest = np.exp(-np.arange(held + 1) / (held * rate * tau))
    e = np.empty((len(g), held, q.shape[-2]))
    B = None if moving else matrix(array, q, medium)
    before = g[0]  # what the transducers do when a frame begins
    for k, row in enumerate(g):
        b = matrix(array, q[k], medium) if B is None else B
        p, old = b @ row, b @ before
        e[k] = np.abs(p + rest[:-1, None] * (old - p)) ** 2
        before = row + rest[-1] * (before - row)
    return e.reshape(-1, q.shape[-2]), held * rate


def measure_audible(e: Floats, sampling: float, *, weighted: bool = False) -> Floats:
    """Energy of an envelope within 20 Hz to 20 kHz over its mean square [dB]; -inf where there is none.

    e: |p|^2 [Pa^2], (S, M). sampling: its samples per second [Hz]. weighted: by the ear's sensitivity,
    as `weigh_a` has it. Both by Hann's window, so that it does not matter where in a period e begins or
    ends. Some tenths of a second are needed to tell 20 Hz from slow motion. Returns (M,).
    """
    from scipy.signal import get_window, periodogram

    window = get_window("hann", len(e))
    frequency, power = periodogram(e, sampling, window="hann", detrend="constant", axis=0)
    heard = (frequency >= BAND[0]) & (frequency <= BAND[1])
    power, frequency = power[heard], frequency[heard]
    if weighted:
        power = power * 10.0 ** (weigh_a(frequency)[:, None] / 10.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = power.sum(axis=0) * sampling / len(e) * (window @ window) / (window**2 @ e**2)
        return np.asarray(10.0 * np.log10(np.nan_to_num(ratio)))


def weigh_a(frequency: Floats) -> Floats:
    """The A-weighting [dB] at frequencies [Hz] above 0; IEC 61672-1, annex E."""
    f = frequency * frequency
    a, b, c, d = 20.598997**2, 107.65265**2, 737.86223**2, 12194.217**2
    R = d * f * f / ((f + a) * np.sqrt((f + b) * (f + c)) * (f + d))
    return np.asarray(20.0 * np.log10(R) + 2.0)
