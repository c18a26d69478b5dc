from __future__ import annotations

import struct
import wave
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import wavfile

import pacinian as pc
from pacinian.scene.modulation import wav
from pacinian.scene.modulation.envelope import Wave

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.types import Floats

bounded = settings(max_examples=40)
RATE = 8000


def tone(frequency: float, seconds: float = 1.0, rate: float = RATE, size: float = 0.8) -> Floats:
    """Return a sine that starts at 0, in -1..1."""
    return size * np.sin(2 * np.pi * frequency * np.arange(round(seconds * rate)) / rate)


def write(path: Path, x: Floats, width: int, rate: int = RATE) -> str:
    """Write a WAV file of integers of `width` bytes with the standard library. x: (L,) or (L, channels)."""
    channels = x.reshape(len(x), -1)
    if width == 1:
        data = np.round(channels * 127 + 128).astype(np.uint8).tobytes()
    else:
        whole = np.round(channels * (2 ** (8 * width - 1) - 1)).astype("<i8")
        data = whole.reshape(-1, 1).view(np.uint8)[:, :width].tobytes()
    with wave.open(str(path), "wb") as file:
        file.setnchannels(channels.shape[1])
        file.setsampwidth(width)
        file.setframerate(rate)
        file.writeframes(data)
    return str(path)


# ---------------------------------------------------------------------------------- files


@pytest.mark.parametrize("width", [1, 2, 3, 4])
@pytest.mark.parametrize("channels", [1, 2])
def test_whole_numbers_of_every_size_come_back(tmp_path: Path, width: int, channels: int) -> None:
    x = tone(100.0)
    both = np.stack([x, 0.5 * x], axis=-1)[:, :channels]
    rate, read = wav.read_wav(write(tmp_path / "a.wav", both, width))
    assert rate == RATE
    assert read == pytest.approx(both.mean(axis=1), abs=1.6 / 2 ** (8 * width - 1) + 1e-7)


@pytest.mark.parametrize("kind", ["f4", "f8", "i2", "i4", "u1"])
def test_what_scipy_writes_comes_back(tmp_path: Path, kind: str) -> None:
    x, path = tone(100.0), tmp_path / "a.wav"
    scale = {"f4": 1.0, "f8": 1.0, "i2": 2.0**15, "i4": 2.0**31, "u1": 128.0}[kind]
    wavfile.write(path, RATE, (x * scale + (128 if kind == "u1" else 0)).astype(kind))
    rate, read = wav.read_wav(str(path))
    assert rate == RATE
    assert read == pytest.approx(x, abs=(1.1 / scale if scale > 1.0 else 0.0) + 1e-7)


def test_a_file_is_played_as_its_wave_read_once_and_again_when_it_has_changed(
    tmp_path: Path,
) -> None:
    path, t = tmp_path / "a.wav", np.arange(4000) / 2000.0  # plays twice
    first = Wave(file=write(path, tone(100.0), 2))
    expected = (1 + 0.8 * np.sin(2 * np.pi * 100.0 * t)) / 2
    assert first.at(t) == pytest.approx(expected, abs=0.001)
    assert first.duration == 1.0
    path.unlink()
    assert first.at(t) == pytest.approx(expected, abs=0.001)
    write(path, tone(50.0, 1.5), 2)
    assert Wave(file=str(path)).duration == 1.5


def bad_files() -> dict[str, bytes]:
    header = b"RIFF" + struct.pack("<I", 836) + b"WAVEfmt "
    form = struct.pack("<IHHIIHH", 16, 1, 1, RATE, 2 * RATE, 2, 16)
    silent = struct.pack("<IHHIIHH", 16, 1, 1, 0, 0, 2, 16)
    law = struct.pack("<IHHIIHH", 16, 6, 1, RATE, RATE, 1, 8)
    data = b"data" + struct.pack("<I", 8) + bytes(8)
    short = b"data" + struct.pack("<I", 800) + bytes(8)
    huge = b"data" + struct.pack("<I", 0xFFFFFFF0) + bytes(8)
    numbers = struct.pack("<IHHIIHH", 16, 3, 1, RATE, 4 * RATE, 4, 32)
    nan = b"data" + struct.pack("<If", 4, float("nan"))
    return {
        "empty": b"",
        "text": b"not a wave at all, but long enough for a header to be looked for",
        "junk": bytes(range(256)) * 4,
        "no form": header[:12],
        "no data": header + form,
        "no samples": header + form + b"data" + struct.pack("<I", 0),
        "data first": header[:12] + data,
        "0 Hz": header + silent + data,
        "A-law": header + law + data,
        "truncated": header + form + short,
        "truncated, huge": header + form + huge,
        "NaN": header + numbers + nan,
    }


@pytest.mark.parametrize("name", list(bad_files()))
def test_a_bad_file_is_refused_by_name(tmp_path: Path, name: str) -> None:
    path = tmp_path / "bad.wav"
    path.write_bytes(bad_files()[name])
    with pytest.raises(pc.ArgumentError, match=r"bad\.wav"):
        _ = Wave(file=str(path)).duration


@given(cut=st.integers(0, 200), seed=st.integers(0, 1000), data=st.binary(max_size=64))
@bounded
def test_any_bytes_are_a_wave_or_an_argument_error(
    tmp_path_factory: pytest.TempPathFactory, cut: int, seed: int, data: bytes
) -> None:
    path = tmp_path_factory.mktemp("fuzz") / "a.wav"
    write(path, tone(100.0, 0.01), 2)
    whole = bytearray(path.read_bytes())
    at = np.random.default_rng(seed).integers(0, 60, len(data))
    for i, byte in zip(at, data, strict=True):
        whole[i] = byte
    path.write_bytes(whole[: len(whole) - cut])
    try:
        value = Wave(file=str(path)).at(np.arange(50) / 2000.0)
    except pc.ArgumentError:
        return
    assert ((value >= 0.0) & (value <= 1.0)).all()


def test_a_file_that_is_not_there_no_file_too_large_or_too_long_is_refused(tmp_path: Path) -> None:
    with (tmp_path / "large.wav").open("wb") as file:
        file.truncate(wav.MAX_BYTES + 1)
    write(tmp_path / "long.wav", np.zeros(601 * 100), 1, rate=100)
    for path, said in (
        (tmp_path, ""),
        (tmp_path / "none.wav", "none.wav"),
        ("a\0b", ""),
        (tmp_path / "large.wav", "large.wav is larger than 64 MiB"),
        (tmp_path / "long.wav", "long.wav.*600 s"),
    ):
        with pytest.raises(pc.ArgumentError, match=f"^`wave.*{said}"):
            _ = Wave(file=str(path)).duration


# -------------------------------------------------------------------------------- samples


@pytest.mark.parametrize("rate", [700, 2000, 11_025, 44_100, 96_001])
@pytest.mark.parametrize("frequency", [10.0, 250.0])
def test_a_tone_comes_through_at_any_rate(rate: int, frequency: float) -> None:
    made = Wave(samples=tuple(tone(frequency, 1.0, rate)), rate=rate)
    t = 0.37 + np.arange(3000) / 1999.0
    expected = (1 + 0.8 * np.sin(2 * np.pi * frequency * t)) / 2
    assert made.at(t) == pytest.approx(expected, abs=0.002)


@pytest.mark.parametrize("rate", [8000, 44_100])
def test_nothing_above_what_skin_feels_is_left_to_fold_down(rate: int) -> None:
    """At 2 kHz, a tone of 1.8 kHz would alias to 200 Hz."""
    t = np.arange(4000) / 2000.0
    for frequency, left in ((500.0, 1.0), (890.0, 1.0), (1010.0, 0.0), (1800.0, 0.0)):
        x = Wave(samples=tuple(tone(frequency, 1.0, rate)), rate=rate).at(t)
        size = np.sqrt(2.0) * (x - x.mean()).std() / 0.4
        assert size == pytest.approx(left, abs=0.01)


@given(seed=st.integers(0, 100), period=st.integers(-50, 50), rate=st.floats(500.0, 50_000.0))
@bounded
def test_a_loop_repeats_without_a_seam(seed: int, period: int, rate: float) -> None:
    x = np.random.default_rng(seed).uniform(-1, 1, 300)
    made = Wave(samples=tuple(x), rate=rate)
    t = np.random.default_rng(seed).uniform(0.0, made.duration, 20)
    assert made.at(t + period * made.duration) == pytest.approx(made.at(t), abs=1e-6)
    seam = made.at(made.duration * np.array([-1e-9, 0.0, 1e-9, 1 - 1e-9, 1.0, 1 + 1e-9]))
    assert seam == pytest.approx(np.full(6, seam[0]), abs=1e-4)


@pytest.mark.parametrize("mode", ["waveform", "loudness"])
def test_without_a_loop_there_is_nothing_before_and_after(mode: Any) -> None:
    made = Wave(samples=tuple(tone(100.0)), rate=RATE, loop=False, mode=mode)
    t = np.array([-1e300, -1.0, -1e-6, 1.0, 2.0, 1e300])
    assert made.at(t).tolist() == [0.0] * 6
    middle = np.linspace(0.1, 0.9, 99)
    looped = Wave(samples=tuple(tone(100.0)), rate=RATE, mode=mode)
    assert made.at(middle) == pytest.approx(looped.at(middle), abs=1e-4)


@pytest.mark.parametrize("rate", [4000, 8000, 44_100])
def test_loudness_is_the_strength_of_a_tone(rate: int) -> None:
    swelling = tone(200.0, 1.0, rate, 1.0) * np.sin(np.pi * np.arange(rate) / rate) ** 2
    made = Wave(samples=tuple(swelling), rate=rate, mode="loudness")
    t = np.linspace(0.05, 0.95, 50)
    assert made.at(t) == pytest.approx(np.sin(np.pi * t) ** 2, abs=0.03)


def test_silence_is_a_steady_half_of_a_waveform_and_nothing_of_loudness() -> None:
    t = np.linspace(0.0, 3.0, 100)
    silence = (0.0,) * 1000
    assert Wave(samples=silence, rate=1000.0).at(t) == pytest.approx(0.5)
    assert Wave(samples=silence, rate=1000.0, mode="loudness").at(t) == pytest.approx(0.0)


@pytest.mark.parametrize(("mode", "level"), [("waveform", 0.8), ("loudness", 0.6 * np.pi / 2)])
def test_a_few_samples_will_do(mode: Any, level: float) -> None:
    t = np.linspace(-0.01, 0.01, 30)
    for count in (1, 2, 3):
        made = Wave(samples=(0.6,) * count, rate=1000.0, mode=mode)
        assert made.at(t) == pytest.approx(level, abs=0.002)
        once = Wave(samples=(0.6,) * count, rate=1000.0, mode=mode, loop=False).at(t)
        assert ((once >= 0.0) & (once <= 1.0)).all()


@pytest.mark.parametrize(
    ("given_as", "argument"),
    [
        ({}, "wave"),
        ({"file": "a.wav", "samples": (0.0,)}, "wave"),
        ({"samples": (0.0,)}, "rate"),
        ({"file": "a.wav", "rate": 100.0}, "rate"),
        ({"samples": (0.0,), "rate": 0.0}, "rate"),
        ({"samples": (0.0,), "rate": 1e7}, "rate"),
        ({"samples": (0.0,) * 601, "rate": 1.0}, "rate"),
        ({"samples": (float("nan"),), "rate": 1.0}, "samples"),
        ({"samples": ("a",), "rate": 1.0}, "samples"),
        ({"file": "a.wav", "mode": "loud"}, "mode"),
    ],
)
def test_bad_waves_are_refused_by_name(given_as: dict[str, Any], argument: str) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`{argument}` "):
        Wave(**given_as)


def test_samples_may_be_an_array() -> None:
    x = tone(100.0, 0.1)
    assert Wave(samples=x, rate=RATE) == Wave(samples=tuple(x), rate=RATE)  # type: ignore[arg-type]
