"""The newest state and the server's clock; a server that is stopped."""

import signal
import sys
import time
from collections.abc import Iterator
from itertools import count

import numpy as np
import pytest
import zmq
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.client import link
from pacinian.client.server_clock import RoundTrips, ServerClock
from pacinian.client.state_subscription import MAX_READS, read_newest
from pacinian.solving.felt_figures import FeltRegion
from pacinian.wire.binary_arrays import pack
from pacinian.wire.codec import encode
from pacinian.wire.state import STATE

from ...waiting import PATIENCE
from .fake_server import Fake, state
from .long_timeouts import BEATS
from .stopped_processes import STILL, server_apart, stand_still

SECONDS = st.floats(0.0, 1.0)


@pytest.fixture
def client(server: Fake) -> Iterator[pc.Client]:
    with pc.Client(server.connection) as made:
        made.poll_state()  # it subscribes at the first `poll_state`
        numbers = count(-1, -1)
        server.until(lambda: server.publish(state(next(numbers))) or made.poll_state() is not None)  # type: ignore[func-returns-value]
        yield made


def test_of_many_the_newest_is_seen(server: Fake, client: pc.Client) -> None:
    server.publish(*(state(i) for i in range(1, 9)))
    server.until(lambda: (seen := client.poll_state()) is not None and seen.sequence == 8)
    assert client.poll_state() is None
    for turn in range(3):
        server.publish(*(state(10 * turn + i) for i in range(10, 18)))
        seen = next(client.watch(PATIENCE))
        assert seen.sequence >= 10 * turn + 10
        while seen.sequence < 10 * turn + 17:  # otherwise the next round may find one of these
            seen = next(client.watch(PATIENCE))


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
    got = [seen.sequence] if (seen := client.poll_state()) else []

    def newest_seen() -> bool:
        server.publish(state(6000))
        got.extend([seen.sequence] if (seen := client.poll_state()) else [])
        return bool(got) and got[-1] == 6000

    server.until(newest_seen)
    assert got == sorted(got)
    assert len(got) < 1000


class Stream:
    """A fake socket with endless states of a given age [s]; time passes before each."""

    def __init__(self, *ages: float) -> None:
        self.ages, self.count, self.here = ages, 0, False

    def poll(self, wait: int) -> bool:
        self.here = wait > 0 or not self.count
        return self.here

    def recv_multipart(self, flags: int = 0) -> list[bytes]:
        if not self.here:
            raise zmq.Again
        self.here, self.count = False, self.count + 1
        age = self.ages[min(self.count, len(self.ages)) - 1]
        return [STATE, encode(state(self.count, time=-age))]


@pytest.mark.parametrize(("ages", "read"), [((0.0,), 1), ((9.0, 9.0, 0.0), 3), ((9.0,), MAX_READS)])
def test_where_states_come_without_end_the_first_fresh_one_is_taken(
    ages: tuple[float, ...], read: int
) -> None:
    seen = read_newest(Stream(*ages), lambda state: -state.time)  # type: ignore[arg-type]
    assert seen is not None
    assert seen.sequence == read


def test_what_is_felt_of_regions_is_told_by_name() -> None:
    felt = pack([[np.nan] * 4, [0.5, 0.25, 0.125, 1.5]])
    told = pc.Client.decode_felt(state(output="sounding", objects=("point", "ball"), felt=felt))
    assert told == {"ball": FeltRegion(0.5, 0.25, 0.125, 1.5)}
    assert pc.Client.decode_felt(state(output="silent", objects=("point", "ball"), felt=felt)) == {}
    assert pc.Client.decode_felt(state(output="sounding")) == {}


def test_no_state_in_time_is_a_loss(client: pc.Client) -> None:
    with pytest.raises(pc.ConnectionLost, match=r"no state within 0.01 s"):
        for _ in client.watch(0.01):
            pass  # earlier states may still arrive
    assert not client.connected


@given(st.floats(-1e6, 1e6), st.lists(st.tuples(SECONDS, SECONDS), min_size=1, max_size=100))
def test_the_servers_clock_is_known_to_half_of_the_shortest_trip(
    offset: float, ways: list[tuple[float, float]]
) -> None:
    clock, now = ServerClock(), 0.0
    for there, back in ways:
        clock.add_mark(now, now + there + back, now + there + offset)
        now += 1.0
    shortest = min(sum(way) for way in ways[-64:])
    assert abs(clock.offset - offset) <= shortest / 2.0 + 1e-9 * (1.0 + abs(offset))
    assert clock.age(now + offset, now + 5.0) == pytest.approx(5.0, abs=shortest + 1e-6)


@given(st.lists(SECONDS, max_size=300))
def test_round_trips_in_order(trips: list[float]) -> None:
    clock = ServerClock()
    for trip in trips:
        clock.add_round_trip(0.0, trip)
    told = clock.round_trips
    if not trips:
        assert told == RoundTrips()
    else:
        assert told.longest == max(trips)
        assert sorted(told) == list(told)
        assert told.median == np.quantile(trips, 0.5, method="inverted_cdf")


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGSTOP")
def test_a_server_that_is_stopped_is_lost_by_its_heartbeat(monkeypatch: pytest.MonkeyPatch) -> None:
    quiet = {zmq.HEARTBEAT_TTL: 4000, zmq.HEARTBEAT_TIMEOUT: 4000}  # [ms]
    monkeypatch.setattr(link, "HEARTBEAT", BEATS | quiet)
    with server_apart() as (process, connection), pc.Client(connection, timeout=1e4) as client:
        client.arm()
        process.send_signal(signal.SIGSTOP)
        with pytest.raises(pc.ConnectionLost, match="has gone"):
            client.hold(PATIENCE, every=0.02)
        with pytest.raises(pc.ConnectionLost):
            client.renew()


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGSTOP")
def test_a_server_that_stands_still_for_a_moment_is_not_lost() -> None:
    assert min(BEATS[zmq.HEARTBEAT_TIMEOUT], BEATS[zmq.HEARTBEAT_TTL]) >= 2e3 * STILL
    with server_apart() as (process, connection), pc.Client(connection) as client:
        client.arm()
        stand_still(process)
        client.hold(0.2, every=0.02)
        assert client.armed
