"""Messages that must be rejected, and losses that must be noticed, on real sockets."""

from __future__ import annotations

import contextlib
import os
import random
import signal
import socket
import subprocess
import sys
import time
from typing import TYPE_CHECKING, Any

import pytest
import zmq

from pacinian.serving.settings import Log, Safety, Settings
from pacinian.wire.codec import decode_reply, encode
from pacinian.wire.control import Arm, Hello, Renew, Status, Stop
from pacinian.wire.protocol import MAJOR, MAX_CONTROL_BYTES, MINOR
from pacinian.wire.replies import Error, Ok

from ....waiting import PATIENCE, eventually

if TYPE_CHECKING:
    from collections.abc import Iterator

STOP = encode(Stop(id=1))
PROTOCOL = "protocol", "handshake"  # depends on which side closes the connection first
FAILED = (
    zmq.EVENT_HANDSHAKE_FAILED_AUTH
    | zmq.EVENT_HANDSHAKE_FAILED_PROTOCOL
    | zmq.EVENT_HANDSHAKE_FAILED_NO_DETAIL
)
GREETING = b"\xff\x00\x00\x00\x00\x00\x00\x00\x01\x7f\x03\x00PLAIN" + bytes(47)
CLIENT = """
import sys, threading, time
import zmq
from pacinian.wire.codec import decode_reply, encode
from pacinian.wire.connection_file import Connection
from pacinian.wire.control import Arm, Hello, Renew
from pacinian.wire.protocol import MAJOR, MINOR
connection = Connection.read(sys.argv[1])
socket = zmq.Context().socket(zmq.DEALER)
socket.linger = 0
socket.plain_username, socket.plain_password = b"pacinian", connection.token.encode()
socket.connect(connection.control)
socket.send(encode(Hello(protocol=(MAJOR, MINOR), client="other")))
key = decode_reply(socket.recv()).session
for n in range(1, 100000):
    socket.send(encode(Arm(session=key, take=True)))
    socket.send(encode(Renew(session=key, sequence=n, time=time.perf_counter())))
    while socket.poll(0):
        socket.recv()
    time.sleep(0.01)
"""


def raw(server: Any, port: str = "control") -> socket.socket:
    address = getattr(server.connection, port).removeprefix("tcp://")
    host, _, number = address.rpartition(":")
    return socket.create_connection((host, int(number)), timeout=PATIENCE)


def closed(stream: socket.socket) -> bool:
    """Return whether the other side closes the connection."""
    try:
        while stream.recv(4096):
            pass
    except ConnectionError:
        pass
    return True


# strangers


STRANGE = (
    b"\x01\x00" + bytes([len(STOP) + 1, 0]) + STOP,  # ZMTP 1.0
    b"\x01\x00\x01\x7f\x04\x00" + STOP,
    b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\n" + STOP,
    GREETING.replace(b"PLAIN", b"NULL\0") + b"\x04\x19\x05READY\x0bSocket-Type\0\0\0\x06DEALER"
    b"\x00" + bytes([len(STOP)]) + STOP,
    GREETING + b"\x00" + bytes([len(STOP)]) + STOP,  # no handshake at all
    random.Random(1).randbytes(5000),
    bytes(5000),
)
UNFINISHED = b"", b"\xff\x00", GREETING


@pytest.mark.parametrize("port", ["control", "state"])
def test_strangers_and_who_does_not_say_who_it_is_are_dropped_unheard(
    server: Any, port: str
) -> None:
    began = time.monotonic()
    with contextlib.ExitStack() as stack:
        streams = [stack.enter_context(raw(server, port)) for _ in (*STRANGE, *UNFINISHED)]
        for stream, data in zip(streams, (*STRANGE, *UNFINISHED), strict=True):
            stream.sendall(data)
        for stream in streams[len(STRANGE) :]:
            assert closed(stream)
            assert time.monotonic() - began > 0.5, "it had the time to say more"
        assert all(map(closed, streams[: len(STRANGE)]))
    assert server.client().hello().ask(Status).output == "silent", "nothing stopped it"
    assert server.permit().stopped == 0


@pytest.mark.parametrize("token", ["0" * 64, ""])
def test_a_wrong_token_or_none_is_refused_and_logged(logged: Any, server: Any, token: str) -> None:
    stranger = server.client(token=token, sndtimeo=0)
    with contextlib.suppress(zmq.Again):  # it may be refused already
        stranger.send(Stop(id=1))
    logged.refused(*(PROTOCOL if not token else ("secret",)))
    quiet = server.socket(zmq.SUB, token=token)
    quiet.subscribe(b"")
    ended = server.monitor(quiet, FAILED)
    quiet.connect(server.connection.state)
    assert ended.poll(1e3 * PATIENCE)
    server.states()()  # another subscriber still gets states
    server.client().hello().ask(Status)
    assert not quiet.poll(0)
    assert not stranger.socket.poll(0)
    assert server.permit().stopped == 0


def test_the_token_of_a_run_before_is_refused(logged: Any, start_server: Any) -> None:
    first = start_server()
    old = first.connection.token
    first.end()
    server = start_server()
    assert server.connection.token != old
    with contextlib.suppress(zmq.Again):  # it may already be refused
        server.client(token=old, sndtimeo=0).send(Stop())
    logged.refused("secret")
    assert server.permit().stopped == 0


# messages and routes


def test_a_message_that_is_too_long_ends_that_connection_only(server: Any) -> None:
    calm = server.client().hello("calm")
    rude = server.client().hello("rude")
    rude.socket.send(bytes(MAX_CONTROL_BYTES + 1))
    eventually(lambda: [c.name for c in calm.ask(Status).clients] == ["calm"])
    calm.socket.send(bytes(MAX_CONTROL_BYTES))

    def refused() -> Any:
        reply = calm.hear()  # meanwhile, control may measure the latency of its connection
        return reply if isinstance(reply, Error) else None

    assert eventually(refused).code == "malformed"


def test_one_routing_id_is_one_clients(server: Any) -> None:
    first = server.client(routing_id=b"twin").hello("first")
    second = server.socket(zmq.DEALER, routing_id=b"twin")
    there = server.monitor(second, zmq.EVENT_HANDSHAKE_SUCCEEDED)
    second.connect(server.connection.control)
    second.send(encode(Hello(id=1, protocol=(MAJOR, MINOR), client="second")))
    assert there.poll(1e3 * PATIENCE)
    for _ in range(20):
        assert isinstance(first.ask(Arm), Ok)
        assert [c.name for c in first.ask(Status).clients] == ["first"]
    assert not second.poll(0)


def test_a_key_on_another_connection_is_refused_and_logged(logged: Any, server: Any) -> None:
    game, thief = server.client().hello(), server.client()
    thief.session = game.session
    assert thief.ask(Arm).code == "session"
    assert game.session.hex() not in logged.wait("another connection")


def test_a_slow_reader_delays_nobody(server: Any) -> None:
    slow = server.client(rcvhwm=1).hello("slow")
    states = server.socket(zmq.SUB, rcvhwm=1)
    states.subscribe(b"")
    states.connect(server.connection.state)
    for n in range(3000):
        slow.send(Status(session=slow.session, id=n))
    game = server.client().hello()
    assert isinstance(game.ask(Stop), Ok)


# links


@contextlib.contextmanager
def other(server: Any) -> Iterator[subprocess.Popen[bytes]]:
    """A client in another process, which arms and renews all the time."""
    command = [sys.executable, "-c", CLIENT, str(server.path)]
    with subprocess.Popen(command) as process:
        try:
            eventually(lambda: server.permit().armed == 1)
            yield process
        finally:
            process.kill()


def test_a_client_that_is_killed_is_silenced_by_its_link(server: Any) -> None:
    watcher = server.client().hello("watcher")
    with other(server) as process:
        process.kill()
        eventually(lambda: server.permit().armed == 0)
        assert [c.name for c in watcher.ask(Status).clients] == ["watcher"], "not its lease"


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_a_client_that_is_stopped_is_silenced_by_its_lease(start_server: Any) -> None:
    server = start_server(Settings(log=Log(level="warning"), safety=Safety(session_timeout=3600.0)))
    with other(server) as process:
        watcher = server.client().hello("watcher")
        os.kill(process.pid, signal.SIGSTOP)
        eventually(lambda: server.permit().armed == 0)
        there = {c.name for c in watcher.ask(Status).clients}
        assert there == {"watcher", "other"}, "not its link"


def test_a_connection_that_died_half_is_noticed(server: Any) -> None:
    """The client's side is gone without notice: a relay keeps the connection open, but passes nothing on."""
    relay = socket.create_server(("127.0.0.1", 0))
    calm = server.client().hello("calm")
    game = server.socket(zmq.DEALER)
    game.heartbeat_ivl, game.heartbeat_ttl, game.heartbeat_timeout = 50, 4000, 60_000
    game.connect(f"tcp://127.0.0.1:{relay.getsockname()[1]}")
    with relay, relay.accept()[0] as near, raw(server) as far:
        near.settimeout(0.002)
        far.settimeout(0.002)

        def pass_on() -> bytes:
            """Return the bytes from the client."""
            came = b""
            for source, target in ((near, far), (far, near)):
                with contextlib.suppress(TimeoutError):
                    data = source.recv(65536)
                    target.sendall(data)
                    came += data if source is near else b""
            return came

        def armed() -> bool:
            pass_on()
            return bool(server.permit().armed == 1)

        game.send(encode(Hello(id=1, protocol=(MAJOR, MINOR), client="far")))

        def answered() -> Any:
            pass_on()
            return game.poll(0)

        eventually(answered)
        key = decode_reply(game.recv()).session
        game.send(encode(Arm(session=key)))
        eventually(armed)
        eventually(lambda: b"\x04PING" in pass_on())  # the last bytes that arrive
        game.send(encode(Renew(session=key, sequence=1, time=time.perf_counter())))
        # from here on, nothing is passed on
        eventually(lambda: server.permit().armed == 0)
        assert [c.name for c in calm.ask(Status).clients] == ["calm"], "not its lease"
