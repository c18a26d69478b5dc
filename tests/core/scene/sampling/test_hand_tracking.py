from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.scene.hands.hand import Hand
from pacinian.scene.sampling.hand_tracking import HOLD_TIME, LOST_HAND_FADE_TIME, HandTrack
from pacinian.scene.sampling.pose_prediction import BLEND_TIME, MAX_BLENDED_ERROR

bounded = settings(max_examples=60)
TICK = 0.001
NOWHERE = np.full((26, 3), np.nan)


def moved(x: float, **given: Any) -> Hand:
    return Hand.open("right", pc.Pose((x, 0.0, 0.2)), **given)


def lost(**given: Any) -> Hand:
    return Hand(NOWHERE, side="right", **given)


def palm(track: HandTrack, hand: Hand, t: float) -> float:
    """Return the palm's x [m]."""
    now, _ = track.update(hand, t)
    assert now is not None
    assert now.joints is not None
    return float(now.joints[0, 0])


@given(
    steps=st.lists(
        st.tuples(st.integers(0, 30), st.floats(-0.02, 0.02), st.floats(-1.0, 1.0)),
        min_size=1,
        max_size=6,
    )
)
@bounded
def test_no_update_makes_a_hand_jump(steps: Any) -> None:
    track, t, hand = HandTrack(), 0.0, moved(0.0)
    x = palm(track, hand, t)
    for ticks, d, v in steps:
        for _ in range(ticks + 1):
            t += TICK
            now = palm(track, hand, t)
            assert abs(now - x) <= (1.0 + MAX_BLENDED_ERROR / BLEND_TIME) * TICK
            x = now
        hand = moved(x + d, velocities=(v, 0.0, 0.0), time=t)
        assert palm(track, hand, t) == pytest.approx(x, abs=1e-12)


def test_a_hand_is_carried_on_by_its_velocities() -> None:
    track, hand = HandTrack(), moved(0.0, velocities=(0.4, 0.0, 0.0), time=1.0)
    for t in (1.0, 1.01, 1.03):
        assert palm(track, hand, t) == pytest.approx(0.4 * (t - 1.0))
    assert palm(track, hand, 1.08) == pytest.approx(0.4 * HOLD_TIME)


def test_a_late_hand_is_where_it_must_be_by_now() -> None:
    hand = moved(0.0, velocities=(0.4, 0.0, 0.0), time=0.98)
    assert palm(HandTrack(), hand, 1.0) == pytest.approx(0.008)


def test_a_hand_that_teleports_is_there_at_once() -> None:
    track = HandTrack()
    palm(track, moved(0.0), 0.0)
    assert palm(track, moved(1.1 * MAX_BLENDED_ERROR), TICK) == pytest.approx(
        1.1 * MAX_BLENDED_ERROR
    )


@pytest.mark.parametrize("timed", [False, True])
def test_a_lost_hand_stays_and_then_fades(timed: bool) -> None:
    track = HandTrack()
    x = palm(track, moved(0.0, time=0.5 if timed else None), 0.5)
    gone, shares = lost(), []
    for t in np.arange(0.5, 0.5 + HOLD_TIME + LOST_HAND_FADE_TIME + 0.02, TICK):
        now, share = track.update(gone, t)
        shares.append(share)
        if now is None:
            assert share == 0.0
        else:
            assert now.joints is not None
            assert now.joints[0, 0] == x
    held = round(HOLD_TIME / TICK)
    assert shares[:held] == [1.0] * held
    assert np.diff(shares).min() >= -TICK / LOST_HAND_FADE_TIME - 1e-9
    assert (np.diff(shares) <= 0.0).all()
    assert shares[-1] == 0.0
    assert not track.can_move(1.0)


def test_a_hand_that_stayed_long_before_it_was_lost_stays_as_long() -> None:
    track = HandTrack()
    palm(track, moved(0.0), 0.0)  # then no call, because nothing changed
    assert track.update(lost(), 10.0)[1] == 1.0
    assert track.update(lost(), 10.0 + 0.9 * HOLD_TIME)[1] == 1.0
    assert track.update(lost(), 10.0 + HOLD_TIME + LOST_HAND_FADE_TIME / 2.0)[1] == pytest.approx(
        0.5
    )
    assert track.update(lost(), 10.0 + HOLD_TIME + LOST_HAND_FADE_TIME + TICK)[0] is None


def test_a_hand_that_is_lost_for_one_frame_stays() -> None:
    track, v = HandTrack(), 0.3
    hands = [moved(v * 0.01 * i, velocities=(v, 0, 0), time=0.01 * i) for i in range(5)]
    hands[2] = lost(time=0.02)
    for i, hand in enumerate(hands):
        for t in 0.01 * i + TICK * np.arange(10):
            now, share = track.update(hand, t)
            assert share == 1.0
            assert now is not None
            assert now.joints is not None
            assert now.joints[0, 0] == pytest.approx(v * t, abs=1e-9)


def test_a_hand_whose_updates_stop_coming_fades_too() -> None:
    track, hand = HandTrack(), moved(0.0, time=1.0)
    assert track.update(hand, 1.0 + 0.9 * HOLD_TIME)[1] == 1.0
    assert 0.0 < track.update(hand, 1.0 + HOLD_TIME + LOST_HAND_FADE_TIME / 2.0)[1] < 1.0
    assert track.update(hand, 1.0 + HOLD_TIME + LOST_HAND_FADE_TIME + TICK) == (None, 0.0)


def test_a_hand_without_a_time_stays_for_ever() -> None:
    track, hand = HandTrack(), moved(0.0)
    assert track.update(hand, 0.0) == track.update(hand, 1e6) == (hand, 1.0)
    assert not track.can_move(1e6)


def test_a_hand_that_comes_back_is_where_it_is() -> None:
    track = HandTrack()
    palm(track, moved(0.0), 0.0)
    assert track.update(lost(), 1.0)[1] == 1.0
    assert track.update(lost(), 2.0) == (None, 0.0)
    assert palm(track, moved(0.01), 2.001) == pytest.approx(0.01)


def test_a_hand_that_was_never_seen_is_not_there() -> None:
    assert HandTrack().update(lost(), 0.0) == (None, 0.0)


@given(times=st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=12), d=st.floats(-0.03, 0.03))
@bounded
def test_whatever_time_does_a_hand_is_between_where_it_was_and_is(times: Any, d: float) -> None:
    track = HandTrack()
    palm(track, moved(0.0), 0.0)
    hand = moved(d)
    for t in (0.0, *times):
        assert min(0.0, d) - 1e-12 <= palm(track, hand, t) <= max(0.0, d) + 1e-12


def test_after_time_jumped_back_a_lost_hand_fades_all_the_same() -> None:
    track = HandTrack()
    palm(track, moved(0.0), 1e6)
    assert track.update(lost(), 5.0)[1] == 1.0
    assert track.update(lost(), 5.0 + HOLD_TIME + LOST_HAND_FADE_TIME + TICK)[0] is None


def test_a_hand_given_as_a_mesh_does_not_jump_either() -> None:
    box = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * [0.08, 0.18, 0.03]
    faces = [[0, 1, 2], [2, 1, 3], [4, 6, 5], [6, 7, 5]]
    track = HandTrack()
    track.update(Hand(vertices=box, faces=faces), 0.0)
    hand = Hand(vertices=box + 0.01, faces=faces)
    for t, share in ((TICK, 1.0), (TICK + BLEND_TIME / 2.0, 0.5), (TICK + BLEND_TIME, 0.0)):
        now, _ = track.update(hand, t)
        assert now is not None
        assert now.vertices == pytest.approx(box + 0.01 * (1.0 - share))


def test_a_hand_that_does_not_move_keeps_its_skin_where_it_is() -> None:
    track, hand = HandTrack(), moved(0.0)
    now, _ = track.update(hand, 0.0)
    assert now is not None
    first = track.pose_skin(now)
    assert track.pose_skin(now) is first
    after, _ = track.update(moved(0.01), TICK)
    assert after is not None
    assert track.pose_skin(after).skin is first.skin
