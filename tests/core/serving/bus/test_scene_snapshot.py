"""Snapshots of the rendered scene for observers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pacinian.errors import WireError
from pacinian.serving.bus.conversion_queue import Converter
from pacinian.serving.bus.dispatcher import carry_out
from pacinian.serving.bus.message_admission import BusSession
from pacinian.serving.bus.scene_snapshot import MAX_SNAPSHOT_BYTES, make_snapshot
from pacinian.serving.bus.shared_scene import SharedScene
from pacinian.serving.ipc.messages import SessionInfo
from pacinian.serving.settings import Settings
from pacinian.wire import commands, objects, shapes
from pacinian.wire.binary_arrays import pack, unpack
from pacinian.wire.codec import decode_reply, encode
from pacinian.wire.protocol import MAX_COMMAND_BYTES, MAX_REPLY_BYTES, MAX_SHOWN
from pacinian.wire.replies import Shown

from ..fake_renderer import AtOnce

KEY = b"k" * 16
POINT = objects.Point(position=(0.1, 0.2, 0.3), force=0.01)
BALL = objects.Volume(
    shape=shapes.Sphere(0.02), pose=shapes.Pose((0.0, 0.0, 0.2), (0.0, 0.0, 0.6, 0.8)), force=0.01
)


class Hall:
    """A shared scene with a client."""

    def __init__(self) -> None:
        settings = Settings()
        self.room = SharedScene(settings, Converter(settings.safety.pressure, AtOnce()), "hall")
        self.client = BusSession(SessionInfo(KEY, "game", "hall", "user"), 1)

    def do(self, kind: type[Any], **fields: Any) -> None:
        command = kind(session=KEY, sequence=1, time=0.0, **fields)
        carry_out(self.room, self.client, command, 0.0, 0.0, len(encode(command)))

    def put(self, **items: objects.Object) -> None:
        self.do(commands.Put, objects=items)

    def show(self, scene: str = "", since: int = 0) -> Shown:
        """Return the reply to `show`, encoded and decoded."""
        asked = commands.Show(session=KEY, sequence=1, time=0.0, id=1, scene=scene, since=since)
        answer = decode_reply(encode(make_snapshot(self.room, asked)))
        assert isinstance(answer, Shown)
        return answer


@pytest.fixture
def hall() -> Hall:
    return Hall()


def test_objects_are_told_as_they_were_put_and_only_once(hall: Hall) -> None:
    hall.put(ball=BALL, point=POINT)
    first = hall.show()
    assert (first.scene, first.names) == ("hall", ("ball", "point"))
    assert first.objects == {"ball": BALL, "point": POINT}
    assert np.allclose(
        unpack(first.poses, 7), [[0, 0, 0.2, 0, 0, 0.6, 0.8], [0.1, 0.2, 0.3, 0, 0, 0, 1]]
    )
    again = hall.show("hall", first.version)
    assert (again.objects, again.names, again.version) == ({}, first.names, first.version)
    hall.put(ball=BALL)
    assert hall.show("hall", first.version).objects == {"ball": BALL}
    assert hall.show("another", first.version).objects.keys() == {"ball", "point"}


def test_poses_are_those_told_last_and_what_is_gone_has_none(hall: Hall) -> None:
    hall.put(ball=BALL, point=POINT)
    pose = [0.1, 0.0, 0.2, 0.0, 1.0, 0.0, 0.0]
    hall.do(commands.Move, names=("ball",), poses=pack([pose]))
    assert np.allclose(unpack(hall.show().poses, 7)[0], pose)
    hall.do(commands.Remove, names=("ball",))
    assert hall.show().names == ("point",)
    hall.do(commands.Clear)
    assert hall.show().names == ()


def test_an_object_is_told_whole_after_the_renderer_has_it(hall: Hall) -> None:
    hall.put(ball=BALL)
    for thing in hall.room.objects.values():
        thing.pack(1e9)
        assert thing.item is None
    assert hall.show().objects == {"ball": BALL}


def mesh(vertices: int) -> objects.Surface:
    corners = np.random.default_rng(1).uniform(0.0, 0.1, (vertices, 3))
    faces = np.arange(3 * (vertices // 3), dtype="<u4").tobytes()
    return objects.Surface(shape=shapes.Mesh(vertices=pack(corners), faces=faces), force=0.01)


def test_much_is_told_in_parts_and_what_is_too_large_is_left_out(hall: Hall) -> None:
    large = mesh(49_998)
    assert len(encode(large)) > 2 * MAX_SNAPSHOT_BYTES
    hall.put(a=large, b=mesh(6000), c=mesh(6000))
    seen, since, answers = dict[str, objects.Object](), 0, 0
    while seen.keys() != {"a", "b", "c"}:
        answer = hall.show("hall", since)
        assert len(encode(answer)) < MAX_REPLY_BYTES
        seen |= answer.objects
        since, answers = answer.version, answers + 1
        assert answers < 5
    assert answers == 2
    assert seen["a"] == large
    wave = objects.Point(position=(0.0, 0.0, 0.1), force=0.01)
    names = {f"{i:064}": wave for i in range(250)}
    hall.put(**names)
    answer = hall.show("hall", since)
    assert answer.objects.keys() <= names.keys()


def test_no_answer_is_longer_than_a_reply_may_be(hall: Hall) -> None:
    for i in range(0, 1000, 100):
        hall.put(**{"ü" * 60 + f"{n:04}": POINT for n in range(i, i + 100)})
    since, told = 0, 0
    for _ in range(100):
        answer = hall.show("hall", since)
        told += len(answer.objects)
        if answer.version == since:
            break
        since = answer.version
    assert told == len(hall.room.objects) == 1000
    assert len(answer.names) <= MAX_SHOWN
    assert MAX_COMMAND_BYTES <= MAX_REPLY_BYTES


def test_before_any_scene_was_felt_there_is_nothing() -> None:
    asked = commands.Show(session=KEY, sequence=1, time=0.0, id=7)
    assert make_snapshot(None, asked) == Shown(
        id=7, scene="", version=0, names=(), poses=b"", objects={}
    )
    with pytest.raises(WireError, match="must not be 0"):
        make_snapshot(None, commands.Show(session=KEY, sequence=1, time=0.0))


def test_what_is_kept_for_lookers_on_counts_as_the_clients(hall: Hall) -> None:
    hall.put(a=mesh(3000))
    (thing,) = hall.room.objects.values()
    thing.pack(1e9)
    assert hall.client.bytes >= len(thing.packed) + 12 * 3000
    hall.do(commands.Clear)
    assert hall.client.bytes == 0
