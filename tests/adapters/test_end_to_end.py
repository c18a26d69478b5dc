"""The examples in C# and C++: a hand that moves at 90 Hz feels a ball; then the game is killed while it plays."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from pacinian_lab.server.faults.server import Server

from ..waiting import eventually
from . import tools
from .game import HELD, RATE, Game, look, wait_for_silence, wait_until_free

if TYPE_CHECKING:
    from pathlib import Path

SECONDS = 4.0
REACH = 0.06  # [m] from the ball's centre; the radius is half of it
SPARE = 4.0  # [bytes] per frame, for a text in the state that changes sometimes


@pytest.fixture
def server(tmp_path: Path) -> Any:
    with Server(tmp_path, HELD, RATE) as made:
        yield made


def steady(game: Game, of_game: str, of_worker: str, spare: float) -> dict[str, Any]:
    """Return the report of a stretch without allocations of the game, and with few of the client's own thread.

    Before it, buffers may grow.
    """
    return game.wait(lambda told: told.get(of_game) == 0.0 and told[of_worker] < spare)


def killed(server: Server, game: Game) -> None:
    """Kill it while it sounds. The server's other device must then be silent, and the output free."""
    # late frames may lose the hand for a moment
    eventually(lambda: look(server).output == "sounding")
    since = time.perf_counter()
    game.kill()
    wait_for_silence(server, since, server.logs[1])
    wait_until_free(server)


@pytest.mark.deep("mono", "mcs")
def test_a_game_in_csharp(csharp_core: Path, server: Server) -> None:
    sources = (tools.CSHARP / "example").glob("*.cs")
    program = tools.csharp(csharp_core.with_name("EndToEnd.exe"), sources, csharp_core)
    with Game(["mono", "--debug", program, server.file, str(SECONDS)]) as game:
        told = steady(game, "bytes_per_frame", "worker_bytes_per_frame", SPARE)
        killed(server, game)
    assert (told["solver"], told["backend"]) == ("gs", "probe-other")
    assert told["foci"] > 0
    assert told["far"] < REACH
    assert told["inputs"] > 0
    assert 0.0 < told["round_trip_p50"] <= told["round_trip_p99"]
    assert 0.0 < told["hand_p50"] <= told["hand_p99"]


@pytest.mark.deep("cmake", "ninja", "g++", "pkg-config")
def test_a_game_in_cpp(server: Server) -> None:
    program = tools.watched("ball") / "core" / "ball"
    with Game(
        [program, server.file, str(SECONDS), "gs-pat", "probe-other"], tools.environment()
    ) as game:
        told = steady(game, "allocations_game", "allocations_worker", 1.0)
        killed(server, game)
    assert told["armed"]
    assert told["solvers"] == ["auto", "gs-pat"]
    assert told["backends"] == ["probe", "probe-other"]
    assert told["points"] > 0
    assert np.linalg.norm(np.subtract(told["at"], [0.0, 0.0, 0.2])) < REACH
    assert told["hands"] > 0
    assert 0.0 < told["round_trip_p50"] <= told["round_trip_p99"]
    assert 0.0 < told["hand_to_emitted_p50"] <= told["hand_to_emitted_p99"]
