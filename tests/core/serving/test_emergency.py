"""The emergency stop works despite crowds of other clients, and is confirmed only when it is done."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest

from pacinian.client.connection_keys import resolve_connection
from pacinian.client.emergency_stop import emergency_stop
from pacinian.errors import ConnectionLost
from pacinian.serving.ipc.auth import make_client_keys, make_server_keys
from pacinian.serving.settings import Security
from pacinian.wire.connection_file import Connection
from pacinian.wire.control import Arm, Reset, Status
from pacinian.wire.replies import Ok
from pacinian.wire.stop_datagram import DATAGRAM_BYTES, StopSocket, request_stop, sign, verify

from ...waiting import PATIENCE, eventually
from .control.test_supervisor import CHILD, PARENT
from .processes import PATIENT

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

posix = pytest.mark.skipif(os.name != "posix", reason="limits of open files")
MAX_OPEN_FILES = 64  # that the server may have
COMMAND = f"""
import sys
from pacinian.cli.main import cli
cli(["stop", "--connection", sys.argv[1], "--timeout", "{int(PATIENCE / 2)}"], standalone_mode=False)
print(*sys.modules)
"""
STRANGERS = 200


def test_it_stops_without_a_connection_and_is_confirmed_when_it_is_done(server: Any) -> None:
    game = server.client().hello()
    assert isinstance(game.ask(Arm), Ok)
    connection = server.connection
    assert request_stop(connection.stop, connection.secret, PATIENCE)
    assert server.permit().stopped == 1
    assert game.ask(Arm).code == "stopped"


def test_a_client_needs_nothing_else(server: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pacinian.client.link.Link", None)
    emergency_stop(server.path, timeout=PATIENCE)
    assert server.permit().stopped == 1


def test_the_command_loads_little_because_on_a_busy_machine_that_takes_seconds(server: Any) -> None:
    done = subprocess.run(
        [sys.executable, "-c", COMMAND, str(server.path)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert server.permit().stopped == 1
    assert not {"numpy", "zmq", "asyncio", "pacinian.wire.codec"} & set(done.stdout.split())


def test_who_has_not_the_secret_is_not_answered_and_does_not_stop(server: Any) -> None:
    connection = server.connection
    assert not request_stop(connection.stop, "f" * 64, 0.2)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as stranger:
        for data in (b"", b"stop", bytes(DATAGRAM_BYTES), bytes(60_000)):
            stranger.sendto(data, connection.stop.partition(":")[2])
    assert server.permit().stopped == 0
    assert request_stop(connection.stop, connection.secret, PATIENCE), "the server goes on"


@contextlib.contextmanager
def open_sender(server: Any) -> Iterator[tuple[socket.socket, str, bytes]]:
    """Give a socket for datagrams, the server's address, and a stop that the server accepts."""
    data = sign(server.connection.secret, b"stop", bytes(16))
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
        sender.bind("")
        sender.settimeout(PATIENCE)
        yield sender, server.connection.stop.partition(":")[2], data


def test_a_stop_that_is_sent_again_does_not_undo_a_reset(server: Any) -> None:
    with open_sender(server) as (sender, where, data):
        sender.sendto(data, where)
        confirmed = sender.recv(DATAGRAM_BYTES)
        assert isinstance(server.client().hello().ask(Reset), Ok)
        assert server.permit().stopped == 0
        sender.sendto(data, where)
        assert sender.recv(DATAGRAM_BYTES) == confirmed
        assert server.permit().stopped == 0
        sender.sendto(sign(server.connection.secret, b"stop", bytes(range(16))), where)
        sender.recv(DATAGRAM_BYTES)
        assert server.permit().stopped == 1, "a new stop is carried out"


def test_nor_does_one_that_is_sent_again_before_the_guard_has_confirmed_it(server: Any) -> None:
    (guard,) = server.processes["guard"]
    client = server.client().hello()
    guard.silent = True  # it tells nothing, so no stop is confirmed
    with open_sender(server) as (sender, where, data):
        sender.sendto(data, where)
        eventually(lambda: server.permit().stopped == 1)
        assert isinstance(client.ask(Reset), Ok)
        assert server.permit().stopped == 0
        sender.sendto(data, where)
        for _ in range(3):  # each after a look at the stops
            assert client.ask(Status).output != "stopped"
        assert server.permit().stopped == 0
        guard.silent = False
        sender.recv(DATAGRAM_BYTES)


def test_a_confirmation_that_came_while_the_sender_stood_still_counts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with StopSocket(tmp_path / "stop", "secret") as server:
        times = iter([0.0, 0.1, 9.0])

        class Stopped(socket.socket):
            def recv(self, size: int) -> bytes:  # type: ignore[override]
                if self.gettimeout() == 0.0:
                    return super().recv(size)
                server.confirm(server.receive())
                raise TimeoutError  # as Python does if the time has passed before it looks

        monkeypatch.setattr("time.perf_counter", lambda: next(times))
        monkeypatch.setattr("socket.socket", Stopped)
        assert request_stop(server.address, "secret", 1.0)


@posix
def test_a_file_that_others_can_read_does_not_prevent_it(server: Any) -> None:
    server.path.chmod(0o644)
    emergency_stop(server.path, timeout=PATIENCE)
    assert server.permit().stopped == 1


def test_where_that_way_is_not_there_it_goes_by_a_connection(server: Any) -> None:
    known = server.connection
    for stop in ("", "unix:/none", "udp:nowhere", "udp:99999999", "pigeon:post"):
        given = Connection(
            pid=known.pid, control=known.control, command=known.command, state=known.state,
            token=known.token, stop=stop,
        )  # fmt: skip
        emergency_stop(given, timeout=PATIENCE)
        assert server.permit().stopped == 1


def test_a_server_that_does_not_confirm_is_told_as_such(tmp_path: Path) -> None:
    with StopSocket(tmp_path / "stop", "secret") as deaf:
        given = Connection(
            pid=os.getpid(), control="tcp://127.0.0.1:9", command="", state="", token="secret",
            stop=deaf.address,
        )  # fmt: skip
        with pytest.raises(ConnectionLost):
            emergency_stop(given, timeout=0.2)
        (nonce, _), *_ = deaf.receive()
    assert len(nonce) == 16


def test_with_curve_the_keys_of_the_file_prove_it_and_those_of_others_go_by_a_connection(
    start_server: Callable[..., Any], tmp_path: Path
) -> None:
    keys = tmp_path / "keys"
    make_server_keys(keys)
    make_client_keys(keys, "headset")
    server = start_server(
        PATIENT.__class__(log=PATIENT.log, safety=PATIENT.safety, security=Security(str(keys)))
    )
    connection = server.connection
    assert not connection.token
    assert request_stop(connection.stop, connection.secret, PATIENCE)
    assert not resolve_connection(connection, keys / "headset.key_secret").stop


def test_a_datagram_proves_the_secret_and_what_it_says() -> None:
    nonce = bytes(range(16))
    data = sign("secret", b"stop", nonce)
    assert len(data) == DATAGRAM_BYTES
    assert verify("secret", b"stop", data) == nonce
    assert not verify("secret", b"stopped", data)
    assert not verify("other", b"stop", data)
    for i in range(DATAGRAM_BYTES):
        assert not verify("secret", b"stop", data[:i])
        assert not verify("secret", b"stop", data[:i] + bytes([data[i] ^ 1]) + data[i + 1 :])


@posix
@pytest.mark.deep
def test_strangers_who_take_all_files_do_not_keep_out_a_stop_or_a_new_guard(tmp_path: Path) -> None:
    path = tmp_path / "connection.json"
    log = tmp_path / "log"
    limited = f'ulimit -n {MAX_OPEN_FILES}; exec "$0" "$@"'
    with contextlib.ExitStack() as stack:
        out = stack.enter_context(log.open("wb"))
        process = stack.enter_context(
            subprocess.Popen(
                ["sh", "-c", limited, sys.executable, "-c", PARENT, str(path), CHILD],
                stdout=out,
                stderr=out,
            )
        )
        stack.callback(process.kill)
        eventually(path.exists)
        host, _, port = Connection.read(path).control.removeprefix("tcp://").rpartition(":")
        strangers: list[socket.socket] = []

        def come() -> None:
            """Connect again after each rejection."""
            for stranger in list(strangers):
                with contextlib.suppress(BlockingIOError):
                    if not _heard(stranger):
                        strangers.remove(stranger)
                        stranger.close()
            while len(strangers) < STRANGERS:
                strangers.append(stack.enter_context(socket.socket()))
                strangers[-1].setblocking(False)
                with contextlib.suppress(ConnectionError):
                    strangers[-1].connect_ex((host, int(port)))

        files = f"/proc/{process.pid}/fd"
        eventually(lambda: len(os.listdir(files)) >= MAX_OPEN_FILES, come)
        emergency_stop(path, timeout=PATIENCE)

        def guards_started() -> list[str]:
            """Return the process ids of all guards and spares, in the order of their starts."""
            words = [line.split() for line in log.read_text().splitlines()]
            return [w[2] for w in words if w[:2] in (["started", "guard"], ["started", "spare"])]

        for _ in range(3):
            before = eventually(guards_started)
            for guard in before:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(int(guard), signal.SIGKILL)
            eventually(lambda: len(guards_started()) > len(before), come)  # noqa: B023
        assert "could not be started" not in log.read_text()
        process.terminate()  # while they still try
        eventually(lambda: process.poll() is not None, come)
        assert process.returncode == 0
        assert not path.exists()


def _heard(stranger: socket.socket) -> bytes:
    try:
        return stranger.recv(64)
    except ConnectionError:
        return b""
