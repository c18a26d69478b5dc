"""The messages that a client sends, and how it handles replies."""

import importlib.metadata
import itertools
import math
import threading
import time
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.testing import ManualClock
from pacinian.wire import commands, control, replies
from pacinian.wire.binary_arrays import unpack
from pacinian.wire.convert import to_scene
from pacinian.wire.protocol import MAJOR, MINOR

from ...waiting import PATIENCE
from .fake_server import Fake, state, usual

POINT = pc.Point(position=(0.0, 0.01, 0.2), radiation_pressure=5.0, name="button")
BALL = pc.Volume(
    shape=pc.Sphere(0.03), pose=pc.Pose((0.0, 0.0, 0.2)), radiation_pressure=8.0, name="ball",
    motion=pc.Motion((0.1, 0.0, 0.0)),
)  # fmt: skip


def refuse(server: Fake, kind: type, code: str, **fields: Any) -> None:
    def answer(message: Any) -> replies.Error:
        return replies.Error(id=message.id, code=code, message="no", **fields)  # type: ignore[arg-type]

    server.answers[kind] = answer


def test_hello_says_who_is_there_and_welcome_is_told(server: Fake) -> None:
    with pc.Client(server.connection, name="game", scene="hall", lease=0.1) as client:
        assert (client.scene, client.lease, client.connected) == ("hall", 0.1, True)
    hello, bye = server.seen
    assert (hello.client, hello.scene, hello.lease, hello.protocol) == (
        "game",
        "hall",
        0.1,
        (MAJOR, MINOR),
    )
    assert hello.version == importlib.metadata.version("pacinian")
    assert isinstance(bye, control.Bye)


def test_objects_arrive_as_they_were_put(server: Fake, client: pc.Client) -> None:
    client.put(POINT, BALL, duration=2.0, ttl=0.5)
    (put,) = server.of(commands.Put)
    assert (put.ttl, put.sequence) == (0.5, 1)
    for item in (POINT, BALL):
        wire = put.objects[item.name]
        assert wire.duration == 2.0
        assert to_scene(item.name, wire) == item


def test_moves_hold_poses_and_motions(server: Fake, client: pc.Client) -> None:
    pose = pc.Pose((0.01, 0.02, 0.2)).rotate("z", math.pi / 2.0)
    client.move("a", pose)
    client.moves({"a": pose, "b": pc.Pose()}, {"a": pc.Motion((1, 2, 3), (4, 5, 6))})
    one, two = server.of(commands.Move)
    assert one.names == ("a",)
    assert not one.velocities
    np.testing.assert_allclose(unpack(one.poses, 7), [(*pose.position, *pose.rotation)], rtol=1e-6)
    assert two.names == ("a", "b")
    np.testing.assert_allclose(unpack(two.velocities, 6), [(1, 2, 3, 4, 5, 6), (0,) * 6])


def test_hands_go_with_the_time_they_were_seen_at(server: Fake) -> None:
    clock = ManualClock(100.0)
    with pc.Client(server.connection, clock=clock.now) as client:
        hand = pc.Hand.open("left", time=99.99, velocities=(1.0, 0.0, 0.0))
        client.hands(hand, pc.Hand(np.full((26, 3), np.nan), side="right"))
        client.hands(pc.Hand.open(time=1e9))
        client.hands()
    seen, ahead, none = server.of(commands.Hands)
    left, right = seen.hands
    assert (seen.time, ahead.time, none.time) == (99.99, 100.0, 100.0)
    assert (left.side, right.side, right.joints) == ("left", "right", b"")
    np.testing.assert_allclose(unpack(left.joints, 3), hand.joints, atol=1e-7)
    assert (len(left.radii), len(left.velocities)) == (0, 12)
    assert none.hands == ()


def test_the_rest_of_the_commands(server: Fake, client: pc.Client) -> None:
    zone = commands.Zone(position=(0.0, 0.0, 0.5), pressure=10.0, radius=0.1)
    client.quiet(pc.Zone(position=(0.0, 0.0, 0.5), pressure=10.0, radius=0.1))
    with pytest.raises(pc.ArgumentError, match="zones"):
        client.quiet(zone)  # type: ignore[arg-type]
    client.envelope("ball", pc.Sine(150.0))
    client.clear()
    p = client.field([(0.0, 0.0, 0.2)] * 3)
    np.testing.assert_array_equal(p, [0, 1 - 1j, 2 - 2j])
    assert server.of(commands.Quiet)[0].zones == (zone,)
    assert server.of(commands.Envelopes)[0].names == ("ball",)
    assert len(server.of(commands.Clear)) == 1


def test_the_rest_of_the_requests(server: Fake, client: pc.Client) -> None:
    client.arm(take=True)
    assert client.armed
    client.select(solver="gs-pat", intensity=0.5, technique=pc.AM(100.0))
    client.reset()
    client.stop()
    client.disarm()
    assert not client.armed
    assert client.capabilities().phases == 320
    assert client.status().solver == "auto"
    assert server.of(control.Arm)[0].take
    (chosen,) = server.of(control.Select)
    assert (chosen.solver.name, chosen.backend, chosen.intensity) == ("gs-pat", None, 0.5)
    for kind in (control.Reset, control.Stop, control.Disarm):
        assert len(server.of(kind)) == 1


def test_a_refusal_has_its_code_its_path_and_advice(server: Fake, client: pc.Client) -> None:
    refuse(server, commands.Put, "argument", path="$.objects[ball].shape", advice="try another")
    with pytest.raises(
        pc.Refused, match=r"^\$\.objects\[ball\]\.shape: no; try another$"
    ) as caught:
        client.put(BALL)
    error = caught.value
    assert (error.code, error.path, error.advice) == (
        "argument",
        "$.objects[ball].shape",
        "try another",
    )
    client.clear()  # the session continues


@pytest.mark.parametrize(("advice", "says"), [("update the server", "server"), ("", "older")])
def test_another_version_is_refused_and_says_what_to_update(
    server: Fake, advice: str, says: str
) -> None:
    refuse(server, control.Hello, "version", advice=advice)
    with pytest.raises(pc.Refused, match=f"update the {says}") as caught:
        pc.Client(server.connection)
    assert caught.value.code == "version"


@pytest.mark.parametrize(("major", "older"), [(0, "server"), (2, "client")])
def test_a_welcome_of_another_version_will_not_do(server: Fake, major: int, older: str) -> None:
    def answer(message: Any) -> Any:
        welcome = usual(message)
        return replies.Welcome(
            **{
                **{f: getattr(welcome, f) for f in welcome.__struct_fields__},
                "protocol": (major, 0),
            }
        )

    server.answers[control.Hello] = answer
    with pytest.raises(pc.Refused, match=f"update the {older}"):
        pc.Client(server.connection)


def test_replies_are_matched_by_their_number(server: Fake, client: pc.Client) -> None:
    def answer(message: Any) -> Any:
        other = replies.Error(id=message.id + 1000, code="limit", message="of another call")
        return [other, replies.Ok(id=message.id - 1), replies.Ok(id=message.id)]

    server.answers[commands.Put] = answer
    client.put(BALL)
    assert [error.code for error in client.errors] == ["limit"]
    assert client.errors == []


def test_an_answer_that_cannot_be_read_is_an_error_of_that_call(
    server: Fake, client: pc.Client
) -> None:
    import msgspec

    server.answers[control.Reset] = lambda m: msgspec.defstruct(
        "Odd", [("type", str, "odd"), ("id", int, m.id)]
    )()
    with pytest.raises(pc.Refused, match="cannot be read"):
        client.reset()
    server.answers[control.Arm] = lambda m: replies.Pressures(id=m.id, pressures=b"", time=0.0)
    with pytest.raises(pc.WireError, match="`arm` was answered by a Pressures"):
        client.arm()


def test_errors_of_what_was_not_waited_for_are_kept(server: Fake, client: pc.Client) -> None:
    client.move("nothing", pc.Pose(), wait=False)
    server.until(lambda: client.renew() is None and bool(server.of(commands.Move)))  # type: ignore[func-returns-value]
    assert server.of(commands.Move)[0].id == 0
    error = replies.Error(code="unknown", message="no object", path="$.names[0]")
    server.say(error, 1)
    server.until(lambda: client.connected and bool(client._server_session.errors))
    (told,) = client.errors
    assert (told.code, told.path) == ("unknown", "$.names[0]")


@pytest.mark.parametrize("code", ["expired", "owner", "stopped", "fault"])
def test_renew_tells_once_why_the_sound_ended(server: Fake, client: pc.Client, code: Any) -> None:
    client.arm()
    server.say(replies.Error(code=code, message="silence"))
    server.until(lambda: client.connected and not client.armed)
    with pytest.raises(pc.Refused, match="silence") as caught:
        client.renew()
    assert caught.value.code == code
    client.renew()
    assert client.connected


def test_what_ended_the_sound_before_it_is_armed_is_told_no_more(
    server: Fake, client: pc.Client
) -> None:
    def answer(message: Any) -> Any:
        return [replies.Error(code="expired", message="late"), replies.Ok(id=message.id)]

    server.answers[control.Arm] = answer
    client.arm()
    assert client.armed
    client.renew()


def test_what_ends_the_sound_at_once_after_it_is_armed_is_told(
    server: Fake, client: pc.Client
) -> None:
    def answer(message: Any) -> Any:
        return [replies.Ok(id=message.id), replies.Error(code="stopped", message="silence")]

    server.answers[control.Arm] = answer
    client.arm()
    server.until(lambda: client.connected and not client.armed)
    with pytest.raises(pc.Refused, match="silence"):
        client.renew()
    client.renew()


def test_renewals_go_on_from_the_callers_own_loop_only(server: Fake) -> None:
    looks = itertools.count()
    with pc.Client(server.connection, clock=lambda: 0.004 * next(looks)) as client:
        client.arm()
        client.hold(0.1, every=0.02)
        client.status()
        renewed = len(server.of(control.Renew))
        assert 2 <= renewed <= 6
        client.status()
        assert len(server.of(control.Renew)) == renewed
    sequences = [m.sequence for m in server.of(control.Renew)]
    assert sequences == sorted(set(sequences))


def test_a_slow_selection_keeps_the_lease_of_an_owner(server: Fake, client: pc.Client) -> None:
    held: list[Any] = []
    server.answers[control.Select] = held.append

    def answer(message: Any) -> Any:
        done = [replies.Ok(id=held[0].id)] if len(server.of(control.Renew)) == 3 else []
        return [usual(message), *done]

    server.answers[control.Renew] = answer
    client.arm()
    client.select(solver="lagrange")
    assert len(server.of(control.Renew)) >= 3


def unarmed(message: Any) -> Any:
    return replace(usual(message), owner=False, armed=False)


@pytest.mark.parametrize(
    ("kind", "call"),
    [
        (control.Select, lambda client: client.select(solver="lagrange")),
        (control.Reset, lambda client: client.reset()),
        (control.Arm, lambda client: client.arm()),
        (commands.Put, lambda client: client.put(BALL)),
        (commands.Show, lambda client: client.show()),
    ],
)
def test_while_nothing_is_armed_any_call_that_waits_keeps_the_session(
    server: Fake, client: pc.Client, kind: Any, call: Any
) -> None:
    answered = threading.Event()

    def answer(message: Any) -> Any:
        threading.Thread(target=late, args=(message,)).start()

    def late(message: Any) -> None:
        server.until(lambda: len(server.of(control.Renew)) >= 3)
        reply = replies.Ok(id=message.id)
        if kind is commands.Show:
            reply = replies.Shown(
                id=message.id, scene="", version=1, names=(), poses=b"", objects={}
            )
        server.say(reply, kind in (commands.Put, commands.Show))
        answered.set()

    server.answers[control.Renew] = unarmed
    server.answers[kind] = answer
    call(client)
    assert answered.wait(PATIENCE)


def test_who_only_watches_keeps_the_session(server: Fake, client: pc.Client) -> None:
    def publish() -> None:
        server.until(lambda: len(server.of(control.Renew)) >= 3)
        server.stream = state

    server.answers[control.Renew] = unarmed
    thread = threading.Thread(target=publish)
    thread.start()
    assert next(client.watch(PATIENCE)).output == "silent"
    server.stream = None
    thread.join()


@pytest.mark.parametrize("ran_out", [False, True])
def test_of_what_sounds_or_would_sound_again_no_other_call_renews_the_lease(
    server: Fake, client: pc.Client, ran_out: bool
) -> None:
    """A game that hangs in a call of the client must lose its output, and must not regain it by that call."""
    client.arm()
    if ran_out:
        server.say(
            replies.Renewed(
                id=0, sequence=0, time=0.0, server_time=0.0, until=0.0, owner=True, armed=False
            )
        )
        server.until(lambda: client.connected and not client.armed)
    before = len(server.of(control.Renew))
    server.answers[control.Reset] = lambda message: None
    client._server_session.timeout = 8.0 * client._server_session.renewal_interval
    with pytest.raises(pc.ConnectionLost, match="hangs"):
        client.reset()
    assert len(server.of(control.Renew)) == before


def test_a_selection_need_not_be_waited_for(server: Fake, client: pc.Client) -> None:
    refuse(server, control.Select, "unknown")
    client.select(solver="magic", wait=False)
    server.until(lambda: client.connected and bool(client._server_session.errors))
    assert client.errors[0].code == "unknown"


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda c: c.put(pc.Point(position=(0, 0, 0.2), force=0.1)), r"objects\[0\]"),
        (lambda c: c.put(BALL, BALL), r"objects\[1\]"),
        (lambda c: c.put("ball"), r"objects\[0\]"),
        (lambda c: c.move("ball", (0, 0, 0)), "poses"),
        (lambda c: c.moves({}, {"ball": pc.Motion()}), "motions"),
        (lambda c: c.hands("left"), r"hands\[0\]"),
        (lambda c: c.field([(0.0, 1.0)]), "points"),
        (lambda c: c.clear(ttl=-1.0), "ttl"),
        (lambda c: c.hold(-1.0), "seconds"),
    ],
)
def test_bad_arguments_are_named(server: Fake, client: pc.Client, call: Any, argument: str) -> None:
    with pytest.raises(pc.ArgumentError, match=argument):
        call(client)
    assert len(server.seen) == 1


def test_what_the_wire_cannot_hold_is_told_with_its_path(client: pc.Client) -> None:
    loud = pc.Point(position=(0, 0, 0.2), radiation_pressure=1e9, name="loud")
    with pytest.raises(pc.WireError, match=r"\$\.objects\[loud\]\.radiation_pressure"):
        client.put(loud)


def test_round_trips_and_the_clock_of_the_server_are_measured(server: Fake) -> None:
    begin = time.perf_counter()
    with pc.Client(server.connection, name="test") as client:
        for _ in range(20):
            client.clear()
        median, p99, longest = client.round_trips
        assert 0.0 < median <= p99 <= longest
        age = client.age(client.status())
        assert abs(age) < time.perf_counter() - begin  # one clock for both
