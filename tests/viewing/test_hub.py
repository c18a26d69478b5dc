"""The hub, which gives each view the newest values. Pure: no sockets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import msgpack
import pytest
from msgspec import Raw
from msgspec.structs import replace

from pacinian.viewing.hub import MAX_WAITING_REFUSALS, Hub
from pacinian.viewing.messages import Disarm, Hello, SessionMessage
from pacinian.viewing.scene_mirror import SceneMirror

if TYPE_CHECKING:
    from pacinian.viewing.hub import View

POSE = bytes(28)
BALL, BOX = (Raw(msgpack.packb({"type": name})) for name in ("ball", "box"))
OURS = SessionMessage(name="viewer", scene="", lease=0.25, armed=True, mine=False)


@pytest.fixture
def hub() -> Hub:
    return Hub()


def taken(view: View) -> list[dict[str, Any]]:
    return [msgpack.unpackb(data) for _, data in view.take()]


def test_a_view_is_told_the_newest_of_each_kind_once(hub: Hub) -> None:
    hub.put("hello", Hello(viewer="1"))
    view = hub.join(lambda: None)
    for i in range(1000):
        hub.put("state", msgpack.packb({"type": "state", "sequence": i}) or b"")
        hub.put("frame", msgpack.packb({"type": "frame", "sequence": i}) or b"")
    told = taken(view)
    assert [message["type"] for message in told] == ["hello", "frame", "state", "scenery"]
    assert [message["sequence"] for message in told[1:3]] == [999, 999]
    assert not taken(view)
    assert len(taken(hub.join(lambda: None))) == 4


def test_what_comes_while_a_view_takes_is_told_then_or_next_time(hub: Hub) -> None:
    view = hub.join(lambda: None)
    hub.put("frame", b"first")
    taking = view.take()
    assert next(taking) == ("frame", b"first")
    hub.put("frame", b"second")
    hub.put("state", b"third")
    assert next(taking) == ("state", b"third")
    assert ("frame", b"second") in list(view.take())


def test_views_are_woken_and_may_leave_meanwhile(hub: Hub) -> None:
    woken: list[str] = []

    def leave() -> None:
        woken.append("a")
        hub.leave(first)

    first = hub.join(leave)
    hub.join(lambda: woken.append("b"))
    hub.put("state", b"")
    hub.put("state", b"")
    assert woken == ["a", "b", "b"]


def test_objects_are_told_once_and_those_without_a_pose_are_gone(hub: Hub) -> None:
    early, scenery = hub.join(lambda: None), SceneMirror()
    scenery = scenery.with_("hall", {"ball": BALL}, {"ball": POSE})
    hub.show(scenery)
    assert taken(early)[-1]["objects"] == {"ball": {"type": "ball"}}
    scenery = scenery.with_("hall", {"box": BOX}, {"ball": POSE, "box": POSE})
    hub.show(scenery)
    assert taken(early)[-1]["objects"].keys() == {"box"}
    late = hub.join(lambda: None)
    told = taken(late)[-1]
    assert (told["scene"], told["objects"].keys()) == ("hall", {"ball", "box"})
    scenery = scenery.with_("hall", {}, {"box": POSE})
    hub.show(scenery)
    (last,) = taken(early)
    assert (last["objects"], last["poses"].keys()) == ({}, {"box"})
    assert taken(hub.join(lambda: None))[-1]["objects"].keys() == {"box"}
    assert scenery.with_("hall", {}, {"box": POSE}) is scenery


def test_after_a_loss_all_is_told_anew(hub: Hub) -> None:
    view = hub.join(lambda: None)
    scenery = SceneMirror().with_("hall", {"ball": BALL}, {"ball": POSE})
    hub.put("array", b"array")
    hub.show(scenery)
    list(view.take())
    hub.disconnect("it has gone")
    told = dict(view.take())
    assert msgpack.unpackb(told["lost"]) == {"type": "lost", "reason": "it has gone"}
    assert msgpack.unpackb(told["poses"])["poses"] == {}
    assert {kind for kind, _ in hub.join(lambda: None).take()} == {"lost", "poses"}
    hub.put("array", b"array")
    hub.show(SceneMirror().with_("hall", {"ball": BALL}, {"ball": POSE}))
    assert {kind for kind, _ in view.take()} == {"array", "scenery"}
    assert "lost" not in dict(hub.join(lambda: None).take())


@pytest.mark.parametrize("after", ["record", "frame", "state"])
def test_a_loss_while_a_view_takes_is_told_before_that_objects_are_gone(
    hub: Hub, after: str
) -> None:
    view = hub.join(lambda: None)
    hub.put("array", b"array")
    hub.show(SceneMirror().with_("hall", {"ball": BALL}, {"ball": POSE}))
    list(view.take())
    for kind in ("record", "frame", "state"):
        hub.put(kind, b"")
    taking = view.take()
    while next(taking)[0] != after:
        pass
    hub.disconnect("it has gone")
    rest = [kind for kind, _ in (*taking, *view.take())]
    assert rest == ["lost", "poses"]


@pytest.mark.parametrize("after", ["record", "lost"])
def test_a_server_that_comes_while_a_view_takes_is_told_before_what_it_emits(
    hub: Hub, after: str
) -> None:
    view = hub.join(lambda: None)
    hub.disconnect("it is not there yet")
    hub.put("record", b"")
    taking = view.take()
    while next(taking)[0] != after:
        pass
    for kind in ("array", "frame", "state"):
        hub.put(kind, b"")
    hub.show(SceneMirror().with_("hall", {"ball": BALL}, {"ball": POSE}))
    kinds = [kind for kind, _ in (*taking, *view.take())]
    assert [kind for kind in kinds if kind != "record"] == ["array", "frame", "state", "scenery"]


def test_a_refusal_is_for_one_or_all_and_few_wait(hub: Hub) -> None:
    one, other = hub.join(lambda: None), hub.join(lambda: None)
    for page in (one, other):
        list(page.take())
    hub.refuse(one.number, "arm", "no", "do")
    assert taken(one) == [{"type": "refused", "action": "arm", "message": "no", "advice": "do"}]
    assert not taken(other)
    for _ in range(3 * MAX_WAITING_REFUSALS):
        hub.refuse(0, "arm", "no")
    assert len(taken(one)) == len(taken(other)) == MAX_WAITING_REFUSALS


def test_the_page_that_armed_is_told_so_and_lets_go_when_it_goes(hub: Hub) -> None:
    asked: list[tuple[int, object]] = []
    hub.ask = lambda page, what: asked.append((page, what))
    one, other = hub.join(lambda: None), hub.join(lambda: None)
    hub.set_session(OURS, one.number)
    assert [dict(view.take())["session"] for view in (one, other)] != [None, None]
    hub.set_session(OURS, other.number)
    assert [taken(view)[0]["mine"] for view in (one, other)] == [False, True]
    hub.leave(one)
    assert not asked
    hub.leave(other)
    assert asked == [(other.number, Disarm())]
    hub.set_session(OURS, one.number)  # the page requested this before it left
    assert asked[1:] == [(one.number, Disarm())]
    hub.set_session(replace(OURS, armed=False), one.number)
    assert len(asked) == 2
