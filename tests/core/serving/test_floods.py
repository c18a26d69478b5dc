"""Floods against libzmq itself: see `auth.MAX_UNACKNOWLEDGED_TIME`."""

from __future__ import annotations

import contextlib
import time
from typing import TYPE_CHECKING, Any

import pytest
import zmq
from msgspec.structs import replace

from pacinian.scene.config_sections import Units
from pacinian.serving.settings import Log
from pacinian.testing import run_server
from pacinian.wire.codec import encode
from pacinian.wire.connection_file import Connection
from pacinian.wire.control import Stop
from pacinian.wire.protocol import MAX_CONTROL_BYTES

from .processes import PATIENT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.testing import Running

SECONDS = 0.4  # duration of a flood [s]


@pytest.fixture(scope="module")
def server() -> Iterator[Running]:
    with run_server(replace(PATIENT, array=Units(1, 1), log=Log())) as running:
        yield running


@pytest.mark.parametrize("data", [encode(Stop(id=1)), b"\xc1", bytes(MAX_CONTROL_BYTES // 8)])
def test_one_that_floods_and_is_gone_takes_no_process_with_it(server: Running, data: bytes) -> None:
    given = Connection.read(server.connection)
    before = server.pids
    for _ in range(3):
        with zmq.Context() as context, contextlib.ExitStack() as stack:
            floods: list[zmq.Socket[Any]] = []
            for address in (given.control, given.command, given.state):
                floods.append(stack.enter_context(context.socket(zmq.DEALER)))
                floods[-1].linger, floods[-1].sndhwm = 0, 100_000
                floods[-1].plain_username = b"pacinian"
                floods[-1].plain_password = given.token.encode()
                floods[-1].connect(address)
            end = time.monotonic() + SECONDS
            while time.monotonic() < end:
                full = 0
                for flood in floods:
                    try:
                        flood.send(data, zmq.NOBLOCK)
                    except zmq.Again:
                        full += 1
                if full == len(floods):
                    floods[0].poll(1, zmq.POLLOUT)
    assert "Assertion failed" not in server.read_log()
    assert server.pids == before
    assert server.process.poll() is None
