from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.errors import WireError
from pacinian.serving.bus.dispatcher import carry_out
from pacinian.serving.bus.shared_scene import (
    MAX_CLIENT_BYTES,
    CommandRejected,
    SharedScene,
)
from pacinian.serving.bus.stored_object import TooStrong, make_error_reply
from pacinian.serving.settings import ClientLimits, Safety, Settings, Zone
from pacinian.wire import objects, shapes
from pacinian.wire.binary_arrays import pack
from pacinian.wire.commands import Clear, HandFrame, Move
from pacinian.wire.commands import Zone as Ball
from pacinian.wire.modulation import Wave
from pacinian.wire.protocol import MAX_ZONES

from ..fake_renderer import KEY, client, hands, move, point, put, quiet, remove, room_of, wrap

SMALL = Settings(
    clients=ClientLimits(max_objects=5, max_client_objects=3), safety=Safety(pressure=50.0)
)
JOINTS = pack(pc.Hand.open().joints)  # type: ignore[arg-type]


def do(room: SharedScene, who: Any, command: Any, now: float = 0.0, size: int = 100) -> None:
    carry_out(room, who, command, now, now, size)


def test_objects_stay_until_their_duration_is_over() -> None:
    room, who = room_of(), client()
    do(room, who, put({"a": point(duration=1.0), "b": point(), "c": point(duration=3.0)}))
    do(room, who, put({"c": point()}), 0.5)  # now without a duration
    do(room, who, put({"a": point(duration=2.0)}), 0.5)
    for now, left in ((2.49, ["a", "b", "c"]), (2.5, ["b", "c"]), (1e9, ["b", "c"])):
        room.expire(now)
        assert sorted(room.objects) == left
    assert who.objects == 2


def test_objects_that_are_put_for_long_again_and_again_take_no_memory() -> None:
    room, who = room_of(), client()
    for i in range(5000):
        do(room, who, put({"a": point(duration=1e6)}), float(i))
    assert len(room._ends) < 200


def test_so_many_objects_of_a_client_and_of_a_scene_and_no_more() -> None:
    room, one, other = room_of(SMALL), client(1), client(2)
    do(room, one, put({"a": point(), "b": point(), "c": point()}))
    with pytest.raises(CommandRejected, match="more than 3 of one client") as refusal:
        do(room, one, put({"c": point(), "d": point()}))
    assert (refusal.value.code, refusal.value.path) == ("limit", "$.objects")
    do(room, one, put({"a": point(1.0), "b": point(), "c": point()}))
    do(room, other, put({"d": point(), "e": point()}))
    with pytest.raises(CommandRejected, match="more than 5 of one scene"):
        do(room, other, put({"f": point()}))
    do(room, other, put({"a": point()}))  # takes it over
    assert (one.objects, other.objects) == (2, 3)
    assert room.objects["a"].owner is other


def test_a_client_has_so_much_memory_and_no_more() -> None:
    room, who = room_of(), client()
    most = MAX_CLIENT_BYTES >> 20
    for i in range(most):
        do(room, who, put({f"o{i}": point()}), size=1 << 20)
    with pytest.raises(CommandRejected, match="MiB"):
        do(room, who, put({"more": point()}), size=1 << 20)
    do(room, who, remove(*(f"o{i}" for i in range(100))))
    assert (who.objects, who.bytes) == (0, 0)
    wave = Wave(samples=pack(np.zeros(100_000)), rate=1000.0)
    do(room, who, put({f"o{i}": point() for i in range(200)}))
    command = wrap(tuple(room.objects), 1.0)
    with pytest.raises(CommandRejected, match="MiB"):
        do(room, who, type(command)(**{**_fields(command), "envelope": wave}))
    assert who.bytes <= MAX_CLIENT_BYTES


def _fields(command: Any) -> dict[str, Any]:
    return {name: getattr(command, name) for name in command.__struct_fields__}


@pytest.mark.parametrize("ident", [0, 5])
def test_too_much_pressure_is_refused_with_its_path(ident: int) -> None:
    room, who = room_of(SMALL), client()
    with pytest.raises(TooStrong) as wrong:
        do(room, who, put({"a": point(), "b": point(51.0)}, id=ident))
    error = make_error_reply(wrong.value, ident)
    assert (error.code, error.id) == ("limit", ident)
    assert error.path == "$.objects[b].radiation_pressure"
    assert not room.objects  # a command applies completely or not at all
    assert (who.objects, who.bytes) == (0, 0)
    strong = objects.Point(force=1.0, position=(0.0, 0.0, 0.2))
    with pytest.raises(TooStrong, match="Pa") as wrong:
        do(room, who, put({"c": strong}, id=1))
    assert wrong.value.path == "$.objects[c].force"
    do(room, who, put({"c": strong}))
    error = room.pack(room.objects["c"])
    assert error is not None
    assert error.code == "limit"
    assert not room.objects
    assert (who.objects, who.bytes) == (0, 0)


def test_with_an_id_what_cannot_be_meant_is_refused_at_once_and_changes_nothing() -> None:
    room, who = room_of(), client()
    do(room, who, put({"a": point(3.0)}))
    bad = objects.Surface(radiation_pressure=1.0, force=1.0, shape=shapes.Disc(0.1))
    with pytest.raises(WireError) as wrong:
        do(room, who, put({"a": point(4.0), "b": bad}, id=4))
    assert make_error_reply(wrong.value, 4).code == "argument"
    assert wrong.value.path.startswith("$.objects[b]")
    item = room.objects["a"].item
    assert item is not None
    assert item.radiation_pressure == 3.0
    assert who.bytes == sum(t.size for t in room.objects.values())


def test_those_that_are_there_are_moved_and_the_first_that_is_not_is_told() -> None:
    room, who = room_of(), client()
    do(room, who, put({"a": point(), "b": point()}))
    with pytest.raises(CommandRejected, match="'no'") as refusal:
        do(room, who, move(("a", "no", "b"), 0.5))
    assert (refusal.value.code, refusal.value.path) == ("unknown", "$.names[1]")
    moved = room.objects["b"].make_move()
    assert moved is not None
    assert moved.position[0] == 0.5
    with pytest.raises(CommandRejected):
        do(room, who, wrap(("no",), 0.5))
    do(room, who, remove("no"))


@pytest.mark.parametrize(
    ("pose", "velocity", "path"),
    [
        ([0, 0, 0.2, 0, 0, 0, 0], [], "$.poses[1]"),
        ([0, 0, 0.2, 0, 0, 0, 0.9], [], "$.poses[1]"),
        ([0, 0, 0.2, 0, 0, 0, 1], [80, 80, 0, 0, 0, 0], "$.velocities[1]"),
        ([0, 0, 0.2, 0, 0, 0, 1], [0, 0, 0, 0, 80, 80], "$.velocities[1]"),
    ],
)
def test_poses_that_cannot_be_meant_are_refused(
    pose: list[float], velocity: list[float], path: str
) -> None:
    room, who = room_of(), client()
    do(room, who, put({"a": point(), "b": point()}))
    good = [0, 0, 0.2, 0, 0, 0, 1]
    still = [0.0] * 6 if velocity else []
    command = Move(
        session=KEY, sequence=1, time=0.0, names=("a", "b"), poses=pack([*good, *pose]),
        velocities=pack([*still, *velocity]),
    )  # fmt: skip
    with pytest.raises(WireError) as wrong:
        do(room, who, command)
    assert wrong.value.path == path


def test_velocities_go_with_their_pose_and_time() -> None:
    room, who = room_of(), client()
    do(room, who, put({"a": point(), "b": point()}))
    command = Move(
        session=KEY, sequence=1, time=0.0, names=("a", "b"), poses=pack([[0, 0, 0.2, 0, 0, 0, 1]] * 2),
        velocities=pack(np.arange(12.0)),
    )  # fmt: skip
    carry_out(room, who, command, 41.5, 42.0, 100)
    moved = room.objects["b"].make_move()
    assert moved is not None
    assert moved.velocity == (6.0, 7.0, 8.0)
    assert moved.angular_velocity == (9.0, 10.0, 11.0)
    assert moved.time == 41.5


def test_hands_are_of_all_clients_with_names_of_their_own_and_felt_for_good() -> None:
    room, one, other = room_of(), client(1), client(2)
    assert not room.merge_hands().felt
    carry_out(room, one, hands(HandFrame(joints=JOINTS), sequence=5, time=1.0), 101.0, 101.5, 100)
    carry_out(
        room, other, hands(HandFrame(), HandFrame(side="left"), sequence=7, time=3.0), 99.0, 99.5, 1
    )
    told = room.merge_hands()
    assert [hand.name for hand in told.hands] == ["right@1", "right@2", "left@2"]
    assert (told.input, told.sent, told.received) == (5, 1.0, 101.5)
    assert told.hands[0].time == 101.0
    assert told.hands[0].joints == JOINTS
    room.clear(one)
    room.clear(other)
    assert room.merge_hands().hands == ()
    assert room.merge_hands().felt  # without its tracker, objects are not rendered as a whole


@pytest.mark.parametrize(
    ("frames", "path"),
    [
        ((HandFrame(), HandFrame()), "$.hands[1].name"),
        ((HandFrame(joints=pack(np.frombuffer(JOINTS, "<f4") * 1000)),), "$.hands[0].joints"),
        ((HandFrame(joints=JOINTS, radii=pack(np.full(26, -1.0))),), "$.hands[0].radii"),
    ],
)
def test_hands_that_cannot_be_meant_are_refused(frames: Any, path: str) -> None:
    room, who = room_of(), client()
    with pytest.raises(WireError) as wrong:
        do(room, who, hands(*frames))
    assert wrong.value.path == path
    assert not room.felt


def test_who_leaves_takes_along_what_it_put_last() -> None:
    room, one, other = room_of(), client(1), client(2)
    do(room, one, put({"a": point(), "b": point()}))
    do(room, other, put({"b": point(), "c": point()}))
    do(room, one, quiet(Ball(position=(0.0, 0.0, 0.0), pressure=1.0)))
    do(room, one, Clear(session=KEY, sequence=1, time=0.0))
    assert list(room.objects) == ["b", "c"]
    assert (one.objects, one.bytes, other.objects) == (0, 0, 2)
    assert not room.zones


def test_quiet_zones_of_clients_come_to_those_of_the_installation() -> None:
    ours = Settings(safety=Safety(zones=(Zone((0.0, 0.1, 0.3), pressure=5.0, radius=0.05),)))
    room, who = room_of(ours), client()
    do(room, who, quiet(Ball(position=(0.1, 0.0, 0.2), pressure=7.0)))
    always = (0.0, 0.1, 0.3), 5.0, 0.05
    assert room.merge_zones().zones == (always, ((0.1, 0.0, 0.2), 7.0, 0.12)), "a head, by default"
    do(room, who, quiet())
    assert room.merge_zones().zones == (always,)


def test_quiet_zones_of_a_scene_are_bounded() -> None:
    room, one, other = room_of(), client(1), client(2)
    balls = [Ball(position=(0.0, 0.0, 0.1), pressure=1.0, radius=0.1)] * MAX_ZONES
    do(room, one, quiet(*balls))
    with pytest.raises(CommandRejected, match=str(MAX_ZONES)):
        do(room, other, quiet(*balls))
    do(room, one, quiet(*balls[3:]))
    do(room, other, quiet(*balls[:3]))
