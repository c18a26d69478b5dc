"""The Unreal plugin's components, with stubs of the engine's classes, play against a real server."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import pacinian as pc
from pacinian.wire.modulation import Wave
from pacinian.wire.objects import Volume
from pacinian.wire.shapes import Box, Placed, Union
from pacinian_lab.server.faults.server import Server

from ..core.client.fake_server import Fake
from ..waiting import PATIENCE, eventually
from . import tools, unreal
from .game import (
    HELD,
    LEASE,
    RATE,
    Game,
    count_parts,
    kill,
    look,
    refuse_zones,
    wait_for_expiry,
    wait_for_silence,
    wait_until_free,
)
from .level import MIRROR, PLACE, YAW, array, level, numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from pacinian.wire.state import State

    Array = np.ndarray[Any, Any]

pytestmark = pytest.mark.deep("cmake", "ninja", "g++", "pkg-config")

BALL = np.array([0.0, 0.0, 0.175])  # in the array's frame [m]
RADIUS = 0.03


@pytest.fixture(scope="module")
def program() -> Path:
    """Return the game, compiled without a warning, including the editor's part."""
    unreal.generate(tools.CPP / "build" / "watched" / "headers")
    return tools.watched("play") / "play"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """Return one server for all tests; a test that kills it starts it again."""
    with Server(tmp_path_factory.mktemp("server"), HELD, RATE) as running:
        yield running


@pytest.fixture
def play(program: Path, server: Server) -> Iterator[Callable[..., Game]]:
    """Return a function that starts the game, and end it after the test."""
    wait_until_free(server)
    games: list[Game] = []

    def start(*words: str) -> Game:
        games.append(Game([program, server.file, *words], tools.environment()))
        games[-1].do(f"place array {numbers(PLACE)} {YAW} 1")
        games[-1].do(f"place ball {numbers(100.0 * BALL @ MIRROR)} 0 1")
        return games[-1]

    yield start
    for game in games:
        with game:
            if game.process.poll() is None:
                assert game.end() == 0, game.told[-80:]


def touch(game: Game) -> pc.Hand:
    """Return a hand that rests on the ball."""
    hand = pc.Hand.open("right", pc.Pose((0.0, -0.03, 0.215)))
    game.do(f"joints {numbers(level(hand.joints))}")
    return hand


def connected(game: Game) -> None:
    game.until(lambda told: told["status"] == "connected" and told["output"] != "unknown")


def sounds(game: Game) -> dict[str, Any]:
    return game.until(lambda told: told["output"] == "sounding" and len(told["samples"]) > 0)


def test_a_hand_that_moves_feels_a_ball(play: Callable[..., Game], server: Server) -> None:
    game = play()
    connected(game)
    touch(game)
    game.do("sway 1.5")

    def touches(told: dict[str, Any]) -> bool:
        """Return whether the upper side is felt, where the hand is; late frames may lose the hand for a moment."""
        felt = array(np.reshape(told["samples"], (-1, 3)))
        depth = np.linalg.norm(felt - BALL, axis=1)
        return bool(
            len(felt) and np.all(np.abs(depth - RADIUS) < 0.02) and np.all(felt[:, 2] > BALL[2])
        )

    told = game.until(lambda told: told["output"] == "sounding" and touches(told))
    assert told["armed"]
    assert told["lease"] == 10.0
    assert told["solvers"] > 5
    assert told["drawn"] > 0
    state = look(server)

    def sees_hand_and_ball() -> bool:
        nonlocal state
        state = look(server)
        return bool(state.hands and state.objects)

    eventually(sees_hand_and_ball)
    assert (state.objects, state.owner) == (("ball",), "StubGame")
    hands = np.frombuffer(state.hands, "<f4").reshape(-1, 3)
    assert hands[:, 2].min() > 0.19  # above the ball, in the array's frame
    assert game.status()["latency"] > 0.0


def test_effects_come_and_go(play: Callable[..., Game], server: Server) -> None:
    game = play("handless")
    connected(game)
    game.do("place point 5 -3 20 0 1")

    def there(*names: str) -> bool:
        return set(look(server).objects) == set(names)

    eventually(lambda: there("ball"))
    game.do("play point")
    eventually(lambda: there("ball", "Things.Point"))
    game.do("silence ball")
    eventually(lambda: there("Things.Point"))
    at = np.frombuffer(look(server).points, "<f4").reshape(-1, 3)
    np.testing.assert_allclose(at[0], [-0.03, 0.05, 0.2], atol=1e-4)
    game.do("duration point 1000")
    game.do("play point")
    eventually(lambda: there("Things.Point"))
    game.do("duration point 0.001")  # its duration is over
    eventually(there)
    game.until(lambda s: not s["playing"])
    game.do("duration point 0")
    game.do("place point 0 0 22 0 1")
    game.do("press point 3")
    game.do("play point")
    eventually(lambda: there("Things.Point"))
    eventually(lambda: bool(np.frombuffer(look(server).asked, "<f4") == [3.0]))
    game.do("place point 2 0 22 0 1")
    eventually(lambda: abs(np.frombuffer(look(server).points, "<f4")[1] - 0.02) < 1e-4)
    for step in range(100):  # a slow movement adds up, although each step is too short to be sent
        game.do(f"place point {2.0 + 1e-5 * (step + 1)} 0 22 0 1")
    eventually(lambda: abs(np.frombuffer(look(server).points, "<f4")[1] - 0.02001) < 1.5e-6)
    game.do("tremble point 80")
    game.do("solver lagrange")
    game.do("intensity 0.5")
    eventually(lambda: look(server).solver == "lagrange" and look(server).intensity == 0.5)
    game.do("solver auto")
    game.do("intensity 1")
    eventually(lambda: look(server).solver == "auto" and look(server).intensity == 1.0)
    assert not [told for told in game.told if told.get("event") == "refused"]


def test_colliders_of_what_is_attached_are_part_of_a_volume_while_they_are_there(
    play: Callable[..., Game], server: Server
) -> None:
    game = play("handless", "again")  # a busy machine may lose its connection
    connected(game)
    eventually(lambda: count_parts(server) == 1)
    game.do("shelf 0 0 -5 2")
    eventually(lambda: count_parts(server) == 2)
    game.do("shelf 0 0 -5 0")
    eventually(lambda: count_parts(server) == 1)
    game.do("share ball 0.5")
    assert game.until(lambda s: s["relative"] == 0.5)["wrong"] == ""
    game.do("fade ball")
    game.do("refresh ball")
    with pc.Client(server.file) as onlooker:

        def find_wave() -> Wave | None:
            felt = onlooker.show().objects.get("ball")
            faded = felt is not None and felt.radiation_pressure == 10.0
            return felt.envelope if faded and isinstance(felt.envelope, Wave) else None

        wave = eventually(find_wave)
    samples = np.frombuffer(wave.samples, "<f4")
    assert len(samples) / wave.rate == pytest.approx(0.5)
    np.testing.assert_allclose(samples[[0, -1]], [1.0, 0.0], atol=2e-3)  # the pressure: 1 to 0.5
    assert not [told for told in game.told if told.get("event") == "refused"]


def test_each_change_of_an_attached_collider_is_sent(
    play: Callable[..., Game], server: Server
) -> None:
    """At 60 and at 300 degrees, the quaternion differs only in w."""
    game = play("handless", "again")
    connected(game)
    for side, yaw in [
        (2.0, 60.0),
        (2.0, 300.0),
        (float(np.nextafter(np.float32(2.0), 3.0)), 300.0),
    ]:
        game.do(f"shelf 0 0 -5 {side:.9f} {yaw}")
        turn = Rotation.from_euler("z", -yaw, degrees=True)  # from left-handed to right-handed axes

        def has_box(side: float = side, turn: Rotation = turn) -> bool:
            with pc.Client(server.file, name="onlooker", timeout=PATIENCE) as onlooker:
                ball = onlooker.show().objects.get("ball")
            if not isinstance(ball, Volume) or not isinstance(ball.shape, Union):
                return False
            box = ball.shape.parts[-1]
            assert isinstance(box, Placed)
            assert isinstance(box.shape, Box)
            off = (Rotation.from_quat(box.pose.rotation) * turn.inv()).magnitude()
            return bool(off < 1e-6 and np.allclose(box.shape.size, 0.01 * side, rtol=1e-8))

        eventually(has_box)
    assert not [told for told in game.told if told.get("event") == "refused"]


def test_the_editor_draws_effects_in_their_true_size(play: Callable[..., Game]) -> None:
    game = play("unarmed", "handless")

    def outline(name: str) -> Array:
        """Return the drawn positions in the level, (K, 3) [cm], relative to their mean."""
        game.say(f"outline {name}")
        told = game.wait(lambda t: "outline" in t)
        assert (told["drawn"], told["why"]) == (True, "")
        lines = np.reshape(told["outline"], (-1, 3))
        middle: Array = lines - 0.5 * (lines.min(axis=0) + lines.max(axis=0))
        return middle

    assert np.linalg.norm(outline("ball"), axis=1) == pytest.approx(3.0, abs=1e-6)
    game.do("shelf 0 0 -5 2")  # a cube whose lower side is 6 cm below the ball's middle
    assert np.ptp(outline("ball") @ [0.0, 0.0, 1.0]) == pytest.approx(9.0, abs=1e-6)
    game.do("place point 5 -3 20 0 1")
    assert np.linalg.norm(outline("point"), axis=1) == pytest.approx(0.425, abs=1e-6)
    game.do("place plate 3 1 20 90 2")
    game.do("rectangle")
    corners = np.linalg.norm(outline("plate"), axis=1)
    assert corners == pytest.approx(np.hypot(10.0, 10.0), abs=1e-5)
    game.do("disc")
    assert np.linalg.norm(outline("plate"), axis=1) == pytest.approx(10.0, abs=1e-5)


def test_a_second_server_component_says_why_it_waits_and_takes_over(
    play: Callable[..., Game],
) -> None:
    game = play("handless")
    connected(game)
    game.do("second")
    told = game.until(lambda s: s["rival"] != "")
    assert "that of Array is used" in told["rival"]
    assert told["rival_status"] == "stopped"
    game.do("first")
    assert game.until(lambda s: s["rival_status"] == "connected")["rival"] == ""


def test_an_open_hand_feels_as_a_tracked_one_does(play: Callable[..., Game]) -> None:
    game = play()
    connected(game)
    game.do(f"open {numbers(level([0.0, -0.03, 0.215]))}")
    told = sounds(game)
    felt = array(np.reshape(told["samples"], (-1, 3))) - BALL
    assert np.all((felt[:, 2] > 0.0) & (np.abs(np.linalg.norm(felt, axis=1) - RADIUS) < 0.02))
    assert game.until(lambda s: s["emitted"] > 0.5)["wrong"] == ""
    assert not game.until(lambda s: s["force"] > 0.5)["pointed"]
    game.do("stm")
    sounds(game)
    assert not [told for told in game.told if told.get("event") == "refused"]


def test_several_hands_of_a_side_and_effects_of_a_name(
    play: Callable[..., Game], server: Server
) -> None:
    game = play()
    connected(game)
    touch(game)
    game.do("pair")
    eventually(lambda: len(look(server).hands) == 2 * 312)
    eventually(lambda: set(look(server).objects) == {"ball", "ball 2"})
    eventually(lambda: {touch.hand for touch in look(server).touches} == {"right", "right 2"})
    assert not [told for told in game.told if told.get("event") == "refused"]


def test_a_quiet_zone_of_no_pressure_protects_and_takes_no_other_with_it(
    play: Callable[..., Game],
) -> None:
    game = play("handless")
    connected(game)
    game.do("quiet 0 0 500 10 0")
    game.do("quiet 0 0 500 10 -1")
    sounds(game)
    assert not [told for told in game.told if told.get("event") == "refused"]


def test_zones_that_were_refused_are_told_and_sent_again(
    play: Callable[..., Game], server: Server
) -> None:
    with pc.Client(server.file, scene="hall", timeout=PATIENCE) as other:

        def fills_the_scene() -> bool:
            try:
                other.quiet(*(pc.Zone((0.0, 0.0, 5.0), pressure=100.0) for _ in range(16)))
            except pc.PacinianError:
                return False
            return True

        assert fills_the_scene()
        game = play("handless", "shared")
        for _ in range(2):
            assert "16 zones" in game.event("refused")["message"]
        assert len([t for t in game.told if "16 zones" in t.get("said", "")]) == 1  # logged once
        game.until(lambda told: "16 zones" in told["problem"])

        def has_the_games_zone() -> bool:
            other.quiet()
            time.sleep(0.2)
            return not fills_the_scene()

        eventually(has_the_games_zone)


def test_zones_are_not_sent_again_if_they_are_wrong(program: Path, tmp_path: Path) -> None:
    with Fake() as fake:
        file = fake.connection.write(tmp_path / "connection.json")
        with Game([program, file, "handless"], tools.environment()) as game:
            refuse_zones(fake, game)
            assert game.end() == 0, game.told[-20:]


def test_a_stop_that_is_not_confirmed_is_told_without_a_connection(
    program: Path, tmp_path: Path
) -> None:
    with Game([program, tmp_path / "none.json"], tools.environment()) as game:
        game.do("disconnect")
        game.do("stop")
        problem = game.until(lambda told: told["problem"] != "")["problem"]
        assert "the stop was not confirmed" in problem
        assert "switch the array off" in problem
        assert game.end() == 0


def test_the_mouse_moves_a_hand_while_its_button_is_down(
    play: Callable[..., Game], server: Server
) -> None:
    def palm_is_at(position: list[float]) -> bool:
        palm = np.frombuffer(look(server).hands, "<f4")[:3]  # empty until the server has a hand
        return palm.size == 3 and np.allclose(palm, position, atol=1e-3)

    game = play()
    connected(game)
    game.do(f"open {numbers(level([0.0, 0.0, 0.215]))}")
    game.do("mouse 960 540 0")
    eventually(lambda: not look(server).hands)
    game.do("mouse 960 540 1")  # the middle of the window
    sounds(game)
    eventually(lambda: palm_is_at([0.0, 0.0, 0.215]))
    game.do("mouse 1920 540 1")
    eventually(lambda: palm_is_at([0.15, 0.0, 0.215]))
    game.do("mouse 960 0 1")
    eventually(lambda: palm_is_at([0.0, 0.15, 0.215]))
    assert game.status()["cursor"]
    game.do(f"open {numbers(level([0.0, 0.0, 0.215]))}")
    game.until(lambda s: not s["cursor"])  # hidden again


def test_what_is_refused_is_told_where_it_is_and_takes_nothing_with_it(
    play: Callable[..., Game], server: Server
) -> None:
    game = play("handless")
    connected(game)
    game.do("press point 100000")  # more than the server allows
    game.do("place point 0 0 22 0 1")
    game.do("refresh ball")
    game.do("play point")  # in one message with the ball
    assert "radiation_pressure" in game.event("refused")["message"] + game.status()["problem"]
    eventually(lambda: look(server).objects == ("ball",))
    game.until(lambda s: s["faulty"] != "")
    game.do("press point 3")
    eventually(lambda: set(look(server).objects) == {"ball", "Things.Point"})
    assert game.until(lambda s: s["faulty"] == "" == s["problem"])["wrong"] == ""
    for line in ("press point 100000", "press ball 100000"):
        game.do(line)
    status = game.until(lambda s: s["faulty"] != "" and s["wrong"] != "")
    assert "(" in status["problem"]  # the path
    assert not status["problem"].endswith("; ")
    count = len([told for told in game.told if told.get("event") == "refused"])
    game.do("press ball 5")
    assert game.until(lambda s: s["wrong"] == "")["faulty"] == status["faulty"]
    eventually(lambda: look(server).objects == ("ball",))
    assert len([told for told in game.told if told.get("event") == "refused"]) == count


def test_a_scale_of_0_is_told_without_the_server(play: Callable[..., Game]) -> None:
    game = play("handless")
    connected(game)
    game.do(f"place ball {numbers(100.0 * BALL @ MIRROR)} 0 0")
    game.until(lambda s: "scale is 0" in s["wrong"])
    game.do(f"place ball {numbers(100.0 * BALL @ MIRROR)} 0 1")
    game.until(lambda s: s["wrong"] == "")
    assert not [told for told in game.told if told.get("event") == "refused"]


def _upper(state: State, half: tuple[float, float], height: float) -> np.ndarray[Any, Any]:
    """Return the normals, (K, 3), of the points at a height [m], except those of a box's rim.

    Return none at all unless all points are on a plate that extends `half` [m] to each side of (10, 30) mm, and there
    are points on all sides of its middle.
    """
    points, normals = (
        np.frombuffer(rows, "<f4").reshape(-1, 3) for rows in (state.points, state.normals)
    )
    if not len(points):
        return normals
    from_middle = points[:, :2] - [0.01, 0.03]
    there = np.all(np.abs(from_middle) < np.add(half, 1e-3))
    around = np.all(from_middle.min(axis=0) < 1e-3) and np.all(from_middle.max(axis=0) > -1e-3)
    level = np.abs(points[:, 2] - height) < 1e-4
    return normals[there & around & level & (np.abs(normals[:, 2]) > 0.5)]


@pytest.mark.parametrize(
    ("shape", "half", "height"),
    [
        ("rectangle", (0.05, 0.05), 0.2),
        ("disc", (0.05, 0.05), 0.2),
        ("mesh 6 4 1", (0.03, 0.02), 0.205),
    ],
)
@pytest.mark.parametrize("scale", ["1 1 1", "-1 1 1", "1 1 -1"])
def test_surfaces_face_up_and_a_flat_one_down_if_mirrored_along_z(
    play: Callable[..., Game], server: Server, scale: str, shape: str,
    half: tuple[float, float], height: float,
) -> None:  # fmt: skip
    game = play("handless")
    connected(game)
    for line in (f"place plate 3 1 20 90 {scale}", shape, "silence ball", "play plate", "arm"):
        game.do(line)
    upper = np.empty((0, 3))

    def sees_surface() -> bool:
        nonlocal upper
        upper = _upper(look(server), half, height)
        return len(upper) > 0

    eventually(sees_surface)
    if shape.startswith("mesh"):  # the ball has become a box of that mesh
        game.do("play ball")
        eventually(lambda: set(look(server).objects) == {"ball", "Things.Surface"})
    up = -1.0 if scale.endswith("-1") and not shape.startswith("mesh") else 1.0
    np.testing.assert_allclose(upper, np.broadcast_to([0.0, 0.0, up], upper.shape), atol=1e-3)
    assert not [told for told in game.told if told.get("event") == "refused"]


def test_another_mesh_of_a_surface_is_sent(play: Callable[..., Game], server: Server) -> None:
    game = play("handless")
    connected(game)
    for line in ("place plate 3 1 20 90 1 1 1", "mesh 6 4 1", "silence ball", "play plate", "arm"):
        game.do(line)
    eventually(lambda: len(_upper(look(server), (0.03, 0.02), 0.205)) > 0)
    game.do("mesh 6 4 2")
    eventually(lambda: len(_upper(look(server), (0.03, 0.02), 0.21)) > 0)
    assert not [told for told in game.told if told.get("event") == "refused"]


def test_alignment_finds_the_array(play: Callable[..., Game]) -> None:
    game = play("unarmed")
    game.until(lambda told: told["solvers"] > 5)
    game.say("align 10 20 -30 -75")
    told = game.wait(lambda t: "aligned" in t)
    assert told["aligned"]
    assert told["touched"] == 4
    assert told["residual"] < 1e-3
    at, x = np.reshape(told["at"], (2, 3))
    np.testing.assert_allclose(at, [10.0, 20.0, -30.0], atol=1e-3)
    np.testing.assert_allclose(
        x, Rotation.from_euler("z", -75.0, degrees=True).apply([1.0, 0.0, 0.0]), atol=1e-5
    )


def test_a_game_that_hangs_falls_silent(play: Callable[..., Game], server: Server) -> None:
    game = play("short")
    touch(game)
    assert game.sounding(lambda s: len(s["samples"]) > 0)["lease"] == LEASE
    since = time.perf_counter()
    game.stand_still()
    wait_for_expiry(server, since, stood=2.0 * LEASE)
    game.say("status")  # it goes on
    game.event("stood still")
    game.until(lambda s: s["armed"] and s["output"] == "sounding")  # by itself
    assert not [told for told in game.told if told.get("event") == "ended"]


def test_frames_that_all_outlast_the_lease_are_explained(play: Callable[..., Game]) -> None:
    """The editor draws three frames a second while another window has the focus."""
    game = play("short")
    touch(game)
    game.sounding()
    game.do(f"frame {1.5 * LEASE}")
    game.wait(lambda told: "Use Less CPU when in Background" in told.get("said", ""))


def test_a_dedicated_server_does_not_connect(play: Callable[..., Game]) -> None:
    game = play("dedicated")
    for _ in range(5):
        assert game.status()["status"] == "stopped"
    assert not [told for told in game.told if told.get("event") == "connected"]


@pytest.mark.parametrize("has_folder", [True, False])
def test_a_server_starts_without_the_folder_of_its_log(
    program: Path, tmp_path: Path, has_folder: bool
) -> None:
    script = tmp_path / "pacinian"
    script.write_text("#!/bin/sh\necho 'error: no array' >&2\nexit 3\n")
    script.chmod(0o755)
    if not has_folder:
        (tmp_path / "Saved").touch()  # in the place of the folder
    error = ": error: no array" if has_folder else ""
    with Game([program, tmp_path / "connection.json"], tools.environment()) as game:
        game.do(f"serve {script}")
        game.until(lambda s: s["problem"] == f"the server has ended, with exit code 3{error}")
        assert game.end() == 0
    assert (tmp_path / "Saved" / "Logs" / "PacinianServer.log").is_file() is has_folder


def test_touches_are_told_and_why_it_is_silent(play: Callable[..., Game]) -> None:
    game = play()
    connected(game)
    far = pc.Hand.open("right", pc.Pose((0.0, -0.03, 0.3)))
    game.do(f"joints {numbers(level(far.joints))}")
    told = game.until(lambda s: '"ball" is nearest' in s["silence"] and s["silence"] in s["screen"])
    assert told["cause"] == "nothing in reach"
    touch(game)
    began = game.event("touch")
    assert (began["effect"], began["hand"]) == ("ball", "right")
    assert 0.0 < began["strength"] <= 1.0
    assert np.linalg.norm(array(np.reshape(began["at"], (-1, 3))) - BALL) < RADIUS + 0.01
    told = game.until(lambda s: s["touched"] == "ball" and s["output"] == "sounding")
    assert told["silence"] == told["cause"] == ""
    game.do("lost")
    assert game.event("left")["effect"] == "ball"
    game.until(lambda s: s["cause"] == "hand not seen")
    touch(game)
    game.event("touch")
    game.say("disconnect")
    game.event("left")
    assert game.until(lambda s: s["cause"] == "not connected")["silence"] != ""


def test_a_server_that_ends_and_comes_again(play: Callable[..., Game], server: Server) -> None:
    game, other = play(), play("unarmed", "again")
    connected(other)
    touch(game)
    sounds(game)
    kill(server)
    for each in (game, other):
        each.event("lost")
    server.start()
    for each in (game, other):
        connected(each)
    eventually(lambda: [c.objects for c in look(server).clients if c.name == "StubGame"] == [1, 1])
    assert not look(server).armed
    assert not game.status()["armed"]
    game.do("arm")
    sounds(game)


def test_armed_again_after_a_loss_if_that_is_wanted(
    play: Callable[..., Game], server: Server
) -> None:
    game = play("again")
    touch(game)
    sounds(game)
    kill(server)
    game.event("lost")
    server.start()
    connected(game)
    sounds(game)


@pytest.mark.parametrize(
    "way", ["level", "disconnect", "disarm", "stop", "exit", "unload", "lost", "handless", "end"]
)
def test_what_ends_sound(play: Callable[..., Game], server: Server, way: str) -> None:
    game = play()
    touch(game)
    sounds(game)
    since = time.perf_counter()
    game.do(way)
    wait_for_silence(server, since)
    if way not in {"lost", "handless", "stop", "level"}:
        wait_until_free(server)  # so the session has ended, not only the lease
    if way == "level":  # another level, in which nothing is touched
        connected(game)
    if way == "stop":
        assert game.event("ended")["code"] == "stopped"
        game.until(lambda told: told["output"] == "stopped")
        game.do("reset")
        game.until(lambda told: told["output"] == "silent")
        game.do("arm")
        sounds(game)


def test_no_server_no_wait(program: Path, tmp_path: Path) -> None:
    with Game([program, tmp_path / "connection.json"], tools.environment()) as game:
        told = game.until(lambda t: t["status"] == "connecting" and t["screen"] != "")
        assert "pacinian serve" in told["problem"]
        assert told["screen"] == f"Haptics: {told['problem']}"
        assert len([t for t in game.told if "Not connected" in t.get("said", "")]) == 1
        game.do("stop")
        game.do("end")
