from __future__ import annotations

import itertools
import math
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import welch

import pacinian as pc
from pacinian.plugins.backend import Capability
from pacinian.rendering.quantiser import Quantiser
from pacinian.scene.modulation.envelope import Envelope, Noise, Preset, Pulse, Wave, resolve
from pacinian.scene.modulation.waves import EDGE

levels = st.floats(0.0, 1.0)
frequencies = st.floats(0.0, 1e5)
times = st.lists(st.floats(-1e6, 1e6) | st.floats(-1e300, 1e300), min_size=1, max_size=20).map(
    np.array
)


@st.composite
def spans(draw: st.DrawFn) -> tuple[float, float]:
    """Draw a low and a high value."""
    low, high = sorted((draw(levels), draw(levels)))
    return low, high


any_envelope = st.one_of(
    levels.map(pc.Constant),
    st.builds(lambda f, s: pc.Sine(f, *s), frequencies, spans()),
    st.builds(lambda f, s, d: pc.Square(f, *s, duty=d), frequencies, spans(), levels),
    st.builds(
        lambda width, gap, start, rise, s: Pulse(
            width, None if gap is None else width + gap, start, rise * width, *s
        ),
        st.floats(1e-300, 1e6),
        st.none() | st.floats(0.0, 1e6),
        st.floats(-1e6, 1e6),
        st.floats(0.0, 0.5),
        spans(),
    ),
    st.builds(
        lambda share, f, s, seed: Noise(share * f, f, *s, seed=seed),
        st.floats(0.0, 0.98),
        st.floats(1e-3, 1e5),
        spans(),
        st.integers(0, 3),
    ),
    st.builds(
        lambda x, rate, loop, mode: Wave(samples=tuple(x), rate=rate, loop=loop, mode=mode),
        st.lists(st.floats(-2.0, 2.0), min_size=1, max_size=20),
        st.floats(100.0, 1e5),
        st.booleans(),
        st.sampled_from(["waveform", "loudness"]),
    ),
    st.sampled_from(["impulsive", "rapturous", "trembling", "buzzing"]).map(Preset),
)


@given(envelope=any_envelope, t=times)
def test_every_envelope_stays_within_its_bounds(envelope: Any, t: Any) -> None:
    value = envelope.at(t)
    assert value.shape == t.shape
    assert value.dtype == np.float64
    low, high = getattr(envelope, "low", 0.0), getattr(envelope, "high", 1.0)
    assert (value >= low).all()
    assert (value <= high + 1e-15).all()
    assert (value <= 1.0).all()


@given(level=levels, t=times)
def test_a_constant_is_its_level_at_all_times(level: float, t: Any) -> None:
    assert (pc.Constant(level).at(t) == level).all()
    assert pc.Constant() == pc.Constant(1.0)


@given(frequency=st.floats(0.1, 1e4), span=spans(), cycle=st.integers(0, 1000))
def test_a_sine_starts_low_and_is_high_half_a_period_later(
    frequency: float, span: tuple[float, float], cycle: int
) -> None:
    low, high = span
    phase = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
    value = pc.Sine(frequency, low, high).at((cycle + phase) / frequency)
    middle = (low + high) / 2
    assert value == pytest.approx([low, middle, high, middle, low], abs=1e-9)


def test_a_sine_has_its_frequency_and_no_other() -> None:
    t = np.arange(4000) / 4000.0
    spectrum = np.abs(np.fft.rfft(pc.Sine(200.0, 0.2, 0.8).at(t))) / 4000
    assert spectrum[0] == pytest.approx(0.5)
    assert spectrum[200] == pytest.approx(0.15)
    spectrum[[0, 200]] = 0.0
    assert spectrum.max() < 1e-9


@given(frequency=st.floats(0.1, 1e4), span=spans(), duty=levels | st.sampled_from([0.0, 1.0]))
def test_a_square_is_high_for_its_duty_of_each_period_and_then_low(
    frequency: float, span: tuple[float, float], duty: float
) -> None:
    low, high = span
    phase = (np.arange(1000) + 0.5) / 1000
    value = pc.Square(frequency, low, high, duty=duty).at((3 + phase) / frequency)
    edge = min(EDGE * frequency, duty, 1.0 - duty)  # duration of an edge, in periods
    clear = (
        (phase > edge) & ((phase < duty) | (phase > duty + edge)) & (np.abs(phase - duty) > 1e-4)
    )
    expected = np.where(phase < duty, high, low)
    np.testing.assert_allclose(value[clear], expected[clear], atol=1e-6)
    assert (value >= low - 1e-12).all()
    assert (value <= high + 1e-12).all()


stepping = st.one_of(
    st.builds(pc.Square, st.floats(0.1, 300.0), duty=st.floats(0.3, 0.7)),
    st.builds(
        lambda width, gap, share: Pulse(width, width + gap, rise=share * width),
        st.floats(0.0015, 0.1), st.floats(0.0015, 0.1), st.floats(0.0, 0.5),
    ),
    st.builds(Pulse, st.floats(0.0015, 0.1), start=st.floats(0.0, 0.1)),
    st.just(Preset("impulsive")),
    st.just(pc.Wave(samples=(0.0,) * 50, rate=1000.0, loop=False)),
)  # fmt: skip


@given(envelope=stepping, rate=st.sampled_from([2000.0, 4000.0, 64_000.0]))
def test_no_envelope_of_ours_steps(envelope: Any, rate: float) -> None:
    """The slope is at most that of half a cosine of 1.5 ms, or of the available time if that is shorter."""
    e = envelope.at(np.arange(-0.02, 0.3, 1.0 / rate))
    edge = EDGE
    if isinstance(envelope, pc.Square):
        duty = min(envelope.duty, 1.0 - envelope.duty)
        edge = min(EDGE, duty / envelope.frequency)
    if isinstance(envelope, Pulse):
        edge = max(envelope.rise, min(EDGE, envelope.width - envelope.rise))
    assert np.abs(np.diff(e)).max() <= np.pi / 2.0 / (rate * edge) + 1e-6


@pytest.mark.parametrize("kind", [pc.Sine, pc.Square])
def test_no_frequency_is_steady(kind: Any) -> None:
    assert len(set(kind(0.0).at(np.linspace(-5, 5, 99)).tolist())) == 1


@given(
    values=st.lists(st.floats(), min_size=1, max_size=20),
)
def test_a_function_is_clipped_and_its_nan_is_nothing(values: list[float]) -> None:
    t = np.zeros(len(values))
    value = pc.Function(lambda _: np.array(values)).at(t)
    expected = [0.0 if math.isnan(v) else min(max(v, 0.0), 1.0) for v in values]
    assert value.tolist() == expected


def test_a_function_is_given_the_times_and_may_give_one_value_for_all() -> None:
    t = np.array([0.1, 0.2, 0.7])
    assert pc.Function(lambda t: t).at(t).tolist() == t.tolist()
    for answer in (0.5, np.float32(0.5), [0.5], np.array(0.5)):
        assert pc.Function(lambda _, a=answer: a).at(t).tolist() == [0.5] * 3


def test_a_function_may_work_in_place() -> None:
    t = np.array([0.1, 0.2, 0.7])
    assert pc.Function(lambda t: np.multiply(t, 0.5, out=t)).at(t).tolist() == [0.05, 0.1, 0.35]
    assert t.tolist() == [0.1, 0.2, 0.7]


@pytest.mark.parametrize("answer", [1j, [0.5 + 0j], "strong"])
def test_a_function_must_give_real_numbers(answer: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`function` must return"):
        pc.Function(lambda _: answer).at(np.zeros(1))


@pytest.mark.parametrize(
    ("argument", "make"),
    [
        ("level", lambda: pc.Constant(1.1)),
        ("level", lambda: pc.Constant(-0.1)),
        ("low", lambda: pc.Sine(100.0, low=-0.1)),
        ("high", lambda: pc.Sine(100.0, high=1.1)),
        ("high` must be 0.7 or more", lambda: pc.Sine(100.0, low=0.7, high=0.3)),
        ("frequency", lambda: pc.Sine(-1.0)),
        ("frequency` must be 0 or more and at most 100000", lambda: pc.Sine(1.1e5)),
        ("low", lambda: pc.Square(100.0, low=math.nan)),
        ("high", lambda: pc.Square(100.0, high=1.1)),
        ("high` must be 0.7 or more", lambda: pc.Square(100.0, low=0.7, high=0.3)),
        ("duty", lambda: pc.Square(100.0, duty=-0.1)),
        ("duty", lambda: pc.Square(100.0, duty=1.1)),
        ("frequency", lambda: pc.Square(math.inf)),
        ("width", lambda: Pulse(0.0)),
        ("width", lambda: Pulse(math.nan)),
        ("period", lambda: Pulse(0.1, period=0.05)),
        ("rise", lambda: Pulse(0.1, rise=0.06)),
        ("rise", lambda: Pulse(0.1, rise=-0.01)),
        ("start", lambda: Pulse(0.1, start=math.inf)),
        ("high", lambda: Pulse(0.1, low=0.5, high=0.4)),
        ("low_frequency", lambda: Noise(-1.0, 10.0)),
        ("low_frequency", lambda: Noise(10.0, 10.0)),
        ("high_frequency", lambda: Noise(0.0, 0.0)),
        ("high_frequency", lambda: Noise(0.0, math.nan)),
        ("high", lambda: Noise(0.0, 10.0, 0.5, 0.4)),
        ("seed", lambda: Noise(0.0, 10.0, seed=-1)),
        ("seed", lambda: Noise(0.0, 10.0, seed=0.5)),  # type: ignore[arg-type]
    ],
)
def test_what_cannot_be_is_refused_by_name(argument: str, make: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`{argument}"):
        make()


# --------------------------------------------------------------------------------- frames


@pytest.mark.parametrize("begin", [0, 1, 86_400])
@pytest.mark.parametrize("frequency", [10.0, 40.0, 250.0])
def test_edges_due_on_a_frame_are_never_a_frame_late(frequency: float, begin: int) -> None:
    k = np.arange(400) + 2000 * begin
    period = round(2000 / frequency)
    since, half = k % period, period // 2  # frames since the last rising edge
    frames = min(EDGE * 2000.0, half)
    up, down = (np.clip((since - after) / frames, 0.0, 1.0) for after in (0, half))
    expected = (np.cos(np.pi * down) - np.cos(np.pi * up)) / 2.0
    np.testing.assert_allclose(pc.Square(frequency).at(k / 2000.0), expected, atol=1e-4)
    pulse = Pulse(width=0.5 / frequency, period=1.0 / frequency)
    if begin < 2:  # later, the rounding of its period adds up
        np.testing.assert_allclose(pulse.at(k / 2000.0), expected, atol=1e-4)


@pytest.mark.parametrize(
    "envelope",
    [
        pc.Sine(200.0),
        pc.Sine(37.0, 0.1, 0.9),
        Pulse(0.01, 0.1, rise=0.002),
        Noise(20.0, 300.0),
        Preset("impulsive"),
        Preset("trembling"),
    ],
    ids=lambda e: type(e).__name__,
)
def test_the_paper_s_device_plays_an_envelope_to_within_a_level(envelope: Any) -> None:
    """The device has 2 kHz and 320 levels of amplitude. The envelope is radiation pressure, the square of amplitude."""
    N, t = 249, np.arange(2000) / 2000.0
    e = envelope.at(t)
    gains = np.exp(2j * np.pi * np.arange(N) / N).astype(np.complex64)
    modulated = (np.sqrt(e)[:, None] * gains).astype(np.complex64)
    device = Capability(phases=256, amplitudes=320, rate=2000.0)
    frame = Quantiser(device, len(t), N).make_frame(modulated, 1.0, 0, 0.0)
    played, level = np.abs(frame.gains(device)), 1.0 / 319
    assert np.abs(played - np.sqrt(e)[:, None]).max() <= level
    # the mean is much closer: some transducers round up, and others down
    together = played.mean(axis=1)
    assert np.abs(together - np.sqrt(e)).max() <= 0.01 * level
    # (a + h)^2 - a^2 <= 2 a h + h^2
    allowed = 2.0 * np.sqrt(e) * 0.01 * level + level**2
    assert (np.abs(together**2 - e) <= allowed).all()


# ---------------------------------------------------------------------------------- pulse


@given(
    width=st.floats(1e-3, 1.0),
    gap=st.floats(0.0, 1.0),
    start=st.floats(-1.0, 1.0),
    cycle=st.integers(-100, 100),
    span=spans(),
)
def test_a_pulse_is_high_for_its_width_each_period(
    width: float, gap: float, start: float, cycle: int, span: tuple[float, float]
) -> None:
    low, high = span
    pulse = Pulse(width, width + gap, start, low=low, high=high)
    at = start + cycle * (width + gap)
    edge = min(EDGE, width, gap)
    inside = at + edge + (width - edge) * np.array([0.001, 0.5, 0.999])
    assert pulse.at(inside) == pytest.approx([high] * 3, abs=1e-6)
    if gap > 0.01:
        outside = at + width + edge + (gap - edge) * np.array([0.001, 0.5, 0.999])
        assert pulse.at(outside) == pytest.approx([low] * 3, abs=1e-6)


def test_a_pulse_without_a_period_comes_once() -> None:
    t = np.array([-1e9, 0.0, 0.4999, 0.50075, 0.502, 0.55, 0.5999, 0.60075, 0.602, 1e9])
    value = Pulse(0.1, start=0.5).at(t)
    assert value == pytest.approx([0, 0, 0, 0.5, 1, 1, 1, 0.5, 0, 0], abs=1e-5)


@given(rise=st.floats(EDGE, 0.05), single=st.booleans())
def test_a_pulse_rises_and_falls_within_its_width_as_half_a_cosine(
    rise: float, single: bool
) -> None:
    pulse = Pulse(0.1, None if single else 0.3, rise=rise)
    up = rise * np.array([0.0, 0.25, 0.5, 0.75, 1.0])
    expected = (1 - np.cos(np.pi * up / rise)) / 2
    assert pulse.at(up) == pytest.approx(expected, abs=1e-4)
    assert pulse.at(0.1 - up) == pytest.approx(expected, abs=1e-4)
    assert pulse.at(np.array([0.05]))[0] == pytest.approx(1.0)


# ---------------------------------------------------------------------------------- noise


@pytest.mark.parametrize(
    ("low", "high", "seed"),
    [(0.0, 100.0, 0), (20.0, 200.0, 7), (190.0, 210.0, 0), (300.0, 900.0, 7)],
)
def test_noise_has_its_power_within_its_band_evenly(low: float, high: float, seed: int) -> None:
    rate = 20.0 * high
    f, power = welch(
        Noise(low, high, seed=seed).at(np.arange(400_000) / rate), fs=rate, nperseg=8192
    )
    margin = 4 * (f[1] - f[0])
    inside = (f >= low - margin) & (f <= high + margin)
    assert power[inside].sum() / power.sum() > 0.99
    if high - low < 50.0 * margin:
        return
    thirds = np.linspace(low + margin, high - margin, 4)
    shares = [power[(f >= a) & (f < b)].mean() for a, b in itertools.pairwise(thirds)]
    assert np.array(shares) == pytest.approx(np.mean(shares), rel=0.15)


def test_noise_is_about_the_middle_and_clipped_hardly_ever() -> None:
    x = Noise(20.0, 200.0, 0.2, 0.8).at(np.arange(65_536) / 3200.0)
    assert x.mean() == pytest.approx(0.5, abs=0.005)
    assert x.std() == pytest.approx(0.6 / 5.0, rel=0.03)
    assert np.mean((x <= 0.2 + 1e-9) | (x >= 0.8 - 1e-9)) < 0.02


@given(t=times, seed=st.integers(0, 3))
def test_noise_is_the_same_in_whatever_order_it_is_asked(t: Any, seed: int) -> None:
    noise = Noise(20.0, 200.0, seed=seed)
    one_by_one = [Noise(20.0, 200.0, seed=seed).at(np.array([s]))[0] for s in t[::-1]]
    assert noise.at(t).tolist() == one_by_one[::-1]


def test_noise_of_another_seed_is_other_noise_and_repeats() -> None:
    t = np.arange(10_000) / 2000.0
    a, b = Noise(20.0, 200.0).at(t), Noise(20.0, 200.0, seed=1).at(t)
    assert abs(np.corrcoef(a, b)[0, 1]) < 0.1
    assert Noise(20.0, 200.0).at(t + 4096 / 200.0) == pytest.approx(a, abs=1e-9)


# -------------------------------------------------------------------------------- presets


def spectrum(name: str) -> tuple[Any, Any]:
    """Return frequencies [Hz] and the share of power at each, over 12 s."""
    x = Preset(name).at(np.arange(24_000) / 2000.0)  # type: ignore[arg-type]
    power = np.abs(np.fft.rfft(x - x.mean())) ** 2
    return np.fft.rfftfreq(len(x), 1 / 2000.0), power / power.sum()


def share(name: str, low: float, high: float) -> float:
    f, power = spectrum(name)
    return float(power[(f >= low) & (f <= high)].sum())


def test_buzzing_is_a_vibration_where_pacinian_corpuscles_feel_best() -> None:
    assert share("buzzing", 200.0, 300.0) > 0.99


def test_trembling_is_a_low_vibration_of_irregular_strength() -> None:
    assert share("trembling", 30.0, 50.0) > 0.5
    x = Preset("trembling").at(np.arange(24_000) / 2000.0)
    peaks = x.reshape(-1, 50).max(axis=1)  # for each 25 ms, one period
    assert peaks.std() > 0.1
    assert len(np.unique(np.round(peaks, 3))) > 100


def test_rapturous_swells_and_fades() -> None:
    assert share("rapturous", 100.0, 200.0) > 0.4
    x = Preset("rapturous").at(np.arange(24_000) / 2000.0)
    strength = x.reshape(-1, 200).max(axis=1)  # for each 0.1 s
    assert strength.max() > 0.95
    assert strength.min() < 0.05
    assert np.abs(np.diff(strength)).max() < 0.25


def test_impulsive_is_short_taps() -> None:
    x = Preset("impulsive").at(np.arange(24_000) / 2000.0)
    taps = np.flatnonzero((x[1:] > 0.5) & (x[:-1] <= 0.5))
    assert len(taps) == 4 * 12
    assert np.mean(x > 0.1) < 0.2
    assert x.max() > 0.9


@pytest.mark.parametrize("name", ["impulsive", "rapturous", "trembling", "buzzing"])
def test_a_preset_may_be_given_by_its_name(name: Any) -> None:
    assert resolve(name) == Preset(name)
    decode = msgspec.json.Decoder(Envelope).decode
    t = np.arange(100) / 2000.0
    as_word, as_table = decode(f'"{name}"'), decode(f'{{"type": "preset", "name": "{name}"}}')
    assert (resolve(as_word).at(t) == resolve(as_table).at(t)).all()


@pytest.mark.parametrize("bad", ["tremblin", None, ["buzzing"]])
def test_what_is_no_envelope_is_refused(bad: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`(preset|envelope)` must be"):
        resolve(bad)
    with pytest.raises(pc.ArgumentError, match=r"^`preset` must be one of"):
        Preset(bad)


@pytest.mark.parametrize(
    "envelope",
    [
        pc.Constant(0.5),
        pc.Sine(40.0),
        pc.Square(40.0),
        Pulse(0.1, 0.2),
        Noise(1.0, 2.0),
        Wave(file="tap.wav"),
        Wave(samples=(0.0, 1.0), rate=100.0),
        Preset("buzzing"),
    ],
    ids=lambda e: type(e).__name__,
)
def test_every_envelope_comes_back_from_a_scene_file_and_cannot_be_changed(envelope: Any) -> None:
    assert msgspec.json.decode(msgspec.json.encode(envelope), type=Envelope) == envelope
    assert resolve(envelope) is envelope
    for name in envelope.__struct_fields__:
        with pytest.raises(AttributeError):
            setattr(envelope, name, 0.1)
