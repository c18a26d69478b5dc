from __future__ import annotations

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.acoustics.array import autd
from pacinian.serving.bus.coalescing import Message, coalesce
from pacinian.serving.bus.dispatcher import CommandDispatcher
from pacinian.serving.ipc.logs import RateLimitedLog
from pacinian.serving.ipc.messages import SessionInfo, SessionTable
from pacinian.serving.settings import Settings
from pacinian.wire.codec import encode
from pacinian.wire.commands import AnyCommand, Clear, HandFrame
from pacinian.wire.replies import Error

from ..fake_renderer import AtOnce, FakeRenderer, hands, move, point, put, remove, wrap

KEYS = b"k" * 16, b"l" * 16
ARRAY = autd(1, 1)
names = st.lists(st.sampled_from("abc"), min_size=1, max_size=2, unique=True).map(tuple)
xs = st.floats(-0.1, 0.1)
commands = st.lists(
    st.tuples(
        st.sampled_from(KEYS),
        st.one_of(
            st.builds(lambda name, x: put({name: point(x=x)}), st.sampled_from("abc"), xs),
            st.builds(move, names, xs),
            st.builds(move, names, xs),
            st.builds(lambda side: hands(HandFrame(side=side)), st.sampled_from(["left", "right"])),
            st.builds(lambda of: remove(*of), names),
            st.builds(wrap, names, st.floats(0.0, 1.0)),
            st.just(Clear(session=KEYS[0], sequence=1, time=0.0)),
        ),
    ),
    max_size=30,
)


def desk(*keys: bytes) -> CommandDispatcher:
    made = CommandDispatcher(
        Settings(), ARRAY, 7, lambda: None, lambda: (None, 0.0), RateLimitedLog(lambda: 0.0), AtOnce()  # type: ignore[arg-type]
    )  # fmt: skip
    infos = tuple(SessionInfo(key, f"c{i}", "s", "pacinian") for i, key in enumerate(keys))
    made.update_sessions(SessionTable(infos, "s"))
    return made


def said(command: AnyCommand, sequence: int = 1, key: bytes = KEYS[0], **given: object) -> Message:
    now = 0.01 * sequence
    sent = msgspec.structs.replace(command, session=key, sequence=sequence, time=now, **given)
    return Message(key, "pacinian", encode(sent), now)


def felt(made: CommandDispatcher) -> tuple[object, object, object]:
    renderer = FakeRenderer()
    renderer.drain(made.batcher)
    there = renderer.hands
    return renderer.scene, there and set(there.hands), there and there.felt


@settings(max_examples=200)
@given(commands)
def test_all_at_once_or_one_by_one_makes_the_same_scene(
    given: list[tuple[bytes, AnyCommand]],
) -> None:
    messages = [said(command, i + 1, key) for i, (key, command) in enumerate(given)]
    one_by_one, at_once = desk(*KEYS), desk(*KEYS)
    for message in messages:
        one_by_one.handle_messages([message])
    at_once.handle_messages(messages)
    assert felt(at_once) == felt(one_by_one)
    assert at_once.received == one_by_one.received == len(messages)
    for key in KEYS:
        assert at_once.clients[key].commands == one_by_one.clients[key].commands


def test_what_is_replaced_is_not_decoded_and_counted_as_dropped() -> None:
    made = desk(KEYS[0])
    made.handle_messages([said(put({"a": point()}))])
    spoilt = said(move(("a",), 0.0), 2)._replace(data=said(move(("a",), 0.09), 2).data[:-28])
    readable = said(move(("a",), 0.05), 3)
    kept, replaced = coalesce([said(move(("a",), 0.01), 2), readable])
    assert (kept, replaced) == ([readable], {KEYS[0]: 1})
    made.handle_messages([said(move(("a",), 0.01 * x), x) for x in range(2, 12)])
    client = made.clients[KEYS[0]]
    assert (client.commands, client.dropped, client.errors) == (11, 9, 0)
    made.handle_messages([spoilt, readable])
    assert made.refused == 1  # unreadable messages never supersede others


@pytest.mark.parametrize("kind", ["answered", "others", "another's", "another connection's"])
def test_only_a_client_s_own_of_the_same_objects_replaces(kind: str) -> None:
    first = said(move(("a",), 0.01), 1, id=3 if kind == "answered" else 0)
    second = said(move(("b",) if kind == "others" else ("a",), 0.02), 2, KEYS[kind == "another's"])
    if kind == "another connection's":
        second = second._replace(peer=b"x")
    kept, replaced = coalesce([first, second])
    assert kept == [first, second]
    assert not replaced


def test_who_sends_too_much_is_told_also_of_what_would_be_replaced() -> None:
    made = CommandDispatcher(
        Settings(clients=msgspec.structs.replace(Settings().clients, max_rate=5.0)), ARRAY, 7, lambda: None,
        lambda: (None, 0.0), RateLimitedLog(lambda: 0.0), AtOnce(),  # type: ignore[arg-type]
    )  # fmt: skip
    made.update_sessions(SessionTable((SessionInfo(KEYS[0], "c", "s", "pacinian"),), "s"))
    messages = [said(move(("a",), 0.0), i + 1)._replace(time=0.0) for i in range(8)]
    made.handle_messages(messages)
    told = [reply for _, reply in made.replies if isinstance(reply, Error)]
    assert [error.code for error in told].count("busy") == 3
