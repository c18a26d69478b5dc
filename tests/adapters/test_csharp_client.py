"""The client in C#, and servers that refuse, hang, end or come back: it never blocks, and nothing old arrives."""

from __future__ import annotations

import itertools
import time
from typing import TYPE_CHECKING

import pytest
from msgspec.structs import replace

from pacinian.wire import commands, control, replies
from pacinian.wire.binary_arrays import pack, unpack
from pacinian.wire.protocol import MAJOR, MINOR
from pacinian.wire.state import TouchState

from ..core.client.fake_server import Fake, state, usual
from ..waiting import PATIENCE, eventually
from .blockable_link import BlockableLink
from .game import HEAVY, await_step, fill

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from .game import Game

pytestmark = pytest.mark.deep("mono", "mcs")


def subscribed(server: Fake, game: Game) -> None:
    """Wait until the client receives published states."""
    server.stream = lambda: state(0)
    game.until(lambda s: s["objects"] >= 0)
    server.stream = None


def count_messages(server: Fake) -> int:
    """Return how many messages have arrived, except renewals."""
    return len(server.seen) - len(server.of(control.Renew))


def test_hello_and_all_commands(server: Fake, game: Game) -> None:
    (hello,) = server.of(control.Hello)
    assert (hello.client, hello.protocol) == ("driver", (MAJOR, MINOR))
    status = game.status()
    assert (status["status"], status["problem"], status["lease"]) == ("Connected", "", 0.25)
    assert status["solvers"] == 0
    said = [
        "put ball 0 0.01 0.2 20", "move ball 0.01 0 0.3", "envelope ball 100", "remove ball", "quiet 0 0 0 0.4 100",
        "solver gs", "backend probe", "intensity 0.5", "arm take", "disarm", "reset", "clear",
    ]  # fmt: skip
    for line in said:
        before = count_messages(server)
        assert game.do(line)["done"], line
        server.until(lambda n=before: count_messages(server) > n)  # type: ignore[misc]
    game.do("field at 0 0.01 0.2")
    assert game.wait(lambda told: "field" in told)["field"] == 1
    put = server.of(commands.Put)[0].objects["ball"]
    assert (put.position, put.radiation_pressure) == ((0.0, 0.01, 0.2), 20.0)
    move = server.of(commands.Move)[0]
    assert unpack(move.poses, 7)[0].tolist() == pytest.approx([0.01, 0, 0.3, 0, 0, 0, 1])
    assert server.of(commands.Envelopes)[0].envelope.frequency == 100.0
    assert server.of(commands.Remove)[0].names == ("ball",)
    assert server.of(commands.Quiet)[0].zones[0].position == (0.0, 0.0, 0.4)
    selects = server.of(control.Select)
    assert [s.solver and s.solver.name for s in selects] == ["gs", None, None]
    assert [s.backend and s.backend.name for s in selects] == [None, "probe", None]
    assert [s.intensity for s in selects] == [None, None, 0.5]
    assert server.of(control.Arm)[0].take
    for kinds_of in (commands.COMMANDS, (control.Renew,)):
        sequences = [m.sequence for m in server.seen if isinstance(m, kinds_of)]
        assert sequences == sorted(set(sequences))


def test_the_newest_state_and_what_comes_unasked(server: Fake, game: Game) -> None:
    subscribed(server, game)
    server.publish(*(state(i, solver=f"s{i}") for i in range(1, 51)))
    assert game.until(lambda s: s["sequence"] == 50)["solver"] == "s50"
    game.do("arm")
    server.until(lambda: bool(server.of(control.Arm)))  # its answer precedes later messages
    assert game.until(lambda s: s["armed"])["owner"]
    for code in ("expired", "owner", "stopped", "fault"):
        server.say(replies.Error(code=code, message=f"it is {code}", advice="arm again"))
        told = game.event("ended", code)
        assert (told["message"], told["advice"]) == (f"it is {code}", "arm again")
    path = "$.objects[ball].shape"
    server.say(replies.Error(code="argument", message="no", path=path))
    assert game.event("refused", "argument")["path"] == path


def test_what_is_felt_is_told_by_the_objects_name(server: Fake, game: Game) -> None:
    subscribed(server, game)
    figures = [[float("nan")] * 4, [0.98, 0.06, 0.0, 1.3]]
    felt = state(1, output="sounding", objects=("point", "ball"), felt=pack(figures))
    server.publish(felt)
    game.until(lambda s: s["sequence"] == 1)
    told = game.felt("ball")
    assert [told[key] for key in ("known", "force", "rms", "holes", "spill")] == pytest.approx(
        [True, 0.98, 0.06, 0.0, 1.3]
    )
    assert not game.felt("point")["known"]
    assert not game.felt("gone")["known"]
    server.publish(replace(felt, sequence=2, output="silent"))
    game.until(lambda s: s["sequence"] == 2)
    assert not game.felt("ball")["known"]


def test_touches_begin_move_and_end(server: Fake, game: Game) -> None:
    """Also if a state is lost, if a hand moves to another object between two states, and at the session's end."""
    subscribed(server, game)
    own = game.status()["scene"]
    numbers = itertools.count(1)

    def publish(*touches: tuple[str, str, float], scene: str = own) -> None:
        told = tuple(
            TouchState(object=o, hand=h, position=(0.0, 0.0, z), pressure=10.0 * z, strength=z)
            for o, h, z in touches
        )
        server.publish(state(next(numbers), scene=scene, touches=told))

    def hears(event: str) -> tuple[str, str]:
        told = game.event(event)
        return told["object"], told["hand"]

    publish(("ball", "left", 0.25), ("ball", "right", 0.5))
    assert [hears("touch"), hears("touch")] == [("ball", "left"), ("ball", "right")]
    publish(("ball", "right", 0.75))
    assert hears("left") == ("ball", "left")
    assert game.until(lambda s: s["strength"] == 0.75)["height"] == 0.75
    publish(("cube", "right", 1.0))
    assert hears("left") == ("ball", "right")
    assert hears("touch") == ("cube", "right")
    publish(("cube", "right", 1.0), scene="another game's")
    assert hears("left") == ("cube", "right")
    publish(("cube", "right", 1.0))
    assert hears("touch") == ("cube", "right")
    server.say(replies.Error(code="session", message="gone"))
    assert hears("left") == ("cube", "right")
    game.event("lost")


def test_a_client_that_has_ended_lists_no_touch(server: Fake, game: Game) -> None:
    subscribed(server, game)
    touch = TouchState(
        object="a", hand="left", position=(0.0, 0.0, 0.2), pressure=1.0, strength=1.0
    )
    server.publish(state(1, scene=game.status()["scene"], touches=(touch,)))
    game.until(lambda s: s["touches"] == 1)
    game.do("dispose")
    assert game.status()["touches"] == 0


def test_one_bad_object_refuses_itself_by_name(server: Fake, game: Game) -> None:
    """It is not sent, so that no other object is rejected with it."""
    for line, path, says in (
        ("ball small -0.03 5", "$.objects[small].shape.radius", "0"),
        ("ball mute 0.03 0", "$.objects[mute]", "must have a radiation pressure or a force"),
        (f"ball {'n' * 65} 0.03 5", f"$.objects[{'n' * 65}]", "1 to 64 characters"),
    ):
        assert not game.do(line)["done"]
        refused = game.event("refused", "argument")
        assert refused["path"] == path
        assert says in refused["message"]
    assert game.do("ball good 0.03 5")["done"]
    server.until(lambda: bool(server.of(commands.Put)))
    assert [list(put.objects) for put in server.of(commands.Put)] == [["good"]]


def test_a_call_from_another_thread_does_nothing_and_is_told_once(server: Fake, game: Game) -> None:
    assert not game.do("elsewhere late 0 0 0.2 5")["done"]
    assert "another thread" in game.event("refused", "thread")["message"]
    assert not game.do("elsewhere late 0 0 0.2 5")["done"]
    assert game.do("put good 0 0 0.2 5")["done"]
    server.until(lambda: bool(server.of(commands.Put)))
    assert [list(put.objects) for put in server.of(commands.Put)] == [["good"]]
    assert len([told for told in game.told if told.get("event") == "refused"]) == 1


def test_why_it_is_silent_is_what_the_server_says_or_what_only_a_client_knows(
    server: Fake, start: Callable[..., Game], file: Path
) -> None:
    with start(file) as game:
        status = game.status()
        assert status["cause"] == "not connected"
        assert "call Start" in status["why"]
        assert not game.do("put ball 0 0 0.2 5")["done"]
        game.do("start")
        # C++ reports it also before the start
        refused = eventually(
            lambda: next((t for t in game.told if t.get("code") == "session"), None)
        )
        assert "`put` was asked for, but there is no session" in refused["message"]
        status = game.until(lambda s: s["status"] == "Connected")
        assert status["cause"] == "not connected"
        assert status["why"] == "connected; the server has not sent its first state yet"
        server.stream = lambda: state(cause="pause", why="an envelope is at 0")
        game.until(lambda s: (s["cause"], s["why"]) == ("pause", "an envelope is at 0"))
        server.stream = lambda: state(output="sounding", owner="other", scene="hall")
        game.until(lambda s: s["cause"] == "" or s["cause"] == "not the owner")
        server.answers[control.Renew] = lambda m: replies.Renewed(
            id=m.id, sequence=m.sequence, time=m.time, server_time=m.time, until=m.time, owner=False, armed=False
        )  # fmt: skip
        assert (
            '"other" owns the output' in game.until(lambda s: s["cause"] == "not the owner")["why"]
        )
        for cause in ("stopped", "fault"):  # which hold for everybody
            server.stream = lambda cause=cause: state(  # type: ignore[misc]
                output="stopped", owner="other", scene="hall", cause=cause, why=f"it is {cause}"
            )
            game.until(lambda s, cause=cause: (s["cause"], s["why"]) == (cause, f"it is {cause}"))  # type: ignore[misc]
        server.close()
        game.until(lambda s: s["cause"] == "not connected" and "has gone" in s["why"])


@pytest.mark.parametrize("of", ["control", "state"])
def test_what_cannot_be_read_is_told_once_and_skipped(server: Fake, game: Game, of: str) -> None:
    subscribed(server, game)
    router, _, publisher = server._sockets  # pyright: ignore[reportPrivateUsage]
    for _ in range(3):
        if of == "control":
            server.do(lambda: router.send_multipart([server.peers[0], b"\x81\xa4type\xa3new"]))
        else:
            server.do(lambda: publisher.send_multipart([b"state", b"\xc1"]))
    assert "update the older" in game.event("refused", "malformed")["advice"]
    server.publish(state(7))
    game.until(lambda s: s["sequence"] == 7)
    assert len([t for t in game.told if t.get("code") == "malformed"]) == 1


def test_renewals_come_from_the_games_own_tick(server: Fake, game: Game) -> None:
    server.until(lambda: len(server.of(control.Renew)) > 3)
    stopped = game.do("tick off")["time"]
    game.do("put ball 0 0 0.2 5")  # the client's own thread is alive
    server.until(lambda: bool(server.of(commands.Put)))
    renewals = [r.time for r in server.of(control.Renew)]
    assert renewals == sorted(renewals)
    assert renewals[-1] <= stopped  # none has a later time than that of a tick
    game.do("tick on")
    server.until(lambda: len(server.of(control.Renew)) > len(renewals) + 3)


CALLS = (
    "put ball 0 0 0.2 5", "move ball 0 0 0.2", "envelope ball 100", "remove ball", "quiet 0 0 0 0.4 100", "wave on",
    "field at 0 0 0", "solver gs", "backend probe", "intensity 0.5", "arm", "disarm", "reset", "stop", "clear",
)  # fmt: skip


def test_no_call_waits_for_the_clients_own_thread_which_alone_waits_for_the_server(
    server: Fake, game: Game
) -> None:
    game.do("hold")
    for line in CALLS:
        assert game.do(line)["done"], line
    assert game.status()["status"] == "Connected"
    server.until(lambda: bool(server.of(control.Stop)))  # uses its own connection
    assert not server.of(commands.Put) + server.of(commands.Clear) + server.of(control.Arm)
    game.do("release")
    server.until(lambda: bool(server.of(commands.Clear) and server.of(control.Reset)))


@pytest.mark.parametrize("how", ["stopped", "dumb"])
def test_a_server_that_hangs_is_lost(
    server: Fake, tmp_path: Path, start: Callable[..., Game], how: str
) -> None:
    with BlockableLink(server.connection.control) as line:
        path = replace(server.connection, control=line.address).write(tmp_path / "hangs.json")
        with start(path, timeout=2.0) as game:
            game.do("start")
            game.event("connected")
            if how == "stopped":  # like a stopped process, whose heartbeats end, too
                line.goes.clear()
                says = "has gone"
            else:
                server.answers[control.Renew] = lambda _: None
                says = "no answer to `renew` within 2 s: the server hangs"
            game.wait(lambda told: told.get("event") == "lost" and says in told["message"])
            assert not game.do("put ball 0 0 0.2 5")["done"]


def height(move: commands.Move) -> float:
    """Return the height of its first object [m]."""
    return float(unpack(move.poses, 7)[0, 2])


def test_the_newest_wins_while_there_is_no_room(
    server: Fake, wire: BlockableLink, game: Game
) -> None:
    fill(server, game, wire)
    for i in range(50):
        game.do(f"move rain 0 0 {i / 100}")
    assert server.of(commands.Move) == []
    wire.goes.set()
    server.until(lambda: any(height(m) == pytest.approx(0.49) for m in server.of(commands.Move)))
    assert (
        len(server.of(commands.Move)) < 25
    )  # one or two: the sockets may still take one before they are full
    assert len(server.of(commands.Put)) < HEAVY


def test_what_waits_too_long_is_not_sent(
    server: Fake, wire: BlockableLink, file: Path, start: Callable[..., Game]
) -> None:
    """A trial in which the link was lost does not count, because a new link has room: try again."""
    with start(file, life=1.0) as game:
        game.do("start")
        end, sessions, height_of_trial = time.monotonic() + PATIENCE, -1, 0.2
        while len(server.of(control.Hello)) != sessions:
            assert time.monotonic() < end, "the machine is too busy"
            game.until(lambda s: s["status"] == "Connected")
            sessions = len(server.of(control.Hello))
            fill(server, game, wire)
            height_of_trial += 0.001  # a move of another trial may still arrive
            asked = game.do(f"move rain 0 0 {height_of_trial:.3f}")["time"]
            game.until(lambda s, t=asked: s["time"] > t + 1.0)  # type: ignore[misc]
            for _ in range(2):  # a step that began before that time ends with the first
                await_step(server, game)
            wire.goes.set()
            hands = len(server.of(commands.Hands))
            game.do("wave on")  # hands are sent after all other commands
            server.until(lambda n=hands: len(server.of(commands.Hands)) > n)  # type: ignore[misc]
            game.do("lose")
        assert all(height(m) != pytest.approx(height_of_trial) for m in server.of(commands.Move))


def test_nothing_old_reaches_a_new_server_and_nothing_resumes(
    server: Fake, wire: BlockableLink, game: Game
) -> None:
    game.do("put ball 0 0 0.2 5")
    game.do("arm")
    game.until(lambda s: s["armed"])
    fill(server, game, wire)
    for i in range(20):
        game.do(f"heavy rain{i} 5000")
    server.close()
    told = game.event("lost")
    assert "has gone" in told["message"]
    assert "nothing of this session goes on" in told["message"]
    for line in ("put ball 0 0 0.2 5", "move ball 0 0 0.2", "arm", "clear", "field at 0 0 0"):
        assert not game.do(line)["done"]
    wire.goes.set()
    with Fake(server.ports) as again:
        again.answers[control.Renew] = lambda m: replace(usual(m), owner=False, armed=False)
        game.event("connected")
        again.until(lambda: len(again.of(control.Renew)) > 3)
        assert not game.status()["armed"]
        kinds = {type(m) for m in again.seen}
        assert kinds == {control.Hello, control.Capabilities, control.Renew}
        assert game.do("put ball 0 0 0.2 5")["done"]
        again.until(lambda: bool(again.of(commands.Put)))


def test_sessions_that_ended_while_the_game_stood_still_are_not_told(
    server: Fake, game: Game
) -> None:
    game.do("arm")
    game.until(lambda s: s["armed"])
    begin = len(game.told)
    stopped = game.do("tick off")["time"]
    for hellos in (2, 3):
        server.say(replies.Error(code="session", message="nothing was renewed for 10 s"))
        server.until(lambda n=hellos: len(server.of(control.Capabilities)) == n)  # type: ignore[misc]
    game.until(lambda s: s["time"] > stopped + s["lease"])
    game.do("tick on")
    game.event("connected")
    assert game.do("put ball 0 0 0.2 5")["done"]
    server.until(lambda: bool(server.of(commands.Put)))
    assert [t["event"] for t in game.told[begin:] if "event" in t] == ["lost", "connected"]


def test_a_session_that_the_server_has_ended(server: Fake, game: Game) -> None:
    server.say(replies.Error(code="session", message="the bus was started anew"))
    assert "the bus was started anew" in game.event("lost")["message"]
    game.event("connected")
    assert len(server.of(control.Hello)) == 2
