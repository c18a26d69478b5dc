"""The server's benchmarks with a real one, for a moment: nothing here depends on how long anything takes."""

from __future__ import annotations

from collections import Counter
from contextlib import closing
from functools import partial
from typing import Any

import numpy as np
import pytest
import zmq
from msgspec.structs import replace

import pacinian as pc
from pacinian.scene.config_sections import Units
from pacinian.serving.settings import Log, Safety, Settings
from pacinian.testing import run_server
from pacinian_lab.server import latency, load, soak, soak_game
from pacinian_lab.server.load import Final, Row
from pacinian_lab.server.soak_game import Game, Play

pytestmark = pytest.mark.deep
PATIENT = Safety(lease=10.0, frame_timeout=1.0, hang_timeout=60.0, session_timeout=3600.0)


def test_hands_arrive_and_are_timed_in_order(monkeypatch: pytest.MonkeyPatch) -> None:
    given = replace(latency.settings(1), safety=PATIENT)
    monkeypatch.setattr(latency, "settings", lambda side: given)
    runs: Any = latency.measure(1, 0.5, rates=(90.0,) * 10)
    with closing(runs):  # once more where the machine stood still meanwhile
        times = next(times for times in runs if times.reached and times.sounding > 0.0)
    assert times.sent == 45
    assert times.reached <= times.sent
    assert times.echo.count == times.sent
    assert times.samples[1] > 0
    for one in (times.alone, times.echo, times.bus, times.loop, times.whole):
        assert 0.0 < one.p50 <= one.p99 <= one.p999 <= one.most
    assert times.whole.most <= times.bus.most + times.loop.most + 1e-9


def test_what_clients_put_last_is_felt(monkeypatch: pytest.MonkeyPatch) -> None:
    given = replace(load.settings(1), safety=PATIENT)
    monkeypatch.setattr(load, "settings", lambda side: given)
    *rows, final = load.measure(1, 0.5, 3, rates=(0.0, 300.0))
    assert isinstance(final, Final)
    assert not final.missing
    assert final.known == final.objects == 16
    assert final.received == final.sent
    quiet, busy = rows
    assert isinstance(quiet, Row)
    assert isinstance(busy, Row)
    assert quiet.sent == 0.0
    assert busy.seen.backwards == 0
    assert np.isfinite(busy.memory).all()
    assert busy.cpu.keys() == {"control", "bus", "render", "guard"}


def test_all_that_may_happen_in_a_soak_happens_and_nothing_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(soak_game, "Client", partial(pc.Client, timeout=60.0))
    settings = Settings(array=Units(1, 1), log=Log(level="error"), safety=PATIENT)
    context, events = zmq.Context[Any](), Counter[str]()
    with run_server(settings) as server:
        play = Game(context, Play(str(server.connection), beat=0.0))
        while play.count < 40:
            events.update(play.window(soak_game.Window(0.1)).events)
        heard = play.window(soak_game.Window(0.1))
        play.close()
    context.term()
    kinds = [
        "come_and_go",
        "wrap",
        "swap",
        "join_or_leave",
        "nonsense",
        "dim",
        "pause",
        "emergency",
    ]
    assert {kind for kind in kinds if events[kind] > 0} == set(kinds)
    bad = {name for name in events if name.startswith(("refused", "lost"))}
    # where the machine stood still, a command may be older than its time to live
    assert not bad - {"refused: stale"}
    assert heard.faults == heard.restarts == 0


def test_a_soak_tells_of_each_process_in_each_window(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(soak, "Settings", partial(Settings, safety=PATIENT))
    rows = list(soak.measure(1, 2.0))
    assert len(rows) == 4
    assert [row.t for row in rows] == sorted(row.t for row in rows)
    for row in rows:
        assert row.memory.keys() == row.files.keys() == {"control", "bus", "render", "guard"}
        assert 0.0 <= row.heard.sounding <= 1.0
