"""Messages of a page: every other sequence of bytes is rejected."""

from __future__ import annotations

import contextlib
import math
from typing import Any

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pacinian.errors import WireError
from pacinian.viewing.messages import MAX_POINTS, Slice, Volume, decode_message

SLICE: dict[str, Any] = {
    "type": "slice", "id": 1, "centre": [0, 0, 0.1], "u": [1, 0, 0], "v": [0, 1, 0], "size": [0.1, 0.2],
    "shape": [128, 128],
}  # fmt: skip
VOLUME: dict[str, Any] = {
    "type": "volume", "id": 1, "origin": [0, 0, 0.1], "spacing": 0.01, "shape": [64, 64, 64],
}  # fmt: skip
NAN, BIG = math.nan, 2**53 + 1
PLAIN = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats()
    | st.text()
    | st.binary(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=12,
)


def asked(message: Any) -> Any:
    return decode_message(msgpack.packb(message) or b"")


def test_a_slice_and_a_volume_are_understood() -> None:
    assert asked(SLICE) == Slice(
        id=1, centre=(0, 0, 0.1), u=(1, 0, 0), v=(0, 1, 0), size=(0.1, 0.2), shape=(128, 128)
    )
    volume = asked(VOLUME)
    assert isinstance(volume, Volume)
    assert MAX_POINTS == 64**3
    assert asked({**SLICE, "later": [1, {"a": None}]}) == asked(SLICE)


WRONG = [
    *({**SLICE, **change} for change in (
        {"id": 0}, {"id": BIG}, {"id": 1.5}, {"id": None}, {"centre": [0, 0]}, {"centre": [0, 0, 11]},
        {"centre": [0, 0, NAN]}, {"centre": [0, 0, math.inf]}, {"u": [2, 0, 0]}, {"u": [0, 0, 0]},
        {"u": [0, 1, 0]}, {"u": [NAN, 0, 0]}, {"v": [0.1, 1, 0]}, {"size": [0, 1]}, {"size": [1, -1]},
        {"size": [11, 1]}, {"size": [NAN, 1]}, {"shape": [1, 2]}, {"shape": [2, 1025]},
        {"shape": [1024, 1024]}, {"shape": [2.5, 2]}, {"shape": [2]}, {"shape": [2, 2, 2]},
    )),
    *({**VOLUME, **change} for change in (
        {"shape": [65, 64, 64]}, {"shape": [1, 2, 2]}, {"spacing": 0}, {"spacing": NAN}, {"origin": [0, 0]},
    )),
    {"type": "replay", "speed": 0}, {"type": "replay", "speed": 1000}, {"type": "replay", "time": -1},
    {"type": "replay", "time": NAN}, {"type": "record"}, {"type": "record", "on": 1},
    {"type": "hide", "what": "all"}, {"type": "seen"}, {"type": "select", "intensity": 2},
    {"type": "select", "solver": "auto"}, {"type": "arm", "scene": "x" * 65}, {"type": "put"}, {}, [], None,
]  # fmt: skip


@pytest.mark.parametrize("message", WRONG)
def test_what_cannot_be_meant_is_refused(message: Any) -> None:
    with pytest.raises(WireError):
        asked(message)


@given(st.binary(max_size=200))
def test_bytes_are_understood_or_refused(data: bytes) -> None:
    with contextlib.suppress(WireError):
        decode_message(data)


@given(st.sampled_from([SLICE, VOLUME]), st.data(), PLAIN)
def test_a_field_of_any_kind_is_understood_or_refused(
    message: dict[str, Any], data: st.DataObject, value: Any
) -> None:
    name = data.draw(st.sampled_from(sorted(message)))
    with contextlib.suppress(WireError):
        asked({**message, name: value})


def test_deep_nesting_is_refused() -> None:
    with pytest.raises(WireError):
        decode_message(b"\x82\xa4type\xa5slice\xa1x" + b"\x91" * 50_000 + b"\xc0")
