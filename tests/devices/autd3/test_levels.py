"""The levels of a frame are what the emulator emits, for every transducer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian_plugins.backends.autd3.levels import INTENSITY, LEVELS, SIZES, WIDTHS

from .emulated_backend import Emulated


def test_amplitudes_are_those_of_the_pulses_that_differ() -> None:
    assert LEVELS == len(SIZES) == len(set(WIDTHS.tolist())) == 203
    np.testing.assert_allclose(SIZES, np.sin(np.pi * np.unique(WIDTHS) / 512))
    np.testing.assert_allclose(SIZES, INTENSITY / 255, atol=0.5 * np.pi / 512)
    assert (INTENSITY[0], INTENSITY[-1]) == (0, 255)


def test_every_level_is_emitted_as_it_is_meant() -> None:
    it = Emulated(pc.autd(2, 1))
    N = len(it.array)
    for first in range(0, 256, 128):
        phase, amplitude = (first + np.arange(N)) % 256, (first + np.arange(N)) % LEVELS
        it.send(phase, amplitude)
        phases, widths = it.recorded(0.0)
        np.testing.assert_array_equal(phases[:, -1], -phase % 256)
        np.testing.assert_array_equal(widths[:, -1], WIDTHS[INTENSITY[amplitude]])
        frame = pc.Frame(0, 0.0, phase[None].astype(np.uint16), amplitude[None].astype(np.uint16))
        np.testing.assert_allclose(
            it.line.gains(), frame.gains(it.backend.capability)[0], atol=1e-6
        )
        it.clock.advance(1e-3)


def test_a_leading_phase_comes_earlier() -> None:
    it = Emulated()
    phase = np.where(np.arange(249) == 1, 64, 0)  # a quarter of a turn
    it.send(phase, np.full(249, LEVELS // 4))
    it.clock.advance(1e-3)
    volts = it.line.record(75e-6).output_voltage().to_numpy()[:2]  # 512 steps a period
    middle = [np.mean(np.flatnonzero(v[256:768] > 0)) for v in volts]
    assert middle[0] - middle[1] == pytest.approx(128, abs=1)


@settings(max_examples=5)
@given(st.sets(st.integers(0, 248), min_size=1, max_size=20), st.integers(0, 1 << 32))
def test_dead_channels_are_silent_and_the_others_get_their_own(dead: set[int], seed: int) -> None:
    import tempfile

    text = f'[[boards]]\nserial = "1"\n[[boards]]\nserial = "2"\ndead = {sorted(dead)}\n'
    text += "pose = { position = [0.2, 0.0, 0.0] }\n"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "two.toml"
        path.write_text(text, encoding="utf-8")
        array = pc.DeviceDescription.load(path).array()
        it = Emulated(array, description=str(path))
    chance = np.random.default_rng(seed)
    phase, amplitude = chance.integers(0, 256, len(array)), chance.integers(0, LEVELS, len(array))
    it.send(phase, amplitude)
    phases, widths = (levels[:, -1] for levels in it.recorded(0.0))
    alive = np.array([n for n in range(498) if n - 249 not in dead])
    np.testing.assert_array_equal(phases[alive], -phase % 256)
    np.testing.assert_array_equal(widths[alive], WIDTHS[INTENSITY[amplitude]])
    assert not widths[[249 + n for n in dead]].any()


@pytest.mark.parametrize(
    ("phase", "amplitude"), [((1, 249, 256), 0), (0, (1, 249, LEVELS)), ((1, 248, 0), 0)]
)
def test_levels_that_the_units_do_not_have_are_refused(phase: object, amplitude: object) -> None:
    it = Emulated()
    rows = [
        np.full(one[:2], one[2]) if isinstance(one, tuple) else np.zeros((1, 249))
        for one in (phase, amplitude)
    ]
    with pytest.raises(pc.BackendError, match="levels that the units cannot emit"):
        it.send(*rows)


def test_the_silencer_does_not_ramp_what_is_sent_or_silenced() -> None:
    it = Emulated()
    it.clock.time = 0.01
    it.send(np.full(249, 200), np.full(249, LEVELS - 1))
    it.clock.time = 0.011
    it.backend.silence()
    it.clock.time = 0.012
    phases, widths = it.recorded(0.003)
    steps = [0] * 39 + [256] * 40 + [0] * 41
    assert widths[0].tolist() == steps
    assert set(phases[0, widths[0] > 0].tolist()) == {56}
