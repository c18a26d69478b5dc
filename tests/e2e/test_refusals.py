"""Who is not let in, or is not who they say: refused, told and logged."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
import zmq

from pacinian.bench.faults.peer import Peer, Silent
from pacinian.bench.faults.stage import until
from pacinian.bench.hostile.packets import PLAIN, frame, greeting, throw
from pacinian.bench.hostile.spoil import encode
from pacinian.wire.connection import Connection
from pacinian.wire.protocol import MAJOR, MINOR

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.bench.faults.server import Server

HELLO = {"type": "hello", "id": 1, "protocol": [MAJOR, MINOR], "client": "stranger"}
STOP = {"type": "stop", "id": 1}


@pytest.fixture
def server(servers: Callable[[], Server]) -> Server:
    return servers()


def refused(server: Server, *why: str) -> list[dict[str, Any]]:
    def seen() -> list[dict[str, Any]]:
        return [e for e in server.events() if e.get("why") in why]

    return until(seen, 5.0)


def output(server: Server) -> str:
    with Peer(server.file) as peer:
        peer.hello()
        return str(peer.ask("status")["output"])


@pytest.mark.parametrize("token", ["0" * 64, "x"])
def test_a_wrong_token_is_refused_and_logged(server: Server, token: str) -> None:
    with Peer(server.file, token=token) as peer:
        assert not peer.control.poll(500, zmq.POLLOUT) or not answers(peer)
        assert not peer.command.poll(0, zmq.POLLOUT)
    assert refused(server, "secret")[0]["event"] == "connection refused"
    assert Connection.read(server.file).token not in server.said()


def answers(peer: Peer) -> bool:
    try:
        peer.hello(wait=1.0)
    except Silent:
        return False
    return True


def test_without_a_token_nothing_is_heard_or_seen(server: Server) -> None:
    with Peer(server.file, token="") as peer:
        assert not peer.control.poll(500, zmq.POLLOUT) or not answers(peer)
        with peer.context.socket(zmq.SUB) as state:
            state.linger = 0
            state.subscribe(b"")
            state.connect(peer.file["state"])
            assert not state.poll(500)
    assert refused(server, "protocol", "handshake")[0]["event"] == "connection refused"


@pytest.mark.parametrize("socket", ["control", "command", "state"])
def test_raw_bytes_of_strangers_stop_nothing(server: Server, socket: str) -> None:
    address = getattr(Connection.read(server.file), socket)
    body = encode(STOP)
    for data in (
        b"\x01\0" + bytes([len(body) + 1, 0]) + body,  # ZMTP 1.0
        b"POST / HTTP/1.1\r\nContent-Length: 9\r\n\r\n" + frame(body),
        greeting(b"NULL") + frame(body),
        PLAIN + frame(body),
    ):
        throw(address, data)
    assert output(server) == "silent"


def test_a_session_of_another_connection_is_refused_and_logged(server: Server) -> None:
    with Peer(server.file) as good, Peer(server.file) as thief:
        assert good.hello()["type"] == "welcome"
        assert good.tell("clear", wait=2.0) == {"type": "ok", "id": good.id}
        thief.session = good.session
        assert thief.ask("status")["code"] == "session"
        assert thief.ask("arm")["code"] == "session"
        thief.sequence = 1000
        refused = thief.tell("clear", wait=2.0)
        assert refused is not None
        assert refused["code"] == "session"
        good.sequence = 2000
        reply = good.tell("clear", wait=2.0)
        assert reply is not None
        assert reply["type"] == "ok"
    until(lambda: [e for e in server.events() if "another connection" in e["event"]])


def test_a_replayed_command_is_refused(server: Server) -> None:
    with Peer(server.file) as peer:
        peer.hello()
        peer.tell("clear", wait=2.0)
        peer.sequence -= 1
        reply = peer.tell("clear", wait=2.0)
        assert reply is not None
        assert reply["code"] == "sequence"


def test_several_parts_are_no_message(server: Server) -> None:
    with Peer(server.file) as peer:
        peer.hello()
        peer.control.send_multipart([b"", encode(STOP)])
        peer.control.send_multipart([encode(STOP), encode(STOP)])
        assert peer.ask("status")["output"] == "silent"
