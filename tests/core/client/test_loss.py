"""Servers that are missing, end, hang or come back. Nothing resumes by itself, and no old message arrives."""

import os
import socket
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import zmq
from msgspec.structs import replace

import pacinian as pc
from pacinian.client import server_session
from pacinian.client.emergency_stop import emergency_stop
from pacinian.wire import commands, control, replies
from pacinian.wire.binary_arrays import unpack
from pacinian.wire.connection_file import Connection

from ...waiting import PATIENCE
from .fake_server import Fake, usual

FOREVER = 1e4  # timeout that no test reaches [s]
POINT = pc.Point(position=(0.0, 0.01, 0.2), radiation_pressure=5.0, name="button")
HEAVY = pc.Particles(
    positions=tuple((0.0, 0.0, 1e-5 * i) for i in range(5000)), radiation_pressure=5.0, name="rain"
)


def lost(client: pc.Client, call: Callable[[], object], says: str = "server") -> None:
    """Repeat the call until it raises ConnectionLost."""
    end = time.monotonic() + PATIENCE
    with pytest.raises(pc.ConnectionLost, match=says):  # noqa: PT012
        while time.monotonic() < end:
            call()
            time.sleep(0.001)  # for the other thread
    assert not client.connected
    assert not client.armed


@contextmanager
def other_link(server: Fake) -> Iterator[tuple[socket.socket, pc.Client]]:
    """Open a client whose commands go to a listener that never answers."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        at = f"tcp://127.0.0.1:{listener.getsockname()[1]}"
        with pc.Client(replace(server.connection, command=at)) as client:
            yield listener, client


def cut(listener: socket.socket, client: pc.Client) -> None:
    """Close the command connection, and wait until the client's monitor has reported it."""
    listener.accept()[0].close()
    assert client._server_session._command.monitor.poll(1e3 * PATIENCE)


def nobody() -> Connection:
    """Return a connection to ports on which nobody listens."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        at = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    return Connection(pid=1, control=at, command=at, state=at, token="x")


def test_nobody_there_is_told_at_once() -> None:
    with pytest.raises(pc.ConnectionLost, match="is `pacinian serve` running"):
        pc.Client(nobody(), timeout=FOREVER)
    with pytest.raises(pc.ConnectionLost, match="is `pacinian serve` running"):
        emergency_stop(nobody(), timeout=FOREVER)


def test_a_server_without_its_bus_is_told(server: Fake) -> None:
    server.deaf = True  # otherwise its answer may come first
    with pytest.raises(pc.ConnectionLost, match="If it is, it restarts its bus process: try again"):
        pc.Client(replace(server.connection, command=nobody().command), timeout=FOREVER)


def test_a_wrong_token_is_told(server: Fake) -> None:
    with pytest.raises(pc.ConnectionLost, match="token or key"):
        pc.Client(replace(server.connection, token="x" * 64))
    assert server.seen == []


def test_a_server_of_something_else_is_told() -> None:
    with zmq.Context() as context, context.socket(zmq.ROUTER) as router:
        at = f"tcp://127.0.0.1:{router.bind_to_random_port('tcp://127.0.0.1')}"
        with pytest.raises(pc.ConnectionLost, match="not a Pacinian server"):
            pc.Client(Connection(pid=1, control=at, command=at, state=at, token="x"))


def test_an_address_that_is_none_is_told() -> None:
    with pytest.raises(pc.ConnectionLost, match="cannot connect to nowhere"):
        pc.Client(Connection(pid=1, control="nowhere", command="", state="", token="x"))


@pytest.mark.parametrize("secrets", [{}, {"server_key": "x" * 40}, {"server_key": "short"}])
def test_a_connection_without_secrets_is_told(secrets: dict[str, str]) -> None:
    with pytest.raises(pc.ConnectionLost, match="neither a token"):
        pc.Client(Connection(pid=1, control="", command="", state="", **secrets))


def test_a_server_that_goes_in_the_middle_of_a_call(server: Fake) -> None:
    server.answers[commands.Put] = lambda _: server.die()
    with pc.Client(server.connection, timeout=FOREVER) as client:
        with pytest.raises(pc.ConnectionLost, match="has gone"):
            client.put(POINT)
        assert not client.connected


@pytest.mark.parametrize("first", [b"", b"HTTP/1.1 400 Bad Request\r\n\r\n"])
def test_a_server_has_gone_also_where_a_connection_was_still_in_its_handshake(
    server: Fake, first: bytes
) -> None:
    with other_link(server) as (listener, client):
        near, _ = listener.accept()
        with near:
            near.sendall(first)
        lost(client, client.renew, "has gone; nothing of this session goes on")


def test_an_end_is_told_however_much_comes_by_the_other_link(server: Fake) -> None:
    with other_link(server) as (listener, client):
        cut(listener, client)

        def renew() -> None:
            assert client._server_session._control.socket.poll(
                1e3 * PATIENCE
            )  # the answer to the last request
            client.renew()

        client._server_session._renew()
        lost(client, renew, "has gone")
        assert len(server.of(control.Renew)) == 1


def test_an_end_that_came_beside_an_answer_is_told_after_it(
    server: Fake, monkeypatch: pytest.MonkeyPatch
) -> None:
    with other_link(server) as (listener, client):
        session = client._server_session
        sent = session._send

        def heard(*given: Any) -> bool:
            """Send, wait for the answer, then close the command connection."""
            done = sent(*given)
            assert session._control.socket.poll(1e3 * PATIENCE)
            cut(listener, client)
            return done

        with monkeypatch.context() as patch:
            patch.setattr(session, "_send", heard)
            client.status()
        with pytest.raises(pc.ConnectionLost, match="has gone"):
            client.put(POINT)


def test_why_it_fell_silent_is_told_before_its_loss(server: Fake) -> None:
    with other_link(server) as (listener, client):
        client.arm()
        server.say(replies.Error(code="expired", message="not renewed in time"))
        assert client._server_session._control.socket.poll(1e3 * PATIENCE)
        cut(listener, client)
        with pytest.raises(pc.Refused, match="not renewed in time"):
            client.renew()
        with pytest.raises(pc.ConnectionLost, match="has gone"):
            client.renew()


def test_a_server_that_says_nothing_is_lost_in_time(server: Fake) -> None:
    late: list[Any] = []
    server.answers[commands.Put] = late.append
    with pc.Client(server.connection) as client:
        client.clear()  # commands are connected
        client._server_session.timeout = 0.2
        with pytest.raises(pc.ConnectionLost, match=r"no answer to `put` within 0.2 s"):
            client.put(POINT)
        server.until(lambda: bool(late))
        client.reconnect()
        answer = replies.Error(id=late[0].id, code="limit", message="late")
        server.answers[control.Reset] = lambda m: [answer, usual(m)]
        client.reset()  # the late answer must not count as its reply


@pytest.mark.parametrize("asked", [True, False])
def test_a_session_that_the_server_has_ended(server: Fake, asked: bool) -> None:
    ended = {"code": "session", "message": "the bus was started anew"}
    with pc.Client(server.connection) as client:
        client.arm()
        if asked:
            server.answers[control.Reset] = lambda m: replies.Error(id=m.id, **ended)
            lost(client, client.reset, "the bus was started anew")
        else:
            server.say(replies.Error(**ended))  # type: ignore[arg-type]
            lost(client, client.renew, "the bus was started anew")
        with pytest.raises(pc.ConnectionLost):
            client.renew()
        assert [m for m in server.seen if isinstance(m, control.Bye)] == []


@pytest.mark.parametrize("call", ["renew", "cast", "ask", "watch", "poll_state", "hold"])
def test_any_call_finds_out_and_all_after_it_tell_it_again(server: Fake, call: str) -> None:
    with pc.Client(server.connection) as client:
        client.arm()
        server.close()
        calls: dict[str, Callable[[], object]] = {
            "renew": client.renew,
            "cast": lambda: client.put(POINT, wait=False),
            "ask": client.status,
            "watch": lambda: next(client.watch(PATIENCE)),
            "poll_state": client.poll_state,
            "hold": lambda: client.hold(PATIENCE),
        }
        lost(client, calls[call], "has gone")
        for again in (*calls.values(), client.arm):
            with pytest.raises(pc.ConnectionLost, match="has gone"):
                again()


def test_who_watches_finds_out_at_once(server: Fake) -> None:
    watching: list[pc.Client] = []

    def watch() -> object:
        with pc.Client(server.connection) as client:
            watching.append(client)
            return next(client.watch(FOREVER))

    with ThreadPoolExecutor(1) as pool:
        seen = pool.submit(watch)
        server.until(lambda: bool(watching and watching[0]._server_session._states is not None))
        server.close()
        with pytest.raises(pc.ConnectionLost, match="has gone"):
            seen.result(timeout=PATIENCE)


def test_nothing_resumes_after_a_restart(server: Fake, tmp_path: Path) -> None:
    path = server.connection.write(tmp_path / "connection.json")
    with pc.Client(path, reconnect=True, scene="hall") as client:
        client.put(POINT)
        client.hands(pc.Hand.open())
        client.arm()
        server.close()
        with Fake(server.ports) as again:  # on the same ports, with the same token
            lost(client, lambda: client.put(POINT, wait=False))
            with pytest.raises(pc.ConnectionLost):
                client.renew()  # `renew` never reconnects
            assert again.seen == []
            client.clear()  # other calls do
            assert client.connected
            assert not client.armed
            client.renew()
            again.until(lambda: bool(again.of(control.Renew)))
        kinds = [type(m) for m in again.seen]
        assert kinds == [control.Hello, commands.Clear, control.Renew]
        assert again.seen[0].scene == "hall"
        assert again.seen[1].sequence == 1


def test_it_reconnects_where_the_file_says_now(server: Fake, tmp_path: Path) -> None:
    path = server.connection.write(tmp_path / "connection.json")
    with Fake() as other, pc.Client(path) as client:
        server.close()
        lost(client, client.status)
        with pytest.raises(pc.ConnectionLost):
            client.status()  # it does not reconnect by itself
        with pytest.raises(pc.ConnectionLost, match="running"):
            client.reconnect()
        other.connection.write(path)
        client.reconnect()
        client.put(POINT)
        assert [type(m) for m in other.seen] == [control.Hello, commands.Put]


def test_a_stop_reaches_a_new_server_though_the_session_is_lost(
    server: Fake, tmp_path: Path
) -> None:
    path = server.connection.write(tmp_path / "connection.json")
    with pc.Client(path) as client:
        server.close()
        with Fake() as other:
            other.connection.write(path)
            client.stop()
            assert [type(m) for m in other.seen] == [control.Stop]
        assert not client.connected


def fill(server: Fake, client: pc.Client) -> None:
    """Send until the socket has no room, and still has none after `status` has answered 20 times."""
    client.clear()  # commands are connected
    server.full = True
    box, without = client._server_session.outbox, 0
    for _ in range(5000):
        client.put(HEAVY, wait=False, ttl=60.0)
        without = without + 1 if box.waiting else 0
        if without == 20:
            return
        if without:
            client.status()
    raise AssertionError("the socket always had room")


def test_newest_wins_while_there_is_no_room(server: Fake) -> None:
    with pc.Client(server.connection) as client:
        fill(server, client)
        before = client._server_session.outbox.superseded
        for i in range(200):
            client.move("rain", pc.Pose((1e-3 * i, 0.0, 0.2)), wait=False, ttl=60.0)
            client.hands(wait=False, ttl=60.0)
        assert len(client._server_session.outbox.waiting) <= 3
        assert client._server_session.outbox.superseded - before >= 2 * 199
        server.full = False
        server.until(lambda: client.renew() is None and not client._server_session.outbox.waiting)
        client.clear()
        (move,) = server.of(commands.Move)
        assert unpack(move.poses, 7)[0, 0] == pytest.approx(0.199)
        assert len(server.of(commands.Hands)) == 1
        sequences = [m.sequence for m in server.seen if isinstance(m, commands.Command)]
        assert sequences == sorted(set(sequences))


def test_nothing_that_waited_reaches_a_new_server(server: Fake) -> None:
    with pc.Client(server.connection, reconnect=True) as client:
        fill(server, client)
        client.move("rain", pc.Pose(), wait=False)
        server.close()
        with Fake(server.ports) as again:
            lost(client, client.renew)
            client.clear()
            client.renew()
            again.until(lambda: bool(again.of(control.Renew)))
            assert [type(m) for m in again.seen] == [control.Hello, commands.Clear, control.Renew]


def test_closing_does_not_wait_for_a_server_that_hangs(
    server: Fake, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server_session, "BYE_TIMEOUT", 0.2)  # the default
    client = pc.Client(server.connection, timeout=FOREVER)
    fill(server, client)
    server.deaf = True
    client.close()


def test_a_server_without_room_for_what_waits_is_lost(server: Fake) -> None:
    with pc.Client(server.connection) as client:
        fill(server, client)
        client._server_session.timeout = 0.1
        client.move("rain", pc.Pose(), wait=False, ttl=60.0)
        with pytest.raises(pc.ConnectionLost, match=r"no room for a command within 0.1 s"):
            client.put(POINT)


def test_curve_keys_from_a_folder_or_a_file(tmp_path: Path) -> None:
    from zmq.auth import create_certificates, load_certificate

    create_certificates(tmp_path, "server")
    create_certificates(tmp_path, "game")
    if os.name == "posix":
        (tmp_path / "game.key_secret").chmod(0o644)
        with pytest.raises(pc.ArgumentError, match="chmod 600"):
            pc.Client(nobody(), keys=tmp_path)
    (tmp_path / "game.key_secret").chmod(0o600)
    public, secret = load_certificate(tmp_path / "server.key_secret")
    assert secret
    with Fake(keys=(public, secret)) as server:
        for keys in (tmp_path, tmp_path / "game.key_secret"):
            with pc.Client(server.connection, keys=keys) as client:
                client.put(POINT)
        (tmp_path / "server.key").unlink()  # the connection file also contains the key
        with pc.Client(server.connection, keys=tmp_path) as client:
            client.put(POINT)
        with pytest.raises(pc.ConnectionLost, match=r"CURVE|token or key"):
            _wrong(server, tmp_path)
        create_certificates(tmp_path, "other")
        with pytest.raises(pc.ArgumentError, match=r"2 .*key_secret"):
            pc.Client(server.connection, keys=tmp_path)
        with pytest.raises(pc.ArgumentError, match="is not a key file"):
            pc.Client(server.connection, keys=tmp_path / "none")


def _wrong(server: Fake, folder: Path) -> None:
    """Connect with a wrong server key."""
    (folder / "server.key").write_bytes((folder / "game.key").read_bytes())
    pc.Client(server.connection, keys=folder / "game.key_secret")
