from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import pytest
import zmq

import pacinian as pc
from pacinian.serving.bus import process as module
from pacinian.serving.bus.process import Bus, open_bus
from pacinian.serving.ipc import launch_config, launched_child
from pacinian.serving.ipc.auth import DOMAIN, USER
from pacinian.serving.ipc.messages import (
    CAPACITIES,
    BusStatus,
    Changes,
    DeviceStatus,
    FrameHead,
    SessionInfo,
    SessionTable,
    compute_frame_capacity,
    pack,
)
from pacinian.serving.ipc.shared_memory import SharedRegister
from pacinian.serving.settings import Lattice, Network, Settings
from pacinian.wire import binary_arrays
from pacinian.wire.codec import decode_reply, encode
from pacinian.wire.commands import Field, HandFrame
from pacinian.wire.replies import Error, Ok, Pressures

from ....waiting import PATIENCE, eventually
from ..fake_renderer import FakeRenderer, hands, move, point, put, remove

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

TOKEN = "secret"
PLAIN = Settings(array=Lattice(0.1, 0.1))
A, B = b"a" * 16, b"b" * 16


class Server:
    """The environment of a bus: files, a renderer, sockets of clients."""

    def __init__(self, folder: Path, settings: Settings, stack: contextlib.ExitStack) -> None:
        self.settings, self.folder, self._stack = settings, folder, stack
        sizes = {**CAPACITIES, "frame": compute_frame_capacity(len(settings.array.make()))}
        self.memory = {
            name: stack.enter_context(SharedRegister.create(folder / name, size))
            for name, size in sizes.items()
        }
        self.context: zmq.Context[Any] = stack.enter_context(zmq.Context())
        self.renderer = FakeRenderer()
        self._seen = 0
        self.run_round: Callable[[], object] = lambda: None
        self.port = 0
        self.bus: Bus

    def sessions(self, *keys: bytes, owned: str = "s", scene: str = "s") -> None:
        infos = tuple(SessionInfo(key, key[:1].decode(), scene, USER) for key in keys)
        self.memory["sessions"].write(pack(SessionTable(infos, owned)))

    def connect(self, token: str = TOKEN) -> zmq.Socket[Any]:
        socket = self._stack.enter_context(self.context.socket(zmq.DEALER))
        socket.linger = 0
        socket.plain_username, socket.plain_password = USER.encode(), token.encode()
        socket.zap_domain = DOMAIN.encode()
        socket.connect(f"tcp://127.0.0.1:{self.port}")
        return socket

    def take(self) -> None:
        """Take changes, as the renderer does each tick."""
        read = self.memory["changes"].read(self._seen)
        if read is not None:
            self._seen = read[0]
            taken = self.renderer.take(msgspec.msgpack.decode(read[1], type=Changes))
            self.memory["changes_ack"].write(pack(taken))

    def bus_status(self) -> BusStatus:
        read = self.memory["bus_status"].read()
        assert read is not None
        return msgspec.msgpack.decode(read[1], type=BusStatus)

    def until(self, done: Callable[[], Any], *, taking: bool = True) -> Any:
        def look() -> Any:
            self.run_round()
            if taking:
                self.take()
            return done()

        return eventually(look)

    def reply(self, socket: zmq.Socket[Any]) -> Any:
        return self.until(lambda: decode_reply(socket.recv()) if socket.poll(0) else None)


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    with running(tmp_path, PLAIN) as server:
        yield server


@contextlib.contextmanager
def running(folder: Path, settings: Settings) -> Iterator[Server]:
    """Run a bus in this thread."""
    with contextlib.ExitStack() as stack:
        server = Server(folder, settings, stack)
        bus = stack.enter_context(open_bus(settings, folder, {"token": TOKEN}))
        server.run_round, server.port, server.bus = bus.run_round, bus.port, bus
        yield server


def send(socket: zmq.Socket[Any], command: Any) -> None:
    socket.send(encode(command))


def test_what_clients_put_is_what_the_renderer_has(server: Server) -> None:
    server.sessions(A, B)
    one, other = server.connect(), server.connect()
    send(one, put({"a": point(), "b": point()}, session=A, id=1))
    assert server.reply(one) == Ok(id=1)
    send(other, put({"c": point()}, session=B, id=2))
    assert server.reply(other) == Ok(id=2)
    send(other, hands(HandFrame(), session=B, sequence=2, time=7.0))
    send(one, move(("b",), 0.5, session=A, sequence=2))
    server.until(lambda: server.renderer.scene.get("b", [0, 0])[1] == 0.5)
    told = server.until(
        lambda: server.renderer.hands and server.renderer.hands.input == 2 and server.renderer.hands
    )
    assert told.sent == 7.0
    assert told.felt
    assert sorted(server.renderer.scene) == ["a", "b", "c"]
    server.sessions(A)
    server.until(lambda: sorted(server.renderer.scene) == ["a", "b"])
    assert server.renderer.hands is not None
    assert server.renderer.hands.hands == ()
    assert server.renderer.begins == 1
    bus_status = server.until(lambda: (t := server.bus_status()).clients.keys() == {A.hex()} and t)
    assert bus_status.clients[A.hex()][:4] == (2, 2, 0, 0)
    assert bus_status.port == server.port


def test_a_session_that_was_welcomed_just_now_is_known(server: Server) -> None:
    socket = server.connect()
    server.until(lambda: True)
    server.sessions(A)
    send(socket, remove("nothing"))
    send(socket, put({"a": point()}, session=A, id=1))
    error = server.reply(socket)
    assert (error.code, error.path) == ("session", "$.session")  # for a session that does not exist
    assert server.reply(socket) == Ok(id=1)


def test_another_owner_s_scene_takes_the_place_of_the_first(server: Server) -> None:
    server.sessions(A)
    one, other = server.connect(), server.connect()
    send(one, put({"a": point()}, session=A, id=1))
    server.until(lambda: "a" in server.renderer.scene)
    infos = SessionInfo(A, "a", "s", USER), SessionInfo(B, "b", "t", USER)
    server.memory["sessions"].write(pack(SessionTable(infos, "s")))
    send(other, put({"b": point()}, session=B, id=1))
    assert server.reply(other) == Ok(id=1)
    assert list(server.renderer.scene) == ["a"]
    server.memory["sessions"].write(pack(SessionTable(infos, "t")))
    server.until(lambda: list(server.renderer.scene) == ["b"])
    server.memory["sessions"].write(pack(SessionTable(infos, "")))
    server.memory["sessions"].write(pack(SessionTable(infos, "s")))
    server.until(lambda: list(server.renderer.scene) == ["a"])


def test_a_key_on_another_connection_is_refused_and_logged(server: Server, logged: Any) -> None:
    server.sessions(A)
    one, other = server.connect(), server.connect()
    recorded = encode(put({"a": point()}, session=A, id=1))
    one.send(recorded)
    assert server.reply(one) == Ok(id=1)
    other.send(recorded)
    error = server.reply(other)
    assert (error.code, error.id, error.path) == ("session", 1, "$.session")
    assert "connection" in error.message
    one.send(recorded)
    assert server.reply(one).code == "sequence"
    assert A.hex() not in logged.wait("replayed")


def test_who_has_not_the_token_is_not_heard(server: Server) -> None:
    server.sessions(A)
    wrong = server.connect("wrong")
    with contextlib.suppress(zmq.Again):  # it was refused before it could send
        wrong.send(encode(put({"a": point()}, session=A, id=1)), zmq.DONTWAIT)
    right = server.connect()
    send(right, put({"b": point()}, session=A, id=1))
    assert server.reply(right) == Ok(id=1)
    assert not wrong.poll(0)
    assert server.until(lambda: (t := server.bus_status()).received and t).received == 1


def test_nonsense_is_refused_with_its_path_and_not_too_often(server: Server) -> None:
    server.sessions(A)
    socket = server.connect()
    bad = msgspec.msgpack.encode({"type": "put", "id": 3, "session": A, "sequence": -1, "time": 0})
    for data in (bad, b"", b"\xc1" * 50, b"\x91" * 10_000):
        socket.send(data)
    socket.send_multipart([encode(remove("a")), b"more"])
    told = [server.reply(socket) for _ in range(5)]
    assert {e.code for e in told} == {"malformed"}
    assert (told[0].id, told[0].path) == (3, "$.sequence")
    for _ in range(200):
        socket.send(b"\xc1")
    send(socket, put({"a": point()}, session=A, id=9))
    replies = []
    while Ok(id=9) not in replies:
        replies.append(server.reply(socket))
    assert len(replies) < 200
    assert server.until(lambda: (t := server.bus_status()).refused >= 205 and t)


def test_overload_takes_no_memory_and_the_newest_is_what_is_felt(server: Server) -> None:
    server.sessions(A)
    socket, names = server.connect(), tuple(f"o{i}" for i in range(100))
    socket.sndhwm = 10
    send(socket, put({n: point() for n in names}, session=A, id=1))
    assert server.reply(socket) == Ok(id=1)
    waiting = []
    for k in range(1, 1001):  # 100,000 updates, and nothing is taken
        data = encode(move(names, k / 1024, session=A, sequence=k + 1, time=1e-4 * k))
        socket.send(data)
        if k % 200 == 0:
            server.until(
                lambda k=k: server.bus_status().received and _commands(server) >= 1 + k,
                taking=False,
            )
            waiting.append(server.bus_status().waiting)
    assert max(waiting) <= 2 * len(names) + 3
    server.until(lambda: all(p[1] == 1000 / 1024 for p in server.renderer.scene.values()))
    assert list(server.renderer.scene) == list(names)


def _commands(server: Server) -> int:
    return server.bus_status().clients.get(A.hex(), (0, 0))[1]


def test_a_client_that_does_not_read_holds_up_nobody(server: Server) -> None:
    server.sessions(A, B)
    deaf = server.connect()
    deaf.rcvhwm = 1
    other = server.connect()
    for i in range(3000):
        send(deaf, remove("a" * 60))
        if i % 100 == 0:
            server.run_round()
        send(deaf, put({}, session=A, sequence=i + 1, id=1))
    send(other, put({"b": point()}, session=B, id=1))
    assert server.reply(other) == Ok(id=1)
    server.until(lambda: "b" in server.renderer.scene)


def test_the_field_is_of_what_the_device_emits(server: Server) -> None:
    server.sessions(A)
    array = server.settings.array.make()
    N = len(array)
    phase, amplitude = np.arange(N).astype("<u2") % 256, np.full(N, 255, "<u2")
    device = DeviceStatus(1, 0, "d", 256, 256, 1000.0, None, 0.0, True)
    server.memory["device"].write(pack(device))
    head = FrameHead(3, 1.5, 1, 1, 1, N)
    server.memory["frame"].write(head.pack(), phase.tobytes(), amplitude.tobytes())
    socket = server.connect()
    points = np.array([[0, 0, 0.2], [0.01, 0, 0.2]] * 4000, "<f4")
    send(socket, Field(session=A, sequence=1, time=0.0, id=4, points=binary_arrays.pack(points)))
    send(socket, put({"a": point()}, session=A, sequence=2, id=5))
    assert server.reply(socket) == Ok(id=5)  # does not wait for queries
    answer = server.reply(socket)
    assert isinstance(answer, Pressures)
    p = binary_arrays.unpack(answer.pressures, 2).view(np.complex64)[:, 0]
    want = pc.field(
        array, np.exp(2j * np.pi * phase / 256), points, precision="double", medium=pc.Air()
    )
    assert np.abs(p - want).max() < 1e-3 * np.abs(want).max()


def test_errors_of_objects_that_are_converted_later_are_told(server: Server) -> None:
    from pacinian.wire import objects, shapes

    server.sessions(A)
    socket = server.connect()
    bad = objects.Surface(radiation_pressure=1.0, force=1.0, shape=shapes.Disc(0.1))
    send(socket, put({"bad": bad}, session=A))
    error = server.reply(socket)
    assert isinstance(error, Error)
    assert (error.code, error.id) == ("argument", 0)
    assert error.path.startswith("$.objects[bad]")


def test_it_runs_as_a_process_and_ends_with_its_parent(tmp_path: Path) -> None:
    with contextlib.ExitStack() as stack:
        server = Server(tmp_path, PLAIN, stack)
        process = launched_child.start_child(
            "bus", launch_config.LaunchConfig(str(tmp_path), PLAIN, {"token": TOKEN})
        )
        stack.callback(launched_child.end_child, process)
        server.until(lambda: server.memory["bus_status"].number)
        server.port = server.bus_status().port
        server.sessions(A)
        socket = server.connect()
        send(socket, put({"a": point()}, session=A, id=1))
        assert server.reply(socket) == Ok(id=1)
        server.until(lambda: "a" in server.renderer.scene)
        beat = server.bus_status().heartbeat
        server.until(lambda: server.bus_status().heartbeat > beat)
        assert launched_child.end_child(process, PATIENCE) == 0


def test_a_port_that_is_taken_is_told(server: Server, tmp_path: Path) -> None:
    taken = Settings(array=Lattice(0.1, 0.1), network=Network(command=server.port))
    with (
        pytest.raises(pc.ServerError, match="cannot be bound"),
        open_bus(taken, tmp_path, {"token": TOKEN}),
    ):
        pass


def test_a_round_takes_only_so_many_messages(
    server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_ROUND_MESSAGES", 10)
    monkeypatch.setattr(module, "MAX_RECEIVE_TIME", 1e9)
    server.sessions(A)
    socket = server.connect()
    send(socket, put({"a": point()}, session=A, id=1))
    assert server.reply(socket) == Ok(id=1)
    for i in range(100):
        send(socket, move(("a",), 0.1, session=A, sequence=i + 2))
    rounds = 0
    bus_round = server.run_round

    def counted() -> None:
        nonlocal rounds
        rounds += 1
        bus_round()

    server.run_round = counted
    server.until(lambda: server.bus_status().received == 101)
    assert rounds >= 10


def test_before_its_first_report_it_takes_back_what_the_bus_before_told(tmp_path: Path) -> None:
    with contextlib.ExitStack() as stack:
        server = Server(tmp_path, PLAIN, stack)
        server.memory["changes"].write(pack(Changes(9, 1, ())))
        with open_bus(PLAIN, tmp_path, {"token": TOKEN}) as bus:
            read = server.memory["changes"].read()
            assert read is not None
            told = msgspec.msgpack.decode(read[1], type=Changes)
            assert (told.number, told.changes) == (0, ())
            assert told.run == bus.dispatcher.batcher.run


@pytest.mark.parametrize(
    "where",
    [
        "_carry_out",
        "_answer",
        "run_round",
        "expire",
        "run_chunk",
        "make_batch",
        "update_sessions",
        "_leave",
        "encode",
    ],
)
def test_whatever_is_raised_it_goes_on(
    server: Server, monkeypatch: pytest.MonkeyPatch, where: str
) -> None:
    server.sessions(A, B)
    one, other = server.connect(), server.connect()
    send(one, put({"a": point()}, session=A, id=1))
    assert server.reply(one) == Ok(id=1)
    dispatcher = server.bus.dispatcher
    raised: list[str] = []

    def bad(*_: object) -> Any:
        raised.append(where)
        raise RuntimeError(where)

    at: Any = {
        "run_round": dispatcher.converter, "expire": next(iter(dispatcher.scenes.values())),
        "run_chunk": dispatcher.queries, "make_batch": dispatcher.batcher, "encode": module,
    }.get(where, dispatcher)  # fmt: skip
    with monkeypatch.context() as patch:
        patch.setattr(at, where, bad)
        send(one, put({"a": point()}, session=A, id=2, sequence=2))
        server.sessions(A)
        server.until(lambda: raised)
        for _ in range(20):
            server.run_round()
    send(one, put({"c": point()}, session=A, id=3, sequence=3))
    server.until(lambda: decode_reply(one.recv()) == Ok(id=3) if one.poll(0) else None)
    server.until(lambda: "c" in server.renderer.scene)
    if where == "_carry_out":
        server.until(lambda: server.bus_status().refused)
    del other


def test_a_command_that_fails_is_answered(server: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    server.sessions(A)
    one = server.connect()

    def bad(*_: object) -> Any:
        raise RuntimeError("of ours")

    monkeypatch.setattr("pacinian.serving.bus.dispatcher.carry_out", bad)
    send(one, put({"a": point()}, session=A, id=1))
    reply = server.reply(one)
    assert isinstance(reply, Error)
    assert (reply.code, reply.id) == ("fault", 1)
