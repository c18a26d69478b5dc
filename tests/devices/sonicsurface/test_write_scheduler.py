"""The newest pattern goes out as soon as the line is free, and none waits behind it."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian_plugins.backends.sonicsurface.protocol import BYTE, SELECT
from pacinian_plugins.backends.sonicsurface.write_scheduler import REPEAT_INTERVAL, WriteScheduler

from .fpga import Board

FRAME = 258 * BYTE  # [s]
TICK = 1e-3


def pattern(kind: int) -> bytes:
    return bytes([kind]) * 256


def test_a_line_has_time_for_89_patterns_a_second_and_takes_the_newest() -> None:
    feed, shown = WriteScheduler(1, SELECT), []
    for k in range(1000):
        feed.newest = bytes([k % 31]) + pattern(k // 31)[1:]
        if data := feed.next(k * TICK):
            assert data[1:-1] == feed.newest  # of this tick
            shown.append(k)
    assert 83 <= len(shown) <= 89
    assert all(12 <= b - a <= 13 for a, b in pairwise(shown))


def test_two_patterns_that_alternate_take_a_byte_each() -> None:
    feed, board = WriteScheduler(1, SELECT), Board()
    now = 0.0
    for kind in (1, 32):
        feed.newest = pattern(kind)
        board.take(feed.next(now))
        now += 0.02
    for k in range(100):
        kind = (1, 32)[k % 2]
        feed.newest = pattern(kind)
        data = feed.next(now)
        assert data == b"\xfd"
        board.take(data)
        assert (board.heard == kind).all()
        now += TICK


def test_what_stays_is_written_again_now_and_then() -> None:
    feed = WriteScheduler(1, SELECT)
    feed.newest = pattern(3)
    sizes = [len(feed.next(k * TICK)) for k in range(2000)]
    assert [k for k, size in enumerate(sizes) if size] == [0, 500, 1000, 1500]
    assert set(sizes) == {0, 258}
    assert feed.due == 1.5 + REPEAT_INTERVAL


def test_silence_does_not_wait_for_the_line_and_is_written_in_full() -> None:
    feed, board = WriteScheduler(1, SELECT), Board()
    now = 0.0
    for kind in (32, 1):  # so that a swap would do, if nothing was lost
        feed.newest = pattern(kind)
        board.take(feed.next(now))
        now += 0.02
    feed.newest = pattern(2)
    under_way = feed.next(now)
    feed.off()
    feed.newest = pattern(32)
    data = feed.next(now + TICK)
    assert data == b"\xfe" + pattern(32) + b"\xfd"
    board.take(under_way[:20] + data)  # the system has dropped the rest
    assert not board.pulses().any()
    assert abs(feed.free - (now + 2 * FRAME)) < 1e-9
    feed.newest = pattern(1)  # what the buffers hold is not relied on
    assert len(feed.next(feed.free)) == 258


def test_after_a_silence_no_swap_is_relied_on() -> None:
    feed, now = WriteScheduler(1, SELECT), 0.0
    for kind in (1, 2):
        feed.newest = pattern(kind)
        feed.next(now)
        now += 0.02
    feed.off()
    feed.next(now)  # it may have cut what was under way, which is not heard then
    feed.newest = pattern(2)
    assert len(feed.next(now + 0.02)) == 258


def test_nothing_is_shown_before_something_is_given_and_after_it_is_forgotten() -> None:
    feed = WriteScheduler(1, SELECT)
    assert feed.next(5.0) == b""
    feed.newest = pattern(1)
    assert feed.next(6.0)
    feed.forget()
    assert feed.next(9.0) == b""
    feed.newest = pattern(1)
    assert len(feed.next(9.1)) == 258


@settings(max_examples=60)
@given(st.lists(st.tuples(st.integers(0, 3), st.integers(1, 30)), max_size=40), st.booleans())
def test_a_board_shows_one_of_what_was_given_and_at_last_the_newest(
    scene: list[tuple[int, int]], two: bool
) -> None:
    kinds = (1, 2, 7, 32)
    feed = WriteScheduler(1 + two, SELECT)
    boards = [Board(), Board(secondary=True)][: 1 + two]
    feed.off()
    scene = [(3, 30), *scene, (scene[-1][0] if scene else 3, 60)]
    now, wire, line = 0.0, b"", 0.0
    for kind, ticks in scene:
        feed.newest = pattern(kinds[kind]) * (1 + two)
        for _ in range(ticks):
            if data := feed.next(now):
                assert not wire, "a frame waits behind another"
                wire, line = data, now
            arrived = int((now + TICK - line) / BYTE) if wire else 0
            for board in boards:
                board.take(wire[:arrived])
            wire, line = wire[arrived:], line + arrived * BYTE
            now += TICK
            shown = {int(board.heard[0]) for board in boards}
            assert len(shown) == 1
            assert all((board.heard == board.heard[0]).all() for board in boards)
    assert shown == {kinds[scene[-1][0]]}
