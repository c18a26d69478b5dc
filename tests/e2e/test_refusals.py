"""A real server refuses and logs who is not let in; how, tests/core/serving shows of each of its processes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
import zmq

from pacinian.wire.connection_file import Connection
from pacinian_lab.server.faults.misbehaving_client import MisbehavingClient
from pacinian_lab.server.fuzz.mutations import encode
from pacinian_lab.server.fuzz.packets import PLAIN, encode_greeting, frame, throw

from ..waiting import PATIENCE, eventually

if TYPE_CHECKING:
    from pacinian_lab.server.faults.server import Server

STOP = encode({"type": "stop", "id": 1})


@pytest.mark.parametrize(
    ("token", "whys"), [("0" * 64, {"secret"}), ("", {"protocol", "handshake"})]
)
def test_strangers_get_through_no_socket_and_are_logged(
    server: Server, token: str, whys: set[str]
) -> None:
    with (
        MisbehavingClient(server.file, token=token) as stranger,
        MisbehavingClient(server.file) as known,
    ):
        with stranger.context.socket(zmq.SUB) as state:
            state.linger = 0
            state.subscribe(b"")
            state.connect(stranger.file["state"])
            eventually(lambda: [e for e in server.events() if e.get("why") in whys])
            known.hello(PATIENCE)
            assert known.ask("status", PATIENCE)["output"] == "silent"
            assert not state.poll(0)
        assert not stranger.control.poll(0, zmq.POLLOUT)
        assert not stranger.command.poll(0, zmq.POLLOUT)
    assert Connection.read(server.file).token not in server.read_output()


def test_raw_bytes_of_strangers_stop_nothing(server: Server) -> None:
    connection = Connection.read(server.file)
    for address in (connection.control, connection.command, connection.state):
        for data in (
            b"\x01\0" + bytes([len(STOP) + 1, 0]) + STOP,  # ZMTP 1.0
            b"POST / HTTP/1.1\r\nContent-Length: 9\r\n\r\n" + frame(STOP),
            encode_greeting(b"NULL") + frame(STOP),
            PLAIN + frame(STOP),
        ):
            throw(address, data)
    with MisbehavingClient(server.file) as client:
        client.hello(PATIENCE)
        assert client.ask("status", PATIENCE)["output"] == "silent"
