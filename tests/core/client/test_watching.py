"""The newest state and the server's clock; a server that is stopped."""

import signal
import sys
import time
from collections.abc import Iterator
from itertools import count

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.client.timing import Timing, Trips
from pacinian.wire.codec import encode
from pacinian.wire.state import STATE

from .fake import Fake, state
from .standing import server_apart, stand_still

SECONDS = st.floats(0.0, 1.0)


@pytest.fixture
def server() -> Iterator[Fake]:
    with Fake() as fake:
        yield fake


@pytest.fixture
def client(server: Fake) -> Iterator[pc.Client]:
    with pc.Client(server.connection) as made:
        made.look()  # it is subscribed from the first look on
        numbers = count(-1, -1)
        server.until(lambda: server.publish(state(next(numbers))) or made.look() is not None)  # type: ignore[func-returns-value]
        yield made


def test_of_many_the_newest_is_seen(server: Fake, client: pc.Client) -> None:
    server.publish(*(state(i) for i in range(1, 9)))
    server.until(lambda: (seen := client.look()) is not None and seen.sequence == 8)
    assert client.look() is None
    for turn in range(3):
        server.publish(*(state(10 * turn + i) for i in range(10, 18)))
        seen = next(client.watch(5.0))
        assert seen.sequence >= 10 * turn + 10
        assert client.age(seen) < 5.0
        while seen.sequence < 10 * turn + 17:  # else the next turn may find one of these
            seen = next(client.watch(5.0))


def test_a_reader_that_slept_finds_the_newest_not_the_oldest(
    server: Fake, client: pc.Client
) -> None:
    """C6: kernel buffers hold thousands of old ones, whatever the high-water mark."""
    pad = "x" * 200
    given = [
        encode(state(i, time=time.perf_counter() - 10.0, faults=(pad,) * 5)) for i in range(1, 5001)
    ]
    for i in range(0, 5000, 100):
        server.do(
            lambda i=i: [server._sockets[2].send_multipart([STATE, d]) for d in given[i : i + 100]]  # type: ignore[misc]
        )
    got = [seen.sequence] if (seen := client.look()) else []
    end = time.monotonic() + 20.0
    while not got or got[-1] < 6000:
        assert time.monotonic() < end, got
        server.publish(state(6000))
        got += [seen.sequence] if (seen := client.look()) else []
    assert got == sorted(got)
    assert len(got) < 100


def test_a_steady_stream_is_seen_fresh_by_a_slow_reader(server: Fake, client: pc.Client) -> None:
    ages: list[float] = []
    end = time.monotonic() + 20.0
    while len(ages) < 60:
        assert time.monotonic() < end, ages
        server.publish(*(state(1) for _ in range(10)))
        ages += [client.age(seen)] if (seen := client.look()) else []
    assert np.median(ages) < 0.05


def test_no_state_in_time_is_a_loss(client: pc.Client) -> None:
    with pytest.raises(pc.ConnectionLost, match=r"no state within 0.01 s"):
        for _ in client.watch(0.01):
            pass  # what was published before may still come
    assert not client.connected


@given(st.floats(-1e6, 1e6), st.lists(st.tuples(SECONDS, SECONDS), min_size=1, max_size=100))
def test_the_servers_clock_is_known_to_half_of_the_shortest_trip(
    offset: float, ways: list[tuple[float, float]]
) -> None:
    timing, now = Timing(), 0.0
    for there, back in ways:
        timing.clocked(now, now + there + back, now + there + offset)
        now += 1.0
    shortest = min(sum(way) for way in ways[-64:])
    assert abs(timing.offset - offset) <= shortest / 2.0 + 1e-9 * (1.0 + abs(offset))
    assert timing.age(now + offset, now + 5.0) == pytest.approx(5.0, abs=shortest + 1e-6)


@given(st.lists(SECONDS, max_size=300))
def test_round_trips_in_order(trips: list[float]) -> None:
    timing = Timing()
    for trip in trips:
        timing.answered(0.0, trip)
    told = timing.trips
    if not trips:
        assert told == Trips()
    else:
        assert told.longest == max(trips)
        assert sorted(told) == list(told)
        assert told.median == np.quantile(trips, 0.5, method="inverted_cdf")


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGSTOP")
def test_a_server_that_is_stopped_is_lost_by_its_heartbeat() -> None:
    with server_apart() as (process, connection), pc.Client(connection, timeout=60.0) as client:
        client.arm()
        process.send_signal(signal.SIGSTOP)
        begin = time.monotonic()
        with pytest.raises(pc.ConnectionLost, match="has gone"):
            client.hold(30.0, every=0.02)
        assert time.monotonic() - begin < 20.0
        with pytest.raises(pc.ConnectionLost):
            client.renew()


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGSTOP")
def test_a_server_that_stands_still_for_a_moment_is_not_lost() -> None:
    with server_apart() as (process, connection), pc.Client(connection, timeout=60.0) as client:
        client.arm()
        stand_still(process)
        client.hold(0.2, every=0.02)
        assert client.armed
