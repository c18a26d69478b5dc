"""The client in C++: by itself, as the one in C# is tested, and with a real server."""

from __future__ import annotations

import inspect
import os
import signal
import time
from functools import partial
from typing import TYPE_CHECKING, Any

import pytest

from pacinian.bench.faults.server import Server
from pacinian.wire import replies

from . import test_csharp_client, test_csharp_connecting, tools
from .game import HELD, LEASE, Game, begin, free

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from ..core.client.fake import Fake

    Start = Callable[..., Game]

pytestmark = pytest.mark.timeout(tools.LIMIT)  # it is built first
PURE = "client_outbox", "client_dialogue"
ONLY = {"csharp_core", "csharp_driver"}  # what tests of nothing but C# need
OTHER = {"test_one_that_is_forgotten_says_goodbye"}  # C++ forgets nothing
RACES = "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_FLAGS=-O1 -g -fsanitize=thread", tools.JOINED
LINK, SLACK = 0.55, 1.0  # [s] to silence at most; where two processors are shared by many
SILENT = 0.5  # [s] without a frame that sounds
UNTIL = 20.0  # [s]


def shared(test: object) -> bool:
    """Whether a test is of C++, too."""
    if not inspect.isfunction(test) or not test.__name__.startswith("test_"):
        return False
    return test.__name__ not in OTHER and not ONLY & set(inspect.signature(test).parameters)


for module in (test_csharp_client, test_csharp_connecting):  # one behaviour, one set of tests
    globals().update({name: test for name, test in vars(module).items() if shared(test)})


@pytest.fixture(scope="module")
def programs() -> Path:
    return tools.release("client_answers", *PURE) / "core"


@pytest.fixture
def start(programs: Path) -> Start:
    """Starts a game, in C++."""
    return partial(begin, [programs / "client_answers"])


@pytest.fixture
def game(start: Start, file: Path) -> Iterator[Game]:
    """One that is connected."""
    with start(file) as made:
        made.do("start")
        made.event("connected")
        yield made


@pytest.mark.parametrize("name", PURE)
def test_a_program_that_tests_itself(programs: Path, name: str) -> None:
    tools.run(programs / name)


@pytest.mark.timeout(2 * tools.LIMIT)
def test_its_threads_do_not_race(server: Fake, file: Path) -> None:
    program = tools.cmake("races", ["client_answers"], *RACES) / "client_answers"
    known = f"suppressions={tools.CPP / 'tests' / 'client_libzmq.supp'}"
    environment = {**os.environ, "TSAN_OPTIONS": f"{known} exitcode=66"}
    with Game([program, file, "0"], environment) as game:
        for line in ("start", "stop", "wave on"):
            game.do(line)
        for _ in range(2):
            game.event("connected")
            game.do("arm")
            for i in range(200):
                game.do(f"put ball{i % 10} 0 0 0.2 5")
                game.do(f"move ball{i % 10} 0 0 0.3")
            for line in ("field at 0 0 0.2", "solver gs", "stop", "reset", "disarm", "clear"):
                game.do(line)
            game.wait(lambda told: "field" in told)
            server.say(replies.Error(code="session", message="again"))
            game.event("lost")
        game.do("dispose")
        assert game.end() == 0, game.told[-50:]


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server of real processes, whose device remembers when it sounded."""
    with Server(tmp_path_factory.mktemp("server"), HELD) as made:
        yield made


@pytest.fixture
def player(start: Start, real: Server, request: pytest.FixtureRequest) -> Iterator[Game]:
    """A game of that server, with a point that is felt. Its parameter: the lease that it asks for [s]."""
    free(real.file)
    with start(real.file, getattr(request, "param", 0.0)) as made:
        made.do("start")
        play(made)
        yield made


def play(game: Game) -> dict[str, Any]:
    """Put everything, and arm; how it stands when it sounds."""
    game.event("connected")
    game.do("put ball 0 0 0.2 20")
    game.do("arm")
    return game.sounding()


def silence(server: Server, since: float) -> float:
    """How long after `since` [s] it sounded for the last time [s], when it has been silent for a while."""
    end = time.monotonic() + UNTIL
    while time.monotonic() < end:
        now = time.perf_counter()
        events = server.log.read(max(0, server.log.count - 10_000))
        last = events["time"][events["sounds"] == 1].max(initial=0.0)
        if now - last > SILENT:
            return max(0.0, float(last) - since)
        time.sleep(0.01)
    raise AssertionError("it sounds on")


def test_what_a_game_does_is_felt_and_seen(player: Game, real: Server) -> None:
    status = player.until(lambda s: s["objects"] == 1 and s["points"] > 0)
    assert (status["status"], status["owner"], status["lease"]) == ("Connected", True, 10.0)
    assert status["server"].startswith("pacinian ")
    assert status["solvers"] > 3
    assert 0.0 < status["latency"] < 1.0
    assert -0.01 < status["age"] < 1.0
    player.do("wave on")
    player.until(lambda s: s["output"] == "silent")  # the hand has moved on
    player.until(lambda s: s["output"] == "sounding")
    player.do("field at 0 0 0.2")
    assert player.wait(lambda told: "field" in told)["field"] == 1
    player.do("solver gs-pat")
    player.do("backend probe-other")
    player.do("intensity 0.5")
    player.until(
        lambda s: (s["solver"], s["backend"], s["intensity"]) == ("gs-pat", "probe-other", 0.5)
    )
    player.do("solver none")
    assert player.event("refused", "unknown")["message"]
    player.do("put far 0 0 20 5")
    assert player.event("refused", "malformed")["path"] == "$.objects[far].position[2]"
    assert player.do("move ball 0 0 50")["done"]  # out of reach, however far
    player.until(lambda s: s["points"] == 0)
    player.do("remove ball")
    player.do("backend probe")
    player.until(lambda s: s["backend"] == "probe" and s["output"] == "silent")
    player.do("disarm")
    assert not player.until(lambda s: not s["owner"])["armed"]


@pytest.mark.parametrize("player", [LEASE], indirect=True)
def test_a_frozen_game_falls_silent_though_its_worker_lives(player: Game, real: Server) -> None:
    assert player.status()["lease"] == LEASE
    at = player.do("tick off")["time"]
    assert 0.0 < silence(real, at) < LEASE + SLACK
    assert player.do("put other 0 0 0.3 5")["done"]
    player.do("tick on")
    assert "not renewed in time" in player.event("ended", "expired")["message"]
    status = player.until(lambda s: s["owner"] and not s["armed"])
    assert status["output"] == "silent"
    player.sounding()


def test_a_game_that_is_killed_falls_silent(player: Game, real: Server) -> None:
    at = time.perf_counter()
    player.kill()
    assert silence(real, at) < LEASE + LINK + SLACK


def test_a_stop_silences_whoever_owns(player: Game, real: Server, start: Start) -> None:
    with start(real.file) as other:
        at = other.do("stop")["time"]  # without having started
        assert silence(real, at) < SLACK
    player.event("ended", "stopped")
    player.do("arm")
    player.event("refused", "stopped")
    player.do("reset")
    player.do("arm")
    player.until(lambda s: s["armed"] and s["output"] == "sounding")


def test_a_server_that_is_restarted_under_it(player: Game, real: Server) -> None:
    real.signal("control", signal.SIGKILL)
    player.event("lost")
    assert not player.do("put ball 0 0 0.2 20")["done"]
    end = time.monotonic() + UNTIL
    while real.left() and time.monotonic() < end:
        time.sleep(0.01)
    real.start()
    player.event("connected")
    mark = real.log.count
    status = player.until(lambda s: s["output"] == "silent" and s["sequence"] > 30)
    assert (status["armed"], status["owner"], status["objects"]) == (False, False, 0)
    assert not real.log.read(mark)["sounds"].any()
    player.do("put ball 0 0 0.2 20")
    player.do("arm")
    player.until(lambda s: s["armed"] and s["output"] == "sounding")
