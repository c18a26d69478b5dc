"""A fake server in one thread, with real sockets but without an array; tests set its answers."""

import os
import queue
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import msgspec
import zmq
from zmq.auth.thread import ThreadAuthenticator

from pacinian.wire import commands, control, replies
from pacinian.wire.binary_arrays import pack
from pacinian.wire.codec import decode_command, decode_control, encode
from pacinian.wire.connection_file import Connection
from pacinian.wire.state import STATE, State

PATIENCE = 120.0  # ends a test that hangs [s]; not imported, because this file is also a program
KEY = b"k" * 16
ABILITIES: dict[str, Any] = {
    "solvers": (), "backends": (), "techniques": (), "presets": (), "positions": b"", "normals": b"",
    "frequency": 40e3, "wavelength": 0.0085, "phases": 320, "amplitudes": 320, "device_rate": 1e3,
    "rate": 1e3, "limits": {},
}  # fmt: skip


def state(sequence: int = 1, **fields: Any) -> State:
    given: dict[str, Any] = {
        "time": time.perf_counter(), "output": "silent", "armed": False, "owner": "", "scene": "",
        "solver": "auto", "backend": "simulated", "technique": "simultaneous", "intensity": 1.0,
    }  # fmt: skip
    return State(sequence=sequence, **{**given, **fields})


class Fake:
    """A context manager. seen: received messages. answers: by type of message, instead of the usual ones."""

    def __init__(
        self, ports: tuple[int, ...] = (0, 0, 0), keys: tuple[bytes, bytes] | None = None
    ) -> None:
        self.keys, self.token = keys, "t" * 64
        self.seen: list[Any] = []
        self.answers: dict[type, Callable[[Any], Any]] = {}
        self.deaf = False
        """Whether it reads nothing."""
        self.full = False
        """Whether it reads no commands."""
        self.stream: Callable[[], State] | None = None
        """Makes a state to publish in each round of the thread, at most 500 a second."""
        self._context = zmq.Context()
        self._zap = ThreadAuthenticator(self._context)
        self._zap.start()
        self._zap.configure_plain("pacinian", {"pacinian": self.token})
        if keys:
            self._zap.configure_curve("pacinian", location="*")
        kinds = {"control": zmq.ROUTER, "command": zmq.ROUTER, "state": zmq.PUB}
        self._sockets = [
            self._bound(name, kind, port)
            for (name, kind), port in zip(kinds.items(), ports, strict=True)
        ]
        self.ports = tuple(
            int(str(s.last_endpoint).rpartition(":")[2].rstrip("'\0")) for s in self._sockets
        )
        self.peers: list[bytes] = [b"", b""]
        self._todo: queue.Queue[tuple[Callable[[], object], threading.Event]] = queue.Queue()
        self._ended = False
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _bound(self, name: str, kind: int, port: int) -> Any:
        socket = self._context.socket(kind)
        socket.linger, socket.sndhwm = 0, 10_000
        # Clients send heartbeats to `control`, and libzmq aborts if one of these waits at a high-water mark.
        socket.rcvhwm = 10 if name == "command" else 0
        socket.setsockopt(zmq.RCVBUF, 4096)
        socket.zap_domain = b"pacinian"
        if self.keys:
            socket.curve_server = True
            socket.curve_publickey, socket.curve_secretkey = self.keys
        else:
            socket.plain_server = True
        socket.bind(f"tcp://127.0.0.1:{port or '*'}")
        return socket

    @property
    def connection(self) -> Connection:
        at = [f"tcp://127.0.0.1:{port}" for port in self.ports]
        server_key = self.keys[0].decode() if self.keys else ""
        return Connection(
            pid=os.getpid(),
            control=at[0],
            command=at[1],
            state=at[2],
            token=self.token,
            server_key=server_key,
        )

    def of(self, kind: type) -> list[Any]:
        return [m for m in self.seen if isinstance(m, kind)]

    def do(self, what: Callable[[], object]) -> None:
        """Call a function in the server's thread, and wait for its end."""
        done = threading.Event()
        self._todo.put((what, done))
        assert done.wait(PATIENCE)

    def say(self, reply: Any, socket: int = 0, answers: dict[type, Any] | None = None) -> None:
        """Send a reply to the client that last sent on that socket, other than an emergency stop.

        socket: 0 for control, 1 for commands. answers: to messages that come after the reply is sent.
        """

        def send() -> None:
            self.answers.update(answers or {})
            self._sockets[socket].send_multipart([self.peers[socket], encode(reply)])

        self.do(send)

    def publish(self, *states: State) -> None:
        self.do(lambda: [self._sockets[2].send_multipart([STATE, encode(s)]) for s in states])

    def until(self, what: Callable[[], bool]) -> None:
        end = time.monotonic() + PATIENCE
        while not what():
            assert time.monotonic() < end, self.seen
            time.sleep(0.001)  # lets the other thread run

    def die(self) -> None:
        """Close all sockets at once. Answers call it to end the server in the middle of an answer."""
        self._ended = True
        for socket in self._sockets:
            socket.close(0)

    def close(self) -> None:
        if not self._context.closed:
            self._ended = True
            self._thread.join(PATIENCE)
            for socket in self._sockets:
                socket.close(0)
            self._zap.stop()
            self._context.term()

    def __enter__(self) -> "Fake":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _run(self) -> None:
        while not self._ended:
            while not self._todo.empty():
                what, done = self._todo.get()
                what()
                done.set()
            if self.deaf:
                time.sleep(0.001)
                continue
            if stream := self.stream:  # the test may remove it at any time
                self._sockets[2].send_multipart([STATE, encode(stream())])
            ready, *_ = zmq.select(self._sockets[: 1 if self.full else 2], [], [], 0.002)
            for i, decode in enumerate((decode_control, decode_command)):
                if self._sockets[i] in ready and not self._ended:
                    peer, data = self._sockets[i].recv_multipart()
                    message = decode(data)
                    if not isinstance(message, control.Stop):  # a stop uses its own connection
                        self.peers[i] = peer
                    self.seen.append(message)
                    self._answer(i, peer, message)

    def _answer(self, i: int, peer: bytes, message: Any) -> None:
        answer = self.answers.get(type(message), usual)(message)
        for reply in answer if isinstance(answer, list) else [answer]:
            if reply is not None:
                self._sockets[i].send_multipart([peer, encode(reply)])


LEASE = 0.25  # of clients that ask for none [s]


def usual(message: Any) -> Any:
    """Return a normal reply."""
    number, now = message.id, time.perf_counter()
    if isinstance(message, control.Hello):
        return replies.Welcome(
            id=number, session=KEY, protocol=(1, 0), server="fake", time=now, scene=message.scene or "own",
            lease=message.lease or LEASE, link=0.2, rate=1e3,
        )  # fmt: skip
    if isinstance(message, control.Renew):
        return replies.Renewed(
            id=number, sequence=message.sequence, time=message.time, server_time=now, until=now + 0.25,
            owner=True, armed=True,
        )  # fmt: skip
    if isinstance(message, control.Capabilities):
        return replies.Abilities(id=number, **ABILITIES)
    if isinstance(message, control.Status):
        return state(id=number)
    if isinstance(message, commands.Field):
        pairs = [(i, -i) for i in range(len(message.points) // 12)]
        return replies.Pressures(id=number, pressures=pack(pairs), time=now)
    return replies.Ok(id=number) if number else None


if __name__ == "__main__":
    with Fake() as fake:
        sys.stdout.write(msgspec.json.encode(fake.connection).decode() + "\n")
        sys.stdout.flush()
        sys.stdin.read()
