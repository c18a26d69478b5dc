"""A control process in a thread, with fakes of the other processes."""

from __future__ import annotations

import contextlib
import io
import itertools
import threading
import time
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
import zmq
from msgspec.structs import replace

from pacinian.serving.ipc.logs import configure
from pacinian.serving.ipc.messages import (
    BusStatus,
    DeviceStatus,
    FrameHead,
    Permit,
    RendererStatus,
    pack,
)
from pacinian.serving.ipc.shared_memory import SharedRegister
from pacinian.serving.server import serve
from pacinian.serving.settings import Log, Settings
from pacinian.wire.codec import decode_reply, decode_state, encode
from pacinian.wire.connection_file import Connection
from pacinian.wire.control import Hello
from pacinian.wire.protocol import MAJOR, MINOR
from pacinian.wire.replies import Plugin, Welcome

from ...waiting import PATIENCE, eventually
from .processes import PATIENT

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from pacinian.serving.ipc.child_pipe import ChildPipe
    from pacinian.serving.ipc.launch_config import LaunchConfig


class Pretender:
    """A fake process. It sends a heartbeat at each `poll`, and answers all selections."""

    pid = 7

    def __init__(self, name: str, told: LaunchConfig, extra: dict[str, Any]) -> None:
        self.name, self.told, self.extra = name, told, extra
        self.code: int | None = None
        self.silent = self.killed = False
        self.called: Callable[[], object] = lambda: None

    def latest(self, name: str) -> SharedRegister:
        return SharedRegister.attach(self.told.path / name)

    def poll(self) -> int | None:
        if self.code is None and not self.silent:
            self.live()
        return self.code

    def live(self) -> None:
        now = time.perf_counter()
        with self.latest("permit") as file:
            permit = Permit.unpack((file.read() or (0, Permit().pack()))[1])
        value: Any
        if self.name == "guard":
            loud = permit.armed != 0 and now < permit.until
            given = {"name": "pretended", "backends": (Plugin(name="pretended"),), **self.extra}
            value = DeviceStatus(
                generation=1, next_generation=0, phases=16, amplitudes=16, rate=1000.0, watchdog=None, heartbeat=now,
                sounding=loud, **given,
            )  # fmt: skip
        elif self.name == "bus":
            value = BusStatus(now, **self.extra)
        else:
            solvers = Plugin(name="auto"), Plugin(name="gs")
            given = {"state": {"solver": "auto", "ticks": 3}, "solvers": solvers, **self.extra}
            value = RendererStatus(now, **given)
            with self.latest("frame") as file:
                levels = bytes(range(8)) * 2
                file.write(FrameHead(1, now, permit.epoch, 1, 2, 2).pack() + levels)
        with self.latest(
            {"guard": "device", "bus": "bus_status", "render": "renderer_status"}[self.name]
        ) as f:
            f.write(pack(value))

    def activate(self) -> None:
        self.called()

    def close(self) -> None:
        pass

    def kill(self) -> None:
        self.killed, self.code = True, -9

    def wait(self, timeout: float | None = None) -> int:
        self.code = 0 if self.code is None else self.code
        return self.code


class Server:
    """A running control process.

    processes: all started processes, by name. spares: of the guard; they join `processes` once they are called. extra:
    additional status fields, by name. silent: names of processes that start without a heartbeat.
    """

    def __init__(self, settings: Settings, folder: Path) -> None:
        self.path = folder / "connection.json"
        self.settings = replace(settings, connection=str(self.path))
        self.processes: dict[str, list[Pretender]] = {}
        self.spares: list[Pretender] = []
        self.extra: dict[str, dict[str, Any]] = {"guard": {}, "bus": {}, "render": {}}
        self.silent: set[str] = set()
        self.context = zmq.Context()
        self.ending = threading.Event()
        self.error: BaseException | None = None
        self.sockets = contextlib.ExitStack()
        self._thread = threading.Thread(target=self._run)

    def _run(self) -> None:
        try:
            serve(self.settings, start_child=self._start, ending=self.ending)
        except BaseException as error:
            self.error = error

    def _start(self, name: str, told: LaunchConfig, _: ChildPipe) -> Pretender:
        made = Pretender(name, told, self.extra[name])
        made.silent = name in self.silent or told.spare > 0

        def call() -> None:
            made.silent = name in self.silent
            self.processes.setdefault(name, []).append(made)

        if told.spare:
            made.called = call
            self.spares.append(made)
        else:
            call()
        return made

    def __enter__(self) -> Server:
        self._thread.start()
        eventually(lambda: self.path.exists() or self.error)
        if self.error:
            self.__exit__()
            raise self.error
        return self

    def __exit__(self, *_: object) -> None:
        self.end()
        self.sockets.close()
        self.context.destroy(linger=0)

    def end(self) -> None:
        self.ending.set()
        self._thread.join(PATIENCE)
        assert not self._thread.is_alive()

    @property
    def connection(self) -> Connection:
        return Connection.read(self.path)

    def socket(self, kind: int, token: str | None = None, **options: Any) -> zmq.Socket[bytes]:
        """Return an unconnected socket with the secrets of the connection file, unless others are given."""
        made = self.sockets.enter_context(self.context.socket(kind))
        made.linger = 0
        made.rcvtimeo = made.sndtimeo = int(1e3 * PATIENCE)
        connection = self.connection
        if connection.server_key:
            made.curve_serverkey = connection.server_key.encode()
            made.curve_publickey = connection.public_key.encode()
            made.curve_secretkey = connection.secret_key.encode()
        elif token != "":
            made.plain_username = b"pacinian"
            made.plain_password = (token or connection.token).encode()
        for name, value in options.items():
            setattr(made, name, value)
        return made

    def monitor(self, socket: zmq.Socket[bytes], events: int) -> zmq.Socket[bytes]:
        """Return the monitor of a socket. Call it before the socket connects."""
        made = self.sockets.enter_context(socket.get_monitor_socket(events))
        self.sockets.callback(socket.disable_monitor)
        return made

    def client(self, **options: Any) -> Asker:
        made = self.socket(zmq.DEALER, **options)
        made.connect(self.connection.control)
        return Asker(made)

    def states(self, topic: bytes = b"state") -> Callable[[], Any]:
        """Return a function that receives the next published state."""
        made = self.socket(zmq.SUB)
        made.subscribe(topic)
        made.connect(self.connection.state)
        return lambda: decode_state(made.recv_multipart()[1])

    def permit(self) -> Permit:
        with self.processes["guard"][-1].latest("permit") as file:
            read = file.read()
        assert read is not None
        return Permit.unpack(read[1])


class Asker:
    """A client of the control socket."""

    def __init__(self, socket: zmq.Socket[bytes]) -> None:
        self.socket = socket
        self.session = b""
        self._id = 0

    def send(self, message: Any) -> None:
        self.socket.send(encode(message))

    def hear(self) -> Any:
        return decode_reply(self.socket.recv())

    def ask(self, kind: Any, **fields: Any) -> Any:
        """Send a request and return its reply. Unsolicited messages are dropped."""
        self._id += 1
        if "session" in kind.__struct_fields__:
            fields.setdefault("session", self.session)
        self.send(kind(id=self._id, **fields))
        while True:
            reply = self.hear()
            if reply.id == self._id:
                return reply

    def hello(self, name: str = "game", **fields: Any) -> Asker:
        reply = self.ask(Hello, protocol=(MAJOR, MINOR), client=name, **fields)
        assert isinstance(reply, Welcome), reply
        self.session = reply.session
        return self


class Logged(io.StringIO):
    """The log. `capfd` is not used, because it loses text that is written while it reads."""

    def wait(self, *parts: str) -> str:
        """Wait until the log contains all `parts`; return the log."""
        return str(eventually(lambda: all(p in self.getvalue() for p in parts) and self.getvalue()))

    def refused(self, *whys: str) -> None:
        """Wait until the log says that a connection was refused for one of these reasons."""
        self.wait("connection refused")
        eventually(lambda: any(f"why={why}" in self.getvalue() for why in whys))


@pytest.fixture
def logged(monkeypatch: pytest.MonkeyPatch) -> Logged:
    """Capture the log of this process. A server configures its own log when it starts."""
    made = Logged()
    seen = SimpleNamespace(stderr=made)  # sys.stderr is set by pytest when the test begins
    monkeypatch.setattr("pacinian.serving.ipc.logs.sys", seen)
    configure(Log(), "test")
    return made


@pytest.fixture
def start_server(tmp_path: Path) -> Iterator[Callable[..., Server]]:
    """Return a function that starts a server with settings. The server ends with the test."""
    with contextlib.ExitStack() as stack:
        numbers = itertools.count()
        yield lambda settings=None: stack.enter_context(
            Server(settings or PATIENT, tmp_path / str(next(numbers)))
        )


@pytest.fixture
def server(start_server: Callable[..., Server]) -> Server:
    """Start a server with leases that outlast a busy machine."""
    return start_server()
