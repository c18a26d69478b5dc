from __future__ import annotations

import gc
import weakref
from concurrent.futures import Executor, Future
from typing import Any

import msgspec
import numpy as np
import pytest
from msgspec.structs import force_setattr

from pacinian.serving.bus.change_batcher import ChangeBatcher
from pacinian.serving.bus.conversion_queue import Converter
from pacinian.serving.bus.dispatcher import carry_out
from pacinian.serving.bus.shared_scene import CommandRejected, SharedScene
from pacinian.serving.ipc.messages import PutObject
from pacinian.serving.settings import Settings
from pacinian.wire import objects, shapes
from pacinian.wire.binary_arrays import pack
from pacinian.wire.commands import Envelopes
from pacinian.wire.modulation import STM, Constant, Wave
from pacinian.wire.replies import Error, Ok
from pacinian.wire.shapes import Polyline

from ..fake_renderer import (
    KEY,
    FakeRenderer,
    client,
    converted,
    point,
    put,
    remove,
    room_of,
    wrap,
)


def mesh(radiation_pressure: float = 10.0, force: float | None = None) -> objects.Surface:
    corners = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])
    shape = shapes.Mesh(vertices=pack(corners), faces=np.array([0, 1, 2], "<u4").tobytes())
    return objects.Surface(radiation_pressure=radiation_pressure, force=force, shape=shape)


def do(room: Any, who: Any, command: Any) -> bool:
    return bool(carry_out(room, who, command, 0.0, 0.0, 200))


def test_with_an_id_it_is_answered_when_it_is_converted() -> None:
    room, who = room_of(), client()
    assert do(room, who, put({"light": point()}, id=1))
    assert not do(room, who, put({"a": mesh(), "b": point()}, id=2))
    assert room.objects["a"].heavy
    assert not room.objects["b"].heavy
    assert converted(room) == [(who, Ok(id=2))]
    assert not room.objects["a"].heavy
    assert who.bytes == sum(thing.size for thing in room.objects.values())
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
        assert not room.objects
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
    batcher = ChangeBatcher(7)
    batcher.render(room)
    do(room, who, put({"a": mesh()}))
    thing = room.objects["a"]
    do(room, who, remove("a"))
    thing.accept(b"late")
    assert converted(room) == []
    renderer.drain(batcher)
    assert not renderer.scene
    assert (who.objects, who.bytes) == (0, 0)


def test_small_shapes_that_take_long_are_known() -> None:
    room, who = room_of(), client()
    solids = shapes.Union((shapes.Box((0.1, 0.1, 0.1)), shapes.Sphere(0.1)))
    do(room, who, put({"u": objects.Volume(force=0.1, shape=solids)}))
    assert room.objects["u"].heavy
    batcher = ChangeBatcher(7)
    batcher.render(room)
    batch = batcher.make_batch()
    assert batch is not None
    assert not any(isinstance(c, PutObject) for c in batch.changes)


class Later(Executor):
    """An executor that runs nothing by itself."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        return Future()


def test_those_that_are_superseded_are_dropped_at_once_and_answered() -> None:
    settings = Settings()
    room, who = SharedScene(settings, Converter(1e9, Later())), client()
    items: list[Any] = []
    for k in range(1, 201):
        items.append(mesh())
        do(room, who, put({"a": items[-1], f"b{k % 2}": point()}, id=k))
        items[-1] = weakref.ref(room.objects["a"])
        assert len(room._converter) == 1
    gc.collect()
    assert sum(ref() is not None for ref in items) == 1
    assert list(room._converter.run_round()) == [(who, Ok(id=k)) for k in range(1, 200)]
    do(room, who, put({"a": mesh()}, id=300))  # while the one before is converted
    assert list(room._converter.run_round()) == []
    do(room, who, remove("a"))
    do(room, who, put({"c": mesh()}, id=301))
    assert list(room._converter.run_round()) == [(who, Ok(id=300))]


@pytest.mark.parametrize("count", [1, 200])
def test_each_object_is_judged_by_what_it_is_made_of(count: int) -> None:
    room, who = room_of(), client()
    wave = Wave(samples=pack(np.zeros(5000)), rate=1000.0)
    particles = objects.Particles(radiation_pressure=1.0, positions=pack(np.zeros((1000, 3))))
    run = Polyline(points=pack(np.linspace(0.0, 0.1, 1500).reshape(-1, 3)))
    slow = {
        "wave": point(envelope=wave),
        "particles": particles,
        "path": objects.Path(radiation_pressure=1.0, shape=run),
        "run": point(technique=STM(frequency=100.0, along=run)),
    }
    many = {f"p{k}": point() for k in range(count)}
    assert not carry_out(room, who, put({**slow, **many}), 0.0, 0.0, 60_000)
    assert {name for name, thing in room.objects.items() if thing.heavy} == set(slow)
    sizes = [room.objects[name].size for name in slow]
    assert min(sizes) > 6000
    assert 60_000 - len(room.objects) <= who.bytes <= 60_000
    assert converted(room) == []
    assert not any(thing.heavy for name, thing in room.objects.items() if name in slow)


def test_many_with_an_id_are_not_converted_while_commands_wait() -> None:
    room, who = room_of(), client()
    many: dict[str, Any] = {f"p{k}": point() for k in range(200)}
    assert not do(room, who, put(many, id=1))
    assert all(thing.item is not None for thing in room.objects.values())
    assert converted(room) == [(who, Ok(id=1))]
    assert all(thing.packed for thing in room.objects.values())


def wave_of(names: tuple[str, ...], samples: int, ident: int = 0) -> Envelopes:
    wave = Wave(samples=pack(np.full(samples, 0.5)), rate=1000.0)
    return Envelopes(session=KEY, sequence=1, time=0.0, names=names, envelope=wave, id=ident)


def test_a_long_wave_is_converted_elsewhere_and_the_newest_envelope_wins() -> None:
    room, who, renderer = room_of(), client(), FakeRenderer()
    batcher = ChangeBatcher(7)
    batcher.render(room)
    do(room, who, put({"a": point(), "b": point()}))
    for k in range(1, 21):
        assert not do(room, who, wave_of(("a", "b"), 20_000 + k, k))
        assert len(room._converter) == 1
        assert not room.objects["a"].envelope
        assert who.bytes == sum(thing.size for thing in room.objects.values()) > 160_000
    do(room, who, wrap(("b",), 0.25))
    assert [reply for _, reply in converted(room)] == [Ok(id=k) for k in range(1, 21)]
    renderer.drain(batcher)
    a, b = (renderer.scene[name][2] for name in "ab")
    assert isinstance(a, bytes)
    assert len(a) > 9 * 20_000
    assert b == msgspec.msgpack.encode(Constant(0.25))
    assert who.bytes == sum(thing.size for thing in room.objects.values())
    do(room, who, wave_of(("a",), 20_000))
    do(room, who, remove("a", "b"))
    assert converted(room) == []
    assert (who.objects, who.bytes) == (0, 0)
    assert not room.objects


def test_a_long_wave_that_cannot_be_meant_leaves_the_envelope_there_was() -> None:
    room, who = room_of(), client()
    do(room, who, put({"a": point()}))
    do(room, who, wrap(("a",), 0.25))
    before = room.objects["a"].envelope, who.bytes
    command = wave_of(("a",), 5000, 3)
    force_setattr(command.envelope, "samples", bytes(4 * 5000 + 1))
    do(room, who, command)
    [(whose, error)] = converted(room)
    assert whose is who
    assert isinstance(error, Error)
    assert error.id == 3
    assert (room.objects["a"].envelope, who.bytes) == before
    with pytest.raises(CommandRejected, match="'no'"):  # the only answer
        do(room, who, wave_of(("a", "no"), 5000, 4))
    assert converted(room) == []
    assert room.objects["a"].envelope != before[0]
