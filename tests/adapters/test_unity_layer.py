"""The Unity layer, played by stand-ins of the engine's types and a real server. Nothing here runs inside Unity."""

from __future__ import annotations

import os
import re
import signal
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from pacinian.bench.faults.server import Server

from . import tools, unity
from .game import HELD, LEASE, Game, free
from .silence import heard, silent

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.timeout(tools.LIMIT)  # it is built first

LATE = 0.15  # [s] after the lease, where two processors are shared by many
END = 0.5  # [s] that the end may take
STATES = 60  # in which the hand has been to and fro
SKIN = 0.01  # [m]: samples are on the hand's skin, at most so deep in the ball


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> unity.Built:
    return unity.build(tmp_path_factory.mktemp("unity"))


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with Server(tmp_path_factory.mktemp("server"), HELD) as made:
        yield made


@pytest.fixture
def game(real: Server, built: unity.Built, request: pytest.FixtureRequest) -> Iterator[Game]:
    """A level whose ball is touched. Its parameter: the lease that it asks for [s]."""
    free(real.file)
    lease = str(getattr(request, "param", 0.0))
    with Game(["mono", "--debug", built.player, real.file, lease]) as made:
        made.do("play")
        made.event("connected")
        if hasattr(request, "param"):
            made.sounding(felt)
        sounds(made)
        yield made


def felt(status: dict[str, Any]) -> bool:
    return bool(status["output"] == "sounding" and status["emitted"] > 0.5)


def sounds(game: Game) -> None:
    game.until(felt)


def test_the_packages_own_tests(built: unity.Built) -> None:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    said = tools.run(
        "env", f"PATH={path}", "mono", "--debug", built.runner,
        built.editor_tests, "--play", built.tests,
    )  # fmt: skip
    assert said.splitlines()[-1].endswith(" passed, 0 failed")


def test_the_manuals_examples_compile(built: unity.Built, tmp_path: Path) -> None:
    manual = (unity.PACKAGE / "Documentation~" / "index.md").read_text(encoding="utf-8")
    examples = re.findall(r"```csharp\n(.*?)```", manual, re.DOTALL)
    assert examples
    needed = [built.player.with_name(f"{n}.dll") for n in ("UnityEngine", "Pacinian.Haptics")]
    for i, example in enumerate(examples):
        source = tmp_path / f"Example{i}.cs"
        source.write_text(example.replace("HapticPoint click;", "HapticPoint click = null;"))
        tools.csharp(source.with_suffix(".dll"), [source], *needed)


def test_what_is_touched_is_felt_and_drawn_where_it_is(game: Game) -> None:
    status = game.status()
    assert (status["armed"], status["problem"], status["hands"]) == (True, "", 1)
    assert status["objects"] == 1
    game.do("gizmos")
    status = game.status()
    assert status["drawn"] > 0
    assert status["apart"] < SKIN
    game.do("point")
    game.until(lambda s: s["playing"] and s["flash"] > 0.0)
    game.until(lambda s: not s["playing"] and s["flash"] == 0.0)  # its duration is over
    game.do("hand off")
    game.until(lambda s: s["output"] == "silent")
    game.do("hands off")  # without any, the scene stays one that is felt by hands only
    game.do("hand on")
    game.do("disable")
    game.do("enable")
    game.event("connected")
    game.do("warm")
    status = game.until(lambda s: s["armed"] and s["frames"] > 30)
    assert status["output"] == "silent"
    game.do("hands on")
    sounds(game)
    game.do("ball off")
    game.until(lambda s: s["objects"] == 0)
    game.do("ball on")
    sounds(game)


def test_a_frame_makes_no_garbage_and_does_not_wait(game: Game) -> None:
    windows: list[dict[str, Any]] = []
    while len(windows) < 5 and not (windows and windows[-1]["worst"] == 0):
        game.do("warm")  # buffers grow until they are large enough, also for a machine that is late
        windows.append(game.until(lambda s: s["frames"] > 120))
    assert (windows[-1]["bytes"], windows[-1]["worst"]) == (0.0, 0)
    assert windows[-1]["longest"] < 0.1


def test_what_is_changed_while_it_runs(game: Game) -> None:
    game.do("strength 8")
    game.until(lambda s: s["output"] == "sounding" and s["emitted"] > 3.0)  # by where the hand is
    game.do("strength 2")
    weak = [False] * STATES

    def is_weak(status: dict[str, Any]) -> bool:
        """Wherever the hand is."""
        weak.append(0.0 < status["emitted"] < 2.5)
        return all(weak[-STATES:])

    game.until(is_weak)
    game.do("strength 8")
    game.do("intensity 0.5")
    game.until(lambda s: s["intensity"] == 0.5)
    game.do("solver lagrange")
    game.until(lambda s: s["solver"] == "lagrange" and s["output"] == "sounding")
    game.do("solver gs")
    assert "quiet zones" in game.event("refused")["code"]
    game.do("hum 40")
    game.do("intensity 1")
    game.until(lambda s: s["intensity"] == 1.0)
    game.do("solver none-such")
    assert "none-such" in game.event("refused")["code"]
    assert "none-such" in game.status()["problem"]
    game.do("solver auto")
    game.until(lambda s: s["solver"] == "auto")
    game.do("both 100000")  # more than the server allows, in one message with what it does
    assert "radiation_pressure" in game.event("refused")["code"]
    assert game.until(lambda s: s["flash"] > 0.0 and s["objects"] == 1)["wrong"]
    game.do("strength 8")
    sounds(game)
    assert game.status()["wrong"] == ""
    game.do("strength 2000000")
    status = game.until(lambda s: s["objects"] == 0)
    assert "ball cannot be felt: " in status["said"]
    assert "radiation_pressure" in status["said"]


@pytest.mark.parametrize("how", ["quit", "exit", "reload", "disable"])
def test_whatever_ends_it_ends_the_sound_and_does_not_hang(
    real: Server, game: Game, how: str
) -> None:
    since = time.perf_counter()
    assert game.do(how)["took"] < END
    assert silent(real, since) - since < LEASE
    assert not game.status()["current"]
    assert game.end() == 0


def test_a_session_is_ended_and_begun_by_hand(real: Server, game: Game) -> None:
    since = time.perf_counter()
    assert game.do("disconnect")["took"] < END
    assert silent(real, since) - since < LEASE
    assert game.status()["status"] == "Stopped"
    for word in ("connect", "reconnect"):
        game.do(word)
        game.event("connected")
        sounds(game)


@pytest.mark.parametrize("game", [LEASE], indirect=True)
def test_the_end_does_not_wait_for_a_server_that_hangs(real: Server, game: Game) -> None:
    real.signal("control", signal.SIGSTOP)
    try:
        since = time.perf_counter()
        assert game.do("quit")["took"] < END + LATE
        assert silent(real, since) - since < LEASE + LATE
    finally:
        real.signal("control", signal.SIGCONT)


def test_play_mode_again_where_the_domain_is_not_loaded_anew(game: Game) -> None:
    game.do("quit")
    assert game.status()["behaviours"] == 0
    game.do("play")
    game.event("connected")
    sounds(game)
    game.do("disable")
    assert game.status()["status"] == "Stopped"
    game.do("enable")
    game.event("connected")
    sounds(game)


@pytest.mark.parametrize("game", [LEASE], indirect=True)
def test_a_freeze_is_silent_in_time_and_sounds_again_only_if_that_is_wanted(
    real: Server, game: Game
) -> None:
    game.say("freeze 0.6")
    since = time.perf_counter()
    assert silent(real, since) - since < LEASE + LATE
    game.event("ended", "expired")
    game.until(lambda s: s["output"] == "silent" and s["objects"] >= 0)
    mark = real.log.count
    game.do("hum 60")
    game.until(lambda s: s["frames"] > 0)
    assert not game.status()["armed"]
    assert not heard(real, mark)
    game.sounding(felt)
    game.do("again")
    game.do("freeze 0.6")
    game.event("ended", "expired")
    sounds(game)


def test_an_emergency_stop_stays_until_reset(real: Server, game: Game) -> None:
    game.do("again")
    since = time.perf_counter()
    game.do("stop")
    assert silent(real, since) - since < LEASE + LATE
    game.event("ended", "stopped")
    assert not game.until(lambda s: s["output"] == "stopped")["armed"]
    game.do("reset")
    game.until(lambda s: s["output"] == "silent")
    game.do("arm")
    sounds(game)


@pytest.mark.parametrize("again", [False, True], ids=["not armed", "armed again"])
def test_after_a_restart_of_the_server_objects_are_put_again(
    real: Server, game: Game, again: bool
) -> None:
    if again:
        game.do("again")
    real.signal("control", signal.SIGKILL)
    assert "nothing of this session goes on" in game.event("lost")["code"]
    end = time.monotonic() + 20.0
    while real.left():
        assert time.monotonic() < end
        time.sleep(0.01)  # until all of it has ended
    mark = real.log.count
    real.start()
    game.event("connected")
    if again:
        sounds(game)
        return
    game.do("warm")
    assert not game.until(lambda s: s["output"] == "silent" and s["frames"] > 45)["armed"]
    assert not heard(real, mark)
    game.do("arm")  # and nothing else: the objects are there
    sounds(game)


def test_a_game_without_a_server_says_what_to_do_and_connects_when_it_comes(
    real: Server, built: unity.Built, tmp_path: Path
) -> None:
    file = tmp_path / "connection.json"
    with Game(["mono", "--debug", built.player, file, "0"]) as game:
        game.do("play")
        status = game.until(lambda s: s["problem"] != "")
        assert "is `pacinian serve` running?" in status["problem"]
        assert game.do("stop")["took"] < 0.1
        file.write_bytes(real.file.read_bytes())
        file.chmod(0o600)
        game.event("connected")
        assert game.do("quit")["took"] < END
        assert game.end() == 0
