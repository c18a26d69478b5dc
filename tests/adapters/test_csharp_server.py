"""The client in C# and a real server: what is felt, and when there is silence."""

from __future__ import annotations

import signal
import time
from typing import TYPE_CHECKING

import pytest

from pacinian.bench.faults.server import Server

from .game import HELD, LEASE, free
from .silence import heard, silent

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from .game import Game

LATE = 0.15  # [s] after the lease, where two processors are shared by many


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with Server(tmp_path_factory.mktemp("server"), HELD) as made:
        yield made


@pytest.fixture
def game(
    real: Server, start: Callable[..., Game], request: pytest.FixtureRequest
) -> Iterator[Game]:
    """One whose ball sounds. Its parameter: the lease that it asks for [s]."""
    free(real.file)
    with start(real.file, getattr(request, "param", 0.0)) as made:
        made.do("start")
        made.event("connected")
        sound(made)
        yield made


def sound(game: Game) -> None:
    """Put a ball and arm, until it sounds."""
    game.do("put ball 0 0.01 0.2 20")
    game.do("arm")
    game.sounding(lambda s: s["objects"] == 1)


def test_what_is_done_is_felt(game: Game) -> None:
    game.do("field at 0 0.01 0.2")
    assert game.wait(lambda told: "field" in told)["field"] == 1
    game.do("solver gs")
    game.until(lambda s: s["solver"] == "gs")
    game.do("backend probe-other")
    game.until(lambda s: s["backend"] == "probe-other" and s["output"] == "sounding")
    game.do("backend probe")
    game.do("intensity 0.5")
    game.until(lambda s: s["intensity"] == 0.5 and s["backend"] == "probe")
    game.do("put bad 0 0 0.2 100000")
    assert game.event("refused", "limit")["path"] == "$.objects[bad].radiation_pressure"
    game.do("solver none-such")
    game.event("refused", "unknown")
    game.do("wave on")
    game.until(lambda s: s["hands"] == 1 and s["objects"] == 1)
    game.do("lose")
    game.until(lambda s: s["hands"] == 0 and s["objects"] == 0)
    game.do("wave on")
    game.until(lambda s: s["objects"] == 1)
    game.do("remove ball")
    game.until(lambda s: s["objects"] == 0)
    game.do("intensity 1")
    game.do("disarm")
    status = game.until(lambda s: not s["armed"] and s["output"] == "silent")
    assert 0.0 <= status["latency"] < LEASE
    assert 0.0 <= status["age"] < 1.0


@pytest.mark.parametrize("game", [LEASE], indirect=True)
def test_a_frozen_game_is_silent_when_its_lease_is_over(real: Server, game: Game) -> None:
    game.say("freeze 1.2")
    since = time.perf_counter()
    assert silent(real, since) - since < LEASE + LATE
    told = game.event("ended", "expired")
    assert "arm again" in told["advice"]
    assert not game.until(lambda s: s["output"] == "silent")["armed"]
    mark = real.log.count
    game.do("move ball 0 0.01 0.21")
    game.do("field at 0 0 0.2")
    game.wait(lambda told: "field" in told)
    assert not heard(real, mark)  # nothing resumes by itself
    game.sounding()


def test_a_killed_game_is_silent(real: Server, game: Game) -> None:
    since = time.perf_counter()
    game.kill()
    assert silent(real, since) - since < LEASE + LATE


def test_a_game_that_ends_is_silent(real: Server, game: Game) -> None:
    since = time.perf_counter()
    game.do("dispose")
    assert silent(real, since) - since < LEASE
    assert game.end() == 0


def test_a_stop_from_a_game_without_a_session(
    real: Server, game: Game, start: Callable[..., Game]
) -> None:
    with start(real.file) as other:
        since = time.perf_counter()
        other.do("stop")
        assert silent(real, since) - since < LEASE + LATE
        assert other.status()["status"] == "Stopped"
    game.event("ended", "stopped")
    game.do("arm")
    assert game.event("refused", "stopped")["advice"] == "reset first"
    game.do("stop")
    game.do("reset")  # after the stop, however slow that is
    game.do("arm")
    game.until(lambda s: s["output"] == "sounding")


def test_a_server_that_is_killed_and_started_again(real: Server, game: Game) -> None:
    real.signal("control", signal.SIGKILL)
    assert "nothing of this session goes on" in game.event("lost")["message"]
    for i in range(20):
        assert not game.do(f"put ball{i} 0 0.01 0.2 20")["done"]
    assert not game.do("arm")["done"]
    end = time.monotonic() + 20.0
    while real.left():
        assert time.monotonic() < end
        time.sleep(0.01)  # until all of it has ended
    mark = real.log.count
    real.start()
    game.event("connected")
    status = game.until(lambda s: s["objects"] == 0)  # which a state of the new one says
    assert (status["armed"], status["output"]) == (False, "silent")
    assert not heard(real, mark)
    sound(game)
