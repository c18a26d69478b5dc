"""Who has the output while pages and a game want it, and how soon there is silence when a page goes."""

from __future__ import annotations

import contextlib
import math
import socket
import struct
import time
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import msgpack
import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.serving.settings import Safety, Settings

from .browser import status
from .conftest import SETTINGS, Game
from .watching import LIMIT, Page

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.testing.server import Running

MARGIN = 0.5  # [s] for states that come 30 times a second, and a machine that does other things
BALL = pc.Volume(
    name="ball", shape=pc.Sphere(0.02), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=5.0
)
BYE = b"\x88\x80" + bytes(4)


@pytest.fixture(scope="module")
def settings() -> Settings:
    return replace(SETTINGS, safety=Safety(lease=1.0, stale=1.0))


@contextlib.contextmanager
def raw(url: str) -> Iterator[socket.socket]:
    """A page's connection, byte by byte."""
    parts = urlsplit(url)
    asked = (
        f"GET /feed?{parts.query} HTTP/1.1\r\nHost: {parts.netloc}\r\nOrigin: http://{parts.netloc}\r\n"
        "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n\r\n"
    )
    with socket.create_connection(("127.0.0.1", parts.port or 0), LIMIT) as made:
        made.sendall(asked.encode())
        assert made.recv(12) == b"HTTP/1.1 101"
        yield made


def said(kind: str, **fields: object) -> bytes:
    """A page's message in a frame of its own."""
    data = msgpack.packb({"type": kind, **fields}) or b""
    assert len(data) < 126
    return bytes([0x82, 0x80 | len(data)]) + bytes(4) + data


def sounds(page: Page) -> bool:
    state = page.newest.get("state", {})
    return bool(state.get("output") == "sounding" and state["owner"] == "viewer")


def _armed(page: socket.socket, other: Page) -> None:
    """Until it has sounded for three leases; once more where the machine was too busy."""
    begin, end = math.inf, time.monotonic() + LIMIT
    while not sounds(other) or other.newest["state"]["time"] < begin:
        assert time.monotonic() < end, other.newest["state"]
        if not sounds(other):
            page.sendall(said("arm", scene="room", take=True))
            other.hear(0.1)
            begin = math.inf
        elif begin == math.inf:
            begin = other.newest["state"]["time"] + 3.0 * other.newest["session"]["lease"]
        page.sendall(said("alive"))
        other.hear(0.02)


def test_arming_lasts_while_the_page_is_alive(url: str, server: Running) -> None:
    with Page(url) as page, Page(url) as other:
        page.say("arm")
        page.until(lambda: page.newest.get("session", {}).get("armed"))
        other.until(lambda: other.newest.get("session", {}).get("armed"))
        assert page.newest["session"]["mine"]
        assert not other.newest["session"]["mine"]
        lease = page.newest["session"]["lease"]
        end = time.monotonic() + 4.0 * lease
        while time.monotonic() < end:
            page.say("alive")
            page.listen(lease / 10.0)
        assert page.newest["state"]["armed"]
        assert page.newest["state"]["owner"] == page.newest["session"]["name"]
        assert not page.counts["refused"]
        other.say("alive")  # is not the one that armed
        page.until(lambda: page.counts["refused"])
        assert page.newest["refused"]["action"] == "arm"
        page.until(lambda: not page.newest["session"]["armed"])
        page.until(lambda: not page.newest["state"]["armed"])


@pytest.mark.parametrize("how", ["reset", "closed", "silent"])
def test_there_is_silence_within_the_lease_of_a_page_that_goes(
    url: str, server: Running, how: str
) -> None:
    with Game(server.connection) as game, Page(url) as other, raw(url) as page:
        _armed(page, other)
        assert set(game.refused) == {"owner"}
        left = status(server.connection).time
        if how == "reset":  # as of a computer, or a browser, that is killed
            page.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            page.close()
        elif how == "closed":
            page.sendall(BYE)
        other.until(lambda: other.newest["state"]["output"] == "silent")
        lease = other.newest["session"]["lease"] if how == "silent" else 0.0
        assert other.newest["state"]["time"] - left < lease + MARGIN
        other.until(lambda: not other.newest["session"]["armed"])
        assert not other.counts["refused"]  # it was not its own


def test_a_game_that_takes_the_output_back_is_not_disturbed_by_a_page_that_is_alive(
    url: str, server: Running
) -> None:
    with Page(url) as page, pc.Client(server.connection, name="game", scene="room") as game:
        game.put(BALL)
        page.say("arm", scene="room")
        page.until(lambda: page.newest.get("session", {}).get("mine"))
        page.say("alive")
        game.arm(take=True)
        begin, refused = game.status().time, list[str]()
        seen: list[dict[str, Any]] = []
        while not seen or seen[-1]["time"] < begin + 4.0 * game.lease:
            try:
                game.renew()
            except pc.Refused as error:
                refused.append(error.code)
                game.arm()
            page.say("alive")
            page.hear(0.02)
            if (state := page.newest.get("state", {"time": 0.0}))["time"] > begin:
                seen.append(state)
        assert set(refused) <= {"expired"}  # where the machine was too busy
        assert {state["owner"] for state in seen} == {"game"}
        outputs = [state["output"] for state in seen]
        assert refused or "silent" not in outputs[outputs.index("sounding") :]
        page.until(lambda: page.counts["refused"])
        assert page.newest["refused"]["action"] == "arm"
        assert page.newest["refused"]["message"] in (
            "game has taken the output", "the lease was not renewed in time: silence",
        )  # fmt: skip
        assert page.counts["refused"] == 1
        assert not page.newest["session"]["armed"]


def test_a_page_that_took_over_from_another_keeps_the_output_when_that_goes(
    url: str, server: Running
) -> None:
    assert any(_kept(url) for _ in range(5))  # again where the machine was too busy for a lease


def _kept(url: str) -> bool:
    with Page(url) as page:
        with Page(url) as before:
            before.say("arm")
            before.until(lambda: before.newest.get("session", {}).get("mine"))
            page.say("arm")
            page.until(lambda: page.newest.get("session", {}).get("mine"))
            before.until(lambda: not before.newest["session"]["mine"])
        end = time.monotonic() + 3.0 * page.newest["session"]["lease"]
        while time.monotonic() < end:
            page.say("alive")
            page.hear(0.02)
        page.next("state")
        return bool(page.newest["session"]["mine"] and not page.counts["refused"])
