"""The server's benchmarks with a real one, for a moment: nothing here depends on how long anything takes."""

from __future__ import annotations

import numpy as np

from pacinian.bench.bus import latency, load
from pacinian.bench.bus.load import Final, Row


def test_hands_arrive_and_are_timed_in_order() -> None:
    (times,) = latency.measure(1, 0.5, rates=(90.0,))
    assert times.sent == 45
    assert 0 < times.reached <= times.sent
    assert times.echo.count == times.sent
    assert times.samples[1] > 0
    assert times.sounding > 0.0
    for one in (times.alone, times.echo, times.bus, times.loop, times.whole):
        assert 0.0 < one.p50 <= one.p99 <= one.p999 <= one.most
    assert times.whole.most <= times.bus.most + times.loop.most + 1e-9


def test_what_clients_put_last_is_felt() -> None:
    *rows, final = load.measure(1, 0.5, 3, rates=(0.0, 300.0))
    assert isinstance(final, Final)
    assert not final.missing
    assert final.known == final.objects == 16
    assert final.errors == 0  # of a client's moves that come together the newest is done
    assert not final.refused
    assert final.received == final.sent
    quiet, busy = rows
    assert isinstance(quiet, Row)
    assert isinstance(busy, Row)
    assert quiet.sent == 0.0
    assert busy.sent > 0.0
    assert busy.seen.backwards == 0
    assert busy.seen.ping.count > 0
    assert busy.seen.samples == 16
    assert np.isfinite(busy.memory).all()
    assert busy.cpu.keys() == {"control", "bus", "render", "guard"}
