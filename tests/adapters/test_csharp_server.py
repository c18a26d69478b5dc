"""The client in C# with a real server: what is felt, and when there is silence."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import pytest

from ..waiting import PATIENCE, eventually
from .game import (
    LEASE,
    kill,
    look,
    sound,
    sounded_since,
    wait_for_expiry,
    wait_for_silence,
    wait_until_free,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian_lab.server.faults.server import Server

    from .game import Game

pytestmark = pytest.mark.deep("mono", "mcs")


def test_what_is_done_is_felt(player: Game) -> None:
    status = player.status()
    assert (status["owner"], status["lease"]) == (True, 10.0)
    assert status["server"].startswith("pacinian ")
    assert status["solvers"] > 3
    player.do("field at 0 0.01 0.2")
    assert player.wait(lambda told: "field" in told)["field"] == 1
    player.do("solver gs")
    player.until(lambda s: s["solver"] == "gs")
    player.do("backend probe-other")
    player.until(lambda s: s["backend"] == "probe-other" and s["output"] == "sounding")
    player.do("backend probe")
    player.do("intensity 0.5")
    player.until(lambda s: s["intensity"] == 0.5 and s["backend"] == "probe")
    player.do("put bad 0 0 0.2 100000")
    assert player.event("refused", "limit")["path"] == "$.objects[bad].radiation_pressure"
    player.do("solver none-such")
    player.event("refused", "unknown")
    player.do("wave on")
    player.until(lambda s: s["hands"] == 1 and s["objects"] == 1)
    player.do("lose")
    player.until(lambda s: s["hands"] == 0 and s["objects"] == 0)
    player.do("wave on")
    player.until(lambda s: s["objects"] == 1)
    player.do("remove ball")
    player.until(lambda s: s["objects"] == 0)
    player.do("disarm")
    status = player.until(lambda s: not s["armed"] and s["output"] == "silent")
    assert 0.0 < status["latency"] < PATIENCE
    assert -0.01 < status["age"] < PATIENCE


def test_an_object_that_is_too_strong_takes_no_other_with_it(player: Game) -> None:
    assert not player.do("ball loud 0.03 1000")["done"]
    refused = player.event("refused", "limit")
    assert refused["path"] == "$.objects[loud].radiation_pressure"
    assert "of 1000 Pa: keep to 200 Pa" in refused["message"]
    assert player.do("ball other 0.03 5")["done"]
    player.until(lambda s: s["objects"] == 2)


@pytest.mark.parametrize(
    ("wrong", "field"),
    [({"lease": -1.0}, "($.lease)"), ({"life": -1.0}, "the option `life` is -1 s")],
)
def test_a_wrong_option_is_named(
    real: Server, start: Callable[..., Game], wrong: dict[str, float], field: str
) -> None:
    with start(real.file, **wrong) as game:
        game.do("start")
        # on a busy machine, the handshake may take too long at first, which is told in the same way
        game.until(lambda s: s["status"] == "Refused" and field in s["problem"].lower())


@pytest.mark.parametrize("player", [LEASE], indirect=True)
def test_a_game_that_does_not_tick_is_silent_when_its_lease_is_over(
    real: Server, player: Game
) -> None:
    since = time.perf_counter()
    player.do("tick off")
    wait_for_expiry(real, since, stood=2.0 * LEASE)
    assert player.do("put other 0 0 0.3 5")["done"]  # the client's own thread is alive
    player.until(lambda s: s["cause"] == "lease lost" or s["armed"])
    player.do("tick on")
    still = player.event("stood still")
    assert still["seconds"] > LEASE
    player.until(lambda s: s["armed"] and s["output"] == "sounding")  # by itself
    assert not any(told.get("event") == "ended" for told in player.told)


@pytest.mark.parametrize("player", [LEASE], indirect=True)
def test_a_game_that_goes_on_is_silent_if_it_was_armed_only_once_or_stopped_meanwhile(
    real: Server, player: Game
) -> None:
    for how, code in (("arm once", "expired"), ("arm", "stopped")):
        player.do(how)
        player.sounding()
        since = time.perf_counter()
        player.do("tick off")
        wait_for_expiry(real, since)
        if code == "stopped":
            player.do("stop")
            eventually(lambda: look(real).output == "stopped")
        player.do("tick on")
        player.event("ended", code)
        mark = real.log.count
        player.do("move ball 0 0.01 0.21")
        player.do("field at 0 0 0.2")
        player.wait(lambda told: "field" in told)
        assert not sounded_since(real, mark)
    player.do("reset")
    player.until(lambda s: s["output"] == "silent")
    player.sounding()


@pytest.mark.parametrize("player", [LEASE], indirect=True)
@pytest.mark.parametrize("whole", [False, True])
def test_a_whole_program_that_stood_still_is_told_apart_from_a_long_frame(
    real: Server, player: Game, whole: bool
) -> None:
    """As at a breakpoint, where the client's own thread stands still, too."""
    if whole:
        player.do("hold")

    def stand_still() -> bool:
        since = time.perf_counter()
        player.stand_still()
        wait_for_expiry(real, since, stood=2.0 * LEASE)
        player.say("status")
        still = player.event("stood still")
        assert still["seconds"] > LEASE
        assert ("breakpoint" in still["text"]) is still["whole"]
        return bool(still["whole"])

    if whole:
        assert stand_still()
    else:  # on a busy machine, the client's thread may stand still as well
        eventually(lambda: not stand_still(), player.sounding)
    if whole:
        player.do("release")
    player.until(lambda s: s["armed"] and s["output"] == "sounding")


@pytest.mark.parametrize("how", ["kill", "dispose"])
def test_a_game_that_ends_is_silent(real: Server, player: Game, how: str) -> None:
    since = time.perf_counter()
    if how == "kill":
        player.kill()
    else:
        player.do("dispose")
    wait_for_silence(real, since)
    wait_until_free(real)  # so the session has ended, not only its lease
    if how == "dispose":
        assert player.end() == 0


def test_a_stop_from_a_game_without_a_session(
    real: Server, player: Game, start: Callable[..., Game]
) -> None:
    with start(real.file) as other:
        since = time.perf_counter()
        other.do("stop")
        wait_for_silence(real, since)
        assert other.status()["status"] == "Stopped"
    player.event("ended", "stopped")
    player.do("arm")
    assert player.event("refused", "stopped")["advice"] == "reset first"
    player.do("stop")
    player.do("reset")  # after the stop, however slow it is
    player.do("arm")
    player.until(lambda s: s["armed"] and s["output"] == "sounding")


def test_a_server_that_is_killed_and_started_again(real: Server, player: Game) -> None:
    kill(real)
    assert "nothing of this session goes on" in player.event("lost")["message"]
    for i in range(20):
        assert not player.do(f"put ball{i} 0 0.01 0.2 20")["done"]
    assert not player.do("arm")["done"]
    mark = real.log.count
    real.start()
    player.event("connected")
    status = player.until(lambda s: s["objects"] == 0)  # as reported in a state of the new server
    assert (status["armed"], status["owner"], status["output"]) == (False, False, "silent")
    assert not sounded_since(real, mark)
    sound(player)


def test_what_is_out_of_reach_is_as_far_as_can_be(player: Game) -> None:
    assert player.do("move ball 0 0 50")["done"]
    player.until(lambda s: s["points"] == 0)
    assert not [told for told in player.told if told.get("event") == "refused"]
