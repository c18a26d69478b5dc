"""Which of the last frames count for the mean of the field."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pacinian.viewing.recent_frames import MAX_FRAMES, MODULATED_SPAN, MOVING_SPAN, RecentFrames
from pacinian.wire.modulation import AM, Pulse, Sine
from pacinian.wire.objects import Point

EVERY = 1.0 / 60.0
FRAME_COUNT = min(MAX_FRAMES, int(MODULATED_SPAN / EVERY) + 1)
STEADY_POINT = Point(position=(0.0, 0.0, 0.1), radiation_pressure=1.0)
MODULATED_POINT = Point(
    position=(0.0, 0.0, 0.1), radiation_pressure=1.0, technique=AM(frequency=200.0)
)


def frame(value: float) -> bytes:
    return np.full(3, value, np.complex64).tobytes()


def filled(count: int = 120) -> RecentFrames:
    recent = RecentFrames()
    for k in range(count):
        recent.add(k * EVERY, frame(k))
    return recent


def values(recent: RecentFrames) -> list[float]:
    gains, shares = recent.gains()
    assert len(gains) == 24 * len(shares)
    assert not shares or abs(sum(shares) - 1.0) < 1e-9
    return [float(value) for value in np.frombuffer(gains, np.complex64)[::3].real]


def test_frames_of_the_last_moments_count_and_equal_ones_are_one() -> None:
    assert RecentFrames().gains() == (b"", ())
    recent = filled()
    assert values(recent) == [119.0]  # no frame repeats, so all but the newest are transitions
    recent.see_state(0.0, "am", b"")
    found = values(recent)
    assert found == [float(k) for k in range(120 - len(found), 120)]
    recent = RecentFrames()
    for k in range(10):
        recent.add(k * EVERY, frame(7.0))
    assert values(recent) == [7.0]


def test_frames_of_a_cycle_have_one_share_each_and_those_of_a_modulation_as_they_are_seen() -> None:
    recent = RecentFrames()
    for k in range(9):
        recent.add(k * EVERY, frame(1.0 if k % 3 else 2.0))
    assert recent.gains()[1] == (0.5, 0.5)
    recent.see_state(9 * EVERY, "am", b"")
    assert values(recent) == [2.0, 1.0]
    assert recent.gains()[1] == pytest.approx((3 / 9, 6 / 9))


def test_all_frames_of_a_cycle_count_while_it_moves() -> None:
    recent = RecentFrames()
    for k in range(40):  # all frames differ
        recent.add(k * EVERY, frame(k), scene_time=k * EVERY, part=k % 3, parts=3)
    assert values(recent) == [37.0, 38.0, 39.0]
    recent.add(40 * EVERY, b"", parts=3)
    assert values(recent) == []
    recent.add(41 * EVERY, frame(41.0), parts=1)
    assert values(recent) == [41.0]


def test_the_mean_of_a_modulation_is_exact_if_times_in_the_scene_are_known() -> None:
    for item, technique, presentation in (
        (MODULATED_POINT, "", None),
        (STEADY_POINT, "am", AM(frequency=200.0)),
    ):
        recent = RecentFrames()
        recent.see_scene(0.0, {"spot": item}, {"spot": bytes(28)})
        recent.see_state(0.0, technique, b"", presentation)
        pressure = []
        for k in range(60):
            time = k * EVERY + 0.004 * (k * 0.618 % 1.0)
            pressure.append(0.5 - 0.5 * np.cos(2.0 * np.pi * 200.0 * time))
            recent.add(k * EVERY, frame(np.sqrt(pressure[-1])), scene_time=time, parts=1)
        gains, shares = recent.gains()
        amplitudes = np.abs(np.frombuffer(gains, np.complex64)[::3])
        assert np.array(shares) @ amplitudes**2 == pytest.approx(0.5, rel=1e-3)
        assert abs(np.mean(pressure) - 0.5) > 0.005


def test_silence_counts_while_others_sound_and_is_silence_alone() -> None:
    recent = RecentFrames()
    for k in range(4):
        recent.add(k * EVERY, frame(5.0) if k % 2 else b"")
    assert values(recent) == [5.0]  # silence is a gap, not part of a cycle
    recent.see_state(4 * EVERY, "am", b"")
    assert values(recent) == [0.0, 5.0]
    for k in range(4, 90):
        recent.add(k * EVERY, b"")
    assert recent.gains() == (b"", ())


def test_the_mean_of_what_moves_is_short() -> None:
    hands = np.zeros(78, "<f4")
    for technique, item, counts in (
        ("am", STEADY_POINT, int(MOVING_SPAN / EVERY) + 1),
        ("simultaneous", MODULATED_POINT, int(MOVING_SPAN / EVERY) + 1),
    ):
        recent = filled()
        now = 119 * EVERY
        recent.see_scene(0.0, {"spot": item}, {"spot": bytes(28)})
        recent.see_state(0.0, technique, hands.tobytes())
        assert abs(len(values(recent)) - FRAME_COUNT) <= 1
        recent.see_state(now, technique, (hands + np.float32(1e-4)).tobytes())  # noise of a tracker
        assert abs(len(values(recent)) - FRAME_COUNT) <= 1
        recent.see_state(now, technique, (hands + np.float32(0.01)).tobytes())
        assert len(values(recent)) == counts


def test_a_recording_that_goes_back_begins_anew() -> None:
    recent = filled()
    recent.add(0.0, frame(-1.0))
    assert values(recent) == [-1.0]


def test_the_strength_of_an_object_is_its_mean_over_the_modulation() -> None:
    def point(**options: Any) -> Point:
        return Point(position=(0.0, 0.0, 0.1), radiation_pressure=1.0, **options)

    objects = {
        "steady": STEADY_POINT,
        "modulated": MODULATED_POINT,
        "sine": point(envelope=Sine(frequency=150.0)),
        "pulse": point(envelope=Pulse(width=0.1, period=0.4)),
    }
    poses = dict.fromkeys(objects, bytes(28))
    recent = RecentFrames()
    recent.see_scene(0.0, objects, poses)
    names = [*objects, "gone"]
    found = dict(zip(names, recent.find_strengths(names), strict=True))
    assert found["steady"] == found["gone"] == 1.0
    assert found["modulated"] == pytest.approx(0.5, abs=1e-3)
    assert found["sine"] == pytest.approx(0.5, abs=1e-3)
    assert found["pulse"] == pytest.approx(0.25, abs=1e-2)
    recent.see_state(0.0, "am", b"", AM(frequency=200.0))
    found = dict(zip(names, recent.find_strengths(names), strict=True))
    assert found["steady"] == pytest.approx(0.5, abs=1e-3)
