"""The client in C++: by itself, and by all tests of the one in C#, as ThreadSanitizer watches its threads."""

from __future__ import annotations

import inspect
from functools import partial
from typing import TYPE_CHECKING

import pytest

from pacinian.wire import replies

from ..waiting import eventually
from . import test_csharp_client, test_csharp_connecting, test_csharp_server, tools
from .game import Game, begin

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from ..core.client.fake import Fake

pytestmark = pytest.mark.deep("cmake", "ninja", "g++", "pkg-config")

PURE = "client_outbox", "client_dialogue", "client_felt"
ONLY = {"csharp_core", "csharp_driver"}  # what tests of nothing but C# need
OTHER = {"test_one_that_is_forgotten_says_goodbye"}  # C++ forgets nothing


def shared(test: object) -> bool:
    """Whether a test is of C++, too."""
    if not inspect.isfunction(test) or not test.__name__.startswith("test_"):
        return False
    return test.__name__ not in OTHER and not ONLY & set(inspect.signature(test).parameters)


for module in (test_csharp_client, test_csharp_connecting, test_csharp_server):
    globals().update({name: test for name, test in vars(module).items() if shared(test)})


@pytest.fixture(scope="module")
def programs() -> Path:
    return tools.watched("client_answers", *PURE) / "core"


@pytest.fixture
def start(programs: Path) -> Callable[..., Game]:
    """Starts a game, in C++."""
    return partial(begin, [programs / "client_answers"], **tools.WATCHED)


@pytest.mark.parametrize("name", PURE)
def test_a_program_that_tests_itself(programs: Path, name: str) -> None:
    tools.run(programs / name)


def test_what_is_out_of_reach_is_as_far_as_can_be(player: Game) -> None:
    assert player.do("move ball 0 0 50")["done"]
    player.until(lambda s: s["points"] == 0)
    assert not [told for told in player.told if told.get("event") == "refused"]


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
