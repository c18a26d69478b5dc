"""The Unity layer, played with stubs of the engine's types and a real server. Nothing here runs inside Unity."""

from __future__ import annotations

import os
import re
import signal
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import psutil
import pytest

import pacinian as pc
from pacinian_lab.server.faults.server import Server

from ..core.client.fake_server import Fake
from ..waiting import PATIENCE, eventually
from . import tools, unity
from .game import (
    HELD,
    LEASE,
    RATE,
    Game,
    count_parts,
    find_server,
    kill,
    refuse_zones,
    sounded_since,
    wait_for_expiry,
    wait_for_silence,
    wait_until_free,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

pytestmark = pytest.mark.deep("mono", "mcs")

TOUCHES = 60  # states in which the ball is touched while the hand moves to and fro
SKIN = 0.01  # [m] samples are on the hand's skin, at most this deep in the ball


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> unity.Built:
    return unity.build(tmp_path_factory.mktemp("unity"))


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with Server(tmp_path_factory.mktemp("server"), HELD, RATE) as made:
        yield made


@pytest.fixture
def game(real: Server, built: unity.Built, request: pytest.FixtureRequest) -> Iterator[Game]:
    """Return a level whose ball is touched. Its parameter: the lease that it requests [s]."""
    wait_until_free(real)
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


def flash(game: Game, wanted: Callable[[dict[str, Any]], bool] = bool) -> dict[str, Any]:
    """Return the status as soon as the point sounds, as wanted; play it again if a slow machine missed it."""

    def flashes(status: dict[str, Any]) -> bool:
        if not status["playing"]:
            game.do("point")
        return bool(status["playing"] and status["flash"] > 0.0 and wanted(status))

    return game.until(flashes)


def test_the_packages_own_tests(built: unity.Built, tmp_path: Path) -> None:
    """Like the editor, they run in the project's folder, where the started server logs."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    said = tools.run(
        "env", f"PATH={path}", "mono", "--debug", built.runner,
        built.editor_tests, "--play", built.tests, folder=tmp_path,
    )  # fmt: skip
    assert (tmp_path / "Logs" / "pacinian-serve.log").exists()
    assert said.splitlines()[-1].endswith(" passed, 0 failed")


@pytest.mark.parametrize("version", [0, 1], ids=list(unity.VERSIONS))
def test_components_for_other_packages(built: unity.Built, version: int) -> None:
    said = tools.run("mono", "--debug", built.runner, "--play", built.packages[version])
    assert said.splitlines()[-1].endswith(" passed, 0 failed")


@pytest.mark.parametrize("system", [0, 1], ids=list(unity.SYSTEMS))
def test_the_mouse_moves_a_hand_with_each_input_system(built: unity.Built, system: int) -> None:
    tests = built.mouse[system]
    runner = tests.with_name(built.runner.name)
    said = tools.run("mono", "--debug", runner, "--play", tests)
    assert said.splitlines()[-1].endswith(" passed, 0 failed")


def test_the_manuals_examples_compile(built: unity.Built, tmp_path: Path) -> None:
    manual = (unity.PACKAGE / "Documentation~" / "index.md").read_text(encoding="utf-8")
    examples = re.findall(r"```csharp\n(.*?)```", manual, re.DOTALL)
    assert examples
    needed = [
        built.player.with_name(f"{n}.dll")
        for n in ("UnityEngine", "Pacinian.Core", "Pacinian.Haptics")
    ]
    for i, example in enumerate(examples):
        source = tmp_path / f"Example{i}.cs"
        source.write_text(example.replace("HapticPoint click;", "HapticPoint click = null;"))
        tools.csharp(source.with_suffix(".dll"), [source], *needed)


def test_what_is_touched_is_felt_and_drawn_where_it_is(game: Game) -> None:
    # on a busy machine the hand may be lost for a moment, so that nothing is felt
    status = game.until(lambda s: s["hands"] == s["objects"] == 1)
    assert (status["armed"], status["problem"]) == (True, "")

    def draws() -> dict[str, Any] | None:
        game.do("gizmos")
        status = game.status()
        return status if status["drawn"] > 0 else None

    assert eventually(draws)["apart"] < SKIN
    game.until(lambda s: s["force"] > 0.5)
    assert not flash(game)["pointed"]
    game.until(lambda s: not s["playing"] and s["flash"] == 0.0)  # its duration is over
    game.do("hand off")
    game.until(lambda s: s["output"] == "silent")
    game.do("hands off")  # without hands, the scene is still felt only by hands
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


def test_a_child_that_gets_a_collider_becomes_part_of_the_ball_while_it_plays(
    real: Server, game: Game
) -> None:
    game.do("again")  # a busy machine may lose its connection
    eventually(lambda: count_parts(real) == 1)
    game.do("shelf on")
    eventually(lambda: count_parts(real) == 2)
    game.do("shelf off")
    eventually(lambda: count_parts(real) == 1)
    assert game.status()["wrong"] == ""


def test_a_game_starts_a_server_and_takes_it_along(built: unity.Built, tmp_path: Path) -> None:
    """The server ends with play mode."""
    file = tmp_path / "connection.json"
    with Game(["mono", "--debug", built.player, file, "0"]) as game:
        game.do(f"serve {Path(sys.executable).with_name('pacinian')} --quiet")
        game.do("play")
        game.until(lambda s: s["status"] == "Connected" and s["problem"] == "")
        server = find_server(file)
        game.do("exit")
        assert not psutil.wait_procs(server, PATIENCE)[1]
        game.do("quit")
        game.do("serve /nowhere/pacinian")
        game.do("play")
        status = game.until(lambda s: "/nowhere/pacinian was not found" in s["problem"])
        assert status["why"] == status["problem"]
        game.do("quit")
        assert game.end() == 0


def test_frames_make_no_garbage(game: Game) -> None:
    def clean() -> bool:
        game.do("warm")  # buffers grow until they are large enough, even for a slow machine
        return bool(game.until(lambda s: s["frames"] > 90)["worst"] == 0)

    eventually(clean)


def test_what_is_changed_while_it_runs(game: Game) -> None:
    game.do("strength 8")
    game.until(lambda s: s["output"] == "sounding" and s["emitted"] > 3.0)  # by the hand's position
    game.do("strength 2")
    weak = [False] * TOUCHES

    def is_weak(status: dict[str, Any]) -> bool:
        """Return whether the pressure is weak, wherever the hand is.

        For 0.2 s of each second the hand is beside the ball, and nothing is felt. A slow machine sees few states in
        between.
        """
        if status["emitted"] > 0.0:
            weak.append(status["emitted"] < 3.0)  # at the rim it may be a third more than requested
        return all(weak[-TOUCHES:])

    game.until(is_weak)
    game.do("strength 8")
    game.do("intensity 0.5")
    game.until(lambda s: s["intensity"] == 0.5)
    game.do("solver lagrange")
    game.until(lambda s: s["solver"] == "lagrange" and s["output"] == "sounding")
    game.do("solver gs")  # any solver keeps the level's quiet zone
    game.until(lambda s: s["solver"] == "gs" and s["output"] == "sounding")
    game.do("hum 40")
    game.do("intensity 1")
    game.until(lambda s: s["intensity"] == 1.0)
    game.do("solver none-such")
    assert "none-such" in game.event("refused")["code"]
    assert "none-such" in game.status()["problem"]
    game.do("solver auto")
    game.until(lambda s: s["solver"] == "auto")
    game.do("both 100000")  # more than the server allows, in one message with an allowed object
    assert "radiation_pressure" in game.event("refused")["code"]
    assert flash(game, lambda s: s["objects"] == 1)["wrong"]
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
    game.do(how)
    wait_for_silence(real, since)
    wait_until_free(real)  # so the session has ended, not only its lease
    assert not game.status()["current"]
    assert game.end() == 0


def test_a_session_is_ended_and_begun_by_hand(real: Server, game: Game) -> None:
    since = time.perf_counter()
    game.do("disconnect")
    wait_for_silence(real, since)
    wait_until_free(real)
    assert game.status()["status"] == "Stopped"
    for word in ("connect", "reconnect"):
        game.do(word)
        game.event("connected")
        sounds(game)


@pytest.mark.parametrize("game", [LEASE], indirect=True)
def test_neither_frames_nor_the_end_wait_for_a_server_that_hangs(real: Server, game: Game) -> None:
    since = time.perf_counter()
    real.signal("control", signal.SIGSTOP)
    try:
        game.do("warm")
        game.until(lambda s: s["frames"] > 30)
        game.do("quit")
        wait_for_silence(real, since)
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
def test_a_freeze_is_silent_in_time_and_sounds_again_when_the_game_goes_on(
    real: Server, game: Game
) -> None:
    since = time.perf_counter()
    game.stand_still()
    wait_for_expiry(real, since, stood=2.0 * LEASE)
    game.say("status")
    assert "the game did not tick" in game.event("stood still")["code"]
    sounds(game)
    assert not any(told.get("event") == "ended" for told in game.told)


def test_a_pause_of_the_editor_ends_the_sound_at_once_and_is_no_failure(
    real: Server, game: Game
) -> None:
    """The session continues however long the pause is, and the output is released; a stop during the pause holds."""
    since = time.perf_counter()
    game.do("pause on")
    wait_for_silence(real, since)
    wait_until_free(real)
    assert game.status()["status"] == "Connected"
    game.do("pause off")
    sounds(game)
    assert not any(told.get("event") in ("ended", "stood still", "lost") for told in game.told)
    game.do("pause on")
    wait_until_free(real)
    with pc.Client(real.file) as other:
        other.stop()
        game.do("pause off")
        assert "stopped" in game.event("refused")["code"]
        other.reset()
    game.do("arm")
    sounds(game)


def test_a_pause_ends_the_sound_also_while_the_answer_to_arm_is_under_way(
    real: Server, game: Game
) -> None:
    for _ in range(10):
        game.do("arm")
        game.do("pause on")
        wait_until_free(real)
        for _ in range(5):  # frames, in which the answer arrives
            game.status()
        wait_until_free(real)
        game.do("pause off")
        sounds(game)
        game.do("disarm")
        wait_until_free(real)


def test_touches_are_told_to_server_and_effect_where_they_are(game: Game) -> None:
    """The hand moves to and fro once a second, and leaves the ball each time: touches end as often as they begin."""
    status = game.until(lambda s: s["began"] >= 3 and s["moved"] > s["began"])
    assert status["hand"] == "right"
    assert 0.0 < status["pressed"] <= 1.0
    assert status["beside"] < 0.03 + SKIN
    assert status["began"] - status["left"] == status["heard"] <= 1
    assert (status["why"] == "") is (status["output"] == "sounding")
    game.do("hand off")
    status = game.until(lambda s: s["cause"] == "hand not seen")
    assert status["began"] == status["left"]
    assert status["heard"] == 0
    assert status["screen"] == "Silent: " + status["why"]
    game.do("mouse 960 540 1")  # the middle of the window
    assert game.until(felt)["screen"] == "Sounding"
    game.do("mouse 960 540 0")
    game.until(lambda s: s["cause"] == "hand not seen")
    game.do("mouse 960 540 1")
    game.until(lambda s: s["heard"] == 1)
    game.do("disconnect")
    status = game.status()
    assert "not connected" in status["screen"]
    assert (status["heard"], status["left"]) == (0, status["began"])


def test_an_emergency_stop_stays_until_reset(real: Server, game: Game) -> None:
    game.do("again")
    since = time.perf_counter()
    game.do("stop")
    wait_for_silence(real, since)
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
    kill(real)
    assert "nothing of this session goes on" in game.event("lost")["code"]
    mark = real.log.count
    real.start()
    game.event("connected")
    if again:
        sounds(game)
        return
    game.do("warm")
    assert not game.until(lambda s: s["output"] == "silent" and s["frames"] > 45)["armed"]
    assert not sounded_since(real, mark)
    game.do("arm")  # nothing else is needed: the objects are there
    sounds(game)


def test_zones_are_not_sent_again_if_they_are_wrong(built: unity.Built, tmp_path: Path) -> None:
    with Fake() as fake:
        file = fake.connection.write(tmp_path / "connection.json")
        with Game(["mono", "--debug", built.player, file, "0"]) as game:
            game.do("play")
            refuse_zones(fake, game)
            game.do("quit")
            assert game.end() == 0


def test_a_game_without_a_server_says_what_to_do_and_connects_when_it_comes(
    real: Server, built: unity.Built, tmp_path: Path
) -> None:
    file = tmp_path / "connection.json"
    with Game(["mono", "--debug", built.player, file, "0"]) as game:
        game.do("play")
        status = game.until(lambda s: s["problem"] != "")
        assert "is `pacinian serve` running, or still starting?" in status["problem"]
        game.do("stop")
        file.write_bytes(real.file.read_bytes())
        file.chmod(0o600)
        game.event("connected")
        game.do("quit")
        assert game.end() == 0
