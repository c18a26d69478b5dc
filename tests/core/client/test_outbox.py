"""A newer command removes the waiting commands that it replaces. Pure: no sockets."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pacinian.client.outbox import Outbox
from pacinian.wire import commands
from pacinian.wire.binary_arrays import pack, unpack
from pacinian.wire.modulation import Constant
from pacinian.wire.objects import Point

HEAD: dict[str, Any] = {"session": b"k" * 16, "sequence": 1}
NAMES = st.lists(st.sampled_from("abcd"), min_size=1, max_size=4, unique=True).map(tuple)
KINDS = "put", "move", "remove", "envelope", "clear", "hands"


def made(kind: str, names: tuple[str, ...], number: int, time: float = 0.0) -> commands.AnyCommand:
    """Return a command whose parts all contain its number."""
    head = {**HEAD, "time": time}
    if kind == "put":
        point = Point(position=(0.0, 0.0, 0.2), force=float(number))
        return commands.Put(**head, objects=dict.fromkeys(names, point))
    if kind == "move":
        poses, turns = (
            np.full((len(names), 7), number / 1e3),
            np.full((len(names), 6), number / 1e3),
        )
        return commands.Move(**head, names=names, poses=pack(poses), velocities=pack(turns))
    if kind == "remove":
        return commands.Remove(**head, names=names)
    if kind == "envelope":
        return commands.Envelopes(**head, names=names, envelope=Constant(number / 1000.0))
    return commands.Clear(**head) if kind == "clear" else commands.Hands(**head, hands=())


def world(given: list[commands.AnyCommand]) -> dict[str, list[float]]:
    """Return a server's state after these commands: put, pose and envelope of each object."""
    held: dict[str, list[float]] = {}
    for command in given:
        if isinstance(command, commands.Put):
            for name, item in command.objects.items():
                held[name] = [item.force or 0.0, 0.0, 0.0]
        elif isinstance(command, commands.Move):
            poses, turns = unpack(command.poses, 7), unpack(command.velocities, 6)
            for name, pose, turn in zip(command.names, poses, turns, strict=True):
                assert set(pose) == set(turn)
                if name in held:
                    held[name][1] = float(pose[0])
        elif isinstance(command, commands.Envelopes):
            assert isinstance(command.envelope, Constant)
            for name in command.names:
                if name in held:
                    held[name][2] = command.envelope.level
        elif isinstance(command, commands.Remove):
            for name in command.names:
                held.pop(name, None)
        elif isinstance(command, commands.Clear):
            held.clear()
    return held


@given(st.lists(st.tuples(st.sampled_from(KINDS), NAMES), max_size=30), st.integers(0, 10))
def test_the_server_ends_up_with_the_same_from_less(
    steps: list[tuple[str, tuple[str, ...]]], before: int
) -> None:
    given = [made(kind, names, i + 1) for i, (kind, names) in enumerate(steps)]
    box = Outbox()
    sent = given[:before]  # these were sent at once
    for command in given[before:]:
        box.add(command)
    parts = sum(len(getattr(c, "objects", getattr(c, "names", "x"))) for c in box.waiting)
    assert parts <= 4 * 4 + 2  # at most four parts for each of four names, then clear and hands
    assert box.flush(0.0, lambda command: sent.append(command) or True)  # type: ignore[func-returns-value]
    assert world(sent) == world(given)


def test_it_grows_not_with_time() -> None:
    box = Outbox()
    for i in range(1000):
        box.add(made("move", ("a", "b"), i))
        box.add(made("hands", (), i))
    assert len(box.waiting) == 2
    assert box.superseded == 2 * 999


def test_what_has_no_room_waits_and_what_is_overdue_is_dropped() -> None:
    box, sent = Outbox(), []
    box.add(made("put", ("a",), 1, time=0.0))
    box.add(made("put", ("b",), 2, time=0.5))
    assert not box.flush(0.9, lambda _: False)
    assert len(box.waiting) == 2
    assert box.flush(1.2, lambda command: sent.append(command) is None)
    assert [[*command.objects] for command in sent] == [["b"]]
