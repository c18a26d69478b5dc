"""A game in C++ from nothing to its end: ten seconds with a moving hand, and then it is killed."""

from __future__ import annotations

import logging
import time
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.bench.faults.server import Server

from . import tools
from .game import HELD, Game

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.wire.state import State

LOG = logging.getLogger(__name__)
SECONDS = 10.0
WAIT = 60.0  # [s] until it has told
SLACK = 1.0  # [s] where two processors are shared by many


@pytest.fixture(scope="module")
def program() -> Path:
    return tools.release("ball") / "core" / "ball"


def until(client: pc.Client, output: str) -> State:
    """The first state published that says so."""
    return next(state for state in client.watch() if state.output == output)


@pytest.mark.timeout(tools.LIMIT + 2 * WAIT)
def test_a_ball_from_nothing_to_silence(program: Path, tmp_path: Path) -> None:
    with Server(tmp_path, HELD) as server:
        words: list[str | Path] = [program, server.file, str(SECONDS), "gs-pat", "probe-other"]
        with Game(words) as game:
            told = wait(game)
            check(told)
            with pc.Client(server.file) as onlooker:
                until(onlooker, "sounding")  # as its hand may be lost where frames are late
                at = time.perf_counter()
                game.kill()
                state = until(onlooker, "silent")
                seen = time.perf_counter() - at
            other = server.logs[1]
            events = other.read(max(0, other.count - 10_000))
            last = float(events["time"][events["sounds"] == 1].max()) - at
            assert state.owner == ""
            assert max(seen, last) < SLACK
            LOG.info("%s", {**told, "state_says_silent": seen, "last_sound": last})


def wait(game: Game) -> dict[str, Any]:
    """What it tells when it has played."""
    end = time.monotonic() + WAIT
    while not any("frames" in told for told in game.told):
        assert time.monotonic() < end, game.told
        assert game.process.poll() is None, game.told
        time.sleep(0.05)
    return next(told for told in game.told if "frames" in told)


def check(told: dict[str, Any]) -> None:
    """Whether it went as it should."""
    assert told["armed"]
    assert 0.3 * 0.4 * SECONDS * 90.0 < told["frames"] < 1.1 * 0.4 * SECONDS * 90.0
    assert told["solvers"] == ["auto", "gs-pat"]
    assert told["backends"] == ["probe", "probe-other"]
    assert told["points"] > 0
    assert np.linalg.norm(np.subtract(told["at"], [0.0, 0.0, 0.2])) < 0.06  # of skin in the ball
    assert told["hands"] > 100
    assert told["allocations_game"] == 0.0
    assert told["allocations_worker"] < 1.0
    assert 0.0 < told["round_trip_p50"] <= told["round_trip_p99"]
    assert 0.0 < told["hand_to_emitted_p50"] <= told["hand_to_emitted_p99"]
    assert told["call_p99"] < 0.01
