"""The client in C++: its own tests, and all tests of the one in C#, while ThreadSanitizer watches its threads."""

from __future__ import annotations

import inspect
import os
import time
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
import zmq
from msgspec.structs import replace

from pacinian.wire import control, replies

from ..core.client.fake_server import Fake
from ..waiting import eventually
from . import test_csharp_client, test_csharp_connecting, test_csharp_server, tools
from .game import Game, begin

if TYPE_CHECKING:
    from collections.abc import Callable

    Start = Callable[..., Game]

pytestmark = [
    pytest.mark.deep("cmake", "ninja", "g++", "pkg-config"),
    pytest.mark.timeout(600.0),  # in all, they take long
]

PURE = "client_outbox", "client_session", "client_felt", "client_digest", "client_handlers"
ONLY = {"csharp_core", "csharp_driver"}  # fixtures for C# alone
OTHER = {
    "test_one_that_is_forgotten_says_goodbye",  # no finaliser in C++
    "test_a_client_that_has_ended_lists_no_touch",  # the game in C++ does not tell how many
}


def shared(test: object) -> bool:
    """Return whether a test is also for C++."""
    if not inspect.isfunction(test) or not test.__name__.startswith("test_"):
        return False
    return test.__name__ not in OTHER and not ONLY & set(inspect.signature(test).parameters)


for module in (test_csharp_client, test_csharp_connecting, test_csharp_server):
    globals().update({name: test for name, test in vars(module).items() if shared(test)})


@pytest.fixture(scope="module")
def programs() -> Path:
    return tools.watched("client_answers", *PURE) / "core"


@pytest.fixture
def start(programs: Path) -> Start:
    """Return a function that starts a game in C++."""
    return partial(begin, [programs / "client_answers"], **tools.WATCHED)


@pytest.mark.parametrize("name", PURE)
def test_a_program_that_tests_itself(programs: Path, name: str) -> None:
    tools.run(programs / name)


def test_its_threads_do_not_race(server: Fake, game: Game) -> None:
    for line in ("stop", "reset", "wave on"):
        game.do(line)
    for _ in range(2):
        game.do("arm")
        before = len(game.told)
        for i in range(200):
            game.do(f"put ball{i % 10} 0 0 0.2 5")
            game.do(f"move ball{i % 10} 0 0 0.3")
        for line in ("field at 0 0 0.2", "solver gs", "stop", "reset", "disarm", "clear"):
            game.do(line)
        eventually(lambda n=before: any("field" in told for told in game.told[n:]))
        server.say(replies.Error(code="session", message="again"))
        game.event("lost")
        game.event("connected")
    game.do("dispose")
    assert game.end() == 0, game.told[-50:]


@pytest.fixture(scope="module")
def with_libzmq() -> Path:
    """Return a game that was built with libzmq."""
    settings = "-DPACINIAN_LIBZMQ=ON", *tools.RACES, *tools.JOINED
    return tools.cmake("libzmq", ["client_answers"], *settings) / "client_answers"


def write_keys(server: Fake, path: Path, **other: str) -> dict[str, str]:
    """Write a connection file with keys instead of a token."""
    public, secret = zmq.curve_keypair()
    keys = {"public_key": public.decode(), "secret_key": secret.decode(), **other}
    replace(server.connection, token="", **keys).write(path)
    return keys


def test_keys_in_place_of_a_token(with_libzmq: Path, tmp_path: Path) -> None:
    path = tmp_path / "connection.json"
    with Fake(keys=zmq.curve_keypair()) as server:
        keys = write_keys(server, path)
        with begin([with_libzmq], path, **tools.WATCHED_LIBZMQ) as game:
            game.do("start")
            game.event("connected")
            game.do("put ball 0 0 0.2 5")
            server.until(lambda: len(server.seen) > 2)
            game.until(lambda s: s["latency"] > 0.0)
            game.do("stop")
            server.until(lambda: bool(server.of(control.Stop)))
            write_keys(server, path, server_key=keys["public_key"])
            server.say(replies.Error(code="session", message="again"))
            assert game.until(lambda s: s["status"] == "Refused")["problem"]
            write_keys(server, path, secret_key="short")
            game.until(lambda s: "no keys of a client" in s["problem"])
            assert game.end() == 0, game.told[-50:]


def test_a_game_with_libzmq_needs_it_only_for_keys(
    with_libzmq: Path, server: Fake, file: Path
) -> None:
    with begin([with_libzmq], file, **tools.WATCHED_LIBZMQ) as game:
        game.do("start")
        game.event("connected")
        assert game.end() == 0, game.told[-50:]


def test_libzmq_is_needed_only_for_keys(server: Fake, start: Start, tmp_path: Path) -> None:
    path = tmp_path / "connection.json"
    write_keys(server, path, server_key="k" * 40)
    with start(path, timeout=2.0) as game:
        game.do("start")
        problem = game.until(lambda s: s["status"] == "Refused")["problem"]
        assert "built without" in problem
        assert "PACINIAN_LIBZMQ" in problem  # says what to do
        game.do("stop")
        assert "libzmq" in game.event("refused", "stop")["message"]
        server.connection.write(path)
        game.event("connected")
        game.do("stop")
        server.until(lambda: bool(server.of(control.Stop)))
        assert game.end() == 0, game.told[-50:]


def test_it_is_not_linked_with_libzmq(programs: Path) -> None:
    assert "libzmq" not in tools.run("ldd", programs / "client_answers")


def test_it_waits_without_working(server: Fake, game: Game) -> None:
    """A thread that polls would use a whole core."""
    game.until(lambda s: s["latency"] > 0.0)
    before, begin = read_processor_time(game), time.monotonic()
    time.sleep(1.0)
    assert read_processor_time(game) - before < 0.5 * (time.monotonic() - begin)


def read_processor_time(game: Game) -> float:
    """Return the processor time of a process [s]."""
    fields = Path(f"/proc/{game.process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
