from __future__ import annotations

from typing import Any

import numpy as np

from pacinian.serving.messages import PutObject
from pacinian.serving.outbox import Outbox
from pacinian.wire import objects, shapes
from pacinian.wire.bulk import pack
from pacinian.wire.replies import Error, Ok

from .fake_renderer import FakeRenderer, client, converted, point, put, remove, room_of


def mesh(radiation_pressure: float = 10.0, force: float | None = None) -> objects.Surface:
    corners = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])
    shape = shapes.Mesh(vertices=pack(corners), faces=np.array([0, 1, 2], "<u4").tobytes())
    return objects.Surface(radiation_pressure=radiation_pressure, force=force, shape=shape)


def do(room: Any, who: Any, command: Any) -> bool:
    return bool(room.do(who, command, 0.0, 0.0, 200))


def test_with_an_id_it_is_answered_when_it_is_converted() -> None:
    room, who = room_of(), client()
    assert do(room, who, put({"light": point()}, id=1))
    assert not do(room, who, put({"a": mesh(), "b": point()}, id=2))
    assert room.things["a"].heavy
    assert not room.things["b"].heavy
    assert converted(room) == [(who, Ok(id=2))]
    assert not room.things["a"].heavy
    assert who.bytes == sum(thing.size for thing in room.things.values())
    assert not do(room, who, put({"c": mesh()}))
    assert converted(room) == []


def test_one_that_cannot_be_meant_is_gone_and_its_client_is_told() -> None:
    room, who = room_of(), client()
    do(room, who, put({"a": point()}))
    for ident in (0, 3):
        do(room, who, put({"a": mesh(force=1.0)}, id=ident))
        [(whose, error)] = converted(room)
        assert whose is who
        assert isinstance(error, Error)
        assert (error.code, error.id) == ("argument", ident)
        assert error.path.startswith("$.objects[a]")
        assert not room.things
        assert (who.objects, who.bytes) == (0, 0)


def test_those_that_are_superseded_are_not_converted_and_take_no_memory() -> None:
    room, who = room_of(), client()
    for k in range(1000):
        do(room, who, put({"a": mesh(force=1.0), f"b{k % 3}": mesh(force=1.0)}))
    assert len(room._converter) <= 32
    do(room, who, put({"a": mesh(), "b0": mesh(), "b1": mesh(), "b2": mesh()}, id=1))
    assert converted(room) == [(who, Ok(id=1))]
    assert len(room._converter) == 0


def test_one_that_is_removed_while_it_is_converted_stays_removed() -> None:
    room, who, renderer = room_of(), client(), FakeRenderer()
    outbox = Outbox(7)
    outbox.feel(room)
    do(room, who, put({"a": mesh()}))
    thing = room.things["a"]
    do(room, who, remove("a"))
    thing.accept(b"late")
    assert converted(room) == []
    renderer.drain(outbox)
    assert not renderer.scene
    assert (who.objects, who.bytes) == (0, 0)


def test_small_shapes_that_take_long_are_known() -> None:
    room, who = room_of(), client()
    solids = shapes.Union((shapes.Box((0.1, 0.1, 0.1)), shapes.Sphere(0.1)))
    do(room, who, put({"u": objects.Volume(force=0.1, shape=solids)}))
    assert room.things["u"].heavy
    outbox = Outbox(7)
    outbox.feel(room)
    batch = outbox.next()
    assert batch is not None
    assert not any(isinstance(c, PutObject) for c in batch.changes)
