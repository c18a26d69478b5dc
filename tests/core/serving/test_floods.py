"""What a client may do to libzmq itself: see `UNCONFIRMED` in security.py."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import pytest
import zmq

from pacinian.testing import serving
from pacinian.wire.codec import encode
from pacinian.wire.connection import Connection
from pacinian.wire.control import Stop
from pacinian.wire.protocol import LONGEST_CONTROL

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.testing import Running

SECONDS = 0.4  # [s] of a flood


@pytest.fixture(scope="module")
def server() -> Iterator[Running]:
    with serving() as running:
        yield running


@pytest.mark.parametrize("socket", ["control", "command", "state"])
@pytest.mark.parametrize("data", [encode(Stop(id=1)), b"\xc1", bytes(LONGEST_CONTROL // 8)])
def test_one_that_floods_and_is_gone_takes_no_process_with_it(
    server: Running, socket: str, data: bytes
) -> None:
    given = Connection.read(server.connection)
    before = server.pids
    for _ in range(3):
        with zmq.Context() as context, context.socket(zmq.DEALER) as flood:
            flood.linger, flood.sndhwm = 0, 100_000
            flood.plain_username, flood.plain_password = b"pacinian", given.token.encode()
            flood.connect(getattr(given, socket))
            end = time.monotonic() + SECONDS
            while time.monotonic() < end:
                try:
                    flood.send(data, zmq.NOBLOCK)
                except zmq.Again:
                    flood.poll(1, zmq.POLLOUT)
    assert "Assertion failed" not in server.said()
    assert server.pids == before
    assert server.process.poll() is None
