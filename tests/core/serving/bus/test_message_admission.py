from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.serving.ipc.rate_limit import ERROR_RATE, PeerRateLimiter
from pacinian.wire.replies import Error

from ..fake_renderer import client, move

bounded = settings(max_examples=100)


@bounded
@given(st.lists(st.integers(1, 30), max_size=60))
def test_each_sequence_number_is_taken_once_and_only_upwards(numbers: list[int]) -> None:
    who, highest = client(), 0
    for i, number in enumerate(numbers):
        error = who.admit(move(("a",), 0.0, sequence=number, time=float(i)), float(i))
        assert (error is None) == (number > highest)
        assert error is None or (error.code, error.path) == ("sequence", "$.sequence")
        highest = max(highest, number)
    assert who.commands == len(numbers)


def test_a_command_older_than_its_time_to_live_is_dropped_counted_and_told() -> None:
    who = client()
    assert who.admit(move(("a",), 0.0, sequence=1, time=50.0, ttl=0.5), 100.0) is None
    assert who.admit(move(("a",), 0.0, sequence=2, time=51.0, ttl=0.5), 101.5) is None
    assert who.age == pytest.approx(0.5)
    error = who.admit(move(("a",), 0.0, sequence=3, time=52.0, ttl=0.5, id=9), 102.6)
    assert error is not None
    assert (error.code, error.id, error.path) == ("stale", 9, "$.ttl")
    assert (who.commands, who.dropped) == (3, 1)
    again = who.admit(move(("a",), 0.0, sequence=3, time=53.0), 103.0)
    assert again is not None
    assert again.code == "sequence"  # its sequence counts, although it was stale


def test_ages_are_of_the_client_s_own_clock_whatever_that_shows() -> None:
    for offset in (-1e6, 0.0, 1e9):
        who = client()
        for i in range(10):
            assert who.admit(move(("a",), 0.0, sequence=i + 1, time=i + offset), 7.0 + i) is None
            assert who.age == pytest.approx(0.0, abs=1e-6)


def test_errors_are_counted_and_those_not_asked_for_are_told_now_and_then() -> None:
    who = client()
    told = [who.should_report(Error(code="stale", message=""), 0.01 * i) for i in range(1000)]
    assert ERROR_RATE <= sum(told) <= 2.0 * ERROR_RATE + 100
    assert sum(told) < 0.12 * len(told)
    assert all(who.should_report(Error(id=3, code="stale", message=""), 10.0) for _ in range(100))
    assert who.errors == 1100


def test_a_session_is_of_the_connection_that_used_it_first_and_of_its_user() -> None:
    who = client()
    assert not who.claim(b"x", "somebody else")
    assert who.claim(b"a", "pacinian")
    assert who.claim(b"a", "pacinian")
    assert not who.claim(b"b", "pacinian")


def test_connections_send_at_their_rate_and_only_so_many_are_remembered() -> None:
    peers = PeerRateLimiter(rate=100.0, most=10)
    sent = sum(peers.allows(b"a", 0.001 * i) for i in range(2000))
    assert 100 + 195 <= sent <= 100 + 205
    assert peers.allows(b"b", 2.0)
    for i in range(1000):
        peers.allows(str(i).encode(), 3.0)
        peers.should_report(str(i).encode(), 3.0)
    assert len(peers) == 10


def test_the_connection_that_was_silent_for_the_longest_time_is_forgotten_first() -> None:
    peers = PeerRateLimiter(rate=1.0, most=2)
    assert peers.allows(b"a", 0.0)
    assert peers.allows(b"b", 0.0)
    assert not peers.allows(b"a", 0.0)
    assert peers.allows(b"c", 0.0)  # takes the place of b
    assert not peers.allows(b"a", 0.0)
    assert peers.allows(b"b", 0.0)  # as a new connection
