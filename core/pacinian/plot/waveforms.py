"""Plots the pressure at a point over time, its spectrum, and the spectrogram of what is audible."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.audibility import BAND, BANDWIDTH, compute_envelope, weigh_a
from pacinian.acoustics.pressure import radiation_pressure
from pacinian.acoustics.propagation import matrix
from pacinian.argument_checks import check_near, check_numbers
from pacinian.errors import ArgumentError
from pacinian.plot.emissions import Emission, Run, collect_emission
from pacinian.plot.page import panels
from pacinian.plot.quantities import QUANTITIES
from pacinian.plot.style import BLUE, GREY, LINE, RED, bar, dress

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pacinian.plot.quantities import Show
    from pacinian.types import ArrayLike, Floats

TALL, SPECTROGRAM = 1.9, 2.4  # height of a panel [inch]
MAX_FELT = 1000.0  # highest frequency that people feel, and end of the spectrum [Hz]
WINDOW = 0.05  # length of a window of the spectrogram [s]
PADDING = 8  # times that the spectrum is finer than its resolution, so that peaks keep their height
STEPS = 4  # windows that overlap each other
MIN_WINDOWS = 2  # windows in the shortest spectrogram
LEVEL_RANGE = 60.0  # range of levels drawn below the loudest [dB]
MIN_POWER = 1e-30  # smallest relative power, so that its level is finite


def waveform(
    run: Run,
    point: ArrayLike,
    *,
    show: Show = "radiation",
    start: float = 0.0,
    duration: float | None = None,
    ax: Sequence[Axes] | None = None,
) -> Figure:
    """Plot the pressure at a point over time, and the amplitudes of its frequencies.

    run: a recording, its file, or a renderer with the simulated backend, which is run without waiting. point: (3,) [m].
    show: "radiation" pressure on skin [Pa], or peak sound "pressure" [Pa]. start, duration: part of the run [s]; a
    renderer needs a duration. ax: two axes to draw into. The spectrum has a Hann window, so that a sine of amplitude a
    is a peak of height a; the mean is the dashed line. It ends at 1 kHz, above which nothing is felt.
    Raises ArgumentError, PointOnTransducer, RecordingError, MissingExtra.
    """
    if show not in ("radiation", "pressure"):
        raise ArgumentError("show", f'must be "radiation" or "pressure", not {show!r}')
    page, (above, below), ours = panels(ax, [TALL, TALL])
    emission = collect_emission(run, start, duration)
    t, found = compute_course(emission, point, show)
    above.step(1e3 * t, found, where="post", color=BLUE, linewidth=LINE)
    above.axhline(found.mean(), color=GREY, linestyle="--", linewidth=LINE)
    above.set(
        xlabel="time [ms]", ylabel=QUANTITIES[show].label.replace(" on skin", ""), ylim=(0.0, None)
    )
    frequency, amplitude = compute_spectrum(found, emission.rate)
    below.plot(frequency, amplitude, color=RED, linewidth=LINE)
    below.set(
        xlabel="frequency [Hz]", ylabel="amplitude [Pa]", ylim=(0.0, None),
        xlim=(0.0, min(MAX_FELT, emission.rate / 2.0)),
    )  # fmt: skip
    return dress(page) if ours else page


def spectrogram(
    run: Run,
    point: ArrayLike,
    *,
    start: float = 0.0,
    duration: float | None = None,
    bandwidth: float | None = BANDWIDTH,
    ax: Axes | None = None,
) -> Figure:
    """Plot the audible frequencies of a run over time: the squared envelope of the ultrasound, A-weighted.

    run, start, duration: as for `waveform`. point: of an ear or a microphone, (3,) [m]. bandwidth: of the transducers
    at -6 dB [Hz]; None for transducers that respond at once. ax: to draw into. Levels are relative to the mean square
    of the squared envelope, so that they compare runs; they are no sound levels in a room.
    Raises ArgumentError, PointOnTransducer, RecordingError, MissingExtra.
    """
    page, (panel,), ours = panels(ax, [SPECTROGRAM])
    emission = collect_emission(run, start, duration)
    if emission.duration < MIN_WINDOWS * WINDOW:
        least = MIN_WINDOWS * WINDOW
        raise ArgumentError("duration", f"must be {least:g} s or more, to separate frequencies")
    t, frequency, level = compute_audible_levels(emission, point, bandwidth)
    image = panel.pcolormesh(
        t, frequency, np.maximum(level, level.max() - LEVEL_RANGE), cmap="magma", shading="nearest",
        rasterized=True,
    )  # fmt: skip
    panel.set(
        yscale="log", ylim=(frequency[0], BAND[1]), xlabel="time [s]", ylabel="frequency [Hz]"
    )
    bar(page, image, panel, "audible part [dB(A)]")
    return dress(page) if ours else page


def compute_course(emission: Emission, point: ArrayLike, show: Show) -> tuple[Floats, Floats]:
    """Return times from the run's begin [s] and the quantity at a point, (3,) [m], for each row: (T,) each."""
    p = emission.gains @ matrix(emission.array, _check_point(emission, point), emission.medium)[0]
    t = emission.start + np.arange(len(p)) / emission.rate
    return t, radiation_pressure(p, emission.medium) if show == "radiation" else np.asarray(
        np.abs(p), np.float64
    )


def compute_spectrum(values: Floats, rate: float) -> tuple[Floats, Floats]:
    """Return frequencies above 0 [Hz] and the amplitudes of the sines in values at `rate` [Hz], (T,); (F,) each."""
    window = np.hanning(len(values) + 1)[:-1] if len(values) > 1 else np.ones(1)
    size = PADDING * len(values)
    steady = (values * window).sum() / window.sum()
    amplitude = 2.0 * np.abs(np.fft.rfft((values - steady) * window, size)) / window.sum()
    frequency = np.fft.rfftfreq(size, 1.0 / rate)
    return np.asarray(frequency[1:], np.float64), np.asarray(amplitude[1:], np.float64)


def compute_audible_levels(
    emission: Emission, point: ArrayLike, bandwidth: float | None
) -> tuple[Floats, Floats, Floats]:
    """Return times (K,) [s], frequencies (F,) [Hz] and A-weighted levels (F, K) [dB] of the audible part."""
    from scipy.signal import ShortTimeFFT
    from scipy.signal.windows import hann

    q = _check_point(emission, point)
    e, sampling = compute_envelope(
        emission.gains, emission.rate, emission.array, q, emission.medium, bandwidth
    )
    size = round(WINDOW * sampling)
    make = ShortTimeFFT(hann(size, sym=False), size // STEPS, sampling, scale_to="magnitude")
    power = 2.0 * np.abs(make.stft(e[:, 0] - e[:, 0].mean(), padding="odd")) ** 2
    heard = (make.f >= BAND[0]) & (make.f <= BAND[1])
    total = float((e**2).mean()) or 1.0
    level = 10.0 * np.log10(np.maximum(power[heard] / total, MIN_POWER))
    level += weigh_a(make.f[heard])[:, None]
    t = make.t(len(e))
    kept = (t >= 0.0) & (t <= emission.duration)
    return emission.start + t[kept], make.f[heard], np.asarray(level[:, kept])


def _check_point(emission: Emission, point: ArrayLike) -> Floats:
    """Return a point as (1, 3) [m]. Raises ArgumentError."""
    q = check_numbers("point", point, (3,))[None]
    check_near("point", q, emission.array.centre)
    return q
