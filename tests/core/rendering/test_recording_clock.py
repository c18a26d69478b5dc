from __future__ import annotations

import itertools

import pytest

from pacinian.rendering.recording_clock import RecordingClock


def recording_clock() -> RecordingClock:
    return RecordingClock(itertools.count(1.0).__next__)


def test_it_tells_the_time_and_notes_what_it_told() -> None:
    made = recording_clock()
    assert [made.now() for _ in range(3)] == [1.0, 2.0, 3.0]
    assert made.take() == [1.0, 2.0, 3.0]
    assert made.take() == []
    made.now()
    assert made.take() == [4.0]


def test_it_tells_what_was_noted_instead_and_no_more() -> None:
    made = recording_clock()
    made.tell([7.0, 5.0])
    assert [made.now(), made.now()] == [7.0, 5.0]
    with pytest.raises(LookupError, match="read more often"):
        made.now()
    made.tell([9.0])
    assert made.now() == 9.0


def test_what_is_left_untold_is_forgotten() -> None:
    made = recording_clock()
    made.tell([7.0, 5.0])
    made.now()
    made.tell([1.5])
    assert made.now() == 1.5


def test_a_replay_reads_no_clock() -> None:
    def never() -> float:
        raise AssertionError

    made = RecordingClock(never)
    made.tell([2.0])
    assert made.now() == 2.0
    assert made.take() == []


def test_time_may_stand_still_where_more_is_read_than_was_noted() -> None:
    made = RecordingClock(itertools.count(1.0).__next__, stops=True)
    made.tell([])
    with pytest.raises(LookupError, match="read more often"):
        made.now()
    made.tell([7.0, 5.0])
    assert [made.now() for _ in range(4)] == [7.0, 5.0, 5.0, 5.0]
    made.tell([])
    assert made.now() == 5.0
