"""The mean of a modulated field over whole periods, from a few sampled frames."""

from __future__ import annotations

import numpy as np
import pytest

from pacinian.scene.modulation.envelope import resolve
from pacinian.viewing.time_shares import Modulation, share_time
from pacinian.wire import modulation as wire
from pacinian.wire.convert_modulation import envelope_to_scene, technique_to_scene

HAND = Modulation(wire.Constant(level=0.5))
TIMES = 5.0 + np.cumsum(np.random.default_rng(0).uniform(0.5, 1.5, 60)) / 60.0
PERIODIC = [
    (Modulation(wire.Sine(frequency=200.0)), 0.005),
    (Modulation(wire.Sine(frequency=2.3, low=0.2, high=0.9)), 1.0 / 2.3),
    (Modulation(wire.Square(frequency=33.0, duty=0.4)), 1.0 / 33.0),
    (Modulation(wire.Pulse(width=0.01, period=0.05)), 0.05),
    (Modulation("impulsive"), 0.25),
    (Modulation(wire.Preset(name="rapturous")), 1.5),
    (Modulation("buzzing"), 0.004),
    (Modulation(wire.STEADY, wire.AM(frequency=150.0, depth=0.7)), 1.0 / 150.0),
    (Modulation(wire.Sine(frequency=40.0), wire.AM(frequency=150.0)), 0.1),
]


def strength(modulation: Modulation, times: np.ndarray) -> np.ndarray:
    envelope = resolve(envelope_to_scene(modulation.envelope))
    technique = technique_to_scene(modulation.technique or wire.Simultaneous())
    return np.clip(envelope.at(times) * technique.factor(times), 0.0, 1.0)


@pytest.mark.parametrize(("modulation", "period"), PERIODIC)
def test_the_mean_strength_is_that_of_whole_periods(modulation: Modulation, period: float) -> None:
    shares = share_time(TIMES, [modulation, HAND])
    mean = strength(modulation, np.arange(10_000) / 10_000 * period).mean()
    assert (shares >= 0.0).all()
    assert shares.sum() == pytest.approx(1.0)
    assert shares @ strength(modulation, TIMES) == pytest.approx(mean, rel=1e-3)
    plain = strength(modulation, TIMES).mean()
    assert abs(plain - mean) > 5e-3 * mean  # equal shares would be wrong


def test_several_modulations_are_exact_at_once_and_parts_have_equal_shares() -> None:
    modulations = [modulation for modulation, _ in PERIODIC[:3]]
    parts = np.arange(60) % 7 // 5  # the second part has few frames
    shares = share_time(TIMES, modulations, parts)
    for modulation, period in PERIODIC[:3]:
        mean = strength(modulation, np.arange(10_000) / 10_000 * period).mean()
        assert shares @ strength(modulation, TIMES) == pytest.approx(mean, rel=1e-3)
    assert shares[parts == 1].sum() == pytest.approx(0.5)


def test_noise_has_the_mean_of_the_time_that_is_seen() -> None:
    noise = Modulation(wire.Noise(low_frequency=20.0, high_frequency=60.0))
    shares = share_time(TIMES, [noise])
    mean = strength(noise, np.linspace(TIMES.min(), TIMES.max(), 10_000)).mean()
    assert shares @ strength(noise, TIMES) == pytest.approx(mean, rel=2e-3)


def test_times_that_lie_far_apart_need_no_more_work() -> None:
    """Times lie far apart after a restart of the renderer. Sampling ten days each 0.5 ms would need 14 GB."""
    noise = Modulation(wire.Noise(low_frequency=20.0, high_frequency=60.0))
    shares = share_time(np.array([0.0, 1e6]), [noise])
    assert shares.sum() == pytest.approx(1.0)


def test_a_focus_that_moves_has_the_mean_of_its_path() -> None:
    shares = share_time(TIMES, [Modulation(wire.STEADY, wire.STM(frequency=70.0))])
    place = TIMES * 70.0 % 1.0
    near = np.exp(-0.5 * ((place - 0.5) / 0.1) ** 2)  # pressure at one point of the path
    mean = 0.1 * np.sqrt(2.0 * np.pi)
    assert shares @ near == pytest.approx(mean, rel=0.03)
    assert abs(near.mean() - mean) > 0.05 * mean


def test_frames_that_show_less_than_a_period_have_equal_shares() -> None:
    shares = share_time(TIMES, [Modulation(wire.STEADY, wire.STM(frequency=0.5))])
    assert shares == pytest.approx(np.full(60, 1.0 / 60.0))
    assert share_time(TIMES[:1], [PERIODIC[0][0]]) == pytest.approx([1.0])
