"""Measure how audible a sequence of frames is, by the audible part of the ultrasound's envelope.

The model includes the squared envelope |p|^2 at the given points, which air (Westervelt, JASA 35, 535, 1963), ear and
microphone convert to audible sound, and the slow response of the transducers, because of which every phase step causes
a dip. The model omits three things: the sum at the ear of the sound generated along the whole beam, which favours high
frequencies (by their square in Berktay's far field, J. Sound Vib. 2, 435, 1965); the times of travel, so that the sound
of all transducers arrives at once (in reality, within about a millisecond); and rounding by the device. Therefore the
result serves to compare sequences of frames; it is not a sound level in a room.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.propagation import matrix
from pacinian.argument_checks import check_number, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Complexes, Floats

# Bandwidth of a 40 kHz transducer at -6 dB, from the data sheet of the Pro-Wave 400PT120 [Hz].
BANDWIDTH = 2000.0
BAND = (20.0, 20_000.0)  # range of human hearing [Hz]
SAMPLING = 96_000.0  # lowest sampling rate of the envelope [Hz]


def compute_envelope(
    gains: Complexes, rate: float, array: Array, points: ArrayLike,
    medium: Air, bandwidth: float | None = BANDWIDTH,
) -> tuple[Floats, float]:  # fmt: skip
    """Return |p|^2 over time, (S, M) [Pa^2], and its sampling rate [Hz].

    gains: of T frames, (T, N); each is held until the next, and the first is in steady state. rate: frames per second
    [Hz]. points: (M, 3) [m], or (T, M, 3) if they move with the frames. bandwidth: of the transducers at -6 dB [Hz],
    modelled as one resonance; None for transducers that respond at once. Raises ArgumentError.
    """
    g = np.asarray(gains)
    if g.ndim != 2 or not len(g) or g.shape[1] != len(array) or not np.isfinite(g).all():
        raise ArgumentError("gains", f"must be finite, of shape (T, {len(array)})")
    rate = check_number("rate", rate, low=0.0, above=True)
    q = np.asarray(points)
    moving = q.ndim == 3
    q = check_numbers("points", q, (len(g), None, 3) if moving else (None, 3))
    held = math.ceil(SAMPLING / rate)  # samples per frame
    rest = np.zeros(held + 1)  # remaining share of the previous frame, by sample
    if bandwidth is not None:
        W = check_number("bandwidth", bandwidth, low=0.0, above=True)
        tau = math.sqrt(3.0) / (math.pi * W)  # |1 / (1 + j pi W tau)| = 1/2 [s]
        rest = np.exp(-np.arange(held + 1) / (held * rate * tau))
    e = np.empty((len(g), held, q.shape[-2]))
    B = None if moving else matrix(array, q, medium)
    before = g[0]  # state of the transducers at the start of a frame
    for k, row in enumerate(g):
        b = matrix(array, q[k], medium) if B is None else B
        p, old = b @ row, b @ before
        e[k] = np.abs(p + rest[:-1, None] * (old - p)) ** 2
        before = row + rest[-1] * (before - row)
    return e.reshape(-1, q.shape[-2]), held * rate


def measure_audible(e: Floats, sampling: float) -> Floats:
    """Return the A-weighted energy of an envelope relative to its mean square, (M,) [dB]; -inf for none.

    e: |p|^2, (S, M) [Pa^2]. sampling: its sampling rate [Hz]. The energy is that from 20 Hz to 20 kHz. Energy and
    mean square use a Hann window, so that the phase at which e starts and ends does not matter. e must last some tenths
    of a second, to separate 20 Hz from slow motion.
    """
    from scipy.signal import get_window, periodogram

    window = get_window("hann", len(e))
    frequency, power = periodogram(e, sampling, window="hann", detrend="constant", axis=0)
    heard = (frequency >= BAND[0]) & (frequency <= BAND[1])
    power = power[heard] * 10.0 ** (weigh_a(frequency[heard])[:, None] / 10.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = power.sum(axis=0) * sampling / len(e) * (window @ window) / (window**2 @ e**2)
        return np.asarray(10.0 * np.log10(np.nan_to_num(ratio)))


def weigh_a(frequency: Floats) -> Floats:
    """Return the A-weighting [dB] at frequencies [Hz] above 0, by IEC 61672-1, annex E."""
    f = frequency * frequency
    a, b, c, d = 20.598997**2, 107.65265**2, 737.86223**2, 12194.217**2
    R = d * f * f / ((f + a) * np.sqrt((f + b) * (f + c)) * (f + d))
    return np.asarray(20.0 * np.log10(R) + 2.0)
