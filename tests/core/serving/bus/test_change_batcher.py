from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.serving.bus.change_batcher import MAX_BATCH_BYTES, MAX_BATCH_OBJECTS, ChangeBatcher
from pacinian.serving.bus.dispatcher import carry_out
from pacinian.serving.bus.shared_scene import CommandRejected, SharedScene
from pacinian.serving.bus.stored_object import MIN_HEAVY_BYTES
from pacinian.serving.ipc.messages import (
    Changes,
    ChangesAck,
    MoveObject,
    PutObject,
    RemoveObject,
    ResetScene,
    SetHands,
)
from pacinian.wire import objects, shapes
from pacinian.wire.binary_arrays import pack
from pacinian.wire.commands import HandFrame
from pacinian.wire.modulation import STEADY, Wave

from ..fake_renderer import (
    FakeRenderer,
    Model,
    client,
    converted,
    hands,
    move,
    point,
    put,
    remove,
    room_of,
    wrap,
)

bounded = settings(max_examples=200)
NAMES = "abcdefgh"
LONG = Wave(samples=pack(np.zeros(MIN_HEAVY_BYTES)), rate=1000.0)
SLOW = 80  # stronger points have a long envelope [Pa]
name = st.sampled_from(NAMES)
names = st.lists(name, max_size=3, unique=True)
steps = st.lists(
    st.one_of(
        st.tuples(st.just("put"), names, st.integers(1, 100), st.booleans()),
        st.tuples(st.just("move"), names, st.integers(1, 8)),
        st.tuples(st.just("wrap"), names, st.sampled_from([0.25, 0.5, 0.75])),
        st.tuples(st.just("remove"), names),
        st.tuples(st.just("leave")),
        st.tuples(st.just("publish")),
        st.tuples(st.just("take")),
        st.tuples(st.just("convert")),
        st.tuples(st.just("restart")),
    ),
    max_size=60,
)


def command(step: tuple[Any, ...]) -> Any:
    kind, chosen = step[0], tuple(step[1])
    if kind == "put":
        envelope = LONG if step[2] > SLOW else STEADY
        items = {n: point(float(step[2]), envelope=envelope) for n in chosen}
        return put(items, id=int(step[3]))
    if kind == "move":
        return move(chosen, step[2] / 8)
    if kind == "wrap":
        return wrap(chosen, step[2])
    return remove(*chosen)


def done(room: SharedScene, who: Any, made: Any, size: int = 100) -> None:
    try:
        carry_out(room, who, made, 0.0, 0.0, size)
    except CommandRejected as refusal:
        assert refusal.code == "unknown"  # noqa: PT017


def felt(room: SharedScene, run: int = 7) -> ChangeBatcher:
    batcher = ChangeBatcher(run)
    batcher.render(room)
    return batcher


@bounded
@given(steps, st.data())
def test_whatever_is_interleaved_the_renderer_ends_with_all_in_order(
    taken: list[tuple[Any, ...]], data: st.DataObject
) -> None:
    room, model, renderer = room_of(), Model(), FakeRenderer()
    batcher, clients = felt(room), [client(1), client(2), client(3)]
    slow: set[str] = set()
    file = None  # the last published batch: the running renderer may take it
    for step in taken:
        who = data.draw(st.sampled_from(clients))
        if step[0] == "publish":
            file = batcher.make_batch() or file
        elif step[0] == "take":
            if file is not None and (file.number, file.run) != (
                renderer.last.number,
                renderer.last.bus,
            ):
                renderer.take(file)
            batcher.acknowledge(renderer.last)
        elif step[0] == "convert":
            converted(room)
        elif step[0] == "leave":
            room.clear(who)
            model.leave(who)
        elif step[0] == "restart":
            renderer = FakeRenderer(renderer.run + 1)
        else:
            made = command(step)
            heavy = step[0] == "put" and step[2] > SLOW
            slow |= set(step[1]) if heavy else set()
            done(room, who, made)
            model.do(who, made, 0.0)
        assert len(room.pending) <= 2 * len(NAMES) + 3
    if file is not None and renderer.last.number != file.number:
        renderer.take(file)
    batcher.acknowledge(renderer.last)
    renderer.drain(batcher)
    assert renderer.scene == model.scene
    assert [n for n in renderer.scene if n not in slow] == [n for n in model.scene if n not in slow]
    assert not batcher.errors
    assert set(room.pending.known) == set(model.scene)
    for who in clients:
        own = [t for t in room.objects.values() if t.owner is who]
        assert (who.objects, who.bytes) == (len(own), sum(t.size for t in own))


def test_nothing_more_is_sent_before_the_last_was_taken() -> None:
    room = room_of()
    batcher, who = felt(room), client()
    first = batcher.make_batch()
    assert first is not None
    assert first.number == 1
    assert isinstance(first.changes[0], ResetScene)
    done(room, who, put({"a": point()}))
    assert batcher.has_more
    assert batcher.make_batch() is None
    batcher.acknowledge(ChangesAck(1, 5, 7))
    second = batcher.make_batch()
    assert second is not None
    assert [type(c) for c in second.changes] == [PutObject]
    done(room, who, move(("a",), 0.5))
    for not_it in (
        ChangesAck(1, 5, 7),
        ChangesAck(2, 5, 99),
    ):  # acks of an earlier batch, and from another bus
        batcher.acknowledge(not_it)
        assert batcher.make_batch() is None
    batcher.acknowledge(ChangesAck(2, 5, 7))
    assert batcher.make_batch() is not None


def test_a_renderer_that_says_nothing_of_the_first_batch_gets_it_again() -> None:
    room = room_of()
    batcher = felt(room)
    assert batcher.make_batch() is not None
    batcher.acknowledge(ChangesAck(0, 5, 0))  # the renderer that took it, if any, is gone
    again = batcher.make_batch()
    assert again is not None
    assert isinstance(again.changes[0], ResetScene)


def test_many_updates_while_nothing_is_taken_take_no_room_and_the_newest_is_sent() -> None:
    room = room_of()
    batcher, renderer, who = felt(room), FakeRenderer(), client()
    done(room, who, put({f"o{i}": point() for i in range(40)}))
    renderer.drain(batcher)
    chosen = tuple(f"o{i}" for i in range(40))
    for k in range(2000):
        done(room, who, move(chosen, k / 2048))
        done(room, who, put({"p": point(1.0 + k % 100)}))
        done(room, who, put({f"q{k}": point()}))
        done(room, who, remove(f"q{k}"))
    assert len(room.pending) == 41
    assert room.pending.superseded == 2000 * 40 - 40 + 1999 + 2000
    batch = batcher.make_batch()
    assert batch is not None
    assert len(batch.changes) == 41
    batcher.acknowledge(renderer.take(batch))
    assert renderer.scene["o7"][1] == 1999 / 2048
    assert set(renderer.scene) == {*chosen, "p"}


def test_batches_are_bounded_moves_do_not_wait_for_puts_and_puts_not_for_moves() -> None:
    room = room_of()
    batcher, renderer, who = felt(room), FakeRenderer(), client()
    old = tuple(f"o{i}" for i in range(200))
    done(room, who, put({n: point() for n in old}))
    renderer.drain(batcher)
    done(room, who, move(old, 0.5))
    done(room, who, put({f"n{i}": point() for i in range(200)}))
    kinds = []
    while (batch := batcher.make_batch()) is not None:
        assert len(batch.changes) <= MAX_BATCH_OBJECTS
        kinds.append({type(c) for c in batch.changes})
        batcher.acknowledge(renderer.take(batch))
        done(room, who, move(old, 0.25)) if len(kinds) < 5 else None
    assert kinds[0] == {MoveObject, PutObject}
    assert list(renderer.scene) == [*old, *(f"n{i}" for i in range(200))]


def mesh(rows: int) -> objects.Surface:
    x, y = np.meshgrid(np.linspace(0, 0.1, rows), np.linspace(0, 0.1, rows))
    vertices = np.stack([x, y, 0.1 * x * y], -1).reshape(-1, 3).astype("<f4")
    i = np.arange(rows * rows).reshape(rows, rows)
    a, b, c, d = (v.ravel() for v in (i[:-1, :-1], i[:-1, 1:], i[1:, 1:], i[1:, :-1]))
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).astype("<u4")
    shape = shapes.Mesh(vertices=vertices.tobytes(), faces=faces.tobytes())
    return objects.Surface(radiation_pressure=10.0, shape=shape)


def test_an_object_that_takes_long_holds_up_nothing() -> None:
    room = room_of()
    batcher, renderer, who = felt(room), FakeRenderer(), client()
    done(room, who, put({"old": point(), "mesh": point()}))
    renderer.drain(batcher)
    before = renderer.scene["mesh"]
    done(room, who, put({"mesh": mesh(40)}), 40_000)
    done(room, who, put({"after": point()}))
    done(room, who, move(("old",), 0.5))
    done(room, who, hands(HandFrame()))
    batch = batcher.make_batch()
    assert batch is not None
    assert [type(c) for c in batch.changes] == [SetHands, MoveObject, PutObject]
    batcher.acknowledge(renderer.take(batch))
    assert renderer.scene["mesh"] == before  # the replaced object stays until then
    assert batcher.make_batch() is None
    assert converted(room) == []
    done(room, who, move(("mesh",), 0.25))
    renderer.drain(batcher)
    assert renderer.scene["mesh"][1] == 0.25
    assert list(renderer.scene) == ["old", "mesh", "after"]


def test_batches_have_no_more_bytes_than_they_may_but_for_one_object() -> None:
    room = room_of()
    batcher, renderer, who = felt(room), FakeRenderer(), client()
    renderer.drain(batcher)
    values = np.zeros(190_000, "<f4").tobytes()
    texture = objects.Texture(values=values, grid=(400, 475), size=(0.1, 0.1))
    flat = objects.Surface(
        radiation_pressure=1.0, shape=shapes.Rectangle(0.1, 0.1), texture=texture
    )
    for i in range(4):
        done(room, who, put({f"t{i}": flat}), 760_000)
    batches = []
    while len(renderer.scene) < 4:
        converted(room)
        if (batch := batcher.make_batch()) is not None:
            batches.append([len(c.item) for c in batch.changes if isinstance(c, PutObject)])
            batcher.acknowledge(renderer.take(batch))
    assert all(sum(sizes) <= MAX_BATCH_BYTES or len(sizes) == 1 for sizes in batches)
    assert list(renderer.scene) == [f"t{i}" for i in range(4)]


def test_another_renderer_and_another_scene_begin_anew() -> None:
    rooms = [room_of(), room_of()]
    batcher, renderer = felt(rooms[0]), FakeRenderer()
    for i, room in enumerate(rooms):
        done(room, client(), put({f"o{i}": point()}))
    renderer.drain(batcher)
    assert renderer.begins == 1
    done(rooms[0], client(), put({"late": point()}))
    assert batcher.make_batch() is not None  # no renderer takes it: the renderer is killed
    renderer = FakeRenderer(run=2)
    batcher.acknowledge(renderer.last)
    renderer.drain(batcher)
    assert list(renderer.scene) == ["o0", "late"]
    batcher.render(rooms[1])
    renderer.drain(batcher)
    assert list(renderer.scene) == ["o1"]
    batcher.render(rooms[1])
    assert batcher.make_batch() is None
    batcher.render(rooms[0])
    renderer.drain(batcher)
    assert list(renderer.scene) == ["o0", "late"]


def test_an_object_that_cannot_be_meant_is_gone_and_its_client_is_told() -> None:
    room = room_of()
    batcher, renderer, who = felt(room), FakeRenderer(), client()
    done(room, who, put({"bad": point()}))
    renderer.drain(batcher)
    bad = objects.Surface(radiation_pressure=1.0, force=1.0, shape=shapes.Disc(0.1))
    done(room, who, put({"bad": bad, "good": point()}))
    renderer.drain(batcher)
    assert list(renderer.scene) == ["good"]
    [(whose, error)] = batcher.errors
    assert whose is who
    assert (error.code, error.id) == ("argument", 0)
    assert error.path.startswith("$.objects[bad]")


def test_one_that_is_superseded_is_never_converted() -> None:
    room = room_of()
    batcher, who = felt(room), client()
    bad = objects.Surface(radiation_pressure=1.0, force=1.0, shape=shapes.Disc(0.1))
    done(room, who, put({"a": bad}))
    done(room, who, put({"a": point()}))
    FakeRenderer().drain(batcher)
    assert not batcher.errors


def test_a_removed_object_that_comes_again_comes_last() -> None:
    room = room_of()
    batcher, renderer, who = felt(room), FakeRenderer(), client()
    done(room, who, put({"a": point(), "b": point()}))
    renderer.drain(batcher)
    done(room, who, remove("a"))
    done(room, who, put({"a": point(3.0)}))
    batch = batcher.make_batch()
    assert batch is not None
    assert [type(c) for c in batch.changes] == [RemoveObject, PutObject]
    renderer.take(batch)
    assert list(renderer.scene) == ["b", "a"]


@bounded
@given(st.booleans(), st.booleans(), st.booleans())
def test_a_bus_that_begins_with_no_changes_goes_on_as_any(
    seen: bool, early: bool, known: bool
) -> None:
    """seen: the renderer takes the empty ones; early: only after the first batch was made."""
    room, who = room_of(), client()
    batcher, renderer = felt(room, run=8), FakeRenderer()
    renderer.scene["old"] = [b"of the bus before", None, None]
    renderer.last = ChangesAck(3, renderer.run, 7)
    if known:
        batcher.acknowledge(renderer.last)
    done(room, who, put({"a": point()}))
    batch = batcher.make_batch() if early else None
    if seen:
        renderer.take(Changes(0, batcher.run, (ResetScene(),)))  # as in the loop
        batcher.acknowledge(renderer.last)
    if batch is not None:
        batcher.acknowledge(renderer.take(batch))
    renderer.drain(batcher)
    assert set(renderer.scene) == {"a"}
    assert batcher.make_batch() is None
    done(room, who, move(("a",), 0.5))
    renderer.drain(batcher)
    assert renderer.scene["a"][1] == 0.5


def test_a_batch_that_could_not_be_published_comes_anew() -> None:
    room, who = room_of(), client()
    batcher, renderer = felt(room), FakeRenderer()
    done(room, who, put({"a": point()}))
    assert batcher.make_batch() is not None
    batcher.resend_scene()
    renderer.drain(batcher)
    assert set(renderer.scene) == {"a"}
    assert renderer.begins == 1
